//! Characters: a shape that walks, climbs, slides and rides through the colliders of a world.
//!
//! A game keeps the position and the ground of the last movement, and gives them to the next one. It carries out the pushes, as impulses:
//!
//! ```c
//! UmbraMovement *movement = NULL;
//! way.before_step = 1;
//! umbra_character_move(world, &hero, &way, NULL, &movement); // way.position, way.translation, way.ground
//! umbra_movement_state(movement, &state);
//! way.position = state.position, way.ground = state.ground;
//! umbra_movement_free(movement);
//! ```

use std::mem::MaybeUninit;

use umbra_physics::{Character, CharacterHit, Command, ForceOrImpulse, Fx, Ground, Movement};

use crate::UMBRA_NO_HANDLE;
use crate::collider::{collider_word, flag};
use crate::memory::{fill, given};
use crate::number::{UmbraFx, UmbraVec2};
use crate::query::{UmbraQueryFilter, query_by};
use crate::shape::UmbraShape;
use crate::status::{UmbraStatus, guard};
use crate::world::{UmbraWorld, body_id, body_word};

/// A character; `umbra_character_def_default` fills it in, but for the shape. Values out of range are refused with the causes 190 to 194.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct UmbraCharacterDef {
    /// The shape, upright: it is never turned. Not a chain. Default null.
    pub shape: *const UmbraShape,
    /// The direction that is up: of any length from 2^-10 on, within ±2^10 a component. Default +y.
    pub up: UmbraVec2,
    /// The distance from colliders that it keeps, m, 2^-12 to 1. Default 2^-6.
    pub skin: UmbraFx,
    /// The angle of the steepest slope that it climbs and stands on, rad, 0 to π/2. Default π/4.
    pub max_slope: UmbraFx,
    /// The angle of the steepest slope on which a downward translation moves it nowhere, rad, 0 to π/2. Default π/4.
    pub max_rest_slope: UmbraFx,
    /// The height of the highest step that it climbs, m, 0 to 2^4. Default 1/4.
    pub step_height: UmbraFx,
    /// The depth of the top of a step that it needs to climb it, m, 0 to 2^4. Default 1/16.
    pub step_width: UmbraFx,
    /// The distance by which it is moved down to stay on the ground, m, 0 to 2^4. Default 1/4.
    pub snap: UmbraFx,
    /// The mass with which it pushes dynamic bodies, kg, 0 to 2^24. Default 0, which pushes nothing.
    pub push_mass: UmbraFx,
}

/// The ground that a character stands on. With it a character rides on bodies that move and turn.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UmbraGround {
    /// The body, or `UMBRA_NO_HANDLE` in the air; then nothing else is read, and all else is 0.
    pub body: u64,
    /// The centre of the character in the axes of the body, m.
    pub local: UmbraVec2,
    /// The point of the world where that was, m.
    pub point: UmbraVec2,
}

/// A request for a movement.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UmbraCharacterMove {
    /// The position of the shape's centre of mass, m.
    pub position: UmbraVec2,
    /// The translation, m; each component within ±2^8.
    pub translation: UmbraVec2,
    /// The ground in the state of the last movement.
    pub ground: UmbraGround,
    /// 1 for a movement before a step: kinematic bodies are seen where the step takes them, so that the character stands beside them after
    /// it. 0 to see them where they are. Refused otherwise.
    pub before_step: u32,
    /// 0.
    pub reserved: u32,
}

/// The result of a movement.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UmbraMovementState {
    /// The new position of the centre of mass of the shape, m.
    pub position: UmbraVec2,
    /// The ground that it stands on now.
    pub ground: UmbraGround,
    /// The collider of the ground, or `UMBRA_NO_HANDLE` in the air.
    pub ground_collider: u64,
    /// The unit normal of the ground, towards the character; zero in the air.
    pub ground_normal: UmbraVec2,
    /// The velocity of the surface of the ground at the centre of the character, m/s, with the speed of a belt; zero in the air.
    pub ground_velocity: UmbraVec2,
    /// The translation that was asked for, m.
    pub desired: UmbraVec2,
    /// The part of it that was not gone, if it met a dynamic body, m; else zero. A movement by it after the step, with `before_step` 0, takes
    /// the character up to what it pushed: to draw it and to begin the next tick with.
    pub held_back: UmbraVec2,
    /// 1 if it overlaps a collider that it could not get out of, else 0.
    pub is_overlapping: u32,
    /// 0.
    pub reserved: u32,
}

/// A collider that a character moved against.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UmbraCharacterHit {
    /// The collider.
    pub collider: u64,
    /// The body of the collider.
    pub body: u64,
    /// The point where they meet, m.
    pub point: UmbraVec2,
    /// The unit normal of the collider there.
    pub normal: UmbraVec2,
    /// Number of the part of a compound or of the segment of a chain; 0 of all others.
    pub part: u32,
    /// 0.
    pub reserved: u32,
}

/// An impulse with which a character pushes a body that it met: for `umbra_world_apply_impulse`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UmbraCharacterPush {
    /// The body.
    pub body: u64,
    /// The impulse, N·s.
    pub impulse: UmbraVec2,
    /// The point of the world where it acts, m.
    pub point: UmbraVec2,
}

/// A movement that was made: its result, what it met and what it pushes.
pub struct UmbraMovement {
    movement: Movement,
    pushes: Vec<UmbraCharacterPush>,
}

const NO_GROUND: UmbraGround =
    UmbraGround { body: UMBRA_NO_HANDLE, local: UmbraVec2 { x: 0, y: 0 }, point: UmbraVec2 { x: 0, y: 0 } };

impl From<Ground> for UmbraGround {
    fn from(ground: Ground) -> Self {
        Self { body: body_word(ground.body), local: ground.local.into(), point: ground.point.into() }
    }
}

impl From<&CharacterHit> for UmbraCharacterHit {
    fn from(hit: &CharacterHit) -> Self {
        Self {
            collider: collider_word(hit.collider),
            body: body_word(hit.body),
            point: hit.point.into(),
            normal: hit.normal.into(),
            part: hit.part,
            reserved: 0,
        }
    }
}

impl UmbraCharacterPush {
    /// A push as a command has it: all of them are impulses at a point of the world.
    fn of(command: &Command) -> Option<Self> {
        let Command::Apply { body, action, .. } = command else { return None };
        let ForceOrImpulse::Impulse { impulse, point: Some(point) } = action else { return None };
        Some(Self { body: body_word(*body), impulse: (*impulse).into(), point: (*point).into() })
    }
}

/// Fills in a character without a shape.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_character_def_default(def: Option<&mut MaybeUninit<UmbraCharacterDef>>) -> UmbraStatus {
    guard(|| {
        let place = given(def)?;
        let standard = Character::<Fx>::new(umbra_physics::Shape::circle(Fx::ONE)?);
        place.write(UmbraCharacterDef {
            shape: std::ptr::null(),
            up: standard.up.into(),
            skin: standard.skin.to_bits(),
            max_slope: standard.max_slope.to_bits(),
            max_rest_slope: standard.max_rest_slope.to_bits(),
            step_height: standard.step_height.to_bits(),
            step_width: standard.step_width.to_bits(),
            snap: standard.snap.to_bits(),
            push_mass: standard.push_mass.to_bits(),
        });
        Ok(())
    })
}

/// Moves a character: it rides with its ground, is pushed out of what came into its skin, goes the translation, slides along what it meets,
/// climbs a step, and is moved down to the ground. Nothing of the world changes. Leave out its own body by the filter.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_character_move(
    world: Option<&UmbraWorld>,
    character: Option<&UmbraCharacterDef>,
    way: Option<&UmbraCharacterMove>,
    filter: Option<&UmbraQueryFilter>,
    movement: Option<&mut MaybeUninit<Option<Box<UmbraMovement>>>>,
) -> UmbraStatus {
    guard(|| {
        let (def, way, place) = (given(character)?, given(way)?, given(movement)?);
        // SAFETY: the caller promises that the shape is alive, or null.
        let shape = given(unsafe { def.shape.as_ref() })?;
        let character = Character {
            shape: shape.shape.clone(),
            up: def.up.into(),
            skin: Fx::from_bits(def.skin),
            max_slope: Fx::from_bits(def.max_slope),
            max_rest_slope: Fx::from_bits(def.max_rest_slope),
            step_height: Fx::from_bits(def.step_height),
            step_width: Fx::from_bits(def.step_width),
            snap: Fx::from_bits(def.snap),
            push_mass: Fx::from_bits(def.push_mass),
        };
        let UmbraGround { body, local, point } = way.ground;
        let ground =
            (body != UMBRA_NO_HANDLE).then(|| Ground { body: body_id(body), local: local.into(), point: point.into() });
        let (position, translation) = (way.position.into(), way.translation.into());
        let source = given(world)?.world();
        let is_before_step = flag(way.before_step, "before_step is 0 or 1")?;
        let queries = if is_before_step { source.queries_after_step() } else { source.queries() };
        // SAFETY: as the caller promises.
        let movement = unsafe {
            query_by(&queries, filter, |queries, filter| {
                let movement = character.translate(queries, position, ground, translation, filter)?;
                let pushes = character.push(source, &movement);
                Ok(UmbraMovement { movement, pushes: pushes.iter().filter_map(UmbraCharacterPush::of).collect() })
            })
        }?;
        place.write(Some(Box::new(movement)));
        Ok(())
    })
}

/// The result of a movement.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_movement_state(
    movement: Option<&UmbraMovement>,
    state: Option<&mut MaybeUninit<UmbraMovementState>>,
) -> UmbraStatus {
    guard(|| {
        let (movement, place) = (&given(movement)?.movement, given(state)?);
        place.write(UmbraMovementState {
            position: movement.position.into(),
            ground: movement.ground.map_or(NO_GROUND, UmbraGround::from),
            ground_collider: movement.ground_collider.map_or(UMBRA_NO_HANDLE, collider_word),
            ground_normal: movement.ground_normal.into(),
            ground_velocity: movement.ground_velocity.into(),
            desired: movement.desired.into(),
            held_back: movement.held_back.into(),
            is_overlapping: movement.is_overlapping.into(),
            reserved: 0,
        });
        Ok(())
    })
}

/// The colliders that a character moved against, in the order in which it met them; a list as `umbra_world_outcomes` gives it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_movement_hits(
    movement: Option<&UmbraMovement>,
    hits: *mut UmbraCharacterHit,
    capacity: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    guard(|| {
        let all = given(movement)?.movement.hits.iter().map(UmbraCharacterHit::from);
        // SAFETY: as the caller promises.
        unsafe { fill(all, hits, capacity, count) }
    })
}

/// The impulses on the bodies that a character met, at most one a body; none without a `push_mass`. A list as `umbra_world_outcomes` gives
/// it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_movement_pushes(
    movement: Option<&UmbraMovement>,
    pushes: *mut UmbraCharacterPush,
    capacity: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    guard(|| {
        let all = given(movement)?.pushes.iter().copied();
        // SAFETY: as the caller promises.
        unsafe { fill(all, pushes, capacity, count) }
    })
}

/// Frees a movement. Null is ignored.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_movement_free(movement: Option<Box<UmbraMovement>>) {
    drop(movement);
}
