//! Random scenes of bodies, joints and contacts, for a single step.

use alloc::vec::Vec;

use super::world::{fx, inverse, vec2};
use crate::math::{Random, TimeStep, Vec2};
use crate::scalar::{FxFactor, Turn};
use crate::solve::joint::{Axis, AxisSpring};
use crate::solve::{Contact, Correction, Flight, Impulses, Joint, JointKind, Point, Solver, SolverOptions, Velocity};

/// A number from −1 to 1.
pub(super) fn signed(random: &mut Random) -> f64 {
    random.bits() as i64 as f64 / 2f64.powi(63)
}

/// A number from 0 to below `count`.
fn index(random: &mut Random, count: usize) -> usize {
    random.below(count as u64) as usize
}

#[derive(Clone, Debug)]
pub(super) struct Scene {
    pub(super) flights: Vec<Flight>,
    pub(super) joints: Vec<Joint>,
    pub(super) contacts: Vec<Contact>,
    pub(super) options: SolverOptions,
}

pub(super) const RATE: u32 = 60;

/// A body with accelerations of up to 20 m/s² and 20 rad/s².
fn flight(random: &mut Random, is_fixed: bool) -> Flight {
    let h = 1.0 / f64::from(RATE);
    let mut vector = |size: f64| [size * signed(random), size * signed(random), size * signed(random)];
    let (v, a, position) = (vector(3.0), vector(20.0), vector(2.0));
    let velocity = |t: f64| Velocity { linear: vec2([v[0] + a[0] * t, v[1] + a[1] * t]), angular: fx(v[2] + a[2] * t) };
    let displacement = |i: usize| (v[i] + a[i] * h / 2.0) * h;
    let mass = 2f64.powf(2.0 * signed(random));
    let inertia = mass * 0.2 * 2f64.powf(signed(random));
    let inverse_or_zero = |value: f64| if is_fixed { FxFactor::ZERO } else { inverse(value) };
    Flight {
        position: vec2([position[0], position[1]]),
        start: velocity(0.0),
        end: velocity(h),
        displacement: vec2([displacement(0), displacement(1)]),
        rotation: fx(displacement(2)),
        mass: fx(mass),
        inverse_mass: Vec2::new(inverse_or_zero(mass), inverse_or_zero(mass)),
        inverse_inertia: inverse_or_zero(inertia),
        radius: fx(0.75),
        leader: None,
    }
}

/// The impulses that a step begins with, if `is_warm`.
fn impulses(random: &mut Random, is_warm: bool) -> Impulses {
    let mut value = || (signed(random) * 2f64.powi(24)) as i64;
    if is_warm { Impulses { values: [value(), value(), 0], exponent: -30 } } else { Impulses::default() }
}

/// The laws of a planar joint: both with the same forces.
fn planar(random: &mut Random, ways: [f64; 2]) -> [Option<Axis>; 2] {
    let along = Axis { limits: None, friction: fx(0.0), ..axis(random, ways[0]) };
    let rest = fx(ways[1] + signed(random));
    let spring = along.spring.map(|spring| AxisSpring { rest, ..spring });
    let across = Axis { position: fx(ways[1]), motor_speed: fx(signed(random)), spring, ..along };
    [Some(along), Some(across)]
}

/// Limits, a motor, friction and a spring, each with one half of all seeds.
fn axis(random: &mut Random, position: f64) -> Axis {
    let mut any = || signed(random) > 0.0;
    let [has_limits, is_locked, has_motor, has_friction, has_spring] = [(); 5].map(|()| any());
    let mut value = |size: f64| size * signed(random);
    let middle = position + value(0.2);
    let size = if is_locked { 0.0 } else { value(0.2).abs() };
    let spring = AxisSpring {
        frequency: fx(value(6.0).abs()),
        damping_ratio: fx(value(2.0).abs()),
        rest: fx(value(0.5)),
        max_force: fx(if is_locked { 2.0 } else { 2000.0 }),
    };
    Axis {
        position: fx(position),
        limits: has_limits.then(|| [fx(middle - size), fx(middle + size)]),
        motor_speed: fx(value(5.0)),
        motor_force: fx(if has_motor { value(20.0).abs() } else { 0.0 }),
        friction: fx(if has_friction { value(2.0).abs() } else { 0.0 }),
        spring: has_spring.then_some(spring),
    }
}

impl Scene {
    /// Bodies, of which the first `fixed` are fixed and move, with joints whose errors are up to some centimetres.
    pub(super) fn random(random: &mut Random, [bodies, fixed]: [usize; 2], joints: usize, contacts: usize) -> Self {
        let flights: Vec<Flight> = (0..bodies).map(|i| flight(random, i < fixed)).collect();
        let mut scene = Self { flights, joints: Vec::new(), contacts: Vec::new(), options: SolverOptions::default() };
        scene.options.substeps = 1 + index(random, 8) as u32;
        for _ in 0..joints {
            let ends = scene.pair(random);
            let anchors = [(); 2].map(|()| vec2([0.5 * signed(random), 0.5 * signed(random)]));
            let is_warm = signed(random) > 0.0;
            let kind = JointKind::Distance { length: fx(1.0) };
            let mut joint = Joint {
                bodies: ends,
                anchors,
                kind,
                axis: None,
                slides: [None; 2],
                impulses: impulses(random, is_warm),
            };
            let [x, y] = joint.offset(&scene.flights).map(|c| c as f64 / 2f64.powi(32));
            if signed(random) > 0.0 {
                joint.kind = JointKind::Distance { length: fx(x.hypot(y) + 0.02 * signed(random)) };
                joint.impulses.values[1] = 0;
            } else {
                // The second body is moved to the joint: of several joints at a body only the last one nearly holds.
                joint.kind = JointKind::Revolute;
                let position = &mut scene.flights[ends[1] as usize].position;
                let shifted = |c: crate::fx::Fx, d: f64| fx(super::world::double(c) - d);
                *position = Vec2::new(
                    shifted(position.x, x + 0.02 * signed(random)),
                    shifted(position.y, y + 0.02 * signed(random)),
                );
            }
            scene.joints.push(joint);
        }
        for _ in 0..contacts {
            let ends = scene.pair(random);
            let angle = 3.0 * signed(random);
            let normal = [angle.cos(), angle.sin()].map(|c: f64| (c * 2f64.powi(30)).round() as i32);
            let mut arm = || vec2([0.5 * signed(random), 0.5 * signed(random)]);
            let points = [[arm(), arm()], [arm(), arm()]].map(|arms| Point { arms, separation: fx(-0.01) });
            let zero = fx(0.0);
            scene.contacts.push(Contact {
                bodies: ends,
                normal,
                count: 1 + index(random, 2),
                points,
                friction: fx(0.5),
                restitution: zero,
                rolling_resistance: zero,
                rolling_radius: zero,
                surface_speed: zero,
                impulses: Impulses { values: [1 << 20, 1 << 19, 0], exponent: -30 },
            });
        }
        scene
    }

    /// Two bodies that are not both fixed, and not the same.
    fn pair(&self, random: &mut Random) -> [u32; 2] {
        loop {
            let pair = [index(random, self.flights.len()), index(random, self.flights.len())];
            if pair[0] != pair[1] && pair.iter().any(|&body| !self.flights[body].is_fixed()) {
                return pair.map(|body| body as u32);
            }
        }
    }

    /// Gives the bodies masses and inertias from a millionth to a million times as large, locks some of them, and makes lengths from 2^-4
    /// to 2^4 times as long.
    pub(super) fn make_hard(&mut self, random: &mut Random) {
        for flight in self.flights.iter_mut().filter(|flight| !flight.is_fixed()) {
            let mut scaled = |factor: FxFactor| factor.times(inverse(2f64.powf(20.0 * signed(random))));
            flight.inverse_inertia = scaled(flight.inverse_inertia);
            flight.inverse_mass = flight.inverse_mass.map(|_| scaled(flight.inverse_mass.x));
            flight.inverse_mass.y = flight.inverse_mass.x;
            flight.mass = FxFactor::ONE.over(flight.inverse_mass.x).to_scalar().expect("a mass within the limits");
            match index(random, 8) {
                0 => flight.inverse_mass.x = FxFactor::ZERO,
                1 => flight.inverse_mass.y = FxFactor::ZERO,
                2 => flight.inverse_inertia = FxFactor::ZERO,
                3 => flight.inverse_mass = Vec2::new(FxFactor::ZERO, FxFactor::ZERO),
                _ => {}
            }
            flight.radius = fx(0.75 * 16f64.powf(signed(random)).max(1.0));
        }
    }

    /// Turns half of the joints into sliders, planar joints, gears, pulleys, and lines with laws of the distances.
    pub(super) fn add_slides(&mut self, random: &mut Random) {
        let flights = &mut self.flights;
        for joint in &mut self.joints {
            if signed(random) > 0.0 {
                continue;
            }
            let [x, y] = joint.offset(flights).map(|c| c as f64 / 2f64.powi(32));
            let position = match joint.kind {
                JointKind::Revolute if signed(random) > 0.7 => {
                    let teeth = [(); 2].map(|()| (30.0 * signed(random)) as i16 * 2 + 1);
                    let position = fx(0.1 * signed(random));
                    joint.kind = JointKind::Gear { teeth };
                    joint.axis = Some(Axis { position, limits: Some([fx(0.0); 2]), ..Axis::default() });
                    continue;
                }
                JointKind::Revolute => {
                    let angle = 3.0 * signed(random);
                    let is_planar = signed(random) > 0.0;
                    let turn = Turn::from_radians(fx(angle));
                    joint.kind =
                        if is_planar { JointKind::Planar { angle: turn } } else { JointKind::Slider { angle: turn } };
                    let radius = &mut flights[joint.bodies[0] as usize].radius;
                    *radius = (*radius).max(fx(2.0 * (x.hypot(y) + 1.0)));
                    let (sin, cos) = angle.sin_cos();
                    if is_planar {
                        joint.slides = planar(random, [x * cos + y * sin, y * cos - x * sin]);
                        continue;
                    }
                    x * cos + y * sin
                }
                _ if signed(random) > 0.3 => {
                    let mut ground = |k: usize| {
                        let Vec2 { x, y } = flights[joint.bodies[k] as usize].position;
                        Vec2::new(x + fx(3.0 * signed(random)), y + fx(3.0 * signed(random)))
                    };
                    let grounds = [ground(0), ground(1)];
                    let strands = [(); 2].map(|()| 1 + index(random, 3) as u8);
                    joint.kind = JointKind::Pulley { grounds, strands };
                    joint.ways(flights)[0].to_bits() as f64 / 2f64.powi(32)
                }
                _ => {
                    joint.kind = JointKind::Line;
                    x.hypot(y)
                }
            };
            let mut law = axis(random, position);
            if let (JointKind::Pulley { .. }, Some([lower, _])) = (joint.kind, &mut law.limits) {
                *lower -= fx(1.0);
            }
            joint.slides[0] = Some(law);
        }
    }

    /// Gives most joints of angles limits, a motor, friction and a spring, each in half of them.
    pub(super) fn add_axes(&mut self, random: &mut Random) {
        let has_angle = |joint: &&mut Joint| {
            matches!(joint.kind, JointKind::Revolute | JointKind::Slider { .. } | JointKind::Planar { .. })
        };
        for joint in self.joints.iter_mut().filter(has_angle) {
            let position = 0.5 * signed(random);
            joint.axis = Some(axis(random, position));
            if joint.impulses != Impulses::default() {
                joint.impulses.values[2] = (signed(random) * 2f64.powi(22)) as i64;
            }
        }
        // A body that cannot turn has at least the radius of the other one.
        let largest = self.flights.iter().map(|flight| flight.radius).max().unwrap_or_default();
        for flight in self.flights.iter_mut().filter(|flight| flight.inverse_inertia.is_zero()) {
            flight.radius = largest;
        }
    }

    /// The corrections, the impulses of joints, and the number of values that were cut off.
    pub(super) fn solve(&self) -> (Vec<Correction>, Vec<Impulses>, u64) {
        self.solve_by(&mut Solver::default())
    }

    /// [`solve`](Self::solve) by a solver with a past.
    pub(super) fn solve_by(&self, solver: &mut Solver) -> (Vec<Correction>, Vec<Impulses>, u64) {
        let mut corrections = Vec::new();
        let mut joints = self.joints.clone();
        let mut contacts = self.contacts.clone();
        let time_step = TimeStep::hz(RATE);
        let counts =
            solver.solve(time_step, &self.options, &self.flights, &mut joints, &mut contacts, &mut corrections);
        (corrections, joints.iter().map(|joint| joint.impulses).collect(), counts.cut)
    }
}
