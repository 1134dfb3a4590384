//! Adapter between GGRS and a world: it saves, loads and advances the game. A game can take this file as it is.

use std::error::Error;

use ggrs::{Config, Frame, GgrsRequest, InputStatus, NULL_FRAME};
use umbra_physics::{Snapshot, World};

/// Saved state of a frame, a game's [`Config::State`]. The snapshot can be taken out again: the next frame saved in the
/// same place reuses its memory, so that after the first frames nothing is allocated.
pub(crate) type Saved = Option<Snapshot>;

/// Number of frames whose hashes are kept; it must exceed the prediction window.
const HASHES: usize = 64;

/// A world that GGRS saves and restores.
pub(crate) struct GgrsWorld {
    /// The world at the present frame, to draw. Frames within GGRS's window may still be corrected.
    pub(crate) world: World,
    /// The number of loads of a state, of the frames that all of them undid, and the most frames that one load undid.
    pub(crate) loads: u32,
    pub(crate) undone: u32,
    pub(crate) deepest: u32,
    /// The tick of frame 0.
    start: u64,
    /// (frame, hash) of the frames saved last, each at its number modulo the length.
    hashes: [(Frame, u64); HASHES],
}

impl GgrsWorld {
    /// Takes a world as it is at frame 0.
    pub(crate) fn new(world: World) -> Self {
        let start = world.tick();
        Self { world, loads: 0, undone: 0, deepest: 0, start, hashes: [(NULL_FRAME, 0); HASHES] }
    }

    /// Does what [`advance_frame`](ggrs::P2PSession::advance_frame) asks for, in the order it asks. `tick` makes the calls of
    /// a tick from its inputs, by player; after it the world is stepped.
    ///
    /// # Errors
    /// If `tick` steps or restores the world, or GGRS loads a frame that was not saved.
    pub(crate) fn fulfil<C: Config<State = Saved>>(
        &mut self,
        requests: Vec<GgrsRequest<C>>,
        mut tick: impl FnMut(&mut World, &[(C::Input, InputStatus)]),
    ) -> Result<(), Box<dyn Error>> {
        for request in requests {
            match request {
                GgrsRequest::SaveGameState { cell, frame } => {
                    if self.frame() != i64::from(frame) {
                        return Err(format!("{} ticks at frame {frame}: `tick` must not step", self.frame()).into());
                    }
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
                    let before = self.frame();
                    match cell.data().as_deref() {
                        Some(Some(snapshot)) => self.world.restore(snapshot),
                        _ => return Err(format!("frame {frame} was not saved").into()),
                    }
                    let undone = (before - self.frame()) as u32;
                    self.loads += 1;
                    self.undone += undone;
                    self.deepest = self.deepest.max(undone);
                }
                GgrsRequest::AdvanceFrame { inputs } => {
                    tick(&mut self.world, &inputs);
                    self.world.step();
                }
            }
        }
        Ok(())
    }

    /// The hash of a frame as it was saved last. It is final once the inputs of all frames before are confirmed.
    pub(crate) fn hash(&self, frame: Frame) -> Option<u64> {
        let (saved, hash) = self.hashes[frame as usize % HASHES];
        (saved == frame).then_some(hash)
    }

    fn frame(&self) -> i64 {
        self.world.tick() as i64 - self.start as i64
    }
}
