//! Masses: how they are given, the inverse masses that follow, and the table in which bodies that are alike share them.

use super::rows::{Keyed, SharedRows, mix};
use super::{BodyInfo, BodyKind, Locks};
use crate::codec::codec_enum;
use crate::collider::ColliderMass;
use crate::error::{Error, Quantity};
use crate::fx::Fx;
use crate::limits;
use crate::math::Vec2;
use crate::scalar::{Factor, Number, Scalar};

/// Mass and moment of inertia of a dynamic body, as they are given.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
pub enum Mass<S = Fx> {
    /// A mass in kg. The inertia follows from the colliders; without any that have a mass it is infinite, and no torque turns the body.
    Kilograms(S),
    /// A mass and a moment of inertia.
    Explicit {
        /// The mass, kg.
        mass: S,
        /// The moment of inertia about the centre of mass, kg·m².
        inertia: S,
    },
    /// The mass of the colliders, by their densities, and their inertia. A body without colliders has 1 kg, and an infinite inertia.
    #[default]
    FromColliders,
}

codec_enum!(Mass<S>, "the number of a way to give a mass", {
    1 => Kilograms(mass),
    2 => Explicit { mass, inertia },
    3 => FromColliders,
});

/// The locks of a body, and its inverse masses with the locks taken into account: a product with them is the effect of a
/// force, an impulse or a torque, and zero where the body is locked. All are zero for a body that is not dynamic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MassProperties<S: Scalar> {
    /// 1/m, 1/kg, whatever the locks are: drag slows a body by it.
    pub(crate) inverse_mass: S::Factor,
    /// 1/m along x and along y, 1/kg; zero along a locked axis. A dynamic body has it zero along locked axes only.
    pub(crate) axis_inverse_mass: Vec2<S::Factor>,
    /// 1/I, 1/(kg·m²); zero where the rotation is locked, or the inertia infinite.
    pub(crate) inverse_inertia: S::Factor,
    pub(crate) locks: Locks,
}

impl<S: Scalar> MassProperties<S> {
    /// *Domain* `inverse_inertia` is that of the body without its locks.
    pub(super) fn new(inverse_mass: S::Factor, inverse_inertia: S::Factor, locks: Locks) -> Self {
        let unless = |locked, factor| if locked { S::Factor::ZERO } else { factor };
        Self {
            inverse_mass,
            axis_inverse_mass: Vec2::new(unless(locks.x, inverse_mass), unless(locks.y, inverse_mass)),
            inverse_inertia: unless(locks.rotation, inverse_inertia),
            locks,
        }
    }

    /// Returns true if impulses move the body.
    pub(crate) fn can_move(&self) -> bool {
        let zero = S::Factor::ZERO;
        self.axis_inverse_mass != Vec2::new(zero, zero) || self.inverse_inertia != zero
    }
}

impl<S: Scalar> Keyed for MassProperties<S> {
    type Key = Self;

    fn key(&self) -> Self {
        *self
    }

    fn hash(key: &Self) -> u64 {
        let Locks { x, y, rotation } = key.locks;
        let locks = u64::from(x) | u64::from(y) << 1 | u64::from(rotation) << 2;
        let (mass, inertia) = (key.inverse_mass.to_words(), key.inverse_inertia.to_words());
        mass.into_iter().chain(inertia).fold(mix(0, locks), mix)
    }
}

impl<S: Scalar> Mass<S> {
    /// The mass in kg of a dynamic body with these colliders.
    pub(super) fn kilograms(self, colliders: &ColliderMass<S>) -> Result<S, Error> {
        match self {
            Self::Kilograms(mass) | Self::Explicit { mass, inertia: _ } => Ok(mass),
            Self::FromColliders if colliders.is_none() => Ok(S::ONE),
            Self::FromColliders => colliders.mass.to_scalar().ok_or(mass_error(Fx::MAX)),
        }
    }

    /// The moment of inertia, kg·m², of a body of this mass in kg with these colliders; zero stands for infinite.
    pub(super) fn inertia(self, colliders: &ColliderMass<S>, kilograms: S) -> S::Factor {
        match self {
            Self::Explicit { mass: _, inertia } => S::Factor::from_scalar(inertia),
            Self::Kilograms(_) | Self::FromColliders => S::Factor::from_scalar(kilograms).times(colliders.gyration),
        }
    }

    /// The properties of a body that has this mass and these colliders.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] naming the quantity. A body that is not dynamic may have any mass.
    pub(crate) fn properties(
        self,
        colliders: &ColliderMass<S>,
        kind: BodyKind,
        locks: Locks,
    ) -> Result<MassProperties<S>, Error> {
        let zero = S::Factor::ZERO;
        if kind != BodyKind::Dynamic {
            return Ok(MassProperties::new(zero, zero, locks));
        }
        if let Self::Explicit { mass: _, inertia } = self {
            if !(inertia > S::ZERO && inertia.is_finite()) {
                return Err(Error::OutOfRange { quantity: Quantity::Inertia { value: inertia.to_fx() } });
            }
        }
        let kilograms = self.kilograms(colliders)?;
        if !(kilograms >= S::from_fx(limits::MASS_MIN) && kilograms <= S::from_fx(limits::MASS_MAX)) {
            return Err(mass_error(kilograms.to_fx()));
        }
        let inverse_mass = inverse::<S>(S::Factor::from_scalar(kilograms));
        Ok(MassProperties::new(inverse_mass, inverse::<S>(self.inertia(colliders, kilograms)), locks))
    }
}

/// The error of a mass beyond the range, kg.
fn mass_error(value: Fx) -> Error {
    Error::OutOfRange { quantity: Quantity::Mass { value } }
}

/// 1/I of a body without its locks; zero unless it is dynamic.
pub(super) fn inverse_inertia_of<S: Scalar>(info: &BodyInfo<S>) -> S::Factor {
    inverse::<S>(info.inertia())
}

/// 1/f, and zero for the zero that stands for infinite.
fn inverse<S: Scalar>(f: S::Factor) -> S::Factor {
    if f.is_zero() { f } else { S::Factor::ONE.over(f) }
}

/// The mass properties in use. Bodies that are alike share a row, so that a body takes four bytes for its masses, and a copy
/// of a world those alone: copies share the table until a mass is changed in one.
pub(super) type MassTable<S> = SharedRows<MassProperties<S>>;
