//! The coefficients of two surfaces that touch, mixed once for each pair of materials of a step.

use alloc::vec::Vec;

use super::Scene;
use crate::collider::{Material, MaterialPair};
use crate::fx::Fx;

/// The coefficients of a contact.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Coefficients {
    pub(super) materials: MaterialPair,
    /// The velocity of the second surface against the first one along the tangent, m/s.
    pub(super) surface_speed: Fx,
}

impl Coefficients {
    /// The coefficients of two surfaces.
    pub(super) fn new(scene: &Scene<'_>, [first, second]: [&Material; 2]) -> Self {
        let defined = if scene.colliders.material_pairs().is_empty() {
            None
        } else {
            scene.colliders.material_pair([first.id, second.id]).copied()
        };
        let materials = defined.unwrap_or_else(|| first.mixed(second));
        Self { materials, surface_speed: first.surface_speed_against(second) }
    }
}

/// The number of materials whose coefficients are kept.
pub(super) const KEPT: usize = 16;

/// The materials of a step, each with a number, and the coefficients of all pairs of these.
#[derive(Debug, Default)]
pub(super) struct Materials {
    materials: Vec<Material>,
    /// By the number of the first and of the second material.
    pairs: Vec<[Coefficients; KEPT]>,
}

impl Materials {
    pub(super) fn clear(&mut self) {
        self.materials.clear();
    }

    /// Numbers the first materials of a step in their order. *Domain* they are no more than [`KEPT`].
    pub(super) fn begin(&mut self, scene: &Scene<'_>, materials: &[Material]) {
        self.clear();
        for material in materials {
            self.number(scene, material);
        }
    }

    /// The number of a material; `None` if the step has too many of them.
    pub(super) fn number(&mut self, scene: &Scene<'_>, material: &Material) -> Option<u8> {
        let count = self.materials.len();
        if let Some(number) = self.materials.iter().position(|known| known == material) {
            return Some(number as u8);
        }
        if count == KEPT {
            return None;
        }
        self.pairs.resize(KEPT, [Coefficients::default(); KEPT]);
        self.materials.push(*material);
        for (number, known) in self.materials.iter().enumerate() {
            self.pairs[number][count] = Coefficients::new(scene, [known, material]);
            self.pairs[count][number] = Coefficients::new(scene, [material, known]);
        }
        Some(count as u8)
    }

    /// The coefficients of two materials by their numbers.
    #[inline(always)]
    pub(super) fn coefficients(&self, [first, second]: [u8; 2]) -> &Coefficients {
        &self.pairs[usize::from(first)][usize::from(second)]
    }
}
