//! Outlines in world axes.

use alloc::vec::Vec;
use core::ops::Range;

use super::link::link_of;
use super::number::{Float, Pair, dot, minus, plus};
use crate::collide::seam::Face;
use crate::collide::surface::{Link, Surface};
use crate::fx::Fx;
use crate::math::Vec2;
use crate::shape::{Aabb, Outline};

/// The place of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
#[doc(hidden)]
pub struct Pose<F> {
    pub(super) position: Pair<F>,
    /// Sine and cosine of its angle.
    direction: Pair<F>,
}

impl<F: Float> Pose<F> {
    pub(super) fn new(position: Vec2<F>, angle: F) -> Self {
        Self { position: [position.x, position.y], direction: angle.direction() }
    }

    pub(super) fn turned(&self, v: Vec2<F>) -> Pair<F> {
        let [sin, cos] = self.direction;
        [v.x * cos - v.y * sin, v.x * sin + v.y * cos]
    }

    /// The corners of an outline at this pose, relative to another pose's position, ulps.
    pub(super) fn corners<'a>(
        &self,
        outline: &'a Outline<F>,
        from: &Self,
    ) -> impl Iterator<Item = [i64; 2]> + use<'a, F> {
        let (pose, offset) = (*self, minus(self.position, from.position));
        // A cast from a float saturates; it rounds towards zero.
        let ulps = |metres: F| (metres.to_f64() * ULPS) as i64;
        outline.corners().iter().map(move |&corner| plus(pose.turned(corner), offset).map(ulps))
    }

    /// The box around an outline at this pose, grown by `more` and rounded outwards.
    pub(super) fn bounds(&self, outline: &Outline<F>, more: F) -> Aabb<Fx> {
        let more = outline.radius().to_f64() + more.to_f64();
        let mut ends = [(f64::INFINITY, f64::NEG_INFINITY); 2];
        for corner in outline.corners().iter().map(|&corner| self.turned(corner)) {
            for ((low, high), at) in ends.iter_mut().zip(corner) {
                (*low, *high) = (low.min(at.to_f64()), high.max(at.to_f64()));
            }
        }
        // A cast from a float saturates; it rounds towards zero.
        let ulps = |metres: f64| (metres * ULPS) as i64;
        let end = |i: usize| {
            let ((low, high), at) = (ends[i], self.position[i].to_f64());
            (ulps(at + low - more).saturating_sub(1), ulps(at + high + more).saturating_add(1))
        };
        let [x, y] = [end(0), end(1)].map(|(low, high)| (Fx::from_bits(low), Fx::from_bits(high)));
        Aabb { min: Vec2::new(x.0, y.0), max: Vec2::new(x.1, y.1) }
    }
}

/// An outline in world axes, without its corners.
#[derive(Clone, Debug)]
struct Placed<F> {
    position: Pair<F>,
    corners: Range<usize>,
    /// The least box around the corners, relative to the position.
    low: Pair<F>,
    high: Pair<F>,
    radius: F,
}

/// Outlines in world axes, each turned once for all its pairs.
#[derive(Debug, Default)]
pub(super) struct Cores<F: Float> {
    corners: Vec<Pair<F>>,
    /// Of the edges from each corner to the next one; zeros for discs.
    normals: Vec<Pair<F>>,
    placed: Vec<Placed<F>>,
    /// Segments of chains and polygons among others, by number: true for a segment, and the last of its links.
    surfaces: Vec<(usize, bool, usize)>,
    links: Vec<Link<Pair<F>>>,
}

/// An outline in world axes, relative to the position of its body.
#[derive(Clone, Copy)]
pub(super) struct Core<'a, F: Float> {
    pub(super) position: Pair<F>,
    pub(super) corners: &'a [Pair<F>],
    /// Empty for a disc.
    pub(super) normals: &'a [Pair<F>],
    low: Pair<F>,
    high: Pair<F>,
    pub(super) radius: F,
    /// Of a segment of a chain, and of a polygon among others.
    pub(super) surface: Option<Surface<'a, Pair<F>>>,
}

impl<F: Float> Cores<F> {
    pub(super) fn clear(&mut self) {
        self.corners.clear();
        self.normals.clear();
        self.placed.clear();
        self.surfaces.clear();
        self.links.clear();
    }

    /// Adds the outline of a body at a pose, and returns its number.
    pub(super) fn push(&mut self, outline: &Outline<F>, pose: &Pose<F>) -> usize {
        let begin = self.corners.len();
        self.corners.extend(outline.corners().iter().map(|&corner| pose.turned(corner)));
        self.normals.extend(outline.normals().iter().map(|&normal| pose.turned(normal)));
        self.normals.resize(self.corners.len(), [F::of(0.0); 2]);
        let corners = begin..self.corners.len();
        let (mut low, mut high) = (self.corners[begin], self.corners[begin]);
        for corner in &self.corners[corners.clone()] {
            low = [low[0].or_less(corner[0]), low[1].or_less(corner[1])];
            high = [high[0].or_more(corner[0]), high[1].or_more(corner[1])];
        }
        if let Some(neighbours) = outline.neighbours() {
            let neighbours = neighbours.map(|neighbour| neighbour.map(|normal| pose.turned(normal)));
            self.links.push(Link::new([0, 1], self.normals[begin], neighbours, None));
            self.surfaces.push((self.placed.len(), true, self.links.len()));
        }
        self.placed.push(Placed { position: pose.position, corners, low, high, radius: outline.radius() });
        self.placed.len() - 1
    }

    /// Names the edges of the outline that was added last that are on the surface among other polygons.
    pub(super) fn set_faces(&mut self, faces: &[Face]) {
        let Some(last) = self.placed.last() else { return };
        let normals = &self.normals[last.corners.clone()];
        self.links.extend(faces.iter().map(|face| link_of(face, normals)));
        self.surfaces.push((self.placed.len() - 1, false, self.links.len()));
    }

    fn surface(&self, i: usize) -> Option<Surface<'_, Pair<F>>> {
        let at = self.surfaces.binary_search_by_key(&i, |(own, ..)| *own).ok()?;
        let from = if at == 0 { 0 } else { self.surfaces[at - 1].2 };
        let (_, is_one_sided, to) = self.surfaces[at];
        Some(Surface { links: &self.links[from..to], is_one_sided })
    }

    pub(super) fn core(&self, i: usize) -> Core<'_, F> {
        let Placed { position, ref corners, low, high, radius } = self.placed[i];
        let faces = if corners.len() == 1 { corners.start..corners.start } else { corners.clone() };
        let surface = self.surface(i);
        Core {
            position,
            surface,
            corners: &self.corners[corners.clone()],
            normals: &self.normals[faces],
            low,
            high,
            radius,
        }
    }
}

/// Ulps of a metre.
const ULPS: f64 = 4_294_967_296.0;

impl<F: Float> Core<'_, F> {
    /// The largest coordinate of a corner.
    pub(super) fn extent(&self) -> F {
        self.high[0].or_more(self.high[1]).or_more(-self.low[0]).or_more(-self.low[1])
    }

    /// Returns true if the boxes around two cores at an offset are more than `limit` apart.
    pub(super) fn is_clear_of(&self, other: &Self, offset: Pair<F>, limit: F) -> bool {
        let gap = |i: usize| (other.low[i] + offset[i] - self.high[i]).or_more(self.low[i] - other.high[i] - offset[i]);
        gap(0) > limit || gap(1) > limit
    }

    pub(super) fn next(&self, i: usize) -> usize {
        if i + 1 == self.corners.len() { 0 } else { i + 1 }
    }

    /// The vector between two corners.
    pub(super) fn between(&self, from: usize, to: usize) -> Pair<F> {
        minus(self.corners[to], self.corners[from])
    }

    /// The largest component of a corner along a vector.
    pub(super) fn farthest(&self, n: Pair<F>) -> F {
        let heights = self.corners.iter().map(|&corner| dot(n, corner));
        heights.fold(dot(n, self.corners[0]), F::or_more)
    }

    /// The separation of another core at an offset along the normal of an edge.
    pub(super) fn separation(&self, edge: usize, other: &Self, offset: Pair<F>) -> F {
        let n = self.normals[edge];
        let own = dot(n, self.corners[edge]).or_more(dot(n, self.corners[self.next(edge)]));
        dot(n, offset) - other.farthest(n.map(|part| -part)) - own
    }
}
