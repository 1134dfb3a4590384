//! The plain scheme that the kernel's table rotation stands in for: 24 CORDIC rotations in Q2.62, one after the other, then
//! one by the residual angle.

use dashu_float::FBig;
use dashu_float::round::mode::HalfEven;

type Real = FBig<HalfEven, 2>;

const STEPS: usize = 24;

pub(crate) struct Cordic {
    angles_q62: [i64; STEPS],
    start_q62: i64,
    half_pi_q92: i128,
}

impl Cordic {
    pub(crate) fn new() -> Self {
        let real = |value: i64| Real::from(value).with_precision(200).value();
        let units = |value: Real, bits: isize| i128::try_from((value << bits).round().to_int().value()).expect("fits");
        let powers = (0..STEPS).map(|i| real(1) >> i as isize);
        // Rotation i makes the vector √(1 + 4^-i) times as long.
        let growth = powers.clone().fold(real(1), |growth, power| growth * (real(1) + &power * &power));
        let mut angles_q62 = [0; STEPS];
        for (angle, power) in angles_q62.iter_mut().zip(powers) {
            *angle = units(power.atan(), 62) as i64;
        }
        Self {
            angles_q62,
            start_q62: units(real(1) / growth.sqrt(), 62) as i64,
            half_pi_q92: units(real(1).asin(), 92),
        }
    }

    /// (sin, cos) in Q2.62 of raw·2^-32 radians.
    pub(crate) fn sin_cos_q62(&self, raw: i64) -> (i64, i64) {
        let quadrant = (i128::from(raw) << 60) + self.half_pi_q92 / 2;
        let quadrant = quadrant.div_euclid(self.half_pi_q92);
        let mut angle = (((i128::from(raw) << 60) - quadrant * self.half_pi_q92 + (1 << 29)) >> 30) as i64;
        let (mut x, mut y) = (self.start_q62, 0i64);
        for (i, step) in self.angles_q62.iter().enumerate() {
            // All ones where the angle is negative: the direction, without a branch.
            let sign = angle >> 63;
            let half = if i == 0 { 0 } else { 1i64 << (i - 1) };
            let (dx, dy) = ((y + half) >> i, (x + half) >> i);
            x -= (dx ^ sign) - sign;
            y += (dy ^ sign) - sign;
            angle -= (step ^ sign) - sign;
        }
        let high = |a: i64, b: i64| ((i128::from(a) * i128::from(b) + (1 << 61)) >> 62) as i64;
        let versine = high(angle, angle) >> 1;
        let (cos, sin) = (x - high(y, angle) - high(x, versine), y + high(x, angle) - high(y, versine));
        match quadrant & 3 {
            0 => (sin, cos),
            1 => (cos, -sin),
            2 => (-sin, -cos),
            _ => (-cos, sin),
        }
    }

    /// (sin, cos) in I32F32, rounded to nearest, ties to even.
    pub(crate) fn sin_cos(&self, raw: i64) -> (i64, i64) {
        let (sin, cos) = self.sin_cos_q62(raw);
        let round = |value: i64| (value + ((1 << 29) - 1) + ((value >> 30) & 1)) >> 30;
        (round(sin), round(cos))
    }
}
