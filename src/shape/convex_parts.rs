//! Simple polygons in convex parts.
//!
//! The polygon is cut into triangles, an ear at a time, the one with the shortest cut first: that avoids long thin ones. Then cuts are taken
//! back, the longest first, wherever the two parts beside a cut are convex together. A cut that is left is needed for a reflex corner at one of its
//! ends, and each of these needs two at most: with r reflex corners there are at most 2·r + 1 parts, and at most four times as many as in the best
//! solution. Parts with more corners than a polygon may have are halved.
//!
//! All corners of parts are corners of the polygon, and all choices are by exact predicates, from the leftmost corner on: the parts cover the polygon
//! to the bit, without gaps or overlaps, whatever its first corner and its winding.
//!
//! *Source* Meisters, Polygons have ears, 1975; Hertel and Mehlhorn, Fast triangulation of simple polygons, 1983.

use alloc::vec::Vec;
use core::cmp::Ordering;

use super::build::check_points;
use super::crossing::{crossing, order};
use super::{Part, Shape};
use crate::error::{Error, Quantity};
use crate::fx::Fx;
use crate::limits::{CONCAVE_CORNERS, CORNERS};
use crate::math::Vec2;
use crate::scalar::FxWide;
use crate::scalar::internals::Polygons as _;

impl Shape {
    /// A polygon that may be concave, with these corners in either order: a [compound](Self::compound) of convex polygons, or one polygon if it is
    /// convex. The compound is re-centred at its centre of mass, and has the same density all over.
    ///
    /// Corners of the parts are corners of the polygon, so that the parts cover it exactly, and bodies roll over the [seams between
    /// them](crate::guide::collisions) as over one piece, as long as a part and its neighbours have up to 256 corners in all. Neither the first corner nor the winding changes a bit, nor do corners within a straight
    /// side. With r corners that turn inwards there are at most 2·r + 1 parts of at most [`limits::CORNERS`](crate::limits::CORNERS) corners each,
    /// and more only where a part with more corners is halved. It has no holes: put several polygons around one.
    ///
    /// *Cost* n².
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Count`] for fewer than 3 corners or more than
    /// [`limits::CONCAVE_CORNERS`](crate::limits::CONCAVE_CORNERS), or if it takes more than [`limits::PARTS`](crate::limits::PARTS) parts, and with
    /// [`Quantity::Size`] for a coordinate or a part that is too small for a shape; [`Error::ChainCrosses`] if its sides cross or touch each other.
    ///
    /// ```
    /// use umbra_physics::{Shape, fx, vec2};
    ///
    /// // An L of three squares: two parts.
    /// let l = [vec2(0, 0), vec2(2, 0), vec2(2, 1), vec2(1, 1), vec2(1, 2), vec2(0, 2)];
    /// let shape = Shape::concave_polygon(&l)?;
    /// assert_eq!((shape.outlines().len(), shape.measure().to_scalar()), (2, Some(fx!(3))));
    /// // In the coordinates of the corners the centre of mass is at (5/6, 5/6).
    /// assert_eq!(format!("{:.4}", shape.shift()), "(0.8333, 0.8333)");
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[doc(alias = "convex_decomposition")]
    #[doc(alias = "decompose")]
    pub fn concave_polygon(polygon: &[Vec2]) -> Result<Self, Error> {
        if !(3..=CONCAVE_CORNERS).contains(&polygon.len()) {
            return Err(Error::OutOfRange { quantity: Quantity::Count });
        }
        check_points(polygon.iter().copied())?;
        if let Some(segments) = crossing(polygon, true) {
            return Err(Error::ChainCrosses { segments });
        }
        let parts = convex_parts(polygon);
        if let [corners] = &parts[..] {
            return Self::polygon(corners);
        }
        let part = |corners: &Vec<Vec2>| {
            let shape = Self::polygon(corners)?;
            Ok(Part { position: shape.shift(), angle: Fx::ZERO, density: Fx::ONE, shape })
        };
        Self::compound(&parts.iter().map(part).collect::<Result<Vec<_>, Error>>()?)
    }
}

/// The corners of the convex parts of a simple polygon, each counter-clockwise.
fn convex_parts(polygon: &[Vec2]) -> Vec<Vec<Vec2>> {
    let corners = normal_form(polygon);
    let mut parts = Parts { triangles: Vec::new(), cuts: Vec::new() };
    parts.cut_ears(&corners);
    let mut pieces = parts.merge(&corners);
    for piece in &mut pieces {
        let first = (0..piece.len()).min_by_key(|&i| piece[i]).unwrap_or(0);
        piece.rotate_left(first);
    }
    pieces.sort_unstable();
    pieces.iter().flat_map(|piece| halves(strict_corners(&corners, piece))).collect()
}

/// The corners of a simple polygon, counter-clockwise, from the leftmost one on, the lower one of two, without corners within a straight side.
fn normal_form(polygon: &[Vec2]) -> Vec<Vec2> {
    let all: Vec<usize> = (0..polygon.len()).collect();
    let mut corners = strict_corners(polygon, &all);
    let first = (0..corners.len()).min_by(|&i, &j| order(corners[i], corners[j])).unwrap_or(0);
    corners.rotate_left(first);
    // The leftmost corner is convex.
    if Fx::orientation(corners[corners.len() - 1], corners[0], corners[1]) == Ordering::Less {
        corners[1..].reverse();
    }
    corners
}

/// The corners of a polygon that are not within a straight side, for the numbers of all of its corners.
fn strict_corners(corners: &[Vec2], piece: &[usize]) -> Vec<Vec2> {
    let count = piece.len();
    let is_strict = |&i: &usize| turn(corners, piece, i) != Ordering::Equal;
    (0..count).filter(is_strict).map(|i| corners[piece[i]]).collect()
}

/// The way a polygon turns at a corner; `Greater` for a convex corner of one that is counter-clockwise.
fn turn(corners: &[Vec2], piece: &[usize], i: usize) -> Ordering {
    let count = piece.len();
    let corner = |i: usize| corners[piece[i % count]];
    Fx::orientation(corner(i + count - 1), corner(i), corner(i + 1))
}

/// The triangles of a polygon, by the numbers of their corners, and the cuts between them.
struct Parts {
    triangles: Vec<[usize; 3]>,
    cuts: Vec<[usize; 2]>,
}

impl Parts {
    /// Cuts a polygon into triangles.
    fn cut_ears(&mut self, corners: &[Vec2]) {
        let mut rest: Vec<usize> = (0..corners.len()).collect();
        let mut cut_squares: Vec<Option<FxWide>> = (0..rest.len()).map(|i| cut_square(corners, &rest, i)).collect();
        while rest.len() > 3 {
            let ears = (0..rest.len()).filter_map(|i| Some((i, cut_squares[i]?)));
            // Of cuts of one length the first one.
            let shortest = ears.reduce(|least, ear| if ear.1 < least.1 { ear } else { least });
            // A polygon has two ears at least.
            let Some((ear, _)) = shortest else { return };
            let count = rest.len();
            let (before, after) = (rest[(ear + count - 1) % count], rest[(ear + 1) % count]);
            self.triangles.push([before, rest[ear], after]);
            self.cuts.push([before, after]);
            rest.remove(ear);
            cut_squares.remove(ear);
            // The ears at the ends of the cut have changed.
            for i in [(ear + rest.len() - 1) % rest.len(), ear % rest.len()] {
                cut_squares[i] = cut_square(corners, &rest, i);
            }
        }
        if let [a, b, c] = rest[..] {
            self.triangles.push([a, b, c]);
        }
    }

    /// Takes cuts back wherever both parts beside a cut are convex together, the longest one first.
    fn merge(self, corners: &[Vec2]) -> Vec<Vec<usize>> {
        let mut pieces: Vec<Vec<usize>> = self.triangles.iter().map(|triangle| triangle.to_vec()).collect();
        let square = |&[a, b]: &[usize; 2]| square(corners[b] - corners[a]);
        let mut cuts = self.cuts;
        cuts.sort_by_key(|cut| core::cmp::Reverse(square(cut)));
        for [a, b] in cuts {
            let beside = |from: usize, to: usize| {
                let place = |piece: &Vec<usize>| {
                    (0..piece.len()).find(|&i| piece[i] == from && piece[(i + 1) % piece.len()] == to)
                };
                pieces.iter().enumerate().find_map(|(number, piece)| Some((number, place(piece)?)))
            };
            let (Some((left, i)), Some((right, j))) = (beside(a, b), beside(b, a)) else { continue };
            // From b round to a on the one side, and from there back on the other one.
            let mut merged = from_corner(&pieces[left], i + 1);
            let joint = merged.len() - 1;
            let second = from_corner(&pieces[right], j + 1);
            merged.extend(&second[1..second.len() - 1]);
            let is_convex =
                turn(corners, &merged, 0) != Ordering::Less && turn(corners, &merged, joint) != Ordering::Less;
            if is_convex {
                pieces[left] = merged;
                pieces.swap_remove(right);
            }
        }
        pieces
    }
}

/// A convex polygon, halved until no part has more corners than a polygon may have.
fn halves(corners: Vec<Vec2>) -> Vec<Vec<Vec2>> {
    if corners.len() <= CORNERS {
        return alloc::vec![corners];
    }
    let middle = corners.len() / 2;
    let second = [&corners[middle..], &corners[..1]].concat();
    [halves(corners[..=middle].to_vec()), halves(second)].concat()
}

/// The corners of a polygon from one of them on.
fn from_corner(piece: &[usize], i: usize) -> Vec<usize> {
    let (before, after) = piece.split_at(i % piece.len());
    [after, before].concat()
}

/// The square of the length of the cut behind a corner of what is left of a polygon, if the corner is an ear: convex, and no other corner is in the triangle with
/// its neighbours or on it.
fn cut_square(corners: &[Vec2], rest: &[usize], i: usize) -> Option<FxWide> {
    if turn(corners, rest, i) != Ordering::Greater {
        return None;
    }
    let count = rest.len();
    let [a, b, c] = [(i + count - 1) % count, i, (i + 1) % count];
    let triangle = [a, b, c].map(|k| corners[rest[k]]);
    let is_in =
        |point: Vec2| (0..3).all(|k| Fx::orientation(triangle[k], triangle[(k + 1) % 3], point) != Ordering::Less);
    let is_clear = (0..count).all(|k| [a, b, c].contains(&k) || !is_in(corners[rest[k]]));
    if is_clear { square(triangle[2] - triangle[0]) } else { None }
}

/// The square of a length, exactly: it fits within the sizes of shapes.
fn square(v: Vec2) -> Option<FxWide> {
    v.wide_dot(v)
}
