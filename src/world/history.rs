//! The past ticks that a rollback can return to.

use alloc::collections::VecDeque;
use alloc::vec::Vec;

use super::{Command, InputResult, Inputs, StepReport, World};
use crate::error::Error;
use crate::fx::Fx;
use crate::scalar::Scalar;

/// The last ticks of a world with their inputs and states, to return to when inputs arrive late.
///
/// Make every change of the world through the inputs: a change by a call between ticks is lost when an earlier tick is
/// simulated again. Register custom forces before the first tick. A handle that was given out in a tick that is simulated
/// again may name another body or field afterwards, or none: take handles from the reports of those ticks as well.
///
/// Once the history is full, a tick with no more inputs than the ticks before does not allocate, if the inputs change motion
/// alone and wake no body: properties that no step changes are shared with the stored states, and copied when they change.
///
/// ```
/// use umbra_physics::{ForceOrImpulse, BodyDef, Command, History, Inputs, ApplyOptions, World, WorldDef, vec2};
///
/// let push = |body, x: i32| {
///     let action = ForceOrImpulse::Impulse { impulse: vec2(x, 0), point: None };
///     Command::Apply { body, action, options: ApplyOptions::default() }
/// };
/// let mut world: World = World::new(WorldDef::default())?;
/// let ships = [world.add_body(BodyDef::dynamic())?, world.add_body(BodyDef::dynamic())?];
/// let mut history = History::new(8);
///
/// // Player 0 is local. The inputs of player 1 are predicted: no push.
/// for _ in 0..5 {
///     let mut inputs = Inputs::new();
///     inputs.replace(0, [push(ships[0], 1)]);
///     history.advance(&mut world, &inputs);
/// }
/// // Tick 2 of player 1 arrives three ticks late, and is not as predicted.
/// let mut again = Vec::new();
/// history.correct(&mut world, 2, 1, [push(ships[1], 6)], |tick| again.push(tick.step.tick))?;
/// assert_eq!(again, [3, 4, 5]); // the ticks simulated again
/// assert_eq!(world.body(ships[1])?.velocity(), vec2(6, 0));
/// // Tick 3 arrives as predicted: nothing is simulated again.
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
/// // Several corrections, and one rollback for all of them.
/// history.inputs_mut(4)?.replace(0, [Command::SetVelocity { body, velocity: vec2(3, 0) }]);
/// history.replace(3, 1, [Command::SetUserData { body, user_data: 7 }])?;
/// assert_eq!(history.redo(&mut world, |_| ()), 3);
///
/// // A rollback without inputs, to make the ticks anew; and another match.
/// history.rollback_to(&mut world, 3)?;
/// assert_eq!((world.tick(), world.body(body)?.user_data()), (3, 0));
/// history.clear();
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Debug)]
pub struct History<S: Scalar = Fx> {
    /// The stored ticks in order, and after them memory for others.
    rows: VecDeque<Row<S>>,
    /// The number of stored ticks.
    held: usize,
    /// The largest number of stored ticks.
    most: usize,
    /// The tick of the first row.
    first: u64,
    /// The first row with inputs that the world was not stepped with.
    changed: Option<usize>,
    outcomes: Vec<InputResult>,
}

#[derive(Debug)]
struct Row<S: Scalar> {
    /// The world before the tick if `is_known`; otherwise any world, and the state follows from the rows before.
    before: World<S>,
    is_known: bool,
    inputs: Inputs<S>,
}

impl<S: Scalar> Row<S> {
    /// Stores a world with its caches: otherwise a restored world would evaluate all its fields once more.
    fn keep(&mut self, world: &World<S>) {
        S::keep(&mut self.before, world);
        self.is_known = true;
    }
}

/// The report of a tick. It borrows from the history and the world: copy values that you need longer.
#[derive(Clone, Copy, Debug)]
pub struct TickReport<'a, S: Scalar = Fx> {
    /// The results of its inputs, in their order.
    pub outcomes: &'a [InputResult],
    /// The report of its step.
    pub step: StepReport<'a, S>,
    /// The world after it.
    pub world: &'a World<S>,
}

impl<S: Scalar> History<S> {
    /// A history of this many ticks, at least one.
    #[must_use]
    pub const fn new(ticks: usize) -> Self {
        let most = if ticks == 0 { 1 } else { ticks };
        Self { rows: VecDeque::new(), held: 0, most, first: 0, changed: None, outcomes: Vec::new() }
    }

    /// The first tick that a rollback can return to; `None` if there is none yet. The last one is the present.
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

    /// The inputs of a past tick, to change. Call [`redo`](Self::redo) afterwards.
    ///
    /// # Errors
    /// [`Error::TickForgotten`]; [`Error::TickToCome`].
    pub fn inputs_mut(&mut self, tick: u64) -> Result<&mut Inputs<S>, Error> {
        let index = self.find(tick)?;
        self.mark_changed(index);
        Ok(&mut self.rows[index].inputs)
    }

    /// Replaces a player's commands in a past tick, as [`Inputs::replace`] does, and returns true if they were other ones. Call
    /// [`redo`](Self::redo) afterwards.
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

    /// Stores the state and the inputs of this tick, carries the inputs out, and steps the world. The oldest tick is dropped if
    /// there are too many.
    ///
    /// Changed inputs of past ticks are applied first, as by [`redo`](Self::redo), without reports. A world that is not at the
    /// tick at which the history ended begins a new history.
    pub fn advance<'a>(&'a mut self, world: &'a mut World<S>, inputs: &Inputs<S>) -> TickReport<'a, S> {
        S::advance_history(self, world, inputs);
        TickReport { outcomes: &self.outcomes, step: world.last_report(), world }
    }

    pub(crate) fn advance_inner(&mut self, world: &mut World<S>, inputs: &Inputs<S>) {
        if world.tick() != self.present() {
            self.clear();
            self.first = world.tick();
        }
        self.redo_inner(world, &mut |_| ());
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
    }

    /// Returns to the first tick with changed inputs, and steps to the present again; `report` receives each of these ticks.
    /// Returns their number.
    pub fn redo(&mut self, world: &mut World<S>, mut report: impl FnMut(TickReport<'_, S>)) -> u64 {
        S::redo(self, world, &mut report)
    }

    pub(crate) fn redo_inner(&mut self, world: &mut World<S>, report: &mut dyn FnMut(TickReport<'_, S>)) -> u64 {
        let Some(changed) = self.changed.take() else { return 0 };
        self.restore(world, changed);
        self.replay(world, changed, report);
        (self.held - changed) as u64
    }

    /// [`replace`](Self::replace) and [`redo`](Self::redo), for the commands that a player really gave in a past tick. Returns
    /// the number of ticks simulated again: none if the tick was stepped with these commands.
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

    /// Restores the world before a tick, with the changed inputs of earlier ticks, and drops that tick and all later ones: the
    /// caller makes them again by [`advance`](Self::advance).
    ///
    /// # Errors
    /// [`Error::TickForgotten`]; [`Error::TickToCome`]. World and history are as they were.
    pub fn rollback_to(&mut self, world: &mut World<S>, tick: u64) -> Result<(), Error> {
        S::rollback_to(self, world, tick)
    }

    pub(crate) fn rollback_to_inner(&mut self, world: &mut World<S>, tick: u64) -> Result<(), Error> {
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

    /// Drops all ticks. The memory is kept for others.
    pub fn clear(&mut self) {
        (self.held, self.changed) = (0, None);
    }

    /// The world's present tick.
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

    /// Marks a tick's inputs as changed: the states after it are no longer known.
    fn mark_changed(&mut self, index: usize) {
        self.changed = Some(self.changed.map_or(index, |changed| changed.min(index)));
        self.rows.range_mut(index + 1..self.held).for_each(|row| row.is_known = false);
    }

    /// Restores the world before a row, from the last known state. The first state is always known.
    fn restore(&mut self, world: &mut World<S>, index: usize) {
        let known = (0..=index).rev().find(|&i| i < self.held && self.rows[i].is_known).unwrap_or(0);
        let Some(row) = self.rows.get(known) else { return };
        S::restore(world, &row.before);
        for row in self.rows.range(known..index) {
            world.carry_out_into(&row.inputs, &mut self.outcomes);
            world.step();
        }
    }

    /// Steps the world from before a row to the present.
    ///
    /// Copies of all states on the way would take a sixth of the time. The next late inputs are most likely for the next tick or
    /// one soon after: so the states 0, 1, 2, 4, 8, … ticks on are stored. No later rollback needs more steps than this one.
    fn replay(&mut self, world: &mut World<S>, first: usize, report: &mut dyn FnMut(TickReport<'_, S>)) {
        for (i, row) in self.rows.range_mut(first..self.held).enumerate() {
            if (i == 0 || i.is_power_of_two()) && !row.is_known {
                row.keep(world);
            }
            world.carry_out_into(&row.inputs, &mut self.outcomes);
            world.step();
            report(TickReport { outcomes: &self.outcomes, step: world.last_report(), world });
        }
    }

    /// Drops the oldest tick. The state before the next one has to be known then, as no earlier row is left.
    fn forget_oldest(&mut self, world: &mut World<S>) {
        let Some(mut oldest) = self.rows.pop_front() else { return };
        if let Some(next) = self.rows.front_mut().filter(|next| self.held > 1 && !next.is_known) {
            let before = &mut oldest.before;
            // The working memory of the world, which is about to step anyway, serves for this step too.
            // The report of the world's last step stays with the world.
            let swap = |before: &mut World<S>, world: &mut World<S>| {
                core::mem::swap(&mut before.workspace, &mut world.workspace);
                core::mem::swap(&mut before.workspace.report, &mut world.workspace.report);
            };
            swap(before, world);
            before.workspace.drop_cached();
            before.carry_out_into(&oldest.inputs, &mut self.outcomes);
            before.step();
            swap(before, world);
            before.workspace.drop_cached();
            world.workspace.drop_cached();
            core::mem::swap(before, &mut next.before);
            next.is_known = true;
        }
        self.rows.push_back(oldest);
        self.first += 1;
        self.held -= 1;
    }
}
