//! The page: what was recorded, and the program that plays it.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};
use umbra_physics::{Activity, BodyKind, PHYSICS_VERSION, Vec2};

use super::events::Event;
use super::recording::{Life, Look, Placed, Recording, Span};
use crate::text::markup;

/// The heading above a run.
pub(crate) struct Heading {
    pub(crate) title: String,
    pub(crate) about: String,
    /// The part of the plane to show at first, m; `None` for all bodies.
    pub(crate) view: Option<[Vec2; 2]>,
    /// True to show trails at first, unless there are too many.
    pub(crate) trails: bool,
}

const BODY: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");
/// The program of the page: six files, which share their names.
const PROGRAM: [&str; 6] = [
    include_str!("data.js"),
    include_str!("camera.js"),
    include_str!("draw.js"),
    include_str!("contacts.js"),
    include_str!("events.js"),
    include_str!("page.js"),
];
/// The security policy of the page: the browser runs what is in it, and fetches nothing.
const POLICY: &str =
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'";

pub(super) fn page(recording: Recording, heading: &Heading) -> String {
    let title = markup(&heading.title);
    let about = if heading.about.is_empty() {
        String::new()
    } else {
        format!("<details><summary>About</summary><p>{}</p></details>", markup(&heading.about))
    };
    let body = BODY.replace("{{about}}", &about).replace("{{title}}", &title);
    let thinned = recording.thinned();
    let (run, bytes) = contents(recording, heading, thinned);
    // Within a script a browser looks for the end tag alone, and JSON has `<` in texts only.
    let run = run.to_string().replace('<', "\\u003c");
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n<meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\">\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<meta name=\"color-scheme\" content=\"light dark\">\n<title>{title}</title>\n<style>\n{STYLE}</style></head>\n<body>\n{body}<script type=\"application/json\" id=\"run\">{run}</script>\n<script type=\"text/plain\" id=\"bytes\">{}</script>\n<script>\n\"use strict\";\n(() => {{\n{}}})();\n</script>\n</body></html>\n",
        STANDARD.encode(&bytes),
        PROGRAM.map(str::trim_end).join("\n\n") + "\n"
    )
}

impl Recording {
    /// The note on a run of which not all is kept.
    pub(super) fn thinned(&self) -> Option<String> {
        let mut parts = Vec::new();
        if self.stride > 1 {
            let ticks = self.last - self.start;
            let each = ordinal(self.stride);
            parts.push(format!("every {each} of {ticks} ticks is in the page: all would make it too large"));
        }
        for (untold, what) in self.events.untold.into_iter().zip(["events", "contacts and visits of sensors", "inputs"])
        {
            if untold > 0 {
                parts.push(format!("{untold} {what} more than are listed"));
            }
        }
        (!parts.is_empty()).then(|| parts.join("; "))
    }
}

fn ordinal(n: u64) -> String {
    let suffix = match (n % 10, n % 100) {
        (_, 11..=13) => "th",
        (1, _) => "st",
        (2, _) => "nd",
        (3, _) => "rd",
        _ => "th",
    };
    format!("{n}{suffix}")
}

/// The data that the program of the page reads: a value for what there is once, and bytes for each tick. The bytes are the hashes of the
/// frames then the tracks, and then the contacts of each frame.
fn contents(recording: Recording, heading: &Heading, thinned: Option<String>) -> (Value, Vec<u8>) {
    let mut bytes: Vec<u8> = recording.hashes.iter().flat_map(|hash| hash.to_le_bytes()).collect();
    let frames = recording.hashes.len();
    let shapes: Vec<Value> = recording.shapes.into_iter().map(|(_, drawn)| drawn).collect();
    let bodies: Vec<Value> = recording.lives.into_iter().map(|life| body(life, &mut bytes)).collect();
    let contacts = recording.contacts.map(|frames| {
        let mut offsets = vec![bytes.len()];
        for frame in frames {
            bytes.extend(frame);
            offsets.push(bytes.len());
        }
        offsets
    });
    let run = json!({
        "view": heading.view.map(|corners| corners.map(Vec2::to_f64)),
        "trails": heading.trails,
        "thinned": thinned,
        "made": format!("umbra-physics {}, physics version {PHYSICS_VERSION}", env!("CARGO_PKG_VERSION")),
        "integrator": recording.integrator,
        "start": recording.start,
        "last": recording.last,
        "stride": recording.stride,
        "frames": frames,
        "clock": recording.clock.iter().map(span).collect::<Vec<_>>(),
        "shapes": shapes,
        "bodies": bodies,
        "fields": recording.fields.iter().filter_map(placed).collect::<Vec<_>>(),
        "joints": recording.joints.iter().filter_map(placed).collect::<Vec<_>>(),
        "contacts": contacts,
        "events": recording.events.told.iter().map(event).collect::<Vec<_>>(),
    });
    (run, bytes)
}

/// A body, and its track behind the bytes.
fn body(life: Life, bytes: &mut Vec<u8>) -> Value {
    let (slot, generation) = life.id.parts();
    let looks: Vec<Value> = life.looks.iter().map(|(tick, l)| look(*tick, l)).collect();
    let (offset, count) = (bytes.len(), life.track.count());
    bytes.extend(life.track.finish());
    json!([slot, generation, life.name, life.from, life.to, life.first, count, offset, looks, life.jumps])
}

/// Whole numbers of 64 bits are texts: a script's numbers have 53.
fn look(tick: u64, look: &Look) -> Value {
    let kind = match look.kind {
        BodyKind::Dynamic => 0,
        BodyKind::Kinematic => 1,
        BodyKind::Static => 2,
    };
    let activity = match look.activity {
        Activity::Awake => 0,
        Activity::Asleep => 1,
        Activity::Quarantined => 2,
        Activity::Disabled => 3,
    };
    json!([tick, kind, activity, look.shape, look.key.to_string(), look.mass.map(|mass| mass.to_string())])
}

fn span(span: &Span) -> Value {
    let (num, den) = span.step.seconds();
    json!([span.tick, span.time.0.to_string(), span.time.1.to_string(), num, den])
}

/// A force field or a joint, with its first and its last tick.
fn placed(placed: &Placed) -> Option<Value> {
    placed.drawing.as_ref().map(|drawing| json!([placed.from, placed.to, drawing]))
}

fn event(event: &Event) -> Value {
    let Event { tick, until, times, what, text, bodies, count } = event;
    json!([tick, until, what.name(), text, bodies, count, times])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ordinals_are_english() {
        assert_eq!([1, 2, 3, 4, 12, 32, 512, 1024].map(ordinal).join(" "), "1st 2nd 3rd 4th 12th 32nd 512th 1024th");
    }
}
