//! How two bodies approach each other at the points of a contact.

use super::moment::position_at;
use crate::collide::Manifold;
use crate::fx::Fx;
use crate::math::{TimeStep, Vec2};
use crate::solve::{Flight, Impulses};

/// How the points of a contact approach each other at the start of the step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Approach {
    /// The unit vector from the first to the second body.
    pub(super) normal: Vec2,
    /// The positions of both bodies at the moment of the manifold, m.
    positions: [Vec2; 2],
    /// By point: the speed along the normal, m/s, positive where they close.
    speeds: [Fx; 2],
    /// By body and point: from the body to where the surfaces meet, m.
    arms: [[Vec2; 2]; 2],
}

impl Approach {
    /// Leaves out the points that had an impulse at the end of the step before. A body that arrives in the last sub-step is slowed down
    /// there in part, and that step has reported the hit.
    pub(super) fn leave_out_pressed(&mut self, start: &Impulses) {
        for (speed, impulse) in self.speeds.iter_mut().zip(start.values) {
            if impulse > 0 {
                *speed = Fx::ZERO;
            }
        }
    }

    /// The speed of the faster one of the points with an impulse, and the place where it meets the other surface, as seen from this body;
    /// the middle of two points that are equally fast. `None` if no point approached.
    pub(super) fn fastest(&self, total: &Impulses, side: usize) -> Option<(Fx, Vec2)> {
        let is_hit = |&k: &usize| total.values[k] > 0 && self.speeds[k] > Fx::ZERO;
        let mut points = (0..2).filter(is_hit);
        let first = points.next()?;
        let arms = &self.arms[side];
        let (speed, arm) = match points.next() {
            Some(second) if self.speeds[second] > self.speeds[first] => (self.speeds[second], arms[second]),
            Some(second) if self.speeds[second] == self.speeds[first] => {
                let [a, b] = [arms[first], arms[second]];
                (self.speeds[first], Vec2::new(middle(a.x, b.x), middle(a.y, b.y)))
            }
            _ => (self.speeds[first], arms[first]),
        };
        Some((speed, self.positions[side] + arm))
    }
}

/// n/d to nearest, halves away from zero. *Domain* d is positive, and |n| + d/2 fits.
fn quotient(n: i128, d: i128) -> i128 {
    let size = (n.abs() + d / 2) / d;
    if n < 0 { -size } else { size }
}

/// The mean of two numbers, halves away from zero.
fn middle(a: Fx, b: Fx) -> Fx {
    Fx::from_bits(quotient(i128::from(a.to_bits()) + i128::from(b.to_bits()), 2) as i64)
}

/// The velocity of a point of a body, in 2^-64 m/s: below 2^86 and 2^100.
fn velocity(flight: &Flight, arm: Vec2) -> [i128; 2] {
    let bits = |value: Fx| i128::from(value.to_bits());
    let (v, turn) = (flight.start.linear, bits(flight.start.angular));
    [(bits(v.x) << 32) - turn * bits(arm.y), (bits(v.y) << 32) + turn * bits(arm.x)]
}

/// The approach at the points of a manifold of this moment. The speed is an exact sum, rounded down, that a mirror image and the two bodies in the other
/// order have as well; vectors are rounded oddly.
pub(super) fn approach(manifold: &Manifold, flights: [&Flight; 2], moment: u64, time_step: TimeStep) -> Approach {
    /// Faster points count as that, 2^30 m/s: products with the normal are below 2^125.
    const FASTEST: i128 = 1 << 94;
    let normal = manifold.normal.map(|part| Fx::from_bits(i64::from(part) << 2));
    let mut approach = Approach {
        normal: Vec2::new(normal[0], normal[1]),
        positions: flights.map(|flight| position_at(flight, moment)),
        speeds: [Fx::ZERO; 2],
        arms: [[Vec2::ZERO; 2]; 2],
    };
    for (k, point) in manifold.points.iter().enumerate().take(manifold.count) {
        let arms = [point.arm_a, point.arm_b];
        let [a, b] = [0, 1].map(|side| velocity(flights[side], arms[side]));
        let closing = [0, 1].map(|axis| (a[axis] - b[axis]).clamp(-FASTEST, FASTEST));
        let [nx, ny] = manifold.normal.map(i128::from);
        // From 2^-94 to 2^-32 m/s.
        let speed = ((closing[0] * nx + closing[1] * ny) >> 62) as i64;
        approach.speeds[k] = Fx::from_bits(speed);
        let way = mean_way([a, b], point.separation, speed, time_step);
        for (side, arm) in arms.into_iter().enumerate() {
            approach.arms[side][k] = Vec2::new(arm.x.saturating_add(way[0]), arm.y.saturating_add(way[1]));
        }
    }
    approach
}

/// The way of the middle between two points until the gap between them is closed, at most that of a step.
fn mean_way([a, b]: [[i128; 2]; 2], gap: Fx, speed: i64, time_step: TimeStep) -> [Fx; 2] {
    if gap <= Fx::ZERO || speed <= 0 {
        return [Fx::ZERO; 2];
    }
    let (num, den) = time_step.seconds();
    let (gap, speed) = (i128::from(gap.to_bits()), i128::from(speed));
    // Both below 2^95.
    let closes = gap * i128::from(den) < speed * i128::from(num);
    let (num, den) = if closes { (gap, speed) } else { (num.into(), den.into()) };
    [0, 1].map(|axis| {
        // Twice the mean, in 2^-32 m/s and within ±2^62: times a number below 2^63.
        let twice = quotient(a[axis] + b[axis], 1 << 32).clamp(-(1 << 62), 1 << 62);
        let way = quotient(twice * num, 2 * den).clamp(-(1 << 62), 1 << 62);
        Fx::from_bits(way as i64)
    })
}
