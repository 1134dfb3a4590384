//! Numbers as integers, and their text.

use std::ffi::c_char;
use std::mem::MaybeUninit;

use umbra_physics::{Fx, FxFactor, FxWide, Vec2};

use crate::memory::{given, text, write_text};
use crate::status::{Refusal, Result, UmbraStatus, guard};

/// A number: this many 2^-32. 1 m is 4294967296, and `UMBRA_ONE`.
pub type UmbraFx = i64;

/// 1 as an `UmbraFx`.
pub const UMBRA_ONE: UmbraFx = 0x1_0000_0000;

/// Two numbers: x to the right, y up.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UmbraVec2 {
    /// Along x.
    pub x: UmbraFx,
    /// Along y.
    pub y: UmbraFx,
}

/// An integer of 128 bits in two's complement: high · 2^64 + low.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UmbraInt128 {
    /// The lower 64 bits.
    pub low: u64,
    /// The higher 64 bits, with the sign.
    pub high: i64,
}

/// An integer of 128 bits from 0: high · 2^64 + low.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UmbraUint128 {
    /// The lower 64 bits.
    pub low: u64,
    /// The higher 64 bits.
    pub high: u64,
}

/// A factor from 0: mantissa · 2^-shift, with the top bit of the mantissa set; or both are 0.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UmbraFactor {
    /// 64 bits, the highest of them set.
    pub mantissa: u64,
    /// -16384 to 16384.
    pub shift: i32,
    /// 0.
    pub reserved: u32,
}

impl From<Vec2> for UmbraVec2 {
    fn from(Vec2 { x, y }: Vec2) -> Self {
        Self { x: x.to_bits(), y: y.to_bits() }
    }
}

impl From<UmbraVec2> for Vec2 {
    fn from(UmbraVec2 { x, y }: UmbraVec2) -> Self {
        vector(x, y)
    }
}

impl From<FxWide> for UmbraInt128 {
    fn from(wide: FxWide) -> Self {
        Self { low: wide.to_bits() as u64, high: (wide.to_bits() >> 64) as i64 }
    }
}

impl From<u128> for UmbraUint128 {
    fn from(value: u128) -> Self {
        Self { low: value as u64, high: (value >> 64) as u64 }
    }
}

impl From<FxFactor> for UmbraFactor {
    fn from(factor: FxFactor) -> Self {
        let (mantissa, shift) = factor.parts();
        Self { mantissa, shift, reserved: 0 }
    }
}

pub(crate) fn factor(UmbraFactor { mantissa, shift, .. }: UmbraFactor) -> Result<FxFactor> {
    FxFactor::from_parts(mantissa, shift)
        .ok_or_else(|| Refusal::bad("a factor has the top bit of its mantissa set, or is 0"))
}

pub(crate) const fn vector(x: UmbraFx, y: UmbraFx) -> Vec2 {
    Vec2::new(Fx::from_bits(x), Fx::from_bits(y))
}

/// The number nearest to a decimal text of `length` bytes, such as `-9.81` or `1.5e-3`; ties to even, never through a float.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_fx_from_text(
    text: *const c_char,
    length: usize,
    number: Option<&mut MaybeUninit<UmbraFx>>,
) -> UmbraStatus {
    guard(|| {
        // SAFETY: as the caller promises.
        let text = unsafe { self::text(text, length) }?;
        given(number)?.write(Fx::parse(text)?.to_bits());
        Ok(())
    })
}

/// All digits of a number: at most 44 bytes and the zero. Read again they are the number. Text as `umbra_last_message` gives it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_fx_to_text(
    number: UmbraFx,
    buffer: *mut c_char,
    capacity: usize,
    length: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    // SAFETY: as the caller promises.
    guard(|| unsafe { write_text(&Fx::from_bits(number).to_string(), buffer, capacity, length) })
}

/// All digits of a multiple of 2^-64, as energies are, at most 85 bytes and the zero: text as `umbra_last_message` gives it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_wide_to_text(
    wide: Option<&UmbraInt128>,
    buffer: *mut c_char,
    capacity: usize,
    length: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    guard(|| {
        let UmbraInt128 { low, high } = *given(wide)?;
        let wide = FxWide::from_bits(i128::from(high) << 64 | i128::from(low));
        // SAFETY: as the caller promises.
        unsafe { write_text(&wide.to_string(), buffer, capacity, length) }
    })
}

/// The factor nearest to a decimal text, such as `3.986004418e14`: for what is too large or too small for an `UmbraFx`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_factor_from_text(
    text: *const c_char,
    length: usize,
    factor: Option<&mut MaybeUninit<UmbraFactor>>,
) -> UmbraStatus {
    guard(|| {
        // SAFETY: as the caller promises.
        let text = unsafe { self::text(text, length) }?;
        given(factor)?.write(FxFactor::parse(text)?.into());
        Ok(())
    })
}

/// The factor that a number is, exactly; of its magnitude if it is below 0.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_factor_from_fx(number: UmbraFx, factor: Option<&mut MaybeUninit<UmbraFactor>>) -> UmbraStatus {
    guard(|| {
        given(factor)?.write(FxFactor::from_scalar(Fx::from_bits(number)).into());
        Ok(())
    })
}
