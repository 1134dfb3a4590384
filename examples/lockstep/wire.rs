//! Messages between two peers: frames of a length, u16 little-endian, and that many bytes.

use std::io::{self, Read, Write};

use serde::{Deserialize, Serialize, de::DeserializeOwned};

use super::game::Controls;

/// Length of the longest frame. A longer one is not from a peer, and no memory is allocated for it.
const LONGEST: usize = 64;

/// The first bytes of a [`Hello`].
pub(crate) const MAGIC: [u8; 4] = *b"UMLS";

/// Settings that both peers must agree on before the first tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Hello {
    /// [`MAGIC`]: another program sends something else.
    pub(crate) magic: [u8; 4],
    /// [`umbra_physics::PHYSICS_VERSION`]: peers of other versions diverge sooner or later.
    pub(crate) physics_version: u32,
    /// The seed of the match.
    pub(crate) seed: u64,
    /// Number of ticks of the match.
    pub(crate) ticks: u64,
    /// The hash of the world at the start.
    pub(crate) start: u64,
}

/// Message of a peer at each tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Turn {
    /// The tick.
    pub(crate) tick: u64,
    /// The hash of the state before its step.
    pub(crate) hash: u64,
    /// The buttons for a future tick, later by the delay.
    pub(crate) controls: Controls,
}

impl Hello {
    /// First setting that two peers do not agree on, if any.
    pub(crate) fn differs_from(&self, rhs: &Self) -> Option<&'static str> {
        let differ = [
            (self.magic != rhs.magic, "game"),
            (self.physics_version != rhs.physics_version, "physics version"),
            (self.seed != rhs.seed, "seed"),
            (self.ticks != rhs.ticks, "number of ticks"),
            (self.start != rhs.start, "world to start from"),
        ];
        differ.into_iter().find(|(differs, _)| *differs).map(|(_, what)| what)
    }
}

/// # Errors
/// If the other side is gone.
pub(crate) fn send(to: &mut impl Write, message: &impl Serialize) -> io::Result<()> {
    let bytes = postcard::to_allocvec(message).map_err(io::Error::other)?;
    let length = u16::try_from(bytes.len()).map_err(io::Error::other)?;
    // In one write: without TCP's delays each write is a packet.
    to.write_all(&[&length.to_le_bytes(), &bytes[..]].concat())
}

/// # Errors
/// If the other side is gone or silent, or sends something else.
pub(crate) fn receive<T: DeserializeOwned>(from: &mut impl Read) -> io::Result<T> {
    let wrong = |what| io::Error::new(io::ErrorKind::InvalidData, what);
    let mut length = [0; 2];
    from.read_exact(&mut length)?;
    let length = usize::from(u16::from_le_bytes(length));
    if length > LONGEST {
        return Err(wrong("the other side sent a frame that is too long"));
    }
    let mut bytes = vec![0; length];
    from.read_exact(&mut bytes)?;
    match postcard::take_from_bytes(&bytes) {
        Ok((message, [])) => Ok(message),
        _ => Err(wrong("the other side sent something that is not the expected message")),
    }
}
