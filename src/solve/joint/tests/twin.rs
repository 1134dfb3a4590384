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
use crate::solve::bodies::STILL;
use crate::solve::motion::VELOCITY;
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
    /// The current velocity, and the largest one that its row holds.
    now: [f64; 3],
    limit: [f64; 3],
}

struct Joint {
    ends: [usize; 2],
    anchors: [[f64; 2]; 2],
    length: Option<f64>,
    /// Half the trace of the inverse mass at the points of both bodies, at the start.
    mobility: f64,
    impulses: Vec<f64>,
    /// Arms, axes and errors where the bodies are now.
    arms: [[f64; 2]; 2],
    axes: Vec<[f64; 2]>,
    errors: Vec<f64>,
    distance: f64,
}

/// Joints of bodies that they connect.
struct Set {
    joints: Vec<usize>,
    is_tree: bool,
}

struct Twin {
    bodies: Vec<Body>,
    joints: Vec<Joint>,
    sets: Vec<Set>,
    h: f64,
    n: usize,
    frequency: f64,
    damping: f64,
    /// The coarsest unit of velocity of an island of the scene, m/s.
    unit: f64,
    /// True if a body was faster within the step than an eighth of what its row holds, as fast as free flights may be.
    is_beyond: bool,
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

/// The sets of joints. A tree has one joint between two movable bodies less than bodies.
fn sets(scene: &Scene) -> Vec<Set> {
    let is_fixed = |body: u32| scene.flights[body as usize].is_fixed();
    let mut label: Vec<usize> = (0..scene.flights.len()).collect();
    for _ in &scene.flights {
        for joint in scene.joints.iter().filter(|joint| !joint.bodies.iter().any(|&body| is_fixed(body))) {
            let [a, b] = joint.bodies.map(|body| body as usize);
            (label[a], label[b]) = (label[a].min(label[b]), label[a].min(label[b]));
        }
    }
    let set = |set: usize| {
        let is_member = |&&body: &&u32| !is_fixed(body) && label[body as usize] == set;
        let joints = (0..scene.joints.len()).filter(|&i| scene.joints[i].bodies.iter().any(|body| is_member(&body)));
        let joints: Vec<usize> = joints.collect();
        let inner = joints.iter().filter(|&&i| scene.joints[i].bodies.iter().all(|body| is_member(&body))).count();
        let members = (0..scene.flights.len() as u32).filter(|body| is_member(&body)).count();
        Set { joints, is_tree: inner + 1 == members }
    };
    (0..scene.flights.len()).map(set).filter(|set| !set.joints.is_empty()).collect()
}

/// The solution of a system of linear equations, by Gauss with the largest pivots.
fn solved(mut matrix: Vec<Vec<f64>>, mut right: Vec<f64>) -> Vec<f64> {
    let n = right.len();
    for i in 0..n {
        let largest = |&a: &usize, &b: &usize| matrix[a][i].abs().total_cmp(&matrix[b][i].abs());
        let pivot = (i..n).max_by(largest).expect("a row is left");
        matrix.swap(i, pivot);
        right.swap(i, pivot);
        for row in i + 1..n {
            let factor = matrix[row][i] / matrix[i][i];
            (i..n).for_each(|k| matrix[row][k] -= factor * matrix[i][k]);
            right[row] -= factor * right[i];
        }
    }
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|k| matrix[i][k] * right[k]).sum();
        right[i] = (right[i] - known) / matrix[i][i];
    }
    right
}

impl Twin {
    fn new(scene: &Scene) -> Self {
        let mut solver = Solver::default();
        solver.prepare(TimeStep::hz(RATE), &scene.options, &scene.flights, &scene.joints, &[]);
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
            let at = |side: usize| {
                let (body, [x, y]) = (&scene.flights[joint.bodies[side] as usize], pair(joint.anchors[side]));
                number(body.inverse_mass.x) + number(body.inverse_inertia) * (x * x + y * y) / 2.0
            };
            let (length, count) = match joint.kind {
                JointKind::Revolute => (None, 2),
                JointKind::Distance { length } => (Some(double(length)), 1),
                _ => unreachable!("not in these scenes"),
            };
            let unit = 2f64.powi(joint.impulses.exponent);
            Joint {
                ends: joint.bodies.map(|body| body as usize),
                anchors: joint.anchors.map(pair),
                length,
                mobility: at(0) + at(1),
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
        for (body, row) in bodies.iter_mut().zip(&solver.bodies.bodies) {
            let limit = f64::from(VELOCITY) * 2f64.powi(row.unit);
            body.limit = [limit, limit, limit / 2f64.powi(row.length)];
        }
        Self {
            is_beyond: false,
            bodies,
            joints: (0..scene.joints.len()).map(joint).collect(),
            sets: sets(scene),
            h: 1.0 / (f64::from(RATE) * f64::from(scene.options.substeps)),
            n: scene.options.substeps as usize,
            frequency: double(scene.options.joint_frequency),
            damping: double(scene.options.joint_damping_ratio),
            unit: 2f64.powi(
                solver
                    .bodies
                    .bodies
                    .iter()
                    .filter(|body| body.row != STILL)
                    .map(|body| body.unit)
                    .max()
                    .unwrap_or_default(),
            ),
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

    /// The velocity of row i of a joint by an impulse along row j of another one.
    fn element(&self, [a, i]: [usize; 2], [b, j]: [usize; 2]) -> f64 {
        let (first, second) = (&self.joints[a], &self.joints[b]);
        let mut sum = 0.0;
        for (k, l) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            if first.ends[k] != second.ends[l] {
                continue;
            }
            let body = &self.bodies[first.ends[k]];
            let turning = cross(first.arms[k], first.axes[i]) * cross(second.arms[l], second.axes[j]);
            let velocity = body.mass * dot(first.axes[i], second.axes[j]) + body.inertia * turning;
            sum += if k == l { velocity } else { -velocity };
        }
        sum
    }

    /// The bias of a row in the solve pass, m/s.
    fn bias(&self, joint: &Joint, row: usize, rate: f64) -> f64 {
        let (axis, h) = (joint.axes[row], self.h);
        let bodies = joint.ends.map(|body| &self.bodies[body]);
        let bend = |side: usize| {
            let angle = (bodies[side].now[2] * h).clamp(-0.1, 0.1);
            let [x, y] = joint.arms[side];
            // Of second and third order.
            -0.5 * angle * angle / h * dot([x - angle / 3.0 * y, y + angle / 3.0 * x], axis)
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

    /// Rows of joints, by joint and number.
    fn rows(&self, joints: &[usize]) -> Vec<[usize; 2]> {
        joints.iter().flat_map(|&joint| (0..self.joints[joint].axes.len()).map(move |row| [joint, row])).collect()
    }

    /// The velocity along a row, m/s.
    fn velocity(&self, [joint, row]: [usize; 2]) -> f64 {
        let joint = &self.joints[joint];
        let speed = |side: usize| {
            let body = &self.bodies[joint.ends[side]];
            dot([body.now[0], body.now[1]], joint.axes[row]) + body.now[2] * cross(joint.arms[side], joint.axes[row])
        };
        speed(1) - speed(0)
    }

    /// The changes of impulses of a tree: (K + γ)·Δλ = −r.
    fn tree_changes(&self, rows: &[[usize; 2]]) -> Vec<f64> {
        let softness = |joint: usize| self.joints[joint].mobility / 2048.0;
        let matrix =
            |i: usize, k: usize| self.element(rows[i], rows[k]) + if i == k { softness(rows[i][0]) } else { 0.0 };
        let matrix = (0..rows.len()).map(|i| (0..rows.len()).map(|k| matrix(i, k)).collect()).collect();
        let residual = |&[joint, row]: &[usize; 2]| {
            let soft = softness(joint) * self.joints[joint].impulses[row];
            -(self.velocity([joint, row]) + self.bias(&self.joints[joint], row, 0.3) + soft)
        };
        solved(matrix, rows.iter().map(residual).collect())
    }

    /// The changes of impulses of a loop by three iterations of conjugate gradients.
    fn loop_changes(&self, rows: &[[usize; 2]], is_biased: bool) -> Vec<f64> {
        let turn = TAU * self.frequency;
        let sum = 2.0 * self.damping + turn;
        let (rate, compliance) = (turn / sum, 1.0 / (turn * sum));
        let numbers = || 0..rows.len();
        let rows_of = |joint: usize| numbers().filter(move |&i| rows[i][0] == joint);
        let trace = |joint: usize| rows_of(joint).map(|i| self.element(rows[i], rows[i])).sum::<f64>();
        let softness = |joint: usize| compliance * trace(joint) / rows_of(joint).count() as f64;
        let times = |p: &[f64]| -> Vec<f64> {
            let whole = |i: usize| numbers().map(|k| self.element(rows[i], rows[k]) * p[k]).sum::<f64>();
            numbers().map(|i| whole(i) + softness(rows[i][0]) * p[i]).collect()
        };
        let precondition = |r: &[f64]| -> Vec<f64> {
            let solve = |i: usize| {
                let joint: Vec<usize> = rows_of(rows[i][0]).collect();
                let extra = if joint.len() == 2 { trace(rows[i][0]) / f64::from(1 << 20) } else { 0.0 };
                let element = |a: usize, b: usize| self.element(rows[a], rows[b]) + if a == b { extra } else { 0.0 };
                let matrix = joint.iter().map(|&a| joint.iter().map(|&b| element(a, b)).collect()).collect();
                let solution = solved(matrix, joint.iter().map(|&a| r[a]).collect());
                solution[joint.iter().position(|&a| a == i).expect("a row of the joint")] / (1.0 + compliance)
            };
            numbers().map(solve).collect()
        };
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let residual = |&[joint, row]: &[usize; 2]| {
            let soft = softness(joint) * self.joints[joint].impulses[row];
            let biased = if is_biased { self.bias(&self.joints[joint], row, rate) + soft } else { 0.0 };
            -(self.velocity([joint, row]) + biased)
        };
        let mut r: Vec<f64> = rows.iter().map(residual).collect();
        let mut z = precondition(&r);
        let (mut p, mut x) = (z.clone(), vec![0.0; rows.len()]);
        for _ in 0..3 {
            let (square, moved) = (product(&r, &z), times(&p));
            if square == 0.0 {
                break;
            }
            let step = square / product(&p, &moved);
            for i in numbers() {
                (x[i], r[i]) = (x[i] + step * p[i], r[i] - step * moved[i]);
            }
            z = precondition(&r);
            let kept = product(&r, &z) / square;
            p = numbers().map(|i| z[i] + kept * p[i]).collect();
        }
        x
    }

    fn pass(&mut self, is_biased: bool) {
        let mut all = vec![];
        for set in &self.sets {
            let rows = self.rows(&set.joints);
            let changes = match (set.is_tree, is_biased) {
                (true, true) => self.tree_changes(&rows),
                // Trees that touch nothing have no relax pass.
                (true, false) => vec![0.0; rows.len()],
                (false, _) => self.loop_changes(&rows, is_biased),
            };
            all.extend(rows.into_iter().zip(changes));
        }
        let mut gains = vec![[0.0; 3]; self.bodies.len()];
        for ([joint, row], change) in all {
            let mut changes = vec![0.0; self.joints[joint].axes.len()];
            changes[row] = change;
            self.push(&self.joints[joint], &changes, &mut gains);
            self.joints[joint].impulses[row] += change;
        }
        self.add(&gains);
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
            self.note_speeds();
            self.pass(true);
            self.note_speeds();
            for body in &mut self.bodies {
                (0..3).for_each(|i| body.moved[i] += self.h * body.velocity[i]);
            }
            self.place(k);
            self.pass(false);
            self.note_speeds();
        }
    }

    fn note_speeds(&mut self) {
        let is_fast = |body: &Body| (0..3).any(|axis| body.now[axis].abs() > body.limit[axis] / 8.0);
        self.is_beyond |= self.bodies.iter().any(|body| body.mass + body.inertia > 0.0 && is_fast(body));
    }
}

/// A velocity is rounded, by half a unit, in up to 24 passes, three in each of eight sub-steps, to which a matrix near a singular one adds
/// 2^-12 of the largest velocity at most. Where joints contradict each other by metres, the solver cuts off velocities, and a twin that does
/// not is no measure.
#[test]
fn a_step_of_joints_follows_a_twin_in_doubles() {
    const UNITS: f64 = 36.0;
    let mut random = Random::seeded(run_seed(7));
    let mut compared = 0;
    for i in 0..400 {
        let scene = Scene::random(&mut random, [8, i % 3], 4 + i % 7, 0);
        let mut twin = Twin::new(&scene);
        twin.run();
        let (corrections, impulses, cut) = scene.solve();
        if cut > 0 || twin.is_beyond {
            continue;
        }
        compared += 1;
        let fastest = twin.bodies.iter().flat_map(|body| body.velocity).fold(0.0, |a, b| f64::max(a, b.abs()));
        let bound = UNITS * twin.unit + fastest / 4096.0;
        for (correction, body) in corrections.iter().zip(&twin.bodies) {
            let velocity = [correction.velocity.x, correction.velocity.y, correction.angular_velocity].map(change);
            let moved = [correction.displacement.x, correction.displacement.y, correction.rotation].map(change);
            for k in 0..3 {
                let (velocity, moved) = (velocity[k] - body.velocity[k], moved[k] - body.moved[k] - body.offset[k]);
                assert!(
                    velocity.abs() < bound && moved.abs() < bound / f64::from(RATE),
                    "{i}: {velocity} {moved} {bound}"
                );
            }
        }
        for (values, joint) in impulses.iter().zip(&twin.joints) {
            let unit = 2f64.powi(values.exponent);
            for (&value, impulse) in values.values.iter().zip(&joint.impulses) {
                let difference = value as f64 * unit - impulse;
                assert!(difference.abs() < 4.0 * bound, "{i}: {difference} {bound}");
            }
        }
    }
    assert!(compared > 150, "{compared}");
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
