//! The world of `examples/c/main.c`, built with the library itself. The hashes it has go into `examples/c/golden.h`, which the
//! program compares its own with; `UMBRA_BLESS=1` writes it.

use std::fs;
use std::path::Path;

use umbra_physics::{
    ApplyOptions, Attachment, BodyDef, BodyId, ColliderDef, Damping, End, Error, FieldKind, Filter, ForceField,
    ForceOrImpulse, Frame, Fx, FxFactor, Mass, Region, Shape, SpringConstants, World, WorldDef, fx, vec2,
};
use umbra_scene::Scene;

const TICKS: u32 = 600;
const SCENE: &str = "scenes/lander.json";

fn build() -> Result<(World, BodyId, BodyId), Error> {
    let mut world = World::new(WorldDef {
        gravity: vec2(0, fx!(-9.81)),
        linear_damping: Damping::kept_per_second(fx!(0.9)),
        ..WorldDef::default()
    })?;
    let corners = [vec2(0, 0), vec2(200, 0), vec2(200, 1), vec2(0, 1)];
    let (slab, disc) = (Shape::polygon(&corners)?, Shape::circle(fx!(0.5))?);
    let ground = world.add_body(BodyDef { position: vec2(0, -6), ..BodyDef::fixed() })?;
    world.add_collider(ground, slab)?;
    let ball = world.add_body(BodyDef {
        velocity: vec2(3, 0),
        angular_damping: Some(Damping::kept_per_second(fx!(0.5))),
        angular_velocity: fx!(1),
        user_data: 7,
        ..BodyDef::dynamic()
    })?;
    world.add_collider(ball, ColliderDef { density: fx!(2.5), ..ColliderDef::new(disc) })?;
    let plank = world.add_body(BodyDef {
        mass: Mass::Kilograms(fx!(2)),
        angle: fx!(0.1),
        position: vec2(20, 0),
        force_groups: 2,
        ..BodyDef::dynamic()
    })?;
    let ghost = |shape| ColliderDef { filter: Filter { mask: 0, ..Filter::default() }, ..ColliderDef::new(shape) };
    world.add_collider(plank, ghost(Shape::rectangle(fx!(4), fx!(0.25))?))?;
    for (side, damping) in [(2, fx!(0)), (-2, fx!(0.25))] {
        world.add_field(FieldKind::Spring {
            near: Attachment { body: plank, point: vec2(side, 0) },
            far: End::World(vec2(20 + side, 5)),
            spring: SpringConstants { rest: fx!(4), stiffness: fx!(50), damping },
        })?;
    }
    let wind = FieldKind::Drag { linear: fx!(0), quadratic: fx!(0.02), wind: vec2(3, 0) };
    world.add_field(ForceField { kind: wind, force_groups: 2 })?;
    let star =
        world.add_body(BodyDef { position: vec2(0, 100), velocity: vec2(fx!(0.5), 0), ..BodyDef::kinematic() })?;
    world.add_body(BodyDef {
        position: vec2(5, 100),
        velocity: vec2(0, 14),
        gravity_scale: fx!(0),
        linear_damping: Some(Damping::NONE),
        force_groups: 4,
        ..BodyDef::dynamic()
    })?;
    let mu = FxFactor::parse("1000").expect("a number");
    let centre = End::Body(Attachment::centre(star));
    world.add_field(ForceField { kind: FieldKind::Attractor { centre, mu, softening: fx!(0) }, force_groups: 4 })?;
    let rocket = world.add_body(BodyDef {
        mass: Mass::Explicit { mass: fx!(3), inertia: fx!(2) },
        position: vec2(-20, 0),
        ..BodyDef::dynamic()
    })?;
    world.add_collider(rocket, ghost(Shape::polygon(&[vec2(fx!(-0.5), -1), vec2(fx!(0.5), -1), vec2(0, 1)])?))?;
    let at = Attachment { body: rocket, point: vec2(fx!(0.01), -1) };
    world.add_field(FieldKind::Thrust { at, force: vec2(0, 40) })?;
    let region = Region::Box { min: vec2(-30, 5), max: vec2(0, 50) };
    world.add_field(FieldKind::Zone { region, acceleration: vec2(1, 0) })?;
    Ok((world, ball, rocket))
}

fn play(world: &mut World, ball: BodyId, rocket: BodyId, tick: u32) -> Result<(), Error> {
    if tick % 60 == 0 {
        let action = ForceOrImpulse::Impulse { impulse: vec2(0, 20), point: Some(vec2(fx!(0.5), 0)) };
        world.apply(ball, action, ApplyOptions { frame: Frame::Body, wake: true })?;
    }
    if tick % 90 < 30 {
        world.apply_torque(rocket, fx!(0.125))?;
    }
    if tick == 100 {
        world.apply_force(ball, vec2(100, 0))?;
    }
    if tick == 200 {
        let up = vec2(0, 5);
        world.set_velocity(ball, up)?;
    }
    Ok(())
}

#[test]
fn the_golden_hashes_are_those_of_the_library() -> Result<(), Box<dyn std::error::Error>> {
    let (mut world, ball, rocket) = build()?;
    for tick in 0..TICKS {
        play(&mut world, ball, rocket, tick)?;
        assert!(world.step().faults.is_empty());
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let scene = Scene::parse(&fs::read_to_string(root.join(SCENE))?)?;
    let mut run = scene.start::<Fx>()?;
    for _ in 0..TICKS {
        run.advance()?;
    }
    let header = format!(
        "/* Written by capi/tests/golden.rs from the library: UMBRA_BLESS=1. */\n\
         #define GOLDEN_TICKS {TICKS}\n\
         #define GOLDEN_STATE_HASH UINT64_C(0x{:016x})\n\
         #define GOLDEN_PHYSICS_HASH UINT64_C(0x{:016x})\n\
         /* Of {SCENE}. */\n\
         #define GOLDEN_SCENE_TICKS {TICKS}\n\
         #define GOLDEN_SCENE_HASH UINT64_C(0x{:016x})\n",
        world.state_hash(),
        world.physics_hash(),
        run.world().state_hash(),
    );
    let file = root.join("examples/c/golden.h");
    if std::env::var("UMBRA_BLESS").is_ok_and(|value| value == "1") {
        fs::write(&file, &header)?;
    }
    assert_eq!(
        fs::read_to_string(&file)?,
        header,
        "UMBRA_BLESS=1 cargo test --test golden, if the physics version changed"
    );
    Ok(())
}
