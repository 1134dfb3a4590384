//! Quarantine: bodies with a fault are taken out of the simulation. The checks gave them back the state before the step.
//!
//! Reads: the faults found. Writes: the report, activities.

use super::{Report, Workspace};
use crate::body::{Activity, Bodies};
use crate::error::Fault;
use crate::scalar::Scalar;

use super::workspace::Findings;

/// Reports the faults in the order of the handles; the first fault of a body is its cause.
pub(super) fn find<S: Scalar>(bodies: &Bodies<S>, workspace: &mut Workspace<S>) {
    let Workspace { findings, report, .. } = workspace;
    if findings.faults.is_empty() {
        return;
    }
    findings.sort_faults();
    findings.faults.dedup_by_key(|(i, _)| *i);
    report.faults.extend(findings.faults.iter().map(|&(i, cause)| Fault { body: bodies.id(i), cause }));
    report.faults.sort_unstable_by_key(|fault| fault.body);
}

/// The first fault in the order of the handles.
pub(super) fn first<S: Scalar>(bodies: &Bodies<S>, findings: &Findings) -> Option<Fault> {
    let faults = findings.faults.iter().map(|&(i, cause)| Fault { body: bodies.id(i), cause });
    // The first of equal faults: the first cause of a body.
    faults.min_by_key(|fault| fault.body)
}

/// Takes the bodies at fault and the bodies that fell asleep out of the moving ones.
pub(super) fn take_out<S: Scalar>(bodies: &mut Bodies<S>, report: &Report<S>) {
    let at_fault = report.faults.iter().map(|fault| (fault.body, Activity::Quarantined));
    let asleep = report.fell_asleep.iter().map(|&body| (body, Activity::Asleep));
    for (body, activity) in at_fault.chain(asleep) {
        if let Ok(i) = bodies.find(body) {
            bodies.set_activity(i, activity);
        }
    }
}
