//! The result of a run, as text or as JSON.

use std::fmt;
use std::time::Duration;

use serde::Serialize;
use umbra_physics::scalar::ToF64;
use umbra_physics::{Activity, Error, Scalar, World};
use umbra_scene::Scene;

use crate::profile::Profile;

/// A value as exact text, and as a double for a glance.
#[derive(Clone, Debug)]
struct Value {
    exact: String,
    near: f64,
}

impl Serialize for Value {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.exact)
    }
}

impl fmt::Display for Value {
    /// The exact text if it is short, else ten digits.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.exact.len() <= 14 {
            return f.write_str(&self.exact);
        }
        let size = self.near.abs();
        if (1e-3..1e7).contains(&size) {
            let places = (9.0 - size.log10().floor()) as usize;
            write!(f, "{:.places$}", self.near)
        } else {
            write!(f, "{:.9e}", self.near)
        }
    }
}

/// The sums over a world that physics keeps an eye on. None is one that does not fit.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Totals {
    energy: Option<Value>,
    momentum: Option<[Value; 2]>,
    angular_momentum: Option<Value>,
}

impl Totals {
    pub(crate) fn of<S: Scalar>(world: &World<S>) -> Self
    where
        S::Wide: ToF64,
    {
        let value = |wide: S::Wide| Value { exact: wide.to_string(), near: wide.to_f64() };
        let total = |wide: Result<S::Wide, Error>| wide.ok().map(value);
        Self {
            energy: total(world.energy()),
            momentum: world.momentum().ok().map(|p| [value(p.x), value(p.y)]),
            angular_momentum: total(world.angular_momentum()),
        }
    }
}

/// A body that left the envelope.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct FaultLine {
    pub(crate) tick: u64,
    pub(crate) name: String,
    pub(crate) cause: String,
}

#[derive(Clone, Debug, Serialize)]
struct Joints {
    total: usize,
    broken: usize,
}

#[derive(Clone, Debug, Serialize)]
struct Bodies {
    total: usize,
    moving: usize,
    asleep: usize,
    quarantined: usize,
    disabled: usize,
}

#[derive(Clone, Debug, Serialize)]
pub(crate) struct Summary {
    title: String,
    #[serde(skip)]
    about: String,
    scalar: &'static str,
    integrator: &'static str,
    time_step: String,
    tick: u64,
    time: String,
    bodies: Bodies,
    fields: usize,
    joints: Joints,
    faults: Vec<FaultLine>,
    before: Totals,
    after: Totals,
    wall_seconds: f64,
    ns_per_body_and_step: f64,
    state_hash: String,
    /// Only if it was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) profile: Option<Profile>,
}

impl Summary {
    pub(crate) fn new<S: Scalar>(
        scene: &Scene,
        world: &World<S>,
        before: Totals,
        faults: Vec<FaultLine>,
        stepping: Duration,
        body_steps: u64,
    ) -> Self
    where
        S::Wide: ToF64,
    {
        let with = |activity| world.bodies().filter(|body| body.activity() == activity).count();
        let ratio = |num: u128, den: u128| if den == 1 { num.to_string() } else { format!("{num}/{den}") };
        let (num, den) = world.def().time_step.seconds();
        let time = world.elapsed();
        Self {
            title: scene.title.clone(),
            about: scene.about.clone(),
            scalar: S::NAME,
            integrator: world.def().integrator.name(),
            time_step: ratio(num.into(), den.into()),
            tick: world.tick(),
            time: ratio(time.num, time.den),
            bodies: Bodies {
                total: world.body_count(),
                moving: world.moving_count(),
                asleep: with(Activity::Asleep),
                quarantined: with(Activity::Quarantined),
                disabled: with(Activity::Disabled),
            },
            fields: world.fields().count(),
            joints: Joints {
                total: world.joint_count(),
                broken: world.joints().filter(|joint| joint.is_broken()).count(),
            },
            faults,
            before,
            after: Totals::of(world),
            wall_seconds: stepping.as_secs_f64(),
            ns_per_body_and_step: if body_steps == 0 { 0.0 } else { stepping.as_nanos() as f64 / body_steps as f64 },
            state_hash: format!("{:016x}", world.state_hash()),
            profile: None,
        }
    }

    fn write_faults(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const SHOWN: usize = 10;
        for FaultLine { tick, name, cause } in self.faults.iter().take(SHOWN) {
            writeln!(f, "  quarantined       {name} at tick {tick}: {cause}")?;
        }
        if self.faults.len() > SHOWN {
            writeln!(f, "                    and {} more", self.faults.len() - SHOWN)?;
        }
        Ok(())
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.title.is_empty() {
            writeln!(f, "{}", self.title)?;
        }
        for line in wrapped(&self.about, 96) {
            writeln!(f, "  {line}")?;
        }
        if !(self.title.is_empty() && self.about.is_empty()) {
            writeln!(f)?;
        }
        let Bodies { total, moving, asleep, quarantined, disabled } = &self.bodies;
        let disabled = if *disabled > 0 { format!(", {disabled} disabled") } else { String::new() };
        writeln!(f, "  computed in       {}, {}, {} s a step", self.scalar, self.integrator, self.time_step)?;
        writeln!(f, "  tick              {}, after {} s", self.tick, self.time)?;
        writeln!(
            f,
            "  bodies            {total}: {moving} moving, {asleep} asleep, {quarantined} quarantined{disabled}"
        )?;
        if self.joints.total > 0 {
            writeln!(f, "  joints            {}: {} broken", self.joints.total, self.joints.broken)?;
        }
        self.write_faults(f)?;
        let (before, after) = (&self.before, &self.after);
        change(f, "energy", "J", &before.energy, &after.energy)?;
        let axis = |totals: &Totals, i: usize| totals.momentum.as_ref().map(|p| p[i].clone());
        change(f, "momentum x", "kg·m/s", &axis(before, 0), &axis(after, 0))?;
        change(f, "momentum y", "kg·m/s", &axis(before, 1), &axis(after, 1))?;
        change(f, "angular momentum", "kg·m²/s", &before.angular_momentum, &after.angular_momentum)?;
        let (wall, each) = (self.wall_seconds, self.ns_per_body_and_step);
        writeln!(f, "  wall time         {wall:.3} s in steps, {each:.0} ns per body and step")?;
        writeln!(f, "  state hash        {}", self.state_hash)?;
        self.profile.as_ref().map_or(Ok(()), |profile| profile.fmt(f))
    }
}

/// A value before and after.
fn change(
    f: &mut fmt::Formatter<'_>,
    name: &str,
    unit: &str,
    before: &Option<Value>,
    after: &Option<Value>,
) -> fmt::Result {
    let text = |value: &Option<Value>| value.as_ref().map_or("beyond 2^63".to_owned(), Value::to_string);
    let (from, to) = (text(before), text(after));
    let differs = match (before, after) {
        (Some(before), Some(after)) => before.exact != after.exact,
        _ => false,
    };
    if !differs {
        return writeln!(f, "  {name:<17} {to} {unit}, as before");
    }
    writeln!(f, "  {name:<17} {from} → {to} {unit}")
}

/// The words of a text in lines of at most `width` characters, where words allow.
fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}
