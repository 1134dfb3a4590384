//! The state that calls are about to change, kept so that the world as the last step left it can still be saved.
//!
//! A call changes the body or field that it names, the bodies that it wakes, and some settings. These parts alone are kept,
//! not the world: a call costs the recorder a few hundred bytes for each body it changes.

use alloc::collections::BTreeMap;
use alloc::sync::Arc;
use alloc::vec::Vec;

use super::error::SnapshotError;
use super::owner::Owner;
use super::read::read_state;
use super::write::{SavedSlot, StateView};
use crate::body::Activity;
use crate::codec::{Reader, Write as _};
use crate::collider::ColliderSet;
use crate::contact::ContactSet;
use crate::force::FieldSet;
use crate::fx::Fx;
use crate::joint::{JointDef, JointSet, JointStates};
use crate::math::Elapsed;
use crate::slots::BodyId;
use crate::world::{Command, World, WorldDef};

/// The parts of a world that calls changed since its last step, as they were before.
#[derive(Clone, Debug)]
pub(in crate::replay) struct BeforeCalls {
    def: WorldDef,
    counted: (Elapsed, u64),
    /// The number of slots for bodies.
    slots: u32,
    /// The slots of bodies that calls changed.
    replaced: BTreeMap<u32, SavedSlot<Fx>>,
    /// The free slots for bodies, if calls added or removed any.
    free: Option<Vec<u32>>,
    /// The force fields, if calls may have changed any.
    fields: Option<Arc<FieldSet<Fx>>>,
    /// The colliders and their contacts, if calls may have changed any.
    colliders: Option<(Arc<ColliderSet<Fx>>, ContactSet)>,
    /// The joints, if calls may have changed any.
    joints: Option<(Arc<JointSet<Fx>>, JointStates)>,
    /// The bodies that calls had woken or put to sleep.
    sleep_changes: Vec<BodyId>,
}

impl BeforeCalls {
    /// Begins with a world to which no call was made since its last step. `restless` are [`restless_sleepers`].
    pub(in crate::replay) fn new(world: &World, restless: &[BodyId]) -> Self {
        let mut before = Self {
            def: world.def,
            counted: world.counted,
            slots: world.bodies.slots().len() as u32,
            replaced: BTreeMap::new(),
            free: None,
            fields: None,
            colliders: None,
            joints: None,
            sleep_changes: world.change_log.sleep_changes(&world.bodies),
        };
        restless.iter().for_each(|body| before.keep_slot(world, body.slot));
        before
    }

    /// Makes a call, and keeps what it changes.
    pub(in crate::replay) fn during<T>(
        &mut self,
        world: &mut World,
        command: &Command,
        call: impl FnOnce(&mut World) -> T,
    ) -> T {
        self.keep_for(world, command);
        let count = world.change_log.woken_count();
        let result = call(world);
        self.keep_woken(world, count);
        result
    }

    /// Keeps the parts that a command may change, but for the bodies it wakes.
    fn keep_for(&mut self, world: &World, command: &Command) {
        if let Owner::Body(body) = Owner::of_command(command) {
            self.keep_slot(world, body.slot);
        }
        match command {
            Command::AddBody(_) => {
                self.keep_colliders(world);
                world.bodies.free().last().into_iter().for_each(|&slot| self.keep_slot(world, slot));
                self.keep_free(world);
            }
            Command::RemoveBody(body) => {
                // The fields and joints that are attached to the body go with it.
                self.keep_free(world);
                self.keep_fields(world);
                self.keep_colliders(world);
                for joint in world.joints_of(*body).into_iter().flatten() {
                    self.keep_ends(world, joint.def());
                }
                self.keep_joints(world);
            }
            Command::AddCollider { .. } => self.keep_colliders(world),
            Command::SetCollider { collider, .. } | Command::RemoveCollider(collider) => {
                let body = world.collider_body(*collider);
                body.into_iter().for_each(|body| self.keep_slot(world, body.slot));
                self.keep_colliders(world);
            }
            Command::SetMaterialPair { .. } => self.keep_colliders(world),
            Command::SetTimeStep(_) | Command::SetContactSettings(_) => {
                self.keep_colliders(world);
                self.keep_joints(world);
            }
            // An angle that is set changes the whole turns of joints.
            Command::SetKind { .. } | Command::Disable(_) | Command::SetAngle { .. } => self.keep_joints(world),
            Command::AddJoint(def) => {
                self.keep_ends(world, def);
                self.keep_colliders(world);
                self.keep_joints(world);
            }
            Command::RemoveJoint(joint)
            | Command::SetJointKind { joint, .. }
            | Command::SetJointBreak { joint, .. }
            | Command::SetJointBreakTorque { joint, .. }
            | Command::SetJointMotor { joint, .. }
            | Command::EnableJoint { joint, .. } => {
                world.joint(*joint).into_iter().for_each(|joint| self.keep_ends(world, joint.def()));
                self.keep_colliders(world);
                self.keep_joints(world);
            }
            Command::ExcludePair { b, .. } | Command::AllowPair { b, .. } => {
                self.keep_slot(world, b.slot);
                self.keep_colliders(world);
            }
            Command::AddField(_) | Command::SetField { .. } | Command::RemoveField(_) => self.keep_fields(world),
            // These two set a value of every body to zero: the ticks at rest, the last acceleration.
            Command::SetSleepAfter(_) | Command::SetIntegrator(_) => {
                (0..self.slots).for_each(|slot| self.keep_slot(world, slot));
            }
            Command::Explode(explosion) => {
                world.hit_by(explosion).into_iter().for_each(|body| self.keep_slot(world, body.slot));
            }
            Command::Sleep(body) => {
                for member in world.check_sleep(*body).into_iter().flatten() {
                    self.keep_slot(world, member.slot);
                }
            }
            Command::ClearForces => {
                world.applied.rows().iter().for_each(|row| self.keep_slot(world, row.body.slot));
            }
            _ => {}
        }
    }

    fn keep_slot(&mut self, world: &World, slot: u32) {
        if slot < self.slots && !self.replaced.contains_key(&slot) {
            self.replaced.extend(SavedSlot::of(world, slot).map(|saved| (slot, saved)));
        }
    }

    /// Keeps the bodies of a joint, whose ticks at rest are counted anew.
    fn keep_ends(&mut self, world: &World, def: &JointDef) {
        def.bodies().into_iter().flatten().for_each(|body| self.keep_slot(world, body.slot));
    }

    fn keep_joints(&mut self, world: &World) {
        self.joints.get_or_insert_with(|| (world.joints.clone(), world.joint_states.clone()));
    }

    fn keep_free(&mut self, world: &World) {
        self.free.get_or_insert_with(|| world.bodies.free().to_vec());
    }

    fn keep_fields(&mut self, world: &World) {
        self.fields.get_or_insert_with(|| world.fields.clone());
    }

    fn keep_colliders(&mut self, world: &World) {
        self.colliders.get_or_insert_with(|| (world.colliders.clone(), world.contacts.clone()));
    }

    /// Keeps the bodies that a call woke, after the first `count` that calls woke in this tick. Waking changes whether a body
    /// sleeps and nothing else: the ticks at rest of a sleeping body are zero, but for restless sleepers, which are kept.
    fn keep_woken(&mut self, world: &World, count: usize) {
        for body in world.change_log.woken_since(count) {
            if body.slot < self.slots && !self.replaced.contains_key(&body.slot) {
                let mut saved = SavedSlot::of(world, body.slot);
                if let Some(SavedSlot { body: Some(body), .. }) = &mut saved {
                    body.record.activity = Activity::Asleep;
                }
                self.replaced.extend(saved.map(|saved| (body.slot, saved)));
            }
        }
    }

    /// Rebuilds the world as it was before the calls, from the world after them.
    pub(in crate::replay) fn rebuild(&self, after: &World) -> Result<World, SnapshotError> {
        let now = StateView::of(after);
        let view = StateView {
            def: &self.def,
            counted: self.counted,
            slots: self.slots,
            replaced: Some(&self.replaced),
            free: self.free.as_deref().unwrap_or(now.free),
            fields: self.fields.as_deref().unwrap_or(now.fields),
            colliders: self.colliders.as_ref().map_or(now.colliders, |(colliders, _)| colliders),
            contacts: self.colliders.as_ref().map_or(now.contacts, |(_, contacts)| contacts),
            joints: self.joints.as_ref().map_or(now.joints, |(joints, _)| joints),
            joint_states: self.joints.as_ref().map_or(now.joint_states, |(_, states)| states),
            sleep_changes: self.sleep_changes.clone(),
            ..now
        };
        let mut bytes = Vec::new();
        view.write(&mut bytes);
        let custom_forces: Vec<_> = after.custom_forces.values().cloned().collect();
        read_state(&mut Reader::new(&bytes), &custom_forces)
    }
}

/// The sleeping bodies whose count of ticks at rest is not zero. Steps and calls make none: a body that falls asleep has zero.
/// A file may have some, which become fewer until none is left.
pub(in crate::replay) fn restless_sleepers(world: &World) -> Vec<BodyId> {
    let restless = |&dense: &usize| world.bodies.columns.motion.ticks_at_rest[dense] != 0;
    world.bodies.asleep().filter(restless).map(|dense| world.bodies.id(dense)).collect()
}
