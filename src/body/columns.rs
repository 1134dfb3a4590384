//! The state of all bodies, one array per quantity, those that move first.

use alloc::vec::Vec;

use super::motion::{Acceleration, Block, Motion};
use super::tuning::{Climate, Tunings};
use super::{Activity, BodyDef, BodyKind, Mass, MassProperties};
use crate::error::Error;
use crate::handle::BodyId;
use crate::limits;
use crate::scalar::{Angle, Scalar};
use crate::shape::Shape;

/// What a step does not change, and rarely reads.
#[derive(Clone, Debug)]
pub(crate) struct Card<S: Scalar> {
    pub(crate) kind: BodyKind,
    pub(crate) activity: Activity,
    pub(crate) groups: u32,
    /// Where its applied forces are, or [`NONE`].
    pub(crate) applied: u32,
    pub(crate) key: u64,
    pub(crate) user_data: u64,
    pub(crate) mass: Mass<S>,
    pub(crate) properties: MassProperties<S>,
    pub(crate) shape: Option<Shape<S>>,
    pub(crate) gravity_scale: S,
    pub(crate) linear_damping: Option<S>,
    pub(crate) angular_damping: Option<S>,
}

/// No index.
pub(crate) const NONE: u32 = u32::MAX;

/// All columns.
#[derive(Debug)]
pub(crate) struct Columns<S: Scalar> {
    pub(crate) motion: Motion<S>,
    /// Which of the [`Tunings`](super::Tunings) a body has.
    pub(crate) tuning: Vec<u32>,
    pub(crate) slot: Vec<u32>,
    pub(crate) card: Vec<Card<S>>,
}

clone_by_field!(Columns { motion, tuning, slot, card });

#[derive(Clone, Copy, Debug)]
struct Slot {
    generation: u32,
    /// Its index in the columns, or [`NONE`].
    dense: u32,
}

/// The bodies of a world. The allocator of handles is part of its state.
#[derive(Debug)]
pub(crate) struct Bodies<S: Scalar> {
    pub(crate) columns: Columns<S>,
    /// The bodies before this index are the ones a step moves.
    moving: usize,
    slots: Vec<Slot>,
    /// Free slots; the last one freed is used first.
    free: Vec<u32>,
    /// Whether bodies have a last acceleration.
    keeps_last: bool,
    /// How many are asleep; derived, so that waking costs nothing where nobody sleeps.
    asleep: usize,
}

clone_by_field!(Bodies { columns, moving, slots, free, keeps_last, asleep });

impl<S: Scalar> Default for Bodies<S> {
    fn default() -> Self {
        let columns = Columns { motion: Motion::default(), tuning: Vec::new(), slot: Vec::new(), card: Vec::new() };
        Self { columns, moving: 0, slots: Vec::new(), free: Vec::new(), keeps_last: false, asleep: 0 }
    }
}

impl<S: Scalar> Bodies<S> {
    pub(crate) fn len(&self) -> usize {
        self.columns.card.len()
    }

    pub(crate) fn moving(&self) -> usize {
        self.moving
    }

    /// The bodies that move.
    pub(crate) fn all_moving(&mut self) -> Block<'_, S> {
        self.block(0, self.moving)
    }

    /// Some of the bodies that move, by their indices.
    pub(crate) fn block(&mut self, first: usize, end: usize) -> Block<'_, S> {
        Block::new(&mut self.columns.motion, &self.columns.tuning, first, end)
    }

    pub(crate) fn any_asleep(&self) -> bool {
        self.asleep > 0
    }

    /// Changes whether a body takes part; returns its new index.
    pub(crate) fn set_activity(&mut self, dense: usize, activity: Activity) -> usize {
        let card = &mut self.columns.card[dense];
        self.asleep -= usize::from(card.activity == Activity::Asleep);
        self.asleep += usize::from(activity == Activity::Asleep);
        card.activity = activity;
        self.columns.motion.rest[dense] = 0;
        let moves = activity == Activity::Awake && card.kind != BodyKind::Static;
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

    /// Generations and whether they are taken, by slot; then the free slots in the order they will not be used.
    pub(crate) fn allocator(&self) -> (impl ExactSizeIterator<Item = (u32, bool)>, &[u32]) {
        (self.slots.iter().map(|s| (s.generation, s.dense != NONE)), &self.free)
    }

    /// Adds a body. *Domain* the definition was checked.
    pub(crate) fn insert(
        &mut self,
        def: BodyDef<S>,
        properties: MassProperties<S>,
        tunings: &mut Tunings<S>,
        climate: &Climate<'_, S>,
    ) -> Result<BodyId, Error> {
        let dense = self.len();
        if dense >= limits::BODIES {
            return Err(Error::Full);
        }
        let slot = self.free.pop().unwrap_or_else(|| {
            self.slots.push(Slot { generation: 0, dense: NONE });
            (self.slots.len() - 1) as u32
        });
        self.slots[slot as usize].dense = dense as u32;
        let columns = &mut self.columns;
        columns.motion.push(def.position, def.velocity, S::Angle::from_radians(def.angle), def.angular_velocity);
        if self.keeps_last {
            columns.motion.last.push(Acceleration::default());
        }
        let card = Card {
            kind: def.kind,
            activity: Activity::Awake,
            groups: def.groups,
            applied: NONE,
            key: def.key,
            user_data: def.user_data,
            mass: def.mass,
            properties,
            shape: def.shape,
            gravity_scale: def.gravity_scale,
            linear_damping: def.linear_damping,
            angular_damping: def.angular_damping,
        };
        columns.tuning.push(tunings.acquire(&card, climate));
        columns.slot.push(slot);
        columns.card.push(card);
        if def.kind != BodyKind::Static {
            self.swap(dense, self.moving);
            self.moving += 1;
        }
        Ok(BodyId { slot, generation: self.slots[slot as usize].generation })
    }

    /// Removes a body; its slot is free for the next one, with the next generation.
    pub(crate) fn remove(&mut self, body: BodyId) -> Result<(), Error> {
        let dense = self.find(body)?;
        let dense = self.set_moving(dense, false);
        let last = self.len() - 1;
        self.swap(dense, last);
        let columns = &mut self.columns;
        columns.motion.pop();
        columns.tuning.pop();
        columns.slot.pop();
        columns.card.pop();
        let slot = &mut self.slots[body.slot as usize];
        slot.dense = NONE;
        // A slot whose generations are used up is never taken again: no handle names two bodies.
        if let Some(next) = slot.generation.checked_add(1) {
            slot.generation = next;
            self.free.push(body.slot);
        }
        Ok(())
    }

    /// Moves a body among those that move, or out of them; returns its new index.
    pub(crate) fn set_moving(&mut self, dense: usize, moving: bool) -> usize {
        match (dense < self.moving, moving) {
            (false, true) => {
                self.swap(dense, self.moving);
                self.moving += 1;
                self.moving - 1
            }
            (true, false) => {
                self.moving -= 1;
                self.swap(dense, self.moving);
                self.moving
            }
            _ => dense,
        }
    }

    /// Gives every body a last acceleration of zero, or none any room for one.
    pub(crate) fn keep_last_acceleration(&mut self, keep: bool) {
        self.keeps_last = keep;
        let last = &mut self.columns.motion.last;
        last.clear();
        if keep {
            last.resize(self.columns.card.len(), Acceleration::default());
        }
    }

    fn swap(&mut self, a: usize, b: usize) {
        if a == b {
            return;
        }
        let columns = &mut self.columns;
        columns.motion.swap(a, b);
        columns.tuning.swap(a, b);
        columns.slot.swap(a, b);
        columns.card.swap(a, b);
        self.slots[columns.slot[a] as usize].dense = a as u32;
        self.slots[columns.slot[b] as usize].dense = b as u32;
    }
}
