//! Time is exact: after any number of steps, what has a closed form is where it says.

#[path = "support/real.rs"]
mod real;

use crate::seeds::is_short;
use real::{Real, TAU, exact, ratio, real, to_f64, units};
use umbra_physics::{
    BodyDef, BodyId, Damping, Elapsed, Fx, FxAccumulator, Integrator, TimeStep, Vec2, World, WorldDef, fx, vec2,
};

const RATES: [TimeStep; 5] =
    [TimeStep::hz(60), TimeStep::hz(100), TimeStep::hz(144), TimeStep::ratio(1001, 60_000), TimeStep::hz(64)];
const ULP: f64 = 1.0 / 4_294_967_296.0;

fn seconds(step: TimeStep, ticks: u64) -> Real {
    let (num, den) = step.seconds();
    ratio(i64::from(num) * ticks as i64, i64::from(den))
}

fn rates() -> &'static [TimeStep] {
    if is_short() { &RATES[3..] } else { &RATES }
}

/// The ticks of an hour, or the last one before it.
fn an_hour(step: TimeStep) -> u64 {
    let (num, den) = step.seconds();
    3600 * u64::from(den) / u64::from(num)
}

/// |value − reference| in ulps.
fn ulps_off(value: Fx, reference: &Real) -> f64 {
    to_f64(&(exact(value) - reference)).abs() / ULP
}

/// A world with a body in it.
fn one_body(def: WorldDef, body: BodyDef) -> (World, BodyId) {
    let mut world = World::new(def).expect("a fair definition");
    let body = world.add_body(body).expect("a fair body");
    (world, body)
}

/// The worst distances in ulps of a body thrown under g = 9.81 from its parabola over an hour: of the public position, and
/// with what is carried below its ulp.
fn worst_off_the_parabola(step: TimeStep, integrator: Integrator) -> (f64, f64) {
    let gravity = vec2(0, fx!(-9.81));
    let thrown = vec2(fx!(3.3), fx!(7.7));
    let (mut world, body) = one_body(
        WorldDef { time_step: step, gravity, integrator, ..WorldDef::default() },
        BodyDef { velocity: thrown, ..BodyDef::dynamic() },
    );
    let (ticks, mut worst) = (an_hour(step), (0.0f64, 0.0f64));
    for tick in 1..=ticks {
        world.step();
        // A prime: at whole seconds the exact position happens to be a multiple of the ulp.
        if tick % 997 == 0 || tick == ticks {
            let t = seconds(step, tick);
            let look = world.body(body).expect("it is there");
            let coordinate = |v: Fx, g: Fx| exact(v) * &t + exact(g) * &t * &t / real(2);
            let (x, y) = (coordinate(thrown.x, gravity.x), coordinate(thrown.y, gravity.y));
            worst.0 = worst.0.max(ulps_off(look.position().x, &x)).max(ulps_off(look.position().y, &y));
            let below =
                |at: FxAccumulator, reference: &Real| to_f64(&(units(at.to_bits(), 96) - reference)).abs() / ULP;
            worst.1 = worst.1.max(below(look.position_exact().x, &x)).max(below(look.position_exact().y, &y));
        }
    }
    worst
}

fn an_hour_of_free_fall_is_exact(integrator: Integrator, rates: &[TimeStep]) {
    for &step in rates {
        let (worst, carried) = worst_off_the_parabola(step, integrator);
        let (num, den) = step.seconds();
        println!(
            "{} at {num}/{den} s: {:.1e} m off, {:.1e} m before rounding",
            integrator.name(),
            worst * ULP,
            carried * ULP
        );
        assert!(worst <= 1.0, "{} at {num}/{den} s is {worst} ulps off", integrator.name());
    }
}

#[test]
fn an_hour_of_free_fall_is_exact_in_velocity_verlet() {
    an_hour_of_free_fall_is_exact(Integrator::VelocityVerlet, rates());
}

#[test]
fn an_hour_of_free_fall_is_exact_in_yoshida4() {
    an_hour_of_free_fall_is_exact(Integrator::Yoshida4, rates());
}

#[test]
fn elapsed_time_is_the_exact_ratio() {
    for &step in rates() {
        let mut world = World::new(WorldDef { time_step: step, ..WorldDef::default() }).expect("a fair rate");
        for _ in 0..an_hour(step) {
            world.step();
        }
        let (num, den) = step.seconds();
        let Elapsed { num: n, den: d } = world.elapsed();
        assert_eq!(n * u128::from(den), d * u128::from(num) * u128::from(an_hour(step)), "{step:?}");
    }
}

#[test]
fn a_spin_of_ten_radians_a_second_is_exact_after_a_thousand_seconds() {
    for &step in rates() {
        for integrator in [Integrator::VelocityVerlet, Integrator::Yoshida4] {
            let (mut world, body) = one_body(
                WorldDef { time_step: step, integrator, ..WorldDef::default() },
                BodyDef { angular_velocity: fx!(10), ..BodyDef::dynamic() },
            );
            let (num, den) = step.seconds();
            let ticks = 1000 * u64::from(den) / u64::from(num);
            for _ in 0..ticks {
                world.step();
            }
            let passed = seconds(step, ticks) * real(10);
            let turns = (&passed / &*TAU).floor();
            let off = ulps_off(world.body(body).expect("it is there").angle(), &(passed - turns * &*TAU));
            println!("{} at {:?} s: {:.1e} rad off", integrator.name(), step.seconds(), off * ULP);
            assert!(off <= 1.0, "{} at {step:?} is {off} ulps off", integrator.name());
        }
    }
}

/// The velocity, linear and angular, after so many ticks of damping.
fn damped(step: TimeStep, ticks: u64, kept: Fx, start: Fx, integrator: Integrator) -> (Vec2, Fx) {
    let def = WorldDef {
        time_step: step,
        linear_damping: Damping::kept_per_second(kept),
        angular_damping: Damping::kept_per_second(kept),
        integrator,
        sleep_after: None,
        ..WorldDef::default()
    };
    let body = BodyDef { velocity: vec2(start, -start), angular_velocity: start, ..BodyDef::dynamic() };
    let (mut world, body) = one_body(def, body);
    for _ in 0..ticks {
        assert!(world.step().faults.is_empty());
    }
    let body = world.body(body).expect("it is there");
    (body.velocity(), body.angular_velocity())
}

/// v0·d^t, and how far from it the damped velocity may be, in m/s.
fn decayed(step: TimeStep, ticks: u64, kept: Fx, start: Fx) -> (Real, f64) {
    let left = exact(start) * exact(kept).powf(&seconds(step, ticks));
    let allowed = to_f64(&left) * ticks as f64 * ULP * ULP + ULP;
    (left, allowed)
}

#[test]
fn a_million_damped_steps_stay_on_the_exponential() {
    // What is lost a second: slow enough that something is left at the end, from nothing to the whole speed.
    let cases = [
        (TimeStep::hz(60), fx!(0.999), fx!(1000000)),
        (TimeStep::hz(60), fx!(0.9999), fx!(100000)),
        (TimeStep::hz(144), fx!(0.998), fx!(1000000)),
        (TimeStep::hz(10_000), fx!(0.9), fx!(1000000)),
        (TimeStep::hz(10_000), fx!(0.999999), fx!(1000000)),
        (TimeStep::ratio(1001, 60_000), fx!(0.9995), fx!(123456.789)),
    ];
    for (step, kept, start) in cases.into_iter().skip(if is_short() { 4 } else { 0 }) {
        let (left, allowed) = decayed(step, 1_000_000, kept, start);
        let (velocity, spin) = damped(step, 1_000_000, kept, start, Integrator::VelocityVerlet);
        let off = |v: Fx| to_f64(&(exact(v) - &left)).abs();
        let worst = off(velocity.x).max(off(-velocity.y)).max(off(spin));
        println!("{kept} a second at {:?} s: {worst:.1e} of {allowed:.1e} m/s", step.seconds());
        assert!(worst <= allowed, "{kept} a second from {start} m/s at {step:?}: {worst} m/s off, {allowed} allowed");
    }
}

#[test]
fn a_hundred_and_fifty_steps_a_second_damp_alike() {
    for kept in [fx!(0.5), fx!(0.1), fx!(0.0009765625), fx!(0.98)] {
        for integrator in Integrator::ALL {
            for &(fine, coarse) in &[(100, 50), (144, 60), (10_000, 1)][..if is_short() { 2 } else { 3 }] {
                let fine = damped(TimeStep::hz(fine), u64::from(fine) * 10, kept, fx!(1000), integrator);
                let coarse = damped(TimeStep::hz(coarse), u64::from(coarse) * 10, kept, fx!(1000), integrator);
                // Each is within half an ulp, and a little, of the exact value: the same, or neighbours.
                let apart = |a: Fx, b: Fx| (a.to_bits() - b.to_bits()).abs();
                assert!(apart(fine.0.x, coarse.0.x) <= 1, "{kept} a second in {}", integrator.name());
                assert!(apart(fine.1, coarse.1) <= 1, "{kept} a second in {}", integrator.name());
            }
        }
    }
}

/// Returns the rest of a velocity of 10^6 m/s after a step, linear and angular, in units of 2^-96 m/s: by a damping of the body, or of the world.
fn left_by_a_step(damping: Damping, step: TimeStep, integrator: Integrator, is_own: bool) -> [i128; 2] {
    let body_damping = is_own.then_some(damping);
    let world_damping = if is_own { Damping::NONE } else { damping };
    let def = WorldDef { time_step: step, integrator, sleep_after: None, ..WorldDef::default() };
    let body = BodyDef { velocity: vec2(0, 1_000_000), angular_velocity: fx!(1_000_000), ..BodyDef::dynamic() };
    let (mut world, body) = one_body(
        WorldDef { linear_damping: world_damping, angular_damping: world_damping, ..def },
        BodyDef { linear_damping: body_damping, angular_damping: body_damping, ..body },
    );
    assert!(world.step().faults.is_empty());
    let body = world.body(body).expect("it is there");
    [body.velocity_exact().y.to_bits(), body.angular_velocity_exact().to_bits()]
}

#[test]
fn a_step_leaves_what_its_rate_of_damping_says_however_strong() {
    let rates =
        ["0.001", "0.1", "1", "3.999", "4", "4.001", "10", "15", "22.8", "22.9", "60", "1000", "12345.678", "1000000"];
    let rates = rates.map(|text| text.parse::<Fx>().expect("a number")).into_iter().chain([Fx::DELTA, Fx::MAX]);
    let steps = [1000, 240, 144, 60, 30].map(TimeStep::hz).into_iter().chain([TimeStep::ratio(1001, 60_000)]);
    for (rate, step) in rates.flat_map(|rate| steps.clone().map(move |step| (rate, step))) {
        // The documented bound: of the share of a second up to 4/s, of the rate above.
        let bound = if rate <= fx!(4) { seconds(step, 1) >> 27 } else { real(1) >> 60 };
        let left = real(1_000_000) * (-(exact(rate) * seconds(step, 1))).exp();
        // What is below half an ulp is cleared.
        let allowed = &left * bound + (real(1) >> 33);
        for integrator in Integrator::ALL {
            // It steps back in time, where nothing comes back.
            if integrator == Integrator::Yoshida4 && rate > fx!(22.87) {
                continue;
            }
            for (is_own, velocity) in [true, false].into_iter().flat_map(|is_own| {
                left_by_a_step(Damping::rate(rate), step, integrator, is_own).map(move |velocity| (is_own, velocity))
            }) {
                let off = units(velocity, 96) - &left;
                let off = if off < real(0) { -off } else { off };
                let relative = to_f64(&off) / to_f64(&left);
                assert!(off <= allowed, "{rate}/s at {step:?}, {}, own: {is_own}: {relative:e} off", integrator.name());
            }
        }
    }
}

#[test]
fn nothing_jumps_where_a_damping_begins_to_hold_its_rate() {
    let border = fx!(4);
    let [below, above] = [border - Fx::DELTA, border + Fx::DELTA].map(Damping::rate);
    assert_eq!((below.strong_rate(), above.strong_rate()), (None, Some(border + Fx::DELTA)));
    for step in [1, 30, 60, 1000].map(TimeStep::hz) {
        for integrator in Integrator::ALL {
            for (less, more) in left_by_a_step(below, step, integrator, true)
                .into_iter()
                .zip(left_by_a_step(above, step, integrator, true))
            {
                let seconds = to_f64(&seconds(step, 1));
                let share = (less - more) as f64 / less as f64;
                // Two ulps of the rate between them, and half an ulp of a share of e^-4, 2^-27.2, either way.
                assert!(share.abs() <= seconds * 7.5e-9, "{} at {step:?}: {share:e}", integrator.name());
            }
        }
    }
}

#[test]
fn damping_never_increases_speed() {
    let shares = [fx!(0.999999), fx!(0.5), fx!(0.0001), Fx::from_bits(1), fx!(0)].map(Damping::kept_per_second);
    let rates = [Fx::DELTA, fx!(5), fx!(23), fx!(1000), Fx::MAX].map(Damping::rate);
    for damping in shares.into_iter().chain(rates) {
        let (mut world, body) = one_body(
            WorldDef { linear_damping: damping, sleep_after: None, ..WorldDef::default() },
            BodyDef { velocity: vec2(fx!(1000), fx!(-0.001)), ..BodyDef::dynamic() },
        );
        let mut before = world.body(body).expect("it is there").velocity_exact();
        for _ in 0..10_000 {
            world.step();
            let after = world.body(body).expect("it is there").velocity_exact();
            assert!(after.x <= before.x && after.y >= before.y, "{damping:?}");
            assert!(after.x >= Default::default() && after.y <= Default::default(), "{damping:?}");
            before = after;
        }
    }
}
