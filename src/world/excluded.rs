//! Pairs of bodies that do not touch each other, as calls change and read them.

use super::{Command, World};
use crate::body::Change;
use crate::contact::{ExcludedPair, Exclusion, sorted};
use crate::error::Error;
use crate::limits;
use crate::scalar::Scalar;
use crate::slots::BodyId;

impl<S: Scalar> World<S> {
    /// Excludes two bodies from contacts with each other, with all of their colliders, and wakes both. The impulses of contacts between
    /// them are dropped. A pair that is excluded already gets the new exclusion. Removing one of the bodies removes the pair.
    ///
    /// [`Exclusion::UntilApart`] is for bodies that overlap: a grenade and its thrower, a character that drops through a platform. A step
    /// allows the pair again when the bodies are farther apart than 2 cm plus the distance by which they approach each other in the step.
    /// While one of them is disabled or quarantined they stay excluded.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`]; [`Error::SameBody`]; [`Error::Full`] for more than [`limits::EXCLUDED_PAIRS`].
    ///
    /// ```
    /// use umbra_physics::{BodyDef, Exclusion, Shape, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let ball = BodyDef::dynamic().with_collider(Shape::circle(fx!(0.5))?);
    /// let ghost = world.add_body(BodyDef { velocity: vec2(6, 0), ..ball.clone() })?;
    /// let post = world.add_body(BodyDef { position: vec2(3, 0), ..ball })?;
    /// world.exclude_pair(ghost, post, Exclusion::Always)?;
    /// (0..60).for_each(|_| _ = world.step());
    /// assert_eq!((world.body(ghost)?.position(), world.body(post)?.position()), (vec2(6, 0), vec2(3, 0)));
    /// assert!(world.excluded_pairs().eq([([ghost, post], Exclusion::Always)]));
    /// world.allow_pair(ghost, post)?;
    /// assert_eq!(world.excluded_pairs().count(), 0);
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn exclude_pair(&mut self, a: BodyId, b: BodyId, exclusion: Exclusion) -> Result<(), Error> {
        let place = self.check_excluded(a, b)?;
        self.touch(a, Change::VELOCITY)?;
        self.touch(b, Change::VELOCITY)?;
        self.journal.note(|| Command::ExcludePair { a, b, exclusion });
        let pair = ExcludedPair { bodies: sorted(a, b), exclusion };
        match place {
            Ok(index) => self.contacts.excluded[index] = pair,
            Err(index) => self.contacts.excluded.insert(index, pair),
        }
        self.end_contacts_between(pair.bodies);
        Ok(())
    }

    /// Drops the impulses of contacts between two bodies, which were woken, by their slots, the lower one first.
    pub(super) fn end_contacts_between(&mut self, bodies: [u32; 2]) {
        let colliders = self.colliders.fixed();
        let is_one = |slots: [u32; 2]| match slots.map(|slot| colliders.at(slot).map(|collider| collider.body)) {
            [Some(first), Some(second)] => sorted(first, second) == bodies,
            _ => true,
        };
        let contacts = &mut self.contacts;
        if colliders.any_contact_events() {
            contacts.keep_ends_of(&self.bodies, colliders, is_one);
        }
        contacts.records.retain(|record| !is_one(record.pair().map(|outline| outline.slot)));
    }

    /// Allows contacts between two bodies again, and wakes both, also if they were not excluded.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`]; [`Error::SameBody`].
    pub fn allow_pair(&mut self, a: BodyId, b: BodyId) -> Result<(), Error> {
        self.check_two(a, b)?;
        self.touch(a, Change::VELOCITY)?;
        self.touch(b, Change::VELOCITY)?;
        self.journal.note(|| Command::AllowPair { a, b });
        if let Ok(index) = self.contacts.find_excluded(sorted(a, b)) {
            self.contacts.excluded.remove(index);
        }
        Ok(())
    }

    /// The pairs of bodies that are excluded from contacts, sorted by their slots.
    pub fn excluded_pairs(&self) -> impl Iterator<Item = ([BodyId; 2], Exclusion)> {
        let id = |slot| BodyId::from_parts(slot, self.bodies.generation(slot).unwrap_or_default());
        self.contacts.excluded.iter().map(move |pair| (pair.bodies.map(id), pair.exclusion))
    }

    pub(super) fn check_two(&self, a: BodyId, b: BodyId) -> Result<(), Error> {
        self.bodies.find(a)?;
        self.bodies.find(b)?;
        if a == b { Err(Error::SameBody { body: a }) } else { Ok(()) }
    }

    /// The place in the list of a pair that is excluded already, or the one where it belongs.
    pub(super) fn check_excluded(&self, a: BodyId, b: BodyId) -> Result<Result<usize, usize>, Error> {
        self.check_two(a, b)?;
        let place = self.contacts.find_excluded(sorted(a, b));
        let is_full = self.contacts.excluded.len() >= limits::EXCLUDED_PAIRS;
        if is_full && place.is_err() { Err(Error::Full) } else { Ok(place) }
    }
}
