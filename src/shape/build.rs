//! Making shapes: the checks, and the centre of mass.

use alloc::sync::Arc;
use alloc::vec::Vec;
use core::cmp::Ordering;

use super::outline::outlines;
use super::{Geometry, Part, Shape, mass};
use crate::codec::StateHasher;
use crate::error::{Error, Quantity};
use crate::limits::{CORNERS, PARTS, SIZE_MAX, SIZE_MIN};
use crate::math::Vec2;
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

impl<S: Scalar> Shape<S> {
    fn of(geometry: Geometry<S>, shift: Vec2<S>, measure: S::Factor, gyration: S::Factor) -> Self {
        S::new_shape(geometry, shift, measure, gyration)
    }

    pub(crate) fn of_inner(geometry: Geometry<S>, shift: Vec2<S>, measure: S::Factor, gyration: S::Factor) -> Self {
        let outlines = outlines(&geometry);
        let shape = Self { geometry, shift, measure, gyration, outlines, digest: 0 };
        Self { digest: StateHasher::of(&shape), ..shape }
    }

    /// A disc of this radius in m.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Size`].
    ///
    /// ```
    /// use umbra_physics::{Shape, fx};
    /// let wheel = Shape::circle(fx!(0.5))?;
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn circle(radius: S) -> Result<Self, Error> {
        check_size(radius)?;
        let (measure, gyration) = mass::circle(radius);
        Ok(Self::of(Geometry::Circle { radius }, Vec2::ZERO, measure, gyration))
    }

    /// A rectangle of this width (along x) and height in m.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Size`].
    pub fn rectangle(width: S, height: S) -> Result<Self, Error> {
        check_size(width)?;
        check_size(height)?;
        let (measure, gyration) = mass::rectangle(width, height);
        Ok(Self::of(Geometry::Rectangle { width, height }, Vec2::ZERO, measure, gyration))
    }

    /// A capsule along x: `length` in m between the centres of its round ends, `radius` in m.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Size`].
    pub fn capsule(length: S, radius: S) -> Result<Self, Error> {
        check_size(length)?;
        check_size(radius)?;
        let (measure, gyration) = mass::capsule(length, radius);
        Ok(Self::of(Geometry::Capsule { length, radius }, Vec2::ZERO, measure, gyration))
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

    pub(crate) fn polygon_inner(corners: &[Vec2<S>]) -> Result<Self, Error> {
        if !(3..=CORNERS).contains(&corners.len()) {
            return Err(Error::OutOfRange { quantity: Quantity::Count });
        }
        corners.iter().try_for_each(|&corner| check_point(corner))?;
        let winding = check_convex(corners)?;
        // Convex with three corners or more: its area is not zero.
        let given = S::polygon_moments(corners).ok_or(Error::NotConvex { corner: 0 })?;
        let shift = given.centroid;
        let mut centred: Vec<Vec2<S>> = corners.iter().map(|&c| c - shift).collect();
        if winding == Ordering::Less {
            centred.reverse();
        }
        check_extent(&centred)?;
        let moments = S::polygon_moments(&centred).ok_or(Error::NotConvex { corner: 0 })?;
        let gyration = moments.second.over(moments.area);
        Ok(Self::of(Geometry::Polygon { corners: centred.into() }, shift, moments.area, gyration))
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
