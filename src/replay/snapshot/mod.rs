//! Snapshots: a world saved in memory or as bytes, and the hash of its state.
//!
//! `write` walks over a world, `read` rebuilds one from bytes and refuses what cannot be a world, `hash` has the state hash,
//! `before` keeps what calls change so that the world before them can still be saved.

mod before;
mod error;
mod hash;
mod owner;
mod read;
mod write;

use alloc::sync::Arc;
use alloc::vec::Vec;
use core::fmt;

use crate::codec::{Reader, Write as _};
use crate::force::CustomForce;
use crate::fx::Fx;
use crate::scalar::Scalar;
use crate::world::World;

pub(super) use before::{BeforeCalls, restless_sleepers};
pub use error::SnapshotError;
pub use hash::PHYSICS_VERSION;
pub use owner::Owner;
pub(super) use read::{read, read_unsealed};
pub(super) use write::{Saved, State};

/// A saved world: to go back to, to send, or to keep.
///
/// In memory a snapshot is a copy of what steps change, 121 bytes a body (169 with
/// [`PublishedVerlet`](crate::Integrator::PublishedVerlet)); the rest is shared until the world changes it. As bytes it is the
/// same on every machine. There a body takes 143 to 191 bytes, by how many of its options are set. It takes 48 more with
/// `PublishedVerlet`, 72 more if a force waits for the next step, and 8 more if a call woke it since the last one: at most 319
/// bytes. A kinematic body with a goal takes 26 more. A collider with a circle takes 124, or 148 if it is one-way.
///
/// A restored world has the same hash, handles and future as the saved one, in another process or on another machine too.
/// A world read from bytes reports nothing of the steps before; only the bodies that calls had woken or put to sleep are still reported.
/// Restoring drops everything made after the snapshot: a handle from that abandoned future may later
/// name another body.
///
/// ```
/// use umbra_physics::{BodyDef, Snapshot, World, WorldDef, vec2};
///
/// let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
/// let ball = world.add_body(BodyDef::dynamic())?;
/// let saved = world.snapshot();
/// for _ in 0..60 {
///     world.step();
/// }
/// let after = world.state_hash();
///
/// world.restore(&saved);
/// for _ in 0..60 {
///     world.step();
/// }
/// assert_eq!(world.state_hash(), after);
///
/// // The same over the network or from a file.
/// let bytes = saved.to_bytes();
/// let mut restored = Snapshot::from_bytes(&bytes, &[])?.into_world();
/// for _ in 0..60 {
///     restored.step();
/// }
/// assert_eq!(restored.state_hash(), after);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Snapshot<S: Scalar = Fx> {
    world: World<S>,
}

clone_by_field!(Snapshot { world });

impl<S: Scalar> fmt::Debug for Snapshot<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Snapshot").field(&self.world).finish()
    }
}

impl<S: Scalar> World<S> {
    /// Saves the world in memory.
    #[must_use]
    pub fn snapshot(&self) -> Snapshot<S> {
        Snapshot { world: self.clone() }
    }

    /// Saves the world into an existing snapshot, whose memory is used again.
    pub fn snapshot_into(&self, snapshot: &mut Snapshot<S>) {
        snapshot.world.keep(self);
    }

    /// Goes back to a snapshot, of this world or another.
    pub fn restore(&mut self, snapshot: &Snapshot<S>) {
        self.clone_from(&snapshot.world);
    }
}

impl<S: Scalar> Snapshot<S> {
    /// The saved world.
    #[must_use]
    pub fn world(&self) -> &World<S> {
        &self.world
    }

    /// The saved world, to go on with.
    #[must_use]
    pub fn into_world(self) -> World<S> {
        self.world
    }
}

impl Snapshot {
    /// The snapshot as bytes, the same on every machine; `docs/formats.md` describes them one by one.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.write_to(&mut bytes);
        bytes
    }

    /// Appends the bytes to a buffer.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, Snapshot, World, WorldDef};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// world.add_body(BodyDef::dynamic())?;
    /// let mut message = b"state: ".to_vec();
    /// world.snapshot().write_to(&mut message);
    /// let restored = Snapshot::from_bytes(&message[7..], &[])?.into_world();
    /// assert_eq!(restored.state_hash(), world.state_hash());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn write_to(&self, bytes: &mut Vec<u8>) {
        Saved(&self.world).write(bytes);
    }

    /// Reads a snapshot from bytes. The custom forces that the world uses must be among those given.
    ///
    /// The bytes need not be trusted: a state that no world can have is refused. Reading takes at most 16 bytes of memory
    /// for each input byte and 64 KiB, the snapshot included, so that a limit on the input is a limit on both.
    ///
    /// # Errors
    /// A [`SnapshotError`].
    pub fn from_bytes(bytes: &[u8], custom_forces: &[Arc<dyn CustomForce>]) -> Result<Self, SnapshotError> {
        let mut reader = Reader::new(bytes);
        let world = read(&mut reader, custom_forces)?;
        reader.end()?;
        Ok(Self { world })
    }
}
