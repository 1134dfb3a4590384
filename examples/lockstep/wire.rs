//! Messages between two peers: frames of a length, u16 little-endian, and that many bytes.

use std::io::{self, Read, Write};

/// Length of the longest frame. A longer one is not from a peer, and no memory is allocated for it.
const LONGEST: usize = 64;

const MAGIC: [u8; 4] = *b"UMLS";

/// Settings that both peers must agree on before the first tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Hello {
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
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Turn {
    /// The tick.
    pub(crate) tick: u64,
    /// The hash of the state before its step.
    pub(crate) hash: u64,
    /// The buttons for a future tick, later by the delay.
    pub(crate) controls: u8,
}

fn wrong(what: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, what)
}

impl Hello {
    /// # Errors
    /// If the other side is gone.
    pub(crate) fn send(&self, to: &mut impl Write) -> io::Result<()> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend(self.physics_version.to_le_bytes());
        [self.seed, self.ticks, self.start].iter().for_each(|word| bytes.extend(word.to_le_bytes()));
        send(to, &bytes)
    }

    /// # Errors
    /// If the other side is gone, silent, or no peer of this game.
    pub(crate) fn receive(from: &mut impl Read) -> io::Result<Self> {
        let mut frame = Frame::receive(from)?;
        if frame.take()? != MAGIC {
            return Err(wrong("the other side is no peer of this game"));
        }
        let physics_version = u32::from_le_bytes(frame.take()?);
        let (seed, ticks, start) = (frame.word()?, frame.word()?, frame.word()?);
        frame.end()?;
        Ok(Self { physics_version, seed, ticks, start })
    }

    /// First setting that two peers do not agree on, if any.
    pub(crate) fn differs_from(&self, other: &Self) -> Option<&'static str> {
        let differ = [
            (self.physics_version != other.physics_version, "physics version"),
            (self.seed != other.seed, "seed"),
            (self.ticks != other.ticks, "number of ticks"),
            (self.start != other.start, "world to start from"),
        ];
        differ.into_iter().find(|(differs, _)| *differs).map(|(_, what)| what)
    }
}

impl Turn {
    /// # Errors
    /// If the other side is gone.
    pub(crate) fn send(&self, to: &mut impl Write) -> io::Result<()> {
        let mut bytes = Vec::with_capacity(17);
        [self.tick, self.hash].iter().for_each(|word| bytes.extend(word.to_le_bytes()));
        bytes.push(self.controls);
        send(to, &bytes)
    }

    /// The turn of this tick.
    ///
    /// # Errors
    /// If the other side is gone or silent, or says something else.
    pub(crate) fn receive(from: &mut impl Read, tick: u64) -> io::Result<Self> {
        let mut frame = Frame::receive(from)?;
        let turn = Self { tick: frame.word()?, hash: frame.word()?, controls: u8::from_le_bytes(frame.take()?) };
        frame.end()?;
        if turn.tick == tick { Ok(turn) } else { Err(wrong("a turn is missing")) }
    }
}

fn send(to: &mut impl Write, bytes: &[u8]) -> io::Result<()> {
    // In one write: without TCP's delays each write is a packet.
    let length = u16::try_from(bytes.len()).map_err(|_| wrong("too much for a frame"))?;
    let mut frame = length.to_le_bytes().to_vec();
    frame.extend(bytes);
    to.write_all(&frame)
}

/// The bytes of a frame that are not read yet.
struct Frame(Vec<u8>);

impl Frame {
    fn receive(from: &mut impl Read) -> io::Result<Self> {
        let mut length = [0; 2];
        from.read_exact(&mut length)?;
        let length = usize::from(u16::from_le_bytes(length));
        if length > LONGEST {
            return Err(wrong("a frame that is too long"));
        }
        let mut bytes = vec![0; length];
        from.read_exact(&mut bytes)?;
        bytes.reverse();
        Ok(Self(bytes))
    }

    fn take<const N: usize>(&mut self) -> io::Result<[u8; N]> {
        let mut taken = [0; N];
        for byte in &mut taken {
            // The next byte is the last, because the bytes were reversed.
            *byte = self.0.pop().ok_or(wrong("a frame that is too short"))?;
        }
        Ok(taken)
    }

    fn word(&mut self) -> io::Result<u64> {
        self.take().map(u64::from_le_bytes)
    }

    fn end(self) -> io::Result<()> {
        if self.0.is_empty() { Ok(()) } else { Err(wrong("a frame that is too long")) }
    }
}
