//! Manifolds against their definition in exact numbers.
//!
//! Corners are turned by angles with 160 bits; products, comparisons and quotients are of integers of any size. The reference shares no
//! code with the narrow phase. Where a choice (which of two directions, whether an edge is flat) is within the rounding of the narrow
//! phase, any of the manifolds that follow is right.

mod expected;
mod geometry;
mod numbers;
mod points;

use expected::expected;
use geometry::Pair;
use numbers::{FRACTION, ulps};
use points::Contact;

use crate::collide::fairness;
use crate::collide::pairs::{Case, KINDS, lattice_case, random_case, resting_case, tied_case};
use crate::collide::random::SplitMix;
use dashu_int::IBig;
use umbra_physics::Fx;
use umbra_physics::collide::Manifold;

/// Counts, and the largest errors.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    counts: [usize; 3],
    /// Pairs with several normals of exactly the largest separation.
    tied: usize,
    /// Pairs with a choice within rounding.
    unsure: usize,
    /// The largest error of a component of a normal, in units of 2^-30, and in units of its bound.
    normal: [f64; 2],
    /// The largest error of a separation, in ulps of pairs below 1 m and in units of its bound.
    separation: [f64; 2],
    /// The largest error of a point, likewise.
    point: [f64; 2],
    /// The largest error of the least separation of cores that are apart, against their distance, in units of the bound.
    distance: f64,
}

fn larger(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0].max(b[0]), a[1].max(b[1])]
}

/// Returns true for the name of a corner and a corner.
fn is_of_corners(name: u32) -> bool {
    let part = |at: u32| name >> at & 63;
    part(0) == part(6) && part(12) == part(18)
}

/// The errors of a manifold: of the normal, of separations and of points, each in its unit and in units of its bound. `None` if it is
/// another one.
fn errors(pair: &Pair, manifold: &Manifold, contact: &Contact) -> Option<[[f64; 2]; 3]> {
    let part = |i: usize| (f64::from(manifold.normal[i]) - contact.normal[i] * 2f64.powi(30)).abs();
    let normal = part(0).max(part(1));
    let mut errors = [[normal, normal / (contact.bound + 1e-6)], [0.0; 2], [0.0; 2]];
    if manifold.count != contact.points.len() {
        return None;
    }
    let size = pair.cores[0].extent.max(pair.cores[1].extent);
    let is_small = size < 2f64.powi(32) && contact.bound <= 1.0;
    for (point, expected) in manifold.points.iter().zip(&contact.points) {
        let off = |value: Fx, exact: &IBig| ulps(&((IBig::from(value.to_bits()) << FRACTION) - exact)).abs();
        let apart = off(point.separation, &expected.separation);
        let away = off(point.arm_a.x, &expected.at[0]).max(off(point.arm_a.y, &expected.at[1]));
        let shown = |error: f64| if is_small && expected.bounds[0] < 5.0 { error } else { 0.0 };
        errors[1] = larger(errors[1], [shown(apart), apart / expected.bounds[0]]);
        errors[2] = larger(errors[2], [shown(away), away / expected.bounds[1]]);
        if expected.feature.is_some_and(|feature| point.feature != feature) {
            return None;
        }
    }
    Some(errors)
}

impl Seen {
    fn check(&mut self, random: &mut SplitMix, case: &Case, is_exact: bool) {
        let manifold = fairness::check(random, case);
        let pair = Pair::new(case, is_exact);
        let all = expected(&pair, manifold.as_ref());
        assert!(!all.is_empty(), "{case:?}");
        self.counts[manifold.map_or(0, |manifold| manifold.count)] += 1;
        self.unsure += usize::from(all.len() > 1);
        self.tied += usize::from(is_exact && pair.ties() > 1);
        let Some(manifold) = manifold else {
            assert!(all.iter().any(Option::is_none), "no manifold, not {all:#?}: {case:?}");
            return;
        };
        let of_all = all.iter().flatten().filter_map(|contact| errors(&pair, &manifold, contact));
        let worst = |errors: &[[f64; 2]; 3]| errors.iter().map(|error| error[1]).fold(0.0, f64::max);
        let best = of_all.min_by(|a, b| worst(a).total_cmp(&worst(b)));
        let Some(errors) = best.filter(|errors| worst(errors) <= 1.0) else {
            panic!("{best:?}: {manifold:#?}\nnot {all:#?}\nof {case:?}");
        };
        self.normal = larger(self.normal, errors[0]);
        self.separation = larger(self.separation, errors[1]);
        self.point = larger(self.point, errors[2]);
        self.check_distance(case, &pair, &manifold);
    }

    /// Cores that are apart have their distance for the least separation.
    fn check_distance(&mut self, case: &Case, pair: &Pair, manifold: &Manifold) {
        let Some(distance) = pair.distance().filter(|&distance| distance > pair.far + pair.choice) else {
            return;
        };
        let least = manifold.points[..manifold.count].iter().map(|point| point.separation.to_bits()).min();
        let radii = pair.cores[0].radius + pair.cores[1].radius;
        let is_between_corners = manifold.count == 1 && is_of_corners(manifold.points[0].feature);
        let bound = pair.bound(distance) + pair.flatness() + if is_between_corners { pair.far_ends() } else { 0.0 };
        let error = (least.expect("a point") as f64 + radii as f64 - distance).abs() / bound;
        assert!(error <= 1.0, "{distance}: {manifold:#?}\nof {case:?}");
        self.distance = self.distance.max(error);
    }
}

/// A share of the pairs, perhaps within rounding of a choice.
fn check_cases(name: &str, count: usize, is_exact: bool, mut case: impl FnMut(&mut SplitMix) -> Case) -> Seen {
    let mut random = SplitMix::seeded(name.bytes().fold(0, |seed, byte| seed << 5 ^ seed >> 59 ^ u64::from(byte)));
    let mut tally = Seen::default();
    for _ in 0..count {
        let case = case(&mut random);
        tally.check(&mut random, &case, is_exact);
    }
    println!("{name}: {tally:?}");
    tally
}

/// A size for each of two shapes: the same in most cases.
fn exponents(random: &mut SplitMix) -> [u32; 2] {
    let exponent = random.between(27, 42) as u32;
    [exponent, if random.between(0, 3) == 0 { random.between(27, 42) as u32 } else { exponent }]
}

#[test]
fn manifolds_of_random_pairs_are_those_of_exact_numbers() {
    let share = super::exact_cases() / 2 / KINDS.len() / KINDS.len();
    for first in KINDS {
        for second in KINDS {
            let tally = check_cases(&format!("{first}, {second}"), share, false, |random| {
                let exponents = exponents(random);
                random_case(random, [first, second], exponents)
            });
            assert!(tally.unsure * 1000 <= share, "{first}, {second}: {tally:?}");
        }
    }
}

#[test]
fn manifolds_of_parallel_and_tied_edges_are_those_of_exact_numbers() {
    let share = super::exact_cases() / 8;
    check_cases("resting", share, false, |random| {
        let exponents = exponents(random);
        resting_case(random, exponents)
    });
    check_cases("tied", share, false, tied_case);
}

#[test]
fn exact_ties_are_resolved_by_the_rule() {
    let count = super::exact_cases() / 4;
    let tally = check_cases("lattice", count, true, lattice_case);
    assert!(tally.unsure == 0 && tally.tied > count / 4 && tally.counts.iter().all(|&n| n > count / 5), "{tally:?}");
}
