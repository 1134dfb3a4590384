//! Commands of a scene for a world: another scalar, and the world's handles in place of indices.

use alloc::vec::Vec;

use super::field::convert_factor;
use super::shape::{ShapeDef, vector};
use umbra_physics::{
    BodyDef, BodyId, ColliderDef, ColliderId, Command, CommandMap, ContactSettings, Damping, Error, FieldId,
    ForceField, Fx, FxFactor, JointDef, JointId, Scalar, Shape, Vec2,
};

/// Converts a command.
pub(super) fn convert_command<S: Scalar>(
    command: &Command,
    bodies: &impl Fn(BodyId) -> Result<BodyId, Error>,
    fields: &impl Fn(FieldId) -> Result<FieldId, Error>,
    colliders: &impl Fn(ColliderId) -> Result<ColliderId, Error>,
    joints: &impl Fn(JointId) -> Result<JointId, Error>,
) -> Result<Command<S>, Error> {
    command.clone().map(&mut Convert { bodies, fields, colliders, joints })
}

/// Converts a force field; the error names the index of a body that is not there.
pub(super) fn convert_field<S: Scalar>(
    field: &ForceField,
    bodies: &impl Fn(BodyId) -> Result<BodyId, Error>,
) -> Result<ForceField<S>, Error> {
    Convert { bodies, fields: &no_field, colliders: &no_collider, joints: &no_joint }.force_field(*field)
}

/// Converts a joint; the error names the index of a body that is not there.
pub(super) fn convert_joint<S: Scalar>(
    def: &JointDef,
    bodies: &impl Fn(BodyId) -> Result<BodyId, Error>,
) -> Result<JointDef<S>, Error> {
    Convert { bodies, fields: &no_field, colliders: &no_collider, joints: &no_joint }.joint_def(*def)
}

/// Converts the definition of a body without its colliders.
pub(super) fn convert_body<S: Scalar>(def: &BodyDef) -> Result<BodyDef<S>, Error> {
    let def = BodyDef { colliders: Vec::new(), ..def.clone() };
    Convert { bodies: &no_body, fields: &no_field, colliders: &no_collider, joints: &no_joint }.body_def(def)
}

/// Converts the definition of a collider.
pub(super) fn convert_collider<S: Scalar>(def: &ColliderDef) -> Result<ColliderDef<S>, Error> {
    Convert { bodies: &no_body, fields: &no_field, colliders: &no_collider, joints: &no_joint }
        .collider_def(def.clone())
}

/// Converts a damping of the world.
pub(super) fn convert_damping<S: Scalar>(damping: Damping) -> Result<Damping<S>, Error> {
    Convert { bodies: &no_body, fields: &no_field, colliders: &no_collider, joints: &no_joint }.damping(damping)
}

/// Converts the settings of contacts.
pub(super) fn convert_contacts<S: Scalar>(contacts: &ContactSettings) -> Result<ContactSettings<S>, Error> {
    Convert { bodies: &no_body, fields: &no_field, colliders: &no_collider, joints: &no_joint }
        .contact_settings(*contacts)
}

const fn no_body(body: BodyId) -> Result<BodyId, Error> {
    Err(Error::NoSuchBody { body })
}

const fn no_field(field: FieldId) -> Result<FieldId, Error> {
    Err(Error::NoSuchField { field })
}

const fn no_collider(collider: ColliderId) -> Result<ColliderId, Error> {
    Err(Error::NoSuchCollider { collider })
}

const fn no_joint(joint: JointId) -> Result<JointId, Error> {
    Err(Error::NoSuchJoint { joint })
}

struct Convert<'a, B, F, C, J> {
    bodies: &'a B,
    fields: &'a F,
    colliders: &'a C,
    joints: &'a J,
}

impl<S: Scalar, B, F, C, J> CommandMap<Fx, S> for Convert<'_, B, F, C, J>
where
    B: Fn(BodyId) -> Result<BodyId, Error>,
    F: Fn(FieldId) -> Result<FieldId, Error>,
    C: Fn(ColliderId) -> Result<ColliderId, Error>,
    J: Fn(JointId) -> Result<JointId, Error>,
{
    type Error = Error;

    fn scalar(&mut self, value: Fx) -> Result<S, Error> {
        Ok(S::from_fx(value))
    }

    fn factor(&mut self, value: FxFactor) -> Result<S::Factor, Error> {
        Ok(convert_factor::<S>(value))
    }

    fn shape(&mut self, shape: Shape) -> Result<Shape<S>, Error> {
        ShapeDef::from(&shape).make()
    }

    fn vector(&mut self, v: Vec2) -> Result<Vec2<S>, Error> {
        Ok(vector(v))
    }

    fn body(&mut self, body: BodyId) -> Result<BodyId, Error> {
        (self.bodies)(body)
    }

    fn field(&mut self, field: FieldId) -> Result<FieldId, Error> {
        (self.fields)(field)
    }

    fn collider(&mut self, collider: ColliderId) -> Result<ColliderId, Error> {
        (self.colliders)(collider)
    }

    fn joint(&mut self, joint: JointId) -> Result<JointId, Error> {
        (self.joints)(joint)
    }
}
