//! Rays, and shapes that are cast.

use alloc::vec::Vec;

use super::{Found, Queries, QueryFilter, Rank, Target, sort_by_rank};
use crate::body::BodyKind;
use crate::collide::broad::Path;
use crate::collider::OutlineId;
use crate::error::{Error, Quantity};
use crate::fx::Fx;
use crate::math::Vec2;
use crate::query::{
    Core, Line, Placement, Point, RayEnd, Seam, SeamPlace, Sum, at, beside, beyond_seam, cast_hit, checked_point,
    checked_translation, in_parts, in_scalar, normal, normal_at_seam, ray_hit,
};
use crate::scalar::{Angle as _, Scalar};
use crate::shape::union::REACH;
use crate::shape::{Geometry, Shape};
use crate::slots::{BodyId, ColliderId};

/// A collider that a ray or a shape met on its way.
///
/// ```
/// use umbra_physics::{BodyDef, CastHit, QueryFilter, Shape, World, WorldDef, fx, vec2};
///
/// let mut world = World::new(WorldDef::default())?;
/// let ground = world.add_body(BodyDef::fixed().with_collider(Shape::rectangle(20, 2)?))?;
/// // A crate that falls from 5 m: it comes to lie with its centre 1.5 m up.
/// let crate_ = Shape::rectangle(1, 1)?;
/// let hit: Option<CastHit> =
///     world.queries().cast_shape(&crate_, (vec2(3, 5), fx!(0)), vec2(0, -7), &QueryFilter::default())?;
/// let hit = hit.unwrap();
/// assert_eq!((hit.body, hit.fraction, hit.normal, hit.part), (ground, fx!(0.5), vec2(0, 1), 0));
/// assert_eq!(hit.point, vec2(3, 1)); // in the middle of the side on which it lies
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct CastHit<S = Fx> {
    /// The collider.
    pub collider: ColliderId,
    /// The body of the collider.
    pub body: BodyId,
    /// The fraction of the translation at which they meet, from 0 to 1, rounded down to units of 2^-32. The distance to the hit is this
    /// fraction of the length of the translation.
    pub fraction: S,
    /// The point where they meet, on the surface of the collider, m; where two edges touch, the middle of the stretch in which they touch.
    /// If they overlap at the start, the point where the ray or the centre of mass of the shape starts. *Error* for a ray ½ ulp and 2^-9,
    /// for a shape 3 ulps and 2^-31 of its radius; 2^-14 ulp more with a radius.
    pub point: Vec2<S>,
    /// The outward unit normal of the surface there; zero if a ray starts in the collider, or a shape overlaps it at the start. At a sharp corner
    /// the mean of the normals of the edges that are met from outside, also where a ray meets the seam of a chain; at a seam of polygons
    /// that are [one surface](crate::guide::queries) the normal of the surface, not of a corner. *Error* 1 ulp in each component; 4 ulps of a
    /// mean with an edge of another collider or part.
    pub normal: Vec2<S>,
    /// The number of the part of a compound or of the segment of a chain; 0 for all other shapes.
    pub part: u32,
}

/// A ray or a shape that is cast: the outlines of the shape, as seen from its position, and the position.
struct Cast {
    from: Point,
    translation: Point,
    shape: Option<Vec<Core>>,
}

/// The number of the outline of the moving shape that meets the target, and where.
type Met = (u32, RayEnd);

impl Cast {
    fn path(&self) -> Path {
        let none = [self.from; 2];
        let around = |corners: [Point; 2]| corners.map(|corner| beside(self.from, corner));
        let bounds = self.shape.iter().flatten().map(|core| around(core.bounds()));
        let union = |[min, max]: [Point; 2], [low, high]: [Point; 2]| {
            [[min[0].min(low[0]), min[1].min(low[1])], [max[0].max(high[0]), max[1].max(high[1])]]
        };
        let [min, max] = bounds.reduce(union).unwrap_or(none);
        Path::new(min, max, self.translation)
    }

    /// The line of a ray.
    fn line(&self) -> Option<Line> {
        self.shape.is_none().then(|| Line::new(self.from, self.translation))
    }

    /// The first point on the way to a collider.
    #[inline]
    fn meet<S: Scalar>(&self, outline: &Found<'_, S>, line: Option<&Line>) -> Option<Met> {
        if line.is_some_and(|line| outline.is_beside(line)) {
            return None;
        }
        let (core, is_link) = outline.core(self.from)?;
        match &self.shape {
            None => ray_hit(&core, is_link, self.translation).map(|end| (0, end)),
            Some(parts) => {
                let hits = (0..)
                    .zip(parts)
                    .filter_map(|(own_part, part)| Some((own_part, cast_hit(part, &core, is_link, self.translation)?)));
                hits.min_by_key(|&(own_part, end)| (end.fraction, own_part))
            }
        }
    }
}

impl<S: Scalar> Queries<'_, S> {
    /// The result for a collider that is met.
    fn hit(&self, cast: &Cast, filter: &QueryFilter<'_, S>, outline: &Found<'_, S>, met: Met) -> Option<CastHit<S>> {
        let (own_part, end) = met;
        let Target { collider, id, part } = outline.target()?;
        let (ray, (target, is_link)) = (cast.translation, outline.core(cast.from)?);
        let seam_normal = |core: &Core| {
            if !has_surface(&target, is_link) {
                return None;
            }
            let place = SeamPlace::of(core, ray, end)?;
            self.seam_normal(cast, filter, outline, own_part, core, place)
        };
        let (offset, normal) = match &cast.shape {
            None if is_link => {
                let beyond = beyond_seam(&collider.def.shape, part, end);
                let core = |part| outline.core_of(OutlineId { slot: id.slot, part }, cast.from);
                let beyond = beyond.and_then(core).map(|(core, _)| core);
                (at(ray, end.fraction), normal_at_seam(&target, beyond, ray, end))
            }
            None => (at(ray, end.fraction), seam_normal(&target).unwrap_or_else(|| normal(&target, ray, end))),
            Some(parts) => {
                let moving = &parts[own_part as usize];
                let sum = Sum::new(moving, &target);
                let normal = seam_normal(&sum.core).unwrap_or_else(|| normal(&sum.core, ray, end));
                (sum.touch_point([moving, &target], ray, end, normal), normal)
            }
        };
        Some(CastHit {
            collider: id,
            body: collider.body,
            fraction: in_parts(end.fraction),
            point: in_scalar(beside(cast.from, offset)),
            normal: normal.map(S::from_fx),
            part,
        })
    }

    /// The normal where a cast meets a corner at a seam of an outline with others, for the part of the shape that meets it, and the sum of the
    /// two.
    fn seam_normal(
        &self,
        cast: &Cast,
        filter: &QueryFilter<'_, S>,
        outline: &Found<'_, S>,
        own_part: u32,
        core: &Core,
        place: SeamPlace,
    ) -> Option<Vec2> {
        let target = outline.target()?;
        let mut seam = Seam::new(core, place);
        let point = [Core::around(&[[0; 2]])];
        for (number, part) in (0..).zip(cast.shape.as_deref().unwrap_or(&point)) {
            let corners = part.bounds().map(|corner| beside(beside(cast.from, place.point), corner));
            let bounds = [corners[0].map(|part| part - REACH), corners[1].map(|part| part + REACH)];
            self.in_box(bounds, filter, |neighbour| {
                let are_one = if neighbour.outline == outline.outline {
                    number != own_part
                } else {
                    neighbour.target().is_some_and(|other_target| self.are_joined(&target, &other_target))
                };
                if !are_one {
                    return true;
                }
                let Some((core, is_link)) = neighbour.core(cast.from) else { return true };
                !has_surface(&core, is_link) || seam.add(&Sum::new(part, &core).core)
            });
        }
        seam.normal(cast.translation)
    }

    /// Returns true if two outlines have one surface, as they have it for contacts.
    fn are_joined(&self, a: &Target<'_, S>, b: &Target<'_, S>) -> bool {
        let [def, neighbour] = [&a.collider.def, &b.collider.def];
        if def.shape.is_chain() || neighbour.shape.is_chain() {
            let count = a.collider.outline_count();
            let [low, high] = [a.part.min(b.part), a.part.max(b.part)];
            let is_closed = matches!(def.shape.geometry(), Geometry::Chain { closed: true, .. });
            return a.id == b.id && (high - low == 1 || is_closed && high - low == count - 1);
        }
        if def.filter != neighbour.filter {
            return false;
        }
        match self.kind(a.collider.body) {
            Some(BodyKind::Static) => {
                self.kind(b.collider.body) == Some(BodyKind::Static) && def.one_way == neighbour.one_way
            }
            _ => a.collider.body == b.collider.body && a.collider.side == b.collider.side,
        }
    }
}

impl<S: Scalar> Queries<'_, S> {
    fn ray(origin: Vec2<S>, translation: Vec2<S>) -> Result<Cast, Error> {
        Ok(Cast { from: checked_point(origin)?, translation: checked_translation(translation)?, shape: None })
    }

    fn shape_cast(shape: &Shape<S>, pose: (Vec2<S>, S), translation: Vec2<S>) -> Result<Cast, Error> {
        let (from, parts) = checked_shape(shape, pose.0, pose.1)?;
        Ok(Cast { from, translation: checked_translation(translation)?, shape: Some(parts) })
    }

    /// The hit that comes first.
    fn first(&self, cast: &Cast, filter: &QueryFilter<'_, S>) -> Option<CastHit<S>> {
        if filter.predicate.is_some() {
            return self.all(cast, filter, 1).pop();
        }
        let (mut least, line): (Option<(Found<'_, S>, Met)>, _) = (None, cast.line());
        self.on_path(&mut cast.path(), filter, |outline, path| {
            let Some(met) = cast.meet(&outline, line.as_ref()) else { return true };
            let fraction = met.1.fraction;
            // Keys and handles are looked up only where fractions tie.
            let is_first = match &least {
                Some((first, (_, end))) if end.fraction == fraction => outline.rank(0) < first.rank(0),
                Some((_, (_, end))) => fraction < end.fraction,
                None => true,
            };
            if is_first {
                path.shorten(fraction);
                least = Some((outline, met));
            }
            true
        });
        let (outline, met) = least?;
        self.hit(cast, filter, &outline, met)
    }

    /// The first so many hits in their order.
    fn all(&self, cast: &Cast, filter: &QueryFilter<'_, S>, limit: usize) -> Vec<CastHit<S>> {
        self.ranked(cast, filter, false)
            .into_iter()
            .map(|(_, hit)| hit)
            .filter(|hit| self.accepts(hit.collider, filter))
            .take(limit)
            .collect()
    }

    /// All hits in their order, or those that tie for the first place.
    fn ranked(&self, cast: &Cast, filter: &QueryFilter<'_, S>, are_first: bool) -> Vec<(Rank, CastHit<S>)> {
        let (mut hits, mut least, line) = (Vec::new(), u64::MAX, cast.line());
        self.on_path(&mut cast.path(), filter, |outline, path| {
            let Some(met) = cast.meet(&outline, line.as_ref()) else { return true };
            let fraction = met.1.fraction;
            if are_first && fraction < least {
                least = fraction;
                path.shorten(least);
            }
            if !are_first || fraction == least {
                hits.extend(outline.rank(fraction.into()).map(|rank| (rank, (outline, met))));
            }
            true
        });
        if are_first {
            hits.retain(|((fraction, ..), _)| *fraction == u128::from(least));
        }
        sort_by_rank(&mut hits);
        let hit =
            |(rank, (outline, met)): (Rank, (Found<'_, S>, Met))| Some((rank, self.hit(cast, filter, &outline, met)?));
        hits.into_iter().filter_map(hit).collect()
    }

    /// The hits that tie for the first place.
    fn ties(&self, cast: &Cast, filter: &QueryFilter<'_, S>) -> Vec<CastHit<S>> {
        let ranked = self.ranked(cast, filter, filter.predicate.is_none());
        let mut accepted = ranked.into_iter().filter(|(_, hit)| self.accepts(hit.collider, filter));
        let Some((first, hit)) = accepted.next() else { return Vec::new() };
        // `map_while` calls the predicate for one more: the first one behind the ties.
        let ties = accepted.map_while(|(rank, hit)| (rank.0 == first.0).then_some(hit));
        core::iter::once(hit).chain(ties).collect()
    }

    pub(super) fn accepts(&self, id: ColliderId, filter: &QueryFilter<'_, S>) -> bool {
        self.world.colliders.get(id).is_ok_and(|collider| filter.accepts(id, &collider.def))
    }

    /// The first collider on a ray from `origin` to `origin + translation`, both in m. Where several are at the same fraction, the one with
    /// the least key, then handle; [`cast_ray_ties`](Self::cast_ray_ties) gives all of them.
    ///
    /// Shapes are closed sets: a graze counts. A ray that starts in a collider hits it at fraction 0 with a normal of zero. A segment of a
    /// chain is hit only from the side on which it [touches others](Shape::chain): a ray that starts on it hits it if it goes to the other
    /// side.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Query`] for the translation, whose components are within ±2^20 m, and with
    /// [`Quantity::Position`] for the origin.
    pub fn cast_ray(
        &self,
        origin: Vec2<S>,
        translation: Vec2<S>,
        filter: &QueryFilter<'_, S>,
    ) -> Result<Option<CastHit<S>>, Error> {
        Ok(self.first(&Self::ray(origin, translation)?, filter))
    }

    /// All colliders on a ray, each with the first point where the ray meets it, sorted.
    ///
    /// # Errors
    /// As [`cast_ray`](Self::cast_ray).
    pub fn cast_ray_all(
        &self,
        origin: Vec2<S>,
        translation: Vec2<S>,
        filter: &QueryFilter<'_, S>,
    ) -> Result<Vec<CastHit<S>>, Error> {
        Ok(self.all(&Self::ray(origin, translation)?, filter, usize::MAX))
    }

    /// The colliders that tie for the first place on a ray, sorted: those at the least fraction, in units of 2^-62.
    ///
    /// # Errors
    /// As [`cast_ray`](Self::cast_ray).
    ///
    /// ```
    /// use umbra_physics::{BodyDef, QueryFilter, Shape, World, WorldDef, fx, vec2};
    ///
    /// // A ray into the seam of two tiles meets both. The answer is the same in a world with the tiles added in another order,
    /// // if they have keys.
    /// let mut world = World::new(WorldDef::default())?;
    /// let tile = BodyDef::fixed().with_collider(Shape::rectangle(1, 1)?);
    /// for x in [fx!(0.5), fx!(-0.5)] {
    ///     world.add_body(BodyDef { position: vec2(x, 0), ..tile.clone() })?;
    /// }
    /// let (queries, all) = (world.queries(), QueryFilter::default());
    /// assert_eq!(queries.cast_ray_ties(vec2(0, 2), vec2(0, -2), &all)?.len(), 2);
    /// assert!(queries.cast_ray_any(vec2(0, 2), vec2(0, -2), &all)?);
    /// assert!(!queries.cast_ray_any(vec2(0, 2), vec2(0, -1), &all)?);
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn cast_ray_ties(
        &self,
        origin: Vec2<S>,
        translation: Vec2<S>,
        filter: &QueryFilter<'_, S>,
    ) -> Result<Vec<CastHit<S>>, Error> {
        Ok(self.ties(&Self::ray(origin, translation)?, filter))
    }

    /// Returns true if a ray meets any collider: a line of sight is blocked. Faster than [`cast_ray`](Self::cast_ray), as it ends with the
    /// first one that it finds.
    ///
    /// # Errors
    /// As [`cast_ray`](Self::cast_ray).
    pub fn cast_ray_any(
        &self,
        origin: Vec2<S>,
        translation: Vec2<S>,
        filter: &QueryFilter<'_, S>,
    ) -> Result<bool, Error> {
        let cast = Self::ray(origin, translation)?;
        if filter.predicate.is_some() {
            return Ok(self.first(&cast, filter).is_some());
        }
        let mut is_met = false;
        let line = cast.line();
        self.on_path(&mut cast.path(), filter, |outline, _| {
            is_met = cast.meet(&outline, line.as_ref()).is_some();
            !is_met
        });
        Ok(is_met)
    }

    /// The first collider that a shape meets on its way from a pose (the position of its centre of mass in m, and the angle in rad) over a
    /// translation in m, without turning. Where several are at the same fraction, the one with the least key, then handle.
    ///
    /// A shape that overlaps a collider at the start meets it at fraction 0 with a normal of zero. One that touches it exactly, at the start or on its
    /// way, meets it there if its way leads into the collider, and passes if it slides along it, grazes it or leaves it: a crate on a floor
    /// can be moved along it. A segment of a chain is met by shapes that come from its outer side: those that move towards it and do not have the middle of their corners behind it at
    /// the start. *Cost* in proportion to the parts of the shape as well.
    ///
    /// # Errors
    /// As [`cast_ray`](Self::cast_ray); [`Error::OutOfRange`] with [`Quantity::Angle`]; [`Error::DynamicChain`] for a chain.
    pub fn cast_shape(
        &self,
        shape: &Shape<S>,
        pose: (Vec2<S>, S),
        translation: Vec2<S>,
        filter: &QueryFilter<'_, S>,
    ) -> Result<Option<CastHit<S>>, Error> {
        Ok(self.first(&Self::shape_cast(shape, pose, translation)?, filter))
    }

    /// All colliders that a shape meets on its way, each where it meets it first, sorted.
    ///
    /// # Errors
    /// As [`cast_shape`](Self::cast_shape).
    ///
    /// ```
    /// use umbra_physics::{BodyDef, QueryFilter, Shape, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// for (x, y) in [(4, -1), (4, 1), (7, 0)] {
    ///     world.add_body(BodyDef { position: vec2(x, y), ..BodyDef::fixed().with_collider(Shape::rectangle(1, 1)?) })?;
    /// }
    /// let (ball, all) = (Shape::circle(1)?, QueryFilter::default());
    /// let start = (vec2(0, 0), fx!(0));
    /// let hits = world.queries().cast_shape_all(&ball, start, vec2(10, 0), &all)?;
    /// assert!(hits.is_sorted_by_key(|hit| hit.fraction) && hits.len() == 3);
    /// // It meets the corners of two of them at once.
    /// assert_eq!(world.queries().cast_shape_ties(&ball, start, vec2(10, 0), &all)?, hits[..2]);
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn cast_shape_all(
        &self,
        shape: &Shape<S>,
        pose: (Vec2<S>, S),
        translation: Vec2<S>,
        filter: &QueryFilter<'_, S>,
    ) -> Result<Vec<CastHit<S>>, Error> {
        Ok(self.all(&Self::shape_cast(shape, pose, translation)?, filter, usize::MAX))
    }

    /// The colliders that a shape meets at the same time, before all others, sorted.
    ///
    /// # Errors
    /// As [`cast_shape`](Self::cast_shape).
    pub fn cast_shape_ties(
        &self,
        shape: &Shape<S>,
        pose: (Vec2<S>, S),
        translation: Vec2<S>,
        filter: &QueryFilter<'_, S>,
    ) -> Result<Vec<CastHit<S>>, Error> {
        Ok(self.ties(&Self::shape_cast(shape, pose, translation)?, filter))
    }
}

/// Returns true for an outline that has a surface with others: a sharp polygon, or a segment of a chain.
fn has_surface(core: &Core, is_link: bool) -> bool {
    is_link || core.corners().len() > 2 && core.radius == 0
}

/// The position of a shape in ulps, and the cores of its outlines as seen from there.
pub(super) fn checked_shape<S: Scalar>(
    shape: &Shape<S>,
    position: Vec2<S>,
    angle: S,
) -> Result<(Point, Vec<Core>), Error> {
    if shape.is_chain() {
        return Err(Error::DynamicChain);
    }
    if !angle.is_finite() {
        return Err(Error::OutOfRange { quantity: Quantity::Angle });
    }
    let from = checked_point(position)?;
    let placement = Placement::<S>::new(position, S::Angle::from_radians(angle));
    Ok((from, shape.outlines().iter().filter_map(|outline| Core::new(outline, &placement, from)).collect()))
}
