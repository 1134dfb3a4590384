//! Joints in floats: the rows and laws of the solver in integers, each set of joined bodies solved exactly, tree or loop.
//!
//! A pass finds the velocities at which every row has the impulse of its law. With the change x of the velocities of all bodies of a set, over
//! the square root of their inverse masses, with the rows Ĵ times that root, and with the impulse λ(w) of each row, which falls with its velocity w,
//!
//! ```text
//! x = Ĵᵀ(λ(w) − λ)      w = J·v + Ĵ·x
//! ```
//!
//! is where the gradient of a convex function of x is zero: half the square of x, and for each row the integral of −λ(w). Rows that are held and
//! springs make it quadratic, bounds piecewise so. Newton's method with a search along each step ends there in few steps, with
//!
//! ```text
//! (1 + Ĵᵀ·K·Ĵ)·dx = Ĵᵀ(λ(w) − λ) − x      K = −dλ/dw
//! ```
//!
//! - `matrix`: that matrix, of 3×3 blocks by bodies.
//! - `rows`: axes, arms and errors where the bodies are, in each sub-step, and the second-order term of the motion.
//! - `law`: λ(w).
//!
//! As in integers, rows give way by 2^-11 of the inverse mass of their joint, by 2^-7 where joints bear heavy loads among other constraints, and a
//! tenth of an error is taken away in a sub-step. Sets that touch nothing take three tenths away, and have no relax pass.

mod law;
mod matrix;
mod rows;

use alloc::vec::Vec;
use core::ops::Range;

use self::law::Aim;
use self::matrix::Matrix;
use self::rows::JointRows;
use super::body::Body;
use super::{Clock, Vector, dot, in_units, newton_seconds};
use crate::slots::NONE;
use crate::solve::joint::{Forest, Loads};
use crate::solve::{Contact, Flight, Graph, Impulses, Joint};

/// Rows that are held give way by this part of the inverse mass of their joint; and among other constraints, under heavy loads.
const GIVE: f64 = 1.0 / 2048.0;
const LOADED_GIVE: f64 = 1.0 / 128.0;
/// The most steps of Newton's method, and of a search along one of them.
const STEPS: usize = 32;
const SEARCHES: usize = 48;
/// The part of the slope along a step that a search may leave.
const SMALL_SLOPE: f64 = 1e-12;
/// A step ends the passes of a set if it lowers the function by less than this part of the square of x.
const SMALL_STEP: f64 = 1e-24;

/// All joints of the solver.
#[derive(Debug, Default)]
pub(super) struct Joints {
    forest: Forest,
    loads: Loads,
    matrix: Matrix,
    /// The bodies of joints, [`NONE`] for bodies that cannot be moved: the matrix was made for them.
    links: Vec<[u32; 2]>,
    sets: Vec<Set>,
    rows: Vec<JointRows>,
    /// The velocities of rows by joint, and their changes along a step.
    velocities: Vec<Vector>,
    slopes: Vec<Vector>,
    /// By rank: the square root of the inverse mass, x, and dx.
    roots: Vec<Vector>,
    changes: Vec<Vector>,
    steps: Vec<Vector>,
}

/// A set of joined bodies.
#[derive(Clone, Debug)]
struct Set {
    joints: Range<usize>,
    ranks: Range<usize>,
    /// True if one of its bodies is in a contact.
    touches: bool,
    /// True if one step ends where the gradient is zero.
    is_linear: bool,
}

/// The velocities of the bodies of a joint.
fn velocities(rows: &JointRows, bodies: &[Body]) -> [Vector; 2] {
    rows.bodies.map(|body| bodies[body as usize].velocity)
}

/// The excess of the displacements of the bodies of a joint in a sub-step.
fn shifts(rows: &JointRows, bodies: &[Body], clock: Clock) -> [Vector; 2] {
    rows.bodies.map(|body| bodies[body as usize].shift.map(|part| part / clock.count()))
}

impl Joints {
    /// Prepares the joints of a step.
    pub(super) fn set(
        &mut self,
        clock: Clock,
        flights: &[Flight],
        joints: &[Joint],
        contacts: &[Contact],
        graph: &Graph,
        bodies: &[Body],
    ) {
        let Self { forest, loads, rows, .. } = self;
        rows.clear();
        forest.update(flights, joints);
        if joints.is_empty() {
            self.sets.clear();
            return;
        }
        loads.find(flights, joints, contacts, forest, graph);
        for &index in &forest.order {
            let joint = &joints[index as usize];
            let island = graph.island_of_link(joint.bodies);
            let give = if loads.is_heavy(island) { LOADED_GIVE } else { GIVE };
            let mut joint_rows = JointRows::new(index, joint, flights, clock, give);
            joint_rows.turn(bodies, 0.0);
            rows.push(joint_rows);
        }
        self.set_matrix(flights);
        let Self { matrix, roots, changes, steps, sets, rows, .. } = self;
        for vectors in [&mut *roots, changes, steps] {
            vectors.clear();
            vectors.resize(matrix.len(), [0.0; 3]);
        }
        for body in rows.iter().flat_map(|rows| rows.bodies) {
            if let Some(rank) = matrix.rank(body) {
                roots[rank] = bodies[body as usize].inverse_mass.map(libm::sqrt);
            }
        }
        for set in sets.iter_mut() {
            set.touches = false;
            set.is_linear = rows[set.joints.clone()].iter().all(JointRows::is_linear);
        }
        for rank in contacts.iter().flat_map(|contact| contact.bodies).filter_map(|body| matrix.rank(body)) {
            let set = sets.partition_point(|set| set.ranks.end <= rank);
            sets[set].touches = true;
        }
        for set in &*sets {
            rows[set.joints.clone()].iter_mut().for_each(|rows| rows.set_free(!set.touches));
        }
    }

    /// Finds the order in which bodies are eliminated, if joints have changed since the step before.
    fn set_matrix(&mut self, flights: &[Flight]) {
        let Self { forest, matrix, links, sets, rows, .. } = self;
        let movable = |body: u32| if flights[body as usize].is_fixed() { NONE } else { body };
        let present = rows.iter().map(|rows| rows.bodies.map(movable));
        if links.iter().copied().eq(present.clone()) && matrix.is_for(flights.len()) {
            return;
        }
        links.clear();
        links.extend(present);
        matrix.clear(flights.len());
        sets.clear();
        for joints in forest.sets() {
            let ranks = matrix.add_set(links[joints.clone()].iter().copied());
            sets.push(Set { joints, ranks, touches: false, is_linear: false });
        }
    }

    /// Begins a sub-step, before bodies take up the changes of their free flight: takes note of velocities.
    pub(super) fn begin(&mut self, bodies: &[Body], joints: &[Joint], clock: Clock, is_first: bool) {
        for rows in &mut self.rows {
            let velocities = match is_first {
                true => rows.bodies.map(|body| bodies[body as usize].start),
                false => velocities(rows, bodies),
            };
            rows.set_start(&velocities, &shifts(rows, bodies, clock), clock);
            if is_first {
                rows.split(newton_seconds(joints[rows.joint as usize].impulses));
            }
        }
    }

    /// Begins the solve pass of a sub-step with the impulses of the one before.
    pub(super) fn warm_start(&mut self, bodies: &mut [Body]) {
        self.rows.iter_mut().for_each(|rows| rows.warm_start(bodies));
    }

    /// The pass before the contacts are solved.
    pub(super) fn solve(&mut self, bodies: &mut [Body], clock: Clock) {
        for set in 0..self.sets.len() {
            self.pass(set, bodies, clock, Aim::Solve);
        }
    }

    /// The pass after a move, before the contacts are relaxed. `share` is the share of the sub-steps that bodies have moved in.
    pub(super) fn relax(&mut self, bodies: &mut [Body], clock: Clock, share: f64) {
        for rows in &mut self.rows {
            rows.weigh();
            rows.turn(bodies, share);
        }
        for set in 0..self.sets.len() {
            if self.sets[set].touches {
                self.pass(set, bodies, clock, Aim::Relax);
            }
        }
    }

    /// Solves a set.
    fn pass(&mut self, set: usize, bodies: &mut [Body], clock: Clock, aim: Aim) {
        let Set { joints, ranks, is_linear, .. } = self.sets[set].clone();
        self.velocities.clear();
        for rows in &mut self.rows[joints.clone()] {
            let (velocities, shifts) = (velocities(rows, bodies), shifts(rows, bodies, clock));
            self.velocities.push(rows.begin(aim, &velocities, &shifts, clock));
        }
        self.changes[ranks.clone()].fill([0.0; 3]);
        for _ in 0..STEPS {
            self.find_step(&joints, &ranks);
            if self.go_along(&joints, &ranks, is_linear) {
                break;
            }
        }
        for (rows, velocities) in self.rows[joints].iter_mut().zip(&self.velocities) {
            let (parts, _) = rows.response(velocities);
            rows.take(parts, bodies);
        }
    }

    /// Lets joints answer impulses on bodies by bounces, to which the impulses of the answer are added: no row with one position moves by both.
    pub(super) fn answer(&mut self, impulses: &mut [Option<Vector>], bodies: &[Body], clock: Clock) {
        for set in 0..self.sets.len() {
            let Set { joints, ranks, .. } = self.sets[set].clone();
            let is_struck = |body: u32| self.matrix.rank(body).is_some() && impulses[body as usize].is_some();
            if !self.rows[joints.clone()].iter().any(|rows| rows.bodies.into_iter().any(is_struck)) {
                continue;
            }
            self.velocities.clear();
            for rows in &mut self.rows[joints.clone()] {
                let changes = rows.bodies.map(|body| {
                    let impulse = impulses[body as usize].unwrap_or_default();
                    [0, 1, 2].map(|c| impulse[c] * bodies[body as usize].inverse_mass[c])
                });
                self.velocities.push(rows.begin(Aim::Answer, &changes, &[[0.0; 3]; 2], clock));
            }
            self.changes[ranks.clone()].fill([0.0; 3]);
            self.find_step(&joints, &ranks);
            self.go_along(&joints, &ranks, true);
            for (rows, velocities) in self.rows[joints].iter_mut().zip(&self.velocities) {
                let (parts, _) = rows.response(velocities);
                for (body, answer) in rows.bodies.into_iter().zip(rows.take_answer(parts)) {
                    if self.matrix.rank(body).is_some() {
                        let sums = impulses[body as usize].get_or_insert([0.0; 3]);
                        (0..3).for_each(|c| sums[c] += answer[c]);
                    }
                }
            }
        }
    }

    /// Adds a part of each answer, by the bodies of the joint, to the impulses of the step.
    pub(super) fn add_answers(&mut self, part: impl Fn([u32; 2]) -> f64) {
        self.rows.iter_mut().for_each(|rows| rows.add_answer(part(rows.bodies)));
    }

    /// Goes along the step as far as the convex function falls. Returns true if its gradient is zero there.
    fn go_along(&mut self, joints: &Range<usize>, ranks: &Range<usize>, is_linear: bool) -> bool {
        let slope = if is_linear { 0.0 } else { self.slope_at(0.0, joints, ranks) };
        let length = if is_linear { 1.0 } else { self.step_length(joints, ranks, slope) };
        let mut square = 0.0;
        for rank in ranks.clone() {
            (0..3).for_each(|c| self.changes[rank][c] += length * self.steps[rank][c]);
            square += dot(&self.changes[rank], &self.changes[rank]);
        }
        let mut are_same = length == 1.0;
        for (velocities, (rows, slopes)) in
            self.velocities.iter_mut().zip(self.rows[joints.clone()].iter().zip(&self.slopes))
        {
            let (_, before) = rows.response(velocities);
            (0..3).for_each(|row| velocities[row] += length * slopes[row]);
            // On the same pieces of all laws the step leads to the end.
            are_same = are_same && (is_linear || rows.response(velocities).1 == before);
        }
        are_same || -slope <= SMALL_STEP * square
    }

    /// A row of a joint at a body, times the square root of the inverse mass, with the sign by which its impulses push.
    fn scaled_row(&self, rows: &JointRows, row: usize, side: usize) -> Option<(usize, Vector)> {
        let rank = self.matrix.rank(rows.bodies[side])?;
        let (factors, root) = (rows.rows[row][side], self.roots[rank]);
        let sign = if side == 0 { -1.0 } else { 1.0 };
        Some((rank, [0, 1, 2].map(|c| sign * factors[c] * root[c])))
    }

    /// Finds the step of Newton's method, and the changes of the velocities of rows by it.
    fn find_step(&mut self, joints: &Range<usize>, ranks: &Range<usize>) {
        self.matrix.begin(ranks.clone());
        for rank in ranks.clone() {
            self.steps[rank] = self.changes[rank].map(|part| -part);
        }
        for (index, velocities) in joints.clone().zip(0..) {
            let rows = &self.rows[index];
            let (parts, slopes) = rows.response(&self.velocities[velocities]);
            let before = rows.impulses();
            let scaled = [0, 1, 2].map(|row| [0, 1].map(|side| self.scaled_row(rows, row, side)));
            for row in 0..3 {
                let push = parts[row].iter().sum::<f64>() - before[row];
                for (rank, factors) in scaled[row].into_iter().flatten() {
                    (0..3).for_each(|c| self.steps[rank][c] += factors[c] * push);
                }
                for (column, slope) in slopes[row].into_iter().enumerate().filter(|&(_, slope)| slope != 0.0) {
                    for (row_rank, row_factors) in scaled[row].into_iter().flatten() {
                        for (column_rank, column_factors) in scaled[column].into_iter().flatten() {
                            let column_factors = column_factors.map(|part| slope * part);
                            self.matrix.add([row_rank, column_rank], &row_factors, &column_factors);
                        }
                    }
                }
            }
        }
        self.matrix.factor(ranks.clone());
        self.matrix.solve(ranks.clone(), &mut self.steps);
        self.slopes.clear();
        for index in joints.clone() {
            let rows = &self.rows[index];
            let slopes = [0, 1, 2].map(|row| {
                let ends = [0, 1].map(|side| self.scaled_row(rows, row, side));
                ends.into_iter().flatten().map(|(rank, factors)| dot(&factors, &self.steps[rank])).sum()
            });
            self.slopes.push(slopes);
        }
    }

    /// The slope of the convex function along a step, after a part of it.
    fn slope_at(&self, part: f64, joints: &Range<usize>, ranks: &Range<usize>) -> f64 {
        let by_mass: f64 = ranks
            .clone()
            .map(|rank| dot(&self.steps[rank], &[0, 1, 2].map(|c| self.changes[rank][c] + part * self.steps[rank][c])))
            .sum();
        let by_rows: f64 = self.rows[joints.clone()]
            .iter()
            .zip(self.velocities.iter().zip(&self.slopes))
            .map(|(rows, (velocities, slopes))| {
                let (parts, _) = rows.response(&[0, 1, 2].map(|row| velocities[row] + part * slopes[row]));
                let before = rows.impulses();
                (0..3).map(|row| slopes[row] * (parts[row].iter().sum::<f64>() - before[row])).sum::<f64>()
            })
            .sum();
        by_mass - by_rows
    }

    /// The part of a step after which the convex function is least, for the slope at its beginning.
    fn step_length(&self, joints: &Range<usize>, ranks: &Range<usize>, slope: f64) -> f64 {
        let small = SMALL_SLOPE * slope.abs();
        if self.slope_at(1.0, joints, ranks) <= small {
            return 1.0;
        }
        let [mut low, mut high] = [0.0, 1.0];
        for _ in 0..SEARCHES {
            let middle = (low + high) / 2.0;
            if self.slope_at(middle, joints, ranks) > 0.0 {
                high = middle;
            } else {
                low = middle;
            }
        }
        high
    }

    /// The number of each joint and its impulses over the step on the second body: along x and y, in N·s, and around, in N·m·s.
    pub(super) fn totals(&self) -> impl Iterator<Item = (u32, Vector)> + '_ {
        self.rows.iter().map(|rows| {
            let [_, [x, y, _]] = rows.applied();
            (rows.joint, [x, y, rows.around])
        })
    }

    /// Writes the impulses of joints, and adds the impulses of the step to the sums of bodies.
    pub(super) fn apply(&self, joints: &mut [Joint], bodies: &mut [Body]) {
        joints.iter_mut().for_each(|joint| joint.impulses = Impulses::default());
        for rows in &self.rows {
            joints[rows.joint as usize].impulses = in_units(rows.impulses());
            let applied = rows.applied();
            for (k, body) in rows.bodies.into_iter().enumerate() {
                let body = &mut bodies[body as usize];
                (0..3).for_each(|c| body.applied[c] += applied[k][c]);
                (0..3).for_each(|c| body.weighted[c] += rows.weighted[k][c]);
            }
        }
    }
}
