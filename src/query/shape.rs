//! Queries on a shape alone.

use super::core::{in_fx, ulps};
use super::{
    Core, Placement, Point, RayEnd, Seam, SeamPlace, at, beyond_seam, distance, nearest, normal_at_seam, odd_shift,
    point, ray_hit,
};
use crate::error::{Error, Quantity};
use crate::fx::Fx;
use crate::limits;
use crate::math::Vec2;
use crate::scalar::Scalar;
use crate::shape::Shape;

/// The first point of a shape on a ray.
///
/// ```
/// use umbra_physics::{Shape, ShapeHit, fx, vec2};
///
/// let bar = Shape::rectangle(fx!(4), fx!(1))?;
/// let hit: Option<ShapeHit> = bar.cast_ray(vec2(-5, 0), vec2(6, 0))?;
/// let hit = hit.unwrap();
/// assert_eq!((hit.fraction, hit.point, hit.normal, hit.part), (fx!(0.5), vec2(-2, 0), vec2(-1, 0), 0));
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct ShapeHit<S = Fx> {
    /// The fraction of the translation at which the ray meets the shape, from 0 to 1, rounded down.
    pub fraction: S,
    /// The point where it does, m. *Error* ½ ulp and 2^-9, and 2^-14 ulp more of a shape with a radius.
    pub point: Vec2<S>,
    /// The outward unit normal of the surface there; zero if the ray starts in the shape. At a sharp corner the mean of the normals of the
    /// edges that the ray meets from outside; at a [seam](crate::guide::queries) of parts the normal of the surface. *Error* 1 ulp in each
    /// component; 4 ulps of a mean with an edge of another part.
    pub normal: Vec2<S>,
    /// The number of the part of a compound or of the segment of a chain; 0 of all others.
    pub part: u32,
}

/// A translation in ulps.
pub(crate) fn checked_translation<S: Scalar>(translation: Vec2<S>) -> Result<Point, Error> {
    if translation.is_within(S::from_fx(limits::QUERY)) {
        return Ok(ulps(translation));
    }
    Err(Error::OutOfRange { quantity: Quantity::Query })
}

/// A point in ulps.
pub(crate) fn checked_point<S: Scalar>(point: Vec2<S>) -> Result<Point, Error> {
    if point.is_within(S::from_fx(limits::POSITION)) {
        return Ok(ulps(point));
    }
    Err(Error::OutOfRange { quantity: Quantity::Position })
}

/// A vector of ulps in a scalar.
pub(crate) fn in_scalar<S: Scalar>(v: Point) -> Vec2<S> {
    in_fx(v).map(S::from_fx)
}

/// The point in ulps at this offset from another one. *Domain* it fits, as it does within [`limits`].
pub(crate) fn beside([x, y]: Point, [by_x, by_y]: Point) -> Point {
    [x + by_x, y + by_y]
}

/// A distance in units of 2^-48 m as a scalar, to nearest.
pub(crate) fn in_metres<S: Scalar>(distance: u128) -> S {
    S::from_fx(Fx::from_bits(odd_shift(distance as i128, super::near::FRACTION) as i64))
}

/// A fraction in units of 2^-62 as a scalar, rounded down to units of 2^-32.
pub(crate) fn in_parts<S: Scalar>(fraction: u64) -> S {
    S::from_fx(Fx::from_bits((fraction >> 30) as i64))
}

impl<S: Scalar> Shape<S> {
    fn cores(&self, from: Point) -> impl Iterator<Item = Option<(u32, Core)>> {
        let placement = Placement::new(Vec2::ZERO, S::Angle::default());
        let core = move |(part, outline)| Some((part, Core::new(outline, &placement, from)?));
        (0..).zip(self.outlines()).map(core)
    }

    /// Returns true if a point, in coordinates relative to the centre of mass, is in the shape or on its surface. Exact; a chain has its
    /// segments alone. *Cost* in proportion to the corners.
    ///
    /// ```
    /// use umbra_physics::{Fx, Shape, fx, vec2};
    ///
    /// let capsule = Shape::capsule(fx!(2), fx!(0.5))?;
    /// assert!(capsule.contains(vec2(fx!(1.5), 0)));
    /// assert!(!capsule.contains(vec2(fx!(1.5) + Fx::DELTA, 0)));
    /// // The nearest point, and the distance from it.
    /// assert_eq!(capsule.closest_point(vec2(4, 4))?, vec2(fx!(1.3), fx!(0.4)));
    /// assert_eq!(capsule.distance(vec2(4, 4))?, fx!(4.5));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[must_use]
    pub fn contains(&self, point: Vec2<S>) -> bool {
        self.cores(ulps(point)).flatten().any(|(_, core)| super::contains(&core))
    }

    /// The part nearest to a point: its distance in units of 2^-48 m, and its point relative to that one, ulps.
    fn nearest(&self, from: Point) -> Result<(u128, Point), Error> {
        let mut least: Option<(u128, Point)> = None;
        for core in self.cores(from) {
            let (_, core) = core.ok_or(Error::OutOfRange { quantity: Quantity::Query })?;
            let closest = nearest(core.corners());
            let away = distance(&core, closest);
            if least.is_none_or(|(least, _)| away < least) {
                least = Some((away, point(&core, closest, away).0));
            }
        }
        least.ok_or(Error::OutOfRange { quantity: Quantity::Count })
    }

    /// The point of the shape that is nearest to a point, m: that point itself if it is in the shape. Where several parts are at
    /// the same distance, the point of the first one. *Error* ½ ulp and 2^-7 in each component. *Cost* in proportion to the corners.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Query`] for a coordinate of 2^21 m or more either way.
    pub fn closest_point(&self, point: Vec2<S>) -> Result<Vec2<S>, Error> {
        let from = ulps(point);
        let (_, offset) = self.nearest(from)?;
        Ok(if offset == [0; 2] { point } else { in_scalar(beside(from, offset)) })
    }

    /// The distance of a point from the shape, m; 0 in it. *Error* ½ ulp and 2^-16. *Cost* in proportion to the corners.
    ///
    /// # Errors
    /// As [`closest_point`](Self::closest_point).
    pub fn distance(&self, point: Vec2<S>) -> Result<S, Error> {
        Ok(in_metres(self.nearest(ulps(point))?.0))
    }

    /// The normal where a ray meets a corner at a seam of a part with others.
    fn seam_normal(&self, from: Point, part: u32, core: &Core, ray: Point, end: RayEnd) -> Option<Vec2> {
        let mut seam = Seam::new(core, SeamPlace::of(core, ray, end)?);
        for (_, core) in self.cores(from).flatten().filter(|&(number, _)| number != part) {
            if !seam.add(&core) {
                break;
            }
        }
        seam.normal(ray)
    }

    /// The first point of the shape on a ray from `origin`, relative to the centre of mass, to `origin + translation`, m. Where several
    /// parts are hit at the same point, the first one is reported. Shapes are closed: a graze counts, and a ray that starts in the shape
    /// hits at fraction 0 with a normal of zero. A segment of a chain is hit only from the side on which it [touches others](Self::chain).
    /// *Cost* in proportion to the corners.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Query`] for the translation, with [`Quantity::Position`] for the origin.
    pub fn cast_ray(&self, origin: Vec2<S>, translation: Vec2<S>) -> Result<Option<ShapeHit<S>>, Error> {
        let (from, ray) = (checked_point(origin)?, checked_translation(translation)?);
        let hits = self.cores(from).flatten().filter_map(|(part, core)| {
            let end = ray_hit(&core, self.is_chain(), ray)?;
            Some((end, part, core))
        });
        let Some((end, part, core)) = hits.min_by_key(|&(end, part, _)| (end.fraction, part)) else { return Ok(None) };
        let beyond = beyond_seam(self, part, end).and_then(|number| self.cores(from).nth(number as usize)?);
        let normal = self
            .seam_normal(from, part, &core, ray, end)
            .unwrap_or_else(|| normal_at_seam(&core, beyond.map(|(_, core)| core), ray, end));
        Ok(Some(ShapeHit {
            fraction: in_parts(end.fraction),
            point: if end.fraction == 0 { origin } else { in_scalar(beside(from, at(ray, end.fraction))) },
            normal: normal.map(S::from_fx),
            part,
        }))
    }
}
