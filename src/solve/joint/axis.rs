//! The law of a free row of a joint - an angle, or a distance along an axis or a line - with limits, a motor, friction and a spring.
//!
//! All of them act along the one row, and its impulse is one value: a function of the velocity of the row at the end of a pass that falls in
//! *steps*. Each limit, the motor and friction make a step, as high as their impulses go, at the velocity that they aim at; a spring makes a
//! slope. Between two steps the impulse is on a *level*.
//!
//! ```text
//! impulse
//!   ∞ |                    lower limit: at least the velocity that leaves it
//!     |
//!     +-----+              motor and friction push forwards
//!           |              motor: its speed
//!           +----+         they are against each other
//!                |         friction: no velocity
//!                +-----+   both push backwards
//!                      |
//!                      |   upper limit
//!                          velocity
//! ```
//!
//! So limits and a motor have no order among them, both limits change places in a mirror, and one impulse tells the state of all: a pass
//! only asks on which step or level the row ends. It takes the place where the pass before ended, and at first the one where the joint alone would
//! end; if the impulse then lies beyond the step, or the velocity beyond the level, the row moves on to the next one and the pass is done once more
//! ([`AxisRow::revise`]). Where rows move on still after some rounds, as where limits of a chain between two supports press against motors, the
//! pass begins anew with a descent ([`AxisRow::descend`]), which cannot go round in circles.
//!
//! A motor and friction aim at a velocity between the velocities of the limits: they stop at a limit, and press against it with no more than
//! their force.
//!
//! Both rows of a planar joint are *paired*: the forces of motor and spring are bounds of vectors. Each row alone has no bound. Where the
//! impulses of the springs come out too long they are shortened for the pass, then the impulses of the motors likewise
//! ([`AxisRow::revise_pair`]).
//!
//! - *Solve pass*: a limit lets the row come as near as it is, and pushes it back by a part of the error. The impulse of a [spring](spring) is
//!   −(d·w + e·v + s·c) for the velocity w at the end of the pass, v at the beginning of the sub-step and the error c at the beginning.
//! - *Relax pass*: limits do not push back, a limit that the row is still on the way to does not act, and the impulse of the spring stays.

mod impact;
mod pair;
mod spring;
mod steps;

use self::impact::Stop;
use self::spring::SpringFactors;
use super::tree::FRACTION;
use super::{FAR, IMPULSE};
use crate::fx::Fx;
use crate::kernel::wide::mul_shift_64;
use crate::scalar::FxFactor;
use crate::solve::number::shifted;
use crate::solve::unit::{Clock, multiple};

/// The free row of a joint, with all that acts along it: for an angle in rad, rad/s and N·m, for a distance in m, m/s and N.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Axis {
    /// The position at the start of the step.
    pub position: Fx,
    /// The lowest and the highest position; not in the wrong order.
    pub limits: Option<[Fx; 2]>,
    /// The velocity that a motor aims at.
    pub motor_speed: Fx,
    /// The largest force of the motor; zero without a motor.
    pub motor_force: Fx,
    /// The largest force of friction.
    pub friction: Fx,
    /// A spring, if there is one.
    pub spring: Option<AxisSpring>,
}

/// A spring along the axis of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AxisSpring {
    /// Hz, of the two bodies of the joint alone.
    pub frequency: Fx,
    /// Damping over critical damping.
    pub damping_ratio: Fx,
    /// The position at rest.
    pub rest: Fx,
    /// The largest force.
    pub max_force: Fx,
}

/// The largest velocity of a step, in 2^-30: of a row between two bodies.
const FASTEST: i128 = 1 << 61;
/// A level beyond all impulses.
pub(super) const ENDLESS: i64 = 1 << 60;
/// The distance from a limit at which a row is at it, as contacts touch: 2^-10 m in 2^-32 m.
const TOUCH: i128 = 1 << 22;
/// The largest number of steps.
const STEPS: usize = 4;
/// A row is as stiff as 2^STIFFEST times its effective mass.
pub(super) const STIFFEST: i32 = 11;

/// The place where a row ends in a pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Place {
    Step(usize),
    /// Above the step of the same number: at a higher velocity, and a lower impulse.
    Level(usize),
    /// A level on which the spring is at its largest force, with the sign of its impulse.
    Strained(usize, i64),
    /// The impulse that the row has at the end, whatever its velocity.
    Given(i64),
}

/// A row at the end of a pass, to be reached by the change Δ of its impulse with the change Δw of its velocity: Δ = `change` − `slope`·Δw.
#[derive(Clone, Copy, Debug)]
pub(super) enum Aim {
    /// Δw = −`velocity`, in 2^-30, with the stiffest slope; at a limit the row gives way to its impulse.
    Velocity { velocity: i64, gives_way: bool },
    /// The slope is the slope of the spring, if `is_elastic`, else zero.
    Impulse { change: i64, is_elastic: bool },
}

/// The law of a row as the passes see it.
#[derive(Clone, Debug)]
pub(super) struct AxisRow {
    /// log2 of the length at which velocities of the row are taken, m.
    pub(super) length: i32,
    /// The effective mass, and the d of the spring, kg.
    pub(super) mass: FxFactor,
    pub(super) damping: FxFactor,
    /// The impulses for a velocity in 2^-30, by the effective mass, by d and by e, and for an error, by s: mantissa and shift.
    by_mass: (u64, i32),
    by_damping: (u64, i32),
    by_start: (u64, i32),
    by_stiffness: (u64, i32),
    /// True if e is negative.
    is_start_negative: bool,
    /// The limits and the rest position against the position at the start. Limits at the end of the range for none.
    lower: i64,
    upper: i64,
    rest: i64,
    /// The way since the start, and the velocity at the beginning of the sub-step, in 2^-30.
    way: i64,
    start: i64,
    /// The way up to a limit within which the row is at it.
    touch: i64,
    stop: Stop,
    motor_speed: i64,
    /// The largest impulses in a sub-step.
    motor: i64,
    friction: i64,
    spring: i64,
    /// The largest vectors of the impulses of motors and of springs of a pair.
    pair: Option<[i64; 2]>,
    /// The impulse of the spring of a paired row in the pass, where the pair is at its largest force.
    strain: Option<i64>,
    /// The velocities of the steps, in 2^-30, falling, and the levels above, between and below them, rising.
    count: usize,
    velocities: [i64; STEPS],
    levels: [i64; STEPS + 1],
    /// The velocity at the beginning of the pass, in 2^-30.
    velocity: i64,
    place: Place,
    /// The place where the last pass ended, and the number of its steps.
    last_place: Place,
    last_count: usize,
    /// The impulse of the spring in the relax pass.
    spring_impulse: i64,
    is_biased: bool,
}

/// The product of a number and a factor, within ±limit.
fn product(factor: (u64, i32), value: i128, limit: i64) -> i64 {
    let (mantissa, shift) = factor;
    if value.unsigned_abs() < 1 << 62 && matches!(shift, 64..128) {
        return multiple(value as i64, mantissa, shift).clamp(-limit, limit);
    }
    let limit = i128::from(limit);
    mul_shift_64(value, mantissa, shift).unwrap_or(value.signum() * limit).clamp(-limit, limit) as i64
}

impl Axis {
    /// A speed that the motor or the spring may give the row in the step, in 2^-32 m/s, for its effective mass and the length at which its velocities
    /// are taken.
    pub(super) fn speed(&self, mass: FxFactor, length: i32, clock: &Clock) -> u128 {
        let spring = self.spring.map_or(0, |spring| {
            let way = self.position.saturating_sub(spring.rest).to_bits().unsigned_abs();
            // 2π is below 8. Below 2^31 Hz and 2^63 units.
            let free = (u128::from(way) * u128::from(spring.frequency.to_bits().unsigned_abs())) >> 29;
            let step = clock.substep.times(FxFactor::new(clock.substeps.into(), 0));
            let (mantissa, shift) = FxFactor::from_scalar(spring.max_force).times(step).over(mass).parts();
            free.min(mul_shift_64(1 << 32, mantissa, shift).map_or(u128::MAX, i128::unsigned_abs))
        });
        let motor = if self.motor_force > Fx::ZERO { self.motor_speed.to_bits().unsigned_abs() } else { 0 };
        let fastest = spring.max(motor.into());
        // Below 2^97 and lengths within 2^13.
        if length < 0 { fastest >> -length } else { fastest << length.min(30) }
    }
}

impl AxisRow {
    /// A row with an effective mass, kg or kg·m², whose velocities are taken at 2^`length` m, with the unit of velocity 2^`unit` m/s and of
    /// impulses 2^`mass_exponent` kg of it.
    pub(super) fn new(axis: &Axis, mass: FxFactor, length: i32, clock: &Clock, unit: i32, mass_exponent: i32) -> Self {
        let (mantissa, shift) = mass.parts();
        let mass = FxFactor::from_parts(mantissa, shift + 2 * length).unwrap_or(FxFactor::ZERO);
        let impulse_by = |factor: FxFactor, fraction: i32| {
            let (mantissa, shift) = factor.parts();
            (mantissa, shift + mass_exponent + fraction)
        };
        let position = |radians: i128| clock.length_of_bits(radians, unit - length).clamp(-FAR, FAR) as i64;
        let from_start = |radians: Fx| position(i128::from(radians.to_bits()) - i128::from(axis.position.to_bits()));
        // Most rows lack some of them.
        let limit = |force: Fx| {
            if force == Fx::ZERO {
                return 0;
            }
            let (mantissa, shift) = clock.substep.parts();
            product((mantissa, shift + 32 + mass_exponent + unit + length), force.to_bits().into(), IMPULSE)
        };
        let speed = shifted(axis.motor_speed.to_bits().into(), 2 + unit - length).clamp(-FASTEST, FASTEST);
        let spring = axis.spring.as_ref().map_or(SpringFactors::NONE, |spring| SpringFactors::new(spring, clock));
        let damping = spring.damping.times(mass);
        Self {
            length,
            mass,
            damping,
            by_mass: impulse_by(mass, 30),
            by_damping: impulse_by(damping, 30),
            by_start: impulse_by(spring.start.times(mass), 30),
            by_stiffness: impulse_by(spring.stiffness.times(mass), 0),
            is_start_negative: spring.is_start_negative,
            lower: axis.limits.map_or(-ENDLESS, |[lower, _]| from_start(lower)),
            upper: axis.limits.map_or(ENDLESS, |[_, upper]| from_start(upper)),
            rest: axis.spring.map_or(0, |spring| from_start(spring.rest)),
            way: 0,
            start: 0,
            touch: clock.length_of_bits(TOUCH, unit).clamp(0, FAR) as i64,
            stop: Stop::Open,
            motor_speed: speed as i64,
            motor: limit(axis.motor_force),
            friction: limit(axis.friction),
            spring: axis.spring.map_or(0, |spring| limit(spring.max_force)),
            pair: None,
            strain: None,
            count: 0,
            velocities: [0; STEPS],
            levels: [0; STEPS + 1],
            velocity: 0,
            place: Place::Level(0),
            last_place: Place::Given(0),
            last_count: 0,
            spring_impulse: 0,
            is_biased: true,
        }
    }

    pub(super) fn has_spring(&self) -> bool {
        self.spring > 0
    }

    /// A guess by the impulse that the row starts from: true if it may hold a velocity in the first pass.
    pub(super) fn may_hold(&self, impulse: i64) -> bool {
        let forces = self.motor + self.friction;
        let is_held = if forces > 0 { impulse.abs() < forces } else { impulse != 0 };
        self.is_locked() || is_held && !self.has_spring()
    }

    /// Takes note of the velocity of the row at the beginning of a sub-step, in 2^-30.
    pub(super) fn set_start(&mut self, velocity: i64) {
        self.start = velocity;
    }

    /// Takes note of the way of the row since the start.
    pub(super) fn set_way(&mut self, way: i64) {
        self.way = way;
    }

    /// Begins a pass with the velocity of the row, in 2^-30, and its impulse; with a rate, in 2^-30, the solve pass.
    #[inline(always)]
    pub(super) fn begin(&mut self, velocity: i64, impulse: i64, rate: Option<i64>) {
        self.is_biased = rate.is_some();
        self.strain = None;
        self.velocity = velocity;
        self.set_steps(rate);
        self.place = match self.last_place {
            Place::Step(_) | Place::Level(_) if self.count == self.last_count && !self.is_paired() => self.last_place,
            _ => self.find_place(velocity, impulse, self.by_mass),
        };
    }

    /// Returns true if the limits leave one position.
    pub(super) fn is_locked(&self) -> bool {
        self.lower == self.upper
    }

    /// The impulse of the spring at a velocity.
    #[inline(always)]
    fn spring_at(&self, velocity: i64) -> i64 {
        if !self.is_biased {
            return self.spring_impulse;
        }
        if let Some(strain) = self.strain {
            return strain;
        }
        if self.spring == 0 {
            return 0;
        }
        let error = i128::from(self.way) - i128::from(self.rest);
        let start = product(self.by_start, self.start.into(), ENDLESS);
        let impulse = product(self.by_damping, velocity.into(), ENDLESS)
            + product(self.by_stiffness, error, ENDLESS)
            + if self.is_start_negative { -start } else { start };
        -impulse.clamp(-self.spring, self.spring)
    }

    /// The place where the row would end if it met nothing but a mass, as the factor `by_mass` of impulses by velocities.
    fn find_place(&self, velocity: i64, impulse: i64, by_mass: (u64, i32)) -> Place {
        for step in 0..self.count {
            let change = product(by_mass, i128::from(self.velocities[step]) - i128::from(velocity), ENDLESS);
            let wanted = impulse + change - self.spring_at(self.velocities[step]);
            if wanted < self.levels[step] {
                return Place::Level(step);
            }
            if wanted <= self.levels[step + 1] {
                return Place::Step(step);
            }
        }
        Place::Level(self.count)
    }

    /// The aim of the pass for the row, from its impulse at the beginning.
    #[inline(always)]
    pub(super) fn aim(&self, impulse: i64) -> Aim {
        let velocity = self.velocity;
        match self.place {
            Place::Step(step) => {
                let is_limit = self.levels[step] == -ENDLESS || self.levels[step + 1] == ENDLESS;
                Aim::Velocity { velocity: velocity - self.velocities[step], gives_way: is_limit && self.is_biased }
            }
            Place::Level(level) => {
                let change = self.levels[level] + self.spring_at(velocity) - impulse;
                Aim::Impulse { change, is_elastic: self.is_elastic() }
            }
            Place::Strained(level, sign) => {
                Aim::Impulse { change: self.levels[level] + sign * self.spring - impulse, is_elastic: false }
            }
            Place::Given(given) => Aim::Impulse { change: given - impulse, is_elastic: false },
        }
    }

    /// Moves on to the next place if the row has left its place, at the end of a pass with this change of its velocity, in 2^-[`FRACTION`], and this
    /// impulse. Returns true if it has.
    #[inline(always)]
    pub(super) fn revise(&mut self, change: i64, impulse: i64) -> bool {
        let velocity = self.velocity_after(change);
        if self.is_biased {
            self.spring_impulse = self.spring_part(impulse);
        }
        let place = match self.place {
            Place::Step(step) => {
                let pressed = impulse - self.spring_at(self.velocities[step]);
                if pressed < self.levels[step] {
                    Place::Level(step)
                } else if pressed > self.levels[step + 1] {
                    Place::Level(step + 1)
                } else {
                    self.place
                }
            }
            Place::Level(level) | Place::Strained(level, _) => {
                let strain = impulse - self.levels[level];
                if level < self.count && velocity < self.velocities[level] {
                    Place::Step(level)
                } else if level > 0 && velocity > self.velocities[level - 1] {
                    Place::Step(level - 1)
                } else if self.is_biased && strain.abs() > self.spring {
                    Place::Strained(level, strain.signum())
                } else {
                    self.place
                }
            }
            Place::Given(_) => self.place,
        };
        let has_left = place != self.place;
        self.place = place;
        has_left
    }

    /// The part of the spring of an impulse at the end of a pass.
    #[inline(always)]
    fn spring_part(&self, impulse: i64) -> i64 {
        match self.place {
            Place::Step(step) => self.spring_at(self.velocities[step]),
            Place::Level(level) | Place::Strained(level, _) => {
                (impulse - self.levels[level]).clamp(-self.spring, self.spring)
            }
            Place::Given(_) => self.spring_impulse,
        }
    }

    /// Begins a [descent](super::tree) after [`begin`](Self::begin), from the impulse of the row.
    pub(super) fn begin_descent(&mut self, impulse: i64) {
        self.place = Place::Given(impulse);
    }

    /// An iteration of a descent, after the change of its velocity since the beginning of the pass, in 2^-[`FRACTION`]: the impulse that the law has
    /// where the row meets 2^-`share` of its own effective mass.
    pub(super) fn descend(&mut self, change: i64, share: i32) {
        let Place::Given(impulse) = self.place else { return };
        let velocity = self.velocity_after(change);
        let (mantissa, shift) = self.by_mass;
        let by_mass = (mantissa, shift + share);
        let place = self.find_place(velocity, impulse, by_mass);
        let spring = match place {
            Place::Step(step) => self.spring_at(self.velocities[step]),
            Place::Level(level) if self.is_elastic() => {
                let wanted = self.levels[level] + self.spring_at(velocity) - impulse;
                // The spring gives way by its damping d, and the row by its mass m: the share m/(m + d) is left.
                let damping = self.damping.times(FxFactor::from_ratio(1 << share, 1));
                let left = self.mass.over(self.mass.plus(damping));
                let reached = impulse + product(left.parts(), wanted.into(), ENDLESS);
                (reached - self.levels[level]).clamp(-self.spring, self.spring)
            }
            Place::Level(_) | Place::Strained(..) | Place::Given(_) => self.spring_at(velocity),
        };
        if self.is_biased {
            self.spring_impulse = spring;
        }
        self.place = Place::Given(match place {
            Place::Step(step) => {
                impulse + product(by_mass, i128::from(self.velocities[step]) - i128::from(velocity), ENDLESS)
            }
            Place::Level(level) | Place::Strained(level, _) => self.levels[level] + spring,
            Place::Given(_) => impulse,
        });
    }

    /// Returns true if the impulse of the spring follows from the velocity.
    #[inline(always)]
    fn is_elastic(&self) -> bool {
        self.is_biased && self.spring > 0 && self.strain.is_none()
    }

    /// The velocity after a change since the beginning of the pass, in 2^-[`FRACTION`].
    #[inline(always)]
    fn velocity_after(&self, change: i64) -> i64 {
        let limit = i128::from(i64::MAX);
        (i128::from(self.velocity) + (i128::from(change) << (30 - FRACTION))).clamp(-limit, limit) as i64
    }

    /// The impulse within the range of the place where the row ended, from the impulse that the pass led to.
    #[inline(always)]
    pub(super) fn finish(&mut self, impulse: i64) -> i64 {
        (self.last_place, self.last_count) = (self.place, self.count);
        let impulse = match self.place {
            Place::Step(step) => {
                let spring = self.spring_at(self.velocities[step]);
                let [lowest, highest] = [self.levels[step], self.levels[step + 1]].map(|level| level + spring);
                if self.is_biased {
                    self.spring_impulse = spring;
                }
                impulse.clamp(lowest, highest)
            }
            Place::Level(level) | Place::Strained(level, _) if self.is_biased => {
                self.spring_impulse = (impulse - self.levels[level]).clamp(-self.spring, self.spring);
                self.levels[level] + self.spring_impulse
            }
            Place::Level(_) | Place::Strained(..) => impulse,
            Place::Given(impulse) => impulse,
        };
        impulse.clamp(-IMPULSE, IMPULSE)
    }
}
