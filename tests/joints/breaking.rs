//! Joints break on the mean force of a step.

use super::scenes::{assert_near, falling, point_mass, steps, still};
use umbra_physics::{
    BodyDef, BodyId, Event, Fx, JointDef, JointId, JointKind, JointMotor, Mass, Revolute, Shape, Snapshot, Symmetry,
    Weld, World, WorldDef, fx, vec2,
};

/// A chain of ten weights of 1 kg on rods of 1 m, straight down: the uppermost rod bears 100 N.
fn weights(break_force: Fx) -> (World, Vec<BodyId>, Vec<JointId>) {
    let mut world = falling();
    let mut bodies: Vec<BodyId> = Vec::new();
    let mut joints = Vec::new();
    for i in 0..10 {
        let body = point_mass(&mut world, vec2(0, -i - 1));
        let rod = JointDef::between(&world, bodies.last().copied(), vec2(0, -i), body, vec2(0, -i - 1)).expect("a rod");
        let rod = JointDef { break_force: Some(break_force), events: true, key: i as u64, ..rod };
        joints.push(world.add_joint(rod).expect("a rod"));
        bodies.push(body);
    }
    (world, bodies, joints)
}

/// The greatest mean force of a joint while a chain without a limit comes to rest.
fn rest(world: &mut World) {
    steps(world, 600);
}

/// A chain that rests holds its load at half a percent above it for ten minutes, and breaks at once at half a percent below it: the uppermost
/// rod alone, in the first step that loads it.
#[test]
fn a_joint_breaks_above_its_force_and_not_below() {
    let (mut world, _, joints) = weights(fx!(1000));
    rest(&mut world);
    for &joint in &joints {
        world.set_joint_break(joint, Some(fx!(100.5))).expect("a force");
    }
    for _ in 0..36_000 {
        assert!(world.step().joints_broke.is_empty(), "tick {}", world.tick());
    }
    for &joint in &joints {
        world.set_joint_break(joint, Some(fx!(99.5))).expect("a force");
    }
    let broke = world.step().joints_broke.to_vec();
    assert_eq!(broke.iter().map(|broke| (broke.joint, broke.key)).collect::<Vec<_>>(), [(joints[0], 0)]);
    assert!((broke[0].force - vec2(0, 100)).length() < fx!(0.5), "{}", broke[0].force);
    let joint = world.joint(joints[0]).expect("a joint");
    assert!(joint.is_broken() && !joint.is_active() && joint.def().enabled);
    assert_eq!(joint.force(), vec2(0, 0));
    // The rest falls freely, and breaks no more.
    for _ in 0..30 {
        assert!(world.step().joints_broke.is_empty());
    }
}

/// All joints that are too weak break in one step, and are reported by their keys whatever the order in which they were added; mirrored twins
/// break alike.
#[test]
fn all_breaks_of_a_step_are_one_report() {
    let run = |order: [u64; 3], mirror: bool| {
        let mut world = falling();
        for key in order {
            let x = 3 * key as i32;
            let body = world.add_body(BodyDef { position: vec2(x, -1), key, ..BodyDef::dynamic() }).expect("a body");
            let rod = JointDef::between(&world, None, vec2(x, 0), body, vec2(x, -1)).expect("a rod");
            let rod = JointDef { break_force: Some(fx!(5)), events: true, key, ..rod };
            world.add_joint(rod).expect("a rod");
        }
        if mirror {
            world = Symmetry::MIRROR.world(&world).expect("an image");
        }
        for _ in 0..60 {
            let tick = world.tick();
            let report = world.step();
            if !report.joints_broke.is_empty() {
                let keys: Vec<u64> = report.joints_broke.iter().map(|broke| broke.key).collect();
                let events = report.events().filter(|event| matches!(event, Event::JointBroke(_))).count();
                return (tick, keys, events);
            }
        }
        panic!("nothing broke");
    };
    let expected = run([1, 2, 3], false);
    assert_eq!((&expected.1[..], expected.2), (&[1, 2, 3][..], 3));
    assert_eq!(run([3, 1, 2], false), expected);
    assert_eq!(run([2, 3, 1], true), expected);
}

/// A shelf of 2 kg on a weld bears 20 N and 10 N·m: it holds at half a percent above either, and breaks at half a percent below it. The report has
/// both.
#[test]
fn a_joint_breaks_above_its_torque_and_not_below() {
    for (force, torque, breaks) in [
        (Some(fx!(20.1)), Some(fx!(10.05)), false),
        (None, Some(fx!(10.05)), false),
        (None, Some(fx!(9.95)), true),
        (Some(fx!(1_000)), Some(fx!(9.95)), true),
        (Some(fx!(19.9)), Some(fx!(1_000)), true),
        (Some(fx!(19.9)), None, true),
    ] {
        let mut world = falling();
        let mass = Mass::Explicit { mass: fx!(2), inertia: fx!(1) };
        let shelf = world.add_body(BodyDef { position: vec2(fx!(0.5), 0), mass, ..BodyDef::dynamic() });
        let weld = JointDef::at(&world, None, shelf.expect("a body"), vec2(0, 0)).expect("a weld");
        let weld = JointDef { kind: JointKind::Weld(Weld::default()), events: true, ..weld };
        let weld = world.add_joint(weld).expect("a weld");
        rest(&mut world);
        world.set_joint_break(weld, force).expect("a force");
        world.set_joint_break_torque(weld, torque).expect("a torque");
        let mut broke = Vec::new();
        for _ in 0..600 {
            broke.extend_from_slice(world.step().joints_broke);
        }
        assert_eq!(broke.len(), usize::from(breaks), "{force:?} {torque:?}");
        for broke in broke {
            assert!((broke.force - vec2(0, 20)).length() < fx!(0.05), "{}", broke.force);
            assert!((broke.torque - fx!(10)).abs() < fx!(0.05), "{}", broke.torque);
        }
    }
}

/// A joint breaks in the first step of a load, by the torque of the load: the mean has what the sub-steps add.
#[test]
fn a_torque_breaks_a_joint_in_its_first_step() {
    let mut world = still();
    let mass = Mass::Explicit { mass: fx!(2), inertia: fx!(1) };
    let sign = world.add_body(BodyDef { mass, ..BodyDef::dynamic() }).expect("a body");
    let weld = JointDef::at(&world, None, sign, vec2(0, 0)).expect("a weld");
    let kind = JointKind::Weld(Weld::default());
    world.add_joint(JointDef { kind, break_torque: Some(fx!(7.9)), events: true, ..weld }).expect("a weld");
    world.apply_torque(sign, fx!(8)).expect("a torque");
    let [broke] = world.step().joints_broke else { panic!("it breaks") };
    assert_near(broke.torque, fx!(-8), fx!(0.05));
}

/// A motor that is held wrings its axle off where its torque is larger; the torque of a gear is the torque on its second body.
#[test]
fn motors_and_gears_break_by_their_torque() {
    let held = |teeth: [i16; 2], torque: Fx| {
        let mut world = World::new(WorldDef::default()).expect("a world");
        let mass = Mass::Explicit { mass: fx!(1), inertia: fx!(1) };
        let [first, second] = [0, 5].map(|x| {
            let body = world.add_body(BodyDef { position: vec2(x, 0), mass, ..BodyDef::dynamic() }).expect("a body");
            let axle = JointDef::at(&world, None, body, vec2(x, 0)).expect("a joint");
            let motor = Some(JointMotor { speed: fx!(0), max_force: if x == 0 { fx!(0) } else { fx!(1_000) } });
            let kind = JointKind::Revolute(Revolute { motor, ..Revolute::default() });
            world.add_joint(JointDef { kind, ..axle }).expect("a joint");
            body
        });
        let gear = JointDef::gear(&world, first, second, teeth).expect("a gear");
        let gear = JointDef { break_torque: Some(torque), events: true, ..gear };
        let gear = world.add_joint(gear).expect("a gear");
        for _ in 0..120 {
            world.apply_torque(first, fx!(4)).expect("a torque");
            if let [broke] = world.step().joints_broke {
                return (broke.joint == gear).then_some(broke.torque);
            }
        }
        None
    };
    // 4 N·m on a wheel of 10 teeth are 12 N·m on one of 30, and the other way round.
    for (teeth, expected) in [([10, 30], fx!(12)), ([30, 10], fx!(4) / 3)] {
        assert_eq!(held(teeth, expected * fx!(1.01)), None);
        let torque = held(teeth, expected * fx!(0.99)).expect("it breaks");
        assert!((torque.abs() - expected).abs() < expected / 50, "{torque}");
    }
}

/// A ball of 1 kg hits an arm of 0.1 kg a metre from its weld to a hull at 10 m/s, in one step: 10 N·m·s but for what the arm keeps. The
/// impulses of an impact count.
#[test]
fn an_impact_breaks_by_its_torque() {
    let hit = |torque: Option<Fx>| {
        let mut world = World::new(WorldDef::default()).expect("a world");
        let heavy = Mass::Explicit { mass: fx!(1_000), inertia: fx!(1_000) };
        let hull = world.add_body(BodyDef { mass: heavy, ..BodyDef::dynamic() }).expect("a body");
        let light = Mass::Kilograms(fx!(0.1));
        let arm = BodyDef::dynamic().with_collider(Shape::rectangle(fx!(1.2), fx!(0.2)).expect("a shape"));
        let arm = world.add_body(BodyDef { position: vec2(fx!(0.6), 0), mass: light, ..arm }).expect("a body");
        let weld = JointDef::at(&world, hull, arm, vec2(0, 0)).expect("a weld");
        let kind = JointKind::Weld(Weld::default());
        world.add_joint(JointDef { kind, break_torque: torque, events: true, ..weld }).expect("a weld");
        let ball = BodyDef::dynamic().with_collider(Shape::circle(fx!(0.1)).expect("a shape"));
        let mass = Mass::Kilograms(fx!(1));
        let ball = BodyDef { position: vec2(1, fx!(0.25)), velocity: vec2(0, -10), mass, ..ball };
        world.add_body(ball).expect("a body");
        world.step().joints_broke.first().map(|broke| broke.torque)
    };
    // 600 N·m less a hundredth.
    let torque = hit(Some(fx!(550))).expect("it breaks");
    assert!((torque.abs() - fx!(590)).abs() < fx!(15), "{torque}");
    assert_eq!((hit(Some(fx!(620))), hit(None)), (None, None));
}

/// A broken joint that is repaired pulls again from where its ends are.
#[test]
fn a_broken_joint_can_be_repaired() {
    let mut world = falling();
    let load = point_mass(&mut world, vec2(0, -1));
    let rod = JointDef::between(&world, None, vec2(0, 0), load, vec2(0, -1)).expect("a rod");
    let rod = world.add_joint(JointDef { break_force: Some(fx!(5)), ..rod }).expect("a rod");
    steps(&mut world, 30);
    assert!(world.joint(rod).expect("a joint").is_broken());
    assert!(world.last_report().joints_broke.is_empty(), "it has no events");
    assert!(world.joint(rod).expect("a joint").length() > fx!(1.1));
    world.set_joint_break(rod, None).expect("a force");
    assert!(world.joint(rod).expect("a joint").is_broken(), "that alone repairs nothing");
    world.enable_joint(rod, true).expect("a joint");
    steps(&mut world, 600);
    let joint = world.joint(rod).expect("a joint");
    assert!(joint.is_active() && (joint.length() - fx!(1)).abs() < fx!(0.001), "{}", joint.length());
}

/// A gauge: a joint that never breaks, with events.
fn gauge(joint: JointDef) -> JointDef {
    JointDef { break_force: Some(Fx::MAX), events: true, ..joint }
}

/// The mean load of a step is the change of momentum of what hangs on the joint, to the last bits, also where the last sub-step has another force.
#[test]
fn the_mean_load_is_the_momentum_of_the_step() {
    let mut world = falling();
    let weight = point_mass(&mut world, vec2(0, -2));
    let rope = JointDef::between(&world, None, vec2(0, 0), weight, vec2(0, -2)).expect("a rod");
    let rope = world.add_joint(gauge(rope)).expect("a joint");
    world.set_velocity(weight, vec2(3, -4)).expect("a speed");
    let mut differed = 0;
    for tick in 0..240 {
        if tick == 100 {
            world.apply_impulse(weight, vec2(1, -2)).expect("an impulse");
        }
        let before = world.body(weight).expect("a body").velocity();
        let [load] = world.step().joint_loads else { panic!("one joint") };
        let (load, after) = (*load, world.body(weight).expect("a body").velocity());
        assert_eq!((load.joint, load.key, load.torque), (rope, 0, fx!(0)));
        // 1 kg, 60 steps a second.
        let expected = (after - before) * 60 + vec2(0, 10);
        assert!((load.force - expected).length() < fx!(0.000001), "tick {tick}: {} {expected}", load.force);
        let last = world.joint(rope).expect("a joint").force();
        differed += u32::from((load.force - last).length() > fx!(0.1));
    }
    assert!(differed > 1, "{differed}");
}

/// A torque: a shelf of 1 kg on a wall. A motor that turns a wheel has its own.
#[test]
fn the_mean_torque_is_the_moment_that_a_weld_bears() {
    let mut world = falling();
    let mass = Mass::Explicit { mass: fx!(1), inertia: fx!(1) };
    let shelf = world.add_body(BodyDef { position: vec2(fx!(0.5), 0), mass, ..BodyDef::dynamic() }).expect("a body");
    let weld = JointDef::at(&world, None, shelf, vec2(0, 0)).expect("a joint");
    let weld = JointDef { kind: JointKind::Weld(Weld::default()), break_torque: Some(fx!(100)), events: true, ..weld };
    world.add_joint(weld).expect("a joint");
    steps(&mut world, 29);
    let [load] = world.step().joint_loads else { panic!("one joint") };
    assert_near(load.torque, fx!(5), fx!(0.0001));
    assert!((load.force - vec2(0, 10)).length() < fx!(0.0001), "{}", load.force);
}

/// Loads are sorted by key, of joints alone that ask for them and whose bodies are awake. A world from a snapshot reports the same ones, and its mirror
/// image the images.
#[test]
fn loads_are_those_of_joints_that_ask_and_the_same_again() {
    let mut world = falling();
    let mut hang = |x: i32, ask: &dyn Fn(JointDef) -> JointDef| {
        let weight = point_mass(&mut world, vec2(x, -2));
        let rod = JointDef::between(&world, None, vec2(x - 1, 0), weight, vec2(x, -2)).expect("a rod");
        world.add_joint(ask(JointDef { key: 10 - x as u64, ..rod })).expect("a joint")
    };
    let first = hang(1, &gauge);
    hang(2, &|rod| rod);
    hang(3, &|rod| JointDef { events: true, ..rod });
    hang(4, &|rod| JointDef { break_force: Some(fx!(1000)), ..rod });
    let second = hang(5, &gauge);
    for _ in 0..40 {
        let copy = Snapshot::from_bytes(&world.snapshot().to_bytes(), &[]).expect("its own bytes");
        let mut copy: World = copy.into_world();
        let mut image = Symmetry::MIRROR.world(&world).expect("an image");
        assert!(copy.last_report().joint_loads.is_empty());
        let loads = world.step().joint_loads;
        assert_eq!(loads.iter().map(|load| load.joint).collect::<Vec<_>>(), [second, first]);
        assert_eq!(copy.step().joint_loads, loads);
        for (load, counterpart) in loads.iter().zip(image.step().joint_loads) {
            assert_eq!((Symmetry::MIRROR.vector(load.force), load.joint), (Some(counterpart.force), counterpart.joint));
        }
    }
    // One that swings no more falls asleep.
    let mut still = falling();
    let weight = point_mass(&mut still, vec2(0, -2));
    let rod = JointDef::between(&still, None, vec2(0, 0), weight, vec2(0, -2)).expect("a rod");
    still.add_joint(gauge(rod)).expect("a joint");
    steps(&mut still, 20);
    assert_eq!(still.last_report().joint_loads.len(), 1);
    steps(&mut still, 100);
    assert!(still.last_report().joint_loads.is_empty());
}
