//! Scenes for tests of the solver, by hand or at random, and their images under mirrors, turns and changes of order.

use alloc::vec::Vec;

use crate::fx::Fx;
use crate::kernel::simd::{Job, Portable};
use crate::math::{Random, TimeStep, Vec2};
use crate::scalar::{FxAccumulator, FxFactor};
use crate::solve::unit::Clock;
use crate::solve::{
    Contact, Correction, Flight, Impulses, Point, Solver, SolverCounts, SolverOptions, SubSteps, Velocity,
};

/// Bodies, the contacts between them, and the settings to solve them with.
#[derive(Clone, Debug)]
pub(super) struct Scene {
    pub(super) flights: Vec<Flight>,
    pub(super) contacts: Vec<Contact>,
    pub(super) options: SolverOptions,
    pub(super) time_step: TimeStep,
}

/// The results of the solver for a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Solution {
    pub(super) impulses: Vec<Impulses>,
    pub(super) corrections: Vec<Correction>,
    pub(super) counts: SolverCounts,
}

/// A number as the nearest multiple of 2^-32.
pub(super) fn fx(value: f64) -> Fx {
    Fx::from_bits((value * 4_294_967_296.0).round() as i64)
}

pub(super) fn vec(x: f64, y: f64) -> Vec2 {
    Vec2::new(fx(x), fx(y))
}

/// The factor nearest to a positive number.
pub(super) fn factor(value: f64) -> FxFactor {
    let exponent = value.log2().floor() as i32;
    let mantissa = (value * 2f64.powi(63 - exponent)) as u128;
    FxFactor::new(mantissa, 63 - exponent)
}

/// A body at rest. `gyration` is R²·m/I for the radius R.
pub(super) fn body(mass: f64, gyration: f64, radius: f64) -> Flight {
    let mass = fx(mass);
    let r = FxFactor::from_scalar(fx(radius));
    let inertia = r.times(r).times(FxFactor::from_scalar(mass)).over(factor(gyration));
    let inverse = FxFactor::ONE.over(FxFactor::from_scalar(mass));
    Flight {
        position: Vec2::default(),
        start: Velocity::default(),
        end: Velocity::default(),
        displacement: Vec2::default(),
        rotation: Fx::from_bits(0),
        mass,
        inverse_mass: Vec2::new(inverse, inverse),
        inverse_inertia: FxFactor::ONE.over(inertia),
        radius: fx(radius),
        leader: None,
    }
}

/// A body that cannot be moved.
pub(super) fn fixed(radius: f64) -> Flight {
    Flight {
        inverse_mass: Vec2::new(FxFactor::ZERO, FxFactor::ZERO),
        inverse_inertia: FxFactor::ZERO,
        ..body(1.0, 2.0, radius)
    }
}

impl Flight {
    /// The body in straight flight at these velocities, over a step of `seconds`.
    pub(super) fn flying(self, [x, y, angular]: [f64; 3], seconds: f64) -> Self {
        let velocity = Velocity { linear: vec(x, y), angular: fx(angular) };
        let displacement = vec(x * seconds, y * seconds);
        Self { start: velocity, end: velocity, displacement, rotation: fx(angular * seconds), ..self }
    }
}

/// A contact with points given by the arms of both bodies and the separation, frictionless.
pub(super) fn contact(bodies: [u32; 2], normal: [f64; 2], points: &[([f64; 2], [f64; 2], f64)]) -> Contact {
    let mut contact_points = [Point::default(); 2];
    for (point, &(a, b, separation)) in contact_points.iter_mut().zip(points) {
        *point = Point { arms: [vec(a[0], a[1]), vec(b[0], b[1])], separation: fx(separation) };
    }
    Contact {
        bodies,
        normal: normal.map(|n| (n * f64::from(1 << 30)).round() as i32),
        count: points.len(),
        points: contact_points,
        friction: fx(0.0),
        restitution: fx(0.0),
        rolling_resistance: fx(0.0),
        rolling_radius: fx(0.0),
        surface_speed: fx(0.0),
        impulses: Impulses::default(),
    }
}

impl Scene {
    pub(super) fn new(flights: Vec<Flight>, contacts: Vec<Contact>) -> Self {
        Self { flights, contacts, options: SolverOptions::default(), time_step: TimeStep::hz(60) }
    }

    pub(super) fn solve(&self) -> Solution {
        self.solve_with(&mut Solver::default())
    }

    /// Solves the scene with a solver that may have solved others.
    pub(super) fn solve_with(&self, solver: &mut Solver) -> Solution {
        let mut corrections = Vec::new();
        let mut contacts = self.contacts.clone();
        let counts =
            solver.solve(self.time_step, &self.options, &self.flights, &mut [], &mut contacts, &mut corrections);
        Solution { impulses: contacts.iter().map(|contact| contact.impulses).collect(), corrections, counts }
    }

    /// Solves the scene with one lane at a time.
    pub(super) fn solve_portably(&self) -> Solution {
        let mut solver = Solver::default();
        let mut corrections = Vec::new();
        let mut contacts = self.contacts.clone();
        solver.prepare(self.time_step, &self.options, &self.flights, &[], &contacts);
        let clock = Clock::new(self.time_step, self.options.substeps);
        let options = &self.options;
        let cut = SubSteps { solver: &mut solver, clock: &clock, options, contacts: &contacts }.run(Portable);
        solver.finish(self.time_step, &self.options, &self.flights, &mut [], &mut contacts, &mut corrections);
        let impulses = contacts.iter().map(|contact| contact.impulses).collect();
        Solution { impulses, corrections, counts: SolverCounts { cut } }
    }
}

/// A scene as another observer sees it, and its solution.
pub(super) trait Image {
    #[must_use]
    fn mirrored(&self) -> Self;
    /// A quarter turn: (x, y) to (−y, x).
    #[must_use]
    fn turned(&self) -> Self;
    /// The bodies of each contact in the opposite order.
    #[must_use]
    fn swapped(&self) -> Self;
    /// The points of each contact in the opposite order.
    #[must_use]
    fn with_points_swapped(&self) -> Self;
}

fn mirrored(v: Vec2) -> Vec2 {
    Vec2::new(negated(v.x), v.y)
}

fn turned(v: Vec2) -> Vec2 {
    Vec2::new(negated(v.y), v.x)
}

fn negated(value: Fx) -> Fx {
    Fx::from_bits(-value.to_bits())
}

fn minus(value: FxAccumulator) -> FxAccumulator {
    FxAccumulator::from_bits(-value.to_bits())
}

impl Image for Velocity {
    fn mirrored(&self) -> Self {
        Self { linear: mirrored(self.linear), angular: negated(self.angular) }
    }

    fn turned(&self) -> Self {
        Self { linear: turned(self.linear), ..*self }
    }

    fn swapped(&self) -> Self {
        *self
    }

    fn with_points_swapped(&self) -> Self {
        *self
    }
}

impl Image for Flight {
    fn mirrored(&self) -> Self {
        Self {
            position: mirrored(self.position),
            start: self.start.mirrored(),
            end: self.end.mirrored(),
            displacement: mirrored(self.displacement),
            rotation: negated(self.rotation),
            ..*self
        }
    }

    fn turned(&self) -> Self {
        Self {
            position: turned(self.position),
            start: self.start.turned(),
            end: self.end.turned(),
            displacement: turned(self.displacement),
            inverse_mass: Vec2::new(self.inverse_mass.y, self.inverse_mass.x),
            ..*self
        }
    }

    fn swapped(&self) -> Self {
        *self
    }

    fn with_points_swapped(&self) -> Self {
        *self
    }
}

impl Image for Impulses {
    fn mirrored(&self) -> Self {
        let [first, second, tangential] = self.values;
        Self { values: [first, second, -tangential], ..*self }
    }

    fn turned(&self) -> Self {
        *self
    }

    fn swapped(&self) -> Self {
        *self
    }

    fn with_points_swapped(&self) -> Self {
        let [first, second, tangential] = self.values;
        Self { values: [second, first, tangential], ..*self }
    }
}

impl Image for Contact {
    fn mirrored(&self) -> Self {
        let [x, y] = self.normal;
        let points = self.points.map(|point| Point { arms: point.arms.map(mirrored), ..point });
        let surface_speed = negated(self.surface_speed);
        let mut impulses = self.impulses.mirrored();
        if self.count == 1 {
            impulses.values[1] = -impulses.values[1];
        }
        Self { normal: [-x, y], points, surface_speed, impulses, ..*self }
    }

    fn turned(&self) -> Self {
        let [x, y] = self.normal;
        let points = self.points.map(|point| Point { arms: point.arms.map(turned), ..point });
        Self { normal: [-y, x], points, ..*self }
    }

    fn swapped(&self) -> Self {
        let [a, b] = self.bodies;
        let points = self.points.map(|point| Point { arms: [point.arms[1], point.arms[0]], ..point });
        let mut impulses = self.impulses;
        if self.count == 1 {
            impulses.values[1] = -impulses.values[1];
        }
        Self { bodies: [b, a], normal: self.normal.map(|n| -n), points, impulses, ..*self }
    }

    fn with_points_swapped(&self) -> Self {
        if self.count < 2 {
            return *self;
        }
        let [first, second] = self.points;
        Self { points: [second, first], impulses: self.impulses.with_points_swapped(), ..*self }
    }
}

impl Image for Correction {
    fn mirrored(&self) -> Self {
        let flip = |v: Vec2<FxAccumulator>| Vec2::new(minus(v.x), v.y);
        Self {
            is_pushed: self.is_pushed,
            velocity: flip(self.velocity),
            angular_velocity: minus(self.angular_velocity),
            displacement: flip(self.displacement),
            rotation: minus(self.rotation),
        }
    }

    fn turned(&self) -> Self {
        let turn = |v: Vec2<FxAccumulator>| Vec2::new(minus(v.y), v.x);
        Self { velocity: turn(self.velocity), displacement: turn(self.displacement), ..*self }
    }

    fn swapped(&self) -> Self {
        *self
    }

    fn with_points_swapped(&self) -> Self {
        *self
    }
}

impl Scene {
    /// The scene with the images of its flights and contacts.
    pub(super) fn image(&self, flight: impl Fn(&Flight) -> Flight, contact: impl Fn(&Contact) -> Contact) -> Self {
        Self {
            flights: self.flights.iter().map(flight).collect(),
            contacts: self.contacts.iter().map(contact).collect(),
            ..*self
        }
    }
}

/// A number with all magnitudes from 2^low to 2^high equally likely.
pub(super) fn by_exponent(random: &mut Random, low: f64, high: f64) -> f64 {
    (low + (high - low) * unit(random)).exp2()
}

/// A number from 0 to below 1.
pub(super) fn unit(random: &mut Random) -> f64 {
    (random.bits() >> 11) as f64 / 2f64.powi(53)
}

/// A number from −1 to 1.
pub(super) fn signed(random: &mut Random) -> f64 {
    2.0 * unit(random) - 1.0
}
