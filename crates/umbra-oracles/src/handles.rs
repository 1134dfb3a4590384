//! The handles of one run in another.

use std::collections::BTreeMap;
use std::convert::Infallible;

use umbra_physics::{BodyId, ColliderId, Command, CommandMap, Created, FieldId, Fx, FxFactor, JointId, Shape, World};

/// A map from the bodies, force fields, colliders and joints of one run to those of another.
///
/// A handle says how often its slot was taken before, so that none ever names two bodies, and a body that is gone still has
/// its counterpart, gone as well.
///
/// ```
/// use umbra_oracles::Handles;
/// use umbra_physics::{BodyId, ColliderId, Command, FieldId, JointId};
///
/// // No body of the one run has a counterpart in the other yet: what they are called there is nobody.
/// let handles = Handles::default();
/// let body = BodyId::from_parts(3, 0);
/// assert_ne!(handles.body(body), body);
/// assert_ne!(handles.field(FieldId::from_parts(0, 0)), FieldId::from_parts(0, 0));
/// assert_ne!(handles.collider(ColliderId::from_parts(0, 0)), ColliderId::from_parts(0, 0));
/// assert_ne!(handles.joint(JointId::from_parts(0, 0)), JointId::from_parts(0, 0));
/// assert_eq!(handles.command(&Command::Wake(body)), Command::Wake(handles.body(body)));
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Handles {
    bodies: BTreeMap<BodyId, BodyId>,
    fields: BTreeMap<FieldId, FieldId>,
    colliders: BTreeMap<ColliderId, ColliderId>,
    joints: BTreeMap<JointId, JointId>,
}

/// Slots from here on are never taken: a world has room for 2^24 of each.
const NOBODY: u32 = 1 << 31;

impl Handles {
    /// The counterpart of a body; of one that has none a handle that names no body there, ever.
    #[must_use]
    pub fn body(&self, body: BodyId) -> BodyId {
        let nobody = |(slot, generation)| BodyId::from_parts(slot | NOBODY, generation);
        self.bodies.get(&body).copied().unwrap_or_else(|| nobody(body.parts()))
    }

    /// The counterpart of a force field; of one that has none a handle that names no field there, ever.
    #[must_use]
    pub fn field(&self, field: FieldId) -> FieldId {
        let nothing = |(slot, generation)| FieldId::from_parts(slot | NOBODY, generation);
        self.fields.get(&field).copied().unwrap_or_else(|| nothing(field.parts()))
    }

    /// The counterpart of a collider; of one that has none a handle that names no collider there, ever.
    #[must_use]
    pub fn collider(&self, collider: ColliderId) -> ColliderId {
        let nothing = |(slot, generation)| ColliderId::from_parts(slot | NOBODY, generation);
        self.colliders.get(&collider).copied().unwrap_or_else(|| nothing(collider.parts()))
    }

    /// The counterpart of a joint; of one that has none a handle that names no joint there, ever.
    #[must_use]
    pub fn joint(&self, joint: JointId) -> JointId {
        let nothing = |(slot, generation)| JointId::from_parts(slot | NOBODY, generation);
        self.joints.get(&joint).copied().unwrap_or_else(|| nothing(joint.parts()))
    }

    /// The command with these counterparts in place of what it names.
    #[must_use]
    pub fn command(&self, command: &Command) -> Command {
        rename(
            command,
            |body| self.body(body),
            |field| self.field(field),
            |collider| self.collider(collider),
            |joint| self.joint(joint),
        )
    }

    pub(super) fn knows(&self, body: BodyId) -> bool {
        self.bodies.contains_key(&body)
    }

    pub(super) fn knows_field(&self, field: FieldId) -> bool {
        self.fields.contains_key(&field)
    }

    pub(super) fn knows_collider(&self, collider: ColliderId) -> bool {
        self.colliders.contains_key(&collider)
    }

    pub(super) fn knows_joint(&self, joint: JointId) -> bool {
        self.joints.contains_key(&joint)
    }

    /// Notes that what was made in one run is the counterpart of what was made in the other.
    pub(super) fn pair(&mut self, first: Created, second: Created) {
        match (first, second) {
            (Created::Body(body), Created::Body(twin)) => _ = self.bodies.insert(body, twin),
            (Created::ForceField(field), Created::ForceField(twin)) => _ = self.fields.insert(field, twin),
            (Created::Collider(collider), Created::Collider(twin)) => _ = self.colliders.insert(collider, twin),
            (Created::Joint(joint), Created::Joint(twin)) => _ = self.joints.insert(joint, twin),
            _ => {}
        }
    }
}

/// Returns what a command made in a world: a body is followed by the colliders that it was added with, in the order of its definition.
pub(super) fn all_made(world: &World, created: Created) -> Vec<Created> {
    let body = if let Created::Body(body) = created { Some(body) } else { None };
    let colliders = body.and_then(|body| world.colliders_of(body).ok()).into_iter().flatten();
    let object = if created == Created::Nothing { None } else { Some(created) };
    object.into_iter().chain(colliders.map(Created::Collider)).collect()
}

/// Returns the command with other handles in place of those that it names.
///
/// ```
/// use umbra_oracles::rename;
/// use umbra_physics::{BodyId, Command};
///
/// let [old, new] = [0, 7].map(|slot| BodyId::from_parts(slot, 0));
/// assert_eq!(rename(&Command::Wake(old), |_| new, |field| field, |collider| collider, |joint| joint), Command::Wake(new));
/// ```
#[must_use]
pub fn rename(
    command: &Command,
    body: impl FnMut(BodyId) -> BodyId,
    field: impl FnMut(FieldId) -> FieldId,
    collider: impl FnMut(ColliderId) -> ColliderId,
    joint: impl FnMut(JointId) -> JointId,
) -> Command {
    let Ok(renamed) = command.clone().map(&mut Rename { body, field, collider, joint });
    renamed
}

/// Replaces handles.
struct Rename<B, F, C, J> {
    body: B,
    field: F,
    collider: C,
    joint: J,
}

impl<B, F, C, J> CommandMap<Fx> for Rename<B, F, C, J>
where
    B: FnMut(BodyId) -> BodyId,
    F: FnMut(FieldId) -> FieldId,
    C: FnMut(ColliderId) -> ColliderId,
    J: FnMut(JointId) -> JointId,
{
    type Error = Infallible;

    fn scalar(&mut self, value: Fx) -> Result<Fx, Infallible> {
        Ok(value)
    }

    fn factor(&mut self, value: FxFactor) -> Result<FxFactor, Infallible> {
        Ok(value)
    }

    fn shape(&mut self, shape: Shape) -> Result<Shape, Infallible> {
        Ok(shape)
    }

    fn body(&mut self, body: BodyId) -> Result<BodyId, Infallible> {
        Ok((self.body)(body))
    }

    fn field(&mut self, field: FieldId) -> Result<FieldId, Infallible> {
        Ok((self.field)(field))
    }

    fn collider(&mut self, collider: ColliderId) -> Result<ColliderId, Infallible> {
        Ok((self.collider)(collider))
    }

    fn joint(&mut self, joint: JointId) -> Result<JointId, Infallible> {
        Ok((self.joint)(joint))
    }
}
