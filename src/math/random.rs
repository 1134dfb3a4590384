//! Random numbers that are the same on every machine.

use core::ops::RangeInclusive;

#[cfg(feature = "serde")]
use super::serial;
use crate::fx::Fx;

/// A generator of random numbers: xoshiro256**, of period 2^256 − 1. Not for secrets: its future follows from its past.
///
/// A world has one, which snapshots, hashes and replays carry along: see [`World::random`](crate::World::random).
///
/// *Source* Blackman and Vigna, Scrambled Linear Pseudorandom Number Generators, ACM TOMS 47 (2021).
///
/// ```
/// use umbra_physics::{Random, fx};
///
/// let mut dice = Random::seeded(7);
/// let thrown: Vec<u64> = (0..5).map(|_| 1 + dice.below(6)).collect();
/// assert_eq!(thrown, [5, 2, 6, 6, 6]);
/// assert!((fx!(0)..fx!(1)).contains(&dice.fraction()));
/// ```
///
/// ```
/// use umbra_physics::{Random, Turn, fx};
///
/// let mut random = Random::seeded(7);
/// let saved = random.state(); // four words, to be sent or kept
/// let drawn = (random.bits(), random.integer(-3..=3), random.number(fx!(-0.5)..=fx!(0.5)), random.angle());
/// assert!((-3..=3).contains(&drawn.1) && drawn.3 != Turn::default());
/// let mut again = Random::from_state(saved).unwrap();
/// assert_eq!(again.bits(), drawn.0);
///
/// let mut deck: Vec<u32> = (0..52).collect();
/// random.shuffle(&mut deck);
/// assert_ne!(deck[..5], [0, 1, 2, 3, 4]);
///
/// // Streams that never overlap: one for each player, for example.
/// let root = random;
/// let (mut a, mut b) = (random.split(), random.split());
/// assert_ne!(a.bits(), b.bits());
/// // By hand: a stream is a copy, and a jump skips its 2^128 draws.
/// let mut third = root;
/// third.jump();
/// third.jump();
/// assert_eq!(third, random.split());
/// // A generator whose streams overlap with none of `root`'s.
/// let mut far = root;
/// far.long_jump(); // 2^192 draws
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "serial::State", deny_unknown_fields)
)]
pub struct Random {
    state: [u64; 4],
}

impl Default for Random {
    /// The generator seeded with 0.
    fn default() -> Self {
        Self::seeded(0)
    }
}

impl Random {
    /// The generator of a seed: its state is filled by SplitMix64, as its authors ask.
    #[must_use]
    pub fn seeded(seed: u64) -> Self {
        let mut sum = seed;
        let state = core::array::from_fn(|_| {
            sum = sum.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let z = (sum ^ sum >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
            z ^ z >> 31
        });
        Self { state }
    }

    /// The generator in this state; `None` for four zeros, a state that never changes.
    #[must_use]
    pub fn from_state(state: [u64; 4]) -> Option<Self> {
        (state != [0; 4]).then_some(Self { state })
    }

    /// The state, on which all future draws depend.
    #[must_use]
    pub const fn state(&self) -> [u64; 4] {
        self.state
    }

    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        let [a, b, c, d] = &mut self.state;
        let result = b.wrapping_mul(5).rotate_left(7).wrapping_mul(9);
        let shifted = *b << 17;
        *c ^= *a;
        *d ^= *b;
        *b ^= *c;
        *a ^= *d;
        *c ^= shifted;
        *d = d.rotate_left(45);
        result
    }

    /// An integer from 0 to below `end`, each as likely as the others; 0 if `end` is.
    ///
    /// *Source* Lemire, Fast Random Integer Generation in an Interval, ACM TOMACS 29 (2019).
    pub fn below(&mut self, end: u64) -> u64 {
        let mut product = u128::from(self.bits()) * u128::from(end);
        if (product as u64) < end {
            // The lowest of the 2^64 cases are one too many for some results: as many as 2^64 modulo `end`.
            let surplus = end.wrapping_neg() % end;
            while (product as u64) < surplus {
                product = u128::from(self.bits()) * u128::from(end);
            }
        }
        (product >> 64) as u64
    }

    /// An integer of a range, each as likely as the others; its start if it is empty.
    pub fn integer(&mut self, range: RangeInclusive<i64>) -> i64 {
        let (start, end) = (*range.start(), *range.end());
        if start >= end {
            return start;
        }
        let above = match end.wrapping_sub(start).wrapping_add(1) as u64 {
            0 => self.bits(),
            width => self.below(width),
        };
        start.wrapping_add(above as i64)
    }

    /// A number from 0 to below 1: each of the 2^32 there are as likely as the others.
    pub fn fraction(&mut self) -> Fx {
        Fx::from_bits((self.bits() >> 32) as i64)
    }

    /// A number of a range, each as likely as the others; its start if it is empty.
    pub fn number(&mut self, range: RangeInclusive<Fx>) -> Fx {
        Fx::from_bits(self.integer(range.start().to_bits()..=range.end().to_bits()))
    }

    /// Shuffles a list; each order is as likely as the others.
    pub fn shuffle<T>(&mut self, list: &mut [T]) {
        for i in (1..list.len()).rev() {
            list.swap(i, self.below(i as u64 + 1) as usize);
        }
    }

    /// Skips 2^128 draws, to make streams that never overlap: [`split`](Self::split) is a copy and a jump.
    pub fn jump(&mut self) {
        self.leap([0x180e_c6d3_3cfd_0aba, 0xd5a6_1266_f0c9_392c, 0xa958_2618_e03f_c9aa, 0x39ab_dc45_29b1_661c]);
    }

    /// Skips 2^192 draws, to make sets of such streams.
    pub fn long_jump(&mut self) {
        self.leap([0x76e1_5d3e_fefd_cbbf, 0xc500_4e44_1c52_2fb3, 0x7771_0069_854e_e241, 0x3910_9bb0_2acb_e635]);
    }

    /// A stream of 2^128 draws, as a generator; this one continues behind them.
    ///
    /// Split all streams from one generator. Neither split nor [jump](Self::jump) a stream itself: behind its draws the next
    /// stream begins.
    #[must_use]
    pub fn split(&mut self) -> Self {
        let stream = *self;
        self.jump();
        stream
    }

    fn leap(&mut self, polynomial: [u64; 4]) {
        let mut sum = [0; 4];
        for word in polynomial {
            for bit in 0..64 {
                if word >> bit & 1 == 1 {
                    sum.iter_mut().zip(self.state).for_each(|(sum, word)| *sum ^= word);
                }
                self.bits();
            }
        }
        self.state = sum;
    }
}
