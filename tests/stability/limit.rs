//! Stiff springs, up to the limit of stability and past it.
//!
//! On x″ = −ω²x a step of length h is a matrix of determinant 1 that depends on z = h·ω alone. Its powers stay bounded
//! while half its trace a(z) is within ±1. If a step back is its inverse, as in velocity Verlet and Yoshida4, its
//! diagonal is a, a: from rest x_n = T_n(a)·x_0, and from the origin v_n = T_n(a)·v_0, with Chebyshev's polynomials.
//! That is the start at most inside the limit, and cosh(n·arcosh |a|) times it past the limit.
//!
//! Symplectic Euler is velocity Verlet seen half a kick later. So is the published scheme, in v + ½·a·h with the last
//! acceleration: it adds a·h to that, and moves x by it.

use umbra_physics::scalar::ToF64;
use umbra_physics::{Activity, BodyRef, Fx, Integrator, fx, limits, vec2};

use crate::seeds::is_short;
use crate::stability::scene::{Ball, Scene, Seen, Spring, bits, look};

/// The integrators that have a limit.
pub(crate) const BOUNDED: [Integrator; 4] =
    [Integrator::SymplecticEuler, Integrator::VelocityVerlet, Integrator::PublishedVerlet, Integrator::Yoshida4];

/// The weights of the three Verlet steps in one of Yoshida's.
fn yoshida_weights() -> [f64; 3] {
    let outer = 1.0 / (2.0 - 2f64.cbrt());
    [outer, 1.0 - 2.0 * outer, outer]
}

/// The matrix of a Verlet step over z, for (x, v/ω).
fn verlet(z: f64) -> [[f64; 2]; 2] {
    let a = 1.0 - z * z / 2.0;
    [[a, z], [-z * (1.0 - z * z / 4.0), a]]
}

fn product(a: [[f64; 2]; 2], b: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    a.map(|row| [row[0] * b[0][0] + row[1] * b[1][0], row[0] * b[0][1] + row[1] * b[1][1]])
}

/// a(z), half the trace of the step.
pub(crate) fn half_trace(integrator: Integrator, z: f64) -> f64 {
    match integrator {
        Integrator::Yoshida4 => {
            let [first, second, third] = yoshida_weights().map(|weight| verlet(weight * z));
            let step = product(product(first, second), third);
            (step[0][0] + step[1][1]) / 2.0
        }
        _ => verlet(z)[0][0],
    }
}

/// Halves a range until its ends are neighbours: the last place where `holds` is true, if it is at the first.
fn bisect(mut range: [f64; 2], holds: impl Fn(f64) -> bool) -> f64 {
    loop {
        let middle = (range[0] + range[1]) / 2.0;
        if middle <= range[0] || middle >= range[1] {
            return range[0];
        }
        range[usize::from(!holds(middle))] = middle;
    }
}

/// Inside every limit, and past every one.
const INSIDE: f64 = 1.0;
const PAST: f64 = 2.5;

/// Up to which z half the trace stays within ±`level`.
fn crossing(integrator: Integrator, level: f64) -> f64 {
    bisect([INSIDE, PAST], |z| half_trace(integrator, z).abs() <= level)
}

const START: Fx = fx!(1000);

fn rounded(value: f64) -> Fx {
    Fx::from_f64_for_tools(value).expect("it fits")
}

/// Stiffness of a spring for ω·dt = z at this rate.
fn stiffness(mass: Fx, rate: u32, z: f64) -> Fx {
    rounded(mass.to_f64() * (z * f64::from(rate)).powi(2))
}

/// z, of what the stiffness was rounded to.
fn z_of(mass: Fx, rate: u32, stiffness: Fx) -> f64 {
    (stiffness.to_f64() / mass.to_f64()).sqrt() / f64::from(rate)
}

/// An oscillator that starts with what a step at the limit leaves as it is, or turns round: with a velocity in
/// Yoshida4, at a distance in the others.
fn oscillator(integrator: Integrator, mass: Fx, rate: u32, z: f64) -> Scene {
    let stiffness = stiffness(mass, rate, z);
    // Half a kick ahead of velocity Verlet.
    let ahead = rounded(stiffness.to_f64() / mass.to_f64() * START.to_f64() / f64::from(2 * rate));
    let (position, velocity) = match integrator {
        Integrator::Yoshida4 => (Fx::ZERO, START),
        Integrator::SymplecticEuler | Integrator::PublishedVerlet => (START, ahead),
        Integrator::VelocityVerlet | Integrator::ExplicitEuler => (START, Fx::ZERO),
    };
    Scene::oscillator(mass, stiffness, vec2(position, 0), vec2(velocity, 0))
}

/// Returns true if the oscillator stays within twice its start for this number of steps.
fn keeps(integrator: Integrator, mass: Fx, rate: u32, z: f64, steps: u32) -> bool {
    let mut world = oscillator(integrator, mass, rate, z).world::<Fx>(rate, integrator);
    let swing = |body: BodyRef| match integrator {
        Integrator::Yoshida4 => body.velocity().x,
        _ => body.position().x,
    };
    (0..steps).all(|_| {
        let stays = world.step().faults.is_empty();
        stays && world.bodies().all(|body| swing(body).abs() <= START + START)
    })
}

/// The largest z with which the engine keeps an oscillator.
fn measured_limit(integrator: Integrator, mass: Fx, rate: u32, steps: u32) -> f64 {
    let limit = bisect([INSIDE, PAST], |z| keeps(integrator, mass, rate, z, steps));
    z_of(mass, rate, stiffness(mass, rate, limit))
}

#[test]
fn the_limit_of_stability_is_where_the_trace_of_the_step_says() {
    let steps = if is_short() { 2_000 } else { 20_000 };
    for integrator in BOUNDED {
        let known = if integrator == Integrator::Yoshida4 { 1.573_401_947 } else { 2.0 };
        let limit = crossing(integrator, 1.0);
        assert!((limit - known).abs() < 1e-9, "{}: {limit}", integrator.name());
        // So many steps swing twice as far only from here on: in 20,000 that is past the limit by 5e-10, relative.
        let noticed = crossing(integrator, (2f64.acosh() / f64::from(steps)).cosh());
        // What rounding adds to an oscillator of 1,000 m is far below one in a hundred.
        let slack = (noticed - limit) / 100.0;
        for (mass, rate) in [(fx!(1), 64), (fx!(3), 60)] {
            let limit = measured_limit(integrator, mass, rate, steps);
            println!("{} at {rate} Hz: {limit:.12}, noticed from {noticed:.12} on", integrator.name());
            assert!((limit - noticed).abs() <= slack, "{} at {rate} Hz: {limit}", integrator.name());
        }
    }
}

/// ln of the growth of √(v² + ω²x²) over so many steps.
fn growth(integrator: Integrator, scene: &Scene, rate: u32, steps: u32) -> f64 {
    let square = scene.springs[0].stiffness.to_f64() / scene.bodies[0].mass.to_f64();
    let size = |at: &Seen| (at.v[0] * at.v[0] + square * at.x[0] * at.x[0]).sqrt().ln();
    let mut world = scene.world::<Fx>(rate, integrator);
    let start = size(&look(&world)[0]);
    for _ in 0..steps {
        assert!(world.step().faults.is_empty());
    }
    size(&look(&world)[0]) - start
}

#[test]
fn explicit_euler_grows_at_every_stiffness_as_its_step_says() {
    // Its step multiplies v² + ω²x² by 1 + z².
    for (z, steps) in [(1.0, 10), (0.25, 100), (1.0 / 16.0, 2_000), (1.0 / 256.0, 20_000), (1.0 / 1024.0, 100_000)] {
        let (mass, rate) = (fx!(1), 16);
        let omega = z * f64::from(rate);
        let scene = Scene::oscillator(mass, stiffness(mass, rate, z), vec2(START, 0), vec2(0, 0));
        let is = growth(Integrator::ExplicitEuler, &scene, rate, steps);
        let expected = f64::from(steps) * (z * z).ln_1p() / 2.0;
        // The public position and velocity are half an ulp off at most: z·(1 + 1/ω) half ulps of ω·START a step.
        let rounding = f64::from(steps) * z * (1.0 + 1.0 / omega) * Fx::DELTA.to_f64() / 2.0 / START.to_f64();
        println!("z = {z}: {is} in {steps} steps, {:.1e} off, {rounding:.1e} allowed", is - expected);
        // Doubles add a few roundings of logarithms below 16.
        assert!((is - expected).abs() <= rounding + 32.0 * f64::EPSILON, "z = {z}: {is}, not {expected}");
        // Velocity Verlet stays on an ellipse, v² + (1 − z²/4)·ω²x².
        let kept = growth(Integrator::VelocityVerlet, &scene, rate, steps).abs();
        assert!(kept <= -(-z * z / 4.0).ln_1p() / 2.0 + rounding, "z = {z}: {kept} by velocity Verlet");
    }
}

/// Steps a second, beside a stiff spring.
const RATE: u32 = 60;

/// Bodies beside the stiff spring: two on a spring of their own, and one by itself.
fn beside() -> Scene {
    let mut scene = Scene::pair([fx!(3), fx!(1)], fx!(10), fx!(5));
    scene.springs.push(Spring { near: 0, far: Some(1), rest: fx!(8), stiffness: fx!(0.75) });
    scene.bodies.push(Ball { mass: fx!(2), position: vec2(100, 7), velocity: vec2(1, fx!(-0.25)) });
    scene
}

/// The scene with an oscillator, at `START`, as its last body.
fn with_oscillator(mut scene: Scene, mass: Fx, stiffness: Fx) -> Scene {
    let near = scene.bodies.len();
    scene.bodies.push(Ball { mass, position: vec2(START, 0), velocity: vec2(0, 0) });
    scene.springs.push(Spring { near, far: None, rest: fx!(0), stiffness });
    scene
}

/// The step at which the oscillator was quarantined, if it was, and the others' bits after all steps.
fn fate(integrator: Integrator, [mass, stiffness]: [Fx; 2], steps: u32) -> (Option<u32>, Vec<[i128; 4]>) {
    let scene = with_oscillator(beside(), mass, stiffness);
    let (mut world, last) = (scene.world::<Fx>(RATE, integrator), scene.bodies.len() - 1);
    let stiff = world.bodies().nth(last).expect("the oscillator").id();
    let mut gone = None;
    for step in 1..=steps {
        let before = bits(&world)[last];
        for fault in world.step().faults.to_vec() {
            assert_eq!((fault.body, gone), (stiff, None), "{} at {stiffness} N/m, step {step}", integrator.name());
            assert_eq!(bits(&world)[last], before, "{} at {stiffness} N/m: not put back", integrator.name());
            gone = Some(step);
        }
        let activity = world.body(stiff).expect("it is there").activity();
        assert_eq!(activity == Activity::Quarantined, gone.is_some());
    }
    let mut all = bits(&world);
    all.truncate(last);
    (gone, all)
}

/// By which step an oscillator past the limit is beyond 2^30 m, or in explicit Euler beyond that or 2^20 m/s. Most are
/// gone long before, by their velocity or a kick.
fn steps_to_the_envelope(integrator: Integrator, z: f64) -> u32 {
    let reach = (limits::POSITION.to_f64() / START.to_f64()).ln();
    let steps = match integrator {
        // It turns as it grows: at √2 of the envelope x or v/ω is past 2^30 m, and ω is above 2^-10 rad/s.
        Integrator::ExplicitEuler => (reach + 2f64.ln() / 2.0) / ((z * z).ln_1p() / 2.0),
        // The hyperbolic cosine is more than half of the exponential.
        _ => (reach + 2f64.ln()) / half_trace(integrator, z).abs().acosh(),
    };
    steps.ceil() as u32
}

#[test]
fn past_the_limit_a_body_is_quarantined_and_the_others_go_on_unharmed() {
    let steps = 2_000;
    for integrator in Integrator::ALL {
        let mut alone = beside().world::<Fx>(RATE, integrator);
        (0..steps).for_each(|_| assert!(alone.step().faults.is_empty()));
        let limit = if integrator == Integrator::ExplicitEuler { 0.0 } else { crossing(integrator, 1.0) };
        let past = [0.25, 1.6, 2.001, 3.0, 100.0].into_iter().filter(|&z| z > limit);
        let past = past.map(|z| [fx!(1), stiffness(fx!(1), RATE, z)]);
        for [mass, stiffness] in past.chain([[fx!(1), Fx::MAX], [limits::MASS_MIN, Fx::MAX]]) {
            let (gone, others) = fate(integrator, [mass, stiffness], steps);
            let gone = gone.expect("it is past the limit");
            let steps = steps_to_the_envelope(integrator, z_of(mass, RATE, stiffness));
            println!("{} at {stiffness:.0} N/m: gone at step {gone} of {steps} at most", integrator.name());
            assert!(gone <= steps, "{} at {stiffness} N/m: gone at step {gone}, not by {steps}", integrator.name());
            assert_eq!(others, bits(&alone), "{} at {stiffness} N/m: others were touched", integrator.name());
        }
    }
}

#[test]
fn within_the_limit_nothing_is_quarantined() {
    for integrator in BOUNDED {
        let stiffness = stiffness(fx!(1), RATE, crossing(integrator, 1.0) * 0.99);
        assert_eq!(fate(integrator, [fx!(1), stiffness], 10_000).0, None, "{}", integrator.name());
    }
}
