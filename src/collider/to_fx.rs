//! Colliders in fixed point. Contacts are found in fixed point in every world: a world of floats keeps its colliders twice, as they were
//! given and rounded to [`Fx`].

use alloc::boxed::Box;
use core::any::{Any, TypeId};

use super::{ColliderDef, ColliderSet, ContactSettings, Material, MaterialPair, OneWay};
use crate::fx::Fx;
use crate::scalar::Scalar;

/// The set for the rounded colliders of a world; `None` in a world of [`Fx`], whose colliders need no rounding.
pub(super) fn image<S: Scalar>() -> Option<Box<ColliderSet<Fx>>> {
    (TypeId::of::<S>() != TypeId::of::<Fx>()).then(Box::default)
}

impl<S: Scalar> ColliderSet<S> {
    /// The colliders in fixed point, with the same slots and handles: the set itself in a world of [`Fx`].
    #[inline(always)]
    pub(crate) fn fixed(&self) -> &ColliderSet<Fx> {
        let image = self.image.as_deref();
        image.or_else(|| (self as &dyn Any).downcast_ref()).expect("a set of Fx is its own image")
    }
}

impl<S: Scalar> ColliderDef<S> {
    /// The definition with all numbers rounded to nearest.
    pub(super) fn to_fx(&self) -> ColliderDef<Fx> {
        ColliderDef {
            shape: self.shape.to_fx(),
            position: self.position.map(S::to_fx),
            angle: self.angle.to_fx(),
            density: self.density.to_fx(),
            material: self.material.to_fx(),
            filter: self.filter,
            one_way: self.one_way.map(|one_way| OneWay {
                direction: one_way.direction.map(S::to_fx),
                tolerance: one_way.tolerance.to_fx(),
            }),
            sensor: self.sensor,
            contact_events: self.contact_events,
            hit_events: self.hit_events,
            key: self.key,
            user_data: self.user_data,
        }
    }
}

impl<S: Scalar> Material<S> {
    fn to_fx(self) -> Material<Fx> {
        Material {
            friction: self.friction.to_fx(),
            restitution: self.restitution.to_fx(),
            rolling_resistance: self.rolling_resistance.to_fx(),
            surface_speed: self.surface_speed.to_fx(),
            friction_rule: self.friction_rule,
            restitution_rule: self.restitution_rule,
            id: self.id,
        }
    }
}

impl<S: Scalar> MaterialPair<S> {
    pub(super) fn to_fx(self) -> MaterialPair<Fx> {
        MaterialPair {
            friction: self.friction.to_fx(),
            restitution: self.restitution.to_fx(),
            rolling_resistance: self.rolling_resistance.to_fx(),
        }
    }
}

impl<S: Scalar> ContactSettings<S> {
    /// The settings with all speeds rounded to nearest.
    pub(crate) fn to_fx(self) -> ContactSettings<Fx> {
        ContactSettings {
            substeps: self.substeps,
            push_speed: self.push_speed.to_fx(),
            restitution_speed: self.restitution_speed.to_fx(),
            sleep_speed: self.sleep_speed.to_fx(),
            hit_speed: self.hit_speed.to_fx(),
            max_pairs: self.max_pairs,
            max_pairs_per_collider: self.max_pairs_per_collider,
        }
    }
}
