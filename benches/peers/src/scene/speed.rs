//! Scenes whose steps are timed.

use std::collections::HashMap;

use super::{Body, Corners, Joint, Lcg, Ray, Scene, Shape};

fn disc(r: f64) -> Shape {
    let m = std::f64::consts::PI * r * r;
    Shape::None { mass: m, inertia: 0.5 * m * r * r }
}

/// Dynamic bodies without colliders: integration and nothing else.
pub fn free(n: usize) -> Scene {
    let mut s = Scene::new("free", n);
    let side = (n as f64).sqrt().ceil() as usize;
    let mut g = Lcg(1);
    for i in 0..n {
        let mut b = Body::dynamic((i % side) as f64 * 4.0, (i / side) as f64 * 4.0, disc(0.5));
        b.vx = 3.0 * g.next();
        b.vy = 3.0 * g.next();
        b.w = 5.0 * g.next();
        b.lin_damp = 0.1;
        b.ang_damp = 0.1;
        s.bodies.push(b);
    }
    s
}

/// Free bodies with circle colliders that never come near each other: adds the price
/// of keeping the broad phase current. No gravity and no damping, so that it costs
/// the same however many steps an engine is given.
pub fn free_far(n: usize) -> Scene {
    let mut s = free(n);
    s.name = "free_far".into();
    s.gravity = [0.0, 0.0];
    for b in &mut s.bodies {
        b.shape = Shape::Circle { r: 0.5 };
        b.vx = 3.0;
        b.vy = 2.0;
        b.lin_damp = 0.0;
        b.ang_damp = 0.0;
    }
    s
}

/// `n` fixed bodies and 100 dynamic ones far above them.
pub fn free_static(n: usize, colliders: bool) -> Scene {
    let mut s = Scene::new(if colliders { "free_static_col" } else { "free_static" }, n);
    let side = (n as f64).sqrt().ceil() as usize;
    let shape = if colliders { Shape::Circle { r: 0.5 } } else { disc(0.5) };
    for i in 0..n {
        s.bodies.push(Body::fixed((i % side) as f64 * 4.0, -((i / side) as f64) * 4.0, shape));
    }
    let mut g = Lcg(2);
    s.gravity = [0.0, 0.0];
    for i in 0..100 {
        let mut b = Body::dynamic((i % 10) as f64 * 4.0, 1000.0 + (i / 10) as f64 * 4.0, shape);
        b.vy = 2.0;
        b.w = 5.0 * g.next();
        b.lin_damp = 0.1;
        b.ang_damp = 0.1;
        s.bodies.push(b);
    }
    s
}

/// The width of the square of [`rays`] for one body, m: a long ray then goes 30 m on average before it hits.
const RAYS_SPACING: f64 = 6.0;

/// `n` fixed boxes, discs, triangles and pentagons, 1 m to 2 m in size, at all angles in a square.
pub fn rays(n: usize) -> Scene {
    let mut s = Scene::new("rays", n);
    s.gravity = [0.0, 0.0];
    let regular = |corners: usize, r: f64| {
        let corner = |i: usize| {
            let (sin, cos) = (std::f64::consts::TAU * i as f64 / corners as f64).sin_cos();
            [r * cos, r * sin]
        };
        Shape::Polygon(Corners::new(&(0..corners).map(corner).collect::<Vec<_>>()))
    };
    let side = (n as f64).sqrt() * RAYS_SPACING;
    let mut g = Lcg(5);
    for i in 0..n {
        let size = 0.5 + 0.5 * g.unit();
        let shape = match i % 4 {
            0 | 1 => Shape::Box { hx: size, hy: 0.5 + 0.5 * g.unit() },
            2 => Shape::Circle { r: size },
            _ => regular(3 + i / 4 % 2 * 2, size),
        };
        let mut b = Body::fixed(side * g.unit(), side * g.unit(), shape);
        b.angle = std::f64::consts::PI * g.next();
        s.bodies.push(b);
    }
    // One that moves, far from all rays: engines that look for contacts keep what they know of the others.
    s.bodies.push(Body::dynamic(-1000.0, 0.0, Shape::Circle { r: 0.5 }));
    s
}

/// Rays of a length in all directions, from points of the square of [`rays`] that are in no body: not all engines count those.
pub fn ray_list(s: &Scene, count: usize, length: f64) -> Vec<Ray> {
    let side = (s.n as f64).sqrt() * RAYS_SPACING;
    // Bodies reach 1.42 m at most: those near a point are in the cells around its own.
    let cell = |x: f64, y: f64| ((x / 1.5).floor() as i64, (y / 1.5).floor() as i64);
    let mut bodies: HashMap<_, Vec<[f64; 2]>> = HashMap::new();
    s.bodies.iter().for_each(|b| bodies.entry(cell(b.x, b.y)).or_default().push([b.x, b.y]));
    let is_free = |[x, y]: [f64; 2]| {
        let (i, j) = cell(x, y);
        let mut neighbours = (0..9).filter_map(|k| bodies.get(&(i + k / 3 - 1, j + k % 3 - 1))).flatten();
        neighbours.all(|b| (b[0] - x).hypot(b[1] - y) > 1.42)
    };
    let mut g = Lcg(6);
    let mut ray = || {
        let from = [side * g.unit(), side * g.unit()];
        let (sin, cos) = (std::f64::consts::PI * g.next()).sin_cos();
        Ray { from, by: [length * cos, length * sin] }
    };
    std::iter::repeat_with(&mut ray).filter(|ray| is_free(ray.from)).take(count).collect()
}

/// Boxes, each resting alone on one of many static floors, that fall asleep.
pub fn sleeping(n: usize) -> Scene {
    let mut s = Scene::new("sleeping", n);
    s.sleep = true;
    s.contacts = true;
    let per = 100.min(n);
    let floors = n.div_ceil(per);
    for f in 0..floors {
        s.bodies.push(Body::fixed(0.0, f as f64 * 5.0 - 0.5, Shape::Box { hx: per as f64 * 1.5 + 2.0, hy: 0.5 }));
    }
    for i in 0..n {
        let (f, k) = (i / per, i % per);
        s.bodies.push(Body::dynamic(
            (k as f64 - (per as f64 - 1.0) / 2.0) * 3.0,
            f as f64 * 5.0 + 0.5,
            Shape::Box { hx: 0.5, hy: 0.5 },
        ));
    }
    s
}

/// Bodies without colliders at rest where nothing pulls, which fall asleep.
pub fn sleeping_free(n: usize) -> Scene {
    let mut s = free(n);
    s.name = "sleeping_free".into();
    s.sleep = true;
    s.gravity = [0.0, 0.0];
    for b in &mut s.bodies {
        (b.vx, b.vy, b.w) = (0.0, 0.0, 0.0);
    }
    s
}

/// A pyramid of unit boxes. Body 0 is the ground, the last body is the top box.
pub fn pyramid(base: usize) -> Scene {
    let mut s = Scene::new("pyramid", base);
    s.contacts = true;
    s.bodies.push(Body::fixed(0.0, -1.0, Shape::Box { hx: 100.0, hy: 1.0 }));
    for row in 0..base {
        let k = base - row;
        for j in 0..k {
            let x = (j as f64 - (k as f64 - 1.0) / 2.0) * 1.05;
            s.bodies.push(Body::dynamic(x, 0.5 + row as f64, Shape::Box { hx: 0.5, hy: 0.5 }));
        }
    }
    s
}

pub fn rain_half_width(n: usize) -> f64 {
    (n as f64).sqrt() * 0.65
}

/// Circles and boxes dropped into a container of three static walls.
pub fn rain(n: usize) -> Scene {
    let mut s = Scene::new("rain", n);
    s.contacts = true;
    let hw = rain_half_width(n);
    let hh = 400.0;
    s.bodies.push(Body::fixed(0.0, -2.0, Shape::Box { hx: hw + 8.0, hy: 2.0 }));
    s.bodies.push(Body::fixed(-hw - 2.0, hh, Shape::Box { hx: 2.0, hy: hh }));
    s.bodies.push(Body::fixed(hw + 2.0, hh, Shape::Box { hx: 2.0, hy: hh }));
    let cols = ((2.0 * hw - 1.0) / 1.25) as usize;
    let mut g = Lcg(3);
    for i in 0..n {
        let (r, c) = (i / cols, i % cols);
        let x = (c as f64 - (cols as f64 - 1.0) / 2.0) * 1.25 + 0.1 * g.next();
        let y = 1.0 + r as f64 * 1.3;
        // The box's half diagonal (0.53) stays below half of the spacing.
        let shape = if (i + r) % 2 == 0 { Shape::Circle { r: 0.4 } } else { Shape::Box { hx: 0.375, hy: 0.375 } };
        let mut b = Body::dynamic(x, y, shape);
        b.angle = 0.5 * g.next();
        s.bodies.push(b);
    }
    s
}

/// A chain of `n` links hung from a fixed body, starting horizontal.
pub fn chain(n: usize) -> Scene {
    let mut s = Scene::new("chain", n);
    let shape = Shape::None { mass: 1.0, inertia: (0.5 * 0.5 + 0.2 * 0.2) / 12.0 };
    s.bodies.push(Body::fixed(0.0, 0.0, shape));
    for i in 0..n {
        s.bodies.push(Body::dynamic(0.25 + 0.5 * i as f64, 0.0, shape));
        s.joints.push(Joint::revolute(i, i + 1, 0.5 * i as f64, 0.0));
    }
    s
}

/// A hanging net of side x side bodies, the two top corners fixed:
/// 2 side (side - 1) revolute joints (15 gives 420).
pub fn grid(side: usize) -> Scene {
    let mut s = Scene::new("grid", 2 * side * (side - 1));
    let shape = Shape::None { mass: 1.0, inertia: 0.08 };
    for r in 0..side {
        for c in 0..side {
            let (x, y) = (c as f64, -(r as f64));
            let fixed = r == 0 && (c == 0 || c == side - 1);
            s.bodies.push(if fixed { Body::fixed(x, y, shape) } else { Body::dynamic(x, y, shape) });
            let me = r * side + c;
            if c > 0 {
                s.joints.push(Joint::revolute(me - 1, me, x - 0.5, y));
            }
            if r > 0 {
                s.joints.push(Joint::revolute(me - side, me, x, y + 0.5));
            }
        }
    }
    s
}

/// One free body of mass 1, for the accuracy scenes.
pub fn single(name: &str, gravity: [f64; 2], dt: f64, substeps: Option<u32>) -> Scene {
    let mut s = Scene::new(name, 1);
    s.gravity = gravity;
    s.dt = dt;
    s.substeps = substeps;
    s.bodies.push(Body::dynamic(0.0, 0.0, Shape::None { mass: 1.0, inertia: 1.0 }));
    s
}
