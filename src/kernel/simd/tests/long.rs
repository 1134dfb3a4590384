//! Products of wide lanes beside their definitions in 128 bits.

use super::*;

/// Operands in the domains of all operations.
#[derive(Clone)]
struct Products {
    /// Within 2^51.
    values: [[i64; GROUP]; 2],
    /// Within 2^36.
    velocities: [[i64; GROUP]; 2],
    /// From 0 to 2^57.
    mass: [i64; GROUP],
    /// Within 2^62.
    impulse: [i64; GROUP],
    /// From 0 to 2^40.
    step: i64,
    /// Within 2^30.
    crosses: Pairs,
    /// Below 2^31.
    elements: Pairs,
    base: [i64; GROUP],
    bits: [i64; GROUP],
    down: [i64; GROUP],
}

impl Products {
    fn new(random: &mut Random, edges: &[i64]) -> Self {
        // Of any size, and the ends of the domain.
        let mut within = |bits: u32| operands(random, edges, bits + 1).map(|word| word.clamp(-1 << bits, 1 << bits));
        let (values, velocities) = ([within(51), within(51)], [within(36), within(36)]);
        let (mass, impulse, base) = (within(57).map(i64::abs), within(62), within(60));
        let (first, second) = (within(30), within(30));
        let (e11, e12) = (within(31), within(31));
        let step = within(40)[0].abs();
        let pair = |a: i64, b: i64| [a, b].map(|part| part.clamp(-i64::from(i32::MAX), i32::MAX.into()) as i32);
        let mut products = Self {
            values,
            velocities,
            mass,
            impulse,
            step,
            crosses: core::array::from_fn(|lane| pair(first[lane], second[lane])),
            elements: core::array::from_fn(|lane| pair(e11[lane], e12[lane])),
            base,
            bits: [0; GROUP],
            down: [0; GROUP],
        };
        products.bits = products.bits.map(|_| random.next().rem_euclid(31));
        if random.next() & 1 == 0 {
            products.down =
                products.down.map(|_| random.next().rem_euclid(if random.next() & 1 == 0 { 40 } else { 200 }));
        }
        // Ties: an odd number of halves.
        if random.next() & 1 == 0 {
            let lane = random.next() as usize % GROUP;
            let bits = products.bits[lane];
            products.elements[lane] = [1, 0];
            products.values[0][lane] = (random.number(20) | 1) << (bits - 1).max(0);
            products.velocities[0][lane] = (random.number(5) | 1) << (bits - 1).max(0);
            products.crosses[lane] = [1 << 19, 0];
            products.mass[lane] = 1 << 57;
            products.impulse[lane] = (random.number(40) | 1) << 6;
        }
        products
    }
}

/// The results of operations, the sum of products, and the velocities of bodies.
type Outcome = ([[i64; GROUP]; 10], i128);

impl Job for Products {
    type Result = Outcome;

    fn run<L: Lanes>(self, lanes: L) -> Outcome {
        let (mut results, mut sums) = ([[0; GROUP]; 10], [lanes.all(0); 3]);
        for at in (0..GROUP).step_by(L::WIDTH) {
            let wide = |words: &[i64; GROUP]| lanes.wide(words, at);
            let (values, velocities) =
                ([0, 1].map(|k| wide(&self.values[k])), [0, 1].map(|k| wide(&self.velocities[k])));
            let ((k, l), (e, f)) = (lanes.pair(&self.crosses, at), lanes.pair(&self.elements, at));
            let products = [
                lanes.multiples(values, self.step)[0],
                lanes.multiples(values, self.step)[1],
                lanes.upper_word(wide(&self.mass), wide(&self.impulse)),
                lanes.lowered_product(wide(&self.mass), lanes.clamped(wide(&self.impulse), lanes.all(1 << 43))),
                lanes.lowered_dot([k, l], values),
                lanes.dot([k, l], values)[0],
                lanes.dot([k, l], values)[1],
                lanes.lowered_limbs([values[0], values[1]]),
                lanes.lowered_way(wide(&self.base), [k, l], values),
                lanes.dot_within([e, f], velocities, wide(&self.bits), 51),
            ];
            for (words, product) in results.iter_mut().zip(products) {
                lanes.store(words, at, product);
            }
            lanes.add_products(&mut sums, velocities, values, wide(&self.down));
        }
        (results, lanes.total(sums))
    }
}

/// The definitions.
fn expected(products: &Products) -> Outcome {
    let product = |a: i64, b: i64| i128::from(a) * i128::from(b);
    let rounded = |value: i128, bits: i64| {
        let half = if bits == 0 { 0 } else { 1_i128 << (bits - 1) };
        value.signum() * ((value.abs() + half) >> bits)
    };
    let (mut results, mut total) = ([[0; GROUP]; 10], 0);
    for lane in 0..GROUP {
        let [v, w] = products.values.map(|words| words[lane]);
        let [x, y] = products.velocities.map(|words| words[lane]);
        let ([k, l], [e, f]) = (products.crosses[lane].map(i64::from), products.elements[lane].map(i64::from));
        let dot = product(k, v) + product(l, w);
        let results_of_lane = [
            rounded(product(v, products.step), 30),
            rounded(product(w, products.step), 30),
            rounded(product(products.mass[lane], products.impulse[lane]), 64),
            rounded(product(products.mass[lane], products.impulse[lane].clamp(-1 << 43, 1 << 43)), 38),
            rounded(dot, 20),
            dot >> 30,
            dot & 0x3fff_ffff,
            rounded((i128::from(v) << 30) + i128::from(w), 20),
            rounded(product(products.base[lane], 1 << 30) + dot, 34),
            rounded(product(e, x) + product(f, y), products.bits[lane]).clamp(-1 << 51, 1 << 51),
        ];
        for (words, result) in results.iter_mut().zip(results_of_lane) {
            words[lane] = i64::try_from(result).expect("a word");
        }
        total += (product(x, v) + product(y, w)) >> products.down[lane].min(127);
    }
    (results, total)
}

#[test]
fn products_of_wide_lanes_are_rounded_once() {
    let edges = edges(64);
    for seed in 0..times(20_000) {
        let products = Products::new(&mut Random(run_seed(seed)), &edges);
        for set in VectorSet::available() {
            assert_eq!(run_with(set, products.clone()), expected(&products), "{set:?}, seed {seed}");
        }
    }
}

/// Velocities of bodies by an index, and changes of bodies that several lanes have.
struct Motions {
    speeds: Vec<Speeds>,
    index: [u32; GROUP],
    changes: [[i64; GROUP]; 3],
}

impl Motions {
    fn new(random: &mut Random) -> Self {
        Self {
            speeds: (0..5)
                .map(|_| Speeds(core::array::from_fn(|k| if k < 3 { random.number(50) } else { 0 })))
                .collect(),
            index: core::array::from_fn(|_| random.next().rem_euclid(5) as u32),
            changes: core::array::from_fn(|_| core::array::from_fn(|_| random.number(50))),
        }
    }
}

impl Job for Motions {
    type Result = ([[i64; GROUP]; 3], Vec<Speeds>);

    fn run<L: Lanes>(mut self, lanes: L) -> Self::Result {
        let mut results = [[0; GROUP]; 3];
        for at in (0..GROUP).step_by(L::WIDTH) {
            for (words, value) in results.iter_mut().zip(lanes.speeds_of(&self.speeds, &self.index, at)) {
                lanes.store(words, at, value);
            }
        }
        for at in (0..GROUP).step_by(L::WIDTH) {
            let change = [0, 1, 2].map(|k| lanes.wide(&self.changes[k], at));
            lanes.add_speeds(&mut self.speeds, &self.index, at, change);
        }
        (results, self.speeds)
    }
}

#[test]
fn velocities_of_bodies_have_all_changes() {
    for seed in 0..times(1000) {
        let Motions { mut speeds, index, changes } = Motions::new(&mut Random(run_seed(seed)));
        let gathered = [0, 1, 2].map(|k| index.map(|body| speeds[body as usize].0[k]));
        for lane in 0..GROUP {
            (0..3).for_each(|k| speeds[index[lane] as usize].0[k] += changes[k][lane]);
        }
        for set in VectorSet::available() {
            let results = run_with(set, Motions::new(&mut Random(run_seed(seed))));
            assert_eq!(results, (gathered, speeds.clone()), "{set:?}, seed {seed}");
        }
    }
}
