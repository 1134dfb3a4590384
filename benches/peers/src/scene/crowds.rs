//! Crowds: scenes of thousands of bodies whose steps are timed, each with another reason to be slow.

use std::f64::consts::{PI, TAU};

use super::quality::{UNIT_BOX, circle, on_grid, rectangle};
use super::{Body, Corners, Kick, Kind, Lcg, Scene, Shape};

impl Scene {
    fn kinematic(&mut self, x: f64, y: f64, shape: Shape) -> &mut Body {
        let body = self.fixed(x, y, shape);
        body.kind = Kind::Kinematic;
        body
    }
}

/// A convex polygon about its centroid, its corners on a circle at uneven angles.
fn polygon(corners: usize, r: f64, g: &mut Lcg) -> Shape {
    let mut on_circle = |k: usize| {
        let (sin, cos) = (TAU * (k as f64 + 0.3 * g.next()) / corners as f64).sin_cos();
        [r * cos, r * sin]
    };
    let points: Vec<[f64; 2]> = (0..corners).map(&mut on_circle).collect();
    let (mut area, mut sum) = (0.0, [0.0; 2]);
    for (k, a) in points.iter().enumerate() {
        let b = points[(k + 1) % corners];
        let cross = a[0] * b[1] - a[1] * b[0];
        area += cross;
        sum = [sum[0] + cross * (a[0] + b[0]) / 3.0, sum[1] + cross * (a[1] + b[1]) / 3.0];
    }
    let shifted: Vec<_> = points.iter().map(|p| [0, 1].map(|c| on_grid(p[c] - sum[c] / area))).collect();
    Shape::Polygon(Corners::new(&shifted))
}

/// `side` × `side` pyramids of 10 rows on `side` floors: many islands.
pub fn many_pyramids(side: usize) -> Scene {
    const ROWS: usize = 10;
    let mut s = Scene::with_contacts("many_pyramids", side * side);
    let half_width = side as f64 * 6.0;
    for floor in 0..side {
        let y = floor as f64 * 15.0;
        s.fixed(0.0, y - 0.5, rectangle(half_width + 2.0, 0.5));
        for pyramid in 0..side {
            let x = (pyramid as f64 + 0.5) * 12.0 - half_width;
            for row in 0..ROWS {
                for k in 0..ROWS - row {
                    let along = (k as f64 - (ROWS - row - 1) as f64 / 2.0) * 1.05;
                    s.dynamic(x + along, y + 0.5 + row as f64, UNIT_BOX);
                }
            }
        }
    }
    s
}

/// The radius of the ring of [`spinner`], m.
pub const RING: f64 = 40.0;

/// Discs, boxes and pentagons in a ring, stirred by a bar that turns by 1 rad/s.
pub fn spinner(n: usize) -> Scene {
    const PLATES: usize = 90;
    const PITCH: f64 = 1.1;
    let mut s = Scene::with_contacts("spinner", n);
    for plate in 0..PLATES {
        let angle = TAU * plate as f64 / PLATES as f64;
        let (sin, cos) = angle.sin_cos();
        s.fixed((RING + 1.0) * cos, (RING + 1.0) * sin, rectangle(1.0, 1.5)).angle = on_grid(angle);
    }
    let bar_y = -12.0;
    s.kinematic(0.0, bar_y, rectangle(0.4, 20.0)).w = 1.0;
    let mut g = Lcg(21);
    let places = (0..).flat_map(|row| {
        let y = PITCH * row as f64 + 3.0 - RING;
        let half_width = (0.9 * RING * RING - y * y).max(0.0).sqrt();
        (0..(2.0 * half_width / PITCH) as usize).map(move |column| [(column as f64 + 0.5) * PITCH - half_width, y])
    });
    let is_beside_bar = |&[x, y]: &[f64; 2]| x.abs() > 1.2 || (y - bar_y).abs() > 21.0;
    for (i, [x, y]) in places.filter(is_beside_bar).take(n).enumerate() {
        let shape = match i % 3 {
            0 => circle(0.3 + 0.1 * g.unit()),
            1 => rectangle(0.25 + 0.1 * g.unit(), 0.25 + 0.1 * g.unit()),
            _ => polygon(5, 0.35 + 0.1 * g.unit(), &mut g),
        };
        s.dynamic(x, y, shape);
    }
    s
}

/// Half of the inner size of the hourglass, m.
pub const HOURGLASS: [f64; 2] = [20.0, 36.0];

/// Discs in an hourglass that turns once in 20 s. Its walls are kinematic bodies, each with the velocity that leads to its next pose.
pub fn hourglass(n: usize, steps: usize) -> Scene {
    let mut s = Scene::with_contacts("hourglass", n);
    let [hx, hy] = HOURGLASS;
    let mut walls = vec![(0.0, hy + 1.0, hx + 2.0, 1.0, 0.0), (0.0, -hy - 1.0, hx + 2.0, 1.0, 0.0)];
    for x in [-1.0, 1.0] {
        walls.push((x * (hx + 1.0), 0.0, 1.0, hy, 0.0));
        // They lead to a waist of some 2 m.
        walls.extend([-1.0, 1.0].map(|y| (x * 11.0, y * 9.0, 12.4, 0.5, x * y * 0.7)));
    }
    for &(x, y, half_width, half_height, angle) in &walls {
        s.kinematic(x, y, rectangle(half_width, half_height)).angle = on_grid(angle);
    }
    let (dt, spin) = (s.dt, TAU / 20.0);
    for step in 0..steps {
        for (body, &(x, y, ..)) in walls.iter().enumerate() {
            let place = |step: usize| {
                let (sin, cos) = (spin * step as f64 * dt).sin_cos();
                [cos * x - sin * y, sin * x + cos * y]
            };
            let (from, to) = (place(step), place(step + 1));
            s.kicks.push(Kick { step, body, vx: (to[0] - from[0]) / dt, vy: (to[1] - from[1]) / dt, w: spin });
        }
    }
    let mut g = Lcg(22);
    for i in 0..n {
        let (row, column) = (i / 60, i % 60);
        // 26 rows fit in above the waist; the others begin below.
        let y = if row < 26 { hy - 0.7 - row as f64 * 0.66 } else { -19.0 - (row - 26) as f64 * 0.66 };
        s.dynamic((column as f64 - 29.5) * 0.66, y, circle(0.25 + 0.05 * g.unit()));
    }
    s
}

/// The half width of the containers of [`polygons`] and [`settling`], m.
pub fn container_half_width(n: usize) -> f64 {
    0.65 * (n as f64).sqrt()
}

/// Bodies in rows above the floor of a container.
fn poured(name: &str, n: usize, mut shape: impl FnMut(usize) -> Shape) -> Scene {
    let mut s = Scene::with_contacts(name, n);
    let half_width = container_half_width(n);
    s.container(half_width);
    let columns = ((2.0 * half_width - 0.6) / 1.2) as usize;
    let mut g = Lcg(23);
    for i in 0..n {
        let (row, column) = (i / columns, i % columns);
        let x = (column as f64 - (columns as f64 - 1.0) / 2.0) * 1.2 + 0.1 * g.next();
        let angle = on_grid(0.3 * g.next());
        s.dynamic(x, 1.0 + 1.2 * row as f64, shape(i)).angle = angle;
    }
    s
}

/// A pile of polygons of 3 to 8 corners.
pub fn polygons(n: usize) -> Scene {
    let mut g = Lcg(24);
    poured("polygons", n, |i| polygon(3 + i % 6, 0.35 + 0.13 * g.unit(), &mut g))
}

/// A heap of boxes that comes to rest and falls asleep.
pub fn settling(n: usize) -> Scene {
    let mut g = Lcg(25);
    let boxes = |_| rectangle(0.25 + 0.1 * g.unit(), 0.25 + 0.1 * g.unit());
    Scene { sleep: true, ..poured("settling", n, boxes) }
}

/// The columns of [`tiles`].
pub const COLUMNS: usize = 500;

/// Ground of `n` square tiles with steps in its surface, and 1,000 discs and boxes that fall on it and roll.
pub fn tiles(n: usize) -> Scene {
    let mut s = Scene::with_contacts("tiles", n);
    let mut g = Lcg(26);
    let mut top = 0.0f64;
    let x_of = |column: f64| column - COLUMNS as f64 / 2.0;
    for column in 0..COLUMNS {
        if column % 4 == 0 {
            top = (top + (1.5 * g.next()).round()).clamp(-4.0, 4.0);
        }
        for depth in 0..n / COLUMNS {
            s.fixed(x_of(column as f64 + 0.5), top - 0.5 - depth as f64, UNIT_BOX);
        }
    }
    for side in [-1.0, 1.0] {
        s.fixed(side * (COLUMNS as f64 / 2.0 + 1.0), 0.0, rectangle(1.0, 50.0));
    }
    for i in 0..1_000 {
        let (row, column) = (i / 200, i % 200);
        let x = x_of((column as f64 + 0.5) * COLUMNS as f64 / 200.0);
        let size = 0.25 + 0.2 * g.unit();
        let shape = if i % 2 == 0 { circle(size) } else { rectangle(size, 0.25 + 0.2 * g.unit()) };
        let b = s.dynamic(x + 0.5 * g.next(), 6.0 + 1.5 * row as f64, shape);
        (b.vx, b.angle) = (4.0 * g.next(), on_grid(PI * g.next()));
    }
    s
}

/// Steps from a kick of a room to the next one.
const KICK_EVERY: usize = 120;

/// A room of 30 crates that falls asleep, and of which a crate is kicked now and then, in other steps than in other rooms.
pub fn room(number: usize, steps: usize) -> Scene {
    let mut s = Scene::with_contacts("rooms", 100);
    s.sleep = true;
    s.fixed(0.0, -0.5, rectangle(11.0, 0.5));
    for side in [-1.0, 1.0] {
        s.fixed(side * 10.5, 5.0, rectangle(0.5, 5.0));
    }
    for i in 0..30 {
        let (row, column) = (i / 6, i % 6);
        s.dynamic((column as f64 - 2.5) * 1.05, 0.5 + row as f64, UNIT_BOX);
    }
    let mut g = Lcg(100 + number as u64);
    for step in (number * 37 % KICK_EVERY..steps).step_by(KICK_EVERY) {
        let body = 3 + (30.0 * g.unit()) as usize;
        s.kicks.push(Kick { step, body, vx: 6.0 * g.next(), vy: 4.0 * g.unit(), w: 0.0 });
    }
    s
}
