//! The step: takes the bodies through the integrator's stages, then takes out what left the envelope and lets sleep what
//! is at rest.
//!
//! Stages see columns and a context, never the world. Bodies that no field reaches march through all stages a block at a
//! time ([`march`]); those that one may reach are *engaged*: they go stage by stage, together, because fields look at
//! many bodies at once. Which way a body goes changes no bit. A step is undone by the same ways with other stages.

mod engaged;
mod finish;
mod kick;
mod march;
mod targets;
mod timers;

pub(crate) use march::find_strays;
#[cfg(feature = "timers")]
pub use timers::Timers;

use alloc::vec::Vec;

use crate::body::{Acceleration, BLOCK, Bodies, FactorTable, KinematicTargets, Motion, Velocities};
use crate::error::Fault;
use crate::force::{Applied, CustomForces, Dependence, Directions, End, FieldKind, FieldSet, Loads};
use crate::integrate::{Integrator, Plan, Stage};
use crate::scalar::Scalar;
use crate::slots::BodyId;
use march::{Calm, Found, March, Pushed};
use timers::timed;

/// What a step works on.
pub(crate) struct Context<'a, S: Scalar> {
    pub(crate) bodies: &'a mut Bodies<S>,
    pub(crate) factor_table: &'a FactorTable<S>,
    pub(crate) fields: &'a FieldSet<S>,
    pub(crate) custom_forces: &'a CustomForces<S>,
    pub(crate) applied: &'a mut Applied<S>,
    pub(crate) targets: &'a mut KinematicTargets<S>,
    /// After the step.
    pub(crate) tick: u64,
    pub(crate) plan: &'a Plan<S>,
    pub(crate) integrator: Integrator,
    pub(crate) sleep_after: Option<u32>,
    /// Sees the bodies after each stage; all are engaged then.
    pub(crate) probe: Option<&'a mut Probe<'a, S>>,
    pub(crate) scratch: &'a mut Scratch<S>,
}

/// What looks on while a step goes through its stages.
pub(crate) type Probe<'a, S> = dyn FnMut(&Stage, &Bodies<S>) + 'a;

/// Fewer bodies than this are done sooner by one core.
#[cfg(feature = "parallel")]
pub(crate) const MANY: usize = 64 * BLOCK;

/// Fewer than `THRONG` in `tests/promises/closure.rs` and in `umbra-oracles`, where threads are to be used: they cannot see `MANY`.
#[cfg(feature = "parallel")]
const _: () = assert!(MANY <= 8_200);

/// Accelerations of some bodies, by their indices in the columns.
type Accelerations<S> = Vec<(usize, Acceleration<S>)>;

/// Memory that a step uses again, and what the last one reported. None of it is state.
#[derive(Debug)]
pub(crate) struct Scratch<S: Scalar> {
    /// Whether a field may reach a body of a block, by the number of the block; none at all if it is empty.
    engaged: Vec<bool>,
    /// By the number of the block.
    calm: Vec<Calm>,
    /// The engaged blocks as they were before the step; or the first holds one block after the other.
    frames: Vec<Motion<S>>,
    loads: Loads<S>,
    /// Those of the angles now.
    directions: Directions<S>,
    /// What the fields of position do at the positions now, if `fields_hold`.
    fields: Accelerations<S>,
    fields_hold: bool,
    /// What the fields of velocity did in the kick before.
    resisting: Accelerations<S>,
    spare: Accelerations<S>,
    /// What the forces applied this tick do, in the order of the indices.
    pushed: Vec<Pushed<S>>,
    /// For `PublishedVerlet`, by index: all accelerations of a body, if their sum fits.
    total: Vec<Option<Acceleration<S>>>,
    /// What a step may add to the speed of a body, by index.
    gain: Vec<S::Factor>,
    /// Bodies whose drag acts around the whole step.
    outside: Vec<bool>,
    /// The velocities, before the step, of bodies whose goals are too far off, by their indices.
    stranded: Vec<(usize, Velocities<S>)>,
    found: Found,
    pub(crate) faults: Vec<Fault>,
    pub(crate) fell_asleep: Vec<BodyId>,
    pub(crate) drag_outside: u32,
    /// For islands of springs.
    links: Vec<u32>,
    kept_up: Vec<bool>,
    #[cfg(feature = "timers")]
    pub(crate) timers: Timers,
}

impl<S: Scalar> Default for Scratch<S> {
    fn default() -> Self {
        Self {
            engaged: Vec::new(),
            calm: Vec::new(),
            frames: Vec::new(),
            loads: Loads::default(),
            directions: Directions::<S>::default(),
            fields: Vec::new(),
            fields_hold: false,
            resisting: Vec::new(),
            spare: Vec::new(),
            pushed: Vec::new(),
            total: Vec::new(),
            gain: Vec::new(),
            outside: Vec::new(),
            stranded: Vec::new(),
            found: Found::default(),
            faults: Vec::new(),
            fell_asleep: Vec::new(),
            drag_outside: 0,
            links: Vec::new(),
            kept_up: Vec::new(),
            #[cfg(feature = "timers")]
            timers: Timers::default(),
        }
    }
}

impl<S: Scalar> Scratch<S> {
    /// Drops what is cached. Whatever changes a body or a field does so; a step that finds nothing has the same bits.
    pub(crate) fn forget(&mut self) {
        self.forget_places();
        self.calm.clear();
    }

    /// As `clone_from`, with what is cached: for a copy of the world that `source` belongs to.
    pub(crate) fn clone_cached_from(&mut self, source: &Self) {
        self.clone_from(source);
        self.calm.clone_from(&source.calm);
        self.fields_hold = source.fields_hold;
        if source.fields_hold {
            self.fields.clone_from(&source.fields);
        }
    }

    /// Drops what was reported of the last step.
    pub(crate) fn forget_report(&mut self) {
        self.faults.clear();
        self.fell_asleep.clear();
        self.drag_outside = 0;
    }

    /// Drops what goes with the positions and angles of engaged bodies.
    fn forget_places(&mut self) {
        self.fields_hold = false;
        self.directions.clear();
    }
}

/// The reports alone: a step makes the rest anew.
impl<S: Scalar> Clone for Scratch<S> {
    fn clone(&self) -> Self {
        let mut copy = Self::default();
        copy.clone_from(self);
        copy
    }

    fn clone_from(&mut self, source: &Self) {
        self.forget();
        self.faults.clone_from(&source.faults);
        self.fell_asleep.clone_from(&source.fell_asleep);
        self.drag_outside = source.drag_outside;
    }
}

/// What the fields of a scene are; a stage of a kind it lacks is passed over.
#[derive(Clone, Copy, Debug, Default)]
struct Has {
    position: bool,
    velocity: bool,
    drag: bool,
    /// Attractors that a movable body carries.
    wanderers: bool,
}

impl<S: Scalar> Context<'_, S> {
    /// One tick.
    pub(crate) fn step(mut self) {
        self.scratch.forget_report();
        let has = self.open();
        let travels = self.targets.are_due(self.bodies);
        if travels {
            self.begin_targets();
        }
        let pushed = timed!(self.scratch, survey, self.take_applied());
        let march = March {
            stages: self.integrator.stages(),
            plan: self.plan,
            rows: self.factor_table.rows(),
            pushed: &pushed,
            sleep_after: self.sleep_after,
            restores: true,
            caps: self.factor_table.any_capped(),
        };
        self.run_all(&march, has);
        self.scratch.pushed = pushed;
        if travels {
            self.finish_targets();
        }
        // The last stage of each list, for all bodies at once.
        self.applied.finish();
        timed!(self.scratch, finish, self.finish(has));
    }

    /// Undoes a tick by these [`inverse`](Integrator::inverse) stages. What was applied over it stays applied.
    ///
    /// # Errors
    /// The first fault on the way back, in the order of the handles; then all bodies are as they were.
    pub(crate) fn step_back(mut self, stages: &'static [Stage]) -> Result<(), Fault> {
        let has = self.open();
        let pushed = timed!(self.scratch, survey, self.take_applied());
        let reversed = self.plan.reversed();
        let back = March {
            stages,
            plan: &reversed,
            rows: self.factor_table.rows(),
            pushed: &pushed,
            sleep_after: None,
            restores: false,
            caps: false,
        };
        self.run_all(&back, has);
        let fault = self.first_fault();
        if fault.is_some() {
            // Of a free body there is no copy: it goes the same way again, there, to the bits it came from. Nothing but
            // gravity and what was applied acts on it, and whatever was left out as too large is so again.
            self.march(&March { stages: self.integrator.stages(), plan: self.plan, ..back });
            self.restore_engaged();
            self.scratch.forget();
        }
        self.scratch.pushed = pushed;
        fault.map_or(Ok(()), Err)
    }

    fn open(&mut self) -> Has {
        self.scratch.found.faults.clear();
        self.scratch.found.ready = false;
        #[cfg(feature = "timers")]
        {
            self.scratch.timers.steps += 1;
        }
        timed!(self.scratch, survey, self.survey())
    }

    fn run_all(&mut self, march: &March<'_, S>, has: Has) {
        timed!(self.scratch, march, self.march(march));
        if !self.scratch.engaged.is_empty() || self.probe.is_some() {
            self.run_engaged(march, has);
        }
    }

    fn first_fault(&self) -> Option<Fault> {
        let named = self.scratch.found.faults.iter().map(|&(i, cause)| Fault { body: self.bodies.id(i), cause });
        // The first of those that are equal: the first cause of a body.
        named.min_by_key(|fault| fault.body)
    }

    /// Says what fields there are, and marks the blocks with bodies that one may reach.
    fn survey(&mut self) -> Has {
        let moving = self.bodies.moving();
        let engaged = &mut self.scratch.engaged;
        engaged.clear();
        let mut has = Has::default();
        let all = self.integrator == Integrator::PublishedVerlet || self.probe.is_some();
        if all || !self.fields.is_empty() {
            engaged.resize(moving.div_ceil(BLOCK), all);
        }
        for (_, field) in self.fields.iter() {
            let depends_on = field.depends_on(self.custom_forces);
            match &field.kind {
                FieldKind::Drag { .. } => has.drag = true,
                FieldKind::Spring { .. } => {
                    has.position = true;
                    has.velocity |= depends_on == Dependence::Velocity;
                }
                _ if depends_on == Dependence::Velocity => has.velocity = true,
                _ => has.position = true,
            }
            match &field.kind {
                // Only the bodies it is attached to.
                FieldKind::Spring { .. } | FieldKind::Thrust { .. } => {
                    for i in field.bodies().filter_map(|body| self.bodies.find(body).ok()).filter(|&i| i < moving) {
                        engaged[i / BLOCK] = true;
                    }
                }
                law => {
                    engaged.fill(true);
                    if let FieldKind::Attractor { centre: End::Body(at), .. } = law {
                        has.wanderers |= self.bodies.find(at.body).is_ok_and(|i| finish::wanders(self.bodies, i));
                    }
                }
            }
        }
        has
    }

    /// Takes the bodies that no field reaches through the step.
    fn march(&mut self, march: &March<'_, S>) {
        let Scratch { engaged, calm, frames, found, .. } = &mut *self.scratch;
        calm.resize(self.bodies.moving().div_ceil(BLOCK), Calm::default());
        if frames.is_empty() {
            frames.push(Motion::default());
        }
        // Now, not in the step in which a block first needs it.
        frames[0].make_room(BLOCK.min(self.bodies.moving()));
        #[cfg(feature = "parallel")]
        if self.bodies.moving() >= MANY {
            return march.run_side_by_side(self.bodies.all_moving(), calm, engaged, found);
        }
        march.run(self.bodies.all_moving(), calm, engaged, &mut frames[0], found);
    }
}
