//! Limits on what a file of a stranger may cost. All are finite, whoever sets them.

use std::collections::BTreeMap;
use std::io;
use std::path::Path;
use std::time::Duration;

use umbra_physics::ReplayLimits;

use crate::failure::Failure;
use crate::load::{self, Kind};

#[derive(Clone, Copy)]
enum Limit {
    Bytes,
    CpuSeconds,
    Ticks,
    Bodies,
    Fields,
    Colliders,
    Pairs,
    Commands,
}

struct Row {
    limit: Limit,
    name: &'static str,
    default: u64,
    about: &'static str,
}

/// The limits, in the order in which a [`Limits`] has their values.
const ROWS: [Row; 8] = [
    row(Limit::Bytes, "bytes", 64 << 20, "bytes of a file; memory is about 16 times that"),
    row(Limit::CpuSeconds, "cpu_seconds", 600, "CPU time for a file, s"),
    row(Limit::Ticks, "ticks", 6 * 60 * 60 * 60, "ticks: six hours at 60 Hz"),
    row(Limit::Bodies, "bodies", 1 << 14, "bodies at any time"),
    row(Limit::Fields, "fields", 1 << 12, "force fields at any time"),
    row(Limit::Colliders, "colliders", 1 << 16, "colliders at any time"),
    row(Limit::Pairs, "pairs", 1 << 20, "pairs of colliders that its contact settings may allow"),
    row(Limit::Commands, "commands", 2_000_000, "commands in all ticks together"),
];

const fn row(limit: Limit, name: &'static str, default: u64, about: &'static str) -> Row {
    Row { limit, name, default, about }
}

/// A limit that is set by the arguments.
#[derive(Clone, Debug)]
pub(super) struct Setting {
    name: String,
    value: u64,
}

impl Setting {
    /// Reads `ticks=216000`.
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        let (name, value) = text.split_once('=').ok_or_else(|| "expected NAME=N, such as ticks=216000".to_owned())?;
        let value = value.parse().map_err(|_| "expected a whole number from 0, below 2^64".to_owned())?;
        index(name)?;
        Ok(Self { name: name.to_owned(), value })
    }
}

/// Changes of limits by their names.
pub(super) type Changes = BTreeMap<String, u64>;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Limits([u64; ROWS.len()]);

impl Default for Limits {
    fn default() -> Self {
        Self(ROWS.map(|row| row.default))
    }
}

impl Limits {
    /// The defaults, with the changes in a file and then those of the arguments.
    pub(super) fn new(file: Option<&Path>, settings: &[Setting]) -> Result<Self, Failure> {
        let mut limits = Self::default();
        if let Some(file) = file {
            let failed = Failure::file(file, "read");
            let wrong = |what: String| failed(io::Error::new(io::ErrorKind::InvalidData, what));
            let text = load::bytes(file)?;
            if let Some(kind) = Kind::of(&text).filter(|&kind| kind != Kind::Scene) {
                let expected = "a JSON object with limits";
                return Err(Failure::Foreign { file: file.into(), expected, kind: Some(kind) });
            }
            let changes: Changes = serde_json::from_slice(&text).map_err(|error| wrong(error.to_string()))?;
            for (name, value) in changes {
                limits.0[index(&name).map_err(&wrong)?] = value;
            }
        }
        for Setting { name, value } in settings {
            limits.0[index(name).map_err(|what| Failure::Usage { what })?] = *value;
        }
        Ok(limits)
    }

    /// The limits of a job, which may lower those of the service.
    pub(super) fn lowered(mut self, changes: &Changes) -> Result<Self, String> {
        for (name, &value) in changes {
            let limit = &mut self.0[index(name)?];
            if value > *limit {
                return Err(format!(
                    "limits.{name}: {value} is above the limit of {limit}, which a job can only lower"
                ));
            }
            *limit = value;
        }
        Ok(self)
    }

    fn get(&self, limit: Limit) -> u64 {
        self.0[limit as usize]
    }

    pub(super) fn bytes(&self) -> u64 {
        self.get(Limit::Bytes)
    }

    pub(super) fn cpu_time(&self) -> Duration {
        Duration::from_secs(self.get(Limit::CpuSeconds))
    }

    pub(super) fn replay(&self) -> ReplayLimits {
        // No world has so many.
        let count = |limit| u32::try_from(self.get(limit)).unwrap_or(u32::MAX);
        ReplayLimits {
            ticks: self.get(Limit::Ticks),
            bodies: count(Limit::Bodies),
            fields: count(Limit::Fields),
            colliders: count(Limit::Colliders),
            pairs: count(Limit::Pairs),
            commands: self.get(Limit::Commands),
        }
    }
}

/// The place of the value of a limit.
fn index(name: &str) -> Result<usize, String> {
    let row = ROWS.iter().find(|row| row.name == name).map(|row| row.limit as usize);
    row.ok_or_else(|| format!("no limit `{name}`; there are {}", ROWS.map(|row| row.name).join(", ")))
}

/// The limits and their defaults, as the help has them.
pub(super) fn help() -> String {
    let lines = ROWS.map(|Row { name, default, about, .. }| format!("  {name:<12} {default:>9}  {about}\n"));
    lines.concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_limit_is_at_its_place() {
        assert!(ROWS.iter().enumerate().all(|(place, row)| row.limit as usize == place));
        let replay = Limits::default().replay();
        assert_eq!((replay.ticks, replay.bodies, replay.fields), (1_296_000, 16_384, 4_096));
        assert_eq!((replay.colliders, replay.pairs, replay.commands), (65_536, 1 << 20, 2_000_000));
        assert_eq!(Limits([u64::MAX; ROWS.len()]).replay().pairs, u32::MAX);
    }

    #[test]
    fn a_job_lowers_limits_and_raises_none() {
        let change = |name: &str, value| Changes::from([(name.to_owned(), value)]);
        let limits = Limits::default();
        assert_eq!(limits.lowered(&change("bytes", 5)).map(|limits| limits.bytes()), Ok(5));
        assert_eq!(limits.lowered(&change("cpu_seconds", 600)), Ok(limits));
        let above = "limits.cpu_seconds: 601 is above the limit of 600, which a job can only lower".to_owned();
        assert_eq!(limits.lowered(&change("cpu_seconds", 601)), Err(above));
        assert!(
            limits
                .lowered(&change("tick", 1))
                .is_err_and(|what| what.starts_with("no limit `tick`; there are bytes, "))
        );
    }
}
