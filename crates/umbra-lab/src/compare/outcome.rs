//! The result of a comparison, as a table, as JSON, as a picture.

use std::fmt;

use serde::Serialize;
use umbra_physics::Integrator;
use umbra_scene::SceneError;

use super::largest_and_last;
use super::way::Gap;
use crate::chart::{Axis, Chart, Line, Look, Scale};

#[derive(Serialize)]
pub(super) struct Comparison {
    pub(super) title: String,
    pub(super) ticks: u64,
    pub(super) seconds: f64,
    pub(super) reference: Reference,
    #[serde(rename = "runs")]
    pub(super) outcomes: Vec<Outcome>,
}

/// The reference that the runs are compared with, and its distance from one with half as many steps.
#[derive(Serialize)]
pub(super) struct Reference {
    integrator: &'static str,
    scalar: &'static str,
    steps_to_a_tick: u32,
    #[serde(flatten)]
    converged: Errors,
}

/// A run of the scene as it is.
#[derive(Serialize)]
pub(super) struct Outcome {
    scalar: &'static str,
    integrator: &'static str,
    /// The reason why there is no result.
    refused: Option<String>,
    #[serde(flatten)]
    numbers: Option<Numbers>,
}

#[derive(Serialize)]
pub(super) struct Numbers {
    #[serde(flatten)]
    errors: Errors,
    /// Bodies that left the envelope.
    quarantined: usize,
    /// CPU seconds to a simulated second.
    cost: f64,
}

/// Errors, m and rad, at the end and the largest of all the time.
#[derive(Serialize)]
struct Errors {
    position_at_end: f64,
    position_at_most: f64,
    angle_at_end: f64,
    angle_at_most: f64,
    #[serde(skip)]
    over_time: Vec<Gap>,
}

impl Errors {
    fn new(over_time: Vec<Gap>) -> Self {
        let (largest, end) = largest_and_last(&over_time);
        Self {
            position_at_end: end.position,
            position_at_most: largest.position,
            angle_at_end: end.angle,
            angle_at_most: largest.angle,
            over_time,
        }
    }

    /// Positions over time, of many moments the worst.
    fn points(&self) -> Vec<(f64, f64)> {
        const MOST: usize = 240;
        let pieces = self.over_time.chunks(self.over_time.len().div_ceil(MOST).max(1));
        pieces.map(|piece| (piece[0].time, largest_and_last(piece).0.position)).collect()
    }
}

impl Reference {
    pub(super) fn new(integrator: Integrator, steps_to_a_tick: u32, gaps: Vec<Gap>) -> Self {
        Self { integrator: integrator.name(), scalar: "f64", steps_to_a_tick, converged: Errors::new(gaps) }
    }
}

impl Numbers {
    pub(super) fn new(gaps: Vec<Gap>, quarantined: usize, cost: f64) -> Self {
        Self { errors: Errors::new(gaps), quarantined, cost }
    }
}

impl Outcome {
    pub(super) fn new(scalar: &'static str, integrator: Integrator, result: Result<Numbers, SceneError>) -> Self {
        let (refused, numbers) = match result {
            Ok(numbers) => (None, Some(numbers)),
            Err(error) => (Some(error.message), None),
        };
        Self { scalar, integrator: integrator.name(), refused, numbers }
    }
}

/// Two digits and a power of ten.
fn short(number: f64) -> String {
    if number == 0.0 { "0".to_owned() } else { format!("{number:.1e}") }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "  {:<17} {:<4}", self.integrator, self.scalar)?;
        let Some(Numbers { errors, quarantined, cost }) = &self.numbers else {
            return writeln!(f, "  {}", self.refused.as_deref().unwrap_or_default());
        };
        let Errors { position_at_end, position_at_most, angle_at_end, angle_at_most, .. } = errors;
        for number in [position_at_end, position_at_most, angle_at_end, angle_at_most, cost] {
            write!(f, " {:>10}", short(*number))?;
        }
        if *quarantined > 0 {
            write!(f, "  {quarantined} quarantined")?;
        }
        writeln!(f)
    }
}

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.title.is_empty() {
            writeln!(f, "{}\n", self.title)?;
        }
        let Reference { integrator, scalar, steps_to_a_tick, converged } = &self.reference;
        let Errors { position_at_most, angle_at_most, .. } = converged;
        let (metres, radians) = (short(*position_at_most), short(*angle_at_most));
        writeln!(
            f,
            "  {} ticks, {:.3} s; the reference is {integrator} in {scalar}, {steps_to_a_tick} steps to a tick.",
            self.ticks, self.seconds
        )?;
        writeln!(
            f,
            "  Half as many differ from it by {metres} m and {radians} rad at most: an error near that says nothing.\n"
        )?;
        writeln!(f, "                               error in m          error in rad      CPU s to a")?;
        writeln!(f, "  integrator        in       at end    at most     at end    at most   second")?;
        self.outcomes.iter().try_for_each(|outcome| outcome.fmt(f))
    }
}

impl Comparison {
    /// The errors over time as SVG.
    pub(super) fn draw(&self) -> String {
        const REFERENCE: Look = Look { colour: 6, stroke: 0, marks: false };
        let look = |i: usize| Look { colour: i / 3, stroke: i % 3, marks: false };
        let line = |(i, outcome): (usize, &Outcome)| {
            let numbers = outcome.numbers.as_ref()?;
            let name = format!("{}, {}", outcome.integrator, outcome.scalar);
            Some(Line { name, look: look(i), points: numbers.errors.points() })
        };
        let mut lines: Vec<Line> = self.outcomes.iter().enumerate().filter_map(line).collect();
        let coarser = "coarser reference";
        lines.push(Line { name: coarser.to_owned(), look: REFERENCE, points: self.reference.converged.points() });
        let mut legend: Vec<(Look, &str)> =
            Integrator::ALL.iter().enumerate().map(|(i, integrator)| (look(3 * i), integrator.name())).collect();
        let scalars = self.outcomes.iter().take(3).enumerate();
        legend.extend(scalars.map(|(i, outcome)| (Look { colour: 5, ..look(i) }, outcome.scalar)));
        legend.push((REFERENCE, coarser));
        let errors = lines.iter().flat_map(|line| &line.points).map(|point| point.1);
        let chart = Chart {
            x: Axis { label: "time in s", scale: Scale::Linear(0.0, self.seconds) },
            y: Axis { label: "error in m", scale: Scale::log(errors, f64::INFINITY) },
            lines,
        };
        let title = if self.title.is_empty() { "Scene" } else { &self.title };
        chart.file(title, &legend)
    }
}
