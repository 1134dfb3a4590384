//! The table of pairs of materials: coefficients in place of those that follow from both.

use super::scenes::{def, ground, square, through_bytes, world};
use umbra_physics::{
    BodyDef, BodyId, Command, Error, Fx, Material, MaterialPair, Quantity, Symmetry, Vec2, World, fx, limits, vec2,
};

/// A box that slides at 20 m/s on a ground, of materials 3 and 5.
fn slider() -> (World, BodyId) {
    let mut floor = ground().expect("a ground");
    floor.colliders[0].material = Material { friction: fx!(0.8), id: 3, ..Material::default() };
    let mut above = square(Vec2::new(fx!(0), fx!(0.5)), 1).expect("a square");
    above.colliders[0].material = Material { friction: fx!(0.2), id: 5, ..Material::default() };
    let (world, ids) = world(def(), [floor, BodyDef { velocity: vec2(20, 0), ..above }]).expect("a scene");
    (world, ids[1])
}

/// The speed that the box loses in half a second, over that by a friction of 1.
fn friction(world: &mut World, id: BodyId) -> Fx {
    let speed = |world: &World| world.body(id).expect("the box").velocity().x;
    let before = speed(world);
    (0..30).for_each(|_| _ = world.step());
    (before - speed(world)) / 5
}

fn near(value: Fx, expected: Fx) {
    assert!((value - expected).abs() < fx!(0.002), "{value} for {expected}");
}

fn of(friction: Fx) -> Option<MaterialPair> {
    Some(MaterialPair { friction, ..MaterialPair::default() })
}

#[test]
fn coefficients_of_a_pair_replace_the_mixed_ones_until_they_are_taken_back() {
    let (mut world, id) = slider();
    near(friction(&mut world, id), fx!(0.4)); // √(0.2 · 0.8)
    world.set_material_pair(5, 3, of(fx!(0.1))).expect("a pair");
    near(friction(&mut world, id), fx!(0.1));
    world.set_material_pair(3, 5, of(fx!(0.7))).expect("a pair");
    near(friction(&mut world, id), fx!(0.7));
    // Other pairs, among them one of two alike, are none of theirs.
    for (first, second) in [(3, 3), (5, 5), (1, 3), (5, u32::MAX)] {
        world.set_material_pair(first, second, of(fx!(0))).expect("a pair");
    }
    assert_eq!(
        world.material_pairs().map(|(ids, _)| ids).collect::<Vec<_>>(),
        [[1, 3], [3, 3], [3, 5], [5, 5], [5, u32::MAX]]
    );
    world.set_material_pair(3, 5, None).expect("it is there");
    near(friction(&mut world, id), fx!(0.4));
    // Nothing to take back.
    assert_eq!(world.set_material_pair(3, 5, None), Ok(()));
    assert_eq!(world.material_pairs().count(), 4);
}

#[test]
fn restitution_of_a_pair_counts_too() {
    let (mut world, id) = slider();
    world
        .set_material_pair(3, 5, Some(MaterialPair { restitution: fx!(0.5), ..MaterialPair::default() }))
        .expect("a pair");
    world.set_velocity(id, vec2(0, -20)).expect("a velocity");
    world.step();
    let velocity = world.body(id).expect("the box").velocity().y;
    assert!((velocity - fx!(10)).abs() < fx!(0.3), "{velocity}");
}

#[test]
fn invalid_material_pairs_are_refused_and_change_nothing() {
    let (mut world, _) = slider();
    let out_of = |quantity| Err(Error::OutOfRange { quantity });
    let ulp = Fx::from_bits(1);
    let good = MaterialPair::default();
    let cases = [
        ((0, 1), Some(good), out_of(Quantity::MaterialId)),
        ((1, 0), None, out_of(Quantity::MaterialId)),
        ((1, 2), of(-ulp), out_of(Quantity::Friction)),
        ((1, 2), of(limits::FRICTION + ulp), out_of(Quantity::Friction)),
        ((1, 2), Some(MaterialPair { restitution: fx!(1) + ulp, ..good }), out_of(Quantity::Restitution)),
        ((1, 2), Some(MaterialPair { rolling_resistance: fx!(1) + ulp, ..good }), out_of(Quantity::RollingResistance)),
        ((1, 2), Some(MaterialPair { rolling_resistance: -ulp, ..good }), out_of(Quantity::RollingResistance)),
        ((1, 2), of(limits::FRICTION), Ok(())),
    ];
    for ((first, second), pair, expected) in cases {
        let before = world.state_hash();
        let command = Command::SetMaterialPair { first, second, pair };
        assert_eq!(world.check(&command), expected);
        assert_eq!(world.execute(&command).map(drop), expected);
        assert_eq!(world.state_hash() == before, expected.is_err());
    }
}

#[test]
fn a_full_table_takes_no_more() {
    let (mut world, _) = slider();
    for id in 1..=limits::MATERIAL_PAIRS as u32 {
        world.set_material_pair(7, id, of(fx!(1))).expect("there is room");
    }
    assert_eq!(world.set_material_pair(8, 8, of(fx!(1))), Err(Error::Full));
    // One that is there can be changed, and one that goes makes room.
    world.set_material_pair(7, 9, of(fx!(2))).expect("it is there");
    world.set_material_pair(7, 9, None).expect("it is there");
    world.set_material_pair(8, 8, of(fx!(1))).expect("there is room");
    let back = through_bytes(&world);
    assert!(back.material_pairs().eq(world.material_pairs()));
}

#[test]
fn the_table_is_state() {
    let (mut world, _) = slider();
    let plain = (world.state_hash(), world.physics_hash());
    let without = world.clone();
    world.set_material_pair(3, 5, of(fx!(0.1))).expect("a pair");
    assert!(world.state_hash() != plain.0 && world.physics_hash() != plain.1);
    let differences = without.differences(&world);
    let fields: Vec<&str> = differences.iter().map(|difference| &difference.field[..]).collect();
    assert!(fields.contains(&"material_pairs[0].coefficients.friction"), "{fields:?}");
    let mut back = through_bytes(&world);
    let mut mirrored = Symmetry::MIRROR.world(&world).expect("an image");
    assert!(mirrored.material_pairs().eq(world.material_pairs()));
    for _ in 0..30 {
        world.step();
        back.step();
        mirrored.step();
        assert_eq!(back.state_hash(), world.state_hash());
        assert_eq!(Symmetry::MIRROR.world(&world).expect("an image").state_hash(), mirrored.state_hash());
    }
}
