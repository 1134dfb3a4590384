//! Free flights beside the engine, in double precision: where the outlines of bodies are, and how near they come to each other.

use umbra_physics::{BodyDef, BodyKind, Fx, Random, Shape, Vec2};

use crate::impacts::scenes::{between, disc, float, floats, number, of_any_size, point, rectangle};

/// The corners of a convex outline, and the radius around them, m.
struct Core {
    corners: Vec<[f64; 2]>,
    radius: f64,
}

/// The flight of a body that nothing touches.
pub(crate) struct Flight {
    position: [f64; 2],
    velocity: [f64; 2],
    acceleration: [f64; 2],
    angle: f64,
    spin: f64,
    cores: Vec<Core>,
    /// The distance of the farthest point from the centre of mass, m.
    reach: f64,
}

impl Flight {
    /// The flight of a body whose colliders lie at its centre of mass.
    pub(crate) fn new(body: &BodyDef, gravity: Vec2) -> Self {
        let outlines = body.colliders.iter().flat_map(|collider| collider.shape.outlines());
        let cores: Vec<Core> = outlines
            .map(|outline| Core {
                corners: outline.corners().iter().map(|&corner| floats(corner)).collect(),
                radius: float(outline.radius()),
            })
            .collect();
        let reach = |core: &Core| core.corners.iter().map(|&corner| length(corner)).fold(0.0, f64::max) + core.radius;
        Self {
            position: floats(body.position),
            velocity: floats(body.velocity),
            acceleration: if body.kind == BodyKind::Dynamic { floats(gravity) } else { [0.0; 2] },
            angle: float(body.angle),
            spin: float(body.angular_velocity),
            reach: cores.iter().map(reach).fold(0.0, f64::max),
            cores,
        }
    }

    fn cores_at(&self, time: f64) -> Vec<Core> {
        let (sin, cos) = (self.angle + self.spin * time).sin_cos();
        let along =
            |axis: usize| self.position[axis] + time * (self.velocity[axis] + time * self.acceleration[axis] / 2.0);
        let centre = [along(0), along(1)];
        let placed = |&[x, y]: &[f64; 2]| [centre[0] + x * cos - y * sin, centre[1] + x * sin + y * cos];
        self.cores
            .iter()
            .map(|core| Core { corners: core.corners.iter().map(placed).collect(), radius: core.radius })
            .collect()
    }
}

/// The least distance of two flights in a duration, m, to an eighth of itself; `None` if they come as near as `limit`.
///
/// By conservative advancement: nothing can close a distance faster than the sum of the speeds of the farthest points.
pub(crate) fn least_distance(flights: [&Flight; 2], duration: f64, limit: f64) -> Option<f64> {
    let [a, b] = flights;
    let (mut time, mut least) = (0.0, f64::INFINITY);
    while time < duration {
        let distance = distance(&a.cores_at(time), &b.cores_at(time));
        least = f64::min(least, distance);
        let relative = |axis: usize| {
            let speed = a.velocity[axis] - b.velocity[axis];
            let acceleration = a.acceleration[axis] - b.acceleration[axis];
            f64::max((speed + acceleration * time).abs(), (speed + acceleration * duration).abs())
        };
        let fastest = length([relative(0), relative(1)]) + a.spin.abs() * a.reach + b.spin.abs() * b.reach;
        let free = distance - limit;
        if free < limit / 8.0 {
            return None;
        }
        time += f64::max(free, 1e-9) / f64::max(fastest, 1e-9) / 8.0 * if free > least { 8.0 } else { 1.0 };
    }
    Some(least)
}

fn distance(a: &[Core], b: &[Core]) -> f64 {
    let pairs = a.iter().flat_map(|a| b.iter().map(move |b| core_distance(a, b) - a.radius - b.radius));
    pairs.fold(f64::INFINITY, f64::min)
}

/// The distance of two convex polygons, segments or points; 0 where they overlap.
fn core_distance(a: &Core, b: &Core) -> f64 {
    if contains(&a.corners, b.corners[0]) || contains(&b.corners, a.corners[0]) {
        return 0.0;
    }
    let edges = |core: &Core| -> Vec<[[f64; 2]; 2]> {
        let corners = &core.corners;
        (0..corners.len()).map(|i| [corners[i], corners[(i + 1) % corners.len()]]).collect()
    };
    let others = edges(b);
    let pairs = edges(a).into_iter().flat_map(|edge| others.iter().map(move |&second| edge_distance(edge, second)));
    pairs.fold(f64::INFINITY, f64::min)
}

/// Returns true if a polygon, its corners counter-clockwise, has this point inside.
fn contains(corners: &[[f64; 2]], inner: [f64; 2]) -> bool {
    let is_left = |i: usize| {
        let [from, to] = [corners[i], corners[(i + 1) % corners.len()]];
        cross(minus(to, from), minus(inner, from)) > 0.0
    };
    corners.len() > 2 && (0..corners.len()).all(is_left)
}

fn edge_distance(a: [[f64; 2]; 2], b: [[f64; 2]; 2]) -> f64 {
    let side = |edge: [[f64; 2]; 2], end: [f64; 2]| cross(minus(edge[1], edge[0]), minus(end, edge[0]));
    if side(a, b[0]) * side(a, b[1]) < 0.0 && side(b, a[0]) * side(b, a[1]) < 0.0 {
        return 0.0;
    }
    let ends = [point_distance(a, b[0]), point_distance(a, b[1]), point_distance(b, a[0]), point_distance(b, a[1])];
    ends.into_iter().fold(f64::INFINITY, f64::min)
}

fn point_distance(edge: [[f64; 2]; 2], end: [f64; 2]) -> f64 {
    let [way, offset] = [minus(edge[1], edge[0]), minus(end, edge[0])];
    let share = (dot(way, offset) / f64::max(dot(way, way), 1e-300)).clamp(0.0, 1.0);
    length(minus(offset, [share * way[0], share * way[1]]))
}

fn minus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

pub(crate) fn length(vector: [f64; 2]) -> f64 {
    vector[0].hypot(vector[1])
}

/// A polygon of 3 to 8 corners on a circle.
pub(crate) fn random_polygon(random: &mut Random, radius: f64) -> Shape {
    loop {
        let mut angles: Vec<f64> =
            (0..random.integer(3..=8)).map(|_| between(random, 0.0, std::f64::consts::TAU)).collect();
        angles.sort_by(f64::total_cmp);
        let corners: Vec<Vec2> = angles.iter().map(|angle| point(radius * angle.cos(), radius * angle.sin())).collect();
        // Corners may be too near to each other.
        if let Ok(shape) = Shape::polygon(&corners) {
            return shape;
        }
    }
}

/// A convex shape within a circle of this radius.
pub(crate) fn random_shape(random: &mut Random, radius: f64) -> Shape {
    loop {
        let shape = shape_of_any_kind(random, radius);
        // Some polygons have hardly a mass.
        if BodyDef::dynamic().with_collider(shape.clone()).check().is_ok() {
            return shape;
        }
    }
}

fn shape_of_any_kind(random: &mut Random, radius: f64) -> Shape {
    let half = radius / 2.0;
    let part = between(random, 0.2, 1.0);
    match random.below(5) {
        0 => disc(number(radius)),
        1 => rectangle(number(1.4 * radius), number(f64::max(1.4 * radius * part, 0.01))),
        2 => Shape::capsule(number(2.0 * half), number(f64::max(half * part, 0.01))).expect("a capsule"),
        3 => Shape::segment(point(-radius, 0.0), point(radius, 0.0)).expect("a segment"),
        _ => random_polygon(random, radius),
    }
}

/// A speed of either sign.
pub(crate) fn random_speed(random: &mut Random, low: f64, high: f64) -> f64 {
    let speed = of_any_size(random, low, high);
    if random.below(2) == 0 { speed } else { -speed }
}

/// An angle, rad.
pub(crate) fn random_angle(random: &mut Random) -> Fx {
    number(0.01 * between(random, 0.0, 628.0))
}
