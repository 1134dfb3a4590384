//! The contacts of a step: from the free flights of bodies to impulses.
//!
//! Reads: bodies at the end of their free flight, colliders, the contacts of the step before. Writes: contacts with their impulses, the
//! changes of bodies by impulses, the ends of fast paths.
//!
//! The parts are arguments of each other, in the order of a step: `flights`, `resting`, `pairs`, `rules`, `narrow`, `contacts`, `again` and
//! `sweeps`. Each has the memory of its own work, and none keeps another one.

mod near;

use alloc::sync::Arc;
use alloc::vec::Vec;

use self::near::{NearPair, push_meeting};
use super::actors::CHUNK;
use super::again::Again;
use super::deflected::list_deflected;
use super::events::{find_touches, list_hits, read_totals};
use super::flights::{FlightKind, Flights};
use super::joints::JointList;
use super::list::ContactList;
use super::narrow::Narrow;
use super::pairs::Pairs;
use super::resting::Resting;
use super::rules::Rules;
use super::split::{Part, Solvers};
use super::sweep::{Paths, Sweeps};
use super::{ContactHit, ContactSet, Correction, Detected, Scene, Stop};
use crate::collide::broad::Statics;
use crate::collide::sweep::Path;
use crate::collider::{Collider, ColliderSet, OutlineId};
use crate::scalar::Scalar;
use crate::slots::BodyId;
use crate::solve::{ContactSolver, Impulses};
#[cfg(feature = "timers")]
use crate::timers::Timers;
use crate::timers::{counted, timed};

/// The search for the contacts of a world, and its memory. No result depends on earlier steps through it.
#[derive(Debug, Default)]
pub(crate) struct Pipeline {
    flights: Flights,
    resting: Resting,
    pairs: Pairs,
    rules: Rules,
    narrow: Narrow,
    joints: JointList,
    contacts: ContactList,
    again: Again,
    sweeps: Sweeps,
    /// The pairs of a chunk.
    near_pairs: Vec<NearPair>,
    /// Of the current step.
    #[cfg(feature = "timers")]
    pub(crate) timers: Timers,
}

impl Pipeline {
    /// Finds the contacts at the start poses, with the impulses that they start from. Adds to `touched` the sleeping bodies that a
    /// moving one touches or that have too many pairs, and to `crowded` the indices in the columns of moving bodies with too many pairs.
    /// If there are any, the contacts are incomplete: the step wakes or quarantines the bodies and calls this again.
    pub(crate) fn detect(&mut self, scene: &Scene<'_>, detected: &mut Detected) {
        let Some(list) = timed!(self, pairs, self.find_pairs(scene, detected)) else { return };
        counted!(self, pairs, list.len());
        timed!(self, manifolds, self.find_contacts(scene, &list, &mut detected.touched));
        self.pairs.put_back(list);
    }

    /// The first part of [`detect`](Self::detect): the pairs that may touch, sorted; none if there are bodies to wake or to quarantine.
    fn find_pairs(&mut self, scene: &Scene<'_>, detected: &mut Detected) -> Option<Vec<[u32; 2]>> {
        let Self { flights, resting, pairs, rules, narrow, contacts, again, sweeps, .. } = self;
        contacts.clear();
        again.clear();
        sweeps.deflected.clear();
        narrow.begin(resting.update(scene, &mut detected.changed_resting));
        flights.begin(scene, &resting.numbers);
        pairs.find(scene, flights, resting, narrow);
        list_crowded(scene, resting, pairs.crowded(), detected);
        if !detected.crowded.is_empty() || !detected.touched.is_empty() {
            return None;
        }
        let mut list = pairs.take();
        resting.pair_changed(scene, &detected.changed_resting, &mut list);
        rules.filter(scene, flights, resting, narrow, &detected.changed_resting, &mut list);
        Some(list)
    }

    /// The second part: the contacts of these pairs.
    fn find_contacts(&mut self, scene: &Scene<'_>, list: &[[u32; 2]], touched: &mut Vec<BodyId>) {
        let mut next_record = 0;
        for chunk in list.chunks(CHUNK) {
            self.find_near(scene, chunk, &mut next_record);
            self.narrow.collide_pairs();
            self.push_contacts(scene, touched);
        }
    }

    /// Adds to `touched` the sleeping bodies that the bodies of `scene.starts` touch; none where bodies have too many pairs. The bodies of
    /// `scene.starts` woke since contacts were detected, and nothing else has changed.
    pub(crate) fn spread(&mut self, scene: &Scene<'_>, detected: &mut Detected) {
        let Self { flights, resting, pairs, rules, narrow, .. } = self;
        // Bodies with too many pairs are at fault before they touch anything.
        if !pairs.crowded().is_empty() {
            return;
        }
        narrow.forget_placed();
        flights.begin(scene, &resting.numbers);
        let mut list = pairs.take_with_sleepers(scene, flights, resting, narrow);
        rules.one_way.leave_out_passing(scene, flights, resting, narrow, &detected.changed_resting, &mut list);
        for &pair in &list {
            let sides = pair.map(|number| flights.side(scene, &resting.numbers, number));
            let [Some(first), Some(second)] = &sides else { continue };
            if narrow.start_manifold(scene, flights, resting, [first, second]).is_some() {
                Pairs::add_sleepers(scene, [first.collider.body, second.collider.body], &mut detected.touched);
            }
        }
        pairs.put_back(list);
    }

    /// Solves the joints and contacts, and writes the change of each body of `scene.starts` to `corrections`; none if there was no
    /// impulse.
    pub(crate) fn solve<C: ContactSolver>(
        &mut self,
        solvers: &mut Solvers<C>,
        scene: &Scene<'_>,
        corrections: &mut Vec<Correction>,
    ) {
        let Self { flights, joints, contacts, .. } = self;
        joints.set(scene, flights);
        contacts.totals.clear();
        contacts.touched.clear();
        if joints.is_empty() && contacts.is_empty() {
            corrections.clear();
            return;
        }
        counted!(self, contacts, contacts.len());
        counted!(self, points, contacts.solver_contacts.iter().map(|contact| contact.count).sum::<usize>());
        let (options, time_step) = (scene.settings.into(), scene.time_step);
        let (solver_joints, solver_contacts) = (&mut joints.solver_joints, &mut contacts.solver_contacts);
        timed!(
            self,
            setup,
            solvers.solve(time_step, &options, flights.all(), solver_joints, solver_contacts, corrections)
        );
        #[cfg(feature = "timers")]
        self.timers.add_solver(solvers.take_timers());
        // Moving bodies have the first flights.
        corrections.truncate(scene.starts.len());
        timed!(self, events, self.read_events(solvers, scene, None));
        timed!(self, apply, mark_pushing(&self.joints, &self.contacts, &self.flights, corrections));
    }

    /// Adds the contacts that deflected bodies meet on the paths of these corrections, and to `touched` the sleeping bodies. Returns true if
    /// there is a contact.
    pub(crate) fn add_deflected(
        &mut self,
        scene: &Scene<'_>,
        corrections: &[Correction],
        touched: &mut Vec<BodyId>,
    ) -> bool {
        let Self { flights, resting, pairs, rules, narrow, joints, contacts, again, sweeps, .. } = self;
        #[cfg(feature = "selftest")]
        if narrow.is_discrete {
            return false;
        }
        let known = contacts.len();
        let solver_joints = &joints.solver_joints;
        let solver_contacts = &contacts.solver_contacts;
        list_deflected(scene, corrections, flights, solver_joints, solver_contacts, again, &mut sweeps.deflected);
        if !sweeps.deflected.is_empty() {
            let paths = Paths { scene, corrections, is_corrected: false };
            sweeps.fast.clone_from(&sweeps.deflected);
            let takes_part = |flight: u32| !again.is_in_large_island(flight);
            sweeps.find_pairs(&paths, flights, resting, rules, Some(pairs), &takes_part);
            for &pair in &sweeps.pairs {
                let sides = pair.map(|number| flights.side(scene, &resting.numbers, number));
                let [Some(first), Some(second)] = &sides else { continue };
                if contacts.has([first.id, second.id], known) {
                    continue;
                }
                let Some(meeting) = narrow.meet_on_paths(&paths, flights, resting, [first, second]) else { continue };
                let count = touched.len();
                let asleep = [first, second].into_iter().filter(|side| side.kind == FlightKind::Asleep);
                touched.extend(asleep.map(|side| side.collider.body));
                if touched.len() == count {
                    let actors = pair.map(|number| narrow.actor(scene, flights, resting, number));
                    let [Some(first), Some(second)] = actors else { continue };
                    let start = Impulses::default();
                    push_meeting(contacts, scene, flights, &narrow.actors, [first, second], &meeting, start);
                }
            }
        }
        if contacts.len() == known {
            // Bodies that meet nothing on their new ways are swept as others are.
            sweeps.deflected.clear();
            return false;
        }
        let added = &contacts.solver_contacts[known..];
        counted!(self, contacts, added.len());
        counted!(self, points, added.iter().map(|contact| contact.count).sum::<usize>());
        again.added.extend(added.iter().flat_map(|contact| contact.bodies));
        contacts.sort_from(known);
        true
    }

    /// Solves the islands again that the added contacts belong to, from the start of the step.
    pub(crate) fn solve_again<C: ContactSolver>(
        &mut self,
        solvers: &mut Solvers<C>,
        scene: &Scene<'_>,
        corrections: &mut Vec<Correction>,
    ) {
        let mut again = core::mem::take(&mut self.again);
        let Self { flights, joints, contacts, .. } = self;
        let part = timed!(self, again, again.solve(solvers, scene, flights, joints, contacts, corrections));
        #[cfg(feature = "timers")]
        self.timers.add_again(solvers.take_timers());
        timed!(self, events, self.read_events(solvers, scene, Some(part)));
        timed!(self, apply, mark_pushing(&self.joints, &self.contacts, &self.flights, corrections));
        self.again = again;
    }

    /// Lists the bodies that are deflected still after all rounds: they are swept as bullets are.
    pub(crate) fn find_deflected(&mut self, scene: &Scene<'_>, corrections: &[Correction]) {
        let Self { flights, joints, contacts, again, sweeps, .. } = self;
        let (joints, contacts) = (&joints.solver_joints, &contacts.solver_contacts);
        list_deflected(scene, corrections, flights, joints, contacts, again, &mut sweeps.deflected);
    }

    /// Reads the impulses of joints that may break, and the impulses and impacts of events from the solvers, if a collider has events. The
    /// solvers have solved all joints and contacts, or the joints and contacts of this part.
    fn read_events<C: ContactSolver>(&mut self, solvers: &Solvers<C>, scene: &Scene<'_>, part: Option<&Part>) {
        let Self { flights, resting, narrow, joints, contacts, .. } = self;
        if scene.joints.may_any_break() {
            joints.read_totals(solvers, part);
        }
        if scene.colliders.any_contact_events() || scene.colliders.any_hit_events() {
            read_totals(contacts, solvers, part);
            find_touches(contacts, scene, flights, resting, narrow);
        }
    }

    /// Lists the contacts with impulses: before [`solve`](Self::solve) with the impulses that they start from, and after it also the
    /// contacts that touched and have events. Lists also the answers of one-way colliders and the pairs of bodies that stay excluded.
    pub(crate) fn list(&self, contacts: &mut ContactSet) {
        self.contacts.list_records(&mut contacts.records);
        self.rules.list(contacts);
    }

    /// The joints that were solved, with their impulses.
    pub(crate) fn joints(&self) -> &JointList {
        &self.joints
    }

    /// Returns true if there are no contacts in the step.
    pub(crate) fn has_no_contacts(&self) -> bool {
        self.contacts.is_empty()
    }

    /// Exchanges the impulses of all contacts with the impulses that they start from.
    pub(crate) fn swap_starts(&mut self) {
        self.contacts.swap_starts();
    }

    /// Lists the hits of contacts that were solved.
    pub(crate) fn list_hits<S: Scalar>(&self, scene: &Scene<'_>, hits: &mut Vec<ContactHit<S>>) {
        list_hits(&self.contacts, scene, hits);
    }

    /// Calls `visit` with the slots of the two bodies of each contact, and true if a surface of one of them moves.
    pub(crate) fn touching(&self, colliders: &ColliderSet, visit: impl FnMut([u32; 2], bool)) {
        self.contacts.each_body_pair(colliders, visit);
    }

    /// Finds the bodies whose paths end before the end of the tick, lest they cross something, and their poses then. `paths` has the bodies
    /// as impulses left them. Bodies at fault are left out.
    pub(crate) fn end_fast_paths(
        &mut self,
        paths: &Paths<'_>,
        is_faulty: &dyn Fn(usize) -> bool,
        stops: &mut Vec<Stop>,
    ) {
        let Self { flights, resting, rules, sweeps, .. } = self;
        sweeps.end_fast_paths(paths, flights, resting, rules, is_faulty, stops);
    }

    /// Visits the final paths of fast bodies, which may end early, with the slots of the bodies.
    pub(super) fn each_fast_path(&self, paths: &Paths<'_>, visit: impl FnMut(u32, Path)) {
        self.sweeps.each_fast_path(paths, &self.flights, visit);
    }

    /// The path of a collider's body, if it moved more than a quarter of the collider's least width.
    pub(super) fn path_if_fast(&self, paths: &Paths<'_>, collider: &Collider) -> Option<Path> {
        self.sweeps.path_if_fast(paths, &self.flights, collider)
    }

    /// The tree of static colliders of the last search, if it belongs to these colliders.
    pub(crate) fn statics(&self, colliders: &ColliderSet) -> Option<&Arc<Statics>> {
        self.resting.current(colliders).map(|trees| &trees.statics)
    }

    /// The tree of the colliders of sleeping bodies of the last search, likewise.
    pub(crate) fn sleepers(&self, colliders: &ColliderSet) -> Option<&Statics> {
        self.resting.current(colliders).map(|trees| &trees.sleepers)
    }

    /// An outline by its number in [`statics`](Self::statics) and [`sleepers`](Self::sleepers).
    pub(crate) fn outline(&self, number: u32) -> OutlineId {
        self.resting.numbers.outline(number)
    }

    /// The number of the first outline of the collider in a slot, likewise.
    pub(crate) fn number(&self, slot: u32) -> u32 {
        self.resting.numbers.first(slot)
    }

    /// Finds contacts ahead of time or not, for tests.
    #[cfg(feature = "selftest")]
    pub(crate) fn set_discrete(&mut self, is_discrete: bool) {
        self.narrow.is_discrete = is_discrete;
    }

    /// Takes over the caches of the contacts of another world, of which this world is a copy.
    pub(crate) fn clone_cached_from(&mut self, source: &Self) {
        if self.resting.copy_from(&source.resting) {
            self.narrow.forget_tiles();
        }
    }
}

/// Takes note of bodies that push others, which are not at rest even if nothing moves them. There are no corrections without impulses.
fn mark_pushing(joints: &JointList, contacts: &ContactList, flights: &Flights, corrections: &mut Vec<Correction>) {
    let mut mark = |bodies: [u32; 2]| {
        for body in bodies {
            if let Some(correction) = corrections.get_mut(flights.leader(body) as usize) {
                correction.is_pushed = true;
            }
        }
    };
    contacts.pushing().for_each(&mut mark);
    joints.pulling().for_each(mark);
    if !corrections.iter().any(|correction| correction.is_pushed) {
        corrections.clear();
    }
}

/// Lists the bodies of outlines with too many pairs.
fn list_crowded(scene: &Scene<'_>, resting: &Resting, crowded: &[u32], detected: &mut Detected) {
    let outlines = crowded.iter().map(|&number| resting.numbers.outline(number));
    for collider in outlines.filter_map(|outline| scene.colliders.at(outline.slot)) {
        match scene.bodies.index_of(collider.body) {
            Some(dense) if dense < scene.bodies.moving() => detected.crowded.push(dense),
            // A sleeping body is at fault as if it were awake: sleep must not decide who is quarantined.
            Some(_) => detected.touched.push(collider.body),
            None => {}
        }
    }
}
