//! The events of a run, as a list.

use std::collections::BTreeMap;

/// Bodies that an event of many names.
const NAMED: usize = 6;
/// The largest number of events of a group in the list. More are counted.
pub(super) const EVENTS: usize = 10_000;
/// Inputs that are at most this many ticks apart go on.
const PAUSE: u64 = 6;
/// A value that was given for fewer ticks than this changes all the time.
const HELD: u64 = 4;

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
    Broke,
    Touched,
    Parted,
    Hit,
    Entered,
    Left,
    /// A command to the world, or to a body other than adding or removing it.
    Input,
    /// The run is not the one that was recorded.
    Diverged,
}

/// A group of events with room of its own in the list: many of one group leave room for the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Group {
    Bodies,
    Encounters,
    Inputs,
}

impl What {
    /// The name by which the page knows it.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Added => "added",
            Self::Removed => "removed",
            Self::Slept => "slept",
            Self::Woke => "woke",
            Self::Quarantined => "quarantined",
            Self::Released => "released",
            Self::Disabled => "disabled",
            Self::Enabled => "enabled",
            Self::Broke => "broke",
            Self::Touched => "touched",
            Self::Parted => "parted",
            Self::Hit => "hit",
            Self::Entered => "entered",
            Self::Left => "left",
            Self::Input => "input",
            Self::Diverged => "diverged",
        }
    }

    const fn group(self) -> Group {
        match self {
            Self::Touched | Self::Parted | Self::Hit | Self::Entered | Self::Left => Group::Encounters,
            Self::Input => Group::Inputs,
            _ => Group::Bodies,
        }
    }
}

/// Event of a tick, with all its bodies.
#[derive(Clone, Debug)]
pub(super) struct Event {
    pub(super) tick: u64,
    /// The last tick of those at which it was done over and over.
    pub(super) until: u64,
    /// The number of times it was done.
    pub(super) times: u64,
    pub(super) what: What,
    pub(super) text: String,
    /// The first of the bodies, as indices of lives, and how many there are.
    pub(super) bodies: Vec<usize>,
    pub(super) count: usize,
}

/// An input that may go on.
#[derive(Clone, Debug)]
struct Ongoing {
    /// The index of its event.
    event: usize,
    /// The text that it has now, and the tick from which on.
    text: String,
    since: u64,
    /// True if the text changed on the way.
    varies: bool,
}

/// The events of a run, in the order in which they were told.
#[derive(Clone, Debug, Default)]
pub(super) struct Events {
    pub(super) told: Vec<Event>,
    /// The numbers of events in the list, and of those that were too many, by group.
    counts: [usize; 3],
    pub(super) untold: [u64; 3],
    /// The latest event of each input, by what it is about.
    inputs: BTreeMap<String, Ongoing>,
}

impl Events {
    /// An event of a body, or one body more in an event of this tick; `None` for an event of none.
    pub(super) fn tell(&mut self, tick: u64, what: What, body: Option<usize>, text: String) {
        let mut latest = self.told.iter_mut().rev().take_while(|event| event.tick == tick);
        if let Some(event) = latest.find(|event| event.what == what && event.text == text && body.is_some()) {
            event.count += 1;
            if event.bodies.len() < NAMED {
                event.bodies.extend(body);
            }
            return;
        }
        self.add(tick, what, body.into_iter().collect(), text);
    }

    /// An event of some bodies together. Returns its index if there is room for it.
    pub(super) fn add(&mut self, tick: u64, what: What, bodies: Vec<usize>, text: String) -> Option<usize> {
        let group = what.group() as usize;
        if self.counts[group] == EVENTS {
            self.untold[group] += 1;
            return None;
        }
        self.counts[group] += 1;
        self.told.push(Event { tick, until: tick, times: 1, what, text, count: bodies.len(), bodies });
        Some(self.told.len() - 1)
    }

    /// An input that says this about a topic. It goes on where the same is said again, and where what is said changes all the time.
    pub(super) fn input(&mut self, tick: u64, topic: String, text: String) {
        if let Some(ongoing) = self.inputs.get_mut(&topic) {
            let event = &mut self.told[ongoing.event];
            let is_same = ongoing.text == text;
            let changes_all_the_time = event.until - ongoing.since < HELD;
            if tick - event.until <= PAUSE && (is_same || changes_all_the_time) {
                if !is_same {
                    (ongoing.text, ongoing.since, ongoing.varies) = (text, tick, true);
                }
                if ongoing.varies && event.text != topic {
                    event.text.clone_from(&topic);
                }
                (event.until, event.times) = (tick, event.times + 1);
                return;
            }
        }
        if let Some(event) = self.add(tick, What::Input, Vec::new(), text.clone()) {
            self.inputs.insert(topic, Ongoing { event, text, since: tick, varies: false });
        }
    }

    /// Says that the run is not the recorded one, for as long as it is told again each tick.
    pub(super) fn diverge(&mut self, tick: u64, text: String) {
        match self.told.iter_mut().rev().find(|event| event.what == What::Diverged) {
            Some(event) if event.until + 1 == tick => (event.until, event.times) = (tick, event.times + 1),
            _ => _ = self.add(tick, What::Diverged, Vec::new(), text),
        }
    }
}
