//! Assemblies of joined bodies in impacts: trees and loops. An assembly is among the shocks as a whole: its joints answer the impulses at each of
//! its bodies ([`Joints::answer_impact`]). In the iterations of a compression the answer at the bodies with shocks is *estimated* by their responses
//! to each other, which are found once: the answer of all joints takes a hundred times as long.
//!
//! Reads: joints. Writes: velocities of struck bodies.

mod stops;

use alloc::vec::Vec;
use core::ops::Range;

use super::super::bodies::STILL;
use super::super::joint::{Joints, Response};
use super::super::number::{lowered, product, shifted, within};
use super::shock::Shock;
use super::{FINE, FRACTION, NONE, Struck};

/// A response that is wanted.
const WANTED: u32 = NONE - 1;
/// The largest product of the nodes of an assembly and of its struck bodies with which there are responses to these.
const RESPONSES: usize = 1 << 11;
/// The largest change of a velocity.
const LARGEST: i64 = 1 << 60;
/// The largest velocity that is estimated.
const FASTEST: i64 = 1 << 59;

/// The assemblies of a step.
#[derive(Clone, Debug, Default)]
pub(super) struct Assemblies {
    /// By row: its assembly, or [`NONE`], and its node in it. Empty without joints.
    assembly_of: Vec<u32>,
    node_of: Vec<u32>,
    /// The rows of all nodes, assembly by assembly.
    rows: Vec<u32>,
    all: Vec<Assembly>,
    /// The assemblies of the shocks.
    pub(super) set: Vec<u32>,
    /// The responses of all nodes of an assembly to a body of the shocks, body by body.
    responses: Vec<Response>,
    /// The bodies of the shocks in assemblies, assembly by assembly, if all of them have responses; else none.
    members: Vec<Member>,
    /// The changes of the velocities of the nodes of an assembly.
    changes: Vec<[i64; 3]>,
}

/// An assembly in the impacts of a step.
#[derive(Clone, Debug)]
struct Assembly {
    nodes: Range<usize>,
    is_in_set: bool,
    /// True if a joint has limits; and if its joints have been [settled](Assemblies::settle) in the sub-step, or have none.
    has_limits: bool,
    is_settled: bool,
    /// The number of shocks that share its bodies; contacts between two of them count twice.
    share: i64,
    /// The share for which rows were stopped by limits; zero while none has been looked at.
    stopped_share: i64,
    /// The number of bodies with shocks.
    response_count: usize,
    /// The work of an answer, in shocks of an iteration.
    work: usize,
}

/// A body of the shocks in an assembly.
#[derive(Clone, Debug)]
struct Member {
    assembly: u32,
    body: u32,
    node: u32,
    /// The number of the first response to it.
    response: u32,
    /// The velocity after the last answer, and without the answers that are estimated.
    answered: [i64; 3],
    unanswered: [i64; 3],
    /// The change by contacts since the last answer.
    change: [i64; 3],
}

impl Member {
    /// Takes note of the change by contacts since the last answer.
    fn take_change(&mut self, struck: &[Struck]) {
        self.change = difference(struck[self.body as usize].velocity, self.answered);
        for (unanswered, change) in self.unanswered.iter_mut().zip(self.change) {
            *unanswered = (*unanswered + change).clamp(-LARGEST, LARGEST);
        }
    }
}

impl Assemblies {
    /// Lists the assemblies of a step.
    pub(super) fn build(&mut self, joints: &Joints, row_count: u32) {
        let Self { assembly_of, node_of, rows, all, .. } = self;
        assembly_of.clear();
        rows.clear();
        all.clear();
        if joints.assembly_count() == 0 {
            return;
        }
        for numbers in [&mut *assembly_of, node_of] {
            numbers.clear();
            numbers.resize(row_count as usize, NONE);
        }
        for assembly in 0..joints.assembly_count() {
            let begin = rows.len();
            joints.list_rows(assembly, rows);
            for (node, &row) in (0..).zip(&rows[begin..]).filter(|&(_, &row)| row != STILL) {
                (assembly_of[row as usize], node_of[row as usize]) = (assembly as u32, node);
            }
            let nodes = begin..rows.len();
            let work = joints.answer_work(assembly, nodes.len());
            all.push(Assembly {
                nodes,
                is_in_set: false,
                has_limits: joints.has_limits(assembly),
                is_settled: false,
                share: 0,
                stopped_share: 0,
                response_count: 0,
                work,
            });
        }
    }

    /// The assembly of a row.
    pub(super) fn assembly_of(&self, row: u32) -> Option<u32> {
        self.assembly_of.get(row as usize).copied().filter(|&assembly| assembly != NONE)
    }

    /// The row that stands for all rows of its assembly.
    pub(super) fn first_row(&self, row: u32) -> u32 {
        self.assembly_of(row).and_then(|assembly| self.rows(assembly).next()).unwrap_or(row)
    }

    /// The numbers of the nodes of an assembly among all nodes.
    pub(super) fn nodes(&self, assembly: u32) -> Range<usize> {
        self.all[assembly as usize].nodes.clone()
    }

    /// The row of a node; `None` for a node that is no body.
    pub(super) fn row(&self, node: usize) -> Option<u32> {
        Some(self.rows[node]).filter(|&row| row != STILL)
    }

    /// The rows of an assembly.
    fn rows(&self, assembly: u32) -> impl Iterator<Item = u32> + '_ {
        self.rows[self.all[assembly as usize].nodes.clone()].iter().copied().filter(|&row| row != STILL)
    }

    /// Adds an assembly to the set. Returns false if it is in it.
    pub(super) fn add(&mut self, assembly: u32, joints: &mut Joints) -> bool {
        let added = &mut self.all[assembly as usize];
        if core::mem::replace(&mut added.is_in_set, true) {
            return false;
        }
        (added.share, added.stopped_share, added.response_count) = (0, 0, 0);
        self.set.push(assembly);
        joints.begin_impact(assembly as usize);
        true
    }

    /// Counts a shock at an assembly.
    pub(super) fn count_shock(&mut self, assembly: u32) {
        self.all[assembly as usize].share += 1;
    }

    /// Gives the bodies of assemblies the shares of these.
    pub(super) fn give_shares(&self, struck: &mut [Struck], struck_of: &[u32]) {
        for &assembly in &self.set {
            for row in self.rows(assembly) {
                struck[struck_of[row as usize] as usize].share = self.all[assembly as usize].share;
            }
        }
    }

    /// The work of an answer in an iteration, in shocks.
    pub(super) fn answer_work(&self) -> usize {
        if self.is_estimated() {
            return self.members.len();
        }
        self.set.iter().map(|&assembly| self.all[assembly as usize].work).sum()
    }

    /// Finds the responses of struck bodies of assemblies, and the elements of their shocks. Where an assembly with all its struck bodies is too large
    /// for that, the others stay as if they were alone, with which iterations converge as well, but slowly.
    pub(super) fn find_responses(&mut self, shocks: &mut [Shock], struck: &mut [Struck], joints: &mut Joints) {
        if self.set.is_empty() {
            return;
        }
        // All are counted before the first one is found, so that no order matters.
        for (row, body) in shocks.iter().flat_map(|shock| shock.rows.into_iter().zip(shock.bodies)) {
            let Some(assembly) = self.assembly_of(row) else { continue };
            if struck[body as usize].response == NONE {
                struck[body as usize].response = WANTED;
                self.all[assembly as usize].response_count += 1;
            }
        }
        for shock in shocks {
            for side in 0..2 {
                let (row, body) = (shock.rows[side], shock.bodies[side] as usize);
                let Some(assembly) = self.assembly_of(row).filter(|_| !shock.has_response[side]) else { continue };
                let Assembly { nodes, response_count, .. } = &self.all[assembly as usize];
                if struck[body].response == WANTED && nodes.len() * response_count <= RESPONSES {
                    struck[body].response = self.find_response(row, assembly, joints);
                }
                let response = struck[body].response;
                if response != WANTED {
                    let response = &self.responses[(response + self.node_of[row as usize]) as usize];
                    shock.elements[side] = shock.jacobian.joined_elements(side, response);
                    // The matrix is found anew.
                    (shock.has_response[side], shock.shares) = (true, [0; 2]);
                }
            }
        }
    }

    /// Finds the responses of an assembly to one of its bodies. Returns the number of the first one.
    fn find_response(&mut self, row: u32, assembly: u32, joints: &mut Joints) -> u32 {
        let (node_count, first) = (self.all[assembly as usize].nodes.len(), self.responses.len());
        self.changes.clear();
        self.changes.resize(node_count, [0; 3]);
        self.responses.resize(first + node_count, Response::default());
        let node = self.node_of[row as usize] as usize;
        joints.find_responses(assembly as usize, node, &mut self.changes, &mut self.responses[first..]);
        first as u32
    }

    /// Lists the members, whose velocities hold an answer of all joints.
    pub(super) fn list_members(&mut self, struck: &[Struck], struck_of: &[u32]) {
        let Self { members, set, all, rows, .. } = self;
        members.clear();
        for &assembly in &*set {
            for (node, &row) in (0..).zip(&rows[all[assembly as usize].nodes.clone()]).filter(|&(_, &row)| row != STILL)
            {
                let body = struck_of[row as usize];
                let Struck { response, velocity, .. } = struck[body as usize];
                match response {
                    NONE => {}
                    WANTED => {
                        members.clear();
                        return;
                    }
                    _ => members.push(Member {
                        assembly,
                        body,
                        node,
                        response,
                        answered: velocity,
                        unanswered: velocity,
                        change: [0; 3],
                    }),
                }
            }
        }
    }

    /// Returns true if answers are estimated.
    pub(super) fn is_estimated(&self) -> bool {
        !self.members.is_empty()
    }

    /// Estimates the answers of all joints at the members to the impulses of contacts since the last answer. Returns false where velocities do not hold
    /// them.
    ///
    /// # Ranges
    /// Changes are within 2^60, responses below 2^42: sums over 2^11 members are below 2^115.
    pub(super) fn estimate(&mut self, struck: &mut [Struck]) -> bool {
        let Self { members, responses, .. } = self;
        let mut is_held = true;
        for members in members.chunk_by_mut(|a, b| a.assembly == b.assembly) {
            members.iter_mut().for_each(|member| member.take_change(struck));
            for index in 0..members.len() {
                let node = members[index].node;
                let mut sums = [0; 3];
                for Member { response, change, .. } in members.iter().filter(|member| member.change != [0; 3]) {
                    let response = &responses[(response + node) as usize];
                    for (sum, axis) in sums.iter_mut().zip(0..) {
                        *sum += (0..3).map(|from| product(response[from][axis], change[from])).sum::<i128>();
                    }
                }
                let Member { body, answered, unanswered, .. } = &mut members[index];
                for (velocity, sum) in answered.iter_mut().zip(sums) {
                    let answer = within(lowered(sum, 30), LARGEST.into());
                    let wanted = *velocity + answer;
                    *velocity = wanted.clamp(-FASTEST, FASTEST);
                    is_held &= *velocity == wanted;
                }
                is_held &= unanswered.iter().all(|part| part.abs() < LARGEST);
                struck[*body as usize].velocity = *answered;
            }
        }
        is_held
    }

    /// Lets all joints of the set answer the impulses so far. Returns the largest velocity by which a joint gives way, in 2^-[`FRACTION`].
    pub(super) fn answer(&mut self, struck: &mut [Struck], struck_of: &[u32], coarse: i32, joints: &mut Joints) -> i64 {
        for member in &mut self.members {
            member.take_change(struck);
            struck[member.body as usize].velocity = member.unanswered;
        }
        let mut largest = 0;
        for index in 0..self.set.len() {
            let assembly = self.set[index] as usize;
            let nodes = self.all[assembly].nodes.clone();
            self.changes.clear();
            for &row in &self.rows[nodes.clone()] {
                let change = match struck_of[row as usize] {
                    body if row != STILL && body != NONE => {
                        let Struck { velocity, start, .. } = struck[body as usize];
                        difference(velocity, start)
                    }
                    _ => [0; 3],
                };
                self.changes.push(change);
            }
            largest = largest.max(joints.answer_impact(assembly, &mut self.changes, coarse));
            for (&row, &change) in self.rows[nodes].iter().zip(&self.changes) {
                if row != STILL {
                    let struck = &mut struck[struck_of[row as usize] as usize];
                    (0..3).for_each(|axis| struck.velocity[axis] = struck.start[axis] + change[axis]);
                }
            }
        }
        for Member { body, answered, unanswered, .. } in &mut self.members {
            let velocity = struck[*body as usize].velocity;
            (*answered, *unanswered) = (velocity, velocity);
        }
        largest >> (FINE - FRACTION - coarse)
    }

    /// Adds the changes of velocity by the joints of the set to `begun`.
    pub(super) fn add_gains(&mut self, struck: &mut [Struck], struck_of: &[u32], joints: &Joints) {
        for index in 0..self.set.len() {
            let assembly = self.set[index] as usize;
            let nodes = self.all[assembly].nodes.clone();
            self.changes.clear();
            self.changes.resize(nodes.len(), [0; 3]);
            joints.add_impacts(assembly, &mut self.changes);
            for (&row, &change) in self.rows[nodes].iter().zip(&self.changes) {
                if row != STILL {
                    let begun = &mut struck[struck_of[row as usize] as usize].begun;
                    (0..3).for_each(|axis| begun[axis] = begun[axis].wrapping_add(change[axis]));
                }
            }
        }
    }

    /// Applies the impulses of the joints of the set, and empties the set. All bodies of an assembly are struck at one moment. The way that contacts take
    /// back is answered by the joints like velocities: each contact has its own moment, and so have the parts of the impulses of joints by it.
    pub(super) fn strike(&mut self, struck: &mut [Struck], struck_of: &[u32], coarse: i32, joints: &mut Joints) {
        while let Some(assembly) = self.set.pop() {
            let Assembly { nodes, is_in_set, .. } = &mut self.all[assembly as usize];
            *is_in_set = false;
            let rows = &self.rows[nodes.clone()];
            let bodies = rows.iter().map(|&row| if row == STILL { NONE } else { struck_of[row as usize] });
            self.changes.clear();
            self.changes.extend(bodies.clone().map(|body| {
                match struck.get(body as usize) {
                    Some(struck) => struck
                        .back
                        .map(|back| shifted(back, coarse).clamp(-i128::from(LARGEST), i128::from(LARGEST)) as i64),
                    None => [0; 3],
                }
            }));
            joints.apply_impact(assembly as usize, &mut self.changes, coarse);
            let members = bodies.clone().filter_map(|body| struck.get(body as usize));
            let moment = members.map(|struck| struck.moment).max().unwrap_or(0);
            for (body, back) in bodies.zip(&self.changes) {
                if let Some(struck) = struck.get_mut(body as usize) {
                    struck.moment = moment;
                    struck.back = back.map(|part| i128::from(part) << coarse);
                }
            }
        }
        self.responses.clear();
        self.members.clear();
    }
}

/// The change from one velocity to another.
fn difference(velocity: [i64; 3], start: [i64; 3]) -> [i64; 3] {
    [0, 1, 2].map(|axis| (velocity[axis] - start[axis]).clamp(-LARGEST, LARGEST))
}
