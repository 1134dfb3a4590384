//! The mass that a body has from its colliders.

use alloc::vec::Vec;

use super::ColliderDef;
use crate::scalar::{Factor, Scalar};

/// The mass of a body's colliders together, and their moment of inertia about the body's centre of mass; zero without colliders.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ColliderMass<S: Scalar> {
    count: usize,
    /// Σ density times area, kg.
    pub(crate) mass: S::Factor,
    /// The moment of inertia per mass, m²; zero without mass.
    pub(crate) gyration: S::Factor,
}

impl<S: Scalar> Default for ColliderMass<S> {
    fn default() -> Self {
        Self { count: 0, mass: S::Factor::ZERO, gyration: S::Factor::ZERO }
    }
}

impl<S: Scalar> ColliderMass<S> {
    /// Returns true for a body without colliders.
    pub(crate) fn is_none(&self) -> bool {
        self.count == 0
    }

    /// Σ w and Σ w·(k² + d²) / Σ w with w the mass of a collider, k its radius of gyration and d the distance of its centre of mass
    /// from that of the body.
    ///
    /// The result does not depend on the order in which colliders were added. *Error* 2^-58 relative.
    pub(crate) fn of<'a>(colliders: impl Iterator<Item = &'a ColliderDef<S>>) -> Self
    where
        S: 'a,
    {
        let term = |def: &ColliderDef<S>| {
            let away = def.position.wide_length();
            let mass = S::Factor::from_scalar(def.density).times(def.shape.measure());
            (mass, mass.times(def.shape.gyration().plus(away.times(away))))
        };
        let (masses, inertias): (Vec<S::Factor>, Vec<S::Factor>) = colliders.map(term).unzip();
        let count = masses.len();
        let (mass, inertia) = (S::Factor::sum(masses), S::Factor::sum(inertias));
        let gyration = if mass.is_zero() { S::Factor::ZERO } else { inertia.over(mass) };
        Self { count, mass, gyration }
    }
}
