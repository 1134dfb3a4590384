//! The ends of the solver's ranges: nothing overflows, and the cut-off is an odd function of a value.

use super::made::Ranges;
use super::scene::{Image, Scene, by_exponent, fixed, fx, signed};
use crate::cases::run_seed;
use crate::math::{Random, TimeStep};
use crate::solve::{Contact, Flight, Impulses};

/// Checks that a scene has the same result with and without vectors, and that its images have the images of the result: in a mirror, after
/// a quarter turn, with bodies or points swapped. Returns the number of values that were cut off.
fn check(scene: &Scene) -> u64 {
    let solution = scene.solve();
    assert_eq!(scene.solve_portably(), solution, "lanes: {scene:?}");
    let mirrored = scene.image(Flight::mirrored, Contact::mirrored).solve();
    let turned = scene.image(Flight::turned, Contact::turned).solve();
    let swapped = scene.image(Flight::swapped, Contact::swapped).solve();
    let points = scene.image(Flight::with_points_swapped, Contact::with_points_swapped).solve();
    for (i, correction) in solution.corrections.iter().enumerate() {
        assert_eq!(mirrored.corrections[i], correction.mirrored(), "mirrored: {scene:?}");
        assert_eq!(turned.corrections[i], correction.turned(), "turned: {scene:?}");
        assert_eq!(swapped.corrections[i], *correction, "swapped: {scene:?}");
        assert_eq!(points.corrections[i], *correction, "points: {scene:?}");
    }
    for image in [&mirrored, &turned, &swapped, &points] {
        assert_eq!(image.counts, solution.counts, "{scene:?}");
    }
    solution.counts.cut
}

/// Scenes at a rate and a number of sub-steps.
fn scene(random: &mut Random, ranges: &Ranges, rate: u32, substeps: u32) -> Scene {
    let mut scene = ranges.scene(random, 6, 8);
    scene.options.substeps = substeps;
    scene.time_step = TimeStep::hz(rate);
    scene
}

/// Returns the number of values cut off in all scenes of these ranges.
fn check_all(seed: u64, ranges: &Ranges) -> u64 {
    let mut random = Random::seeded(run_seed(seed));
    let mut cut = 0;
    for rate in [1, 60, 10_000] {
        for substeps in 1..=16 {
            for _ in 0..20 {
                cut += check(&scene(&mut random, ranges, rate, substeps));
            }
        }
    }
    cut
}

#[test]
fn any_rate_and_any_substeps() {
    check_all(1, &Ranges { restitution: 1.0, ..Ranges::default() });
}

#[test]
fn fast_bodies() {
    check_all(2, &Ranges { speed: 1_048_576.0, restitution: 1.0, ..Ranges::default() });
}

#[test]
fn bodies_of_any_size_and_mass() {
    check_all(
        3,
        &Ranges {
            mass: [-24.0, 24.0],
            radius: [-8.0, 13.0],
            gyration: [1.0, 1e4],
            restitution: 1.0,
            ..Ranges::default()
        },
    );
}

#[test]
fn deep_overlaps_and_far_points() {
    check_all(4, &Ranges { separation: [-8192.0, 8192.0], radius: [-2.0, 13.0], ..Ranges::default() });
}

/// Rims at up to 2^30 m/s.
#[test]
fn fast_rims() {
    let mut random = Random::seeded(run_seed(5));
    for rate in [1, 60, 10_000] {
        for substeps in 1..=16 {
            let mut scene = scene(&mut random, &Ranges { radius: [12.0, 13.0], ..Ranges::default() }, rate, substeps);
            for flight in scene.flights.iter_mut().filter(|flight| !flight.is_fixed()) {
                let radius = flight.radius.to_bits() as f64 / 2f64.powi(32);
                let turn = signed(&mut random) * 2f64.powi(29) / radius;
                (flight.start.angular, flight.end.angular) = (fx(turn), fx(-turn));
            }
            check(&scene);
        }
    }
}

/// Impulses of any size, up to the largest that may be written, on bodies of any mass.
#[test]
fn impulses_at_the_cap() {
    let mut random = Random::seeded(run_seed(6));
    let mut cut = 0;
    let ranges = Ranges { mass: [-20.0, 20.0], gyration: [1.0, 1e4], restitution: 1.0, ..Ranges::default() };
    for _ in 0..400 {
        let substeps = 1 + random.below(16) as u32;
        let mut scene = scene(&mut random, &ranges, 60, substeps);
        scene.options.relax_passes = if random.below(8) == 0 { 65 } else { 1 };
        for contact in &mut scene.contacts {
            let exponent = random.integer(-80..=80) as i32;
            let largest = 2f64.powi(62);
            let values = [0; 3].map(|_| by_exponent(&mut random, 20.0, 62.0).min(largest) as i64);
            let [first, mut second, mut tangential] = values;
            tangential *= if random.below(2) == 0 { 1 } else { -1 };
            second *= i64::from(contact.count == 2);
            contact.impulses = Impulses { values: [first, second, tangential], exponent };
        }
        cut += check(&scene);
    }
    assert!(cut > 0, "some velocities are cut off");
}

/// A light body between two heavy bodies that fly at each other.
#[test]
fn light_bodies_between_heavy_ones() {
    let mut random = Random::seeded(run_seed(7));
    let mut cut = 0;
    for _ in 0..400 {
        let ranges = Ranges { mass: [20.0, 24.0], speed: 1000.0, separation: [-1.0, 0.0], ..Ranges::default() };
        let light = Ranges { mass: [-20.0, -16.0], ..ranges };
        let mut flights = [0; 4].map(|_| ranges.flight(&mut random, 1.0 / 60.0)).to_vec();
        flights[1] = light.flight(&mut random, 1.0 / 60.0);
        flights[3] = fixed(4.0);
        let pairs = [[0, 1], [1, 2], [1, 3]];
        let contacts = pairs.map(|pair| ranges.contact(&mut random, pair, &flights)).to_vec();
        cut += check(&Scene::new(flights, contacts));
    }
    assert_eq!(cut, 0, "the unit leaves room for the impulses at the start, and nothing is cut off");
}
