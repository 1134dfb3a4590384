//! The plain scheme that the kernel's table rotation stands in for: 24 CORDIC rotations in Q2.62, one after the other, then
//! one by the residual angle.

use dashu_float::FBig;
use dashu_float::round::mode::HalfEven;

type Real = FBig<HalfEven, 2>;

/// The single rotations of the plain scheme.
const STEPS: usize = 24;

/// CORDIC with its first rotations merged into one from a table, its last ones into one by the residual angle, and single
/// rotations in between.
pub(crate) struct Cordic {
    /// (cos, sin) in Q2.62 of multiples of 2^-first rad, made shorter by what the single rotations make longer.
    table_q62: Vec<(i64, i64)>,
    first: usize,
    /// The angles of the single rotations.
    angles_q62: Vec<i64>,
    half_pi_q92: i128,
}

impl Cordic {
    /// All rotations single.
    pub(crate) fn new() -> Self {
        Self::merged(0, STEPS)
    }

    /// The rotations before `first` from the table, those before `end` single.
    pub(crate) fn merged(first: usize, end: usize) -> Self {
        let real = |value: i64| Real::from(value).with_precision(200).value();
        let units = |value: Real, bits: isize| i128::try_from((value << bits).round().to_int().value()).expect("fits");
        let powers = (first..end).map(|i| real(1) >> i as isize);
        // Rotation i makes the vector √(1 + 4^-i) times as long.
        let growth = powers.clone().fold(real(1), |growth, power| growth * (real(1) + &power * &power)).sqrt();
        // π/4, below 4/5, and half a spacing; without a merged rotation the vector starts at 0.
        let entries = if first == 0 { 1 } else { (1i64 << first) * 4 / 5 + 2 };
        let entry = |i: i64| {
            let (sin, cos) = (real(i) >> first as isize).sin_cos();
            (units(cos / &growth, 62) as i64, units(sin / &growth, 62) as i64)
        };
        Self {
            table_q62: (0..entries).map(entry).collect(),
            first,
            angles_q62: powers.map(|power| units(power.atan(), 62) as i64).collect(),
            half_pi_q92: units(real(1).asin(), 92),
        }
    }

    /// (sin, cos) in Q2.62 of an angle in Q2.62 within ±π/4, give or take a little.
    pub(crate) fn rotate(&self, angle: i64) -> (i64, i64) {
        let merged =
            if self.first == 0 { 0 } else { (angle.unsigned_abs() + (1 << (61 - self.first))) >> (62 - self.first) };
        let (mut x, y) = self.table_q62[merged as usize];
        let (mut y, mut angle) = if angle < 0 {
            (-y, angle + ((merged as i64) << (62 - self.first)))
        } else {
            (y, angle - ((merged as i64) << (62 - self.first)))
        };
        for (i, step) in (self.first..).zip(&self.angles_q62) {
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
        (y + high(x, angle) - high(y, versine), x - high(y, angle) - high(x, versine))
    }

    /// (sin, cos) in Q2.62 of raw·2^-32 radians.
    pub(crate) fn sin_cos_q62(&self, raw: i64) -> (i64, i64) {
        let quadrant = (i128::from(raw) << 60) + self.half_pi_q92 / 2;
        let quadrant = quadrant.div_euclid(self.half_pi_q92);
        let angle = (((i128::from(raw) << 60) - quadrant * self.half_pi_q92 + (1 << 29)) >> 30) as i64;
        let (sin, cos) = self.rotate(angle);
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
