//! The events of a run, as a list.

use std::collections::BTreeMap;

/// Bodies that an event of many names.
const NAMED: usize = 6;
/// The largest number of events in the list. More are counted.
const EVENTS: usize = 10_000;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum What {
    Added,
    Removed,
    Slept,
    Woke,
    Quarantined,
    Released,
    Disabled,
    Enabled,
    /// A command to the world, or to a body other than adding or removing it.
    Input,
    /// The run is not the one that was recorded.
    Diverged,
}

/// Event of a tick, with all its bodies.
#[derive(Clone, Debug)]
pub(super) struct Event {
    pub(super) tick: u64,
    /// The last tick of those at which it was done over and over.
    pub(super) until: u64,
    pub(super) what: What,
    pub(super) text: String,
    /// The first of the bodies, as indices of lives, and how many there are.
    pub(super) bodies: Vec<usize>,
    pub(super) count: usize,
}

/// The events of a run, in the order in which they were told.
#[derive(Clone, Debug, Default)]
pub(super) struct Events {
    pub(super) told: Vec<Event>,
    /// The number of events that were too many.
    pub(super) untold: u64,
    /// The latest event of each input, by what it says; None for a run that is not the recorded one.
    inputs: BTreeMap<Option<String>, usize>,
}

impl Events {
    /// An event, or one body more in an event of this tick.
    pub(super) fn tell(&mut self, tick: u64, what: What, body: Option<usize>, text: String) {
        let mut latest = self.told.iter_mut().rev().take_while(|event| event.tick == tick);
        if let Some(event) = latest.find(|event| event.what == what && event.text == text && body.is_some()) {
            event.count += 1;
            if event.bodies.len() < NAMED {
                event.bodies.extend(body);
            }
            return;
        }
        if self.told.len() == EVENTS {
            self.untold += 1;
            return;
        }
        let bodies: Vec<usize> = body.into_iter().collect();
        self.told.push(Event { tick, until: tick, what, text, count: bodies.len(), bodies });
    }

    /// An event that goes on as long as it is told again each tick.
    pub(super) fn repeat(&mut self, tick: u64, what: What, text: String) {
        let key = (what == What::Input).then(|| text.clone());
        if let Some(event) = self.inputs.get(&key).map(|&index| &mut self.told[index]) {
            if event.until + 1 == tick {
                event.until = tick;
                return;
            }
        }
        let before = self.told.len();
        self.tell(tick, what, None, text);
        if self.told.len() > before {
            self.inputs.insert(key, before);
        }
    }
}
