//! Scenes with a known solution: as worlds, and as differential equations in arbitrary precision.
//!
//! In each the fastest rate is about [`RATE`], lengths are about 1 m, and everything may be made larger by a power of two,
//! which leaves all as it was but for what is rounded: the difference between a scene and one 2^7 times as large or more
//! is what rounding adds.

use std::sync::{Arc, LazyLock};

use super::real::{Real, TAU, exact, ratio, real, units};
use umbra_physics::{
    Attachment, BodyDef, BodyId, BodyState, CustomForce, CustomForceError, Damping, Dependence, End, FieldKind,
    ForceTorque, Fx, FxAccumulator, FxFactor, Mass, SpringConstants, Vec2, World, WorldDef, fx, vec2,
};

/// The fastest rate of each problem, rad/s.
pub(crate) const RATE: f64 = 3.75;

/// A scene and its equations.
pub(crate) struct Problem {
    pub(crate) name: &'static str,
    /// Duration of the observation, in tenths of a second.
    pub(crate) tenths: u32,
    /// The scene in a world, all lengths times 2^scale.
    pub(crate) scene: fn(WorldDef, Scale) -> (World, Vec<BodyId>),
    /// The torque applied at each tick, N·m.
    pub(crate) torque: Option<Fx>,
    /// Magnified quantity, to see the rounding: lengths, or angles if nothing else moves.
    pub(crate) enlarged: Enlarged,
    /// d/dt of (x, y, v_x, v_y, angle, spin) of each body.
    pub(crate) slope: fn(&[Real]) -> Vec<Real>,
}

#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Enlarged {
    Lengths,
    Angles,
}

/// The power of two that lengths are enlarged by.
#[derive(Clone, Copy)]
pub(crate) struct Scale(pub(crate) u32);

impl Scale {
    pub(crate) fn of(self, value: Fx) -> Fx {
        Fx::from_bits(value.to_bits() << self.0)
    }

    fn vector(self, x: Fx, y: Fx) -> Vec2 {
        Vec2::new(self.of(x), self.of(y))
    }
}

/// A world with these bodies.
fn world(def: WorldDef, bodies: impl IntoIterator<Item = BodyDef>) -> (World, Vec<BodyId>) {
    let mut world = World::new(def).expect("a fair definition");
    let bodies = bodies.into_iter().map(|body| world.add_body(body).expect("a fair body")).collect();
    (world, bodies)
}

fn with_field(mut scene: (World, Vec<BodyId>), law: impl Fn(&[BodyId]) -> FieldKind) -> (World, Vec<BodyId>) {
    let law = law(&scene.1);
    scene.0.add_field(law).expect("a fair field");
    scene
}

/// The state of bodies that do not turn, from accelerations and velocities.
fn moving(state: &[Real], acceleration: [Real; 2]) -> Vec<Real> {
    let [x, y] = acceleration;
    vec![state[2].clone(), state[3].clone(), x, y, real(0), real(0)]
}

fn square(x: &Real) -> Real {
    x * x
}

fn length(x: &Real, y: &Real) -> Real {
    (square(x) + square(y)).sqrt()
}

const MASS: Fx = fx!(2);
const GRAVITY: Fx = fx!(-9.81);
const LINEAR: Fx = fx!(2);
const QUADRATIC: Fx = fx!(0.0029296875);
const WIND: (Fx, Fx) = (fx!(30), fx!(10));

/// Gravity, linear and quadratic drag, and a wind: a shell at 1,000 m/s.
pub(crate) const FALL: Problem = Problem {
    name: "fall with drag and wind",
    tenths: 20,
    scene: |def, scale| {
        let def = WorldDef { gravity: scale.vector(fx!(0), GRAVITY), ..def };
        let body =
            BodyDef { mass: Mass::Kilograms(MASS), velocity: scale.vector(fx!(800), fx!(600)), ..BodyDef::dynamic() };
        let quadratic = Fx::from_bits(QUADRATIC.to_bits() >> scale.0);
        let wind = scale.vector(WIND.0, WIND.1);
        with_field(world(def, [body]), |_| FieldKind::Drag { linear: LINEAR, quadratic, wind })
    },
    torque: None,
    enlarged: Enlarged::Lengths,
    slope: |state| {
        let u = [&state[2] - exact(WIND.0), &state[3] - exact(WIND.1)];
        let share = (exact(LINEAR) + exact(QUADRATIC) * length(&u[0], &u[1])) / exact(MASS);
        moving(state, [-(&share * &u[0]), exact(GRAVITY) - &share * &u[1]])
    },
};

/// ω² = 14.0625 for 1 kg.
const STIFFNESS: Fx = fx!(14.0625);

/// On a spring of no length at the origin, on an ellipse that keeps away from it.
fn tied(def: WorldDef, scale: Scale, damping: Fx) -> (World, Vec<BodyId>) {
    let (position, velocity) = (scale.vector(fx!(1), fx!(0.25)), scale.vector(fx!(-0.5), fx!(2)));
    let body = BodyDef { position, velocity, ..BodyDef::dynamic() };
    with_field(world(def, [body]), |bodies| FieldKind::Spring {
        near: Attachment::centre(bodies[0]),
        far: End::World(vec2(0, 0)),
        spring: SpringConstants { rest: fx!(0), stiffness: STIFFNESS, damping },
    })
}

/// A harmonic oscillator in both axes.
pub(crate) const OSCILLATOR: Problem = Problem {
    name: "oscillator",
    tenths: 20,
    scene: |def, scale| tied(def, scale, fx!(0)),
    torque: None,
    enlarged: Enlarged::Lengths,
    slope: |state| moving(state, [-(exact(STIFFNESS) * &state[0]), -(exact(STIFFNESS) * &state[1])]),
};

/// Fraction of the oscillator's velocity left after a second.
pub(crate) const KEPT: Fx = fx!(0.75);

/// The oscillator with the exponential damping of the world.
pub(crate) const DAMPED_OSCILLATOR: Problem = Problem {
    name: "damped oscillator",
    scene: |def, scale| tied(WorldDef { linear_damping: Damping::kept_per_second(KEPT), ..def }, scale, fx!(0)),
    slope: |state| {
        static LOG: LazyLock<Real> = LazyLock::new(|| exact(KEPT).ln());
        let component = |i: usize| &*LOG * &state[i + 2] - exact(STIFFNESS) * &state[i];
        moving(state, [component(0), component(1)])
    },
    ..OSCILLATOR
};

const DAMPER: Fx = fx!(0.75);

/// The oscillator with a damper along its spring.
pub(crate) const SPRING_DAMPER: Problem = Problem {
    name: "spring with a damper",
    scene: |def, scale| tied(def, scale, DAMPER),
    slope: |state| {
        // The rate of the length over the length.
        let rate = (&state[0] * &state[2] + &state[1] * &state[3]) / (square(&state[0]) + square(&state[1]));
        let share = exact(STIFFNESS) + exact(DAMPER) * rate;
        moving(state, [-(&share * &state[0]), -(&share * &state[1])])
    },
    ..OSCILLATOR
};

/// A force of the velocity, by the hook: across it, as on a charge in a magnetic field, N·s/m.
struct Across(Fx);

impl CustomForce for Across {
    fn id(&self) -> u64 {
        1
    }

    fn version(&self) -> u32 {
        1
    }

    fn depends_on(&self) -> Dependence {
        Dependence::Velocity
    }

    fn push(&self, body: &BodyState) -> Result<ForceTorque, CustomForceError> {
        let fault = CustomForceError { code: 0 };
        let force = body.velocity.perp().checked_scale(self.0).ok_or(fault)?;
        Ok(ForceTorque { force, torque: Fx::ZERO })
    }
}

const ACROSS: Fx = fx!(1.5);

/// The oscillator, turned by a force across its velocity.
pub(crate) const TURNED: Problem = Problem {
    name: "law of velocity by the hook",
    scene: |def, scale| {
        let (mut world, bodies) = tied(def, scale, fx!(0));
        world.register_custom_force(Arc::new(Across(ACROSS))).expect("the first of its id");
        world.add_field(FieldKind::Custom { id: 1 }).expect("a registered law");
        (world, bodies)
    },
    slope: |state| {
        let across = exact(ACROSS);
        let x = -(&across * &state[3]) - exact(STIFFNESS) * &state[0];
        let y = across * &state[2] - exact(STIFFNESS) * &state[1];
        moving(state, [x, y])
    },
    ..OSCILLATOR
};

/// About an attractor at the origin.
fn orbit(def: WorldDef, scale: Scale, mu: Fx, from: Fx, speed: Fx) -> (World, Vec<BodyId>) {
    let body =
        BodyDef { position: scale.vector(from, fx!(0)), velocity: scale.vector(fx!(0), speed), ..BodyDef::dynamic() };
    // m³/s² grow with the cube of lengths.
    let larger = FxFactor::from_ratio(1 << scale.0, 1);
    let mu = larger.times(larger).times(larger).times(FxFactor::from_scalar(mu));
    let centre = End::World(vec2(0, 0));
    with_field(world(def, [body]), |_| FieldKind::Attractor { centre, mu, softening: fx!(0) })
}

fn attracted(state: &[Real], mu: Fx) -> Vec<Real> {
    let squares = square(&state[0]) + square(&state[1]);
    let share = exact(mu) / (&squares * squares.sqrt());
    moving(state, [-(&share * &state[0]), -(&share * &state[1])])
}

/// A circle, but for the rounding of the start.
pub(crate) const CIRCLE: Problem = Problem {
    name: "Kepler, e = 0",
    tenths: 20,
    scene: |def, scale| orbit(def, scale, fx!(14.0625), fx!(1), fx!(3.75)),
    torque: None,
    enlarged: Enlarged::Lengths,
    slope: |state| attracted(state, fx!(14.0625)),
};

/// From the nearest point of an ellipse with the half axis 1 m: there it turns five times as fast as on average.
pub(crate) const ELLIPSE: Problem = Problem {
    name: "Kepler, e = 0.6",
    tenths: 80,
    scene: |def, scale| orbit(def, scale, fx!(0.5625), fx!(0.4), fx!(1.5)),
    slope: |state| attracted(state, fx!(0.5625)),
    ..CIRCLE
};

const TORQUE: Fx = fx!(20);
const INERTIA: Fx = fx!(0.5);
/// Fraction of the spin left after a second.
pub(crate) const SPIN_KEPT: Fx = fx!(0.0235);

/// A constant torque against angular damping.
pub(crate) const SPUN_UP: Problem = Problem {
    name: "spin under torque and damping",
    tenths: 10,
    scene: |def, scale| {
        let def = WorldDef { angular_damping: Damping::kept_per_second(SPIN_KEPT), ..def };
        let mass = Mass::Explicit { mass: fx!(1), inertia: INERTIA };
        world(def, [BodyDef { mass, angular_velocity: scale.of(fx!(3)), ..BodyDef::dynamic() }])
    },
    torque: Some(TORQUE),
    enlarged: Enlarged::Angles,
    slope: |state| {
        static LOG: LazyLock<Real> = LazyLock::new(|| exact(SPIN_KEPT).ln());
        let spin = exact(TORQUE) / exact(INERTIA) + &*LOG * &state[5];
        vec![real(0), real(0), real(0), real(0), state[5].clone(), spin]
    },
};

const OFF_CENTRE: (Fx, Fx) = (fx!(0.5), fx!(0.125));
const ANCHOR: (Fx, Fx) = (fx!(4), fx!(0.25));
const OFF_CENTRE_STIFFNESS: Fx = fx!(6.5);
const OFF_CENTRE_REST: Fx = fx!(2.5);
const OFF_CENTRE_INERTIA: Fx = fx!(0.25);

/// Pulled at a point off its centre of mass: the torque depends on the angle.
pub(crate) const PULLED_ROUND: Problem = Problem {
    name: "spin under the torque of a spring",
    tenths: 20,
    scene: |def, scale| {
        // kg·m² grow with the square of lengths.
        let inertia = scale.of(scale.of(OFF_CENTRE_INERTIA));
        let body = BodyDef {
            mass: Mass::Explicit { mass: fx!(1), inertia },
            velocity: scale.vector(fx!(0), fx!(0.5)),
            angle: fx!(0.75),
            angular_velocity: fx!(1.5),
            ..BodyDef::dynamic()
        };
        with_field(world(def, [body]), |bodies| FieldKind::Spring {
            near: Attachment { body: bodies[0], point: scale.vector(OFF_CENTRE.0, OFF_CENTRE.1) },
            far: End::World(scale.vector(ANCHOR.0, ANCHOR.1)),
            spring: SpringConstants {
                rest: scale.of(OFF_CENTRE_REST),
                stiffness: OFF_CENTRE_STIFFNESS,
                damping: fx!(0),
            },
        })
    },
    torque: None,
    enlarged: Enlarged::Lengths,
    slope: |state| {
        let (sin, cos) = state[4].sin_cos();
        let (px, py) = (exact(OFF_CENTRE.0), exact(OFF_CENTRE.1));
        let arm = [&cos * &px - &sin * &py, sin * px + cos * py];
        let to = [exact(ANCHOR.0) - &state[0] - &arm[0], exact(ANCHOR.1) - &state[1] - &arm[1]];
        let share = exact(OFF_CENTRE_STIFFNESS) * (real(1) - exact(OFF_CENTRE_REST) / length(&to[0], &to[1]));
        let force = [&share * &to[0], &share * &to[1]];
        let torque = &arm[0] * &force[1] - &arm[1] * &force[0];
        let [x, y] = force;
        vec![state[2].clone(), state[3].clone(), x, y, state[5].clone(), torque / exact(OFF_CENTRE_INERTIA)]
    },
};

const PAIR_STIFFNESS: Fx = fx!(10.5);
const PAIR_REST: Fx = fx!(2);
const HEAVIER: Fx = fx!(3);

/// Two bodies of 1 and 3 kg that turn about each other and drift along.
pub(crate) const PAIR: Problem = Problem {
    name: "two bodies on a spring",
    tenths: 30,
    scene: |def, scale| {
        let light = BodyDef {
            position: scale.vector(fx!(1.25), fx!(0.5)),
            velocity: scale.vector(fx!(0.5), fx!(1)),
            ..BodyDef::dynamic()
        };
        let heavy =
            BodyDef { mass: Mass::Kilograms(HEAVIER), velocity: scale.vector(fx!(0.25), fx!(0)), ..BodyDef::dynamic() };
        with_field(world(def, [light, heavy]), |bodies| FieldKind::Spring {
            near: Attachment::centre(bodies[0]),
            far: End::Body(Attachment::centre(bodies[1])),
            spring: SpringConstants { rest: scale.of(PAIR_REST), stiffness: PAIR_STIFFNESS, damping: fx!(0) },
        })
    },
    torque: None,
    enlarged: Enlarged::Lengths,
    slope: |state| {
        let (light, heavy) = state.split_at(6);
        let to = [&heavy[0] - &light[0], &heavy[1] - &light[1]];
        let share = exact(PAIR_STIFFNESS) * (real(1) - exact(PAIR_REST) / length(&to[0], &to[1]));
        let force = [&share * &to[0], &share * &to[1]];
        let back = [-&force[0] / exact(HEAVIER), -&force[1] / exact(HEAVIER)];
        [moving(light, force), moving(heavy, back)].concat()
    },
};

/// Problems with forces of position, drag and damping, in which every integrator has its order.
pub(crate) const PROBLEMS: [Problem; 8] =
    [FALL, OSCILLATOR, DAMPED_OSCILLATOR, CIRCLE, ELLIPSE, SPUN_UP, PULLED_ROUND, PAIR];

/// The exact state of bodies: (x, y, v_x, v_y, angle, spin) of each.
pub(crate) fn state(world: &World, bodies: &[BodyId]) -> Vec<Real> {
    let coordinates = |&body: &BodyId| {
        let body = world.body(body).expect("it is there");
        let (x, v) = (body.position_exact(), body.velocity_exact());
        let [x, y, vx, vy, spin] =
            [x.x, x.y, v.x, v.y, body.angular_velocity_exact()].map(|a| units(FxAccumulator::to_bits(a), 96));
        [x, y, vx, vy, units(body.angle_exact().to_bits(), 64) * &*TAU, spin]
    };
    bodies.iter().flat_map(coordinates).collect()
}

fn plus(state: &[Real], slope: &[Real], times: &Real) -> Vec<Real> {
    state.iter().zip(slope).map(|(y, f)| y + f * times).collect()
}

/// The solution by extrapolation of the modified midpoint rule (Gragg 1965, Bulirsch and Stoer 1966) to order 18, so many
/// steps a second: for problems of about 4 rad/s, 20 of them leave some 1e-25.
pub(crate) fn solve(
    slope: fn(&[Real]) -> Vec<Real>,
    start: Vec<Real>,
    tenths: u32,
    steps_per_second: i64,
) -> Vec<Real> {
    const COLUMNS: usize = 9;
    let step = ratio(1, steps_per_second);
    let mut state = start;
    for _ in 0..i64::from(tenths) * steps_per_second / 10 {
        let mut row: Vec<Vec<Real>> = Vec::new();
        let first = slope(&state);
        for k in 1..=COLUMNS {
            let h = &step / real(2 * k as i64);
            let twice = &h * real(2);
            let (mut before, mut now) = (state.clone(), plus(&state, &first, &h));
            for _ in 1..2 * k {
                let next = plus(&before, &slope(&now), &twice);
                (before, now) = (now, next);
            }
            let ahead = plus(&now, &slope(&now), &h);
            let mut entry: Vec<Real> = before.iter().zip(&ahead).map(|(a, b)| (a + b) * ratio(1, 2)).collect();
            // Aitken and Neville's table in h², row by row.
            for (j, above) in row.iter_mut().enumerate() {
                let step = (k - 1 - j) as i64;
                let weight = real(step * step) / real((k * k) as i64 - step * step);
                let better = entry.iter().zip(above.iter()).map(|(e, a)| e + (e - a) * &weight).collect();
                *above = core::mem::replace(&mut entry, better);
            }
            row.push(entry);
        }
        state = row.pop().expect("there are columns");
    }
    state
}
