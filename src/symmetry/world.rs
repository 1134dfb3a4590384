//! Images of worlds.

use alloc::sync::Arc;

use super::{FAR, Image, Symmetry};
use crate::collider::{ColliderMass, ColliderSet, OutlineId};
use crate::contact::{ContactRecord, OneWayAnswer};
use crate::fx::Fx;
use crate::joint::JointKind;
use crate::math::Vec2;
use crate::scalar::{Accumulator as _, FxAccumulator, FxSum, Number as _};
use crate::shape::{Geometry, Outline, Shape};
use crate::world::{CommandMap as _, World};

impl Symmetry {
    /// The image of a world, with the same handles. The data of the game (generator, blob, user data of bodies) stays as it was.
    /// `None` where a custom force acts, or a body is more than 2^29 m out and would be shifted.
    #[must_use]
    pub fn world(&self, world: &World) -> Option<World> {
        let mut image = world.clone();
        image.def.gravity = self.vector(world.def.gravity)?;
        Arc::make_mut(&mut image.factor_table).change_all();
        self.take_colliders(&mut image, world)?;
        for i in 0..image.bodies.len() {
            self.take(&mut image, i)?;
        }
        let fields = Arc::make_mut(&mut image.fields);
        for (id, field) in world.fields.iter() {
            fields.replace(id, self.field(field)?).ok()?;
        }
        self.take_joints(&mut image, world)?;
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

    /// Makes of joints and their impulses their images.
    fn take_joints(&self, image: &mut World, world: &World) -> Option<()> {
        if world.joints.len() == 0 {
            return Some(());
        }
        let joints = Arc::make_mut(&mut image.joints);
        for index in world.joints.indices() {
            let def = Image(self).joint_def(*world.joints.def(index)).ok()?;
            joints.replace(index, def);
            let state = &mut image.joint_states.list[index];
            let [x, y, torque] = state.impulses;
            let Vec2 { x, y } = match def.kind {
                // Along the line between its ends, and along its rope.
                JointKind::Distance(_) | JointKind::Pulley(_) => Vec2::new(x, y),
                _ if def.kind.has_frame() => self.signed_local(Vec2::new(x, y), i64::checked_neg)?,
                _ => self.signed(Vec2::new(x, y), i64::checked_neg)?,
            };
            state.impulses = [x, y, if self.mirrors() { torque.checked_neg()? } else { torque }];
            if self.mirrors() && def.kind.counts_turns() {
                // Half a turn is the same angle either way round.
                let is_half = world.joint_turn(index).to_bits() == 1 << 63;
                state.turns = i16::from(is_half).checked_sub(state.turns)?;
            }
        }
        Some(())
    }

    /// Makes of colliders and contacts their images. A quarter turn leaves them as they are: the axes of bodies turn along.
    fn take_colliders(&self, image: &mut World, world: &World) -> Option<()> {
        if !self.mirrors() || world.colliders.is_empty() {
            return Some(());
        }
        let set = Arc::make_mut(&mut image.colliders);
        for (id, def) in world.colliders() {
            set.replace(id, Image(self).collider_def(def.clone()).ok()?).ok()?;
        }
        let mut are_all_images = true;
        let colliders = &image.colliders;
        image.contacts.change_all(|record| {
            let image_record = self.contact(record, &world.colliders, colliders);
            are_all_images &= image_record.is_some();
            *record = image_record.unwrap_or(*record);
            true
        });
        for record in &mut image.contacts.passes {
            let (OutlineId { slot, part }, body) = record.place();
            let part = world.colliders.at(slot).map_or(part, |collider| image_of_part(&collider.def.shape, part));
            *record = OneWayAnswer::new(OutlineId { slot, part }, body, record.passes);
        }
        image.contacts.passes.sort_unstable_by_key(OneWayAnswer::place);
        are_all_images.then_some(())
    }

    /// The image of a contact. The segments of a chain are in the opposite order.
    fn contact(
        &self,
        record: &ContactRecord,
        original_set: &ColliderSet<Fx>,
        image_set: &ColliderSet<Fx>,
    ) -> Option<ContactRecord> {
        let pair = record.pair();
        let images = pair.map(|OutlineId { slot, part }| {
            let shape = original_set.at(slot).map(|collider| &collider.def.shape);
            OutlineId { slot, part: shape.map_or(part, |shape| image_of_part(shape, part)) }
        });
        let outlines = [0, 1].map(|side| {
            let original = own_outline(&original_set.at(pair[side].slot)?.def.shape, pair[side].part)?;
            let image = &image_set.at(images[side].slot)?.def.shape;
            Some((original, own_outline(image, images[side].part)?))
        });
        let corner = |side: usize, number: usize| {
            let (original, image) = outlines[side]?;
            let place = self.local(*original.corners().get(number)?)?;
            image.corners().iter().position(|corner| *corner == place)
        };
        record.mirrored(images, corner)
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
        let moved = |c: FxAccumulator, offset: Fx| c.plus(FxAccumulator::from_scalar(offset));
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
        if self.mirrors() && !info.collider_mass().is_none() {
            let definitions = world.colliders.of(world.bodies.id(i)).map(|collider| &collider.def);
            let colliders = ColliderMass::of(definitions);
            let properties = info.mass.properties(&colliders, info.kind, self.locks(locks)).ok()?;
            world.bodies.set_collider_mass(i, colliders, properties);
        }
        Some(())
    }
}

/// An outline in the axes of the shape that it is of: of a compound the part's.
fn own_outline(shape: &Shape, part: u32) -> Option<&Outline> {
    match shape.geometry() {
        Geometry::Compound { parts } => parts.get(part as usize)?.shape.outlines().first(),
        _ => shape.outlines().get(part as usize),
    }
}

/// The number that an outline has in a mirror image of its shape: a chain goes through its points in the opposite order.
fn image_of_part(shape: &Shape, part: u32) -> u32 {
    match shape.geometry() {
        Geometry::Chain { points, .. } => {
            // The segment that closes a chain stays the last one.
            let joins = points.len() as u32 - 1;
            if part < joins { joins - 1 - part } else { part }
        }
        _ => part,
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::BodyDef;
    use crate::cases::run_seed;
    use crate::collide::{Manifold, Pose, collide};
    use crate::collider::ColliderDef;
    use crate::fx;
    use crate::math::{Random, vec2};
    use crate::solve::Impulses;
    use crate::world::WorldDef;

    /// The manifold of the colliders in slots 0 and 1.
    fn manifold(world: &World) -> Option<Manifold> {
        let [a, b] = [0, 1].map(|slot| world.colliders.at(slot).expect("it is there"));
        let [at, bt] = [a, b].map(|collider| {
            let body = world.body(collider.body).expect("it is there");
            Pose::new(body.position(), body.angle_exact())
        });
        collide(&a.outline(0).outline, &at, &b.outline(0).outline, &bt, Fx::ZERO)
    }

    fn record(manifold: &Manifold, values: [i64; 3]) -> ContactRecord {
        let features = manifold.points.map(|point| point.feature);
        let pair = [0, 1].map(|slot| OutlineId { slot, part: 0 });
        ContactRecord::new(pair, features, manifold.count, Impulses { values, exponent: -9 })
    }

    #[test]
    fn the_record_of_an_image_has_the_features_of_the_image() {
        let mut random = Random::seeded(run_seed(3));
        let mut met = [0; 3];
        for run in 0..600 {
            let mut world = World::new(WorldDef::default()).expect("a world");
            let mut number = |max: i32| random.number(Fx::from(-max)..=Fx::from(max));
            for _ in 0..2 {
                let corners = [(); 5].map(|()| vec2(number(2), number(2)));
                let shape = match run % 3 {
                    0 => Shape::polygon(&corners[..3]).or_else(|_| Shape::capsule(fx!(1), fx!(0.5))),
                    1 => Shape::rectangle(fx!(2), fx!(1)),
                    _ => Shape::capsule(fx!(2), fx!(0.5)),
                };
                // Every other pair is parallel: two points.
                let angle = if run % 2 == 0 { Fx::ZERO } else { number(3) };
                let def = ColliderDef {
                    position: vec2(number(1), number(1)),
                    angle: number(1),
                    ..ColliderDef::new(shape.expect("a shape"))
                };
                let def = if run % 2 == 0 { ColliderDef::new(def.shape) } else { def };
                let body = BodyDef { position: vec2(number(1), number(1)), angle, ..BodyDef::dynamic() };
                world.add_body(body.with_collider(def)).expect("a body");
            }
            let Some(here) = manifold(&world) else { continue };
            let values = if here.count == 2 { [5, 3, -7] } else { [5, 0, -7] };
            world.contacts.records = [record(&here, values)].to_vec();
            for symmetry in [Symmetry::MIRROR, Symmetry::FLIP, Symmetry::DIAGONAL, Symmetry::TURN] {
                let image = symmetry.world(&world).expect("it has an image");
                let image_manifold = manifold(&image).expect("they meet there too");
                let [a, b, tangent] = values;
                let values = match (symmetry.mirrors(), image_manifold.count) {
                    (false, _) => values,
                    (true, 2) => [b, a, -tangent],
                    (true, _) => [a, b, -tangent],
                };
                assert_eq!(image.contacts.records, [record(&image_manifold, values)], "run {run}: {}", symmetry.name());
                met[image_manifold.count] += 1;
                // It goes on from there: what is set in both worlds is the same.
                assert!(image.colliders().all(|(id, def)| {
                    Image(&symmetry)
                        .collider_def(world.collider(id).expect("the same handles").clone())
                        .is_ok_and(|image| image == *def)
                }));
            }
        }
        assert!(met[1] > 200 && met[2] > 200, "{met:?}");
    }
}
