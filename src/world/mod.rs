//! The world: bodies, force fields, and the parameters of the step.

mod bodies;
mod body_ref;
mod change_log;
mod check;
mod colliders;
mod command;
mod command_map;
mod command_source;
mod commands;
mod contacts;
mod events;
mod excluded;
mod explosion;
mod fields;
mod forces;
mod game;
mod inputs;
mod joint_defs;
mod joint_ref;
mod joints;
mod journal;
mod preview;
mod queries;
mod query;
mod reverse;
mod rollback;
mod settings;
mod stance;
mod stepper;
mod totals;
mod trace;
mod wake;

use alloc::sync::Arc;
use alloc::vec::Vec;

use crate::body::{Bodies, Damping, FactorTable, KinematicTargets, WorldFactors};
use crate::codec::codec_struct;
use crate::collider::{ColliderSet, ContactSettings};
use crate::contact::ContactSet;
use crate::error::{Error, Quantity};
use crate::force::{Applied, CustomForces, FieldSet};
use crate::fx::Fx;
use crate::integrate::{Integrator, Plan};
use crate::joint::{JointSet, JointStates};
use crate::limits;
use crate::math::{Elapsed, Random, TimeStep, Vec2};
use crate::scalar::Scalar;
use crate::step::{Contacts, Forces, Probe, Settings, Step, Workspace};
use crate::timers::timed;

pub use body_ref::BodyRef;
pub(crate) use change_log::ChangeLog;
pub use command_map::CommandMap;
pub use command_source::CommandSource;
pub use commands::{Command, Created};
pub use events::{Event, StepReport};
pub use explosion::Explosion;
pub use forces::{ApplyOptions, ForceOrImpulse, Frame};
pub use inputs::{Input, InputResult, Inputs, InputsIter};
pub use joint_ref::JointRef;
pub(crate) use journal::Journal;
pub use preview::Preview;
pub(crate) use queries::Neighbour;
pub use queries::{CastHit, ClosestPoint, Queries, QueryFilter};
pub use query::BodyIter;
pub use rollback::{ConfirmedTick, EventStatus, Rollback, RollbackReport, TickEvent};
pub(crate) use stance::{Moment, Stance};
pub use stepper::Stepper;
pub use trace::Trace;

/// The definition of a world: change what differs from the default, which has no gravity.
///
/// ```
/// use umbra_physics::{ContactSettings, Damping, TimeStep, World, WorldDef, fx, vec2};
///
/// let world = World::new(WorldDef {
///     time_step: TimeStep::hz(120),
///     gravity: vec2(0, fx!(-9.81)),
///     linear_damping: Damping::rate(fx!(0.1)),
///     contacts: ContactSettings { restitution_speed: fx!(0.5), ..ContactSettings::default() },
///     ..WorldDef::default()
/// })?;
/// assert_eq!(world.def().sleep_after, Some(30));
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct WorldDef<S: Scalar = Fx> {
    /// The length of a step, 1 to 10,000 steps a second; 60 by default.
    pub time_step: TimeStep,
    /// Gravity, m/s², each component within ±2^16. The default is none. In a world seen from above nothing has to come to rest in spite of
    /// gravity: let slow balls bounce too, by [`ContactSettings::restitution_speed`] 0.
    pub gravity: Vec2<S>,
    /// The integrator.
    pub integrator: Integrator,
    /// The damping of velocities, for bodies without their own.
    pub linear_damping: Damping<S>,
    /// The damping of angular velocities, for bodies without their own.
    pub angular_damping: Damping<S>,
    /// The number of ticks at rest after which a body falls asleep, from 1; 30 by default, `None` for never. A body that contacts push
    /// counts as at rest while it is slower than [`ContactSettings::sleep_speed`].
    pub sleep_after: Option<u32>,
    /// The settings of contacts.
    pub contacts: ContactSettings<S>,
}

impl<S: Scalar> Default for WorldDef<S> {
    /// 60 steps a second by velocity Verlet, no gravity, no damping, asleep after half a second at rest.
    fn default() -> Self {
        Self {
            time_step: TimeStep::hz(60),
            gravity: Vec2::ZERO,
            integrator: Integrator::default(),
            linear_damping: Damping::NONE,
            angular_damping: Damping::NONE,
            sleep_after: Some(30),
            contacts: ContactSettings::default(),
        }
    }
}

codec_struct!(WorldDef { time_step, gravity, integrator, linear_damping, angular_damping, sleep_after, contacts });

impl<S: Scalar> WorldDef<S> {
    /// Checks the definition.
    ///
    /// # Errors
    /// [`Error::TimeStep`]; [`Error::OutOfRange`] naming the quantity; [`Error::DampingHasNoInverse`].
    ///
    /// ```
    /// use umbra_physics::{Error, Quantity, TimeStep, WorldDef, vec2};
    ///
    /// let def = WorldDef { gravity: vec2(0, 100_000), ..WorldDef::default() };
    /// assert_eq!(def.check(), Err(Error::OutOfRange { quantity: Quantity::Gravity }));
    /// let def: WorldDef = WorldDef { time_step: TimeStep::hz(20_000), ..WorldDef::default() };
    /// assert_eq!(def.check(), Err(Error::TimeStep));
    /// ```
    pub fn check(&self) -> Result<(), Error> {
        self.time_step.checked()?;
        check_gravity(self.gravity)?;
        self.linear_damping.check()?;
        self.angular_damping.check()?;
        check_sleep_after(self.sleep_after)?;
        self.contacts.check()?;
        let stops = self.linear_damping.stops() || self.angular_damping.stops();
        if self.integrator == Integrator::Yoshida4 && stops {
            return Err(Error::DampingHasNoInverse);
        }
        Ok(())
    }
}

fn check_gravity<S: Scalar>(gravity: Vec2<S>) -> Result<(), Error> {
    if gravity.is_within(S::from_fx(limits::GRAVITY)) {
        return Ok(());
    }
    Err(Error::OutOfRange { quantity: Quantity::Gravity })
}

fn check_sleep_after(ticks: Option<u32>) -> Result<(), Error> {
    if ticks == Some(0) {
        return Err(Error::OutOfRange { quantity: Quantity::SleepAfter });
    }
    Ok(())
}

/// Bodies with colliders, and force fields, simulated tick by tick.
///
/// The next step depends on the state and the inputs alone, and no body's bits depend on bodies it does not interact with.
///
/// `clone` makes a world with the same future; `clone_from` does so in the memory of another world. Reports of calls and steps
/// are not part of the state: they are not in the hash.
///
/// # Cost
/// A call or a [`Command`] takes constant time, up to a logarithm: at most 10,000 instructions. The exceptions:
///
/// | call | takes time in proportion to |
/// |---|---|
/// | `set_blob` | its bytes |
/// | `add_body`, `add_collider`, `set_collider` | the corners and parts of the shapes |
/// | `set_collider`, `remove_collider` | all contacts and overlaps of sensors |
/// | [`explode`](Self::explode) | the bodies that are not static, and the colliders of those in reach |
/// | `remove_body` | the fields and joints attached to the body, its colliders, and all contacts and overlaps of sensors |
/// | `exclude_pair`, `contacts_of`, and the calls that change a joint without `collide_connected` | all contacts |
/// | [`queries`](Self::queries) | the colliders, as it says there |
/// | a call that wakes | the bodies it wakes and the fields and joints attached to them |
/// | [`sleep`](Self::sleep), if it puts a body to sleep | all contacts, the bodies it puts to sleep, and the fields and joints attached to them |
/// | `set_kind`, `disable`, `enable`, and any change of a static or kinematic body, once between two steps | the fields and joints attached to the body |
/// | `add_field`, `set_field`, `remove_field` for groups in which a body sleeps | all bodies; afterwards no body of these groups sleeps |
/// | `set_sleep_after`, once between two steps | all bodies |
/// | the first change after a copy was made | all bodies, all fields or all joints, whichever it changes: copies share them until then |
/// | `step`, `step_back` | the bodies that move, and for each the fields that act on it; `step` also their joints, and the pairs of colliders near each other |
/// | calls that read the whole world: `bodies`, `fields`, `joints`, `bodies_with_key`, energies, hashes, copies, differences, drawing | the world |
/// | [`preview`](Self::preview) | all fields, and the bodies that its body depends on |
///
/// Some calls leave work to the next step, which does it once for all of them. After a change of the time step, the integrator,
/// gravity or damping, it computes the factors of the moving bodies, once for bodies with the same damping. After a change of a
/// body, it hashes the properties of that body. After changes of bodies with colliders that are static or asleep, and of colliders, it
/// looks at the colliders of these bodies, or at all of them if many changed: for n colliders it takes n·log n, once for all calls. A search for expensive commands found no kilobyte of them
/// that costs more than ten steps of its world, including that work.
#[doc(alias("PhysicsWorld", "PhysicsPipeline"))]
pub struct World<S: Scalar = Fx> {
    pub(crate) def: WorldDef<S>,
    pub(crate) tick: u64,
    /// The time at which the present time step began to count, and the tick of it.
    pub(crate) counted: (Elapsed, u64),
    pub(crate) bodies: Bodies<S>,
    /// Shared with copies of the world until one changes it, as are the colliders, the custom forces and the factor table.
    pub(crate) fields: Arc<FieldSet<S>>,
    pub(crate) colliders: Arc<ColliderSet<S>>,
    pub(crate) contacts: ContactSet,
    /// Shared as well.
    pub(crate) joints: Arc<JointSet<S>>,
    pub(crate) joint_states: JointStates,
    pub(crate) custom_forces: Arc<CustomForces<S>>,
    pub(crate) applied: Applied<S>,
    pub(crate) targets: KinematicTargets<S>,
    pub(crate) random: Random,
    pub(crate) blob: Vec<u8>,
    // The fields below are derived values, scratch memory and reports.
    pub(crate) factor_table: Arc<FactorTable<S>>,
    pub(crate) plan: Plan<S>,
    pub(crate) workspace: Workspace<S>,
    pub(crate) change_log: ChangeLog,
    pub(crate) journal: Journal<S>,
}

clone_by_field!((clone_world, clone_world_from) World {
    def,
    tick,
    counted,
    bodies,
    fields,
    colliders,
    contacts,
    joints,
    joint_states,
    custom_forces,
    applied,
    targets,
    random,
    blob,
    factor_table,
    plan,
    workspace,
    change_log,
    journal,
});

impl World {
    /// An empty world.
    ///
    /// # Errors
    /// As [`WorldDef::check`].
    pub fn new(def: WorldDef) -> Result<Self, Error> {
        Self::with_scalar(def)
    }
}

impl<S: Scalar> World<S> {
    /// An empty world with numbers of the type of its definition: of [`Fx`], or of floats to compare with.
    ///
    /// A world of floats takes the contacts that integers find, at its poses rounded to [`Fx`]: their error of 2^-32 m is far below what
    /// floats are compared for. The free flight and the solver compute in floats. For contacts as a whole, Box2D and Rapier are the
    /// references in floats.
    ///
    /// # Errors
    /// As [`WorldDef::check`].
    ///
    /// ```
    /// # #[cfg(feature = "float")] {
    /// use umbra_physics::{World, WorldDef};
    ///
    /// let world: World<f64> = World::with_scalar(WorldDef::default())?;
    /// # assert_eq!(world.tick(), 0);
    /// # }
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn with_scalar(def: WorldDef<S>) -> Result<Self, Error> {
        S::new_world(def)
    }

    pub(crate) fn new_inner(def: WorldDef<S>) -> Result<Self, Error> {
        def.check()?;
        let def = WorldDef { time_step: def.time_step.checked()?, ..def };
        let mut bodies = Bodies::default();
        bodies.keep_last_acceleration(def.integrator == Integrator::PublishedVerlet);
        Ok(Self {
            def,
            tick: 0,
            counted: (Elapsed::ZERO, 0),
            bodies,
            fields: Arc::default(),
            colliders: Arc::default(),
            contacts: ContactSet::default(),
            joints: Arc::default(),
            joint_states: JointStates::default(),
            custom_forces: Arc::default(),
            applied: Applied::default(),
            targets: KinematicTargets::default(),
            random: Random::default(),
            blob: Vec::new(),
            factor_table: Arc::default(),
            plan: Plan::new(def.integrator, def.time_step),
            workspace: Workspace::default(),
            change_log: ChangeLog::default(),
            journal: Journal::default(),
        })
    }

    /// Simulates one tick.
    pub fn step(&mut self) -> StepReport<'_, S> {
        S::step(self);
        self.end_step();
        self.last_report()
    }

    /// Logs what the step changed.
    pub(crate) fn end_step(&mut self) {
        let report = &self.workspace.report;
        self.change_log.end(&report.faults, &report.fell_asleep, &report.woke);
    }

    /// Simulates one tick, with or without a probe.
    pub(crate) fn advance<'a>(&'a mut self, probe: Option<&'a mut Probe<'a, S>>) {
        self.tick = limits::tick_after(self.tick, 1);
        self.change_log.begin(self.tick, &self.bodies);
        timed!(self.workspace, survey, self.update());
        self.next_step(probe).step();
    }

    /// Computes the derived values that calls have made stale, of the bodies that the step may move: those that sleep may be touched.
    fn update(&mut self) {
        self.plan.update(self.def.integrator, self.def.time_step);
        let any_come = self.bodies.begin_step(&self.factor_table);
        let factors = &self.bodies.columns.factors;
        let moving = &factors[..self.bodies.moving()];
        // A copy of the world may have the same table: it is copied only if a row has to be made.
        if self.factor_table.is_stale(moving, any_come) {
            let WorldDef { gravity, linear_damping, angular_damping, integrator, .. } = self.def;
            let (spans, damps) = (&self.plan.spans[..integrator.spans().len()], integrator.damps());
            let world_factors = WorldFactors::new(gravity, [linear_damping, angular_damping], spans, damps);
            // A sleeping body has moved with these factors, or a call has put it to sleep before: then the table is stale.
            let indices = if self.bodies.any_asleep() { &factors[..] } else { moving };
            Arc::make_mut(&mut self.factor_table).update(&world_factors, indices);
        }
    }

    /// Everything a step works on.
    fn next_step<'a>(&'a mut self, probe: Option<&'a mut Probe<'a, S>>) -> Step<'a, S> {
        Step {
            bodies: &mut self.bodies,
            applied: &mut self.applied,
            targets: &mut self.targets,
            forces: Forces {
                fields: &self.fields,
                custom_forces: &self.custom_forces,
                colliders: &self.colliders,
                gravity: self.def.gravity,
            },
            contacts: Contacts {
                colliders: &self.colliders,
                contacts: &mut self.contacts,
                joints: &self.joints,
                joint_states: &mut self.joint_states,
                settings: &self.def.contacts,
            },
            settings: Settings {
                tick: self.tick,
                integrator: self.def.integrator,
                time_step: self.def.time_step,
                plan: &self.plan,
                factor_table: &self.factor_table,
                sleep_after: self.def.sleep_after,
            },
            probe,
            workspace: &mut self.workspace,
        }
    }

    /// The report of the last step. After [`step_back`](Self::step_back) it is empty.
    ///
    /// Copies in memory have it too: clones, snapshots, the worlds of a [`Rollback`]. A snapshot as bytes does not, and no hash covers it:
    /// a world that was read from bytes has an empty report until its next step. Rules of a game whose peers may join from bytes must read
    /// state instead, such as [`contacts`](Self::contacts) and [`sensor_overlaps`](Self::sensor_overlaps).
    #[must_use]
    pub fn last_report(&self) -> StepReport<'_, S> {
        StepReport {
            tick: self.tick,
            faults: &self.workspace.report.faults,
            fell_asleep: &self.change_log.reported.fell_asleep,
            woke: &self.change_log.reported.woken,
            removed: &self.change_log.reported.removed,
            added: &self.change_log.reported.added,
            placed: &self.change_log.reported.placed,
            contacts_ended: &self.workspace.report.contacts_ended,
            contacts_began: &self.workspace.report.contacts_began,
            hits: &self.workspace.report.hits,
            sensors_left: &self.workspace.report.sensors_left,
            sensors_entered: &self.workspace.report.sensors_entered,
            sensors_crossed: &self.workspace.report.sensors_crossed,
            joints_broke: &self.workspace.report.joints_broke,
            joint_loads: &self.workspace.report.joint_loads,
            joints_removed: &self.change_log.reported.removed_joints,
            applied: self.applied.done(),
            drag_outside: self.workspace.report.drag_outside,
        }
    }

    /// The number of steps made, at most [`limits::TICK`].
    #[must_use]
    pub fn tick(&self) -> u64 {
        self.tick
    }

    /// The definition, with later changes.
    #[must_use]
    pub fn def(&self) -> &WorldDef<S> {
        &self.def
    }
}

/// Steps each of these worlds, with the feature `parallel` on several threads; [`World::last_report`] has the report of each.
///
/// ```
/// use umbra_physics::{BodyDef, World, WorldDef, step_all, vec2};
///
/// let mut worlds: Vec<World> = Vec::new();
/// for gravity in [-10, -2] {
///     let mut world = World::new(WorldDef { gravity: vec2(0, gravity), ..WorldDef::default() })?;
///     world.add_body(BodyDef::dynamic())?;
///     worlds.push(world);
/// }
/// (0..60).for_each(|_| step_all(&mut worlds));
/// assert!(worlds.iter().all(|world| world.tick() == 60 && world.last_report().faults.is_empty()));
/// # Ok::<(), umbra_physics::Error>(())
/// ```
pub fn step_all<S: Scalar>(worlds: &mut [World<S>]) {
    #[cfg(feature = "parallel")]
    {
        use rayon::iter::{IntoParallelRefMutIterator as _, ParallelIterator as _};
        worlds.par_iter_mut().for_each(|world| _ = world.step());
    }
    #[cfg(not(feature = "parallel"))]
    worlds.iter_mut().for_each(|world| _ = world.step());
}
