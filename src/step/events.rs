//! Events: contacts that begin and end, hits, and colliders that enter and leave sensors.
//!
//! Reads: the contacts before and after the step, poses at its end, the pairs that calls ended. Writes: the report, the overlaps of
//! sensors.

use super::Step;
use super::contacts::Contacts;
use crate::contact::{ColliderPair, ContactRecord, Overlap, compare, list_pairs};
use crate::scalar::Scalar;
use crate::slots::BodyId;

impl<S: Scalar> Step<'_, S> {
    /// Drops the contacts and the impulses of joints of bodies that were quarantined in the step: if one is released, they start anew.
    pub(super) fn drop_contacts_of_quarantined(&mut self) {
        let Contacts { colliders, contacts, joints, joint_states, .. } = &mut self.contacts;
        let report = &mut self.workspace.report;
        if report.faults.is_empty() {
            return;
        }
        let faults = &report.faults;
        let is_at_fault = |body: BodyId| faults.binary_search_by_key(&body, |fault| fault.body).is_ok();
        contacts.records.retain(|record: &ContactRecord| {
            let colliders = record.pair().map(|outline| colliders.at(outline.slot));
            !colliders.into_iter().flatten().any(|collider| is_at_fault(collider.body))
        });
        for fault in faults {
            joint_states.relax(joints.of(fault.body.slot));
        }
        report.hits.retain(|hit| !hit.pair.bodies.into_iter().any(is_at_fault));
    }

    /// Reports events, and keeps the overlaps of sensors.
    pub(super) fn report_events(&mut self) {
        let Contacts { colliders, contacts, settings, .. } = &mut self.contacts;
        let any_contacts = colliders.any_contact_events();
        let any_overlaps = colliders.any_sensors() || !contacts.overlaps.is_empty();
        if !any_contacts && !any_overlaps && contacts.ended.is_empty() {
            return;
        }
        let workspace = &mut *self.workspace;
        let bodies = &*self.bodies;
        let colliders = colliders.fixed();
        let report = &mut workspace.report;
        if !contacts.ended.is_empty() {
            contacts.pushed_at = self.settings.tick;
        }
        for ended in contacts.ended.drain(..) {
            if ended.is_sensor { &mut report.sensors_left } else { &mut report.contacts_ended }.push(ended.pair);
        }
        if let Some(memory) = workspace.contacts.as_deref_mut() {
            if any_contacts {
                list_pairs(&contacts.records, colliders, &mut memory.touching_after);
                let pair = |slots| ColliderPair::of_contact(bodies, colliders, slots);
                let lists = [&memory.touching_before[..], &memory.touching_after];
                let ended = &mut report.contacts_ended;
                let began = &mut report.contacts_began;
                compare(lists, |slots| ended.extend(pair(slots)), |slots| began.extend(pair(slots)));
            }
            if any_overlaps {
                memory.find_overlaps(bodies, colliders, &report.fell_asleep, &settings.to_fx());
                let pair = |overlap: Overlap| ColliderPair::new(bodies, colliders, overlap.slots());
                let lists = [&contacts.overlaps[..], memory.overlaps()];
                let left = &mut report.sensors_left;
                let entered = &mut report.sensors_entered;
                compare(lists, |overlap| left.extend(pair(overlap)), |overlap| entered.extend(pair(overlap)));
                // A collider that was in the sensor at the start only leaves it, also where a call moved it out.
                left.sort_unstable_by_key(ColliderPair::rank);
                let has_left =
                    |pair: &ColliderPair| left.binary_search_by_key(&pair.rank(), ColliderPair::rank).is_ok();
                let crossed = memory.crossed().iter().filter_map(|&overlap| pair(overlap));
                report.sensors_crossed.extend(crossed.filter(|pair| !has_left(pair)));
                left.extend_from_slice(&report.sensors_crossed);
                entered.extend_from_slice(&report.sensors_crossed);
                if contacts.overlaps != memory.overlaps() {
                    contacts.overlaps.clear();
                    contacts.overlaps.extend_from_slice(memory.overlaps());
                    contacts.pushed_at = self.settings.tick;
                }
            }
        }
        for list in [
            &mut report.contacts_ended,
            &mut report.contacts_began,
            &mut report.sensors_left,
            &mut report.sensors_entered,
            &mut report.sensors_crossed,
        ] {
            list.sort_unstable_by_key(ColliderPair::rank);
        }
    }
}
