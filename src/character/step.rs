//! A movement from its start to its end.

use alloc::vec::Vec;

use super::obstacle::{Obstacles, along};
use super::result::{CharacterHit, Ground, Movement};
use super::settings::Character;
use super::slide::{MAX_PUSH, Touch, Walker};
use crate::body::Activity;
use crate::error::{Error, Quantity};
use crate::fx::Fx;
use crate::math::Vec2;
use crate::query::{FULL, Point, RayEnd, beside, checked_point, from_to, in_scalar};
use crate::scalar::Scalar;
use crate::slots::BodyId;
use crate::world::{Neighbour, Queries, QueryFilter, World};

/// The largest component of a translation, and of the way that a ground carries a character.
const MAX_TRANSLATION: Fx = Fx::from_bits(1 << 40);

impl<S: Scalar> Character<S> {
    /// Moves the character from a position by a translation, both in m, and returns where it gets and what it meets.
    ///
    /// Call it once a tick. In this order the character
    /// 1. rides with `ground`, which the last call returned;
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
    /// *Cost* in proportion to the colliders within reach of the translation, steps and snapping.
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
        let ride = ground.and_then(|ground| Some((ground.body, carried(queries.world(), &ground)?)));
        let lengths = [way, ride.map_or([0; 2], |(_, ride)| ride)].map(|[x, y]| x.abs() + y.abs());
        // Below 2^44.
        let reach = lengths[0] + lengths[1] + 2 * terms.step_height + terms.step_width + terms.snap;
        let reach = reach + MAX_PUSH + 4 * terms.skin;
        let (start, neighbours) = queries.around(&self.shape, position, reach, filter)?;
        let stood_on = ground.map(|ground| ground.body);
        let mut walker = Walker::new(Obstacles { neighbours: &neighbours, terms: &terms, stood_on });
        if let Some((body, ride)) = ride {
            walker.carry(ride, body);
        }
        walker.push_out();
        let stands = ground.is_some() || walker.ground_of(&walker.contacts()).is_some();
        let is_up = along(way, terms.up) > 0;
        let step = walker.walk(way, stands);
        let support = if stands && !is_up && step.is_none() { walker.snap() } else { step };
        let contacts = walker.contacts();
        let is_overlapping = contacts.planes.iter().any(|plane| plane.overlaps);
        let support = walker.ground_of(&contacts).or(support);
        // The end is in range, as all positions of bodies are.
        let end = in_scalar::<S>(beside(start, walker.at));
        checked_point(end)?;
        let support = support.filter(|_| !is_up).map(|plane| (&neighbours[plane.index], plane.unit));
        let ground = support.and_then(|(neighbour, normal)| {
            Some((ground_at(queries.world(), neighbour.body, end)?, neighbour, normal))
        });
        Ok(Movement {
            position: end,
            ground: ground.map(|(ground, ..)| ground),
            ground_collider: ground.map(|(_, neighbour, _)| neighbour.collider),
            ground_normal: ground.map_or(Vec2::ZERO, |(.., normal)| in_scalar(normal)),
            ground_velocity: ground
                .and_then(|(ground, ..)| velocity(queries.world(), ground.body, end))
                .unwrap_or(Vec2::ZERO),
            hits: walker.touches.iter().map(|touch| hit(start, &neighbours[touch.index], touch)).collect::<Vec<_>>(),
            is_overlapping,
            desired: translation,
        })
    }
}

fn in_ulps<S: Scalar>(v: Vec2<S>) -> Point {
    [v.x.to_fx().to_bits(), v.y.to_fx().to_bits()]
}

/// The way that a ground has moved the character since: `None` if its body is gone or takes no part, or if the way is too long for a ride.
fn carried<S: Scalar>(world: &World<S>, ground: &Ground<S>) -> Option<Point> {
    let body = world.body(ground.body).ok()?;
    let takes_part = matches!(body.activity(), Activity::Awake | Activity::Asleep);
    let now = body.world_point(ground.local).filter(|_| takes_part)?;
    // Both are points of the world, so that the difference fits.
    let moved = from_to(in_ulps(ground.point), in_ulps(now));
    moved.iter().all(|part| part.abs() <= MAX_TRANSLATION.to_bits()).then_some(moved)
}

fn ground_at<S: Scalar>(world: &World<S>, body: BodyId, position: Vec2<S>) -> Option<Ground<S>> {
    let ground = world.body(body).ok()?;
    let local = ground.local_point(position)?;
    Some(Ground { body, local, point: ground.world_point(local)? })
}

fn velocity<S: Scalar>(world: &World<S>, body: BodyId, position: Vec2<S>) -> Option<Vec2<S>> {
    world.body(body).ok()?.velocity_at(position)
}

fn hit<S: Scalar>(start: Point, neighbour: &Neighbour, touch: &Touch) -> CharacterHit<S> {
    let end = RayEnd { fraction: FULL, feature: touch.feature };
    let normal = Vec2::new(Fx::from_bits(touch.unit[0]), Fx::from_bits(touch.unit[1]));
    let point = neighbour.sum.touch_point([&neighbour.cores[0], &neighbour.cores[1]], touch.at, end, normal);
    CharacterHit {
        collider: neighbour.collider,
        body: neighbour.body,
        part: neighbour.part,
        point: in_scalar(beside(start, point)),
        normal: in_scalar(touch.unit),
    }
}

/// The body that holds a hit, for pushing.
pub(super) fn is_pushed<S: Scalar>(world: &World<S>, body: BodyId) -> bool {
    world.body(body).is_ok_and(|body| {
        body.kind() == crate::body::BodyKind::Dynamic && matches!(body.activity(), Activity::Awake | Activity::Asleep)
    })
}
