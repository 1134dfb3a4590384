//! Engine-neutral scene descriptions, in f64. Everything is generated from integer
//! arithmetic and a fixed LCG, so every engine gets the same numbers.

mod crowds;
mod impacts;
mod joined;
mod quality;
mod speed;
mod twins;

pub use crowds::*;
pub use impacts::*;
pub use joined::*;
pub use quality::*;
pub use speed::*;
pub use twins::{Mirror, mirrored, shuffled};

#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Kind {
    Fixed,
    /// Moves at the velocity that it has.
    Kinematic,
    Dynamic,
}

/// The corners of a convex polygon, counter-clockwise, relative to the body's position.
/// The position is the centroid, to 2^-20 m.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Corners {
    count: usize,
    at: [[f64; 2]; Corners::MOST],
}

impl Corners {
    /// The largest number of corners.
    const MOST: usize = 8;

    pub fn new(corners: &[[f64; 2]]) -> Self {
        let mut at = [[0.0; 2]; Self::MOST];
        at[..corners.len()].copy_from_slice(corners);
        Corners { count: corners.len(), at }
    }

    pub fn as_slice(&self) -> &[[f64; 2]] {
        &self.at[..self.count]
    }
}

#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Shape {
    /// No collider at all: mass and moment of inertia are given.
    None {
        mass: f64,
        inertia: f64,
    },
    Circle {
        r: f64,
    },
    Box {
        hx: f64,
        hy: f64,
    },
    /// The points within `r` of a segment through the position. It ends at `half` and at the opposite point.
    Capsule {
        half: [f64; 2],
        r: f64,
    },
    Polygon(Corners),
    /// Four walls around a rectangle of half the sizes `hx` and `hy`.
    Frame {
        hx: f64,
        hy: f64,
        wall: f64,
    },
}

/// A rectangle that is a part of a shape: its middle from the position, and half its sizes.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Wall {
    pub at: [f64; 2],
    pub half: [f64; 2],
}

impl Shape {
    /// The corners of a box or of a polygon, counter-clockwise.
    pub fn corners(&self) -> Option<Corners> {
        match *self {
            Shape::Box { hx, hy } => Some(Corners::new(&[[hx, hy], [-hx, hy], [-hx, -hy], [hx, -hy]])),
            Shape::Polygon(corners) => Some(corners),
            Shape::None { .. } | Shape::Circle { .. } | Shape::Capsule { .. } | Shape::Frame { .. } => None,
        }
    }
}

/// The walls of a frame: below and above over its whole width, left and right between them.
pub fn walls(hx: f64, hy: f64, wall: f64) -> [Wall; 4] {
    let half = 0.5 * wall;
    let level = |side: f64| Wall { at: [0.0, side * (hy + half)], half: [hx + wall, half] };
    let upright = |side: f64| Wall { at: [side * (hx + half), 0.0], half: [half, hy] };
    [level(-1.0), level(1.0), upright(-1.0), upright(1.0)]
}

/// A body with one shape.
///
/// Two bodies in contact mix their materials like this: friction sqrt(a b), restitution
/// max(a, b), surface speed a + b. The sum of the scalars is the difference of the two
/// surface velocities, since the outward normals of the two bodies are opposite.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Body {
    pub kind: Kind,
    pub x: f64,
    pub y: f64,
    pub angle: f64,
    pub vx: f64,
    pub vy: f64,
    pub w: f64,
    /// Coefficients c of dv/dt = -c v.
    pub lin_damp: f64,
    pub ang_damp: f64,
    pub shape: Shape,
    /// Mass per area, kg/m^2. It has no meaning for `Shape::None`.
    pub density: f64,
    pub friction: f64,
    pub restitution: f64,
    /// The speed at which the surface runs clockwise around the body, m/s: a floor with a
    /// positive speed carries what lies on it towards +x. With the normal n from A to B and
    /// t = (n.y, -n.x), friction drives t·(vB - vA) towards the sum of both speeds.
    pub surface_speed: f64,
}

impl Body {
    pub fn dynamic(x: f64, y: f64, shape: Shape) -> Self {
        Body {
            kind: Kind::Dynamic,
            x,
            y,
            angle: 0.0,
            vx: 0.0,
            vy: 0.0,
            w: 0.0,
            lin_damp: 0.0,
            ang_damp: 0.0,
            shape,
            density: 1.0,
            friction: 0.5,
            restitution: 0.0,
            surface_speed: 0.0,
        }
    }
    pub fn fixed(x: f64, y: f64, shape: Shape) -> Self {
        Body { kind: Kind::Fixed, ..Body::dynamic(x, y, shape) }
    }
    /// Mass and moment of inertia about the position.
    pub fn mass_inertia(&self) -> (f64, f64) {
        let (m, i) = match self.shape {
            Shape::None { mass, inertia } => return (mass, inertia),
            Shape::Circle { r } => {
                let m = std::f64::consts::PI * r * r;
                (m, 0.5 * m * r * r)
            }
            Shape::Box { hx, hy } => {
                let m = 4.0 * hx * hy;
                (m, m * (hx * hx + hy * hy) / 3.0)
            }
            Shape::Capsule { half: [x, y], r } => {
                let half = x.hypot(y);
                let (bar, ends) = (4.0 * half * r, std::f64::consts::PI * r * r);
                // Half a disc has its centre at 4 r/3π from its middle.
                let end = 0.5 * r * r + half * half + half * 8.0 * r / (3.0 * std::f64::consts::PI);
                (bar + ends, bar * (half * half + r * r) / 3.0 + ends * end)
            }
            Shape::Polygon(corners) => polygon_moments(corners.as_slice()),
            Shape::Frame { hx, hy, wall } => walls(hx, hy, wall).iter().fold((0.0, 0.0), |(m, i), w| {
                let ([x, y], [half_x, half_y]) = (w.at, w.half);
                let part = 4.0 * half_x * half_y;
                (m + part, i + part * (x * x + y * y + (half_x * half_x + half_y * half_y) / 3.0))
            }),
        };
        (m * self.density, i * self.density)
    }
}

/// The area, and its second moment about the origin.
fn polygon_moments(c: &[[f64; 2]]) -> (f64, f64) {
    let (mut area, mut second) = (0.0, 0.0);
    for (k, a) in c.iter().enumerate() {
        let b = c[(k + 1) % c.len()];
        let cross = a[0] * b[1] - a[1] * b[0];
        let dot = |p: [f64; 2], q: [f64; 2]| p[0] * q[0] + p[1] * q[1];
        area += cross / 2.0;
        second += cross * (dot(*a, *a) + dot(*a, b) + dot(b, b)) / 12.0;
    }
    (area, second)
}

/// A force field about the origin, on a body of mass 1.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Field {
    /// The gravity of a point of this GM.
    Attractor(f64),
    /// A spring without length of this stiffness.
    Spring(f64),
}

impl Field {
    /// The force on a body at (x, y).
    pub fn force(self, x: f64, y: f64) -> (f64, f64) {
        let k = match self {
            Field::Attractor(gm) => gm / x.hypot(y).powi(3),
            Field::Spring(k) => k,
        };
        (-k * x, -k * y)
    }
}

/// A motor of a revolute joint: it turns the second body against the first one.
#[derive(Clone, Copy, Debug)]
pub struct Motor {
    /// The angular velocity that it aims at, rad/s; 0 for friction.
    pub speed: f64,
    /// Its largest torque, N·m.
    pub max_torque: f64,
}

/// A joint. The joined bodies do not collide with each other.
#[derive(Clone, Copy, Debug)]
pub struct Joint {
    pub a: usize,
    pub b: usize,
    /// The world point of the initial configuration that is fixed in `a`.
    pub x: f64,
    pub y: f64,
    /// `None`: a revolute joint at that point. Else a rigid rod, which ends at this world
    /// point, fixed in `b`, and turns freely at both ends.
    pub rod_end: Option<[f64; 2]>,
    /// The range of the angle of a revolute joint, rad: 0 is how the bodies stand at first.
    pub limits: Option<[f64; 2]>,
    pub motor: Option<Motor>,
}

impl Joint {
    pub fn revolute(a: usize, b: usize, x: f64, y: f64) -> Self {
        Joint { a, b, x, y, rod_end: None, limits: None, motor: None }
    }
    /// The points of both bodies, each in the frame of its body.
    pub fn anchors(&self, bodies: &[Body]) -> [[f64; 2]; 2] {
        let local = |b: &Body, x: f64, y: f64| {
            let (s, c) = b.angle.sin_cos();
            let (dx, dy) = (x - b.x, y - b.y);
            [c * dx + s * dy, c * dy - s * dx]
        };
        let [end_x, end_y] = self.rod_end.unwrap_or([self.x, self.y]);
        [local(&bodies[self.a], self.x, self.y), local(&bodies[self.b], end_x, end_y)]
    }
    /// The distance of the two points that the joint keeps.
    pub fn length(&self) -> f64 {
        self.rod_end.map_or(0.0, |[x, y]| (x - self.x).hypot(y - self.y))
    }
}

/// A mirror symmetry of a scene, exact in its doubles.
#[derive(Clone, Debug)]
pub struct Symmetry {
    pub mirror: Mirror,
    /// For each body the one that is its mirror image, or itself.
    pub partner: Vec<usize>,
}

#[derive(Clone, Debug)]
pub struct Scene {
    pub name: String,
    pub n: usize,
    pub gravity: [f64; 2],
    pub dt: f64,
    pub sleep: bool,
    /// True if bodies touch.
    pub contacts: bool,
    /// None: the engine's default.
    pub substeps: Option<u32>,
    pub bodies: Vec<Body>,
    pub joints: Vec<Joint>,
    /// Sorted by step.
    pub kicks: Vec<Kick>,
    pub symmetry: Option<Symmetry>,
    /// A force field that acts on all bodies.
    pub field: Option<Field>,
    /// True if the harness pushes the field before each step, instead of the engine evaluating its own.
    pub pushed: bool,
}

impl Scene {
    fn new(name: &str, n: usize) -> Self {
        Scene {
            name: name.to_string(),
            n,
            gravity: [0.0, -10.0],
            dt: 1.0 / 60.0,
            sleep: false,
            contacts: false,
            substeps: None,
            bodies: Vec::new(),
            joints: Vec::new(),
            kicks: Vec::new(),
            symmetry: None,
            field: None,
            pushed: false,
        }
    }

    /// The kicks before a step.
    pub fn kicks_at(&self, step: usize) -> &[Kick] {
        let from = self.kicks.partition_point(|kick| kick.step < step);
        let count = self.kicks[from..].partition_point(|kick| kick.step == step);
        &self.kicks[from..from + count]
    }
}

/// The velocity that the harness gives a body before a step.
#[derive(Clone, Copy, Debug)]
pub struct Kick {
    /// The number of the step, from 0.
    pub step: usize,
    pub body: usize,
    pub vx: f64,
    pub vy: f64,
    pub w: f64,
}

/// A ray: where it starts, and from there to its end, m.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    pub from: [f64; 2],
    pub by: [f64; 2],
}

/// Deterministic numbers in [-1, 1).
struct Lcg(u64);
impl Lcg {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        ((self.0 >> 33) as f64) / ((1u64 << 30) as f64) - 1.0
    }
    /// A number in [0, 1).
    fn unit(&mut self) -> f64 {
        0.5 * (self.next() + 1.0)
    }
}
