//! The step. [`Step::step`] has its stages in order; each is in a file of its own, which begins with a list of its reads and writes.
//!
//! A *free* body, on which no force field can act, goes through all stages at once with its block ([`free`]). *Coupled* bodies
//! go stage by stage, together, as a field looks at many bodies at once ([`coupled`]). Which way a body goes changes no bit. With
//! `PublishedVerlet`, and in a step that is traced, all bodies are coupled.
//! A step is undone by the same ways with other lists of stages.
//!
//! - `targets`: before the stages, kinematic bodies get the velocity that leads to their target; after them they are placed on it.
//! - `applied`: forces become accelerations: the forces of the caller here, the forces of fields through `fields`.
//! - `free`: the pass of free bodies, a block at a time through all stages.
//! - `coupled`: the pass of coupled bodies, stage by stage: `damp`, `kick`, `drift`, `fields`.
//! - `bounds`: the allowed range, and ticks at rest.
//! - `contacts`: contacts and joints are found and solved, after the free flight of all bodies.
//! - `quarantine`: bodies outside the allowed range, or with another fault, are excluded.
//! - `sleep`: islands at rest fall asleep.
//! - `events`: contacts that began and ended, hits, and colliders that entered and left sensors.
//! - `workspace`: memory that steps use again.

mod applied;
mod bounds;
mod contacts;
mod coupled;
mod damp;
mod drift;
mod events;
mod fields;
mod free;
mod kick;
mod quarantine;
mod sleep;
mod targets;
mod workspace;

pub(crate) use bounds::find_out_of_bounds;
pub(crate) use contacts::Contacts;
pub use contacts::{JointBroke, JointLoad};
pub(crate) use workspace::{Report, Workspace};

use alloc::vec::Vec;

#[cfg(feature = "parallel")]
use crate::body::BLOCK;
use crate::body::{Acceleration, Block, Bodies, FactorTable, KinematicTargets, StepFactors};
use crate::collider::ColliderSet;
use crate::contact::ContactSet;
use crate::error::{Cause, Fault};
use crate::force::{Applied, CustomForces, FieldSet};
use crate::integrate::{AFTER_FLIGHT, Integrator, Plan, Schedule, Stage, StageKind};
use crate::joint::JointStates;
use crate::math::{TimeStep, Vec2};
use crate::scalar::Scalar;
use crate::timers::timed;
use coupled::FieldKinds;
use free::FreePass;
use workspace::Findings;

/// The parts of a world that a step works on.
pub(crate) struct Step<'a, S: Scalar> {
    pub(crate) bodies: &'a mut Bodies<S>,
    pub(crate) applied: &'a mut Applied<S>,
    pub(crate) targets: &'a mut KinematicTargets<S>,
    pub(crate) forces: Forces<'a, S>,
    pub(crate) contacts: Contacts<'a, S>,
    pub(crate) settings: Settings<'a, S>,
    /// Sees the bodies after each stage; all are coupled then.
    pub(crate) probe: Option<&'a mut Probe<'a, S>>,
    pub(crate) workspace: &'a mut Workspace<S>,
}

/// The force fields, and their inputs beside the bodies.
#[derive(Clone, Copy)]
pub(crate) struct Forces<'a, S: Scalar> {
    pub(crate) fields: &'a FieldSet<S>,
    pub(crate) custom_forces: &'a CustomForces<S>,
    /// The colliders, which displace fluids.
    pub(crate) colliders: &'a ColliderSet<S>,
    /// The gravity of the world.
    pub(crate) gravity: Vec2<S>,
}

/// The parameters of a step.
#[derive(Clone, Copy)]
pub(crate) struct Settings<'a, S: Scalar> {
    /// The tick after the step.
    pub(crate) tick: u64,
    pub(crate) integrator: Integrator,
    pub(crate) time_step: TimeStep,
    pub(crate) plan: &'a Plan<S>,
    pub(crate) factor_table: &'a FactorTable<S>,
    pub(crate) sleep_after: Option<u32>,
}

/// The function that is called after each stage of a step. Its contacts and joints are `None` while they are still as before the step.
pub(crate) type Probe<'a, S> = dyn FnMut(&Stage, &Bodies<S>, Option<(&ContactSet, &JointStates)>) + 'a;

/// The free bodies that a thread takes at least, so that handing them over is worth it: some tens of microseconds. Threads share
/// twice as many or more.
#[cfg(feature = "parallel")]
const SHARE: usize = 32 * BLOCK;

// The tests of threads have 8,200 bodies and must reach the parallel pass; they cannot import this constant. They are `THRONG` in
// `tests/promises/closure.rs` and `throng` in `umbra-oracles`.
#[cfg(feature = "parallel")]
const _: () = assert!(2 * SHARE <= 8_200);

/// The acceleration by the forces applied to a body, by its index in the columns; `None` if their sum does not fit.
type AppliedAcceleration<S> = (usize, Option<Acceleration<S>>);

/// Accelerations of some bodies, by their indices in the columns.
type Accelerations<S> = Vec<(usize, Acceleration<S>)>;

/// Values that are the same for all bodies over a step.
#[derive(Clone, Copy)]
struct Constants<'a, S: Scalar> {
    plan: &'a Plan<S>,
    rows: &'a [StepFactors<S>],
    /// In the order of the columns.
    applied: &'a [AppliedAcceleration<S>],
    sleep_after: Option<u32>,
    /// The speed below which a body that contacts push, or that floats, is at rest.
    sleep_speed: S,
    /// True if a body with a fault is restored to its state before the step. When a step is undone, all bodies are, or none.
    restores: bool,
    /// True if the speed of a body is limited.
    any_capped: bool,
}

impl<S: Scalar> Constants<'_, S> {
    /// Adds a fault for each body of a block whose applied forces do not fit.
    fn report_overloaded(&self, block: &Block<'_, S>, faults: &mut Vec<(usize, Cause)>) {
        let overloaded =
            applied::part_in(block, self.applied).iter().filter(|(_, acceleration)| acceleration.is_none());
        faults.extend(overloaded.map(|&(i, _)| (i, Cause::Force)));
    }
}

/// Shows a probe the world after a stage that follows the free flight.
fn show<S: Scalar>(
    probe: &mut Option<&mut Probe<'_, S>>,
    kind: StageKind,
    bodies: &Bodies<S>,
    contacts: &ContactSet,
    joints: &JointStates,
) {
    let stage = AFTER_FLIGHT.iter().find(|stage| stage.kind == kind);
    if let Some((probe, stage)) = probe.as_mut().zip(stage) {
        probe(stage, bodies, Some((contacts, joints)));
    }
}

impl<S: Scalar> Step<'_, S> {
    /// Moves the world on by a tick.
    pub(crate) fn step(mut self) {
        let Settings { plan, factor_table, sleep_after, integrator, .. } = self.settings;
        self.workspace.report.clear();
        timed!(self.workspace, survey, self.survey_contacts());
        // 1. Bodies change sets, free or coupled, if the fields that act on them changed.
        timed!(self.workspace, survey, self.part());
        // 2. Kinematic bodies get the velocity that leads to their target.
        let has_targets = self.targets.are_due(self.bodies);
        if has_targets {
            timed!(
                self.workspace,
                targets,
                targets::begin(self.bodies, self.targets, plan, &mut self.workspace.targets)
            );
        }
        // 3. Caches drop the entries of bodies that changed.
        let kinds = timed!(self.workspace, survey, self.begin());
        // 4. Applied forces become accelerations.
        let applied = timed!(self.workspace, survey, self.convert_applied());
        let constants = Constants {
            plan,
            rows: factor_table.rows(),
            applied: &applied,
            sleep_after,
            sleep_speed: self.contacts.settings.sleep_speed,
            restores: true,
            any_capped: factor_table.any_capped(),
        };
        if let Some(contacts) = &mut self.workspace.contacts {
            timed!(self.workspace, survey, contacts.begin(self.bodies));
        }
        // 5. The stages of the integrator: damp, kick, drift, fields. Then caps of speeds, the allowed range, ticks at rest.
        self.run_stages(&constants, integrator.schedule(), kinds);
        // 6. Kinematic bodies arrive at their targets, to the bit.
        if has_targets {
            let Workspace { targets: workspace, findings, .. } = &mut *self.workspace;
            let tick = self.settings.tick;
            timed!(
                self.workspace,
                targets,
                targets::finish(self.bodies, self.targets, tick, workspace, &mut findings.faults)
            );
        }
        // 7. Colliders touch: impulses change the free flight of the stages.
        if !self.are_contacts_idle() {
            self.run_contacts(&constants, integrator.schedule());
        } else if self.probe.is_some() {
            AFTER_FLIGHT.iter().filter(|stage| stage.kind != StageKind::Clear).for_each(|stage| self.show(stage.kind));
        }
        // 8. The applied forces have acted.
        self.applied.finish();
        self.show(StageKind::Clear);
        // 9. Bodies with a fault are quarantined; islands at rest fall asleep; events of contacts and sensors are reported.
        timed!(self.workspace, finish, {
            quarantine::find(self.bodies, self.workspace);
            if let Some(ticks) = sleep_after {
                sleep::find(self.bodies, self.forces.fields, &self.contacts, ticks, kinds, self.workspace);
            }
            quarantine::take_out(self.bodies, &self.workspace.report);
            self.drop_contacts_of_quarantined();
        });
        timed!(self.workspace, events, self.report_events());
        timed!(self.workspace, finish, self.put_contacts_to_sleep());
        self.workspace.applied = applied;
    }

    /// Shows the probe the world after a stage that follows the free flight.
    fn show(&mut self, kind: StageKind) {
        show(&mut self.probe, kind, self.bodies, self.contacts.contacts, self.contacts.joint_states);
    }

    /// Undoes a tick by an [inverse](Integrator::inverse_schedule) schedule. Forces that were applied over it stay applied.
    ///
    /// # Errors
    /// The first fault on the way back, in the order of the handles; then all bodies are as they were.
    pub(crate) fn step_back(mut self, schedule: Schedule) -> Result<(), Fault> {
        let Settings { plan, factor_table, integrator, .. } = self.settings;
        self.part();
        let kinds = self.begin();
        let applied = self.convert_applied();
        let reversed = plan.reversed();
        let rows = factor_table.rows();
        let back = Constants {
            plan: &reversed,
            rows,
            applied: &applied,
            sleep_after: None,
            sleep_speed: S::ZERO,
            restores: false,
            any_capped: false,
        };
        self.run_stages(&back, schedule, kinds);
        let fault = quarantine::first(self.bodies, &self.workspace.findings);
        if fault.is_some() {
            // A free body has no backup: it goes the same way forwards again, to the bits it came from. Only gravity and
            // applied forces act on it, and a force that was left out as too large is left out again.
            self.run_free(&Constants { plan, ..back }, integrator.schedule());
            let coupled = self.coupled();
            self.workspace.coupled.restore_all(&mut self.bodies.block(coupled));
            self.workspace.drop_cached();
        }
        self.workspace.applied = applied;
        fault.map_or(Ok(()), Err)
    }

    /// Parts the bodies into free and coupled ones.
    fn part(&mut self) {
        let fields = self.forces.fields;
        if fields.len() == 0 {
            self.bodies.free_all();
        } else {
            self.bodies.part(|| fields.coupling_groups(), |body| fields.is_attached(body));
        }
    }

    /// Makes the workspace ready, and says which kinds of fields act on coupled bodies.
    fn begin(&mut self) -> FieldKinds {
        let coupled = self.coupled();
        self.workspace.begin(self.bodies, self.forces.fields);
        if coupled.is_empty() { FieldKinds::default() } else { FieldKinds::of(self.forces, self.bodies) }
    }

    fn convert_applied(&mut self) -> Vec<AppliedAcceleration<S>> {
        let mut accelerations = core::mem::take(&mut self.workspace.applied);
        applied::convert(self.applied, self.bodies, &mut accelerations);
        accelerations
    }

    /// The indices of the bodies that go stage by stage.
    fn coupled(&self) -> core::ops::Range<usize> {
        let all = self.settings.integrator == Integrator::PublishedVerlet || self.probe.is_some();
        (if all { 0 } else { self.bodies.free_count() })..self.bodies.moving()
    }

    fn run_stages(&mut self, constants: &Constants<'_, S>, schedule: Schedule, kinds: FieldKinds) {
        timed!(self.workspace, free, self.run_free(constants, schedule));
        let indices = self.coupled();
        if !indices.is_empty() || self.probe.is_some() {
            let Self { forces, settings, .. } = *self;
            let integrator = settings.integrator;
            let pass =
                coupled::Coupled { bodies: self.bodies, indices, forces, constants: *constants, integrator, kinds };
            coupled::run(pass, schedule.coupled, self.workspace, self.probe.as_deref_mut());
        }
    }

    /// Takes the bodies at some indices through the stages, as coupled bodies, unseen by the probe.
    fn run_coupled(&mut self, indices: core::ops::Range<usize>, constants: &Constants<'_, S>, schedule: Schedule) {
        let Self { forces, settings, .. } = *self;
        let integrator = settings.integrator;
        let kinds = FieldKinds::of(forces, self.bodies);
        let pass = coupled::Coupled { bodies: self.bodies, indices, forces, constants: *constants, integrator, kinds };
        coupled::run(pass, schedule.coupled, self.workspace, None);
    }

    fn run_free(&mut self, constants: &Constants<'_, S>, schedule: Schedule) {
        let count = self.coupled().start;
        let pass = FreePass { constants: *constants, stages: schedule.free };
        let Workspace { free, findings, .. } = &mut *self.workspace;
        free::run(&pass, self.bodies, count, free, findings);
    }
}
