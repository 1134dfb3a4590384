//! Whole turns of the angles of joints, the teeth of ratchets, and motors that turn.
//!
//! The angle between two bodies is exact but for whole turns. These follow from the velocities of the step, which tell the angle that a body
//! has turned to within half a turn: it is asked for at most once in a step, and the angle since then is exact.

use super::super::Step;
use super::ContactMemory;
use crate::contact::Start;
use crate::fx::Fx;
use crate::joint::{tooth_at, turns_after};
use crate::kernel::wide::mul_shift_64;
use crate::math::Vec2;
use crate::scalar::{Accumulator, Angle as _, Scalar, Turn};
use crate::solve::Axis;

/// 1/2π in 2^-66.
const TURNS_A_RADIAN: u64 = 0xa2f9_836e_4e44_1529;

impl<S: Scalar> Step<'_, S> {
    /// Counts the whole turns of the joints of the step, and engages the teeth that ratchets have passed.
    pub(super) fn count_turns(&mut self, memory: &ContactMemory<S>) {
        for (index, flights) in memory.pipeline.joints().ends() {
            let index = index as usize;
            let link = self.contacts.joints.link(index);
            if !link.counts_turns {
                continue;
            }
            // Bodies that move have the first flights. All others do not turn.
            let starts = flights.map(|flight| memory.starts.get(flight as usize));
            let [first, second] = starts.map(|start| start.map_or(0, |start| self.turned(start)));
            let slots = [0, 1].map(|side| link.ends[side].slot());
            let now = [0, 1].map(|side| match (starts[side], slots[side]) {
                (Some(start), _) => self.bodies.columns.motion.angle[start.dense].to_turn(),
                (None, Some(slot)) => self
                    .bodies
                    .index_in(slot)
                    .map_or(Turn::default(), |dense| self.bodies.columns.motion.angle[dense].to_turn()),
                (None, None) => Turn::default(),
            });
            let before = [0, 1].map(|side| starts[side].map_or(now[side], |start| start.angle.to_turn()));
            let (from, to) = (link.angle(before), link.angle(now));
            let states = &mut *self.contacts.joint_states;
            let state = &mut states.list[index];
            let turns = turns_after(state.turns, from, to, second - first);
            let tooth = link.ratchet.map_or(0, |teeth| state.tooth.max(tooth_at(teeth, to, turns)));
            if (turns, tooth) != (state.turns, state.tooth) {
                // A step that is undone would not count back.
                (state.turns, state.tooth, states.pulled_at) = (turns, tooth, self.settings.tick);
            }
        }
    }

    /// Keeps bodies awake that a motor turns or pushes, at half of its speed at least: slow clocks would stop. A motor that is held may sleep.
    pub(super) fn keep_driven_awake(&mut self, memory: &ContactMemory<S>) {
        for (index, flights) in memory.pipeline.joints().ends() {
            let link = self.contacts.joints.link(index as usize);
            let speed = |law: Option<Axis>| law.map_or(Fx::ZERO, |law| law.motor_speed.abs());
            let (turning, pushing) = (speed(link.axis), speed(link.slides[0]).max(speed(link.slides[1])));
            if turning == Fx::ZERO && pushing == Fx::ZERO {
                continue;
            }
            let starts = flights.map(|flight| memory.starts.get(flight as usize));
            let motion = &mut self.bodies.columns.motion;
            let velocities = starts.map(|start| {
                start.map_or([Fx::ZERO; 3], |start| {
                    let Vec2 { x, y } = motion.velocity.get(start.dense);
                    [x, y, motion.angular_velocity[start.dense]].map(|part| part.value().to_fx())
                })
            });
            // Speeds are within 2^20 m/s and rad/s.
            let is_half = |part: usize, speed: Fx| {
                let difference = (velocities[1][part] - velocities[0][part]).abs();
                speed > Fx::ZERO && difference + difference >= speed
            };
            let is_driven = is_half(2, turning) || is_half(0, pushing) || is_half(1, pushing);
            for start in starts.into_iter().flatten().filter(|_| is_driven) {
                motion.ticks_at_rest[start.dense] = 0;
            }
        }
    }

    /// The angle that a body has turned in the step at the mean of its velocities, in 2^-64 turns. *Error* less than half a turn, unless its velocity
    /// has changed by more than a turn in a step.
    fn turned(&self, start: &Start<S>) -> i128 {
        let end = self.bodies.columns.motion.angular_velocity[start.dense];
        let [start, end] = [start.angular_velocity, end].map(|velocity| velocity.value().to_fx().to_bits());
        let (num, den) = self.settings.time_step.seconds();
        // Below 2^54 rad/s in 2^-32, a step takes up to a second: below 2^86 and 2^96.
        let radians = (i128::from(start) + i128::from(end)) * i128::from(num) / i128::from(2 * u64::from(den));
        mul_shift_64(radians, TURNS_A_RADIAN, 34).unwrap_or(0)
    }
}
