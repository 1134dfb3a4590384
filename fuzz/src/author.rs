//! Commands from the bytes of an input, fair ones and unfair ones: for any scalar, and for the image of a run.
//!
//! Two authors over the same bytes write the same commands, each for its own scalar and its own image, as long as their
//! worlds give out the same handles.

use std::marker::PhantomData;
use std::sync::Arc;

use arbitrary::{Arbitrary, Result, Unstructured};
use umbra_physics::scalar::Factor;
use umbra_physics::{
    ApplyOptions, Attachment, BodyDef, BodyId, BodyKind, BodyState, Command, Created, CustomForce, CustomForceError,
    Dependence, End, FieldId, FieldKind, ForceField, ForceOrImpulse, ForceTorque, Frame, Fx, FxFactor, Integrator,
    Locks, Mass, Part, Random, Region, Scalar, Shape, SpringConstants, TimeStep, Vec2, World, WorldDef, fx, limits,
};

/// Image of a run: mirrored about x = 0 or not, then shifted.
#[derive(Clone, Copy, Debug, Default)]
pub struct Image {
    /// True if left and right are exchanged.
    pub is_mirrored: bool,
    /// By so much; an even number of ulps.
    pub shift: Vec2,
}

impl Image {
    fn sign(&self, value: Fx) -> Fx {
        if self.is_mirrored { -value } else { value }
    }
}

/// Writes commands.
pub struct Author<'a, S: Scalar = Fx> {
    pub input: Unstructured<'a>,
    image: Image,
    /// True if all values are fair: everyday sizes, nothing near a limit, no damping that stops at once.
    is_tame: bool,
    bodies: Vec<BodyId>,
    fields: Vec<FieldId>,
    /// The largest coordinate of a point of the world so far, in ulps.
    pub farthest: u64,
    scalar: PhantomData<S>,
}

/// Values that are not everyday ones: ends of ranges, and a number of bits to look beyond.
const EDGES: [Fx; 12] = [
    Fx::ZERO,
    Fx::DELTA,
    limits::POSITION,
    limits::SPEED,
    limits::GRAVITY,
    limits::GRAVITY_SCALE,
    limits::MASS_MIN,
    limits::MASS_MAX,
    limits::SIZE_MIN,
    limits::SIZE_MAX,
    Fx::ONE,
    Fx::MAX,
];

impl<'a, S: Scalar> Author<'a, S> {
    pub fn new(data: &'a [u8], image: Image) -> Self {
        Self {
            input: Unstructured::new(data),
            image,
            is_tame: false,
            bodies: Vec::new(),
            fields: Vec::new(),
            farthest: 0,
            scalar: PhantomData,
        }
    }

    /// An author who is fair throughout.
    pub fn tame(data: &'a [u8]) -> Self {
        Self { is_tame: true, ..Self::new(data, Image::default()) }
    }

    pub fn any<T: Arbitrary<'a>>(&mut self) -> Result<T> {
        self.input.arbitrary()
    }

    fn below(&mut self, count: u8) -> Result<u8> {
        Ok(self.any::<u8>()? % count)
    }

    fn one_in(&mut self, count: u8) -> Result<bool> {
        Ok(self.below(count)? == 0)
    }

    /// Mostly between the two: with few bits, so that sums of it come to ties, or with many; else one of any size. Never
    /// the least number there is, which has no opposite.
    fn number(&mut self, low: Fx, high: Fx) -> Result<Fx> {
        let range = high.to_bits().abs_diff(low.to_bits()).max(1);
        let style = self.below(16)?;
        let bits = match style {
            0..8 => {
                let step = (range / 256).next_power_of_two().max(1);
                low.to_bits().saturating_add_unsigned(u64::from(self.any::<u8>()?) * step)
            }
            8..14 => low.to_bits().saturating_add_unsigned(self.any::<u64>()? % (range + 1)),
            _ if self.is_tame => low.to_bits(),
            14 => {
                let edge = EDGES[usize::from(self.below(EDGES.len() as u8)?)].to_bits();
                let near = edge.saturating_add(i64::from(self.any::<u8>()? % 5) - 2);
                if self.any()? { near } else { near.saturating_neg() }
            }
            _ => self.any::<i64>()? >> (self.any::<u8>()? % 64),
        };
        let bits = if self.is_tame { bits.clamp(low.to_bits(), high.to_bits()) } else { bits.max(-i64::MAX) };
        Ok(Fx::from_bits(bits))
    }

    fn scalar(&mut self, low: Fx, high: Fx) -> Result<S> {
        self.number(low, high).map(S::from_fx)
    }

    fn pair(&mut self, size: Fx) -> Result<Vec2> {
        Ok(Vec2::new(self.number(-size, size)?, self.number(-size, size)?))
    }

    /// A velocity, force, impulse or acceleration; or a point of a body.
    fn vector(&mut self, size: Fx) -> Result<Vec2<S>> {
        let Vec2 { x, y } = self.pair(size)?;
        Ok(Vec2::new(S::from_fx(self.image.sign(x)), S::from_fx(y)))
    }

    fn point(&mut self, size: Fx) -> Result<Vec2<S>> {
        let point = self.pair(size)?;
        Ok(self.seen(point))
    }

    /// The image of a point of the world.
    fn seen(&mut self, Vec2 { x, y }: Vec2) -> Vec2<S> {
        self.farthest = self.farthest.max(x.to_bits().unsigned_abs()).max(y.to_bits().unsigned_abs());
        let Vec2 { x: right, y: up } = self.image.shift;
        Vec2::new(S::from_fx(self.image.sign(x).saturating_add(right)), S::from_fx(y.saturating_add(up)))
    }

    /// An angle, angular velocity, torque or angular impulse.
    fn pseudo(&mut self, size: Fx) -> Result<S> {
        let value = self.number(-size, size)?;
        Ok(S::from_fx(self.image.sign(value)))
    }

    /// Fraction left after a second.
    fn share(&mut self) -> Result<S> {
        Ok(match self.below(8)? {
            0..4 => S::ONE,
            4 if !self.is_tame => S::ZERO,
            _ => self.scalar(fx!(0.5), fx!(1))?,
        })
    }

    pub fn time_step(&mut self) -> Result<TimeStep> {
        Ok(match self.below(8)? {
            0..3 => TimeStep::hz(60),
            3 => TimeStep::hz(64),
            4 => TimeStep::ratio(1001, 60_000),
            5 => TimeStep::hz(144),
            _ if self.is_tame => TimeStep::hz(50),
            6 => TimeStep::hz([1, 10_000][usize::from(self.below(2)?)]),
            _ => TimeStep::ratio(self.any()?, self.any()?),
        })
    }

    fn integrator(&mut self) -> Result<Integrator> {
        Ok(Integrator::ALL[usize::from(self.below(Integrator::ALL.len() as u8)?)])
    }

    fn ticks_to_sleep(&mut self) -> Result<Option<u32>> {
        Ok(match self.below(8)? {
            _ if self.is_tame => None,
            0 => None,
            1..4 => Some(1),
            4..6 => Some(3),
            6 => Some(30),
            _ => Some(self.any()?),
        })
    }

    pub fn world(&mut self) -> Result<WorldDef<S>> {
        Ok(WorldDef {
            time_step: self.time_step()?,
            gravity: if self.any()? { Vec2::ZERO } else { self.vector(fx!(10))? },
            integrator: self.integrator()?,
            linear_damping: self.share()?,
            angular_damping: self.share()?,
            sleep_after: self.ticks_to_sleep()?,
        })
    }

    fn size(&mut self) -> Result<S> {
        self.scalar(fx!(0.125), fx!(2))
    }

    fn shape(&mut self) -> Result<Option<Shape<S>>> {
        // Which polygons are convex, a coarser scalar sees otherwise.
        let shape = match self.below(if self.is_tame { 4 } else { 8 })? {
            0 | 1 => return Ok(None),
            2 => Shape::circle(self.size()?),
            3 => Shape::rectangle(self.size()?, self.size()?),
            4 => Shape::capsule(self.size()?, self.size()?),
            5 => Shape::segment(self.vector(fx!(2))?, self.vector(fx!(2))?),
            6 => {
                let mut corners = Vec::new();
                for _ in 0..3 + self.below(3)? {
                    corners.push(self.vector(fx!(3))?);
                }
                Shape::polygon(&corners)
            }
            _ => {
                let mut parts = Vec::new();
                for _ in 0..1 + self.below(3)? {
                    let shape = match self.below(3)? {
                        0 => Shape::circle(self.size()?),
                        1 => Shape::rectangle(self.size()?, self.size()?),
                        _ => Shape::segment(self.vector(fx!(2))?, self.vector(fx!(2))?),
                    };
                    let (position, angle) = (self.vector(fx!(2))?, self.pseudo(fx!(7))?);
                    let density = self.scalar(fx!(0.5), fx!(4))?;
                    parts.extend(shape.ok().map(|shape| Part { shape, position, angle, density }));
                }
                Shape::compound(&parts)
            }
        };
        Ok(shape.ok())
    }

    fn mass(&mut self) -> Result<Mass<S>> {
        Ok(match self.below(4)? {
            0 if !self.is_tame => Mass::Density(self.scalar(fx!(0.25), fx!(4))?),
            0 | 1 => Mass::Kilograms(self.scalar(fx!(0.5), fx!(4))?),
            _ => Mass::Explicit { mass: self.scalar(fx!(0.5), fx!(4))?, inertia: self.scalar(fx!(0.5), fx!(4))? },
        })
    }

    fn kind(&mut self) -> Result<BodyKind> {
        Ok(match self.below(8)? {
            0 => BodyKind::Static,
            1 => BodyKind::Kinematic,
            _ => BodyKind::Dynamic,
        })
    }

    fn groups(&mut self) -> Result<u32> {
        Ok(match self.below(4)? {
            0 => self.any()?,
            _ => 1,
        })
    }

    fn own_share(&mut self) -> Result<Option<S>> {
        if self.one_in(3)? { self.share().map(Some) } else { Ok(None) }
    }

    /// None for the most part.
    fn locks(&mut self) -> Result<Locks> {
        let bits = if self.one_in(4)? { self.any::<u8>()? } else { 0 };
        Ok(Locks { x: bits & 1 == 1, y: bits & 2 == 2, rotation: bits & 4 == 4 })
    }

    /// A largest speed, or none.
    fn most(&mut self) -> Result<Option<S>> {
        if self.one_in(8)? { self.scalar(fx!(0), fx!(4)).map(Some) } else { Ok(None) }
    }

    /// Definition of a body. Half of them are at rest, to fall asleep.
    pub fn body(&mut self) -> Result<BodyDef<S>> {
        let kind = self.kind()?;
        let is_still = kind == BodyKind::Static || self.any()?;
        // Half of those that are locked have a velocity nonetheless, and are refused.
        let locks = if is_still || self.one_in(16)? { self.locks()? } else { Locks::NONE };
        Ok(BodyDef {
            kind,
            position: self.point(fx!(20))?,
            angle: self.pseudo(fx!(9))?,
            velocity: if is_still { Vec2::ZERO } else { self.vector(fx!(3))? },
            angular_velocity: if is_still { S::ZERO } else { self.pseudo(fx!(3))? },
            shape: self.shape()?,
            mass: self.mass()?,
            gravity_scale: if self.any()? { S::ONE } else { self.scalar(fx!(-1), fx!(2))? },
            linear_damping: self.own_share()?,
            angular_damping: self.own_share()?,
            max_speed: self.most()?,
            max_angular_speed: self.most()?,
            locks,
            groups: self.groups()?,
            key: u64::from(self.below(4)?),
            user_data: u64::from(self.below(2)?),
        })
    }

    /// A body that there is or was; now and then one that never was.
    pub fn some_body(&mut self) -> Result<BodyId> {
        let index = self.any::<u8>()?;
        if self.bodies.is_empty() || (index == u8::MAX && !self.is_tame) {
            return Ok(BodyId::from_parts(index.into(), u32::from(index) % 3));
        }
        Ok(self.bodies[usize::from(index) % self.bodies.len()])
    }

    fn some_field(&mut self) -> Result<FieldId> {
        let index = self.any::<u8>()?;
        if self.fields.is_empty() || (index == u8::MAX && !self.is_tame) {
            return Ok(FieldId::from_parts(index.into(), u32::from(index) % 3));
        }
        Ok(self.fields[usize::from(index) % self.fields.len()])
    }

    fn attachment(&mut self) -> Result<Attachment<S>> {
        let body = self.some_body()?;
        Ok(if self.any()? { Attachment::centre(body) } else { Attachment { body, point: self.vector(fx!(0.5))? } })
    }

    fn end(&mut self) -> Result<End<S>> {
        Ok(if self.any()? { End::World(self.point(fx!(20))?) } else { End::Body(self.attachment()?) })
    }

    fn field(&mut self) -> Result<ForceField<S>> {
        // A scalar may see a body inside a zone, and another outside.
        let kind = match self.below(if self.is_tame { 6 } else { 9 })? {
            0 => {
                let (centre, mu) = (self.end()?, self.number(fx!(0), fx!(5))?);
                let mu = S::Factor::from_scalar(S::from_fx(mu));
                FieldKind::Attractor { centre, mu, softening: self.scalar(fx!(0.5), fx!(2))? }
            }
            1 | 2 => {
                let (near, far) = (self.attachment()?, self.end()?);
                let spring = SpringConstants {
                    rest: self.scalar(fx!(0), fx!(3))?,
                    stiffness: self.scalar(fx!(0), fx!(5))?,
                    damping: if self.any()? { S::ZERO } else { self.scalar(fx!(0), fx!(1))? },
                };
                FieldKind::Spring { near, far, spring }
            }
            3 => {
                let (linear, quadratic) = (self.scalar(fx!(0), fx!(0.25))?, self.scalar(fx!(0), fx!(0.25))?);
                FieldKind::Drag { linear, quadratic, wind: self.vector(fx!(2))? }
            }
            4 => FieldKind::Thrust { at: self.attachment()?, force: self.vector(fx!(2))? },
            5 => FieldKind::Custom { id: u64::from(self.below(if self.is_tame { 2 } else { 3 })?) },
            6 | 7 => {
                let region = self.region()?;
                FieldKind::Zone { region, acceleration: self.vector(fx!(2))? }
            }
            _ => {
                let mu = FxFactor::from_ratio(self.any()?, 1);
                let mu = S::Factor::from_ratio(mu.parts().0, 1);
                FieldKind::Attractor { centre: self.end()?, mu, softening: self.scalar(fx!(0), fx!(2))? }
            }
        };
        Ok(ForceField { kind, groups: if self.any()? { u32::MAX } else { self.groups()? } })
    }

    fn region(&mut self) -> Result<Region<S>> {
        if self.any()? {
            return Ok(Region::Disc { centre: self.point(fx!(9))?, radius: self.scalar(fx!(1), fx!(9))? });
        }
        let (a, b) = (self.point(fx!(9))?, self.point(fx!(9))?);
        // The corners of the image are other ones: mirrored, the left one is on the right.
        let (min, max) = if self.image.is_mirrored { (Vec2::new(b.x, a.y), Vec2::new(a.x, b.y)) } else { (a, b) };
        Ok(Region::Box { min, max })
    }

    fn action(&mut self, frame: Frame) -> Result<ForceOrImpulse<S>> {
        let kind = self.below(4)?;
        let point = if self.any()? {
            Some(if frame == Frame::World { self.point(fx!(20))? } else { self.vector(fx!(2))? })
        } else {
            None
        };
        Ok(match kind {
            0 => ForceOrImpulse::Force { force: self.vector(fx!(30))?, point },
            1 => ForceOrImpulse::Torque(self.pseudo(fx!(5))?),
            2 => ForceOrImpulse::Impulse { impulse: self.vector(fx!(1))?, point },
            _ => ForceOrImpulse::AngularImpulse(self.pseudo(fx!(1))?),
        })
    }

    /// A command of any kind. Handles are those of what was [`made`](Self::made).
    pub fn command(&mut self) -> Result<Command<S>> {
        let kind = self.below(42)?;
        let body = self.some_body()?;
        Ok(match kind {
            0 => Command::RemoveBody(body),
            1 => Command::SetPosition { body, position: self.point(fx!(20))? },
            2 => Command::SetAngle { body, angle: self.pseudo(fx!(9))? },
            3 => Command::SetVelocity { body, velocity: self.vector(fx!(3))? },
            4 => Command::SetAngularVelocity { body, velocity: self.pseudo(fx!(3))? },
            5 => Command::SetMass { body, mass: self.mass()? },
            6 => Command::SetShape { body, shape: self.shape()? },
            7 => Command::SetKind { body, kind: self.kind()? },
            8 => Command::SetGravityScale { body, scale: self.scalar(fx!(-1), fx!(2))? },
            9 => Command::SetBodyDamping { body, linear: self.own_share()?, angular: self.own_share()? },
            10 => Command::SetGroups { body, groups: self.groups()? },
            11 => Command::SetKey { body, key: self.any()? },
            12 => Command::SetUserData { body, user_data: self.any()? },
            13 => Command::Wake(body),
            14 => Command::Release(body),
            15 => {
                let field = self.field()?;
                Command::SetField { id: self.some_field()?, field }
            }
            16 => Command::RemoveField(self.some_field()?),
            17 => Command::SetTimeStep(self.time_step()?),
            18 => Command::SetGravity(self.vector(fx!(10))?),
            19 => Command::SetIntegrator(self.integrator()?),
            20 => Command::SetDamping { linear: self.share()?, angular: self.share()? },
            21 => Command::SetRandom(Random::seeded(self.any()?)),
            22 => Command::SetBlob(vec![self.any()?; usize::from(self.below(9)?)]),
            23 => Command::ClearForces,
            24 => Command::SetSleepAfter(self.ticks_to_sleep()?),
            25..28 => Command::AddField(self.field()?),
            28..32 => {
                let frame = if self.any()? { Frame::World } else { Frame::Body };
                let action = self.action(frame)?;
                Command::Apply { body, action, manner: ApplyOptions { frame, wake: !self.one_in(4)? } }
            }
            32 => Command::SetLocks { body, locks: self.locks()? },
            33 => Command::SetMaxSpeeds { body, linear: self.most()?, angular: self.most()? },
            34 => Command::Disable(body),
            35 | 36 => Command::Enable(body),
            37 => Command::MoveTo { body, position: self.point(fx!(20))?, angle: self.pseudo(fx!(9))? },
            _ => Command::AddBody(self.body()?),
        })
    }

    /// Takes note of what a command made, for those that come.
    pub fn made(&mut self, made: Created) {
        match made {
            Created::Body(body) => self.bodies.push(body),
            Created::ForceField(field) => self.fields.push(field),
            Created::Nothing => {}
        }
    }
}

/// A law of force that every symmetry of a world leaves as it is: against the velocity, and none from a speed on.
struct Brake;

impl<S: Scalar> CustomForce<S> for Brake {
    fn id(&self) -> u64 {
        0
    }

    fn version(&self) -> u32 {
        1
    }

    fn depends_on(&self) -> Dependence {
        Dependence::Velocity
    }

    fn push(&self, body: &BodyState<S>) -> std::result::Result<ForceTorque<S>, CustomForceError> {
        let limit = S::from_fx(fx!(1000));
        let Vec2 { x, y } = body.velocity;
        if [x, y, body.angular_velocity].iter().any(|v| *v > limit || -*v > limit) {
            return Err(CustomForceError { code: 7 });
        }
        Ok(ForceTorque { force: Vec2::new(-x, -y), torque: -body.angular_velocity })
    }
}

/// A force law that is the same everywhere, also for mirror images.
struct Lift;

impl<S: Scalar> CustomForce<S> for Lift {
    fn id(&self) -> u64 {
        1
    }

    fn version(&self) -> u32 {
        3
    }

    fn depends_on(&self) -> Dependence {
        Dependence::Nothing
    }

    fn push(&self, body: &BodyState<S>) -> std::result::Result<ForceTorque<S>, CustomForceError> {
        Ok(ForceTorque { force: Vec2::new(S::ZERO, body.mass), torque: S::ZERO })
    }
}

/// The laws of force that worlds here have.
pub fn custom_forces<S: Scalar>() -> [Arc<dyn CustomForce<S>>; 2] {
    [Arc::new(Brake), Arc::new(Lift)]
}

/// A world with these laws, or none if it is refused.
pub fn world<S: Scalar>(def: WorldDef<S>) -> Option<World<S>> {
    let mut world = World::new(def).ok()?;
    for law in custom_forces() {
        world.register_custom_force(law).expect("each is registered once");
    }
    Some(world)
}
