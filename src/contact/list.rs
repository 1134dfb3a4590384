//! The contacts of a step, in the order of their outlines.
//!
//! Reads: manifolds, one after the other; impulses of the solver. Writes: the contacts that the solver takes, and the records of the state.

use alloc::vec::Vec;

use super::approach::{Approach, approach};
use super::coefficients::Coefficients;
use super::flights::Flights;
use super::moment::take_back;
use super::narrow::Meeting;
use super::{ContactRecord, Scene};
use crate::collide::{Manifold, ManifoldPoint, SurfacePoint};
use crate::collider::{ColliderSet, OutlineId};
use crate::fx::Fx;
use crate::kernel::round::odd_shift;
use crate::math::Vec2;
use crate::solve::{Contact, Impulses, Point};

/// The points of a contact on the surfaces of both bodies, with their separations at the start of the step.
#[derive(Clone, Copy, Debug)]
pub(super) struct ContactPoints {
    /// The unit vector from the first to the second body, in 2^-30.
    pub(super) normal: [i32; 2],
    pub(super) count: usize,
    pub(super) points: [SurfacePoint; 2],
}

impl ContactPoints {
    pub(super) fn new(meeting: &Meeting) -> Self {
        let Meeting { manifold: Manifold { normal, count, points }, ways } = meeting;
        let mut surface_points = [SurfacePoint::default(); 2];
        for (surface_point, point) in surface_points.iter_mut().zip(points).take(*count) {
            *surface_point = on_surfaces(*normal, point);
            take_back(surface_point, *normal, ways);
        }
        Self { normal: *normal, count: *count, points: surface_points }
    }
}

/// A point with arms to the surface of each body: an open gap closes within the step.
#[inline(always)]
fn on_surfaces(normal: [i32; 2], point: &ManifoldPoint) -> SurfacePoint {
    let &ManifoldPoint { arm_a, arm_b, separation, feature } = point;
    // Half of the gap along the normal, below 2^87, oddly.
    let gap = i128::from(separation.to_bits().max(0));
    let [x, y] = normal.map(|component| Fx::from_bits(odd_shift(i128::from(component) * gap, 31) as i64));
    let half = Vec2::new(x, y);
    SurfacePoint { arms: [arm_a - half, arm_b + half], separation, feature }
}

/// The contacts of a step. Lists of the same length share their order, and a number is an index into them.
#[derive(Debug, Default)]
pub(super) struct ContactList {
    /// The contacts with the impulses that they start from.
    pub(super) detected: Vec<ContactRecord>,
    /// The contacts in the form that the solver takes.
    pub(super) solver_contacts: Vec<Contact>,
    /// The impulses along the normals over the step; empty where no collider has events.
    pub(super) totals: Vec<Impulses>,
    /// True for a contact that has events and touched in the step; empty where no collider has such events.
    pub(super) touched: Vec<bool>,
    /// Empty; swapped with `touched` while the contacts have the impulses that they start from.
    start_touched: Vec<bool>,
    /// The contacts that may be hits, with their numbers, which rise.
    pub(super) approaches: Vec<(u32, Approach)>,
}

impl ContactList {
    pub(super) fn clear(&mut self) {
        self.detected.clear();
        self.solver_contacts.clear();
        self.totals.clear();
        self.touched.clear();
        self.approaches.clear();
    }

    pub(super) fn len(&self) -> usize {
        self.detected.len()
    }

    pub(super) fn is_empty(&self) -> bool {
        self.detected.is_empty()
    }

    /// Adds a contact at the end: of two outlines and two complete flights, with the impulses that it starts from.
    #[inline(always)]
    pub(super) fn push(
        &mut self,
        pair: [OutlineId; 2],
        flights: [u32; 2],
        points: &ContactPoints,
        coefficients: &Coefficients,
        rolling_radius: Fx,
        start: Impulses,
    ) {
        let [first, second] = &points.points;
        let Coefficients { materials, surface_speed } = coefficients;
        self.solver_contacts.push(Contact {
            bodies: flights,
            normal: points.normal,
            count: points.count,
            points: [
                Point { arms: first.arms, separation: first.separation },
                Point { arms: second.arms, separation: second.separation },
            ],
            friction: materials.friction,
            restitution: materials.restitution,
            rolling_resistance: materials.rolling_resistance,
            rolling_radius,
            surface_speed: *surface_speed,
            impulses: start,
        });
        self.detected.push(ContactRecord::new(pair, [first.feature, second.feature], points.count, start));
    }

    /// Takes note that the last contact may be a hit.
    pub(super) fn add_approach(&mut self, scene: &Scene<'_>, flights: &Flights, meeting: &Meeting) {
        let Some(contact) = self.solver_contacts.last() else { return };
        let approach = approach(scene, meeting, contact, contact.bodies.map(|flight| flights.flight(flight)));
        self.approaches.push((self.detected.len() as u32 - 1, approach));
    }

    /// Returns true if a pair has a contact among the first `count`, which are sorted.
    pub(super) fn has(&self, pair: [OutlineId; 2], count: usize) -> bool {
        self.detected[..count].binary_search_by_key(&pair, ContactRecord::pair).is_ok()
    }

    /// Moves the contacts from number `first` on to their places among the contacts before, which are sorted. Each move shifts all contacts
    /// behind its place: such contacts are few.
    pub(super) fn sort_from(&mut self, first: usize) {
        for last in first..self.detected.len() {
            let pair = self.detected[last].pair();
            let place = self.detected[..last].partition_point(|contact| contact.pair() < pair);
            self.detected[place..=last].rotate_right(1);
            self.solver_contacts[place..=last].rotate_right(1);
            if !self.totals.is_empty() {
                self.totals.insert(place, Impulses::default());
            }
            for (number, _) in &mut self.approaches {
                match *number as usize {
                    index if index == last => *number = place as u32,
                    index if (place..last).contains(&index) => *number += 1,
                    _ => {}
                }
            }
        }
        self.approaches.sort_unstable_by_key(|(number, _)| *number);
    }

    /// Exchanges the impulses of all contacts with the impulses that they start from.
    pub(super) fn swap_starts(&mut self) {
        for (contact, detected) in self.solver_contacts.iter_mut().zip(&mut self.detected) {
            let start = detected.carried();
            *detected = detected.carrying(contact.impulses);
            contact.impulses = start;
        }
        core::mem::swap(&mut self.touched, &mut self.start_touched);
    }

    /// The bodies of the contacts with impulses.
    pub(super) fn pushing(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        let pushing = self.solver_contacts.iter().filter(|contact| contact.impulses.values != [0; 3]);
        pushing.map(|contact| contact.bodies)
    }

    /// Lists the records of the contacts with impulses, and of contacts that touched and have events.
    pub(super) fn list_records(&self, records: &mut Vec<ContactRecord>) {
        records.clear();
        for (number, (detected, contact)) in self.detected.iter().zip(&self.solver_contacts).enumerate() {
            let [first, second, tangent] = contact.impulses.values;
            if first | second | tangent != 0 || self.touched.get(number) == Some(&true) {
                records.push(detected.carrying(contact.impulses));
            }
        }
    }

    /// Calls `visit` with the slots of the two bodies of each contact, and true if a surface of one of them moves.
    pub(super) fn each_body_pair(&self, colliders: &ColliderSet, mut visit: impl FnMut([u32; 2], bool)) {
        for detected in &self.detected {
            if let [Some(a), Some(b)] = detected.pair().map(|outline| colliders.at(outline.slot)) {
                let is_driven = a.def.material.surface_speed_against(&b.def.material) != Fx::ZERO;
                visit([a.body.slot, b.body.slot], is_driven);
            }
        }
    }
}
