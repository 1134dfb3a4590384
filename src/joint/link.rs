//! A joint as steps see it.
//!
//! Joints are in fixed point, as contacts are: a world of floats keeps the points and laws of its joints rounded to [`Fx`]. Only the solver
//! depends on the scalar.

use super::{JointDef, JointState, position, stop};
use crate::force::End;
use crate::fx::Fx;
use crate::math::Vec2;
use crate::scalar::{Angle as _, Scalar, Turn};
use crate::slots::NONE;
use crate::solve::{Axis, Flight, Joint, JointKind};

/// The place of an end of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    /// A point of the world, m.
    World(Vec2),
    /// A point of the body in a slot, in the axes of the body, from its centre of mass, m.
    Body(u32, Vec2),
}

/// An end of a joint.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LinkEnd {
    pub(crate) place: Place,
    /// The distance of the point from the centre of mass of its body, m, rounded up.
    pub(crate) reach: Fx,
    /// The neighbours in the list of the ends on the body, or [`NONE`].
    pub(super) previous: u32,
    pub(super) next: u32,
}

impl LinkEnd {
    fn new<S: Scalar>(end: &End<S>) -> Self {
        let place = match end {
            End::World(point) => Place::World(point.map(S::to_fx)),
            End::Body(attachment) => Place::Body(attachment.body.slot, attachment.point.map(S::to_fx)),
        };
        let reach = match place {
            Place::World(_) => Fx::ZERO,
            Place::Body(_, point) => length_above(point),
        };
        Self { place, reach, previous: NONE, next: NONE }
    }

    /// The slot of the body.
    pub(crate) fn slot(&self) -> Option<u32> {
        match self.place {
            Place::World(_) => None,
            Place::Body(slot, _) => Some(slot),
        }
    }
}

/// The length of a vector, rounded up. *Domain* components within ±2^12 m.
fn length_above(vector: Vec2) -> Fx {
    let square = |value: Fx| i128::from(value.to_bits()).pow(2);
    let length = vector.checked_length().unwrap_or(Fx::MAX);
    let is_below = square(length) < square(vector.x) + square(vector.y);
    Fx::from_bits(length.to_bits() + i64::from(is_below))
}

/// A joint: first all that a walk along the ends on a body reads.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct Link {
    pub(crate) ends: [LinkEnd; 2],
    pub(crate) is_enabled: bool,
    /// True if the two bodies touch each other.
    pub(crate) collides: bool,
    pub(crate) kind: JointKind,
    /// The laws of the angle and of the ways along the axis or the line and across the axis, at position 0. The angle of a frame is in the axes
    /// of its body.
    pub(crate) axis: Option<Axis>,
    pub(crate) slides: [Option<Axis>; 2],
    pub(crate) counts_turns: bool,
    /// The teeth of a ratchet.
    pub(crate) ratchet: Option<i16>,
    /// The angle of the joint for two ends without an angle.
    pub(crate) frame: Turn,
    /// N and N·m.
    pub(crate) break_force: Option<Fx>,
    pub(crate) break_torque: Option<Fx>,
}

impl Link {
    /// The angle of the joint, for the angles of the ends.
    pub(crate) fn angle(&self, ends: [Turn; 2]) -> Turn {
        Turn::from_bits(self.kind.angle(ends).to_bits().wrapping_add(self.frame.to_bits()))
    }

    /// Returns true if the joint may break.
    pub(crate) fn is_breakable(&self) -> bool {
        self.break_force.is_some() || self.break_torque.is_some()
    }

    /// The position of the joint around, rad, for the angles of the ends and whole turns: of two gears of the wheel with more teeth. *Error* 1 ulp.
    pub(crate) fn position(&self, ends: [Turn; 2], turns: i16) -> Fx {
        self.kind.position_around(position(self.angle(ends), turns))
    }

    /// The limits of the angle with the tooth of a ratchet.
    fn limits_at(&self, [lower, upper]: [Fx; 2], state: &JointState) -> [Fx; 2] {
        match self.ratchet.map(|teeth| (teeth > 0, stop(teeth, state.tooth))) {
            Some((true, stop)) => [stop.clamp(lower, upper), upper],
            Some((false, stop)) => [lower, stop.clamp(lower, upper)],
            None => [lower, upper],
        }
    }

    /// The joint as the solver takes it, of bodies with these flights: for the arms of its ends in world axes, m, and the angles of its bodies.
    pub(crate) fn posed(
        &self,
        state: &JointState,
        bodies: [u32; 2],
        anchors: [Vec2; 2],
        angles: [Turn; 2],
        flights: &[Flight],
    ) -> Joint {
        let turned = |angle: Turn| Turn::from_bits(angles[0].to_bits().wrapping_add(angle.to_bits()));
        let kind = match self.kind {
            JointKind::Slider { angle } => JointKind::Slider { angle: turned(angle) },
            JointKind::Planar { angle } => JointKind::Planar { angle: turned(angle) },
            kind => kind,
        };
        let mut joint = Joint { bodies, anchors, kind, axis: None, slides: [None; 2], impulses: state.impulses() };
        joint.axis = self.axis.map(|axis| Axis {
            position: self.position(angles, state.turns),
            limits: axis.limits.map(|limits| self.limits_at(limits, state)),
            ..axis
        });
        if self.slides != [None; 2] {
            let ways = joint.ways(flights);
            joint.slides = [0, 1].map(|row| self.slides[row].map(|slide| Axis { position: ways[row], ..slide }));
        }
        joint
    }

    pub(crate) fn new<S: Scalar>(def: &JointDef<S>) -> Self {
        let frames = def.angles.map(|angle| S::Angle::from_radians(angle).to_turn());
        let kind = def.kind.for_solver(frames[0]);
        Self {
            ends: [LinkEnd::new(&def.ends[0]), LinkEnd::new(&def.ends[1])],
            is_enabled: def.enabled,
            collides: def.collide_connected,
            kind,
            axis: def.kind.axis(),
            slides: def.kind.slides(),
            counts_turns: def.kind.counts_turns(),
            ratchet: def.kind.ratchet(),
            frame: kind.angle(frames),
            break_force: def.break_force.map(S::to_fx),
            break_torque: def.break_torque.map(S::to_fx),
        }
    }
}

/// The joints of a world at a moment: the links of the set, and the state of each.
#[derive(Clone, Copy)]
pub(crate) struct Joined<'a> {
    pub(super) links: &'a [Link],
    /// The first end on each body by its slot, or [`NONE`]: end e of link i has the number 2·i + e.
    pub(super) first_ends: &'a [u32],
    pub(crate) states: &'a [JointState],
    pub(super) are_any_apart: bool,
    pub(super) may_any_break: bool,
}

impl<'a> Joined<'a> {
    /// Returns true if no body has a joint.
    pub(crate) fn is_empty(&self) -> bool {
        self.first_ends.is_empty()
    }

    /// Returns true if the body in a slot has a joint, active or not.
    #[inline]
    pub(crate) fn has(&self, slot: u32) -> bool {
        self.first_ends.get(slot as usize).is_some_and(|&end| end != NONE)
    }

    pub(crate) fn link(&self, index: u32) -> &'a Link {
        &self.links[index as usize]
    }

    /// Returns true if steps keep what the joint keeps.
    pub(crate) fn is_active(&self, index: u32) -> bool {
        self.links[index as usize].is_enabled && !self.states[index as usize].is_broken
    }

    /// Returns true if a joint, active or not, keeps its bodies from touching each other.
    pub(crate) fn keeps_any_apart(&self) -> bool {
        self.are_any_apart
    }

    /// Returns true if a joint may break.
    pub(crate) fn may_any_break(&self) -> bool {
        self.may_any_break
    }

    /// The joints of the body in a slot that are active, in no order: the index of each, and which of its ends is on the body.
    #[inline]
    pub(crate) fn of(self, slot: u32) -> impl Iterator<Item = (u32, usize)> + use<'a> {
        let mut end = self.first_ends.get(slot as usize).copied().unwrap_or(NONE);
        let all = core::iter::from_fn(move || {
            let (index, side) = (end / 2, end as usize % 2);
            end = self.links.get(index as usize)?.ends[side].next;
            Some((index, side))
        });
        all.filter(move |&(index, _)| self.is_active(index))
    }

    /// The slots of the bodies that active joints join to the body in a slot.
    pub(crate) fn partners(self, slot: u32) -> impl Iterator<Item = u32> + use<'a> {
        self.of(slot).filter_map(move |(index, side)| self.link(index).ends[1 - side].slot())
    }

    /// The largest distance of a point of active joints from the centre of mass of the body in a slot, m.
    pub(crate) fn reach(self, slot: u32) -> Fx {
        self.of(slot).map(|(index, side)| self.link(index).ends[side].reach).fold(Fx::ZERO, Fx::max)
    }

    /// Returns true if an active joint keeps the bodies in two slots from touching each other. It takes time in proportion to the joints of
    /// the body that has fewer.
    pub(crate) fn keeps_apart(self, [a, b]: [u32; 2]) -> bool {
        let apart = |slot: u32, partner: u32| {
            self.of(slot).map(move |(index, side)| {
                let link = self.link(index);
                !link.collides && link.ends[1 - side].slot() == Some(partner)
            })
        };
        self.are_any_apart && apart(a, b).zip(apart(b, a)).any(|(of_a, of_b)| of_a || of_b)
    }
}
