//! Results of a movement.

use alloc::vec::Vec;

use crate::fx::Fx;
use crate::math::Vec2;
use crate::slots::{BodyId, ColliderId};

/// The ground that a character stands on.
///
/// A game gives it back at the next call, so that the character rides: where the body has moved and turned since, the character moves along
/// with the point of the body at its centre. The body is meant as the [queries](crate::Queries) of the call saw it: as it was, or as the next
/// step takes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Ground<S = Fx> {
    /// The body.
    pub body: BodyId,
    /// The centre of the character in the axes of the body, m.
    pub local: Vec2<S>,
    /// The point of the world where [`local`](Self::local) was, m.
    pub point: Vec2<S>,
}

/// A collider that a character moved against.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct CharacterHit<S = Fx> {
    /// The collider.
    pub collider: ColliderId,
    /// The body of the collider.
    pub body: BodyId,
    /// The number of the part of a compound or of the segment of a chain; 0 for all other shapes.
    pub part: u32,
    /// The point where they meet, m, within the skin of the surface of the collider; where two edges touch, the middle of the stretch in
    /// which they touch.
    pub point: Vec2<S>,
    /// The unit normal of the collider there. *Error* 1 ulp in each component.
    pub normal: Vec2<S>,
    /// How far the stretch in which they touch, but for a skin, goes to either side of the point along (−n.y, n.x), m.
    pub(super) stretch: [S; 2],
}

/// The result of a movement: [`Character::translate`](crate::Character::translate).
///
/// ```
/// use umbra_physics::{BodyDef, Character, CharacterHit, Ground, Movement, QueryFilter, Shape, World, WorldDef, fx, vec2};
///
/// let mut world = World::new(WorldDef::default())?;
/// let floor = BodyDef::fixed().with_collider(Shape::rectangle(20, 2)?);
/// world.add_body(floor)?;
/// // A platform that moves to the right with 3 m/s, whose surface is at y = 2.
/// let lift = BodyDef { position: vec2(0, fx!(1.5)), velocity: vec2(3, 0), ..BodyDef::kinematic() };
/// let lift = world.add_body(lift.with_collider(Shape::rectangle(4, 1)?))?;
/// let (hero, all) = (Character::new(Shape::rectangle(1, 1)?), QueryFilter::default());
///
/// let landed: Movement = hero.translate(&world.queries(), vec2(0, 3), None, vec2(0, -1), &all)?;
/// let ground: Ground = landed.ground.unwrap();
/// assert_eq!((ground.body, landed.ground_velocity, landed.ground_normal), (lift, vec2(3, 0), vec2(0, 1)));
/// assert_eq!(landed.ground_collider, world.colliders_of(lift)?.next());
/// assert!(!landed.is_overlapping);
/// let hit: &CharacterHit = &landed.hits[0];
/// assert_eq!((hit.body, hit.part, hit.point, hit.normal), (lift, 0, vec2(0, 2), vec2(0, 1)));
/// assert_eq!((landed.desired, landed.held_back), (vec2(0, -1), vec2(0, 0)));
/// // It rides along for a second, at the same height.
/// (0..60).for_each(|_| _ = world.step());
/// let ridden = hero.translate(&world.queries(), landed.position, landed.ground, vec2(0, 0), &all)?;
/// assert_eq!(ridden.position, landed.position + vec2(3, 0));
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Movement<S = Fx> {
    /// The new position of the centre of mass of the shape, m.
    pub position: Vec2<S>,
    /// The ground that it stands on now; `None` in the air, on slopes that are too steep, and after a translation that leads up.
    pub ground: Option<Ground<S>>,
    /// The collider of the ground, `None` without one; where several are equally level, the first by key, then by handle.
    pub ground_collider: Option<ColliderId>,
    /// The unit normal of the ground, towards the character; zero without ground. *Error* 1 ulp in each component.
    pub ground_normal: Vec2<S>,
    /// The velocity of the surface of the ground at the centre of the character, m/s: add it when the character jumps off. It is the
    /// velocity of the body there and the [speed of the surface](crate::Material::surface_speed). Zero without ground.
    pub ground_velocity: Vec2<S>,
    /// The colliders that it moved against, in the order in which it met them; at the same time, by key, then by handle.
    pub hits: Vec<CharacterHit<S>>,
    /// True if it overlaps a collider that it could not get out of: it is being crushed, or was put there, or a body was put into it.
    pub is_overlapping: bool,
    /// The translation that was asked for, m.
    pub desired: Vec2<S>,
    /// The part of the translation that it did not go, if it met a dynamic body, m; else zero.
    ///
    /// A crate moves in the step, when the character stands already: without more it is drawn the way of a tick behind a crate that it
    /// pushes. A [`translate`](crate::Character::translate) by this in the [world after the step](crate::World::queries) takes it there,
    /// to draw it and to begin the next tick with.
    pub held_back: Vec2<S>,
}
