//! Segments of chains: the rules of [`collide`](crate::collide) in floats.

use super::cores::Core;
use super::number::{Float, Pair, cross, dot, minus, plus, times};
use crate::collide::span::At;
use crate::shape::Neighbour;

/// What has its middle farther behind a segment is not pushed, m.
const BEHIND: f64 = 0.02;

/// The sine of the angle by which a direction may be off.
const SLACK: f64 = 1.0 / 1_048_576.0;

/// The directions in which a segment of a chain pushes, in world axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link<F> {
    normal: Pair<F>,
    /// At either corner the directions from one to another, counter-clockwise.
    cones: [[Pair<F>; 2]; 2],
    /// The normals of neighbours at outward corners.
    pub(super) outer: [Option<Pair<F>>; 2],
    /// The chain goes on straight at this corner.
    is_straight: [bool; 2],
}

/// Returns true for a direction between two others, counter-clockwise, less than half a turn apart.
fn is_between<F: Float>([from, to]: [Pair<F>; 2], n: Pair<F>) -> bool {
    let slack = F::of(SLACK).or_more(F::of(16.0) * F::EPSILON);
    cross(from, n) >= -slack && cross(n, to) >= -slack && dot(n, plus(from, to)) > F::of(0.0)
}

impl<F: Float> Link<F> {
    pub(super) fn new(normal: Pair<F>, [before, after]: [Neighbour<Pair<F>>; 2]) -> Self {
        let along = [-normal[1], normal[0]];
        let is_straight = [before, after].map(|neighbour| match neighbour {
            Neighbour::Inner(other) | Neighbour::Outer(other) => is_between([normal; 2], other),
            Neighbour::None => false,
        });
        let outer = [0, 1].map(|end| match [before, after][end] {
            Neighbour::Outer(other) if !is_straight[end] => Some(other),
            _ => None,
        });
        let reach = |end: usize, neighbour, far| match neighbour {
            Neighbour::None => far,
            _ => outer[end].unwrap_or(normal),
        };
        let (first, last) = (reach(0, before, along.map(|part| -part)), reach(1, after, along));
        Self { normal, cones: [[first, normal], [normal, last]], outer, is_straight }
    }

    /// Returns true if the segment may push in a direction.
    pub(super) fn has(&self, n: Pair<F>) -> bool {
        self.cones.iter().any(|&cone| is_between(cone, n))
    }

    /// Returns true for a point where an edge of the other core lies over a corner at which the chain goes on straight.
    pub(super) fn is_seam(&self, at: At) -> bool {
        matches!(at, At::A(corner) if self.is_straight[corner & 1])
    }

    /// Returns true if the mean of a core's corners is behind the segment.
    pub(super) fn is_before(&self, own: &Core<'_, F>, other: &Core<'_, F>, offset: Pair<F>) -> bool {
        let zero = (F::of(0.0), [F::of(0.0); 2]);
        let (count, sum) = other.corners.iter().fold(zero, |(n, sum), corner| (n + F::of(1.0), plus(sum, *corner)));
        let mean = plus(times(sum, F::of(1.0) / count), minus(offset, own.corners[0]));
        dot(self.normal, mean) < -F::of(BEHIND)
    }
}
