//! The rows of a joint: axes, arms and errors where the bodies are.

use super::law::{Aim, Law, Parts};
use crate::math::Vec2;
use crate::scalar::{ToF64 as _, Turn};
use crate::solve::float::body::Body;
use crate::solve::float::{Clock, Pair, Vector, dot, within};
use crate::solve::joint::rope_way;
use crate::solve::{Axis, Flight, Joint, JointKind};

/// The largest turn in a sub-step that the second-order term counts, rad.
const LARGEST_ANGLE: f64 = 0.1;

/// The axes of the rows of a joint.
#[derive(Clone, Copy, Debug)]
enum Frame {
    /// Along x and y.
    World,
    /// Along the offset of the points.
    Line,
    /// Along a direction that turns with the first body: at the start.
    Body(Pair),
    /// Along the ways from two points of the world, for a body each, with the velocities of both points in the velocity of the rope.
    Ropes(Pair),
}

/// A joint in the passes.
#[derive(Clone, Debug)]
pub(super) struct JointRows {
    /// The index of the joint.
    pub(super) joint: u32,
    pub(super) bodies: [u32; 2],
    frame: Frame,
    /// The rows that the joint holds at zero.
    held: [bool; 2],
    /// The laws of rows along the axes of the frame, and around; held rows have one too.
    pub(super) laws: [Option<Law>; 3],
    /// True if the forces of both rows along the axes are bounds of vectors.
    pub(super) is_paired: bool,
    /// The arms at the start, and now.
    start_arms: [Pair; 2],
    arms: [Pair; 2],
    /// The offset from the first anchor to the second at the start, less both arms; of a pulley the ways from the points of the world likewise.
    bases: [Pair; 2],
    /// The lengths that ways are counted from: lengths that are held, or lengths at the start.
    lengths: Pair,
    /// The present lengths along the axes.
    present: Pair,
    /// The axes of the frame; of a pulley the directions of both parts of the rope.
    axes: [Pair; 2],
    /// The factors of the velocities of both bodies in the velocity of a row: the second body's count, less the first body's.
    pub(super) rows: [[Vector; 2]; 3],
    /// The impulses on both bodies in the sub-step, in the sub-steps before, and weighted by the sub-steps that they moved the bodies in.
    change: [Vector; 2],
    applied: [Vector; 2],
    pub(super) weighted: [Vector; 2],
    /// The impulse around of all sub-steps, N·m·s.
    pub(super) around: f64,
    /// The impulses of the rows that answer bounces.
    answer: Vector,
}

fn pair(vector: Vec2) -> Pair {
    [vector.x, vector.y].map(|part| part.to_f64())
}

fn sum(first: Pair, second: Pair) -> Pair {
    [first[0] + second[0], first[1] + second[1]]
}

fn difference(first: Pair, second: Pair) -> Pair {
    [first[0] - second[0], first[1] - second[1]]
}

fn turned([x, y]: Pair, angle: f64) -> Pair {
    let (sin, cos) = libm::sincos(angle);
    [cos * x - sin * y, sin * x + cos * y]
}

/// A direction turned left by a quarter.
fn perpendicular([x, y]: Pair) -> Pair {
    [-y, x]
}

fn cross(first: Pair, second: Pair) -> f64 {
    first[0] * second[1] - first[1] * second[0]
}

/// The direction of a vector and its length; no direction for none.
fn direction([x, y]: Pair) -> (Pair, f64) {
    let length = libm::hypot(x, y);
    if length > 0.0 { ([x / length, y / length], length) } else { ([0.0; 2], 0.0) }
}

/// The direction at an angle.
fn direction_at(angle: Turn) -> Pair {
    let (sin, cos) = libm::sincos(angle.to_f64());
    [cos, sin]
}

/// A row along an axis at an arm.
fn row_along(axis: Pair, arm: Pair) -> Vector {
    [axis[0], axis[1], cross(arm, axis)]
}

/// A vector of 2^-32 m in m.
fn metres(bits: [i128; 2]) -> Pair {
    bits.map(|part| part as f64 / f64::from(1 << 16) / f64::from(1 << 16))
}

/// The angle that a body turns in a sub-step at a velocity, as far as the second-order term counts it.
fn sweep(velocity: &Vector, clock: Clock) -> f64 {
    within(velocity[2] * clock.length, LARGEST_ANGLE)
}

/// The velocity of a point of a body.
fn point_velocity(velocity: &Vector, [x, y]: Pair) -> Pair {
    [velocity[0] - velocity[2] * y, velocity[1] + velocity[2] * x]
}

impl JointRows {
    /// A joint at the start of a step. Rows that are held give way by a part of the inverse mass of the joint.
    pub(super) fn new(index: u32, joint: &Joint, flights: &[Flight], clock: Clock, give: f64) -> Self {
        let ends = joint.bodies.map(|body| &flights[body as usize]);
        let offset_bits = joint.offset(flights);
        let (offset, arms) = (metres(offset_bits), joint.anchors.map(pair));
        let base = difference(offset, difference(arms[1], arms[0]));
        let (frame, held, bases, lengths) = match joint.kind {
            JointKind::Revolute => (Frame::World, [true; 2], [base; 2], [0.0; 2]),
            JointKind::Distance { length } => (Frame::Line, [true, false], [base; 2], [length.to_f64(), 0.0]),
            JointKind::Line => (Frame::Line, [false; 2], [base; 2], [direction(offset).1, 0.0]),
            JointKind::Gear { .. } => (Frame::World, [false; 2], [base; 2], [0.0; 2]),
            JointKind::Slider { angle } | JointKind::Planar { angle } => {
                let axis = direction_at(angle);
                let is_slider = matches!(joint.kind, JointKind::Slider { .. });
                let across = if is_slider { 0.0 } else { dot(&perpendicular(axis), &offset) };
                (Frame::Body(axis), [false, is_slider], [base; 2], [dot(&axis, &offset), across])
            }
            JointKind::Pulley { grounds, .. } => {
                let ways = [0, 1].map(|k| metres(rope_way(ends[k], joint.anchors[k], grounds[k])));
                let factors = joint.kind.rope_factors().map(|factor| factor as f64 / f64::from(1 << 30));
                let bases = [0, 1].map(|k| difference(ways[k], arms[k]));
                (Frame::Ropes(factors), [false; 2], bases, ways.map(|way| direction(way).1))
            }
        };
        // Half the sum of the inverse mass at the points along x and along y. The first body of a frame is pushed at the second point.
        let reach = if matches!(frame, Frame::Body(_)) { [sum(arms[0], offset), arms[1]] } else { arms };
        let inverse_mass: f64 = (ends.iter().zip(&reach))
            .map(|(end, arm)| {
                let linear = end.inverse_mass.x.to_f64().max(end.inverse_mass.y.to_f64());
                linear + end.inverse_inertia.to_f64() * dot(arm, arm) / 2.0
            })
            .sum();
        let stiffness = if inverse_mass > 0.0 { 1.0 / (give * inverse_mass) } else { 0.0 };
        let law = |axis: &Option<Axis>, mass: Option<f64>| Some(Law::new(axis.as_ref()?, mass?, clock));
        let has_slide = joint.slides != [None; 2];
        let mass = has_slide.then(|| joint.effective_mass(ends, offset_bits)).flatten().map(|mass| mass.to_f64());
        let inertia = joint.axis.and_then(|_| joint.effective_inertia(ends)).map(|inertia| inertia.to_f64());
        let along = |row: usize| match held[row] {
            true => Some(Law::held(stiffness)),
            false => law(&joint.slides[row], mass),
        };
        let laws = [along(0), along(1), law(&joint.axis, inertia)];
        let factors = joint.kind.angle_factors().map(|factor| factor as f64 / f64::from(1 << 30));
        Self {
            joint: index,
            bodies: joint.bodies,
            frame,
            held,
            is_paired: matches!(joint.kind, JointKind::Planar { .. }) && laws[0].is_some() && laws[1].is_some(),
            laws,
            start_arms: arms,
            arms,
            bases,
            lengths,
            present: lengths,
            axes: [[1.0, 0.0], [0.0, 1.0]],
            rows: [[[0.0; 3]; 2], [[0.0; 3]; 2], [[0.0, 0.0, -factors[0]], [0.0, 0.0, factors[1]]]],
            change: [[0.0; 3]; 2],
            applied: [[0.0; 3]; 2],
            weighted: [[0.0; 3]; 2],
            around: 0.0,
            answer: [0.0; 3],
        }
    }

    /// Settles whether the joint is in a set that touches nothing.
    pub(super) fn set_free(&mut self, is_free: bool) {
        for law in
            self.laws[..2].iter_mut().zip(self.held).filter_map(|(law, is_held)| law.as_mut().filter(|_| is_held))
        {
            law.set_free(is_free);
        }
    }

    /// Returns true if all impulses follow from velocities linearly.
    pub(super) fn is_linear(&self) -> bool {
        self.laws.iter().flatten().all(Law::is_rigid)
    }

    /// Updates arms, axes and errors to where the bodies are, after a share of the sub-steps.
    pub(super) fn turn(&mut self, bodies: &[Body], share: f64) {
        let moved = self.bodies.map(|body| bodies[body as usize].moved(share));
        self.arms = [0, 1].map(|k| turned(self.start_arms[k], moved[k][2]));
        let ways = moved.map(|[x, y, _]| [x, y]);
        let offset = sum(self.bases[0], difference(sum(ways[1], self.arms[1]), sum(ways[0], self.arms[0])));
        let mut points = self.arms;
        match self.frame {
            Frame::World => self.present = offset,
            Frame::Line => {
                let (axis, length) = direction(offset);
                (self.axes, self.present) = ([axis, [0.0; 2]], [length, 0.0]);
            }
            Frame::Body(axis) => {
                let axis = turned(axis, moved[0][2]);
                self.axes = [axis, perpendicular(axis)];
                self.present = self.axes.map(|axis| dot(&axis, &offset));
                points[0] = sum(points[0], offset);
            }
            Frame::Ropes(_) => {
                for (k, way) in ways.into_iter().enumerate() {
                    (self.axes[k], self.present[k]) = direction(sum(self.bases[k], sum(way, self.arms[k])));
                }
            }
        }
        let mut errors = difference(self.present, self.lengths);
        if let Frame::Ropes(factors) = self.frame {
            errors = [dot(&factors, &errors), 0.0];
            self.rows[0] = [0, 1].map(|k| {
                let factor = if k == 0 { -factors[0] } else { factors[1] };
                row_along(self.axes[k], points[k]).map(|part| factor * part)
            });
        } else {
            for row in 0..2 {
                self.rows[row] = points.map(|arm| row_along(self.axes[row], arm));
            }
        }
        let around = self.along(2, &moved);
        for (law, way) in self.laws.iter_mut().zip([errors[0], errors[1], around]) {
            if let Some(law) = law {
                law.set_way(way);
            }
        }
    }

    /// The component along a row of a velocity or a displacement of both bodies.
    pub(super) fn along(&self, row: usize, vectors: &[Vector; 2]) -> f64 {
        dot(&self.rows[row][1], &vectors[1]) - dot(&self.rows[row][0], &vectors[0])
    }

    /// The motion of a row in a sub-step over the length of it, less the velocity: bodies move on straight lines within a sub-step while points
    /// turn on circles. `shifts` are the excess of the displacements in a sub-step over the ways of the bodies.
    fn second_order(&self, row: usize, velocities: &[Vector; 2], shifts: &[Vector; 2], clock: Clock) -> f64 {
        if row == 2 {
            return 0.0;
        }
        let h = clock.length;
        let angles = [0, 1].map(|k| sweep(&velocities[k], clock));
        // Of second and third order.
        let bends = [0, 1].map(|k| {
            let arm = self.arms[k];
            let left = perpendicular(arm);
            [0, 1].map(|c| angles[k] * angles[k] * (arm[c] + angles[k] * left[c] / 3.0) / (2.0 * h))
        });
        let points = [0, 1].map(|k| point_velocity(&velocities[k], self.arms[k]));
        // Of a line of a length whose end moves across it.
        let turn = |velocity: f64, length: f64| {
            let angle = if length > 0.0 { within(velocity * h / length, LARGEST_ANGLE) } else { 0.0 };
            angle * angle * length / (2.0 * h)
        };
        let shift = self.along(row, shifts) / h;
        if let Frame::Ropes(factors) = self.frame {
            let parts = [0, 1].map(|k| {
                let across = cross(self.axes[k], points[k]);
                factors[k] * (turn(across, self.present[k]) - dot(&self.axes[k], &bends[k]))
            });
            return parts[0] + parts[1] - shift;
        }
        let bend = dot(&self.axes[row], &difference(bends[0], bends[1])) - shift;
        let relative = difference(points[1], points[0]);
        match self.frame {
            Frame::World | Frame::Ropes(_) => bend,
            Frame::Line => bend + turn(cross(self.axes[0], relative), self.present[0]),
            Frame::Body(_) => {
                let velocity = angles[0] * dot(&self.axes[1 - row], &relative) * if row == 1 { -1.0 } else { 1.0 };
                let offset = if self.held[row] { 0.0 } else { self.present[row] };
                bend + velocity - angles[0] * angles[0] * offset / (2.0 * h)
            }
        }
    }

    /// Takes note of the velocities of the bodies at the beginning of a sub-step, which springs ask for.
    pub(super) fn set_start(&mut self, velocities: &[Vector; 2], shifts: &[Vector; 2], clock: Clock) {
        for row in 0..3 {
            if self.laws[row].as_ref().is_some_and(Law::has_spring) {
                let velocity = self.along(row, velocities) + self.second_order(row, velocities, shifts, clock);
                if let Some(law) = &mut self.laws[row] {
                    law.set_start(velocity);
                }
            }
        }
    }

    /// Splits the impulses of the step before among the parts of laws.
    pub(super) fn split(&mut self, impulses: Vector) {
        if let ([Some(first), Some(second), _], true) = (&mut self.laws, self.is_paired) {
            Law::split_pair([first, second], [impulses[0], impulses[1]]);
        }
        let is_paired = self.is_paired;
        for (row, law) in self.laws.iter_mut().enumerate().filter(|&(row, _)| row == 2 || !is_paired) {
            if let Some(law) = law {
                law.split(impulses[row]);
            }
        }
    }

    /// Begins a pass at the velocities of the bodies. Returns the velocities of the rows.
    pub(super) fn begin(&mut self, aim: Aim, velocities: &[Vector; 2], shifts: &[Vector; 2], clock: Clock) -> Vector {
        for row in 0..3 {
            let second_order = match aim {
                Aim::Solve => self.second_order(row, velocities, shifts, clock),
                Aim::Relax | Aim::Answer => 0.0,
            };
            if let Some(law) = &mut self.laws[row] {
                law.begin(aim, second_order, clock);
            }
        }
        [0, 1, 2].map(|row| self.along(row, velocities))
    }

    /// The impulses of the parts of all rows at velocities of the rows, and the slopes by which the impulses of rows fall.
    pub(super) fn response(&self, velocities: &Vector) -> ([Parts; 3], [Vector; 3]) {
        let mut parts = [Parts::default(); 3];
        let mut slopes = [[0.0; 3]; 3];
        if let ([Some(first), Some(second), _], true) = (&self.laws, self.is_paired) {
            let (pair_parts, pair_slopes) = Law::pair_response([first, second], [velocities[0], velocities[1]]);
            for row in 0..2 {
                parts[row] = pair_parts[row];
                slopes[row][..2].copy_from_slice(&pair_slopes[row]);
            }
        }
        for row in 0..3 {
            if let Some(law) = self.laws[row].as_ref().filter(|_| row == 2 || !self.is_paired) {
                (parts[row], slopes[row][row]) = law.response(velocities[row]);
            }
        }
        (parts, slopes)
    }

    /// The impulses of the rows.
    pub(super) fn impulses(&self) -> Vector {
        [0, 1, 2].map(|row| self.laws[row].as_ref().map_or(0.0, Law::impulse))
    }

    /// The impulses on both bodies by impulses of the rows.
    fn on_bodies(&self, impulses: &Vector) -> [Vector; 2] {
        let [first, second] = [0, 1]
            .map(|side| [0, 1, 2].map(|c| (0..3).map(|row| self.rows[row][side][c] * impulses[row]).sum::<f64>()));
        [first.map(|part| -part), second]
    }

    /// Begins a sub-step with the impulses of the one before at the present arms. Bodies have once more the changes of the sub-step before.
    pub(super) fn warm_start(&mut self, bodies: &mut [Body]) {
        let impulses = self.impulses();
        let change = self.on_bodies(&impulses);
        for k in 0..2 {
            let repeated = self.change[k];
            (0..3).for_each(|c| self.applied[k][c] += repeated[c]);
            bodies[self.bodies[k] as usize].push([0, 1, 2].map(|c| change[k][c] - repeated[c]));
        }
        self.change = change;
        self.around += impulses[2];
    }

    /// Takes the impulses of a pass.
    pub(super) fn take(&mut self, parts: [Parts; 3], bodies: &mut [Body]) {
        let before = self.impulses();
        for (law, parts) in self.laws.iter_mut().zip(parts) {
            if let Some(law) = law {
                law.parts = parts;
            }
        }
        let after = self.impulses();
        let impulses = [0, 1, 2].map(|row| after[row] - before[row]);
        self.around += impulses[2];
        for (k, impulse) in self.on_bodies(&impulses).into_iter().enumerate() {
            (0..3).for_each(|c| self.change[k][c] += impulse[c]);
            bodies[self.bodies[k] as usize].push(impulse);
        }
    }

    /// Takes the impulses of an answer. Returns the impulses on both bodies.
    pub(super) fn take_answer(&mut self, parts: [Parts; 3]) -> [Vector; 2] {
        let before = self.impulses();
        self.answer = [0, 1, 2].map(|row| parts[row].iter().sum::<f64>() - before[row]);
        self.on_bodies(&self.answer)
    }

    /// Adds a part of the answer to the impulses of the step. The next one does not start from it.
    pub(super) fn add_answer(&mut self, part: f64) {
        let answer = self.answer.map(|impulse| part * impulse);
        let impulses = self.on_bodies(&answer);
        for (change, impulse) in self.change.iter_mut().zip(impulses) {
            (0..3).for_each(|c| change[c] += impulse[c]);
        }
        self.around += answer[2];
        self.answer = [0.0; 3];
    }

    /// The impulses on both bodies in the step.
    pub(super) fn applied(&self) -> [Vector; 2] {
        [0, 1].map(|k| [0, 1, 2].map(|c| self.applied[k][c] + self.change[k][c]))
    }

    /// Adds up the impulses that have moved the bodies, after the move of a sub-step.
    pub(super) fn weigh(&mut self) {
        let impulses = self.applied();
        for (weighted, applied) in self.weighted.iter_mut().zip(impulses) {
            (0..3).for_each(|c| weighted[c] += applied[c]);
        }
    }
}
