//! The time of a run by parts of its steps, as text or as JSON.

use std::fmt;
use std::time::Duration;

use serde::Serialize;
use umbra_physics::{Scalar, Timers, World};

use crate::text::counted;

/// A part of a step.
#[derive(Clone, Debug, Serialize)]
struct Part {
    name: &'static str,
    us_per_step: f64,
    /// The share of the time of all parts, from 0 to 1.
    share: f64,
}

/// A count, as its mean over the steps.
#[derive(Clone, Debug, Serialize)]
struct Count {
    name: &'static str,
    per_step: f64,
}

#[derive(Clone, Debug, Serialize)]
pub(crate) struct Profile {
    steps: u64,
    us_per_step: f64,
    parts: Vec<Part>,
    counts: Vec<Count>,
}

impl Profile {
    /// The profile of all steps of a world.
    pub(crate) fn of<S: Scalar>(world: &World<S>) -> Self {
        let Timers { times, counts, .. } = world.timers();
        let steps = counts.steps.max(1) as f64;
        let us_per_step = |time: Duration| time.as_secs_f64() * 1e6 / steps;
        let whole = times.sum().as_secs_f64().max(f64::MIN_POSITIVE);
        let part = |(name, time): (&'static str, Duration)| Part {
            name,
            us_per_step: us_per_step(time),
            share: time.as_secs_f64() / whole,
        };
        Self {
            steps: counts.steps,
            us_per_step: us_per_step(times.sum()),
            parts: times.each().map(part).collect(),
            counts: counts
                .each()
                .filter(|(name, _)| *name != "steps")
                .map(|(name, count)| Count { name, per_step: count as f64 / steps })
                .collect(),
        }
    }
}

impl fmt::Display for Profile {
    /// Parts and counts that are zero are left out.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "\n  part of a step           µs   share   ({})", counted(self.steps, ["step", "steps"]))?;
        for Part { name, us_per_step, share } in self.parts.iter().filter(|part| part.us_per_step > 0.0) {
            writeln!(f, "  {name:<17} {us_per_step:>10.2} {:>6.1} %", share * 100.0)?;
        }
        writeln!(f, "  {:<17} {:>10.2}", "all", self.us_per_step)?;
        writeln!(f, "\n  in a step")?;
        for Count { name, per_step } in self.counts.iter().filter(|count| count.per_step > 0.0) {
            writeln!(f, "  {name:<17} {per_step:>10.2}")?;
        }
        Ok(())
    }
}
