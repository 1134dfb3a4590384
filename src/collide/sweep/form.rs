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

/// A vector (x, y) and (−x, y) [turned], by the same products.
fn turned_beside([x, y]: [i64; 2], sin: i64, cos: i64) -> [[i64; 2]; 2] {
    let product = |a: i64, b: i64| i128::from(a) * i128::from(b);
    let [x_cos, x_sin, y_cos, y_sin] = [product(x, cos), product(x, sin), product(y, cos), product(y, sin)];
    let part = |sum: i128| odd_shift(sum, 62) as i64;
    [[part(x_cos - y_sin), part(x_sin + y_cos)], [part(-x_cos - y_sin), part(y_cos - x_sin)]]
}

/// n·p in units of 2^-30 of p's unit.
pub(super) fn height(n: [i32; 2], p: [i64; 2]) -> i128 {
    i128::from(n[0]) * i128::from(p[0]) + i128::from(n[1]) * i128::from(p[1])
}

/// The square of the length of a vector. *Domain* components below 2^62.
pub(super) fn square([x, y]: [i64; 2]) -> u128 {
    u128::from(x.unsigned_abs()).pow(2) + u128::from(y.unsigned_abs()).pow(2)
}

/// The root of a square, rounded up.
fn root(square: u128) -> i64 {
    // Roots of words are much faster.
    let root = u64::try_from(square).map_or_else(|_| square.isqrt(), |square| square.isqrt().into());
    (root + u128::from(root * root < square)) as i64
}

/// Corners nearer than this to the centre of the rotation, one metre in ulps, have heights of 64 bits.
const NEAR: i64 = 1 << 32;

/// Half a radian in 2^-44 rad.
const HALF: i64 = 1 << 43;

/// Returns true if the second half of a list is the first half, negated.
fn is_symmetric(vectors: &[Vec2]) -> bool {
    let (first, second) = vectors.split_at(vectors.len() / 2);
    first.len() == second.len() && first.iter().zip(second).all(|(&a, &b)| ulps(a) == ulps(b).map(|part| -part))
}

/// Returns true if the first corners and normals of four are the corners and normals of a rectangle that is not turned.
fn is_upright(corners: &[Vec2], normals: &[Vec2]) -> bool {
    let ([first, second, _, _], [n1, n2, _, _]) = (corners, normals) else { return false };
    let ([x1, y1], [x2, y2]) = (ulps(*first), ulps(*second));
    let ([nx, ny], across) = (ulps(*n1), ulps(*n2));
    [x2, y2] == [-x1, y1] && across == [-ny, nx]
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
    /// True for an outline that looks alike at half a turn: the second halves of its corners and of its normals are the first halves, negated.
    is_symmetric: bool,
    /// Besides, it is a rectangle that is not turned.
    is_upright: bool,
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
        let is_symmetric = is_symmetric(corners) && is_symmetric(normals);
        let is_upright = is_symmetric && is_upright(corners, normals);
        Self {
            corners,
            normals,
            radius: outline.radius().to_bits(),
            reach,
            is_symmetric,
            is_upright,
            width: width.to_bits(),
            is_link,
        }
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
    /// The second halves of the corners and of the normals are the first halves, negated.
    pub(super) is_symmetric: bool,
}

impl PlacedForm {
    pub(super) const NONE: Self = Self {
        centre: [0; 2],
        counts: [0; 2],
        corners: [[0; 2]; CORNERS],
        normals: [[0; 2]; CORNERS],
        reach: 0,
        is_symmetric: false,
    };

    #[inline(always)]
    pub(super) fn set(&mut self, form: &Form<'_>, leg: &Leg, at: u64) {
        let arm = leg.arm(at);
        self.centre = leg.centre(at);
        self.counts = [form.corners.len(), form.normals.len()];
        self.is_symmetric = form.is_symmetric && arm == [0; 2];
        // Corners and arms are rounded.
        self.reach = form.reach + if arm == [0; 2] { 2 } else { root(square(arm)) + 4 };
        if form.corners == [Vec2::ZERO] {
            self.corners[0] = arm;
            return;
        }
        let (sin, cos) = sin_cos_turn(leg.angle(at).to_bits());
        // All is rounded oddly: negatives stay negatives.
        let parts = if self.is_symmetric { 2 } else { 1 };
        let [corners, normals] = self.counts.map(|count| count / parts);
        // From 2^-32 to 2^-30.
        let turned_normal = |normal: Vec2| turned(ulps(normal), sin, cos).map(|part| odd_shift(part.into(), 2) as i32);
        if self.is_symmetric && form.is_upright {
            let [x, y] = ulps(form.corners[0]);
            [self.corners[0], self.corners[1]] = turned_beside([x, y], sin, cos);
            let [nx, ny] = turned_normal(form.normals[0]);
            [self.normals[0], self.normals[1]] = [[nx, ny], [-ny, nx]];
        } else {
            for (place, &corner) in self.corners.iter_mut().zip(&form.corners[..corners]) {
                let [x, y] = turned(ulps(corner), sin, cos);
                *place = [x + arm[0], y + arm[1]];
            }
            for (place, &normal) in self.normals.iter_mut().zip(&form.normals[..normals]) {
                *place = turned_normal(normal);
            }
        }
        if self.is_symmetric {
            for i in 0..corners {
                self.corners[corners + i] = self.corners[i].map(|part| -part);
            }
            for i in 0..normals {
                self.normals[normals + i] = self.normals[i].map(|part| -part);
            }
        }
    }

    /// Brings the outline to another moment of the piece of its path that it was [set](Self::set) on.
    #[inline(always)]
    pub(super) fn advance(&mut self, form: &Form<'_>, leg: &Leg, at: u64) {
        if leg.spin == 0 {
            self.centre = leg.centre(at);
        } else {
            self.set(form, leg, at);
        }
    }

    /// The corners, or one of each two that are opposite to each other.
    fn distinct_corners(&self) -> &[[i64; 2]] {
        &self.corners[..if self.is_symmetric { self.counts[0] / 2 } else { self.counts[0] }]
    }

    /// The normals, or one of each two that are opposite to each other.
    pub(super) fn distinct_normals(&self) -> &[[i32; 2]] {
        &self.normals[..if self.is_symmetric { self.counts[1] / 2 } else { self.counts[1] }]
    }

    /// The least and the largest height of a corner along a unit vector, in 2^-30 ulps.
    ///
    /// # Ranges
    /// A unit vector is longer than one by less than 2^-28. So heights of corners within 2^32 ulps are below 2^62.1, and so are both
    /// products.
    #[inline(always)]
    pub(super) fn heights(&self, n: [i32; 2]) -> [i128; 2] {
        let corners = self.distinct_corners();
        let [lowest, highest] = if self.reach < NEAR {
            let [x, y] = n.map(i64::from);
            let (mut lowest, mut highest) = (i64::MAX, i64::MIN);
            for &[corner_x, corner_y] in corners {
                let height = x * corner_x + y * corner_y;
                (lowest, highest) = (lowest.min(height), highest.max(height));
            }
            [lowest, highest].map(i128::from)
        } else {
            let (mut lowest, mut highest) = (i128::MAX, i128::MIN);
            for &corner in corners {
                let height = height(n, corner);
                (lowest, highest) = (lowest.min(height), highest.max(height));
            }
            [lowest, highest]
        };
        if self.is_symmetric { [lowest.min(-highest), highest.max(-lowest)] } else { [lowest, highest] }
    }

    /// The largest height of a corner along a unit vector, in 2^-30 ulps, after it has gone on by an angle in 2^-44 rad at the velocity of the
    /// moment.
    ///
    /// # Ranges
    /// Corners are below 2^49.5 ulps, angles below 2^46: the product is below 2^126.
    pub(super) fn highest_after(&self, n: [i32; 2], turn: i64) -> i128 {
        let across = [n[1], -n[0]];
        let at = |&corner: &[i64; 2]| height(n, corner) + ((height(across, corner) * i128::from(turn)) >> 44);
        self.corners().iter().map(at).max().unwrap_or(0)
    }

    /// The corners along a unit vector, for many angles; none where heights do not fit words, or corners are many.
    #[inline(always)]
    pub(super) fn swing(&self, n: [i32; 2]) -> Option<Swing> {
        let corners = self.distinct_corners();
        if self.reach >= NEAR || corners.len() > SWING_CORNERS {
            return None;
        }
        let [x, y] = n.map(i64::from);
        let mut swing = Swing {
            count: corners.len(),
            heights: [0; SWING_CORNERS],
            ways: [0; SWING_CORNERS],
            farthest_way: 0,
            is_symmetric: self.is_symmetric,
        };
        let mut highest = i64::MIN;
        for ((&[corner_x, corner_y], height), way) in corners.iter().zip(&mut swing.heights).zip(&mut swing.ways) {
            *height = x * corner_x + y * corner_y;
            *way = y * corner_x - x * corner_y;
            let is_opposite = self.is_symmetric && *height < 0;
            let (high, way) = if is_opposite { (-*height, -*way) } else { (*height, *way) };
            if high > highest {
                (highest, swing.farthest_way) = (high, way);
            }
        }
        Some(swing)
    }

    pub(super) fn corners(&self) -> &[[i64; 2]] {
        &self.corners[..self.counts[0]]
    }

    /// Outward unit normals of the edges, 2^-30.
    pub(super) fn normals(&self) -> &[[i32; 2]] {
        &self.normals[..self.counts[1]]
    }
}

/// The most distinct corners of a [`Swing`].
const SWING_CORNERS: usize = 8;

/// The heights of the distinct corners of an outline along a unit vector, and their ways by a radian.
pub(super) struct Swing {
    count: usize,
    /// 2^-30 ulps: below 2^62.1, as in [`PlacedForm::heights`].
    heights: [i64; SWING_CORNERS],
    ways: [i64; SWING_CORNERS],
    /// The way of the corner that is highest.
    pub(super) farthest_way: i64,
    is_symmetric: bool,
}

impl Swing {
    /// [`PlacedForm::highest_after`]; none from half a radian on.
    ///
    /// # Ranges
    /// An angle below 2^43 adds at most half as much to a height: the sum is below 2^62.7.
    #[inline(always)]
    pub(super) fn highest_after(&self, turn: i64) -> Option<i128> {
        if turn.abs() >= HALF {
            return None;
        }
        let mut highest = i64::MIN;
        for (&height, &way) in self.heights.iter().zip(&self.ways).take(self.count) {
            let way = i128::from(way) * i128::from(turn);
            highest = highest.max(height + (way >> 44) as i64);
            if self.is_symmetric {
                highest = highest.max(((-way) >> 44) as i64 - height);
            }
        }
        Some(highest.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cases::{run_seed, times};
    use crate::fx;
    use crate::kernel::sqrt::direction;
    use crate::math::{Random, vec2};
    use crate::scalar::Turn;
    use crate::shape::Shape;

    /// Boxes and polygons below and beyond a metre, at random angles, with angles to go up to several turns.
    #[test]
    fn heights_of_half_of_the_corners_in_words_are_those_of_all_corners() {
        let mut random = Random::seeded(run_seed(43));
        let triangle = Shape::polygon(&[vec2(0, 0), vec2(fx!(0.5), 0), vec2(0, fx!(0.7))]);
        let shapes = [Shape::rectangle(fx!(0.3), fx!(1.9)), Shape::rectangle(3000, 7), triangle, Shape::circle(1)];
        for shape in shapes.map(|shape| shape.expect("a shape")) {
            let outline = shape.outlines().first().expect("an outline");
            let form = Form::new(outline, fx!(1), false);
            assert_eq!([form.is_symmetric, form.is_upright], [outline.corners().len() == 4; 2]);
            for _ in 0..times(1000) {
                let leg = Leg::new([0; 2], [0; 2], Turn::from_bits(random.bits()), 1 << 60);
                let mut placed = PlacedForm::NONE;
                placed.set(&form, &leg, 0);
                let mut turned = PlacedForm::NONE;
                turned.set(&Form { is_upright: false, ..form }, &leg, 0);
                assert_eq!((placed.corners(), placed.normals()), (turned.corners(), turned.normals()));
                let n = direction(random.bits() as i64 >> 8, random.bits() as i64 >> 8 | 1).0;
                let heights = placed.corners().iter().map(|&corner| height(n, corner));
                assert_eq!(placed.heights(n), [heights.clone().min(), heights.max()].map(|end| end.expect("a corner")));
                let turn = random.bits() as i64 >> (18 + random.bits() % 40);
                let after = placed
                    .corners()
                    .iter()
                    .map(|&corner| height(n, corner) + ((height([n[1], -n[0]], corner) * i128::from(turn)) >> 44));
                let highest = after.max();
                assert_eq!(Some(placed.highest_after(n, turn)), highest);
                let swing = placed.swing(n).and_then(|swing| swing.highest_after(turn));
                assert_eq!(swing.is_some(), placed.reach < NEAR && turn.abs() < HALF);
                assert!(swing.is_none() || swing == highest);
            }
        }
    }
}
