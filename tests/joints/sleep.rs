//! Joints wake bodies, and joined bodies sleep together.

use super::scenes::{falling, point_mass, steps};
use umbra_physics::{Activity, BodyDef, BodyId, JointDef, JointId, World, fx, vec2};

fn activity(world: &World, body: BodyId) -> Activity {
    world.body(body).expect("a body").activity()
}

/// Two weights, one under the other, that hang at rest and sleep.
fn hanging() -> (World, [BodyId; 2], [JointId; 2]) {
    let mut world = falling();
    let bodies = [-1, -2].map(|y| point_mass(&mut world, vec2(0, y)));
    let upper = JointDef::between(&world, None, vec2(0, 0), bodies[0], vec2(0, -1)).expect("a rod");
    let lower = JointDef::between(&world, bodies[0], vec2(0, -1), bodies[1], vec2(0, -2)).expect("a rod");
    let joints = [upper, lower].map(|rod| world.add_joint(rod).expect("a rod"));
    steps(&mut world, 200);
    assert_eq!(bodies.map(|body| activity(&world, body)), [Activity::Asleep; 2]);
    (world, bodies, joints)
}

/// Any change of a joint wakes both ends at once and counts their rest anew: half a second later they sleep, and not before.
#[test]
fn changes_of_joints_wake_both_ends() {
    type Change = fn(&mut World, JointId) -> Result<(), umbra_physics::Error>;
    let changes: [Change; 3] = [
        |world, joint| world.set_joint_kind(joint, world.joint(joint)?.def().kind),
        |world, joint| world.set_joint_break(joint, Some(fx!(1000))),
        |world, joint| world.enable_joint(joint, true),
    ];
    for change in changes {
        for end in 0..2 {
            let (mut world, bodies, joints) = hanging();
            change(&mut world, joints[end]).expect("a change");
            assert_eq!(bodies.map(|body| activity(&world, body)), [Activity::Awake; 2]);
            steps(&mut world, 29);
            assert_eq!(bodies.map(|body| activity(&world, body)), [Activity::Awake; 2]);
            steps(&mut world, 60);
            assert_eq!(bodies.map(|body| activity(&world, body)), [Activity::Asleep; 2]);
        }
    }
}

/// A body whose joint is removed or disabled falls in the next step, and so does one whose partner is removed.
#[test]
fn bodies_without_their_joint_fall_at_once() {
    for way in 0..3 {
        let (mut world, [upper, lower], [_, rod]) = hanging();
        match way {
            0 => world.remove_joint(rod),
            1 => world.enable_joint(rod, false),
            _ => world.remove_body(upper),
        }
        .expect("a change");
        assert_eq!(activity(&world, lower), Activity::Awake);
        let before = world.body(lower).expect("a body").velocity();
        world.step();
        assert!(world.body(lower).expect("a body").velocity().y < before.y - fx!(0.1), "way {way}");
    }
}

/// A joint that is added to sleeping bodies wakes them, and pulls.
#[test]
fn a_new_joint_wakes_its_bodies() {
    let mut world = World::new(umbra_physics::WorldDef::default()).expect("a world");
    let bodies = [0, 3].map(|x| point_mass(&mut world, vec2(x, 0)));
    steps(&mut world, 40);
    assert_eq!(bodies.map(|body| activity(&world, body)), [Activity::Asleep; 2]);
    let rod = JointDef::between(&world, bodies[0], vec2(0, 0), bodies[1], vec2(2, 0)).expect("a rod");
    world.add_joint(rod).expect("a rod");
    assert_eq!(bodies.map(|body| activity(&world, body)), [Activity::Awake; 2]);
}

/// A kinematic body that moves keeps its partners awake; one that stands lets them sleep, and wakes them in the step in which it starts.
#[test]
fn kinematic_partners_keep_awake_and_wake() {
    let mut world = falling();
    let hook = world.add_body(BodyDef::kinematic()).expect("a body");
    let load = point_mass(&mut world, vec2(0, -2));
    let rope = JointDef::between(&world, hook, vec2(0, 0), load, vec2(0, -2)).expect("a rod");
    world.add_joint(rope).expect("a rod");
    steps(&mut world, 200);
    assert_eq!(activity(&world, load), Activity::Asleep);
    // As slow as what rests by itself.
    world.set_velocity(hook, vec2(0, fx!(0.001))).expect("a velocity");
    assert_eq!(activity(&world, load), Activity::Awake);
    for _ in 0..200 {
        world.step();
        assert_eq!(activity(&world, load), Activity::Awake);
    }
    world.set_velocity(hook, vec2(0, 0)).expect("a velocity");
    steps(&mut world, 100);
    assert_eq!(activity(&world, load), Activity::Asleep);
    world.move_to(hook, vec2(0, 1), fx!(0)).expect("a way");
    world.step();
    assert_eq!(activity(&world, load), Activity::Awake);
    assert!(world.body(load).expect("a body").velocity().y > fx!(10), "it is pulled up in the same step");
}

/// Joined bodies sleep together: one that still moves keeps the other one awake, over any number of joints.
#[test]
fn a_body_that_moves_keeps_its_partners_awake() {
    let (mut world, [upper, lower], _) = hanging();
    world.set_velocity(lower, vec2(1, 0)).expect("a velocity");
    for _ in 0..120 {
        world.step();
        let activities = [upper, lower].map(|body| activity(&world, body));
        assert_eq!(activities, [Activity::Awake; 2], "tick {}", world.tick());
    }
}
