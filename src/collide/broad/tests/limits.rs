//! Pairs beyond the limits: who is left out is a function of the graph.

use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;

use super::scene::{KINDS, Kind, METRE, NO_LIMITS, all_overlaps, all_pairs, filter, proxy, updated_pairs};
use crate::cases::run_seed;
use crate::collide::broad::{BroadPhase, PairLimits, Proxy, RestingTrees, Statics};
use crate::collider::Filter;
use crate::math::Random;

/// The colliders above the cap, and the pairs of the others, by a look at all pairs.
fn expected(statics: &[Proxy], movers: &[Proxy], limits: &PairLimits) -> (Vec<u32>, Vec<[u32; 2]>) {
    let pairs = all_pairs(statics, movers);
    let overlaps = all_overlaps(statics, movers);
    let too_many = overlaps.len() > limits.overlaps;
    if pairs.len() <= limits.pairs && !too_many {
        return (Vec::new(), pairs);
    }
    let graph = if too_many { &overlaps } else { &pairs };
    let degree = |collider: u32| graph.iter().filter(|pair| pair.contains(&collider)).count();
    let degrees: Vec<(u32, usize)> = movers.iter().map(|proxy| (proxy.collider, degree(proxy.collider))).collect();
    let mut cap = limits.per_collider;
    loop {
        let above = degrees.iter().filter(|&&(_, degree)| degree > cap).map(|&(collider, _)| collider);
        let mut above: Vec<u32> = above.collect();
        above.sort_unstable();
        let stays = |pair: &&[u32; 2]| !pair.iter().any(|c| above.contains(c));
        if graph.iter().filter(stays).count() <= limits.pairs {
            return (above.clone(), pairs.iter().filter(stays).copied().collect());
        }
        cap -= 1;
    }
}

#[test]
fn colliders_above_the_cap_are_those_of_the_definition_after_any_history() {
    let (mut capped, mut capped_by_overlaps) = (0, 0);
    for (i, kind) in KINDS.into_iter().enumerate() {
        let mut random = Random::seeded(run_seed(50 + i as u64));
        let mut broad = BroadPhase::default();
        for round in 0..60 {
            let mut make = |collider| {
                let filter = if round % 2 == 0 { filter(&mut random) } else { Default::default() };
                // Static colliders are on other bodies than moving colliders.
                let body = if collider < 10 { collider } else { 10 + collider % 30 };
                Proxy { collider, body, bounds: kind.bounds(&mut random), filter, digest: 0 }
            };
            let fixed: Vec<Proxy> = (0..10).map(&mut make).collect();
            let movers: Vec<Proxy> = (10..60).map(&mut make).collect();
            let statics = Arc::new(Statics::new(fixed.clone()));
            let count = all_pairs(&fixed, &movers).len();
            let overlaps = all_overlaps(&fixed, &movers).len();
            let pair_limits = [0, count / 8, count / 2, count.saturating_sub(1), count, count + 1];
            let overlap_limits = [overlaps.saturating_sub(1), overlaps, usize::MAX];
            for (pairs, overlaps) in
                pair_limits.into_iter().flat_map(|pairs| overlap_limits.map(|overlaps| (pairs, overlaps)))
            {
                let limits = PairLimits { pairs, per_collider: random.below(20) as usize, overlaps };
                let (above, rest) = expected(&fixed, &movers, &limits);
                capped += usize::from(!above.is_empty());
                capped_by_overlaps += usize::from(!above.is_empty() && count <= pairs);
                broad.update(&RestingTrees::of(&statics), &movers, &limits);
                assert_eq!((broad.above_cap(), broad.pairs()), (&above[..], &rest[..]), "{kind:?} {limits:?}");
                let mut fresh = BroadPhase::default();
                fresh.update(&RestingTrees::of(&statics), &movers, &limits);
                assert_eq!((fresh.above_cap(), fresh.pairs()), (&above[..], &rest[..]), "{kind:?} {limits:?}");
            }
            // Pairs that the limits left out are found again without limits.
            assert_eq!(updated_pairs(&mut broad, &statics, &movers), all_pairs(&fixed, &movers));
        }
    }
    assert!(capped > 1_500 && capped_by_overlaps > 200, "{capped}, {capped_by_overlaps}");
}

/// Moves a heap, a few boxes at a time and for many steps, while the limit is about the number of overlaps that there are.
#[test]
fn overlaps_that_come_and_go_a_few_at_a_time_are_counted_as_they_are() {
    let mut random = Random::seeded(run_seed(70));
    let make = |random: &mut Random, collider: u32| {
        let (bounds, filter) = (Kind::Clusters.bounds(random), filter(random));
        Proxy { collider, body: collider % 50, bounds, filter, digest: 0 }
    };
    let fixed: Vec<Proxy> =
        (200..220).map(|collider| Proxy { body: collider, ..make(&mut random, collider) }).collect();
    let statics = Arc::new(Statics::new(fixed.clone()));
    let mut movers: Vec<Proxy> = (0..100).map(|collider| make(&mut random, collider)).collect();
    let mut broad = BroadPhase::default();
    let mut max_overlaps = all_overlaps(&fixed, &movers).len();
    let mut outcomes = [0; 2];
    for _ in 0..400 {
        for _ in 0..random.below(4) {
            let at = random.below(movers.len() as u64) as usize;
            match random.below(8) {
                0 if movers.len() > 90 => _ = movers.swap_remove(at),
                _ => movers[at] = make(&mut random, movers[at].collider),
            }
        }
        let overlaps = all_overlaps(&fixed, &movers).len();
        let limits = PairLimits { pairs: all_pairs(&fixed, &movers).len(), per_collider: 15, overlaps: max_overlaps };
        let (above, rest) = expected(&fixed, &movers, &limits);
        broad.update(&RestingTrees::of(&statics), &movers, &limits);
        assert_eq!((broad.above_cap(), broad.pairs()), (&above[..], &rest[..]), "{overlaps} of {max_overlaps}");
        outcomes[usize::from(above.is_empty())] += 1;
        max_overlaps = (overlaps + 3).saturating_sub(random.below(6) as usize);
    }
    assert!(outcomes.iter().all(|&count| count > 50), "{outcomes:?}");
}

#[test]
fn ten_thousand_that_filters_keep_apart_stay_within_the_limits() {
    let filters: [fn(u32) -> Filter; 4] = [
        |_| Filter { group: -1, ..Filter::default() },
        // Each has a category in the mask of the next one, and not the other way round.
        |i| Filter { category: 1 << (i % 3), mask: 2 << (i % 3), group: 0 },
        // Categories and masks of all kinds, of which few agree, and groups among them.
        |i| Filter { category: 1 << (i % 31), mask: 1 << (i / 31 % 31), group: -(i as i32 % 7) },
        |i| Filter { category: 1, mask: 1, group: -1 - i as i32 / 5_000 },
    ];
    let limits = PairLimits { pairs: 20_000, per_collider: 100, overlaps: 100_000 };
    for filter in filters {
        let at = |i| Proxy { filter: filter(i), ..proxy(i, [0, 0], [METRE, METRE]) };
        let movers: Vec<Proxy> = (0..10_000).map(at).collect();
        let mut broad = BroadPhase::default();
        for _ in 0..3 {
            broad.update(&RestingTrees::of(&Arc::default()), &movers, &limits);
            assert_eq!(broad.above_cap().len(), 10_000);
            assert!(broad.rejected <= 2 * limits.overlaps, "{}", broad.rejected);
        }
    }
    // Neither has a category in the mask of the other: parts of the tree are skipped.
    let apart = |i: u32| Filter { category: 1 << (i % 2), mask: 4 << (i % 2), group: 0 };
    let movers: Vec<Proxy> =
        (0..10_000).map(|i| Proxy { filter: apart(i), ..proxy(i, [0, 0], [METRE, METRE]) }).collect();
    let mut broad = BroadPhase::default();
    broad.update(&RestingTrees::of(&Arc::default()), &movers, &limits);
    assert_eq!((broad.above_cap().len(), broad.pairs().len(), broad.rejected), (0, 0, 0));
}

#[test]
fn ten_thousand_in_one_place_stay_within_the_limits() {
    let mut movers: Vec<Proxy> = (0..10_000).map(|i| proxy(i, [0, 0], [METRE, METRE])).collect();
    // Bystanders, two by two.
    movers.extend(
        (10_000..10_100)
            .map(|i| proxy(i, [i64::from(i / 2) * 9 * METRE, 0], [(i64::from(i / 2) * 9 + 1) * METRE, METRE])),
    );
    let limits = PairLimits { pairs: 20_000, per_collider: 100, ..NO_LIMITS };
    let mut broad = BroadPhase::default();
    for _ in 0..3 {
        broad.update(&RestingTrees::of(&Arc::default()), &movers, &limits);
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
        &RestingTrees::of(&Arc::new(Statics::new(vec![floor]))),
        &movers,
        &PairLimits { pairs: 499, per_collider: 9, ..NO_LIMITS },
    );
    // Each box has one pair, so that no cap above zero leaves few enough.
    assert_eq!((broad.above_cap().len(), broad.pairs().len()), (500, 0));
    broad.update(
        &RestingTrees::of(&Arc::new(Statics::new(vec![floor]))),
        &movers,
        &PairLimits { pairs: 500, per_collider: 0, ..NO_LIMITS },
    );
    assert_eq!((broad.above_cap().len(), broad.pairs().len()), (0, 500));
    assert_eq!(updated_pairs(&mut broad, &Arc::new(Statics::new(vec![floor])), &movers), all_pairs(&[floor], &movers));
    assert_eq!(NO_LIMITS.pairs, usize::MAX);
}
