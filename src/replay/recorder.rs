//! Recording runs.

use alloc::vec::Vec;

use super::LAW;
use super::chunk;
use super::file::{DONE, Doings, Done, HEAD, Head, REPLAY, SNAPSHOT, TICKS};
use super::snapshot::Saved;
use crate::error::Error;
use crate::math::Random;
use crate::wire::Write as _;
use crate::world::{Command, Driver, Inputs, Made, Outcome, StepReport, World};

/// A chunk of ticks has as many: what is lost when a recording is cut off.
const SEGMENT: u32 = 64;
/// Or it ends when it has so many bytes: a tick with a blob may have 2^24 more, and no chunk has 2^32.
const SEGMENT_BYTES: usize = 1 << 20;

/// How much is recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RecordOptions {
    /// A hash after every so many ticks, by the world's count of them: how exactly a divergence is dated. At least 1.
    pub hash_every: u32,
    /// A snapshot after every so many ticks, 0 for none on the way: what a divergence is named by, and from where
    /// playback can begin. The last tick has one always.
    pub snapshot_every: u32,
}

impl Default for RecordOptions {
    /// A hash every tick, a snapshot every 4,096.
    fn default() -> Self {
        Self { hash_every: 1, snapshot_every: 4_096 }
    }
}

/// Records a run: the world it begins with, all that is done to it, and what comes of it.
///
/// All changes go through the recorder, but two that it sees by itself: numbers drawn from the world's generator, and its
/// blob.
///
/// ```
/// use umbra_physics::{BodyDef, Command, Input, Inputs, RecordOptions, Recorder, Replay, World, WorldDef, vec2};
///
/// let mut world: World = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
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
    options: RecordOptions,
    /// What is finished of the file and was not taken yet.
    file: Vec<u8>,
    /// The ticks of the chunk to come, as bytes.
    segment: Vec<u8>,
    ticks: u32,
    calls: Vec<Command>,
    /// The world before the first of these calls, if there are any.
    uncalled: Option<World>,
    outcomes: Vec<Outcome>,
    random: Random,
    blob: Vec<u8>,
}

impl Recorder {
    /// Begins with a world as it is.
    #[must_use]
    pub fn new(world: &World, options: RecordOptions) -> Self {
        let options = RecordOptions { hash_every: options.hash_every.max(1), ..options };
        let mut file = REPLAY.begin();
        let mut head = Vec::new();
        let RecordOptions { hash_every, snapshot_every } = options;
        Head { law: LAW, tick: world.tick(), hash_every, snapshot_every }.write(&mut head);
        chunk::write(&mut file, HEAD, &head);
        let mut recorder = Self {
            options,
            file,
            segment: Vec::new(),
            ticks: 0,
            calls: Vec::new(),
            uncalled: None,
            outcomes: Vec::new(),
            random: *world.random(),
            blob: world.blob().to_vec(),
        };
        recorder.write_snapshot(world);
        recorder
    }

    /// Does something outside of the players' inputs, as the level's own doings: it comes before the inputs of the tick.
    ///
    /// # Errors
    /// As [`World::execute`]; then nothing is recorded.
    pub fn execute(&mut self, world: &mut World, command: &Command) -> Result<Made, Error> {
        world.check(command)?;
        if self.calls.is_empty() {
            match &mut self.uncalled {
                Some(uncalled) => uncalled.clone_from(world),
                None => self.uncalled = Some(world.clone()),
            }
        }
        let made = world.execute(command)?;
        self.calls.push(command.clone());
        Ok(made)
    }

    /// Carries out the inputs of a tick and steps.
    pub fn step<'w>(&mut self, world: &'w mut World, inputs: &Inputs) -> StepReport<'w> {
        self.notice(world);
        if self.segment.is_empty() {
            world.tick().write(&mut self.segment);
            // The number of ticks, when it is known.
            0u32.write(&mut self.segment);
        }
        world.carry_out_into(inputs, &mut self.outcomes);
        world.step();
        self.random = *world.random();
        self.blob.clear();
        self.blob.extend_from_slice(world.blob());
        let every = |count: u32| count > 0 && world.tick() % u64::from(count) == 0;
        let hash = every(self.options.hash_every).then(|| world.state_hash());
        Doings { calls: &self.calls, inputs, hash }.write(&mut self.segment);
        self.calls.clear();
        self.ticks += 1;
        let snapshot = every(self.options.snapshot_every);
        if self.ticks == SEGMENT || self.segment.len() > SEGMENT_BYTES || snapshot {
            self.finish_segment();
        }
        if snapshot {
            self.write_snapshot(world);
        }
        world.last_report()
    }

    /// What became of the inputs of the last step.
    #[must_use]
    pub fn outcomes(&self) -> &[Outcome] {
        &self.outcomes
    }

    /// What of the file is finished, to be written away; each byte is handed out once.
    #[must_use]
    pub fn take_bytes(&mut self) -> Vec<u8> {
        core::mem::take(&mut self.file)
    }

    /// Ends the recording with the world as the last step left it, and gives the rest of the file: all of it if nothing was
    /// taken before. What was done since is of no tick, and not recorded.
    #[must_use]
    pub fn finish(mut self, world: &World) -> Vec<u8> {
        self.finish_segment();
        let uncalled = self.uncalled.take().filter(|_| !self.calls.is_empty());
        let mut world = uncalled.unwrap_or_else(|| world.clone());
        world.random = self.random;
        world.blob.clone_from(&self.blob);
        let world = &world;
        if self.options.snapshot_every == 0 || world.tick() % u64::from(self.options.snapshot_every) != 0 {
            self.write_snapshot(world);
        }
        let mut done = Vec::new();
        Done { tick: world.tick(), hash: world.state_hash() }.write(&mut done);
        chunk::write(&mut self.file, DONE, &done);
        self.file
    }

    /// Records what a game does to its world without commands.
    fn notice(&mut self, world: &World) {
        if *world.random() != self.random {
            self.calls.push(Command::SetRandom(*world.random()));
        }
        if world.blob() != self.blob {
            self.calls.push(Command::SetBlob(world.blob().to_vec()));
        }
    }

    fn finish_segment(&mut self) {
        if self.ticks == 0 {
            return;
        }
        self.segment[8..12].copy_from_slice(&self.ticks.to_le_bytes());
        chunk::write(&mut self.file, TICKS, &self.segment);
        self.segment.clear();
        self.ticks = 0;
    }

    fn write_snapshot(&mut self, world: &World) {
        let mut bytes = Vec::new();
        Saved(world).write(&mut bytes);
        chunk::write(&mut self.file, SNAPSHOT, &bytes);
    }
}

/// Ticks without players: all commands are the level's own.
impl Driver for Recorder {
    fn execute(&mut self, world: &mut World, command: &Command) -> Result<Made, Error> {
        Self::execute(self, world, command)
    }

    fn step(&mut self, world: &mut World) {
        Self::step(self, world, &Inputs::new());
    }
}
