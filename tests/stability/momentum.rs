//! Action is reaction: what internal forces leave of the momentum of a world, to the bit or within what rounding adds.

use umbra_physics::scalar::{Accumulator, Factor, ToF64};
use umbra_physics::{
    Attachment, End, FieldKind, Fx, FxAccumulator, Integrator, Scalar, SpringConstants, Vec2, World, fx, vec2,
};

use crate::seeds::times;
use crate::stability::random::SplitMix;
use crate::stability::real::{Real, exact, real, to_f64, units};
use crate::stability::scene::{Ball, Gravity, Scene, Spring, look};

/// The velocities of all bodies added up, in units of 2^-96 m/s.
fn velocities(world: &World) -> [i128; 2] {
    let sum = |component: fn(Vec2<FxAccumulator>) -> FxAccumulator| {
        world.bodies().map(|body| Accumulator::to_bits(component(body.velocity_exact()))).sum()
    };
    [sum(|v| v.x), sum(|v| v.y)]
}

/// Σ m·v with all the bits that are carried, to 160 bits.
pub(crate) fn momentum<S: Exact>(scene: &Scene, world: &World<S>) -> [Real; 2] {
    let mut sum = [real(0), real(0)];
    for (ball, body) in scene.bodies.iter().zip(world.bodies()) {
        let v = body.velocity_exact();
        for (sum, v) in sum.iter_mut().zip([v.x, v.y]) {
            *sum += exact(ball.mass) * S::real(v);
        }
    }
    sum
}

/// A scalar whose accumulators are known without loss.
pub(crate) trait Exact: Scalar<Accumulator: ToF64> {
    fn real(value: Self::Accumulator) -> Real;
}

impl Exact for Fx {
    fn real(value: FxAccumulator) -> Real {
        units(Accumulator::to_bits(value), 96)
    }
}

impl Exact for f64 {
    fn real(value: f64) -> Real {
        Real::try_from(value).expect("it is finite").with_precision(crate::stability::real::PRECISION).value()
    }
}

impl Exact for f32 {
    fn real(value: f32) -> Real {
        f64::real(value.into())
    }
}

/// Distance of two momenta, kg·m/s: the larger component.
pub(crate) fn apart(a: &[Real; 2], b: &[Real; 2]) -> f64 {
    let component = |i: usize| to_f64(&(&a[i] - &b[i])).abs();
    component(0).max(component(1))
}

/// Bound on the change of a component of momentum by velocity Verlet's rounding in a number of steps, kg·m/s, if the magnitudes
/// of all forces add up to `pull` at most.
///
/// A spring pulls both its bodies by the same bits; F/m is then rounded to 2^-64 m/s², with a 1/m that is within 2^-64
/// of its own. Each attraction is rounded to 2^-64 m/s², and within 2^-90 of its own. Times the mass and the time step
/// that goes to momentum. Either half kick is rounded to 2^-96 m/s besides.
pub(crate) fn rounding(scene: &Scene, rate: u32, steps: u32, pull: f64) -> f64 {
    let unit = 2f64.powi(-64);
    let mass: f64 = scene.bodies.iter().map(|ball| ball.mass.to_f64()).sum();
    let (quotients, relative) = if scene.springs.is_empty() { (0, 2f64.powi(-90)) } else { (1, unit) };
    let attractions = if scene.gravity.is_some() { scene.bodies.len() - 1 } else { 0 };
    let forces = mass * (quotients + attractions) as f64 * unit / 2.0 + pull * relative;
    f64::from(steps) * (forces / f64::from(rate) + mass * 2f64.powi(-96))
}

/// Two bodies of 3 kg at odd places.
fn twins() -> Scene {
    let ball = |x, y, v, w| Ball { mass: fx!(3), position: Vec2::new(x, y), velocity: Vec2::new(v, w) };
    let bodies = vec![ball(fx!(1.1), fx!(2.3), fx!(0.7), fx!(-2.9)), ball(fx!(-3.7), fx!(0.1), fx!(0.3), fx!(1.7))];
    Scene { bodies, springs: vec![], gravity: None }
}

/// Connections between two bodies.
type Join<S> = fn([Attachment<S>; 2]) -> Vec<FieldKind<S>>;

fn joined<S: Scalar>(integrator: Integrator, join: Join<S>) -> World<S> {
    let mut world = twins().world::<S>(60, integrator);
    let centres: Vec<_> = world.bodies().map(|body| Attachment { body: body.id(), point: Vec2::ZERO }).collect();
    for law in join([centres[0], centres[1]]) {
        world.add_field(law).expect("a fair field");
    }
    world
}

/// A spring with a damper.
fn spring<S: Scalar>([near, far]: [Attachment<S>; 2]) -> Vec<FieldKind<S>> {
    let [rest, stiffness, damping] = [fx!(4.1), fx!(23.3), fx!(0.01)].map(S::from_fx);
    vec![FieldKind::Spring { near, far: End::Body(far), spring: SpringConstants { rest, stiffness, damping } }]
}

/// Each attracts the other.
fn attraction<S: Scalar>(bodies: [Attachment<S>; 2]) -> Vec<FieldKind<S>> {
    let (mu, softening) = (S::Factor::from_ratio(100, 3), S::from_fx(fx!(0.1)));
    bodies.map(|carrier| FieldKind::Attractor { centre: End::Body(carrier), mu, softening }).to_vec()
}

#[test]
fn two_equal_bodies_keep_the_sum_of_their_velocities_to_the_bit() {
    for integrator in Integrator::ALL {
        // Explicit Euler spirals out of the envelope.
        let steps = if integrator == Integrator::ExplicitEuler { 2_000 } else { times(5_000) };
        let joins: [(&str, Join<Fx>); 2] = [("spring", spring), ("attraction", attraction)];
        for (name, join) in joins {
            let mut world = joined(integrator, join);
            let start = velocities(&world);
            for step in 0..steps {
                assert!(world.step().faults.is_empty());
                assert_eq!(velocities(&world), start, "{name}, {}, step {step}", integrator.name());
            }
        }
    }
}

#[test]
fn two_equal_bodies_do_not_keep_it_in_f64() {
    let joins: [Join<f64>; 2] = [spring, attraction];
    for join in joins {
        let mut world = joined(Integrator::VelocityVerlet, join);
        let start = momentum(&twins(), &world);
        (0..100).for_each(|_| assert!(world.step().faults.is_empty()));
        assert_ne!(momentum(&twins(), &world), start);
    }
}

#[test]
fn a_net_keeps_its_momentum_to_the_bit_where_nothing_has_to_be_rounded() {
    // At 64 Hz and 1 kg, h and 1/m are powers of two: F/m and its kicks have all the bits of F.
    let (scene, steps) = (Scene::net(5, [fx!(1); 2]), times(2_000));
    let spread = |rate| {
        let mut world = scene.world::<Fx>(rate, Integrator::VelocityVerlet);
        let start = velocities(&world);
        (0..steps).for_each(|_| assert!(world.step().faults.is_empty()));
        let end = velocities(&world);
        (end[0] - start[0], end[1] - start[1])
    };
    assert_eq!(spread(64), (0, 0));
    // At 60 Hz each kick is rounded, and it shows.
    assert_ne!(spread(60), (0, 0));
}

/// Bodies of 0.3 to 20 kg in a ring of springs, under their own gravity.
fn crowd() -> Scene {
    let mut random = SplitMix::seeded(7);
    let mut number = |low: Fx, high: Fx| Fx::from_bits(random.between(low.to_bits(), high.to_bits()));
    let ring = [(20, 0), (14, 14), (0, 20), (-14, 14), (-20, 0), (-14, -14), (0, -20), (14, -14)];
    let bodies: Vec<_> = ring
        .map(|(x, y)| Ball {
            mass: number(fx!(0.3), fx!(20)),
            position: vec2(x, y) + Vec2::new(number(fx!(-2), fx!(2)), number(fx!(-2), fx!(2))),
            velocity: Vec2::new(number(fx!(-3), fx!(3)), number(fx!(-3), fx!(3))),
        })
        .to_vec();
    let join = |near| Spring { near, far: Some((near + 1) % ring.len()), rest: fx!(15), stiffness: fx!(9) };
    let gravity = Some(Gravity { constant: fx!(1), softening: fx!(2) });
    Scene { springs: (0..ring.len()).map(join).collect(), bodies, gravity }
}

/// Change of momentum in a number of steps, and the change that rounding allows.
fn moved<S: Exact>(scene: &Scene, rate: u32, steps: u32) -> (f64, f64) {
    let mut world = scene.world::<S>(rate, Integrator::VelocityVerlet);
    let start = momentum(scene, &world);
    let mut pull = scene.weigh(&look(&world)).pull;
    for _ in 0..steps {
        assert!(world.step().faults.is_empty());
        pull = pull.max(scene.weigh(&look(&world)).pull);
    }
    (apart(&momentum(scene, &world), &start), rounding(scene, rate, steps, pull))
}

#[test]
fn the_momentum_of_unequal_bodies_moves_by_no_more_than_rounding() {
    let (scene, rate, steps) = (crowd(), 60, times(3_000));
    let (fixed, allowed) = moved::<Fx>(&scene, rate, steps);
    let (float, _) = moved::<f64>(&scene, rate, steps);
    println!("in {steps} steps {fixed:.1e} kg·m/s of {allowed:.1e} allowed, {float:.1e} in f64");
    assert!(fixed <= allowed);
    // The bound adds up what mostly cancels: of n roundings about √n remain.
    let roundings = f64::from(steps) * scene.bodies.len() as f64;
    assert!(fixed >= allowed / roundings.sqrt() / 100.0, "the bound is empty");
    assert!(float > allowed, "f64 would pass");
}
