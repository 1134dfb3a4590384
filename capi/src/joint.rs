//! Joints.

use std::mem::MaybeUninit;

use umbra_physics::{
    Attachment, BodyId, Command, Distance, End, Fx, Gear, JointBroke, JointDef, JointId, JointKind, JointLimits,
    JointLoad, JointMotor, JointSpring, Motor, PlanarMotor, PlanarSpring, Prismatic, Pulley, Revolute, Vec2, Weld,
    Wheel, World,
};

use crate::UMBRA_NO_HANDLE;
use crate::body::UMBRA_NO_LIMIT;
use crate::memory::{fill, given};
use crate::number::{UmbraFx, UmbraVec2};
use crate::status::{Refusal, Result, UMBRA_ERROR_NO_SUCH_JOINT, UmbraStatus, guard};
use crate::world::{UmbraWorld, body_id, body_word, change, change_by, created, look, word};

/// A kind of joint: one of those below.
pub type UmbraJointKind = u32;

/// Both ends stay at one point, around which the bodies turn. Reads the limits, the motor, the spring and `friction`.
pub const UMBRA_REVOLUTE: UmbraJointKind = 0;
/// The ends stay at a distance: a rigid rod with two limits that are the same, a rope, or a spring. Reads the limits, the motor, the spring and
/// `friction`.
pub const UMBRA_DISTANCE: UmbraJointKind = 1;
/// Both ends stay at one point and at one angle. Reads the spring, which stands in place of the rigid angle.
pub const UMBRA_WELD: UmbraJointKind = 2;
/// The second end slides along the x axis of the frame of the first one, and the bodies do not turn against each other. Reads the limits, the
/// motor, the spring and `friction`, along the axis.
pub const UMBRA_PRISMATIC: UmbraJointKind = 3;
/// The second end slides along the x axis of the frame of the first one, and turns. Reads the limits and the spring along the axis, the motor and
/// `friction` of the turn.
pub const UMBRA_WHEEL: UmbraJointKind = 4;
/// The second end is moved in the frame of the first one by forces with bounds: by the planar spring and the planar motor, and turned by the motor
/// and the spring. A mouse has a planar spring alone, whose point at rest is set in each tick by `umbra_world_set_joint_kind`.
pub const UMBRA_MOTOR: UmbraJointKind = 5;
/// The bodies turn at a ratio: two gears, a chain, a belt. Reads the teeth.
pub const UMBRA_GEAR: UmbraJointKind = 6;
/// A rope from one body over two points of the world to the other body, which pulls. Reads the points `grounds`, the strands, and `upper`, the length
/// of the rope.
pub const UMBRA_PULLEY: UmbraJointKind = 7;

/// A joint: its kind, its ends, and what it keeps of them. Only what its kind reads matters. `umbra_joint_def_default`,
/// `umbra_joint_def_revolute`, `umbra_joint_def_weld`, `umbra_joint_def_distance`, `umbra_joint_def_prismatic`, `umbra_joint_def_wheel`,
/// `umbra_joint_def_motor`, `umbra_joint_def_gear` and `umbra_joint_def_pulley` fill it in; `umbra_joint_def_set_stiffness` sets its spring in N/m. Limits,
/// motor and spring are of an angle in rad, rad/s and N·m, or of a distance in m, m/s and N, as their kind says.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UmbraJointDef {
    /// The kind.
    pub kind: UmbraJointKind,
    /// 1 if the two bodies touch each other all the same. Default 0.
    pub collide_connected: u32,
    /// 0 for a joint that does nothing until it is enabled. Default 1.
    pub is_enabled: u32,
    /// 1 to report when the joint breaks, and its mean loads if it may break. Default 0.
    pub events: u32,
    /// 1 if `lower` and `upper` are limits. Default 0.
    pub has_limits: u32,
    /// 1 if there is a motor. Default 0.
    pub has_motor: u32,
    /// 1 if there is a spring. Default 0.
    pub has_spring: u32,
    /// 1 if there is a planar spring. Default 0.
    pub has_planar_spring: u32,
    /// 1 if there is a planar motor. Default 0.
    pub has_planar_motor: u32,
    /// The teeth of the ratchet of a revolute joint, which turns back to the last tooth at most: 1 to 1,024, or negative for one that turns on
    /// clockwise; 0 for none, the default.
    pub ratchet: i32,
    /// The teeth of two gears, 1 to 1,024 or negative.
    pub teeth: [i32; 2],
    /// The strands of the rope of a pulley on both sides, 1 to 64. Default 1.
    pub strands: [u32; 2],
    /// The bodies at the two ends, or `UMBRA_NO_HANDLE` for the world. At least one is dynamic.
    pub bodies: [u64; 2],
    /// Points of the bodies in their own axes from their centres of mass, or of the world, m.
    pub points: [UmbraVec2; 2],
    /// The angles of the joint's frame in the axes of both ends, rad.
    pub angles: [UmbraFx; 2],
    /// The points of the world over which the rope of a pulley runs, m.
    pub grounds: [UmbraVec2; 2],
    /// The lowest angle, within ±2^17 rad, or distance, within ±2^20 m.
    pub lower: UmbraFx,
    /// The highest one, likewise.
    pub upper: UmbraFx,
    /// The speed that a motor aims at, of the second end against the first one, within ±2^20 rad/s or m/s.
    pub motor_speed: UmbraFx,
    /// The largest torque or force of a motor, from 0.
    pub motor_max_force: UmbraFx,
    /// The frequency of a spring without damping, 0 to 10^6 Hz.
    pub spring_hertz: UmbraFx,
    /// The damping of a spring over critical damping, 0 to 1024. Default 1.
    pub spring_damping_ratio: UmbraFx,
    /// The angle or the distance of a spring at rest, like the limits.
    pub spring_rest: UmbraFx,
    /// The largest torque or force of a spring, from 0, or `UMBRA_NO_LIMIT`, the default.
    pub spring_max_force: UmbraFx,
    /// The largest torque or force of friction, from 0.
    pub friction: UmbraFx,
    /// The frequency of a planar spring without damping, 0 to 10^6 Hz.
    pub planar_spring_hertz: UmbraFx,
    /// The damping of a planar spring over critical damping, 0 to 1024. Default 1.
    pub planar_spring_damping_ratio: UmbraFx,
    /// The point of a planar spring at rest in the frame of the first end, within ±2^20 m.
    pub planar_spring_rest: UmbraVec2,
    /// The largest force of a planar spring, from 0, N, or `UMBRA_NO_LIMIT`, the default.
    pub planar_spring_max_force: UmbraFx,
    /// The velocity of a planar motor in the frame of the first end, within ±2^20 m/s.
    pub planar_motor_velocity: UmbraVec2,
    /// The largest force of a planar motor, from 0, N.
    pub planar_motor_max_force: UmbraFx,
    /// The mean force over a step above which the joint breaks, from 0, N, or `UMBRA_NO_LIMIT`, the default.
    pub break_force: UmbraFx,
    /// The mean torque over a step above which the joint breaks, from 0, N·m, or `UMBRA_NO_LIMIT`, the default.
    pub break_torque: UmbraFx,
    /// Number of the caller's own, by which joints are listed.
    pub key: u64,
    /// Number of the caller's own.
    pub user_data: u64,
}

/// The state of a joint: its place, its motion and its force.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UmbraJointState {
    /// The two ends in the world, m.
    pub points: [UmbraVec2; 2],
    /// The distance of the ends, m; of a pulley the length of its rope in use.
    pub length: UmbraFx,
    /// The way of the second end along the axis of a prismatic, a wheel or a motor joint, m; of other kinds the distance.
    pub translation: UmbraFx,
    /// The place of the second end in the frame of the first one, m.
    pub offset: UmbraVec2,
    /// The angle from the frame of the first end to that of the second one, rad.
    pub angle: UmbraFx,
    /// The angle of the tooth of a ratchet that is engaged, rad; 0 without one.
    pub stop: UmbraFx,
    /// The speed of the angle, rad/s.
    pub speed: UmbraFx,
    /// The force on the second end in the last step, N.
    pub force: UmbraVec2,
    /// The torque on the second end in the last step, N·m.
    pub torque: UmbraFx,
    /// 1 if the joint is broken.
    pub is_broken: u32,
    /// 1 if steps keep the joint: it is enabled and not broken, and its bodies take part.
    pub is_active: u32,
}

/// The mean load of a joint over a step.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UmbraJointLoad {
    /// The joint.
    pub joint: u64,
    /// The key of the joint.
    pub key: u64,
    /// The mean force on the second end, N.
    pub force: UmbraVec2,
    /// The mean torque on the second body, N·m.
    pub torque: UmbraFx,
}

/// A joint that broke.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UmbraJointBroke {
    /// The joint.
    pub joint: u64,
    /// The key of the joint.
    pub key: u64,
    /// The bodies at its ends, or `UMBRA_NO_HANDLE` for the world.
    pub bodies: [u64; 2],
    /// The mean force on the second end over the step, N.
    pub force: UmbraVec2,
    /// The mean torque on the second body over the step, N·m.
    pub torque: UmbraFx,
}

/// A joint of a kind between nothing.
const BLANK: UmbraJointDef = UmbraJointDef {
    kind: UMBRA_REVOLUTE,
    collide_connected: 0,
    is_enabled: 1,
    events: 0,
    has_limits: 0,
    has_motor: 0,
    has_spring: 0,
    has_planar_spring: 0,
    has_planar_motor: 0,
    ratchet: 0,
    teeth: [1; 2],
    strands: [1; 2],
    bodies: [UMBRA_NO_HANDLE; 2],
    points: [UmbraVec2 { x: 0, y: 0 }; 2],
    angles: [0; 2],
    grounds: [UmbraVec2 { x: 0, y: 0 }; 2],
    lower: 0,
    upper: 0,
    motor_speed: 0,
    motor_max_force: 0,
    spring_hertz: 0,
    spring_damping_ratio: Fx::ONE.to_bits(),
    spring_rest: 0,
    spring_max_force: UMBRA_NO_LIMIT,
    friction: 0,
    planar_spring_hertz: 0,
    planar_spring_damping_ratio: Fx::ONE.to_bits(),
    planar_spring_rest: UmbraVec2 { x: 0, y: 0 },
    planar_spring_max_force: UMBRA_NO_LIMIT,
    planar_motor_velocity: UmbraVec2 { x: 0, y: 0 },
    planar_motor_max_force: 0,
    break_force: UMBRA_NO_LIMIT,
    break_torque: UMBRA_NO_LIMIT,
    key: 0,
    user_data: 0,
};

pub(crate) const fn joint_word(joint: JointId) -> u64 {
    let (slot, generation) = joint.parts();
    word(slot, generation)
}

pub(crate) const fn joint_id(word: u64) -> JointId {
    JointId::from_parts(word as u32, (word >> 32) as u32)
}

fn optional_body(word: u64) -> Option<BodyId> {
    (word != UMBRA_NO_HANDLE).then(|| body_id(word))
}

fn optional_word(body: Option<BodyId>) -> u64 {
    body.map_or(UMBRA_NO_HANDLE, body_word)
}

fn optional_force(bits: UmbraFx) -> Option<Fx> {
    (bits != UMBRA_NO_LIMIT).then(|| Fx::from_bits(bits))
}

fn force_bits(force: Option<Fx>) -> UmbraFx {
    force.map_or(UMBRA_NO_LIMIT, Fx::to_bits)
}

/// Beyond 16 bits it is refused like any other out of range.
fn teeth(count: i32) -> i16 {
    i16::try_from(count).unwrap_or(i16::MAX)
}

/// Likewise.
fn strands(count: u32) -> u8 {
    u8::try_from(count).unwrap_or(0)
}

impl UmbraJointDef {
    fn end(&self, index: usize) -> End {
        let point = self.points[index].into();
        match optional_body(self.bodies[index]) {
            None => End::World(point),
            Some(body) => End::Body(Attachment { body, point }),
        }
    }

    fn limits(&self) -> Option<JointLimits> {
        let [lower, upper] = [self.lower, self.upper].map(Fx::from_bits);
        (self.has_limits != 0).then_some(JointLimits { lower, upper })
    }

    fn motor(&self) -> Option<JointMotor> {
        let [speed, max_force] = [self.motor_speed, self.motor_max_force].map(Fx::from_bits);
        (self.has_motor != 0).then_some(JointMotor { speed, max_force })
    }

    fn spring(&self) -> Option<JointSpring> {
        (self.has_spring != 0).then(|| JointSpring {
            hertz: Fx::from_bits(self.spring_hertz),
            damping_ratio: Fx::from_bits(self.spring_damping_ratio),
            rest: Fx::from_bits(self.spring_rest),
            max_force: optional_force(self.spring_max_force),
        })
    }

    fn planar_spring(&self) -> Option<PlanarSpring> {
        (self.has_planar_spring != 0).then(|| PlanarSpring {
            hertz: Fx::from_bits(self.planar_spring_hertz),
            damping_ratio: Fx::from_bits(self.planar_spring_damping_ratio),
            rest: self.planar_spring_rest.into(),
            max_force: optional_force(self.planar_spring_max_force),
        })
    }

    fn planar_motor(&self) -> Option<PlanarMotor> {
        let max_force = Fx::from_bits(self.planar_motor_max_force);
        (self.has_planar_motor != 0).then(|| PlanarMotor { velocity: self.planar_motor_velocity.into(), max_force })
    }

    fn joint_kind(&self) -> Result<JointKind> {
        let (limits, motor, spring) = (self.limits(), self.motor(), self.spring());
        let friction = Fx::from_bits(self.friction);
        Ok(match self.kind {
            UMBRA_REVOLUTE => {
                let ratchet = (self.ratchet != 0).then(|| teeth(self.ratchet));
                JointKind::Revolute(Revolute { limits, motor, spring, friction, ratchet })
            }
            UMBRA_DISTANCE => JointKind::Distance(Distance { limits, motor, spring, friction }),
            UMBRA_WELD => JointKind::Weld(Weld { spring }),
            UMBRA_PRISMATIC => JointKind::Prismatic(Prismatic { limits, motor, spring, friction }),
            UMBRA_WHEEL => JointKind::Wheel(Wheel { limits, spring, motor, friction }),
            UMBRA_GEAR => JointKind::Gear(Gear { teeth: self.teeth.map(teeth) }),
            UMBRA_PULLEY => JointKind::Pulley(Pulley {
                grounds: self.grounds.map(Vec2::from),
                strands: self.strands.map(strands),
                length: Fx::from_bits(self.upper),
            }),
            UMBRA_MOTOR => JointKind::Motor(Motor {
                spring: self.planar_spring(),
                motor: self.planar_motor(),
                angular_spring: spring,
                angular_motor: motor,
            }),
            _ => return Err(Refusal::bad("no kind of joint has this number")),
        })
    }

    fn joint(&self) -> Result<JointDef> {
        Ok(JointDef {
            ends: [self.end(0), self.end(1)],
            angles: self.angles.map(Fx::from_bits),
            kind: self.joint_kind()?,
            collide_connected: self.collide_connected != 0,
            enabled: self.is_enabled != 0,
            break_force: optional_force(self.break_force),
            break_torque: optional_force(self.break_torque),
            events: self.events != 0,
            key: self.key,
            user_data: self.user_data,
        })
    }

    fn set_spring(&mut self, spring: Option<JointSpring>) {
        let Some(JointSpring { hertz, damping_ratio, rest, max_force }) = spring else { return };
        self.has_spring = 1;
        (self.spring_hertz, self.spring_damping_ratio) = (hertz.to_bits(), damping_ratio.to_bits());
        (self.spring_rest, self.spring_max_force) = (rest.to_bits(), force_bits(max_force));
    }

    fn set_parts(&mut self, limits: Option<JointLimits>, motor: Option<JointMotor>, friction: Fx) {
        if let Some(JointLimits { lower, upper }) = limits {
            (self.has_limits, self.lower, self.upper) = (1, lower.to_bits(), upper.to_bits());
        }
        if let Some(JointMotor { speed, max_force }) = motor {
            (self.has_motor, self.motor_speed, self.motor_max_force) = (1, speed.to_bits(), max_force.to_bits());
        }
        self.friction = friction.to_bits();
    }

    fn set_planar(&mut self, spring: Option<PlanarSpring>, motor: Option<PlanarMotor>) {
        if let Some(PlanarSpring { hertz, damping_ratio, rest, max_force }) = spring {
            (self.has_planar_spring, self.planar_spring_rest) = (1, rest.into());
            (self.planar_spring_hertz, self.planar_spring_damping_ratio) = (hertz.to_bits(), damping_ratio.to_bits());
            self.planar_spring_max_force = force_bits(max_force);
        }
        if let Some(PlanarMotor { velocity, max_force }) = motor {
            (self.has_planar_motor, self.planar_motor_velocity) = (1, velocity.into());
            self.planar_motor_max_force = max_force.to_bits();
        }
    }

    fn of(joint: &JointDef) -> Result<Self> {
        let mut def = Self {
            collide_connected: joint.collide_connected.into(),
            is_enabled: joint.enabled.into(),
            events: joint.events.into(),
            angles: joint.angles.map(Fx::to_bits),
            break_force: force_bits(joint.break_force),
            break_torque: force_bits(joint.break_torque),
            key: joint.key,
            user_data: joint.user_data,
            ..BLANK
        };
        for (index, end) in joint.ends.iter().enumerate() {
            (def.bodies[index], def.points[index]) = match end {
                End::World(point) => (UMBRA_NO_HANDLE, (*point).into()),
                End::Body(at) => (body_word(at.body), at.point.into()),
            };
        }
        let spring = match joint.kind {
            JointKind::Revolute(Revolute { limits, motor, spring, friction, ratchet }) => {
                def.set_parts(limits, motor, friction);
                def.ratchet = ratchet.map_or(0, i32::from);
                spring
            }
            JointKind::Weld(Weld { spring }) => {
                def.kind = UMBRA_WELD;
                spring
            }
            JointKind::Distance(Distance { limits, motor, spring, friction }) => {
                def.kind = UMBRA_DISTANCE;
                def.set_parts(limits, motor, friction);
                spring
            }
            JointKind::Prismatic(Prismatic { limits, motor, spring, friction }) => {
                def.kind = UMBRA_PRISMATIC;
                def.set_parts(limits, motor, friction);
                spring
            }
            JointKind::Wheel(Wheel { limits, spring, motor, friction }) => {
                def.kind = UMBRA_WHEEL;
                def.set_parts(limits, motor, friction);
                spring
            }
            JointKind::Motor(Motor { spring, motor, angular_spring, angular_motor }) => {
                def.kind = UMBRA_MOTOR;
                def.set_planar(spring, motor);
                def.set_parts(None, angular_motor, Fx::ZERO);
                angular_spring
            }
            JointKind::Gear(Gear { teeth }) => {
                (def.kind, def.teeth) = (UMBRA_GEAR, teeth.map(i32::from));
                None
            }
            JointKind::Pulley(Pulley { grounds, strands, length }) => {
                (def.kind, def.strands) = (UMBRA_PULLEY, strands.map(u32::from));
                (def.grounds, def.upper) = (grounds.map(UmbraVec2::from), length.to_bits());
                None
            }
            _ => return Err(Refusal::bad("this interface does not have the kind of this joint")),
        };
        def.set_spring(spring);
        Ok(def)
    }
}

impl From<&JointLoad> for UmbraJointLoad {
    fn from(load: &JointLoad) -> Self {
        let JointLoad { joint, key, force, torque, .. } = *load;
        Self { joint: joint_word(joint), key, force: force.into(), torque: torque.to_bits() }
    }
}

impl From<&JointBroke> for UmbraJointBroke {
    fn from(broke: &JointBroke) -> Self {
        Self {
            joint: joint_word(broke.joint),
            key: broke.key,
            bodies: broke.bodies.map(optional_word),
            force: broke.force.into(),
            torque: broke.torque.to_bits(),
        }
    }
}

fn point(x: UmbraFx, y: UmbraFx) -> Vec2 {
    Vec2::new(Fx::from_bits(x), Fx::from_bits(y))
}

/// The definition of a joint of two bodies at a point of the world.
fn joint_at(world: &World, [first, second]: [u64; 2], point: Vec2, kind: JointKind) -> Result<UmbraJointDef> {
    UmbraJointDef::of(&JointDef { kind, ..JointDef::at(world, optional_body(first), optional_body(second), point)? })
}

/// Fills in the definition of a joint of a kind, with both ends at the origin of the world: set its bodies and points.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_joint_def_default(
    kind: UmbraJointKind,
    def: Option<&mut MaybeUninit<UmbraJointDef>>,
) -> UmbraStatus {
    guard(|| {
        let (place, blank) = (given(def)?, UmbraJointDef { kind, ..BLANK });
        blank.joint_kind()?;
        place.write(blank);
        Ok(())
    })
}

/// Fills in the definition of a revolute joint of two bodies at a point of the world, m; `UMBRA_NO_HANDLE` is the world. The angle of the
/// joint is 0 as the bodies stand.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_joint_def_revolute(
    world: Option<&UmbraWorld>,
    first: u64,
    second: u64,
    x: UmbraFx,
    y: UmbraFx,
    def: Option<&mut MaybeUninit<UmbraJointDef>>,
) -> UmbraStatus {
    look(world, def, |world| joint_at(world, [first, second], point(x, y), JointKind::default()))
}

/// Fills in the definition of a weld of two bodies as they stand, at a point of the world, m; `UMBRA_NO_HANDLE` is the world.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_joint_def_weld(
    world: Option<&UmbraWorld>,
    first: u64,
    second: u64,
    x: UmbraFx,
    y: UmbraFx,
    def: Option<&mut MaybeUninit<UmbraJointDef>>,
) -> UmbraStatus {
    look(world, def, |world| joint_at(world, [first, second], point(x, y), JointKind::Weld(Weld::default())))
}

/// The definition of a joint of two bodies at a point of the world, along an axis.
fn joint_along(
    world: &World,
    [first, second]: [u64; 2],
    point: Vec2,
    axis: Vec2,
    kind: JointKind,
) -> Result<UmbraJointDef> {
    let def = JointDef::along(world, optional_body(first), optional_body(second), point, axis)?;
    UmbraJointDef::of(&JointDef { kind, ..def })
}

/// Fills in the definition of a prismatic joint of two bodies at a point of the world, m, along an axis in the world, which turns with the first
/// body; `UMBRA_NO_HANDLE` is the world. The way and the angle of the joint are 0 as the bodies stand.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_joint_def_prismatic(
    world: Option<&UmbraWorld>,
    first: u64,
    second: u64,
    x: UmbraFx,
    y: UmbraFx,
    axis_x: UmbraFx,
    axis_y: UmbraFx,
    def: Option<&mut MaybeUninit<UmbraJointDef>>,
) -> UmbraStatus {
    look(world, def, |world| {
        let kind = JointKind::Prismatic(Prismatic::default());
        joint_along(world, [first, second], point(x, y), point(axis_x, axis_y), kind)
    })
}

/// Fills in the definition of a wheel joint of a car and a wheel at its hub, a point of the world, m, along the axis of the suspension in the
/// world, which turns with the car. The way of the joint is 0 as the bodies stand.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_joint_def_wheel(
    world: Option<&UmbraWorld>,
    car: u64,
    wheel: u64,
    x: UmbraFx,
    y: UmbraFx,
    axis_x: UmbraFx,
    axis_y: UmbraFx,
    def: Option<&mut MaybeUninit<UmbraJointDef>>,
) -> UmbraStatus {
    look(world, def, |world| {
        let kind = JointKind::Wheel(Wheel::default());
        joint_along(world, [car, wheel], point(x, y), point(axis_x, axis_y), kind)
    })
}

/// Fills in the definition of a motor joint of two bodies at a point of the world, m; `UMBRA_NO_HANDLE` is the world. It does nothing until its
/// planar spring or motor, its spring or its motor is set. The point of the planar spring at rest is counted from the first end.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_joint_def_motor(
    world: Option<&UmbraWorld>,
    first: u64,
    second: u64,
    x: UmbraFx,
    y: UmbraFx,
    def: Option<&mut MaybeUninit<UmbraJointDef>>,
) -> UmbraStatus {
    look(world, def, |world| joint_at(world, [first, second], point(x, y), JointKind::Motor(Motor::default())))
}

/// Fills in the definition of two gears with these numbers of teeth, 1 to 1,024 or negative, whose teeth fit as the bodies stand.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_joint_def_gear(
    world: Option<&UmbraWorld>,
    first: u64,
    second: u64,
    first_teeth: i32,
    second_teeth: i32,
    def: Option<&mut MaybeUninit<UmbraJointDef>>,
) -> UmbraStatus {
    look(world, def, |world| {
        let teeth = [first_teeth, second_teeth].map(teeth);
        UmbraJointDef::of(&JointDef::gear(world, body_id(first), body_id(second), teeth)?)
    })
}

/// Fills in the definition of a rope from a point of one body over two points of the world to a point of another body, all given where they are in the
/// world, m, with one strand on each side: set `strands` and `upper`, the length of the rope, for more. It is as long as the points are apart.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_joint_def_pulley(
    world: Option<&UmbraWorld>,
    first: u64,
    first_x: UmbraFx,
    first_y: UmbraFx,
    first_ground_x: UmbraFx,
    first_ground_y: UmbraFx,
    second: u64,
    second_x: UmbraFx,
    second_y: UmbraFx,
    second_ground_x: UmbraFx,
    second_ground_y: UmbraFx,
    def: Option<&mut MaybeUninit<UmbraJointDef>>,
) -> UmbraStatus {
    look(world, def, |world| {
        let points = [point(first_x, first_y), point(second_x, second_y)];
        let grounds = [point(first_ground_x, first_ground_y), point(second_ground_x, second_ground_y)];
        let bodies = [first, second].map(body_id);
        UmbraJointDef::of(&JointDef::pulley(world, bodies, points, grounds, [1; 2])?)
    })
}

/// Fills in the definition of a rigid rod between points of two bodies, given where they are in the world, m; `UMBRA_NO_HANDLE` is the world.
/// It is as long as the points are apart.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_joint_def_distance(
    world: Option<&UmbraWorld>,
    first: u64,
    from_x: UmbraFx,
    from_y: UmbraFx,
    second: u64,
    to_x: UmbraFx,
    to_y: UmbraFx,
    def: Option<&mut MaybeUninit<UmbraJointDef>>,
) -> UmbraStatus {
    look(world, def, |world| {
        let (from, to) = (point(from_x, from_y), point(to_x, to_y));
        UmbraJointDef::of(&JointDef::between(world, optional_body(first), from, optional_body(second), to)?)
    })
}

/// Gives the definition of a joint a spring with a stiffness, N/m or N·m/rad, and a damper, N·s/m or N·m·s/rad, both from 0: sets `has_spring`,
/// `spring_hertz` and `spring_damping_ratio` for the effective mass that the spring meets as the bodies stand. Of a motor joint it is the planar spring,
/// `has_planar_spring`, `planar_spring_hertz` and `planar_spring_damping_ratio`.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_joint_def_set_stiffness(
    world: Option<&UmbraWorld>,
    def: Option<&mut UmbraJointDef>,
    stiffness: UmbraFx,
    damping: UmbraFx,
) -> UmbraStatus {
    guard(|| {
        let (world, def) = (given(world)?, given(def)?);
        let mass = def.joint()?.effective_mass(world.world())?;
        let spring = JointSpring::with_stiffness(Fx::from_bits(stiffness), Fx::from_bits(damping), mass)?;
        let (hertz, damping_ratio) = (spring.hertz.to_bits(), spring.damping_ratio.to_bits());
        if def.kind == UMBRA_MOTOR {
            def.has_planar_spring = 1;
            (def.planar_spring_hertz, def.planar_spring_damping_ratio) = (hertz, damping_ratio);
        } else {
            def.has_spring = 1;
            (def.spring_hertz, def.spring_damping_ratio) = (hertz, damping_ratio);
        }
        Ok(())
    })
}

/// Adds a joint; wakes its bodies, and ends contacts between them unless they are to touch each other.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_add_joint(
    world: Option<&mut UmbraWorld>,
    def: Option<&UmbraJointDef>,
    joint: Option<&mut MaybeUninit<u64>>,
) -> UmbraStatus {
    guard(|| {
        let (world, def, place) = (given(world)?, given(def)?, given(joint)?);
        place.write(created(world.execute(&Command::AddJoint(def.joint()?))?).1);
        Ok(())
    })
}

/// Removes a joint; wakes its bodies.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_remove_joint(world: Option<&mut UmbraWorld>, joint: u64) -> UmbraStatus {
    change(world, Command::RemoveJoint(joint_id(joint)))
}

/// Sets the kind of a joint and the values that the kind reads in `def`; wakes its bodies. The ends and the rest of the joint stay.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_set_joint_kind(
    world: Option<&mut UmbraWorld>,
    joint: u64,
    def: Option<&UmbraJointDef>,
) -> UmbraStatus {
    change_by(world, || Ok(Command::SetJointKind { joint: joint_id(joint), kind: given(def)?.joint_kind()? }))
}

/// Sets the motor of a joint: its speed, rad/s or m/s, and its largest torque, N·m, or force, N, or `UMBRA_NO_LIMIT` for no motor; wakes its
/// bodies.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_set_joint_motor(
    world: Option<&mut UmbraWorld>,
    joint: u64,
    speed: UmbraFx,
    max_force: UmbraFx,
) -> UmbraStatus {
    guard(|| {
        let (world, joint) = (given(world)?, joint_id(joint));
        let motor = optional_force(max_force).map(|max_force| JointMotor { speed: Fx::from_bits(speed), max_force });
        // A draft does not know the joint.
        let turning = Command::SetJointMotor { joint, motor };
        let command = world.world().joint_motor_command(joint, motor).unwrap_or(turning);
        world.execute(&command)?;
        Ok(())
    })
}

/// Sets the mean force over a step above which a joint breaks, N, or `UMBRA_NO_LIMIT` for never; wakes its bodies.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_set_joint_break(
    world: Option<&mut UmbraWorld>,
    joint: u64,
    force: UmbraFx,
) -> UmbraStatus {
    change(world, Command::SetJointBreak { joint: joint_id(joint), force: optional_force(force) })
}

/// Sets the mean torque over a step above which a joint breaks, N·m, or `UMBRA_NO_LIMIT` for never; wakes its bodies.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_set_joint_break_torque(
    world: Option<&mut UmbraWorld>,
    joint: u64,
    torque: UmbraFx,
) -> UmbraStatus {
    change(world, Command::SetJointBreakTorque { joint: joint_id(joint), torque: optional_force(torque) })
}

/// Enables a joint, or with 0 disables it; wakes its bodies. Either repairs a broken joint.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_enable_joint(world: Option<&mut UmbraWorld>, joint: u64, is_enabled: u32) -> UmbraStatus {
    change(world, Command::EnableJoint { joint: joint_id(joint), enabled: is_enabled != 0 })
}

/// Reads the definition of a joint.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_joint(
    world: Option<&UmbraWorld>,
    joint: u64,
    def: Option<&mut MaybeUninit<UmbraJointDef>>,
) -> UmbraStatus {
    look(world, def, |world| UmbraJointDef::of(world.joint(joint_id(joint))?.def()))
}

/// Reads where a joint is, its angle, its force and torque in the last step, and whether it is broken.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_joint_state(
    world: Option<&UmbraWorld>,
    joint: u64,
    state: Option<&mut MaybeUninit<UmbraJointState>>,
) -> UmbraStatus {
    look(world, state, |world| {
        let joint = world.joint(joint_id(joint))?;
        Ok(UmbraJointState {
            points: joint.points().map(Into::into),
            length: joint.length().to_bits(),
            translation: joint.translation().to_bits(),
            offset: joint.offset().into(),
            angle: joint.angle().to_bits(),
            stop: joint.stop().unwrap_or_default().to_bits(),
            speed: joint.speed().to_bits(),
            force: joint.force().into(),
            torque: joint.torque().to_bits(),
            is_broken: joint.is_broken().into(),
            is_active: joint.is_active().into(),
        })
    })
}

/// The handles of all joints, sorted by their keys, then by themselves; a list as `umbra_world_outcomes` gives it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_joints(
    world: Option<&UmbraWorld>,
    joints: *mut u64,
    capacity: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    guard(|| {
        let all: Vec<u64> = given(world)?.world().joints().map(|joint| joint_word(joint.id())).collect();
        // SAFETY: as the caller promises.
        unsafe { fill(all.into_iter(), joints, capacity, count) }
    })
}

/// The first joint by handle that has a key; `UMBRA_ERROR_NO_SUCH_JOINT` if none has. It looks through all of them.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_joint_with_key(
    world: Option<&UmbraWorld>,
    key: u64,
    joint: Option<&mut MaybeUninit<u64>>,
) -> UmbraStatus {
    look(world, joint, |world| match world.joint_with_key(key) {
        Some(joint) => Ok(joint_word(joint.id())),
        None => Err(Refusal::own(UMBRA_ERROR_NO_SUCH_JOINT, "no joint has this key")),
    })
}

/// All joints that have a key, sorted by their handles; a list as `umbra_world_outcomes` gives it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_joints_with_key(
    world: Option<&UmbraWorld>,
    key: u64,
    joints: *mut u64,
    capacity: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    guard(|| {
        let all: Vec<u64> = given(world)?.world().joints_with_key(key).map(|joint| joint_word(joint.id())).collect();
        // SAFETY: as the caller promises.
        unsafe { fill(all.into_iter(), joints, capacity, count) }
    })
}

/// The mean loads over the last step of the joints with `events` that may break, sorted by their keys, then by their handles; a list as
/// `umbra_world_outcomes` gives it. For a joint that must never break set `break_force` to `INT64_MAX`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_joint_loads(
    world: Option<&UmbraWorld>,
    loads: *mut UmbraJointLoad,
    capacity: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    guard(|| {
        let rows = given(world)?.world().last_report().joint_loads.iter().map(UmbraJointLoad::from);
        // SAFETY: as the caller promises.
        unsafe { fill(rows, loads, capacity, count) }
    })
}

/// The joints with `events` that broke in the last step, sorted by their keys, then by their handles; a list as `umbra_world_outcomes`
/// gives it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_joints_broke(
    world: Option<&UmbraWorld>,
    broke: *mut UmbraJointBroke,
    capacity: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    guard(|| {
        let rows = given(world)?.world().last_report().joints_broke.iter().map(UmbraJointBroke::from);
        // SAFETY: as the caller promises.
        unsafe { fill(rows, broke, capacity, count) }
    })
}
