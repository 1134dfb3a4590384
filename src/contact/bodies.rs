//! The border between the bodies of a world and its contacts. Contacts are found in fixed point, whatever the scalar of the world is: here
//! poses, velocities and masses become [`Fx`].

use alloc::vec::Vec;

use crate::body::{Activity, Bodies, BodyKind, Locks};
use crate::collider::ColliderSet;
use crate::fx::Fx;
use crate::joint::Joined;
use crate::math::{TimeStep, Vec2};
use crate::scalar::{Accumulator as _, Angle as _, Factor as _, FxAccumulator, FxFactor, Scalar, Turn};
use crate::slots::BodyId;
use crate::solve::{Flight, Velocity};

use super::Start;

/// The properties of a body that no step changes and contacts read.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ContactInfo {
    pub(crate) kind: BodyKind,
    pub(crate) is_bullet: bool,
    pub(crate) key: u64,
}

/// A moving body with colliders that meet others, or with joints: the facts about it that no step changes and each step reads.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MovingBody {
    pub(crate) slot: u32,
    /// False for a kinematic body.
    pub(crate) is_dynamic: bool,
    pub(crate) is_bullet: bool,
    pub(crate) dominance: i32,
    /// kg; zero for a kinematic body.
    pub(crate) mass: Fx,
    /// The largest distance of a point of its solid colliders from the centre of mass, m; zero without solid colliders.
    pub(crate) radius: Fx,
    /// The radius without discs around the centre of mass, which look alike at all angles; zero without other colliders.
    pub(crate) turning_radius: Fx,
    /// The least width of its solid colliders, m; the largest number without solid colliders.
    pub(crate) width: Fx,
}

impl MovingBody {
    /// The moving body in a slot; `None` if no collider of it meets others and it has no joint.
    pub(crate) fn new<S: Scalar>(
        bodies: &Bodies<S>,
        colliders: &ColliderSet,
        joints: &Joined<'_>,
        slot: u32,
    ) -> Option<Self> {
        let dense = bodies.index_in(slot).filter(|_| colliders.any_meeting_of_slot(slot) || joints.has(slot))?;
        let info = bodies.info(dense);
        let mut body = Self {
            slot,
            is_dynamic: info.kind == BodyKind::Dynamic,
            is_bullet: info.is_bullet,
            dominance: info.dominance,
            mass: info.kilograms().to_fx(),
            radius: Fx::ZERO,
            turning_radius: Fx::ZERO,
            width: Fx::MAX,
        };
        for collider in colliders.solid_of_slot(slot) {
            body.radius = collider.radius.max(body.radius);
            body.width = collider.width.min(body.width);
            if !collider.is_central_disc() {
                body.turning_radius = collider.radius.max(body.turning_radius);
            }
        }
        Some(body)
    }
}

/// The bodies of a world in fixed point. Indices are indices in the columns.
pub(crate) trait ContactBodies {
    /// The index of a body; `None` if there is none with this handle.
    fn index_of(&self, body: BodyId) -> Option<usize>;
    /// The index of the body in a slot.
    fn index_in(&self, slot: u32) -> Option<usize>;
    fn id(&self, dense: usize) -> BodyId;
    /// The number of bodies that a step moves: they come first.
    fn moving(&self) -> usize;
    fn any_asleep(&self) -> bool;
    fn activity(&self, dense: usize) -> Activity;
    fn contact_info(&self, dense: usize) -> ContactInfo;
    fn locks(&self, dense: usize) -> Locks;
    /// Returns true if impulses move the body.
    fn can_move(&self, dense: usize) -> bool;
    /// The position, m.
    fn position(&self, dense: usize) -> Vec2<FxAccumulator>;
    fn angle(&self, dense: usize) -> Turn;
    /// 1/m along x and y, 1/kg, and 1/I, 1/(kg·m²).
    fn inverse_masses(&self, dense: usize) -> (Vec2<FxFactor>, FxFactor);
    /// Lists the free flights of moving bodies from their starts to where they are now, as far as flights decide about contacts: without
    /// velocities and masses.
    fn list_flights(&self, starts: &[Start], time_step: TimeStep, flights: &mut Vec<Flight>);
    /// Adds velocities and masses to the flight of a moving body.
    fn complete(&self, start: &Start, flight: &mut Flight);
}

impl<S: Scalar> ContactBodies for Bodies<S> {
    fn index_of(&self, body: BodyId) -> Option<usize> {
        self.find(body).ok()
    }

    fn index_in(&self, slot: u32) -> Option<usize> {
        self.index_in(slot)
    }

    fn id(&self, dense: usize) -> BodyId {
        self.id(dense)
    }

    fn moving(&self) -> usize {
        self.moving()
    }

    fn any_asleep(&self) -> bool {
        self.any_asleep()
    }

    fn activity(&self, dense: usize) -> Activity {
        self.activity(dense)
    }

    fn contact_info(&self, dense: usize) -> ContactInfo {
        let info = self.info(dense);
        ContactInfo { kind: info.kind, is_bullet: info.is_bullet, key: info.key }
    }

    fn locks(&self, dense: usize) -> Locks {
        self.mass(dense).locks
    }

    fn can_move(&self, dense: usize) -> bool {
        self.mass(dense).can_move()
    }

    fn position(&self, dense: usize) -> Vec2<FxAccumulator> {
        self.columns.motion.position.get(dense).map(|part| part.to_fixed())
    }

    fn angle(&self, dense: usize) -> Turn {
        self.columns.motion.angle[dense].to_turn()
    }

    fn inverse_masses(&self, dense: usize) -> (Vec2<FxFactor>, FxFactor) {
        let mass = self.mass(dense);
        (mass.axis_inverse_mass.map(|part| part.to_fx_factor()), mass.inverse_inertia.to_fx_factor())
    }

    fn list_flights(&self, starts: &[Start], time_step: TimeStep, flights: &mut Vec<Flight>) {
        let way = |from: FxAccumulator, to: FxAccumulator| to.plus(from.negated()).value();
        flights.extend(starts.iter().map(|start| {
            let end = ContactBodies::position(self, start.dense);
            let end_velocity = self.columns.motion.angular_velocity[start.dense].to_fixed();
            let velocities = [start.angular_velocity, end_velocity];
            Flight {
                displacement: Vec2::new(way(start.position.x, end.x), way(start.position.y, end.y)),
                rotation: rotation(start.angle, ContactBodies::angle(self, start.dense), velocities, time_step),
                radius: if start.body.radius == Fx::ZERO { Fx::ONE } else { start.body.radius },
                ..resting(start.position.map(FxAccumulator::value))
            }
        }));
    }

    fn complete(&self, start: &Start, flight: &mut Flight) {
        let velocity = |linear: Vec2<FxAccumulator>, angular: FxAccumulator| Velocity {
            linear: linear.map(FxAccumulator::value),
            angular: angular.value(),
        };
        let motion = &self.columns.motion;
        let end_velocity = motion.velocity.get(start.dense).map(|part| part.to_fixed());
        flight.start = velocity(start.velocity, start.angular_velocity);
        flight.end = velocity(end_velocity, motion.angular_velocity[start.dense].to_fixed());
        flight.mass = start.body.mass;
        (flight.inverse_mass, flight.inverse_inertia) = self.inverse_masses(start.dense);
    }
}

/// The flight of a body that does not move.
#[inline(always)]
pub(super) fn resting(position: Vec2) -> Flight {
    Flight {
        position,
        start: Velocity::default(),
        end: Velocity::default(),
        displacement: Vec2::ZERO,
        rotation: Fx::ZERO,
        mass: Fx::ZERO,
        inverse_mass: Vec2::new(FxFactor::ZERO, FxFactor::ZERO),
        inverse_inertia: FxFactor::ZERO,
        radius: Fx::ONE,
        leader: None,
    }
}

/// 2π in ulps.
const TURN: i128 = 26_986_075_409;

/// The angle turned in a step, rad: the way between two angles, and as many whole turns as the velocities say.
fn rotation(from: Turn, to: Turn, velocities: [FxAccumulator; 2], time_step: TimeStep) -> Fx {
    let way = i128::from(from.way_to(to).to_scalar().unwrap_or(Fx::ZERO).to_bits());
    let (num, den) = time_step.seconds();
    // Velocities are below 2^21 rad/s, a step takes at most a second: below 2^54 · 2^32. Up to 2 ulp more than the sum of the two.
    let speeds: u64 =
        velocities.iter().map(|velocity| (velocity.to_bits() >> 64) as i64).map(|v| v.unsigned_abs() + 1).sum();
    // A way and a mean velocity of at most a radian: no turn is between them.
    if way.unsigned_abs() <= 1 << 32 && u128::from(speeds) * u128::from(num) <= u128::from(den) << 33 {
        return Fx::from_bits(way as i64);
    }
    let sum: i128 = velocities.iter().map(|velocity| i128::from(velocity.value().to_bits())).sum();
    let about = sum * i128::from(num) / (2 * i128::from(den));
    let rest = about - way;
    let turns = (rest.abs() + TURN / 2) / TURN * rest.signum();
    Fx::from_bits((way + turns * TURN) as i64)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A constant rotation has the angle that its velocity says, over any number of turns: within half an ulp for each, as 2π is in ulps.
    #[test]
    fn whole_turns_follow_the_velocities() {
        for (num, den) in [(1, 60), (1, 1), (1, 1000), (7, 240)] {
            // From 10^-8 to 2^21 rad/s.
            let speeds = core::iter::successors(Some(43_i64), |&speed| Some(speed + speed / 4));
            for speed in speeds.take_while(|&speed| speed < 1 << 53).flat_map(|speed| [speed, -speed]) {
                let expected = i128::from(speed) * num / den;
                let from = Turn::from_radians(crate::fx!(2.5));
                let to = from.turned(FxAccumulator::from_scalar(Fx::from_bits(expected as i64)));
                let way = rotation(
                    from,
                    to,
                    [FxAccumulator::from_scalar(Fx::from_bits(speed)); 2],
                    TimeStep::ratio(num as u32, den as u32),
                );
                let error = (i128::from(way.to_bits()) - expected).abs();
                assert!(error <= 2 + expected.abs() / TURN, "{speed} for {num}/{den} s: {way}");
            }
        }
    }
}
