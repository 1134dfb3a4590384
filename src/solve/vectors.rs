//! Operations on vectors, composed of the operations of [`Lanes`].

use super::batch::ONE;
use crate::kernel::simd::{GROUP, Lanes};

/// a·b / 2^30 to nearest, ties away from zero.
#[inline(always)]
pub(super) fn product<L: Lanes>(lanes: L, a: L::Narrow, b: L::Narrow) -> L::Wide {
    lanes.rounded_oddly::<30>(lanes.times(a, b))
}

/// a·b, exact. *Domain* |b| < 2^62, and the product fits.
#[inline(always)]
pub(super) fn long<L: Lanes>(lanes: L, a: L::Narrow, b: L::Wide) -> L::Wide {
    let bits = lanes.all(31);
    let high = lanes.floored::<31>(b);
    let low = lanes.sub(b, lanes.raised_by(high, bits));
    lanes.add(lanes.times(a, lanes.low(low)), lanes.raised_by(lanes.times(a, lanes.low(high)), bits))
}

/// The cross product of an arm and a direction, both in 2^-30, within ±1.
#[inline(always)]
pub(super) fn across<L: Lanes>(lanes: L, arm: (L::Narrow, L::Narrow), direction: (L::Narrow, L::Narrow)) -> L::Narrow {
    let cross = lanes.sub(lanes.times(arm.0, direction.1), lanes.times(arm.1, direction.0));
    lanes.low(lanes.clamped(lanes.rounded_oddly::<30>(cross), lanes.all(ONE)))
}

/// A shift by the bits of each lane, down where they are positive and up where they are negative.
pub(super) struct Shift<L: Lanes> {
    up: L::Wide,
    down: L::Wide,
    /// One half of the unit, and as much less by one; zero without a shift.
    half: L::Wide,
    less: L::Wide,
}

impl<L: Lanes> Shift<L> {
    /// *Domain* −64 < bits < 63; not negative without `UP`.
    #[inline(always)]
    pub(super) fn new<const UP: bool>(lanes: L, bits: L::Wide) -> Self {
        let (up, down) =
            if UP { (lanes.positive(lanes.sub(lanes.all(0), bits)), lanes.positive(bits)) } else { (bits, bits) };
        let half = lanes.floored::<1>(lanes.raised_by(lanes.all(1), down));
        Self { up, down, half, less: lanes.positive(lanes.sub(half, lanes.all(1))) }
    }

    /// value · 2^-bits to nearest, ties away from zero. *Domain* the result, and the sum of the value and one half of its unit, fit.
    #[inline(always)]
    pub(super) fn rounded<const UP: bool>(&self, lanes: L, value: L::Wide) -> L::Wide {
        let value = if UP { lanes.raised_by(value, self.up) } else { value };
        lanes.floored_by(lanes.add(value, lanes.if_negative(value, self.less, self.half)), self.down)
    }

    /// [`rounded`](Self::rounded) words that fit in 32 bits then.
    #[inline(always)]
    pub(super) fn words<const UP: bool>(&self, lanes: L, words: &[i64; GROUP], at: usize) -> L::Narrow {
        lanes.low(self.rounded::<UP>(lanes, lanes.wide(words, at)))
    }

    /// [`rounded`](Self::rounded) within ±[`ONE`].
    #[inline(always)]
    pub(super) fn arm<const UP: bool>(&self, lanes: L, value: L::Wide) -> L::Wide {
        lanes.clamped(self.rounded::<UP>(lanes, value), lanes.all(ONE))
    }

    /// [`factor`](Self::factor) within a quarter.
    #[inline(always)]
    pub(super) fn quarter<const UP: bool>(&self, lanes: L, value: L::Wide) -> L::Narrow {
        lanes.low(lanes.clamped(self.factor::<UP>(lanes, value), lanes.all(ONE >> 2)))
    }

    /// value · 2^-bits to nearest, ties away from zero, within the range of a factor.
    #[inline(always)]
    fn factor<const UP: bool>(&self, lanes: L, value: L::Wide) -> L::Wide {
        let cut = if UP {
            // A value that is shifted up beyond 2^31 saturates.
            let is_up = lanes.sub(lanes.all(0), self.up);
            lanes.if_negative(is_up, lanes.clamped(value, lanes.all(1 << 31)), value)
        } else {
            value
        };
        lanes.clamped(self.rounded::<UP>(lanes, cut), lanes.all(i32::MAX.into()))
    }
}
