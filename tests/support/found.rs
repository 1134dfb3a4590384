//! Values read by the tables of `docs/formats.md`, in the form that the library has: by the names of fields and cases.

use umbra_physics::{
    Activity, ApplyOptions, Attachment, BodyDef, BodyId, BodyKind, ColliderDef, ColliderId, Command, ContactSettings,
    Damping, Distance, End, Exclusion, Explosion, FieldId, FieldKind, Filter, ForceField, ForceOrImpulse, Frame, Fx,
    FxFactor, Gear, Integrator, JointDef, JointId, JointKind, JointLimits, JointMotor, JointSpring, Locks, Mass,
    Material, MaterialPair, MixRule, Motor, OneWay, Part, PlanarMotor, PlanarSpring, Prismatic, Pulley, Random, Region,
    Revolute, Shape, SpringConstants, TimeStep, Vec2, Weld, Wheel,
};

use super::layouts::Value;

pub(crate) fn number(value: &Value) -> Fx {
    Fx::from_bits(value.integer() as i64)
}

pub(crate) fn damping(value: &Value) -> Damping {
    Damping::from_number(number(value))
}

pub(crate) fn vector(value: &Value) -> Vec2 {
    Vec2::new(number(&value["x"]), number(&value["y"]))
}

pub(crate) fn body(value: &Value) -> BodyId {
    BodyId::from_parts(value["slot"].natural() as u32, value["generation"].natural() as u32)
}

pub(crate) fn field_id(value: &Value) -> FieldId {
    FieldId::from_parts(value["slot"].natural() as u32, value["generation"].natural() as u32)
}

pub(crate) fn kind(value: &Value) -> BodyKind {
    match value.case() {
        "Static" => BodyKind::Static,
        "Kinematic" => BodyKind::Kinematic,
        "Dynamic" => BodyKind::Dynamic,
        name => panic!("kind {name}"),
    }
}

pub(crate) fn activity(value: &Value) -> Activity {
    match value.case() {
        "Awake" => Activity::Awake,
        "Asleep" => Activity::Asleep,
        "Quarantined" => Activity::Quarantined,
        "Disabled" => Activity::Disabled,
        name => panic!("activity {name}"),
    }
}

pub(crate) fn locks(value: &Value) -> Locks {
    let is = |axis: &str| value[axis].natural() == 1;
    Locks { x: is("x"), y: is("y"), rotation: is("rotation") }
}

fn mix_rule(value: &Value) -> MixRule {
    match value.case() {
        "Standard" => MixRule::Standard,
        "GeometricMean" => MixRule::GeometricMean,
        "Mean" => MixRule::Mean,
        "Minimum" => MixRule::Minimum,
        "Product" => MixRule::Product,
        "Maximum" => MixRule::Maximum,
        name => panic!("mix rule {name}"),
    }
}

pub(crate) fn integrator(value: &Value) -> Integrator {
    match value.case() {
        "ExplicitEuler" => Integrator::ExplicitEuler,
        "SymplecticEuler" => Integrator::SymplecticEuler,
        "VelocityVerlet" => Integrator::VelocityVerlet,
        "PublishedVerlet" => Integrator::PublishedVerlet,
        "Yoshida4" => Integrator::Yoshida4,
        name => panic!("integrator {name}"),
    }
}

pub(crate) fn time_step(value: &Value) -> TimeStep {
    TimeStep::ratio(value["num"].natural() as u32, value["den"].natural() as u32)
}

pub(crate) fn random(value: &Value) -> Random {
    Random::from_state(value.words()).expect("a state")
}

pub(crate) fn mass(value: &Value) -> Mass {
    match value.case() {
        "Kilograms" => Mass::Kilograms(number(&value["mass"])),
        "FromColliders" => Mass::FromColliders,
        "Explicit" => Mass::Explicit { mass: number(&value["mass"]), inertia: number(&value["inertia"]) },
        name => panic!("mass {name}"),
    }
}

pub(crate) fn shape(value: &Value) -> Shape {
    let part = |part: &Value| Part {
        shape: shape(&part["shape"]),
        position: vector(&part["position"]),
        angle: number(&part["angle"]),
        density: number(&part["density"]),
    };
    let shape = match value.case() {
        "Circle" => Shape::circle(number(&value["radius"])),
        "Rectangle" => Shape::rectangle(number(&value["width"]), number(&value["height"])),
        "Capsule" => Shape::capsule(number(&value["length"]), number(&value["radius"])),
        "Polygon" => Shape::polygon(&value["corners"].list().iter().map(vector).collect::<Vec<_>>()),
        "Segment" => Shape::segment(vector(&value["a"]), vector(&value["b"])),
        "RoundedPolygon" => {
            let corners: Vec<_> = value["corners"].list().iter().map(vector).collect();
            Shape::rounded_polygon(&corners, number(&value["radius"]))
        }
        "Chain" => {
            let points: Vec<_> = value["points"].list().iter().map(vector).collect();
            Shape::chain(&points, value["closed"].natural() == 1)
        }
        "Compound" => Shape::compound(&value["parts"].list().iter().map(part).collect::<Vec<_>>()),
        name => panic!("shape {name}"),
    };
    shape.expect("a shape")
}

pub(crate) fn attachment(value: &Value) -> Attachment {
    Attachment { body: body(&value["body"]), point: vector(&value["point"]) }
}

pub(crate) fn end(value: &Value) -> End {
    match value.case() {
        "World" => End::World(vector(&value["point"])),
        "Body" => End::Body(attachment(&value["attachment"])),
        name => panic!("end {name}"),
    }
}

pub(crate) fn region(value: &Value) -> Region {
    match value.case() {
        "Disc" => Region::Disc { centre: vector(&value["centre"]), radius: number(&value["radius"]) },
        "Box" => Region::Box { min: vector(&value["min"]), max: vector(&value["max"]) },
        name => panic!("region {name}"),
    }
}

/// mantissa · 2^-shift.
pub(crate) fn factor(value: &Value) -> FxFactor {
    let [shift, mantissa] = value.words();
    assert!(mantissa >> 63 == 1 && shift < 64, "{mantissa} and {shift}");
    FxFactor::from_ratio(mantissa, 1 << shift)
}

pub(crate) fn field(value: &Value) -> ForceField {
    let law = &value["kind"];
    let spring = |value: &Value| SpringConstants {
        rest: number(&value["rest"]),
        stiffness: number(&value["stiffness"]),
        damping: number(&value["damping"]),
    };
    let kind = match law.case() {
        "Attractor" => FieldKind::Attractor {
            centre: end(&law["centre"]),
            mu: factor(&law["mu"]),
            softening: number(&law["softening"]),
        },
        "Spring" => {
            FieldKind::Spring { near: attachment(&law["near"]), far: end(&law["far"]), spring: spring(&law["spring"]) }
        }
        "Drag" => FieldKind::Drag {
            linear: number(&law["linear"]),
            quadratic: number(&law["quadratic"]),
            wind: vector(&law["wind"]),
        },
        "Friction" => FieldKind::Friction {
            deceleration: number(&law["deceleration"]),
            angular_deceleration: number(&law["angular_deceleration"]),
        },
        "Thrust" => FieldKind::Thrust { at: attachment(&law["at"]), force: vector(&law["force"]) },
        "Zone" => FieldKind::Zone { region: region(&law["region"]), acceleration: vector(&law["acceleration"]) },
        "Custom" => FieldKind::Custom { id: law["id"].natural() },
        "Buoyancy" => FieldKind::Buoyancy {
            min: vector(&law["min"]),
            max: vector(&law["max"]),
            density: number(&law["density"]),
            linear_drag: number(&law["linear_drag"]),
            angular_drag: number(&law["angular_drag"]),
            flow: vector(&law["flow"]),
        },
        name => panic!("law {name}"),
    };
    ForceField { kind, force_groups: value["force_groups"].natural() as u32 }
}

pub(crate) fn action(value: &Value) -> ForceOrImpulse {
    let point = || value["point"].option().map(vector);
    match value.case() {
        "Force" => ForceOrImpulse::Force { force: vector(&value["force"]), point: point() },
        "Torque" => ForceOrImpulse::Torque(number(&value["torque"])),
        "Impulse" => ForceOrImpulse::Impulse { impulse: vector(&value["impulse"]), point: point() },
        "AngularImpulse" => ForceOrImpulse::AngularImpulse(number(&value["impulse"])),
        name => panic!("action {name}"),
    }
}

pub(crate) fn options(value: &Value) -> ApplyOptions {
    let frame = match value["frame"].case() {
        "World" => Frame::World,
        "Body" => Frame::Body,
        name => panic!("frame {name}"),
    };
    ApplyOptions { frame, wake: value["wake"].natural() == 1 }
}

pub(crate) fn collider(value: &Value) -> ColliderId {
    ColliderId::from_parts(value["slot"].natural() as u32, value["generation"].natural() as u32)
}

pub(crate) fn collider_def(value: &Value) -> ColliderDef {
    let (material, filter) = (&value["material"], &value["filter"]);
    ColliderDef {
        shape: shape(&value["shape"]),
        position: vector(&value["position"]),
        angle: number(&value["angle"]),
        density: number(&value["density"]),
        material: Material {
            friction: number(&material["friction"]),
            restitution: number(&material["restitution"]),
            rolling_resistance: number(&material["rolling_resistance"]),
            surface_speed: number(&material["surface_speed"]),
            friction_rule: mix_rule(&material["friction_rule"]),
            restitution_rule: mix_rule(&material["restitution_rule"]),
            id: material["id"].natural() as u32,
        },
        filter: Filter {
            category: filter["category"].natural() as u32,
            mask: filter["mask"].natural() as u32,
            group: filter["group"].natural() as u32 as i32,
        },
        one_way: value["one_way"].option().map(|one_way| OneWay {
            direction: vector(&one_way["direction"]),
            tolerance: number(&one_way["tolerance"]),
        }),
        sensor: value["sensor"].natural() == 1,
        contact_events: value["contact_events"].natural() == 1,
        hit_events: value["hit_events"].natural() == 1,
        key: value["key"].natural(),
        user_data: value["user_data"].natural(),
    }
}

fn joint(value: &Value) -> JointId {
    JointId::from_parts(value["slot"].natural() as u32, value["generation"].natural() as u32)
}

fn joint_limits(value: &Value) -> JointLimits {
    JointLimits { lower: number(&value["lower"]), upper: number(&value["upper"]) }
}

fn joint_motor(value: &Value) -> JointMotor {
    JointMotor { speed: number(&value["speed"]), max_force: number(&value["max_force"]) }
}

fn joint_spring(value: &Value) -> JointSpring {
    JointSpring {
        hertz: number(&value["hertz"]),
        damping_ratio: number(&value["damping_ratio"]),
        rest: number(&value["rest"]),
        max_force: value["max_force"].option().map(number),
    }
}

fn joint_kind(value: &Value) -> JointKind {
    match value.case() {
        "Revolute" => JointKind::Revolute(Revolute {
            limits: value["limits"].option().map(joint_limits),
            motor: value["motor"].option().map(joint_motor),
            spring: value["spring"].option().map(joint_spring),
            friction: number(&value["friction"]),
            ratchet: value["ratchet"].option().map(|teeth| teeth.natural() as u16 as i16),
        }),
        "Weld" => JointKind::Weld(Weld { spring: value["spring"].option().map(joint_spring) }),
        "Distance" => JointKind::Distance(Distance {
            limits: value["limits"].option().map(joint_limits),
            motor: value["motor"].option().map(joint_motor),
            spring: value["spring"].option().map(joint_spring),
            friction: number(&value["friction"]),
        }),
        "Prismatic" => JointKind::Prismatic(Prismatic {
            limits: value["limits"].option().map(joint_limits),
            motor: value["motor"].option().map(joint_motor),
            spring: value["spring"].option().map(joint_spring),
            friction: number(&value["friction"]),
        }),
        "Wheel" => JointKind::Wheel(Wheel {
            limits: value["limits"].option().map(joint_limits),
            spring: value["spring"].option().map(joint_spring),
            motor: value["motor"].option().map(joint_motor),
            friction: number(&value["friction"]),
        }),
        "Motor" => JointKind::Motor(Motor {
            spring: value["spring"].option().map(|spring| PlanarSpring {
                hertz: number(&spring["hertz"]),
                damping_ratio: number(&spring["damping_ratio"]),
                rest: vector(&spring["rest"]),
                max_force: spring["max_force"].option().map(number),
            }),
            motor: value["motor"].option().map(|motor| PlanarMotor {
                velocity: vector(&motor["velocity"]),
                max_force: number(&motor["max_force"]),
            }),
            angular_spring: value["angular_spring"].option().map(joint_spring),
            angular_motor: value["angular_motor"].option().map(joint_motor),
        }),
        "Gear" => {
            let teeth = ["first_teeth", "second_teeth"].map(|name| value[name].natural() as u16 as i16);
            JointKind::Gear(Gear { teeth })
        }
        "Pulley" => JointKind::Pulley(Pulley {
            grounds: [vector(&value["first_ground"]), vector(&value["second_ground"])],
            strands: ["first_strands", "second_strands"].map(|name| value[name].natural() as u8),
            length: number(&value["length"]),
        }),
        name => panic!("kind of joint {name}"),
    }
}

fn joint_def(value: &Value) -> JointDef {
    JointDef {
        ends: [end(&value["first_end"]), end(&value["second_end"])],
        angles: [number(&value["first_angle"]), number(&value["second_angle"])],
        kind: joint_kind(&value["kind"]),
        collide_connected: value["collide_connected"].natural() == 1,
        enabled: value["enabled"].natural() == 1,
        break_force: value["break_force"].option().map(number),
        break_torque: value["break_torque"].option().map(number),
        events: value["events"].natural() == 1,
        key: value["key"].natural(),
        user_data: value["user_data"].natural(),
    }
}

fn exclusion(value: &Value) -> Exclusion {
    match value.case() {
        "Always" => Exclusion::Always,
        "UntilApart" => Exclusion::UntilApart,
        name => panic!("exclusion {name}"),
    }
}

pub(crate) fn material_pair(value: &Value) -> MaterialPair {
    MaterialPair {
        friction: number(&value["friction"]),
        restitution: number(&value["restitution"]),
        rolling_resistance: number(&value["rolling_resistance"]),
    }
}

pub(crate) fn contact_settings(value: &Value) -> ContactSettings {
    ContactSettings {
        substeps: value["substeps"].natural() as u32,
        push_speed: number(&value["push_speed"]),
        restitution_speed: number(&value["restitution_speed"]),
        sleep_speed: number(&value["sleep_speed"]),
        hit_speed: number(&value["hit_speed"]),
        max_pairs: value["max_pairs"].natural() as u32,
        max_pairs_per_collider: value["max_pairs_per_collider"].natural() as u32,
    }
}

pub(crate) fn body_def(value: &Value) -> BodyDef {
    BodyDef {
        kind: kind(&value["kind"]),
        position: vector(&value["position"]),
        angle: number(&value["angle"]),
        velocity: vector(&value["velocity"]),
        angular_velocity: number(&value["angular_velocity"]),
        colliders: value["colliders"].list().iter().map(collider_def).collect(),
        mass: mass(&value["mass"]),
        gravity_scale: number(&value["gravity_scale"]),
        linear_damping: value["linear_damping"].option().map(damping),
        angular_damping: value["angular_damping"].option().map(damping),
        max_speed: value["max_speed"].option().map(number),
        max_angular_speed: value["max_angular_speed"].option().map(number),
        locks: locks(&value["locks"]),
        dominance: value["dominance"].natural() as u32 as i32,
        bullet: value["bullet"].natural() == 1,
        force_groups: value["force_groups"].natural() as u32,
        key: value["key"].natural(),
        user_data: value["user_data"].natural(),
    }
}

pub(crate) fn command(value: &Value) -> Command {
    let target = || body(&value["body"]);
    match value.case() {
        "AddBody" => Command::AddBody(body_def(&value["def"])),
        "RemoveBody" => Command::RemoveBody(target()),
        "Apply" => {
            Command::Apply { body: target(), action: action(&value["action"]), options: options(&value["options"]) }
        }
        "SetPosition" => Command::SetPosition { body: target(), position: vector(&value["position"]) },
        "SetAngle" => Command::SetAngle { body: target(), angle: number(&value["angle"]) },
        "SetVelocity" => Command::SetVelocity { body: target(), velocity: vector(&value["velocity"]) },
        "SetAngularVelocity" => Command::SetAngularVelocity { body: target(), velocity: number(&value["velocity"]) },
        "SetMass" => Command::SetMass { body: target(), mass: mass(&value["mass"]) },
        "SetKind" => Command::SetKind { body: target(), kind: kind(&value["kind"]) },
        "SetGravityScale" => Command::SetGravityScale { body: target(), scale: number(&value["scale"]) },
        "SetBodyDamping" => Command::SetBodyDamping {
            body: target(),
            linear: value["linear"].option().map(damping),
            angular: value["angular"].option().map(damping),
        },
        "SetDominance" => {
            Command::SetDominance { body: target(), dominance: value["dominance"].natural() as u32 as i32 }
        }
        "SetBullet" => Command::SetBullet { body: target(), bullet: value["bullet"].natural() == 1 },
        "SetForceGroups" => {
            Command::SetForceGroups { body: target(), force_groups: value["force_groups"].natural() as u32 }
        }
        "SetKey" => Command::SetKey { body: target(), key: value["key"].natural() },
        "SetUserData" => Command::SetUserData { body: target(), user_data: value["user_data"].natural() },
        "Wake" => Command::Wake(target()),
        "Sleep" => Command::Sleep(target()),
        "Release" => Command::Release(target()),
        "AddField" => Command::AddField(field(&value["field"])),
        "SetField" => Command::SetField { id: field_id(&value["id"]), field: field(&value["field"]) },
        "RemoveField" => Command::RemoveField(field_id(&value["id"])),
        "SetTimeStep" => Command::SetTimeStep(time_step(&value["time_step"])),
        "SetGravity" => Command::SetGravity(vector(&value["gravity"])),
        "SetIntegrator" => Command::SetIntegrator(integrator(&value["integrator"])),
        "SetDamping" => Command::SetDamping { linear: damping(&value["linear"]), angular: damping(&value["angular"]) },
        "SetSleepAfter" => Command::SetSleepAfter(value["ticks"].option().map(|ticks| ticks.natural() as u32)),
        "SetRandom" => Command::SetRandom(random(&value["random"])),
        "SetBlob" => Command::SetBlob(value["bytes"].raw().to_vec()),
        "Explode" => Command::Explode(Explosion {
            position: vector(&value["explosion"]["position"]),
            radius: number(&value["explosion"]["radius"]),
            falloff: number(&value["explosion"]["falloff"]),
            impulse: number(&value["explosion"]["impulse"]),
            mask: value["explosion"]["mask"].natural() as u32,
        }),
        "ClearForces" => Command::ClearForces,
        "SetLocks" => Command::SetLocks { body: target(), locks: locks(&value["locks"]) },
        "SetMaxSpeeds" => Command::SetMaxSpeeds {
            body: target(),
            linear: value["linear"].option().map(number),
            angular: value["angular"].option().map(number),
        },
        "Disable" => Command::Disable(target()),
        "Enable" => Command::Enable(target()),
        "MoveTo" => {
            Command::MoveTo { body: target(), position: vector(&value["position"]), angle: number(&value["angle"]) }
        }
        "AddCollider" => Command::AddCollider { body: target(), def: collider_def(&value["def"]) },
        "SetCollider" => {
            Command::SetCollider { collider: collider(&value["collider"]), def: collider_def(&value["def"]) }
        }
        "RemoveCollider" => Command::RemoveCollider(collider(&value["collider"])),
        "SetContactSettings" => Command::SetContactSettings(contact_settings(&value["contacts"])),
        "ExcludePair" => Command::ExcludePair {
            a: body(&value["a"]),
            b: body(&value["b"]),
            exclusion: exclusion(&value["exclusion"]),
        },
        "AllowPair" => Command::AllowPair { a: body(&value["a"]), b: body(&value["b"]) },
        "SetMaterialPair" => Command::SetMaterialPair {
            first: value["first"].natural() as u32,
            second: value["second"].natural() as u32,
            pair: value["pair"].option().map(material_pair),
        },
        "AddJoint" => Command::AddJoint(joint_def(&value["def"])),
        "RemoveJoint" => Command::RemoveJoint(joint(&value["joint"])),
        "SetJointKind" => Command::SetJointKind { joint: joint(&value["joint"]), kind: joint_kind(&value["kind"]) },
        "SetJointMotor" => {
            Command::SetJointMotor { joint: joint(&value["joint"]), motor: value["motor"].option().map(joint_motor) }
        }
        "SetJointBreak" => {
            Command::SetJointBreak { joint: joint(&value["joint"]), force: value["force"].option().map(number) }
        }
        "SetJointBreakTorque" => {
            Command::SetJointBreakTorque { joint: joint(&value["joint"]), torque: value["torque"].option().map(number) }
        }
        "EnableJoint" => {
            Command::EnableJoint { joint: joint(&value["joint"]), enabled: value["enabled"].natural() == 1 }
        }
        name => panic!("command {name}"),
    }
}
