//! A run as plain data: a fresh world, and commands by tick.

use std::collections::BTreeMap;

use super::Handles;
use super::handles::all_made;
use umbra_physics::{Command, Created, Error, RecordOptions, Recorder, Stepper, World, WorldDef};

/// A run: an empty world, what is done to it, and for how long.
///
/// The commands are those that [`World::execute`] takes, with the handles that the world gives out: the first body is
/// `BodyId::from_parts(0, 0)`. Commands of tick 0 build the scene. A tick carries out its commands, in the order of the list,
/// and then steps. One that is refused changes nothing and stops no other.
///
/// ```
/// use umbra_oracles::Script;
/// use umbra_physics::{BodyDef, BodyId, Command, Replay, WorldDef, vec2};
///
/// let ball = BodyId::from_parts(0, 0);
/// let script = Script {
///     world: WorldDef { gravity: vec2(0, -10), ..WorldDef::default() },
///     commands: vec![
///         (0, Command::AddBody(BodyDef::dynamic())),
///         (30, Command::SetVelocity { body: ball, velocity: vec2(0, 5) }),
///     ],
///     ticks: 60,
/// };
/// let end = script.run()?;
/// assert_eq!(end.body(ball)?.velocity(), vec2(0, 0));
///
/// let replay = Replay::from_bytes(&script.record()?, &[])?;
/// assert_eq!((replay.end(), replay.verify()), (60, Ok(())));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// ```
/// use umbra_oracles::{Oracle, Script};
/// use umbra_physics::{BodyDef, Command, WorldDef};
///
/// let add = |key| Command::AddBody(BodyDef { key, ..BodyDef::dynamic() });
/// let script = Script { world: WorldDef::default(), commands: vec![(0, add(1)), (2, add(2))], ticks: 4 };
/// // Tick by tick, with a driver: `()` does no more than carry out.
/// let mut world = script.start()?;
/// while world.tick() < script.ticks {
///     println!("{} commands", script.commands_of(world.tick()).count());
///     script.advance(&mut world, &mut ());
/// }
/// assert_eq!(world.state_hash(), script.run()?.state_hash());
/// // Some of its commands alone; and the smallest one that an oracle objects to, if one does.
/// assert_eq!(script.with(|index| index == 1).run()?.body_count(), 1);
/// assert_eq!(script.shrunk(Oracle::Restore, 100), None);
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Script {
    /// The definition of the world.
    pub world: WorldDef,
    /// The commands, each with its tick. Ticks may stand in any order; commands from `ticks` on are never reached.
    pub commands: Vec<(u64, Command)>,
    /// The number of ticks.
    pub ticks: u64,
}

impl Script {
    /// The world before the first tick, empty.
    ///
    /// # Errors
    /// As [`WorldDef::check`].
    pub fn start(&self) -> Result<World, Error> {
        World::new(self.world)
    }

    /// Carries out the commands of the world's tick, and steps the world.
    pub fn advance(&self, world: &mut World, driver: &mut dyn Stepper) {
        for command in self.commands_of(world.tick()) {
            // What is refused is refused in every run alike.
            _ = driver.execute(world, command);
        }
        driver.step(world);
    }

    /// The commands of a tick, in the order in which they are carried out.
    pub fn commands_of(&self, tick: u64) -> impl Iterator<Item = &Command> {
        self.commands.iter().filter(move |(at, _)| *at == tick).map(|(_, command)| command)
    }

    /// The world at the end.
    ///
    /// # Errors
    /// As [`WorldDef::check`].
    pub fn run(&self) -> Result<World, Error> {
        let mut world = self.start()?;
        self.play(&mut world, &mut ());
        Ok(world)
    }

    /// The run as a replay: the bytes of a file that `umbra view` and `umbra verify` open.
    ///
    /// # Errors
    /// As [`WorldDef::check`].
    pub fn record(&self) -> Result<Vec<u8>, Error> {
        let mut world = self.start()?;
        let mut recorder = Recorder::new(&world, RecordOptions::default());
        self.play(&mut world, &mut recorder);
        Ok(recorder.finish(&world))
    }

    /// Makes all ticks. The commands are put in order once: each tick by itself goes through the whole list.
    fn play(&self, world: &mut World, driver: &mut dyn Stepper) {
        let mut order: Vec<&(u64, Command)> = self.commands.iter().collect();
        order.sort_by_key(|(tick, _)| *tick);
        let mut commands = order.into_iter().peekable();
        for now in 0..self.ticks {
            while let Some((_, command)) = commands.next_if(|(tick, _)| *tick == now) {
                _ = driver.execute(world, command);
            }
            driver.step(world);
        }
    }

    /// The script with some of its commands alone, by their places in the list.
    ///
    /// The handles in the others are those that the world gives out then, so that they name the same bodies and fields as
    /// before; what they name of bodies and fields that are no longer added is refused.
    #[must_use]
    pub fn with(&self, mut keep: impl FnMut(usize) -> bool) -> Self {
        let kept = self.commands.iter().enumerate().filter(|(index, _)| keep(*index));
        self.arranged(&self.made(), kept.map(|(index, (tick, _))| (*tick, index)).collect(), self.ticks)
    }

    /// The bodies, fields and colliders that the commands make, by the places of the commands in the list.
    pub(super) fn made(&self) -> BTreeMap<usize, Vec<Created>> {
        let mut created = BTreeMap::new();
        let mut order: Vec<(u64, usize)> = self.commands.iter().enumerate().map(|(i, (tick, _))| (*tick, i)).collect();
        order.sort_by_key(|(tick, _)| *tick);
        self.walk(&order, self.ticks, |world, index| {
            if let Ok(new) = world.execute(&self.commands[index].1) {
                created.insert(index, all_made(world, new));
            }
        });
        created
    }

    /// Makes a script of some of the commands, by their places in the list, at other ticks and in another order, with the
    /// handles that they have there. `created` is what [`Self::made`] returns.
    pub(super) fn arranged(
        &self,
        created: &BTreeMap<usize, Vec<Created>>,
        mut order: Vec<(u64, usize)>,
        ticks: u64,
    ) -> Self {
        order.sort_by_key(|(tick, _)| *tick);
        let mut handles = Handles::default();
        let mut commands = Vec::with_capacity(order.len());
        self.walk(&order, ticks, |world, index| {
            let command = handles.command(&self.commands[index].1);
            if let (Some(was), Ok(new)) = (created.get(&index), world.execute(&command)) {
                was.iter().zip(all_made(world, new)).for_each(|(was, new)| handles.pair(*was, new));
            }
            commands.push(command);
        });
        // Those that the walk did not come to.
        commands.extend(order[commands.len()..].iter().map(|(_, index)| handles.command(&self.commands[*index].1)));
        let commands = order.into_iter().map(|(tick, _)| tick).zip(commands).collect();
        Self { world: self.world, commands, ticks }
    }

    /// Takes a fresh world to the tick of each of these commands in turn, as far as the ticks go.
    fn walk(&self, order: &[(u64, usize)], ticks: u64, mut visit: impl FnMut(&mut World, usize)) {
        let Ok(mut world) = self.start() else { return };
        for &(tick, index) in order.iter().take_while(|(tick, _)| *tick < ticks) {
            while world.tick() < tick {
                world.step();
            }
            visit(&mut world, index);
        }
    }
}
