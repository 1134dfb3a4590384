//! Scenes whose end state is judged: what stands, rests, slides and bounces.
//!
//! Coordinates, sizes and angles are multiples of 2^-20, which f32 and fixed point hold
//! exactly near the origin. The last body is the one whose path is followed. Where a scene
//! is symmetric in nature, it is so in its doubles.

use super::{Body, Corners, Joint, Kind, Lcg, Mirror, Scene, Shape, pyramid};
use std::f64::consts::PI;

/// Friction of all bodies, where a scene does not say otherwise.
const FRICTION: f64 = 0.6;

/// The nearest multiple of 2^-20; halves are rounded away from zero, so that mirror images stay mirror images.
pub(super) fn on_grid(v: f64) -> f64 {
    const UNIT: f64 = (1u32 << 20) as f64;
    (v * UNIT).round() / UNIT
}

impl Scene {
    pub(super) fn with_contacts(name: &str, n: usize) -> Self {
        Scene { contacts: true, ..Scene::new(name, n) }
    }

    pub(super) fn add(&mut self, kind: Kind, x: f64, y: f64, shape: Shape) -> &mut Body {
        self.bodies.push(Body { kind, friction: FRICTION, ..Body::dynamic(on_grid(x), on_grid(y), shape) });
        self.bodies.last_mut().expect("just pushed")
    }

    pub(super) fn fixed(&mut self, x: f64, y: f64, shape: Shape) -> &mut Body {
        self.add(Kind::Fixed, x, y, shape)
    }

    pub(super) fn dynamic(&mut self, x: f64, y: f64, shape: Shape) -> &mut Body {
        self.add(Kind::Dynamic, x, y, shape)
    }

    /// A floor whose top is y = 0.
    pub(super) fn floor(&mut self, half_width: f64) -> &mut Body {
        self.fixed(0.0, -1.0, rectangle(half_width, 1.0))
    }

    /// A floor and two high walls.
    pub(super) fn container(&mut self, half_width: f64) {
        self.fixed(0.0, -2.0, rectangle(half_width + 8.0, 2.0));
        for side in [-1.0, 1.0] {
            self.fixed(side * (half_width + 2.0), 400.0, rectangle(2.0, 402.0));
        }
    }
}

pub(super) fn rectangle(hx: f64, hy: f64) -> Shape {
    Shape::Box { hx: on_grid(hx), hy: on_grid(hy) }
}

pub(super) fn circle(r: f64) -> Shape {
    Shape::Circle { r: on_grid(r) }
}

pub(super) const UNIT_BOX: Shape = Shape::Box { hx: 0.5, hy: 0.5 };

/// The pyramid whose steps are timed too, on the grid.
pub fn pyramid_on_grid(base: usize) -> Scene {
    let mut s = pyramid(base);
    for b in &mut s.bodies {
        b.x = on_grid(b.x);
    }
    s.symmetric(Mirror::X)
}

/// A tower of boxes, the top one of another density.
pub fn tower(n: usize, top_density: f64) -> Scene {
    let mut s = Scene::with_contacts("tower", n);
    s.floor(100.0);
    for k in 0..n {
        s.dynamic(0.0, 0.5 + k as f64, UNIT_BOX);
    }
    s.bodies[n].density = top_density;
    s.symmetric(Mirror::X)
}

/// Boxes in three layers on a floor that carries them towards a stop at x = 0.
pub fn belt() -> Scene {
    let mut s = Scene::with_contacts("belt", 60);
    s.floor(200.0).surface_speed = 2.0;
    let mut g = Lcg(2);
    for i in 0..60 {
        let (row, column) = (i / 20, i % 20);
        let b = s.dynamic(-40.0 + 1.3 * column as f64, 0.5 + 1.01 * row as f64, UNIT_BOX);
        b.angle = on_grid(0.02 * g.unit());
    }
    s.fixed(0.0, 1.0, rectangle(0.5, 1.0));
    s
}

/// Discs and boxes of unequal sizes dropped into a container.
pub fn mixed(n: usize) -> Scene {
    let mut s = Scene::with_contacts("mixed", n);
    s.container(12.0);
    let mut g = Lcg(11);
    for i in 0..n {
        let (row, column) = (i / 20, i % 20);
        let (x, y) = ((column as f64 - 9.5) * 1.15 + 0.1 * g.unit(), 1.0 + row as f64 * 1.2);
        if i % 2 == 0 {
            s.dynamic(x, y, circle(0.25 + 0.2 * g.unit()));
        } else {
            let (hx, hy) = (0.2 + 0.2 * g.unit(), 0.2 + 0.2 * g.unit());
            s.dynamic(x, y, rectangle(hx, hy)).angle = on_grid(6.0 * g.unit());
        }
    }
    s
}

/// A half circle of `n` wedges between two radii, `n` odd, without mortar.
pub fn arch(n: usize, inner: f64, outer: f64) -> Scene {
    let mut s = Scene::with_contacts("arch", n);
    s.floor(50.0);
    let middle = n / 2;
    let edge = |k: usize| {
        let t = PI * k as f64 / n as f64;
        [inner, outer].map(|r| [on_grid(r * t.cos()), on_grid(r * t.sin())])
    };
    let mut right = Vec::new();
    for k in 0..middle {
        right.push(wedge([edge(k), edge(k + 1)]));
    }
    let keystone = wedge([edge(middle), edge(middle).map(|p| Mirror::X.point(p))]);
    let left: Vec<Body> = right.iter().rev().map(|b| Mirror::X.body(b)).collect();
    for b in right.into_iter().chain([Body { x: 0.0, ..keystone }]).chain(left) {
        s.bodies.push(b);
    }
    s.symmetric(Mirror::X)
}

/// A stone between two edges, each given by its inner and its outer corner.
fn wedge([first, last]: [[[f64; 2]; 2]; 2]) -> Body {
    let corners = [first[0], first[1], last[1], last[0]];
    let (mut area, mut cx, mut cy) = (0.0, 0.0, 0.0);
    for (k, a) in corners.iter().enumerate() {
        let b = corners[(k + 1) % 4];
        let cross = a[0] * b[1] - a[1] * b[0];
        area += cross / 2.0;
        cx += cross * (a[0] + b[0]) / 6.0;
        cy += cross * (a[1] + b[1]) / 6.0;
    }
    let (x, y) = (on_grid(cx / area), on_grid(cy / area));
    let shape = Shape::Polygon(Corners::new(&corners.map(|c| [c[0] - x, c[1] - y])));
    Body { friction: FRICTION, ..Body::dynamic(x, y, shape) }
}

/// A house of cards: pairs of cards that lean on each other, with a card across each gap.
pub fn cards(storeys: usize) -> Scene {
    let mut s = Scene::with_contacts("cards", storeys);
    s.floor(200.0);
    let (half, thin, lean) = (0.5, 0.02, on_grid(0.35));
    let width = 2.0 * (half * lean.sin() + thin * lean.cos()) + 0.002;
    let height = 2.0 * (half * lean.cos() + thin * lean.sin());
    for row in 0..storeys {
        let k = storeys - row;
        let centre = (k as f64 - 1.0) / 2.0;
        let base = row as f64 * (height + 2.0 * thin);
        for j in 0..k {
            let x = (j as f64 - centre) * 2.0 * width;
            for side in [-1.0, 1.0] {
                let b = s.dynamic(x + side * width * 0.5, base + 0.5 * height, rectangle(thin, half));
                b.angle = side * lean;
            }
        }
        for j in 1..k {
            let x = (j as f64 - 0.5 - centre) * 2.0 * width;
            s.dynamic(x, base + height + thin, rectangle(width * 0.95, thin));
        }
    }
    s.symmetric(Mirror::X)
}

/// Discs above a funnel, mirror images of each other.
pub fn hopper(n: usize) -> Scene {
    let mut s = Scene::with_contacts("hopper", n);
    s.floor(40.0);
    for side in [-1.0, 1.0] {
        s.fixed(side * 21.0, 20.0, rectangle(1.0, 20.0));
        s.fixed(side * 11.0, 18.0, rectangle(11.5, 0.5)).angle = on_grid(side * 0.7);
    }
    let mut g = Lcg(7);
    for i in 0..n / 2 {
        let (row, column) = (i / 10, i % 10);
        let (x, y) = ((column as f64 + 0.5) * 0.75 + 0.1 * g.unit(), 26.0 + row as f64 * 0.75);
        let shape = circle(0.25 + 0.1 * g.unit());
        for side in [-1.0, 1.0] {
            s.dynamic(side * x, y, shape);
        }
    }
    s.symmetric(Mirror::X)
}

/// A disc that runs into a triangle of 15, `gap` between neighbours, without friction and gravity.
pub fn billiards(gap: f64) -> Scene {
    let mut s = Scene::with_contacts("break", 16);
    s.gravity = [0.0, 0.0];
    let r = 0.5;
    s.dynamic(-10.0, 0.0, circle(r)).vx = 20.0;
    for row in 0..5 {
        for k in 0..=row {
            let pitch = 2.0 * r + gap;
            s.dynamic(row as f64 * pitch * 0.75f64.sqrt(), (k as f64 - row as f64 / 2.0) * pitch, circle(r));
        }
    }
    for b in &mut s.bodies {
        (b.restitution, b.friction) = (0.95, 0.0);
    }
    s.symmetric(Mirror::Y)
}

/// A box that falls 2 m flat onto a floor of restitution 0.5.
pub fn flat_drop() -> Scene {
    let mut s = Scene::with_contacts("flat_drop", 1);
    s.floor(10.0).restitution = 0.5;
    s.dynamic(0.0, 2.5, UNIT_BOX);
    s.symmetric(Mirror::X)
}

/// A box on a slope that is steeper than the angle of friction by `excess` rad.
pub fn slope(excess: f64) -> Scene {
    let mut s = Scene::with_contacts("slope", 1);
    let angle = on_grid(FRICTION.atan() + excess);
    s.fixed(0.0, 0.0, rectangle(20.0, 1.0)).angle = angle;
    // 1 mm deep, so that the box touches from the first step.
    s.dynamic(-1.499 * angle.sin(), 1.499 * angle.cos(), UNIT_BOX).angle = angle;
    s
}

/// The acceleration along the slope by the law of friction, m/s^2; 0 if the box holds.
pub fn slope_acceleration(s: &Scene) -> f64 {
    let (sin, cos) = s.bodies[0].angle.sin_cos();
    (-s.gravity[1] * (sin - s.bodies[0].friction * cos)).max(0.0)
}

/// A disc that falls 10 m onto a floor of restitution 0.9.
pub fn bounce() -> Scene {
    let mut s = Scene::with_contacts("bounce", 1);
    s.floor(10.0).restitution = 0.9;
    s.dynamic(0.0, 10.5, circle(0.5));
    s.symmetric(Mirror::X)
}

/// The mass and the moment of inertia of a shape, without the shape.
pub(super) fn ghost(shape: Shape, density: f64) -> Shape {
    let (mass, inertia) = Body { density, ..Body::dynamic(0.0, 0.0, shape) }.mass_inertia();
    Shape::None { mass, inertia }
}

/// A chain of `n` rods that hangs straight down, the last one of another density.
pub fn hanging(n: usize, tip_density: f64) -> Scene {
    let mut s = Scene::new("hanging", n);
    let link = |density| ghost(rectangle(0.0625, 0.25), density);
    s.fixed(0.0, 0.0, link(20.0));
    for i in 0..n {
        let top = -0.5 * i as f64;
        s.dynamic(0.0, top - 0.25, link(if i + 1 == n { 20.0 * tip_density } else { 20.0 }));
        s.joints.push(Joint::revolute(i, i + 1, 0.0, top));
    }
    s.symmetric(Mirror::X)
}

/// A net of side x side discs 1 m apart, the two top corners fixed. Neighbours are tied by
/// rods from centre to centre, or by pins half way between them.
pub fn net(side: usize, pins: bool) -> Scene {
    let mut s = Scene::new("net", 2 * side * (side - 1));
    let knot = ghost(circle(0.2), 1.0);
    for row in 0..side {
        for column in 0..side {
            let (x, y) = (column as f64 - (side as f64 - 1.0) / 2.0, -(row as f64));
            let corner = row == 0 && (column == 0 || column == side - 1);
            s.add(if corner { Kind::Fixed } else { Kind::Dynamic }, x, y, knot);
            let me = row * side + column;
            let mut tie = |to: usize, dx: f64, dy: f64| {
                let joint = Joint::revolute(to, me, x + 0.5 * dx, y + 0.5 * dy);
                let rod = Joint { x: x + dx, y: y + dy, rod_end: Some([x, y]), ..joint };
                s.joints.push(if pins { joint } else { rod });
            };
            if column > 0 {
                tie(me - 1, -1.0, 0.0);
            }
            if row > 0 {
                tie(me - side, 0.0, 1.0);
            }
        }
    }
    s.symmetric(Mirror::X)
}

/// A rod of 1 m on a pin half a metre beyond its end, let go horizontally.
pub fn pendulum() -> Scene {
    let mut s = Scene::new("pendulum", 1);
    let rod = ghost(rectangle(0.5, 0.05), 1.0);
    s.fixed(0.0, 0.0, rod);
    s.dynamic(1.0, 0.0, rod);
    s.joints.push(Joint::revolute(0, 1, 0.0, 0.0));
    s
}

/// Ten ropes of ten boxes that fall on a floor.
pub fn ropes() -> Scene {
    let mut s = Scene::with_contacts("ropes", 100);
    s.floor(50.0);
    for rope in 0..10 {
        let (x, y) = ((rope % 5) as f64 * 1.2 - 2.4, 2.0 + 3.0 * (rope / 5) as f64);
        for k in 0..10 {
            let (x, y) = (x + 0.02 * k as f64, y + 0.22 * k as f64);
            s.dynamic(x, y, rectangle(0.06, 0.12)).angle = on_grid(0.02);
            let me = s.bodies.len() - 1;
            if k > 0 {
                s.joints.push(Joint::revolute(me - 1, me, on_grid(x), on_grid(y - 0.11)));
            }
        }
    }
    s
}

/// A bridge of `n` planks between two supports, and five discs that fall on it.
pub fn bridge(n: usize, disc_density: f64) -> Scene {
    let mut s = Scene::with_contacts("bridge", n);
    let half = n as f64 / 2.0;
    s.fixed(-half - 1.0, 0.0, rectangle(1.0, 0.125));
    for i in 0..n {
        s.dynamic(i as f64 + 0.5 - half, 0.0, rectangle(0.48, 0.125)).density = 20.0;
        s.joints.push(Joint::revolute(i, i + 1, i as f64 - half, 0.0));
    }
    s.fixed(half + 1.0, 0.0, rectangle(1.0, 0.125));
    s.joints.push(Joint::revolute(n, n + 1, half, 0.0));
    for k in 0..5 {
        s.dynamic(k as f64 * 1.5 - 3.0, 3.0, circle(0.5)).density = disc_density;
    }
    s
}
