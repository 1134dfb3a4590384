//! Limits on the number of pairs, and the rule by which colliders are left out.

use super::{BroadPhase, Standing, Statics, key, pair};

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
}

impl Default for PairLimits {
    /// 2^20 pairs, and 256 of one collider.
    fn default() -> Self {
        Self { pairs: 1 << 20, per_collider: 256 }
    }
}

impl BroadPhase {
    /// Lists the colliders with too many pairs, and the pairs of the others: a function of the graph of pairs and of the limits.
    ///
    /// *Domain* the tree holds the boxes as they are, without margins. No collider's pairs are counted beyond the cap, so that time grows
    /// with the number of colliders times the cap.
    #[cold]
    pub(super) fn cap(&mut self, still: &Standing<'_>, limits: &PairLimits) {
        let colliders = still.trees().map(Statics::len).fold(self.movers.len(), usize::saturating_add);
        let most = limits.per_collider.min(colliders) as u32;
        self.degrees.clear();
        self.degrees.resize(self.entries.len(), 0);
        for i in 0..self.movers.len() {
            let mut degree = 0;
            self.neighbours(still, self.movers[i], |_, _| {
                degree += 1;
                degree <= most
            });
            self.degrees[self.movers[i] as usize] = degree;
        }
        // By cap, the number of pairs that need it: the larger number of pairs of its two colliders.
        let mut needs = core::mem::take(&mut self.needs);
        needs.clear();
        needs.resize(most as usize + 1, 0);
        self.pairs_within(still, most, |_, need| needs[need as usize] += 1);
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
        self.pairs_within(still, cap, |key, _| pairs.push(pair(key)));
        pairs.sort_unstable();
        self.pairs = pairs;
        let is_above = |&collider: &u32| self.degrees[collider as usize] > cap;
        self.above_cap.extend(self.movers.iter().copied().filter(is_above));
        self.above_cap.sort_unstable();
    }

    /// Calls `each` with every pair of colliders that have at most `cap` pairs, and with the larger number of pairs of the two.
    fn pairs_within(&self, still: &Standing<'_>, cap: u32, mut each: impl FnMut(u64, u32)) {
        for &collider in &self.movers {
            let own = self.degrees[collider as usize];
            if own > cap {
                continue;
            }
            self.neighbours(still, collider, |other, moves| {
                let need = if moves { own.max(self.degrees[other as usize]) } else { own };
                // Two that move find each other.
                if need <= cap && (!moves || collider < other) {
                    each(key(collider, other), need);
                }
                true
            });
        }
    }

    /// Calls `found` with each collider that makes a pair with this one, and with whether it moves, until it returns false.
    fn neighbours(&self, still: &Standing<'_>, collider: u32, mut found: impl FnMut(u32, bool) -> bool) {
        let entry = &self.entries[collider as usize];
        let extent = entry.extent();
        let mut goes_on = true;
        self.tree.search(0, &extent, |other| {
            if entry.may_meet(&self.entries[other as usize]) {
                goes_on = found(other, true);
            }
            goes_on
        });
        for tree in still.trees() {
            if goes_on {
                tree.search(&extent, |other| {
                    goes_on = !entry.filter.agrees(other.filter) || found(other.collider, false);
                    goes_on
                });
            }
        }
    }
}
