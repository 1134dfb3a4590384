//! The pairs match the definition, whatever happened before.

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::scene::{KINDS, Kind, METRE, NO_LIMITS, all_pairs, bounds, filter, updated_pairs};
use crate::cases::run_seed;
use crate::collide::broad::{BroadPhase, Proxy, RestingTrees, Statics};
use crate::fx::Fx;
use crate::math::Random;
use crate::shape::Aabb;

/// Moves a box, within the range and where its mirror image is within it.
fn moved(aabb: Aabb<Fx>, shift: [i64; 2]) -> Aabb<Fx> {
    let add = |v: Fx, d: i64| v.to_bits().saturating_add(d).max(-i64::MAX);
    let corner = |v: crate::math::Vec2<Fx>| [add(v.x, shift[0]), add(v.y, shift[1])];
    bounds(corner(aabb.min), corner(aabb.max))
}

/// A scene of boxes that come, go and move.
struct Scene {
    kind: Kind,
    random: Random,
    movers: Vec<Proxy>,
    fixed: Vec<Proxy>,
    statics: Arc<Statics>,
    /// Numbers that nobody has.
    free: Vec<u32>,
}

impl Scene {
    fn new(kind: Kind, seed: u64) -> Self {
        let mut free: Vec<u32> = (0..120).collect();
        let mut random = Random::seeded(run_seed(seed));
        random.shuffle(&mut free);
        let mut scene = Self { kind, random, movers: Vec::new(), fixed: Vec::new(), statics: Arc::default(), free };
        for _ in 0..40 {
            let proxy = scene.make();
            scene.movers.push(proxy);
        }
        scene.change_statics();
        scene
    }

    fn make(&mut self) -> Proxy {
        let collider = self.free.pop().expect("a number");
        Proxy {
            collider,
            body: collider % 60,
            bounds: self.kind.bounds(&mut self.random),
            filter: filter(&mut self.random),
            digest: 0,
        }
    }

    fn index(&mut self) -> usize {
        self.random.below(self.movers.len() as u64) as usize
    }

    fn change_statics(&mut self) {
        self.free.extend(self.fixed.drain(..).map(|proxy| proxy.collider));
        // Numbers change hands between moving and static colliders.
        self.random.shuffle(&mut self.free);
        for _ in 0..self.random.below(20) {
            // On a body that does not move.
            let proxy = self.make();
            self.fixed.push(Proxy { body: 60 + proxy.body, ..proxy });
        }
        self.statics = Arc::new(Statics::new(self.fixed.clone()));
    }

    /// Something happens, or nothing.
    fn advance(&mut self) {
        match self.random.below(12) {
            0 if !self.free.is_empty() => {
                let proxy = self.make();
                self.movers.push(proxy);
            }
            1 | 2 if self.movers.len() > 2 => {
                let at = self.index();
                self.free.push(self.movers.swap_remove(at).collider);
                // Another one may get its number in the same step.
                if self.random.below(2) == 0 {
                    let proxy = self.make();
                    self.movers.push(proxy);
                }
            }
            3 if self.free.len() > 20 => self.change_statics(),
            4 => self.random.shuffle(&mut self.movers),
            5 => {
                let at = self.index();
                self.movers[at].filter = filter(&mut self.random);
            }
            6 => {
                let at = self.index();
                self.movers[at].bounds = self.kind.bounds(&mut self.random);
            }
            7 if self.free.len() > 40 => {
                for _ in 0..30 {
                    let proxy = self.make();
                    self.movers.push(proxy);
                }
            }
            8 => {
                let keep = self.index() + 1;
                self.free.extend(self.movers.drain(keep..).map(|proxy| proxy.collider));
            }
            9 => {}
            step => {
                // One ulp, a little, or far.
                let range = [1, METRE / 100, METRE][self.random.below(3) as usize];
                for proxy in &mut self.movers {
                    let shift = [0; 2].map(|_| self.random.integer(-range..=range));
                    if step == 10 || self.random.below(8) == 0 {
                        proxy.bounds = moved(proxy.bounds, shift);
                    }
                }
            }
        }
    }

    fn pairs(&self) -> Vec<[u32; 2]> {
        all_pairs(&self.fixed, &self.movers)
    }
}

#[test]
fn pairs_are_those_of_the_definition_after_any_history() {
    let mut total = 0;
    for (i, kind) in KINDS.into_iter().enumerate() {
        for run in 0..20 {
            let mut scene = Scene::new(kind, 100 * i as u64 + run);
            let mut broad = BroadPhase::default();
            for step in 0..60 {
                let expected = scene.pairs();
                assert_eq!(updated_pairs(&mut broad, &scene.statics, &scene.movers), expected, "{kind:?} {run} {step}");
                let fresh = updated_pairs(&mut BroadPhase::default(), &scene.statics, &scene.movers);
                assert_eq!(fresh, expected, "{kind:?} {run} {step}");
                total += expected.len();
                scene.advance();
            }
        }
    }
    assert!(total > 100_000, "{total}");
}

#[test]
fn a_restored_scene_has_the_pairs_it_had() {
    for (i, kind) in KINDS.into_iter().enumerate() {
        let mut scene = Scene::new(kind, 900 + i as u64);
        let mut history = Vec::new();
        let mut broad = BroadPhase::default();
        for _ in 0..100 {
            let pairs = updated_pairs(&mut broad, &scene.statics, &scene.movers);
            history.push((scene.movers.clone(), Arc::clone(&scene.statics), pairs));
            scene.advance();
        }
        // Back and forth, with one cache for all.
        for _ in 0..300 {
            let (movers, statics, pairs) = &history[scene.random.below(100) as usize];
            assert_eq!(updated_pairs(&mut broad, statics, movers), *pairs, "{kind:?}");
        }
    }
}

#[test]
fn a_cache_of_another_world_does_no_harm() {
    let mut broad = BroadPhase::default();
    for round in 0..50 {
        for kind in KINDS {
            let scene = Scene::new(kind, 2000 + round);
            assert_eq!(updated_pairs(&mut broad, &scene.statics, &scene.movers), scene.pairs(), "{kind:?} {round}");
        }
    }
}

/// The image of a box.
fn image(proxy: &Proxy, map: impl Fn([i64; 2]) -> [i64; 2]) -> Proxy {
    let corners = [proxy.bounds.min, proxy.bounds.max].map(|v| map([v.x.to_bits(), v.y.to_bits()]));
    let corner = |pick: fn(i64, i64) -> i64| [0, 1].map(|k| pick(corners[0][k], corners[1][k]));
    Proxy { bounds: bounds(corner(i64::min), corner(i64::max)), ..*proxy }
}

#[test]
fn mirrored_and_turned_scenes_have_the_same_pairs() {
    let maps: [fn([i64; 2]) -> [i64; 2]; 3] = [|[x, y]| [-x, y], |[x, y]| [y, x], |[x, y]| [-y, x]];
    for (i, kind) in KINDS.into_iter().enumerate() {
        let mut scene = Scene::new(kind, 3000 + i as u64);
        let mut broad = [const { None }; 4].map(|_: Option<()>| BroadPhase::default());
        for _ in 0..100 {
            let expected = updated_pairs(&mut broad[3], &scene.statics, &scene.movers);
            for (map, broad) in maps.into_iter().zip(&mut broad) {
                let images = |list: &[Proxy]| list.iter().map(|proxy| image(proxy, map)).collect::<Vec<_>>();
                let statics = Arc::new(Statics::new(images(&scene.fixed)));
                assert_eq!(updated_pairs(broad, &statics, &images(&scene.movers)), expected, "{kind:?}");
            }
            scene.advance();
        }
    }
}

#[test]
fn pairs_follow_the_numbers_and_not_the_order_of_the_list() {
    for (i, kind) in KINDS.into_iter().enumerate() {
        let mut scene = Scene::new(kind, 4000 + i as u64);
        let mut numbers: Vec<u32> = (0..120).collect();
        scene.random.shuffle(&mut numbers);
        let renumbered = |proxy: &Proxy| Proxy { collider: numbers[proxy.collider as usize], ..*proxy };
        let mut fixed: Vec<Proxy> = scene.fixed.iter().map(renumbered).collect();
        let mut movers: Vec<Proxy> = scene.movers.iter().map(renumbered).collect();
        scene.random.shuffle(&mut fixed);
        scene.random.shuffle(&mut movers);
        let mut expected = scene.pairs();
        for pair in &mut expected {
            *pair = pair.map(|collider| numbers[collider as usize]);
            pair.sort_unstable();
        }
        expected.sort_unstable();
        let mut broad = BroadPhase::default();
        assert_eq!(updated_pairs(&mut broad, &Arc::new(Statics::new(fixed)), &movers), expected, "{kind:?}");
    }
}

#[test]
fn boxes_that_share_a_point_are_a_pair_and_those_an_ulp_apart_are_not() {
    let at = |collider, x: i64, y: i64| super::scene::proxy(collider, [x, y], [x + METRE, y + METRE]);
    for (x, y, is_pair) in [
        (METRE, 0, true),
        (METRE + 1, 0, false),
        (0, -METRE, true),
        (0, -METRE - 1, false),
        (METRE, METRE, true),
        (METRE, METRE + 1, false),
    ] {
        let mut broad = BroadPhase::default();
        broad.update(&RestingTrees::of(&Arc::default()), &[at(7, 0, 0), at(3, x, y)], &NO_LIMITS);
        assert_eq!(broad.pairs(), if is_pair { &[[3, 7]][..] } else { &[] });
        broad.update(&RestingTrees::of(&Arc::new(Statics::new([at(3, x, y)].to_vec()))), &[at(7, 0, 0)], &NO_LIMITS);
        assert_eq!(broad.pairs(), if is_pair { &[[3, 7]][..] } else { &[] });
    }
}

#[test]
fn boxes_of_the_whole_range_meet_all() {
    let whole = |collider| super::scene::proxy(collider, [i64::MIN; 2], [i64::MAX; 2]);
    let corner = |collider, x: i64, y: i64| super::scene::proxy(collider, [x, y], [x, y]);
    let corners = [i64::MIN, i64::MAX].map(|x| [i64::MIN, i64::MAX].map(|y| [x, y])).concat();
    let mut movers: Vec<Proxy> = corners.iter().zip(10..).map(|(&[x, y], k)| corner(k, x, y)).collect();
    movers.push(whole(1));
    let statics = Arc::new(Statics::new([whole(0)].to_vec()));
    let mut broad = BroadPhase::default();
    let expected = [[0, 1], [0, 10], [0, 11], [0, 12], [0, 13], [1, 10], [1, 11], [1, 12], [1, 13]];
    assert_eq!(updated_pairs(&mut broad, &statics, &movers), expected);
    // A collider that is gone has no box, not even for colliders that meet all others.
    movers.remove(2);
    assert_eq!(
        updated_pairs(&mut broad, &statics, &movers),
        [[0, 1], [0, 10], [0, 11], [0, 13], [1, 10], [1, 11], [1, 13]]
    );
}
