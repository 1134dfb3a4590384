//! The kick stage: forces to velocities.

use alloc::vec::Vec;

use super::march::{March, Pushed, accelerations};
use super::{Accelerations, Context, Has, Scratch};
use crate::body::{Acceleration, MassProperties};
use crate::error::Cause;
use crate::force::{Dependence, Load, Scene, accumulate};
use crate::integrate::{Stage, kick_by, sum};
use crate::math::Vec2;
use crate::scalar::{Factor, Scalar, Sum, Wide};

/// a = Σ accelerations + Σ F / m, α = Σ τ / I, none along a locked axis; `None` if a sum does not fit. *Domain* the body is
/// dynamic.
fn acceleration<S: Scalar>(load: &Load<S>, mass: &MassProperties<S>) -> Option<Acceleration<S>> {
    let component = |a: S::Sum, f: S::Sum, inverse_mass: S::Factor| {
        // A sum along a locked axis has no effect and may be of any size.
        if inverse_mass.is_zero() {
            return Some(S::Wide::default());
        }
        let (a, f) = (a.total()?, f.total()?);
        if f == S::Wide::default() { Some(a) } else { a.plus(f.times(inverse_mass)?) }
    };
    // A torque on a body of infinite inertia has to fit.
    let torque = if mass.locks.rotation { S::Wide::default() } else { load.torque.total()? };
    let turns = torque != S::Wide::default();
    Some(Acceleration {
        linear: Vec2::new(
            component(load.acceleration.x, load.force.x, mass.axis_inverse_mass.x)?,
            component(load.acceleration.y, load.force.y, mass.axis_inverse_mass.y)?,
        ),
        angular: if turns { torque.times(mass.inverse_inertia)? } else { torque },
    })
}

impl<S: Scalar> Context<'_, S> {
    /// The accelerations from what was applied this tick, constant over it; in the order of the columns, whatever the order
    /// of the calls. The list is lent by the scratch.
    pub(super) fn take_applied(&mut self) -> Vec<Pushed<S>> {
        let mut pushed = core::mem::take(&mut self.scratch.pushed);
        pushed.clear();
        for row in self.applied.rows() {
            let Ok(i) = self.bodies.find(row.body) else { continue };
            let load = Load { acceleration: Vec2::default(), force: row.force, torque: row.torque };
            pushed.push((i, acceleration(&load, self.bodies.mass(i))));
        }
        pushed.sort_unstable_by_key(|(i, _)| *i);
        pushed
    }

    /// What the fields of position do here and now.
    pub(super) fn evaluate_fields(&mut self) {
        let mut fields = core::mem::take(&mut self.scratch.fields);
        self.evaluate(Dependence::Position, &mut fields);
        self.scratch.fields = fields;
        self.scratch.fields_hold = true;
    }

    /// What the fields of velocity do here and now.
    pub(super) fn evaluate_resisting(&mut self) {
        let mut resisting = core::mem::take(&mut self.scratch.resisting);
        self.evaluate(Dependence::Velocity, &mut resisting);
        self.scratch.resisting = resisting;
    }

    fn evaluate(&mut self, pass: Dependence, into: &mut Accelerations<S>) {
        let Scratch { directions, loads, found, .. } = &mut *self.scratch;
        loads.clear();
        let scene = Scene { bodies: self.bodies, fields: self.fields, custom_forces: self.custom_forces };
        accumulate(scene, pass, directions, loads, &mut found.faults);
        into.clear();
        for (i, load) in loads.rows() {
            match acceleration(load, self.bodies.mass(*i)) {
                Some(acceleration) => into.push((*i, acceleration)),
                None => found.faults.push((*i, Cause::Force)),
            }
        }
    }

    /// What the fields of position and velocity do in a kick.
    pub(super) fn kick_by_fields(&mut self, march: &March<'_, S>, stage: &Stage, has: Has) {
        if has.position {
            let fields = core::mem::take(&mut self.scratch.fields);
            self.kick_all(march, stage, &fields);
            self.scratch.fields = fields;
        }
        if has.velocity {
            let resisting = core::mem::take(&mut self.scratch.resisting);
            self.kick_all(march, stage, &resisting);
            if stage.mirrored {
                self.correct(march, stage, &resisting);
            }
            self.scratch.resisting = resisting;
        }
    }

    fn kick_all(&mut self, march: &March<'_, S>, stage: &Stage, accelerations: &Accelerations<S>) {
        let timing = march.plan.timing[stage.span];
        let mut block = self.bodies.all_moving();
        for (i, acceleration) in accelerations {
            if let Err(cause) = kick_by(&mut block, *i, acceleration, timing.seconds, timing.negative) {
                self.scratch.found.faults.push((*i, cause));
            }
        }
    }

    /// The second evaluation of the forces of velocity: the closing half kick is the implicit one, v' = v + ½h·a(x', v'),
    /// to within O(h³). The first, explicit half takes its value at the old velocity, so that the two together are the
    /// trapezoidal rule, of order 2.
    fn correct(&mut self, march: &March<'_, S>, stage: &Stage, first: &Accelerations<S>) {
        let timing = march.plan.timing[stage.span];
        let mut second = core::mem::take(&mut self.scratch.spare);
        self.evaluate(Dependence::Velocity, &mut second);
        let mut block = self.bodies.all_moving();
        // The first kick is taken back to the bit; one that was left out for its size stays out.
        let back = first.iter().map(|(i, acceleration)| (*i, acceleration, !timing.negative));
        let there = second.iter().map(|(i, acceleration)| (*i, acceleration, timing.negative));
        for (i, acceleration, negative) in back.chain(there) {
            if let Err(cause) = kick_by(&mut block, i, acceleration, timing.seconds, negative) {
                self.scratch.found.faults.push((i, cause));
            }
        }
        self.scratch.spare = second;
    }

    /// PublishedVerlet's v += (a + a')/2·dt; the new acceleration is kept for the next step.
    pub(super) fn kick_by_mean(&mut self, march: &March<'_, S>, has: Has) {
        let half = self.plan.half;
        let Scratch { fields, resisting, total, found, .. } = &mut *self.scratch;
        let mut block = self.bodies.all_moving();
        total.clear();
        total.extend(
            block.factors.iter().map(|&row| {
                Some(Acceleration { linear: march.rows[row as usize].gravity, angular: S::Wide::default() })
            }),
        );
        let fields = if has.position { &fields[..] } else { &[] };
        let resisting = if has.velocity { &resisting[..] } else { &[] };
        let fields = fields.iter().chain(resisting).map(|(i, part)| (i, part));
        for (i, part) in fields.chain(accelerations(march.pushed)) {
            total[*i] = total[*i].and_then(|total| sum(&total, part));
        }
        for (i, total) in total.iter().enumerate() {
            let last = block.last[i];
            let kicked = total.and_then(|total| {
                block.last[i] = total;
                sum(&last, &total)
            });
            let done = match kicked {
                Some(twice) => kick_by(&mut block, i, &twice, half, false),
                None => Err(Cause::Force),
            };
            if let Err(cause) = done {
                found.faults.push((i, cause));
            }
        }
    }
}
