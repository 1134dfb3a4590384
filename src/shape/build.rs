//! Making shapes: the checks, and the centre of mass.

use alloc::sync::Arc;
use alloc::vec::Vec;
use core::cmp::Ordering;

use super::crossing::crossing;
use super::outline::outlines;
use super::{Aabb, Geometry, Part, Shape, mass};
use crate::error::{Dimension, Error, Quantity};
use crate::fx::IntoFx;
use crate::limits::{CHAIN, CORNERS, PARTS, SIZE_MAX, SIZE_MIN};
use crate::math::Vec2;
use crate::scalar::internals::AreaMoments;
use crate::scalar::{Factor, Scalar};

/// The refusal of a size.
fn refused<S: Scalar>(dimension: Dimension, value: S) -> Error {
    Error::OutOfRange { quantity: Quantity::Size { dimension, value: value.to_fx() } }
}

/// Refuses a size outside the limits.
fn check_size<S: Scalar>(size: S, dimension: Dimension) -> Result<(), Error> {
    if size >= S::from_fx(SIZE_MIN) && size <= S::from_fx(SIZE_MAX) { Ok(()) } else { Err(refused(dimension, size)) }
}

/// Refuses the first of some points that is farther out than any shape reaches.
pub(super) fn check_points<S: Scalar>(points: impl IntoIterator<Item = Vec2<S>>) -> Result<(), Error> {
    let limit = S::from_fx(SIZE_MAX);
    for (number, point) in points.into_iter().enumerate() {
        if !point.is_within(limit) {
            let is_within = |part: S| part >= -limit && part <= limit;
            let part = if is_within(point.x) { point.y } else { point.x };
            return Err(refused(Dimension::Coordinate(number), part));
        }
    }
    Ok(())
}

/// Refuses two points, the ends of an edge, that are too near each other.
fn check_length<S: Scalar>([from, to]: [Vec2<S>; 2], dimension: Dimension) -> Result<(), Error> {
    let length = (to - from).wide_length();
    if length >= S::Factor::from_scalar(S::from_fx(SIZE_MIN)) {
        return Ok(());
    }
    Err(refused(dimension, length.to_scalar().unwrap_or(S::ZERO)))
}

impl Shape {
    /// A disc of this radius in m.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Size`].
    ///
    /// ```
    /// use umbra_physics::{Dimension, Error, Quantity, Shape, fx};
    /// let wheel = Shape::circle(fx!(0.5))?;
    /// let gate = Shape::rectangle(50, 1)?; // integers need no fx!
    /// let error = Shape::rectangle(1, fx!(0.00390625)).unwrap_err();
    /// let quantity = Quantity::Size { dimension: Dimension::Height, value: fx!(0.00390625) };
    /// assert_eq!(error, Error::OutOfRange { quantity });
    /// assert_eq!(error.to_string(), "out of range: expected a height from 2^-7 (0.0078125) to 2^12 m, not 0.00390625");
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[doc(alias("ball", "disc"))]
    pub fn circle(radius: impl IntoFx) -> Result<Self, Error> {
        Self::new(Geometry::Circle { radius: radius.into() })
    }

    /// A rectangle of this width (along x) and height in m.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Size`].
    #[doc(alias("cuboid", "box", "make_box"))]
    pub fn rectangle(width: impl IntoFx, height: impl IntoFx) -> Result<Self, Error> {
        Self::new(Geometry::Rectangle { width: width.into(), height: height.into() })
    }

    /// A capsule that lies along x: `length` in m between the centres of its round ends, `radius` in m.
    ///
    /// For an upright one set [`ColliderDef::angle`](crate::ColliderDef::angle) to [`Fx::FRAC_PI_2`](crate::Fx::FRAC_PI_2); for a
    /// [`Character`](crate::Character), which has no angle, make a [compound](Self::compound) of one [`Part`] with that angle.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Size`].
    pub fn capsule(length: impl IntoFx, radius: impl IntoFx) -> Result<Self, Error> {
        Self::new(Geometry::Capsule { length: length.into(), radius: radius.into() })
    }
}

impl<S: Scalar> Shape<S> {
    pub(super) fn of(geometry: Geometry<S>, shift: Vec2<S>, measure: S::Factor, gyration: S::Factor) -> Self {
        S::new_shape(geometry, shift, measure, gyration)
    }

    pub(crate) fn of_inner(geometry: Geometry<S>, shift: Vec2<S>, measure: S::Factor, gyration: S::Factor) -> Self {
        let outlines = outlines(&geometry);
        Self { geometry, shift, measure, gyration, outlines }
    }

    /// A shape of this geometry, re-centred at its centre of mass.
    ///
    /// The named constructors make the same shapes of `Fx`; this one makes those of floats too.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Size`] for a disc, a rectangle or a capsule, and as [`segment`](Self::segment),
    /// [`polygon`](Self::polygon), [`compound`](Self::compound) and [`chain`](Self::chain).
    ///
    /// ```
    /// use umbra_physics::{Geometry, Shape, fx};
    /// assert_eq!(Shape::new(Geometry::Circle { radius: fx!(0.5) }), Shape::circle(fx!(0.5)));
    /// ```
    pub fn new(geometry: Geometry<S>) -> Result<Self, Error> {
        let (measure, gyration) = match geometry {
            Geometry::Circle { radius } => {
                check_size(radius, Dimension::Radius)?;
                mass::circle(radius)
            }
            Geometry::Rectangle { width, height } => {
                check_size(width, Dimension::Width)?;
                check_size(height, Dimension::Height)?;
                mass::rectangle(width, height)
            }
            Geometry::Capsule { length, radius } => {
                check_size(length, Dimension::Length)?;
                check_size(radius, Dimension::Rounding)?;
                mass::capsule(length, radius)
            }
            Geometry::Polygon { corners } => return Self::polygon(&corners),
            Geometry::RoundedPolygon { corners, radius } => return Self::rounded_polygon(&corners, radius),
            Geometry::Segment { ends: [a, b] } => return Self::segment(a, b),
            Geometry::Compound { parts } => return Self::compound(&parts),
            Geometry::Chain { points, closed } => return Self::chain(&points, closed),
        };
        Ok(Self::of(geometry, Vec2::ZERO, measure, gyration))
    }

    /// A thin rod between two points. Its density is in kg/m.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Size`] for its length or a coordinate.
    pub fn segment(a: Vec2<S>, b: Vec2<S>) -> Result<Self, Error> {
        check_points([a, b])?;
        check_length([a, b], Dimension::Length)?;
        let even = [S::Factor::ONE, S::Factor::ONE];
        let middle = |p: S, q: S| S::weighted_mean(&even, &[p, q]).unwrap_or(S::ZERO);
        let shift = Vec2::new(middle(a.x, b.x), middle(a.y, b.y));
        let ends = [a - shift, b - shift];
        let (measure, gyration) = mass::segment::<S>((b - a).wide_length());
        Ok(Self::of(Geometry::Segment { ends }, shift, measure, gyration))
    }

    /// A chain of segments through these points, and from the last one back to the first if it is closed: a surface for static and
    /// kinematic bodies. It has no mass, and is not re-centred: its points are relative to where the collider is.
    ///
    /// Each segment touches only bodies on its *right*, seen from its first point to its second, and lets bodies from its left pass: it
    /// does not push an outline if the middle of the outline's corners is more than 2 cm behind it. So a ground runs from right to left, an
    /// island counter-clockwise, the wall of a room clockwise. (This is the convention of Box2D.) Where segments join, bodies slide and
    /// roll over the seam without a bump: no segment pushes in a direction that belongs to its neighbours.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, Error, Shape, World, WorldDef, fx, vec2};
    ///
    /// let ground = Shape::chain(&[vec2(20, 3), vec2(9, 0), vec2(-9, 0), vec2(-20, 3)], false)?;
    /// let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
    /// world.add_body(BodyDef::fixed().with_collider(ground.clone()))?;
    /// let ball = BodyDef::dynamic().with_collider(Shape::circle(fx!(0.5))?);
    /// let ball = world.add_body(BodyDef { position: vec2(0, 2), ..ball })?;
    /// (0..120).for_each(|_| _ = world.step());
    /// assert_eq!(format!("{:.2}", world.body(ball)?.position()), "(0.00, 0.50)");
    /// // It is a surface, not a body that moves.
    /// assert_eq!(world.add_body(BodyDef::dynamic().with_collider(ground)), Err(Error::DynamicChain));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Count`] for fewer than 2 points (3 of a closed chain) or more than
    /// [`limits::CHAIN`](crate::limits::CHAIN), with [`Quantity::Size`] for a coordinate out of range or two points, one after the
    /// other, less than 2^-7 m apart; [`Error::ChainCrosses`] if it crosses or touches itself.
    ///
    /// *Cost* n·log n.
    #[doc(alias("polyline", "heightfield"))]
    pub fn chain(points: &[Vec2<S>], closed: bool) -> Result<Self, Error> {
        S::chain(points, closed)
    }

    pub(crate) fn chain_inner(points: &[Vec2<S>], closed: bool) -> Result<Self, Error> {
        if !(2 + usize::from(closed)..=CHAIN).contains(&points.len()) {
            return Err(Error::OutOfRange { quantity: Quantity::Count });
        }
        check_points(points.iter().copied())?;
        let edges = if closed { points.len() } else { points.len() - 1 };
        for number in 0..edges {
            let ends = [points[number], points[(number + 1) % points.len()]];
            check_length(ends, Dimension::Edge(number))?;
        }
        if let Some(segments) = crossing(points, closed) {
            return Err(Error::ChainCrosses { segments });
        }
        let geometry = Geometry::Chain { points: points.into(), closed };
        Ok(Self::of(geometry, Vec2::ZERO, S::Factor::ZERO, S::Factor::ZERO))
    }

    /// A convex polygon with these corners in either order; re-centred at its centroid.
    ///
    /// Its area, centroid and inertia come from exact sums, so that neither the first corner nor the winding changes a bit.
    ///
    /// # Errors
    /// [`Error::NotConvex`] at the first corner that does not turn the way the others do, or repeats another;
    /// [`Error::OutOfRange`] with [`Quantity::Count`] or [`Quantity::Size`].
    #[doc(alias = "convex_polyline")]
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
        check_size(radius, Dimension::Rounding)?;
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
    /// [`Error::OutOfRange`] with [`Quantity::Count`] for no parts, too many, or a compound or a chain among them; with
    /// [`Quantity::Density`] or [`Quantity::Size`] for a part's.
    pub fn compound(parts: &[Part<S>]) -> Result<Self, Error> {
        S::compound(parts)
    }

    pub(crate) fn compound_inner(parts: &[Part<S>]) -> Result<Self, Error> {
        let is_nested = |p: &Part<S>| matches!(p.shape.geometry, Geometry::Compound { .. } | Geometry::Chain { .. });
        let nested = parts.iter().any(is_nested);
        if parts.is_empty() || parts.len() > PARTS || nested {
            return Err(Error::OutOfRange { quantity: Quantity::Count });
        }
        check_points(parts.iter().map(|part| part.position))?;
        for part in parts {
            if !part.angle.is_finite() {
                return Err(Error::OutOfRange { quantity: Quantity::Angle });
            }
            if !(part.density > S::ZERO && part.density.is_finite()) {
                return Err(Error::OutOfRange { quantity: Quantity::Density { value: part.density.to_fx() } });
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
    check_points(corners.iter().copied())?;
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
    let Aabb { min, max } = Aabb::around(corners, S::ZERO);
    let sides = max - min;
    let extent = if sides.x > sides.y { sides.x } else { sides.y };
    if extent >= S::from_fx(SIZE_MIN) { Ok(()) } else { Err(refused(Dimension::Extent, extent)) }
}
