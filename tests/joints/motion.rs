//! How joined bodies move.

use super::scenes::{chain, falling, point_mass, steps};
use umbra_physics::{BodyDef, BodyId, BodyKind, Fx, FxWide, JointDef, Mass, Vec2, World, WorldDef, fx, vec2};

/// Kinetic and potential energy of a body under a gravity of 10 m/s², J.
fn energy(world: &World, body: BodyId) -> Fx {
    let body = world.body(body).expect("a body");
    let kinetic = body.kinetic_energy().expect("a small energy").to_scalar().expect("a small energy");
    kinetic + body.mass().expect("a mass") * fx!(10) * body.position().y
}

/// A pendulum, let go level, keeps its energy for 100 s within 1 % of m·g·l on a rod, within 0.6 % as a bar of 1 m on a hinge, and stays at its
/// distance. A small bob on a hinge keeps it within 1.6 %: a hinge gives way alike along x and y, by 2^-11 of the mean of the inverse masses of
/// its body there, 1/m + r²/2I. At ten radii of gyration from the centre of mass this is 51/m, of which the tension along the arm takes 2.5 %
/// as a damped spring.
#[test]
fn a_pendulum_keeps_its_energy_and_its_length() {
    for (is_rod, inertia, limit) in
        [(true, fx!(0.01), fx!(0.1)), (false, Fx::from_ratio(1, 12), fx!(0.06)), (false, fx!(0.01), fx!(0.16))]
    {
        let mut world = falling();
        let mass = Mass::Explicit { mass: fx!(1), inertia };
        let bob = BodyDef { position: vec2(1, 0), mass, ..BodyDef::dynamic() };
        let bob = world.add_body(bob).expect("a body");
        let joint = if is_rod {
            JointDef::between(&world, None, vec2(0, 0), bob, vec2(1, 0))
        } else {
            JointDef::at(&world, None, bob, vec2(0, 0))
        };
        let joint = world.add_joint(joint.expect("a joint")).expect("a joint");
        for _ in 0..6_000 {
            world.step();
            let drift = energy(&world, bob);
            assert!(drift.abs() < limit, "rod {is_rod}, {inertia}, tick {}: {drift} J of 10", world.tick());
            let length = world.joint(joint).expect("a joint").length() - if is_rod { fx!(1) } else { fx!(0) };
            assert!(length.abs() < fx!(0.0005), "rod {is_rod}, tick {}: {length} m", world.tick());
        }
        // It swings still.
        assert!((0..180).any(|_| {
            world.step();
            world.body(bob).is_ok_and(|bob| bob.position().x < fx!(-0.9))
        }));
    }
}

/// A chain of ten bars falls, swings and hangs: no hinge opens by more than 2 cm on the way and 1 mm in the end; the rest of its motion goes with
/// damping, and then it sleeps as a whole.
#[test]
fn a_chain_comes_to_rest_and_sleeps_as_a_whole() {
    let mut world = falling();
    let (bodies, joints) = chain(&mut world, 10);
    for &body in &bodies {
        let damping = Some(umbra_physics::Damping::rate(fx!(1)));
        world.set_body_damping(body, damping, damping).expect("a damping");
    }
    let gap = |world: &World| {
        let gaps = joints.iter().map(|&joint| world.joint(joint).expect("a joint").length());
        gaps.fold(fx!(0), Fx::max)
    };
    let mut slept = Vec::new();
    for _ in 0..3_000 {
        slept.extend_from_slice(world.step().fell_asleep);
        assert!(gap(&world) < fx!(0.02), "tick {}: {}", world.tick(), gap(&world));
    }
    assert_eq!(slept, bodies, "all in one step, and none woke");
    assert!(gap(&world) < fx!(0.001), "{}", gap(&world));
    // Straight down; the uppermost hinge bears all of it.
    let tip = world.body(bodies[9]).expect("a body").position();
    assert!((tip - vec2(0, fx!(-9.5))).length() < fx!(0.05), "{tip}");
    let force = world.joint(joints[0]).expect("a joint").force();
    assert!((force - vec2(0, 20)).length() < fx!(0.2), "{force}");
}

/// The momentum of a free chain that is thrown stays what it was: joints take from one body what they give to the other.
#[test]
fn joints_keep_momentum() {
    let mut world = World::new(WorldDef::default()).expect("a world");
    let bodies: Vec<BodyId> = (0..8)
        .map(|i| {
            let mass = Mass::Explicit { mass: Fx::from(1 + i), inertia: fx!(0.5) };
            let velocity = Vec2::new(fx!(0.5) * (i % 3), fx!(0.25) * (i % 5));
            let def = BodyDef { position: vec2(i, i % 2), mass, velocity, ..BodyDef::dynamic() };
            world.add_body(def).expect("a body")
        })
        .collect();
    for pair in bodies.windows(2) {
        let [from, to] = [pair[0], pair[1]].map(|body| world.body(body).expect("a body").position());
        let rod = JointDef::between(&world, pair[0], from, pair[1], to).expect("a rod");
        world.add_joint(rod).expect("a rod");
    }
    let totals = |world: &World| {
        let momentum = world.momentum().expect("a momentum");
        let momentum = momentum.map(|part: FxWide| part.to_scalar().expect("a small momentum"));
        (momentum, world.angular_momentum().expect("a momentum").to_scalar().expect("a small momentum"))
    };
    let (before, spin_before) = totals(&world);
    steps(&mut world, 600);
    let (after, spin_after) = totals(&world);
    // Public velocities are rounded: half an ulp for each of 36 kg.
    assert!((after - before).length() < Fx::from_bits(64), "{before} {after}");
    assert!((spin_after - spin_before).abs() < fx!(0.05), "{spin_before} {spin_after}");
}

/// A kinematic body turns a crank through a hinge: the bar goes along, and so does a weight at the end of a rod.
#[test]
fn kinematic_bodies_pull_by_joints() {
    let mut world = World::new(WorldDef::default()).expect("a world");
    let cart = world.add_body(BodyDef { velocity: vec2(2, 0), ..BodyDef::kinematic() }).expect("a body");
    let load = point_mass(&mut world, vec2(-3, 0));
    let rod = JointDef::between(&world, cart, vec2(0, 0), load, vec2(-3, 0)).expect("a rod");
    world.add_joint(rod).expect("a rod");
    steps(&mut world, 120);
    let look = world.body(load).expect("a body");
    assert!((look.velocity() - vec2(2, 0)).length() < fx!(0.01), "{}", look.velocity());
    assert!((look.position() - vec2(1, 0)).length() < fx!(0.01), "{}", look.position());
    assert_eq!(world.body(cart).map(|cart| (cart.kind(), cart.velocity())), Ok((BodyKind::Kinematic, vec2(2, 0))));
}
