//! Matrices of two rows, and their inverses.

use super::batch::{Batch, FACTOR_BITS, Words};
use super::group::Group;
use super::number::{bits_in, bits_of, clamped_word, shifted_word};
use super::vectors::{Shift, larger, long, magnitude, word};
use crate::kernel::simd::{GROUP, Lanes};

/// The matrix of two rows.
#[derive(Clone, Copy)]
pub(super) struct Matrix {
    pub(super) k11: i64,
    pub(super) k12: i64,
    pub(super) k22: i64,
}

/// value · 2^-bits within the range of a factor.
#[inline(always)]
fn factor(value: i64, bits: i32) -> i32 {
    let limit = i64::from(i32::MAX);
    if bits < 0 && bits_of(value) - bits > 31 {
        return clamped_word(value.signum() * limit, limit);
    }
    clamped_word(shifted_word(value, bits), limit)
}

/// The largest ratio of element 12 to a diagonal one.
const RATIO: i64 = 4;

/// Element 12 over a diagonal one in 2^-28, within ±[`RATIO`].
pub(super) fn ratio(k12: i64, diagonal: i64) -> i32 {
    let bits = (bits_in(diagonal) - 31).max(0);
    let (k12, diagonal) = (k12 >> bits, diagonal >> bits);
    if diagonal == 0 {
        return 0;
    }
    // The diagonal is below 2^31, the numerator below 2^33: their quotient in 2^-28 is below 2^30. It is rounded towards zero.
    let quotient = ((k12.abs().min(RATIO * diagonal) << 28) as u64 / diagonal as u64) as i32;
    if k12 < 0 { -quotient } else { quotient }
}

/// Elements 11, 22 and 12 of an inverse, in 2^-exponent.
pub(super) struct Inverse {
    pub(super) elements: [i64; 3],
    pub(super) exponent: i32,
}

/// The reciprocal of a determinant: 30 or 31 bits of it, and the number of bits that the determinant has above 33; zeros if it is
/// not positive.
#[inline(always)]
fn reciprocal(determinant: i128) -> (i64, i32) {
    if determinant <= 0 {
        return (0, 0);
    }
    // The top 33 bits: most often the upper word has the first of them.
    let (high, low) = ((determinant >> 64) as u64, determinant as u64);
    let zeros = if high == 0 { low.leading_zeros() } else { high.leading_zeros() };
    let (top, bits) = if high == 0 { (low << zeros, 31) } else { (high << zeros | low >> 1 >> (63 - zeros), 95) };
    let kept = top >> 31;
    (((1 << 63) / kept) as i64, bits - zeros as i32)
}

impl Inverse {
    /// The inverse of a matrix. *Error* 2^-29 of the largest element. *Domain* elements below 2^60.
    pub(super) fn of(k: Matrix) -> Self {
        let determinant = i128::from(k.k11) * i128::from(k.k22) - i128::from(k.k12) * i128::from(k.k12);
        let (reciprocal, bits) = reciprocal(determinant);
        if reciprocal == 0 {
            return Self { elements: [0; 3], exponent: 0 };
        }
        let down = (bits_in(k.k11.max(k.k22)) - 31).max(0);
        // The numerators have 31 bits.
        let element = |value: i64| ((value >> down) * reciprocal) >> 31;
        Self { elements: [element(k.k22), element(k.k11), -element(k.k12)], exponent: 32 + bits - down }
    }
}

/// The matrices of the contacts of a group.
#[derive(Clone, Debug, Default)]
pub(super) struct Matrices {
    /// Element 11, rigid and soft.
    first: [Words; 2],
    /// Element 22 with no point soft, the first, the second, both.
    second: [Words; 4],
    /// Reciprocals of the four determinants, less by one: negative if there is none.
    less: [Words; 4],
    /// Shifts of the numerators; then of the inverses.
    down: [Words; 4],
    /// Elements 11, 22 and 12 of the inverses, in 2^-exponent, and the largest ones.
    elements: [[Words; 3]; 4],
    exponents: [Words; 4],
    largest: [Words; 4],
}

impl Matrices {
    /// Writes the inverse matrices of a group, with their shifts, ratios and compliance.
    #[inline(always)]
    pub(super) fn set<L: Lanes>(&mut self, lanes: L, batch: &mut Batch, group: &mut Group) {
        self.stiffen(batch);
        let is_up = batch.bits.iter().any(|&bits| bits < FACTOR_BITS);
        for at in (0..GROUP).step_by(L::WIDTH) {
            if is_up {
                self.soften::<L, true>(lanes, batch, group, at);
            } else {
                self.soften::<L, false>(lanes, batch, group, at);
            }
        }
        self.divide(batch, group);
        for at in (0..GROUP).step_by(L::WIDTH) {
            self.invert(lanes, batch, at);
        }
        let is_up = self.choose_shifts(batch, group);
        for at in (0..GROUP).step_by(L::WIDTH) {
            if is_up {
                self.write::<L, true>(lanes, group, at);
            } else {
                self.write::<L, false>(lanes, group, at);
            }
        }
    }

    /// Two points close together make the matrix nearly singular. Its diagonal is raised by 2^-13, so that impulses of the two points stay
    /// bounded instead of cancelling each other with large values of opposite sign.
    ///
    /// Both rows of a body that can only turn, or only move, are multiples of each other: the determinant is nothing but the rounding of
    /// the elements, by one each. The rows are solved one by one, each for half of the body.
    ///
    /// A row may move the other one by many times as much as itself: so does the row of a point without a lever on a body that locks let
    /// move but little along the normal. Its element is raised so that it is by [`RATIO`] times: beside an open point, a row is solved alone
    /// by that ratio.
    #[inline(always)]
    fn stiffen(&mut self, batch: &mut Batch) {
        for lane in 0..GROUP {
            let [k11, k12, k22] = [0, 1, 2].map(|i| batch.split[i][lane]);
            let product = i128::from(k11) * i128::from(k22);
            let determinant = product - i128::from(k12) * i128::from(k12);
            let more = if determinant < product >> 6 { batch.two[lane] } else { 0 };
            let smallest_diagonal = ((k12.abs() & batch.two[lane]) + RATIO - 1) / RATIO;
            self.first[0][lane] = (k11 + ((k11 >> 13) & more)).max(smallest_diagonal);
            self.second[0][lane] = (k22 + ((k22 >> 13) & more)).max(smallest_diagonal);
            if batch.two[lane] != 0 && determinant <= 4 * (i128::from(k11) + i128::from(k22)) {
                (self.first[0][lane], self.second[0][lane]) = (2 * k11, 2 * k22);
                batch.split[1][lane] = 0;
            }
        }
    }

    /// Adds the softness to the diagonal, and writes it.
    #[inline(always)]
    fn soften<L: Lanes, const UP: bool>(&mut self, lanes: L, batch: &Batch, group: &mut Group, at: usize) {
        let [k11, k12, k22] = &batch.whole;
        let (k11, k12, k22) = (lanes.wide(k11, at), lanes.wide(k12, at), lanes.wide(k22, at));
        let two = lanes.wide(&batch.two, at);
        let k12 = lanes.if_negative(two, lanes.positive(k12), word(lanes, 0));
        let compliance = lanes.low(lanes.wide(&batch.compliance, at));
        let softness_1 = lanes.rounded_oddly::<30>(long(lanes, compliance, lanes.add(k11, k12)));
        let softness_2 = lanes.rounded_oddly::<30>(long(lanes, compliance, lanes.add(k22, k12)));
        let bits = lanes.sub(lanes.wide(&batch.bits, at), word(lanes, FACTOR_BITS));
        let shift = Shift::<L>::new::<UP>(lanes, bits);
        let pair = (shift.quarter::<UP>(lanes, softness_1), shift.quarter::<UP>(lanes, softness_2));
        lanes.put_pair(&mut group.compliance, at, pair);
        let (rigid_11, rigid_22) = (lanes.wide(&self.first[0], at), lanes.wide(&self.second[0], at));
        let (soft_11, soft_22) = (lanes.add(rigid_11, softness_1), lanes.add(rigid_22, softness_2));
        lanes.store(&mut self.first[1], at, soft_11);
        // With one point the second row does nothing: it gets the element of the first, so that the determinant is positive.
        let pairs = [(rigid_22, rigid_11), (rigid_22, soft_11), (soft_22, rigid_11), (soft_22, soft_11)];
        for (second, (k22, k11)) in self.second.iter_mut().zip(pairs) {
            lanes.store(second, at, lanes.if_negative(two, k22, k11));
        }
    }

    /// Finds the reciprocals of the determinants, and writes the ratios of elements.
    #[inline(always)]
    fn divide(&mut self, batch: &Batch, group: &mut Group) {
        for lane in 0..GROUP {
            let k12 = batch.split[1][lane] & batch.two[lane];
            let square = i128::from(k12) * i128::from(k12);
            for set in 0..4 {
                // Of one point both rows are the first, whether the second is soft or not.
                if set >= 2 && batch.two[lane] == 0 {
                    for words in [&mut self.less, &mut self.down, &mut self.exponents] {
                        words[set][lane] = words[set - 2][lane];
                    }
                    continue;
                }
                let (k11, k22) = (self.first[set & 1][lane], self.second[set][lane]);
                let (reciprocal, bits) = reciprocal(i128::from(k11) * i128::from(k22) - square);
                let down = (bits_in(k11.max(k22)) - 31).max(0);
                self.less[set][lane] = reciprocal - 1;
                self.down[set][lane] = down.into();
                // A matrix that has no inverse gets zeros.
                self.exponents[set][lane] = if reciprocal > 0 { 32 + bits - down } else { 0 }.into();
            }
            (group.ratio_12[lane], group.ratio_21[lane]) = ([0; 2], [0; 2]);
            if k12 != 0 {
                group.ratio_12[lane] = [ratio(k12, self.first[0][lane]), ratio(k12, self.first[1][lane])];
                group.ratio_21[lane] = [ratio(k12, self.second[0][lane]), ratio(k12, self.second[3][lane])];
            }
        }
    }

    /// Finds the inverses.
    #[inline(always)]
    fn invert<L: Lanes>(&mut self, lanes: L, batch: &Batch, at: usize) {
        let two = lanes.wide(&batch.two, at);
        let zero = word(lanes, 0);
        let k12 = lanes.if_negative(two, lanes.wide(&batch.split[1], at), zero);
        for set in 0..4 {
            let (k11, k22) = (lanes.wide(&self.first[set & 1], at), lanes.wide(&self.second[set], at));
            let less = lanes.wide(&self.less[set], at);
            let down = lanes.wide(&self.down[set], at);
            let e11 = element(lanes, k22, less, down);
            let e22 = lanes.if_negative(two, element(lanes, k11, less, down), zero);
            let e12 = lanes.sub(zero, element(lanes, k12, less, down));
            let largest = larger(lanes, larger(lanes, e11, e22), magnitude(lanes, e12));
            lanes.store(&mut self.largest[set], at, largest);
            for (words, element) in self.elements[set].iter_mut().zip([e11, e22, e12]) {
                lanes.store(words, at, element);
            }
        }
    }

    /// Chooses the units of the inverses. Returns true if one of them is shifted up to its unit.
    #[inline(always)]
    fn choose_shifts(&mut self, batch: &Batch, group: &mut Group) -> bool {
        let mut is_up = false;
        for lane in 0..GROUP {
            let log2 = |set: usize| i64::from(bits_in(self.largest[set][lane])) - self.exponents[set][lane];
            let top = log2(0).max(log2(1)).max(log2(2)).max(log2(3));
            // One over the unit of the impulses, in units of the inverse matrix, is 2^(bits + 2).
            let unit = batch.bits[lane] + 2;
            let shift = (30 - top - unit).clamp(0, 62);
            group.inverse_shift[lane] = shift;
            for set in 0..4 {
                // Elements are below 2^32, so that farther shifts make no difference.
                let down = (self.exponents[set][lane] - shift - unit).clamp(-31, 62);
                self.down[set][lane] = down;
                is_up |= down < 0;
            }
        }
        is_up
    }

    /// Writes the inverses in their units.
    #[inline(always)]
    fn write<L: Lanes, const UP: bool>(&self, lanes: L, group: &mut Group, at: usize) {
        let mut last = [lanes.splat(0); 4];
        for (set, last) in last.iter_mut().enumerate() {
            let shift = Shift::<L>::new::<UP>(lanes, lanes.wide(&self.down[set], at));
            let [e11, e22, e12] = &self.elements[set];
            let pair = (shift.saturated::<UP>(lanes, e11, at), shift.saturated::<UP>(lanes, e22, at));
            lanes.put_pair(&mut group.inverse[set], at, pair);
            *last = shift.saturated::<UP>(lanes, e12, at);
        }
        lanes.put_pair(&mut group.inverse_12[0], at, (last[0], last[1]));
        lanes.put_pair(&mut group.inverse_12[1], at, (last[2], last[3]));
    }
}

/// An element of the inverse: an element of the matrix, shifted down, times the reciprocal of the determinant, which is less by one.
#[inline(always)]
fn element<L: Lanes>(lanes: L, k: L::Wide, less: L::Wide, down: L::Wide) -> L::Wide {
    // A numerator below 2^31 times a reciprocal up to 2^31; zero if there is none.
    let k = lanes.if_negative(less, word(lanes, 0), lanes.floored_by(k, down));
    lanes.floored::<31>(lanes.add(lanes.times(lanes.low(k), lanes.low(less)), k))
}

/// The inverse of the friction row in 2^-(27 + bits + 2), for the velocity along the tangent by an impulse along it: below 2^60.
#[inline(always)]
pub(super) fn friction(tangent: i64, bits: i64) -> i32 {
    if tangent <= 0 {
        return 0;
    }
    // 1/tangent is the reciprocal of its top 33 bits times 2^-(30 + size). It is cut first, as an element of an inverse matrix is.
    let size = bits_in(tangent);
    let reciprocal = ((1 << 63) / ((tangent as u64) << (64 - size) >> 31)) as i64;
    let down = size.max(32) - 31;
    factor(reciprocal >> down, 30 + size - down - bits as i32 - 2 - 27)
}
