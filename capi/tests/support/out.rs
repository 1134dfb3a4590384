//! Helpers for functions that give their results through pointers.

use std::mem::MaybeUninit;

use umbra_physics_capi::{UMBRA_OK, UmbraStatus};

/// Calls a function that gives a value through a pointer, and returns the value.
pub(crate) fn out<T>(call: impl FnOnce(Option<&mut MaybeUninit<T>>) -> UmbraStatus) -> Result<T, UmbraStatus> {
    let mut place = MaybeUninit::uninit();
    match call(Some(&mut place)) {
        // SAFETY: a call that is done has written it.
        UMBRA_OK => Ok(unsafe { place.assume_init() }),
        status => Err(status),
    }
}

/// Calls a function that makes an object, and returns the object.
pub(crate) fn own<T>(
    call: impl FnOnce(Option<&mut MaybeUninit<Option<Box<T>>>>) -> UmbraStatus,
) -> Result<Box<T>, UmbraStatus> {
    out(call).map(|thing| thing.expect("a call that is done gives something"))
}
