//! Trees of hashes, to find where two states differ from afar.

use alloc::format;
use alloc::string::{String, ToString};
use alloc::vec::Vec;

use super::difference::TickPhase;
use crate::codec::{Encoder as _, FieldIndex, FieldValue, Part, StateHasher};
use crate::integrate::Stage;
use crate::replay::snapshot::State;
use crate::scalar::Scalar;
use crate::world::{Trace, World};

/// A tree of hashes over a state or a step. A peer whose root differs asks for one level after the other, and finds where the
/// two differ without either state being sent.
///
/// The hashes are XXH3, 64 bits: a leaf hashes the bytes of a value, a node the hashes below it.
///
/// ```
/// use umbra_physics::{BodyDef, HashTree, World, WorldDef, vec2};
///
/// let mut world = World::new(WorldDef::default())?;
/// let body = world.add_body(BodyDef { velocity: vec2(1, 0), ..BodyDef::dynamic() })?;
/// let mut peer = world.clone();
/// peer.set_velocity(body, vec2(2, 0))?;
/// let (ours, theirs) = (HashTree::of(&world), HashTree::of(&peer));
/// assert_eq!(ours.first_difference(&theirs).unwrap().join("."), "tick 0.bodies.0.velocity.x");
///
/// // The tree of a step has the state after each stage. Trees of many ticks can be grouped into one.
/// let trace = world.step_traced();
/// let step = HashTree::of_step(&trace, &world);
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
    /// The hash of the parts below, or of the value.
    pub hash: u64,
    /// The parts below; empty for a value.
    pub parts: Vec<HashTree>,
}

impl HashTree {
    /// Builds the tree of a state, by its parts, bodies and fields.
    #[must_use]
    pub fn of<S: Scalar>(world: &World<S>) -> Self {
        S::hash_tree(world)
    }

    pub(crate) fn of_inner<S: Scalar>(world: &World<S>) -> Self {
        let leaves = FieldIndex::of(&State(world)).leaves;
        Self::over(format!("tick {}", world.tick()), &leaves, 0)
    }

    /// Builds the tree of a step: the state after each of its stages, and at its end. Its tick is that of the world before the
    /// step, as in a [`Difference`](super::Difference).
    #[must_use]
    pub fn of_step<S: Scalar>(trace: &Trace<S>, end: &World<S>) -> Self {
        let stage = |(index, (stage, world)): (u32, (&Stage, &World<S>))| {
            let phase = TickPhase::Stage { index, kind: stage.kind };
            Self { name: phase.to_string(), ..Self::of(world) }
        };
        let mut parts: Vec<Self> = (0..).zip(trace.stages()).map(stage).collect();
        parts.push(Self { name: TickPhase::End.to_string(), ..Self::of(end) });
        let tick = trace.stages().next().map_or(end.tick(), |(_, world)| world.tick());
        Self::group(format!("tick {tick}"), parts)
    }

    /// Puts a node over trees that were built before.
    #[must_use]
    pub fn group(name: String, parts: Vec<Self>) -> Self {
        let mut sink = StateHasher::new();
        parts.iter().for_each(|part| sink.bytes(&part.hash.to_le_bytes()));
        Self { name, hash: sink.finish(), parts }
    }

    /// Builds the node over leaves that have the first `depth` parts of their paths in common.
    fn over(name: String, leaves: &[FieldValue], depth: usize) -> Self {
        let mut parts = Vec::new();
        let mut rest = leaves;
        while let Some(first) = rest.first() {
            let Some(part) = first.path.get(depth) else {
                // A value of the node itself: the length of a list, the variant of an enum.
                let mut sink = StateHasher::new();
                sink.bytes(&first.bytes);
                parts.push(Self { name: String::new(), hash: sink.finish(), parts: Vec::new() });
                rest = &rest[1..];
                continue;
            };
            let count = rest.iter().take_while(|leaf| leaf.path.get(depth) == Some(part)).count();
            let (children, siblings) = rest.split_at(count);
            let name = match part {
                Part::Name(name) => (*name).to_string(),
                Part::Entry(index) => index.to_string(),
            };
            parts.push(Self::over(name, children, depth + 1));
            rest = siblings;
        }
        match <[Self; 1]>::try_from(parts) {
            // A node over a single value is that value.
            Ok([lone]) if lone.name.is_empty() => Self { name, ..lone },
            Ok(lone) => Self::group(name, lone.into()),
            Err(parts) => Self::group(name, parts),
        }
    }

    /// The names on the path to the first value in which two trees differ; `None` if they are equal.
    #[must_use]
    pub fn first_difference<'a>(&'a self, rhs: &'a Self) -> Option<Vec<&'a str>> {
        if self.hash == rhs.hash {
            return None;
        }
        let mut path = alloc::vec![&self.name[..]];
        let (mut left, mut right) = (self, rhs);
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
    use super::*;

    #[test]
    fn a_part_that_only_one_of_two_trees_has_is_named() {
        let leaf = |name: &str| HashTree::group(name.to_string(), Vec::new());
        let all = |parts: Vec<HashTree>| HashTree::group("all".to_string(), parts);
        let (shorter, longer) = (all(alloc::vec![leaf("a")]), all(alloc::vec![leaf("a"), leaf("b")]));
        for (left, right) in [(&shorter, &longer), (&longer, &shorter)] {
            assert_eq!(left.first_difference(right), Some(alloc::vec!["all", "b"]));
        }
        // Parts with different names are not compared further.
        let (a, b) = (HashTree::group("a".to_string(), alloc::vec![leaf("c")]), leaf("b"));
        assert_eq!(all(alloc::vec![a]).first_difference(&all(alloc::vec![b])), Some(alloc::vec!["all", "a"]));
    }
}
