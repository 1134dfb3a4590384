//! Fairness: the observer of a scene, and the order of its bodies and contacts, change no bit.

use alloc::vec::Vec;
use std::thread;

use super::made::Ranges;
use super::scene::{Image, Scene, Solution, body};
use crate::cases::run_seed;
use crate::fx::Fx;
use crate::kernel::simd::{Job, Portable};
use crate::math::Random;
use crate::solve::impact::SubStep;
use crate::solve::motion::{Advance, Begin};
use crate::solve::pass::{Pass, PassOver};
use crate::solve::unit::{COARSE, Clock};
use crate::solve::{Contact, Flight, Impulses, PHASES, Solver, SolverCounts};

/// Random scenes, each with a generator for its changes in a test. There are 3 bodies and fewer than `extra_bodies` more.
fn scenes(seed: u64, count: u64, extra_bodies: u64) -> impl Iterator<Item = (Scene, Random)> {
    let ranges = Ranges { restitution: 1.0, ..Ranges::default() };
    (0..count).map(move |index| {
        let mut random = Random::seeded(run_seed(seed << 32 | index));
        let bodies = 3 + random.below(extra_bodies);
        let contacts = 1 + random.below(2 * bodies);
        let mut scene = ranges.scene(&mut random, bodies as usize, contacts as usize);
        scene.options.substeps = 1 + random.below(8) as u32;
        scene.options.relax_passes = if random.below(8) == 0 { 1 + random.below(65) as u32 } else { 1 };
        (scene, random)
    })
}

fn is_moved(solution: &Solution) -> bool {
    solution.corrections.iter().any(|correction| *correction != Default::default())
}

/// The unit of an island follows from speeds: it is the same for a velocity and its opposite, also just below a power of two.
#[test]
fn opposite_velocities_have_one_speed() {
    for bits in 0..40 {
        for less in [0, 1, 1 << (32 - COARSE), 3 << (32 - COARSE)] {
            let [there, back] = [1, -1].map(|sign| {
                let velocity = Fx::from_bits(sign * ((1 << bits) - less));
                let mut flight = body(1.0, 2.0, 1.0);
                flight.end.linear.x = velocity;
                let mut spinning = body(1.0, 2.0, 1.0);
                spinning.start.angular = velocity;
                [flight.speed(0), spinning.speed(0), spinning.speed(12)]
            });
            assert_eq!(there, back, "2^{bits} - {less}");
        }
    }
}

#[test]
fn images_stay_images() {
    let (mut moved, mut rolled) = (0, 0);
    for (scene, _) in scenes(1, 400, 24) {
        let solution = scene.solve();
        moved += usize::from(is_moved(&solution));
        // The second impulse of a contact with one point is its rolling resistance.
        let with_rolling_negated = |image: fn(&Impulses) -> Impulses| {
            solution
                .impulses
                .iter()
                .zip(&scene.contacts)
                .map(|(impulses, contact)| {
                    let [first, second, tangential] = image(impulses).values;
                    let second = if contact.count == 1 { -second } else { second };
                    Impulses { values: [first, second, tangential], ..*impulses }
                })
                .collect()
        };
        rolled += solution
            .impulses
            .iter()
            .zip(&scene.contacts)
            .filter(|(impulses, contact)| contact.count == 1 && impulses.values[1] != 0)
            .count();
        let swapped_points = solution
            .impulses
            .iter()
            .zip(&scene.contacts)
            .map(|(impulses, contact)| if contact.count == 2 { impulses.with_points_swapped() } else { *impulses })
            .collect();
        let images = [
            (
                scene.image(Flight::mirrored, Contact::mirrored),
                Solution {
                    impulses: with_rolling_negated(Image::mirrored),
                    corrections: solution.corrections.iter().map(Image::mirrored).collect(),
                    ..solution
                },
            ),
            (
                scene.image(Flight::turned, Contact::turned),
                Solution { corrections: solution.corrections.iter().map(Image::turned).collect(), ..solution.clone() },
            ),
            (
                scene.image(Flight::swapped, Contact::swapped),
                Solution { impulses: with_rolling_negated(|impulses| *impulses), ..solution.clone() },
            ),
            (
                scene.image(Flight::with_points_swapped, Contact::with_points_swapped),
                Solution { impulses: swapped_points, ..solution.clone() },
            ),
        ];
        for (index, (image, expected)) in images.iter().enumerate() {
            assert_eq!(&image.solve(), expected, "image {index} of {scene:?}");
        }
    }
    assert!(moved > 300 && rolled > 50, "{moved}, {rolled}");
}

fn shuffled(random: &mut Random, count: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    random.shuffle(&mut order);
    order
}

/// The scene with body `bodies[i]` in place i, and contact `contacts[i]` in place i.
fn reordered(scene: &Scene, bodies: &[usize], contacts: &[usize]) -> Scene {
    let mut place = alloc::vec![0; bodies.len()];
    bodies.iter().enumerate().for_each(|(to, &from)| place[from] = to as u32);
    let moved = |&from: &usize| {
        let contact = scene.contacts[from];
        Contact { bodies: contact.bodies.map(|body| place[body as usize]), ..contact }
    };
    Scene {
        flights: bodies.iter().map(|&from| scene.flights[from]).collect(),
        contacts: contacts.iter().map(moved).collect(),
        ..*scene
    }
}

#[test]
fn the_order_of_bodies_and_contacts_changes_no_bit() {
    for (scene, mut random) in scenes(2, 300, 40) {
        let solution = scene.solve();
        let bodies = shuffled(&mut random, scene.flights.len());
        let contacts = shuffled(&mut random, scene.contacts.len());
        let expected = Solution {
            impulses: contacts.iter().map(|&from| solution.impulses[from]).collect(),
            corrections: bodies.iter().map(|&from| solution.corrections[from]).collect(),
            ..solution
        };
        assert_eq!(reordered(&scene, &bodies, &contacts).solve(), expected);
    }
}

/// The islands of a second scene, mixed with the bodies and contacts of the first and touching the same fixed body.
#[test]
fn bystanders_change_no_bit() {
    let mut shared = 0;
    for ((scene, mut random), (mut bystanders, _)) in scenes(3, 300, 20).zip(scenes(4, 300, 40)) {
        // Faster bodies, so that their unit of velocity is another one.
        let scale = random.below(12) as u32;
        for flight in &mut bystanders.flights {
            for velocity in [&mut flight.start, &mut flight.end] {
                velocity.linear.x = crate::fx::Fx::from_bits(velocity.linear.x.to_bits() << scale);
            }
        }
        let mut merged = scene.clone();
        let fixed = scene.flights.iter().position(Flight::is_fixed);
        let place: Vec<u32> = (0..bystanders.flights.len())
            .map(|body| match fixed {
                Some(fixed) if bystanders.flights[body].is_fixed() => fixed as u32,
                _ => (scene.flights.len() + body) as u32,
            })
            .collect();
        shared += usize::from(fixed.is_some());
        merged.flights.extend_from_slice(&bystanders.flights);
        merged.contacts.extend(
            bystanders
                .contacts
                .iter()
                .map(|contact| Contact { bodies: contact.bodies.map(|body| place[body as usize]), ..*contact }),
        );
        let bodies = shuffled(&mut random, merged.flights.len());
        let contacts = shuffled(&mut random, merged.contacts.len());
        let alone = scene.solve();
        let solution = reordered(&merged, &bodies, &contacts).solve();
        let scene_corrections =
            bodies.iter().zip(&solution.corrections).filter(|&(&from, _)| from < scene.flights.len());
        for (&from, correction) in scene_corrections {
            assert_eq!(alone.corrections[from], *correction);
        }
        let scene_impulses = contacts.iter().zip(&solution.impulses).filter(|&(&from, _)| from < scene.contacts.len());
        for (&from, impulses) in scene_impulses {
            assert_eq!(alone.impulses[from], *impulses);
        }
    }
    assert!(shared > 100, "{shared}");
}

/// A pass with the groups of each phase dealt out to threads, each with gains of its own.
fn pass_in_parts(solver: &mut Solver, pass: Pass, threads: usize) -> u64 {
    let mut cut = 0;
    for phase in 0..PHASES {
        let groups = &mut solver.groups.groups[solver.groups.phases[phase].clone()];
        let size = groups.len().div_ceil(threads).max(1);
        let rows = &solver.bodies.rows;
        let parts: Vec<_> = thread::scope(|scope| {
            let handles: Vec<_> = groups
                .chunks_mut(size)
                .map(|groups| {
                    scope.spawn(move || {
                        let mut rows = rows.clone();
                        rows.rows.iter_mut().for_each(|row| row.gain = Default::default());
                        let cut = PassOver { pass, groups, rows: &mut rows, touched: &[] }.run(Portable);
                        (cut, rows.rows)
                    })
                })
                .collect();
            handles.into_iter().map(|handle| handle.join().expect("no thread panics")).collect()
        });
        for (part_cut, part_rows) in parts {
            cut += part_cut;
            for (row, part_row) in solver.bodies.rows.rows.iter_mut().zip(part_rows) {
                (0..3).for_each(|i| row.gain[i] += part_row.gain[i]);
            }
        }
        let touched = &solver.groups.shares.touched[phase][..];
        cut += PassOver { pass, groups: &mut [], rows: &mut solver.bodies.rows, touched }.run(Portable);
        cut += solver.rolls.run(phase, pass, &solver.groups.groups, &mut solver.bodies.rows, Portable);
    }
    cut
}

fn solve_in_parts(scene: &Scene, threads: usize) -> Solution {
    let mut solver = Solver::default();
    let mut corrections = Vec::new();
    let mut contacts = scene.contacts.clone();
    solver.prepare(scene.time_step, &scene.options, &scene.flights, &[], &contacts);
    let clock = Clock::new(scene.time_step, scene.options.substeps);
    let n = scene.options.substeps;
    let mut cut = 0;
    for k in 1..=n {
        Begin { rows: &mut solver.bodies.rows, k, n }.run(Portable);
        if k == 1 {
            cut += pass_in_parts(&mut solver, Pass::WarmStart, threads);
        }
        let substep = SubStep { k, n, clock: &clock, graph: &solver.graph, contacts: &contacts };
        solver.impacts.solve(substep, &mut solver.bodies, &mut solver.groups, &mut solver.joints, Portable);
        cut += pass_in_parts(&mut solver, Pass::Solve, threads);
        Advance { rows: &mut solver.bodies.rows }.run(Portable);
        cut += pass_in_parts(&mut solver, Pass::Relax, threads);
        if scene.options.relax_passes > 1 {
            solver.groups.add_applied(-1);
            for _ in 1..scene.options.relax_passes {
                cut += pass_in_parts(&mut solver, Pass::RelaxAgain, threads);
            }
            solver.groups.add_applied(1);
        }
    }
    solver.finish(scene.time_step, &scene.options, &scene.flights, &mut [], &mut contacts, &mut corrections);
    let impulses = contacts.iter().map(|contact| contact.impulses).collect();
    Solution { impulses, corrections, counts: SolverCounts { cut } }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let mut largest = 0;
    for (scene, _) in scenes(5, 12, 300) {
        let solution = scene.solve();
        assert_eq!(solution, scene.solve_portably());
        largest = largest.max(scene.contacts.len());
        for threads in 1..=8 {
            assert_eq!(solve_in_parts(&scene, threads), solution, "{threads} threads");
        }
    }
    assert!(largest > 100, "groups for each of the threads: {largest} contacts");
}
