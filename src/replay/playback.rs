//! Replays played: tick by tick, compared with what was recorded.

use alloc::boxed::Box;
use alloc::vec::Vec;
use core::fmt;

use super::finding::{Finding, TickPhase};
use super::replay::{Cursor, Replay};
use super::verify::{ReplayLimits, VerifyError};
use crate::error::codes;
use crate::world::{Command, InputResult, World};

/// A run that is not the one recorded.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Divergence {
    /// The tick the world was at with the first hash that is another one.
    pub tick: u64,
    /// The hash recorded.
    pub recorded: u64,
    /// The hash the run has.
    pub computed: u64,
    /// The first value that differs, at the next tick with a snapshot; the hash itself if none does there.
    pub finding: Finding,
}

impl fmt::Display for Divergence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { tick, recorded, computed, finding } = self;
        write!(f, "at tick {tick} the hash is {computed:016x}, recorded was {recorded:016x}; {finding}")
    }
}

codes!(Divergence = 420);

impl core::error::Error for Divergence {}

/// A replay on its way.
///
/// ```
/// use umbra_physics::{
///     BodyDef, Command, Divergence, Inputs, Playback, RecordOptions, Recorder, Replay, World, WorldDef, vec2,
/// };
///
/// let mut world: World = World::new(WorldDef::default())?;
/// let body = world.add_body(BodyDef::dynamic())?;
/// let mut recorder = Recorder::new(&world, RecordOptions::default());
/// for tick in 0..10 {
///     let mut inputs = Inputs::new();
///     inputs.replace(0, [Command::SetVelocity { body, velocity: vec2(tick, 0) }]);
///     recorder.step(&mut world, &inputs);
///     assert!(recorder.outcomes()[0].result.is_ok());
/// }
/// let replay = Replay::from_bytes(&recorder.finish(&world), &[])?;
/// let mut playback: Playback<'_> = replay.play();
/// playback.seek(5);
/// assert_eq!(playback.commands().count(), 1); // of the tick to come
/// let went_on: Result<bool, Box<Divergence>> = playback.step();
/// assert_eq!(went_on, Ok(true));
/// assert_eq!(playback.outcomes().len(), 1);
/// assert_eq!(playback.recorded_hash(), Some(playback.world().state_hash()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Playback<'a> {
    replay: &'a Replay,
    world: World,
    /// Before the tick to come.
    cursor: Cursor,
    /// How many ticks are behind.
    ticks: u64,
    /// The hash recorded for the world as it is.
    recorded: Option<u64>,
    outcomes: Vec<InputResult>,
    most: ReplayLimits,
    /// How many commands were carried out.
    commands: u64,
    /// What of the limits was exceeded: it stopped there, maybe amid a tick, and does not go on.
    beyond: Option<VerifyError>,
}

impl<'a> Playback<'a> {
    pub(super) fn new(replay: &'a Replay, most: ReplayLimits) -> Self {
        let (cursor, recorded, outcomes) = (Cursor::default(), None, Vec::new());
        Self {
            replay,
            world: replay.start.clone(),
            cursor,
            ticks: 0,
            recorded,
            outcomes,
            most,
            commands: 0,
            beyond: None,
        }
    }

    /// Plays on to the end, or as far as it may.
    pub(super) fn verify(mut self) -> Result<(), VerifyError> {
        self.most.check_ticks(self.replay)?;
        self.most.check(&self.world)?;
        while self.step()? {}
        self.beyond.map_or(Ok(()), Err)
    }

    /// The world as it is now.
    #[must_use]
    pub fn world(&self) -> &World {
        &self.world
    }

    /// The commands of the tick to come in the order in which they are carried out, none at the end: calls outside of inputs
    /// first, then inputs by player and sequence.
    pub fn commands(&self) -> impl Iterator<Item = Command> + use<'a> {
        let tick = self.replay.next(&mut self.cursor.clone());
        let calls = tick.into_iter().flat_map(|tick| tick.calls.iter());
        calls.chain(tick.into_iter().flat_map(|tick| tick.inputs.iter().map(|input| input.command)))
    }

    /// What became of the inputs of the last tick.
    #[must_use]
    pub fn outcomes(&self) -> &[InputResult] {
        &self.outcomes
    }

    /// The hash that was recorded for the world as it is now, if one was.
    #[must_use]
    pub fn recorded_hash(&self) -> Option<u64> {
        self.recorded
    }

    /// Does what was done in the tick, steps, and compares with what was recorded. `false` at the end, where nothing is
    /// done.
    ///
    /// A run that parts is played on, aside, up to a snapshot that names in what. That takes as long as what is done until then,
    /// which a loop of the caller's does not see: [`Replay::verify_within`] has limits that hold for it too.
    ///
    /// # Errors
    /// A [`Divergence`]; the world is at that tick, and can go on.
    pub fn step(&mut self) -> Result<bool, Box<Divergence>> {
        if !self.advance() {
            return Ok(false);
        }
        let snapshot = self.replay.snapshot_after(self.ticks);
        let done = self.replay.done.filter(|_| self.replay.ticks == self.ticks);
        let recorded = [self.recorded_hash(), snapshot.map(World::state_hash), done.map(|done| done.hash)];
        let mut recorded = recorded.into_iter().flatten().peekable();
        if recorded.peek().is_none() {
            return Ok(true);
        }
        let computed = self.world.state_hash();
        recorded.find(|&hash| hash != computed).map_or(Ok(true), |hash| Err(Box::new(self.divergence(hash))))
    }

    /// The same without comparing. `false` also where the limits are exceeded: before the step, which is what takes long.
    fn advance(&mut self) -> bool {
        if self.beyond.is_some() {
            return false;
        }
        let Some(tick) = self.replay.next(&mut self.cursor) else { return false };
        for call in tick.calls.iter() {
            if self.is_beyond() {
                return false;
            }
            // One that is refused was not recorded; refused here, it is found by the hash.
            _ = self.world.execute(&call);
        }
        self.outcomes.clear();
        for input in tick.inputs.iter() {
            if self.is_beyond() {
                return false;
            }
            let outcome = self.world.carry_out_one(&input);
            self.outcomes.push(outcome);
        }
        self.beyond = self.most.check(&self.world).err();
        if self.beyond.is_some() {
            return false;
        }
        self.world.step();
        self.ticks += 1;
        self.recorded = tick.hash;
        true
    }

    /// Whether another command would be beyond the limits, or what the last one made is.
    fn is_beyond(&mut self) -> bool {
        let beyond = VerifyError::Commands { tick: self.world.tick(), most: self.most.commands };
        self.beyond = self.most.check(&self.world).err().or((self.commands == self.most.commands).then_some(beyond));
        self.commands += 1;
        self.beyond.is_some()
    }

    /// Goes to a tick, or to the end if that is before it: from the snapshot nearest before it, without comparing.
    pub fn seek(&mut self, tick: u64) {
        let ticks = tick.saturating_sub(self.replay.head.tick);
        let (after, nearest) = self.replay.snapshot_before(ticks);
        if self.ticks > ticks || self.ticks < after {
            self.world.clone_from(nearest);
            (self.cursor, self.recorded) = self.replay.cursor(after);
            self.ticks = after;
        }
        self.seek_on(ticks);
    }

    /// Finds out in what the run differs from the one recorded: that has its values in snapshots alone. Within the limits: what
    /// anybody can have recorded may be larger by then.
    fn divergence(&self, recorded: u64) -> Divergence {
        let (tick, computed) = (self.world.tick(), self.world.state_hash());
        let head = &self.replay.head;
        let mut ahead = self.clone();
        let found = self.replay.snapshots_from(self.ticks).find_map(|(after, snapshot)| {
            ahead.seek_on(after);
            if ahead.beyond.is_some() {
                return None;
            }
            let found = snapshot.first_difference(&ahead.world)?;
            Some(Finding::at(head.tick_after(after - 1), TickPhase::End, found))
        });
        let last = head.tick_after(self.ticks - 1);
        let finding = found.unwrap_or_else(|| Finding::of_hashes(last, recorded, computed));
        Divergence { tick, recorded, computed, finding }
    }

    fn seek_on(&mut self, ticks: u64) {
        while self.ticks < ticks && self.advance() {}
    }
}
