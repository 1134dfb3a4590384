//! Differences in JSON.

use serde::Serialize;
use umbra_physics::Difference;

/// The first value in which two recordings differ, or in which a file was changed. Values are exact, as text; null is a value
/// that is missing or unknown, and a name that there is none; a key of 0 is none.
#[derive(Serialize)]
pub(crate) struct FindingLine {
    tick: u64,
    phase: String,
    owner: String,
    name: Option<String>,
    key: u64,
    field: String,
    recorded: Option<String>,
    found: Option<String>,
}

impl From<&Difference> for FindingLine {
    fn from(difference: &Difference) -> Self {
        let Difference { tick, phase, owner, name, key, field, left, right } = difference;
        Self {
            tick: *tick,
            phase: phase.to_string(),
            owner: owner.to_string(),
            name: name.clone(),
            key: *key,
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
    name: Option<String>,
    key: u64,
    field: String,
    left: Option<String>,
    right: Option<String>,
}

impl From<&Difference> for DifferenceLine {
    fn from(difference: &Difference) -> Self {
        let Difference { owner, name, key, field, left, right, .. } = difference;
        let (name, field, left, right) = (name.clone(), field.clone(), left.clone(), right.clone());
        Self { owner: owner.to_string(), name, key: *key, field, left, right }
    }
}
