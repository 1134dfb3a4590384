//! The outlines of the bodies that move: what each step asks of them, and no step changes.
//!
//! Reads: starts, colliders, numbers. Writes: a list that stays from step to step while the same bodies move with the same colliders.

use alloc::vec::Vec;

use super::Scene;
use super::actors::Actor;
use super::coefficients::KEPT;
use super::flights::FlightKind;
use super::numbers::Numbers;
use crate::collider::{BodyOutline, Collider, Filter, Material, OutlineId};
use crate::fx::Fx;
use crate::math::Vec2;
use crate::slots::NONE;

/// The form of an outline, if a few numbers say all of it.
#[derive(Clone, Copy, Debug)]
pub(super) enum Form {
    Disc {
        centre: Vec2,
        radius: Fx,
    },
    /// A rectangle around the centre of mass that is not turned, and is the only outline of its body.
    Upright {
        corner: Vec2,
        radius: Fx,
    },
    Other,
}

impl Form {
    fn new(collider: &Collider, BodyOutline { outline, corners, is_upright, .. }: &BodyOutline) -> Self {
        let radius = outline.radius();
        match outline.corners() {
            [centre] => Self::Disc { centre: *centre, radius },
            _ if *is_upright && !collider.has_others() => Self::Upright { corner: corners.max, radius },
            _ => Self::Other,
        }
    }
}

/// An outline of a moving body.
#[derive(Clone, Copy, Debug)]
pub(super) struct MovingOutline {
    pub(super) number: u32,
    pub(super) id: OutlineId,
    pub(super) flight: u32,
    pub(super) form: Form,
    /// The largest distance of a point of it from the centre of mass of its body, ulps.
    pub(super) extent: i64,
    pub(super) filter: Filter,
    /// The slot of its body.
    pub(super) body: u32,
    /// The number of its material in the step, if it has one.
    material: Option<u8>,
    has_hits: bool,
    is_alone: bool,
}

impl MovingOutline {
    /// Its actor, without the kind of its flight and without its core, which each step finds.
    #[inline(always)]
    pub(super) fn actor(&self) -> Actor {
        let Self { number, id, flight, extent, material, has_hits, is_alone, .. } = *self;
        let (kind, core, shape) = (FlightKind::Dynamic, NONE, None);
        Actor { number, id, flight, kind, core, shape, material, has_hits, is_alone, extent }
    }
}

/// The outlines of all moving bodies, in the order of the flights.
#[derive(Debug, Default)]
pub(super) struct MovingOutlines {
    list: Vec<MovingOutline>,
    /// The end of the part of the list of each flight.
    ends: Vec<u32>,
    /// The materials by the numbers that outlines have for them.
    materials: Vec<Material>,
    /// The slots of the bodies.
    bodies: Vec<u32>,
    /// The revision of the colliders; `None` before the first step.
    revision: Option<u64>,
}

impl MovingOutlines {
    /// Lists the outlines anew, unless the same bodies move with the same colliders as before. The numbers follow from the colliders alone.
    pub(super) fn update(&mut self, scene: &Scene<'_>, numbers: &Numbers) {
        let revision = Some(scene.colliders.revision());
        let bodies = || scene.starts.iter().map(|start| start.body.slot);
        if self.revision == revision && bodies().eq(self.bodies.iter().copied()) {
            return;
        }
        self.revision = revision;
        self.bodies.clear();
        self.bodies.extend(bodies());
        self.list.clear();
        self.list.reserve(scene.starts.len());
        self.ends.clear();
        self.ends.reserve(scene.starts.len());
        self.materials.clear();
        for (flight, body) in (0..).zip(bodies()) {
            for collider in scene.colliders.solid_of_slot(body) {
                let first = numbers.first(collider.slot);
                let material = self.material(&collider.def.material);
                for part in 0..collider.outline_count() {
                    let outline = collider.outline(part);
                    let (number, id) = (first + part, OutlineId { slot: collider.slot, part });
                    let (form, extent) = (Form::new(collider, &outline), outline.radius.to_bits());
                    self.list.push(MovingOutline {
                        number,
                        id,
                        flight,
                        form,
                        extent,
                        filter: collider.def.filter,
                        body,
                        material,
                        has_hits: collider.def.hit_events,
                        is_alone: !collider.has_others() && !collider.def.shape.is_chain(),
                    });
                }
            }
            self.ends.push(self.list.len() as u32);
        }
    }

    pub(super) fn all(&self) -> &[MovingOutline] {
        &self.list
    }

    /// The outlines of the body of a flight.
    pub(super) fn of(&self, flight: u32) -> &[MovingOutline] {
        let index = flight as usize;
        let start = if index == 0 { 0 } else { self.ends[index - 1] };
        &self.list[start as usize..self.ends[index] as usize]
    }

    pub(super) fn materials(&self) -> &[Material] {
        &self.materials
    }

    /// The number of a material; `None` if there are too many of them.
    fn material(&mut self, material: &Material) -> Option<u8> {
        let known = self.materials.iter().position(|known| known == material);
        if known.is_none() && self.materials.len() < KEPT {
            self.materials.push(*material);
            return Some(self.materials.len() as u8 - 1);
        }
        known.map(|number| number as u8)
    }
}
