//! Names of bodies, force fields, colliders and joints, for people who read a replay.

use alloc::collections::BTreeMap;
use alloc::format;
use alloc::string::{String, ToString};
use alloc::vec::Vec;

use crate::codec::{self, Encoder, Malformed, Part, Read, Reader, Write};
use crate::replay::diff::Difference;
use crate::replay::snapshot::Owner;
use crate::slots::{BodyId, ColliderId, FieldId, JointId};
use crate::world::World;

/// Names of the bodies, force fields, colliders and joints of a recorded run. They are kept in the replay for people to read and change no
/// result: neither the motion nor a hash depends on them. Differences of replays, `umbra diff`, `umbra verify` and `umbra view` use them.
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
    colliders: BTreeMap<ColliderId, String>,
    joints: BTreeMap<JointId, String>,
}

/// The fewest bytes of an entry: a handle, the length of a name, and a letter.
const LEAST_BYTES: usize = 13;

impl Labels {
    /// The most bytes of a name: 256.
    pub const BYTES: usize = 256;

    /// Makes a list without names.
    #[must_use]
    pub const fn new() -> Self {
        Self { bodies: BTreeMap::new(), fields: BTreeMap::new(), colliders: BTreeMap::new(), joints: BTreeMap::new() }
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

    /// Gives a collider a name, as [`set_body`](Self::set_body) does for a body.
    pub fn set_collider(&mut self, collider: ColliderId, name: &str) {
        set(&mut self.colliders, collider, name);
    }

    /// Gives a joint a name, as [`set_body`](Self::set_body) does for a body.
    pub fn set_joint(&mut self, joint: JointId, name: &str) {
        set(&mut self.joints, joint, name);
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

    /// The name of a collider.
    #[must_use]
    pub fn collider(&self, collider: ColliderId) -> Option<&str> {
        self.colliders.get(&collider).map(String::as_str)
    }

    /// The name of a joint.
    #[must_use]
    pub fn joint(&self, joint: JointId) -> Option<&str> {
        self.joints.get(&joint).map(String::as_str)
    }

    /// The name of the owner of a value. A contact has the names of its two colliders if one of them has a name: `lid and
    /// collider 3`. The world has none.
    ///
    /// ```
    /// use umbra_physics::{ColliderId, JointId, Labels, Owner};
    ///
    /// let (mut labels, [lid, floor]) = (Labels::new(), [0, 3].map(|slot| ColliderId::from_parts(slot, 0)));
    /// labels.set_collider(lid, "lid");
    /// assert_eq!(labels.collider(lid), Some("lid"));
    /// assert_eq!(labels.owner(Owner::Collider(lid)).as_deref(), Some("lid"));
    /// assert_eq!(labels.owner(Owner::Contact(lid, floor)).as_deref(), Some("lid and collider 3"));
    /// assert_eq!(labels.owner(Owner::Collider(floor)), None);
    /// let hinge = JointId::from_parts(0, 0);
    /// labels.set_joint(hinge, "hinge");
    /// assert_eq!((labels.joint(hinge), labels.owner(Owner::Joint(hinge)).as_deref()), (Some("hinge"), Some("hinge")));
    /// ```
    #[must_use]
    pub fn owner(&self, owner: Owner) -> Option<String> {
        let name = match owner {
            Owner::World => None,
            Owner::Body(body) => self.body(body),
            Owner::ForceField(field) => self.field(field),
            Owner::Collider(collider) => self.collider(collider),
            Owner::Joint(joint) => self.joint(joint),
            Owner::Contact(first, second) => {
                let [a, b] = [first, second].map(|collider| self.collider(collider));
                a.or(b)?;
                let named =
                    |name: Option<&str>, collider: ColliderId| name.map_or(collider.to_string(), str::to_string);
                return Some(format!("{} and {}", named(a, first), named(b, second)));
            }
        };
        name.map(str::to_string)
    }

    /// Says whether nothing has a name.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        let Self { bodies, fields, colliders, joints } = self;
        bodies.is_empty() && fields.is_empty() && colliders.is_empty() && joints.is_empty()
    }

    /// Adds to a difference the name of its owner, and the key that the owner has in this world.
    pub(super) fn name(&self, difference: Difference, world: &World) -> Difference {
        let key = match difference.owner {
            Owner::Body(body) => world.body(body).map_or(0, |body| body.key()),
            Owner::Collider(collider) => world.collider(collider).map_or(0, |collider| collider.key),
            Owner::Joint(joint) => world.joint(joint).map_or(0, |joint| joint.key()),
            Owner::World | Owner::ForceField(_) | Owner::Contact(..) => 0,
        };
        let key = if difference.key == 0 { key } else { difference.key };
        Difference { name: difference.name.or_else(|| self.owner(difference.owner)), key, ..difference }
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
        write_names(out, "colliders", &self.colliders);
        write_names(out, "joints", &self.joints);
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
        let labels = Self {
            bodies: read_names(reader)?,
            fields: read_names(reader)?,
            colliders: read_names(reader)?,
            joints: read_names(reader)?,
        };
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
