//! A movement from its start to its end.

use alloc::vec::Vec;

use super::obstacle::{Obstacles, along, in_ulps, times};
use super::result::{CharacterHit, Ground, Movement};
use super::settings::Character;
use super::slide::{MAX_PUSH, Touch, Walker};
use crate::body::{Activity, BodyKind};
use crate::error::{Error, Quantity};
use crate::fx::Fx;
use crate::math::Vec2;
use crate::query::{Core, FULL, Point, RayEnd, beside, checked_point, from_to, in_scalar};
use crate::scalar::{Scalar, Wide as _};
use crate::slots::BodyId;
use crate::world::{Moment, Neighbour, Queries, QueryFilter, Stance, World};

/// The largest component of a translation, and of the way that a ground carries a character.
const MAX_TRANSLATION: Fx = Fx::from_bits(1 << 40);

impl<S: Scalar> Character<S> {
    /// Moves the character from a position by a translation, both in m, and returns where it gets and what it meets.
    ///
    /// Call it once a tick, before the step in the world of [`World::queries_after_step`], or after it in the world of [`World::queries`]. In this
    /// order the character
    /// 1. rides with `ground`, which the last call returned: with its body, and by the way of a step with a surface that moves;
    /// 2. is pushed out of colliders that came into its skin, by up to 1 m;
    /// 3. moves by the translation and slides along colliders; it climbs a step, if it stood on ground and the translation does not lead up;
    /// 4. is moved down to the ground, if it stood on one and the translation does not lead up.
    ///
    /// It never ends in a collider that it did not overlap at the start, unless that one moved into it and presses it against others
    /// ([`Movement::is_overlapping`]).
    ///
    /// Leave out the body of the character itself by the filter. A [one-way](crate::OneWay) collider that the character comes through lets
    /// it pass until it has left the skin around it. To drop through a platform that the character stands on, leave the platform out for
    /// one call with a translation downwards.
    ///
    /// *Cost* in proportion to the colliders within reach of the translation, steps and snapping; on a belt they are looked up twice.
    ///
    /// # Errors
    /// The errors of [`check`](Self::check); [`Error::OutOfRange`] with [`Quantity::CharacterTranslation`] for a component beyond ±2^8 m,
    /// or with [`Quantity::Position`] for the position.
    pub fn translate(
        &self,
        queries: &Queries<'_, S>,
        position: Vec2<S>,
        ground: Option<Ground<S>>,
        translation: Vec2<S>,
        filter: &QueryFilter<'_, S>,
    ) -> Result<Movement<S>, Error> {
        let terms = self.terms()?;
        if !translation.is_within(S::from_fx(MAX_TRANSLATION)) {
            return Err(Error::OutOfRange { quantity: Quantity::CharacterTranslation });
        }
        let way = in_ulps(translation);
        let ride = ground.and_then(|ground| Ride::new(queries, &ground));
        let size = |[x, y]: Point| x.abs() + y.abs();
        // Below 2^45.
        let reach = size(way) + ride.map_or(0, |ride| size(ride.way) + size(ride.ahead));
        let reach = reach + 2 * terms.step_height + terms.step_width + terms.snap + MAX_PUSH + 4 * terms.skin;
        let stood_on = ground.map(|ground| ground.body);
        let (start, mut neighbours) = queries.around(&self.shape, position, reach, filter)?;
        let mut at = [0; 2];
        if let Some(ride) = ride {
            let mut rider = Walker::new(Obstacles { neighbours: &neighbours, terms: &terms, stood_on }, at);
            rider.carry(ride.way, Some(ride.body));
            let belt = belt_way(queries.world(), &rider, ride.body);
            at = rider.at;
            if belt != [0; 2] {
                (_, neighbours) = queries.around(&self.shape, position, reach + size(belt), filter)?;
                let mut rider = Walker::new(Obstacles { neighbours: &neighbours, terms: &terms, stood_on }, at);
                rider.carry(belt, None);
                at = rider.at;
            }
        }
        let mut walker = Walker::new(Obstacles { neighbours: &neighbours, terms: &terms, stood_on }, at);
        walker.push_out();
        let stands = ground.is_some() || walker.ground_of(&walker.contacts()).is_some();
        let is_up = along(way, terms.up) > 0;
        let step = walker.walk(way, stands);
        let support = if stands && !is_up && step.is_none() { walker.snap() } else { step };
        let contacts = walker.contacts();
        let is_overlapping = contacts.planes.iter().any(|plane| plane.overlaps);
        let support = walker.ground_of(&contacts).or(support).filter(|_| !is_up);
        let support = support.map(|plane| (&neighbours[plane.index], plane.unit));
        let ahead = ride.filter(|ride| support.is_some_and(|(neighbour, _)| neighbour.body == ride.body));
        if let Some(ride) = ahead {
            walker.carry(ride.ahead, Some(ride.body));
        }
        // The end is in range, as all positions of bodies are.
        let end = in_scalar::<S>(beside(start, walker.at));
        checked_point(end)?;
        let ground = support.and_then(|(neighbour, normal)| {
            let stance = ahead.map_or_else(|| queries.stance(neighbour.body), |ride| Some(ride.stance));
            Some((ground_at(neighbour.body, stance?, end)?, neighbour, normal))
        });
        let is_met = |touch: &Touch| neighbours[touch.index].is_dynamic;
        let held_back = if walker.touches.iter().any(is_met) { in_scalar(walker.held_back) } else { Vec2::ZERO };
        let ground_velocity =
            ground.and_then(|(_, neighbour, normal)| surface_velocity(queries.world(), neighbour, normal, end));
        Ok(Movement {
            position: end,
            ground: ground.map(|(ground, ..)| ground),
            ground_collider: ground.map(|(_, neighbour, _)| neighbour.collider),
            ground_normal: ground.map_or(Vec2::ZERO, |(.., normal)| in_scalar(normal)),
            ground_velocity: ground_velocity.unwrap_or(Vec2::ZERO),
            hits: walker.touches.iter().map(|touch| hit(start, &walker.obstacles, touch)).collect::<Vec<_>>(),
            is_overlapping,
            desired: translation,
            held_back,
        })
    }
}

/// The ways of a character with the body that it stood on.
#[derive(Clone, Copy, Debug)]
struct Ride<S: Scalar> {
    body: BodyId,
    /// The way that the body has moved the character since the last call.
    way: Point,
    /// The way of a dynamic body in the next step, if the queries see bodies as they are after it: by its velocities.
    ahead: Point,
    /// The stance of the body at the end of both ways.
    stance: Stance<S>,
}

impl<S: Scalar> Ride<S> {
    /// `None` if the body is gone or takes no part, or if the way is too long for a ride.
    fn new(queries: &Queries<'_, S>, ground: &Ground<S>) -> Option<Self> {
        let body = queries.world().body(ground.body).ok()?;
        let takes_part = matches!(body.activity(), Activity::Awake | Activity::Asleep);
        let current = queries.stance(ground.body).filter(|_| takes_part)?;
        let is_ahead = queries.moment() == Moment::AfterStep && body.kind() == BodyKind::Dynamic;
        let stance = if is_ahead { body.stance_after_step() } else { current };
        let places = [ground.point, current.world_point(ground.local)?, stance.world_point(ground.local)?].map(in_ulps);
        // All are points of the world, so that the differences fit.
        let [way, ahead] = [from_to(places[0], places[1]), from_to(places[1], places[2])];
        let is_short = |way: Point| way.iter().all(|part| part.abs() <= MAX_TRANSLATION.to_bits());
        let ahead = if is_short(ahead) { ahead } else { [0; 2] };
        let stance = if is_short(ahead) { stance } else { current };
        is_short(way).then_some(Self { body: ground.body, way, ahead, stance })
    }
}

fn ground_at<S: Scalar>(body: BodyId, stance: Stance<S>, position: Vec2<S>) -> Option<Ground<S>> {
    let local = stance.local_point(position)?;
    Some(Ground { body, local, point: stance.world_point(local)? })
}

/// The speed of the surface of a collider along the tangent (−n.y, n.x), counter-clockwise around its shape.
fn surface_speed<S: Scalar>(world: &World<S>, neighbour: &Neighbour) -> S {
    world.collider(neighbour.collider).map_or(S::ZERO, |def| def.material.surface_speed)
}

/// The way of the surface of a body under the character in a step, ulps; zero if it does not stand on that body, or if the way is too long.
fn belt_way<S: Scalar>(world: &World<S>, walker: &Walker<'_>, body: BodyId) -> Point {
    let ground = walker.ground_of(&walker.contacts());
    let Some(plane) = ground.filter(|plane| walker.obstacles.neighbours[plane.index].body == body) else {
        return [0; 2];
    };
    let speed = surface_speed(world, &walker.obstacles.neighbours[plane.index]).to_fx().to_bits();
    let (num, den) = world.def().time_step.seconds();
    // Rounded to nearest, halves away from zero; below 2^42 · 2^32, then at most 2^42.
    let size = (2 * speed.unsigned_abs() as u128 * u128::from(num) + u128::from(den)) / (2 * u128::from(den));
    let size = size as i64;
    if size > MAX_TRANSLATION.to_bits() {
        [0; 2]
    } else {
        times(tangent(plane.unit), if speed < 0 { -size } else { size })
    }
}

/// The velocity of the surface of a body at a point, with the speed of its surface.
fn surface_velocity<S: Scalar>(
    world: &World<S>,
    neighbour: &Neighbour,
    normal: Point,
    point: Vec2<S>,
) -> Option<Vec2<S>> {
    let velocity = world.body(neighbour.body).ok()?.velocity_at(point)?;
    let tangent = in_scalar::<S>(tangent(normal));
    let speed = surface_speed(world, neighbour);
    let sum = |v: S, tangent: S| tangent.product(speed).plus(S::Wide::from_scalar(v))?.to_scalar();
    Some(Vec2::new(sum(velocity.x, tangent.x)?, sum(velocity.y, tangent.y)?))
}

fn hit<S: Scalar>(start: Point, obstacles: &Obstacles<'_>, touch: &Touch) -> CharacterHit<S> {
    let neighbour = &obstacles.neighbours[touch.index];
    let end = RayEnd { fraction: FULL, feature: touch.feature };
    let normal = Vec2::new(Fx::from_bits(touch.unit[0]), Fx::from_bits(touch.unit[1]));
    let point = neighbour.sum.touch_point([&neighbour.cores[0], &neighbour.cores[1]], touch.at, end, normal);
    let stretch = stretch(neighbour, touch, obstacles.terms.skin).map(|end| end - along(point, tangent(touch.unit)));
    CharacterHit {
        collider: neighbour.collider,
        body: neighbour.body,
        part: neighbour.part,
        point: in_scalar(beside(start, point)),
        normal: in_scalar(touch.unit),
        stretch: stretch.map(|end| S::from_fx(Fx::from_bits(end))),
    }
}

const fn tangent([x, y]: Point) -> Point {
    [-y, x]
}

/// The ends, along the tangent, of the stretch in which a character and a collider face each other with a gap that differs by less than a
/// skin. A crate that tilts by a hair is pushed at its side and not at a corner.
fn stretch(neighbour: &Neighbour, touch: &Touch, skin: i64) -> [i64; 2] {
    let face = |core: &Core, out: Point| {
        let tangent = tangent(touch.unit);
        let height = |corner: &&Point| along(**corner, out);
        let top = core.corners().iter().map(|corner| along(*corner, out)).max().unwrap_or_default();
        let ends =
            core.corners().iter().filter(|corner| height(corner) >= top - skin).map(|corner| along(*corner, tangent));
        ends.fold([i64::MAX, i64::MIN], |[low, high], end| [low.min(end), high.max(end)])
    };
    let moved = along(touch.at, tangent(touch.unit));
    let shape = face(&neighbour.cores[0], touch.unit.map(|part| -part)).map(|end| end + moved);
    let collider = face(&neighbour.cores[1], touch.unit);
    let [low, high] = [shape[0].max(collider[0]), shape[1].min(collider[1])];
    // Round ends touch at one point, which rounding may put beside the face of the other.
    [low.min(high), high.max(low)]
}

/// The body that holds a hit, for pushing.
pub(super) fn is_pushed<S: Scalar>(world: &World<S>, body: BodyId) -> bool {
    world.body(body).is_ok_and(|body| {
        body.kind() == BodyKind::Dynamic && matches!(body.activity(), Activity::Awake | Activity::Asleep)
    })
}
