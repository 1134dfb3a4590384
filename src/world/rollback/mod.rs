//! Rollback over a game's own inputs: late inputs, prediction, correction, confirmed ticks.

mod inputs;
mod report;

use alloc::collections::VecDeque;
use alloc::vec::Vec;

use super::{Command, Event, World};
use crate::error::Error;
use crate::fx::Fx;
use crate::scalar::Scalar;
use inputs::Players;
pub use report::{ConfirmedTick, EventStatus, RollbackReport, TickEvent};

/// The ticks of a match that are not final yet, with the inputs of all players and the states to go back to.
///
/// A tick is a function of the game that makes calls on the world from the inputs of the players; after it the rollback steps
/// the world. Inputs of all players go to [`add_input`](Self::add_input), in any order. [`advance`](Self::advance) makes a tick,
/// with predictions for the inputs that are missing. If an input arrives that was predicted wrongly, the next `advance` goes back
/// to that tick and makes it and all later ones again. A tick is confirmed when the inputs of all players for it and all ticks
/// before are known: then it is final, and handed out once, in order, in the report.
///
/// The tick function must depend on the world and the inputs alone, and must make all changes to the world. A change made
/// between two ticks would be lost when an earlier tick is made again: `advance` notices and refuses it. Register custom forces
/// before the first tick.
///
/// A tick without changes of bodies or fields other than their motion allocates nothing once the window is full.
///
/// ```
/// use umbra_physics::{BodyDef, BodyId, Rollback, World, WorldDef, fx, vec2};
///
/// /// Buttons of a player. The default is none.
/// #[derive(Clone, Copy, Debug, Default, PartialEq)]
/// struct Buttons {
///     jump: bool,
/// }
///
/// let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
/// let ships = [world.add_body(BodyDef::dynamic())?, world.add_body(BodyDef::dynamic())?];
/// let tick = |world: &mut World, inputs: &[(u32, Buttons)]| {
///     for (player, buttons) in inputs {
///         let ship = ships[*player as usize];
///         if buttons.jump && world.body(ship).is_ok_and(|ship| ship.velocity().y < fx!(5)) {
///             world.apply_impulse(ship, vec2(0, 3)).expect("a ship");
///         }
///     }
/// };
/// let mut rollback = Rollback::new(&world, [0, 1], 8);
/// for now in 0..6 {
///     rollback.add_input(now, 0, Buttons { jump: now % 2 == 0 })?; // ours
///     let report = rollback.advance(&mut world, tick)?;
///     assert_eq!(report.confirmed().count(), 0); // nothing is known of player 1 yet
/// }
/// // The inputs of player 1 for the first three ticks arrive. The one of tick 1 was predicted wrongly.
/// for (past, jump) in [(2, false), (0, false), (1, true)] {
///     rollback.add_input(past, 1, Buttons { jump })?;
/// }
/// rollback.add_input(6, 0, Buttons::default())?;
/// let report = rollback.advance(&mut world, tick)?;
/// assert_eq!(report.redone, 5); // ticks 1 to 5
/// assert!(report.confirmed().map(|tick| tick.tick).eq([0, 1, 2]));
/// # Ok::<(), umbra_physics::Error>(())
/// ```
///
/// The inputs may be commands. Until they arrive, predict none:
///
/// ```
/// use umbra_physics::{BodyDef, Command, Rollback, World, WorldDef, vec2};
///
/// let mut world = World::new(WorldDef::default())?;
/// let ship = world.add_body(BodyDef::dynamic())?;
/// let tick = |world: &mut World, inputs: &[(u32, Vec<Command>)]| {
///     for command in inputs.iter().flat_map(|(_player, commands)| commands) {
///         // A refused command changes nothing, and is refused for every peer.
///         let _result = world.execute(command);
///     }
/// };
/// let mut rollback = Rollback::new(&world, [0, 1], 8).with_prediction(|_| Vec::new());
/// for now in 0..5 {
///     rollback.add_input(now, 0, Vec::new())?;
///     rollback.advance(&mut world, tick)?;
/// }
/// rollback.add_input(0, 1, vec![Command::SetVelocity { body: ship, velocity: vec2(6, 0) }])?;
/// let report = rollback.advance(&mut world, tick)?;
/// assert_eq!((report.redone, report.confirmed().len()), (5, 1));
/// assert_eq!(world.body(ship)?.velocity(), vec2(6, 0));
/// # Ok::<(), umbra_physics::Error>(())
/// ```
pub struct Rollback<I, S: Scalar = Fx> {
    players: Players<I>,
    window: usize,
    /// The made ticks in order, and after them memory for others. The first is the first one that is not confirmed, or that was
    /// handed out by the last report.
    rows: VecDeque<Row<I, S>>,
    simulated: usize,
    /// The number of ticks at the front that the last report handed out.
    handed_out: usize,
    /// The tick of the first row.
    first: u64,
    /// The count of [`World::rewinds`] when the last call ended; `None` before the first tick.
    rewinds: Option<u64>,
    events: Vec<TickEvent<S>>,
}

/// The function of the game that makes a tick's calls.
type TickFunction<'a, I, S> = dyn FnMut(&mut World<S>, &[(u32, I)]) + 'a;

/// A made tick.
struct Row<I, S: Scalar> {
    before: World<S>,
    /// The inputs that it was made with, by player.
    inputs: Vec<(u32, I)>,
    /// The calls of the tick function.
    commands: Vec<Command<S>>,
    /// The events that were reported of it.
    events: Vec<Event<S>>,
}

impl<I, S: Scalar> core::fmt::Debug for Rollback<I, S> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Self { window, simulated, first, .. } = self;
        let ticks = *first..*first + *simulated as u64;
        f.debug_struct("Rollback").field("window", window).field("ticks", &ticks).finish_non_exhaustive()
    }
}

impl<I: Clone + Default + PartialEq, S: Scalar> Rollback<I, S> {
    /// The most ticks after the present for which inputs are taken: it bounds the memory that inputs of other players take.
    pub const AHEAD: u64 = 256;

    /// A rollback from the present tick of a world, for these players. At most `window` ticks are made before they are
    /// confirmed; with 0 a tick waits for all inputs, as in lockstep.
    #[must_use]
    pub fn new(world: &World<S>, players: impl IntoIterator<Item = u32>, window: usize) -> Self {
        Self {
            players: Players::new(world.tick(), players),
            window,
            rows: VecDeque::new(),
            simulated: 0,
            handed_out: 0,
            first: world.tick(),
            rewinds: None,
            events: Vec::new(),
        }
    }

    /// Sets how a missing input is predicted from the last known input of the player; otherwise it is the same again.
    /// For buttons that act when pressed, return the input without them.
    #[must_use]
    pub fn with_prediction(mut self, predict: fn(&I) -> I) -> Self {
        self.players.predict = predict;
        self
    }

    /// Takes the input of a player for a tick. The first input counts: returns false for another one of the same player and
    /// tick, and for one of a tick that is confirmed.
    ///
    /// # Errors
    /// [`Error::NoSuchPlayer`]; [`Error::TickToCome`] for a tick more than [`AHEAD`](Self::AHEAD) ticks after the present.
    pub fn add_input(&mut self, tick: u64, player: u32, input: I) -> Result<bool, Error> {
        let present = self.present();
        if tick > present.saturating_add(Self::AHEAD) {
            return Err(Error::TickToCome { tick, present });
        }
        self.players.add(tick, player, input)
    }

    /// Ends the inputs of a player: from this tick on there are none of that player, and no tick waits for them. All peers have
    /// to agree on the tick.
    ///
    /// # Errors
    /// [`Error::NoSuchPlayer`]; [`Error::TickForgotten`] for a tick that is confirmed.
    pub fn remove_player(&mut self, player: u32, tick: u64) -> Result<(), Error> {
        self.players.remove(player, tick, self.first_unconfirmed())
    }

    /// The tick that is made next.
    #[must_use]
    pub fn present(&self) -> u64 {
        self.first + self.simulated as u64
    }

    /// The first tick that is not confirmed.
    #[must_use]
    pub fn first_unconfirmed(&self) -> u64 {
        self.players.known_up_to(self.present())
    }

    /// Makes the ticks again whose inputs were predicted wrongly, then the next tick: calls the tick function with the inputs by
    /// player, and steps the world. It waits instead if as many ticks as the window has are unconfirmed.
    ///
    /// # Errors
    /// [`Error::ChangedBetweenTicks`] if the world is not as the last call left it: it was changed by a call, stepped, restored,
    /// or replaced by another one. Then nothing is done. [`Error::SteppedInTick`] if the tick function stepped or restored the
    /// world, which is left as it is. Call [`restart`](Self::restart) to go on from such a world.
    pub fn advance<'a>(
        &'a mut self,
        world: &'a mut World<S>,
        mut tick: impl FnMut(&mut World<S>, &[(u32, I)]),
    ) -> Result<RollbackReport<'a, I, S>, Error> {
        self.advance_inner(world, &mut tick)
    }

    fn advance_inner<'a>(
        &'a mut self,
        world: &'a mut World<S>,
        tick: &mut TickFunction<'_, I, S>,
    ) -> Result<RollbackReport<'a, I, S>, Error> {
        self.check_unchanged(world)?;
        if self.rewinds.is_none() {
            world.journal.start();
        }
        self.forget_handed_out();
        self.events.clear();
        let redone = self.redo(world, tick)?;
        // A tick whose inputs are all known needs no place in the window, if all ticks before are confirmed.
        let unconfirmed = self.present() - self.first_unconfirmed();
        let is_known = unconfirmed == 0 && self.players.known_up_to(self.present() + 1) > self.present();
        let waits_for = if is_known || unconfirmed < self.window as u64 {
            let index = self.simulated;
            match self.rows.get_mut(index) {
                Some(row) => row.events.clear(),
                None => {
                    let (inputs, commands, events) = (Vec::new(), Vec::new(), Vec::new());
                    self.rows.push_back(Row { before: world.clone(), inputs, commands, events });
                }
            }
            self.simulated += 1;
            S::keep(&mut self.rows[index].before, world);
            self.make(index, world, tick)?;
            None
        } else {
            self.players.missing(self.first_unconfirmed())
        };
        self.handed_out = (self.first_unconfirmed() - self.first) as usize;
        // While the first tick waits, the world's journal may still have changes from before.
        if self.simulated > 0 || self.rewinds.is_some() {
            self.rewinds = Some(world.rewinds());
        }
        Ok(RollbackReport::new(
            redone,
            waits_for,
            self.first,
            &self.rows,
            self.handed_out,
            self.simulated,
            &self.events,
            world,
        ))
    }

    /// Drops all ticks that are not confirmed, and goes on from a world as it is: after a snapshot was loaded, or after a change
    /// between ticks on which all peers agree. Inputs that have arrived for its tick and later ones count, unless the world is
    /// at a tick before the ones that were kept: then all inputs are dropped.
    pub fn restart(&mut self, world: &World<S>) {
        (self.simulated, self.handed_out, self.rewinds) = (0, 0, None);
        self.first = world.tick();
        self.players.restart(world.tick());
    }

    /// The world after the last confirmed tick that a report handed out. `world` is the present one.
    #[must_use]
    pub fn confirmed_world<'a>(&'a self, world: &'a World<S>) -> &'a World<S> {
        // Inputs that were added since may have confirmed more ticks, which are not made with them yet.
        if self.handed_out < self.simulated { &self.rows[self.handed_out].before } else { world }
    }

    fn check_unchanged(&self, world: &World<S>) -> Result<(), Error> {
        let Some(rewinds) = self.rewinds else {
            // Calls before the first tick prepare the level.
            return if world.tick() == self.first {
                Ok(())
            } else {
                Err(Error::ChangedBetweenTicks { tick: self.first })
            };
        };
        let is_same = world.tick() == self.present() && world.rewinds() == rewinds && world.journal.is_empty();
        if is_same { Ok(()) } else { Err(Error::ChangedBetweenTicks { tick: self.present() }) }
    }

    /// Drops the ticks that the last report handed out, and keeps their memory.
    fn forget_handed_out(&mut self) {
        for _ in 0..self.handed_out {
            let row = self.rows.pop_front();
            self.rows.extend(row);
        }
        self.simulated -= self.handed_out;
        self.first += self.handed_out as u64;
        self.handed_out = 0;
        self.players.forget_before(self.first);
    }

    /// Makes the ticks again from the first one that was made with other inputs than it has now. Returns their number.
    fn redo(&mut self, world: &mut World<S>, tick: &mut TickFunction<'_, I, S>) -> Result<u64, Error> {
        let Some(from) = self.players.take_first_new() else { return Ok(0) };
        let from = from.max(self.first) - self.first;
        let mut first_wrong = None;
        for (index, row) in self.rows.iter().enumerate().take(self.simulated).skip(from as usize) {
            if !self.players.are_inputs(self.first + index as u64, &row.inputs) {
                first_wrong = Some(index);
                break;
            }
        }
        let Some(first_wrong) = first_wrong else { return Ok(0) };
        let before = &self.rows[first_wrong].before;
        S::restore(world, before);
        self.make(first_wrong, world, tick)?;
        for index in first_wrong + 1..self.simulated {
            S::keep(&mut self.rows[index].before, world);
            self.make(index, world, tick)?;
        }
        Ok((self.simulated - first_wrong) as u64)
    }

    /// Makes a tick whose state before it is stored: calls the tick function, steps, and compares the events with those reported.
    fn make(&mut self, index: usize, world: &mut World<S>, tick: &mut TickFunction<'_, I, S>) -> Result<(), Error> {
        let now = self.first + index as u64;
        let row = &mut self.rows[index];
        self.players.inputs_into(now, &mut row.inputs);
        world.journal.start();
        let rewinds = world.rewinds();
        tick(world, &row.inputs);
        if (world.tick(), world.rewinds()) != (now, rewinds) {
            self.rewinds = None;
            return Err(Error::SteppedInTick { tick: now });
        }
        let random = *world.random();
        row.commands.clear();
        world.journal.take(random, &mut row.commands);
        world.step();
        report::compare(now, &mut row.events, &mut world.last_report().events(), &mut self.events);
        Ok(())
    }
}

#[cfg(test)]
mod tests;
