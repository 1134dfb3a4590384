//! Drawing the shapes of bodies and colliders.

use alloc::vec::Vec;
use core::f64::consts::PI;

use super::draw::{DebugDraw, Role};
use super::pose::{Placed, Pose};
use crate::math::Vec2;
use crate::scalar::{Scalar, ToF64};
use crate::shape::{Geometry, Shape};

/// The outline of a capsule; of a disc if its ends are one point.
pub(super) fn round([a, b]: [[f64; 2]; 2], radius: f64) -> Vec<[f64; 2]> {
    /// Segments of a half disc.
    const PARTS: u32 = 24;
    let along = libm::atan2(b[1] - a[1], b[0] - a[0]);
    let arc = |centre: [f64; 2], from: f64, points: u32| {
        (0..points).map(move |i| {
            let angle = from + PI * f64::from(i) / f64::from(PARTS);
            [centre[0] + radius * libm::cos(angle), centre[1] + radius * libm::sin(angle)]
        })
    };
    // Where the half discs of one disc meet they have one corner, not two.
    let points = if a == b { PARTS } else { PARTS + 1 };
    arc(b, along - PI / 2.0, points).chain(arc(a, along + PI / 2.0, points)).collect()
}

impl<S: Scalar + ToF64> Shape<S> {
    /// Draws the shape with its centre of mass at a pose: the parts of a compound one after the other.
    pub fn debug_draw(&self, pose: Pose, role: Role, draw: &mut (impl DebugDraw + ?Sized)) {
        draw_geometry(self.geometry(), &Placed::at(pose), role, draw);
    }
}

/// The points of the rim of a rounded polygon: five to each corner, in equal parts of its arc.
fn rounded(corners: &[[f64; 2]], radius: f64) -> impl Iterator<Item = [f64; 2]> {
    let count = corners.len();
    let normal = move |i: usize| {
        let ([ax, ay], [bx, by]) = (corners[i % count], corners[(i + 1) % count]);
        libm::atan2(ax - bx, by - ay)
    };
    (0..count).flat_map(move |i| {
        let (from, [x, y]) = (normal(i + count - 1), corners[i]);
        let turn = normal(i) - from;
        let turn = if turn < 0.0 { turn + core::f64::consts::TAU } else { turn };
        (0..5).map(move |k| {
            let angle = from + turn * f64::from(k) / 4.0;
            [x + radius * libm::cos(angle), y + radius * libm::sin(angle)]
        })
    })
}

pub(super) fn draw_geometry<S: Scalar + ToF64>(
    geometry: &Geometry<S>,
    at: &Placed,
    role: Role,
    draw: &mut (impl DebugDraw + ?Sized),
) {
    let place = |v: &Vec2<S>| at.point(v.to_f64());
    match geometry {
        Geometry::Circle { radius } => {
            let radius = radius.to_f64();
            draw.circle(at.pose.position, radius, Some(at.point([radius, 0.0])), role);
        }
        Geometry::Rectangle { width, height } => {
            let (w, h) = (width.to_f64() / 2.0, height.to_f64() / 2.0);
            draw.polygon(&[[-w, -h], [w, -h], [w, h], [-w, h]].map(|corner| at.point(corner)), role);
        }
        Geometry::Capsule { length, radius } => {
            let half = length.to_f64() / 2.0;
            draw.capsule([[-half, 0.0], [half, 0.0]].map(|end| at.point(end)), radius.to_f64(), role);
        }
        Geometry::Polygon { corners } => {
            let corners: Vec<[f64; 2]> = corners.iter().map(place).collect();
            draw.polygon(&corners, role);
        }
        Geometry::RoundedPolygon { corners, radius } => {
            let corners: Vec<[f64; 2]> = corners.iter().map(|corner| corner.to_f64()).collect();
            let rim: Vec<[f64; 2]> = rounded(&corners, radius.to_f64()).map(|point| at.point(point)).collect();
            draw.polygon(&rim, role);
        }
        Geometry::Segment { ends } => draw.segment([place(&ends[0]), place(&ends[1])], role),
        Geometry::Compound { parts } => {
            for part in parts.iter() {
                let part_at = at.part(part.position.to_f64(), part.angle.to_f64());
                draw_geometry(part.shape.geometry(), &part_at, role, draw);
            }
        }
        Geometry::Chain { points, closed } => {
            let last = points.last().zip(points.first()).filter(|_| *closed);
            for (a, b) in points.windows(2).map(|ends| (&ends[0], &ends[1])).chain(last) {
                draw.segment([place(a), place(b)], role);
            }
        }
    }
}
