//! Inputs whose exact result lies nearest to a rounding boundary, or that lead to such: found by search.

use super::cordic::Cordic;
use super::inputs::Random;
use super::reference::{Real, Reference, real};
use dashu_int::IBig;

/// The hardest for sine or cosine among 10^9, from the search below.
pub(crate) const SIN_COS: [i64; 40] = [
    -5627267875664254094,
    -1398491770088663455,
    -30837519820,
    -66844583,
    196608,
    66844583,
    -8672932831175384259,
    -8514099950950755268,
    -5382541759010230027,
    -196608,
    65536,
    8626911251,
    -7414770589064908072,
    -65536,
    2298392970191541264,
    5707872909964788969,
    6354342954940785858,
    9780064392,
    -7730996412250942965,
    -113986481953636336,
    -327680,
    136130905296,
    4428703408646852925,
    327680,
    2800215285922534176,
    5113841929853183721,
    -1737005346907934475,
    -2801429566320349993,
    -132244595905436882,
    -33225147818,
    31236036723,
    132804891582,
    3260692061852430053,
    1386233263,
    22385985046415,
    -8109960282295504049,
    -1627319125291375347,
    48574807759885481,
    869729567404544732,
    -6523806664402067832,
];

/// The hardest for 2^x among 10^9.
pub(crate) const EXP2: [i64; 20] = [
    -11205856445,
    -23786942695,
    -15430331663,
    -1104889355,
    -23835583710,
    -25316949460,
    -5302155581,
    -19056502554,
    -26024393109,
    -6345667823,
    -7966341842,
    -33706992635,
    -11971537974,
    -10774485346,
    -28729851805,
    -23608250819,
    -13837938304,
    -7003147889,
    -17235512283,
    -17619095331,
];

/// Keeps the inputs with the least distances.
struct Nearest {
    kept: Vec<(u64, i64)>,
    capacity: usize,
}

impl Nearest {
    fn new(capacity: usize) -> Self {
        Self { kept: Vec::with_capacity(2 * capacity), capacity }
    }

    fn offer(&mut self, distance: u64, raw: i64) {
        if self.kept.len() == 2 * self.capacity {
            self.tidy();
        }
        if self.kept.len() < self.capacity || distance < self.kept[self.capacity - 1].0 {
            self.kept.push((distance, raw));
        }
    }

    /// Sorts, and drops what is twice there, as small arguments are, or too far.
    fn tidy(&mut self) {
        self.kept.sort_unstable();
        self.kept.dedup();
        self.kept.truncate(self.capacity);
    }

    fn into_inputs(mut self) -> Vec<i64> {
        self.tidy();
        self.kept.into_iter().map(|(_, raw)| raw).collect()
    }
}

/// The hardest for sine or cosine among `count` random ones of all sizes, by the 62-bit values of plain CORDIC.
pub(crate) fn search_sin_cos(random: &mut Random, count: usize, keep: usize) -> Vec<i64> {
    let cordic = Cordic::new();
    let mut nearest = Nearest::new(keep);
    let distance = |value: i64| ((value & 0x3fff_ffff) - (1 << 29)).unsigned_abs();
    for i in 0..count {
        let raw = if i % 2 == 0 { random.next() } else { random.next_by_exponent() };
        let (sin, cos) = cordic.sin_cos_q62(raw);
        nearest.offer(distance(sin).min(distance(cos)), raw);
    }
    nearest.into_inputs()
}

/// The hardest for 2^x among `count` random ones with results from 2^-8 to 1, by products of four table entries.
pub(crate) fn search_exp2(reference: &Reference, random: &mut Random, count: usize, keep: usize) -> Vec<i64> {
    let tables: Vec<Vec<u64>> = (0..4)
        .map(|place| {
            let entry = |byte: i64| reference.exp2(&real(byte, 8 * place - 32)) << 63;
            (0..256).map(|byte| u64::try_from(entry(byte).floor().to_int().value()).expect("fits")).collect()
        })
        .collect();
    let mut nearest = Nearest::new(keep);
    for _ in 0..count {
        // Results below 2^-8 have few bits, above 1 these products leave too few below the ulp.
        let raw = random.within(-8 << 32, 0);
        let value = tables
            .iter()
            .zip((raw as u32).to_le_bytes())
            .fold(1u128 << 63, |value, (table, byte)| (value * u128::from(table[usize::from(byte)])) >> 63)
            as u64;
        let below_point = (31 - (raw >> 32)) as u32;
        let rest = value & ((1 << below_point) - 1);
        // In units of 2^-40 ulp.
        let distance = rest.abs_diff(1 << (below_point - 1));
        nearest
            .offer(if below_point > 40 { distance >> (below_point - 40) } else { distance << (40 - below_point) }, raw);
    }
    nearest.into_inputs()
}

/// `value` as an integer, and the ones beside it.
fn around(value: &Real) -> Option<[i64; 3]> {
    let nearest = i64::try_from(value.round().to_int().value()).ok()?;
    Some([nearest.checked_sub(1)?, nearest, nearest.checked_add(1)?])
}

/// Arguments of log2 around 2^tie, for ties of the result: the larger they are, the nearer.
pub(crate) fn log2_from_ties(reference: &Reference, random: &mut Random) -> Vec<i64> {
    let tie = real(2 * random.within(-32 << 32, 31 << 32) + 1, -33);
    let inputs = around(&(reference.exp2(&tie) << 32)).unwrap_or_default();
    inputs.into_iter().filter(|&raw| raw > 0).collect()
}

/// Bases around tie^(1/exponent): the smaller the exponent, the nearer.
pub(crate) fn pow_from_ties(reference: &Reference, random: &mut Random) -> Vec<(i64, i64)> {
    let exponent = random.next_by_exponent() >> 28 | 1;
    let result = (random.next_by_exponent() >> 1).unsigned_abs() as i64;
    // log2 of 2·result + 1 in units of half an ulp.
    let log = (reference.log2(2 * result + 1) - real(1, 0)) * real(1, 32) / real(exponent, 0);
    let approximate = log.to_f64().value();
    if !(-31.0..30.9).contains(&approximate) {
        return Vec::new();
    }
    let bases = around(&(reference.exp2(&log) << 32)).unwrap_or_default();
    bases.into_iter().filter(|&base| base > 0).map(|base| (base, exponent)).collect()
}

/// Arguments of the square root around (k + ½)²·2^-32.
pub(crate) fn sqrt_from_ties(random: &mut Random) -> Vec<i64> {
    let root = random.next() as u64 >> (17 + random.next() as u64 % 32);
    let square = (u128::from(root) * (u128::from(root) + 1)) >> 32;
    (0..2).filter_map(|d| i64::try_from(square + d).ok()).collect()
}

/// Vectors (x, y) with x² + y² around (k + ½)²: the smaller y is beside x, the nearer.
pub(crate) fn hypot_from_ties(random: &mut Random) -> Vec<(i64, i64)> {
    let x = random.next_by_exponent().unsigned_abs() >> 2;
    let length = x + random.next_by_exponent().unsigned_abs() % (x / 4 + 1);
    let square = u128::from(length) * (u128::from(length) + 1) - u128::from(x).pow(2);
    let y = square.isqrt();
    (0..2).filter_map(|d| Some((x as i64, i64::try_from(y + d).ok()?))).collect()
}

/// Quotients n/d around k + ½, ties themselves among them.
pub(crate) fn div_from_ties(random: &mut Random) -> Vec<(i64, i64)> {
    let (d, k) = (random.next_by_exponent(), random.next_by_exponent());
    let n = (i128::from(d) * (2 * i128::from(k) + 1)) >> 33;
    (0..2).filter_map(|step| Some((i64::try_from(n + step).ok()?, d))).collect()
}

/// Vectors whose angle is as near to a tie as 63 bits allow: the last convergent of the tangent's continued fraction.
pub(crate) fn atan2_from_ties(reference: &Reference, random: &mut Random) -> Vec<(i64, i64)> {
    let raw = random.within(0, 13_493_037_704);
    let (sin, cos) = reference.sin_cos(raw);
    let (half_sin, half_cos) = real(1, -33).sin_cos();
    let (sin, cos) = (&sin * &half_cos + &cos * &half_sin, cos * half_cos - sin * half_sin);
    let backwards = cos < real(0, 0);
    let units = |value: Real| -> IBig { (value << 190).round().to_int().value() };
    let (mut n, mut d) = (units(sin), units(if backwards { -cos } else { cos }));
    let (mut y, mut x) = ((0i128, 1i128), (1i128, 0i128));
    while d != IBig::ZERO {
        let Ok(part) = i64::try_from(&n / &d) else { break };
        let next = (y.0 + i128::from(part) * y.1, x.0 + i128::from(part) * x.1);
        if next.0 >> 63 != 0 || next.1 >> 63 != 0 {
            break;
        }
        (y, x) = ((y.1, next.0), (x.1, next.1));
        (n, d) = (d.clone(), n % d);
    }
    let (y, x) = (y.1 as i64, x.1 as i64);
    vec![(y, if backwards { -x } else { x })]
}
