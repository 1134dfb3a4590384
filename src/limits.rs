//! Limits: the ranges that the proof below needs (together the envelope), and some limits of size. Each definition documents its own.
//!
//! Nothing wraps inside the envelope.
//! A value beyond its bound is refused where it enters, by a typed error and with the world unchanged. A body that leaves
//! the envelope during a step is quarantined at the end of it. Hence the arithmetic of a step, which is neither checked
//! nor saturating, never wraps:
//!
//! - *Velocity.* At the start of a step at most [`SPEED`] = 2^20 m/s a component. A step has at most six kick stages, each
//!   of at most four kicks: gravity ([`GRAVITY`]), what was applied, the fields of position and those of velocity, each
//!   below [`KICK`] = 2^21 m/s (a larger one is left out, and the body is quarantined). Damping backwards in
//!   time is cut off at [`TRANSIENT_SPEED`] = 2^24 m/s: |v| < 2^24 + 6·4·2^21 = 2^26 throughout. As an
//!   accumulator, in units of 2^-96, that is below 2^122.
//! - *Position.* At most [`POSITION`] = 2^30 m before, and a step drifts for at most 1.36 + 1.71 + 1.36 = 4.43 s in all:
//!   |x| < 2^30 + 4.43·2^26 < 2^30.35 m throughout, and an accumulator holds 2^31 m.
//! - *Offsets.* Between two such points, less than 2^31.36 m = 2^63.36 ulps a component; the sum of two squares is below
//!   2^127.8 and fits in u128.
//! - *Forces.* A call adds at most 2^31 N a component or 2^63 N·m; sums are held in 192 bits and checked
//!   once, in the step.
//!
//! Ticks are from 0 to [`TICK`] = 2^63, and no step leads out of that range: at [`TICK`] the count stands still. So a file that a
//! reader accepts can be saved, recorded and read again after any number of steps, even at the last tick. A
//! run from tick 0 never gets there: 2^63 steps take 292 years at a nanosecond each. A tick and a number of ticks below 2^63
//! add up in 64 bits.
//!
//! Rotation has the same bounds in rad/s; its angle wraps by itself. Undoing a step makes the same kicks and drifts with the
//! opposite sign, from the same bounds.
//!
//! ```
//! use umbra_physics::{Fx, fx, limits};
//!
//! let power = |exponent: u32| Fx::from_bits(1 << (32 + exponent));
//! assert_eq!((limits::POSITION, limits::SPEED, limits::ANGULAR_SPEED), (power(30), power(20), power(20)));
//! assert_eq!((limits::KICK, limits::TRANSIENT_SPEED), (power(21), power(24)));
//! assert_eq!((limits::MASS_MIN, limits::MASS_MAX), (fx!(0.0000152587890625), power(24)));
//! assert_eq!((limits::SIZE_MIN, limits::SIZE_MAX), (fx!(0.0078125), power(12)));
//! assert_eq!((limits::GRAVITY, limits::GRAVITY_SCALE, limits::MU_MAX_LOG2), (power(16), power(4), 64));
//! assert_eq!((limits::RATE_MIN, limits::RATE_MAX), (1, 10_000));
//! assert_eq!((limits::CORNERS, limits::PARTS, limits::CHAIN), (64, 256, 1 << 16));
//! assert_eq!(limits::CONCAVE_CORNERS, 1 << 10);
//! assert_eq!((limits::BODIES, limits::FIELDS, limits::BLOB), (1 << 24, 1 << 24, 1 << 24));
//! assert_eq!((limits::COLLIDERS, limits::FRICTION, limits::SURFACE_SPEED), (1 << 24, power(5), power(10)));
//! assert_eq!((limits::EXCLUDED_PAIRS, limits::MATERIAL_PAIRS, limits::TICK), (1 << 16, 1 << 12, 1 << 63));
//! assert_eq!((limits::QUERY, limits::JOINT_LENGTH, limits::JOINTS), (power(20), power(20), 1 << 24));
//! assert_eq!((limits::JOINT_ANGLE, limits::TEETH, limits::STRANDS), (power(17), 1 << 10, 64));
//! ```

use crate::error::Error;
use crate::fx::Fx;
use crate::math::TimeStep;
use crate::scalar::{KICK_LOG2, TRANSIENT_SPEED_LOG2};

const fn power(exponent: i32) -> Fx {
    Fx::from_bits(1 << (32 + exponent))
}

pub(crate) const POSITION_LOG2: u32 = 30;
pub(crate) const SPEED_LOG2: u32 = 20;

/// The largest coordinate of a position: 2^30 m either way.
pub const POSITION: Fx = power(POSITION_LOG2 as i32);
/// The largest component of a velocity: 2^20 m/s either way.
pub const SPEED: Fx = power(SPEED_LOG2 as i32);
/// The largest angular velocity: 2^20 rad/s either way.
pub const ANGULAR_SPEED: Fx = power(SPEED_LOG2 as i32);
/// The bound that a kick within a step stays below: 2^21 m/s, or rad/s.
pub const KICK: Fx = power(KICK_LOG2);
/// The bound on velocities between the stages of a step: damping backwards in time stays below 2^24 m/s, or rad/s.
pub const TRANSIENT_SPEED: Fx = power(TRANSIENT_SPEED_LOG2);
/// The largest coordinate of a position within a step: above 2^30.35 m by enough that a shape still fits beside it.
pub(crate) const TRANSIENT_POSITION: Fx = Fx::from_bits(POSITION.to_bits() + POSITION.to_bits() / 2);
/// The largest component of a velocity within a step: 2^26 m/s, or rad/s, with all kicks on top of damping backwards.
pub(crate) const TRANSIENT_SUM: Fx = power(26);
/// The smallest mass of a dynamic body: 2^-16 kg, 15 mg.
pub const MASS_MIN: Fx = power(-16);
/// The largest mass: 2^24 kg, 16,777 t.
pub const MASS_MAX: Fx = power(24);
/// The smallest extent of a shape (radius, side, length): 2^-7 m.
///
/// Surfaces within a millimetre touch, and bodies that rest on each other overlap in proportion to the load, at 60 steps a second and 5 sub-steps
/// by 0.23 mm for each equal body above. A pile of twelve boxes of half this thickness does not come to rest.
pub const SIZE_MIN: Fx = power(-7);
/// The largest radius, side or length of a shape, and the largest coordinate of a corner, part or attachment: 2^12 m.
pub const SIZE_MAX: Fx = power(12);
/// The largest component of gravity or of the acceleration of a region: 2^16 m/s² either way.
///
/// With [`GRAVITY_SCALE`] a kick of gravity over the longest span, 1.71 s, is below 2^21 m/s: never a fault.
pub const GRAVITY: Fx = power(16);
/// The largest gravity scale of a body, either way.
pub const GRAVITY_SCALE: Fx = power(4);
/// The largest gravitational parameter: 2^64 m³/s² (the Sun has 2^66.9; scale the scene).
pub const MU_MAX_LOG2: u32 = 64;
/// The slowest rate, steps a second.
pub const RATE_MIN: u32 = 1;
/// The fastest rate, steps a second.
pub const RATE_MAX: u32 = 10_000;
/// The most corners a polygon has.
pub const CORNERS: usize = 64;
/// The most parts a compound has.
pub const PARTS: usize = 256;
/// The most corners a concave polygon has, which is cut into convex parts: 1,024.
pub const CONCAVE_CORNERS: usize = 1 << 10;
/// The most points a chain has.
pub const CHAIN: usize = 1 << 16;
/// The most bodies a world has, slots whose handles are used up included: handles are 32-bit.
pub const BODIES: usize = 1 << 24;
/// The most force fields a world has, slots whose handles are used up included: handles are 32-bit.
pub const FIELDS: usize = 1 << 24;
/// The most colliders a world has, slots whose handles are used up included, and the most outlines that they have beyond the first one
/// of each.
pub const COLLIDERS: usize = 1 << 24;
/// The most joints a world has, slots whose handles are used up included: handles are 32-bit.
pub const JOINTS: usize = 1 << 24;
/// The largest distance that a joint keeps: 2^20 m.
pub const JOINT_LENGTH: Fx = power(20);
/// The largest angle of a limit or of the spring of a joint: 2^17 rad either way, which is 20,860 turns.
pub const JOINT_ANGLE: Fx = power(17);
/// The most teeth of a gear or a ratchet.
pub const TEETH: u16 = 1 << 10;
/// The most strands of the rope of a pulley between a body and its point.
pub const STRANDS: u8 = 64;
/// The most pairs of bodies that are excluded from contacts: 65,536.
pub const EXCLUDED_PAIRS: usize = 1 << 16;
/// The most pairs of materials of a world that have coefficients of their own.
pub const MATERIAL_PAIRS: usize = 1 << 12;
/// The largest coefficient of friction: 32.
pub const FRICTION: Fx = power(5);
/// The largest speed of a surface, m/s: 1,024.
pub const SURFACE_SPEED: Fx = power(10);
/// The farthest that a query looks: the largest component of a translation, and the largest distance of a closest point, 2^20 m.
pub const QUERY: Fx = power(20);
/// The last tick: 2^63, 29 million years at the fastest rate. A world read from a file at this tick still moves with each step,
/// but its tick and its elapsed time stay the same.
pub const TICK: u64 = 1 << 63;
/// The most bytes of a game's own data a world carries along: 16 MiB.
pub const BLOB: usize = 1 << 24;

/// The tick that is `steps` after a tick, at most [`TICK`].
pub(crate) const fn tick_after(tick: u64, steps: u64) -> u64 {
    let later = tick.saturating_add(steps);
    if later < TICK { later } else { TICK }
}

impl TimeStep {
    /// The time step itself if its rate is within the limits.
    ///
    /// # Errors
    /// [`Error::TimeStep`].
    pub(crate) const fn checked(self) -> Result<Self, Error> {
        let (num, den) = self.seconds();
        let (n, d) = (num as u64, den as u64);
        // A step of zero would have an infinite rate.
        if num == 0 || d < n * RATE_MIN as u64 || d > n * RATE_MAX as u64 {
            return Err(Error::TimeStep);
        }
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_outside_the_rates_are_refused() {
        for (num, den) in [(0, 1), (1, 0), (0, 0), (2, 1), (1, 10_001), (u32::MAX, 1)] {
            assert_eq!(TimeStep::ratio(num, den).checked(), Err(Error::TimeStep), "{num}/{den}");
        }
        for (num, den) in [(1, 1), (1, 10_000), (1001, 60_000), (7, 420)] {
            assert!(TimeStep::ratio(num, den).checked().is_ok(), "{num}/{den}");
        }
    }
}
