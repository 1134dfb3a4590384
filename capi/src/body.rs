//! Bodies: making them, reading them, changing them.

use std::mem::MaybeUninit;

use umbra_physics::{Activity, BodyDef, BodyKind, BodyRef, Command, Damping, Fx, FxAccumulator, Locks, Mass, Vec2};

use crate::UMBRA_NO_HANDLE;
use crate::memory::{fill, given};
use crate::number::{UMBRA_ONE, UmbraFactor, UmbraFx, UmbraInt128, UmbraVec2, vector};
use crate::status::{Refusal, Result, UMBRA_ERROR_NO_SUCH_BODY, UMBRA_ERROR_NUMBER_OUT_OF_RANGE, UmbraStatus, guard};
use crate::world::{UmbraWorld, body_id, body_word, change, change_by, created, look, word};

/// How a body moves: one of the three values below.
pub type UmbraBodyKind = u32;

/// Never moves.
pub const UMBRA_STATIC: UmbraBodyKind = 0;
/// Moves at the velocity you set. Forces, damping and contacts have no effect on it; it pushes dynamic bodies.
pub const UMBRA_KINEMATIC: UmbraBodyKind = 1;
/// Responds to forces, gravity, damping and contacts.
pub const UMBRA_DYNAMIC: UmbraBodyKind = 2;

/// State of activity of a body: one of the four values below.
pub type UmbraActivity = u32;

/// The body takes part in steps.
pub const UMBRA_AWAKE: UmbraActivity = 0;
/// The body is at rest and is skipped until something wakes it.
pub const UMBRA_ASLEEP: UmbraActivity = 1;
/// The body left the allowed range: restored to its last good state and excluded from simulation until it is released.
pub const UMBRA_QUARANTINED: UmbraActivity = 2;
/// The body was taken out of the simulation by a call, until it is enabled.
pub const UMBRA_DISABLED: UmbraActivity = 3;

/// Source of mass and moment of inertia: one of the three values below.
pub type UmbraMassKind = u32;

/// `mass` in kg. The inertia follows from the colliders; without any it is infinite.
pub const UMBRA_MASS_KILOGRAMS: UmbraMassKind = 1;
/// `mass` in kg and `inertia` in kg·m².
pub const UMBRA_MASS_EXPLICIT: UmbraMassKind = 2;
/// The mass and the inertia of the colliders; without any as `UMBRA_MASS_KILOGRAMS` with 1 kg. `mass` is not read.
pub const UMBRA_MASS_FROM_COLLIDERS: UmbraMassKind = 3;

/// In place of a damping of a body's own: that of the world.
pub const UMBRA_AS_WORLD: UmbraFx = -1;

/// In place of a largest speed: none.
pub const UMBRA_NO_LIMIT: UmbraFx = -1;

/// Components of a body's velocity that are held at zero: 0, or any of the flags below.
pub type UmbraLocks = u32;

/// The velocity along x.
pub const UMBRA_LOCK_X: UmbraLocks = 1;
/// The velocity along y.
pub const UMBRA_LOCK_Y: UmbraLocks = 2;
/// The angular velocity.
pub const UMBRA_LOCK_ROTATION: UmbraLocks = 4;

/// Definition of a body; `umbra_body_def_default` fills it in.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct UmbraBodyDef {
    /// How the body moves; default `UMBRA_DYNAMIC`.
    pub kind: UmbraBodyKind,
    /// Source of the mass; default `UMBRA_MASS_FROM_COLLIDERS`.
    pub mass_kind: UmbraMassKind,
    /// Mass in kg, 2^-16 to 2^24, unless it is that of the colliders; default 1.
    pub mass: UmbraFx,
    /// Moment of inertia, for `UMBRA_MASS_EXPLICIT` only.
    pub inertia: UmbraFx,
    /// Position of the centre of mass, m, within ±2^30; default the origin.
    pub position: UmbraVec2,
    /// Velocity, m/s, within ±2^20; default 0.
    pub velocity: UmbraVec2,
    /// Angle, rad, of any size; default 0.
    pub angle: UmbraFx,
    /// Angular velocity, rad/s, within ±2^20; default 0.
    pub angular_velocity: UmbraFx,
    /// Factor on the world's gravity, within ±16; default 1.
    pub gravity_scale: UmbraFx,
    /// Damping: the share of the velocity that is left after a second, from 0 (stops at once) to `UMBRA_ONE` (none). This is not the
    /// damping of Box2D, which is a rate: `umbra_kept_at_rate` makes one from it. Default `UMBRA_AS_WORLD`.
    pub linear_kept_per_second: UmbraFx,
    /// Damping: the share of the angular velocity that is left after a second; default `UMBRA_AS_WORLD`.
    pub angular_kept_per_second: UmbraFx,
    /// The largest speed it has after a step, 0 to 2^20 m/s, if it is dynamic: `UMBRA_NO_LIMIT`.
    pub max_speed: UmbraFx,
    /// The largest angular speed it has after a step, 0 to 2^20 rad/s, if it is dynamic: `UMBRA_NO_LIMIT`.
    pub max_angular_speed: UmbraFx,
    /// A name of the caller's, by which worlds built in another order are compared: 0.
    pub key: u64,
    /// Anything of the caller's: 0.
    pub user_data: u64,
    /// The groups it is in: a force field with one of these bits acts on it. 1.
    pub force_groups: u32,
    /// Components of the velocity that are held at zero; default none.
    pub locks: UmbraLocks,
    /// The dominance: in a contact of two dynamic bodies, the body with the higher number is not moved; default 0.
    pub dominance: i32,
    /// 1 for a bullet, which never crosses dynamic bodies either; default 0.
    pub is_bullet: u32,
}

/// A body as it is. Its colliders, what its mass was given as and where it is sent have functions of their own.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UmbraBodyState {
    /// Position of the centre of mass, m.
    pub position: UmbraVec2,
    /// Velocity, m/s.
    pub velocity: UmbraVec2,
    /// Angle, rad in [0, 2π).
    pub angle: UmbraFx,
    /// Angular velocity, rad/s.
    pub angular_velocity: UmbraFx,
    /// The cosine of its angle.
    pub cos: UmbraFx,
    /// The sine of its angle.
    pub sin: UmbraFx,
    /// Full position with the carried remainder: multiples of 2^-96 m.
    pub exact_x: UmbraInt128,
    /// See `exact_x`.
    pub exact_y: UmbraInt128,
    /// Full velocity: multiples of 2^-96 m/s.
    pub exact_velocity_x: UmbraInt128,
    /// See `exact_velocity_x`.
    pub exact_velocity_y: UmbraInt128,
    /// Full angular velocity: multiples of 2^-96 rad/s.
    pub exact_angular_velocity: UmbraInt128,
    /// Full angle: multiples of 2^-64 turns.
    pub turn: u64,
    /// Mass, kg; 0 unless the body is dynamic.
    pub mass: UmbraFx,
    /// Moment of inertia, kg·m²; 0 if it is infinite.
    pub inertia: UmbraFactor,
    /// Factor on the world's gravity.
    pub gravity_scale: UmbraFx,
    /// The share of the velocity that its damping leaves after a second, or minus a rate above 4/s (see `umbra_kept_at_rate`), or
    /// `UMBRA_AS_WORLD`.
    pub linear_kept_per_second: UmbraFx,
    /// As `linear_kept_per_second`, of the angular velocity.
    pub angular_kept_per_second: UmbraFx,
    /// The largest speed it has after a step, or `UMBRA_NO_LIMIT`.
    pub max_speed: UmbraFx,
    /// The largest angular speed it has after a step, or `UMBRA_NO_LIMIT`.
    pub max_angular_speed: UmbraFx,
    /// The caller's name for it.
    pub key: u64,
    /// The caller's data.
    pub user_data: u64,
    /// How the body moves.
    pub kind: UmbraBodyKind,
    /// State of activity.
    pub activity: UmbraActivity,
    /// The groups it is in.
    pub force_groups: u32,
    /// Components of the velocity that are held at zero.
    pub locks: UmbraLocks,
    /// The dominance: in a contact of two dynamic bodies, the body with the higher number is not moved.
    pub dominance: i32,
    /// 1 for a bullet, else 0.
    pub is_bullet: u32,
    /// 0.
    pub reserved: u32,
}

/// Kinematic target: the pose to which the next step moves a body.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UmbraGoal {
    /// The position it is to have, m.
    pub position: UmbraVec2,
    /// The angle it is to have, rad in [0, 2π).
    pub angle: UmbraFx,
    /// 1, or 0 if the body is not sent anywhere: then all else is 0.
    pub is_there: u32,
    /// 0.
    pub reserved: u32,
}

/// Values of a body needed to draw it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UmbraPose {
    /// The body.
    pub body: u64,
    /// Position of the centre of mass, m.
    pub position: UmbraVec2,
    /// Angle, rad in [0, 2π).
    pub angle: UmbraFx,
    /// The caller's name for it, by which what is drawn stays with its body through a rollback.
    pub key: u64,
    /// The caller's data: what to draw, say.
    pub user_data: u64,
    /// How the body moves.
    pub kind: UmbraBodyKind,
    /// State of activity.
    pub activity: UmbraActivity,
}

fn kind_of(number: UmbraBodyKind) -> Result<BodyKind> {
    match number {
        UMBRA_STATIC => Ok(BodyKind::Static),
        UMBRA_KINEMATIC => Ok(BodyKind::Kinematic),
        UMBRA_DYNAMIC => Ok(BodyKind::Dynamic),
        _ => Err(Refusal::bad("no kind of body has this number")),
    }
}

const fn number_of(kind: BodyKind) -> UmbraBodyKind {
    match kind {
        BodyKind::Static => UMBRA_STATIC,
        BodyKind::Kinematic => UMBRA_KINEMATIC,
        BodyKind::Dynamic => UMBRA_DYNAMIC,
    }
}

const fn activity_of(activity: Activity) -> UmbraActivity {
    match activity {
        Activity::Awake => UMBRA_AWAKE,
        Activity::Asleep => UMBRA_ASLEEP,
        Activity::Quarantined => UMBRA_QUARANTINED,
        Activity::Disabled => UMBRA_DISABLED,
    }
}

fn mass_of(kind: UmbraMassKind, mass: UmbraFx, inertia: UmbraFx) -> Result<Mass> {
    let (mass, inertia) = (Fx::from_bits(mass), Fx::from_bits(inertia));
    match kind {
        UMBRA_MASS_KILOGRAMS => Ok(Mass::Kilograms(mass)),
        UMBRA_MASS_EXPLICIT => Ok(Mass::Explicit { mass, inertia }),
        UMBRA_MASS_FROM_COLLIDERS => Ok(Mass::FromColliders),
        _ => Err(Refusal::bad("no way to give a mass has this number")),
    }
}

fn damping_of(kept: UmbraFx) -> Option<Damping> {
    (kept != UMBRA_AS_WORLD).then(|| Damping::from_number(Fx::from_bits(kept)))
}

fn limit_of(limit: UmbraFx) -> Option<Fx> {
    (limit != UMBRA_NO_LIMIT).then(|| Fx::from_bits(limit))
}

fn locks_of(flags: UmbraLocks) -> Result<Locks> {
    if flags & !(UMBRA_LOCK_X | UMBRA_LOCK_Y | UMBRA_LOCK_ROTATION) != 0 {
        return Err(Refusal::bad("a flag is none of a lock"));
    }
    let has = |flag| flags & flag != 0;
    Ok(Locks { x: has(UMBRA_LOCK_X), y: has(UMBRA_LOCK_Y), rotation: has(UMBRA_LOCK_ROTATION) })
}

fn flags_of(Locks { x, y, rotation }: Locks) -> UmbraLocks {
    let flag = |is_on, flag| if is_on { flag } else { 0 };
    flag(x, UMBRA_LOCK_X) | flag(y, UMBRA_LOCK_Y) | flag(rotation, UMBRA_LOCK_ROTATION)
}

fn exact(value: FxAccumulator) -> UmbraInt128 {
    let bits = value.to_bits();
    UmbraInt128 { low: bits as u64, high: (bits >> 64) as i64 }
}

fn state_of(body: BodyRef<'_>) -> UmbraBodyState {
    let (place, velocity, rotation) = (body.position_exact(), body.velocity_exact(), body.rotation());
    let kept = |damping: Option<Damping>| damping.map_or(UMBRA_AS_WORLD, |damping| damping.number().to_bits());
    let limit = |limit: Option<Fx>| limit.map_or(UMBRA_NO_LIMIT, Fx::to_bits);
    UmbraBodyState {
        position: body.position().into(),
        velocity: body.velocity().into(),
        angle: body.angle().to_bits(),
        angular_velocity: body.angular_velocity().to_bits(),
        cos: rotation.cos.to_bits(),
        sin: rotation.sin.to_bits(),
        exact_x: exact(place.x),
        exact_y: exact(place.y),
        exact_velocity_x: exact(velocity.x),
        exact_velocity_y: exact(velocity.y),
        exact_angular_velocity: exact(body.angular_velocity_exact()),
        turn: body.angle_exact().to_bits(),
        mass: body.mass().map_or(0, Fx::to_bits),
        inertia: body.inertia().unwrap_or_default().into(),
        gravity_scale: body.gravity_scale().to_bits(),
        linear_kept_per_second: kept(body.linear_damping()),
        angular_kept_per_second: kept(body.angular_damping()),
        max_speed: limit(body.max_speed()),
        max_angular_speed: limit(body.max_angular_speed()),
        key: body.key(),
        user_data: body.user_data(),
        kind: number_of(body.kind()),
        activity: activity_of(body.activity()),
        force_groups: body.force_groups(),
        locks: flags_of(body.locks()),
        dominance: body.dominance(),
        is_bullet: body.is_bullet().into(),
        reserved: 0,
    }
}

/// Fills in a definition: a body of 1 kg, or of the mass of the colliders that are added to it, that everything moves, at rest at the origin.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_body_def_default(def: Option<&mut MaybeUninit<UmbraBodyDef>>) -> UmbraStatus {
    guard(|| {
        given(def)?.write(UmbraBodyDef {
            kind: UMBRA_DYNAMIC,
            mass_kind: UMBRA_MASS_FROM_COLLIDERS,
            mass: UMBRA_ONE,
            inertia: 0,
            position: UmbraVec2::default(),
            velocity: UmbraVec2::default(),
            angle: 0,
            angular_velocity: 0,
            gravity_scale: UMBRA_ONE,
            linear_kept_per_second: UMBRA_AS_WORLD,
            angular_kept_per_second: UMBRA_AS_WORLD,
            max_speed: UMBRA_NO_LIMIT,
            max_angular_speed: UMBRA_NO_LIMIT,
            key: 0,
            user_data: 0,
            force_groups: 1,
            locks: 0,
            dominance: 0,
            is_bullet: 0,
        });
        Ok(())
    })
}

/// Adds a body, to which `umbra_world_add_collider` adds colliders. Its handle stays good until it is removed, and never names another one afterwards.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_add_body(
    world: Option<&mut UmbraWorld>,
    def: Option<&UmbraBodyDef>,
    body: Option<&mut MaybeUninit<u64>>,
) -> UmbraStatus {
    guard(|| {
        let (world, def, place) = (given(world)?, given(def)?, given(body)?);
        let new = world.execute(&Command::AddBody(BodyDef {
            kind: kind_of(def.kind)?,
            position: def.position.into(),
            angle: Fx::from_bits(def.angle),
            velocity: def.velocity.into(),
            angular_velocity: Fx::from_bits(def.angular_velocity),
            colliders: Vec::new(),
            mass: mass_of(def.mass_kind, def.mass, def.inertia)?,
            gravity_scale: Fx::from_bits(def.gravity_scale),
            linear_damping: damping_of(def.linear_kept_per_second),
            angular_damping: damping_of(def.angular_kept_per_second),
            max_speed: limit_of(def.max_speed),
            max_angular_speed: limit_of(def.max_angular_speed),
            locks: locks_of(def.locks)?,
            dominance: def.dominance,
            bullet: def.is_bullet != 0,
            force_groups: def.force_groups,
            key: def.key,
            user_data: def.user_data,
        }))?;
        place.write(created(new).1);
        Ok(())
    })
}

/// Removes a body, its colliders and the force fields attached to it, and wakes what they joined it to.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_remove_body(world: Option<&mut UmbraWorld>, body: u64) -> UmbraStatus {
    change(world, Command::RemoveBody(body_id(body)))
}

/// Reads a body.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_body(
    world: Option<&UmbraWorld>,
    body: u64,
    state: Option<&mut MaybeUninit<UmbraBodyState>>,
) -> UmbraStatus {
    look(world, state, |world| Ok(state_of(world.body(body_id(body))?)))
}

/// Mass of a body as it was given, to the bit, also while it is not dynamic; a `mass` or an `inertia` that was not given is 0.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_body_mass_def(
    world: Option<&UmbraWorld>,
    body: u64,
    kind: Option<&mut MaybeUninit<UmbraMassKind>>,
    mass: Option<&mut MaybeUninit<UmbraFx>>,
    inertia: Option<&mut MaybeUninit<UmbraFx>>,
) -> UmbraStatus {
    guard(|| {
        let (world, kind, mass, inertia) = (given(world)?, given(kind)?, given(mass)?, given(inertia)?);
        let mass_def = match world.world().body(body_id(body))?.mass_def() {
            Mass::Kilograms(mass) => (UMBRA_MASS_KILOGRAMS, mass, Fx::ZERO),
            Mass::Explicit { mass, inertia } => (UMBRA_MASS_EXPLICIT, mass, inertia),
            Mass::FromColliders => (UMBRA_MASS_FROM_COLLIDERS, Fx::ZERO, Fx::ZERO),
        };
        kind.write(mass_def.0);
        mass.write(mass_def.1.to_bits());
        inertia.write(mass_def.2.to_bits());
        Ok(())
    })
}

/// Kinematic target of a body, if it has one.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_body_goal(
    world: Option<&UmbraWorld>,
    body: u64,
    goal: Option<&mut MaybeUninit<UmbraGoal>>,
) -> UmbraStatus {
    look(world, goal, |world| {
        let goal = world.body(body_id(body))?.goal();
        Ok(goal.map_or_else(UmbraGoal::default, |(position, angle)| UmbraGoal {
            position: position.into(),
            angle: angle.radians().to_bits(),
            is_there: 1,
            reserved: 0,
        }))
    })
}

/// Hands on what a body makes of two numbers.
fn seen(
    world: Option<&UmbraWorld>,
    body: u64,
    place: Option<&mut MaybeUninit<UmbraVec2>>,
    vector: impl FnOnce(BodyRef<'_>) -> Option<Vec2>,
) -> UmbraStatus {
    look(world, place, |world| match vector(world.body(body_id(body))?) {
        Some(value) => Ok(value.into()),
        None => Err(Refusal::own(UMBRA_ERROR_NUMBER_OUT_OF_RANGE, "a component does not fit")),
    })
}

/// The velocity of a point of the world that moves with a body, m/s, rounded once. `UMBRA_ERROR_NUMBER_OUT_OF_RANGE` if a
/// component does not fit.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_body_velocity_at(
    world: Option<&UmbraWorld>,
    body: u64,
    x: UmbraFx,
    y: UmbraFx,
    velocity: Option<&mut MaybeUninit<UmbraVec2>>,
) -> UmbraStatus {
    seen(world, body, velocity, |body| body.velocity_at(vector(x, y)))
}

/// World coordinates of a point of a body, m, given in its axes from its centre of mass. `UMBRA_ERROR_NUMBER_OUT_OF_RANGE` if a
/// component does not fit.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_body_world_point(
    world: Option<&UmbraWorld>,
    body: u64,
    x: UmbraFx,
    y: UmbraFx,
    point: Option<&mut MaybeUninit<UmbraVec2>>,
) -> UmbraStatus {
    seen(world, body, point, |body| body.world_point(vector(x, y)))
}

/// Coordinates of a world point on a body, m, in its axes from its centre of mass. `UMBRA_ERROR_NUMBER_OUT_OF_RANGE` if a
/// component, or one of the way from the centre, does not fit.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_body_local_point(
    world: Option<&UmbraWorld>,
    body: u64,
    x: UmbraFx,
    y: UmbraFx,
    point: Option<&mut MaybeUninit<UmbraVec2>>,
) -> UmbraStatus {
    seen(world, body, point, |body| body.local_point(vector(x, y)))
}

/// The first body by slot that has a key; `UMBRA_ERROR_NO_SUCH_BODY` if none has. It looks through all of them.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_body_with_key(
    world: Option<&UmbraWorld>,
    key: u64,
    body: Option<&mut MaybeUninit<u64>>,
) -> UmbraStatus {
    look(world, body, |world| match world.body_with_key(key) {
        Some(body) => Ok(body_word(body.id())),
        None => Err(Refusal::own(UMBRA_ERROR_NO_SUCH_BODY, "no body has this key")),
    })
}

/// All bodies that have a key, in the order of their slots; a list as `umbra_world_outcomes` gives it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_bodies_with_key(
    world: Option<&UmbraWorld>,
    key: u64,
    bodies: *mut u64,
    capacity: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    guard(|| {
        let all: Vec<u64> = given(world)?.world().bodies_with_key(key).map(|body| body_word(body.id())).collect();
        // SAFETY: as the caller promises.
        unsafe { fill(all.into_iter(), bodies, capacity, count) }
    })
}

/// The number of bodies, and of those that a step moves: not static, not asleep, not out of the simulation. Either pointer may be null.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_body_count(
    world: Option<&UmbraWorld>,
    all: Option<&mut MaybeUninit<usize>>,
    moving: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    guard(|| {
        let world = given(world)?.world();
        if let Some(all) = all {
            all.write(world.body_count());
        }
        if let Some(moving) = moving {
            moving.write(world.moving_count());
        }
        Ok(())
    })
}

/// The handles of all bodies, in the order of their slots; a list as `umbra_world_outcomes` gives it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_bodies(
    world: Option<&UmbraWorld>,
    bodies: *mut u64,
    capacity: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    guard(|| {
        let world = given(world)?.world();
        let rows = Counted { rows: world.bodies().map(|body| body_word(body.id())), left: world.body_count() };
        // SAFETY: as the caller promises.
        unsafe { fill(rows, bodies, capacity, count) }
    })
}

/// Poses of all bodies, in the order of their slots: one call a frame; a list as `umbra_world_outcomes` gives it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_poses(
    world: Option<&UmbraWorld>,
    poses: *mut UmbraPose,
    capacity: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    guard(|| {
        let world = given(world)?.world();
        let rows = world.bodies().map(|body| UmbraPose {
            body: body_word(body.id()),
            position: body.position().into(),
            angle: body.angle().to_bits(),
            key: body.key(),
            user_data: body.user_data(),
            kind: number_of(body.kind()),
            activity: activity_of(body.activity()),
        });
        let rows = Counted { rows, left: world.body_count() };
        // SAFETY: as the caller promises.
        unsafe { fill(rows, poses, capacity, count) }
    })
}

/// Rows whose number is known.
pub(crate) struct Counted<I> {
    pub(crate) rows: I,
    pub(crate) left: usize,
}

impl<I: Iterator> Iterator for Counted<I> {
    type Item = I::Item;

    fn next(&mut self) -> Option<I::Item> {
        self.left = self.left.checked_sub(1)?;
        self.rows.next()
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        (self.left, Some(self.left))
    }
}

impl<I: Iterator> ExactSizeIterator for Counted<I> {}

/// Puts a body somewhere else, m; wakes it. The fraction below 2^-32 is dropped.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_set_position(
    world: Option<&mut UmbraWorld>,
    body: u64,
    x: UmbraFx,
    y: UmbraFx,
) -> UmbraStatus {
    change(world, Command::SetPosition { body: body_id(body), position: vector(x, y) })
}

/// Turns a body to an angle, rad, of any size; wakes it.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_set_angle(world: Option<&mut UmbraWorld>, body: u64, angle: UmbraFx) -> UmbraStatus {
    change(world, Command::SetAngle { body: body_id(body), angle: Fx::from_bits(angle) })
}

/// Gives a body a velocity, m/s; wakes it.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_set_velocity(
    world: Option<&mut UmbraWorld>,
    body: u64,
    x: UmbraFx,
    y: UmbraFx,
) -> UmbraStatus {
    change(world, Command::SetVelocity { body: body_id(body), velocity: vector(x, y) })
}

/// Gives a body an angular velocity, rad/s; wakes it.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_set_angular_velocity(
    world: Option<&mut UmbraWorld>,
    body: u64,
    velocity: UmbraFx,
) -> UmbraStatus {
    change(world, Command::SetAngularVelocity { body: body_id(body), velocity: Fx::from_bits(velocity) })
}

/// Gives a body a mass, as the fields of its definition do. One that is not dynamic keeps it for when it is.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_set_mass(
    world: Option<&mut UmbraWorld>,
    body: u64,
    kind: UmbraMassKind,
    mass: UmbraFx,
    inertia: UmbraFx,
) -> UmbraStatus {
    change_by(world, || Ok(Command::SetMass { body: body_id(body), mass: mass_of(kind, mass, inertia)? }))
}

/// Changes what moves a body. One that becomes static stops; what was applied to it this tick is forgotten.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_set_kind(world: Option<&mut UmbraWorld>, body: u64, kind: UmbraBodyKind) -> UmbraStatus {
    change_by(world, || Ok(Command::SetKind { body: body_id(body), kind: kind_of(kind)? }))
}

/// Changes how much of the world's gravity a body feels, within ±16.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_set_gravity_scale(
    world: Option<&mut UmbraWorld>,
    body: u64,
    scale: UmbraFx,
) -> UmbraStatus {
    change(world, Command::SetGravityScale { body: body_id(body), scale: Fx::from_bits(scale) })
}

/// Gives a body dampings of its own: the share of each velocity that is left after a second, 0 to 1, or what `umbra_kept_at_rate`
/// returns. `UMBRA_AS_WORLD` takes one from it.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_set_body_kept_per_second(
    world: Option<&mut UmbraWorld>,
    body: u64,
    linear: UmbraFx,
    angular: UmbraFx,
) -> UmbraStatus {
    let (linear, angular) = (damping_of(linear), damping_of(angular));
    change(world, Command::SetBodyDamping { body: body_id(body), linear, angular })
}

/// Changes the dominance of a body.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_set_dominance(world: Option<&mut UmbraWorld>, body: u64, dominance: i32) -> UmbraStatus {
    change(world, Command::SetDominance { body: body_id(body), dominance })
}

/// Makes a body a bullet, which never crosses dynamic bodies either (1), or one no more (0).
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_set_bullet(world: Option<&mut UmbraWorld>, body: u64, is_bullet: u32) -> UmbraStatus {
    change(world, Command::SetBullet { body: body_id(body), bullet: is_bullet != 0 })
}

/// Changes the groups a body is in.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_set_force_groups(
    world: Option<&mut UmbraWorld>,
    body: u64,
    force_groups: u32,
) -> UmbraStatus {
    change(world, Command::SetForceGroups { body: body_id(body), force_groups })
}

/// Changes the caller's name for a body.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_set_key(world: Option<&mut UmbraWorld>, body: u64, key: u64) -> UmbraStatus {
    change(world, Command::SetKey { body: body_id(body), key })
}

/// Changes the caller's data of a body.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_set_user_data(world: Option<&mut UmbraWorld>, body: u64, user_data: u64) -> UmbraStatus {
    change(world, Command::SetUserData { body: body_id(body), user_data })
}

/// Locks components of a body's velocity, which are zero from now on, and frees the others.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_set_locks(world: Option<&mut UmbraWorld>, body: u64, locks: UmbraLocks) -> UmbraStatus {
    change_by(world, || Ok(Command::SetLocks { body: body_id(body), locks: locks_of(locks)? }))
}

/// Gives a dynamic body largest speeds after a step, from 0, or takes them from it with `UMBRA_NO_LIMIT`.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_set_max_speeds(
    world: Option<&mut UmbraWorld>,
    body: u64,
    linear: UmbraFx,
    angular: UmbraFx,
) -> UmbraStatus {
    let (linear, angular) = (limit_of(linear), limit_of(angular));
    change(world, Command::SetMaxSpeeds { body: body_id(body), linear, angular })
}

/// Takes a body out of the simulation as it is, until it is enabled.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_disable(world: Option<&mut UmbraWorld>, body: u64) -> UmbraStatus {
    change(world, Command::Disable(body_id(body)))
}

/// Takes a disabled body back into the simulation, as it was.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_enable(world: Option<&mut UmbraWorld>, body: u64) -> UmbraStatus {
    change(world, Command::Enable(body_id(body)))
}

/// Moves a kinematic body to a place and an angle over the next step.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_move_to(
    world: Option<&mut UmbraWorld>,
    body: u64,
    x: UmbraFx,
    y: UmbraFx,
    angle: UmbraFx,
) -> UmbraStatus {
    let (position, angle) = (vector(x, y), Fx::from_bits(angle));
    change(world, Command::MoveTo { body: body_id(body), position, angle })
}

/// Wakes a body and what springs join it to.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_wake(world: Option<&mut UmbraWorld>, body: u64) -> UmbraStatus {
    change(world, Command::Wake(body_id(body)))
}

/// Puts a body to sleep, with the bodies that springs, joints and the contacts of the last step join it to. They stop.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_sleep(world: Option<&mut UmbraWorld>, body: u64) -> UmbraStatus {
    change(world, Command::Sleep(body_id(body)))
}

/// Lets a quarantined body take part again.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_release(world: Option<&mut UmbraWorld>, body: u64) -> UmbraStatus {
    change(world, Command::Release(body_id(body)))
}

const _: () = assert!(word(u32::MAX, u32::MAX) == UMBRA_NO_HANDLE);
