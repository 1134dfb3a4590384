//! Area and moment of inertia per mass, by shape. All terms are positive but one of an ulp, so nothing cancels: the error
//! is a few 2^-64, relative.
//!
//! *Source* uniform density; the half disc's centroid is 4r/3π from its diameter; compounds by the parallel-axis theorem; rounded
//! polygons as the polygon, a strip along each edge and a sector at each corner.

use alloc::vec::Vec;

use super::Part;
use crate::math::Vec2;
use crate::scalar::{Factor, Scalar};

fn ratio<S: Scalar>(num: u64, den: u64) -> S::Factor {
    S::Factor::from_ratio(num, den)
}

fn square<S: Scalar>(size: S) -> S::Factor {
    let size = S::Factor::from_scalar(size);
    size.times(size)
}

/// πr² and r²/2.
pub(super) fn circle<S: Scalar>(radius: S) -> (S::Factor, S::Factor) {
    let square = square(radius);
    (S::Factor::PI.times(square), ratio::<S>(1, 2).times(square))
}

/// w·h and (w² + h²)/12.
pub(super) fn rectangle<S: Scalar>(width: S, height: S) -> (S::Factor, S::Factor) {
    let area = S::Factor::from_wide(width.product(height));
    (area, square(width).plus(square(height)).over(ratio::<S>(12, 1)))
}

/// Area and moment of inertia per mass of a rectangle and a disc, whose halves are moved l/2 away from the middle.
pub(super) fn capsule<S: Scalar>(length: S, radius: S) -> (S::Factor, S::Factor) {
    let (disc, disc_gyration) = circle(radius);
    let diameter = S::Factor::from_scalar(radius).times(ratio::<S>(2, 1));
    let (l, r) = (S::Factor::from_scalar(length), S::Factor::from_scalar(radius));
    let bar = l.times(diameter);
    let bar_gyration = l.times(l).plus(diameter.times(diameter)).over(ratio::<S>(12, 1));
    // ½r² + (l/2)² + 2·(l/2)·(4r/3π)
    let ends_gyration = disc_gyration
        .plus(l.times(l).over(ratio::<S>(4, 1)))
        .plus(l.times(r).times(ratio::<S>(4, 3)).over(S::Factor::PI));
    let area = disc.plus(bar);
    (area, bar.times(bar_gyration).plus(disc.times(ends_gyration)).over(area))
}

/// l and l²/12.
pub(super) fn segment<S: Scalar>(length: S::Factor) -> (S::Factor, S::Factor) {
    (length, length.times(length).over(ratio::<S>(12, 1)))
}

/// By corner the corner itself, the one before and the one after.
fn neighbours<S: Scalar>(corners: &[Vec2<S>]) -> impl Iterator<Item = [Vec2<S>; 3]> {
    let count = corners.len();
    (0..count).map(move |i| [corners[(i + count - 1) % count], corners[i], corners[(i + 1) % count]])
}

/// The mass of the rim of a rounded polygon as weights of its corners, which have the same centre of mass.
///
/// The strip along an edge of length L, L·r, counts half at either end, and the sector at a corner, πr² times its part of a turn, there.
/// The moments of strips and sectors about these points cancel all around: Σ L·n = 0, and the first moments of sectors are r³/3 times
/// differences of normals.
pub(super) fn rounded_weights<S: Scalar>(corners: &[Vec2<S>], radius: S) -> Vec<S::Factor> {
    let (disc, _) = circle(radius);
    let half = S::Factor::from_scalar(radius).times(ratio::<S>(1, 2));
    let weight = |[before, at, after]: [Vec2<S>; 3]| {
        let lengths = (at - before).wide_length().plus((after - at).wide_length());
        lengths.times(half).plus(S::turning(before, at, after).times(disc))
    };
    neighbours(corners).map(weight).collect()
}

/// A + r·P + πr², and the moment of inertia over that, about the origin: *domain* that is the centre of mass but for an ulp along each
/// axis, and within the polygon.
///
/// The moments about the origin: of the polygon ΣA·(a² + b² + c²)/12 over the triangles with the origin, a and b from there to the
/// corners and c = a + b; of strips r·ΣL·(L²/12 + m²) + 2r²·A + r³·P/3, with m from there to the middle of the edge; of sectors
/// r²·π·Σt·v² + 2r³·P/3 + π·r⁴/2, with t the part of a turn and v from there to the corner. No term is negative.
pub(super) fn rounded_polygon<S: Scalar>(corners: &[Vec2<S>], radius: S, area: S::Factor) -> (S::Factor, S::Factor) {
    let r = S::Factor::from_scalar(radius);
    let (disc, disc_gyration) = circle(radius);
    let squared = |v: Vec2<S>| v.wide_length().times(v.wide_length());
    let edges = || neighbours(corners).map(|[_, at, after]| (at, after, (after - at).wide_length()));
    let perimeter = S::Factor::sum(edges().map(|(_, _, length)| length).collect());
    let triangle = |(a, b, _)| {
        let area = S::polygon_moments(&[Vec2::ZERO, a, b]).map_or(S::Factor::ZERO, |moments| moments.area);
        // Sums of two in either order are the same.
        area.times(squared(a).plus(squared(b)).plus(squared(a + b))).over(ratio::<S>(12, 1))
    };
    let within = S::Factor::sum(edges().map(triangle).collect());
    let along = |(a, b, length): (Vec2<S>, Vec2<S>, S::Factor)| {
        let middle = squared(a + b).over(ratio::<S>(4, 1));
        length.times(length.times(length).over(ratio::<S>(12, 1)).plus(middle))
    };
    let strips = S::Factor::sum(edges().map(along).collect());
    let sector = |[before, at, after]: [Vec2<S>; 3]| S::turning(before, at, after).times(squared(at));
    let sectors = S::Factor::sum(neighbours(corners).map(sector).collect());
    let rest = area.times(ratio::<S>(2, 1)).plus(r.times(perimeter));
    let moment =
        within.plus(r.times(strips)).plus(r.times(r).times(rest)).plus(disc.times(sectors.plus(disc_gyration)));
    let measure = area.plus(r.times(perimeter)).plus(disc);
    (measure, moment.over(measure))
}

/// Σ w and Σ w·(k² + d²) / Σ w, d from the common centre to the part's: they are given from a point within an ulp of it.
pub(super) fn compound<S: Scalar>(parts: &[Part<S>], weights: &[S::Factor]) -> (S::Factor, S::Factor) {
    let (mut total, mut inertia) = (S::Factor::ZERO, S::Factor::ZERO);
    for (part, &weight) in parts.iter().zip(weights) {
        let away = part.position.wide_length();
        total = total.plus(weight);
        inertia = inertia.plus(weight.times(part.shape.gyration.plus(away.times(away))));
    }
    // From that point to the centre by the theorem itself: half an ulp counts in the smallest shapes.
    let out = |pick: fn(&Part<S>) -> S| {
        let (mut above, mut below) = (S::Factor::ZERO, S::Factor::ZERO);
        for (part, &weight) in parts.iter().zip(weights) {
            let at = pick(part);
            let side = if at < S::ZERO { &mut below } else { &mut above };
            *side = side.plus(weight.times(S::Factor::from_scalar(at)));
        }
        let out = above.abs_diff(below).over(total);
        out.times(out)
    };
    let gyration = inertia.over(total);
    (total, gyration.minus(out(|p| p.position.x)).minus(out(|p| p.position.y)))
}
