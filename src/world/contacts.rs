//! Contacts as calls read them.

use super::World;
use crate::contact::{Contact, ContactEngine as _, ContactRecord};
use crate::error::Error;
use crate::scalar::Scalar;
use crate::slots::BodyId;

impl<S: Scalar> World<S> {
    /// The contacts that carried an impulse at the end of the last step, at the present poses: those whose colliders are no longer
    /// near each other are left out. Sorted by the slots of the colliders.
    ///
    /// They are a function of the state: a restored world has the same.
    pub fn contacts(&self) -> impl Iterator<Item = Contact<S>> {
        self.contacts.records.iter().filter_map(|record| self.contact(record))
    }

    /// The [contacts](Self::contacts) of a body. The call looks at all contacts of the world.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`].
    ///
    /// ```
    /// use umbra_physics::{BodyDef, Shape, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
    /// world.add_body(BodyDef::fixed().with_collider(Shape::rectangle(fx!(20), fx!(2))?))?;
    /// let ball = BodyDef { position: vec2(0, fx!(1.5)), ..BodyDef::dynamic().with_collider(Shape::circle(fx!(0.5))?) };
    /// let ball = world.add_body(ball)?;
    /// assert_eq!(world.contacts_of(ball)?.count(), 0);
    /// (0..10).for_each(|_| _ = world.step());
    /// // On the ground: something pushes it upwards.
    /// assert!(world.contacts_of(ball)?.any(|contact| contact.bodies[1] == ball && contact.normal.y > fx!(0.9)));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn contacts_of(&self, body: BodyId) -> Result<impl Iterator<Item = Contact<S>> + use<'_, S>, Error> {
        self.bodies.find(body)?;
        let is_of = move |slot| self.colliders.at(slot).is_some_and(|collider| collider.body == body);
        let own = self.contacts.records.iter().filter(move |record| record.pair.into_iter().any(is_of));
        Ok(own.filter_map(|record| self.contact(record)))
    }

    fn contact(&self, record: &ContactRecord) -> Option<Contact<S>> {
        let [a, b] = record.pair.map(|slot| self.colliders.at(slot));
        let (a, b) = (a?, b?);
        let motion = &self.bodies.columns.motion;
        let pose = |body| self.bodies.find(body).ok().map(|dense| (motion.position.get(dense), motion.angle[dense]));
        let (normal, points, count) = S::Contacts::touch((&a.outline, pose(a.body)?), (&b.outline, pose(b.body)?))?;
        let handles = (record.pair.map(|slot| self.colliders.id(slot)), [a.body, b.body]);
        Some(Contact::new(record, handles, (normal, &points[..count])))
    }
}
