//! The rows of a contact in words, for impacts: velocities along them, and changes of bodies by impulses along them.

use super::super::group::Group;
use super::super::joint::Response;
use super::super::number::{bits_of, lowered, product, shifted, shifted_word};
use super::{COARSER, FINE, FRACTION};

/// Elements 11, 12, 22, 1t, 2t and tt of the matrix of a contact by one body, in 2^-30.
pub(super) type Elements = [i64; 6];

/// The two normal rows and the friction row of a contact: a copy of its lane of a group.
#[derive(Clone, Copy, Debug)]
pub(super) struct Jacobian {
    /// In 2^-30.
    normal: [i32; 2],
    /// By row, of both bodies, in 2^-30 of the bodies' lengths.
    arms: [[i32; 2]; 3],
    /// By body: changes of velocity by an impulse along the normal and along the tangent.
    linear: [[[i32; 2]; 2]; 2],
    /// By row: changes of angular velocity of both bodies, in units of 2^shift of the linear ones.
    angular: [[i32; 2]; 3],
    angular_shift: i64,
}

impl Jacobian {
    pub(super) fn of(group: &Group, lane: usize) -> Self {
        Self {
            normal: group.normal[lane],
            arms: [0, 1, 2].map(|row| group.arms[row][lane]),
            linear: [&group.linear_a, &group.linear_b].map(|linear| [linear[0][lane], linear[1][lane]]),
            angular: [0, 1, 2].map(|row| group.angular[row][lane]),
            angular_shift: group.angular_shift[lane],
        }
    }

    /// Velocities or displacements along the three rows, in the unit of the bodies': 2^-bits of it. Rounded to nearest, along the tangent oddly:
    /// normal rows are the same in a mirror image.
    ///
    /// # Ranges
    /// Components are below 2^61, factors at most 2^30: sums of four products are below 2^94, and results below 2^50 or, of coarse
    /// velocities, 2^58.
    #[inline(always)]
    pub(super) fn along(&self, a: [i64; 3], b: [i64; 3], bits: i32) -> [i64; 3] {
        let [first, second] = self.along_normal(a, b, bits, true);
        [first, second, self.along_tangent(a, b, bits)]
    }

    /// The normal rows of [`along`](Self::along). The second one is zero if it is not wanted.
    #[inline(always)]
    fn along_normal(&self, a: [i64; 3], b: [i64; 3], bits: i32, has_second: bool) -> [i64; 2] {
        let [nx, ny] = self.normal.map(i64::from);
        let normal = product(nx, b[0] - a[0]) + product(ny, b[1] - a[1]) + (1 << (29 + bits));
        let first = (normal + self.turned(0, a, b)) >> (30 + bits);
        let second = if has_second { (normal + self.turned(1, a, b)) >> (30 + bits) } else { 0 };
        [first as i64, second as i64]
    }

    /// The friction row of [`along`](Self::along).
    #[inline(always)]
    fn along_tangent(&self, a: [i64; 3], b: [i64; 3], bits: i32) -> i64 {
        let [nx, ny] = self.normal.map(i64::from);
        let tangent = product(ny, b[0] - a[0]) - product(nx, b[1] - a[1]);
        lowered(tangent + self.turned(2, a, b), 30 + bits) as i64
    }

    /// The part of angular velocities along a row.
    #[inline(always)]
    fn turned(&self, row: usize, a: [i64; 3], b: [i64; 3]) -> i128 {
        let [arm_a, arm_b] = self.arms[row].map(i64::from);
        product(arm_b, b[2]) - product(arm_a, a[2])
    }

    /// The normal rows of [`along`](Self::along) of velocities in 2^(coarse − [`FINE`]), in 2^-[`FRACTION`]. The second one is zero if it is
    /// not wanted.
    #[inline(always)]
    pub(super) fn normal_velocities(&self, a: [i64; 3], b: [i64; 3], coarse: i32, has_second: bool) -> [i64; 2] {
        // By constants: shifts of words twice as long by a number cost several times as much.
        if coarse == 0 {
            self.along_normal(a, b, FINE - FRACTION, has_second)
        } else {
            self.along_normal(a, b, FINE - FRACTION - COARSER, has_second)
        }
    }

    /// The friction row of [`along`](Self::along) of velocities in 2^(coarse − [`FINE`]), in 2^-[`FRACTION`].
    #[inline(always)]
    pub(super) fn slip(&self, a: [i64; 3], b: [i64; 3], coarse: i32) -> i64 {
        if coarse == 0 {
            self.along_tangent(a, b, FINE - FRACTION)
        } else {
            self.along_tangent(a, b, FINE - FRACTION - COARSER)
        }
    }

    /// The change of velocity of a body by impulses, in 2^(coarse − [`FINE`]), rounded oddly and within ±2^60 over its share.
    ///
    /// # Ranges
    /// Impulses are below 2^62, factors at most 2^28 and angular ones 2^28 with a shift of at most 36: sums are below 2^127.
    #[inline(always)]
    pub(super) fn gain(&self, side: usize, impulses: [i64; 3], share: i64, coarse: i32) -> [i64; 3] {
        let [[nx, ny], [tx, ty]] = self.linear[side].map(|factors| factors.map(i64::from));
        let [first, second, third] = self.angular.map(|factors| i64::from(factors[side]));
        let pressing = impulses[0] + impulses[1];
        let sizes = impulses[0].unsigned_abs() | impulses[1].unsigned_abs() | impulses[2].unsigned_abs();
        if sizes < 1 << 32 && coarse == 0 {
            // Sums of three products are below 2^62.
            let turned = first * impulses[0] + second * impulses[1] + third * impulses[2];
            let [x, y] = [nx * pressing + tx * impulses[2], ny * pressing + ty * impulses[2]];
            // Most are far within the limit: the logarithm of the share is rounded up.
            let bits = 60 - (64 - (share - 1).max(0).leading_zeros());
            let largest = x.unsigned_abs() | y.unsigned_abs() | turned.unsigned_abs();
            if largest >> bits.saturating_sub(self.angular_shift as u32) == 0 {
                return [x, y, turned << self.angular_shift];
            }
            return [
                limited_word(x, share),
                limited_word(y, share),
                limited(i128::from(turned) << self.angular_shift, share),
            ];
        }
        let turned = product(first, impulses[0]) + product(second, impulses[1]) + product(third, impulses[2]);
        let changes = [
            product(nx, pressing) + product(tx, impulses[2]),
            product(ny, pressing) + product(ty, impulses[2]),
            turned << self.angular_shift,
        ];
        let changes = if coarse == 0 { changes } else { changes.map(|change| shifted(change, coarse)) };
        changes.map(|change| limited(change, share))
    }

    /// The changes of [`gain`](Self::gain) by impulses that are [free](Self::free_bits), in 2^-[`FINE`].
    #[inline(always)]
    pub(super) fn free_gain(&self, side: usize, impulses: [i64; 3]) -> [i64; 3] {
        let [[nx, ny], [tx, ty]] = self.linear[side].map(|factors| factors.map(i64::from));
        let [first, second, third] = self.angular.map(|factors| i64::from(factors[side]));
        let pressing = impulses[0] + impulses[1];
        let turned = first * impulses[0] + second * impulses[1] + third * impulses[2];
        [nx * pressing + tx * impulses[2], ny * pressing + ty * impulses[2], turned << self.angular_shift]
    }

    /// The bits of impulses that change no velocity of a body as far as its limit: below 2^bits they are *free*.
    ///
    /// # Ranges
    /// A change is below the sum of the factors of its impulses times 2^bits, and that times the share is at most 2^60. So no product in
    /// words wraps.
    pub(super) fn free_bits(&self, side: usize, share: i64) -> i32 {
        let [normal, tangent] = self.linear[side].map(|factors| factors.map(|factor| i64::from(factor).abs()));
        let turning: i64 = self.angular.iter().map(|factors| i64::from(factors[side]).abs()).sum();
        let linear = (2 * normal[0] + tangent[0]) | (2 * normal[1] + tangent[1]);
        60 - bits_of(share) - bits_of(linear).max(bits_of(turning) + self.angular_shift as i32)
    }

    /// The gain of a body by an impulse of one unit along a row.
    fn unit_gain(&self, side: usize, row: usize) -> [i64; 3] {
        let [x, y] = self.linear[side][row / 2].map(i64::from);
        let turned = i128::from(self.angular[row][side]) << self.angular_shift;
        [x, y, limited(turned, 1)]
    }

    /// The elements of the matrix by one body.
    pub(super) fn elements(&self, side: usize) -> Elements {
        self.elements_by(side, [0, 1, 2].map(|row| self.unit_gain(side, row)))
    }

    /// The elements of the matrix by one body that is joined to others, for its response.
    pub(super) fn joined_elements(&self, side: usize, response: &Response) -> Elements {
        let gains = [0, 1, 2].map(|row| {
            let gain = self.unit_gain(side, row);
            [0, 1, 2].map(|axis| {
                let sum: i128 = (0..3).map(|from| product(response[from][axis], gain[from])).sum();
                limited(lowered(sum, 30), 1)
            })
        });
        let mut elements = self.elements_by(side, gains);
        // Responses of loops are not exact: no row moves a body by less than 2^-16 of its own inverse mass.
        let alone = self.elements(side);
        for row in [0, 2, 5] {
            elements[row] = elements[row].max(alone[row] >> 16);
        }
        // Nor has any pair of rows more in common than both have.
        for (between, [first, second]) in [(1, [0, 2]), (3, [0, 5]), (4, [2, 5])] {
            let [first, second] = [elements[first], elements[second]];
            if product(elements[between], elements[between]) > product(first, second) {
                elements[between] = elements[between].signum() * first.min(second);
            }
        }
        elements
    }

    /// The elements of the matrix by one body with these gains by impulses of one unit.
    fn elements_by(&self, side: usize, gains: [[i64; 3]; 3]) -> Elements {
        let column =
            |row: usize| if side == 0 { self.along(gains[row], [0; 3], 0) } else { self.along([0; 3], gains[row], 0) };
        let ([k11, k21, k1t], [k12, k22, k2t], [_, _, ktt]) = (column(0), column(1), column(2));
        // Both ways, so that the points may come in either order.
        [k11, (k12 + k21) >> 1, k22, k1t, k2t, ktt]
    }
}

/// The two normal rows of a contact: a copy of its lane of a group, for contacts that are looked at again and again whether they close.
#[derive(Clone, Copy, Debug)]
pub(super) struct NormalRows {
    pub(super) place: u32,
    /// The rows of both bodies.
    pub(super) rows: [u32; 2],
    normal: [i32; 2],
    arms: [[i32; 2]; 2],
}

impl NormalRows {
    pub(super) fn of(place: u32, group: &Group, lane: usize) -> Self {
        Self {
            place,
            rows: [group.a[lane], group.b[lane]],
            normal: group.normal[lane],
            arms: [group.arms[0][lane], group.arms[1][lane]],
        }
    }

    /// By point: true if two bodies with these velocities in 2^(coarse − [`FINE`]) close along the normal faster than a speed in
    /// 2^-[`FRACTION`], as [`Jacobian::normal_velocities`] has them.
    #[inline(always)]
    pub(super) fn close_faster(&self, [a, b]: [[i64; 3]; 2], coarse: i32, speed: i64) -> [bool; 2] {
        let bits = 30 + FINE - FRACTION - coarse;
        let [nx, ny] = self.normal.map(i64::from);
        // Rounded down after a half is added: below −speed if the sum is below −speed · 2^bits.
        let normal = product(nx, b[0] - a[0]) + product(ny, b[1] - a[1]) + (1 << (bits - 1));
        let limit = -(i128::from(speed) << bits);
        let mut close = [false; 2];
        for (point, closes) in close.iter_mut().enumerate() {
            let [arm_a, arm_b] = self.arms[point].map(i64::from);
            *closes = normal + product(arm_b, b[2]) - product(arm_a, a[2]) < limit;
        }
        close
    }
}

/// A velocity in units 2^coarse times as large, rounded oddly.
#[inline(always)]
pub(super) fn coarsened(velocity: [i64; 3], coarse: i32) -> [i64; 3] {
    if coarse == 0 { velocity } else { velocity.map(|part| shifted_word(part, coarse)) }
}

/// A change within ±2^60 over a share. *Domain* shares are below 2^22.
#[inline(always)]
fn limited(change: i128, share: i64) -> i64 {
    limited_word(change.clamp(-(1 << 60), 1 << 60) as i64, share)
}

/// [`limited`] for a word.
#[inline(always)]
fn limited_word(change: i64, share: i64) -> i64 {
    // Few are beyond the limit: a product costs less than a quotient.
    if product(change.unsigned_abs() as i64, share.max(1)) <= 1 << 60 {
        return change;
    }
    let limit = (1_i64 << 60) / share.max(1);
    change.clamp(-limit, limit)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A response that is not exact leaves a matrix that no impulse gets energy from: here both rows would have more in common than each has.
    #[test]
    fn elements_of_a_joined_body_are_those_of_masses() {
        const ONE: i32 = 1 << 30;
        let jacobian = Jacobian {
            normal: [0, ONE],
            arms: [[0, ONE], [0, -ONE], [0, ONE >> 1]],
            linear: [[[ONE, ONE]; 2]; 2],
            angular: [[0, ONE], [0, -ONE], [0, ONE >> 1]],
            angular_shift: 0,
        };
        let scale = 1 << 30;
        for response in [
            [[scale, 0, 0], [0, scale, 0], [0, 0, scale]],
            [[scale, 0, 0], [0, scale >> 8, 0], [0, 0, -scale]],
            [[scale, 3 * scale, 0], [-scale, scale >> 4, scale], [0, -scale, scale >> 4]],
        ] {
            let [k11, k12, k22, k1t, k2t, ktt] = jacobian.joined_elements(1, &response);
            assert!(k11 > 0 && k22 > 0 && ktt > 0, "{response:?}");
            for (between, first, second) in [(k12, k11, k22), (k1t, k11, ktt), (k2t, k22, ktt)] {
                assert!(
                    product(between, between) <= product(first, second),
                    "{response:?}: {between} {first} {second}"
                );
            }
        }
    }
}
