//! Scenes of the tests.

use umbra_physics::{
    BodyDef, BodyId, ColliderDef, Error, Fx, Material, Random, Shape, Snapshot, Symmetry, TimeStep, Vec2, World,
    WorldDef, fx, vec2,
};

/// A world with gravity, 60 steps a second, in which nobody falls asleep.
pub(crate) fn def() -> WorldDef {
    WorldDef { gravity: vec2(0, -10), time_step: TimeStep::hz(60), sleep_after: None, ..WorldDef::default() }
}

/// The ground: its top is at height 0.
pub(crate) fn ground() -> Result<BodyDef, Error> {
    let shape = Shape::rectangle(fx!(100), fx!(2))?;
    Ok(BodyDef { position: vec2(0, -1), key: 1 << 40, ..BodyDef::fixed().with_collider(shape) })
}

/// A square of a metre.
pub(crate) fn square(position: Vec2, key: u64) -> Result<BodyDef, Error> {
    let collider = ColliderDef { key, ..ColliderDef::new(Shape::rectangle(fx!(1), fx!(1))?) };
    Ok(BodyDef { position, key, ..BodyDef::dynamic().with_collider(collider) })
}

/// A pyramid of squares, `rows` at its base.
pub(crate) fn pyramid(rows: i32) -> Result<Vec<BodyDef>, Error> {
    let mut bodies = vec![ground()?];
    for row in 0..rows {
        for i in 0..rows - row {
            let x = Fx::from_ratio((2 * i - (rows - row - 1)).into(), 2);
            let position = Vec2::new(x, Fx::from_ratio((2 * row + 1).into(), 2));
            bodies.push(square(position, (row * 1_000 + i) as u64)?);
        }
    }
    Ok(bodies)
}

/// A world with these bodies, and their handles.
pub(crate) fn world(def: WorldDef, bodies: impl IntoIterator<Item = BodyDef>) -> Result<(World, Vec<BodyId>), Error> {
    let mut world = World::new(def)?;
    let ids = bodies.into_iter().map(|def| world.add_body(def)).collect::<Result<_, _>>()?;
    Ok((world, ids))
}

/// The world that is read from the bytes of one.
pub(crate) fn through_bytes(world: &World) -> World {
    Snapshot::from_bytes(&world.snapshot().to_bytes(), &[]).expect("its own bytes").into_world()
}

/// A material.
pub(crate) fn material(friction: Fx, restitution: Fx) -> Material {
    Material { friction, restitution, ..Material::default() }
}

/// Steps a world of these bodies beside three others: with the bodies in another order, its mirror image, and one that goes through bytes
/// every so many steps. All have the same bits. `look` sees the world after each step.
pub(crate) fn keeps_its_bits(bodies: Vec<BodyDef>, (steps, every): (u32, u32), mut look: impl FnMut(&World)) {
    let mut shuffled = bodies.clone();
    Random::seeded(5).shuffle(&mut shuffled);
    let (mut here, _) = world(def(), bodies).expect("a scene");
    let (mut twin, _) = world(def(), shuffled).expect("a scene");
    let mut image = Symmetry::MIRROR.world(&here).expect("an image");
    let mut restored = here.clone();
    for step in 0..steps {
        for world in [&mut here, &mut twin, &mut image, &mut restored] {
            world.step();
        }
        assert_eq!(here.physics_hash(), twin.physics_hash(), "{step}");
        assert_eq!(Symmetry::MIRROR.world(&here).expect("an image").first_difference(&image), None, "{step}");
        assert_eq!(here.state_hash(), restored.state_hash(), "{step}");
        if step % every == 0 {
            let bytes = restored.snapshot().to_bytes();
            restored = Snapshot::from_bytes(&bytes, &[]).expect("its own bytes").into_world();
            assert_eq!(restored.snapshot().to_bytes(), bytes);
        }
        look(&here);
    }
}
