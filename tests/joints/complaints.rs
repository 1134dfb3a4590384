//! Complaints of users of other engines as tests of this engine: each names the public threads, and expects the value of physics.

use super::scenes::{falling, steps, still, wheel};
use crate::seeds::{run_seed, times};
use umbra_physics::scalar::ToF64;
use umbra_physics::{
    Activity, Attachment, BodyDef, BodyId, ColliderDef, ContactSettings, Distance, End, Error, Filter, Fx, JointDef,
    JointId, JointKind, JointLimits, JointMotor, JointSpring, Locks, Mass, Motor, PlanarMotor, Prismatic, Random,
    Revolute, Shape, TimeStep, Vec2, Weld, Wheel, World, WorldDef, fx, vec2,
};

/// A rectangle at a place.
fn bar(position: Vec2, width: Fx, height: Fx) -> BodyDef {
    BodyDef { position, ..BodyDef::dynamic().with_collider(Shape::rectangle(width, height).expect("a shape")) }
}

/// A disc at a place.
fn disc(position: Vec2, radius: Fx) -> BodyDef {
    BodyDef { position, ..BodyDef::dynamic().with_collider(Shape::circle(radius).expect("a shape")) }
}

/// A body without an outline at a place, whose inertia in kg·m² is its mass in kg.
fn solid(position: Vec2, mass: Fx) -> BodyDef {
    BodyDef { position, mass: Mass::Explicit { mass, inertia: mass }, ..BodyDef::dynamic() }
}

/// A world of this gravity along y that does not sleep.
fn awake(gravity: i32) -> World {
    World::new(WorldDef { gravity: vec2(0, gravity), sleep_after: None, ..WorldDef::default() }).expect("a world")
}

fn add(world: &mut World, body: BodyDef) -> BodyId {
    world.add_body(body).expect("a body")
}

fn join(world: &mut World, joint: Result<JointDef, Error>, kind: JointKind) -> JointId {
    world.add_joint(JointDef { kind, ..joint.expect("points of both") }).expect("a joint")
}

fn range(lower: Fx, upper: Fx) -> Option<JointLimits> {
    Some(JointLimits { lower, upper })
}

fn energy(world: &World) -> f64 {
    world.energy().expect("an energy").to_f64()
}

/// The speed of a body, m/s, or that of its turning, rad/s, whichever is the larger number.
fn speed(world: &World, body: BodyId) -> f64 {
    let body = world.body(body).expect("a body");
    body.velocity().length().max(body.angular_velocity().abs()).to_f64()
}

/// The angle of a joint, rad.
fn angle(world: &World, joint: JointId) -> f64 {
    world.joint(joint).expect("a joint").angle().to_f64()
}

/// A bar of 2 m that hangs on one end is thrown at a limit of its hinge at 50 rad/s. It stops there, less than 0.05 rad beyond, and never has more
/// energy than it was thrown with. <https://github.com/godotengine/godot/issues/88481>, <https://github.com/godotengine/godot/issues/91691>
#[test]
fn a_bar_that_is_thrown_at_a_limit_stops() {
    for mass in [fx!(0.001), fx!(1), fx!(10_000)] {
        for direction in [1, -1] {
            let mut world = awake(0);
            let body = BodyDef {
                mass: Mass::Kilograms(mass),
                velocity: vec2(0, 50 * direction),
                angular_velocity: Fx::from(50 * direction),
                ..bar(vec2(1, 0), fx!(2), fx!(0.1))
            };
            let body = add(&mut world, body);
            let hinge = JointDef::at(&world, None, body, vec2(0, 0));
            let limits = range(fx!(-0.7), fx!(0.7));
            let hinge = join(&mut world, hinge, JointKind::Revolute(Revolute { limits, ..Revolute::default() }));
            let start = energy(&world);
            let mut farthest = 0.0_f64;
            for tick in 0..120 {
                world.step();
                farthest = farthest.max(angle(&world, hinge).abs());
                assert!(energy(&world) <= start, "{mass} kg, {tick}: {} of {start} J", energy(&world));
            }
            assert!(farthest < 0.75 && speed(&world, body) < 0.001, "{farthest}, {}", speed(&world, body));
        }
    }
}

/// A pinball flipper of 30 cm, from 0.1 g to 10 t, strikes its two stops 50 times at 30 rad/s. Half a second after each hit its tip has less than
/// 1 mm/s: it does not jitter. <https://github.com/avianphysics/avian/issues/886>
#[test]
fn flippers_of_any_mass_are_still_at_their_stops() {
    for mass in [fx!(0.0001), fx!(0.001), fx!(1), fx!(100), fx!(10_000)] {
        let mut world = falling();
        let flipper = BodyDef { mass: Mass::Kilograms(mass), ..bar(vec2(fx!(0.15), 0), fx!(0.3), fx!(0.05)) };
        let flipper = add(&mut world, flipper);
        let limits = Some(JointLimits::degrees(-30, 30));
        let hinge = JointDef::at(&world, None, flipper, vec2(0, 0));
        let hinge = join(&mut world, hinge, JointKind::Revolute(Revolute { limits, ..Revolute::default() }));
        for hit in 0..50 {
            let direction = 1 - hit % 2 * 2;
            // 2,000 rad/s² about the hinge.
            let motor = JointMotor { speed: Fx::from(30 * direction), max_force: mass * 60 };
            world.set_joint_motor(hinge, Some(motor)).expect("a motor");
            let stop = std::f64::consts::FRAC_PI_6 * f64::from(direction);
            let mut ticks = 0;
            while (angle(&world, hinge) - stop).abs() > 0.01 {
                world.step();
                ticks += 1;
                assert!(ticks < 60, "{mass} kg does not arrive");
            }
            steps(&mut world, 30);
            let tip = world.body(flipper).expect("a body").angular_velocity().to_f64() * 0.3;
            assert!(tip.abs() < 0.001, "{mass} kg, hit {hit}: {tip} m/s");
            assert!((angle(&world, hinge) - stop).abs() < 0.0001, "{mass} kg, hit {hit}: {}", angle(&world, hinge));
        }
    }
}

/// A motor presses an arm on a post that does not give way. In three minutes the arm does not creep, whatever the torque.
/// <https://github.com/dimforge/rapier/issues/125>
#[test]
fn a_motor_that_is_stalled_does_not_creep() {
    for torque in [fx!(0.001), fx!(2), fx!(100_000)] {
        let mut world = awake(0);
        let arm = BodyDef { mass: Mass::Kilograms(torque / 2), ..bar(vec2(fx!(0.5), 0), fx!(1), fx!(0.1)) };
        let arm = add(&mut world, arm);
        let post = BodyDef::fixed().with_collider(Shape::circle(fx!(0.1)).expect("a shape"));
        add(&mut world, BodyDef { position: vec2(fx!(0.8), fx!(0.15)), ..post });
        let hinge = JointDef::at(&world, None, arm, vec2(0, 0));
        let motor = Some(JointMotor { speed: fx!(1), max_force: torque });
        let hinge = join(&mut world, hinge, JointKind::Revolute(Revolute { motor, ..Revolute::default() }));
        steps(&mut world, 600);
        let start = angle(&world, hinge);
        let mut creep = 0.0_f64;
        for _ in 0..10_000 {
            world.step();
            creep = creep.max((angle(&world, hinge) - start).abs());
        }
        assert!(creep < 1e-7, "{torque} N·m: {creep} rad");
    }
}

/// A motor holds a wheel at its limit, and is turned round in each of the last 25 steps before the wheel would sleep: in the next step the wheel
/// has the speed τ/I/60, and it arrives at the other limit. <https://github.com/erincatto/box2d/issues/367>
#[test]
fn a_motor_that_turns_round_just_before_its_wheel_sleeps_moves_it() {
    let mut world = still();
    let (body, axle) = wheel(&mut world, vec2(0, 0), fx!(1));
    let motor = |speed: i32| Some(JointMotor { speed: Fx::from(speed), max_force: fx!(1) });
    let revolute = Revolute { limits: range(fx!(-0.5), fx!(0.5)), motor: motor(1), ..Revolute::default() };
    world.set_joint_kind(axle, JointKind::Revolute(revolute)).expect("a kind");
    let mut past = Vec::new();
    while world.body(body).expect("a body").activity() == Activity::Awake {
        past.push(world.clone());
        world.step();
    }
    for (before, mut world) in past.into_iter().rev().take(25).enumerate() {
        assert!((angle(&world, axle) - 0.5).abs() < 1e-4, "{before}: {}", angle(&world, axle));
        world.set_joint_motor(axle, motor(-1)).expect("a motor");
        world.step();
        let spin = world.body(body).expect("a body").angular_velocity().to_f64();
        assert!((spin + 1.0 / 60.0).abs() < 1e-4, "{before}: {spin}");
        steps(&mut world, 120);
        assert!((angle(&world, axle) + 0.5).abs() < 1e-4, "{before}: {}", angle(&world, axle));
    }
}

/// Two boxes in space on a slider between them, the second one at any of 4,096 angles when they are joined: nothing moves at all.
/// <https://github.com/dimforge/rapier/issues/746>
#[test]
fn sliders_of_turned_boxes_do_not_move() {
    for k in 0..4_096_i64 {
        let mut world = still();
        let first = add(&mut world, solid(vec2(0, 0), fx!(1)));
        let second = BodyDef { angle: Fx::TAU * Fx::from_ratio(k, 4_096), ..solid(vec2(1, 0), fx!(1)) };
        let second = add(&mut world, second);
        let rail = JointDef::along(&world, first, second, vec2(0, 0), vec2(1, 0));
        join(&mut world, rail, JointKind::Prismatic(Prismatic::default()));
        for _ in 0..5 {
            world.step();
            assert_eq!([first, second].map(|body| speed(&world, body)), [0.0; 2], "{k}");
        }
    }
}

/// A slider at a limit against which its motor presses it, at 1,000 angles: it does not drift by a micrometre.
/// <https://github.com/erincatto/box2d/issues/69>
#[test]
fn sliders_at_their_stops_do_not_drift() {
    let mut world = awake(-10);
    let mut places = Vec::new();
    for k in 0..1_000_i64 {
        let (sin, cos) = (Fx::TAU * Fx::from_ratio(2 * k + 1, 2_000)).sin_cos();
        let locks = Locks { rotation: k % 2 == 0, ..Locks::NONE };
        let body = add(&mut world, BodyDef { locks, ..solid(vec2(0, 0), fx!(1)) });
        let rail = JointDef::along(&world, None, body, vec2(0, 0), Vec2::new(cos, sin));
        let motor = Some(JointMotor { speed: fx!(1), max_force: fx!(20) });
        let limits = range(fx!(-0.02), fx!(0.02));
        let slider = Prismatic { limits, motor, ..Prismatic::default() };
        places.push((body, join(&mut world, rail, JointKind::Prismatic(slider)), vec2(0, 0)));
    }
    steps(&mut world, 20);
    for (body, _, place) in &mut places {
        *place = world.body(*body).expect("a body").position();
    }
    for _ in 0..times(12_u32) {
        steps(&mut world, 10);
        for &(body, rail, place) in &places {
            let drift = (world.body(body).expect("a body").position() - place).length();
            assert!(drift < fx!(0.000001), "{drift}");
            let stop = world.joint(rail).expect("a joint").translation();
            assert!((stop - fx!(0.02)).abs() < fx!(0.00001), "{stop}");
        }
    }
}

/// A slider-crank: the piston, which does not turn, comes off its rod in motion. It falls to the end of its rail and stays there, and is
/// never a micrometre beside the rail. <https://github.com/erincatto/box2d/issues/96>
#[test]
fn a_piston_that_lost_its_rod_does_not_drift() {
    let mut world = awake(-10);
    let crank = add(&mut world, solid(vec2(0, 7), fx!(4)));
    let rod = add(&mut world, solid(vec2(0, 13), fx!(8)));
    let locks = Locks { rotation: true, ..Locks::NONE };
    let piston = add(&mut world, BodyDef { locks, ..solid(vec2(0, 17), fx!(9)) });
    let motor = Some(JointMotor { speed: Fx::PI, max_force: fx!(10_000) });
    let axle = JointDef::at(&world, None, crank, vec2(0, 5));
    join(&mut world, axle, JointKind::Revolute(Revolute { motor, ..Revolute::default() }));
    let pin = JointDef::at(&world, crank, rod, vec2(0, 9));
    join(&mut world, pin, JointKind::default());
    let pin = JointDef::at(&world, rod, piston, vec2(0, 17));
    let pin = join(&mut world, pin, JointKind::default());
    let rail = JointDef::along(&world, None, piston, vec2(0, 17), vec2(0, 1));
    let limits = range(fx!(-10), fx!(10));
    join(&mut world, rail, JointKind::Prismatic(Prismatic { limits, ..Prismatic::default() }));
    steps(&mut world, 100);
    world.remove_joint(pin).expect("a joint");
    steps(&mut world, 30);
    let mut drift = 0.0_f64;
    for _ in 0..10_000 {
        world.step();
        drift = drift.max(world.body(piston).expect("a body").position().x.to_f64().abs());
    }
    assert!(drift < 1e-6, "{drift} m");
}

/// A slider-crank with its motor in a frame that floats in space: whatever turns and slides in it, its momentum stays 0.
/// <https://github.com/erincatto/box2d/issues/96>
#[test]
fn a_floating_crank_has_no_momentum() {
    let mut world = awake(0);
    let frame = add(&mut world, solid(vec2(0, 0), fx!(20)));
    let crank = add(&mut world, solid(vec2(fx!(0.5), 0), fx!(1)));
    let rod = add(&mut world, solid(vec2(fx!(2.5), 0), fx!(2)));
    let piston = add(&mut world, solid(vec2(4, 0), fx!(5)));
    let motor = Some(JointMotor { speed: fx!(3), max_force: fx!(100) });
    let axle = JointDef::at(&world, frame, crank, vec2(0, 0));
    join(&mut world, axle, JointKind::Revolute(Revolute { motor, ..Revolute::default() }));
    for (first, second, x) in [(crank, rod, 1), (rod, piston, 4)] {
        let pin = JointDef::at(&world, first, second, vec2(x, 0));
        join(&mut world, pin, JointKind::default());
    }
    let rail = JointDef::along(&world, frame, piston, vec2(4, 0), vec2(1, 0));
    let rail = join(&mut world, rail, JointKind::Prismatic(Prismatic::default()));
    let mut stroke = 0.0_f64;
    for tick in 0..1_200 {
        world.step();
        stroke = stroke.max(world.joint(rail).expect("a joint").translation().to_f64().abs());
        let Vec2 { x, y } = world.momentum().expect("a momentum");
        let momentum = x.to_f64().hypot(y.to_f64());
        assert!(momentum < 1e-7, "{tick}: {momentum} N·s");
    }
    assert!((stroke - 2.0).abs() < 0.01, "{stroke} m");
}

/// A windmill of four blades welded to a hub, free and on an axle: after a push of 0.1 N·s it keeps its angular momentum to a millionth over
/// 10^4 steps, and gains no energy. <https://github.com/erincatto/box2d/issues/997>
#[test]
fn a_windmill_keeps_its_momentum_to_a_millionth() {
    for has_axle in [false, true] {
        let mut world = awake(0);
        let hub = add(&mut world, disc(vec2(0, 0), fx!(0.3)));
        if has_axle {
            let axle = JointDef::at(&world, None, hub, vec2(0, 0));
            join(&mut world, axle, JointKind::default());
        }
        let blades = [vec2(1, 0), vec2(0, 1), vec2(-1, 0), vec2(0, -1)].map(|place| {
            let [width, height] = if place.x == fx!(0) { [fx!(0.2), fx!(1)] } else { [fx!(1), fx!(0.2)] };
            let blade = add(&mut world, bar(place, width, height));
            let weld = JointDef::at(&world, hub, blade, place / fx!(2));
            join(&mut world, weld, JointKind::Weld(Weld::default()));
            blade
        });
        world.apply_impulse_at_point(blades[0], vec2(0, fx!(0.1)), vec2(fx!(1.5), 0)).expect("an impulse");
        let momentum = |world: &World| world.angular_momentum().expect("a momentum").to_f64();
        world.step();
        let [start, start_energy] = [momentum(&world), energy(&world)];
        assert!((start - 0.15).abs() < 1e-6 * 0.15, "{start}");
        for _ in 0..100 {
            steps(&mut world, 100);
            assert!((momentum(&world) - start).abs() < 1e-6 * start, "{} of {start}", momentum(&world));
            assert!(energy(&world) <= start_energy, "{} of {start_energy}", energy(&world));
        }
    }
}

/// A car: a chassis and two wheels on springs, in the order of the bodies, and its axles.
fn car(world: &mut World, place: Vec2, angle: Fx) -> ([BodyId; 3], [JointId; 2]) {
    let (sin, cos) = angle.sin_cos();
    let chassis = add(world, BodyDef { angle, ..bar(place, fx!(2.4), fx!(0.5)) });
    let hubs = [fx!(-0.8), fx!(0.8)].map(|x| place + Vec2::new(x * cos + fx!(0.4) * sin, x * sin - fx!(0.4) * cos));
    let tyres = hubs.map(|hub| add(world, BodyDef { angle, ..disc(hub, fx!(0.4)) }));
    let spring = Some(JointSpring::new(fx!(3), fx!(0.7)));
    let suspension = JointKind::Wheel(Wheel { limits: range(fx!(-0.25), fx!(0.25)), spring, ..Wheel::default() });
    let axles = [0, 1].map(|side| {
        let axle = JointDef::along(world, chassis, tyres[side], hubs[side], Vec2::new(-sin, cos));
        join(world, axle, suspension)
    });
    ([chassis, tyres[0], tyres[1]], axles)
}

/// A flat road, and a car over it.
fn road(height: Fx, angle: Fx) -> (World, [BodyId; 3], [JointId; 2]) {
    let mut world = falling();
    let ground = BodyDef::fixed().with_collider(Shape::rectangle(2_000, 1).expect("a shape"));
    add(&mut world, BodyDef { position: vec2(0, fx!(-0.5)), ..ground });
    let (bodies, axles) = car(&mut world, vec2(0, height), angle);
    (world, bodies, axles)
}

/// The largest distance of a hub from its axis in so many steps, m. None of them has a fault.
fn off_axis(world: &mut World, axles: [JointId; 2], ticks: usize) -> f64 {
    let mut farthest = 0.0_f64;
    for _ in 0..ticks {
        assert!(world.step().faults.is_empty(), "tick {}", world.tick());
        let offsets = axles.map(|axle| world.joint(axle).expect("a joint").offset().y.to_f64().abs());
        farthest = farthest.max(offsets[0]).max(offsets[1]);
    }
    farthest
}

/// A car that falls from 5 m, tilted by up to a radian, has its wheels within half a millimetre of their axes all the time.
/// <https://github.com/piqnt/planck.js/issues/28>, <https://github.com/godotengine/godot/issues/10580>
#[test]
fn wheels_of_a_car_that_falls_stay_on_their_axes() {
    for angle in [fx!(1), fx!(-1), fx!(0.5), fx!(0.2), fx!(0)] {
        let (mut world, _, axles) = road(fx!(5), angle);
        let farthest = off_axis(&mut world, axles, 400);
        println!("{angle} rad: {farthest}");
        assert!(farthest < 0.000_5, "{angle} rad: {farthest} m");
    }
}

/// A box with 200 times the mass of a wheel hits it at 50 m/s, from behind, from the front and from above: no step has a fault, and the wheel stays
/// within 5 mm of its axis. <https://github.com/slembcke/Chipmunk2D/issues/213>, <https://github.com/erincatto/box2d/issues/1007>
#[test]
fn a_wheel_that_is_struck_stays_on_its_axis() {
    let strokes =
        [(vec2(-3, fx!(0.5)), vec2(50, 0)), (vec2(3, fx!(0.5)), vec2(-50, 0)), (vec2(-3, fx!(1.9)), vec2(40, -30))];
    for (place, velocity) in strokes {
        let (mut world, [_, tyre, _], axles) = road(fx!(0.8), fx!(0));
        steps(&mut world, 120);
        let mass = world.body(tyre).expect("a body").mass().expect("a mass");
        let hammer = BodyDef { velocity, mass: Mass::Kilograms(mass * 200), ..bar(place, fx!(1), fx!(0.6)) };
        add(&mut world, hammer);
        let farthest = off_axis(&mut world, axles, 300);
        println!("{velocity}: {farthest}");
        assert!(farthest < 0.005, "{velocity}: {farthest} m");
        assert!((world.body(tyre).expect("a body").position().x).abs() > fx!(3), "it was struck");
    }
}

/// A weight of 100 kg falls 3 m into a rope of 4 m, and swings on it: the rope is never longer than 4.001 m.
/// <https://github.com/dimforge/rapier/issues/561>
#[test]
fn a_rope_stays_as_long_as_it_is() {
    let mut world = awake(-10);
    let weight = add(&mut world, solid(vec2(0, -1), fx!(100)));
    let rope = JointDef::between(&world, None, vec2(0, 0), weight, vec2(0, -1));
    let rope = join(&mut world, rope, JointKind::Distance(Distance::rope(fx!(4))));
    for swing in 0..4 {
        for _ in 0..300 {
            world.step();
            let length = world.joint(rope).expect("a joint").length();
            assert!(length < fx!(4.001), "{length}");
        }
        world.set_velocity(weight, vec2(4 * swing, 0)).expect("a velocity");
    }
}

/// A weight of 10 t on a chain of 20 links of 1 kg: no joint opens by 2 mm, from the first step on.
/// <https://github.com/DanielChappuis/reactphysics3d/issues/329>, <https://github.com/erincatto/box3d/issues/131>
#[test]
fn a_chain_bears_ten_thousand_times_its_links() {
    let mut world = awake(-10);
    let mut above: Option<BodyId> = None;
    for k in 0..20 {
        let mass = Mass::Kilograms(if k == 19 { fx!(10_000) } else { fx!(1) });
        let link = add(&mut world, BodyDef { mass, ..bar(vec2(0, fx!(-0.5) - Fx::from(k)), fx!(0.2), fx!(1)) });
        let pin = JointDef::at(&world, above, link, vec2(0, -k));
        join(&mut world, pin, JointKind::default());
        above = Some(link);
    }
    let mut widest = fx!(0);
    for _ in 0..1_200 {
        world.step();
        widest = world.joints().map(|joint| joint.length()).fold(widest, Fx::max);
    }
    assert!(widest < fx!(0.002), "{widest}");
}

/// A part of a figure of 1.9 m: the height of its middle, its length between the centres of its ends, and its radius, the part that it hangs on, and
/// the height of its hinge, m, its limits, degrees, and the friction in its hinge, N·m.
struct Limb {
    size: [Fx; 3],
    parent: usize,
    hinge: Fx,
    limits: [i32; 2],
    friction: Fx,
}

/// Torso, head, arms and legs, with the friction that the example of ragdolls has.
fn limbs() -> Vec<Limb> {
    let limb = |size: [Fx; 3], parent: usize, hinge: Fx, limits: [i32; 2], friction: Fx| Limb {
        size,
        parent,
        hinge,
        limits,
        friction,
    };
    let mut limbs = vec![
        limb([fx!(1.28), fx!(0.34), fx!(0.15)], 0, fx!(1.28), [0, 0], fx!(0)),
        limb([fx!(1.76), fx!(0.08), fx!(0.12)], 0, fx!(1.62), [-35, 35], fx!(2)),
    ];
    for arm in [2, 6] {
        limbs.push(limb([fx!(1.37), fx!(0.22), fx!(0.05)], 0, fx!(1.51), [-60, 170], fx!(2)));
        limbs.push(limb([fx!(1.09), fx!(0.22), fx!(0.045)], arm, fx!(1.23), [0, 140], fx!(1)));
        limbs.push(limb([fx!(0.84), fx!(0.28), fx!(0.07)], 0, fx!(1.04), [-35, 115], fx!(4)));
        limbs.push(limb([fx!(0.44), fx!(0.3), fx!(0.06)], arm + 2, fx!(0.64), [-125, 0], fx!(2)));
    }
    limbs
}

/// Adds a ragdoll with its feet at a point. Returns its limbs, the torso first, and how far from the torso's middle each of them reaches at most.
fn ragdoll(world: &mut World, feet: Vec2, number: i32) -> Vec<(BodyId, Fx)> {
    let mut parts: Vec<(BodyId, Fx)> = Vec::new();
    let limbs = limbs();
    for limb in &limbs {
        let [middle, length, radius] = limb.size;
        let collider = ColliderDef {
            angle: Fx::FRAC_PI_2,
            density: fx!(125),
            filter: Filter { group: -1 - number, ..Filter::default() },
            ..ColliderDef::new(Shape::capsule(length, radius).expect("a shape"))
        };
        let body = BodyDef { position: feet + vec2(0, middle), ..BodyDef::dynamic().with_collider(collider) };
        let body = add(world, body);
        let mut reach = fx!(0);
        if let Some(&(parent, way)) = parts.get(limb.parent) {
            let hinge = JointDef::at(world, parent, body, feet + vec2(0, limb.hinge));
            let limits = Some(JointLimits::degrees(limb.limits[0], limb.limits[1]));
            join(
                world,
                hinge,
                JointKind::Revolute(Revolute { limits, friction: limb.friction, ..Revolute::default() }),
            );
            reach = way + (limb.hinge - middle).abs() + (limb.hinge - limbs[limb.parent].size[0]).abs();
        }
        parts.push((body, reach));
    }
    parts
}

/// Ground and two walls, some metres apart.
fn yard(half_width: i32) -> World {
    let mut world = falling();
    let ground = BodyDef::fixed().with_collider(Shape::rectangle(2 * half_width, 1).expect("a shape"));
    add(&mut world, BodyDef { position: vec2(0, fx!(-0.5)), ..ground });
    for x in [-half_width, half_width] {
        let wall = BodyDef::fixed().with_collider(Shape::rectangle(1, 60).expect("a shape"));
        add(&mut world, BodyDef { position: vec2(x, 30), ..wall });
    }
    world
}

/// Ten ragdolls with friction in their joints fall in a heap: all of them are at rest, and asleep, within 10 s.
/// <https://github.com/liabru/matter-js/issues/772>, <https://github.com/NVIDIAGameWorks/PhysX/issues/365>
#[test]
fn ragdolls_that_fall_in_a_heap_rest_within_ten_seconds() {
    for drop in 0..times(4_u64) {
        let mut random = Random::seeded(run_seed(drop));
        let mut world = yard(7);
        let mut bodies = Vec::new();
        for k in 0..10 {
            let x = Fx::from(k % 5 * 2 - 4) + random.number(fx!(-0.4)..=fx!(0.4));
            for (body, _) in ragdoll(&mut world, Vec2::new(x, fx!(0.5) + Fx::from(k / 5 * 3)), k) {
                world.set_angular_velocity(body, random.number(fx!(-2)..=fx!(2))).expect("a speed");
                bodies.push(body);
            }
        }
        let mut ticks = 0;
        while bodies.iter().any(|&body| world.body(body).expect("a body").activity() == Activity::Awake) {
            world.step();
            ticks += 1;
            assert!(ticks <= 600, "drop {drop}");
        }
    }
}

/// Ragdolls thrown down at the ground at 50 m/s: a second later no limb is farther from the torso than 1.05 times as far as it reaches.
/// <https://github.com/liabru/matter-js/issues/772>
#[test]
fn ragdolls_that_are_thrown_stay_whole() {
    let mut random = Random::seeded(run_seed(8));
    let mut worst = 0.0_f64;
    for throw in 0..times(60_u32) {
        let mut world = yard(10);
        let parts = ragdoll(&mut world, vec2(0, 3), 0);
        let (sin, cos) = random.number(fx!(3.5)..=fx!(5.9)).sin_cos();
        let spin = random.number(fx!(-10)..=fx!(10));
        for &(body, _) in &parts {
            world.set_velocity(body, Vec2::new(cos, sin) * fx!(50)).expect("a velocity");
            world.set_angular_velocity(body, spin).expect("a speed");
        }
        steps(&mut world, 60);
        let torso = world.body(parts[0].0).expect("a body").position();
        for &(body, reach) in &parts[1..] {
            let distance = (world.body(body).expect("a body").position() - torso).length();
            worst = worst.max(distance.to_f64() / reach.to_f64());
            assert!(distance < reach * fx!(1.05), "throw {throw}: {distance} of {reach}");
        }
    }
    println!("worst {worst}");
}

/// Ten weights of 1 kg on rods, one below the other, that do not sleep: the uppermost rod, which bears 100 N, does not break at 100.5 N in an hour
/// (by day in a tenth of it), and breaks at once at 99.5 N. <https://github.com/dimforge/rapier/issues/348>
#[test]
fn a_rod_that_bears_its_load_does_not_break_later() {
    let mut world = awake(-10);
    let mut above: Option<BodyId> = None;
    let mut rods = Vec::new();
    for k in 0..10 {
        let weight = add(&mut world, solid(vec2(0, -k - 1), fx!(1)));
        let rod = JointDef::between(&world, above, vec2(0, -k), weight, vec2(0, -k - 1)).expect("a rod");
        rods.push(world.add_joint(JointDef { events: true, ..rod }).expect("a rod"));
        above = Some(weight);
    }
    steps(&mut world, 600);
    world.set_joint_break(rods[0], Some(fx!(100.5))).expect("a force");
    let mut off = 0.0_f64;
    for _ in 0..times(21_600_u32) {
        assert!(world.step().joints_broke.is_empty(), "tick {}", world.tick());
        let force = world.joint(rods[0]).expect("a joint").force();
        off = off.max((force.y.to_f64() - 100.0).abs());
    }
    assert!(off < 0.005, "{off} N");
    world.set_joint_break(rods[0], Some(fx!(99.5))).expect("a force");
    let broke = world.step().joints_broke.to_vec();
    assert_eq!(broke.iter().map(|broke| broke.joint).collect::<Vec<_>>(), [rods[0]]);
}

/// A spring of 10^4 N/m whose largest force is 10 N, stretched by 2 m, as a line, as a slider and as a suspension: it pulls with 10 N, and never with
/// more but for half a unit of impulse, 2^-32 N·s, in a sub-step. <https://github.com/slembcke/Chipmunk2D/issues/245>
#[test]
fn a_stiff_spring_keeps_to_its_largest_force() {
    let rounding = 0.5 / 4_294_967_296.0 * 300.0;
    for mass in [fx!(1), fx!(100)] {
        let hertz = (fx!(10_000) / mass).checked_sqrt().expect("positive") / Fx::TAU;
        let spring = JointSpring { max_force: Some(fx!(10)), ..JointSpring::new(hertz, fx!(0)) };
        for kind in [
            JointKind::Distance(Distance {
                spring: Some(JointSpring { rest: fx!(3), ..spring }),
                ..Distance::default()
            }),
            JointKind::Prismatic(Prismatic { spring: Some(spring), ..Prismatic::default() }),
            JointKind::Wheel(Wheel { spring: Some(spring), ..Wheel::default() }),
        ] {
            let mut world = awake(0);
            let body = add(&mut world, solid(vec2(3, 0), mass));
            let joint = match kind {
                JointKind::Distance(_) => JointDef::between(&world, None, vec2(0, 0), body, vec2(3, 0)),
                _ => JointDef::along(&world, None, body, vec2(3, 0), vec2(1, 0)),
            };
            let joint = join(&mut world, joint, kind);
            world.set_position(body, vec2(5, 0)).expect("a place");
            world.step();
            let pull = world.joint(joint).expect("a joint").force().x.to_f64();
            assert!((pull + 10.0).abs() < 1e-6, "{mass} kg, {kind:?}: {pull} N");
            let mut over = 0.0_f64;
            for _ in 0..600 {
                world.step();
                let pull = world.joint(joint).expect("a joint").force();
                over = over.max(pull.x.to_f64().abs() - 10.0);
            }
            assert!(over <= rounding, "{mass} kg, {kind:?}: {over} N more");
        }
    }
}

/// The second hand of a clock drives the minute hand by a train of 60 to 1 for 24 hours, in steps of a second. The minute hand has made 24 turns for
/// 1,440 of the other one, and each gear is as well in step in the last hour as in the second one. <https://github.com/dimforge/rapier/issues/922>
#[test]
fn a_clock_is_right_after_a_day() {
    let contacts = ContactSettings { substeps: 1, ..ContactSettings::default() };
    let time_step = TimeStep::hz(1);
    let def = WorldDef { gravity: vec2(0, 0), time_step, contacts, sleep_after: None, ..WorldDef::default() };
    let mut world = World::new(def).expect("a world");
    let hands = [0, 2, 4, 6].map(|x| wheel(&mut world, vec2(x, 0), fx!(1)));
    let gears = [[1, -5], [1, -4], [1, -3]].into_iter().zip(hands.windows(2)).map(|(teeth, pair)| {
        let gear = JointDef::gear(&world, pair[0].0, pair[1].0, teeth).expect("a gear");
        world.add_joint(gear).expect("a gear")
    });
    let gears: Vec<JointId> = gears.collect();
    let motor = Some(JointMotor { speed: -Fx::TAU / 60, max_force: fx!(1) });
    // Joints with limits count turns.
    for ((_, axle), motor) in hands.into_iter().zip([motor, None, None, None]) {
        let revolute = Revolute { limits: range(fx!(-100_000), fx!(100_000)), motor, ..Revolute::default() };
        world.set_joint_kind(axle, JointKind::Revolute(revolute)).expect("a kind");
    }
    let mut hours = Vec::new();
    for _ in 0..24 {
        let mut off = 0.0_f64;
        for _ in 0..3_600 {
            world.step();
            off = gears.iter().map(|&gear| angle(&world, gear).abs()).fold(off, f64::max);
        }
        hours.push(off);
    }
    let [second, .., minute] = hands.map(|(_, axle)| angle(&world, axle));
    assert!(hours[1..].iter().all(|&off| off < 2e-6), "{hours:?}");
    assert!((second + 1_440.0 * std::f64::consts::TAU).abs() < 1e-3, "{second}");
    assert!((second - 60.0 * minute).abs() < 60.0 * 1e-6, "{second} {minute}");
}

/// Machines of all kinds of joints side by side, and weights that fall on them: their bodies, in the order in which they were added, and the joints.
fn machines() -> (Vec<BodyDef>, Vec<JointDef>) {
    let mut world = falling();
    let mut defs: Vec<BodyDef> = vec![BodyDef {
        position: vec2(0, fx!(-0.5)),
        ..BodyDef::fixed().with_collider(Shape::rectangle(200, 1).expect("a shape"))
    }];
    let chain = (0..6).map(|k| bar(vec2(fx!(0.5) + Fx::from(k), 4), fx!(1), fx!(0.2)));
    let ring = [vec2(10, 3), vec2(11, 3), vec2(11, 4), vec2(10, 4)].map(|place| disc(place, fx!(0.3)));
    let car = [
        bar(vec2(16, fx!(0.8)), fx!(2.4), fx!(0.5)),
        disc(vec2(15, fx!(0.4)), fx!(0.4)),
        disc(vec2(17, fx!(0.4)), fx!(0.4)),
    ];
    let gears = [disc(vec2(21, 4), fx!(0.4)), disc(vec2(22, 4), fx!(0.4))];
    let hoist = [disc(vec2(25, 2), fx!(0.4)), bar(vec2(27, 2), fx!(0.6), fx!(0.6))];
    let sled = [bar(vec2(31, 1), fx!(1), fx!(0.3)), disc(vec2(31, 2), fx!(0.3))];
    let rain = (0..12).map(|k| disc(vec2(fx!(2.7) * k + fx!(0.4), 6), fx!(0.25)));
    defs.extend(chain.chain(ring).chain(car).chain(gears).chain(hoist).chain(sled).chain(rain));
    for (def, key) in defs.iter_mut().zip(1..) {
        def.key = key;
    }
    let ids: Vec<BodyId> = defs.iter().map(|def| add(&mut world, def.clone())).collect();
    let revolute = |revolute: Revolute| JointKind::Revolute(revolute);
    let mut joints = Vec::new();
    let mut push = |joint: Result<JointDef, Error>, kind: JointKind| {
        let key = joints.len() as u64;
        joints.push(JointDef { kind, key, ..joint.expect("points of both") });
    };
    for k in 0..6_usize {
        let before = k.checked_sub(1).map(|before| ids[1 + before]);
        let limits = range(fx!(-0.4), fx!(0.4));
        let hinge = JointDef::at(&world, before, ids[1 + k], vec2(k as i32, 4));
        push(hinge, revolute(Revolute { limits, friction: fx!(0.5), ..Revolute::default() }));
    }
    for k in 0..4_usize {
        let (from, to) = (ids[7 + k], ids[7 + (k + 1) % 4]);
        let places = [vec2(10, 3), vec2(11, 3), vec2(11, 4), vec2(10, 4)];
        push(
            JointDef::between(&world, from, places[k], to, places[(k + 1) % 4]),
            JointKind::Distance(Distance::rod(fx!(1))),
        );
    }
    let spring = Some(JointSpring::new(fx!(3), fx!(0.7)));
    let motor = Some(JointMotor { speed: fx!(-6), max_force: fx!(3) });
    for (tyre, x) in [(ids[12], 15), (ids[13], 17)] {
        let axle = JointDef::along(&world, ids[11], tyre, vec2(x, fx!(0.4)), vec2(0, 1));
        push(axle, JointKind::Wheel(Wheel { limits: range(fx!(-0.2), fx!(0.2)), spring, motor, ..Wheel::default() }));
    }
    for (gear, x) in [(ids[14], 21), (ids[15], 22)] {
        let ratchet = (x == 21).then_some(12);
        push(
            JointDef::at(&world, None, gear, vec2(x, 4)),
            revolute(Revolute { motor, ratchet, ..Revolute::default() }),
        );
    }
    let gear = JointDef::gear(&world, ids[14], ids[15], [12, 36]).expect("a gear");
    push(Ok(gear), gear.kind);
    let rope =
        JointDef::pulley(&world, [ids[16], ids[17]], [vec2(25, 2), vec2(27, 2)], [vec2(25, 8), vec2(27, 8)], [1, 1]);
    let rope = rope.expect("a rope");
    push(Ok(rope), rope.kind);
    let rail = JointDef::along(&world, None, ids[18], vec2(31, 1), vec2(1, 0));
    push(rail, JointKind::Prismatic(Prismatic { limits: range(fx!(-1), fx!(1)), motor, ..Prismatic::default() }));
    push(JointDef::at(&world, ids[18], ids[19], vec2(31, fx!(1.5))), JointKind::Weld(Weld { spring }));
    let friction = Some(PlanarMotor { velocity: vec2(0, 0), max_force: fx!(2) });
    push(
        JointDef::at(&world, None, ids[20], vec2(0, 6)),
        JointKind::Motor(Motor { motor: friction, ..Motor::default() }),
    );
    (defs, joints)
}

/// The world of these bodies and joints, added in an order by a seed.
fn shuffled(defs: &[BodyDef], joints: &[JointDef], seed: Option<u64>) -> World {
    let (mut bodies, mut links): (Vec<usize>, Vec<usize>) = ((0..defs.len()).collect(), (0..joints.len()).collect());
    if let Some(seed) = seed {
        let mut random = Random::seeded(run_seed(seed));
        random.shuffle(&mut bodies);
        random.shuffle(&mut links);
    }
    let mut world = falling();
    let mut ids = vec![BodyId::from_parts(0, 0); defs.len()];
    for place in bodies {
        ids[place] = add(&mut world, defs[place].clone());
    }
    for link in links {
        let ends = joints[link].ends.map(|end| match end {
            End::Body(attachment) => {
                End::Body(Attachment { body: ids[attachment.body.parts().0 as usize], ..attachment })
            }
            End::World(point) => End::World(point),
        });
        world.add_joint(JointDef { ends, ..joints[link] }).expect("a joint");
    }
    world
}

/// Machines of all kinds of joints with weights that fall on them have the same motion to the bit in whatever order bodies and joints are added.
/// <https://github.com/newton-physics/newton/issues/910>, <https://github.com/dimforge/bevy_rapier/issues/233>
#[test]
fn the_order_of_joints_changes_no_machine() {
    let (defs, joints) = machines();
    let mut world = shuffled(&defs, &joints, None);
    let mut twins = [1, 2, 3].map(|seed| shuffled(&defs, &joints, Some(seed)));
    for tick in 0..240 {
        world.step();
        for twin in &mut twins {
            twin.step();
            assert_eq!(twin.physics_hash(), world.physics_hash(), "tick {tick}");
        }
    }
    assert!(twins.iter().all(|twin| twin.state_hash() != world.state_hash()));
}

/// Bodies at any angles are joined as they stand, at their centres: hinges with limits, with a spring, welds and sliders have nothing to do, and do
/// nothing to the bit in the first step. The pose is the zero of the limits.
#[test]
fn a_joint_between_bodies_at_any_angles_has_no_impulse() {
    let mut random = Random::seeded(run_seed(7));
    let spring = Some(JointSpring::new(fx!(5), fx!(0.5)));
    let kinds = [
        JointKind::Revolute(Revolute { limits: range(fx!(-0.5), fx!(0.5)), ..Revolute::default() }),
        JointKind::Revolute(Revolute { limits: range(fx!(0), fx!(0.5)), ..Revolute::default() }),
        JointKind::Revolute(Revolute { limits: range(fx!(0), fx!(0)), spring, ..Revolute::default() }),
        JointKind::Weld(Weld::default()),
        JointKind::Prismatic(Prismatic { limits: range(fx!(0), fx!(1)), spring, ..Prismatic::default() }),
        JointKind::Wheel(Wheel { limits: range(fx!(-1), fx!(0)), spring, ..Wheel::default() }),
    ];
    for _ in 0..500 {
        let angles = [0; 2].map(|_| random.number(fx!(-100)..=fx!(100)));
        for kind in kinds {
            let mut world = still();
            let place = vec2(1, 2);
            let bodies = angles.map(|angle| add(&mut world, BodyDef { angle, ..solid(place, fx!(1)) }));
            let joint = match kind {
                JointKind::Revolute(_) | JointKind::Weld(_) => JointDef::at(&world, bodies[0], bodies[1], place),
                _ => JointDef::along(&world, bodies[0], bodies[1], place, vec2(3, 1)),
            };
            let joint = join(&mut world, joint, kind);
            world.step();
            assert_eq!(bodies.map(|body| speed(&world, body)), [0.0; 2], "{angles:?}, {kind:?}");
            let joint = world.joint(joint).expect("a joint");
            assert_eq!((joint.force(), joint.torque()), (vec2(0, 0), fx!(0)), "{angles:?}, {kind:?}");
        }
    }
}
