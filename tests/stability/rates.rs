//! From one step a second to ten thousand: the same physics, within the error of the order, at exact times.

use umbra_physics::scalar::ToF64;
use umbra_physics::{BodyDef, Elapsed, Fx, Integrator, Scalar, TimeStep, Vec2, World, WorldDef, fx, vec2};

use crate::seeds::is_short;
use crate::stability::limit::{BOUNDED, half_trace};
use crate::stability::scene::{Scene, look};

/// By day without the fast ones.
fn rates() -> &'static [u32] {
    let all = &[1, 2, 7, 30, 60, 100, 144, 1_000, 10_000];
    if is_short() { &all[..7] } else { all }
}

/// At 0.25 rad/s some five periods: sin(30) is −0.99, so that an error of the phase shows.
const SECONDS: u32 = 120;
const OMEGA: f64 = 0.25;

/// Distance of the oscillator from cos(ω·t) at the end, as a fraction of its amplitude.
fn off_the_cosine(integrator: Integrator, rate: u32) -> f64 {
    let scene = Scene::oscillator(fx!(1), fx!(0.0625), vec2(1000, 0), vec2(0, 0));
    let mut world = scene.world::<Fx>(rate, integrator);
    for _ in 0..SECONDS * rate {
        assert!(world.step().faults.is_empty());
    }
    (look(&world)[0].x[0] / 1000.0 - (OMEGA * f64::from(SECONDS)).cos()).abs()
}

/// Relative phase error of a step over z: −z⁴·0.0661… in Yoshida4, z²/24 in velocity Verlet and its kin.
fn phase_error(integrator: Integrator) -> (f64, i32) {
    match integrator {
        Integrator::Yoshida4 => {
            let z = 0.05;
            ((half_trace(integrator, z).acos() / z - 1.0) / z.powi(4), 4)
        }
        _ => (1.0 / 24.0, 2),
    }
}

/// Error predicted by the first term of the integrator's error.
fn order_error(integrator: Integrator, rate: u32) -> f64 {
    let z = OMEGA / f64::from(rate);
    let (constant, power) = phase_error(integrator);
    let phase = constant.abs() * z.powi(power) * OMEGA * f64::from(SECONDS);
    // Symplectic Euler starts half a kick beside velocity Verlet.
    let beside = if integrator.order() == 1 { z / 2.0 } else { 0.0 };
    phase + beside
}

/// Public positions and velocities are half an ulp off at most, which moves the body by that over the whole time, in
/// Yoshida4 over 4.41 times as much, in relation to the swing.
fn rounding() -> f64 {
    4.41 * f64::from(SECONDS) * (1.0 + OMEGA) * Fx::DELTA.to_f64() / 2.0 / 1000.0
}

#[test]
fn an_oscillator_is_where_it_should_be_at_every_rate() {
    for integrator in BOUNDED {
        for &rate in rates() {
            let (is, expected) = (off_the_cosine(integrator, rate), order_error(integrator, rate));
            println!("{} at {rate} Hz: {is:.1e}, of the order {expected:.1e}", integrator.name());
            // Neither more nor less, but for the next terms: a tenth, at z = ¼ and below.
            let off = (is - expected).abs();
            assert!(off <= expected / 10.0 + rounding(), "{} at {rate} Hz: {is:e}", integrator.name());
        }
    }
}

#[test]
fn explicit_euler_is_farther_off_at_every_rate() {
    for &rate in rates() {
        let is = off_the_cosine(Integrator::ExplicitEuler, rate);
        for integrator in BOUNDED {
            assert!(is > 1.1 * order_error(integrator, rate) + rounding(), "{rate} Hz: {is:e}");
        }
    }
}

/// Position of a falling body after `SECONDS` at this rate, and the elapsed time.
fn fall<S: Scalar>(rate: u32, integrator: Integrator) -> (Vec2<S>, Elapsed) {
    let gravity = Vec2::new(S::ZERO, S::from_fx(fx!(-9.8125)));
    let def = WorldDef { time_step: TimeStep::hz(rate), integrator, gravity, ..WorldDef::default() };
    let mut world = World::with_scalar(def).expect("a fair definition");
    let velocity = Vec2::new(S::from_fx(fx!(3.25)), S::ZERO);
    let body = world.add_body(BodyDef { velocity, ..BodyDef::dynamic() }).expect("a fair body");
    for _ in 0..SECONDS * rate {
        assert!(world.step().faults.is_empty());
    }
    (world.body(body).expect("it is there").position(), world.elapsed())
}

/// Returns true if the place is within an ulp of the exact (3.25·120, −½·9.8125·120²).
fn is_exact(place: Vec2<Fx>) -> bool {
    let off = |is: Fx, right: Fx| (is - right).abs() <= Fx::DELTA;
    off(place.x, fx!(390)) && off(place.y, fx!(-70650))
}

#[test]
fn a_fall_ends_at_the_same_place_and_time_at_every_rate() {
    for integrator in [Integrator::VelocityVerlet, Integrator::Yoshida4] {
        for &rate in rates() {
            let (place, time) = fall::<Fx>(rate, integrator);
            assert!(is_exact(place), "{} at {rate} Hz: {place:?}", integrator.name());
            assert_eq!(time, Elapsed { num: SECONDS.into(), den: 1 });
        }
    }
}

#[test]
fn f32_is_inexact_and_so_is_a_rounded_time_step() {
    for &rate in &rates()[3..] {
        let place =
            fall::<f32>(rate, Integrator::VelocityVerlet).0.map(|x| Fx::from_f64_for_tools(x.into()).expect("it fits"));
        assert!(!is_exact(place), "{rate} Hz");
    }
    // A sixtieth as an `Fx` is off by 4/15 of an ulp, and 7,200 of them by 1,920 ulps.
    assert_ne!(Fx::from_ratio(1, 60) * fx!(7200), Fx::from(SECONDS as i32));
}
