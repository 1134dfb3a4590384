//! Bodies and their contacts. No world has them yet: free flight, narrow phase and solver are joined here, as a step will join them.

use alloc::vec::Vec;

use super::trial::Trial;
use crate::codec::Write as _;
use crate::collide::{Cores, Manifold, Pose, radius_bound};
use crate::fx::{Fx, fx};
use crate::math::{TimeStep, Vec2};
use crate::scalar::{Accumulator as _, Angle as _, FxAccumulator, FxFactor, Turn};
use crate::shape::Shape;
use crate::solve::{Contact, Correction, Flight, Impulses, Point, Solver, SolverOptions, Velocity};

/// Steps a second, a power of two.
pub(super) const RATE: i64 = 64;

/// Shapes have a manifold up to this distance, plus the way by which they close in the step.
const MARGIN: Fx = fx!(0.02);

/// A body. No impulse moves it if its mass is zero.
pub(super) struct Body {
    shape: Shape,
    /// Whole kg.
    pub(super) mass: i32,
    pub(super) position: Vec2<FxAccumulator>,
    velocity: Vec2<FxAccumulator>,
    pub(super) angle: Turn,
    angular_velocity: FxAccumulator,
}

fn sum(a: Vec2<FxAccumulator>, b: Vec2<FxAccumulator>) -> Vec2<FxAccumulator> {
    Vec2::new(a.x.plus(b.x), a.y.plus(b.y))
}

/// A quantity times the length of a step, rounded towards zero, which is odd: a velocity gives a displacement, an acceleration
/// a change of velocity.
fn in_a_step(velocity: FxAccumulator) -> FxAccumulator {
    FxAccumulator::from_bits(velocity.to_bits() / i128::from(RATE))
}

/// 1/f; zero, for what cannot be moved, if f is zero.
fn inverse(factor: FxFactor) -> FxFactor {
    if factor.is_zero() { factor } else { FxFactor::ONE.over(factor) }
}

impl Body {
    /// A body at rest.
    pub(super) fn new(shape: Shape, mass: i32, position: Vec2) -> Self {
        Self {
            shape,
            mass,
            position: position.map(FxAccumulator::from_scalar),
            velocity: Vec2::default(),
            angle: Turn::default(),
            angular_velocity: FxAccumulator::default(),
        }
    }

    /// Gives the body these velocities.
    pub(super) fn moving(mut self, velocity: Vec2, angular_velocity: Fx) -> Self {
        self.velocity = velocity.map(FxAccumulator::from_scalar);
        self.angular_velocity = FxAccumulator::from_scalar(angular_velocity);
        self
    }

    /// The image of the body in the mirror x → −x. *Domain* the shape is its own image.
    pub(super) fn mirrored(&self) -> Self {
        let mirrored = |v: Vec2<FxAccumulator>| Vec2::new(v.x.negated(), v.y);
        Self {
            shape: self.shape.clone(),
            mass: self.mass,
            position: mirrored(self.position),
            velocity: mirrored(self.velocity),
            angle: Turn::from_bits(self.angle.to_bits().wrapping_neg()),
            angular_velocity: self.angular_velocity.negated(),
        }
    }

    /// The quantities that a step changes.
    pub(super) fn bits(&self) -> (Vec2<FxAccumulator>, Vec2<FxAccumulator>, Turn, FxAccumulator) {
        (self.position, self.velocity, self.angle, self.angular_velocity)
    }

    fn is_fixed(&self) -> bool {
        self.mass == 0
    }

    fn pose(&self) -> Pose {
        Pose::new(self.position.map(FxAccumulator::value), self.angle)
    }

    pub(super) fn public_velocity(&self) -> Velocity {
        Velocity { linear: self.velocity.map(FxAccumulator::value), angular: self.angular_velocity.value() }
    }

    /// A step of velocity Verlet.
    fn fly(&mut self, gravity: Fx) -> Flight {
        let (position, start) = (self.position.map(FxAccumulator::value), self.public_velocity());
        let gravity = if self.is_fixed() { Fx::ZERO } else { gravity };
        let half_kick = Vec2::new(FxAccumulator::default(), in_a_step(FxAccumulator::from_scalar(gravity / 2)));
        self.velocity = sum(self.velocity, half_kick);
        let displacement = self.velocity.map(in_a_step);
        let rotation = in_a_step(self.angular_velocity);
        self.position = sum(self.position, displacement);
        self.angle = self.angle.turned(rotation);
        self.velocity = sum(self.velocity, half_kick);
        let mass = FxFactor::from_scalar(Fx::from_int(self.mass));
        let inertia = mass.times(self.shape.gyration());
        Flight {
            position,
            start,
            end: self.public_velocity(),
            displacement: displacement.map(FxAccumulator::value),
            rotation: rotation.value(),
            mass: Fx::from_int(self.mass),
            inverse_mass: Vec2::new(inverse(mass), inverse(mass)),
            inverse_inertia: inverse(inertia),
            radius: radius_bound(&self.shape.outlines()[0]),
            leader: None,
        }
    }

    fn correct(&mut self, correction: &Correction) {
        self.velocity = sum(self.velocity, correction.velocity);
        self.position = sum(self.position, correction.displacement);
        self.angular_velocity = self.angular_velocity.plus(correction.angular_velocity);
        self.angle = self.angle.turned(correction.rotation);
    }
}

/// A contact, and the features of its points.
pub(super) type Touch = (Contact, [u32; 2]);

/// Bodies and their contacts. Bodies of one scene have the same friction and restitution.
pub(super) struct Bodies {
    pub(super) gravity: Fx,
    friction: Fx,
    restitution: Fx,
    pub(super) bodies: Vec<Body>,
    cores: Cores,
    solver: Solver,
    /// The contacts of the last step, sorted by bodies.
    pub(super) touches: Vec<Touch>,
    corrections: Vec<Correction>,
    /// The number of values that the solver cut off in all steps.
    pub(super) cut: u64,
}

impl Bodies {
    pub(super) fn new(gravity: Fx, friction: Fx, restitution: Fx) -> Self {
        Self {
            gravity,
            friction,
            restitution,
            bodies: Vec::new(),
            cores: Cores::default(),
            solver: Solver::default(),
            touches: Vec::new(),
            corrections: Vec::new(),
            cut: 0,
        }
    }

    /// Adds a body and its image in the mirror.
    pub(super) fn push_with_image(&mut self, body: Body) {
        let image = body.mirrored();
        self.bodies.extend([body, image]);
    }

    /// Makes a step and writes the bits of all bodies and impulses to the digest.
    pub(super) fn step(&mut self, trial: &mut Trial) {
        self.step_alone();
        let digest = trial.tick();
        for body in &self.bodies {
            body.position.write(digest);
            body.velocity.write(digest);
            body.angle.write(digest);
            body.angular_velocity.write(digest);
        }
        for (Contact { bodies, impulses, .. }, _) in &self.touches {
            bodies.iter().for_each(|body| body.write(digest));
            impulses.values.iter().for_each(|&value| (value as u64).write(digest));
            (impulses.exponent as u32).write(digest);
        }
    }

    /// Makes a step of a twin.
    pub(super) fn step_alone(&mut self) {
        self.cores.clear();
        for body in &self.bodies {
            self.cores.push(&body.shape.outlines()[0], &body.pose());
        }
        let flights: Vec<Flight> = self.bodies.iter_mut().map(|body| body.fly(self.gravity)).collect();
        let (mut contacts, features): (Vec<Contact>, Vec<_>) = self.collide(&flights).into_iter().unzip();
        let time_step = TimeStep::hz(RATE as u32);
        let options = SolverOptions::default();
        let counts = self.solver.solve(time_step, &options, &flights, &mut [], &mut contacts, &mut self.corrections);
        self.cut += counts.cut;
        self.bodies.iter_mut().zip(&self.corrections).for_each(|(body, correction)| body.correct(correction));
        self.touches = contacts.into_iter().zip(features).collect();
    }

    /// The contacts at the start poses.
    fn collide(&self, flights: &[Flight]) -> Vec<Touch> {
        let mut touches = Vec::new();
        // No point of the body moves farther.
        let moved = |f: &Flight| f.displacement.x.abs() + f.displacement.y.abs() + f.rotation.abs() * f.radius;
        for (a, of_a) in flights.iter().enumerate() {
            for (b, of_b) in flights.iter().enumerate().skip(a + 1) {
                let margin = MARGIN + moved(of_a) + moved(of_b);
                let (offset, reach) = (of_b.position - of_a.position, of_a.radius + of_b.radius + margin);
                let is_far = offset.x.abs() > reach || offset.y.abs() > reach;
                if is_far || (self.bodies[a].is_fixed() && self.bodies[b].is_fixed()) {
                    continue;
                }
                if let Some(manifold) = self.cores.collide(a, b, margin.into()) {
                    touches.push(self.touch([a as u32, b as u32], &manifold));
                }
            }
        }
        touches
    }

    /// A contact that starts with the impulses of the step before where the same features met.
    fn touch(&self, bodies: [u32; 2], manifold: &Manifold) -> Touch {
        let features = manifold.points.map(|point| point.feature);
        let mut impulses = Impulses::default();
        if let Ok(at) = self.touches.binary_search_by_key(&bodies, |(old, _)| old.bodies) {
            let (old, old_features) = &self.touches[at];
            impulses.exponent = old.impulses.exponent;
            for (k, feature) in features.iter().enumerate().take(manifold.count) {
                if let Some(i) = old_features[..old.count].iter().position(|old_feature| old_feature == feature) {
                    impulses.values[k] = old.impulses.values[i];
                    impulses.values[2] = old.impulses.values[2];
                }
            }
        }
        let contact = Contact {
            bodies,
            normal: manifold.normal,
            count: manifold.count,
            points: manifold.points.map(|p| Point { arms: [p.arm_a, p.arm_b], separation: p.separation }),
            friction: self.friction,
            restitution: self.restitution,
            rolling_resistance: Fx::ZERO,
            rolling_radius: Fx::ZERO,
            surface_speed: Fx::ZERO,
            impulses,
        };
        (contact, features)
    }

    /// The sum of m·Δv by the contacts of the last step, and the sum of |m·Δv|, along x and y, in 2^-96 N·s.
    pub(super) fn momentum_gained(&self) -> ([i128; 2], i128) {
        let mut total = [0; 2];
        let mut moved = 0;
        for (body, correction) in self.bodies.iter().zip(&self.corrections) {
            let gains = [correction.velocity.x, correction.velocity.y].map(|v| i128::from(body.mass) * v.to_bits());
            (0..2).for_each(|i| total[i] += gains[i]);
            moved += gains[0].abs() + gains[1].abs();
        }
        (total, moved)
    }

    /// The upward impulse by fixed bodies in the last sub-step, in 2^-64 N·s. *Domain* fixed bodies come first.
    pub(super) fn support(&self) -> i128 {
        let upward = |contact: &Contact| {
            let [nx, ny] = contact.normal.map(i128::from);
            let [first, second, friction] = contact.impulses.values.map(i128::from);
            let up = ny * (first + second) - nx * friction;
            // From 2^(exponent − 30) to 2^-64 N·s, rounded down.
            let bits = contact.impulses.exponent + 64 - 30;
            if bits < 0 { up >> -bits } else { up << bits }
        };
        // A fixed body is the first of its contacts, so that their normals point away from it.
        let is_fixed = |contact: &&Contact| self.bodies[contact.bodies[0] as usize].is_fixed();
        self.touches.iter().map(|(contact, _)| contact).filter(is_fixed).map(upward).sum()
    }
}
