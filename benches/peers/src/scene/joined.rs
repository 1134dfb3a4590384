//! Scenes whose steps are timed, with limits, friction and motors in their joints.

use super::quality::{circle, ghost, on_grid, rectangle};
use super::{Body, Joint, Kind, Lcg, Motor, Scene, Shape};

/// Half the inner width of the container of [`ragdolls`], m.
pub const RAGDOLLS_HALF_WIDTH: f64 = 9.0;

/// The bodies of a ragdoll.
const PARTS: usize = 10;

/// A part of a ragdoll: a capsule, in m from the middle of its hips. All but the first one hang on a joint.
struct Part {
    at: [f64; 2],
    half: [f64; 2],
    r: f64,
    /// The part that it hangs on.
    parent: usize,
    joint: [f64; 2],
    limits: [f64; 2],
}

/// A man who stands with his arms stretched out, 1.6 m high: no part overlaps another one but the one it hangs on.
fn man() -> [Part; PARTS] {
    let torso = Part { at: [0.0, 0.3], half: [0.0, 0.17], r: 0.14, parent: 0, joint: [0.0; 2], limits: [0.0; 2] };
    let head = Part { at: [0.0, 0.76], half: [0.0, 0.02], r: 0.12, parent: 0, joint: [0.0, 0.62], limits: [-0.5, 0.5] };
    // Limits of the right side; the left side is its mirror image.
    let limb = |side: f64, at: [f64; 2], half: [f64; 2], r: f64, parent: usize, joint: [f64; 2], limits: [f64; 2]| {
        let [lower, upper] = limits;
        let limits = if side < 0.0 { [-upper, -lower] } else { limits };
        Part { at: [side * at[0], at[1]], half, r, parent, joint: [side * joint[0], joint[1]], limits }
    };
    let upper_arm = |side| limb(side, [0.3, 0.5], [0.1, 0.0], 0.045, 0, [0.16, 0.5], [-1.5, 1.2]);
    let forearm = |side, parent| limb(side, [0.6, 0.5], [0.1, 0.0], 0.04, parent, [0.45, 0.5], [0.0, 2.2]);
    let thigh = |side| limb(side, [0.08, -0.2], [0.0, 0.12], 0.06, 0, [0.08, 0.0], [-0.3, 1.2]);
    let shin = |side, parent| limb(side, [0.08, -0.58], [0.0, 0.13], 0.05, parent, [0.08, -0.39], [-1.8, 0.0]);
    [
        torso,
        head,
        upper_arm(1.0),
        forearm(1.0, 2),
        upper_arm(-1.0),
        forearm(-1.0, 4),
        thigh(1.0),
        shin(1.0, 6),
        thigh(-1.0),
        shin(-1.0, 8),
    ]
}

/// `n` ragdolls of 45 kg that fall into a container, with limits and friction in their joints.
pub fn ragdolls(n: usize) -> Scene {
    const COLUMNS: usize = 10;
    let mut s = Scene::with_contacts("ragdolls", n);
    s.container(RAGDOLLS_HALF_WIDTH);
    let mut g = Lcg(31);
    for i in 0..n {
        let (row, column) = (i / COLUMNS, i % COLUMNS);
        let middle = (COLUMNS as f64 - 1.0) / 2.0;
        let [x, y] = [(column as f64 - middle) * 1.7 + 0.1 * g.next(), 1.2 + 1.9 * row as f64].map(on_grid);
        let (first, spin) = (s.bodies.len(), on_grid(g.next()));
        for (k, part) in man().into_iter().enumerate() {
            let half = part.half.map(on_grid);
            let body = s.dynamic(x + part.at[0], y + part.at[1], Shape::Capsule { half, r: on_grid(part.r) });
            (body.density, body.w) = (100.0, if k == 0 { spin } else { 0.0 });
            if k > 0 {
                let [x, y] = [x + part.joint[0], y + part.joint[1]].map(on_grid);
                s.joints.push(Joint {
                    limits: Some(part.limits.map(on_grid)),
                    motor: Some(Motor { speed: 0.0, max_torque: 1.0 }),
                    ..Joint::revolute(first + part.parent, first + k, x, y)
                });
            }
        }
    }
    s
}

/// Box2D's joint grid: `side` × `side` discs, which collide with nothing, each on pins half way to its neighbours. Seven of the upper row are fixed.
pub fn joint_grid(side: usize) -> Scene {
    let mut s = Scene::new("joint_grid", side * side);
    let disc = ghost(circle(0.4), 1.0);
    for column in 0..side {
        for row in 0..side {
            let (x, y) = (column as f64, -(row as f64));
            let is_fixed = row == 0 && column.abs_diff(side / 2) <= 3;
            s.add(if is_fixed { Kind::Fixed } else { Kind::Dynamic }, x, y, disc);
            let me = column * side + row;
            if row > 0 {
                s.joints.push(Joint::revolute(me - 1, me, x, y + 0.5));
            }
            if column > 0 && !(is_fixed && s.bodies[me - side].kind == Kind::Fixed) {
                s.joints.push(Joint::revolute(me - side, me, x - 0.5, y));
            }
        }
    }
    s
}

/// Half the inner size of the drum of [`tumbler`], m.
pub const TUMBLER: f64 = 10.0;

/// Box2D's tumbler: a square drum that a motor turns by 25° a second, with `side` × `side` small boxes in it.
pub fn tumbler(side: usize) -> Scene {
    let mut s = Scene::with_contacts("tumbler", side * side);
    s.fixed(0.0, 0.0, ghost(circle(0.5), 1.0));
    let drum = Shape::Frame { hx: TUMBLER, hy: TUMBLER, wall: 1.0 };
    s.dynamic(0.0, 0.0, drum).density = 50.0;
    let motor = Motor { speed: on_grid(25.0f64.to_radians()), max_torque: 1e8 };
    s.joints.push(Joint { motor: Some(motor), ..Joint::revolute(0, 1, 0.0, 0.0) });
    let middle = (side as f64 - 1.0) / 2.0;
    for row in 0..side {
        for column in 0..side {
            let [x, y] = [row, column].map(|k| 0.4 * (k as f64 - middle));
            s.dynamic(x, y, rectangle(0.125, 0.125));
        }
    }
    s
}

/// The [`spinner`](super::spinner) with a bar on a motor in place of a kinematic one, as Box2D has it.
pub fn motor_spinner(n: usize) -> Scene {
    let mut s = super::spinner(n);
    s.name = "motor_spinner".into();
    let bar = s.bodies.iter().position(|b| b.kind == Kind::Kinematic).expect("the spinner has a bar");
    let motor = Motor { speed: s.bodies[bar].w, max_torque: 1e6 };
    let (x, y) = (s.bodies[bar].x, s.bodies[bar].y);
    s.bodies[bar].kind = Kind::Dynamic;
    let friction = s.bodies[bar].friction;
    let hub = Body { kind: Kind::Fixed, friction, ..Body::dynamic(x, y, ghost(circle(0.5), 1.0)) };
    s.bodies.push(hub);
    s.joints.push(Joint { motor: Some(motor), ..Joint::revolute(s.bodies.len() - 1, bar, x, y) });
    s
}
