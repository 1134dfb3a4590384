//! How two bodies approach each other at the points of a contact.

use super::Scene;
use super::narrow::Meeting;
use super::view::newton_seconds;
use crate::fx::Fx;
use crate::math::{TimeStep, Vec2};
use crate::solve::{Contact, ContactImpact, Flight, Impulses, Velocity};

/// How the points of a contact approach each other in a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Approach {
    /// The unit vector from the first to the second body.
    pub(super) normal: Vec2,
    /// The positions of both bodies at the moment of the manifold, m.
    positions: [Vec2; 2],
    /// By point: the speed along the normal at which it meets the other surface, m/s; zero where it does not.
    speeds: [Fx; 2],
    /// By point: the sub-steps that are left after the one in which it meets the other surface.
    substeps_left: [u32; 2],
    /// By body and point: from the body to where the surfaces meet, m.
    arms: [[Vec2; 2]; 2],
    /// The number of points.
    count: usize,
    /// The impulses that the contact started from.
    start: Impulses,
    /// The impacts of the contact, once the step is solved.
    impact: Option<ContactImpact>,
}

impl Approach {
    /// Takes the impacts that the solver found, with their speeds, or forgets them. A contact that only passed on the impacts of
    /// others is no hit by them.
    pub(super) fn set_impact(&mut self, impact: Option<ContactImpact>) {
        self.impact = impact.filter(|impact| impact.speeds != [Fx::ZERO; 2]);
    }

    /// The speed of the faster one of the points with an impulse, and the place where it meets the other surface, as seen from this body;
    /// the middle of two points that are equally fast. `None` if no point approached.
    pub(super) fn fastest(&self, total: &Impulses, side: usize) -> Option<(Fx, Vec2)> {
        let speeds = self.impact.map_or(self.speeds, |impact| impact.speeds);
        let mut points = (0..2).filter(|&k| total.values[k] > 0 && speeds[k] > Fx::ZERO);
        let first = points.next()?;
        let arms = &self.arms[side];
        let (speed, arm) = match points.next() {
            Some(second) if speeds[second] > speeds[first] => (speeds[second], arms[second]),
            Some(second) if speeds[second] == speeds[first] => {
                let [a, b] = [arms[first], arms[second]];
                (speeds[first], Vec2::new(middle(a.x, b.x), middle(a.y, b.y)))
            }
            _ => (speeds[first], arms[first]),
        };
        Some((speed, self.positions[side] + arm))
    }

    /// The impulse of the hit, N·s: the impulse of its impacts. Without an impact, which is for fast bodies, the impulse over
    /// the step less the carrying impulses: at a point that was pressed before, the impulses of the step before, else the
    /// impulses of the last sub-step, from the touch on.
    pub(super) fn impulse(&self, total: &Impulses, last: &Impulses, substeps: u32) -> Fx {
        if let Some(ContactImpact { impulses: [first, second], exponent, .. }) = self.impact {
            return newton_seconds(first.saturating_add(second), exponent);
        }
        let hit_impulse = |k: usize| {
            let is_pressed = self.start.values[k] > 0;
            let (carrying, times) = if is_pressed { (&self.start, substeps) } else { (last, self.substeps_left[k]) };
            let carried = newton_seconds(carrying.values[k], carrying.exponent).saturating_mul(Fx::from(times as i32));
            newton_seconds(total.values[k], total.exponent).saturating_sub(carried).max(Fx::ZERO)
        };
        (0..self.count).fold(Fx::ZERO, |sum, k| sum.saturating_add(hit_impulse(k)))
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
fn velocity(body: &Velocity, arm: Vec2) -> [i128; 2] {
    let bits = |value: Fx| i128::from(value.to_bits());
    let linear = body.linear;
    let angular = bits(body.angular);
    [(bits(linear.x) << 32) - angular * bits(arm.y), (bits(linear.y) << 32) + angular * bits(arm.x)]
}

/// The speed at which points with these velocities close along a normal, in 2^-32 m/s and within 2^62.5: an exact sum,
/// rounded down, that a mirror image and the two bodies in the other order have as well.
fn closing_speed(normal: [i32; 2], [a, b]: [[i128; 2]; 2]) -> i64 {
    /// Faster points count as 2^30 m/s: products with the normal are below 2^125.
    const LIMIT: i128 = 1 << 94;
    let closing = [0, 1].map(|axis| (a[axis] - b[axis]).clamp(-LIMIT, LIMIT));
    let [nx, ny] = normal.map(i128::from);
    // From 2^-94 to 2^-32 m/s.
    ((closing[0] * nx + closing[1] * ny) >> 62) as i64
}

/// The approach at the points of a contact, which has this manifold at the end of these ways. Vectors are rounded oddly.
pub(super) fn approach(scene: &Scene<'_>, meeting: &Meeting, contact: &Contact, flights: [&Flight; 2]) -> Approach {
    let Meeting { manifold, ways } = meeting;
    let normal = manifold.normal.map(|part| Fx::from_bits(i64::from(part) << 2));
    let mut approach = Approach {
        normal: Vec2::new(normal[0], normal[1]),
        positions: [0, 1].map(|side| ways[side].position(flights[side].position)),
        speeds: [Fx::ZERO; 2],
        substeps_left: [0; 2],
        arms: [[Vec2::ZERO; 2]; 2],
        count: manifold.count,
        start: contact.impulses,
        impact: None,
    };
    for (k, point) in manifold.points.iter().enumerate().take(manifold.count) {
        let arms = [point.arm_a, point.arm_b];
        let start = [0, 1].map(|side| velocity(&flights[side].start, arms[side]));
        let end = [0, 1].map(|side| velocity(&flights[side].end, arms[side]));
        let speeds = [start, end].map(|velocities| closing_speed(manifold.normal, velocities));
        // A body that arrives in the last sub-step is slowed down there in part, and the step before has reported the
        // hit.
        if contact.impulses.values[k] <= 0 {
            let gap = contact.points[k].separation;
            (approach.speeds[k], approach.substeps_left[k]) =
                touch(speeds, gap, scene.time_step, scene.settings.substeps);
        }
        let way = mean_way(start, point.separation, speeds[0], scene.time_step);
        for (side, arm) in arms.into_iter().enumerate() {
            approach.arms[side][k] = Vec2::new(arm.x.saturating_add(way[0]), arm.y.saturating_add(way[1]));
        }
    }
    approach
}

/// The speed at which a point meets the other surface, m/s, and the sub-steps that are left after the one in which it
/// does: for a gap at the start and the speeds at both ends of the step. Zero if the point does not approach.
///
/// # Ranges
/// Speeds are below 2^62.5 and their difference below 2^63.5; the gap is cut off at 2^60 of a step's way: the square is
/// below 2^126.
fn touch(speeds: [i64; 2], gap: Fx, time_step: TimeStep, substeps: u32) -> (Fx, u32) {
    let [start, end] = speeds.map(i128::from);
    if start <= 0 && end <= 0 {
        return (Fx::ZERO, 0);
    }
    let (num, den) = time_step.seconds();
    // As a speed: the gap over the length of the step.
    let gap = (i128::from(gap.max(Fx::ZERO).to_bits()) * i128::from(den) / i128::from(num)).min(1 << 60);
    // u² = u0² + 2·a·g, and u + u0 is twice the mean speed.
    let square = (start * start + 2 * (end - start) * gap).max(0);
    let speed = square.unsigned_abs().isqrt() as i128;
    let sum = start + speed;
    let substeps = i128::from(substeps);
    let number = if sum > 0 { ((2 * gap * substeps + sum - 1) / sum).clamp(1, substeps) } else { substeps };
    (Fx::from_bits(speed.min(i64::MAX.into()) as i64), (substeps - number) as u32)
}

/// The way of the middle between two points until the gap between them is closed, at most its way in a step.
fn mean_way([a, b]: [[i128; 2]; 2], gap: Fx, speed: i64, time_step: TimeStep) -> [Fx; 2] {
    if gap <= Fx::ZERO || speed <= 0 {
        return [Fx::ZERO; 2];
    }
    let (num, den) = time_step.seconds();
    let gap = i128::from(gap.to_bits());
    let speed = i128::from(speed);
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
