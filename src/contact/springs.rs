//! The energy that the springs of the joints of a world hold, and the masses that they meet, at the poses of its bodies, with the stiffness that the
//! next step would give them.

use super::bodies::{ContactBodies, resting};
use super::joints::turned;
use crate::joint::{Joined, JointState, Link, Place};
use crate::math::Vec2;
use crate::scalar::{FxAccumulator, FxFactor, Turn};
use crate::solve::{Flight, Joint};

/// An end of a joint at rest: its body as the solver takes it, the arm of the point in world axes, m, and the angle of the body.
struct StandingEnd {
    body: Flight,
    arm: Vec2,
    angle: Turn,
}

impl StandingEnd {
    /// The end at a place; `None` on a body that does not exist.
    fn new(bodies: &dyn ContactBodies, place: &Place) -> Option<Self> {
        let (slot, point) = match *place {
            Place::World(point) => {
                return Some(Self { body: resting(point), arm: Vec2::ZERO, angle: Turn::default() });
            }
            Place::Body(slot, point) => (slot, point),
        };
        let dense = bodies.index_in(slot)?;
        let (inverse_mass, inverse_inertia) = bodies.inverse_masses(dense);
        let position = bodies.position(dense).map(FxAccumulator::value);
        let body = Flight { inverse_mass, inverse_inertia, ..resting(position) };
        let angle = bodies.angle(dense);
        Some(Self { body, arm: turned(point, angle), angle })
    }
}

/// A joint as the solver takes it, at the poses of its bodies, with both as they stand.
fn standing(bodies: &dyn ContactBodies, link: &Link, state: &JointState) -> Option<(Joint, [Flight; 2])> {
    let [first, second] = [0, 1].map(|side| StandingEnd::new(bodies, &link.ends[side].place));
    let (first, second) = (first?, second?);
    let (anchors, angles, flights) = ([first.arm, second.arm], [first.angle, second.angle], [first.body, second.body]);
    Some((link.posed(state, [0, 1], anchors, angles, &flights), flights))
}

/// The energies of the springs of a joint, J: along its axes or line, and around. Both are zero unless the joint is active, its bodies take part,
/// and one of them can be moved.
pub(crate) fn spring_energies(bodies: &dyn ContactBodies, joints: Joined<'_>, index: u32) -> [FxFactor; 2] {
    let link = joints.link(index);
    let has_spring = link.slides.iter().chain([&link.axis]).flatten().any(|law| law.spring.is_some());
    let slots = link.ends.iter().filter_map(|end| end.slot());
    let take_part = |slot| bodies.index_in(slot).is_some_and(|dense| bodies.activity(dense).takes_part());
    if !has_spring || !joints.is_active(index) || !slots.into_iter().all(take_part) {
        return [FxFactor::ZERO; 2];
    }
    let joint = standing(bodies, link, &joints.states[index as usize]);
    joint.map_or([FxFactor::ZERO; 2], |(joint, flights)| joint.spring_energies(&flights))
}

/// The mass that a spring of a joint meets, kg, or the moment of inertia, kg·m²; `None` if neither end can be moved, or if the spring has no direction.
pub(crate) fn spring_mass(bodies: &dyn ContactBodies, link: &Link) -> Option<FxFactor> {
    let (joint, flights) = standing(bodies, link, &JointState::default())?;
    joint.spring_mass(&flights)
}
