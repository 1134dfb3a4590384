//! Commands in words.

use umbra_physics::{
    BodyId, BodyKind, ColliderId, Command, Damping, Exclusion, FieldId, FieldKind, ForceField, ForceOrImpulse, Frame,
    Fx, Locks, Mass, Vec2,
};
use umbra_scene::{Scene, SceneAction};

use crate::text::counted;

/// The names of bodies, force fields and colliders.
pub(crate) struct Names<B, F, C> {
    pub(crate) body: B,
    pub(crate) field: F,
    pub(crate) collider: C,
}

/// An input in words, and its topic: the same for all inputs that differ in their values alone.
pub(super) struct Words {
    pub(super) topic: String,
    pub(super) text: String,
}

/// A command in words.
pub(super) fn command<B, F, C>(command: &Command<Fx>, names: &Names<B, F, C>) -> Words
where
    B: Fn(BodyId) -> String,
    F: Fn(FieldId) -> String,
    C: Fn(ColliderId) -> String,
{
    let text = command_text(command, names);
    let topic = match command {
        Command::AddBody(def) => format!("add a {} body", kind(def.kind)),
        Command::Apply { body, action, .. } => format!("{} on {}", act_topic(action), (names.body)(*body)),
        Command::SetPosition { body, .. } => format!("put {}", (names.body)(*body)),
        Command::SetAngle { body, .. } => format!("turn {}", (names.body)(*body)),
        Command::MoveTo { body, .. } => format!("move {}", (names.body)(*body)),
        Command::Explode(_) => "an explosion".to_owned(),
        Command::SetBlob(_) => "a blob".to_owned(),
        // The texts of settings have their values behind this.
        Command::SetVelocity { .. } | Command::SetAngularVelocity { .. } => {
            text.rsplit_once(": ").map_or_else(|| text.clone(), |(topic, _)| topic.to_owned())
        }
        _ => text.clone(),
    };
    Words { topic, text }
}

fn act_topic(action: &ForceOrImpulse) -> &'static str {
    match action {
        ForceOrImpulse::Force { .. } => "force",
        ForceOrImpulse::Torque(_) => "torque",
        ForceOrImpulse::Impulse { .. } => "impulse",
        ForceOrImpulse::AngularImpulse(_) => "angular impulse",
    }
}

fn command_text<B, F, C>(command: &Command<Fx>, names: &Names<B, F, C>) -> String
where
    B: Fn(BodyId) -> String,
    F: Fn(FieldId) -> String,
    C: Fn(ColliderId) -> String,
{
    let name_of = |body: &BodyId| (names.body)(*body);
    match command {
        Command::AddBody(def) => format!("add a {} body at {} m", kind(def.kind), vector(def.position)),
        Command::RemoveBody(body) => format!("remove {}", name_of(body)),
        Command::Apply { body, action, options } => {
            let frame = if options.frame == Frame::Body { ", in its frame" } else { "" };
            let wake = if options.wake { "" } else { ", without waking it" };
            format!("{} on {}{frame}{wake}", act(action), name_of(body))
        }
        Command::SetPosition { body, position } => format!("put {} at {} m", name_of(body), vector(*position)),
        Command::SetAngle { body, angle } => format!("turn {} to {} rad", name_of(body), short(*angle)),
        Command::SetVelocity { body, velocity } => format!("velocity of {}: {} m/s", name_of(body), vector(*velocity)),
        Command::SetAngularVelocity { body, velocity } => {
            format!("angular velocity of {}: {} rad/s", name_of(body), short(*velocity))
        }
        Command::SetMass { body, mass } => format!("mass of {}: {}", name_of(body), weight(*mass)),
        Command::SetKind { body, kind: to } => format!("make {} {}", name_of(body), kind(*to)),
        Command::SetGravityScale { body, scale } => format!("gravity scale of {}: {}", name_of(body), short(*scale)),
        Command::SetBodyDamping { body, linear, angular } => {
            let damping_text = |damping: Option<Damping>| damping.map_or("the world's".to_owned(), damped);
            format!(
                "damping of {}: linear {}, angular {}",
                name_of(body),
                damping_text(*linear),
                damping_text(*angular)
            )
        }
        Command::SetMaxSpeeds { body, linear, angular } => {
            let limit =
                |limit: Option<Fx>, unit| limit.map_or("any".to_owned(), |limit| format!("{} {unit}", short(limit)));
            format!("largest speeds of {}: {}, {}", name_of(body), limit(*linear, "m/s"), limit(*angular, "rad/s"))
        }
        Command::SetLocks { body, locks } => format!("locks of {}: {}", name_of(body), locked(*locks)),
        Command::SetDominance { body, dominance } => format!("dominance of {}: {dominance}", name_of(body)),
        Command::SetBullet { body, bullet: true } => format!("make {} a bullet", name_of(body)),
        Command::SetBullet { body, bullet: false } => format!("make {} no bullet", name_of(body)),
        Command::SetForceGroups { body, force_groups } => {
            format!("force groups of {}: {force_groups:#x}", name_of(body))
        }
        Command::SetKey { body, key } => format!("key of {}: {key}", name_of(body)),
        Command::SetUserData { body, user_data } => format!("user data of {}: {user_data}", name_of(body)),
        Command::Wake(body) => format!("wake {}", name_of(body)),
        Command::Sleep(body) => format!("put {} to sleep", name_of(body)),
        Command::Release(body) => format!("release {}", name_of(body)),
        Command::MoveTo { body, position, angle } => {
            format!("move {} to {} m, {} rad", name_of(body), vector(*position), short(*angle))
        }
        Command::Disable(body) => format!("disable {}", name_of(body)),
        Command::Enable(body) => format!("enable {}", name_of(body)),
        Command::AddField(field) => format!("add {}", field_words(field)),
        Command::SetField { id, field } => format!("in place of {}: {}", (names.field)(*id), field_words(field)),
        Command::RemoveField(field) => format!("remove {}", (names.field)(*field)),
        Command::Explode(explosion) => {
            format!("an explosion at {} m: {} N·s/m", vector(explosion.position), short(explosion.impulse))
        }
        Command::SetTimeStep(step) => {
            let (num, den) = step.seconds();
            format!("time step: {num}/{den} s")
        }
        Command::SetGravity(gravity) => format!("gravity: {} m/s²", vector(*gravity)),
        Command::SetIntegrator(integrator) => format!("integrator: {}", integrator.name()),
        Command::SetDamping { linear, angular } => {
            format!("damping: linear {}, angular {}", damped(*linear), damped(*angular))
        }
        Command::SetSleepAfter(Some(ticks)) => format!("sleep after {}", counted((*ticks).into(), ["tick", "ticks"])),
        Command::SetSleepAfter(None) => "no sleep".to_owned(),
        Command::SetRandom(_) => "another state of the generator".to_owned(),
        Command::SetBlob(bytes) => format!("a blob of {} bytes", bytes.len()),
        Command::AddCollider { body, def } => {
            format!("add a collider to {} at {} m", name_of(body), vector(def.position))
        }
        Command::SetCollider { collider, .. } => {
            format!("another definition for {}", (names.collider)(*collider))
        }
        Command::RemoveCollider(collider) => format!("remove {}", (names.collider)(*collider)),
        Command::ExcludePair { a, b, exclusion } => {
            let until = if *exclusion == Exclusion::UntilApart { " until they are apart" } else { "" };
            format!("no contacts of {} and {}{until}", name_of(a), name_of(b))
        }
        Command::AllowPair { a, b } => format!("contacts of {} and {} again", name_of(a), name_of(b)),
        Command::SetContactSettings(contacts) => format!("contacts: {} sub-steps", contacts.substeps),
        Command::SetMaterialPair { first, second, pair: Some(pair) } => {
            format!("materials {first} and {second}: friction {}", pair.friction)
        }
        Command::SetMaterialPair { first, second, pair: None } => {
            format!("materials {first} and {second}: no coefficients of their own")
        }
        // One that this version does not know; its name at least.
        command => format!("{command:?}").chars().take_while(char::is_ascii_alphanumeric).collect(),
    }
}

/// Says in words what an input of a scene does.
pub(super) fn action(scene: &Scene, action: &SceneAction) -> Words {
    // The handles in it are indices.
    let body = |id: BodyId| scene.bodies.get(id.parts().0 as usize).map_or(id.to_string(), |body| body.name.clone());
    let field = |id: FieldId| {
        let name = scene.fields.get(id.parts().0 as usize).and_then(|field| field.name.clone());
        name.unwrap_or_else(|| id.to_string())
    };
    let collider_name = |id: ColliderId| {
        let (index, part) = id.parts();
        let colliders = scene.bodies.get(index as usize).map(|body| &body.colliders);
        colliders.and_then(|colliders| colliders.get(part as usize)?.name.clone())
    };
    let collider = |id: ColliderId| collider_name(id).unwrap_or_else(|| "a collider".to_owned());
    let text = match action {
        SceneAction::Command(what) => return command(what, &Names { body, field, collider }),
        SceneAction::AddBody(index) => format!("add {}", body(BodyId::from_parts(*index as u32, 0))),
        SceneAction::AddField(index) => {
            let added = &scene.fields[*index];
            added
                .name
                .as_ref()
                .map_or_else(|| format!("add {}", field_words(&added.field)), |name| format!("add {name}"))
        }
        SceneAction::AddCollider(symbol) => {
            format!("add {} to {}", collider(*symbol), body(BodyId::from_parts(symbol.parts().0, 0)))
        }
        action => format!("{action:?}").chars().take_while(char::is_ascii_alphanumeric).collect(),
    };
    Words { topic: text.clone(), text }
}

fn act(action: &ForceOrImpulse) -> String {
    let at = |point: &Option<Vec2>| point.map_or(String::new(), |point| format!(" at {} m", vector(point)));
    match action {
        ForceOrImpulse::Force { force, point } => format!("force {} N{}", vector(*force), at(point)),
        ForceOrImpulse::Torque(torque) => format!("torque {} N·m", short(*torque)),
        ForceOrImpulse::Impulse { impulse, point } => format!("impulse {} N·s{}", vector(*impulse), at(point)),
        ForceOrImpulse::AngularImpulse(impulse) => format!("angular impulse {} N·m·s", short(*impulse)),
    }
}

fn kind(kind: BodyKind) -> &'static str {
    match kind {
        BodyKind::Static => "static",
        BodyKind::Kinematic => "kinematic",
        BodyKind::Dynamic => "dynamic",
    }
}

fn locked(locks: Locks) -> String {
    if locks == Locks::NONE { "none".to_owned() } else { locks.names().collect::<Vec<_>>().join(", ") }
}

fn field_words(field: &ForceField) -> &'static str {
    match field.kind {
        FieldKind::Attractor { .. } => "an attractor",
        FieldKind::Spring { .. } => "a spring",
        FieldKind::Drag { .. } => "a drag",
        FieldKind::Friction { .. } => "a friction",
        FieldKind::Thrust { .. } => "a thrust",
        FieldKind::Zone { .. } => "a zone",
        FieldKind::Buoyancy { .. } => "a fluid",
        FieldKind::Custom { .. } => "a custom force",
        _ => "a force field",
    }
}

fn weight(mass: Mass) -> String {
    match mass {
        Mass::Kilograms(mass) => format!("{} kg", short(mass)),
        Mass::Explicit { mass, inertia } => format!("{} kg, {} kg·m²", short(mass), short(inertia)),
        Mass::FromColliders => "that of its colliders".to_owned(),
    }
}

fn vector(v: Vec2) -> String {
    format!("({}, {})", short(v.x), short(v.y))
}

fn damped(damping: Damping) -> String {
    match damping.strong_rate() {
        Some(rate) => format!("{}/s", short(rate)),
        None if damping == Damping::NONE => "none".to_owned(),
        None => format!("keeps {} a second", short(damping.kept())),
    }
}

/// The exact text if it is short, or if six digits after the point would be zeros; else these.
pub(super) fn short(value: Fx) -> String {
    let (exact, rounded) = (value.to_string(), format!("{value:.6}"));
    if exact.len() <= 9 || !rounded.contains(|digit| ('1'..='9').contains(&digit)) {
        return exact;
    }
    rounded.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_not_lost() {
        let texts = [Fx::ZERO, Fx::from_bits(-(3 << 31)), Fx::from_bits(0x1999_999a), Fx::DELTA].map(short);
        assert_eq!(texts, ["0", "-1.5", "0.1", "0.00000000023283064365386962890625"]);
    }
}
