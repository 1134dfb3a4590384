//! Measures of poses, in f64: overlap, joint gaps, speeds. The overlap of two convex shapes
//! is the least distance that parts them, by the separating axis test.

use crate::engine::State;
use crate::scene::{Body, Kind, Scene, Shape, Wall, walls};

type Point = [f64; 2];

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn sub(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

/// A point of the body's frame, in the world.
pub fn world_point(q: &State, [x, y]: Point) -> Point {
    let (s, c) = q.angle.sin_cos();
    [q.x + (c * x - s * y), q.y + (s * x + c * y)]
}

/// The distance of the farthest point from the position. For a body without shape, the half
/// length of the thin rod that has its mass and moment of inertia.
pub fn radius(b: &Body) -> f64 {
    match b.shape {
        Shape::None { mass, inertia } => (3.0 * inertia / mass).sqrt(),
        Shape::Circle { r } => r,
        Shape::Box { hx, hy } => hx.hypot(hy),
        Shape::Capsule { half: [x, y], r } => x.hypot(y) + r,
        Shape::Frame { hx, hy, wall } => (hx + wall).hypot(hy + wall),
        Shape::Polygon(c) => c.as_slice().iter().map(|p| p[0].hypot(p[1])).fold(0.0, f64::max),
    }
}

/// The largest speed of a dynamic body, the spin taken at its radius.
pub fn largest_speed(s: &Scene, states: &[State]) -> f64 {
    let dynamic = s.bodies.iter().zip(states).filter(|(b, _)| b.kind == Kind::Dynamic);
    dynamic.map(|(b, q)| q.vx.hypot(q.vy).max(q.w.abs() * radius(b))).fold(0.0, largest)
}

/// The larger number, or NaN if one is.
pub fn largest(a: f64, b: f64) -> f64 {
    if b > a || b.is_nan() { b } else { a }
}

/// The kinetic energy, J.
pub fn kinetic(s: &Scene, states: &[State]) -> f64 {
    let dynamic = s.bodies.iter().zip(states).filter(|(b, _)| b.kind == Kind::Dynamic);
    let energy = dynamic.map(|(b, q)| {
        let (mass, inertia) = b.mass_inertia();
        0.5 * (mass * (q.vx * q.vx + q.vy * q.vy) + inertia * q.w * q.w)
    });
    energy.sum()
}

/// The largest error of a joint, m.
pub fn joint_gap(s: &Scene, states: &[State]) -> f64 {
    let gap = |j: &crate::scene::Joint| {
        let [a, b] = j.anchors(&s.bodies);
        let d = sub(world_point(&states[j.b], b), world_point(&states[j.a], a));
        (d[0].hypot(d[1]) - j.length()).abs()
    };
    s.joints.iter().map(gap).fold(0.0, largest)
}

/// A convex part of a shape in the world: the points within `r` of a polygon, a segment or a point.
struct Placed {
    corners: Vec<Point>,
    r: f64,
    low: Point,
    high: Point,
    fixed: bool,
}

fn places(b: &Body, q: &State) -> Vec<Placed> {
    let placed = |corners: &[Point], r: f64| {
        let corners = corners.iter().map(|&corner| world_point(q, corner)).collect();
        place(corners, r, b.kind != Kind::Dynamic)
    };
    match b.shape {
        Shape::None { .. } => vec![],
        Shape::Circle { r } => vec![placed(&[[0.0; 2]], r)],
        Shape::Capsule { half: [x, y], r } => vec![placed(&[[x, y], [-x, -y]], r)],
        Shape::Box { .. } | Shape::Polygon(_) => vec![placed(b.shape.corners().expect("a polygon").as_slice(), 0.0)],
        Shape::Frame { hx, hy, wall } => {
            let part = |wall: &Wall| {
                let ([x, y], [half_x, half_y]) = (wall.at, wall.half);
                let corners = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]];
                placed(&corners.map(|[side_x, side_y]| [x + side_x * half_x, y + side_y * half_y]), 0.0)
            };
            walls(hx, hy, wall).iter().map(part).collect()
        }
    }
}

fn place(corners: Vec<Point>, r: f64, fixed: bool) -> Placed {
    let bound = |pick: fn(f64, f64) -> f64, grow: f64| {
        [0, 1].map(|k| corners.iter().map(|c: &Point| c[k]).reduce(pick).expect("a corner") + grow)
    };
    let (low, high) = (bound(f64::min, -r), bound(f64::max, r));
    Placed { corners, r, low, high, fixed }
}

/// The signed distance of polygon `p`'s faces to the points: positive if a face parts them.
fn face_separation(p: &[Point], points: &[Point]) -> f64 {
    let face = |k: usize| {
        let (a, b) = (p[k], p[(k + 1) % p.len()]);
        let d = sub(b, a);
        let length = d[0].hypot(d[1]);
        let n = [d[1] / length, -d[0] / length];
        points.iter().map(|&c| dot(sub(c, a), n)).fold(f64::INFINITY, f64::min)
    };
    (0..p.len()).map(face).fold(f64::NEG_INFINITY, f64::max)
}

/// The distance of a point from the polygon's outline.
fn outline_distance(p: &[Point], c: Point) -> f64 {
    let edge = |k: usize| {
        let (a, b) = (p[k], p[(k + 1) % p.len()]);
        let d = sub(b, a);
        let t = (dot(sub(c, a), d) / dot(d, d)).clamp(0.0, 1.0);
        let e = sub(c, [a[0] + t * d[0], a[1] + t * d[1]]);
        e[0].hypot(e[1])
    };
    (0..p.len()).map(edge).fold(f64::INFINITY, f64::min)
}

/// How deep two shapes overlap, 0 or more.
fn depth(a: &Placed, b: &Placed) -> f64 {
    let separation = match (a.corners.len(), b.corners.len()) {
        (1, 1) => {
            let d = sub(a.corners[0], b.corners[0]);
            d[0].hypot(d[1])
        }
        (1, _) | (_, 1) => {
            let (disc, polygon) = if a.corners.len() == 1 { (a, b) } else { (b, a) };
            let inside = face_separation(&polygon.corners, &disc.corners);
            if inside <= 0.0 { inside } else { outline_distance(&polygon.corners, disc.corners[0]) }
        }
        _ => {
            let faces = face_separation(&a.corners, &b.corners).max(face_separation(&b.corners, &a.corners));
            if faces <= 0.0 || a.r + b.r == 0.0 {
                faces
            } else {
                // What is round may pass beside a corner.
                let from = |a: &Placed, b: &Placed| {
                    b.corners.iter().map(|&c| outline_distance(&a.corners, c)).fold(f64::INFINITY, f64::min)
                };
                from(a, b).min(from(b, a))
            }
        }
    };
    (a.r + b.r - separation).max(0.0)
}

/// The deepest overlap of two bodies, at least one of them dynamic, that no joint ties.
pub fn overlap(s: &Scene, states: &[State]) -> f64 {
    let placed = s.bodies.iter().zip(states).enumerate();
    let mut list: Vec<(usize, Placed)> =
        placed.flat_map(|(i, (b, q))| places(b, q).into_iter().map(move |place| (i, place))).collect();
    list.sort_by(|a, b| a.1.low[0].total_cmp(&b.1.low[0]));
    let tied = |i: usize, k: usize| s.joints.iter().any(|j| (j.a, j.b) == (i, k) || (j.a, j.b) == (k, i));
    let mut worst = 0.0;
    for (at, (i, a)) in list.iter().enumerate() {
        for (k, b) in &list[at + 1..] {
            if b.low[0] > a.high[0] {
                break;
            }
            let apart = i == k || b.low[1] > a.high[1] || a.low[1] > b.high[1] || (a.fixed && b.fixed);
            if !apart && !tied(*i, *k) {
                worst = largest(worst, depth(a, b));
            }
        }
    }
    worst
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{arch, flat_drop};

    fn starts(s: &Scene) -> Vec<State> {
        let state = |b: &Body| State { x: b.x, y: b.y, angle: b.angle, ..State::default() };
        s.bodies.iter().map(state).collect()
    }

    #[test]
    fn overlap_of_boxes_and_discs_is_the_least_way_out() {
        let mut s = flat_drop();
        let disc = Body::dynamic(4.0, 0.25, Shape::Circle { r: 0.5 });
        for (y, turned, expected) in [(0.5, 0.0, 0.0), (0.25, 0.0, 0.25), (0.5, 0.25, 0.5f64.sqrt() - 0.5)] {
            (s.bodies[1].y, s.bodies[1].angle) = (y, turned * std::f64::consts::PI);
            assert!((overlap(&s, &starts(&s)) - expected).abs() < 1e-15, "{y} {turned}");
        }
        s.bodies[1] = disc;
        assert_eq!(overlap(&s, &starts(&s)), 0.25);
        s.bodies[1].y = -0.25;
        assert_eq!(overlap(&s, &starts(&s)), 0.75);
        // Beside the corner at (10, 0), 0.3 and 0.4 away from it.
        (s.bodies[1].x, s.bodies[1].y) = (10.3, 0.4);
        assert!(overlap(&s, &starts(&s)) < 1e-15);
        s.bodies[1].shape = Shape::Circle { r: 0.6 };
        assert!((overlap(&s, &starts(&s)) - 0.1).abs() < 1e-14);
        // A capsule whose end is there, on its side and upright.
        s.bodies[1] = Body { angle: -0.5 * std::f64::consts::PI, ..Body::dynamic(12.3, 0.4, Shape::Circle { r: 1.0 }) };
        for (half, x, y) in [([0.0, 2.0], 12.3, 0.4), ([2.0, 0.0], 10.3, 2.4)] {
            (s.bodies[1].shape, s.bodies[1].x, s.bodies[1].y) = (Shape::Capsule { half, r: 0.6 }, x, y);
            assert!((overlap(&s, &starts(&s)) - 0.1).abs() < 1e-14, "{half:?}");
        }
        // The lower wall of a frame is 0.1 deep.
        s.bodies[1] = Body::dynamic(0.0, 3.0, Shape::Frame { hx: 2.0, hy: 3.0, wall: 0.1 });
        assert!((overlap(&s, &starts(&s)) - 0.1).abs() < 1e-14);
    }

    #[test]
    fn moments_of_capsules_and_frames_are_sums_of_thin_strips() {
        for shape in [Shape::Capsule { half: [0.3, 0.4], r: 0.2 }, Shape::Frame { hx: 0.6, hy: 0.4, wall: 0.1 }] {
            let (mass, inertia) = Body::dynamic(0.0, 0.0, shape).mass_inertia();
            let side = 1e-3;
            let inside = |[x, y]: Point| match shape {
                Shape::Capsule { half, r } => outline_distance(&[half, half.map(|c| -c)], [x, y]) < r,
                Shape::Frame { hx, hy, wall } => {
                    (x.abs() < hx + wall && y.abs() < hy + wall) && !(x.abs() < hx && y.abs() < hy)
                }
                _ => false,
            };
            let (mut strips, mut second) = (0.0, 0.0);
            for row in -1000..1000 {
                for column in -1000..1000 {
                    let at = [(f64::from(column) + 0.5) * side, (f64::from(row) + 0.5) * side];
                    if inside(at) {
                        strips += side * side;
                        second += side * side * dot(at, at);
                    }
                }
            }
            assert!((mass - strips).abs() < 1e-3 * mass && (inertia - second).abs() < 1e-3 * inertia, "{shape:?}");
        }
    }

    #[test]
    fn the_stones_of_an_arch_touch_and_overlap_nowhere() {
        let s = arch(15, 5.0, 6.0);
        assert!(overlap(&s, &starts(&s)) < 1e-12);
        let mut higher = starts(&s);
        higher[8].y -= 0.01;
        assert!(overlap(&s, &higher) > 1e-3);
    }
}
