//! The ways in which colliders hold others, for drawings to tell them apart.

use umbra_physics::{ColliderDef, Scalar};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Surface {
    /// A collider that holds from all sides.
    Solid,
    /// A collider that holds nothing.
    Sensor,
    /// A collider that holds from one side.
    OneWay,
    /// A collider that holds, and carries along.
    Belt,
}

impl Surface {
    pub(crate) fn of<S: Scalar>(def: &ColliderDef<S>) -> Self {
        if def.sensor {
            Self::Sensor
        } else if def.one_way.is_some() {
            Self::OneWay
        } else if def.material.surface_speed != S::ZERO {
            Self::Belt
        } else {
            Self::Solid
        }
    }
}
