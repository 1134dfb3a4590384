//! The set of the shocks of a round: contacts, bodies and assemblies that join it, the answers of joints, and the work of its iterations.
//!
//! Reads: rows of bodies, joints. Writes: shocks, struck bodies, assemblies.

use super::super::joint::Joints;
use super::super::motion::Rows;
use super::jacobian::{NormalRows, coarsened};
use super::shock::Shock;
use super::{ANSWERS, BUSY, FRACTION, Impacts, NONE, SubStep};

impl Impacts {
    /// Adds a contact to the shocks, with its bodies.
    pub(super) fn join(&mut self, mut shock: Shock, substep: SubStep<'_>, rows: &Rows, joints: &mut Joints) {
        for side in 0..2 {
            let row = shock.rows[side];
            let body = self.join_body(row, substep, rows);
            shock.bodies[side] = body;
            match self.assemblies.assembly_of(row) {
                Some(assembly) => self.join_assembly(assembly, substep, rows, joints),
                None => self.struck[body as usize].share += 1,
            }
        }
        self.is_joined[shock.place as usize] = true;
        self.shocks.push(shock);
    }

    /// Adds a shock to an assembly, and the assembly to the set of the shocks.
    pub(super) fn join_assembly(&mut self, assembly: u32, substep: SubStep<'_>, rows: &Rows, joints: &mut Joints) {
        if self.assemblies.add(assembly, joints) {
            for node in self.assemblies.nodes(assembly) {
                if let Some(row) = self.assemblies.row(node) {
                    self.join_body(row, substep, rows);
                }
            }
            if self.assemblies.has_limits(assembly) {
                let velocities = &mut self.velocities;
                _ = joints.set_velocities(assembly as usize, |row| velocities.at(rows, row, substep));
            }
        }
        self.assemblies.count_shock(assembly);
    }

    /// The index of a body among the bodies of the impacts, as one of the set of the shocks.
    pub(super) fn join_body(&mut self, row: u32, substep: SubStep<'_>, rows: &Rows) -> u32 {
        let body = self.struck_of(row);
        if !self.struck[body as usize].is_in_set {
            let start = coarsened(self.velocities.at(rows, row, substep), self.coarse);
            let struck = &mut self.struck[body as usize];
            (struck.is_in_set, struck.share, struck.response) = (true, 0, NONE);
            struck.open = self.index.places_of(row).len() as u32;
            struck.start = start;
            (struck.velocity, struck.begun) = (struck.start, struck.start);
            self.set.push(body);
        }
        body
    }

    /// Lets joints answer the impulses so far. Returns the largest velocity by which a joint gives way, in 2^-[`FRACTION`].
    pub(super) fn answer(&mut self, joints: &mut Joints) -> i64 {
        let Self { assemblies, struck, struck_of, coarse, .. } = self;
        assemblies.answer(struck, struck_of, *coarse, joints)
    }

    /// [`answer_fully`](Self::answer_fully) in an iteration: estimated where it can be, which tells nothing of the velocities by which joints give way.
    pub(super) fn estimate(&mut self, joints: &mut Joints) -> Option<i64> {
        if self.assemblies.is_estimated() {
            self.is_cut |= !self.assemblies.estimate(&mut self.struck);
            return None;
        }
        Some(self.answer_fully(joints))
    }

    /// Returns true if impulses of joints were cut off.
    pub(super) fn are_joints_cut(&self, joints: &Joints) -> bool {
        self.assemblies.set.iter().any(|&assembly| joints.is_impact_cut(assembly as usize))
    }

    /// Lets joints answer until they give way by less than the tolerance. Returns the largest velocity by which one still does.
    pub(super) fn answer_fully(&mut self, joints: &mut Joints) -> i64 {
        let mut residual = 0;
        for _ in 0..ANSWERS {
            residual = self.answer(joints);
            if residual <= self.tolerance {
                break;
            }
        }
        residual
    }

    /// Returns true if the island of the shocks has done much work in the step.
    pub(super) fn is_busy(&self) -> bool {
        self.work[self.island] > BUSY
    }

    /// Counts an iteration over the shocks.
    pub(super) fn count_work(&mut self) {
        self.work[self.island] += self.iteration_work() as u32;
    }

    /// The work of an iteration, in shocks.
    pub(super) fn iteration_work(&self) -> usize {
        self.shocks.len() + self.assemblies.answer_work()
    }

    /// Returns true if the other body of a contact has changed too, and its row comes first: so that contacts between two bodies of the set
    /// are looked at once.
    pub(super) fn has_earlier_body(&self, row: u32, contact: &NormalRows) -> bool {
        let earlier = contact.rows[0].min(contact.rows[1]);
        let body = self.struck_of[earlier as usize];
        earlier != row
            && body != NONE
            && self.struck[body as usize].is_in_set
            && self.struck[body as usize].has_changed()
    }

    /// Contacts that close by more than this join the shocks: 2^-8 of the fastest impact, so that a light ball feels the floor under a stack; more where
    /// there are many, or joints that answer.
    pub(super) fn slowest(&self) -> i64 {
        let bits = match self.shocks.len() {
            ..8 if self.assemblies.set.is_empty() => 8,
            ..32 => 6,
            32..128 => 4,
            _ => 3,
        };
        (self.fastest >> bits).max(2 << FRACTION)
    }
}
