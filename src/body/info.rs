//! The properties of bodies that no step changes.

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::columns::{NONE, push};
use super::factors::Key;
use super::{BodyDef, BodyKind, Locks, Mass};
use crate::codec::{StateHasher, Write as _};
use crate::collider::ColliderMass;
use crate::scalar::{Factor as _, Scalar};

/// The properties of a body that no step changes, and few steps read.
#[derive(Clone, Debug)]
pub(crate) struct BodyInfo<S: Scalar> {
    pub(crate) kind: BodyKind,
    pub(crate) dominance: i32,
    pub(crate) force_groups: u32,
    pub(crate) is_bullet: bool,
    pub(crate) key: u64,
    pub(crate) user_data: u64,
    pub(crate) mass: Mass<S>,
    /// Follows from the colliders. Apart, as bodies without colliders are to take no room for it.
    collider_mass: Option<Arc<ColliderMass<S>>>,
}

fn kept<S: Scalar>(mass: ColliderMass<S>) -> Option<Arc<ColliderMass<S>>> {
    if mass.is_none() { None } else { Some(Arc::new(mass)) }
}

impl<S: Scalar> BodyInfo<S> {
    pub(super) fn new(def: &BodyDef<S>, collider_mass: ColliderMass<S>) -> Self {
        Self {
            kind: def.kind,
            dominance: def.dominance,
            force_groups: def.force_groups,
            is_bullet: def.bullet,
            key: def.key,
            user_data: def.user_data,
            mass: def.mass,
            collider_mass: kept(collider_mass),
        }
    }

    /// The mass of the colliders.
    pub(crate) fn collider_mass(&self) -> ColliderMass<S> {
        self.collider_mass.as_deref().copied().unwrap_or_default()
    }

    pub(super) fn set_collider_mass(&mut self, mass: ColliderMass<S>) {
        self.collider_mass = kept(mass);
    }

    /// Returns true if a field with these groups acts on the body.
    pub(crate) fn feels(&self, force_groups: u32) -> bool {
        self.kind == BodyKind::Dynamic && self.force_groups & force_groups != 0
    }

    /// The mass, kg; zero unless the body is dynamic.
    pub(crate) fn kilograms(&self) -> S {
        // The mass of a dynamic body was checked when it was set.
        match self.kind {
            BodyKind::Dynamic => self.mass.kilograms(&self.collider_mass()).unwrap_or(S::ZERO),
            _ => S::ZERO,
        }
    }

    /// The moment of inertia, kg·m²; zero stands for infinite, and is that of every body that is not dynamic.
    pub(crate) fn inertia(&self) -> S::Factor {
        self.inertia_for(self.kilograms())
    }

    /// The [`inertia`](Self::inertia) of a body whose mass in kg is at hand.
    pub(crate) fn inertia_for(&self, kilograms: S) -> S::Factor {
        match self.kind {
            BodyKind::Dynamic => self.mass.inertia(&self.collider_mass(), kilograms),
            _ => S::Factor::ZERO,
        }
    }

    /// A hash of the info, the key of the body's factors, and its locks.
    pub(super) fn digest(&self, key: &Key<S>, locks: Locks) -> u64 {
        let mut sink = StateHasher::new();
        self.kind.write(&mut sink);
        self.is_bullet.write(&mut sink);
        self.force_groups.write(&mut sink);
        self.key.write(&mut sink);
        self.user_data.write(&mut sink);
        self.mass.write(&mut sink);
        key.gravity_scale.write(&mut sink);
        key.linear.write(&mut sink);
        key.angular.write(&mut sink);
        key.most[0].write(&mut sink);
        key.most[1].write(&mut sink);
        locks.write(&mut sink);
        self.dominance.write(&mut sink);
        sink.finish().max(NOT_MADE + 1)
    }
}

const NOT_MADE: u64 = 0;

/// The number of entries for which the list of stale digests keeps its memory.
const STALE: usize = 256;

/// The properties of all bodies that no step changes. Copies of a world share the table until it is changed in one.
///
/// A slot without a body has no info: it takes as little memory as in a file, however many there are.
#[derive(Clone, Debug, Default)]
pub(super) struct BodyTable<S: Scalar> {
    /// The index of the info of each slot, or [`NONE`].
    at: Vec<u32>,
    infos: Vec<BodyInfo<S>>,
    /// The infos without a body, to be used again.
    vacant: Vec<u32>,
    /// The digests of the infos by slot, so that a hash of the world does not hash the infos again. The step after a change
    /// makes the new digest, once for all changes. Until then the digest is [`NOT_MADE`], which no digest is.
    digests: Vec<u64>,
    /// The slots whose digests were set to [`NOT_MADE`]. Some of them may have lost their body since.
    stale: Vec<u32>,
}

impl<S: Scalar> BodyTable<S> {
    /// The info of the body in a slot.
    pub(super) fn info(&self, slot: usize) -> &BodyInfo<S> {
        &self.infos[self.at[slot] as usize]
    }

    /// Changes the info of the body in a slot, or marks that its factors or locks have changed.
    pub(super) fn edit(&mut self, slot: usize, edit: impl FnOnce(&mut BodyInfo<S>)) {
        edit(&mut self.infos[self.at[slot] as usize]);
        if core::mem::replace(&mut self.digests[slot], NOT_MADE) != NOT_MADE {
            push(&mut self.stale, slot as u32);
        }
    }

    /// Returns true if there is anything to [`update`](Self::update).
    pub(super) fn is_stale(&self) -> bool {
        !self.stale.is_empty()
    }

    /// Makes the digests that are not up to date; `key` gives the key of the factors and the locks of the body in a slot.
    pub(super) fn update<'k>(&mut self, key: impl Fn(usize) -> (&'k Key<S>, Locks))
    where
        S: 'k,
    {
        for slot in self.stale.drain(..).map(|slot| slot as usize) {
            let info = self.infos.get(self.at[slot] as usize);
            let digest = |info: &BodyInfo<S>| {
                let (key, locks) = key(slot);
                info.digest(key, locks)
            };
            self.digests[slot] = info.map_or(!NOT_MADE, digest);
        }
        self.stale.shrink_to(STALE);
    }

    /// The up-to-date digest of the body in a slot.
    pub(super) fn digest(&self, slot: usize, key: &Key<S>, locks: Locks) -> u64 {
        match self.digests[slot] {
            NOT_MADE => self.info(slot).digest(key, locks),
            digest => digest,
        }
    }

    /// The digests by slot, if all are up to date.
    pub(super) fn digests(&self) -> Option<&[u64]> {
        self.stale.is_empty().then_some(&self.digests)
    }

    /// Adds a slot without a body.
    pub(super) fn open(&mut self) {
        push(&mut self.at, NONE);
        push(&mut self.digests, !NOT_MADE);
    }

    /// Puts the info of a body into a slot without one.
    pub(super) fn place(&mut self, slot: usize, info: BodyInfo<S>) {
        self.at[slot] = if let Some(at) = self.vacant.pop() {
            self.infos[at as usize] = info;
            at
        } else {
            push(&mut self.infos, info);
            (self.infos.len() - 1) as u32
        };
        self.edit(slot, |_| {});
    }

    /// Removes the info of the body in a slot.
    pub(super) fn remove(&mut self, slot: usize) {
        let at = core::mem::replace(&mut self.at[slot], NONE);
        self.vacant.push(at);
    }
}
