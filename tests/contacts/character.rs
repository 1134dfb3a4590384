//! Characters: slopes, steps, seams, platforms, pushes, walls, and mirror images to the bit.

use std::collections::BTreeSet;

use umbra_physics::{
    BodyDef, BodyId, Character, ColliderDef, Command, Error, ForceOrImpulse, Fx, Ground, Locks, Mass, Movement, OneWay,
    Quantity, QueryFilter, Random, Shape, Symmetry, TimeStep, Vec2, World, WorldDef, fx, vec2,
};

const ALL: QueryFilter<'_> = QueryFilter { filter: None, without_bodies: &[], without_colliders: &[], predicate: None };

/// The skin of a new character, and how far from it one stands.
const SKIN: Fx = fx!(0.015625);
const NEAR: Fx = Fx::from_bits(6);

fn world() -> World {
    let def = WorldDef { time_step: TimeStep::hz(64), gravity: vec2(0, -10), ..WorldDef::default() };
    World::new(def).expect("a world")
}

fn add(world: &mut World, def: BodyDef, at: Vec2, shape: Shape) -> BodyId {
    world.add_body(BodyDef { position: at, ..def.with_collider(shape) }).expect("a body")
}

fn bar(width: Fx, height: Fx) -> Shape {
    Shape::rectangle(width, height).expect("a bar")
}

/// A character of 0.5 m by 1 m: its centre is 0.5 m above its sole.
fn hero() -> Character {
    Character::new(bar(fx!(0.5), fx!(1)))
}

/// A character between two calls.
#[derive(Clone, Debug)]
struct Walk {
    hero: Character,
    position: Vec2,
    ground: Option<Ground>,
}

impl Walk {
    fn new(hero: Character, position: Vec2) -> Self {
        Self { hero, position, ground: None }
    }

    fn go(&mut self, world: &World, by: Vec2) -> Movement {
        self.go_past(world, by, &ALL)
    }

    fn go_past(&mut self, world: &World, by: Vec2, filter: &QueryFilter<'_>) -> Movement {
        let moved =
            self.hero.translate(&world.queries(), self.position, self.ground, by, filter).expect("a movement in range");
        (self.position, self.ground) = (moved.position, moved.ground);
        moved
    }

    /// Lets it fall onto what is below.
    fn land(&mut self, world: &World) {
        for _ in 0..200 {
            self.go(world, vec2(0, fx!(-0.1)));
        }
        assert!(self.ground.is_some(), "{self:?}");
    }
}

/// A slope up to the right from the origin, of an angle in degrees.
fn slope(degrees: i32) -> (World, Vec2) {
    let mut world = world();
    let angle = Fx::PI * Fx::from(degrees) / Fx::from(180);
    let (sine, cosine) = angle.sin_cos();
    // Its surface goes through the origin.
    let at = vec2(sine * 2, -cosine * 2);
    let def = BodyDef { angle, ..BodyDef::fixed() };
    add(&mut world, def, at, bar(fx!(100), fx!(4)));
    (world, vec2(cosine, sine))
}

#[test]
fn it_stands_on_a_slope_up_to_the_limit_and_slides_on_a_steeper_one() {
    for degrees in [0, 10, 30, 44, 45, 46, 60, 80] {
        let (world, along) = slope(degrees);
        for shape in
            [bar(fx!(0.5), fx!(1)), Shape::capsule(fx!(0.5), fx!(0.25)).unwrap(), Shape::circle(fx!(0.5)).unwrap()]
        {
            let mut walk = Walk::new(Character::new(shape), vec2(0, 2));
            for _ in 0..60 {
                walk.go(&world, vec2(0, fx!(-0.05)));
            }
            let stood = walk.position;
            assert_eq!(walk.ground.is_some(), degrees <= 45, "{degrees}");
            for _ in 0..60 {
                walk.go(&world, vec2(0, fx!(-0.05)));
            }
            if degrees <= 45 {
                assert_eq!(walk.position, stood, "{degrees}");
                let ground = walk.go(&world, vec2(0, 0)).ground_normal;
                assert!((ground - along.perp()).length() < fx!(0.00001), "{ground}");
            } else {
                // Down along the slope, as far as its translation goes along it: sin² of the way.
                let (way, down) = (stood - walk.position, Fx::from(3) * along.y);
                assert!((way - along * down).length() < fx!(0.0001), "{degrees}: {way}");
            }
        }
    }
}

#[test]
fn it_slides_on_a_slope_that_it_climbs_but_does_not_rest_on() {
    let (world, along) = slope(30);
    let mut walk = Walk::new(Character { max_rest_slope: fx!(0.35), ..hero() }, vec2(0, 2));
    walk.go(&world, vec2(0, -3));
    assert!(walk.ground.is_some());
    let before = walk.position;
    walk.go(&world, vec2(0, -1));
    assert!((before - walk.position - along * along.y).length() < fx!(0.0001));
    assert!(walk.ground.is_some(), "it stands while it slides");
    let before = walk.position;
    walk.go(&world, vec2(1, 0));
    assert!((walk.position - before - along * along.x).length() < fx!(0.0001), "and climbs");
}

#[test]
fn it_climbs_no_slope_that_is_too_steep_and_jumps_up_along_it() {
    for degrees in [50, 70, 89] {
        let (world, _) = slope(degrees);
        let mut walk = Walk::new(Character { step_height: fx!(0.5), ..hero() }, vec2(-6, 0));
        let mut floor = world.clone();
        add(&mut floor, BodyDef::fixed(), vec2(-10, fx!(-3)), bar(fx!(40), fx!(1)));
        walk.land(&floor);
        let height = walk.position.y;
        for _ in 0..200 {
            walk.go(&floor, vec2(fx!(0.1), fx!(-0.01)));
            assert_eq!(walk.position.y, height, "{degrees}");
        }
        let before = walk.position;
        walk.go(&floor, vec2(fx!(0.1), fx!(0.5)));
        assert_eq!(walk.position, before + vec2(0, fx!(0.5)), "{degrees}");
    }
}

/// A floor whose surface is at y = 0, and steps of a height, each 2 m long, up to the right from x = 0 on.
fn stairs(height: Fx, count: i32) -> World {
    let mut world = world();
    add(&mut world, BodyDef::fixed(), vec2(-10, -5), bar(fx!(20), fx!(10)));
    for i in 0..count {
        let top = height * (i + 1);
        add(&mut world, BodyDef::fixed(), vec2(2 * i + 1, top - fx!(5)), bar(fx!(2), fx!(10)));
    }
    add(&mut world, BodyDef::fixed(), vec2(2 * count + 10, height * count - fx!(5)), bar(fx!(20), fx!(10)));
    world
}

#[test]
fn it_climbs_steps_up_to_its_height_and_none_that_is_higher() {
    let heights = [fx!(0.01), fx!(0.02), fx!(0.1), fx!(0.24), fx!(0.25)];
    let more = Fx::from_bits(16);
    for speed in [fx!(0.003), fx!(0.02), fx!(0.1), fx!(0.4)] {
        for height in heights {
            let world = stairs(height, 5);
            let mut walk = Walk::new(hero(), vec2(-1, 1));
            walk.land(&world);
            let mut ticks = 0;
            while walk.position.x < fx!(12) {
                let before = walk.position;
                walk.go(&world, vec2(speed, fx!(-0.001)));
                assert!(walk.ground.is_some(), "{speed} {height}: {before} {}", walk.position);
                assert!(walk.position.x > before.x, "{speed} {height}: {before}");
                ticks += 1;
                assert!(ticks < 10_000);
            }
            assert!((walk.position.y - fx!(0.5) - SKIN - height * 5).abs() <= NEAR, "{}", walk.position);
            // And down again, without a moment in the air.
            while walk.position.x > fx!(-1) {
                let before = walk.position;
                walk.go(&world, vec2(-speed, fx!(-0.001)));
                assert!(walk.ground.is_some(), "{speed} {height}: {before} {}", walk.position);
                assert!(walk.position.x < before.x, "{speed} {height}: {before}");
            }
            assert!((walk.position.y - fx!(0.5) - SKIN).abs() <= NEAR, "{}", walk.position);
        }
        let world = stairs(fx!(0.25) + more, 1);
        let mut walk = Walk::new(hero(), vec2(-1, 1));
        walk.land(&world);
        for _ in 0..600 {
            walk.go(&world, vec2(speed, fx!(-0.001)));
        }
        assert!((walk.position.x + fx!(0.25) + SKIN).abs() <= NEAR, "{speed}: {}", walk.position);
    }
}

#[test]
fn a_capsule_climbs_steps_too() {
    let capsule = Character::new(Shape::capsule(fx!(1), fx!(0.3)).unwrap());
    for (speed, height) in [(fx!(0.02), fx!(0.25)), (fx!(0.1), fx!(0.2)), (fx!(0.1), fx!(0.25)), (fx!(0.3), fx!(0.1))] {
        let world = stairs(height, 4);
        // A capsule lies along x; this one is 1.6 m wide.
        let mut walk = Walk::new(capsule.clone(), vec2(-2, 1));
        walk.land(&world);
        for _ in 0..2_000 {
            walk.go(&world, vec2(speed, fx!(-0.001)));
        }
        assert!(walk.position.x > fx!(12), "{speed} {height}: {}", walk.position);
    }
}

#[test]
fn a_step_that_is_too_narrow_is_a_wall() {
    for (width, climbs) in [(fx!(0.01), false), (fx!(0.5), true)] {
        let mut world = world();
        add(&mut world, BodyDef::fixed(), vec2(0, -5), bar(fx!(40), fx!(10)));
        add(&mut world, BodyDef::fixed(), vec2(2, 0), bar(width, fx!(0.4)));
        // Behind a narrow ledge stands a wall.
        add(&mut world, BodyDef::fixed(), vec2(fx!(3) + width / 2, 0), bar(fx!(2), fx!(4)));
        let mut walk = Walk::new(Character { step_width: fx!(0.125), ..hero() }, vec2(0, 1));
        walk.land(&world);
        for _ in 0..100 {
            walk.go(&world, vec2(fx!(0.05), fx!(-0.01)));
        }
        assert_eq!(walk.position.y > fx!(0.6), climbs, "{}", walk.position);
    }
}

#[test]
fn it_walks_over_a_thousand_seams_at_one_height_and_to_the_exact_distance() {
    let mut world = world();
    for x in 0..1_000 {
        add(&mut world, BodyDef::fixed(), vec2(x, fx!(-0.5)), bar(fx!(1), fx!(1)));
    }
    let (queries, step) = (world.queries(), vec2(fx!(0.1), fx!(-0.02)));
    for shape in [bar(fx!(0.5), fx!(1)), Shape::capsule(fx!(0.5), fx!(0.25)).unwrap(), Shape::circle(fx!(0.3)).unwrap()]
    {
        let mut walk = Walk::new(Character::new(shape), vec2(1, 1));
        walk.land(&world);
        let start = walk.position;
        for i in 1..=9_900 {
            let moved = walk.hero.translate(&queries, walk.position, walk.ground, step, &ALL).unwrap();
            (walk.position, walk.ground) = (moved.position, moved.ground);
            assert_eq!(walk.position, start + vec2(fx!(0.1) * i, 0), "step {i}");
            assert!(walk.ground.is_some(), "step {i}");
        }
    }
}

#[test]
fn tiles_that_are_off_by_an_ulp_are_one_floor() {
    let mut world = world();
    for x in 0..100 {
        let height = fx!(-0.5) + Fx::DELTA * (x * 7 % 3 - 1);
        add(&mut world, BodyDef::fixed(), Vec2::new(x.into(), height), bar(fx!(1), fx!(1)));
    }
    for shape in [bar(fx!(0.5), fx!(1)), Shape::capsule(fx!(0.5), fx!(0.25)).unwrap()] {
        let mut walk = Walk::new(Character::new(shape), vec2(1, 1));
        walk.land(&world);
        let start = walk.position;
        for i in 1..=900 {
            let moved = walk.go(&world, vec2(fx!(0.1), fx!(-0.02)));
            let off = walk.position - start - vec2(fx!(0.1) * i, 0);
            assert!(off.x.abs() < fx!(0.000001) && off.y.abs() <= NEAR && walk.ground.is_some(), "{i}: {off}");
            assert!(moved.hits.iter().all(|hit| hit.normal.y > fx!(0.999)), "{i}: {:?}", moved.hits);
        }
    }
}

#[test]
fn it_follows_a_slope_down_by_snapping_and_without_it_does_not() {
    for (snap, follows) in [(fx!(0.25), true), (fx!(0), false)] {
        let (world, along) = slope(-30);
        let mut walk = Walk::new(Character { snap, ..hero() }, vec2(0, 2));
        walk.land(&world);
        let mut in_air = 0;
        for _ in 0..100 {
            let before = walk.position;
            walk.go(&world, vec2(fx!(0.1), 0));
            in_air += i32::from(walk.ground.is_none());
            if follows {
                let expected = fx!(0.1) * along.y / along.x;
                assert!((walk.position.y - before.y - expected).abs() < fx!(0.0001), "{}", walk.position);
            }
        }
        assert_eq!(in_air, if follows { 0 } else { 100 });
    }
}

#[test]
fn it_does_not_snap_when_it_jumps() {
    let world = stairs(fx!(0.25), 1);
    let mut walk = Walk::new(hero(), vec2(-1, 1));
    walk.land(&world);
    let before = walk.position;
    walk.go(&world, vec2(0, fx!(0.01)));
    assert_eq!((walk.position, walk.ground), (before + vec2(0, fx!(0.01)), None));
}

/// A world with a plank from y = -0.125 to 0.125 that is solid from above.
fn plank(def: BodyDef) -> (World, BodyId) {
    let mut world = world();
    let one_way = Some(OneWay::default());
    let plank = ColliderDef { one_way, ..ColliderDef::new(bar(fx!(4), fx!(0.25))) };
    let plank = world.add_body(def.with_collider(plank)).expect("a plank");
    (world, plank)
}

#[test]
fn a_one_way_platform_holds_from_above_alone() {
    let (world, plank) = plank(BodyDef::fixed());
    // From above.
    let mut walk = Walk::new(hero(), vec2(0, 2));
    walk.go(&world, vec2(0, -3));
    assert!((walk.position.y - fx!(0.625) - SKIN).abs() <= NEAR);
    assert_eq!(walk.ground.map(|ground| ground.body), Some(plank));
    // From below, fast and slowly, and then it stands on it.
    for speed in [fx!(3), fx!(0.3), fx!(0.01)] {
        let mut walk = Walk::new(hero(), vec2(0, -1));
        while walk.position.y < fx!(1) {
            let before = walk.position;
            walk.go(&world, vec2(0, speed));
            assert_eq!(walk.position, before + vec2(0, speed));
        }
        walk.go(&world, vec2(0, -3));
        assert_eq!(walk.ground.map(|ground| ground.body), Some(plank));
    }
    // From the side, and down again if it did not get out of it.
    let mut walk = Walk::new(hero(), vec2(-3, 0));
    for by in [vec2(3, 0), vec2(0, fx!(0.3)), vec2(0, -2)] {
        let before = walk.position;
        walk.go(&world, by);
        assert_eq!(walk.position, before + by);
    }
    // It drops through when the platform is left out for one call.
    let mut walk = Walk::new(hero(), vec2(0, 2));
    walk.land(&world);
    let before = walk.position;
    walk.go_past(&world, vec2(0, fx!(-0.01)), &QueryFilter { without_bodies: &[plank], ..ALL });
    for _ in 0..30 {
        walk.go(&world, vec2(0, fx!(-0.01)));
    }
    assert_eq!(walk.position, before - vec2(0, fx!(0.01) * 31));
    assert_eq!(walk.ground, None);
}

#[test]
fn it_rides_platforms_without_slipping_and_without_gaps() {
    for velocity in [vec2(3, 0), vec2(0, 2), vec2(0, -7), vec2(-2, fx!(1.3))] {
        let mut world = world();
        let lift = add(&mut world, BodyDef { velocity, ..BodyDef::kinematic() }, vec2(0, 0), bar(fx!(4), fx!(1)));
        let mut walk = Walk::new(hero(), vec2(fx!(0.5), 2));
        walk.land(&world);
        let beside = walk.position - world.body(lift).unwrap().position();
        for _ in 0..640 {
            world.step();
            let moved = walk.go(&world, vec2(0, fx!(-0.01)));
            assert_eq!(walk.position - world.body(lift).unwrap().position(), beside, "{velocity}");
            assert_eq!((moved.ground.map(|ground| ground.body), moved.ground_velocity), (Some(lift), velocity));
        }
        // It walks on it as if it stood still.
        world.step();
        walk.go(&world, vec2(fx!(0.25), 0));
        assert_eq!(walk.position - world.body(lift).unwrap().position(), beside + vec2(fx!(0.25), 0));
    }
}

#[test]
fn it_rides_a_one_way_platform_up_and_one_that_tips_until_it_is_too_steep() {
    let (mut world, plank) = plank(BodyDef { velocity: vec2(1, 2), ..BodyDef::kinematic() });
    let mut walk = Walk::new(hero(), vec2(0, 2));
    walk.land(&world);
    for _ in 0..640 {
        world.step();
        walk.go(&world, vec2(0, fx!(-0.01)));
        assert_eq!(walk.ground.map(|ground| ground.body), Some(plank));
    }
    // A platform that tips: it stays on until the slope is too steep.
    let mut world = self::world();
    let tip = add(
        &mut world,
        BodyDef { angular_velocity: fx!(0.25), ..BodyDef::kinematic() },
        vec2(0, 0),
        bar(fx!(8), fx!(1)),
    );
    let mut walk = Walk::new(hero(), vec2(1, 2));
    walk.land(&world);
    for tick in 0..192 {
        world.step();
        walk.go(&world, vec2(0, fx!(-0.01)));
        assert_eq!(walk.ground.map(|ground| ground.body), Some(tip), "tick {tick}: {}", walk.position);
    }
    for _ in 0..64 {
        world.step();
        walk.go(&world, vec2(0, fx!(-0.01)));
    }
    assert_eq!(walk.ground, None, "at more than 45° it slides");
}

#[test]
fn a_platform_that_rises_against_a_ceiling_crushes_it_and_a_wall_that_comes_pushes_it() {
    let mut world = world();
    add(&mut world, BodyDef { velocity: vec2(0, fx!(0.25)), ..BodyDef::kinematic() }, vec2(0, 0), bar(fx!(4), fx!(1)));
    add(&mut world, BodyDef::fixed(), vec2(0, 3), bar(fx!(4), fx!(1)));
    let mut walk = Walk::new(hero(), vec2(0, fx!(1.2)));
    walk.land(&world);
    let mut crushed = None;
    for tick in 0..300 {
        world.step();
        let moved = walk.go(&world, vec2(0, fx!(-0.01)));
        assert!(moved.position.y < 2.into(), "never into the ceiling: {}", moved.position);
        crushed = crushed.or(moved.is_overlapping.then_some(tick));
    }
    // 1 m of it between surfaces 2 m apart, and one of its skins: 252 ticks of 2^-8 m.
    assert!(crushed.is_some_and(|tick| (250..254).contains(&tick)), "{crushed:?}");

    let mut world = self::world();
    add(&mut world, BodyDef::fixed(), vec2(0, fx!(-0.5)), bar(fx!(20), fx!(1)));
    add(&mut world, BodyDef { velocity: vec2(2, 0), ..BodyDef::kinematic() }, vec2(-2, 1), bar(fx!(1), fx!(2)));
    let mut walk = Walk::new(hero(), vec2(0, 1));
    walk.land(&world);
    for _ in 0..128 {
        world.step();
        assert!(!walk.go(&world, vec2(0, fx!(-0.01))).is_overlapping);
    }
    assert!((walk.position.x - fx!(2.75) - SKIN).abs() < fx!(0.001), "{}", walk.position);
}

#[test]
fn it_stops_in_corners_without_a_jitter() {
    for angle in [fx!(0), fx!(0.2), fx!(0.5)] {
        let mut world = world();
        add(&mut world, BodyDef { angle, ..BodyDef::fixed() }, vec2(0, -5), bar(fx!(40), fx!(10)));
        add(&mut world, BodyDef { angle: -angle, ..BodyDef::fixed() }, vec2(8, 0), bar(fx!(4), fx!(40)));
        let mut walk = Walk::new(hero(), vec2(0, 3));
        walk.land(&world);
        for _ in 0..200 {
            walk.go(&world, vec2(fx!(0.1), fx!(-0.05)));
        }
        let stopped = walk.position;
        for _ in 0..200 {
            let moved = walk.go(&world, vec2(fx!(0.1), fx!(-0.05)));
            assert_eq!(walk.position, stopped, "{angle}");
            assert!(moved.hits.len() >= 2 && moved.ground.is_some());
        }
    }
}

#[test]
fn a_ceiling_stops_it_and_it_slides_along() {
    let mut world = world();
    add(&mut world, BodyDef::fixed(), vec2(0, 5), bar(fx!(40), fx!(2)));
    let mut walk = Walk::new(hero(), vec2(0, 2));
    let moved = walk.go(&world, vec2(1, 3));
    assert_eq!((moved.hits.len(), moved.hits[0].normal, moved.ground), (1, vec2(0, -1), None));
    assert!((walk.position.y - fx!(3.5) + SKIN).abs() <= NEAR);
    assert!((walk.position.x - fx!(1)).abs() <= NEAR, "{}", walk.position);
}

#[test]
fn it_pushes_a_box_by_a_share_of_its_mass() {
    for (share, expected) in [(fx!(60), fx!(3)), (fx!(20), fx!(2)), (fx!(0), fx!(0))] {
        let mut world = World::new(WorldDef { time_step: TimeStep::hz(64), ..WorldDef::default() }).unwrap();
        let def = BodyDef { mass: Mass::Kilograms(fx!(20)), ..BodyDef::dynamic() };
        let crate_ = add(&mut world, def, vec2(2, 0), bar(fx!(1), fx!(1)));
        let mut walk = Walk::new(Character { push_mass: share, ..hero() }, vec2(0, 0));
        let mut met = false;
        for _ in 0..30 {
            let moved = walk.go(&world, vec2(fx!(0.0625), 0));
            let pushes = walk.hero.push(&world, &moved);
            if moved.hits.is_empty() {
                assert_eq!(pushes, []);
                continue;
            }
            pushes.iter().for_each(|push| _ = world.execute(push).unwrap());
            assert_eq!(pushes.len(), usize::from(share > fx!(0)));
            assert_eq!(world.body(crate_).unwrap().velocity(), vec2(expected, 0), "4 m/s · M/(M + m)");
            met = true;
            break;
        }
        assert!(met, "it never reached the box");
    }
}

#[test]
fn a_push_at_the_edge_of_a_box_turns_it_and_leaves_no_approach() {
    let mut world = World::new(WorldDef { time_step: TimeStep::hz(64), ..WorldDef::default() }).unwrap();
    let crate_ = add(&mut world, BodyDef::dynamic(), vec2(2, fx!(0.8)), bar(fx!(1), fx!(1)));
    let mut walk = Walk::new(Character { push_mass: fx!(1024), ..hero() }, vec2(1, 0));
    let moved = walk.go(&world, vec2(fx!(0.5), 0));
    let pushes = walk.hero.push(&world, &moved);
    assert_eq!(pushes.len(), 1);
    pushes.iter().for_each(|push| _ = world.execute(push).unwrap());
    let body = world.body(crate_).unwrap();
    assert!(body.angular_velocity() > fx!(1), "{}", body.angular_velocity());
    // 32 m/s of a mass that is far above that of the box.
    let at = body.velocity_at(moved.hits[0].point).unwrap().x;
    assert!((at - fx!(32)).abs() < fx!(0.2), "{at}");
}

/// A hero on a floor at y = 0, and what else is there.
fn on_floor(hero: Character, x: i32, more: impl FnOnce(&mut World)) -> (World, Walk) {
    let mut world = world();
    add(&mut world, BodyDef::fixed(), vec2(0, -5), bar(fx!(100), fx!(10)));
    let mut walk = Walk::new(hero, vec2(x, 1));
    walk.land(&world);
    more(&mut world);
    (world, walk)
}

#[test]
fn a_slope_that_is_a_little_too_steep_is_no_ground() {
    for (angle, stands) in [(fx!(0.7853), true), (fx!(0.7856), false)] {
        let mut world = world();
        let def = BodyDef { angle, ..BodyDef::fixed() };
        add(&mut world, def, vec2(0, 0), bar(fx!(40), fx!(1)));
        let mut walk = Walk::new(hero(), vec2(0, 2));
        assert_eq!(walk.go(&world, vec2(0, -2)).ground.is_some(), stands, "{angle}");
    }
}

#[test]
fn it_climbs_steps_from_the_ground_alone() {
    let step = |world: &mut World| _ = add(world, BodyDef::fixed(), vec2(2, 0), bar(fx!(2), fx!(0.4)));
    // A jump leads up the step's side, and not onto it.
    let (world, mut walk) = on_floor(hero(), 0, step);
    walk.go(&world, vec2(fx!(0.7), 0));
    let before = walk.position;
    let (_, mut jump) = (walk.go(&world, vec2(fx!(0.1), 0)), walk.clone());
    assert!((walk.position.y - before.y - fx!(0.2)).abs() <= NEAR, "{}", walk.position);
    (jump.position, jump.ground) = (before, walk.ground);
    let moved = jump.go(&world, vec2(fx!(0.1), fx!(0.01)));
    assert!(moved.position.y == before.y + fx!(0.01) && moved.ground.is_none(), "{}", moved.position);
    // One in the air stops at the side, and is not moved down to ground that is near.
    let mut fall = Walk::new(hero(), before + vec2(0, fx!(0.1)));
    let moved = fall.go(&world, vec2(fx!(0.1), 0));
    assert_eq!((moved.position.y, moved.ground), (before.y + fx!(0.1), None));
    // On the first call, without a ground, one that stands climbs.
    let mut first = Walk::new(hero(), before);
    assert!(first.go(&world, vec2(fx!(0.1), 0)).position.y > before.y + fx!(0.19));
    // The least way up leaves the ground.
    let mut least = Walk { position: before, ..first };
    assert_eq!(least.go(&world, Vec2::new(fx!(0), Fx::DELTA)).ground, None);
}

#[test]
fn it_climbs_no_step_under_a_low_ceiling() {
    let (world, mut walk) = on_floor(hero(), 0, |world| {
        add(world, BodyDef::fixed(), vec2(2, 0), bar(fx!(2), fx!(0.4)));
        add(world, BodyDef::fixed(), vec2(0, fx!(1) + SKIN * 2 + fx!(0.5)), bar(fx!(2), fx!(1)));
    });
    let height = walk.position.y;
    for _ in 0..30 {
        let moved = walk.go(&world, vec2(fx!(0.1), fx!(-0.01)));
        assert!(moved.position.y == height && !moved.is_overlapping, "{}", moved.position);
    }
    assert!((walk.position.x - fx!(0.75) + SKIN).abs() <= NEAR, "{}", walk.position);
}

#[test]
fn dynamic_bodies_are_neither_steps_nor_on_them() {
    let low = |world: &mut World, def: BodyDef, x: Fx, height: Fx| {
        add(world, def, Vec2::new(x, height / 2), bar(fx!(0.5), height));
    };
    // A crate alone; one before a step; one on the far side of a sill; and a step that stays climbable.
    type Bars<'a> = &'a [(bool, Fx, Fx)];
    let cases: [(Bars<'_>, bool); 4] = [
        (&[(true, fx!(1), fx!(0.2))], false),
        (&[(true, fx!(1), fx!(0.1)), (false, fx!(1.05), fx!(0.2))], false),
        (&[(false, fx!(1), fx!(0.1)), (true, fx!(1.05), fx!(0.2))], false),
        (&[(false, fx!(1), fx!(0.2))], true),
    ];
    for (bars, climbs) in cases {
        let (world, mut walk) = on_floor(hero(), 0, |world| {
            for &(is_dynamic, x, height) in bars {
                low(world, if is_dynamic { BodyDef::dynamic() } else { BodyDef::fixed() }, x, height);
            }
        });
        let height = walk.position.y;
        for _ in 0..6 {
            walk.go(&world, vec2(fx!(0.1), fx!(-0.01)));
        }
        assert_eq!(walk.position.y > height + fx!(0.05), climbs, "{bars:?}: {}", walk.position);
    }
}

#[test]
fn it_is_pushed_out_by_a_metre_at_most_and_upwards_where_all_ways_are_as_long() {
    let place = |size: Fx, at: Vec2| {
        let mut world = world();
        add(&mut world, BodyDef::fixed(), vec2(0, 0), bar(size, size));
        let mut walk = Walk::new(Character::new(bar(fx!(0.5), fx!(0.5))), at);
        (walk.go(&world, vec2(0, 0)).is_overlapping, walk.position)
    };
    let (is_overlapping, at) = place(fx!(20), vec2(0, 7));
    assert!(is_overlapping && at.y <= fx!(8) && at.x == fx!(0), "{at}");
    let (is_overlapping, at) = place(fx!(0.5), vec2(0, 0));
    assert!(!is_overlapping && (at.y - fx!(0.5) - SKIN).abs() <= NEAR && at.x == fx!(0), "{at}");
}

#[test]
fn it_leaves_a_chain_to_its_outer_side_and_passes_from_behind() {
    let chain = || {
        let mut world = world();
        let floor = Shape::chain(&[vec2(2, 0), vec2(-2, 0)], false).unwrap();
        world.add_body(BodyDef::fixed().with_collider(floor)).unwrap();
        world
    };
    // Near the end of it the shortest way out is sideways.
    let mut walk = Walk::new(hero(), vec2(fx!(2.2), fx!(0.1)));
    walk.go(&chain(), vec2(0, 0));
    assert!((walk.position - vec2(fx!(2.2), fx!(0.5) + SKIN)).length() <= NEAR, "{}", walk.position);
    // With its middle below, it falls on.
    let mut walk = Walk::new(hero(), vec2(0, fx!(-0.1)));
    for by in [vec2(0, fx!(-0.1)), vec2(0, fx!(0.15)), vec2(fx!(0.5), fx!(-1))] {
        let before = walk.position;
        assert!(!walk.go(&chain(), by).is_overlapping);
        assert_eq!(walk.position, before + by);
    }
}

#[test]
fn it_rides_in_a_fast_cabin_and_not_with_one_that_is_disabled_or_teleported() {
    let mut world = world();
    let wall = |x: i32| ColliderDef { position: vec2(x, 1), ..ColliderDef::new(bar(fx!(0.25), fx!(2))) };
    let cabin = BodyDef { velocity: vec2(128, 0), ..BodyDef::kinematic().with_collider(bar(fx!(4), fx!(0.5))) };
    let cabin = world.add_body(cabin.with_collider(wall(-1)).with_collider(wall(1))).unwrap();
    let mut walk = Walk::new(hero(), vec2(0, 1));
    walk.land(&world);
    let beside = walk.position;
    for tick in 1..=64 {
        world.step();
        walk.go(&world, vec2(0, fx!(-0.01)));
        assert_eq!(walk.position, beside + vec2(2 * tick, 0));
    }
    let (stays, at) = (walk.clone(), world.body(cabin).unwrap().position());
    world.set_position(cabin, at + vec2(300, 0)).unwrap();
    assert_eq!(walk.go(&world, vec2(0, 0)).position, stays.position);
    let mut walk = stays.clone();
    world.disable(cabin).unwrap();
    world.set_position(cabin, at + vec2(0, -3)).unwrap();
    assert_eq!(walk.go(&world, vec2(0, 0)).position, stays.position);
}

#[test]
fn a_one_way_platform_that_tips_holds_who_stands_on_it() {
    let (mut world, plank) = plank(BodyDef { angular_velocity: fx!(0.25), ..BodyDef::kinematic() });
    let mut walk = Walk::new(hero(), vec2(1, 2));
    walk.land(&world);
    for tick in 0..150 {
        world.step();
        walk.go(&world, vec2(0, fx!(-0.01)));
        assert_eq!(walk.ground.map(|ground| ground.body), Some(plank), "tick {tick}: {}", walk.position);
    }
}

#[test]
fn it_steps_and_snaps_as_far_as_it_is_told() {
    let far = Character { step_height: fx!(3), snap: fx!(3), ..hero() };
    let (world, mut walk) = on_floor(far, 0, |world| _ = add(world, BodyDef::fixed(), vec2(2, 0), bar(fx!(2), fx!(5))));
    let height = walk.position.y;
    (0..20).for_each(|_| _ = walk.go(&world, vec2(fx!(0.1), fx!(-0.01))));
    assert!((walk.position.y - height - fx!(2.5)).abs() <= NEAR, "{}", walk.position);
    (0..20).for_each(|_| _ = walk.go(&world, vec2(fx!(0.1), fx!(-0.01))));
    assert!((walk.position.y - height).abs() <= NEAR && walk.ground.is_some(), "{}", walk.position);
}

#[test]
fn a_disc_walks_down_steps_without_a_moment_in_the_air_or_in_a_step() {
    let world = stairs(fx!(0.25), 5);
    let disc = Shape::circle(fx!(0.5)).unwrap();
    let mut walk = Walk::new(Character::new(disc.clone()), vec2(14, 3));
    walk.land(&world);
    while walk.position.x > fx!(-1) {
        walk.go(&world, vec2(fx!(-0.02), fx!(-0.01)));
        let inside = world.queries().overlap_shape(&disc, (walk.position, fx!(0)), &ALL).unwrap();
        assert!(walk.ground.is_some() && inside.is_empty(), "{}", walk.position);
    }
}

#[test]
fn it_stands_on_what_is_the_most_level_and_then_on_the_least_key() {
    for order in [[1, 2], [2, 1]] {
        let (mut world, key) = (world(), |world: &World, id| world.collider(id).unwrap().key);
        for key in order {
            let tile = ColliderDef { key, ..ColliderDef::new(bar(fx!(4), fx!(2))) };
            let at = vec2(if key == 1 { -2 } else { 2 }, -1);
            world.add_body(BodyDef { position: at, ..BodyDef::fixed().with_collider(tile) }).unwrap();
        }
        let mut walk = Walk::new(hero(), vec2(0, 1));
        let moved = walk.go(&world, vec2(0, -1));
        let hits: Vec<u64> = moved.hits.iter().map(|hit| key(&world, hit.collider)).collect();
        assert_eq!((moved.ground_collider.map(|id| key(&world, id)), hits), (Some(1), vec![1, 2]));
        // A predicate leaves one of them out.
        let only: &dyn Fn(_, &ColliderDef) -> bool = &|_, def| def.key == 2;
        let mut walk = Walk::new(hero(), vec2(0, 1));
        let moved = walk.go_past(&world, vec2(0, -1), &QueryFilter { predicate: Some(only), ..ALL });
        assert_eq!(moved.ground_collider.map(|id| key(&world, id)), Some(2));
    }
    // Between two slopes, where it slides down to and rests on neither.
    let mut world = world();
    for (x, angle) in [(3, fx!(0.6)), (-3, fx!(-0.3))] {
        add(&mut world, BodyDef { angle, ..BodyDef::fixed() }, vec2(x, 0), bar(fx!(12), fx!(1)));
    }
    let mut walk = Walk::new(Character { max_rest_slope: fx!(0), ..hero() }, vec2(0, 4));
    (0..40).for_each(|_| _ = walk.go(&world, vec2(0, fx!(-0.5))));
    let moved = walk.go(&world, vec2(0, fx!(-0.5)));
    let colliders: BTreeSet<_> = moved.hits.iter().map(|hit| hit.collider).collect();
    assert_eq!((moved.hits.len(), colliders.len()), (2, 2));
    assert!((moved.ground_normal.x - fx!(0.3).sin()).abs() < fx!(0.00001), "{}", moved.ground_normal);
}

#[test]
fn a_push_is_as_large_as_the_approach() {
    // 4 m/s of 60 kg against a crate of 20 kg that flees.
    for (speed, expected) in [(fx!(3), fx!(15)), (fx!(5), fx!(0))] {
        let mut world = World::new(WorldDef { time_step: TimeStep::hz(64), ..WorldDef::default() }).unwrap();
        let def = BodyDef { mass: Mass::Kilograms(fx!(20)), velocity: Vec2::new(speed, fx!(0)), ..BodyDef::dynamic() };
        add(&mut world, def, Vec2::new(fx!(0.75) + SKIN, fx!(0)), bar(fx!(1), fx!(1)));
        let mut walk = Walk::new(Character { push_mass: fx!(60), ..hero() }, vec2(0, 0));
        let moved = walk.go(&world, vec2(fx!(0.0625), 0));
        assert_eq!(moved.hits.len(), 1);
        let impulses: Vec<Fx> = walk.hero.push(&world, &moved).iter().map(impulse_of).map(|by| by.x).collect();
        assert_eq!(impulses, if expected > fx!(0) { vec![expected] } else { vec![] });
    }
}

fn impulse_of(push: &Command) -> Vec2 {
    match push {
        Command::Apply { action: ForceOrImpulse::Impulse { impulse, .. }, .. } => *impulse,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_body_gets_the_greatest_of_its_pushes_and_one_that_stands_none() {
    let mut world = World::new(WorldDef { time_step: TimeStep::hz(64), ..WorldDef::default() }).unwrap();
    let corner = |at: Vec2, size: Vec2| ColliderDef { position: at, ..ColliderDef::new(bar(size.x, size.y)) };
    let def = BodyDef { locks: Locks { rotation: true, ..Locks::NONE }, ..BodyDef::dynamic() };
    let [floor, side] = [(vec2(0, -1), vec2(4, 1)), (vec2(1, 1), vec2(1, 3))].map(|(at, size)| corner(at, size));
    let angle = world.add_body(def.with_collider(floor).with_collider(side)).unwrap();
    add(&mut world, BodyDef::fixed(), vec2(-1, 1), bar(fx!(0.25), fx!(3)));
    let hero = Character { push_mass: fx!(60), step_height: fx!(0), ..hero() };
    for (by, normal) in [
        (vec2(fx!(0.06), fx!(-0.03)), Some(vec2(1, 0))),
        (vec2(fx!(0.03), fx!(-0.06)), Some(vec2(0, -1))),
        (vec2(fx!(0.05), fx!(-0.05)), None),
    ] {
        let mut walk = Walk::new(hero.clone(), vec2(0, fx!(0.25)));
        for _ in 0..30 {
            walk.go(&world, by);
        }
        let moved = walk.go(&world, by);
        assert_eq!(moved.hits.len(), 2);
        let pushes = hero.push(&world, &moved);
        assert!(pushes.len() == 1 && moved.hits.iter().all(|hit| hit.body == angle));
        let impulse = impulse_of(&pushes[0]);
        // Of equal ones the first; across the normal it gives nothing.
        let normal = normal.unwrap_or(-moved.hits[0].normal);
        let [along, across] = [normal, normal.perp()].map(|axis| impulse.x * axis.x + impulse.y * axis.y);
        assert!(along > fx!(1) && across == fx!(0), "{impulse}");
    }
    // A wall that stands is not pushed.
    let mut walk = Walk::new(hero.clone(), vec2(0, fx!(0.25)));
    (0..30).for_each(|_| _ = walk.go(&world, vec2(fx!(-0.06), 0)));
    let moved = walk.go(&world, vec2(fx!(-0.06), 0));
    assert_eq!((moved.hits.len(), hero.push(&world, &moved)), (1, vec![]));
}

/// Boxes, discs, turned bars, rounded polygons and a chain at random.
fn clutter(random: &mut Random, turned: bool) -> World {
    let mut world = world();
    for key in 0..24 {
        let size = |random: &mut Random| random.number(fx!(0.25)..=fx!(2));
        let shape = match random.below(5) {
            0 => Shape::circle(size(random)),
            1 => Shape::rounded_polygon(&[vec2(0, 0), vec2(2, 0), vec2(1, 2)], fx!(0.2)),
            2 => Shape::polygon(&[vec2(0, 0), vec2(3, 0), vec2(2, 2), vec2(0, 1)]),
            _ => Shape::rectangle(size(random), size(random)),
        };
        let mut number = |most: i32| random.number(-Fx::from(most)..=Fx::from(most));
        let (position, angle) = (Vec2::new(number(6), number(6)), if turned { number(3) } else { fx!(0) });
        let collider = ColliderDef { key, ..ColliderDef::new(shape.expect("a shape")) };
        let def = BodyDef { position, angle, ..BodyDef::fixed().with_collider(collider) };
        world.add_body(def).expect("a body");
    }
    world
}

fn any_hero(random: &mut Random) -> Character {
    let shape = match random.below(4) {
        0 => bar(fx!(0.5), fx!(1)),
        1 => Shape::circle(fx!(0.4)).unwrap(),
        2 => Shape::capsule(fx!(0.5), fx!(0.3)).unwrap(),
        _ => Shape::polygon(&[vec2(0, 0), vec2(1, 0), vec2(fx!(0.6), 1), vec2(0, 1)]).unwrap(),
    };
    Character::new(shape)
}

/// A place for it, if there is one.
fn free_place(random: &mut Random, world: &World, hero: &Character) -> Option<Vec2> {
    let queries = world.queries();
    (0..50).find_map(|_| {
        let place = Vec2::new(random.number(fx!(-7)..=fx!(7)), random.number(fx!(-7)..=fx!(7)));
        queries.overlap_shape(&hero.shape, (place, fx!(0)), &ALL).unwrap().is_empty().then_some(place)
    })
}

#[test]
fn it_never_ends_in_a_wall() {
    let (mut moves, mut hits) = (0, 0);
    for seed in 0..200 {
        let random = &mut Random::seeded(seed);
        let world = clutter(random, seed % 4 > 0);
        let hero = any_hero(random);
        let Some(place) = free_place(random, &world, &hero) else { continue };
        let (queries, mut walk) = (world.queries(), Walk::new(hero, place));
        let mut goal = vec2(0, 0);
        for i in 0..60 {
            // To places among the obstacles, at a jump now and then.
            if i % 10 == 0 {
                goal = Vec2::new(random.number(fx!(-6)..=fx!(6)), random.number(fx!(-6)..=fx!(6)));
            }
            let by = (goal - walk.position) * if i % 10 == 0 { fx!(0.9) } else { fx!(0.15) };
            let moved = walk.hero.translate(&queries, walk.position, walk.ground, by, &ALL).unwrap();
            let inside = queries.overlap_shape(&walk.hero.shape, (moved.position, fx!(0)), &ALL).unwrap();
            assert_eq!(inside, [], "seed {seed}, move {i}: {walk:?} by {by} to {moved:?}");
            assert!(!moved.is_overlapping);
            let parts: BTreeSet<_> = moved.hits.iter().map(|hit| (hit.collider, hit.part)).collect();
            assert_eq!(parts.len(), moved.hits.len(), "each once");
            hits += moved.hits.len();
            moves += 1;
            (walk.position, walk.ground) = (moved.position, moved.ground);
        }
    }
    assert!(moves >= 10_000 && hits > 5_000, "{moves} moves, {hits} hits");
}

#[test]
fn a_mirror_image_moves_to_the_mirror_image() {
    let (mirror, mut moves, mut met) = (Symmetry::MIRROR, 0, 0);
    for seed in 0..120 {
        let random = &mut Random::seeded(1_000 + seed);
        let world = clutter(random, seed % 4 > 0);
        let image = mirror.world(&world).expect("an image");
        let hero = any_hero(random);
        let Some(place) = free_place(random, &world, &hero) else { continue };
        let mirrored = Character { shape: mirror.shape(&hero.shape).unwrap(), ..hero.clone() };
        let at = mirror.point(place).unwrap();
        let (mut own, mut other) = (Walk::new(hero, place), Walk::new(mirrored, at));
        for i in 0..60 {
            let by = Vec2::new(random.number(fx!(-0.4)..=fx!(0.4)), random.number(fx!(-0.4)..=fx!(0.3)));
            let moved = own.go(&world, by);
            let there = other.go(&image, mirror.vector(by).unwrap());
            assert_eq!(mirror.point(moved.position), Some(there.position), "seed {seed}, move {i}: {by}");
            assert_eq!(moved.ground_collider, there.ground_collider);
            assert_eq!(mirror.vector(moved.ground_normal), Some(there.ground_normal));
            let hits = moved
                .hits
                .iter()
                .map(|hit| (hit.collider, mirror.point(hit.point).unwrap(), mirror.vector(hit.normal).unwrap()));
            assert!(
                hits.eq(there.hits.iter().map(|hit| (hit.collider, hit.point, hit.normal))),
                "seed {seed}, move {i}"
            );
            met += moved.hits.len();
            moves += 1;
        }
    }
    assert!(moves >= 6_000 && met > 700, "{moves} moves, {met} hits");
}

#[test]
fn the_order_in_which_a_world_was_built_makes_no_difference() {
    let mut hits = 0;
    for seed in 0..20 {
        let random = &mut Random::seeded(seed);
        let world = clutter(random, true);
        let mut other = self::world();
        let bodies: Vec<_> = world.bodies().map(|body| body.id()).collect();
        for id in bodies.into_iter().rev() {
            let collider = world.colliders_of(id).unwrap().next().unwrap();
            let body = world.body(id).unwrap();
            let def = BodyDef { angle: body.angle(), ..BodyDef::fixed() };
            let def = BodyDef {
                colliders: vec![world.collider(collider).unwrap().clone()],
                position: body.position(),
                ..def
            };
            other.add_body(def).unwrap();
        }
        let hero = any_hero(random);
        let Some(place) = free_place(random, &world, &hero) else { continue };
        let (mut a, mut b) = (Walk::new(hero.clone(), place), Walk::new(hero, place));
        for _ in 0..60 {
            let by = Vec2::new(random.number(fx!(-0.4)..=fx!(0.4)), random.number(fx!(-0.4)..=fx!(0.3)));
            let [a, b] = [a.go(&world, by), b.go(&other, by)];
            assert_eq!(a.position, b.position);
            let keys = |world: &World, moved: &Movement| -> Vec<u64> {
                moved.hits.iter().map(|hit| world.collider(hit.collider).unwrap().key).collect()
            };
            assert_eq!(keys(&world, &a), keys(&other, &b));
            hits += a.hits.len();
        }
    }
    assert!(hits > 200, "{hits} hits");
}

#[test]
fn settings_and_translations_out_of_range_are_refused() {
    let world = world();
    let refused = |hero: &Character, by: Vec2| {
        hero.translate(&world.queries(), vec2(0, 0), None, by, &ALL).map(drop).map_err(|error| match error {
            Error::OutOfRange { quantity } => quantity,
            error => panic!("{error}"),
        })
    };
    let most = fx!(256);
    assert_eq!(refused(&hero(), vec2(most, -most)), Ok(()));
    assert_eq!(refused(&hero(), vec2(0, most + Fx::DELTA)), Err(Quantity::CharacterTranslation));
    let cases: [(Character, Quantity); 10] = [
        (Character { skin: fx!(0), ..hero() }, Quantity::CharacterSkin),
        (Character { skin: fx!(1) + Fx::DELTA, ..hero() }, Quantity::CharacterSkin),
        (Character { up: vec2(0, 0), ..hero() }, Quantity::CharacterUp),
        (Character { up: vec2(0, 2_000), ..hero() }, Quantity::CharacterUp),
        (Character { max_slope: fx!(1.6), ..hero() }, Quantity::CharacterSlope),
        (Character { max_rest_slope: -Fx::DELTA, ..hero() }, Quantity::CharacterSlope),
        (Character { step_height: fx!(17), ..hero() }, Quantity::CharacterStep),
        (Character { step_width: fx!(-1), ..hero() }, Quantity::CharacterStep),
        (Character { snap: fx!(17), ..hero() }, Quantity::CharacterStep),
        (Character { push_mass: fx!(-1), ..hero() }, Quantity::Mass),
    ];
    for (hero, quantity) in cases {
        assert_eq!(refused(&hero, vec2(0, 0)), Err(quantity));
    }
    let chain = Shape::chain(&[vec2(0, 0), vec2(1, 0)], false).unwrap();
    assert_eq!(Character::new(chain).check(), Err(Error::DynamicChain));
}

#[test]
fn it_walks_over_the_joints_of_a_chain_and_with_any_side_up() {
    let mut world = world();
    let points: Vec<Vec2> = (0..=60).rev().map(|i| vec2(i - 30, 0)).collect();
    world.add_body(BodyDef::fixed().with_collider(Shape::chain(&points, false).unwrap())).unwrap();
    let mut walk = Walk::new(hero(), vec2(-20, 2));
    walk.land(&world);
    let start = walk.position;
    for i in 1..=400 {
        walk.go(&world, vec2(fx!(0.1), fx!(-0.02)));
        assert_eq!(walk.position, start + vec2(fx!(0.1) * i, 0));
    }
    // From behind it passes.
    let mut walk = Walk::new(hero(), vec2(0, -2));
    walk.go(&world, vec2(0, 3));
    assert_eq!(walk.position, vec2(0, 1));

    // Turned by a quarter, all of it.
    let turn = Symmetry::TURN;
    let world = stairs(fx!(0.25), 3);
    let image = turn.world(&world).unwrap();
    let hero = Character::new(Shape::circle(fx!(0.5)).unwrap());
    let side = Character { up: turn.vector(vec2(0, 1)).unwrap(), ..hero.clone() };
    let at = vec2(-2, 1);
    let (mut own, mut other) = (Walk::new(hero, at), Walk::new(side, turn.point(at).unwrap()));
    for _ in 0..200 {
        let by = vec2(fx!(0.07), fx!(-0.05));
        own.go(&world, by);
        other.go(&image, turn.vector(by).unwrap());
        assert_eq!(turn.point(own.position), Some(other.position));
    }
    assert!(own.position.x > fx!(6));
}

#[test]
fn it_rides_a_platform_that_turns_and_one_that_is_moved_by_forces() {
    // As far from the surface as before; a bar stays upright, and stands on a corner.
    for (shape, bound) in [(Shape::circle(fx!(0.5)).unwrap(), NEAR), (bar(fx!(0.5), fx!(1)), fx!(0.0625))] {
        for kind in [BodyDef::kinematic(), BodyDef { gravity_scale: fx!(0), ..BodyDef::dynamic() }] {
            let mut world = world();
            let def = BodyDef { velocity: vec2(fx!(0.5), fx!(0.25)), angular_velocity: fx!(0.25), ..kind };
            let platform = add(&mut world, def, vec2(0, 0), bar(fx!(8), fx!(1)));
            let mut walk = Walk::new(Character::new(shape.clone()), vec2(1, 2));
            walk.land(&world);
            let start = walk.ground.unwrap().local;
            for tick in 0..180 {
                world.step();
                walk.go(&world, vec2(0, fx!(-0.01)));
                let ground = walk.ground.expect("it stands");
                assert_eq!(ground.body, platform);
                let way = ground.local - start;
                assert!(way.length() <= bound, "tick {tick}: {way}");
            }
        }
    }
}
