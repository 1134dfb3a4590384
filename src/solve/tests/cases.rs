//! Regression tests: single cases, each of which was once a bug.

use alloc::vec;

use super::scene::{Image, Scene, body, contact, fixed, fx, signed};
use crate::cases::run_seed;
use crate::kernel::simd::{Job, Portable};
use crate::math::{Random, Vec2};
use crate::scalar::FxAccumulator;
use crate::solve::motion::Begin;
use crate::solve::pass::Pass;
use crate::solve::{Contact, Flight, Impulses, Solver};

const TICK: f64 = 1.0 / 60.0;

fn to_f64(value: FxAccumulator) -> f64 {
    value.to_bits() as f64 / 2f64.powi(96)
}

/// The change of velocity of a body.
fn change(scene: &Scene, body: usize) -> [f64; 3] {
    let correction = scene.solve().corrections[body];
    [correction.velocity.x, correction.velocity.y, correction.angular_velocity].map(to_f64)
}

#[test]
fn points_may_come_in_either_order() {
    let mut random = Random::seeded(run_seed(1));
    for case in 0..2000 {
        let [x1, x2, slide, spin] = [0; 4].map(|_| signed(&mut random));
        let points = [([x1, 1.0], [x1, -0.5], 0.0), ([x2, 1.0], [x2, -0.5], 0.001)];
        let mut contact = contact([0, 1], [0.0, 1.0], &points);
        contact.friction = fx(0.5);
        let falling = body(1.0, 3.0, 1.0).flying([slide, -2.0, spin], TICK);
        let scene = Scene::new(vec![fixed(4.0), falling], vec![contact]);
        let swapped = scene.image(|flight| *flight, Contact::with_points_swapped);
        assert_eq!(scene.solve().corrections, swapped.solve().corrections, "case {case}");
    }
}

/// A body that lands on a narrow base to the side of its centre turns over the nearer point, as if it were the only point.
#[test]
fn a_narrow_base_pushes_as_one_point_does() {
    for substeps in [1, 5] {
        for (speed, half) in [(16.0, 0.1), (16.0, 0.05), (16.0, 0.02), (16.0, 0.01), (4.0, 0.01), (4.0, 0.005)] {
            let points = [0.5 - half, 0.5 + half].map(|x| ([x, 1.0], [x, -0.5], 0.0));
            let falling = body(1.0, 3.0, 1.0).flying([0.0, -speed, 0.0], TICK);
            let mut scene = Scene::new(vec![fixed(4.0), falling], vec![contact([0, 1], [0.0, 1.0], &points)]);
            scene.options.substeps = substeps;
            let by_two_points = change(&scene, 1);
            scene.contacts[0].count = 1;
            let by_one_point = change(&scene, 1);
            // The diagonal is raised by 2^-13, so that velocities differ by as much.
            let tolerance = speed * 2f64.powi(-12);
            let differs = (0..3).any(|i| (by_two_points[i] - by_one_point[i]).abs() > tolerance);
            assert!(
                !differs,
                "{substeps} sub-steps, {speed} m/s, {half} m: {by_two_points:?} instead of {by_one_point:?}"
            );
        }
    }
}

#[test]
fn still_bodies_have_no_row_of_their_own() {
    let scene = Scene::new(
        vec![fixed(1.0), body(1.0, 2.0, 1.0)],
        vec![contact([0, 1], [0.0, 1.0], &[([0.0, 1.0], [0.0, -1.0], 0.0)])],
    );
    let mut solver = Solver::default();
    solver.prepare(scene.time_step, &scene.options, &scene.flights, &[], &scene.contacts);
    assert!(solver.bodies.carriers.is_empty());
}

/// Two heaviest bodies an odd number of 2^-32 m apart: their middle is between two multiples.
#[test]
fn heaviest_bodies_tie_at_any_distance() {
    let side_contact = |a, b| contact([a, b], [1.0, 0.0], &[([1.0, 0.0], [-1.0, 0.0], 0.0)]);
    let metre = 1i64 << 32;
    for odd in [0, 1] {
        let placed = |bits: i64, flight: Flight| Flight {
            position: Vec2::new(fx(bits as f64 / metre as f64), fx(0.0)),
            ..flight
        };
        let heavy = body(2.0, 2.0, 1.0);
        let light = body(1.0, 2.0, 1.0);
        let flights = vec![
            placed(0, heavy.flying([1.0, 0.0, 0.0], TICK)),
            placed(2 * metre, light),
            placed(2 * metre + odd, light),
            placed(4 * metre + odd, heavy.flying([-1.0, 0.0, 0.0], TICK)),
        ];
        let scene =
            Scene::new(flights, vec![side_contact(0, 1), side_contact(0, 2), side_contact(1, 3), side_contact(2, 3)]);
        let solution = scene.solve();
        let [left, right] = [0, 3].map(|body: usize| solution.corrections[body].velocity.x.to_bits());
        assert_eq!(left, -right, "a half turn about the middle exchanges the bodies");
        let mut reversed = scene.clone();
        reversed.flights.reverse();
        reversed.contacts.iter_mut().for_each(|contact| contact.bodies = contact.bodies.map(|body| 3 - body));
        let mut reversed_corrections = reversed.solve().corrections;
        reversed_corrections.reverse();
        assert_eq!(solution.corrections, reversed_corrections);
    }
}

/// Bodies that overlap by much are pushed out at the same speed, whatever the unit of velocity.
#[test]
fn deep_overlaps_are_pushed_at_the_push_speed() {
    for speed in [0.0, 64.0, 4096.0] {
        for depth in [0.3, 1.0, 4.0] {
            let flight = body(1.0, 2.0, 8.0).flying([speed, 0.0, 0.0], TICK);
            let contact = contact([0, 1], [0.0, 1.0], &[([0.0, 1.0], [0.0, -1.0], -depth)]);
            let solution = Scene::new(vec![flight; 2], vec![contact]).solve();
            let displacements = [0, 1].map(|body: usize| to_f64(solution.corrections[body].displacement.y));
            let push = (displacements[1] - displacements[0]) / TICK;
            assert!((push - 3.0).abs() < 0.1, "{speed} m/s, {depth} m: {push} m/s");
        }
    }
}

/// A body that a heavier body hits at its rim turns faster than any body turned before.
#[test]
fn a_hit_at_the_rim_turns_a_body_at_any_speed() {
    for substeps in 1..=16 {
        for k in 0..40 {
            let speed = 1.1f64.powi(k);
            let hammer = fixed(4.0).flying([0.0, speed, 0.0], TICK);
            let rod = body(1.0, 3.0, 1.03125).flying([0.0, -speed, 0.0], TICK);
            let mut scene =
                Scene::new(vec![hammer, rod], vec![contact([0, 1], [0.0, 1.0], &[([0.0; 2], [1.03125, 0.0], 0.0)])]);
            scene.options.substeps = substeps;
            // The points have the same velocity after it: (1 + R²·m/I)·Δv = 2·speed, and R²·m/I is 3.
            let [_, up, turn] = change(&scene, 1);
            let [up, turn] = [up / (speed / 2.0), turn * 1.03125 / (1.5 * speed)];
            assert!(
                (up - 1.0).abs() < 1e-5 && (turn - 1.0).abs() < 1e-5,
                "{substeps} sub-steps, {speed} m/s: {up} {turn}"
            );
        }
    }
}

/// A contact at one point beside the centre of B, with an impulse from the previous step in 2^-30 N·s.
fn warm(bodies: [u32; 2], x: f64, impulse: i64) -> Contact {
    let contact = contact(bodies, [0.0, 1.0], &[([x, 0.0], [x, 0.0], 0.0)]);
    Contact { impulses: Impulses { values: [impulse, 0, 0], exponent: -30 }, ..contact }
}

/// A body whose inertia is small for its size, and impulses that cancel.
#[test]
fn large_impulses_change_no_bit_of_the_lanes_beside_them() {
    let contacts = vec![
        warm([0, 1], 1.0, 1 << 26),
        warm([0, 1], -1.0, 1 << 25),
        warm([0, 1], -1.0, 1 << 25),
        warm([0, 2], 1.0, 1 << 60),
    ];
    let mut scene = Scene::new(vec![fixed(4.0), body(1.0, 262_144.0, 1.0), body(1.0, 2.0, 1.0)], contacts);
    scene.options.substeps = 1;
    let vectorised = scene.solve();
    let portable = scene.solve_portably();
    scene.contacts.pop();
    let alone = scene.solve();
    assert_eq!(vectorised, portable);
    assert_eq!(vectorised.corrections[1], alone.corrections[1]);
}

#[test]
fn a_large_impulse_turns_the_way_it_points() {
    for impulse in [18, 26, 27, 28, 30, 34, 50].map(|bits| 1 << bits) {
        let mut scene = Scene::new(vec![fixed(4.0), body(1.0, 262_144.0, 1.0)], vec![warm([0, 1], 1.0, impulse)]);
        scene.options.substeps = 1;
        let mut solver = Solver::default();
        solver.prepare(scene.time_step, &scene.options, &scene.flights, &[], &scene.contacts);
        Begin { rows: &mut solver.bodies.rows, k: 1, n: 1 }.run(Portable);
        solver.pass(Pass::WarmStart, Portable);
        assert!(solver.bodies.rows.velocity(1)[2] > 0, "{impulse}: {:?}", solver.bodies.rows.velocity(1));
    }
}

/// Both bodies of a contact get its impulse, however light a body is.
#[test]
fn no_body_is_left_out() {
    let light = body(1.0 / 65536.0, 2.0, 0.0078125);
    let heavy = body(16_777_216.0, 2.0, 4.0);
    let mut below = contact([0, 1], [0.0, 1.0], &[([0.0, 4.0], [0.0, -0.0078125], 0.0)]);
    below.impulses = Impulses { values: [1 << 44, 0, 0], exponent: 0 };
    let above = contact([1, 2], [0.0, 1.0], &[([0.0, 0.0078125], [0.0, -4.0], 0.0)]);
    let flights = vec![heavy.flying([0.0, 1e6, 0.0], TICK), light, heavy.flying([0.0, -1e6, 0.0], TICK)];
    let solution = Scene::new(flights, vec![below, above]).solve();
    let is_moved = [0, 1, 2].map(|body: usize| solution.corrections[body].velocity.y.to_bits() != 0);
    assert_eq!(is_moved, [true; 3], "{solution:?}");
}
