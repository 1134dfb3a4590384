//! Images of worlds.

use alloc::sync::Arc;

use super::{FAR, Symmetry};
use crate::body::mass_properties;
use crate::fx::Fx;
use crate::math::Vec2;
use crate::scalar::{Accumulator as _, FxAccumulator, FxSum, Number as _};
use crate::world::World;

impl Symmetry {
    /// The image of a world, with the same handles. What the game keeps in it, its generator, its blob and the bodies' data,
    /// is as it was. None where a custom force acts, or a body is more than 2^29 m out and would be shifted.
    #[must_use]
    pub fn world(&self, world: &World) -> Option<World> {
        let mut image = world.clone();
        image.def.gravity = self.vector(world.def.gravity)?;
        Arc::make_mut(&mut image.factor_table).change_all();
        for i in 0..image.bodies.len() {
            self.take(&mut image, i)?;
        }
        let fields = Arc::make_mut(&mut image.fields);
        for (id, field) in world.fields.iter() {
            fields.replace(id, self.field(field)?).ok()?;
        }
        image.applied.clear();
        for row in world.applied.rows() {
            let force = self.signed(row.force, |sum| Some(opposite(sum)))?;
            let torque = if self.mirrors() { opposite(row.torque) } else { row.torque };
            image.applied.adopt(row.body, force, torque);
        }
        for (_, target) in image.targets.rows_mut() {
            if let Some(goal) = &mut target.goal {
                (goal.position, goal.angle) = (self.point(goal.position)?, self.turn(goal.angle));
            }
        }
        image.bodies.changes_mut().note_all();
        Some(image)
    }

    /// Makes of the body at an index in the columns its image.
    fn take(&self, world: &mut World, i: usize) -> Option<()> {
        let negative = |a: FxAccumulator| Some(a.negated());
        let motion = &mut world.bodies.columns.motion;
        let position = motion.position.get(i);
        let is_near = |c: FxAccumulator| self.shift == Vec2::ZERO || c.is_within(FAR);
        if !(is_near(position.x) && is_near(position.y)) {
            return None;
        }
        let position = self.signed(position, negative)?;
        let moved = |c: FxAccumulator, by: Fx| c.plus(FxAccumulator::from_scalar(by));
        motion.position.set(i, Vec2::new(moved(position.x, self.shift.x), moved(position.y, self.shift.y)));
        motion.velocity.set(i, self.signed(motion.velocity.get(i), negative)?);
        motion.angle[i] = self.turn(motion.angle[i]);
        if self.mirrors() {
            motion.angular_velocity[i] = motion.angular_velocity[i].negated();
        }
        if let Some(last) = motion.last_acceleration.get_mut(i) {
            last.linear = self.signed(last.linear, |wide| Some(wide.negated()))?;
            if self.mirrors() {
                last.angular = last.angular.negated();
            }
        }
        let locks = world.bodies.mass(i).locks;
        if self.locks(locks) != locks {
            world.bodies.set_locks(i, Arc::make_mut(&mut world.factor_table), self.locks(locks));
        }
        let info = world.bodies.info(i);
        if let Some(shape) = info.shape.as_deref().filter(|_| self.mirrors()) {
            let (kind, mass, shape) = (info.kind, info.mass, self.shape(shape)?);
            let properties = mass_properties(kind, mass, Some(&shape), self.locks(locks)).ok()?;
            world.bodies.set_shape(i, Some(shape), properties);
        }
        Some(())
    }
}

/// The sum on the other side of zero.
fn opposite(sum: FxSum) -> FxSum {
    let [carries, high, low] = sum.to_words();
    // Carries count 2^128, and what is beside them has a sign; its least value is its own opposite, a carry off.
    let rest = u128::from(high) << 64 | u128::from(low);
    let carries = carries.wrapping_neg().wrapping_add(u64::from(rest == 1 << 127));
    let rest = rest.wrapping_neg();
    FxSum::from_words([carries, (rest >> 64) as u64, rest as u64])
}
