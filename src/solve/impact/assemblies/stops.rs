//! Limits of joints in impacts: assemblies are *settled* before they are struck, and rows that the contacts press against their limits are
//! *stopped* ([`axis::impact`](crate::solve::joint)).
//!
//! Reads: shocks, struck bodies. Writes: joints; responses that hold no more.

use super::super::super::bodies::STILL;
use super::super::super::joint::{Joints, StopSpeeds};
use super::super::shock::Shock;
use super::super::{NONE, Struck};
use super::{Assemblies, Assembly, LARGEST};

impl Assemblies {
    /// Begins a sub-step.
    pub(in super::super) fn begin_substep(&mut self) {
        self.all.iter_mut().for_each(|assembly| assembly.is_settled = !assembly.has_limits);
    }

    /// Returns true for an assembly with limits.
    pub(in super::super) fn has_limits(&self, assembly: u32) -> bool {
        self.all[assembly as usize].has_limits
    }

    /// Takes the velocities away that joints of an assembly with limits hold, if one is faster than `still`, once a sub-step; `velocity` is the
    /// velocity of a row before. Returns true if there are [changes](Self::settled).
    pub(in super::super) fn settle(
        &mut self,
        assembly: u32,
        still: i64,
        joints: &mut Joints,
        velocity: impl FnMut(u32) -> [i64; 3],
    ) -> bool {
        let Assembly { nodes, is_settled, .. } = &mut self.all[assembly as usize];
        if core::mem::replace(is_settled, true) {
            return false;
        }
        joints.begin_impact(assembly as usize);
        self.changes.clear();
        self.changes.resize(nodes.len(), [0; 3]);
        joints.set_velocities(assembly as usize, velocity) > still
            && joints.settle(assembly as usize, &mut self.changes)
    }

    /// The rows of the bodies of the assembly that was settled, and the changes of their velocities.
    pub(in super::super) fn settled(&self, assembly: u32) -> impl Iterator<Item = (u32, [i64; 3])> + '_ {
        let rows = self.rows[self.all[assembly as usize].nodes.clone()].iter().copied();
        rows.zip(self.changes.iter().copied()).filter(|&(row, _)| row != STILL)
    }

    /// Stops the rows of joints that the shocks press against their limits: for the impulses that shocks have, and that each of them would have
    /// next. The responses of an assembly are found anew where other rows are stopped than before.
    pub(in super::super) fn stop_rows(
        &mut self,
        shocks: &mut [Shock],
        struck: &mut [Struck],
        struck_of: &[u32],
        speeds: &StopSpeeds,
        joints: &mut Joints,
    ) {
        for index in 0..self.set.len() {
            let assembly = self.set[index];
            let Assembly { has_limits, share, stopped_share, .. } = &mut self.all[assembly as usize];
            let is_known = core::mem::replace(stopped_share, *share) == *share;
            if is_known || !*has_limits || !joints.may_stop(assembly as usize) {
                continue;
            }
            self.push_nodes(assembly, shocks, struck, speeds.coarse);
            if joints.stop_rows(assembly as usize, &self.changes, speeds) {
                self.forget_responses(assembly, shocks, struck, struck_of);
            }
        }
    }

    /// Finds the changes of the velocities of the nodes of an assembly by contacts alone.
    fn push_nodes(&mut self, assembly: u32, shocks: &mut [Shock], struck: &[Struck], coarse: i32) {
        self.changes.clear();
        self.changes.resize(self.all[assembly as usize].nodes.len(), [0; 3]);
        for shock in shocks {
            let is_struck = shock.rows.map(|row| self.assembly_of(row) == Some(assembly));
            if is_struck == [false; 2] {
                continue;
            }
            let shares = shock.bodies.map(|body| struck[body as usize].share);
            shock.set_shares(shares);
            let impulses = shock.next_impulses(struck, coarse);
            for side in (0..2).filter(|&side| is_struck[side]) {
                let gain = shock.jacobian.gain(side, impulses, shares[side], coarse);
                let change = &mut self.changes[self.node_of[shock.rows[side] as usize] as usize];
                (0..3).for_each(|axis| change[axis] = (change[axis] + gain[axis]).clamp(-LARGEST, LARGEST));
            }
        }
    }

    /// Forgets the responses of an assembly.
    fn forget_responses(&mut self, assembly: u32, shocks: &mut [Shock], struck: &mut [Struck], struck_of: &[u32]) {
        self.all[assembly as usize].response_count = 0;
        for row in self.rows(assembly) {
            struck[struck_of[row as usize] as usize].response = NONE;
        }
        for shock in shocks {
            for side in 0..2 {
                shock.has_response[side] &= self.assembly_of(shock.rows[side]) != Some(assembly);
            }
        }
    }

    /// Bars rows from being stopped whose limits pull; all that are stopped if `is_last`. Returns true if there is one.
    pub(in super::super) fn bar_stops(&self, joints: &mut Joints, is_last: bool) -> bool {
        let mut is_any_barred = false;
        for &assembly in self.set.iter().filter(|&&assembly| self.has_limits(assembly)) {
            is_any_barred |= joints.bar_stops(assembly as usize, is_last);
        }
        is_any_barred
    }

    /// Begins the impact of all assemblies of the set once more, without the rows that are barred.
    pub(in super::super) fn begin_again(&mut self, joints: &mut Joints) {
        for &assembly in &self.set {
            self.all[assembly as usize].stopped_share = 0;
            joints.begin_impact_again(assembly as usize);
        }
    }
}
