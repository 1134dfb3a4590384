//! Making shapes: the checks, and the centre of mass.

use alloc::sync::Arc;
use alloc::vec::Vec;
use core::cmp::Ordering;

use super::outline::outlines;
use super::{Geometry, Part, Shape, mass};
use crate::codec::StateHasher;
use crate::error::{Error, Quantity};
use crate::fx::IntoFx;
use crate::limits::{CORNERS, PARTS, SIZE_MAX, SIZE_MIN};
use crate::math::Vec2;
use crate::scalar::internals::AreaMoments;
use crate::scalar::{Factor, Scalar};

/// Refuses a size outside the limits.
fn check_size<S: Scalar>(size: S) -> Result<(), Error> {
    if size >= S::from_fx(SIZE_MIN) && size <= S::from_fx(SIZE_MAX) {
        return Ok(());
    }
    Err(Error::OutOfRange { quantity: Quantity::Size })
}

/// Refuses a point farther out than any shape reaches.
fn check_point<S: Scalar>(point: Vec2<S>) -> Result<(), Error> {
    if point.is_within(S::from_fx(SIZE_MAX)) {
        return Ok(());
    }
    Err(Error::OutOfRange { quantity: Quantity::Size })
}

impl Shape {
    /// A disc of this radius in m.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Size`].
    ///
    /// ```
    /// use umbra_physics::{Shape, fx};
    /// let wheel = Shape::circle(fx!(0.5))?;
    /// let gate = Shape::rectangle(50, 1)?; // integers need no fx!
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn circle(radius: impl IntoFx) -> Result<Self, Error> {
        Self::new(Geometry::Circle { radius: radius.into() })
    }

    /// A rectangle of this width (along x) and height in m.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Size`].
    pub fn rectangle(width: impl IntoFx, height: impl IntoFx) -> Result<Self, Error> {
        Self::new(Geometry::Rectangle { width: width.into(), height: height.into() })
    }

    /// A capsule along x: `length` in m between the centres of its round ends, `radius` in m.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Size`].
    pub fn capsule(length: impl IntoFx, radius: impl IntoFx) -> Result<Self, Error> {
        Self::new(Geometry::Capsule { length: length.into(), radius: radius.into() })
    }
}

impl<S: Scalar> Shape<S> {
    fn of(geometry: Geometry<S>, shift: Vec2<S>, measure: S::Factor, gyration: S::Factor) -> Self {
        S::new_shape(geometry, shift, measure, gyration)
    }

    pub(crate) fn of_inner(geometry: Geometry<S>, shift: Vec2<S>, measure: S::Factor, gyration: S::Factor) -> Self {
        let outlines = outlines(&geometry);
        let shape = Self { geometry, shift, measure, gyration, outlines, digest: 0 };
        Self { digest: StateHasher::of(&shape), ..shape }
    }

    /// A shape of this geometry, re-centred at its centre of mass.
    ///
    /// The named constructors make the same shapes of `Fx`; this one makes those of floats too.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Size`] for a disc, a rectangle or a capsule, and as [`segment`](Self::segment),
    /// [`polygon`](Self::polygon) and [`compound`](Self::compound).
    ///
    /// ```
    /// use umbra_physics::{Geometry, Shape, fx};
    /// assert_eq!(Shape::new(Geometry::Circle { radius: fx!(0.5) }), Shape::circle(fx!(0.5)));
    /// ```
    pub fn new(geometry: Geometry<S>) -> Result<Self, Error> {
        let (measure, gyration) = match geometry {
            Geometry::Circle { radius } => {
                check_size(radius)?;
                mass::circle(radius)
            }
            Geometry::Rectangle { width, height } => {
                check_size(width)?;
                check_size(height)?;
                mass::rectangle(width, height)
            }
            Geometry::Capsule { length, radius } => {
                check_size(length)?;
                check_size(radius)?;
                mass::capsule(length, radius)
            }
            Geometry::Polygon { corners } => return Self::polygon(&corners),
            Geometry::RoundedPolygon { corners, radius } => return Self::rounded_polygon(&corners, radius),
            Geometry::Segment { ends: [a, b] } => return Self::segment(a, b),
            Geometry::Compound { parts } => return Self::compound(&parts),
        };
        Ok(Self::of(geometry, Vec2::ZERO, measure, gyration))
    }

    /// A thin rod between two points. Its density is in kg/m.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Size`] for its length or a coordinate.
    pub fn segment(a: Vec2<S>, b: Vec2<S>) -> Result<Self, Error> {
        check_point(a)?;
        check_point(b)?;
        let even = [S::Factor::ONE, S::Factor::ONE];
        let middle = |p: S, q: S| S::weighted_mean(&even, &[p, q]).unwrap_or(S::ZERO);
        let shift = Vec2::new(middle(a.x, b.x), middle(a.y, b.y));
        let ends = [a - shift, b - shift];
        let length = (b - a).wide_length();
        if length < S::Factor::from_scalar(S::from_fx(SIZE_MIN)) {
            return Err(Error::OutOfRange { quantity: Quantity::Size });
        }
        let (measure, gyration) = mass::segment::<S>(length);
        Ok(Self::of(Geometry::Segment { ends }, shift, measure, gyration))
    }

    /// A convex polygon with these corners in either order; re-centred at its centroid.
    ///
    /// Its area, centroid and inertia come from exact sums, so that neither the first corner nor the winding changes a bit.
    ///
    /// # Errors
    /// [`Error::NotConvex`] at the first corner that does not turn the way the others do, or repeats another;
    /// [`Error::OutOfRange`] with [`Quantity::Count`] or [`Quantity::Size`].
    pub fn polygon(corners: &[Vec2<S>]) -> Result<Self, Error> {
        S::polygon(corners)
    }

    /// A convex polygon, with these corners in either order, and all points within `radius` m of it; re-centred at its centre of mass.
    ///
    /// Neither the first corner nor the winding changes a bit.
    ///
    /// # Errors
    /// As [`polygon`](Self::polygon) for the corners; [`Error::OutOfRange`] with [`Quantity::Size`] for the radius, which is not zero.
    ///
    /// ```
    /// use umbra_physics::{Shape, fx, vec2};
    /// // A box of 3 m by 3 m whose corners have a radius of 0.5 m.
    /// let core = [vec2(-1, -1), vec2(1, -1), vec2(1, 1), vec2(-1, 1)];
    /// let shape = Shape::rounded_polygon(&core, fx!(0.5))?;
    /// assert_eq!(format!("{:.4}", shape.measure()), "8.7854"); // 9 m² less what the corners lack
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn rounded_polygon(corners: &[Vec2<S>], radius: S) -> Result<Self, Error> {
        S::rounded_polygon(corners, radius)
    }

    pub(crate) fn polygon_inner(corners: &[Vec2<S>]) -> Result<Self, Error> {
        let corners = checked_corners(corners)?;
        let shift = moments(&corners)?.centroid;
        let centred: Vec<Vec2<S>> = corners.iter().map(|&c| c - shift).collect();
        check_extent(&centred)?;
        let moments = moments(&centred)?;
        let gyration = moments.second.over(moments.area);
        Ok(Self::of(Geometry::Polygon { corners: centred.into() }, shift, moments.area, gyration))
    }

    pub(crate) fn rounded_polygon_inner(corners: &[Vec2<S>], radius: S) -> Result<Self, Error> {
        let corners = checked_corners(corners)?;
        check_size(radius)?;
        let core = moments(&corners)?;
        let mut weights = mass::rounded_weights(&corners, radius);
        weights.push(core.area);
        let mean = |pick: fn(&Vec2<S>) -> S| {
            let values: Vec<S> = corners.iter().chain([&core.centroid]).map(pick).collect();
            S::weighted_mean(&weights, &values).unwrap_or(S::ZERO)
        };
        let shift = Vec2::new(mean(|c| c.x), mean(|c| c.y));
        let centred: Vec<Vec2<S>> = corners.iter().map(|&c| c - shift).collect();
        check_extent(&centred)?;
        let (measure, gyration) = mass::rounded_polygon(&centred, radius, moments(&centred)?.area);
        Ok(Self::of(Geometry::RoundedPolygon { corners: centred.into(), radius }, shift, measure, gyration))
    }

    /// Several shapes as one, re-centred at their common centre of mass.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Count`] for no parts, too many, or a compound among them; with
    /// [`Quantity::Density`] or [`Quantity::Size`] for a part's.
    pub fn compound(parts: &[Part<S>]) -> Result<Self, Error> {
        S::compound(parts)
    }

    pub(crate) fn compound_inner(parts: &[Part<S>]) -> Result<Self, Error> {
        let nested = parts.iter().any(|p| matches!(p.shape.geometry, Geometry::Compound { .. }));
        if parts.is_empty() || parts.len() > PARTS || nested {
            return Err(Error::OutOfRange { quantity: Quantity::Count });
        }
        for part in parts {
            check_point(part.position)?;
            if !part.angle.is_finite() {
                return Err(Error::OutOfRange { quantity: Quantity::Angle });
            }
            if !(part.density > S::ZERO && part.density.is_finite()) {
                return Err(Error::OutOfRange { quantity: Quantity::Density });
            }
        }
        let weights: Vec<S::Factor> =
            parts.iter().map(|p| S::Factor::from_scalar(p.density).times(p.shape.measure)).collect();
        let mean = |pick: fn(&Part<S>) -> S| {
            let values: Vec<S> = parts.iter().map(pick).collect();
            S::weighted_mean(&weights, &values).unwrap_or(S::ZERO)
        };
        let shift = Vec2::new(mean(|p| p.position.x), mean(|p| p.position.y));
        let parts: Arc<[Part<S>]> = parts.iter().map(|p| Part { position: p.position - shift, ..p.clone() }).collect();
        let (measure, gyration) = mass::compound(&parts, &weights);
        Ok(Self::of(Geometry::Compound { parts }, shift, measure, gyration))
    }
}

/// The corners of a convex polygon, counter-clockwise.
fn checked_corners<S: Scalar>(corners: &[Vec2<S>]) -> Result<Vec<Vec2<S>>, Error> {
    if !(3..=CORNERS).contains(&corners.len()) {
        return Err(Error::OutOfRange { quantity: Quantity::Count });
    }
    corners.iter().try_for_each(|&corner| check_point(corner))?;
    let winding = check_convex(corners)?;
    let mut corners = corners.to_vec();
    if winding == Ordering::Less {
        corners.reverse();
    }
    Ok(corners)
}

/// Area, centroid and second moment. *Domain* convex with three corners or more: then the area is not zero.
fn moments<S: Scalar>(corners: &[Vec2<S>]) -> Result<AreaMoments<S>, Error> {
    S::polygon_moments(corners).ok_or(Error::NotConvex { corner: 0 })
}

/// The way the corners turn, the same at each of them, and once around in all.
fn check_convex<S: Scalar>(corners: &[Vec2<S>]) -> Result<Ordering, Error> {
    let n = corners.len();
    let corner = |i: usize| corners[i % n];
    let winding = S::orientation(corner(n - 1), corner(0), corner(1));
    for i in 0..n {
        let turn = S::orientation(corner(i + n - 1), corner(i), corner(i + 1));
        if turn == Ordering::Equal || turn != winding {
            return Err(Error::NotConvex { corner: i });
        }
        // A star turns one way throughout as well, but goes round twice: then a corner is behind the first edge, or the
        // fan of triangles from the first corner folds back.
        let behind = |p: usize, q: usize| S::orientation(corner(0), corner(p), corner(q)) != winding;
        if i >= 2 && (behind(1, i) || behind(i - 1, i)) {
            return Err(Error::NotConvex { corner: i });
        }
    }
    Ok(winding)
}

/// A polygon is at least as large as the smallest size along one of the axes.
fn check_extent<S: Scalar>(corners: &[Vec2<S>]) -> Result<(), Error> {
    // Corners are within the largest size of the origin, so that their differences fit.
    let is_wide = |pick: fn(&Vec2<S>) -> S| {
        let far = |p| corners.iter().any(|q| pick(q) - p >= S::from_fx(SIZE_MIN));
        corners.iter().map(pick).any(far)
    };
    if is_wide(|c| c.x) || is_wide(|c| c.y) {
        return Ok(());
    }
    Err(Error::OutOfRange { quantity: Quantity::Size })
}
