//! Fairness of the ends of paths: images, order of insertion, restored worlds.

use super::shots::{MISSILES, Missile, ROOMS, Room, scene};
use crate::seeds::run_seed;
use umbra_physics::{BodyDef, ColliderDef, Filter, Random, Snapshot, Symmetry, World, WorldDef};

/// Rooms of bodies that also touch each other.
fn crowds() -> impl Iterator<Item = (Missile, Room, WorldDef, Vec<BodyDef>)> {
    ROOMS.into_iter().flat_map(|room| {
        MISSILES.into_iter().enumerate().map(move |(i, missile)| {
            let (def, mut bodies) = scene(&mut Random::seeded(run_seed(i as u64)), missile, room, 12);
            let colliders = bodies.iter_mut().flat_map(|body| &mut body.colliders);
            colliders.for_each(|collider: &mut ColliderDef| collider.filter = Filter::default());
            (missile, room, def, bodies)
        })
    })
}

fn world(def: &WorldDef, bodies: &[BodyDef]) -> World {
    let mut world = World::new(*def).expect("a world");
    bodies.iter().for_each(|body| _ = world.add_body(body.clone()).expect("a body"));
    world
}

#[test]
fn the_ends_of_paths_are_those_of_the_image() {
    let mut wrong = Vec::new();
    for (missile, room, def, bodies) in crowds() {
        for symmetry in [Symmetry::MIRROR, Symmetry::TURN] {
            for without in [false, true] {
                let mut here = world(&def, &bodies);
                let mut twin = symmetry.world(&here).expect("an image");
                for world in [&mut here, &mut twin] {
                    world.do_without_continuous_collision(without, false);
                }
                for tick in 0..6 {
                    here.step();
                    twin.step();
                    let image = symmetry.world(&here).expect("an image");
                    if let Some(difference) = image.first_difference(&twin) {
                        wrong.push(format!(
                            "{missile:?} in {room:?}, {symmetry:?}, {without}, after {tick}: {difference:?}"
                        ));
                        break;
                    }
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn the_order_of_insertion_ends_no_path_elsewhere() {
    for (missile, room, def, bodies) in crowds() {
        let mut shuffled = bodies.clone();
        Random::seeded(5).shuffle(&mut shuffled);
        let (mut here, mut twin) = (world(&def, &bodies), world(&def, &shuffled));
        for tick in 0..6 {
            here.step();
            twin.step();
            assert_eq!(here.physics_hash(), twin.physics_hash(), "{missile:?} in {room:?} after {tick}");
        }
    }
}

#[test]
fn a_restored_world_ends_paths_alike() {
    for (missile, room, def, bodies) in crowds() {
        let mut here = world(&def, &bodies);
        let mut twin = world(&def, &bodies);
        for tick in 0..6 {
            here.step();
            let bytes = twin.snapshot().to_bytes();
            twin = Snapshot::from_bytes(&bytes, &[]).expect("its own bytes").into_world();
            twin.step();
            assert_eq!(here.state_hash(), twin.state_hash(), "{missile:?} in {room:?} after {tick}");
        }
    }
}
