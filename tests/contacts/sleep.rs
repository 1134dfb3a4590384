//! Sleeping bodies that are touched, and bystanders.

use super::scenes::{def, square, through_bytes, world};
use umbra_physics::{
    Activity, BodyDef, BodyId, Cause, ColliderDef, ContactSettings, Damping, Exclusion, Fx, Locks, Material, OneWay,
    Shape, Snapshot, TimeStep, Vec2, World, WorldDef, fx, vec2,
};

fn disc(position: Vec2, velocity: Vec2) -> BodyDef {
    let shape = Shape::circle(fx!(0.5)).expect("a disc");
    BodyDef { position, velocity, ..BodyDef::dynamic().with_collider(shape) }
}

/// Discs at rest in a row, next to each other, and one that flies at them.
fn row() -> Vec<BodyDef> {
    let mut bodies: Vec<BodyDef> = (0..5).map(|x| disc(vec2(x, 0), vec2(0, 0))).collect();
    bodies.push(disc(vec2(-9, fx!(0.1)), vec2(4, 0)));
    bodies
}

fn motion(world: &World) -> Vec<[i128; 5]> {
    let motion_of = |body: umbra_physics::BodyRef<'_>| {
        let (x, v) = (body.position_exact(), body.velocity_exact());
        [x.x, x.y, v.x, v.y, body.angular_velocity_exact()].map(umbra_physics::FxAccumulator::to_bits)
    };
    world.bodies().map(motion_of).collect()
}

#[test]
fn whether_bodies_slept_before_a_touch_changes_no_bit() {
    let still = WorldDef { gravity: vec2(0, 0), ..def() };
    let (mut awake, _) = world(still, row()).expect("a scene");
    let (mut sleeping, ids) = world(WorldDef { sleep_after: Some(10), ..still }, row()).expect("a scene");
    let (mut slept, mut woke) = (Vec::new(), Vec::new());
    for _ in 0..300 {
        awake.step();
        let report = sleeping.step();
        slept.extend_from_slice(report.fell_asleep);
        woke.extend_from_slice(report.woke);
        assert_eq!(motion(&sleeping), motion(&awake));
    }
    assert_eq!(slept[..5], ids[..5]);
    assert_eq!(woke[..5], ids[..5], "one wakes the next in the same step");
}

/// Wakes a row of which each touches the next, as far as these touch: not where a pair is excluded, and not where a one-way collider lets
/// the next one pass; the last one passes a collider that holds from the other side.
#[test]
fn waking_goes_no_farther_than_touching() {
    let apart = |i: i32| Vec2::new(fx!(0.9999) * i, fx!(0));
    let facing = |x: i32| Some(OneWay { direction: vec2(x, 0), ..OneWay::default() });
    for (is_excluded, one_way, expected) in
        [(false, None, 5), (true, None, 3), (false, facing(1), 3), (false, facing(-1), 4)]
    {
        let mut bodies: Vec<BodyDef> = (0..5).map(|i| disc(apart(i), vec2(0, 0))).collect();
        bodies[3].colliders[0].one_way = one_way;
        let def = WorldDef { gravity: vec2(0, 0), sleep_after: Some(2), ..def() };
        let (mut world, ids) = world(def, bodies).expect("a scene");
        if is_excluded {
            world.exclude_pair(ids[3], ids[2], Exclusion::Always).expect("a pair");
        }
        (0..10).for_each(|_| _ = world.step());
        assert!(are_asleep(&world, &ids));
        world.set_velocity(ids[0], vec2(0, 1)).expect("a disc");
        world.step();
        assert!(are_asleep(&world, &ids[expected..]), "{is_excluded} {one_way:?}");
        assert_eq!(world.moving_count(), expected, "{is_excluded} {one_way:?}");
    }
}

/// Quarantines a sleeping disc with too many pairs before it wakes those that it touches.
#[test]
fn a_sleeper_in_too_many_pairs_wakes_nobody() {
    let contacts = ContactSettings { max_pairs: 2, max_pairs_per_collider: 1, ..ContactSettings::default() };
    let row = [0, 1, -1].map(|x| Vec2::new(fx!(1.01) * x, fx!(0)));
    let def = WorldDef { gravity: vec2(0, 0), sleep_after: Some(2), contacts, ..def() };
    let (mut world, ids) = world(def, row.map(|at| disc(at, vec2(0, 0)))).expect("a scene");
    (0..10).for_each(|_| _ = world.step());
    assert!(are_asleep(&world, &ids));
    // Two more that are near each other: a third pair.
    for x in [fx!(100), fx!(101.01)] {
        world.add_body(disc(Vec2::new(x, fx!(0)), vec2(0, 0))).expect("a disc");
    }
    let faults: Vec<_> = world.step().faults.iter().map(|fault| (fault.body, fault.cause)).collect();
    assert_eq!(faults, [(ids[0], Cause::Pairs)]);
    assert!(are_asleep(&world, &ids[1..]));
}

#[test]
fn a_sleeping_body_wakes_where_a_static_one_is_put_into_it() {
    let def = WorldDef { gravity: vec2(0, 0), sleep_after: Some(5), ..def() };
    let (mut world, ids) = world(def, [disc(vec2(0, 0), vec2(0, 0)), disc(vec2(50, 0), vec2(1, 0))]).expect("a scene");
    (0..10).for_each(|_| _ = world.step());
    assert_eq!(world.body(ids[0]).expect("it").activity(), Activity::Asleep);
    let wall = BodyDef::fixed().with_collider(Shape::rectangle(fx!(1), fx!(1)).expect("a wall"));
    world.add_body(BodyDef { position: vec2(fx!(0.9), 0), ..wall }).expect("a wall");
    let report = world.step();
    assert_eq!(report.woke, [ids[0]]);
    assert!(world.body(ids[0]).expect("it").velocity().x < fx!(0));
}

#[test]
fn bystanders_change_no_bit() {
    let square_near = |i: i32| square(Vec2::new(fx!(0.3) * i, fx!(2) * i), i as u64).expect("a square");
    let ground = || super::scenes::ground().expect("a ground");
    let pile: Vec<BodyDef> = [ground()].into_iter().chain((1..8).map(square_near)).collect();
    let others = (1..8).map(|i| {
        let def = square_near(i);
        BodyDef { position: def.position + vec2(1_000, 0), ..def }
    });
    let far_ground = BodyDef { position: vec2(1_000, -1), ..ground() };
    let (mut alone, _) = world(def(), pile.clone()).expect("a scene");
    let (mut crowd, _) = world(def(), pile.into_iter().chain([far_ground]).chain(others)).expect("a scene");
    for _ in 0..300 {
        alone.step();
        crowd.step();
        assert_eq!(motion(&crowd)[..8], motion(&alone)[..]);
    }
}

#[test]
fn filters_and_bodies_of_one_kind_pass_each_other() {
    let ghost = |x: i32, vx: i32| {
        let filter = umbra_physics::Filter { category: 4, mask: 2, ..Default::default() };
        let collider = ColliderDef { filter, ..ColliderDef::new(Shape::circle(fx!(0.5)).expect("a disc")) };
        BodyDef { position: vec2(x, 0), velocity: vec2(vx, 0), ..BodyDef::dynamic().with_collider(collider) }
    };
    let still = WorldDef { gravity: vec2(0, 0), ..def() };
    let lift = |x: i32, vx: i32| BodyDef {
        position: vec2(x, 9),
        velocity: vec2(vx, 0),
        ..BodyDef::kinematic().with_collider(Shape::circle(fx!(0.5)).expect("a disc"))
    };
    let (mut world, ids) = world(still, [ghost(-1, 1), ghost(1, -1), lift(-1, 1), lift(1, -1)]).expect("a scene");
    (0..60).for_each(|_| _ = world.step());
    let x: Vec<_> = ids.iter().map(|&id| world.body(id).expect("it").position().x).collect();
    assert_eq!(x, [fx!(0); 4]);
    assert_eq!(world.contacts().count(), 0);
}

/// A stack of squares on the ground of [`scenes`](super::scenes) at x, from the lowest one.
fn stack(x: i32, count: i32) -> impl Iterator<Item = BodyDef> {
    let at = move |i: i32| Vec2::new(Fx::from(x), fx!(0.5) + Fx::from(i));
    (0..count).map(move |i| square(at(i), (100 * x + i) as u64).expect("a square"))
}

/// The ground and two stacks of squares 20 m apart, stepped until all sleep.
fn asleep() -> (World, Vec<BodyId>) {
    let ground = super::scenes::ground().expect("a ground");
    let bodies = [ground].into_iter().chain(stack(0, 5)).chain(stack(20, 3));
    let def = WorldDef { sleep_after: Some(30), ..def() };
    let (mut world, ids) = world(def, bodies.collect::<Vec<_>>()).expect("a scene");
    for _ in 0..300 {
        let slept = world.step().fell_asleep.to_vec();
        // An island as a whole.
        assert!(slept.is_empty() || slept == ids[1..6] || slept == ids[6..] || slept == ids[1..], "{slept:?}");
    }
    assert_eq!(world.moving_count(), 0);
    (world, ids)
}

fn are_asleep(world: &World, ids: &[BodyId]) -> bool {
    ids.iter().all(|&id| world.body(id).expect("it").activity() == Activity::Asleep)
}

#[test]
fn stacks_stop_and_fall_asleep_with_their_contacts() {
    let (mut world, ids) = asleep();
    let before = motion(&world);
    assert!(before.iter().all(|[_, _, x, y, turn]| [x, y, turn] == [&0; 3]));
    let contacts: Vec<_> = world.contacts().collect();
    assert_eq!(contacts.len(), 8);
    let weight = |contact: &umbra_physics::Contact| {
        contact.points().iter().fold(Fx::ZERO, |sum, point| sum + point.normal_impulse)
    };
    // The lowest one carries five kilograms for a sub-step.
    let lowest = contacts.iter().find(|contact| contact.bodies == [ids[0], ids[1]]).expect("the ground is touched");
    assert!((weight(lowest) - fx!(0.16667)).abs() < fx!(0.0001), "{}", weight(lowest));
    (0..100).for_each(|_| _ = world.step());
    assert_eq!((motion(&world), world.contacts().count()), (before, 8));
    // A world restored from bytes goes on alike, also where the stack is woken.
    let saved = world.snapshot().to_bytes();
    let mut twin = Snapshot::from_bytes(&saved, &[]).expect("its own bytes").into_world();
    for world in [&mut world, &mut twin] {
        world.apply_impulse(ids[5], vec2(fx!(0.3), 0)).expect("it is there");
    }
    for _ in 0..200 {
        assert_eq!(world.state_hash(), twin.state_hash());
        assert_eq!(world.step().woke, twin.step().woke);
    }
}

#[test]
fn a_stack_wakes_as_a_whole_and_another_sleeps_on() {
    let push = |world: &mut World, ids: &[BodyId]| world.apply_impulse(ids[3], vec2(0, fx!(0.1)));
    let remove = |world: &mut World, ids: &[BodyId]| world.remove_body(ids[1]).map(drop);
    let lift = |world: &mut World, ids: &[BodyId]| world.set_position(ids[1], vec2(-5, 5));
    let change = |world: &mut World, ids: &[BodyId]| {
        let collider = world.colliders_of(ids[2])?.next().expect("a collider");
        let material = Material { friction: fx!(0.1), ..Material::default() };
        let def = ColliderDef { material, ..world.collider(collider)?.clone() };
        world.set_collider(collider, def)
    };
    type Call<'a> = &'a dyn Fn(&mut World, &[BodyId]) -> Result<(), umbra_physics::Error>;
    for (call, removed) in [(&push as Call<'_>, 0), (&remove, 1), (&lift, 0), (&change, 0)] {
        let (mut world, ids) = asleep();
        call(&mut world, &ids).expect("a call");
        let woke = world.step().woke.to_vec();
        assert_eq!(woke[..], ids[1 + removed..6]);
        assert!(are_asleep(&world, &ids[6..]));
    }
    // A ball on the top of one.
    let (mut world, ids) = asleep();
    let ball = disc(vec2(0, 6), vec2(0, -2));
    world.add_body(ball).expect("a ball");
    let woke = core::iter::repeat_with(|| world.step().woke.to_vec()).take(60).find(|woke| !woke.is_empty());
    assert_eq!(woke.as_deref(), Some(&ids[1..6]));
    assert!(are_asleep(&world, &ids[6..]));
    // The ground is lowered: all fall.
    let (mut world, ids) = asleep();
    world.set_position(ids[0], vec2(0, -3)).expect("the ground");
    assert_eq!(world.step().woke, &ids[1..]);
    (0..20).for_each(|_| _ = world.step());
    assert!(ids[1..].iter().all(|&id| world.body(id).expect("it").velocity().y < fx!(-2)));
    // A wall is put up elsewhere: nobody wakes.
    let (mut world, ids) = asleep();
    let wall = BodyDef::fixed().with_collider(Shape::rectangle(fx!(1), fx!(1)).expect("a wall"));
    world.add_body(BodyDef { position: vec2(-20, 1), ..wall }).expect("a wall");
    assert!(world.step().woke.is_empty());
    assert!(are_asleep(&world, &ids[1..]));
}

#[test]
fn a_moving_support_keeps_a_body_awake() {
    let def = WorldDef { sleep_after: Some(10), ..def() };
    let plank = || ColliderDef::new(Shape::rectangle(fx!(20), fx!(1)).expect("a plank"));
    let belt = |surface_speed| {
        let material = Material { surface_speed, ..Material::default() };
        BodyDef::fixed().with_collider(ColliderDef { material, ..plank() })
    };
    let platform = |velocity| BodyDef { velocity, ..BodyDef::kinematic().with_collider(plank()) };
    let floors = [
        (belt(fx!(0.02)), false),
        (platform(vec2(fx!(0.03), 0)), false),
        (belt(fx!(0)), true),
        (platform(vec2(0, 0)), true),
    ];
    for (floor, sleeps) in floors {
        let on_top = square(vec2(0, 1), 1).expect("a square");
        let (mut world, ids) = world(def, [floor, on_top]).expect("a scene");
        (0..300).for_each(|_| _ = world.step());
        assert_eq!(are_asleep(&world, &ids[1..]), sleeps, "{:?} {:?}", world.body(ids[1]), world.body(ids[0]));
    }
}

#[test]
fn a_body_pushed_in_each_tick_stays_awake_and_with_sleep_speed_0_so_does_every_pressed_one() {
    let (mut world, ids) = asleep();
    for _ in 0..100 {
        world.apply_force(ids[5], vec2(fx!(0.5), 0)).expect("a body");
        world.step();
    }
    assert!(!are_asleep(&world, &ids[1..2]));
    let contacts = umbra_physics::ContactSettings { sleep_speed: Fx::ZERO, ..world.def().contacts };
    world.set_contact_settings(contacts).expect("settings");
    (0..300).for_each(|_| _ = world.step());
    assert!(!are_asleep(&world, &ids[1..2]));
}

/// Bodies that are pushed apart have no velocity after a step.
#[test]
fn without_a_speed_bodies_that_are_pushed_apart_do_not_sleep() {
    let contacts = umbra_physics::ContactSettings { sleep_speed: Fx::ZERO, ..Default::default() };
    let places = [Some(1), None].map(|sleep_after| {
        let squares =
            [vec2(0, 5), vec2(fx!(0.5), 5)].map(|at| square(at, 1 + at.x.to_bits() as u64).expect("a square"));
        let def = WorldDef { sleep_after, contacts, gravity: vec2(0, 0), ..def() };
        let (mut world, ids) = world(def, squares).expect("a scene");
        (0..40).for_each(|_| _ = world.step());
        ids.into_iter().map(|id| world.body(id).expect("it is there").position()).collect::<Vec<_>>()
    });
    assert_eq!(places[0], places[1]);
    assert!(places[0][1].x - places[0][0].x > fx!(0.99), "{places:?}");
}

#[test]
fn boxes_on_a_floor_fall_asleep_after_thirty_steps_at_rest() {
    // As soon as those of Box2D and Rapier: the first step finds the contacts.
    let ground = super::scenes::ground().expect("a ground");
    let boxes = (0..10).map(|i| square(Vec2::new(Fx::from(3 * i), fx!(0.5)), i as u64).expect("a square"));
    let def = WorldDef { sleep_after: Some(30), ..def() };
    let (mut world, _) = world(def, [ground].into_iter().chain(boxes)).expect("a scene");
    let steps = (1..=100).find(|_| {
        world.step();
        world.moving_count() == 0
    });
    assert!(steps.is_some_and(|steps| steps <= 31), "{steps:?} steps");
}

/// The factors of a step are made when they are needed: a restored world has none at first.
#[test]
fn a_body_that_is_touched_flies_with_its_own_gravity_and_damping() {
    let damped = |def: BodyDef| BodyDef { gravity_scale: fx!(0.5), linear_damping: Some(Damping::rate(fx!(3))), ..def };
    let floor = BodyDef { position: vec2(0, -1), ..super::scenes::ground().expect("a ground") };
    let sleeper = damped(square(vec2(0, fx!(0.5)), 1).expect("a square"));
    let shots = [disc(vec2(-40, fx!(0.6)), vec2(20, 0)), disc(vec2(-60, fx!(0.6)), vec2(20, 0))];
    let flying = shots.map(|shot| BodyDef { gravity_scale: fx!(0), ..shot });
    let bodies = [floor, sleeper].into_iter().chain(flying);
    let (mut twin, ids) = world(WorldDef { sleep_after: Some(20), ..def() }, bodies).expect("a scene");
    let mut woke = 0;
    for tick in 0..400 {
        if tick == 60 {
            // All factors of a step are others from here on, and the box sleeps.
            assert_eq!(twin.body(ids[1]).expect("a box").activity(), Activity::Asleep);
            twin.set_time_step(TimeStep::hz(120)).expect("within the limit of time");
        }
        let mut restored = through_bytes(&twin);
        woke += usize::from(twin.step().woke.contains(&ids[1]));
        restored.step();
        assert_eq!(restored.first_difference(&twin), None, "tick {tick}");
    }
    assert!(woke > 0, "no shot woke the box");
}

/// A body that no contact can push apart from a wall sleeps in it. A change of another static body has all looked at again, in a world
/// that goes on as in one that is restored and does not know what has changed.
#[test]
fn a_sleeper_that_is_locked_in_a_wall_has_the_future_of_a_restored_world() {
    let wall = |x: i32| {
        let shape = Shape::rectangle(1, 8).expect("a wall");
        BodyDef { position: vec2(x, 0), key: 10 + x as u64, ..BodyDef::fixed().with_collider(shape) }
    };
    for locks in [Locks { x: true, ..Locks::NONE }, Locks { x: true, y: true, rotation: true }] {
        let locked = BodyDef { locks, ..square(vec2(fx!(0.75), 0), 1).expect("a square") };
        let def = WorldDef { sleep_after: Some(5), gravity: vec2(0, 0), ..def() };
        let (mut world, ids) = world(def, [wall(0), wall(20), locked]).expect("a scene");
        let mut fell = 0;
        for tick in 0..30 {
            if tick % 4 == 3 {
                world.set_position(ids[1], vec2(20 + tick, 0)).expect("elsewhere");
            }
            let mut restored = through_bytes(&world);
            let (step, restored_step) = (world.step(), restored.step());
            assert_eq!(step.woke, restored_step.woke, "{locks:?}, tick {tick}");
            fell += step.fell_asleep.len();
            assert_eq!(restored.first_difference(&world), None, "{locks:?}, tick {tick}");
        }
        assert!(fell > 0, "{locks:?}: it is awake");
    }
}
