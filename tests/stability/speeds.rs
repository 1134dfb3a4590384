//! Speeds from below an ulp a second to the envelope.

use umbra_physics::limits::{POSITION, SPEED};
use umbra_physics::scalar::Accumulator;
use umbra_physics::{
    BodyDef, BodyId, Cause, Fx, FxAccumulator, Mass, Scalar, TimeStep, Vec2, World, WorldDef, fx, vec2,
};

use crate::seeds::is_short;

const ULP: Fx = Fx::DELTA;

fn world<S: Scalar>(rate: u32, gravity: Fx, body: BodyDef<S>) -> (World<S>, BodyId) {
    let gravity = Vec2::new(S::from_fx(gravity), S::ZERO);
    let def = WorldDef { time_step: TimeStep::hz(rate), gravity, sleep_after: None, ..WorldDef::default() };
    let mut world = World::with_scalar(def).expect("a fair definition");
    let body = world.add_body(body).expect("a fair body");
    (world, body)
}

fn run<S: Scalar>(world: &mut World<S>, steps: u32) {
    (0..steps).for_each(|_| assert!(world.step().faults.is_empty()));
}

fn place(world: &World, body: BodyId) -> FxAccumulator {
    world.body(body).expect("it is there").position_exact().x
}

/// In units of 2^-96.
fn units(value: FxAccumulator) -> i128 {
    Accumulator::to_bits(value)
}

/// ulps · 2^64, in the same.
fn ulps(count: i128) -> i128 {
    count << 64
}

#[test]
fn half_an_ulp_a_second_moves_nothing_and_a_bit_more_moves_an_ulp_a_second() {
    // An impulse of an ulp gives 2 kg half of one; 3 kg get two thirds from two.
    for (mass, impulse, moves) in [(fx!(2), ULP, 0), (fx!(3), ULP + ULP, 1), (fx!(0.75), ULP, 1)] {
        let (mut world, body) = world(64, fx!(0), BodyDef { mass: Mass::Kilograms(mass), ..BodyDef::dynamic() });
        world.apply_impulse(body, vec2(impulse, 0)).expect("a small impulse");
        run(&mut world, 640);
        assert_eq!(units(place(&world, body)), ulps(10 * moves), "{mass} kg");
        // Whether it moves or not, the velocity is all there: the same impulse against it leaves none.
        world.apply_impulse(body, vec2(-impulse, 0)).expect("a small impulse");
        assert_eq!(world.body(body).expect("it is there").velocity_exact().x, FxAccumulator::default());
    }
}

#[test]
fn an_acceleration_of_an_ulp_adds_up_from_kicks_of_a_ten_thousandth_of_one() {
    // The velocity shows after half a second.
    let (rate, seconds) = (10_000, if is_short() { 4 } else { 100 });
    let (mut world, body) = world(rate, ULP, BodyDef::dynamic());
    run(&mut world, rate / 2 - 1);
    assert_eq!(units(place(&world, body)), 0, "less than half an ulp a second");
    run(&mut world, rate * seconds - rate / 2 + 1);
    let v = units(world.body(body).expect("it is there").velocity_exact().x);
    let t = i128::from(seconds);
    // Two half kicks a step, each rounded to a unit of 2^-96.
    assert!((v - ulps(t)).abs() <= i128::from(rate * seconds), "{v}");
    // The public velocity is a staircase about g·t: ½·g·t² of it, and half an ulp a second more or less.
    let off = units(place(&world, body)) - ulps(t * t) / 2;
    assert!(off.abs() <= ulps(t) / 2, "{off}");
}

/// The way in 10 s at 10,000 Hz, from a far place, at a low speed.
fn crawl<S: Scalar>(from: Fx, speed: Fx) -> (Vec2<S>, Vec2<S>) {
    let (position, velocity) = (Vec2::new(S::from_fx(from), S::ZERO), Vec2::new(S::from_fx(speed), S::ZERO));
    let (mut world, body) = world(10_000, fx!(0), BodyDef { position, velocity, ..BodyDef::dynamic() });
    run(&mut world, 100_000);
    (position, world.body(body).expect("it is there").position())
}

#[test]
fn the_lowest_speeds_are_exact_at_the_fastest_rate_and_the_edge_of_the_world() {
    for speed in [ULP, fx!(0.000001), fx!(0.01)] {
        for from in [fx!(0), POSITION - fx!(1)] {
            let (start, end) = crawl::<Fx>(from, speed);
            assert_eq!(end.x - start.x, speed * fx!(10), "{speed} m/s from {from} m");
        }
    }
}

#[test]
fn doubles_and_singles_lose_a_step_of_the_lowest_speeds() {
    // A hundredth of a micrometre is below half an ulp of a double at 2^30 m; a micrometre below that of a single at 1
    // km.
    let (start, end) = crawl::<f64>(POSITION - fx!(1), fx!(0.0001));
    assert_eq!(start, end);
    let (start, end) = crawl::<f32>(fx!(1000), fx!(0.01));
    assert_eq!(start, end);
}

#[test]
fn the_highest_speed_is_exact_from_one_end_of_the_world_to_the_other() {
    // Powers of two: a step that is rounded may end a hair beyond.
    let rates: &[u32] = if is_short() { &[1, 64] } else { &[1, 64, 512] };
    for &rate in rates {
        let (position, velocity) = (Vec2::new(-POSITION, POSITION), Vec2::new(SPEED, -SPEED));
        let (mut world, body) = world(rate, fx!(0), BodyDef { position, velocity, ..BodyDef::dynamic() });
        // 2^31 m at 2^20 m/s.
        run(&mut world, 2048 * rate);
        let end = world.body(body).expect("it is there").position();
        assert_eq!(end, vec2(POSITION, -POSITION), "{rate} Hz");
        // The next step leaves the world.
        let faults = world.step().faults.to_vec();
        assert_eq!(faults.iter().map(|fault| (fault.body, fault.cause)).collect::<Vec<_>>(), [(body, Cause::Position)]);
        assert_eq!(world.body(body).expect("it is there").position(), end);
    }
}
