//! The state of joints: snapshots, hashes, copies, images, differences.

use super::scenes::{bar, chain, falling, point_mass, steps};
use crate::seeds::run_seed;
use umbra_physics::{
    BodyDef, BodyId, Error, Fx, Irreversible, JointDef, JointKind, Owner, Random, Snapshot, Symmetry, TimeStep, Vec2,
    Weld, Wheel, World, WorldDef, fx, vec2,
};

fn through_bytes(world: &World) -> World {
    Snapshot::from_bytes(&world.snapshot().to_bytes(), &[]).expect("its own bytes").into_world()
}

/// A chain in full swing goes on to the bit from bytes, from a snapshot in memory and from a clone, at each tick.
#[test]
fn a_restored_chain_goes_on_to_the_bit() {
    let mut world = falling();
    let (_, joints) = chain(&mut world, 6);
    world.set_joint_break(joints[2], Some(fx!(300))).expect("a force");
    let mut stored = world.snapshot();
    for tick in 0..240 {
        let (mut read, mut cloned) = (through_bytes(&world), world.clone());
        assert_eq!(read.state_hash(), world.state_hash());
        world.snapshot_into(&mut stored);
        world.step();
        read.step();
        cloned.step();
        assert_eq!([read.state_hash(), cloned.state_hash()], [world.state_hash(); 2], "tick {tick}");
        cloned.restore(&stored);
        cloned.step();
        assert_eq!(cloned.state_hash(), world.state_hash(), "tick {tick}");
    }
}

/// A joint takes at most 32 bytes of a snapshot beside its definition, and a revolute one that turns freely 20.
#[test]
fn the_state_of_a_joint_is_small() {
    let mut world = falling();
    let body = point_mass(&mut world, vec2(1, 0));
    let size = |world: &World| world.snapshot().to_bytes().len();
    let empty = size(&world);
    let def = JointDef::at(&world, None, body, vec2(0, 0)).expect("a joint");
    let joint = world.add_joint(def).expect("a joint");
    steps(&mut world, 1);
    // Two ends, two angles, the kind, three flags, no force and no torque, a key, data; the slot has a generation and says that it is taken.
    let definition = (17 + 25) + 16 + 1 + 3 + 2 + 16;
    // No limits, motor or spring, and no friction.
    let axis = 3 + 8;
    // And no ratchet.
    assert_eq!(size(&world) - empty, definition + axis + 1 + 5 + 19);
    let rod = JointDef::between(&world, None, vec2(0, 0), body, vec2(1, 0)).expect("a rod");
    world.set_joint_kind(joint, rod.kind).expect("a kind");
    // Two limits.
    assert_eq!(size(&world) - empty, definition + axis + 16 + 5 + 11);
    world.set_joint_kind(joint, JointKind::Wheel(Wheel::default())).expect("a kind");
    assert_eq!(size(&world) - empty, definition + axis + 5 + 29);
    world.set_joint_kind(joint, JointKind::Weld(Weld::default())).expect("a kind");
    assert_eq!(size(&world) - empty, definition + 1 + 5 + 29);
}

/// Bodies and joints in another order have the same motion, and so do mirrored, turned and shifted worlds.
#[test]
fn order_and_images_change_no_bit() {
    /// A net of 5 by 5 weights on pins and rods between two fixed corners, and bars that fall on it.
    fn net(order: impl Fn(&mut Vec<usize>)) -> World {
        let mut world = falling();
        let mut places: Vec<usize> = (0..25).collect();
        order(&mut places);
        let mut ids = [None::<BodyId>; 25];
        let at = |place: usize| vec2((place % 5) as i32, (place / 5) as i32);
        for &place in &places {
            let def = BodyDef { position: at(place), key: place as u64 + 1, ..BodyDef::dynamic() };
            ids[place] = Some(world.add_body(def).expect("a body"));
        }
        let mut links: Vec<usize> = (0..52).collect();
        order(&mut links);
        for link in links {
            let (from, to) = match link {
                0..20 => (link / 4 * 5 + link % 4, link / 4 * 5 + link % 4 + 1),
                20..40 => (link - 20, link - 15),
                _ => continue,
            };
            let rod = JointDef::between(&world, ids[from], at(from), ids[to], at(to)).expect("a rod");
            world.add_joint(JointDef { key: link as u64, ..rod }).expect("a rod");
        }
        for (key, corner) in [(60, 20), (61, 24)] {
            let pin = JointDef::at(&world, None, ids[corner], at(corner)).expect("a pin");
            world.add_joint(JointDef { key, ..pin }).expect("a pin");
        }
        world
    }
    let mut world = net(|_| {});
    let mut shuffled = net(|list| {
        let mut random = Random::seeded(run_seed(3));
        for i in (1..list.len()).rev() {
            list.swap(i, random.below(i as u64 + 1) as usize);
        }
    });
    let shift = Symmetry::shift(vec2(7, -3)).expect("a shift");
    let symmetries = [Symmetry::MIRROR, Symmetry::FLIP, Symmetry::DIAGONAL, Symmetry::TURN, shift];
    let mut images = symmetries.map(|symmetry| symmetry.world(&world).expect("an image"));
    for tick in 0..200 {
        world.step();
        shuffled.step();
        assert_eq!(shuffled.physics_hash(), world.physics_hash(), "tick {tick}");
        for (symmetry, image) in symmetries.iter().zip(&mut images) {
            image.step();
            let expected = symmetry.world(&world).expect("an image").state_hash();
            assert_eq!(image.state_hash(), expected, "{} at tick {tick}", symmetry.name());
        }
    }
    assert_ne!(shuffled.state_hash(), world.state_hash());
}

/// The ends of joints may change places without a change of motion.
#[test]
fn ends_may_change_places() {
    let run = |swaps: bool| {
        let mut world = falling();
        let bodies = [1, 2].map(|x| bar(&mut world, vec2(x, 0)));
        for pair in [[None, Some(bodies[0])], [Some(bodies[0]), Some(bodies[1])]] {
            let [first, second] = if swaps { [pair[1], pair[0]] } else { pair };
            let joint = JointDef::at(
                &world,
                first,
                second,
                Vec2::new(fx!(0.5) + Fx::from(i32::from(pair[0].is_some())), fx!(0)),
            );
            world.add_joint(joint.expect("a joint")).expect("a joint");
        }
        steps(&mut world, 300);
        bodies.map(|body| {
            (world.body(body).expect("a body").position_exact(), world.body(body).expect("a body").angle_exact())
        })
    };
    assert_eq!(run(true), run(false));
}

/// A world without joints has the hash that it had, and a world whose joints are all gone has no other motion.
#[test]
fn a_world_whose_joints_are_gone_moves_as_if_there_had_been_none() {
    let mut world = falling();
    let body = point_mass(&mut world, vec2(1, 0));
    let mut plain = world.clone();
    let joint = JointDef::at(&world, None, body, vec2(0, 0)).expect("a joint");
    let joint = world.add_joint(joint).expect("a joint");
    world.remove_joint(joint).expect("a joint");
    assert_eq!(world.physics_hash(), plain.physics_hash());
    steps(&mut world, 10);
    steps(&mut plain, 10);
    assert_eq!(world.physics_hash(), plain.physics_hash());
}

/// A difference names the joint and its value.
#[test]
fn differences_name_joints() {
    let mut world = falling();
    let body = point_mass(&mut world, vec2(1, 0));
    let joint = JointDef::at(&world, None, body, vec2(0, 0)).expect("a joint");
    let joint = world.add_joint(JointDef { key: 9, ..joint }).expect("a joint");
    let mut changed = world.clone();
    changed.set_joint_break(joint, Some(fx!(5))).expect("a force");
    let difference = world.first_difference(&changed).expect("a difference");
    assert_eq!((difference.owner, difference.key), (Owner::Joint(joint), 9));
    assert_eq!(difference.field, "break_force.given");
    world.step();
    let mut other = world.clone();
    other.enable_joint(joint, false).expect("a joint");
    let fields: Vec<String> = world.differences(&other).into_iter().map(|difference| difference.field).collect();
    assert!(fields.contains(&"enabled".into()) && fields.contains(&"state.impulses.y".into()), "{fields:?}");
}

/// Forces stay the same when the time step or the number of sub-steps changes.
#[test]
fn forces_stay_when_the_step_changes() {
    let mut world =
        World::new(WorldDef { gravity: vec2(0, -10), sleep_after: None, ..WorldDef::default() }).expect("a world");
    let body = point_mass(&mut world, vec2(0, -1));
    let joint = JointDef::between(&world, None, vec2(0, 0), body, vec2(0, -1)).expect("a rod");
    let joint = world.add_joint(joint).expect("a joint");
    steps(&mut world, 120);
    let force = |world: &World| world.joint(joint).expect("a joint").force();
    let before = force(&world);
    world.set_time_step(TimeStep::hz(144)).expect("a step");
    assert!((force(&world) - before).length() < fx!(0.00001), "{before} {}", force(&world));
    world
        .set_contact_settings(umbra_physics::ContactSettings { substeps: 8, ..world.def().contacts })
        .expect("settings");
    assert!((force(&world) - before).length() < fx!(0.00001), "{before} {}", force(&world));
    for _ in 0..60 {
        world.step();
        assert!((force(&world) - before).length() < fx!(0.01), "{before} {}", force(&world));
    }
    // Another kind has other rows: it starts anew.
    world.set_joint_kind(joint, JointKind::default()).expect("a kind");
    assert_eq!(force(&world), vec2(0, 0));
}

/// A step in which a joint pulled cannot be undone; one in which it had nothing to do can.
#[test]
fn a_step_with_a_pull_cannot_be_undone() {
    let mut world = World::new(WorldDef { sleep_after: None, ..WorldDef::default() }).expect("a world");
    let bodies = [0, 1].map(|x| {
        let def = BodyDef { position: vec2(x, 0), velocity: vec2(3, 0), ..BodyDef::dynamic() };
        world.add_body(def).expect("a body")
    });
    let rod = JointDef::between(&world, bodies[0], vec2(0, 0), bodies[1], vec2(1, 0)).expect("a rod");
    world.add_joint(rod).expect("a rod");
    steps(&mut world, 3);
    let before = world.state_hash();
    world.step();
    assert_eq!(world.step_back(&[]), Ok(()));
    assert_eq!(world.state_hash(), before);
    world.apply_impulse(bodies[1], vec2(0, 1)).expect("an impulse");
    world.step();
    assert_eq!(world.step_back(&[]), Err(Error::NotReversible { why: Irreversible::Joint }));
}

/// A rollback that goes back and makes the ticks again has the same world.
#[test]
fn rolled_back_ticks_are_the_same() {
    let mut world = falling();
    chain(&mut world, 5);
    let mut straight = world.clone();
    steps(&mut straight, 120);
    for _ in 0..12 {
        let saved = world.snapshot();
        steps(&mut world, 17);
        world.restore(&saved);
        steps(&mut world, 10);
    }
    assert_eq!(world.state_hash(), straight.state_hash());
}
