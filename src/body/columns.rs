//! All bodies: what steps change in columns, those that move first; what they do not change by slot.

use alloc::sync::Arc;
use alloc::vec::Vec;
use core::ops::Range;

use super::changes::{Change, Changes};
use super::factors::{FactorTable, Key};
use super::info::{BodyInfo, BodyTable};
use super::motion::{Acceleration, Motion};
use super::{Activity, BodyDef, BodyKind, Locks, MassProperties};
use crate::codec::{self, StateHasher, Write as _};
use crate::error::Error;
use crate::handle::{BodyId, are_free};
use crate::limits;
use crate::scalar::{Accumulator, Angle, Scalar};
use crate::shape::Shape;

/// No index.
pub(crate) const NONE: u32 = u32::MAX;

/// All columns.
#[derive(Debug)]
pub(crate) struct Columns<S: Scalar> {
    pub(crate) motion: Motion<S>,
    /// The rows of the [`FactorTable`] that the bodies have.
    pub(crate) factors: Vec<u32>,
    pub(crate) slot: Vec<u32>,
    activity: Vec<Activity>,
}

clone_by_field!(Columns { motion, factors, slot, activity });

#[derive(Clone, Copy, Debug)]
struct Slot {
    generation: u32,
    /// Its index in the columns, or [`NONE`].
    dense: u32,
}

/// More than so many are taken body by body.
const MOST_RUNS: usize = 32;

/// Ranges of indices in the columns.
struct Runs {
    ranges: [Range<u32>; MOST_RUNS],
    count: usize,
}

impl Runs {
    fn push(&mut self, run: Range<u32>) -> Option<()> {
        if run.is_empty() {
            return Some(());
        }
        *self.ranges.get_mut(self.count)? = run;
        self.count += 1;
        Some(())
    }

    fn iter(&self) -> impl Iterator<Item = Range<usize>> {
        self.ranges[..self.count].iter().map(|run| run.start as usize..run.end as usize)
    }
}

/// The bodies of a world. The allocator of handles is part of its state.
#[derive(Debug)]
pub(crate) struct Bodies<S: Scalar> {
    pub(crate) columns: Columns<S>,
    table: Arc<BodyTable<S>>,
    /// The bodies before this index are the ones a step moves.
    pub(super) moving: usize,
    /// The moving bodies before this index are free and the others coupled, but for what `changes` has.
    pub(super) first_coupled: usize,
    /// The groups of all fields that act on bodies by their groups, as the bodies are parted now.
    pub(super) coupling_groups: u32,
    pub(super) changes: Changes,
    slots: Vec<Slot>,
    /// Free slots; the last one freed is used first.
    free: Vec<u32>,
    /// Whether bodies have a last acceleration. The column is empty as long as all are zero.
    keeps_last: bool,
    /// Whether a body has come among those that move since the last step.
    pub(super) any_come: bool,
    /// Whether all ticks at rest are known to be zero.
    is_rest_zero: bool,
    /// The bodies that are asleep; derived, so that waking costs nothing where nobody sleeps.
    asleep: Sleepers,
}

clone_by_field!(Bodies {
    columns,
    table,
    moving,
    first_coupled,
    coupling_groups,
    changes,
    slots,
    free,
    keeps_last,
    any_come,
    is_rest_zero,
    asleep
});

/// How many bodies are asleep, and how many dynamic ones of them in each group.
#[derive(Clone, Copy, Debug, Default)]
struct Sleepers {
    count: usize,
    by_group: [u32; 32],
}

impl Sleepers {
    /// Counts a body in (`by` = 1) or out (−1).
    fn count<S: Scalar>(&mut self, info: &BodyInfo<S>, by: i32) {
        self.count = self.count.wrapping_add_signed(by as isize);
        let mut groups = if info.kind == BodyKind::Dynamic { info.groups } else { 0 };
        while groups != 0 {
            let group = groups.trailing_zeros() as usize;
            self.by_group[group] = self.by_group[group].wrapping_add_signed(by);
            groups &= groups - 1;
        }
    }

    /// The groups with a dynamic body that sleeps.
    fn groups(&self) -> u32 {
        (0..32).fold(0, |groups, group| groups | u32::from(self.by_group[group] > 0) << group)
    }
}

impl<S: Scalar> Default for Bodies<S> {
    fn default() -> Self {
        let columns =
            Columns { motion: Motion::default(), factors: Vec::new(), slot: Vec::new(), activity: Vec::new() };
        Self {
            columns,
            table: Arc::default(),
            moving: 0,
            first_coupled: 0,
            coupling_groups: 0,
            changes: Changes::default(),
            slots: Vec::new(),
            free: Vec::new(),
            keeps_last: false,
            any_come: false,
            is_rest_zero: false,
            asleep: Sleepers::default(),
        }
    }
}

/// Adds a value. A column of more than a few grows by an eighth, not to twice its size: little is kept for bodies to come.
pub(crate) fn push<T>(column: &mut Vec<T>, value: T) {
    if column.len() == column.capacity() {
        column.reserve_exact(column.len().clamp(4, 16).max(column.len() / 8));
    }
    column.push(value);
}

impl<S: Scalar> Bodies<S> {
    pub(crate) fn len(&self) -> usize {
        self.columns.slot.len()
    }

    pub(crate) fn any_asleep(&self) -> bool {
        self.asleep.count > 0
    }

    /// Whether a dynamic body in one of these groups is asleep.
    pub(crate) fn any_asleep_in(&self, groups: u32) -> bool {
        self.asleep.groups() & groups != 0
    }

    /// The bodies that are asleep, in no order. Looks at all that no step moves.
    pub(crate) fn asleep(&self) -> impl Iterator<Item = usize> {
        (self.moving..self.len()).filter(|&dense| self.columns.activity[dense] == Activity::Asleep)
    }

    /// The properties that no step changes, of the body at this index in the columns.
    pub(crate) fn info(&self, dense: usize) -> &BodyInfo<S> {
        self.table.info(self.columns.slot[dense] as usize)
    }

    /// Changes properties that no step changes. A body that is asleep keeps its kind and its groups.
    pub(crate) fn edit(&mut self, dense: usize, edit: impl FnOnce(&mut BodyInfo<S>)) {
        let slot = self.columns.slot[dense] as usize;
        Arc::make_mut(&mut self.table).edit(slot, edit);
    }

    /// Makes the hashes of what calls have changed since the step before.
    pub(crate) fn update_digests(&mut self, factor_table: &FactorTable<S>) {
        if self.table.is_stale() {
            let Self { table, slots, columns, .. } = self;
            Arc::make_mut(table).update(|slot| key_of(slots, columns, factor_table, slot));
        }
    }

    /// Gives a body a shape, or none, and the properties that follow.
    pub(crate) fn set_shape(&mut self, dense: usize, shape: Option<Shape<S>>, properties: MassProperties<S>) {
        let shapes = &mut Arc::make_mut(&mut self.table).shapes;
        let new = shape.map(|shape| shapes.acquire(shape));
        let mut old = None;
        self.edit(dense, |info| {
            old = core::mem::replace(&mut info.shape, new);
            info.properties = properties;
        });
        if let Some(old) = old {
            Arc::make_mut(&mut self.table).shapes.release(&old);
        }
    }

    /// Locks a body along some axes, unlocks it along the others, and gives it the factors that go with that.
    pub(crate) fn set_locks(&mut self, dense: usize, factor_table: &mut FactorTable<S>, locks: Locks) {
        self.columns.motion.lock(dense, locks);
        self.edit(dense, |info| info.locks = locks);
        let key = factor_table.rows()[self.columns.factors[dense] as usize].key;
        self.set_factors(dense, factor_table, Key { still: [locks.x, locks.y], ..key });
    }

    /// Gives a body the factors that go with a key.
    pub(crate) fn set_factors(&mut self, dense: usize, factor_table: &mut FactorTable<S>, key: Key<S>) {
        let new = factor_table.acquire(key);
        factor_table.release(core::mem::replace(&mut self.columns.factors[dense], new));
        self.edit(dense, |_| {});
    }

    pub(crate) fn activity(&self, dense: usize) -> Activity {
        self.columns.activity[dense]
    }

    /// Changes whether a body takes part; returns its new index.
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
        match self.slots.get(body.slot as usize) {
            Some(slot) if slot.generation == body.generation && slot.dense != NONE => Ok(slot.dense as usize),
            _ => Err(Error::NoSuchBody { body }),
        }
    }

    /// The handle of the body at this index in the columns.
    pub(crate) fn id(&self, dense: usize) -> BodyId {
        let slot = self.columns.slot[dense];
        BodyId { slot, generation: self.slots[slot as usize].generation }
    }

    /// Indices in the columns in the order of the slots, which is the order of everything public.
    pub(crate) fn in_order(&self) -> impl Iterator<Item = usize> {
        self.slots.iter().filter(|s| s.dense != NONE).map(|s| s.dense as usize)
    }

    /// The same as ranges of indices that follow each other; `None` if there are many.
    fn runs(&self) -> Option<Runs> {
        let mut runs = Runs { ranges: [const { 0..0 }; MOST_RUNS], count: 0 };
        let mut run = 0..0;
        for slots in self.slots.chunks(64) {
            // Where nothing was removed and nobody sleeps: without a branch a slot.
            if slots.iter().zip(run.end..).fold(true, |follows, (slot, next)| follows & (slot.dense == next)) {
                run.end += slots.len() as u32;
                continue;
            }
            for dense in slots.iter().map(|slot| slot.dense).filter(|&dense| dense != NONE) {
                if dense == run.end {
                    run.end += 1;
                } else {
                    runs.push(core::mem::replace(&mut run, dense..dense + 1))?;
                }
            }
        }
        runs.push(run)?;
        Some(runs)
    }

    /// Adds a column to a hash, in the order of the slots.
    fn write_column<T: Copy, const BYTES: usize>(
        &self,
        sink: &mut StateHasher,
        runs: Option<&Runs>,
        column: &[T],
        bytes: impl Fn(T) -> [u8; BYTES] + Copy,
    ) {
        match runs {
            Some(runs) => runs.iter().for_each(|run| sink.all(&column[run], bytes)),
            None => sink.each(self.in_order().map(|dense| column[dense]), bytes),
        }
    }

    /// Adds to a hash all bodies and how their handles are given out.
    pub(crate) fn write(&self, sink: &mut StateHasher, factor_table: &FactorTable<S>) {
        codec::count(sink, self.slots.len());
        sink.all(&self.slots, |slot| (u64::from(slot.generation) << 1 | u64::from(slot.dense != NONE)).to_le_bytes());
        codec::count(sink, self.free.len());
        sink.all(&self.free, u32::to_le_bytes);
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
        let is_taken = |slot: &usize| self.slots[*slot].dense != NONE;
        let taken = (0..self.slots.len()).filter(is_taken);
        match self.table.digests() {
            Some(digests) if self.len() == self.slots.len() => sink.all(digests, u64::to_le_bytes),
            Some(digests) => sink.each(taken.map(|slot| digests[slot]), u64::to_le_bytes),
            None => {
                let digest = |slot| self.table.digest(slot, key_of(&self.slots, &self.columns, factor_table, slot));
                sink.each(taken.map(digest), u64::to_le_bytes);
            }
        }
        if self.keeps_last {
            for last in self.in_order().map(|dense| motion.last_acceleration.get(dense).copied().unwrap_or_default()) {
                [last.linear.x, last.linear.y, last.angular].iter().for_each(|a| a.write(sink));
            }
        }
    }

    /// Refuses where there is no room for another body.
    pub(crate) fn check_room(&self) -> Result<(), Error> {
        if self.free.is_empty() && self.slots.len() >= limits::BODIES { Err(Error::Full) } else { Ok(()) }
    }

    /// Adds a body. *Domain* the definition was checked, and there is room.
    pub(crate) fn insert(
        &mut self,
        def: BodyDef<S>,
        properties: MassProperties<S>,
        factor_table: &mut FactorTable<S>,
    ) -> BodyId {
        let slot = match self.free.pop() {
            Some(slot) => slot,
            None => self.new_slot(0),
        };
        self.insert_at(slot, def, properties, factor_table);
        BodyId { slot, generation: self.slots[slot as usize].generation }
    }

    /// Adds a slot without a body.
    pub(super) fn new_slot(&mut self, generation: u32) -> u32 {
        push(&mut self.slots, Slot { generation, dense: NONE });
        Arc::make_mut(&mut self.table).open();
        (self.slots.len() - 1) as u32
    }

    /// Puts a body into a slot without one. *Domain* the definition was checked.
    pub(super) fn insert_at(
        &mut self,
        slot: u32,
        def: BodyDef<S>,
        properties: MassProperties<S>,
        factor_table: &mut FactorTable<S>,
    ) {
        let dense = self.len();
        self.slots[slot as usize].dense = dense as u32;
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
        push(&mut columns.slot, slot);
        push(&mut columns.activity, Activity::Awake);
        let table = Arc::make_mut(&mut self.table);
        let info = BodyInfo::new(&def, def.shape.clone().map(|shape| table.shapes.acquire(shape)), properties);
        table.place(slot as usize, info);
        self.note(dense, Change::ALL);
        self.set_moving(dense, def.kind != BodyKind::Static);
    }

    /// The index of the body in a slot.
    pub(super) fn slot_index(&self, slot: usize) -> usize {
        self.slots[slot].dense as usize
    }

    /// The slots: how often each was taken before, and the index of its body in the columns.
    pub(crate) fn slots(&self) -> impl ExactSizeIterator<Item = (u32, Option<usize>)> {
        self.slots.iter().map(|slot| (slot.generation, (slot.dense != NONE).then_some(slot.dense as usize)))
    }

    pub(super) fn keeps_last(&self) -> bool {
        self.keeps_last
    }

    /// How often a slot was taken before.
    pub(crate) fn generation(&self, slot: u32) -> Option<u32> {
        self.slots.get(slot as usize).map(|slot| slot.generation)
    }

    /// The slots to take next, the last one first.
    pub(crate) fn free(&self) -> &[u32] {
        &self.free
    }

    /// Says which slots to take next: each one without a body, and once.
    pub(crate) fn set_free(&mut self, free: Vec<u32>) -> Result<(), Error> {
        if !are_free(self.slots.iter().map(|slot| slot.dense == NONE), &free) {
            return Err(Error::Inconsistent);
        }
        self.free = free;
        Ok(())
    }

    /// Adds a body of another world with the same parameters, with all that it is but its handle.
    pub(crate) fn adopt(
        &mut self,
        (other, body): (&Self, BodyId),
        (other_tunings, factor_table): (&FactorTable<S>, &mut FactorTable<S>),
    ) -> Result<BodyId, Error> {
        let from = other.find(body)?;
        let (info, key) = (other.info(from), &other_tunings.rows()[other.columns.factors[from] as usize].key);
        let def = BodyDef {
            kind: info.kind,
            shape: info.shape.as_deref().cloned(),
            mass: info.mass,
            gravity_scale: key.gravity_scale,
            linear_damping: key.linear,
            angular_damping: key.angular,
            max_speed: key.most[0],
            max_angular_speed: key.most[1],
            locks: info.locks,
            groups: info.groups,
            key: info.key,
            user_data: info.user_data,
            ..BodyDef::dynamic()
        };
        let adopted = self.insert(def, info.properties, factor_table);
        let dense = self.find(adopted)?;
        let dense = self.set_activity(dense, other.activity(from));
        self.make_last_accelerations();
        self.is_rest_zero = false;
        self.columns.motion.copy(dense, &other.columns.motion, from);
        Ok(adopted)
    }

    /// Removes a body; its slot is free for the next one, with the next generation.
    pub(crate) fn remove(&mut self, body: BodyId) -> Result<(), Error> {
        let dense = self.find(body)?;
        let dense = self.set_moving(dense, false);
        let last = self.len() - 1;
        self.swap(dense, last);
        let columns = &mut self.columns;
        columns.motion.pop();
        columns.factors.pop();
        columns.slot.pop();
        columns.activity.pop();
        Arc::make_mut(&mut self.table).remove(body.slot as usize);
        let slot = &mut self.slots[body.slot as usize];
        slot.dense = NONE;
        // A slot whose generations are used up is never taken again: no handle names two bodies.
        if let Some(next) = slot.generation.checked_add(1) {
            slot.generation = next;
            self.free.push(body.slot);
        }
        Ok(())
    }

    /// Gives every body a last acceleration of zero, or none any.
    pub(crate) fn keep_last_acceleration(&mut self, keep: bool) {
        self.keeps_last = keep;
        self.columns.motion.last_acceleration.clear();
    }

    /// Fills the column of last accelerations, if there is one and it is empty.
    fn make_last_accelerations(&mut self) {
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
        columns.slot.swap(a, b);
        columns.activity.swap(a, b);
        self.slots[columns.slot[a] as usize].dense = a as u32;
        self.slots[columns.slot[b] as usize].dense = b as u32;
    }
}

/// The key that the factors of the body in a slot are made from.
fn key_of<'a, S: Scalar>(
    slots: &[Slot],
    columns: &Columns<S>,
    factor_table: &'a FactorTable<S>,
    slot: usize,
) -> &'a Key<S> {
    &factor_table.rows()[columns.factors[slots[slot].dense as usize] as usize].key
}
