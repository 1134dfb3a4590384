//! Twins of a scene: runs that a fair engine gives the same bits.

use super::{Body, Corners, Joint, Lcg, Motor, Scene, Shape, Symmetry};
use crate::engine::State;

/// A reflection.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Mirror {
    /// (x, y) becomes (-x, y).
    X,
    /// (x, y) becomes (x, -y).
    Y,
}

impl Mirror {
    pub fn point(self, [x, y]: [f64; 2]) -> [f64; 2] {
        match self {
            Mirror::X => [-x, y],
            Mirror::Y => [x, -y],
        }
    }

    /// The mirror image. Angles, spins and surface speeds change their sign; the corners of
    /// a polygon come in reverse order, so that they stay counter-clockwise.
    pub fn body(self, b: &Body) -> Body {
        let [x, y] = self.point([b.x, b.y]);
        let [vx, vy] = self.point([b.vx, b.vy]);
        let shape = match b.shape {
            Shape::Polygon(corners) => {
                let image: Vec<_> = corners.as_slice().iter().rev().map(|&c| self.point(c)).collect();
                Shape::Polygon(Corners::new(&image))
            }
            Shape::Capsule { half, r } => Shape::Capsule { half: self.point(half), r },
            same => same,
        };
        Body { x, y, vx, vy, shape, angle: -b.angle, w: -b.w, surface_speed: -b.surface_speed, ..*b }
    }

    fn joint(self, j: &Joint) -> Joint {
        let [x, y] = self.point([j.x, j.y]);
        let limits = j.limits.map(|[lower, upper]| [-upper, -lower]);
        let motor = j.motor.map(|motor| Motor { speed: -motor.speed, ..motor });
        Joint { x, y, rod_end: j.rod_end.map(|p| self.point(p)), limits, motor, ..*j }
    }

    pub fn state(self, q: State) -> State {
        let [x, y] = self.point([q.x, q.y]);
        let [vx, vy] = self.point([q.vx, q.vy]);
        State { x, y, angle: -q.angle, vx, vy, w: -q.w }
    }
}

impl Scene {
    /// Declares the scene its own mirror image. Panics unless the mirror image of each body
    /// is a body of the scene, to the last bit.
    pub(super) fn symmetric(mut self, mirror: Mirror) -> Self {
        let partner = self.bodies.iter().enumerate().map(|(i, b)| {
            let image = mirror.body(b);
            let place = self.bodies.iter().position(|candidate| *candidate == image);
            place.unwrap_or_else(|| panic!("{}: body {i} has no mirror image", self.name))
        });
        let partner = partner.collect();
        self.symmetry = Some(Symmetry { mirror, partner });
        self
    }
}

/// The scene mirrored at x = 0, bodies and joints in the same order.
pub fn mirrored(s: &Scene) -> Scene {
    Scene {
        name: format!("{} mirrored", s.name),
        gravity: Mirror::X.point(s.gravity),
        bodies: s.bodies.iter().map(|b| Mirror::X.body(b)).collect(),
        joints: s.joints.iter().map(|j| Mirror::X.joint(j)).collect(),
        ..s.clone()
    }
}

/// The scene with bodies and joints in another order, and for each of its bodies the index
/// that it has in `s`.
pub fn shuffled(s: &Scene, seed: u64) -> (Scene, Vec<usize>) {
    let mut random = Lcg(seed);
    let mut order = |n: usize| {
        let mut v: Vec<usize> = (0..n).collect();
        for k in (1..n).rev() {
            v.swap(k, (random.unit() * (k + 1) as f64) as usize);
        }
        v
    };
    let (bodies, joints) = (order(s.bodies.len()), order(s.joints.len()));
    let mut place = vec![0; bodies.len()];
    for (k, &i) in bodies.iter().enumerate() {
        place[i] = k;
    }
    let moved = |j: &Joint| Joint { a: place[j.a], b: place[j.b], ..*j };
    let twin = Scene {
        name: format!("{} shuffled", s.name),
        bodies: bodies.iter().map(|&i| s.bodies[i]).collect(),
        joints: joints.iter().map(|&i| moved(&s.joints[i])).collect(),
        symmetry: None,
        ..s.clone()
    };
    (twin, bodies)
}
