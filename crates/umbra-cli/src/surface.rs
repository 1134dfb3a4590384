//! How colliders hold others, for drawings to tell them apart.

use umbra_physics::{ColliderDef, Scalar};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Surface {
    /// It holds from all sides.
    Solid,
    /// It holds nothing.
    Sensor,
    /// It holds from one side.
    OneWay,
    /// It holds, and carries along.
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
