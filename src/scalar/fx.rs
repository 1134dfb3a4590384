//! `Fx`.

/// x
pub struct Fx;
/// x
pub struct MathError;
