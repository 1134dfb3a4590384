//! The accuracy contract, as code: a table of functions, the error each may have, the worst seen, and where.
//!
//! Truth is the arbitrary-precision reference.

#[path = "support/mod.rs"]
mod support;

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use support::cordic::Cordic;
use support::hard;
use support::inputs::{Random, edges};
use support::reference::{Reference, error, real};
use umbra_physics::{Damping, Fx, MathError, WorldDef};

/// Random inputs of each distribution, a function.
fn random_count() -> usize {
    crate::seeds::times(2_000)
}
/// Neighbours in the dense intervals.
fn dense() -> i64 {
    crate::seeds::times(2_000)
}
/// Ties from which hard inputs are made.
fn ties() -> usize {
    crate::seeds::times(1_000)
}
/// Inputs that a search looks through, and how many it keeps.
fn searched() -> usize {
    crate::seeds::times(500_000)
}
const KEPT: usize = 200;

/// The arguments' bits; the second is 0 for functions of one.
type Input = (i64, i64);

struct Function {
    name: &'static str,
    /// The methods of `Fx` whose accuracy this row answers for.
    methods: &'static [&'static str],
    /// In ulp.
    allowed: f64,
    inputs: fn(&Reference) -> Vec<Input>,
    /// The error in ulp, or `None` outside the domain, after a look at how that was refused.
    error: fn(&Reference, Input) -> Option<f64>,
}

const FUNCTIONS: [Function; 11] = [
    Function {
        name: "sin",
        methods: &["sin", "sin_cos"],
        allowed: 0.5001,
        inputs: angles,
        error: |reference, (raw, _)| {
            let sin = Fx::from_bits(raw).sin();
            assert_eq!(sin, Fx::from_bits(raw).sin_cos().0);
            Some(error(sin.to_bits(), &reference.sin_cos(raw).0))
        },
    },
    Function {
        name: "cos",
        methods: &["cos", "sin_cos"],
        allowed: 0.5001,
        inputs: angles,
        error: |reference, (raw, _)| {
            let cos = Fx::from_bits(raw).cos();
            assert_eq!(cos, Fx::from_bits(raw).sin_cos().1);
            Some(error(cos.to_bits(), &reference.sin_cos(raw).1))
        },
    },
    Function {
        name: "sqrt",
        methods: &["sqrt", "checked_sqrt"],
        allowed: 0.5,
        inputs: |_| {
            let mut random = Random::seeded(3);
            let from_ties: Vec<_> = (0..ties()).flat_map(|_| hard::sqrt_from_ties(&mut random)).collect();
            singles(from_ties.into_iter().chain(common()))
        },
        error: |_, (raw, _)| {
            let root = Fx::from_bits(raw).checked_sqrt();
            assert_eq!(root.is_none(), raw < 0, "{raw}");
            Some(error(root?.to_bits(), &real(raw, -32).sqrt()))
        },
    },
    Function {
        name: "length",
        methods: &["checked_hypot"],
        allowed: 0.5,
        inputs: |_| {
            let mut random = Random::seeded(4);
            pairs((0..ties()).flat_map(|_| hard::hypot_from_ties(&mut random)).collect())
        },
        error: |_, (x, y)| {
            let square = |raw: i64| u128::from(raw.unsigned_abs()).pow(2);
            let sum = square(x) + square(y);
            let length = Fx::from_bits(x).checked_hypot(Fx::from_bits(y));
            // (2^63 - ½)², rounded down.
            assert_eq!(length.is_none(), sum > (1 << 126) - (1 << 63), "{x}, {y}");
            Some(error(length?.to_bits(), &(real(sum, 0).sqrt() >> 32)))
        },
    },
    Function {
        name: "division",
        methods: &["checked_div", "checked_from_ratio"],
        allowed: 0.5,
        inputs: |_| {
            let mut random = Random::seeded(5);
            pairs((0..ties()).flat_map(|_| hard::div_from_ties(&mut random)).collect())
        },
        error: |_, (n, d)| {
            let quotient = Fx::from_bits(n).checked_div(Fx::from_bits(d));
            assert_eq!(quotient, Fx::checked_from_ratio(n, d));
            if d == 0 {
                assert_eq!(quotient, None);
                return None;
            }
            let exact = real(n, 0) / real(d, 0);
            if quotient.is_none() {
                // Past 2^31 - 2^-33 or -2^31 - 2^-33, the ties themselves being refused above and not below.
                assert!(exact >= real((1i128 << 64) - 1, -33) || exact < real(-(1i128 << 64) - 1, -33), "{n} / {d}");
            }
            Some(error(quotient?.to_bits(), &exact))
        },
    },
    Function {
        name: "product",
        methods: &["checked_mul"],
        allowed: 0.5,
        inputs: |_| pairs(Vec::new()),
        error: |_, (a, b)| {
            let exact = real(i128::from(a) * i128::from(b), -64);
            let product = Fx::from_bits(a).checked_mul(Fx::from_bits(b));
            if product.is_none() {
                assert!(exact >= real((1i128 << 64) - 1, -33) || exact < real(-(1i128 << 64) - 1, -33), "{a} · {b}");
            }
            Some(error(product?.to_bits(), &exact))
        },
    },
    Function {
        name: "atan2",
        methods: &["atan2"],
        allowed: 0.5001,
        inputs: |reference| {
            let mut random = Random::seeded(6);
            pairs((0..ties()).flat_map(|_| hard::atan2_from_ties(reference, &mut random)).collect())
        },
        error: |reference, (y, x)| {
            let angle = Fx::from_bits(y).atan2(Fx::from_bits(x));
            assert!(angle <= Fx::PI && angle >= -Fx::PI && (angle.to_bits() == 0 || (angle < Fx::ZERO) == (y < 0)));
            if (y, x) == (0, 0) {
                return Some(if angle == Fx::ZERO { 0.0 } else { f64::INFINITY });
            }
            Some(reference.angle_error(angle.to_bits(), y, x))
        },
    },
    Function {
        name: "exp2",
        methods: &["exp2"],
        allowed: 0.5001,
        inputs: |reference| {
            let mut random = Random::seeded(7);
            let in_range: Vec<_> = (0..random_count()).map(|_| random.within(-33 << 32, 31 << 32)).collect();
            let searched = hard::search_exp2(reference, &mut random, searched(), KEPT);
            singles(in_range.into_iter().chain(searched).chain(hard::EXP2).chain(common()))
        },
        error: |reference, (raw, _)| {
            let power = Fx::from_bits(raw).exp2();
            assert_eq!(power == Err(MathError::Overflow), raw >= 31 << 32, "{raw}");
            let power = power.ok()?.to_bits();
            Some(if raw < -80 << 32 { power as f64 } else { error(power, &reference.exp2(&real(raw, -32))) })
        },
    },
    Function {
        name: "Damping::rate",
        methods: &[],
        allowed: 0.5001,
        inputs: |_| {
            let mut random = Random::seeded(17);
            // The share is 0 from 33·ln 2 on; what is next to the tie of 2^-33 there, and next to none.
            let last = 98_242_467_570;
            let rates = (0..random_count()).map(|_| random.within(0, 23 << 32)).collect::<Vec<_>>();
            let ends = (-dense()..=dense()).flat_map(|d| [d.abs(), last + d]);
            singles(rates.into_iter().chain(ends).chain(common()))
        },
        error: |reference, (raw, _)| {
            let damping = Damping::rate(Fx::from_bits(raw));
            let refused = WorldDef { linear_damping: damping, ..WorldDef::default() }.check().is_err();
            assert_eq!((refused, damping == Damping::NONE), (raw < 0, raw == 0), "{raw}");
            let kept = damping.kept();
            if !(-92_288_378_626..=80 << 32).contains(&raw) {
                assert_eq!(kept, if raw < 0 { Fx::MAX } else { Fx::ZERO }, "{raw}");
                return None;
            }
            Some(error(kept.to_bits(), &reference.exp(&real(-i128::from(raw), -32))))
        },
    },
    Function {
        name: "log2",
        methods: &["log2"],
        allowed: 0.5001,
        inputs: |reference| {
            let mut random = Random::seeded(8);
            let from_ties: Vec<_> = (0..ties()).flat_map(|_| hard::log2_from_ties(reference, &mut random)).collect();
            let near_one = (-dense()..=dense()).map(|d| (1 << 32) + d);
            singles(from_ties.into_iter().chain(near_one).chain(common()))
        },
        error: |reference, (raw, _)| {
            let log = Fx::from_bits(raw).log2();
            assert_eq!(log == Err(MathError::NotPositive), raw <= 0, "{raw}");
            Some(error(log.ok()?.to_bits(), &reference.log2(raw)))
        },
    },
    Function {
        name: "pow",
        methods: &["pow"],
        allowed: 0.5001,
        inputs: powers,
        error: |reference, (base, exponent)| {
            let power = Fx::from_bits(base).pow(Fx::from_bits(exponent));
            assert_eq!(power == Err(MathError::NotPositive), base <= 0, "{base}");
            if base <= 0 {
                return None;
            }
            let log = reference.log2(base) * real(exponent, -32);
            let approximate = log.to_f64().value();
            if !(-80.0..=31.5).contains(&approximate) {
                assert_eq!(power, if approximate > 0.0 { Err(MathError::Overflow) } else { Ok(Fx::ZERO) });
                return Some(0.0).filter(|_| approximate < 0.0);
            }
            let exact = reference.exp2(&log);
            if power.is_err() {
                assert!(exact >= real((1i128 << 64) - 2, -33), "{base}, {exponent}");
            }
            Some(error(power.ok()?.to_bits(), &exact))
        },
    },
];

fn singles(inputs: impl Iterator<Item = i64>) -> Vec<Input> {
    inputs.map(|raw| (raw, 0)).collect()
}

/// For any function of one argument: the edges, a dense interval, random ones uniform and uniform in exponent.
fn common() -> impl Iterator<Item = i64> {
    let (mut uniform, mut by_exponent) = (Random::seeded(1), Random::seeded(2));
    let dense = (0..2 * dense()).map(|d| (3 << 31) + d);
    let uniform = (0..random_count()).map(move |_| uniform.next());
    edges()
        .into_iter()
        .chain(dense)
        .chain(uniform)
        .chain((0..random_count()).map(move |_| by_exponent.next_by_exponent()))
}

/// For any function of two: the edges with each other, a dense square, random ones uniform and uniform in exponent.
fn pairs(hard: Vec<Input>) -> Vec<Input> {
    let edges: Vec<i64> = edges().into_iter().step_by(if crate::seeds::is_short() { 3 } else { 1 }).collect();
    let corners = edges.iter().flat_map(|&a| edges.iter().map(move |&b| (a, b)));
    let side = dense().isqrt();
    let dense = (0..side).flat_map(|a| (0..side).map(move |b| ((1 << 32) + a, (3 << 31) + b)));
    let (mut uniform, mut by_exponent) = (Random::seeded(1), Random::seeded(2));
    let uniform = (0..random_count()).map(|_| (uniform.next(), uniform.next()));
    let by_exponent = (0..random_count()).map(|_| (by_exponent.next_by_exponent(), by_exponent.next_by_exponent()));
    hard.into_iter().chain(corners).chain(dense).chain(uniform).chain(by_exponent).collect()
}

/// For sine and cosine: beside the common ones, quadrant boundaries near zero and anywhere up to 2^31 rad, the ends of the
/// range, and the hardest to round.
fn angles(reference: &Reference) -> Vec<Input> {
    let mut random = Random::seeded(9);
    // 2^31 rad are 1367130551.2 quadrants.
    let last = 1_367_130_551;
    let far: Vec<i64> = (0..ties()).map(|_| random.within(0, last)).collect();
    let boundaries = (0..200).chain(last - 200..=last).chain(far).flat_map(|quadrants| {
        let raw = ((&reference.half_pi * real(quadrants, 32)).round()).to_int().value();
        let raw = i64::try_from(raw).expect("below 2^63");
        (-2..=2).flat_map(move |d| [raw.saturating_add(d), -raw.saturating_add(d)])
    });
    let ends = (0..dense()).flat_map(|d| [i64::MAX - d, i64::MIN + d, d, -d]);
    let searched = hard::search_sin_cos(&mut random, searched(), KEPT);
    singles(boundaries.chain(ends).chain(searched).chain(hard::SIN_COS).chain(common()))
}

/// For pow: beside the common pairs, bases next to 1 with exponents up to 2^31, results anywhere up to 2^31, and exact ties.
fn powers(reference: &Reference) -> Vec<Input> {
    let mut random = Random::seeded(10);
    let mut inputs: Vec<Input> = (0..ties()).flat_map(|_| hard::pow_from_ties(reference, &mut random)).collect();
    for i in 0..random_count() {
        // Half of the bases next to 1, the others of all sizes; the exponent leads to a result of a random size.
        let off = random.next() % 1000;
        let base =
            if i % 2 == 0 && off != 0 { (1i64 << 32) + off } else { random.next_by_exponent().unsigned_abs() as i64 };
        let result_log = random.within(-34 << 32, 31 << 32) as f64;
        let exponent = result_log / ((base as f64).log2() - 32.0);
        inputs.push((base, exponent as i64));
    }
    for k in (1..1000).step_by(2) {
        // (k/2^11)³ is an odd multiple of 2^-33, and so is the inverse third power of its inverse for k = 1.
        inputs.push((k << 21, 3 << 32));
    }
    inputs.push((1 << 43, -3 << 32));
    for base in (1..=300).flat_map(|k| [(1i64 << 32) - k, (1 << 32) + k]) {
        inputs.extend([i64::MAX, i64::MIN, 1 << 62, -1 << 62].map(|exponent| (base, exponent)));
    }
    inputs.extend(pairs(Vec::new()));
    inputs
}

/// The worst error of a function, where it is, and how many inputs had a result.
struct Worst {
    error: f64,
    at: Input,
    tried: usize,
}

fn worst(function: &Function, reference: &Reference) -> Worst {
    let mut worst = Worst { error: -1.0, at: (0, 0), tried: 0 };
    for at in (function.inputs)(reference) {
        if let Some(error) = (function.error)(reference, at) {
            worst.tried += 1;
            if error.abs() > worst.error {
                worst = Worst { error: error.abs(), at, ..worst };
            }
        }
    }
    worst
}

#[test]
fn every_function_is_as_accurate_as_promised() {
    let reference = Reference::new();
    let results = Mutex::new(Vec::new());
    let next = AtomicUsize::new(0);
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(|| {
                // The last take longest: first come, so that no thread is left with one of them at the end.
                while let Some((row, function)) =
                    FUNCTIONS.iter().enumerate().rev().nth(next.fetch_add(1, Ordering::Relaxed))
                {
                    let worst = worst(function, &reference);
                    results.lock().unwrap().push((row, function, worst));
                }
            });
        }
    });
    let mut results = results.into_inner().unwrap();
    results.sort_by_key(|&(row, ..)| row);
    println!("{:10} {:>8} {:>13} {:>9}  at (bits)", "function", "allowed", "worst, ulp", "inputs");
    for (_, function, worst) in &results {
        println!(
            "{:10} {:>8} {:>13.10} {:>9}  {:?}",
            function.name, function.allowed, worst.error, worst.tried, worst.at
        );
    }
    for (_, function, worst) in &results {
        assert!(worst.error <= function.allowed, "{}: {} ulp at {:?}", function.name, worst.error, worst.at);
        assert!(worst.tried > random_count(), "{}: only {} inputs have a result", function.name, worst.tried);
        // A table whose inputs never come near a tie would show nothing.
        assert!(worst.error > 0.49, "{}: no hard inputs, {} ulp at worst", function.name, worst.error);
    }
}

#[test]
fn no_function_is_missing_from_the_table() {
    let source = include_str!("../src/fx/maths.rs");
    let methods = source.lines().filter_map(|line| line.trim_start().strip_prefix("pub ")?.split_once("fn "));
    let methods: Vec<&str> = methods.filter_map(|(_, rest)| Some(rest.split_once('(')?.0)).collect();
    assert!(methods.len() >= 9, "the scan finds the methods: {methods:?}");
    for method in methods.into_iter().chain(["checked_div", "checked_from_ratio", "checked_mul"]) {
        assert!(FUNCTIONS.iter().any(|function| function.methods.contains(&method)), "{method} is missing");
    }
}

#[test]
fn plain_cordic_gives_the_same_bits() {
    let (reference, cordic) = (Reference::new(), Cordic::new());
    let mut differing = 0;
    let mut angles = angles(&reference);
    angles.sort_unstable();
    angles.dedup();
    for (raw, _) in angles {
        let (sin, cos) = Fx::from_bits(raw).sin_cos();
        let plain = cordic.sin_cos(raw);
        if (sin.to_bits(), cos.to_bits()) != plain {
            // At a tie to within what 62 bits carry. There ours is to be the nearer, or as near.
            differing += 1;
            let exact = reference.sin_cos(raw);
            let ours = (error(sin.to_bits(), &exact.0), error(cos.to_bits(), &exact.1));
            let theirs = (error(plain.0, &exact.0), error(plain.1, &exact.1));
            println!("sin, cos of {raw}·2^-32: errors {ours:?} ulp, plain CORDIC {theirs:?}");
            let size = |(sin, cos): (f64, f64)| sin.abs().max(cos.abs());
            assert!(size(theirs) < 0.5 + 1e-7 && size(ours) < 0.5 + 1e-7);
        }
    }
    println!("{differing} differ");
    // One in some 2^25 is that near to a tie, and a few are so by nature, such as cos 2^-16 = 1 - 2^-33 + 2^-68/3.
    assert!(differing <= 16);
}

#[test]
#[ignore = "minutes of search, for the lists in tests/support/hard.rs"]
fn search_further() {
    let (reference, mut random) = (Reference::new(), Random::seeded(11));
    println!("SIN_COS: {:?}", hard::search_sin_cos(&mut random, 1_000_000_000, 40));
    println!("EXP2: {:?}", hard::search_exp2(&reference, &mut random, 1_000_000_000, 20));
}
