//! Writing joints.

use alloc::string::String;

use super::json::{Fields, list, null, text};
use super::{Scene, SceneJoint};
use umbra_physics::{
    Distance, Fx, Gear, JointDef, JointId, JointKind, JointLimits, JointMotor, JointSpring, Motor, PlanarMotor,
    PlanarSpring, Prismatic, Pulley, Revolute, Vec2, Weld, Wheel,
};

impl Scene {
    pub(super) fn scene_joint(&self, joint: &SceneJoint) -> String {
        self.joint(joint.name.as_deref().map_or_else(Fields::default, Fields::of_name), &joint.def)
    }

    pub(super) fn joint(&self, mut object: Fields, def: &JointDef) -> String {
        let [first, second] = &def.ends;
        object.put("ends", list([self.end(first), self.end(second)]));
        object.unless(def.angles == [Fx::ZERO; 2], "angles", list(def.angles));
        kind_into(&mut object, &def.kind);
        let collides = matches!(def.kind, JointKind::Pulley(_));
        object.unless(def.collide_connected == collides, "collide_connected", def.collide_connected);
        object.unless(def.enabled, "enabled", false);
        if let Some(force) = def.break_force {
            object.put("break_force", force);
        }
        if let Some(torque) = def.break_torque {
            object.put("break_torque", torque);
        }
        object.unless(!def.events, "events", true);
        object.unless(def.key == 0, "key", def.key);
        object.unless(def.user_data == 0, "user_data", def.user_data);
        object.line()
    }

    /// `null` for what the scene does not have: nothing is read as a name of another.
    fn joint_name(&self, joint: JointId) -> String {
        let name = self.joints.get(joint.parts().0 as usize).and_then(|joint| joint.name.as_deref());
        name.map_or_else(null, text)
    }

    pub(super) fn do_to_joint(&self, object: &mut Fields, joint: JointId, what: &str) {
        object.put("joint", self.joint_name(joint));
        object.put("do", text(what));
    }

    pub(super) fn set_joint(&self, object: &mut Fields, joint: JointId, property: &str, value: String) {
        object.put("joint", self.joint_name(joint));
        object.put("set", Fields::of(property, value));
    }
}

pub(super) fn kind_text(kind: &JointKind) -> String {
    let mut object = Fields::default();
    kind_into(&mut object, kind);
    object.line()
}

fn kind_into(object: &mut Fields, kind: &JointKind) {
    let mut values = Fields::default();
    let name = match kind {
        JointKind::Revolute(Revolute { limits, motor, spring, friction, ratchet }) => {
            parts_into(&mut values, limits, motor, spring, *friction);
            if let Some(teeth) = ratchet {
                values.put("ratchet", teeth);
            }
            "revolute"
        }
        JointKind::Weld(Weld { spring }) => {
            parts_into(&mut values, &None, &None, spring, Fx::ZERO);
            "weld"
        }
        JointKind::Distance(Distance { limits, motor, spring, friction }) => {
            match limits {
                Some(limits) if *kind == JointKind::Distance(Distance::rod(limits.lower)) => {
                    values.put("length", limits.lower);
                }
                _ => distance_into(&mut values, limits, motor, spring, *friction),
            }
            "distance"
        }
        JointKind::Prismatic(Prismatic { limits, motor, spring, friction }) => {
            parts_into(&mut values, limits, motor, spring, *friction);
            "prismatic"
        }
        JointKind::Wheel(Wheel { limits, spring, motor, friction }) => {
            parts_into(&mut values, limits, motor, spring, *friction);
            "wheel"
        }
        JointKind::Motor(motor) => {
            planar_into(&mut values, motor);
            "motor"
        }
        JointKind::Gear(Gear { teeth: [first, second] }) => {
            values.put("teeth", list([first, second]));
            "gear"
        }
        JointKind::Pulley(Pulley { grounds, strands, length }) => {
            values.put("grounds", list(grounds.map(|ground| list([ground.x, ground.y]))));
            values.unless(*strands == [1, 1], "strands", list(strands));
            values.put("length", length);
            "pulley"
        }
        // All there are stand above: `tests/layers.rs` compares the lists.
        _ => "unknown",
    };
    object.put(name, values.line());
}

fn planar_into(values: &mut Fields, motor: &Motor) {
    if let Some(PlanarSpring { hertz, damping_ratio, rest, max_force }) = motor.spring {
        let mut spring = spring_fields(&JointSpring { hertz, damping_ratio, rest: Fx::ZERO, max_force });
        spring.unless(rest == Vec2::ZERO, "rest", list([rest.x, rest.y]));
        values.put("spring", spring.line());
    }
    if let Some(PlanarMotor { velocity, max_force }) = motor.motor {
        let mut object = Fields::default();
        object.unless(velocity == Vec2::ZERO, "velocity", list([velocity.x, velocity.y]));
        object.put("max_force", max_force);
        values.put("motor", object.line());
    }
    if let Some(spring) = &motor.angular_spring {
        values.put("angular_spring", spring_fields(spring).line());
    }
    if let Some(angular_motor) = &motor.angular_motor {
        values.put("angular_motor", motor_text(angular_motor));
    }
}

/// The parts of a distance joint that is no rod, with a field that says so.
fn distance_into(
    values: &mut Fields,
    limits: &Option<JointLimits>,
    motor: &Option<JointMotor>,
    spring: &Option<JointSpring>,
    friction: Fx,
) {
    if limits.is_none() && motor.is_none() && spring.is_none() {
        values.put("friction", friction);
        return;
    }
    parts_into(values, limits, motor, &None, friction);
    if let Some(spring) = spring {
        let mut spring_values = spring_fields(spring);
        // Left out, it would be the distance of the points.
        if spring.rest == Fx::ZERO {
            spring_values.put("rest", spring.rest);
        }
        values.put("spring", spring_values.line());
    }
}

fn parts_into(
    values: &mut Fields,
    limits: &Option<JointLimits>,
    motor: &Option<JointMotor>,
    spring: &Option<JointSpring>,
    friction: Fx,
) {
    if let Some(JointLimits { lower, upper }) = limits {
        values.put("limits", list([lower, upper]));
    }
    if let Some(motor) = motor {
        values.put("motor", motor_text(motor));
    }
    if let Some(spring) = spring {
        values.put("spring", spring_fields(spring).line());
    }
    values.unless(friction == Fx::ZERO, "friction", friction);
}

pub(super) fn motor_text(motor: &JointMotor) -> String {
    let mut object = Fields::default();
    object.unless(motor.speed == Fx::ZERO, "speed", motor.speed);
    object.put("max_force", motor.max_force);
    object.line()
}

fn spring_fields(spring: &JointSpring) -> Fields {
    let mut object = Fields::default();
    object.put("hertz", spring.hertz);
    object.unless(spring.damping_ratio == Fx::ONE, "damping_ratio", spring.damping_ratio);
    object.unless(spring.rest == Fx::ZERO, "rest", spring.rest);
    if let Some(force) = spring.max_force {
        object.put("max_force", force);
    }
    object
}
