//! Worlds in floats: the closed forms of worlds in [`Fx`], and how far both are apart.

use umbra_physics::scalar::ToF64;
use umbra_physics::{
    BodyDef, BodyId, ColliderDef, Fx, Geometry, Mass, Material, Scalar, Shape, TimeStep, Vec2, World, WorldDef, fx,
};

/// A float, or [`Fx`].
trait Real: Scalar<Angle: ToF64, Accumulator: ToF64> + ToF64 {}
impl<S: Scalar<Angle: ToF64, Accumulator: ToF64> + ToF64> Real for S {}

fn of<S: Scalar>(value: Fx) -> S {
    S::from_fx(value)
}

fn vec<S: Scalar>(x: Fx, y: Fx) -> Vec2<S> {
    Vec2::new(of(x), of(y))
}

fn rectangle<S: Scalar>(width: Fx, height: Fx, surface: [Fx; 2]) -> ColliderDef<S> {
    collider(Geometry::Rectangle { width: of(width), height: of(height) }, surface)
}

fn collider<S: Scalar>(geometry: Geometry<S>, [friction, restitution]: [Fx; 2]) -> ColliderDef<S> {
    let material = Material { friction: of(friction), restitution: of(restitution), ..Material::default() };
    ColliderDef { material, ..ColliderDef::new(Shape::new(geometry).expect("a shape")) }
}

fn body<S: Scalar>(position: Vec2<S>, collider: ColliderDef<S>) -> BodyDef<S> {
    BodyDef { position, colliders: vec![collider], ..BodyDef::dynamic() }
}

/// The ground: its top is at height 0.
fn ground<S: Scalar>(surface: [Fx; 2]) -> BodyDef<S> {
    let collider = rectangle(fx!(100), fx!(2), surface);
    BodyDef { position: vec(fx!(0), fx!(-1)), colliders: vec![collider], ..BodyDef::fixed() }
}

fn square<S: Scalar>(x: Fx, y: Fx) -> BodyDef<S> {
    body(vec(x, y), rectangle(fx!(1), fx!(1), [fx!(0.6), fx!(0)]))
}

/// A world of 60 steps a second in which nobody falls asleep.
fn world<S: Scalar>(gravity: Fx, bodies: impl IntoIterator<Item = BodyDef<S>>) -> (World<S>, Vec<BodyId>) {
    let def = WorldDef {
        gravity: vec(fx!(0), gravity),
        time_step: TimeStep::hz(60),
        sleep_after: None,
        ..WorldDef::default()
    };
    let mut world = World::with_scalar(def).expect("a world");
    let ids = bodies.into_iter().map(|def| world.add_body(def).expect("a body")).collect();
    (world, ids)
}

/// Position, angle from −π to π, velocity and angular velocity.
fn motion<S: Real>(world: &World<S>, id: BodyId) -> [f64; 6] {
    let body = world.body(id).expect("a body");
    let [at, velocity] = [body.position_exact(), body.velocity_exact()].map(|v| [v.x.to_f64(), v.y.to_f64()]);
    let angle = body.angle_exact().to_f64();
    let turn = std::f64::consts::TAU;
    let angle = if angle > turn / 2.0 { angle - turn } else { angle };
    [at[0], at[1], angle, velocity[0], velocity[1], body.angular_velocity_exact().to_f64()]
}

fn pyramid<S: Scalar>(rows: i32) -> Vec<BodyDef<S>> {
    let mut bodies = vec![ground([fx!(0.6), fx!(0)])];
    for row in 0..rows {
        for i in 0..rows - row {
            let x = Fx::from_ratio((2 * i - (rows - row - 1)).into(), 2);
            bodies.push(square(x, Fx::from_ratio((2 * row + 1).into(), 2)));
        }
    }
    bodies
}

/// A box dropped from 2 m bounces to 2 m · e². Returns the height.
fn bounce<S: Real>() -> f64 {
    let surface = [fx!(0.6), fx!(0.5)];
    let falling = body(vec(fx!(0), fx!(2.5)), rectangle(fx!(1), fx!(1), surface));
    let (mut world, ids) = world::<S>(fx!(-10), [ground(surface), falling]);
    let (mut highest, mut has_bounced) = (0f64, false);
    for _ in 0..180 {
        world.step();
        let [x, y, angle, _, velocity, _] = motion(&world, ids[1]);
        assert!(x.abs() < 1e-4 && angle.abs() < 1e-3, "{} {x} {angle}", S::NAME);
        has_bounced |= velocity > 0.0;
        if has_bounced {
            highest = highest.max(y - 0.5);
        }
    }
    highest
}

#[test]
fn a_box_dropped_with_restitution_bounces() {
    for highest in [bounce::<f64>(), bounce::<f32>()] {
        assert!((highest - 0.5).abs() < 1e-3, "{highest}");
    }
}

/// Ten squares on each other for 5 s. Returns the motion of the top one.
fn stack<S: Real>() -> [f64; 6] {
    let squares = (0..10).map(|row| square(fx!(0), fx!(0.5) + row.into()));
    let (mut world, ids) = world::<S>(fx!(-10), [ground([fx!(0.6), fx!(0)])].into_iter().chain(squares));
    (0..300).for_each(|_| _ = world.step());
    motion(&world, ids[10])
}

#[test]
fn a_stack_stands() {
    for [x, y, angle, vx, vy, _] in [stack::<f64>(), stack::<f32>()] {
        assert!(x.abs() < 1e-3 && (y - 9.5).abs() < 0.05 && angle.abs() < 1e-3, "{x} {y} {angle}");
        assert!(vx.abs() < 1e-3 && vy.abs() < 1e-3, "{vx} {vy}");
    }
}

/// Discs of 1 kg and 3 kg at 3 m/s and −1 m/s, elastic. Returns the velocities after the impact.
fn impact<S: Real>() -> [f64; 2] {
    let ball = |x: Fx, speed: Fx, mass: Fx| BodyDef {
        velocity: vec(speed, fx!(0)),
        mass: Mass::Kilograms(of(mass)),
        ..body(vec(x, fx!(0)), collider(Geometry::Circle { radius: of(fx!(0.5)) }, [fx!(0), fx!(1)]))
    };
    let balls = [ball(fx!(-2), fx!(3), fx!(1)), ball(fx!(2), fx!(-1), fx!(3))];
    let (mut world, ids) = world::<S>(fx!(0), balls);
    (0..120).for_each(|_| _ = world.step());
    [0, 1].map(|i| motion(&world, ids[i])[3])
}

#[test]
fn an_elastic_impact_keeps_momentum_and_energy() {
    for [a, b] in [impact::<f64>(), impact::<f32>()] {
        assert!((a + 3.0).abs() < 1e-4 && (b - 1.0).abs() < 1e-4, "{a} {b}");
    }
}

/// A box on a slope of 30° with friction μ, for a second. Returns its speed.
fn slope<S: Real>(mu: Fx) -> f64 {
    let surface = [mu, fx!(0)];
    let tilt = Fx::from_ratio(1, 6) * Fx::PI;
    let (sin, cos) = tilt.sin_cos();
    // The normal is (−sin, cos): the box stands half a metre along it above the surface, which goes through the origin.
    let at = |along: Fx| vec(-sin * along, cos * along);
    let floor = rectangle(fx!(40), fx!(2), surface);
    let floor = BodyDef { position: at(fx!(-1)), angle: of(tilt), colliders: vec![floor], ..BodyDef::fixed() };
    let square = BodyDef { angle: of(tilt), ..body(at(fx!(0.5)), rectangle(fx!(1), fx!(1), surface)) };
    let (mut world, ids) = world::<S>(fx!(-10), [floor, square]);
    (0..60).for_each(|_| _ = world.step());
    let [.., vx, vy, _] = motion(&world, ids[1]);
    vx.hypot(vy)
}

#[test]
fn a_box_slides_down_a_slope_or_does_not() {
    // g·(sin − μ·cos)
    let expected = 10.0 * (0.5 - 0.25 * 0.75f64.sqrt());
    for [sliding, still] in
        [[slope::<f64>(fx!(0.25)), slope::<f64>(fx!(0.6))], [slope::<f32>(fx!(0.25)), slope::<f32>(fx!(0.6))]]
    {
        assert!((sliding / expected - 1.0).abs() < 2e-3, "{sliding} {expected}");
        assert!(still < 1e-4, "{still}");
    }
}

/// A scene in two scalars, side by side: the largest difference of a component of a position over the steps.
fn apart<S: Real, T: Real>(
    (mut here, ids): (World<S>, Vec<BodyId>),
    (mut twin, others): (World<T>, Vec<BodyId>),
    steps: usize,
) -> f64 {
    let mut largest = 0f64;
    for _ in 0..steps {
        here.step();
        twin.step();
        for (&id, &twin_id) in ids.iter().zip(&others) {
            let (a, b) = (motion(&here, id), motion(&twin, twin_id));
            largest = (0..3).map(|i| (a[i] - b[i]).abs()).fold(largest, f64::max);
        }
    }
    largest
}

/// A body that meets the ground slower than bodies bounce, and how far both worlds may be apart within a second, m and rad. A sub-step stops a corner exactly at the
/// surface; rounding decides on which side of it, and with that by how much of a sub-step it rises.
fn alone<S: Scalar>(which: usize) -> (Vec<BodyDef<S>>, f64) {
    let surface = [fx!(0.6), fx!(0.25)];
    let brick = || Geometry::Rectangle { width: of(fx!(1)), height: of(fx!(0.5)) };
    let (shape, height, angle, bound) = match which {
        // Falls and rolls.
        0 => (Geometry::Circle { radius: of(fx!(0.4)) }, fx!(0.425), fx!(0), 1e-4),
        // Slides until it stands.
        1 => (brick(), fx!(0.25), fx!(0), 1e-4),
        // Fall flat.
        2 => (brick(), fx!(0.275), fx!(0), 1e-4),
        _ => (Geometry::Capsule { length: of(fx!(1)), radius: of(fx!(0.25)) }, fx!(0.275), fx!(0), 1e-4),
    };
    let velocity = vec(fx!(3), if which == 1 { fx!(0) } else { fx!(-0.25) });
    let def = body(vec(fx!(0.25), height), collider(shape, surface));
    (vec![ground(surface), BodyDef { angle: of(angle), velocity, ..def }], bound)
}

#[test]
fn a_body_alone_meets_the_ground_as_in_fixed_point() {
    for which in 0..4 {
        let (bodies, bound) = alone(which);
        let off = apart(world::<Fx>(fx!(-10), bodies), world::<f64>(fx!(-10), alone(which).0), 60);
        assert!(off < bound, "{which}: {off:e}");
    }
}

#[test]
fn a_pyramid_of_doubles_stands_as_that_of_fixed_point_does() {
    let off = apart(world::<Fx>(fx!(-10), pyramid(8)), world::<f64>(fx!(-10), pyramid(8)), 300);
    assert!(off < 1e-4, "{off}");
}
