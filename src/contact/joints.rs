//! The joints of a step, as the solver takes them.
//!
//! Reads: the joints of bodies that move, with the impulses of the step before; flights; impulses of the solver. Writes: solver joints, and
//! flights of points that stay where they are.
//!
//! A joint takes part if it is active and one of its ends is on a dynamic body that moves in the step. The other end may be on a body that
//! moves as well, or at a fixed point: of the world, of a static body, or of a kinematic body that is asleep. A joint to a disabled or
//! quarantined body, or to a body at fault, does nothing and loses its impulses, as contacts of such bodies do.

use alloc::vec::Vec;

use super::Scene;
use super::flights::{FlightKind, Flights};
use super::split::{Part, Solvers};
use crate::body::{Activity, BodyKind};
use crate::fx::Fx;
use crate::joint::{JointStates, Place};
use crate::math::Vec2;
use crate::scalar::{FxAccumulator, FxWide, Turn};
use crate::solve::{ContactSolver, Impulses, Joint};

/// An end of a joint on a body: its flight, the point from its centre of mass in its axes, m, and its angle.
#[derive(Clone, Copy)]
struct MovingEnd {
    flight: u32,
    point: Vec2,
    angle: Turn,
}

impl MovingEnd {
    /// The arm in world axes.
    fn arm(&self) -> Vec2 {
        turned(self.point, self.angle)
    }
}

/// An end of a joint in a step.
enum StepEnd {
    /// A body that moves.
    Moving(MovingEnd),
    /// A point that stays where it is, and its angle.
    Fixed(Vec2, Turn),
    /// A body that takes no part.
    Absent,
}

/// The joints of a step. Lists of the same length share their order.
#[derive(Debug, Default)]
pub(crate) struct JointList {
    pub(super) solver_joints: Vec<Joint>,
    /// The impulses that the joints start from.
    pub(super) starts: Vec<Impulses>,
    /// The index of each joint in its set.
    indices: Vec<u32>,
    /// The impulses over the step on the second body, along x and y, in 2^-32 N·s, and around, in 2^-32 N·m·s; empty where no joint may break.
    totals: Vec<[i128; 3]>,
    /// The indices of joints to bodies that take no part.
    idle: Vec<u32>,
}

/// An arm of a body in world axes. *Domain* points of joints.
pub(super) fn turned(point: Vec2, angle: Turn) -> Vec2 {
    // Within 2^12.5 m: it fits.
    angle.rotate(point).and_then(|arm| arm.try_map(FxWide::to_scalar)).unwrap_or_default()
}

impl JointList {
    /// Lists the joints of the bodies that move.
    pub(super) fn set(&mut self, scene: &Scene<'_>, flights: &mut Flights) {
        self.solver_joints.clear();
        self.starts.clear();
        self.indices.clear();
        self.totals.clear();
        self.idle.clear();
        if scene.joints.is_empty() {
            return;
        }
        for (flight, start) in (0..).zip(scene.starts) {
            let slot = flights.body(flight).slot;
            for (index, side) in scene.joints.of(slot) {
                let Place::Body(_, point) = scene.joints.link(index).ends[side].place else { continue };
                let end = MovingEnd { flight, point, angle: start.angle };
                self.push(scene, flights, end, index, side);
            }
        }
        // Once all bodies have their radii.
        for joint in self.solver_joints.iter().filter(|joint| joint.axis.is_some()) {
            flights.widen_fixed(joint.bodies);
        }
    }

    /// Adds a joint of a moving body, unless its other end adds it.
    fn push(&mut self, scene: &Scene<'_>, flights: &mut Flights, end: MovingEnd, index: u32, side: usize) {
        let link = scene.joints.link(index);
        let is_dynamic = |flight: u32| flights.body(flight).kind == FlightKind::Dynamic;
        let far_end = step_end(scene, flights, &link.ends[1 - side].place);
        let far_end = match far_end {
            // The end with the lower flight adds it.
            StepEnd::Moving(far_end) if far_end.flight < end.flight => return,
            StepEnd::Moving(far_end) if is_dynamic(end.flight) || is_dynamic(far_end.flight) => far_end,
            StepEnd::Fixed(point, angle) if is_dynamic(end.flight) => {
                MovingEnd { flight: flights.push_fixed_point(point), point: Vec2::ZERO, angle }
            }
            StepEnd::Moving(_) | StepEnd::Fixed(..) => return,
            StepEnd::Absent => {
                self.idle.push(index);
                return;
            }
        };
        flights.complete(scene, end.flight);
        flights.complete(scene, far_end.flight);
        let [first, second] = if side == 0 { [end, far_end] } else { [far_end, end] };
        let bodies = [first.flight, second.flight];
        let (anchors, angles) = ([first.arm(), second.arm()], [first.angle, second.angle]);
        let joint = link.posed(&scene.joints.states[index as usize], bodies, anchors, angles, flights.all());
        if joint.kind.frame_angle().is_some() {
            flights.reach_point(bodies, anchors, joint.offset(flights.all()));
        }
        self.solver_joints.push(joint);
        self.starts.push(joint.impulses);
        self.indices.push(index);
    }

    pub(super) fn is_empty(&self) -> bool {
        self.solver_joints.is_empty()
    }

    /// The bodies of the joints with impulses.
    pub(super) fn pulling(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        let pulling = self.solver_joints.iter().filter(|joint| joint.impulses.values != [0; 3]);
        pulling.map(|joint| joint.bodies)
    }

    /// Reads the impulses over the step from the solvers, which have solved all joints, or the joints of this part.
    pub(super) fn read_totals<C: ContactSolver>(&mut self, solvers: &Solvers<C>, part: Option<&Part>) {
        self.totals.resize(self.solver_joints.len(), [0; 3]);
        for (joint, total) in solvers.joint_totals() {
            let number = part.map_or(joint, |part| part.joint_numbers[joint as usize]);
            self.totals[number as usize] = total;
        }
    }

    /// Writes the impulses of the step to the state, and the tick of the step if an impulse acted in it.
    pub(crate) fn store(&self, states: &mut JointStates, pushed_at: Option<u64>) {
        for (&index, joint) in self.indices.iter().zip(&self.solver_joints) {
            states.list[index as usize].set_impulses(joint.impulses);
        }
        for &index in &self.idle {
            states.list[index as usize].clear_impulses();
        }
        if let (false, Some(tick)) = (self.is_empty(), pushed_at) {
            states.pulled_at = tick;
        }
    }

    /// The joints by their indices in the set, each with the flights of its ends.
    pub(crate) fn ends(&self) -> impl Iterator<Item = (u32, [u32; 2])> + '_ {
        self.indices.iter().copied().zip(self.solver_joints.iter().map(|joint| joint.bodies))
    }

    /// The joints by their indices in the set, each with its impulses over the step on the second body, along x and y, in 2^-32 N·s, and around, in
    /// 2^-32 N·m·s; none where no joint may break.
    pub(crate) fn totals(&self) -> impl Iterator<Item = (u32, [i128; 3])> + '_ {
        self.indices.iter().copied().zip(self.totals.iter().copied())
    }
}

/// The end of a joint at a place.
fn step_end(scene: &Scene<'_>, flights: &Flights, place: &Place) -> StepEnd {
    let (slot, point) = match *place {
        Place::World(point) => return StepEnd::Fixed(point, Turn::default()),
        Place::Body(slot, point) => (slot, point),
    };
    // Bodies that move have the first flights.
    let moving = flights.at(slot).and_then(|flight| Some((flight, scene.starts.get(flight as usize)?)));
    if let Some((flight, start)) = moving {
        return StepEnd::Moving(MovingEnd { flight, point, angle: start.angle });
    }
    let Some(dense) = scene.bodies.index_in(slot) else { return StepEnd::Absent };
    let stands = match scene.bodies.activity(dense) {
        Activity::Asleep => true,
        Activity::Awake => scene.bodies.contact_info(dense).kind == BodyKind::Static,
        Activity::Disabled | Activity::Quarantined => false,
    };
    if !stands {
        return StepEnd::Absent;
    }
    let centre = scene.bodies.position(dense).map(FxAccumulator::value);
    let angle = scene.bodies.angle(dense);
    let arm = turned(point, angle);
    let sum = |centre: Fx, arm: Fx| centre.saturating_add(arm);
    StepEnd::Fixed(Vec2::new(sum(centre.x, arm.x), sum(centre.y, arm.y)), angle)
}
