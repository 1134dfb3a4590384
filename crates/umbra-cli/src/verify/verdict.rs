//! Verdicts on files, as text and as JSON.

use std::io;
use std::path::Path;
use std::time::Duration;

use serde::Serialize;
use serde_json::value::RawValue;
use umbra_physics::{Difference, Divergence, ReplayError};

use crate::failure::{BAD_JOB, OTHER_START, TOO_LARGE, UNREADABLE, tag};
use crate::finding::FindingLine;
use crate::load::Kind;
use crate::text::{self, counted, grouped};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Status {
    Ok,
    Tampered,
    Diverged,
    CutOff,
    OverLimits,
    OtherStart,
    TooLarge,
    PhysicsVersion,
    Malformed,
    Unreadable,
    BadJob,
    Failed,
}

impl Status {
    const fn name(self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::Tampered => "tampered",
            Self::Diverged => "diverged",
            Self::CutOff => "cut_off",
            Self::OverLimits => "over_limits",
            Self::OtherStart => "other_start",
            Self::TooLarge => "too_large",
            Self::PhysicsVersion => "physics_version",
            Self::Malformed => "malformed",
            Self::Unreadable => "unreadable",
            Self::BadJob => "bad_job",
            Self::Failed => "failed",
        }
    }

    pub(super) const fn exit(self) -> u8 {
        match self {
            Self::Ok => 0,
            Self::Tampered | Self::Diverged | Self::CutOff | Self::OverLimits | Self::OtherStart | Self::TooLarge => 1,
            Self::PhysicsVersion | Self::Malformed | Self::Unreadable | Self::BadJob | Self::Failed => 2,
        }
    }

    const fn of(error: &ReplayError) -> Self {
        match error {
            ReplayError::Tampered(_) => Self::Tampered,
            ReplayError::CutOff { .. } => Self::CutOff,
            ReplayError::PhysicsVersion { .. } => Self::PhysicsVersion,
            _ => Self::Malformed,
        }
    }
}

/// The part of a replay that was run again, and the number of hashes that are as recorded.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Played {
    pub(super) ticks: u64,
    pub(super) hashes: u64,
    /// The time that passed in its world, s.
    pub(super) seconds: f64,
    pub(super) wall: Duration,
    /// The hash of the world there.
    pub(super) end_hash: Option<u64>,
}

/// The result for a file.
#[derive(Debug)]
pub(super) struct Verdict {
    pub(super) status: Status,
    code: Option<u16>,
    reason: Option<String>,
    finding: Option<Difference>,
    played: Played,
    /// CPU time that the file took, its reading included.
    pub(super) cpu: Duration,
}

impl Verdict {
    fn new(status: Status, code: Option<u16>, reason: Option<String>) -> Self {
        Self { status, code, reason, finding: None, played: Played::default(), cpu: Duration::ZERO }
    }

    pub(super) fn ok(played: Played) -> Self {
        Self { played, ..Self::new(Status::Ok, None, None) }
    }

    pub(super) fn unreadable(error: &io::Error) -> Self {
        Self::new(Status::Unreadable, Some(UNREADABLE), Some(format!("cannot read: {error}")))
    }

    pub(super) fn too_large(limit: u64) -> Self {
        Self::new(Status::TooLarge, Some(TOO_LARGE), Some(format!("more than {} bytes", grouped(limit))))
    }

    pub(super) fn bad_job(reason: String) -> Self {
        Self::new(Status::BadJob, Some(BAD_JOB), Some(reason))
    }

    /// A defect of this program, whose report is on the standard error.
    pub(super) fn failed() -> Self {
        Self::new(Status::Failed, None, Some("a defect of this program: please report it with the file".to_owned()))
    }

    pub(super) fn other_start(finding: Option<Difference>) -> Self {
        let difference = finding.as_ref().map_or_else(String::new, |finding| format!(": {finding}"));
        let reason = Some(format!("it begins with another world{difference}"));
        Self { finding, ..Self::new(Status::OtherStart, Some(OTHER_START), reason) }
    }

    pub(super) fn flawed(error: ReplayError, played: Played) -> Self {
        let verdict = Self::new(Status::of(&error), Some(error.code()), Some(error.to_string()));
        let finding = if let ReplayError::Tampered(finding) = error { Some(*finding) } else { None };
        Self { finding, played, ..verdict }
    }

    pub(super) fn diverged(divergence: Divergence, played: Played) -> Self {
        let verdict = Self::new(Status::Diverged, Some(divergence.code()), Some(divergence.to_string()));
        Self { finding: Some(divergence.difference), played, ..verdict }
    }

    pub(super) fn over_limits(code: u16, reason: String, played: Played) -> Self {
        Self { played, ..Self::new(Status::OverLimits, Some(code), Some(reason)) }
    }

    /// The verdict on a file of another kind.
    pub(super) fn foreign(self, kind: Kind) -> Self {
        Self { reason: Some(format!("expected a replay, found {}", kind.advice("FILE"))), ..self }
    }

    pub(super) fn line(&self, file: &Path, exact: bool) -> String {
        let Self { status, code, reason, finding, played, .. } = self;
        let mut what = reason.clone().unwrap_or_else(|| played.describe());
        if let Some(finding) = finding.as_ref().filter(|_| exact) {
            what = what.replace(&finding.to_string(), &finding.exact().to_string());
        }
        let code = code.map_or_else(String::new, |code| format!(" [{}]", tag(code)));
        format!("{}  {}  {what}{code}", status.name(), text::path(file))
    }

    fn report(&self) -> Report<'_> {
        let Self { status, code, reason, finding, played, cpu } = self;
        Report {
            status: *status,
            ticks: played.ticks,
            hashes: played.hashes,
            wall_seconds: played.wall.as_secs_f64(),
            cpu_seconds: cpu.as_secs_f64(),
            end_hash: played.end_hash.map(|hash| format!("{hash:016x}")),
            code: code.map(tag),
            reason: reason.as_deref(),
            finding: finding.as_ref().map(FindingLine::from),
        }
    }

    pub(super) fn json(&self, file: &Path) -> String {
        json(&FileLine { file: file.display().to_string(), report: self.report() })
    }

    /// The answer to a job, which stood in a line of the input, from 1.
    pub(super) fn answer(&self, id: Option<&RawValue>, line: u64) -> String {
        json(&JobLine { id, line, report: self.report() })
    }
}

/// Texts and numbers always have a form in JSON.
fn json(line: &impl Serialize) -> String {
    serde_json::to_string(line).unwrap_or_default()
}

#[derive(Serialize)]
struct FileLine<'a> {
    file: String,
    #[serde(flatten)]
    report: Report<'a>,
}

#[derive(Serialize)]
struct JobLine<'a> {
    id: Option<&'a RawValue>,
    line: u64,
    #[serde(flatten)]
    report: Report<'a>,
}

#[derive(Serialize)]
struct Report<'a> {
    status: Status,
    /// Run again; those with a hash, which is as recorded.
    ticks: u64,
    hashes: u64,
    wall_seconds: f64,
    cpu_seconds: f64,
    /// The hash after the last of these ticks, if the run is as recorded up to there.
    end_hash: Option<String>,
    code: Option<String>,
    reason: Option<&'a str>,
    finding: Option<FindingLine>,
}

impl Played {
    /// Writes it as `3,600 ticks, 3,600 hashes, 58× real time`.
    fn describe(&self) -> String {
        let mut text =
            format!("{}, {}", counted(self.ticks, ["tick", "ticks"]), counted(self.hashes, ["hash", "hashes"]));
        let factor = self.seconds / self.wall.as_secs_f64();
        if factor.is_finite() && self.ticks > 0 {
            let factor = if factor < 10.0 { format!("{factor:.1}") } else { grouped(factor as u64) };
            text += &format!(", {factor}× real time");
        }
        text
    }
}
