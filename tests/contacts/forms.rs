//! Closed forms.

use super::scenes::{def, ground, material, square, world};
use umbra_physics::{BodyDef, ColliderDef, Fx, Shape, Vec2, fx, vec2};

#[test]
fn a_flat_box_dropped_with_restitution_bounces_straight_up() {
    let bouncy = material(fx!(0.6), fx!(0.5));
    let mut ground = ground().expect("a ground");
    ground.colliders[0].material = bouncy;
    let mut falling = square(vec2(0, fx!(2.5)), 1).expect("a square");
    falling.colliders[0].material = bouncy;
    let (mut world, ids) = world(def(), [ground, falling]).expect("a scene");
    let (mut highest, mut has_bounced) = (fx!(0), false);
    for _ in 0..180 {
        world.step();
        let body = world.body(ids[1]).expect("a body");
        assert_eq!((body.position().x, body.angle_exact().to_bits()), (fx!(0), 0));
        has_bounced |= body.velocity().y > fx!(0);
        if has_bounced {
            highest = highest.max(body.position().y - fx!(0.5));
        }
    }
    // 2 m · e²
    assert!((highest - fx!(0.5)).abs() < fx!(0.001), "{highest}");
}

#[test]
fn a_body_that_touches_nothing_keeps_the_bits_of_a_free_one() {
    let disc = |x| BodyDef {
        position: vec2(x, 5),
        velocity: vec2(1, 2),
        angular_velocity: fx!(3),
        ..BodyDef::dynamic().with_collider(Shape::circle(fx!(0.5)).expect("a disc"))
    };
    let (mut world, ids) = world(def(), [ground().expect("a ground"), disc(0)]).expect("a scene");
    let free = BodyDef { colliders: Vec::new(), ..disc(0) };
    let (mut alone, alone_ids) = super::scenes::world(def(), [free]).expect("a scene");
    let mut steps = 0;
    loop {
        world.step();
        alone.step();
        let [pushed, free] = [world.body(ids[1]).expect("it"), alone.body(alone_ids[0]).expect("it")];
        // The last pass of the solver looks a sub-step ahead, a fifth of a step.
        let ahead = free.velocity().y * Fx::from_ratio(1, 300);
        if free.position().y + ahead < fx!(0.5) {
            assert!(pushed.position().y > fx!(0.49));
            break;
        }
        assert_eq!(pushed.position_exact(), free.position_exact());
        assert_eq!(pushed.angle_exact(), free.angle_exact());
        steps += 1;
    }
    assert!(steps > 60);
}

/// The height that a box ends at, and its largest speed after a second.
#[test]
fn a_stack_comes_to_rest() {
    let mut bodies = vec![ground().expect("a ground")];
    for row in 0..10 {
        bodies.push(square(Vec2::new(fx!(0), fx!(0.5) + row.into()), row as u64).expect("a square"));
    }
    let (mut world, ids) = world(def(), bodies).expect("a scene");
    (0..300).for_each(|_| _ = world.step());
    let top = world.body(ids[10]).expect("the top");
    assert!((top.position().y - fx!(9.5)).abs() < fx!(0.05), "{}", top.position());
    assert_eq!(top.position().x, Fx::ZERO);
    assert!(top.velocity().y.abs() < fx!(0.001), "{}", top.velocity());
}

#[test]
fn momentum_of_what_is_free_is_kept() {
    let ball = |x: i32, vx: i32, mass: Fx| BodyDef {
        position: vec2(x, 0),
        velocity: vec2(vx, 0),
        mass: umbra_physics::Mass::Kilograms(mass),
        ..BodyDef::dynamic().with_collider(ColliderDef {
            material: material(fx!(0), fx!(1)),
            ..ColliderDef::new(Shape::circle(fx!(0.5)).expect("a disc"))
        })
    };
    let def = umbra_physics::WorldDef { gravity: vec2(0, 0), ..def() };
    let (mut world, ids) = world(def, [ball(-2, 3, fx!(1)), ball(2, -1, fx!(3))]).expect("a scene");
    (0..120).for_each(|_| _ = world.step());
    let [a, b] = [0, 1].map(|i| world.body(ids[i]).expect("a ball").velocity());
    // An elastic impact: (m1 − m2)·u1 + 2·m2·u2 over m1 + m2, and so on.
    assert!((a.x + fx!(3)).abs() < fx!(0.0001) && (b.x - fx!(1)).abs() < fx!(0.0001), "{a} {b}");
}
