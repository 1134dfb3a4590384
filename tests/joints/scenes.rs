//! Worlds with joints.

use umbra_physics::{
    BodyDef, BodyId, Fx, JointDef, JointId, Mass, Shape, Snapshot, Symmetry, Vec2, World, WorldDef, fx, vec2,
};

/// Gravity of 10 m/s² downwards.
pub(crate) fn falling() -> World {
    World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() }).expect("a world")
}

/// No gravity.
pub(crate) fn still() -> World {
    World::new(WorldDef::default()).expect("a world")
}

/// A wheel of an inertia on an axle of the world.
pub(crate) fn wheel(world: &mut World, position: Vec2, inertia: Fx) -> (BodyId, JointId) {
    let mass = Mass::Explicit { mass: fx!(1), inertia };
    let body = world.add_body(BodyDef { position, mass, ..BodyDef::dynamic() }).expect("a body");
    let axle = JointDef::at(world, None, body, position).expect("a joint");
    (body, world.add_joint(axle).expect("a joint"))
}

pub(crate) fn assert_near(value: Fx, expected: Fx, error: Fx) {
    assert!((value - expected).abs() < error, "{value} is not {expected}");
}

/// A body of 1 kg that touches nothing.
pub(crate) fn point_mass(world: &mut World, position: Vec2) -> BodyId {
    world.add_body(BodyDef { position, ..BodyDef::dynamic() }).expect("a body")
}

/// A link of a chain: a bar of 1 m by 0.2 m.
pub(crate) fn bar(world: &mut World, position: Vec2) -> BodyId {
    let shape = Shape::rectangle(fx!(1), fx!(0.2)).expect("a bar");
    world.add_body(BodyDef { position, ..BodyDef::dynamic().with_collider(shape) }).expect("a body")
}

/// A level chain of bars that hangs on the world at the origin.
pub(crate) fn chain(world: &mut World, links: i32) -> (Vec<BodyId>, Vec<JointId>) {
    let mut bodies: Vec<BodyId> = Vec::new();
    let mut joints = Vec::new();
    for i in 0..links {
        let body = bar(world, Vec2::new(fx!(0.5) + fx!(1) * i, fx!(0)));
        let joint = JointDef::at(world, bodies.last().copied(), body, vec2(i, 0)).expect("points of both");
        joints.push(world.add_joint(joint).expect("a joint"));
        bodies.push(body);
    }
    (bodies, joints)
}

/// A slope of 20° on which bodies stand whose place on it is turned about the origin.
pub(crate) fn slope(world: &mut World) {
    let slope = BodyDef::fixed().with_collider(Shape::rectangle(40, 1).expect("a shape"));
    world.add_body(BodyDef { angle: Fx::PI / 9, position: vec2(0, fx!(-0.532)), ..slope }).expect("a body");
}

/// Asserts that a body that has come to rest stays within a millimetre for ten minutes, awake.
pub(crate) fn assert_stays(world: &mut World, body: BodyId) {
    world.set_sleep_after(None).expect("a number");
    steps(world, 300);
    let start = world.body(body).expect("a body").position();
    steps(world, 36_000);
    let creep = (world.body(body).expect("a body").position() - start).length();
    assert!(creep < fx!(0.001), "{creep}");
}

pub(crate) fn steps(world: &mut World, count: usize) {
    (0..count).for_each(|_| _ = world.step());
}

/// Asserts that images and copies of a world go on in the same bits.
pub(crate) fn assert_images_and_copies(world: fn() -> World) {
    for symmetry in [Symmetry::MIRROR, Symmetry::DIAGONAL, Symmetry::TURN] {
        let mut world = world();
        let mut image = symmetry.world(&world).expect("an image");
        for tick in 0..400 {
            let expected = symmetry.world(&world).expect("an image").state_hash();
            assert_eq!(expected, image.state_hash(), "{symmetry:?}, tick {tick}");
            if tick % 50 == 20 {
                let copy = Snapshot::from_bytes(&world.snapshot().to_bytes(), &[]).expect("its own bytes").into_world();
                assert_eq!(copy.state_hash(), world.state_hash());
                world = copy;
            }
            world.step();
            image.step();
        }
    }
}
