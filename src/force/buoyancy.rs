//! Fluids: the lift of a body, and which bodies float.

use super::submerged::{Submerged, submerged};
use super::{FieldKind, FieldSet};
use crate::body::{Bodies, Sparse};
use crate::collider::ColliderSet;
use crate::math::Vec2;
use crate::scalar::{Accumulator, Factor, Offset, Scalar, Sum, Wide};
use crate::shape::Aabb;
use crate::slots::FieldId;

/// Parts of bodies in fluids that were computed already, by the index of the body: at most once for a body as long as it does not move, if
/// it is in one fluid. A body in several fluids has its part in the last one here.
pub(crate) type Parts<S> = Sparse<(usize, (FieldId, Option<Submerged<S>>))>;

/// The fields, and the colliders that fluids act on.
pub(crate) struct Fluids<'a, S: Scalar> {
    pub(crate) fields: &'a FieldSet<S>,
    pub(crate) colliders: &'a ColliderSet<S>,
    pub(crate) parts: &'a mut Parts<S>,
}

impl<S: Scalar> Parts<S> {
    /// The part of body `i` in the box of a fluid, if there is one.
    pub(super) fn of(
        &mut self,
        bodies: &Bodies<S>,
        colliders: &ColliderSet<S>,
        i: usize,
        fluid: FieldId,
        bounds: Aabb<S>,
    ) -> Option<Submerged<S>> {
        let compute = || {
            let motion = &bodies.columns.motion;
            let own_colliders = colliders.solid_of_slot(bodies.columns.slot[i]);
            submerged(own_colliders, motion.position.get(i).map(Accumulator::value), motion.angle[i], bounds)
        };
        let (_, (cached, part)) = self.get_or_insert(i, || (i, (fluid, compute())));
        if *cached != fluid {
            (*cached, *part) = (fluid, compute());
        }
        *part
    }
}

/// At least the area of the colliders of a body that displace a fluid, m²: that of the boxes around them.
pub(super) fn whole_area<S: Scalar>(bodies: &Bodies<S>, colliders: &ColliderSet<S>, i: usize) -> S::Factor {
    let mut sum = S::Sum::default();
    for collider in colliders.solid_of_slot(bodies.columns.slot[i]).filter(|collider| !collider.def.shape.is_chain()) {
        for part in 0..collider.outline_count() {
            let bounds = collider.outline(part).outline.bounds();
            sum.add((bounds.max.x - bounds.min.x).product(bounds.max.y - bounds.min.y));
        }
    }
    sum.total().map_or(S::Factor::from_ratio(u64::MAX, 1), S::Factor::from_wide)
}

/// The lift of a part of a body, −density·area·gravity, and its torque about the centre of mass; `None` if either does not fit.
pub(super) fn lift<S: Scalar>(part: &Submerged<S>, density: S, gravity: Vec2<S>) -> Option<(Offset<S>, S::Wide)> {
    let density = S::Factor::from_scalar(density);
    let scaled = |value: S::Wide, factor: S| {
        let product = value.times(density)?.times(S::Factor::from_scalar(factor))?;
        Some(if factor < S::ZERO { product } else { product.negated() })
    };
    let (area, moments) = (part.area.total()?, part.moments.try_map(Sum::total)?);
    let force = Vec2::new(scaled(area, gravity.x)?, scaled(area, gravity.y)?);
    let torque = scaled(moments.x, gravity.y)?.plus(scaled(moments.y, gravity.x)?.negated())?;
    Some((force, torque))
}

/// Returns true if a body has a part in fluids, and none of them flows.
pub(crate) fn floats<S: Scalar>(fluids: &mut Fluids<'_, S>, bodies: &Bodies<S>, i: usize) -> bool {
    let info = bodies.info(i);
    let mut floats = false;
    for (id, field) in fluids.fields.iter() {
        let FieldKind::Buoyancy { min, max, flow, .. } = &field.kind else { continue };
        if !info.feels(field.force_groups) {
            continue;
        }
        let bounds = Aabb { min: *min, max: *max };
        if fluids.parts.of(bodies, fluids.colliders, i, id, bounds).is_some() {
            if *flow != Vec2::ZERO {
                return false;
            }
            floats = true;
        }
    }
    floats
}
