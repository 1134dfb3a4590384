//! Errors of rounding, for tests: the solver in floats rounds nothing by itself, and in tests at random wherever the solver in integers
//! rounds, within the same limits.

use alloc::vec::Vec;

use super::Vector;
use crate::math::Random;

/// The resolutions of a body in the solver in integers.
#[derive(Clone, Copy, Debug)]
pub(in crate::solve) struct BodyUnits {
    /// Of velocities: m/s and rad/s.
    pub(in crate::solve) velocity: Vector,
    /// The length by which arms are divided, m.
    pub(in crate::solve) length: f64,
}

impl BodyUnits {
    const EXACT: Self = Self { velocity: [0.0; 3], length: 1.0 };
}

/// The resolutions of a contact in the solver in integers.
#[derive(Clone, Copy, Debug)]
pub(in crate::solve) struct ContactUnits {
    /// m/s
    pub(in crate::solve) velocity: f64,
    /// N·s
    pub(in crate::solve) impulse: f64,
    /// log2 of the resolution of factors of angular velocities over the resolution of factors of velocities.
    pub(in crate::solve) angular_shift: i32,
    /// The velocity at which its overlap is pushed out at most, where wedges and locks limit it, m/s.
    pub(in crate::solve) push: f64,
}

impl ContactUnits {
    const EXACT: Self = Self { velocity: 0.0, impulse: 0.0, angular_shift: 0, push: f64::INFINITY };

    /// A unit of velocity for a unit of impulse, 1/kg; infinite without units.
    pub(super) fn factor(&self) -> f64 {
        if self.impulse == 0.0 { f64::INFINITY } else { self.velocity / self.impulse }
    }

    /// Half the resolution of factors in 2^-30.
    pub(super) fn half(&self) -> f64 {
        self.factor() * power(-31)
    }
}

/// Errors of rounding: none, or any within a limit.
#[derive(Debug, Default)]
pub(in crate::solve) struct Rounding {
    pub(in crate::solve) random: Option<Random>,
    /// The units by body and by contact; empty without any.
    pub(in crate::solve) bodies: Vec<BodyUnits>,
    pub(in crate::solve) contacts: Vec<ContactUnits>,
}

/// 2^exponent
pub(super) fn power(exponent: i32) -> f64 {
    libm::scalbn(1.0, exponent)
}

/// The power of two above a positive number.
pub(super) fn power_above(value: f64) -> f64 {
    power(libm::frexp(value).1)
}

impl Rounding {
    pub(super) fn body(&self, body: usize) -> BodyUnits {
        self.bodies.get(body).copied().unwrap_or(BodyUnits::EXACT)
    }

    pub(super) fn contact(&self, contact: usize) -> ContactUnits {
        self.contacts.get(contact).copied().unwrap_or(ContactUnits::EXACT)
    }

    /// An error from −limit to limit.
    pub(super) fn within(&mut self, limit: f64) -> f64 {
        match &mut self.random {
            None => 0.0,
            Some(random) => limit * (random.below(1 << 32) as f64 / power(31) - 1.0),
        }
    }

    /// The value rounded. Zero stays zero.
    pub(super) fn rounded(&mut self, value: f64, limit: f64) -> f64 {
        if value == 0.0 { value } else { value + self.within(limit) }
    }
}
