//! A world of 1,000 bodies under random commands, beside a twin that goes through a snapshot at every tick.
//!
//! Equal at every tick, and neither takes more memory as time goes by. For a minute and for an hour:
//! `cargo test --release --all-features --test soak -- --ignored --nocapture minute` (or `hour`).

#[path = "support/commands.rs"]
mod commands;
#[path = "support/random.rs"]
mod random;

use std::sync::Arc;
use std::time::{Duration, Instant};

use allocation_counter::measure;
use commands::Author;
use random::SplitMix;
use umbra_physics::{BodyState, Command, Dependence, ForceLaw, LawFault, Push, Snapshot, World, WorldDef, vec2};

const BODIES: usize = 1_000;
/// As many fields as bodies would make each tick a thousand times as long.
const FIELDS: usize = 32;
const COMMANDS: u64 = 8;
/// Between two looks at the memory.
const WINDOW: u64 = 250;

/// One of the three laws of the author's commands; it fails now and then.
struct Swirl(u64);

impl ForceLaw for Swirl {
    fn id(&self) -> u64 {
        self.0
    }
    fn version(&self) -> u32 {
        1
    }
    fn depends_on(&self) -> Dependence {
        [Dependence::Nothing, Dependence::Position, Dependence::Velocity][self.0 as usize % 3]
    }
    fn push(&self, body: &BodyState) -> Result<Push, LawFault> {
        let (at, velocity) = (body.position, body.velocity);
        match self.0 {
            0 => Ok(Push { force: vec2(1, 0), ..Push::default() }),
            1 if at.x.to_bits() % 4_096 == 0 => Err(LawFault { code: 7 }),
            1 => Ok(Push { force: vec2(at.y, -at.x), ..Push::default() }),
            _ => Ok(Push { force: vec2(velocity.y, -velocity.x), ..Push::default() }),
        }
    }
}

fn laws() -> Vec<Arc<dyn ForceLaw>> {
    (0..3).map(|id| Arc::new(Swirl(id)) as Arc<dyn ForceLaw>).collect()
}

struct Soak {
    author: Author,
    world: World,
    twin: World,
    laws: Vec<Arc<dyn ForceLaw>>,
    bytes: Vec<u8>,
    refused: u64,
    faults: u64,
}

impl Soak {
    fn new() -> Self {
        let mut world = World::new(WorldDef { sleep_after: Some(8), ..WorldDef::default() }).expect("a fair world");
        let laws = laws();
        for law in &laws {
            world.register_law(law.clone()).expect("each once");
        }
        let mut author = Author { random: SplitMix(1), unfair: 64 };
        while world.bodies().count() < BODIES {
            // Of an unfair one the next is the remedy.
            _ = world.add_body(author.body());
        }
        Self { author, twin: world.clone(), world, laws, bytes: Vec::new(), refused: 0, faults: 0 }
    }

    /// A command of any kind; one that keeps the world at its size, if it is not.
    fn command(&mut self, bodies: usize, fields: usize) -> Command {
        let kind = match self.author.any(&self.world) {
            Command::AddBody(_) if bodies > BODIES => 1,
            Command::RemoveBody(_) if bodies < BODIES => 0,
            Command::AddField(_) if fields > FIELDS => 19,
            command => return command,
        };
        self.author.of_kind(kind, &self.world)
    }

    fn tick(&mut self) {
        for _ in 0..COMMANDS {
            let command = self.command(self.world.bodies().count(), self.world.fields().count());
            let (made, twin) = (self.world.execute(&command), self.twin.execute(&command));
            assert_eq!(made, twin, "{command:?}");
            self.refused += u64::from(made.is_err());
        }
        self.faults += self.world.step().faults.len() as u64;
        self.twin.step();
        assert_eq!(self.world.last_report(), self.twin.last_report());
        assert_eq!(self.world.state_hash(), self.twin.state_hash(), "tick {}", self.world.tick());
        self.renew();
    }

    /// The twin becomes what its snapshot says: by turns from memory and from bytes, in a world that knew nothing of it.
    fn renew(&mut self) {
        let snapshot = self.twin.snapshot();
        if self.twin.tick() % 2 == 0 {
            return self.twin.restore(&snapshot);
        }
        self.bytes.clear();
        snapshot.write_to(&mut self.bytes);
        self.twin = Snapshot::from_bytes(&self.bytes, &self.laws).expect("its own bytes").into_world();
    }
}

/// Goes on while `more` says so of the ticks that were made. Says what happened.
fn soak(mut more: impl FnMut(u64) -> bool) -> String {
    let mut soak = Soak::new();
    // What is there when room was made for all kinds of things.
    let (mut settled, mut kept, mut most) = (None, 0, 0);
    while more(soak.world.tick()) {
        let window = measure(|| (0..WINDOW).for_each(|_| soak.tick()));
        kept += window.bytes_current;
        most = most.max(kept);
        if soak.world.tick() == 4 * WINDOW {
            settled = Some(kept);
        }
    }
    // By how many bodies there are, and by what they have room for, it goes up and down.
    let settled = settled.expect("enough ticks to settle");
    assert!(most <= 2 * settled, "{settled} bytes when it was settled, {most} later");
    assert!(soak.refused > 0 && soak.faults > 0, "no strangers");
    let Soak { world, refused, faults, .. } = &soak;
    format!(
        "{} ticks, {} bodies, {} fields, {refused} commands refused, {faults} faults; {settled} bytes, at most {most} later; \
         hash {:016x}",
        world.tick(),
        world.bodies().count(),
        world.fields().count(),
        world.state_hash(),
    )
}

fn soak_for(time: Duration) {
    let start = Instant::now();
    println!("{}", soak(|_| start.elapsed() < time));
}

#[test]
fn a_twin_that_is_restored_at_every_tick_stays_equal() {
    soak(|tick| tick < 4 * WINDOW);
}

#[test]
#[ignore = "takes a minute"]
fn for_a_minute() {
    soak_for(Duration::from_secs(60));
}

#[test]
#[ignore = "takes an hour"]
fn for_an_hour() {
    soak_for(Duration::from_secs(3_600));
}
