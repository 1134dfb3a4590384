//! Surfaces that move, and the rules by which two surfaces become one, against closed forms.

use super::scenes::{def, ground, square, world};
use umbra_physics::{
    BodyDef, ColliderDef, Fx, Geometry, Material, MixRule, Scalar, Shape, Symmetry, Vec2, World, WorldDef, fx, vec2,
};

/// A ground with this surface.
fn belt(material: Material) -> BodyDef {
    let mut ground = ground().expect("a ground");
    ground.colliders[0].material = material;
    ground
}

/// A belt whose top moves to the right at this speed, with a friction of 0.5 against all.
fn to_the_right(speed: Fx) -> Material {
    Material { friction: fx!(0.5), friction_rule: MixRule::Minimum, surface_speed: -speed, ..Material::default() }
}

fn near(value: Fx, expected: Fx, bound: Fx) {
    assert!((value - expected).abs() <= bound, "{value} for {expected}");
}

/// A box on a belt is accelerated by μ·g until it moves as the belt does, and then stays at that speed.
#[test]
fn a_belt_carries_a_box() {
    for speed in [fx!(2), fx!(-2), fx!(100), fx!(1024)] {
        let bodies = [belt(to_the_right(speed)), square(Vec2::new(fx!(0), fx!(0.5)), 1).expect("a square")];
        let (mut world, ids) = world(WorldDef { ..def() }, bodies).expect("a scene");
        for tick in 1..=60 {
            world.step();
            let velocity = world.body(ids[1]).expect("the box").velocity();
            // Half of 10 m/s², up to the speed of the belt.
            let slipping = fx!(5) * Fx::from_ratio(tick, 60);
            let expected = slipping.min(speed.abs()) * speed.signum();
            // The unit of velocities in the solver grows with the speed: 2^-14 m/s at 1,024 m/s.
            near(velocity.x, expected, fx!(0.002) + speed.abs() / 100_000);
        }
    }
}

/// Two surfaces that move add their speeds; the bodies of a pair that both can move keep their momentum.
#[test]
fn belts_on_both_sides_add_up() {
    let mut above = square(Vec2::new(fx!(0), fx!(0.5)), 1).expect("a square");
    above.colliders[0].material = to_the_right(fx!(-1));
    let (mut world, ids) = world(def(), [belt(to_the_right(fx!(2))), above]).expect("a scene");
    (0..120).for_each(|_| _ = world.step());
    // The belt runs at 2 m/s to the right, and so does the bottom of the box at 1 m/s: the box takes up the difference.
    near(world.body(ids[1]).expect("the box").velocity().x, fx!(1), fx!(0.001));
}

/// Two boxes on a belt, one upon the other, with surfaces of their own; in every second column the upper one is the first body.
fn column(number: i32) -> [BodyDef; 2] {
    let of_height = |height: i32| {
        let offset = if height == 0 { Fx::ZERO } else { fx!(0.125) };
        let position = Vec2::new(Fx::from(number * 3 - 45) + offset, Fx::from(height) + fx!(0.5));
        let surface = Fx::from(number * 2 + height);
        let mut body = square(position, 1).expect("a square");
        body.colliders[0].material = Material {
            friction: fx!(0.1) + surface / 100,
            restitution: surface / 200,
            surface_speed: (surface - fx!(20.5)) / 8,
            rolling_resistance: surface / 1000,
            ..Material::default()
        };
        body
    };
    if number % 2 == 0 { [0, 1].map(of_height) } else { [1, 0].map(of_height) }
}

/// The step keeps the mixed coefficients of sixteen materials: with 61 of them each column moves as it does alone, to the bit.
#[test]
fn each_pair_of_many_surfaces_has_its_own_coefficients() {
    let (mut all, ids) =
        world(def(), [belt(to_the_right(fx!(1)))].into_iter().chain((0..30).flat_map(column))).expect("a scene");
    (0..60).for_each(|_| _ = all.step());
    for number in 0..30 {
        let alone = [belt(to_the_right(fx!(1)))].into_iter().chain(column(number));
        let (mut alone, ids_alone) = world(def(), alone).expect("a scene");
        (0..60).for_each(|_| _ = alone.step());
        for k in 1..=2 {
            let together = all.body(ids[number as usize * 2 + k]).expect("a box");
            let alone = alone.body(ids_alone[k]).expect("a box");
            assert_eq!(together.position_exact(), alone.position_exact(), "column {number}");
            assert_eq!(together.velocity_exact(), alone.velocity_exact(), "column {number}");
            assert_ne!(together.velocity().x, fx!(0), "column {number}");
        }
    }
}

/// A disc on a belt that rolls without slip moves at a third of the belt's speed.
#[test]
fn a_disc_on_a_belt_spins_up() {
    let disc = ColliderDef::new(Shape::circle(fx!(0.5)).expect("a disc"));
    let disc = BodyDef { position: vec2(0, fx!(0.5)), ..BodyDef::dynamic().with_collider(disc) };
    let (mut world, ids) = world(def(), [belt(to_the_right(fx!(3))), disc]).expect("a scene");
    (0..120).for_each(|_| _ = world.step());
    let disc = world.body(ids[1]).expect("the disc");
    // An impulse J at the rim gives m·v = J and I·ω = J·r with I = m·r²/2, so ω·r = 2·v; the rim moves at v + ω·r = 3 m/s.
    near(disc.velocity().x, fx!(1), fx!(0.002));
    near(disc.angular_velocity(), fx!(4), fx!(0.01));
}

#[test]
fn a_mirrored_belt_carries_the_other_way() {
    let bodies = [belt(to_the_right(fx!(2))), square(Vec2::new(fx!(0.25), fx!(0.5)), 1).expect("a square")];
    let (mut world, _) = world(def(), bodies).expect("a scene");
    let image = |world: &World| Symmetry::MIRROR.world(world).expect("an image");
    let mut mirrored = image(&world);
    for _ in 0..100 {
        world.step();
        mirrored.step();
        assert_eq!(image(&world).state_hash(), mirrored.state_hash());
    }
}

/// The friction that a box slides with, and its restitution, by the rules of both surfaces.
#[test]
fn rules_mix_coefficients() {
    let rules = [
        (MixRule::Standard, MixRule::Standard, fx!(0.4)),
        (MixRule::GeometricMean, MixRule::Standard, fx!(0.4)),
        (MixRule::Mean, MixRule::GeometricMean, fx!(0.5)),
        (MixRule::Mean, MixRule::Minimum, fx!(0.2)),
        (MixRule::Product, MixRule::Minimum, fx!(0.16)),
        (MixRule::Product, MixRule::Maximum, fx!(0.8)),
    ];
    for (rule, ground_rule, friction) in rules {
        for (rule, ground_rule) in [(rule, ground_rule), (ground_rule, rule)] {
            let surface = |friction, friction_rule| Material { friction, friction_rule, ..Material::default() };
            let mut slider = square(Vec2::new(fx!(0), fx!(0.5)), 1).expect("a square");
            slider.colliders[0].material = surface(fx!(0.2), rule);
            slider.velocity = vec2(20, 0);
            let (mut world, ids) = world(def(), [belt(surface(fx!(0.8), ground_rule)), slider]).expect("a scene");
            (0..60).for_each(|_| _ = world.step());
            let lost = fx!(20) - world.body(ids[1]).expect("the box").velocity().x;
            near(lost, friction * fx!(10), fx!(0.02));
        }
    }
}

#[test]
fn rules_mix_restitution() {
    let rules = [(MixRule::Standard, fx!(0.8)), (MixRule::Minimum, fx!(0.2)), (MixRule::Product, fx!(0.16))];
    for (rule, restitution) in rules {
        let surface = |restitution| Material { restitution, restitution_rule: rule, ..Material::default() };
        let disc =
            ColliderDef { material: surface(fx!(0.2)), ..ColliderDef::new(Shape::circle(fx!(0.5)).expect("a disc")) };
        let disc =
            BodyDef { position: vec2(0, fx!(0.6)), velocity: vec2(0, -30), ..BodyDef::dynamic().with_collider(disc) };
        let free = WorldDef { gravity: vec2(0, 0), ..def() };
        let (mut world, ids) = world(free, [belt(surface(fx!(0.8))), disc]).expect("a scene");
        (0..10).for_each(|_| _ = world.step());
        near(world.body(ids[1]).expect("the disc").velocity().y, fx!(30) * restitution, fx!(0.001));
    }
}

/// The velocity of a box on a belt of 2 m/s after two seconds, and the friction of a pair by each rule.
fn carried<S: Scalar>() -> S {
    let scalar = |value| S::from_fx(value);
    let material = Material { friction: scalar(fx!(0.5)), surface_speed: scalar(fx!(-2)), ..Material::default() };
    let collider = |width, height| -> ColliderDef<S> {
        ColliderDef {
            material,
            ..ColliderDef::new(
                Shape::new(Geometry::Rectangle { width: scalar(width), height: scalar(height) }).expect("a box"),
            )
        }
    };
    let gravity = Vec2::new(S::ZERO, scalar(fx!(-10)));
    let mut world = World::with_scalar(WorldDef { gravity, ..WorldDef::default() }).expect("a world");
    let at = |y| Vec2::new(S::ZERO, scalar(y));
    world
        .add_body(BodyDef { position: at(fx!(-1)), ..BodyDef::fixed().with_collider(collider(fx!(100), fx!(2))) })
        .expect("a belt");
    let mut above = collider(fx!(1), fx!(1));
    above.material.surface_speed = S::ZERO;
    let id =
        world.add_body(BodyDef { position: at(fx!(0.5)), ..BodyDef::dynamic().with_collider(above) }).expect("a box");
    (0..120).for_each(|_| _ = world.step());
    world.body(id).expect("the box").velocity().x
}

#[test]
fn belts_move_in_floats_too() {
    assert!((carried::<f64>() - 2.0).abs() < 1e-3, "{}", carried::<f64>());
    assert!((carried::<f32>() - 2.0).abs() < 1e-3, "{}", carried::<f32>());
    near(carried::<Fx>(), fx!(2), fx!(0.001));
}
