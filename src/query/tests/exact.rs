//! Rational references.

use alloc::vec::Vec;
use core::cmp::Ordering;

use crate::cases::run_seed;
use dashu_int::IBig;

use super::cases::{case, cases};
use crate::math::Random;
use crate::query::ray::{FRACTION, FULL, first_entry, first_hit};
use crate::query::{Core, Point, RayEnd, Sum, at, contains, distance, nearest, point};

#[path = "../../../tests/support/rational.rs"]
mod rational;

use rational::{Ratio, Vector, cross, dot, minus, square_from_segment};

/// num / den.
fn ratio(num: IBig, den: IBig) -> Ratio {
    if den < IBig::ZERO { Ratio(-num, -den) } else { Ratio(num, den) }
}

fn int(x: impl Into<IBig>) -> IBig {
    x.into()
}

fn squared(x: impl Into<IBig>) -> IBig {
    let x: IBig = x.into();
    &x * &x
}

fn big(v: Point) -> Vector {
    v.map(IBig::from)
}

fn edges(corners: &[Vector]) -> impl Iterator<Item = (&Vector, &Vector)> {
    corners.iter().zip(corners.iter().cycle().skip(1))
}

/// The square of the distance of a point from a core.
fn square_from(p: &Vector, corners: &[Vector]) -> Ratio {
    let is_left = |(a, b): (&Vector, &Vector)| cross(&minus(b, a), &minus(p, a)) >= IBig::ZERO;
    if corners.len() > 2 && edges(corners).all(is_left) {
        return Ratio(IBig::ZERO, IBig::ONE);
    }
    edges(corners).map(|(a, b)| square_from_segment(p, a, b)).min_by(Ratio::cmp).expect("a corner")
}

/// The fraction at which a ray from the origin enters a core without a radius, from 0 to 1, by clipping.
fn entry(corners: &[Vector], ray: &Vector) -> Option<Ratio> {
    let zero = Ratio(IBig::ZERO, IBig::ONE);
    let (mut first, mut last) = (zero.clone(), Ratio(IBig::ONE, IBig::ONE));
    // t·n·ray <= n·a for all of these half planes.
    let mut planes: Vec<(IBig, IBig)> = Vec::new();
    for (a, b) in edges(corners) {
        let e = minus(b, a);
        planes.push((cross(ray, &e), cross(a, &e)));
        if corners.len() == 2 {
            // Not beyond the end.
            planes.push((dot(ray, &e), dot(b, &e)));
        }
    }
    if let [only] = corners {
        for sign in [1, -1] {
            planes.push((cross(ray, only) * int(sign), IBig::ZERO));
            planes.extend((0..2).map(|k| (&ray[k] * int(sign), &only[k] * int(sign))));
        }
    }
    for (along, limit) in planes {
        let bound = || ratio(limit.clone(), along.clone());
        match along.cmp(&IBig::ZERO) {
            Ordering::Equal if limit < IBig::ZERO => return None,
            Ordering::Equal => {}
            Ordering::Less => first = if bound().cmp(&first).is_gt() { bound() } else { first },
            Ordering::Greater => last = if bound().cmp(&last).is_lt() { bound() } else { last },
        }
    }
    first.cmp(&last).is_le().then_some(first)
}

fn corners_of(core: &Core) -> Vec<Vector> {
    core.corners().iter().copied().map(big).collect()
}

#[test]
fn containment_and_the_nearest_point_are_those_of_the_definition() {
    let (mut random, mut inside, mut border) = (Random::seeded(run_seed(1)), 0, 0);
    for i in 0..cases() {
        let case = case(&mut random);
        let (core, corners) = (&case.core, corners_of(&case.core));
        let square = square_from(&big([0; 2]), &corners);
        let order = square.cmp(&Ratio(squared(core.radius), IBig::ONE));
        assert_eq!(contains(core), order.is_le(), "{i}: {core:?}");
        inside += u32::from(order.is_lt());
        border += u32::from(order.is_eq());
        let closest = nearest(core.corners());
        let away = distance(core, closest);
        let (surface, towards) = point(core, closest, away);
        if order.is_le() {
            assert_eq!((away, surface), (0, [0; 2]), "{i}: {core:?}");
            continue;
        }
        // Within 0.51 units of 2^-16 ulp.
        let from_core = int(away + ((core.radius as u128) << 16)) * int(100);
        let exact = Ratio((square.0 << 32) * int(10_000), square.1);
        for (ulps, wanted) in [(-51, Ordering::Less), (51, Ordering::Greater)] {
            let bound: IBig = &from_core + IBig::from(ulps);
            assert!(
                bound < IBig::ZERO || Ratio(squared(bound.clone()), IBig::ONE).cmp(&exact) == wanted,
                "{i}: {core:?}"
            );
        }
        // Twice the point: within √½ and a little of the surface, and as far from the origin as is said.
        let p = big(surface);
        let near_surface = square_from(&p, &corners);
        let bound = Ratio(squared(int(core.radius) * int(4) + int(3)), IBig::from(16));
        assert!(near_surface.cmp(&bound).is_le(), "{i}: {core:?} {surface:?}");
        let whole = dot(&p, &p) << 32;
        let (min, max) = ((away as i128) - 49_152, away as i128 + 49_152);
        assert!(whole >= squared(min.max(0)) && whole <= squared(max), "{i}: {core:?} {surface:?}");
        assert!(cross(&big(towards), &p).is_zero() || core.corners().len() > 1 || core.radius > 0);
    }
    assert!(inside > cases() / 50 && border > cases() / 200, "{inside}, {border}");
}

#[test]
fn rays_enter_sharp_cores_where_clipping_says_to_the_last_bit() {
    let (mut random, mut hits, mut corners_hit, mut ends) = (Random::seeded(run_seed(2)), 0, 0, 0);
    for i in 0..2 * cases() {
        let mut case = case(&mut random);
        case.core.radius = 0;
        let expected = entry(&corners_of(&case.core), &big(case.ray)).map(|t| (t.0 << FRACTION as usize) / t.1);
        let actual = first_hit(&case.core, case.ray);
        assert_eq!(actual.map(|end| end.fraction.into()), expected, "{i}: {case:?}");
        hits += u32::from(actual.is_some_and(|end| end.fraction > 0));
        ends += u32::from(actual.is_some_and(|end| end.fraction == FULL));
        corners_hit +=
            u32::from(actual.is_some_and(|end| matches!(end.feature, crate::query::ray::Feature::Corner(_))));
    }
    assert!(hits > cases() / 10 && ends > cases() / 200 && corners_hit > cases() / 20, "{hits}, {ends}, {corners_hit}");
}

/// The fraction from which on a ray from the origin is in the inside of a core of three corners or more, by clipping its line with open half planes.
fn inner_entry(corners: &[Vector], ray: &Vector) -> Option<Ratio> {
    let (mut first, mut last): (Option<Ratio>, Option<Ratio>) = (None, None);
    for (a, b) in edges(corners) {
        let e = minus(b, a);
        // t·ray × e < a × e.
        let (along, limit) = (cross(ray, &e), cross(a, &e));
        let bound = ratio(limit.clone(), if along.is_zero() { IBig::ONE } else { along.clone() });
        match along.cmp(&IBig::ZERO) {
            Ordering::Equal if limit <= IBig::ZERO => return None,
            Ordering::Equal => {}
            Ordering::Less => first = Some(first.filter(|first| first.cmp(&bound).is_ge()).unwrap_or(bound)),
            Ordering::Greater => last = Some(last.filter(|last| last.cmp(&bound).is_le()).unwrap_or(bound)),
        }
    }
    let zero = Ratio(IBig::ZERO, IBig::ONE);
    // Without a ray only what starts inside is there.
    let Some((first, last)) = first.zip(last) else { return Some(zero) };
    let first = if first.cmp(&zero).is_lt() { zero.clone() } else { first };
    let is_met = first.cmp(&last).is_lt() && first.cmp(&Ratio(IBig::ONE, IBig::ONE)).is_le();
    is_met.then_some(first)
}

#[test]
fn ways_lead_into_sharp_cores_where_clipping_with_open_half_planes_says() {
    let (mut random, mut hits, mut starts, mut grazes) = (Random::seeded(run_seed(7)), 0, 0, 0);
    for i in 0..2 * cases() {
        let mut case = case(&mut random);
        case.core.radius = 0;
        if i % 3 == 0 {
            // From a corner, or from the middle of an edge.
            let corners = case.core.corners();
            let (from, to) = (corners[0], corners[corners.len() - 1]);
            let place = if i % 2 == 0 { from } else { [0, 1].map(|k| from[k] + (to[k] - from[k]) / 2) };
            case.core = case.core.seen_from(place, 0);
        }
        if case.core.corners().len() < 3 {
            continue;
        }
        let corners = corners_of(&case.core);
        let expected = inner_entry(&corners, &big(case.ray)).map(|t| (t.0 << FRACTION as usize) / t.1);
        let actual = first_entry(&case.core, case.ray);
        assert_eq!(actual.map(|end| end.fraction.into()), expected, "{i}: {case:?}");
        let normal = actual.map(|end| crate::query::normal(&case.core, case.ray, end));
        hits += u32::from(actual.is_some_and(|end| end.fraction > 0));
        starts += u32::from(actual.is_some_and(|end| end.fraction == 0) && normal != Some(Default::default()));
        grazes += u32::from(actual.is_none() && first_hit(&case.core, case.ray).is_some());
    }
    assert!(hits > cases() / 10 && starts > cases() / 20 && grazes > cases() / 20, "{hits}, {starts}, {grazes}");
}

/// Discs and capsules on a lattice of lengths of 5 and of multiples of it, where tangents are exact.
#[test]
fn ways_lead_into_rounded_shapes_from_their_surface_and_along_no_tangent() {
    let mut random = Random::seeded(run_seed(8));
    let (mut counts, mut tangents) = ([0; 3], 0);
    for i in 0..cases() {
        let unit = 1 << (random.bits() % 30);
        let scaled = |v: [i64; 2]| v.map(|part| part * unit);
        let [x, y] = [[3, 4], [4, 3], [5, 0], [0, 5], [-3, 4], [-5, 0]][(random.bits() % 6) as usize];
        let disc = Core::of(&[scaled([-x, -y])], 5 * unit);
        let ray = scaled([(random.bits() % 17) as i64 - 8, (random.bits() % 17) as i64 - 8]);
        // The origin is on the disc, whose outward normal there is (x, y).
        let towards = ray[0] * x / unit + ray[1] * y / unit;
        let end = first_entry(&disc, ray);
        assert_eq!(end.map(|end| end.fraction), (towards < 0).then_some(0), "{i}: {disc:?} {ray:?}");
        counts[usize::from(towards < 0) + usize::from(towards <= 0)] += 1;
        // A line that is as far from the middle as the radius, and one that is an ulp nearer.
        for nearer in [0, 1] {
            let far =
                Core::of(&[scaled([20 * y - x, -20 * x - y]).map(|part| part - nearer * part.signum())], 5 * unit);
            let tangent = scaled([40 * y, -40 * x]);
            let distance = crate::query::cross(tangent, far.corners()[0]).unsigned_abs();
            let is_inside = crate::kernel::wide::mul_128(distance, distance)
                < crate::kernel::wide::mul_128(25 * (unit as u128).pow(2), crate::query::dot(tangent, tangent) as u128);
            assert_eq!(first_entry(&far, tangent).is_some(), is_inside, "{i}: {far:?} {tangent:?}");
            assert!(first_hit(&far, tangent).is_some() || !is_inside);
            tangents += u32::from(!is_inside && first_hit(&far, tangent).is_some());
        }
    }
    assert!(counts.iter().all(|count| *count > cases() / 50) && tangents > cases() / 10, "{counts:?} {tangents}");
}

/// The point at a fraction of a ray, and corners, in units of 2^-62 ulp.
fn scaled(ray: Point, fraction: &IBig, corners: &[Vector]) -> (Vector, Vec<Vector>) {
    let up = |v: &Vector| [&v[0] << FRACTION as usize, &v[1] << FRACTION as usize];
    (big(ray).map(|part| part * fraction), corners.iter().map(up).collect())
}

/// Compares the distance between a core and the point at a fraction of a ray with the radius and 2^-20 ulp times `more`.
fn compare(core: &Core, ray: Point, fraction: &IBig, more: i64) -> Ordering {
    let (p, corners) = scaled(ray, fraction, &corners_of(core));
    let reach = (int(core.radius) << 62) + (int(more) << 42);
    if reach < IBig::ZERO {
        return Ordering::Greater;
    }
    square_from(&p, &corners).cmp(&Ratio(squared(reach), IBig::ONE))
}

/// The least distance of a core from a ray, compared with the radius and 2^-20 ulp times `more`.
fn compare_least(core: &Core, ray: Point, more: i64) -> Ordering {
    let corners = corners_of(core);
    let (start, end) = (big([0; 2]), big(ray));
    if entry(&corners, &end).is_some() {
        return Ordering::Less;
    }
    let ends = [&start, &end].map(|p| square_from(p, &corners));
    let distances = corners.iter().map(|corner| square_from_segment(corner, &start, &end));
    let Ratio(num, den) = distances.chain(ends).min_by(Ratio::cmp).expect("a corner");
    let reach = (int(core.radius) << 20) + int(more);
    if reach < IBig::ZERO {
        return Ordering::Greater;
    }
    Ratio(num << 40, den).cmp(&Ratio(squared(reach), IBig::ONE))
}

#[test]
fn rays_enter_rounded_shapes_within_a_fraction_of_an_ulp_of_the_surface() {
    let (mut random, mut hits, mut misses) = (Random::seeded(run_seed(3)), 0, 0);
    for i in 0..2 * cases() {
        let case = case(&mut random);
        let (core, ray) = (&case.core, case.ray);
        if core.radius == 0 {
            continue;
        }
        // 2^-14 ulp less of a radius, and half as much as the ray goes on in a unit of its fraction.
        let slack = 64 + ((ray[0].abs().max(ray[1].abs()) as i128) >> 41) as i64;
        match first_hit(core, ray) {
            None => {
                misses += 1;
                assert!(compare_least(core, ray, -64).is_gt(), "{i}: {case:?}");
            }
            Some(RayEnd { fraction: 0, .. }) if contains(core) => {}
            Some(end) => {
                hits += 1;
                let fraction = IBig::from(end.fraction);
                // At the end it is at the surface, neither deeper nor before it.
                assert!(compare(core, ray, &fraction, -slack).is_ge(), "{i}: {case:?} too late");
                assert!(compare(core, ray, &fraction, slack).is_le(), "{i}: {case:?} too early");
                // It comes from outside: the distance, which is convex along the ray, is no less before.
                let before = fraction.clone() * int(9) / int(10);
                assert!(compare(core, ray, &before, -64).is_ge(), "{i}: {case:?}");
            }
        }
    }
    assert!(hits > cases() / 10 && misses > cases() / 4, "{hits}, {misses}");
}

#[test]
fn a_sum_has_the_hull_of_all_differences() {
    let mut random = Random::seeded(run_seed(4));
    for i in 0..cases() / 4 {
        let case = case(&mut random);
        let (a, b) = (&case.core, &case.other);
        let sum = Sum::new(a, b);
        let all: Vec<Point> =
            b.corners().iter().flat_map(|q| a.corners().iter().map(|p| [q[0] - p[0], q[1] - p[1]])).collect();
        let hull = Core::of(&all, a.radius + b.radius);
        let mut corners = sum.core.corners().to_vec();
        let first = corners.iter().position(|corner| *corner == hull.corners()[0]).expect("a corner of the hull");
        corners.rotate_left(first);
        assert_eq!((corners.as_slice(), sum.core.radius), (hull.corners(), hull.radius), "{i}: {case:?}");
        for (corner, [j, k]) in sum.core.corners().iter().zip(&sum.pairs) {
            assert_eq!(*corner, [0, 1].map(|axis| b.corners()[*k][axis] - a.corners()[*j][axis]));
        }
    }
}

#[test]
fn shapes_that_are_cast_touch_where_they_are_said_to() {
    let (mut random, mut hits) = (Random::seeded(run_seed(5)), 0);
    for i in 0..cases() {
        let case = case(&mut random);
        let (a, b) = (&case.core, &case.other);
        let sum = Sum::new(a, b);
        // Towards a corner of the sum, and on, or anywhere.
        let aim = sum.core.corners()[(random.bits() % sum.core.corners().len() as u64) as usize];
        let aimed = aim.map(|part| (2 * part).clamp(-(1 << 52), 1 << 52));
        let ray = if random.bits() % 4 == 0 { case.ray } else { aimed };
        let Some(end) = first_hit(&sum.core, ray) else { continue };
        let normal = crate::query::normal(&sum.core, ray, end);
        let touch = sum.touch_point([a, b], ray, end, normal);
        if end.feature == crate::query::ray::Feature::Inside {
            assert_eq!((touch, normal), ([0; 2], Default::default()));
            continue;
        }
        hits += 1;
        // The point is on the surface of B, and of A at the place where it is then, within 4 ulps and the error of the normal.
        let p = big(touch);
        let moved: Vec<Vector> = {
            let way = at(ray, end.fraction);
            a.corners().iter().map(|corner| big([corner[0] + way[0], corner[1] + way[1]])).collect()
        };
        let slack = 4 + ((a.radius + b.radius) >> 31);
        for (corners, radius) in [(corners_of(b), b.radius), (moved, a.radius)] {
            let square = square_from(&p, &corners);
            let max = squared(radius + slack);
            assert!(square.cmp(&Ratio(max, IBig::ONE)).is_le(), "{i}: {case:?} {touch:?}");
            let min = squared((radius - slack).max(0));
            assert!(square.cmp(&Ratio(min, IBig::ONE)).is_ge(), "{i}: {case:?} {touch:?}");
        }
    }
    assert!(hits > cases() / 10, "{hits}");
}
