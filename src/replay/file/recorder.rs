//! Recording runs.

use alloc::vec::Vec;

use super::format::{Done, Head};
use super::labels::Labels;
use super::layout::Writer;
use super::ticks::NewTick;
use crate::error::Error;
use crate::math::Random;
use crate::replay::snapshot::{BeforeCalls, PHYSICS_VERSION, restless_sleepers};
use crate::slots::BodyId;
use crate::world::{Command, ConfirmedTick, Created, InputResult, Inputs, StepReport, Stepper, World};

/// Options that set how much is recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RecordOptions {
    /// The number of ticks from one recorded hash to the next, at least 1; the world's own count of ticks decides. A
    /// divergence is dated to a tick with a hash.
    pub hash_every: u32,
    /// The number of ticks from one snapshot to the next, 0 for none on the way. Snapshots tell which value diverged, and
    /// playback can start from each. The last tick always has one.
    pub snapshot_every: u32,
}

impl Default for RecordOptions {
    /// A hash every tick, a snapshot every 4,096 ticks.
    fn default() -> Self {
        Self { hash_every: 1, snapshot_every: 4_096 }
    }
}

/// Records a run: the world at its start, all changes to it, and the hashes of the results.
///
/// All changes must go through the recorder, but for two that it notices by itself: numbers drawn from the world's random
/// generator, and changes of its blob.
///
/// The calls and inputs of a tick, and the snapshot of a world, must take less than 4 GiB each: a longer part makes the file
/// unreadable. The limit is 255 blobs of the largest size in one tick; a snapshot reaches it with 13 million bodies, or with
/// fewer that have large shapes.
///
/// ```
/// use umbra_physics::{BodyDef, Command, Input, Inputs, RecordOptions, Recorder, Replay, World, WorldDef, vec2};
///
/// let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
/// let ball = world.add_body(BodyDef::dynamic())?;
///
/// let mut recorder = Recorder::new(&world, RecordOptions::default());
/// for tick in 0..100 {
///     let mut inputs = Inputs::new();
///     if tick % 30 == 0 {
///         let command = Command::SetVelocity { body: ball, velocity: vec2(0, 5) };
///         inputs.insert(Input { player: 0, sequence: 0, command })?;
///     }
///     recorder.step(&mut world, &inputs);
/// }
/// let file = recorder.finish(&world);
///
/// let replay = Replay::from_bytes(&file, &[])?;
/// replay.verify()?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Recorder {
    writer: Writer,
    labels: Labels,
    calls: Vec<Command>,
    /// The parts of the world that these calls changed, as the last step left them.
    before_calls: Option<BeforeCalls>,
    restless_sleepers: Vec<BodyId>,
    outcomes: Vec<InputResult>,
    /// The random generator and the blob as the last step left them.
    random: Random,
    blob: Vec<u8>,
    /// The tick that is recorded next.
    next: u64,
}

impl Recorder {
    /// Begins a recording with a world as it is.
    #[must_use]
    pub fn new(world: &World, options: RecordOptions) -> Self {
        let RecordOptions { hash_every, snapshot_every } = options;
        let head = Head {
            physics_version: PHYSICS_VERSION,
            tick: world.tick(),
            hash_every: hash_every.max(1),
            snapshot_every,
        };
        Self {
            writer: Writer::new(head, world),
            labels: Labels::new(),
            calls: Vec::new(),
            before_calls: None,
            restless_sleepers: restless_sleepers(world),
            outcomes: Vec::new(),
            random: *world.random(),
            blob: world.blob().to_vec(),
            next: world.tick(),
        }
    }

    /// Makes a call that is no input of a player, such as an action of the level itself. Calls come before the inputs of the
    /// tick.
    ///
    /// # Errors
    /// The errors of [`World::execute`]; then nothing is recorded.
    pub fn execute(&mut self, world: &mut World, command: &Command) -> Result<Created, Error> {
        let before = self.before_calls.get_or_insert_with(|| BeforeCalls::new(world, &self.restless_sleepers));
        let created = before.during(world, command, |world| world.execute(command))?;
        self.calls.push(command.clone());
        Ok(created)
    }

    /// Carries out the inputs of a tick and steps.
    pub fn step<'w>(&mut self, world: &'w mut World, inputs: &Inputs) -> StepReport<'w> {
        self.notice(world);
        self.before_calls = None;
        let before = world.tick();
        world.carry_out_into(inputs, &mut self.outcomes);
        world.step();
        let mut calls = core::mem::take(&mut self.calls);
        self.next = before;
        self.add(world, &calls, inputs);
        calls.clear();
        self.calls = calls;
        world.last_report()
    }

    /// Adds a tick with the world after it. Returns the hash, if it is recorded.
    fn add(&mut self, world: &World, calls: &[Command], inputs: &Inputs) -> Option<u64> {
        self.random = *world.random();
        self.blob.clear();
        self.blob.extend_from_slice(world.blob());
        let head = self.writer.head;
        let after = world.tick();
        let hash = head.has_hash(after).then(|| world.state_hash());
        self.writer.tick(self.next, &NewTick { calls, inputs, hash }, after);
        self.next = after;
        if head.has_snapshot(after) {
            self.writer.snapshot(world);
        }
        hash
    }

    /// Records a tick that a [`Rollback`](crate::Rollback) has confirmed: the calls of its tick function. The next tick to
    /// record is the one after it. Returns the hash of the world after the tick, if the options say that it is recorded.
    ///
    /// At the end, [`finish`](Self::finish) takes the world after the last confirmed tick,
    /// [`Rollback::confirmed_world`](crate::Rollback::confirmed_world).
    ///
    /// # Errors
    /// [`Error::TickForgotten`] or [`Error::TickToCome`] if another tick was to be recorded; nothing is recorded then.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, RecordOptions, Recorder, Replay, Rollback, World, WorldDef, vec2};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let ship = world.add_body(BodyDef::dynamic())?;
    /// let mut recorder = Recorder::new(&world, RecordOptions::default());
    /// let mut rollback = Rollback::new(&world, [0, 1], 8);
    /// for now in 0..60 {
    ///     rollback.add_input(now, 0, now as i32)?;
    ///     if let Some(late) = now.checked_sub(3) {
    ///         rollback.add_input(late, 1, -1)?;
    ///     }
    ///     let tick = |world: &mut World, inputs: &[(u32, i32)]| {
    ///         let sum: i32 = inputs.iter().map(|(_, speed)| speed).sum();
    ///         world.set_velocity(ship, vec2(sum, 0)).expect("a slow ship");
    ///     };
    ///     for confirmed in rollback.advance(&mut world, tick)?.confirmed() {
    ///         let _hash = recorder.record(&confirmed)?; // to compare with the other peers
    ///     }
    /// }
    /// let replay = Replay::from_bytes(&recorder.finish(rollback.confirmed_world(&world)), &[])?;
    /// replay.verify()?;
    /// assert_eq!(replay.ticks(), 57);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn record<I>(&mut self, confirmed: &ConfirmedTick<'_, I>) -> Result<Option<u64>, Error> {
        let ConfirmedTick { tick, commands, after: world, .. } = *confirmed;
        if tick < self.next {
            return Err(Error::TickForgotten { tick, oldest: self.next });
        }
        if tick > self.next {
            return Err(Error::TickToCome { tick, present: self.next });
        }
        Ok(self.add(world, commands, &Inputs::new()))
    }

    /// The results of the inputs of the last step.
    #[must_use]
    pub fn outcomes(&self) -> &[InputResult] {
        &self.outcomes
    }

    /// The names of bodies, force fields and joints, to be changed at any time before the end. They are written at the end: a file that is cut
    /// off has none.
    #[must_use]
    pub const fn labels_mut(&mut self) -> &mut Labels {
        &mut self.labels
    }

    /// Takes the finished bytes of the file, to write them out; each byte is handed out once.
    #[must_use]
    pub fn take_bytes(&mut self) -> Vec<u8> {
        core::mem::take(&mut self.writer.file)
    }

    /// Ends the recording with the world as the last step left it, and gives the rest of the file: all of it if nothing was
    /// taken before. Calls since the last step belong to no tick and are not recorded.
    #[must_use]
    pub fn finish(self, world: &World) -> Vec<u8> {
        let mut writer = self.writer;
        writer.finish_segment();
        // A state that a world had can always be rebuilt.
        let rebuilt = self.before_calls.and_then(|before| before.rebuild(world).ok());
        let mut world = rebuilt.unwrap_or_else(|| world.clone());
        world.random = self.random;
        world.blob = self.blob;
        if !writer.head.has_snapshot(world.tick()) {
            writer.snapshot(&world);
        }
        writer.labels(&self.labels);
        writer.done(Done { tick: world.tick(), hash: world.state_hash() });
        writer.file
    }

    /// Records the changes that a game makes without commands, as calls after all others.
    fn notice(&mut self, world: &World) {
        let (mut random, mut blob) = (&self.random, &self.blob);
        for call in &self.calls {
            match call {
                Command::SetRandom(set) => random = set,
                Command::SetBlob(set) => blob = set,
                _ => {}
            }
        }
        let (is_random_new, is_blob_new) = (world.random() != random, world.blob() != blob);
        if is_random_new {
            self.calls.push(Command::SetRandom(*world.random()));
        }
        if is_blob_new {
            self.calls.push(Command::SetBlob(world.blob().to_vec()));
        }
    }
}

/// The ticks have no players: all commands are calls.
impl Stepper for Recorder {
    fn execute(&mut self, world: &mut World, command: &Command) -> Result<Created, Error> {
        Self::execute(self, world, command)
    }

    fn step(&mut self, world: &mut World) {
        Self::step(self, world, &Inputs::new());
    }
}
