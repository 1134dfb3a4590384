//! The stack that a step takes, which counts without optimisation: games are first tried in such builds, and threads have 1 to 2 MiB.

use std::thread;

use umbra_physics::{
    Attachment, BodyDef, End, Error, Fx, JointDef, JointKind, JointLimits, JointMotor, Revolute, Shape, Vec2, World,
    WorldDef, fx, vec2,
};

/// Bytes, with what the thread itself takes.
const STACK: usize = 1 << 19;

/// rad.
const EIGHTH: Fx = fx!(0.785398);

/// The direction of a number of eighths of a turn.
fn direction(eighths: i32) -> Vec2 {
    let (sin, cos) = (EIGHTH * eighths).sin_cos();
    Vec2::new(cos, sin)
}

/// Shapes of all kinds that fall in a heap on a floor, and a ring of planks with limits and motors among them.
fn heap() -> Result<World, Error> {
    let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
    let floor = BodyDef::fixed().with_collider(Shape::rectangle(100, 2)?);
    world.add_body(BodyDef { position: vec2(0, -1), ..floor })?;
    let octagon: Vec<Vec2> = (0..8).map(|i| direction(i) / 4).collect();
    let shapes = [
        Shape::rectangle(fx!(0.5), fx!(0.5))?,
        Shape::circle(fx!(0.25))?,
        Shape::capsule(fx!(0.5), fx!(0.125))?,
        Shape::polygon(&[vec2(0, 0), vec2(fx!(0.5), 0), vec2(fx!(0.25), fx!(0.5))])?,
        Shape::polygon(&octagon)?,
    ];
    for (i, shape) in (0..).zip(shapes.iter().cycle().take(60)) {
        let position = vec2(fx!(0.5) * (i % 6) - fx!(1.5), fx!(0.5) + fx!(0.25) * i);
        world.add_body(BodyDef { position, ..BodyDef::dynamic().with_collider(shape.clone()) })?;
    }
    let mut planks = Vec::new();
    for i in 0..8 {
        let angle = EIGHTH * i;
        let plank = BodyDef::dynamic().with_collider(Shape::rectangle(fx!(0.25), 1)?);
        planks.push(world.add_body(BodyDef { position: direction(i) * 2 + vec2(5, 3), angle, ..plank })?);
    }
    for (i, &plank) in planks.iter().enumerate() {
        let next = planks[(i + 1) % planks.len()];
        let kind = JointKind::Revolute(Revolute {
            limits: Some(JointLimits::degrees(-30, 30)),
            motor: Some(JointMotor { speed: fx!(1), max_force: fx!(5) }),
            ..Revolute::default()
        });
        let ends = [(plank, fx!(0.5)), (next, fx!(-0.5))];
        let ends = ends.map(|(body, y)| End::Body(Attachment { body, point: vec2(0, y) }));
        world.add_joint(JointDef::new(ends, kind))?;
    }
    let rope = [End::World(vec2(5, 10)), End::Body(Attachment::centre(planks[2]))];
    world.add_joint(JointDef::new(rope, JointKind::Revolute(Revolute::default())))?;
    Ok(world)
}

#[test]
fn a_step_needs_no_more_than_half_a_megabyte_of_stack() {
    let step_all = || {
        let mut world = heap().expect("a heap");
        (0..150).for_each(|_| _ = world.step());
        world.contacts().count()
    };
    let thread = thread::Builder::new().stack_size(STACK).spawn(step_all).expect("a thread");
    // Its end by an overflow is the end of the program.
    assert!(thread.join().expect("no panic") > 30);
}
