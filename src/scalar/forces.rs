//! Force formulas: attraction, springs, drag, and the lengths they need.

use super::Offset;
use super::factor::FxFactor;
use super::motion::power_of_two;
use super::number::Scalar;
use super::wide::FxWide;
use crate::fx::Fx;
use crate::kernel::div::{div_round_by, reciprocal};
use crate::kernel::inverse_cube::{OVER_CUBE_ERROR, over_cube};
use crate::kernel::round::{shr_round, shr_round_short};
use crate::kernel::sqrt::root_fine;
use crate::kernel::wide::{div_256, magnitude, mul_128, mul_192, mul_shift_64, with_sign};

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
    /// The exponentials of the drag before, which bodies of the same mass in one field share. It has no effect on results.
    type DragMemo: Default;

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
        memo: &mut Self::DragMemo,
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

/// The exponentials of a linear drag over a span.
#[derive(Clone, Copy, Debug)]
#[doc(hidden)]
pub struct FxDecay {
    /// The inverse time constant, the span, and whether time runs backwards.
    made_for: (FxFactor, FxFactor, bool),
    /// e^-αh.
    left: FxFactor,
    /// (1 − e^-αh) / αh.
    mean: FxFactor,
}

impl FxDecay {
    /// `None` if they grow beyond 2^255.
    fn new(alpha: FxFactor, seconds: FxFactor, negative: bool) -> Option<Self> {
        let (left, mean) = if alpha.is_zero() {
            (FxFactor::ONE, FxFactor::ONE)
        } else {
            let z = alpha.times(seconds);
            let left = exponential(z, negative)?;
            (left, mean_exponential(z, left, negative))
        };
        Some(Self { made_for: (alpha, seconds, negative), left, mean })
    }
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

/// The attraction as it is defined, by a division: for what [`sure_attraction`] is not sure of.
#[cold]
#[inline(never)]
fn defined_attraction(mu: FxFactor, to_centre: Offset<Fx>, softening: Fx) -> Option<Offset<Fx>> {
    let (x, y, sum) = squares(to_centre, softening)?;
    let (mantissa, mu_shift) = mu.parts();
    if (x == 0 && y == 0) || mantissa == 0 {
        return Some(Offset::<Fx>::default());
    }
    // s = sum · 2^even in [2^126, 2^128), and its root in [2^95, 2^96).
    let even = sum.leading_zeros() & !1;
    let s = sum << even;
    // d³ / 2^(64 − 3·even/2) in [2^125, 2^128), cut below 2^-125 relative. The root of the largest s rounds up to 2^96,
    // which is one too many: 2^-96 relative.
    let (cube, _) = mul_128(s, root_fine(s).min((1 << 96) - 1) << 32);
    // ⌊mantissa · 2^160 / cube⌋, with 95 bits or more. mantissa · 2^160 < 2^224: its high half is below 2^96, which is below the cube.
    let (share, _) = div_256(u128::from(mantissa) << 32, 0, cube);
    let shift = 96 + mu_shift - 3 * (even as i32) / 2;
    let component = |c: i128| {
        let part = mul_shift_64(share as i128, magnitude(c) as u64, shift)?;
        Some(FxWide::from_bits(with_sign(part, c)))
    };
    Some(Offset::<Fx>::new(component(x)?, component(y)?))
}

/// The [`defined_attraction`] by an estimate, where it is sure to round alike; `None` where it may not, and outside of 2^-37 to 2^17 m/s².
///
/// # Ranges
/// The share of the definition is mu / d³ within 2^-95.9 relative: less than a unit of the power, which is 64 units of the share. The power
/// is less than 168 away from it, [`over_cube`] says why. A component moved up by `half_even` has at most 64 bits, as its square is at most
/// the sum; so its product with the power, in units of 2^64, is below 2^93.2 and, rounded down, less than 170 away: [`OVER_CUBE_ERROR`] is more.
#[inline(always)]
pub(super) fn sure_attraction(mu: FxFactor, to_centre: Offset<Fx>, softening: Fx) -> Option<Offset<Fx>> {
    let (x, y) = (to_centre.x.ulps_of_a_word()?, to_centre.y.ulps_of_a_word()?);
    let third = softening.to_bits().unsigned_abs();
    let (mantissa, mu_shift) = mu.parts();
    let (along, across) = (x.unsigned_abs(), y.unsigned_abs());
    // At most 2^126 + 2^126 + 2^124.
    let square = |c: u64| u128::from(c) * u128::from(c);
    if third > 1 << 62 {
        return None;
    }
    let sum = square(along) + square(across) + square(third);
    let half_even = sum.leading_zeros() / 2;
    // The bits of a product, in units of 2^64, below those of the result: mu / d³ is the power · 2^(3·half_even − 90 − mu_shift) and a
    // component has been moved up by `half_even`.
    let cut = 26 + mu_shift - 2 * half_even as i32;
    // The error is at most a quarter of a unit of the result.
    if sum == 0 || !(10..=64).contains(&cut) {
        return None;
    }
    let up = 64 - cut.unsigned_abs();
    let power = over_cube(mantissa, sum << (2 * half_even));
    let error = OVER_CUBE_ERROR << up;
    let part = |c: u64, sign: i64| {
        let c = c << half_even;
        let product = (power >> 64) * u128::from(c) + ((u128::from(power as u64) * u128::from(c)) >> 64);
        let rest = (product as u64) << up;
        let is_sure = rest.wrapping_sub(1 << 63).wrapping_add(error) > 2 * error;
        let floor = (product >> 1) >> (63 - up);
        (with_sign((floor + u128::from(rest >> 63)) as i128, sign.into()), is_sure)
    };
    let ((x, x_is_sure), (y, y_is_sure)) = (part(along, x), part(across, y));
    (x_is_sure & y_is_sure).then_some(Offset::<Fx>::new(FxWide::from_bits(x), FxWide::from_bits(y)))
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
    type DragMemo = Option<FxDecay>;

    /// *Error* within 2^-64 + 2^-90 relative of the exact value for these inputs, then rounded to 2^-64 m/s².
    #[inline]
    fn attraction(mu: FxFactor, to_centre: Offset<Self>, softening: Self) -> Option<Offset<Self>> {
        match sure_attraction(mu, to_centre, softening) {
            Some(acceleration) => Some(acceleration),
            None => defined_attraction(mu, to_centre, softening),
        }
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

    fn drag(
        memo: &mut Option<FxDecay>,
        speed: FxFactor,
        alpha: FxFactor,
        beta: FxFactor,
        seconds: FxFactor,
        negative: bool,
    ) -> Option<FxFactor> {
        // 1/u obeys dw/dt = α·w + β, so u(h) = u·e^-αh / (1 + β·u·(1 − e^-αh)/α); backwards both signs turn.
        let decay = match *memo {
            Some(decay) if decay.made_for == (alpha, seconds, negative) => decay,
            _ => *memo.insert(FxDecay::new(alpha, seconds, negative)?),
        };
        let FxDecay { left, mean, .. } = decay;
        let slowed = beta.times(speed).times(seconds).times(mean);
        if negative {
            // The flow backwards has a pole at 1; short of it a body's speed grows fourfold at most.
            return Some(left.over_nonzero(FxFactor::ONE.minus(slowed.min(FxFactor::new(3, 2)))));
        }
        Some(left.over_nonzero(FxFactor::ONE.plus(slowed)))
    }
}
