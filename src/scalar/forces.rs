//! Force formulas: attraction, springs, drag, and the lengths they need.

use super::Offset;
use super::factor::FxFactor;
use super::motion::power_of_two;
use super::number::Scalar;
use super::wide::FxWide;
use crate::fx::Fx;
use crate::kernel::div::{div_round_by, reciprocal};
use crate::kernel::round::{shr_round, shr_round_short};
use crate::kernel::sqrt::{root_and_reciprocal, root_fine};
use crate::kernel::wide::{div_256, magnitude, mul_128, mul_192, mul_shift_64, mul_shift_near, with_sign};

/// The constants of a spring.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct SpringConstants<S> {
    /// Length at which the spring exerts no force, m, 0 to 2^30.
    pub rest: S,
    /// Stiffness, N/m, from 0.
    pub stiffness: S,
    /// Damping along the spring, N·s/m, from 0.
    pub damping: S,
}

/// Force formulas.
#[doc(hidden)]
pub trait Forces<S: Scalar>: Sized {
    /// The acceleration towards an attractor: mu·d / (d² + softening²)^(3/2); zero at its centre.
    fn attraction(mu: S::Factor, to_centre: Offset<S>, softening: S) -> Option<Offset<S>>;
    /// The force of a spring on its near end, whose far end is at `offset` and moves at `velocity` relative to it:
    /// stiffness·(length − rest) + damping·(d length/dt) along the spring; zero where the ends coincide.
    fn tension(offset: Offset<S>, velocity: Offset<S>, spring: &SpringConstants<S>) -> Option<Offset<S>>;
    /// √(x² + y² + z²).
    fn length(offset: Offset<S>, third: S) -> S::Factor;
    /// Returns true if the offset is no longer than this length, exactly.
    fn reaches(self, offset: Offset<S>) -> bool;
    /// The share that is left of a velocity relative to the medium: du/dt = −(α + β·|u|)·u solved exactly over `seconds`, with
    /// α = linear·inverse_mass and β = quadratic·inverse_mass. Backwards the quadratic
    /// part is cut off short of its pole, where a speed grows fourfold. `None` if the linear part grows beyond 2^255.
    fn drag(
        speed: S::Factor,
        alpha: S::Factor,
        beta: S::Factor,
        seconds: S::Factor,
        negative: bool,
    ) -> Option<S::Factor>;
}

/// log2 e, within 2^-64 relative.
const LOG2_E: (u128, i32) = (0xb8aa_3b29_5c17_f0bc, 63);

/// e^-z, or e^z if `growth`; `None` beyond 2^255.
pub(crate) fn exponential(z: FxFactor, growth: bool) -> Option<FxFactor> {
    let exponent = z.times(FxFactor::new(LOG2_E.0, LOG2_E.1));
    match exponent.to_fixed(120) {
        Some(exponent) => Some(power_of_two(exponent, !growth)),
        None => (!growth).then_some(FxFactor::ZERO),
    }
}

/// (1 − e^-z) / z, or (e^z − 1) / z if `growth`, given that exponential.
pub(super) fn mean_exponential(z: FxFactor, exponential: FxFactor, growth: bool) -> FxFactor {
    // Below 2^-16 the difference would lose more than the series does: 1 ∓ z/2 + z²/6 ∓ z³/24, next term z⁴/120 < 2^-70.
    if z < FxFactor::new(1, 16) {
        let series = |terms: FxFactor, divisor: u64| z.times(terms).over_nonzero(FxFactor::from_ratio(divisor, 1));
        let third = FxFactor::ONE;
        let join = |next: FxFactor| if growth { FxFactor::ONE.plus(next) } else { FxFactor::ONE.minus(next) };
        return join(series(join(series(join(series(third, 4)), 3)), 2));
    }
    let change = if growth { exponential.minus(FxFactor::ONE) } else { FxFactor::ONE.minus(exponential) };
    change.over_nonzero(z)
}

/// An offset in ulps, the sum of the squares of its components, and of a third.
///
/// *Domain* components below 2^31.38 m; `None` beyond. Positions inside a step stay below 2^30.35 m, and attachments within
/// 2^12 m of them, so that no two points of one are farther apart.
fn squares(offset: Offset<Fx>, third: Fx) -> Option<(i128, i128, u128)> {
    const MOST: u128 = 12_000_000_000_000_000_000; // 2^63.38: 2·MOST² + 2^124 < 2^128
    let (x, y) = (offset.x.ulps(), offset.y.ulps());
    let third = third.to_bits().unsigned_abs();
    let (along, across) = (magnitude(x), magnitude(y));
    if along > MOST || across > MOST || third > 1 << 62 {
        return None;
    }
    let square = |c: u64| u128::from(c) * u128::from(c);
    Some((x, y, square(along as u64) + square(across as u64) + square(third)))
}

/// √sum · 2^(32 − shift), with all its bits for small sums as well.
fn root(sum: u128, shift: i32) -> FxFactor {
    if sum == 0 {
        return FxFactor::ZERO;
    }
    let even = sum.leading_zeros() & !1;
    FxFactor::new(root_fine(sum << even), shift + (even / 2) as i32)
}

/// ⌊mantissa · 2^160 / cube⌋, from which mu / d³ is made, with 95 bits or more. *Domain* cube >= 2^125.
#[cold]
pub(super) fn share(mantissa: u64, cube: u128) -> u128 {
    // mantissa · 2^160 < 2^224: its high half is below 2^96, which is below the cube.
    div_256(u128::from(mantissa) << 32, 0, cube).0
}

/// The [`share`], or one more or less, without a division.
///
/// *Domain* cube = v^(3/2) · 2^128 within 2^-94 relative, and inverse = 2^61 / √v within 2^-55, for a v in [¼, 1).
#[inline]
pub(super) fn near_share(mantissa: u64, cube: u128, inverse: u64) -> u128 {
    let high = |a: u64, b: u64| ((u128::from(a) * u128::from(b)) >> 64) as u64;
    // 1/v^(3/2) <= 2^3 within 3 · 2^-55 + 2^-58 + 2^-60 < 2^-53.3.
    let power_q60 = ((u128::from(high(inverse, inverse)) * u128::from(inverse)) >> 59) as u64;
    // In units of 2^36, with 59 to 63 bits: rounded down within 2^-53.2.
    let first = high(mantissa, power_q60);
    // The remainder of mantissa · 2^160 after that, in units of 2^100 and less than one too much: below 2^(124 − 53.2) = 2^70.8.
    let rest = (i128::from(mantissa) << 60) - mul_192(cube, first).0 as i128;
    // rest · 2^100 / cube, below 2^45.8. The power is 2^-7.5 of it off, the bits cut off make 2^-16, and rounding down one.
    let second = ((rest >> 8) * i128::from(power_q60)) >> 80;
    ((u128::from(first) << 36) as i128 + second) as u128
}

/// The direction of an offset: takes the parts of a vector along it, and of a magnitude along the axes.
struct Direction {
    /// The length with its top bit set.
    length: u128,
    /// The reciprocal of the length, to divide by.
    reciprocal: u64,
    /// A component in ulps, shifted by this, is 2^-64 of what it is in the units of that length.
    scale: u32,
}

impl Direction {
    /// *Domain* `fine` = √(sum · 2^(2·up)) in units of 2^-32, in [2^95, 2^96], for the sum of the squares of two components.
    #[inline]
    fn new(fine: u128, up: u32) -> Self {
        // 32, or 31 where the length rounds up to 2^96. The sum of two squares is below 0.9 · 2^128, so that it has been scaled
        // there, and `up` is at least 1.
        let spare = fine.leading_zeros();
        let length = fine << spare;
        Self { length, reciprocal: reciprocal(length), scale: up + spare - 32 }
    }

    /// `whole` times a component over the length, with `more` bits behind the last; `None` if it does not fit.
    // Inlined for `more`, which is a constant.
    #[inline(always)]
    fn part(&self, whole: i128, component: i128, more: u32) -> Option<i128> {
        // |component| · 2^up is at most √(sum · 2^(2·up)) < 2^64.
        let (high, low) = mul_192(magnitude(whole), (magnitude(component) as u64) << self.scale);
        if high.leading_zeros() < more {
            return None;
        }
        let low = u128::from(low) << 64;
        let (high, low) = ((high << more) | (low >> 1 >> (127 - more)), low << more);
        let part = div_round_by(high, low, self.length, self.reciprocal)?;
        Some(with_sign(i128::try_from(part).ok()?, component ^ whole))
    }
}

impl Forces<Fx> for Fx {
    /// *Error* within 2^-64 + 2^-90 relative of the exact value for these inputs, then rounded to 2^-64 m/s².
    fn attraction(mu: FxFactor, to_centre: Offset<Self>, softening: Self) -> Option<Offset<Self>> {
        let (x, y, sum) = squares(to_centre, softening)?;
        let (mantissa, mu_shift) = mu.parts();
        if (x == 0 && y == 0) || mantissa == 0 {
            return Some(Offset::<Self>::default());
        }
        // s = sum · 2^even in [2^126, 2^128), and its root in [2^95, 2^96).
        let even = sum.leading_zeros() & !1;
        let s = sum << even;
        // d³ / 2^(64 − 3·even/2) in [2^125, 2^128), cut below 2^-125 relative. The root of the largest s rounds up to 2^96,
        // which is one too many: 2^-96 relative.
        let (root, inverse) = root_and_reciprocal(s);
        let (cube, _) = mul_128(s, root.min((1 << 96) - 1) << 32);
        let approximate = near_share(mantissa, cube, inverse);
        let shift = 96 + mu_shift - 3 * (even as i32) / 2;
        let component = |c: i128| {
            let size = magnitude(c) as u64;
            let part = match mul_shift_near(approximate, size, shift) {
                Some(part) => part,
                None => mul_shift_64(share(mantissa, cube) as i128, size, shift)?,
            };
            Some(FxWide::from_bits(with_sign(part, c)))
        };
        Some(Offset::<Self>::new(component(x)?, component(y)?))
    }

    /// *Error* the tension is that of a spring 0.501 · 2^-64 m longer or shorter (from 2^23 m on 0.751), rounded to 2^-64 N;
    /// each component is then rounded once more.
    fn tension(offset: Offset<Self>, velocity: Offset<Self>, spring: &SpringConstants<Self>) -> Option<Offset<Self>> {
        let (x, y, sum) = squares(offset, Self::ZERO)?;
        if sum == 0 {
            return Some(Offset::<Self>::default());
        }
        // The direction of a short spring needs all bits of its length: that in units of 2^-64 m / 2^up, in [2^95, 2^96].
        let up = sum.leading_zeros() / 2;
        let fine = root_fine(sum << (2 * up));
        // In units of 2^-64 m, below 2^97. Rounded twice: 0.501 / 2^up of a unit, then a half.
        let length = shr_round_short(fine, up);
        let stretch = length as i128 - (i128::from(spring.rest.to_bits()) << 32);
        let direction = Direction::new(fine, up);
        let mut tension = mul_shift_64(stretch, spring.stiffness.to_bits().unsigned_abs(), 32)?;
        if spring.damping != Self::ZERO {
            // Velocities of points are below 2^34 m/s, so each part is below 2^34 · 2^(64 + 16) and a little.
            let part = |v: FxWide, c: i128| direction.part(v.to_bits(), c, 16);
            let rate = shr_round(part(velocity.x, x)?.checked_add(part(velocity.y, y)?)?, 16);
            let damping = mul_shift_64(rate, spring.damping.to_bits().unsigned_abs(), 32)?;
            tension = tension.checked_add(damping)?;
        }
        let part = |c: i128| Some(FxWide::from_bits(direction.part(tension, c, 0)?));
        Some(Offset::<Self>::new(part(x)?, part(y)?))
    }

    fn length(offset: Offset<Self>, third: Self) -> FxFactor {
        match squares(offset, third) {
            Some((_, _, sum)) => root(sum, 64),
            // Farther than any two points of the envelope are from each other: by quarters, two bits coarser.
            None => {
                let quarter = |c: FxWide| FxWide::from_bits(c.to_bits() / 4);
                let third = Self::from_bits(third.to_bits() / 4);
                match squares(offset.map(quarter), third) {
                    Some((_, _, sum)) => root(sum, 62),
                    None => FxFactor::new(1, -32),
                }
            }
        }
    }

    fn reaches(self, offset: Offset<Self>) -> bool {
        // A sum of squares that does not fit is beyond every radius.
        let square = u128::from(self.to_bits().unsigned_abs()).pow(2);
        self >= Self::ZERO && squares(offset, Self::ZERO).is_some_and(|(_, _, sum)| sum <= square)
    }

    fn drag(speed: FxFactor, alpha: FxFactor, beta: FxFactor, seconds: FxFactor, negative: bool) -> Option<FxFactor> {
        // 1/u obeys dw/dt = α·w + β, so u(h) = u·e^-αh / (1 + β·u·(1 − e^-αh)/α); backwards both signs turn.
        let (left, mean) = if alpha.is_zero() {
            (FxFactor::ONE, FxFactor::ONE)
        } else {
            let z = alpha.times(seconds);
            let left = exponential(z, negative)?;
            (left, mean_exponential(z, left, negative))
        };
        let slowed = beta.times(speed).times(seconds).times(mean);
        if negative {
            // The flow backwards has a pole at 1; short of it a body's speed grows fourfold at most.
            return Some(left.over_nonzero(FxFactor::ONE.minus(slowed.min(FxFactor::new(3, 2)))));
        }
        Some(left.over_nonzero(FxFactor::ONE.plus(slowed)))
    }
}
