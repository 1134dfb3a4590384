//! Commands of a scene for a world: another scalar, and the world's handles in place of indices.

use super::field::convert_factor;
use super::shape::{ShapeDef, vector};
use umbra_physics::{
    BodyDef, BodyId, Command, CommandMap, Error, FieldId, ForceField, Fx, FxFactor, Scalar, Shape, Vec2,
};

/// Converts a command.
pub(super) fn convert_command<S: Scalar>(
    command: &Command,
    bodies: &impl Fn(BodyId) -> Result<BodyId, Error>,
    fields: &impl Fn(FieldId) -> Result<FieldId, Error>,
) -> Result<Command<S>, Error> {
    command.clone().map(&mut Convert { bodies, fields })
}

/// Converts a force field; the error names the index of a body that is not there.
pub(super) fn convert_field<S: Scalar>(
    field: &ForceField,
    bodies: &impl Fn(BodyId) -> Result<BodyId, Error>,
) -> Result<ForceField<S>, Error> {
    Convert { bodies, fields: &|field| Err(Error::NoSuchField { field }) }.force_field(*field)
}

/// Converts the definition of a body without a shape.
pub(super) fn convert_body<S: Scalar>(def: &BodyDef) -> Result<BodyDef<S>, Error> {
    let (bodies, fields) = (&|body| Err(Error::NoSuchBody { body }), &|field| Err(Error::NoSuchField { field }));
    Convert { bodies, fields }.body_def(BodyDef { shape: None, ..def.clone() })
}

struct Convert<'a, B, F> {
    bodies: &'a B,
    fields: &'a F,
}

impl<S: Scalar, B, F> CommandMap<Fx, S> for Convert<'_, B, F>
where
    B: Fn(BodyId) -> Result<BodyId, Error>,
    F: Fn(FieldId) -> Result<FieldId, Error>,
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
}
