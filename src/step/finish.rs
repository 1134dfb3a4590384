//! The end of a step: quarantine and sleep.

use super::march::is_ready;
use super::{Context, Has, Scratch};
use crate::body::{Activity, Bodies, BodyKind};
use crate::error::Fault;
use crate::force::{End, FieldKind, FieldSet};
use crate::scalar::Scalar;

impl<S: Scalar> Context<'_, S> {
    pub(super) fn finish(&mut self, has: Has) {
        self.name_faults();
        if let Some(ticks) = self.sleep_after {
            if has.wanderers {
                keep_awake_around_wanderers(self.bodies, self.fields);
            }
            if self.scratch.found.ready {
                self.find_sleepers(ticks);
            }
        }
        let Scratch { faults, fell_asleep, .. } = &*self.scratch;
        let taken_out = faults
            .iter()
            .map(|fault| (fault.body, Activity::Quarantined))
            .chain(fell_asleep.iter().map(|&body| (body, Activity::Asleep)));
        let mut any = false;
        for (body, activity) in taken_out {
            if let Ok(i) = self.bodies.find(body) {
                self.bodies.set_activity(i, activity);
                any = true;
            }
        }
        if any {
            self.scratch.forget();
        }
    }

    /// The faults by their bodies' names and in their order; the first of a body is its cause.
    fn name_faults(&mut self) {
        let Scratch { found, faults, .. } = &mut *self.scratch;
        if found.faults.is_empty() {
            return;
        }
        // Stable, which matters within a body alone.
        found.faults.sort_by_key(|(i, _)| *i);
        found.faults.dedup_by_key(|(i, _)| *i);
        faults.extend(found.faults.iter().map(|&(i, cause)| Fault { body: self.bodies.id(i), cause }));
        faults.sort_unstable_by_key(|fault| fault.body);
    }

    /// Bodies that the next step would leave as they are, to the bit, and that were so for `ticks` steps. Skipping them
    /// changes nothing: their public velocities are zero, the step changed nothing below them either, no force was
    /// applied, and no body that might still move acts on them.
    fn find_sleepers(&mut self, ticks: u32) {
        let Scratch { fell_asleep, links, kept_up, .. } = &mut *self.scratch;
        let moving = self.bodies.moving();
        let rest = &self.bodies.columns.motion.rest;
        if !rest[..moving].iter().any(|&rest| is_ready(rest, ticks)) {
            return;
        }
        island_roots(self.bodies, self.fields, moving, links);
        // An island sleeps as a whole, when one of its own bodies tries, and one that is not ready keeps it up.
        kept_up.clear();
        kept_up.resize(links.len(), true);
        for i in (0..moving).filter(|&i| is_ready(rest[i], ticks)) {
            kept_up[links[i] as usize] = false;
        }
        for i in (0..moving).filter(|&i| rest[i] < ticks) {
            kept_up[links[i] as usize] = true;
        }
        let ready = (0..moving).filter(|&i| !kept_up[links[i] as usize]);
        fell_asleep.extend(ready.map(|i| self.bodies.id(i)));
        fell_asleep.sort_unstable();
    }
}

/// A body that an attractor carried by another, movable body acts on does not sleep: what acts on it may change.
fn keep_awake_around_wanderers<S: Scalar>(bodies: &mut Bodies<S>, fields: &FieldSet<S>) {
    for (_, field) in fields.iter() {
        let FieldKind::Attractor { centre: End::Body(carrier), .. } = &field.kind else { continue };
        let Ok(own) = bodies.find(carrier.body) else { continue };
        if !wanders(bodies, own) {
            continue;
        }
        for i in 0..bodies.moving() {
            if i != own && bodies.info(i).feels(field.groups) {
                bodies.columns.motion.rest[i] = 0;
            }
        }
    }
}

/// Whether a body may be elsewhere after a step.
pub(super) fn wanders<S: Scalar>(bodies: &Bodies<S>, i: usize) -> bool {
    bodies.info(i).kind != BodyKind::Static && bodies.activity(i).takes_part()
}

/// For each of the first `count` bodies of the columns, the lowest index among those of them that springs join it to, over
/// any number of springs. Static bodies and those that take no part join nothing.
fn island_roots<S: Scalar>(bodies: &Bodies<S>, fields: &FieldSet<S>, count: usize, links: &mut alloc::vec::Vec<u32>) {
    fn root(links: &mut [u32], mut i: usize) -> usize {
        while links[i] as usize != i {
            links[i] = links[links[i] as usize];
            i = links[i] as usize;
        }
        i
    }
    links.clear();
    links.extend(0..count as u32);
    for (_, field) in fields.iter() {
        let FieldKind::Spring { near, far: End::Body(far), .. } = &field.kind else { continue };
        let (Ok(a), Ok(b)) = (bodies.find(near.body), bodies.find(far.body)) else { continue };
        let joins = |i: usize| i < count && wanders(bodies, i);
        if joins(a) && joins(b) {
            let (a, b) = (root(links, a), root(links, b));
            links[a.max(b)] = a.min(b) as u32;
        }
    }
    for i in 0..links.len() {
        links[i] = root(links, i) as u32;
    }
}
