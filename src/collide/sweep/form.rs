//! Outlines for the time of impact: in ulps, in the axes of their bodies and in world axes.

use super::super::place::odd_shift;
use super::path::Leg;
use crate::fx::Fx;
use crate::kernel::trig::sin_cos_turn;
use crate::limits::CORNERS;
use crate::math::Vec2;
use crate::shape::Outline;

/// A vector turned, each component rounded once, oddly. *Domain* components below 2^62.
pub(super) fn turned([x, y]: [i64; 2], sin: i64, cos: i64) -> [i64; 2] {
    let product = |a: i64, b: i64| i128::from(a) * i128::from(b);
    // Below 2^62 · 2^62 · 2.
    let part = |sum: i128| odd_shift(sum, 62) as i64;
    [part(product(x, cos) - product(y, sin)), part(product(x, sin) + product(y, cos))]
}

/// The square of the length of a vector. *Domain* components below 2^62.
pub(super) fn square([x, y]: [i64; 2]) -> u128 {
    u128::from(x.unsigned_abs()).pow(2) + u128::from(y.unsigned_abs()).pow(2)
}

/// The root of a square, rounded up.
fn root(square: u128) -> i64 {
    let root = square.isqrt();
    (root + u128::from(root * root < square)) as i64
}

/// A vector in ulps.
fn ulps(vector: Vec2) -> [i64; 2] {
    [vector.x.to_bits(), vector.y.to_bits()]
}

/// An outline in the axes of its body, relative to the body's centre of mass.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Form<'a> {
    corners: &'a [Vec2],
    /// The normals of the edges from each corner to the next one; none for a disc.
    normals: &'a [Vec2],
    /// Lengths are in ulps.
    pub(super) radius: i64,
    /// The largest distance of a corner from the centre of mass.
    reach: i64,
    /// The least distance of two parallel lines that the outline is between.
    pub(crate) width: i64,
    /// A segment of a chain.
    pub(crate) is_link: bool,
}

impl<'a> Form<'a> {
    /// *Domain* one to 64 corners within 2^15 m, and a normal for each unless there is one corner.
    pub(crate) fn new(outline: &'a Outline, width: Fx, is_link: bool) -> Self {
        let corners = outline.corners();
        let normals = if corners.len() == 1 { &[] } else { outline.normals() };
        let reach = root(corners.iter().map(|&corner| square(ulps(corner))).max().unwrap_or(0));
        Self { corners, normals, radius: outline.radius().to_bits(), reach, width: width.to_bits(), is_link }
    }

    /// The outline as one that has no side.
    pub(crate) fn without_sides(self) -> Self {
        Self { is_link: false, ..self }
    }
}

/// An outline at a moment, relative to the centre of its rotation, in world axes.
#[derive(Clone, Debug)]
pub(super) struct PlacedForm {
    pub(super) centre: [i64; 2],
    /// The numbers of corners and normals; entries after them are of another outline.
    counts: [usize; 2],
    corners: [[i64; 2]; CORNERS],
    normals: [[i32; 2]; CORNERS],
    /// The largest distance of a corner from the centre of the rotation, rounded up.
    pub(super) reach: i64,
}

impl PlacedForm {
    pub(super) const NONE: Self =
        Self { centre: [0; 2], counts: [0; 2], corners: [[0; 2]; CORNERS], normals: [[0; 2]; CORNERS], reach: 0 };

    #[inline(always)]
    pub(super) fn set(&mut self, form: &Form<'_>, leg: &Leg, at: u64) {
        let arm = leg.arm(at);
        let (sin, cos) = sin_cos_turn(leg.angle(at).to_bits());
        self.centre = leg.centre(at);
        self.counts = [form.corners.len(), form.normals.len()];
        // Corners and arms are rounded.
        self.reach = form.reach + if arm == [0; 2] { 2 } else { root(square(arm)) + 4 };
        for (place, &corner) in self.corners.iter_mut().zip(form.corners) {
            let [x, y] = turned(ulps(corner), sin, cos);
            *place = [x + arm[0], y + arm[1]];
        }
        for (place, &normal) in self.normals.iter_mut().zip(form.normals) {
            // From 2^-32 to 2^-30.
            *place = turned(ulps(normal), sin, cos).map(|part| odd_shift(part.into(), 2) as i32);
        }
    }

    pub(super) fn corners(&self) -> &[[i64; 2]] {
        &self.corners[..self.counts[0]]
    }

    /// Outward unit normals of the edges, 2^-30.
    pub(super) fn normals(&self) -> &[[i32; 2]] {
        &self.normals[..self.counts[1]]
    }
}
