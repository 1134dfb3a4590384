//! The walk over a world that gives a snapshot its bytes, and comparisons their fields.

use alloc::collections::BTreeMap;
use alloc::vec::Vec;
use core::fmt::Display;

use super::hash::PHYSICS_VERSION;
use crate::body::{KinematicTarget, Record};
use crate::codec::{self, Encoder, Malformed, Part, Read, Reader, StateHasher, Write};
use crate::collider::ColliderSet;
use crate::contact::ContactSet;
use crate::force::FieldSet;
use crate::fx::Fx;
use crate::joint::{JointSet, JointStates};
use crate::math::{Elapsed, Vec2};
use crate::scalar::{FxSum, Scalar};
use crate::slots::BodyId;
use crate::world::{World, WorldDef};

/// The first bytes of a snapshot.
pub(super) const MAGIC: [u8; 8] = *b"UMBRASNP";
/// The number of the format, in the four bytes after the magic. It is increased whenever the layout changes.
pub(super) const FORMAT: u32 = 8;

/// A world as the bytes of a snapshot.
pub(in crate::replay) struct Saved<'a, S: Scalar>(pub(in crate::replay) &'a World<S>);

impl<S: Scalar> Write for Saved<'_, S> {
    fn write(&self, out: &mut impl Encoder) {
        let mut sealed = Sealed { out, seal: StateHasher::new() };
        sealed.enter(Part::Name("magic"));
        sealed.bytes(&MAGIC);
        sealed.leave();
        codec::field(&mut sealed, "format", &FORMAT);
        codec::field(&mut sealed, "physics_version", &PHYSICS_VERSION);
        State(self.0).write(&mut sealed);
        codec::field(&mut sealed, "hash", &self.0.state_hash());
        let Sealed { out, seal } = sealed;
        codec::field(out, "seal", &seal.finish());
    }
}

/// An encoder that hands its bytes on, and hashes them.
struct Sealed<'a, E> {
    out: &'a mut E,
    seal: StateHasher,
}

impl<E: Encoder> Encoder for Sealed<'_, E> {
    #[inline]
    fn bytes(&mut self, bytes: &[u8]) {
        self.seal.bytes(bytes);
        self.out.bytes(bytes);
    }

    #[inline]
    fn enter(&mut self, part: Part) {
        self.out.enter(part);
    }

    #[inline]
    fn leave(&mut self) {
        self.out.leave();
    }

    #[inline]
    fn leaf(&mut self, bytes: &[u8], value: &dyn Display) {
        self.seal.bytes(bytes);
        self.out.leaf(bytes, value);
    }
}

/// The state of a world: all that its future depends on, body by body.
pub(in crate::replay) struct State<'a, S: Scalar>(pub(in crate::replay) &'a World<S>);

impl<S: Scalar> Write for State<'_, S> {
    fn write(&self, out: &mut impl Encoder) {
        StateView::of(self.0).write(out);
    }
}

/// A slot for a body, as a snapshot has it.
#[derive(Clone, Debug)]
pub(super) struct SavedSlot<S: Scalar> {
    pub(super) generation: u32,
    pub(super) body: Option<SavedBody<S>>,
}

/// The state of a body, as a snapshot has it.
#[derive(Clone, Debug)]
pub(super) struct SavedBody<S: Scalar> {
    pub(super) record: Record<S>,
    applied: Option<AppliedSums<S>>,
    target: Option<KinematicTarget<S>>,
}

impl<S: Scalar> SavedSlot<S> {
    /// The slot with this number, if the world has so many.
    pub(super) fn of(world: &World<S>, slot: u32) -> Option<Self> {
        let generation = world.bodies.generation(slot)?;
        let body = BodyId::from_parts(slot, generation);
        let saved = |dense: usize| SavedBody {
            record: world.bodies.record(dense, &world.factor_table),
            applied: world.applied.row(body).map(|row| AppliedSums { force: row.force, torque: row.torque }),
            target: world.targets.of(body).copied(),
        };
        Some(Self { generation, body: world.bodies.find(body).ok().map(saved) })
    }

    fn write(&self, out: &mut impl Encoder) {
        codec::field(out, "generation", &self.generation);
        codec::field(out, "present", &self.body.is_some());
        let Some(SavedBody { record, applied, target }) = &self.body else { return };
        record.write(out);
        codec::field(out, "applied", applied);
        codec::field(out, "kinematic_target", target);
    }
}

/// The parts of a world's state: those of the world as it is, some of which [`BeforeCalls`](super::before::BeforeCalls)
/// replaces by those the world had.
pub(super) struct StateView<'a, S: Scalar> {
    pub(super) world: &'a World<S>,
    pub(super) def: &'a WorldDef<S>,
    pub(super) counted: (Elapsed, u64),
    /// The number of slots for bodies.
    pub(super) slots: u32,
    /// The slots that are replaced.
    pub(super) replaced: Option<&'a BTreeMap<u32, SavedSlot<S>>>,
    pub(super) free: &'a [u32],
    pub(super) fields: &'a FieldSet<S>,
    pub(super) colliders: &'a ColliderSet<S>,
    pub(super) contacts: &'a ContactSet,
    pub(super) joints: &'a JointSet<S>,
    pub(super) joint_states: &'a JointStates,
    pub(super) sleep_changes: Vec<BodyId>,
}

impl<'a, S: Scalar> StateView<'a, S> {
    pub(super) fn of(world: &'a World<S>) -> Self {
        Self {
            world,
            def: &world.def,
            counted: world.counted,
            slots: world.bodies.slots().len() as u32,
            replaced: None,
            free: world.bodies.free(),
            fields: &world.fields,
            colliders: &world.colliders,
            contacts: &world.contacts,
            joints: &world.joints,
            joint_states: &world.joint_states,
            sleep_changes: world.change_log.sleep_changes(&world.bodies),
        }
    }

    fn write_bodies(&self, out: &mut impl Encoder) {
        codec::count(out, self.slots as usize);
        for slot in 0..self.slots {
            entry(out, slot, |out| match self.replaced.and_then(|replaced| replaced.get(&slot)) {
                Some(saved) => saved.write(out),
                None => SavedSlot::of(self.world, slot).into_iter().for_each(|saved| saved.write(out)),
            });
        }
    }

    fn write_colliders(&self, out: &mut impl Encoder) {
        codec::count(out, self.colliders.slots().len());
        for (slot, (generation, collider)) in (0..).zip(self.colliders.slots()) {
            entry(out, slot, |out| {
                codec::field(out, "generation", &generation);
                codec::field(out, "present", &collider.is_some());
                if let Some(collider) = collider {
                    codec::field(out, "body", &collider.body);
                    collider.def.write(out);
                }
            });
        }
    }

    fn write_fields(&self, out: &mut impl Encoder) {
        codec::count(out, self.fields.slots().len());
        for (slot, (generation, field)) in (0..).zip(self.fields.slots()) {
            entry(out, slot, |out| {
                codec::field(out, "generation", &generation);
                codec::field(out, "field", &field.copied());
            });
        }
    }

    fn write_joints(&self, out: &mut impl Encoder) {
        codec::count(out, self.joints.slots().len());
        for (slot, (generation, index)) in (0..).zip(self.joints.slots()) {
            entry(out, slot, |out| {
                codec::field(out, "generation", &generation);
                codec::field(out, "present", &index.is_some());
                if let Some(index) = index {
                    let def = self.joints.def(index);
                    def.write(out);
                    let state = &self.joint_states.list[index];
                    out.enter(Part::Name("state"));
                    state.write(&def.kind, out);
                    out.leave();
                }
            });
        }
    }

    fn write_custom_forces(&self, out: &mut impl Encoder) {
        codec::count(out, self.world.custom_forces.len());
        for (index, force) in (0..).zip(self.world.custom_forces.values()) {
            entry(out, index, |out| {
                codec::field(out, "id", &force.id());
                codec::field(out, "version", &force.version());
            });
        }
    }
}

impl<S: Scalar> Write for StateView<'_, S> {
    fn write(&self, out: &mut impl Encoder) {
        let world = self.world;
        codec::field(out, "settings", self.def);
        codec::field(out, "tick", &world.tick);
        let (elapsed, since) = &self.counted;
        codec::field(out, "elapsed", elapsed);
        codec::field(out, "elapsed_at_tick", since);
        codec::field(out, "moved_at_tick", &world.targets.moved_at);
        codec::field(out, "random", &world.random);
        codec::field(out, "blob", &world.blob);
        part(out, "custom_forces", |out| self.write_custom_forces(out));
        part(out, "colliders", |out| self.write_colliders(out));
        part(out, "free_colliders", |out| codec::list(out, self.colliders.free().iter()));
        part(out, "material_pairs", |out| codec::list(out, self.colliders.material_pairs().iter()));
        part(out, "bodies", |out| self.write_bodies(out));
        part(out, "free_slots", |out| codec::list(out, self.free.iter()));
        part(out, "fields", |out| self.write_fields(out));
        part(out, "free_fields", |out| codec::list(out, self.fields.free().iter()));
        part(out, "fields_by_age", |out| codec::list(out, self.fields.ages().iter()));
        codec::field(out, "pushed_at_tick", &self.contacts.pushed_at);
        part(out, "contacts", |out| codec::list(out, self.contacts.all().iter()));
        part(out, "one_way_pairs", |out| codec::list(out, self.contacts.passes.iter()));
        part(out, "excluded_pairs", |out| codec::list(out, self.contacts.excluded.iter()));
        part(out, "sensor_overlaps", |out| codec::list(out, self.contacts.overlaps.iter()));
        part(out, "ended_pairs", |out| codec::list(out, self.contacts.ended.iter()));
        part(out, "joints", |out| self.write_joints(out));
        part(out, "free_joints", |out| codec::list(out, self.joints.free().iter()));
        codec::field(out, "pulled_at_tick", &self.joint_states.pulled_at);
        part(out, "sleep_changes", |out| codec::list(out, self.sleep_changes.iter()));
    }
}

fn part<O: Encoder>(out: &mut O, name: &'static str, write: impl FnOnce(&mut O)) {
    out.enter(Part::Name(name));
    write(out);
    out.leave();
}

fn entry<O: Encoder>(out: &mut O, index: u32, write: impl FnOnce(&mut O)) {
    out.enter(Part::Entry(index));
    write(out);
    out.leave();
}

/// The sums of the forces and torques that were applied to a body since the last step.
#[derive(Clone, Debug)]
pub(super) struct AppliedSums<S: Scalar> {
    pub(super) force: Vec2<S::Sum>,
    pub(super) torque: S::Sum,
}

impl<S: Scalar> Write for AppliedSums<S> {
    fn write(&self, out: &mut impl Encoder) {
        codec::field(out, "force", &self.force);
        codec::field(out, "torque", &self.torque);
    }
}

impl Read for AppliedSums<Fx> {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        Ok(Self { force: Vec2::read(reader)?, torque: FxSum::read(reader)? })
    }
}
