//! The handles of one run in another.

use std::collections::BTreeMap;
use umbra_physics::{BodyId, Command, Created, FieldId};

/// A map from the bodies and force fields of one run to those of another.
///
/// A handle says how often its slot was taken before, so that none ever names two bodies, and a body that is gone still has
/// its counterpart, gone as well.
///
/// ```
/// use umbra_oracles::Handles;
/// use umbra_physics::{BodyId, Command, FieldId};
///
/// // No body of the one run has a counterpart in the other yet: what they are called there is nobody.
/// let handles = Handles::default();
/// let body = BodyId::from_parts(3, 0);
/// assert_ne!(handles.body(body), body);
/// assert_ne!(handles.field(FieldId::from_parts(0, 0)), FieldId::from_parts(0, 0));
/// assert_eq!(handles.command(&Command::Wake(body)), Command::Wake(handles.body(body)));
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Handles {
    bodies: BTreeMap<BodyId, BodyId>,
    fields: BTreeMap<FieldId, FieldId>,
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

    /// The command with these counterparts in place of what it names.
    #[must_use]
    pub fn command(&self, command: &Command) -> Command {
        let mut command = command.clone();
        match &mut command {
            Command::Apply { body, .. }
            | Command::SetPosition { body, .. }
            | Command::SetAngle { body, .. }
            | Command::SetVelocity { body, .. }
            | Command::SetAngularVelocity { body, .. }
            | Command::SetMass { body, .. }
            | Command::SetShape { body, .. }
            | Command::SetKind { body, .. }
            | Command::SetGravityScale { body, .. }
            | Command::SetBodyDamping { body, .. }
            | Command::SetGroups { body, .. }
            | Command::SetKey { body, .. }
            | Command::SetUserData { body, .. }
            | Command::SetLocks { body, .. }
            | Command::SetMaxSpeeds { body, .. }
            | Command::MoveTo { body, .. }
            | Command::RemoveBody(body)
            | Command::Wake(body)
            | Command::Release(body)
            | Command::Disable(body)
            | Command::Enable(body) => *body = self.body(*body),
            Command::AddField(field) => *field = field.map_bodies(|body| Some(self.body(body))).unwrap_or(*field),
            Command::SetField { id, field } => {
                *id = self.field(*id);
                *field = field.map_bodies(|body| Some(self.body(body))).unwrap_or(*field);
            }
            Command::RemoveField(id) => *id = self.field(*id),
            Command::AddBody(_)
            | Command::ClearForces
            | Command::SetTimeStep(_)
            | Command::SetGravity(_)
            | Command::SetIntegrator(_)
            | Command::SetDamping { .. }
            | Command::SetSleepAfter(_)
            | Command::SetRandom(_)
            | Command::SetBlob(_) => {}
            // All there are stand above: `tests/layers.rs` compares the lists.
            _ => {}
        }
        command
    }

    pub(super) fn knows(&self, body: BodyId) -> bool {
        self.bodies.contains_key(&body)
    }

    pub(super) fn knows_field(&self, field: FieldId) -> bool {
        self.fields.contains_key(&field)
    }

    /// Notes that what was made in one run is the counterpart of what was made in the other.
    pub(super) fn pair(&mut self, here: Created, there: Created) {
        match (here, there) {
            (Created::Body(here), Created::Body(there)) => _ = self.bodies.insert(here, there),
            (Created::ForceField(here), Created::ForceField(there)) => _ = self.fields.insert(here, there),
            _ => {}
        }
    }
}
