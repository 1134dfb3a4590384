//! Names of bodies and force fields, for people who read a replay.

use alloc::collections::BTreeMap;
use alloc::string::{String, ToString};
use alloc::vec::Vec;

use crate::codec::{self, Encoder, Malformed, Part, Read, Reader, Write};
use crate::replay::diff::Difference;
use crate::replay::snapshot::Owner;
use crate::slots::{BodyId, FieldId};
use crate::world::World;

/// Names of the bodies and force fields of a recorded run. They are kept in the replay for people to read and change no result: neither
/// the motion nor a hash depends on them. Differences of replays, `umbra diff`, `umbra verify` and `umbra view` use them.
///
/// A name has 1 to 256 bytes and no control characters. Two bodies may have the same one.
///
/// ```
/// use umbra_physics::{BodyDef, Inputs, Labels, RecordOptions, Recorder, Replay, World, WorldDef};
///
/// let mut world: World = World::new(WorldDef::default())?;
/// let ball = world.add_body(BodyDef::dynamic())?;
/// let mut recorder = Recorder::new(&world, RecordOptions::default());
/// recorder.labels_mut().set_body(ball, "ball");
/// recorder.step(&mut world, &Inputs::new());
///
/// let replay = Replay::from_bytes(&recorder.finish(&world), &[])?;
/// let labels: &Labels = replay.labels();
/// assert_eq!(labels.body(ball), Some("ball"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Labels {
    bodies: BTreeMap<BodyId, String>,
    fields: BTreeMap<FieldId, String>,
}

/// The fewest bytes of an entry: a handle, the length of a name, and a letter.
const LEAST_BYTES: usize = 13;

impl Labels {
    /// The most bytes of a name: 256.
    pub const BYTES: usize = 256;

    /// Makes a list without names.
    #[must_use]
    pub const fn new() -> Self {
        Self { bodies: BTreeMap::new(), fields: BTreeMap::new() }
    }

    /// Gives a body a name, in place of one that it had. Control characters are left out, and a name that would be longer than
    /// [`BYTES`](Self::BYTES) ends before; an empty one is none.
    pub fn set_body(&mut self, body: BodyId, name: &str) {
        set(&mut self.bodies, body, name);
    }

    /// Gives a force field a name, as [`set_body`](Self::set_body) does for a body.
    ///
    /// ```
    /// use umbra_physics::{FieldId, Labels};
    ///
    /// let (mut labels, wind) = (Labels::new(), FieldId::from_parts(0, 0));
    /// labels.set_field(wind, "wind\n");
    /// assert_eq!((labels.field(wind), labels.is_empty()), (Some("wind"), false));
    /// labels.set_field(wind, "");
    /// assert!(labels.is_empty());
    /// let long = "x".repeat(2 * Labels::BYTES);
    /// labels.set_field(wind, &long);
    /// assert_eq!(labels.field(wind).map(str::len), Some(Labels::BYTES));
    /// ```
    pub fn set_field(&mut self, field: FieldId, name: &str) {
        set(&mut self.fields, field, name);
    }

    /// The name of a body.
    #[must_use]
    pub fn body(&self, body: BodyId) -> Option<&str> {
        self.bodies.get(&body).map(String::as_str)
    }

    /// The name of a force field.
    #[must_use]
    pub fn field(&self, field: FieldId) -> Option<&str> {
        self.fields.get(&field).map(String::as_str)
    }

    /// Says whether nothing has a name.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.bodies.is_empty() && self.fields.is_empty()
    }

    /// Adds to a difference the name of the body or force field that it is of, and the key that the body has in this world.
    pub(super) fn name(&self, difference: Difference, world: &World) -> Difference {
        let (name, key) = match difference.owner {
            Owner::Body(body) => (self.body(body), world.body(body).map_or(0, |body| body.key())),
            Owner::ForceField(field) => (self.field(field), 0),
            Owner::World => (None, 0),
        };
        let key = if difference.key == 0 { key } else { difference.key };
        Difference { name: difference.name.or_else(|| name.map(ToString::to_string)), key, ..difference }
    }
}

fn set<H: Ord>(names: &mut BTreeMap<H, String>, handle: H, name: &str) {
    let mut kept = String::new();
    for letter in name.chars().filter(|letter| !letter.is_control()) {
        if kept.len() + letter.len_utf8() > Labels::BYTES {
            break;
        }
        kept.push(letter);
    }
    if kept.is_empty() {
        names.remove(&handle);
    } else {
        names.insert(handle, kept);
    }
}

impl Write for Labels {
    fn write(&self, out: &mut impl Encoder) {
        write_names(out, "bodies", &self.bodies);
        write_names(out, "fields", &self.fields);
    }
}

fn write_names<H: Write>(out: &mut impl Encoder, part: &'static str, names: &BTreeMap<H, String>) {
    out.enter(Part::Name(part));
    codec::count(out, names.len());
    for (i, (handle, name)) in (0..).zip(names) {
        out.enter(Part::Entry(i));
        codec::field(out, "id", handle);
        out.enter(Part::Name("name"));
        codec::count(out, name.len());
        out.leaf(name.as_bytes(), name);
        out.leave();
        out.leave();
    }
    out.leave();
}

impl Read for Labels {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        let malformed = reader.malformed("one name at least");
        let labels = Self { bodies: read_names(reader)?, fields: read_names(reader)? };
        // Without names there is no chunk: each file has one form.
        if labels.is_empty() { Err(malformed) } else { Ok(labels) }
    }
}

fn read_names<H: Ord + Copy + Read>(reader: &mut Reader<'_>) -> Result<BTreeMap<H, String>, Malformed> {
    let mut names = BTreeMap::new();
    for _ in 0..reader.count(LEAST_BYTES)? {
        let malformed = reader.malformed("names by their handles, in ascending order");
        let handle = H::read(reader)?;
        if names.last_key_value().is_some_and(|(last, _)| *last >= handle) {
            return Err(malformed);
        }
        let malformed = reader.malformed("a name of 1 to 256 bytes of UTF-8 without control characters");
        let name = String::from_utf8(Vec::read(reader)?);
        let is_name = |name: &String| (1..=Labels::BYTES).contains(&name.len()) && !name.contains(char::is_control);
        names.insert(handle, name.ok().filter(is_name).ok_or(malformed)?);
    }
    Ok(names)
}
