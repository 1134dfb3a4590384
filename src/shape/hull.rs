//! Convex hulls of points.

use alloc::vec::Vec;
use core::cmp::Ordering;

use super::Shape;
use super::build::check_points;
use super::crossing::order;
use crate::error::{Error, Quantity};
use crate::fx::Fx;
use crate::limits::{CHAIN, CORNERS};
use crate::math::Vec2;
use crate::scalar::internals::Polygons as _;

impl Shape {
    /// The convex hull of some points: the [polygon](Self::polygon) with the least area that has all of them in it. Points within it, and on its
    /// edges between two corners, are no corners.
    ///
    /// The corners are those of the exact hull, whatever the order of the points and however often one is named: the polygon starts at
    /// the leftmost corner, the lower one of two. *Source* Andrew, Another efficient algorithm for convex hulls in two dimensions, 1979. *Cost*
    /// n·log n.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Count`] for more than [`limits::CHAIN`](crate::limits::CHAIN) points, or a hull of more than
    /// [`limits::CORNERS`](crate::limits::CORNERS) corners, or of fewer than three as all points are on one line; with [`Quantity::Size`] for a
    /// coordinate, or if the hull is too small for a shape.
    ///
    /// ```
    /// use umbra_physics::{Fx, Shape, fx, vec2};
    ///
    /// // A cloud of points: its hull is a square of 2 m.
    /// let cloud = [vec2(0, 0), vec2(1, 1), vec2(-1, 1), vec2(0, 1), vec2(1, -1), vec2(-1, -1), vec2(1, 1)];
    /// let hull: Shape = Shape::hull(&cloud)?;
    /// assert_eq!(hull, Shape::polygon(&[vec2(-1, -1), vec2(1, -1), vec2(1, 1), vec2(-1, 1)])?);
    /// // An ulp beyond its edge a point is a corner.
    /// let hull = Shape::hull(&[&cloud[..], &[vec2(0, fx!(1) + Fx::DELTA)]].concat())?;
    /// assert_eq!(hull.outlines()[0].corners().len(), 5);
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[doc(alias = "convex_hull")]
    pub fn hull(points: &[Vec2]) -> Result<Self, Error> {
        if points.len() > CHAIN {
            return Err(Error::OutOfRange { quantity: Quantity::Count });
        }
        check_points(points.iter().copied())?;
        let corners = hull(points);
        if !(3..=CORNERS).contains(&corners.len()) {
            return Err(Error::OutOfRange { quantity: Quantity::Count });
        }
        Self::polygon(&corners)
    }
}

/// The corners of the hull, counter-clockwise from the leftmost one, the lower one of two; fewer than three for points on one line.
fn hull(points: &[Vec2]) -> Vec<Vec2> {
    let mut sorted = points.to_vec();
    sorted.sort_unstable_by(|&a, &b| order(a, b));
    sorted.dedup();
    let mut corners: Vec<Vec2> = Vec::new();
    add_half(&mut corners, sorted.iter().copied());
    // The last corner of each half is the first one of the other half.
    corners.pop();
    let lower = corners.split_off(0);
    add_half(&mut corners, sorted.iter().rev().copied());
    corners.pop();
    [lower, corners].concat()
}

/// Adds sorted points to a chain that turns to the left at each of its points.
fn add_half(chain: &mut Vec<Vec2>, points: impl Iterator<Item = Vec2>) {
    for point in points {
        while let [.., a, b] = chain[..] {
            if Fx::orientation(a, b, point) == Ordering::Greater {
                break;
            }
            chain.pop();
        }
        chain.push(point);
    }
}
