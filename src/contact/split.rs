//! Islands that are solved otherwise than the rest: in finer sub-steps, with more relax passes, and with joints and contacts in turn.
//!
//! *Heavy loads.* A soft contact is a spring: under the impulse P of a sub-step h it gives way by P·K·h/(hω)², where K is the sum of both
//! inverse masses and hω is the same for all contacts. A light body under a heavy one sinks in by that much: with 5 sub-steps of a step of
//! 1/60 s four boxes collapse under a fifth that is 1,000 times as heavy. The way is proportional to the square of the sub-step, so such an
//! island takes [`FINE_SUBSTEPS`].
//!
//! Whether it does follows from masses and levels alone: a body lies on another one if it is farther, in contacts and joints, from the bodies that
//! cannot be moved. (By the impulses of the step before, islands would change from one to the other and never rest: finer sub-steps push
//! out the overlaps that make the impulses large.) Records of contacts have the impulses over a sub-step of the settings, whatever sub-steps their
//! island takes.
//!
//! *Deep overlaps.* The solve pass gives bodies the velocity that pushes them out of each other, and the relax pass takes it back. It does
//! so contact by contact: where one body wedges another out, at many times its own speed, a pass takes back a few hundredths, and the rest
//! is energy from nothing. (A capsule that a ceiling pushes out by 15 cm squeezes a disc out below it, whose locks leave it one direction:
//! 27 m/s, and less than 1 m/s with 65 passes.) So an island with an overlap of more than [`DEEP_OVERLAP`] takes [`RELAX_PASSES`], if it has up to
//! [`FEW`] contacts: in piles overlaps are common, as loads and impacts make them, friction takes the energy away, and the passes would
//! cost more than all else.
//!
//! *Joints among contacts.* A pass over joints and one over contacts each undo a part of the other: a leg that lands is stopped by the floor, and
//! pulled into it by the body above, whose velocity takes some sub-steps to arrive. So an island with both takes [`JOINT_ROUNDS`] of them in
//! a sub-step: ten ragdolls that fall on crates open their hinges by 2.4 cm instead of 6.2, for a fifth of the time more. (Rounds in the relax pass
//! too throw them about.) Where joined bodies press on a body that is much lighter than all of them together, the impulses of contacts arrive late
//! at the joints behind them even so, and the bodies rock on the soft contacts for ever, as a spring does whose force lags behind its way. Such
//! islands take [`LOAD_ROUNDS`]: of 240 piles of ten ragdolls of 68 kg on crates of 0.64 kg six did not fall asleep. They relax contacts
//! [twice](LOAD_RELAX_PASSES), since the last contact of a pass leaves its impulse with the light body: crates that a ragdoll lands on had up to
//! 19 m/s for a step.
//!
//! *Threads.* With the feature `parallel` the islands are shared out between threads, a part and a solver each.
//!
//! A body that dominates others must not depend on them: how its island is solved does not follow from theirs. An island under such a body
//! is solved as the body's island is, if that one is special. If only its own contacts are, it is solved after the body's island, and sees
//! that body go along the flight that this has found.

mod assemblies;
mod shares;
mod task;

use alloc::vec::Vec;

use self::assemblies::Assemblies;
use self::shares::Shares;
use self::task::{SplitStep, Task, kind_options};
use crate::fx::Fx;
use crate::math::TimeStep;
use crate::slots::NONE;
use crate::solve::{
    Contact, ContactImpact, ContactSolver, Correction, Flight, Graph, Joint, SolverOptions, is_heavy, may_be_heavy,
};
#[cfg(feature = "timers")]
use crate::timers::Timers;

/// The sub-steps of islands under heavy loads: the most that a world may have.
const FINE_SUBSTEPS: u32 = 16;

/// The relax passes of a sub-step in islands with deep overlaps.
const RELAX_PASSES: u32 = 65;

/// The times that joints and contacts are solved in turn in a sub-step, in islands with both.
const JOINT_ROUNDS: u32 = 3;

/// The times in islands in which joined bodies are a load on a light body.
const LOAD_ROUNDS: u32 = 6;

/// The least relax passes of a sub-step in islands with such a load. With four, one pile of 240 gained 1.4 kJ in a step.
const LOAD_RELAX_PASSES: u32 = 2;

/// An overlap of more than this is deep, ulps: 2^-8 m. Most loads press bodies into each other by less.
const DEEP_OVERLAP: i64 = 1 << 24;

/// The largest number of contacts of an island that takes more relax passes.
const FEW: u32 = 32;

/// Ways in which an island is special, one bit each.
const IS_HEAVY: usize = 1;
const IS_DEEP: usize = 2;
const IS_JOINED: usize = 4;
/// Only where it is joined.
const IS_LOADED: usize = 8;
/// The number of sets of such bits. A superset is a larger number.
const KINDS: usize = 16;

/// Returns true for a contact with a deep overlap.
fn is_deep(contact: &Contact) -> bool {
    let [first, second] = &contact.points;
    let deeper = if contact.count == 1 { first.separation } else { first.separation.min(second.separation) };
    deeper.to_bits() < -DEEP_OVERLAP
}

/// Joints and contacts of whole islands, and their flights.
#[derive(Debug, Default)]
pub(super) struct Part {
    pub(super) flights: Vec<Flight>,
    /// The numbers of the flights among all.
    pub(super) flight_numbers: Vec<u32>,
    pub(super) joints: Vec<Joint>,
    /// The numbers of the joints among all.
    pub(super) joint_numbers: Vec<u32>,
    pub(super) contacts: Vec<Contact>,
    /// The numbers of the contacts among all.
    pub(super) contact_numbers: Vec<u32>,
    /// By the number among all flights: the number in the part, or [`NONE`].
    place: Vec<u32>,
    pub(super) corrections: Vec<Correction>,
}

impl Part {
    /// Copies the joints and contacts of bodies for which `is_taken` returns true, and the flights that they join. Leaders keep their numbers
    /// among all flights.
    pub(super) fn take(
        &mut self,
        flights: &[Flight],
        joints: &[Joint],
        contacts: &[Contact],
        is_taken: impl Fn([u32; 2]) -> bool,
    ) {
        self.clear();
        self.place.resize(flights.len(), NONE);
        for (number, joint) in (0..).zip(joints).filter(|(_, joint)| is_taken(joint.bodies)) {
            let bodies = joint.bodies.map(|body| self.take_flight(flights, body));
            self.joints.push(Joint { bodies, ..*joint });
            self.joint_numbers.push(number);
        }
        for (number, contact) in (0..).zip(contacts).filter(|(_, contact)| is_taken(contact.bodies)) {
            let bodies = contact.bodies.map(|body| self.take_flight(flights, body));
            self.contacts.push(Contact { bodies, ..*contact });
            self.contact_numbers.push(number);
        }
    }

    fn clear(&mut self) {
        self.place.clear();
        self.flights.clear();
        self.flight_numbers.clear();
        self.joints.clear();
        self.joint_numbers.clear();
        self.contacts.clear();
        self.contact_numbers.clear();
    }

    /// Copies a flight, if it is not there yet, and returns its number in the part.
    fn take_flight(&mut self, flights: &[Flight], body: u32) -> u32 {
        let number = &mut self.place[body as usize];
        if *number == NONE {
            *number = self.flights.len() as u32;
            self.flights.push(flights[body as usize]);
            self.flight_numbers.push(body);
        }
        *number
    }

    /// Returns true if it has neither joints nor contacts.
    fn is_empty(&self) -> bool {
        self.joints.is_empty() && self.contacts.is_empty()
    }

    /// The number in the part of a flight, by its number among all.
    pub(super) fn flight(&self, number: u32) -> Option<u32> {
        self.place.get(number as usize).copied().filter(|&number| number != NONE)
    }
}

/// The joints and contacts of a step, split by the kinds of their islands and shared out between threads, and a solver for each part.
#[derive(Debug, Default)]
pub(crate) struct Solvers<C> {
    graph: Graph,
    /// True if the graph and the kinds of islands belong to the step.
    are_islands_known: bool,
    /// The largest mass on top of each body, kg.
    loads: Vec<Fx>,
    /// By island.
    kinds: Vec<usize>,
    contact_counts: Vec<u32>,
    assemblies: Assemblies,
    shares: Shares,
    /// True if islands of the last step were of several kinds, took other sub-steps or were shared out.
    is_split: bool,
    /// The kind of all islands, if they are not split.
    whole: usize,
    /// By share and kind: [`KINDS`] for each share.
    tasks: Vec<Task<C>>,
}

impl<C: ContactSolver> Solvers<C> {
    /// Solves joints and contacts, each island with the options of its kind: writes their impulses and the corrections of all flights.
    pub(super) fn solve(
        &mut self,
        time_step: TimeStep,
        options: &SolverOptions,
        flights: &[Flight],
        joints: &mut [Joint],
        contacts: &mut [Contact],
        corrections: &mut Vec<Correction>,
    ) {
        let is_any_special = self.find_special(options, flights, joints, contacts);
        self.whole = if is_any_special { self.kinds[0] } else { 0 };
        self.is_split =
            self.whole & IS_HEAVY != 0 || is_any_special && self.kinds.iter().any(|&kind| kind != self.whole);
        self.shares.clear();
        #[cfg(feature = "parallel")]
        let share_count = self.share_out(flights, joints, contacts);
        #[cfg(not(feature = "parallel"))]
        let share_count = 1;
        self.is_split |= share_count > 1;
        if self.tasks.len() < share_count * KINDS {
            self.tasks.resize_with(share_count * KINDS, Task::default);
        }
        if !self.is_split {
            let whole_options = kind_options(self.whole, options);
            let solver = &mut self.tasks[self.whole].solver;
            solver.solve(time_step, &whole_options, flights, joints, contacts, corrections);
            return;
        }
        corrections.clear();
        corrections.resize(flights.len(), Correction::default());
        let Self { graph, kinds, shares, tasks, .. } = self;
        tasks.iter_mut().for_each(|task| task.is_used = false);
        // Joints of fixed bodies are in the first one.
        tasks[0].is_used = true;
        for (island, kind) in kinds.iter().enumerate() {
            tasks[shares.of(island) * KINDS + kind].is_used = true;
        }
        let step = SplitStep { time_step, options, flights, graph, kinds, shares };
        #[cfg(feature = "parallel")]
        if share_count > 1 {
            use rayon::iter::{IndexedParallelIterator as _, IntoParallelRefMutIterator as _, ParallelIterator as _};
            let (all_joints, all_contacts) = (&*joints, &*contacts);
            tasks.par_iter_mut().with_max_len(1).enumerate().for_each(|(number, task)| {
                task.take(&step, number, all_joints, all_contacts, &[]);
                task.solve(&step, number);
            });
            for (number, task) in tasks.iter().enumerate() {
                task.write(&step, number, joints, contacts, corrections);
            }
            return;
        }
        for (number, task) in tasks.iter_mut().enumerate() {
            task.take(&step, number, joints, contacts, corrections);
            task.solve(&step, number);
            task.write(&step, number, joints, contacts, corrections);
        }
    }

    /// Shares the islands out between threads, where these have enough to do. Returns the number of shares.
    #[cfg(feature = "parallel")]
    fn share_out(&mut self, flights: &[Flight], joints: &[Joint], contacts: &[Contact]) -> usize {
        let Self { graph, are_islands_known, kinds, shares, .. } = self;
        let count = shares.count_for(joints, contacts);
        // Islands below a body that dominates them follow it.
        if count == 1 || flights.iter().any(|flight| flight.leader.is_some()) {
            return 1;
        }
        if !*are_islands_known {
            let is_fixed = |body: u32| flights[body as usize].is_fixed();
            graph.build_islands(is_fixed, flights.len(), bodies_of(joints, contacts));
            kinds.clear();
            kinds.resize(graph.islands(), 0);
        }
        shares.share_out(count, graph, joints, contacts)
    }

    /// Gives each thread at least so much work, in contacts.
    #[cfg(all(feature = "parallel", feature = "selftest"))]
    pub(crate) fn share(&mut self, least: usize) {
        self.shares.set_least(least);
    }

    /// The timers of the solvers since they were taken last.
    #[cfg(feature = "timers")]
    pub(super) fn take_timers(&mut self) -> Timers {
        let mut sum = Timers::default();
        self.tasks.iter_mut().for_each(|task| sum += task.solver.take_timers());
        sum
    }

    /// The number of each contact that was solved, its impulses along the normal over the step by point, and log2 of their unit.
    pub(super) fn totals(&self) -> impl Iterator<Item = (u32, [i64; 2], i32)> + '_ {
        self.solved_parts().flat_map(move |part| {
            let totals = self.tasks[part].solver.totals();
            totals.map(move |(contact, sums, exponent)| (self.number(part, contact), sums, exponent))
        })
    }

    /// The number of each joint that was solved, and its impulses over the step on the second body: along x and y, in 2^-32 N·s, and
    /// around, in 2^-32 N·m·s.
    pub(super) fn joint_totals(&self) -> impl Iterator<Item = (u32, [i128; 3])> + '_ {
        self.solved_parts().flat_map(move |part| {
            let number = move |joint: u32| {
                if self.is_split { self.tasks[part].part.joint_numbers[joint as usize] } else { joint }
            };
            self.tasks[part].solver.joint_totals().map(move |(joint, total)| (number(joint), total))
        })
    }

    /// The impacts in the step of these contacts, which must be the solved contacts.
    pub(super) fn impacts<'a>(&'a self, contacts: &'a [Contact]) -> impl Iterator<Item = ContactImpact> + 'a {
        self.solved_parts().flat_map(move |part| {
            let contacts = if self.is_split { &self.tasks[part].part.contacts } else { contacts };
            let impacts = self.tasks[part].solver.impacts(contacts);
            impacts.map(move |impact| ContactImpact { contact: self.number(part, impact.contact), ..impact })
        })
    }

    /// The parts with joints or contacts of the last step.
    fn solved_parts(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.tasks.len())
            .filter(|&part| if self.is_split { !self.tasks[part].part.is_empty() } else { part == self.whole })
    }

    /// The number among all of a contact of a part.
    fn number(&self, part: usize, contact: u32) -> u32 {
        if self.is_split { self.tasks[part].part.contact_numbers[contact as usize] } else { contact }
    }

    /// Finds the kinds of the islands. Returns true if one is special.
    fn find_special(
        &mut self,
        options: &SolverOptions,
        flights: &[Flight],
        joints: &[Joint],
        contacts: &[Contact],
    ) -> bool {
        let may_be_heavy = options.substeps < FINE_SUBSTEPS && may_be_heavy(flights);
        let any_deep = contacts.iter().any(is_deep);
        let may_be_joined = !joints.is_empty() && !contacts.is_empty();
        self.are_islands_known = may_be_heavy || any_deep || may_be_joined;
        if !self.are_islands_known {
            return false;
        }
        let links = bodies_of(joints, contacts);
        let is_fixed = |body: u32| flights[body as usize].is_fixed();
        if may_be_heavy || flights.iter().any(|flight| flight.leader.is_some()) {
            // Islands that no fixed body holds carry nothing: they get no levels.
            self.graph.build(is_fixed, flights.len(), links, |_, _| {});
        } else {
            self.graph.build_islands(is_fixed, flights.len(), links);
        }
        self.kinds.clear();
        self.kinds.resize(self.graph.islands(), 0);
        if may_be_heavy {
            self.find_heavy(flights);
        }
        if any_deep || may_be_joined {
            self.count_contacts(contacts);
            self.find_deep();
            self.find_joined(joints);
        }
        if may_be_joined {
            self.find_loaded(flights, joints, contacts);
        }
        self.follow_leaders(flights);
        self.kinds.iter().any(|&kind| kind != 0)
    }

    /// Counts the contacts of islands, and finds deep ones.
    fn count_contacts(&mut self, contacts: &[Contact]) {
        let Self { graph, kinds, contact_counts, .. } = self;
        contact_counts.clear();
        contact_counts.resize(graph.islands(), 0);
        for contact in contacts {
            if let Some(island) = graph.island_of_link(contact.bodies) {
                contact_counts[island as usize] += 1;
                kinds[island as usize] |= if is_deep(contact) { IS_DEEP } else { 0 };
            }
        }
    }

    fn find_deep(&mut self) {
        for (kind, &count) in self.kinds.iter_mut().zip(&self.contact_counts) {
            *kind &= if count > FEW { !IS_DEEP } else { *kind };
        }
    }

    fn find_joined(&mut self, joints: &[Joint]) {
        let Self { graph, kinds, contact_counts, .. } = self;
        for joint in joints {
            let island = graph.island_of_link(joint.bodies).map(|island| island as usize);
            if let Some(island) = island.filter(|&island| contact_counts[island] > 0) {
                kinds[island] |= IS_JOINED;
            }
        }
    }

    fn find_loaded(&mut self, flights: &[Flight], joints: &[Joint], contacts: &[Contact]) {
        let Self { graph, kinds, assemblies, .. } = self;
        assemblies.find(flights, joints);
        for contact in contacts.iter().filter(|contact| assemblies.are_load(flights, contact.bodies)) {
            let island = graph.island_of_link(contact.bodies);
            if let Some(island) = island.map(|island| island as usize).filter(|&island| kinds[island] & IS_JOINED != 0)
            {
                kinds[island] |= IS_LOADED;
            }
        }
    }

    fn find_heavy(&mut self, flights: &[Flight]) {
        let Self { graph, loads, kinds, .. } = self;
        graph.largest_above(|body| flights[body as usize].mass, loads);
        for ((body, flight), &load) in (0..).zip(flights).zip(&*loads) {
            if let Some(island) = graph.island_of(body).filter(|_| is_heavy(load, flight.mass)) {
                kinds[island as usize] |= IS_HEAVY;
            }
        }
    }

    /// Gives islands below bodies that dominate them the kinds of the islands of these bodies.
    fn follow_leaders(&mut self, flights: &[Flight]) {
        let Self { graph, kinds, .. } = self;
        let followers = || (0..).zip(flights).filter_map(|(body, flight)| Some((body, flight.leader?)));
        let below = |follower| graph.touched_by(follower).filter_map(|body| graph.island_of(body));
        // Leaders may be below others in turn: at most one round for each number of dominance.
        let mut has_changed = followers().next().is_some();
        while has_changed {
            has_changed = false;
            for (follower, leader) in followers() {
                let Some(kind) = graph.island_of(leader).map(|island| kinds[island as usize]) else { continue };
                for island in below(follower) {
                    let below = &mut kinds[island as usize];
                    has_changed |= *below | kind != *below;
                    *below |= kind;
                }
            }
        }
    }
}

/// The bodies of joints and contacts.
pub(super) fn bodies_of<'a>(
    joints: &'a [Joint],
    contacts: &'a [Contact],
) -> impl Iterator<Item = [u32; 2]> + Clone + use<'a> {
    joints.iter().map(|joint| joint.bodies).chain(contacts.iter().map(|contact| contact.bodies))
}
