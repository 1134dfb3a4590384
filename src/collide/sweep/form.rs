//! Outlines for the time of impact: in ulps, in the axes of their bodies and in world axes.

use super::super::place::odd_shift;
use super::path::Leg;
use crate::kernel::trig::sin_cos_turn;
use crate::limits::CORNERS;

/// A vector turned, each component rounded once, oddly. *Domain* components below 2^62.
pub(super) fn turned([x, y]: [i64; 2], (sin, cos): (i64, i64)) -> [i64; 2] {
    let product = |a: i64, b: i64| i128::from(a) * i128::from(b);
    // Below 2^62 · 2^62 · 2.
    let part = |sum: i128| odd_shift(sum, 62) as i64;
    [part(product(x, cos) - product(y, sin)), part(product(x, sin) + product(y, cos))]
}

/// The length of a vector in ulps, rounded up. *Domain* components below 2^62.
pub(super) fn length([x, y]: [i64; 2]) -> i64 {
    let square = |v: i64| u128::from(v.unsigned_abs()).pow(2);
    let squares = square(x) + square(y);
    let root = squares.isqrt();
    (root + u128::from(root * root < squares)) as i64
}

/// An outline in the axes of its body, relative to the body's centre of mass, ulps.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Form {
    count: usize,
    corners: [[i64; 2]; CORNERS],
    /// The normals of the edges from each corner to the next one, in units of 2^-32; none for a disc.
    normals: [[i64; 2]; CORNERS],
    pub(super) radius: i64,
    /// The largest distance of a corner from the centre of mass.
    reach: i64,
    /// The least distance of two parallel lines that the outline is between.
    pub(crate) width: i64,
    /// A segment of a chain.
    pub(crate) is_link: bool,
}

impl Form {
    /// *Domain* one to 64 corners within 2^15 m, and a normal for each unless there is one corner.
    pub(crate) fn new(
        corners: impl Iterator<Item = [i64; 2]>,
        normals: impl Iterator<Item = [i64; 2]>,
        radius: i64,
        width: i64,
        is_link: bool,
    ) -> Self {
        let mut form =
            Self { count: 0, corners: [[0; 2]; CORNERS], normals: [[0; 2]; CORNERS], radius, reach: 0, width, is_link };
        for (place, corner) in form.corners.iter_mut().zip(corners) {
            *place = corner;
            form.reach = form.reach.max(length(corner));
            form.count += 1;
        }
        form.normals.iter_mut().zip(normals).for_each(|(place, normal)| *place = normal);
        form
    }

    /// The outline as one that has no side.
    pub(crate) fn without_sides(self) -> Self {
        Self { is_link: false, ..self }
    }
}

/// An outline at a moment, relative to the centre of its rotation, in world axes.
pub(super) struct Seen {
    pub(super) centre: [i64; 2],
    count: usize,
    corners: [[i64; 2]; CORNERS],
    normals: [[i32; 2]; CORNERS],
    /// The largest distance of a corner from the centre of the rotation, rounded up.
    pub(super) reach: i64,
}

impl Seen {
    #[inline(always)]
    pub(super) fn new(form: &Form, leg: &Leg, at: u64) -> Self {
        let mut seen = Self {
            centre: leg.centre(at),
            count: form.count,
            corners: [[0; 2]; CORNERS],
            normals: [[0; 2]; CORNERS],
            reach: 0,
        };
        let (arm, direction) = (leg.arm(at), sin_cos_turn(leg.angle(at).to_bits()));
        // Corners and arms are rounded.
        seen.reach = form.reach + if arm == [0; 2] { 2 } else { length(arm) + 4 };
        for (place, &corner) in seen.corners.iter_mut().zip(form.corners()) {
            let [x, y] = turned(corner, direction);
            *place = [x + arm[0], y + arm[1]];
        }
        for (place, &normal) in seen.normals.iter_mut().zip(form.normals()) {
            // From 2^-32 to 2^-30.
            *place = turned(normal, direction).map(|part| odd_shift(part.into(), 2) as i32);
        }
        seen
    }

    pub(super) fn corners(&self) -> &[[i64; 2]] {
        &self.corners[..self.count]
    }

    /// Outward unit normals of the edges, 2^-30.
    pub(super) fn normals(&self) -> &[[i32; 2]] {
        &self.normals[..faces(self.count)]
    }
}

impl Form {
    fn corners(&self) -> &[[i64; 2]] {
        &self.corners[..self.count]
    }

    fn normals(&self) -> &[[i64; 2]] {
        &self.normals[..faces(self.count)]
    }
}

/// A disc has no edges.
const fn faces(count: usize) -> usize {
    if count == 1 { 0 } else { count }
}
