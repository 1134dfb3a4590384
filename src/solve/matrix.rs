//! Matrices of two rows, and their inverses.

use super::batch::{Batch, FACTOR_BITS};
use super::group::Group;
use super::number::bits_in;
use super::vectors::{Shift, long};
use crate::kernel::simd::{GROUP, Lanes};

/// The matrix of two rows.
#[derive(Clone, Copy)]
pub(super) struct Matrix {
    pub(super) k11: i64,
    pub(super) k12: i64,
    pub(super) k22: i64,
}

/// The largest ratio of element 12 to a diagonal one.
const RATIO: i64 = 4;

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

/// The matrix of the normal rows of contacts, in lanes.
///
/// A matrix K is divided by powers of two, K' = D·K·D with D = diag(2^-a, 2^-b), such that elements 11 and 22, the softness included, have
/// 28 to 30 bits: so determinants are exact in 62 bits, and neither row loses bits to a larger one.
struct Rows<L: Lanes> {
    /// Elements 11, 22 and 12 of the rigid matrix.
    k11: L::Wide,
    k22: L::Wide,
    k12: L::Narrow,
    /// The softness of both rows.
    soft: [L::Wide; 2],
    /// log2 of the units of elements 11 and 22: even.
    units: [L::Wide; 2],
}

/// The most bits of elements 11 and 22: of one that is twice as large, a bit more.
const ELEMENT_BITS: i64 = 30;

/// Writes the inverse matrices of contacts, with their shifts, compliance and the inverse of friction.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn set_matrices<L: Lanes>(lanes: L, batch: &Batch, group: &mut Group) {
    let fewest = batch.bits.iter().fold(i64::MAX, |fewest, &bits| fewest.min(bits));
    for at in (0..GROUP).step_by(L::WIDTH) {
        let softness = if fewest < FACTOR_BITS {
            soften::<L, true>(lanes, batch, group, at)
        } else {
            soften::<L, false>(lanes, batch, group, at)
        };
        let two = lanes.wide(&batch.two, at);
        let rows = Rows::new(lanes, batch, at, softness);
        rows.write_inverses(lanes, two, lanes.wide(&batch.bits, at), group, at);
        write_friction(lanes, batch, group, at);
    }
    (group.has_one_soft, group.has_ratios) = (false, false);
}

/// Writes the compliance of contacts. Returns the parts of both diagonal elements by softness.
#[cfg_attr(not(debug_assertions), inline(always))]
fn soften<L: Lanes, const UP: bool>(lanes: L, batch: &Batch, group: &mut Group, at: usize) -> [L::Wide; 2] {
    let [k11, k12, k22] = &batch.whole;
    let (k11, k12, k22) = (lanes.wide(k11, at), lanes.wide(k12, at), lanes.wide(k22, at));
    let two = lanes.wide(&batch.two, at);
    let k12 = lanes.if_negative(two, lanes.positive(k12), lanes.all(0));
    let compliance = lanes.low(lanes.wide(&batch.compliance, at));
    let first = lanes.rounded_oddly::<30>(long(lanes, compliance, lanes.add(k11, k12)));
    let second = lanes.rounded_oddly::<30>(long(lanes, compliance, lanes.add(k22, k12)));
    let bits = lanes.sub(lanes.wide(&batch.bits, at), lanes.all(FACTOR_BITS));
    let shift = Shift::<L>::new::<UP>(lanes, bits);
    let pair = (shift.quarter::<UP>(lanes, first), shift.quarter::<UP>(lanes, second));
    lanes.put_pair(&mut group.compliance, at, pair);
    [first, second]
}

impl<L: Lanes> Rows<L> {
    /// Two points close together make the matrix nearly singular. Its diagonal is raised by 2^-13, so that impulses of the two points stay
    /// bounded instead of cancelling each other with large values of opposite sign.
    ///
    /// Both rows of a body that can only turn, or only move, are multiples of each other: the determinant is nothing but the rounding of
    /// the elements, by one each, before the shift and after it. The rows are solved one by one, each for half of the body.
    ///
    /// A row may move the other one by many times as much as itself: so does the row of a point without a lever on a body that locks let
    /// move but little along the normal. Its element is raised so that it is by [`RATIO`] times: beside an open point, a row is solved alone
    /// by that ratio.
    ///
    /// With one point the second row does nothing: it gets the elements of the first, so that the determinant is positive.
    ///
    /// # Ranges
    /// Elements are below 2^56 and at least 2^4 in lanes with a contact: units are from 2^-26 to 2^28, and the sum of the diagonal below
    /// 2^59 when it is shifted.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn new(lanes: L, batch: &Batch, at: usize, softness: [L::Wide; 2]) -> Self {
        let [k11, k12, k22] = &batch.split;
        let two = lanes.wide(&batch.two, at);
        let (zero, k11) = (lanes.all(0), lanes.wide(k11, at));
        let k12 = lanes.if_negative(two, lanes.wide(k12, at), zero);
        let k22 = lanes.if_negative(two, lanes.wide(k22, at), k11);
        let softness_2 = lanes.if_negative(two, softness[1], softness[0]);
        let smallest = lanes.floored::<2>(lanes.add(lanes.magnitude(k12), lanes.all(RATIO - 1)));
        let unit_1 = even_unit(lanes, lanes.add(lanes.larger(k11, smallest), softness[0]));
        let unit_2 = even_unit(lanes, lanes.add(lanes.larger(k22, smallest), softness_2));
        let both = lanes.add(unit_1, unit_2);
        let (e11, e22) = (lowered(lanes, k11, unit_1), lowered(lanes, k22, unit_2));
        let e12 = lowered(lanes, k12, lanes.floored::<1>(both));
        let product = lanes.times(lanes.low(e11), lanes.low(e22));
        let determinant = lanes.sub(product, lanes.times(lanes.low(e12), lanes.low(e12)));
        let is_near = lanes.sub(determinant, lanes.floored::<6>(product));
        let is_near = lanes.if_negative(two, is_near, zero);
        let more_1 = lanes.if_negative(is_near, lanes.floored::<13>(e11), zero);
        let more_2 = lanes.if_negative(is_near, lanes.floored::<13>(e22), zero);
        let least_1 = lanes.larger(lanes.add(e11, more_1), lowered(lanes, smallest, unit_1));
        let least_2 = lanes.larger(lanes.add(e22, more_2), lowered(lanes, smallest, unit_2));
        let noise = lowered(lanes, lanes.raised_by(lanes.add(k11, k22), lanes.all(2)), both);
        let noise = lanes.add(noise, lanes.raised_by(lanes.add(e11, e22), lanes.all(1)));
        let is_multiple = lanes.if_negative(two, lanes.sub(determinant, lanes.add(noise, lanes.all(1))), zero);
        Self {
            k11: lanes.if_negative(is_multiple, lanes.add(e11, e11), least_1),
            k22: lanes.if_negative(is_multiple, lanes.add(e22, e22), least_2),
            k12: lanes.low(lanes.if_negative(is_multiple, zero, e12)),
            soft: [lowered(lanes, softness[0], unit_1), lowered(lanes, softness_2, unit_2)],
            units: [unit_1, unit_2],
        }
    }

    /// Elements 11 and 22 with no point soft, or with both.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn diagonal(&self, lanes: L, is_soft: bool) -> [L::Narrow; 2] {
        let [soft_1, soft_2] = self.soft;
        if is_soft {
            [lanes.low(lanes.add(self.k11, soft_1)), lanes.low(lanes.add(self.k22, soft_2))]
        } else {
            [lanes.low(self.k11), lanes.low(self.k22)]
        }
    }

    /// Writes the inverses with no point soft and with both, in a unit in which the largest element has 30 bits. The rigid ones have it:
    /// softness only makes them smaller. In the places of the others it leaves what [`make_one_soft`] and [`make_ratios`] read.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn write_inverses(&self, lanes: L, two: L::Wide, bits: L::Wide, group: &mut Group, at: usize) {
        let [unit_1, unit_2] = self.units;
        // One over the unit of the impulses, in units of the inverse matrix, is 2^(bits + 2).
        let unit = lanes.add(bits, lanes.all(2));
        let rigid = Adjugate::new(lanes, self.diagonal(lanes, false), self.k12);
        let finest = lanes.smaller(unit_1, unit_2);
        let first = lanes.floored_by(rigid.elements[0], lanes.sub(unit_1, finest));
        let second = lanes.floored_by(rigid.elements[1], lanes.sub(unit_2, finest));
        let top = lanes.sub(lanes.bit_length(lanes.larger(first, second)), lanes.add(rigid.exponent, finest));
        let inverse_shift = lanes.sub(lanes.sub(lanes.all(30), top), unit);
        let inverse_shift = lanes.smaller(lanes.positive(inverse_shift), lanes.all(62));
        lanes.store(&mut group.inverse_shift, at, inverse_shift);
        let shift = lanes.add(inverse_shift, unit);
        let units = [lanes.sub(unit_1, shift), lanes.sub(unit_2, shift)];
        let [none_11, none_12, none_22] = rigid.factors(lanes, units, two);
        let soft = Adjugate::new(lanes, self.diagonal(lanes, true), self.k12);
        let [both_11, both_12, both_22] = soft.factors(lanes, units, two);
        lanes.put_pair(&mut group.inverse[0], at, (none_11, none_22));
        lanes.put_pair(&mut group.inverse[1], at, (lanes.low(self.k11), lanes.low(self.k22)));
        lanes.put_pair(&mut group.inverse[2], at, (lanes.low(self.soft[0]), lanes.low(self.soft[1])));
        lanes.put_pair(&mut group.inverse[3], at, (both_11, both_22));
        lanes.put_pair(&mut group.inverse_12[0], at, (none_12, self.k12));
        lanes.put_pair(&mut group.inverse_12[1], at, (lanes.low(two), both_12));
        lanes.put_pair(&mut group.inverse_units, at, (lanes.low(units[0]), lanes.low(units[1])));
    }
}

/// Makes the ratios, from the values in the places of the inverses with one point soft: few groups have a contact of which a point pulls.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn make_ratios<L: Lanes>(lanes: L, group: &mut Group) {
    group.has_ratios = true;
    for at in (0..GROUP).step_by(L::WIDTH) {
        write_ratios(lanes, group, at);
    }
}

/// Writes element 12 over the diagonal ones in 2^-28, within ±[`RATIO`]: by one reciprocal of the product of both.
#[cfg_attr(not(debug_assertions), inline(always))]
fn write_ratios<L: Lanes>(lanes: L, group: &mut Group, at: usize) {
    let (k11, k22) = lanes.pair(&group.inverse[1], at);
    let (soft_1, soft_2) = lanes.pair(&group.inverse[2], at);
    let (_, k12) = lanes.pair(&group.inverse_12[0], at);
    let (unit_1, unit_2) = lanes.pair(&group.inverse_units, at);
    // From the unit of element 12 to the unit of element 11, as log2.
    let step = lanes.floored::<1>(lanes.times(lanes.minus(unit_2, unit_1), lanes.splat(1)));
    let (mut ratios_12, mut ratios_21) = ([lanes.splat(0); 2], [lanes.splat(0); 2]);
    for soft in 0..2 {
        let [k11, k22] = if soft == 1 { [lanes.plus(k11, soft_1), lanes.plus(k22, soft_2)] } else { [k11, k22] };
        let (reciprocal, exponent) = reciprocal_of(lanes, lanes.times(k11, k22));
        // 1/11 and 1/22 in 2^-(exponent − 30), below 2^31.
        let first = lanes.low(lanes.floored::<30>(lanes.times(k22, reciprocal)));
        let second = lanes.low(lanes.floored::<30>(lanes.times(k11, reciprocal)));
        let down = lanes.sub(exponent, lanes.all(58));
        ratios_12[soft] = ratio_of(lanes, lanes.times(k12, first), lanes.sub(down, step));
        ratios_21[soft] = ratio_of(lanes, lanes.times(k12, second), lanes.add(down, step));
    }
    lanes.put_pair(&mut group.ratio_12, at, (ratios_12[0], ratios_12[1]));
    lanes.put_pair(&mut group.ratio_21, at, (ratios_21[0], ratios_21[1]));
}

/// Makes the inverses with one point soft, from the values in their places: few groups have a contact of which one point alone is pressed.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn make_one_soft<L: Lanes>(lanes: L, group: &mut Group) {
    if !group.has_ratios {
        make_ratios(lanes, group);
    }
    group.has_one_soft = true;
    for at in (0..GROUP).step_by(L::WIDTH) {
        let (k11, k22) = lanes.pair(&group.inverse[1], at);
        let (soft_1, soft_2) = lanes.pair(&group.inverse[2], at);
        let ((none_12, k12), (two, both_12)) =
            (lanes.pair(&group.inverse_12[0], at), lanes.pair(&group.inverse_12[1], at));
        let (unit_1, unit_2) = lanes.pair(&group.inverse_units, at);
        // Words as long as two.
        let unity = lanes.splat(1);
        let units = [lanes.times(unit_1, unity), lanes.times(unit_2, unity)];
        let two = lanes.times(two, unity);
        let first = Adjugate::new(lanes, [lanes.plus(k11, soft_1), k22], k12);
        let [first_11, first_12, first_22] = first.factors(lanes, units, two);
        let second = Adjugate::new(lanes, [k11, lanes.plus(k22, soft_2)], k12);
        let [second_11, second_12, second_22] = second.factors(lanes, units, two);
        lanes.put_pair(&mut group.inverse[1], at, (first_11, first_22));
        lanes.put_pair(&mut group.inverse[2], at, (second_11, second_22));
        lanes.put_pair(&mut group.inverse_12[0], at, (none_12, first_12));
        lanes.put_pair(&mut group.inverse_12[1], at, (second_12, both_12));
    }
}

/// An inverse before it is brought to a unit: elements 11, 22 and 12 in 2^-exponent, over the units of their rows.
struct Adjugate<L: Lanes> {
    elements: [L::Wide; 3],
    exponent: L::Wide,
}

impl<L: Lanes> Adjugate<L> {
    /// The inverse of the matrix with elements 11 and 22, below 2^31, and 12. Its elements are products of these with a reciprocal below 2^30.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn new(lanes: L, [k11, k22]: [L::Narrow; 2], k12: L::Narrow) -> Self {
        let determinant = lanes.sub(lanes.times(k11, k22), lanes.times(k12, k12));
        let (reciprocal, exponent) = reciprocal_of(lanes, determinant);
        let e12 = lanes.sub(lanes.all(0), lanes.times(k12, reciprocal));
        Self { elements: [lanes.times(k22, reciprocal), lanes.times(k11, reciprocal), e12], exponent }
    }

    /// Elements 11, 12 and 22 as factors, for these units of the rows as log2. With one point element 22 is zero.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn factors(&self, lanes: L, [unit_1, unit_2]: [L::Wide; 2], two: L::Wide) -> [L::Narrow; 3] {
        let [e11, e22, e12] = self.elements;
        let e22 = lanes.if_negative(two, factor_of(lanes, e22, lanes.add(self.exponent, unit_2)), lanes.all(0));
        let both = lanes.floored::<1>(lanes.add(unit_1, unit_2));
        [
            lanes.low(factor_of(lanes, e11, lanes.add(self.exponent, unit_1))),
            lanes.low(factor_of(lanes, e12, lanes.add(self.exponent, both))),
            lanes.low(e22),
        ]
    }
}

/// log2 of the unit, the square of a power of two, in which a value has [`ELEMENT_BITS`], or one less.
#[inline(always)]
fn even_unit<L: Lanes>(lanes: L, value: L::Wide) -> L::Wide {
    let bits = lanes.sub(lanes.bit_length(value), lanes.all(ELEMENT_BITS - 1));
    lanes.raised_by(lanes.floored::<1>(bits), lanes.all(1))
}

/// value · 2^-bits, down where they are positive and up where they are negative. *Domain* −64 < bits < 64, and the result fits.
#[inline(always)]
fn lowered<L: Lanes>(lanes: L, value: L::Wide, bits: L::Wide) -> L::Wide {
    let up = lanes.positive(lanes.sub(lanes.all(0), bits));
    lanes.floored_by(lanes.raised_by(value, up), lanes.positive(bits))
}

/// 1/value in 2^-exponent, below 2^30, and the exponent; of one, where the value is not positive. *Error* 2^-28. *Domain* value < 2^62.
#[inline(always)]
fn reciprocal_of<L: Lanes>(lanes: L, value: L::Wide) -> (L::Narrow, L::Wide) {
    let value = lanes.larger(value, lanes.all(1));
    let bits = lanes.bit_length(value);
    // Its top 31 bits: the value is d · 2^(bits − 31).
    let d = lanes.floored::<32>(lanes.raised_by(value, lanes.sub(lanes.all(63), bits)));
    (lanes.reciprocal(lanes.low(d)), lanes.add(bits, lanes.all(29)))
}

/// value · 2^-bits, rounded down, within the range of a factor.
#[inline(always)]
fn factor_of<L: Lanes>(lanes: L, value: L::Wide, bits: L::Wide) -> L::Wide {
    // A value that would be shifted up is beyond the range as it is.
    let bits = lanes.smaller(lanes.positive(bits), lanes.all(62));
    lanes.clamped(lanes.floored_by(value, bits), lanes.all(i32::MAX.into()))
}

/// value · 2^-bits, rounded towards zero, within ±[`RATIO`] in 2^-28.
#[inline(always)]
fn ratio_of<L: Lanes>(lanes: L, value: L::Wide, bits: L::Wide) -> L::Narrow {
    let bits = lanes.smaller(lanes.positive(bits), lanes.all(62));
    let size = lanes.floored_by(lanes.magnitude(value), bits);
    let size = lanes.smaller(size, lanes.all(RATIO << 28));
    lanes.low(lanes.if_negative(value, lanes.sub(lanes.all(0), size), size))
}

/// Writes the inverse of the friction row in 2^-(27 + bits + 2), for the velocity along the tangent by an impulse along it.
#[cfg_attr(not(debug_assertions), inline(always))]
fn write_friction<L: Lanes>(lanes: L, batch: &Batch, group: &mut Group, at: usize) {
    let tangent = lanes.wide(&batch.tangent[1], at);
    let (reciprocal, exponent) = reciprocal_of(lanes, tangent);
    // With 30 bits more below it, as it may be shifted up.
    let raised = lanes.times(reciprocal, lanes.splat(1 << 30));
    let down = lanes.sub(lanes.add(exponent, lanes.all(1)), lanes.wide(&batch.bits, at));
    let inverse = factor_of(lanes, raised, down);
    let inverse = lanes.if_negative(lanes.sub(lanes.all(0), tangent), inverse, lanes.all(0));
    let (_, mu) = lanes.pair(&group.friction, at);
    lanes.put_pair(&mut group.friction, at, (lanes.low(inverse), mu));
}
