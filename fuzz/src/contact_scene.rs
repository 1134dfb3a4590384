//! Scenes of the target `contact_solver`: bodies and contacts from bytes, and what becomes of them in a step.

use umbra_physics::limits::{POSITION, SPEED};
use umbra_physics::solve::{
    Contact, Correction, Flight, Impulses, Point, Solver, SolverCounts, SolverOptions, Velocity,
};
use umbra_physics::{Fx, FxAccumulator, FxFactor, TimeStep, Turn, Vec2, fx};

use super::number;

/// Reads the values, one byte after the other; zeros after the end.
pub struct Values<'a> {
    pub rest: &'a [u8],
}

impl Values<'_> {
    fn byte(&mut self) -> u8 {
        let (byte, rest) = self.rest.split_first().unwrap_or((&0, &[]));
        self.rest = rest;
        *byte
    }

    /// From 0 to `end` − 1. *Domain* 0 < end ≤ 256.
    pub fn below(&mut self, end: usize) -> usize {
        usize::from(self.byte()) % end
    }

    /// From 1 to `few`, and in one case of 16 up to `max`.
    fn number(&mut self, few: u8, max: u8) -> usize {
        number(self.byte(), few, max)
    }

    /// From 2^low to below 2^(high + 1). *Domain* −32 ≤ low ≤ high ≤ 30.
    fn size(&mut self, low: i32, high: i32) -> Fx {
        let exponent = low + self.below((high - low + 1) as usize) as i32;
        // One in four is a power of two: such numbers have products that are ties.
        let mantissa = 256 + Some(self.byte()).filter(|&byte| byte >= 64).map_or(0, i128::from);
        Fx::from_bits(((mantissa << (exponent + 32)) >> 8) as i64)
    }

    /// Zero, or a number of either sign whose magnitude is from 2^low to 2^high.
    fn signed(&mut self, low: i32, high: i32) -> Fx {
        let (kind, size) = (self.byte(), self.size(low, high - 1));
        match kind % 4 {
            0 => Fx::ZERO,
            1 => -size,
            2 => size,
            // As large as it may be.
            _ => Fx::from_bits((1 << (high + 32)) * if kind < 128 { 1 } else { -1 }),
        }
    }

    fn vector(&mut self, low: i32, high: i32) -> Vec2 {
        Vec2::new(self.signed(low, high), self.signed(low, high))
    }

    pub fn scene(&mut self) -> Scene {
        let rates = [60, 1, 10_000, 144, 30, 1_000];
        let time_step = TimeStep::hz(rates[self.below(rates.len())]);
        let substeps = [5, 1, 2, 3, 4, 6, 8, 16][self.below(8)];
        let options = match self.below(4) {
            0 => SolverOptions {
                // Softer contacts are beyond the solver's ranges.
                frequency: self.size(-3, -2),
                damping_ratio: self.size(2, 5),
                push_speed: self.size(-20, 20),
                restitution_speed: self.size(-20, 20),
                relax_passes: self.number(3, 65) as u32,
                substeps,
                ..SolverOptions::default()
            },
            _ => SolverOptions { substeps, ..SolverOptions::default() },
        };
        let (bodies, contacts, parts) = (1 + self.number(4, 11), self.number(6, 24), 1 + self.below(3));
        let is_wild = self.below(4) == 0;
        let mut scene = Scene { time_step, options, bodies: Vec::new(), contacts: Vec::new() };
        for _ in 0..bodies {
            scene.bodies.push(self.body(is_wild));
        }
        for _ in 0..contacts {
            scene.contacts.push(self.contact(&scene.bodies, parts));
        }
        scene
    }

    /// A body; wild ones are of any mass, inertia and speed.
    fn body(&mut self, is_wild: bool) -> Body {
        let kind = self.byte();
        let (mass, radius) = match kind % 4 {
            0 if is_wild => (self.size(-16, 23), self.size(-8, 12)),
            _ => (self.size(-2, 1), self.size(-2, 0)),
        };
        let inverse = |factor: FxFactor| if factor.is_zero() { factor } else { FxFactor::ONE.over(factor) };
        let (of_mass, length) = (FxFactor::from_scalar(mass), FxFactor::from_scalar(radius));
        let inertia = match kind / 4 % 4 {
            0 => FxFactor::ZERO,
            1 if is_wild => FxFactor::from_scalar(self.size(-32, 30)),
            _ => of_mass.times(length).times(length).over(FxFactor::from_scalar(self.size(0, 4))),
        };
        let (inverse_of_mass, none) = (inverse(of_mass), FxFactor::ZERO);
        let (inverse_mass, inverse_inertia) = match kind / 16 {
            0 | 1 => (Vec2::new(none, none), none),
            2 => (Vec2::new(none, inverse_of_mass), inverse(inertia)),
            3 => (Vec2::new(inverse_of_mass, none), none),
            _ => (Vec2::new(inverse_of_mass, inverse_of_mass), inverse(inertia)),
        };
        let is_still = kind / 16 == 0;
        let max = if is_wild && self.below(4) == 0 { 20 } else { 3 };
        let velocity = |values: &mut Self, max: i32| match is_still {
            true => Velocity::default(),
            false => Velocity { linear: values.vector(-32, max), angular: values.signed(-32, max) },
        };
        let (velocity, change) = (velocity(self, max), velocity(self, max - 5));
        let change = if kind / 16 <= 1 { Velocity::default() } else { change };
        let farthest = if self.below(8) == 0 { 30 } else { 4 };
        let position = self.vector(-32, farthest);
        Body { position, velocity, change, mass, inverse_mass, inverse_inertia, radius }
    }

    /// A contact of two bodies whose indices have the same remainder by `parts`, if there are such.
    fn contact(&mut self, bodies: &[Body], parts: usize) -> Contact {
        let a = self.below(bodies.len());
        let others: Vec<usize> = (a % parts..bodies.len()).step_by(parts).filter(|&b| b != a).collect();
        let b = others.get(self.below(others.len().max(1))).copied().unwrap_or((a + 1) % bodies.len());
        let kind = self.byte();
        // Quarters of a turn, and what is between.
        let angle = match kind % 4 {
            0 => u64::from(self.byte()) << 62,
            _ => u64::from(self.byte()) << 56 | u64::from(self.byte()) << 20,
        };
        let (sin, cos) = Turn::from_bits(angle).sin_cos();
        let count = 1 + usize::from(kind / 4 % 2);
        let mut points = [Point::default(); 2];
        for point in &mut points[..count] {
            let mut arm = |body: usize| {
                let mut part = || {
                    // A share of the radius in 2^-7; two components below 0.7 of it are within it.
                    let share = i64::from(self.byte() as i8) * 90 / 128;
                    Fx::from_bits(bodies[body].radius.to_bits() / 128 * share)
                };
                Vec2::new(part(), part())
            };
            let arms = [arm(a), arm(b)];
            let separation = if kind / 8 % 4 == 0 { self.signed(-32, 14) } else { self.signed(-20, -4) };
            *point = Point { arms, separation };
        }
        let mut impulses = Impulses::default();
        if kind / 32 % 2 == 1 {
            let exponent = if kind < 128 { -30 } else { self.below(161) as i32 - 80 };
            let mut value = || (256 + i64::from(self.byte())) << self.below(54);
            let (first, second, along) = (value(), value(), value());
            let along = if first % 2 == 0 { along } else { -along };
            impulses = Impulses { values: [first, if count == 2 { second } else { 0 }, along], exponent };
        }
        Contact {
            bodies: [a as u32, b as u32],
            normal: [cos, sin].map(|part| (part.to_bits() >> 2) as i32),
            count,
            points,
            friction: if kind >= 192 { Fx::ZERO } else { self.size(-16, 6) },
            restitution: self.signed(-8, 0).max(Fx::ZERO),
            rolling_resistance: if self.below(4) == 0 { self.signed(-8, 0).max(Fx::ZERO) } else { Fx::ZERO },
            rolling_radius: if count == 1 { self.size(-7, 12) } else { Fx::ZERO },
            surface_speed: if self.below(4) == 0 { self.signed(-20, 20) } else { Fx::ZERO },
            impulses,
        }
    }
}

/// A body with its velocity at the start of a step, and the change of that by its free flight.
#[derive(Clone, Debug)]
pub struct Body {
    position: Vec2,
    velocity: Velocity,
    change: Velocity,
    pub mass: Fx,
    pub inverse_mass: Vec2<FxFactor>,
    inverse_inertia: FxFactor,
    radius: Fx,
}

#[derive(Clone, Debug)]
pub struct Scene {
    time_step: TimeStep,
    options: SolverOptions,
    pub bodies: Vec<Body>,
    pub contacts: Vec<Contact>,
}

/// The results of a step.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    pub impulses: Vec<Impulses>,
    pub corrections: Vec<Correction>,
    pub counts: SolverCounts,
}

/// A sum within ±limit.
fn within(parts: [Fx; 2], limit: Fx) -> Fx {
    let limit = i128::from(limit.to_bits());
    let sum: i128 = parts.iter().map(|part| i128::from(part.to_bits())).sum();
    Fx::from_bits(sum.clamp(-limit, limit) as i64)
}

fn both(a: Vec2, b: Vec2, limit: Fx) -> Vec2 {
    Vec2::new(within([a.x, b.x], limit), within([a.y, b.y], limit))
}

impl Body {
    fn flight(&self, time_step: TimeStep) -> Flight {
        let (start, change) = (self.velocity, self.change);
        let end = Velocity {
            linear: both(start.linear, change.linear, SPEED),
            angular: within([start.angular, change.angular], SPEED),
        };
        // At the mean velocity, rounded towards zero.
        let (num, den) = time_step.seconds();
        let moved = |a: Fx, b: Fx| {
            let sum = i128::from(a.to_bits()) + i128::from(b.to_bits());
            Fx::from_bits((sum * i128::from(num) / (2 * i128::from(den))) as i64)
        };
        let displacement = Vec2::new(moved(start.linear.x, end.linear.x), moved(start.linear.y, end.linear.y));
        Flight {
            position: self.position,
            start,
            end,
            displacement,
            rotation: moved(start.angular, end.angular),
            mass: self.mass,
            inverse_mass: self.inverse_mass,
            inverse_inertia: self.inverse_inertia,
            radius: self.radius,
            leader: None,
        }
    }

    pub fn is_fixed(&self) -> bool {
        [self.inverse_mass.x, self.inverse_mass.y, self.inverse_inertia].iter().all(|factor| factor.is_zero())
    }
}

impl Scene {
    pub fn flights(&self) -> Vec<Flight> {
        self.bodies.iter().map(|body| body.flight(self.time_step)).collect()
    }

    pub fn solve(&self) -> Solution {
        self.solve_seen(&self.flights(), self.contacts.clone())
    }

    /// Solves other flights and contacts by the same settings.
    pub fn solve_seen(&self, flights: &[Flight], mut contacts: Vec<Contact>) -> Solution {
        let (mut solver, mut corrections) = (Solver::default(), Vec::new());
        let counts = solver.solve(self.time_step, &self.options, flights, &mut [], &mut contacts, &mut corrections);
        Solution { impulses: contacts.iter().map(|contact| contact.impulses).collect(), corrections, counts }
    }

    /// Goes on to the next step.
    pub fn advance(&mut self, solution: &Solution) {
        let flights = self.flights();
        for ((body, correction), flight) in self.bodies.iter_mut().zip(&solution.corrections).zip(&flights) {
            let end = flight.end;
            body.velocity = Velocity {
                linear: both(end.linear, correction.velocity.map(FxAccumulator::value), SPEED),
                angular: within([end.angular, correction.angular_velocity.value()], SPEED),
            };
            let displacement = both(flight.displacement, correction.displacement.map(FxAccumulator::value), POSITION);
            body.position = both(body.position, displacement, POSITION);
        }
        for (contact, impulses) in self.contacts.iter_mut().zip(&solution.impulses) {
            contact.impulses = *impulses;
            let [nx, ny] = contact.normal.map(i128::from);
            for point in &mut contact.points[..contact.count] {
                let mut moved = 0;
                for (side, sign) in [-1, 1].into_iter().enumerate() {
                    let body = contact.bodies[side] as usize;
                    let (flight, correction) = (&flights[body], &solution.corrections[body]);
                    let [x, y, angle, rx, ry] = [
                        within([flight.displacement.x, correction.displacement.x.value()], POSITION),
                        within([flight.displacement.y, correction.displacement.y.value()], POSITION),
                        within([flight.rotation, correction.rotation.value()], SPEED),
                        point.arms[side].x,
                        point.arms[side].y,
                    ]
                    .map(|part| i128::from(part.to_bits()));
                    moved += sign * ((nx * x + ny * y) >> 30);
                    moved += sign * ((((rx * ny - ry * nx) >> 30) * angle) >> 32);
                }
                let limit = fx!(16_384).to_bits();
                let separation = i128::from(point.separation.to_bits()) + moved;
                point.separation = Fx::from_bits(separation.clamp((-limit).into(), limit.into()) as i64);
            }
        }
    }
}
