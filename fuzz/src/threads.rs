//! Two threads do what one does.
//!
//! An input is a world's definition, a pile, a seed, a kind of body, and commands. Enough free bodies are added for a step to use
//! several threads: threads share free bodies alone.

use std::sync::LazyLock;

use arbitrary::Result;
use rayon::{ThreadPool, ThreadPoolBuilder};
use umbra_physics::{BodyDef, CommandSource as _, Created, Fx, Integrator, Random, Vec2, WorldDef, fx, step_all, vec2};

use super::author::{self, Author};
use super::pile::pile;
use super::tally;

/// The target.
pub fn run(data: &[u8]) {
    _ = play(data);
}

static POOLS: LazyLock<[ThreadPool; 2]> =
    LazyLock::new(|| [1, 2].map(|count| ThreadPoolBuilder::new().num_threads(count).build().expect("threads")));

/// The number of bodies that are refused, fall asleep or are reached by fields, as the input says. After each come
/// [`STEADY`] that move for ever and that no field reaches: 8,200 in all, enough for a step to use several threads.
const CROWD: u64 = 2_050;
const STEADY: u64 = 4;
/// The ticks of an input, and the most commands, one a tick.
const TICKS: usize = 20;
const COMMANDS: usize = 8;

fn play(data: &[u8]) -> Result<()> {
    let mut author = Author::new(data);
    let def = author.world();
    let integrator = match def.integrator {
        // It has no free bodies.
        Integrator::PublishedVerlet => Integrator::VelocityVerlet,
        other => other,
    };
    let Some(mut world) = author::world(WorldDef { integrator, ..def }) else { return Ok(()) };
    pile(&mut author, &mut world)?;
    let mut random = Random::seeded(author.any()?);
    // A few kinds of bodies, one of them as the input says; the others differ in where they are and how they move.
    let special = author.generator().body_def();
    let every = u64::from(author.any::<u8>()?) + 1;
    for i in 0..CROWD + u64::from(author.any::<u8>()?) {
        let mut number = |size: Fx| random.number(-size..=size);
        let (position, velocity) =
            (Vec2::new(number(fx!(99)), number(fx!(99))), Vec2::new(number(fx!(3)), number(fx!(3))));
        let def = BodyDef { position, velocity, angular_velocity: number(fx!(1)), ..BodyDef::dynamic() };
        let made = if i % every == 0 { world.add_body(special.clone()) } else { world.add_body(def) };
        if let Ok(body) = made {
            author.made(&world, Created::Body(body));
        }
        for _ in 0..STEADY {
            let def = BodyDef { position, velocity: vec2(1, 0), force_groups: 0, ..BodyDef::kinematic() };
            world.add_body(def).expect("a fair body");
        }
    }
    let mut others = [world.clone(), world.clone()];
    for tick in 0..TICKS {
        if tick < COMMANDS && !author.input.is_empty() {
            let command = author.command();
            let done = POOLS[0].install(|| world.execute(&command));
            for other in &mut others {
                assert_eq!(POOLS[1].install(|| other.execute(&command)), done);
            }
            done.into_iter().for_each(|made| author.made(&world, made));
        }
        POOLS[0].install(|| _ = world.step());
        tally::count(&world);
        POOLS[1].install(|| step_all(&mut others));
        for other in &others {
            assert_eq!(other.state_hash(), world.state_hash(), "on two threads");
            assert_eq!(other.last_report(), world.last_report());
        }
    }
    Ok(())
}
