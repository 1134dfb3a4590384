//! Joints as data.

use super::JointKind;
use super::parts::check;
use crate::body::{Bodies, BodyKind, check_angle};
use crate::codec::codec_struct;
use crate::error::{Error, Quantity};
use crate::force::End;
use crate::fx::Fx;
use crate::limits;
use crate::scalar::Scalar;
use crate::slots::BodyId;

/// A joint to be added to a world with [`World::add_joint`](crate::World::add_joint): two ends and what it keeps of them.
///
/// [`JointDef::at`] and [`JointDef::between`] make the definition from points of the world; change what differs.
///
/// ```
/// use umbra_physics::{BodyDef, Event, JointDef, World, WorldDef, fx, vec2};
///
/// let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
/// let lamp = world.add_body(BodyDef { position: vec2(0, -2), ..BodyDef::dynamic() })?;
/// // A lamp of 1 kg on a rod of 2 m, which carries no more than 15 N.
/// let rod = JointDef::between(&world, None, vec2(0, 0), lamp, vec2(0, -2))?;
/// let rod = world.add_joint(JointDef { break_force: Some(fx!(15)), events: true, ..rod })?;
/// (0..60).for_each(|_| _ = world.step());
/// assert!((world.joint(rod)?.force().length() - fx!(10)).abs() < fx!(0.1));
///
/// world.apply_impulse(lamp, vec2(0, -1))?;
/// let broke = world.step().into_iter().any(|event| matches!(event, Event::JointBroke(broke) if broke.joint == rod));
/// assert!(broke && world.joint(rod)?.is_broken());
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[doc(alias("GenericJointBuilder", "JointBuilder"))]
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct JointDef<S = Fx> {
    /// The two ends: points of two bodies, or of a body and of the world. At least one of the bodies is dynamic when the joint is added.
    pub ends: [End<S>; 2],
    /// The angle of the joint's frame in the axes of each end, rad. [`JointRef::angle`](crate::JointRef::angle) is the angle from the first
    /// frame to the second one.
    pub angles: [S; 2],
    /// The kind, with its values.
    pub kind: JointKind<S>,
    /// True if the two bodies touch each other all the same, as [`JointDef::pulley`] has it. False by default: then they are excluded from contacts
    /// as long as the joint is there, enabled and not broken.
    pub collide_connected: bool,
    /// False for a joint that does nothing until [`World::enable_joint`](crate::World::enable_joint); true by default.
    pub enabled: bool,
    /// The mean force over a step, N, above which the joint breaks; from 0. `None` by default: it never does.
    pub break_force: Option<S>,
    /// The mean [torque](crate::JointRef::torque) over a step, N·m, above which the joint breaks; from 0. `None` by default: it never does.
    pub break_torque: Option<S>,
    /// True if steps report when the joint breaks, and its mean [load](crate::StepReport::joint_loads) if it may break; false by default.
    pub events: bool,
    /// A key of your own: joints are listed and reported by it.
    pub key: u64,
    /// Data of your own, which the engine only keeps.
    pub user_data: u64,
}

codec_struct!(JointDef {
    ends,
    angles,
    kind,
    collide_connected,
    enabled,
    break_force,
    break_torque,
    events,
    key,
    user_data
});

/// Refuses a force or a torque at which a joint cannot break.
pub(crate) fn check_break<S: Scalar>(force: Option<S>) -> Result<(), Error> {
    check(force.is_none_or(|force| force >= S::ZERO && force.is_finite()), Quantity::BreakForce)
}

impl<S: Scalar> JointDef<S> {
    /// A joint of this kind between two ends, with frames along the axes of both.
    ///
    /// ```
    /// use umbra_physics::{Attachment, BodyDef, End, JointDef, JointKind, World, WorldDef, vec2};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let wheel = world.add_body(BodyDef::dynamic())?;
    /// let ends = [End::World(vec2(0, 0)), End::Body(Attachment::centre(wheel))];
    /// let axle = world.add_joint(JointDef::new(ends, JointKind::default()))?;
    /// assert_eq!(world.joint(axle)?.def().ends, ends);
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[must_use]
    pub fn new(ends: [End<S>; 2], kind: JointKind<S>) -> Self {
        Self {
            ends,
            angles: [S::ZERO; 2],
            kind,
            collide_connected: false,
            enabled: true,
            break_force: None,
            break_torque: None,
            events: false,
            key: 0,
            user_data: 0,
        }
    }

    /// Refuses a joint that a world cannot add.
    pub(crate) fn check(&self, bodies: &Bodies<S>) -> Result<(), Error> {
        self.check_values(bodies)?;
        let is_dynamic = |body: BodyId| bodies.find(body).is_ok_and(|i| bodies.info(i).kind == BodyKind::Dynamic);
        let any_dynamic = self.bodies().into_iter().flatten().any(is_dynamic);
        if any_dynamic { Ok(()) } else { Err(Error::NothingToMove) }
    }

    /// Refuses values out of range and unknown bodies. A joint that was added passes for as long as its bodies exist, also if they have
    /// changed.
    pub(crate) fn check_values(&self, bodies: &Bodies<S>) -> Result<(), Error> {
        for end in &self.ends {
            match end {
                End::World(point) => check(point.is_within(S::from_fx(limits::POSITION)), Quantity::Position)?,
                End::Body(attachment) => {
                    bodies.find(attachment.body)?;
                    check(attachment.point.is_within(S::from_fx(limits::SIZE_MAX)), Quantity::JointPoint)?;
                }
            }
        }
        if let [Some(first), Some(second)] = self.bodies() {
            if first == second {
                return Err(Error::SameBody { body: first });
            }
        }
        self.angles.iter().try_for_each(|&angle| check_angle(angle))?;
        self.kind.check()?;
        check_break(self.break_force)?;
        check_break(self.break_torque)
    }

    /// The bodies at the ends.
    pub(crate) fn bodies(&self) -> [Option<BodyId>; 2] {
        [self.ends[0].body(), self.ends[1].body()]
    }

    /// Returns the joint with other bodies in place of the bodies that it names, as in another world; `None` where `map` gives none.
    pub(crate) fn map_bodies(&self, map: impl Fn(BodyId) -> Option<BodyId>) -> Option<Self> {
        let [first, second] = self.ends;
        Some(Self { ends: [first.map_body(&map)?, second.map_body(&map)?], ..*self })
    }
}
