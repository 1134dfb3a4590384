//! `umbra-physics` behind a C ABI: for C, C++, C#, engines that load libraries, and browsers.
//!
//! It is a separate package because pointers from other languages need `unsafe`, which the library denies outside its vector
//! instructions. It stands where a pointer comes with a length (`memory`), where a definition contains a shape, and for the runs of
//! scenes and replays, which borrow from them (`run`); elsewhere functions take references that may be null. Every change is a `Command`.
//! Nothing is computed here: every function checks its arguments, calls the library, and returns the result.
//! The header, `include/umbra_physics.h`, is generated from these sources; `README.md` describes building, linking and
//! ownership.
//!
//! # Safety
//! All functions have the same requirements for their caller:
//! - a pointer is null, or aligned and points to as many values as the function says. Objects come from this library and are not freed
//!   yet. Null is refused where it has no meaning, with `UMBRA_ERROR_NULL_POINTER`;
//! - memory that a call writes to is not used by another call at the same time, nor by another argument of the call;
//! - a definition (`UmbraBodyDef`, …) is filled in before it is read; its `_default` function does so.
//!
//! Then, for any numbers, handles, lengths and bytes, a call succeeds or returns an error and changes nothing. No panic reaches the
//! caller: it would be a bug of the library, and returns `UMBRA_ERROR_PANIC`; in WebAssembly, where panics do not unwind, it traps.
#![allow(clippy::missing_safety_doc, reason = "it is the same for all, and stands above and in the header")]
#![allow(clippy::type_complexity, reason = "types as C has them: pointers to places for pointers")]

// In the order in which the header has them.
mod memory;
mod number;
mod status;

mod arithmetic;

mod shape;

mod run;
mod world;

mod name;

mod body;
mod collider;
mod contact;
mod event;
mod field;
mod force;
mod joint;
mod query;

mod character;

mod command;
mod settings;

mod back;
mod snapshot;

mod replay;

mod draw;

mod totals;

pub use arithmetic::*;
pub use back::*;
pub use body::*;
pub use character::*;
pub use collider::*;
pub use command::*;
pub use contact::*;
pub use draw::*;
pub use event::*;
pub use field::*;
pub use force::*;
pub use joint::*;
pub use memory::*;
pub use name::*;
pub use number::*;
pub use query::*;
pub use replay::*;
pub use settings::*;
pub use shape::*;
pub use snapshot::*;
pub use status::*;
pub use totals::*;
pub use world::*;

use std::ffi::c_char;
use std::mem::MaybeUninit;

/// The number of this interface: it moves when a function, a struct or a meaning changes so that programs have to be built
/// again. A program compares `UMBRA_API` of its header with `umbra_api` of the library it loads.
pub const UMBRA_API: u32 = 3;

/// No body, no field, no collider: a handle that names nothing, in no world.
pub const UMBRA_NO_HANDLE: u64 = 0xFFFF_FFFF_FFFF_FFFF;

/// The number of the interface that the library has.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_api() -> u32 {
    UMBRA_API
}

/// The physics version. Peers, snapshots and replays go together if they have the same.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_physics_version() -> u32 {
    umbra_physics::PHYSICS_VERSION
}

/// The version of the library as text, which stays. This interface has the same.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_version() -> *const c_char {
    concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
}

/// Runs the corpus of the library, and gives its digest: the same on every machine. What it is to be
/// stands in `src/selftest/golden.txt`.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_selftest(digest: Option<&mut MaybeUninit<u64>>) -> UmbraStatus {
    status::guard(|| {
        let digest = memory::given(digest)?;
        digest.write(umbra_physics::selftest::run()?.digest);
        Ok(())
    })
}
