//! How far bodies move over a tick, and the legs of their paths.

use crate::collide::sweep::{END, Leg};
use crate::contact::Start;
use crate::kernel::wide::mul_shift;
use crate::math::Vec2;
use crate::scalar::{FxAccumulator, Turn};
use crate::solve::Flight;

/// A position in ulps.
fn ulps(position: Vec2<FxAccumulator>) -> [i64; 2] {
    [position.x.value().to_bits(), position.y.value().to_bits()]
}

/// The angle turned after impulses, about, in 2^-32 rad.
fn turned(flight: &Flight, rotation: Option<FxAccumulator>) -> i128 {
    i128::from(flight.rotation.to_bits()) + rotation.map_or(0, |change| change.value().to_bits().into())
}

/// A bound of the distance by which a point within `reach` of the centre moves, ulps.
#[inline]
pub(super) fn moved(
    [from, to]: [Vec2<FxAccumulator>; 2],
    flight: &Flight,
    rotation: Option<FxAccumulator>,
    reach: i64,
) -> i64 {
    let way = |from: FxAccumulator, to: FxAccumulator| {
        // Below 2^32 m; the magnitude is cut off, as in all images.
        (to.to_bits().abs_diff(from.to_bits()) >> 64).min(1 << 62) as i64 + 1
    };
    let x = way(from.x, to.x);
    let y = way(from.y, to.y);
    // a + b/2 is at least the length of (a, b) for a ≥ b.
    let straight = x.max(y).saturating_add(x.min(y) / 2);
    if reach == 0 {
        return straight;
    }
    // No point moves farther than twice its distance from the centre, which is below 2^49: a rotation beyond 8 rad counts as 8 rad.
    let turned = flight.rotation.to_bits().saturating_add(rotation.map_or(0, |change| change.value().to_bits()));
    // Below 2^23 · 2^30, each rounded up.
    let round = ((turned.saturating_abs().min(8 << 32) >> 12) + 1) * ((reach >> 20) + 1);
    straight.saturating_add(round.min(2 * reach) + 1)
}

/// The path from the start to a pose.
pub(super) fn leg(
    start: &Start,
    position: Vec2<FxAccumulator>,
    angle: Turn,
    flight: &Flight,
    rotation: Option<FxAccumulator>,
) -> Leg {
    // 1/2π in 2^-66; from 2^-32 rad to 2^-64 turns.
    const PER_TURN: u128 = 0xa2f9_836e_4e44_152a;
    let from = ulps(start.position);
    let to = ulps(position);
    let way = [0, 1].map(|k| i128::from(to[k]) - i128::from(from[k]));
    let shortest = i128::from(angle.to_bits().wrapping_sub(start.angle.to_bits()) as i64);
    let turned = turned(flight, rotation);
    // Both are below a quarter of a turn: there are no whole turns.
    if turned.unsigned_abs() < 3 << 31 && shortest.unsigned_abs() < 1 << 62 {
        return Leg::new(from, way, start.angle, shortest);
    }
    let about = mul_shift(turned, PER_TURN, 66 + 32 - 64).unwrap_or(0);
    // Whole turns, to nearest, ties away from zero.
    let rest = about - shortest;
    let turns = ((rest.abs() + (1 << 63)) >> 64) * rest.signum();
    Leg::new(from, way, start.angle, shortest + (turns << 64))
}

/// The path of a body that does not move.
pub(in super::super) fn resting(position: Vec2<FxAccumulator>, angle: Turn) -> Leg {
    Leg::new(ulps(position), [0; 2], angle, 0)
}

/// The part of the way from one coordinate to another, rounded to nearest, ties to even.
pub(crate) fn between(from: FxAccumulator, to: FxAccumulator, part: u64) -> FxAccumulator {
    if part == END {
        return to;
    }
    // Below 2^31 m in all.
    let way = to.to_bits() - from.to_bits();
    FxAccumulator::from_bits(from.to_bits() + mul_shift(way, u128::from(part), 62).unwrap_or(0))
}
