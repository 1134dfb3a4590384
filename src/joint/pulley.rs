//! Pulleys.

use super::parts::check;
use crate::codec::codec_struct;
use crate::error::{Error, Quantity};
use crate::fx::Fx;
use crate::limits;
use crate::math::Vec2;
use crate::scalar::Scalar;
use crate::solve;

/// A rope from one body over two points of the world to another body, which pulls and does not push.
///
/// [`JointDef::pulley`](crate::JointDef::pulley) makes the definition. The rope has z₁·l₁ + z₂·l₂ of its length in use, for the distances l of
/// both ends from their points and the strands z between them: with two strands on one side, as of a block and tackle, the body there moves
/// half as far and is pulled twice as hard. [`JointRef::length`](crate::JointRef::length) is the length in use.
///
/// ```
/// use umbra_physics::{BodyDef, JointDef, Mass, World, WorldDef, fx, vec2};
///
/// let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
/// let mut load = |x: i32, mass: i32| {
///     let mass = Mass::Explicit { mass: mass.into(), inertia: fx!(1) };
///     world.add_body(BodyDef { position: vec2(x, 0), mass, ..BodyDef::dynamic() })
/// };
/// let (light, heavy) = (load(0, 1)?, load(2, 3)?);
/// let points = [vec2(0, 0), vec2(2, 0)];
/// let rope = JointDef::pulley(&world, [light, heavy], points, [vec2(0, 8), vec2(2, 8)], [1, 1])?;
/// let rope = world.add_joint(rope)?;
/// (0..60).for_each(|_| _ = world.step());
/// // g·(m₂ − m₁)/(m₁ + m₂)
/// assert!((world.body(light)?.velocity().y - fx!(5)).abs() < fx!(0.001));
/// assert!((world.joint(rope)?.length() - fx!(16)).abs() < fx!(0.001));
/// assert!((world.joint(rope)?.force() - vec2(0, 15)).length() < fx!(0.01));
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Pulley<S = Fx> {
    /// The points of the world over which the rope runs, m: for the first and for the second end.
    pub grounds: [Vec2<S>; 2],
    /// The strands of the rope between each end and its point, from 1 to [`limits::STRANDS`] = 64.
    pub strands: [u8; 2],
    /// The length of the rope in use at most, m, from 2^-7 to 2^20.
    pub length: S,
}

codec_struct!(Pulley { grounds, strands, length });

impl<S: Scalar> Pulley<S> {
    /// Refuses values out of range.
    pub(super) fn check(&self) -> Result<(), Error> {
        let reach = S::from_fx(limits::POSITION);
        check(self.grounds.iter().all(|ground| ground.is_within(reach)), Quantity::Position)?;
        check(self.strands.iter().all(|strands| (1..=limits::STRANDS).contains(strands)), Quantity::Strands)?;
        let [shortest, longest] = [limits::SIZE_MIN, limits::JOINT_LENGTH].map(S::from_fx);
        check(shortest <= self.length && self.length <= longest, Quantity::JointLength)
    }

    /// The length in use for both ends at these points, m. *Error* 2 ulp a strand; the largest number where it does not fit.
    pub(crate) fn length_to(&self, points: [Vec2<S>; 2]) -> Fx {
        let lengths = [0, 1].map(|k| {
            let [from, to] = [self.grounds[k], points[k]].map(|point| point.map(S::to_fx));
            from.checked_distance(to).unwrap_or(Fx::MAX).saturating_mul(Fx::from(i32::from(self.strands[k])))
        });
        lengths[0].saturating_add(lengths[1])
    }

    /// The kind as the solver takes it.
    pub(super) fn for_solver(&self) -> solve::JointKind {
        solve::JointKind::Pulley { grounds: self.grounds.map(|ground| ground.map(S::to_fx)), strands: self.strands }
    }

    /// The law of the length in use, over the larger number of strands.
    pub(super) fn law(&self) -> solve::Axis {
        let [first, second] = self.strands;
        let longest = self.length.to_fx() / Fx::from(i32::from(first.max(second)));
        solve::Axis { limits: Some([-limits::JOINT_LENGTH, longest]), ..solve::Axis::default() }
    }
}
