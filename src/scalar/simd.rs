//! The loops of [`fx_bulk`](super::fx_bulk) for CPUs with wide vectors, chosen when the program runs.
//!
//! The loops are safe code on 32-bit halves, without branches, which the compiler turns into vector instructions when
//! it may assume the CPU has them. Only AVX-512 makes that pay: it has 64-bit comparisons, and eight lanes make up for
//! the four multiplications that one of 64 by 64 bits takes. (With AVX2 the same loops take as long as the plain ones.)
//!
//! The one thing that is not safe is to call them on a CPU without these instructions: this file asks first. It is the
//! only one in the crate that may say `unsafe`.
#![cfg_attr(
    all(feature = "std", target_arch = "x86_64"),
    allow(unsafe_code, reason = "to call what is compiled for wide vectors, where there are some")
)]

use super::accumulator::FxAccumulator;
use super::turn::Turn;

/// The switch for wide vectors in this process.
#[doc(hidden)]
pub mod wide_vectors {
    use core::sync::atomic::{AtomicBool, Ordering};

    static ALLOWED: AtomicBool = AtomicBool::new(true);

    /// Allows or forbids wide vectors in this process. They change no bit: the switch is for tests that show it and for measurements.
    #[doc(hidden)]
    pub fn allow(yes: bool) {
        ALLOWED.store(yes, Ordering::Relaxed);
    }

    /// Returns true if they are used: they are allowed, the CPU has them (AVX-512), and so had the compiler (1.89 or newer, with the
    /// feature `std`).
    ///
    /// ```
    /// use umbra_physics::scalar::internals::wide_vectors;
    /// println!("wide vectors: {}", wide_vectors::are_used()); // for a report of measurements
    /// wide_vectors::allow(false);
    /// assert!(!wide_vectors::are_used());
    /// # wide_vectors::allow(true);
    /// ```
    #[must_use]
    #[doc(hidden)]
    pub fn are_used() -> bool {
        ALLOWED.load(Ordering::Relaxed) && has()
    }

    #[cfg(all(feature = "std", target_arch = "x86_64"))]
    #[rustversion::since(1.89)]
    fn has() -> bool {
        extern crate std;
        std::is_x86_feature_detected!("avx512f")
            && std::is_x86_feature_detected!("avx512dq")
            && std::is_x86_feature_detected!("bmi2")
    }

    #[cfg(all(feature = "std", target_arch = "x86_64"))]
    #[rustversion::before(1.89)]
    fn has() -> bool {
        false
    }

    #[cfg(not(all(feature = "std", target_arch = "x86_64")))]
    fn has() -> bool {
        false
    }
}

/// A loop where the CPU has wide vectors; `None`, and nothing done, where it has not or where there are few values.
macro_rules! where_wide {
    (fn $name:ident($values:ident: $slice:ty $(, $argument:ident: $type:ty)*) $(-> $result:ty)?) => {
        #[cfg(all(feature = "std", target_arch = "x86_64"))]
        #[allow(unused_parens, reason = "the result may be none")]
        pub(super) fn $name($values: $slice $(, $argument: $type)*) -> Option<($($result)?)> {
            #[rustversion::attr(since(1.89), target_feature(enable = "avx512f,avx512dq,bmi2"))]
            unsafe fn wide($values: $slice $(, $argument: $type)*) $(-> $result)? {
                loops::$name($values $(, $argument)*)
            }

            if !pay($values.len()) {
                return None;
            }
            // SAFETY: the CPU has the instructions that the function is compiled for.
            Some(unsafe { wide($values $(, $argument)*) })
        }

        #[cfg(not(all(feature = "std", target_arch = "x86_64")))]
        #[allow(unused_parens, reason = "the result may be none")]
        pub(super) fn $name(_: $slice $(, _: $type)*) -> Option<($($result)?)> {
            None
        }
    };
}

where_wide!(fn damp(values: &mut [FxAccumulator], mantissa: u64));
where_wide!(fn kick(values: &mut [FxAccumulator], gained: FxAccumulator));
where_wide!(fn drift(
    positions: &mut [FxAccumulator],
    velocities: &[FxAccumulator],
    mantissa: u64,
    shift: u32,
    backwards: u64
));
where_wide!(fn spread(values: &[FxAccumulator], limit: u64) -> u64);
where_wide!(fn turn(angles: &mut [Turn], velocities: &[FxAccumulator], mantissa: u64, shift: u32, backwards: u64));

/// Returns true if wide vectors are faster for this number of values.
pub(super) fn pay(count: usize) -> bool {
    count >= 16 && wide_vectors::are_used()
}

/// The loops, for every machine, so that every machine can test them.
#[cfg_attr(not(all(feature = "std", target_arch = "x86_64")), allow(dead_code, reason = "only tests call them"))]
pub(super) mod loops {
    use super::{FxAccumulator, Turn};

    /// Half of a word.
    const TIE: u64 = 1 << 63;

    /// Two's complement in two words, the low one first.
    type Words = (u64, u64);

    #[inline(always)]
    fn sum(a: Words, b: Words) -> Words {
        let low = a.0.wrapping_add(b.0);
        (low, a.1.wrapping_add(b.1).wrapping_add(u64::from(low < b.0)))
    }

    /// a·b by halves. Each partial product is at most (2^32 − 1)², which leaves room for two more words of 32 bits.
    #[inline(always)]
    fn product(a: u64, b: u64) -> Words {
        const HALF: u64 = u32::MAX as u64;
        let (a1, a0, b1, b0) = (a >> 32, a & HALF, b >> 32, b & HALF);
        let low = a0 * b0;
        let mid = a1 * b0 + (low >> 32);
        let mid2 = a0 * b1 + (mid & HALF);
        ((mid2 << 32) | (low & HALF), a1 * b1 + (mid >> 32) + (mid2 >> 32))
    }

    /// a·b with a signed.
    #[inline(always)]
    fn signed_product(a: u64, b: u64) -> Words {
        let (low, high) = product(a, b);
        (low, high.wrapping_sub((a as i64 >> 63) as u64 & b))
    }

    /// floor + 1 if the rest is above a half, or is a half and the floor odd.
    #[inline(always)]
    fn rounded(floor: Words, rest: u64, half: u64) -> Words {
        sum(floor, (u64::from(rest > half - (floor.0 & 1)), 0))
    }

    /// The public value of an accumulator.
    #[inline(always)]
    fn value(v: &FxAccumulator) -> u64 {
        let high = v.high as u64;
        high.wrapping_add(u64::from(v.low > TIE - (high & 1)))
    }

    /// v·mantissa / 2^shift. *Domain* 1 <= shift <= 63.
    #[inline(always)]
    fn passed(v: u64, mantissa: u64, shift: u32) -> Words {
        let (low, high) = signed_product(v, mantissa);
        let floor = (low >> shift | high << (64 - shift), (high as i64 >> shift) as u64);
        rounded(floor, low & ((1 << shift) - 1), 1 << (shift - 1))
    }

    /// v·mantissa / 2^64, and zero where its public value is zero.
    #[inline(always)]
    pub(in crate::scalar) fn damp(values: &mut [FxAccumulator], mantissa: u64) {
        for v in values {
            let (rest, carried) = product(v.low, mantissa);
            let floor = sum(signed_product(v.high as u64, mantissa), (carried, 0));
            let (low, high) = rounded(floor, rest, TIE);
            // Its public value is zero from −½ to ½ ulp: shifted by half an ulp, from 0 to 2^64.
            let (above, ulps) = sum((low, high), (TIE, 0));
            let is_zero = (ulps == 0) | ((ulps == 1) & (above == 0));
            let keep = u64::from(is_zero).wrapping_sub(1);
            *v = FxAccumulator { high: (high & keep) as i64, low: low & keep };
        }
    }

    /// v + gained.
    #[inline(always)]
    pub(in crate::scalar) fn kick(values: &mut [FxAccumulator], gained: FxAccumulator) {
        for v in values {
            let (low, high) = sum((v.low, v.high as u64), (gained.low, gained.high as u64));
            *v = FxAccumulator { high: high as i64, low };
        }
    }

    /// x + v·mantissa / 2^shift with the public velocity, taken negative if `backwards` has all bits set.
    #[inline(always)]
    pub(in crate::scalar) fn drift(
        positions: &mut [FxAccumulator],
        velocities: &[FxAccumulator],
        mantissa: u64,
        shift: u32,
        backwards: u64,
    ) {
        for (x, v) in positions.iter_mut().zip(velocities) {
            let v = (value(v) ^ backwards).wrapping_sub(backwards);
            let (low, high) = sum((x.low, x.high as u64), passed(v, mantissa, shift & 63));
            *x = FxAccumulator { high: high as i64, low };
        }
    }

    /// The bits of all values plus `limit`.
    #[inline(always)]
    pub(in crate::scalar) fn spread(values: &[FxAccumulator], limit: u64) -> u64 {
        values.iter().fold(0, |bits, v| bits | (v.high as u64).wrapping_add(limit))
    }

    /// angle + v·mantissa / 2^shift with the public velocity, taken negative if `backwards` has all bits set.
    #[inline(always)]
    pub(in crate::scalar) fn turn(
        angles: &mut [Turn],
        velocities: &[FxAccumulator],
        mantissa: u64,
        shift: u32,
        backwards: u64,
    ) {
        for (angle, v) in angles.iter_mut().zip(velocities) {
            let v = (value(v) ^ backwards).wrapping_sub(backwards);
            angle.0 = angle.0.wrapping_add(passed(v, mantissa, shift & 63).0);
        }
    }
}
