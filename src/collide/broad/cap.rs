//! Limits on the number of pairs, and the rule by which colliders are left out.

use super::{BroadPhase, RestingTrees, Statics, key, pair};

/// Limits on the number of pairs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PairLimits {
    /// The number of pairs of a step.
    pub pairs: usize,
    /// The number of pairs of one moving collider, where there are more than `pairs`: colliders with more are left out. If there are
    /// still more pairs than `pairs`, this cap is lowered to the largest one at which the pairs of the others are no more than that.
    ///
    /// Static colliders have no cap: a floor may bear any number of boxes.
    pub per_collider: usize,
    /// The number of overlaps that a step looks at: pairs, and overlapping boxes of which one collider at least has a category in the mask
    /// of the other, or a positive group, but which are no pair. With more, each of them counts as a pair does for the other two limits.
    pub overlaps: usize,
}

impl Default for PairLimits {
    /// 2^20 pairs, 256 of one collider, and 2^24 overlaps.
    fn default() -> Self {
        Self { pairs: 1 << 20, per_collider: 256, overlaps: 1 << 24 }
    }
}

impl BroadPhase {
    /// Lists the colliders with too many pairs, and the pairs of the others: a function of the graph of pairs and of the limits.
    ///
    /// With too many overlaps the graph is the graph of overlaps, and the pairs are the overlaps that are pairs.
    ///
    /// *Domain* the tree holds the boxes as they are, without margins. No collider's pairs are counted beyond the cap, so that time grows
    /// with the number of colliders times the cap, and with the overlaps up to their limit.
    #[cold]
    pub(super) fn cap(&mut self, resting: &RestingTrees<'_>, limits: &PairLimits) {
        let colliders = resting.trees().map(Statics::len).fold(self.movers.len(), usize::saturating_add);
        let max_degree = limits.per_collider.min(colliders) as u32;
        let counts_overlaps = self.has_more_overlaps(resting, limits.overlaps);
        self.degrees.clear();
        self.degrees.resize(self.entries.len(), 0);
        for i in 0..self.movers.len() {
            let mut degree = 0;
            self.neighbours(resting, self.movers[i], |neighbour| {
                degree += u32::from(counts_overlaps || neighbour.is_pair);
                degree <= max_degree
            });
            self.degrees[self.movers[i] as usize] = degree;
        }
        // By cap, the number of pairs that need it: the larger number of pairs of its two colliders.
        let mut needs = core::mem::take(&mut self.needs);
        needs.clear();
        needs.resize(max_degree as usize + 1, 0);
        self.pairs_within(resting, max_degree, counts_overlaps, |_, need, _| needs[need as usize] += 1);
        let mut total = 0;
        let fitting = needs.iter().take_while(|&&pairs| {
            total += pairs;
            total <= limits.pairs
        });
        // A collider without pairs never has too many, and nobody has pairs that need a cap of zero.
        let cap = (fitting.count() as u32).saturating_sub(1);
        self.needs = needs;
        let mut pairs = core::mem::take(&mut self.pairs);
        pairs.clear();
        self.pairs_within(resting, cap, counts_overlaps, |key, _, is_pair| {
            if is_pair {
                pairs.push(pair(key));
            }
        });
        pairs.sort_unstable();
        self.pairs = pairs;
        let is_above = |&collider: &u32| self.degrees[collider as usize] > cap;
        self.above_cap.extend(self.movers.iter().copied().filter(is_above));
        self.above_cap.sort_unstable();
    }

    /// Returns true if there are more overlaps than `limit`.
    fn has_more_overlaps(&self, resting: &RestingTrees<'_>, limit: usize) -> bool {
        let mut count = 0;
        self.movers.iter().any(|&collider| {
            self.neighbours(resting, collider, |neighbour| {
                count += usize::from(!neighbour.moves || collider < neighbour.collider);
                count <= limit
            });
            count > limit
        })
    }

    /// Calls `each` with every pair, or every overlap if `counts_overlaps` is true, of colliders that have at most `cap` of them, with the
    /// larger number of the two, and with whether it is a pair.
    fn pairs_within(
        &self,
        resting: &RestingTrees<'_>,
        cap: u32,
        counts_overlaps: bool,
        mut each: impl FnMut(u64, u32, bool),
    ) {
        for &collider in &self.movers {
            let degree = self.degrees[collider as usize];
            if degree > cap {
                continue;
            }
            self.neighbours(resting, collider, |neighbour| {
                let need = if neighbour.moves { degree.max(self.degrees[neighbour.collider as usize]) } else { degree };
                // Two moving colliders find each other.
                let is_first = !neighbour.moves || collider < neighbour.collider;
                if (counts_overlaps || neighbour.is_pair) && need <= cap && is_first {
                    each(key(collider, neighbour.collider), need, neighbour.is_pair);
                }
                true
            });
        }
    }

    /// Calls `visit` with each collider that overlaps this one, until it returns false.
    fn neighbours(&self, resting: &RestingTrees<'_>, collider: u32, mut visit: impl FnMut(Neighbour) -> bool) {
        let entry = &self.entries[collider as usize];
        let extent = entry.extent();
        let mut goes_on = true;
        self.tree.search(
            0,
            |node| node.touches(&extent),
            |mover| {
                if mover != collider {
                    let is_pair = entry.may_meet(&self.entries[mover as usize]);
                    goes_on = visit(Neighbour { collider: mover, moves: true, is_pair });
                }
                goes_on
            },
        );
        for tree in resting.trees() {
            if goes_on {
                tree.search(
                    |node| node.touches(&extent),
                    |proxy| {
                        let is_pair = entry.filter.agrees(proxy.filter);
                        goes_on = visit(Neighbour { collider: proxy.collider, moves: false, is_pair });
                        goes_on
                    },
                );
            }
        }
    }
}

/// A collider whose box overlaps the box of another one.
#[derive(Clone, Copy)]
struct Neighbour {
    collider: u32,
    moves: bool,
    is_pair: bool,
}
