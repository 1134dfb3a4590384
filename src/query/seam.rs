//! Normals where a ray or a shape that is cast meets a seam.
//!
//! A corner of a tile in a row is no corner of the row: what meets it meets the face that goes on there. So the normal at a sharp corner is the
//! normal of the surface of the union of the polygons that touch there, by the rules of [contacts](crate::shape::union): an edge that another polygon
//! covers, within the same slop, is not on the surface. If one edge at the corner is left, its normal counts; where the surface turns outwards into an
//! edge of another polygon, the mean of both: a ridge of two tiles is a corner as of one piece. If both edges are left, the corner is a corner of the
//! union, and if none is left, the polygon is behind an inner corner: then the normal is the polygon's own.
//!
//! A shape that is cast is a point that meets sums (`sum`), and so are its parts. The union of the sums is the sum of the unions: the same rule holds
//! for a crate that lands flat on a row, and for a row of parts that lands flat on a crate. A shape with a radius needs no rule. The direction from a
//! corner to the middle of a disc around it turns as the surface does, and where a neighbour covers the corner, its face is met first.

use alloc::vec::Vec;

use super::core::in_fx;
use super::ray::{Feature, RayEnd, at};
use super::{Core, Point, cross, dot, edge, from_to, outward};
use crate::math::Vec2;
use crate::shape::Neighbour;
use crate::shape::union::{Face, PARALLEL, Polygons, REACH};

/// With more corners than this, the polygons at a seam are a crowd, in which each has its own corners: a query stays in proportion to what it meets.
const CROWD: usize = 1 << 12;

/// A sharp corner that a ray meets, or that is within the slop of the place where the ray meets an edge.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SeamPlace {
    /// The number of the corner.
    corner: usize,
    /// The edge that the ray meets, if it is not at the corner exactly.
    met: Option<usize>,
    /// Where the ray meets it, ulps.
    pub(crate) point: Point,
}

impl SeamPlace {
    /// The corner of a core at which a ray ends; `None` elsewhere, and for a core with a radius or without an inside.
    pub(crate) fn of(core: &Core, ray: Point, end: RayEnd) -> Option<Self> {
        let corners = core.corners();
        if core.radius > 0 || corners.len() < 3 {
            return None;
        }
        let point = at(ray, end.fraction);
        match end.feature {
            Feature::Corner(corner) => Some(Self { corner, met: None, point }),
            Feature::Edge(i) => {
                let next = if i + 1 < corners.len() { i + 1 } else { 0 };
                let square = |corner: usize| {
                    let away = from_to(corners[corner], point);
                    dot(away, away)
                };
                let corner = if square(i) < square(next) { i } else { next };
                (square(corner) <= i128::from(REACH).pow(2)).then_some(Self { corner, met: Some(i), point })
            }
            Feature::Inside | Feature::Disc(_) => None,
        }
    }
}

/// The polygons at a seam, the one that is met first, as seen from the place where it is met.
pub(crate) struct Seam<'a> {
    core: &'a Core,
    place: SeamPlace,
    polygons: Polygons,
}

impl<'a> Seam<'a> {
    pub(crate) fn new(core: &'a Core, place: SeamPlace) -> Self {
        let mut seam = Self { core, place, polygons: Polygons::default() };
        seam.push(core);
        seam
    }

    /// Adds a polygon; returns false if there are too many.
    pub(crate) fn add(&mut self, core: &Core) -> bool {
        if core.radius == 0 && core.corners().len() > 2 {
            self.push(core);
        }
        !self.is_crowd()
    }

    fn push(&mut self, core: &Core) {
        let point = self.place.point;
        self.polygons.push(core.corners().iter().map(|&corner| from_to(point, corner)));
    }

    fn is_crowd(&self) -> bool {
        self.polygons.corner_count() > CROWD
    }

    /// The outward unit normal of the union there; `None` where it is the normal of the first polygon alone.
    pub(crate) fn normal(&mut self, ray: Point) -> Option<Vec2> {
        let mut faces = Vec::new();
        if self.is_crowd() || !self.polygons.faces(&mut faces) {
            return None;
        }
        let (corners, SeamPlace { corner, met, .. }) = (self.core.corners(), self.place);
        // The edges at the corner, each with the end that is there.
        let edges = [(if corner > 0 { corner - 1 } else { corners.len() - 1 }, 1), (corner, 0)];
        let mut exposed = edges.into_iter().filter_map(|(i, end)| {
            let face = faces.iter().find(|face| face.edge == i)?;
            (!matches!(face.ends[end], Neighbour::Covered)).then_some((face, end))
        });
        let (Some((face, end)), None) = (exposed.next(), exposed.next()) else { return None };
        let e = edge(corners, face.edge);
        let towards = cross(ray, e);
        if met == Some(face.edge) {
            return None;
        }
        // From units of 2^-30 to those of 2^-32.
        let next_normal = match face.ends[end] {
            Neighbour::Outer(next) if is_turned(next, face) => Some(next.map(|part| i64::from(part) << 2)),
            _ => None,
        };
        let normal = in_fx(outward(e)).normalize()?;
        match (towards < 0, next_normal.filter(|&next| dot(ray, next) < 0).map(in_fx)) {
            (true, Some(next)) => (normal + next).normalize(),
            (false, Some(next)) => next.normalize(),
            // What comes along a face meets it as well.
            (_, None) => (towards <= 0).then_some(normal),
        }
    }
}

/// Returns true if the surface turns from a face to the next one by more than rounding.
fn is_turned(next: [i32; 2], face: &Face) -> bool {
    let sine = i64::from(face.normal[0]) * i64::from(next[1]) - i64::from(face.normal[1]) * i64::from(next[0]);
    i128::from(sine).abs() > PARALLEL
}
