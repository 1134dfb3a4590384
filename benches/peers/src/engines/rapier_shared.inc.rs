// Included by rapier_f32.rs and rapier_f64.rs: the two crates have the same API.

use crate::engine::{Engine, Hash, Info, Snapshot, State, World, locked_version};
use crate::scene::{self, Kind, Scene, Shape};
use rapier::math::{Real, Vector};
use rapier::parry::mass_properties::MassProperties;
use rapier::prelude::*;

pub struct Rapier;

impl Engine for Rapier {
    fn id(&self) -> &'static str {
        ID
    }
    fn info(&self) -> Info {
        Info {
            version: locked_version(CRATE),
            number: NUMBER,
            build: if cfg!(feature = "determinism") {
                "enhanced-determinism, serde-serialize; default SIMD of 4 lanes (wide), target baseline"
            } else if cfg!(feature = "avx2") {
                "without enhanced-determinism; simd8: in f32 SIMD of 8 lanes (wide), -C target-feature=+avx2,+fma"
            } else {
                "without enhanced-determinism; default SIMD of 4 lanes (wide), target baseline"
            }
            .into(),
            solver: "defaults: 4 substeps (num_solver_iterations) x 1 PGS + 1 stabilization, soft contacts 30 Hz, \
                     block solver, contact recycling, speculative CCD (max_ccd_substeps 1)"
                .into(),
            damping_law: "v *= 1/(1+c*dt), once per step",
            damped: |v0, c, dt, steps, _| v0 * (1.0 / (1.0 + c * dt)).powi(steps as i32),
            default_substeps: 4,
            body_struct_bytes: Some(std::mem::size_of::<RigidBody>()),
        }
    }
    fn refuse(&self, scene: &Scene) -> Option<String> {
        let lacks = if scene.bodies.iter().any(|b| b.surface_speed != 0.0) {
            "surface speeds"
        } else if scene.bodies.iter().any(|b| b.friction != scene.bodies[0].friction) {
            "a mean of frictions that is geometric"
        } else if scene.joints.iter().any(|j| j.rod_end.is_some()) {
            "rods"
        } else if scene.joints.iter().any(|j| scene.bodies[j.a].angle != scene.bodies[j.b].angle) {
            "joints between bodies at different angles"
        } else {
            return None;
        };
        Some(format!("the harness does not map {lacks}"))
    }
    fn build(&self, scene: &Scene) -> Box<dyn World> {
        let mut w = PhysicsWorld::new();
        w.gravity = vec2(scene.gravity[0], scene.gravity[1]);
        w.integration_parameters.dt = scene.dt as Real;
        if let Some(n) = scene.substeps {
            w.integration_parameters.num_solver_iterations = n as usize;
        }
        let mut handles = Vec::with_capacity(scene.bodies.len());
        for b in &scene.bodies {
            let rb = match b.kind {
                Kind::Fixed => RigidBodyBuilder::fixed(),
                Kind::Kinematic => RigidBodyBuilder::kinematic_velocity_based(),
                Kind::Dynamic => RigidBodyBuilder::dynamic(),
            };
            let mut rb = rb
                .translation(vec2(b.x, b.y))
                .rotation(b.angle as Real)
                .linvel(vec2(b.vx, b.vy))
                .angvel(b.w as Real)
                .linear_damping(b.lin_damp as Real)
                .angular_damping(b.ang_damp as Real)
                .can_sleep(scene.sleep);
            if let Shape::None { mass, inertia } = b.shape {
                rb = rb.additional_mass_properties(MassProperties::new(vec2(0.0, 0.0), mass as Real, inertia as Real));
            }
            let h = w.bodies.insert(rb);
            let colliders = match b.shape {
                Shape::None { .. } => vec![],
                Shape::Circle { r } => vec![ColliderBuilder::ball(r as Real)],
                Shape::Box { hx, hy } => vec![ColliderBuilder::cuboid(hx as Real, hy as Real)],
                Shape::Capsule { half: [x, y], r } => {
                    vec![ColliderBuilder::capsule_from_endpoints(vec2(-x, -y), vec2(x, y), r as Real)]
                }
                Shape::Polygon(corners) => {
                    let points = corners.as_slice().iter().map(|c| vec2(c[0], c[1])).collect();
                    vec![ColliderBuilder::convex_polyline(points).expect("a convex polygon")]
                }
                Shape::Frame { hx, hy, wall } => {
                    let cuboid = |wall: &scene::Wall| {
                        let ([x, y], [half_x, half_y]) = (wall.at, wall.half);
                        ColliderBuilder::cuboid(half_x as Real, half_y as Real).translation(vec2(x, y))
                    };
                    scene::walls(hx, hy, wall).iter().map(cuboid).collect()
                }
            };
            for co in colliders {
                // Friction mixes by the mean, which is the scenes' rule where all are equal.
                let co = co
                    .density(b.density as Real)
                    .friction(b.friction as Real)
                    .restitution(b.restitution as Real)
                    .restitution_combine_rule(CoefficientCombineRule::Max);
                w.colliders.insert_with_parent(co, h, &mut w.bodies);
            }
            handles.push(h);
        }
        for j in &scene.joints {
            let [a, b] = j.anchors(&scene.bodies);
            let mut joint = RevoluteJointBuilder::new()
                .local_anchor1(vec2(a[0], a[1]))
                .local_anchor2(vec2(b[0], b[1]))
                .contacts_enabled(false);
            if let Some([lower, upper]) = j.limits {
                joint = joint.limits([lower as Real, upper as Real]);
            }
            if let Some(motor) = j.motor {
                joint = joint.motor_velocity(motor.speed as Real, STIFF).motor_max_force(motor.max_torque as Real);
            }
            w.impulse_joints.insert(handles[j.a], handles[j.b], joint, true);
        }
        Box::new(RapierWorld { w, handles })
    }
}

/// The factor of motors, 1/s: so large that they reach their speed in a step, as the motors of the others do.
const STIFF: Real = 1e4;

fn vec2(x: f64, y: f64) -> Vector {
    Vector::new(x as Real, y as Real)
}

struct RapierWorld {
    w: PhysicsWorld,
    handles: Vec<RigidBodyHandle>,
}

/// Everything a step reads, without the pipelines (workspace only).
fn clone_world(w: &PhysicsWorld) -> PhysicsWorld {
    PhysicsWorld {
        gravity: w.gravity,
        integration_parameters: w.integration_parameters,
        physics_pipeline: PhysicsPipeline::new(),
        collision_pipeline: CollisionPipeline::new(),
        islands: w.islands.clone(),
        broad_phase: w.broad_phase.clone(),
        narrow_phase: w.narrow_phase.clone(),
        bodies: w.bodies.clone(),
        colliders: w.colliders.clone(),
        impulse_joints: w.impulse_joints.clone(),
        multibody_joints: w.multibody_joints.clone(),
        soft_bodies: w.soft_bodies.clone(),
        ccd_solver: CCDSolver::new(),
    }
}

impl World for RapierWorld {
    fn step(&mut self) {
        self.w.step();
    }
    fn body_count(&self) -> usize {
        self.w.bodies.len()
    }
    fn state(&self, i: usize) -> State {
        let b = &self.w.bodies[self.handles[i]];
        let (p, v) = (b.translation(), b.linvel());
        State {
            x: p.x as f64,
            y: p.y as f64,
            angle: b.rotation().angle() as f64,
            vx: v.x as f64,
            vy: v.y as f64,
            w: b.angvel() as f64,
        }
    }
    fn hash(&self) -> u64 {
        let mut h = Hash::new();
        for &k in &self.handles {
            let b = &self.w.bodies[k];
            let (p, v, q) = (b.translation(), b.linvel(), b.rotation());
            for f in [p.x, p.y, v.x, v.y, q.re, q.im, b.angvel()] {
                h.word(f.to_bits() as u64);
            }
        }
        h.finish()
    }
    fn push(&mut self, i: usize, fx: f64, fy: f64) {
        let b = &mut self.w.bodies[self.handles[i]];
        b.reset_forces(false);
        b.add_force(vec2(fx, fy), true);
    }
    fn set_velocity(&mut self, i: usize, [x, y, angular]: [f64; 3]) {
        let body = &mut self.w.bodies[self.handles[i]];
        body.set_linvel(vec2(x, y), true);
        body.set_angvel(angular as Real, true);
    }
    fn awake(&self) -> Option<usize> {
        Some(
            self.handles
                .iter()
                .filter(|&&h| {
                    let b = &self.w.bodies[h];
                    b.is_dynamic() && !b.is_sleeping()
                })
                .count(),
        )
    }
    fn contact_points(&self) -> Option<usize> {
        Some(
            self.w
                .narrow_phase
                .contact_pairs()
                .flat_map(|p| p.manifolds().iter())
                .map(|m| m.data.solver_contacts.len())
                .sum(),
        )
    }
    fn cast_rays(&mut self, rays: &[scene::Ray], fractions: &mut [f64]) -> bool {
        // One for all rays: making it costs something.
        let queries = self.w.query_pipeline_with_filter(QueryFilter::default());
        for (ray, fraction) in rays.iter().zip(fractions) {
            let ray = Ray::new(vec2(ray.from[0], ray.from[1]), vec2(ray.by[0], ray.by[1]));
            let hit = queries.cast_ray_and_get_normal(&ray, 1.0, true);
            *fraction = hit.map_or(2.0, |(_, hit)| hit.time_of_impact as f64);
        }
        true
    }
    fn snapshot_kinds(&self) -> &'static [&'static str] {
        &["clone", "bincode"]
    }
    fn snapshot(&mut self, kind: usize) -> Snapshot {
        if kind == 0 {
            Snapshot { bytes: None, data: Box::new(clone_world(&self.w)) }
        } else {
            let v = bincode::serialize(&self.w).expect("serialize");
            Snapshot { bytes: Some(v.len()), data: Box::new(v) }
        }
    }
    fn restore(&mut self, kind: usize, snap: &Snapshot) {
        self.w = if kind == 0 {
            clone_world(snap.data.downcast_ref::<PhysicsWorld>().unwrap())
        } else {
            bincode::deserialize(snap.data.downcast_ref::<Vec<u8>>().unwrap()).expect("deserialize")
        };
    }
}
