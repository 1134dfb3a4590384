//! Sums of impulses in limbs beside sums in 128 bits.

use alloc::vec::Vec;

use super::made::Ranges;
use super::scene::by_exponent;
use crate::cases::run_seed;
use crate::kernel::simd::{self, Job, Lanes, Sums, VectorSet};
use crate::math::Random;
use crate::solve::Solver;
use crate::solve::group::Group;
use crate::solve::limbs::{Size, add_impulses, joined, lane_of, on_bodies};

/// Impulses and weighted impulses along x, y and of rotation.
type Totals = [[i128; 3]; 2];

/// The sums of groups that are not large.
struct AddGroups<'a> {
    groups: &'a [Group],
    rows: usize,
}

impl Job for AddGroups<'_> {
    type Result = Vec<Totals>;

    fn run<L: Lanes>(self, lanes: L) -> Vec<Totals> {
        let mut sums: Vec<Sums> = Vec::new();
        sums.resize(self.rows, Sums::default());
        for group in self.groups {
            for at in (0..group.count).step_by(L::WIDTH) {
                match Size::new(group, 6) {
                    Size::Small => add_impulses::<L, false>(lanes, group, at, &mut sums),
                    Size::Middle => add_impulses::<L, true>(lanes, group, at, &mut sums),
                    Size::Large => {}
                }
            }
        }
        sums.iter().map(joined).collect()
    }
}

/// The sums in 128 bits.
fn twin(groups: &[Group], rows: usize) -> Vec<Totals> {
    let mut totals = Vec::new();
    totals.resize(rows, Totals::default());
    for group in groups.iter().filter(|group| Size::new(group, 6) != Size::Large) {
        for lane in 0..group.count {
            for (set, impulses) in [&group.applied, &group.weighted].into_iter().enumerate() {
                let [x, y, turn_a, turn_b] = on_bodies(group, lane, lane_of(impulses, lane));
                for (row, change) in [(group.a[lane], [-x, -y, -turn_a]), (group.b[lane], [x, y, turn_b])] {
                    (0..3).for_each(|i| totals[row as usize][set][i] += change[i]);
                }
            }
        }
    }
    totals
}

/// Bodies and impulses of any size, and units finer and coarser than 2^-64 N·s.
#[test]
fn sums_in_limbs_are_exact() {
    let mut random = Random::seeded(run_seed(1));
    let mut counts = [0; 3];
    for _ in 0..2000 {
        let mass = [-24.0, 0.0, 12.0][random.below(3) as usize];
        let ranges = Ranges { mass: [mass, mass + 12.0], radius: [-6.0, 6.0], ..Ranges::default() };
        let scene = ranges.scene(&mut random, 6, 20);
        let mut solver = Solver::default();
        solver.prepare(scene.time_step, &scene.options, &scene.flights, &[], &scene.contacts);
        let groups = &mut solver.groups.groups;
        for group in groups.iter_mut() {
            let bits = 4.0 + random.below(52) as f64;
            for sums in [&mut group.applied, &mut group.weighted] {
                for impulse in sums.as_flattened_mut() {
                    let sign = if random.below(2) == 0 { 1 } else { -1 };
                    *impulse = sign * by_exponent(&mut random, bits - 4.0, bits) as i64;
                }
            }
            for lane in group.count..group.raise.len() {
                for sums in [&mut group.applied, &mut group.weighted] {
                    sums.iter_mut().for_each(|words| words[lane] = 0);
                }
            }
            let size = Size::new(group, 6);
            counts[[Size::Small, Size::Middle, Size::Large].iter().position(|&s| s == size).unwrap_or(0)] += 1;
        }
        let rows = solver.bodies.rows.len() as usize;
        let expected = twin(groups, rows);
        for set in VectorSet::available() {
            assert_eq!(simd::run_with(set, AddGroups { groups, rows }), expected, "{set:?}");
        }
    }
    assert!(counts.iter().all(|&count| count > 400), "{counts:?}");
}
