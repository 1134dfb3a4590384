//! A world of 1,000 bodies and a pit with a pile of 160 more under random commands, beside a twin that goes through a snapshot at every
//! tick, and a second one that goes back some ticks now and then and makes them again.
//!
//! Equal at every tick, and none takes more memory as time goes by. For an hour:
//! `cargo test --release --all-features --test counting -- --ignored --nocapture hour`.

#[path = "support/commands.rs"]
mod commands;
#[path = "support/pit.rs"]
mod pit;
#[path = "support/random.rs"]
mod random;

use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::seeds::is_short;
use allocation_counter::measure;
use commands::{Author, is_global};
use pit::{PILE, Phase, Pit, turn};
use random::SplitMix;
use umbra_physics::{
    BodyState, Command, Created, CustomForce, CustomForceError, Dependence, Error, ForceTorque, Snapshot, StepReport,
    World, WorldDef, vec2,
};

const BODIES: usize = 1_000;
/// Limit for fields: as many fields as bodies would make each tick a thousand times as long.
const FIELDS: usize = 32;
/// Commands of a tick; ticks of a command while the pit is at rest.
const COMMANDS: u64 = 8;
const SELDOM: u64 = 6;
/// A rollback takes back so many ticks, each time as many ticks have passed twice.
const BACK: u64 = 8;
/// The least number of steps in a second.
const LEAST_HZ: u32 = 20;
/// Between two looks at the memory.
const WINDOW: u64 = 16;

/// One of the three custom forces of the author's commands; the second one fails now and then.
struct Swirl(u64);

impl CustomForce for Swirl {
    fn id(&self) -> u64 {
        self.0
    }
    fn version(&self) -> u32 {
        1
    }
    fn depends_on(&self) -> Dependence {
        [Dependence::Nothing, Dependence::Position, Dependence::Velocity][self.0 as usize % 3]
    }
    fn push(&self, body: &BodyState) -> Result<ForceTorque, CustomForceError> {
        let (at, velocity) = (body.position, body.velocity);
        match self.0 {
            0 => Ok(ForceTorque { force: vec2(1, 0), ..ForceTorque::default() }),
            1 if at.x.to_bits() % 4_096 == 0 => Err(CustomForceError { code: 7 }),
            1 => Ok(ForceTorque { force: vec2(at.y, -at.x), ..ForceTorque::default() }),
            _ => Ok(ForceTorque { force: vec2(velocity.y, -velocity.x), ..ForceTorque::default() }),
        }
    }
}

fn custom_forces() -> Vec<Arc<dyn CustomForce>> {
    (0..3).map(|id| Arc::new(Swirl(id)) as Arc<dyn CustomForce>).collect()
}

/// Returns true for a time step so long that bodies of the pit fly past each other in it. Such a step takes as long as a hundred others.
/// One that is longer still is refused.
fn is_long_step(command: &Command) -> bool {
    matches!(command, Command::SetTimeStep(step) if {
        let (num, den) = step.seconds();
        num > den / LEAST_HZ && num <= den
    })
}

/// The ticks that a rollback makes again.
struct Rollback {
    world: World,
    /// The state at the start, and the commands since then, with their ticks.
    start: Snapshot,
    commands: Vec<(u64, Command)>,
}

/// Numbers of what happened.
#[derive(Debug, Default)]
struct Counts {
    refused: u64,
    faults: u64,
    fell_asleep: u64,
    woke: u64,
    began: u64,
    hits: u64,
    entered: u64,
    /// Touching manifolds after the ticks.
    touching: u64,
}

impl Counts {
    fn add(&mut self, report: &StepReport<'_>) {
        self.faults += report.faults.len() as u64;
        self.fell_asleep += report.fell_asleep.len() as u64;
        self.woke += report.woke.len() as u64;
        self.began += report.contacts_began.len() as u64;
        self.hits += report.hits.len() as u64;
        self.entered += report.sensors_entered.len() as u64;
    }
}

struct Soak {
    author: Author,
    world: World,
    twin: World,
    rollback: Rollback,
    pit: Option<Pit>,
    custom_forces: Vec<Arc<dyn CustomForce>>,
    bytes: Vec<u8>,
    counts: Counts,
}

impl Soak {
    fn new() -> Self {
        let mut world = World::new(WorldDef { sleep_after: Some(8), ..WorldDef::default() }).expect("a fair world");
        let custom_forces = custom_forces();
        for force in &custom_forces {
            world.register_custom_force(force.clone()).expect("each once");
        }
        let mut author = Author { random: SplitMix::seeded(1), unfair: 64 };
        while world.bodies().count() < BODIES {
            // Of an unfair one the next is the remedy.
            _ = world.add_body(author.body());
        }
        let rollback = Rollback { world: world.clone(), start: world.snapshot(), commands: Vec::new() };
        Self {
            author,
            twin: world.clone(),
            rollback,
            pit: Some(Pit::new(&world)),
            world,
            custom_forces,
            bytes: Vec::new(),
            counts: Counts::default(),
        }
    }

    /// A command of any kind; one that brings the world back to its size, if it is too large or too small.
    fn command(&mut self, bodies: usize, fields: usize) -> Command {
        let kind = match self.author.any(&self.world) {
            Command::AddBody(_) if bodies > BODIES + PILE => 1,
            Command::RemoveBody(_) if bodies < BODIES + PILE => 0,
            Command::AddField(_) if fields > FIELDS => 19,
            Command::RemoveField(_) if fields < FIELDS => 17,
            command => return command,
        };
        self.author.of_kind(kind, &self.world)
    }

    fn execute(&mut self, command: Command) -> Result<Created, Error> {
        let refused = self.world.check(&command).err();
        let before = refused.map(|_| self.world.state_hash());
        let (created, twin) = (self.world.execute(&command), self.twin.execute(&command));
        assert_eq!(created, twin, "{command:?}");
        assert_eq!(created.err(), refused, "{command:?}");
        assert!(before.is_none_or(|before| self.world.state_hash() == before), "{command:?}");
        self.rollback.commands.push((self.world.tick(), command));
        self.counts.refused += u64::from(created.is_err());
        created
    }

    fn tick(&mut self) {
        let tick = self.world.tick();
        if tick % (2 * BACK) == BACK {
            self.rollback.start = self.world.snapshot();
            self.rollback.commands.clear();
        }
        let phase = Phase::of(tick);
        if let Some(mut pit) = self.pit.take() {
            let outside = if Pit::is_filled(tick) { pit.outside(&self.world) } else { Vec::new() };
            pit.tick(tick, outside, |command| self.execute(command).ok());
            self.pit = Some(pit);
        }
        let count = if phase != Phase::Rest { COMMANDS } else { u64::from(tick % SELDOM == 0) };
        for _ in 0..count {
            let command = self.command(self.world.bodies().count(), self.world.fields().count());
            // While the pit is stirred, gravity is an everyday one. At rest it changes now and then, and all wake.
            if !is_long_step(&command) && (phase != Phase::Stirred || !is_global(&command)) {
                _ = self.execute(command);
            }
        }
        self.world.step();
        self.twin.step();
        self.counts.add(&self.world.last_report());
        self.counts.touching += self.world.contacts().count() as u64;
        assert_eq!(self.world.last_report(), self.twin.last_report());
        let are_equal = self.world.state_hash() == self.twin.state_hash();
        assert!(are_equal, "{:#?}", self.world.first_difference(&self.twin));
        self.renew();
        if self.world.tick() % (2 * BACK) == 0 {
            self.roll_back();
        }
    }

    /// The second twin goes back to the start, and makes the ticks since then again.
    fn roll_back(&mut self) {
        let Rollback { world, start, commands } = &mut self.rollback;
        world.restore(start);
        let mut commands = commands.iter().peekable();
        while world.tick() < self.world.tick() {
            while let Some((_, command)) = commands.next_if(|(tick, _)| *tick == world.tick()) {
                _ = world.execute(command);
            }
            world.step();
        }
        assert_eq!(world.last_report(), self.world.last_report());
        let are_equal = world.state_hash() == self.world.state_hash();
        assert!(are_equal, "after a rollback: {:#?}", self.world.first_difference(world));
    }

    /// Replaces the twin by a restored snapshot of it: in turns from memory, and from bytes as a new world.
    fn renew(&mut self) {
        let snapshot = self.twin.snapshot();
        if self.twin.tick() % 2 == 0 {
            return self.twin.restore(&snapshot);
        }
        self.bytes.clear();
        snapshot.write_to(&mut self.bytes);
        self.twin = Snapshot::from_bytes(&self.bytes, &self.custom_forces).expect("its own bytes").into_world();
    }
}

/// Runs for as long as `more` returns true for the number of ticks made, and returns a summary.
fn soak(mut more: impl FnMut(u64) -> bool) -> String {
    let mut soak = Soak::new();
    // The heap after each window, in bytes. Bodies and spare capacity make it rise and fall; a leak would make it rise for ever.
    let mut heap = Vec::new();
    while more(soak.world.tick()) {
        let window = measure(|| (0..WINDOW).for_each(|_| soak.tick()));
        heap.push(heap.last().unwrap_or(&0) + window.bytes_current);
    }
    // Of eight parts of the time. A crowd makes buffers larger once, and they stay so; a leak makes each part higher than all before.
    let parts: Vec<_> = heap.chunks(heap.len().div_ceil(8)).map(|part| *part.iter().max().expect("windows")).collect();
    let (early, late) = parts.split_at(parts.len() / 2);
    let is_highest = |&i: &usize| parts[..i].iter().all(|before| parts[i] > before + before / 100);
    let highest = (early.len()..parts.len()).filter(is_highest).count();
    assert!(2 * highest <= late.len(), "{parts:?} bytes");
    let Soak { world, counts, .. } = &soak;
    let ticks = world.tick();
    let Counts { refused, faults, fell_asleep, woke, began, hits, entered, touching } = counts;
    // An event that never happens is not tested.
    for (what, count) in
        [("refused", refused), ("faults", faults), ("hits", hits), ("entered", entered), ("woke", woke)]
    {
        assert!(count * 64 > ticks, "{what}: {count} in {ticks} ticks");
    }
    assert!(fell_asleep.min(began) > &ticks && *touching > 20 * ticks, "{counts:?} in {ticks} ticks");
    format!(
        "{ticks} ticks, {} bodies, {} fields, {counts:?}; at most {parts:?} bytes; hash {:016x}",
        world.bodies().count(),
        world.fields().count(),
        world.state_hash(),
    )
}

#[test]
fn a_twin_that_is_restored_at_every_tick_stays_equal() {
    soak(|tick| tick < if is_short() { 2 } else { 10 } * turn());
}

#[test]
#[ignore = "takes an hour"]
fn for_an_hour() {
    let start = Instant::now();
    println!("{}", soak(|_| start.elapsed() < Duration::from_secs(3_600)));
}
