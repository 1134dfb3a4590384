//! All bodies: in columns what steps change, the moving bodies first; in shared tables what no step changes.

use alloc::sync::Arc;
use alloc::vec::Vec;
use core::convert::identity;

use super::asleep::Sleepers;
use super::changes::{Change, ChangeCursor, Changes};
use super::factors::{FactorTable, Key};
use super::info::{BodyInfo, BodyTable};
use super::mass::{MassTable, inverse_inertia_of};
use super::motion::{Acceleration, Motion};
use super::{Activity, BodyDef, BodyKind, Locks, Mass, MassProperties};
use crate::codec::{self, StateHasher, Write as _};
use crate::collider::ColliderMass;
use crate::error::Error;
use crate::limits;
use crate::scalar::{Accumulator, Angle, Scalar};
use crate::slots::{BodyId, Slots};
pub(super) use crate::slots::{NONE, push};

/// The columns, each with a value for each body, in one order.
#[derive(Debug)]
pub(crate) struct Columns<S: Scalar> {
    pub(crate) motion: Motion<S>,
    /// The row of the [`FactorTable`] that each body has.
    pub(crate) factors: Vec<u32>,
    /// The row of the [`MassTable`] that each body has.
    mass: Vec<u32>,
    pub(crate) slot: Vec<u32>,
    activity: Vec<Activity>,
}

clone_by_field!(Columns { motion, factors, mass, slot, activity });

/// The bodies of a world. The slots, from which new bodies get their handles, are part of the state.
#[derive(Debug)]
pub(crate) struct Bodies<S: Scalar> {
    pub(crate) columns: Columns<S>,
    table: Arc<BodyTable<S>>,
    masses: Arc<MassTable<S>>,
    /// The bodies before this index are the ones a step moves.
    pub(super) moving: usize,
    /// The moving bodies before this index are free and the others coupled, except for the bodies in `changes`.
    pub(super) first_coupled: usize,
    /// The groups of all fields that act on bodies by their groups, as the bodies are parted now.
    pub(super) coupling_groups: u32,
    pub(super) changes: Changes,
    /// How far the parting into free and coupled bodies has followed the changes.
    pub(super) parted: ChangeCursor,
    /// Memory that parting uses again; empty in between.
    pub(super) parting: Vec<usize>,
    /// The index of each body in the columns.
    pub(super) slots: Slots<BodyId>,
    /// True if bodies have a last acceleration. The column is empty as long as all are zero.
    keeps_last: bool,
    /// True if a body started to move since the last step.
    pub(super) any_come: bool,
    /// True if all ticks at rest are known to be zero.
    pub(super) is_rest_zero: bool,
    /// Counts of the bodies that are asleep; derived.
    asleep: Sleepers,
}

clone_by_field!(Bodies {
    columns,
    table,
    masses,
    moving,
    first_coupled,
    coupling_groups,
    changes,
    parted,
    parting,
    slots,
    keeps_last,
    any_come,
    is_rest_zero,
    asleep
});

impl<S: Scalar> Default for Bodies<S> {
    fn default() -> Self {
        let (factors, mass, slot, activity) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let columns = Columns { motion: Motion::default(), factors, mass, slot, activity };
        Self {
            columns,
            table: Arc::default(),
            masses: Arc::default(),
            moving: 0,
            first_coupled: 0,
            coupling_groups: 0,
            changes: Changes::default(),
            parted: ChangeCursor::default(),
            parting: Vec::new(),
            slots: Slots::default(),
            keeps_last: false,
            any_come: false,
            is_rest_zero: false,
            asleep: Sleepers::default(),
        }
    }
}

impl<S: Scalar> Bodies<S> {
    pub(crate) fn len(&self) -> usize {
        self.columns.slot.len()
    }

    pub(crate) fn any_asleep(&self) -> bool {
        self.asleep.count > 0
    }

    /// Returns true if a dynamic body in one of these groups is asleep.
    pub(crate) fn any_asleep_in(&self, force_groups: u32) -> bool {
        self.asleep.force_groups() & force_groups != 0
    }

    /// The bodies that are asleep, in no order. It looks at all bodies that no step moves.
    pub(crate) fn asleep(&self) -> impl Iterator<Item = usize> {
        (self.moving..self.len()).filter(|&dense| self.columns.activity[dense] == Activity::Asleep)
    }

    /// The properties that no step changes, of the body at this index in the columns.
    pub(crate) fn info(&self, dense: usize) -> &BodyInfo<S> {
        self.table.info(self.columns.slot[dense] as usize)
    }

    /// The inverse masses and the locks of the body at this index in the columns.
    #[inline]
    pub(crate) fn mass(&self, dense: usize) -> &MassProperties<S> {
        &self.masses.all()[self.columns.mass[dense] as usize]
    }

    /// Changes properties that no step changes. *Domain* the kind and the groups of a body that is asleep stay the same.
    pub(crate) fn edit(&mut self, dense: usize, edit: impl FnOnce(&mut BodyInfo<S>)) {
        let slot = self.columns.slot[dense] as usize;
        Arc::make_mut(&mut self.table).edit(slot, edit);
    }

    /// Makes the hashes of the bodies whose properties calls have changed since the step before.
    pub(crate) fn update_digests(&mut self, factor_table: &FactorTable<S>) {
        if self.table.is_stale() {
            let Self { table, slots, columns, masses, .. } = self;
            Arc::make_mut(table).update(|slot| hashed_with(slots, columns, masses, factor_table, slot));
        }
    }

    /// Sets the kind and the mass of a body, with the mass properties that follow.
    pub(crate) fn set_mass(&mut self, dense: usize, kind: BodyKind, mass: Mass<S>, properties: MassProperties<S>) {
        self.edit(dense, |info| (info.kind, info.mass) = (kind, mass));
        self.set_mass_row(dense, properties);
    }

    /// Sets the mass of the colliders of a body, with the mass properties that follow.
    pub(crate) fn set_collider_mass(&mut self, dense: usize, mass: ColliderMass<S>, properties: MassProperties<S>) {
        self.edit(dense, |info| info.set_collider_mass(mass));
        self.set_mass_row(dense, properties);
    }

    fn set_mass_row(&mut self, dense: usize, properties: MassProperties<S>) {
        let masses = Arc::make_mut(&mut self.masses);
        let new = masses.acquire(properties, identity);
        masses.release(core::mem::replace(&mut self.columns.mass[dense], new));
    }

    /// Locks a body along some axes and unlocks it along the others, with the mass properties and factors that follow.
    pub(crate) fn set_locks(&mut self, dense: usize, factor_table: &mut FactorTable<S>, locks: Locks) {
        self.columns.motion.lock(dense, locks);
        let (info, inverse_mass) = (self.info(dense), self.mass(dense).inverse_mass);
        let properties = MassProperties::new(inverse_mass, inverse_inertia_of(info), locks);
        self.set_mass_row(dense, properties);
        let key = factor_table.rows()[self.columns.factors[dense] as usize].key;
        self.set_factors(dense, factor_table, Key { still: [locks.x, locks.y], ..key });
    }

    /// Gives a body the factors of a key.
    pub(crate) fn set_factors(&mut self, dense: usize, factor_table: &mut FactorTable<S>, key: Key<S>) {
        let new = factor_table.acquire(key);
        factor_table.release(core::mem::replace(&mut self.columns.factors[dense], new));
        self.edit(dense, |_| {});
    }

    pub(crate) fn activity(&self, dense: usize) -> Activity {
        self.columns.activity[dense]
    }

    /// Sets the activity of a body; returns its new index.
    pub(crate) fn set_activity(&mut self, dense: usize, activity: Activity) -> usize {
        let old = core::mem::replace(&mut self.columns.activity[dense], activity);
        let slot = self.columns.slot[dense] as usize;
        if old == Activity::Asleep {
            self.asleep.count(self.table.info(slot), -1);
        }
        if activity == Activity::Asleep {
            self.asleep.count(self.table.info(slot), 1);
        }
        self.columns.motion.ticks_at_rest[dense] = 0;
        self.note(dense, Change::ALL);
        let moves = activity == Activity::Awake && self.info(dense).kind != BodyKind::Static;
        self.set_moving(dense, moves)
    }

    /// The index of a body in the columns.
    pub(crate) fn find(&self, body: BodyId) -> Result<usize, Error> {
        self.slots.find(body).ok_or(Error::NoSuchBody { body })
    }

    /// The handle of the body at this index in the columns.
    pub(crate) fn id(&self, dense: usize) -> BodyId {
        self.slots.handle(self.columns.slot[dense])
    }

    /// Adds all bodies to a hash, and the state of the slots.
    pub(crate) fn write(&self, sink: &mut StateHasher, factor_table: &FactorTable<S>) {
        codec::count(sink, self.slots.len());
        sink.all(self.slots.all(), |slot| (u64::from(slot.generation) << 1 | u64::from(slot.is_taken())).to_le_bytes());
        codec::count(sink, self.slots.free().len());
        sink.all(self.slots.free(), u32::to_le_bytes);
        let Columns { motion, activity, .. } = &self.columns;
        let runs = self.runs();
        let runs = runs.as_ref();
        let [x, y, vx, vy] = [&motion.position.x, &motion.position.y, &motion.velocity.x, &motion.velocity.y];
        for column in [x, y, vx, vy, &motion.angular_velocity] {
            self.write_column(sink, runs, column, Accumulator::to_bytes);
        }
        self.write_column(sink, runs, &motion.angle, |angle| angle.to_bits().to_le_bytes());
        self.write_column(sink, runs, &motion.ticks_at_rest, u32::to_le_bytes);
        self.write_column(sink, runs, activity, |activity| [activity as u8]);
        let is_taken = |slot: &usize| self.slots.all()[*slot].is_taken();
        let taken = (0..self.slots.len()).filter(is_taken);
        match self.table.digests() {
            Some(digests) if self.len() == self.slots.len() => sink.all(digests, u64::to_le_bytes),
            Some(digests) => sink.each(taken.map(|slot| digests[slot]), u64::to_le_bytes),
            None => {
                let digest = |slot| {
                    let (key, locks) = hashed_with(&self.slots, &self.columns, &self.masses, factor_table, slot);
                    self.table.digest(slot, key, locks)
                };
                sink.each(taken.map(digest), u64::to_le_bytes);
            }
        }
        if self.keeps_last {
            for last in self.in_order().map(|dense| motion.last_acceleration.get(dense).copied().unwrap_or_default()) {
                [last.linear.x, last.linear.y, last.angular].iter().for_each(|a| a.write(sink));
            }
        }
    }

    /// Refuses another body where the limit is reached.
    pub(crate) fn check_room(&self) -> Result<(), Error> {
        if self.slots.has_room(limits::BODIES) { Ok(()) } else { Err(Error::Full) }
    }

    /// Adds a body; the colliders of the definition are added apart. *Domain* the definition was checked, and there is room.
    pub(crate) fn insert(
        &mut self,
        def: &BodyDef<S>,
        collider_mass: ColliderMass<S>,
        properties: MassProperties<S>,
        factor_table: &mut FactorTable<S>,
    ) -> BodyId {
        let slot = match self.slots.reuse() {
            Some(slot) => slot,
            None => self.new_slot(0),
        };
        self.insert_at(slot, def, collider_mass, properties, factor_table);
        self.slots.handle(slot)
    }

    /// Adds a slot without a body.
    pub(super) fn new_slot(&mut self, generation: u32) -> u32 {
        Arc::make_mut(&mut self.table).open();
        self.slots.open(generation)
    }

    /// Puts a body into a slot without one. *Domain* the definition was checked.
    pub(super) fn insert_at(
        &mut self,
        slot: u32,
        def: &BodyDef<S>,
        collider_mass: ColliderMass<S>,
        properties: MassProperties<S>,
        factor_table: &mut FactorTable<S>,
    ) {
        let dense = self.len();
        self.slots.set_index(slot, dense as u32);
        let columns = &mut self.columns;
        columns.motion.push(def.position, def.velocity, S::Angle::from_radians(def.angle), def.angular_velocity);
        if self.keeps_last && columns.motion.last_acceleration.len() == dense {
            push(&mut columns.motion.last_acceleration, Acceleration::default());
        }
        let key = Key {
            dynamic: def.kind == BodyKind::Dynamic,
            gravity_scale: def.gravity_scale,
            linear: def.linear_damping,
            angular: def.angular_damping,
            most: [def.max_speed, def.max_angular_speed],
            still: [def.locks.x, def.locks.y],
        };
        push(&mut columns.factors, factor_table.acquire(key));
        push(&mut columns.mass, Arc::make_mut(&mut self.masses).acquire(properties, identity));
        push(&mut columns.slot, slot);
        push(&mut columns.activity, Activity::Awake);
        let table = Arc::make_mut(&mut self.table);
        table.place(slot as usize, BodyInfo::new(def, collider_mass));
        self.note(dense, Change::ALL);
        self.set_moving(dense, def.kind != BodyKind::Static);
    }

    pub(super) fn keeps_last(&self) -> bool {
        self.keeps_last
    }

    /// Removes a body and frees its slot.
    pub(crate) fn remove(&mut self, body: BodyId) -> Result<(), Error> {
        let dense = self.find(body)?;
        let dense = self.set_moving(dense, false);
        let last = self.len() - 1;
        self.swap(dense, last);
        let columns = &mut self.columns;
        columns.motion.pop();
        columns.factors.pop();
        if let Some(row) = columns.mass.pop() {
            Arc::make_mut(&mut self.masses).release(row);
        }
        columns.slot.pop();
        columns.activity.pop();
        Arc::make_mut(&mut self.table).remove(body.slot as usize);
        self.slots.release(body.slot);
        Ok(())
    }

    /// Gives every body a last acceleration of zero, or none any.
    pub(crate) fn keep_last_acceleration(&mut self, keep: bool) {
        self.keeps_last = keep;
        self.columns.motion.last_acceleration.clear();
    }

    /// Fills the column of last accelerations, if there is one and it is empty.
    pub(super) fn make_last_accelerations(&mut self) {
        if self.keeps_last {
            self.columns.motion.last_acceleration.resize(self.len(), Acceleration::default());
        }
    }

    /// Sets the ticks at rest of all bodies to zero.
    pub(crate) fn clear_rest(&mut self) {
        if !core::mem::replace(&mut self.is_rest_zero, true) {
            self.columns.motion.ticks_at_rest.fill(0);
        }
    }

    /// Makes the columns ready for a step, and says whether a body has come among those that move since the last one.
    pub(crate) fn begin_step(&mut self, factor_table: &FactorTable<S>) -> bool {
        self.is_rest_zero = false;
        self.make_last_accelerations();
        self.update_digests(factor_table);
        core::mem::take(&mut self.any_come)
    }

    pub(super) fn swap(&mut self, a: usize, b: usize) {
        if a == b {
            return;
        }
        [a, b].into_iter().for_each(|dense| self.note(dense, Change::POSE));
        let columns = &mut self.columns;
        columns.motion.swap(a, b);
        columns.factors.swap(a, b);
        columns.mass.swap(a, b);
        columns.slot.swap(a, b);
        columns.activity.swap(a, b);
        self.slots.set_index(columns.slot[a], a as u32);
        self.slots.set_index(columns.slot[b], b as u32);
    }
}

/// The values that are hashed with the info of the body in a slot: the key of its factors, and its locks.
fn hashed_with<'a, S: Scalar>(
    slots: &Slots<BodyId>,
    columns: &Columns<S>,
    masses: &MassTable<S>,
    factor_table: &'a FactorTable<S>,
    slot: usize,
) -> (&'a Key<S>, Locks) {
    let dense = slots.all()[slot].index_or_none() as usize;
    (&factor_table.rows()[columns.factors[dense] as usize].key, masses.all()[columns.mass[dense] as usize].locks)
}
