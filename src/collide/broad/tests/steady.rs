//! A scene that rests costs no search, and steps take no memory.

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::scene::{METRE, NO_LIMITS, all_pairs, proxy, updated_pairs};
use crate::cases::run_seed;
use crate::collide::broad::{BroadPhase, Proxy, RestingTrees, Statics};
use crate::math::Random;

/// Boxes in a square, shifted by this.
fn square(count: u32, shift: [i64; 2]) -> Vec<Proxy> {
    let at = |i: u32| [i64::from(i % 32) * METRE + shift[0], i64::from(i / 32) * METRE + shift[1]];
    (0..count).map(|i| proxy(i, at(i), at(i).map(|c| c + METRE))).collect()
}

#[test]
fn within_its_fat_box_a_collider_is_not_searched() {
    let rest = square(500, [0; 2]);
    let shifted = square(500, [METRE / 100, -METRE / 50]);
    let floor = Arc::new(Statics::new([proxy(900, [-METRE, -METRE], [40 * METRE, 0])].to_vec()));
    let mut broad = BroadPhase::default();
    let pairs = updated_pairs(&mut broad, &floor, &rest);
    assert_eq!(broad.stale.len(), 500);
    for _ in 0..4 {
        updated_pairs(&mut broad, &floor, &shifted);
        assert_eq!(broad.stale.len(), 0);
        // Back to where it was: as a restore does it.
        assert_eq!(updated_pairs(&mut broad, &floor, &rest), pairs);
        assert_eq!(broad.stale.len(), 0);
    }
    // A collider that leaves its fat box is searched for alone, and once.
    let mut movers = rest.clone();
    movers[77] = proxy(77, [200 * METRE, 0], [201 * METRE, METRE]);
    assert_eq!(updated_pairs(&mut broad, &floor, &movers).len(), pairs.len() - 8);
    assert_eq!(broad.stale, [77]);
    updated_pairs(&mut broad, &floor, &movers);
    // It stopped: the room for its motion is given back.
    assert_eq!(broad.stale, [77]);
    updated_pairs(&mut broad, &floor, &movers);
    assert_eq!(broad.stale.len(), 0);
    // A box that shrinks gives back its room as well.
    movers[77] = proxy(77, [200 * METRE, 0], [210 * METRE, METRE]);
    updated_pairs(&mut broad, &floor, &movers);
    movers[77] = proxy(77, [200 * METRE, 0], [201 * METRE, METRE]);
    updated_pairs(&mut broad, &floor, &movers);
    assert_eq!(broad.stale, [77]);
    updated_pairs(&mut broad, &floor, &movers);
    assert_eq!(broad.stale.len(), 0);
}

#[test]
fn a_copy_shares_the_static_tree() {
    let tiles = square(1000, [0; 2]);
    let statics = Arc::new(Statics::new(tiles.clone()));
    let movers = [proxy(5000, [0; 2], [3 * METRE; 2])];
    let mut broad = BroadPhase::default();
    let pairs = updated_pairs(&mut broad, &statics, &movers);
    assert_eq!(pairs, all_pairs(&tiles, &movers));
    let mut copy = broad.clone();
    assert_eq!(Arc::strong_count(&statics), 3);
    assert_eq!(updated_pairs(&mut copy, &statics, &movers), pairs);
    assert!(copy.stale.is_empty());
}

#[test]
fn without_colliders_there_is_nothing() {
    let mut broad = BroadPhase::default();
    broad.update(&RestingTrees::of(&Arc::default()), &[], &NO_LIMITS);
    assert!(broad.pairs().is_empty());
    assert_eq!(broad.capacities(), [0; 9]);
    let statics = Arc::new(Statics::new(square(1000, [0; 2])));
    broad.update(&RestingTrees::of(&statics), &[], &NO_LIMITS);
    assert!(broad.pairs().is_empty());
    assert_eq!(broad.capacities(), [0; 9]);
}

#[test]
fn steps_take_no_memory_once_sizes_have_been_reached() {
    // Boxes that go round in circles of squares, each at its own speed.
    let mut random = Random::seeded(run_seed(8));
    let speeds: Vec<i64> = (0..300).map(|_| random.integer(0..=8)).collect();
    let statics = Arc::new(Statics::new([proxy(400, [-METRE; 2], [12 * METRE, 0])].to_vec()));
    let scene = |step: i64| {
        let at = |i: usize| {
            let turn = (step * speeds[i]) % 64;
            let offset = [turn.min(32), (turn - 32).max(0)].map(|way| way * METRE / 8);
            [offset[0] + (i as i64 % 18) * METRE, offset[1] + (i as i64 / 18) * METRE]
        };
        (0..300).map(|i| proxy(i as u32, at(i), at(i).map(|c| c + METRE))).collect::<Vec<_>>()
    };
    let mut broad = BroadPhase::default();
    let mut before = Default::default();
    for round in 0..4 {
        for step in 0..64 {
            updated_pairs(&mut broad, &statics, &scene(step));
        }
        if round == 2 {
            before = broad.capacities();
        }
    }
    assert_eq!(broad.capacities(), before);
}
