//! Queries: bodies by handle, by key, and in order.

use super::{BodyRef, World};
use crate::error::Error;
use crate::scalar::Scalar;
use crate::slots::BodyId;

impl<S: Scalar> World<S> {
    /// A read-only view of a body.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`].
    pub fn body(&self, body: BodyId) -> Result<BodyRef<'_, S>, Error> {
        Ok(BodyRef { world: self, dense: self.bodies.find(body)? })
    }

    /// The bodies in the order of their slots.
    pub fn bodies(&self) -> impl Iterator<Item = BodyRef<'_, S>> {
        self.bodies.in_order().map(|dense| BodyRef { world: self, dense })
    }

    /// The first body by slot with this [key](BodyRef::key). The call looks through all bodies: keep the handle if you need it
    /// often.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, World, WorldDef};
    ///
    /// let mut world: World = World::new(WorldDef::default())?;
    /// let [red, _, green] = [1, 2, 1].map(|key| world.add_body(BodyDef { key, ..BodyDef::dynamic() }));
    /// let [red, green] = [red?, green?];
    /// assert_eq!(world.body_with_key(1).map(|body| body.id()), Some(red));
    /// assert!(world.bodies_with_key(1).map(|body| body.id()).eq([red, green]));
    /// assert!(world.body_with_key(3).is_none());
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[must_use]
    pub fn body_with_key(&self, key: u64) -> Option<BodyRef<'_, S>> {
        self.bodies_with_key(key).next()
    }

    /// The bodies with this [key](BodyRef::key), in the order of their slots. The call looks through all bodies.
    pub fn bodies_with_key(&self, key: u64) -> impl Iterator<Item = BodyRef<'_, S>> {
        self.bodies().filter(move |body| body.key() == key)
    }

    /// The number of bodies.
    #[must_use]
    pub fn body_count(&self) -> usize {
        self.bodies.len()
    }

    /// The number of bodies that a step moves: not static, asleep, quarantined or disabled.
    #[must_use]
    pub fn moving_count(&self) -> usize {
        self.bodies.moving()
    }
}
