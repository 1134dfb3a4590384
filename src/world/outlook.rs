//! Looking ahead with one body.

use alloc::collections::{BTreeMap, BTreeSet};
use alloc::sync::Arc;
use alloc::vec::Vec;

use super::journal::Journal;
use super::{BodyRef, StepReport, World};
use crate::body::BodyKind;
use crate::error::Error;
use crate::force::{Field, Law};
use crate::handle::BodyId;
use crate::scalar::{Scalar, fx::Fx};

/// A body and all that its future depends on, in a small world of their own.
///
/// What is not joined to a body by force fields never changes a bit of it, so this goes exactly where the world itself
/// would go without further inputs, at the price of these few bodies.
#[derive(Clone, Debug)]
pub struct Outlook<S: Scalar = Fx> {
    world: World<S>,
    body: BodyId,
}

impl<S: Scalar> Outlook<S> {
    /// Looks a tick farther ahead.
    pub fn step(&mut self) -> StepReport<'_, S> {
        self.world.step()
    }

    /// The body there.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`] if it was removed there.
    pub fn body(&self) -> Result<BodyRef<'_, S>, Error> {
        self.world.body(self.body)
    }

    /// Its handle there; in the world it comes from it may be another.
    #[must_use]
    pub fn id(&self) -> BodyId {
        self.body
    }

    /// The small world.
    #[must_use]
    pub fn world(&self) -> &World<S> {
        &self.world
    }

    /// The small world, to try something out: an impulse, another velocity.
    pub fn world_mut(&mut self) -> &mut World<S> {
        &mut self.world
    }
}

impl<S: Scalar> World<S> {
    /// Looks ahead with one body, without copying the world: for an aim line, say.
    ///
    /// It takes the body, those that springs join it to over any number of them, those that carry attractors which act on
    /// one of these, and the fields that act on them. The time is that of the fields' number and of those bodies.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`].
    ///
    /// ```
    /// use umbra_physics::{BodyDef, World, WorldDef, vec2};
    ///
    /// let mut world: World = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
    /// let ball = world.add_body(BodyDef::dynamic())?;
    /// let mut ahead = world.look_ahead(ball)?;
    /// let shot = ahead.id();
    /// ahead.world_mut().set_velocity(shot, vec2(3, 4))?;
    /// let mut line = Vec::new();
    /// for _ in 0..60 {
    ///     ahead.step();
    ///     line.push(ahead.body()?.position());
    /// }
    /// assert_eq!(line[59], vec2(3, -1));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn look_ahead(&self, body: BodyId) -> Result<Outlook<S>, Error> {
        self.bodies.find(body)?;
        let bodies = self.company(body);
        let mut world = World::new(self.def)?;
        (world.tick, world.counted, world.laws) = (self.tick, self.counted, self.laws.clone());
        world.journal = Journal::starting_at(self.tick);
        world.errands.moved_at = self.errands.moved_at;
        let mut adopted = BTreeMap::new();
        for &old in &bodies {
            let climate = Self::climate(&world.def, &world.plan);
            let tunings = (&*self.tunings, Arc::make_mut(&mut world.tunings));
            let new = world.bodies.adopt((&self.bodies, old), tunings, &climate)?;
            if let Some(row) = self.applied.row(old) {
                world.applied.adopt(new, row.force, row.torque);
            }
            if let Some(errand) = self.errands.of(old) {
                world.errands.set(new, *errand);
            }
            adopted.insert(old, new);
        }
        let fields = Arc::make_mut(&mut world.fields);
        for (_, field) in self.fields.iter().filter(|(_, field)| self.acts_on_any(field, &bodies)) {
            if let Some(field) = field.moved(|body| adopted.get(&body).copied()) {
                fields.insert(field);
            }
        }
        Ok(Outlook { body: adopted[&body], world })
    }

    /// A body and those that its future depends on.
    fn company(&self, body: BodyId) -> BTreeSet<BodyId> {
        let mut joined: BTreeMap<BodyId, Vec<BodyId>> = BTreeMap::new();
        let mut attractors = Vec::new();
        for (_, field) in self.fields.iter() {
            let ends: Vec<BodyId> = field.bodies().collect();
            match (&field.law, ends[..].as_ref()) {
                (Law::Spring { .. }, &[a, b]) => {
                    joined.entry(a).or_default().push(b);
                    joined.entry(b).or_default().push(a);
                }
                (Law::Attractor { .. }, &[carrier]) => attractors.push((field, carrier)),
                _ => {}
            }
        }
        let (mut company, mut to_ask) = (BTreeSet::from([body]), Vec::from([body]));
        while let Some(one) = to_ask.pop() {
            let carriers = attractors.iter().filter(|(field, _)| self.acts_on(field, one)).map(|&(_, carrier)| carrier);
            // What never moves hands nothing on from one spring to another.
            let hands_on = self.bodies.find(one).is_ok_and(|i| self.bodies.card(i).kind != BodyKind::Static);
            let neighbours = joined.get(&one).filter(|_| hands_on).into_iter().flatten().copied();
            to_ask.extend(neighbours.chain(carriers).filter(|&other| company.insert(other)));
        }
        company
    }

    fn acts_on_any(&self, field: &Field<S>, bodies: &BTreeSet<BodyId>) -> bool {
        match &field.law {
            Law::Spring { .. } | Law::Thrust { .. } => field.bodies().any(|own| bodies.contains(&own)),
            _ => bodies.iter().any(|&body| self.acts_on(field, body)),
        }
    }

    /// Whether a field acts on a body for its groups.
    fn acts_on(&self, field: &Field<S>, body: BodyId) -> bool {
        self.bodies.find(body).is_ok_and(|i| self.bodies.card(i).feels(field.groups))
    }
}
