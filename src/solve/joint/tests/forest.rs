//! Trees of joined bodies against a search from every body.

use alloc::vec::Vec;

use super::scene::Scene;
use crate::cases::run_seed;
use crate::math::Random;
use crate::slots::NONE;
use crate::solve::joint::forest::Forest;

/// The distance in joints from a body to the farthest body that joints connect it with, and the number of these bodies.
fn reach(scene: &Scene, from: u32) -> (usize, usize) {
    let is_fixed = |body: u32| scene.flights[body as usize].is_fixed();
    let mut visited = Vec::from([from]);
    let mut begin = 0;
    for distance in 0.. {
        let end = visited.len();
        for i in begin..end {
            let body = visited[i];
            for joint in scene.joints.iter().filter(|joint| joint.bodies.contains(&body)) {
                let next = joint.bodies.into_iter().find(|&body| !is_fixed(body) && !visited.contains(&body));
                visited.extend(next);
            }
        }
        if visited.len() == end {
            return (distance, end);
        }
        begin = end;
    }
    unreachable!("there are finitely many bodies");
}

#[test]
fn a_tree_has_its_centre_where_the_farthest_body_is_nearest() {
    let mut random = Random::seeded(run_seed(11));
    let mut forest = Forest::default();
    let mut joints_at_centres = 0;
    for i in 0..300 {
        let scene = Scene::random(&mut random, [12, i % 3], 4 + i % 9, 0);
        forest.update(&scene.flights, &scene.joints);
        // Every joint has one block.
        let mut order = forest.order.clone();
        order.sort_unstable();
        assert_eq!(order, (0..scene.joints.len() as u32).collect::<Vec<_>>());
        for range in &forest.trees {
            let places = &forest.places[range.clone()];
            for (node, place) in (range.start..).zip(places) {
                assert!(place.parent == NONE || node < place.parent as usize && (place.parent as usize) < range.end);
            }
            let bodies: Vec<u32> = places.iter().map(|place| place.body).filter(|&body| body != NONE).collect();
            let centre = places.last().expect("a tree has a centre");
            let supports = places.iter().filter(|place| place.body == NONE && place.parent != NONE).count();
            let joints = scene.joints.iter().filter(|joint| joint.bodies.iter().any(|body| bodies.contains(body)));
            assert_eq!(joints.count(), bodies.len() - 1 + supports);
            let (_, count) = reach(&scene, bodies[0]);
            assert_eq!(count, bodies.len());
            let nearest = bodies.iter().map(|&body| reach(&scene, body).0).min().expect("a tree has bodies");
            let centres: Vec<u32> = bodies.iter().copied().filter(|&body| reach(&scene, body).0 == nearest).collect();
            if centre.body == NONE {
                joints_at_centres += 1;
                assert_eq!(centres.len(), 2);
            } else {
                assert_eq!(centres, [centre.body]);
            }
        }
        let blocks: usize = forest.loops.iter().map(|range| range.len()).sum();
        let in_trees = forest.trees.iter().map(|range| forest.places[range.clone()].iter());
        let in_trees = in_trees.map(|places| {
            let mut blocks: Vec<u32> = places.map(|place| place.block).filter(|&block| block != NONE).collect();
            blocks.dedup();
            blocks.len()
        });
        assert_eq!(blocks + in_trees.sum::<usize>(), scene.joints.len());
    }
    assert!(joints_at_centres > 50, "{joints_at_centres}");
}
