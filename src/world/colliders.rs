//! Adding, removing, changing and reading colliders.

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::{Command, World, WorldDef};
use crate::body::{BodyKind, Change};
use crate::collider::{ColliderDef, ContactSettings, MaterialPair};
use crate::error::Error;
use crate::scalar::Scalar;
use crate::slots::{BodyId, ColliderId};

impl<S: Scalar> World<S> {
    /// Adds a collider to a body; wakes the body. Its mass changes if it is
    /// [`Mass::FromColliders`](crate::Mass::FromColliders); the centre of mass stays where it is.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`]; as [`ColliderDef::check`]; [`Error::DynamicChain`] for a chain on a dynamic body;
    /// [`Error::OutOfRange`] for a mass that the body cannot have; [`Error::Full`].
    ///
    /// ```
    /// use umbra_physics::{BodyDef, ColliderDef, Shape, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let body = world.add_body(BodyDef::dynamic())?;
    /// let disc = ColliderDef { density: fx!(2), ..ColliderDef::new(Shape::circle(fx!(1))?) };
    /// let collider = world.add_collider(body, disc)?;
    /// assert_eq!(world.collider(collider)?.density, fx!(2));
    /// assert_eq!((world.collider_body(collider)?, world.collider_count()), (body, 1));
    /// assert_eq!(world.colliders_of(body)?.collect::<Vec<_>>(), [collider]);
    ///
    /// let square = Shape::rectangle(fx!(1), fx!(1))?;
    /// world.set_collider(collider, square)?; // a shape alone, with the default material
    /// assert_eq!(world.body(body)?.mass(), Some(fx!(1)));
    /// world.remove_collider(collider)?;
    /// assert!(world.collider(collider).is_err() && world.colliders().next().is_none());
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[doc(alias("create_shape", "insert_collider", "add_shape"))]
    pub fn add_collider(&mut self, body: BodyId, def: impl Into<ColliderDef<S>>) -> Result<ColliderId, Error> {
        S::add_collider(self, body, def.into())
    }

    pub(crate) fn add_collider_inner(&mut self, body: BodyId, def: ColliderDef<S>) -> Result<ColliderId, Error> {
        let (mass, properties) = self.check_new_collider(body, &def)?;
        let dense = self.touch(body, self.change_of_colliders(body))?;
        self.journal.note(|| Command::AddCollider { body, def: def.clone() });
        self.bodies.set_collider_mass(dense, mass, properties);
        Ok(Arc::make_mut(&mut self.colliders).insert(body, def))
    }

    /// Replaces the definition of a collider; wakes its body. Its contacts and overlaps end, and begin anew in the next step, without
    /// impulses, if they are still there.
    ///
    /// # Errors
    /// [`Error::NoSuchCollider`], and as [`add_collider`](Self::add_collider).
    pub fn set_collider(&mut self, collider: ColliderId, def: impl Into<ColliderDef<S>>) -> Result<(), Error> {
        S::set_collider(self, collider, def.into())
    }

    pub(crate) fn set_collider_inner(&mut self, collider: ColliderId, def: ColliderDef<S>) -> Result<(), Error> {
        let (body, mass, properties) = self.check_next_collider(collider, Some(&def))?;
        let dense = self.touch(body, self.change_of_colliders(body))?;
        self.journal.note(|| Command::SetCollider { collider, def: def.clone() });
        self.bodies.set_collider_mass(dense, mass, properties);
        self.contacts.forget(&self.bodies, self.colliders.fixed(), &[collider.slot]);
        Arc::make_mut(&mut self.colliders).replace(collider, def)
    }

    /// Removes a collider; wakes its body and those that it touches.
    ///
    /// # Errors
    /// [`Error::NoSuchCollider`]; [`Error::OutOfRange`] if the body's other colliders have a mass that it cannot have.
    pub fn remove_collider(&mut self, collider: ColliderId) -> Result<(), Error> {
        S::remove_collider(self, collider)
    }

    pub(crate) fn remove_collider_inner(&mut self, collider: ColliderId) -> Result<(), Error> {
        let (body, mass, properties) = self.check_next_collider(collider, None)?;
        let dense = self.touch(body, self.change_of_colliders(body))?;
        self.journal.note(|| Command::RemoveCollider(collider));
        self.bodies.set_collider_mass(dense, mass, properties);
        self.contacts.forget(&self.bodies, self.colliders.fixed(), &[collider.slot]);
        Arc::make_mut(&mut self.colliders).remove(collider)
    }

    /// A change of the colliders of a body: that of a static one has no mass.
    fn change_of_colliders(&self, body: BodyId) -> Change {
        let kind = self.bodies.find(body).map(|dense| self.bodies.info(dense).kind);
        if kind == Ok(BodyKind::Static) { Change::COLLIDERS } else { Change::ALL }
    }

    /// Removes the colliders of a body that is removed, in the order of their slots: the slot that is freed last is taken first.
    pub(super) fn take_colliders(&mut self, body: BodyId) -> Result<(), Error> {
        let colliders: Vec<ColliderId> = self.colliders_of(body)?.collect();
        let slots: Vec<u32> = colliders.iter().map(|collider| collider.slot).collect();
        self.contacts.forget(&self.bodies, self.colliders.fixed(), &slots);
        for collider in colliders {
            Arc::make_mut(&mut self.colliders).remove(collider)?;
        }
        Ok(())
    }

    /// Sets the settings of contacts; wakes all bodies.
    ///
    /// # Errors
    /// As [`ContactSettings::check`].
    pub fn set_contact_settings(&mut self, contacts: ContactSettings<S>) -> Result<(), Error> {
        contacts.check()?;
        self.journal.note(|| Command::SetContactSettings(contacts));
        self.redefine(WorldDef { contacts, ..self.def });
        Ok(())
    }

    /// Gives the contacts of two materials coefficients of their own, which replace the mixed ones from the next step on; `None` removes
    /// them. Materials are named by [`Material::id`](crate::Material::id), in either order; both may be the same. The call wakes all
    /// bodies.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] naming the quantity: a number that is 0, friction, restitution, rolling resistance. [`Error::Full`] beyond
    /// [`limits::MATERIAL_PAIRS`](crate::limits::MATERIAL_PAIRS).
    ///
    /// ```
    /// use umbra_physics::{Error, MaterialPair, Quantity, World, WorldDef, fx};
    ///
    /// let [ice, skates] = [1, 2];
    /// let mut world = World::new(WorldDef::default())?;
    /// let slippery = MaterialPair { friction: fx!(0.01), ..MaterialPair::default() };
    /// world.set_material_pair(ice, skates, Some(slippery))?;
    /// assert_eq!(world.material_pair(skates, ice), Some(&slippery));
    /// let numberless = world.set_material_pair(ice, 0, Some(slippery));
    /// assert_eq!(numberless, Err(Error::OutOfRange { quantity: Quantity::MaterialId }));
    /// world.set_material_pair(skates, ice, None)?;
    /// assert_eq!(world.material_pairs().count(), 0);
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn set_material_pair(&mut self, first: u32, second: u32, pair: Option<MaterialPair<S>>) -> Result<(), Error> {
        self.colliders.check_material_pair([first, second], pair.as_ref())?;
        self.journal.note(|| Command::SetMaterialPair { first, second, pair });
        self.wake_all();
        Arc::make_mut(&mut self.colliders).set_material_pair([first, second], pair);
        Ok(())
    }

    /// The coefficients that were given to the contacts of two materials, in either order.
    #[must_use]
    pub fn material_pair(&self, first: u32, second: u32) -> Option<&MaterialPair<S>> {
        self.colliders.material_pair([first, second])
    }

    /// The pairs of materials with coefficients of their own, sorted by both numbers, the lower one first.
    pub fn material_pairs(&self) -> impl Iterator<Item = ([u32; 2], &MaterialPair<S>)> {
        self.colliders.material_pairs().iter().map(|entry| (entry.ids, &entry.pair))
    }

    /// The definition of a collider.
    ///
    /// # Errors
    /// [`Error::NoSuchCollider`].
    pub fn collider(&self, collider: ColliderId) -> Result<&ColliderDef<S>, Error> {
        self.colliders.get(collider).map(|collider| &collider.def)
    }

    /// The body that a collider belongs to.
    ///
    /// # Errors
    /// [`Error::NoSuchCollider`].
    pub fn collider_body(&self, collider: ColliderId) -> Result<BodyId, Error> {
        self.colliders.get(collider).map(|collider| collider.body)
    }

    /// The colliders in the order of their slots.
    pub fn colliders(&self) -> impl Iterator<Item = (ColliderId, &ColliderDef<S>)> {
        self.colliders.iter().map(|collider| (self.colliders.id(collider.slot), &collider.def))
    }

    /// The colliders of a body, in the order of their slots.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`].
    pub fn colliders_of(&self, body: BodyId) -> Result<impl Iterator<Item = ColliderId> + use<'_, S>, Error> {
        self.bodies.find(body)?;
        let mut slots: Vec<u32> = self.colliders.of(body).map(|collider| collider.slot).collect();
        slots.sort_unstable();
        Ok(slots.into_iter().map(|slot| self.colliders.id(slot)))
    }

    /// The number of colliders.
    #[must_use]
    pub fn collider_count(&self) -> usize {
        self.colliders.len()
    }
}
