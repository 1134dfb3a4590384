//! Segments of chains and polygons among others: the rules of [`collide`](crate::collide) in floats.

use super::cores::Core;
use super::number::{Float, Pair, cross, dot, minus, plus, times};
use crate::collide::seam::{Face, REACH};
use crate::collide::surface::{Link, Normal, Surface, is_reached};
use crate::fx::Fx;

/// A body whose middle is farther behind a segment than this is not pushed by it, m.
const BEHIND: f64 = 0.02;

/// The sine of the angle by which a direction may be off.
const SLACK: f64 = 1.0 / 1_048_576.0;

impl<F: Float> Normal for Pair<F> {
    /// In m.
    type Point = Self;

    fn opposite(self) -> Self {
        self.map(|part| -part)
    }

    fn across(self) -> Self {
        [-self[1], self[0]]
    }

    fn is_between(self, [from, to]: [Self; 2]) -> bool {
        let slack = F::of(SLACK).or_more(F::of(16.0) * F::EPSILON);
        cross(from, self) >= -slack && cross(self, to) >= -slack && dot(self, plus(from, to)) > F::of(0.0)
    }
}

impl<F: Float> Surface<'_, Pair<F>> {
    /// Returns true if a core is where the surface does not push: with its middle behind a segment of a chain or outside of a polygon whose
    /// edges others cover, or beyond an edge that is covered.
    pub(super) fn is_passed(&self, own: &Core<'_, F>, other: &Core<'_, F>, offset: Pair<F>) -> bool {
        let zero = (F::of(0.0), [F::of(0.0); 2]);
        let (count, sum) = other.corners.iter().fold(zero, |(n, sum), corner| (n + F::of(1.0), plus(sum, *corner)));
        let mean = plus(times(sum, F::of(1.0) / count), offset);
        let mut heights = own.normals.iter().zip(own.corners).map(|(&n, &corner)| dot(n, minus(mean, corner)));
        match self.is_one_sided {
            true => heights.next().is_some_and(|height| height < -F::of(BEHIND)),
            false if self.links.is_empty() => heights.any(|height| height >= F::of(0.0)),
            // A core beyond an edge that is covered is at the neighbour's.
            false => {
                let reach = F::from_fx(Fx::from_bits(REACH));
                let is_covered = |i: &usize| self.links.iter().all(|link| link.corners[0] != *i);
                let mut covered = (0..own.normals.len()).filter(is_covered);
                covered.any(|i| own.separation(i, other, offset) > reach)
            }
        }
    }
}

/// Returns true if a core reaches over the part of an edge that is on the surface, or beyond an end of it.
pub(super) fn reaches<F: Float>(link: &Link<Pair<F>>, end: Option<usize>, core: &Core<'_, F>, offset: Pair<F>) -> bool {
    let Some(part) = link.part else { return true };
    let place = |p: Pair<F>| dot([-link.normal[1], link.normal[0]], p);
    let [low, high] = part.map(place);
    let places = || core.corners.iter().map(|&corner| place(plus(corner, offset)));
    let slop = F::from_fx(Fx::from_bits(REACH));
    let (Some(least), Some(most)) = (places().reduce(F::or_less), places().reduce(F::or_more)) else { return false };
    is_reached([least, most + slop], [low, high + slop], end)
}

/// The link of an edge on the surface of a polygon among others.
pub(super) fn link_of<F: Float>(face: &Face, normals: &[Pair<F>]) -> Link<Pair<F>> {
    let unit = |n: [i32; 2]| n.map(|part| F::of(f64::from(part) / f64::from(1 << 30)));
    let metres = |end: [i64; 2]| end.map(|part| F::from_fx(Fx::from_bits(part)));
    let corners = [face.edge, (face.edge + 1) % normals.len()];
    let ends = face.ends.map(|neighbour| neighbour.map(unit));
    Link::new(corners, normals[face.edge], ends, face.part.map(|part| part.map(metres)))
}
