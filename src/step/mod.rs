//! The step: walks the integrator's stages, then takes out what left the envelope and lets sleep what is at rest.
//!
//! Stages see columns and a context, never the world.

mod finish;
mod kick;

pub(crate) use finish::island_roots;

use alloc::vec::Vec;

use crate::body::{Acceleration, Bodies, Motion, Tunings};
use crate::error::{Cause, Fault};
use crate::force::{Applied, FieldSet, Laws, Load, outer_drag, resist};
use crate::handle::BodyId;
use crate::integrate::{Integrator, Plan, Stage, Verb, damp, drift, kick_gravity};
use crate::math::Vec2;
use crate::scalar::{Accumulator, Factor, Scalar};

/// What a step works on.
pub(crate) struct Context<'a, S: Scalar> {
    pub(crate) bodies: &'a mut Bodies<S>,
    pub(crate) tunings: &'a Tunings<S>,
    pub(crate) fields: &'a FieldSet<S>,
    pub(crate) laws: &'a Laws<S>,
    pub(crate) applied: &'a mut Applied<S>,
    pub(crate) plan: &'a Plan<S>,
    pub(crate) integrator: Integrator,
    pub(crate) sleep_after: Option<u32>,
    pub(crate) scratch: &'a mut Scratch<S>,
}

/// Memory that a step uses again, and what the last one reported. None of it is state.
#[derive(Debug)]
pub(crate) struct Scratch<S: Scalar> {
    /// The bodies that move, as they were before the step.
    before: Motion<S>,
    loads: Vec<Load<S>>,
    /// What the fields of position do at the positions now, if `fields_hold`.
    fields: Vec<Acceleration<S>>,
    /// Dropped by whatever changes a body or a field: a step that finds it false has the same bits.
    pub(crate) fields_hold: bool,
    /// What the fields of velocity did in the kick before.
    resisting: Vec<Acceleration<S>>,
    spare: Vec<Acceleration<S>>,
    /// What the forces applied this tick do, by index in the columns.
    pushed: Vec<(usize, Acceleration<S>)>,
    /// Bodies whose drag acts around the whole step.
    outside: Vec<bool>,
    stage_faults: Vec<(usize, Cause)>,
    pub(crate) faults: Vec<Fault>,
    pub(crate) fell_asleep: Vec<BodyId>,
    pub(crate) drag_outside: u32,
    /// For islands of springs.
    links: Vec<u32>,
    kept_up: Vec<bool>,
}

clone_by_field!(Scratch {
    before,
    loads,
    fields,
    fields_hold,
    resisting,
    spare,
    pushed,
    outside,
    stage_faults,
    faults,
    fell_asleep,
    drag_outside,
    links,
    kept_up
});

impl<S: Scalar> Default for Scratch<S> {
    fn default() -> Self {
        Self {
            before: Motion::default(),
            loads: Vec::new(),
            fields: Vec::new(),
            fields_hold: false,
            resisting: Vec::new(),
            spare: Vec::new(),
            pushed: Vec::new(),
            outside: Vec::new(),
            stage_faults: Vec::new(),
            faults: Vec::new(),
            fell_asleep: Vec::new(),
            drag_outside: 0,
            links: Vec::new(),
            kept_up: Vec::new(),
        }
    }
}

/// What a scene has; a stage of a kind it lacks is passed over.
#[derive(Clone, Copy, Debug, Default)]
struct Has {
    position: bool,
    velocity: bool,
    drag: bool,
    gravity: bool,
    damping: bool,
}

impl<S: Scalar> Context<'_, S> {
    /// One tick.
    pub(crate) fn step(mut self) {
        let moving = self.bodies.moving();
        self.scratch.faults.clear();
        self.scratch.stage_faults.clear();
        self.scratch.fell_asleep.clear();
        self.scratch.drag_outside = 0;
        self.scratch.before.copy_first(&self.bodies.columns.motion, moving);
        let has = self.has();
        self.take_applied();
        if has.drag && self.integrator == Integrator::Yoshida4 {
            self.find_stiff_drag(has);
            self.resist_outside(false);
            self.name_faults();
        }
        for stage in self.integrator.stages() {
            self.run(stage, has);
            self.name_faults();
        }
        if self.scratch.drag_outside > 0 {
            self.resist_outside(true);
            self.name_faults();
        }
        self.finish();
    }

    fn has(&self) -> Has {
        use crate::force::{Dependence, Law};
        let (gravity, damping) = (self.tunings.any_gravity(), self.tunings.any_damped());
        let mut has = Has { gravity, damping, ..Has::default() };
        for (_, field) in self.fields.iter() {
            let depends_on = field.depends_on(self.laws);
            match field.law {
                Law::Drag { .. } => has.drag = true,
                Law::Spring { .. } => {
                    has.position = true;
                    has.velocity |= depends_on == Dependence::Velocity;
                }
                _ if depends_on == Dependence::Velocity => has.velocity = true,
                _ => has.position = true,
            }
        }
        has
    }

    fn run(&mut self, stage: &Stage, has: Has) {
        let moving = self.bodies.moving();
        let timing = self.plan.timing[stage.span];
        match stage.verb {
            Verb::Damp if stage.closing => {
                self.resist_inside(stage, has);
                self.damp(stage, has);
            }
            Verb::Damp => {
                self.damp(stage, has);
                self.resist_inside(stage, has);
            }
            Verb::Kick => self.kick(stage, has),
            Verb::Drift => {
                drift(&mut self.bodies.columns.motion, moving, &timing);
                if self.integrator == Integrator::PublishedVerlet {
                    self.drift_by_acceleration();
                }
                self.scratch.fields_hold = false;
            }
            Verb::Fields => {
                if has.position {
                    self.evaluate_fields();
                }
                if has.velocity && self.integrator == Integrator::ExplicitEuler {
                    self.evaluate_resisting();
                }
            }
            Verb::Clear => self.applied.finish(self.bodies),
        }
    }

    fn damp(&mut self, stage: &Stage, has: Has) {
        if !has.damping {
            return;
        }
        let moving = self.bodies.moving();
        let columns = &mut self.bodies.columns;
        let tuning = &columns.tuning[..moving];
        damp(&mut columns.motion, tuning, self.tunings.rows(), stage.span, &mut self.scratch.stage_faults);
    }

    fn fall(&mut self, stage: &Stage, has: Has) {
        if has.gravity {
            let moving = self.bodies.moving();
            let columns = &mut self.bodies.columns;
            kick_gravity(&mut columns.motion, &columns.tuning[..moving], self.tunings.rows(), stage.span);
        }
    }

    fn resist_inside(&mut self, stage: &Stage, has: Has) {
        if !has.drag {
            return;
        }
        let timing = self.plan.timing[stage.span];
        let Scratch { outside, drag_outside, stage_faults, .. } = &mut *self.scratch;
        let only = |i: usize| *drag_outside == 0 || !outside[i];
        resist(self.fields, self.bodies, (timing.seconds, timing.negative), stage.closing, only, stage_faults);
    }

    /// Finds the bodies whose drag is to act around the whole step, judged by what gravity, the forces applied and the
    /// fields of position here may add to their speed in twice the time step.
    fn find_stiff_drag(&mut self, has: Has) {
        if has.position && !self.scratch.fields_hold {
            self.evaluate_fields();
        }
        let Scratch { fields, pushed, outside, drag_outside, .. } = &mut *self.scratch;
        let size = |a: Vec2<S::Wide>| S::Factor::from_wide(a.x).plus(S::Factor::from_wide(a.y));
        let twice = self.plan.whole.plus(self.plan.whole);
        let rows = self.tunings.rows();
        let gain = |i: usize| {
            let gravity = size(rows[self.bodies.columns.tuning[i] as usize].gravity);
            let field = if has.position { size(fields[i].linear) } else { S::Factor::ZERO };
            let applied = pushed.binary_search_by_key(&i, |(at, _)| *at);
            let applied = applied.map_or(S::Factor::ZERO, |at| size(pushed[at].1.linear));
            gravity.plus(field).plus(applied).times(twice)
        };
        *drag_outside = outer_drag(self.fields, self.bodies, self.plan.whole, gain, outside);
    }

    fn resist_outside(&mut self, closing: bool) {
        let Scratch { outside, stage_faults, .. } = &mut *self.scratch;
        resist(self.fields, self.bodies, (self.plan.half, false), closing, |i| outside[i], stage_faults);
    }

    /// PublishedVerlet's x += ½·a·dt² beside x += v·dt.
    fn drift_by_acceleration(&mut self) {
        let half_square = self.plan.half_square;
        let moving = self.bodies.moving();
        let Motion { position, angle, last, .. } = &mut self.bodies.columns.motion;
        for (i, acceleration) in last[..moving].iter().enumerate() {
            let way = |a: S::Wide| S::kick(a, half_square);
            match (acceleration.linear.try_map(way), way(acceleration.angular)) {
                (Some(linear), Some(angular)) => {
                    position[i] = Vec2::new(position[i].x.plus(linear.x), position[i].y.plus(linear.y));
                    angle[i] = crate::scalar::Angle::turned(angle[i], angular);
                }
                _ => self.scratch.stage_faults.push((i, Cause::Velocity)),
            }
        }
    }

    /// Gives the faults of a stage the names of their bodies.
    fn name_faults(&mut self) {
        let Scratch { stage_faults, faults, .. } = &mut *self.scratch;
        faults.extend(stage_faults.drain(..).map(|(i, cause)| Fault { body: self.bodies.id(i), cause }));
    }
}
