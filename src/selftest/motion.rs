//! Motion by itself: constant forces, time, damping, angles, and an orbit by each integrator.

use super::trial::{
    Flight, Numbers, Played, Trial, add_all, exact, happened, near, near_fx, near_turn, near_vec, near_wide, same,
    there,
};
use crate::body::{BodyDef, Damping, Mass};
use crate::error::Error;
use crate::force::{Attachment, End, FieldKind};
use crate::fx::{Fx, fx};
use crate::integrate::Integrator;
use crate::math::{Elapsed, TimeStep, Vec2, vec2};
use crate::scalar::{FxFactor, FxWide, Turn};
use crate::world::{World, WorldDef};

pub(super) fn free_fall(trial: &mut Trial) -> Played {
    let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
    let masses = (0..=20).map(|i| BodyDef {
        mass: Mass::Kilograms(Fx::from_bits(1 << (16 + 2 * i))),
        position: vec2(i, 1000),
        ..BodyDef::dynamic()
    });
    let ids = add_all(&mut world, masses)?;
    for n in 1..=600 {
        trial.step(&mut world);
        let first = world.body(ids[0])?;
        // 1000 − ½·10·(n/60)².
        near_fx("height of a fall", first.position().y, Fx::from_ratio(720_000 - n * n, 720), 1)?;
        for &id in &ids {
            let body = world.body(id)?;
            let motion = (body.position_exact().y, body.velocity_exact());
            same("the fall of two masses", &motion, &(first.position_exact().y, first.velocity_exact()))?;
        }
    }
    let (light, heavy) = (world.body(ids[0])?.mass(), world.body(ids[20])?.mass());
    happened("masses from end to end", (light, heavy) == (Some(crate::limits::MASS_MIN), Some(crate::limits::MASS_MAX)))
}

pub(super) fn time_steps(trial: &mut Trial) -> Played {
    let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
    let start = BodyDef { position: vec2(-100, 1000), velocity: vec2(200, 0), ..BodyDef::dynamic() };
    let id = world.add_body(BodyDef { angular_velocity: fx!(7), ..start })?;
    for step in [TimeStep::hz(60), TimeStep::ratio(1001, 60_000), TimeStep::hz(100)] {
        world.set_time_step(step)?;
        trial.steps(&mut world, 100);
    }
    // 100/60 + 100·1001/60000 + 100/100 s.
    same("elapsed time", &world.elapsed(), &Elapsed { num: 867, den: 200 })?;
    let body = world.body(id)?;
    near_fx("way at constant speed", body.position().x, fx!(767), 1)?;
    near_fx("height of a fall", body.position().y, Fx::from_ratio(40_000_000 - 5 * 867 * 867, 40_000), 2)?;
    near_fx("speed of a fall", body.velocity().y, fx!(-43.35), 1)?;
    // Half an ulp of 30.345 rad is 2^28.4 of these units, each step adds half of one.
    near_turn("angle", body.angle_exact(), Turn::from_radians(fx!(30.345)), 1 << 29)
}

/// Constant gravity and a constant force, by each integrator for 60 steps. With h = 1/64 s and a = −8 m/s² all is a
/// multiple of 2^-13, and nothing rounds but in Yoshida's irrational weights.
pub(super) fn integrators_in_turn(trial: &mut Trial) -> Played {
    const N: i64 = 60;
    let mut world = World::new(WorldDef { gravity: vec2(0, -8), ..exact() })?;
    let falling = world.add_body(BodyDef { velocity: vec2(0, 32), ..BodyDef::dynamic() })?;
    let pushed = world.add_body(BodyDef { velocity: vec2(0, 32), gravity_scale: fx!(0), ..BodyDef::dynamic() })?;
    world.add_field(FieldKind::Thrust { at: Attachment::centre(pushed), force: vec2(0, -8) })?;
    let mut expected = Flight::new(fx!(0), fx!(32));
    // The gain of a velocity in a step, and half of that of a position.
    let (gain, half) = (fx!(-8).to_bits() / 64, fx!(-8).to_bits() / (2 * 64 * 64));
    for integrator in Integrator::ALL {
        world.set_integrator(integrator)?;
        trial.steps(&mut world, N as u32);
        let v = expected.v;
        expected.fly(fx!(-8), N);
        match integrator {
            // x with the old velocity: Σ (i − 1) where the exact flight has Σ (i − ½); with the new one: Σ i.
            Integrator::ExplicitEuler => expected.x -= half * N,
            Integrator::SymplecticEuler => expected.x += half * N,
            // From a last acceleration of zero its velocity gains half a step less.
            Integrator::PublishedVerlet => {
                expected.x += half * N;
                expected.v = v + gain * N - gain / 2;
            }
            Integrator::VelocityVerlet | Integrator::Yoshida4 => {}
        }
        // Yoshida's drifts go with velocities to the ulp, 60·3 of them over less than 2/64 s: below 3 ulps.
        let bound = if integrator == Integrator::Yoshida4 { 3 } else { 0 };
        for id in [falling, pushed] {
            let body = world.body(id)?;
            near("place by an integrator", body.position().y.to_bits().into(), expected.x.into(), bound)?;
            near("velocity by an integrator", body.velocity().y.to_bits().into(), expected.v.into(), bound)?;
        }
    }
    Ok(())
}

pub(super) fn damping(trial: &mut Trial) -> Played {
    let (half, quarter) = (fx!(0.5), fx!(0.25));
    let [linear_damping, angular_damping] = [half, quarter].map(Damping::kept_per_second);
    let mut world = World::new(WorldDef { linear_damping, angular_damping, ..WorldDef::default() })?;
    let dampings = [
        (None, None),
        (Some(fx!(1)), None),
        (None, Some(fx!(1))),
        (Some(fx!(0.0625)), Some(fx!(0.9375))),
        (Some(fx!(0)), Some(fx!(0))),
        (Some(fx!(0.9375)), Some(half)),
    ];
    let bodies = dampings.map(|(linear, angular)| BodyDef {
        velocity: vec2(1024, -512),
        angular_velocity: fx!(256),
        linear_damping: linear.map(Damping::kept_per_second),
        angular_damping: angular.map(Damping::kept_per_second),
        ..BodyDef::dynamic()
    });
    let ids = add_all(&mut world, bodies)?;
    let mut left = dampings.map(|_| (fx!(1), fx!(1)));
    for _ in 0..4 {
        trial.steps(&mut world, 60);
        for ((id, left), damping) in ids.iter().zip(&mut left).zip(dampings) {
            // Powers of these have few digits: no product rounds.
            *left = (left.0 * damping.0.unwrap_or(half), left.1 * damping.1.unwrap_or(quarter));
            let body = world.body(*id)?;
            near_vec("what damping leaves", body.velocity(), Vec2::new(left.0 * fx!(1024), left.0 * fx!(-512)), 1)?;
            near_fx("what damping leaves of spin", body.angular_velocity(), left.1 * fx!(256), 1)?;
        }
    }
    near_fx("way of the undamped", world.body(ids[1])?.position().x, fx!(4096), 1)?;
    same("place of one that is stopped at once", &world.body(ids[4])?.position(), &vec2(0, 0))
}

pub(super) fn strong_damping(trial: &mut Trial) -> Played {
    let [linear_damping, angular_damping] = [fx!(60), fx!(30)].map(Damping::rate);
    let mut world = World::new(WorldDef { linear_damping, angular_damping, ..WorldDef::default() })?;
    // Rates of bodies, and what such a rate loses in a step: the negative logarithm of what it leaves.
    let dampings = [(None, None), (Some(fx!(120)), Some(fx!(15))), (Some(fx!(1)), Some(fx!(600)))];
    let losses = [(fx!(1), fx!(0.5)), (fx!(2), fx!(0.25)), (fx!(1 / 60), fx!(10))];
    let bodies = dampings.map(|(linear, angular)| BodyDef {
        velocity: vec2(1, -1),
        angular_velocity: fx!(1),
        linear_damping: linear.map(Damping::rate),
        angular_damping: angular.map(Damping::rate),
        ..BodyDef::dynamic()
    });
    let ids = add_all(&mut world, bodies)?;
    for tick in 1..=90 {
        trial.step(&mut world);
        for (id, loss) in ids.iter().zip(losses) {
            // The exponential, rounded; a 60th and what a velocity keeps of an ulp make another one.
            let left = |loss: Fx| Damping::rate(loss * Fx::from_int(tick)).kept();
            let body = world.body(*id)?;
            near_vec("what a strong damping leaves", body.velocity(), Vec2::new(left(loss.0), -left(loss.0)), 50)?;
            near_fx("what a strong damping leaves of spin", body.angular_velocity(), left(loss.1), 50)?;
        }
    }
    Ok(())
}

pub(super) fn gravity_scales(trial: &mut Trial) -> Played {
    let mut world = World::new(WorldDef { gravity: vec2(0, -8), ..exact() })?;
    let scales = [fx!(-16), fx!(-1), fx!(0), fx!(0.5), fx!(1), fx!(16)];
    let bodies = scales.map(|gravity_scale| BodyDef { gravity_scale, velocity: vec2(0, 4), ..BodyDef::dynamic() });
    let ids = add_all(&mut world, bodies)?;
    let mut flights = scales.map(|_| Flight::new(fx!(0), fx!(4)));
    for (gravity, factor) in [(fx!(-8), fx!(1)), (fx!(-8), fx!(-0.5)), (fx!(4), fx!(0.25))] {
        world.set_gravity(Vec2::new(fx!(0), gravity))?;
        for (&id, scale) in ids.iter().zip(scales) {
            world.set_gravity_scale(id, scale * factor)?;
        }
        trial.steps(&mut world, 64);
        for ((&id, flight), scale) in ids.iter().zip(&mut flights).zip(scales) {
            flight.fly(gravity * scale * factor, 64);
            let body = world.body(id)?;
            same("place by gravity scale", &body.position().y.to_bits(), &flight.x)?;
            same("velocity by gravity scale", &body.velocity().y.to_bits(), &flight.v)?;
        }
    }
    Ok(())
}

pub(super) fn many_turns(trial: &mut Trial) -> Played {
    let mut world = World::new(exact())?;
    let mut numbers = Numbers(1);
    let mut spins =
        alloc::vec![crate::limits::ANGULAR_SPEED, -crate::limits::ANGULAR_SPEED, Fx::DELTA, fx!(3), fx!(-3)];
    spins.extend((0..20).map(|_| numbers.fx(20)));
    let bodies = spins.iter().map(|&angular_velocity| BodyDef { angular_velocity, ..BodyDef::dynamic() });
    let ids = add_all(&mut world, bodies)?;
    trial.steps(&mut world, 512);
    let mut turns = 0;
    for (&id, &spin) in ids.iter().zip(&spins) {
        // 512/64 s, and eight times a spin is exact.
        let radians = spin * fx!(8);
        // The factor of a step is exact to 2^-64, and 2^23 rad are below 2^21 turns; each of 512 steps rounds once.
        near_turn(
            "angle after many turns",
            world.body(id)?.angle_exact(),
            Turn::from_radians(radians),
            (1 << 21) + 512,
        )?;
        turns += (radians / Fx::TAU).abs().floor().to_bits() >> 32;
    }
    happened("millions of turns", turns > 2_000_000)
}

const ORBIT_MU: u64 = 1000;

fn orbiting(integrator: Integrator, rate: u32) -> Result<World, Error> {
    let mut world = World::new(WorldDef { time_step: TimeStep::hz(rate), integrator, ..WorldDef::default() })?;
    let start = BodyDef { position: vec2(10, 0), velocity: vec2(0, 9), ..BodyDef::dynamic() };
    world.add_body(start)?;
    let mu = FxFactor::from_ratio(ORBIT_MU, 1);
    world.add_field(FieldKind::Attractor { centre: End::World(vec2(0, 0)), mu, softening: fx!(0) })?;
    Ok(world)
}

/// A Kepler ellipse. Steps of half and a quarter of the length show the order; energy and r × v show the kind.
pub(super) fn orbit(trial: &mut Trial, integrator: Integrator) -> Played {
    let mut world = orbiting(integrator, 60)?;
    let energy = world.energy()?;
    let before = world.angular_momentum()?;
    trial.steps(&mut world, 60);
    let after_second = places(&world)?;
    let finer = |rate| -> Result<_, Error> {
        let mut world = orbiting(integrator, rate)?;
        (0..rate).for_each(|_| _ = world.step());
        places(&world)
    };
    let (half, quarter) = (finer(120)?, finer(240)?);
    let apart = |a: Vec2, b: Vec2| there("a distance", (a - b).checked_length());
    let ratio = apart(after_second, half)? / apart(half, quarter)?;
    let order = fx!(1) * Fx::from_int(1 << integrator.order());
    // The next power of the step adds a share of the order of ω·h = 1/60 times a small number.
    near_fx("order of convergence", ratio / order, fx!(1), fx!(0.25).to_bits() as u32)?;
    trial.steps(&mut world, 540);
    let gained = there("a gain of energy", world.energy()?.plus(energy.negated()))?;
    // From −59.5 J.
    let joule = |joules: i32| FxWide::from_scalar(Fx::from_int(joules));
    match integrator {
        Integrator::ExplicitEuler => happened("a gain of energy", gained > joule(10))?,
        _ => happened("energy about the same", gained < joule(5) && gained > joule(-5))?,
    }
    let keeps = !matches!(integrator, Integrator::ExplicitEuler | Integrator::PublishedVerlet);
    if keeps {
        // Kicks are radial and drifts along v. What is rounded: the drift's velocity to ½ ulp, whose sum over 10 s is
        // within 10 s · ½ ulp · √2 in place at 10 m/s and less; the two of them read to ½ ulp at 14 m and 12 m/s.
        let ulps = 100;
        near_wide("angular momentum", world.angular_momentum()?, before, ulps << 32)?;
    }
    Ok(())
}

fn places(world: &World) -> Result<Vec2, Error> {
    let place = world.bodies().next().map(|body| body.position_exact().map(|x| x.value()));
    place.ok_or(Error::Full)
}
