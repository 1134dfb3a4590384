//! Errors of results against the exact value, from the arbitrary-precision crate, fast enough for millions of inputs.
//!
//! The crate's own functions take 10 to 60 µs a call. They make tables here, by the byte of the argument; the addition
//! theorems put the bytes together, in the crate's arithmetic, with some 190 bits: sin and cos of a sum, 2^ of a sum.
//! A logarithm or an angle is not computed but tested: how far is 2^y from x, how far is the vector from the ray?

use dashu_float::FBig;
use dashu_float::round::mode::HalfEven;
use dashu_int::IBig;

pub(crate) type Real = FBig<HalfEven, 2>;

const PRECISION: usize = 200;

/// `mantissa`·2^exponent.
pub(crate) fn real(mantissa: impl Into<IBig>, exponent: isize) -> Real {
    Real::from_parts(mantissa.into(), exponent).with_precision(PRECISION).value()
}

fn float(value: &Real) -> f64 {
    value.to_f64().value()
}

pub(crate) struct Reference {
    /// (sin, cos) of byte·2^(8·place - 32) radians.
    sin_cos: Vec<Vec<(Real, Real)>>,
    /// 2^(byte·2^(-8·place - 8)).
    exp2: Vec<Vec<Real>>,
    pub(crate) half_pi: Real,
    ln_2: Real,
}

impl Reference {
    pub(crate) fn new() -> Self {
        let ln_2 = real(2, 0).ln();
        Self {
            sin_cos: (0..8).map(|place| (0..256).map(|byte| real(byte, 8 * place - 32).sin_cos()).collect()).collect(),
            exp2: (0..8)
                .map(|place| (0..256).map(|byte| (real(byte, -8 * place - 8) * &ln_2).exp()).collect())
                .collect(),
            half_pi: real(1, 0).asin(),
            ln_2,
        }
    }

    /// (sin, cos) of raw·2^-32 radians.
    pub(crate) fn sin_cos(&self, raw: i64) -> (Real, Real) {
        let (mut sin, mut cos) = (real(0, 0), real(1, 0));
        for (table, byte) in self.sin_cos.iter().zip(raw.unsigned_abs().to_le_bytes()) {
            if byte != 0 {
                let (s, c) = &table[usize::from(byte)];
                (sin, cos) = (&sin * c + &cos * s, cos * c - sin * s);
            }
        }
        if raw < 0 { (-sin, cos) } else { (sin, cos) }
    }

    /// 2^power, for |power| below 2^40.
    pub(crate) fn exp2(&self, power: &Real) -> Real {
        let scaled = (power.clone() << 64).floor();
        let rest = (power - (scaled.clone() >> 64)) * &self.ln_2;
        let scaled = i128::try_from(scaled.to_int().value()).expect("the power is small");
        // The rest is below 2^-64, its fourth power below 2^-256.
        let mut value = real(1, 0) + &rest * (real(1, 0) + &rest * (real(1, -1) + &rest / real(6, 0)));
        for (table, byte) in self.exp2.iter().zip((scaled as u64).to_be_bytes()) {
            if byte != 0 {
                value *= &table[usize::from(byte)];
            }
        }
        value << (scaled >> 64) as isize
    }

    /// e^power, for |power| below 2^39.
    pub(crate) fn exp(&self, power: &Real) -> Real {
        self.exp2(&(power / &self.ln_2))
    }

    /// log2(raw·2^-32).
    pub(crate) fn log2(&self, raw: i64) -> Real {
        // A guess within 2^-40, then ln(1 + e) = e - e²/2 + e³/3 - e⁴/4 of what it leaves.
        let guess = real((((raw as f64).log2() - 32.0) * (1u64 << 48) as f64) as i64, -48);
        let e = real(raw, -32) * self.exp2(&-guess.clone()) - real(1, 0);
        assert!(float(&e).abs() < 1e-12);
        let ln = &e * (real(1, 0) - &e * (real(1, -1) - &e * (real(1, 0) / real(3, 0) - &e * real(1, -2))));
        guess + ln / &self.ln_2
    }

    /// The angle `raw` less that of the vector (x, y), which must be near, in ulp.
    pub(crate) fn angle_error(&self, raw: i64, y: i64, x: i64) -> f64 {
        let (sin, cos) = self.sin_cos(raw);
        let (y, x) = (real(y, 0), real(x, 0));
        let along = &x * &cos + &y * &sin;
        let across = x * sin - y * cos;
        // tan z = z + z³/3; z is below 2^-32 or the test fails anyway.
        if float(&along) <= 0.0 { f64::INFINITY } else { float(&((across / along) << 32)) }
    }
}

/// raw less the exact value, in ulp.
pub(crate) fn error(raw: i64, exact: &Real) -> f64 {
    float(&(real(raw, 0) - (exact.clone() << 32)))
}
