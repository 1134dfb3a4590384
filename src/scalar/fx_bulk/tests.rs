//! The loops against the operations on one value.

use alloc::vec::Vec;
use proptest::prelude::*;

use super::super::motion::{Span, Weight};
use super::*;
use crate::cases::cases;

/// Velocities of every size, with the low words where roundings turn.
fn accumulators() -> impl Strategy<Value = Vec<FxAccumulator>> {
    let low = prop_oneof![any::<u64>(), Just(0), Just(1), Just(TIE - 1), Just(TIE), Just(TIE + 1), Just(u64::MAX)];
    let high = (any::<i64>(), 6u32..64).prop_map(|(bits, cut)| bits >> cut);
    let accumulator = (high, low).prop_map(|(high, low)| FxAccumulator { high, low });
    prop::collection::vec(accumulator, 33)
}

fn factor(mantissa: u64, shift: i32) -> FxFactor {
    FxFactor::new(u128::from(mantissa | TIE), shift)
}

/// Compares a loop over many values with the operation on one: over all values at once, and over few at a time.
fn alike<T: Copy + PartialEq + core::fmt::Debug>(
    values: &[T],
    many: impl Fn(usize, &mut [T]),
    single: impl Fn(usize, T) -> T,
) -> Result<(), TestCaseError> {
    let expected: Vec<T> = values.iter().enumerate().map(|(i, v)| single(i, *v)).collect();
    let (mut long, mut short) = (values.to_vec(), values.to_vec());
    many(0, &mut long);
    short.chunks_mut(5).enumerate().for_each(|(k, few)| many(5 * k, few));
    prop_assert_eq!(&long, &expected, "all at once");
    prop_assert_eq!(&short, &expected, "few at a time");
    Ok(())
}

proptest! {
    #![proptest_config(cases(128))]

    #[test]
    fn damping_many_is_damping_each(values in accumulators(), mantissa: u64, close in 0u32..64) {
        // Factors near 1 as well.
        let kept = factor(!(!mantissa >> close), 64);
        alike(&values, |_, v| Fx::damp_all(v, kept), |_, v| v.shrunk(kept))?;
        alike(&values, |_, v| Damp { values: v, mantissa: kept.parts().0 }.run(Portable), |_, v| v.shrunk(kept))?;
    }

    #[test]
    fn damping_to_nearly_nothing_is_damping_each(values in accumulators(), mantissa: u64, shift in 65i32..200) {
        let kept = factor(mantissa, shift);
        alike(&values, |_, v| Fx::damp_all(v, kept), |_, v| v.shrunk(kept))?;
    }

    #[test]
    fn kicking_many_is_kicking_each(values in accumulators(), gained in accumulators()) {
        let gained = gained[0];
        alike(&values, |_, v| Fx::kick_all(v, gained), |_, v| v.plus(gained))?;
        alike(&values, |_, v| Kick { values: v, gained }.run(Portable), |_, v| v.plus(gained))?;
    }

    #[test]
    fn moving_many_is_moving_each(
        positions in accumulators(),
        velocities in accumulators(),
        angles in prop::collection::vec(any::<u64>(), 33),
        (num, den) in (1u32..=10_000).prop_flat_map(|den| (1..=den, Just(den))),
        weight in prop_oneof![Just(Weight::Whole), Just(Weight::YoshidaOuter), Just(Weight::YoshidaInner)],
        half: bool,
    ) {
        let span = Span { ratio: (num, den), weight, half };
        let (seconds, negative) = (Fx::seconds(span), span.is_negative());
        let (mantissa, shift) = seconds.parts();
        let backwards = mask(negative);
        let moved = |at: usize, x: FxAccumulator| {
            let way = velocities[at].value().drift(seconds);
            x.plus(if negative { way.negated() } else { way })
        };
        let of = |at: usize, count: usize| &velocities[at..at + count];
        alike(&positions, |at, x| Fx::drift_all(x, of(at, x.len()), seconds, negative), moved)?;
        // The loops for wide vectors take no span of ½ s or more.
        if let shift @ 1.. = shift - 64 {
            let drift = |at, positions: &mut [_]| {
                let velocities = of(at, positions.len());
                Drift { positions, velocities, mantissa, shift: shift as u32, backwards }.run(Portable);
            };
            alike(&positions, drift, moved)?;
        }
        let angles: Vec<Turn> = angles.into_iter().map(Turn::from_bits).collect();
        let per_turn = Turn::drift_factor(span);
        let (mantissa, shift) = per_turn.parts();
        let turned = |at: usize, angle: Turn| angle.drifted(velocities[at].value(), per_turn, negative);
        let turn = |at, angles: &mut [_]| {
            let velocities = of(at, angles.len());
            TurnAll { angles, velocities, mantissa, shift: shift as u32 - 32, backwards }.run(Portable);
        };
        alike(&angles, |at, x| Fx::turn_all(x, of(at, x.len()), per_turn, negative), turned)?;
        alike(&angles, turn, turned)?;
    }

    #[test]
    fn all_at_once_is_stage_by_stage(
        positions in accumulators(),
        velocities in accumulators(),
        angles in prop::collection::vec(any::<u64>(), 33),
        gravity_delta_v in prop_oneof![Just(FxAccumulator::default()), accumulators().prop_map(|v| v[0])],
        kept in prop_oneof![
            Just(FxFactor::ONE),
            any::<u64>().prop_map(|m| factor(!(!m >> 8), 64)),
            (any::<u64>(), 65i32..140).prop_map(|(m, shift)| factor(m, shift)),
            Just(FxFactor::ZERO),
        ],
        den in 1u32..=10_000,
        negative: bool,
    ) {
        let step = Span { ratio: (1, den), weight: Weight::Whole, half: false };
        let span = KickDriftKick { kept, gravity_delta_v, seconds: Fx::seconds(step), negative };
        let turn_span = DampedTurn { kept, turn: Turn::drift_factor(step), negative };
        let angles: Vec<Turn> = angles.into_iter().map(Turn::from_bits).collect();
        let start = (positions, velocities.clone(), angles, velocities);
        let (mut one, mut many, mut few) = (start.clone(), start.clone(), start);
        kick_drift_kick_in_stages(&mut one.0, &mut one.1, &span);
        damped_turn_in_stages(&mut one.2, &mut one.3, &turn_span);
        Fx::kick_drift_kick_all(&mut many.0, &mut many.1, &span);
        Fx::damped_turn_all(&mut many.2, &mut many.3, &turn_span);
        // Too few for wide vectors.
        few.0.chunks_mut(7).zip(few.1.chunks_mut(7)).for_each(|(x, v)| Fx::kick_drift_kick_all(x, v, &span));
        few.2.chunks_mut(7).zip(few.3.chunks_mut(7)).for_each(|(x, v)| Fx::damped_turn_all(x, v, &turn_span));
        prop_assert_eq!(&many, &one, "many");
        prop_assert_eq!(&few, &one, "few");
    }

    #[test]
    fn values_reported_as_within_bounds_are(values in accumulators(), log2 in 0u32..31) {
        let limit = Fx::from_bits(1 << (32 + log2));
        if Fx::are_within(&values, log2) {
            prop_assert!(values.iter().all(|v| v.is_within(limit)));
        } else {
            // Refused at the limit itself or beyond.
            let smaller = FxAccumulator { high: limit.to_bits() - 1, low: u64::MAX };
            prop_assert!(values.iter().any(|v| *v > smaller || v.negated() >= smaller));
        }
    }
}
