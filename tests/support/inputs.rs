//! Inputs for the kernels, by kind.

#[path = "seeds.rs"]
mod seeds;

/// SplitMix64 (Steele, Lea and Flood 2014).
#[derive(Clone)]
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// The generator of a test, by the usual seed.
    pub(crate) fn seeded(usual: u64) -> Self {
        Self(seeds::run_seed(usual))
    }

    pub(crate) fn next(&mut self) -> i64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as i64
    }

    /// Values of either sign, every magnitude from 2^0 to 2^62 equally likely.
    pub(crate) fn next_by_exponent(&mut self) -> i64 {
        let bits = self.next();
        let shift = (self.next() as u64 % 63) as u32;
        bits >> shift
    }

    /// From `low` up to, but not including, `high`.
    pub(crate) fn within(&mut self, low: i64, high: i64) -> i64 {
        low + (self.next() as u64 % low.abs_diff(high)) as i64
    }
}

/// Every power of two, its neighbours, their negatives, zero and the ends of the range.
pub(crate) fn edges() -> Vec<i64> {
    let mut edges: Vec<i64> = (0..64)
        .flat_map(|k| (-2..=2).map(move |d| (1i64 << k).wrapping_add(d)))
        .flat_map(|raw| [raw, raw.wrapping_neg()])
        .collect();
    edges.sort_unstable();
    edges.dedup();
    edges
}
