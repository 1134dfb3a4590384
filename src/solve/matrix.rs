//! Matrices of two rows, and their inverses.

use super::number::{bits_of, clamped_word, shifted_word};

/// The matrix of two rows.
#[derive(Clone, Copy)]
pub(super) struct Matrix {
    pub(super) k11: i64,
    pub(super) k12: i64,
    pub(super) k22: i64,
}

/// value · 2^-bits, as large as a factor may be.
pub(super) fn factor(value: i64, bits: i32) -> i32 {
    let most = i64::from(i32::MAX);
    if bits < 0 && bits_of(value) - bits > 31 {
        return clamped_word(value.signum() * most, most);
    }
    clamped_word(shifted_word(value, bits), most)
}

/// Element 12 over a diagonal one in 2^-28, within ±4.
pub(super) fn ratio(k12: i64, diagonal: i64) -> i32 {
    let bits = (bits_of(diagonal) - 31).max(0);
    let (k12, diagonal) = (k12 >> bits, diagonal >> bits);
    if diagonal == 0 {
        return 0;
    }
    // The diagonal is below 2^31, the numerator below 2^33: their quotient in 2^-28 is below 2^30.
    ((k12.clamp(-4 * diagonal, 4 * diagonal) << 28) / diagonal) as i32
}

/// Elements 11, 22 and 12 of an inverse, in 2^-exponent.
pub(super) struct Inverse {
    pub(super) elements: [i64; 3],
    pub(super) exponent: i32,
}

impl Inverse {
    /// The inverse of a matrix. *Error* 2^-29 of the largest element. *Domain* elements below 2^60.
    pub(super) fn of(k: Matrix) -> Self {
        let determinant = i128::from(k.k11) * i128::from(k.k22) - i128::from(k.k12) * i128::from(k.k12);
        if determinant <= 0 {
            return Self { elements: [0; 3], exponent: 0 };
        }
        // 33 bits of the determinant: its reciprocal has 30 or 31. Numerators have 31.
        let bits = 128 - determinant.leading_zeros() as i32 - 33;
        let kept = if bits > 0 { determinant >> bits } else { determinant << -bits };
        let reciprocal = (1 << 63) / kept as i64 as u64;
        let down = (bits_of(k.k11.max(k.k22)) - 31).max(0);
        let element = |value: i64| ((value >> down) * reciprocal as i64) >> 31;
        Self { elements: [element(k.k22), element(k.k11), -element(k.k12)], exponent: 32 + bits - down }
    }

    /// log2 above the largest element.
    pub(super) fn log2(&self) -> i32 {
        self.elements.iter().map(|&e| bits_of(e)).max().unwrap_or_default() - self.exponent
    }

    /// The elements in 2^-shift.
    pub(super) fn in_units(&self, shift: i32) -> [i32; 3] {
        self.elements.map(|e| factor(e, self.exponent - shift))
    }
}
