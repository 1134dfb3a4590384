//! Box2D v3 (C), the copy bundled by boxdd, through its raw C API.

use crate::engine::{Engine, Hash, Info, PARTS, Snapshot, State, World, locked_version};
use crate::scene::{Body, Joint, Kind, Ray, Scene, Shape, walls};
use boxdd_sys::ffi::*;
use std::collections::HashSet;

// Keeps the safe crate linked, so both crates stay at one release.
use boxdd as _;

pub struct Box2d {
    id: &'static str,
    workers: u32,
}

const SUBSTEPS: u32 = 4;

const ID: &str = if cfg!(feature = "avx2") { "box2d-avx2" } else { "box2d" };

impl Box2d {
    pub fn new() -> Self {
        Self { id: ID, workers: 1 }
    }

    /// The engine with options, by its id: `box2d@workers=2`, on Box2D's own scheduler.
    pub fn with_options(id: &str) -> Option<Self> {
        let workers = id.strip_prefix(ID)?.strip_prefix("@workers=")?.parse().ok()?;
        // Ids live as long as the program, and there are few.
        (1..=64).contains(&workers).then(|| Self { id: String::from(id).leak(), workers })
    }
}

impl Engine for Box2d {
    fn id(&self) -> &'static str {
        self.id
    }
    fn info(&self) -> Info {
        let v = unsafe { b2GetVersion() };
        Info {
            version: format!("Box2D {}.{}.{} in boxdd {}", v.major, v.minor, v.revision, locked_version("boxdd")),
            number: "f32",
            build: format!(
                "C, -O2 -ffp-contract=off, then CFLAGS={:?}; {}, workers: {}",
                option_env!("CFLAGS").unwrap_or(""),
                if cfg!(feature = "avx2") { "AVX2 of 8 lanes" } else { "SSE2 SIMD of 4 lanes" },
                self.workers
            ),
            solver: "defaults: soft step, 4 substeps, contacts 30 Hz, contact recycling, continuous on".into(),
            damping_law: "v *= 1/(1+c*h), every substep h",
            damped: |v0, c, dt, steps, sub| v0 * (1.0 / (1.0 + c * dt / sub as f64)).powi((steps * sub) as i32),
            default_substeps: SUBSTEPS,
            body_struct_bytes: None,
        }
    }
    fn build(&self, scene: &Scene) -> Box<dyn World> {
        unsafe {
            let mut wd = b2DefaultWorldDef();
            wd.gravity = v2(scene.gravity[0], scene.gravity[1]);
            wd.enableSleep = scene.sleep;
            wd.workerCount = self.workers as i32;
            let world = b2CreateWorld(&wd);
            let ids: Vec<_> = scene.bodies.iter().map(|b| add_body(world, scene, b)).collect();
            // A better tree than that of insertions one by one.
            b2World_RebuildStaticTree(world);
            for j in &scene.joints {
                add_joint(world, scene, &ids, j);
            }
            Box::new(B2World { world, ids, dt: scene.dt as f32, substeps: scene.substeps.unwrap_or(SUBSTEPS) as i32 })
        }
    }
}

fn v2(x: f64, y: f64) -> b2Vec2 {
    b2Vec2 { x: x as f32, y: y as f32 }
}

unsafe fn add_body(world: b2WorldId, scene: &Scene, b: &Body) -> b2BodyId {
    unsafe {
        let mut bd = b2DefaultBodyDef();
        bd.type_ = match b.kind {
            Kind::Fixed => b2BodyType_b2_staticBody,
            Kind::Kinematic => b2BodyType_b2_kinematicBody,
            Kind::Dynamic => b2BodyType_b2_dynamicBody,
        };
        bd.position = v2(b.x, b.y);
        bd.rotation = b2Rot { c: b.angle.cos() as f32, s: b.angle.sin() as f32 };
        bd.linearVelocity = v2(b.vx, b.vy);
        bd.angularVelocity = b.w as f32;
        bd.linearDamping = b.lin_damp as f32;
        bd.angularDamping = b.ang_damp as f32;
        bd.enableSleep = scene.sleep;
        let id = b2CreateBody(world, &bd);
        // Box2D mixes as the scenes say: sqrt for friction, max for restitution, the sum of the tangent speeds.
        let mut sd = b2DefaultShapeDef();
        sd.density = b.density as f32;
        sd.material.friction = b.friction as f32;
        sd.material.restitution = b.restitution as f32;
        sd.material.tangentSpeed = b.surface_speed as f32;
        match b.shape {
            Shape::None { mass, inertia } => {
                if b.kind == Kind::Dynamic {
                    let (mass, inertia) = (mass as f32, inertia as f32);
                    b2Body_SetMassData(id, b2MassData { mass, center: v2(0.0, 0.0), rotationalInertia: inertia });
                }
            }
            Shape::Circle { r } => {
                b2CreateCircleShape(id, &sd, &b2Circle { center: v2(0.0, 0.0), radius: r as f32 });
            }
            Shape::Box { hx, hy } => {
                let p = b2MakeBox(hx as f32, hy as f32);
                b2CreatePolygonShape(id, &sd, &p);
            }
            Shape::Capsule { half: [x, y], r } => {
                let capsule = b2Capsule { center1: v2(-x, -y), center2: v2(x, y), radius: r as f32 };
                b2CreateCapsuleShape(id, &sd, &capsule);
            }
            Shape::Frame { hx, hy, wall } => {
                for wall in walls(hx, hy, wall) {
                    let ([x, y], [half_x, half_y]) = (wall.at, wall.half);
                    let p = b2MakeOffsetBox(half_x as f32, half_y as f32, v2(x, y), b2Rot { c: 1.0, s: 0.0 });
                    b2CreatePolygonShape(id, &sd, &p);
                }
            }
            Shape::Polygon(corners) => {
                let points: Vec<_> = corners.as_slice().iter().map(|c| v2(c[0], c[1])).collect();
                let hull = b2ComputeHull(points.as_ptr(), points.len() as i32);
                assert_eq!(hull.count as usize, points.len(), "the polygon is not convex, or too small for Box2D");
                let p = b2MakePolygon(&hull, 0.0);
                b2CreatePolygonShape(id, &sd, &p);
            }
        }
        id
    }
}

unsafe fn add_joint(world: b2WorldId, scene: &Scene, ids: &[b2BodyId], j: &Joint) {
    let set = |base: &mut b2JointDef| {
        let [a, b] = j.anchors(&scene.bodies);
        (base.bodyIdA, base.bodyIdB) = (ids[j.a], ids[j.b]);
        (base.localFrameA.p, base.localFrameB.p) = (v2(a[0], a[1]), v2(b[0], b[1]));
        // Both frames lie along the axes of the world.
        let turned_back = |body: usize| {
            let (s, c) = scene.bodies[body].angle.sin_cos();
            b2Rot { c: c as f32, s: -s as f32 }
        };
        (base.localFrameA.q, base.localFrameB.q) = (turned_back(j.a), turned_back(j.b));
        base.collideConnected = false;
    };
    unsafe {
        if j.rod_end.is_some() {
            let mut jd = b2DefaultDistanceJointDef();
            set(&mut jd.base);
            jd.length = j.length() as f32;
            b2CreateDistanceJoint(world, &jd);
        } else {
            let mut jd = b2DefaultRevoluteJointDef();
            set(&mut jd.base);
            if let Some([lower, upper]) = j.limits {
                (jd.enableLimit, jd.lowerAngle, jd.upperAngle) = (true, lower as f32, upper as f32);
            }
            if let Some(motor) = j.motor {
                (jd.enableMotor, jd.motorSpeed, jd.maxMotorTorque) =
                    (true, motor.speed as f32, motor.max_torque as f32);
            }
            b2CreateRevoluteJoint(world, &jd);
        }
    }
}

struct B2World {
    world: b2WorldId,
    ids: Vec<b2BodyId>,
    dt: f32,
    substeps: i32,
}

impl Drop for B2World {
    fn drop(&mut self) {
        unsafe { b2DestroyWorld(self.world) }
    }
}

impl World for B2World {
    fn step(&mut self) {
        unsafe { b2World_Step(self.world, self.dt, self.substeps) }
    }
    fn body_count(&self) -> usize {
        self.ids.len()
    }
    fn state(&self, i: usize) -> State {
        unsafe {
            let id = self.ids[i];
            let t = b2Body_GetTransform(id);
            let v = b2Body_GetLinearVelocity(id);
            State {
                x: t.p.x as f64,
                y: t.p.y as f64,
                angle: (t.q.s as f64).atan2(t.q.c as f64),
                vx: v.x as f64,
                vy: v.y as f64,
                w: b2Body_GetAngularVelocity(id) as f64,
            }
        }
    }
    fn hash(&self) -> u64 {
        let mut h = Hash::new();
        for &id in &self.ids {
            unsafe {
                let t = b2Body_GetTransform(id);
                let v = b2Body_GetLinearVelocity(id);
                for f in [t.p.x, t.p.y, t.q.c, t.q.s, v.x, v.y, b2Body_GetAngularVelocity(id)] {
                    h.word(f.to_bits() as u64);
                }
            }
        }
        h.finish()
    }
    fn push(&mut self, i: usize, fx: f64, fy: f64) {
        // Box2D clears forces after every step.
        unsafe { b2Body_ApplyForceToCenter(self.ids[i], v2(fx, fy), true) }
    }
    fn set_velocity(&mut self, i: usize, [x, y, angular]: [f64; 3]) {
        unsafe {
            b2Body_SetAwake(self.ids[i], true);
            b2Body_SetLinearVelocity(self.ids[i], v2(x, y));
            b2Body_SetAngularVelocity(self.ids[i], angular as f32);
        }
    }
    fn awake(&self) -> Option<usize> {
        Some(unsafe { b2World_GetAwakeBodyCount(self.world) } as usize)
    }
    fn contact_points(&self) -> Option<usize> {
        let mut touching = HashSet::new();
        let mut points = 0;
        let mut buf: Vec<b2ContactData> = Vec::new();
        unsafe {
            for &id in &self.ids {
                if b2Body_GetType(id) != b2BodyType_b2_dynamicBody {
                    continue;
                }
                let cap = b2Body_GetContactCapacity(id);
                buf.clear();
                buf.reserve(cap as usize);
                let n = b2Body_GetContactData(id, buf.as_mut_ptr(), cap);
                buf.set_len(n as usize);
                for c in &buf {
                    if touching.insert((c.shapeIdA.index1, c.shapeIdB.index1)) {
                        points += c.manifold.pointCount as usize;
                    }
                }
            }
        }
        Some(points)
    }
    fn pass_times(&self) -> Vec<(&'static str, f64)> {
        let p = unsafe { b2World_GetProfile(self.world) };
        let stages = [
            ("integrateVelocities", p.integrateVelocities),
            ("warmStart", p.warmStart),
            ("solveImpulses", p.solveImpulses),
            ("integratePositions", p.integratePositions),
            ("relaxImpulses", p.relaxImpulses),
        ];
        stages.map(|(name, ms)| (name, f64::from(ms) * 1e3)).into()
    }
    fn part_times(&self) -> Option<[f64; PARTS.len()]> {
        let p = unsafe { b2World_GetProfile(self.world) };
        let passes = p.integrateVelocities + p.warmStart + p.solveImpulses + p.integratePositions + p.relaxImpulses;
        let parts = [
            p.pairs + p.refit,
            p.collide,
            p.solverSetup + p.prepareConstraints,
            passes,
            p.applyRestitution,
            p.storeImpulses,
            p.bullets,
            p.transforms + p.splitIslands + p.sleepIslands,
            p.jointEvents + p.hitEvents + p.sensorHits + p.sensors,
        ];
        Some(parts.map(|ms| f64::from(ms) * 1e3))
    }
    fn cast_rays(&mut self, rays: &[Ray], fractions: &mut [f64]) -> bool {
        for (ray, fraction) in rays.iter().zip(fractions) {
            let (from, way) = (v2(ray.from[0], ray.from[1]), v2(ray.by[0], ray.by[1]));
            let hit = unsafe { b2World_CastRayClosest(self.world, from, way, b2DefaultQueryFilter()) };
            *fraction = if hit.hit { f64::from(hit.fraction) } else { 2.0 };
        }
        true
    }
    fn snapshot_kinds(&self) -> &'static [&'static str] {
        &["b2World_Snapshot"]
    }
    fn snapshot(&mut self, _kind: usize) -> Snapshot {
        unsafe {
            let n = b2World_Snapshot(self.world, std::ptr::null_mut(), 0);
            let mut v: Vec<u8> = Vec::with_capacity(n as usize);
            let m = b2World_Snapshot(self.world, v.as_mut_ptr(), n);
            assert!(m > 0 && m <= n, "snapshot failed");
            v.set_len(m as usize);
            Snapshot { bytes: Some(v.len()), data: Box::new(v) }
        }
    }
    fn restore(&mut self, _kind: usize, snap: &Snapshot) {
        let v = snap.data.downcast_ref::<Vec<u8>>().unwrap();
        let ok = unsafe { b2World_Restore(self.world, v.as_ptr(), v.len() as i32) };
        assert!(ok, "restore failed");
    }
}
