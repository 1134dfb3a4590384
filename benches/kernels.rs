//! Time of each function of `Fx` beside the `cordic` crate's, std's f64's, and simpler schemes, in one run.
//!
//! A sample is 1000 calls with inputs of their own, so a time in µs reads as ns a call. The calls are independent: this is
//! throughput, not latency. Compare within one run only.

use divan::{Bencher, black_box};
use fixed::types::I32F32;
use umbra_physics::scalar::internals::Forces as _;
use umbra_physics::{Fx, FxFactor, FxWide, SpringConstants, Vec2, fx};

#[path = "../tests/support/cordic.rs"]
mod plain;

#[path = "../tests/support/inputs.rs"]
#[allow(dead_code, reason = "the benches use a part of the inputs")]
mod inputs;

const CALLS: usize = 1000;

fn main() {
    divan::main();
}

/// Values with `bits` random bits, of either sign.
fn values(seed: u64, bits: u32) -> Vec<Fx> {
    let mut random = inputs::Random(seed);
    (0..CALLS).map(|_| Fx::from_bits(random.next() >> (64 - bits))).collect()
}

fn positive(seed: u64, bits: u32) -> Vec<Fx> {
    values(seed, bits).into_iter().map(|value| Fx::from_bits(value.to_bits().abs() | 1)).collect()
}

fn floats(values: Vec<Fx>) -> Vec<f64> {
    values.into_iter().map(|value| value.to_bits() as f64 * (-32f64).exp2()).collect()
}

fn fixeds(values: Vec<Fx>) -> Vec<I32F32> {
    values.into_iter().map(I32F32::from).collect()
}

/// Times `function` on each input.
fn one<T: Copy + Sync, R>(bencher: Bencher, inputs: Vec<T>, function: impl Fn(T) -> R + Sync) {
    bencher.bench(|| {
        for &input in black_box(&inputs) {
            black_box(function(input));
        }
    });
}

/// Times `function` on each pair of inputs.
fn two<T: Copy + Sync, U: Copy + Sync, R>(
    bencher: Bencher,
    (a, b): (Vec<T>, Vec<U>),
    function: impl Fn(T, U) -> R + Sync,
) {
    let inputs: Vec<(T, U)> = a.into_iter().zip(b).collect();
    one(bencher, inputs, |(a, b)| function(a, b));
}

/// A yardstick of the machine: one 64-bit multiplication.
mod integer {
    use super::*;

    #[divan::bench]
    fn multiply(bencher: Bencher) {
        let bits = |seed| values(seed, 64).into_iter().map(Fx::to_bits).collect();
        two(bencher, (bits(1), bits(2)), |a: i64, b: i64| a.wrapping_mul(b));
    }
}

/// Angles in ±8 rad, unless said otherwise: the `cordic` crate reduces larger ones by repeated subtraction.
mod sin_cos {
    use super::*;

    const BITS: u32 = 36;

    #[divan::bench]
    fn fx(bencher: Bencher) {
        one(bencher, values(1, BITS), Fx::sin_cos);
    }

    #[divan::bench]
    fn fx_whole_range(bencher: Bencher) {
        one(bencher, values(1, 64), Fx::sin_cos);
    }

    #[divan::bench]
    fn plain_cordic_24(bencher: Bencher) {
        let cordic = plain::Cordic::new();
        one(bencher, values(1, BITS), |value| cordic.sin_cos(value.to_bits()));
    }

    #[divan::bench]
    fn cordic_crate(bencher: Bencher) {
        one(bencher, fixeds(values(1, BITS)), cordic::sin_cos);
    }

    #[divan::bench]
    fn f64(bencher: Bencher) {
        one(bencher, floats(values(1, BITS)), f64::sin_cos);
    }

    #[divan::bench]
    fn f64_whole_range(bencher: Bencher) {
        one(bencher, floats(values(1, 64)), f64::sin_cos);
    }
}

/// The rotations alone, of angles within ±π/4: how many single steps of CORDIC to keep between the table's rotation and the
/// residual's. A residual below 2^-n rad leaves an error near 2^-3n.
mod rotation {
    use super::*;

    fn angles() -> Vec<i64> {
        values(1, 64).into_iter().map(|value| value.to_bits() / 3).collect()
    }

    /// All 24 steps single.
    #[divan::bench]
    fn steps_0_to_24(bencher: Bencher) {
        let cordic = plain::Cordic::new();
        one(bencher, angles(), |angle| cordic.rotate(angle));
    }

    /// 102 entries for the first 7 steps, 17 single ones.
    #[divan::bench]
    fn table_7_steps_to_24(bencher: Bencher) {
        let cordic = plain::Cordic::merged(7, 24);
        one(bencher, angles(), |angle| cordic.rotate(angle));
    }

    /// 102 entries for the first 7 steps, 11 single ones.
    #[divan::bench]
    fn table_7_steps_to_18(bencher: Bencher) {
        let cordic = plain::Cordic::merged(7, 18);
        one(bencher, angles(), |angle| cordic.rotate(angle));
    }

    /// No single step. As exact as the others with two more terms of the residual's series, which is what the kernel has.
    #[divan::bench]
    fn table_7_no_steps(bencher: Bencher) {
        let cordic = plain::Cordic::merged(7, 7);
        one(bencher, angles(), |angle| cordic.rotate(angle));
    }

    /// The kernel, reduction and rounding included.
    #[divan::bench]
    fn fx(bencher: Bencher) {
        let angles = angles().into_iter().map(|angle| Fx::from_bits(angle >> 30)).collect();
        one(bencher, angles, Fx::sin_cos);
    }
}

mod atan2 {
    use super::*;

    fn arguments() -> (Vec<Fx>, Vec<Fx>) {
        (values(1, 40), values(2, 40))
    }

    #[divan::bench]
    fn fx(bencher: Bencher) {
        two(bencher, arguments(), Fx::atan2);
    }

    #[divan::bench]
    fn cordic_crate(bencher: Bencher) {
        let (y, x) = arguments();
        two(bencher, (fixeds(y), fixeds(x)), cordic::atan2);
    }

    #[divan::bench]
    fn f64(bencher: Bencher) {
        let (y, x) = arguments();
        two(bencher, (floats(y), floats(x)), f64::atan2);
    }
}

mod sqrt {
    use super::*;

    #[divan::bench]
    fn fx(bencher: Bencher) {
        one(bencher, positive(1, 64), Fx::sqrt);
    }

    /// The standard library's integer root, rounded down.
    #[divan::bench]
    fn integer_of_std(bencher: Bencher) {
        one(bencher, positive(1, 64), |value| (u128::from(value.to_bits() as u64) << 32).isqrt());
    }

    /// Below 2^28: its first loop wraps and never ends from 2^30 on.
    #[divan::bench]
    fn cordic_crate(bencher: Bencher) {
        one(bencher, fixeds(positive(1, 60)), cordic::sqrt);
    }

    #[divan::bench]
    fn f64(bencher: Bencher) {
        one(bencher, floats(positive(1, 64)), f64::sqrt);
    }
}

mod length {
    use super::*;

    #[divan::bench]
    fn fx(bencher: Bencher) {
        two(bencher, (values(1, 62), values(2, 62)), Fx::checked_hypot);
    }

    #[divan::bench]
    fn f64_hypot(bencher: Bencher) {
        two(bencher, (floats(values(1, 62)), floats(values(2, 62))), f64::hypot);
    }
}

mod product {
    use super::*;

    #[divan::bench]
    fn fx(bencher: Bencher) {
        two(bencher, (values(1, 46), values(2, 46)), |a: Fx, b| a * b);
    }

    #[divan::bench]
    fn fixed_crate_rounded_down(bencher: Bencher) {
        two(bencher, (fixeds(values(1, 46)), fixeds(values(2, 46))), I32F32::wrapping_mul);
    }
}

mod division {
    use super::*;

    #[divan::bench]
    fn fx(bencher: Bencher) {
        two(bencher, (values(1, 46), positive(2, 40)), Fx::checked_div);
    }

    #[divan::bench]
    fn fixed_crate_rounded_to_zero(bencher: Bencher) {
        two(bencher, (fixeds(values(1, 46)), fixeds(positive(2, 40))), I32F32::wrapping_div);
    }

    #[divan::bench]
    fn f64(bencher: Bencher) {
        two(bencher, (floats(values(1, 46)), floats(positive(2, 40))), |a, b| a / b);
    }
}

mod exp2 {
    use super::*;

    #[divan::bench]
    fn fx(bencher: Bencher) {
        one(bencher, values(1, 36), Fx::exp2);
    }

    /// e^x, as the crate has no 2^x.
    #[divan::bench]
    fn cordic_crate_exp(bencher: Bencher) {
        one(bencher, fixeds(values(1, 36)), cordic::exp);
    }

    #[divan::bench]
    fn f64(bencher: Bencher) {
        one(bencher, floats(values(1, 36)), f64::exp2);
    }
}

mod log2 {
    use super::*;

    #[divan::bench]
    fn fx(bencher: Bencher) {
        one(bencher, positive(1, 48), Fx::log2);
    }

    #[divan::bench]
    fn f64(bencher: Bencher) {
        one(bencher, floats(positive(1, 48)), f64::log2);
    }
}

mod pow {
    use super::*;

    #[divan::bench]
    fn fx(bencher: Bencher) {
        two(bencher, (positive(1, 40), values(2, 34)), Fx::pow);
    }

    #[divan::bench]
    fn f64(bencher: Bencher) {
        two(bencher, (floats(positive(1, 40)), floats(values(2, 34))), f64::powf);
    }
}

/// The force formulas, metres apart.
mod custom_forces {
    use super::*;

    type Pair = Vec2<FxWide>;

    /// Vectors of either sign with `bits` random bits a component.
    fn vectors(seed: u64, bits: u32) -> Vec<Pair> {
        let component = |seed| values(seed, bits).into_iter().map(FxWide::from);
        component(seed).zip(component(seed + 1)).map(Pair::from).collect()
    }

    fn factors(seed: u64, divisor: u64) -> Vec<FxFactor> {
        positive(seed, 36).into_iter().map(|bits| FxFactor::from_ratio(bits.to_bits() as u64, divisor)).collect()
    }

    const SPRING: SpringConstants<Fx> = SpringConstants { rest: fx!(1), stiffness: fx!(100), damping: Fx::ZERO };

    #[divan::bench]
    fn spring(bencher: Bencher) {
        one(bencher, vectors(1, 34), |offset| Fx::tension(offset, Pair::default(), &SPRING));
    }

    #[divan::bench]
    fn spring_with_damper(bencher: Bencher) {
        let spring = SpringConstants { damping: fx!(1.5), ..SPRING };
        two(bencher, (vectors(1, 34), vectors(3, 35)), |offset, velocity| Fx::tension(offset, velocity, &spring));
    }

    #[divan::bench]
    fn attraction(bencher: Bencher) {
        let mu = FxFactor::from_ratio(400, 3);
        one(bencher, vectors(1, 36), |offset| Fx::attraction(mu, offset, fx!(0.25)));
    }

    /// Drag at up to 16 m/s, with coefficients of ¼ a second and a metre, over 1/120 s.
    fn drag(bencher: Bencher, linear: FxFactor, quadratic: FxFactor) {
        let seconds = FxFactor::from_ratio(1, 120);
        one(bencher, factors(1, 1 << 31), |speed| Fx::drag(&mut None, speed, linear, quadratic, seconds, false));
    }

    #[divan::bench]
    fn drag_linear(bencher: Bencher) {
        drag(bencher, FxFactor::from_ratio(1, 4), FxFactor::ZERO);
    }

    #[divan::bench]
    fn drag_quadratic(bencher: Bencher) {
        drag(bencher, FxFactor::ZERO, FxFactor::from_ratio(1, 4));
    }

    #[divan::bench]
    fn drag_of_both_kinds(bencher: Bencher) {
        drag(bencher, FxFactor::from_ratio(1, 4), FxFactor::from_ratio(1, 4));
    }

    /// A force over a mass.
    #[divan::bench]
    fn force_times_factor(bencher: Bencher) {
        let forces: Vec<FxWide> = vectors(1, 40).into_iter().map(|force| force.x).collect();
        two(bencher, (forces, factors(3, 1 << 40)), |force, factor: FxFactor| force.times(factor));
    }

    #[divan::bench]
    fn factor_over_factor(bencher: Bencher) {
        two(bencher, (factors(1, 3), factors(2, 7)), FxFactor::over);
    }
}
