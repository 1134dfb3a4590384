//! Impacts: points that meet at speed within a sub-step, solved at their moments, before the passes of the sub-step.
//!
//! Reads: flights, velocities and displacements of bodies, separations of contacts. Writes: velocities and displacements of the bodies that
//! impacts change, the impulses and separations of their contacts, [`Strike`]s.
//!
//! A point has an *impact* in a sub-step if the flights of its bodies, with all corrections so far, bring it to the surface faster than
//! [`SolverOptions::restitution_speed`](super::SolverOptions): at the moment τ with u² = u0² − 2·a·g, for the velocity u0 and the gap g at
//! the beginning of the sub-step, and the acceleration a of the flight and of the [support](super::motion::Rows::support) by contacts and joints:
//! a body on a floor does not fall up to the moment. The impacts of a sub-step are solved in *rounds*, in the order of their moments: a round
//! takes the impacts that are the first ones of both of their bodies, and the next round looks again at all contacts of the bodies that it changed.
//! So a chain of impacts within a sub-step is a chain.
//!
//! The impacts of a round in an island are one set of *shocks*. Contacts that touch join it when its impulses make them close, so
//! that an impact costs the bodies that it changes:
//!
//! 1. *Compression* ([`compress`](self::compress)): the least impulses along the normals, with friction in their cone, that leave no
//!    point closing.
//! 2. *Expansion* ([`expand`](self::expand)): each point with an impact returns e of its impulse (Poisson's hypothesis: between two
//!    bodies Newton's, and for several it depends on no convergence). All are scaled by the largest share up to 1 with which the impulses
//!    J do no work: Σ J·(r before + r after) ≤ 0 over all rows, which is twice the change of the kinetic energy of all bodies. (Impulses of joints
//!    do no work as far as their rows do not move: the motion left there is taken away by the passes.)
//! 3. Compression once more, with these impulses as lower bounds and friction in the cone of the whole impulse.
//!
//! Impacts of a body that follow within an eighth of a sub-step and within 5 mm of the way are one, as the two of a box that lands flat.
//! Work is bounded: a contact joins where its bodies close by more than a share of the speed of the impact, from 2^-8 for a few contacts to
//! 2^-3 for a crowd, in the first iterations; large sets, and sets without a solution, are left to the passes after some iterations.
//!
//! Impulses act from their moments on: they change the velocity, and take back the way that the body would have gone with that change
//! up to the moment. The next sub-step does not repeat them, as it does the impulses of the passes.
//!
//! An assembly of joined bodies takes part as a whole ([`assemblies`](self::assemblies)): its joints answer the impulses at its bodies in each
//! iteration, by an estimate before the last one, and contacts meet the inverse masses of bodies with all that hangs on them. Limits and ropes hold
//! what the contacts press against them, and pull nothing; springs, motors and friction of joints have no time to act. Large velocities that joints hold
//! are taken away first where rows have limits, so that the impulses of joints do no work.
//!
//! Box2D applies restitution once a step, by the approach speed at its start, and Rapier in the bias of each contact: both see the
//! contacts of a body in turn, and gain or lose energy by their order. Moreau's time stepping solves one problem of this kind a step.

mod assemblies;
mod compress;
mod expand;
mod fast;
mod index;
mod jacobian;
mod set;
mod shock;
mod velocities;

use alloc::vec::Vec;

use self::assemblies::Assemblies;
use self::expand::{renew_separation, solve_shocks, strike};
use self::fast::FastLanes;
use self::index::ContactIndex;
use self::shock::Shock;
use self::velocities::Velocities;
use super::bodies::BodyRows;
use super::follow::Follower;
use super::graph::Graph;
use super::groups::ContactGroups;
use super::joint::Joints;
use super::motion::Rows;
use super::unit::Clock;
use super::{Contact, ContactImpact};
use crate::fx;
use crate::fx::Fx;
use crate::kernel::simd::Lanes;

/// Bits after the point of velocities along rows.
const FRACTION: i32 = 16;
/// Bits after the point of velocities of bodies.
const FINE: i32 = 30;
/// One, as a moment of a sub-step.
const ONE: i64 = 1 << 30;
/// Rounds of an island in a sub-step. The last one takes all impacts that are left at once.
const ROUNDS: u32 = 64;
/// Iterations times shocks of an island in a step after which it is *busy*: all impacts that are left in a sub-step are taken at once, by the
/// fewest iterations. Impacts in crowds would cost far more than all else.
const BUSY: u32 = 1 << 12;
/// Impacts of a body that follow each other within this part of a sub-step, and on a way of at most [`NEAR`] times [`TOUCH`], are one: a box
/// that lands flat has two.
const AT_ONCE: i64 = ONE / 8;
/// The latest moment of an impact that is one with an impact of the sub-step.
const LATEST: i64 = ONE + AT_ONCE;
/// The part of the speed of the fastest impact up to which rows of joints stand still, as minus log2.
const STILL_SPEED: i32 = 6;
/// The part of that speed from which on velocities that joints hold are taken away before the impact, as minus log2. Joints give way to loads, and from
/// an eighth on ragdolls in a pile are pushed beyond their limits by it.
const LOOSE_SPEED: i32 = 1;
/// Points up to this distance apart touch, m.
const TOUCH: Fx = fx!(0.001);
/// See [`AT_ONCE`].
const NEAR: i128 = 5;
/// Bits that velocities of bodies have less where impulses of the shocks change some by more than they hold, 2^29 units: impulses on a
/// light body under a heavy one may be large, and cancel.
const COARSER: i32 = 12;
/// The largest number of answers of joints to impulses that are added at once. In a tree of points each leaves 2^-7 of the error before, or less;
/// welds in series and loops leave more.
const ANSWERS: u32 = 4;
/// No index.
const NONE: u32 = u32::MAX;

/// A body in the impacts of a sub-step, in place of its row.
#[derive(Clone, Copy, Debug)]
struct Struck {
    row: u32,
    /// True while it is a body of the shocks.
    is_in_set: bool,
    /// The number of shocks that share it, or its assembly.
    share: i64,
    /// The number of the first of the responses to it, for a body of an assembly with a shock, or that there are none; else [`NONE`].
    response: u32,
    /// The number of its contacts that may still join the shocks: they stand first among its [normal rows](ContactIndex::normal_rows).
    open: u32,
    /// The velocity before the round, at the beginning of the compression and now, in 2^([`coarse`](Impacts::coarse) − [`FINE`]).
    start: [i64; 3],
    begun: [i64; 3],
    velocity: [i64; 3],
    /// The way to take back for impulses after the beginning of the sub-step, in 2^-[`FINE`].
    back: [i128; 3],
    /// The moment of its last impact in the sub-step.
    moment: i64,
}

impl Struck {
    fn has_changed(&self) -> bool {
        self.velocity != self.start
    }
}

/// The impulses of impacts at a contact over the step, which are part of `applied`, and the speed of the fastest one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Strike {
    pub(super) place: u32,
    pub(super) impulses: [i64; 3],
    /// By point: the speed at the moment of its fastest impact, in units of velocity.
    pub(super) speeds: [i64; 2],
}

/// A sub-step: its number `k` of `n`, and the contacts.
#[derive(Clone, Copy)]
pub(super) struct SubStep<'a> {
    pub(super) k: u32,
    pub(super) n: u32,
    pub(super) clock: &'a Clock,
    pub(super) graph: &'a Graph,
    pub(super) contacts: &'a [Contact],
}

/// The buffers of impacts.
#[derive(Clone, Debug, Default)]
pub(super) struct Impacts {
    /// The contacts of each row, listed in the first sub-step of a step that needs them.
    index: ContactIndex,
    /// The impacts of a round, and the contacts to look at in the next one.
    shocks: Vec<Shock>,
    candidates: Vec<Shock>,
    /// The numbers of the candidates by island, then by contact.
    order: Vec<u32>,
    pending: Vec<u32>,
    /// By contact: true while it is among the shocks.
    is_joined: Vec<bool>,
    /// The bodies of the impacts of a sub-step.
    struck: Vec<Struck>,
    /// By row: true for a body that may have an impact in the sub-step.
    fast: Vec<bool>,
    fast_lanes: FastLanes,
    velocities: Velocities,
    assemblies: Assemblies,
    /// By row: the index in `struck`, or [`NONE`].
    struck_of: Vec<u32>,
    /// The bodies of the shocks.
    set: Vec<u32>,
    /// The moment of the first impact in the sub-step, by row.
    first_moment: Vec<i64>,
    /// The speed of the fastest impact of the shocks. Residuals up to 2^-12 of it end a compression. In 2^-[`FRACTION`].
    fastest: i64,
    tolerance: i64,
    /// The first moment of the shocks.
    moment: i64,
    /// The island of the shocks.
    island: usize,
    /// True if the shocks have no solution.
    is_clamped: bool,
    /// True if impulses of joints, or estimates of their answers, were cut off.
    is_cut: bool,
    /// The largest exponent of the shocks.
    exponent: i32,
    /// Bits of [`FINE`] that velocities of the shocks' bodies are without: none or [`COARSER`].
    coarse: i32,
    /// Iterations times shocks, by island.
    work: Vec<u32>,
    /// True for an island after its last round in the sub-step.
    is_finished: Vec<bool>,
    /// Sorted by contact when the sub-steps are done.
    pub(super) strikes: Vec<Strike>,
}

impl Impacts {
    /// Forgets the contacts of the step before.
    pub(super) fn clear(&mut self) {
        self.index.clear();
        self.strikes.clear();
        self.work.clear();
    }

    /// Solves the impacts of a sub-step, after [`Begin`](super::motion::Begin).
    #[inline(always)]
    pub(super) fn solve<L: Lanes>(
        &mut self,
        substep: SubStep<'_>,
        bodies: &mut BodyRows,
        groups: &mut ContactGroups,
        joints: &mut Joints,
        lanes: L,
    ) {
        self.list_fast(substep, &bodies.rows, groups, joints, lanes);
        if self.pending.is_empty() {
            return;
        }
        self.index_contacts(&bodies.rows, groups, joints);
        self.velocities.begin(bodies.rows.len());
        self.assemblies.begin_substep();
        let islands = substep.graph.islands();
        self.work.resize(islands, 0);
        self.is_finished.clear();
        self.is_finished.resize(islands, false);
        for round in 1..=ROUNDS {
            self.find_candidates(substep, bodies, groups);
            if self.candidates.is_empty() {
                break;
            }
            self.solve_round(substep, bodies, groups, joints, round == ROUNDS, lanes);
        }
        self.leave_bodies();
    }

    /// Lists the contacts of fast bodies. Where a quarter of all bodies is fast, all contacts are looked through in their order, and the list
    /// needs no sort.
    #[inline(always)]
    fn list_fast<L: Lanes>(
        &mut self,
        substep: SubStep<'_>,
        rows: &Rows,
        groups: &ContactGroups,
        joints: &Joints,
        lanes: L,
    ) {
        let Self { pending, fast, fast_lanes, .. } = self;
        pending.clear();
        fast.clear();
        fast.extend((0..rows.len()).map(|row| rows.is_fast(row)));
        let count = fast.iter().filter(|&&is_fast| is_fast).count();
        if count > fast.len() / 4 {
            fast_lanes.find(substep, rows, &groups.groups, lanes);
            for (index, place) in groups.places.iter().enumerate() {
                let (group, lane) = (&groups.groups[place.group as usize], place.lane as usize);
                let is_fast = fast[group.a[lane] as usize] || fast[group.b[lane] as usize];
                if is_fast && fast_lanes.contains(place.group, place.lane) {
                    pending.push(index as u32);
                }
            }
        } else if count > 0 {
            self.index_contacts(rows, groups, joints);
            for row in 0..rows.len() {
                if self.fast[row as usize] {
                    let places = self.index.places_of(row);
                    self.pending.extend_from_slice(&self.index.places[places]);
                }
            }
        }
    }

    /// Lists the contacts of each row, once a step.
    fn index_contacts(&mut self, rows: &Rows, groups: &ContactGroups, joints: &Joints) {
        let Self { index, is_joined, struck_of, first_moment, assemblies, .. } = self;
        if !index.build(rows, groups) {
            return;
        }
        assemblies.build(joints, rows.len());
        is_joined.clear();
        is_joined.resize(groups.places.len(), false);
        struck_of.clear();
        struck_of.resize(rows.len() as usize, NONE);
        first_moment.clear();
        first_moment.resize(rows.len() as usize, ONE);
    }

    /// Looks for impacts at the pending contacts, sorted by island and contact.
    fn find_candidates(&mut self, substep: SubStep<'_>, bodies: &BodyRows, groups: &ContactGroups) {
        let mut pending = core::mem::take(&mut self.pending);
        pending.sort_unstable();
        pending.dedup();
        self.candidates.clear();
        for place in pending.drain(..) {
            if let Some(shock) = Shock::find(self, substep, bodies, groups, place) {
                self.candidates.push(shock);
            }
        }
        self.pending = pending;
        let Self { order, candidates, .. } = self;
        order.clear();
        order.extend(0..candidates.len() as u32);
        // They are sorted by contact.
        order.sort_unstable_by_key(|&number| (candidates[number as usize].island, number));
    }

    /// Solves the impacts of a round, island by island, and lists the contacts to look at again. `is_last` takes all of them at once, as does
    /// an island that is busy.
    fn solve_round<L: Lanes>(
        &mut self,
        substep: SubStep<'_>,
        bodies: &mut BodyRows,
        groups: &mut ContactGroups,
        joints: &mut Joints,
        is_last: bool,
        lanes: L,
    ) {
        let candidates = core::mem::take(&mut self.candidates);
        let order = core::mem::take(&mut self.order);
        self.find_first_moments(&candidates);
        let shock = |number: u32| &candidates[number as usize];
        for island in order.chunk_by(|&a, &b| shock(a).island == shock(b).island) {
            self.shocks.clear();
            self.set.clear();
            self.coarse = 0;
            self.island = shock(island[0]).island as usize;
            if self.is_finished[self.island] {
                continue;
            }
            if self.settle_joints(island.iter().map(|&number| shock(number)), substep, bodies, joints, lanes) {
                // With other velocities they are other impacts.
                self.pending.extend(island.iter().map(|&number| shock(number).place));
                continue;
            }
            let is_last = is_last || self.is_busy();
            for shock in island.iter().map(|&number| shock(number)) {
                if self.is_first(shock) || is_last && shock.moment() <= ONE {
                    self.join(shock.clone(), substep, &bodies.rows, joints);
                } else if shock.moment() <= ONE {
                    self.pending.push(shock.place);
                }
            }
            if !self.shocks.is_empty() {
                self.is_finished[self.island] = is_last;
                solve_shocks(self, substep, bodies, groups, joints);
                strike(self, bodies, groups, joints, lanes);
            }
        }
        (self.candidates, self.order) = (candidates, order);
        self.follow(bodies, groups);
    }

    /// Takes the velocities away that joints hold, of assemblies with limits that an island's impacts strike: by impulses at the beginning of the
    /// sub-step. Passes that end with contacts leave such velocities, and an impulse of a joint beside them does work: the impulses of stops threw a
    /// body of 400 kg on a foot of 25 kg up with half of the energy of its fall. (Chains without limits are worse with it.) Returns true if there are any.
    fn settle_joints<'a, L: Lanes>(
        &mut self,
        shocks: impl Iterator<Item = &'a Shock> + Clone,
        substep: SubStep<'_>,
        bodies: &mut BodyRows,
        joints: &mut Joints,
        lanes: L,
    ) -> bool {
        let Self { assemblies, velocities, index, pending, .. } = self;
        let fastest = shocks.clone().flat_map(|shock| shock.speeds).max().unwrap_or(0);
        let still = (fastest >> LOOSE_SPEED) << (FINE - FRACTION);
        let mut are_settled = false;
        for row in shocks.flat_map(|shock| shock.rows) {
            let Some(assembly) = assemblies.assembly_of(row) else { continue };
            if !assemblies.settle(assembly, still, joints, |row| velocities.at(&bodies.rows, row, substep)) {
                continue;
            }
            are_settled = true;
            for (row, change) in assemblies.settled(assembly) {
                bodies.rows.strike(lanes, row, change, [0; 3]);
                velocities.forget(row);
                pending.extend_from_slice(&index.places[index.places_of(row)]);
            }
        }
        are_settled
    }

    /// Takes the impacts of leaders over to their followers, after all islands of a round.
    fn follow(&mut self, bodies: &mut BodyRows, groups: &mut ContactGroups) {
        let BodyRows { rows, followers, .. } = bodies;
        for &Follower { row, leader, down } in followers.iter() {
            let is_struck = self.struck_of[leader as usize] != NONE;
            let moment = self.moment_of(leader);
            if is_struck && rows.follow_impact(row, leader, down) {
                self.velocities.forget(row);
                let follower = self.struck_of(row);
                self.struck[follower as usize].moment = moment;
                for at in self.index.places_of(row) {
                    let place = self.index.places[at];
                    renew_separation(rows, groups, place);
                    self.pending.push(place);
                }
            }
        }
    }

    /// The moment of the last impact of a row in the sub-step.
    fn moment_of(&self, row: u32) -> i64 {
        match self.struck_of.get(row as usize) {
            Some(&body) if body != NONE => self.struck[body as usize].moment,
            _ => 0,
        }
    }

    /// Forgets the bodies of a sub-step.
    fn leave_bodies(&mut self) {
        for body in self.struck.drain(..) {
            self.struck_of[body.row as usize] = NONE;
        }
    }

    /// Adds up the impulses of impacts by contact.
    pub(super) fn sum_strikes(&mut self) {
        self.strikes.sort_unstable_by_key(|strike| strike.place);
        self.strikes.dedup_by(|strike, sum| {
            let is_same = strike.place == sum.place;
            if is_same {
                (0..3).for_each(|row| sum.impulses[row] += strike.impulses[row]);
                (0..2).for_each(|point| sum.speeds[point] = sum.speeds[point].max(strike.speeds[point]));
            }
            is_same
        });
    }

    /// The impacts in the step of these contacts, which are the contacts that were solved.
    pub(super) fn list<'a>(
        &'a self,
        graph: &'a Graph,
        bodies: &'a BodyRows,
        groups: &'a ContactGroups,
        contacts: &'a [Contact],
    ) -> impl Iterator<Item = ContactImpact> + 'a {
        self.strikes.iter().filter_map(|strike| {
            let place = &groups.places[strike.place as usize];
            let mover = graph.mover(contacts[place.contact as usize].bodies)?;
            // Units are from 2^-22 to 2^13 m/s, and speeds below 2^31 units.
            let up = 32 + bodies.bodies[mover as usize].unit;
            let metres = |speed: i64| Fx::from_bits((i128::from(speed) << up).min(i64::MAX.into()) as i64);
            let ([first, second, _], speeds) = (strike.impulses, strike.speeds.map(metres));
            Some(ContactImpact { contact: place.contact, impulses: [first, second], exponent: place.exponent, speeds })
        })
    }

    /// The index of the body of a row.
    fn struck_of(&mut self, row: u32) -> u32 {
        if self.struck_of[row as usize] == NONE {
            self.struck_of[row as usize] = self.struck.len() as u32;
            self.struck.push(Struck {
                row,
                is_in_set: false,
                share: 0,
                response: NONE,
                open: 0,
                start: [0; 3],
                begun: [0; 3],
                velocity: [0; 3],
                back: [0; 3],
                moment: 0,
            });
        }
        self.struck_of[row as usize]
    }

    /// Finds the moment of the first impact of each row, or of its assembly, in the sub-step.
    fn find_first_moments(&mut self, candidates: &[Shock]) {
        let Self { first_moment, assemblies, .. } = self;
        for row in candidates.iter().flat_map(|shock| shock.rows) {
            first_moment[assemblies.first_row(row) as usize] = LATEST;
        }
        for shock in candidates.iter().filter(|shock| shock.moment() <= ONE) {
            for row in shock.rows {
                let first = &mut first_moment[assemblies.first_row(row) as usize];
                *first = (*first).min(shock.moment());
            }
        }
    }

    /// Returns true for an impact that is the first one of both of its bodies, or follows these at once. Impacts of other bodies at one that
    /// cannot be moved do not count.
    fn is_first(&self, shock: &Shock) -> bool {
        let firsts = shock.rows.map(|row| self.first_moment[self.assemblies.first_row(row) as usize]);
        let [a, b] = [0, 1].map(|side| if shock.is_movable(side) { firsts[side] } else { LATEST });
        shock.moment() <= a.min(b).saturating_add(shock.window) && a.min(b) <= ONE
    }
}
