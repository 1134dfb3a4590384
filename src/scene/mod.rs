//! Scenes: a world and its inputs as JSON text.
//!
//! A number is taken from the text itself and rounded once, never through a float; an error names line and field. The
//! format is in `docs/scene.md`.
//!
//! ```
//! use umbra_physics::{Fx, fx, scene::Scene};
//!
//! let scene = Scene::parse(r#"{
//!     "gravity": [0, -10],
//!     "bodies": [{"name": "ball", "position": [0, 10], "shape": {"circle": {"radius": 0.5}}}],
//!     "inputs": [{"at": 30, "body": "ball", "impulse": [0, 5]}]
//! }"#)?;
//! let mut run = scene.start::<Fx>()?;
//! for _ in 0..60 {
//!     run.advance()?;
//! }
//! let [ball] = run.world().bodies().collect::<Vec<_>>()[..] else { unreachable!() };
//! // 10 − ½·10·1² + 5·½, exactly.
//! assert_eq!(ball.position().y, fx!(7.5));
//! # Ok::<(), umbra_physics::scene::SceneError>(())
//! ```

mod body;
mod commands;
mod error;
mod field;
mod input;
mod node;
mod repeat;
mod run;
mod settings;
mod shape;
mod text;

use alloc::string::String;
use alloc::vec::Vec;

use crate::scalar::{Scalar, fx::Fx};
use crate::world::{World, WorldDef};
use field::Names;
use node::{Node, Object, Source, quoted};

pub use body::SceneBody;
pub use error::{Place, SceneError, Unsayable};
pub use field::SceneField;
pub use input::{Deed, Input};
pub use run::SceneRun;
pub use settings::{Plot, Trails};
pub use shape::{PartDef, ShapeDef};

/// A world to be built, and what is done to it at which tick. Plain data; changes to it are checked when it starts.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Its title.
    pub title: String,
    /// What it is about and what to see.
    pub about: String,
    /// How many ticks it is meant to run for.
    pub ticks: u64,
    /// What the world is made from.
    pub world: WorldDef,
    /// All bodies, those that inputs add behind the others.
    pub bodies: Vec<SceneBody>,
    /// How many of them are there from the start.
    pub starting_bodies: usize,
    /// All force fields, those that inputs add behind the others.
    pub fields: Vec<SceneField>,
    /// How many of them are there from the start.
    pub starting_fields: usize,
    /// What is done, in the order of the file; at the same tick in this order.
    pub inputs: Vec<Input>,
    /// How to draw it.
    pub plot: Plot,
    /// Where it begins.
    pub place: Place,
}

/// The names that are taken, with their indices.
#[derive(Default)]
struct Tables {
    bodies: Names,
    fields: Names,
}

/// How many ticks a scene runs for that does not say.
const TICKS: u64 = 600;

impl Scene {
    /// The scene that a JSON text describes.
    ///
    /// # Errors
    /// A [`SceneError`] with the line and the field: text that is not JSON, unknown or doubled fields, names that are
    /// taken or that nothing has, and what the engine would refuse.
    pub fn parse(text: &str) -> Result<Self, SceneError> {
        let source = Source::new(text);
        let root = Node::document(&source)?;
        let object = root.object()?;
        let mut scene = Self {
            title: settings::words(&object, "title")?,
            about: settings::words(&object, "about")?,
            ticks: object.or("ticks", TICKS, Node::whole)?,
            world: settings::world(&object)?,
            bodies: Vec::new(),
            starting_bodies: 0,
            fields: Vec::new(),
            starting_fields: 0,
            inputs: Vec::new(),
            plot: Plot::default(),
            place: root.place(),
        };
        let mut tables = Tables::default();
        scene.read_start(&object, &mut tables)?;
        if let Some(list) = object.get("inputs") {
            repeat::each(list, |object| input::input(object, &mut scene, &mut tables))?;
        }
        if let Some(node) = object.get("plot") {
            scene.plot = settings::plot(node, &tables.bodies)?;
        }
        object.finish()?;
        if !scene.inputs.is_empty() {
            scene.start::<Fx>()?.rehearse()?;
        }
        Ok(scene)
    }

    /// The bodies and the force fields of the start. Both are added to a world as they are read, which refuses what is
    /// wrong with them while the place is known.
    fn read_start(&mut self, object: &Object<'_>, tables: &mut Tables) -> Result<(), SceneError> {
        let mut world = World::new(self.world).map_err(|error| object.node.fault(error))?;
        let mut handles = Vec::new();
        if let Some(list) = object.get("bodies") {
            repeat::each(list, |object| {
                let read = body::body(object)?;
                let def = read.def().map_err(|error| body::blame(object, error))?;
                handles.push(world.add_body(def).map_err(|error| body::blame(object, error))?);
                self.add_body(read, object.at(&["name"]), tables).map(drop)
            })?;
        }
        self.starting_bodies = self.bodies.len();
        if let Some(list) = object.get("fields") {
            repeat::each(list, |object| {
                let read = field::field(object, &tables.bodies)?;
                // All names are those of bodies that were added above.
                let field = field::convert_field(&read.field, &|body| Ok(handles[body.parts().0 as usize]));
                let added = field.and_then(|field| world.add_field(field));
                added.map_err(|error| field::blame(object, error))?;
                self.add_field(read, object.at(&["name"]), tables).map(drop)
            })?;
        }
        self.starting_fields = self.fields.len();
        Ok(())
    }

    fn add_body(&mut self, body: SceneBody, node: &Node<'_>, tables: &mut Tables) -> Result<usize, SceneError> {
        let index = self.bodies.len();
        if tables.bodies.insert(body.name.clone(), index).is_some() {
            return Err(node.fault(format_args!("there is a body {} already", quoted(&body.name))));
        }
        self.bodies.push(body);
        Ok(index)
    }

    fn add_field(&mut self, field: SceneField, node: &Node<'_>, tables: &mut Tables) -> Result<usize, SceneError> {
        let index = self.fields.len();
        if let Some(name) = &field.name {
            if tables.fields.insert(name.clone(), index).is_some() {
                return Err(node.fault(format_args!("there is a force field {} already", quoted(name))));
            }
        }
        self.fields.push(field);
        Ok(index)
    }

    /// The world as it is at the start.
    ///
    /// # Errors
    /// A [`SceneError`] if the engine refuses something: the scene was changed since it was read, or a scalar other than
    /// [`Fx`] is too coarse for it.
    pub fn build<S: Scalar>(&self) -> Result<World<S>, SceneError> {
        self.start().map(SceneRun::into_world)
    }

    /// The world as it is at the start, with the inputs before it.
    ///
    /// # Errors
    /// As [`build`](Self::build).
    pub fn start<S: Scalar>(&self) -> Result<SceneRun<'_, S>, SceneError> {
        SceneRun::new(self, 1)
    }

    /// The same with so many equal steps to each tick, to see what the time step costs. Inputs come at the same moments.
    /// What is applied for a tick acts over all of its steps as it did over the first: a force in the body's frame does not
    /// turn with it meanwhile, one at a point keeps its torque. It is rounded to the scalar.
    ///
    /// # Errors
    /// As [`build`](Self::build); also if the steps are too short for a world.
    pub fn start_finer<S: Scalar>(&self, steps: u32) -> Result<SceneRun<'_, S>, SceneError> {
        SceneRun::new(self, steps)
    }
}
