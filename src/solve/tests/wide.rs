//! One pass over one contact against a twin in 128 bits, which rounds 40 bits later.

use alloc::vec::Vec;

use super::made::Ranges;
use super::scene::{Scene, fixed, signed, unit};
use crate::cases::run_seed;
use crate::kernel::simd::{self, GAIN_BITS, Job, Pairs, Portable, Row};
use crate::math::Random;
use crate::solve::Solver;
use crate::solve::group::Group;
use crate::solve::matrix::make_one_soft;
use crate::solve::pass::{Pass, PassOver, SPECULATIVE};

/// Fraction bits of the twin.
const PLACES: i32 = 40;

/// The results of the twin, in 2^-40 units.
struct Twin {
    /// The impulses afterwards: both normal ones and friction.
    impulses: [i128; 3],
    /// The distance of the solution of the linear system from a change of the points that push.
    solution: [i128; 2],
}

/// (linear + k_B·ω_B − k_A·ω_A), in 2^-30.
fn row(linear: i128, [ka, kb]: [i32; 2], [wa, wb]: [i32; 2]) -> i128 {
    linear + i128::from(kb) * i128::from(wb) - i128::from(ka) * i128::from(wa)
}

fn raised(value: i128) -> i128 {
    value << (PLACES - 30)
}

/// The change of a separation since the start, in 2^-30.
fn moved(group: &Group, point: usize, [a, b]: [Row; 2]) -> i128 {
    let [nx, ny] = group.normal[0].map(i128::from);
    let [x, y] = [0, 1].map(|i| i128::from(b.displacement[i]) - i128::from(a.displacement[i]));
    row(nx * x + ny * y, group.arms[point][0], [a.displacement[2], b.displacement[2]])
}

/// The separation of a point as passes see it.
fn separation_now(group: &Group, point: usize, rows: [Row; 2]) -> i32 {
    let moved = (moved(group, point, rows) + (1 << 29)) >> 30;
    group.separation[0][point] + moved as i32
}

/// Solves the contact in lane 0. With `normals`, the normal impulses of the pass, friction follows from them.
fn twin(group: &Group, [a, b]: [Row; 2], pass: Pass, normals: Option<[i64; 2]>) -> Twin {
    let [nx, ny] = group.normal[0].map(i128::from);
    let velocities = [a.velocity, b.velocity].map(|v| [v[0], v[1]]);
    let [dx, dy] = [0, 1].map(|i| i128::from(velocities[1][i] - velocities[0][i]));
    let turning = [a.velocity[2], b.velocity[2]];
    let start = [0, 1, 2].map(|k| i128::from(group.impulses[k][0]) << PLACES);
    let (mut rows, mut is_pressed) = ([0; 2], [false; 2]);
    for k in 0..2 {
        // The choice is part of the definition: it goes by the rounded separation.
        is_pressed[k] = separation_now(group, k, [a, b]) <= 0;
        let separation = (i128::from(group.separation[0][k]) << PLACES) + raised(moved(group, k, [a, b]));
        let speculative = i128::from(SPECULATIVE) << PLACES;
        let bias = match pass {
            Pass::Solve if is_pressed[k] => {
                let [rate, deepest] = group.push_out[0].map(i128::from);
                let softening = i128::from(group.compliance[0][k]) * start[k].min(i128::from(i32::MAX) << PLACES);
                (rate * separation.max(deepest << PLACES) + softening) >> 30
            }
            Pass::Solve => separation.min(speculative),
            _ => separation.clamp(0, speculative),
        };
        rows[k] = raised(row(nx * dx + ny * dy, group.arms[k][0], turning)) + bias;
    }
    let is_soft = is_pressed.map(|pressed| pressed && pass == Pass::Solve);
    let set = usize::from(is_soft[0]) + 2 * usize::from(is_soft[1]);
    let [i11, i22] = group.inverse[set][0].map(i128::from);
    let i12 = i128::from(group.inverse_12[set / 2][0][set % 2]);
    let p12 = i128::from(group.ratio_12[0][usize::from(is_soft[0])]);
    let p21 = i128::from(group.ratio_21[0][usize::from(is_soft[1])]);
    let shift = group.inverse_shift[0];
    let x1 = start[0] - ((i11 * rows[0] + i12 * rows[1]) >> shift);
    let x2 = start[1] - ((i12 * rows[0] + i22 * rows[1]) >> shift);
    let alone = |x: i128, p: i128, other_x: i128| (x + if other_x < 0 { (p * other_x) >> 28 } else { 0 }).max(0);
    let solved = [alone(x1, p12, x2), alone(x2, p21, x1)];
    let [n1, n2] = normals.map_or(solved, |normals| normals.map(|n| i128::from(n) << PLACES));
    let mut friction = start[2];
    if pass == Pass::Relax {
        let [vx, vy] = [0, 1].map(|i| i128::from(velocities[1][i] - velocities[0][i]));
        let slip = raised(row(ny * vx - nx * vy, group.arms[2][0], turning));
        let [c1, c2] = group.coupling[0].map(i128::from);
        let coupled = (c1 * (n1 - start[0]) + c2 * (n2 - start[1])) >> 30;
        let slip = slip + coupled - (i128::from(group.surface[0][0]) << PLACES);
        let [m, mu] = group.friction[0].map(i128::from);
        let limit = (mu * (n1 + n2)) >> 26;
        friction = (start[2] - ((m * slip) >> 27)).clamp(-limit, limit);
    }
    Twin { impulses: [n1, n2, friction], solution: [x1, x2] }
}

/// The changes of velocity of a body (x, y, angular) by changes of impulses in 2^-places, in 2^-(places + 24).
fn gains(group: &Group, side: usize, [d1, d2, dt]: [i128; 3]) -> [i128; 3] {
    let linear = if side == 0 { &group.linear_a } else { &group.linear_b };
    let linear_gain = |i: usize| i128::from(linear[0][0][i]) * (d1 + d2) + i128::from(linear[1][0][i]) * dt;
    let [g1, g2, gt] = [0, 1, 2].map(|k| i128::from(group.angular[k][0][side]));
    [linear_gain(0), linear_gain(1), (g1 * d1 + g2 * d2 + gt * dt) << group.angular_shift[0]]
}

/// The velocity along a row (normals 1 and 2, tangent) by an impulse along a row, as it follows from the factors of the group.
fn element(group: &Group, velocity_row: usize, impulse_row: usize) -> f64 {
    let [nx, ny] = group.normal[0];
    let direction = if velocity_row == 2 { [ny, -nx] } else { [nx, ny] };
    let mut impulse = [0; 3];
    impulse[impulse_row] = 1;
    let [a, b] = [0, 1].map(|side| gains(group, side, impulse));
    let linear: i128 = (0..2).map(|i| i128::from(direction[i]) * (b[i] - a[i])).sum();
    let [ka, kb] = group.arms[velocity_row][0].map(i128::from);
    (linear + kb * b[2] - ka * a[2]) as f64 / 2f64.powi(30 + GAIN_BITS)
}

fn difference(pass: i64, twin: i128) -> f64 {
    ((i128::from(pass) << PLACES) - twin) as f64 / 2f64.powi(PLACES)
}

/// A contact before a pass.
struct Case {
    solver: Solver,
    group: Group,
    /// Rows of both bodies.
    rows: [Row; 2],
}

/// A solver with one contact, random rows and random impulses. Velocities and displacements are up to 2^24 units.
fn case(random: &mut Random, ranges: &Ranges) -> Case {
    let mut flights: Vec<_> = (0..2).map(|_| ranges.flight(random, 0.0)).collect();
    if random.below(4) == 0 {
        flights[random.below(2) as usize] = fixed(1.0);
    }
    let scene = Scene::new(flights.clone(), [ranges.contact(random, [0, 1], &flights)].into());
    let mut solver = Solver::default();
    solver.prepare(scene.time_step, &scene.options, &scene.flights, &[], &scene.contacts);
    let size = (24.0 * unit(random)).exp2();
    for (index, row) in solver.bodies.rows.rows.iter_mut().enumerate().skip(1) {
        assert!(index < 3, "two bodies at most");
        let [vx, vy, turn, x, y, angle] = [0; 6].map(|_| (size * signed(random)) as i32);
        *row = Row { velocity: [vx, vy, turn, angle], displacement: [x, y, angle, 0], ..Row::default() };
    }
    let first_group = solver.groups.phases.iter().find(|phase| !phase.is_empty()).expect("one contact").start;
    for k in 0..2 {
        if k < scene.contacts[0].count {
            solver.groups.groups[first_group].impulses[k][0] =
                (size * unit(random)) as i64 * i64::from(random.below(3) != 0);
        }
        // Pressed, open, or at the surface.
        solver.groups.groups[first_group].separation[0][k] = match random.below(4) {
            0 => 0,
            1 => (size * unit(random)) as i32,
            _ => (size * signed(random)) as i32,
        };
    }
    if scene.contacts[0].count == 1 {
        solver.groups.groups[first_group].separation[0][1] = solver.groups.groups[first_group].separation[0][0];
    }
    let group = &mut solver.groups.groups[first_group];
    // No point is left to the impacts of the next sub-step.
    group.surface[0][1] = 1 << 28;
    let rows = [group.a[0], group.b[0]].map(|row| solver.bodies.rows.rows[row as usize]);
    group.separation_now[0] = [0, 1].map(|k| separation_now(group, k, rows));
    let mut group = group.clone();
    make_one_soft(Portable, &mut group);
    Case { solver, group, rows }
}

/// Runs a pass over a case, over lanes and without. Returns the number of values cut off, the group and both rows.
fn run(case: &mut Case, pass: Pass) -> (u64, Group, [Row; 2]) {
    let mut results = [false, true].map(|is_portable| {
        let mut solver = case.solver.clone();
        let touched: Vec<u32> = (1..solver.bodies.rows.rows.len() as u32).collect();
        let job =
            PassOver { pass, groups: &mut solver.groups.groups, rows: &mut solver.bodies.rows, touched: &touched };
        let cut = if is_portable { job.run(Portable) } else { simd::run(job) };
        let group = solver.groups.groups.into_iter().find(|group| group.count > 0).expect("one contact");
        let rows = [group.a[0], group.b[0]].map(|row| solver.bodies.rows.rows[row as usize]);
        (cut, group, rows)
    });
    let [vectorised, portable] = &results;
    assert_eq!((vectorised.0, vectorised.1.impulses, vectorised.2), (portable.0, portable.1.impulses, portable.2));
    core::mem::replace(&mut results[0], (0, Group::empty(0), [Row::default(); 2]))
}

/// The velocities are the impulses' times the factors, rounded once.
fn check_velocities(case: &Case, after: &Group, rows: &[Row; 2]) {
    let changes = [0, 1, 2].map(|k| i128::from(after.impulses[k][0] - case.group.impulses[k][0]));
    for side in (0..2).filter(|&side| [case.group.a, case.group.b][side][0] != 0) {
        let gains = gains(&case.group, side, changes);
        for (i, gain) in gains.into_iter().enumerate() {
            let rounded = ((gain.abs() + (1 << (GAIN_BITS - 1))) >> GAIN_BITS) * gain.signum();
            assert_eq!(i128::from(rows[side].velocity[i] - case.rows[side].velocity[i]), rounded);
        }
    }
}

/// Checks the differences of impulses from the twin's, as velocities along the rows.
///
/// Rounding moves the velocity that a point aims at by at most e: 1/2 for the velocity, 1/2 for the separation of an open point;
/// for the bias of a pressed one 1/2, and its rate, below 1/10, times 1/2 for the separation. The matrix M that is inverted is the
/// contact's matrix K with a larger diagonal, K + D, so that with w = K·M⁻¹·e the bound |D^-1/2·w| ≤ |D^-1/2·e| holds; D is at least
/// K's diagonal times 2^-13: |w_i| ≤ e·√(1 + K_ii/K_jj). One point alone is within the same bound, and as the solution is continuous in
/// the velocities aimed at, so are changes from one point to two and back. Impulses are rounded down: once, and once more where a point is alone.
fn check_rows(case: &Case, after: &Group, pass: Pass) {
    let group = &case.group;
    let solved = twin(group, case.rows, pass, None);
    let errors = [0, 1].map(|k| difference(after.impulses[k][0], solved.impulses[k]));
    let k = |i: usize, j: usize| element(group, i, j);
    let e = 1.05;
    for (i, j) in [(0, 1), (1, 0)] {
        let error = k(i, 0) * errors[0] + k(i, 1) * errors[1];
        let floors = 2.0 * (k(i, i).abs() + k(i, j).abs());
        // Elements of the inverse are rounded to 30 bits, and so both sides of a change of the points that push differ.
        let largest =
            solved.solution.iter().map(|x| x.unsigned_abs()).max().unwrap_or_default() as f64 / 2f64.powi(PLACES);
        let seam = k(i, i).abs() * largest * 2f64.powi(-27);
        let limit = e * (1.0 + k(i, i) / k(j, j)).sqrt() + floors + seam;
        assert!(error.abs() <= limit, "row {i}: {error} beyond {limit}, {pass:?} {group:?}");
    }
    let normals = [0, 1].map(|k| after.impulses[k][0]);
    let solved = twin(group, case.rows, pass, Some(normals));
    let error = difference(after.impulses[2][0], solved.impulses[2]);
    // The slip is rounded to 1/2, the impulse that follows from it to 1/2, the limit down twice.
    let limit = 0.5 * f64::from(group.friction[0][0]) / 2f64.powi(27) + 2.5;
    assert!(error.abs() <= limit, "friction: {error} beyond {limit}");
}

fn check(seed: u64, cases: usize, ranges: &Ranges, mut check_more: impl FnMut(&Case, Pass, &Group, &[Row; 2])) {
    let mut random = Random::seeded(run_seed(seed));
    let mut uncut = 0;
    for _ in 0..cases {
        for pass in [Pass::Solve, Pass::Relax] {
            let mut case = case(&mut random, ranges);
            let (cut, after, rows) = run(&mut case, pass);
            // Set before a solve pass, and by a relax pass.
            assert_eq!(after.separation_now[0], [0, 1].map(|k| separation_now(&case.group, k, case.rows)));
            if cut == 0 {
                uncut += 1;
                check_velocities(&case, &after, &rows);
                check_rows(&case, &after, pass);
                check_more(&case, pass, &after, &rows);
            }
        }
    }
    assert!(uncut > cases, "most cases are within the limits of the loop: {uncut} of {}", 2 * cases);
}

/// By the energy of the change, a velocity differs by at most √(1/m · eᵀ·K⁻¹·e) ≤ e·√(1/m · Σ 1/K_ii / (1 − |K12|/√(K11·K22))),
/// with e = 1.05: 1 unit in the cases compared, and 1/2 for the last rounding.
#[test]
fn well_conditioned_contacts_are_within_two_units_of_a_wide_twin() {
    let ranges = Ranges { gyration: [1.0, 1.0], mass: [-1.0, 1.0], ..Ranges::default() };
    let (mut compared, mut worst) = (0, 0.0f64);
    check(1, 20_000, &ranges, |case, pass, after, rows| {
        let group = &case.group;
        let k = |i: usize, j: usize| element(group, i, j);
        let linear = |factors: &[Pairs; 2]| f64::from(factors[0][0][0]).hypot(f64::from(factors[0][0][1]));
        let mass = linear(&group.linear_a).max(linear(&group.linear_b)) / f64::from(1 << GAIN_BITS);
        let has_two_points = group.inverse[0][0][1] != 0;
        let independence = if has_two_points { 1.0 - k(0, 1).abs() / (k(0, 0) * k(1, 1)).sqrt() } else { 1.0 };
        let compliance = (1.0 / k(0, 0) + if has_two_points { 1.0 / k(1, 1) } else { 0.0 }) / independence;
        if mass * compliance > 0.9 {
            return;
        }
        let solved = twin(group, case.rows, pass, None);
        let changes = [0, 1, 2].map(|k| solved.impulses[k] - (i128::from(group.impulses[k][0]) << PLACES));
        for side in (0..2).filter(|&side| [group.a, group.b][side][0] != 0) {
            for (i, gain) in gains(group, side, changes).into_iter().enumerate() {
                let exact = f64::from(case.rows[side].velocity[i]) + gain as f64 / 2f64.powi(PLACES + GAIN_BITS);
                let error = (f64::from(rows[side].velocity[i]) - exact).abs();
                worst = worst.max(error);
                assert!(error <= 2.0, "{error}: {:?} {pass:?} {:?} after {:?}", group, case.rows, after.impulses);
            }
        }
        compared += 1;
    });
    assert!(compared > 5_000 && worst > 0.5, "{compared} compared, {worst}");
}

#[test]
fn contacts_of_any_masses_and_bases_follow_a_wide_twin() {
    let wide_ranges = Ranges { mass: [-20.0, 20.0], gyration: [1.0, 64.0], radius: [-6.0, 6.0], ..Ranges::default() };
    check(2, 20_000, &wide_ranges, |_, _, _, _| {});
    check(3, 20_000, &Ranges::default(), |_, _, _, _| {});
}

/// Inverse matrices, ratios and the inverse of friction, beside the matrix that follows from the factors, in doubles.
#[test]
fn inverses_are_those_of_the_factors() {
    let mut random = Random::seeded(run_seed(9));
    let ranges = Ranges { mass: [-6.0, 6.0], gyration: [1.0, 4.0], ..Ranges::default() };
    let mut compared = [0; 2];
    for _ in 0..10_000 {
        let Case { group, .. } = case(&mut random, &ranges);
        let k = |i: usize, j: usize| element(&group, i, j);
        let [k11, k12, k22] = [k(0, 0), k(0, 1), k(1, 1)];
        let has_two_points = group.inverse[0][0][1] != 0;
        let (tangent, inverse) = (k(2, 2), f64::from(group.friction[0][0]) / 2f64.powi(27));
        if tangent > 0.07 {
            assert!((inverse * tangent - 1.0).abs() < 1e-5, "{inverse} of {tangent}");
        }
        // Factors and elements are rounded to 28 bits of the largest one: here no element is much smaller.
        if k11.min(k22) < 0.01 || has_two_points && (k12 * k12 > 0.95 * k11 * k22 || k12.abs() > 3.9 * k11.min(k22)) {
            continue;
        }
        compared[usize::from(has_two_points)] += 1;
        let soft = group.compliance[0].map(|c| f64::from(c) / 2f64.powi(30));
        for set in 0..4 {
            let scale = 2f64.powi(-(group.inverse_shift[0] as i32));
            let [i11, i22] = group.inverse[set][0].map(|i| f64::from(i) * scale);
            let i12 = f64::from(group.inverse_12[set / 2][0][set % 2]) * scale;
            let s11 = k11 + if set & 1 == 0 { 0.0 } else { soft[0] };
            let s22 = k22 + if set & 2 == 0 { 0.0 } else { soft[1] };
            let wanted = if has_two_points {
                let determinant = s11 * s22 - k12 * k12;
                [s22 / determinant, -k12 / determinant, s11 / determinant]
            } else {
                [1.0 / s11, 0.0, 0.0]
            };
            let largest = wanted.iter().fold(0.0, |largest: f64, w| largest.max(w.abs()));
            for (found, wanted) in [i11, i12, i22].into_iter().zip(wanted) {
                assert!((found - wanted).abs() < 1e-5 * largest, "set {set}: {found}, not {wanted}, of {largest}");
            }
        }
        let ratios = [group.ratio_12[0], group.ratio_21[0]].map(|ratios| ratios.map(|r| f64::from(r) / 2f64.powi(28)));
        let wanted = [[k12 / k11, k12 / (k11 + soft[0])], [k12 / k22, k12 / (k22 + soft[1])]];
        for (found, wanted) in ratios.as_flattened().iter().zip(wanted.as_flattened()) {
            let wanted = if has_two_points { *wanted } else { 0.0 };
            assert!((found - wanted).abs() < 1e-5, "{found}, not {wanted}");
        }
    }
    assert!(compared.iter().all(|&compared| compared > 1000), "{compared:?}");
}
