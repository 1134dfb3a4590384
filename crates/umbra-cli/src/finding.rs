//! Differences in JSON.

use serde::Serialize;
use umbra_physics::Difference;

/// The first value in which two recordings differ, or in which a file was changed. Values are exact, as text; null is a value
/// that is missing or unknown.
#[derive(Serialize)]
pub(crate) struct FindingLine {
    tick: u64,
    #[serde(rename = "phase")]
    phase: String,
    owner: String,
    field: String,
    recorded: Option<String>,
    found: Option<String>,
}

impl From<&Difference> for FindingLine {
    fn from(difference: &Difference) -> Self {
        let Difference { tick, phase, owner, field, left, right } = difference;
        Self {
            tick: *tick,
            phase: phase.to_string(),
            owner: owner.to_string(),
            field: field.clone(),
            recorded: left.clone(),
            found: right.clone(),
        }
    }
}

/// A value in which two worlds differ.
#[derive(Serialize)]
pub(crate) struct DifferenceLine {
    owner: String,
    field: String,
    left: Option<String>,
    right: Option<String>,
}

impl From<&Difference> for DifferenceLine {
    fn from(difference: &Difference) -> Self {
        let Difference { owner, field, left, right, .. } = difference;
        Self { owner: owner.to_string(), field: field.clone(), left: left.clone(), right: right.clone() }
    }
}
