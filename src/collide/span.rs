//! The parts of two cores that face each other, and the corners of their points.

use core::cmp::Ordering;

use super::feature;

/// An edge, or a corner as an edge of no length, in order of place.
#[derive(Clone, Copy)]
pub(super) struct Span<T> {
    pub(super) corners: [usize; 2],
    pub(super) places: [T; 2],
}

impl<T: Copy + PartialOrd> Span<T> {
    #[inline(always)]
    pub(super) fn is_corner(&self) -> bool {
        self.corners[0] == self.corners[1]
    }

    pub(super) fn in_order(self) -> Self {
        let ([i, j], [from, to]) = (self.corners, self.places);
        if from <= to { self } else { Self { corners: [j, i], places: [to, from] } }
    }
}

/// The parts of two cores that face each other.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Facing {
    /// The edges overlap.
    Edges,
    /// These corners, of A and of B, are nearest, and the cores are apart.
    Corners(usize, usize),
    /// The edges lie beside each other, the cores overlap: the corners next to each other.
    Beside(usize, usize),
    /// Sharp corners touch, or nearly: nothing rests on a point that is no wider than that.
    Touching,
}

/// The corner that a point is at.
#[derive(Clone, Copy)]
pub(super) enum At {
    A(usize),
    B(usize),
    /// A corner of each core, at the same place.
    Both(usize, usize),
}

/// The corner at an end of the overlap of two edges, and the name of the point there. `ahead` says which of the two edges ends first.
#[inline(always)]
pub(super) fn end_of_overlap<T: Copy + PartialOrd>(a: &Span<T>, b: &Span<T>, end: usize, ahead: Ordering) -> (At, u32) {
    let (i, j) = (a.corners[end], b.corners[end]);
    // The end of the overlap is the inner one of the two ends; a corner over an edge counts as inner at both ends.
    let (is_corner_of_a, is_corner_of_b) = (a.is_corner(), b.is_corner());
    let at = match (is_corner_of_a, is_corner_of_b) {
        (true, false) => At::A(i),
        (false, true) => At::B(j),
        _ => match ahead {
            Ordering::Equal => At::Both(i, j),
            Ordering::Greater => At::A(i),
            Ordering::Less => At::B(j),
        },
    };
    let name = match (is_corner_of_a, is_corner_of_b) {
        (false, true) => feature(a.corners, [j, j]),
        (true, false) => feature([i, i], [b.corners[1], b.corners[0]]),
        _ => feature([i, i], [j, j]),
    };
    (at, name)
}
