//! Springs by stiffness, N/m or N·m/rad, and damping, N·s/m or N·m·s/rad.

use core::f64::consts::TAU;

use super::scenes::{falling, steps, still};
use umbra_physics::scalar::ToF64;
use umbra_physics::{
    BodyDef, BodyId, Distance, Error, Fx, FxFactor, JointDef, JointKind, JointRef, JointSpring, Mass, Motor,
    PlanarSpring, Prismatic, Quantity, Revolute, Vec2, Weld, Wheel, World, fx, vec2,
};

fn add(world: &mut World, position: Vec2, mass: i32, inertia: impl Into<Fx>) -> BodyId {
    let mass = Mass::Explicit { mass: Fx::from(mass), inertia: inertia.into() };
    world.add_body(BodyDef { position, mass, ..BodyDef::dynamic() }).expect("a body")
}

/// The kinds of joints that have a spring, with this one.
fn kinds(spring: JointSpring) -> [JointKind; 6] {
    let JointSpring { hertz, damping_ratio, rest, .. } = spring;
    let planar = Some(PlanarSpring::new(vec2(rest, 0), hertz, damping_ratio));
    let spring = Some(spring);
    [
        JointKind::Distance(Distance { spring, ..Distance::default() }),
        JointKind::Prismatic(Prismatic { spring, ..Prismatic::default() }),
        JointKind::Wheel(Wheel { spring, ..Wheel::default() }),
        JointKind::Motor(Motor { spring: planar, ..Motor::default() }),
        JointKind::Revolute(Revolute { spring, ..Revolute::default() }),
        JointKind::Weld(Weld { spring }),
    ]
}

/// Springs of these kinds: by stiffness, damping and rest, for the mass that the joint meets.
fn with_stiffness(world: &World, joint: JointDef, number: usize, values: [Fx; 3]) -> JointDef {
    let [stiffness, damping, rest] = values;
    let plain = JointDef { kind: kinds(JointSpring::new(fx!(1), fx!(1)))[number], ..joint };
    let mass = plain.effective_mass(world).expect("a mass");
    let spring = JointSpring::with_stiffness(stiffness, damping, mass).expect("a fair spring");
    JointDef { kind: kinds(JointSpring { rest, ..spring })[number], ..joint }
}

/// A body that hangs below the world, or beside it where the joint turns, on a spring of each kind: F = k·x, with the load in the spring's force.
#[test]
fn a_load_stretches_a_spring_by_its_stiffness() {
    let values = [(1, fx!(40), fx!(9)), (8, fx!(500), fx!(100)), (300, fx!(20_000), fx!(4000))];
    for (mass, stiffness, damping) in values {
        for number in 0..6 {
            let (mut world, turns) = (falling(), number >= 4);
            world.set_sleep_after(None).expect("no sleep");
            let body = add(&mut world, if turns { vec2(1, 0) } else { vec2(0, -1) }, mass, 1);
            let joint = match number {
                0 => JointDef::between(&world, None, vec2(0, 0), body, vec2(0, -1)),
                _ if turns => JointDef::at(&world, None, body, vec2(0, 0)),
                _ => JointDef::along(&world, None, body, vec2(0, -1), vec2(0, -1)),
            };
            let rest = if number == 0 { fx!(1) } else { fx!(0) };
            let joint = with_stiffness(&world, joint.expect("a joint"), number, [stiffness, damping, rest]);
            let joint = world.add_joint(joint).expect("a fair joint");
            steps(&mut world, 1200);
            let joint: JointRef = world.joint(joint).expect("a joint");
            let load = f64::from(mass) * 10.0;
            let (stretch, pull) = if turns {
                // The load is nearer to the pin where the arm is lower.
                (-joint.angle().to_f64(), load * joint.angle().to_f64().cos())
            } else {
                (joint.translation().to_f64() - rest.to_f64(), load)
            };
            let expected = pull / stiffness.to_f64();
            assert!((stretch / expected - 1.0).abs() < 1e-4, "{mass} kg, {number}: {stretch}, not {expected}");
        }
    }
}

/// Two bodies that a spring joins swing against each other with 2π·√(μ/k), and lose the damper's part: e^(−c·t/2μ).
#[test]
fn two_bodies_swing_with_the_period_of_their_reduced_mass() {
    for (masses, stiffness, damping) in
        [([1, 1], fx!(50), fx!(0)), ([2, 6], fx!(300), fx!(0.3)), ([50, 1], fx!(9), fx!(0.1))]
    {
        let mut world = still();
        world.set_sleep_after(None).expect("no sleep");
        let [first, second] = [0, 1].map(|i| add(&mut world, vec2(3 * i, 0), masses[i as usize], 1));
        let joint = JointDef::between(&world, first, vec2(0, 0), second, vec2(3, 0)).expect("a joint");
        let joint = with_stiffness(&world, joint, 0, [stiffness, damping, fx!(2.5)]);
        let reduced = 1.0 / masses.map(|mass| 1.0 / f64::from(mass)).iter().sum::<f64>();
        let effective = joint.effective_mass(&world).expect("a mass").to_f64();
        assert!((effective / reduced - 1.0).abs() < 1e-9, "{effective}");
        let joint = world.add_joint(joint).expect("a fair joint");
        let (k, c) = (stiffness.to_f64(), damping.to_f64());
        let decay = c / (2.0 * reduced);
        let rate = (k / reduced - decay * decay).sqrt();
        // The times at which it goes through its rest outwards, in between steps, and its amplitude at the step before.
        let stretch = |world: &World| world.joint(joint).expect("a joint").length().to_f64() - 2.5;
        let (mut last, mut times, mut amplitudes) = (stretch(&world), Vec::new(), Vec::new());
        for tick in 1..=1800 {
            world.step();
            let now = stretch(&world);
            if last < 0.0 && now >= 0.0 {
                let before = f64::from(tick - 1) / 60.0;
                let (part, amplitude) = crossing([last, now * (decay / 60.0).exp()], rate / 60.0);
                times.push(before + part / 60.0);
                amplitudes.push((before, amplitude));
            }
            last = now;
        }
        let periods = times.len() - 1;
        let period = (times[periods] - times[0]) / periods as f64;
        let expected = TAU / rate;
        assert!(periods > 10 && (period / expected - 1.0).abs() < 1e-4, "{masses:?}: {period} s, not {expected}");
        let [(start, first), (end, last)] = [amplitudes[0], amplitudes[periods]];
        let (left, expected) = (last / first, (-decay * (end - start)).exp());
        assert!((left / expected - 1.0).abs() < 3e-4, "{masses:?}: {left}, not {expected}");
    }
}

/// The part of a step of this phase, rad, after which a sine through these two values is 0, and its amplitude.
fn crossing([before, after]: [f64; 2], phase: f64) -> (f64, f64) {
    // sin(a) : sin(phase − a) = −before : after
    let (sine, cosine) = (-before * phase.sin(), after - before * phase.cos());
    (sine.atan2(cosine) / phase, sine.hypot(cosine) / phase.sin())
}

/// f = √(k/m)/2π and ζ = c/(2·√(k·m)), rounded once.
#[test]
fn frequency_and_ratio_are_the_nearest() {
    let values = [fx!(0.001), fx!(0.37), fx!(1), fx!(17), fx!(500), fx!(123_456.789), fx!(2_000_000)];
    let mut count = 0;
    for stiffness in values {
        for damping in values {
            for mass in values {
                let (k, c, m) = (stiffness.to_f64(), damping.to_f64(), mass.to_f64());
                let (hertz, ratio) = ((k / m).sqrt() / TAU, c / (2.0 * (k * m).sqrt()));
                let spring = JointSpring::<Fx>::with_stiffness(stiffness, damping, mass.into());
                if ratio > 1024.0 {
                    assert_eq!(spring, Err(Error::OutOfRange { quantity: Quantity::DampingRatio }));
                    continue;
                }
                let spring = spring.expect("a fair spring");
                let ulps = |value: Fx, expected: f64| (value.to_bits() as f64 - expected * 4_294_967_296.0).abs();
                assert!(ulps(spring.hertz, hertz) < 0.51, "{stiffness} {mass}: {} {hertz}", spring.hertz);
                assert!(ulps(spring.damping_ratio, ratio) < 0.51, "{stiffness} {damping} {mass}");
                assert_eq!((spring.rest, spring.max_force), (fx!(0), None));
                count += 1;
            }
        }
    }
    assert!(count > 200, "{count}");
}

#[test]
fn springs_out_of_range_are_refused() {
    let spring = |stiffness: Fx, damping: Fx, mass: FxFactor| JointSpring::with_stiffness(stiffness, damping, mass);
    let refused = |quantity| Err(Error::OutOfRange { quantity });
    let unity = FxFactor::ONE;
    assert_eq!(spring(fx!(-1), fx!(0), unity), refused(Quantity::Stiffness));
    assert_eq!(spring(fx!(1), fx!(-1), unity), refused(Quantity::Drag));
    assert_eq!(spring(fx!(1), fx!(1), FxFactor::ZERO), refused(Quantity::SpringFrequency));
    // 10^6 Hz of 2^-32 kg have 9,191 N/m.
    let light = FxFactor::from(Fx::from_bits(1));
    assert!(spring(fx!(9191), fx!(0), light).is_ok());
    assert_eq!(spring(fx!(9192), fx!(0), light), refused(Quantity::SpringFrequency));
    assert_eq!(spring(Fx::MAX, fx!(0), light), refused(Quantity::SpringFrequency));
    assert_eq!(spring(fx!(0), fx!(1), unity), refused(Quantity::DampingRatio));
    assert!(spring(fx!(1), fx!(2048), unity).is_ok());
    assert_eq!(spring(fx!(1), fx!(2049), unity), refused(Quantity::DampingRatio));
    assert_eq!(spring(fx!(0), fx!(0), unity), Ok(JointSpring::new(fx!(0), fx!(0))));
    let planar = PlanarSpring::with_stiffness(vec2(1, 2), fx!(-1), fx!(0), unity);
    assert_eq!(planar, Err(Error::OutOfRange { quantity: Quantity::Stiffness }));
}

#[test]
fn a_joint_that_nothing_moves_has_no_effective_mass() {
    let mut world = still();
    let fixed = world.add_body(BodyDef::fixed()).expect("a body");
    let joint = JointDef::at(&world, None, fixed, vec2(0, 0)).expect("a joint");
    assert_eq!(joint.effective_mass(&world), Err(Error::NothingToMove));
    // Without a moment of inertia it does not turn.
    let point = world.add_body(BodyDef::dynamic()).expect("a body");
    let pin = JointDef::at(&world, None, point, vec2(0, 0)).expect("a joint");
    assert_eq!(pin.effective_mass(&world), Err(Error::NothingToMove));
    let rod = JointDef::between(&world, None, vec2(2, 0), point, vec2(0, 0)).expect("a joint");
    assert_eq!(rod.effective_mass(&world), Ok(FxFactor::ONE));
    let spring = JointKind::Distance(Distance::spring(fx!(1), fx!(1), fx!(0)));
    let none =
        JointDef { kind: spring, ..JointDef::between(&world, None, vec2(0, 0), point, vec2(0, 0)).expect("a joint") };
    assert_eq!(none.effective_mass(&world), Err(Error::OutOfRange { quantity: Quantity::JointLength }));
    // A disabled body meets it as it will once it takes part.
    world.disable(point).expect("a body");
    assert_eq!(rod.effective_mass(&world), Ok(FxFactor::ONE));
    world.remove_body(point).expect("a body");
    assert_eq!(rod.effective_mass(&world), Err(Error::NoSuchBody { body: point }));
}
