//! The energy that springs of joints hold.

use super::scenes::{falling, point_mass, steps};
use umbra_physics::scalar::ToF64;
use umbra_physics::{
    BodyDef, BodyId, Distance, Error, Fx, FxWide, JointDef, JointId, JointKind, JointSpring, Mass, Motor, PlanarSpring,
    Prismatic, Quantity, Revolute, Vec2, Weld, Wheel, World, WorldDef, fx, vec2,
};

const ULP: f64 = 1.0 / 4_294_967_296.0;

fn floating() -> World {
    World::new(WorldDef { sleep_after: None, ..WorldDef::default() }).expect("a world")
}

fn add(world: &mut World, position: Vec2, mass: i32, inertia: impl Into<Fx>) -> BodyId {
    let mass = Mass::Explicit { mass: Fx::from(mass), inertia: inertia.into() };
    world.add_body(BodyDef { position, mass, ..BodyDef::dynamic() }).expect("a body")
}

fn join(world: &mut World, joint: Result<JointDef, Error>, kind: JointKind) -> JointId {
    world.add_joint(JointDef { kind, ..joint.expect("a joint") }).expect("a fair joint")
}

/// A spring of 1.5 Hz without damping.
fn spring(rest: Fx) -> Option<JointSpring> {
    Some(JointSpring { rest, ..JointSpring::new(fx!(1.5), fx!(0)) })
}

fn distance(rest: Fx) -> JointKind {
    JointKind::Distance(Distance { spring: spring(rest), ..Distance::default() })
}

fn revolute(rest: Fx) -> JointKind {
    JointKind::Revolute(Revolute { spring: spring(rest), ..Revolute::default() })
}

/// The energy of a spring of 1.5 Hz with an effective mass, stretched by this.
fn closed_form(mass: f64, stretch: f64) -> f64 {
    let rate = core::f64::consts::TAU * 1.5;
    0.5 * mass * rate * rate * stretch * stretch
}

fn potential(world: &World) -> f64 {
    world.potential_energy().expect("a small energy").to_f64()
}

/// The energy of all springs of joints: what is missing when no joint is enabled.
fn spring_energy(world: &World) -> f64 {
    let mut without = world.clone();
    let joints: Vec<JointId> = world.joints().map(|joint| joint.id()).collect();
    joints.into_iter().for_each(|joint| without.enable_joint(joint, false).expect("a joint"));
    potential(world) - potential(&without)
}

#[test]
fn springs_hold_what_closed_forms_say() {
    let quarter = fx!(0.25);
    let prismatic = |rest: Fx| JointKind::Prismatic(Prismatic { spring: spring(rest), ..Prismatic::default() });
    let check = |name: &str, world: &World, mass: f64, stretch: f64| {
        let (energy, expected) = (potential(world), closed_form(mass, stretch));
        assert!(expected > 1.0 && (energy - expected).abs() < 4.0 * ULP, "{name}: {energy}, not {expected}");
        let joint = world.joints().next().expect("a joint");
        let effective = joint.def().effective_mass(world).expect("a mass").to_f64();
        assert!((effective / mass - 1.0).abs() < 4e-9, "{name}: {effective} kg, not {mass}");
    };
    for (rest, stretch) in [(fx!(2.5), 0.5), (fx!(4), -1.0)] {
        let mut world = floating();
        let body = add(&mut world, vec2(3, 0), 2, 1);
        let between = JointDef::between(&world, None, vec2(0, 0), body, vec2(3, 0));
        join(&mut world, between, distance(rest));
        check("a weight", &world, 2.0, stretch);
    }
    let mut world = floating();
    let [first, second] = [(0, 1), (4, 3)].map(|(x, mass)| add(&mut world, vec2(x, 0), mass, 1));
    let between = JointDef::between(&world, first, vec2(0, 0), second, vec2(4, 0));
    join(&mut world, between, distance(fx!(3)));
    check("two weights", &world, 0.75, 1.0);

    // 1/K = 1/(1/2 + 1²/0.5): it turns the body more than it moves it.
    let mut world = floating();
    let body = add(&mut world, vec2(3, 0), 2, fx!(0.5));
    let between = JointDef::between(&world, None, vec2(0, 1), body, vec2(3, 1));
    join(&mut world, between, distance(fx!(2)));
    check("beside the centre of mass", &world, 0.4, 1.0);

    for kind in [revolute(quarter), JointKind::Weld(Weld { spring: spring(quarter) })] {
        let mut world = floating();
        let body = add(&mut world, vec2(fx!(1.5), 0), 2, fx!(0.5));
        let pin = JointDef::at(&world, None, body, vec2(0, 0));
        join(&mut world, pin, kind);
        check("about a pin", &world, 0.5 + 2.0 * 2.25, 0.25);
    }
    // K = (I₁ + I₂ + μ|r₁ − r₂|²)/(I₁·I₂ + μ(I₁·r₂² + I₂·r₁²)) with arms of 1 and −2 m.
    let mut world = floating();
    let first = add(&mut world, vec2(0, 0), 2, 3);
    let second = add(&mut world, vec2(3, 0), 6, 4);
    let pin = JointDef::at(&world, first, second, vec2(1, 0));
    join(&mut world, pin, revolute(fx!(-0.5)));
    check("two bodies on a pin", &world, (12.0 + 1.5 * (3.0 * 4.0 + 4.0)) / (7.0 + 1.5 * 9.0), 0.5);

    let mut world = floating();
    let body = add(&mut world, vec2(1, 1), 3, 1);
    let rail = JointDef::along(&world, None, body, vec2(1, 1), vec2(0, -1));
    join(&mut world, rail, prismatic(fx!(-0.5)));
    check("on a rail", &world, 3.0, 0.5);
    // The slide also moves both bodies about each other: μ·I/(I + μ·D²).
    let mut world = floating();
    let first = add(&mut world, vec2(0, 0), 2, fx!(0.5));
    let second = add(&mut world, vec2(0, 2), 2, fx!(0.5));
    let rail = JointDef::along(&world, first, second, vec2(0, 1), vec2(1, 0));
    join(&mut world, rail, prismatic(fx!(2)));
    check("two bodies on a rail", &world, 0.2, 2.0);
    // A spring to a point pulls as far as the point is away.
    let mut world = floating();
    let body = add(&mut world, vec2(3, 0), 2, 1);
    let target = PlanarSpring::new(vec2(fx!(2.4), fx!(0.8)), fx!(1.5), fx!(0));
    let between = JointDef::between(&world, None, vec2(0, 0), body, vec2(3, 0));
    join(&mut world, between, JointKind::Motor(Motor { spring: Some(target), ..Motor::default() }));
    check("to a point", &world, 2.0, 1.0);
    // The hub is beside the centre of the chassis.
    let mut world = floating();
    let chassis = add(&mut world, vec2(0, 0), 4, 2);
    let wheel = add(&mut world, vec2(1, fx!(-0.5)), 1, 1);
    let axle = JointDef::along(&world, chassis, wheel, vec2(1, fx!(-0.5)), vec2(0, 1));
    join(&mut world, axle, JointKind::Wheel(Wheel { spring: spring(fx!(1)), ..Wheel::default() }));
    check("a suspension", &world, 1.0 / (0.25 + 0.5 + 1.0), 1.0);
}

/// The stretch of a torsion spring counts whole turns.
#[test]
fn whole_turns_count() {
    let mut world = floating();
    let wheel = add(&mut world, vec2(0, 0), 1, 2);
    let pin = JointDef::at(&world, None, wheel, vec2(0, 0));
    let slow = Some(JointSpring { rest: fx!(1), ..JointSpring::new(fx!(0.01), fx!(0)) });
    let joint = join(&mut world, pin, JointKind::Revolute(Revolute { spring: slow, ..Revolute::default() }));
    world.set_angular_velocity(wheel, fx!(9)).expect("a speed");
    steps(&mut world, 300);
    let angle = world.joint(joint).expect("a joint").angle().to_f64();
    let rate = core::f64::consts::TAU * 0.01_f64;
    let expected = 0.5 * 2.0 * (Fx::from_ratio(1, 100).to_f64() / 0.01 * rate).powi(2) * (angle - 1.0).powi(2);
    assert!(
        angle > 40.0 && (potential(&world) - expected).abs() < 4.0 * ULP,
        "{angle}: {} {expected}",
        potential(&world)
    );
}

/// A spring at its largest force F holds ½·F²/k + F·(x − F/k): a straight line on from the parabola.
#[test]
fn a_spring_at_its_largest_force_holds_a_line() {
    let stiffness = 2.0 * (core::f64::consts::TAU * 1.5).powi(2);
    let held = |stretch: Fx, max_force: Option<Fx>| {
        let mut world = floating();
        let body = add(&mut world, vec2(3, 0), 2, 1);
        let between = JointDef::between(&world, None, vec2(0, 0), body, vec2(3, 0));
        let spring = spring(fx!(3) - stretch).map(|spring| JointSpring { max_force, ..spring });
        join(&mut world, between, JointKind::Distance(Distance { spring, ..Distance::default() }));
        potential(&world)
    };
    // 177.65 N/m: 40 N at 0.2252 m.
    for stretch in [fx!(0.1), fx!(0.225), fx!(-0.225)] {
        assert_eq!(held(stretch, Some(fx!(40))), held(stretch, None), "{stretch}");
    }
    for stretch in [fx!(0.226), fx!(1), fx!(-1), fx!(3)] {
        let expected = 0.5 * 1600.0 / stiffness + 40.0 * (stretch.to_f64().abs() - 40.0 / stiffness);
        let energy = held(stretch, Some(fx!(40)));
        assert!(
            (energy - expected).abs() < 4.0 * ULP && energy < held(stretch, None),
            "{stretch}: {energy} {expected}"
        );
    }
    assert_eq!(held(fx!(1), Some(fx!(0))), 0.0);
    // The force of a spring to a point is as long as its bound.
    let mut world = floating();
    let body = add(&mut world, vec2(3, 0), 2, 1);
    let target = Motor::target(vec2(fx!(2.4), fx!(0.8)), fx!(1.5), fx!(0), fx!(40));
    let between = JointDef::between(&world, None, vec2(0, 0), body, vec2(3, 0));
    join(&mut world, between, JointKind::Motor(target));
    assert!((potential(&world) - held(fx!(1), Some(fx!(40)))).abs() < 100.0 * ULP, "{}", potential(&world));
}

/// A spring at rest, of no frequency, in a rigid rod, or with both ends at one point holds nothing; nor does one that steps do not keep.
#[test]
fn springs_that_do_nothing_hold_nothing() {
    let none = Ok(FxWide::default());
    let start = || {
        let mut world = floating();
        let body = add(&mut world, vec2(3, 0), 2, 1);
        let between = JointDef::between(&world, None, vec2(0, 0), body, vec2(3, 0));
        let joint = join(&mut world, between, distance(fx!(2)));
        (world, body, joint)
    };
    let (mut world, body, joint) = start();
    let full = world.potential_energy();
    assert_ne!(full, none);
    let mut with = |distance: Distance| {
        world.set_joint_kind(joint, JointKind::Distance(distance)).expect("a kind");
        world.potential_energy()
    };
    assert_eq!(with(Distance { spring: spring(fx!(3)), ..Distance::default() }), none);
    let limp = Some(JointSpring { rest: fx!(2), ..JointSpring::new(fx!(0), fx!(1)) });
    assert_eq!(with(Distance { spring: limp, ..Distance::default() }), none);
    assert_eq!(with(Distance { spring: spring(fx!(2)), ..Distance::rod(fx!(3)) }), none);
    assert_eq!(with(Distance { spring: spring(fx!(2)), ..Distance::rope(fx!(4)) }), full);
    world.set_position(body, vec2(0, 0)).expect("a position");
    assert_eq!(world.potential_energy(), none);

    let (mut world, body, joint) = start();
    world.enable_joint(joint, false).expect("a joint");
    assert_eq!(world.potential_energy(), none);
    world.enable_joint(joint, true).expect("a joint");
    assert_eq!(world.potential_energy(), full);
    world.disable(body).expect("a body");
    assert_eq!(world.potential_energy(), none);
    world.enable(body).expect("a body");
    assert_eq!(world.potential_energy(), full);
    world.set_joint_break(joint, Some(fx!(1))).expect("a joint");
    world.step();
    assert!(world.joint(joint).expect("a joint").is_broken());
    assert_eq!(world.potential_energy(), none);
    world.enable_joint(joint, true).expect("a joint");
    assert_ne!(world.potential_energy(), none);
    world.set_kind(body, umbra_physics::BodyKind::Static).expect("a body");
    assert_eq!(world.potential_energy(), none, "nothing that it moves");
}

/// A spring at 2^31 N over 2^30 m holds less than 2^61 J, and four of them less than 2^63.
#[test]
fn energies_beyond_the_range_are_refused() {
    let mut world = floating();
    let body = world.add_body(BodyDef { position: vec2(1 << 30, 0), ..BodyDef::dynamic() }).expect("a body");
    let fast = Some(JointSpring::new(fx!(1_000_000), fx!(0)));
    for count in 1..=5 {
        let between = JointDef::between(&world, None, vec2(0, 0), body, vec2(1 << 30, 0));
        join(&mut world, between, JointKind::Distance(Distance { spring: fast, ..Distance::default() }));
        let total = 2f64.powi(61) * f64::from(count);
        match world.energy() {
            Ok(energy) => assert!(count < 5 && (energy.to_f64() / total - 1.0).abs() < 1e-6, "{count}: {energy}"),
            error => assert_eq!((count >= 5, error), (true, Err(Error::OutOfRange { quantity: Quantity::Total }))),
        }
    }
}

/// A load at rest on springs has the force of their stiffness: they hold half of force times stretch, also where bodies give way by turning.
#[test]
fn the_stiffness_is_the_one_that_steps_use() {
    let damped = |rest: Fx| Some(JointSpring { rest, ..JointSpring::new(fx!(2), fx!(1)) });
    let check = |name: &str, world: &mut World, force_times_stretch: &dyn Fn(&World) -> f64| {
        world.set_sleep_after(None).expect("a number");
        steps(world, 1_800);
        let (energy, expected) = (spring_energy(world), force_times_stretch(world) / 2.0);
        assert!(expected > 0.1 && (energy / expected - 1.0).abs() < 1e-5, "{name}: {energy} J, not {expected}");
    };
    let mut world = falling();
    let plank = add(&mut world, vec2(0, 0), 3, 1);
    let axles = [-1, 1].map(|x| {
        let axle = JointDef::along(&world, None, plank, vec2(x, 0), vec2(0, 1));
        join(&mut world, axle, JointKind::Wheel(Wheel { spring: damped(fx!(0)), ..Wheel::default() }))
    });
    check("a plank on two springs that turn it too", &mut world, &|world| {
        let work = axles.map(|axle| {
            let axle = world.joint(axle).expect("a joint");
            -axle.force().y.to_f64() * axle.translation().to_f64()
        });
        work.iter().sum()
    });
    let mut world = falling();
    let first = add(&mut world, vec2(fx!(0.5), 0), 1, fx!(0.5));
    let second = add(&mut world, vec2(fx!(1.5), 0), 1, fx!(0.5));
    let flags = [(None, first, 0), (Some(first), second, 1)].map(|(from, to, x)| {
        let pin = JointDef::at(&world, from, to, vec2(x, 0));
        let kind = JointKind::Revolute(Revolute { spring: damped(fx!(0.3)), ..Revolute::default() });
        join(&mut world, pin, kind)
    });
    check("a flag on a flag on a wall", &mut world, &|world| {
        let work = flags.map(|flag| {
            let flag = world.joint(flag).expect("a joint");
            -flag.torque().to_f64() * (flag.angle().to_f64() - Fx::from_ratio(3, 10).to_f64())
        });
        work.iter().sum()
    });
    let mut world = falling();
    let lever = add(&mut world, vec2(1, 0), 2, fx!(0.3));
    let pin = JointDef::at(&world, None, lever, vec2(0, 0));
    world.add_joint(pin.expect("a joint")).expect("a fair joint");
    let chain = JointDef::between(&world, None, vec2(3, 2), lever, vec2(2, fx!(0.1)));
    let chain =
        join(&mut world, chain, JointKind::Distance(Distance { spring: damped(fx!(2)), ..Distance::default() }));
    check("a lever on a pin that a spring holds", &mut world, &|world| {
        let chain = world.joint(chain).expect("a joint");
        chain.force().length().to_f64() * (chain.length().to_f64() - 2.0)
    });
}

/// The largest change of energy in 10 s, and the drift: the change of its mean from the first four seconds to the last ones. Both are shares of the
/// largest energy that moves or is in springs.
fn changes(world: &mut World) -> [f64; 2] {
    let energy = |world: &World| world.energy().expect("a small energy").to_f64();
    let start = energy(world);
    let (mut changes, mut scale) = (Vec::new(), 0.0_f64);
    for _ in 0..600 {
        world.step();
        changes.push(energy(world) - start);
        scale = scale.max(spring_energy(world)).max(world.kinetic_energy().expect("a small energy").to_f64());
    }
    let mean = |changes: &[f64]| changes.iter().sum::<f64>() / changes.len() as f64;
    let largest = changes.iter().fold(0.0_f64, |largest, change| largest.max(change.abs()));
    [largest / scale, (mean(&changes[360..]) - mean(&changes[..240])) / scale]
}

/// An undamped spring gives back what it takes. Velocities are half a sub-step h ahead of positions, so at each moment the energy is off by
/// up to ½·ω·h of it: 0.26 % at 0.25 Hz, 4.3 % at 4 Hz. The mean over 10 s stays within 1.5·10^-7.
#[test]
fn undamped_springs_keep_energy() {
    for hertz in [fx!(0.25), fx!(1), fx!(4)] {
        let spring = |rest: Fx| Some(JointSpring { rest, ..JointSpring::new(hertz, fx!(0)) });
        let along = |rest: Fx| JointKind::Distance(Distance { spring: spring(rest), ..Distance::default() });
        let mut weight = floating();
        let body = point_mass(&mut weight, vec2(3, 0));
        let between = JointDef::between(&weight, None, vec2(0, 0), body, vec2(3, 0));
        join(&mut weight, between, along(fx!(2.5)));

        let mut pair = floating();
        let [first, second] = [(0, 1), (3, 3)].map(|(x, mass)| add(&mut pair, vec2(x, 0), mass, 1));
        let between = JointDef::between(&pair, first, vec2(0, 0), second, vec2(3, 0));
        join(&mut pair, between, along(fx!(2)));

        let mut wheel = floating();
        let body = add(&mut wheel, vec2(0, 0), 2, 1);
        let pin = JointDef::at(&wheel, None, body, vec2(0, 0));
        let kind = JointKind::Revolute(Revolute { spring: spring(fx!(0.5)), ..Revolute::default() });
        join(&mut wheel, pin, kind);

        let mut gate = floating();
        let body = add(&mut gate, vec2(1, 0), 2, 1);
        let pin = JointDef::at(&gate, None, body, vec2(0, 0));
        join(&mut gate, pin, JointKind::Weld(Weld { spring: spring(fx!(0.5)) }));

        let mut lift = falling();
        lift.set_sleep_after(None).expect("a number");
        let body = add(&mut lift, vec2(0, 0), 2, 1);
        let rail = JointDef::along(&lift, None, body, vec2(0, 0), vec2(1, 2));
        join(&mut lift, rail, JointKind::Prismatic(Prismatic { spring: spring(fx!(0.5)), ..Prismatic::default() }));

        let mut pendulum = falling();
        pendulum.set_sleep_after(None).expect("a number");
        let body = point_mass(&mut pendulum, vec2(3, 0));
        let between = JointDef::between(&pendulum, None, vec2(0, 0), body, vec2(3, 0));
        join(&mut pendulum, between, along(fx!(3)));

        // The gate's hinge is off its centre of mass, and gives way; the pendulum is pulled across its spring.
        let worlds = [
            ("weight", weight, 2e-7),
            ("pair", pair, 2e-7),
            ("wheel", wheel, 2e-7),
            ("lift", lift, 2e-7),
            ("gate", gate, 0.012),
            ("pendulum", pendulum, 3e-4),
        ];
        for (name, mut world, limit) in worlds {
            let [largest, drift] = changes(&mut world);
            let ahead = core::f64::consts::PI * hertz.to_f64() / 300.0;
            let wobble = (if name == "gate" { 1.5 } else { 1.04 }) * ahead;
            assert!(largest < wobble, "{name}, {hertz} Hz: {largest} of {wobble}");
            assert!(drift.abs() < limit, "{name}, {hertz} Hz: {drift}");
        }
    }
}
