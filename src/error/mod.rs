//! Reasons why a call is refused, and faults of bodies in a step.

mod fault;
mod quantity;

use core::fmt;

use crate::codes::codes;
use crate::slots::{BodyId, ColliderId, FieldId, JointId};

pub use fault::{Cause, Fault};
pub use quantity::{Dimension, Quantity};

/// Reason why a call was refused. The world is unchanged by a refused call.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
pub enum Error {
    /// A value is outside the range of its kind: the message of [`Quantity`] has the range.
    OutOfRange {
        /// Kind of the value.
        quantity: Quantity,
    },
    /// The handle names no body: it was removed, or never in this world.
    NoSuchBody {
        /// The handle.
        body: BodyId,
    },
    /// The handle names no force field.
    NoSuchField {
        /// The handle.
        field: FieldId,
    },
    /// A time step is num/den seconds with den/num between 1 and 10,000 steps a second.
    TimeStep,
    /// A polygon's corner is not convex, or repeats its neighbour.
    NotConvex {
        /// Index of the corner in the given list.
        corner: usize,
    },
    /// The call needs a dynamic body.
    NotDynamic {
        /// The body.
        body: BodyId,
    },
    /// A static body has no velocity.
    NotMovable {
        /// The body.
        body: BodyId,
    },
    /// The body is quarantined: set its state and release it first.
    Quarantined {
        /// The body.
        body: BodyId,
    },
    /// The body is not quarantined, so there is nothing to release.
    NotQuarantined {
        /// The body.
        body: BodyId,
    },
    /// `Yoshida4` runs its middle sub-step backwards, which is impossible with a damping that leaves nothing of a velocity.
    DampingHasNoInverse,
    /// One body is named twice, where two are needed: at both ends of a spring or joint, in a pair to exclude.
    SameBody {
        /// The body.
        body: BodyId,
    },
    /// No custom force with this id is registered, or one is registered already.
    CustomForce {
        /// The id.
        id: u64,
    },
    /// The world already has the maximum number of bodies, colliders, outlines of colliders, force fields or joints, 2^24 each, of
    /// excluded pairs, 2^16, or of pairs of materials, 2^12.
    Full,
    /// The elapsed time no longer fits in a ratio of 128-bit integers: too many different time steps or speeds were used.
    ElapsedTime,
    /// The parts of a snapshot contradict each other.
    Inconsistent,
    /// The tick already has an input of this player and sequence.
    DuplicateInput {
        /// The player.
        player: u32,
        /// The sequence.
        sequence: u32,
    },
    /// The tick is confirmed or recorded already.
    TickForgotten {
        /// The tick that was asked for.
        tick: u64,
        /// The first tick that is not.
        oldest: u64,
    },
    /// The tick is too far in the future.
    TickToCome {
        /// The tick that was asked for.
        tick: u64,
        /// The tick that is made or recorded next.
        present: u64,
    },
    /// The rollback has no player with this number.
    NoSuchPlayer {
        /// The player.
        player: u32,
    },
    /// The world was changed between two ticks of a rollback. The change would be lost when an earlier tick is made again.
    ChangedBetweenTicks {
        /// The tick that was to be made.
        tick: u64,
    },
    /// The tick function of a rollback stepped or restored the world.
    SteppedInTick {
        /// The tick.
        tick: u64,
    },
    /// The last step cannot be undone.
    NotReversible {
        /// The reason.
        why: Irreversible,
    },
    /// The body is locked along an axis of a velocity.
    Locked {
        /// The velocity: linear or angular.
        quantity: Quantity,
    },
    /// The body is disabled: enable it first.
    Disabled {
        /// The body.
        body: BodyId,
    },
    /// The body is not disabled, so there is nothing to enable.
    NotDisabled {
        /// The body.
        body: BodyId,
    },
    /// The call needs a kinematic body.
    NotKinematic {
        /// The body.
        body: BodyId,
    },
    /// The handle names no collider: it or its body was removed, or it was never in this world.
    NoSuchCollider {
        /// The handle.
        collider: ColliderId,
    },
    /// A chain is a surface of static and kinematic bodies. The body is dynamic, or would become so.
    DynamicChain,
    /// Two segments of a chain, or two sides of a concave polygon, cross or touch each other.
    ChainCrosses {
        /// The segments or sides, each by the number of the point that it begins at.
        segments: [usize; 2],
    },
    /// The handle names no joint: it or one of its bodies was removed, or it was never in this world.
    NoSuchJoint {
        /// The handle.
        joint: JointId,
    },
    /// The joint is of a kind that has no motor.
    NoMotor {
        /// The handle.
        joint: JointId,
    },
    /// Neither end of the joint is on a dynamic body.
    NothingToMove,
    /// Sleeping is off in the world: set `sleep_after` first.
    SleepIsOff,
    /// A kinematic body that moves touches the body's island, or is joined to it, and would wake it.
    KeptAwake {
        /// The kinematic body.
        kinematic: BodyId,
    },
}

/// Reason why a step cannot be undone.
///
/// ```
/// use umbra_physics::{Damping, Error, Irreversible, World, WorldDef, fx};
///
/// let linear_damping = Damping::rate(fx!(0.5));
/// let mut world = World::new(WorldDef { linear_damping, sleep_after: None, ..WorldDef::default() })?;
/// world.add_body(umbra_physics::BodyDef::dynamic())?;
/// world.step();
/// assert_eq!(world.step_back(&[]), Err(Error::NotReversible { why: Irreversible::Damping }));
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
#[non_exhaustive]
pub enum Irreversible {
    /// The world's scalar is a float type, whose sums round.
    Scalar,
    /// The integrator has no inverse: [`Integrator::inverse`](crate::Integrator::inverse).
    Integrator,
    /// The world is at tick 0: no step has been taken yet.
    Start,
    /// The time step was changed at this tick, and the one before is no longer known.
    TimeStep,
    /// Sleeping is on: the number of ticks a body was at rest before is not known.
    Sleep,
    /// A body is damped: the bits that damping rounds away are lost.
    Damping,
    /// The force of a field depends on the velocity: drag, a spring with a damper, or a custom force that says so.
    Velocity {
        /// The field.
        field: FieldId,
    },
    /// A body is quarantined: its motion in the last step is not known.
    Quarantined {
        /// The body.
        body: BodyId,
    },
    /// Forces were applied for the next step; [`clear_forces`](crate::World::clear_forces) takes them back.
    Pending,
    /// The list of applied forces names a body twice.
    Twice {
        /// The body.
        body: BodyId,
    },
    /// A body would leave the allowed range on the way back, or a force does not fit: no step led to this state.
    Fault(Fault),
    /// The speed of a dynamic body is limited: its speed before the limit was applied is not known.
    Capped,
    /// A kinematic body reached a target in the last step, or stopped there, or has a target for the next step.
    Moved,
    /// The world is at the [last tick](crate::limits::TICK), where steps are no longer counted.
    End,
    /// Colliders pushed each other in the last step or in the one before, or another case of contacts was met that
    /// [`World::step_back`](crate::World::step_back) lists: the state of contacts before is not known.
    Contact,
    /// A joint had an impulse in the last step or in the one before, or broke: what it had before is not known.
    Joint,
}

codes!(Irreversible {
    Scalar = 131,
    Integrator = 132,
    Start = 133,
    TimeStep = 134,
    Sleep = 135,
    Damping = 136,
    Velocity = 137,
    Quarantined = 138,
    Pending = 139,
    Twice = 140,
    Fault = 141,
    Capped = 142,
    Moved = 143,
    End = 144,
    Contact = 145,
    Joint = 146,
});

impl core::error::Error for Irreversible {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::Fault(fault) => Some(&fault.cause),
            _ => None,
        }
    }
}

impl fmt::Display for Irreversible {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scalar => f.write_str("the world computes in floats, whose sums round"),
            Self::Integrator => f.write_str("the integrator has no inverse"),
            Self::Start => f.write_str("no step has been taken yet"),
            Self::TimeStep => f.write_str("the time step was changed at this tick"),
            Self::Sleep => f.write_str("sleeping is on: set sleep_after to None"),
            Self::Damping => f.write_str("a body is damped"),
            Self::Velocity { field } => write!(f, "the force of {field} depends on the velocity"),
            Self::Quarantined { body } => write!(f, "{body} is quarantined"),
            Self::Pending => f.write_str("forces were applied for the next step: clear them first"),
            Self::Twice { body } => write!(f, "the list of applied forces names {body} twice"),
            Self::Fault(fault) => write!(f, "on the way back {} is out of range: {}", fault.body, fault.cause),
            Self::Capped => f.write_str("the speed of a body is limited"),
            Self::Moved => f.write_str("a kinematic body was moved to a target, or stopped there"),
            Self::End => f.write_str("the world is at the last tick, 2^63"),
            Self::Contact => f.write_str(
                "in the last two steps colliders pushed each other, or a sensor, a one-way collider or an excluded pair changed",
            ),
            Self::Joint => f.write_str("in the last two steps a joint pulled or broke"),
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::OutOfRange { quantity } => write!(f, "out of range: expected {quantity}"),
            Self::NoSuchBody { body } => write!(f, "no such body: {body}"),
            Self::NoSuchField { field } => write!(f, "no such force field: {field}"),
            Self::TimeStep => f.write_str("the time step must be num/den seconds, from 1 to 10,000 steps a second"),
            Self::NotConvex { corner } => write!(
                f,
                "corner {corner} is not convex, or repeats its neighbour: list the corners of a convex polygon in order",
            ),
            Self::NotDynamic { body } => write!(f, "{body} is not dynamic: the call needs a dynamic body"),
            Self::NotMovable { body } => write!(f, "{body} is static and has no velocity"),
            Self::Quarantined { body } => write!(f, "{body} is quarantined: release it first"),
            Self::NotQuarantined { body } => write!(f, "{body} is not quarantined"),
            Self::DampingHasNoInverse => f.write_str("Yoshida4 needs damping that keeps more than 2^-33 of a velocity a second: a rate below 22.87"),
            Self::SameBody { body } => write!(f, "{body} is named twice: two different bodies are needed"),
            Self::CustomForce { id } => write!(f, "custom force {id:#x} is not registered, or is registered already"),
            Self::Full => {
                f.write_str("the world already has the maximum number of bodies, colliders, outlines of colliders, force fields or joints (16,777,216 each), of excluded pairs (65,536), or of pairs of materials (4,096)")
            },
            Self::Inconsistent => f.write_str("the parts of the snapshot contradict each other"),
            Self::ElapsedTime => f.write_str(
                "the elapsed time no longer fits in a ratio of 128-bit integers: use fewer different time steps or speeds",
            ),
            Self::DuplicateInput { player, sequence } => {
                write!(f, "player {player} already has an input with sequence {sequence} in this tick")
            },
            Self::TickForgotten { tick, oldest } => {
                write!(f, "tick {tick} is confirmed or recorded already: the first that is not is tick {oldest}")
            },
            Self::TickToCome { tick, present } => {
                write!(f, "tick {tick} is too far in the future: the next one is tick {present}")
            },
            Self::NoSuchPlayer { player } => write!(f, "the rollback has no player {player}: name all players at its start"),
            Self::ChangedBetweenTicks { tick } => write!(
                f,
                "the world was changed before tick {tick}, outside of the tick function: make all changes in it, or restart the rollback",
            ),
            Self::SteppedInTick { tick } => write!(
                f,
                "the tick function stepped or restored the world in tick {tick}: the rollback steps it after the function",
            ),
            Self::NotReversible { why } => write!(f, "the step cannot be undone: {why}"),
            Self::Disabled { body } => write!(f, "{body} is disabled: enable it first"),
            Self::NotDisabled { body } => write!(f, "{body} is not disabled"),
            Self::NotKinematic { body } => write!(f, "{body} is not kinematic: the call needs a kinematic body"),
            Self::NoSuchCollider { collider } => write!(f, "no such collider: {collider}"),
            Self::DynamicChain => {
                f.write_str("a chain cannot be on a dynamic body: make the body static or kinematic, or give it another shape")
            },
            Self::ChainCrosses { segments: [a, b] } => {
                write!(f, "segments {a} and {b} of the chain or the concave polygon cross or touch: it may not meet itself")
            },
            Self::NoSuchJoint { joint } => write!(f, "no such joint: {joint}"),
            Self::NothingToMove => {
                f.write_str("neither end of the joint is on a dynamic body: a joint needs a body that it can move")
            }
            Self::SleepIsOff => f.write_str("sleeping is off in the world: set sleep_after"),
            Self::KeptAwake { kinematic } => {
                write!(f, "{kinematic} moves, and touches the bodies that were to sleep or is joined to them: stop it first")
            }
            Self::NoMotor { joint } => write!(f, "a joint without a motor of this kind: {joint}"),
            Self::Locked { quantity: Quantity::AngularVelocity } => f.write_str("the rotation of the body is locked"),
            Self::Locked { .. } => f.write_str("the body is locked along an axis of the velocity"),
        }
    }
}

codes!(Error {
    OutOfRange = 101,
    NoSuchBody = 102,
    NoSuchField = 103,
    TimeStep = 104,
    NotConvex = 105,
    NotDynamic = 107,
    NotMovable = 108,
    Quarantined = 109,
    NotQuarantined = 110,
    DampingHasNoInverse = 111,
    SameBody = 112,
    CustomForce = 113,
    Full = 114,
    ElapsedTime = 115,
    Inconsistent = 116,
    DuplicateInput = 117,
    TickForgotten = 118,
    TickToCome = 119,
    NotReversible = 120,
    Locked = 121,
    Disabled = 122,
    NotDisabled = 123,
    NotKinematic = 124,
    NoSuchPlayer = 125,
    ChangedBetweenTicks = 126,
    SteppedInTick = 127,
    NoSuchCollider = 128,
    DynamicChain = 129,
    ChainCrosses = 130,
    NoSuchJoint = 147,
    NothingToMove = 148,
    NoMotor = 214,
    SleepIsOff = 218,
    KeptAwake = 219,
});

impl core::error::Error for Error {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            // Nothing is wrong with the range of what a lock forbids.
            Self::OutOfRange { quantity } => Some(quantity),
            Self::NotReversible { why } => Some(why),
            _ => None,
        }
    }
}
