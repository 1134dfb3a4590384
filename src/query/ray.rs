//! The first point of a ray that is in a shape.
//!
//! **Cores without a radius**: exact. The ray crosses the edge whose ends are on both sides of its line and which it meets from outside.
//!
//! **Cores with a radius**: the disc around each corner, exactly, and each edge moved outwards by the radius; the ray enters the shape
//! where it enters the first of them. A moved edge has its ends rounded towards the core, by less than 2 units of 2^-16 ulp in each
//! component: what is found is the first point in a shape that is larger than the one with a radius 2^-14 ulp less, and no larger than
//! the shape itself.
//!
//! How far along the ray is an integer in units of 2^-62, rounded down.

use core::cmp::Ordering;

use super::core::in_fx;
use super::near::{Near, nearest, order_of_distance};
use super::{Core, Point, contains, cross, dot, edge, from_to, odd_shift, outward};
use crate::kernel::sqrt::{over_root, root_fine};
use crate::kernel::wide::{div_256, mul_128};
use crate::math::Vec2;
use crate::scalar::Scalar;
use crate::shape::{Geometry, Shape};

/// Bits of the fraction of a ray.
pub(crate) const FRACTION: u32 = 62;

/// The end of a ray, as a fraction of it.
pub(crate) const FULL: u64 = 1 << FRACTION;

/// Bits of the ends of moved edges after an ulp.
const FINE: u32 = 16;

/// The part of a shape that a ray meets first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Feature {
    /// The ray starts in the shape.
    Inside,
    /// An edge, by the number of its first corner.
    Edge(usize),
    /// A sharp corner.
    Corner(usize),
    /// The disc around a corner.
    Disc(usize),
}

/// The first point of a ray in a shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct RayEnd {
    /// The fraction of the ray in units of 2^-62, up to [`FULL`].
    pub(crate) fraction: u64,
    pub(crate) feature: Feature,
}

/// The line of a ray, to tell soon what is beside it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    from: Point,
    ray: Point,
    /// The length of the ray in ulps, rounded up.
    length: i128,
}

impl Line {
    pub(crate) fn new(from: Point, ray: Point) -> Self {
        // Below 2^53.
        let length = (dot(ray, ray) as u128).isqrt() as i128 + 1;
        Self { from, ray, length }
    }

    /// Returns true if no point of a shape is on the line; false where it is out of reach. Exact of a core without a radius.
    #[inline]
    pub(crate) fn misses(&self, corners: &[Point], radius: i64) -> bool {
        let Self { from, ray, length } = *self;
        // Corners in reach are below 2^54: products are below 2^106, that with a radius below 2^99.
        let (mut min, mut max) = (i128::MAX, i128::MIN);
        for corner in corners {
            let (Some(x), Some(y)) = (corner[0].checked_sub(from[0]), corner[1].checked_sub(from[1])) else {
                return false;
            };
            let side = cross(ray, [x, y]);
            (min, max) = (min.min(side), max.max(side));
        }
        let reach = i128::from(radius) * length;
        min > reach || max < -reach
    }
}

/// The first point of the ray from the origin along `ray` that is in a shape.
pub(crate) fn first_hit(core: &Core, ray: Point) -> Option<RayEnd> {
    if contains(core) {
        return Some(RayEnd { fraction: 0, feature: Feature::Inside });
    }
    if core.radius == 0 { sharp_hit(core.corners(), ray) } else { rounded_hit(core, ray) }
}

/// The first point of the ray from which on it leads into a shape: where [`first_hit`] has it, but for rays that only graze the shape. A ray from
/// the surface that goes along it or away from it leads nowhere into a convex shape.
///
/// A line without a radius has no inside. A ray leads into it if it crosses the line between its ends, or comes along the line from beyond an end.
pub(crate) fn first_entry(core: &Core, ray: Point) -> Option<RayEnd> {
    match start(core) {
        Start::Inside => Some(RayEnd { fraction: 0, feature: Feature::Inside }),
        Start::On(feature) => leads_in(core, feature, ray),
        Start::Outside => {
            let end = if core.radius == 0 { sharp_hit(core.corners(), ray) } else { rounded_hit(core, ray) };
            end.filter(|_| !grazes(core, ray))
        }
    }
}

/// The place of the start of a ray in a shape.
enum Start {
    Outside,
    /// On the surface, at an edge or a corner.
    On(Feature),
    Inside,
}

/// The place of the origin in a shape. Exact.
fn start(core: &Core) -> Start {
    let corners = core.corners();
    let feature = nearest(corners);
    if core.radius > 0 || feature != Near::Inside {
        return match (order_of_distance(core, feature), feature) {
            (Ordering::Greater, _) => Start::Outside,
            (Ordering::Equal, Near::Corner(i)) => Start::On(Feature::Disc(i)),
            (Ordering::Equal, Near::Edge(i)) => Start::On(Feature::Edge(i)),
            _ => Start::Inside,
        };
    }
    if let Some(i) = corners.iter().position(|&corner| corner == [0; 2]) {
        return Start::On(Feature::Corner(i));
    }
    let edges = if corners.len() > 1 { corners.len() } else { 0 };
    match (0..edges).find(|&i| cross(corners[i], edge(corners, i)) == 0) {
        Some(i) => Start::On(Feature::Edge(i)),
        None => Start::Inside,
    }
}

/// The start of a ray, which is on the surface of a shape, if it leads into the shape from there.
fn leads_in(core: &Core, feature: Feature, ray: Point) -> Option<RayEnd> {
    let corners = core.corners();
    let count = corners.len();
    let is_met = |i: usize| cross(ray, edge(corners, i)) < 0;
    let feature = match feature {
        // A line has an edge on each side.
        Feature::Edge(i) if count == 2 && core.radius == 0 => {
            [i, 1 - i].into_iter().find(|&i| is_met(i)).map(Feature::Edge)
        }
        Feature::Edge(i) => is_met(i).then_some(feature),
        Feature::Disc(i) => (dot(ray, corners[i]) > 0).then_some(feature),
        Feature::Corner(i) if count == 2 => {
            let way = from_to(corners[i], corners[1 - i]);
            (cross(ray, way) == 0 && dot(ray, way) > 0).then_some(feature)
        }
        Feature::Corner(i) => (count > 2 && is_met(i) && is_met(before(i, count))).then_some(feature),
        Feature::Inside => None,
    };
    feature.map(|feature| RayEnd { fraction: 0, feature })
}

/// Returns true if the line of a ray has no point in the inside of a shape.
fn grazes(core: &Core, ray: Point) -> bool {
    // Below 2^107.
    let sides = core.corners().iter().map(|&corner| cross(ray, corner));
    let (min, max) = sides.fold((i128::MAX, i128::MIN), |(min, max), side| (min.min(side), max.max(side)));
    let is_along = core.radius == 0 && min == 0 && max == 0;
    if is_along || min < 0 && max > 0 {
        return false;
    }
    // The distance of the nearest corner, times the length of the ray, is no less than the radius times that length: below 2^214 and 2^197.
    let side = min.unsigned_abs().min(max.unsigned_abs());
    mul_128(side, side) >= mul_128((core.radius as u128).pow(2), dot(ray, ray) as u128)
}

/// The number of the edge that ends at a corner.
fn before(i: usize, count: usize) -> usize {
    if i > 0 { i - 1 } else { count - 1 }
}

/// [`first_hit`], of a segment of a chain from the side alone on which it touches others.
pub(crate) fn ray_hit(core: &Core, is_link: bool, ray: Point) -> Option<RayEnd> {
    if is_link { one_sided_hit(core.corners(), ray) } else { first_hit(core, ray) }
}

/// The first point of the ray on the side of a segment that a chain touches others with, without a radius: that to the right of the way
/// from the first corner to the second one.
fn one_sided_hit(corners: &[Point], ray: Point) -> Option<RayEnd> {
    let [a, b] = corners else { return None };
    if cross(ray, from_to(*a, *b)) >= 0 || cross(*a, from_to(*a, *b)) > 0 {
        return None;
    }
    sharp_hit(corners, ray)
}

/// [`first_hit`] for a core without a radius that does not have the origin in it.
fn sharp_hit(corners: &[Point], ray: Point) -> Option<RayEnd> {
    if ray == [0; 2] {
        return None;
    }
    let count = corners.len();
    // The side of the ray's line that each corner is on: below 2^107.
    let side = |i: usize| cross(ray, corners[if i < count { i } else { 0 }]);
    let mut next = side(0);
    let mut touched = None;
    let mut is_on_line = true;
    for i in 0..count {
        let this = next;
        next = side(i + 1);
        is_on_line &= this == 0;
        // The ray meets the edge from outside: cross(ray, edge) = next − this < 0.
        if this >= 0 && next <= 0 && this > next {
            touched = Some((i, this, next));
            break;
        }
    }
    let Some((i, this, next)) = touched else {
        return if is_on_line { hit_along(corners, ray) } else { None };
    };
    // The edge is crossed where t·ray × edge = corner × edge. Below 2^105 and 2^103.
    let away = -cross(corners[i], edge(corners, i));
    let fraction = fraction(away, (this - next).unsigned_abs(), 0)?;
    // The ray meets a corner: of the two edges at it, one may be turned away.
    let feature = match (this, next) {
        (0, _) => Feature::Corner(i),
        (_, 0) => Feature::Corner(if i + 1 < count { i + 1 } else { 0 }),
        _ => Feature::Edge(i),
    };
    Some(RayEnd { fraction, feature })
}

/// `away·2^-fine / towards` as a fraction of the ray; `None` before its start and behind its end.
///
/// *Domain* |away| < 2^123, towards < 2^107, fine is 0 or 16.
#[inline(always)]
fn fraction(away: i128, towards: u128, fine: u32) -> Option<u64> {
    if away < 0 || away.unsigned_abs() > towards << fine {
        return None;
    }
    // At most 2^62, as the quotient is at most 1.
    let (away, left) = (away.unsigned_abs(), FRACTION - fine);
    Some(div_256(away >> (128 - left), away << left, towards).0 as u64)
}

/// The end of a point or a segment, on the line of the ray, that the ray meets first.
#[cold]
fn hit_along(corners: &[Point], ray: Point) -> Option<RayEnd> {
    let way = |i: &usize| dot(corners[*i], ray);
    // The origin is not between the ends: if one is behind it, both are.
    let first = (0..corners.len()).min_by_key(way)?;
    // Below 2^107, and 2^105.
    let fraction = fraction(way(&first), dot(ray, ray) as u128, 0)?;
    Some(RayEnd { fraction, feature: Feature::Corner(first) })
}

/// The ends of an edge moved outwards by a radius, in units of 2^-16 ulp: below 2^71.
fn moved(corner: Point, e: Point, radius: i64) -> [i128; 2] {
    let square = dot(e, e) as u128;
    // A radius is below 2^46, and in these units below 2^62.
    let whole = (radius as u64) << FINE;
    let part = |c: i64| {
        let size = over_root(c.unsigned_abs(), whole, square);
        // The nearest integer may be above: then one less. |c|·whole < 2^50·2^62, and its square has 224 bits.
        let (product, size) = (u128::from(c.unsigned_abs()) * u128::from(whole), u128::from(size));
        let size = size - u128::from(mul_128(size * size, square) > mul_128(product, product));
        if c < 0 { -(size as i128) } else { size as i128 }
    };
    let [x, y] = outward(e).map(part);
    [(i128::from(corner[0]) << FINE) + x, (i128::from(corner[1]) << FINE) + y]
}

/// [`first_hit`] for a core with a radius that does not have the origin in it.
fn rounded_hit(core: &Core, ray: Point) -> Option<RayEnd> {
    if ray == [0; 2] {
        return None;
    }
    let corners = core.corners();
    let count = corners.len();
    let square = dot(ray, ray) as u128;
    let mut first: Option<RayEnd> = None;
    let mut add = |fraction: Option<u64>, feature: Feature| {
        if let Some(fraction) = fraction.filter(|fraction| first.is_none_or(|first| *fraction < first.fraction)) {
            first = Some(RayEnd { fraction, feature });
        }
    };
    // Discs come first: at a seam the ray may meet the edges on both sides of a disc as soon as the disc, and neither is preferred.
    for (i, &corner) in corners.iter().enumerate() {
        add(disc_fraction(corner, core.radius, ray, square), Feature::Disc(i));
    }
    for i in 0..if count > 1 { count } else { 0 } {
        let e = edge(corners, i);
        let towards = -cross(ray, e);
        // Below 2^103. Edges that the ray cannot meet from outside are not moved.
        if towards <= 0 || cross(corners[i], e) >= 0 {
            continue;
        }
        let [x, y] = moved(corners[i], e, core.radius);
        // Below 2^71·2^52·2 = 2^124.
        let side = i128::from(ray[0]) * y - i128::from(ray[1]) * x;
        if side >= 0 && side <= towards << FINE {
            // Below 2^71·2^50·2 = 2^122.
            let away = i128::from(e[0]) * y - i128::from(e[1]) * x;
            add(fraction(away, towards as u128, FINE), Feature::Edge(i));
        }
    }
    first
}

/// The fraction of the ray at which it enters the disc around a corner; `None` if it does not. `square` is that of the ray.
///
/// With b = corner·ray, c = corner² − r² and D = ray²·r² − (ray × corner)² that is (b − √D)/ray² = c/(b + √D), and the second form loses
/// nothing: c and D are exact, and no term is subtracted.
fn disc_fraction(corner: Point, radius: i64, ray: Point, square: u128) -> Option<u64> {
    // b < 2^107 and c < 2^109.
    let (b, c) = (dot(corner, ray), dot(corner, corner) - i128::from(radius).pow(2));
    // c > 0, as the origin is not in the disc: with b <= 0 the ray leads away from it.
    if b <= 0 {
        return None;
    }
    let away = cross(ray, corner).unsigned_abs();
    // Below 2^105·2^92, and 2^214.
    let (reach, aside) = (mul_128(square, (radius as u128).pow(2)), mul_128(away, away));
    let (high, low) = minus(reach, aside)?;
    // In front of the end: c <= b + √D.
    let (b, c) = (b as u128, c as u128);
    let beyond = c.saturating_sub(b);
    if mul_128(beyond, beyond) > (high, low) {
        return None;
    }
    // In units of 2^-fine, 20 <= fine <= 64, b is below 2^127, and √D <= b. The root is within 2^-94 relative and a unit. With D >= 0 is
    // b >= |ray|·√c >= 1: a unit is less than 2^-64 of the sum, or than 2^-126.
    let fine = (b.leading_zeros() - 1).min(64);
    let sum = (b << fine) + root_256(high, low, fine);
    // c·2^(62 + fine): the quotient is at most 2^62, and 1 more by the error of the root.
    let left = FRACTION + fine;
    let (quotient, _) = div_256(c >> (128 - left), c << left, sum);
    Some((quotient as u64).min(FULL))
}

/// a − b; `None` below zero.
fn minus(a: (u128, u128), b: (u128, u128)) -> Option<(u128, u128)> {
    let (low, borrow) = a.1.overflowing_sub(b.1);
    Some((a.0.checked_sub(b.0)?.checked_sub(u128::from(borrow))?, low))
}

/// √(high·2^128 + low) in units of 2^-fine, within 2^-94 relative and a unit. *Domain* the root is below 2^127 of these units, fine <= 64.
fn root_256(high: u128, low: u128, fine: u32) -> u128 {
    if high == 0 && low == 0 {
        return 0;
    }
    // The upper 128 bits, moved by an even number of bits, are 2^126 or more; the root of them is in units of 2^-32.
    let zeros = if high == 0 { 128 + low.leading_zeros() } else { high.leading_zeros() } & !1;
    let upper = match zeros {
        0 => high,
        1..128 => high << zeros | low >> (128 - zeros),
        _ => low << (zeros - 128),
    };
    // √(upper·2^(128 − zeros)) = root·2^(64 − zeros/2 − 32).
    let root = root_fine(upper);
    let left = 32 + fine as i32 - (zeros / 2) as i32;
    if left >= 0 { root << left } else { root >> -left }
}

/// The outward unit normal where a ray meets a shape; zero where it starts in it. *Error* 1 ulp in each component.
pub(crate) fn normal(core: &Core, ray: Point, end: RayEnd) -> Vec2 {
    let corners = core.corners();
    let count = corners.len();
    let of_edge = |i: usize| in_fx(outward(edge(corners, i))).normalize().unwrap_or_default();
    match end.feature {
        Feature::Inside => Vec2::default(),
        Feature::Edge(i) => of_edge(i),
        Feature::Disc(i) => in_fx(to_fine(ray, end.fraction, corners[i])).normalize().unwrap_or_default(),
        Feature::Corner(i) => {
            // The mean of the edges at the corner that the ray meets from outside.
            let met = [before(i, count), i].map(|k| count > 1 && cross(ray, edge(corners, k)) < 0);
            match met {
                [true, true] if count > 2 => (of_edge(before(i, count)) + of_edge(i)).normalize().unwrap_or_default(),
                [_, true] => of_edge(i),
                [true, false] => of_edge(before(i, count)),
                // Along a segment, or onto a point.
                [false, false] => -in_fx(ray).normalize().unwrap_or_default(),
            }
        }
    }
}

/// The segment of a chain on the other side of the seam that a ray meets, by its number.
pub(crate) fn beyond_seam<S: Scalar>(shape: &Shape<S>, part: u32, end: RayEnd) -> Option<u32> {
    let Geometry::Chain { closed, .. } = shape.geometry() else { return None };
    let last = shape.outlines().len() as u32 - 1;
    match end.feature {
        Feature::Corner(0) if part > 0 => Some(part - 1),
        Feature::Corner(0) => closed.then_some(last),
        Feature::Corner(_) if part < last => Some(part + 1),
        Feature::Corner(_) => closed.then_some(0),
        _ => None,
    }
}

/// [`normal`], and the mean with that of the segment beyond a seam if the ray meets that as well: neither of the two is preferred.
pub(crate) fn normal_at_seam(core: &Core, beyond: Option<Core>, ray: Point, end: RayEnd) -> Vec2 {
    let own_normal = normal(core, ray, end);
    let met = beyond.and_then(|next| {
        let met = ray_hit(&next, true, ray).filter(|met| met.fraction == end.fraction)?;
        Some(normal(&next, ray, met))
    });
    met.and_then(|met| (own_normal + met).normalize()).unwrap_or(own_normal)
}

/// The point at a fraction of a ray, ulps, rounded to nearest, halves away from zero.
#[inline(always)]
pub(crate) fn at(ray: Point, fraction: u64) -> Point {
    // Below 2^52·2^62.
    ray.map(|part| odd_shift(i128::from(part) * i128::from(fraction), FRACTION) as i64)
}

/// The vector from a corner to the point at a fraction of a ray, in units of 2^-8 ulp. *Domain* it is below 2^54 ulps.
fn to_fine(ray: Point, fraction: u64, corner: Point) -> Point {
    [0, 1].map(|k| {
        let way = i128::from(ray[k]) * i128::from(fraction) - (i128::from(corner[k]) << FRACTION);
        odd_shift(way, FRACTION - 8) as i64
    })
}
