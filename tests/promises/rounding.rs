//! P4: maths is correctly rounded, by the definition where integers decide it, and against the exact reference elsewhere.

use dashu_int::IBig;
use proptest::prelude::*;
use umbra_physics::{Fx, MathError};

use crate::promises::check::{Verdict, config, falsified};
use crate::promises::reference::{Reference, error, real};

/// Any bits: of any size, next to a power of two, few and far between.
fn raw() -> BoxedStrategy<i64> {
    let sized = (any::<i64>(), 0u32..64).prop_map(|(bits, shift)| bits >> shift);
    let near_power = (0u32..63, -3i64..=3, any::<bool>()).prop_map(|(log2, off, negative)| {
        let power = (1i64 << log2).saturating_add(off);
        if negative { -power } else { power }
    });
    prop_oneof![4 => sized, 2 => near_power, 1 => Just(i64::MAX), 1 => Just(i64::MIN)].boxed()
}

/// num/den to the nearest integer, ties to even; where it fits in 64 bits.
fn nearest(num: i128, den: i128) -> Option<i64> {
    let (num, den) = if den < 0 { (IBig::from(num) * -1, IBig::from(den) * -1) } else { (num.into(), den.into()) };
    let twice: IBig = &num * 2 + &den;
    let (den2, mut floor) = (&den * 2, &twice / (&den * 2));
    if &floor * &den2 > twice {
        floor -= 1;
    }
    // Half-up so far: a tie went up, to an odd number or not.
    if &floor * &den2 == twice && &floor % IBig::from(2) != IBig::ZERO {
        floor -= 1;
    }
    i64::try_from(floor).ok()
}

fn equal(what: &str, is: Option<Fx>, exact: Option<i64>) -> Verdict {
    if is.map(Fx::to_bits) == exact { Ok(()) } else { Err(format!("{what}: {is:?}, not {exact:?}")) }
}

#[test]
fn products_and_quotients_are_the_nearest_and_ties_go_to_even() {
    let counterexample = falsified(config(2_000), (raw(), raw()), |&(a, b)| {
        let (x, y) = (Fx::from_bits(a), Fx::from_bits(b));
        equal("product", x.checked_mul(y), nearest(i128::from(a) * i128::from(b), 1 << 32))?;
        let quotient = if b == 0 { None } else { nearest(i128::from(a) << 32, b.into()) };
        equal("quotient", x.checked_div(y), quotient)?;
        equal("ratio", Fx::checked_from_ratio(a, b), quotient)
    });
    assert!(counterexample.is_none(), "{counterexample:?}");
}

/// Returns true if r is √n to the nearest integer: r − ½ < √n < r + ½, as no integer's root is halfway.
fn is_root(r: u64, n: u128) -> bool {
    let r = u128::from(r);
    // (r ± ½)² = r² ± r + ¼.
    (r == 0 || r * r - r < n) && n <= r * r + r
}

#[test]
fn roots_and_lengths_are_the_nearest() {
    let counterexample = falsified(config(2_000), (raw(), raw()), |&(a, b)| {
        let root = Fx::from_bits(a).checked_sqrt();
        match root {
            Some(root) if !is_root(root.to_bits() as u64, (a as u128) << 32) => {
                return Err(format!("the root is {root}"));
            }
            None if a >= 0 => return Err("there is a root".to_owned()),
            _ => {}
        }
        let sum = u128::from(a.unsigned_abs()).pow(2) + u128::from(b.unsigned_abs()).pow(2);
        match Fx::from_bits(a).checked_hypot(Fx::from_bits(b)) {
            Some(length) if is_root(length.to_bits() as u64, sum) => Ok(()),
            None if !is_root(i64::MAX as u64, sum) && sum > (i64::MAX as u128).pow(2) => Ok(()),
            length => Err(format!("the length is {length:?}")),
        }
    });
    assert!(counterexample.is_none(), "{counterexample:?}");
}

#[test]
fn transcendental_functions_are_within_their_bounds() {
    let reference = Reference::new();
    let within = |what: &str, off: f64, bound: f64| {
        if off.abs() <= bound { Ok(()) } else { Err(format!("{what} is {off} ulps off")) }
    };
    // Beside the turning points of sine and cosine too.
    let quadrant =
        (0i64..1_367_130_551, -2i64..=2).prop_map(|(n, off)| (n as f64 * 6_746_518_852.261_009) as i64 + off);
    let angle = prop_oneof![raw(), quadrant];
    // Beside where powers of two begin to be too great, and to be 0.
    let edge = (prop_oneof![Just(31i64 << 32), Just(-33i64 << 32)], -3i64..=3).prop_map(|(edge, off)| edge + off);
    let power = prop_oneof![7 => raw(), 1 => edge];
    let counterexample = falsified(config(400), (angle, power), |&(a, b)| {
        let (sin, cos) = Fx::from_bits(a).sin_cos();
        let (exact_sin, exact_cos) = reference.sin_cos(a);
        within("the sine", error(sin.to_bits(), &exact_sin), 0.5001)?;
        within("the cosine", error(cos.to_bits(), &exact_cos), 0.5001)?;
        if a != i64::MIN && Fx::from_bits(-a).sin_cos() != (-sin, cos) {
            return Err("the mirrored angle has other bits".to_owned());
        }
        let (y, x) = (Fx::from_bits(a), Fx::from_bits(b));
        if (a, b) != (0, 0) {
            within("the angle", reference.angle_error(y.atan2(x).to_bits(), a, b), 0.51)?;
        }
        if a != i64::MIN && a != 0 && (-y).atan2(x) != -y.atan2(x) {
            return Err("the mirrored vector has another angle".to_owned());
        }
        match x.log2() {
            Ok(log) if b > 0 => within("the logarithm", error(log.to_bits(), &reference.log2(b)), 0.51)?,
            Err(MathError::NotPositive) if b <= 0 => {}
            log => return Err(format!("the logarithm is {log:?}")),
        }
        // Further out it is 0, or too great, all the more.
        let exact = reference.exp2(&real(b.clamp(-80 << 32, 64 << 32), -32));
        match x.exp2() {
            Ok(power) => within("the power of two", error(power.to_bits(), &exact), 0.51),
            Err(MathError::Overflow) if error(i64::MAX, &exact) < -0.5 => Ok(()),
            Err(error) => Err(format!("there is a power of two: {error}")),
        }
    });
    assert!(counterexample.is_none(), "{counterexample:?}");
}
