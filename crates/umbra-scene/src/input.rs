//! Reading inputs: what is done to the world, and at which tick.

use alloc::vec::Vec;

use super::body::{blame, body, force_groups, kind, locks, mass, max_speeds, own_damping};
use super::error::{Flaw, Place};
use super::field::{field, named, symbol};
use super::node::{Node, Object, Result};
use super::repeat::check_count;
use super::settings::{blob, integrator, random, sleep_after, time_step, world_damping};
use super::shape::{ShapeDef, shape};
use super::{Scene, Tables};
use umbra_physics::{ApplyOptions, BodyId, Command, FieldId, ForceOrImpulse, Frame, Fx};

/// An input: an action on the world, at one tick or at several.
#[derive(Clone, Debug, PartialEq)]
pub struct Input {
    /// The first tick at which it is done, before the step from that tick to the next.
    pub from: u64,
    /// The last one.
    pub to: u64,
    /// The number of ticks from one time to the next; 0 is taken for 1.
    pub every: u64,
    /// The action.
    pub action: SceneAction,
    /// The place in the text.
    pub place: Place,
}

/// An action of an input. Handles in it are indices in [`Scene::bodies`] and [`Scene::fields`].
///
/// ```
/// use umbra_physics::Command;
/// use umbra_scene::{Scene, SceneAction};
///
/// let text = r#"{"bodies": [{"name": "a"}], "inputs": [{"at": 4, "body": "a", "do": "remove"}]}"#;
/// let scene = Scene::parse(text)?;
/// let SceneAction::Command(Command::RemoveBody(body)) = scene.inputs[0].action else { unreachable!() };
/// assert_eq!(scene.bodies[body.parts().0 as usize].name, "a");
/// # Ok::<(), umbra_scene::SceneError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[allow(clippy::large_enum_variant, reason = "nearly all are commands")]
pub enum SceneAction {
    /// A command of the world's. A body or force field that it adds has no index in the scene.
    Command(Command),
    /// The body of this index is added.
    AddBody(usize),
    /// The force field of this index is added.
    AddField(usize),
    /// A body gets a shape, or none.
    SetShape {
        /// The body.
        body: BodyId,
        /// The shape.
        shape: Option<ShapeDef>,
    },
}

/// Reads an input, which may do several things in the order in which they stand here.
pub(super) fn input(object: &Object<'_>, scene: &mut Scene, tables: &mut Tables) -> Result<()> {
    let mut actions = Vec::new();
    let mut push = |node: &Node<'_>, action| actions.push((node.place(), action));
    if let Some(node) = object.get("add") {
        let object = node.object()?;
        let body = body(&object)?;
        body.def::<Fx>().and_then(|def| def.check()).map_err(|error| blame(&object, error))?;
        push(node, SceneAction::AddBody(scene.add_body(body, node, tables)?));
    }
    if let Some(node) = object.get("add_field") {
        let field = field(&node.object()?, &tables.bodies)?;
        push(node, SceneAction::AddField(scene.add_field(field, node, tables)?));
    }
    if let Some(node) = object.get("body") {
        let target = symbol(named(node, &tables.bodies, "body")?);
        read_forces(object, target, &mut push)?;
        if let Some(node) = object.get("move_to") {
            let goal = node.object()?;
            let (position, angle) = (goal.need("position")?.point()?, goal.or("angle", Fx::ZERO, Node::number)?);
            goal.finish()?;
            push(node, SceneAction::Command(Command::MoveTo { body: target, position, angle }));
        }
        if let Some(set) = object.get("set") {
            set_body(&set.object()?, target, &mut push)?;
        }
        if let Some(node) = object.get("do") {
            let command =
                match node.choice(&[("remove", 0), ("release", 1), ("wake", 2), ("disable", 3), ("enable", 4)])? {
                    0 => Command::RemoveBody(target),
                    1 => Command::Release(target),
                    2 => Command::Wake(target),
                    3 => Command::Disable(target),
                    _ => Command::Enable(target),
                };
            push(node, SceneAction::Command(command));
        }
    } else if let Some(node) = object.get("field") {
        let target = FieldId::from_parts(named(node, &tables.fields, "force field")? as u32, 0);
        if let Some(node) = object.get("replace") {
            let field = field(&node.object()?, &tables.bodies)?.field;
            push(node, SceneAction::Command(Command::SetField { id: target, field }));
        }
        if let Some(node) = object.get("do") {
            node.choice(&[("remove", ())])?;
            push(node, SceneAction::Command(Command::RemoveField(target)));
        }
    } else {
        if let Some(set) = object.get("set") {
            set_world(&set.object()?, &mut push)?;
        }
        if let Some(node) = object.get("do") {
            node.choice(&[("clear_forces", ())])?;
            push(node, SceneAction::Command(Command::ClearForces));
        }
    }
    // Last, so that what is unknown is known to be.
    let (from, to, every) = span(object)?;
    object.finish()?;
    let is_added =
        |(_, action): &(Place, SceneAction)| matches!(action, SceneAction::AddBody(_) | SceneAction::AddField(_));
    if let Some((place, _)) = actions.iter().find(|action| from != to && is_added(action)) {
        return Err(place.fault(
            Flaw::OutOfRange.of("out of range: a body or field with a name is added once: give `at` with one tick"),
        ));
    }
    if actions.is_empty() {
        return Err(object.node.fault("this input does nothing: give it an action such as `force`, `set` or `do`"));
    }
    check_count(&object.node, (scene.inputs.len() + actions.len()) as u64, tables.most)?;
    let inputs = actions.into_iter().map(|(place, action)| Input { from, to, every, action, place });
    scene.inputs.extend(inputs);
    Ok(())
}

/// `at` one tick, or `from` one `to` another, `every` so many.
fn span(object: &Object<'_>) -> Result<(u64, u64, u64)> {
    let (name, node) = object.one_of(&["at", "from"])?;
    let first: u64 = node.whole()?;
    if name == "at" {
        return Ok((first, first, 1));
    }
    let to = object.need("to")?;
    let (last, every): (u64, u64) = (to.whole()?, object.or("every", 1, Node::whole)?);
    if last < first {
        return Err(to.fault(
            Flaw::OutOfRange.of("out of range: the last tick is before the first: expected `to` of at least `from`"),
        ));
    }
    if every == 0 {
        return Err(object
            .at(&["every"])
            .fault(Flaw::OutOfRange.of("out of range: expected a number of ticks from 1")));
    }
    Ok((first, last, every))
}

/// Forces and impulses.
fn read_forces(object: &Object<'_>, target: BodyId, push: &mut impl FnMut(&Node<'_>, SceneAction)) -> Result<()> {
    let [force, torque, impulse, angular_impulse] =
        ["force", "torque", "impulse", "angular_impulse"].map(|name| object.get(name));
    let has_point = force.or(impulse).is_some();
    let is_any = has_point || torque.or(angular_impulse).is_some();
    if let Some(node) = object.get("point").filter(|_| !has_point) {
        return Err(node.fault("a `point` needs a `force` or an `impulse` beside it"));
    }
    for name in ["frame", "wake"] {
        if let Some(node) = object.get(name).filter(|_| !is_any) {
            let message = "needs a `force`, `torque`, `impulse` or `angular_impulse` beside it";
            return Err(node.fault(format_args!("`{name}` {message}")));
        }
    }
    let frame = |node: &Node<'_>| node.choice(&[("world", Frame::World), ("body", Frame::Body)]);
    let options =
        ApplyOptions { frame: object.or("frame", Frame::World, frame)?, wake: object.or("wake", true, Node::boolean)? };
    let point = object.get("point").map(Node::point).transpose()?;
    let mut apply = |node: &Node<'_>, action| {
        push(node, SceneAction::Command(Command::Apply { body: target, action, options }));
    };
    if let Some(node) = force {
        apply(node, ForceOrImpulse::Force { force: node.point()?, point });
    }
    if let Some(node) = torque {
        apply(node, ForceOrImpulse::Torque(node.number()?));
    }
    if let Some(node) = impulse {
        apply(node, ForceOrImpulse::Impulse { impulse: node.point()?, point });
    }
    if let Some(node) = angular_impulse {
        apply(node, ForceOrImpulse::AngularImpulse(node.number()?));
    }
    Ok(())
}

fn set_body(object: &Object<'_>, body: BodyId, push: &mut impl FnMut(&Node<'_>, SceneAction)) -> Result<()> {
    let mut set = |node: &Node<'_>, command| push(node, SceneAction::Command(command));
    if let Some(node) = object.get("kind") {
        set(node, Command::SetKind { body, kind: kind(node)? });
    }
    if let Some(mass) = mass(object)? {
        set(object.at(&["mass", "density"]), Command::SetMass { body, mass });
    }
    if let Some(node) = object.get("position") {
        set(node, Command::SetPosition { body, position: node.point()? });
    }
    if let Some(node) = object.get("angle") {
        set(node, Command::SetAngle { body, angle: node.number()? });
    }
    if let Some(node) = object.get("velocity") {
        set(node, Command::SetVelocity { body, velocity: node.point()? });
    }
    if let Some(node) = object.get("angular_velocity") {
        set(node, Command::SetAngularVelocity { body, velocity: node.number()? });
    }
    if let Some(node) = object.get("gravity_scale") {
        set(node, Command::SetGravityScale { body, scale: node.number()? });
    }
    if let Some(node) = object.get("damping") {
        let (linear, angular) = own_damping(node)?;
        set(node, Command::SetBodyDamping { body, linear, angular });
    }
    if let Some(node) = object.get("max_speeds") {
        let (linear, angular) = max_speeds(node)?;
        set(node, Command::SetMaxSpeeds { body, linear, angular });
    }
    if let Some(node) = object.get("locks") {
        set(node, Command::SetLocks { body, locks: locks(node)? });
    }
    if let Some(node) = object.get("force_groups") {
        set(node, Command::SetForceGroups { body, force_groups: force_groups(node)? });
    }
    if let Some(node) = object.get("key") {
        set(node, Command::SetKey { body, key: node.whole()? });
    }
    if let Some(node) = object.get("user_data") {
        set(node, Command::SetUserData { body, user_data: node.whole()? });
    }
    if let Some(node) = object.get("shape") {
        let shape = if node.raw() == "null" { None } else { Some(shape(node)?) };
        push(node, SceneAction::SetShape { body, shape });
    }
    object.finish()
}

fn set_world(object: &Object<'_>, push: &mut impl FnMut(&Node<'_>, SceneAction)) -> Result<()> {
    let mut set = |node: &Node<'_>, command| push(node, SceneAction::Command(command));
    if let Some(node) = object.get("time_step") {
        set(node, Command::SetTimeStep(time_step(node)?));
    }
    if let Some(node) = object.get("gravity") {
        set(node, Command::SetGravity(node.point()?));
    }
    if let Some(node) = object.get("integrator") {
        set(node, Command::SetIntegrator(integrator(node)?));
    }
    if let Some(node) = object.get("damping") {
        let (linear, angular) = world_damping(node)?;
        set(node, Command::SetDamping { linear, angular });
    }
    if let Some(node) = object.get("sleep_after") {
        set(node, Command::SetSleepAfter(sleep_after(node)?));
    }
    if let Some(node) = object.get("random") {
        set(node, Command::SetRandom(random(node)?));
    }
    if let Some(node) = object.get("blob") {
        set(node, Command::SetBlob(blob(node)?));
    }
    object.finish()
}

impl Input {
    /// Returns whether the input is carried out at this tick.
    ///
    /// ```
    /// use umbra_scene::Scene;
    ///
    /// let text = r#"{"bodies": [{"name": "a"}],
    /// "inputs": [{"from": 4, "to": 10, "every": 3, "body": "a", "impulse": [1, 0]}]}"#;
    /// let scene = Scene::parse(text)?;
    /// let due: Vec<u64> = (0..20).filter(|&tick| scene.inputs[0].is_due(tick)).collect();
    /// assert_eq!(due, [4, 7, 10]);
    /// # Ok::<(), umbra_scene::SceneError>(())
    /// ```
    #[must_use]
    pub const fn is_due(&self, tick: u64) -> bool {
        let every = if self.every == 0 { 1 } else { self.every };
        self.from <= tick && tick <= self.to && (tick - self.from) % every == 0
    }
}
