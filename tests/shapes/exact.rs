//! Exact geometry of convex cores in ulps.

use core::cmp::Ordering;

use dashu_int::IBig;
use umbra_physics::{Outline, Random, Vec2};

#[path = "../support/rational.rs"]
mod rational;

use rational::square_from_segment;
pub(super) use rational::{Ratio, Vector as Point, cross, dot, minus};

/// A point in ulps.
pub(super) fn point(v: Vec2) -> Point {
    [v.x, v.y].map(|part| IBig::from(part.to_bits()))
}

/// The corners of an outline at a position, in ulps.
pub(super) fn corners(outline: &Outline, position: Vec2) -> Vec<Point> {
    outline.corners().iter().map(|&corner| point(corner + position)).collect()
}

/// The edges of a core: a segment has one either way, a point none.
pub(super) fn edges(corners: &[Point]) -> Vec<(&Point, &Point)> {
    if corners.len() == 1 {
        return Vec::new();
    }
    corners.iter().zip(corners.iter().cycle().skip(1)).collect()
}

/// Twice the area within some corners, counter-clockwise.
pub(super) fn twice_area(corners: &[Point]) -> IBig {
    edges(corners).iter().map(|(a, b)| cross(a, b)).sum()
}

/// The square of the distance of a point from the edges of a core.
pub(super) fn square_from_rim(p: &Point, corners: &[Point]) -> Ratio {
    let squares = edges(corners).into_iter().map(|(a, b)| square_from_segment(p, a, b));
    let w = minus(p, &corners[0]);
    squares.min_by(Ratio::cmp).unwrap_or_else(|| Ratio(dot(&w, &w), IBig::ONE))
}

/// The squares of the distances along which the normals of the edges of two cores separate them, or are to separate them: positive where they are
/// apart along a normal.
fn along_normals(a: &[Point], b: &[Point]) -> Vec<(Ordering, Ratio)> {
    let mut all = Vec::new();
    for (from, to, sign) in
        edges(a).into_iter().map(|(p, q)| (p, q, 1)).chain(edges(b).into_iter().map(|(p, q)| (p, q, -1)))
    {
        let e = minus(to, from);
        let normal = [&e[1] * IBig::from(sign), -&e[0] * IBig::from(sign)];
        let farthest = a.iter().map(|corner| dot(corner, &normal)).max().expect("a corner");
        let nearest = b.iter().map(|corner| dot(corner, &normal)).min().expect("a corner");
        let gap = nearest - farthest;
        all.push((gap.cmp(&IBig::ZERO), Ratio(&gap * &gap, dot(&normal, &normal))));
    }
    all
}

/// Two cores: the square of their distance, or of the depth of their overlap, and whether several directions tie for it.
pub(super) enum Gap {
    Apart(Ratio),
    Overlap(Ratio, bool),
}

pub(super) fn gap(a: &[Point], b: &[Point]) -> Gap {
    let corner_squares = || {
        let from_b = a.iter().map(|p| square_from_rim(p, b));
        from_b.chain(b.iter().map(|p| square_from_rim(p, a))).min_by(Ratio::cmp).expect("a corner")
    };
    let mut depths = along_normals(a, b);
    if depths.is_empty() {
        let square = corner_squares();
        return if square.0.is_zero() { Gap::Overlap(square, true) } else { Gap::Apart(square) };
    }
    if depths.iter().any(|(order, _)| order.is_gt()) {
        return Gap::Apart(corner_squares());
    }
    // Segments in one line have no normal along it.
    let are_in_line = a.len() < 3 && b.len() < 3 && depths.iter().all(|(_, square)| square.0.is_zero());
    if are_in_line && !corner_squares().0.is_zero() {
        return Gap::Apart(corner_squares());
    }
    depths.sort_by(|a, b| a.1.cmp(&b.1));
    let ties = depths.len() > 1 && depths[0].1.cmp(&depths[1].1).is_eq();
    Gap::Overlap(depths.swap_remove(0).1, ties)
}

/// Returns true if a length in ulps is the root of a square within so many units of 2^-16 ulp.
pub(super) fn is_root(length: &IBig, square: &Ratio, slack: i64) -> bool {
    let scaled = Ratio(&square.0 << 32, square.1.clone());
    let end = |units: i64| (length << 16) + IBig::from(units);
    let (low, high) = (end(-slack), end(slack));
    let is_below = low < IBig::ZERO || Ratio(&low * &low, IBig::ONE).cmp(&scaled).is_le();
    high >= IBig::ZERO && is_below && Ratio(&high * &high, IBig::ONE).cmp(&scaled).is_ge()
}

/// A point of a grid of so many steps either way.
pub(super) fn on_grid(random: &mut Random, steps: i64, step: umbra_physics::Fx) -> Vec2 {
    let mut part = || step * random.integer(-steps..=steps) as i32;
    Vec2::new(part(), part())
}
