//! The colliders of a world and their handles.

use alloc::boxed::Box;
use alloc::sync::Arc;
use alloc::vec::Vec;

use super::chunks::Chunks;
use super::outline::{BodyOutline, OutlineRef};
use super::pairs::MaterialPairs;
use super::{ColliderDef, Side, to_fx};
use crate::codec::{self, StateHasher, Write as _};
use crate::error::Error;
use crate::fx::Fx;
use crate::limits;
use crate::math::Vec2;
use crate::scalar::Scalar;
use crate::shape::Aabb;
use crate::slots::{BodyId, ColliderId, NONE, Slots, push};

/// The colliders. Copies of a world share them until one is changed.
///
/// The time to add, replace, find or remove a collider does not depend on the number of others, except those of its body.
#[derive(Debug)]
pub(crate) struct ColliderSet<S: Scalar = Fx> {
    /// The index of each collider in the list.
    slots: Slots<ColliderId>,
    /// The colliders in no order.
    list: Chunks<Collider<S>>,
    /// The first collider of each body by its slot, or [`NONE`]; long enough for the bodies that have had one.
    first: Vec<u32>,
    /// A hash of all changes so far: caches of a step compare it. Copies of a world have the same.
    revision: u64,
    /// The last changes: the revision after each, and the slot.
    changes: Vec<(u64, u32)>,
    /// The number of outlines beyond the first one of each collider.
    more_outlines: usize,
    /// The numbers of colliders of some kinds.
    kinds: Kinds,
    /// The coefficients of pairs of materials.
    pub(super) pairs: MaterialPairs<S>,
    /// The colliders rounded to fixed point, in a world of floats: see [`fixed`](Self::fixed).
    pub(super) image: Option<Box<ColliderSet<Fx>>>,
}

impl<S: Scalar> Default for ColliderSet<S> {
    fn default() -> Self {
        Self {
            slots: Slots::default(),
            list: Chunks::default(),
            first: Vec::new(),
            revision: 0,
            changes: Vec::new(),
            more_outlines: 0,
            kinds: Kinds::default(),
            pairs: MaterialPairs::default(),
            image: to_fx::image::<S>(),
        }
    }
}

/// The numbers of colliders of some kinds: a step does nothing for a kind that is not there.
#[derive(Clone, Copy, Debug, Default)]
struct Kinds {
    /// Colliders that meet others. All further kinds are among them.
    meeting: usize,
    one_way: usize,
    sensors: usize,
    contact_events: usize,
    hit_events: usize,
}

impl Kinds {
    /// Counts a collider, or with `change` takes it out again.
    fn count<S: Scalar>(&mut self, def: &ColliderDef<S>, change: fn(usize, usize) -> usize) {
        let meets_others = def.meets_others();
        let add = |count: &mut usize, is_one: bool| *count = change(*count, usize::from(meets_others && is_one));
        add(&mut self.meeting, true);
        add(&mut self.one_way, def.one_way.is_some());
        add(&mut self.sensors, def.sensor);
        add(&mut self.contact_events, def.contact_events);
        add(&mut self.hit_events, def.hit_events);
    }
}

/// The number of changes that are remembered: caches that are older are made anew.
const CHANGES: usize = 64;

/// A collider, with values that follow from its definition.
#[derive(Clone, Debug)]
pub(crate) struct Collider<S: Scalar = Fx> {
    pub(crate) slot: u32,
    pub(crate) body: BodyId,
    /// The slots of the neighbours in the list of the body's colliders, or [`NONE`].
    previous: u32,
    next: u32,
    pub(crate) def: ColliderDef<S>,
    first: BodyOutline<S>,
    /// The outlines of a compound's other parts. Those of a chain's other segments are made from the first one.
    others: Option<Arc<[BodyOutline<S>]>>,
    count: u32,
    /// The largest distance of a point of the collider from the body's centre of mass, m, rounded up.
    pub(crate) radius: S,
    /// The side from which it holds others, if it is a one-way collider.
    pub(crate) side: Option<Side<S>>,
    /// The least width of an outline, m.
    pub(crate) width: S,
    /// A hash of the body and the definition: no step changes them.
    pub(crate) digest: u64,
    /// A hash of the definition without the handle of the body.
    pub(crate) physics_digest: u64,
    /// The revision after the last change of the body's colliders, if this is the first of them.
    body_revision: u64,
}

/// An outline of a collider by name: the collider's slot, and the number of the outline among the shape's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct OutlineId {
    pub(crate) slot: u32,
    pub(crate) part: u32,
}

clone_by_field!(ColliderSet { slots, list, first, revision, changes, more_outlines, kinds, pairs, image });

impl<S: Scalar> ColliderSet<S> {
    pub(crate) fn len(&self) -> usize {
        self.list.len()
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.list.len() == 0
    }

    /// Returns true if there is a collider that meets others.
    #[inline(always)]
    pub(crate) fn any_meeting(&self) -> bool {
        self.kinds.meeting > 0
    }

    pub(crate) fn revision(&self) -> u64 {
        self.revision
    }

    /// A name of the colliders of the body in a slot: caches of a step compare it. Copies of a world have the same.
    pub(crate) fn revision_of(&self, body: u32) -> Option<u64> {
        self.of_slot(body).next().map(|first| first.body_revision)
    }

    /// Notes a change of the collider of a body in a slot.
    fn note(&mut self, slot: u32, body: u32) {
        let mut sink = StateHasher::new();
        self.revision.write(&mut sink);
        slot.write(&mut sink);
        self.at(slot).map(|collider| collider.digest).write(&mut sink);
        self.revision = sink.finish();
        if self.changes.len() == CHANGES {
            self.changes.drain(..CHANGES / 2);
        }
        push(&mut self.changes, (self.revision, slot));
        let first = self.first[body as usize];
        let revision = self.revision;
        if let Some(first) = self.at_mut(first) {
            first.body_revision = revision;
        }
    }

    /// The slots whose colliders were added, changed or removed since a revision, perhaps more than once; `None` if that was too many
    /// changes ago.
    pub(crate) fn changed_since(&self, revision: u64) -> Option<impl Iterator<Item = u32> + '_> {
        let from = match self.changes.iter().rposition(|(after, _)| *after == revision) {
            Some(last) => last + 1,
            None if revision == self.revision => self.changes.len(),
            None => return None,
        };
        Some(self.changes[from..].iter().map(|(_, slot)| *slot))
    }

    /// The number of outlines beyond the first one of each collider.
    pub(crate) fn more_outlines(&self) -> usize {
        self.more_outlines
    }

    /// Returns true if there is a one-way collider.
    #[inline(always)]
    pub(crate) fn any_one_way(&self) -> bool {
        self.kinds.one_way > 0
    }

    /// Returns true if there is a sensor.
    #[inline(always)]
    pub(crate) fn any_sensors(&self) -> bool {
        self.kinds.sensors > 0
    }

    /// Returns true if a collider reports where contacts begin and end.
    #[inline(always)]
    pub(crate) fn any_contact_events(&self) -> bool {
        self.kinds.contact_events > 0
    }

    /// Returns true if a collider reports hits.
    #[inline(always)]
    pub(crate) fn any_hit_events(&self) -> bool {
        self.kinds.hit_events > 0
    }

    /// Refuses colliders where a limit is reached: so many more, with so many outlines beyond the first one of each.
    pub(crate) fn check_room(&self, more: usize, more_outlines: usize) -> Result<(), Error> {
        let has_room = self.slots.has_room_for(more, limits::COLLIDERS)
            && self.more_outlines.saturating_add(more_outlines) <= limits::COLLIDERS;
        if has_room { Ok(()) } else { Err(Error::Full) }
    }

    /// Adds a collider. *Domain* it was checked, and there is room.
    pub(crate) fn insert(&mut self, body: BodyId, def: ColliderDef<S>) -> ColliderId {
        if let Some(image) = &mut self.image {
            image.insert(body, def.to_fx());
        }
        let slot = self.slots.reuse().unwrap_or_else(|| self.slots.open(0));
        self.place(slot, body, def);
        self.slots.handle(slot)
    }

    /// Adds the colliders of a new body: their slots ascend in the order of the list. *Domain* as [`insert`](Self::insert).
    pub(crate) fn insert_all(&mut self, body: BodyId, defs: Vec<ColliderDef<S>>) {
        if let Some(image) = &mut self.image {
            image.insert_all(body, defs.iter().map(ColliderDef::to_fx).collect());
        }
        let mut slots: Vec<u32> =
            defs.iter().map(|_| self.slots.reuse().unwrap_or_else(|| self.slots.open(0))).collect();
        slots.sort_unstable();
        slots.into_iter().zip(defs).for_each(|(slot, def)| self.place(slot, body, def));
    }

    /// Puts a collider into a slot without one, as the last of its body.
    fn place(&mut self, slot: u32, body: BodyId, def: ColliderDef<S>) {
        self.slots.set_index(slot, self.list.len() as u32);
        let at = body.slot as usize;
        if self.first.len() <= at {
            self.first.resize(at + 1, NONE);
        }
        let next = core::mem::replace(&mut self.first[at], slot);
        if let Some(next) = self.at_mut(next) {
            next.previous = slot;
        }
        self.more_outlines += more_outlines(&def);
        self.kinds.count(&def, core::ops::Add::add);
        self.list.push(Collider::new(slot, body, def, [NONE, next]));
        self.note(slot, body.slot);
    }

    /// The index in the list of the collider in a slot, if there is one.
    fn index_in(&self, slot: u32) -> Option<usize> {
        self.slots.all().get(slot as usize)?.index()
    }

    /// The collider in a slot, if there is one.
    pub(crate) fn at(&self, slot: u32) -> Option<&Collider<S>> {
        self.index_in(slot).map(|index| &self.list[index])
    }

    fn at_mut(&mut self, slot: u32) -> Option<&mut Collider<S>> {
        self.index_in(slot).and_then(|index| self.list.get_mut(index))
    }

    fn find(&self, id: ColliderId) -> Result<usize, Error> {
        self.slots.find(id).ok_or(Error::NoSuchCollider { collider: id })
    }

    pub(crate) fn get(&self, id: ColliderId) -> Result<&Collider<S>, Error> {
        self.find(id).map(|index| &self.list[index])
    }

    pub(crate) fn id(&self, slot: u32) -> ColliderId {
        self.slots.handle(slot)
    }

    /// Replaces the definition of a collider.
    pub(crate) fn replace(&mut self, id: ColliderId, def: ColliderDef<S>) -> Result<(), Error> {
        let index = self.find(id)?;
        if let Some(image) = &mut self.image {
            image.replace(id, def.to_fx())?;
        }
        if let Some(collider) = self.list.get_mut(index) {
            let Collider { slot, body, previous, next, def: ref before, .. } = *collider;
            self.more_outlines = self.more_outlines - more_outlines(before) + more_outlines(&def);
            self.kinds.count(before, core::ops::Sub::sub);
            self.kinds.count(&def, core::ops::Add::add);
            *collider = Collider::new(slot, body, def, [previous, next]);
            self.note(slot, body.slot);
        }
        Ok(())
    }

    pub(crate) fn remove(&mut self, id: ColliderId) -> Result<(), Error> {
        let index = self.find(id)?;
        if let Some(image) = &mut self.image {
            image.remove(id)?;
        }
        let Some(Collider { body, previous, next, def, .. }) = self.list.swap_remove(index) else {
            return Err(Error::NoSuchCollider { collider: id });
        };
        self.more_outlines -= more_outlines(&def);
        self.kinds.count(&def, core::ops::Sub::sub);
        if let Some(moved) = self.list.get(index) {
            self.slots.set_index(moved.slot, index as u32);
        }
        self.slots.release(id.slot);
        match self.at_mut(previous) {
            Some(previous) => previous.next = next,
            None => self.first[body.slot as usize] = next,
        }
        if let Some(next) = self.at_mut(next) {
            next.previous = previous;
        }
        self.note(id.slot, body.slot);
        Ok(())
    }

    /// The colliders of a body of the world, in no order.
    pub(crate) fn of(&self, body: BodyId) -> impl Iterator<Item = &Collider<S>> + Clone {
        self.of_slot(body.slot)
    }

    /// The colliders of the body in a slot, in no order.
    pub(crate) fn of_slot(&self, body: u32) -> impl Iterator<Item = &Collider<S>> + Clone {
        let mut slot = self.first.get(body as usize).copied().unwrap_or(NONE);
        core::iter::from_fn(move || {
            let collider = self.at(slot)?;
            slot = collider.next;
            Some(collider)
        })
    }

    /// The colliders of the body in a slot that touch others, in no order.
    pub(crate) fn solid_of_slot(&self, body: u32) -> impl Iterator<Item = &Collider<S>> + Clone {
        self.of_slot(body).filter(|collider| collider.def.is_solid())
    }

    /// Returns true if a collider of the body in a slot meets others.
    pub(crate) fn any_meeting_of_slot(&self, body: u32) -> bool {
        self.of_slot(body).any(|collider| collider.def.meets_others())
    }

    /// All colliders, in no order.
    pub(crate) fn list(&self) -> impl Iterator<Item = &Collider<S>> + Clone {
        self.list.iter()
    }

    /// The colliders by slot.
    pub(crate) fn iter(&self) -> impl Iterator<Item = &Collider<S>> {
        self.slots.all().iter().filter_map(|slot| slot.index().map(|index| &self.list[index]))
    }

    /// All slots: how often each was taken before, and its collider.
    pub(crate) fn slots(&self) -> impl ExactSizeIterator<Item = (u32, Option<&Collider<S>>)> {
        self.slots.all().iter().map(|slot| (slot.generation, slot.index().map(|index| &self.list[index])))
    }

    /// Generation of a slot; `None` beyond the last slot.
    pub(crate) fn generation(&self, slot: u32) -> Option<u32> {
        self.slots.generation(slot)
    }

    /// The slots to take again, the next one last.
    pub(crate) fn free(&self) -> &[u32] {
        self.slots.free()
    }

    /// Adds all colliders to a hash, and the state of their slots.
    pub(crate) fn write(&self, sink: &mut StateHasher) {
        codec::count(sink, self.slots.len());
        for (generation, collider) in self.slots() {
            generation.write(sink);
            collider.map(|collider| collider.digest).write(sink);
        }
        codec::count(sink, self.slots.free().len());
        sink.all(self.slots.free(), u32::to_le_bytes);
        self.write_material_pairs(sink);
    }
}

impl ColliderSet<Fx> {
    /// Adds a slot from a snapshot. *Domain* the collider was checked.
    pub(crate) fn rebuild(&mut self, generation: u32, collider: Option<(BodyId, ColliderDef)>) -> Result<(), Error> {
        self.check_room(1, collider.as_ref().map_or(0, |(_, def)| more_outlines(def)))?;
        let slot = self.slots.open(generation);
        if let Some((body, def)) = collider {
            self.place(slot, body, def);
        }
        Ok(())
    }

    /// Sets which slots to take again.
    ///
    /// # Errors
    /// [`Error::Inconsistent`] if one has a collider or is listed twice.
    pub(crate) fn set_free(&mut self, free: Vec<u32>) -> Result<(), Error> {
        if self.slots.set_free(free) { Ok(()) } else { Err(Error::Inconsistent) }
    }
}

/// The number of a collider's outlines beyond the first one.
pub(crate) fn more_outlines<S: Scalar>(def: &ColliderDef<S>) -> usize {
    def.shape.outlines().len() - 1
}

impl<S: Scalar> Collider<S> {
    fn new(slot: u32, body: BodyId, def: ColliderDef<S>, [previous, next]: [u32; 2]) -> Self {
        let mut outlines = def.shape.outlines_at(def.angle, def.position).map(BodyOutline::new);
        let count = outlines.len() as u32;
        let first = outlines.next().unwrap_or_else(|| BodyOutline::new(def.shape.outlines()[0].clone()));
        let larger = |max: S, radius: S| if radius > max { radius } else { max };
        let less = |min: S, width: S| if width < min { width } else { min };
        let (others, radius, width) = if count == 1 || def.shape.is_chain() {
            // The segments of a chain share their points, and have no width.
            (None, outlines.map(|outline| outline.radius).fold(first.radius, larger), first.width)
        } else {
            let others: Arc<[BodyOutline<S>]> = outlines.collect();
            let radius = others.iter().map(|outline| outline.radius).fold(first.radius, larger);
            let width = others.iter().map(|outline| outline.width).fold(first.width, less);
            (Some(others), radius, width)
        };
        let mut sink = StateHasher::new();
        body.write(&mut sink);
        def.write(&mut sink);
        let side = def.one_way.map(|one_way| one_way.side(def.angle));
        let (digest, physics_digest) = (sink.finish(), StateHasher::of(&def));
        Self {
            slot,
            body,
            previous,
            next,
            def,
            first,
            others,
            count,
            radius,
            width,
            side,
            digest,
            physics_digest,
            body_revision: 0,
        }
    }

    /// An outline by its number among the shape's: 0 unless the shape is a compound or a chain. *Domain* it is there.
    #[inline(always)]
    pub(crate) fn outline(&self, part: u32) -> OutlineRef<'_, S> {
        if part == 0 {
            return OutlineRef::Kept(&self.first);
        }
        match &self.others {
            Some(others) => OutlineRef::Kept(&others[part as usize - 1]),
            None => self.segment(part),
        }
    }

    /// The outline of a segment of a chain.
    #[cold]
    fn segment(&self, part: u32) -> OutlineRef<'_, S> {
        OutlineRef::Made(BodyOutline::new(self.first.outline.segment(part as usize)))
    }

    /// The number of outlines.
    #[inline(always)]
    pub(crate) fn outline_count(&self) -> u32 {
        self.count
    }

    /// Returns true if the body has other outlines than the first one of this collider.
    #[inline(always)]
    pub(crate) fn has_others(&self) -> bool {
        self.count > 1 || self.previous != NONE || self.next != NONE
    }

    /// Returns true for a disc around the centre of mass of its body that looks alike at all angles.
    pub(crate) fn is_central_disc(&self) -> bool {
        self.others.is_none()
            && self.side.is_none()
            && self.first.corners == (Aabb { min: Vec2::ZERO, max: Vec2::ZERO })
    }
}
