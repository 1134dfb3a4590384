//! Reading inputs: what is done to the world, and at which tick.

use alloc::vec::Vec;

use super::body::{bits, blame, body, force_groups, kind, locks, mass, max_speeds, own_damping};
use super::collider::{self, contacts, material_pair};
use super::error::{Flaw, Place};
use super::field::{REFUSED, field, named, symbol};
use super::joint::{break_force, joint, kind as joint_kind, optional_motor};
use super::node::{Node, Result};
use super::object::Object;
use super::repeat::check_count;
use super::settings::{blob, integrator, random, sleep_after, time_step, world_damping};
use super::{Scene, Tables};
use umbra_physics::{
    ApplyOptions, BodyId, ColliderId, Command, Error, Exclusion, Explosion, FieldId, ForceOrImpulse, Frame, Fx,
    JointId, Quantity, Vec2,
};

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

/// An action of an input. Handles in it are indices in [`Scene::bodies`], [`Scene::fields`] and [`Scene::joints`]; the two parts of a collider's are the
/// index of its body and that in [`SceneBody::colliders`](super::SceneBody::colliders).
///
/// ```
/// use umbra_physics::Command;
/// use umbra_scene::{Scene, SceneAction};
///
/// let text = r#"{"bodies": [{"name": "a"}], "inputs": [{"at": 4, "body": "a", "do": "remove"}]}"#;
/// let scene = Scene::parse(text)?;
/// let SceneAction::Command(Command::RemoveBody(body)) = scene.inputs[0].action else { unreachable!() };
/// assert_eq!(scene.bodies[body.parts().0 as usize].name, "a");
/// # Ok::<(), umbra_scene::SceneErrors>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[allow(clippy::large_enum_variant, reason = "nearly all are commands")]
pub enum SceneAction {
    /// A command of the world's. A body, force field, joint or collider that it adds has no index in the scene.
    Command(Command),
    /// The body of this index is added.
    AddBody(usize),
    /// The force field of this index is added.
    AddField(usize),
    /// The joint of this index is added.
    AddJoint(usize),
    /// A collider is added to its body.
    AddCollider(ColliderId),
}

/// The actions of an input, each with its place in the text.
type Actions = Vec<(Place, SceneAction)>;

/// Reads an input, which may do several things in the order in which they stand here.
pub(super) fn input(object: &Object<'_>, scene: &mut Scene, tables: &mut Tables) -> Result<()> {
    let mut actions = Actions::new();
    let mut push = |node: &Node<'_>, action| actions.push((node.place(), action));
    object.or("add", (), |node| {
        let object = node.object()?;
        let read = body(&object, scene.bodies.len(), tables).and_then(|body| {
            let checked = body.def::<Fx>().and_then(|def| def.check());
            checked.map_err(|error| blame(&object, error))?;
            scene.add_body(body, node, tables)
        });
        let index = read.inspect_err(|_| tables.bodies.note_refused(&object, true))?;
        push(node, SceneAction::AddBody(index));
        Ok(())
    });
    object.or("add_field", (), |node| {
        let object = node.object()?;
        let read = field(&object, &tables.bodies).and_then(|field| scene.add_field(field, node, tables));
        let index = read.inspect_err(|_| tables.fields.note_refused(&object, false))?;
        push(node, SceneAction::AddField(index));
        Ok(())
    });
    object.or("add_joint", (), |node| {
        let object = node.object()?;
        let read = joint(&object, &tables.bodies, None).and_then(|joint| scene.add_joint(joint, node, tables));
        let index = read.inspect_err(|_| tables.joints.note_refused(&object, false))?;
        push(node, SceneAction::AddJoint(index));
        Ok(())
    });
    if let Some(node) = object.get("body") {
        // With a name that nothing has the rest is read all the same.
        let target = symbol(named(node, &tables.bodies, "body").unwrap_or(REFUSED));
        object.or("add_collider", (), |node| {
            let symbol = scene.add_collider(&node.object()?, target, tables)?;
            push(node, SceneAction::AddCollider(symbol));
            Ok(())
        });
        do_to_body(object, target, tables, &mut push);
    } else if let Some(node) = object.get("collider") {
        let target = tables.collider(node).unwrap_or(ColliderId::from_parts(REFUSED as u32, 0));
        do_to_collider(object, target, &mut push);
    } else if let Some(node) = object.get("field") {
        let target = named(node, &tables.fields, "force field").unwrap_or(REFUSED);
        do_to_field(object, FieldId::from_parts(target as u32, 0), tables, &mut push);
    } else if let Some(node) = object.get("joint") {
        let target = named(node, &tables.joints, "joint").unwrap_or(REFUSED);
        do_to_joint(object, JointId::from_parts(target as u32, 0), &mut push);
    } else {
        object.or("set", (), |set| set_world(&set.object()?, &mut push));
        object.or("do", (), |node| {
            node.choice(&[("clear_forces", ())])?;
            push(node, SceneAction::Command(Command::ClearForces));
            Ok(())
        });
        set_by(object, "explode", &mut push, |node| Ok(Command::Explode(explosion(&node.object()?)?)));
    }
    // Last, so that what is unknown is known to be.
    let (from, to, every) = span(object)?;
    object.finish()?;
    let is_added = |(_, action): &(Place, SceneAction)| !matches!(action, SceneAction::Command(_));
    if actions.iter().any(|action| from != to && is_added(action)) {
        return Err(object.at(&["add", "add_field", "add_joint", "add_collider"]).fault(
            Flaw::OutOfRange.of(
                "out of range: a body, field, joint or collider with a name is added once: give `at` with one tick",
            ),
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

/// Reads what is done to a body.
fn do_to_body(object: &Object<'_>, target: BodyId, tables: &Tables, push: &mut impl FnMut(&Node<'_>, SceneAction)) {
    // What is refused is with the errors.
    _ = read_forces(object, target, push);
    object.or("move_to", (), |node| {
        let goal = node.object()?;
        let (position, angle) = (goal.need("position", Node::point), goal.or("angle", Fx::ZERO, Node::number));
        goal.finish()?;
        push(node, SceneAction::Command(Command::MoveTo { body: target, position: position?, angle }));
        Ok(())
    });
    object.or("set", (), |set| set_body(&set.object()?, target, push));
    exclude(object, target, tables, push);
    object.or("do", (), |node| {
        let choices = [("remove", 0), ("release", 1), ("wake", 2), ("sleep", 3), ("disable", 4), ("enable", 5)];
        let command = match node.choice(&choices)? {
            0 => Command::RemoveBody(target),
            1 => Command::Release(target),
            2 => Command::Wake(target),
            3 => Command::Sleep(target),
            4 => Command::Disable(target),
            _ => Command::Enable(target),
        };
        push(node, SceneAction::Command(command));
        Ok(())
    });
}

/// Reads what is done to a collider.
fn do_to_collider(object: &Object<'_>, target: ColliderId, push: &mut impl FnMut(&Node<'_>, SceneAction)) {
    set_by(object, "replace", push, |node| {
        Ok(Command::SetCollider { collider: target, def: collider::read(&node.object()?)?.def })
    });
    set_by(object, "do", push, |node| {
        node.choice(&[("remove", ())])?;
        Ok(Command::RemoveCollider(target))
    });
}

/// Reads what is done to a force field.
fn do_to_field(object: &Object<'_>, target: FieldId, tables: &Tables, push: &mut impl FnMut(&Node<'_>, SceneAction)) {
    set_by(object, "replace", push, |node| {
        Ok(Command::SetField { id: target, field: field(&node.object()?, &tables.bodies)?.field })
    });
    set_by(object, "do", push, |node| {
        node.choice(&[("remove", ())])?;
        Ok(Command::RemoveField(target))
    });
}

/// Reads what is done to a joint.
fn do_to_joint(object: &Object<'_>, joint: JointId, push: &mut impl FnMut(&Node<'_>, SceneAction)) {
    object.or("set", (), |set| {
        let set = set.object()?;
        set_by(&set, "kind", push, |node| {
            let object = node.object()?;
            let kind = joint_kind(&object, None)?;
            object.finish()?;
            Ok(Command::SetJointKind { joint, kind })
        });
        set_by(&set, "motor", push, |node| Ok(Command::SetJointMotor { joint, motor: optional_motor(node)? }));
        set_by(&set, "break_force", push, |node| Ok(Command::SetJointBreak { joint, force: break_force(node)? }));
        set_by(&set, "break_torque", push, |node| {
            Ok(Command::SetJointBreakTorque { joint, torque: break_force(node)? })
        });
        set.finish()
    });
    set_by(object, "do", push, |node| {
        let command = match node.choice(&[("remove", 0), ("disable", 1), ("enable", 2)])? {
            0 => Command::RemoveJoint(joint),
            enabled => Command::EnableJoint { joint, enabled: enabled == 2 },
        };
        Ok(command)
    });
}

/// Excludes a body from contacts with another one, or allows them again.
fn exclude(object: &Object<'_>, a: BodyId, tables: &Tables, push: &mut impl FnMut(&Node<'_>, SceneAction)) {
    let names = ["exclude", "exclude_until_apart", "allow"];
    for (name, exclusion) in names.into_iter().zip([Some(Exclusion::Always), Some(Exclusion::UntilApart), None]) {
        object.or(name, (), |node| {
            let b = symbol(named(node, &tables.bodies, "body")?);
            if a == b {
                return Err(node.fault(Flaw::OutOfRange.of("out of range: expected the name of another body")));
            }
            push(
                node,
                SceneAction::Command(match exclusion {
                    Some(exclusion) => Command::ExcludePair { a, b, exclusion },
                    None => Command::AllowPair { a, b },
                }),
            );
            Ok(())
        });
    }
}

/// An explosion.
fn explosion(object: &Object<'_>) -> Result<Explosion> {
    let standard = Explosion::new(Vec2::ZERO, Fx::ZERO);
    let position = object.need("position", Node::point);
    let impulse = object.need("impulse", Node::number);
    let radius = object.or("radius", standard.radius, Node::number);
    let falloff = object.or("falloff", standard.falloff, Node::number);
    let mask = object.or("mask", standard.mask, |node| bits(node, "category"));
    object.finish()?;
    let explosion = Explosion { position: position?, radius, falloff, impulse: impulse?, mask };
    explosion.check().map_err(|error| {
        let fields: &[&str] = match error {
            Error::OutOfRange { quantity: Quantity::ExplosionImpulse } => &["impulse"],
            Error::OutOfRange { quantity: Quantity::ExplosionRadius }
                if Explosion { falloff: Fx::ZERO, ..explosion }.check().is_ok() =>
            {
                &["falloff"]
            }
            Error::OutOfRange { quantity: Quantity::ExplosionRadius } => &["radius"],
            _ => &["position"],
        };
        object.at(fields).fault(error)
    })?;
    Ok(explosion)
}

/// `at` one tick, or `from` one `to` another, `every` so many.
fn span(object: &Object<'_>) -> Result<(u64, u64, u64)> {
    let (name, node) = object.one_of(&["at", "from"])?;
    let first = node.whole();
    if name == "at" {
        let first = first?;
        return Ok((first, first, 1));
    }
    let (last, every) = (object.need("to", Node::whole), object.or("every", 1, Node::whole));
    object.finish()?;
    let (first, last): (u64, u64) = (first?, last?);
    if last < first {
        return Err(object.at(&["to"]).fault(
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
    let [has_force, has_torque, has_impulse, has_angular_impulse] =
        ["force", "torque", "impulse", "angular_impulse"].map(|name| object.has(name));
    let has_point = has_force || has_impulse;
    let is_any = has_point || has_torque || has_angular_impulse;
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
        ApplyOptions { frame: object.or("frame", Frame::World, frame), wake: object.or("wake", true, Node::boolean) };
    let point = object.or("point", None, |node| node.point().map(Some));
    let mut apply = |name, read: &dyn Fn(&Node<'_>) -> Result<ForceOrImpulse>| {
        object.or(name, (), |node| {
            let action = read(node)?;
            push(node, SceneAction::Command(Command::Apply { body: target, action, options }));
            Ok(())
        });
    };
    apply("force", &|node| Ok(ForceOrImpulse::Force { force: node.point()?, point }));
    apply("torque", &|node| node.number().map(ForceOrImpulse::Torque));
    apply("impulse", &|node| Ok(ForceOrImpulse::Impulse { impulse: node.point()?, point }));
    apply("angular_impulse", &|node| node.number().map(ForceOrImpulse::AngularImpulse));
    Ok(())
}

/// Reads a field of an object, if it is there, as the command that sets it.
fn set_by<'a>(
    object: &Object<'a>,
    name: &'static str,
    push: &mut impl FnMut(&Node<'_>, SceneAction),
    read: impl FnOnce(&Node<'a>) -> Result<Command>,
) {
    object.or(name, (), |node| {
        let command = read(node)?;
        push(node, SceneAction::Command(command));
        Ok(())
    });
}

fn set_body(object: &Object<'_>, body: BodyId, push: &mut impl FnMut(&Node<'_>, SceneAction)) -> Result<()> {
    set_by(object, "kind", push, |node| Ok(Command::SetKind { body, kind: kind(node)? }));
    if let Ok(Some(mass)) = mass(object) {
        push(object.at(&["mass"]), SceneAction::Command(Command::SetMass { body, mass }));
    }
    set_by(object, "position", push, |node| Ok(Command::SetPosition { body, position: node.point()? }));
    set_by(object, "angle", push, |node| Ok(Command::SetAngle { body, angle: node.number()? }));
    set_by(object, "velocity", push, |node| Ok(Command::SetVelocity { body, velocity: node.point()? }));
    set_by(object, "angular_velocity", push, |node| Ok(Command::SetAngularVelocity { body, velocity: node.number()? }));
    set_by(object, "gravity_scale", push, |node| Ok(Command::SetGravityScale { body, scale: node.number()? }));
    set_by(object, "damping", push, |node| {
        let (linear, angular) = own_damping(node)?;
        Ok(Command::SetBodyDamping { body, linear, angular })
    });
    set_by(object, "max_speeds", push, |node| {
        let (linear, angular) = max_speeds(node)?;
        Ok(Command::SetMaxSpeeds { body, linear, angular })
    });
    set_by(object, "locks", push, |node| Ok(Command::SetLocks { body, locks: locks(node)? }));
    set_by(object, "dominance", push, |node| Ok(Command::SetDominance { body, dominance: node.whole()? }));
    set_by(object, "bullet", push, |node| Ok(Command::SetBullet { body, bullet: node.boolean()? }));
    set_by(object, "force_groups", push, |node| {
        Ok(Command::SetForceGroups { body, force_groups: force_groups(node)? })
    });
    set_by(object, "key", push, |node| Ok(Command::SetKey { body, key: node.whole()? }));
    set_by(object, "user_data", push, |node| Ok(Command::SetUserData { body, user_data: node.whole()? }));
    object.finish()
}

fn set_world(object: &Object<'_>, push: &mut impl FnMut(&Node<'_>, SceneAction)) -> Result<()> {
    set_by(object, "time_step", push, |node| time_step(node).map(Command::SetTimeStep));
    set_by(object, "gravity", push, |node| node.point().map(Command::SetGravity));
    set_by(object, "integrator", push, |node| integrator(node).map(Command::SetIntegrator));
    set_by(object, "damping", push, |node| {
        let (linear, angular) = world_damping(node)?;
        Ok(Command::SetDamping { linear, angular })
    });
    set_by(object, "sleep_after", push, |node| sleep_after(node).map(Command::SetSleepAfter));
    set_by(object, "random", push, |node| random(node).map(Command::SetRandom));
    set_by(object, "blob", push, |node| blob(node).map(Command::SetBlob));
    set_by(object, "material_pair", push, |node| {
        let ([first, second], pair) = material_pair(&node.object()?, true)?;
        Ok(Command::SetMaterialPair { first, second, pair })
    });
    set_by(object, "contacts", push, |node| contacts(node).map(Command::SetContactSettings));
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
    /// # Ok::<(), umbra_scene::SceneErrors>(())
    /// ```
    #[must_use]
    pub const fn is_due(&self, tick: u64) -> bool {
        let every = if self.every == 0 { 1 } else { self.every };
        self.from <= tick && tick <= self.to && (tick - self.from) % every == 0
    }
}
