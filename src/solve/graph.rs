//! The graph of touching bodies: islands, levels and the order of contacts.
//!
//! Reads: the pairs of bodies of joints and contacts, masses. Writes: [`Graph`].
//!
//! The level of a body is its distance, in contacts, from the nearest body that cannot be moved. Contacts between bodies of unlike
//! level form two phases, by the lower level being even or odd; contacts between bodies of the same level form the third. An
//! island without such a body starts from its heaviest bodies, among these from the nearest to its centre of mass, all that tie.
//! So the order is a function of the graph and the masses alone.
//!
//! Contacts of a phase do not see each other, so each phase is a Jacobi step. Phases by level make a pass over a pile a red-black
//! Gauss-Seidel step, by which impulses cross it in fewer passes. A colouring would do that too, but depends on the order of bodies.

use alloc::vec::Vec;

use super::Flight;

/// The number of phases of contacts.
pub(crate) const PHASES: usize = 3;

/// No level yet, or no island.
const NONE: u32 = u32::MAX;

/// Islands and levels of bodies.
#[derive(Clone, Debug, Default)]
pub(crate) struct Graph {
    /// The links of the bodies: many bodies rest, and have the same links in each step.
    links: Vec<[u32; 2]>,
    /// True for bodies that cannot be moved.
    is_fixed: Vec<bool>,
    /// Level by body.
    level: Vec<u32>,
    /// Island by body; bodies that cannot be moved have none.
    island: Vec<u32>,
    /// The number of islands.
    islands: u32,
    /// True if there are neighbours and levels for these links.
    has_levels: bool,
    /// The index in `neighbours` of the first neighbour of each body.
    first: Vec<u32>,
    neighbours: Vec<u32>,
    /// Bodies of islands that touch no fixed body, island by island, and the end of each island's part.
    floating: Vec<u32>,
    ends: Vec<u32>,
    /// The bodies that have a level: from bodies that cannot be moved on, level by level; then island by island.
    order: Vec<u32>,
}

impl Graph {
    /// Builds the graph of `links` between bodies. `start` chooses the bodies at which an island without a fixed body
    /// begins. Returns false if the graph is the one that it was before.
    pub(crate) fn build(
        &mut self,
        is_fixed: impl Fn(u32) -> bool,
        bodies: usize,
        links: impl Iterator<Item = [u32; 2]> + Clone,
        start: impl FnMut(&[u32], &mut Vec<u32>),
    ) -> bool {
        self.build_islands(is_fixed, bodies, links);
        if !self.has_levels {
            self.find_neighbours(bodies);
        } else if self.floating.is_empty() {
            return false;
        }
        self.find_levels(bodies, start);
        self.has_levels = true;
        true
    }

    /// Builds the islands alone, without levels and neighbours. They are numbered by their first bodies.
    pub(crate) fn build_islands(
        &mut self,
        is_fixed: impl Fn(u32) -> bool,
        bodies: usize,
        links: impl Iterator<Item = [u32; 2]> + Clone,
    ) {
        let are_fixed = || (0..bodies as u32).map(&is_fixed);
        if links.clone().eq(self.links.iter().copied()) && are_fixed().eq(self.is_fixed.iter().copied()) {
            return;
        }
        let Self { links: known, is_fixed: fixed, island, islands, has_levels, .. } = self;
        *has_levels = false;
        known.clear();
        known.extend(links);
        fixed.clear();
        fixed.extend(are_fixed());
        // At first a body of the same island that comes before, or the body itself.
        island.clear();
        island.resize(bodies, NONE);
        for &link in &*known {
            let [a, b] = link.map(|body| if fixed[body as usize] { NONE } else { first_of(island, body) });
            // A body that cannot be moved joins nothing.
            if a != NONE && b != NONE {
                island[a.max(b) as usize] = a.min(b);
            }
        }
        *islands = 0;
        for body in 0..bodies {
            let before = island[body] as usize;
            if before < body {
                island[body] = island[before];
            } else if before == body {
                island[body] = *islands;
                *islands += 1;
            }
        }
    }

    fn find_neighbours(&mut self, bodies: usize) {
        let Self { links, first, neighbours, .. } = self;
        first.clear();
        first.resize(bodies + 1, 0);
        for &body in links.as_flattened() {
            first[body as usize] += 1;
        }
        let mut end = 0;
        for count in first.iter_mut() {
            end += *count;
            *count = end;
        }
        neighbours.clear();
        neighbours.resize(end as usize, 0);
        // Filled from the end of each body's part, until its end is its beginning; the order does not matter.
        for &[a, b] in &*links {
            for (from, to) in [(a, b), (b, a)] {
                let end = &mut first[from as usize];
                *end -= 1;
                neighbours[*end as usize] = to;
            }
        }
    }

    fn find_levels(&mut self, bodies: usize, mut start: impl FnMut(&[u32], &mut Vec<u32>)) {
        self.level.clear();
        self.level.resize(bodies, NONE);
        self.order.clear();
        self.order.extend((0..bodies as u32).filter(|&body| self.is_fixed[body as usize]));
        // A fixed body gives levels to all bodies of the islands that it touches.
        self.spread(0);
        self.list_floating();
        let mut begin = 0;
        for island in 0..self.ends.len() {
            let end = self.ends[island] as usize;
            if begin < end {
                let next = self.order.len();
                start(&self.floating[begin..end], &mut self.order);
                self.spread(next);
            }
            begin = end;
        }
    }

    /// Lists the bodies of islands whose bodies have no levels.
    fn list_floating(&mut self) {
        let Self { level, island, islands, floating, ends, .. } = self;
        floating.clear();
        ends.clear();
        let bodies =
            || island.iter().zip(&*level).zip(0..).filter(|&((&island, &level), _)| island != NONE && level == NONE);
        let count = bodies().count();
        if count == 0 {
            return;
        }
        ends.resize(*islands as usize + 1, 0);
        for ((&island, _), _) in bodies() {
            ends[island as usize + 1] += 1;
        }
        for island in 0..*islands as usize {
            ends[island + 1] += ends[island];
        }
        floating.resize(count, 0);
        // Each entry is the beginning of its island's part at first, and then the end.
        for ((&island, _), body) in bodies() {
            let end = &mut ends[island as usize];
            floating[*end as usize] = body;
            *end += 1;
        }
    }

    /// Gives the bodies of the order from `first` on level 0, and goes on from there, level by level.
    fn spread(&mut self, first: usize) {
        let Self { level, order, first: first_neighbours, neighbours, .. } = self;
        for &body in &order[first..] {
            level[body as usize] = 0;
        }
        let mut next = first;
        while let Some(&body) = order.get(next) {
            next += 1;
            let above = level[body as usize] + 1;
            let part = first_neighbours[body as usize] as usize..first_neighbours[body as usize + 1] as usize;
            for &neighbour in &neighbours[part] {
                let level = &mut level[neighbour as usize];
                if *level == NONE {
                    *level = above;
                    order.push(neighbour);
                }
            }
        }
    }

    fn neighbours_of(&self, body: u32) -> core::ops::Range<usize> {
        self.first[body as usize] as usize..self.first[body as usize + 1] as usize
    }

    /// Writes for each body the largest mass of the bodies that lie on it: the bodies at a higher level that it touches, and the bodies that
    /// lie on these.
    pub(crate) fn largest_above<M: Copy + Default + PartialOrd>(&self, mass: impl Fn(u32) -> M, largest: &mut Vec<M>) {
        largest.clear();
        largest.resize(self.level.len(), M::default());
        // Bodies above come first. The levels of two bodies that touch differ by one at most.
        for &body in self.order.iter().rev() {
            let mut largest_mass = M::default();
            for i in self.neighbours_of(body) {
                let neighbour = self.neighbours[i];
                if self.level[neighbour as usize] > self.level[body as usize] {
                    for mass_above in [mass(neighbour), largest[neighbour as usize]] {
                        largest_mass = if mass_above > largest_mass { mass_above } else { largest_mass };
                    }
                }
            }
            largest[body as usize] = largest_mass;
        }
    }

    /// The phase of a contact.
    pub(crate) fn phase(&self, [a, b]: [u32; 2]) -> usize {
        let (a, b) = (self.level[a as usize], self.level[b as usize]);
        if a == b { 2 } else { (a.min(b) & 1) as usize }
    }

    /// A body of a contact that can be moved.
    pub(crate) fn mover(&self, bodies: [u32; 2]) -> Option<u32> {
        bodies.into_iter().find(|&body| self.island[body as usize] != NONE)
    }

    /// The island of a body; `None` if it touches nothing or cannot be moved.
    pub(crate) fn island_of(&self, body: u32) -> Option<u32> {
        self.island.get(body as usize).copied().filter(|&island| island != NONE)
    }

    /// The island of two bodies that touch; `None` if neither can be moved.
    pub(crate) fn island_of_link(&self, bodies: [u32; 2]) -> Option<u32> {
        self.mover(bodies).and_then(|body| self.island_of(body))
    }

    /// The number of islands.
    pub(crate) fn islands(&self) -> usize {
        self.islands as usize
    }

    /// The bodies that a body touches.
    pub(crate) fn touched_by(&self, body: u32) -> impl Iterator<Item = u32> + '_ {
        self.neighbours_of(body).map(|i| self.neighbours[i])
    }
}

/// The first body of an island, by bodies that come before each other: ways there become shorter. A body that has none is the first.
#[inline(always)]
fn first_of(before: &mut [u32], mut body: u32) -> u32 {
    if before[body as usize] == NONE {
        before[body as usize] = body;
    }
    while before[body as usize] != body {
        let skipped = before[before[body as usize] as usize];
        before[body as usize] = skipped;
        body = skipped;
    }
    body
}

/// The bodies at which the levels of an island begin that touches no fixed body: the heaviest ones; among these the nearest to
/// the island's centre of mass.
pub(super) fn graph_start(flights: &[Flight], members: &[u32], queue: &mut Vec<u32>) {
    let mass = |body: u32| flights[body as usize].mass.to_bits();
    let total: i128 = members.iter().map(|&body| i128::from(mass(body))).sum();
    let Some(heaviest) = members.iter().map(|&body| mass(body)).max() else { return };
    // All masses together have 60 bits.
    let down = (68 - total.leading_zeros() as i32).max(0);
    let weight = |body: u32| i128::from(mass(body) >> down);
    let weights: i128 = members.iter().map(|&body| weight(body)).sum();
    // Offsets from any member: positions differ by less than 2^31.4 m, 2^63.4 units.
    let origin = flights[members[0] as usize].position;
    let offset = |body: u32| {
        let position = flights[body as usize].position;
        [(position.x, origin.x), (position.y, origin.y)].map(|(x, o)| i128::from(x.to_bits()) - i128::from(o.to_bits()))
    };
    let mut sums = [0; 2];
    for &body in members {
        let offset = offset(body);
        (0..2).for_each(|i| sums[i] += weight(body) * offset[i]);
    }
    // From the centre of mass, times the sum of masses: exact, so that ties are ties. Below 2^124.4.
    let centre_offset = |body: u32| {
        let offset = offset(body);
        [0, 1].map(|i| (weights * offset[i] - sums[i]).unsigned_abs())
    };
    let heavy = || members.iter().copied().filter(|&body| mass(body) == heaviest);
    let Some(farthest) = heavy().flat_map(centre_offset).max() else { return };
    // Down to 62 bits, so that the squares fit.
    let down = (66 - farthest.leading_zeros() as i32).max(0);
    let distance = |body: u32| centre_offset(body).map(|d| (d >> down).pow(2)).into_iter().sum::<u128>();
    let Some(nearest) = heavy().map(distance).min() else { return };
    queue.extend(heavy().filter(|&body| distance(body) == nearest));
}
