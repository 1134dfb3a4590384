//! Reading colliders and the settings of contacts.

use alloc::string::String;

use super::Tables;
use super::body::bits;
use super::convert::convert_collider;
use super::error::{Place, Refused};
use super::node::{Node, Result};
use super::object::Object;
use super::shape::{ShapeDef, shape};
use umbra_physics::{
    ColliderDef, ColliderId, ContactSettings, Error, Filter, Fx, Material, MaterialPair, MixRule, OneWay, Quantity,
    Scalar, Shape, Vec2, limits,
};

/// A collider of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneCollider {
    /// The name, if inputs are to change the collider. No other collider of the scene has it.
    pub name: Option<String>,
    /// The definition.
    pub def: ColliderDef,
    /// The place in the text.
    pub place: Place,
}

impl SceneCollider {
    /// The definition for a scalar.
    ///
    /// # Errors
    /// As the constructors of [`Shape`]: a polygon may have no area left in a coarser scalar.
    ///
    /// ```
    /// use umbra_physics::{ColliderDef, Material, fx};
    /// use umbra_scene::{Scene, SceneCollider};
    ///
    /// let text = r#"{"bodies": [{"name": "a", "colliders": [
    ///     {"name": "hull", "shape": {"circle": {"radius": 0.5}}, "friction": 0.5}]}]}"#;
    /// let scene = Scene::parse(text)?;
    /// let hull: &SceneCollider = &scene.bodies[0].colliders[0];
    /// let def: ColliderDef<f64> = hull.def()?;
    /// assert_eq!((hull.def.material.friction, def.material.friction), (fx!(0.5), 0.5));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn def<S: Scalar>(&self) -> core::result::Result<ColliderDef<S>, Error> {
        convert_collider(&self.def)
    }
}

/// Reads a collider of a body, and takes it in under its name.
pub(super) fn collider(object: &Object<'_>, symbol: ColliderId, tables: &mut Tables) -> Result<SceneCollider> {
    let read = read(object).and_then(|read| {
        tables.add_collider(object, read.name.as_deref(), symbol)?;
        Ok(read)
    });
    read.inspect_err(|_| tables.colliders.note_refused(object, false))
}

/// Reads a collider.
pub(super) fn read(object: &Object<'_>) -> Result<SceneCollider> {
    let name = object.or("name", None, |node| node.string().map(Some));
    let shape = object.need("shape", shape).and_then(|def: ShapeDef| {
        let shape: Shape = def.make().map_err(|error| object.at(&["shape"]).fault(error))?;
        Ok(shape)
    });
    let (material, filter) = (Material::default(), Filter::default());
    let (position, angle) =
        (object.or("position", Vec2::ZERO, Node::point), object.or("angle", Fx::ZERO, Node::number));
    let density = object.or("density", Fx::ONE, Node::number);
    let material = Material {
        friction: object.or("friction", material.friction, Node::number),
        restitution: object.or("restitution", material.restitution, Node::number),
        rolling_resistance: object.or("rolling_resistance", material.rolling_resistance, Node::number),
        surface_speed: object.or("surface_speed", material.surface_speed, Node::number),
        friction_rule: object.or("friction_rule", material.friction_rule, rule),
        restitution_rule: object.or("restitution_rule", material.restitution_rule, rule),
        id: object.or("material_id", material.id, Node::whole),
    };
    let categories = |node: &Node<'_>| bits(node, "category");
    let one_way = object.or("one_way", None, |node| one_way(node).map(Some));
    let flag = |name| object.or(name, false, Node::boolean);
    let [sensor, contact_events, hit_events] = [flag("sensor"), flag("contact_events"), flag("hit_events")];
    let filter = Filter {
        category: object.or("category", filter.category, categories),
        mask: object.or("mask", filter.mask, categories),
        group: object.or("group", filter.group, Node::whole),
    };
    let (key, user_data) = (object.or("key", 0, Node::whole), object.or("user_data", 0, Node::whole));
    object.finish()?;
    let def = ColliderDef {
        shape: shape?,
        position,
        angle,
        density,
        material,
        filter,
        one_way,
        sensor,
        contact_events,
        hit_events,
        key,
        user_data,
    };
    def.check().map_err(|error| blame(object, error))?;
    Ok(SceneCollider { name, def, place: object.node.place() })
}

fn rule(node: &Node<'_>) -> Result<MixRule> {
    node.choice(&MixRule::ALL.map(|rule| (rule.name(), rule)))
}

/// Reads the side from which a collider holds. Each field that is out of range is refused at its place.
fn one_way(node: &Node<'_>) -> Result<OneWay> {
    let object = node.object()?;
    let standard: OneWay = OneWay::default();
    let read = OneWay {
        direction: object.or("direction", standard.direction, Node::point),
        tolerance: object.or("tolerance", standard.tolerance, Node::number),
    };
    object.finish()?;
    let field = |error| match error {
        Error::OutOfRange { quantity: Quantity::OneWayTolerance } => "tolerance",
        _ => "direction",
    };
    read.check().map_err(|error| object.at(&[field(error)]).fault(error))?;
    Ok(read)
}

/// Puts an error of the engine's at the field of the collider that it is about.
fn blame(object: &Object<'_>, error: Error) -> Refused {
    let fields: &[&str] = match error {
        Error::OutOfRange { quantity } => match quantity {
            Quantity::ColliderPosition => &["position"],
            Quantity::Angle => &["angle"],
            Quantity::ColliderDensity { .. } => &["density"],
            Quantity::Friction => &["friction"],
            Quantity::Restitution => &["restitution"],
            Quantity::RollingResistance => &["rolling_resistance"],
            Quantity::SurfaceSpeed => &["surface_speed"],
            _ => &[],
        },
        _ => &[],
    };
    object.at(fields).fault(error)
}

/// The coefficients of two materials together.
///
/// ```
/// use umbra_physics::fx;
/// use umbra_scene::{Scene, SceneMaterialPair};
///
/// let text = r#"{"bodies": [{"name": "puck", "colliders": [{"shape": {"circle": {"radius": 1}}, "material_id": 4}]}],
///     "material_pairs": [{"materials": [4, 4], "friction": 0.1}]}"#;
/// let scene = Scene::parse(text)?;
/// let [SceneMaterialPair { materials: [4, 4], pair, .. }] = scene.material_pairs[..] else { unreachable!() };
/// assert_eq!(pair.friction, fx!(0.1));
/// # Ok::<(), umbra_scene::SceneErrors>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SceneMaterialPair {
    /// The numbers of the materials.
    pub materials: [u32; 2],
    /// The coefficients of contacts of the two materials.
    pub pair: MaterialPair,
    /// The place in the text.
    pub place: Place,
}

/// Reads the numbers of two materials and their coefficients; none with `remove` where that is allowed.
pub(super) fn material_pair(object: &Object<'_>, may_remove: bool) -> Result<([u32; 2], Option<MaterialPair>)> {
    let ids = object.need("materials", |node| {
        let [a, b] = node.tuple()?.map(|node: Node<'_>| {
            let id: u32 = node.whole()?;
            let error = Error::OutOfRange { quantity: Quantity::MaterialId };
            if id == 0 { Err(node.fault(error)) } else { Ok(id) }
        });
        Ok([a?, b?])
    });
    let is_removed = may_remove && object.or("remove", false, Node::boolean);
    let mut pair: MaterialPair = MaterialPair::default();
    if !is_removed {
        coefficient(object, "friction", |value| pair.friction = value, limits::FRICTION, Quantity::Friction);
        coefficient(object, "restitution", |value| pair.restitution = value, Fx::ONE, Quantity::Restitution);
        let set = |value| pair.rolling_resistance = value;
        coefficient(object, "rolling_resistance", set, Fx::ONE, Quantity::RollingResistance);
    }
    object.finish()?;
    Ok((ids?, (!is_removed).then_some(pair)))
}

/// Reads a coefficient from 0, if it is there.
fn coefficient(object: &Object<'_>, name: &'static str, set: impl FnOnce(Fx), max: Fx, quantity: Quantity) {
    object.or(name, (), |node| {
        let value = node.number()?;
        if value < Fx::ZERO || value > max {
            return Err(node.fault(Error::OutOfRange { quantity }));
        }
        set(value);
        Ok(())
    });
}

/// Reads the settings of contacts. Each that is out of range is refused at its place.
pub(super) fn contacts(node: &Node<'_>) -> Result<ContactSettings> {
    let object = node.object()?;
    let mut settings: ContactSettings = ContactSettings::default();
    number(&object, "substeps", &mut settings, Node::whole, |settings| &mut settings.substeps);
    number(&object, "push_speed", &mut settings, Node::number, |settings| &mut settings.push_speed);
    number(&object, "restitution_speed", &mut settings, Node::number, |settings| &mut settings.restitution_speed);
    number(&object, "sleep_speed", &mut settings, Node::number, |settings| &mut settings.sleep_speed);
    number(&object, "hit_speed", &mut settings, Node::number, |settings| &mut settings.hit_speed);
    number(&object, "max_pairs", &mut settings, Node::whole, |settings| &mut settings.max_pairs);
    number(&object, "max_pairs_per_collider", &mut settings, Node::whole, |settings| {
        &mut settings.max_pairs_per_collider
    });
    object.finish()?;
    Ok(settings)
}

/// Reads one of the settings, if it is there.
fn number<'a, T>(
    object: &Object<'a>,
    name: &'static str,
    settings: &mut ContactSettings,
    read: fn(&Node<'a>) -> Result<T>,
    place: fn(&mut ContactSettings) -> &mut T,
) {
    object.or(name, (), |node| {
        let mut next = *settings;
        *place(&mut next) = read(node)?;
        next.check().map_err(|error| node.fault(error))?;
        *settings = next;
        Ok(())
    });
}
