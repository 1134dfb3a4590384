//! The generator of random numbers is the published one, and what is made of its bits is as likely as it should be.

use rand_xoshiro::Xoshiro256StarStar;
use rand_xoshiro::rand_core::{RngCore, SeedableRng};
use umbra_physics::{Fx, Random, fx};

/// The authors' own, as a crate has it.
fn published(seed: u64) -> Xoshiro256StarStar {
    Xoshiro256StarStar::seed_from_u64(seed)
}

#[test]
fn draws_and_jumps_are_those_of_the_published_generator() {
    for seed in [0, 1, 42, u64::MAX] {
        let (mut ours, mut theirs) = (Random::seeded(seed), published(seed));
        for leap in 0..3 {
            for draw in 0..1_000 {
                assert_eq!(ours.bits(), theirs.next_u64(), "seed {seed}, leap {leap}, draw {draw}");
            }
            if leap == 0 {
                ours.jump();
                theirs.jump();
            } else {
                ours.long_jump();
                theirs.long_jump();
            }
        }
    }
    // From the reference in C, from the state 1, 2, 3, 4.
    let mut ours = Random::from_state([1, 2, 3, 4]).expect("a state");
    assert_eq!(
        [ours.bits(), ours.bits(), ours.bits(), ours.bits()],
        [11_520, 0, 1_509_978_240, 1_215_971_899_390_074_240]
    );
    assert_eq!(Random::from_state([0; 4]), None);
}

#[test]
fn a_stream_that_is_split_off_is_the_one_before_the_jump() {
    let mut ours = Random::seeded(9);
    let before = ours;
    let mut stream = ours.split();
    assert_eq!(stream, before);
    let mut jumped = before;
    jumped.jump();
    assert_eq!(ours, jumped);
    assert_ne!(stream.bits(), ours.bits());
}

/// The counts of what comes, and the largest distance of one from what is expected, in standard deviations.
fn farthest(counts: &[u32], draws: u32) -> f64 {
    let p = 1.0 / counts.len() as f64;
    let (mean, deviation) = (f64::from(draws) * p, (f64::from(draws) * p * (1.0 - p)).sqrt());
    counts.iter().map(|&count| (f64::from(count) - mean).abs() / deviation).fold(0.0, f64::max)
}

#[test]
fn every_result_of_a_range_is_as_likely_as_the_others() {
    let mut random = Random::seeded(5);
    // Where multiplying without rejection errs most: two thirds of 2^64, so that one half would come twice as often.
    let end = 3 << 62;
    let mut counts = [0; 3];
    for _ in 0..300_000 {
        counts[(random.below(end) >> 62) as usize] += 1;
    }
    assert!(farthest(&counts, 300_000) < 5.0, "{counts:?}");
    let mut counts = [0; 7];
    for _ in 0..700_000 {
        counts[random.below(7) as usize] += 1;
    }
    assert!(farthest(&counts, 700_000) < 5.0, "{counts:?}");
    let mut counts = [0; 11];
    for _ in 0..1_100_000 {
        counts[(random.integer(-5..=5) + 5) as usize] += 1;
    }
    assert!(farthest(&counts, 1_100_000) < 5.0, "{counts:?}");
    // All orders of four.
    let mut counts = [0; 24];
    for _ in 0..240_000 {
        let mut list = [0usize, 1, 2, 3];
        random.shuffle(&mut list);
        let [a, b, c, _] = list;
        let second = b - usize::from(b > a);
        let third = c - usize::from(c > a) - usize::from(c > b);
        counts[a * 6 + second * 2 + third] += 1;
    }
    assert!(farthest(&counts, 240_000) < 5.0, "{counts:?}");
}

#[test]
fn draws_stay_in_their_range() {
    let mut random = Random::seeded(6);
    assert_eq!((random.below(0), random.below(1)), (0, 0));
    #[allow(clippy::reversed_empty_ranges, reason = "that is what is tried")]
    let empty = random.integer(3..=2);
    assert_eq!(empty, 3);
    assert_eq!(random.integer(i64::MAX..=i64::MAX), i64::MAX);
    let (mut below, mut above) = (false, false);
    for _ in 0..1_000 {
        let any = random.integer(i64::MIN..=i64::MAX);
        (below, above) = (below | (any < 0), above | (any > 0));
        let fraction = random.fraction();
        assert!(Fx::ZERO <= fraction && fraction < fx!(1));
        let number = random.number(fx!(-0.5)..=fx!(2));
        assert!(fx!(-0.5) <= number && number <= fx!(2));
        assert!((-2..=3).contains(&random.integer(-2..=3)));
    }
    assert!(below && above);
    // Both ends come.
    let ends: Vec<Fx> = (0..64).map(|_| random.number(Fx::ZERO..=Fx::DELTA)).collect();
    assert!(ends.contains(&Fx::ZERO) && ends.contains(&Fx::DELTA));
}
