//! Outlines in world axes.

use super::cores::across;
use crate::collider::BodyOutline;
use crate::fx::Fx;
pub(super) use crate::kernel::round::odd_shift;
use crate::kernel::simd::Line;
use crate::kernel::trig::sin_cos_turn;
use crate::math::Vec2;
use crate::scalar::Turn;
use crate::shape::union::Face;
use crate::shape::{Aabb, Outline};

/// The place of a body: the position of its centre of mass and the direction it is turned to. Made once for all outlines of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pose {
    position: Vec2<Fx>,
    /// Sine and cosine in units of 2^-62.
    direction: (i64, i64),
}

impl Pose {
    /// The pose at this position in m and angle.
    #[must_use]
    pub fn new(position: Vec2<Fx>, angle: Turn) -> Self {
        Self {
            position,
            direction: if angle == Turn::default() { (0, 1 << 62) } else { sin_cos_turn(angle.to_bits()) },
        }
    }

    /// The position of the centre of mass, m.
    pub(crate) fn position(&self) -> Vec2<Fx> {
        self.position
    }

    /// The pose moved by a vector. *Domain* the position stays within 2^31 m.
    pub(crate) fn shifted(&self, shift: Vec2<Fx>) -> Self {
        Self { position: self.position + shift, ..*self }
    }

    /// A unit vector in the axes of the body, from units of 2^-32 to world axes in units of 2^-30; at most 2^30 + 1.
    pub(crate) fn turned(&self, v: Vec2<Fx>) -> [i32; 2] {
        turned_normal(v, self)
    }

    /// The corners of an outline at this pose, relative to the position of another pose near it, ulps.
    pub(crate) fn corners_from<'a>(
        &self,
        outline: &'a Outline,
        origin: &Self,
    ) -> impl Iterator<Item = [i64; 2]> + use<'a> {
        let (sin, cos) = self.direction;
        let (to, from) = (self.position, origin.position);
        let offset = [to.x.to_bits().wrapping_sub(from.x.to_bits()), to.y.to_bits().wrapping_sub(from.y.to_bits())];
        outline.corners().iter().map(move |&corner| {
            let [x, y] = turned(corner, sin, cos, 62);
            [x.wrapping_add(offset[0]), y.wrapping_add(offset[1])]
        })
    }

    /// A box around a box at this pose and all within `radius` of it, at most 2^31 m out: for a rectangle the least one, but for 2 ulp.
    /// The box of a mirror image is the mirror image.
    ///
    /// *Domain* coordinates within 2^15 m, a radius up to 2^12 m.
    #[must_use]
    pub fn bounds(&self, local_bounds: &Aabb, radius: Fx) -> Aabb {
        let at = |centre: Fx, offset: i64| Fx::from_bits(centre.to_bits().saturating_add(offset));
        let Vec2 { x, y } = self.position;
        if *local_bounds == (Aabb { min: Vec2::ZERO, max: Vec2::ZERO }) {
            // A disc around the centre, as below.
            let up = 2 + radius.to_bits();
            return Aabb { min: Vec2::new(at(x, -up), at(y, -up)), max: Vec2::new(at(x, up), at(y, up)) };
        }
        self.bounds_of_corners(local_bounds, radius)
    }

    /// [`bounds`](Self::bounds) of an outline: for a box the same ones as when it is placed.
    pub(crate) fn outline_bounds(&self, outline: &BodyOutline) -> Aabb {
        match outline.placed_box(self) {
            Some(placed_box) => placed_box.placed.bounds(),
            None => self.bounds(&outline.corners, outline.outline.radius()),
        }
    }

    fn bounds_of_corners(&self, local_bounds: &Aabb, radius: Fx) -> Aabb {
        let ends = [(local_bounds.min.x, local_bounds.max.x), (local_bounds.min.y, local_bounds.max.y)]
            .map(|(low, high)| (low.to_bits(), high.to_bits()));
        // Twice the middle and twice half the size, exact: below 2^49, and their products with sine and cosine below 2^112.
        let ([x, y], [width, height]) = (ends.map(|(low, high)| low + high), ends.map(|(low, high)| high - low));
        let (sin, cos) = self.direction;
        let product = |length: i64, factor: i64| i128::from(length) * i128::from(factor);
        let middle = [product(x, cos) - product(y, sin), product(x, sin) + product(y, cos)];
        let (abs_sin, abs_cos) = (sin.abs(), cos.abs());
        let reach =
            [product(width, abs_cos) + product(height, abs_sin), product(width, abs_sin) + product(height, abs_cos)];
        // An ulp for rounding up, and one for the corners, which are rounded to ulps.
        let up = |twice: i128| (twice >> 63) as i64 + 2 + radius.to_bits();
        let at = |centre: Fx, offset: i64| Fx::from_bits(centre.to_bits().saturating_add(offset));
        let Vec2 { x, y } = self.position;
        Aabb {
            min: Vec2::new(at(x, -up(reach[0] - middle[0])), at(y, -up(reach[1] - middle[1]))),
            max: Vec2::new(at(x, up(reach[0] + middle[0])), at(y, up(reach[1] + middle[1]))),
        }
    }
}

/// (x, y) turned by the angle with this sine and cosine in units of 2^-62, divided by 2^(s − 62).
///
/// Coordinates are below 2^47.5 and the results for corners too (a corner is within 2^15 m of the centre); the products are below 2^110.
#[inline(always)]
fn turned(v: Vec2<Fx>, sin: i64, cos: i64, s: u32) -> [i64; 2] {
    let (x, y) = (i128::from(v.x.to_bits()), i128::from(v.y.to_bits()));
    let (sin, cos) = (i128::from(sin), i128::from(cos));
    [odd_shift(x * cos - y * sin, s) as i64, odd_shift(x * sin + y * cos, s) as i64]
}

/// A unit normal in world axes, from units of 2^-32 to units of 2^-30; at most 2^30 + 1.
#[inline(always)]
pub(super) fn turned_normal(normal: Vec2<Fx>, pose: &Pose) -> [i32; 2] {
    let (sin, cos) = pose.direction;
    turned(normal, sin, cos, 64).map(|part| part as i32)
}

impl Face {
    /// A face in the axes of a body, in world axes at a pose.
    pub(crate) fn turned(self, pose: &Pose) -> Self {
        let (sin, cos) = pose.direction;
        let turned = |[x, y]: [i64; 2]| turned(Vec2::new(Fx::from_bits(x), Fx::from_bits(y)), sin, cos, 62);
        let turned_normal = |normal: [i32; 2]| turned(normal.map(i64::from)).map(|part| part as i32);
        Self {
            normal: turned_normal(self.normal),
            ends: self.ends.map(|end| end.map(turned_normal)),
            part: self.part.map(|ends| ends.map(turned)),
            ..self
        }
    }
}

/// A core in world axes, without its corners and normals.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed {
    pub(super) position: Vec2<Fx>,
    pub(super) count: usize,
    /// The least box around the corners, relative to the position, in ulps: below 2^48.
    pub(super) low: [i64; 2],
    pub(super) high: [i64; 2],
    /// The largest coordinate of a corner, below 2^48.
    pub(super) extent: i64,
    pub(super) radius: i64,
    /// Corners and normals come in opposite pairs, as in a box around its centre.
    pub(super) is_box: bool,
}

/// The number of places that a core of this many corners takes: most shapes are boxes, and few places are as soon gone through as counted.
pub(super) fn places_of(count: usize) -> usize {
    match count {
        0..=4 => 4,
        5..=8 => 8,
        _ => count,
    }
}

/// The first two of four vectors whose other two are opposite to them, as in a box around its centre.
#[inline(always)]
fn halves(vectors: &[Vec2<Fx>]) -> Option<[Vec2<Fx>; 2]> {
    let [a, b, c, d] = vectors else { return None };
    let are_opposite = |a: &Vec2<Fx>, b: &Vec2<Fx>| a.x.to_bits() == -b.x.to_bits() && a.y.to_bits() == -b.y.to_bits();
    (are_opposite(a, c) && are_opposite(b, d)).then_some([*a, *b])
}

impl Placed {
    /// Places an outline. Its corners in ulps, relative to the position, each rounded once, and its normals in units of 2^-30 go to
    /// these slices of [`places_of`]; places after the last corner repeat the first one.
    #[inline(always)]
    pub(super) fn new(outline: &Outline, pose: &Pose, corners: &mut [[i64; 2]], normals: &mut [[i32; 2]]) -> Self {
        let count = outline.corners().len();
        let turned_normal = |normal: Vec2<Fx>| turned_normal(normal, pose);
        let (sin, cos) = pose.direction;
        let turned_corner = |corner: Vec2<Fx>| turned(corner, sin, cos, 62);
        if let Some(placed_box) = PlacedBox::new(outline, pose) {
            let mut room = Room::default();
            room.fill(placed_box.corners, placed_box.normals);
            corners.copy_from_slice(&room.corners);
            normals.copy_from_slice(&room.normals);
            return placed_box.placed;
        }
        let first = turned_corner(outline.corners()[0]);
        let (mut low, mut high) = (first, first);
        corners[0] = first;
        for (place, &corner) in corners[1..].iter_mut().zip(&outline.corners()[1..]) {
            let [x, y] = turned_corner(corner);
            *place = [x, y];
            (low, high) = ([low[0].min(x), low[1].min(y)], [high[0].max(x), high[1].max(y)]);
        }
        corners[count..].fill(first);
        for (place, &normal) in normals.iter_mut().zip(outline.normals()) {
            *place = turned_normal(normal);
        }
        let extent = high[0].max(high[1]).max(-low[0]).max(-low[1]);
        let radius = outline.radius().to_bits();
        Self { position: pose.position, count, low, high, extent, radius, is_box: false }
    }

    /// Places a disc around a place in the axes of its body. The second value is the place in ulps, relative to the position.
    #[inline(always)]
    pub(super) fn disc(centre: Vec2<Fx>, radius: Fx, pose: &Pose) -> (Self, [i64; 2]) {
        let (sin, cos) = pose.direction;
        let [x, y] = turned(centre, sin, cos, 62);
        let extent = x.abs().max(y.abs());
        let (position, radius) = (pose.position, radius.to_bits());
        (Self { position, count: 1, low: [x, y], high: [x, y], extent, radius, is_box: false }, [x, y])
    }

    /// A box around the outline: as [`Pose::bounds`].
    #[inline(always)]
    pub(super) fn bounds(&self) -> Aabb {
        let at = |centre: Fx, offset: i64| Fx::from_bits(centre.to_bits().saturating_add(offset));
        // An ulp for the rounding of corners, and one more, as for other outlines.
        let up = 2 + self.radius;
        let (Vec2 { x, y }, low, high) = (self.position, self.low, self.high);
        Aabb {
            min: Vec2::new(at(x, low[0] - up), at(y, low[1] - up)),
            max: Vec2::new(at(x, high[0] + up), at(y, high[1] + up)),
        }
    }
}

/// A core whose corners and normals come in opposite pairs, with the first one of each.
pub(super) struct PlacedBox {
    pub(super) placed: Placed,
    pub(super) corners: [[i64; 2]; 2],
    pub(super) normals: [[i32; 2]; 2],
}

/// The corners and normals of a box.
#[derive(Clone, Copy, Default)]
pub(super) struct Room {
    pub(super) corners: [[i64; 2]; 4],
    pub(super) normals: [[i32; 2]; 4],
}

impl Room {
    #[inline(always)]
    fn fill(&mut self, [c1, c2]: [[i64; 2]; 2], [n1, n2]: [[i32; 2]; 2]) {
        self.corners = [c1, c2, c1.map(|part| -part), c2.map(|part| -part)];
        self.normals = [n1, n2, n1.map(|part| -part), n2.map(|part| -part)];
    }

    #[inline(always)]
    pub(super) fn fill_rectangle(&mut self, &Line([x1, y1, x2, y2, nx, ny, ..]): &Line) {
        let normal = [nx as i32, ny as i32];
        self.fill([[x1, y1], [x2, y2]], [normal, across(normal)]);
    }
}

impl BodyOutline {
    /// Places the outline; `None` for other outlines than boxes.
    #[inline(always)]
    pub(super) fn placed_box(&self, pose: &Pose) -> Option<PlacedBox> {
        if self.is_upright {
            return Some(PlacedBox::upright(self.corners.max, self.outline.radius(), pose));
        }
        PlacedBox::new(&self.outline, pose)
    }
}

impl PlacedBox {
    /// Places an outline; `None` for other outlines than boxes.
    #[inline(always)]
    pub(super) fn new(outline: &Outline, pose: &Pose) -> Option<Self> {
        let (corners, normals) = (halves(outline.corners())?, halves(outline.normals())?);
        let (sin, cos) = pose.direction;
        let corners = corners.map(|corner| turned(corner, sin, cos, 62));
        let normals = normals.map(|normal| turned_normal(normal, pose));
        Some(Self::of_vectors(corners, normals, outline.radius(), pose))
    }

    /// Places a rectangle that is not turned, by the corner where x and y are positive: to the bit as [`new`](Self::new) does.
    #[inline(always)]
    pub(super) fn upright(corner: Vec2<Fx>, radius: Fx, pose: &Pose) -> Self {
        let (sin, cos) = pose.direction;
        // Below 2^110, as in `turned`.
        let product = |length: Fx, factor: i64| i128::from(length.to_bits()) * i128::from(factor);
        let [x_cos, x_sin] = [product(corner.x, cos), product(corner.x, sin)];
        let [y_cos, y_sin] = [product(corner.y, cos), product(corner.y, sin)];
        let rounded = |x: i128, y: i128| [odd_shift(x, 62) as i64, odd_shift(y, 62) as i64];
        let [sin, cos] = [sin, cos].map(|part| odd_shift(part.into(), 32) as i32);
        let corners = [rounded(y_sin - x_cos, -x_sin - y_cos), rounded(x_cos + y_sin, x_sin - y_cos)];
        Self::of_vectors(corners, [[sin, -cos], [cos, sin]], radius, pose)
    }

    #[inline(always)]
    fn of_vectors([c1, c2]: [[i64; 2]; 2], normals: [[i32; 2]; 2], radius: Fx, pose: &Pose) -> Self {
        // Rounding is odd: the other half is the opposite to the bit.
        let high = [c1[0].abs().max(c2[0].abs()), c1[1].abs().max(c2[1].abs())];
        let placed = Placed {
            position: pose.position,
            count: 4,
            low: high.map(|part| -part),
            high,
            extent: high[0].max(high[1]),
            radius: radius.to_bits(),
            is_box: true,
        };
        Self { placed, corners: [c1, c2], normals }
    }
}

/// A core in world axes.
#[derive(Clone, Copy)]
pub(super) struct View<'a> {
    pub(super) placed: &'a Placed,
    pub(super) corners: &'a [[i64; 2]],
    pub(super) normals: &'a [[i32; 2]],
}

impl View<'_> {
    /// The number of edges that have a normal: a disc has none.
    #[inline(always)]
    pub(super) fn faces(&self) -> usize {
        if self.placed.count == 1 { 0 } else { self.placed.count }
    }

    /// The offset from this position to another in ulps, exactly; `None` from 2^24 m on in a component, where nothing touches.
    #[inline(always)]
    pub(super) fn offset_to(&self, target: &Self) -> Option<[i64; 2]> {
        const FAR: i64 = 1 << (24 + 32);
        let part = |from: Fx, to: Fx| to.to_bits().checked_sub(from.to_bits()).filter(|d| -FAR < *d && *d < FAR);
        let (from, to) = (self.placed.position, target.placed.position);
        Some([part(from.x, to.x)?, part(from.y, to.y)?])
    }

    /// The distance of the boxes around the cores along x or y, whichever is larger; negative where they overlap. All terms are below 2^57.
    #[inline(always)]
    pub(super) fn gap(&self, target: &Self, offset: [i64; 2]) -> i64 {
        let (a, b) = (self.placed, target.placed);
        let gap = |i: usize| (b.low[i] + offset[i] - a.high[i]).max(a.low[i] - b.high[i] - offset[i]);
        gap(0).max(gap(1))
    }
}
