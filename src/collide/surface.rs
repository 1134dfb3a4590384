//! The directions in which a segment of a chain pushes, or a polygon among others, by the rules that integers and floats share.

use core::fmt::Debug;

use super::span::At;
use crate::shape::Neighbour;

/// A unit vector.
pub(crate) trait Normal: Copy {
    /// A point, in the scalar's coordinates.
    type Point: Copy + Debug;
    /// The opposite direction.
    fn opposite(self) -> Self;
    /// The vector turned by a quarter counter-clockwise.
    fn across(self) -> Self;
    /// Returns true for a direction between two others, counter-clockwise, less than half a turn apart, within rounding.
    fn is_between(self, cone: [Self; 2]) -> bool;
}

/// An edge on a surface, and the directions in which it pushes, in world axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Link<V: Normal> {
    /// The corners at its ends, by number.
    pub(crate) corners: [usize; 2],
    pub(crate) normal: V,
    /// At its first and at its second corner the directions from one to another, counter-clockwise.
    cones: [[V; 2]; 2],
    /// The normals of neighbours at outward corners.
    pub(crate) outer: [Option<V>; 2],
    /// The surface goes on straight at this corner.
    is_straight: [bool; 2],
    /// The surface goes on along the same polygon at this corner.
    is_own: [bool; 2],
    /// The ends of the part of the edge that is on the surface, if that is not all of it.
    pub(crate) part: Option<[V::Point; 2]>,
}

impl<V: Normal> Link<V> {
    pub(crate) fn new(
        corners: [usize; 2],
        normal: V,
        [before, after]: [Neighbour<V>; 2],
        part: Option<[V::Point; 2]>,
    ) -> Self {
        let along = normal.across();
        let is_straight = [before, after].map(|neighbour| match neighbour {
            Neighbour::Inner(other) | Neighbour::Outer(other) => other.is_between([normal; 2]),
            _ => false,
        });
        let outer = [0, 1].map(|end| match [before, after][end] {
            Neighbour::Outer(other) if !is_straight[end] => Some(other),
            _ => None,
        });
        let reach = |end: usize, neighbour, far| match neighbour {
            Neighbour::None => far,
            Neighbour::Own(next) => next,
            _ => outer[end].unwrap_or(normal),
        };
        let cones = [[reach(0, before, along.opposite()), normal], [normal, reach(1, after, along)]];
        let is_own = [before, after].map(|neighbour| matches!(neighbour, Neighbour::Own(_)));
        Self { corners, normal, cones, outer, is_straight, is_own, part }
    }

    /// Returns true if the edge may push in a direction.
    pub(crate) fn has(&self, n: V) -> bool {
        self.cones.iter().any(|&cone| n.is_between(cone))
    }

    fn has_at(&self, corner: usize, at_end: [bool; 2]) -> bool {
        (0..2).any(|end| self.corners[end] == corner && at_end[end])
    }
}

/// The surface of an outline: the segment of a chain, or the edges of a polygon that others do not cover.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surface<'a, V: Normal> {
    pub(crate) links: &'a [Link<V>],
    /// True for a segment of a chain, which bodies pass from behind.
    pub(crate) is_one_sided: bool,
}

impl<V: Normal> Surface<'_, V> {
    /// Returns true if the surface may push in a direction.
    pub(crate) fn has(&self, n: V) -> bool {
        self.links.iter().any(|link| link.has(n))
    }

    /// The normals of neighbours at outward corners.
    pub(crate) fn outer(&self) -> impl Iterator<Item = V> + '_ {
        self.links.iter().flat_map(|link| link.outer).flatten()
    }

    /// Returns true for a point where an edge of the other core lies over a corner at which the surface goes on straight.
    pub(crate) fn is_seam(&self, at: At) -> bool {
        matches!(at, At::A(corner) if self.links.iter().any(|link| link.has_at(corner, link.is_straight)))
    }

    /// Returns true for a corner at which the surface goes on along the same polygon.
    pub(crate) fn is_own(&self, corner: usize) -> bool {
        self.links.iter().any(|link| link.has_at(corner, link.is_own))
    }

    /// Returns true for a corner, or for an edge between two, that is on the surface.
    pub(crate) fn has_edge(&self, corners: [usize; 2]) -> bool {
        self.is_one_sided || corners[0] == corners[1] || self.links.iter().any(|link| link.corners == corners)
    }
}
