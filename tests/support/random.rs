//! Random numbers.

#[path = "seeds.rs"]
pub(crate) mod seeds;

/// A generator of test inputs (Steele, Lea and Flood 2014).
pub(crate) struct SplitMix(pub(crate) u64);

// Each test takes what it needs.
#[allow(dead_code, reason = "each test that takes this file in uses a part of it")]
impl SplitMix {
    /// The generator of a test, by the usual seed.
    pub(crate) fn seeded(usual: u64) -> Self {
        Self(seeds::run_seed(usual))
    }

    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Between the two, the first included.
    pub(crate) fn between(&mut self, low: i64, high: i64) -> i64 {
        low + (self.next() % high.abs_diff(low)) as i64
    }

    /// A value of either sign, uniform in its number of bits.
    pub(crate) fn of_bits(&mut self, max_bits: u32) -> i64 {
        let bits = 1 + self.next() % u64::from(max_bits);
        let magnitude = (self.next() >> (64 - bits)) as i64;
        if self.next() & 1 == 0 { magnitude } else { -magnitude }
    }
}
