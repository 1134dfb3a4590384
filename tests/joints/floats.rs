//! Joints of worlds in floats: closed forms, and what joints of worlds in [`Fx`] keep.

use umbra_physics::scalar::ToF64;
use umbra_physics::{
    BodyDef, BodyId, ColliderDef, Distance, Fx, Geometry, JointDef, JointId, JointKind, JointLimits, JointMotor,
    JointSpring, Mass, Prismatic, Revolute, Scalar, Shape, TimeStep, Vec2, Weld, Wheel, World, WorldDef, fx,
};

/// A float, or [`Fx`].
trait Real: Scalar<Angle: ToF64, Accumulator: ToF64> + ToF64 {}
impl<S: Scalar<Angle: ToF64, Accumulator: ToF64> + ToF64> Real for S {}

fn vec<S: Scalar>(x: Fx, y: Fx) -> Vec2<S> {
    Vec2::new(S::from_fx(x), S::from_fx(y))
}

/// A world of 60 steps a second in which nobody falls asleep.
fn world<S: Scalar>(gravity: Fx) -> World<S> {
    let def = WorldDef {
        gravity: vec(fx!(0), gravity),
        time_step: TimeStep::hz(60),
        sleep_after: None,
        ..WorldDef::default()
    };
    World::with_scalar(def).expect("a world")
}

fn body<S: Scalar>(world: &mut World<S>, position: [Fx; 2], mass: Fx, inertia: Fx) -> BodyId {
    let mass = Mass::Explicit { mass: S::from_fx(mass), inertia: S::from_fx(inertia) };
    let def = BodyDef { position: vec(position[0], position[1]), mass, ..BodyDef::dynamic() };
    world.add_body(def).expect("a body")
}

fn hinge<S: Scalar>(world: &mut World<S>, body: BodyId, point: [Fx; 2], revolute: Revolute<S>) -> JointId {
    let def = JointDef::at(world, None, body, vec(point[0], point[1])).expect("a joint");
    world.add_joint(JointDef { kind: JointKind::Revolute(revolute), ..def }).expect("a joint")
}

fn steps<S: Scalar>(world: &mut World<S>, count: usize) {
    (0..count).for_each(|_| _ = world.step());
}

/// Position, angle, velocity and angular velocity.
fn motion<S: Real>(world: &World<S>, id: BodyId) -> [f64; 6] {
    let body = world.body(id).expect("a body");
    let [at, velocity] = [body.position_exact(), body.velocity_exact()].map(|v| [v.x.to_f64(), v.y.to_f64()]);
    [at[0], at[1], body.angle_exact().to_f64(), velocity[0], velocity[1], body.angular_velocity_exact().to_f64()]
}

fn spring<S: Scalar>(hertz: Fx, damping_ratio: Fx) -> JointSpring<S> {
    let [hertz, damping_ratio] = [hertz, damping_ratio].map(S::from_fx);
    JointSpring { hertz, damping_ratio, rest: S::ZERO, max_force: None }
}

fn motor<S: Scalar>(speed: Fx, max_force: Fx) -> JointMotor<S> {
    JointMotor { speed: S::from_fx(speed), max_force: S::from_fx(max_force) }
}

/// The largest change of the energy of a pendulum of 1 m in 60 s, over m·g·l, and its period over the closed form.
fn pendulum<S: Real>() -> [f64; 2] {
    let mut world = world::<S>(fx!(-10));
    let bob = body(&mut world, [fx!(1), fx!(0)], fx!(1), fx!(0.01));
    let rod = JointDef::between(&world, None, vec(fx!(0), fx!(0)), bob, vec(fx!(1), fx!(0))).expect("a rod");
    world.add_joint(rod).expect("a rod");
    let (mut drift, mut crossings, mut before) = (0.0_f64, Vec::new(), 1.0);
    for tick in 1..=3_600 {
        world.step();
        let [x, y, _, vx, vy, _] = motion(&world, bob);
        drift = drift.max(((vx * vx + vy * vy) / 2.0 + 10.0 * y).abs() / 10.0);
        if x > 0.0 && before <= 0.0 {
            crossings.push((f64::from(tick) - x / (x - before)) / 60.0);
        }
        before = x;
    }
    let mean = (crossings[crossings.len() - 1] - crossings[0]) / (crossings.len() - 1) as f64;
    // 2π·√(l/g) over the arithmetic-geometric mean of 1 and cos(45°).
    let period = std::f64::consts::TAU * 0.1_f64.sqrt() * 1.180_340_599_016_096;
    [drift, mean / period]
}

#[test]
fn a_pendulum_keeps_energy_and_period() {
    let measures = [pendulum::<Fx>(), pendulum::<f64>(), pendulum::<f32>()];
    println!("pendulum {measures:?}");
    for [drift, period] in measures {
        assert!(drift < 0.01 && (period - 1.0).abs() < 0.001, "{drift} {period}");
    }
}

/// The stretch of a chain of 100 bars of 1 m, m, and the force on its first hinge over its weight.
fn hanging<S: Real>() -> [f64; 2] {
    let mut world = world::<S>(fx!(-10));
    let (mut last, mut joints) = (None, Vec::new());
    for i in 0..100 {
        let link = body(&mut world, [fx!(0), -(fx!(0.5) + fx!(1) * i)], fx!(0.2), fx!(0.02));
        let joint = JointDef::at(&world, last, link, vec(fx!(0), fx!(-1) * i)).expect("a joint");
        joints.push(world.add_joint(joint).expect("a joint"));
        last = Some(link);
    }
    steps(&mut world, 300);
    let tip = motion(&world, last.expect("a link"));
    let force = world.joint(joints[0]).expect("a joint").force().y.to_f64();
    [-99.5 - tip[1], force / 200.0]
}

#[test]
fn a_hanging_chain_of_100_stretches_little() {
    let measures = [hanging::<Fx>(), hanging::<f64>(), hanging::<f32>()];
    println!("chain {measures:?}");
    for [stretch, force] in measures {
        assert!(stretch.abs() < 0.001 && (force - 1.0).abs() < 0.001, "{stretch} {force}");
    }
}

/// The energy of a rod of 1 m that spins on a pin after 100 s, over its energy at the start.
fn spinning<S: Real>() -> f64 {
    let mut world = world::<S>(fx!(0));
    let rod = body(&mut world, [fx!(0.5), fx!(0)], fx!(1), Fx::from_ratio(1, 12));
    hinge(&mut world, rod, [fx!(0), fx!(0)], Revolute::default());
    world.set_velocity(rod, vec(fx!(0), fx!(5))).expect("a velocity");
    world.set_angular_velocity(rod, S::from_fx(fx!(10))).expect("a velocity");
    steps(&mut world, 6_000);
    let [.., vx, vy, spin] = motion(&world, rod);
    (vx * vx + vy * vy + spin * spin / 12.0) / (25.0 + 100.0 / 12.0)
}

#[test]
fn a_rod_that_spins_on_a_pin_keeps_its_energy() {
    let measures = [spinning::<Fx>(), spinning::<f64>(), spinning::<f32>()];
    println!("spinning {measures:?}");
    assert!(measures.into_iter().all(|share| (share - 1.0).abs() < 0.02), "{measures:?}");
}

/// A motor of 2 N·m and 1.01 rad/s on 1 kg·m²: the speed after 30 and 31 ticks, and 60; its torque at work; and the acceleration where a load
/// of 5 N·m turns it back.
fn motors<S: Real>() -> [f64; 5] {
    let mut world = world::<S>(fx!(0));
    let wheel = body(&mut world, [fx!(0), fx!(0)], fx!(1), fx!(1));
    let revolute = Revolute { motor: Some(motor(fx!(1.01), fx!(2))), ..Revolute::default() };
    let axle = hinge(&mut world, wheel, [fx!(0), fx!(0)], revolute);
    let speed = |world: &World<S>| motion(world, wheel)[5];
    steps(&mut world, 30);
    let torque = world.joint(axle).expect("a joint").torque().to_f64();
    let early = speed(&world);
    steps(&mut world, 1);
    let reached = speed(&world);
    steps(&mut world, 29);
    let kept = speed(&world);
    (0..60).for_each(|_| {
        world.apply_torque(wheel, S::from_fx(fx!(-5))).expect("a torque");
        world.step();
    });
    [early, reached, kept, torque, speed(&world) - kept]
}

#[test]
fn a_motor_reaches_its_speed_in_the_step_that_its_torque_allows_and_stalls_at_its_torque() {
    let measures = [motors::<Fx>(), motors::<f64>(), motors::<f32>()];
    println!("motors {measures:?}");
    for ([early, reached, kept, torque, stalled], error) in measures.into_iter().zip([1e-8, 1e-8, 1e-5]) {
        assert!((early - 1.0).abs() < error, "{early}");
        assert!((reached - 1.01).abs() < error && (kept - 1.01).abs() < error, "{reached} {kept}");
        assert!((torque - 2.0).abs() < error && (stalled + 3.0).abs() < error, "{torque} {stalled}");
    }
}

/// A bar of 1 m falls onto a limit of −30°: the farthest that it turns beyond it, rad; and where it rests, and its torque there.
fn limits<S: Real>() -> [f64; 3] {
    let mut world = world::<S>(fx!(-10));
    let bar = body(&mut world, [fx!(0.5), fx!(0)], fx!(1), Fx::from_ratio(1, 12));
    let [lower, upper] = [-Fx::PI / 6, fx!(1)].map(S::from_fx);
    let revolute = Revolute { limits: Some(JointLimits { lower, upper }), ..Revolute::default() };
    let joint = hinge(&mut world, bar, [fx!(0), fx!(0)], revolute);
    let angle = |world: &World<S>| world.joint(joint).expect("a joint").angle().to_f64() + std::f64::consts::FRAC_PI_6;
    let mut beyond = 0.0_f64;
    for _ in 0..300 {
        world.step();
        beyond = beyond.min(angle(&world));
    }
    [-beyond, angle(&world), world.joint(joint).expect("a joint").torque().to_f64()]
}

#[test]
fn a_limit_holds() {
    let measures = [limits::<Fx>(), limits::<f64>(), limits::<f32>()];
    println!("limits {measures:?}");
    let expected = 10.0 * 0.5 * std::f64::consts::FRAC_PI_6.cos();
    for [beyond, rest, torque] in measures {
        assert!(beyond < 1e-3 && rest.abs() < 1e-5 && (torque - expected).abs() < 1e-4, "{beyond} {rest} {torque}");
    }
}

/// A wheel on a spring of 2 Hz, let go at 1 rad without a speed: the largest distance from the closed form in 3 s.
fn springs<S: Real>(ratio: Fx) -> f64 {
    let mut world = world::<S>(fx!(0));
    let wheel = body(&mut world, [fx!(0), fx!(0)], fx!(1), fx!(0.5));
    let rest = S::from_fx(fx!(-1));
    let spring = Some(JointSpring { rest, ..spring(fx!(2), ratio) });
    hinge(&mut world, wheel, [fx!(0), fx!(0)], Revolute { spring, ..Revolute::default() });
    let (omega, zeta) = (2.0 * std::f64::consts::TAU, ratio.to_f64());
    let exact = |t: f64| {
        let damped = omega * (1.0 - zeta * zeta).sqrt();
        (-zeta * omega * t).exp() * ((damped * t).cos() + zeta * omega / damped * (damped * t).sin())
    };
    let mut farthest = 0.0_f64;
    for tick in 1..=180 {
        world.step();
        let angle = motion(&world, wheel)[2];
        let angle = if angle > std::f64::consts::PI { angle - std::f64::consts::TAU } else { angle };
        farthest = farthest.max((angle + 1.0 - exact(f64::from(tick) / 60.0)).abs());
    }
    farthest
}

#[test]
fn a_spring_has_its_period_and_decay() {
    for ratio in [fx!(0), fx!(0.1), fx!(0.7)] {
        let measures = [springs::<Fx>(ratio), springs::<f64>(ratio), springs::<f32>(ratio)];
        println!("springs {ratio}: {measures:?}");
        assert!(measures.into_iter().all(|farthest| farthest < 1e-4), "{measures:?}");
    }
}
