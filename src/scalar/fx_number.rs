//! `Fx` as a scalar of the engine.

use super::accumulator::FxAccumulator;
use super::factor::FxFactor;
use super::number::{Arithmetic, Number, Scalar};
use super::turn::Turn;
use super::wide::{FxSum, FxWide};
use crate::fx::Fx;
use crate::kernel::wide::{magnitude, mul_shift, with_sign};

impl Number for Fx {
    const WORDS: usize = 1;

    fn to_words(self) -> [u64; 3] {
        [self.to_bits() as u64, 0, 0]
    }
}

impl Scalar for Fx {
    type Accumulator = FxAccumulator;
    type Factor = FxFactor;
    type Angle = Turn;
    type Wide = FxWide;
    type Sum = FxSum;

    const ZERO: Self = Self::ZERO;
    const ONE: Self = Self::ONE;
    const NAME: &'static str = "fx";

    #[inline]
    fn from_fx(value: Fx) -> Self {
        value
    }

    #[inline]
    fn to_fx(self) -> Fx {
        self
    }

    #[inline]
    fn to_bits(self) -> i64 {
        Self::to_bits(self)
    }

    #[inline]
    fn is_finite(self) -> bool {
        true
    }
}

impl Arithmetic<Fx> for Fx {
    fn sin_cos(self) -> (Self, Self) {
        Self::sin_cos(self)
    }

    #[inline]
    fn product(self, rhs: Self) -> FxWide {
        self.wide_mul(rhs)
    }

    #[inline]
    fn offset(self, rhs: Self) -> FxWide {
        // Below 2^64 ulps.
        FxWide::from_bits((i128::from(self.to_bits()) - i128::from(rhs.to_bits())) << 32)
    }

    #[inline]
    fn torque(arm: FxWide, force: FxWide) -> Option<FxWide> {
        let torque = mul_shift(arm.to_bits(), magnitude(force.to_bits()), 64)?;
        Some(FxWide::from_bits(with_sign(torque, force.to_bits())))
    }

    #[inline]
    fn times(self, rhs: Self) -> Option<Self> {
        self.checked_mul(rhs)
    }
}

impl Fx {
    /// The product as an [`FxWide`], exactly.
    ///
    /// ```
    /// # use umbra_physics::{Fx, fx};
    /// let square = Fx::MAX.wide_mul(fx!(2));
    /// assert_eq!((square.to_scalar(), format!("{square:.0}")), (None, "4294967296".into()));
    /// ```
    #[inline]
    #[must_use]
    pub const fn wide_mul(self, rhs: Self) -> FxWide {
        // At most 2^63 · 2^63.
        FxWide::from_bits(self.to_bits() as i128 * rhs.to_bits() as i128)
    }
}
