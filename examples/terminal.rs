//! Lanterns on a chain, in gusts of wind, drawn in the terminal in real time: 60 ticks a second, integers only.
//!
//! ```sh
//! cargo run --release --example terminal                  # ten seconds
//! cargo run --release --example terminal -- --frames 60   # or a number of frames
//! ```

#[path = "shared/grid.rs"]
mod grid;

use std::io::Write as _;
use std::process::ExitCode;
use std::time::{Duration, Instant};
use std::{env, io, thread};

use umbra_physics::{
    Attachment, BodyDef, BodyId, End, Error, FieldId, FieldKind, ForceField, Fx, Mass, Random, SpringConstants,
    StepClock, TimeStep, Vec2, World, WorldDef, fx, vec2,
};

use grid::Grid;

const RATE: u32 = 60;
/// Largest number of ticks per frame: time beyond it is dropped after the terminal stood still.
const MOST_TICKS: u32 = 6;

/// Characters: four to a metre from left to right, two from top to bottom.
const WIDTH: i64 = 78;
const HEIGHT: i64 = 20;

const NODES: u64 = 17;
const LANTERN: u32 = 2;

fn main() -> ExitCode {
    let frames = match env::args().skip(1).collect::<Vec<_>>().as_slice() {
        [] => Some(600),
        [option, frames] if option == "--frames" => frames.parse().ok(),
        _ => None,
    };
    let Some(frames) = frames else {
        eprintln!("terminal: the one option is --frames N");
        return ExitCode::from(2);
    };
    match play(frames) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("terminal: {error}");
            ExitCode::FAILURE
        }
    }
}

fn play(frames: u64) -> Result<(), Box<dyn std::error::Error>> {
    let (mut world, wind) = chain()?;
    let mut step_clock = StepClock::new(world.def().time_step)?;
    step_clock.set_limit(MOST_TICKS);
    let (start, mut frames_of_second, mut lost) = (Instant::now(), 0, 0);
    print!("\x1b[2J"); // an empty screen
    for _ in 0..frames {
        // In whole nanoseconds: no error accumulates, and the clock never enters the state.
        let now = start.elapsed().as_nanos() as u64;
        let due = step_clock.frame(now - frames_of_second);
        frames_of_second = now;
        lost += due.dropped;
        for _ in 0..due.ticks {
            blow(&mut world, wind)?;
            world.step();
        }
        draw(&world)?;
        if let Some(wait) = step_clock.until_tick() {
            thread::sleep(Duration::from_nanos(frames_of_second + wait).saturating_sub(start.elapsed()));
        }
    }
    println!("{frames} frames, {} ticks, {lost} lost, state hash {:016x}", world.tick(), world.state_hash());
    Ok(())
}

/// A chain between two posts, with a lantern at every fourth of its nodes; and the wind.
fn chain() -> Result<(World, FieldId), Error> {
    let gravity = vec2(0, fx!(-9.81));
    let mut world = World::new(WorldDef { time_step: TimeStep::hz(RATE), gravity, ..WorldDef::default() })?;
    world.set_random(Random::seeded(7));
    let hook = |x: i32| End::World(vec2(x, 4));
    let link = |start: BodyId, end: End, rest: Fx| {
        let spring = SpringConstants { rest, stiffness: fx!(200), damping: fx!(1) };
        FieldKind::Spring { near: Attachment::centre(start), far: end, spring }
    };
    let mut last = hook(-8);
    for i in 1..=NODES {
        let node =
            BodyDef { position: vec2(i as i32 - 9, 4), mass: Mass::Kilograms(fx!(0.2)), key: i, ..BodyDef::dynamic() };
        let node = world.add_body(node)?;
        world.add_field(link(node, last, fx!(0.9)))?;
        last = End::Body(Attachment::centre(node));
        if i == NODES {
            world.add_field(link(node, hook(8), fx!(0.9)))?;
        }
        if i % 4 == 1 {
            let lantern = BodyDef {
                position: vec2(i as i32 - 9, 2),
                mass: Mass::Kilograms(fx!(0.5)),
                force_groups: LANTERN,
                key: 100 + i,
                ..BodyDef::dynamic()
            };
            let lantern = world.add_body(lantern)?;
            world.add_field(link(lantern, last, fx!(2)))?;
        }
    }
    let wind = world.add_field(ForceField { kind: air(Vec2::ZERO), force_groups: 1 | LANTERN })?;
    Ok((world, wind))
}

fn air(wind: Vec2) -> FieldKind {
    FieldKind::Drag { linear: fx!(0.15), quadratic: fx!(0), wind }
}

/// Changes the wind every second. Its numbers come from the world, so that a copy of the world has the same weather.
fn blow(world: &mut World, wind: FieldId) -> Result<(), Error> {
    if world.tick() % u64::from(RATE) == 0 {
        let speed = world.random_mut().number(fx!(-12)..=fx!(12));
        world.set_field(wind, ForceField { kind: air(vec2(speed, 0)), force_groups: 1 | LANTERN })?;
    }
    Ok(())
}

/// The whole picture in one write, over the last one.
fn draw(world: &World) -> io::Result<()> {
    let mut grid = Grid::new(WIDTH, HEIGHT);
    for body in world.bodies() {
        // A position has 32 bits below a metre: 30 below a quarter, 31 below a half. A shift rounds down.
        let at = body.position();
        let sign = if body.force_groups() == LANTERN { '@' } else { '.' };
        grid.put(at.x.to_bits() >> 30, at.y.to_bits() >> 31, sign);
    }
    let mut picture = String::from("\x1b[H"); // to the upper left corner
    for row in grid.rows() {
        picture.push_str(&row);
        picture.push_str("\x1b[K\n"); // and nothing to the right of it
    }
    let mut out = io::stdout().lock();
    out.write_all(picture.as_bytes())?;
    out.flush()
}
