//! The bodies that take part in contacts in a step, each with its *flight*: its motion over the step without contacts.

use alloc::vec::Vec;

use super::numerics::Numerics;
use super::stamped::Stamped;
use super::{Scene, Start};
use crate::body::{Activity, BodyKind};
use crate::scalar::Scalar;
use crate::slots::NONE;

/// The part that a body takes in contacts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FlightOf {
    /// A body that impulses move.
    Dynamic,
    /// A body that moves as set, whatever touches it.
    Kinematic,
    Asleep,
    Static,
}

/// A body: its slot, its pose at the start and its kind.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place<P> {
    pub(super) slot: u32,
    pub(super) pose: P,
    pub(super) kind: FlightOf,
    /// The dominance: a contact of two dynamic bodies does not move the body with the higher one.
    pub(super) dominance: i32,
    /// The largest distance of a point of its colliders from the centre of mass, ulps; 0 for discs around it, which look alike at all
    /// angles.
    pub(super) reach: i64,
    /// The least width of its colliders, ulps.
    pub(super) width: i64,
    /// False while the flight lacks the values that only contacts need: few bodies of a step touch something.
    is_complete: bool,
}

/// The flights of a step: moving bodies in the order of `Scene::starts`, then bodies that stand still, in the order in which pairs name
/// them.
#[derive(Debug)]
pub(super) struct Flights<F, P> {
    flights: Vec<F>,
    /// The body of each flight.
    places: Vec<Place<P>>,
    /// The number of the flight by the slot of the body.
    of: Stamped,
    /// The follower of each flight and the leader of each follower, or [`NONE`]; empty if there are no followers.
    followers: Vec<u32>,
}

impl<F, P> Default for Flights<F, P> {
    fn default() -> Self {
        Self { flights: Vec::new(), places: Vec::new(), of: Stamped::default(), followers: Vec::new() }
    }
}

impl<F, P> Flights<F, P> {
    /// Lists the bodies that move.
    pub(super) fn begin<S: Scalar, N: Numerics<S, Flight = F, Pose = P>>(&mut self, scene: &Scene<'_, S>) {
        self.flights.clear();
        self.places.clear();
        self.of.clear();
        self.followers.clear();
        for start in scene.starts {
            self.push_moving::<S, N>(scene, start);
        }
    }

    fn push_moving<S: Scalar, N: Numerics<S, Flight = F, Pose = P>>(&mut self, scene: &Scene<'_, S>, start: &Start<S>) {
        let (bodies, dense) = (scene.bodies, start.dense);
        let slot = bodies.id(dense).slot;
        let (mut shows_angle, mut reach, mut width) = (false, 0, i64::MAX);
        for collider in scene.colliders.solid_of_slot(slot) {
            // Discs around the centre look alike at all angles.
            if !collider.is_central_disc() {
                (shows_angle, reach) = (true, N::ulps(collider.radius).max(reach));
            }
            width = N::ulps(collider.width).min(width);
        }
        let pose = N::pose(start.position, if shows_angle { start.angle } else { S::Angle::default() });
        self.flights.push(N::moving(scene, start, &pose));
        let info = bodies.info(dense);
        let kind = if info.kind == BodyKind::Dynamic { FlightOf::Dynamic } else { FlightOf::Kinematic };
        self.place(Place { slot, pose, kind, dominance: info.dominance, reach, width, is_complete: false });
    }

    #[cold]
    fn push_still<S: Scalar, N: Numerics<S, Flight = F, Pose = P>>(
        &mut self,
        scene: &Scene<'_, S>,
        slot: u32,
        dense: usize,
    ) -> u32 {
        let motion = &scene.bodies.columns.motion;
        let position = motion.position.get(dense);
        self.flights.push(N::still(position));
        let is_asleep = scene.bodies.activity(dense) == Activity::Asleep;
        let kind = if is_asleep { FlightOf::Asleep } else { FlightOf::Static };
        let pose = N::pose(position, motion.angle[dense]);
        self.place(Place { slot, pose, kind, dominance: 0, reach: 0, width: 0, is_complete: true })
    }

    fn place(&mut self, place: Place<P>) -> u32 {
        let flight = self.places.len() as u32;
        self.of.set(place.slot, flight);
        self.places.push(place);
        flight
    }

    /// Completes a flight of which a contact is found.
    pub(super) fn complete<S: Scalar, N: Numerics<S, Flight = F, Pose = P>>(
        &mut self,
        scene: &Scene<'_, S>,
        flight: u32,
    ) {
        let at = flight as usize;
        if let (false, Some(start)) = (self.places[at].is_complete, scene.starts.get(at)) {
            N::complete(scene, start, &mut self.flights[at]);
            self.places[at].is_complete = true;
        }
    }

    /// The flights of a contact, which are complete. For two dynamic bodies of unlike dominance, a follower stands for the higher one.
    pub(super) fn by_dominance<S: Scalar, N: Numerics<S, Flight = F, Pose = P>>(&mut self, ends: [u32; 2]) -> [u32; 2]
    where
        P: Copy,
    {
        let [a, b] = ends.map(|flight| &self.places[flight as usize]);
        let dynamic = FlightOf::Dynamic;
        if a.dominance == b.dominance || a.kind != dynamic || b.kind != dynamic {
            return ends;
        }
        let side = usize::from(a.dominance < b.dominance);
        let mut ends = ends;
        ends[side] = self.follower::<S, N>(ends[side]);
        ends
    }

    #[cold]
    fn follower<S: Scalar, N: Numerics<S, Flight = F, Pose = P>>(&mut self, leader: u32) -> u32
    where
        P: Copy,
    {
        self.followers.resize(self.flights.len() + 1, NONE);
        if self.followers[leader as usize] != NONE {
            return self.followers[leader as usize];
        }
        let follower = self.flights.len() as u32;
        self.followers[leader as usize] = follower;
        self.followers[follower as usize] = leader;
        self.flights.push(N::follower(&self.flights[leader as usize], leader));
        self.places.push(Place { kind: FlightOf::Kinematic, ..self.places[leader as usize] });
        follower
    }

    /// The leader of a follower, or the flight itself.
    pub(super) fn leader(&self, flight: u32) -> u32 {
        // Leaders have lower numbers than their followers.
        match self.followers.get(flight as usize) {
            Some(&other) if other < flight => other,
            _ => flight,
        }
    }

    /// The flight of a body.
    #[inline(always)]
    pub(super) fn of<S: Scalar, N: Numerics<S, Flight = F, Pose = P>>(
        &mut self,
        scene: &Scene<'_, S>,
        slot: u32,
    ) -> u32 {
        match self.of.get(slot) {
            // A pair names only colliders whose bodies exist.
            NONE => scene.bodies.index_in(slot).map_or(0, |dense| self.push_still::<S, N>(scene, slot, dense)),
            flight => flight,
        }
    }

    /// Returns true if the body in a slot has a flight.
    pub(super) fn has(&self, slot: u32) -> bool {
        self.of.get(slot) != NONE
    }

    pub(super) fn len(&self) -> usize {
        self.flights.len()
    }

    pub(super) fn all(&self) -> &[F] {
        &self.flights
    }

    pub(super) fn flight(&self, flight: u32) -> &F {
        &self.flights[flight as usize]
    }

    pub(super) fn body(&self, flight: u32) -> &Place<P> {
        &self.places[flight as usize]
    }
}
