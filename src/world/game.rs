//! What a game keeps in a world so that snapshots, hashes and replays carry it along.

use super::World;
use crate::error::{Error, Quantity};
use crate::limits;
use crate::math::Random;
use crate::scalar::Scalar;

impl<S: Scalar> World<S> {
    /// The world's generator of random numbers, as it is now.
    #[must_use]
    pub fn random(&self) -> &Random {
        &self.random
    }

    /// The world's generator of random numbers, to draw from. Drawing is a change of state: peers that are to agree draw
    /// alike, in the same tick and in the same order.
    ///
    /// ```
    /// use umbra_physics::{Random, World, WorldDef};
    ///
    /// let mut world: World = World::new(WorldDef::default())?;
    /// world.set_random(Random::seeded(42));
    /// let saved = world.clone();
    /// let drawn = world.random_mut().below(6);
    /// world.clone_from(&saved);
    /// assert_eq!(world.random_mut().below(6), drawn);
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn random_mut(&mut self) -> &mut Random {
        &mut self.random
    }

    /// Puts another generator in its place, to seed it, say.
    pub fn set_random(&mut self, random: Random) {
        self.random = random;
    }

    /// The game's own data: whatever else its next tick depends on, as bytes.
    #[must_use]
    pub fn blob(&self) -> &[u8] {
        &self.blob
    }

    /// Puts other bytes in their place.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Blob`].
    pub fn set_blob(&mut self, bytes: &[u8]) -> Result<(), Error> {
        Self::check_blob(bytes)?;
        self.blob.clear();
        self.blob.extend_from_slice(bytes);
        Ok(())
    }

    pub(super) fn check_blob(bytes: &[u8]) -> Result<(), Error> {
        if bytes.len() > limits::BLOB { Err(Error::OutOfRange { quantity: Quantity::Blob }) } else { Ok(()) }
    }
}
