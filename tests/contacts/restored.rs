//! Worlds that went on, were restored from bytes, copied or taken back: they know different things about what has changed, and have the
//! same future.

use super::scenes::{def, square, through_bytes, world};
use crate::seeds::run_seed;
use umbra_physics::{
    BodyDef, BodyId, BodyKind, ColliderDef, ContactSettings, Error, Exclusion, Filter, Fx, Locks, MaterialPair, OneWay,
    Part, Random, Rollback, Shape, Snapshot, TimeStep, Vec2, World, WorldDef, fx, vec2,
};

/// A call on a body.
type Change = fn(&mut World, BodyId) -> Result<(), Error>;

fn tile(x: i32, y: i32) -> BodyDef {
    let shape = Shape::rectangle(1, 1).expect("a tile");
    BodyDef { position: vec2(x, y), key: (100 + 10 * x + y) as u64, ..BodyDef::fixed().with_collider(shape) }
}

fn ball(position: Vec2) -> BodyDef {
    let shape = Shape::circle(fx!(0.2)).expect("a disc");
    BodyDef { position, key: 7, ..BodyDef::dynamic().with_collider(shape) }
}

/// Tiles at x from 0 on.
fn compound(tiles: i32) -> Shape {
    let tile = Shape::rectangle(1, 1).expect("a tile");
    let part = |x: i32| Part { shape: tile.clone(), position: vec2(x, 0), angle: fx!(0), density: fx!(1) };
    Shape::compound(&(0..tiles).map(part).collect::<Vec<_>>()).expect("a compound")
}

/// The surface of a tile depends on its neighbour: where that goes, who sleeps in the side that it covered wakes.
#[test]
fn a_sleeper_in_a_tile_whose_neighbour_changes_has_the_future_of_a_restored_world() {
    let changes: [Change; 4] = [
        |world, tile| world.set_position(tile, vec2(9, 9)),
        |world, tile| world.disable(tile),
        |world, tile| {
            let collider = world.colliders_of(tile)?.next().expect("a collider");
            world.remove_collider(collider)
        },
        // The numbers of the outlines behind it are others from here on.
        |world, tile| {
            let collider = world.colliders_of(tile)?.next().expect("a collider");
            world.set_collider(collider, ColliderDef { position: vec2(9, 9), ..ColliderDef::new(compound(3)) })
        },
    ];
    let mut woke = [0; 4];
    for (which, change) in changes.into_iter().enumerate() {
        for x in (0..20).map(|k| fx!(0.3) + Fx::from_ratio(k, 50)) {
            let def = WorldDef { sleep_after: Some(5), gravity: vec2(0, 0), ..def() };
            let bodies = [tile(1, 0), tile(0, 0), ball(Vec2::new(x, fx!(0)))];
            let (mut world, ids) = world(def, bodies).expect("a scene");
            world.exclude_pair(ids[0], ids[2], Exclusion::Always).expect("a pair");
            (0..30).for_each(|_| _ = world.step());
            assert_eq!(world.moving_count(), 0, "{x}");
            change(&mut world, ids[0]).expect("a change");
            for tick in 0..3 {
                let mut restored = through_bytes(&world);
                woke[which] += world.step().woke.len();
                restored.step();
                assert_eq!(restored.first_difference(&world), None, "{which} {x} {tick}");
            }
        }
    }
    assert!(woke.iter().all(|&woke| woke > 0), "{woke:?}");
}

/// A step back finds no contacts, but it must not forget what calls have changed since the last step.
#[test]
fn calls_before_a_step_back_are_known_to_the_next_step() {
    let changes: [Change; 4] = [
        |world, wall| world.set_position(wall, vec2(2, 0)),
        |world, wall| world.disable(wall),
        |world, wall| world.set_kind(wall, BodyKind::Kinematic).and_then(|()| world.set_position(wall, vec2(2, 0))),
        |world, wall| world.set_kind(wall, BodyKind::Dynamic).and_then(|()| world.set_position(wall, vec2(2, 0))),
    ];
    for (which, change) in changes.into_iter().enumerate() {
        let def = WorldDef { gravity: vec2(0, 0), ..def() };
        let flying = BodyDef { velocity: vec2(6, 0), ..ball(vec2(0, 0)) };
        let (mut world, ids) = world(def, [tile(3, 0), flying]).expect("a scene");
        (0..4).for_each(|_| _ = world.step());
        change(&mut world, ids[0]).expect("a change");
        world.step_back(&[]).expect("nothing has touched");
        let mut restored = through_bytes(&world);
        for tick in 0..60 {
            world.step();
            restored.step();
            assert_eq!(restored.first_difference(&world), None, "{which} {tick}");
        }
        let is_stopped = world.body(ids[1]).expect("it").position().x < fx!(3);
        assert_eq!(is_stopped, which != 1, "{which}");
    }
}

/// A tick in which a collider gets more outlines is made again: those behind it have the numbers of before when it begins.
#[test]
fn a_tick_that_numbers_outlines_anew_is_made_again() {
    let floor = Shape::rectangle(20, 1).expect("a floor");
    let floor = BodyDef { position: vec2(0, fx!(-0.5)), ..BodyDef::fixed().with_collider(floor) };
    let rolling = BodyDef { velocity: vec2(1, 0), ..ball(vec2(0, fx!(0.2))) };
    let bodies = [tile(50, 0), floor, square(vec2(4, fx!(0.5)), 1).expect("a box"), rolling];
    let (start, ids) = world(WorldDef { sleep_after: Some(5), ..def() }, bodies).expect("a scene");
    let act = |world: &mut World, is_pushed: bool| {
        if world.tick() == 10 {
            let collider = world.colliders_of(ids[0]).expect("it").next().expect("a tile");
            world.set_collider(collider, compound(3)).expect("a change");
        }
        if is_pushed {
            world.set_velocity(ids[3], vec2(2, 0)).expect("a push");
        }
    };
    let (mut right, mut late) = (start.clone(), start);
    let mut rollback = Rollback::<u8>::new(&late, [0], 8).with_prediction(|_| 0);
    for now in 0..40 {
        act(&mut right, now == 10);
        right.step();
        // The input of tick 10 comes in tick 12.
        let known = if now == 12 { 10..13 } else { now..now + u64::from(!(10..12).contains(&now)) };
        for tick in known {
            rollback.add_input(tick, 0, u8::from(tick == 10)).expect("a player");
        }
        rollback.advance(&mut late, |world, inputs| act(world, inputs[0].1 == 1)).expect("unchanged");
    }
    assert_eq!(late.first_difference(&right), None);
    assert!(late.body(ids[3]).expect("it").position().y > fx!(0.19));
}

/// A kinematic body that rests in a static one falls asleep once.
#[test]
fn a_kinematic_body_sleeps_in_a_wall() {
    let def = WorldDef { sleep_after: Some(5), ..def() };
    let inside = BodyDef { position: vec2(fx!(0.5), 0), kind: BodyKind::Kinematic, ..tile(7, 0) };
    let (mut world, _) = world(def, [tile(0, 0), inside]).expect("a scene");
    let fell: usize = (0..100).map(|_| world.step().fell_asleep.len()).sum();
    assert_eq!(fell, 1);
}

fn random_collider(random: &mut Random, may_be_chain: bool) -> ColliderDef {
    let shape = match random.below(7) {
        0 => Shape::circle(fx!(0.4)).expect("a disc"),
        1 => compound(2 + random.below(2) as i32),
        2 if may_be_chain => {
            let points: Vec<Vec2> = (0..4).map(|i| vec2(2 - i, fx!(0.1) * Fx::from(i % 2))).collect();
            Shape::chain(&points, false).expect("a chain")
        }
        _ => Shape::rectangle(1, 1).expect("a box"),
    };
    let sensor = random.below(10) == 0;
    let apart = Filter { category: 3, mask: 2, ..Filter::default() };
    let height = if random.below(2) == 0 { fx!(0) } else { random.number(fx!(-1)..=fx!(1)) };
    ColliderDef {
        sensor,
        one_way: (!sensor && random.below(3) == 0).then(OneWay::default),
        contact_events: random.below(4) == 0,
        filter: if random.below(6) == 0 { apart } else { Filter::default() },
        position: vec2(random.number(fx!(-1)..=fx!(1)), height),
        ..ColliderDef::new(shape)
    }
}

fn random_place(random: &mut Random) -> Vec2 {
    let grid = Vec2::new(Fx::from(random.below(7) as i32 - 3), Fx::from(random.below(5) as i32));
    let place = vec2(random.number(fx!(-3)..=fx!(3)), random.number(fx!(-1)..=fx!(5)));
    if random.below(2) == 0 { grid } else { place }
}

fn random_body(random: &mut Random) -> BodyDef {
    let kinds = [BodyKind::Static, BodyKind::Static, BodyKind::Kinematic, BodyKind::Dynamic, BodyKind::Dynamic];
    let kind = kinds[random.below(5) as usize];
    let gravity_scale = Fx::from(random.below(2) as i32);
    let key = random.below(1 << 20);
    let start = BodyDef { kind, position: random_place(random), key, gravity_scale, ..BodyDef::dynamic() };
    let colliders = (0..random.below(3)).map(|_| random_collider(random, kind != BodyKind::Dynamic));
    colliders.fold(start, BodyDef::with_collider)
}

/// Makes a call at random. Whether it is refused does not matter.
fn disturb(world: &mut World, random: &mut Random) {
    let bodies: Vec<BodyId> = world.bodies().map(|body| body.id()).collect();
    let [first, second] = [0, 1].map(|_| bodies[random.below(bodies.len() as u64) as usize]);
    let kind = world.body(first).expect("it is there").kind();
    let may_be_chain = kind != BodyKind::Dynamic;
    let place = random_place(random);
    let colliders: Vec<_> = world.colliders_of(first).expect("it is there").collect();
    _ = match random.below(25) {
        0..3 if kind != BodyKind::Dynamic => world.set_position(first, place),
        3 => world.wake(first),
        4 if first != second => {
            world.exclude_pair(first, second, [Exclusion::UntilApart, Exclusion::Always][random.below(2) as usize])
        }
        5 if first != second => world.allow_pair(first, second),
        6 | 7 if colliders.len() < 4 => world.add_collider(first, random_collider(random, may_be_chain)).map(drop),
        8 | 9 if !colliders.is_empty() => world.remove_collider(colliders[0]),
        10 | 11 if !colliders.is_empty() => {
            world.set_collider(colliders[colliders.len() - 1], random_collider(random, may_be_chain))
        }
        12 => world.disable(first),
        13 => world.enable(first),
        14 => {
            let kinds = [BodyKind::Static, BodyKind::Kinematic, BodyKind::Dynamic];
            world.set_kind(first, kinds[random.below(3) as usize])
        }
        15 => {
            let body = random_body(random);
            let is_replaced = random.below(2) == 0;
            world.remove_body(first).and_then(|()| if is_replaced { world.add_body(body).map(drop) } else { Ok(()) })
        }
        16 | 17 if bodies.len() < 45 => world.add_body(random_body(random)).map(drop),
        18 if random.below(8) == 0 => world.set_contact_settings(ContactSettings {
            max_pairs: [20, 60, 1 << 20][random.below(3) as usize],
            max_pairs_per_collider: [3, 10, 256][random.below(3) as usize],
            substeps: 4 + random.below(2) as u32,
            sleep_speed: [fx!(0.05), fx!(2)][random.below(2) as usize],
            ..ContactSettings::default()
        }),
        19 if random.below(4) == 0 => world.set_time_step(TimeStep::hz([60, 50, 120][random.below(3) as usize])),
        20 if random.below(4) == 0 => {
            let pair = MaterialPair { friction: fx!(0.1), restitution: fx!(0), rolling_resistance: fx!(0) };
            world.set_material_pair(0, 0, (random.below(2) == 0).then_some(pair))
        }
        21 if kind == BodyKind::Dynamic => world.set_velocity(first, vec2(random.number(fx!(-3)..=fx!(3)), 1)),
        22 if kind == BodyKind::Kinematic => world.move_to(first, place, fx!(0)),
        23 => world.release(first),
        24 => world.sleep(first),
        _ => Ok(()),
    };
}

/// Calls at random on floors of tiles with boxes and other bodies, of which some sleep, in worlds of different pasts: one that goes on; one
/// restored from bytes before the calls of each tick, and one after them; a copy of a few ticks ago; and one that goes back, on and
/// forward between snapshots in memory.
#[test]
fn worlds_of_different_pasts_have_the_same_future() {
    let [mut fell, mut woke] = [0, 0];
    let seeds = crate::seeds::times(6);
    for seed in 0..seeds {
        let mut random = Random::seeded(run_seed(seed));
        let gravity = vec2(0, if seed % 2 == 0 { 0 } else { -10 });
        let def = WorldDef { sleep_after: Some(3), gravity, ..def() };
        let mut bodies: Vec<BodyDef> = (0..12).map(|i| tile(i % 7 - 3, -(i / 7))).collect();
        bodies
            .extend((0..14).map(|i| {
                square(Vec2::new(Fx::from(i % 7 - 3), fx!(1) + Fx::from(i / 7)), i as u64).expect("a square")
            }));
        bodies.extend((0..8).map(|_| random_body(&mut random)));
        let (mut here, _) = world(def, bodies).expect("a scene");
        let (mut copied, mut moved, mut past) = (here.clone(), here.clone(), Vec::<Snapshot>::new());
        for tick in 0..120 {
            if tick % 7 == 0 {
                copied = here.clone();
            }
            let mut before = through_bytes(&here);
            for _ in 0..if random.below(3) == 0 { 1 + random.below(3) } else { 0 } {
                for world in [&mut before, &mut copied] {
                    disturb(world, &mut random.clone());
                }
                disturb(&mut here, &mut random);
            }
            let mut after = through_bytes(&here);
            for _ in 0..random.below(3) {
                if let Some(then) = past.get(random.below(past.len() as u64 + 1) as usize) {
                    moved.restore(then);
                    if random.below(3) > 0 {
                        moved.step();
                    }
                }
            }
            let now = here.snapshot();
            moved.restore(&now);
            match past.len() {
                6 => here.snapshot_into(&mut past[random.below(6) as usize]),
                _ => past.push(now),
            }
            let report = here.step();
            (fell, woke) = (fell + report.fell_asleep.len(), woke + report.woke.len());
            let twins =
                [("before", &mut before), ("after", &mut after), ("copied", &mut copied), ("moved", &mut moved)];
            for (name, twin) in twins {
                twin.step();
                assert_eq!(twin.first_difference(&here), None, "seed {seed}, tick {tick}, {name}");
            }
        }
    }
    assert!(fell > 40 * seeds as usize && woke > 40 * seeds as usize, "{fell} fell asleep, {woke} woke");
}

/// A body that no contact moves, and that rests in a static one, falls asleep once: one that is locked in all ways, and one in a world that
/// pushes nothing apart.
#[test]
fn a_body_that_no_contact_moves_sleeps_in_a_wall() {
    let gentle = ContactSettings { push_speed: fx!(0), ..ContactSettings::default() };
    let all = Locks { x: true, y: true, rotation: true };
    let cases = [(all, ContactSettings::default()), (Locks::NONE, gentle)];
    for (which, (locks, contacts)) in cases.into_iter().enumerate() {
        let def = WorldDef { sleep_after: Some(5), gravity: vec2(0, 0), contacts, ..def() };
        let inside = BodyDef { locks, ..square(vec2(fx!(0.5), 0), 7).expect("a square") };
        let (mut world, ids) = world(def, [tile(0, 0), inside]).expect("a scene");
        let (mut fell, mut woke) = (0, 0);
        for _ in 0..100 {
            let report = world.step();
            (fell, woke) = (fell + report.fell_asleep.len(), woke + report.woke.len());
        }
        assert_eq!(world.body(ids[1]).expect("it").position(), vec2(fx!(0.5), 0), "{which}: it was pushed");
        assert_eq!((fell, woke), (1, 0), "{which}");
    }
}
