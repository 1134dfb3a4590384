//! Reading joints. The slot of a handle in them is an index in the scene's list of bodies.

use alloc::string::String;

use super::error::{Coded, Place, Refused};
use super::field::{Names, end, named, symbol};
use super::node::{Kind, Node, Result};
use super::object::Object;
use umbra_physics::{
    BodyId, Distance, End, Error, Fx, Gear, JointDef, JointKind, JointLimits, JointMotor, JointSpring, Motor,
    PlanarMotor, PlanarSpring, Prismatic, Pulley, Quantity, Revolute, Vec2, Weld, Wheel, World,
};

/// A joint of a scene.
///
/// ```
/// use umbra_physics::{Fx, JointKind, JointLimits, fx};
/// use umbra_scene::{Scene, SceneJoint};
///
/// let scene = Scene::parse(r#"{"bodies": [{"name": "gate", "position": [1, 0]}], "joints": [
///     {"name": "hinge", "bodies": [null, "gate"], "point": [0, 0], "revolute": {"limits": [0, 1.5]}}]}"#)?;
/// let SceneJoint { name, def, .. } = &scene.joints[0];
/// let JointKind::Revolute(revolute) = def.kind else { unreachable!() };
/// assert_eq!(revolute.limits, Some(JointLimits { lower: fx!(0), upper: fx!(1.5) }));
/// assert_eq!((name.as_deref(), scene.build::<Fx>()?.joint_count()), (Some("hinge"), 1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SceneJoint {
    /// The name, if inputs are to change it. No other joint of the scene has it.
    pub name: Option<String>,
    /// The definition. Its handles are indices in [`Scene::bodies`](super::Scene::bodies).
    pub def: JointDef,
    /// The place in the text.
    pub place: Place,
}

/// The world at the start, in which points of joints are found on bodies, and the handles of the scene's bodies in it.
pub(super) struct Start<'a> {
    pub(super) world: &'a World,
    pub(super) handles: &'a [BodyId],
}

/// The kinds of joints.
const KINDS: [&str; 8] = ["revolute", "weld", "distance", "prismatic", "wheel", "motor", "gear", "pulley"];

/// The points and the axis at which a joint is placed in the world.
#[derive(Clone, Copy)]
enum Placing {
    /// One point.
    At(Vec2),
    /// One point, and the direction of an axis.
    Along(Vec2, Vec2),
    /// A point of each body.
    Between(Vec2, Vec2),
    /// The centres of two bodies with these teeth.
    Geared([i16; 2]),
    /// A point of each of two bodies, and the points of the world and the strands of the rope between them.
    Roped([Vec2; 2], Pulley),
}

/// Reads a joint. Without a start its ends are needed in the axes of its bodies.
pub(super) fn joint(object: &Object<'_>, names: &Names, start: Option<&Start<'_>>) -> Result<SceneJoint> {
    let name = object.or("name", None, |node| node.string().map(Some));
    let flag = |name, otherwise| object.or(name, otherwise, Node::boolean);
    let [collide_connected, enabled, events] =
        [flag("collide_connected", object.has("pulley")), flag("enabled", true), flag("events", false)];
    let [break_force, break_torque] = ["break_force", "break_torque"].map(|name| object.or(name, None, break_force));
    let (key, user_data) = (object.or("key", 0, Node::whole), object.or("user_data", 0, Node::whole));
    // The teeth of gears fit as the bodies stand.
    let gear = object.has("gear").then(|| kind(object, None));
    let placed = placed(object, names, start, gear.as_ref());
    // A rod between two points, a rope, and a spring at rest, is as long as they are apart, unless it says so itself.
    let length = placed.as_ref().ok().and_then(|def| match def.kind {
        JointKind::Distance(Distance { limits: Some(limits), .. }) => Some(limits.upper),
        JointKind::Pulley(Pulley { length, .. }) => Some(length),
        _ => None,
    });
    let kind = gear.unwrap_or_else(|| kind(object, length));
    object.finish()?;
    let JointDef { ends, angles, .. } = placed?;
    let def = JointDef {
        ends,
        angles,
        kind: kind?,
        collide_connected,
        enabled,
        break_force,
        break_torque,
        events,
        key,
        user_data,
    };
    Ok(SceneJoint { name, def, place: object.node.place() })
}

/// The ends of a joint: `bodies` with points of the world, or `ends` in the axes of bodies.
fn placed(
    object: &Object<'_>,
    names: &Names,
    start: Option<&Start<'_>>,
    gear: Option<&Result<JointKind>>,
) -> Result<JointDef> {
    let (way, node) = object.one_of(&["bodies", "ends"])?;
    if way == "ends" {
        let [first, second] = node.tuple()?.map(|node: Node<'_>| end(&node, names));
        let angles = object.or("angles", [Fx::ZERO; 2], numbers);
        return Ok(JointDef { angles, ..JointDef::new([first?, second?], JointKind::default()) });
    }
    let Some(start) = start else {
        // Known, so that the one error is told alone.
        _ = (object.get("point"), object.get("points"), object.get("axis"));
        return Err(node.fault("points of the world are found on bodies at the start alone: give `ends`"));
    };
    let [first, second] = node.tuple()?.map(|node: Node<'_>| match node.kind() {
        Kind::Null => Ok(None),
        Kind::Text => named(&node, names, "body").map(|index| Some(symbol(index))),
        _ => Err(node.wrong_kind("the name of a body, or null for the world")),
    });
    let placing = if object.has("distance") {
        object.need("points", points).map(|[from, to]| Placing::Between(from, to))
    } else if object.has("pulley") {
        let points = object.need("points", points);
        // Its values have their errors there.
        let rope =
            object.at(&["pulley"]).object().ok().and_then(|inner| rope(&inner).ok()).ok_or_else(Refused::default);
        points.and_then(|points| Ok(Placing::Roped(points, rope?)))
    } else if let Some(gear) = gear {
        match gear {
            Ok(JointKind::Gear(Gear { teeth })) => Ok(Placing::Geared(*teeth)),
            // It has its error there.
            _ => Err(Refused::default()),
        }
    } else if object.has("prismatic") || object.has("wheel") {
        let (point, axis) = (object.need("point", Node::point), object.need("axis", axis));
        point.and_then(|point| Ok(Placing::Along(point, axis?)))
    } else {
        object.need("point", Node::point).map(Placing::At)
    };
    let (symbols, placing) = ([first?, second?], placing?);
    start.joint(object.at(&["point", "points", "bodies"]), symbols, placing)
}

/// The direction of an axis.
fn axis(node: &Node<'_>) -> Result<Vec2> {
    let axis = node.point()?;
    if axis == Vec2::ZERO { Err(node.fault("an axis without a direction")) } else { Ok(axis) }
}

impl Start<'_> {
    /// A joint at points of the world.
    fn joint(&self, node: &Node<'_>, symbols: [Option<BodyId>; 2], placing: Placing) -> Result<JointDef> {
        let mut handles = [None; 2];
        for (handle, symbol) in handles.iter_mut().zip(symbols) {
            let Some(symbol) = symbol else { continue };
            // A body that was refused has its error there.
            *handle = Some(*self.handles.get(symbol.parts().0 as usize).ok_or_else(Refused::default)?);
        }
        let [first, second] = handles;
        let def = match placing {
            Placing::At(point) => JointDef::at(self.world, first, second, point),
            Placing::Along(point, axis) => JointDef::along(self.world, first, second, point, axis),
            Placing::Between(from, to) => JointDef::between(self.world, first, from, second, to),
            Placing::Roped(points, Pulley { grounds, strands, .. }) => match (first, second) {
                (Some(first), Some(second)) => JointDef::pulley(self.world, [first, second], points, grounds, strands),
                _ => return Err(node.fault("a pulley joins two bodies")),
            },
            Placing::Geared(teeth) => match (first, second) {
                (Some(first), Some(second)) => JointDef::gear(self.world, first, second, teeth),
                _ => return Err(node.fault("gears are two bodies")),
            },
        };
        let mut def = def.map_err(|error| node.fault(error))?;
        for (end, symbol) in def.ends.iter_mut().zip(symbols) {
            if let (End::Body(attachment), Some(symbol)) = (end, symbol) {
                attachment.body = symbol;
            }
        }
        Ok(def)
    }
}

/// The kind of a joint, with its values. A rod needs a length where none is given here.
pub(super) fn kind(object: &Object<'_>, length: Option<Fx>) -> Result<JointKind> {
    let (word, node) = object.one_of(&KINDS)?;
    let inner = node.object()?;
    match word {
        "revolute" => {
            let revolute = Revolute {
                limits: object_or_none(&inner, "limits", angles),
                motor: object_or_none(&inner, "motor", motor),
                spring: object_or_none(&inner, "spring", |node| spring(node, None, turning_spring)),
                friction: friction(&inner),
                ratchet: object_or_none(&inner, "ratchet", ratchet),
            };
            inner.finish()?;
            Ok(JointKind::Revolute(revolute))
        }
        "weld" => {
            let weld = Weld { spring: object_or_none(&inner, "spring", |node| spring(node, None, turning_spring)) };
            inner.finish()?;
            Ok(JointKind::Weld(weld))
        }
        "prismatic" => {
            let prismatic = Prismatic {
                limits: object_or_none(&inner, "limits", ways),
                motor: object_or_none(&inner, "motor", linear_motor),
                spring: object_or_none(&inner, "spring", |node| spring(node, None, pushing_spring)),
                friction: friction(&inner),
            };
            inner.finish()?;
            Ok(JointKind::Prismatic(prismatic))
        }
        "wheel" => {
            let wheel = Wheel {
                limits: object_or_none(&inner, "limits", ways),
                spring: object_or_none(&inner, "spring", |node| spring(node, None, pushing_spring)),
                motor: object_or_none(&inner, "motor", motor),
                friction: friction(&inner),
            };
            inner.finish()?;
            Ok(JointKind::Wheel(wheel))
        }
        "gear" => {
            let gear = inner.need("teeth", teeth);
            inner.finish()?;
            gear.map(JointKind::Gear)
        }
        "pulley" => pulley(&inner, length).map(JointKind::Pulley),
        "motor" => {
            let motor = Motor {
                spring: object_or_none(&inner, "spring", planar_spring),
                motor: object_or_none(&inner, "motor", planar_motor),
                angular_spring: object_or_none(&inner, "angular_spring", |node| spring(node, None, turning_spring)),
                angular_motor: object_or_none(&inner, "angular_motor", motor),
            };
            inner.finish()?;
            Ok(JointKind::Motor(motor))
        }
        _ => distance(&inner, length).map(JointKind::Distance),
    }
}

/// A distance joint: a rod of a length where nothing else is said.
fn distance(inner: &Object<'_>, length: Option<Fx>) -> Result<Distance> {
    let is_rod = !["limits", "motor", "spring", "friction"].iter().any(|name| inner.has(name));
    if is_rod {
        let length = match length {
            Some(length) => Ok(inner.or("length", length, Node::number)),
            None => inner.need("length", Node::number),
        };
        inner.finish()?;
        let rod = Distance::rod(length?);
        // What the points make is refused by the world, at the points.
        if inner.has("length") {
            check(inner, JointKind::Distance(rod), &["length"])?;
        }
        return Ok(rod);
    }
    let distance = Distance {
        limits: object_or_none(inner, "limits", ways),
        motor: object_or_none(inner, "motor", linear_motor),
        spring: object_or_none(inner, "spring", |node| spring(node, length, pushing_spring)),
        friction: friction(inner),
    };
    inner.finish()?;
    let limits = Distance { limits: distance.limits, ..Distance::default() };
    check(inner, JointKind::Distance(limits), &["limits"])?;
    let spring = Distance { spring: distance.spring, ..Distance::default() };
    check(inner, JointKind::Distance(spring), &["spring"])?;
    Ok(distance)
}

/// A pulley. Its rope needs a length where none is given here.
fn pulley(inner: &Object<'_>, length: Option<Fx>) -> Result<Pulley> {
    let rope = rope(inner);
    let length = match length {
        Some(length) => Ok(inner.or("length", length, Node::number)),
        None => inner.need("length", Node::number),
    };
    inner.finish()?;
    let pulley = Pulley { length: length?, ..rope? };
    if inner.has("length") {
        check(inner, JointKind::Pulley(pulley), &["length"])?;
    }
    Ok(pulley)
}

/// The points and the strands of a rope, without its length.
fn rope(inner: &Object<'_>) -> Result<Pulley> {
    let grounds = inner.need("grounds", points);
    let strands = inner.or("strands", [1; 2], |node| {
        let [first, second] = node.tuple()?.map(|node: Node<'_>| node.whole::<u8>());
        Ok([first?, second?])
    });
    let pulley = Pulley { grounds: grounds?, strands, length: Fx::ONE };
    check(inner, JointKind::Pulley(pulley), &["strands"])?;
    Ok(pulley)
}

/// Two points.
fn points(node: &Node<'_>) -> Result<[Vec2; 2]> {
    let [first, second] = node.tuple()?.map(|node: Node<'_>| node.point());
    Ok([first?, second?])
}

/// A value that may be left out or `null`.
fn object_or_none<T>(object: &Object<'_>, name: &'static str, read: impl FnOnce(&Node<'_>) -> Result<T>) -> Option<T> {
    object.or(name, None, |node| optional(node, read))
}

fn optional<T>(node: &Node<'_>, read: impl FnOnce(&Node<'_>) -> Result<T>) -> Result<Option<T>> {
    if node.kind() == Kind::Null { Ok(None) } else { read(node).map(Some) }
}

/// Refuses a kind out of range, at the first of these fields that is there.
fn check(object: &Object<'_>, kind: JointKind, fields: &[&str]) -> Result<()> {
    kind.check().map_err(|error| object.at(fields).fault(error))
}

fn numbers(node: &Node<'_>) -> Result<[Fx; 2]> {
    let [first, second] = node.tuple()?.map(|node: Node<'_>| node.number());
    Ok([first?, second?])
}

/// The largest force or torque of friction.
fn friction(object: &Object<'_>) -> Fx {
    object.or("friction", Fx::ZERO, |node| {
        let friction = node.number()?;
        let kind: JointKind = JointKind::Revolute(Revolute { friction, ..Revolute::default() });
        kind.check().map(|()| friction).map_err(|error| node.fault(error))
    })
}

/// The lowest and the highest angle.
fn angles(node: &Node<'_>) -> Result<JointLimits> {
    limits(node, |limits| JointKind::Revolute(Revolute { limits, ..Revolute::default() }))
}

/// The lowest and the highest way.
fn ways(node: &Node<'_>) -> Result<JointLimits> {
    limits(node, |limits| JointKind::Prismatic(Prismatic { limits, ..Prismatic::default() }))
}

/// Limits that are in range for a kind.
fn limits(node: &Node<'_>, kind: fn(Option<JointLimits>) -> JointKind) -> Result<JointLimits> {
    let [lower, upper] = numbers(node)?;
    let limits = JointLimits { lower, upper };
    kind(Some(limits)).check().map_err(|error| node.fault(error))?;
    Ok(limits)
}

/// A motor that turns.
fn motor(node: &Node<'_>) -> Result<JointMotor> {
    motor_of(node, |motor| JointKind::Revolute(Revolute { motor, ..Revolute::default() }))
}

/// A motor that pushes.
fn linear_motor(node: &Node<'_>) -> Result<JointMotor> {
    motor_of(node, |motor| JointKind::Prismatic(Prismatic { motor, ..Prismatic::default() }))
}

/// A motor, all of whose values are in range for a kind.
fn motor_of(node: &Node<'_>, kind: fn(Option<JointMotor>) -> JointKind) -> Result<JointMotor> {
    let object = node.object()?;
    let speed = object.or("speed", Fx::ZERO, Node::number);
    let max_force = object.need("max_force", Node::number);
    object.finish()?;
    let motor = JointMotor { speed, max_force: max_force? };
    let kind = kind(Some(motor));
    let field = match kind.check() {
        Err(Error::OutOfRange { quantity: Quantity::MotorSpeed }) => "speed",
        _ => "max_force",
    };
    check(&object, kind, &[field])?;
    Ok(motor)
}

/// A motor that turns, or `null` for none.
pub(super) fn optional_motor(node: &Node<'_>) -> Result<Option<JointMotor>> {
    optional(node, motor)
}

fn turning_spring(spring: JointSpring) -> JointKind {
    JointKind::Weld(Weld { spring: Some(spring) })
}

fn pushing_spring(spring: JointSpring) -> JointKind {
    JointKind::Prismatic(Prismatic { spring: Some(spring), ..Prismatic::default() })
}

/// A spring, all of whose values are in range for a kind; it may have another position at rest than 0.
fn spring(node: &Node<'_>, rest: Option<Fx>, kind: fn(JointSpring) -> JointKind) -> Result<JointSpring> {
    let object = node.object()?;
    let hertz = object.need("hertz", Node::number);
    let damping_ratio = object.or("damping_ratio", Fx::ONE, Node::number);
    let rest = object.or("rest", rest.unwrap_or_default(), Node::number);
    let max_force = object.or("max_force", None, |node| optional(node, |node| node.number()));
    object.finish()?;
    let spring = JointSpring { hertz: hertz?, damping_ratio, rest, max_force };
    let kind = kind(spring);
    check(&object, kind, &[spring_field(&kind)])?;
    Ok(spring)
}

/// The field of a spring that is out of range.
fn spring_field(kind: &JointKind) -> &'static str {
    match kind.check() {
        Err(Error::OutOfRange { quantity: Quantity::SpringFrequency }) => "hertz",
        Err(Error::OutOfRange { quantity: Quantity::DampingRatio }) => "damping_ratio",
        Err(Error::OutOfRange { quantity: Quantity::JointAngle | Quantity::JointLength }) => "rest",
        _ => "max_force",
    }
}

/// The teeth of two gears.
fn teeth(node: &Node<'_>) -> Result<Gear> {
    let [first, second] = numbers(node)?;
    let gear = Gear { teeth: [tooth_count(node, first)?, tooth_count(node, second)?] };
    JointKind::<Fx>::Gear(gear).check().map_err(|error| node.fault(error))?;
    Ok(gear)
}

/// The teeth of a ratchet.
fn ratchet(node: &Node<'_>) -> Result<i16> {
    let teeth = tooth_count(node, node.number()?)?;
    let kind: JointKind = JointKind::Revolute(Revolute { ratchet: Some(teeth), ..Revolute::default() });
    kind.check().map(|()| teeth).map_err(|error| node.fault(error))
}

/// A whole number of teeth.
fn tooth_count(node: &Node<'_>, number: Fx) -> Result<i16> {
    let count = i16::try_from(number.floor_to_int()).ok().filter(|&count| Fx::from(i32::from(count)) == number);
    count.ok_or_else(|| node.fault(Error::OutOfRange { quantity: Quantity::Teeth }))
}

/// A spring that pulls to a point.
fn planar_spring(node: &Node<'_>) -> Result<PlanarSpring> {
    let object = node.object()?;
    let hertz = object.need("hertz", Node::number);
    let damping_ratio = object.or("damping_ratio", Fx::ONE, Node::number);
    let rest = object.or("rest", Vec2::ZERO, Node::point);
    let max_force = object.or("max_force", None, |node| optional(node, |node| node.number()));
    object.finish()?;
    let spring = PlanarSpring { hertz: hertz?, damping_ratio, rest, max_force };
    let kind = JointKind::Motor(Motor { spring: Some(spring), ..Motor::default() });
    check(&object, kind, &[spring_field(&kind)])?;
    Ok(spring)
}

/// A motor with a velocity.
fn planar_motor(node: &Node<'_>) -> Result<PlanarMotor> {
    let object = node.object()?;
    let velocity = object.or("velocity", Vec2::ZERO, Node::point);
    let max_force = object.need("max_force", Node::number);
    object.finish()?;
    let motor = PlanarMotor { velocity, max_force: max_force? };
    let kind = JointKind::Motor(Motor { motor: Some(motor), ..Motor::default() });
    let field = match kind.check() {
        Err(Error::OutOfRange { quantity: Quantity::MotorSpeed }) => "velocity",
        _ => "max_force",
    };
    check(&object, kind, &[field])?;
    Ok(motor)
}

/// The mean force or torque over a step at which a joint breaks, or `null` for never.
pub(super) fn break_force(node: &Node<'_>) -> Result<Option<Fx>> {
    let force = optional(node, |node| node.number())?;
    let is_in_range = force.is_none_or(|force| force >= Fx::ZERO);
    if is_in_range { Ok(force) } else { Err(node.fault(Error::OutOfRange { quantity: Quantity::BreakForce })) }
}

/// Puts an error of the engine's at the field of the joint that it is about.
pub(super) fn blame(object: &Object<'_>, error: Error) -> Refused {
    let node = object.at(&["ends", "points", "point"]);
    let bodies = object.at(&["bodies", "ends"]);
    match error {
        Error::SameBody { .. } => bodies.fault(Coded(error.code(), "both ends of the joint are on the same body")),
        Error::NothingToMove => bodies.fault(error),
        Error::OutOfRange { quantity: Quantity::JointLength } => object.at(&["points"]).fault(error),
        Error::OutOfRange { quantity: Quantity::Position | Quantity::JointPoint } => node.fault(error),
        _ => object.node.fault(error),
    }
}
