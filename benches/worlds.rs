//! Worlds as a server has them: what a match costs a core and how much of the heap it takes, and how the cost of one world grows up to 10^6
//! bodies with colliders, a tenth of them awake.
//!
//! Two tables in Markdown. `cargo bench --bench worlds matches` or `scale` prints one of them. Times are of the wall clock: run it on an idle
//! machine.

use std::time::{Duration, Instant};

use allocation_counter::measure;
use umbra_physics::{BodyDef, BodyId, ColliderDef, Fx, Material, Random, Shape, Vec2, World, WorldDef, fx, vec2};

/// Matches that take turns, so that each comes back to a cold cache.
const MATCHES: usize = 64;
/// Ticks of a match before it is measured, and ticks that are measured: ten seconds.
const BEFORE: u64 = 120;
const TICKS: u64 = 600;
/// The part of a core's time that matches may take: the rest is for a slow tick and for all else.
const LOAD: f64 = 0.7;

fn main() {
    let wanted: Vec<_> = std::env::args().skip(1).filter(|argument| !argument.starts_with("--")).collect();
    let is_wanted = |name: &str| wanted.is_empty() || wanted.iter().any(|part| part == name);
    if is_wanted("matches") {
        matches();
    }
    if is_wanted("scale") {
        scale();
    }
}

fn shape(shape: Result<Shape, umbra_physics::Error>) -> Shape {
    shape.expect("a fair shape")
}

fn add(world: &mut World, def: BodyDef) -> BodyId {
    world.add_body(def).expect("a fair body")
}

fn fixed(world: &mut World, width: Fx, height: Fx, x: Fx, y: Fx) {
    let collider = ColliderDef::new(shape(Shape::rectangle(width, height)));
    _ = add(world, BodyDef { position: Vec2::new(x, y), ..BodyDef::fixed().with_collider(collider) });
}

/// A match: a world, and the bodies that players push about.
struct Match {
    world: World,
    players: Vec<BodyId>,
    random: Random,
    /// The largest speed that a push gives, m/s.
    speed: i64,
}

impl Match {
    /// A floor of 22 m with walls, or a court seen from above, and bodies in rows.
    fn new(seed: u64, has_gravity: bool, bodies: &[(Shape, Fx)], columns: usize, players: usize, speed: i64) -> Self {
        let gravity = if has_gravity { vec2(0, -10) } else { Vec2::ZERO };
        let mut world = World::new(WorldDef { gravity, ..WorldDef::default() }).expect("a fair world");
        fixed(&mut world, fx!(24), fx!(1), fx!(0), fx!(-0.5));
        fixed(&mut world, fx!(24), fx!(1), fx!(0), fx!(22.5));
        fixed(&mut world, fx!(1), fx!(22), fx!(-11.5), fx!(11));
        fixed(&mut world, fx!(1), fx!(22), fx!(11.5), fx!(11));
        let mut ids = Vec::new();
        for (index, (shape, restitution)) in bodies.iter().enumerate() {
            let (row, column) = ((index / columns) as i32, (index % columns) as i32);
            let x = (Fx::from(column) - Fx::from(columns as i32 - 1) / 2) * fx!(1.05);
            let material = Material { restitution: *restitution, ..Material::default() };
            let collider = ColliderDef { material, ..ColliderDef::new(shape.clone()) };
            let position = Vec2::new(x, fx!(0.5) + Fx::from(row));
            ids.push(add(&mut world, BodyDef { position, ..BodyDef::dynamic().with_collider(collider) }));
        }
        ids.truncate(players);
        Self { world, players: ids, random: Random::seeded(seed), speed }
    }

    /// A tick of the server: the players' inputs, the step, and a hash once a second.
    fn tick(&mut self) {
        if self.world.tick() % 20 == 0 {
            for &player in &self.players {
                let mut part = || Fx::from_bits((self.random.bits() as i64 >> 31) * self.speed);
                let velocity = Vec2::new(part(), part());
                self.world.set_velocity(player, velocity).expect("a player's body");
            }
        }
        _ = self.world.step();
        if self.world.tick() % 60 == 0 {
            std::hint::black_box(self.world.state_hash());
        }
    }
}

fn matches() {
    let disc = |radius: Fx| shape(Shape::circle(radius));
    let crate_shape = shape(Shape::rectangle(fx!(1), fx!(1)));
    let duel = vec![(disc(fx!(0.5)), fx!(0.9)); 3];
    let arena = vec![(disc(fx!(0.4)), fx!(0.8)); 100];
    let room = vec![(crate_shape.clone(), fx!(0)); 30];
    let pile = vec![(crate_shape, fx!(0)); 200];
    println!(
        "| match | bodies | a tick, µs | 99 % of ticks below, µs | matches a core at 60 Hz | heap, kB | snapshot, kB |"
    );
    println!("|---|---|---|---|---|---|---|");
    for (name, has_gravity, bodies, columns, players, speed) in [
        ("two players and a ball, seen from above", false, &duel, 3, 2, 10),
        ("an arena of 100 discs, 8 of them players", false, &arena, 10, 8, 10),
        ("a room of 30 crates, 2 of them players", true, &room, 6, 2, 6),
        ("a pile of 200 crates, 4 of them players", true, &pile, 20, 4, 6),
    ] {
        let mut worlds = Vec::with_capacity(MATCHES);
        let heap = measure(|| {
            for seed in 0..MATCHES as u64 {
                let mut game = Match::new(seed, has_gravity, bodies, columns, players, speed);
                (0..BEFORE).for_each(|_| game.tick());
                worlds.push(game);
            }
        });
        let mut times = Vec::with_capacity(MATCHES * TICKS as usize);
        for _ in 0..TICKS {
            for game in &mut worlds {
                let start = Instant::now();
                game.tick();
                times.push(start.elapsed());
            }
        }
        times.sort_unstable();
        let mean = micros(times.iter().sum()) / times.len() as f64;
        let slow = micros(times[times.len() * 99 / 100]);
        let count = (LOAD * 1e6 / 60.0 / mean) as u64;
        let snapshot = worlds[0].world.snapshot().to_bytes().len() as f64 / 1e3;
        let heap = heap.bytes_current as f64 / MATCHES as f64 / 1e3;
        println!("| {name} | {} | {mean:.1} | {slow:.1} | {count} | {heap:.0} | {snapshot:.1} |", bodies.len());
    }
    println!();
}

fn micros(time: Duration) -> f64 {
    time.as_secs_f64() * 1e6
}

/// The time since a start, ms.
fn millis(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}

/// Columns of ten crates on a row of static plates, most of them asleep from the beginning.
fn level(count: usize) -> World {
    const HEIGHT: usize = 10;
    let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() }).expect("a fair world");
    let square = ColliderDef::new(shape(Shape::rectangle(fx!(1), fx!(1))));
    let plate = ColliderDef::new(shape(Shape::rectangle(fx!(15), fx!(1))));
    for column in 0..count / HEIGHT {
        let x = Fx::from(column as i32) * fx!(1.5);
        if column % 10 == 0 {
            let position = Vec2::new(x + fx!(6.75), fx!(-0.5));
            _ = add(&mut world, BodyDef { position, ..BodyDef::fixed().with_collider(plate.clone()) });
        }
        for row in 0..HEIGHT {
            let position = Vec2::new(x, fx!(0.5) + Fx::from(row as i32));
            let body = add(&mut world, BodyDef { position, ..BodyDef::dynamic().with_collider(square.clone()) });
            if column % 10 != 0 {
                world.sleep(body).expect("a body that may sleep");
            }
        }
    }
    world
}

fn scale() {
    println!(
        "| bodies with colliders | awake | built in, s | heap a body, bytes | first step, ms | a step, ms | ns a body awake | \
         a hash, ms | a copy, ms | a snapshot, ms | its size, MB |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
    for count in [10_000, 100_000, 1_000_000] {
        let start = Instant::now();
        let (mut built, mut first) = (Duration::ZERO, Duration::ZERO);
        let mut world = None;
        let heap = measure(|| {
            let mut level = level(count);
            built = start.elapsed();
            let start = Instant::now();
            _ = level.step();
            first = start.elapsed();
            _ = level.step();
            world = Some(level);
        });
        let Some(mut world) = world else { continue };
        let awake = world.moving_count();
        // Before anything falls asleep.
        let start = Instant::now();
        (0..20).for_each(|_| _ = world.step());
        let step = millis(start) / 20.0;
        let start = Instant::now();
        std::hint::black_box(world.state_hash());
        let hash = millis(start);
        let mut copy = world.clone();
        let start = Instant::now();
        copy.clone_from(&world);
        let clone = millis(start);
        let start = Instant::now();
        let size = world.snapshot().to_bytes().len();
        let snapshot = millis(start);
        println!(
            "| {count} | {awake} | {:.2} | {} | {:.1} | {step:.2} | {:.0} | {hash:.1} | {clone:.1} | {snapshot:.0} | {:.1} |",
            built.as_secs_f64(),
            heap.bytes_current / count as i64,
            first.as_secs_f64() * 1e3,
            step * 1e6 / awake as f64,
            size as f64 / 1e6,
        );
    }
}
