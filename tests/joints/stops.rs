//! Stops: limits and ropes that are reached at speed.

use super::scenes::still;
use umbra_physics::scalar::ToF64;
use umbra_physics::{
    BodyDef, ColliderDef, ContactSettings, Distance, Fx, JointDef, JointId, JointKind, JointLimits, JointMotor, Mass,
    Prismatic, Revolute, Rot, Shape, Turn, Vec2, Weld, World, WorldDef, fx, vec2,
};

/// A world with gravity of 10 m/s² and so many sub-steps.
fn world_of(substeps: u32) -> World {
    let contacts = ContactSettings { substeps, ..ContactSettings::default() };
    World::new(WorldDef { gravity: vec2(0, -10), contacts, ..WorldDef::default() }).expect("a world")
}

/// A rectangle that touches nothing.
fn ghost(mass: i32, position: Vec2, width: Fx, height: Fx) -> BodyDef {
    let shape = Shape::rectangle(width, height).expect("a shape");
    let body = BodyDef { position, mass: Mass::Kilograms(mass.into()), ..BodyDef::dynamic() };
    body.with_collider(ColliderDef::ghost(shape))
}

/// A catapult: an arm of 100 kg at 45° on a hinge with a limit, and a weight at its short end, on a hook or welded. Its stop and its hook.
fn catapult(weight: i32, limit: Fx, is_hung: bool, substeps: u32) -> (World, [JointId; 2]) {
    let mut world = world_of(substeps);
    let direction = Rot::from_angle(Turn::from_degrees(fx!(225)));
    let arm = ghost(100, direction * vec2(1, 0), fx!(4), fx!(0.2));
    let arm = world.add_body(BodyDef { angle: fx!(225).to_radians(), ..arm }).expect("an arm");
    let end = direction * vec2(-1, 0);
    let middle = if is_hung { end - Vec2::new(fx!(0), fx!(0.6)) } else { end };
    let weight = world.add_body(ghost(weight, middle, fx!(0.8), fx!(0.8))).expect("a weight");
    let limits = Some(JointLimits { lower: limit.to_radians(), upper: fx!(1) });
    let kind = JointKind::Revolute(Revolute { limits, ..Revolute::default() });
    let hinge = JointDef::at(&world, None, arm, vec2(0, 0)).expect("a joint");
    let hinge = world.add_joint(JointDef { kind, ..hinge }).expect("a hinge");
    let hook = JointDef::at(&world, arm, weight, end).expect("a joint");
    let kind = if is_hung { hook.kind } else { JointKind::Weld(Weld::default()) };
    let hook = world.add_joint(JointDef { kind, ..hook }).expect("a hook");
    (world, [hinge, hook])
}

/// Runs a world for three seconds. Returns the widest gap of its joints, m, and the largest rise of the energy above its lowest value, J.
fn stopped(mut world: World, joints: &[JointId]) -> [f64; 2] {
    let (mut gap, mut lowest, mut rise) = (0.0_f64, f64::MAX, 0.0_f64);
    for _ in 0..180 {
        world.step();
        let energy = world.energy().expect("an energy").to_f64();
        lowest = lowest.min(energy);
        rise = rise.max(energy - lowest);
        for &joint in joints {
            gap = gap.max(world.joint(joint).expect("a joint").length().to_f64());
        }
    }
    [gap, rise]
}

/// The weight is up to 70 times as heavy as the arm, which stops it at any moment of a step. The impulses of the hook and of the hinge on the arm are
/// far beyond what its velocity may change by, and cancel.
#[test]
fn a_light_arm_stops_a_heavy_weight() {
    for (substeps, largest_gap) in [(5, 0.003), (16, 0.000_5)] {
        for (weight, is_hung) in [(800, true), (3_200, true), (7_000, true), (3_200, false)] {
            let (mut widest, mut highest) = (0.0_f64, 0.0_f64);
            for k in 0..16 {
                let limit = fx!(-110) + fx!(2.5) * k;
                let (world, joints) = catapult(weight, limit, is_hung, substeps);
                let [gap, rise] = stopped(world, &joints);
                (widest, highest) = (widest.max(gap), highest.max(rise));
            }
            println!("{weight} kg, {substeps} sub-steps: gap {:.3} mm, rise {highest:.1} J", widest * 1e3);
            // The weight has fallen by 0.7 m and more.
            let energy = f64::from(weight) * 10.0 * 0.7;
            assert!(widest < largest_gap && highest < 0.01 * energy, "{weight} kg: {widest} m, {highest} J");
        }
    }
}

/// A carriage of 10 kg that falls down a rail with a limit, or on a rope, with a load of up to a ton below it.
#[test]
fn a_light_carriage_stops_a_heavy_load() {
    for is_rope in [false, true] {
        for load in [80, 320, 1_000] {
            for k in 0..12 {
                let way = fx!(0.7) + fx!(0.06) * k;
                let mut world = world_of(5);
                let carriage = world.add_body(ghost(10, vec2(0, 0), fx!(0.4), fx!(0.4))).expect("a carriage");
                let middle = Vec2::new(fx!(0.3), fx!(-0.6));
                let weight = world.add_body(ghost(load, middle, fx!(0.6), fx!(0.6))).expect("a load");
                let (kind, def) = if is_rope {
                    let ends = [Vec2::new(fx!(0), fx!(0.5)), Vec2::new(fx!(0), fx!(0.1))];
                    let def = JointDef::between(&world, None, ends[0], carriage, ends[1]);
                    (JointKind::Distance(Distance::rope(way)), def)
                } else {
                    let limits = Some(JointLimits { lower: fx!(-1), upper: way });
                    let def = JointDef::along(&world, None, carriage, vec2(0, 0), vec2(0, -1));
                    (JointKind::Prismatic(Prismatic { limits, ..Prismatic::default() }), def)
                };
                world.add_joint(JointDef { kind, ..def.expect("a joint") }).expect("a stop");
                let hook = JointDef::at(&world, carriage, weight, Vec2::new(fx!(0), fx!(-0.3))).expect("a joint");
                let hook = world.add_joint(hook).expect("a hook");
                let [gap, rise] = stopped(world, &[hook]);
                let energy = f64::from(load) * 10.0 * way.to_f64();
                assert!(gap < 0.003 && rise < 0.01 * energy, "{load} kg after {way} m: {gap} m, {rise} J of {energy}");
            }
        }
    }
}

/// A cart is pushed by a constant force up to a limit, and a box before it flies on at the speed √(2·a·d) of both there: less half of the push of a
/// sub-step, as sub-steps of semi-implicit Euler have it, and less the push of the sub-step in which the limit is reached.
#[test]
fn what_a_stop_throws_has_all_the_push_before_it() {
    for substeps in [1, 5, 16] {
        for k in 0..20 {
            let way = fx!(0.5) + fx!(0.02) * k;
            let contacts = ContactSettings { substeps, ..ContactSettings::default() };
            let def = WorldDef { gravity: vec2(0, 0), contacts, sleep_after: None, ..WorldDef::default() };
            let mut world = World::new(def).expect("a world");
            let [cart, load] = [(0, fx!(4)), (1, fx!(1))].map(|(x, mass)| {
                let body = BodyDef { position: vec2(x, 0), mass: Mass::Kilograms(mass), ..BodyDef::dynamic() };
                let shape = Shape::rectangle(1, 1).expect("a shape");
                world.add_body(body.with_collider(shape)).expect("a body")
            });
            let kind = JointKind::Prismatic(Prismatic {
                limits: Some(JointLimits { lower: fx!(-1), upper: way }),
                motor: Some(JointMotor { speed: fx!(1000), max_force: fx!(300) }),
                ..Prismatic::default()
            });
            let rail = JointDef::along(&world, None, cart, vec2(0, 0), vec2(1, 0)).expect("a joint");
            world.add_joint(JointDef { kind, ..rail }).expect("a rail");
            (0..60).for_each(|_| {
                world.step();
            });
            let speed = world.body(load).expect("a body").velocity().x.to_f64();
            let acceleration = 300.0 / 5.0;
            let push = acceleration / 60.0 / f64::from(substeps);
            let missing = ((2.0 * acceleration * way.to_f64()).sqrt() - speed) / push;
            assert!((0.45..1.55).contains(&missing), "{substeps} sub-steps, {way} m: {missing} pushes are missing");
            assert!(world.body(cart).expect("a body").velocity().x.abs() < fx!(0.001));
        }
    }
}

/// In the step after a stop the impulses that it starts from turn the arm back as fast as it came, before they are taken back. The world is otherwise
/// at rest then, and its unit of velocity small.
#[test]
fn a_stop_at_the_end_of_a_step_is_over_in_the_next_step() {
    let mut count = 0;
    for k in 0..80 {
        let (mut world, [hinge, _]) = catapult(3_200, fx!(-110) + fx!(0.5) * k, true, 16);
        while world.joint(hinge).expect("a joint").torque().abs() < fx!(1) {
            world.step();
        }
        // An impulse of the last sub-step, and none of the steps before it.
        count += u32::from(world.joint(hinge).expect("a joint").torque().abs() > fx!(1_000_000));
        world.step();
        let speed = world.joint(hinge).expect("a joint").speed();
        assert!(speed.abs() < fx!(0.1), "{speed} rad/s");
    }
    assert!(count > 0, "no stop at the end of a step");
}

/// A carriage that meets the end of its rail at 150 m/s stays there: in the step after the stop its impulse of the last sub-step sends it back
/// at first, beyond what the unit of velocity of a world at rest has room for.
#[test]
fn a_fast_carriage_that_was_stopped_stays() {
    for k in 0..64 {
        let mut world = still();
        let carriage = ghost(1, vec2(0, 0), fx!(0.4), fx!(0.4));
        let carriage = world.add_body(BodyDef { velocity: vec2(150, 0), ..carriage }).expect("a carriage");
        let limits = Some(JointLimits { lower: fx!(-1), upper: fx!(3) + fx!(0.04) * k });
        let kind = JointKind::Prismatic(Prismatic { limits, ..Prismatic::default() });
        let rail = JointDef::along(&world, None, carriage, vec2(0, 0), vec2(1, 0)).expect("a joint");
        world.add_joint(JointDef { kind, ..rail }).expect("a rail");
        for tick in 0..6 {
            world.step();
            let speed = world.body(carriage).expect("a body").velocity().x;
            assert!(tick < 3 || speed.abs() < fx!(0.1), "way {k}, tick {tick}: {speed} m/s");
        }
    }
}

/// A rope between bodies of 1 and 100 kg that gets taut at 3 m/s leaves the momentum of both.
#[test]
fn a_rope_that_gets_taut_leaves_the_momentum() {
    let mut world = still();
    let masses = [1, 100];
    let [light, heavy] = [(0, vec2(-3, 0)), (1, vec2(0, 2))].map(|(x, velocity)| {
        let ball = ghost(masses[x as usize], vec2(x, 0), fx!(0.2), fx!(0.2));
        world.add_body(BodyDef { velocity, ..ball }).expect("a body")
    });
    let rope = JointDef::between(&world, light, vec2(0, 0), heavy, vec2(1, 0)).expect("a joint");
    world.add_joint(JointDef { kind: JointKind::Distance(Distance::rope(fx!(2))), ..rope }).expect("a rope");
    for _ in 0..60 {
        world.step();
    }
    let momenta = [light, heavy].into_iter().zip(masses).map(|(body, mass)| {
        let velocity = world.body(body).expect("a body").velocity();
        Vec2::new(velocity.x * mass, velocity.y * mass)
    });
    let momentum = momenta.fold(vec2(0, 0), |sum, momentum| sum + momentum);
    assert!((momentum - vec2(-3, 200)).length() < fx!(0.001), "{momentum:?}");
}
