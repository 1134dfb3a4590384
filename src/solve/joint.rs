//! Joints: points of two bodies that stay together, or at a distance.
//!
//! A joint has up to three rows in a frame: along its two axes, and around. Each row is free, or *held* at zero, or has a [law](axis) of limits,
//! motor, friction and spring:
//!
//! | kind | frame | along | across | around |
//! |---|---|---|---|---|
//! | `Revolute` | the world's axes | held | held | law |
//! | `Distance` | the line between the points | held at a length | | |
//! | `Line` | the line between the points | law | | |
//! | `Slider` | turns with the first body | law | held | law |
//! | `Planar` | turns with the first body | law | law | law |
//! | `Gear` | | | | law of a sum of angles |
//! | `Pulley` | a line for each body | law of a sum of lengths | | |
//!
//! Each row has an axis and, for each body, the cross product of its arm with the axis; impulses act along the axes, of a slider and a planar
//! joint at the second point on both bodies. Arms and axes turn with the bodies in every sub-step, unlike the arms of contacts, by the angle since the start of the
//! step: frozen, a rod that spins on a pin at 10 rad/s would lose 60 % of its energy in a second.
//!
//! - *Solve pass*: the rows aim at the velocity that takes a part of the error away, and at the terms of second and third order of the motion:
//!   bodies move on straight lines within a sub-step while points turn on circles, so a velocity along the circle would leave it by h·ω²·r/2, and be
//!   ahead on it by h²·ω³·r/6.
//!   *Relax pass*: they aim at zero.
//! - *Warm start*: in every sub-step, as arms turn. From the second on the body's velocity already has once more the changes of the
//!   sub-step before ([`Begin`](super::motion::Begin)), also the changes by joints; so a joint adds the difference between its impulse at
//!   the present arms and its change in the sub-step before. A body with joints and contacts gets both right, and a body without joints
//!   pays nothing.
//! - *Trees*: joined bodies without a closed ring are solved at once, exactly (`tree`, in the order of `forest`). A joint gives way by 2^-11 of
//!   its inverse mass, and takes a tenth of its error away in a sub-step or, in a tree that touches nothing, three tenths; a tree
//!   with contacts, rings or two supports in its island that bears a load of more than 64 times a mass gives way by 2^-7, or its bodies would swing
//!   across the tension. Trees that touch nothing have no relax pass.
//! - *Loops*: all others are solved by three iterations of conjugate gradients a pass (`gradients`), as springs and dampers of the frequency and
//!   damping ratio of [`SolverOptions`](super::SolverOptions).
//! - *Paths*: joints hold points where the bodies really are, so they must know where a body without further impulses ends
//!   ([`Path`](super::apply::Path)).
//! - *Impacts*: joints answer the impulses of contacts within an impact (`impact`), before their passes.
//! - *Sums*: each block adds up its impulses with the arms that they had, exactly; `apply` hands them to the bodies once.
//!
//! # Ranges
//! Values are in units of the island: u for velocities, u·h for lengths, [`Block::exponent`] for impulses.
//! - Arms over the length of the body are within ±2^30 in each component, so that axes are within 2^30 and cross products within 2^30.5.
//! - The velocity of a row is below (√2·2^28 + 2·√2·2^27) = 2^29.5, times 2^30; the error is within ±2^30 ([`ERROR`]), times a rate below
//!   2^30. The second-order terms are at most 0.1·√2·2^27 a body and 0.1·2^29.5 for the rod, the offsets of free flights along the row at
//!   most (√2·2^29 + 2·√2·2^28) = 2^30.5, times 2^30. The sum is below 2^62.
//! - Impulses are within ±2^50 ([`IMPULSE`]). Their unit follows from the lightest row, and is coarser where so many would not hold the heaviest body: a
//!   weight of 1,000 kg at 100 m on an arm of 1 kg. A sub-step has the impulse of the solve pass at one axis and the change of the relax pass
//!   at another, for both rows together at most 3·2^50·2^31 = 2^82.6. Lowered by 20 bits, times a mass of at most 2^44, this is below
//!   2^107. Weighted sums over 16 sub-steps are at most 136 times as much: below 2^90; with impacts, up to 64 in a sub-step, below 2^97.
//! - Changes of velocity by a joint in a sub-step are below 2^100 in 2^-30, and their sum for a body is within ±2^61 ([`gains`]); in an impact they
//!   are within ±2^58 ([`GAIN`]) and 2^61 over the number of joints at the body.
//! - Offsets of points are within ±2^60 ([`FAR`]): 2^20 m at 160,000 sub-steps a second.

mod axis;
mod effective;
mod energy;
mod forest;
mod gains;
mod gradients;
mod impact;
mod kind;
mod laws;
mod loads;
mod passes;
mod paths;
mod residual;
#[cfg(test)]
mod tests;
mod tree;
mod turn;

use alloc::vec::Vec;

use self::axis::AxisRow;
use self::gains::Sums;
use self::turn::{Pose, Side};
use super::bodies::{SolverBody, largest_exponent};
use super::motion::{Rows, Vector};
use super::number::{bits_of, lowered, lowered_word, shifted, shifted_word};
use super::unit::Clock;
use super::{Flight, Impulses, StepInput};
use crate::fx::Fx;
use crate::kernel::sqrt::direction;
use crate::kernel::trig::sin_cos_turn;
use crate::math::Vec2;
use crate::scalar::{FxFactor, Turn};
use crate::slots::NONE;

pub use self::axis::{Axis, AxisSpring};
#[cfg(feature = "float")]
pub(super) use self::forest::Forest;
pub(super) use self::impact::{Response, StopSpeeds};
pub use self::kind::JointKind;
#[cfg(feature = "float")]
pub(super) use self::loads::Loads;
pub(super) use self::passes::Joints;
#[cfg(feature = "float")]
pub(super) use self::paths::find_paths;

/// Factors of masses have this many bits relative to the largest of a joint.
const MASS_BITS: i32 = 44;
/// A unit of impulse changes the velocity of a row by at most 2^-8, unless it is [coarser](unit_shift).
const FINER: i32 = 8;
/// The largest error of a row.
const ERROR: i64 = 1 << 30;
/// The largest impulse.
const IMPULSE: i64 = 1 << IMPULSE_BITS;
const IMPULSE_BITS: i32 = 50;
/// Impulses reach far enough to change the velocity of the heaviest body of a joint by 2^REACH units in a sub-step.
const REACH: i32 = 22;
/// The largest [`unit_shift`]; and of pins in loops, whose compliance has no more room in words.
const MAX_SHIFT: i32 = 24;
const MAX_SHIFT_IN_LOOP: i32 = 5;
/// The largest change of velocity in an impact, 2^28 in 2^-30.
const GAIN: i64 = 1 << 58;
/// Bits by which the products of impulses and axes are lowered, before the products with masses.
const LOWER: i32 = 20;
/// The largest component of an offset.
const FAR: i128 = 1 << 60;

/// A joint of two bodies, at the start of the step.
#[derive(Clone, Copy, Debug)]
pub struct Joint {
    /// Indices of flights.
    pub bodies: [u32; 2],
    /// The points that it joins: from the centre of mass of the first and of the second body, m. *Domain* they lie within the
    /// [`radius`](Flight::radius) of their body.
    pub anchors: [Vec2; 2],
    /// The quantity that it keeps.
    pub kind: JointKind,
    /// The law of the angle of a revolute joint, a slider or a planar joint, if something acts on it. A body that cannot turn then has at least the
    /// [`radius`](Flight::radius) of the other body.
    pub axis: Option<Axis>,
    /// The laws of the distance along the axis of a slider or along a line, and of both distances of a planar joint, if something acts on them. The
    /// radius of the first body of a slider or a planar joint reaches the second anchor.
    pub slides: [Option<Axis>; 2],
    /// The impulses on the second body in the last sub-step of the step before, by which the solver starts; then the impulses of this step.
    /// Of a revolute joint along x and y, and around, N·m·s; of a slider and a planar joint along and across the axis, and around; of the other
    /// kinds along the line from the first anchor to the second.
    pub impulses: Impulses,
}

impl Joint {
    /// The offset from the first anchor to the second, in 2^-32 m.
    pub(crate) fn offset(&self, flights: &[Flight]) -> [i128; 2] {
        let [from, to] = [0, 1].map(|side| point_of(&flights[self.bodies[side] as usize], self.anchors[side]));
        [to[0] - from[0], to[1] - from[1]]
    }

    /// The ways along the axes of its slides, m: [`JointKind::ways`], and of a pulley the length of its rope, over the larger number of strands.
    pub(crate) fn ways(&self, flights: &[Flight]) -> [Fx; 2] {
        let JointKind::Pulley { grounds, .. } = self.kind else { return self.kind.ways(self.offset(flights)) };
        let ways = [0, 1].map(|k| rope_way(&flights[self.bodies[k] as usize], self.anchors[k], grounds[k]));
        [self.kind.rope_length(ways), Fx::ZERO]
    }

    /// A speed at which its error is taken away, in 2^-32 m/s: at most half of the error in a sub-step.
    pub(super) fn repair_speed(&self, clock: &Clock, flights: &[Flight]) -> u128 {
        let [x, y] = self.offset(flights).map(|c| c.clamp(-FAR, FAR) as i64);
        let error = match self.kind {
            JointKind::Revolute => x.abs().max(y.abs()),
            JointKind::Distance { length } => length_of(x, y).abs_diff(length.to_bits()) as i64,
            JointKind::Line | JointKind::Planar { .. } | JointKind::Gear { .. } | JointKind::Pulley { .. } => 0,
            JointKind::Slider { angle } => {
                let [ux, uy] = direction_of(angle).map(i128::from);
                lowered(ux * i128::from(y) - uy * i128::from(x), 30).unsigned_abs() as i64
            }
        };
        let repair = clock.length_of_bits(error.into(), -32).unsigned_abs() >> 1;
        let ends = self.bodies.map(|body| &flights[body as usize]);
        let around = self.axis.as_ref().zip(axis_length(ends)).map_or(0, |(law, length)| {
            // Springs alone ask for it.
            let inertia = law.spring.and_then(|_| self.effective_inertia(ends)).unwrap_or(FxFactor::ONE);
            law.speed(inertia, length, clock)
        });
        if self.slides == [None; 2] {
            return repair.max(around);
        }
        let mass = self.effective_mass(ends, self.offset(flights));
        let along = self.slides.iter().flatten().map(|law| mass.map_or(0, |mass| law.speed(mass, 0, clock)));
        along.fold(repair.max(around), u128::max)
    }
}

/// A vector in 2^-32 m.
fn vector_bits(vector: Vec2) -> [i128; 2] {
    [vector.x, vector.y].map(|part| part.to_bits().into())
}

/// The point of a body at an anchor, in 2^-32 m.
fn point_of(flight: &Flight, anchor: Vec2) -> [i128; 2] {
    let ([x, y], [arm_x, arm_y]) = (vector_bits(flight.position), vector_bits(anchor));
    [x + arm_x, y + arm_y]
}

/// The way from a point of the world to a point of a body, in 2^-32 m.
pub(super) fn rope_way(flight: &Flight, anchor: Vec2, ground: Vec2) -> [i128; 2] {
    let ([x, y], [ground_x, ground_y]) = (point_of(flight, anchor), vector_bits(ground));
    [x - ground_x, y - ground_y]
}

/// The direction at an angle, in 2^-30.
fn direction_of(angle: Turn) -> [i64; 2] {
    let (sin, cos) = sin_cos_turn(angle.to_bits());
    [cos, sin].map(|part| lowered(part.into(), 32) as i64)
}

/// log2 of the length at which the velocities of the angle between two bodies are taken, m: of the shorter body that can turn. `None` if none
/// can.
fn axis_length(flights: [&Flight; 2]) -> Option<i32> {
    let turning = flights.into_iter().filter(|flight| !flight.inverse_inertia.is_zero());
    turning.map(|flight| flight.length()).min()
}

/// log2 of the length of the longer body, m.
fn longest(flights: [&Flight; 2]) -> i32 {
    flights[0].length().max(flights[1].length())
}

/// Bits by which the unit of impulses has to be coarser than the lightest row asks for, so that they can hold the heaviest body, for the bits of
/// the largest mass factor. A row around has the moment of the force at the end of the longest arm, counted at the length of the shorter body: so many
/// bits are added.
fn unit_shift(sides: &[Side; 2], mass_bits: i32) -> i32 {
    let masses = sides.iter().flat_map(|side| [side.masses[0], side.masses[1]]);
    let heaviest = masses.filter(|&mass| mass != 0).min();
    heaviest.map_or(0, |mass| mass_bits - bits_of(mass) + FINER + REACH - IMPULSE_BITS)
}

/// The axes of the rows of a joint.
#[derive(Clone, Copy, Debug)]
enum Frame {
    /// Along x and y.
    World,
    /// Along the offset of the points.
    Line,
    /// Along a direction that turns with the first body: at the start, in 2^-30.
    Body([i64; 2]),
    /// Along the ways from two points of the world, for a body each: the second body has the axis of the second row, which is free.
    Ropes {
        /// The way to the second body at the start, without its arm.
        second_base: [i64; 2],
        /// The velocities of both points in the velocity of the rope, in 2^-30.
        factors: [i64; 2],
    },
}

/// A direction turned left by a quarter.
fn perpendicular([ux, uy]: [i64; 2]) -> [i64; 2] {
    [-uy, ux]
}

/// The component of a vector along a direction in 2^-30.
fn along([ux, uy]: [i64; 2], [x, y]: [i64; 2]) -> i64 {
    lowered(i128::from(ux) * i128::from(x) + i128::from(uy) * i128::from(y), 30) as i64
}

/// The length of a vector, to nearest. *Domain* of [`direction`]; zero is fine.
fn length_of(x: i64, y: i64) -> i64 {
    if (x, y) == (0, 0) { 0 } else { direction(x, y).1 as i64 }
}

/// A joint as the passes see it: through the sub-steps in place of a [`Joint`].
///
/// Passes go over many blocks that caches do not hold: so all that joints that hold a point need in a pass stands at the front, then all that their
/// moves need, and the rest behind.
#[derive(Clone, Debug)]
#[repr(C)]
pub(super) struct Block {
    sides: [Side; 2],
    /// Cross products of arms and axes by row and body, in 2^-30 of the bodies' lengths.
    crosses: [[i64; 2]; 3],
    /// Impulses of the sub-step, by row.
    pub(super) impulses: [i64; 3],
    /// The sum of the impulses around of all sub-steps and impacts: below 2^60.
    around: i64,
    /// Errors of the rows.
    errors: [i64; 2],
    /// The number of bits of the largest mass factor of a row, less the bits by which the unit of impulses is coarser.
    mass_bits: i32,
    /// The laws of rows by their numbers, [`NONE`] for rows without: along the axes of the frame, and around.
    laws: [u32; 3],
    /// The rows that the joint holds at zero.
    held: [bool; 2],
    /// True for rows that are not free.
    is_active: [bool; 3],
    /// True if the displacement of a row differs from the displacement of its body.
    is_shifted: bool,
    /// True if it has impulses of an impact in its sums.
    is_struck: bool,
    /// The impulses applied in the sub-step.
    change: Sums,
    /// Sums of the changes of all sub-steps, of the present one from its move on.
    pub(super) applied: Sums,
    /// Sums over sub-steps of the changes applied up to the move.
    pub(super) weighted: Sums,
    frame: Frame,
    /// The offset from the first anchor to the second at the start, without both arms.
    base: [i64; 2],
    /// The lengths that the errors of rows along the axes are counted from: lengths that are held, or lengths at the start.
    lengths: [i64; 2],
    /// Axes of the rows, in 2^-30.
    axes: [[i64; 2]; 3],
    /// The distance of the anchors.
    distance: i64,
    /// The number of the rope of a pulley; [`NONE`] for other joints.
    rope: u32,
    /// Index of the joint.
    pub(super) joint: u32,
    /// log2 of the length at which the velocities of the third row are taken, m.
    axis_length: i32,
    /// The number of sub-steps.
    substeps: i32,
    /// log2 of the unit of its impulses, N·s.
    pub(super) exponent: i32,
    /// log2 of that unit over the unit of velocity, kg.
    mass_exponent: i32,
}

impl Block {
    /// Prepares a joint that can move a body, in the unit of its island, and adds its laws.
    fn new(
        index: usize,
        input: &StepInput<'_>,
        bodies: [&SolverBody; 2],
        poses: [&Pose; 2],
        shares: [i64; 2],
        unit: i32,
        is_in_loop: bool,
        laws: &mut Vec<AxisRow>,
    ) -> Self {
        let StepInput { clock, flights, joints, .. } = *input;
        let joint = &joints[index];
        let scale = MASS_BITS - largest_exponent(bodies).unwrap_or(0);
        let mut sides = [0, 1].map(|k| {
            let flight = &flights[joint.bodies[k] as usize];
            Side::new(flight, poses[k], shares[k], joint.anchors[k], scale, unit, clock)
        });
        let flights = joint.bodies.map(|body| &flights[body as usize]);
        let offset_bits = joint.offset(input.flights);
        let offset = offset_bits.map(|c| clock.length_of_bits(c, unit).clamp(-FAR, FAR) as i64);
        let turns_frame = joint.kind.frame_angle().is_some();
        if turns_frame {
            sides[0].reach(offset);
        }
        // Locks may leave nothing that it moves.
        let mut largest_mass = (sides[0].largest_mass() + sides[1].largest_mass()).max(1);
        if turns_frame || joint.axis.is_some() {
            largest_mass = largest_mass.max(sides[0].masses[2] + sides[1].masses[2]);
        }
        let axis_length = axis_length(flights).unwrap_or(0);
        // The arm of the first body may grow to twice its length in the step.
        let mass_bits = bits_of(largest_mass) + if turns_frame { 2 } else { 0 };
        let max_shift = if is_in_loop && joint.kind == JointKind::Revolute { MAX_SHIFT_IN_LOOP } else { MAX_SHIFT };
        let lever = if joint.axis.is_some() { longest(flights) - axis_length } else { 0 };
        let mass_bits = mass_bits - unit_shift(&sides, mass_bits + lever).clamp(0, max_shift.min(mass_bits - 1));
        let mut base = [0, 1].map(|i| offset[i] - sides[1].start[i] + sides[0].start[i]);
        let mass_exponent = scale - mass_bits - FINER;
        let exponent = mass_exponent + unit;
        let is_planar = matches!(joint.kind, JointKind::Planar { .. });
        let mut add = |law: &Option<Axis>, mass: Option<FxFactor>, length: i32, is_paired: bool| {
            let (Some(law), Some(mass)) = (law, mass) else { return NONE };
            let row = AxisRow::new(law, mass, length, clock, unit, mass_exponent);
            laws.push(if is_paired { row.paired() } else { row });
            laws.len() as u32 - 1
        };
        let has_slide = joint.slides != [None; 2];
        let mass = has_slide.then(|| joint.effective_mass(flights, offset_bits)).flatten();
        let [along_law, across_law] = [0, 1].map(|row| add(&joint.slides[row], mass, 0, is_planar));
        let inertia = joint.axis.as_ref().and_then(|_| joint.effective_inertia(flights));
        let axis = add(&joint.axis, inertia, axis_length, false);
        let (frame, held, lengths) = match joint.kind {
            JointKind::Revolute => (Frame::World, [true; 2], [0; 2]),
            JointKind::Distance { length } => {
                (Frame::Line, [true, false], [clock.length(length, unit).clamp(0, FAR) as i64, 0])
            }
            JointKind::Gear { .. } => (Frame::World, [false; 2], [0; 2]),
            JointKind::Pulley { grounds, .. } => {
                let ways = [0, 1].map(|k| {
                    let way = rope_way(flights[k], joint.anchors[k], grounds[k]);
                    way.map(|c| clock.length_of_bits(c, unit).clamp(-FAR, FAR) as i64)
                });
                let second_base;
                [base, second_base] = [0, 1].map(|k| [0, 1].map(|i| ways[k][i] - sides[k].start[i]));
                let frame = Frame::Ropes { second_base, factors: joint.kind.rope_factors() };
                (frame, [false; 2], ways.map(|[x, y]| length_of(x, y)))
            }
            JointKind::Line => (Frame::Line, [false; 2], [length_of(offset[0], offset[1]), 0]),
            JointKind::Slider { angle } => {
                let direction = direction_of(angle);
                (Frame::Body(direction), [false, true], [along(direction, offset), 0])
            }
            JointKind::Planar { angle } => {
                let direction = direction_of(angle);
                let across = along(perpendicular(direction), offset);
                (Frame::Body(direction), [false; 2], [along(direction, offset), across])
            }
        };
        let laws = [along_law, across_law, axis];
        // The third row turns a body by the length at which its velocities are taken, over the length of the body.
        let [first, second] = joint.kind.angle_factors();
        let turning = [(-first, flights[0]), (second, flights[1])]
            .map(|(factor, flight)| shifted_word(factor, (flight.length() - axis_length).clamp(0, 30)));
        let is_active = [0, 1, 2].map(|row| laws[row] != NONE || row < 2 && held[row]);
        let warm = |row: usize, length: i32| {
            let impulse = if is_active[row] { joint.impulses.values[row] } else { 0 };
            let bits = (exponent + length).saturating_sub(joint.impulses.exponent).max(bits_of(impulse) - 100);
            let limit = i128::from(IMPULSE);
            match bits {
                // Within 2^62.
                1..63 => lowered_word(impulse, bits).clamp(-IMPULSE, IMPULSE),
                _ => shifted(impulse.into(), bits).clamp(-limit, limit) as i64,
            }
        };
        Self {
            sides,
            crosses: [[0; 2], [0; 2], turning],
            impulses: [warm(0, 0), warm(1, 0), warm(2, axis_length)],
            around: 0,
            errors: [0; 2],
            mass_bits,
            laws,
            held,
            is_active,
            is_shifted: false,
            is_struck: false,
            change: Sums::default(),
            applied: Sums::default(),
            weighted: Sums::default(),
            frame,
            base,
            lengths,
            axes: [[1 << 30, 0], [0, 1 << 30], [0; 2]],
            distance: 0,
            rope: NONE,
            joint: index as u32,
            axis_length,
            substeps: clock.substeps as i32,
            exponent,
            mass_exponent,
        }
    }

    /// After the move of a sub-step: adds up the changes that moved the bodies, then updates arms and matrices to their poses.
    #[inline(always)]
    fn advance(&mut self, poses: &[Pose], laws: &mut [AxisRow]) -> u64 {
        self.weigh();
        self.turn(poses, laws)
    }

    /// Returns true if the first row has an axis for each body.
    #[inline(always)]
    fn is_pulley(&self) -> bool {
        // A joint that holds a point does not have to fetch its frame.
        !self.holds_point() && matches!(self.frame, Frame::Ropes { .. })
    }

    /// The axes of a row for both bodies.
    #[inline(always)]
    fn side_axes(&self, row: usize) -> [[i64; 2]; 2] {
        [self.axes[row], if self.is_pulley() { self.axes[1] } else { self.axes[row] }]
    }

    /// Returns true if the joint holds a point: along the world's axes.
    #[inline(always)]
    fn holds_point(&self) -> bool {
        self.held == [true; 2]
    }

    /// Returns true if the joint holds a length, and nothing else.
    fn is_rod(&self) -> bool {
        self.held == [true, false]
    }

    /// The velocities of the sides.
    #[inline(always)]
    fn velocities(&self, rows: &Rows) -> [Vector; 2] {
        [0, 1].map(|k| rows.velocity(self.sides[k].row))
    }

    /// Changes the impulses of the rows, by less than 2^62, in the solve pass if `is_biased`. Returns the number of impulses that were cut off.
    #[inline(always)]
    fn change(&mut self, changes: [i64; 3], laws: &mut [AxisRow], is_biased: bool) -> u64 {
        let mut cut = 0;
        let before = self.impulses;
        for row in 0..3 {
            if self.is_active[row] {
                let wanted = before[row] + changes[row];
                let mut after = wanted.clamp(-IMPULSE, IMPULSE);
                cut += u64::from(after != wanted);
                if let Some(law) = laws.get_mut(self.laws[row] as usize) {
                    after = law.finish(after);
                }
                self.impulses[row] = after;
            }
        }
        self.push(before, is_biased);
        cut
    }
}
