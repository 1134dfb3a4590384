//! Laws of rows: the impulse of a row as a function of its velocity at the end of a pass.
//!
//! A row has up to four *parts*, whose impulses add up: its limits, a motor, friction and a spring. The impulse of each falls with the velocity
//! w, and stays within bounds:
//!
//! ```text
//! limits, motor, friction     λ' = clamp(λ − k·(w − s), lowest, highest)       s: the velocity that the part aims at
//! spring                      λ' = clamp(−(d·w + e·v + p·c), −F, F)           v: the velocity at the beginning of the sub-step, c: the stretch
//! ```
//!
//! - A row that is held at zero has limits of one position.
//! - *Solve pass*: limits give way to their impulse, k·(s − w) in place of λ + k·(s − w), let the row come as near as it is, and take a part of
//!   the error away. *Relax pass*: they do not push back, and the spring keeps its impulse.
//! - *Answer*: rows with one position take back the motion by bounces, and all other parts keep their impulses.
//! - A motor and friction aim at a velocity between the velocities of the limits: they stop there, and press with no more than their force.
//! - The parts of both rows of a planar joint are vectors: lengths are clamped.
//!
//! Springs have the factors of the exact solution for one body, as in the solver in integers: with E = e^(−ζhω) and the effective
//! mass m,
//!
//! ```text
//! Q = (1 − E)² + 4·E·sin²(hω·√(1 − ζ²)/2)      p = m·hω²      d = m·(hω)²/Q − m      e = m − m·(E·hω)²/Q
//! ```
//!
//! Above ζ = 1, Q = (1 − E₁)·(1 − E₂) for both exponents. From hω = 1/2 on, d = m·hω·(2ζ + hω) and e = 0.

use core::f64::consts::TAU;

use crate::scalar::ToF64 as _;
use crate::solve::float::{Clock, Pair, within};
use crate::solve::{Axis, AxisSpring};

/// The stiffness of limits over the effective mass of their row; and of motors and friction, which keep no position.
const LIMIT_STIFFNESS: f64 = 2048.0;
const MOTOR_STIFFNESS: f64 = 65_536.0;
/// The part of an error that is taken away in a sub-step; and by rows that are held, in sets that touch nothing.
const RATE: f64 = 0.1;
const FREE_RATE: f64 = 0.3;

/// The impulses of the parts of a row.
pub(super) type Parts = [f64; 4];
const LIMITS: usize = 0;
const MOTOR: usize = 1;
const FRICTION: usize = 2;
const SPRING: usize = 3;

/// The aim of a pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Aim {
    Solve,
    Relax,
    Answer,
}

/// A spring: m, rad, N·s and N·m·s.
#[derive(Clone, Copy, Debug)]
struct Spring {
    /// d, e and p.
    damping: f64,
    start: f64,
    stiffness: f64,
    /// The way to the position at rest from the start of the step.
    rest: f64,
    /// The largest impulse in a sub-step.
    bound: f64,
}

impl Spring {
    fn new(spring: &AxisSpring, position: f64, mass: f64, clock: Clock) -> Self {
        let (ratio, omega) = (spring.damping_ratio.to_f64(), TAU * spring.frequency.to_f64());
        let angle = omega * clock.length;
        let square = angle * angle;
        let (mut damping, mut start) = (angle * (2.0 * ratio + angle), 0.0);
        if angle > 0.0 && angle <= 0.5 {
            let whole = libm::exp(-angle * ratio);
            let lost = |exponent: f64| -libm::expm1(-angle * exponent);
            let q = if ratio <= 1.0 {
                let sine = libm::sin(angle * libm::sqrt(1.0 - ratio * ratio) / 2.0);
                lost(ratio) * lost(ratio) + 4.0 * whole * sine * sine
            } else {
                let fast = ratio + libm::sqrt(ratio * ratio - 1.0);
                // The product of both is 1.
                lost(fast) * lost(1.0 / fast)
            };
            (damping, start) = (square / q - 1.0, 1.0 - whole * whole * square / q);
        }
        // No stiffer than limits.
        let share = if damping > LIMIT_STIFFNESS { LIMIT_STIFFNESS / damping } else { 1.0 };
        Self {
            damping: mass * damping * share,
            start: mass * start * share,
            stiffness: mass * square * share / clock.length,
            rest: spring.rest.to_f64() - position,
            bound: spring.max_force.to_f64() * clock.length,
        }
    }

    /// The impulse at a velocity, without its bound.
    fn impulse(&self, velocity: f64, start: f64, way: f64) -> f64 {
        -(self.damping * velocity + self.start * start + self.stiffness * (way - self.rest))
    }
}

/// The law of a row through the sub-steps: m and N·s, or rad and N·m·s.
#[derive(Clone, Debug)]
pub(super) struct Law {
    /// The stiffness k of limits, and of motors and friction.
    limit_stiffness: f64,
    motor_stiffness: f64,
    /// The ways to both limits from the start of the step; infinite without.
    limits: Pair,
    motor_speed: f64,
    /// The largest impulses in a sub-step.
    motor: f64,
    friction: f64,
    spring: Option<Spring>,
    /// The way since the start of the step, and the velocity at the beginning of the sub-step.
    way: f64,
    start: f64,
    /// The velocities that limits, motor and friction aim at.
    limit_speeds: Pair,
    motor_aim: f64,
    friction_aim: f64,
    /// The part of an error that is taken away in a sub-step.
    rate: f64,
    /// The second-order term: the motion of the row in a sub-step over its length, less its velocity at the end.
    second_order: f64,
    aim: Aim,
    /// The impulses of the pass before.
    pub(super) parts: Parts,
}

impl Law {
    /// A row that is held at zero, with a stiffness in kg.
    pub(super) fn held(stiffness: f64) -> Self {
        Self {
            rate: RATE,
            limit_stiffness: stiffness,
            motor_stiffness: 0.0,
            limits: [0.0; 2],
            motor_speed: 0.0,
            motor: 0.0,
            friction: 0.0,
            spring: None,
            way: 0.0,
            start: 0.0,
            limit_speeds: [0.0; 2],
            motor_aim: 0.0,
            friction_aim: 0.0,
            second_order: 0.0,
            aim: Aim::Solve,
            parts: Parts::default(),
        }
    }

    /// A row with an effective mass, kg or kg·m².
    pub(super) fn new(axis: &Axis, mass: f64, clock: Clock) -> Self {
        let position = axis.position.to_f64();
        Self {
            motor_stiffness: MOTOR_STIFFNESS * mass,
            limits: axis
                .limits
                .map_or([f64::NEG_INFINITY, f64::INFINITY], |limits| limits.map(|limit| limit.to_f64() - position)),
            motor_speed: axis.motor_speed.to_f64(),
            motor: axis.motor_force.to_f64() * clock.length,
            friction: axis.friction.to_f64() * clock.length,
            spring: axis.spring.map(|spring| Spring::new(&spring, position, mass, clock)),
            ..Self::held(LIMIT_STIFFNESS * mass)
        }
    }

    pub(super) fn has_spring(&self) -> bool {
        self.spring.is_some()
    }

    /// Returns true if the limits leave one position.
    fn is_locked(&self) -> bool {
        self.limits[0] == self.limits[1]
    }

    /// Returns true if the row is held, and nothing else acts along it: its impulse has no bounds.
    pub(super) fn is_rigid(&self) -> bool {
        self.is_locked() && self.motor == 0.0 && self.friction == 0.0 && self.spring.is_none()
    }

    /// The sum of the parts.
    pub(super) fn impulse(&self) -> f64 {
        self.parts.iter().sum()
    }

    pub(super) fn set_way(&mut self, way: f64) {
        self.way = way;
    }

    /// Takes note of the velocity at the beginning of a sub-step, with the second-order term.
    pub(super) fn set_start(&mut self, velocity: f64) {
        self.start = velocity;
    }

    /// The impulse of the spring at a velocity, without its bound, and the bound.
    fn spring_at(&self, velocity: f64) -> Pair {
        self.spring.map_or([0.0; 2], |spring| [spring.impulse(velocity, self.start, self.way), spring.bound])
    }

    /// Splits the impulse of the step before among the parts: what the spring has at the start, then as much as motor and friction may have.
    pub(super) fn split(&mut self, impulse: f64) {
        if impulse == 0.0 {
            return;
        }
        let [spring, bound] = self.spring_at(self.start);
        let spring = within(spring, bound);
        let motor = within(impulse - spring, self.motor);
        let friction = within(impulse - spring - motor, self.friction);
        let [lowest, highest] = [
            if self.limits[1] < f64::INFINITY { f64::NEG_INFINITY } else { 0.0 },
            if self.limits[0] > f64::NEG_INFINITY { f64::INFINITY } else { 0.0 },
        ];
        self.parts = [(impulse - spring - motor - friction).clamp(lowest, highest), motor, friction, spring];
    }

    /// [`split`](Self::split) of the impulse of both rows of a planar joint.
    pub(super) fn split_pair(pair: [&mut Self; 2], impulses: Pair) {
        if impulses == [0.0; 2] {
            return;
        }
        let springs = pair.each_ref().map(|law| law.spring_at(law.start));
        let (springs, _) = shortened(springs.map(|[impulse, _]| impulse), springs[0][1]);
        let (motors, _) = shortened([0, 1].map(|row| impulses[row] - springs[row]), pair[0].motor);
        for (row, law) in pair.into_iter().enumerate() {
            (law.parts[MOTOR], law.parts[SPRING]) = (motors[row], springs[row]);
        }
    }

    /// Settles whether the row is in a set that touches nothing. *Domain* it is held.
    pub(super) fn set_free(&mut self, is_free: bool) {
        self.rate = if is_free { FREE_RATE } else { RATE };
    }

    /// Begins a pass, with the second-order term of the row.
    pub(super) fn begin(&mut self, aim: Aim, second_order: f64, clock: Clock) {
        (self.aim, self.second_order) = (aim, second_order);
        let [below, above] = self.limits.map(|limit| (limit - self.way) / clock.length);
        let pushed = |speed: f64, is_beyond: bool| if is_beyond { self.rate * speed } else { speed };
        self.limit_speeds = match (aim, self.is_locked()) {
            (Aim::Solve, true) => [self.rate * below; 2],
            (Aim::Solve, false) => [pushed(below, below > 0.0), pushed(above, above < 0.0)],
            (Aim::Relax | Aim::Answer, true) => [0.0; 2],
            // A limit that is neither reached nor pressed against does not act yet.
            (Aim::Relax, false) => [
                if below < 0.0 && self.parts[LIMITS] <= 0.0 { f64::NEG_INFINITY } else { below.min(0.0) },
                if above > 0.0 && self.parts[LIMITS] >= 0.0 { f64::INFINITY } else { above.max(0.0) },
            ],
            (Aim::Answer, false) => [below.min(0.0), above.max(0.0)],
        };
        let [slowest, fastest] = self.limit_speeds;
        self.motor_aim = self.motor_speed.max(slowest).min(fastest);
        self.friction_aim = 0_f64.max(slowest).min(fastest);
    }

    /// The impulses of limits and friction, and the slope of their sum, at a velocity with the second-order term.
    fn scalar_parts(&self, velocity: f64) -> (Pair, f64) {
        let (mut limit, mut slope) = (0.0, 0.0);
        let before = if self.aim == Aim::Solve { 0.0 } else { self.parts[LIMITS] };
        let [lower, upper] = self.limit_speeds.map(|speed| self.limit_stiffness * (speed - velocity));
        if self.is_locked() {
            (limit, slope) = (before + lower, self.limit_stiffness);
        } else {
            for push in [(before.max(0.0) + lower).max(0.0), (before.min(0.0) + upper).min(0.0)] {
                if push != 0.0 {
                    (limit, slope) = (limit + push, slope + self.limit_stiffness);
                }
            }
        }
        let friction = self.parts[FRICTION] + self.motor_stiffness * (self.friction_aim - velocity);
        if friction.abs() < self.friction {
            slope += self.motor_stiffness;
        }
        ([limit, within(friction, self.friction)], slope)
    }

    /// The impulses of the parts at a velocity of the row, and the slope by which their sum falls.
    pub(super) fn response(&self, velocity: f64) -> (Parts, f64) {
        if self.aim == Aim::Answer {
            return self.answer(velocity);
        }
        let velocity = velocity + self.second_order;
        let ([limit, friction], mut slope) = self.scalar_parts(velocity);
        let motor = self.parts[MOTOR] + self.motor_stiffness * (self.motor_aim - velocity);
        if motor.abs() < self.motor {
            slope += self.motor_stiffness;
        }
        let mut spring = self.parts[SPRING];
        if let (Aim::Solve, Some(Spring { damping, bound, .. })) = (self.aim, self.spring) {
            let [impulse, _] = self.spring_at(velocity);
            spring = within(impulse, bound);
            if impulse.abs() < bound {
                slope += damping;
            }
        }
        ([limit, within(motor, self.motor), friction, spring], slope)
    }

    /// [`response`](Self::response) of an answer.
    fn answer(&self, velocity: f64) -> (Parts, f64) {
        let mut parts = self.parts;
        if !self.is_locked() {
            return (parts, 0.0);
        }
        parts[LIMITS] -= self.limit_stiffness * velocity;
        (parts, self.limit_stiffness)
    }

    /// [`response`](Self::response) of both rows of a planar joint: their slopes are a matrix.
    pub(super) fn pair_response(pair: [&Self; 2], velocities: Pair) -> ([Parts; 2], [Pair; 2]) {
        if pair[0].aim == Aim::Answer {
            return (pair.map(|law| law.parts), [[0.0; 2]; 2]);
        }
        let velocities = [0, 1].map(|row| velocities[row] + pair[row].second_order);
        let mut parts = [Parts::default(); 2];
        let mut slopes = [[0.0; 2]; 2];
        for row in 0..2 {
            let ([limit, friction], slope) = pair[row].scalar_parts(velocities[row]);
            (parts[row][LIMITS], parts[row][FRICTION]) = (limit, friction);
            slopes[row][row] = slope;
        }
        let mut add = |part: usize, impulses: Pair, bound: f64, stiffness: f64| {
            let (impulses, kept) = shortened(impulses, bound);
            for row in 0..2 {
                parts[row][part] = impulses[row];
                (0..2).for_each(|column| slopes[row][column] += stiffness * kept[row][column]);
            }
        };
        let motors = [0, 1].map(|row| {
            let Self { parts, motor_stiffness, motor_aim, .. } = pair[row];
            parts[MOTOR] + motor_stiffness * (motor_aim - velocities[row])
        });
        add(MOTOR, motors, pair[0].motor, pair[0].motor_stiffness);
        match pair[0].spring {
            Some(Spring { damping, bound, .. }) if pair[0].aim == Aim::Solve => {
                let springs = [0, 1].map(|row| pair[row].spring_at(velocities[row])[0]);
                add(SPRING, springs, bound, damping);
            }
            _ => (0..2).for_each(|row| parts[row][SPRING] = pair[row].parts[SPRING]),
        }
        (parts, slopes)
    }
}

/// A vector shortened to a length, and its change by a change of the vector.
fn shortened(vector: Pair, length: f64) -> (Pair, [Pair; 2]) {
    let longer = libm::hypot(vector[0], vector[1]);
    if longer < length {
        return (vector, [[1.0, 0.0], [0.0, 1.0]]);
    }
    if longer == 0.0 {
        return ([0.0; 2], [[0.0; 2]; 2]);
    }
    let ([x, y], share) = (vector.map(|part| part / longer), length / longer);
    (vector.map(|part| part * share), [[share * y * y, -share * x * y], [-share * x * y, share * x * x]])
}
