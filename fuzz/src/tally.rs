//! Ticks of an input and the contacts in them: how much of the solver it reaches.

use std::cell::Cell;

use umbra_physics::{Activity, Scalar, World};

/// The steps of an input, and the touching manifolds after each of them.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tally {
    pub ticks: u64,
    /// The sum over all ticks.
    pub contacts: u64,
    /// The most after a tick.
    pub max_contacts: u64,
    /// The comparisons of a world with one without sleep while a body sleeps.
    pub slept: u64,
}

thread_local! {
    /// `None` where nobody asks: then counting costs nothing.
    static TALLY: Cell<Option<Tally>> = const { Cell::new(None) };
}

impl Tally {
    /// Runs an input of a target, and counts.
    #[must_use]
    pub fn of(run: fn(&[u8]), input: &[u8]) -> Self {
        TALLY.set(Some(Self::default()));
        run(input);
        TALLY.take().unwrap_or_default()
    }

    /// The mean number of touching manifolds in a tick.
    #[must_use]
    pub fn mean(&self) -> u64 {
        self.contacts / self.ticks.max(1)
    }
}

/// Counts a step of the first run of an input. What a second run repeats is not counted.
pub fn count<S: Scalar>(world: &World<S>) {
    count_contacts(|| world.contacts().count());
}

/// Counts a comparison with a world without sleep, if a body sleeps.
pub fn count_sleepers(world: &World) {
    if let Some(tally) = TALLY.get() {
        let any_asleep = world.bodies().any(|body| body.activity() == Activity::Asleep);
        TALLY.set(Some(Tally { slept: tally.slept + u64::from(any_asleep), ..tally }));
    }
}

/// Returns true if somebody asks, in this thread.
pub fn is_asked_for() -> bool {
    TALLY.get().is_some()
}

/// Counts a step with so many touching manifolds.
pub fn count_contacts(number: impl FnOnce() -> usize) {
    if let Some(tally) = TALLY.get() {
        let here = number() as u64;
        let (ticks, contacts, max_contacts) = (tally.ticks + 1, tally.contacts + here, tally.max_contacts.max(here));
        TALLY.set(Some(Tally { ticks, contacts, max_contacts, ..tally }));
    }
}
