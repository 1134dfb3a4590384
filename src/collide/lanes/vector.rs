//! Operations on vectors and on corners of boxes, composed of the operations of [`Lanes`].

use crate::kernel::simd::Lanes;

pub(super) type Vector<L> = [<L as Lanes>::Wide; 2];

#[inline(always)]
pub(super) fn not<L: Lanes>(lanes: L, m: L::Mask) -> L::Mask {
    lanes.unless(lanes.equal(lanes.all(0), lanes.all(0)), m)
}

/// `a` where `m` says yes, else `b`.
#[inline(always)]
pub(super) fn choose<L: Lanes>(lanes: L, m: L::Mask, a: L::Mask, b: L::Mask) -> L::Mask {
    lanes.either(lanes.both(m, a), lanes.unless(b, m))
}

/// a·b. *Domain* both fit in 32 bits.
#[inline(always)]
pub(super) fn product<L: Lanes>(lanes: L, a: L::Wide, b: L::Wide) -> L::Wide {
    lanes.times(lanes.low(a), lanes.low(b))
}

#[inline(always)]
pub(super) fn dot<L: Lanes>(lanes: L, a: Vector<L>, b: Vector<L>) -> L::Wide {
    lanes.add(product(lanes, a[0], b[0]), product(lanes, a[1], b[1]))
}

#[inline(always)]
pub(super) fn cross<L: Lanes>(lanes: L, a: Vector<L>, b: Vector<L>) -> L::Wide {
    lanes.sub(product(lanes, a[0], b[1]), product(lanes, a[1], b[0]))
}

#[inline(always)]
pub(super) fn opposite<L: Lanes>(lanes: L, a: Vector<L>) -> Vector<L> {
    [lanes.sub(lanes.all(0), a[0]), lanes.sub(lanes.all(0), a[1])]
}

#[inline(always)]
pub(super) fn plus<L: Lanes>(lanes: L, a: Vector<L>, b: Vector<L>) -> Vector<L> {
    [lanes.add(a[0], b[0]), lanes.add(a[1], b[1])]
}

#[inline(always)]
pub(super) fn minus<L: Lanes>(lanes: L, a: Vector<L>, b: Vector<L>) -> Vector<L> {
    [lanes.sub(a[0], b[0]), lanes.sub(a[1], b[1])]
}

/// n·v to nearest ulps, for a vector in ulps: floor((n·v + 2^29) / 2^30).
#[inline(always)]
pub(super) fn height<L: Lanes>(lanes: L, n: Vector<L>, v: Vector<L>) -> L::Wide {
    let bits = lanes.all(31);
    let high = [lanes.floored::<31>(v[0]), lanes.floored::<31>(v[1])];
    let low = [lanes.sub(v[0], lanes.raised_by(high[0], bits)), lanes.sub(v[1], lanes.raised_by(high[1], bits))];
    let upper = dot(lanes, n, high);
    let lower = lanes.floored::<30>(lanes.add(dot(lanes, n, low), lanes.all(1 << 29)));
    lanes.add(lanes.add(upper, upper), lower)
}

#[inline(always)]
pub(super) fn select<L: Lanes>(lanes: L, m: L::Mask, a: Vector<L>, b: Vector<L>) -> Vector<L> {
    [lanes.select(m, a[0], b[0]), lanes.select(m, a[1], b[1])]
}

/// A corner by its number, 0 to 3.
pub(super) struct Corner<L: Lanes> {
    pub(super) is_odd: L::Mask,
    /// True for the last two corners, which are opposite to the first two.
    pub(super) is_opposite: L::Mask,
}

impl<L: Lanes> Clone for Corner<L> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}

impl<L: Lanes> Copy for Corner<L> {}

impl<L: Lanes> Corner<L> {
    /// The corner after this one, counter-clockwise.
    #[inline(always)]
    pub(super) fn next(self, lanes: L) -> Self {
        Self { is_odd: not(lanes, self.is_odd), is_opposite: lanes.unlike(self.is_opposite, self.is_odd) }
    }

    /// The corner before this one.
    #[inline(always)]
    pub(super) fn previous(self, lanes: L) -> Self {
        let is_even = not(lanes, self.is_odd);
        Self { is_odd: is_even, is_opposite: lanes.unlike(self.is_opposite, is_even) }
    }

    /// This corner where `m` says yes, else another one.
    #[inline(always)]
    pub(super) fn or(self, lanes: L, m: L::Mask, corner: Self) -> Self {
        Self {
            is_odd: choose(lanes, m, self.is_odd, corner.is_odd),
            is_opposite: choose(lanes, m, self.is_opposite, corner.is_opposite),
        }
    }

    /// The value at this corner, of the values at the first two.
    #[inline(always)]
    pub(super) fn of(self, lanes: L, halves: [L::Wide; 2]) -> L::Wide {
        lanes.negated(self.is_opposite, lanes.select(self.is_odd, halves[1], halves[0]))
    }

    /// The vector at this corner, of the vectors at the first two.
    #[inline(always)]
    pub(super) fn vector(self, lanes: L, [first, second]: [Vector<L>; 2]) -> Vector<L> {
        [self.of(lanes, [first[0], second[0]]), self.of(lanes, [first[1], second[1]])]
    }

    /// The number, 0 to 3.
    #[inline(always)]
    pub(super) fn number(self, lanes: L) -> L::Wide {
        let zero = lanes.all(0);
        let lower = lanes.select(self.is_odd, lanes.all(1), zero);
        lanes.add(lower, lanes.select(self.is_opposite, lanes.all(2), zero))
    }
}
