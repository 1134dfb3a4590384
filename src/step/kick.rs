//! The kick stage: forces to velocities.

use alloc::vec::Vec;

use super::{Context, Has, Scratch};
use crate::body::{Acceleration, Bodies, MassProperties};
use crate::error::Cause;
use crate::force::{Dependence, Load, Scene, accumulate};
use crate::integrate::{Integrator, Stage, kick_by, sum};
use crate::math::Vec2;
use crate::scalar::{Scalar, Sum, Wide};

/// a = Σ accelerations + Σ F / m, α = Σ τ / I; `None` if a sum does not fit.
fn acceleration<S: Scalar>(load: &Load<S>, properties: &MassProperties<S>) -> Option<Acceleration<S>> {
    let component = |a: S::Sum, f: S::Sum| {
        let (a, f) = (a.total()?, f.total()?);
        if f == S::Wide::default() { Some(a) } else { a.plus(f.times(properties.inverse_mass)?) }
    };
    let torque = load.torque.total()?;
    let turns = torque != S::Wide::default();
    Some(Acceleration {
        linear: Vec2::new(component(load.acceleration.x, load.force.x)?, component(load.acceleration.y, load.force.y)?),
        angular: if turns { torque.times(properties.inverse_inertia)? } else { torque },
    })
}

impl<S: Scalar> Context<'_, S> {
    /// The accelerations from what was applied this tick, constant over it.
    pub(super) fn take_applied(&mut self) {
        let Scratch { pushed, stage_faults, .. } = &mut *self.scratch;
        pushed.clear();
        for row in self.applied.rows() {
            let Ok(i) = self.bodies.find(row.body) else { continue };
            let load = Load { acceleration: Vec2::default(), force: row.force, torque: row.torque };
            match acceleration(&load, &self.bodies.columns.card[i].properties) {
                Some(acceleration) => pushed.push((i, acceleration)),
                None => stage_faults.push((i, Cause::Force)),
            }
        }
        // In the order of the columns, whatever the order of the calls.
        pushed.sort_unstable_by_key(|(i, _)| *i);
        self.name_faults();
    }

    /// What the fields of position do here and now.
    pub(super) fn evaluate_fields(&mut self) {
        let mut fields = core::mem::take(&mut self.scratch.fields);
        self.evaluate(Dependence::Position, &mut fields);
        self.scratch.fields = fields;
        self.scratch.fields_hold = true;
        self.name_faults();
    }

    /// What the fields of velocity do here and now.
    pub(super) fn evaluate_resisting(&mut self) {
        let mut resisting = core::mem::take(&mut self.scratch.resisting);
        self.evaluate(Dependence::Velocity, &mut resisting);
        self.scratch.resisting = resisting;
    }

    fn evaluate(&mut self, pass: Dependence, into: &mut Vec<Acceleration<S>>) {
        let moving = self.bodies.moving();
        let scratch = &mut *self.scratch;
        scratch.loads.clear();
        scratch.loads.resize(moving, Load::default());
        let scene = Scene { bodies: self.bodies, fields: self.fields, laws: self.laws };
        accumulate(scene, pass, &mut scratch.loads, &mut scratch.stage_faults);
        into.clear();
        for (i, load) in scratch.loads.iter().enumerate() {
            into.push(acceleration(load, &self.bodies.columns.card[i].properties).unwrap_or_else(|| {
                scratch.stage_faults.push((i, Cause::Force));
                Acceleration::default()
            }));
        }
    }

    pub(super) fn kick(&mut self, stage: &Stage, has: Has) {
        // ExplicitEuler has moved on since its fields were evaluated, and means them as they were.
        let moved_on = self.integrator == Integrator::ExplicitEuler;
        if has.position && !self.scratch.fields_hold && !moved_on {
            self.evaluate_fields();
        }
        if has.velocity && !moved_on {
            self.evaluate_resisting();
        }
        let resisting = core::mem::take(&mut self.scratch.resisting);
        if self.integrator == Integrator::PublishedVerlet {
            self.kick_by_mean(has, &resisting);
        } else {
            self.fall(stage, has);
            let timing = self.plan.timing[stage.span];
            let Scratch { fields, pushed, stage_faults, .. } = &mut *self.scratch;
            let mut kick = |bodies: &mut Bodies<S>, i: usize, a: &Acceleration<S>| {
                let done = kick_by(&mut bodies.columns.motion, i, a, timing.seconds, timing.negative);
                if let Err(cause) = done {
                    stage_faults.push((i, cause));
                }
            };
            for (i, acceleration) in pushed.iter() {
                kick(self.bodies, *i, acceleration);
            }
            if has.position {
                for (i, acceleration) in fields.iter().enumerate() {
                    kick(self.bodies, i, acceleration);
                }
            }
            if has.velocity {
                for (i, acceleration) in resisting.iter().enumerate() {
                    kick(self.bodies, i, acceleration);
                }
                if stage.closing {
                    self.correct(stage, &resisting);
                }
            }
        }
        self.scratch.resisting = resisting;
    }

    /// The second evaluation of the forces of velocity: the closing half kick is the implicit one, v' = v + ½h·a(x', v'),
    /// to within O(h³). The first, explicit half takes its value at the old velocity, so that the two together are the
    /// trapezoidal rule, of order 2.
    fn correct(&mut self, stage: &Stage, first: &[Acceleration<S>]) {
        let timing = self.plan.timing[stage.span];
        let mut second = core::mem::take(&mut self.scratch.spare);
        self.evaluate(Dependence::Velocity, &mut second);
        for (i, (first, second)) in first.iter().zip(&second).enumerate() {
            // The first kick is taken back to the bit; one that was left out for its size stays out.
            let motion = &mut self.bodies.columns.motion;
            let done = kick_by(motion, i, first, timing.seconds, !timing.negative)
                .and_then(|()| kick_by(motion, i, second, timing.seconds, timing.negative));
            if let Err(cause) = done {
                self.scratch.stage_faults.push((i, cause));
            }
        }
        self.scratch.spare = second;
    }

    /// PublishedVerlet's v += (a + a')/2·dt; the new acceleration is kept for the next step.
    fn kick_by_mean(&mut self, has: Has, resisting: &[Acceleration<S>]) {
        let moving = self.bodies.moving();
        let half = self.plan.half;
        let Scratch { fields, pushed, stage_faults, .. } = &mut *self.scratch;
        let mut pushed = pushed.iter().peekable();
        for i in 0..moving {
            let columns = &mut self.bodies.columns;
            let row = &self.tunings.rows()[columns.tuning[i] as usize];
            let gravity = Acceleration { linear: row.gravity, angular: S::Wide::default() };
            let applied = pushed.next_if(|(at, _)| *at == i).map(|(_, acceleration)| acceleration);
            let parts = [
                if has.position { fields.get(i) } else { None },
                if has.velocity { resisting.get(i) } else { None },
                applied,
            ];
            let total = parts.into_iter().flatten().try_fold(gravity, |total, part| sum(&total, part));
            let last = columns.motion.last[i];
            let kicked = total.and_then(|total| {
                columns.motion.last[i] = total;
                sum(&last, &total)
            });
            let done = match kicked {
                Some(twice) => kick_by(&mut columns.motion, i, &twice, half, false),
                None => Err(Cause::Force),
            };
            if let Err(cause) = done {
                stage_faults.push((i, cause));
            }
        }
    }
}
