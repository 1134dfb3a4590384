//! This engine, in fixed point and in floats: the same code over three scalars.

use crate::engine::{Engine, Info, Snapshot, State, World, locked_version};
use crate::scene::{self, Field, Kind, Scene, Shape};
use std::cell::RefCell;
use std::marker::PhantomData;
use std::rc::Rc;
use umbra_physics::scalar::internals::VectorSet;
use umbra_physics::scalar::{Factor, ToF64};
use umbra_physics::{
    Activity, Attachment, BodyDef, BodyId, BodyKind, Damping, End, FieldKind, Fx, Geometry, Integrator, Mass, Scalar,
    Shape as Form, SpringConstants, TimeStep, Vec2, World as Umbra, WorldDef,
};

/// The scalars, and how the scenes' doubles become them.
pub trait Number: Scalar<Angle: ToF64> + ToF64 {
    const ID: &'static str;
    const FORMAT: &'static str;
    fn number(value: f64) -> Self;
}

impl Number for Fx {
    const ID: &'static str = "umbra-fx";
    const FORMAT: &'static str = "I32F32 fixed point";
    fn number(value: f64) -> Self {
        Fx::from_f64_for_tools(value).expect("scenes stay within the range of Fx")
    }
}

impl Number for f64 {
    const ID: &'static str = "umbra-f64";
    const FORMAT: &'static str = "f64";
    fn number(value: f64) -> Self {
        value
    }
}

impl Number for f32 {
    const ID: &'static str = "umbra-f32";
    const FORMAT: &'static str = "f32";
    fn number(value: f64) -> Self {
        value as f32
    }
}

pub fn vector<S: Number>(x: f64, y: f64) -> Vec2<S> {
    Vec2::new(S::number(x), S::number(y))
}

/// The damping of dv/dt = -c v, by the share of a velocity that is left after a second.
fn damping<S: Number>(c: f64) -> Damping<S> {
    Damping::kept_per_second(S::number((-c).exp()))
}

pub fn time_step(dt: f64) -> TimeStep {
    let rate = (1.0 / dt).round();
    assert!((rate * dt - 1.0).abs() < 1e-12, "{dt} s is no whole number of steps a second");
    TimeStep::hz(rate as u32)
}

/// The shape of a body; `None` if it has none.
pub fn shape<S: Number>(b: &scene::Body) -> Option<Form<S>> {
    let geometry = match b.shape {
        Shape::None { .. } => return None,
        Shape::Circle { r } => Geometry::Circle { radius: S::number(r) },
        Shape::Box { hx, hy } => Geometry::Rectangle { width: S::number(2.0 * hx), height: S::number(2.0 * hy) },
        Shape::Polygon(corners) => {
            Geometry::Polygon { corners: corners.as_slice().iter().map(|c| vector(c[0], c[1])).collect() }
        }
    };
    Some(Form::new(geometry).expect("a shape within the limits"))
}

fn body<S: Number>(b: &scene::Body) -> BodyDef<S> {
    let mass = match b.shape {
        Shape::None { mass, inertia } => Mass::Explicit { mass: S::number(mass), inertia: S::number(inertia) },
        _ => Mass::Density(S::number(b.density)),
    };
    let def = match b.kind {
        Kind::Fixed => BodyDef::fixed(),
        Kind::Dynamic => BodyDef::dynamic(),
    };
    BodyDef {
        position: vector(b.x, b.y),
        angle: S::number(b.angle),
        velocity: vector(b.vx, b.vy),
        angular_velocity: S::number(b.w),
        shape: shape(b),
        mass,
        linear_damping: Some(damping(b.lin_damp)),
        angular_damping: Some(damping(b.ang_damp)),
        ..def
    }
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

pub struct Build<S> {
    id: &'static str,
    widest: VectorSet,
    scalar: PhantomData<S>,
}

impl<S: Number> Build<S> {
    /// With the wide vectors of the CPU, where it has them.
    pub fn new() -> Self {
        Self { id: S::ID, widest: VectorSet::Avx512, scalar: PhantomData }
    }
}

impl Build<Fx> {
    /// The code for every CPU, everywhere.
    pub fn portable() -> Self {
        Self { id: "umbra-fx-portable", widest: VectorSet::Portable, scalar: PhantomData }
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
            solver: "defaults: velocity Verlet, no substeps, no collision yet; symplectic Euler where the harness \
                     pushes what depends on the position: a push is constant over its step",
            damping_law: "v *= d^dt with d = exp(-c) as the scalar holds it",
            damped: |v0, c, dt, steps, _| v0 * damping::<S>(c).kept().to_f64().powf(dt * f64::from(steps)),
            default_substeps: 1,
            body_struct_bytes: None,
        }
    }
    fn refuse(&self, scene: &Scene) -> Option<String> {
        let lacks = if scene.contacts {
            "collision"
        } else if !scene.joints.is_empty() {
            "joints"
        } else {
            return None;
        };
        Some(format!("has no {lacks} yet"))
    }
    fn has_fields(&self) -> bool {
        true
    }
    fn build(&self, scene: &Scene) -> Box<dyn World> {
        let integrator = if scene.pushed { Integrator::SymplecticEuler } else { Integrator::default() };
        let def = WorldDef {
            time_step: time_step(scene.dt),
            gravity: vector(scene.gravity[0], scene.gravity[1]),
            integrator,
            sleep_after: if scene.sleep { WorldDef::<S>::default().sleep_after } else { None },
            ..WorldDef::default()
        };
        let mut world = Umbra::<S>::with_scalar(def).expect("a definition within the limits");
        let add = |b| world.add_body(body(b)).expect("a body within the limits");
        let ids: Vec<_> = scene.bodies.iter().map(add).collect();
        if let (Some(field), false) = (scene.field, scene.pushed) {
            for &id in &ids {
                world.add_field(law(field, id)).expect("a field within the limits");
            }
        }
        Box::new(Built { world, ids, spare: Rc::default(), widest: self.widest })
    }
}

/// Worlds whose memory a snapshot may use again.
type Spare<S> = Rc<RefCell<Vec<Umbra<S>>>>;

struct Built<S: Number> {
    world: Umbra<S>,
    ids: Vec<BodyId>,
    spare: Spare<S>,
    widest: VectorSet,
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
        self.world.step();
        VectorSet::allow(VectorSet::Avx512);
    }
    fn body_count(&self) -> usize {
        self.world.body_count()
    }
    fn state(&self, i: usize) -> State {
        let body = self.world.body(self.ids[i]).expect("no body is removed");
        let (position, velocity) = (body.position(), body.velocity());
        State {
            x: position.x.to_f64(),
            y: position.y.to_f64(),
            angle: body.angle_exact().to_f64(),
            vx: velocity.x.to_f64(),
            vy: velocity.y.to_f64(),
            w: body.angular_velocity().to_f64(),
        }
    }
    fn hash(&self) -> u64 {
        self.world.state_hash()
    }
    fn push(&mut self, i: usize, fx: f64, fy: f64) {
        self.world.apply_force(self.ids[i], vector(fx, fy)).expect("a force within the limits");
    }
    fn awake(&self) -> Option<usize> {
        let awake = self.world.bodies().filter(|b| b.kind() == BodyKind::Dynamic && b.activity() == Activity::Awake);
        Some(awake.count())
    }
    fn contact_points(&self) -> Option<usize> {
        None
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
