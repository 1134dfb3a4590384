//! The ring of past ticks that a rollback goes back to.

use alloc::collections::VecDeque;
use alloc::vec::Vec;

use super::{Command, InputResult, Inputs, StepReport, World};
use crate::error::Error;
use crate::scalar::{Scalar, fx::Fx};

/// The last ticks of a world, their inputs and states, to go back to when inputs arrive late.
///
/// All that changes the world goes through the inputs: what calls change between ticks is lost when a tick before is done
/// over. Laws of force are registered before the first tick. A handle that was given out in a tick that is done over may
/// name another body or field afterwards, or none: take handles from the reports of what is done over as well.
///
/// Once it is full, a tick that has no more inputs than those before takes nothing from the heap, if they change motion
/// alone: what no step changes is shared with the states that are kept, and copied when it is changed.
///
/// ```
/// use umbra_physics::{ForceOrImpulse, BodyDef, Command, History, Inputs, ApplyOptions, World, WorldDef, vec2};
///
/// let push = |body, x: i32| {
///     let action = ForceOrImpulse::Impulse { impulse: vec2(x, 0), point: None };
///     Command::Apply { body, action, manner: ApplyOptions::default() }
/// };
/// let mut world: World = World::new(WorldDef::default())?;
/// let ships = [world.add_body(BodyDef::dynamic())?, world.add_body(BodyDef::dynamic())?];
/// let mut history = History::new(8);
///
/// // Player 0 is here. What player 1 does is guessed: the ship is not pushed.
/// for _ in 0..5 {
///     let mut inputs = Inputs::new();
///     inputs.replace(0, [push(ships[0], 1)]);
///     history.advance(&mut world, &inputs);
/// }
/// // Tick 2 of player 1 arrives three ticks late, and is not as guessed.
/// let mut again = Vec::new();
/// history.correct(&mut world, 2, 1, [push(ships[1], 6)], |tick| again.push(tick.step.tick))?;
/// assert_eq!(again, [3, 4, 5]); // the ticks reached anew
/// assert_eq!(world.body(ships[1])?.velocity(), vec2(6, 0));
/// // Tick 3 arrives, and is as guessed: nothing is done over.
/// assert_eq!(history.correct(&mut world, 3, 1, [], |_| ())?, 0);
/// # Ok::<(), umbra_physics::Error>(())
/// ```
///
/// ```
/// use umbra_physics::{BodyDef, Command, Error, History, Inputs, TickReport, World, WorldDef, vec2};
///
/// let mut world: World = World::new(WorldDef::default())?;
/// let body = world.add_body(BodyDef::dynamic())?;
/// let mut history = History::new(4);
/// for tick in 0..6 {
///     let TickReport { step, .. } = history.advance(&mut world, &Inputs::new());
///     assert_eq!(step.tick, tick + 1);
/// }
/// assert_eq!(history.oldest(), Some(2)); // 0 and 1 are forgotten
/// assert_eq!(history.inputs(1).err(), Some(Error::TickForgotten { tick: 1, oldest: 2 }));
///
/// // Several corrections, and one way back for all of them.
/// history.inputs_mut(4)?.replace(0, [Command::SetVelocity { body, velocity: vec2(3, 0) }]);
/// history.replace(3, 1, [Command::SetUserData { body, user_data: 7 }])?;
/// assert_eq!(history.redo(&mut world, |_| ()), 3);
///
/// // Back, to make the ticks in some other way; and another match.
/// history.rollback_to(&mut world, 3)?;
/// assert_eq!((world.tick(), world.body(body)?.user_data()), (3, 0));
/// history.clear();
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Debug)]
pub struct History<S: Scalar = Fx> {
    /// The ticks that are kept, each the next one's predecessor, and after them memory for others.
    rows: VecDeque<Row<S>>,
    /// How many are kept.
    held: usize,
    /// The most there may be.
    most: usize,
    /// The tick of the first row.
    first: u64,
    /// The first row whose inputs are not those that the world was stepped with.
    changed: Option<usize>,
    outcomes: Vec<InputResult>,
}

#[derive(Debug)]
struct Row<S: Scalar> {
    /// The world before the tick, if it `is_known`; otherwise some other world, and the rows before lead here.
    before: World<S>,
    is_known: bool,
    inputs: Inputs<S>,
}

impl<S: Scalar> Row<S> {
    /// With what is cached: otherwise a world that was put back would evaluate all its fields once more.
    fn keep(&mut self, world: &World<S>) {
        self.before.keep(world);
        self.before.workspace.clone_cached_from(&world.workspace);
        self.is_known = true;
    }
}

/// What happened in a tick. It borrows from the history and the world: take out what is to be kept.
#[derive(Clone, Copy, Debug)]
pub struct TickReport<'a, S: Scalar = Fx> {
    /// What became of its inputs, in their order.
    pub outcomes: &'a [InputResult],
    /// What its step did.
    pub step: StepReport<'a, S>,
    /// The world after it.
    pub world: &'a World<S>,
}

impl<S: Scalar> History<S> {
    /// A history that goes back by so many ticks, at least one.
    #[must_use]
    pub const fn new(ticks: usize) -> Self {
        let most = if ticks == 0 { 1 } else { ticks };
        Self { rows: VecDeque::new(), held: 0, most, first: 0, changed: None, outcomes: Vec::new() }
    }

    /// The first tick that can be gone back to; `None` if there is none yet. The last one is the present.
    #[must_use]
    pub fn oldest(&self) -> Option<u64> {
        (self.held > 0).then_some(self.first)
    }

    /// The inputs of a past tick.
    ///
    /// # Errors
    /// [`Error::TickForgotten`]; [`Error::TickToCome`].
    pub fn inputs(&self, tick: u64) -> Result<&Inputs<S>, Error> {
        Ok(&self.rows[self.find(tick)?].inputs)
    }

    /// The inputs of a past tick, to change. [`redo`](Self::redo) does what follows from that.
    ///
    /// # Errors
    /// [`Error::TickForgotten`]; [`Error::TickToCome`].
    pub fn inputs_mut(&mut self, tick: u64) -> Result<&mut Inputs<S>, Error> {
        let index = self.find(tick)?;
        self.mark_changed(index);
        Ok(&mut self.rows[index].inputs)
    }

    /// Puts these commands in the place of a player's in a past tick, as [`Inputs::replace`], and says whether that changed
    /// anything. [`redo`](Self::redo) does what follows from that.
    ///
    /// # Errors
    /// [`Error::TickForgotten`]; [`Error::TickToCome`].
    pub fn replace(
        &mut self,
        tick: u64,
        player: u32,
        commands: impl IntoIterator<Item = Command<S>>,
    ) -> Result<bool, Error> {
        let index = self.find(tick)?;
        let changed = self.rows[index].inputs.replace(player, commands);
        if changed {
            self.mark_changed(index);
        }
        Ok(changed)
    }

    /// Keeps the state and the inputs of this tick, carries the inputs out, and moves the world on. The oldest tick is
    /// forgotten if there are too many.
    ///
    /// Inputs changed before and not done over are done over first, without reports. A world that is not at the tick that
    /// the history ended at begins a new one.
    pub fn advance<'a>(&'a mut self, world: &'a mut World<S>, inputs: &Inputs<S>) -> TickReport<'a, S> {
        if world.tick() != self.present() {
            self.clear();
            self.first = world.tick();
        }
        self.redo(world, |_| ());
        if self.held == self.most {
            self.forget_oldest(world);
        }
        match self.rows.get_mut(self.held) {
            Some(row) => row.inputs.clone_from(inputs),
            None => self.rows.push_back(Row { before: world.clone(), is_known: false, inputs: inputs.clone() }),
        }
        self.rows[self.held].keep(world);
        self.held += 1;
        world.carry_out_into(inputs, &mut self.outcomes);
        world.step();
        TickReport { outcomes: &self.outcomes, step: world.last_report(), world }
    }

    /// Goes back to the first tick whose inputs were changed, and steps to the present again; `report` sees each tick that
    /// is done over. Returns how many these are.
    pub fn redo(&mut self, world: &mut World<S>, report: impl FnMut(TickReport<'_, S>)) -> u64 {
        let Some(changed) = self.changed.take() else { return 0 };
        self.restore(world, changed);
        self.replay(world, changed, report);
        (self.held - changed) as u64
    }

    /// [`replace`](Self::replace) and [`redo`](Self::redo): what a player really did in a past tick has arrived. Returns how
    /// many ticks were done over: none if it is what the tick was stepped with.
    ///
    /// # Errors
    /// [`Error::TickForgotten`]; [`Error::TickToCome`]. The world is as it was.
    pub fn correct(
        &mut self,
        world: &mut World<S>,
        tick: u64,
        player: u32,
        commands: impl IntoIterator<Item = Command<S>>,
        report: impl FnMut(TickReport<'_, S>),
    ) -> Result<u64, Error> {
        self.replace(tick, player, commands)?;
        Ok(self.redo(world, report))
    }

    /// Puts the world back to where it was before a tick, inputs changed since taken into account, and forgets that tick
    /// and those after it: they are the caller's to do over, by [`advance`](Self::advance).
    ///
    /// # Errors
    /// [`Error::TickForgotten`]; [`Error::TickToCome`]. World and history are as they were.
    pub fn rollback_to(&mut self, world: &mut World<S>, tick: u64) -> Result<(), Error> {
        if self.held == 0 {
            self.first = world.tick();
        }
        let present = self.present();
        let index = if tick == present { self.held } else { self.find(tick)? };
        let is_there = tick == present && world.tick() == tick && self.changed.is_none();
        if !is_there {
            self.restore(world, index);
        }
        self.held = index;
        self.changed = None;
        Ok(())
    }

    /// Forgets all ticks. The memory stays for others.
    pub fn clear(&mut self) {
        (self.held, self.changed) = (0, None);
    }

    /// The tick that the world is at.
    fn present(&self) -> u64 {
        self.first + self.held as u64
    }

    fn find(&self, tick: u64) -> Result<usize, Error> {
        if tick >= self.present() {
            return Err(Error::TickToCome { tick, present: self.present() });
        }
        let index = tick.checked_sub(self.first).ok_or(Error::TickForgotten { tick, oldest: self.first })?;
        Ok(index as usize)
    }

    /// The states after a tick whose inputs change are not known any more.
    fn mark_changed(&mut self, index: usize) {
        self.changed = Some(self.changed.map_or(index, |changed| changed.min(index)));
        self.rows.range_mut(index + 1..self.held).for_each(|row| row.is_known = false);
    }

    /// Makes the world what it was before a row, from the last state that is known. The first is.
    fn restore(&mut self, world: &mut World<S>, index: usize) {
        let known = (0..=index).rev().find(|&i| i < self.held && self.rows[i].is_known).unwrap_or(0);
        let Some(row) = self.rows.get(known) else { return };
        world.clone_from(&row.before);
        world.workspace.clone_cached_from(&row.before.workspace);
        for row in self.rows.range(known..index) {
            world.carry_out_into(&row.inputs, &mut self.outcomes);
            world.step();
        }
    }

    /// Steps the world from before a row to the present.
    ///
    /// Not every state on the way is kept, as copies would take a sixth of the time. The next late inputs are most likely
    /// for the next tick or one soon after, so that the states 0, 1, 2, 4, 8, … ticks on are: whichever tick is next to be
    /// done over, no more steps are needed than now.
    fn replay(&mut self, world: &mut World<S>, first: usize, mut report: impl FnMut(TickReport<'_, S>)) {
        for (i, row) in self.rows.range_mut(first..self.held).enumerate() {
            if (i == 0 || i.is_power_of_two()) && !row.is_known {
                row.keep(world);
            }
            world.carry_out_into(&row.inputs, &mut self.outcomes);
            world.step();
            report(TickReport { outcomes: &self.outcomes, step: world.last_report(), world });
        }
    }

    /// Makes room for another tick. The state before the next one has to be known then: no row is left to lead there.
    fn forget_oldest(&mut self, world: &mut World<S>) {
        let Some(mut oldest) = self.rows.pop_front() else { return };
        if let Some(next) = self.rows.front_mut().filter(|next| self.held > 1 && !next.is_known) {
            let before = &mut oldest.before;
            // The working memory of the world, which is about to step anyway, serves for this step too.
            core::mem::swap(&mut before.workspace, &mut world.workspace);
            before.workspace.drop_cached();
            before.carry_out_into(&oldest.inputs, &mut self.outcomes);
            before.step();
            core::mem::swap(&mut before.workspace, &mut world.workspace);
            before.workspace.clone_from(&world.workspace);
            world.workspace.drop_cached();
            core::mem::swap(before, &mut next.before);
            next.is_known = true;
        }
        self.rows.push_back(oldest);
        self.first += 1;
        self.held -= 1;
    }
}
