//! Bodies that calls put to sleep.

use super::scenes::{def, ground, square, through_bytes, world};
use umbra_physics::{
    Activity, Attachment, BodyDef, BodyId, ColliderDef, Command, End, Error, Event, FieldKind, Fx, Integrator,
    JointDef, Material, Shape, SpringConstants, Vec2, World, WorldDef, fx, vec2,
};

fn activities(world: &World, ids: &[BodyId]) -> Vec<Activity> {
    ids.iter().map(|&id| world.body(id).expect("a body").activity()).collect()
}

fn are_asleep(world: &World, ids: &[BodyId]) -> bool {
    activities(world, ids).iter().all(|&activity| activity == Activity::Asleep)
}

fn are_awake(world: &World, ids: &[BodyId]) -> bool {
    activities(world, ids).iter().all(|&activity| activity == Activity::Awake)
}

fn steps(world: &mut World, count: usize) {
    (0..count).for_each(|_| _ = world.step());
}

fn falling() -> WorldDef {
    WorldDef { gravity: vec2(0, -10), sleep_after: Some(30), ..def() }
}

/// Squares of 1 m on a floor whose top is at 0, `count` above each other at each of these places; the floor is the first body.
fn stacks(places: &[Fx], count: i32) -> (World, Vec<BodyId>) {
    let squares = places.iter().flat_map(|&x| (0..count).map(move |i| Vec2::new(x, fx!(0.5) + Fx::from(i))));
    let squares = (1..).zip(squares).map(|(key, position)| square(position, key).expect("a square"));
    world(falling(), [ground().expect("a floor")].into_iter().chain(squares)).expect("a scene")
}

/// An island falls asleep as a whole and stays as it is to the bit, without what stands beside it; its next step has the events, and no other step.
#[test]
fn a_body_takes_its_island_along() {
    let (mut world, ids) = stacks(&[fx!(0), fx!(5)], 3);
    steps(&mut world, 3);
    assert!(are_awake(&world, &ids[1..]));
    world.sleep(ids[2]).expect("a square");
    assert!(are_asleep(&world, &ids[1..4]) && are_awake(&world, &ids[4..]));
    let places =
        |world: &World| ids[..4].iter().map(|&id| world.body(id).expect("it").position_exact()).collect::<Vec<_>>();
    let before = places(&world);
    assert_eq!(world.step().fell_asleep, &ids[1..4]);
    for _ in 0..20 {
        assert_eq!(world.step().fell_asleep, []);
    }
    assert!(are_asleep(&world, &ids[1..4]) && are_awake(&world, &ids[4..]));
    assert_eq!(places(&world), before);
    let top = world.body(ids[3]).expect("a square");
    assert_eq!((top.velocity(), top.angular_velocity()), (vec2(0, 0), fx!(0)));
    // The impulses are kept: it wakes without a jolt, and stands.
    world.wake(ids[1]).expect("a square");
    assert!(are_awake(&world, &ids[1..4]));
    steps(&mut world, 200);
    let top = world.body(ids[3]).expect("a square").position();
    assert!((top - vec2(0, fx!(2.5))).length() < fx!(0.01), "{top}");
}

/// A body in the air stops, loses what was applied to it, and hangs there until something touches it.
#[test]
fn a_body_in_the_air_stays_there() {
    let (mut world, ids) =
        world(falling(), [(0, 10), (0, 30)].map(|(x, y)| square(vec2(x, y), y as u64).expect("a square")))
            .expect("a scene");
    world.set_velocity(ids[0], vec2(3, 4)).expect("a square");
    world.set_angular_velocity(ids[0], fx!(2)).expect("a square");
    world.apply_force(ids[0], vec2(100, 0)).expect("a square");
    world.sleep(ids[0]).expect("a square");
    world.sleep(ids[0]).expect("it sleeps already");
    assert!(world.step().applied.is_empty());
    let mut touched = None;
    for tick in 0..200 {
        let report = world.step();
        if !report.woke.is_empty() {
            touched = Some((tick, report.woke.to_vec()));
            break;
        }
        assert_eq!(world.body(ids[0]).expect("it").position(), vec2(0, 10));
    }
    // The other one falls 19 m in 1.95 s.
    let (tick, woke) = touched.expect("the other one comes");
    assert_eq!(woke, [ids[0]]);
    assert!((110..125).contains(&tick), "{tick}");
    steps(&mut world, 10);
    assert!(world.body(ids[0]).expect("it").position().y < fx!(10));
}

/// Bodies that touch each other and a floor sleep from the start, in contact and never simulated, until a square strikes one.
#[test]
fn a_level_can_begin_asleep() {
    let places: Vec<Fx> = (0..10).map(Fx::from).collect();
    let (mut world, ids) = stacks(&places, 5);
    for &id in &ids[1..] {
        world.sleep(id).expect("a square");
    }
    for _ in 0..50 {
        assert!(world.step().woke.is_empty());
        assert_eq!(world.moving_count(), 0);
    }
    let shot = BodyDef { velocity: vec2(30, 3), ..square(vec2(-20, fx!(2.5)), 99).expect("a square") };
    let shot = world.add_body(shot).expect("a square");
    let mut woken = 0;
    for _ in 0..600 {
        woken += world.step().woke.len();
    }
    // The island by touch: the whole block.
    assert_eq!(woken, 50);
    assert_eq!(world.moving_count(), 0, "and all rest again, the shot too: {:?}", activities(&world, &[shot]));
}

#[test]
fn joints_and_springs_fall_asleep_as_one() {
    let squares =
        [(0, 10), (2, 10), (4, 10), (8, 10), (20, 10)].map(|(x, y)| square(vec2(x, y), x as u64).expect("a square"));
    let (mut world, ids) = world(falling(), squares).expect("a scene");
    for i in 0..2 {
        let pin = JointDef::at(&world, Some(ids[i]), Some(ids[i + 1]), vec2(2 * i as i32 + 1, 10)).expect("a pin");
        world.add_joint(pin).expect("a pin");
    }
    let spring = SpringConstants { rest: fx!(4), stiffness: fx!(100), damping: fx!(1) };
    let far = End::Body(Attachment::centre(ids[3]));
    world.add_field(FieldKind::Spring { near: Attachment::centre(ids[2]), far, spring }).expect("a spring");
    steps(&mut world, 5);
    world.sleep(ids[3]).expect("a square");
    assert!(are_asleep(&world, &ids[..4]) && are_awake(&world, &ids[4..]));
    assert_eq!(world.step().fell_asleep, &ids[..4]);
    steps(&mut world, 50);
    assert!(are_asleep(&world, &ids[..4]));
    world.set_velocity(ids[0], vec2(0, 1)).expect("a square");
    assert!(are_awake(&world, &ids[..4]));
}

#[test]
fn bodies_that_cannot_sleep_are_refused() {
    let platform = BodyDef::kinematic().with_collider(Shape::rectangle(fx!(4), fx!(1)).expect("a box"));
    let bodies = [platform, square(vec2(0, 1), 1).expect("a square"), ground().expect("a floor")];
    let (mut world, ids) = world(falling(), bodies).expect("a scene");
    world.set_position(ids[2], vec2(0, -50)).expect("a floor");
    let stranger = BodyId::from_parts(77, 0);
    assert_eq!(world.sleep(stranger), Err(Error::NoSuchBody { body: stranger }));
    assert_eq!(world.sleep(ids[2]), Err(Error::NotMovable { body: ids[2] }));
    world.set_velocity(ids[0], vec2(1, 0)).expect("a platform");
    steps(&mut world, 3);
    // It lies on what moves.
    let kept_awake = Err(Error::KeptAwake { kinematic: ids[0] });
    assert_eq!(world.sleep(ids[1]), kept_awake);
    assert_eq!(world.check(&Command::Sleep(ids[1])), kept_awake);
    assert!(are_awake(&world, &ids[..2]));
    // The platform itself stops, and then the body on it may sleep.
    world.sleep(ids[0]).expect("a platform");
    assert_eq!(world.body(ids[0]).expect("it").velocity(), vec2(0, 0));
    world.sleep(ids[1]).expect("a square");
    steps(&mut world, 60);
    assert!(are_asleep(&world, &ids[..2]));
    // A target wakes them; with one, the body on the platform is kept awake.
    world.move_to(ids[0], vec2(5, 0), fx!(0)).expect("a target");
    assert_eq!(world.sleep(ids[1]), kept_awake);
    // A joint to a body that moves keeps awake as well, without a contact.
    let trailer = world.add_body(square(vec2(30, 0), 2).expect("a square")).expect("a square");
    let rod = JointDef::between(&world, Some(ids[0]), vec2(0, 0), Some(trailer), vec2(30, 0)).expect("a rod");
    let rod = world.add_joint(rod).expect("a rod");
    assert_eq!(world.sleep(trailer), kept_awake);
    world.remove_joint(rod).expect("a rod");
    world.sleep(trailer).expect("a square");
    world.disable(trailer).expect("a square");
    assert_eq!(world.sleep(trailer), Err(Error::Disabled { body: trailer }));
    world.set_sleep_after(None).expect("no sleep");
    assert_eq!(world.sleep(ids[1]), Err(Error::SleepIsOff));
}

/// A body on a platform that stands still: both sleep, at once and for good.
#[test]
fn a_platform_at_rest_sleeps_with_what_lies_on_it() {
    let platform = BodyDef::kinematic().with_collider(Shape::rectangle(fx!(4), fx!(1)).expect("a box"));
    let (mut world, ids) = world(falling(), [platform, square(vec2(0, 1), 1).expect("a square")]).expect("a scene");
    steps(&mut world, 3);
    world.sleep(ids[1]).expect("a square");
    assert_eq!(world.step().fell_asleep, ids);
    steps(&mut world, 20);
    assert!(are_asleep(&world, &ids));
}

/// Bodies fall asleep alike with and without events: a ball that bounced off a body is no part of its island.
#[test]
fn events_do_not_decide_who_falls_asleep() {
    let activities = [false, true].map(|has_events| {
        let bouncing = Material { restitution: fx!(1), ..Material::default() };
        let shape = Shape::circle(fx!(0.5)).expect("a disc");
        let collider = ColliderDef { material: bouncing, contact_events: has_events, ..ColliderDef::new(shape) };
        let ball =
            BodyDef { position: vec2(0, 3), velocity: vec2(0, -10), ..BodyDef::dynamic().with_collider(collider) };
        let anvil = BodyDef { position: vec2(0, fx!(0.5)), ..square(vec2(0, 0), 1).expect("a square") };
        let weightless = WorldDef { gravity: vec2(0, 0), ..falling() };
        let (mut world, ids) = world(weightless, [ground().expect("a floor"), anvil, ball]).expect("a scene");
        while world.body(ids[2]).expect("a ball").velocity().y < fx!(0) {
            world.step();
        }
        world.sleep(ids[1]).expect("a square");
        self::activities(&world, &ids)
    });
    assert_eq!(activities[0], [Activity::Awake, Activity::Asleep, Activity::Awake]);
    assert_eq!(activities[0], activities[1]);
}

/// Worlds in which a body was put to sleep right after another call are saved and read as they are.
#[test]
fn what_calls_put_to_sleep_is_saved() {
    let square_at = |x: i32| square(vec2(x, 10), x as u64).expect("a square");
    // A platform that has arrived.
    let (mut world, ids) = world(falling(), [BodyDef::kinematic(), square_at(5)]).expect("a scene");
    world.move_to(ids[0], vec2(1, 0), fx!(0)).expect("a target");
    world.step();
    world.sleep(ids[0]).expect("a platform");
    assert_eq!(through_bytes(&world).state_hash(), world.state_hash());
    assert_eq!(world.step().fell_asleep, [ids[0]]);
    // A body in the slot of another one.
    world.sleep(ids[1]).expect("a square");
    world.remove_body(ids[1]).expect("a square");
    let second = world.add_body(square_at(6)).expect("a square");
    world.sleep(second).expect("a square");
    assert_eq!(through_bytes(&world).step().fell_asleep, [second]);
    assert_eq!(world.step().fell_asleep, [second]);
}

/// A body that missed a change of gravity before it was put to sleep, and whose factors nothing else has, falls with the new gravity once it is struck.
#[test]
fn a_sleeper_falls_with_the_gravity_that_it_missed() {
    let smooth = |x: i32, scale: i32| {
        let square = ColliderDef::new(Shape::rectangle(fx!(1), fx!(1)).expect("a square"));
        let collider = ColliderDef { material: Material { friction: fx!(0), ..Material::default() }, ..square };
        let gravity_scale = Fx::from(scale);
        BodyDef { position: vec2(x, 10), gravity_scale, key: x as u64, ..BodyDef::dynamic().with_collider(collider) }
    };
    let (mut world, ids) = world(falling(), [smooth(20, 1), smooth(30, 0)]).expect("a scene");
    let [sleeper, mover] = ids[..] else { panic!("two") };
    world.set_velocity(mover, vec2(1, 0)).expect("a square");
    world.disable(sleeper).expect("a square");
    world.step();
    world.set_gravity(vec2(0, -90)).expect("gravity");
    world.step();
    world.enable(sleeper).expect("a square");
    world.sleep(sleeper).expect("a square");
    world.step();
    let bullet = BodyDef { velocity: vec2(-60, 0), ..smooth(22, 0) };
    world.add_body(bullet).expect("a square");
    let mut restored = through_bytes(&world);
    let mut speeds = Vec::new();
    for _ in 0..5 {
        world.step();
        restored.step();
        assert_eq!(restored.state_hash(), world.state_hash());
        speeds.push(world.body(sleeper).expect("a square").velocity().y);
    }
    assert_eq!(speeds, [fx!(0), fx!(-1.5), fx!(-3), fx!(-4.5), fx!(-6)]);
}

/// A step of `PublishedVerlet` begins with the acceleration of the step before: a body that was stopped has none.
#[test]
fn a_force_before_the_sleep_is_over_after_it() {
    let weightless = WorldDef { gravity: vec2(0, 0), integrator: Integrator::PublishedVerlet, ..falling() };
    let (mut world, ids) = world(weightless, [square(vec2(0, 0), 1).expect("a square")]).expect("a scene");
    world.apply_force(ids[0], vec2(1000, 0)).expect("a square");
    world.step();
    world.sleep(ids[0]).expect("a square");
    let place = world.body(ids[0]).expect("a square").position_exact();
    world.wake(ids[0]).expect("a square");
    steps(&mut world, 3);
    assert_eq!(world.body(ids[0]).expect("a square").position_exact(), place);
}

/// The island of a body that a call puts to sleep counts as changed in this tick, with the platform under it, and so does a body that was woken first. A
/// body that sleeps on does not.
#[test]
fn bodies_put_to_sleep_count_as_changed() {
    let platform = BodyDef::kinematic().with_collider(Shape::rectangle(fx!(4), fx!(1)).expect("a box"));
    let places = [vec2(0, 1), vec2(0, 2), vec2(20, 1), vec2(30, 1)];
    let squares = (1..).zip(places).map(|(key, place)| square(place, key).expect("a square"));
    let (mut world, ids) = world(falling(), [platform].into_iter().chain(squares)).expect("a scene");
    let changed = |world: &World, tick| world.changed_since(tick).map(|body| body.id()).collect::<Vec<_>>();
    let [platform, low, high, sleeper, riser] = ids[..] else { panic!("five") };
    steps(&mut world, 3);
    world.sleep(sleeper).expect("a square");
    world.sleep(riser).expect("a square");
    world.step();
    assert_eq!(changed(&world, world.tick()), [platform, low, high]);
    let tick = world.tick();
    world.sleep(low).expect("a square");
    world.sleep(sleeper).expect("a square");
    assert!(are_asleep(&world, &ids));
    assert_eq!(changed(&world, tick), [platform, low, high]);
    world.wake(riser).expect("a square");
    world.sleep(riser).expect("a square");
    assert_eq!(changed(&world, tick), [platform, low, high, riser]);
    world.step();
    assert_eq!(changed(&world, tick), [platform, low, high, riser]);
    assert_eq!(changed(&world, world.tick()), []);
}

/// The report has each body as it is after the step, whatever calls did before it: an observer of events is never wrong.
#[test]
fn reports_say_how_calls_left_bodies() {
    let place = |i: i32| square(vec2(3 * i, 10), i as u64).expect("a square");
    let (mut world, ids) = world(falling(), (0..6).map(place)).expect("a scene");
    let [sleeper, riser, napper, removed_square, disabled_square, struck_square] = ids[..] else { panic!("six") };
    world.step();
    for id in [sleeper, riser, napper, removed_square, disabled_square, struck_square] {
        world.sleep(id).expect("a square");
    }
    world.wake(riser).expect("a square");
    world.wake(napper).expect("a square");
    world.sleep(napper).expect("a square");
    world.remove_body(removed_square).expect("a square");
    world.disable(disabled_square).expect("a square");
    let on_top = BodyDef { velocity: vec2(0, -60), ..square(vec2(15, fx!(11.2)), 9).expect("a square") };
    let hammer = world.add_body(on_top).expect("a square");
    // A saved world reports the same.
    let mut restored = through_bytes(&world);
    let mut copied = world.clone();
    let events: Vec<Event> = world.step().events().collect();
    let slept = |events: &[Event]| {
        let bodies = events.iter().filter_map(|event| match event {
            Event::FellAsleep(body) => Some(*body),
            _ => None,
        });
        bodies.collect::<Vec<_>>()
    };
    assert_eq!(slept(&events), [sleeper, napper]);
    assert!(!events.iter().any(|event| matches!(event, Event::Woke(_))), "{events:?}");
    assert!(are_awake(&world, &[riser, struck_square, hammer]));
    assert_eq!(copied.step().events().collect::<Vec<_>>(), events);
    assert_eq!(slept(&restored.step().events().collect::<Vec<_>>()), [sleeper, napper]);
    assert_eq!(restored.last_report().woke, []);
    assert_eq!(restored.state_hash(), world.state_hash());
    // Now the other way round: what slept before.
    world.wake(sleeper).expect("a square");
    world.sleep(sleeper).expect("a square");
    world.wake(napper).expect("a square");
    world.sleep(napper).expect("a square");
    world.wake(napper).expect("a square");
    let report = world.step();
    assert_eq!((report.woke, report.fell_asleep), (&[napper][..], &[][..]));
    assert_eq!(world.step().woke, []);
}
