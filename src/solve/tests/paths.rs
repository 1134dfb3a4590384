//! The loops of the solver with each set of vector instructions, on random groups and bodies.

use crate::cases::{run_seed, times};
use alloc::vec::Vec;

use super::super::group::{Group, IMPULSE, SEPARATION};
use super::super::motion::{Advance, Begin, DISPLACEMENT, FlightRow, Rows, VELOCITY};
use super::super::pass::{Pass, PassOver};
use crate::kernel::simd::{GROUP, VectorSet, run_with};
use crate::kernel::sqrt::direction;

/// A generator of random numbers in ranges.
struct Random(u64);

impl Random {
    fn next(&mut self) -> i64 {
        self.0 = self.0.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
        (self.0 ^ self.0 >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9) as i64
    }

    fn below(&mut self, count: usize) -> usize {
        self.next() as usize % count
    }

    /// A number from −limit to limit: one of the ends, or one of any size.
    fn within(&mut self, limit: i64) -> i64 {
        match self.next() & 15 {
            0 => limit,
            1 => -limit,
            _ => (self.next() >> self.below(64)).clamp(-limit, limit),
        }
    }

    fn word(&mut self, limit: i64) -> i32 {
        self.within(limit) as i32
    }

    fn pair(&mut self, limit: i64) -> [i32; 2] {
        [self.word(limit), self.word(limit)]
    }

    /// A number from 0 to limit.
    fn positive(&mut self, limit: i64) -> i32 {
        self.within(limit).abs() as i32
    }
}

/// The sizes of quantities in a case. Ordinary ones end in no cut.
#[derive(Clone, Copy)]
struct Sizes {
    velocity: i64,
    displacement: i64,
    impulse: i64,
    /// Elements of the inverse matrix, before the shift.
    inverse: i64,
    angular_shift: usize,
}

const ORDINARY: Sizes =
    Sizes { velocity: 1 << 20, displacement: 1 << 20, impulse: 1 << 26, inverse: 1 << 26, angular_shift: 3 };
const LARGE: Sizes = Sizes {
    velocity: VELOCITY as i64,
    displacement: DISPLACEMENT as i64,
    impulse: IMPULSE,
    inverse: 1 << 30,
    angular_shift: 18,
};

/// A case: bodies, groups with some lanes unused, and the bodies that take their gains.
#[derive(Clone, Debug, PartialEq)]
struct Case {
    rows: Rows,
    groups: Vec<Group>,
    touched: Vec<u32>,
}

fn fill(random: &mut Random, group: &mut Group, lane: usize, bodies: usize, sizes: Sizes) {
    let body = |random: &mut Random| random.below(bodies) as u32;
    (group.a[lane], group.b[lane]) = (body(random), body(random));
    (group.normal[lane], _) = direction(random.next() >> 2, random.next() >> 2 | 1);
    let has_two_points = random.next() & 3 != 0;
    // The numbers of contacts of both bodies: more than there are, so that all of them may name the same body.
    let shares = [0, 1].map(|_| 32i64 << (random.next() & 3));
    let factors = shares.map(|share| (1 << 28) / share);
    (0..2).for_each(|side| group.gain_limit[side][lane] = (1 << 61) / shares[side]);
    for row in 0..3 {
        group.arms[row][lane] = random.pair(1 << 30);
        group.angular[row][lane] = factors.map(|limit| random.word(limit));
    }
    group.separation[lane] = [0, 1].map(|_| random.within(SEPARATION).max(-1 << 28) as i32);
    group.separation_now[lane] = [0, 1].map(|_| random.within(SEPARATION).max(-1 << 28) as i32);
    for k in 0..2 {
        group.linear_a[k][lane] = random.pair(factors[0]);
        group.linear_b[k][lane] = random.pair(factors[1]);
        group.inverse_12[k][lane] = random.pair(sizes.inverse);
    }
    for k in 0..4 {
        group.inverse[k][lane] =
            [random.positive(sizes.inverse), if has_two_points { random.positive(sizes.inverse) } else { 0 }];
    }
    group.angular_shift[lane] = random.below(sizes.angular_shift + 1) as i64;
    group.inverse_shift[lane] = [random.below(63), 20, 30, 40][random.below(4)] as i64;
    group.ratio_12[lane] = random.pair(1 << 30);
    group.ratio_21[lane] = random.pair(1 << 30);
    group.compliance[lane] = [random.positive(1 << 28), random.positive(1 << 28)];
    group.push_out[lane] = [random.positive(1 << 30), -random.positive(1 << 26)];
    group.friction[lane] = [random.positive(sizes.inverse), random.positive(i32::MAX.into())];
    group.coupling[lane] = random.pair(1 << 28);
    group.surface[lane] = [random.word(1 << 27), 0];
    for k in 0..3 {
        let impulse = random.within(sizes.impulse);
        group.impulses[k][lane] = if k < 2 { impulse.abs() } else { impulse };
        group.applied[k][lane] = random.within(1 << 50);
        group.weighted[k][lane] = random.within(1 << 54);
    }
}

fn case(random: &mut Random, sizes: impl Fn(&mut Random) -> Sizes) -> Case {
    let mut rows = Rows::default();
    rows.push(FlightRow::default(), i32::MAX);
    let size = sizes(random);
    for _ in 0..1 + random.below(20) {
        let velocity = |random: &mut Random| random.word(size.velocity);
        let mut vector = |limit: i64| [random.word(limit), random.word(limit), random.word(limit), 0];
        let start = vector(size.velocity);
        let change = vector(2 * size.velocity);
        let row = rows.push(FlightRow { start, change }, i32::MAX) as usize;
        rows.rows[row].displacement = vector(size.displacement);
        let angle = rows.rows[row].displacement[2];
        rows.rows[row].velocity = [velocity(random), velocity(random), velocity(random), angle];
        if random.next() & 1 == 0 {
            rows.rows[row].gain = [random.within(1 << 59), random.within(1 << 59), random.within(1 << 59), 0];
        }
    }
    let bodies = rows.rows.len();
    let mut groups = Vec::new();
    for _ in 0..random.below(4) {
        let mut group = Group::empty(0);
        group.count = 1 + random.below(GROUP);
        for lane in 0..group.count {
            let sizes = sizes(random);
            fill(random, &mut group, lane, bodies, sizes);
        }
        groups.push(group);
    }
    // All bodies: gains that no pass takes would add up from pass to pass.
    let touched = (0..bodies as u32).collect();
    Case { rows, groups, touched }
}

/// Sizes by chance: mostly ordinary, so that lanes that are cut stand beside lanes that are not.
fn mixed(random: &mut Random) -> Sizes {
    if random.next() & 7 == 0 { LARGE } else { ORDINARY }
}

/// Checks that a run over the cases of many seeds has the same result with each set. Returns the sum of the results without vectors.
fn check_sets(sizes: impl Fn(&mut Random) -> Sizes + Copy, run: impl Fn(VectorSet, &mut Case, u64) -> u64) -> u64 {
    (0..times(3_000))
        .map(|seed| {
            let start = case(&mut Random(run_seed(seed)), sizes);
            let mut expected = start.clone();
            let result = run(VectorSet::Portable, &mut expected, seed);
            for set in VectorSet::available().skip(1) {
                let mut case = start.clone();
                assert_eq!(run(set, &mut case, seed), result, "{set:?}, seed {seed}");
                assert!(case == expected, "{set:?}, seed {seed}:\n{case:#?}\n{expected:#?}");
            }
            result
        })
        .sum()
}

fn pass(set: VectorSet, case: &mut Case, pass: Pass) -> u64 {
    let Case { rows, groups, touched } = case;
    run_with(set, PassOver { pass, groups, rows, touched })
}

#[test]
fn passes_are_the_same_with_each_set() {
    for kind in [Pass::Solve, Pass::Relax, Pass::WarmStart] {
        for sizes in [|_: &mut Random| ORDINARY, mixed, |_: &mut Random| LARGE] {
            let cut = check_sets(sizes, |set, case, _| pass(set, case, kind));
            // The last two cut off.
            assert!(sizes(&mut Random(0)).velocity == ORDINARY.velocity || cut > 100, "{kind:?}: {cut}");
        }
    }
}

#[test]
fn motion_is_the_same_with_each_set() {
    for sizes in [|_: &mut Random| ORDINARY, mixed, |_: &mut Random| LARGE] {
        check_sets(sizes, |set, case, seed| {
            let n = 1 + (seed % 8) as u32;
            for k in 1..=n {
                run_with(set, Begin { rows: &mut case.rows, k, n });
                run_with(set, Advance { rows: &mut case.rows });
            }
            0
        });
    }
}

#[test]
fn steps_are_the_same_with_each_set() {
    for sizes in [|_: &mut Random| ORDINARY, mixed, |_: &mut Random| LARGE] {
        check_sets(sizes, |set, case, seed| {
            let n = 1 + (seed % 8) as u32;
            let mut cut = pass(set, case, Pass::WarmStart);
            for k in 1..=n {
                run_with(set, Begin { rows: &mut case.rows, k, n });
                cut += pass(set, case, Pass::Solve);
                run_with(set, Advance { rows: &mut case.rows });
                cut += pass(set, case, Pass::Relax);
            }
            cut
        });
    }
}
