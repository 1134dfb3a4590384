//! Scenes of impacts, each with what mechanics says of it.
//!
//! Trials of one kind stand side by side in a scene, far enough apart that they never meet. The last bodies are the moving ones.

use super::quality::{UNIT_BOX, circle, on_grid, rectangle};
use super::{Lcg, Scene, Shape};
use std::f64::consts::PI;

/// Trials of a scene.
pub const TRIALS: usize = 100;
/// The distance between trials, m.
const APART: f64 = 40.0;

/// The place of a trial.
fn place(trial: usize) -> [f64; 2] {
    [(trial % 10) as f64 * APART, (trial / 10) as f64 * APART]
}

/// Discs that fly past the corner of a box, 1 cm to 1 m away, at 20 to 100 m/s. They touch nothing in the first 10 steps, and keep their
/// velocity. Body `TRIALS + i` is the disc of trial `i`.
pub fn ghosts() -> Scene {
    let mut s = Scene { gravity: [0.0, 0.0], ..Scene::with_contacts("impacts_ghosts", TRIALS) };
    let mut g = Lcg(3);
    let (mut discs, half) = (Vec::new(), 1.0);
    for trial in 0..TRIALS {
        let [x, y] = place(trial);
        s.fixed(x, y, rectangle(half, half));
        let (r, clearance, speed) = (0.2 + 0.3 * g.unit(), 0.01 + 0.99 * g.unit(), 20.0 + 80.0 * g.unit());
        // Along a line past the corner (1, 1), on the outer side: its direction leans to the diagonal by up to 30 degrees.
        let way = -0.25 * PI + g.next() * PI / 6.0;
        let (direction, outward) = ([way.cos(), way.sin()], [-way.sin(), way.cos()]);
        let (back, beside) = (speed * (1.0 + 4.0 * g.unit()) / 60.0, r + clearance);
        let at = [0, 1].map(|k| half - back * direction[k] + beside * outward[k]);
        discs.push((x + at[0], y + at[1], r, direction.map(|part| on_grid(speed * part))));
    }
    for (x, y, r, [vx, vy]) in discs {
        let disc = s.dynamic(x, y, circle(r));
        (disc.vx, disc.vy, disc.restitution) = (vx, vy, 0.5);
    }
    s
}

/// The restitution of the walls of [`bounces`].
pub const RESTITUTION: f64 = 0.8;

/// Discs that slide over a floor without friction, against a wall at 2 to 20 m/s. They leave it with 0.8 of that. Body `2 * TRIALS + i` is the
/// disc of trial `i`.
pub fn bounces() -> Scene {
    let mut s = Scene::with_contacts("impacts_bounces", TRIALS);
    let mut g = Lcg(5);
    for trial in 0..TRIALS {
        let [x, y] = place(trial);
        let floor = s.fixed(x, y - 1.0, rectangle(18.0, 1.0));
        floor.friction = 0.0;
        let wall = s.fixed(x + 17.0, y + 2.0, rectangle(1.0, 2.0));
        (wall.friction, wall.restitution) = (0.0, RESTITUTION);
    }
    for trial in 0..TRIALS {
        let ([x, y], speed) = (place(trial), 2.0 + 18.0 * g.unit());
        // At the wall after 20 to 30 steps: by then it rests on the floor.
        let way = speed * (20.0 + 10.0 * g.unit()) / 60.0;
        let disc = s.dynamic(x + 15.5 - way, y + 0.5, circle(0.5));
        (disc.friction, disc.vx) = (0.0, on_grid(speed));
    }
    s
}

/// 40 elastic discs in a box, without gravity and friction. They keep their kinetic energy.
pub fn gas(seed: u64) -> Scene {
    let mut s = Scene { gravity: [0.0, 0.0], ..Scene::with_contacts("impacts_gas", 40) };
    let mut g = Lcg(seed);
    for side in [-1.0, 1.0] {
        s.fixed(side * 11.0, 0.0, rectangle(1.0, 12.0));
        s.fixed(0.0, side * 11.0, rectangle(12.0, 1.0));
    }
    for i in 0..40 {
        let (row, column) = ((i / 8) as f64, (i % 8) as f64);
        let disc = s.dynamic(-8.4 + 2.4 * column, -8.0 + 4.0 * row, circle(0.3 + 0.5 * g.unit()));
        (disc.vx, disc.vy) = (on_grid(8.0 * g.next()), on_grid(8.0 * g.next()));
    }
    for body in &mut s.bodies {
        (body.friction, body.restitution) = (0.0, 1.0);
    }
    s
}

/// The gaps of rows, m, and the speeds of the discs that come, m/s.
pub const GAPS: [f64; 4] = [0.01, 0.03, 0.1, 0.3];
pub const SPEEDS: [f64; 3] = [3.0, 10.0, 30.0];
/// The discs of a row.
pub const ROW: usize = 6;

/// Elastic discs in rows with gaps, the first of each on its way to the next one: the last one leaves with its speed, and the others rest. Body
/// `ROW * i + k` is disc `k` of row `i`.
pub fn rows() -> Scene {
    let mut s = Scene { gravity: [0.0, 0.0], ..Scene::with_contacts("impacts_rows", GAPS.len() * SPEEDS.len()) };
    for (number, (gap, speed)) in GAPS.into_iter().flat_map(|gap| SPEEDS.map(|speed| (gap, speed))).enumerate() {
        for k in 0..ROW {
            let disc = s.dynamic(k as f64 * (1.0 + gap), 10.0 * number as f64, circle(0.5));
            (disc.friction, disc.restitution) = (0.0, 1.0);
            if k == 0 {
                (disc.x, disc.vx) = (on_grid(-1.3), speed);
            }
        }
    }
    s
}

/// The heights from which crates fall on overhangs, m.
pub const DROPS: [f64; 5] = [0.1, 0.2, 0.3, 0.4, 0.5];

/// Stacks of three crates of which the third one overhangs by 0.3 m, and one more that falls on it with 0.55 m: exact spins after the impact
/// are below 0.06 rad/s, and the stacks stand. Body `4 * i + k` is crate `k` of stack `i`, counted after the floor.
pub fn overhang() -> Scene {
    let mut s = Scene::with_contacts("impacts_overhang", DROPS.len());
    s.floor(50.0);
    for (i, drop) in DROPS.into_iter().enumerate() {
        let x = 10.0 * i as f64 - 20.0;
        for (offset, y) in [(0.0, 0.5), (0.0, 1.5), (0.3, 2.5), (0.55, 3.5 + drop)] {
            s.dynamic(x + offset, y, UNIT_BOX);
        }
    }
    s
}

/// A disc in half a pipe of 3 m of 60 plates, without friction: its energy never rises.
pub fn half_pipe() -> Scene {
    const PLATES: usize = 60;
    let mut s = Scene::with_contacts("impacts_half_pipe", PLATES);
    let half = 3.0 * (PI / 2.0 / PLATES as f64).tan();
    for i in 0..PLATES {
        let angle = PI * (i as f64 + 0.5) / PLATES as f64;
        let distance = 3.0 + 0.25;
        let plate = s.fixed(distance * angle.cos(), 3.0 - distance * angle.sin(), rectangle(half, 0.25));
        (plate.angle, plate.friction) = (on_grid(0.5 * PI - angle), 0.0);
    }
    let (sin, cos) = 0.62f64.sin_cos();
    let disc = s.dynamic(2.744 * sin, 3.0 - 2.744 * cos, circle(0.25));
    disc.friction = 0.0;
    s
}

/// Discs at 5 m/s across corridors that are 1 cm too narrow for them: they come to rest. Body `2 * i` from the walls on is one of each restitution.
pub fn corridor() -> Scene {
    let mut s = Scene { gravity: [0.0, 0.0], ..Scene::with_contacts("impacts_corridor", 4) };
    for i in 0..4 {
        for side in [-1.0, 1.0] {
            s.fixed(10.0 * i as f64, side * 1.5, rectangle(4.0, 1.0)).friction = 0.0;
        }
    }
    for i in 0..4 {
        let disc = s.dynamic(10.0 * i as f64, 0.0, Shape::Circle { r: on_grid(0.505) });
        (disc.vy, disc.friction, disc.restitution) = (5.0, 0.0, 0.3 * i as f64);
    }
    s
}
