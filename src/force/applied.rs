//! The sums of the forces and torques applied to bodies in this tick.

use alloc::vec::Vec;

use crate::body::{Row, Sparse};
use crate::codec::{self, StateHasher, Write as _};
use crate::fx::Fx;
use crate::math::Vec2;
use crate::scalar::{Scalar, Sum};
use crate::slots::BodyId;

/// The sum of the forces and torques applied to a body over a tick. Undoing the step of that tick needs it.
///
/// ```
/// use umbra_physics::{AppliedForce, BodyDef, Vec2, World, WorldDef, fx, vec2};
///
/// let mut world = World::new(WorldDef::default())?;
/// let body = world.add_body(BodyDef::dynamic())?;
/// world.apply_force(body, vec2(1, 0))?;
/// world.apply_force(body, vec2(2, 5))?;
/// world.apply_torque(body, fx!(7))?;
/// let applied: Vec<AppliedForce> = world.step().applied.to_vec();
/// let Some(Vec2 { x, y }) = applied[0].force() else { unreachable!() };
/// assert_eq!((x.to_scalar(), y.to_scalar()), (Some(fx!(3)), Some(fx!(5))));
/// assert_eq!(applied[0].torque().map(|torque| torque.to_string()), Some("7".into()));
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(
        deny_unknown_fields,
        bound(serialize = "S::Sum: serde::Serialize", deserialize = "S::Sum: serde::Deserialize<'de>")
    )
)]
pub struct AppliedForce<S: Scalar = Fx> {
    /// The body.
    pub body: BodyId,
    pub(crate) force: Vec2<S::Sum>,
    pub(crate) torque: S::Sum,
}

impl<S: Scalar> AppliedForce<S> {
    /// The force through the centre of mass, N; `None` if the sum does not fit.
    #[must_use]
    pub fn force(&self) -> Option<Vec2<S::Wide>> {
        self.force.try_map(Sum::total)
    }

    /// The torque about the centre of mass, N·m; `None` if the sum does not fit.
    #[must_use]
    pub fn torque(&self) -> Option<S::Wide> {
        self.torque.total()
    }
}

impl<S: Scalar> Row for AppliedForce<S> {
    fn key(&self) -> usize {
        self.body.slot as usize
    }
}

/// The sums of this tick, and the sums of the last step. Only bodies to which something was applied have one.
#[derive(Debug, Default)]
pub(crate) struct Applied<S: Scalar> {
    rows: Sparse<AppliedForce<S>>,
    done: Vec<AppliedForce<S>>,
}

clone_by_field!(Applied { rows, done });

impl<S: Scalar> Applied<S> {
    pub(crate) fn rows(&self) -> &[AppliedForce<S>] {
        self.rows.rows()
    }

    /// The sums that the last step used, in the order of the bodies.
    pub(crate) fn done(&self) -> &[AppliedForce<S>] {
        &self.done
    }

    /// The sum of a body, if something was applied to it.
    pub(crate) fn row(&self, body: BodyId) -> Option<&AppliedForce<S>> {
        self.rows.get(body.slot as usize)
    }

    /// The sum of a body, which begins at zero if it has none.
    fn row_mut(&mut self, body: BodyId) -> &mut AppliedForce<S> {
        let none = || AppliedForce { body, force: Vec2::default(), torque: S::Sum::default() };
        self.rows.get_or_insert(body.slot as usize, none)
    }

    /// Adds a force and a torque to the sum of a body.
    pub(crate) fn add(&mut self, body: BodyId, force: Vec2<S::Wide>, torque: S::Wide) {
        let row = self.row_mut(body);
        row.force.x.add(force.x);
        row.force.y.add(force.y);
        row.torque.add(torque);
    }

    /// Replaces the sum of a body by one from another world or another tick.
    pub(crate) fn adopt(&mut self, body: BodyId, force: Vec2<S::Sum>, torque: S::Sum) {
        *self.row_mut(body) = AppliedForce { body, force, torque };
    }

    /// Removes the sum of a body.
    pub(crate) fn forget(&mut self, body: BodyId) {
        self.rows.remove(body.slot as usize);
    }

    /// Ends the tick: the sums become those of the last step, in the order of the bodies.
    pub(crate) fn finish(&mut self) {
        self.rows.move_to(&mut self.done);
        self.done.sort_unstable_by_key(|row| row.body);
    }

    /// Removes the sums of this tick.
    pub(crate) fn clear(&mut self) {
        self.rows.clear();
    }

    /// Removes the sums of the last step.
    pub(crate) fn forget_done(&mut self) {
        self.done.clear();
    }

    /// Adds the sums of this tick to a hash, in the order of the slots.
    pub(crate) fn write(&self, sink: &mut StateHasher) {
        codec::count(sink, self.rows().len());
        for row in self.rows.in_order() {
            row.body.slot.write(sink);
            row.force.write(sink);
            row.torque.write(sink);
        }
    }
}
