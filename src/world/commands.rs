//! The table of commands: a row for each call that changes a world.

use alloc::vec::Vec;

use super::command_map::CommandMap;
use super::command_source::CommandSource;
use super::{ApplyOptions, Explosion, ForceOrImpulse, World};
use crate::body::{BodyDef, BodyKind, Damping, Locks, Mass};
use crate::codec::codec_enum;
use crate::collider::{ColliderDef, ContactSettings, MaterialPair};
use crate::contact::Exclusion;
use crate::error::Error;
use crate::force::ForceField;
use crate::fx::Fx;
use crate::integrate::Integrator;
use crate::joint::{JointDef, JointKind, JointMotor};
use crate::math::{Random, TimeStep, Vec2};
use crate::scalar::Scalar;
use crate::slots::{BodyId, ColliderId, FieldId, JointId};

/// Makes [`Command`] and all that follows from its variants.
///
/// A row is `number => Variant { field: type as role(source) } , check EXPRESSION, execute EXPRESSION;`. The number is the first
/// byte of the encoded command and never changes; the fields are encoded in the order of the row. The role is the method of
/// [`CommandMap`] for the field (`with` names a field that the method also takes), the source its method of [`CommandSource`].
/// The expressions see the world and references to the fields. Both are refused for the same reasons, and `check` changes
/// nothing.
macro_rules! commands {
    ($world:ident: $(
        $(#[$doc:meta])*
        $number:literal => $variant:ident
            $({ $($field:ident: $type:ty as $role:ident($source:ident) $(with $other:ident)?),* })?
            $(( $entry:ident: $entry_type:ty as $entry_role:ident($entry_source:ident) ))?,
            check $check:expr,
            execute $execute:expr;
    )*) => {
        /// A call that changes a world, as data to send, record and replay. Each variant stands for a method of [`World`],
        /// which says what it does and when it is refused; [`World`](World#cost) says what each costs.
        #[derive(Clone, Debug, PartialEq)]
        #[non_exhaustive]
        #[allow(missing_docs, reason = "fields are the arguments of the method")]
        #[cfg_attr(
            feature = "serde",
            derive(serde::Serialize, serde::Deserialize),
            serde(
                rename_all = "snake_case",
                deny_unknown_fields,
                bound(
                    serialize = "S: serde::Serialize, S::Factor: serde::Serialize",
                    deserialize = "S: serde::Deserialize<'de>, S::Factor: serde::Deserialize<'de>"
                )
            )
        )]
        pub enum Command<S: Scalar = Fx> {
            $($(#[$doc])* $variant $({ $($field: $type),* })? $(($entry_type))?,)*
        }

        codec_enum!(Command<S>, "the number of a command", {
            $($number => $variant $({ $($field),* })? $(($entry))?),*
        });

        impl<S: Scalar> Command<S> {
            /// The number of its kind: the first of its [bytes](Command::to_bytes).
            ///
            /// ```
            /// use umbra_physics::{BodyId, Command};
            ///
            /// let body = BodyId::from_parts(3, 0);
            /// let wake: Command = Command::Wake(body);
            /// assert_eq!((wake.number(), wake.name()), (15, "Wake"));
            /// assert!(Command::NUMBERS.contains(&wake.number()));
            /// assert_eq!((wake.body(), wake.field()), (Some(body), None));
            /// ```
            #[must_use]
            pub const fn number(&self) -> u8 {
                match self {
                    $(Self::$variant { .. } => $number,)*
                }
            }

            /// The name of its variant, such as `"SetVelocity"`.
            #[must_use]
            pub const fn name(&self) -> &'static str {
                match self {
                    $(Self::$variant { .. } => stringify!($variant),)*
                }
            }

            /// The body that it is about, the first one of two: `None` for a command about a field or about the whole world, and for `AddBody`.
            #[must_use]
            #[allow(unused_variables, unreachable_code, reason = "most fields are no handles, and the first one counts")]
            pub const fn body(&self) -> Option<BodyId> {
                match self {
                    $(Self::$variant $({ $($field),* })? $(($entry))? => {
                        $($(handle!(body: $role($field));)*)?
                        $(handle!(body: $entry_role($entry));)?
                    })*
                }
                None
            }

            /// The force field that it is about: that of `SetField` and of `RemoveField`.
            #[must_use]
            #[allow(unused_variables, reason = "most fields are no handles")]
            pub const fn field(&self) -> Option<FieldId> {
                match self {
                    $(Self::$variant $({ $($field),* })? $(($entry))? => {
                        $($(handle!(field: $role($field));)*)?
                        $(handle!(field: $entry_role($entry));)?
                    })*
                }
                None
            }

            /// The collider that it is about: that of `SetCollider` and of `RemoveCollider`.
            #[must_use]
            #[allow(unused_variables, reason = "most fields are no handles")]
            pub const fn collider(&self) -> Option<ColliderId> {
                match self {
                    $(Self::$variant $({ $($field),* })? $(($entry))? => {
                        $($(handle!(collider: $role($field));)*)?
                        $(handle!(collider: $entry_role($entry));)?
                    })*
                }
                None
            }

            /// The joint that it is about: of `RemoveJoint` and of the commands that change one.
            #[must_use]
            #[allow(unused_variables, reason = "most fields are no handles")]
            pub const fn joint(&self) -> Option<JointId> {
                match self {
                    $(Self::$variant $({ $($field),* })? $(($entry))? => {
                        $($(handle!(joint: $role($field));)*)?
                        $(handle!(joint: $entry_role($entry));)?
                    })*
                }
                None
            }

            /// The command with each value replaced by its counterpart, by the role that the value has.
            ///
            /// # Errors
            /// The error of the first value without a counterpart.
            #[allow(unused_variables, reason = "a command may have no fields")]
            pub fn map<T: Scalar, M: CommandMap<S, T>>(self, map: &mut M) -> Result<Command<T>, M::Error> {
                Ok(match self {
                    $(Self::$variant $({ $($field),* })? $(($entry))? => Command::$variant
                        $({ $($field: map.$role($field $(, $other)?)?),* })?
                        $((map.$entry_role($entry)?))?,)*
                })
            }
        }

        impl Command {
            /// The numbers of the kinds of commands. A number that a kind had which is gone is none of them.
            pub const NUMBERS: &'static [u8] = &[$($number),*];

            /// A command of the kind with this number, with values from a source; `None` if it is none of the
            /// [`NUMBERS`](Self::NUMBERS).
            #[allow(unused_variables, reason = "a command may have no fields")]
            pub fn fill(number: u8, source: &mut impl CommandSource) -> Option<Self> {
                Some(match number {
                    $($number => Self::$variant
                        $({ $($field: source.$source()),* })?
                        $((source.$entry_source()))?,)*
                    _ => return None,
                })
            }
        }

        impl<S: Scalar> World<S> {
            /// Refuses a command that [`execute`](Self::execute) would refuse now, with the same error. Nothing changes, and
            /// nothing is copied.
            ///
            /// # Errors
            /// The errors of the method that the command stands for.
            ///
            /// ```
            /// use umbra_physics::{BodyDef, BodyId, Command, Error, World, WorldDef, vec2};
            ///
            /// let mut world = World::new(WorldDef::default())?;
            /// let body = BodyId::from_parts(0, 0);
            /// let push = Command::SetVelocity { body, velocity: vec2(1, 0) };
            /// assert_eq!(world.check(&push), Err(Error::NoSuchBody { body }));
            /// world.execute(&Command::AddBody(BodyDef::dynamic()))?;
            /// assert_eq!(world.check(&push), Ok(()));
            /// assert!(push.to_bytes().len() <= Command::BYTES);
            /// # Ok::<(), umbra_physics::Error>(())
            /// ```
            pub fn check(&self, command: &Command<S>) -> Result<(), Error> {
                S::check(self, command)
            }

            #[allow(unused_variables, reason = "some checks need no values")]
            pub(crate) fn check_inner(&self, command: &Command<S>) -> Result<(), Error> {
                let $world = self;
                match command {
                    $(Command::$variant $({ $($field),* })? $(($entry))? => dropped($check),)*
                }
            }

            /// Carries out a command.
            ///
            /// # Errors
            /// The errors of the method that the command stands for; the world is as it was.
            pub fn execute(&mut self, command: &Command<S>) -> Result<Created, Error> {
                S::execute(self, command)
            }

            pub(crate) fn execute_inner(&mut self, command: &Command<S>) -> Result<Created, Error> {
                let $world = self;
                match command {
                    $(Command::$variant $({ $($field),* })? $(($entry))? => created($execute),)*
                }
            }
        }
    };
}

/// Returns from the function with the handle in a field, if the field's role is the one asked for.
macro_rules! handle {
    (body: body($id:ident)) => {
        return Some(*$id)
    };
    (field: field($id:ident)) => {
        return Some(*$id)
    };
    (collider: collider($id:ident)) => {
        return Some(*$id)
    };
    (joint: joint($id:ident)) => {
        return Some(*$id)
    };
    ($asked:ident: $role:ident($value:ident)) => {};
}

commands! { world:
    /// Calls [`World::add_body`].
    0 => AddBody(def: BodyDef<S> as body_def(body_def)),
        check world.check_new_body(def),
        execute world.add_body(def.clone());
    /// Calls [`World::remove_body`].
    1 => RemoveBody(body: BodyId as body(body)),
        check world.bodies.find(*body),
        execute world.remove_body(*body);
    /// Calls [`World::apply`].
    2 => Apply { body: BodyId as body(body), action: ForceOrImpulse<S> as force_or_impulse(force_or_impulse) with options, options: ApplyOptions as plain(apply_options) },
        check world.effect(*body, *action, options.frame),
        execute world.apply(*body, *action, *options);
    /// Calls [`World::clear_forces`].
    27 => ClearForces,
        check Ok(()),
        execute { world.clear_forces(); Ok(()) };
    /// Calls [`World::set_position`].
    3 => SetPosition { body: BodyId as body(body), position: Vec2<S> as point(position) },
        check world.check_body_position(*body, *position),
        execute world.set_position(*body, *position);
    /// Calls [`World::set_angle`].
    4 => SetAngle { body: BodyId as body(body), angle: S as angle(angle) },
        check world.check_body_angle(*body, *angle),
        execute world.set_angle(*body, *angle);
    /// Calls [`World::set_velocity`].
    5 => SetVelocity { body: BodyId as body(body), velocity: Vec2<S> as vector(velocity) },
        check world.check_body_velocity(*body, *velocity),
        execute world.set_velocity(*body, *velocity);
    /// Calls [`World::set_angular_velocity`].
    6 => SetAngularVelocity { body: BodyId as body(body), velocity: S as pseudoscalar(angular_velocity) },
        check world.check_body_angular_velocity(*body, *velocity),
        execute world.set_angular_velocity(*body, *velocity);
    /// Calls [`World::set_mass`].
    7 => SetMass { body: BodyId as body(body), mass: Mass<S> as mass(mass) },
        check world.check_body_mass(*body, *mass),
        execute world.set_mass(*body, *mass);
    /// Calls [`World::set_kind`].
    9 => SetKind { body: BodyId as body(body), kind: BodyKind as plain(kind) },
        check world.check_body_kind(*body, *kind),
        execute world.set_kind(*body, *kind);
    /// Calls [`World::set_gravity_scale`].
    10 => SetGravityScale { body: BodyId as body(body), scale: S as scalar(gravity_scale) },
        check world.check_body_gravity_scale(*body, *scale),
        execute world.set_gravity_scale(*body, *scale);
    /// Calls [`World::set_body_damping`].
    11 => SetBodyDamping { body: BodyId as body(body), linear: Option<Damping<S>> as optional_damping(body_damping), angular: Option<Damping<S>> as optional_damping(body_damping) },
        check world.check_body_damping(*body, *linear, *angular),
        execute world.set_body_damping(*body, *linear, *angular);
    /// Calls [`World::set_force_groups`].
    12 => SetForceGroups { body: BodyId as body(body), force_groups: u32 as force_groups(force_groups) },
        check world.bodies.find(*body),
        execute world.set_force_groups(*body, *force_groups);
    /// Calls [`World::set_key`].
    13 => SetKey { body: BodyId as body(body), key: u64 as plain(key) },
        check world.bodies.find(*body),
        execute world.set_key(*body, *key);
    /// Calls [`World::set_user_data`].
    14 => SetUserData { body: BodyId as body(body), user_data: u64 as plain(user_data) },
        check world.bodies.find(*body),
        execute world.set_user_data(*body, *user_data);
    /// Calls [`World::wake`].
    15 => Wake(body: BodyId as body(body)),
        check world.check_taking_part(*body),
        execute world.wake(*body);
    /// Calls [`World::sleep`].
    50 => Sleep(body: BodyId as body(body)),
        check world.check_sleep(*body),
        execute world.sleep(*body);
    /// Calls [`World::release`].
    16 => Release(body: BodyId as body(body)),
        check world.check_release(*body),
        execute world.release(*body);
    /// Calls [`World::add_field`].
    17 => AddField(field: ForceField<S> as force_field(force_field)),
        check world.check_new_field(field),
        execute world.add_field(*field);
    /// Calls [`World::set_field`].
    18 => SetField { id: FieldId as field(field), field: ForceField<S> as force_field(force_field) },
        check world.check_next_field(*id, field),
        execute world.set_field(*id, *field);
    /// Calls [`World::remove_field`].
    19 => RemoveField(id: FieldId as field(field)),
        check world.check_field(*id),
        execute world.remove_field(*id);
    /// Calls [`World::set_time_step`].
    20 => SetTimeStep(time_step: TimeStep as plain(time_step)),
        check world.check_time_step(*time_step),
        execute world.set_time_step(*time_step);
    /// Calls [`World::set_gravity`].
    21 => SetGravity(gravity: Vec2<S> as vector(gravity)),
        check world.check_gravity(*gravity),
        execute world.set_gravity(*gravity);
    /// Calls [`World::set_integrator`].
    22 => SetIntegrator(integrator: Integrator as plain(integrator)),
        check world.check_integrator(*integrator),
        execute world.set_integrator(*integrator);
    /// Calls [`World::set_damping`].
    23 => SetDamping { linear: Damping<S> as damping(damping), angular: Damping<S> as damping(damping) },
        check world.check_damping(*linear, *angular),
        execute world.set_damping(*linear, *angular);
    /// Calls [`World::set_sleep_after`].
    24 => SetSleepAfter(ticks: Option<u32> as plain(sleep_after)),
        check world.check_sleep_after(*ticks),
        execute world.set_sleep_after(*ticks);
    /// Calls [`World::set_random`].
    25 => SetRandom(random: Random as plain(random)),
        check Ok(()),
        execute { world.set_random(*random); Ok(()) };
    /// Calls [`World::set_blob`].
    26 => SetBlob(bytes: Vec<u8> as plain(blob)),
        check World::<S>::check_blob(bytes),
        execute world.set_blob(bytes);
    /// Calls [`World::set_locks`].
    28 => SetLocks { body: BodyId as body(body), locks: Locks as locks(locks) },
        check world.bodies.find(*body),
        execute world.set_locks(*body, *locks);
    /// Calls [`World::set_max_speeds`].
    29 => SetMaxSpeeds { body: BodyId as body(body), linear: Option<S> as optional_scalar(max_speed), angular: Option<S> as optional_scalar(max_angular_speed) },
        check world.check_body_max_speeds(*body, *linear, *angular),
        execute world.set_max_speeds(*body, *linear, *angular);
    /// Calls [`World::disable`].
    30 => Disable(body: BodyId as body(body)),
        check world.check_taking_part(*body),
        execute world.disable(*body);
    /// Calls [`World::enable`].
    31 => Enable(body: BodyId as body(body)),
        check world.check_enable(*body),
        execute world.enable(*body);
    /// Calls [`World::add_collider`].
    33 => AddCollider { body: BodyId as body(body), def: ColliderDef<S> as collider_def(collider_def) },
        check world.check_new_collider(*body, def),
        execute world.add_collider(*body, def.clone());
    /// Calls [`World::set_collider`].
    34 => SetCollider { collider: ColliderId as collider(collider), def: ColliderDef<S> as collider_def(collider_def) },
        check world.check_next_collider(*collider, Some(def)),
        execute world.set_collider(*collider, def.clone());
    /// Calls [`World::remove_collider`].
    35 => RemoveCollider(collider: ColliderId as collider(collider)),
        check world.check_next_collider(*collider, None),
        execute world.remove_collider(*collider);
    /// Calls [`World::set_contact_settings`].
    36 => SetContactSettings(contacts: ContactSettings<S> as contact_settings(contact_settings)),
        check contacts.check(),
        execute world.set_contact_settings(*contacts);
    /// Calls [`World::exclude_pair`].
    37 => ExcludePair { a: BodyId as body(body), b: BodyId as body(body), exclusion: Exclusion as plain(exclusion) },
        check world.check_excluded(*a, *b),
        execute world.exclude_pair(*a, *b, *exclusion);
    /// Calls [`World::allow_pair`].
    38 => AllowPair { a: BodyId as body(body), b: BodyId as body(body) },
        check world.check_two(*a, *b),
        execute world.allow_pair(*a, *b);
    /// Calls [`World::set_material_pair`].
    39 => SetMaterialPair { first: u32 as plain(material), second: u32 as plain(material), pair: Option<MaterialPair<S>> as optional_material_pair(optional_material_pair) },
        check world.colliders.check_material_pair([*first, *second], pair.as_ref()),
        execute world.set_material_pair(*first, *second, *pair);
    /// Calls [`World::set_dominance`].
    40 => SetDominance { body: BodyId as body(body), dominance: i32 as plain(dominance) },
        check world.bodies.find(*body),
        execute world.set_dominance(*body, *dominance);
    /// Calls [`World::set_bullet`].
    41 => SetBullet { body: BodyId as body(body), bullet: bool as plain(bullet) },
        check world.bodies.find(*body),
        execute world.set_bullet(*body, *bullet);
    /// Calls [`World::explode`].
    42 => Explode(explosion: Explosion<S> as explosion(explosion)),
        check world.blast(explosion),
        execute world.explode(explosion);
    /// Calls [`World::add_joint`].
    43 => AddJoint(def: JointDef<S> as joint_def(joint_def)),
        check world.check_new_joint(def),
        execute world.add_joint(*def);
    /// Calls [`World::remove_joint`].
    44 => RemoveJoint(joint: JointId as joint(joint)),
        check world.joints.find(*joint),
        execute world.remove_joint(*joint);
    /// Calls [`World::set_joint_kind`].
    45 => SetJointKind { joint: JointId as joint(joint), kind: JointKind<S> as joint_kind(joint_kind) },
        check world.check_joint_kind(*joint, kind),
        execute world.set_joint_kind(*joint, *kind);
    /// Calls [`World::set_joint_motor`] of a joint whose motor turns its ends. A motor that pushes is a part of
    /// [`SetJointKind`](Self::SetJointKind).
    48 => SetJointMotor { joint: JointId as joint(joint), motor: Option<JointMotor<S>> as turning_motor(optional_joint_motor) },
        check world.check_turning_motor(*joint, *motor),
        execute world.set_turning_motor(*joint, *motor);
    /// Calls [`World::set_joint_break`].
    46 => SetJointBreak { joint: JointId as joint(joint), force: Option<S> as optional_scalar(break_force) },
        check world.check_joint_break(*joint, *force),
        execute world.set_joint_break(*joint, *force);
    /// Calls [`World::set_joint_break_torque`].
    49 => SetJointBreakTorque { joint: JointId as joint(joint), torque: Option<S> as optional_scalar(break_force) },
        check world.check_joint_break(*joint, *torque),
        execute world.set_joint_break_torque(*joint, *torque);
    /// Calls [`World::enable_joint`].
    47 => EnableJoint { joint: JointId as joint(joint), enabled: bool as plain(enabled) },
        check world.joints.find(*joint),
        execute world.enable_joint(*joint, *enabled);
    /// Calls [`World::move_to`].
    32 => MoveTo { body: BodyId as body(body), position: Vec2<S> as point(position), angle: S as angle(angle) },
        check world.check_move(*body, *position, *angle),
        execute world.move_to(*body, *position, *angle);
}

/// The result of a command that was carried out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
pub enum Created {
    /// Nothing new.
    Nothing,
    /// A body.
    Body(BodyId),
    /// A force field.
    ForceField(FieldId),
    /// A collider.
    Collider(ColliderId),
    /// A joint.
    Joint(JointId),
}

impl From<()> for Created {
    fn from((): ()) -> Self {
        Self::Nothing
    }
}

impl From<BodyId> for Created {
    fn from(body: BodyId) -> Self {
        Self::Body(body)
    }
}

impl From<FieldId> for Created {
    fn from(field: FieldId) -> Self {
        Self::ForceField(field)
    }
}

impl From<ColliderId> for Created {
    fn from(collider: ColliderId) -> Self {
        Self::Collider(collider)
    }
}

impl From<JointId> for Created {
    fn from(joint: JointId) -> Self {
        Self::Joint(joint)
    }
}

fn created(result: Result<impl Into<Created>, Error>) -> Result<Created, Error> {
    result.map(Into::into)
}

fn dropped<T>(checked: Result<T, Error>) -> Result<(), Error> {
    checked.map(drop)
}
