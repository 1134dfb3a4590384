//! The manifold of a pair by its definition, in exact numbers: all those that the rounding of the narrow phase allows.

use std::cmp::Ordering;

use dashu_int::IBig;
use umbra_physics::collide::{Manifold, feature};

use super::geometry::{Axis, Direction, Pair, Span};
use super::numbers::{Vector, cross, dot, float, sum, ulps};
use super::points::{At, Contact, Point};

/// How two spans face each other.
#[derive(Clone, Copy)]
enum Way {
    /// In this many points.
    Points(usize),
    Beside,
}

/// The manifolds along a direction, and whether edges face each other.
#[derive(Default)]
struct Outcomes {
    contacts: Vec<Option<Contact>>,
    faces: bool,
}

/// The manifolds that a pair may have. Means of directions that tie by rounding are taken near that of the actual manifold alone.
pub(crate) fn expected(pair: &Pair, actual: Option<&Manifold>) -> Vec<Option<Contact>> {
    let axes = pair.axes();
    let Some(best) = axes.iter().max_by(|a, b| a.cmp(b)) else {
        return pair.between_corners(0, 0);
    };
    let mut contacts = Vec::new();
    let beyond = best.value - pair.limit;
    let unsure = if pair.choice > 0.0 { pair.choice.max(pair.bound(best.value)) } else { 0.0 };
    if beyond > 0.0 || beyond > -unsure {
        contacts.push(None);
    }
    if beyond > unsure {
        return contacts;
    }
    let is_near = |axis: &&Axis| axis.cmp(best).is_eq() || axis.value > best.value - pair.choice;
    let closest: Vec<&Axis> = axes.iter().filter(is_near).collect();
    let tied: Vec<&Axis> = axes.iter().filter(|axis| axis.cmp(best).is_eq()).collect();
    let ruled = rule(&tied);
    let Some(direction) = &ruled else {
        contacts.extend(pair.on_one_line());
        contacts.extend(others(pair, &closest, actual));
        return contacts;
    };
    let outcomes = pair.along(direction);
    if !outcomes.faces && pair.choice == 0.0 {
        // Exactly: one other of those that tie whose edges face each other, if all that do have one direction.
        let facing: Vec<&&Axis> = tied.iter().filter(|axis| pair.along(&axis.direction).faces).collect();
        let is_one = facing.iter().all(|axis| is_same(&axis.direction, &facing[0].direction));
        if let (Some(axis), true) = (facing.first(), is_one) {
            contacts.extend(pair.along(&axis.direction).contacts);
            return contacts;
        }
    }
    contacts.extend(outcomes.contacts);
    if closest.len() > 1 && pair.choice > 0.0 {
        contacts.extend(others(pair, &closest, actual));
    }
    contacts
}

fn is_same(a: &Direction, b: &Direction) -> bool {
    cross(&a.normal, &b.normal) == IBig::ZERO && dot(&a.normal, &b.normal) > IBig::ZERO
}

/// The direction of the longest edge of those that tie, or the mean over all that are as long; `None` if they cancel.
fn rule(tied: &[&Axis]) -> Option<Direction> {
    let longest = tied.iter().map(|axis| &axis.direction.square).max()?;
    let longest: Vec<&Direction> =
        tied.iter().map(|axis| &axis.direction).filter(|direction| direction.square == *longest).collect();
    mean(&longest)
}

/// The mean of directions of edges of one length.
fn mean(directions: &[&Direction]) -> Option<Direction> {
    if directions.iter().all(|direction| is_same(direction, directions[0])) {
        return Some(directions[0].clone());
    }
    let zero = [IBig::ZERO, IBig::ZERO];
    let direction = Direction::new(directions.iter().fold(zero, |all, direction| sum(&all, &direction.normal)));
    let length = (float(&direction.square) / float(&directions[0].square)).sqrt();
    let count = directions.len() as f64;
    (length > 1e-6).then(|| Direction { mean_of: Some(count / length), ..direction })
}

/// The manifolds along single directions that are within rounding of the best, and along means of them near the actual normal.
fn others(pair: &Pair, candidates: &[&Axis], actual: Option<&Manifold>) -> Vec<Option<Contact>> {
    if pair.choice == 0.0 {
        return Vec::new();
    }
    let mut contacts = Vec::new();
    for axis in candidates {
        contacts.extend(pair.along(&axis.direction).contacts);
    }
    // All that tie by rounding may cancel.
    let is_opposite = |a: &Axis, b: &Axis| dot(&a.direction.normal, &b.direction.normal) < IBig::ZERO;
    if candidates.iter().any(|a| candidates.iter().any(|b| is_opposite(a, b))) {
        contacts.extend(pair.on_one_line());
    }
    let Some(actual) = actual.filter(|_| candidates.len() <= 12) else {
        return contacts;
    };
    let normal = actual.normal.map(|part| f64::from(part) / 2f64.powi(30));
    for set in 1u32..1 << candidates.len() {
        let some: Vec<&Direction> =
            (0..candidates.len()).filter(|i| set >> i & 1 == 1).map(|i| &candidates[i].direction).collect();
        let Some(direction) = mean(&some).filter(|direction| direction.mean_of.is_some()) else {
            continue;
        };
        let unit = direction.unit();
        if (unit[0] - normal[0]).hypot(unit[1] - normal[1]) < 1e-6 {
            contacts.extend(pair.along(&direction).contacts);
        }
    }
    contacts
}

/// The corners at the gap of two spans beside each other, and how wide it is times `length`; of spans that overlap, those at the end where
/// they overlap less. No corners if it is as much at both.
fn nearest(pair: &Pair, a: &Span, b: &Span, length: f64) -> Vec<Option<(f64, [usize; 2])>> {
    let (before, after) = (&a.places[0] - &b.places[1], &b.places[0] - &a.places[1]);
    let gaps = [&before, &after].map(|gap| ulps(gap) / length);
    let orders = pair.orders(ulps(&(&before - &after)) / length);
    orders
        .map(|order| match order {
            Ordering::Greater => Some((gaps[0], [a.corners[0], b.corners[1]])),
            Ordering::Less => Some((gaps[1], [a.corners[1], b.corners[0]])),
            Ordering::Equal => None,
        })
        .collect()
}

impl Pair {
    /// The manifolds along a direction.
    fn along(&self, n: &Direction) -> Outcomes {
        let length = float(&n.square).sqrt();
        let scaled = self.separation(n);
        let separation = ulps(&scaled) / length;
        let mut outcomes = Outcomes::default();
        for [supports, [a, b]] in self.faces(n) {
            for is_far in self.is_above(separation - self.far) {
                let ends = nearest(self, &supports[0], &supports[1], length);
                let mut is_decided = true;
                for end in ends.into_iter().filter(|_| is_far) {
                    let gap = end.map_or(-1.0, |(gap, _)| gap);
                    for is_gap in self.is_above(gap) {
                        match end {
                            Some((_, [i, j])) if is_gap => outcomes.contacts.extend(self.between_corners(i, j)),
                            _ => is_decided = false,
                        }
                    }
                }
                if !is_far || !is_decided {
                    self.beside_or_facing(n, &scaled, [&a, &b], &mut outcomes);
                }
            }
        }
        outcomes
    }

    /// The manifolds of spans that face each other or lie beside each other.
    fn beside_or_facing(&self, n: &Direction, scaled: &IBig, spans: [&Span; 2], outcomes: &mut Outcomes) {
        let ([a, b], length) = (spans, float(&n.square).sqrt());
        // A corner is inside of an edge, or on its end.
        let overlap = match (a.is_corner(), b.is_corner()) {
            (true, false) => (&a.places[0] - &b.places[0]).min(&b.places[1] - &a.places[0]),
            (false, true) => (&b.places[0] - &a.places[0]).min(&a.places[1] - &b.places[0]),
            _ => (&a.places[1]).min(&b.places[1]) - (&a.places[0]).max(&b.places[0]),
        };
        let touching = self.is_contact(ulps(scaled) / length);
        for order in self.orders(ulps(&overlap) / length) {
            let ways: &[Way] = match (order, a.is_corner(), b.is_corner()) {
                (Ordering::Less, ..) | (Ordering::Equal, false, false) => &[Way::Beside],
                (_, true, true) if touching.len() == 2 => &[Way::Points(1), Way::Beside],
                (_, true, true) if !touching[0] => &[Way::Beside],
                (_, false, false) => &[Way::Points(2)],
                _ => &[Way::Points(1)],
            };
            for way in ways {
                match *way {
                    Way::Points(count) => {
                        outcomes.faces = true;
                        outcomes.contacts.extend(self.clipped(n, scaled, spans, count));
                        // Two ends of an overlap that is hardly one may be at one place.
                        if count == 2 && ulps(&overlap) / length < self.choice {
                            outcomes.contacts.extend(self.clipped(n, scaled, spans, 1));
                        }
                    }
                    Way::Beside => outcomes.contacts.extend(self.beside(n, scaled, spans, &touching)),
                }
            }
        }
    }

    /// Returns true where cores without overlapping edges touch: sharp corners touch if they overlap or are apart.
    fn is_contact(&self, separation: f64) -> Vec<bool> {
        let mut answers = Vec::new();
        for is_far in self.is_above(separation - self.far) {
            for is_deep in self.is_above(-separation) {
                answers.push(self.is_rounded || is_far || is_deep);
            }
        }
        answers.sort_unstable();
        answers.dedup();
        answers
    }

    /// The manifolds of spans that do not overlap.
    fn beside(&self, n: &Direction, scaled: &IBig, [a, b]: [&Span; 2], touching: &[bool]) -> Vec<Option<Contact>> {
        let are_thin = self.cores.iter().all(|core| core.corners.len() <= 2);
        let mut contacts = Vec::new();
        for end in nearest(self, a, b, float(&n.square).sqrt()) {
            let Some((gap, [i, j])) = end else {
                contacts.push(None);
                continue;
            };
            for is_apart in self.is_above(gap - self.far) {
                if are_thin && is_apart {
                    contacts.extend(self.between_corners(i, j));
                    continue;
                }
                for is_contact in touching {
                    contacts.extend(if *is_contact { self.single(n, scaled, i, j) } else { vec![None] });
                }
            }
        }
        contacts
    }

    /// Segments and points on one line that are apart: their ends next to each other.
    fn on_one_line(&self) -> Vec<Option<Contact>> {
        let [a, b] = &self.cores;
        if a.corners.len().max(b.corners.len()) > 2 {
            return vec![None];
        }
        let edge = if a.corners.len() == 2 { a.edge(0) } else { b.edge(0) };
        let length = float(&dot(&edge, &edge)).sqrt();
        let span = |corners: &[Vector]| {
            let mut places: Vec<(IBig, usize)> =
                corners.iter().enumerate().map(|(i, corner)| (dot(&edge, corner), i)).collect();
            places.sort();
            let [first, last] = [&places[0], &places[places.len() - 1]];
            Span { corners: [first.1, last.1], places: [first.0.clone(), last.0.clone()] }
        };
        let mut contacts = Vec::new();
        for end in nearest(self, &span(&a.corners), &span(&b.corners), length) {
            let gap = end.map_or(-1.0, |(gap, _)| gap);
            for is_gap in self.is_above(gap - self.far) {
                match end {
                    Some((_, [i, j])) if is_gap => contacts.extend(self.between_corners(i, j)),
                    _ => contacts.push(None),
                }
            }
        }
        contacts
    }

    /// Edges that overlap: a point at either end, or at one, where it is at most as far as counts.
    fn clipped(&self, n: &Direction, scaled: &IBig, [a, b]: [&Span; 2], ends: usize) -> Vec<Option<Contact>> {
        let length = float(&n.square).sqrt();
        let width = |span: &Span| ulps(&(&span.places[1] - &span.places[0])) / length;
        let is_named = [a, b].iter().all(|span| span.is_corner() || width(span) >= self.choice);
        let mut kept: Vec<Vec<Option<Point>>> = Vec::new();
        for end in 0..ends {
            let (i, j) = (a.corners[end], b.corners[end]);
            let ahead = if end == 0 { &a.places[0] - &b.places[0] } else { &b.places[1] - &a.places[1] };
            let ats: Vec<At> = match (a.is_corner(), b.is_corner()) {
                (true, false) => vec![At::A(i)],
                (false, true) => vec![At::B(j)],
                _ => self.orders(ulps(&ahead) / length).map(|order| At::of(order, i, j)).collect(),
            };
            let name = match (a.is_corner(), b.is_corner()) {
                (false, true) => feature(a.corners, [j, j]),
                (true, false) => feature([i, i], [b.corners[1], b.corners[0]]),
                _ => feature([i, i], [j, j]),
            };
            let mut options = Vec::new();
            for at in ats {
                let mut point = self.point(n, at, &self.height(n, [a, b], at), name);
                point.feature = is_named.then_some(name);
                let radii = (self.cores[0].radius + self.cores[1].radius) as f64;
                let beyond = ulps(&point.separation) + radii - self.limit;
                let unsure = if self.choice > 0.0 { point.bounds[0] } else { 0.0 };
                if beyond > 0.0 || beyond > -unsure {
                    options.push(None);
                }
                if beyond <= unsure {
                    options.push(Some(point));
                }
            }
            kept.push(options);
        }
        self.chosen(n, scaled, [a, b], kept)
    }

    /// The manifolds of each choice of points.
    fn chosen(
        &self,
        n: &Direction,
        scaled: &IBig,
        [a, b]: [&Span; 2],
        kept: Vec<Vec<Option<Point>>>,
    ) -> Vec<Option<Contact>> {
        let mut sets: Vec<Vec<&Point>> = vec![Vec::new()];
        for options in &kept {
            let with =
                |set: &Vec<_>| options.iter().map(|o| set.iter().copied().chain(o).collect()).collect::<Vec<_>>();
            sets = sets.iter().flat_map(with).collect();
        }
        let mut contacts = Vec::new();
        for set in sets {
            if set.is_empty() {
                for end in nearest(self, a, b, float(&n.square).sqrt()) {
                    match end {
                        Some((_, [i, j])) => contacts.extend(self.single(n, scaled, i, j)),
                        None => contacts.push(None),
                    }
                }
                continue;
            }
            let points = set.into_iter().map(Point::copy).collect();
            contacts.push(Some(self.contact(n, points)));
        }
        contacts
    }
}
