//! Cores of a pair, and what of them faces a direction.
//!
//! Where a choice is within the rounding of the narrow phase, both ways are taken.

use std::cmp::Ordering;

use dashu_int::IBig;
use umbra_physics::Outline;

use super::numbers::{FRACTION, Vector, across, cross, direction, dot, float, sub, sum, sum_over_roots, turned, ulps};
use crate::collide::pairs::Case;

/// A core in world axes relative to the centre of A's body.
pub(crate) struct Core {
    pub(crate) corners: Vec<Vector>,
    /// ulps.
    pub(crate) radius: i64,
    /// The largest coordinate relative to the centre of the own body, ulps.
    pub(crate) extent: f64,
}

/// Two cores, A and B, and how far apart they may be.
pub(crate) struct Pair {
    pub(crate) cores: [Core; 2],
    /// The largest separation of cores that counts, ulps.
    pub(crate) limit: f64,
    /// Sharp corners nearer than this have no direction between them, ulps.
    pub(crate) far: f64,
    pub(crate) is_rounded: bool,
    /// The unit of choices, ulps.
    pub(crate) unit: f64,
    /// Choices by a difference of lengths below this may go either way, ulps. 0: exact choices.
    pub(crate) choice: f64,
    /// Choices by an angle between directions below this may go either way.
    pub(crate) angle: f64,
}

/// A direction from A to B.
#[derive(Clone, Debug)]
pub(crate) struct Direction {
    pub(crate) normal: Vector,
    pub(crate) square: IBig,
    /// The number of normals that it is the mean of, divided by the length of their sum.
    pub(crate) mean_of: Option<f64>,
}

impl Direction {
    pub(crate) fn new(normal: Vector) -> Self {
        let square = dot(&normal, &normal);
        Self { normal, square, mean_of: None }
    }

    /// The normal as a unit vector.
    pub(crate) fn unit(&self) -> [f64; 2] {
        let length = float(&self.square).sqrt();
        [float(&self.normal[0]) / length, float(&self.normal[1]) / length]
    }
}

/// A normal of an edge, and the separation along it.
#[derive(Debug)]
pub(crate) struct Axis {
    pub(crate) direction: Direction,
    /// Times the length of the normal.
    pub(crate) separation: IBig,
    /// ulps.
    pub(crate) value: f64,
}

impl Axis {
    /// Compares separations, exactly.
    pub(crate) fn cmp(&self, rhs: &Self) -> Ordering {
        let (zero, own_value, rhs_value) = (IBig::ZERO, &self.separation, &rhs.separation);
        let (square, other_square) = (&self.direction.square, &rhs.direction.square);
        let magnitudes = || (own_value * own_value * other_square).cmp(&(rhs_value * rhs_value * square));
        match (*own_value >= zero, *rhs_value >= zero) {
            (true, true) => magnitudes(),
            (false, false) => magnitudes().reverse(),
            (lhs, rhs) => lhs.cmp(&rhs),
        }
    }
}

/// An edge or a corner in order of place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Span {
    pub(crate) corners: [usize; 2],
    pub(crate) places: [IBig; 2],
}

impl Span {
    pub(crate) fn is_corner(&self) -> bool {
        self.corners[0] == self.corners[1]
    }
}

impl Core {
    fn new(outline: &Outline, turn: &[IBig; 2], offset: &Vector) -> Self {
        let turned_corners: Vec<Vector> = outline.corners().iter().map(|&corner| turned(corner, turn)).collect();
        let extent = turned_corners.iter().flatten().map(|part| ulps(part).abs()).fold(0.0, f64::max);
        let corners = turned_corners.iter().map(|corner| sum(corner, offset)).collect();
        Self { corners, radius: outline.radius().to_bits(), extent }
    }

    fn corner(&self, i: usize) -> &Vector {
        &self.corners[i % self.corners.len()]
    }

    pub(crate) fn edge(&self, i: usize) -> Vector {
        sub(self.corner(i + 1), self.corner(i))
    }

    /// The outward normal of an edge, as long as the edge.
    fn normal(&self, i: usize) -> Vector {
        let [x, y] = self.edge(i);
        [y, -x]
    }

    /// The largest distance of two corners, ulps.
    pub(crate) fn size(&self) -> f64 {
        let pairs = self.corners.iter().flat_map(|p| self.corners.iter().map(move |q| sub(p, q)));
        pairs.map(|[x, y]| ulps(&x).hypot(ulps(&y))).fold(0.0, f64::max)
    }

    fn edges(&self) -> usize {
        if self.corners.len() == 1 { 0 } else { self.corners.len() }
    }

    /// The largest component of a corner along `w`, times its length.
    fn height(&self, w: &Vector) -> IBig {
        self.corners.iter().map(|corner| dot(w, corner)).max().expect("a corner")
    }

    /// The farthest corners along `w`, from the first to the last counter-clockwise.
    fn supports(&self, w: &Direction, pair: &Pair) -> Vec<[usize; 2]> {
        let (height, length) = (self.height(&w.normal), float(&w.square).sqrt());
        let below =
            |i: usize| float(&(&height - dot(&w.normal, &self.corners[i]))) / length / 2f64.powi(FRACTION as i32);
        let mut depths: Vec<(f64, usize)> = (0..self.corners.len()).map(|i| (below(i), i)).collect();
        depths.sort_by(|a, b| a.0.total_cmp(&b.0));
        // Rounding of the reference itself is far below 2^-8 ulp.
        let flat = if pair.choice > 0.0 { 1.0 / 256.0 } else { 0.0 };
        let min_count = depths.iter().filter(|(below, _)| *below <= flat).count();
        let max_count = depths.iter().filter(|(below, _)| *below <= pair.choice).count().max(min_count);
        let across = across(&w.normal);
        let mut supports = Vec::new();
        for count in min_count..=max_count {
            let corners = depths[..count].iter().map(|&(below, i)| (dot(&across, &self.corners[i]), below, i));
            let (mut first, mut last) = (depths[0].1, depths[0].1);
            let key = |i: usize| dot(&across, &self.corners[i]);
            for (place, _, i) in corners {
                first = if place < key(first) { i } else { first };
                last = if place > key(last) { i } else { last };
            }
            if !supports.contains(&[first, last]) {
                supports.push([first, last]);
            }
        }
        supports
    }

    /// The edge that faces along `w`: that of the support, or of the two beside a corner the one whose normal is nearer to `w`; the corner
    /// itself if both are as near.
    fn facing(&self, support: [usize; 2], w: &Direction, pair: &Pair) -> Vec<[usize; 2]> {
        let ([corner, last], count) = (support, self.corners.len());
        if corner != last || count == 1 {
            return vec![support];
        }
        let (before, after) = ((corner + count - 1) % count, (corner + 1) % count);
        // How far the middle of the two normals is counter-clockwise of `w`.
        let (normal_after, normal_before) = (self.normal(corner), self.normal(before));
        let sine = if count == 2 {
            let out = sub(&self.corners[corner], &self.corners[after]);
            float(&cross(&w.normal, &out)) / float(&dot(&out, &out)).sqrt()
        } else {
            let (c, d) = (cross(&w.normal, &normal_after), cross(&w.normal, &normal_before));
            sum_over_roots([&c, &dot(&normal_after, &normal_after)], [&d, &dot(&normal_before, &normal_before)])
        } / float(&w.square).sqrt();
        let length = |edge: &Vector| ulps(&edge[0]).hypot(ulps(&edge[1]));
        let fuzz = pair.angle + pair.choice / length(&self.edge(before)).min(length(&self.edge(corner)));
        let mut edges = Vec::new();
        let mut add = |edge: [usize; 2]| {
            let along = sub(&self.corners[edge[1]], &self.corners[edge[0]]);
            let across = float(&cross(&w.normal, &along)) / float(&w.square).sqrt() / 2f64.powi(FRACTION as i32);
            for is_wide in pair.is_above(across) {
                let edge = if is_wide { edge } else { [corner; 2] };
                if !edges.contains(&edge) {
                    edges.push(edge);
                }
            }
        };
        if sine > -fuzz && (sine > 0.0 || fuzz > 0.0) {
            add([before, corner]);
        }
        if sine < fuzz && (sine < 0.0 || fuzz > 0.0) {
            add([corner, after]);
        }
        if sine.abs() <= fuzz {
            add([corner; 2]);
        }
        edges
    }
}

impl Pair {
    /// A pair, whose choices are taken exactly or within the rounding of the narrow phase.
    pub(crate) fn new(case: &Case, is_exact: bool) -> Self {
        let shapes = case.shapes();
        let offset = [case.positions[0], case.positions[1]].map(|p| [p.x, p.y].map(|part| IBig::from(part.to_bits())));
        let offset = sub(&offset[1], &offset[0]).map(|part| part << FRACTION);
        let origin = [IBig::ZERO, IBig::ZERO];
        let core = |i: usize, at: &Vector| Core::new(&shapes[i].outlines()[0], &direction(case.angles[i]), at);
        let cores = [core(0, &origin), core(1, &offset)];
        let [a, b] = &cores;
        let apart = ulps(&offset[0]).abs().max(ulps(&offset[1]).abs());
        let total = a.extent + b.extent + apart;
        let smaller = (a.extent + a.radius as f64).min(b.extent + b.radius as f64);
        let is_rounded = a.radius + b.radius > 0;
        // Choices are by corners in units of 2^-29 of the pair's size, and at most 2^-25 of the smaller one's; by normals to 2^-30.
        let unit = (total / 2f64.powi(29)).min(smaller / 2f64.powi(25));
        let choice = 4.0 + a.extent.max(b.extent) / 2f64.powi(28) + 8.0 * unit;
        let margin = case.margin.to_bits().clamp(0, 1 << 54);
        let limit = (margin + a.radius + b.radius) as f64;
        let far = if is_rounded { 0.0 } else { (a.extent.min(b.extent) / 2048.0).floor() };
        let [choice, angle] = if is_exact { [0.0; 2] } else { [choice, 1.0 / 2f64.powi(27)] };
        Self { cores, limit, far, is_rounded, unit, choice, angle }
    }

    /// How a length may compare with 0.
    pub(crate) fn orders(&self, length: f64) -> impl Iterator<Item = Ordering> + use<> {
        let (choice, actual) = (self.choice, length.total_cmp(&0.0));
        // Negative zero is none.
        let actual = if length == 0.0 { Ordering::Equal } else { actual };
        let all = [Ordering::Less, Ordering::Equal, Ordering::Greater];
        all.into_iter().filter(move |&order| order == actual || length.abs() < choice)
    }

    /// The answers to the question whether a length is above 0.
    pub(crate) fn is_above(&self, length: f64) -> impl Iterator<Item = bool> + use<> {
        let (choice, actual) = (self.choice, length > 0.0);
        [true, false].into_iter().filter(move |&answer| answer == actual || length.abs() < choice)
    }

    /// Separations along all normals.
    pub(crate) fn axes(&self) -> Vec<Axis> {
        let [a, b] = &self.cores;
        let axis = |normal: Vector, separation: IBig| {
            let direction = Direction::new(normal);
            let value = ulps(&separation) / float(&direction.square).sqrt();
            Axis { direction, separation, value }
        };
        let of_a = (0..a.edges()).map(|i| {
            let n = a.normal(i);
            let least = b.corners.iter().map(|corner| dot(&n, &sub(corner, &a.corners[i]))).min().expect("a corner");
            axis(n, least)
        });
        let of_b = (0..b.edges()).map(|j| {
            let n = super::numbers::negated(&b.normal(j));
            let least = a.corners.iter().map(|corner| dot(&n, &sub(&b.corners[j], corner))).min().expect("a corner");
            axis(n, least)
        });
        of_a.chain(of_b).collect()
    }

    /// The number of normals with exactly the largest separation.
    pub(crate) fn ties(&self) -> usize {
        let axes = self.axes();
        let best = axes.iter().max_by(|a, b| a.cmp(b));
        best.map_or(0, |best| axes.iter().filter(|axis| axis.cmp(best).is_eq()).count())
    }

    /// The separation along a direction, times the length of its normal.
    pub(crate) fn separation(&self, direction: &Direction) -> IBig {
        let [a, b] = &self.cores;
        -b.height(&super::numbers::negated(&direction.normal)) - a.height(&direction.normal)
    }

    pub(crate) fn apart(&self, i: usize, j: usize) -> Vector {
        sub(&self.cores[1].corners[j], &self.cores[0].corners[i])
    }

    /// Supports of A and of B, and the spans that face each other, as `[supports, facing]`.
    pub(crate) fn faces(&self, n: &Direction) -> Vec<[[Span; 2]; 2]> {
        let [a, b] = &self.cores;
        let back = Direction { normal: super::numbers::negated(&n.normal), ..n.clone() };
        let across = across(&n.normal);
        let span = |core: &Core, corners: [usize; 2]| Span {
            corners,
            places: corners.map(|i| dot(&across, &core.corners[i])),
        };
        let spans = |of_a: [usize; 2], of_b: [usize; 2]| [span(a, of_a), span(b, [of_b[1], of_b[0]])];
        let mut faces = Vec::new();
        for of_a in a.supports(n, self) {
            for of_b in b.supports(&back, self) {
                let supports = spans(of_a, of_b);
                if n.mean_of.is_some() {
                    faces.push([supports.clone(), supports]);
                    continue;
                }
                for facing_a in a.facing(of_a, n, self) {
                    for facing_b in b.facing(of_b, &back, self) {
                        faces.push([supports.clone(), spans(facing_a, facing_b)]);
                    }
                }
            }
        }
        faces
    }

    /// The largest distance of a corner from the line through its neighbours that counts as none, ulps.
    pub(crate) fn flatness(&self) -> f64 {
        let corners = self.cores.iter().flat_map(|core| (0..core.corners.len()).map(move |i| (core, i)));
        let height = |(core, i): (&Core, usize)| {
            let before = core.corner(i + core.corners.len() - 1);
            let (line, to) = (sub(core.corner(i + 1), before), sub(core.corner(i), before));
            if core.corners.len() < 3 { 0.0 } else { ulps(&cross(&line, &to)).abs() / float(&dot(&line, &line)).sqrt() }
        };
        corners.map(height).filter(|height| *height < self.choice).fold(0.0, f64::max)
    }

    /// The distance of the cores, if they are apart, ulps.
    pub(crate) fn distance(&self) -> Option<f64> {
        let [a, b] = &self.cores;
        if self.axes().iter().all(|axis| axis.separation <= IBig::ZERO) && a.edges() + b.edges() > 0 {
            return None;
        }
        let to_edge = |core: &Core, point: &Vector, i: usize| {
            let (edge, to) = (core.edge(i), sub(point, core.corner(i)));
            let (along, square) = (dot(&edge, &to), dot(&edge, &edge));
            if along <= IBig::ZERO || along >= square {
                return f64::MAX;
            }
            ulps(&cross(&edge, &to)).abs() / float(&square).sqrt()
        };
        let mut least = f64::MAX;
        for p in &a.corners {
            for q in &b.corners {
                let [x, y] = sub(p, q);
                least = least.min(ulps(&x).hypot(ulps(&y)));
            }
        }
        for (core, second) in [(a, b), (b, a)] {
            for point in &second.corners {
                least = (0..core.edges()).map(|i| to_edge(core, point, i)).fold(least, f64::min);
            }
        }
        Some(least)
    }
}
