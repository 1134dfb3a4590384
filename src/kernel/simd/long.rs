//! Products of wide lanes, which have up to 126 bits: of limbs of 28 to 32 bits, as CPUs multiply lanes of 32 bits only.
//!
//! A limb that stands above others has their sign, and is narrow: values are below 2^62.

use super::{GROUP, Lanes};

/// A sum of narrow factors times wide values: high · 2^30 + low.
struct Dot<L: Lanes> {
    high: L::Wide,
    /// From 0 to 2^30 − 1.
    low: L::Wide,
}

impl<L: Lanes> Dot<L> {
    /// base · 2^30 + Σ factor · value. *Domain* the base and the values over 2^30 are below 2^31, factors at most 2^31, and two products with 2^30
    /// below 2^63.
    #[inline(always)]
    fn new(lanes: L, base: L::Wide, [k, l]: [L::Narrow; 2], [v, w]: [L::Wide; 2]) -> Self {
        let (v_high, w_high) = (lanes.narrowed::<30>(v), lanes.narrowed::<30>(w));
        let (v_low, w_low) = (lanes.low(lanes.rest::<30>(v)), lanes.low(lanes.rest::<30>(w)));
        let high = lanes.add(base, lanes.add(lanes.times(k, v_high), lanes.times(l, w_high)));
        let low = lanes.add(lanes.times(k, v_low), lanes.times(l, w_low));
        Self { high: lanes.add(high, lanes.floored::<30>(low)), low: lanes.rest::<30>(low) }
    }

    /// The sum over 2^bits to nearest, ties away from zero. *Domain* 0 ≤ bits ≤ 30, and the result fits.
    #[inline(always)]
    fn lowered_by(&self, lanes: L, bits: L::Wide) -> L::Wide {
        let half = lanes.floored::<1>(lanes.raised_by(lanes.all(1), bits));
        let less = lanes.positive(lanes.sub(half, lanes.all(1)));
        let low = lanes.floored_by(lanes.add(self.low, lanes.if_negative(self.high, less, half)), bits);
        lanes.add(lanes.raised_by(self.high, lanes.sub(lanes.all(30), bits)), low)
    }
}

/// [`Lanes::lowered_dot`]
#[inline(always)]
pub(super) fn lowered_dot<L: Lanes>(lanes: L, factors: [L::Narrow; 2], values: [L::Wide; 2]) -> L::Wide {
    Dot::new(lanes, lanes.all(0), factors, values).lowered_by(lanes, lanes.all(20))
}

/// [`Lanes::lowered_way`]
#[inline(always)]
pub(super) fn lowered_way<L: Lanes>(lanes: L, base: L::Wide, factors: [L::Narrow; 2], values: [L::Wide; 2]) -> L::Wide {
    let Dot { high, low } = Dot::new(lanes, base, factors, values);
    // Of the lower limb nothing is left but the loan of a negative number.
    let loan = lanes.if_negative(high, lanes.all((1 << 30) - 1), lanes.all(1 << 30));
    let low = lanes.floored::<30>(lanes.add(low, loan));
    lanes.floored::<4>(lanes.add(high, lanes.add(low, lanes.all(7))))
}

/// [`Lanes::dot_within`]
#[inline(always)]
pub(super) fn dot_within<L: Lanes>(
    lanes: L,
    factors: [L::Narrow; 2],
    values: [L::Wide; 2],
    bits: L::Wide,
    limit_bits: i64,
) -> L::Wide {
    let Dot { high, low } = Dot::new(lanes, lanes.all(0), factors, values);
    // Twice the limit is as good as more.
    let largest = lanes.raised_by(lanes.all(1 << (limit_bits - 29)), bits);
    let dot = Dot::<L> { high: lanes.clamped(high, largest), low };
    lanes.clamped(dot.lowered_by(lanes, bits), lanes.all(1 << limit_bits))
}

/// [`Lanes::multiples`]
#[inline(always)]
pub(super) fn multiples<L: Lanes>(lanes: L, [v, w]: [L::Wide; 2], factor: i64) -> [L::Wide; 2] {
    let low = lanes.splat((factor & 0x7fff_ffff) as i32);
    let [first, second] = [narrow_multiple(lanes, v, low), narrow_multiple(lanes, w, low)];
    if factor >> 31 == 0 {
        // Most factors are below two.
        return [first, second];
    }
    let high = lanes.splat((factor >> 31) as i32);
    [lanes.add(first, twice_product(lanes, v, high)), lanes.add(second, twice_product(lanes, w, high))]
}

/// value · factor / 2^30 to nearest, ties away from zero. *Domain* 0 ≤ factor < 2^31.
#[inline(always)]
fn narrow_multiple<L: Lanes>(lanes: L, value: L::Wide, factor: L::Narrow) -> L::Wide {
    let (high, low) = (lanes.narrowed::<30>(value), lanes.low(lanes.rest::<30>(value)));
    let half = lanes.if_negative(value, lanes.all((1 << 29) - 1), lanes.all(1 << 29));
    lanes.add(lanes.times(high, factor), lanes.floored::<30>(lanes.add(lanes.times(low, factor), half)))
}

/// 2 · value · factor. *Domain* it fits.
#[inline(always)]
fn twice_product<L: Lanes>(lanes: L, value: L::Wide, factor: L::Narrow) -> L::Wide {
    let (high, low) = (lanes.narrowed::<30>(value), lanes.low(lanes.rest::<30>(value)));
    let high = lanes.raised_by(lanes.times(high, factor), lanes.all(31));
    let low = lanes.times(low, factor);
    lanes.add(high, lanes.add(low, low))
}

/// A product in limbs: high · 2^60 + (middle − 1) · 2^28, and what is below that does not matter to a rounded number.
struct Product<L: Lanes> {
    high: L::Wide,
    middle: L::Wide,
}

impl<L: Lanes> Product<L> {
    /// a·b. *Domain* 0 ≤ a ≤ 2^57, |b| ≤ 2^62.
    #[inline(always)]
    fn new(lanes: L, a: L::Wide, b: L::Wide) -> Self {
        let (a_high, a_low) = (lanes.narrowed::<28>(a), lanes.low(lanes.rest::<28>(a)));
        let (b_high, b_low) = (lanes.narrowed::<32>(b), lanes.low(b));
        // Below 2^62 + 2^61.
        let raised = lanes.raised_by(lanes.times(a_low, b_high), lanes.all(4));
        let middle = lanes.add(raised, lanes.times_unsigned(a_high, b_low));
        let low = lanes.times_unsigned(a_low, b_low);
        // Of the lowest limb nothing is left but its carry, or the loan of a negative number: both less by one.
        let loan = lanes.if_negative(b, lanes.all((1 << 28) - 1), lanes.all(1 << 28));
        let carry = lanes.floored::<28>(lanes.add(low, loan));
        Self { high: lanes.times(a_high, b_high), middle: lanes.add(middle, carry) }
    }
}

/// [`Lanes::upper_word`]
#[inline(always)]
pub(super) fn upper_word<L: Lanes>(lanes: L, a: L::Wide, b: L::Wide) -> L::Wide {
    let Product { high, middle } = Product::new(lanes, a, b);
    let middle = lanes.floored::<32>(lanes.add(middle, lanes.all((1 << 35) - 1)));
    lanes.floored::<4>(lanes.add(high, middle))
}

/// [`Lanes::lowered_product`]
#[inline(always)]
pub(super) fn lowered_product<L: Lanes>(lanes: L, a: L::Wide, b: L::Wide) -> L::Wide {
    let Product { high, middle } = Product::new(lanes, a, b);
    let middle = lanes.floored::<10>(lanes.add(middle, lanes.all((1 << 9) - 1)));
    lanes.add(lanes.raised_by(high, lanes.all(22)), middle)
}

/// [`Lanes::dot`]
#[inline(always)]
pub(super) fn dot<L: Lanes>(lanes: L, factors: [L::Narrow; 2], values: [L::Wide; 2]) -> [L::Wide; 2] {
    let Dot { high, low } = Dot::new(lanes, lanes.all(0), factors, values);
    [high, low]
}

/// [`Lanes::lowered_limbs`]
#[inline(always)]
pub(super) fn lowered_limbs<L: Lanes>(lanes: L, [high, low]: [L::Wide; 2]) -> L::Wide {
    let dot = Dot::<L> { high: lanes.add(high, lanes.floored::<30>(low)), low: lanes.rest::<30>(low) };
    dot.lowered_by(lanes, lanes.all(20))
}

/// [`Lanes::add_products`]
#[inline(always)]
pub(super) fn add_products<L: Lanes>(
    lanes: L,
    sums: &mut [L::Wide; 3],
    [v, w]: [L::Wide; 2],
    [x, y]: [L::Wide; 2],
    down: L::Wide,
) {
    let (v_high, w_high) = (lanes.narrowed::<30>(v), lanes.narrowed::<30>(w));
    let (v_low, w_low) = (lanes.low(lanes.rest::<30>(v)), lanes.low(lanes.rest::<30>(w)));
    let (x_high, y_high) = (lanes.narrowed::<30>(x), lanes.narrowed::<30>(y));
    let (x_low, y_low) = (lanes.low(lanes.rest::<30>(x)), lanes.low(lanes.rest::<30>(y)));
    let high = lanes.add(lanes.times(v_high, x_high), lanes.times(w_high, y_high));
    let first = lanes.add(lanes.times(v_high, x_low), lanes.times(v_low, x_high));
    let second = lanes.add(lanes.times(w_high, y_low), lanes.times(w_low, y_high));
    let low = lanes.add(lanes.times(v_low, x_low), lanes.times(w_low, y_low));
    // In 2^30: below 2^60.
    let middle = lanes.add(lanes.add(first, second), lanes.floored::<30>(low));
    let mut high = lanes.add(lanes.raised_by(high, lanes.all(30)), middle);
    let mut low = lanes.rest::<30>(low);
    if !lanes.is_zero(down) {
        let bits = lanes.smaller(down, lanes.all(30));
        // A shift by more than 30 bits leaves nothing of the lower limb: the rest of it comes first.
        let far = lanes.floored_by(high, lanes.smaller(lanes.sub(down, bits), lanes.all(63)));
        high = lanes.floored_by(far, bits);
        let rest = lanes.sub(far, lanes.raised_by(high, bits));
        low = lanes.floored_by(lanes.add(lanes.raised_by(rest, lanes.all(30)), low), bits);
    }
    sums[0] = lanes.add(sums[0], lanes.floored::<30>(high));
    sums[1] = lanes.add(sums[1], lanes.rest::<30>(high));
    sums[2] = lanes.add(sums[2], low);
}

/// [`Lanes::total`]
#[inline(always)]
pub(super) fn total<L: Lanes>(lanes: L, sums: [L::Wide; 3]) -> i128 {
    let mut total = 0;
    for limb in sums {
        let mut words = [0; GROUP];
        lanes.store(&mut words, 0, limb);
        total = (total << 30) + words.iter().map(|&word| i128::from(word)).sum::<i128>();
    }
    total
}
