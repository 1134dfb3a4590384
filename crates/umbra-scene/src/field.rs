//! Reading force fields. The slot of a handle in them is an index in the scene's list of bodies.

use alloc::collections::BTreeMap;
use alloc::format;
use alloc::string::{String, ToString};

use super::body::force_groups;
use super::error::{Coded, Flaw, Place, Refused};
use super::hint;
use super::node::{Kind, Node, Result, quoted};
use super::object::Object;
use umbra_physics::{
    Attachment, BodyId, End, Error, FieldKind, ForceField, Fx, FxFactor, Quantity, Region, Scalar, SpringConstants,
    Vec2, limits, scalar::Factor,
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

/// Names of things of a kind, with their indices.
#[derive(Default)]
pub(super) struct Names {
    pub(super) indices: BTreeMap<String, usize>,
    /// True if there are more names, of entries that were refused: then a name that is not listed may exist all the same.
    pub(super) has_more: bool,
}

/// The index of what was refused and has a name. No list has so many entries.
pub(super) const REFUSED: usize = u32::MAX as usize;

/// The most bytes of a name, its indices filled in.
const NAME: usize = 256;

impl Names {
    /// Takes in the name of a thing of this kind; refuses one that is taken.
    pub(super) fn take(&mut self, name: &str, index: usize, node: &Node<'_>, kind: &str) -> Result<()> {
        if name.len() > NAME {
            return Err(node.fault(Flaw::Text.of(format_args!("a name has at most {NAME} bytes"))));
        }
        if self.indices.contains_key(name) {
            let name = quoted(name);
            return Err(
                node.fault(Flaw::Taken.of(format_args!("there is a {kind} {name} already: choose another name")))
            );
        }
        self.indices.insert(name.into(), index);
        Ok(())
    }

    /// Takes in the name of what was refused, so that a second error is not made of what refers to it. A name that is needed
    /// may be there under another field's name.
    pub(super) fn note_refused(&mut self, object: &Object<'_>, is_needed: bool) {
        match object.at(&["name"]).filled() {
            Ok(name) => _ = self.indices.entry(name).or_insert(REFUSED),
            // A body needs a name, and a name that cannot be read is one; without any, a field is not referred to.
            Err(_) => self.has_more |= is_needed || object.has("name"),
        }
    }
}

/// The handle that stands for a body of this index.
pub(super) const fn symbol(index: usize) -> BodyId {
    // They fit: few more than 2^17, or as many as a caller allows, a `u32`.
    BodyId::from_parts(index as u32, 0)
}

/// The index of the body that a text names.
pub(super) fn named(node: &Node<'_>, names: &Names, what: &str) -> Result<usize> {
    let name = node.string()?;
    if let Some(index) = names.indices.get(&name) {
        return Ok(*index);
    }
    if names.has_more {
        return Ok(REFUSED);
    }
    let meant = hint::nearest(&name, names.indices.keys().map(String::as_str));
    let meant = meant.map_or_else(String::new, |meant| format!(": did you mean {}?", quoted(meant)));
    Err(node.fault(Flaw::NoSuchName.of(format_args!("there is no {what} {}{meant}", quoted(&name)))))
}

/// The kinds of force fields.
const KINDS: [&str; 7] = ["attractor", "spring", "drag", "friction", "thrust", "zone", "buoyancy"];

/// Reads a force field.
pub(super) fn field(object: &Object<'_>, names: &Names) -> Result<SceneField> {
    let name = object.or("name", None, |node| node.string().map(Some));
    let force_groups = object.or("force_groups", u32::MAX, force_groups);
    let (kind, inner) = object.one_of(&KINDS)?;
    let kind = inner.object().and_then(|inner| match kind {
        "attractor" => attractor(&inner, names),
        "spring" => spring(&inner, names),
        "drag" => drag(&inner),
        "friction" => friction(&inner),
        "thrust" => thrust(&inner, names),
        "zone" => zone(&inner),
        _ => buoyancy(&inner),
    });
    object.finish()?;
    Ok(SceneField { name, field: ForceField { kind: kind?, force_groups }, place: inner.place() })
}

/// Puts an error of the engine's at the field of the law that it is about.
pub(super) fn blame(object: &Object<'_>, error: Error) -> Refused {
    let law = object.at(&KINDS);
    let fields: &[&str] = match error {
        Error::OutOfRange { quantity } => match quantity {
            Quantity::Position => &["at", "from", "disc", "box"],
            Quantity::Velocity => &["wind", "flow"],
            Quantity::Gravity => &["acceleration"],
            Quantity::Mu => &["mu"],
            Quantity::Softening => &["softening"],
            Quantity::Stiffness => &["stiffness"],
            Quantity::Drag => &["damping", "linear", "quadratic"],
            Quantity::Deceleration => &["deceleration", "angular_deceleration"],
            Quantity::RestLength => &["rest"],
            Quantity::Force => &["force"],
            Quantity::FluidBox => &["box"],
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
    let mu = object.need("mu", factor);
    let centre = object.need("at", |node| end(node, names));
    let softening = object.or("softening", Fx::ZERO, Node::number);
    object.finish()?;
    Ok(FieldKind::Attractor { centre: centre?, mu: mu?, softening })
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
    let start = object.need("from", |node| attachment(node, names));
    let end_point = object.need("to", |node| end(node, names));
    let rest = object.or("rest", Fx::ZERO, Node::number);
    let stiffness = object.need("stiffness", |node| not_negative(node, Quantity::Stiffness));
    let damping = object.or("damping", Fx::ZERO, |node| not_negative(node, Quantity::Drag));
    object.finish()?;
    Ok(FieldKind::Spring {
        near: start?,
        far: end_point?,
        spring: SpringConstants { rest, stiffness: stiffness?, damping },
    })
}

fn drag(object: &Object<'_>) -> Result<FieldKind> {
    let coefficient = |node: &Node<'_>| not_negative(node, Quantity::Drag);
    let law = FieldKind::Drag {
        linear: object.or("linear", Fx::ZERO, coefficient),
        quadratic: object.or("quadratic", Fx::ZERO, coefficient),
        wind: object.or("wind", Vec2::ZERO, Node::point),
    };
    object.finish()?;
    Ok(law)
}

fn friction(object: &Object<'_>) -> Result<FieldKind> {
    let law = FieldKind::Friction {
        deceleration: object.or("deceleration", Fx::ZERO, deceleration),
        angular_deceleration: object.or("angular_deceleration", Fx::ZERO, deceleration),
    };
    object.finish()?;
    Ok(law)
}

fn deceleration(node: &Node<'_>) -> Result<Fx> {
    let quantity = Quantity::Deceleration;
    let number = not_negative(node, quantity)?;
    if number > limits::GRAVITY { Err(node.fault(Error::OutOfRange { quantity })) } else { Ok(number) }
}

fn thrust(object: &Object<'_>, names: &Names) -> Result<FieldKind> {
    let at = object.need("at", |node| attachment(node, names));
    let force = object.need("force", Node::point);
    object.finish()?;
    Ok(FieldKind::Thrust { at: at?, force: force? })
}

fn not_negative(node: &Node<'_>, quantity: Quantity) -> Result<Fx> {
    let number = node.number()?;
    if number < Fx::ZERO { Err(node.fault(Error::OutOfRange { quantity })) } else { Ok(number) }
}

fn zone(object: &Object<'_>) -> Result<FieldKind> {
    let acceleration = object.need("acceleration", Node::point);
    let (kind, inner) = object.one_of(&["disc", "box"])?;
    let region = inner.object().and_then(|parts| region(kind, &parts));
    object.finish()?;
    Ok(FieldKind::Zone { region: region?, acceleration: acceleration? })
}

fn buoyancy(object: &Object<'_>) -> Result<FieldKind> {
    let corners = object.need("box", |node| corners(&node.object()?));
    let density =
        object.need("density", |node| not_negative(node, Quantity::ColliderDensity { value: node.number()? }));
    let drag = |node: &Node<'_>| not_negative(node, Quantity::Drag);
    let linear_drag = object.or("linear_drag", Fx::ZERO, drag);
    let angular_drag = object.or("angular_drag", Fx::ZERO, drag);
    let flow = object.or("flow", Vec2::ZERO, Node::point);
    object.finish()?;
    let (min, max) = corners?;
    Ok(FieldKind::Buoyancy { min, max, density: density?, linear_drag, angular_drag, flow })
}

fn region(kind: &str, parts: &Object<'_>) -> Result<Region> {
    if kind == "disc" {
        let centre = parts.need("centre", Node::point);
        let radius = parts.need("radius", |node| not_negative(node, Quantity::Position));
        parts.finish()?;
        return Ok(Region::Disc { centre: centre?, radius: radius? });
    }
    corners(parts).map(|(min, max)| Region::Box { min, max })
}

/// The least and the greatest corner of a box.
fn corners(parts: &Object<'_>) -> Result<(Vec2, Vec2)> {
    let (min, max) = (parts.need("min", Node::point), parts.need("max", Node::point));
    parts.finish()?;
    Ok((min?, max?))
}

/// "name", or {body, point}.
fn attachment(node: &Node<'_>, names: &Names) -> Result<Attachment> {
    if node.kind() == Kind::Text {
        return Ok(Attachment::centre(symbol(named(node, names, "body")?)));
    }
    attached(&node.object()?, names)
}

fn attached(object: &Object<'_>, names: &Names) -> Result<Attachment> {
    let body = object.need("body", |node| named(node, names, "body"));
    let point = object.or("point", Vec2::ZERO, Node::point);
    object.finish()?;
    Ok(Attachment { body: symbol(body?), point })
}

/// A point of the world as [x, y] or {x, y}, or a point of a body.
pub(super) fn end(node: &Node<'_>, names: &Names) -> Result<End> {
    match node.kind() {
        Kind::Text => attachment(node, names).map(End::Body),
        Kind::Object => {
            let object = node.object()?;
            let is_point = object.has("x") || object.has("y");
            if is_point { object.vector().map(End::World) } else { attached(&object, names).map(End::Body) }
        }
        Kind::List => node.point().map(End::World),
        _ => Err(node.wrong_kind("a point [x, y], the name of a body, or an object with a `body`")),
    }
}

/// Converts a factor to another scalar; a float is rounded to nearest.
pub(super) fn convert_factor<S: Scalar>(factor: FxFactor) -> S::Factor {
    let (mantissa, mut shift) = factor.parts();
    let mut value = S::Factor::from_ratio(mantissa, 1);
    while shift != 0 {
        let part = shift.clamp(-63, 63);
        let power = S::Factor::from_ratio(1 << part.unsigned_abs(), 1);
        value = if part > 0 { value.over(power) } else { value.times(power) };
        shift -= part;
    }
    value
}
