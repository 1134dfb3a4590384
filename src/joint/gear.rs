//! Gears.

use super::parts::check;
use crate::codec::codec_plain;
use crate::error::{Error, Quantity};
use crate::limits;

/// Two gears that mesh, a chain, or a belt: with the teeth z of both, z₁·θ₁ + z₂·θ₂ stays as it is, for the angles θ of both bodies.
///
/// [`JointDef::gear`](crate::JointDef::gear) makes the definition. Wheels turn in opposite directions; with a negative number of teeth, of a ring with its
/// teeth inside or of a belt, in the same one. The sum is known exactly at any number of turns, so that a gear train keeps its ratio for ever; teeth
/// that are forced apart by more than half a tooth jump to the next one. A gear holds no points: both bodies have hinges or axles of their own.
///
/// ```
/// use umbra_physics::{BodyDef, JointDef, JointMotor, Mass, World, WorldDef, fx, vec2};
///
/// let mut world = World::new(WorldDef::default())?;
/// let mass = Mass::Explicit { mass: fx!(1), inertia: fx!(1) };
/// let [small, large] = [0, 4].map(|x| world.add_body(BodyDef { position: vec2(x, 0), mass, ..BodyDef::dynamic() }));
/// let (small, large) = (small?, large?);
/// let axle = world.add_joint(JointDef::at(&world, None, small, vec2(0, 0))?)?;
/// world.add_joint(JointDef::at(&world, None, large, vec2(4, 0))?)?;
/// world.add_joint(JointDef::gear(&world, small, large, [12, 36])?)?;
/// world.set_joint_motor(axle, Some(JointMotor { speed: fx!(3), max_force: fx!(100) }))?;
/// (0..60).for_each(|_| _ = world.step());
/// assert!((world.body(large)?.angular_velocity() + fx!(1)).abs() < fx!(0.0001));
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Gear {
    /// The teeth of the first and of the second body, from 1 to [`limits::TEETH`] = 1,024 or negative.
    pub teeth: [i16; 2],
}

codec_plain!(Gear { teeth });

impl Gear {
    /// Refuses numbers of teeth out of range.
    pub(super) fn check(self) -> Result<(), Error> {
        self.teeth.into_iter().try_for_each(check_teeth)
    }
}

/// Refuses a number of teeth out of range.
pub(super) fn check_teeth(teeth: i16) -> Result<(), Error> {
    check(teeth != 0 && teeth.unsigned_abs() <= limits::TEETH, Quantity::Teeth)
}
