//! Changes of static colliders: after any history they are the colliders that stand there.

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::scene::{METRE, all_pairs, proxy, updated_pairs};
use crate::cases::run_seed;
use crate::collide::broad::{Boxes, BroadPhase, Proxy, Statics};
use crate::math::Random;

/// A square of a metre at a place of a grid, a hundred to a row.
fn tile(collider: u32, at: u64) -> Proxy {
    let [x, y] = [at % 100, at / 100].map(|place| place as i64 * METRE);
    proxy(collider, [x, y], [x + METRE, y + METRE])
}

#[test]
fn changed_tiles_are_those_of_a_new_tree() {
    let mut random = Random::seeded(run_seed(9));
    let mut tiles: Vec<Proxy> = (0..4_000).map(|i| tile(i, u64::from(i))).collect();
    let movers: Vec<Proxy> = (0..200).map(|i| tile(5_000 + i, random.below(4_000))).collect();
    let mut statics = Arc::new(Statics::new(tiles.clone()));
    let mut broad = BroadPhase::default();
    let mut rebuilt = 0;
    for step in 0..2_000 {
        let number = random.below(4_100) as u32;
        let now = (random.below(3) > 0).then(|| tile(number, random.below(4_000)));
        let before = tiles.iter().position(|tile| tile.collider == number).map(|i| tiles.swap_remove(i));
        tiles.extend(now);
        let mut changes = Vec::from([(number, now)]);
        statics.sift(&mut changes);
        let next = statics.changed(&changes);
        assert_eq!(next.is_some(), before != now, "{step}");
        let Some(next) = next else { continue };
        rebuilt += usize::from(!next.shares_tree(&statics));
        statics = Arc::new(next);
        assert!(statics.are(&tiles), "{step}");
        if step % 50 == 0 {
            assert_eq!(updated_pairs(&mut broad, &statics, &movers), all_pairs(&tiles, &movers), "{step}");
        }
    }
    // Most changes leave the tree as it is.
    assert!((2..10).contains(&rebuilt), "{rebuilt}");
}

#[test]
fn many_changes_at_once_are_those_of_a_new_tree() {
    let mut random = Random::seeded(run_seed(10));
    let mut tiles: Vec<Option<Proxy>> = (0..1_000).map(|i| Some(tile(i, u64::from(i)))).collect();
    let mut statics = Statics::new(tiles.iter().copied().flatten().collect());
    for step in 0..400 {
        let count = [3, 30, 300, 900][step % 4];
        let mut numbers: Vec<u32> = (0..count).map(|_| random.below(1_000) as u32).collect();
        // A number that is there twice has the same change twice.
        for number in &mut numbers {
            let now = (random.below(4) > 0).then(|| tile(*number, random.below(1_000)));
            tiles[*number as usize] = now;
        }
        let before = statics.clone();
        let mut changes: Vec<(u32, Option<Proxy>)> =
            numbers.iter().map(|&number| (number, tiles[number as usize])).collect();
        statics.sift(&mut changes);
        let differs = |(number, now): &(u32, Option<Proxy>)| before.find(*number) != now.as_ref();
        assert!(changes.iter().all(differs) && changes.is_sorted_by_key(|(number, _)| *number), "{step}");
        statics.change(&changes);
        let proxies: Vec<Proxy> = tiles.iter().copied().flatten().collect();
        assert!(statics.are(&proxies), "{step}");

        let mut boxes = Boxes::default();
        let places: Vec<Proxy> = changes.iter().filter_map(|(_, now)| *now).take(20).collect();
        boxes.refill(places.iter().map(|place| place.bounds));
        let mut nearby = Vec::new();
        statics.near_any(&boxes, |proxy| nearby.push(proxy.collider));
        nearby.sort_unstable();
        let is_nearby = |proxy: &&Proxy| places.iter().any(|place| place.bounds.overlaps(proxy.bounds));
        assert!(nearby.iter().copied().eq(proxies.iter().filter(is_nearby).map(|proxy| proxy.collider)), "{step}");
    }
}
