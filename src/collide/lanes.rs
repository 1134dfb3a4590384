//! Pairs of outlines side by side in lanes: the manifolds of pairs alone, to the bit, and their points as contacts take them.
//!
//! Boxes are rectangles without a radius that stand alone. Pairs of boxes and discs have kernels of their own; polygons of up to eight corners,
//! with segments and radii, have one for all of them, which takes boxes and discs too. A lane whose choice takes more than comparisons, a wider
//! product or a root is left undecided. No such criterion depends on which of the two outlines comes first.
//!
//! # Ranges
//! Corners are below 2^48 ulps; offsets from 2^55 on count as 0, and the lane is left. In the pair's unit coordinates are below 2^30 + 2,
//! components of normals up to 2^30 + 1: products as in [`Product`](super::cores::Product) for 64 bits. Vectors between corners are below 2^56,
//! ways along which corners move below 2^58: with parts of 31 bits, products with normals are below 2^56.1 above and 2^62 below. Separations at
//! points are below 2^31 ulps (half a metre): their products with normals are below 2^61.1. Ways to the moment of the manifold are below 2^30
//! ulps and 2^28 units of rotation, with arms below 2^35 where the body turns: along a row they are below 2^60.6 and 2^61, their difference below
//! 2^62.8.

mod box_disc;
mod boxes;
mod corners;
mod direction;
mod discs;
mod facing;
mod motion;
mod point;
mod polygons;
#[cfg(test)]
mod tests;
mod vector;

use alloc::vec::Vec;

use super::place::{Placed, View};
use super::{Manifold, ManifoldPoint};
use crate::fx::Fx;
use crate::kernel::simd::{GROUP, Job, Lanes, Line};
use crate::math::Vec2;

/// The largest number of corners of an outline that lanes take.
pub(crate) const LANE_CORNERS: usize = 8;

/// A number for each lane.
type Words = [i64; GROUP];

/// The shape of an outline that stands alone, as far as lanes take it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LaneShape {
    /// A rectangle without a radius.
    Box,
    Disc,
    /// A polygon or a segment of at most four corners, perhaps with a radius.
    FourCorners,
    /// A polygon of five to eight corners, likewise.
    EightCorners,
}

/// The kinds of pairs that lanes take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LaneKind {
    Boxes,
    /// A box and a disc.
    BoxDisc,
    Discs,
    /// Outlines of at most four corners.
    FourCorners,
    /// Outlines of at most eight corners.
    EightCorners,
}

impl LaneKind {
    /// All kinds, in their order.
    pub(crate) const ALL: [Self; 5] = [Self::Boxes, Self::BoxDisc, Self::Discs, Self::FourCorners, Self::EightCorners];

    #[inline(always)]
    pub(crate) fn new([a, b]: [LaneShape; 2]) -> Self {
        match (a, b) {
            (LaneShape::Box, LaneShape::Box) => Self::Boxes,
            (LaneShape::Box, LaneShape::Disc) | (LaneShape::Disc, LaneShape::Box) => Self::BoxDisc,
            (LaneShape::Disc, LaneShape::Disc) => Self::Discs,
            (LaneShape::EightCorners, _) | (_, LaneShape::EightCorners) => Self::EightCorners,
            _ => Self::FourCorners,
        }
    }

    /// Returns true if lanes read the outlines as [`Polygons`].
    #[inline(always)]
    pub(crate) fn has_polygons(self) -> bool {
        matches!(self, Self::FourCorners | Self::EightCorners)
    }
}

/// Polygons of up to eight corners, segments and discs, as lanes read them: by number.
#[derive(Clone, Debug, Default)]
pub(super) struct Polygons {
    /// The number of corners, the radius, the position; the least box around the corners, relative to the position.
    heads: Vec<Line>,
    /// The first and the last four corners, relative to the position, in ulps. Places after the last corner repeat the first one.
    corners: [Vec<Line>; 2],
    /// The normals: y above x in each word. Places after the last one repeat it.
    normals: Vec<Line>,
}

impl Polygons {
    pub(super) fn clear(&mut self) {
        self.heads.clear();
        self.corners.iter_mut().for_each(Vec::clear);
        self.normals.clear();
    }

    /// Adds a core, and returns its number.
    pub(super) fn push(&mut self, view: &View<'_>) -> u32 {
        let &Placed { position, count, low, high, radius, .. } = view.placed;
        let [x, y] = [position.x, position.y].map(Fx::to_bits);
        self.heads.push(Line([count as i64, radius, x, y, low[0], low[1], high[0], high[1]]));
        for (half, lines) in self.corners.iter_mut().enumerate() {
            let mut line = Line::default();
            for (place, words) in line.0.chunks_exact_mut(2).enumerate() {
                let i = 4 * half + place;
                words.copy_from_slice(&view.corners[if i < count { i } else { 0 }]);
            }
            lines.push(line);
        }
        let mut line = Line::default();
        for (i, word) in line.0.iter_mut().enumerate() {
            let [x, y] = view.normals[i.min(count - 1)];
            *word = i64::from(y) << 32 | i64::from(x as u32);
        }
        self.normals.push(line);
        self.heads.len() as u32 - 1
    }
}

/// Pairs of outlines to be collided, side by side.
#[derive(Clone, Debug, Default)]
#[repr(C, align(64))]
pub(crate) struct LanePairs {
    /// The outlines A and B, by their lines or as polygons; of a box and a disc the box is A.
    outlines: [[u32; GROUP]; 2],
    /// The motions of A and B, by their lines.
    motions: [[u32; GROUP]; 2],
    /// −1 for a pair that has B first, else 0.
    swapped: Words,
}

impl LanePairs {
    /// Writes a pair into a lane.
    #[inline(always)]
    pub(crate) fn set(&mut self, lane: usize, outlines: [u32; 2], motions: [u32; 2], is_swapped: bool) {
        for side in 0..2 {
            self.outlines[side][lane] = outlines[side];
            self.motions[side][lane] = motions[side];
        }
        self.swapped[lane] = -i64::from(is_swapped);
    }

    /// Repeats the pair of the first lane in the lanes from this one on.
    pub(crate) fn fill(&mut self, lanes: usize) {
        for indices in self.outlines.iter_mut().chain(&mut self.motions) {
            let first = indices[0];
            indices[lanes..].fill(first);
        }
        let first = self.swapped[0];
        self.swapped[lanes..].fill(first);
    }
}

/// What lanes read of outlines and bodies.
pub(super) struct Tables<'a> {
    /// By box: the first two corners relative to the position, in ulps; the first normal; the position. By disc: the centre relative to the
    /// position, in ulps, two zeros, the radius, a zero, the position.
    pub(super) outlines: &'a [Line],
    pub(super) polygons: &'a Polygons,
    /// By body: the displacement in the step, a bound of the way that the rotation adds, in ulps; the way to the moment of the manifold, in
    /// ulps and 2^-32 rad.
    pub(super) motions: &'a [Line],
    /// Outlines have a manifold if they are nearer than this and the distance that they close, ulps.
    pub(super) margin: i64,
}

/// Finds the manifolds of pairs of a kind, group by group.
pub(super) struct CollidePairs<'a> {
    pub(super) kind: LaneKind,
    pub(super) tables: Tables<'a>,
    pub(super) pairs: &'a [LanePairs],
    pub(super) manifolds: &'a mut [LaneManifolds],
}

impl Job for CollidePairs<'_> {
    type Result = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let Self { kind, tables, pairs, manifolds } = self;
        for (pairs, manifolds) in pairs.iter().zip(manifolds) {
            manifolds.clear();
            for at in (0..GROUP).step_by(L::WIDTH) {
                match kind {
                    LaneKind::Boxes => boxes::collide(lanes, &tables, pairs, manifolds, at),
                    LaneKind::BoxDisc => box_disc::collide(lanes, &tables, pairs, manifolds, at),
                    LaneKind::Discs => discs::collide(lanes, &tables, pairs, manifolds, at),
                    LaneKind::FourCorners => polygons::collide::<L, 4>(lanes, &tables, pairs, manifolds, at),
                    LaneKind::EightCorners => polygons::collide::<L, 8>(lanes, &tables, pairs, manifolds, at),
                }
            }
        }
    }
}

/// The manifolds of pairs, side by side.
#[derive(Clone, Debug, Default)]
#[repr(C, align(64))]
pub(crate) struct LaneManifolds {
    normal: [Words; 2],
    /// By point and side: arms to the surfaces.
    arms: [[[Words; 2]; 2]; 2],
    /// By point: the vector by which the point is before the surface of A, and behind the surface of B.
    halves: [[Words; 2]; 2],
    separations: [Words; 2],
    /// The separations at the start of the step.
    starts: [Words; 2],
    features: [Words; 2],
    /// A bit for each lane that is left.
    undecided: u32,
    /// By point: a bit for each lane that has it.
    points: [u32; 2],
}

/// The result of a lane.
pub(crate) enum LaneManifold {
    Undecided,
    None,
    /// The number of points, and the first one.
    Points(usize, usize),
}

/// A point of a manifold as a contact takes it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct SurfacePoint {
    /// From the positions of A and B to their surfaces, m.
    pub(crate) arms: [Vec2; 2],
    /// The separation at the start of the step, m.
    pub(crate) separation: Fx,
    pub(crate) feature: u32,
}

#[inline(always)]
fn vector([x, y]: &[Words; 2], lane: usize) -> Vec2 {
    Vec2::new(Fx::from_bits(x[lane]), Fx::from_bits(y[lane]))
}

impl LaneManifolds {
    /// The result of a lane.
    #[inline(always)]
    pub(crate) fn get(&self, lane: usize) -> LaneManifold {
        let has = |bits: u32| bits >> lane & 1 == 1;
        if has(self.undecided) {
            return LaneManifold::Undecided;
        }
        match self.points.map(has) {
            [false, false] => LaneManifold::None,
            [true, true] => LaneManifold::Points(2, 0),
            [true, false] => LaneManifold::Points(1, 0),
            [false, true] => LaneManifold::Points(1, 1),
        }
    }

    #[inline(always)]
    pub(crate) fn normal(&self, lane: usize) -> [i32; 2] {
        [self.normal[0][lane] as i32, self.normal[1][lane] as i32]
    }

    /// A point of a lane that has it.
    #[inline(always)]
    pub(crate) fn point(&self, lane: usize, point: usize) -> SurfacePoint {
        let [arm_a, arm_b] = &self.arms[point];
        SurfacePoint {
            arms: [vector(arm_a, lane), vector(arm_b, lane)],
            separation: Fx::from_bits(self.starts[point][lane]),
            feature: self.features[point][lane] as u32,
        }
    }

    /// The manifold of a lane with this number of points, from this one on.
    pub(crate) fn manifold(&self, lane: usize, count: usize, first: usize) -> Manifold {
        let mut points = [ManifoldPoint::default(); 2];
        for (k, point) in points.iter_mut().enumerate().take(count) {
            let SurfacePoint { arms, feature, .. } = self.point(lane, first + k);
            let half = vector(&self.halves[first + k], lane);
            let separation = Fx::from_bits(self.separations[first + k][lane]);
            *point = ManifoldPoint { arm_a: arms[0] + half, arm_b: arms[1] - half, separation, feature };
        }
        Manifold { normal: self.normal(lane), count, points }
    }

    /// Forgets all manifolds.
    #[inline(always)]
    fn clear(&mut self) {
        (self.undecided, self.points) = (0, [0; 2]);
    }

    /// Writes the normals and the masks of the lanes from `at` on.
    #[inline(always)]
    fn finish<L: Lanes>(
        &mut self,
        lanes: L,
        normal: [L::Wide; 2],
        undecided: L::Mask,
        is_there: [L::Mask; 2],
        at: usize,
    ) {
        lanes.store(&mut self.normal[0], at, normal[0]);
        lanes.store(&mut self.normal[1], at, normal[1]);
        self.undecided |= lanes.bits(undecided) << at;
        for (points, is_there) in self.points.iter_mut().zip(is_there) {
            *points |= lanes.bits(is_there) << at;
        }
    }
}
