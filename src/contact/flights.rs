//! The bodies that take part in contacts in a step, each with its *flight*: its motion over the step without contacts.

use alloc::vec::Vec;

use super::bodies::{MovingBody, resting};
use super::moment::{Way, length, mean_beginning};
use super::movers::MovingOutlines;
use super::numbers::Numbers;
use super::reach::Reach;
use super::slot_table::SlotTable;
use super::{Correction, Scene, Start};
use crate::body::Activity;
use crate::collide::{PlacedMotion, Pose};
use crate::collider::{Collider, OutlineId, OutlineRef};
use crate::fx::Fx;
use crate::limits;
use crate::math::Vec2;
use crate::scalar::{FxAccumulator, FxFactor, Turn};
use crate::slots::NONE;
use crate::solve::Flight;

/// The kind of a body's flight: how contacts treat the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FlightKind {
    /// A body that impulses move.
    Dynamic,
    /// A body that moves as set, whatever touches it.
    Kinematic,
    Asleep,
    Static,
}

/// The body of a flight: its slot, its kind, and its pose at the moment of manifolds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub(super) slot: u32,
    pub(super) pose: Pose,
    /// The way from the start to that pose.
    pub(super) way: Way,
    pub(super) kind: FlightKind,
    pub(super) is_bullet: bool,
    /// The dominance: a contact of two dynamic bodies does not move the body with the higher one.
    pub(super) dominance: i32,
    /// False while the flight lacks the values that only contacts need: few bodies of a step touch something.
    is_complete: bool,
}

/// An outline of a pair, with its collider and the flight of its body.
#[derive(Clone, Copy, Debug)]
pub(super) struct PairSide<'a> {
    /// The number by which the broad phase knows the outline.
    pub(super) number: u32,
    pub(super) id: OutlineId,
    pub(super) collider: &'a Collider,
    pub(super) flight: u32,
    pub(super) kind: FlightKind,
}

impl<'a> PairSide<'a> {
    #[inline(always)]
    pub(super) fn outline(&self) -> OutlineRef<'a, Fx> {
        self.collider.outline(self.id.part)
    }

    /// The largest distance of a point of the outline from the centre of mass of its body, m.
    #[inline(always)]
    pub(super) fn radius(&self) -> Fx {
        self.outline().radius
    }

    /// Returns true for an outline that may be one of several with one surface.
    pub(super) fn may_be_tile(&self) -> bool {
        self.kind == FlightKind::Static || self.collider.has_others()
    }
}

/// The flights of a step: moving bodies in the order of `Scene::starts`, then bodies that stand still, in the order in which pairs name
/// them.
#[derive(Debug, Default)]
pub(super) struct Flights {
    flights: Vec<Flight>,
    /// The body of each flight.
    places: Vec<Place>,
    /// The outlines of the bodies that move.
    pub(super) outlines: MovingOutlines,
    /// The flights of kinematic bodies that move.
    pub(super) kinematic: Vec<u32>,
    /// The number of the flight by the slot of the body.
    flight_of: SlotTable,
    /// The moment of manifolds, and the length of the step, in 2^-48 s.
    mean_beginning: u64,
    length: u64,
    /// The follower of each flight and the leader of each follower, or [`NONE`]; empty if there are no followers.
    followers: Vec<u32>,
}

/// The pose of a body.
pub(super) fn pose(position: Vec2<FxAccumulator>, angle: Turn) -> Pose {
    Pose::new(position.map(FxAccumulator::value), angle)
}

impl Place {
    /// The place of a body that moves.
    #[inline(always)]
    fn moving(start: &Start, mean_beginning: u64) -> Self {
        let MovingBody { slot, is_dynamic, is_bullet, dominance, turning_radius, .. } = start.body;
        let way = Way::steady(start, mean_beginning);
        // Discs around the centre look alike at all angles.
        let pose = if turning_radius == Fx::ZERO {
            way.without_rotation().pose(start.position, Turn::default())
        } else {
            way.pose(start.position, start.angle)
        };
        let kind = if is_dynamic { FlightKind::Dynamic } else { FlightKind::Kinematic };
        Self { slot, pose, way, kind, is_bullet, dominance, is_complete: false }
    }
}

impl Flights {
    /// Lists the bodies that move, with their outlines.
    pub(super) fn begin(&mut self, scene: &Scene<'_>, numbers: &Numbers) {
        self.outlines.update(scene, numbers);
        self.flights.clear();
        self.places.clear();
        self.flight_of.clear();
        self.followers.clear();
        self.mean_beginning = mean_beginning(scene.time_step, scene.settings.substeps);
        self.length = length(scene.time_step);
        scene.bodies.list_flights(scene.starts, scene.time_step, &mut self.flights);
        if !scene.joints.is_empty() {
            self.reach_joints(scene);
        }
        let mean_beginning = self.mean_beginning;
        self.places.extend(scene.starts.iter().map(|start| Place::moving(start, mean_beginning)));
        self.kinematic.clear();
        for (flight, start) in (0..).zip(scene.starts) {
            self.flight_of.set(start.body.slot, flight);
            if !start.body.is_dynamic {
                self.kinematic.push(flight);
            }
        }
    }

    /// Extends the radii of bodies to the points of their joints.
    fn reach_joints(&mut self, scene: &Scene<'_>) {
        for (flight, start) in self.flights.iter_mut().zip(scene.starts) {
            let radius = scene.joints.reach(start.body.slot).max(start.body.radius);
            if radius > Fx::ZERO {
                flight.radius = radius;
            }
        }
    }

    #[cold]
    fn push_resting(&mut self, scene: &Scene<'_>, slot: u32, dense: usize) -> u32 {
        let pose = pose(scene.bodies.position(dense), scene.bodies.angle(dense));
        self.flights.push(resting(pose.position()));
        let is_asleep = scene.bodies.activity(dense) == Activity::Asleep;
        let kind = if is_asleep { FlightKind::Asleep } else { FlightKind::Static };
        let way = Way::default();
        let flight = self.places.len() as u32;
        self.flight_of.set(slot, flight);
        let is_bullet = scene.bodies.contact_info(dense).is_bullet;
        self.places.push(Place { slot, pose, way, kind, is_bullet, dominance: 0, is_complete: true });
        flight
    }

    /// Adds a flight for a point that stays where it is: the end of a joint on the world, or on a body that does not move. Returns its number.
    pub(super) fn push_fixed_point(&mut self, point: Vec2) -> u32 {
        let way = Way::default();
        let pose = pose(point.map(FxAccumulator::from_scalar), Turn::default());
        let kind = FlightKind::Static;
        self.flights.push(resting(point));
        self.places.push(Place { slot: NONE, pose, way, kind, is_bullet: false, dominance: 0, is_complete: true });
        self.flights.len() as u32 - 1
    }

    /// Completes the flight of a body that has a contact.
    #[inline(always)]
    pub(super) fn complete(&mut self, scene: &Scene<'_>, flight: u32) {
        if !self.places[flight as usize].is_complete {
            self.complete_first(scene, flight as usize);
        }
    }

    fn complete_first(&mut self, scene: &Scene<'_>, index: usize) {
        let Some(start) = scene.starts.get(index) else { return };
        scene.bodies.complete(start, &mut self.flights[index]);
        self.places[index].is_complete = true;
    }

    /// The flights of a contact, which are complete. For two dynamic bodies of unlike dominance, a follower stands for the higher one.
    pub(super) fn by_dominance(&mut self, ends: [u32; 2]) -> [u32; 2] {
        let [a, b] = ends.map(|flight| &self.places[flight as usize]);
        let dynamic = FlightKind::Dynamic;
        if a.dominance == b.dominance || a.kind != dynamic || b.kind != dynamic {
            return ends;
        }
        let side = usize::from(a.dominance < b.dominance);
        let mut ends = ends;
        ends[side] = self.follower(ends[side]);
        ends
    }

    /// The follower of a flight: it moves as its leader does, and no contact moves it.
    #[cold]
    fn follower(&mut self, leader: u32) -> u32 {
        self.followers.resize(self.flights.len() + 1, NONE);
        if self.followers[leader as usize] != NONE {
            return self.followers[leader as usize];
        }
        let follower = self.flights.len() as u32;
        self.followers[leader as usize] = follower;
        self.followers[follower as usize] = leader;
        let fixed = FxFactor::ZERO;
        self.flights.push(Flight {
            inverse_mass: Vec2::new(fixed, fixed),
            inverse_inertia: fixed,
            leader: Some(leader),
            ..self.flights[leader as usize]
        });
        self.places.push(Place { kind: FlightKind::Kinematic, ..self.places[leader as usize] });
        follower
    }

    /// The leader of a follower, or the flight itself.
    pub(super) fn leader(&self, flight: u32) -> u32 {
        // Leaders have lower numbers than their followers.
        match self.followers.get(flight as usize) {
            Some(&leader) if leader < flight => leader,
            _ => flight,
        }
    }

    /// Returns true if a body follows another one.
    pub(super) fn any_followers(&self) -> bool {
        !self.followers.is_empty()
    }

    /// Extends the radius of a body to a point of another one, at an offset from one of its own, throughout the step: to the farther end of its free
    /// flight, with the turn of an arm, and by a quarter beyond for the way by impulses.
    pub(super) fn reach_point(&mut self, flights: [u32; 2], arms: [Vec2; 2], offset: [i128; 2]) {
        let [first, second] = flights.map(|flight| &self.flights[flight as usize]);
        let bits = |number: Fx| i128::from(number.to_bits());
        let ways = [
            bits(second.displacement.x) - bits(first.displacement.x),
            bits(second.displacement.y) - bits(first.displacement.y),
        ];
        let [x, y] = [0, 1].map(|axis| offset[axis].abs().max((offset[axis] + ways[axis]).abs()));
        let size = |arm: Vec2| bits(arm.x).abs() + bits(arm.y).abs();
        // At most the diameter of the circle on which it goes round.
        let turned = (bits(second.rotation).abs().min(2 << 32) * size(arms[1])) >> 32;
        // Points are within 2^31 m of each other, and ways within 2^32 m: the sum is below 2^67 units.
        let reach = size(arms[0]) + x + y + turned;
        let reach = reach + (reach >> 2);
        let reach = Fx::from_bits(reach.min(limits::JOINT_LENGTH.to_bits().into()) as i64);
        let radius = &mut self.flights[flights[0] as usize].radius;
        *radius = (*radius).max(reach);
    }

    /// Gives a body that cannot turn at least the radius of the body that it is joined to, if that one can turn: its radius stays, so that the order
    /// of joints does not matter.
    pub(super) fn widen_fixed(&mut self, [first, second]: [u32; 2]) {
        for [fixed, turning] in [[first, second], [second, first]] {
            let [fixed, turning] = [fixed, turning].map(|flight| flight as usize);
            if self.flights[fixed].inverse_inertia.is_zero() && !self.flights[turning].inverse_inertia.is_zero() {
                self.flights[fixed].radius = self.flights[fixed].radius.max(self.flights[turning].radius);
            }
        }
    }

    /// The flight of a body.
    #[inline(always)]
    pub(super) fn of(&mut self, scene: &Scene<'_>, slot: u32) -> u32 {
        match self.flight_of.get(slot) {
            // A pair names only colliders whose bodies exist.
            NONE => scene.bodies.index_in(slot).map_or(0, |dense| self.push_resting(scene, slot, dense)),
            flight => flight,
        }
    }

    /// An outline by its number; `None` if its collider is gone.
    #[inline(always)]
    pub(super) fn side<'a>(&mut self, scene: &Scene<'a>, numbers: &Numbers, number: u32) -> Option<PairSide<'a>> {
        let id = numbers.outline(number);
        let collider = scene.colliders.at(id.slot)?;
        let flight = self.of(scene, collider.body.slot);
        Some(PairSide { number, id, collider, flight, kind: self.body(flight).kind })
    }

    /// The way of a body in the step at the velocity of the start, m.
    pub(super) fn steady_way(&self, start: &Start) -> Vec2 {
        Way::steady(start, self.length).displacement
    }

    /// The pose of a moving body at the start of the step; `None` for one that does not move.
    pub(super) fn start_pose(&self, scene: &Scene<'_>, flight: u32) -> Option<Pose> {
        scene.starts.get(flight as usize).map(|start| pose(start.position, start.angle))
    }

    /// A flight with the changes of its way by impulses, if there are any.
    pub(super) fn deflected(&self, flight: u32, corrections: &[Correction]) -> Flight {
        let free = self.flights[flight as usize];
        match corrections.get(self.leader(flight) as usize) {
            Some(change) => Flight {
                displacement: free.displacement + change.displacement.map(FxAccumulator::value),
                rotation: free.rotation.saturating_add(change.rotation.value()),
                ..free
            },
            None => free,
        }
    }

    /// The motion of an outline of this extent in ulps, which is placed at the moment of manifolds, with the changes of its body's way by
    /// impulses, if there are any.
    #[inline(always)]
    pub(super) fn placed_motion(&self, index: u32, corrections: &[Correction], extent: i64) -> PlacedMotion {
        let ulps = |vector: Vec2| [vector.x.to_bits(), vector.y.to_bits()];
        let Flight { position, displacement, rotation, .. } = &self.flights[index as usize];
        let mut motion = PlacedMotion {
            centre: ulps(*position),
            way: ulps(*displacement),
            rotation: rotation.to_bits(),
            placed_rotation: self.body(index).way.rotation.to_bits(),
            extent,
        };
        if let Some(change) = corrections.get(index as usize) {
            let [x, y] = ulps(change.displacement.map(FxAccumulator::value));
            motion.way = [motion.way[0].saturating_add(x), motion.way[1].saturating_add(y)];
            motion.rotation = motion.rotation.saturating_add(change.rotation.value().to_bits());
        }
        motion
    }

    /// The flight of the body in a slot, if it has one.
    pub(super) fn at(&self, slot: u32) -> Option<u32> {
        Some(self.flight_of.get(slot)).filter(|&flight| flight != NONE)
    }

    /// Returns true if the body in a slot has a flight.
    pub(super) fn has(&self, slot: u32) -> bool {
        self.flight_of.get(slot) != NONE
    }

    pub(super) fn len(&self) -> usize {
        self.flights.len()
    }

    pub(super) fn all(&self) -> &[Flight] {
        &self.flights
    }

    /// The motion of an outline over the step.
    pub(super) fn reach(&self, side: &PairSide<'_>) -> Reach {
        Reach::new(self.flight(side.flight), side.radius())
    }

    pub(super) fn flight(&self, flight: u32) -> &Flight {
        &self.flights[flight as usize]
    }

    /// The ways of two bodies to the moment of manifolds.
    pub(super) fn ways(&self, flights: [u32; 2]) -> [Way; 2] {
        flights.map(|flight| self.body(flight).way)
    }

    pub(super) fn body(&self, flight: u32) -> &Place {
        &self.places[flight as usize]
    }
}
