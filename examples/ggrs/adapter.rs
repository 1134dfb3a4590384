//! Adapter between GGRS and a world: it saves, loads and advances the game. A game can take this file as it is.

use std::fmt;

use ggrs::{Config, Frame, GgrsRequest, InputStatus, NULL_FRAME};
use umbra_physics::{Error, Snapshot, World};

/// Saved state of a frame, a game's [`Config::State`]. The snapshot can be taken out again: the next frame saved in the
/// same place reuses its memory, so that after the first frames nothing is allocated.
pub(crate) type Saved = Option<Snapshot>;

/// Number of frames whose hashes are kept; it must exceed the prediction window.
const HASHES: usize = 64;

/// A world that GGRS saves and restores.
pub(crate) struct Rollback {
    world: World,
    /// The tick of frame 0.
    start: u64,
    /// (frame, hash) of the frames saved last, each at its number modulo the length.
    hashes: [(Frame, u64); HASHES],
    work: Work,
}

/// Statistics of rolling back so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Work {
    /// Number of times a state was loaded.
    pub(crate) loads: u32,
    /// The number of frames that these loads undid.
    pub(crate) undone: u32,
    /// The most frames that one of them undid.
    pub(crate) deepest: u32,
}

/// Reason why a request cannot be fulfilled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Failure {
    /// The world refused something.
    Refused(Error),
    /// The world is at another tick than GGRS's frame: the game must step exactly once whenever it advances.
    OutOfStep {
        /// The frame.
        frame: Frame,
        /// The tick, counted from that of frame 0.
        ticks: u64,
    },
    /// GGRS asked for a frame that was not saved.
    NotSaved(Frame),
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self::Refused(error)
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Refused(error) => error.fmt(f),
            Self::OutOfStep { frame, ticks } => write!(f, "{ticks} ticks at frame {frame}"),
            Self::NotSaved(frame) => write!(f, "frame {frame} was not saved"),
        }
    }
}

impl std::error::Error for Failure {}

impl Rollback {
    /// Takes a world as it is at frame 0.
    pub(crate) fn new(world: World) -> Self {
        Self { start: world.tick(), world, hashes: [(NULL_FRAME, 0); HASHES], work: Work::default() }
    }

    /// Does what [`advance_frame`](ggrs::P2PSession::advance_frame) asks for, in the order it asks. `advance` gives the
    /// world a tick's inputs, by player, and steps it once.
    ///
    /// # Errors
    /// [`Failure`]: the session is over then.
    pub(crate) fn fulfil<C: Config<State = Saved>>(
        &mut self,
        requests: Vec<GgrsRequest<C>>,
        mut advance: impl FnMut(&mut World, &[(C::Input, InputStatus)]) -> Result<(), Error>,
    ) -> Result<(), Failure> {
        for request in requests {
            match request {
                GgrsRequest::SaveGameState { cell, frame } => {
                    self.check_step(frame)?;
                    let hash = self.world.state_hash();
                    self.hashes[frame as usize % HASHES] = (frame, hash);
                    // Nobody reads a frame that is about to be overwritten. Drop the guard before saving to the cell.
                    let mut saved: Saved = cell.data().and_then(|mut old| old.as_mut_dangerous().take());
                    match &mut saved {
                        Some(snapshot) => self.world.snapshot_into(snapshot),
                        None => saved = Some(self.world.snapshot()),
                    }
                    cell.save(frame, Some(saved), Some(hash.into()));
                }
                GgrsRequest::LoadGameState { cell, frame } => {
                    let before = self.world.tick();
                    match cell.data().as_deref() {
                        Some(Some(snapshot)) => self.world.restore(snapshot),
                        _ => return Err(Failure::NotSaved(frame)),
                    }
                    self.check_step(frame)?;
                    let undone = before.saturating_sub(self.world.tick()) as u32;
                    self.work.loads += 1;
                    self.work.undone += undone;
                    self.work.deepest = self.work.deepest.max(undone);
                }
                GgrsRequest::AdvanceFrame { inputs } => advance(&mut self.world, &inputs)?,
            }
        }
        Ok(())
    }

    /// The world at the present frame, to draw. Frames within GGRS's window may still be corrected.
    pub(crate) fn world(&self) -> &World {
        &self.world
    }

    /// The hash of a frame as it was saved last. It is final once the inputs of all frames before are confirmed.
    pub(crate) fn hash(&self, frame: Frame) -> Option<u64> {
        let (saved, hash) = self.hashes[frame as usize % HASHES];
        (saved == frame).then_some(hash)
    }

    /// Statistics of rolling back.
    pub(crate) fn work(&self) -> Work {
        self.work
    }

    fn check_step(&self, frame: Frame) -> Result<(), Failure> {
        let ticks = self.world.tick() - self.start;
        if i64::from(frame) == ticks as i64 { Ok(()) } else { Err(Failure::OutOfStep { frame, ticks }) }
    }
}
