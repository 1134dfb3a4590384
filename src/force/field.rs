//! Force fields as data.

use super::CustomForces;
use crate::body::{Bodies, BodyKind, check_velocity};
use crate::codec::{codec_enum, codec_struct};
use crate::error::{Error, Quantity};
use crate::fx::Fx;
use crate::limits;
use crate::math::Vec2;
use crate::scalar::{Factor, Scalar, SpringConstants};
use crate::slots::BodyId;

/// The part of a body's state that a force depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
pub enum Dependence {
    /// The force is constant.
    Nothing,
    /// Position or angle. The force is evaluated once in each fields stage.
    Position,
    /// Velocity as well. The force is evaluated again in the closing half kick. The step is then of order 2, with `Yoshida4` of
    /// order 3, and not reversible.
    Velocity,
}

/// A point of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Attachment<S = Fx> {
    /// The body.
    pub body: BodyId,
    /// The point relative to the centre of mass of the body, in the axes of the body, m, each component within ±2^12.
    pub point: Vec2<S>,
}

impl Attachment {
    /// The centre of mass of a body.
    #[must_use]
    pub const fn centre(body: BodyId) -> Self {
        Self { body, point: Vec2::ZERO }
    }
}

/// The place of the far end of a spring, or of the centre of an attractor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
pub enum End<S = Fx> {
    /// A point of the world, m, each component within ±2^30.
    World(Vec2<S>),
    /// A point of a body.
    Body(Attachment<S>),
}

/// A closed region: a point on its edge is inside.
///
/// ```
/// use umbra_physics::{BodyDef, FieldKind, Region, World, WorldDef, vec2};
///
/// // A shaft of air that rises at 2 m/s².
/// let shaft = Region::Box { min: vec2(-1, 0), max: vec2(1, 10) };
/// let mut world = World::new(WorldDef::default())?;
/// world.add_field(FieldKind::Zone { region: shaft, acceleration: vec2(0, 2) })?;
/// let [inside, outside] = [0, 5].map(|x| world.add_body(BodyDef { position: vec2(x, 1), ..BodyDef::dynamic() }));
/// (0..60).for_each(|_| _ = world.step());
/// assert_eq!(world.body(inside?)?.position(), vec2(0, 2));
/// assert_eq!(world.body(outside?)?.position(), vec2(5, 1));
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
pub enum Region<S = Fx> {
    /// A disc.
    Disc {
        /// The centre, m, each component within ±2^30.
        centre: Vec2<S>,
        /// The radius, m, 0 to 2^30.
        radius: S,
    },
    /// A rectangle parallel to the axes. A box whose `min` is beyond its `max` is empty and acts on nothing.
    Box {
        /// The lower left corner, m, each component within ±2^30.
        min: Vec2<S>,
        /// The upper right corner, m, each component within ±2^30.
        max: Vec2<S>,
    },
}

/// The kind of a force field, with its parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(
        rename_all = "snake_case",
        deny_unknown_fields,
        bound(
            serialize = "S: serde::Serialize, S::Factor: serde::Serialize",
            deserialize = "S: serde::Deserialize<'de>, S::Factor: serde::Deserialize<'de>"
        )
    )
)]
pub enum FieldKind<S: Scalar = Fx> {
    /// An acceleration mu·d / (d² + softening²)^(3/2) towards a point, the same for every mass. A body does not attract itself.
    Attractor {
        /// The point that attracts.
        centre: End<S>,
        /// The gravitational parameter G·M, m³/s², 0 to 2^64.
        mu: S::Factor,
        /// The distance below which the attraction softens, m, 0 to 2^12; 0 for none.
        softening: S,
    },
    /// A spring with a damper along it. At zero length it has no direction and exerts no force.
    Spring {
        /// The near end.
        near: Attachment<S>,
        /// The far end.
        far: End<S>,
        /// Rest length, stiffness and damping.
        spring: SpringConstants<S>,
    },
    /// Drag against a medium: F = −(linear + quadratic·|u|)·u with u the velocity relative to the medium. The equation is
    /// solved exactly.
    ///
    /// Several drags on one body act one after the other, in the order in which they were added.
    Drag {
        /// The linear coefficient, N·s/m, from 0.
        linear: S,
        /// The quadratic coefficient, N·s²/m², from 0.
        quadratic: S,
        /// The velocity of the medium, m/s, each component within ±2^20.
        wind: Vec2<S>,
    },
    /// Friction with a ground that is seen from above: speed and spin fall at constant rates, whatever the mass, to nothing. For balls, pucks, cars.
    ///
    /// A body stops to the bit, in its direction, after the way v²/2a, and falls asleep. One at rest that other fields, gravity or applied forces
    /// push by less stays where it is. Contacts and joints push it all the same: [`Motor::friction`](crate::Motor::friction) is weighed against their
    /// forces, at the price of a joint for each body. Frictions that act on one body add up. With [`Yoshida4`](crate::Integrator::Yoshida4), which
    /// steps backwards in between, it acts at the end of each step. There, and with [`PublishedVerlet`](crate::Integrator::PublishedVerlet), whose
    /// drift takes in the acceleration, a body that an acceleration a below the friction pushes goes by ½·a·h² in a step. Over a step with an impact
    /// it acts as on the way without the impact: a bounce is off by a·h at most.
    /// *Error* of the way ⅛·a·h² in steps of h seconds: the step that stops the body is not on the parabola.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, FieldKind, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// world.add_field(FieldKind::Friction { deceleration: fx!(2), angular_deceleration: fx!(3) })?;
    /// let ball = BodyDef { velocity: vec2(3, 4), angular_velocity: fx!(-6), ..BodyDef::dynamic() };
    /// let ball = world.add_body(ball)?;
    /// (0..151).for_each(|_| _ = world.step()); // 5 m/s take 2.5 s
    /// let ball = world.body(ball)?;
    /// assert_eq!((ball.velocity(), ball.angular_velocity()), (vec2(0, 0), fx!(0)));
    /// assert!((ball.position() - vec2(fx!(3.75), 5)).length() < fx!(0.0001)); // v²/2a = 6.25 m
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    Friction {
        /// The deceleration, m/s², 0 to 2^16: μ·g for a coefficient μ.
        deceleration: S,
        /// The deceleration of the spin, rad/s², 0 to 2^16: 4/3·μ·g/R for a disc of the radius R that lies on the ground.
        angular_deceleration: S,
    },
    /// A force that turns with the body.
    Thrust {
        /// The point where the force acts.
        at: Attachment<S>,
        /// The force in the axes of the body, N.
        force: Vec2<S>,
    },
    /// A constant acceleration of the bodies whose centre of mass is in a region, the same for every mass.
    Zone {
        /// The region.
        region: Region<S>,
        /// The acceleration, m/s², each component within ±2^16.
        acceleration: Vec2<S>,
    },
    /// A fluid in a box, which lifts the colliders in it and slows them down.
    ///
    /// The part of a body's colliders in the box displaces the fluid: the body gets a lift of density·area against the gravity of the
    /// world, at the centroid of that part. Sensors, segments and a body without colliders displace nothing. The gravity scale of the body
    /// does not change the lift, which is the weight of the displaced fluid. Where parts of a compound, or colliders of a body, overlap,
    /// the area counts twice, as it does for the mass.
    ///
    /// The drags are in proportion to the area too: F = −`linear_drag`·area·(v − flow) through the centre of mass, and a torque of
    /// −`angular_drag`·area·ω. Their equations are solved exactly over each half of a step, so that no drag is too strong, with the area at
    /// the start and at the end. They act in turn with [`Drag`](Self::Drag)s, in the order in which the fields were added.
    ///
    /// A body in fluids without flow falls asleep by the rule for bodies with contacts: when it has been slower than
    /// [`ContactSettings::sleep_speed`](crate::ContactSettings::sleep_speed) for [`WorldDef::sleep_after`](crate::WorldDef::sleep_after)
    /// ticks.
    ///
    /// *Error* of the area 2^-32 m times the length of the outline (2^-36 of its reach from the centre of mass, where that is more than 32
    /// m, times that length), and for a collider with a radius r 2^-10·r² more.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, ContactSettings, FieldKind, Shape, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
    /// // A pool 20 m wide and 5 m deep; its surface is at a height of 0.
    /// world.add_field(FieldKind::Buoyancy {
    ///     min: vec2(-10, -5),
    ///     max: vec2(10, 0),
    ///     density: fx!(4),
    ///     linear_drag: fx!(6),
    ///     angular_drag: fx!(2),
    ///     flow: vec2(0, 0),
    /// })?;
    /// // A quarter as heavy as the fluid: a quarter of it is under the surface.
    /// let crate_ = world.add_body(BodyDef::dynamic().with_collider(Shape::rectangle(2, 2)?))?;
    /// (0..600).for_each(|_| _ = world.step());
    /// assert_eq!(format!("{:.1}", world.body(crate_)?.position().y), "0.5");
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    Buoyancy {
        /// The lower left corner of the box, m, each component within ±2^30.
        min: Vec2<S>,
        /// The upper right corner of the box, m, in the same range: not left of the other one and not below it.
        max: Vec2<S>,
        /// The density of the fluid, kg/m², from 0. A body of lower density floats.
        density: S,
        /// The linear drag, N·s/m for each m² in the fluid, from 0. With 0 a floating body bobs for ever.
        linear_drag: S,
        /// The angular drag, N·m·s for each m² in the fluid, from 0.
        angular_drag: S,
        /// The velocity of the fluid, m/s, each component within ±2^20.
        flow: Vec2<S>,
    },
    /// A [`CustomForce`](super::CustomForce) that the user defines.
    Custom {
        /// The id of the custom force.
        id: u64,
    },
}

/// A force field: its kind, and the bodies it acts on.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(
        deny_unknown_fields,
        bound(
            serialize = "S: serde::Serialize, S::Factor: serde::Serialize",
            deserialize = "S: serde::Deserialize<'de>, S::Factor: serde::Deserialize<'de>"
        )
    )
)]
pub struct ForceField<S: Scalar = Fx> {
    /// The kind of the field, with its parameters.
    pub kind: FieldKind<S>,
    /// The groups the field acts on: dynamic bodies with one of these bits. Springs and thrusts act only on the bodies they are
    /// attached to.
    pub force_groups: u32,
}

impl<S: Scalar> From<FieldKind<S>> for ForceField<S> {
    /// A field of this kind that acts on the bodies of all groups.
    fn from(kind: FieldKind<S>) -> Self {
        Self { kind, force_groups: u32::MAX }
    }
}

codec_struct!(Attachment { body, point });
codec_struct!(SpringConstants { rest, stiffness, damping });
codec_struct!(ForceField { force_groups, kind });
codec_enum!(End<S>, "0 or 1 for an end", { 0 => World(point), 1 => Body(attachment) });
codec_enum!(Region<S>, "0 or 1 for a region", { 0 => Disc { centre, radius }, 1 => Box { min, max } });
codec_enum!(FieldKind<S>, "the number of a kind of field", {
    0 => Attractor { centre, mu, softening },
    1 => Spring { near, far, spring },
    2 => Drag { linear, quadratic, wind },
    3 => Thrust { at, force },
    4 => Zone { region, acceleration },
    5 => Custom { id },
    6 => Buoyancy { min, max, density, linear_drag, angular_drag, flow },
    7 => Friction { deceleration, angular_deceleration },
});

fn check(ok: bool, quantity: Quantity) -> Result<(), Error> {
    if ok { Ok(()) } else { Err(Error::OutOfRange { quantity }) }
}

fn within<S: Scalar>(point: Vec2<S>, limit: Fx) -> bool {
    point.is_within(S::from_fx(limit))
}

fn not_negative<S: Scalar>(value: S) -> bool {
    value >= S::ZERO && value.is_finite()
}

impl<S: Scalar> FieldKind<S> {
    /// Returns true if the field acts on the bodies of its groups, false if on the bodies that it is attached to.
    pub(crate) fn acts_by_groups(&self) -> bool {
        match self {
            Self::Spring { .. } | Self::Thrust { .. } => false,
            Self::Attractor { .. }
            | Self::Drag { .. }
            | Self::Friction { .. }
            | Self::Zone { .. }
            | Self::Buoyancy { .. }
            | Self::Custom { .. } => true,
        }
    }

    /// Returns true if the field slows bodies down by the exact solution of its equation: see [`resist`](super::resist).
    pub(crate) fn has_drag(&self) -> bool {
        match self {
            Self::Drag { .. } => true,
            Self::Buoyancy { linear_drag, angular_drag, .. } => *linear_drag != S::ZERO || *angular_drag != S::ZERO,
            _ => false,
        }
    }
}

impl<S: Scalar> End<S> {
    /// The body that it is on.
    pub(crate) fn body(&self) -> Option<BodyId> {
        match self {
            Self::World(_) => None,
            Self::Body(attachment) => Some(attachment.body),
        }
    }

    /// Returns the same place with the body that `map` gives for its body; `None` where it gives none.
    pub(crate) fn map_body(&self, map: impl Fn(BodyId) -> Option<BodyId>) -> Option<Self> {
        Some(match self {
            Self::World(point) => Self::World(*point),
            Self::Body(attachment) => Self::Body(Attachment { body: map(attachment.body)?, ..*attachment }),
        })
    }
}

impl<S: Scalar> ForceField<S> {
    /// Refuses a field that a world cannot add.
    pub(crate) fn check(&self, bodies: &Bodies<S>, custom_forces: &CustomForces<S>) -> Result<(), Error> {
        self.check_values(bodies, custom_forces)?;
        let dynamic = |body| match bodies.info(bodies.find(body)?).kind {
            BodyKind::Dynamic => Ok(()),
            _ => Err(Error::NotDynamic { body }),
        };
        match &self.kind {
            // At least one end has to be on a dynamic body.
            FieldKind::Spring { near: start, far: End::Body(end), .. } => {
                dynamic(start.body).or_else(|_| dynamic(end.body))
            }
            FieldKind::Spring { near: at, .. } | FieldKind::Thrust { at, .. } => dynamic(at.body),
            FieldKind::Attractor { .. }
            | FieldKind::Drag { .. }
            | FieldKind::Friction { .. }
            | FieldKind::Zone { .. }
            | FieldKind::Buoyancy { .. }
            | FieldKind::Custom { .. } => Ok(()),
        }
    }

    /// Refuses parameters out of range and unknown bodies and custom forces. A field that was added passes for as long as its
    /// bodies exist, also if they have changed.
    pub(crate) fn check_values(&self, bodies: &Bodies<S>, custom_forces: &CustomForces<S>) -> Result<(), Error> {
        let attachment = |a: &Attachment<S>| {
            bodies.find(a.body)?;
            check(within(a.point, limits::SIZE_MAX), Quantity::Position)
        };
        let end = |e: &End<S>| match e {
            End::World(point) => check(within(*point, limits::POSITION), Quantity::Position),
            End::Body(a) => attachment(a),
        };
        match &self.kind {
            FieldKind::Attractor { centre, mu, softening } => {
                end(centre)?;
                let max = S::Factor::from_ratio(1 << 32, 1);
                check(S::Factor::ZERO <= *mu && *mu <= max.times(max), Quantity::Mu)?;
                let soft = *softening >= S::ZERO && *softening <= S::from_fx(limits::SIZE_MAX);
                check(soft, Quantity::Softening)
            }
            FieldKind::Spring { near, far, spring } => {
                attachment(near)?;
                end(far)?;
                if matches!(far, End::Body(a) if a.body == near.body) {
                    return Err(Error::SameBody { body: near.body });
                }
                let rest = not_negative(spring.rest) && spring.rest <= S::from_fx(limits::POSITION);
                check(rest, Quantity::RestLength)?;
                check(not_negative(spring.stiffness), Quantity::Stiffness)?;
                check(not_negative(spring.damping), Quantity::Drag)
            }
            FieldKind::Drag { linear, quadratic, wind } => {
                check(not_negative(*linear) && not_negative(*quadratic), Quantity::Drag)?;
                check_velocity(*wind)
            }
            FieldKind::Friction { deceleration, angular_deceleration } => {
                let is_within = |rate: S| rate >= S::ZERO && rate <= S::from_fx(limits::GRAVITY);
                check(is_within(*deceleration) && is_within(*angular_deceleration), Quantity::Deceleration)
            }
            FieldKind::Thrust { at, force } => {
                attachment(at)?;
                check(force.is_finite(), Quantity::Force)
            }
            FieldKind::Zone { region, acceleration } => {
                let placed = match *region {
                    Region::Disc { centre, radius } => {
                        within(centre, limits::POSITION)
                            && not_negative(radius)
                            && radius <= S::from_fx(limits::POSITION)
                    }
                    Region::Box { min, max } => within(min, limits::POSITION) && within(max, limits::POSITION),
                };
                check(placed, Quantity::Position)?;
                check(within(*acceleration, limits::GRAVITY), Quantity::Gravity)
            }
            FieldKind::Buoyancy { min, max, density, linear_drag, angular_drag, flow } => {
                let is_box = min.x <= max.x && min.y <= max.y;
                check(is_box && within(*min, limits::POSITION) && within(*max, limits::POSITION), Quantity::FluidBox)?;
                check(not_negative(*density), Quantity::ColliderDensity { value: density.to_fx() })?;
                check(not_negative(*linear_drag) && not_negative(*angular_drag), Quantity::Drag)?;
                check_velocity(*flow)
            }
            FieldKind::Custom { id } => custom_forces.get(id).map(drop).ok_or(Error::CustomForce { id: *id }),
        }
    }

    /// The part of the bodies' state that the field depends on. The damper of a spring is evaluated apart from its elastic
    /// force, and the drag of a fluid apart from its lift.
    pub(crate) fn depends_on(&self, custom_forces: &CustomForces<S>) -> Dependence {
        match &self.kind {
            FieldKind::Spring { spring, .. } if spring.damping != S::ZERO => Dependence::Velocity,
            FieldKind::Custom { id } => custom_forces.get(id).map_or(Dependence::Nothing, |custom| custom.depends_on()),
            kind if kind.has_drag() => Dependence::Velocity,
            FieldKind::Friction { .. } => Dependence::Velocity,
            FieldKind::Drag { .. }
            | FieldKind::Buoyancy { .. }
            | FieldKind::Zone { .. }
            | FieldKind::Spring { .. }
            | FieldKind::Attractor { .. }
            | FieldKind::Thrust { .. } => Dependence::Position,
        }
    }

    /// The same field with other bodies in place of those it names, as for the same things in another world; `None` where
    /// `map` gives none.
    ///
    /// ```
    /// use umbra_physics::{Attachment, BodyId, FieldKind, ForceField, vec2};
    ///
    /// let [old, new] = [1, 2].map(|slot| BodyId::from_parts(slot, 0));
    /// let engine = |body| FieldKind::Thrust { at: Attachment::centre(body), force: vec2(0, 1) };
    /// let field: ForceField = engine(old).into();
    /// assert_eq!(field.map_bodies(|body| (body == old).then_some(new)), Some(engine(new).into()));
    /// assert_eq!(field.map_bodies(|_| None), None);
    /// ```
    #[must_use]
    pub fn map_bodies(&self, map: impl Fn(BodyId) -> Option<BodyId>) -> Option<Self> {
        let attachment = |a: &Attachment<S>| Some(Attachment { body: map(a.body)?, ..*a });
        let kind = match self.kind {
            FieldKind::Attractor { centre, mu, softening } => {
                FieldKind::Attractor { centre: centre.map_body(&map)?, mu, softening }
            }
            FieldKind::Spring { near, far, spring } => {
                FieldKind::Spring { near: attachment(&near)?, far: far.map_body(&map)?, spring }
            }
            FieldKind::Thrust { at, force } => FieldKind::Thrust { at: attachment(&at)?, force },
            kind @ (FieldKind::Drag { .. }
            | FieldKind::Friction { .. }
            | FieldKind::Zone { .. }
            | FieldKind::Buoyancy { .. }
            | FieldKind::Custom { .. }) => kind,
        };
        Some(Self { kind, force_groups: self.force_groups })
    }

    /// The bodies at the ends of the field: two for a spring between bodies, at most one for other kinds.
    pub(crate) fn ends(&self) -> [Option<BodyId>; 2] {
        match &self.kind {
            FieldKind::Attractor { centre, .. } => [centre.body(), None],
            FieldKind::Spring { near, far, .. } => [Some(near.body), far.body()],
            FieldKind::Thrust { at, .. } => [Some(at.body), None],
            FieldKind::Drag { .. }
            | FieldKind::Friction { .. }
            | FieldKind::Zone { .. }
            | FieldKind::Buoyancy { .. }
            | FieldKind::Custom { .. } => [None, None],
        }
    }

    /// The bodies that the field is attached to.
    pub(crate) fn bodies(&self) -> impl Iterator<Item = BodyId> + use<S> {
        self.ends().into_iter().flatten()
    }
}
