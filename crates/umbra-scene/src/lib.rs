//! Scene files for `umbra-physics`: a world, and what is done to it at which tick, as JSON text.
//!
//! Numbers are read from the text itself and rounded once, never through a float. All errors of a text are reported at once, each with
//! its line and field. The format is described in `docs/scene.md`.
//!
//! ```
//! use umbra_physics::{Fx, fx};
//! use umbra_scene::Scene;
//!
//! let scene = Scene::parse(r#"{
//!     "gravity": [0, -10],
//!     "bodies": [{"name": "ball", "position": [0, 10], "mass": 1, "colliders": [{"shape": {"circle": {"radius": 0.5}}}]}],
//!     "inputs": [{"at": 30, "body": "ball", "impulse": [0, 5]}]
//! }"#)?;
//! let mut run = scene.start::<Fx>()?;
//! for _ in 0..60 {
//!     run.advance()?;
//! }
//! let [ball] = run.world().bodies().collect::<Vec<_>>()[..] else { unreachable!() };
//! // 10 − ½·10·1² + 5·½, exactly.
//! assert_eq!(ball.position().y, fx!(7.5));
//! # Ok::<(), umbra_scene::SceneErrors>(())
//! ```
#![no_std]
#![forbid(unsafe_code)]
#![warn(missing_docs)]

extern crate alloc;

/// The README's example, compiled and run as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

mod body;
mod collider;
mod commands;
mod convert;
mod error;
mod field;
mod hint;
mod input;
mod joint;
mod node;
mod object;
mod repeat;
mod run;
mod settings;
mod shape;
mod text;

use alloc::collections::BTreeSet;
use alloc::string::String;
use alloc::vec::Vec;

use umbra_physics::{BodyId, ColliderId, Error, Fx, Scalar, World, WorldDef, limits};

use error::Flaw;
use field::{Names, named};
use node::{Node, Source};
use object::Object;

pub use body::SceneBody;
pub use collider::{SceneCollider, SceneMaterialPair};
pub use error::{ExportError, Place, SceneError, SceneErrors};
pub use field::SceneField;
pub use input::{Input, SceneAction};
pub use joint::SceneJoint;
pub use run::SceneRun;
pub use settings::{Plot, Trails};
pub use shape::{PartDef, ShapeDef};

/// A scene: the definition of a world, and what is done to it at which tick. It is plain data, which you may change; the changes are
/// checked when it starts.
///
/// ```
/// use umbra_scene::{Plot, Scene, SceneBody, SceneField, SceneRun, Trails};
/// use umbra_physics::{BodyDef, Fx, Geometry, TimeStep};
///
/// let mut scene = Scene::parse(
///     r#"{
/// "bodies": [{"name": "ball", "colliders": [{"shape": {"circle": {"radius": 0.5}}}], "velocity": [1, 0]}],
/// "fields": [{"drag": {"linear": 0.1}}]
/// }"#,
/// )?;
/// let ball: &SceneBody = &scene.bodies[0];
/// let Geometry::Circle { radius } = *ball.colliders[0].def.shape.geometry() else { unreachable!() };
/// let SceneField { name, .. } = &scene.fields[0];
/// assert_eq!((radius, name), (Fx::HALF, &None));
/// assert!(ball.def::<Fx>().is_ok_and(|def: BodyDef| def.colliders.len() == 1));
/// assert_eq!(scene.plot, Plot { trails: Trails::All, ..Plot::default() });
///
/// // Plain data: it can be changed before it is built.
/// scene.world.time_step = TimeStep::hz(120);
/// assert_eq!(scene.build::<Fx>()?.body_count(), 1);
/// let mut run: SceneRun<'_, Fx> = scene.start_finer(4)?; // four steps to a tick
/// run.advance()?;
/// assert_eq!((run.tick(), run.world().tick()), (1, 4));
/// let body = run.world().bodies().next().unwrap().id();
/// assert_eq!((run.index(body), run.name(body)), (Some(0), "ball"));
/// let world = run.into_world();
/// assert!(world.tick() == 4 && Scene::MOST == 131_072);
/// # Ok::<(), umbra_scene::SceneErrors>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// The title.
    pub title: String,
    /// A description: what the scene is about, and what to look at.
    pub about: String,
    /// The number of ticks that the scene is meant to run for.
    pub ticks: u64,
    /// The definition of the world.
    pub world: WorldDef,
    /// All bodies. Those that inputs add come last.
    pub bodies: Vec<SceneBody>,
    /// The number of bodies that are there from the start.
    pub starting_bodies: usize,
    /// All force fields. Those that inputs add come last.
    pub fields: Vec<SceneField>,
    /// The number of force fields that are there from the start.
    pub starting_fields: usize,
    /// All joints. Those that inputs add come last.
    pub joints: Vec<SceneJoint>,
    /// The number of joints that are there from the start.
    pub starting_joints: usize,
    /// The coefficients of pairs of materials at the start.
    pub material_pairs: Vec<SceneMaterialPair>,
    /// The inputs, in the order of the file. Inputs of the same tick are carried out in this order.
    pub inputs: Vec<Input>,
    /// Settings for drawing it.
    pub plot: Plot,
    /// The place where the text of the scene begins.
    pub place: Place,
}

/// The names that are in use, with their indices, and the number of things of a kind that are allowed.
struct Tables {
    bodies: Names,
    fields: Names,
    colliders: Names,
    joints: Names,
    /// All colliders, those without names too: their handles in the scene.
    collider_symbols: Vec<ColliderId>,
    most: u64,
}

/// The number of ticks of a scene that gives none.
const TICKS: u64 = 600;

impl Scene {
    /// The most bodies of a scene, the most force fields, joints and colliders, and the most things that its inputs do: 131,072.
    pub const MOST: u32 = 1 << 17;

    /// Reads a scene from JSON text.
    ///
    /// # Errors
    /// [`SceneErrors`], each with the line and the field: text that is not JSON, unknown or doubled fields, names that are
    /// taken or that nothing has, more than [`MOST`](Self::MOST) of a kind, and what the engine would refuse.
    pub fn parse(text: &str) -> Result<Self, SceneErrors> {
        Self::parse_within(text, Self::MOST)
    }

    /// Reads a scene as [`parse`](Self::parse) does, with your own limit on the number of bodies, of force fields, of joints, of colliders and
    /// of things that inputs do: a short text can ask for many. The text that repetitions would have if they were written out is limited as
    /// well, to 512 bytes for each of the things allowed.
    ///
    /// Memory: at most 64 KiB, 8 bytes for a byte of the text and of what repetitions would be, and 4 KiB for each thing.
    ///
    /// # Errors
    /// As [`parse`](Self::parse).
    ///
    /// ```
    /// use umbra_scene::Scene;
    ///
    /// let text = r#"{"bodies": [
    ///     {"name": "{i}", "repeat": {"i": 100000}}]}"#;
    /// assert_eq!(Scene::parse(text)?.bodies.len(), 100_000);
    /// let error = Scene::parse_within(text, 1_000).unwrap_err();
    /// assert_eq!(error.to_string(), "2: bodies[0].repeat: out of range: at most 1000 can be made");
    /// # Ok::<(), umbra_scene::SceneErrors>(())
    /// ```
    pub fn parse_within(text: &str, limit: u32) -> Result<Self, SceneErrors> {
        let source = Source::new(text);
        let scene = Self::read(&source, limit);
        source.found.finish()?;
        // A mark of a value that was refused has its error beside it.
        let scene = scene.map_err(|_| Place::default().fault(Flaw::NotJson.of("not a scene")))?;
        if !scene.inputs.is_empty() {
            scene.start::<Fx>()?.rehearse()?;
        }
        Ok(scene)
    }

    /// Reads as much as there is. What is refused is among the errors of the source, and the scene is then good for nothing but to
    /// find more of them.
    fn read(source: &Source<'_>, limit: u32) -> node::Result<Self> {
        let root = Node::document(source)?;
        let object = root.object()?;
        let mut scene = Self {
            title: settings::words(&object, "title"),
            about: settings::words(&object, "about"),
            ticks: object.or("ticks", TICKS, Node::whole),
            world: settings::world(&object),
            bodies: Vec::new(),
            starting_bodies: 0,
            fields: Vec::new(),
            starting_fields: 0,
            joints: Vec::new(),
            starting_joints: 0,
            material_pairs: Vec::new(),
            inputs: Vec::new(),
            plot: Plot::default(),
            place: root.place(),
        };
        let mut tables = Tables::new(limit.into());
        scene.read_start(&object, &mut tables)?;
        object.or("inputs", (), |list| {
            repeat::each(list, limit.into(), |object| input::input(object, &mut scene, &mut tables))
        });
        object.or("material_pairs", (), |list| scene.read_material_pairs(list, tables.most));
        scene.plot = object.or("plot", Plot::default(), |node| settings::plot(node, &tables.bodies));
        object.finish()?;
        Ok(scene)
    }

    /// The bodies, the force fields and the joints of the start. All are added to a world as they are read, which refuses what is
    /// wrong with them while the place is known.
    fn read_start(&mut self, object: &Object<'_>, tables: &mut Tables) -> node::Result<()> {
        let mut world = World::new(self.world).map_err(|error| object.node.fault(error))?;
        let mut handles = Vec::new();
        object.or("bodies", (), |list| {
            repeat::each(list, tables.most, |object| {
                let read = body::body(object, self.bodies.len(), tables).and_then(|read| {
                    let def = read.def().map_err(|error| body::blame(object, error))?;
                    let handle = world.add_body(def).map_err(|error| body::blame(object, error))?;
                    self.add_body(read, object.at(&["name"]), tables)?;
                    handles.push(handle);
                    Ok(())
                });
                read.inspect_err(|_| tables.bodies.note_refused(object, true))
            })
        });
        self.starting_bodies = self.bodies.len();
        object.or("fields", (), |list| {
            repeat::each(list, tables.most, |object| {
                let read = field::field(object, &tables.bodies).and_then(|read| {
                    let handle = |body: BodyId| handles.get(body.parts().0 as usize).copied();
                    let field =
                        convert::convert_field(&read.field, &|body| handle(body).ok_or(Error::NoSuchBody { body }));
                    match field.and_then(|field| world.add_field(field)) {
                        // All names are those of bodies above; one that was refused has its error there.
                        Ok(_) | Err(Error::NoSuchBody { .. }) => {}
                        Err(error) => return Err(field::blame(object, error)),
                    }
                    self.add_field(read, object.at(&["name"]), tables).map(drop)
                });
                read.inspect_err(|_| tables.fields.note_refused(object, false))
            })
        });
        self.starting_fields = self.fields.len();
        self.read_joints(object, tables, &mut world, &handles);
        Ok(())
    }

    /// The joints of the start. The handles are those of the scene's bodies in the world.
    fn read_joints(&mut self, object: &Object<'_>, tables: &mut Tables, world: &mut World, handles: &[BodyId]) {
        object.or("joints", (), |list| {
            repeat::each(list, tables.most, |object| {
                let start = joint::Start { world, handles };
                let read = joint::joint(object, &tables.bodies, Some(&start)).and_then(|read| {
                    let handle = |body: BodyId| handles.get(body.parts().0 as usize).copied();
                    let def = convert::convert_joint(&read.def, &|body| handle(body).ok_or(Error::NoSuchBody { body }));
                    match def.and_then(|def| world.add_joint(def)) {
                        // All names are those of bodies above; one that was refused has its error there.
                        Ok(_) | Err(Error::NoSuchBody { .. }) => {}
                        Err(error) => return Err(joint::blame(object, error)),
                    }
                    self.add_joint(read, object.at(&["name"]), tables).map(drop)
                });
                read.inspect_err(|_| tables.joints.note_refused(object, false))
            })
        });
        self.starting_joints = self.joints.len();
    }

    /// The coefficients of pairs of materials, which colliders of the scene have.
    fn read_material_pairs(&mut self, list: &Node<'_>, limit: u64) -> node::Result<()> {
        let colliders = self.bodies.iter().flat_map(|body| &body.colliders);
        let known: BTreeSet<u32> = colliders.map(|collider| collider.def.material.id).collect();
        repeat::each(list, limit, |object| {
            let place = object.node.place();
            let (materials, pair) = collider::material_pair(object, false)?;
            let unknown = |id: &u32| !known.contains(id);
            if let Some(id) = materials.into_iter().find(unknown) {
                return Err(object.at(&["materials"]).fault(
                    Flaw::NoSuchName
                        .of(format_args!("no collider has the material {id}: expected a `material_id` of one")),
                ));
            }
            let is_twin = |pair: &SceneMaterialPair| {
                pair.materials == materials || pair.materials == [materials[1], materials[0]]
            };
            if self.material_pairs.iter().any(is_twin) {
                let message = "there is an entry for these two materials already";
                return Err(object.at(&["materials"]).fault(Flaw::Taken.of(message)));
            }
            if self.material_pairs.len() >= limits::MATERIAL_PAIRS {
                return Err(object.node.fault(Error::Full));
            }
            self.material_pairs.extend(pair.map(|pair| SceneMaterialPair { materials, pair, place }));
            Ok(())
        })
    }

    fn add_body(&mut self, body: SceneBody, node: &Node<'_>, tables: &mut Tables) -> node::Result<usize> {
        let index = self.bodies.len();
        repeat::check_count(node, index as u64 + 1, tables.most)?;
        tables.bodies.take(&body.name, index, node, "body")?;
        self.bodies.push(body);
        Ok(index)
    }

    fn add_field(&mut self, field: SceneField, node: &Node<'_>, tables: &mut Tables) -> node::Result<usize> {
        let index = self.fields.len();
        repeat::check_count(node, index as u64 + 1, tables.most)?;
        if let Some(name) = &field.name {
            tables.fields.take(name, index, node, "force field")?;
        }
        self.fields.push(field);
        Ok(index)
    }

    fn add_joint(&mut self, joint: SceneJoint, node: &Node<'_>, tables: &mut Tables) -> node::Result<usize> {
        let index = self.joints.len();
        repeat::check_count(node, index as u64 + 1, tables.most)?;
        if let Some(name) = &joint.name {
            tables.joints.take(name, index, node, "joint")?;
        }
        self.joints.push(joint);
        Ok(index)
    }

    /// Reads a collider that an input adds to a body.
    fn add_collider(&mut self, object: &Object<'_>, body: BodyId, tables: &mut Tables) -> node::Result<ColliderId> {
        let (index, _) = body.parts();
        let body = self.bodies.get_mut(index as usize);
        let symbol = ColliderId::from_parts(index, body.as_ref().map_or(0, |body| body.colliders.len() as u32));
        let read = collider::collider(object, symbol, tables)?;
        // A body that was refused has its error there.
        if let Some(body) = body {
            body.colliders.push(read);
        }
        Ok(symbol)
    }

    /// Makes the world as it is at the start.
    ///
    /// # Errors
    /// A [`SceneError`] if the engine refuses something: the scene was changed since it was read, or a scalar other than
    /// [`Fx`] is too coarse for it.
    pub fn build<S: Scalar>(&self) -> Result<World<S>, SceneError> {
        self.start().map(SceneRun::into_world)
    }

    /// Makes the world as it is at the start, with all inputs still to come.
    ///
    /// # Errors
    /// As [`build`](Self::build).
    pub fn start<S: Scalar>(&self) -> Result<SceneRun<'_, S>, SceneError> {
        SceneRun::new(self, 1)
    }

    /// Starts the scene with several equal steps in each tick, to see the error of the time step. Inputs come at the same moments.
    /// A force that is applied for a tick acts over all of its steps as over the first: one in the body's frame does not turn with the
    /// body meanwhile, and one at a point keeps its torque. It is rounded to the scalar. A kinematic target is reached in the first of
    /// the steps, at a velocity that is higher by their number.
    ///
    /// # Errors
    /// As [`build`](Self::build); also if the steps are too short for a world.
    pub fn start_finer<S: Scalar>(&self, steps: u32) -> Result<SceneRun<'_, S>, SceneError> {
        SceneRun::new(self, steps)
    }
}

impl Tables {
    fn new(limit: u64) -> Self {
        let (bodies, fields, colliders, joints) = Default::default();
        Self { bodies, fields, colliders, joints, collider_symbols: Vec::new(), most: limit }
    }

    /// Takes in a collider of a body, by the indices of both, with a name if it has one. The node is that of the collider.
    fn add_collider(&mut self, object: &Object<'_>, name: Option<&str>, symbol: ColliderId) -> node::Result<()> {
        let index = self.collider_symbols.len();
        repeat::check_count(&object.node, index as u64 + 1, self.most)?;
        if let Some(name) = name {
            self.colliders.take(name, index, object.at(&["name"]), "collider")?;
        }
        self.collider_symbols.push(symbol);
        Ok(())
    }

    /// The handle in the scene of the collider that a text names.
    fn collider(&self, node: &Node<'_>) -> node::Result<ColliderId> {
        let index = named(node, &self.colliders, "collider")?;
        Ok(self.collider_symbols.get(index).copied().unwrap_or(ColliderId::from_parts(u32::MAX, 0)))
    }
}
