//! The contacts of a step in groups of lanes, by phase, and the order in which they are put there.
//!
//! Reads: contacts, the graph, [`BodyRows`]. Writes: [`ContactGroups`], and rows of fixed bodies that move.

use alloc::vec::Vec;
use core::ops::Range;

use super::batch::Batch;
use super::bodies::{BodyRows, STILL};
use super::graph::{Graph, PHASES};
use super::group::Group;
use super::matrix::set_matrices;
use super::unit::{FINEST, Scale};
use super::wedge::Push;
use super::{Contact, StepInput};
use crate::fx::Fx;
use crate::kernel::simd::{self, GROUP, Job, Lanes};

/// The place of a contact in the groups.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    pub(super) contact: u32,
    pub(super) group: u32,
    pub(super) lane: u32,
    /// log2 of the unit of its impulses, N·s.
    pub(super) exponent: i32,
}

/// The contacts, joints or rows of a phase at each body: a body that has several moves its share by each of them.
#[derive(Clone, Debug, Default)]
pub(super) struct Shares {
    /// The number by body, for each phase.
    pub(super) counts: Vec<[u32; PHASES]>,
    /// Rows of the bodies that they can move, by phase.
    pub(super) touched: [Vec<u32>; PHASES],
}

impl Shares {
    /// Begins to count, for this number of bodies.
    pub(super) fn clear(&mut self, bodies: usize) {
        self.counts.clear();
        self.counts.resize(bodies, [0; PHASES]);
        self.touched.iter_mut().for_each(Vec::clear);
    }

    /// Counts a contact or joint of a phase at its bodies.
    #[inline(always)]
    pub(super) fn count(&mut self, row_of: &[u32], phase: usize, bodies: [u32; 2]) {
        for body in bodies {
            let count = &mut self.counts[body as usize][phase];
            let row = row_of[body as usize];
            *count += 1;
            if *count == 1 && row != STILL {
                self.touched[phase].push(row);
            }
        }
    }
}

/// The contacts of a step, in groups.
#[derive(Clone, Debug, Default)]
pub(super) struct ContactGroups {
    pub(super) groups: Vec<Group>,
    /// The part of `groups` of each phase.
    pub(super) phases: [Range<usize>; PHASES],
    pub(super) shares: Shares,
    /// Phase by contact, [`PHASES`] for contacts of bodies that cannot be moved; contacts sorted by phase, without these.
    pub(super) phase_of: Vec<u8>,
    order: Vec<u32>,
    /// The part of `order` of each phase.
    sorted: [Range<usize>; PHASES],
    pub(super) places: Vec<Place>,
    /// True if a contact resists rolling.
    pub(super) has_rolls: bool,
    batch: Batch,
}

impl ContactGroups {
    /// Puts the contacts into groups, phase by phase. With the graph of the step before, as many contacts are the same contacts.
    pub(super) fn set(
        &mut self,
        input: &StepInput<'_>,
        graph: &Graph,
        is_new_graph: bool,
        bodies: &mut BodyRows,
        pushes: &mut Vec<Push>,
    ) {
        self.places.clear();
        pushes.clear();
        if is_new_graph || self.phase_of.len() != input.contacts.len() {
            self.sort(input.contacts, graph, bodies);
        }
        self.has_rolls = input.contacts.iter().any(|contact| contact.rolling_resistance != Fx::ZERO);
        let scale = Scale::new(input.clock, input.softness, FINEST);
        self.batch.begin(&scale);
        simd::run(SetGroups { groups: self, input, bodies, scale, pushes });
    }

    /// The place of a contact by its index, with its group and lane.
    pub(super) fn lane_of(&self, place: u32) -> (&Place, &Group, usize) {
        let place = &self.places[place as usize];
        (place, &self.groups[place.group as usize], place.lane as usize)
    }

    /// Adds the present impulses to the sums over sub-steps, or takes them off again, by the sign.
    pub(super) fn add_applied(&mut self, sign: i64) {
        for group in &mut self.groups {
            for (applied, impulses) in group.applied.iter_mut().zip(&group.impulses) {
                for (applied, impulse) in applied.iter_mut().zip(impulses) {
                    *applied += sign * impulse;
                }
            }
        }
    }

    /// The number of each contact that was solved, its impulses along the normal over the step by point, and log2 of their unit.
    pub(super) fn totals(&self) -> impl Iterator<Item = (u32, [i64; 2], i32)> + '_ {
        self.places.iter().map(|place| {
            let applied = &self.groups[place.group as usize].applied;
            let lane = place.lane as usize;
            (place.contact, [applied[0][lane], applied[1][lane]], place.exponent)
        })
    }

    /// Sorts the contacts by phase, and counts them by body and phase.
    fn sort(&mut self, contacts: &[Contact], graph: &Graph, bodies: &BodyRows) {
        let Self { shares, order, sorted, phase_of, .. } = self;
        shares.clear(bodies.row_of.len());
        phase_of.clear();
        let mut counts = [0; PHASES];
        for contact in contacts {
            let phase = graph.phase(contact.bodies);
            shares.count(&bodies.row_of, phase, contact.bodies);
            let can_move = graph.mover(contact.bodies).is_some();
            counts[phase] += usize::from(can_move);
            phase_of.push(if can_move { phase as u8 } else { PHASES as u8 });
        }
        let mut ends = [0, counts[0], counts[0] + counts[1]];
        order.clear();
        order.resize(counts.iter().sum(), 0);
        for (index, &phase) in phase_of.iter().enumerate() {
            if let Some(end) = ends.get_mut(usize::from(phase)) {
                order[*end] = index as u32;
                *end += 1;
            }
        }
        (0..PHASES).for_each(|phase| sorted[phase] = ends[phase] - counts[phase]..ends[phase]);
    }
}

/// Puts the contacts of all phases into groups.
struct SetGroups<'a> {
    groups: &'a mut ContactGroups,
    input: &'a StepInput<'a>,
    bodies: &'a mut BodyRows,
    /// The scale of the contact before.
    scale: Scale,
    /// Contacts that push a body out of one that does not give way.
    pushes: &'a mut Vec<Push>,
}

impl Job for SetGroups<'_> {
    type Result = ();

    #[inline(always)]
    fn run<L: Lanes>(mut self, lanes: L) {
        let order = core::mem::take(&mut self.groups.order);
        let mut at = 0;
        for phase in 0..PHASES {
            let begin = at;
            for indices in order[self.groups.sorted[phase].clone()].chunks(GROUP) {
                self.set_group(lanes, at, indices, phase);
                at += 1;
            }
            self.groups.phases[phase] = begin..at;
        }
        self.groups.groups.truncate(at);
        self.groups.order = order;
    }
}

impl SetGroups<'_> {
    /// Writes a group of contacts.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn set_group<L: Lanes>(&mut self, lanes: L, at: usize, indices: &[u32], phase: usize) {
        if self.groups.groups.len() == at {
            self.groups.groups.push(Group::empty(STILL));
        }
        let is_short = self.load(at, indices, phase);
        let Self { groups: ContactGroups { groups, batch, .. }, input, .. } = self;
        let group = &mut groups[at];
        group.count = indices.len();
        (group.applied, group.weighted) = ([[0; GROUP]; 3], [[0; GROUP]; 3]);
        batch.clear(indices.len()..GROUP);
        group.clear(indices.len()..GROUP);
        batch.fill(lanes, group, is_short, input.clock.short_rate().0);
        set_matrices(lanes, batch, group);
        for at in (0..GROUP).step_by(L::WIDTH) {
            batch.start(lanes, group, at);
        }
        batch.limit_pushes(lanes, group);
        self.add_places(at, indices);
    }

    /// Loads the contacts and their bodies. Returns true if a length is below a quarter of a metre.
    #[inline(always)]
    fn load(&mut self, at: usize, indices: &[u32], phase: usize) -> bool {
        let Self { groups: ContactGroups { groups, shares, batch, .. }, input, bodies, scale, .. } = self;
        let group = &mut groups[at];
        let mut min_length = 0;
        for (lane, &index) in indices.iter().enumerate() {
            let contact = &input.contacts[index as usize];
            let ends = contact.bodies.map(|body| body as usize);
            let (mut row_a, mut row_b) = (bodies.bodies[ends[0]].row, bodies.bodies[ends[1]].row);
            let (body_a, body_b) = (&bodies.bodies[ends[0]], &bodies.bodies[ends[1]]);
            let unit = if row_a != STILL { body_a.unit } else { body_b.unit };
            min_length = body_a.length.min(body_b.length).min(min_length);
            batch.masses[0][lane] = body_a.masses;
            batch.masses[1][lane] = body_b.masses;
            if scale.unit != unit {
                *scale = Scale::new(input.clock, input.softness, unit);
            }
            if !batch.has_scale(lane, unit) {
                batch.set_scale(lane, scale);
            }
            let soft = if body_a.is_held || body_b.is_held { &scale.fixed } else { &scale.moving };
            (group.push_out[lane], batch.compliance[lane]) = (soft.push_out, soft.compliance.into());
            if body_a.is_carrier || body_b.is_carrier {
                row_a = bodies.row(input, contact.bodies[0], unit);
                row_b = bodies.row(input, contact.bodies[1], unit);
            }
            (group.a[lane], group.b[lane]) = (row_a, row_b);
            let (change_a, change_b) = (bodies.rows.flight(row_a).change, bodies.rows.flight(row_b).change);
            batch.change[lane] = [change_b[0] - change_a[0], change_b[1] - change_a[1]];
            batch.share[0][lane] = shares.counts[ends[0]][phase].into();
            batch.share[1][lane] = shares.counts[ends[1]][phase].into();
            group.normal[lane] = contact.normal;
            batch.load(lane, contact);
        }
        // Arms are in 2^-30 of the length.
        min_length < -2
    }

    /// Lists the places of the contacts of a group.
    #[inline(always)]
    fn add_places(&mut self, at: usize, indices: &[u32]) {
        let Self { groups: ContactGroups { groups, batch, places, .. }, pushes, .. } = self;
        let group = &groups[at];
        for (lane, &index) in indices.iter().enumerate() {
            if !batch.moves(lane) {
                continue;
            }
            let place =
                Place { contact: index, group: at as u32, lane: lane as u32, exponent: batch.exponent[lane] as i32 };
            let is_held = [batch.moved[0][lane] == 0, batch.moved[1][lane] == 0];
            if is_held[0] != is_held[1] && group.separation[lane][0].min(group.separation[lane][1]) < 0 {
                pushes.push(Push::new(group, lane, is_held, places.len() as u32));
            }
            places.push(place);
        }
    }
}
