//! Slices from pointers: the one place where the interface dereferences the caller's pointers.

use std::ffi::c_char;
use std::mem::MaybeUninit;

use crate::status::{Refusal, Result, UMBRA_ERROR_BUFFER_TOO_SMALL, UMBRA_ERROR_NULL_POINTER, UmbraStatus, guard};

/// The value at a pointer, unless the pointer is null.
pub(crate) fn given<T>(pointer: Option<T>) -> Result<T> {
    pointer.ok_or_else(|| Refusal::own(UMBRA_ERROR_NULL_POINTER, "a pointer is null"))
}

/// Refuses a length that no memory has.
fn check_length<T>(length: usize) -> Result {
    match length.checked_mul(size_of::<T>()) {
        Some(bytes) if bytes <= isize::MAX as usize => Ok(()),
        _ => Err(Refusal::bad("a length is beyond what memory has")),
    }
}

/// A slice of `count` values at a pointer, which may be null if the count is 0.
///
/// # Safety
/// They are there, initialised, and stay as they are as long as the slice is used.
pub(crate) unsafe fn slice<'a, T>(pointer: *const T, length: usize) -> Result<&'a [T]> {
    if length == 0 {
        return Ok(&[]);
    }
    check_length::<T>(length)?;
    if pointer.is_null() {
        return given(None);
    }
    // SAFETY: not null, not longer than memory is; the caller promises the rest.
    Ok(unsafe { std::slice::from_raw_parts(pointer, length) })
}

/// Text at a pointer.
///
/// # Safety
/// As [`slice`].
pub(crate) unsafe fn text<'a>(pointer: *const c_char, length: usize) -> Result<&'a str> {
    // SAFETY: as the caller promises; bytes are characters of C.
    let bytes = unsafe { slice(pointer.cast::<u8>(), length) }?;
    std::str::from_utf8(bytes).map_err(|error| Refusal::bad(&error.to_string()))
}

/// Writes values to a buffer if they all fit, and to a place, if there is one, `count`, the number that the caller goes by.
///
/// # Safety
/// The buffer, unless it is null, has room for `capacity` values, and nothing else uses it meanwhile.
unsafe fn put<T>(
    values: impl ExactSizeIterator<Item = T>,
    buffer: *mut T,
    capacity: usize,
    count: usize,
    place: Option<&mut MaybeUninit<usize>>,
) -> Result {
    check_length::<T>(capacity)?;
    if capacity > 0 && buffer.is_null() {
        return given(None);
    }
    if let Some(place) = place {
        place.write(count);
    }
    let needed = values.len();
    if needed > capacity {
        return Err(Refusal::own(UMBRA_ERROR_BUFFER_TOO_SMALL, "the buffer is too small"));
    }
    for (i, value) in values.take(needed).enumerate() {
        // SAFETY: i < needed ≤ capacity, so there is room; with a capacity of 0 there is no i.
        unsafe { buffer.add(i).write(value) };
    }
    Ok(())
}

/// Writes values to a buffer if they all fit, and how many there are also if they do not.
///
/// # Safety
/// As [`put`].
pub(crate) unsafe fn fill<T>(
    values: impl ExactSizeIterator<Item = T>,
    buffer: *mut T,
    capacity: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> Result {
    let needed = values.len();
    // SAFETY: as the caller promises.
    unsafe { put(values, buffer, capacity, needed, count) }
}

/// Writes text with a zero after it; its length is counted without.
///
/// # Safety
/// As [`put`].
pub(crate) unsafe fn write_text(
    text: &str,
    buffer: *mut c_char,
    capacity: usize,
    length: Option<&mut MaybeUninit<usize>>,
) -> Result {
    let mut bytes = text.as_bytes().to_vec();
    bytes.push(0);
    // SAFETY: as the caller promises; bytes are characters of C.
    unsafe { put(bytes.into_iter(), buffer.cast::<u8>(), capacity, text.len(), length) }
}

/// Bytes that the library owns: a snapshot, a replay, or room that a caller without memory of its own asked for.
pub struct UmbraBytes {
    /// Never longer than it was made, so that it stays where it is.
    bytes: Vec<u8>,
    /// Start of the caller's bytes.
    from: usize,
}

impl UmbraBytes {
    pub(crate) fn boxed(bytes: Vec<u8>) -> Option<Box<Self>> {
        Some(Box::new(Self { bytes, from: 0 }))
    }
}

/// Alignment of the structs of the interface, or more: allocated room may hold any of them.
const ALIGNMENT: usize = 16;

/// Allocates bytes, all 0, to write into: for hosts whose memory the library does not see, such as a WebAssembly host.
/// They lie at a multiple of 16.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_bytes_new(
    length: usize,
    bytes: Option<&mut MaybeUninit<Option<Box<UmbraBytes>>>>,
) -> UmbraStatus {
    guard(|| {
        let out = given(bytes)?;
        check_length::<u8>(length)?;
        let mut bytes = Vec::new();
        bytes.try_reserve_exact(length + ALIGNMENT).map_err(|error| Refusal::bad(&error.to_string()))?;
        let from = (bytes.as_ptr() as usize).wrapping_neg() % ALIGNMENT;
        bytes.resize(from + length, 0);
        out.write(Some(Box::new(UmbraBytes { bytes, from })));
        Ok(())
    })
}

/// Address of the bytes, valid until they are freed; null for null.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_bytes_data(bytes: Option<&mut UmbraBytes>) -> *mut u8 {
    // Without a reference to them: pointers that were given out before stay good.
    bytes.map_or(std::ptr::null_mut(), |bytes| bytes.bytes.as_mut_ptr().wrapping_add(bytes.from))
}

/// Number of bytes; 0 for null.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_bytes_length(bytes: Option<&UmbraBytes>) -> usize {
    bytes.map_or(0, |bytes| bytes.bytes.len() - bytes.from)
}

/// Frees bytes. Null is ignored.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_bytes_free(bytes: Option<Box<UmbraBytes>>) {
    drop(bytes);
}
