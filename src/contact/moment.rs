//! The moment of the step at which the manifold of a pair is found, and the distance that its points close up to then.
//!
//! The solver holds the normal and the arms of a contact for a step, and moves its points along rows that do not turn. Rows of the start
//! give energy to a body that turns, rows of the middle take it away: sub-steps of semi-implicit Euler, n of them, keep it with the rows
//! of the mean of their beginnings, (n − 1)/2n of the step. So manifolds are found at the poses to which the velocities of the start lead up
//! to then: a body that another one carries does not fall. Bodies that go from tile to tile, or from segment to segment, have these too.
//!
//! Bodies that approach fast and did not press each other in the step before have the manifold of the moment at which their free flights
//! meet, and no contact if they do not meet: a body touches nothing that its path does not touch, and a glancing hit has the normal of the
//! touch.
//!
//! A separation at a moment becomes the separation at the start by the way along the row that the bodies close up to then.

use super::Start;
use crate::collide::{Pose, SurfacePoint};
use crate::fx::Fx;
use crate::kernel::round::{odd_shift, shr_round};
use crate::math::{TimeStep, Vec2};
use crate::scalar::{Accumulator as _, Angle as _, FxAccumulator, Turn};
use crate::solve::Flight;

/// Bodies that approach by less than this in a step, 4 mm, are slow: as much as gravity does to a body at rest.
pub(super) const SLOW: i64 = 1 << 24;

/// Surfaces are level that turn by less than 2.5°: its cosine, in 2^-60.
pub(super) const LEVEL: i64 = (1 << 60) - (1 << 50);

/// The length of a step, in 2^-48 s.
pub(super) fn length(time_step: TimeStep) -> u64 {
    let (num, den) = time_step.seconds();
    // Steps are shorter than 2^15 s.
    ((u128::from(num) << 48) / u128::from(den)) as u64
}

/// The moment of the manifolds of bodies that press each other, in 2^-48 s.
pub(super) fn mean_beginning(time_step: TimeStep, substeps: u32) -> u64 {
    length(time_step) / (2 * u64::from(substeps)) * u64::from(substeps - 1)
}

/// A part of a value, for a moment in 2^-62 of the step; rounded to nearest, ties to even: oddly.
fn part(value: Fx, moment: u64) -> Fx {
    // Not larger than the value.
    Fx::from_bits(shr_round(i128::from(value.to_bits()) * i128::from(moment), 62) as i64)
}

/// The way of a body from the start of a step to the moment of a manifold.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Way {
    /// m
    pub(super) displacement: Vec2,
    /// rad
    pub(super) rotation: Fx,
}

/// a·b / 2^64 to nearest, ties to even.
#[inline(always)]
fn rounded_product(a: i64, b: u64) -> i64 {
    let product = u128::from(a.unsigned_abs()) * u128::from(b);
    let (floor, rest) = ((product >> 64) as u64, product as u64);
    let size = (floor + u64::from(rest > (1 << 63) - (floor & 1))) as i64;
    if a < 0 { -size } else { size }
}

impl Way {
    #[inline(always)]
    /// The way at the velocity of the start, up to a time in 2^-48 s: a body that something carries does not fall.
    pub(super) fn steady(start: &Start, time: u64) -> Self {
        // Velocities are below 2^21 m/s: ways are below 2^36 m. Rounded to nearest, ties to even: oddly.
        let way = |velocity: FxAccumulator| {
            let velocity = velocity.value().to_bits();
            if time >> 48 == 0 {
                return Fx::from_bits(rounded_product(velocity, time << 16));
            }
            let way = shr_round(i128::from(velocity) * i128::from(time), 48);
            Fx::from_bits(way.clamp(i64::MIN.into(), i64::MAX.into()) as i64)
        };
        Self { displacement: start.velocity.map(way), rotation: way(start.angular_velocity) }
    }

    /// The way on a flight up to a moment.
    pub(super) fn along(flight: &Flight, moment: u64) -> Self {
        Self { displacement: flight.displacement.map(|way| part(way, moment)), rotation: part(flight.rotation, moment) }
    }

    /// The same way without the rotation.
    pub(super) fn without_rotation(self) -> Self {
        Self { rotation: Fx::ZERO, ..self }
    }

    /// The pose at its end.
    pub(super) fn pose(&self, position: Vec2<FxAccumulator>, angle: Turn) -> Pose {
        let moved = |from: FxAccumulator, way: Fx| from.plus(FxAccumulator::from_scalar(way)).value();
        let position = Vec2::new(moved(position.x, self.displacement.x), moved(position.y, self.displacement.y));
        let turned = |angle: Turn| angle.turned(FxAccumulator::from_scalar(self.rotation));
        Pose::new(position, if self.rotation == Fx::ZERO { angle } else { turned(angle) })
    }

    /// The position at its end, m.
    pub(super) fn position(&self, start: Vec2) -> Vec2 {
        let moved = |from: Fx, way: Fx| from.saturating_add(way);
        Vec2::new(moved(start.x, self.displacement.x), moved(start.y, self.displacement.y))
    }

    /// n·(d + φ × r): the way of a point of the body along a normal, in 2^-62 m. The lever is rounded to 2^-28 m, oddly, as it changes its
    /// sign where the bodies change places.
    ///
    /// # Ranges
    /// Displacements are below 2^61 ulps, rotations below 2^54 and arms below 2^47: with normals of 2^30 sums of products are below 2^93,
    /// and products of rotations with levers, which are below 2^44, below 2^98.
    fn along_row(&self, normal: [i32; 2], arm: Vec2) -> i128 {
        let [nx, ny] = normal.map(i128::from);
        let straight = nx * i128::from(self.displacement.x.to_bits()) + ny * i128::from(self.displacement.y.to_bits());
        if self.rotation == Fx::ZERO {
            return straight;
        }
        let [x, y] = [arm.x, arm.y].map(|part| odd_shift(part.to_bits().into(), 4));
        straight + 4 * odd_shift(ny * x - nx * y, 30) * i128::from(self.rotation.to_bits())
    }
}

/// Takes a point of the moment at the end of these ways to the start of the step, along its row: a mirror image has the same separation.
pub(super) fn take_back(point: &mut SurfacePoint, normal: [i32; 2], ways: &[Way; 2]) {
    let [a, b] = [0, 1].map(|side: usize| ways[side].along_row(normal, point.arms[side]));
    point.separation = Fx::from_bits(point.separation.to_bits().saturating_add(((a - b) >> 30) as i64));
}
