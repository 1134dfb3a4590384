//! Adding, removing and changing force fields.

use super::{Command, World};
use crate::body::Change;
use crate::error::Error;
use crate::force::ForceField;
use crate::scalar::Scalar;
use crate::slots::FieldId;
use alloc::sync::Arc;

impl<S: Scalar> World<S> {
    /// Adds a force field; wakes the bodies that it may act on.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`], [`Error::NotDynamic`] or [`Error::SameBody`] for the bodies that it is attached to;
    /// [`Error::CustomForce`] for a custom force that is not registered; [`Error::OutOfRange`] naming the quantity; [`Error::Full`].
    ///
    /// ```
    /// use umbra_physics::{BodyDef, End, FieldKind, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let star =
    ///     FieldKind::Attractor { centre: End::World(vec2(0, 0)), mu: 100.into(), softening: fx!(1) };
    /// let star = world.add_field(star)?; // acts on all bodies; a `ForceField` with `force_groups` on some
    /// world.set_field(star, FieldKind::Drag { linear: fx!(1), quadratic: fx!(0), wind: vec2(3, 0) })?;
    /// assert_eq!(world.fields().map(|(id, _)| id).collect::<Vec<_>>(), [star]);
    /// world.remove_field(star)?;
    /// assert!(world.field(star).is_err());
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn add_field(&mut self, field: impl Into<ForceField<S>>) -> Result<FieldId, Error> {
        S::add_field(self, field.into())
    }

    pub(crate) fn add_field_inner(&mut self, field: ForceField<S>) -> Result<FieldId, Error> {
        self.check_new_field(&field)?;
        self.journal.note(|| Command::AddField(field));
        let id = Arc::make_mut(&mut self.fields).insert(field);
        self.wake_for(&field);
        Ok(id)
    }

    /// A force field.
    ///
    /// # Errors
    /// [`Error::NoSuchField`].
    pub fn field(&self, id: FieldId) -> Result<&ForceField<S>, Error> {
        self.fields.get(id)
    }

    /// The force fields in the order in which they were added. Drags act in this order.
    pub fn fields(&self) -> impl Iterator<Item = (FieldId, &ForceField<S>)> {
        self.fields.iter()
    }

    /// Replaces a force field; wakes the bodies that either may act on.
    ///
    /// # Errors
    /// [`Error::NoSuchField`], and as [`add_field`](Self::add_field).
    pub fn set_field(&mut self, id: FieldId, field: impl Into<ForceField<S>>) -> Result<(), Error> {
        S::set_field(self, id, field.into())
    }

    pub(crate) fn set_field_inner(&mut self, id: FieldId, field: ForceField<S>) -> Result<(), Error> {
        let old = self.check_next_field(id, &field)?;
        self.journal.note(|| Command::SetField { id, field });
        self.wake_for(&old);
        Arc::make_mut(&mut self.fields).replace(id, field)?;
        self.wake_for(&field);
        Ok(())
    }

    /// Removes a force field; wakes the bodies that it may have acted on.
    ///
    /// # Errors
    /// [`Error::NoSuchField`].
    pub fn remove_field(&mut self, id: FieldId) -> Result<(), Error> {
        S::remove_field(self, id)
    }

    pub(crate) fn remove_field_inner(&mut self, id: FieldId) -> Result<(), Error> {
        self.take_field(id)?;
        self.journal.note(|| Command::RemoveField(id));
        Ok(())
    }

    /// Removes a force field as part of another change.
    pub(super) fn take_field(&mut self, id: FieldId) -> Result<(), Error> {
        let field = self.check_field(id)?;
        self.wake_for(&field);
        Arc::make_mut(&mut self.fields).remove(id).map(drop)
    }

    /// Notes that a field comes, goes or changes, and wakes what it may act on.
    fn wake_for(&mut self, field: &ForceField<S>) {
        let by_groups = field.kind.acts_by_groups();
        field.bodies().for_each(|body| self.bodies.note_body(body, Change::FORCES));
        if by_groups {
            self.bodies.changes_mut().note_group_fields();
            self.wake_reached(&[], field.force_groups);
        } else {
            let bodies: alloc::vec::Vec<_> = field.bodies().collect();
            // Fields on the same static body, and bodies that it attracts, are not affected.
            self.wake_reached(&bodies, 0);
        }
    }
}
