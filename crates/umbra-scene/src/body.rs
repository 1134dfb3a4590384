//! Reading bodies.

use alloc::string::String;
use alloc::vec::Vec;

use super::Tables;
use super::collider::{SceneCollider, collider};
use super::convert::convert_body;
use super::error::Refused;
use super::error::{Flaw, Place};
use super::node::{Kind, Node, Result};
use super::object::Object;
use umbra_physics::{BodyDef, BodyKind, ColliderId, Damping, Error, Fx, Locks, Mass, Quantity, Scalar, Vec2};

/// A body of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneBody {
    /// The name. No other body of the scene has it.
    pub name: String,
    /// The definition, without the colliders.
    pub def: BodyDef,
    /// All colliders. Those that inputs add come last.
    pub colliders: Vec<SceneCollider>,
    /// The number of colliders that the body is added with.
    pub starting_colliders: usize,
    /// The place in the text.
    pub place: Place,
}

impl SceneBody {
    /// The definition for a scalar, with the colliders that the body is added with.
    ///
    /// # Errors
    /// As the constructors of [`Shape`](umbra_physics::Shape): a polygon may have no area left in a coarser scalar.
    pub fn def<S: Scalar>(&self) -> core::result::Result<BodyDef<S>, Error> {
        let colliders = self.colliders.iter().take(self.starting_colliders).map(SceneCollider::def);
        let colliders = colliders.collect::<core::result::Result<_, _>>()?;
        Ok(BodyDef { colliders, ..convert_body(&self.def)? })
    }
}

/// The fields of a body in which a quantity of it can be wrong.
const fn fields_of(error: &Error) -> &'static [&'static str] {
    match error {
        Error::OutOfRange { quantity } => match quantity {
            Quantity::Position => &["position"],
            Quantity::Angle => &["angle"],
            Quantity::Velocity => &["velocity"],
            Quantity::AngularVelocity => &["angular_velocity"],
            Quantity::Mass { .. } => &["mass", "colliders"],
            Quantity::Inertia { .. } => &["inertia"],
            Quantity::GravityScale => &["gravity_scale"],
            Quantity::Damping => &["damping"],
            Quantity::MaxSpeed | Quantity::MaxAngularSpeed => &["max_speeds"],
            _ => &[],
        },
        Error::Locked { quantity: Quantity::AngularVelocity } => &["angular_velocity"],
        Error::Locked { .. } => &["velocity"],
        Error::DampingHasNoInverse => &["damping"],
        _ => &[],
    }
}

/// Puts an error of the engine's at the field that it is about.
pub(super) fn blame(object: &Object<'_>, error: Error) -> Refused {
    object.at(fields_of(&error)).fault(error)
}

/// Reads a body. It is left to the caller to make its definition, and to refuse what the world would.
///
/// The body will have this index.
pub(super) fn body(object: &Object<'_>, index: usize, tables: &mut Tables) -> Result<SceneBody> {
    let name = object.need("name", Node::string);
    let kind = object.or("kind", BodyKind::Dynamic, kind);
    let (linear_damping, angular_damping) = object.or("damping", (None, None), own_damping);
    let (max_speed, max_angular_speed) = object.or("max_speeds", (None, None), max_speeds);
    let def = BodyDef {
        kind,
        position: object.or("position", Vec2::ZERO, Node::point),
        angle: object.or("angle", Fx::ZERO, Node::number),
        velocity: object.or("velocity", Vec2::ZERO, Node::point),
        angular_velocity: object.or("angular_velocity", Fx::ZERO, Node::number),
        colliders: Vec::new(),
        mass: mass(object).ok().flatten().unwrap_or_default(),
        gravity_scale: object.or("gravity_scale", Fx::ONE, Node::number),
        linear_damping,
        angular_damping,
        max_speed,
        max_angular_speed,
        locks: object.or("locks", Locks::NONE, locks),
        dominance: object.or("dominance", 0, Node::whole),
        bullet: object.or("bullet", false, Node::boolean),
        force_groups: object.or("force_groups", 1, force_groups),
        key: object.or("key", 0, Node::whole),
        user_data: object.or("user_data", 0, Node::whole),
    };
    let mut colliders = Vec::new();
    object.or("colliders", (), |list| {
        list.each(|node| {
            let symbol = ColliderId::from_parts(index as u32, colliders.len() as u32);
            colliders.push(collider(&node.object()?, symbol, tables)?);
            Ok(())
        })
    });
    object.finish()?;
    if kind == BodyKind::Static && (def.velocity != Vec2::ZERO || def.angular_velocity != Fx::ZERO) {
        return Err(object.at(&["velocity", "angular_velocity"]).fault("a static body has no velocity"));
    }
    let starting_colliders = colliders.len();
    Ok(SceneBody { name: name?, def, colliders, starting_colliders, place: object.node.place() })
}

pub(super) fn kind(node: &Node<'_>) -> Result<BodyKind> {
    node.choice(&[("static", BodyKind::Static), ("kinematic", BodyKind::Kinematic), ("dynamic", BodyKind::Dynamic)])
}

/// The mass that is given by `mass` and `inertia`. A `mass` may be the text `from_colliders`.
pub(super) fn mass(object: &Object<'_>) -> Result<Option<Mass>> {
    match (object.get("mass"), object.get("inertia")) {
        (None, Some(inertia)) => Err(inertia.fault("an `inertia` needs a `mass` beside it")),
        (Some(mass), Some(inertia)) => {
            let (mass, inertia) = (mass.number(), inertia.number());
            Ok(Some(Mass::Explicit { mass: mass?, inertia: inertia? }))
        }
        (Some(mass), None) if mass.kind() == Kind::Text => {
            mass.choice(&[("from_colliders", Mass::FromColliders)]).map(Some)
        }
        (Some(mass), None) => Ok(Some(Mass::Kilograms(mass.number()?))),
        (None, None) => Ok(None),
    }
}

/// {linear, angular}, both of which may be left out.
pub(super) fn own_damping(node: &Node<'_>) -> Result<(Option<Damping>, Option<Damping>)> {
    if node.kind() != Kind::Object {
        return Err(
            node.wrong_kind(r#"dampings such as {"linear": {"rate": 0.1}, "angular": {"kept_per_second": 0.9}}"#)
        );
    }
    let object = node.object()?;
    let damping_of = |name| object.or(name, None, |node| damping(node).map(Some));
    let dampings = (damping_of("linear"), damping_of("angular"));
    object.finish()?;
    Ok(dampings)
}

/// {linear, angular}, both of which may be left out.
pub(super) fn max_speeds(node: &Node<'_>) -> Result<(Option<Fx>, Option<Fx>)> {
    let object = node.object()?;
    let limit_of = |name| object.or(name, None, |node| node.number().map(Some));
    let speeds = (limit_of("linear"), limit_of("angular"));
    object.finish()?;
    Ok(speeds)
}

/// {kept_per_second}, {rate}, or "none". A number by itself would be read as the one or as the other.
fn damping(node: &Node<'_>) -> Result<Damping> {
    match node.kind() {
        Kind::Object => {
            let object = node.object()?;
            let (name, number) = object.one_of(&["kept_per_second", "rate"])?;
            let make = if name == "rate" { Damping::rate } else { Damping::kept_per_second };
            let damping = make(number.number()?);
            object.finish()?;
            if (Fx::ZERO..=Fx::ONE).contains(&damping.kept()) {
                return Ok(damping);
            }
            Err(number.fault(Error::OutOfRange { quantity: Quantity::Damping }))
        }
        Kind::Text => node.choice(&[("none", Damping::NONE)]),
        _ => Err(node.wrong_kind(
            r#"a damping: {"rate": 0.1} in 1/s as in Box2D and Rapier, {"kept_per_second": 0.9} for the share of a velocity that is left after a second, or "none""#,
        )),
    }
}

/// A degree of freedom that can be locked.
type Axis = fn(&mut Locks) -> &mut bool;

const AXES: [(&str, Axis); 3] =
    [("x", |locks| &mut locks.x), ("y", |locks| &mut locks.y), ("rotation", |locks| &mut locks.rotation)];

/// A list of axes.
pub(super) fn locks(node: &Node<'_>) -> Result<Locks> {
    let mut locks = Locks::NONE;
    node.each(|node| {
        let axis = node.choice(&AXES)?;
        *axis(&mut locks) = true;
        Ok(())
    })?;
    Ok(locks)
}

/// A list of group numbers from 0 to 31.
pub(super) fn force_groups(node: &Node<'_>) -> Result<u32> {
    bits(node, "group")
}

/// A list of numbers from 0 to 31 as bits.
pub(super) fn bits(node: &Node<'_>, what: &str) -> Result<u32> {
    let mut bits = 0;
    node.each(|node| {
        let bit: i64 = node.whole()?;
        if !(0..32).contains(&bit) {
            return Err(node.fault(Flaw::OutOfRange.of(format_args!("out of range: expected a {what} from 0 to 31"))));
        }
        bits |= 1 << bit;
        Ok(())
    })?;
    Ok(bits)
}
