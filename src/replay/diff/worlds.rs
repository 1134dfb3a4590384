//! The values in which two worlds differ.

use alloc::collections::BTreeMap;
use alloc::vec::Vec;

use super::difference::{Difference, TickPhase, name_of};
use crate::codec::{self, Encoder, FieldIndex, FieldValue, Part, Write};
use crate::collider::Collider;
use crate::replay::snapshot::{Owner, State};
use crate::scalar::Scalar;
use crate::slots::{BodyId, ColliderId, FieldId, JointId};
use crate::world::{BodyRef, World};

impl<S: Scalar> World<S> {
    /// All values in which the states of two worlds differ, in the order of a snapshot: values of the world itself, of its
    /// bodies, of its force fields. Equal states have none. The tick is that of this world, the phase is
    /// [`TickPhase::Start`].
    ///
    /// This is a tool for debugging: it is slow, and builds the names of all values.
    #[must_use]
    pub fn differences(&self, rhs: &Self) -> Vec<Difference> {
        S::differences(self, rhs)
    }

    pub(crate) fn differences_inner(&self, rhs: &Self) -> Vec<Difference> {
        let (left, right) = (FieldIndex::of(&State(self)).leaves, FieldIndex::of(&State(rhs)).leaves);
        let mut rest: BTreeMap<&[Part], &FieldValue> = right.iter().map(|leaf| (&leaf.path[..], leaf)).collect();
        let mut differences = Vec::new();
        for leaf in &left {
            let counterpart = rest.remove(&leaf.path[..]);
            if counterpart.is_none_or(|twin| twin.bytes != leaf.bytes) {
                differences.push(self.difference(self, &leaf.path, Some(leaf), counterpart));
            }
        }
        differences.extend(rest.into_iter().map(|(path, leaf)| self.difference(rhs, path, None, Some(leaf))));
        differences
    }

    /// The first of the [`differences`](Self::differences), found in little memory however much differs.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, World, WorldDef, vec2};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// for x in 0..1_000 {
    ///     world.add_body(BodyDef { position: vec2(x, 0), velocity: vec2(0, 1), ..BodyDef::dynamic() })?;
    /// }
    /// let mut ahead = world.clone();
    /// assert_eq!(world.first_difference(&ahead), None);
    /// ahead.step();
    /// let first = world.first_difference(&ahead).unwrap();
    /// assert_eq!(first.to_string(), "tick 0, start, the world, tick: 0 and 1");
    /// assert_eq!(world.differences(&ahead).first(), Some(&first));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[must_use]
    pub fn first_difference(&self, rhs: &Self) -> Option<Difference> {
        S::first_difference(self, rhs)
    }

    pub(crate) fn first_difference_inner(&self, rhs: &Self) -> Option<Difference> {
        let (left, right) = codec::first_difference(&State(self), &State(rhs))?;
        let (with, path) = match (&left, &right) {
            (Some(leaf), _) => (self, &leaf.path),
            (None, Some(leaf)) => (rhs, &leaf.path),
            (None, None) => return None,
        };
        let right = right.as_ref().filter(|leaf| leaf.path == *path);
        Some(self.difference(with, path, left.as_ref(), right))
    }

    /// The difference at a path, which the world `with` has.
    fn difference(
        &self,
        with: &Self,
        path: &[Part],
        left: Option<&FieldValue>,
        right: Option<&FieldValue>,
    ) -> Difference {
        let (owner, path) = with.owner_of(path);
        let key = match owner {
            Owner::Body(body) => with.body(body).map_or(0, |body| body.key()),
            Owner::Joint(joint) => with.joint(joint).map_or(0, |joint| joint.key()),
            _ => 0,
        };
        Difference { key, ..difference(self.tick(), owner, path, left, right) }
    }

    /// The handle of the collider in a slot.
    fn collider_in(&self, slot: u32) -> ColliderId {
        ColliderId::from_parts(slot, self.colliders.generation(slot).unwrap_or_default())
    }

    /// The owner of the value at a path, and the rest of the path.
    pub(in crate::replay) fn owner_of<'p>(&self, path: &'p [Part]) -> (Owner, &'p [Part]) {
        match *path {
            [Part::Name("bodies"), Part::Entry(slot), ..] => {
                let generation = self.bodies.generation(slot).unwrap_or_default();
                (Owner::Body(BodyId::from_parts(slot, generation)), &path[2..])
            }
            [Part::Name("fields"), Part::Entry(slot), ..] => {
                let generation = self.fields.generation(slot).unwrap_or_default();
                (Owner::ForceField(FieldId::from_parts(slot, generation)), &path[2..])
            }
            [Part::Name("colliders"), Part::Entry(slot), ..] => (Owner::Collider(self.collider_in(slot)), &path[2..]),
            [Part::Name("joints"), Part::Entry(slot), ..] => {
                let generation = self.joints.generation(slot).unwrap_or_default();
                (Owner::Joint(JointId::from_parts(slot, generation)), &path[2..])
            }
            [Part::Name("contacts"), Part::Entry(index), ..] => {
                let pair = self.contacts.iter().nth(index as usize).map(|record| record.pair()).unwrap_or_default();
                let [first, second] = pair.map(|outline| self.collider_in(outline.slot));
                (Owner::Contact(first, second), &path[2..])
            }
            [Part::Name("one_way_pairs"), Part::Entry(index), ..] => {
                let slot = self.contacts.passes.get(index as usize).map_or(0, |record| record.collider);
                (Owner::Collider(self.collider_in(slot)), path)
            }
            [Part::Name("sensor_overlaps"), Part::Entry(index), ..] => {
                let slot = self.contacts.overlaps.get(index as usize).map_or(0, |overlap| overlap.sensor);
                (Owner::Collider(self.collider_in(slot)), path)
            }
            [Part::Name("ended_pairs"), Part::Entry(index), ..] => match self.contacts.ended.get(index as usize) {
                Some(ended) => (Owner::Collider(ended.pair.colliders[0]), path),
                None => (Owner::World, path),
            },
            [Part::Name("excluded_pairs"), Part::Entry(index), ..] => {
                let slot = self.contacts.excluded.get(index as usize).map_or(0, |pair| pair.bodies[0]);
                (Owner::Body(BodyId::from_parts(slot, self.bodies.generation(slot).unwrap_or_default())), path)
            }
            _ => (Owner::World, path),
        }
    }
}

/// The colliders of a body without their handles, sorted by key and then by definition.
struct CollidersByKey<'a, S: Scalar>(Vec<&'a Collider<S>>);

impl<'a, S: Scalar> CollidersByKey<'a, S> {
    fn of(body: &BodyRef<'a, S>) -> Self {
        let mut colliders: Vec<_> = body.parts().0.colliders.of(body.id()).collect();
        colliders.sort_unstable_by_key(|collider| (collider.def.key, collider.physics_digest));
        Self(colliders)
    }
}

impl<S: Scalar> Write for CollidersByKey<'_, S> {
    fn write(&self, out: &mut impl Encoder) {
        out.enter(Part::Name("colliders"));
        codec::list(out, self.0.iter().map(|collider| &collider.def));
        out.leave();
    }
}

impl<S: Scalar> BodyRef<'_, S> {
    /// The first value in which the body differs from another one, of this world or another, handles aside: definition, motion, rest,
    /// colliders in the order of their keys. `None` if there is none; forces applied since the last step are not compared.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, Owner, World, WorldDef, vec2};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let [a, b] = [1, 2].map(|x| world.add_body(BodyDef { velocity: vec2(x, 0), ..BodyDef::dynamic() }));
    /// let (a, b) = (world.body(a?)?, world.body(b?)?);
    /// let difference = a.first_difference(&b).unwrap();
    /// assert_eq!((difference.owner, &difference.field[..]), (Owner::Body(a.id()), "velocity.x"));
    /// assert_eq!(a.first_difference(&a), None);
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[must_use]
    pub fn first_difference(&self, rhs: &BodyRef<'_, S>) -> Option<Difference> {
        let leaves = |body: &BodyRef<'_, S>| {
            let (world, dense) = body.parts();
            let mut leaves = FieldIndex::of(&world.bodies.record(dense, &world.factor_table)).leaves;
            leaves.extend(FieldIndex::of(&CollidersByKey::of(body)).leaves);
            leaves
        };
        let difference = first_unlike(self.parts().0.tick(), Owner::Body(self.id()), &leaves(self), &leaves(rhs))?;
        Some(Difference { key: self.key(), ..difference })
    }
}

fn difference(
    tick: u64,
    owner: Owner,
    path: &[Part],
    left: Option<&FieldValue>,
    right: Option<&FieldValue>,
) -> Difference {
    let [left, right] = [left, right].map(|value| value.map(|value| value.text.clone()));
    let phase = TickPhase::Start;
    let field = name_of(path);
    Difference { tick, phase, owner, name: None, key: 0, field, left, right }
}

/// The first value in which two records of one body or field differ.
fn first_unlike(tick: u64, owner: Owner, left: &[FieldValue], right: &[FieldValue]) -> Option<Difference> {
    let pairs = left.iter().map(|leaf| (leaf, right.iter().find(|twin| twin.path == leaf.path)));
    let mut unlike = pairs.filter(|(leaf, twin)| twin.is_none_or(|twin| twin.bytes != leaf.bytes));
    if let Some((leaf, twin)) = unlike.next() {
        return Some(difference(tick, owner, &leaf.path, Some(leaf), twin));
    }
    let more = right.iter().find(|leaf| left.iter().all(|here| here.path != leaf.path));
    more.map(|leaf| difference(tick, owner, &leaf.path, None, Some(leaf)))
}

#[cfg(test)]
mod tests {
    use alloc::string::ToString as _;

    use super::*;

    #[test]
    fn a_value_that_only_one_of_two_records_has_is_a_difference() {
        let leaf = |name| FieldValue {
            path: alloc::vec![Part::Name(name)],
            at: 0,
            bytes: alloc::vec![1],
            text: "1".to_string(),
        };
        let named = |left: &[FieldValue], right: &[FieldValue]| {
            first_unlike(0, Owner::World, left, right).map(|Difference { field, left, right, .. }| (field, left, right))
        };
        let (b, value) = ("b".to_string(), Some("1".to_string()));
        assert_eq!(named(&[leaf("a")], &[leaf("a")]), None);
        assert_eq!(named(&[leaf("a")], &[leaf("a"), leaf("b")]), Some((b.clone(), None, value.clone())));
        assert_eq!(named(&[leaf("a"), leaf("b")], &[leaf("a")]), Some((b, value, None)));
    }
}
