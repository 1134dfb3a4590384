//! The data of a report. These are the fields of its JSON file, which `docs/report/README.md` describes.

use std::env::consts::{ARCH, OS};
use std::fs;

use serde::Serialize;
use umbra_physics::Integrator;

use super::parting::Parting;

#[derive(Serialize)]
pub(crate) struct Report {
    pub(crate) version: &'static str,
    pub(crate) command: String,
    pub(crate) machine: Machine,
    /// Steps a second that were tried.
    pub(crate) rates: Vec<u32>,
    /// Problems without contacts, and those with.
    pub(crate) problems: Vec<Results>,
    pub(crate) contacts: Vec<Results>,
    pub(crate) parting: Option<Parting>,
}

#[derive(Serialize)]
pub(crate) struct Machine {
    pub(crate) processor: Option<String>,
    pub(crate) system: String,
    /// True if the program was built with optimisation.
    pub(crate) optimised: bool,
}

impl Machine {
    pub(crate) fn this() -> Self {
        let cpuinfo = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let model = cpuinfo.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':'));
        let processor = model.map(|(_, name)| name.trim().to_owned());
        Self { processor, system: format!("{OS}, {ARCH}"), optimised: !cfg!(debug_assertions) }
    }
}

/// A problem and its runs.
#[derive(Serialize)]
pub(crate) struct Results {
    pub(crate) name: &'static str,
    #[serde(skip)]
    pub(crate) title: &'static str,
    #[serde(skip)]
    pub(crate) about: &'static str,
    #[serde(skip)]
    pub(crate) has_contacts: bool,
    pub(crate) unit: &'static str,
    /// The time at which the errors are read, s.
    pub(crate) seconds: u32,
    /// The error of the reference, in the unit.
    pub(crate) reference_error: f64,
    pub(crate) lines: Vec<Line>,
}

/// The runs of an integrator in a scalar.
#[derive(Serialize)]
pub(crate) struct Line {
    #[serde(serialize_with = "name")]
    pub(crate) integrator: Integrator,
    pub(crate) scalar: &'static str,
    /// The slope of the error against the time step, and the rates between which it was taken.
    pub(crate) order: Option<Order>,
    pub(crate) runs: Vec<Measured>,
}

fn name<S: serde::Serializer>(integrator: &Integrator, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(integrator.name())
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Order {
    pub(crate) slope: f64,
    pub(crate) from_rate: u32,
    pub(crate) to_rate: u32,
}

/// A run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Measured {
    /// Steps a second.
    pub(crate) rate: u32,
    /// The error at the end, in the problem's unit; none if a body left the envelope.
    pub(crate) error: Option<f64>,
    /// CPU seconds to a simulated second.
    pub(crate) cost: f64,
}
