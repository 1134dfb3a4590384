//! Each integrator has the order it claims: local slopes of the error over successive halvings of the time step.
//!
//! An error is the distance from the exact solution in phase space: positions and angles, and velocities over the fastest
//! rate. What rounding adds is measured: the same scene enlarged by a power of two has the same error but for it.

#[path = "support/problems.rs"]
mod problems;
#[path = "support/real.rs"]
mod real;

use problems::{
    CIRCLE, DAMPED_OSCILLATOR, ELLIPSE, Enlarged, FALL, KEPT, OSCILLATOR, PAIR, PROBLEMS, PULLED_ROUND, Problem, RATE,
    SPIN_KEPT, SPRING_DAMPER, SPUN_UP, Scale, TURNED, solve, state,
};
use real::{Real, TAU, exact, ratio, real, to_f64};
use umbra_physics::{BodyId, Fx, Integrator, TimeStep, Vec2, World, WorldDef};

/// The coarsest steps a second; with the fastest rate ω = 3.75 rad/s, ω·dt = 1/8.
const COARSEST: u32 = 30;
/// Errors count that are this much above what rounding adds.
const ABOVE_FLOOR: f64 = 30.0;

/// A way to move a scene through a tick.
type Tick = fn(&mut World, &[BodyId]);

/// Errors at successive halvings of the time step, and what rounding added to each.
struct Ladder {
    name: String,
    errors: Vec<(f64, f64)>,
}

impl Ladder {
    /// The slopes between errors above the floor.
    fn slopes(&self) -> Vec<f64> {
        let clear = self.errors.iter().take_while(|(error, floor)| *error > ABOVE_FLOOR * floor);
        let logs: Vec<f64> = clear.map(|(error, _)| error.log2()).collect();
        logs.windows(2).map(|pair| pair[0] - pair[1]).collect()
    }

    /// Returns true if `halvings` or more show this order to within the tolerance, without exception.
    fn shows(&self, order: f64, tolerance: f64, halvings: usize) -> Result<(), String> {
        let slopes = self.slopes();
        println!("{}: {slopes:.3?}, at last {:.1e} over a floor of {:.1e}", self.name, self.last().0, self.last().1);
        if slopes.len() < halvings {
            return Err(format!("{}: only {slopes:?} are above the floor of {:?}", self.name, self.errors));
        }
        match slopes.iter().find(|slope| (*slope - order).abs() > tolerance) {
            Some(slope) => Err(format!("{}: slope {slope} of {slopes:?}, not {order} ± {tolerance}", self.name)),
            None => Ok(()),
        }
    }

    fn last(&self) -> (f64, f64) {
        self.errors[self.slopes().len()]
    }
}

/// A measurement of the order over successive halvings of the time step.
#[derive(Clone, Copy)]
struct Climb {
    integrator: Integrator,
    tick: Tick,
    /// The time that is watched, in tenths of a second.
    tenths: u32,
    /// ω·dt of its steps: 1/8 of 1/2^first to 1/8 of 1/2^last.
    halvings: (u32, u32),
    /// The size of the scene, and of the larger one that shows the rounding.
    scales: (u32, u32),
}

impl Climb {
    fn of(problem: &Problem, integrator: Integrator) -> Self {
        let (tenths, halvings) = match integrator.order() {
            // First-order errors are large: over a longer time their squares show.
            1 => (2, (3, 8)),
            2 => (problem.tenths, (0, 6)),
            _ => (problem.tenths, (0, 4)),
        };
        // Enlarged angles wrap if their errors grow to turns.
        let larger = if problem.enlarged == Enlarged::Angles { 2 } else { 10 };
        Self { integrator, tick: |world, _| _ = world.step(), tenths, halvings, scales: (0, larger) }
    }

    fn def(&self, rate: u32) -> WorldDef {
        let (integrator, time_step) = (self.integrator, TimeStep::hz(rate));
        WorldDef { time_step, integrator, sleep_after: None, ..WorldDef::default() }
    }

    /// The distance from the solution in the scene's own size.
    fn off(&self, problem: &Problem, rate: u32, scale: u32, solution: &[Real]) -> Vec<f64> {
        let (mut world, bodies) = (problem.scene)(self.def(rate), Scale(scale));
        for _ in 0..rate * self.tenths / 10 {
            if let Some(torque) = problem.torque {
                world.apply_torque(bodies[0], Scale(scale).of(torque)).expect("a fair torque");
            }
            (self.tick)(&mut world, &bodies);
            assert!(world.last_report().faults.is_empty() && world.last_report().drag_outside == 0);
        }
        let component = |(i, (is, right)): (usize, (&Real, &Real))| {
            let (angle, velocity) = (i % 6 >= 4, matches!(i % 6, 2 | 3 | 5));
            let enlarged = angle == (problem.enlarged == Enlarged::Angles);
            let size = if enlarged { scale as isize } else { 0 };
            let mut off = is - (right.clone() << size);
            if i % 6 == 4 {
                off -= (&off / &*TAU).round() * &*TAU;
            }
            to_f64(&(off >> size)) / if velocity { RATE } else { 1.0 }
        };
        state(&world, &bodies).iter().zip(solution).enumerate().map(component).collect()
    }

    fn climb(&self, problem: &Problem) -> Ladder {
        let (world, bodies) = (problem.scene)(self.def(COARSEST), Scale(0));
        let solution = solve(problem.slope, state(&world, &bodies), self.tenths, 20);
        let norm = |off: &[f64]| off.iter().map(|d| d * d).sum::<f64>().sqrt();
        let rung = |halving: u32| {
            let rate = COARSEST << halving;
            let off = self.off(problem, rate, self.scales.0, &solution);
            let larger = self.off(problem, rate, self.scales.1, &solution);
            let rounding: Vec<f64> = off.iter().zip(&larger).map(|(a, b)| a - b).collect();
            (norm(&off), norm(&rounding))
        };
        let (first, last) = self.halvings;
        let name = format!("{} by {} at 2^{} m", problem.name, self.integrator.name(), self.scales.0);
        Ladder { name, errors: (first..=last).map(rung).collect() }
    }
}

/// Tolerance of a slope around the order.
fn tolerance(order: u32) -> f64 {
    if order == 4 { 0.1 } else { 0.03 }
}

fn every_integrator_has_its_order(problem: &Problem) {
    for integrator in Integrator::ALL {
        let ladder = Climb::of(problem, integrator).climb(problem);
        let order = integrator.order();
        ladder.shows(order.into(), tolerance(order), 4).unwrap_or_else(|why| panic!("{why}"));
    }
}

#[test]
fn every_integrator_has_its_order_in_a_fall_with_drag_and_wind() {
    every_integrator_has_its_order(&FALL);
}

#[test]
fn every_integrator_has_its_order_in_an_oscillator() {
    every_integrator_has_its_order(&OSCILLATOR);
}

#[test]
fn every_integrator_has_its_order_in_a_damped_oscillator() {
    every_integrator_has_its_order(&DAMPED_OSCILLATOR);
}

#[test]
fn every_integrator_has_its_order_in_a_circular_orbit() {
    every_integrator_has_its_order(&CIRCLE);
}

#[test]
fn every_integrator_has_its_order_in_an_elliptic_orbit() {
    every_integrator_has_its_order(&ELLIPSE);
}

#[test]
fn every_integrator_has_its_order_in_a_damped_spin_under_torque() {
    every_integrator_has_its_order(&SPUN_UP);
}

#[test]
fn every_integrator_has_its_order_in_a_spin_under_a_torque_of_the_angle() {
    every_integrator_has_its_order(&PULLED_ROUND);
}

#[test]
fn every_integrator_has_its_order_in_two_bodies_on_a_spring() {
    every_integrator_has_its_order(&PAIR);
}

/// Down to a step of 1/512 s by day, of 1/2048 s by night.
#[test]
fn yoshida4_has_order_4_down_to_short_steps_at_a_kilometre() {
    let (tenths, last) = if crate::seeds::is_short() { (40, 6) } else { (640, 8) };
    let climb = Climb { tenths, halvings: (0, last), scales: (10, 17), ..Climb::of(&OSCILLATOR, Integrator::Yoshida4) };
    climb.climb(&OSCILLATOR).shows(4.0, 0.1, last as usize).unwrap_or_else(|why| panic!("{why}"));
}

/// Problems with forces of velocity that have no exact solution of their own.
const OF_VELOCITY: [Problem; 2] = [SPRING_DAMPER, TURNED];

#[test]
fn dampers_and_hooks_of_velocity_have_order_2_in_velocity_verlet() {
    for problem in &OF_VELOCITY {
        let ladder = Climb::of(problem, Integrator::VelocityVerlet).climb(problem);
        ladder.shows(2.0, 0.03, 4).unwrap_or_else(|why| panic!("{why}"));
    }
}

#[test]
fn dampers_and_hooks_of_velocity_have_order_3_in_yoshida4() {
    // The composition's weights cancel what a sub-step leaves of h³; as it is not symmetric, it leaves h⁴ too.
    for problem in &OF_VELOCITY {
        let ladder = Climb::of(problem, Integrator::Yoshida4).climb(problem);
        assert!(ladder.shows(4.0, 0.1, 4).is_err());
        let slopes = ladder.slopes();
        assert!(slopes.len() >= 4 && (slopes[slopes.len() - 1] - 3.0).abs() < 0.1, "{}: {slopes:?}", ladder.name);
    }
}

#[test]
fn the_eulers_have_order_1_with_forces_of_velocity() {
    for problem in &OF_VELOCITY {
        for integrator in Integrator::ALL.into_iter().filter(|integrator| integrator.order() == 1) {
            let ladder = Climb::of(problem, integrator).climb(problem);
            ladder.shows(1.0, 0.03, 4).unwrap_or_else(|why| panic!("{why}"));
        }
    }
}

/// Multiplies the velocity by what damping leaves over so much of a tick, as a game's own code does.
fn slow_down(world: &mut World, body: BodyId, share: i64) {
    let (num, den) = world.def().time_step.seconds();
    let left = KEPT.pow(Fx::from_ratio(num.into(), share * i64::from(den))).expect("it fits");
    let velocity = world.body(body).expect("it is there").velocity();
    let slowed: Vec2 = velocity.checked_scale(left).expect("it fits");
    world.set_velocity(body, slowed).expect("a fair velocity");
}

/// The damped oscillator in a world that leaves the damping to `tick`.
fn damped_by_hand(integrator: Integrator, tick: Tick) -> Ladder {
    let twin = Problem { scene: OSCILLATOR.scene, ..DAMPED_OSCILLATOR };
    Climb { tick, ..Climb::of(&twin, integrator) }.climb(&twin)
}

#[test]
fn velocity_verlet_damped_after_the_step_fails_as_order_2() {
    let ladder = damped_by_hand(Integrator::VelocityVerlet, |world, bodies| {
        world.step();
        slow_down(world, bodies[0], 1);
    });
    assert!(ladder.shows(2.0, 0.03, 4).is_err(), "a first-order twin passes for second order");
    assert!(ladder.slopes().len() >= 4 && (ladder.slopes()[ladder.slopes().len() - 1] - 1.0).abs() < 0.03);
}

#[test]
fn yoshida4_damped_around_the_step_fails_as_order_4() {
    let ladder = damped_by_hand(Integrator::Yoshida4, |world, bodies| {
        slow_down(world, bodies[0], 2);
        world.step();
        slow_down(world, bodies[0], 2);
    });
    assert!(ladder.shows(4.0, 0.1, 4).is_err(), "a second-order twin passes for fourth order");
    assert!(ladder.slopes().len() >= 4 && (ladder.slopes()[ladder.slopes().len() - 1] - 2.0).abs() < 0.03);
}

#[test]
fn the_published_scheme_fails_as_order_2() {
    for problem in &PROBLEMS {
        let halvings = (3, 8);
        let climb = Climb { halvings, ..Climb::of(problem, Integrator::PublishedVerlet) };
        assert!(climb.climb(problem).shows(2.0, 0.03, 4).is_err(), "{}", problem.name);
    }
}

/// Positions and velocities after each tick.
fn path(problem: &Problem, integrator: Integrator, ticks: u32) -> Vec<Vec<Real>> {
    let def = WorldDef { integrator, time_step: TimeStep::hz(60), ..WorldDef::default() };
    let (mut world, bodies) = (problem.scene)(def, Scale(0));
    let mut path = vec![state(&world, &bodies)];
    for _ in 0..ticks {
        world.step();
        path.push(state(&world, &bodies));
    }
    path
}

/// The largest distance between two paths, from the `first` component of a body to the one before `end`.
fn apart(a: &[Vec<Real>], b: &[Vec<Real>], first: usize, end: usize) -> f64 {
    let pairs = a.iter().zip(b).flat_map(|(a, b)| a[first..end].iter().zip(&b[first..end]));
    pairs.map(|(a, b)| to_f64(&(a - b)).abs()).fold(0.0, f64::max)
}

const ULP: f64 = 1.0 / 4_294_967_296.0;

#[test]
fn the_published_scheme_has_the_positions_of_symplectic_euler_without_damping() {
    for problem in [OSCILLATOR, CIRCLE, ELLIPSE, PAIR] {
        let published = path(&problem, Integrator::PublishedVerlet, 600);
        let euler = path(&problem, Integrator::SymplecticEuler, 600);
        let distance = apart(&published, &euler, 0, 2) / ULP;
        println!("{}: {distance:.1} ulps apart after 10 s", problem.name);
        // What both round differs; the two schemes' errors are in the millions of ulps.
        assert!(distance < 64.0, "{}: {distance} ulps apart", problem.name);
    }
}

#[test]
fn the_published_velocity_lags_by_half_a_kick() {
    let published = path(&OSCILLATOR, Integrator::PublishedVerlet, 600);
    let mut euler = path(&OSCILLATOR, Integrator::SymplecticEuler, 600);
    let kicks: Vec<Vec<Real>> = euler.iter().map(|state| (OSCILLATOR.slope)(state)).collect();
    for (state, slope) in euler[1..].iter_mut().zip(&kicks) {
        for i in [2, 3] {
            state[i] -= &slope[i] * ratio(1, 120);
        }
    }
    assert!(apart(&published, &euler, 2, 4) < 64.0 * ULP);
}

#[test]
fn the_published_scheme_leaves_symplectic_euler_with_damping() {
    let published = path(&DAMPED_OSCILLATOR, Integrator::PublishedVerlet, 600);
    let euler = path(&DAMPED_OSCILLATOR, Integrator::SymplecticEuler, 600);
    assert!(apart(&published, &euler, 0, 2) > 1e-4);
}

#[test]
fn explicit_euler_is_the_textbooks() {
    // x' = x + v·dt and v' = v − ω²·x·dt, both of the old values.
    let euler = path(&OSCILLATOR, Integrator::ExplicitEuler, 600);
    let mut by_hand = vec![euler[0].clone()];
    for tick in 0..600 {
        let state = &by_hand[tick];
        let slope = (OSCILLATOR.slope)(state);
        by_hand.push(state.iter().zip(&slope).map(|(y, f)| y + f * ratio(1, 60)).collect());
    }
    let growth = to_f64(&(&by_hand[600][0] / &by_hand[0][0])).abs();
    assert!(apart(&euler, &by_hand, 0, 4) < 64.0 * ULP * growth.max(1.0), "{}", apart(&euler, &by_hand, 0, 4));
}

/// The solution of a problem from its start, after its time.
fn solved(problem: &Problem, steps_per_second: i64) -> (Vec<Real>, Vec<Real>) {
    let def = WorldDef { time_step: TimeStep::hz(60), ..WorldDef::default() };
    let (world, bodies) = (problem.scene)(def, Scale(0));
    let start = state(&world, &bodies);
    (start.clone(), solve(problem.slope, start, problem.tenths, steps_per_second))
}

#[test]
fn the_reference_does_not_depend_on_its_steps() {
    for problem in PROBLEMS.iter().chain(&OF_VELOCITY).step_by(if crate::seeds::is_short() { 3 } else { 1 }) {
        let (coarse, fine) = (solved(problem, 20).1, solved(problem, 30).1);
        let off = coarse.iter().zip(&fine).map(|(a, b)| to_f64(&(a - b)).abs()).fold(0.0, f64::max);
        println!("{}: {off:.1e}", problem.name);
        assert!(off < 1e-15, "{}: {off}", problem.name);
    }
}

fn assert_close(value: &Real, closed_form: &Real, what: &str) {
    let off = to_f64(&(value - closed_form)).abs();
    assert!(off < 1e-18, "{what}: {off}");
}

#[test]
fn the_reference_is_the_closed_form_of_the_oscillators() {
    for (problem, log) in [(OSCILLATOR, real(0)), (DAMPED_OSCILLATOR, exact(KEPT).ln())] {
        let (start, end) = solved(&problem, 20);
        // x″ = −ω²x + log·x′: e^(log·t/2), turning at √(ω² − log²/4).
        let half = &log / real(2);
        let rate = (ratio(225, 16) - &half * &half).sqrt();
        let t = ratio(problem.tenths.into(), 10);
        let (sin, cos) = (&rate * &t).sin_cos();
        for (x, v) in [(0, 2), (1, 3)] {
            let along = (&start[v] - &half * &start[x]) / &rate;
            let closed_form = (&half * &t).exp() * (&start[x] * &cos + along * &sin);
            assert_close(&end[x], &closed_form, problem.name);
        }
    }
}

#[test]
fn the_reference_is_keplers_ellipse() {
    let (start, end) = solved(&ELLIPSE, 20);
    let (periapsis, speed, mu) = (&start[0], &start[3], ratio(9, 16));
    let e = periapsis * speed * speed / &mu - real(1);
    let half_axis = periapsis / (real(1) - &e);
    let mean = (&mu / (&half_axis * &half_axis * &half_axis)).sqrt() * ratio(ELLIPSE.tenths.into(), 10);
    // Newton's iteration for Kepler's equation, E − e·sin E = M.
    let mut anomaly = mean.clone();
    for _ in 0..20 {
        let (sin, cos) = anomaly.sin_cos();
        anomaly -= (&anomaly - &e * sin - &mean) / (real(1) - &e * cos);
    }
    let (sin, cos) = anomaly.sin_cos();
    assert_close(&end[0], &(&half_axis * (cos - &e)), "along the axis");
    assert_close(&end[1], &(&half_axis * (real(1) - &e * &e).sqrt() * sin), "across it");
}

#[test]
fn the_reference_is_the_closed_form_of_the_damped_spin() {
    let (start, end) = solved(&SPUN_UP, 20);
    let log = exact(SPIN_KEPT).ln();
    let terminal = real(-40) / &log;
    let t = ratio(SPUN_UP.tenths.into(), 10);
    let left = (&log * &t).exp();
    let excess = &start[5] - &terminal;
    assert_close(&end[5], &(&terminal + &excess * &left), "spin");
    assert_close(&end[4], &(&start[4] + &terminal * &t + &excess * (left - real(1)) / &log), "angle");
}
