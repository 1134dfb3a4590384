//! Playing a replay: tick by tick, compared with the recorded hashes.

use alloc::boxed::Box;
use alloc::vec::Vec;
use core::fmt;

use super::replay::{Cursor, Replay};
use super::verify::{Divergence, ReplayLimits, VerifyError};
use crate::replay::diff::{Difference, TickPhase};
use crate::world::{Command, InputResult, World};

impl Replay {
    /// Plays the replay from its start.
    #[must_use]
    pub fn play(&self) -> Playback<'_> {
        Playback::new(self, ReplayLimits::NONE)
    }

    /// Plays an untrusted replay from its start within limits, as [`verify_within`](Self::verify_within) does, tick by tick: for a
    /// caller that looks at the ticks, or that ends the work by its own measure, such as time
    /// ([`Playback::stop_when`]). Once a limit is exceeded, [`Playback::step`] returns `false`, and [`Playback::exceeded`] says
    /// which one.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, Command, Inputs, RecordOptions, Recorder, Replay, ReplayLimits, VerifyError};
    /// use umbra_physics::{World, WorldDef};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let mut recorder = Recorder::new(&world, RecordOptions::default());
    /// for _ in 0..9 {
    ///     recorder.execute(&mut world, &Command::AddBody(BodyDef::dynamic()))?;
    ///     recorder.step(&mut world, &Inputs::new());
    /// }
    /// let replay = Replay::from_bytes(&recorder.finish(&world), &[])?;
    /// let limits = ReplayLimits { ticks: 99, bodies: 6, fields: 9, colliders: 9, pairs: 1 << 20, commands: 99 };
    /// let mut playback = replay.play_within(limits);
    /// while playback.step()? {}
    /// assert_eq!((playback.world().tick(), playback.exceeded()), (6, Some(&VerifyError::Bodies { tick: 6, most: 6 })));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn play_within(&self, limits: ReplayLimits) -> Playback<'_> {
        Playback::new(self, limits)
    }

    /// Runs the whole replay again, and compares every hash. For an untrusted replay use
    /// [`verify_within`](Self::verify_within).
    ///
    /// # Errors
    /// A [`Divergence`] at the first hash that differs.
    pub fn verify(&self) -> Result<(), Box<Divergence>> {
        let mut playback = self.play();
        while playback.step()? {}
        Ok(())
    }

    /// Verifies an untrusted replay within limits on its ticks and commands, and on the bodies, colliders and force fields at any time: a
    /// short file can add many, and step them for long. The limits hold for the search of a divergence too.
    ///
    /// The time is at most that of `ticks` steps of `bodies` bodies in `fields` fields, of a pass over such a world, its blob
    /// included, for each hash, and of the commands in the file, each on so many bodies and fields. A limit on the size of the
    /// file limits its blobs and commands. The time of custom forces comes on top.
    ///
    /// # Errors
    /// A [`VerifyError`]: the run diverged from the recording, or exceeded a limit.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, Command, Inputs, RecordOptions, Recorder, Replay, ReplayLimits, VerifyError};
    /// use umbra_physics::{World, WorldDef};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let mut recorder = Recorder::new(&world, RecordOptions::default());
    /// for _ in 0..100 {
    ///     recorder.execute(&mut world, &Command::AddBody(BodyDef::dynamic()))?;
    ///     recorder.step(&mut world, &Inputs::new());
    /// }
    /// let replay = Replay::from_bytes(&recorder.finish(&world), &[])?;
    /// let limits = ReplayLimits {
    ///     ticks: 60 * 60 * 30,
    ///     bodies: 1_000,
    ///     fields: 200,
    ///     colliders: 1_000,
    ///     pairs: 1 << 20,
    ///     commands: 100_000,
    /// };
    /// assert_eq!(replay.verify_within(limits), Ok(()));
    /// let error = replay.verify_within(ReplayLimits { bodies: 60, ..limits }).unwrap_err();
    /// assert_eq!(error, VerifyError::Bodies { tick: 60, most: 60 });
    /// assert_eq!(error.to_string(), "more than 60 bodies at tick 60");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn verify_within(&self, limits: ReplayLimits) -> Result<(), VerifyError> {
        self.verified_end(limits).map(drop)
    }

    /// Verifies an untrusted replay as [`verify_within`](Self::verify_within) does, and gives the world at its end: a server reads the
    /// result of a match from it, without a second run.
    ///
    /// # Errors
    /// As [`verify_within`](Self::verify_within).
    ///
    /// ```
    /// use umbra_physics::{Inputs, RecordOptions, Recorder, Replay, ReplayLimits, World, WorldDef};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let mut recorder = Recorder::new(&world, RecordOptions::default());
    /// world.set_blob(b"3:1")?; // the game's own: before the step that records it
    /// (0..30).for_each(|_| _ = recorder.step(&mut world, &Inputs::new()));
    /// let replay = Replay::from_bytes(&recorder.finish(&world), &[])?;
    /// let limits = ReplayLimits { ticks: 30, bodies: 9, fields: 9, colliders: 9, pairs: 1 << 20, commands: 9 };
    /// let end = replay.verified_end(limits)?;
    /// assert_eq!((end.tick(), end.blob()), (30, &b"3:1"[..]));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn verified_end(&self, limits: ReplayLimits) -> Result<World, VerifyError> {
        let mut playback = self.play_within(limits);
        while playback.step()? {}
        playback.exceeded.map_or(Ok(playback.world), Err)
    }
}

/// A replay that is being played.
///
/// ```
/// use umbra_physics::{
///     BodyDef, Command, Divergence, Inputs, Playback, RecordOptions, Recorder, Replay, World, WorldDef, vec2,
/// };
///
/// let mut world = World::new(WorldDef::default())?;
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
    /// The number of ticks played.
    ticks: u64,
    /// The recorded hash of the world as it is now.
    recorded: Option<u64>,
    outcomes: Vec<InputResult>,
    limits: ReplayLimits,
    /// The number of commands carried out.
    commands: u64,
    stop: Option<Stop<'a>>,
    /// The limit that was exceeded. The playback stopped there, maybe within a tick, and does not go on.
    exceeded: Option<VerifyError>,
}

/// Says whether a playback is to stop.
#[derive(Clone, Copy)]
struct Stop<'a>(&'a (dyn Fn() -> bool + Sync));

impl fmt::Debug for Stop<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Stop")
    }
}

impl<'a> Playback<'a> {
    pub(super) fn new(replay: &'a Replay, limits: ReplayLimits) -> Self {
        let (cursor, recorded, outcomes) = (Cursor::default(), None, Vec::new());
        let exceeded = limits.check_ticks(replay.ticks).and_then(|()| limits.check(&replay.start)).err();
        Self {
            replay,
            world: replay.start.clone(),
            cursor,
            ticks: 0,
            recorded,
            outcomes,
            limits,
            commands: 0,
            stop: None,
            exceeded,
        }
    }

    /// Stops the playback when the caller says so, who is asked before each command and before each step, in the search of a
    /// divergence too: the work left is at most one command or step. [`exceeded`](Self::exceeded) is [`VerifyError::Stopped`] then.
    ///
    /// ```
    /// use core::sync::atomic::{AtomicU32, Ordering};
    /// use umbra_physics::{Inputs, RecordOptions, Recorder, Replay, VerifyError, World, WorldDef};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let mut recorder = Recorder::new(&world, RecordOptions::default());
    /// (0..100).for_each(|_| _ = recorder.step(&mut world, &Inputs::new()));
    /// let replay = Replay::from_bytes(&recorder.finish(&world), &[])?;
    /// let asked = AtomicU32::new(0);
    /// let is_enough = || asked.fetch_add(1, Ordering::Relaxed) == 30;
    /// let mut playback = replay.play().stop_when(&is_enough);
    /// while playback.step()? {}
    /// assert_eq!(playback.exceeded(), Some(&VerifyError::Stopped { tick: 30 }));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub const fn stop_when(mut self, is_over: &'a (dyn Fn() -> bool + Sync)) -> Self {
        self.stop = Some(Stop(is_over));
        self
    }

    /// The limit that was exceeded, if one was. The playback has stopped there, maybe after some commands of the tick to come, and
    /// does not go on.
    #[must_use]
    pub const fn exceeded(&self) -> Option<&VerifyError> {
        self.exceeded.as_ref()
    }

    /// The world as it is now.
    #[must_use]
    pub fn world(&self) -> &World {
        &self.world
    }

    /// The commands of the next tick in the order in which they are carried out, none at the end: first the calls that are no
    /// input, then the inputs by player and sequence.
    pub fn commands(&self) -> impl Iterator<Item = Command> + use<'a> {
        let tick = self.replay.next(&mut self.cursor.clone());
        let calls = tick.into_iter().flat_map(|tick| tick.calls.iter());
        calls.chain(tick.into_iter().flat_map(|tick| tick.inputs.iter().map(|input| input.command)))
    }

    /// The results of the inputs of the last tick; none after a [`seek`](Self::seek).
    #[must_use]
    pub fn outcomes(&self) -> &[InputResult] {
        &self.outcomes
    }

    /// The recorded hash of the world as it is now, if there is one.
    #[must_use]
    pub fn recorded_hash(&self) -> Option<u64> {
        self.recorded
    }

    /// Plays a tick and compares the result with the recorded one. Returns `false` at the end, where nothing is done, and where a
    /// limit is exceeded.
    ///
    /// When the run diverges, a copy is played on up to a snapshot that tells which value differs. That may take long, and a
    /// loop of the caller cannot interrupt it: the limits of [`Replay::play_within`] and [`stop_when`](Self::stop_when) hold for it
    /// too.
    ///
    /// # Errors
    /// A [`Divergence`]. The world is at its tick, and the playback can go on.
    pub fn step(&mut self) -> Result<bool, Box<Divergence>> {
        if !self.advance() {
            return Ok(false);
        }
        let mut recorded = self.replay.hashes_after(self.ticks, self.recorded).into_iter().flatten().peekable();
        if recorded.peek().is_none() {
            return Ok(true);
        }
        let computed = self.world.state_hash();
        recorded.find(|&hash| hash != computed).map_or(Ok(true), |hash| Err(Box::new(self.divergence(hash))))
    }

    /// Plays a tick without comparing. Returns `false` at the end, and before the step if a limit is exceeded: it is the step
    /// that takes long.
    fn advance(&mut self) -> bool {
        if self.exceeded.is_some() {
            return false;
        }
        let Some(tick) = self.replay.next(&mut self.cursor) else { return false };
        for call in tick.calls.iter() {
            if self.exceeds_limits() {
                return false;
            }
            // A refused call is not recorded. If one is refused here, the hash will differ.
            _ = self.world.execute(&call);
        }
        self.outcomes.clear();
        for input in tick.inputs.iter() {
            if self.exceeds_limits() {
                return false;
            }
            let outcome = self.world.carry_out_one(&input);
            self.outcomes.push(outcome);
        }
        self.exceeded = self.limits.check(&self.world).err().or_else(|| self.stopped());
        if self.exceeded.is_some() {
            return false;
        }
        self.world.step();
        self.ticks += 1;
        self.recorded = tick.hash;
        true
    }

    /// Says whether the last command exceeded a limit, or the next one would.
    fn exceeds_limits(&mut self) -> bool {
        let exceeded = VerifyError::Commands { tick: self.world.tick(), most: self.limits.commands };
        let commands = (self.commands == self.limits.commands).then_some(exceeded);
        self.exceeded = self.limits.check(&self.world).err().or(commands).or_else(|| self.stopped());
        self.commands += 1;
        self.exceeded.is_some()
    }

    /// The error of a playback that the caller stops.
    fn stopped(&self) -> Option<VerifyError> {
        let is_over = self.stop.is_some_and(|Stop(is_over)| is_over());
        is_over.then(|| VerifyError::Stopped { tick: self.world.tick() })
    }

    /// Goes to a tick, or to the end if that is earlier: from the nearest snapshot before it, without comparing.
    pub fn seek(&mut self, tick: u64) {
        let ticks = tick.saturating_sub(self.replay.head.tick);
        let (after, nearest) = self.replay.snapshot_before(ticks);
        if self.ticks > ticks || self.ticks < after {
            self.world.clone_from(nearest);
            (self.cursor, self.recorded) = self.replay.cursor(after);
            self.ticks = after;
        }
        self.seek_on(ticks);
        self.outcomes.clear();
    }

    /// Finds the first value in which the run differs from the recorded one, whose values are in its snapshots alone. The
    /// limits hold: an untrusted run may grow until the next snapshot.
    fn divergence(&self, recorded: u64) -> Divergence {
        let tick = self.world.tick();
        let computed = self.world.state_hash();
        let head = &self.replay.head;
        let mut ahead = self.clone();
        let finding = self.replay.snapshots_from(self.ticks).find_map(|(after, snapshot)| {
            ahead.seek_on(after);
            if ahead.exceeded.is_some() {
                return None;
            }
            let difference = snapshot.first_difference(&ahead.world)?;
            Some(difference.at(head.tick_after(after - 1), TickPhase::End))
        });
        let last = head.tick_after(self.ticks - 1);
        let difference = finding.unwrap_or_else(|| Difference::of_hashes(last, recorded, computed));
        let difference = self.replay.labels.name(difference, &self.world);
        Divergence { tick, recorded, computed, difference }
    }

    fn seek_on(&mut self, ticks: u64) {
        while self.ticks < ticks && self.advance() {}
    }
}
