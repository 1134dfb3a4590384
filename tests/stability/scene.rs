//! Point masses on springs and under their own gravity: as worlds, and weighed in doubles.

use umbra_physics::scalar::{Accumulator, Factor, ToF64};
use umbra_physics::{
    Attachment, BodyDef, End, FieldKind, Fx, Integrator, Mass, Scalar, SpringConstants, TimeStep, Vec2, World,
    WorldDef, fx,
};

#[derive(Clone, Debug)]
pub(crate) struct Scene {
    pub(crate) bodies: Vec<Ball>,
    pub(crate) springs: Vec<Spring>,
    pub(crate) gravity: Option<Gravity>,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Ball {
    pub(crate) mass: Fx,
    pub(crate) position: Vec2,
    pub(crate) velocity: Vec2,
}

/// From a body to another, or to the origin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spring {
    pub(crate) near: usize,
    pub(crate) far: Option<usize>,
    pub(crate) rest: Fx,
    pub(crate) stiffness: Fx,
}

/// All bodies attract one another.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gravity {
    /// G, m³/(kg·s²). Its product with each mass has to fit in 64 bits, or action is not reaction.
    pub(crate) constant: Fx,
    pub(crate) softening: Fx,
}

/// A body's position and velocity with the bits that are carried, as near as doubles come.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Seen {
    pub(crate) x: [f64; 2],
    pub(crate) v: [f64; 2],
}

/// A scene at one moment.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Weighed {
    pub(crate) energy: f64,
    /// Quantity that velocity Verlet conserves beside the energy, over h²: see [`Scene::weigh`].
    pub(crate) shadow: f64,
    pub(crate) angular_momentum: f64,
    /// Effect of errors of 1 in all public positions and velocities, independent of each other, on the energy and the
    /// angular momentum in a second, root mean square.
    pub(crate) energy_noise: f64,
    pub(crate) angular_noise: f64,
    /// The magnitudes of all forces, their components added up.
    pub(crate) pull: f64,
}

/// Bond on a body: to another, or to the origin.
#[derive(Clone, Copy)]
enum Bond {
    Spring { rest: f64, stiffness: f64 },
    Gravity { strength: f64, softening: f64 },
}

/// Energy and forces of all bonds.
struct Loads {
    potential: f64,
    pull: f64,
    /// On each body.
    force: Vec<[f64; 2]>,
    /// Change of the force in a second.
    change: Vec<[f64; 2]>,
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn times(a: [f64; 2], factor: f64) -> [f64; 2] {
    a.map(|a| a * factor)
}

fn plus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] + b[0], a[1] + b[1]]
}

impl Bond {
    /// Potential energy at the offset d, its slope, and the change of the slope while d changes by w.
    fn at(self, d: [f64; 2], w: [f64; 2]) -> (f64, [f64; 2], [f64; 2]) {
        let (along, square) = (dot(d, w), dot(d, d));
        match self {
            Self::Spring { rest, stiffness } => {
                // A spring of no length pulls nothing.
                let length = square.sqrt().max(f64::MIN_POSITIVE);
                let stretch = length - rest;
                let share = stiffness * stretch / length;
                let bend = stiffness * rest * along / length.powi(3);
                (stiffness * stretch * stretch / 2.0, times(d, share), plus(times(w, share), times(d, bend)))
            }
            Self::Gravity { strength, softening } => {
                let square = square + softening * softening;
                let share = strength / (square * square.sqrt());
                let bend = -3.0 * share * along / square;
                (-strength / square.sqrt(), times(d, share), plus(times(w, share), times(d, bend)))
            }
        }
    }
}

impl Scene {
    /// A mass on a spring of no length, tied to the origin: each axis an oscillator of ω² = stiffness / mass.
    pub(crate) fn oscillator(mass: Fx, stiffness: Fx, position: Vec2, velocity: Vec2) -> Self {
        let springs = vec![Spring { near: 0, far: None, rest: fx!(0), stiffness }];
        Self { bodies: vec![Ball { mass, position, velocity }], springs, gravity: None }
    }

    /// Two bodies about their common centre of mass, `apart` from each other and moving across with `speed` relative to
    /// each other. Nothing joins them so far.
    pub(crate) fn pair(masses: [Fx; 2], apart: Fx, speed: Fx) -> Self {
        let share = masses[0] / (masses[0] + masses[1]);
        let ball = |mass, x, v| Ball { mass, position: Vec2::new(x, Fx::ZERO), velocity: Vec2::new(Fx::ZERO, v) };
        let (x, v) = (apart * share, speed * share);
        Self {
            bodies: vec![ball(masses[0], x - apart, v - speed), ball(masses[1], x, v)],
            springs: vec![],
            gravity: None,
        }
    }

    /// A net of n by n bodies, of one mass and the other in turn, with springs of 1 m between neighbours, stretched,
    /// that turns and drifts.
    pub(crate) fn net(n: usize, masses: [Fx; 2]) -> Self {
        let mut scene = Self { bodies: vec![], springs: vec![], gravity: None };
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            let (x, y) = (Fx::from(j as i32) * fx!(1.2), Fx::from(i as i32) * fx!(0.9));
            let velocity = Vec2::new(fx!(0.3) - y * fx!(0.4), x * fx!(0.5));
            scene.bodies.push(Ball { mass: masses[(i + j) % 2], position: Vec2::new(x, y), velocity });
            let near = i * n + j;
            let neighbours = [(j > 0).then(|| near - 1), (i > 0).then(|| near - n)];
            for far in neighbours.into_iter().flatten() {
                scene.springs.push(Spring { near, far: Some(far), rest: fx!(1), stiffness: fx!(100) });
            }
        }
        scene
    }

    /// The scene in a world where nothing sleeps.
    pub(crate) fn world<S: Scalar>(&self, rate: u32, integrator: Integrator) -> World<S> {
        let def = WorldDef { time_step: TimeStep::hz(rate), integrator, sleep_after: None, ..WorldDef::default() };
        let mut world = World::<S>::with_scalar(def).expect("a fair definition");
        let vector = |v: Vec2| v.map(S::from_fx);
        let centres = self.bodies.iter().map(|ball| {
            let mass = Mass::Kilograms(S::from_fx(ball.mass));
            let (position, velocity) = (vector(ball.position), vector(ball.velocity));
            let body = world.add_body(BodyDef { mass, position, velocity, ..BodyDef::dynamic() });
            Attachment { body: body.expect("a fair body"), point: Vec2::ZERO }
        });
        let centres: Vec<_> = centres.collect();
        for law in self.custom_forces(&centres) {
            world.add_field(law).expect("a fair field");
        }
        world
    }

    fn custom_forces<S: Scalar>(&self, centres: &[Attachment<S>]) -> Vec<FieldKind<S>> {
        let factor = |value: Fx| S::Factor::from_scalar(S::from_fx(value));
        let springs = self.springs.iter().map(|spring| FieldKind::Spring {
            near: centres[spring.near],
            far: spring.far.map_or(End::World(Vec2::ZERO), |far| End::Body(centres[far])),
            spring: SpringConstants {
                rest: S::from_fx(spring.rest),
                stiffness: S::from_fx(spring.stiffness),
                damping: S::ZERO,
            },
        });
        let carriers = self.bodies.iter().zip(centres);
        let attractors = self.gravity.iter().flat_map(|gravity| {
            carriers.clone().map(|(ball, &carrier)| FieldKind::Attractor {
                centre: End::Body(carrier),
                mu: factor(gravity.constant).times(factor(ball.mass)),
                softening: S::from_fx(gravity.softening),
            })
        });
        springs.chain(attractors).collect()
    }

    fn bonds(&self) -> impl Iterator<Item = (usize, Option<usize>, Bond)> {
        let springs = self.springs.iter().map(|spring| {
            let [rest, stiffness] = [spring.rest, spring.stiffness].map(Fx::to_f64);
            (spring.near, spring.far, Bond::Spring { rest, stiffness })
        });
        let pairs = (0..self.bodies.len()).flat_map(|a| (0..a).map(move |b| (a, b)));
        let gravity = self.gravity.iter().flat_map(move |gravity| {
            pairs.clone().map(|(a, b)| {
                let masses = self.bodies[a].mass.to_f64() * self.bodies[b].mass.to_f64();
                let strength = gravity.constant.to_f64() * masses;
                (a, Some(b), Bond::Gravity { strength, softening: gravity.softening.to_f64() })
            })
        });
        springs.chain(gravity)
    }

    fn loads(&self, state: &[Seen]) -> Loads {
        let none = vec![[0.0; 2]; state.len()];
        let mut loads = Loads { potential: 0.0, pull: 0.0, force: none.clone(), change: none };
        for (near, far, bond) in self.bonds() {
            let end = far.map_or(Seen::default(), |far| state[far]);
            let offset = plus(end.x, times(state[near].x, -1.0));
            let (potential, slope, bend) = bond.at(offset, plus(end.v, times(state[near].v, -1.0)));
            loads.potential += potential;
            for (body, sign) in [(Some(near), 1.0), (far, -1.0)] {
                let Some(body) = body else { continue };
                loads.force[body] = plus(loads.force[body], times(slope, sign));
                loads.change[body] = plus(loads.change[body], times(bend, sign));
                loads.pull += slope[0].abs() + slope[1].abs();
            }
        }
        loads
    }

    /// Weighs the scene.
    ///
    /// Velocity Verlet at a time step h follows the exact solution of another energy, and therefore keeps it (Hairer,
    /// Lubich and Wanner, Acta Numerica 12, 399 (2003)): H + h²·(v·V″·v/12 − Σ |F|²/(24·m)) + O(h⁴).
    pub(crate) fn weigh(&self, state: &[Seen]) -> Weighed {
        let Loads { potential, pull, force, change } = self.loads(state);
        let mut sum = Weighed { energy: potential, pull, ..Weighed::default() };
        for (((ball, at), force), change) in self.bodies.iter().zip(state).zip(force).zip(change) {
            let mass = ball.mass.to_f64();
            let momentum = times(at.v, mass);
            sum.energy += dot(momentum, at.v) / 2.0;
            sum.angular_momentum += at.x[0] * momentum[1] - at.x[1] * momentum[0];
            // The force changes by −V″·v.
            sum.shadow -= dot(at.v, change) / 12.0 + dot(force, force) / (24.0 * mass);
            // Bodies drift by their public v, and F is that at the public x: with the errors of these dE/dt is F·δv +
            // V″v·δx.
            sum.energy_noise += dot(force, force) + dot(change, change);
            // Pairs pull along their public offset: dL/dt = δv × m·v + δx × F.
            sum.angular_noise += dot(momentum, momentum) + dot(force, force);
        }
        Weighed { energy_noise: sum.energy_noise.sqrt(), angular_noise: sum.angular_noise.sqrt(), ..sum }
    }
}

/// All bodies, in the order they were added.
pub(crate) fn look<S: Scalar<Accumulator: ToF64>>(world: &World<S>) -> Vec<Seen> {
    let doubles = |a: Vec2<S::Accumulator>| [a.x.to_f64(), a.y.to_f64()];
    world.bodies().map(|body| Seen { x: doubles(body.position_exact()), v: doubles(body.velocity_exact()) }).collect()
}

/// All bodies to the bit: x, y and their velocities.
pub(crate) fn bits(world: &World) -> Vec<[i128; 4]> {
    let body = |x: Vec2<_>, v: Vec2<_>| [x.x, x.y, v.x, v.y].map(Accumulator::to_bits);
    world.bodies().map(|b| body(b.position_exact(), b.velocity_exact())).collect()
}
