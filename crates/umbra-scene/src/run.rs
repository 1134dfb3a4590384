//! A scene that is running: its world, and the inputs still to come.

use alloc::collections::{BTreeMap, BTreeSet};
use alloc::format;
use alloc::string::{String, ToString};
use alloc::vec::Vec;

use super::convert::{convert_command, convert_contacts, convert_damping, convert_field, convert_joint};
use super::error::{Coded, Flaw, Found, Place, SceneError, SceneErrors};
use super::field::symbol;
use super::input::{Input, SceneAction};
use super::node::quoted;
use super::shape::vector;
use super::{Scene, SceneMaterialPair};
use umbra_physics::{
    ApplyOptions, BodyId, ColliderId, Command, Created, Error, FieldId, ForceOrImpulse, Fx, JointId, Labels, Quantity,
    Scalar, StepReport, Stepper, TimeStep, World, WorldDef, scalar::Wide,
};

/// A running scene: its world, and the inputs still to come.
#[derive(Clone, Debug)]
pub struct SceneRun<'a, S: Scalar = Fx> {
    scene: &'a Scene,
    world: World<S>,
    /// Steps to a tick of the scene.
    steps: u32,
    bodies: Vec<Option<BodyId>>,
    fields: Vec<Option<FieldId>>,
    joints: Vec<Option<JointId>>,
    /// By the index of a body and that of a collider of it.
    colliders: BTreeMap<(u32, u32), ColliderId>,
    indices: BTreeMap<BodyId, usize>,
    /// The inputs in the order of their first ticks, and how many of them have begun.
    order: Vec<usize>,
    begun: usize,
    /// The inputs that have begun and not ended, in the order of the file.
    active: BTreeSet<usize>,
}

impl<'a, S: Scalar> SceneRun<'a, S> {
    pub(super) fn new(scene: &'a Scene, steps: u32) -> Result<Self, SceneError> {
        let def = &scene.world;
        let damping = |damping| convert_damping(damping).map_err(|error| scene.place.fault(error));
        let world = World::with_scalar(WorldDef {
            time_step: divided(def.time_step, steps),
            gravity: vector(def.gravity),
            integrator: def.integrator,
            linear_damping: damping(def.linear_damping)?,
            angular_damping: damping(def.angular_damping)?,
            sleep_after: def.sleep_after.map(|ticks| ticks.saturating_mul(steps)),
            contacts: convert_contacts(&def.contacts).map_err(|error| scene.place.fault(error))?,
        });
        let world = world.map_err(|error| scene.place.fault(error))?;
        let mut order: Vec<usize> = (0..scene.inputs.len()).collect();
        order.sort_by_key(|&index| scene.inputs[index].from);
        let mut run = Self {
            scene,
            world,
            steps,
            bodies: Vec::new(),
            fields: Vec::new(),
            joints: Vec::new(),
            colliders: BTreeMap::new(),
            indices: BTreeMap::new(),
            order,
            begun: 0,
            active: BTreeSet::new(),
        };
        run.bodies.resize(scene.bodies.len(), None);
        run.fields.resize(scene.fields.len(), None);
        run.joints.resize(scene.joints.len(), None);
        if scene.starting_bodies > scene.bodies.len()
            || scene.starting_fields > scene.fields.len()
            || scene.starting_joints > scene.joints.len()
        {
            let message = "out of range: the start has more bodies, force fields or joints than the scene";
            return Err(scene.place.fault(Flaw::OutOfRange.of(message)));
        }
        for SceneMaterialPair { materials: [first, second], pair, place } in &scene.material_pairs {
            let command = Command::SetMaterialPair { first: *first, second: *second, pair: Some(*pair) };
            run.carry_out(&SceneAction::Command(command), &mut ()).map_err(|error| place.fault(error))?;
        }
        for index in 0..scene.starting_bodies {
            run.carry_out(&SceneAction::AddBody(index), &mut ())
                .map_err(|e| scene.bodies[index].place.fault(Coded(e.code(), run.explain(e))))?;
        }
        for index in 0..scene.starting_fields {
            run.carry_out(&SceneAction::AddField(index), &mut ())
                .map_err(|e| scene.fields[index].place.fault(Coded(e.code(), run.explain(e))))?;
        }
        for index in 0..scene.starting_joints {
            run.carry_out(&SceneAction::AddJoint(index), &mut ())
                .map_err(|e| scene.joints[index].place.fault(Coded(e.code(), run.explain(e))))?;
        }
        Ok(run)
    }

    /// The world.
    #[must_use]
    pub fn world(&self) -> &World<S> {
        &self.world
    }

    /// Returns the world, without the inputs still to come.
    #[must_use]
    pub fn into_world(self) -> World<S> {
        self.world
    }

    /// The index in [`Scene::bodies`] of a body.
    #[must_use]
    pub fn index(&self, body: BodyId) -> Option<usize> {
        self.indices.get(&body).copied()
    }

    /// The name of a body; empty if it is none of the scene's.
    #[must_use]
    pub fn name(&self, body: BodyId) -> &'a str {
        self.index(body).map_or("", |index| &self.scene.bodies[index].name)
    }

    /// The names of the bodies, force fields, joints and colliders that the scene has added up to now, for a
    /// [`Recorder`](umbra_physics::Recorder::labels_mut): the replay then has them too.
    #[must_use]
    pub fn labels(&self) -> Labels {
        let mut labels = Labels::new();
        for (body, index) in &self.indices {
            labels.set_body(*body, &self.scene.bodies[*index].name);
        }
        for (field, id) in self.scene.fields.iter().zip(&self.fields) {
            if let (Some(name), Some(id)) = (&field.name, id) {
                labels.set_field(*id, name);
            }
        }
        for (joint, id) in self.scene.joints.iter().zip(&self.joints) {
            if let (Some(name), Some(id)) = (&joint.name, id) {
                labels.set_joint(*id, name);
            }
        }
        for (&(index, collider_index), id) in &self.colliders {
            let collider = self.scene.bodies[index as usize].colliders.get(collider_index as usize);
            if let Some(name) = collider.and_then(|collider| collider.name.as_deref()) {
                labels.set_collider(*id, name);
            }
        }
        labels
    }

    /// The number of ticks that were made.
    #[must_use]
    pub fn tick(&self) -> u64 {
        self.world.tick() / u64::from(self.steps)
    }

    /// Carries out the inputs of this tick and steps the world. Where a tick has several steps, the report is that of the
    /// last.
    ///
    /// # Errors
    /// A [`SceneError`] at an input that the world refuses. The inputs before it have been carried out.
    pub fn advance(&mut self) -> Result<StepReport<'_, S>, SceneError> {
        self.advance_by(&mut ())
    }

    /// Advances by a tick through a driver, which carries out all commands and steps the world. With a
    /// [`Recorder`](umbra_physics::Recorder) that was made from the world at the start, the run becomes a replay.
    ///
    /// ```
    /// use umbra_scene::Scene;
    /// use umbra_physics::{RecordOptions, Recorder, Replay};
    ///
    /// let push = r#"{"at": 2, "body": "a", "impulse": [1, 0]}"#;
    /// let scene = Scene::parse(&format!(r#"{{"bodies": [{{"name": "a"}}], "inputs": [{push}]}}"#))?;
    /// let mut run = scene.start()?;
    /// let mut recorder = Recorder::new(run.world(), RecordOptions::default());
    /// for _ in 0..5 {
    ///     run.advance_by(&mut recorder)?;
    /// }
    /// *recorder.labels_mut() = run.labels();
    /// let replay = Replay::from_bytes(&recorder.finish(run.world()), &[])?;
    /// assert_eq!((replay.end(), replay.verify()), (5, Ok(())));
    /// let body = run.world().bodies().next().unwrap().id();
    /// assert_eq!(replay.labels().body(body), Some("a"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`advance`](Self::advance).
    pub fn advance_by(&mut self, driver: &mut impl Stepper<S>) -> Result<StepReport<'_, S>, SceneError> {
        let tick = self.tick();
        let scene = self.scene;
        while let Some(&index) = self.order.get(self.begun).filter(|&&index| scene.inputs[index].from <= tick) {
            self.active.insert(index);
            self.begun += 1;
        }
        let due: Vec<usize> = self.active.iter().copied().filter(|&i| scene.inputs[i].is_due(tick)).collect();
        for index in due {
            let Input { action, place, .. } = &scene.inputs[index];
            let done = self.carry_out(action, driver);
            done.map_err(|error| self.blame(place, tick, error))?;
        }
        self.active.retain(|&index| scene.inputs[index].to > tick);
        driver.step(&mut self.world);
        for _ in 1..self.steps {
            let held = self.hold(driver);
            held.map_err(|error| self.blame(&scene.place, tick, error))?;
            driver.step(&mut self.world);
        }
        Ok(self.world.last_report())
    }

    /// Applies over the next step what was applied over the last.
    fn hold(&mut self, driver: &mut impl Stepper<S>) -> Result<(), Error> {
        let options = ApplyOptions { wake: false, ..ApplyOptions::default() };
        for applied in self.world.last_report().applied.to_vec() {
            let body = applied.body;
            if !self.world.body(body)?.activity().takes_part() {
                continue;
            }
            let force = applied.force().and_then(|force| force.try_map(S::Wide::to_scalar));
            let force = force.ok_or(Error::OutOfRange { quantity: Quantity::Force })?;
            let torque = applied.torque().and_then(S::Wide::to_scalar);
            let torque = torque.ok_or(Error::OutOfRange { quantity: Quantity::Torque })?;
            for action in [ForceOrImpulse::Force { force, point: None }, ForceOrImpulse::Torque(torque)] {
                driver.execute(&mut self.world, &Command::Apply { body, action, options })?;
            }
        }
        Ok(())
    }

    /// Tries the inputs in their order, on a world that does not move on. One that is refused changes nothing, and the next are tried.
    pub(super) fn rehearse(mut self) -> Result<(), SceneErrors> {
        let faults = Found::default();
        for index in core::mem::take(&mut self.order) {
            let Input { from, action, place, .. } = &self.scene.inputs[index];
            // What these are refused for depends on the motion before.
            let depends = matches!(
                action,
                SceneAction::Command(
                    Command::Release(_) | Command::Sleep(_) | Command::MoveTo { .. } | Command::Explode(_)
                ) | SceneAction::Command(Command::Apply {
                    action: ForceOrImpulse::Impulse { .. }
                        | ForceOrImpulse::AngularImpulse(_)
                        | ForceOrImpulse::Force { point: Some(_), .. },
                    ..
                })
            );
            if !depends {
                if let Err(error) = self.carry_out(action, &mut ()) {
                    faults.add(|| self.blame(place, *from, error));
                }
            }
        }
        faults.finish()
    }

    fn carry_out(&mut self, action: &SceneAction, driver: &mut impl Stepper<S>) -> Result<(), Error> {
        let command = match self.command(action)? {
            // Of a joint whose motor pushes it is another command.
            Command::SetJointMotor { joint, motor } => self.world.joint_motor_command(joint, motor)?,
            command => command,
        };
        let created = driver.execute(&mut self.world, &command)?;
        match (action, created) {
            (SceneAction::AddBody(index), Created::Body(body)) => {
                self.bodies[*index] = Some(body);
                self.indices.insert(body, *index);
                // In the order of the definition.
                let created_colliders = (0u32..).zip(self.world.colliders_of(body)?);
                self.colliders.extend(created_colliders.map(|(place, collider)| ((*index as u32, place), collider)));
            }
            (SceneAction::AddField(index), Created::ForceField(field)) => self.fields[*index] = Some(field),
            (SceneAction::AddJoint(index), Created::Joint(joint)) => self.joints[*index] = Some(joint),
            (SceneAction::AddCollider(symbol), Created::Collider(collider)) => {
                self.colliders.insert(symbol.parts(), collider);
            }
            _ => {}
        }
        Ok(())
    }

    /// Returns the command to the world that an action is.
    fn command(&self, action: &SceneAction) -> Result<Command<S>, Error> {
        Ok(match action {
            SceneAction::AddBody(index) => {
                let unknown = Error::NoSuchBody { body: symbol(*index) };
                Command::AddBody(self.scene.bodies.get(*index).ok_or(unknown)?.def()?)
            }
            SceneAction::AddField(index) => {
                let unknown = Error::NoSuchField { field: FieldId::from_parts(*index as u32, 0) };
                let field = &self.scene.fields.get(*index).ok_or(unknown)?.field;
                Command::AddField(convert_field(field, &|body| self.body(body))?)
            }
            SceneAction::AddJoint(index) => {
                let unknown = Error::NoSuchJoint { joint: JointId::from_parts(*index as u32, 0) };
                let def = &self.scene.joints.get(*index).ok_or(unknown)?.def;
                Command::AddJoint(convert_joint(def, &|body| self.body(body))?)
            }
            SceneAction::AddCollider(symbol) => {
                let (index, collider_index) = symbol.parts();
                let symbol_body = BodyId::from_parts(index, 0);
                let body = self.scene.bodies.get(index as usize);
                let collider = body.and_then(|body| body.colliders.get(collider_index as usize));
                let def = collider.ok_or(Error::NoSuchCollider { collider: *symbol })?.def()?;
                Command::AddCollider { body: self.body(symbol_body)?, def }
            }
            SceneAction::Command(command) => {
                let (fields, colliders) = (|field| self.field(field), |collider| self.collider(collider));
                let (bodies, joints) = (|body| self.body(body), |joint| self.joint(joint));
                match convert_command(command, &bodies, &fields, &colliders, &joints)? {
                    Command::SetTimeStep(time_step) => Command::SetTimeStep(divided(time_step, self.steps)),
                    Command::SetSleepAfter(ticks) => {
                        Command::SetSleepAfter(ticks.map(|ticks| ticks.saturating_mul(self.steps)))
                    }
                    command => command,
                }
            }
        })
    }

    /// The handle of a body that a scene names by its index.
    fn body(&self, symbol: BodyId) -> Result<BodyId, Error> {
        let known = self.bodies.get(symbol.parts().0 as usize).copied().flatten();
        known.ok_or(Error::NoSuchBody { body: BodyId::from_parts(u32::MAX, 0) })
    }

    fn field(&self, symbol: FieldId) -> Result<FieldId, Error> {
        let known = self.fields.get(symbol.parts().0 as usize).copied().flatten();
        known.ok_or(Error::NoSuchField { field: symbol })
    }

    fn collider(&self, symbol: ColliderId) -> Result<ColliderId, Error> {
        self.colliders.get(&symbol.parts()).copied().ok_or(Error::NoSuchCollider { collider: symbol })
    }

    fn joint(&self, symbol: JointId) -> Result<JointId, Error> {
        let known = self.joints.get(symbol.parts().0 as usize).copied().flatten();
        known.ok_or(Error::NoSuchJoint { joint: symbol })
    }

    /// Puts an error of the engine at the place of the input that it refuses.
    fn blame(&self, place: &Place, tick: u64, error: Error) -> SceneError {
        place.fault(Coded(error.code(), format_args!("at tick {tick}: {}", self.explain(error))))
    }

    /// An error of the engine's, with names in place of handles.
    fn explain(&self, error: Error) -> String {
        let (body, what) = match error {
            Error::NoSuchBody { .. } => return "the body does not exist at that tick".to_string(),
            Error::NoSuchField { .. } => return "the force field does not exist at that tick".to_string(),
            Error::NoSuchCollider { .. } => return "the collider does not exist at that tick".to_string(),
            Error::NoSuchJoint { .. } => return "the joint does not exist at that tick".to_string(),
            Error::NoMotor { .. } => return "the joint is of a kind that has no motor".to_string(),
            Error::NotDynamic { body } => (body, "is not dynamic"),
            Error::NotMovable { body } => (body, "is static and has no velocity"),
            Error::Quarantined { body } => (body, "is quarantined"),
            Error::NotQuarantined { body } => (body, "is not quarantined"),
            Error::Disabled { body } => (body, "is disabled"),
            Error::NotDisabled { body } => (body, "is not disabled"),
            Error::NotKinematic { body } => (body, "is not kinematic"),
            Error::KeptAwake { kinematic } => {
                (kinematic, "moves, and touches the bodies that were to sleep or is joined to them: stop it first")
            }
            Error::SameBody { body } => (body, "is named twice, where two bodies are needed"),
            error => return error.to_string(),
        };
        format!("{} {what}", quoted(self.name(body)))
    }
}

/// A part of a time step; what has none is refused by the world.
fn divided(time_step: TimeStep, divisor: u32) -> TimeStep {
    let (num, den) = time_step.seconds();
    TimeStep::ratio(num, den.checked_mul(divisor).unwrap_or(0))
}
