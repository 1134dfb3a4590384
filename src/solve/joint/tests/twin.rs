//! A step of joints in doubles, in metres and seconds, written independently of the solver.

use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::TAU;

use super::scene::{RATE, Scene};
use super::world::{change, double, rotated};
use crate::cases::run_seed;
use crate::fx::Fx;
use crate::math::{Random, TimeStep, Vec2};
use crate::scalar::FxFactor;
use crate::solve::graph::PHASES;
use crate::solve::{JointKind, Solver};

fn pair(v: Vec2) -> [f64; 2] {
    [double(v.x), double(v.y)]
}

fn number(factor: FxFactor) -> f64 {
    let (mantissa, shift) = factor.parts();
    mantissa as f64 * 2f64.powi(-shift)
}

fn cross([ax, ay]: [f64; 2], [bx, by]: [f64; 2]) -> f64 {
    ax * by - ay * bx
}

fn dot([ax, ay]: [f64; 2], [bx, by]: [f64; 2]) -> f64 {
    ax * bx + ay * by
}

#[derive(Clone, Default)]
struct Body {
    /// Inverse mass and inertia.
    mass: f64,
    inertia: f64,
    at: [f64; 2],
    /// Velocities at the start and at the end of the free flight: linear and angular.
    start: [f64; 3],
    end: [f64; 3],
    /// The displacement without impulses: by the sub-steps if a fixed body holds its island, else by the free flight.
    flown: [f64; 3],
    /// The excess of `flown` over the displacement of the free flight.
    offset: [f64; 3],
    /// Corrections of the velocity, and of the displacement.
    velocity: [f64; 3],
    moved: [f64; 3],
    /// The true displacement so far.
    way: [f64; 3],
    /// The current velocity.
    now: [f64; 3],
}

struct Joint {
    ends: [usize; 2],
    anchors: [[f64; 2]; 2],
    length: Option<f64>,
    phase: usize,
    shares: [f64; 2],
    impulses: Vec<f64>,
    /// Arms, axes and errors where the bodies are now.
    arms: [[f64; 2]; 2],
    axes: Vec<[f64; 2]>,
    errors: Vec<f64>,
    distance: f64,
}

struct Twin {
    bodies: Vec<Body>,
    joints: Vec<Joint>,
    h: f64,
    n: usize,
    frequency: f64,
    damping: f64,
    /// The coarsest unit of velocity of an island of the scene, m/s.
    unit: f64,
}

/// Bodies that joints connect to a fixed body, directly or by way of others.
fn held(scene: &Scene) -> Vec<usize> {
    let mut is_held: Vec<bool> = scene.flights.iter().map(|flight| flight.is_fixed()).collect();
    for _ in &scene.flights {
        for joint in &scene.joints {
            let [a, b] = joint.bodies.map(|body| body as usize);
            (is_held[a], is_held[b]) = (is_held[a] || is_held[b], is_held[a] || is_held[b]);
        }
    }
    (0..scene.flights.len()).filter(|&body| is_held[body] && !scene.flights[body].is_fixed()).collect()
}

impl Twin {
    fn new(scene: &Scene) -> Self {
        // The phases are the solver's, which have tests of their own.
        let mut solver = Solver::default();
        solver.prepare(TimeStep::hz(RATE), &scene.options, &scene.flights, &scene.joints, &[]);
        let phase = |i: usize| solver.graph.phase(scene.joints[i].bodies);
        let bodies = scene.flights.iter().map(|flight| Body {
            mass: number(flight.inverse_mass.x),
            inertia: number(flight.inverse_inertia),
            at: pair(flight.position),
            start: [flight.start.linear.x, flight.start.linear.y, flight.start.angular].map(double),
            end: [flight.end.linear.x, flight.end.linear.y, flight.end.angular].map(double),
            flown: [flight.displacement.x, flight.displacement.y, flight.rotation].map(double),
            ..Body::default()
        });
        let joint = |i: usize| {
            let joint = &scene.joints[i];
            let in_phase = |&k: &usize| phase(k) == phase(i);
            let sharing = |body: u32| {
                let phase_joints = (0..scene.joints.len()).filter(in_phase);
                phase_joints.filter(|&k| scene.joints[k].bodies.contains(&body)).count() as f64
            };
            let (length, count) = match joint.kind {
                JointKind::Revolute => (None, 2),
                JointKind::Distance { length } => (Some(double(length)), 1),
            };
            let unit = 2f64.powi(joint.impulses.exponent);
            Joint {
                ends: joint.bodies.map(|body| body as usize),
                anchors: joint.anchors.map(pair),
                length,
                phase: phase(i),
                shares: joint.bodies.map(sharing),
                impulses: joint.impulses.values[..count].iter().map(|&value| value as f64 * unit).collect(),
                arms: [[0.0; 2]; 2],
                axes: vec![],
                errors: vec![],
                distance: 0.0,
            }
        };
        let mut bodies: Vec<Body> = bodies.collect();
        let n = f64::from(scene.options.substeps);
        for body in held(scene) {
            let Body { start, end, flown, offset, .. } = &mut bodies[body];
            let h = 1.0 / f64::from(RATE);
            let euler = [0, 1, 2].map(|i| h * (start[i] + (end[i] - start[i]) * (n + 1.0) / (2.0 * n)));
            *offset = [0, 1, 2].map(|i| euler[i] - flown[i]);
            *flown = euler;
        }
        Self {
            bodies,
            joints: (0..scene.joints.len()).map(joint).collect(),
            h: 1.0 / (f64::from(RATE) * f64::from(scene.options.substeps)),
            n: scene.options.substeps as usize,
            frequency: double(scene.options.joint_frequency),
            damping: double(scene.options.joint_damping_ratio),
            unit: 2f64.powi(solver.bodies.bodies.iter().map(|body| body.unit).max().unwrap_or_default()),
        }
    }

    /// Arms, axes and errors where the bodies are after `k` sub-steps.
    fn place(&mut self, k: usize) {
        let (n, h) = (self.n as f64, self.h);
        let part = k as f64 / n;
        for body in &mut self.bodies {
            for i in 0..3 {
                let (from, to) = (body.start[i], body.end[i]);
                let euler: f64 = (1..=self.n).map(|k| h * (from + (to - from) * k as f64 / n)).sum();
                let up_to_now: f64 = (1..=k).map(|k| h * (from + (to - from) * k as f64 / n)).sum();
                body.way[i] = up_to_now - part * (euler - body.flown[i]) + body.moved[i];
            }
        }
        for joint in &mut self.joints {
            let mut ends = [[0.0; 2]; 2];
            for (side, end) in ends.iter_mut().enumerate() {
                let body = &self.bodies[joint.ends[side]];
                joint.arms[side] = rotated(body.way[2], joint.anchors[side]);
                *end = [0, 1].map(|i| body.at[i] + body.way[i] + joint.arms[side][i]);
            }
            let offset = [0, 1].map(|i| ends[1][i] - ends[0][i]);
            (joint.axes, joint.errors) = match joint.length {
                None => (vec![[1.0, 0.0], [0.0, 1.0]], offset.to_vec()),
                Some(length) => {
                    joint.distance = offset[0].hypot(offset[1]);
                    (vec![offset.map(|c| c / joint.distance)], vec![joint.distance - length])
                }
            };
        }
    }

    /// Adds impulses at the current arms to the changes of velocity.
    fn push(&self, joint: &Joint, impulses: &[f64], gains: &mut [[f64; 3]]) {
        for (&impulse, &axis) in impulses.iter().zip(&joint.axes) {
            for (side, sign) in [(0, -1.0), (1, 1.0)] {
                let body = joint.ends[side];
                let Body { mass, inertia, .. } = self.bodies[body];
                let impulse = sign * impulse;
                let turn = inertia * cross(joint.arms[side], axis) * impulse;
                let changes = [mass * axis[0] * impulse, mass * axis[1] * impulse, turn];
                gains[body].iter_mut().zip(changes).for_each(|(gain, change)| *gain += change);
            }
        }
    }

    fn add(&mut self, gains: &[[f64; 3]]) {
        for (body, gain) in self.bodies.iter_mut().zip(gains) {
            (0..3).for_each(|i| {
                body.now[i] += gain[i];
                body.velocity[i] += gain[i];
            });
        }
    }

    /// The matrix element of two rows, with shares of both bodies.
    fn element(&self, joint: &Joint, i: usize, j: usize, shares: [f64; 2]) -> f64 {
        let side_element = |side: usize| {
            let (body, arm) = (&self.bodies[joint.ends[side]], joint.arms[side]);
            let turning = cross(arm, joint.axes[i]) * cross(arm, joint.axes[j]);
            shares[side] * (body.mass * dot(joint.axes[i], joint.axes[j]) + body.inertia * turning)
        };
        side_element(0) + side_element(1)
    }

    /// The bias of a row in the solve pass, m/s.
    fn bias(&self, joint: &Joint, row: usize, rate: f64) -> f64 {
        let (axis, h) = (joint.axes[row], self.h);
        let bodies = joint.ends.map(|body| &self.bodies[body]);
        let bend = |side: usize| {
            let angle = (bodies[side].now[2] * h).clamp(-0.1, 0.1);
            -0.5 * angle * angle / h * dot(joint.arms[side], axis)
        };
        let shift = |side: usize| {
            let (body, n) = (bodies[side], self.n as f64);
            let excess = |i: usize| {
                let (from, to) = (body.start[i], body.end[i]);
                let euler: f64 = (1..=self.n).map(|k| h * (from + (to - from) * k as f64 / n)).sum();
                (euler - body.flown[i]) / (n * h)
            };
            dot([excess(0), excess(1)], axis) + excess(2) * cross(joint.arms[side], axis)
        };
        let rod = if joint.length.is_some() {
            let speed = |side: usize| {
                let (body, arm) = (bodies[side], joint.arms[side]);
                [body.now[0] - body.now[2] * arm[1], body.now[1] + body.now[2] * arm[0]]
            };
            let across = cross(axis, [speed(1)[0] - speed(0)[0], speed(1)[1] - speed(0)[1]]);
            let angle = (across * h / joint.distance).abs().min(0.1);
            0.5 * angle * angle / h * joint.distance
        } else {
            0.0
        };
        rate * joint.errors[row] / h + bend(1) - bend(0) - (shift(1) - shift(0)) + rod
    }

    /// The changes of the impulses of a joint.
    fn changes(&self, joint: &Joint, is_biased: bool) -> Vec<f64> {
        let is_split = (0..2).any(|side| {
            let body = &self.bodies[joint.ends[side]];
            joint.shares[side] > 1.0 && body.mass + body.inertia > 0.0
        });
        let turn = TAU * self.frequency * if is_split { 0.5 } else { 1.0 };
        let sum = 2.0 * self.damping * if is_split { 4.0 } else { 1.0 } + turn;
        let (rate, compliance) = (turn / sum, 1.0 / (turn * sum));
        let count = joint.axes.len();
        let trace = |shares| (0..count).map(|i| self.element(joint, i, i, shares)).sum::<f64>();
        let (split, whole) = (trace(joint.shares), trace([1.0; 2]));
        let rigid = split / (split + compliance * whole);
        let velocity = |row: usize| {
            let speed = |side: usize| {
                let body = &self.bodies[joint.ends[side]];
                dot([body.now[0], body.now[1]], joint.axes[row])
                    + body.now[2] * cross(joint.arms[side], joint.axes[row])
            };
            speed(1) - speed(0) + if is_biased { self.bias(joint, row, rate) } else { 0.0 }
        };
        let k = |i: usize, j: usize| self.element(joint, i, j, joint.shares);
        let solution = if count == 1 {
            vec![velocity(0) / k(0, 0)]
        } else {
            let more = split / f64::from(1 << 20);
            let (k11, k12, k22) = (k(0, 0) + more, k(0, 1), k(1, 1) + more);
            let (v1, v2, det) = (velocity(0), velocity(1), k11 * k22 - k12 * k12);
            vec![(k22 * v1 - k12 * v2) / det, (k11 * v2 - k12 * v1) / det]
        };
        solution
            .into_iter()
            .zip(&joint.impulses)
            .map(|(push, impulse)| if is_biased { -rigid * push - (1.0 - rigid) * impulse } else { -push })
            .collect()
    }

    fn pass(&mut self, is_biased: bool) {
        for phase in 0..PHASES {
            let mut gains = vec![[0.0; 3]; self.bodies.len()];
            let is_in_phase = |joint: &&Joint| joint.phase == phase;
            let changes: Vec<_> =
                self.joints.iter().filter(is_in_phase).map(|joint| self.changes(joint, is_biased)).collect();
            for (joint, changes) in self.joints.iter().filter(is_in_phase).zip(&changes) {
                self.push(joint, changes, &mut gains);
            }
            for (joint, changes) in self.joints.iter_mut().filter(|joint| joint.phase == phase).zip(&changes) {
                joint.impulses.iter_mut().zip(changes).for_each(|(impulse, change)| *impulse += change);
            }
            self.add(&gains);
        }
    }

    fn run(&mut self) {
        self.place(0);
        for k in 1..=self.n {
            let part = k as f64 / self.n as f64;
            for body in &mut self.bodies {
                body.now = [0, 1, 2].map(|i| body.start[i] + (body.end[i] - body.start[i]) * part + body.velocity[i]);
            }
            let mut gains = vec![[0.0; 3]; self.bodies.len()];
            self.joints.iter().for_each(|joint| self.push(joint, &joint.impulses, &mut gains));
            self.add(&gains);
            self.pass(true);
            for body in &mut self.bodies {
                (0..3).for_each(|i| body.moved[i] += self.h * body.velocity[i]);
            }
            self.place(k);
            self.pass(false);
        }
    }
}

/// A velocity is rounded, by half a unit, in up to 72 passes, nine in each of eight sub-steps: together 36 units. Where joints
/// contradict each other by metres the unit is coarser than 2^-22 m/s, as such errors are removed at a high speed. Masses are at most
/// 4 kg.
#[test]
fn a_step_of_joints_follows_a_twin_in_doubles() {
    const UNITS: f64 = 36.0;
    let mut random = Random::seeded(run_seed(7));
    let mut largest = [0.0; 3];
    for i in 0..300 {
        let scene = Scene::random(&mut random, [8, i % 3], 4 + i % 7, 0);
        let mut twin = Twin::new(&scene);
        twin.run();
        let (corrections, impulses, cut) = scene.solve();
        assert_eq!(cut, 0);
        let mut record =
            |k: usize, difference: f64, unit: f64| largest[k] = f64::max(largest[k], difference.abs() / unit);
        for (correction, body) in corrections.iter().zip(&twin.bodies) {
            let velocity = [correction.velocity.x, correction.velocity.y, correction.angular_velocity].map(change);
            let moved = [correction.displacement.x, correction.displacement.y, correction.rotation].map(change);
            for i in 0..3 {
                record(0, velocity[i] - body.velocity[i], twin.unit);
                record(1, moved[i] - body.moved[i] - body.offset[i], twin.unit / f64::from(RATE));
            }
        }
        for (values, joint) in impulses.iter().zip(&twin.joints) {
            let unit = 2f64.powi(values.exponent);
            for (&value, impulse) in values.values.iter().zip(&joint.impulses) {
                record(2, value as f64 * unit - impulse, 4.0 * twin.unit);
            }
        }
    }
    assert!(largest.iter().all(|&units| units < UNITS), "{largest:?}");
}

/// A joint far from any other body changes nothing there, and a body without joints and contacts stays as it flies.
#[test]
fn bodies_without_joints_are_left_alone() {
    let mut random = Random::seeded(run_seed(8));
    let mut scene = Scene::random(&mut random, [8, 0], 6, 0);
    let stranger = scene.flights[0];
    scene.flights.push(stranger);
    let (corrections, ..) = scene.solve();
    assert_eq!(corrections.last(), Some(&Default::default()));
    let far = Fx::from_bits(1 << 62);
    scene.flights.last_mut().expect("eight and one").position = Vec2::new(far, far);
    assert_eq!(scene.solve().0, corrections);
}
