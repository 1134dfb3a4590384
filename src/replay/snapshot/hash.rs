//! Hashes of a world's state over a canonical sequence of little-endian bytes, the same on every machine.

use alloc::vec::Vec;
use core::cmp::Ordering;

use crate::codec::{self, StateHasher, Write as _};
use crate::contact::ContactRecord;
use crate::scalar::Scalar;
use crate::slots::BodyId;
use crate::world::{BodyRef, World};

/// The physics version: it is increased whenever the results of a step or of a hash change.
pub const PHYSICS_VERSION: u32 = 34;

impl<S: Scalar> World<S> {
    /// A hash of the whole state that the future depends on, handles included: for peers that made the same calls. Equal
    /// worlds have equal hashes on every machine; derived and cached values are not part of it.
    ///
    /// *Source* XXH3, 64 bits (Collet).
    #[doc(alias = "checksum")]
    #[must_use]
    pub fn state_hash(&self) -> u64 {
        S::state_hash(self)
    }

    pub(crate) fn state_hash_inner(&self) -> u64 {
        let mut sink = StateHasher::new();
        PHYSICS_VERSION.write(&mut sink);
        self.def.write(&mut sink);
        self.tick.write(&mut sink);
        self.elapsed().write(&mut sink);
        self.random.write(&mut sink);
        self.blob.write(&mut sink);
        self.bodies.write(&mut sink, &self.factor_table);
        self.applied.write(&mut sink);
        self.targets.write(&mut sink);
        self.fields.write(&mut sink);
        self.colliders.write(&mut sink);
        self.contacts.write(&mut sink);
        codec::count(&mut sink, self.custom_forces.len());
        self.hash_custom_forces(&mut sink);
        self.joints.write(&self.joint_states, &mut sink);
        sink.finish()
    }

    /// A hash of the motion alone, bodies by their [`key`](crate::BodyDef::key), no handles: for worlds with the same bodies
    /// and fields that were built in another order. Each body should have a key of its own; bodies that share one are
    /// told apart by their state alone.
    ///
    /// The hash covers settings and time, the bodies and their motion, the applied forces, contacts, joints by their keys and those of their
    /// bodies, and the fields: drags in the order they act in, other fields in any order. The random generator and the blob belong to the game and are left out.
    ///
    /// *Source* XXH3, 64 bits (Collet).
    ///
    /// ```
    /// use umbra_physics::{BodyDef, World, WorldDef, vec2};
    ///
    /// let bodies = [1, 2].map(|key| BodyDef { key, velocity: vec2(key as i32, 0), ..BodyDef::dynamic() });
    /// let [mut a, mut b] = [World::new(WorldDef::default())?, World::new(WorldDef::default())?];
    /// bodies.iter().try_for_each(|def| a.add_body(def.clone()).map(drop))?;
    /// bodies.iter().rev().try_for_each(|def| b.add_body(def.clone()).map(drop))?;
    /// _ = (a.step(), b.step());
    /// assert_eq!(a.physics_hash(), b.physics_hash());
    /// assert_ne!(a.state_hash(), b.state_hash()); // other handles
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[must_use]
    pub fn physics_hash(&self) -> u64 {
        S::physics_hash(self)
    }

    pub(crate) fn physics_hash_inner(&self) -> u64 {
        let mut sink = StateHasher::new();
        PHYSICS_VERSION.write(&mut sink);
        self.def.write(&mut sink);
        self.tick.write(&mut sink);
        self.elapsed().write(&mut sink);
        let mut bodies: Vec<(u64, u64)> = self.bodies.in_order().map(|dense| self.motion_of(dense)).collect();
        bodies.sort_unstable();
        sink.all(&bodies, |(_, digest)| digest.to_le_bytes());
        let by_key = |body| {
            let key = self.bodies.info(self.bodies.find(body).ok()?).key;
            Some(BodyId::from_parts(key as u32, (key >> 32) as u32))
        };
        let (mut drags, mut others) = (Vec::new(), Vec::new());
        for (_, field) in self.fields.iter() {
            let digest = field.map_bodies(by_key).map_or(0, |field| StateHasher::of(&field));
            if field.kind.has_drag() { drags.push(digest) } else { others.push(digest) }
        }
        others.sort_unstable();
        for digests in [drags, others] {
            codec::count(&mut sink, digests.len());
            sink.all(&digests, u64::to_le_bytes);
        }
        self.hash_custom_forces(&mut sink);
        self.colliders.write_material_pairs(&mut sink);
        self.hash_contacts(&mut sink);
        self.hash_joints(&mut sink);
        sink.finish()
    }

    /// Hashes the joints by the keys of their bodies and their own, in no order, if there are any.
    fn hash_joints(&self, sink: &mut StateHasher) {
        if self.joints.len() == 0 && self.joint_states.pulled_at == 0 {
            return;
        }
        let key = |body: Option<BodyId>| {
            let dense = body.and_then(|body| self.bodies.find(body).ok());
            dense.map(|dense| self.bodies.info(dense).key)
        };
        let without_handle = |_| Some(BodyId::from_parts(0, 0));
        let digest = |index: usize| {
            let def = self.joints.def(index);
            let mut sink = StateHasher::new();
            def.map_bodies(without_handle).write(&mut sink);
            self.joint_states.list[index].write(&def.kind, &mut sink);
            let [first, second] = def.bodies().map(key);
            (first, second, def.key, sink.finish())
        };
        let mut digests: Vec<_> = self.joints.indices().map(digest).collect();
        digests.sort_unstable();
        self.joint_states.pulled_at.write(sink);
        codec::count(sink, digests.len());
        for (first, second, key, digest) in digests {
            first.write(sink);
            second.write(sink);
            key.write(sink);
            digest.write(sink);
        }
    }

    /// Hashes the contacts by the keys of the colliders, without their number.
    fn hash_contacts(&self, sink: &mut StateHasher) {
        self.contacts.pushed_at.write(sink);
        let key = |slot: u32| self.colliders.at(slot).map_or(0, |collider| collider.def.key);
        let contact_digest = |record: &ContactRecord| {
            let keys = record.pair().map(|outline| key(outline.slot));
            let digest = |record: ContactRecord| {
                let mut sink = StateHasher::new();
                record.write_impulses(&mut sink);
                sink.finish()
            };
            // Whichever slot is the lower one: the contact is hashed from the collider with the lower key; of equal keys, from the side
            // with the lower digest.
            let digest = match keys[0].cmp(&keys[1]) {
                Ordering::Less => digest(*record),
                Ordering::Greater => digest(record.swapped()),
                Ordering::Equal => digest(*record).min(digest(record.swapped())),
            };
            (keys[0].min(keys[1]), keys[0].max(keys[1]), digest)
        };
        let mut contacts: Vec<(u64, u64, u64)> = self.contacts.iter().map(contact_digest).collect();
        contacts.sort_unstable();
        for (first, second, digest) in contacts {
            [first, second, digest].iter().for_each(|word| word.write(sink));
        }
        self.hash_pairs(sink);
    }

    /// Hashes the answers of one-way colliders, the excluded pairs, and what overlaps sensors or was ended, by the keys of colliders and
    /// bodies.
    fn hash_pairs(&self, sink: &mut StateHasher) {
        let of_body = |slot: u32| self.bodies.index_in(slot).map_or(0, |dense| self.bodies.info(dense).key);
        let of_collider = |slot: u32| self.colliders.at(slot).map_or(0, |collider| collider.def.key);
        let one_way = self.contacts.passes.iter().map(|record| {
            let (outline, body) = record.place();
            (of_collider(outline.slot), of_body(body), u64::from(outline.part) << 1 | u64::from(record.passes))
        });
        let excluded = self.contacts.excluded.iter().map(|pair| {
            let [a, b] = pair.bodies.map(of_body);
            (a.min(b), a.max(b), pair.exclusion as u64)
        });
        let overlaps = self.contacts.overlaps.iter().map(|overlap| {
            let [sensor, visitor] = overlap.slots().map(of_collider);
            (sensor, visitor, 0)
        });
        let ended = self.contacts.ended.iter().map(|ended| {
            let ([first, second], [of_first, of_second]) = (ended.pair.collider_keys, ended.pair.body_keys);
            let mut sink = StateHasher::new();
            of_first.write(&mut sink);
            of_second.write(&mut sink);
            ended.is_sensor.write(&mut sink);
            (first, second, sink.finish())
        });
        for mut pairs in [one_way.collect::<Vec<_>>(), excluded.collect(), overlaps.collect(), ended.collect()] {
            pairs.sort_unstable();
            codec::count(sink, pairs.len());
            pairs.iter().for_each(|&(a, b, state)| [a, b, state].iter().for_each(|word| word.write(sink)));
        }
    }

    /// Hashes the registered custom forces, without their number.
    fn hash_custom_forces(&self, sink: &mut StateHasher) {
        for force in self.custom_forces.values() {
            force.id().write(sink);
            force.version().write(sink);
        }
    }

    /// The key of a body, and a hash of everything that belongs to it except its handle.
    fn motion_of(&self, dense: usize) -> (u64, u64) {
        let mut sink = StateHasher::new();
        self.bodies.record(dense, &self.factor_table).write(&mut sink);
        let row = self.applied.row(self.bodies.id(dense));
        let (force, torque) = row.map_or_else(Default::default, |row| (row.force, row.torque));
        force.write(&mut sink);
        torque.write(&mut sink);
        self.targets.of(self.bodies.id(dense)).copied().write(&mut sink);
        let keyed =
            self.colliders.of(self.bodies.id(dense)).map(|collider| (collider.def.key, collider.physics_digest));
        let mut digests: Vec<(u64, u64)> = keyed.collect();
        digests.sort_unstable();
        sink.all(&digests, |(_, digest)| digest.to_le_bytes());
        (self.bodies.info(dense).key, sink.finish())
    }
}

impl<S: Scalar> BodyRef<'_, S> {
    /// A hash of everything that belongs to the body except its handle: definition, colliders, motion, rest, and what was applied
    /// to it since the last step. Two bodies with the same hash move alike where the same fields act on them.
    ///
    /// *Source* XXH3, 64 bits (Collet).
    ///
    /// ```
    /// use umbra_physics::{BodyDef, World, WorldDef, vec2};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let [a, b] = [(); 2].map(|()| world.add_body(BodyDef { velocity: vec2(1, 0), ..BodyDef::dynamic() }));
    /// let (a, b) = (a?, b?);
    /// world.step();
    /// assert_eq!(world.body(a)?.physics_hash(), world.body(b)?.physics_hash());
    /// world.apply_force(b, vec2(1, 0))?;
    /// assert_ne!(world.body(a)?.physics_hash(), world.body(b)?.physics_hash());
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[must_use]
    pub fn physics_hash(&self) -> u64 {
        S::physics_hash_of(self)
    }

    pub(crate) fn physics_hash_inner(&self) -> u64 {
        let (world, dense) = self.parts();
        world.motion_of(dense).1
    }
}
