//! Making a command from nothing: a value for each role.

use alloc::vec::Vec;

use super::{ApplyOptions, Explosion, ForceOrImpulse};
use crate::body::{BodyDef, BodyKind, Damping, Locks, Mass};
use crate::collider::{ColliderDef, ContactSettings, MaterialPair};
use crate::contact::Exclusion;
use crate::force::ForceField;
use crate::fx::Fx;
use crate::integrate::Integrator;
use crate::joint::{JointDef, JointKind, JointMotor};
use crate::math::{Random, TimeStep, Vec2};
use crate::slots::{BodyId, ColliderId, FieldId, JointId};

/// A source of values for [`Command::fill`](super::Command::fill): a method for each kind of value in a command. The ranges are
/// the source's own choice; a world refuses a command with a value out of range.
#[allow(missing_docs, reason = "each method gives the argument of this name of a method of `World`")]
pub trait CommandSource {
    fn body(&mut self) -> BodyId;
    fn field(&mut self) -> FieldId;
    fn collider(&mut self) -> ColliderId;
    fn joint(&mut self) -> JointId;
    fn joint_def(&mut self) -> JointDef;
    fn joint_kind(&mut self) -> JointKind;
    fn optional_joint_motor(&mut self) -> Option<JointMotor>;
    fn break_force(&mut self) -> Option<Fx>;
    fn enabled(&mut self) -> bool;
    fn collider_def(&mut self) -> ColliderDef;
    fn contact_settings(&mut self) -> ContactSettings;
    fn exclusion(&mut self) -> Exclusion;
    fn material(&mut self) -> u32;
    fn optional_material_pair(&mut self) -> Option<MaterialPair>;
    fn body_def(&mut self) -> BodyDef;
    fn force_field(&mut self) -> ForceField;
    fn force_or_impulse(&mut self) -> ForceOrImpulse;
    fn apply_options(&mut self) -> ApplyOptions;
    fn explosion(&mut self) -> Explosion;
    fn position(&mut self) -> Vec2;
    fn angle(&mut self) -> Fx;
    fn velocity(&mut self) -> Vec2;
    fn angular_velocity(&mut self) -> Fx;
    fn mass(&mut self) -> Mass;
    fn kind(&mut self) -> BodyKind;
    fn gravity_scale(&mut self) -> Fx;
    fn body_damping(&mut self) -> Option<Damping>;
    fn max_speed(&mut self) -> Option<Fx>;
    fn max_angular_speed(&mut self) -> Option<Fx>;
    fn dominance(&mut self) -> i32;
    fn bullet(&mut self) -> bool;
    fn force_groups(&mut self) -> u32;
    fn key(&mut self) -> u64;
    fn user_data(&mut self) -> u64;
    fn locks(&mut self) -> Locks;
    fn time_step(&mut self) -> TimeStep;
    fn gravity(&mut self) -> Vec2;
    fn integrator(&mut self) -> Integrator;
    fn damping(&mut self) -> Damping;
    fn sleep_after(&mut self) -> Option<u32>;
    fn random(&mut self) -> Random;
    fn blob(&mut self) -> Vec<u8>;
}
