//! Ragdolls, bridges and tracks among other bodies: they come to rest, and nothing is thrown.

use super::scenes::falling;
use umbra_physics::{
    Activity, BodyDef, BodyId, BodyKind, BodyRef, ColliderDef, Distance, Filter, Fx, JointDef, JointId, JointKind,
    JointLimits, JointMotor, JointRef, Random, Revolute, Shape, Vec2, World, fx, vec2,
};

/// A limb: its middle over the place of the ragdoll, its size, the limb that it hangs on, the joint's point and its limits, degrees.
struct Limb {
    middle: [Fx; 2],
    size: [Fx; 2],
    parent: usize,
    point: [Fx; 2],
    limits: [i32; 2],
}

/// Torso, head, arms and legs of a figure of 1.7 m, both sides of it in one place: limbs of a ragdoll do not touch each other.
fn limbs() -> Vec<Limb> {
    let limb = |middle: [Fx; 2], size: [Fx; 2], parent: usize, point: [Fx; 2], limits: [i32; 2]| Limb {
        middle,
        size,
        parent,
        point,
        limits,
    };
    let mut limbs = vec![
        limb([fx!(0), fx!(1.1)], [fx!(0.3), fx!(0.6)], 0, [fx!(0), fx!(0)], [0, 0]),
        limb([fx!(0), fx!(1.55)], [fx!(0.2), fx!(0.25)], 0, [fx!(0), fx!(1.42)], [-30, 30]),
    ];
    for _ in 0..2 {
        let (upper_arm, upper_leg) = (limbs.len(), limbs.len() + 2);
        limbs.push(limb([fx!(0), fx!(1.2)], [fx!(0.1), fx!(0.35)], 0, [fx!(0), fx!(1.35)], [-90, 170]));
        limbs.push(limb([fx!(0), fx!(0.9)], [fx!(0.08), fx!(0.3)], upper_arm, [fx!(0), fx!(1.04)], [0, 140]));
        limbs.push(limb([fx!(0), fx!(0.62)], [fx!(0.14), fx!(0.42)], 0, [fx!(0), fx!(0.82)], [-20, 110]));
        limbs.push(limb([fx!(0), fx!(0.22)], [fx!(0.12), fx!(0.42)], upper_leg, [fx!(0), fx!(0.42)], [-140, 0]));
    }
    limbs
}

/// Adds a ragdoll with its feet at a point, and returns its bodies.
fn ragdoll(world: &mut World, at: Vec2, number: i32) -> Vec<BodyId> {
    let mut bodies: Vec<BodyId> = Vec::new();
    for limb in limbs() {
        let [width, height] = limb.size;
        let shape = Shape::rectangle(width, height).expect("a shape");
        // About the mass of 70 kg.
        let collider = ColliderDef {
            density: fx!(120),
            filter: Filter { group: -1 - number, ..Filter::default() },
            ..ColliderDef::new(shape)
        };
        let [x, y] = limb.middle;
        let body = BodyDef { position: at + Vec2::new(x, y), colliders: vec![collider], ..BodyDef::dynamic() };
        let body = world.add_body(body).expect("a body");
        if let Some(&parent) = bodies.get(limb.parent) {
            let [x, y] = limb.point;
            let joint = JointDef::at(world, parent, body, at + Vec2::new(x, y)).expect("a joint");
            let [lower, upper] = limb.limits;
            let limits = Some(JointLimits::degrees(lower, upper));
            let kind = JointKind::Revolute(Revolute { limits, friction: fx!(5), ..Revolute::default() });
            world.add_joint(JointDef { kind, ..joint }).expect("a joint");
        }
        bodies.push(body);
    }
    bodies
}

fn gap(world: &World) -> Fx {
    world.joints().map(|joint| joint.length()).fold(fx!(0), Fx::max)
}

/// The largest angle by which a joint is beyond its limits, rad.
fn beyond(world: &World) -> Fx {
    let excess = |joint: JointRef<'_>| match joint.def().kind {
        JointKind::Revolute(Revolute { limits: Some(limits), .. }) => {
            (limits.lower - joint.angle()).max(joint.angle() - limits.upper)
        }
        _ => fx!(0),
    };
    world.joints().map(excess).fold(fx!(0), Fx::max)
}

fn ground(world: &mut World) {
    let ground = BodyDef::fixed().with_collider(Shape::rectangle(100, 1).expect("a shape"));
    world.add_body(BodyDef { position: vec2(0, fx!(-0.5)), ..ground }).expect("a body");
    for x in [-7, 7] {
        let wall = BodyDef::fixed().with_collider(Shape::rectangle(1, 30).expect("a shape"));
        world.add_body(BodyDef { position: vec2(x, 15), ..wall }).expect("a body");
    }
}

/// Kinetic and potential energy, J.
fn total_energy(world: &World) -> Fx {
    world.energy().expect("an energy").to_scalar().expect("below 2^31 J")
}

/// Ten ragdolls fall on crates and on each other: nobody is thrown, joints and limits hold but for landings, and piles sleep within 20 s. They land at
/// 9 m/s; the free end of a body that is stopped at the other one whips at half as much again.
#[test]
fn ragdolls_among_crates_hold_together() {
    const PILES: u64 = 16;
    let (mut slept, mut worst) = (0, [fx!(0); 2]);
    let (mut angles, mut gains) = (Vec::new(), Vec::new());
    for seed in 0..PILES {
        let mut random = Random::seeded(seed);
        let mut world = falling();
        ground(&mut world);
        for i in 0..12 {
            let shape = Shape::rectangle(fx!(0.8), fx!(0.8)).expect("a shape");
            let position = Vec2::new(Fx::from(i - 6) + random.number(fx!(0)..=fx!(0.15)), fx!(0.4));
            world.add_body(BodyDef { position, ..BodyDef::dynamic().with_collider(shape) }).expect("a body");
        }
        for i in 0..10 {
            let x = Fx::from(i % 5 * 2 - 4) + random.number(fx!(-0.4)..=fx!(0.4));
            for body in ragdoll(&mut world, Vec2::new(x, Fx::from(2 + i / 5 * 3)), i) {
                let spin = random.number(fx!(-2)..=fx!(2));
                world.set_angular_velocity(body, spin).expect("a speed");
            }
        }
        let (mut energy, mut angle, mut gain) = (total_energy(&world), fx!(0), fx!(0));
        for _ in 0..1_200 {
            world.step();
            let energy_before = core::mem::replace(&mut energy, total_energy(&world));
            gain = gain.max(energy - energy_before);
            let fastest = world.bodies().map(|body| body.velocity().length()).fold(fx!(0), Fx::max);
            worst = [worst[0].max(gap(&world)), worst[1].max(fastest)];
            angle = angle.max(beyond(&world));
        }
        angles.push(angle);
        gains.push(gain);
        let is_at_rest = |body: BodyRef<'_>| body.kind() == BodyKind::Static || body.activity() == Activity::Asleep;
        slept += u64::from(world.bodies().all(is_at_rest));
    }
    angles.sort_unstable();
    gains.sort_unstable();
    println!(
        "{slept} of {PILES} asleep; gap, speed: {worst:?}, beyond limits {angles:?}; energy gained in a step: {gains:?}"
    );
    assert_eq!(slept, PILES);
    assert!(worst[0] < fx!(0.015) && worst[1] < fx!(14), "{worst:?}");
    let [median, last_but_one, last] = [gains.len() / 2, gains.len() - 2, gains.len() - 1];
    // By chance a limit of one pile in sixteen opens farther.
    assert!(angles[last_but_one] < fx!(0.1) && angles[last] < fx!(0.2), "{angles:?}");
    // Of 25 kJ at first. By chance a leg of one pile in sixteen whips through its stretched knee, by a radian in a step.
    assert!(gains[median] < fx!(5) && gains[last_but_one] < fx!(25) && gains[last] < fx!(200), "{gains:?}");
}

/// Planks between two posts with limits at their hinges, and discs that roll over them.
#[test]
fn a_bridge_with_limits_bears_rolling_discs() {
    let mut world = falling();
    let mut last: Option<BodyId> = None;
    for i in 0..=30 {
        let at = vec2(i, 0);
        let next = if i < 30 {
            let plank = BodyDef::dynamic().with_collider(Shape::rectangle(1, fx!(0.25)).expect("a shape"));
            let position = Vec2::new(Fx::from(i) + fx!(0.5), fx!(0));
            Some(world.add_body(BodyDef { position, ..plank }).expect("a body"))
        } else {
            None
        };
        let joint = JointDef::at(&world, last, next, at).expect("a joint");
        let limits = Some(JointLimits::degrees(-20, 20));
        let kind = JointKind::Revolute(Revolute { limits, ..Revolute::default() });
        world.add_joint(JointDef { kind, ..joint }).expect("a joint");
        last = next;
    }
    for i in 0..5 {
        let disc = BodyDef::dynamic().with_collider(Shape::circle(fx!(0.5)).expect("a shape"));
        let position = Vec2::new(Fx::from(3 + 5 * i), fx!(1));
        world.add_body(BodyDef { position, velocity: vec2(2, 0), ..disc }).expect("a body");
    }
    let (mut widest, mut bent) = (fx!(0), fx!(0));
    for _ in 0..1_200 {
        world.step();
        (widest, bent) = (widest.max(gap(&world)), bent.max(beyond(&world)));
    }
    let fastest = world.bodies().filter(|body| body.position().y > fx!(-20)).map(|body| body.velocity().length());
    println!("bridge: gap {widest}, beyond {bent}, fastest {}", fastest.fold(fx!(0), Fx::max));
    assert!(widest < fx!(0.02) && bent < fx!(0.05), "{widest}, {bent}");
}

/// A tank: a hull on five wheels, of which the last is driven, in a track of links, which is a ring. It drives over crates, stops and rests.
#[test]
fn a_tank_drives_on_its_track_and_rests() {
    let mut world = falling();
    let ground = BodyDef::fixed().with_collider(Shape::rectangle(200, 1).expect("a shape"));
    world.add_body(BodyDef { position: vec2(0, fx!(-0.5)), ..ground }).expect("a body");
    let group = Filter { group: -1, ..Filter::default() };
    let hull = ColliderDef {
        filter: group,
        density: fx!(2),
        ..ColliderDef::new(Shape::rectangle(4, fx!(0.6)).expect("a shape"))
    };
    let hull = BodyDef { position: vec2(0, fx!(1.5)), colliders: vec![hull], ..BodyDef::dynamic() };
    let hull = world.add_body(hull).expect("a body");
    let mut drives: Vec<JointId> = Vec::new();
    for i in 0..5 {
        let position = Vec2::new(Fx::from(i - 2) * fx!(0.9), fx!(0.6));
        let wheel = BodyDef::dynamic().with_collider(Shape::circle(fx!(0.4)).expect("a shape"));
        let wheel = world.add_body(BodyDef { position, ..wheel }).expect("a body");
        let axle = JointDef::at(&world, hull, wheel, position).expect("a joint");
        drives.push(world.add_joint(axle).expect("a joint"));
    }
    // Links around the wheels: straight above and below, half circles at the ends.
    let (half, radius, count) = (fx!(1.8), fx!(0.45), 30);
    let arc = Fx::PI * radius;
    let length = (half * 4 + arc * 2) / count;
    let place = |along: Fx| {
        let (top, bend) = (half * 2, arc);
        let turned = |angle: Fx, x: Fx| (Vec2::new(x + radius * angle.cos(), fx!(0.6) + radius * angle.sin()), angle);
        if along < top {
            (Vec2::new(half - along, fx!(0.6) + radius), Fx::PI / 2)
        } else if along < top + bend {
            turned(Fx::PI / 2 + (along - top) / radius, -half)
        } else if along < top * 2 + bend {
            (Vec2::new(along - top - bend - half, fx!(0.6) - radius), Fx::PI * 3 / 2)
        } else {
            turned(Fx::PI * 3 / 2 + (along - top * 2 - bend) / radius, half)
        }
    };
    let links: Vec<BodyId> = (0..count)
        .map(|i| {
            let (position, normal) = place(length * i + length / 2);
            let shape = Shape::rectangle(length * fx!(0.9), fx!(0.08)).expect("a shape");
            let collider = ColliderDef { density: fx!(3), ..ColliderDef::new(shape) };
            let link =
                BodyDef { position, angle: normal + Fx::PI / 2, colliders: vec![collider], ..BodyDef::dynamic() };
            world.add_body(link).expect("a body")
        })
        .collect();
    for i in 0..count as usize {
        let (point, _) = place(length * (i as i32 + 1) - if i + 1 == count as usize { Fx::DELTA } else { fx!(0) });
        let joint = JointDef::at(&world, links[i], links[(i + 1) % count as usize], point).expect("a joint");
        world.add_joint(joint).expect("a joint");
    }
    for i in 0..4 {
        let crate_def = BodyDef::dynamic().with_collider(Shape::rectangle(fx!(0.3), fx!(0.3)).expect("a shape"));
        world.add_body(BodyDef { position: vec2(4 + 2 * i, fx!(0.15)), ..crate_def }).expect("a body");
    }
    let mut widest = fx!(0);
    for tick in 0..1_500 {
        let speed = match tick {
            60 => Some(fx!(-5)),
            600 => Some(fx!(0)),
            _ => None,
        };
        if let Some(speed) = speed {
            for &axle in &drives {
                world.set_joint_motor(axle, Some(JointMotor { speed, max_force: fx!(40) })).expect("a motor");
            }
        }
        world.step();
        widest = widest.max(gap(&world));
    }
    let fastest = world.bodies().map(|body| body.velocity().length()).fold(fx!(0), Fx::max);
    let x = world.body(hull).expect("a body").position().x;
    println!("tank: at {x}, gap {widest}, fastest {fastest}");
    assert!(x > fx!(8) && widest < fx!(0.05) && fastest < fx!(0.05), "{x}, {widest}, {fastest}");
}

/// Level planks of 1 m between two banks, whose hinges are made by their number.
fn bridge(planks: i32, hinge: impl Fn(i32) -> Revolute) -> World {
    let mut world = falling();
    let mut last: Option<BodyId> = None;
    for i in 0..=planks {
        let next = (i < planks).then(|| {
            let shape = Shape::rectangle(fx!(1), fx!(0.2)).expect("a shape");
            let collider = ColliderDef { density: fx!(4), ..ColliderDef::new(shape) };
            let position = Vec2::new(Fx::from(i) + fx!(0.5), fx!(0));
            let plank = BodyDef { position, colliders: vec![collider], ..BodyDef::dynamic() };
            world.add_body(plank).expect("a body")
        });
        let joint = JointDef::at(&world, last, next, vec2(i, 0)).expect("a joint");
        world.add_joint(JointDef { kind: JointKind::Revolute(hinge(i)), ..joint }).expect("a joint");
        last = next;
    }
    world
}

/// Runs a bridge. Returns the widest gap on the way, and the fastest speed at the end.
fn run_bridge(world: &mut World, ticks: usize) -> [Fx; 2] {
    let mut widest = fx!(0);
    for _ in 0..ticks {
        world.step();
        widest = widest.max(gap(world));
    }
    [widest, world.bodies().map(|body| body.velocity().length()).fold(fx!(0), Fx::max)]
}

/// Planks between two banks with friction in every hinge, or with brakes: whatever the torque, no hinge opens, and nothing starts by itself.
#[test]
fn a_bridge_with_friction_between_two_banks_holds() {
    for (friction, is_brake) in [(0, false), (1, false), (100, false), (500, false), (5_000, false), (500, true)] {
        let force = Fx::from_ratio(friction, 1_000);
        let motor = is_brake.then_some(JointMotor { speed: fx!(0), max_force: force });
        let friction = if is_brake { fx!(0) } else { force };
        let mut world = bridge(14, |_| Revolute { friction, motor, ..Revolute::default() });
        let [widest, fastest] = run_bridge(&mut world, 600);
        println!("friction {force}, brake {is_brake}: gap {widest}, speed {fastest}");
        assert!(widest < fx!(0.005) && fastest < fx!(0.3), "{force}, {is_brake}: {widest}, {fastest}");
    }
}

/// Motors that turn hinges of a bridge between two banks to and fro against friction of the same torque: rows go on from place to place in each
/// pass.
#[test]
fn a_bridge_with_motors_against_friction_holds() {
    let force = fx!(5);
    let mut world = bridge(6, |i| {
        let motor = Some(JointMotor { speed: Fx::from(i * 6 % 7 - 3), max_force: force });
        Revolute { friction: force, motor, ..Revolute::default() }
    });
    let [widest, fastest] = run_bridge(&mut world, 200);
    assert!(widest < fx!(0.005) && fastest < fx!(1), "{widest}, {fastest}");
}

/// A bridge whose hinges all have limits, friction and motors of any speeds at once, by a seed.
fn driven_bridge(seed: u64) -> (World, i32) {
    let mut random = Random::seeded(seed);
    let mut number = |range| random.integer(range) as i32;
    let (planks, torque) = (number(4..=15), Fx::from(number(1..=100)));
    let speeds: Vec<i32> = (0..=planks).map(|_| number(-3..=3)).collect();
    let largest = number(1..=30);
    let hinge = |i: i32| Revolute {
        limits: Some(JointLimits::degrees(-largest, largest)),
        friction: torque,
        motor: Some(JointMotor { speed: Fx::from(speeds[i as usize]), max_force: torque }),
        ..Revolute::default()
    };
    (bridge(planks, hinge), planks)
}

/// Drives a bridge for two seconds: keeps the widest gap of hinges, the largest angle beyond a limit and the largest speed.
fn drive(world: &mut World, worst: &mut [Fx; 3]) {
    for _ in 0..120 {
        world.step();
        let hinges = world.joints().filter(|joint| matches!(joint.def().kind, JointKind::Revolute(_)));
        worst[0] = hinges.map(|joint| joint.length()).fold(worst[0], Fx::max);
        worst[1] = worst[1].max(beyond(world));
        worst[2] = world.bodies().map(|body| body.velocity().length()).fold(worst[2], Fx::max);
    }
}

/// Rows press against each other from bank to bank, and for some sets of them the search for their places goes round in circles. One bridge of fifteen
/// would fly apart at 100 km/s if its last impulses were taken.
#[test]
fn bridges_with_limits_and_motors_of_any_speeds_hold() {
    let mut worst = [fx!(0); 3];
    for seed in 0..200 {
        let (mut world, _) = driven_bridge(seed);
        drive(&mut world, &mut worst);
    }
    println!("bridges: gap, angle beyond limits, speed: {worst:?}");
    assert!(worst[0] < fx!(0.002) && worst[1] < fx!(0.02) && worst[2] < fx!(3), "{worst:?}");
}

/// With a brace from the second plank to the last one a bridge is a loop, which is softer.
#[test]
fn braced_bridges_with_limits_and_motors_hold() {
    let mut worst = [fx!(0); 3];
    for seed in 0..60 {
        let (mut world, planks) = driven_bridge(seed);
        let mut bodies = world.bodies().map(|body| body.id());
        let ends = [bodies.nth(1), bodies.last()].map(|body| body.expect("four planks"));
        let [from, to] = ends.map(|body| world.body(body).expect("a body").position());
        let brace = JointDef::between(&world, ends[0], from, ends[1], to).expect("a joint");
        let kind = JointKind::Distance(Distance::rod(Fx::from(planks - 2)));
        world.add_joint(JointDef { kind, ..brace }).expect("a joint");
        drive(&mut world, &mut worst);
    }
    println!("braced bridges: gap, angle beyond limits, speed: {worst:?}");
    assert!(worst[0] < fx!(0.03) && worst[1] < fx!(0.05) && worst[2] < fx!(5), "{worst:?}");
}
