//! Rebuilding a command value by value.
//!
//! A value is known by its role: a position turns with the world, an angular velocity changes its sign in a mirror. The rows
//! of the table in `commands.rs` name the role of each field.

use super::{ApplyOptions, Explosion, ForceOrImpulse, Frame};
use crate::body::{BodyDef, Damping, Locks, Mass};
use crate::collider::{ColliderDef, ContactSettings, Material, MaterialPair, OneWay};
use crate::force::{Attachment, End, FieldKind, ForceField, Region};
use crate::joint::{
    Distance, Gear, JointDef, JointKind, JointLimits, JointMotor, JointSpring, Motor, PlanarMotor, PlanarSpring,
    Prismatic, Pulley, Revolute, Weld, Wheel,
};
use crate::math::Vec2;
use crate::scalar::{Scalar, SpringConstants};
use crate::shape::Shape;
use crate::slots::{BodyId, ColliderId, FieldId, JointId};

use alloc::vec::Vec;

/// A way in which a map takes a scalar.
type MapScalar<M, S, T, E> = fn(&mut M, S) -> Result<T, E>;

/// A change of all values of one role in a [`Command`](super::Command), for [`Command::map`](super::Command::map).
///
/// Three methods are required: they convert from the scalar `S` to the scalar `T`, or return the value. Every other method has
/// a default that returns the value, or rebuilds it with the methods of its parts. Override the roles that change.
///
/// ```
/// use umbra_physics::{BodyId, Command, CommandMap, Fx, FxFactor, Shape, fx, vec2};
///
/// /// Renames bodies: slot 0 becomes slot 7.
/// struct Rename;
///
/// impl CommandMap<Fx> for Rename {
///     type Error = core::convert::Infallible;
///     fn scalar(&mut self, value: Fx) -> Result<Fx, Self::Error> {
///         Ok(value)
///     }
///     fn factor(&mut self, value: FxFactor) -> Result<FxFactor, Self::Error> {
///         Ok(value)
///     }
///     fn shape(&mut self, shape: Shape) -> Result<Shape, Self::Error> {
///         Ok(shape)
///     }
///     fn body(&mut self, body: BodyId) -> Result<BodyId, Self::Error> {
///         let (slot, generation) = body.parts();
///         Ok(BodyId::from_parts(if slot == 0 { 7 } else { slot }, generation))
///     }
/// }
///
/// let [old, new] = [0, 7].map(|slot| BodyId::from_parts(slot, 0));
/// let command = Command::SetVelocity { body: old, velocity: vec2(1, 0) };
/// assert_eq!(command.map(&mut Rename), Ok(Command::SetVelocity { body: new, velocity: vec2(1, 0) }));
/// ```
#[allow(clippy::missing_errors_doc, reason = "every method fails for a value without a counterpart")]
pub trait CommandMap<S: Scalar, T: Scalar = S> {
    /// The reason why a value has no counterpart.
    type Error;

    /// A scalar without a direction: a mass, length, stiffness, share or gravity scale.
    fn scalar(&mut self, value: S) -> Result<T, Self::Error>;

    /// The strength μ of an attractor.
    fn factor(&mut self, value: S::Factor) -> Result<T::Factor, Self::Error>;

    /// A shape.
    fn shape(&mut self, shape: Shape<S>) -> Result<Shape<T>, Self::Error>;

    /// A handle of a body.
    fn body(&mut self, body: BodyId) -> Result<BodyId, Self::Error> {
        Ok(body)
    }

    /// A handle of a force field.
    fn field(&mut self, field: FieldId) -> Result<FieldId, Self::Error> {
        Ok(field)
    }

    /// A handle of a collider.
    fn collider(&mut self, collider: ColliderId) -> Result<ColliderId, Self::Error> {
        Ok(collider)
    }

    /// A handle of a joint.
    fn joint(&mut self, joint: JointId) -> Result<JointId, Self::Error> {
        Ok(joint)
    }

    /// A velocity, force, impulse or acceleration in the world's axes.
    fn vector(&mut self, vector: Vec2<S>) -> Result<Vec2<T>, Self::Error> {
        Ok(Vec2::new(self.scalar(vector.x)?, self.scalar(vector.y)?))
    }

    /// A point of the world.
    fn point(&mut self, point: Vec2<S>) -> Result<Vec2<T>, Self::Error> {
        self.vector(point)
    }

    /// A point or vector in the axes of a body.
    fn local(&mut self, local: Vec2<S>) -> Result<Vec2<T>, Self::Error> {
        self.vector(local)
    }

    /// An angle in radians.
    fn angle(&mut self, angle: S) -> Result<T, Self::Error> {
        self.scalar(angle)
    }

    /// A scalar that changes its sign in a mirror: an angular velocity, torque or angular impulse.
    fn pseudoscalar(&mut self, value: S) -> Result<T, Self::Error> {
        self.scalar(value)
    }

    /// A position or a velocity along the axis of a joint, which turns with its body.
    fn along(&mut self, value: S) -> Result<T, Self::Error> {
        self.scalar(value)
    }

    /// The teeth of gears.
    fn gear(&mut self, gear: Gear) -> Result<Gear, Self::Error> {
        Ok(gear)
    }

    /// A scalar that may be absent.
    fn optional_scalar(&mut self, value: Option<S>) -> Result<Option<T>, Self::Error> {
        value.map(|value| self.scalar(value)).transpose()
    }

    /// A damping of the world.
    fn damping(&mut self, damping: Damping<S>) -> Result<Damping<T>, Self::Error> {
        damping.decay().try_map(|value| self.scalar(value)).map(Damping::new)
    }

    /// A damping of a body's own, which may be absent.
    fn optional_damping(&mut self, damping: Option<Damping<S>>) -> Result<Option<Damping<T>>, Self::Error> {
        damping.map(|damping| self.damping(damping)).transpose()
    }

    /// The bits of the groups that a body is in, or that a field acts on.
    fn force_groups(&mut self, force_groups: u32) -> Result<u32, Self::Error> {
        Ok(force_groups)
    }

    /// The locked axes of a body.
    fn locks(&mut self, locks: Locks) -> Result<Locks, Self::Error> {
        Ok(locks)
    }

    /// A value that is the same in every run: a key, a kind, a number of ticks, bytes.
    fn plain<V>(&mut self, value: V) -> Result<V, Self::Error> {
        Ok(value)
    }

    /// The id of a custom force.
    fn custom_force(&mut self, id: u64) -> Result<u64, Self::Error> {
        Ok(id)
    }

    /// A mass.
    fn mass(&mut self, mass: Mass<S>) -> Result<Mass<T>, Self::Error> {
        Ok(match mass {
            Mass::Kilograms(mass) => Mass::Kilograms(self.scalar(mass)?),
            Mass::Explicit { mass, inertia } => {
                Mass::Explicit { mass: self.scalar(mass)?, inertia: self.scalar(inertia)? }
            }
            Mass::FromColliders => Mass::FromColliders,
        })
    }

    /// The definition of a body.
    fn body_def(&mut self, def: BodyDef<S>) -> Result<BodyDef<T>, Self::Error> {
        Ok(BodyDef {
            kind: def.kind,
            position: self.point(def.position)?,
            angle: self.angle(def.angle)?,
            velocity: self.vector(def.velocity)?,
            angular_velocity: self.pseudoscalar(def.angular_velocity)?,
            colliders: self.colliders(def.colliders)?,
            mass: self.mass(def.mass)?,
            gravity_scale: self.scalar(def.gravity_scale)?,
            linear_damping: self.optional_damping(def.linear_damping)?,
            angular_damping: self.optional_damping(def.angular_damping)?,
            max_speed: self.optional_scalar(def.max_speed)?,
            max_angular_speed: self.optional_scalar(def.max_angular_speed)?,
            locks: self.locks(def.locks)?,
            dominance: def.dominance,
            bullet: def.bullet,
            force_groups: self.force_groups(def.force_groups)?,
            key: def.key,
            user_data: def.user_data,
        })
    }

    /// The colliders of the definition of a body.
    fn colliders(&mut self, defs: Vec<ColliderDef<S>>) -> Result<Vec<ColliderDef<T>>, Self::Error> {
        defs.into_iter().map(|def| self.collider_def(def)).collect()
    }

    /// The definition of a collider.
    fn collider_def(&mut self, def: ColliderDef<S>) -> Result<ColliderDef<T>, Self::Error> {
        Ok(ColliderDef {
            shape: self.shape(def.shape)?,
            position: self.local(def.position)?,
            angle: self.pseudoscalar(def.angle)?,
            density: self.scalar(def.density)?,
            material: Material {
                friction: self.scalar(def.material.friction)?,
                restitution: self.scalar(def.material.restitution)?,
                rolling_resistance: self.scalar(def.material.rolling_resistance)?,
                surface_speed: self.pseudoscalar(def.material.surface_speed)?,
                friction_rule: def.material.friction_rule,
                restitution_rule: def.material.restitution_rule,
                id: def.material.id,
            },
            filter: def.filter,
            one_way: match def.one_way {
                Some(OneWay { direction, tolerance }) => {
                    Some(OneWay { direction: self.local(direction)?, tolerance: self.scalar(tolerance)? })
                }
                None => None,
            },
            sensor: def.sensor,
            contact_events: def.contact_events,
            hit_events: def.hit_events,
            key: def.key,
            user_data: def.user_data,
        })
    }

    /// The settings of contacts.
    fn contact_settings(&mut self, settings: ContactSettings<S>) -> Result<ContactSettings<T>, Self::Error> {
        Ok(ContactSettings {
            substeps: settings.substeps,
            push_speed: self.scalar(settings.push_speed)?,
            restitution_speed: self.scalar(settings.restitution_speed)?,
            sleep_speed: self.scalar(settings.sleep_speed)?,
            hit_speed: self.scalar(settings.hit_speed)?,
            max_pairs: settings.max_pairs,
            max_pairs_per_collider: settings.max_pairs_per_collider,
        })
    }

    /// The coefficients of two materials together, which may be absent.
    fn optional_material_pair(
        &mut self,
        pair: Option<MaterialPair<S>>,
    ) -> Result<Option<MaterialPair<T>>, Self::Error> {
        let Some(pair) = pair else { return Ok(None) };
        Ok(Some(MaterialPair {
            friction: self.scalar(pair.friction)?,
            restitution: self.scalar(pair.restitution)?,
            rolling_resistance: self.scalar(pair.rolling_resistance)?,
        }))
    }

    /// A point of a body that a field is attached to.
    fn attachment(&mut self, at: Attachment<S>) -> Result<Attachment<T>, Self::Error> {
        Ok(Attachment { body: self.body(at.body)?, point: self.local(at.point)? })
    }

    /// An end of a field.
    fn end(&mut self, end: End<S>) -> Result<End<T>, Self::Error> {
        Ok(match end {
            End::World(point) => End::World(self.point(point)?),
            End::Body(at) => End::Body(self.attachment(at)?),
        })
    }

    /// A region of the world.
    fn region(&mut self, region: Region<S>) -> Result<Region<T>, Self::Error> {
        Ok(match region {
            Region::Disc { centre, radius } => {
                Region::Disc { centre: self.point(centre)?, radius: self.scalar(radius)? }
            }
            Region::Box { min, max } => {
                let (min, max) = self.corners(min, max)?;
                Region::Box { min, max }
            }
        })
    }

    /// The least and the greatest corner of a box along the axes.
    fn corners(&mut self, min: Vec2<S>, max: Vec2<S>) -> Result<(Vec2<T>, Vec2<T>), Self::Error> {
        Ok((self.point(min)?, self.point(max)?))
    }

    /// A force field.
    fn force_field(&mut self, field: ForceField<S>) -> Result<ForceField<T>, Self::Error> {
        let kind = match field.kind {
            FieldKind::Attractor { centre, mu, softening } => FieldKind::Attractor {
                centre: self.end(centre)?,
                mu: self.factor(mu)?,
                softening: self.scalar(softening)?,
            },
            FieldKind::Spring { near, far, spring } => FieldKind::Spring {
                near: self.attachment(near)?,
                far: self.end(far)?,
                spring: SpringConstants {
                    rest: self.scalar(spring.rest)?,
                    stiffness: self.scalar(spring.stiffness)?,
                    damping: self.scalar(spring.damping)?,
                },
            },
            FieldKind::Drag { linear, quadratic, wind } => FieldKind::Drag {
                linear: self.scalar(linear)?,
                quadratic: self.scalar(quadratic)?,
                wind: self.vector(wind)?,
            },
            FieldKind::Friction { deceleration, angular_deceleration } => FieldKind::Friction {
                deceleration: self.scalar(deceleration)?,
                angular_deceleration: self.scalar(angular_deceleration)?,
            },
            FieldKind::Thrust { at, force } => {
                FieldKind::Thrust { at: self.attachment(at)?, force: self.local(force)? }
            }
            FieldKind::Zone { region, acceleration } => {
                FieldKind::Zone { region: self.region(region)?, acceleration: self.vector(acceleration)? }
            }
            FieldKind::Buoyancy { min, max, density, linear_drag, angular_drag, flow } => {
                let (min, max) = self.corners(min, max)?;
                FieldKind::Buoyancy {
                    min,
                    max,
                    density: self.scalar(density)?,
                    linear_drag: self.scalar(linear_drag)?,
                    angular_drag: self.scalar(angular_drag)?,
                    flow: self.vector(flow)?,
                }
            }
            FieldKind::Custom { id } => FieldKind::Custom { id: self.custom_force(id)? },
        };
        Ok(ForceField { kind, force_groups: self.force_groups(field.force_groups)? })
    }

    /// A joint.
    fn joint_def(&mut self, def: JointDef<S>) -> Result<JointDef<T>, Self::Error> {
        let mut angle = |end: &End<S>, angle: S| match end {
            End::World(_) => self.angle(angle),
            End::Body(_) => self.pseudoscalar(angle),
        };
        let angles = [angle(&def.ends[0], def.angles[0])?, angle(&def.ends[1], def.angles[1])?];
        let [first, second] = def.ends;
        Ok(JointDef {
            ends: [self.end(first)?, self.end(second)?],
            angles,
            kind: self.joint_kind(def.kind)?,
            collide_connected: def.collide_connected,
            enabled: def.enabled,
            break_force: self.optional_scalar(def.break_force)?,
            break_torque: self.optional_scalar(def.break_torque)?,
            events: def.events,
            key: def.key,
            user_data: def.user_data,
        })
    }

    /// The kind of a joint.
    fn joint_kind(&mut self, kind: JointKind<S>) -> Result<JointKind<T>, Self::Error> {
        let [around, along, plain] = [Self::pseudoscalar, Self::along, Self::scalar];
        Ok(match kind {
            JointKind::Revolute(Revolute { limits, motor, spring, friction, ratchet }) => {
                let is_mirrored = self.pseudoscalar(S::ONE)? < T::ZERO;
                JointKind::Revolute(Revolute {
                    limits: self.joint_limits(limits, around)?,
                    motor: self.joint_motor(motor, around)?,
                    spring: self.joint_spring(spring, around)?,
                    friction: self.scalar(friction)?,
                    ratchet: ratchet.map(|teeth| if is_mirrored { teeth.saturating_neg() } else { teeth }),
                })
            }
            JointKind::Weld(Weld { spring }) => JointKind::Weld(Weld { spring: self.joint_spring(spring, around)? }),
            JointKind::Distance(Distance { limits, motor, spring, friction }) => JointKind::Distance(Distance {
                limits: self.joint_limits(limits, plain)?,
                motor: self.joint_motor(motor, plain)?,
                spring: self.joint_spring(spring, plain)?,
                friction: self.scalar(friction)?,
            }),
            JointKind::Prismatic(Prismatic { limits, motor, spring, friction }) => JointKind::Prismatic(Prismatic {
                limits: self.joint_limits(limits, along)?,
                motor: self.joint_motor(motor, along)?,
                spring: self.joint_spring(spring, along)?,
                friction: self.scalar(friction)?,
            }),
            JointKind::Wheel(Wheel { limits, spring, motor, friction }) => JointKind::Wheel(Wheel {
                limits: self.joint_limits(limits, along)?,
                spring: self.joint_spring(spring, along)?,
                motor: self.joint_motor(motor, around)?,
                friction: self.scalar(friction)?,
            }),
            JointKind::Gear(gear) => JointKind::Gear(self.gear(gear)?),
            JointKind::Pulley(Pulley { grounds: [first, second], strands, length }) => JointKind::Pulley(Pulley {
                grounds: [self.point(first)?, self.point(second)?],
                strands,
                length: self.scalar(length)?,
            }),
            JointKind::Motor(Motor { spring, motor, angular_spring, angular_motor }) => JointKind::Motor(Motor {
                spring: self.planar_spring(spring)?,
                motor: self.planar_motor(motor)?,
                angular_spring: self.joint_spring(angular_spring, around)?,
                angular_motor: self.joint_motor(angular_motor, around)?,
            }),
        })
    }

    /// Limits of positions that are mapped so. They change places where positions change their sign.
    fn joint_limits(
        &mut self,
        limits: Option<JointLimits<S>>,
        position: MapScalar<Self, S, T, Self::Error>,
    ) -> Result<Option<JointLimits<T>>, Self::Error> {
        let Some(JointLimits { lower, upper }) = limits else { return Ok(None) };
        let [lower, upper] = [position(self, lower)?, position(self, upper)?];
        Ok(Some(if upper < lower { JointLimits { lower: upper, upper: lower } } else { JointLimits { lower, upper } }))
    }

    /// A motor whose speed is mapped so.
    fn joint_motor(
        &mut self,
        motor: Option<JointMotor<S>>,
        speed: MapScalar<Self, S, T, Self::Error>,
    ) -> Result<Option<JointMotor<T>>, Self::Error> {
        let Some(motor) = motor else { return Ok(None) };
        Ok(Some(JointMotor { speed: speed(self, motor.speed)?, max_force: self.scalar(motor.max_force)? }))
    }

    /// A motor that turns.
    fn turning_motor(&mut self, motor: Option<JointMotor<S>>) -> Result<Option<JointMotor<T>>, Self::Error> {
        self.joint_motor(motor, Self::pseudoscalar)
    }

    /// A spring whose position at rest is mapped so.
    fn joint_spring(
        &mut self,
        spring: Option<JointSpring<S>>,
        position: MapScalar<Self, S, T, Self::Error>,
    ) -> Result<Option<JointSpring<T>>, Self::Error> {
        let Some(spring) = spring else { return Ok(None) };
        Ok(Some(JointSpring {
            hertz: self.scalar(spring.hertz)?,
            damping_ratio: self.scalar(spring.damping_ratio)?,
            rest: position(self, spring.rest)?,
            max_force: self.optional_scalar(spring.max_force)?,
        }))
    }

    /// A spring in the frame of the first end of a joint.
    fn planar_spring(&mut self, spring: Option<PlanarSpring<S>>) -> Result<Option<PlanarSpring<T>>, Self::Error> {
        let Some(spring) = spring else { return Ok(None) };
        Ok(Some(PlanarSpring {
            hertz: self.scalar(spring.hertz)?,
            damping_ratio: self.scalar(spring.damping_ratio)?,
            rest: self.local(spring.rest)?,
            max_force: self.optional_scalar(spring.max_force)?,
        }))
    }

    /// A motor in the frame of the first end of a joint.
    fn planar_motor(&mut self, motor: Option<PlanarMotor<S>>) -> Result<Option<PlanarMotor<T>>, Self::Error> {
        let Some(motor) = motor else { return Ok(None) };
        Ok(Some(PlanarMotor { velocity: self.local(motor.velocity)?, max_force: self.scalar(motor.max_force)? }))
    }

    /// A force or impulse, whose vectors are in this frame.
    fn force_or_impulse(
        &mut self,
        action: ForceOrImpulse<S>,
        options: ApplyOptions,
    ) -> Result<ForceOrImpulse<T>, Self::Error> {
        let is_local = options.frame == Frame::Body;
        let vector = |map: &mut Self, v| if is_local { map.local(v) } else { map.vector(v) };
        let point = |map: &mut Self, point: Option<_>| {
            point.map(|point| if is_local { map.local(point) } else { map.point(point) }).transpose()
        };
        Ok(match action {
            ForceOrImpulse::Force { force, point: at } => {
                ForceOrImpulse::Force { force: vector(self, force)?, point: point(self, at)? }
            }
            ForceOrImpulse::Torque(torque) => ForceOrImpulse::Torque(self.pseudoscalar(torque)?),
            ForceOrImpulse::Impulse { impulse, point: at } => {
                ForceOrImpulse::Impulse { impulse: vector(self, impulse)?, point: point(self, at)? }
            }
            ForceOrImpulse::AngularImpulse(impulse) => ForceOrImpulse::AngularImpulse(self.pseudoscalar(impulse)?),
        })
    }

    /// An explosion.
    fn explosion(&mut self, explosion: Explosion<S>) -> Result<Explosion<T>, Self::Error> {
        let Explosion { position, radius, falloff, impulse, mask } = explosion;
        Ok(Explosion {
            position: self.point(position)?,
            radius: self.scalar(radius)?,
            falloff: self.scalar(falloff)?,
            impulse: self.scalar(impulse)?,
            mask,
        })
    }
}
