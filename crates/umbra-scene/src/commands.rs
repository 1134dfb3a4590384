//! Writing the commands that a world was given as a scene.

use alloc::collections::BTreeMap;
use alloc::format;
use alloc::vec::Vec;

use super::convert::{convert_command, convert_field, convert_joint};
use super::error::{ExportError, Place};
use super::field::{SceneField, factor_text, symbol};
use super::input::{Input, SceneAction};
use super::joint::SceneJoint;
use super::settings::Plot;
use super::{Scene, SceneBody, SceneCollider};
use umbra_physics::{
    BodyDef, BodyId, ColliderDef, ColliderId, Command, Created, Error, FieldId, FieldKind, ForceField, FxFactor,
    JointDef, JointId, World, WorldDef,
};

impl Scene {
    /// The scene that is a new world of this definition, and commands that are carried out before the steps from their ticks;
    /// those of one tick in the order of the list. Its bodies are called `body 1`, `body 2`, …, its force fields `field 1`, …,
    /// its joints `joint 1`, …, its colliders `collider 1`, ….
    ///
    /// The run of the scene has the state of that world at every tick, to the last bit and with the same handles. A command
    /// that the world refuses changes nothing and is left out, so is one at `ticks` or later; but a custom force, which
    /// another world may have, is an error. To tell, the world is run up to the last command.
    ///
    /// ```
    /// use umbra_scene::Scene;
    /// use umbra_physics::{BodyDef, BodyId, Command, Fx, WorldDef, vec2};
    ///
    /// let ball = BodyId::from_parts(0, 0);
    /// let commands = [
    ///     (0, Command::AddBody(BodyDef { position: vec2(0, 10), ..BodyDef::dynamic() })),
    ///     (2, Command::SetVelocity { body: ball, velocity: vec2(3, 0) }),
    /// ];
    /// let scene = Scene::from_commands(WorldDef::default(), &commands, 60)?;
    /// let text = scene.to_json();
    /// assert!(text.contains(r#"{"at": 2, "body": "body 1", "set": {"velocity": [3, 0]}}"#));
    /// assert_eq!(Scene::parse(&text)?.start::<Fx>()?.advance()?.tick, 1);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ExportError`] for what a scene has no words for, and for a definition that no world can be made from.
    pub fn from_commands(world: WorldDef, commands: &[(u64, Command)], ticks: u64) -> Result<Self, ExportError> {
        let mut writer = Writer {
            world: World::new(world).map_err(ExportError::World)?,
            scene: Self {
                ticks,
                world,
                title: Default::default(),
                about: Default::default(),
                bodies: Vec::new(),
                starting_bodies: 0,
                fields: Vec::new(),
                starting_fields: 0,
                joints: Vec::new(),
                starting_joints: 0,
                material_pairs: Vec::new(),
                inputs: Vec::new(),
                plot: Plot::default(),
                place: Place::default(),
            },
            bodies: BTreeMap::new(),
            fields: BTreeMap::new(),
            joints: BTreeMap::new(),
            colliders: BTreeMap::new(),
        };
        let mut order: Vec<usize> = (0..commands.len()).filter(|&i| commands[i].0 < ticks).collect();
        order.sort_by_key(|&i| commands[i].0);
        for index in order {
            let (tick, command) = &commands[index];
            while writer.world.tick() < *tick {
                writer.world.step();
            }
            writer.write(*tick, index, command)?;
        }
        Ok(writer.scene)
    }
}

/// A scene being made, and its world on the way.
struct Writer {
    world: World,
    scene: Scene,
    /// The indices in the scene of what is in the world.
    bodies: BTreeMap<BodyId, usize>,
    fields: BTreeMap<FieldId, usize>,
    joints: BTreeMap<JointId, usize>,
    /// The handles in the scene of the colliders that are in the world or were.
    colliders: BTreeMap<ColliderId, ColliderId>,
}

impl Writer {
    fn write(&mut self, tick: u64, index: usize, command: &Command) -> Result<(), ExportError> {
        if let Command::AddField(field) | Command::SetField { field, .. } = command {
            if let FieldKind::Custom { id } = field.kind {
                return Err(ExportError::CustomForce { command: index, id });
            }
        }
        // The start has bodies, then force fields, then joints: no kind's handles depend on another kind.
        let starts = tick == 0 && self.scene.inputs.is_empty();
        let Ok(created) = self.world.execute(command) else { return Ok(()) };
        let is_full = |len: usize| len >= Scene::MOST as usize;
        let action = match (command, created) {
            (Command::AddBody(def), Created::Body(body)) => {
                if is_full(self.scene.bodies.len()) || is_full(self.colliders.len() + def.colliders.len()) {
                    return Err(ExportError::Many { command: index });
                }
                let symbol = self.add_body(def.clone(), body);
                if starts {
                    self.scene.starting_bodies += 1;
                    return Ok(());
                }
                SceneAction::AddBody(symbol)
            }
            (Command::AddField(field), Created::ForceField(id)) => {
                if is_full(self.scene.fields.len()) {
                    return Err(ExportError::Many { command: index });
                }
                let symbol = self.add_field(index, field, id)?;
                if starts {
                    self.scene.starting_fields += 1;
                    return Ok(());
                }
                SceneAction::AddField(symbol)
            }
            (Command::AddCollider { body, def }, Created::Collider(collider)) => {
                if is_full(self.colliders.len()) {
                    return Err(ExportError::Many { command: index });
                }
                let Some(&body) = self.bodies.get(body) else { return Ok(()) };
                SceneAction::AddCollider(self.add_collider(body, def.clone(), collider))
            }
            (Command::AddJoint(def), Created::Joint(id)) => {
                if is_full(self.scene.joints.len()) {
                    return Err(ExportError::Many { command: index });
                }
                let symbol = self.add_joint(def, id);
                if starts {
                    self.scene.starting_joints += 1;
                    return Ok(());
                }
                SceneAction::AddJoint(symbol)
            }
            (command, _) => {
                if let Command::SetField { field, .. } = command {
                    check_mu(index, field)?;
                }
                let known = |field| self.fields.get(&field).map(|&i| FieldId::from_parts(i as u32, 0));
                let fields = |field| known(field).ok_or(Error::NoSuchField { field });
                let known = |collider| self.colliders.get(&collider).copied();
                let colliders = |collider| known(collider).ok_or(Error::NoSuchCollider { collider });
                let known = |joint| self.joints.get(&joint).map(|&i| JointId::from_parts(i as u32, 0));
                let joints = |joint| known(joint).ok_or(Error::NoSuchJoint { joint });
                // Carried out, so that all it names is there.
                let converted = convert_command(command, &|body| self.body(body), &fields, &colliders, &joints);
                let Ok(command) = converted else { return Ok(()) };
                SceneAction::Command(command)
            }
        };
        if is_full(self.scene.inputs.len()) {
            return Err(ExportError::Many { command: index });
        }
        self.scene.inputs.push(Input { from: tick, to: tick, every: 1, action, place: Place::default() });
        Ok(())
    }

    fn body(&self, body: BodyId) -> Result<BodyId, Error> {
        self.bodies.get(&body).map(|&index| symbol(index)).ok_or(Error::NoSuchBody { body })
    }

    fn add_body(&mut self, def: BodyDef, body: BodyId) -> usize {
        let index = self.scene.bodies.len();
        self.bodies.insert(body, index);
        let (name, place) = (format!("body {}", index + 1), Place::default());
        let starting_colliders = def.colliders.len();
        let colliders = Vec::with_capacity(starting_colliders);
        let bare = BodyDef { colliders: Vec::new(), ..def.clone() };
        self.scene.bodies.push(SceneBody { name, def: bare, colliders, starting_colliders, place });
        // In the order of the definition.
        let handles: Vec<ColliderId> = self.world.colliders_of(body).into_iter().flatten().collect();
        for (def, handle) in def.colliders.into_iter().zip(handles) {
            self.add_collider(index, def, handle);
        }
        index
    }

    fn add_collider(&mut self, body: usize, def: ColliderDef, collider: ColliderId) -> ColliderId {
        let name = Some(format!("collider {}", self.colliders.len() + 1));
        let colliders = &mut self.scene.bodies[body].colliders;
        let symbol = ColliderId::from_parts(body as u32, colliders.len() as u32);
        colliders.push(SceneCollider { name, def, place: Place::default() });
        self.colliders.insert(collider, symbol);
        symbol
    }

    fn add_field(&mut self, command: usize, field: &ForceField, id: FieldId) -> Result<usize, ExportError> {
        check_mu(command, field)?;
        let index = self.scene.fields.len();
        // Carried out, so that all it names is there.
        let field = convert_field(field, &|body| self.body(body)).unwrap_or(*field);
        let name = Some(format!("field {}", index + 1));
        self.scene.fields.push(SceneField { name, field, place: Place::default() });
        self.fields.insert(id, index);
        Ok(index)
    }

    fn add_joint(&mut self, def: &JointDef, id: JointId) -> usize {
        let index = self.scene.joints.len();
        // Carried out, so that all it names is there.
        let def = convert_joint(def, &|body| self.body(body)).unwrap_or(*def);
        let name = Some(format!("joint {}", index + 1));
        self.scene.joints.push(SceneJoint { name, def, place: Place::default() });
        self.joints.insert(id, index);
        index
    }
}

/// Refuses a factor that no text is read as.
fn check_mu(command: usize, field: &ForceField) -> Result<(), ExportError> {
    match field.kind {
        FieldKind::Attractor { mu, .. } if FxFactor::parse(&factor_text(mu)) != Ok(mu) => {
            Err(ExportError::Mu { command })
        }
        _ => Ok(()),
    }
}
