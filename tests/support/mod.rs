//! Helpers that the tests of the kernels share.

pub(crate) mod cordic;
pub(crate) mod hard;
pub(crate) mod inputs;
pub(crate) mod reference;
