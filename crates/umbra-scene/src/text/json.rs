//! The JSON of a scene: objects, lists, and values as text.

use alloc::format;
use alloc::string::{String, ToString};
use alloc::vec::Vec;
use core::fmt::Display;

use umbra_physics::{BodyKind, Damping, ForceOrImpulse, Locks, Mass, TimeStep, Vec2};

/// The fields of an object, each `"name": value`.
#[derive(Default)]
pub(super) struct Fields(Vec<String>);

impl Fields {
    pub(super) fn put(&mut self, name: &str, value: impl Display) {
        self.0.push(format!("\"{name}\": {value}"));
    }

    pub(super) fn unless(&mut self, is_default: bool, name: &str, value: impl Display) {
        if !is_default {
            self.put(name, value);
        }
    }

    /// The object over several lines, a field a line.
    pub(super) fn lines(&self) -> String {
        format!("{{\n  {}\n}}\n", self.0.join(",\n  "))
    }

    pub(super) fn line(&self) -> String {
        format!("{{{}}}", self.0.join(", "))
    }

    /// An object of one field, in a line.
    pub(super) fn of(name: &str, value: impl Display) -> String {
        format!("{{\"{name}\": {value}}}")
    }

    pub(super) fn of_name(name: &str) -> Self {
        let mut object = Self::default();
        object.put("name", text(name));
        object
    }

    pub(super) fn mass(&mut self, mass: Mass) {
        match mass {
            Mass::Kilograms(mass) => self.put("mass", mass),
            Mass::Explicit { mass, inertia } => {
                self.put("mass", mass);
                self.put("inertia", inertia);
            }
            Mass::FromColliders => self.put("mass", text("from_colliders")),
        }
    }

    pub(super) fn action(&mut self, action: ForceOrImpulse) {
        let at = match action {
            ForceOrImpulse::Force { force, point: at } => {
                self.put("force", point(force));
                at
            }
            ForceOrImpulse::Impulse { impulse, point: at } => {
                self.put("impulse", point(impulse));
                at
            }
            ForceOrImpulse::Torque(torque) => return self.put("torque", torque),
            ForceOrImpulse::AngularImpulse(impulse) => return self.put("angular_impulse", impulse),
        };
        if let Some(at) = at {
            self.put("point", point(at));
        }
    }
}

pub(super) fn null() -> String {
    "null".to_string()
}

/// A text in quotes.
pub(super) fn text(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

pub(super) fn list(items: impl IntoIterator<Item = impl Display>) -> String {
    let items: Vec<String> = items.into_iter().map(|item| item.to_string()).collect();
    format!("[{}]", items.join(", "))
}

/// A list with an item a line.
pub(super) fn lines(items: impl Iterator<Item = String>) -> String {
    let items: Vec<String> = items.collect();
    format!("[\n    {}\n  ]", items.join(",\n    "))
}

pub(super) fn point(v: Vec2) -> String {
    list([v.x, v.y])
}

pub(super) fn ratio(time_step: TimeStep) -> String {
    let (num, den) = time_step.seconds();
    format!("\"{num}/{den}\"")
}

pub(super) fn ticks(after: Option<u32>) -> String {
    after.map_or_else(null, |ticks| ticks.to_string())
}

pub(super) fn dampings(linear: Option<Damping>, angular: Option<Damping>) -> String {
    let text = |damping: Damping| match damping.strong_rate() {
        Some(rate) => Fields::of("rate", rate),
        None if damping == Damping::NONE => text("none"),
        None => Fields::of("kept_per_second", damping.kept()),
    };
    linear_angular(linear.map(text), angular.map(text))
}

pub(super) fn linear_angular(linear: Option<impl Display>, angular: Option<impl Display>) -> String {
    let mut object = Fields::default();
    if let Some(linear) = linear {
        object.put("linear", linear);
    }
    if let Some(angular) = angular {
        object.put("angular", angular);
    }
    object.line()
}

pub(super) fn locked(locks: Locks) -> String {
    list(locks.names().map(text))
}

/// The numbers of the bits that are set.
pub(super) fn bits(bits: u32) -> String {
    list((0..u32::BITS).filter(|group| bits >> group & 1 == 1))
}

pub(super) const fn kind_name(kind: BodyKind) -> &'static str {
    match kind {
        BodyKind::Static => "static",
        BodyKind::Kinematic => "kinematic",
        BodyKind::Dynamic => "dynamic",
    }
}

pub(super) fn hexadecimal(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(2 * bytes.len() + 2);
    let digit = |digit: u8| char::from(b"0123456789abcdef"[usize::from(digit)]);
    text.push('"');
    for byte in bytes {
        text.extend([digit(byte >> 4), digit(byte & 15)]);
    }
    text.push('"');
    text
}
