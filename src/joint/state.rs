//! The state of joints that steps change.

use alloc::vec::Vec;

use super::JointKind;
use crate::codec::{self, Encoder, Malformed, Read, Reader, StateHasher, codec_enum};
use crate::fx::Fx;
use crate::kernel::wide::{mul_128, mul_shift_64};
use crate::math::TimeStep;
use crate::scalar::{Scalar, Turn};
use crate::solve::Impulses;

/// The state of a joint: the impulses that the next step starts from, and whether it is broken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct JointState {
    /// Multiples of the unit, on the second body over the last sub-step: of revolute joints and welds along x and y, and around; of prismatic,
    /// wheel and motor joints along and across the axis, and around; of a distance joint along the line from the first end to the
    /// second, of a pulley along its rope, and 0.
    pub(crate) impulses: [i64; 3],
    /// The number of the tooth of a ratchet that is engaged, from angle 0 in its direction; 0 without one.
    pub(crate) tooth: i32,
    /// Whole turns of the angle, beside the nearest turn; 0 where none are counted.
    pub(crate) turns: i16,
    /// log2 of the unit, N·s, of the axis N·m·s; 0 without impulses.
    pub(crate) exponent: i8,
    pub(crate) is_broken: bool,
}

// The state is copied with every snapshot.
const _: () = assert!(size_of::<JointState>() == 32);

/// The largest impulse, units.
const LARGEST: u64 = 1 << 62;

impl JointState {
    pub(crate) fn impulses(&self) -> Impulses {
        Impulses { values: self.impulses, exponent: self.exponent.into() }
    }

    /// Sets the impulses, as near as the unit can have them.
    pub(crate) fn set_impulses(&mut self, impulses: Impulses) {
        self.impulses = impulses.values;
        self.exponent = if self.impulses == [0; 3] { 0 } else { impulses.exponent.clamp(-128, 127) as i8 };
    }

    pub(crate) fn clear_impulses(&mut self) {
        (self.impulses, self.exponent) = ([0; 3], 0);
    }

    /// The forces of the impulses, N and N·m, in a world with this number of sub-steps. *Error* ½ ulp; the largest number where one does not
    /// fit.
    pub(crate) fn forces(&self, time_step: TimeStep, substeps: u32) -> [Fx; 3] {
        let (num, den) = time_step.seconds();
        let (rate, seconds) = (u128::from(den) * u128::from(substeps), u128::from(num));
        self.impulses.map(|impulse| {
            // Below 2^63 · 2^36, from units of 2^exponent to 2^-32 N.
            let product = u128::from(impulse.unsigned_abs()) * rate;
            let size = match i32::from(self.exponent) + 32 {
                up @ 0.. if product.leading_zeros() > up as u32 => ((product << up) + seconds / 2) / seconds,
                0.. => u128::MAX,
                // Below 2^32 · 2^95.
                down @ -95.. => (product + (seconds << -down) / 2) / (seconds << -down),
                _ => 0,
            };
            let bits = i64::try_from(size).unwrap_or(i64::MAX);
            Fx::from_bits(if impulse < 0 { -bits } else { bits })
        })
    }

    fn to_bytes(self) -> [u8; 32] {
        let mut bytes = [0; 32];
        bytes[0] = self.exponent as u8;
        bytes[1] = self.is_broken.into();
        bytes[2..4].copy_from_slice(&self.turns.to_le_bytes());
        bytes[4..8].copy_from_slice(&self.tooth.to_le_bytes());
        bytes[8..].copy_from_slice(self.impulses.map(i64::to_le_bytes).as_flattened());
        bytes
    }

    /// Encodes the state of a joint of this kind.
    pub(crate) fn write<S: Scalar>(&self, kind: &JointKind<S>, out: &mut impl Encoder) {
        let &Self { impulses: [x, y, torque], tooth, turns, .. } = self;
        codec::field(out, "exponent", &self.exponent);
        codec::field(out, "broken", &self.is_broken);
        codec::field(
            out,
            "impulses",
            &match kind {
                JointKind::Distance(_) | JointKind::Pulley(_) => JointImpulses::Distance { along: x },
                _ if kind.has_frame() => JointImpulses::Slider { along: x, across: y, torque, turns },
                _ if kind.ratchet().is_some() => JointImpulses::Ratchet { x, y, torque, turns, tooth },
                _ if kind.axis().is_some() => JointImpulses::Axis { x, y, torque, turns },
                _ => JointImpulses::Revolute { x, y },
            },
        );
    }

    /// Decodes the state of a joint of this kind.
    pub(crate) fn read<S: Scalar>(kind: &JointKind<S>, reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        let malformed = reader.malformed("the state of a joint of its kind");
        let exponent = i8::read(reader)?;
        let is_broken = bool::read(reader)?;
        let has_axis = kind.axis().is_some();
        let active = kind.active_rows();
        let has_ratchet = kind.ratchet().is_some();
        let (impulses, turns, tooth) = match (kind, JointImpulses::read(reader)?) {
            (JointKind::Distance(_) | JointKind::Pulley(_), JointImpulses::Distance { along }) => ([along, 0, 0], 0, 0),
            (_, JointImpulses::Slider { along, across, torque, turns }) if kind.has_frame() => {
                ([along, across, torque], turns, 0)
            }
            (_, JointImpulses::Ratchet { x, y, torque, turns, tooth }) if has_ratchet => ([x, y, torque], turns, tooth),
            (
                JointKind::Revolute(_) | JointKind::Weld(_) | JointKind::Gear(_),
                JointImpulses::Axis { x, y, torque, turns },
            ) if has_axis && !has_ratchet => ([x, y, torque], turns, 0),
            (JointKind::Revolute(_), JointImpulses::Revolute { x, y }) if !has_axis => ([x, y, 0], 0, 0),
            _ => return Err(malformed),
        };
        // A joint without impulses has no unit, and a broken one has none.
        let is_canonical = if impulses == [0; 3] { exponent == 0 } else { !is_broken };
        let fits = (0..3).all(|row| impulses[row] == 0 || active[row] && impulses[row].unsigned_abs() <= LARGEST);
        let are_counted = (turns == 0 || kind.counts_turns()) && turns != i16::MIN && tooth.unsigned_abs() <= TEETH;
        if is_canonical && fits && are_counted {
            Ok(Self { impulses, tooth, turns, exponent, is_broken })
        } else {
            Err(malformed)
        }
    }
}

/// The largest number of a tooth: of 2^15 turns of a ratchet with 2^10 teeth.
const TEETH: u32 = 1 << 25;

/// 2π in units of 2^-61.
const TAU: u64 = 0xc90f_daa2_2168_c235;

/// The angle of a joint, rad, of the angle between its frames and whole turns. *Error* ½ ulp.
pub(crate) fn position(angle: Turn, turns: i16) -> Fx {
    // Below 2^79: it fits.
    Fx::from_bits(mul_shift_64(unwrapped(angle, turns), TAU, 93).unwrap_or(0) as i64)
}

/// The angle of a joint in 2^-64 turns.
fn unwrapped(angle: Turn, turns: i16) -> i128 {
    (i128::from(turns) << 64) + i128::from(angle.to_bits() as i64)
}

/// The number of the tooth of a ratchet with this number of teeth that its angle engages, from angle 0 in its direction: within 2^-20 of the way
/// to it already.
pub(crate) fn tooth_at(teeth: i16, angle: Turn, turns: i16) -> i32 {
    // Below 2^79 · 2^10, and 2^25 teeth.
    ((unwrapped(angle, turns) * i128::from(teeth) + (1 << 44)) >> 64) as i32
}

/// The angle of a tooth of a ratchet, rad. *Error* 1 ulp.
pub(crate) fn stop(teeth: i16, tooth: i32) -> Fx {
    // Odd: within 2^89, as there are at most 2^25 teeth.
    let turns = (i128::from(tooth) << 64) / i128::from(teeth);
    Fx::from_bits(mul_shift_64(turns, TAU, 93).unwrap_or(0) as i64)
}

/// The whole turns of a joint whose angle has gone from one angle between its frames to another, by about this much in 2^-64 turns: within
/// half a turn.
pub(crate) fn turns_after(turns: i16, from: Turn, to: Turn, change: i128) -> i16 {
    let apart = unwrapped(from, turns) + change - i128::from(to.to_bits() as i64);
    let nearest = (apart + (1 << 63)) >> 64;
    // Odd: an image counts as many the other way round.
    let largest = i128::from(i16::MAX);
    nearest.clamp(-largest, largest) as i16
}

/// The impulses of a joint in a file, and what else its axis has.
enum JointImpulses {
    Revolute { x: i64, y: i64 },
    Distance { along: i64 },
    Axis { x: i64, y: i64, torque: i64, turns: i16 },
    Slider { along: i64, across: i64, torque: i64, turns: i16 },
    Ratchet { x: i64, y: i64, torque: i64, turns: i16, tooth: i32 },
}

codec_enum!(JointImpulses, "the number of the impulses of a joint", {
    0 => Revolute { x, y },
    1 => Distance { along },
    2 => Axis { x, y, torque, turns },
    3 => Slider { along, across, torque, turns },
    4 => Ratchet { x, y, torque, turns, tooth },
});

/// The state of the joints of a world that steps change.
#[derive(Debug, Default)]
pub(crate) struct JointStates {
    /// By the index of the joint in its set.
    pub(crate) list: Vec<JointState>,
    /// The tick of the last step in which a joint had an impulse, counted a turn or broke; 0 if there was none.
    pub(crate) pulled_at: u64,
}

clone_by_field!([] JointStates { list, pulled_at });

impl JointStates {
    /// Scales all impulses by the ratio of the length of two sub-steps, num/den: the forces stay the same.
    pub(crate) fn rescale(&mut self, num: u64, den: u64) {
        for state in &mut self.list {
            state.set_impulses(state.impulses().rescaled(num, den));
        }
    }

    /// Breaks a joint in the step to a tick.
    pub(crate) fn break_joint(&mut self, index: usize, tick: u64) {
        self.list[index] = JointState { is_broken: true, ..JointState::default() };
        self.pulled_at = tick;
    }

    /// Counts the whole turns of a joint whose angle has gone from one angle to another by less than half a turn.
    pub(crate) fn turn(&mut self, index: usize, from: Turn, to: Turn) {
        let change = to.to_bits().wrapping_sub(from.to_bits()) as i64;
        let turns = &mut self.list[index].turns;
        *turns = turns_after(*turns, from, to, change.into());
    }

    /// Engages the tooth of a ratchet with this number of teeth at an angle.
    pub(crate) fn engage(&mut self, index: usize, ratchet: Option<i16>, angle: Turn) {
        let state = &mut self.list[index];
        state.tooth = ratchet.map_or(0, |teeth| tooth_at(teeth, angle, state.turns));
    }

    /// Drops the impulses of joints, by their indices.
    pub(crate) fn relax(&mut self, indices: impl Iterator<Item = usize>) {
        indices.for_each(|index| self.list[index].clear_impulses());
    }

    /// Adds the states to a hash, in the order of their indices.
    pub(super) fn write(&self, index: usize, sink: &mut StateHasher) {
        sink.bytes(&self.list[index].to_bytes());
    }
}

/// Returns true if the mean force of an impulse over a step is larger than this force, N. The impulse is in 2^-32 N·s, along x and y.
/// Likewise for a torque.
///
/// # Ranges
/// Of an impulse beyond ±2^94 units a component this tells that it is larger, which it is: forces are below 2^31 N and steps take up to a
/// second. Times the denominator of the step components are below 2^126: the sum of two squares is below 2^253.
pub(crate) fn exceeds(impulse: [i128; 2], force: Fx, time_step: TimeStep) -> bool {
    let (num, den) = time_step.seconds();
    let square = |value: u128| mul_128(value, value);
    let [x, y] = impulse.map(|part| square(part.unsigned_abs().min(1 << 94) * u128::from(den)));
    let (low, carry) = x.1.overflowing_add(y.1);
    let pull = (x.0 + y.0 + u128::from(carry), low);
    pull > square(u128::from(force.to_bits().unsigned_abs()) * u128::from(num))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tooth beyond the turns that are counted, or a turn without an opposite, is no state of a ratchet.
    #[test]
    fn impossible_teeth_are_refused() {
        use crate::joint::Revolute;

        let kind: JointKind = JointKind::Revolute(Revolute { ratchet: Some(12), ..Revolute::default() });
        let read = |tooth: i32, turns: i16| {
            let mut bytes = Vec::new();
            JointState { tooth, turns, ..JointState::default() }.write(&kind, &mut bytes);
            JointState::read(&kind, &mut Reader::new(&bytes)).is_ok()
        };
        assert!(read(0, 0) && read(1 << 25, 32_767) && read(-(1 << 25), -32_767));
        assert!(!read((1 << 25) + 1, 0) && !read(i32::MIN, 0) && !read(0, i16::MIN));
    }

    /// A joint that stands at a tooth but for the last bits of its angle engages it, in both directions.
    #[test]
    fn a_tooth_is_engaged_where_it_stands() {
        let turn = |bits: i64| Turn::from_bits(bits as u64);
        let twelfth = (1_i64 << 62) / 3;
        for (bits, tooth) in [(0, 0), (-9, 0), (twelfth - 9, 1), (twelfth - (1 << 50), 0), (-twelfth, -1)] {
            assert_eq!((tooth_at(12, turn(bits), 0), tooth_at(-12, turn(-bits), 0)), (tooth, tooth), "{bits}");
        }
        assert_eq!((tooth_at(12, turn(0), 7), tooth_at(-12, turn(0), -7)), (84, 84));
    }

    /// Both ends of the range are opposite.
    #[test]
    fn turns_are_counted_alike_in_both_directions() {
        let quarter = Turn::from_bits(1 << 62);
        let opposite = Turn::from_bits(quarter.to_bits().wrapping_neg());
        for turns in [0, 5, 32_766, 32_767] {
            for change in [1 << 62, 1 << 64, 3 << 64, 1 << 80] {
                let forwards = turns_after(turns, Turn::default(), quarter, change);
                let backwards = turns_after(-turns, Turn::default(), opposite, -change);
                assert_eq!(forwards, -backwards, "{turns} {change}");
            }
        }
    }

    /// The mean force is compared to the last unit of the impulse: 3 and 4 N give 5 N over a second, and over any other step.
    #[test]
    fn one_unit_of_impulse_decides() {
        for (num, den) in [(1, 1), (1, 60), (1001, 60_000), (1, 10_000)] {
            let time_step = TimeStep::ratio(num, den);
            let (num, den) = time_step.seconds();
            // 3·den N over num/den s.
            let impulse = [3, -4].map(|part| (part * i128::from(num)) << 32);
            let force = crate::fx!(5).to_bits() * i64::from(den);
            assert!(!exceeds(impulse, Fx::from_bits(force), time_step));
            assert!(exceeds(impulse, Fx::from_bits(force - 1), time_step));
            assert!(exceeds([impulse[0] + 1, impulse[1]], Fx::from_bits(force), time_step));
        }
        assert!(exceeds([i128::MIN, i128::MAX], Fx::MAX, TimeStep::hz(1)));
        assert!(!exceeds([0; 2], Fx::ZERO, TimeStep::hz(60)));
    }
}
