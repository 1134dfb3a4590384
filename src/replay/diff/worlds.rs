//! The values in which two worlds differ.

use alloc::collections::BTreeMap;
use alloc::vec::Vec;

use super::difference::{Difference, TickPhase, name_of};
use crate::codec::{self, FieldIndex, FieldValue, Part};
#[cfg(feature = "oracles")]
use crate::force::ForceField;
use crate::handle::{BodyId, FieldId};
use crate::replay::snapshot::{Owner, State};
use crate::scalar::Scalar;
use crate::world::World;

impl<S: Scalar> World<S> {
    /// All values in which the states of two worlds differ, in the order of a snapshot: values of the world itself, of its
    /// bodies, of its force fields. Equal states have none. The tick is that of this world, the phase is
    /// [`TickPhase::Start`].
    ///
    /// This is a tool for debugging: it is slow, and builds the names of all values.
    #[must_use]
    pub fn differences(&self, other: &Self) -> Vec<Difference> {
        let (left, right) = (FieldIndex::of(&State(self)).leaves, FieldIndex::of(&State(other)).leaves);
        let mut rest: BTreeMap<&[Part], &FieldValue> = right.iter().map(|leaf| (&leaf.path[..], leaf)).collect();
        let mut found = Vec::new();
        for leaf in &left {
            let there = rest.remove(&leaf.path[..]);
            if there.is_none_or(|there| there.bytes != leaf.bytes) {
                found.push(self.difference(self, &leaf.path, Some(leaf), there));
            }
        }
        found.extend(rest.into_iter().map(|(path, there)| self.difference(other, path, None, Some(there))));
        found
    }

    /// The first of the [`differences`](Self::differences), found in little memory however much differs.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, World, WorldDef, vec2};
    ///
    /// let mut world: World = World::new(WorldDef::default())?;
    /// for x in 0..1_000 {
    ///     world.add_body(BodyDef { position: vec2(x, 0), velocity: vec2(0, 1), ..BodyDef::dynamic() })?;
    /// }
    /// let mut other = world.clone();
    /// assert_eq!(world.first_difference(&other), None);
    /// other.step();
    /// let first = world.first_difference(&other).unwrap();
    /// assert_eq!(first.to_string(), "tick 0, start, the world, tick: 0 and 1");
    /// assert_eq!(world.differences(&other).first(), Some(&first));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[must_use]
    pub fn first_difference(&self, other: &Self) -> Option<Difference> {
        let (left, right) = codec::first_difference(&State(self), &State(other))?;
        let (with, path) = match (&left, &right) {
            (Some(leaf), _) => (self, &leaf.path),
            (None, Some(leaf)) => (other, &leaf.path),
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
        difference(self.tick(), owner, path, left, right)
    }

    /// The first value in which a body differs from a body of another world, handles aside; `None` if there is none, or no
    /// such body.
    #[cfg(feature = "oracles")]
    pub(crate) fn body_difference(&self, body: BodyId, other: &Self, there: BodyId) -> Option<Difference> {
        let (here, there) = (self.bodies.find(body).ok()?, other.bodies.find(there).ok()?);
        let leaves = |world: &Self, dense: usize| {
            let mut leaves = FieldIndex::of(&world.bodies.record(dense, &world.factor_table)).leaves;
            let shape = world.bodies.info(dense).shape.as_deref();
            leaves.extend(shape.into_iter().flat_map(|shape| FieldIndex::of(shape).leaves));
            leaves
        };
        first_unlike(self.tick(), Owner::Body(body), &leaves(self, here), &leaves(other, there))
    }

    /// The first value in which a field of another world differs from what it should be there; `None` if there is none.
    #[cfg(feature = "oracles")]
    pub(crate) fn field_difference(
        &self,
        id: FieldId,
        meant: &ForceField<S>,
        there: Option<&ForceField<S>>,
    ) -> Option<Difference> {
        let there = there.map(|there| FieldIndex::of(there).leaves).unwrap_or_default();
        first_unlike(self.tick(), Owner::ForceField(id), &FieldIndex::of(meant).leaves, &there)
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
            _ => (Owner::World, path),
        }
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
    Difference { tick, phase: TickPhase::Start, owner, field: name_of(path), left, right }
}

/// The first value in which two records of one body or field differ.
#[cfg(feature = "oracles")]
fn first_unlike(tick: u64, owner: Owner, left: &[FieldValue], right: &[FieldValue]) -> Option<Difference> {
    let pairs = left.iter().map(|leaf| (leaf, right.iter().find(|there| there.path == leaf.path)));
    let mut unlike = pairs.filter(|(leaf, there)| there.is_none_or(|there| there.bytes != leaf.bytes));
    if let Some((leaf, there)) = unlike.next() {
        return Some(difference(tick, owner, &leaf.path, Some(leaf), there));
    }
    let more = right.iter().find(|leaf| left.iter().all(|here| here.path != leaf.path));
    more.map(|leaf| difference(tick, owner, &leaf.path, None, Some(leaf)))
}

#[cfg(all(test, feature = "oracles"))]
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
        let found = |left: &[FieldValue], right: &[FieldValue]| {
            first_unlike(0, Owner::World, left, right).map(|Difference { field, left, right, .. }| (field, left, right))
        };
        let (b, one) = ("b".to_string(), Some("1".to_string()));
        assert_eq!(found(&[leaf("a")], &[leaf("a")]), None);
        assert_eq!(found(&[leaf("a")], &[leaf("a"), leaf("b")]), Some((b.clone(), None, one.clone())));
        assert_eq!(found(&[leaf("a"), leaf("b")], &[leaf("a")]), Some((b, one, None)));
    }
}
