//! The tree of queries: it leaves out no box that a path meets, and few others come with them.

use alloc::vec::Vec;

use super::scene::proxy;
use crate::cases::run_seed;
use crate::collide::broad::{Path, Proxy, Statics};
use crate::collider::Filter;
use crate::math::Random;

/// Returns true if a box meets a path, grown by so much: exact.
fn meets(proxy: &Proxy, [min, max]: [[i64; 2]; 2], translation: [i64; 2], more: i128) -> bool {
    let [low, high] = [proxy.bounds.min, proxy.bounds.max].map(|corner| [corner.x.to_bits(), corner.y.to_bits()]);
    // The box of all differences, and whether the segment from the origin meets it.
    let low = [0, 1].map(|k| i128::from(low[k]) - i128::from(max[k]) - more);
    let high = [0, 1].map(|k| i128::from(high[k]) - i128::from(min[k]) + more);
    let translation = translation.map(i128::from);
    let overlaps = |k: usize| low[k] <= translation[k].max(0) && high[k] >= translation[k].min(0);
    let sides = [[low[0], low[1]], [low[0], high[1]], [high[0], low[1]], [high[0], high[1]]]
        .map(|[x, y]| translation[0] * y - translation[1] * x);
    overlaps(0) && overlaps(1) && sides.iter().any(|side| *side <= 0) && sides.iter().any(|side| *side >= 0)
}

#[test]
fn a_search_finds_all_that_a_path_meets_and_little_else() {
    let mut random = Random::seeded(run_seed(12));
    let (mut met, mut false_hits) = (0, 0);
    for round in 0..400 {
        // From a room to the whole range of positions.
        let size = 30 + random.below(33) as u32;
        let number = |random: &mut Random, bits: u32| {
            let range = 1_i64 << bits;
            random.integer(-range..=range)
        };
        let extent = |random: &mut Random| 1 << random.below(u64::from(size.min(44))) as u32;
        let make = |random: &mut Random, collider: u32| {
            let [x, y] = [number(random, size), number(random, size)];
            let [width, height] = [extent(random), extent(random)];
            proxy(collider, [x, y], [x + width, y + height])
        };
        let proxies: Vec<Proxy> =
            (0..1 + random.below(80) as u32).map(|collider| make(&mut random, collider)).collect();
        let [tree, _] = Statics::new(proxies.clone()).cores(|_| None);
        for _ in 0..20 {
            let from = [number(&mut random, size), number(&mut random, size)];
            let bits = 20 + random.below(33) as u32;
            let mut translation = [number(&mut random, bits), number(&mut random, bits)];
            match random.below(6) {
                0 => translation[0] = 0,
                1 => translation = [0; 2],
                _ => {}
            }
            let more = if random.below(2) == 0 { 0 } else { extent(&mut random) };
            let start = [from.map(|part| part - more), from.map(|part| part + more)];
            let mut numbers = Vec::new();
            let is_filtered = random.below(2) != 0;
            let filter = is_filtered.then(Filter::default);
            assert!(tree.search(&mut Path::new(start[0], start[1], translation), filter, |placed, _| {
                numbers.push(placed.number);
                true
            }));
            numbers.sort_unstable();
            // Four units of the tree, in which its whole extent has 30 bits.
            let slack = 1_i128 << (size + 5).saturating_sub(30).max(25);
            for proxy in &proxies {
                let is_found = numbers.binary_search(&proxy.collider).is_ok();
                let is_met = meets(proxy, start, translation, 0);
                assert!(is_found || !is_met, "{round}: {proxy:?} {start:?} {translation:?}");
                assert!(
                    !is_found || meets(proxy, start, translation, slack),
                    "{round}: {proxy:?} {start:?} {translation:?}"
                );
                met += u32::from(is_met);
                false_hits += u32::from(is_found && !is_met);
            }
        }
    }
    // The unit of boxes is there to be seen.
    assert!(met > 1_000 && false_hits > 10, "{met}, {false_hits}");
}
