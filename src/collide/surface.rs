//! The directions in which a segment of a chain pushes, or a polygon among others.

use super::cores::across;
use super::span::At;
use crate::shape::Neighbour;

/// A unit vector in units of 2^-30: products are below 2^61.1, their sums below 2^62.1.
type Unit = [i32; 2];

/// The sine of the angle by which a direction may be off, in units of 2^-60: 2^-20. Normals err by 2^-30, directions between corners
/// by 1.5 ulp over their distance, which is 2^-7 m at least where it counts.
pub(super) const SLACK: i64 = 1 << 40;

/// The sine of the angle by which a direction may be off for flat sides of two surfaces that lean on each other, in units of 2^-60: 2^-4.
pub(super) const LEAN: i64 = 1 << 56;

/// Returns true for a direction between two others, counter-clockwise, less than half a turn apart, within the sine of an angle in units of
/// 2^-60.
fn is_between(n: Unit, [from, to]: [Unit; 2], slack: i64) -> bool {
    let cross = |a: Unit, b: Unit| i64::from(a[0]) * i64::from(b[1]) - i64::from(a[1]) * i64::from(b[0]);
    let dot = |a: Unit, b: Unit| i64::from(a[0]) * i64::from(b[0]) + i64::from(a[1]) * i64::from(b[1]);
    cross(from, n) >= -slack && cross(n, to) >= -slack && i128::from(dot(n, from)) + i128::from(dot(n, to)) > 0
}

/// An edge on a surface, and the directions in which it pushes, in world axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    /// The corners at its ends, by number.
    pub(super) corners: [usize; 2],
    pub(super) normal: Unit,
    /// At its first and at its second corner the directions from one to another, counter-clockwise.
    cones: [[Unit; 2]; 2],
    /// The normals of neighbours at outward corners.
    pub(super) outer: [Option<Unit>; 2],
    /// The surface goes on straight at this corner.
    is_straight: [bool; 2],
    /// The surface goes on along the same polygon at this corner.
    is_own: [bool; 2],
    /// Another polygon covers the edge at this corner.
    is_covered: [bool; 2],
    /// The surface ends at this corner.
    is_free: [bool; 2],
    /// The ends of the part of the edge that is on the surface, if that is not all of it, ulps.
    pub(super) part: Option<[[i64; 2]; 2]>,
}

impl Link {
    pub(super) fn new(
        corners: [usize; 2],
        normal: Unit,
        [before, after]: [Neighbour<Unit>; 2],
        part: Option<[[i64; 2]; 2]>,
    ) -> Self {
        let along = across(normal);
        let is_straight = [before, after].map(|neighbour| match neighbour {
            Neighbour::Inner(next) | Neighbour::Outer(next) => is_between(next, [normal; 2], SLACK),
            _ => false,
        });
        let outer = [0, 1].map(|end| match [before, after][end] {
            Neighbour::Outer(next) if !is_straight[end] => Some(next),
            _ => None,
        });
        let reach = |end: usize, neighbour, far| match neighbour {
            Neighbour::None => far,
            Neighbour::Own(next) => next,
            _ => outer[end].unwrap_or(normal),
        };
        let cones = [[reach(0, before, along.map(|part| -part)), normal], [normal, reach(1, after, along)]];
        let is_own = [before, after].map(|neighbour| matches!(neighbour, Neighbour::Own(_)));
        let is_covered = [before, after].map(|neighbour| matches!(neighbour, Neighbour::Covered));
        let is_free = [before, after].map(|neighbour| matches!(neighbour, Neighbour::None));
        Self { corners, normal, cones, outer, is_straight, is_own, is_covered, is_free, part }
    }

    /// Returns true for a direction that leads backwards beyond a free end.
    fn is_beyond(&self, end: usize, n: Unit) -> bool {
        let back = self.normal.map(|part| -part);
        let [far, outward] = [self.cones[0][0], self.cones[1][1]];
        let between = if end == 0 { [back, far] } else { [outward, back] };
        self.is_free[end] && is_between(n, between, SLACK)
    }

    fn is_at(&self, corner: usize, at_end: [bool; 2]) -> bool {
        (0..2).any(|end| self.corners[end] == corner && at_end[end])
    }
}

/// The surface of an outline: the segment of a chain, or the edges of a polygon that others do not cover.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surface<'a> {
    pub(super) links: &'a [Link],
    /// True for a segment of a chain, which bodies pass from behind.
    pub(super) is_one_sided: bool,
    /// True if a corner of the other core is beyond an end of the segment and one is far behind the segment, and its middle is not: it may
    /// cross the line of the segment beyond the end.
    pub(super) is_across: bool,
}

impl Surface<'_> {
    /// Returns true if the surface may push in a direction, a normal of the other core, within this slack.
    ///
    /// `reaches` says of an edge if the other core is over the part of it that is on the surface, or, where an end is given, beyond that
    /// end. At a corner of one polygon both edges have to be near in that way: the other core may be beside one of them where that is
    /// covered.
    pub(super) fn has(&self, n: Unit, slack: i64, reaches: impl Fn(&Link, Option<usize>) -> bool) -> bool {
        let is_at_end = |link: &Link, end: usize| {
            let mut beside = self.links.iter().filter(|adjacent| adjacent.corners[1 - end] == link.corners[end]);
            let is_between = is_between(n, link.cones[end], slack) || self.is_across && link.is_beyond(end, n);
            is_between && (!link.is_own[end] || beside.all(|adjacent| reaches(adjacent, Some(1 - end))))
        };
        self.links.iter().any(|link| (0..2).any(|end| is_at_end(link, end)) && reaches(link, None))
    }

    /// Returns true if the surface may push in a direction at a corner.
    fn has_at(&self, corner: usize, n: Unit) -> bool {
        let is_at_end = |link: &Link, end: usize| {
            let is_between = is_between(n, link.cones[end], SLACK) || self.is_across && link.is_beyond(end, n);
            link.corners[end] == corner && !link.is_covered[end] && is_between
        };
        self.links.iter().any(|link| (0..2).any(|end| is_at_end(link, end)))
    }

    /// The normals of neighbours at outward corners.
    pub(super) fn outer(&self) -> impl Iterator<Item = Unit> + '_ {
        self.links.iter().flat_map(|link| link.outer).flatten()
    }

    /// Returns true for a corner at which the surface goes on straight.
    fn is_seam(&self, corner: usize) -> bool {
        self.links.iter().any(|link| link.is_at(corner, link.is_straight))
    }

    /// The number of ends at which the surface goes on straight from an edge, by the edge's first corner.
    pub(super) fn straight_ends(&self, edge: usize) -> usize {
        let link = self.links.iter().find(|link| link.corners[0] == edge);
        link.map_or(0, |link| link.is_straight.into_iter().filter(|is_straight| *is_straight).count())
    }

    /// Returns true for a corner at which the surface goes on along the same polygon.
    fn is_own(&self, corner: usize) -> bool {
        self.links.iter().any(|link| link.is_at(corner, link.is_own))
    }

    /// Returns true for a corner, or for an edge between two, that is on the surface where the other core is: see [`has`](Self::has).
    pub(super) fn has_edge(&self, corners: [usize; 2], reaches: impl Fn(&Link, Option<usize>) -> bool) -> bool {
        let is_there = |link: &Link| link.corners == corners && reaches(link, None);
        self.is_one_sided || corners[0] == corners[1] || self.links.iter().any(is_there)
    }
}

/// The surfaces of the two cores of a pair; `None` for a core without one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surfaces<'a> {
    pub(super) a: Option<Surface<'a>>,
    pub(super) b: Option<Surface<'a>>,
}

impl Surfaces<'_> {
    /// Returns true for a point where an edge of a core lies over a corner at which the surface of the other one goes on straight, or where
    /// both surfaces do.
    pub(super) fn is_seam(&self, at: At) -> bool {
        let is_seam = |surface: &Option<Surface<'_>>, corner| surface.is_some_and(|surface| surface.is_seam(corner));
        match at {
            At::A(i) => is_seam(&self.a, i),
            At::B(j) => is_seam(&self.b, j),
            At::Both(i, j) => is_seam(&self.a, i) && is_seam(&self.b, j),
        }
    }

    /// Returns true if at a corner of A and at one of B no surface goes on along another polygon.
    pub(super) fn are_own(&self, i: usize, j: usize) -> bool {
        self.a.is_none_or(|surface| surface.is_own(i)) && self.b.is_none_or(|surface| surface.is_own(j))
    }

    /// Returns true if the surfaces may push in a direction from A to B at a corner of A and one of B.
    pub(super) fn have_at(&self, i: usize, j: usize, n: Unit) -> bool {
        self.a.is_none_or(|surface| surface.has_at(i, n))
            && self.b.is_none_or(|surface| surface.has_at(j, n.map(|part| -part)))
    }
}

/// Returns true if places that a core has along an edge, from `first` to `last`, reach the part from `low` to `high` of it, or, where an
/// end of the edge is given, the line beyond that part in its direction.
pub(super) fn is_reached<T: PartialOrd>([first, last]: [T; 2], [low, high]: [T; 2], end: Option<usize>) -> bool {
    (end == Some(1) || first <= high) && (end == Some(0) || low <= last)
}
