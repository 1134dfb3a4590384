//! Changes of static colliders: those of any history are those that stand there.

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::scene::{METRE, all_pairs, found, proxy};
use crate::cases::run_seed;
use crate::collide::broad::{BroadPhase, Proxy, Statics};
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
        let next = statics.changed(&[(number, now)]);
        assert_eq!(next.is_some(), before != now, "{step}");
        let Some(next) = next else { continue };
        rebuilt += usize::from(!next.shares_tree(&statics));
        statics = Arc::new(next);
        assert!(statics.are(&tiles), "{step}");
        if step % 50 == 0 {
            assert_eq!(found(&mut broad, &statics, &movers), all_pairs(&tiles, &movers), "{step}");
        }
    }
    // Most changes leave the tree as it is.
    assert!((2..10).contains(&rebuilt), "{rebuilt}");
}
