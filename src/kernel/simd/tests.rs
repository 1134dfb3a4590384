//! Each operation of each set beside [`Portable`], lane by lane.

mod long;

use super::*;
use crate::cases::{run_seed, times};
use alloc::{vec, vec::Vec};

/// An operation by its name, and its result in each lane.
type Results = Vec<(&'static str, [i64; GROUP])>;

/// Random bits.
struct Random(u64);

impl Random {
    fn next(&mut self) -> i64 {
        self.0 = self.0.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
        (self.0 ^ self.0 >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9) as i64
    }

    /// Any size is as likely as any other.
    fn number(&mut self, bits: u32) -> i64 {
        let cut = 64 - bits + self.next() as u32 % bits;
        self.next() >> cut
    }
}

/// Powers of two with their neighbours, and the negatives.
fn edges(bits: u32) -> Vec<i64> {
    let mut edges = vec![0, -1 << (bits - 1)];
    for power in (0..bits - 1).map(|k| 1i64 << k) {
        edges.extend([power - 1, power, power + 1].iter().flat_map(|&edge| [edge, -edge]));
    }
    edges.push(((1u64 << (bits - 1)) - 1) as i64);
    edges
}

/// Operands for a group: an edge in one lane, or in all of them, or none, and random numbers elsewhere.
fn operands(random: &mut Random, edges: &[i64], bits: u32) -> [i64; GROUP] {
    let (edge, lanes) = (edges[random.next() as usize % edges.len()], random.next() & random.next());
    let mut words = [0; GROUP];
    for (lane, word) in words.iter_mut().enumerate() {
        *word = match lanes >> lane & 3 {
            0 => random.number(bits),
            1 => edge,
            2 => edges[random.next() as usize % edges.len()],
            _ => edge.wrapping_neg(),
        };
    }
    words
}

fn pairs(random: &mut Random, edges: &[i64]) -> Pairs {
    let (a, b) = (operands(random, edges, 32), operands(random, edges, 32));
    core::array::from_fn(|lane| [a[lane] as i32, b[lane] as i32])
}

/// The operands with zero in lanes where they are outside of a domain.
fn within<const N: usize>(operands: [[i64; GROUP]; N], domain: impl Fn([i64; N]) -> bool) -> [[i64; GROUP]; N] {
    let mut operands = operands;
    for lane in 0..GROUP {
        if !domain(operands.map(|words| words[lane])) {
            operands.iter_mut().for_each(|words| words[lane] = 0);
        }
    }
    operands
}

/// A narrow vector as words: what the lower halves hold.
fn narrow<L: Lanes>(lanes: L, words: &mut [i64; GROUP], at: usize, value: L::Narrow) {
    lanes.store(words, at, lanes.times(value, lanes.splat(1)));
}

/// Operations on narrow vectors: the upper halves hold other numbers.
struct Narrows {
    /// Sums and differences of the operands fit.
    small: [Pairs; 2],
    any: [Pairs; 2],
    words: [i64; GROUP],
}

impl Job for Narrows {
    type Result = Results;

    fn run<L: Lanes>(self, lanes: L) -> Results {
        let names = ["plus", "minus", "at_least", "at_most", "if_positive", "none_positive", "times", "low", "splat"];
        let names = names.into_iter().chain(["first of a pair", "second of a pair"]);
        let mut results: Results = names.map(|name| (name, [0; GROUP])).collect();
        let mut is_none_positive = true;
        for at in (0..GROUP).step_by(L::WIDTH) {
            let ((a, _), (b, b_second)) = (lanes.pair(&self.small[0], at), lanes.pair(&self.small[1], at));
            let ((c, d), (e, f)) = (lanes.pair(&self.any[0], at), lanes.pair(&self.any[1], at));
            let low = lanes.low(lanes.wide(&self.words, at));
            // The sums of these bring a carry, or a borrow, into the upper halves.
            narrow(lanes, &mut results[0].1, at, lanes.plus(lanes.plus(a, b), b_second));
            narrow(lanes, &mut results[1].1, at, lanes.minus(lanes.minus(a, b), b_second));
            narrow(lanes, &mut results[2].1, at, lanes.at_least(c, d));
            narrow(lanes, &mut results[3].1, at, lanes.at_most(c, d));
            narrow(lanes, &mut results[4].1, at, lanes.if_positive(c, e, f));
            is_none_positive &= lanes.none_positive(c, e);
            lanes.store(&mut results[6].1, at, lanes.times(c, d));
            narrow(lanes, &mut results[7].1, at, low);
            narrow(lanes, &mut results[8].1, at, lanes.splat(self.any[0][0][0]));
            let mut pairs = [[0; 2]; GROUP];
            lanes.put_pair(&mut pairs, at, (c, f));
            let (first, second) = lanes.pair(&pairs, at);
            narrow(lanes, &mut results[9].1, at, first);
            narrow(lanes, &mut results[10].1, at, second);
        }
        results[5].1[0] = i64::from(is_none_positive);
        results
    }
}

/// Operations on wide vectors, with operands in their domains.
struct Wides {
    sum: [[i64; GROUP]; 2],
    any: [[i64; GROUP]; 3],
    limit: [i64; GROUP],
    shift: [i64; GROUP],
    /// Room for the half that is added before a shift.
    rounded: [i64; GROUP],
    raised: [[i64; GROUP]; 2],
    load: [i64; GROUP],
    factor: Pairs,
    /// From 2^30 to 2^31 − 1.
    divisor: [i64; GROUP],
}

impl Wides {
    fn new(random: &mut Random, edges: &[i64], narrow_edges: &[i64]) -> Self {
        let mut any = || operands(random, edges, 64);
        let [limit] = within([any()], |[limit]| limit >= 0);
        let [rounded] = within([any()], |[a]| a.unsigned_abs() < (1 << 63) - (1 << 29));
        let [load] = within([any()], |[load]| (0..1 << 58).contains(&load));
        let sum = within([any(), any()], |[a, b]| a.checked_add(b).is_some() && a.checked_sub(b).is_some());
        let divisor = any().map(|word| 1 << 30 | word & ((1 << 30) - 1));
        let (any, shift) = ([any(), any(), any()], any().map(|bits| bits & 63));
        let raised = within([any[0], any[1].map(|bits| bits & 63)], |[a, bits]| (a << bits) >> bits == a);
        let factor = pairs(random, narrow_edges).map(|[a, b]| [a.max(0), b]);
        Self { sum, any, limit, shift, rounded, raised, load, factor, divisor }
    }
}

impl Job for Wides {
    type Result = Results;

    fn run<L: Lanes>(self, lanes: L) -> Results {
        let mut results = Results::new();
        // One operation over the group, by its result in a vector at a place.
        macro_rules! operation {
            ($name:literal, |$at:ident| $result:expr) => {{
                let mut words = [0; GROUP];
                (0..GROUP).step_by(L::WIDTH).for_each(|$at| lanes.store(&mut words, $at, $result));
                results.push(($name, words));
            }};
            (narrow $name:literal, |$at:ident| $result:expr) => {{
                let mut words = [0; GROUP];
                (0..GROUP).step_by(L::WIDTH).for_each(|$at| narrow(lanes, &mut words, $at, $result));
                results.push(($name, words));
            }};
        }
        let [a, b, c] = [0, 1, 2].map(|k| move |at: usize, any: &[[i64; GROUP]; 3]| lanes.wide(&any[k], at));
        let words_at = |words: &[i64; GROUP], at: usize| lanes.wide(words, at);
        operation!("add", |at| lanes.add(words_at(&self.sum[0], at), words_at(&self.sum[1], at)));
        operation!("sub", |at| lanes.sub(words_at(&self.sum[0], at), words_at(&self.sum[1], at)));
        operation!("if_negative", |at| lanes.if_negative(a(at, &self.any), b(at, &self.any), c(at, &self.any)));
        operation!("positive", |at| lanes.positive(a(at, &self.any)));
        operation!("larger", |at| lanes.larger(words_at(&self.sum[0], at), words_at(&self.sum[1], at)));
        operation!("smaller", |at| lanes.smaller(words_at(&self.sum[0], at), words_at(&self.sum[1], at)));
        operation!("clamped", |at| lanes.clamped(a(at, &self.any), words_at(&self.limit, at)));
        operation!(narrow "capped", |at| lanes.capped(words_at(&self.limit, at)));
        operation!("floored 28", |at| lanes.floored::<28>(a(at, &self.any)));
        operation!("floored 30", |at| lanes.floored::<30>(a(at, &self.any)));
        operation!("floored_by", |at| lanes.floored_by(a(at, &self.any), words_at(&self.shift, at)));
        operation!(narrow "rounded", |at| lanes.rounded(words_at(&self.rounded, at)));
        operation!("rounded_oddly 24", |at| lanes.rounded_oddly::<24>(words_at(&self.rounded, at)));
        operation!("rounded_oddly 27", |at| lanes.rounded_oddly::<27>(words_at(&self.rounded, at)));
        operation!("rounded_oddly 30", |at| lanes.rounded_oddly::<30>(words_at(&self.rounded, at)));
        operation!("raised_by", |at| lanes.raised_by(words_at(&self.raised[0], at), words_at(&self.raised[1], at)));
        operation!("all", |_at| lanes.all(self.any[0][0]));
        operation!("bit_length", |at| lanes.bit_length(words_at(&self.limit, at)));
        operation!("larger", |at| lanes.larger(a(at, &self.any), b(at, &self.any)));
        operation!("smaller", |at| lanes.smaller(a(at, &self.any), b(at, &self.any)));
        operation!("magnitude", |at| lanes.magnitude(words_at(&self.rounded, at)));
        // The portable one divides.
        operation!(narrow "reciprocal", |at| lanes.reciprocal(lanes.low(words_at(&self.divisor, at))));
        operation!("share", |at| lanes.share(lanes.pair(&self.factor, at).0, words_at(&self.load, at)));
        results
    }
}

/// Comparisons, and what masks are made of.
struct Masks {
    words: [[i64; GROUP]; 4],
}

impl Masks {
    fn new(random: &mut Random, edges: &[i64]) -> Self {
        let mut words = [0; 4].map(|_| operands(random, edges, 64));
        // Equal words in some lanes.
        let lanes = random.next();
        (0..GROUP).filter(|lane| lanes >> lane & 1 == 1).for_each(|lane| words[1][lane] = words[0][lane]);
        Self { words }
    }
}

impl Job for Masks {
    type Result = ([u32; 6], [i64; GROUP]);

    fn run<L: Lanes>(self, lanes: L) -> Self::Result {
        let (mut bits, mut selected) = ([0; 6], [0; GROUP]);
        for at in (0..GROUP).step_by(L::WIDTH) {
            let [a, b, c, d] = [0, 1, 2, 3].map(|k: usize| lanes.wide(&self.words[k], at));
            let (greater, equal) = (lanes.greater(c, d), lanes.equal(a, b));
            let masks = [
                greater,
                equal,
                lanes.both(greater, equal),
                lanes.either(greater, equal),
                lanes.unless(greater, equal),
                lanes.unlike(greater, equal),
            ];
            for (bits, mask) in bits.iter_mut().zip(masks) {
                *bits |= lanes.bits(mask) << at;
            }
            lanes.store(&mut selected, at, lanes.select(greater, a, c));
        }
        (bits, selected)
    }
}

/// Lines that an index names.
struct Lines {
    lines: Vec<Line>,
    index: [u32; GROUP],
}

impl Lines {
    fn new(random: &mut Random) -> Self {
        let count = 1 + random.next() as usize % 12;
        let lines = (0..count).map(|_| Line(core::array::from_fn(|_| random.next()))).collect();
        Self { lines, index: core::array::from_fn(|_| random.next() as u32 % count as u32) }
    }
}

impl Job for Lines {
    type Result = [[i64; GROUP]; 8];

    fn run<L: Lanes>(self, lanes: L) -> Self::Result {
        let mut words = [[0; GROUP]; 8];
        for at in (0..GROUP).step_by(L::WIDTH) {
            for (words, value) in words.iter_mut().zip(lanes.words_of(&self.lines, &self.index, at)) {
                lanes.store(words, at, value);
            }
        }
        words
    }
}

/// Questions about a group in which one lane is near a bound.
struct Bounds {
    any: [[i64; GROUP]; 2],
    low: [[i64; GROUP]; 2],
    /// Not negative, except near a bound.
    impulses: [[i64; GROUP]; 2],
    /// Zeros, or one bit among them.
    few: [i64; GROUP],
}

impl Bounds {
    fn new(random: &mut Random) -> Self {
        const BOUNDS: [i64; 6] = [-1 << 31, -1 << 30, 0, 1 << 30, 1 << 31, 1 << 61];
        let mut groups = [[0i64; GROUP]; 4];
        groups.as_flattened_mut().iter_mut().for_each(|word| *word = random.number(30));
        let (group, lane) = (random.next() & 3, random.next() & 7);
        groups[group as usize][lane as usize] = BOUNDS[random.next() as usize % 6] + random.number(4);
        let [a, b, c, d] = groups;
        let mut impulses = [c, d].map(|words| words.map(i64::abs));
        impulses[group as usize & 1][lane as usize] = BOUNDS[random.next() as usize % 6] + random.number(4);
        let mut few = [0; GROUP];
        few[lane as usize] = (random.next() & 1) << (random.next() & 63);
        Self { any: [a, b], low: [c, d], impulses, few }
    }
}

impl Job for Bounds {
    type Result = [bool; 4];

    fn run<L: Lanes>(self, lanes: L) -> [bool; 4] {
        let mut is_any = [false; 4];
        for at in (0..GROUP).step_by(L::WIDTH) {
            let wides = |words: [[i64; GROUP]; 2]| words.map(|words| lanes.wide(&words, at));
            is_any[0] |= lanes.is_beyond(lanes.wide(&self.any[0], at));
            is_any[2] |= !lanes.is_zero(lanes.wide(&self.few, at));
            is_any[1] |= lanes.are_beyond(wides(self.any), wides(self.low));
            is_any[3] |= !lanes.are_pushes(wides(self.impulses), wides(self.any));
        }
        is_any
    }
}

/// Operations on one body.
struct OneBody {
    small: [[i32; 4]; 2],
    any: [[i32; 4]; 2],
    limit: i32,
    /// From 0 to 2^30.
    share: i32,
    row: Row,
}

impl OneBody {
    fn new(random: &mut Random, edges: &[i64]) -> Self {
        let any = [0, 1].map(|_| core::array::from_fn(|_| edges[random.next() as usize % edges.len()] as i32));
        let limit = 1 << (random.next() as u32 % 31);
        let small = [0, 1].map(|_| core::array::from_fn(|_| random.number(30) as i32));
        let share = (random.number(31) as i32).abs();
        let mut row = Row::default();
        for k in 0..4 {
            row.displacement[k] = random.next() as i32;
            // Sums next to the limits as well.
            row.velocity[k] = (random.number(32) as i32).clamp(-limit, limit - 1);
            let missing = [0, i64::from(limit), i64::from(-limit)][random.next() as usize % 3];
            let wanted = if k == 0 || random.next() & 1 == 0 { missing - i64::from(row.velocity[k]) } else { 0 };
            row.gain[k] = if k < 3 { (wanted << GAIN_BITS) + random.number(26) } else { 0 };
        }
        Self { small, any, limit, share, row }
    }
}

impl Job for OneBody {
    type Result = ([[i32; 4]; 5], Row, bool);

    fn run<L: Lanes>(mut self, lanes: L) -> Self::Result {
        let lanes = lanes.quads();
        let [a, b, c, d] = [self.small[0], self.small[1], self.any[0], self.any[1]].map(|words| lanes.quad(&words));
        let mut results = [[0; 4]; 5];
        lanes.put(&mut results[0], lanes.quad_plus(a, b));
        lanes.put(&mut results[1], lanes.quad_minus(a, b));
        lanes.put(&mut results[2], lanes.quad_clamped(c, self.limit));
        lanes.put(&mut results[3], lanes.quad_share(c, self.share));
        lanes.put(&mut results[4], lanes.quad_joined(c, d));
        let is_within = lanes.take_gain(&mut self.row, self.limit);
        (results, self.row, is_within)
    }
}

/// Rows of bodies that an index names.
struct Bodies {
    rows: Vec<Row>,
    index: [u32; GROUP],
    change: [[i64; GROUP]; 3],
    /// A row of four words for each lane.
    table: [[i64; 4]; GROUP],
    /// Impulses by quad.
    impulses: [[[i64; GROUP]; 4]; 4],
}

impl Bodies {
    fn new(random: &mut Random) -> Self {
        let count = 1 + random.next() as usize % 12;
        let words = |random: &mut Random| core::array::from_fn(|_| random.next() as i32);
        let rows = (0..count).map(|_| Row {
            velocity: words(random),
            displacement: words(random),
            gain: core::array::from_fn(|k| if k < 3 { random.number(59) } else { 0 }),
        });
        let rows = rows.collect();
        let index = core::array::from_fn(|_| random.next() as u32 % count as u32);
        let change = [0, 1, 2].map(|_| core::array::from_fn(|_| random.number(58)));
        let table = core::array::from_fn(|_| core::array::from_fn(|_| random.next()));
        let impulses = core::array::from_fn(|_| core::array::from_fn(|_| core::array::from_fn(|_| random.number(58))));
        Self { rows, index, change, table, impulses }
    }
}

impl Job for Bodies {
    type Result = ([[i64; GROUP]; 10], Vec<Row>, Vec<Sums>);

    fn run<L: Lanes>(self, lanes: L) -> Self::Result {
        let mut gathered = [[0; GROUP]; 10];
        let mut rows = self.rows.clone();
        let mut sums = vec![Sums::default(); rows.len()];
        // Each body is the first one of a contact as often as the second one of another one.
        let second: [u32; GROUP] = core::array::from_fn(|lane| self.index[GROUP - 1 - lane]);
        for at in (0..GROUP).step_by(L::WIDTH) {
            let Gathered { velocity, displacement } = lanes.gather(&self.rows, &self.index, at);
            for (words, value) in gathered.iter_mut().zip(velocity.into_iter().chain(displacement)) {
                narrow(lanes, words, at, value);
            }
            let change = self.change.map(|words| lanes.wide(&words, at));
            lanes.add_gains(&mut rows, &self.index, at, change);
            for (words, value) in gathered[6..].iter_mut().zip(lanes.columns(&self.table, at)) {
                lanes.store(words, at, value);
            }
            let [low, high, turn_a, turn_b] = self.impulses.map(|quad| quad.map(|words| lanes.wide(&words, at)));
            lanes.add_sums(&mut sums, [&self.index, &second], at, [low, high], [turn_a, turn_b]);
        }
        (gathered, rows, sums)
    }
}

/// Compares a job on all sets with the same job on [`Portable`], many times.
fn same<J: Job<Result: PartialEq + core::fmt::Debug>>(job: impl Fn(&mut Random) -> J) {
    for seed in 0..times(20_000) {
        let expected = job(&mut Random(run_seed(seed))).run(Portable);
        for set in VectorSet::available().skip(1) {
            assert_eq!(run_with(set, job(&mut Random(run_seed(seed)))), expected, "{set:?}, seed {seed}");
        }
    }
}

#[test]
fn operations_on_narrow_lanes_are_the_portable_ones() {
    let (edges, wide_edges) = (edges(32), edges(64));
    let small = |[a, b]: [i32; 2]| [a >> 2, b >> 2];
    same(|random| Narrows {
        small: [0, 1].map(|_| pairs(random, &edges).map(small)),
        any: [0, 1].map(|_| pairs(random, &edges)),
        words: operands(random, &wide_edges, 64),
    });
}

#[test]
fn operations_on_wide_lanes_are_the_portable_ones() {
    let (narrow_edges, edges) = (edges(32), edges(64));
    same(|random| Wides::new(random, &edges, &narrow_edges));
}

#[test]
fn masks_and_lines_are_the_portable_ones() {
    let edges = edges(64);
    same(|random| Masks::new(random, &edges));
    same(Lines::new);
}

#[test]
fn each_lane_beyond_a_bound_is_seen() {
    same(Bounds::new);
    // Both answers occur.
    let asked: Vec<[bool; 4]> = (0..1000).map(|seed| Bounds::new(&mut Random(run_seed(seed))).run(Portable)).collect();
    for k in 0..4 {
        assert!(asked.iter().filter(|is| is[k]).count() > 50 && asked.iter().filter(|is| !is[k]).count() > 50);
    }
}

#[test]
fn operations_on_bodies_are_the_portable_ones() {
    let edges = edges(32);
    same(|random| OneBody::new(random, &edges));
    let taken = (0..1000).filter(|&seed| OneBody::new(&mut Random(run_seed(seed)), &edges).run(Portable).2).count();
    assert!((100..900).contains(&taken), "{taken}");
    same(Bodies::new);
}

/// The columns of a table are its transpose; sums of impulses are sums of each lane.
#[test]
fn columns_and_sums_are_those_of_each_lane() {
    for seed in 0..100 {
        let bodies = Bodies::new(&mut Random(run_seed(seed)));
        let (index, table, impulses) = (bodies.index, bodies.table, bodies.impulses);
        let (results, rows, sums) = bodies.run(Portable);
        for lane in 0..GROUP {
            assert_eq!([0, 1, 2, 3].map(|k| results[6 + k][lane]), table[lane]);
        }
        let mut expected = vec![Sums::default(); rows.len()];
        for lane in 0..GROUP {
            let quad = |quad: usize| [0, 1, 2, 3].map(|k| impulses[quad][k][lane]);
            let (a, b) = (index[lane] as usize, index[GROUP - 1 - lane] as usize);
            for (k, (from_a, to_b)) in
                [(quad(0), quad(0)), (quad(1), quad(1)), (quad(2), quad(3))].into_iter().enumerate()
            {
                (0..4).for_each(|i| expected[a].0[k][i] -= from_a[i]);
                (0..4).for_each(|i| expected[b].0[k][i] += to_b[i]);
            }
        }
        assert_eq!(sums, expected);
    }
}

#[test]
fn reciprocals_are_quotients() {
    for d in [(1 << 30), (1 << 30) + 1, (1 << 30) + 2, 3 << 29, i32::MAX - 1, i32::MAX] {
        assert_eq!(i64::from(Portable.reciprocal(d)), ((1_i64 << 60) - 1) / i64::from(d));
    }
}

#[test]
fn the_widest_set_that_is_allowed_is_used() {
    let available: Vec<VectorSet> = VectorSet::available().collect();
    assert_eq!(available[0], VectorSet::Portable);
    for &set in &available {
        VectorSet::allow(set);
        assert_eq!(VectorSet::used(), set);
    }
    VectorSet::allow(VectorSet::Avx512);
    assert_eq!(VectorSet::used(), available[available.len() - 1]);
}
