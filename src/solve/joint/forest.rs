//! Sets of joined bodies: whether they are trees, and the order in which a tree is solved.
//!
//! A set of bodies that joints connect is a tree if it has one joint less than bodies; joints to bodies that cannot be moved do not count.
//! Bodies with at most one joint left are taken off, all at once, round by round, until one body is left or two that are joined: so the
//! *centre* of a tree, a body or a joint, and all sums on the way there follow from the graph alone, in whatever order bodies and joints
//! stand. All other sets are *loops*, and sets with gears or pulleys, whose rows are not of one angle or axis.
//!
//! Reads: the bodies of joints. Writes: [`Forest`], anew when joints or the bodies that they can move have changed since the step before.

use alloc::vec::Vec;
use core::ops::Range;

use crate::slots::NONE;
use crate::solve::graph::Graph;
use crate::solve::{Flight, Joint};

/// A node of a tree with the joint to its parent, the node next to it on the way to the centre: a body, a support, which is the end of a
/// joint to a body that cannot be moved, or the middle of the joint at the centre.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place {
    /// [`NONE`] for a support and for a joint.
    pub(super) body: u32,
    /// The number of the parent; [`NONE`] for the centre.
    pub(super) parent: u32,
    /// The block of the joint to the parent; [`NONE`] for the centre.
    pub(super) block: u32,
    /// The side of that joint on which the node is.
    pub(super) side: usize,
    /// The number of nodes whose parent it is.
    pub(super) children: u32,
}

/// All sets of joined bodies.
#[derive(Clone, Debug, Default)]
pub(in crate::solve) struct Forest {
    /// The bodies of joints, [`NONE`] for bodies that cannot be moved: all that the rest follows from.
    links: Vec<[u32; 2]>,
    /// True for joints that make a loop alone.
    are_loops: Vec<bool>,
    /// The joints that can move a body, in the order of their blocks: tree by tree, then loop by loop.
    pub(in crate::solve) order: Vec<u32>,
    /// The nodes of trees, tree by tree: parents come after their children.
    pub(super) places: Vec<Place>,
    /// The nodes of each tree.
    pub(super) trees: Vec<Range<usize>>,
    /// The blocks of each loop.
    pub(super) loops: Vec<Range<usize>>,
    /// Tree by body, [`NONE`] for bodies in none. Bodies after the last one with a joint may be missing.
    tree_of: Vec<u32>,
    work: Work,
}

/// Memory for finding the sets.
#[derive(Clone, Debug, Default)]
struct Work {
    graph: Graph,
    /// By body: the number of joints to bodies that are left, and the exclusive or of the numbers of these joints.
    degree: Vec<u32>,
    joints_left: Vec<u32>,
    /// The node by body.
    node_of: Vec<u32>,
    /// Bodies and joints by set.
    bodies: Sorted,
    joints: Sorted,
}

/// Numbers sorted by set.
#[derive(Clone, Debug, Default)]
struct Sorted {
    numbers: Vec<u32>,
    /// The end of each set.
    ends: Vec<u32>,
}

impl Sorted {
    /// Sorts the numbers whose sets are not [`NONE`].
    fn sort(&mut self, sets: usize, set_of: impl Iterator<Item = u32> + Clone) {
        let Self { numbers, ends } = self;
        ends.clear();
        ends.resize(sets + 1, 0);
        let members = || (0..).zip(set_of.clone()).filter(|&(_, set)| set != NONE);
        members().for_each(|(_, set)| ends[set as usize + 1] += 1);
        (0..sets).for_each(|set| ends[set + 1] += ends[set]);
        numbers.clear();
        numbers.resize(ends[sets] as usize, 0);
        // Each entry is the beginning of its set at first, and then the end.
        for (number, set) in members() {
            let end = &mut ends[set as usize];
            numbers[*end as usize] = number;
            *end += 1;
        }
    }

    /// The part of a set.
    fn range(&self, set: usize) -> Range<usize> {
        let begin = if set == 0 { 0 } else { self.ends[set - 1] };
        begin as usize..self.ends[set] as usize
    }
}

impl Work {
    /// Sorts bodies and joints by set, and counts the joints at each body.
    fn sort(&mut self, flights: &[Flight], joints: &[Joint], links: &[[u32; 2]]) {
        let Self { graph, degree, joints_left, node_of, bodies, joints: sorted_joints } = self;
        graph.build_islands(
            |body| flights[body as usize].is_fixed(),
            flights.len(),
            joints.iter().map(|joint| joint.bodies),
        );
        for numbers in [&mut *degree, joints_left, node_of] {
            numbers.clear();
            numbers.resize(flights.len(), 0);
        }
        for (number, link) in (0..).zip(links).filter(|(_, link)| !link.contains(&NONE)) {
            for &body in link {
                degree[body as usize] += 1;
                joints_left[body as usize] ^= number;
            }
        }
        let sets = graph.islands();
        bodies.sort(sets, (0..flights.len() as u32).map(|body| graph.island_of(body).unwrap_or(NONE)));
        let set_of = |link: &[u32; 2]| link.iter().find_map(|&body| graph.island_of(body)).unwrap_or(NONE);
        sorted_joints.sort(sets, links.iter().map(set_of));
    }
}

impl Forest {
    #[cfg(test)]
    pub(super) fn capacity(&self) -> usize {
        self.links.capacity() + self.order.capacity() + self.places.capacity()
    }

    /// Finds the trees and loops of joints, if they have changed since the step before.
    pub(in crate::solve) fn update(&mut self, flights: &[Flight], joints: &[Joint]) {
        let movable = |body: u32| if flights[body as usize].is_fixed() { NONE } else { body };
        let links = joints.iter().map(|joint| joint.bodies.map(movable));
        let are_loops = joints.iter().map(|joint| joint.kind.is_loop());
        if self.links.iter().copied().eq(links.clone()) && self.are_loops.iter().copied().eq(are_loops.clone()) {
            return;
        }
        self.links.clear();
        self.links.extend(links);
        self.are_loops.clear();
        self.are_loops.extend(are_loops);
        self.work.sort(flights, joints, &self.links);
        self.order.clear();
        self.places.clear();
        self.trees.clear();
        self.loops.clear();
        self.tree_of.clear();
        self.tree_of.resize(flights.len(), NONE);
        // Trees first.
        let sets = self.work.graph.islands();
        for set in 0..sets {
            if self.is_tree(set) {
                self.add_tree(set);
            }
        }
        for set in 0..sets {
            if !self.is_tree(set) {
                self.add_loop(set);
            }
        }
    }

    /// The blocks of each set.
    #[cfg(feature = "float")]
    pub(in crate::solve) fn sets(&self) -> impl Iterator<Item = Range<usize>> + '_ {
        let trees = self.trees.iter().scan(0, |begin, places| {
            let blocks = self.places[places.clone()].iter().map(|place| place.block).filter(|&block| block != NONE);
            let end = blocks.max().map_or(*begin, |block| block as usize + 1);
            Some(core::mem::replace(begin, end)..end)
        });
        trees.chain(self.loops.iter().cloned())
    }

    /// The tree of a body.
    pub(super) fn tree_of(&self, body: u32) -> Option<usize> {
        self.tree_of.get(body as usize).copied().filter(|&tree| tree != NONE).map(|tree| tree as usize)
    }

    /// Returns true if a set has one joint less than bodies, and none that makes a loop alone.
    fn is_tree(&self, set: usize) -> bool {
        let Self { links, are_loops, work: Work { bodies, joints, .. }, .. } = self;
        let joints = &joints.numbers[joints.range(set)];
        let is_inner = |&&joint: &&u32| !links[joint as usize].contains(&NONE);
        joints.iter().filter(is_inner).count() + 1 == bodies.range(set).len()
            && !joints.iter().any(|&joint| are_loops[joint as usize])
    }

    /// Adds the blocks of a set that is no tree.
    fn add_loop(&mut self, set: usize) {
        let begin = self.order.len();
        let joints = &self.work.joints;
        self.order.extend_from_slice(&joints.numbers[joints.range(set)]);
        self.loops.push(begin..self.order.len());
    }

    /// Adds the nodes of a tree, with the bodies of parents in place of their nodes at first.
    fn add_tree(&mut self, set: usize) {
        let Self { links, order, places, trees, tree_of, work, .. } = self;
        let Work { degree, joints_left, node_of, bodies, joints, .. } = work;
        let begin = places.len();
        for &joint in &joints.numbers[joints.range(set)] {
            let link = links[joint as usize];
            if let Some(side) = link.iter().position(|&body| body == NONE) {
                let parent = link[1 - side];
                places.push(Place { body: NONE, parent, block: order.len() as u32, side, children: 0 });
                order.push(joint);
            }
        }
        let members = &bodies.numbers[bodies.range(set)];
        let leaf = |body: u32| Place { body, parent: NONE, block: NONE, side: 0, children: 0 };
        let mut round = places.len();
        for &body in members {
            tree_of[body as usize] = trees.len() as u32;
            if degree[body as usize] <= 1 {
                places.push(leaf(body));
            }
        }
        let mut left = members.len();
        while left > 2 {
            let end = places.len();
            left -= end - round;
            for node in round..end {
                let body = places[node].body;
                let joint = joints_left[body as usize];
                let link = links[joint as usize];
                let side = usize::from(link[1] == body);
                let parent = link[1 - side];
                places[node] = Place { body, parent, block: order.len() as u32, side, children: 0 };
                order.push(joint);
                degree[parent as usize] -= 1;
                joints_left[parent as usize] ^= joint;
                if degree[parent as usize] == 1 {
                    places.push(leaf(parent));
                }
            }
            round = end;
        }
        for (node, place) in (0..).zip(&*places).skip(begin).filter(|(_, place)| place.body != NONE) {
            node_of[place.body as usize] = node;
        }
        for place in &mut places[begin..round] {
            place.parent = node_of[place.parent as usize];
        }
        if left == 2 {
            // The last two are joined: the middle of their joint is the parent of both.
            let joint = joints_left[places[round].body as usize];
            for place in &mut places[round..] {
                (place.parent, place.block) = (round as u32 + 2, order.len() as u32);
                place.side = usize::from(links[joint as usize][1] == place.body);
            }
            order.push(joint);
            places.push(leaf(NONE));
        }
        for node in begin..places.len() - 1 {
            let parent = places[node].parent as usize;
            places[parent].children += 1;
        }
        trees.push(begin..places.len());
    }
}
