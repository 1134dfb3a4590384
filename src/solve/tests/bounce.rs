//! Restitution against Newton's hypothesis, and its energy.

use alloc::vec::Vec;

use super::super::motion::{Begin, FlightRow, Rows};
use super::scene::{Scene, body, contact, fixed, fx, signed, unit, vec};
use crate::cases::run_seed;
use crate::kernel::simd::{Job as _, Portable};
use crate::math::Random;
use crate::scalar::FxAccumulator;
use crate::solve::{Contact, Flight, Velocity};

const TICK: f64 = 1.0 / 60.0;
const GRAVITY: f64 = 10.0;

fn to_f64(value: FxAccumulator) -> f64 {
    value.to_bits() as f64 / 2f64.powi(96)
}

/// A body of radius 0.5 m that falls for a step, at a velocity along y at its start.
fn falling(mass: f64, speed: f64) -> Flight {
    let flight = body(mass, 8.0 / mass, 0.5).flying([0.0, speed, 0.0], TICK);
    let end = Velocity { linear: vec(0.0, speed - GRAVITY * TICK), ..flight.end };
    let displacement = vec(0.0, (speed - GRAVITY * TICK / 2.0) * TICK);
    Flight { end, displacement, ..flight }
}

/// A contact of the first body with the second body above it.
fn above(bodies: [u32; 2], separation: f64, restitution: f64) -> Contact {
    let contact = contact(bodies, [0.0, 1.0], &[([0.0, 0.5], [0.0, -0.5], separation)]);
    Contact { restitution: fx(restitution), ..contact }
}

/// The velocities of bodies along y at the end of the step.
fn velocities(scene: &Scene) -> Vec<f64> {
    let corrections = scene.solve().corrections;
    scene
        .flights
        .iter()
        .zip(&corrections)
        .map(|(flight, correction)| {
            let free_velocity = flight.end.linear.y.to_bits() as f64 / 2f64.powi(32);
            free_velocity + to_f64(correction.velocity.y)
        })
        .collect()
}

/// A ball above a floor: in whichever sub-step it arrives, its energy after the bounce is e² times its energy at the impact. If it
/// does not bounce in this step, it goes on in free flight.
#[test]
fn a_ball_leaves_with_its_share_of_the_energy() {
    let mut random = Random::seeded(run_seed(1));
    let (mut bounced, mut slowed, mut went_on) = (0, 0, 0);
    for case in 0..3000 {
        let speed = 1.5 + 20.0 * unit(&mut random);
        let e = 0.01 + 0.99 * unit(&mut random);
        let separation = 1.5 * unit(&mut random) * speed * TICK;
        let mut scene =
            Scene::new(alloc::vec![fixed(4.0), falling(1.0, -speed)], alloc::vec![above([0, 1], separation, e)]);
        scene.options.substeps = 1 + case % 16;
        let correction = scene.solve().corrections[1];
        let displaced = scene.flights[1].displacement.y.to_bits() as f64 / 2f64.powi(32);
        let gap = (separation + displaced + to_f64(correction.displacement.y)).max(0.0);
        let after = velocities(&scene)[1];
        if correction.velocity.y.to_bits() == 0 {
            went_on += 1;
            assert!(gap > 0.0 && after < 0.0, "case {case}: {after} m/s at {gap} m");
            continue;
        }
        bounced += 1;
        let energy_before = speed * speed + 2.0 * GRAVITY * separation;
        let energy_after = after * after + 2.0 * GRAVITY * gap;
        // A bounce whose top is below the gap stays there.
        let expected = (e * e * energy_before).max(2.0 * GRAVITY * gap);
        // A ball that falls again before the step ends closes below the speed of impacts: the contact slows it ahead of its second landing.
        let impact_speed = energy_before.sqrt();
        let time_left = TICK - (impact_speed - speed) / GRAVITY;
        let lowest = if e * impact_speed < GRAVITY * time_left { 2.0 * GRAVITY * gap } else { expected };
        let tolerance = 1e-3 * energy_before;
        slowed += u32::from(energy_after <= expected - tolerance);
        assert!(
            energy_after < expected + tolerance && energy_after > lowest - tolerance,
            "case {case}: {energy_after} instead of {expected}, {gap} m"
        );
    }
    assert!(bounced > 1500 && went_on > 300 && slowed < 30, "{bounced}, {slowed} of them slowed, {went_on}");
}

#[test]
fn pairs_part_at_their_share_of_the_speed() {
    let mut random = Random::seeded(run_seed(2));
    for case in 0..1000 {
        let mass = 2f64.powi((case % 21) - 10);
        let speed = 2.0 + 20.0 * unit(&mut random);
        let e = unit(&mut random);
        let drift = 4.0 * signed(&mut random);
        let flight = |mass: f64, speed: f64| body(mass, 8.0 / mass, 0.5).flying([0.0, speed, 0.0], TICK);
        let flights = alloc::vec![flight(1.0, drift + speed), flight(mass, drift)];
        let after = velocities(&Scene::new(flights, alloc::vec![above([0, 1], 0.0, e)]));
        let parting = after[1] - after[0];
        assert!((parting - e * speed).abs() < 1e-4 * speed, "case {case}: {parting} instead of {}", e * speed);
    }
}

/// Bodies on top of each other that land together, some of them with gaps, have no more energy than before.
#[test]
fn stacks_that_land_gain_no_energy() {
    let mut random = Random::seeded(run_seed(3));
    for case in 0..1000 {
        let count = 2 + case % 9;
        let masses: Vec<f64> = (0..count).map(|_| 4f64.powf(signed(&mut random))).collect();
        let speed = 2.0 + 10.0 * unit(&mut random);
        let flights: Vec<_> = masses.iter().map(|&mass| falling(mass, -speed)).collect();
        let contacts = (0..count as u32).map(|i| match i {
            0 => above([count as u32, 0], 0.0, 1.0),
            _ => {
                let gap = if case % 2 == 0 { 0.0 } else { 0.02 * unit(&mut random) };
                above([i - 1, i], gap, unit(&mut random))
            }
        });
        let contacts = contacts.collect();
        let scene = Scene::new(flights.into_iter().chain([fixed(4.0)]).collect(), contacts);
        let energy = |velocity: f64, mass: f64| mass * velocity * velocity / 2.0;
        let initial_energy: f64 = masses.iter().map(|&mass| energy(speed + GRAVITY * TICK, mass)).sum();
        let final_energy: f64 =
            velocities(&scene).iter().zip(&masses).map(|(&velocity, &mass)| energy(velocity, mass)).sum();
        assert!(final_energy < initial_energy * (1.0 + 1e-6), "case {case}: {final_energy} J of {initial_energy} J");
    }
}

/// A light body under a stack that lands: the impulses on it are far larger than their sum.
#[test]
fn light_bodies_under_stacks_that_land_gain_no_energy() {
    let mut random = Random::seeded(run_seed(4));
    for case in 0..600 {
        let count = 2 + case % 7;
        let light = 2f64.powi(-(case % 20));
        let heavy = 2f64.powi(case / 20 % 22);
        let masses = (0..count).map(|i| if i == 0 { light } else { heavy * 4f64.powf(unit(&mut random)) });
        let masses: Vec<f64> = masses.collect();
        let speed = 2.0 + 10.0 * unit(&mut random);
        let flights: Vec<_> = masses.iter().map(|&mass| falling(mass, -speed)).collect();
        let contacts = (0..count as u32).map(|i| match i {
            0 => above([count as u32, 0], 0.0, unit(&mut random)),
            _ => above([i - 1, i], 0.0, unit(&mut random)),
        });
        let contacts = contacts.collect();
        let scene = Scene::new(flights.into_iter().chain([fixed(4.0)]).collect(), contacts);
        let energy = |velocity: f64, mass: f64| mass * velocity * velocity / 2.0;
        let initial_energy: f64 = masses.iter().map(|&mass| energy(speed + GRAVITY * TICK, mass)).sum();
        let velocities = velocities(&scene);
        let final_energy: f64 = velocities.iter().zip(&masses).map(|(&velocity, &mass)| energy(velocity, mass)).sum();
        assert!(
            final_energy < initial_energy * (1.0 + 1e-6),
            "case {case}, {light} under {heavy} kg: {final_energy} J of {initial_energy} J, {velocities:?}"
        );
    }
}

/// Impulses of up to twice the change by the flight hold a body against it; larger ones stop or push it, and impacts take its flight as free.
#[test]
fn contacts_that_push_harder_than_the_flight_are_no_support() {
    // By a velocity of 1,000 units in a step of five sub-steps.
    let flight = FlightRow { start: [70, -30, 5, 0], change: [600, -800, 0, 0] };
    for (push, is_support) in [
        ([0, 0, 0], true),
        ([-120, 160, 0], true),
        ([0, 240, 320], true),
        ([0, 400, 0], true),
        ([0, 401, 0], false),
        ([-300, 200, 180], false),
        ([0, -4_000, 0], false),
    ] {
        for k in [1, 3] {
            let mut rows = Rows::default();
            let row = rows.push(flight, 1 << 20);
            (1..=k).for_each(|k| Begin { rows: &mut rows, k, n: 5 }.run(Portable));
            // Its angle stands beside the velocity.
            rows.rows[row as usize].velocity[3] = 1 << 20;
            (0..3).for_each(|i| rows.rows[row as usize].velocity[i] += push[i]);
            let expected = if is_support { push.map(i64::from) } else { [0; 3] };
            assert_eq!(rows.support(row, 5), expected, "{push:?}, {k}");
        }
    }
}
