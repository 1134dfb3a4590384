//! Findings in JSON.

use serde::Serialize;
use umbra_physics::{Difference, Finding};

/// The first value that is another one. Values are text, exactly as they are; null is none, or one that is not known.
#[derive(Serialize)]
pub(crate) struct FindingLine {
    tick: u64,
    phase: String,
    place: String,
    field: String,
    recorded: Option<String>,
    found: Option<String>,
}

impl From<&Finding> for FindingLine {
    fn from(finding: &Finding) -> Self {
        let Finding { tick, phase, place, field, recorded, found } = finding;
        Self {
            tick: *tick,
            phase: phase.to_string(),
            place: place.to_string(),
            field: field.clone(),
            recorded: recorded.clone(),
            found: found.clone(),
        }
    }
}

/// A value in which two worlds differ.
#[derive(Serialize)]
pub(crate) struct DifferenceLine {
    place: String,
    field: String,
    left: Option<String>,
    right: Option<String>,
}

impl From<&Difference> for DifferenceLine {
    fn from(difference: &Difference) -> Self {
        let Difference { place, field, left, right } = difference;
        Self { place: place.to_string(), field: field.clone(), left: left.clone(), right: right.clone() }
    }
}
