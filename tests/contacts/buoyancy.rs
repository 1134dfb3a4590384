//! Fluids: floating heights, drag, sleep, mirror images, restored worlds, and definitions that are refused.

use std::f64::consts::{PI, TAU};

use super::scenes::through_bytes;
use umbra_physics::scalar::ToF64 as _;
use umbra_physics::{
    Activity, BodyDef, BodyId, ColliderDef, Error, FieldKind, ForceField, Fx, Integrator, Locks, Mass, Quantity, Shape,
    Symmetry, TimeStep, Vec2, World, WorldDef, fx, vec2,
};

/// A fluid of 4 kg/m² in a basin 40 m wide and 10 m deep, with its surface at a height of 0.
const POOL: FieldKind = FieldKind::Buoyancy {
    min: Vec2 { x: fx!(-20), y: fx!(-10) },
    max: Vec2 { x: fx!(20), y: fx!(0) },
    density: fx!(4),
    linear_drag: fx!(6),
    angular_drag: fx!(3),
    flow: Vec2::ZERO,
};

/// A pool that no body is in.
const FAR_POOL: FieldKind = FieldKind::Buoyancy {
    min: Vec2 { x: fx!(500), y: fx!(-10) },
    max: Vec2 { x: fx!(520), y: fx!(0) },
    density: fx!(4),
    linear_drag: fx!(0),
    angular_drag: fx!(0),
    flow: Vec2::ZERO,
};

fn world(field: FieldKind) -> World {
    let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() }).expect("a world");
    world.add_field(field).expect("a field");
    world
}

/// A world in which nothing falls asleep.
fn sleepless(field: FieldKind) -> World {
    let mut world = world(field);
    world.set_sleep_after(None).expect("it may be");
    world
}

fn floating(shape: Shape, density: Fx) -> BodyDef {
    BodyDef::dynamic().with_collider(ColliderDef { density, ..ColliderDef::new(shape) })
}

fn steps(world: &mut World, count: u32) {
    (0..count).for_each(|_| _ = world.step());
}

/// The height and the angle of a body, the angle between −π and π.
fn pose(world: &World, body: BodyId) -> (f64, f64) {
    let body = world.body(body).expect("it is there");
    let angle = body.angle().to_f64();
    (body.position().y.to_f64(), if angle > PI { angle - TAU } else { angle })
}

#[test]
fn a_box_floats_as_deep_as_its_density_says() {
    for density in [fx!(0.5), fx!(1), fx!(2), fx!(3.5)] {
        let shape = Shape::rectangle(4, 1).expect("a shape");
        let def = BodyDef { position: vec2(0, 1), ..floating(shape, density) };
        let share = density.to_f64() / 4.0;
        for (mut world, bound) in [(sleepless(POOL), 1e-7), (world(POOL), 0.025)] {
            let body = world.add_body(def.clone()).expect("a body");
            steps(&mut world, 3_000);
            let (height, angle) = pose(&world, body);
            // Where it sleeps it was slower than 0.05 m/s for half a second.
            assert!((height - (0.5 - share)).abs() < bound && angle == 0.0, "{density}: {height} {angle}");
            let sleeps = world.body(body).expect("it is there").activity() == Activity::Asleep;
            assert_eq!(sleeps, world.def().sleep_after.is_some());
        }
    }
}

#[test]
fn a_tilted_box_rights_itself() {
    let mut world = sleepless(POOL);
    let shape = Shape::rectangle(4, 1).expect("a shape");
    let def = BodyDef { angle: fx!(0.6), position: vec2(0, 0), ..floating(shape, fx!(2)) };
    let body = world.add_body(def).expect("a body");
    steps(&mut world, 3_000);
    let (height, angle) = pose(&world, body);
    assert!(height.abs() < 1e-7 && angle.abs() < 1e-6, "{height} {angle}");
}

/// The share of a disc of radius 1 that is below the line at a height over its centre.
fn below(height: f64) -> f64 {
    0.5 + (height * (1.0 - height * height).sqrt() + height.asin()) / PI
}

#[test]
fn a_disc_floats_where_its_segment_weighs_as_much() {
    for density in [fx!(1), fx!(2), fx!(3)] {
        let mut world = sleepless(POOL);
        let body = world.add_body(floating(Shape::circle(fx!(1)).expect("a shape"), density)).expect("a body");
        steps(&mut world, 3_000);
        let (height, angle) = pose(&world, body);
        let share = below(-height);
        // Its area is right within 2^-10 m².
        assert!((share - density.to_f64() / 4.0).abs() < 0.000_976 / PI, "{density}: {share}");
        assert_eq!(angle, 0.0);
    }
}

#[test]
fn the_drag_is_that_of_its_equation() {
    let still = WorldDef { sleep_after: None, time_step: TimeStep::hz(50), ..WorldDef::default() };
    let mut world = World::new(still).expect("a world");
    let flow = vec2(fx!(0.5), 0);
    world.add_field(fluid(POOL, fx!(0.5), flow)).expect("a field");
    let (velocity, angular_velocity) = (vec2(3, -1), fx!(2));
    let def = floating(Shape::rectangle(2, 1).expect("a shape"), fx!(2));
    let body = world.add_body(BodyDef { position: vec2(0, -5), velocity, angular_velocity, ..def }).expect("a body");
    steps(&mut world, 50);
    let body = world.body(body).expect("it is there");
    // 2 m² of 0.5 N·s/m each, 4 kg; 2 m² of 0.5 N·m·s each, 4·5/12 kg·m².
    let (left, turns_left) = ((-0.25_f64).exp(), (-0.6_f64).exp());
    let [x, y] = body.velocity().to_f64();
    let spin = body.angular_velocity().to_f64();
    assert!((x - (0.5 + 2.5 * left)).abs() < 1e-8 && (y + left).abs() < 1e-8, "{x} {y}");
    assert!((spin - 2.0 * turns_left).abs() < 1e-8, "{spin}");
}

/// Replaces the drags and the flow of a fluid.
fn fluid(kind: FieldKind, drag: Fx, flow: Vec2) -> FieldKind {
    match kind {
        FieldKind::Buoyancy { min, max, density, .. } => {
            FieldKind::Buoyancy { min, max, density, linear_drag: drag, angular_drag: drag, flow }
        }
        command => command,
    }
}

#[test]
fn no_drag_is_too_strong() {
    for integrator in [
        Integrator::ExplicitEuler,
        Integrator::SymplecticEuler,
        Integrator::VelocityVerlet,
        Integrator::Yoshida4,
        Integrator::PublishedVerlet,
    ] {
        let mut world =
            World::new(WorldDef { integrator, gravity: vec2(0, -10), ..WorldDef::default() }).expect("a world");
        world.add_field(fluid(POOL, fx!(1000000), vec2(0, 0))).expect("a field");
        let def = floating(Shape::rectangle(1, 1).expect("a shape"), fx!(1));
        // It comes from above: the first half of the step it is in no fluid.
        let def = BodyDef { position: vec2(0, fx!(0.75)), velocity: vec2(9, -30), angular_velocity: fx!(40), ..def };
        let body = world.add_body(def).expect("a body");
        for tick in 0..60 {
            assert!(world.step().faults.is_empty(), "{integrator:?} {tick}");
            let body = world.body(body).expect("it is there");
            let [x, y] = body.velocity().to_f64();
            assert!(
                x.abs() <= 9.1 && y.abs() <= 31.0 && body.angular_velocity().to_f64().abs() <= 41.0,
                "{integrator:?} {tick}: {x} {y}"
            );
        }
        let body = world.body(body).expect("it is there");
        let [x, y] = body.velocity().to_f64();
        assert!(
            x.abs() < 1e-3 && y.abs() < 1e-2 && body.angular_velocity().to_f64().abs() < 1e-3,
            "{integrator:?} {x} {y}"
        );
    }
}

/// Shapes of all kinds, in colliders off the centres of their bodies, at the surface and at a side of a fluid, and in another one.
fn crowd() -> World {
    let mut world = world(fluid(POOL, fx!(2.3), vec2(fx!(0.7), fx!(-0.2))));
    let corner = FieldKind::Buoyancy {
        min: vec2(fx!(-3.3), fx!(-4.1)),
        max: vec2(fx!(2.7), fx!(1.9)),
        density: fx!(1.7),
        linear_drag: fx!(0.4),
        angular_drag: fx!(0),
        flow: vec2(0, fx!(0.3)),
    };
    world.add_field(corner).expect("a field");
    let disc = Shape::circle(fx!(0.7)).expect("a shape");
    let wedge = Shape::polygon(&[vec2(0, 0), vec2(2, fx!(0.3)), vec2(fx!(0.9), fx!(1.6))]).expect("a shape");
    let stone = Shape::rounded_polygon(&[vec2(0, 0), vec2(1, 0), vec2(fx!(0.4), fx!(0.8))], fx!(0.3)).expect("a shape");
    let shapes = [
        disc.clone(),
        Shape::rectangle(fx!(1.3), fx!(0.6)).expect("a shape"),
        Shape::capsule(fx!(1.1), fx!(0.4)).expect("a shape"),
        wedge.clone(),
        stone,
    ];
    for (i, shape) in shapes.into_iter().enumerate() {
        for (k, height) in [fx!(0.4), fx!(-1.3)].into_iter().enumerate() {
            let number = (2 * i + k) as i32;
            let (x, angle) = (Fx::from(4 * number - 20) + fx!(0.1), Fx::from_ratio(number.into(), 3));
            let side =
                ColliderDef { position: vec2(fx!(0.3), fx!(-0.2)), angle: fx!(0.4), ..ColliderDef::new(shape.clone()) };
            let def = BodyDef { position: vec2(x, height), angle: Fx::ZERO, key: number as u64, ..BodyDef::dynamic() };
            let def = def
                .with_collider(side)
                .with_collider(ColliderDef { position: vec2(fx!(-0.5), fx!(0.4)), ..ColliderDef::new(disc.clone()) });
            let body = world.add_body(def).expect("a body");
            world.set_angular_velocity(body, angle).expect("a velocity");
        }
    }
    world
}

#[test]
fn the_mirror_image_of_a_fluid_does_the_same_to_the_bit() {
    for symmetry in [Symmetry::MIRROR, Symmetry::FLIP, Symmetry::DIAGONAL, Symmetry::TURN] {
        let mut world = crowd();
        let mut image = symmetry.world(&world).expect("an image");
        for tick in 0..400 {
            world.step();
            image.step();
            if tick % 20 == 0 || tick < 10 {
                let now = symmetry.world(&world).expect("an image");
                assert_eq!(now.first_difference(&image), None, "{} at {tick}", symmetry.name());
            }
        }
    }
}

#[test]
fn a_restored_world_goes_on_to_the_bit() {
    let mut world = crowd();
    for tick in 0..200 {
        if tick == 50 {
            world.set_gravity(vec2(fx!(1.5), fx!(-8))).expect("a gravity");
        }
        if tick == 90 {
            let (id, _) = world.colliders().nth(3).expect("a collider");
            world.set_collider(id, ColliderDef::new(Shape::rectangle(2, 2).expect("a shape"))).expect("a collider");
        }
        if tick == 120 {
            let (id, _) = world.colliders().nth(5).expect("a collider");
            world.remove_collider(id).expect("a collider");
        }
        let mut restored = through_bytes(&world);
        world.step();
        restored.step();
        assert_eq!(world.state_hash(), restored.state_hash(), "{tick}");
    }
}

#[test]
fn a_floating_body_falls_asleep_and_a_change_of_the_fluid_wakes_it() {
    let rest = || {
        let mut world = world(POOL);
        let body = world.add_body(floating(Shape::rectangle(2, 1).expect("a shape"), fx!(2))).expect("a body");
        steps(&mut world, 600);
        assert_eq!(world.body(body).expect("it is there").activity(), Activity::Asleep);
        assert_eq!(world.body(body).expect("it is there").velocity(), vec2(0, 0));
        (world, body)
    };
    let (mut world, body) = rest();
    let (field, _) = world.fields().next().expect("a field");
    world.remove_field(field).expect("it is there");
    steps(&mut world, 60);
    assert!(pose(&world, body).0 < -4.0);

    let (mut world, body) = rest();
    let (field, _) = world.fields().next().expect("a field");
    world.set_field(field, fluid(POOL, fx!(6), vec2(1, 0))).expect("it is there");
    steps(&mut world, 600);
    // In a fluid that flows it stays awake, and ends as fast as the fluid.
    let view = world.body(body).expect("it is there");
    assert_eq!(view.activity(), Activity::Awake);
    assert!((view.velocity().x.to_f64() - 1.0).abs() < 1e-3);

    let (mut world, body) = rest();
    world.set_gravity(vec2(0, -5)).expect("a gravity");
    assert_eq!(world.body(body).expect("it is there").activity(), Activity::Awake);

    let (mut world, body) = rest();
    let heavy = BodyDef { position: vec2(0, 3), ..floating(Shape::circle(fx!(0.5)).expect("a shape"), fx!(3)) };
    world.add_body(heavy).expect("a body");
    let woke = (0..120)
        .any(|_| world.step().woke.contains(&body) || world.body(body).expect("there").activity() == Activity::Awake);
    assert!(woke);

    // Of another group: nothing changes for it.
    let (mut world, body) = rest();
    world.add_field(ForceField { kind: POOL, force_groups: 2 }).expect("a field");
    steps(&mut world, 2);
    assert_eq!(world.body(body).expect("it is there").activity(), Activity::Asleep);
}

/// A world without gravity with this field, and the tick in which a body at rest or at this speed falls asleep, if it does so within 90.
fn asleep_after(field: impl Into<ForceField>, def: BodyDef, each_tick: impl Fn(&mut World, BodyId)) -> Option<u32> {
    let mut world = World::new(WorldDef { sleep_after: Some(30), ..WorldDef::default() }).expect("a world");
    world.add_field(field).expect("a field");
    let body = world.add_body(def).expect("a body");
    (0..90).find(|_| {
        each_tick(&mut world, body);
        world.step().fell_asleep == [body]
    })
}

#[test]
fn only_what_floats_at_rest_counts_as_at_rest_while_it_moves_slowly() {
    let slow = |shape: Shape| BodyDef { velocity: vec2(fx!(0.03), 0), ..floating(shape, fx!(2)) };
    let square = || Shape::rectangle(1, 1).expect("a shape");
    let deep = BodyDef { position: vec2(0, -5), ..slow(square()) };
    let still = fluid(POOL, fx!(0), vec2(0, 0));
    assert_eq!(asleep_after(still, deep.clone(), |_, _| ()), Some(29));
    // In a fluid that flows as slowly, pushed all the time, or too fast.
    assert_eq!(asleep_after(fluid(POOL, fx!(6), vec2(fx!(0.03), 0)), deep.clone(), |_, _| ()), None);
    let push = |world: &mut World, body| world.apply_force(body, vec2(fx!(0.01), 0)).expect("a body");
    assert_eq!(asleep_after(still, deep.clone(), push), None);
    assert_eq!(asleep_after(still, BodyDef { velocity: vec2(1, 0), ..deep.clone() }, |_, _| ()), None);
    // One that feels another fluid alone; above the surface; and beside a corner of the fluid.
    let add_far = |world: &mut World, _| _ = world.add_field(ForceField { kind: FAR_POOL, force_groups: 2 });
    let ours = ForceField { kind: still, force_groups: 1 };
    assert_eq!(asleep_after(ours, deep.clone(), add_far), Some(29));
    assert_eq!(asleep_after(ours, BodyDef { force_groups: 2, ..deep }, add_far), None);
    let above = BodyDef { position: vec2(0, fx!(0.5)), ..slow(square()) };
    assert_eq!(asleep_after(still, above, |_, _| ()), None);
    let disc = Shape::circle(fx!(0.5)).expect("a shape");
    let corner = BodyDef { position: vec2(fx!(20.4), fx!(0.4)), ..slow(disc) };
    assert_eq!(asleep_after(still, corner, |_, _| ()), None);
}

#[test]
fn either_drag_may_be_too_stiff_for_the_stages_that_run_backwards() {
    let FieldKind::Buoyancy { min, max, density, flow, .. } = POOL else { unreachable!() };
    for (linear_drag, angular_drag, outside) in
        [(fx!(0.1), fx!(0.1), 0), (fx!(1000), fx!(0.1), 1), (fx!(0.1), fx!(1000), 1)]
    {
        let def = WorldDef { integrator: Integrator::Yoshida4, ..WorldDef::default() };
        let mut world = World::new(def).expect("a world");
        world.add_field(FieldKind::Buoyancy { min, max, density, linear_drag, angular_drag, flow }).expect("a field");
        let def = floating(Shape::rectangle(1, 1).expect("a shape"), fx!(2));
        world.add_body(BodyDef { position: vec2(0, -5), ..def }).expect("a body");
        assert_eq!(world.step().drag_outside, outside, "{linear_drag} {angular_drag}");
    }
}

#[test]
fn drag_is_for_bodies_that_feel_the_fluid_and_along_axes_that_are_free() {
    let (stiff, flow) = (fx!(1000), vec2(2, 1));
    let square = || floating(Shape::rectangle(1, 1).expect("a shape"), fx!(2));
    for integrator in [Integrator::VelocityVerlet, Integrator::Yoshida4] {
        let mut world = World::new(WorldDef { integrator, ..WorldDef::default() }).expect("a world");
        world.add_field(ForceField { kind: fluid(POOL, stiff, flow), force_groups: 1 }).expect("a field");
        world.add_field(ForceField { kind: FAR_POOL, force_groups: 2 }).expect("a field");
        let at = |x: i32| BodyDef { position: vec2(x, -5), velocity: vec2(1, 0), angular_velocity: fx!(1), ..square() };
        let bystander = world.add_body(BodyDef { force_groups: 2, ..at(-8) }).expect("a body");
        assert_eq!(world.step().drag_outside, 0);
        let locks = Locks { x: true, ..Locks::NONE };
        let guided = world.add_body(BodyDef { locks, velocity: vec2(0, 0), ..at(8) }).expect("a body");
        steps(&mut world, 60);
        let bystander = world.body(bystander).expect("it is there");
        assert_eq!((bystander.velocity(), bystander.angular_velocity()), (vec2(1, 0), fx!(1)));
        let guided = world.body(guided).expect("it is there");
        assert_eq!((guided.position().x, guided.velocity().x), (fx!(8), fx!(0)));
        assert!((guided.velocity().y - fx!(1)).abs() < fx!(0.001), "{}", guided.velocity());
    }
}

#[test]
fn bodies_without_area_get_no_lift() {
    let line = Shape::segment(vec2(-1, 0), vec2(1, 0)).expect("a shape");
    let square = || ColliderDef::new(Shape::rectangle(1, 1).expect("a shape"));
    let mass = |def: BodyDef| BodyDef { mass: Mass::Kilograms(fx!(1)), position: vec2(0, -5), ..def };
    for (def, sinks) in [
        (mass(BodyDef::dynamic()), true),
        (mass(BodyDef::dynamic().with_collider(line)), true),
        (mass(BodyDef::dynamic().with_collider(ColliderDef { sensor: true, ..square() })), true),
        (mass(BodyDef::dynamic().with_collider(square())), false),
        (BodyDef { force_groups: 0, ..mass(BodyDef::dynamic().with_collider(square())) }, true),
        (BodyDef { position: vec2(40, -5), ..mass(BodyDef::dynamic().with_collider(square())) }, true),
    ] {
        let mut world = world(fluid(POOL, fx!(0), vec2(0, 0)));
        let body = world.add_body(def).expect("a body");
        world.step();
        let y = world.body(body).expect("it is there").velocity().y;
        assert_eq!(y < Fx::ZERO, sinks, "{y}");
        // Without lift it falls freely, to the bit.
        if sinks {
            let mut free = World::new(*world.def()).expect("a world");
            let falling = free.add_body(mass(BodyDef::dynamic())).expect("a body");
            free.step();
            assert_eq!(y, free.body(falling).expect("it is there").velocity().y);
        }
    }
}

#[test]
fn a_fluid_out_of_range_is_refused() {
    let mut world = world(POOL);
    let hash = world.state_hash();
    let FieldKind::Buoyancy { min, max, density, linear_drag, angular_drag, flow } = POOL else { unreachable!() };
    let refused = |quantity| Err(Error::OutOfRange { quantity });
    let far = Fx::from_bits(i64::MAX);
    for (kind, quantity) in [
        (FieldKind::Buoyancy { min: max, max: min, density, linear_drag, angular_drag, flow }, Quantity::FluidBox),
        (
            FieldKind::Buoyancy { min: vec2(0, 1), max: vec2(1, 0), density, linear_drag, angular_drag, flow },
            Quantity::FluidBox,
        ),
        (FieldKind::Buoyancy { min, max: vec2(far, 0), density, linear_drag, angular_drag, flow }, Quantity::FluidBox),
        (
            FieldKind::Buoyancy { min, max, density: fx!(-1), linear_drag, angular_drag, flow },
            Quantity::ColliderDensity { value: fx!(-1) },
        ),
        (FieldKind::Buoyancy { min, max, density, linear_drag: fx!(-1), angular_drag, flow }, Quantity::Drag),
        (FieldKind::Buoyancy { min, max, density, linear_drag, angular_drag: fx!(-1), flow }, Quantity::Drag),
        (FieldKind::Buoyancy { min, max, density, linear_drag, angular_drag, flow: vec2(0, far) }, Quantity::Velocity),
    ] {
        assert_eq!(world.add_field(kind), refused(quantity), "{kind:?}");
    }
    assert_eq!(world.state_hash(), hash);
}
