//! Previews: the future of one body.

use alloc::collections::{BTreeMap, BTreeSet};
use alloc::sync::Arc;
use alloc::vec::Vec;

use super::change_log::ChangeLog;
use super::{BodyRef, StepReport, World};
use crate::body::BodyKind;
use crate::error::Error;
use crate::force::{FieldKind, ForceField};
use crate::fx::Fx;
use crate::scalar::Scalar;
use crate::slots::BodyId;

/// A small world with one body and everything that its future depends on.
///
/// Bodies that force fields do not connect to a body never change a bit of it. So a preview takes exactly the path that the
/// world itself would take without further inputs, as long as the body touches nothing and has no joint, at the cost of a few bodies.
#[derive(Clone, Debug)]
pub struct Preview<S: Scalar = Fx> {
    world: World<S>,
    body: BodyId,
}

impl<S: Scalar> Preview<S> {
    /// Simulates one more tick.
    pub fn step(&mut self) -> StepReport<'_, S> {
        self.world.step()
    }

    /// The body in the small world.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`] if it was removed there.
    pub fn body(&self) -> Result<BodyRef<'_, S>, Error> {
        self.world.body(self.body)
    }

    /// The handle of the body in the small world, which may differ from its handle in the original world.
    #[must_use]
    pub fn id(&self) -> BodyId {
        self.body
    }

    /// The small world.
    #[must_use]
    pub fn world(&self) -> &World<S> {
        &self.world
    }

    /// The small world, to try changes: an impulse, another velocity.
    pub fn world_mut(&mut self) -> &mut World<S> {
        &mut self.world
    }
}

impl<S: Scalar> World<S> {
    /// Previews the future of one body without a copy of the world, for example for an aim line.
    ///
    /// The preview has the body, all bodies that springs connect to it directly or indirectly, bodies that carry an attractor
    /// which acts on one of these, and the fields that act on them. It has no colliders and no joints: it shows the free flight,
    /// without the lift of fluids, through whatever stands in the way. To look ahead with contacts and joints, step a clone of the world.
    ///
    /// *Cost* in proportion to the fields of the world and to those bodies.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`].
    ///
    /// ```
    /// use umbra_physics::{BodyDef, World, WorldDef, vec2};
    ///
    /// let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
    /// let ball = world.add_body(BodyDef::dynamic())?;
    /// let mut ahead = world.preview(ball)?;
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
    pub fn preview(&self, body: BodyId) -> Result<Preview<S>, Error> {
        S::preview(self, body)
    }

    pub(crate) fn preview_inner(&self, body: BodyId) -> Result<Preview<S>, Error> {
        self.bodies.find(body)?;
        let (company, felt) = self.company(body);
        let mut world = World::with_scalar(self.def)?;
        (world.tick, world.counted, world.custom_forces) = (self.tick, self.counted, self.custom_forces.clone());
        world.change_log = ChangeLog::starting_at(self.tick);
        world.targets.moved_at = self.targets.moved_at;
        let mut adopted = BTreeMap::new();
        for &old in &company {
            let factor_table = Arc::make_mut(&mut world.factor_table);
            let new = world.bodies.adopt(&self.bodies, old, &self.factor_table, factor_table)?;
            if let Some(row) = self.applied.row(old) {
                world.applied.adopt(new, row.force, row.torque);
            }
            if let Some(target) = self.targets.of(old) {
                world.targets.set(new, *target);
            }
            adopted.insert(old, new);
        }
        let fields = Arc::make_mut(&mut world.fields);
        for (_, field) in self.fields.iter().filter(|(_, field)| acts_on_any(field, &company, felt)) {
            if let Some(field) = field.map_bodies(|body| adopted.get(&body).copied()) {
                fields.insert(field);
            }
        }
        Ok(Preview { body: adopted[&body], world })
    }

    /// The body and the bodies that its future depends on, and the groups of which a field needs one to act on them.
    fn company(&self, body: BodyId) -> (BTreeSet<BodyId>, u32) {
        let carried = self.fields.iter().filter(|(_, field)| matches!(field.kind, FieldKind::Attractor { .. }));
        let carried = carried.filter_map(|(_, field)| Some((field.force_groups, field.bodies().next()?)));
        let carried: Vec<(u32, BodyId)> = carried.collect();
        let (mut company, mut to_ask, mut felt) = (BTreeSet::from([body]), Vec::from([body]), 0);
        while let Some(member) = to_ask.pop() {
            let Ok(i) = self.bodies.find(member) else { continue };
            let info = self.bodies.info(i);
            // A static body passes nothing on from one spring to another.
            if info.kind != BodyKind::Static {
                let springs =
                    self.fields.attached_to(member).filter(|(_, field)| matches!(field.kind, FieldKind::Spring { .. }));
                let joined = springs.flat_map(|(_, field)| field.bodies());
                to_ask.extend(joined.filter(|&member| company.insert(member)));
            }
            // At most 32 times, as there are 32 groups.
            let more = if info.kind == BodyKind::Dynamic { info.force_groups & !felt } else { 0 };
            if more != 0 {
                felt |= more;
                let carriers =
                    carried.iter().filter(|(force_groups, _)| force_groups & more != 0).map(|&(_, carrier)| carrier);
                to_ask.extend(carriers.filter(|&carrier| company.insert(carrier)));
            }
        }
        (company, felt)
    }
}

/// True if a field acts on one of these bodies.
fn acts_on_any<S: Scalar>(field: &ForceField<S>, bodies: &BTreeSet<BodyId>, felt: u32) -> bool {
    if field.kind.acts_by_groups() {
        field.force_groups & felt != 0
    } else {
        field.bodies().any(|body| bodies.contains(&body))
    }
}
