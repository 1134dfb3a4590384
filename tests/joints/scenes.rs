//! Worlds with joints.

use umbra_physics::{BodyDef, BodyId, JointDef, JointId, Shape, Vec2, World, WorldDef, fx, vec2};

/// Gravity of 10 m/s² downwards.
pub(crate) fn falling() -> World {
    World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() }).expect("a world")
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

pub(crate) fn steps(world: &mut World, count: usize) {
    (0..count).for_each(|_| _ = world.step());
}
