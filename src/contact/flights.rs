//! The bodies of a step that contacts know, with their free flight.

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
    /// A body that moves, and that no impulse changes.
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
    /// False if the flight lacks what only contacts need.
    is_complete: bool,
}

/// The flights of a step: those of moving bodies in the order of the starts, those of sleeping bodies, and those of static bodies as they
/// are met.
#[derive(Debug)]
pub(super) struct Flights<F, P> {
    flights: Vec<F>,
    /// Beside each flight its body.
    places: Vec<Place<P>>,
    /// By the slot of the body.
    of: Stamped,
}

impl<F, P> Default for Flights<F, P> {
    fn default() -> Self {
        Self { flights: Vec::new(), places: Vec::new(), of: Stamped::default() }
    }
}

impl<F, P> Flights<F, P> {
    /// Lists the bodies that move and those that sleep.
    pub(super) fn begin<S: Scalar, N: Numerics<S, Flight = F, Pose = P>>(&mut self, scene: &Scene<'_, S>) {
        self.flights.clear();
        self.places.clear();
        self.of.clear();
        for start in scene.starts {
            self.push_moving::<S, N>(scene, start);
        }
        if scene.bodies.any_asleep() {
            for dense in scene.bodies.asleep() {
                let slot = scene.bodies.id(dense).slot;
                if scene.colliders.of_slot(slot).next().is_some() {
                    self.push_still::<S, N>(scene, slot, dense);
                }
            }
        }
    }

    fn push_moving<S: Scalar, N: Numerics<S, Flight = F, Pose = P>>(&mut self, scene: &Scene<'_, S>, start: &Start<S>) {
        let (bodies, dense) = (scene.bodies, start.dense);
        let slot = bodies.id(dense).slot;
        // Discs around the centre look alike at all angles.
        let shows_angle = scene.colliders.of_slot(slot).any(|collider| !collider.is_central_disc());
        let pose = N::pose(start.position, if shows_angle { start.angle } else { S::Angle::default() });
        self.flights.push(N::moving(scene, start, &pose));
        let is_dynamic = bodies.info(dense).kind == BodyKind::Dynamic;
        let kind = if is_dynamic { FlightOf::Dynamic } else { FlightOf::Kinematic };
        self.place(Place { slot, pose, kind, is_complete: false });
    }

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
        self.place(Place { slot, pose: N::pose(position, motion.angle[dense]), kind, is_complete: true })
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

    /// The flight of a body.
    pub(super) fn of<S: Scalar, N: Numerics<S, Flight = F, Pose = P>>(
        &mut self,
        scene: &Scene<'_, S>,
        slot: u32,
    ) -> u32 {
        match self.of.get(slot) {
            // A pair names colliders whose bodies are there.
            NONE => scene.bodies.index_in(slot).map_or(0, |dense| self.push_still::<S, N>(scene, slot, dense)),
            flight => flight,
        }
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
