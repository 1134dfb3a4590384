//! alice-physics, its 3D world (I64F64 fixed point), with bodies kept in a plane.

use crate::engine::{Engine, Hash, Info, Snapshot, State, World, locked_version};
use crate::scene::{Kind, Scene, Shape};
use alice_physics::joint::{BallJoint, Joint};
use alice_physics::shape::Shape as AShape;
use alice_physics::{Fix128, PhysicsConfig, PhysicsWorld, QuatFix, RigidBody, SleepConfig, Vec3Fix};

pub struct Alice3d;

pub fn f(x: f64) -> Fix128 {
    Fix128::from_f64(x)
}
fn v3(x: f64, y: f64) -> Vec3Fix {
    Vec3Fix::new(f(x), f(y), Fix128::ZERO)
}

impl Engine for Alice3d {
    fn id(&self) -> &'static str {
        "alice-3d"
    }
    fn info(&self) -> Info {
        Info {
            version: format!("alice-physics {}", locked_version("alice-physics")),
            number: "I64F64 fixed point, 3D",
            build: "default features (std); AGPL".into(),
            solver: "defaults: XPBD, 8 substeps x 1 iteration, BVH rebuilt every substep; global damping 0.99 per step (default; 1 in the free and accuracy scenes)",
            damping_law: "v *= f, once per step; f = exp(-c*dt) is set by the harness",
            damped: |v0, c, dt, steps, _| v0 * (-c * dt * steps as f64).exp(),
            default_substeps: 8,
            body_struct_bytes: Some(std::mem::size_of::<RigidBody>()),
        }
    }
    fn build(&self, scene: &Scene) -> Box<dyn World> {
        let mut cfg = PhysicsConfig::default();
        cfg.gravity = v3(scene.gravity[0], scene.gravity[1]);
        if !scene.engine_damping {
            cfg.damping = Fix128::ONE;
        }
        if let Some(n) = scene.substeps {
            cfg.substeps = n as usize;
        }
        let mut w = PhysicsWorld::new(cfg);
        if !scene.sleep {
            w.set_sleep_config(SleepConfig { frames_to_sleep: u32::MAX, ..SleepConfig::default() });
        }
        for b in &scene.bodies {
            let (m, inertia) = b.mass_inertia();
            let mut rb = match b.kind {
                Kind::Fixed => RigidBody::new_static(v3(b.x, b.y)),
                Kind::Dynamic => RigidBody::new_dynamic(v3(b.x, b.y), f(m)),
            };
            rb.friction = f(scene.friction);
            rb.restitution = Fix128::ZERO;
            if b.angle != 0.0 {
                rb.set_rotation(QuatFix::new(
                    Fix128::ZERO,
                    Fix128::ZERO,
                    f((b.angle / 2.0).sin()),
                    f((b.angle / 2.0).cos()),
                ));
            }
            if b.kind == Kind::Dynamic {
                let inv = f(1.0 / inertia);
                rb.inv_inertia = Vec3Fix::new(inv, inv, inv);
                rb.velocity = v3(b.vx, b.vy);
                rb.angular_velocity = Vec3Fix::new(Fix128::ZERO, Fix128::ZERO, f(b.w));
                rb.linear_damping = f((-b.lin_damp * scene.dt).exp());
                rb.angular_damping = f((-b.ang_damp * scene.dt).exp());
            }
            match b.shape {
                Shape::None { .. } => {
                    w.add_body(rb);
                }
                Shape::Circle { r } => {
                    w.add_body_with_radius(rb, f(r));
                }
                Shape::Box { hx, hy } => {
                    let i = w.add_body(rb);
                    let hz = if b.kind == Kind::Fixed { 4.0 } else { 0.5 };
                    w.set_body_shape(i, &AShape::Box { half_extents: Vec3Fix::new(f(hx), f(hy), f(hz)) });
                }
            }
        }
        for j in &scene.joints {
            let (a, b) = (&scene.bodies[j.a], &scene.bodies[j.b]);
            w.add_joint(Joint::Ball(BallJoint::new(j.a, j.b, v3(j.x - a.x, j.y - a.y), v3(j.x - b.x, j.y - b.y))));
        }
        Box::new(AWorld { w, dt: f(scene.dt) })
    }
}

struct AWorld {
    w: PhysicsWorld,
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
            angle: 2.0 * b.rotation.z.to_f64().atan2(b.rotation.w.to_f64()),
            vx: b.velocity.x.to_f64(),
            vy: b.velocity.y.to_f64(),
            w: b.angular_velocity.z.to_f64(),
        }
    }
    fn hash(&self) -> u64 {
        let mut h = Hash::new();
        for b in &self.w.bodies {
            let (p, v, w, q) = (b.position, b.velocity, b.angular_velocity, b.rotation);
            for x in [p.x, p.y, p.z, v.x, v.y, v.z, w.x, w.y, w.z, q.x, q.y, q.z, q.w] {
                h.word(x.hi as u64);
                h.word(x.lo);
            }
        }
        h.finish()
    }
    fn push(&mut self, i: usize, fx: f64, fy: f64) {
        let dt = self.dt;
        self.w.bodies[i].add_force(v3(fx, fy), dt);
    }
    fn awake(&self) -> Option<usize> {
        Some((0..self.w.bodies.len()).filter(|&i| !self.w.bodies[i].is_static() && !self.w.is_sleeping(i)).count())
    }
    fn contact_points(&self) -> Option<usize> {
        Some(self.w.contact_constraints.len())
    }
    fn snapshot_kinds(&self) -> &'static [&'static str] {
        &["snapshot_world", "serialize_state"]
    }
    fn snapshot(&mut self, kind: usize) -> Snapshot {
        let v = if kind == 0 { self.w.snapshot_world() } else { self.w.serialize_state() };
        Snapshot { bytes: Some(v.len()), data: Box::new(v) }
    }
    fn restore(&mut self, kind: usize, snap: &Snapshot) {
        let v = snap.data.downcast_ref::<Vec<u8>>().unwrap();
        if kind == 0 {
            self.w.restore_world(v).expect("restore");
        } else {
            assert!(self.w.deserialize_state(v), "restore");
        }
    }
}
