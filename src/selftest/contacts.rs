//! Contacts. No world has them yet: free flight, narrow phase and solver are joined here, as a step will join them.

use alloc::vec::Vec;

use super::trial::{Numbers, Played, Trial, happened, near, same};
use crate::codec::Write as _;
use crate::collide::{Cores, Manifold, Pose, radius_bound};
use crate::error::Error;
use crate::fx::{Fx, fx};
use crate::math::{TimeStep, Vec2, vec2};
use crate::scalar::{Accumulator as _, Angle as _, FxAccumulator, FxFactor, Turn};
use crate::shape::Shape;
use crate::solve::{Contact, Correction, Flight, Impulses, Point, Solver, SolverOptions, Velocity};

/// Steps a second, a power of two.
const RATE: i64 = 64;

/// Shapes have a manifold from this distance on, and from what they close in the step.
const MARGIN: Fx = fx!(0.02);

/// A body. No impulse moves it if its mass is zero.
struct Body {
    shape: Shape,
    /// Whole kg.
    mass: i32,
    position: Vec2<FxAccumulator>,
    velocity: Vec2<FxAccumulator>,
    angle: Turn,
    angular_velocity: FxAccumulator,
}

fn sum(a: Vec2<FxAccumulator>, b: Vec2<FxAccumulator>) -> Vec2<FxAccumulator> {
    Vec2::new(a.x.plus(b.x), a.y.plus(b.y))
}

/// The displacement of a step at a velocity, or half of it at twice the velocity: rounded towards zero, which is odd.
fn in_a_step(velocity: FxAccumulator) -> FxAccumulator {
    FxAccumulator::from_bits(velocity.to_bits() / i128::from(RATE))
}

/// 1/f; zero, for what cannot be moved, if f is zero.
fn inverse(factor: FxFactor) -> FxFactor {
    if factor.is_zero() { factor } else { FxFactor::ONE.over(factor) }
}

impl Body {
    /// A body at rest.
    fn new(shape: Shape, mass: i32, position: Vec2) -> Self {
        Self {
            shape,
            mass,
            position: position.map(FxAccumulator::from_scalar),
            velocity: Vec2::default(),
            angle: Turn::default(),
            angular_velocity: FxAccumulator::default(),
        }
    }

    /// The image of the body in the mirror x → −x. *Domain* the shape is its own image.
    fn mirrored(&self) -> Self {
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

    /// All that a step changes.
    fn bits(&self) -> (Vec2<FxAccumulator>, Vec2<FxAccumulator>, Turn, FxAccumulator) {
        (self.position, self.velocity, self.angle, self.angular_velocity)
    }

    fn is_fixed(&self) -> bool {
        self.mass == 0
    }

    fn pose(&self) -> Pose {
        Pose::new(self.position.map(FxAccumulator::value), self.angle)
    }

    fn public_velocity(&self) -> Velocity {
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
            inertia,
            inverse_mass: Vec2::new(inverse(mass), inverse(mass)),
            inverse_inertia: inverse(inertia),
            radius: radius_bound(&self.shape.outlines()[0]),
        }
    }

    fn correct(&mut self, by: &Correction) {
        self.velocity = sum(self.velocity, by.velocity);
        self.position = sum(self.position, by.displacement);
        self.angular_velocity = self.angular_velocity.plus(by.angular_velocity);
        self.angle = self.angle.turned(by.rotation);
    }
}

/// A contact, and the features of its points.
type Touch = (Contact, [u32; 2]);

/// Bodies and their contacts. Bodies of one scene have the same friction and restitution.
struct Bodies {
    gravity: Fx,
    friction: Fx,
    restitution: Fx,
    /// Fixed bodies come first.
    bodies: Vec<Body>,
    cores: Cores,
    solver: Solver,
    /// Those of the last step, sorted by bodies.
    touches: Vec<Touch>,
    corrections: Vec<Correction>,
    /// The number of values that the solver cut off in all steps.
    cut: u64,
}

impl Bodies {
    fn new(gravity: Fx, friction: Fx, restitution: Fx) -> Self {
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
    fn push_with_image(&mut self, body: Body) {
        let image = body.mirrored();
        self.bodies.extend([body, image]);
    }

    /// Makes a step and takes down the bits of all bodies and impulses.
    fn step(&mut self, trial: &mut Trial) {
        self.cores.clear();
        for body in &self.bodies {
            self.cores.push(&body.shape.outlines()[0], &body.pose());
        }
        let flights: Vec<Flight> = self.bodies.iter_mut().map(|body| body.fly(self.gravity)).collect();
        let (mut contacts, features): (Vec<Contact>, Vec<_>) = self.collide(&flights).into_iter().unzip();
        let (time_step, options) = (TimeStep::hz(RATE as u32), SolverOptions::default());
        let counts = self.solver.solve(time_step, &options, &flights, &mut [], &mut contacts, &mut self.corrections);
        self.cut += counts.cut;
        self.bodies.iter_mut().zip(&self.corrections).for_each(|(body, by)| body.correct(by));
        let digest = trial.tick();
        for body in &self.bodies {
            body.position.write(digest);
            body.velocity.write(digest);
            body.angle.write(digest);
            body.angular_velocity.write(digest);
        }
        for Contact { bodies, impulses, .. } in &contacts {
            bodies.iter().for_each(|body| body.write(digest));
            impulses.values.iter().for_each(|&value| (value as u64).write(digest));
            (impulses.exponent as u32).write(digest);
        }
        self.touches = contacts.into_iter().zip(features).collect();
    }

    /// The contacts at the start poses.
    fn collide(&self, flights: &[Flight]) -> Vec<Touch> {
        let mut found = Vec::new();
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
                if let Some(manifold) = self.cores.collide(a, b, margin) {
                    found.push(self.touch([a as u32, b as u32], &manifold));
                }
            }
        }
        found
    }

    /// A contact that starts with the impulses of the step before where the same features met.
    fn touch(&self, bodies: [u32; 2], manifold: &Manifold) -> Touch {
        let features = manifold.points.map(|point| point.feature);
        let mut impulses = Impulses::default();
        if let Ok(at) = self.touches.binary_search_by_key(&bodies, |(old, _)| old.bodies) {
            let (old, old_features) = &self.touches[at];
            impulses.exponent = old.impulses.exponent;
            for (k, feature) in features.iter().enumerate().take(manifold.count) {
                if let Some(i) = old_features[..old.count].iter().position(|other| other == feature) {
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
            surface_speed: Fx::ZERO,
            impulses,
        };
        (contact, features)
    }

    /// The sum of m·Δv by the contacts of the last step, and the sum of |m·Δv|, along x and y, in 2^-96 N·s.
    fn momentum_gained(&self) -> ([i128; 2], i128) {
        let (mut total, mut moved) = ([0; 2], 0);
        for (body, by) in self.bodies.iter().zip(&self.corrections) {
            let gains = [by.velocity.x, by.velocity.y].map(|v| i128::from(body.mass) * v.to_bits());
            (0..2).for_each(|i| total[i] += gains[i]);
            moved += gains[0].abs() + gains[1].abs();
        }
        (total, moved)
    }

    /// The upward impulse by fixed bodies in the last sub-step, in 2^-64 N·s.
    fn support(&self) -> i128 {
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

/// A floor below y = 0, walls at x = ±3, and what falls between them. Bodies 2k + 1 and 2k + 2 are images of each other; the
/// floor and the last two are images of themselves.
fn pile_of_bodies() -> Result<Bodies, Error> {
    let mut pile = Bodies::new(fx!(-9.8125), fx!(0.5), fx!(0.25));
    pile.bodies.push(Body::new(Shape::rectangle(8, 1)?, 0, vec2(0, fx!(-0.5))));
    pile.push_with_image(Body::new(Shape::rectangle(1, 8)?, 0, vec2(fx!(3.5), 3)));
    let mut numbers = Numbers(40);
    for i in 0..14 {
        let shape = if i % 3 == 2 { Shape::circle(fx!(0.25))? } else { Shape::rectangle(fx!(0.625), fx!(0.5))? };
        let place = vec2(fx!(0.75) * (1 + i % 3) + numbers.fx(0) / 16, fx!(0.5) + fx!(0.625) * (i / 3));
        let mut body = Body::new(shape, 1 + i % 4, place);
        body.angle = Turn::from_radians(numbers.fx(0) / 8);
        body.velocity = Vec2::new(numbers.fx(0), Fx::ZERO).map(FxAccumulator::from_scalar);
        body.angular_velocity = FxAccumulator::from_scalar(numbers.fx(0));
        pile.push_with_image(body);
    }
    let wedge = Shape::polygon(&[vec2(fx!(-0.375), 0), vec2(fx!(0.375), 0), vec2(0, fx!(0.5))])?;
    pile.bodies.push(Body::new(wedge, 2, vec2(0, fx!(0.5))));
    pile.bodies.push(Body::new(Shape::circle(fx!(0.25))?, 1, vec2(0, 2)));
    Ok(pile)
}

pub(super) fn pile(trial: &mut Trial) -> Played {
    let mut pile = pile_of_bodies()?;
    let middle = pile.bodies.len() - 2;
    let (mut most_contacts, mut deepest) = (0, Fx::ZERO);
    for _ in 0..256 {
        pile.step(trial);
        for (i, body) in pile.bodies.iter().enumerate().skip(1) {
            let image = if i < middle { ((i - 1) ^ 1) + 1 } else { i };
            same("the pile and its mirror image", &pile.bodies[image].bits(), &body.mirrored().bits())?;
        }
        most_contacts = most_contacts.max(pile.touches.len());
        let points = pile.touches.iter().flat_map(|(contact, _)| &contact.points[..contact.count]);
        deepest = points.fold(deepest, |deepest, point| deepest.min(point.separation));
    }
    happened("bodies overlap by less than 2 cm", deepest > fx!(-0.02))?;
    let mut mass = 0;
    for body in &pile.bodies[3..] {
        let (Velocity { linear, angular }, position) =
            (body.public_velocity(), body.position.map(FxAccumulator::value));
        happened("rest", [linear.x, linear.y, angular].iter().all(|speed| speed.abs() < fx!(0.05)))?;
        happened("all on the floor and between the walls", position.y > Fx::ZERO && position.x.abs() < fx!(3))?;
        mass += i128::from(body.mass);
    }
    // At rest, what is fixed carries the weight: to 1 %, for what still creeps.
    let substeps = RATE * i64::from(SolverOptions::default().substeps);
    let weight = i128::from(-pile.gravity.to_bits()) * (mass << 32) / i128::from(substeps);
    near("upward impulse of floor and walls", pile.support(), weight, weight.unsigned_abs() / 100)?;
    happened("many contacts", most_contacts > 40 && pile.cut == 0)
}

pub(super) fn cluster(trial: &mut Trial) -> Played {
    let mut cluster = Bodies::new(Fx::ZERO, fx!(0.5), fx!(0.5));
    let mut numbers = Numbers(41);
    for i in 0..25 {
        let shape = if i % 2 == 0 { Shape::circle(fx!(0.375))? } else { Shape::rectangle(fx!(0.75), fx!(0.5))? };
        let place = vec2(i % 5 - 2, i / 5 - 2);
        let mut body = Body::new(shape, 1 + i % 3, place);
        // Towards the middle.
        body.velocity = (numbers.vec(0) - place * 2).map(FxAccumulator::from_scalar);
        body.angular_velocity = FxAccumulator::from_scalar(numbers.fx(1));
        cluster.bodies.push(body);
    }
    let masses: i128 = cluster.bodies.iter().map(|body| i128::from(body.mass)).sum();
    let (mut exchanged, mut most_contacts) = (0, 0);
    for _ in 0..120 {
        cluster.step(trial);
        let (gained, moved) = cluster.momentum_gained();
        // Impulses are equal and opposite. 1/m is rounded to 2^-63 of it, and Δv to 2^-96 m/s.
        let bound = ((moved >> 63) + masses).unsigned_abs();
        near("momentum along x", gained[0], 0, bound)?;
        near("momentum along y", gained[1], 0, bound)?;
        exchanged += moved >> 96;
        most_contacts = most_contacts.max(cluster.touches.len());
    }
    happened("momentum exchanged at many contacts", exchanged > 50 && most_contacts > 20 && cluster.cut == 0)
}
