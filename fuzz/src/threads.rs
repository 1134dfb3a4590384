//! Two threads do what one does.
//!
//! An input is a byte for the number of bodies, a world's definition, a pile, a seed, a kind of body, and commands. Free bodies are added,
//! which threads share: enough for two threads in a world that shares few, and in one of 256 inputs as many as threads share in any world.

use std::sync::LazyLock;

use arbitrary::Result;
use rayon::{ThreadPool, ThreadPoolBuilder};
use umbra_physics::{BodyDef, CommandSource as _, Created, Fx, Integrator, Random, Vec2, WorldDef, fx, step_all, vec2};

use super::author::{self, Author};
use super::pile::pile;
use super::{number, tally};

/// The target.
pub fn run(data: &[u8]) {
    static POOL: LazyLock<ThreadPool> =
        LazyLock::new(|| ThreadPoolBuilder::new().num_threads(2).build().expect("threads"));
    // Counted here: a tally is of its thread.
    let counts = tally::is_asked_for();
    let contacts = POOL.install(|| play(data, counts)).unwrap_or_default();
    contacts.into_iter().for_each(|count| tally::count_contacts(|| count));
}

/// The number of bodies that are refused, fall asleep or are reached by fields, as the input says. After each come
/// [`STEADY`] that move for ever and that no field reaches, 256 or more: threads share two blocks of 128 free bodies, and no fewer. In one
/// input of 16 it is twice as many.
const CROWD: [u64; 2] = [64, 128];
const STEADY: u64 = 4;
/// The bodies of these kinds in a large world, in which a step uses several threads by itself: 8,200 with the others.
const LARGE: u64 = 2_050;
/// The most ticks for which a pile falls together first, of most inputs and of one in 16; the ticks that are made twice, with a command
/// before each: fewer in a large world too.
const FALL: [u8; 2] = [4, 12];
const TICKS: [usize; 2] = [4, 8];
/// States are compared after each so many ticks, and reports after each: a difference stays in the state.
const EVERY: usize = 4;

/// Returns the number of touching manifolds after each tick, if these are to be counted.
fn play(data: &[u8], counts: bool) -> Result<Vec<usize>> {
    let mut author = Author::new(data);
    let crowd: u8 = author.any()?;
    let (is_many, is_large) = (crowd >= 240, crowd == 255);
    let def = author.world();
    let integrator = match def.integrator {
        // It has no free bodies.
        Integrator::PublishedVerlet => Integrator::VelocityVerlet,
        integrator => integrator,
    };
    let Some(mut world) = author::world(WorldDef { integrator, ..def }) else { return Ok(Vec::new()) };
    pile(&mut author, &mut world)?;
    let mut contacts = Vec::new();
    for _ in 0..number(author.any()?, FALL[0], FALL[1]) {
        world.step();
        contacts.extend(counts.then(|| world.contacts().count()));
    }
    let mut random = Random::seeded(author.any()?);
    // A few kinds of bodies, one of them as the input says; the others differ in where they are and how they move.
    let special = author.generator().body_def();
    let every = u64::from(author.any::<u8>()?) + 1;
    let count = match crowd {
        255 => LARGE,
        _ => CROWD[usize::from(is_many)] + u64::from(crowd % 16),
    };
    for i in 0..count {
        let mut number = |size: Fx| random.number(-size..=size);
        let (position, velocity) =
            (Vec2::new(number(fx!(99)), number(fx!(99))), Vec2::new(number(fx!(3)), number(fx!(3))));
        let def = BodyDef { position, velocity, angular_velocity: number(fx!(1)), ..BodyDef::dynamic() };
        let added = if i % every == 0 { world.add_body(special.clone()) } else { world.add_body(def) };
        if let Ok(body) = added {
            author.made(&world, Created::Body(body));
        }
        for _ in 0..STEADY {
            let def = BodyDef { position, velocity: vec2(1, 0), force_groups: 0, ..BodyDef::kinematic() };
            world.add_body(def).expect("a fair body");
        }
    }
    // The first goes its way on one thread, the second on both; both at once.
    let mut worlds = [world.clone(), world];
    worlds[0].share_work(usize::MAX);
    if !is_large {
        worlds[1].share_work(0);
    }
    for tick in 0..TICKS[usize::from(is_many && !is_large)] {
        if !author.input.is_empty() {
            let command = author.command();
            let [done, second] = worlds.each_mut().map(|world| world.execute(&command));
            assert_eq!(done, second);
            done.into_iter().for_each(|created| author.made(&worlds[0], created));
        }
        step_all(&mut worlds);
        let [first, second] = &worlds;
        contacts.extend(counts.then(|| first.contacts().count()));
        assert_eq!(first.last_report(), second.last_report());
        assert!(tick % EVERY != EVERY - 1 || first.state_hash() == second.state_hash(), "on two threads");
    }
    Ok(contacts)
}
