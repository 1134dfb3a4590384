//! The changes of a world between two steps, as commands: for a [`Rollback`](super::Rollback) that records its ticks and
//! notices changes made outside of them.

use alloc::vec::Vec;

use super::Command;
use crate::math::Random;
use crate::scalar::Scalar;

/// The changes since the journal was started; nothing while it is off. It is no part of the state.
#[derive(Default)]
pub(crate) struct Journal<S: Scalar> {
    is_on: bool,
    /// The calls that changed the world, in their order.
    commands: Vec<Command<S>>,
    /// True if the random generator was handed out to draw from.
    has_drawn: bool,
}

/// A copy of a world has a journal of its own, which is off. A world that becomes a copy goes on with its journal.
impl<S: Scalar> Clone for Journal<S> {
    fn clone(&self) -> Self {
        Self::default()
    }

    fn clone_from(&mut self, _: &Self) {}
}

impl<S: Scalar> Journal<S> {
    /// Notes a change.
    #[inline]
    pub(super) fn note(&mut self, command: impl FnOnce() -> Command<S>) {
        if self.is_on {
            self.commands.push(command());
        }
    }

    /// Notes that the random generator is handed out.
    pub(super) fn note_draw(&mut self) {
        self.has_drawn = true;
    }

    /// Forgets what was noted, and notes changes from now on.
    pub(super) fn start(&mut self) {
        (self.is_on, self.has_drawn) = (true, false);
        self.commands.clear();
    }

    /// Returns true if it was started and nothing was noted since.
    pub(super) fn is_empty(&self) -> bool {
        self.is_on && self.commands.is_empty() && !self.has_drawn
    }

    /// Exchanges the commands for an empty list. `random` is the world's generator as it is now.
    pub(super) fn take(&mut self, random: Random, commands: &mut Vec<Command<S>>) {
        if self.has_drawn {
            self.commands.push(Command::SetRandom(random));
        }
        core::mem::swap(&mut self.commands, commands);
        self.start();
    }
}
