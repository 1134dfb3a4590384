//! Commands as bytes.

use alloc::vec::Vec;

use super::commands::Command;
use crate::codec::{Malformed, Read as _, Reader, Write as _};

impl Command {
    /// The largest number of bytes of a command without colliders or a blob. A collider takes 76 and its shape, 9 for a circle, 5 and 16 a
    /// corner for a polygon; a blob its length.
    pub const BYTES: usize = 174;

    /// The smallest number of bytes: [`ClearForces`](Self::ClearForces) is its number alone.
    pub(crate) const LEAST_BYTES: usize = 1;

    /// Encodes the command: the same bytes on every machine, as `docs/formats.md` describes them.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.write(&mut bytes);
        bytes
    }

    /// Decodes a command. [`World::check`](super::World::check) says whether a world would refuse it. Decoding takes at most 16
    /// bytes of memory for each byte read, and 64 KiB.
    ///
    /// # Errors
    /// [`Malformed`] with the place of the first byte that no command has there.
    ///
    /// ```
    /// use umbra_physics::{BodyId, Command, vec2};
    ///
    /// let command: Command = Command::SetVelocity { body: BodyId::from_parts(3, 0), velocity: vec2(1, 0) };
    /// let bytes = command.to_bytes();
    /// assert_eq!(bytes.len(), 25);
    /// assert_eq!(Command::from_bytes(&bytes), Ok(command));
    /// assert!(Command::from_bytes(&bytes[..24]).is_err());
    /// ```
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, Malformed> {
        let mut reader = Reader::new(bytes);
        let command = Self::read(&mut reader)?;
        reader.end()?;
        Ok(command)
    }
}
