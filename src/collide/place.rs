//! Outlines in world axes.

use alloc::vec::Vec;

use super::link::{collide_surfaces, swapped};
use super::seam::Face;
use super::surface::{Link, Surface, Surfaces};
use super::{Manifold, Margin, collide_placed};
use crate::fx::Fx;
pub(super) use crate::kernel::round::odd_shift;
use crate::kernel::trig::sin_cos_turn;
use crate::math::Vec2;
use crate::scalar::Turn;
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
fn turned_normal(normal: Vec2<Fx>, pose: &Pose) -> [i32; 2] {
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
    position: Vec2<Fx>,
    pub(super) count: usize,
    /// The least box around the corners, relative to the position, in ulps: below 2^48.
    low: [i64; 2],
    high: [i64; 2],
    /// The largest coordinate of a corner, below 2^48.
    pub(super) extent: i64,
    pub(super) radius: i64,
    /// Corners and normals come in opposite pairs, as in a box around its centre.
    pub(super) is_box: bool,
}

/// The number of places that a core of this many corners takes: most shapes are boxes, and few places are as soon gone through as counted.
pub(super) fn room(count: usize) -> usize {
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
    /// these slices of [`room`]; places after the last corner repeat the first one.
    #[inline(always)]
    pub(super) fn new(outline: &Outline, pose: &Pose, corners: &mut [[i64; 2]], normals: &mut [[i32; 2]]) -> Self {
        let count = outline.corners().len();
        let turned_normal = |normal: Vec2<Fx>| turned_normal(normal, pose);
        let (sin, cos) = pose.direction;
        let turned_corner = |corner: Vec2<Fx>| turned(corner, sin, cos, 62);
        let core_with_bounds = |[low, high]: [[i64; 2]; 2], is_box: bool| {
            let position = pose.position;
            let radius = outline.radius().to_bits();
            let extent = high[0].max(high[1]).max(-low[0]).max(-low[1]);
            Self { position, count, low, high, extent, radius, is_box }
        };
        if let (Some([c1, c2]), Some([n1, n2])) = (halves(outline.corners()), halves(outline.normals())) {
            // Rounding is odd: the other half is the opposite to the bit.
            let [c1, c2] = [turned_corner(c1), turned_corner(c2)];
            let [n1, n2] = [turned_normal(n1), turned_normal(n2)];
            corners.copy_from_slice(&[c1, c2, c1.map(|part| -part), c2.map(|part| -part)]);
            normals.copy_from_slice(&[n1, n2, n1.map(|part| -part), n2.map(|part| -part)]);
            let high = [c1[0].abs().max(c2[0].abs()), c1[1].abs().max(c2[1].abs())];
            return core_with_bounds([high.map(|part| -part), high], true);
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
        core_with_bounds([low, high], false)
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

/// Outlines in world axes, each turned once for all its pairs.
#[derive(Clone, Debug, Default)]
pub struct Cores {
    corners: Vec<[i64; 2]>,
    normals: Vec<[i32; 2]>,
    /// Each core with its first place, and whether it is among the surfaces.
    placed: Vec<(Placed, usize, bool)>,
    /// Segments of chains and polygons among others, by number: true for a segment, and the last of its links.
    surfaces: Vec<(usize, bool, usize)>,
    links: Vec<Link>,
}

impl Cores {
    /// Forgets all outlines and keeps the memory.
    pub fn clear(&mut self) {
        self.corners.clear();
        self.normals.clear();
        self.placed.clear();
        self.surfaces.clear();
        self.links.clear();
    }

    /// Adds the outline of a body at a pose, and returns its number: 0, 1, 2 and so on.
    pub fn push(&mut self, outline: &Outline, pose: &Pose) -> usize {
        let start = self.corners.len();
        let end = start + room(outline.corners().len());
        self.corners.resize(end, [0; 2]);
        self.normals.resize(end, [0; 2]);
        let placed = Placed::new(outline, pose, &mut self.corners[start..], &mut self.normals[start..]);
        if let Some(neighbours) = outline.neighbours() {
            let turned = |normal| turned_normal(normal, pose);
            let neighbours = neighbours.map(|neighbour| neighbour.map(turned));
            self.links.push(Link::new([0, 1], self.normals[start], neighbours, None));
            self.surfaces.push((self.placed.len(), true, self.links.len()));
        }
        self.placed.push((placed, start, outline.neighbours().is_some()));
        self.placed.len() - 1
    }

    /// Names the edges of the outline that was added last that are on the surface among other polygons, in world axes.
    pub(crate) fn set_faces(&mut self, faces: impl Iterator<Item = Face>) {
        let Some((placed, start, is_surface)) = self.placed.last_mut() else { return };
        *is_surface = true;
        let (count, normals) = (placed.count, &self.normals[*start..]);
        let link = |face: Face| {
            let corners = [face.edge, (face.edge + 1) % count];
            Link::new(corners, normals[face.edge], face.ends, face.part)
        };
        self.links.extend(faces.map(link));
        self.surfaces.push((self.placed.len() - 1, false, self.links.len()));
    }

    /// The manifold of two of the outlines: see [`collide`](super::collide()).
    ///
    /// # Panics
    /// Panics if one of them is not there.
    #[must_use]
    pub fn collide(&self, a: usize, b: usize, margin: Margin) -> Option<Manifold> {
        if self.placed[a].2 || self.placed[b].2 {
            return self.collide_surfaces(a, b, margin);
        }
        collide_placed(self.view(a), self.view(b), margin)
    }

    fn surface(&self, i: usize) -> Option<Surface<'_>> {
        let index = self.surfaces.binary_search_by_key(&i, |(number, ..)| *number).ok()?;
        let start = if index == 0 { 0 } else { self.surfaces[index - 1].2 };
        let (_, is_one_sided, end) = self.surfaces[index];
        Some(Surface { links: &self.links[start..end], is_one_sided, is_across: false })
    }

    #[cold]
    fn collide_surfaces(&self, a: usize, b: usize, margin: Margin) -> Option<Manifold> {
        let surfaces = Surfaces { a: self.surface(a), b: self.surface(b) };
        if surfaces.a.is_some() {
            return collide_surfaces(self.view(a), self.view(b), surfaces, margin);
        }
        let surfaces = Surfaces { a: surfaces.b, b: None };
        collide_surfaces(self.view(b), self.view(a), surfaces, margin).map(swapped)
    }

    #[inline(always)]
    fn view(&self, i: usize) -> View<'_> {
        let (placed, start, _) = &self.placed[i];
        let places = *start..start + room(placed.count);
        View { placed, corners: &self.corners[places.clone()], normals: &self.normals[places] }
    }
}
