//! Two boxes: the manifold that `cores`, `axes` and `frame` find, in fewer instructions.
//!
//! The corners of a box around its centre are c, d, −c, −d and its normals m, n, −m, −n, to the bit: rounding is odd. So two products give
//! the heights of all four corners along a direction and along the opposite one, relative to the centre; the offset of the centres adds a
//! third. Products and sums are exact, so that the integers compared here are the integers that `axes` and `frame` compare. Pairs whose
//! choice takes more than a comparison are left [`Undecided`].

use core::cmp::Ordering;

use super::Manifold;
use super::axes::{Edges, tied};
use super::cores::{Core, Product, across};
use super::frame::{Frame, nearest};
use super::place::View;
use super::points::Ends;
use super::span::{Facing, Span};

/// The number of corners of a box.
const N: usize = 4;

/// Two boxes whose manifold takes the way of all other cores.
pub(super) struct Undecided;

/// The first two of four numbers or vectors whose other two are their opposites.
type Halves<T> = [T; 2];

/// Number `i` of the four.
#[inline(always)]
fn at<P: Product>(halves: Halves<P>, i: usize) -> P {
    let half = halves[i & 1];
    if i & 2 == 0 { half } else { -half }
}

/// The largest of the four.
#[inline(always)]
fn max_component<P: Product>([first, second]: Halves<P>) -> P {
    first.max(-first).max(second.max(-second))
}

/// The higher one of the ends of edge 0 or 1.
#[inline(always)]
fn edge_height<P: Product>([first, second]: Halves<P>, edge: usize) -> P {
    second.max(if edge == 0 { first } else { -first })
}

#[inline(always)]
fn opposite<P: Product>([first, second]: Halves<P>) -> Halves<P> {
    [-first, -second]
}

/// A vector in the pair's unit.
#[inline(always)]
fn vector<P: Product>([x, y]: [i64; 2], k: u32) -> [i64; 2] {
    [P::coordinate(x, k), P::coordinate(y, k)]
}

/// A box: its corners in the pair's unit, relative to its centre, and its normals.
struct Rectangle {
    corners: Halves<[i64; 2]>,
    normals: Halves<[i32; 2]>,
    extent: i64,
}

impl Rectangle {
    #[inline(always)]
    fn new<P: Product>(view: &View<'_>, k: u32) -> Option<Self> {
        let (corners, normals) = (view.corners.first_chunk::<N>()?, view.normals.first_chunk::<N>()?);
        let (corners, normals) = ([vector::<P>(corners[0], k), vector::<P>(corners[1], k)], [normals[0], normals[1]]);
        Some(Self { corners, normals, extent: view.placed.extent }).filter(|_| view.placed.is_box)
    }

    /// The corners that are farthest out along `w`, as `frame` finds them, by their heights and their places across `w`.
    #[inline(always)]
    fn support<P: Product>(&self, [h, g]: Halves<P>, places: Halves<P>, k: u32) -> Result<[usize; 2], Undecided> {
        let slack = P::length((3 << k) + (self.extent >> 29), k);
        // Of each two opposite corners the higher one.
        let (first, second) = (if h < P::ZERO { 2 } else { 0 }, if g < P::ZERO { 3 } else { 1 });
        let (first_height, second_height) = (h.max(-h), g.max(-g));
        if first_height > second_height + slack {
            return Ok([first, first]);
        }
        if second_height > first_height + slack {
            return Ok([second, second]);
        }
        // A lower one may be as high within rounding.
        if first_height + second_height <= slack {
            return Err(Undecided);
        }
        let [start, end] = if second == (first + 1) & 3 { [first, second] } else { [second, first] };
        if at(places, start) < at(places, end) { Ok([start, end]) } else { Err(Undecided) }
    }

    /// The edge that faces along `w`, as `frame` finds it.
    #[inline(always)]
    fn facing_edge<P: Product>(&self, w: [i32; 2], [corner, last]: [usize; 2], places: Halves<P>) -> [usize; 2] {
        if corner != last {
            return [corner, last];
        }
        let normal = |i: usize| {
            let sign = if i & 2 == 0 { 1 } else { -1 };
            self.normals[i & 1].map(|part| sign * i64::from(part))
        };
        let (before, after) = ((corner + 3) & 3, (corner + 1) & 3);
        let ([x, y], [u, v]) = (normal(before), normal(corner));
        let edge = match P::cross(w, [x + u, y + v]).cmp(&P::ZERO) {
            Ordering::Equal => return [corner, corner],
            Ordering::Greater => [before, corner],
            Ordering::Less => [corner, after],
        };
        if at(places, edge[0]) < at(places, edge[1]) { edge } else { [corner, corner] }
    }
}

/// Two boxes along a vector: the components of the corners, each relative to its own box's centre, and of the offset from A's
/// centre to B's.
#[derive(Clone, Copy)]
struct Along<P> {
    a: Halves<P>,
    b: Halves<P>,
    offset: P,
}

impl<P: Product> Along<P> {
    /// The larger one of the separations along normal `i` of A and along its opposite, as far as the offset goes.
    #[inline(always)]
    fn separation_by_a(&self, i: usize) -> P {
        self.offset.max(-self.offset) - max_component(self.b) - edge_height(self.a, i)
    }

    /// The larger one of the separations along normal `i` of B and along its opposite.
    #[inline(always)]
    fn separation_by_b(&self, i: usize) -> P {
        self.offset.max(-self.offset) - max_component(self.a) - edge_height(self.b, i)
    }

    /// The pair along the opposite vector.
    #[inline(always)]
    fn reversed(&self) -> Self {
        Self { a: opposite(self.a), b: opposite(self.b), offset: -self.offset }
    }

    /// The spans between corners that are in counter-clockwise order, of which these are the places.
    #[inline(always)]
    fn spans(&self, a: [usize; 2], b: [usize; 2]) -> (Span<P>, Span<P>) {
        let places = [self.offset + at(self.b, b[1]), self.offset + at(self.b, b[0])];
        let span_a = Span { corners: a, places: [at(self.a, a[0]), at(self.a, a[1])] };
        (span_a, Span { corners: [b[1], b[0]], places })
    }
}

/// A pair of boxes.
struct Boxes {
    a: Rectangle,
    b: Rectangle,
    offset: [i64; 2],
    k: u32,
}

/// A direction from A to B, and the pair along it.
type Chosen<P> = ([i32; 2], Along<P>);

impl Boxes {
    #[inline(always)]
    fn along<P: Product>(&self, n: [i32; 2]) -> Along<P> {
        let components = |rectangle: &Rectangle| [P::dot(n, rectangle.corners[0]), P::dot(n, rectangle.corners[1])];
        Along { a: components(&self.a), b: components(&self.b), offset: P::dot(n, self.offset) }
    }

    /// The direction of largest separation; `None` if that is above the limit.
    #[inline(always)]
    fn direction<P: Product>(&self, ends: &Ends<'_>) -> Result<Option<Chosen<P>>, Undecided> {
        let ([m, n], [o, p]) = (self.a.normals, self.b.normals);
        let (first, second): (Along<P>, Along<P>) = (self.along(m), self.along(n));
        let (first_separation, second_separation) = (first.separation_by_a(0), second.separation_by_a(1));
        if ends.limit.is_below_product(first_separation.max(second_separation), self.k) {
            return Ok(None);
        }
        let (third, fourth) = (self.along(o), self.along(p));
        let separations = [first_separation, second_separation, third.separation_by_b(0), fourth.separation_by_b(1)];
        let largest = separations.into_iter().fold(first_separation, P::max);
        if ends.limit.is_below_product(largest, self.k) {
            return Ok(None);
        }
        let ties = (0..N).fold(0_u32, |set, i| set | u32::from(separations[i] == largest) << i);
        let (n, along) = match ties {
            0b0001 => (m, first),
            0b0010 => (n, second),
            0b0100 => (o, third),
            _ => (p, fourth),
        };
        if ties & (ties - 1) != 0 || along.offset == P::ZERO {
            let offsets = [first.offset, second.offset, third.offset, fourth.offset];
            return self.tied(ends, ties, offsets).map(Some);
        }
        Ok(Some(if along.offset > P::ZERO { (n, along) } else { ([-n[0], -n[1]], along.reversed()) }))
    }

    /// The direction among the directions that tie, for the set of normals and their offsets: of the two separations by one normal the one
    /// along the offset is larger, and without an offset both are the same.
    #[cold]
    fn tied<P: Product>(&self, ends: &Ends<'_>, ties: u32, offsets: [P; 4]) -> Result<Chosen<P>, Undecided> {
        let is_tied = |i: usize, is_along: bool| u64::from(ties >> i & 1 == 1 && is_along);
        let [mut edges_a, mut edges_b]: Edges = [0, 0];
        for i in 0..2 {
            let (offset_a, offset_b) = (offsets[i], offsets[i + 2]);
            edges_a |= is_tied(i, offset_a >= P::ZERO) << i | is_tied(i, offset_a <= P::ZERO) << (i + 2);
            // The inward normals of B point from A to B.
            edges_b |= is_tied(i + 2, offset_b <= P::ZERO) << i | is_tied(i + 2, offset_b >= P::ZERO) << (i + 2);
        }
        let (a, b) = (Core::<P, N>::new(&ends.a, [0; 2], self.k), Core::<P, N>::new(&ends.b, ends.offset, self.k));
        let direction = tied(&a, &b, [edges_a, edges_b]).filter(|direction| !direction.is_mean).ok_or(Undecided)?;
        Ok((direction.n, self.along(direction.n)))
    }

    /// The separation from which on a corner next to a corner counts, as in `frame`.
    #[inline(always)]
    fn corner_threshold<P: Product>(&self, is_rounded: bool) -> P {
        if is_rounded { P::ZERO } else { P::length(self.a.extent.min(self.b.extent) >> 11, self.k) }
    }

    /// The frame of boxes with edges that face each other along a direction.
    #[inline(always)]
    fn frame<P: Product>(&self, (n, heights): Chosen<P>, is_rounded: bool) -> Result<Frame<P>, Undecided> {
        let places = self.along(across(n));
        let (down_b, back_b) = (opposite(heights.b), opposite(places.b));
        let back = n.map(|part| -part);
        let support_a = self.a.support(heights.a, places.a, self.k)?;
        let support_b = self.b.support(down_b, back_b, self.k)?;
        let separation = heights.offset - max_component(heights.b) - max_component(heights.a);
        if separation > P::ZERO && separation > self.corner_threshold(is_rounded) {
            let (span_a, span_b) = places.spans(support_a, support_b);
            if nearest(&span_a, &span_b).is_some_and(|(gap, _)| gap > P::ZERO) {
                return Err(Undecided);
            }
        }
        let edge_a = self.a.facing_edge(n, support_a, places.a);
        let (a, b) = places.spans(edge_a, self.b.facing_edge(back, support_b, back_b));
        let is_facing = a.places[0].max(b.places[0]) < a.places[1].min(b.places[1]);
        if is_facing { Ok(Frame { n, a, b, facing: Facing::Edges }) } else { Err(Undecided) }
    }
}

/// The manifold of two cores that are both boxes and have edges that face each other.
#[inline(always)]
pub(super) fn collide_boxes<P: Product>(ends: &Ends<'_>, k: u32) -> Result<Option<Manifold>, Undecided> {
    let (a, b) = (Rectangle::new::<P>(&ends.a, k), Rectangle::new::<P>(&ends.b, k));
    let (Some(a), Some(b)) = (a, b) else { return Err(Undecided) };
    let boxes = Boxes { a, b, offset: vector::<P>(ends.offset, k), k };
    let Some(chosen) = boxes.direction::<P>(ends)? else { return Ok(None) };
    let is_rounded = ends.a.placed.radius + ends.b.placed.radius > 0;
    boxes.frame(chosen, is_rounded).map(|frame| ends.clipped(&frame))
}

#[cfg(test)]
mod tests {
    use super::super::place::Placed;
    use super::super::{Margin, Pose, collide_cores};
    use super::*;
    use crate::cases::run_seed;
    use crate::fx;
    use crate::fx::Fx;
    use crate::math::{Random, Vec2};
    use crate::scalar::Turn;
    use crate::shape::{Geometry, Outline, Shape};

    /// Compares both ways on a pair with products of a type: the manifold of the short way, if it decides.
    fn compared<P: Product>(ends: &Ends<'_>, k: u32) -> Option<Option<Manifold>> {
        let manifold = collide_boxes::<P>(ends, k).ok()?;
        assert_eq!(manifold, collide_cores::<P, N>(ends, k));
        Some(manifold)
    }

    /// A box of up to 4 m in each direction; one in four is a square of 1 m, and one in eight has a radius.
    fn outline(random: &mut Random) -> Outline {
        let mut half = || Fx::from_bits((1 << 26) + random.below(1 << 33) as i64);
        let (x, y) = (half(), half());
        let (x, y) = if random.below(4) == 0 { (fx!(0.5), fx!(0.5)) } else { (x, y) };
        let corners = [(-x, -y), (x, -y), (x, y), (-x, y)].map(|(x, y)| Vec2::new(x, y));
        let corners = corners.into();
        let geometry = match random.below(8) {
            0 => Geometry::RoundedPolygon { corners, radius: fx!(0.125) },
            _ => Geometry::Polygon { corners },
        };
        Shape::new(geometry).expect("a fair box").outlines()[0].clone()
    }

    /// Compares the manifolds of boxes with the manifolds of the general way, to the bit: at any angles, and at angles at which
    /// directions tie.
    #[test]
    fn the_short_way_finds_the_same_manifolds() {
        let mut random = Random::seeded(run_seed(11));
        let (mut decided, mut touching) = ([0; 2], [0; 2]);
        const ROUNDS: usize = 40_000;
        for round in 0..ROUNDS {
            let outlines = [outline(&mut random), outline(&mut random)];
            let angles = match random.below(4) {
                0 => [random.bits(), random.bits()],
                1 => [(1 << 62) + random.below(1 << 40), random.below(1 << 40)],
                2 => [random.bits(); 2],
                _ => [0; 2],
            };
            let reach = outlines[0].reach().to_bits() + outlines[1].reach().to_bits();
            let offset = |random: &mut Random| Fx::from_bits(random.below(2 * reach as u64) as i64 - reach);
            let x = if random.below(4) == 0 { Fx::ZERO } else { offset(&mut random) };
            let places = [Vec2::ZERO, Vec2::new(x, offset(&mut random))];
            let poses = [0, 1].map(|i| Pose::new(places[i], Turn::from_bits(angles[i])));
            let mut memory = [([[0; 2]; N], [[0; 2]; N]); 2];
            let placed = [0, 1].map(|i| {
                let (corners, normals) = &mut memory[i];
                Placed::new(&outlines[i], &poses[i], corners, normals)
            });
            let [a, b] = [0, 1].map(|i| View { placed: &placed[i], corners: &memory[i].0, normals: &memory[i].1 });
            let offset = a.offset_to(&b).expect("they are near");
            // The margin of a body at rest, or more.
            let margin = Margin::from(Fx::from_bits(1 << (25 + 8 * (round % 2))));
            let limit = margin.limit(placed[0].radius + placed[1].radius);
            let ends = Ends { a, b, offset, limit };
            let (k, is_fine) = super::super::unit(&ends);
            let manifold = if is_fine { compared::<i64>(&ends, k) } else { None };
            for (i, manifold) in [manifold, compared::<i128>(&ends, 0)].into_iter().enumerate() {
                decided[i] += usize::from(manifold.is_some());
                touching[i] += usize::from(manifold.flatten().is_some());
            }
        }
        for i in 0..2 {
            assert!(decided[i] > ROUNDS * 3 / 4 && touching[i] > ROUNDS / 4, "{decided:?}, {touching:?}");
        }
    }
}
