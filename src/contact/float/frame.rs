//! The direction of two outlines that touch, and which of their corners and edges face each other along it: the rules of the narrow
//! phase in integers. Where that compares exact numbers, what differs by rounding alone is equal here.
//!
//! Heights are components along the direction n from A to B, places components along n turned by a quarter.

use super::cores::Core;
use super::link::reaches;
use super::number::{Float, Pair, cross, dot, length, minus, plus, times};
use crate::collide::span::{Facing, Span};

/// Differences of this many times the rounding of a length are none.
const SLACK: f64 = 16.0;

/// A direction from A to B.
#[derive(Clone, Copy)]
struct Direction<F> {
    n: Pair<F>,
    /// The mean of normals that tie.
    is_mean: bool,
}

/// Two cores along a direction.
pub(super) struct Frame<F> {
    pub(super) n: Pair<F>,
    /// The separation of the cores along n.
    pub(super) separation: F,
    pub(super) a: Span<F>,
    pub(super) b: Span<F>,
    pub(super) facing: Facing,
}

/// Two cores near each other.
#[derive(Clone, Copy)]
pub(super) struct Both<'a, F: Float> {
    pub(super) a: Core<'a, F>,
    pub(super) b: Core<'a, F>,
    /// The offset from A's position to B's.
    pub(super) offset: Pair<F>,
    /// The largest separation of cores that counts.
    pub(super) limit: F,
    /// Differences of lengths that are below this are none.
    pub(super) slack: F,
}

/// The corners of a core that are farthest out along a direction, in counter-clockwise order. A corner alone is both.
struct Support<F> {
    ends: [usize; 2],
    height: F,
}

/// The farthest corners of a core along `w`: the first and the last of those that differ by rounding alone.
fn support<F: Float>(core: &Core<'_, F>, w: Pair<F>) -> Support<F> {
    let height = core.farthest(w);
    let least = height - F::of(SLACK) * F::EPSILON * core.extent();
    let across = |i: &usize| dot([-w[1], w[0]], core.corners[*i]);
    let near = || (0..core.corners.len()).filter(|&i| dot(w, core.corners[i]) >= least);
    let first = near().reduce(|i, j| if across(&j) < across(&i) { j } else { i }).unwrap_or(0);
    let last = near().reduce(|i, j| if across(&j) > across(&i) { j } else { i }).unwrap_or(0);
    Support { ends: [first, last], height }
}

/// The edge that faces along `w`: that of the support, or of the two beside a corner the one whose normal is nearer to `w`; the corner
/// itself if both are as near.
fn facing_edge<F: Float>(core: &Core<'_, F>, support: &Support<F>, w: Pair<F>) -> [usize; 2] {
    let ([corner, last], count) = (support.ends, core.corners.len());
    if corner != last || count == 1 {
        return support.ends;
    }
    let (before, after) = (if corner == 0 { count - 1 } else { corner - 1 }, core.next(corner));
    // The middle between the two normals; at the end of a segment, where they are opposite, outwards along it.
    let middle =
        if count == 2 { core.between(after, corner) } else { plus(core.normals[corner], core.normals[before]) };
    let turn = cross(w, middle);
    if turn.size() <= F::of(SLACK) * F::EPSILON * length(middle) {
        return [corner, corner];
    }
    // Where the middle is counter-clockwise of `w`, the edge before the corner is.
    let edge = if turn > F::of(0.0) { [before, corner] } else { [corner, after] };
    // An edge along `w` has no length across it.
    if cross(w, core.between(edge[0], edge[1])) > F::of(0.0) { edge } else { [corner, corner] }
}

impl<'a, F: Float> Both<'a, F> {
    /// The two cores, if the boxes around them are at most `margin` apart.
    pub(super) fn new(a: Core<'a, F>, b: Core<'a, F>, margin: F) -> Option<Self> {
        let offset = minus(b.position, a.position);
        let limit = margin + a.radius + b.radius;
        if a.is_clear_of(&b, offset, limit) || a.surface.is_some_and(|surface| surface.is_passed(&a, &b, offset)) {
            return None;
        }
        let size = a.extent() + b.extent() + offset[0].size().or_more(offset[1].size());
        Some(Self { a, b, offset, limit, slack: F::of(SLACK) * F::EPSILON * size })
    }

    /// The separations along the outward normals of A and the inward ones of B, with the normal and the edge's length.
    fn axes(&self) -> impl Iterator<Item = (F, Pair<F>, F)> + '_ {
        let back = self.offset.map(|part| -part);
        // A surface touches along the normals of its edges, and along few of the other's.
        let is_on = |i: &usize| {
            let links = self.a.surface.iter().flat_map(|surface| surface.links);
            let mut own = links.filter(|link| link.corners[0] == *i);
            self.a.surface.is_none() || own.any(|link| reaches(link, None, &self.b, self.offset))
        };
        let of_a = (0..self.a.normals.len()).filter(is_on).map(move |i| {
            (self.a.separation(i, &self.b, self.offset), self.a.normals[i], length(self.a.between(i, self.a.next(i))))
        });
        let of_b = (0..self.b.normals.len()).map(move |i| {
            let n = self.b.normals[i].map(|part| -part);
            (self.b.separation(i, &self.a, back), n, length(self.b.between(i, self.b.next(i))))
        });
        of_a.chain(of_b.filter(move |(_, n, _)| {
            self.a.surface.is_none_or(|surface| surface.has(*n, |link, end| reaches(link, end, &self.b, self.offset)))
        }))
    }

    /// The frame of the two cores: that of the direction of largest separation. `None` if they are farther apart than counts, or if the
    /// directions that tie cancel.
    pub(super) fn frame(&self) -> Option<Frame<F>> {
        let largest = self.axes().map(|(separation, ..)| separation).reduce(F::or_more)?;
        if largest > self.limit {
            return None;
        }
        let is_claimed = |n| self.along(Direction { n, is_mean: false }).separation > largest + self.slack;
        if self.a.surface.is_some_and(|surface| surface.outer().any(is_claimed)) {
            return None;
        }
        let Some(direction) = self.direction(largest) else {
            return self.on_one_line();
        };
        let frame = self.along(direction);
        if frame.facing == Facing::Edges {
            return Some(frame);
        }
        // The right direction may be that of another edge, within rounding of the best.
        let nearly = self.axes().filter(|(separation, ..)| *separation >= largest - self.slack);
        let mut others = nearly.map(|(_, n, _)| self.along(Direction { n, is_mean: false }));
        others.find(|other| other.facing == Facing::Edges).or(Some(frame))
    }

    /// The direction of the longest edge of those that tie, or the mean over all that are as long.
    fn direction(&self, largest: F) -> Option<Direction<F>> {
        let tied = || self.axes().filter(|(separation, ..)| *separation >= largest - self.slack);
        let longest = tied().map(|(.., length)| length).reduce(F::or_more)?;
        let longest = || tied().filter(|(.., length)| *length >= longest - self.slack).map(|(_, n, _)| n);
        let first = longest().next()?;
        // Axes of one direction, which differ by rounding, are one.
        let same = |n: Pair<F>| length(minus(n, first)) <= F::of(SLACK) * F::EPSILON;
        if longest().all(same) {
            return Some(Direction { n: first, is_mean: false });
        }
        let (count, sum) = longest().fold((F::of(0.0), [F::of(0.0); 2]), |(k, sum), n| (k + F::of(1.0), plus(sum, n)));
        let size = length(sum);
        (size > F::of(SLACK) * F::EPSILON * count)
            .then(|| Direction { n: times(sum, F::of(1.0) / size), is_mean: true })
    }

    /// Segments and points that are apart on one line, where the normals of either side tie: their ends next to each other.
    fn on_one_line(&self) -> Option<Frame<F>> {
        let [count_a, count_b] = [self.a.corners.len(), self.b.corners.len()];
        if count_a.max(count_b) > 2 {
            return None;
        }
        let n = *self.a.normals.first().or(self.b.normals.first())?;
        let (a, b) = self.spans(n, [0, count_a - 1], [0, count_b - 1]);
        let (a, b) = (a.in_order(), b.in_order());
        let (_, [i, j]) = self.nearest(&a, &b).filter(|(gap, _)| *gap > self.far())?;
        Some(Frame { n, separation: F::of(0.0), a, b, facing: Facing::Corners(i, j) })
    }

    /// The spans between corners that are in counter-clockwise order: along A's boundary places grow, along B's they fall.
    fn spans(&self, n: Pair<F>, a: [usize; 2], b: [usize; 2]) -> (Span<F>, Span<F>) {
        let across = [-n[1], n[0]];
        let of_a = Span { corners: a, places: a.map(|i| dot(across, self.a.corners[i])) };
        let place = |j: usize| dot(across, plus(self.b.corners[j], self.offset));
        (of_a, Span { corners: [b[1], b[0]], places: [place(b[1]), place(b[0])] })
    }

    /// The cores along a direction.
    fn along(&self, Direction { n, is_mean }: Direction<F>) -> Frame<F> {
        let back = n.map(|part| -part);
        let (support_a, support_b) = (support(&self.a, n), support(&self.b, back));
        let separation = dot(n, self.offset) - support_b.height - support_a.height;
        // No edge faces along a mean of directions more than another.
        let (a, b) = if is_mean {
            self.spans(n, support_a.ends, support_b.ends)
        } else {
            self.spans(n, facing_edge(&self.a, &support_a, n), facing_edge(&self.b, &support_b, back))
        };
        let far = self.far();
        if separation > far {
            let (own, other) = self.spans(n, support_a.ends, support_b.ends);
            // The part of B that is over an edge counts before a corner beside it that is nearer, since that one is over a neighbour.
            let is_over = || a.places[0].or_more(b.places[0]) + self.slack < a.places[1].or_less(b.places[1]);
            let is_of_other = |i| self.a.surface.is_some_and(|surface| !surface.is_own(i)) && is_over();
            let near = self.nearest(&own, &other).filter(|(gap, [i, _])| *gap > self.slack && !is_of_other(*i));
            if let Some((_, [i, j])) = near {
                return Frame { n, separation, a, b, facing: Facing::Corners(i, j) };
            }
        }
        let overlap = a.places[1].or_less(b.places[1]) - a.places[0].or_more(b.places[0]);
        let is_point = || overlap >= -self.slack && self.is_point(separation, far, &a, &b);
        let facing =
            if overlap > self.slack || is_point() { Facing::Edges } else { self.apart(separation, far, &a, &b) };
        Frame { n, separation, a, b, facing }
    }

    /// Sharp cores nearer than this have no direction between corners that is worth the name.
    fn far(&self) -> F {
        if self.is_rounded() {
            self.slack
        } else {
            self.slack + self.a.extent().or_less(self.b.extent()) * F::of(1.0 / 2048.0)
        }
    }

    fn is_rounded(&self) -> bool {
        self.a.radius + self.b.radius > F::of(0.0)
    }

    /// Returns true if spans that overlap in one place have a point there.
    fn is_point(&self, separation: F, far: F, a: &Span<F>, b: &Span<F>) -> bool {
        match (a.is_corner(), b.is_corner()) {
            (true, true) => self.is_contact(separation, far),
            (is_corner, other) => is_corner || other,
        }
    }

    fn is_contact(&self, separation: F, far: F) -> bool {
        self.is_rounded() || separation < -self.slack || separation > far
    }

    /// The parts of cores that face each other if no edges overlap.
    fn apart(&self, separation: F, far: F, a: &Span<F>, b: &Span<F>) -> Facing {
        let Some((gap, [i, j])) = self.nearest(a, b) else {
            return Facing::Touching;
        };
        // Segments and points beside each other are apart, on one line even if no normal says so.
        if self.a.corners.len().max(self.b.corners.len()) <= 2 && gap > far {
            return Facing::Corners(i, j);
        }
        if self.is_contact(separation, far) { Facing::Beside(i, j) } else { Facing::Touching }
    }

    /// The corners at the gap of two spans beside each other, and how wide it is; of spans that overlap, the corners at the end where
    /// they overlap less. `None` if it is as much at both.
    pub(super) fn nearest(&self, a: &Span<F>, b: &Span<F>) -> Option<(F, [usize; 2])> {
        let (before, after) = (a.places[0] - b.places[1], b.places[0] - a.places[1]);
        if (before - after).size() <= self.slack {
            return None;
        }
        let at_start = before > after;
        let (end, other) = if at_start { (0, 1) } else { (1, 0) };
        Some((before.or_more(after), [a.corners[end], b.corners[other]]))
    }
}
