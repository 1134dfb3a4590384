//! What a step does not change of a body.

use alloc::collections::BTreeMap;
use alloc::sync::Arc;
use alloc::vec::Vec;

use super::columns::{NONE, push};
use super::tuning::Key;
use super::{BodyDef, BodyKind, Locks, Mass, MassProperties, inertia_of, mass_of};
use crate::scalar::Scalar;
use crate::shape::Shape;
use crate::wire::{Sink, Write as _};

/// What a step does not change of a body, and rarely reads.
#[derive(Clone, Debug)]
pub(crate) struct Card<S: Scalar> {
    pub(crate) kind: BodyKind,
    pub(crate) locks: Locks,
    pub(crate) groups: u32,
    pub(crate) key: u64,
    pub(crate) user_data: u64,
    pub(crate) mass: Mass<S>,
    /// Of a dynamic body; zero for others.
    pub(crate) properties: MassProperties<S>,
    pub(crate) shape: Option<Arc<Shape<S>>>,
}

impl<S: Scalar> Card<S> {
    pub(super) fn new(def: &BodyDef<S>, shape: Option<Arc<Shape<S>>>, properties: MassProperties<S>) -> Self {
        Self {
            kind: def.kind,
            locks: def.locks,
            groups: def.groups,
            key: def.key,
            user_data: def.user_data,
            mass: def.mass,
            properties,
            shape,
        }
    }

    /// Whether a field with these groups acts on it.
    pub(crate) fn feels(&self, groups: u32) -> bool {
        self.kind == BodyKind::Dynamic && self.groups & groups != 0
    }

    /// kg; zero unless it is dynamic.
    pub(crate) fn kilograms(&self) -> S {
        // A dynamic body's mass was found in range when it was given.
        match self.kind {
            BodyKind::Dynamic => mass_of(self.mass, self.shape.as_deref()).unwrap_or(S::ZERO),
            _ => S::ZERO,
        }
    }

    /// kg·m²; zero for infinite, or unless it is dynamic.
    pub(crate) fn inertia(&self) -> S::Factor {
        inertia_of(self.kilograms(), self.mass, self.shape.as_deref())
    }

    /// A hash of all of it and of what its factors are made from.
    pub(super) fn digest(&self, key: &Key<S>) -> u64 {
        let mut sink = Sink::new();
        self.kind.write(&mut sink);
        self.groups.write(&mut sink);
        self.key.write(&mut sink);
        self.user_data.write(&mut sink);
        self.mass.write(&mut sink);
        key.gravity_scale.write(&mut sink);
        key.linear.write(&mut sink);
        key.angular.write(&mut sink);
        key.most[0].write(&mut sink);
        key.most[1].write(&mut sink);
        self.locks.write(&mut sink);
        self.shape.write(&mut sink);
        sink.finish()
    }
}

/// The shapes in use, each kept once however many bodies have one like it.
#[derive(Clone, Debug)]
pub(super) struct Shapes<S: Scalar>(BTreeMap<u64, (Arc<Shape<S>>, u32)>);

impl<S: Scalar> Default for Shapes<S> {
    fn default() -> Self {
        Self(BTreeMap::new())
    }
}

impl<S: Scalar> Shapes<S> {
    /// The shape that is kept; it is given back by [`release`](Self::release).
    pub(super) fn acquire(&mut self, shape: Shape<S>) -> Arc<Shape<S>> {
        let (kept, users) = self.0.entry(shape.digest()).or_insert_with(|| (Arc::new(shape.clone()), 0));
        if **kept == shape {
            *users += 1;
            kept.clone()
        } else {
            // Another shape has the same hash: this one is kept by its body alone.
            Arc::new(shape)
        }
    }

    pub(super) fn release(&mut self, shape: &Arc<Shape<S>>) {
        let digest = shape.digest();
        if let Some((_, users)) = self.0.get_mut(&digest).filter(|(kept, _)| Arc::ptr_eq(kept, shape)) {
            *users -= 1;
            if *users == 0 {
                self.0.remove(&digest);
            }
        }
    }
}

/// What no step changes of any body. Worlds that are copies of each other share it until one is changed.
///
/// A slot without a body has no card: it takes as little as in a file, however many there are.
#[derive(Clone, Debug)]
pub(super) struct Roster<S: Scalar> {
    /// Where the card of a slot is, or [`NONE`].
    at: Vec<u32>,
    cards: Vec<Card<S>>,
    /// Cards of bodies that are gone, to be used again.
    vacant: Vec<u32>,
    /// Those of the cards, by slot, so that a hash of the world need not look at what no step changes.
    pub(super) digests: Vec<u64>,
    pub(super) shapes: Shapes<S>,
}

impl<S: Scalar> Default for Roster<S> {
    fn default() -> Self {
        let (at, cards, vacant, digests) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Self { at, cards, vacant, digests, shapes: Shapes::default() }
    }
}

impl<S: Scalar> Roster<S> {
    /// The card of a slot with a body.
    pub(super) fn card(&self, slot: usize) -> &Card<S> {
        &self.cards[self.at[slot] as usize]
    }

    /// Changes the card of a slot with a body.
    pub(super) fn edit(&mut self, slot: usize, key: &Key<S>, edit: impl FnOnce(&mut Card<S>)) {
        let card = &mut self.cards[self.at[slot] as usize];
        edit(card);
        self.digests[slot] = card.digest(key);
    }

    /// One slot more.
    pub(super) fn open(&mut self) {
        push(&mut self.at, NONE);
        push(&mut self.digests, 0);
    }

    /// Gives a slot without a body a card.
    pub(super) fn place(&mut self, slot: usize, card: Card<S>, key: &Key<S>) {
        self.digests[slot] = card.digest(key);
        self.at[slot] = if let Some(at) = self.vacant.pop() {
            self.cards[at as usize] = card;
            at
        } else {
            push(&mut self.cards, card);
            (self.cards.len() - 1) as u32
        };
    }

    /// Takes the card of a slot away.
    pub(super) fn remove(&mut self, slot: usize) {
        let at = core::mem::replace(&mut self.at[slot], NONE);
        if let Some(shape) = self.cards[at as usize].shape.take() {
            self.shapes.release(&shape);
        }
        self.vacant.push(at);
    }
}
