//! Writing scenes as text: exact decimals, a line for each body, force field, joint and input; defaults are left out.

mod collider;
mod joint;
mod json;

use alloc::string::{String, ToString};
use core::fmt::Display;

use super::field::{SceneField, factor_text, symbol};
use super::input::{Input, SceneAction};
use super::settings::{Plot, Trails};
use super::shape::{PartDef, ShapeDef};
use super::{Scene, SceneBody, SceneCollider, SceneJoint};
use collider::{collider_text, contacts_text, material_pair_text};
use joint::{kind_text, motor_text};
use json::{
    Fields, bits, dampings, hexadecimal, kind_name, linear_angular, lines, list, locked, null, point, ratio, text,
    ticks,
};
use umbra_physics::{
    Attachment, BodyDef, BodyId, BodyKind, ColliderId, Command, Damping, End, Exclusion, Explosion, FieldId, FieldKind,
    ForceField, Frame, Fx, Locks, Mass, Region, Vec2, WorldDef,
};

impl Scene {
    /// The scene as text, from which [`parse`](Self::parse) makes the same scene, but for places: every number has all its
    /// digits. Repetitions are written out, and each input does one thing.
    ///
    /// This holds for what was parsed or comes from [`from_commands`](Self::from_commands). A scene that was changed since may
    /// say what the format does not have: then `parse` refuses the text, and says where.
    #[must_use]
    pub fn to_json(&self) -> String {
        let WorldDef { time_step, gravity, integrator, linear_damping, angular_damping, sleep_after, contacts } =
            self.world;
        let standard: WorldDef = WorldDef::default();
        let damping = dampings(Some(linear_damping), Some(angular_damping));
        let bodies = self.bodies.iter().take(self.starting_bodies).map(SceneBody::text);
        let fields = self.fields.iter().take(self.starting_fields).map(|field| self.scene_field(field));
        let joints = self.joints.iter().take(self.starting_joints).map(|joint| self.scene_joint(joint));
        let inputs = self.inputs.iter().map(|input| self.input(input));
        let mut object = Fields::default();
        object.unless(self.title.is_empty(), "title", text(&self.title));
        object.unless(self.about.is_empty(), "about", text(&self.about));
        object.put("ticks", self.ticks);
        object.put("time_step", ratio(time_step));
        object.put("gravity", point(gravity));
        object.put("integrator", text(integrator.name()));
        object.unless((linear_damping, angular_damping) == (Damping::NONE, Damping::NONE), "damping", damping);
        object.unless(sleep_after == standard.sleep_after, "sleep_after", ticks(sleep_after));
        object.unless(contacts == standard.contacts, "contacts", contacts_text(&contacts));
        let pairs = self.material_pairs.iter().map(|pair| material_pair_text(pair.materials, Some(&pair.pair)));
        object.unless(self.material_pairs.is_empty(), "material_pairs", lines(pairs));
        object.unless(self.starting_bodies == 0, "bodies", lines(bodies));
        object.unless(self.starting_fields == 0, "fields", lines(fields));
        object.unless(self.starting_joints == 0, "joints", lines(joints));
        object.unless(self.inputs.is_empty(), "inputs", lines(inputs));
        object.unless(self.plot == Plot::default(), "plot", self.plot_text());
        object.lines()
    }

    /// `null` for what the scene does not have: nothing is read as a name of another.
    fn body_name(&self, body: BodyId) -> String {
        self.bodies.get(body.parts().0 as usize).map_or_else(null, |body| text(&body.name))
    }

    fn field_name(&self, field: FieldId) -> String {
        let name = self.fields.get(field.parts().0 as usize).and_then(|field| field.name.as_deref());
        name.map_or_else(null, text)
    }

    fn collider(&self, symbol: ColliderId) -> Option<&SceneCollider> {
        let (body, collider_index) = symbol.parts();
        self.bodies.get(body as usize)?.colliders.get(collider_index as usize)
    }

    fn collider_name(&self, symbol: ColliderId) -> String {
        self.collider(symbol).and_then(|collider| collider.name.as_deref()).map_or_else(null, text)
    }

    fn attachment(&self, at: &Attachment) -> String {
        if at.point == Vec2::ZERO {
            return self.body_name(at.body);
        }
        let mut object = Fields::default();
        object.put("body", self.body_name(at.body));
        object.put("point", point(at.point));
        object.line()
    }

    fn end(&self, end: &End) -> String {
        match end {
            End::World(place) => point(*place),
            End::Body(at) => self.attachment(at),
        }
    }

    fn scene_field(&self, field: &SceneField) -> String {
        self.field(field.name.as_deref().map_or_else(Fields::default, Fields::of_name), &field.field)
    }

    fn field(&self, mut object: Fields, field: &ForceField) -> String {
        let mut law = Fields::default();
        let name = match &field.kind {
            FieldKind::Attractor { centre, mu, softening } => {
                law.put("at", self.end(centre));
                law.put("mu", factor_text(*mu));
                law.unless(*softening == Fx::ZERO, "softening", softening);
                "attractor"
            }
            FieldKind::Spring { near, far, spring } => {
                law.put("from", self.attachment(near));
                law.put("to", self.end(far));
                law.unless(spring.rest == Fx::ZERO, "rest", spring.rest);
                law.put("stiffness", spring.stiffness);
                law.unless(spring.damping == Fx::ZERO, "damping", spring.damping);
                "spring"
            }
            FieldKind::Drag { linear, quadratic, wind } => {
                law.unless(*linear == Fx::ZERO, "linear", linear);
                law.unless(*quadratic == Fx::ZERO, "quadratic", quadratic);
                law.unless(*wind == Vec2::ZERO, "wind", point(*wind));
                "drag"
            }
            FieldKind::Friction { deceleration, angular_deceleration } => {
                law.unless(*deceleration == Fx::ZERO, "deceleration", deceleration);
                law.unless(*angular_deceleration == Fx::ZERO, "angular_deceleration", angular_deceleration);
                "friction"
            }
            FieldKind::Thrust { at, force } => {
                law.put("at", self.attachment(at));
                law.put("force", point(*force));
                "thrust"
            }
            FieldKind::Zone { region, acceleration } => {
                let mut parts = Fields::default();
                let kind = match *region {
                    Region::Disc { centre, radius } => {
                        parts.put("centre", point(centre));
                        parts.put("radius", radius);
                        "disc"
                    }
                    Region::Box { min, max } => {
                        parts.put("min", point(min));
                        parts.put("max", point(max));
                        "box"
                    }
                };
                law.put(kind, parts.line());
                law.put("acceleration", point(*acceleration));
                "zone"
            }
            FieldKind::Buoyancy { min, max, density, linear_drag, angular_drag, flow } => {
                let mut corners = Fields::default();
                corners.put("min", point(*min));
                corners.put("max", point(*max));
                law.put("box", corners.line());
                law.put("density", density);
                law.unless(*linear_drag == Fx::ZERO, "linear_drag", linear_drag);
                law.unless(*angular_drag == Fx::ZERO, "angular_drag", angular_drag);
                law.unless(*flow == Vec2::ZERO, "flow", point(*flow));
                "buoyancy"
            }
            // No scene has one: it is refused where it stands.
            FieldKind::Custom { id } => {
                law.put("id", id);
                "custom"
            }
            // All there are stand above: `tests/layers.rs` compares the lists.
            _ => "unknown",
        };
        object.put(name, law.line());
        object.unless(field.force_groups == u32::MAX, "force_groups", bits(field.force_groups));
        object.line()
    }

    fn input(&self, input: &Input) -> String {
        let mut object = Fields::default();
        if input.from == input.to && input.every == 1 {
            object.put("at", input.from);
        } else {
            object.put("from", input.from);
            object.put("to", input.to);
            object.unless(input.every == 1, "every", input.every);
        }
        match &input.action {
            SceneAction::Command(command) => self.command(&mut object, command),
            SceneAction::AddBody(index) => {
                object.put("add", self.bodies.get(*index).map_or_else(String::new, SceneBody::text));
            }
            SceneAction::AddField(index) => {
                let field = self.fields.get(*index);
                object.put("add_field", field.map_or_else(String::new, |field| self.scene_field(field)));
            }
            SceneAction::AddJoint(index) => {
                let joint = self.joints.get(*index);
                object.put("add_joint", joint.map_or_else(String::new, |joint| self.scene_joint(joint)));
            }
            SceneAction::AddCollider(symbol) => {
                object.put("body", self.body_name(BodyId::from_parts(symbol.parts().0, 0)));
                object.put("add_collider", self.collider(*symbol).map_or_else(String::new, SceneCollider::text));
            }
        }
        object.line()
    }

    fn set_body(&self, object: &mut Fields, body: BodyId, property: &str, value: impl Display) {
        object.put("body", self.body_name(body));
        object.put("set", Fields::of(property, value));
    }

    fn do_to_body(&self, object: &mut Fields, body: BodyId, what: &str) {
        object.put("body", self.body_name(body));
        object.put("do", text(what));
    }

    fn command(&self, object: &mut Fields, command: &Command) {
        let set = |object: &mut Fields, property, value: String| object.put("set", Fields::of(property, value));
        match *command {
            // A scene has actions of its own for these. A body that a command adds has no name, without which none is read.
            Command::AddBody(ref def) => {
                let colliders = def.colliders.iter().map(|def| collider_text(Fields::default(), def));
                object.put("add", body_text(Fields::default(), def, colliders));
            }
            Command::AddField(ref field) => object.put("add_field", self.field(Fields::default(), field)),
            Command::RemoveBody(body) => self.do_to_body(object, body, "remove"),
            Command::Wake(body) => self.do_to_body(object, body, "wake"),
            Command::Sleep(body) => self.do_to_body(object, body, "sleep"),
            Command::Release(body) => self.do_to_body(object, body, "release"),
            Command::Disable(body) => self.do_to_body(object, body, "disable"),
            Command::Enable(body) => self.do_to_body(object, body, "enable"),
            Command::MoveTo { body, position, angle } => {
                object.put("body", self.body_name(body));
                let mut goal = Fields::default();
                goal.put("position", point(position));
                goal.unless(angle == Fx::ZERO, "angle", angle);
                object.put("move_to", goal.line());
            }
            Command::Apply { body, action, options } => {
                object.put("body", self.body_name(body));
                object.action(action);
                object.unless(options.frame == Frame::World, "frame", text("body"));
                object.unless(options.wake, "wake", options.wake);
            }
            Command::SetKind { body, kind } => self.set_body(object, body, "kind", text(kind_name(kind))),
            Command::SetMass { body, mass } => {
                object.put("body", self.body_name(body));
                let mut fields = Fields::default();
                fields.mass(mass);
                object.put("set", fields.line());
            }
            Command::SetPosition { body, position } => self.set_body(object, body, "position", point(position)),
            Command::SetAngle { body, angle } => self.set_body(object, body, "angle", angle),
            Command::SetVelocity { body, velocity } => self.set_body(object, body, "velocity", point(velocity)),
            Command::SetAngularVelocity { body, velocity } => {
                self.set_body(object, body, "angular_velocity", velocity);
            }
            Command::SetGravityScale { body, scale } => self.set_body(object, body, "gravity_scale", scale),
            Command::SetBodyDamping { body, linear, angular } => {
                self.set_body(object, body, "damping", dampings(linear, angular));
            }
            Command::SetMaxSpeeds { body, linear, angular } => {
                self.set_body(object, body, "max_speeds", linear_angular(linear, angular));
            }
            Command::SetLocks { body, locks } => self.set_body(object, body, "locks", locked(locks)),
            Command::SetDominance { body, dominance } => self.set_body(object, body, "dominance", dominance),
            Command::SetBullet { body, bullet } => self.set_body(object, body, "bullet", bullet),
            Command::SetForceGroups { body, force_groups } => {
                self.set_body(object, body, "force_groups", bits(force_groups))
            }
            Command::SetKey { body, key } => self.set_body(object, body, "key", key),
            Command::SetUserData { body, user_data } => self.set_body(object, body, "user_data", user_data),
            Command::SetField { id, ref field } => {
                object.put("field", self.field_name(id));
                object.put("replace", self.field(Fields::default(), field));
            }
            Command::RemoveField(id) => {
                object.put("field", self.field_name(id));
                object.put("do", text("remove"));
            }
            Command::ClearForces => object.put("do", text("clear_forces")),
            Command::Explode(explosion) => {
                let standard = Explosion::new(explosion.position, explosion.impulse);
                let mut fields = Fields::default();
                fields.put("position", point(explosion.position));
                fields.unless(explosion.radius == standard.radius, "radius", explosion.radius);
                fields.unless(explosion.falloff == standard.falloff, "falloff", explosion.falloff);
                fields.put("impulse", explosion.impulse);
                fields.unless(explosion.mask == standard.mask, "mask", bits(explosion.mask));
                object.put("explode", fields.line());
            }
            Command::SetTimeStep(time_step) => set(object, "time_step", ratio(time_step)),
            Command::SetGravity(gravity) => set(object, "gravity", point(gravity)),
            Command::SetIntegrator(integrator) => set(object, "integrator", text(integrator.name())),
            Command::SetDamping { linear, angular } => {
                set(object, "damping", dampings(Some(linear), Some(angular)));
            }
            Command::SetSleepAfter(after) => set(object, "sleep_after", ticks(after)),
            Command::SetRandom(random) => set(object, "random", list(random.state())),
            Command::AddCollider { body, ref def } => {
                object.put("body", self.body_name(body));
                object.put("add_collider", collider_text(Fields::default(), def));
            }
            Command::SetCollider { collider, ref def } => {
                object.put("collider", self.collider_name(collider));
                object.put("replace", collider_text(Fields::default(), def));
            }
            Command::RemoveCollider(collider) => {
                object.put("collider", self.collider_name(collider));
                object.put("do", text("remove"));
            }
            Command::ExcludePair { a, b, exclusion } => {
                let word = if exclusion == Exclusion::UntilApart { "exclude_until_apart" } else { "exclude" };
                object.put("body", self.body_name(a));
                object.put(word, self.body_name(b));
            }
            Command::AllowPair { a, b } => {
                object.put("body", self.body_name(a));
                object.put("allow", self.body_name(b));
            }
            Command::SetMaterialPair { first, second, ref pair } => {
                set(object, "material_pair", material_pair_text([first, second], pair.as_ref()));
            }
            Command::SetContactSettings(contacts) => set(object, "contacts", contacts_text(&contacts)),
            Command::SetBlob(ref bytes) => set(object, "blob", hexadecimal(bytes)),
            Command::AddJoint(ref def) => object.put("add_joint", self.joint(Fields::default(), def)),
            Command::RemoveJoint(joint) => self.do_to_joint(object, joint, "remove"),
            Command::EnableJoint { joint, enabled } => {
                self.do_to_joint(object, joint, if enabled { "enable" } else { "disable" });
            }
            Command::SetJointKind { joint, ref kind } => self.set_joint(object, joint, "kind", kind_text(kind)),
            Command::SetJointMotor { joint, motor } => {
                self.set_joint(object, joint, "motor", motor.as_ref().map_or_else(null, motor_text));
            }
            Command::SetJointBreak { joint, force } => {
                self.set_joint(object, joint, "break_force", force.map_or_else(null, |force| force.to_string()));
            }
            Command::SetJointBreakTorque { joint, torque } => {
                self.set_joint(object, joint, "break_torque", torque.map_or_else(null, |torque| torque.to_string()));
            }
            // All there are stand above: `tests/layers.rs` compares the lists.
            _ => {}
        }
    }

    fn plot_text(&self) -> String {
        let Plot { view, trails, exposures } = &self.plot;
        let mut object = Fields::default();
        if let Some([min, max]) = view {
            object.put("view", list([point(*min), point(*max)]));
        }
        match trails {
            Trails::All => {}
            Trails::None => object.put("trails", text("none")),
            Trails::Of(bodies) => {
                let name = |&index: &usize| self.body_name(symbol(index));
                object.put("trails", list(bodies.iter().map(name)));
            }
        }
        object.unless(*exposures == 0, "exposures", exposures);
        object.line()
    }
}

impl SceneBody {
    fn text(&self) -> String {
        let colliders = self.colliders.iter().take(self.starting_colliders).map(SceneCollider::text);
        body_text(Fields::of_name(&self.name), &self.def, colliders)
    }
}

fn body_text(mut object: Fields, def: &BodyDef, colliders: impl ExactSizeIterator<Item = String>) -> String {
    object.unless(def.kind == BodyKind::Dynamic, "kind", text(kind_name(def.kind)));
    object.unless(def.position == Vec2::ZERO, "position", point(def.position));
    object.unless(def.angle == Fx::ZERO, "angle", def.angle);
    object.unless(def.velocity == Vec2::ZERO, "velocity", point(def.velocity));
    object.unless(def.angular_velocity == Fx::ZERO, "angular_velocity", def.angular_velocity);
    object.unless(colliders.len() == 0, "colliders", list(colliders));
    if def.mass != Mass::default() {
        object.mass(def.mass);
    }
    object.unless(def.gravity_scale == Fx::ONE, "gravity_scale", def.gravity_scale);
    let own_dampings = (def.linear_damping, def.angular_damping);
    object.unless(own_dampings == (None, None), "damping", dampings(own_dampings.0, own_dampings.1));
    let max_speeds = (def.max_speed, def.max_angular_speed);
    object.unless(max_speeds == (None, None), "max_speeds", linear_angular(max_speeds.0, max_speeds.1));
    object.unless(def.locks == Locks::NONE, "locks", locked(def.locks));
    object.unless(def.dominance == 0, "dominance", def.dominance);
    object.unless(!def.bullet, "bullet", def.bullet);
    object.unless(def.force_groups == 1, "force_groups", bits(def.force_groups));
    object.unless(def.key == 0, "key", def.key);
    object.unless(def.user_data == 0, "user_data", def.user_data);
    object.line()
}

impl ShapeDef {
    fn text(&self) -> String {
        let mut inner = Fields::default();
        let (name, inner) = match self {
            Self::Circle { radius } => {
                inner.put("radius", radius);
                ("circle", inner.line())
            }
            Self::Rectangle { width, height } => {
                inner.put("width", width);
                inner.put("height", height);
                ("rectangle", inner.line())
            }
            Self::Capsule { length, radius } => {
                inner.put("length", length);
                inner.put("radius", radius);
                ("capsule", inner.line())
            }
            Self::Polygon { corners } => ("polygon", list(corners.iter().copied().map(point))),
            Self::RoundedPolygon { corners, radius } => {
                inner.put("corners", list(corners.iter().copied().map(point)));
                inner.put("radius", radius);
                ("rounded_polygon", inner.line())
            }
            Self::Segment { ends } => ("segment", list(ends.map(point))),
            Self::Compound { parts } => ("compound", list(parts.iter().map(PartDef::text))),
            Self::Chain { points, closed } => {
                inner.put("points", list(points.iter().copied().map(point)));
                inner.unless(!closed, "closed", closed);
                ("chain", inner.line())
            }
        };
        Fields::of(name, inner)
    }
}

impl PartDef {
    fn text(&self) -> String {
        let mut object = Fields::default();
        object.put("shape", self.shape.text());
        object.unless(self.position == Vec2::ZERO, "position", point(self.position));
        object.unless(self.angle == Fx::ZERO, "angle", self.angle);
        object.unless(self.density == Fx::ONE, "density", self.density);
        object.line()
    }
}
