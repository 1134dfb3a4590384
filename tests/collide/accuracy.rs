//! Manifolds against distances and separations in floats: offsets are small, so that doubles err by less than 2^-43 m.

use super::cases;
use crate::collide::pairs::{Case, KINDS, Recipe, random_case};
use crate::collide::random::SplitMix;
use std::f64::consts::TAU;
use umbra_physics::collide::{Manifold, ManifoldPoint};
use umbra_physics::{Fx, Shape, Turn, Vec2, fx};

pub(crate) type Point = [f64; 2];

pub(crate) const ULP: f64 = 1.0 / 4_294_967_296.0;

pub(crate) fn to_f64(value: Fx) -> f64 {
    value.to_bits() as f64 * ULP
}

fn sub(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

fn add_scaled(a: Point, n: Point, length: f64) -> Point {
    [a[0] + length * n[0], a[1] + length * n[1]]
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn length(a: Point) -> f64 {
    a[0].hypot(a[1])
}

/// A core in world axes relative to the centre of A.
struct Core {
    corners: Vec<Point>,
    radius: f64,
}

impl Core {
    fn new(shape: &Shape, angle: Turn, offset: Point) -> Self {
        let outline = &shape.outlines()[0];
        // Less than half a turn either way: as a double it is as fine as at zero.
        let (sin, cos) = (angle.to_bits() as i64 as f64 / 2f64.powi(64) * TAU).sin_cos();
        let place = |v: &Vec2| {
            let (x, y) = (to_f64(v.x), to_f64(v.y));
            [x * cos - y * sin + offset[0], x * sin + y * cos + offset[1]]
        };
        Self { corners: outline.corners().iter().map(place).collect(), radius: to_f64(outline.radius()) }
    }

    fn edges(&self) -> impl Iterator<Item = [Point; 2]> {
        (0..self.corners.len()).map(|i| [self.corners[i], self.corners[(i + 1) % self.corners.len()]])
    }

    /// The distance of a point from the boundary.
    fn distance(&self, point: Point) -> f64 {
        let to_edge = |[p, q]: [Point; 2]| {
            let (along, to) = (sub(q, p), sub(point, p));
            let square = dot(along, along);
            let share = if square > 0.0 { (dot(along, to) / square).clamp(0.0, 1.0) } else { 0.0 };
            length(sub(to, [share * along[0], share * along[1]]))
        };
        self.edges().map(to_edge).fold(f64::MAX, f64::min)
    }

    /// The largest separation of another core along a normal of this one.
    fn separation(&self, rhs: &Self) -> f64 {
        if self.corners.len() < 2 {
            return f64::MIN;
        }
        let along = |[p, q]: [Point; 2]| {
            let edge = sub(q, p);
            let n = [edge[1] / length(edge), -edge[0] / length(edge)];
            rhs.corners.iter().map(|&c| dot(n, sub(c, p))).fold(f64::MAX, f64::min)
        };
        self.edges().map(along).fold(f64::MIN, f64::max)
    }

    /// The largest distance of two corners.
    fn size(&self) -> f64 {
        let from = |c: &Point| self.corners.iter().map(|&corner| length(sub(*c, corner))).fold(0.0, f64::max);
        self.corners.iter().map(from).fold(0.0, f64::max)
    }

    fn extent(&self, centre: Point) -> f64 {
        let far = |c: &Point| (c[0] - centre[0]).abs().max((c[1] - centre[1]).abs());
        self.corners.iter().map(far).fold(0.0, f64::max)
    }
}

/// A pair in floats.
struct Pair {
    a: Core,
    b: Core,
    /// The largest separation along a normal.
    separation: f64,
    /// The distance of the cores, if they are apart.
    distance: f64,
    /// Sharp corners nearer than this have no direction between them.
    far: f64,
}

impl Pair {
    fn new(case: &Case) -> Self {
        let shapes = case.shapes();
        let offset = case.positions[1] - case.positions[0];
        let offset = [to_f64(offset.x), to_f64(offset.y)];
        let a = Core::new(&shapes[0], case.angles[0], [0.0; 2]);
        let b = Core::new(&shapes[1], case.angles[1], offset);
        let between = a.corners.iter().map(|&c| b.distance(c)).chain(b.corners.iter().map(|&c| a.distance(c)));
        let distance = between.fold(f64::MAX, f64::min);
        let separation = a.separation(&b).max(b.separation(&a));
        let sharp = a.radius + b.radius == 0.0;
        let far = if sharp { a.extent([0.0; 2]).min(b.extent(offset)) / 2048.0 } else { 0.0 };
        Self { a, b, separation, distance, far }
    }

    /// The documented error of a separation.
    fn tolerance(&self) -> f64 {
        let sizes = [self.a.size(), self.b.size()];
        // Nearer along every normal than they are: two corners are nearest.
        let is_between_corners = self.distance > self.separation + ULP;
        let size = if is_between_corners { sizes[0] + sizes[1] } else { sizes[0].max(sizes[1]) };
        let distance = if self.separation > 0.0 { self.distance } else { 0.0 };
        3.0 * ULP + (size + distance) * 2f64.powi(-30)
    }

    /// The separation that the manifold's nearest point is due, if it is sure.
    fn expected(&self) -> f64 {
        let discs = self.a.corners.len() == 1 && self.b.corners.len() == 1;
        if discs || self.separation > self.far { self.distance } else { self.separation }
    }
}

/// Counts of what was seen of a kind of pair.
#[derive(Debug, Default)]
struct Seen {
    touching: usize,
    two_points: usize,
    /// Points off the boundary of a core, where the cores overlap deeply.
    beside: usize,
    /// The largest error of a separation, in units of the tolerance.
    worst: f64,
}

fn check_points(case: &Case, pair: &Pair, manifold: &Manifold, tally: &mut Seen) {
    let n = manifold.normal.map(|part| f64::from(part) / 2f64.powi(30));
    assert!((length(n) - 1.0).abs() < 2f64.powi(-29), "{case:?}");
    for point in &manifold.points[..manifold.count] {
        let ManifoldPoint { arm_a, arm_b, separation, .. } = *point;
        let apart = arm_a - arm_b - (case.positions[1] - case.positions[0]);
        assert!(apart.x.to_bits().abs() <= 1 && apart.y.to_bits().abs() <= 1, "{case:?}");
        // From the point to either core.
        let (point, half) = ([to_f64(arm_a.x), to_f64(arm_a.y)], to_f64(separation) / 2.0);
        let on_a = add_scaled(point, n, -half - pair.a.radius);
        let on_b = add_scaled(point, n, half + pair.b.radius);
        let off = pair.a.distance(on_a).max(pair.b.distance(on_b));
        if off > 1e-7 {
            assert!(pair.separation < 0.0, "{off} m off: {case:?}\n{manifold:?}");
            tally.beside += 1;
        }
    }
}

fn check(case: &Case, tally: &mut Seen) {
    let pair = Pair::new(case);
    let radii = pair.a.radius + pair.b.radius;
    let (expected, margin) = (pair.expected() - radii, to_f64(case.margin));
    let tolerance = pair.tolerance();
    // Within rounding of a choice.
    if (expected - margin).abs() < tolerance || (pair.separation - pair.far).abs() < tolerance {
        return;
    }
    let Some(manifold) = case.manifold() else {
        let touches = pair.far > 0.0 && pair.separation > -tolerance && pair.separation < pair.far;
        assert!(expected > margin || touches, "{expected} m apart: {case:?}");
        return;
    };
    assert!(expected < margin, "{expected} m apart: {case:?}");
    tally.touching += 1;
    tally.two_points += usize::from(manifold.count == 2);
    check_points(case, &pair, &manifold, tally);
    let nearest = manifold.points[..manifold.count].iter().map(|p| to_f64(p.separation)).fold(f64::MAX, f64::min);
    let error = (nearest - expected).abs() / tolerance;
    tally.worst = tally.worst.max(error);
    assert!(error < 1.0, "{nearest}, not {expected}: {case:?}\n{manifold:?}");
}

#[test]
fn separations_are_those_of_floats() {
    for (i, first) in KINDS.into_iter().enumerate() {
        for second in &KINDS[i..] {
            let mut random = SplitMix::seeded(7 + i as u64);
            let mut tally = Seen::default();
            for _ in 0..cases() / 5 {
                let exponents = [30, 33].map(|e| (e + random.between(-3, 2)) as u32);
                let mut case = random_case(&mut random, [first, second], exponents);
                // Near the origin, doubles hold the corners.
                case.margin = if random.between(0, 2) == 0 { case.margin } else { fx!(0.05) };
                check(&case, &mut tally);
            }
            println!("{first}, {second}: {tally:?}");
            assert!(tally.touching > cases() / 100, "{first}, {second}: {tally:?}");
            assert!(tally.beside * 100 < tally.touching, "{first}, {second}: {tally:?}");
        }
    }
}

#[test]
fn boxes_on_long_floors_keep_their_precision() {
    let mut random = SplitMix::seeded(23);
    let mut worst = 0f64;
    for _ in 0..cases() {
        let half = random.between(50, 1_000);
        let floor = Recipe::Rectangle(Fx::from_int(2 * half as i32), fx!(2));
        let crate_ = Recipe::Rectangle(fx!(1), fx!(1));
        let tilt = Turn::from_bits(random.next());
        let place = random.between(-(half - 2) << 32, (half - 2) << 32);
        let height = (3 << 31) + random.between(-1 << 26, 1 << 26);
        let along = |x: i64, y: i64| {
            let v = Vec2::new(Fx::from_bits(x), Fx::from_bits(y));
            tilt.rotate(v).and_then(|v| v.try_map(umbra_physics::FxWide::to_scalar)).expect("small")
        };
        let case = Case {
            recipes: [floor, crate_],
            positions: [Vec2::default(), along(place, height)],
            angles: [tilt, tilt],
            margin: fx!(0.02),
        };
        let manifold = case.manifold().expect("a contact");
        assert_eq!(manifold.count, 2, "{case:?}");
        for point in manifold.points {
            worst = worst.max((to_f64(point.separation) - (height - (3 << 31)) as f64 * ULP).abs() / ULP);
        }
    }
    println!("worst: {worst} ulp");
    assert!(worst <= 4.0, "{worst} ulp");
}
