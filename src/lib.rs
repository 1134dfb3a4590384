//! Deterministic 2D rigid-body physics in fixed point.
#![no_std]

extern crate alloc;
#[cfg(feature = "std")]
extern crate std;

mod kernel;
mod scalar;

pub use scalar::fx::{Fx, MathError, ParseFxError};
