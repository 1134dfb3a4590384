//! What was applied to bodies this tick, summed up.

use alloc::vec::Vec;

use crate::body::{Bodies, NONE};
use crate::handle::BodyId;
use crate::math::Vec2;
use crate::scalar::{Scalar, Sum, fx::Fx};

/// The sum of the forces and torques applied to a body over a tick; what undoing that step needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AppliedForce<S: Scalar = Fx> {
    /// The body.
    pub body: BodyId,
    pub(crate) force: Vec2<S::Sum>,
    pub(crate) torque: S::Sum,
}

impl<S: Scalar> AppliedForce<S> {
    /// Through the centre of mass, N; `None` if the sum does not fit.
    #[must_use]
    pub fn force(&self) -> Option<Vec2<S::Wide>> {
        self.force.try_map(Sum::total)
    }

    /// About it, N·m; `None` if the sum does not fit.
    #[must_use]
    pub fn torque(&self) -> Option<S::Wide> {
        self.torque.total()
    }
}

/// The sums of this tick, and those of the last step. Only bodies that were pushed have one.
#[derive(Debug)]
pub(crate) struct Applied<S: Scalar> {
    rows: Vec<AppliedForce<S>>,
    done: Vec<AppliedForce<S>>,
}

clone_by_field!(Applied { rows, done });

impl<S: Scalar> Default for Applied<S> {
    fn default() -> Self {
        Self { rows: Vec::new(), done: Vec::new() }
    }
}

impl<S: Scalar> Applied<S> {
    pub(crate) fn rows(&self) -> &[AppliedForce<S>] {
        &self.rows
    }

    /// Those the last step used.
    pub(crate) fn done(&self) -> &[AppliedForce<S>] {
        &self.done
    }

    pub(crate) fn row(&self, index: u32) -> Option<&AppliedForce<S>> {
        self.rows.get(index as usize)
    }

    /// Adds to the sums of the body at this index in the columns.
    pub(crate) fn add(&mut self, bodies: &mut Bodies<S>, dense: usize, force: Vec2<S::Wide>, torque: S::Wide) {
        let body = bodies.id(dense);
        let index = &mut bodies.columns.card[dense].applied;
        if *index == NONE {
            *index = self.rows.len() as u32;
            self.rows.push(AppliedForce { body, force: Vec2::default(), torque: S::Sum::default() });
        }
        let row = &mut self.rows[*index as usize];
        row.force.x.add(force.x);
        row.force.y.add(force.y);
        row.torque.add(torque);
    }

    /// Forgets what was applied to a body.
    pub(crate) fn forget(&mut self, bodies: &mut Bodies<S>, dense: usize) {
        let index = core::mem::replace(&mut bodies.columns.card[dense].applied, NONE);
        if index == NONE {
            return;
        }
        self.rows.swap_remove(index as usize);
        let moved = self.rows.get(index as usize).and_then(|moved| bodies.find(moved.body).ok());
        if let Some(dense) = moved {
            bodies.columns.card[dense].applied = index;
        }
    }

    /// Ends the tick: the sums become those of the last step, in the order of the bodies.
    pub(crate) fn finish(&mut self, bodies: &mut Bodies<S>) {
        for row in &self.rows {
            if let Ok(dense) = bodies.find(row.body) {
                bodies.columns.card[dense].applied = NONE;
            }
        }
        core::mem::swap(&mut self.rows, &mut self.done);
        self.rows.clear();
        self.done.sort_unstable_by_key(|row| row.body);
    }
}
