//! alice-physics, its separate 2D world (I64F64 fixed point). Its broad phase tests
//! every pair in every substep, so the larger scenes are refused.

use super::alice3d::f;
use crate::engine::{Engine, Hash, Info, Snapshot, State, World, locked_version};
use crate::scene::{Kind, Scene, Shape};
use alice_physics::Fix128;
use alice_physics::physics2d::{Joint2D, PhysicsConfig2D, PhysicsWorld2D, RigidBody2D, Shape2D, Vec2Fix};

pub struct Alice2d;

fn v2(x: f64, y: f64) -> Vec2Fix {
    Vec2Fix::new(f(x), f(y))
}

impl Engine for Alice2d {
    fn id(&self) -> &'static str {
        "alice-2d"
    }
    fn info(&self) -> Info {
        Info {
            version: format!("alice-physics {} (physics2d)", locked_version("alice-physics")),
            number: "I64F64 fixed point",
            build: "default features (std); AGPL".into(),
            solver: "defaults: XPBD, 4 substeps x 8 iterations, all-pairs broad phase, no sleeping, no snapshot; global damping 0.99 per step (default; from the scene in the free and accuracy scenes)",
            damping_law: "v *= f, once per step, one f per world; f = exp(-c*dt) is set by the harness",
            damped: |v0, c, dt, steps, _| v0 * (-c * dt * steps as f64).exp(),
            default_substeps: 4,
            body_struct_bytes: Some(std::mem::size_of::<RigidBody2D>()),
        }
    }
    fn refuse(&self, scene: &Scene) -> Option<String> {
        if scene.sleep {
            return Some("has no sleeping".into());
        }
        let n = scene.bodies.len() as f64;
        let boxes = scene.bodies.iter().any(|b| matches!(b.shape, Shape::Box { .. }));
        let circles = scene.bodies.iter().any(|b| matches!(b.shape, Shape::Circle { .. }));
        let pair_ns = if boxes {
            4000.0
        } else if circles {
            20.0
        } else {
            4.0
        };
        let est = 4.0 * n * n / 2.0 * pair_ns * 1e-9;
        (est > 0.9).then(|| format!("all-pairs broad phase: about {est:.0} s per step"))
    }
    fn build(&self, scene: &Scene) -> Box<dyn World> {
        let mut cfg = PhysicsConfig2D::default();
        cfg.gravity = v2(scene.gravity[0], scene.gravity[1]);
        let c = scene.bodies.iter().map(|b| b.lin_damp).fold(0.0, f64::max);
        if !scene.engine_damping {
            cfg.damping = f((-c * scene.dt).exp());
        }
        if let Some(n) = scene.substeps {
            cfg.substeps = n as usize;
        }
        let mut w = PhysicsWorld2D::new(cfg);
        for b in &scene.bodies {
            let (m, inertia) = b.mass_inertia();
            let shape = match b.shape {
                // Two edges never collide, so an edge stands for "no collider".
                Shape::None { .. } => Shape2D::Edge { start: v2(-0.1, 0.0), end: v2(0.1, 0.0) },
                Shape::Circle { r } => Shape2D::Circle { radius: f(r) },
                Shape::Box { hx, hy } => {
                    Shape2D::Polygon { vertices: vec![v2(-hx, -hy), v2(hx, -hy), v2(hx, hy), v2(-hx, hy)] }
                }
            };
            let mut rb = match b.kind {
                Kind::Fixed => RigidBody2D::new_static(v2(b.x, b.y), shape),
                Kind::Dynamic => RigidBody2D::new_dynamic(v2(b.x, b.y), f(m), shape),
            };
            rb.friction = f(scene.friction);
            rb.restitution = Fix128::ZERO;
            rb.angle = f(b.angle);
            rb.prev_angle = rb.angle;
            if b.kind == Kind::Dynamic {
                rb.inv_inertia = f(1.0 / inertia);
                rb.velocity = v2(b.vx, b.vy);
                rb.angular_velocity = f(b.w);
            }
            w.add_body(rb);
        }
        for j in &scene.joints {
            let (a, b) = (&scene.bodies[j.a], &scene.bodies[j.b]);
            w.add_joint(Joint2D::Revolute {
                body_a: j.a,
                body_b: j.b,
                local_anchor_a: v2(j.x - a.x, j.y - a.y),
                local_anchor_b: v2(j.x - b.x, j.y - b.y),
                compliance: Fix128::ZERO,
            });
        }
        Box::new(AWorld { w, dt: f(scene.dt) })
    }
}

struct AWorld {
    w: PhysicsWorld2D,
    dt: Fix128,
}

impl World for AWorld {
    fn step(&mut self) {
        self.w.step(self.dt);
    }
    fn body_count(&self) -> usize {
        self.w.bodies.len()
    }
    fn state(&self, i: usize) -> State {
        let b = &self.w.bodies[i];
        State {
            x: b.position.x.to_f64(),
            y: b.position.y.to_f64(),
            angle: b.angle.to_f64(),
            vx: b.velocity.x.to_f64(),
            vy: b.velocity.y.to_f64(),
            w: b.angular_velocity.to_f64(),
        }
    }
    fn hash(&self) -> u64 {
        let mut h = Hash::new();
        for b in &self.w.bodies {
            for x in [b.position.x, b.position.y, b.angle, b.velocity.x, b.velocity.y, b.angular_velocity] {
                h.word(x.hi as u64);
                h.word(x.lo);
            }
        }
        h.finish()
    }
    fn push(&mut self, i: usize, fx: f64, fy: f64) {
        let dt = self.dt;
        self.w.bodies[i].apply_force(v2(fx, fy), dt);
    }
    fn awake(&self) -> Option<usize> {
        None
    }
    fn contact_points(&self) -> Option<usize> {
        None
    }
    fn snapshot_kinds(&self) -> &'static [&'static str] {
        &["clone bodies"]
    }
    fn snapshot(&mut self, _kind: usize) -> Snapshot {
        Snapshot { bytes: None, data: Box::new(self.w.bodies.clone()) }
    }
    fn restore(&mut self, _kind: usize, snap: &Snapshot) {
        self.w.bodies = snap.data.downcast_ref::<Vec<RigidBody2D>>().unwrap().clone();
    }
}
