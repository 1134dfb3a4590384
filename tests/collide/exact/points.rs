//! Points of expected manifolds, and the bounds on their errors.

use std::cmp::Ordering;

use dashu_int::IBig;
use umbra_physics::collide::feature;

use super::geometry::{Direction, Pair, Span};
use super::numbers::{FRACTION, Vector, across, dot, float, over_root, sub, sum, ulps};

/// A point of an expected manifold, in units of 2^-32 ulp.
#[derive(Debug)]
pub(crate) struct Point {
    /// Relative to the centre of A.
    pub(crate) at: Vector,
    /// The separation of the surfaces.
    pub(crate) separation: IBig,
    /// `None` for an edge whose corners are at one place but for rounding: either one may be the first.
    pub(crate) feature: Option<u32>,
    /// The errors that the separation and the place may have, ulps.
    pub(crate) bounds: [f64; 2],
}

/// An expected manifold.
#[derive(Debug)]
pub(crate) struct Contact {
    pub(crate) normal: [f64; 2],
    /// The error of a component of the normal, in units of 2^-30.
    pub(crate) bound: f64,
    pub(crate) points: Vec<Point>,
}

/// The corner that a point is at.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum At {
    A(usize),
    B(usize),
    Both(usize, usize),
}

impl At {
    /// The corner that is ahead of the other, towards the middle of the overlap.
    pub(crate) fn of(ahead: Ordering, i: usize, j: usize) -> Self {
        match ahead {
            Ordering::Greater => Self::A(i),
            Ordering::Less => Self::B(j),
            Ordering::Equal => Self::Both(i, j),
        }
    }
}

/// A separation times the length of the normal, as a fraction.
pub(crate) struct Height {
    num: IBig,
    den: IBig,
    /// The slope of the separation over the place, and its change in all, ulps.
    slope: f64,
    change: f64,
}

impl Pair {
    /// The bound on the error of a separation of the cores, ulps. Corners of A and of B are rounded to ulps, which is 0.71 each along a
    /// normal; distances of corners to nearest, which is 0.5; a mean of two is rounded down; unit vectors are to 2^-30.
    pub(crate) fn bound(&self, separation: f64) -> f64 {
        3.0 + (self.cores[0].extent.max(self.cores[1].extent) + separation.abs()) / 2f64.powi(30)
    }

    /// The bound on the error of the separation in a point between two corners, less that of others, ulps. It is the depth of the deepest
    /// corners, which may be at the far ends of edges.
    pub(crate) fn far_ends(&self) -> f64 {
        let [a, b] = &self.cores;
        (a.size() + b.size() - a.extent.max(b.extent)) / 2f64.powi(30)
    }

    /// Two corners that are apart.
    pub(crate) fn between_corners(&self, i: usize, j: usize) -> Vec<Option<Contact>> {
        let n = Direction::new(self.apart(i, j));
        if n.square == IBig::ZERO {
            return vec![None];
        }
        let distance = ulps(&over_root(&n.square, &n.square));
        let mut contacts = self.single(&n, &n.square, i, j);
        if distance < 2.0 && self.choice > 0.0 {
            contacts.push(None);
        }
        // Corners are rounded to ulps, each by half of one in a component.
        let bound = 1.0 + 1.5 * 2f64.powi(30) / distance;
        for contact in contacts.iter_mut().flatten() {
            contact.bound = bound;
            // A radius is turned with the normal.
            let turned = bound.min(2f64.powi(31)) / 2f64.powi(30);
            let arms = distance + (self.cores[0].radius - self.cores[1].radius).abs() as f64;
            contact.points[0].bounds[1] += turned * arms;
        }
        contacts
    }

    /// One point between two corners.
    pub(crate) fn single(&self, n: &Direction, scaled: &IBig, i: usize, j: usize) -> Vec<Option<Contact>> {
        let separation = ulps(scaled) / float(&n.square).sqrt();
        let height = Height { num: scaled.clone(), den: IBig::ONE, slope: 0.0, change: 0.0 };
        let mut contacts = Vec::new();
        let unsure = if self.choice > 0.0 { self.bound(separation) + self.far_ends() } else { 0.0 };
        if separation <= self.limit + unsure {
            let mut point = self.point(n, At::Both(i, j), &height, feature([i; 2], [j; 2]));
            point.bounds = point.bounds.map(|bound| bound + self.far_ends());
            contacts.push(Some(self.contact(n, vec![point])));
        }
        if separation > self.limit || separation > self.limit - unsure {
            contacts.push(None);
        }
        contacts
    }

    pub(crate) fn contact(&self, n: &Direction, points: Vec<Point>) -> Contact {
        Contact { normal: n.unit(), bound: n.mean_of.unwrap_or(1.0).max(1.0), points }
    }

    /// The separation of the cores where a corner is.
    pub(crate) fn height(&self, n: &Direction, [a, b]: [&Span; 2], at: At) -> Height {
        let along = |i: usize, j: usize| dot(&n.normal, &self.apart(i, j));
        let across = across(&n.normal);
        let (span, place, [from, to]) = match at {
            At::Both(i, j) => return Height { num: along(i, j), den: IBig::ONE, slope: 0.0, change: 0.0 },
            At::A(i) => (b, dot(&across, &self.cores[0].corners[i]), b.corners.map(|j| along(i, j))),
            At::B(j) => (a, dot(&across, &self.cores[1].corners[j]), a.corners.map(|i| along(i, j))),
        };
        // A place that is outside by rounding is at the end.
        let place = place.min(span.places[1].clone()).max(span.places[0].clone());
        let (before, after) = (&place - &span.places[0], &span.places[1] - &place);
        let width = &before + &after;
        let (difference, length) = (float(&(&to - &from)).abs(), float(&n.square).sqrt());
        let change = difference / length / 2f64.powi(FRACTION as i32);
        if width <= IBig::ZERO {
            let slope = if self.choice > 0.0 { f64::INFINITY } else { 0.0 };
            return Height { num: from.min(to), den: IBig::ONE, slope, change };
        }
        Height { num: &from * &after + &to * &before, slope: difference / float(&width), change, den: width }
    }

    /// The point at a corner, in the middle between the surfaces.
    pub(crate) fn point(&self, n: &Direction, at: At, height: &Height, feature: u32) -> Point {
        let [a, b] = &self.cores;
        let radius = |core: i64| IBig::from(core) << FRACTION;
        let between = |first: i64, second: i64| {
            let (along, turned) = (&height.den * &n.square, radius(first) - radius(second));
            [0, 1].map(|c| {
                let part = &n.normal[c];
                (part * &height.num / &along + over_root(&(part * &turned), &n.square)) >> 1
            })
        };
        let from_a = |i: usize| sum(&a.corners[i], &between(a.radius, b.radius));
        let from_b = |j: usize| sub(&b.corners[j], &between(b.radius, a.radius));
        let at = match at {
            At::A(i) => from_a(i),
            At::B(j) => from_b(j),
            At::Both(i, j) => sum(&from_a(i), &from_b(j)).map(|part| part >> 1),
        };
        let core = over_root(&height.num, &(&n.square * &height.den * &height.den));
        let bound = self.bound(ulps(&core));
        let place = bound + 2.0 * self.unit;
        // Ends within 4 ulps of one height, each rounded by 1.21, count as level: at the mean of both.
        let level = if self.choice > 0.0 && height.change < 6.5 { height.change / 2.0 } else { 0.0 };
        let of_separation = bound + (height.slope * place).min(height.change).max(level);
        let turned = n.mean_of.unwrap_or(1.0) / 2f64.powi(30);
        let arms = (ulps(&core).abs() + (a.radius - b.radius).abs() as f64) * turned;
        let bounds = [
            of_separation + ulps(&core).abs() * turned * f64::from(n.mean_of.is_some()),
            bound + of_separation / 2.0 + arms,
        ];
        Point { at, separation: core - radius(a.radius) - radius(b.radius), feature: Some(feature), bounds }
    }
}

impl Point {
    pub(crate) fn copy(&self) -> Self {
        Self { at: self.at.clone(), separation: self.separation.clone(), ..*self }
    }
}
