//! Area and moment of inertia per mass, by shape. All terms are positive but one of an ulp, so nothing cancels: the error
//! is a few 2^-64, relative.
//!
//! *Source* uniform density; the half disc's centroid is 4r/3π from its diameter; compounds by the parallel-axis theorem.

use super::Part;
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
