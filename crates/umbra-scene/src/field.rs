//! Reading force fields. The slot of a handle in them is an index in the scene's list of bodies.

use alloc::collections::BTreeMap;
use alloc::string::{String, ToString};

use super::body::force_groups;
use super::error::{Coded, Flaw, Place};
use super::node::{Kind, Node, Object, Result, quoted};
use umbra_physics::{
    Attachment, BodyId, End, Error, FieldKind, ForceField, Fx, FxFactor, Quantity, Region, Scalar, SpringConstants,
    Vec2, scalar::Factor,
};

/// A force field of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneField {
    /// The name, if inputs are to change it.
    pub name: Option<String>,
    /// The field. Its handles are indices in [`Scene::bodies`](super::Scene::bodies).
    pub field: ForceField,
    /// The place in the text.
    pub place: Place,
}

/// Names of bodies or of fields, with their indices.
pub(super) type Names = BTreeMap<String, usize>;

/// The handle that stands for a body of this index.
pub(super) const fn symbol(index: usize) -> BodyId {
    // They fit: few more than 2^17, or as many as a caller allows, a `u32`.
    BodyId::from_parts(index as u32, 0)
}

/// The index of the body that a text names.
pub(super) fn named(node: &Node<'_>, names: &Names, what: &str) -> Result<usize> {
    let name = node.string()?;
    let missing = || node.fault(Flaw::NoSuchName.of(format_args!("there is no {what} {}", quoted(&name))));
    names.get(&name).copied().ok_or_else(missing)
}

/// Reads a force field.
pub(super) fn field(object: &Object<'_>, names: &Names) -> Result<SceneField> {
    let name = object.get("name").map(Node::string).transpose()?;
    let force_groups = object.or("force_groups", u32::MAX, force_groups)?;
    let (kind, inner) = object.one_of(&["attractor", "spring", "drag", "thrust", "zone"])?;
    object.finish()?;
    let kind = match kind {
        "attractor" => attractor(&inner.object()?, names)?,
        "spring" => spring(&inner.object()?, names)?,
        "drag" => drag(&inner.object()?)?,
        "thrust" => {
            let object = inner.object()?;
            let at = attachment(object.need("at")?, names)?;
            let kind = FieldKind::Thrust { at, force: object.need("force")?.point()? };
            object.finish()?;
            kind
        }
        _ => zone(&inner.object()?)?,
    };
    Ok(SceneField { name, field: ForceField { kind, force_groups }, place: inner.place() })
}

/// Puts an error of the engine's at the field of the law that it is about.
pub(super) fn blame(object: &Object<'_>, error: Error) -> super::SceneError {
    let law = object.at(&["attractor", "spring", "drag", "thrust", "zone"]);
    let fields: &[&str] = match error {
        Error::OutOfRange { quantity } => match quantity {
            Quantity::Position => &["at", "from", "disc", "box"],
            Quantity::Velocity => &["wind"],
            Quantity::Gravity => &["acceleration"],
            Quantity::Mu => &["mu"],
            Quantity::Softening => &["softening"],
            Quantity::Stiffness => &["stiffness"],
            Quantity::Drag => &["damping", "linear", "quadratic"],
            Quantity::RestLength => &["rest"],
            Quantity::Force => &["force"],
            _ => &[],
        },
        Error::SameBody { .. } => &["to"],
        Error::NotDynamic { .. } => &["at", "to"],
        _ => &[],
    };
    let message = match error {
        Error::SameBody { .. } => "both ends are attached to the same body",
        Error::NotDynamic { .. } => "a spring or thrust needs a dynamic body",
        _ => return law.object().map_or_else(|fault| fault, |law| law.at(fields).fault(error)),
    };
    law.object().map_or_else(|fault| fault, |law| law.at(fields).fault(Coded(error.code(), message)))
}

fn attractor(object: &Object<'_>, names: &Names) -> Result<FieldKind> {
    let mu = object.need("mu")?;
    let law = FieldKind::Attractor {
        centre: end(object.need("at")?, names)?,
        mu: factor(mu)?,
        softening: object.or("softening", Fx::ZERO, Node::number)?,
    };
    object.finish()?;
    Ok(law)
}

/// A number of at least zero with 64 significant bits.
fn factor(node: &Node<'_>) -> Result<FxFactor> {
    if node.kind() != Kind::Number {
        return Ok(FxFactor::from_scalar(node.number()?));
    }
    let out_of_range = |_| node.fault(Error::OutOfRange { quantity: Quantity::Mu });
    FxFactor::parse(node.raw()).map_err(out_of_range)
}

/// The text that is read as this factor. The one that is nearest to 10^-60 lies below it, where nothing is read.
pub(super) fn factor_text(factor: FxFactor) -> String {
    const LEAST: &str = "1e-60";
    if FxFactor::parse(LEAST) == Ok(factor) { LEAST.into() } else { factor.to_string() }
}

fn spring(object: &Object<'_>, names: &Names) -> Result<FieldKind> {
    let law = FieldKind::Spring {
        near: attachment(object.need("from")?, names)?,
        far: end(object.need("to")?, names)?,
        spring: SpringConstants {
            rest: object.or("rest", Fx::ZERO, Node::number)?,
            stiffness: not_negative(object.need("stiffness")?, Quantity::Stiffness)?,
            damping: object.or("damping", Fx::ZERO, |node| not_negative(node, Quantity::Drag))?,
        },
    };
    object.finish()?;
    Ok(law)
}

fn drag(object: &Object<'_>) -> Result<FieldKind> {
    let coefficient = |node: &Node<'_>| not_negative(node, Quantity::Drag);
    let law = FieldKind::Drag {
        linear: object.or("linear", Fx::ZERO, coefficient)?,
        quadratic: object.or("quadratic", Fx::ZERO, coefficient)?,
        wind: object.or("wind", Vec2::ZERO, Node::point)?,
    };
    object.finish()?;
    Ok(law)
}

fn not_negative(node: &Node<'_>, quantity: Quantity) -> Result<Fx> {
    let number = node.number()?;
    if number < Fx::ZERO { Err(node.fault(Error::OutOfRange { quantity })) } else { Ok(number) }
}

fn zone(object: &Object<'_>) -> Result<FieldKind> {
    let (kind, inner) = object.one_of(&["disc", "box"])?;
    let acceleration = object.need("acceleration")?.point()?;
    object.finish()?;
    let parts = inner.object()?;
    let region = if kind == "disc" {
        let (centre, radius) = (parts.need("centre")?.point()?, parts.need("radius")?);
        Region::Disc { centre, radius: not_negative(radius, Quantity::Position)? }
    } else {
        Region::Box { min: parts.need("min")?.point()?, max: parts.need("max")?.point()? }
    };
    parts.finish()?;
    Ok(FieldKind::Zone { region, acceleration })
}

/// "name", or {body, point}.
fn attachment(node: &Node<'_>, names: &Names) -> Result<Attachment> {
    if node.kind() == Kind::Text {
        return Ok(Attachment::centre(symbol(named(node, names, "body")?)));
    }
    let object = node.object()?;
    let body = symbol(named(object.need("body")?, names, "body")?);
    let point = object.or("point", Vec2::ZERO, Node::point)?;
    object.finish()?;
    Ok(Attachment { body, point })
}

/// A point of the world as [x, y], or a point of a body.
fn end(node: &Node<'_>, names: &Names) -> Result<End> {
    if node.kind() == Kind::List { node.point().map(End::World) } else { attachment(node, names).map(End::Body) }
}

/// Converts a factor to another scalar; a float is rounded to nearest.
pub(super) fn convert_factor<S: Scalar>(factor: FxFactor) -> S::Factor {
    let (mantissa, mut shift) = factor.parts();
    let mut value = S::Factor::from_ratio(mantissa, 1);
    while shift != 0 {
        let by = shift.clamp(-63, 63);
        let power = S::Factor::from_ratio(1 << by.unsigned_abs(), 1);
        value = if by > 0 { value.over(power) } else { value.times(power) };
        shift -= by;
    }
    value
}
