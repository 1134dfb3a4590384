//! A step has several ways to the same bits: with wide vectors and without, on one core and on many, block by block and
//! stage by stage, skipping what a scene lacks and not. Which one a body goes depends on its neighbours and on the machine, and
//! must not show.

use umbra_physics::scalar::internals::VectorSet;
use umbra_physics::{
    Attachment, BodyDef, BodyId, Damping, End, FieldKind, Fx, Integrator, Mass, Region, SpringConstants, TimeStep,
    Vec2, World, WorldDef, fx, step_all, vec2,
};

#[path = "support/inputs.rs"]
#[allow(dead_code, reason = "this file uses a part of the inputs")]
mod inputs;

const TICKS: u32 = 240;

/// A few blocks of bodies of one kind, and the last block not full.
const COUNT: usize = 300;

fn def(integrator: Integrator) -> WorldDef {
    WorldDef {
        time_step: TimeStep::hz(60),
        gravity: vec2(fx!(0.5), fx!(-9.81)),
        integrator,
        linear_damping: Damping::kept_per_second(fx!(0.75)),
        angular_damping: Damping::kept_per_second(fx!(0.5)),
        sleep_after: None,
        ..WorldDef::default()
    }
}

fn number(random: &mut inputs::Random, bits: u32) -> Fx {
    Fx::from_bits(random.next() >> (64 - bits))
}

/// Bodies that fly and spin, one in three not spinning.
fn bodies() -> impl Iterator<Item = BodyDef> {
    let mut random = inputs::Random::seeded(7);
    (0..COUNT).map(move |i| BodyDef {
        position: Vec2::new(number(&mut random, 45), number(&mut random, 45)),
        velocity: Vec2::new(number(&mut random, 38), number(&mut random, 38)),
        angular_velocity: if i % 3 == 0 { fx!(0) } else { number(&mut random, 36) },
        angle: number(&mut random, 34),
        mass: Mass::Explicit { mass: fx!(2), inertia: fx!(0.5) },
        ..BodyDef::dynamic()
    })
}

/// The world, and the bodies that are compared, with what `beside` adds after each of them.
fn world(def: WorldDef, mut beside: impl FnMut(&mut World, usize)) -> (World, Vec<BodyId>) {
    let mut world = World::new(def).expect("a fair definition");
    let mut ids = Vec::new();
    for (i, body) in bodies().enumerate() {
        ids.push(world.add_body(body).expect("a fair body"));
        beside(&mut world, i);
    }
    (world, ids)
}

/// All the bits of these bodies that a step changes.
fn bits(world: &World, ids: &[BodyId]) -> Vec<impl PartialEq + std::fmt::Debug> {
    let bits_of = |&id: &BodyId| {
        let body = world.body(id).expect("it is there");
        (body.position_exact(), body.velocity_exact(), body.angle_exact(), body.angular_velocity_exact())
    };
    ids.iter().map(bits_of).collect()
}

/// Runs a world beside the plain one, and compares the bodies they have in common.
fn same(case: &str, beside: impl Fn(&mut World, usize), each_tick: impl Fn(&mut World, &[BodyId])) {
    for integrator in Integrator::ALL {
        let (mut plain, ids) = world(def(integrator), |_, _| {});
        let (mut second, others) = world(def(integrator), &beside);
        for tick in 0..TICKS {
            each_tick(&mut second, &others);
            plain.step();
            second.step();
            assert!(bits(&plain, &ids) == bits(&second, &others), "{case}, {integrator:?}: tick {tick}");
        }
    }
}

#[test]
fn wide_vectors_change_nothing() {
    for integrator in Integrator::ALL {
        let (mut wide, ids) = world(def(integrator), |_, _| {});
        let (mut plain, _) = world(def(integrator), |_, _| {});
        for tick in 0..TICKS {
            VectorSet::allow(VectorSet::Avx512);
            wide.step();
            VectorSet::allow(VectorSet::Portable);
            assert_eq!(VectorSet::used(), VectorSet::Portable);
            plain.step();
            assert!(bits(&wide, &ids) == bits(&plain, &ids), "{integrator:?}: tick {tick}");
            assert_eq!(wide.state_hash(), plain.state_hash());
        }
    }
    VectorSet::allow(VectorSet::Avx512);
}

#[test]
fn a_field_that_acts_on_all_and_pushes_nobody_changes_nothing() {
    let zone = |world: &mut World, i: usize| {
        if i == 0 {
            let region = Region::Disc { centre: vec2(1 << 26, 0), radius: fx!(1) };
            world.add_field(FieldKind::Zone { region, acceleration: vec2(1, 1) }).expect("a fair field");
        }
    };
    same("all stage by stage", zone, |_, _| {});
}

#[test]
fn a_spring_in_the_same_block_changes_nothing() {
    let spring = |world: &mut World, i: usize| {
        if i % 100 == 50 {
            let body = world.add_body(BodyDef::dynamic()).expect("a fair body");
            let far = End::World(vec2(1, 2));
            let spring = SpringConstants { rest: fx!(1), stiffness: fx!(10), damping: fx!(0.25) };
            world.add_field(FieldKind::Spring { near: Attachment::centre(body), far, spring }).expect("a fair field");
        }
    };
    same("some blocks stage by stage", spring, |_, _| {});
}

#[test]
fn a_neighbour_at_the_edge_of_the_envelope_changes_nothing() {
    let fast = |world: &mut World, i: usize| {
        if i % 100 == 50 {
            let velocity = vec2(1_048_575, -1_048_575);
            world.add_body(BodyDef { velocity, ..BodyDef::dynamic() }).expect("a fair body");
        }
    };
    same("guarded", fast, |_, _| {});
}

/// From −2^log2 to 2^log2: near either end, near zero, near half of it.
fn up_to(random: &mut inputs::Random, log2: u32) -> Fx {
    let limit = 1i64 << (32 + log2);
    let off = random.next() >> (1 + (random.next() & 62));
    let bits = match random.next() & 3 {
        0 => limit - off.abs(),
        1 => off.abs() - limit,
        2 => off,
        _ => limit / 2 + off,
    };
    Fx::from_bits(bits.clamp(-limit, limit))
}

/// The way a block goes is chosen by how far its bodies are from the envelope: here they are next to it, and next to half
/// of it, and some leave it.
#[test]
fn next_to_the_envelope_and_to_half_of_it_every_way_is_the_same() {
    let mut random = inputs::Random::seeded(23);
    let mut faults = 0;
    let time_steps = [TimeStep::hz(1), TimeStep::hz(2), TimeStep::hz(60), TimeStep::hz(10_000)];
    let dampings = [fx!(0), fx!(0.001), fx!(0.75), fx!(1)].map(Damping::kept_per_second);
    for case in 0..400 {
        let [a, b, c] = [0, 1, 2].map(|_| random.next().unsigned_abs() as usize);
        let definition = WorldDef {
            time_step: time_steps[a % 4],
            gravity: Vec2::new(up_to(&mut random, 16), up_to(&mut random, (c % 17) as u32)),
            linear_damping: dampings[b % 4],
            angular_damping: dampings[c % 4],
            ..def(Integrator::ALL[case % 5])
        };
        // Yoshida4 refuses a damping of zero.
        let Ok(mut plain) = World::new(definition) else { continue };
        for i in 0..150 {
            let far = [20, 29, 30][(a >> 8) % 3];
            let fast = [10, 19, 20][(b >> 8) % 3];
            let body = BodyDef {
                position: Vec2::new(up_to(&mut random, far), up_to(&mut random, far)),
                velocity: Vec2::new(up_to(&mut random, fast), up_to(&mut random, fast)),
                angular_velocity: if i < 128 { fx!(0) } else { up_to(&mut random, fast) },
                ..BodyDef::dynamic()
            };
            plain.add_body(body).expect("a fair body");
        }
        // A field that may act on all bodies takes them stage by stage, and pushes none.
        let mut staged = plain.clone();
        let region = Region::Disc { centre: vec2(0, 0), radius: fx!(1000) };
        staged.add_field(FieldKind::Zone { region, acceleration: Vec2::ZERO }).expect("a fair field");
        let ids: Vec<BodyId> = plain.bodies().map(|body| body.id()).collect();
        for tick in 0..10 {
            plain.step();
            staged.step();
            assert!(bits(&plain, &ids) == bits(&staged, &ids), "{definition:?}, tick {tick}");
            assert_eq!(plain.last_report().faults, staged.last_report().faults, "{definition:?}, tick {tick}");
            faults += plain.last_report().faults.len();
        }
    }
    assert!(faults > 1_000, "only {faults} bodies left the envelope");
}

#[test]
fn neighbours_with_other_damping_and_gravity_change_nothing() {
    let add_neighbour = |world: &mut World, i: usize| {
        let body = match i % 4 {
            0 => BodyDef {
                linear_damping: Some(Damping::NONE),
                angular_damping: Some(Damping::NONE),
                ..BodyDef::dynamic()
            },
            1 => BodyDef {
                gravity_scale: fx!(-2),
                linear_damping: Some(Damping::kept_per_second(fx!(0.001))),
                ..BodyDef::dynamic()
            },
            2 => BodyDef { velocity: vec2(1, 1), angular_velocity: fx!(3), ..BodyDef::kinematic() },
            _ => BodyDef::fixed(),
        };
        world.add_body(body).expect("a fair body");
    };
    same("each its own factors", add_neighbour, |_, _| {});
}

#[test]
fn forces_of_zero_change_nothing() {
    let push = |world: &mut World, ids: &[BodyId]| {
        for id in ids.iter().step_by(7) {
            world.apply_force(*id, vec2(0, 0)).expect("a fair force");
            world.apply_torque(*id, fx!(0)).expect("a fair torque");
        }
    };
    same("pushed", |_, _| {}, push);
}

#[test]
fn forces_on_neighbours_change_nothing() {
    let neighbour = |world: &mut World, _| {
        world.add_body(BodyDef { key: 1, ..BodyDef::dynamic() }).expect("a fair body");
    };
    let push = |world: &mut World, _: &[BodyId]| {
        let pushed: Vec<BodyId> = world.bodies().filter(|body| body.key() == 1).map(|body| body.id()).collect();
        for id in pushed.into_iter().step_by(5) {
            world.apply_force(id, vec2(3, -4)).expect("a fair force");
            world.apply_torque(id, fx!(0.5)).expect("a fair torque");
        }
    };
    same("beside pushed ones", neighbour, push);
}

#[test]
fn asking_for_rotations_changes_nothing() {
    let ask = |world: &mut World, _: &[BodyId]| {
        world.bodies().for_each(|body| assert!(body.rotation() != umbra_physics::Rot { cos: fx!(0), sin: fx!(0) }));
    };
    same("asked for rotations", |_, _| {}, ask);
}

#[test]
fn sleep_changes_no_motion() {
    for integrator in Integrator::ALL {
        let still = WorldDef {
            gravity: vec2(0, 0),
            linear_damping: Damping::kept_per_second(fx!(0.0001)),
            angular_damping: Damping::kept_per_second(fx!(0.0001)),
            ..def(integrator)
        };
        let (mut awake, ids) = world(still, |_, _| {});
        let (mut sleepy, _) = world(WorldDef { sleep_after: Some(3), ..still }, |_, _| {});
        for tick in 0..4 * TICKS {
            awake.step();
            sleepy.step();
            assert!(bits(&awake, &ids) == bits(&sleepy, &ids), "{integrator:?}: tick {tick}");
        }
        assert!(sleepy.moving_count() < COUNT, "{integrator:?}: nobody slept");
    }
}

#[test]
fn worlds_side_by_side_are_worlds_one_by_one() {
    let make = || Integrator::ALL.map(|integrator| world(def(integrator), |_, _| {}).0);
    let (mut together, mut alone) = (make(), make());
    for _ in 0..20 {
        step_all(&mut together);
        alone.iter_mut().for_each(|world| _ = world.step());
    }
    assert_eq!(together.map(|world| world.state_hash()), alone.map(|world| world.state_hash()));
}

#[cfg(feature = "parallel")]
#[test]
fn the_number_of_threads_changes_nothing() {
    let mut random = inputs::Random::seeded(11);
    let mut start = World::new(WorldDef { sleep_after: Some(30), ..def(Integrator::VelocityVerlet) }).expect("fair");
    for i in 0..30_000 {
        let body = BodyDef {
            position: Vec2::new(number(&mut random, 45), number(&mut random, 45)),
            // Some leave the envelope on the way, some are at rest from the start.
            velocity: match i % 1_000 {
                0 => vec2(1_048_500, -1_048_570),
                1 => vec2(0, 0),
                _ => Vec2::new(number(&mut random, 38), number(&mut random, 38)),
            },
            gravity_scale: if i % 1_000 == 1 { fx!(0) } else { fx!(1) },
            linear_damping: Some(Damping::NONE),
            ..BodyDef::dynamic()
        };
        start.add_body(body).expect("a fair body");
    }
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        let mut world = start.clone();
        pool.install(|| {
            (0..60)
                .map(|_| {
                    let report = world.step();
                    let lists = (report.faults.to_vec(), report.fell_asleep.to_vec());
                    (lists, world.state_hash())
                })
                .collect::<Vec<_>>()
        })
    };
    let single = run(1);
    assert!(single.iter().any(|((faults, _), _)| !faults.is_empty()), "nobody left the envelope");
    assert!(single.iter().any(|((_, asleep), _)| !asleep.is_empty()), "nobody fell asleep");
    for threads in [2, 3, 8] {
        assert!(run(threads) == single, "{threads} threads");
    }
}
