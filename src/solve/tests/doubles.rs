//! Steps of the solver beside the solver in floats, its twin in doubles.
//!
//! No formula bounds how far rounding may lead: points that open or close, and bodies split among many contacts, amplify it. So
//! the twin runs again with roundings of its own, at random and of the size of the solver's; the solver has to be about as
//! close to the exact twin as the twins that round.
//!
//! The twin has the solver's clamps by design: couplings and compliances are at most a quarter of a unit of velocity for a unit of impulse,
//! as all factors of velocities are. Velocities and displacements do not saturate there: the unit has to leave room for them.

use alloc::vec::Vec;

use super::made::Ranges;
use super::scene::Scene;
use crate::cases::{run_seed, times};
use crate::fx;
use crate::math::Random;
use crate::scalar::ToF64 as _;
use crate::solve::float::rounding::{BodyUnits, ContactUnits, Rounding};
use crate::solve::unit::FINEST;
use crate::solve::{ContactSolver as _, Correction, FloatSolver, PHASES, Solver};

/// Components x, y and angular.
type Vector = [f64; 3];

/// The resolutions of the solver in a scene, and how fast it pushes overlaps out.
fn rounding(scene: &Scene) -> Rounding {
    let mut solver = Solver::default();
    solver.prepare(scene.time_step, &scene.options, &scene.flights, &[], &scene.contacts);
    let bodies = scene.flights.iter().zip(&solver.bodies.bodies).map(|(flight, body)| {
        // Bodies that are fixed or touch nothing have no unit.
        let unit = 2f64.powi(if body.unit == 0 { FINEST } else { body.unit });
        let length = 2f64.powi(flight.length());
        BodyUnits { velocity: [unit, unit, unit / length], length }
    });
    let bodies: Vec<_> = bodies.collect();
    let contacts = scene.contacts.iter().enumerate().map(|(index, contact)| {
        assert!(solver.graph.phase(contact.bodies) < PHASES, "one body of each contact can be moved");
        let place = solver.groups.places.iter().find(|place| place.contact as usize == index).expect("all have places");
        let mover = solver.graph.mover(contact.bodies).expect("one can be moved");
        let group = &solver.groups.groups[place.group as usize];
        let lane = place.lane as usize;
        let unit = bodies[mover as usize].velocity[0];
        let [rate, deepest] = group.push_out[lane].map(f64::from);
        ContactUnits {
            velocity: unit,
            impulse: 2f64.powi(place.exponent),
            angular_shift: group.angular_shift[lane] as i32,
            push: -rate * deepest * 2f64.powi(-30) * unit,
        }
    });
    let contacts = contacts.collect();
    Rounding { random: None, bodies, contacts }
}

/// The corrections of the exact twin, or of one that rounds at random.
fn twin(scene: &Scene, seed: Option<u64>) -> Vec<Correction> {
    let mut rounding = rounding(scene);
    rounding.random = seed.map(Random::seeded);
    let mut solver = FloatSolver::default();
    solver.rounding = rounding;
    let mut contacts = scene.contacts.clone();
    let mut corrections = Vec::new();
    solver.solve(scene.time_step, &scene.options, &scene.flights, &mut [], &mut contacts, &mut corrections);
    corrections
}

/// The changes of velocities and of displacements of all bodies, in units of the solver.
fn in_units(scene: &Scene, corrections: &[Correction]) -> Vec<[Vector; 2]> {
    let (num, den) = scene.time_step.seconds();
    let step = f64::from(num) / f64::from(den);
    let units = rounding(scene).bodies;
    corrections
        .iter()
        .zip(&units)
        .map(|(correction, BodyUnits { velocity: unit, .. })| {
            let velocity = [correction.velocity.x, correction.velocity.y, correction.angular_velocity];
            let displacement = [correction.displacement.x, correction.displacement.y, correction.rotation];
            [
                [0, 1, 2].map(|i| velocity[i].to_f64() / unit[i]),
                [0, 1, 2].map(|i| displacement[i].to_f64() / (step * unit[i])),
            ]
        })
        .collect()
}

/// The largest difference of any component.
fn largest_difference(a: &[[Vector; 2]], b: &[[Vector; 2]]) -> f64 {
    let [a, b] = [a, b].map(|changes| changes.as_flattened().as_flattened());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn steps_follow_a_twin_in_doubles() {
    let mut random = Random::seeded(run_seed(1));
    let cases = times(300);
    let (mut close, mut touching, mut cut) = (0, 0, 0);
    for case in 0..cases {
        let separation = [[-0.05, 0.0], [-0.05, 0.05], [0.0, 0.05]][random.below(3) as usize];
        let ranges = Ranges { separation, mass: [-2.0, 2.0], ..Ranges::default() };
        let contacts = 1 + random.below(6) as usize;
        let mut scene = ranges.scene(&mut random, 4, contacts);
        scene.options.substeps = 1 + random.below(16) as u32;
        scene.options.relax_passes = if random.below(8) == 0 { 65 } else { 1 };
        // The twin has no impacts: none is so fast.
        scene.options.restitution_speed = fx!(1024);
        let solution = scene.solve();
        if solution.counts.cut != 0 {
            // A jam that many passes press together.
            assert_eq!(scene.options.relax_passes, 65, "case {case}");
            cut += 1;
            continue;
        }
        let solver_changes = in_units(&scene, &solution.corrections);
        let exact_changes = in_units(&scene, &twin(&scene, None));
        let error = largest_difference(&exact_changes, &solver_changes);
        // Twins that round at random show how far rounding may lead: 24 of them, or more where a contact opens in few of them.
        let mut rounding = 0.0_f64;
        for seed in 0..1000 {
            let rounded_changes = in_units(&scene, &twin(&scene, Some(seed)));
            rounding = rounding.max(largest_difference(&exact_changes, &rounded_changes));
            if seed >= 23 && error <= 2.0 * rounding + 2.0 {
                break;
            }
        }
        assert!(
            error <= 2.0 * rounding + 2.0,
            "case {case}: {error} units from the twin, where rounding explains {rounding}"
        );
        touching += u32::from(solution.corrections.iter().any(|correction| correction.velocity.x.to_bits() != 0));
        close += u32::from(error < 64.0);
    }
    assert!(cut <= 2, "the impulses of {cut} scenes of {cases} are cut off");
    // Most are close: a few units, not only less than rounding could lead.
    assert!(touching > cases / 2 && close > cases / 2, "{touching} touch, {close} are close, of {cases}");
}
