//! This engine, in fixed point and in floats: the same code over three scalars.

#[cfg(feature = "timers")]
use crate::engine::PARTS;
use crate::engine::{Engine, Info, Snapshot, State, World, locked_version};
use crate::scene::{self, Field, Kind, Scene, Shape};
use std::cell::RefCell;
use std::rc::Rc;
#[cfg(feature = "threads")]
use std::sync::Arc;
use umbra_physics::scalar::internals::VectorSet;
use umbra_physics::scalar::{Factor, ToF64};
use umbra_physics::{
    Activity, Attachment, BodyDef, BodyId, BodyKind, ColliderDef, ContactSettings, Damping, Distance, End, FieldKind,
    Fx, Geometry, Integrator, JointDef, JointKind, JointLimits, JointMotor, Mass, Material, QueryFilter, Revolute,
    Scalar, Shape as Form, SpringConstants, TimeStep, Turn, Vec2, World as Umbra, WorldDef,
};

/// The scalars, and how the scenes' doubles become them.
pub trait Number: Scalar<Accumulator: ToF64> + ToF64 {
    const ID: &'static str;
    const FORMAT: &'static str;
    fn number(value: f64) -> Self;
    fn radians(angle: Self::Angle) -> f64;
}

impl Number for Fx {
    const ID: &'static str = "umbra-fx";
    const FORMAT: &'static str = "I32F32 fixed point";
    fn number(value: f64) -> Self {
        Fx::from_f64_for_tools(value).expect("scenes stay within the range of Fx")
    }
    /// Between −π and π, so that small angles of both signs are small.
    fn radians(angle: Turn) -> f64 {
        angle.to_bits() as i64 as f64 * (std::f64::consts::PI / (1u64 << 63) as f64)
    }
}

impl Number for f64 {
    const ID: &'static str = "umbra-f64";
    const FORMAT: &'static str = "f64";
    fn number(value: f64) -> Self {
        value
    }
    fn radians(angle: Self::Angle) -> f64 {
        angle.to_f64()
    }
}

impl Number for f32 {
    const ID: &'static str = "umbra-f32";
    const FORMAT: &'static str = "f32";
    fn number(value: f64) -> Self {
        value as f32
    }
    fn radians(angle: Self::Angle) -> f64 {
        angle.to_f64()
    }
}

fn vector<S: Number>(x: f64, y: f64) -> Vec2<S> {
    Vec2::new(S::number(x), S::number(y))
}

/// The damping of dv/dt = -c v, by the share of a velocity that is left after a second.
fn damping<S: Number>(c: f64) -> Damping<S> {
    Damping::kept_per_second(S::number((-c).exp()))
}

fn time_step(dt: f64) -> TimeStep {
    let rate = (1.0 / dt).round();
    assert!((rate * dt - 1.0).abs() < 1e-12, "{dt} s is no whole number of steps a second");
    TimeStep::hz(rate as u32)
}

fn form<S: Number>(geometry: Geometry<S>) -> ColliderDef<S> {
    ColliderDef::new(Form::new(geometry).expect("a shape within the limits"))
}

fn rectangle<S: Number>(hx: f64, hy: f64) -> ColliderDef<S> {
    form(Geometry::Rectangle { width: S::number(2.0 * hx), height: S::number(2.0 * hy) })
}

/// The colliders of a body, without density and material.
fn colliders<S: Number>(shape: Shape) -> Vec<ColliderDef<S>> {
    match shape {
        Shape::None { .. } => vec![],
        Shape::Circle { r } => vec![form(Geometry::Circle { radius: S::number(r) })],
        Shape::Box { hx, hy } => vec![rectangle(hx, hy)],
        Shape::Capsule { half: [x, y], r } => {
            let capsule = form(Geometry::Capsule { length: S::number(2.0 * x.hypot(y)), radius: S::number(r) });
            vec![ColliderDef { angle: S::number(y.atan2(x)), ..capsule }]
        }
        Shape::Polygon(corners) => {
            let corners = corners.as_slice().iter().map(|c| vector(c[0], c[1])).collect();
            vec![form(Geometry::Polygon { corners })]
        }
        Shape::Frame { hx, hy, wall } => {
            let collider = |wall: &scene::Wall| ColliderDef {
                position: vector(wall.at[0], wall.at[1]),
                ..rectangle(wall.half[0], wall.half[1])
            };
            scene::walls(hx, hy, wall).iter().map(collider).collect()
        }
    }
}

/// A body of the scene, and where its position in the scene lies in its axes, from the centre of mass, m.
fn body<S: Number>(b: &scene::Body) -> (BodyDef<S>, [f64; 2]) {
    let def = match b.kind {
        Kind::Fixed => BodyDef::fixed(),
        Kind::Kinematic => BodyDef::kinematic(),
        Kind::Dynamic => BodyDef::dynamic(),
    };
    let (mut mass, mut origin) = (def.mass, [0.0; 2]);
    let mut colliders = colliders::<S>(b.shape);
    if let Shape::None { mass: kilograms, inertia } = b.shape {
        mass = Mass::Explicit { mass: S::number(kilograms), inertia: S::number(inertia) };
    } else {
        if let Shape::Polygon(_) = b.shape {
            let shift = colliders[0].shape.shift();
            origin = [shift.x, shift.y].map(|c| -c.to_f64());
        }
        let material = Material {
            friction: S::number(b.friction),
            restitution: S::number(b.restitution),
            // Counter-clockwise here.
            surface_speed: S::number(-b.surface_speed),
            ..Material::default()
        };
        for collider in &mut colliders {
            (collider.density, collider.material) = (S::number(b.density), material);
        }
    }
    let (dx, dy) = turned(origin, b.angle);
    let def = BodyDef {
        position: vector(b.x - dx, b.y - dy),
        angle: S::number(b.angle),
        velocity: vector(b.vx, b.vy),
        angular_velocity: S::number(b.w),
        colliders,
        mass,
        linear_damping: Some(damping(b.lin_damp)),
        angular_damping: Some(damping(b.ang_damp)),
        ..def
    };
    (def, origin)
}

/// A joint of bodies with these handles and origins.
fn joint<S: Number>(joint: &scene::Joint, scene: &Scene, ids: &[BodyId], origins: &[[f64; 2]]) -> JointDef<S> {
    let anchors = joint.anchors(&scene.bodies);
    let ends = [(joint.a, anchors[0]), (joint.b, anchors[1])].map(|(index, [x, y])| {
        let [origin_x, origin_y] = origins[index];
        End::Body(Attachment { body: ids[index], point: vector(x + origin_x, y + origin_y) })
    });
    let kind = match joint.rod_end {
        None => JointKind::Revolute(Revolute {
            limits: joint.limits.map(|[lower, upper]| JointLimits { lower: S::number(lower), upper: S::number(upper) }),
            motor: joint
                .motor
                .map(|motor| JointMotor { speed: S::number(motor.speed), max_force: S::number(motor.max_torque) }),
            ..Revolute::default()
        }),
        Some(_) => JointKind::Distance(Distance::rod(S::number(joint.length()))),
    };
    // The angle of the joint is 0 as the bodies stand.
    let angles = [joint.a, joint.b].map(|index| S::number(-scene.bodies[index].angle));
    JointDef { angles, ..JointDef::new(ends, kind) }
}

fn turned([x, y]: [f64; 2], angle: f64) -> (f64, f64) {
    let (sin, cos) = angle.sin_cos();
    (cos * x - sin * y, sin * x + cos * y)
}

fn law<S: Number>(field: Field, body: BodyId) -> FieldKind<S> {
    let origin = End::World(Vec2::ZERO);
    match field {
        Field::Attractor(gm) => {
            FieldKind::Attractor { centre: origin, mu: S::Factor::from_scalar(S::number(gm)), softening: S::ZERO }
        }
        Field::Spring(k) => FieldKind::Spring {
            near: Attachment { body, point: Vec2::ZERO },
            far: origin,
            spring: SpringConstants { rest: S::ZERO, stiffness: S::number(k), damping: S::ZERO },
        },
    }
}

/// The widest vector instructions of a name like `avx2`, if this CPU has them.
fn vectors(name: &str) -> Option<VectorSet> {
    VectorSet::available().find(|set| format!("{set:?}").eq_ignore_ascii_case(name))
}

/// A pool of so many threads.
#[cfg(feature = "threads")]
pub fn pool(threads: usize) -> Option<Arc<rayon::ThreadPool>> {
    Some(Arc::new(rayon::ThreadPoolBuilder::new().num_threads(threads).build().ok()?))
}

pub struct Build<S: Scalar> {
    id: &'static str,
    /// The widest vector instructions that it may use.
    widest: VectorSet,
    contacts: ContactSettings<S>,
    #[cfg(feature = "threads")]
    pool: Option<Arc<rayon::ThreadPool>>,
}

impl<S: Number> Build<S> {
    /// With the wide vectors of the CPU, where it has them, and the default settings.
    pub fn new() -> Self {
        Self {
            id: S::ID,
            widest: VectorSet::Avx512,
            contacts: ContactSettings::default(),
            #[cfg(feature = "threads")]
            pool: None,
        }
    }
}

impl Build<Fx> {
    /// The engine of an id like `umbra-fx@substeps=6:vectors=avx2`; `None` for another engine or an unknown option.
    pub fn with_options(id: &str) -> Option<Self> {
        let list = id.strip_prefix(Fx::ID)?.strip_prefix('@')?;
        let mut build = Self::new();
        for option in list.split(':') {
            match option.split_once('=')? {
                ("substeps", value) => build.contacts.substeps = value.parse().ok()?,
                ("vectors", value) => build.widest = vectors(value)?,
                #[cfg(feature = "threads")]
                ("threads", value) => build.pool = Some(pool(value.parse().ok()?)?),
                _ => return None,
            }
        }
        build.contacts.check().ok()?;
        // Ids live as long as the program, and there are few.
        Some(Self { id: String::from(id).leak(), ..build })
    }
}

impl<S: Number> Engine for Build<S> {
    fn id(&self) -> &'static str {
        self.id
    }
    fn info(&self) -> Info {
        Info {
            version: format!("umbra-physics {}", locked_version("umbra-physics")),
            number: S::FORMAT,
            build: format!("feature float; vector instructions: {:?}", self.widest.min(VectorSet::used())),
            solver: format!(
                "velocity Verlet; where bodies touch {} substeps of soft contacts; symplectic Euler where the harness \
                 pushes what depends on the position: a push is constant over its step; options of the fixed-point \
                 build: umbra-fx@substeps=N:vectors=SET, with the feature threads also threads=N",
                self.contacts.substeps
            ),
            damping_law: "v *= d^dt with d = exp(-c) as the scalar holds it",
            damped: |v0, c, dt, steps, _| v0 * damping::<S>(c).kept().to_f64().powf(dt * f64::from(steps)),
            default_substeps: 1,
            body_struct_bytes: None,
        }
    }
    fn has_fields(&self) -> bool {
        true
    }
    fn build(&self, scene: &Scene) -> Box<dyn World> {
        let Placed { world, ids, origins } = self.place(scene);
        Box::new(Built {
            #[cfg(feature = "timers")]
            before: world.timers(),
            world,
            ids,
            origins,
            spare: Rc::default(),
            widest: self.widest,
            #[cfg(feature = "threads")]
            pool: self.pool.clone(),
        })
    }
}

/// The world of a scene.
pub struct Placed<S: Number> {
    pub world: Umbra<S>,
    ids: Vec<BodyId>,
    /// The position of each body in the scene, in the body's axes, from the centre of mass.
    origins: Vec<[f64; 2]>,
}

impl<S: Number> Build<S> {
    pub fn place(&self, scene: &Scene) -> Placed<S> {
        let integrator = if scene.pushed { Integrator::SymplecticEuler } else { Integrator::default() };
        let def = WorldDef {
            time_step: time_step(scene.dt),
            gravity: vector(scene.gravity[0], scene.gravity[1]),
            integrator,
            sleep_after: if scene.sleep { WorldDef::<S>::default().sleep_after } else { None },
            contacts: ContactSettings { substeps: scene.substeps.unwrap_or(self.contacts.substeps), ..self.contacts },
            ..WorldDef::default()
        };
        let mut world = Umbra::<S>::with_scalar(def).expect("a definition within the limits");
        let mut ids = Vec::with_capacity(scene.bodies.len());
        let mut origins = Vec::with_capacity(scene.bodies.len());
        for b in &scene.bodies {
            let (def, origin) = body(b);
            ids.push(world.add_body(def).expect("a body within the limits"));
            origins.push(origin);
        }
        for joint in &scene.joints {
            world.add_joint(self::joint(joint, scene, &ids, &origins)).expect("a joint within the limits");
        }
        if let (Some(field), false) = (scene.field, scene.pushed) {
            for &id in &ids {
                world.add_field(law(field, id)).expect("a field within the limits");
            }
        }
        Placed { world, ids, origins }
    }
}

/// Worlds whose memory a snapshot may use again.
type Spare<S> = Rc<RefCell<Vec<Umbra<S>>>>;

struct Built<S: Number> {
    world: Umbra<S>,
    ids: Vec<BodyId>,
    /// The position of each body in the scene, in the body's axes, from the centre of mass.
    origins: Vec<[f64; 2]>,
    spare: Spare<S>,
    widest: VectorSet,
    #[cfg(feature = "threads")]
    pool: Option<Arc<rayon::ThreadPool>>,
    /// The timers before the last step.
    #[cfg(feature = "timers")]
    before: umbra_physics::Timers,
}

/// A saved world, which gives its memory back.
struct Saved<S: Number> {
    world: Option<Umbra<S>>,
    spare: Spare<S>,
}

impl<S: Number> Drop for Saved<S> {
    fn drop(&mut self) {
        self.spare.borrow_mut().extend(self.world.take());
    }
}

const REUSED: usize = 0;

impl<S: Number> World for Built<S> {
    fn step(&mut self) {
        VectorSet::allow(self.widest);
        #[cfg(feature = "timers")]
        {
            self.before = self.world.timers();
        }
        #[cfg(feature = "threads")]
        match &self.pool {
            Some(pool) => _ = pool.install(|| self.world.step()),
            None => _ = self.world.step(),
        }
        #[cfg(not(feature = "threads"))]
        self.world.step();
        VectorSet::allow(VectorSet::Avx512);
    }
    fn body_count(&self) -> usize {
        self.world.body_count()
    }
    fn state(&self, i: usize) -> State {
        let body = self.world.body(self.ids[i]).expect("no body is removed");
        let (position, velocity) = (body.position_exact(), body.velocity_exact());
        let angle = S::radians(body.angle_exact());
        let (dx, dy) = turned(self.origins[i], angle);
        State {
            x: position.x.to_f64() + dx,
            y: position.y.to_f64() + dy,
            angle,
            vx: velocity.x.to_f64(),
            vy: velocity.y.to_f64(),
            w: body.angular_velocity_exact().to_f64(),
        }
    }
    fn hash(&self) -> u64 {
        self.world.state_hash()
    }
    fn push(&mut self, i: usize, fx: f64, fy: f64) {
        self.world.apply_force(self.ids[i], vector(fx, fy)).expect("a force within the limits");
    }
    fn set_velocity(&mut self, i: usize, [x, y, angular]: [f64; 3]) {
        self.world.set_velocity(self.ids[i], vector(x, y)).expect("a velocity within the limits");
        self.world.set_angular_velocity(self.ids[i], S::number(angular)).expect("a velocity within the limits");
    }
    fn awake(&self) -> Option<usize> {
        let awake = self.world.bodies().filter(|b| b.kind() == BodyKind::Dynamic && b.activity() == Activity::Awake);
        Some(awake.count())
    }
    fn contact_points(&self) -> Option<usize> {
        Some(self.world.contacts().map(|contact| contact.points().len()).sum())
    }
    #[cfg(feature = "timers")]
    fn pass_times(&self) -> Vec<(&'static str, f64)> {
        let time = self.world.timers().times.passes - self.before.times.passes;
        vec![("passes", time.as_secs_f64() * 1e6)]
    }
    #[cfg(feature = "timers")]
    fn part_times(&self) -> Option<[f64; PARTS.len()]> {
        let (times, before) = (self.world.timers().times, self.before.times);
        let sum = |names: &[&str]| {
            let named = times.each().zip(before.each()).filter(|((name, _), _)| names.contains(name));
            named.map(|((_, time), (_, past))| (time - past).as_secs_f64() * 1e6).sum()
        };
        Some([
            sum(&["pairs"]),
            sum(&["manifolds"]),
            sum(&["setup"]),
            sum(&["passes"]),
            sum(&["impacts"]),
            sum(&["apply"]),
            sum(&["deflected", "again", "sweeps"]),
            sum(&["survey", "targets", "free", "fields", "damp", "kick", "drift", "finish"]),
            sum(&["waking", "events"]),
        ])
    }
    fn cast_rays(&mut self, rays: &[scene::Ray], fractions: &mut [f64]) -> bool {
        let (queries, all) = (self.world.queries(), QueryFilter::default());
        for (ray, fraction) in rays.iter().zip(fractions) {
            let (from, way) = (vector(ray.from[0], ray.from[1]), vector(ray.by[0], ray.by[1]));
            let hit = queries.cast_ray(from, way, &all).expect("rays within the limits");
            *fraction = hit.map_or(2.0, |hit| hit.fraction.to_f64());
        }
        true
    }
    fn snapshot_kinds(&self) -> &'static [&'static str] {
        &["clone_from into a world there is", "clone"]
    }
    fn snapshot(&mut self, kind: usize) -> Snapshot {
        let reused = if kind == REUSED { self.spare.borrow_mut().pop() } else { None };
        let world = match reused {
            Some(mut world) => {
                world.clone_from(&self.world);
                world
            }
            None => self.world.clone(),
        };
        let spare = if kind == REUSED { Rc::clone(&self.spare) } else { Rc::default() };
        Snapshot { bytes: None, data: Box::new(Saved { world: Some(world), spare }) }
    }
    fn restore(&mut self, _kind: usize, snap: &Snapshot) {
        let saved = snap.data.downcast_ref::<Saved<S>>().and_then(|saved| saved.world.as_ref());
        self.world.clone_from(saved.expect("a snapshot of this engine"));
    }
}
