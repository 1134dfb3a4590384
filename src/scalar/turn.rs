//! Angles in fixed point: fractions of a turn.

use core::fmt;

use super::accumulator::FxAccumulator;
use super::factor::FxFactor;
use super::motion::{Span, Weight, span_factor};
use super::number::{Angle, Number, inherent};
use super::wide::FxWide;
use crate::fx::{Fx, decimal};
use crate::kernel::div::div_round;
use crate::kernel::round::shr_round;
use crate::kernel::trig;
use crate::kernel::wide::{mul_shift, mul_shift_64};
use crate::math::{Random, Vec2};

/// An angle: a multiple of 2^-64 turns. It wraps by itself, and quarter turns and mirror images are exact.
///
/// ```
/// use umbra_physics::{Fx, FxWide, Turn, fx, vec2};
///
/// let quarter = Turn::from_radians(Fx::FRAC_PI_2);
/// assert_eq!((quarter.radians(), quarter.sin_cos()), (Fx::FRAC_PI_2, (fx!(1), fx!(0))));
/// let turned = Turn::QUARTER.rotate(vec2(3, 1)).and_then(|v| v.try_map(FxWide::to_scalar));
/// assert_eq!(turned, Some(vec2(-1, 3)));
/// assert_eq!(Turn::QUARTER.way_to(Turn::default()).to_scalar(), Some(-Fx::FRAC_PI_2));
/// assert_eq!(Turn::from_bits(Turn::QUARTER.to_bits()), Turn::QUARTER);
/// ```
#[derive(Clone, Copy, Default, PartialEq, Eq, Hash)]
#[repr(transparent)]
pub struct Turn(pub(super) u64);

impl Turn {
    /// A quarter turn, π/2.
    pub const QUARTER: Self = Self(1 << 62);

    /// The angle of this multiple of 2^-64 turns.
    #[inline]
    #[must_use]
    pub const fn from_bits(bits: u64) -> Self {
        Self(bits)
    }

    /// The multiple of 2^-64 turns.
    #[inline]
    #[must_use]
    pub const fn to_bits(self) -> u64 {
        self.0
    }

    /// The angle of this number of radians, which may be any number of turns. *Error* ½ of 2^-64 turns, and 2^-30 of one.
    #[must_use]
    pub fn from_radians(radians: Fx) -> Self {
        Self(trig::turn_from_radians(radians.to_bits()))
    }

    /// Radians in [0, 2π). *Error* 0.5001 ulp.
    #[must_use]
    pub fn radians(self) -> Fx {
        Fx::from_bits(trig::radians_from_turn(self.0))
    }

    /// The angle of this number of degrees, which may be any number of turns. *Error* ½ of 2^-64 turns, ties to even.
    ///
    /// ```
    /// # use umbra_physics::{Fx, Turn, fx};
    /// assert_eq!(Turn::from_degrees(fx!(-270)), Turn::QUARTER);
    /// assert_eq!((Turn::QUARTER.degrees(), Turn::QUARTER.radians()), (fx!(90), Fx::FRAC_PI_2));
    /// ```
    #[must_use]
    pub fn from_degrees(degrees: Fx) -> Self {
        // From units of 2^-32 to units of 2^-64 · 360: below 2^95. The cut to 64 bits takes whole turns away.
        Self(div_round(i128::from(degrees.to_bits()) << 32, 360) as u64)
    }

    /// Degrees, from 0 to 360: an angle within half an ulp of a full turn rounds to 360. *Error* ½ ulp, ties to even.
    #[must_use]
    pub fn degrees(self) -> Fx {
        // Below 2^64 · 360, in units of 2^-64.
        Fx::from_bits(shr_round(i128::from(self.0) * 360, 32) as i64)
    }

    /// Sine and cosine. *Error* 0.5001 ulp.
    #[must_use]
    pub fn sin_cos(self) -> (Fx, Fx) {
        let (sin, cos) = trig::sin_cos_turn(self.0);
        (Fx::from_bits(shr_round(i128::from(sin), 30) as i64), Fx::from_bits(shr_round(i128::from(cos), 30) as i64))
    }

    /// The shortest way from this angle to another, in rad between −π and π; zero for half a turn, where both ways are as long.
    ///
    /// *Error* 2^-64 relative, then rounded to 2^-64 rad.
    #[must_use]
    pub fn way_to(self, goal: Self) -> FxWide {
        // 2π in units of 2^-61.
        const TAU: u64 = 0xc90f_daa2_2168_c235;
        let way = goal.0.wrapping_sub(self.0) as i64;
        let way = if way == i64::MIN { 0 } else { way };
        // Below 2^63 times 2^64.
        FxWide::from_bits(mul_shift_64(way.into(), TAU, 61).unwrap_or(0))
    }

    /// The vector turned counter-clockwise by this angle; `None` if a component does not fit in an [`Fx`].
    ///
    /// *Error* 2^-60 of the length, and ½ of 2^-64.
    #[must_use]
    pub fn rotate(self, v: Vec2) -> Option<Vec2<FxWide>> {
        Self::turn(self.direction(), v)
    }
}

/// Turns from 0 to below 1, as the exact decimal; with a precision, that many digits, rounded to nearest, ties to even.
impl fmt::Display for Turn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        decimal::write(f, false, 0, u128::from(self.0) << 64)
    }
}

impl fmt::Debug for Turn {
    /// Writes the number as [`Display`](fmt::Display) does.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl Number for Turn {
    const WORDS: usize = 1;

    fn to_words(self) -> [u64; 3] {
        [self.0, 0, 0]
    }
}

impl Angle<Fx> for Turn {
    inherent! {
        fn from_radians(radians: Fx) -> Self;
        fn radians(self: Self) -> Fx;
        fn sin_cos(self: Self) -> (Fx, Fx);
        fn way_to(self: Self, goal: Self) -> FxWide;
        fn to_bits(self: Self) -> u64;
    }

    #[inline]
    fn to_turn(self) -> Self {
        self
    }

    #[inline]
    fn from_turn(turn: Self) -> Self {
        turn
    }

    fn drift_factor(span: Span) -> FxFactor {
        // weight / 2π in units of 2^-128.
        let per_turn = match span.weight {
            Weight::Whole => 0x28be_60db_9391_054a_7f09_d5f4_7d4d_3770,
            Weight::YoshidaOuter => 0x370d_9a2c_8862_f00c_50b2_97e1_c987_8b32,
            Weight::YoshidaInner => 0x455c_d37d_7d34_dace_225b_59cf_15c1_def4,
        };
        span_factor(per_turn, 128, span)
    }

    #[inline]
    fn drifted(self, velocity: Fx, drift_factor: FxFactor, negative: bool) -> Self {
        let (mantissa, shift) = drift_factor.parts();
        // |velocity| < 2^26 rad/s, so the product is below 2^122; the span is below 2 s = 0.32 turns per rad/s, so the
        // shift is above 32. The cut to 64 bits takes whole turns away.
        let passed =
            shr_round(i128::from(velocity.to_bits()) * i128::from(mantissa), (shift - 32).unsigned_abs()) as u64;
        Self(if negative { self.0.wrapping_sub(passed) } else { self.0.wrapping_add(passed) })
    }

    fn turned(self, radians: FxAccumulator) -> Self {
        // 1/2π = mantissa · 2^-66; from units of 2^-96 rad to units of 2^-64 turns.
        const PER_TURN: u128 = 0xa2f9_836e_4e44_152a;
        let turns = mul_shift(radians.to_bits(), PER_TURN, 66 + 96 - 64).unwrap_or(0);
        Self(self.0.wrapping_add(turns as u64))
    }

    /// Sine and cosine in units of 2^-62.
    type Direction = (i64, i64);

    fn direction(self) -> (i64, i64) {
        trig::sin_cos_turn(self.0)
    }

    fn turn(direction: (i64, i64), v: Vec2) -> Option<Vec2<FxWide>> {
        let (x, y) = (i128::from(v.x.to_bits()), i128::from(v.y.to_bits()));
        let (sin, cos) = (i128::from(direction.0), i128::from(direction.1));
        // Each product is at most 2^63 · 2^62, their sum 2^126; from units of 2^-94 to units of 2^-64.
        let component = |sum: i128| {
            let bits = shr_round(sum, 30);
            (bits.unsigned_abs() < 1 << 95).then_some(FxWide::from_bits(bits))
        };
        Some(Vec2::new(component(x * cos - y * sin)?, component(x * sin + y * cos)?))
    }
}

impl Random {
    /// A random angle, each as likely as the others.
    pub fn angle(&mut self) -> Turn {
        Turn::from_bits(self.bits())
    }
}
