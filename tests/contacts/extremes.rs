//! Large impulses on light bodies, kinematic bodies that push, and impacts within a step.

use umbra_physics::{BodyDef, BodyId, ColliderDef, Fx, Material, Shape, TimeStep, Vec2, World, WorldDef, fx, vec2};

fn still() -> World {
    World::new(WorldDef { time_step: TimeStep::hz(60), sleep_after: None, ..WorldDef::default() }).expect("a world")
}

fn heavy_world() -> World {
    let mut world = still();
    world.set_gravity(vec2(0, -10)).expect("it");
    let ground = BodyDef { position: vec2(0, -1), ..BodyDef::fixed() };
    world.add_body(ground.with_collider(Shape::rectangle(100, 2).expect("it"))).expect("it");
    world
}

fn square(world: &mut World, size: Fx, position: Vec2, density: i32) -> BodyId {
    let collider =
        ColliderDef { density: density.into(), ..ColliderDef::new(Shape::rectangle(size, size).expect("it")) };
    world.add_body(BodyDef { position, ..BodyDef::dynamic().with_collider(collider) }).expect("it")
}

/// A box of 400 kg falls by 1.5 m onto one of 250 g. (In floats the light one never exceeds 5.5 m/s.)
#[test]
fn a_light_box_under_a_heavy_one_is_not_shot_out() {
    for density in [3, 10, 30] {
        let mut world = heavy_world();
        let light = square(&mut world, fx!(0.5), vec2(0, fx!(0.25)), 1);
        square(&mut world, fx!(2), vec2(0, 3), density);
        for _ in 0..600 {
            world.step();
            let speed = world.body(light).expect("it").velocity().length();
            assert!(speed < fx!(6), "{density}: {speed}");
        }
    }
}

/// A box carries 1,000 times its mass, which sinks in by less than 2 cm.
#[test]
fn a_box_carries_a_thousand_times_its_mass() {
    let mut world = heavy_world();
    square(&mut world, fx!(1), vec2(0, fx!(0.5)), 1);
    let load = square(&mut world, fx!(1), vec2(0, fx!(1.5)), 1000);
    (0..600).for_each(|_| _ = world.step());
    let height = world.body(load).expect("it").position().y;
    assert!(height > fx!(1.48), "{height}");
}

/// A plate that presses a box of 1 kg against a wall and is taken away. (In floats the box leaves at 19 m/s.)
#[test]
fn a_box_that_was_pressed_leaves_at_a_bounded_speed() {
    let mut world = heavy_world();
    let wall = BodyDef { position: vec2(fx!(5.5), 5), ..BodyDef::fixed() };
    world.add_body(wall.with_collider(Shape::rectangle(1, 10).expect("it"))).expect("it");
    let plate = BodyDef { position: vec2(-2, fx!(0.6)), velocity: vec2(5, 0), ..BodyDef::kinematic() };
    let plate = world.add_body(plate.with_collider(Shape::rectangle(fx!(0.5), 1).expect("it"))).expect("it");
    let pressed = square(&mut world, fx!(1), vec2(0, fx!(0.5)), 1);
    for tick in 0..300 {
        if tick == 76 {
            world.remove_body(plate).expect("it");
        }
        world.step();
        let speed = world.body(pressed).expect("it").velocity().length();
        assert!(speed < fx!(30), "{tick}: {speed}");
    }
}

/// v' = V + e·(V − v) off a paddle at V.
#[test]
fn a_paddle_gives_its_speed_and_the_rebound() {
    for (paddle, restitution, ball) in
        [(10, fx!(1), 0), (10, fx!(0.5), 0), (5, fx!(0.8), -5), (2, fx!(0.8), -10), (-2, fx!(0.8), -10)]
    {
        let material = Material { friction: fx!(0), restitution, ..Material::default() };
        let with = |shape| ColliderDef { material, ..ColliderDef::new(shape) };
        let mut world = still();
        let plate = BodyDef { position: vec2(-2, 0), velocity: vec2(paddle, 0), ..BodyDef::kinematic() };
        world.add_body(plate.with_collider(with(Shape::rectangle(1, 4).expect("it")))).expect("it");
        let disc = BodyDef { velocity: vec2(ball, 0), ..BodyDef::dynamic() };
        let disc = world.add_body(disc.with_collider(with(Shape::circle(fx!(0.3)).expect("it")))).expect("it");
        (0..60).for_each(|_| _ = world.step());
        let speed = world.body(disc).expect("it").velocity().x;
        let expected = Fx::from(paddle) + restitution * Fx::from(paddle - ball);
        assert!((speed - expected).abs() < fx!(0.001), "{paddle}, {restitution}, {ball}: {speed} for {expected}");
    }
}

/// A disc of 0.375 m with a spin of 48 rad/s lands at 4.5 m/s: friction takes μ·v = v/4 at its rim, whenever in the step it lands.
#[test]
fn a_landing_takes_the_spin_that_friction_takes_at_the_rim() {
    for height in 0..10 {
        let surface = Material { friction: fx!(0.25), ..Material::default() };
        let with = |shape| ColliderDef { material: surface, ..ColliderDef::new(shape) };
        let mut world = still();
        world.set_gravity(vec2(0, -10)).expect("it");
        let floor = BodyDef { position: vec2(0, -1), ..BodyDef::fixed() };
        world.add_body(floor.with_collider(with(Shape::rectangle(100, 2).expect("it")))).expect("it");
        let position = vec2(0, fx!(1.375) + Fx::from_ratio(height, 100));
        let disc = BodyDef { position, angular_velocity: fx!(-48), ..BodyDef::dynamic() };
        let disc = world.add_body(disc.with_collider(with(Shape::circle(fx!(0.375)).expect("it")))).expect("it");
        // Up to the step in which it lands.
        while world.body(disc).expect("it").velocity().x == Fx::ZERO {
            world.step();
        }
        let body = world.body(disc).expect("it");
        // I·Δω = R·m·Δv with I = m·R²/2.
        let expected = fx!(2) * body.velocity().x / fx!(0.375);
        let spin = body.angular_velocity() + fx!(48);
        assert!((spin / expected - fx!(1)).abs() < fx!(0.001), "{height}: {spin} for {expected}");
    }
}
