//! The inputs of the players: those that are known, and predictions of the others.

use alloc::collections::VecDeque;
use alloc::vec::Vec;

use crate::error::Error;

pub(super) struct Players<I> {
    /// By number.
    players: Vec<Player<I>>,
    pub(super) predict: fn(&I) -> I,
    /// The first tick whose inputs are kept.
    first: u64,
    /// The first tick of which an input became known, or was no longer expected, since the last search for wrong predictions.
    first_new: Option<u64>,
}

struct Player<I> {
    number: u32,
    /// The inputs from the first kept tick on.
    inputs: VecDeque<Option<I>>,
    /// The number of known inputs at the front.
    known: usize,
    /// The last known input before the first kept tick.
    last: I,
    /// The tick from which on there are no inputs.
    end: u64,
}

impl<I: Clone + PartialEq> Player<I> {
    fn at(&self, index: usize) -> Option<&I> {
        self.inputs.get(index)?.as_ref()
    }

    /// The input at an index, or the prediction of it from the last one that is known.
    fn input(&self, index: usize, predict: fn(&I) -> I) -> I {
        let known = |index: &usize| self.at(*index).is_some();
        match self.at(index) {
            Some(input) => input.clone(),
            None => predict((0..index).rev().find(known).and_then(|index| self.at(index)).unwrap_or(&self.last)),
        }
    }

    fn forget(&mut self, ticks: u64) {
        for _ in 0..ticks.min(self.inputs.len() as u64) {
            if let Some(Some(input)) = self.inputs.pop_front() {
                self.last = input;
            }
        }
        self.known = self.known.saturating_sub(usize::try_from(ticks).unwrap_or(usize::MAX));
        self.count_known();
    }

    fn count_known(&mut self) {
        while self.at(self.known).is_some() {
            self.known += 1;
        }
    }
}

impl<I: Clone + Default + PartialEq> Players<I> {
    pub(super) fn new(first: u64, numbers: impl IntoIterator<Item = u32>) -> Self {
        let player = |number| Player { number, inputs: VecDeque::new(), known: 0, last: I::default(), end: u64::MAX };
        let mut players: Vec<Player<I>> = numbers.into_iter().map(player).collect();
        players.sort_by_key(|player| player.number);
        players.dedup_by_key(|player| player.number);
        Self { players, predict: I::clone, first, first_new: None }
    }

    fn find(&self, player: u32) -> Result<usize, Error> {
        self.players.binary_search_by_key(&player, |player| player.number).map_err(|_| Error::NoSuchPlayer { player })
    }

    /// Takes an input, and returns true if it is the first one of the player for the tick.
    pub(super) fn add(&mut self, tick: u64, player: u32, input: I) -> Result<bool, Error> {
        let index = self.find(player)?;
        let player = &mut self.players[index];
        let Some(place) = tick.checked_sub(self.first).filter(|_| tick < player.end) else { return Ok(false) };
        // The caller bounds the tick.
        let place = place as usize;
        if player.inputs.len() <= place {
            player.inputs.resize(place + 1, None);
        }
        if player.inputs[place].is_some() {
            return Ok(false);
        }
        player.inputs[place] = Some(input);
        player.count_known();
        self.note_new(tick);
        Ok(true)
    }

    /// Ends the inputs of a player, from a tick on that is not confirmed.
    pub(super) fn remove(&mut self, player: u32, tick: u64, first_unconfirmed: u64) -> Result<(), Error> {
        let index = self.find(player)?;
        if tick < first_unconfirmed {
            return Err(Error::TickForgotten { tick, oldest: first_unconfirmed });
        }
        let player = &mut self.players[index];
        player.end = player.end.min(tick);
        player.inputs.truncate((player.end.saturating_sub(self.first)).min(player.inputs.len() as u64) as usize);
        player.known = player.known.min(player.inputs.len());
        self.note_new(tick);
        Ok(())
    }

    fn note_new(&mut self, tick: u64) {
        self.first_new = Some(self.first_new.map_or(tick, |first| first.min(tick)));
    }

    /// The first tick of which something new is known since the last call.
    pub(super) fn take_first_new(&mut self) -> Option<u64> {
        self.first_new.take()
    }

    /// The first tick, at most `limit`, for which an input is missing.
    pub(super) fn known_up_to(&self, limit: u64) -> u64 {
        let known = |player: &Player<I>| {
            let end = self.first + player.known as u64;
            if end >= player.end { u64::MAX } else { end }
        };
        self.players.iter().map(known).fold(limit, u64::min)
    }

    /// A player whose input for a tick is missing.
    pub(super) fn missing(&self, tick: u64) -> Option<u32> {
        let is_missing = |player: &&Player<I>| tick < player.end && player.at((tick - self.first) as usize).is_none();
        self.players.iter().find(is_missing).map(|player| player.number)
    }

    /// The inputs of a tick by player, known or predicted.
    fn inputs_of(&self, tick: u64) -> impl Iterator<Item = (u32, I)> {
        let index = (tick - self.first) as usize;
        let players = self.players.iter().filter(move |player| tick < player.end);
        players.map(move |player| (player.number, player.input(index, self.predict)))
    }

    pub(super) fn inputs_into(&self, tick: u64, inputs: &mut Vec<(u32, I)>) {
        inputs.clear();
        inputs.extend(self.inputs_of(tick));
    }

    /// Returns true if these are the inputs of the tick as far as it is known.
    pub(super) fn are_inputs(&self, tick: u64, inputs: &[(u32, I)]) -> bool {
        self.inputs_of(tick).eq(inputs.iter().cloned())
    }

    /// Forgets the inputs of the ticks before this one.
    pub(super) fn forget_before(&mut self, first: u64) {
        let ticks = first - self.first;
        if ticks > 0 {
            self.players.iter_mut().for_each(|player| player.forget(ticks));
            self.first = first;
        }
    }

    /// Goes on from a tick: forgets the inputs of the ticks before, and all of them if it is an earlier one.
    pub(super) fn restart(&mut self, first: u64) {
        if first < self.first {
            for player in &mut self.players {
                player.inputs.clear();
                player.known = 0;
            }
            self.first = first;
        }
        self.forget_before(first);
        self.first_new = None;
    }
}
