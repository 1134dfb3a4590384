//! Joints of worlds in floats: closed forms, and what joints of worlds in [`Fx`] keep.

use umbra_physics::scalar::ToF64;
use umbra_physics::{
    Activity, BodyDef, BodyId, ColliderDef, Damping, Distance, Fx, Geometry, JointDef, JointId, JointKind, JointLimits,
    JointMotor, JointRef, JointSpring, Mass, Material, Prismatic, Revolute, Scalar, Shape, TimeStep, Vec2, Weld, Wheel,
    World, WorldDef, fx,
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
        assert!(stretch.abs() < 0.013 && (force - 1.0).abs() < 0.001, "{stretch} {force}");
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
    assert!(measures.into_iter().all(|share| (share - 1.0).abs() < 0.003), "{measures:?}");
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
    for ([early, reached, kept, torque, stalled], error) in measures.into_iter().zip([1e-6, 1e-9, 1e-5]) {
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

/// A wheel on a spring of 2 Hz, let go at 1 rad: the largest distance from what period and decay make of two angles before, 10 ticks apart each,
/// in 3 s. (Its phase is half a sub-step ahead, as velocities of sub-steps of semi-implicit Euler are.)
fn springs<S: Real>(ratio: Fx) -> f64 {
    let mut world = world::<S>(fx!(0));
    let wheel = body(&mut world, [fx!(0), fx!(0)], fx!(1), fx!(0.5));
    let rest = S::from_fx(fx!(-1));
    let spring = Some(JointSpring { rest, ..spring(fx!(2), ratio) });
    hinge(&mut world, wheel, [fx!(0), fx!(0)], Revolute { spring, ..Revolute::default() });
    let angles: Vec<f64> = (0..180)
        .map(|_| {
            world.step();
            let angle = motion(&world, wheel)[2];
            if angle > std::f64::consts::PI { angle - std::f64::consts::TAU + 1.0 } else { angle + 1.0 }
        })
        .collect();
    let (way, zeta) = (2.0 * std::f64::consts::TAU / 6.0, ratio.to_f64());
    let (decay, turn) = ((-zeta * way).exp(), (way * (1.0 - zeta * zeta).sqrt()).cos());
    let errors = (20..180).map(|tick| {
        let expected = 2.0 * decay * turn * angles[tick - 10] - decay * decay * angles[tick - 20];
        (angles[tick] - expected).abs()
    });
    errors.fold(0.0, f64::max)
}

#[test]
fn a_spring_has_its_period_and_decay() {
    for ratio in [fx!(0), fx!(0.1), fx!(0.7)] {
        let measures = [springs::<Fx>(ratio), springs::<f64>(ratio), springs::<f32>(ratio)];
        println!("springs {ratio}: {measures:?}");
        assert!(measures.into_iter().zip([1e-5, 1e-9, 1e-4]).all(|(farthest, limit)| farthest < limit), "{measures:?}");
    }
}

/// A sled on a slope of 45°, without friction and with friction of 2 N: the way over ½·a·t² in a second, and the distance from the slope, m.
fn sliders<S: Real>(friction: Fx) -> [f64; 2] {
    let mut world = world::<S>(fx!(-10));
    let sled = body(&mut world, [fx!(1), fx!(2)], fx!(2), fx!(0.1));
    let def = JointDef::along(&world, None, sled, vec(fx!(1), fx!(2)), vec(fx!(1), fx!(-1))).expect("a joint");
    let kind = JointKind::Prismatic(Prismatic { friction: S::from_fx(friction), ..Prismatic::default() });
    let joint = world.add_joint(JointDef { kind, ..def }).expect("a joint");
    steps(&mut world, 60);
    let way = world.joint(joint).expect("a joint").translation().to_f64();
    let acceleration = 10.0 * std::f64::consts::FRAC_1_SQRT_2 - friction.to_f64() / 2.0;
    let [x, y, ..] = motion(&world, sled);
    [way / (acceleration / 2.0), x + y - 3.0]
}

/// A body of 100 kg on two wheels of 10 kg that are held by the world: how far the springs give way, over F/k, m.
fn wheels<S: Real>() -> f64 {
    let mut world = world::<S>(fx!(-10));
    let car = body(&mut world, [fx!(0), fx!(1)], fx!(100), fx!(40));
    let mut joints = Vec::new();
    for x in [fx!(-1), fx!(1)] {
        let wheel = body(&mut world, [x, fx!(0.5)], fx!(10), fx!(1));
        let def = JointDef::along(&world, car, wheel, vec(x, fx!(0.5)), vec(fx!(0), fx!(1))).expect("a joint");
        let kind = JointKind::Wheel(Wheel { spring: Some(spring(fx!(3), fx!(0.7))), ..Wheel::default() });
        joints.push(world.add_joint(JointDef { kind, ..def }).expect("a joint"));
        hinge(&mut world, wheel, [x, fx!(0.5)], Revolute::default());
    }
    steps(&mut world, 600);
    let sag =
        joints.iter().map(|&joint| world.joint(joint).expect("a joint").translation().to_f64()).sum::<f64>() / 2.0;
    // 1/m = 1/100 + 1/10 + 1²/40
    let stiffness = (3.0 * std::f64::consts::TAU).powi(2) / (0.01 + 0.1 + 0.025);
    sag / (500.0 / stiffness)
}

/// A shelf of ten planks of 1 m that are welded to each other and to a wall: the torque of the first weld over the moment of the load, and how far the
/// last plank sinks, m.
fn welds<S: Real>() -> [f64; 2] {
    let mut world = world::<S>(fx!(-10));
    let (mut last, mut joints) = (None, Vec::new());
    for i in 0..10 {
        let plank = body(&mut world, [fx!(0.5) + fx!(1) * i, fx!(0)], fx!(1), fx!(0.09));
        let def = JointDef::at(&world, last, plank, vec(fx!(1) * i, fx!(0))).expect("a joint");
        let kind = JointKind::Weld(Weld::default());
        joints.push(world.add_joint(JointDef { kind, ..def }).expect("a joint"));
        last = Some(plank);
    }
    steps(&mut world, 600);
    let torque = world.joint(joints[0]).expect("a joint").torque().to_f64();
    [torque / 500.0, -motion(&world, last.expect("a plank"))[1]]
}

/// A motor of 3 N·m on a wheel of 2 kg·m² with 12 teeth that turns one of 0.25 kg·m² with 6: speeds after a second over the closed form.
fn gears<S: Real>() -> [f64; 2] {
    let mut world = world::<S>(fx!(0));
    let [first, second] = [(fx!(0), fx!(2)), (fx!(3), fx!(0.25))].map(|(x, inertia)| {
        let wheel = body(&mut world, [x, fx!(0)], fx!(1), inertia);
        let drive = (x == fx!(0)).then(|| motor(fx!(100), fx!(3)));
        hinge(&mut world, wheel, [x, fx!(0)], Revolute { motor: drive, ..Revolute::default() });
        wheel
    });
    let gear = JointDef::gear(&world, first, second, [12, 6]).expect("a joint");
    world.add_joint(gear).expect("a joint");
    steps(&mut world, 60);
    // The second wheel is 2² times as heavy at the first one.
    [motion(&world, first)[5], motion(&world, second)[5] / -2.0]
}

/// Atwood's machine with 1 kg and 3 kg: the speed after a second over g·(m₂ − m₁)/(m₁ + m₂), and the force of the rope over its own.
fn pulleys<S: Real>() -> [f64; 2] {
    let mut world = world::<S>(fx!(-10));
    let bodies = [(fx!(0), fx!(1)), (fx!(3), fx!(3))].map(|(x, mass)| body(&mut world, [x, fx!(0)], mass, mass));
    let points = [fx!(0), fx!(3)].map(|x| vec(x, fx!(0)));
    let grounds = [fx!(0), fx!(3)].map(|x| vec(x, fx!(8)));
    let rope = JointDef::pulley(&world, bodies, points, grounds, [1, 1]).expect("a joint");
    let rope = world.add_joint(rope).expect("a joint");
    steps(&mut world, 60);
    let force = world.joint(rope).expect("a joint").force().y.to_f64();
    [motion(&world, bodies[0])[4] / 5.0, force / 15.0]
}

fn assert_ones(name: &str, measures: impl IntoIterator<Item = f64>, limit: f64) {
    for measure in measures {
        println!("{name} {measure}");
        assert!((measure - 1.0).abs() < limit, "{name}: {measure}");
    }
}

#[test]
fn sliders_wheels_and_welds_move_as_closed_forms_say() {
    for friction in [fx!(0), fx!(2)] {
        let measures = [sliders::<Fx>(friction), sliders::<f64>(friction), sliders::<f32>(friction)];
        assert_ones("slider", measures.map(|[way, _]| way), 0.01);
        assert!(measures.into_iter().all(|[_, off]| off.abs() < 1e-4), "{measures:?}");
    }
    assert_ones("wheel", [wheels::<Fx>(), wheels::<f64>(), wheels::<f32>()], 1e-4);
    let measures = [welds::<Fx>(), welds::<f64>(), welds::<f32>()];
    println!("welds {measures:?}");
    assert_ones("weld", measures.map(|[torque, _]| torque), 1e-3);
    assert!(measures.into_iter().all(|[_, sag]| sag.abs() < 0.02), "{measures:?}");
}

#[test]
fn gears_and_pulleys_move_as_closed_forms_say() {
    for [first, second] in [gears::<Fx>(), gears::<f64>(), gears::<f32>()] {
        assert_ones("gear", [first, second], 1e-5);
    }
    for measures in [pulleys::<Fx>(), pulleys::<f64>(), pulleys::<f32>()] {
        assert_ones("pulley", measures, 1e-5);
    }
}

/// Returns true if a rod that bears 10 N breaks at a force.
fn breaks<S: Real>(force: Fx) -> bool {
    let mut world = world::<S>(fx!(-10));
    let load = body(&mut world, [fx!(0), fx!(-2)], fx!(1), fx!(1));
    let rod = JointDef::between(&world, None, vec(fx!(0), fx!(0)), load, vec(fx!(0), fx!(-2))).expect("a rod");
    let rod = JointDef { break_force: Some(S::from_fx(force)), events: true, ..rod };
    let rod = world.add_joint(rod).expect("a joint");
    let mut told = 0;
    for _ in 0..120 {
        let report = world.step();
        told += report.joints_broke.len();
        assert!(report.joints_broke.iter().all(|broke| (broke.force.y.to_f64() - 10.0).abs() < 1e-3));
    }
    let is_broken = world.joint(rod).expect("a joint").is_broken();
    assert_eq!(told, usize::from(is_broken));
    is_broken
}

#[test]
fn joints_break_at_their_force() {
    for is_broken in [breaks::<Fx>, breaks::<f64>, breaks::<f32>] {
        assert!(is_broken(fx!(9.8)) && !is_broken(fx!(10.2)));
    }
}

/// A ring of 12 rods that hangs at two points, whose bodies fall asleep: the widest gap at the end, m, and the number of bodies asleep.
fn ring<S: Real>() -> [f64; 2] {
    let mut world = world::<S>(fx!(-10));
    world.set_sleep_after(Some(30)).expect("a number");
    let place = |k: i32| {
        let angle = Fx::TAU * (k % 12) / 12;
        [angle.cos() * 3, angle.sin() * 3]
    };
    let bodies: Vec<BodyId> = (0..12).map(|k| body(&mut world, place(k), fx!(1), fx!(0.1))).collect();
    for k in 0..12 {
        let [from, to] = [k, k + 1].map(|k| vec(place(k)[0], place(k)[1]));
        let ends = [bodies[k as usize], bodies[(k as usize + 1) % 12]];
        let rod = JointDef::between(&world, ends[0], from, ends[1], to).expect("a rod");
        world.add_joint(rod).expect("a joint");
    }
    for k in [1, 5] {
        hinge(
            &mut world,
            bodies[k as usize],
            place(k),
            Revolute { friction: S::from_fx(fx!(1)), ..Revolute::default() },
        );
    }
    for &body in &bodies {
        let damping = Some(Damping::kept_per_second(S::from_fx(fx!(0.25))));
        world.set_body_damping(body, damping, damping).expect("a damping");
    }
    steps(&mut world, 1_800);
    let gap = |joint: JointRef<'_, S>| match joint.def().kind {
        JointKind::Distance(Distance { limits: Some(limits), .. }) => {
            (joint.length().to_f64() - limits.upper.to_f64()).abs()
        }
        _ => joint.length().to_f64(),
    };
    let asleep =
        bodies.iter().filter(|&&id| world.body(id).is_ok_and(|body| body.activity() == Activity::Asleep)).count();
    [world.joints().map(gap).fold(0.0, f64::max), asleep as f64]
}

#[test]
fn a_ring_holds_and_falls_asleep_as_a_whole() {
    let measures = [ring::<Fx>(), ring::<f64>(), ring::<f32>()];
    println!("ring {measures:?}");
    assert!(measures.into_iter().all(|[gap, asleep]| gap < 0.001 && asleep == 12.0), "{measures:?}");
}

/// A net of 10 × 10 bodies on rods of half a metre that hangs at its two upper corners: the widest gap in 10 s, and the highest speed
/// in the last second, m/s.
fn net<S: Real>() -> [f64; 2] {
    let mut world = world::<S>(fx!(-10));
    let place = |k: i32| [fx!(0.5) * (k % 10), fx!(0.5) * (k / 10)];
    let bodies: Vec<BodyId> = (0..100).map(|k| body(&mut world, place(k), fx!(1), fx!(0.1))).collect();
    let mut join = |from: i32, to: i32| {
        let points = [from, to].map(|k| vec(place(k)[0], place(k)[1]));
        let ends = [bodies[from as usize], bodies[to as usize]];
        let rod = JointDef::between(&world, ends[0], points[0], ends[1], points[1]).expect("a rod");
        world.add_joint(rod).expect("a joint");
    };
    for k in 0..100 {
        if k % 10 < 9 {
            join(k, k + 1);
        }
        if k < 90 {
            join(k, k + 10);
        }
    }
    for k in [90, 99] {
        hinge(&mut world, bodies[k as usize], place(k), Revolute::default());
    }
    let (mut widest, mut fastest) = (0.0_f64, 0.0_f64);
    for tick in 0..600 {
        world.step();
        let gaps = world.joints().map(|joint| match joint.def().kind {
            JointKind::Distance(_) => (joint.length().to_f64() - 0.5).abs(),
            _ => joint.length().to_f64(),
        });
        widest = gaps.fold(widest, f64::max);
        if tick >= 540 {
            let speeds = bodies.iter().map(|&id| motion(&world, id)[3].hypot(motion(&world, id)[4]));
            fastest = speeds.fold(fastest, f64::max);
        }
    }
    [widest, fastest]
}

/// Loops are springs with dampers in fixed point, and exact in floats.
#[test]
fn a_net_holds() {
    let measures = [net::<Fx>(), net::<f64>(), net::<f32>()];
    println!("net {measures:?}");
    for ([widest, fastest], gap) in measures.into_iter().zip([0.03, 0.002, 0.002]) {
        assert!(widest < gap && fastest < 0.5, "{measures:?}");
    }
}

/// A ball of 1 kg with 9 kg welded on top of it falls by a metre and bounces by half: the speeds at which ball and load rise, over half of the speed
/// of the fall.
fn rebound<S: Real>() -> [f64; 2] {
    let mut world = world::<S>(fx!(-10));
    let surface = |geometry: Geometry<S>, restitution: Fx| {
        let material = Material { restitution: S::from_fx(restitution), ..Material::default() };
        ColliderDef { material, ..ColliderDef::new(Shape::new(geometry).expect("a shape")) }
    };
    let ground = surface(Geometry::Rectangle { width: S::from_fx(fx!(40)), height: S::from_fx(fx!(2)) }, fx!(0));
    let ground = BodyDef { position: vec(fx!(0), fx!(-1)), colliders: vec![ground], ..BodyDef::fixed() };
    world.add_body(ground).expect("a body");
    let ball = surface(Geometry::Circle { radius: S::from_fx(fx!(0.5)) }, fx!(0.5));
    let mass = Mass::Explicit { mass: S::from_fx(fx!(1)), inertia: S::from_fx(fx!(0.1)) };
    let ball = BodyDef { position: vec(fx!(0), fx!(1.5)), mass, colliders: vec![ball], ..BodyDef::dynamic() };
    let ball = world.add_body(ball).expect("a body");
    let load = body(&mut world, [fx!(0), fx!(2.5)], fx!(9), fx!(1));
    let weld = JointDef::at(&world, ball, load, vec(fx!(0), fx!(2))).expect("a joint");
    world.add_joint(JointDef { kind: JointKind::Weld(Weld::default()), ..weld }).expect("a joint");
    let mut fastest = [0.0_f64; 2];
    for _ in 0..60 {
        world.step();
        for (fastest, id) in fastest.iter_mut().zip([ball, load]) {
            *fastest = fastest.max(motion(&world, id)[4]);
        }
    }
    fastest.map(|speed| speed / (20_f64.sqrt() / 2.0))
}

/// Worlds of floats return a share of the impulse of the step in which bodies meet: the load takes some of it in the steps after that.
#[test]
fn joined_bodies_bounce_as_a_whole() {
    let measures = [rebound::<Fx>(), rebound::<f64>(), rebound::<f32>()];
    println!("rebound {measures:?}");
    for ([ball, load], least) in measures.into_iter().zip([0.95, 0.35, 0.35]) {
        assert!((least..1.05).contains(&ball) && (ball - load).abs() < 0.03, "{measures:?}");
    }
}
