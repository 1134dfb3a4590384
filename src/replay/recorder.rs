//! Recording runs.

use alloc::vec::Vec;

use super::PHYSICS_VERSION;
use super::file::{Doings, Done, Head};
use super::layout::Writer;
use crate::error::Error;
use crate::math::Random;
use crate::world::{Command, Created, InputResult, Inputs, StepReport, Stepper, World};

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
    writer: Writer,
    calls: Vec<Command>,
    /// The world before the first of these calls, if there are any.
    uncalled: Option<World>,
    outcomes: Vec<InputResult>,
    random: Random,
    blob: Vec<u8>,
}

impl Recorder {
    /// Begins with a world as it is.
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
            calls: Vec::new(),
            uncalled: None,
            outcomes: Vec::new(),
            random: *world.random(),
            blob: world.blob().to_vec(),
        }
    }

    /// Does something outside of the players' inputs, as the level's own doings: it comes before the inputs of the tick.
    ///
    /// # Errors
    /// As [`World::execute`]; then nothing is recorded.
    pub fn execute(&mut self, world: &mut World, command: &Command) -> Result<Created, Error> {
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
        let before = world.tick();
        world.carry_out_into(inputs, &mut self.outcomes);
        world.step();
        self.random = *world.random();
        self.blob.clear();
        self.blob.extend_from_slice(world.blob());
        let (head, after) = (self.writer.head, world.tick());
        let hash = head.has_hash(after).then(|| world.state_hash());
        self.writer.tick(before, &Doings { calls: &self.calls, inputs, hash }, after);
        self.calls.clear();
        if head.has_snapshot(after) {
            self.writer.snapshot(world);
        }
        world.last_report()
    }

    /// What became of the inputs of the last step.
    #[must_use]
    pub fn outcomes(&self) -> &[InputResult] {
        &self.outcomes
    }

    /// What of the file is finished, to be written away; each byte is handed out once.
    #[must_use]
    pub fn take_bytes(&mut self) -> Vec<u8> {
        core::mem::take(&mut self.writer.file)
    }

    /// Ends the recording with the world as the last step left it, and gives the rest of the file: all of it if nothing was
    /// taken before. What was done since is of no tick, and not recorded.
    #[must_use]
    pub fn finish(self, world: &World) -> Vec<u8> {
        let mut writer = self.writer;
        writer.finish_segment();
        let uncalled = self.uncalled.filter(|_| !self.calls.is_empty());
        let mut world = uncalled.unwrap_or_else(|| world.clone());
        world.random = self.random;
        world.blob = self.blob;
        if !writer.head.has_snapshot(world.tick()) {
            writer.snapshot(&world);
        }
        writer.done(Done { tick: world.tick(), hash: world.state_hash() });
        writer.file
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
}

/// Ticks without players: all commands are the level's own.
impl Stepper for Recorder {
    fn execute(&mut self, world: &mut World, command: &Command) -> Result<Created, Error> {
        Self::execute(self, world, command)
    }

    fn step(&mut self, world: &mut World) {
        Self::step(self, world, &Inputs::new());
    }
}
