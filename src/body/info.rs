//! What a step does not change of a body.

use alloc::collections::BTreeMap;
use alloc::sync::Arc;
use alloc::vec::Vec;

use super::columns::{NONE, push};
use super::factors::Key;
use super::mass::{inertia_of, mass_of};
use super::{BodyDef, BodyKind, Locks, Mass};
use crate::codec::{StateHasher, Write as _};
use crate::scalar::Scalar;
use crate::shape::Shape;

/// What a step does not change of a body, and rarely reads.
#[derive(Clone, Debug)]
pub(crate) struct BodyInfo<S: Scalar> {
    pub(crate) kind: BodyKind,
    pub(crate) groups: u32,
    pub(crate) key: u64,
    pub(crate) user_data: u64,
    pub(crate) mass: Mass<S>,
    pub(crate) shape: Option<Arc<Shape<S>>>,
}

impl<S: Scalar> BodyInfo<S> {
    pub(super) fn new(def: &BodyDef<S>, shape: Option<Arc<Shape<S>>>) -> Self {
        Self { kind: def.kind, groups: def.groups, key: def.key, user_data: def.user_data, mass: def.mass, shape }
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

    /// A hash of the info, the locks, and the parameters its factors are made from.
    pub(super) fn digest(&self, (key, locks): (&Key<S>, Locks)) -> u64 {
        let mut sink = StateHasher::new();
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
        locks.write(&mut sink);
        self.shape.write(&mut sink);
        sink.finish()
    }
}

/// The shapes in use, each kept once however many bodies have one like it: two bodies share their shape if and only if it is
/// the same. By the hash and, for shapes with one hash, a number.
#[derive(Clone, Debug)]
pub(super) struct Shapes<S: Scalar>(BTreeMap<(u64, u32), Kept<S>>);

/// A shape, and how many bodies have it.
type Kept<S> = (Arc<Shape<S>>, u32);

impl<S: Scalar> Default for Shapes<S> {
    fn default() -> Self {
        Self(BTreeMap::new())
    }
}

impl<S: Scalar> Shapes<S> {
    /// The shape that is kept; it is given back by [`release`](Self::release).
    pub(super) fn acquire(&mut self, shape: Shape<S>) -> Arc<Shape<S>> {
        let digest = shape.digest();
        let mut free = 0;
        for (&(_, number), (kept, users)) in self.0.range_mut((digest, 0)..=(digest, u32::MAX)) {
            if **kept == shape {
                *users += 1;
                return kept.clone();
            }
            free += u32::from(number == free);
        }
        let shape = Arc::new(shape);
        self.0.insert((digest, free), (shape.clone(), 1));
        shape
    }

    pub(super) fn release(&mut self, shape: &Arc<Shape<S>>) {
        let digest = shape.digest();
        let mut alike = self.0.range_mut((digest, 0)..=(digest, u32::MAX));
        if let Some((&key, (_, users))) = alike.find(|(_, (kept, _))| Arc::ptr_eq(kept, shape)) {
            *users -= 1;
            if *users == 0 {
                self.0.remove(&key);
            }
        }
    }
}

const NOT_MADE: u64 = 0;

/// The list of slots to make digests of keeps room for so many.
const STALE: usize = 256;

/// What no step changes of any body. Worlds that are copies of each other share it until one is changed.
///
/// A slot without a body has no card: it takes as little as in a file, however many there are.
#[derive(Clone, Debug)]
pub(super) struct BodyTable<S: Scalar> {
    /// Where the card of a slot is, or [`NONE`].
    at: Vec<u32>,
    cards: Vec<BodyInfo<S>>,
    /// Cards of bodies that are gone, to be used again.
    vacant: Vec<u32>,
    /// Those of the cards, by slot, so that a hash of the world need not look at what no step changes. They are made by the
    /// step after a change, once: a shape may be large, and a call that changes something else small. Until then one is
    /// [`NOT_MADE`]; one that happens to have that value is made each time it is asked for.
    digests: Vec<u64>,
    /// The slots whose digests were set to [`NOT_MADE`]; some of them may have been vacated since.
    stale: Vec<u32>,
    pub(super) shapes: Shapes<S>,
}

impl<S: Scalar> Default for BodyTable<S> {
    fn default() -> Self {
        let (at, cards, vacant, digests) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Self { at, cards, vacant, digests, stale: Vec::new(), shapes: Shapes::default() }
    }
}

impl<S: Scalar> BodyTable<S> {
    /// The card of a slot with a body.
    pub(super) fn info(&self, slot: usize) -> &BodyInfo<S> {
        &self.cards[self.at[slot] as usize]
    }

    /// Changes the card of a slot with a body, or what its factors are made from.
    pub(super) fn edit(&mut self, slot: usize, edit: impl FnOnce(&mut BodyInfo<S>)) {
        edit(&mut self.cards[self.at[slot] as usize]);
        if core::mem::replace(&mut self.digests[slot], NOT_MADE) != NOT_MADE {
            push(&mut self.stale, slot as u32);
        }
    }

    /// Whether there is anything to [`update`](Self::update).
    pub(super) fn is_stale(&self) -> bool {
        !self.stale.is_empty()
    }

    /// Makes the digests that are not up to date; `key` gives what the factors of the body in a slot are made from.
    pub(super) fn update<'k>(&mut self, key: impl Fn(usize) -> (&'k Key<S>, Locks))
    where
        S: 'k,
    {
        for slot in self.stale.drain(..).map(|slot| slot as usize) {
            let info = self.cards.get(self.at[slot] as usize);
            self.digests[slot] = info.map_or(!NOT_MADE, |info| info.digest(key(slot)));
        }
        self.stale.shrink_to(STALE);
    }

    /// The digest of a slot with a body as it is up to date.
    pub(super) fn digest(&self, slot: usize, key: (&Key<S>, Locks)) -> u64 {
        match self.digests[slot] {
            NOT_MADE => self.info(slot).digest(key),
            digest => digest,
        }
    }

    /// All digests by slot, if all are up to date.
    pub(super) fn digests(&self) -> Option<&[u64]> {
        self.stale.is_empty().then_some(&self.digests)
    }

    /// One slot more.
    pub(super) fn open(&mut self) {
        push(&mut self.at, NONE);
        push(&mut self.digests, !NOT_MADE);
    }

    /// Gives a slot without a body a card.
    pub(super) fn place(&mut self, slot: usize, info: BodyInfo<S>) {
        self.at[slot] = if let Some(at) = self.vacant.pop() {
            self.cards[at as usize] = info;
            at
        } else {
            push(&mut self.cards, info);
            (self.cards.len() - 1) as u32
        };
        self.edit(slot, |_| {});
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::fx::fx;

    /// As if two shapes had one hash, in whichever order the bodies come and go that have them.
    #[test]
    fn shapes_with_one_hash_are_kept_once_each() {
        let [ours, other] = [fx!(1), fx!(2)].map(|radius| Shape::circle(radius).expect("a size"));
        let mut shapes = Shapes::default();
        shapes.0.insert((ours.digest(), 0), (Arc::new(other), 1));
        let [first, second] = [(); 2].map(|()| shapes.acquire(ours.clone()));
        assert!(Arc::ptr_eq(&first, &second) && *first == ours);
        shapes.0.remove(&(ours.digest(), 0));
        assert!(Arc::ptr_eq(&first, &shapes.acquire(ours.clone())));
        (0..3).for_each(|_| shapes.release(&first));
        assert!(shapes.0.is_empty());
    }
}
