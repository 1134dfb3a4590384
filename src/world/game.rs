//! Data of a game that the world stores, so that snapshots, hashes and replays include it.

use super::{Command, World};
use crate::error::{Error, Quantity};
use crate::limits;
use crate::math::Random;
use crate::scalar::Scalar;

impl<S: Scalar> World<S> {
    /// The world's generator of random numbers.
    #[must_use]
    pub fn random(&self) -> &Random {
        &self.random
    }

    /// The world's generator of random numbers, to draw from. Drawing changes the state: peers that have to agree draw in the
    /// same ticks and in the same order.
    ///
    /// ```
    /// use umbra_physics::{Random, World, WorldDef};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// world.set_random(Random::seeded(42));
    /// let saved = world.clone();
    /// let drawn = world.random_mut().below(6);
    /// world.clone_from(&saved);
    /// assert_eq!(world.random_mut().below(6), drawn);
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn random_mut(&mut self) -> &mut Random {
        self.journal.note_draw();
        &mut self.random
    }

    /// Replaces the generator, for example to seed it.
    pub fn set_random(&mut self, random: Random) {
        self.random = random;
        self.journal.note(|| Command::SetRandom(random));
    }

    /// The game's own data as bytes, for everything beside the bodies that the rules of the next tick depend on.
    #[must_use]
    pub fn blob(&self) -> &[u8] {
        &self.blob
    }

    /// Replaces the game's own data.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Blob`].
    pub fn set_blob(&mut self, bytes: &[u8]) -> Result<(), Error> {
        Self::check_blob(bytes)?;
        self.blob.clear();
        self.blob.extend_from_slice(bytes);
        self.journal.note(|| Command::SetBlob(bytes.to_vec()));
        Ok(())
    }

    pub(super) fn check_blob(bytes: &[u8]) -> Result<(), Error> {
        if bytes.len() > limits::BLOB { Err(Error::OutOfRange { quantity: Quantity::Blob }) } else { Ok(()) }
    }
}
