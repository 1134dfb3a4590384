//! Overlaps, and closest points.

use alloc::vec::Vec;

use super::cast::checked_shape;
use super::{Found, Queries, QueryFilter, sort_by_rank};
use crate::error::{Error, Quantity};
use crate::fx::Fx;
use crate::limits;
use crate::math::Vec2;
use crate::query::{
    Core, Point, Sum, beside, checked_point, contains, distance, in_metres, in_scalar, nearest, point as surface_point,
};
use crate::scalar::Scalar;
use crate::shape::{Aabb, Shape};
use crate::slots::{BodyId, ColliderId};

/// The point of a collider that is nearest to a point.
///
/// ```
/// use umbra_physics::{BodyDef, ClosestPoint, QueryFilter, Shape, World, WorldDef, fx, vec2};
///
/// let mut world = World::new(WorldDef::default())?;
/// let ground = world.add_body(BodyDef::fixed().with_collider(Shape::rectangle(20, 2)?))?;
/// let closest: Option<ClosestPoint> = world.queries().closest_point(vec2(3, 5), fx!(10), &QueryFilter::default())?;
/// let closest = closest.unwrap();
/// assert_eq!((closest.body, closest.distance, closest.point, closest.part), (ground, fx!(4), vec2(3, 1), 0));
/// assert_eq!(world.queries().closest_point(vec2(3, 5), fx!(3), &QueryFilter::default())?, None);
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct ClosestPoint<S = Fx> {
    /// The collider.
    pub collider: ColliderId,
    /// The body of the collider.
    pub body: BodyId,
    /// The distance, m; 0 if the point is in the collider. *Error* ½ ulp and 2^-16.
    pub distance: S,
    /// The nearest point of the collider, m: the queried point itself if it is in the collider. *Error* ½ ulp and 2^-7 in each component.
    pub point: Vec2<S>,
    /// The number of the part of a compound or of the segment of a chain; 0 for all other shapes.
    pub part: u32,
}

/// The first distance within which a closest point is looked for, 1 m; then twice that, and so on.
const FIRST_REACH: i64 = 1 << 32;

impl<S: Scalar> Queries<'_, S> {
    /// The colliders that overlap a shape at a pose (the position of its centre of mass in m, and the angle in rad) or touch it, sorted
    /// by key, then by handle. Exact. A segment of a chain is a line for it, without a side.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Position`] or [`Quantity::Angle`]; [`Error::DynamicChain`] for a chain.
    ///
    /// ```
    /// use umbra_physics::{Aabb, BodyDef, Fx, QueryFilter, Shape, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let disc = world.add_body(BodyDef::dynamic().with_collider(Shape::circle(1)?))?;
    /// let disc = world.colliders_of(disc)?.next().unwrap();
    /// let (queries, all) = (world.queries(), QueryFilter::default());
    /// // 3 m and 4 m away: a disc of 4 m touches that of 1 m, a smaller one does not.
    /// let at = (vec2(3, 4), fx!(0));
    /// assert_eq!(queries.overlap_shape(&Shape::circle(4)?, at, &all)?, [disc]);
    /// assert_eq!(queries.overlap_shape(&Shape::circle(fx!(4) - Fx::DELTA)?, at, &all)?, []);
    /// // A box and a point: the box of the disc is no matter.
    /// let corner = |x: Fx| Aabb { min: vec2(x, x), max: vec2(1, 1) };
    /// assert_eq!(queries.overlap_box(corner(fx!(0.7)), &all)?, [disc]);
    /// assert_eq!(queries.overlap_box(corner(fx!(0.71)), &all)?, []);
    /// assert_eq!(queries.overlap_point(vec2(fx!(0.6), fx!(0.8)), &all)?, []); // 0.6 and 0.8 are rounded
    /// assert_eq!(queries.overlap_point(vec2(0, -1), &all)?, [disc]);
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn overlap_shape(
        &self,
        shape: &Shape<S>,
        pose: (Vec2<S>, S),
        filter: &QueryFilter<'_, S>,
    ) -> Result<Vec<ColliderId>, Error> {
        let (from, parts) = checked_shape(shape, pose.0, pose.1)?;
        Ok(self.overlap(from, &parts, filter))
    }

    /// The colliders that overlap a box or touch it, sorted by key, then by handle. Exact.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Position`] for a corner, with [`Quantity::Query`] for a side that is not from 0 to 2^20 m.
    pub fn overlap_box(&self, bounds: Aabb<S>, filter: &QueryFilter<'_, S>) -> Result<Vec<ColliderId>, Error> {
        let (from, max) = (checked_point(bounds.min)?, checked_point(bounds.max)?);
        // Below 2^63.
        let [width, height] = [max[0] - from[0], max[1] - from[1]];
        let max_size = limits::QUERY.to_bits();
        if !(0..=max_size).contains(&width) || !(0..=max_size).contains(&height) {
            return Err(Error::OutOfRange { quantity: Quantity::Query });
        }
        let corners = [[0, 0], [width, 0], [width, height], [0, height]];
        Ok(self.overlap(from, &[Core::around(&corners)], filter))
    }

    /// The colliders that have a point in them or on their surface, sorted by key, then by handle. Exact.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Position`].
    pub fn overlap_point(&self, point: Vec2<S>, filter: &QueryFilter<'_, S>) -> Result<Vec<ColliderId>, Error> {
        Ok(self.overlap(checked_point(point)?, &[Core::around(&[[0; 2]])], filter))
    }

    fn overlap(&self, from: Point, parts: &[Core], filter: &QueryFilter<'_, S>) -> Vec<ColliderId> {
        let mut hits = Vec::new();
        for part in parts {
            self.in_box(part.bounds().map(|corner| beside(from, corner)), filter, |outline| {
                if outline.core(from).is_some_and(|(core, _)| contains(&Sum::new(part, &core).core)) {
                    hits.extend(outline.rank(0).map(|rank| (rank, ())));
                }
                true
            });
        }
        sort_by_rank(&mut hits);
        hits.into_iter().map(|((_, _, id, _), ())| id).filter(|&id| self.accepts(id, filter)).collect()
    }

    /// The collider nearest to a point, up to `max_distance` m, 0 to 2^20. Where several are at the same distance, the one with the
    /// least key, then handle. No point is inside of a chain, closed or not: the distance to the nearest segment counts.
    ///
    /// *Cost* in proportion to the colliders whose boxes are within 1 m, or within twice the distance of the one that is found if that is
    /// more; with no result, within `max_distance`.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Query`] for a distance that is not from 0 to 2^20 m, and with [`Quantity::Position`] for
    /// the point.
    pub fn closest_point(
        &self,
        point: Vec2<S>,
        max_distance: S,
        filter: &QueryFilter<'_, S>,
    ) -> Result<Option<ClosestPoint<S>>, Error> {
        let (from, max_distance) = checked_reach(point, max_distance)?;
        let mut reach = FIRST_REACH.min(max_distance);
        loop {
            let nearest_point = self.within(from, reach, filter, 1).pop();
            if nearest_point.is_some() || reach == max_distance {
                return Ok(nearest_point);
            }
            reach = reach.saturating_mul(2).min(max_distance);
        }
    }

    /// All colliders up to `max_distance` m, 0 to 2^20, from a point, each with its nearest point, sorted by distance, then by key,
    /// then by handle.
    ///
    /// # Errors
    /// As [`closest_point`](Self::closest_point).
    ///
    /// ```
    /// use umbra_physics::{BodyDef, QueryFilter, Shape, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// for (x, key) in [(6, 1), (-3, 3), (3, 2)] {
    ///     let disc = umbra_physics::ColliderDef { key, ..Shape::circle(1)?.into() };
    ///     world.add_body(BodyDef { position: vec2(x, 0), ..BodyDef::dynamic().with_collider(disc) })?;
    /// }
    /// let points = world.queries().closest_points(vec2(0, 0), fx!(10), &QueryFilter::default())?;
    /// let keys = points.iter().map(|point| world.collider(point.collider).unwrap().key);
    /// assert!(keys.eq([2, 3, 1])); // two at the same distance
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn closest_points(
        &self,
        point: Vec2<S>,
        max_distance: S,
        filter: &QueryFilter<'_, S>,
    ) -> Result<Vec<ClosestPoint<S>>, Error> {
        let (from, max_distance) = checked_reach(point, max_distance)?;
        Ok(self.within(from, max_distance, filter, usize::MAX))
    }

    /// The first so many colliders within a distance in ulps.
    fn within(&self, from: Point, reach: i64, filter: &QueryFilter<'_, S>, limit: usize) -> Vec<ClosestPoint<S>> {
        let mut points = Vec::new();
        self.in_box([from.map(|part| part - reach), from.map(|part| part + reach)], filter, |outline| {
            points.extend(closest(from, reach, &outline));
            true
        });
        sort_by_rank(&mut points);
        points
            .into_iter()
            .map(|(_, point)| point)
            .filter(|point| self.accepts(point.collider, filter))
            .take(limit)
            .collect()
    }
}

/// A point and a distance in ulps.
fn checked_reach<S: Scalar>(point: Vec2<S>, max_distance: S) -> Result<(Point, i64), Error> {
    if !(max_distance >= S::ZERO && max_distance <= S::from_fx(limits::QUERY)) {
        return Err(Error::OutOfRange { quantity: Quantity::Query });
    }
    Ok((checked_point(point)?, max_distance.to_fx().to_bits()))
}

/// The nearest point of an outline, if it is within a distance in ulps.
fn closest<S: Scalar>(from: Point, reach: i64, outline: &Found<'_, S>) -> Option<(super::Rank, ClosestPoint<S>)> {
    let (core, _) = outline.core(from)?;
    let nearest_feature = nearest(core.corners());
    let away = distance(&core, nearest_feature);
    if away > (reach as u128) << 16 {
        return None;
    }
    let (offset, _) = surface_point(&core, nearest_feature, away);
    let target = outline.target()?;
    let rank = (away, target.collider.def.key, target.id, target.part);
    let closest_point = ClosestPoint {
        collider: target.id,
        body: target.collider.body,
        distance: in_metres(away),
        point: in_scalar(beside(from, offset)),
        part: target.part,
    };
    Some((rank, closest_point))
}
