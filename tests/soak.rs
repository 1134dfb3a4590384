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
use umbra_physics::{
    BodyState, Command, CustomForce, CustomForceError, Dependence, ForceTorque, Snapshot, World, WorldDef, vec2,
};

const BODIES: usize = 1_000;
/// Limit for fields: as many fields as bodies would make each tick a thousand times as long.
const FIELDS: usize = 32;
const COMMANDS: u64 = 8;
/// Between two looks at the memory.
const WINDOW: u64 = 250;

/// One of the three laws of the author's commands; it fails now and then.
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

struct Soak {
    author: Author,
    world: World,
    twin: World,
    custom_forces: Vec<Arc<dyn CustomForce>>,
    bytes: Vec<u8>,
    refused: u64,
    faults: u64,
}

impl Soak {
    fn new() -> Self {
        let mut world = World::new(WorldDef { sleep_after: Some(8), ..WorldDef::default() }).expect("a fair world");
        let custom_forces = custom_forces();
        for law in &custom_forces {
            world.register_custom_force(law.clone()).expect("each once");
        }
        let mut author = Author { random: SplitMix(1), unfair: 64 };
        while world.bodies().count() < BODIES {
            // Of an unfair one the next is the remedy.
            _ = world.add_body(author.body());
        }
        Self { author, twin: world.clone(), world, custom_forces, bytes: Vec::new(), refused: 0, faults: 0 }
    }

    /// A command of any kind; one that keeps the world at its size, if it is not.
    fn command(&mut self, bodies: usize, fields: usize) -> Command {
        let kind = match self.author.any(&self.world) {
            Command::AddBody(_) if bodies > BODIES => 1,
            Command::RemoveBody(_) if bodies < BODIES => 0,
            Command::AddField(_) if fields > FIELDS => 19,
            Command::RemoveField(_) if fields < FIELDS => 17,
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
        let are_equal = self.world.state_hash() == self.twin.state_hash();
        assert!(are_equal, "{:#?}", self.world.first_difference(&self.twin));
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
        self.twin = Snapshot::from_bytes(&self.bytes, &self.custom_forces).expect("its own bytes").into_world();
    }
}

/// Goes on while `more` says so of the ticks that were made. Says what happened.
fn soak(mut more: impl FnMut(u64) -> bool) -> String {
    let mut soak = Soak::new();
    // What is there after each window, in bytes. Of bodies and of what room is made for there is now more, now less; of what is
    // forgotten somewhere there would be more and more.
    let mut heap = Vec::new();
    while more(soak.world.tick()) {
        let window = measure(|| (0..WINDOW).for_each(|_| soak.tick()));
        heap.push(heap.last().unwrap_or(&0) + window.bytes_current);
    }
    let (early, late) = heap.split_at(heap.len() / 2);
    let (early, late) = (early.iter().max().expect("windows"), late.iter().max().expect("windows"));
    assert!(4 * late <= 5 * early, "at most {early} bytes in the first half, {late} in the second");
    assert!(soak.refused > 0 && soak.faults > 0, "no bystanders");
    let Soak { world, refused, faults, .. } = &soak;
    format!(
        "{} ticks, {} bodies, {} fields, {refused} commands refused, {faults} faults; at most {early} bytes in the first half, \
         {late} in the second; hash {:016x}",
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
    soak(|tick| tick < 6 * WINDOW);
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
