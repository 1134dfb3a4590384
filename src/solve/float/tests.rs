//! Impulses as integers.

use super::{in_units, newton_seconds};
use crate::cases::run_seed;
use crate::math::Random;

#[test]
fn impulses_come_back() {
    let mut random = Random::seeded(run_seed(2));
    for _ in 0..10_000 {
        let size = libm::scalbn(1.0, random.below(60) as i32 - 30);
        let values = [0, 1, 2].map(|k| {
            let fraction = random.below(1 << 24) as f64 / f64::from(1 << 24);
            size * if k == 2 { 2.0 * fraction - 1.0 } else { fraction }
        });
        let impulses = in_units(values);
        assert!(impulses.values.iter().all(|value| value.unsigned_abs() <= 1 << 62));
        let largest = values.into_iter().map(f64::abs).fold(0.0, f64::max);
        for (value, restored) in values.into_iter().zip(newton_seconds(impulses)) {
            assert!((value - restored).abs() <= largest * f64::EPSILON / 256.0, "{value:e} {restored:e}");
        }
    }
}

#[test]
fn impulses_that_are_no_numbers_count_as_zero() {
    assert_eq!(in_units([f64::NAN, f64::INFINITY, f64::NEG_INFINITY]).values, [0; 3]);
    assert_eq!(newton_seconds(in_units([f64::NAN, 2.0, -1.0])), [0.0, 2.0, -1.0]);
    // Beyond the range of a record.
    let [largest, smallest, _] = in_units([f64::MAX, f64::MIN_POSITIVE, 0.0]).values;
    assert_eq!((largest, smallest), (1 << 62, 0));
}
