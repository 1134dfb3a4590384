//! Pairs beyond the limits: who is left out is a function of the graph.

use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;

use super::scene::{KINDS, METRE, NO_LIMITS, all_pairs, filter, found, proxy};
use crate::collide::broad::{BroadPhase, PairLimits, Proxy, Standing, Statics};
use crate::math::Random;

/// The colliders above the cap, and the pairs of the others, by a look at all pairs.
fn expected(statics: &[Proxy], movers: &[Proxy], limits: &PairLimits) -> (Vec<u32>, Vec<[u32; 2]>) {
    let pairs = all_pairs(statics, movers);
    if pairs.len() <= limits.pairs {
        return (Vec::new(), pairs);
    }
    let degree = |collider: u32| pairs.iter().filter(|pair| pair.contains(&collider)).count();
    let mut cap = limits.per_collider;
    loop {
        let above = movers.iter().map(|proxy| proxy.collider).filter(|&collider| degree(collider) > cap);
        let mut above: Vec<u32> = above.collect();
        above.sort_unstable();
        let rest: Vec<_> = pairs.iter().copied().filter(|pair| !pair.iter().any(|c| above.contains(c))).collect();
        if rest.len() <= limits.pairs {
            return (above, rest);
        }
        cap -= 1;
    }
}

#[test]
fn colliders_above_the_cap_are_those_of_the_definition_after_any_history() {
    let mut capped = 0;
    for (i, kind) in KINDS.into_iter().enumerate() {
        let mut random = Random::seeded(50 + i as u64);
        let mut broad = BroadPhase::default();
        for round in 0..60 {
            let mut make = |collider| {
                let filter = if round % 2 == 0 { filter(&mut random) } else { Default::default() };
                // Static colliders are on other bodies than those that move.
                let body = if collider < 10 { collider } else { 10 + collider % 30 };
                Proxy { collider, body, bounds: kind.bounds(&mut random), filter, digest: 0 }
            };
            let fixed: Vec<Proxy> = (0..10).map(&mut make).collect();
            let movers: Vec<Proxy> = (10..60).map(&mut make).collect();
            let statics = Arc::new(Statics::new(fixed.clone()));
            let count = all_pairs(&fixed, &movers).len();
            let near = [0, count / 8, count / 2, count.saturating_sub(1), count, count + 1];
            for pairs in near {
                let limits = PairLimits { pairs, per_collider: random.below(20) as usize };
                let (above, rest) = expected(&fixed, &movers, &limits);
                capped += usize::from(!above.is_empty());
                broad.update(&Standing::of(&statics), &movers, &limits);
                assert_eq!((broad.above_cap(), broad.pairs()), (&above[..], &rest[..]), "{kind:?} {limits:?}");
                let mut fresh = BroadPhase::default();
                fresh.update(&Standing::of(&statics), &movers, &limits);
                assert_eq!((fresh.above_cap(), fresh.pairs()), (&above[..], &rest[..]), "{kind:?} {limits:?}");
            }
            // Pairs that the limits left out are found again without limits.
            assert_eq!(found(&mut broad, &statics, &movers), all_pairs(&fixed, &movers));
        }
    }
    assert!(capped > 500, "{capped}");
}

#[test]
fn ten_thousand_in_one_place_stay_within_the_limits() {
    let mut movers: Vec<Proxy> = (0..10_000).map(|i| proxy(i, [0, 0], [METRE, METRE])).collect();
    // Bystanders, two by two.
    movers.extend(
        (10_000..10_100)
            .map(|i| proxy(i, [i64::from(i / 2) * 9 * METRE, 0], [(i64::from(i / 2) * 9 + 1) * METRE, METRE])),
    );
    let limits = PairLimits { pairs: 20_000, per_collider: 100 };
    let mut broad = BroadPhase::default();
    for _ in 0..3 {
        broad.update(&Standing::of(&Arc::default()), &movers, &limits);
        assert_eq!(broad.above_cap(), (0..10_000).collect::<Vec<_>>());
        let bystanders: Vec<_> = (5_000..5_050).map(|i| [2 * i, 2 * i + 1]).collect();
        assert_eq!(broad.pairs(), bystanders);
        assert!(broad.candidates.capacity() < 200_000, "{}", broad.candidates.capacity());
    }
}

#[test]
fn a_floor_is_never_above_the_cap() {
    let floor = proxy(0, [-METRE, -METRE], [2000 * METRE, 0]);
    let movers: Vec<Proxy> =
        (1..=500).map(|i| proxy(i, [i64::from(i) * 3 * METRE, 0], [(i64::from(i) * 3 + 1) * METRE, METRE])).collect();
    let mut broad = BroadPhase::default();
    broad.update(
        &Standing::of(&Arc::new(Statics::new(vec![floor]))),
        &movers,
        &PairLimits { pairs: 499, per_collider: 9 },
    );
    // Each box has one pair, so that no cap above zero leaves few enough.
    assert_eq!((broad.above_cap().len(), broad.pairs().len()), (500, 0));
    broad.update(
        &Standing::of(&Arc::new(Statics::new(vec![floor]))),
        &movers,
        &PairLimits { pairs: 500, per_collider: 0 },
    );
    assert_eq!((broad.above_cap().len(), broad.pairs().len()), (0, 500));
    assert_eq!(found(&mut broad, &Arc::new(Statics::new(vec![floor])), &movers), all_pairs(&[floor], &movers));
    assert_eq!(NO_LIMITS.pairs, usize::MAX);
}
