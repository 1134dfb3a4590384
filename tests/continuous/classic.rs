//! Scenes in which engines tunnel.

use crate::seeds::run_seed;
use umbra_physics::{
    BodyDef, BodyId, BodyKind, ColliderDef, Fx, Locks, Mass, Material, Random, Shape, TimeStep, Vec2, World, WorldDef,
    fx, vec2,
};

fn world(rate: u32, gravity: Vec2) -> World {
    let def = WorldDef { time_step: TimeStep::hz(rate), gravity, sleep_after: None, ..WorldDef::default() };
    World::new(def).expect("a world")
}

fn add(world: &mut World, def: BodyDef, shape: Result<Shape, umbra_physics::Error>) -> BodyId {
    let material = Material { friction: fx!(0.3), restitution: fx!(0), ..Material::default() };
    let collider = ColliderDef { material, ..ColliderDef::new(shape.expect("a shape")) };
    world.add_body(def.with_collider(collider)).expect("a body")
}

/// Boxes and discs at a slope of 1:1,000 to 1:10 onto a thin floor, at 100 to 100,000 m/s.
#[test]
fn a_thin_floor_holds_at_grazing_angles() {
    for (i, slope) in [1000, 300, 100, 30, 10].into_iter().enumerate() {
        for speed in [100, 1_000, 10_000, 100_000] {
            for round in [false, true] {
                let mut world = world(60, vec2(0, -10));
                add(&mut world, BodyDef::fixed(), Shape::segment(vec2(-4096, 0), vec2(4096, 0)));
                let velocity = Vec2::new(Fx::from_ratio(speed, 1), Fx::from_ratio(-speed, slope));
                let def = BodyDef {
                    position: vec2(-4000, fx!(0.5)),
                    velocity,
                    angular_velocity: Fx::from(i as i32 * 7),
                    ..BodyDef::dynamic()
                };
                let shape = if round { Shape::circle(fx!(0.1)) } else { Shape::rectangle(fx!(0.2), fx!(0.1)) };
                let body = add(&mut world, def, shape);
                for tick in 0..60 {
                    world.step();
                    let at = world.body(body).expect("it").position();
                    assert!(at.y > fx!(0) || at.x > fx!(4096), "1:{slope} at {speed} m/s, tick {tick}: {at:?}");
                }
            }
        }
    }
}

/// A bar of 2 m turns on the spot, 0.9 m from a wall of 1 cm: its ends stay on this side. At 30,000 rad/s, 80 turns a tick, an end is up
/// to 3.6 cm too far.
#[test]
fn a_spinning_bar_stays_beside_a_wall() {
    for (spin, is_discrete) in [20, 100, 1_000, 1_000_000].into_iter().flat_map(|spin| [(spin, false), (spin, true)]) {
        for wall in [Shape::rectangle(fx!(0.01), 8), Shape::segment(vec2(0, -4), vec2(0, 4))] {
            let mut world = world(60, vec2(0, 0));
            add(&mut world, BodyDef { position: vec2(fx!(0.905), 0), ..BodyDef::fixed() }, wall);
            let def = BodyDef { angle: fx!(1.5), angular_velocity: spin.into(), ..BodyDef::dynamic() };
            let bar = add(&mut world, def, Shape::capsule(fx!(1.9), fx!(0.05)));
            world.do_without_continuous_collision(false, is_discrete);
            for tick in 0..60 {
                world.step();
                let bar = world.body(bar).expect("it");
                let (_, cos) = umbra_physics::Turn::from_radians(bar.angle()).sin_cos();
                let reach = cos.abs().checked_mul(fx!(0.95)).expect("it");
                let end = bar.position().x + reach;
                assert!(end < fx!(0.91), "{spin} rad/s, tick {tick}: {end}");
            }
        }
    }
}

/// A plate that comes within a step, and leaves 2 cm more than a disc between itself and a thin wall.
#[test]
fn bodies_pushed_at_a_wall_do_not_cross_it() {
    for from in [-1, -9, -90, -4_000] {
        let mut world = world(60, vec2(0, 0));
        add(&mut world, BodyDef::fixed(), Shape::rectangle(fx!(0.01), 100));
        let plate = BodyDef { position: vec2(from, fx!(0.1)), ..BodyDef::kinematic() };
        let plate = add(&mut world, plate, Shape::rectangle(fx!(0.5), 4));
        let disc = BodyDef { position: vec2(fx!(-0.5), 0), ..BodyDef::dynamic() };
        let disc = add(&mut world, disc, Shape::circle(fx!(0.1)));
        world.move_to(plate, vec2(fx!(-0.475), fx!(0.1)), fx!(0)).expect("it");
        for tick in 0..60 {
            world.step();
            let at = world.body(disc).expect("it").position();
            assert!(at.x < fx!(0) && at.x > fx!(-0.3), "from {from} m, tick {tick}: {at:?}");
        }
    }
}

/// A disc that another one strikes leaves its free path within the step: a wall beside that path stops it, also one that sleeps.
#[test]
fn a_body_struck_in_a_step_is_stopped_in_the_same_step() {
    for (wall, sleeps) in [
        (BodyDef::fixed(), false),
        (BodyDef::kinematic(), false),
        (BodyDef::fixed(), true),
        (BodyDef::kinematic(), true),
    ] {
        let mut world = world(60, vec2(0, 0));
        let disc = || Shape::circle(fx!(0.1));
        add(&mut world, BodyDef { position: vec2(0, fx!(1.5)), ..wall }, Shape::rectangle(400, fx!(0.01)));
        let struck = add(&mut world, BodyDef::dynamic(), disc());
        if sleeps {
            world.set_sleep_after(Some(1)).expect("it may be");
            (0..3).for_each(|_| _ = world.step());
            assert_eq!(world.moving_count(), 0);
        }
        let def = BodyDef { position: vec2(-1, fx!(-0.15)), velocity: vec2(3_000, 0), ..BodyDef::dynamic() };
        add(&mut world, def, disc());
        for tick in 0..10 {
            world.step();
            let at = world.body(struck).expect("it").position();
            assert!(at.x > fx!(0) && at.y < fx!(1.5), "{sleeps}, tick {tick}: {at}");
        }
    }
}

/// A paddle that turns by half a turn and more in a tick takes a disc along.
#[test]
fn a_fast_paddle_does_not_pass_through_a_disc() {
    for spin in [60, 150, 600, 5_000] {
        let mut world = world(60, vec2(0, 0));
        let paddle = BodyDef { angular_velocity: spin.into(), ..BodyDef::kinematic() };
        add(&mut world, paddle, Shape::rectangle(4, fx!(0.05)));
        let disc = BodyDef { position: vec2(fx!(0.1), fx!(1.5)), ..BodyDef::dynamic() };
        let disc = add(&mut world, disc, Shape::circle(fx!(0.05)));
        // It reaches the disc in the first or the second step.
        (0..4).for_each(|_| _ = world.step());
        let disc = world.body(disc).expect("it");
        assert!(disc.velocity().length() > fx!(10), "{spin} rad/s: {:?}", disc.velocity());
    }
}

/// 100 bullets among each other in a room of thin walls.
#[test]
fn bullets_in_a_crowd_stay_in_their_room() {
    let mut world = world(60, vec2(0, 0));
    for (x, y) in [(5, 0), (-5, 0), (0, 5), (0, -5)] {
        let (width, height) = if x == 0 { (fx!(11), fx!(0.01)) } else { (fx!(0.01), fx!(11)) };
        add(&mut world, BodyDef { position: vec2(x, y), ..BodyDef::fixed() }, Shape::rectangle(width, height));
    }
    let mut random = Random::seeded(run_seed(9));
    let bullets: Vec<BodyId> = (0..100)
        .map(|i| {
            let position = Vec2::new(Fx::from_ratio(8 * (i % 10) - 36, 10), Fx::from_ratio(8 * (i / 10) - 36, 10));
            let mut part = || random.number(fx!(-3000)..=fx!(3000));
            let velocity = Vec2::new(part(), part());
            let spin = part();
            let def = BodyDef { position, velocity, angular_velocity: spin, bullet: true, ..BodyDef::dynamic() };
            let shape = if i % 2 == 0 { Shape::circle(fx!(0.1)) } else { Shape::rectangle(fx!(0.2), fx!(0.15)) };
            add(&mut world, BodyDef { mass: Mass::Kilograms(fx!(1)), ..def }, shape)
        })
        .collect();
    for tick in 0..240 {
        world.step();
        for &bullet in &bullets {
            let at = world.body(bullet).expect("it").position();
            assert!(at.x.abs() < fx!(5) && at.y.abs() < fx!(5), "{bullet} at tick {tick}: {at:?}");
        }
    }
}

/// Pairs in which one moves 10 m in the tick, without contacts that are found ahead of time: what is in the way of whom.
#[test]
fn bullets_meet_all_and_others_what_is_not_dynamic() {
    let bullet = |is| BodyDef { bullet: is, ..BodyDef::dynamic() };
    let (fixed, driven) = (BodyDef::fixed(), BodyDef::kinematic());
    for (fast, slow, stops) in [
        (bullet(false), fixed.clone(), true),
        (bullet(false), driven.clone(), true),
        (bullet(false), bullet(false), false),
        (bullet(true), bullet(false), true),
        (bullet(false), bullet(true), true),
        (driven.clone(), bullet(false), true),
        (driven.clone(), fixed, false),
        (driven.clone(), driven, false),
    ] {
        // In either order, beside many others, and asleep.
        for (is_first, crowd, sleeps) in [(true, 0, false), (false, 0, false), (true, 80, false), (false, 0, true)] {
            if sleeps && fast.kind == BodyKind::Kinematic {
                continue;
            }
            let mut world = world(60, vec2(0, 0));
            let add_fast = |world: &mut World| {
                let def = BodyDef { velocity: vec2(600, 0), position: vec2(-5, 0), ..fast.clone() };
                add(world, def, Shape::circle(fx!(0.1)))
            };
            let before = is_first.then(|| add_fast(&mut world));
            let slow = add(&mut world, slow.clone(), Shape::rectangle(fx!(0.1), 4));
            for i in 0..crowd {
                let def =
                    BodyDef { position: vec2(0, 10 + i), velocity: vec2(0, 1), bullet: true, ..BodyDef::dynamic() };
                add(&mut world, def, Shape::circle(fx!(0.1)));
            }
            if sleeps {
                world.set_sleep_after(Some(1)).expect("it may be");
                (0..3).for_each(|_| _ = world.step());
            }
            let fast = before.unwrap_or_else(|| add_fast(&mut world));
            world.do_without_continuous_collision(false, true);
            world.step();
            let [fast, slow] = [fast, slow].map(|id| world.body(id).expect("it"));
            let is_behind = fast.position().x < slow.position().x;
            assert_eq!(is_behind, stops, "{:?} {:?} {sleeps}: {}", fast.kind(), slow.kind(), fast.position());
        }
    }
}

#[test]
fn a_step_that_stops_a_body_without_an_impulse_cannot_be_undone() {
    let mut world = world(60, vec2(0, 0));
    add(&mut world, BodyDef::fixed(), Shape::rectangle(fx!(0.1), 4));
    let fast = BodyDef { velocity: vec2(600, 0), position: vec2(-5, 0), ..BodyDef::dynamic() };
    add(&mut world, fast, Shape::circle(fx!(0.1)));
    world.do_without_continuous_collision(false, true);
    world.step();
    assert!(world.step_back(&[]).is_err());
}

/// A ram of 10 m a tick carries along what it meets: not along an axis that is locked, and nothing that another one holds against it.
#[test]
fn locked_and_squeezed_bodies_are_not_carried() {
    for (locks, y) in [(Locks::NONE, fx!(1)), (Locks { y: true, ..Locks::NONE }, fx!(0))] {
        for rams in [&[1][..], &[-1, 1], &[1, -1]] {
            let mut world = world(60, vec2(0, 0));
            let disc = add(&mut world, BodyDef { locks, ..BodyDef::dynamic() }, Shape::circle(fx!(0.5)));
            for &way in rams {
                let velocity = vec2(600 * way, if rams.len() == 1 { 240 } else { 0 });
                let def = BodyDef { velocity, position: vec2(-6 * way, 0), ..BodyDef::kinematic() };
                add(&mut world, def, Shape::rectangle(1, 40));
            }
            world.do_without_continuous_collision(false, true);
            world.step();
            let at = world.body(disc).expect("it").position();
            match rams {
                [_] => assert!((at.y > fx!(0.5)) == (y > fx!(0)), "{at}"),
                _ => assert_eq!(at, vec2(0, 0)),
            }
        }
    }
}

/// Bodies that slide or roll over a floor at speed end where they end without continuous collision, to the bit; a chain lets them through
/// from behind.
#[test]
fn a_body_that_slides_fast_is_not_held_up() {
    let run = |without: bool| {
        let mut world = world(60, vec2(0, -10));
        add(&mut world, BodyDef { position: vec2(0, -1), ..BodyDef::fixed() }, Shape::rectangle(4000, 2));
        for (i, shape) in [Shape::rectangle(1, fx!(0.2)), Shape::circle(fx!(0.1)), Shape::capsule(1, fx!(0.1))]
            .into_iter()
            .enumerate()
        {
            let position = Vec2::new(Fx::from(-20 * i as i32), fx!(0.1));
            add(&mut world, BodyDef { position, velocity: vec2(40, 0), ..BodyDef::dynamic() }, shape);
        }
        world.do_without_continuous_collision(without, false);
        (0..90).for_each(|_| _ = world.step());
        world.state_hash()
    };
    assert_eq!(run(false), run(true));
    for (from, way) in [(-4, 1), (4, -1)] {
        let mut world = world(60, vec2(0, 0));
        // Its outer side is on the right of the way.
        add(&mut world, BodyDef::fixed(), Shape::chain(&[vec2(0, -9), vec2(0, 0), vec2(0, 9)], false));
        let def = BodyDef { position: vec2(from, 2), velocity: vec2(300 * way, 0), ..BodyDef::dynamic() };
        let disc = add(&mut world, def, Shape::circle(fx!(0.1)));
        (0..4).for_each(|_| _ = world.step());
        let at = world.body(disc).expect("it").position();
        assert!(at.x > fx!(0), "{from}: {at}");
        assert!(way < 0 || at == vec2(from + 20, 2), "{at}");
    }
}

/// Slow bodies end where they end without continuous collision, to the bit, and so does a fast one that meets nothing.
#[test]
fn slow_scenes_keep_their_bits() {
    let run = |without: bool| {
        let mut world = world(60, vec2(0, -10));
        add(&mut world, BodyDef { position: vec2(0, -1), ..BodyDef::fixed() }, Shape::rectangle(100, 2));
        for i in 0..20 {
            let def = BodyDef { position: vec2(i % 5 * 2, 1 + i / 5 * 2), ..BodyDef::dynamic() };
            add(&mut world, def, Shape::rectangle(1, 1));
        }
        let fast = BodyDef { position: vec2(0, 50), velocity: vec2(5_000, 100), ..BodyDef::dynamic() };
        add(&mut world, fast, Shape::circle(fx!(0.1)));
        world.do_without_continuous_collision(without, false);
        (0..120).for_each(|_| _ = world.step());
        world.state_hash()
    };
    assert_eq!(run(false), run(true));
}

/// A pile of boxes for callgrind: `WITHOUT=1` does without the ends of paths.
#[test]
#[ignore = "for callgrind"]
fn pile_for_counting() {
    let mut world = world(60, vec2(0, -10));
    add(&mut world, BodyDef { position: vec2(0, -1), ..BodyDef::fixed() }, Shape::rectangle(100, 2));
    for i in 0..400 {
        let def = BodyDef {
            position: Vec2::new(Fx::from(i % 20 * 2), Fx::from_ratio((i / 20 * 2 + 1).into(), 2)),
            ..BodyDef::dynamic()
        };
        add(&mut world, def, Shape::rectangle(1, 1));
    }
    if std::env::var("FAST").is_ok() {
        let fast = BodyDef { position: vec2(-40, 50), velocity: vec2(50, 0), ..BodyDef::dynamic() };
        add(&mut world, fast, Shape::circle(fx!(0.1)));
    }
    world.do_without_continuous_collision(std::env::var("WITHOUT").is_ok(), false);
    (0..60).for_each(|_| _ = world.step());
}
