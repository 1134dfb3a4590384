//! What two states differ in, by body and field, and trees of hashes to find that out from afar.

use alloc::collections::BTreeMap;
use alloc::format;
use alloc::string::{String, ToString};
use alloc::vec::Vec;
use core::fmt;

use super::finding::TickPhase;
use super::snapshot::State;
use crate::codec::{self, Encoder as _, FieldIndex, FieldValue, Part, StateHasher};
use crate::integrate::Stage;
use crate::scalar::Scalar;
use crate::slots::{BodyId, FieldId};
use crate::world::{BodyRef, Trace, World};

/// What of a world a value belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Owner {
    /// The world as a whole.
    World,
    /// A body.
    Body(BodyId),
    /// A force field.
    ForceField(FieldId),
}

impl fmt::Display for Owner {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::World => f.write_str("the world"),
            Self::Body(body) => body.fmt(f),
            Self::ForceField(field) => field.fmt(f),
        }
    }
}

/// A value in which two states differ.
///
/// ```
/// use umbra_physics::{BodyDef, Difference, Owner, World, WorldDef, vec2};
///
/// let mut world: World = World::new(WorldDef::default())?;
/// let body = world.add_body(BodyDef::dynamic())?;
/// let mut other = world.clone();
/// other.set_gravity(vec2(0, -10))?;
/// other.set_velocity(body, vec2(1, 0))?;
/// let found: Vec<Difference> = world.differences(&other);
/// assert_eq!((found[0].place, &found[0].field[..]), (Owner::World, "settings.gravity.y"));
/// assert_eq!((found[1].place, found[1].right.as_deref()), (Owner::Body(body), Some("1")));
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Difference {
    /// What it belongs to.
    pub place: Owner,
    /// Its name there, as `position.x`.
    pub field: String,
    /// What it is in the first state, exactly; `None` where that has no such value.
    pub left: Option<String>,
    /// What it is in the second.
    pub right: Option<String>,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let value = |value: &Option<String>| value.clone().unwrap_or_else(|| "nothing".to_string());
        write!(f, "{}, {}: {} and {}", self.place, self.field, value(&self.left), value(&self.right))
    }
}

/// A path as a name: `bodies[3].position.x`.
pub(super) fn name_of(path: &[Part]) -> String {
    let mut name = String::new();
    for part in path {
        match part {
            Part::Name(part) if name.is_empty() => name.push_str(part),
            Part::Name(part) => name.push_str(&format!(".{part}")),
            Part::Entry(index) => name.push_str(&format!("[{index}]")),
        }
    }
    name
}

impl<S: Scalar> World<S> {
    /// Every value in which the states of two worlds differ, in the order of a snapshot: the world's own, then those of
    /// its bodies, then those of its force fields. Equal states have none.
    ///
    /// It is for finding out what went wrong, and takes its time.
    #[must_use]
    pub fn differences(&self, other: &Self) -> Vec<Difference> {
        let (left, right) = (FieldIndex::of(&State(self)).leaves, FieldIndex::of(&State(other)).leaves);
        let mut rest: BTreeMap<&[Part], &FieldValue> = right.iter().map(|leaf| (&leaf.path[..], leaf)).collect();
        let mut found = Vec::new();
        for leaf in &left {
            let there = rest.remove(&leaf.path[..]);
            if there.is_none_or(|there| there.bytes != leaf.bytes) {
                found.push(self.difference(&leaf.path, Some(leaf), there));
            }
        }
        found.extend(rest.into_iter().map(|(path, there)| other.difference(path, None, Some(there))));
        found
    }

    /// The first of them, without making the others: in little memory, however much differs.
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
    /// assert_eq!(first.to_string(), "the world, tick: 0 and 1");
    /// assert_eq!(world.differences(&other).first(), Some(&first));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[must_use]
    pub fn first_difference(&self, other: &Self) -> Option<Difference> {
        let (left, right) = codec::first_difference(&State(self), &State(other))?;
        let (owner, path) = match (&left, &right) {
            (Some(leaf), _) => (self, &leaf.path),
            (None, Some(leaf)) => (other, &leaf.path),
            (None, None) => return None,
        };
        let right = right.as_ref().filter(|leaf| leaf.path == *path);
        Some(owner.difference(path, left.as_ref(), right))
    }

    fn difference(&self, path: &[Part], left: Option<&FieldValue>, right: Option<&FieldValue>) -> Difference {
        let (place, path) = self.place(path);
        let text = |leaf: Option<&FieldValue>| leaf.map(|leaf| leaf.text.clone());
        Difference { place, field: name_of(path), left: text(left), right: text(right) }
    }

    /// What the value at a path belongs to, and the rest of the path.
    pub(super) fn place<'p>(&self, path: &'p [Part]) -> (Owner, &'p [Part]) {
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

impl<S: Scalar> BodyRef<'_, S> {
    /// The first value in which the body differs from another one, of this world or another, handles apart: definition, shape,
    /// motion, rest. `None` if there is none; what was applied since the last step is not compared.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, Owner, World, WorldDef, vec2};
    ///
    /// let mut world: World = World::new(WorldDef::default())?;
    /// let [a, b] = [1, 2].map(|x| world.add_body(BodyDef { velocity: vec2(x, 0), ..BodyDef::dynamic() }));
    /// let (a, b) = (world.body(a?)?, world.body(b?)?);
    /// let found = a.first_difference(&b).unwrap();
    /// assert_eq!((found.place, &found.field[..]), (Owner::Body(a.id()), "velocity.x"));
    /// assert_eq!(a.first_difference(&a), None);
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[must_use]
    pub fn first_difference(&self, other: &BodyRef<'_, S>) -> Option<Difference> {
        let leaves = |body: &BodyRef<'_, S>| {
            let (world, dense) = body.parts();
            let mut leaves = FieldIndex::of(&world.bodies.record(dense, &world.factor_table)).leaves;
            leaves.extend(body.shape().into_iter().flat_map(|shape| FieldIndex::of(shape).leaves));
            leaves
        };
        first_unlike(Owner::Body(self.id()), &leaves(self), &leaves(other))
    }
}

/// The first value that is not the same in two records of one thing.
fn first_unlike(place: Owner, left: &[FieldValue], right: &[FieldValue]) -> Option<Difference> {
    let text = |leaf: Option<&FieldValue>| leaf.map(|leaf| leaf.text.clone());
    let named = |path: &[Part], left, right| {
        let (left, right) = (text(left), text(right));
        Difference { place, field: name_of(path), left, right }
    };
    let pairs = left.iter().map(|leaf| (leaf, right.iter().find(|there| there.path == leaf.path)));
    let mut unlike = pairs.filter(|(leaf, there)| there.is_none_or(|there| there.bytes != leaf.bytes));
    if let Some((leaf, there)) = unlike.next() {
        return Some(named(&leaf.path, Some(leaf), there));
    }
    let more = right.iter().find(|leaf| left.iter().all(|here| here.path != leaf.path));
    more.map(|leaf| named(&leaf.path, None, Some(leaf)))
}

/// A tree of hashes over a state or a step: a peer that has another root asks for one level after the other, and finds
/// where the two part without sending either state.
///
/// XXH3, 64 bits: of a value its bytes, of a node the hashes below it.
///
/// ```
/// use umbra_physics::{BodyDef, HashTree, World, WorldDef, vec2};
///
/// let mut here: World = World::new(WorldDef::default())?;
/// let body = here.add_body(BodyDef { velocity: vec2(1, 0), ..BodyDef::dynamic() })?;
/// let mut there = here.clone();
/// there.set_velocity(body, vec2(2, 0))?;
/// let (ours, theirs) = (HashTree::of(&here), HashTree::of(&there));
/// assert_eq!(ours.first_difference(&theirs).unwrap().join("."), "tick 0.bodies.0.velocity.x");
///
/// // Of a step: the state after each of its stages. Trees of many ticks are one tree.
/// let trace = here.step_traced();
/// let step = HashTree::of_step(&trace, &here);
/// assert_eq!(step.parts.len(), trace.stages().len() + 1);
/// let match_so_far = HashTree::group("match".into(), vec![ours, step]);
/// assert_eq!(match_so_far.first_difference(&match_so_far), None);
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct HashTree {
    /// The name of the part: `bodies`, `3`, `position`, `x`.
    pub name: String,
    /// The hash of all that is below, or of the value.
    pub hash: u64,
    /// Its parts; none for a value.
    pub parts: Vec<HashTree>,
}

impl HashTree {
    /// The tree of a state, by its parts, bodies and fields.
    #[must_use]
    pub fn of<S: Scalar>(world: &World<S>) -> Self {
        let leaves = FieldIndex::of(&State(world)).leaves;
        Self::over(format!("tick {}", world.tick()), &leaves, 0)
    }

    /// The tree of a step: the state after each of its stages, and at its end.
    #[must_use]
    pub fn of_step<S: Scalar>(trace: &Trace<S>, end: &World<S>) -> Self {
        let stage = |(index, (stage, world)): (u32, (&Stage, &World<S>))| {
            let phase = TickPhase::Stage { index, kind: stage.kind };
            Self { name: phase.to_string(), ..Self::of(world) }
        };
        let mut parts: Vec<Self> = (0..).zip(trace.stages()).map(stage).collect();
        parts.push(Self { name: TickPhase::End.to_string(), ..Self::of(end) });
        Self::group(format!("tick {}", end.tick()), parts)
    }

    /// A node over trees that were made before.
    #[must_use]
    pub fn group(name: String, parts: Vec<Self>) -> Self {
        let mut sink = StateHasher::new();
        parts.iter().for_each(|part| sink.bytes(&part.hash.to_le_bytes()));
        Self { name, hash: sink.finish(), parts }
    }

    /// The node over leaves that have the first `depth` parts of their paths in common.
    fn over(name: String, leaves: &[FieldValue], depth: usize) -> Self {
        let mut parts = Vec::new();
        let mut rest = leaves;
        while let Some(first) = rest.first() {
            let Some(part) = first.path.get(depth) else {
                // The value of the node itself: the number of a list, the variant of a choice.
                let mut sink = StateHasher::new();
                sink.bytes(&first.bytes);
                parts.push(Self { name: String::new(), hash: sink.finish(), parts: Vec::new() });
                rest = &rest[1..];
                continue;
            };
            let count = rest.iter().take_while(|leaf| leaf.path.get(depth) == Some(part)).count();
            let (own, others) = rest.split_at(count);
            let name = match part {
                Part::Name(name) => (*name).to_string(),
                Part::Entry(index) => index.to_string(),
            };
            parts.push(Self::over(name, own, depth + 1));
            rest = others;
        }
        match <[Self; 1]>::try_from(parts) {
            // A lone value is the node.
            Ok([lone]) if lone.name.is_empty() => Self { name, ..lone },
            Ok(lone) => Self::group(name, lone.into()),
            Err(parts) => Self::group(name, parts),
        }
    }

    /// The names on the way to the first value in which two trees differ; `None` if they are equal.
    #[must_use]
    pub fn first_difference<'a>(&'a self, other: &'a Self) -> Option<Vec<&'a str>> {
        if self.hash == other.hash {
            return None;
        }
        let mut path = alloc::vec![&self.name[..]];
        let (mut left, mut right) = (self, other);
        loop {
            let here = left.parts.iter().zip(&right.parts).find(|(a, b)| a.hash != b.hash || a.name != b.name);
            match here {
                Some((a, b)) if a.name == b.name => {
                    (left, right) = (a, b);
                    path.push(&a.name);
                }
                Some((a, _)) => {
                    path.push(&a.name);
                    return Some(path);
                }
                None => {
                    // One has more parts than the other, or they are values.
                    let longer = if left.parts.len() > right.parts.len() { left } else { right };
                    let more = longer.parts.get(left.parts.len().min(right.parts.len()));
                    path.extend(more.map(|part| &part.name[..]));
                    return Some(path);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use alloc::string::ToString as _;

    use super::*;

    #[test]
    fn what_one_of_two_records_alone_has_is_unlike() {
        let leaf = |name| FieldValue {
            path: alloc::vec![Part::Name(name)],
            at: 0,
            bytes: alloc::vec![1],
            text: "1".to_string(),
        };
        let found = |left: &[FieldValue], right: &[FieldValue]| {
            first_unlike(Owner::World, left, right).map(|Difference { field, left, right, .. }| (field, left, right))
        };
        let (b, one) = ("b".to_string(), Some("1".to_string()));
        assert_eq!(found(&[leaf("a")], &[leaf("a")]), None);
        assert_eq!(found(&[leaf("a")], &[leaf("a"), leaf("b")]), Some((b.clone(), None, one.clone())));
        assert_eq!(found(&[leaf("a"), leaf("b")], &[leaf("a")]), Some((b, one, None)));
    }

    #[test]
    fn a_part_that_one_of_two_trees_alone_has_is_named() {
        let leaf = |name: &str| HashTree::group(name.to_string(), Vec::new());
        let all = |parts: Vec<HashTree>| HashTree::group("all".to_string(), parts);
        let (one, two) = (all(alloc::vec![leaf("a")]), all(alloc::vec![leaf("a"), leaf("b")]));
        for (left, right) in [(&one, &two), (&two, &one)] {
            assert_eq!(left.first_difference(right), Some(alloc::vec!["all", "b"]));
        }
        // Parts of other names are not looked into.
        let (a, b) = (HashTree::group("a".to_string(), alloc::vec![leaf("c")]), leaf("b"));
        assert_eq!(all(alloc::vec![a]).first_difference(&all(alloc::vec![b])), Some(alloc::vec!["all", "a"]));
    }
}
