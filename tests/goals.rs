//! Kinematic bodies that are moved to a place and an angle: there to the bit, with the velocity that leads there.

#[path = "support/random.rs"]
mod random;

use random::SplitMix;
use umbra_physics::{
    Activity, Attachment, BodyDef, BodyId, BodyKind, Cause, Damping, End, Error, FieldKind, Fx, FxAccumulator,
    Integrator, Irreversible, Locks, Quantity, Snapshot, SnapshotError, SpringConstants, TimeStep, Turn, Vec2, World,
    WorldDef, fx, limits, vec2,
};

fn world(integrator: Integrator) -> World {
    let gravity = vec2(0, -10);
    let def = WorldDef {
        integrator,
        gravity,
        linear_damping: Damping::kept_per_second(fx!(0.5)),
        sleep_after: Some(4),
        ..WorldDef::default()
    };
    World::new(def).expect("a world")
}

fn lift(world: &mut World) -> BodyId {
    world.add_body(BodyDef { position: vec2(1, 2), angle: fx!(0.5), ..BodyDef::kinematic() }).expect("a body")
}

/// Returns true if the body is exactly there, with no remainder.
fn is_at(world: &World, body: BodyId, position: Vec2, angle: Fx) {
    let body = world.body(body).expect("it is there");
    let exact = position.map(FxAccumulator::from_scalar);
    assert_eq!(body.position_exact(), exact);
    assert_eq!(body.angle_exact(), Turn::from_radians(angle));
}

fn motion(world: &World, body: BodyId) -> (Vec2, Fx) {
    let body = world.body(body).expect("it is there");
    (body.velocity(), body.angular_velocity())
}

const STILL: (Vec2, Fx) = (Vec2::ZERO, Fx::ZERO);

#[test]
fn a_body_arrives_at_its_target_to_the_bit_and_then_stands_still() {
    let mut random = SplitMix::seeded(0x90a1_0000_0000_0001);
    for integrator in Integrator::ALL {
        for is_coupled in [false, true] {
            let mut world = world(integrator);
            let body = lift(&mut world);
            let load = world.add_body(BodyDef { position: vec2(1, 1), ..BodyDef::dynamic() }).expect("a body");
            if is_coupled {
                let near = Attachment { body: load, point: vec2(1, 0) };
                let far = End::Body(Attachment { body, point: vec2(0, fx!(0.5)) });
                let spring = SpringConstants { rest: fx!(1), stiffness: fx!(10), damping: fx!(1) };
                world.add_field(FieldKind::Spring { near, far, spring }).expect("a field");
            }
            for _ in 0..60 {
                let rate = [TimeStep::hz(60), TimeStep::ratio(1001, 60_000), TimeStep::hz(7), TimeStep::hz(10_000)];
                world.set_time_step(rate[random.between(0, 4) as usize]).expect("a rate");
                let place = Vec2::new(Fx::from_bits(random.of_bits(37)), Fx::from_bits(random.of_bits(37)));
                let angle = Fx::from_bits(random.of_bits(40));
                let before = world.body(body).expect("it is there");
                let (x, turn) = (before.position(), before.angle_exact());
                world.move_to(body, place, angle).expect("near enough");
                assert_eq!(world.body(body).expect("one").goal(), Some((place, Turn::from_radians(angle))));
                let (num, den) = world.def().time_step.seconds();
                assert_eq!(world.step().faults, []);
                is_at(&world, body, place, angle);
                let (v, spin) = motion(&world, body);
                // The way over the time, to nearest; within an ulp for the doubles that are compared.
                let rate = f64::from(den) / f64::from(num);
                let float = |c: Fx| c.to_bits() as f64;
                let assert_close = |v: Fx, way: f64| {
                    let right = way * rate;
                    assert!((float(v) - right).abs() <= 1.0 + right.abs() / (1u64 << 50) as f64, "{v} for {right}");
                };
                assert_close(v.x, float(place.x) - float(x.x));
                assert_close(v.y, float(place.y) - float(x.y));
                let way = Turn::from_radians(angle).to_bits().wrapping_sub(turn.to_bits()) as i64;
                assert_close(spin, way as f64 / 2f64.powi(32) * std::f64::consts::TAU);
                assert_eq!(world.body(body).expect("it is there").goal(), None);
            }
            let (place, angle) = (vec2(3, 3), fx!(1));
            world.move_to(body, place, angle).expect("near enough");
            world.step();
            for _ in 0..12 {
                world.step();
                is_at(&world, body, place, angle);
                assert_eq!(motion(&world, body), STILL, "{integrator:?}");
            }
        }
    }
}

#[test]
fn exact_ways_have_exact_velocities() {
    let mut world: World =
        World::new(WorldDef { time_step: TimeStep::hz(64), ..WorldDef::default() }).expect("a world");
    let body = world.add_body(BodyDef::kinematic()).expect("a body");
    world.move_to(body, vec2(fx!(0.5), fx!(-0.25)), fx!(0)).expect("near enough");
    // Not before the step.
    assert_eq!(motion(&world, body), STILL);
    world.step();
    assert_eq!(motion(&world, body), (vec2(32, -16), fx!(0)));
    // Moved again, it does not stop.
    world.move_to(body, vec2(1, fx!(-0.5)), fx!(0)).expect("near enough");
    world.step();
    assert_eq!(motion(&world, body), (vec2(32, -16), fx!(0)));
    world.step();
    assert_eq!(motion(&world, body), STILL);
}

#[test]
fn a_body_turns_to_its_target_the_short_way_round() {
    for (from, to, sign) in
        [(0.1, 6.2, -1), (6.2, 0.1, 1), (3.0, 3.2, 1), (0.0, 3.1, 1), (0.0, 3.2, -1), (2.0, -2.0, 1)]
    {
        let fx = |value: f64| Fx::from_bits((value * 4_294_967_296.0) as i64);
        let mut world = World::new(WorldDef::default()).expect("a world");
        let body = world.add_body(BodyDef { angle: fx(from), ..BodyDef::kinematic() }).expect("a body");
        world.move_to(body, Vec2::ZERO, fx(to)).expect("any angle");
        world.step();
        let (_, spin) = motion(&world, body);
        assert_eq!(spin.to_bits().signum(), sign, "{from} to {to}: {spin}");
        assert!(spin.abs() < fx!(188.5), "at most π in a step of 1/60 s");
        is_at(&world, body, Vec2::ZERO, fx(to));
    }
    // The way of half a turn is none: to either side it would be the same.
    let way = |from: u64, to: u64| Turn::from_bits(from).way_to(Turn::from_bits(to)).to_bits();
    assert_eq!(way(5, 5 + (1 << 63)), 0);
    assert_eq!(way(0, (1 << 63) - 1), -way(0, (1 << 63) + 1));
    assert!(way(0, (1 << 63) - 1) > 0);
    let quarter = way(7, 7 + (1 << 62));
    assert_eq!(quarter >> 32, i128::from(Fx::FRAC_PI_2.to_bits()));
}

#[test]
fn dampers_feel_how_it_moves() {
    let run = |moves: bool| {
        let mut world = World::new(WorldDef { sleep_after: None, ..WorldDef::default() }).expect("a world");
        let body = world.add_body(BodyDef::kinematic()).expect("a body");
        let load = world.add_body(BodyDef { position: vec2(3, 0), ..BodyDef::dynamic() }).expect("a body");
        let spring = SpringConstants { rest: fx!(3), stiffness: fx!(0), damping: fx!(5) };
        let (near, far) = (Attachment::centre(load), End::Body(Attachment::centre(body)));
        world.add_field(FieldKind::Spring { near, far, spring }).expect("a field");
        if moves {
            world.move_to(body, vec2(fx!(-0.1), 0), fx!(0)).expect("near enough");
        } else {
            world.set_velocity(body, vec2(-6, 0)).expect("inside");
        }
        world.step();
        let pulled = world.body(load).expect("it is there").velocity();
        world.step();
        (pulled, world.body(load).expect("it is there").velocity())
    };
    let ((first, second), (same, faster)) = (run(true), run(false));
    assert!(first.x < fx!(-0.1), "{first}");
    // 0.1 m is no whole number of ulps.
    assert!(first.x.to_bits().abs_diff(same.x.to_bits()) < 64 && first.y == same.y);
    assert!(second.x > faster.x, "it stands still in the next step");
}

#[test]
fn calls_that_drop_a_target() {
    type Call = fn(&mut World, BodyId) -> Result<(), Error>;
    // The call, and what is left of the velocity of the way before.
    let calls: [(&str, Call, bool); 6] = [
        ("set_velocity", |world, body| world.set_velocity(body, vec2(1, 0)), true),
        ("set_angular_velocity", |world, body| world.set_angular_velocity(body, fx!(1)), true),
        ("set_position", |world, body| world.set_position(body, vec2(9, 9)), false),
        ("set_angle", |world, body| world.set_angle(body, fx!(2)), false),
        ("set_locks", |world, body| world.set_locks(body, Locks { rotation: true, ..Locks::NONE }), false),
        ("set_kind", |world, body| world.set_kind(body, BodyKind::Dynamic), true),
    ];
    for (name, call, goes_on) in calls {
        let mut world = World::new(WorldDef { sleep_after: None, ..WorldDef::default() }).expect("a world");
        let body = lift(&mut world);
        world.move_to(body, vec2(2, 2), fx!(0.25)).expect("near enough");
        world.step();
        world.move_to(body, vec2(3, 3), fx!(0)).expect("near enough");
        call(&mut world, body).expect("it is allowed");
        assert_eq!(world.body(body).expect("it is there").goal(), None, "{name}");
        world.step();
        let now = world.body(body).expect("it is there");
        assert_ne!(now.position(), vec2(3, 3), "{name}");
        assert_eq!(motion(&world, body) != STILL, goes_on, "{name}");
    }
    // A handle that is taken again has no goal left.
    let mut world = world(Integrator::VelocityVerlet);
    let body = lift(&mut world);
    world.move_to(body, vec2(2, 2), fx!(0)).expect("near enough");
    world.remove_body(body).expect("it is there");
    let next = lift(&mut world);
    assert_eq!(world.body(next).expect("it is there").goal(), None);
    world.step();
    is_at(&world, next, vec2(1, 2), fx!(0.5));
}

#[test]
fn a_disabled_body_reaches_no_target_and_stops_when_enabled() {
    let mut world = world(Integrator::VelocityVerlet);
    let body = lift(&mut world);
    world.move_to(body, vec2(2, 2), fx!(0.5)).expect("near enough");
    world.step();
    world.move_to(body, vec2(3, 2), fx!(0.5)).expect("near enough");
    world.disable(body).expect("it takes part");
    (0..3).for_each(|_| _ = world.step());
    is_at(&world, body, vec2(2, 2), fx!(0.5));
    assert_eq!(motion(&world, body), (vec2(60, 0), fx!(0)));
    assert_eq!(world.move_to(body, vec2(3, 2), fx!(0.5)), Err(Error::Disabled { body }));
    world.enable(body).expect("it is disabled");
    world.step();
    is_at(&world, body, vec2(2, 2), fx!(0.5));
    assert_eq!(motion(&world, body), STILL);
}

#[test]
fn refusals_have_their_reasons() {
    let mut world = World::new(WorldDef::default()).expect("a world");
    let body = world.add_body(BodyDef::kinematic()).expect("a body");
    let [ball, wall] = [BodyDef::dynamic(), BodyDef::fixed()].map(|def| world.add_body(def).expect("a body"));
    for body in [ball, wall] {
        assert_eq!(world.move_to(body, Vec2::ZERO, fx!(0)), Err(Error::NotKinematic { body }));
    }
    let out_of = |quantity| Err(Error::OutOfRange { quantity });
    let outside = Vec2::new(limits::POSITION + Fx::DELTA, Fx::ZERO);
    assert_eq!(world.move_to(body, outside, fx!(0)), out_of(Quantity::Position));
    // 2^20 m/s for 1/60 s, rounded down.
    let reach = Fx::from_bits((1 << 52) / 60);
    assert_eq!(world.move_to(body, Vec2::new(reach, -reach), fx!(0)), Ok(()));
    assert_eq!(world.move_to(body, Vec2::new(Fx::ZERO, reach + Fx::DELTA), fx!(0)), out_of(Quantity::Velocity));
    assert_eq!(world.move_to(body, Vec2::new(limits::POSITION, Fx::ZERO), fx!(0)), out_of(Quantity::Velocity));
    assert_eq!(world.body(body).expect("it is there").goal().map(|(at, _)| at), Some(Vec2::new(reach, -reach)));
    assert_eq!(world.step().faults, []);
    is_at(&world, body, Vec2::new(reach, -reach), fx!(0));
    // Along a locked axis there is no way, across it there is.
    world.set_locks(body, Locks { y: true, rotation: true, ..Locks::NONE }).expect("it is there");
    let locked = |quantity| Err(Error::Locked { quantity });
    assert_eq!(world.move_to(body, Vec2::ZERO, fx!(0)), locked(Quantity::Velocity));
    assert_eq!(world.move_to(body, vec2(0, -reach), fx!(1)), locked(Quantity::AngularVelocity));
    assert_eq!(world.move_to(body, vec2(0, -reach), fx!(0)), Ok(()));
    world.step();
    is_at(&world, body, vec2(0, -reach), fx!(0));
}

/// To the last place there is, on the way to which the stages may come out an ulp beyond.
#[test]
fn the_edge_of_the_envelope_is_a_goal() {
    let mut random = SplitMix::seeded(0x90a1_0000_0000_0002);
    for integrator in Integrator::ALL {
        let mut world = world(integrator);
        let body = lift(&mut world);
        for _ in 0..50 {
            let inside = limits::POSITION - Fx::from_bits(random.between(1, 1 << 45));
            world.set_position(body, Vec2::new(inside, -inside)).expect("inside");
            world.move_to(body, Vec2::new(limits::POSITION, -limits::POSITION), fx!(0)).expect("near enough");
            assert_eq!(world.step().faults, [], "{integrator:?}");
            is_at(&world, body, Vec2::new(limits::POSITION, -limits::POSITION), fx!(0));
        }
    }
}

#[test]
fn a_step_that_became_too_short_quarantines_and_moves_nothing() {
    let mut world = World::new(WorldDef { sleep_after: None, ..WorldDef::default() }).expect("a world");
    let bystanders: Vec<BodyId> = (0..200).map(|_| world.add_body(BodyDef::dynamic()).expect("a body")).collect();
    let body = lift(&mut world);
    world.set_velocity(body, vec2(1, 2)).expect("inside");
    world.move_to(body, vec2(10_000, 0), fx!(1)).expect("600 km/s");
    world.set_time_step(TimeStep::hz(10_000)).expect("a rate");
    let report = world.step();
    let faults: Vec<_> = report.faults.iter().map(|fault| (fault.body, fault.cause)).collect();
    assert_eq!(faults, [(body, Cause::Velocity)]);
    is_at(&world, body, vec2(1, 2), fx!(0.5));
    assert_eq!(motion(&world, body), (vec2(1, 2), fx!(0)));
    let now = world.body(body).expect("it is there");
    assert_eq!((now.activity(), now.goal()), (Activity::Quarantined, None));
    assert!(bystanders.iter().all(|&id| world.body(id).expect("one").activity() == Activity::Awake));
    // Back at the state it has: its own velocity.
    world.release(body).expect("it is quarantined");
    world.step();
    assert_eq!(motion(&world, body), (vec2(1, 2), fx!(0)));
    // In a longer step it is there all the same.
    world.move_to(body, vec2(5, 5), fx!(1)).expect("near enough");
    world.set_time_step(TimeStep::hz(1)).expect("a rate");
    world.step();
    is_at(&world, body, vec2(5, 5), fx!(1));
}

#[test]
fn sleep_changes_nothing() {
    let run = |sleep_after| {
        let mut world = World::new(WorldDef { sleep_after, ..WorldDef::default() }).expect("a world");
        let body = lift(&mut world);
        let load = world.add_body(BodyDef { position: vec2(1, 3), ..BodyDef::dynamic() }).expect("a body");
        let spring = SpringConstants { rest: fx!(1), stiffness: fx!(400), damping: fx!(40) };
        let (near, far) = (Attachment::centre(load), End::Body(Attachment::centre(body)));
        world.add_field(FieldKind::Spring { near, far, spring }).expect("a field");
        let (mut way, mut asleep) = (Vec::new(), 0);
        for tick in 0..400 {
            if [3, 4, 150, 151, 300].contains(&tick) {
                world.move_to(body, vec2(1, fx!(2) + Fx::from_bits(tick << 20)), fx!(0.5)).expect("near enough");
            }
            world.step();
            asleep += world.bodies().filter(|body| body.activity() == Activity::Asleep).count();
            way.push([body, load].map(|id| {
                let body = world.body(id).expect("it is there");
                (body.position_exact(), body.velocity_exact())
            }));
        }
        (way, asleep)
    };
    let (awake, none) = run(None);
    for ticks in [1, 2, 3, 30] {
        let (way, asleep) = run(Some(ticks));
        assert!(way == awake, "asleep after {ticks}");
        assert!(asleep > 0 && none == 0, "after {ticks}: {asleep}");
    }
}

#[test]
fn steps_to_and_from_a_goal_are_not_undone() {
    let def = WorldDef { gravity: vec2(0, -10), sleep_after: None, ..WorldDef::default() };
    let mut world = World::new(def).expect("a world");
    let body = world.add_body(BodyDef::kinematic()).expect("a body");
    let refused = Err(Error::NotReversible { why: Irreversible::Moved });
    world.step();
    world.move_to(body, vec2(1, 0), fx!(0)).expect("near enough");
    for what in ["to come", "reached", "stopped"] {
        let before = world.state_hash();
        assert_eq!(world.step_back(&[]), refused, "{what}");
        assert_eq!(world.state_hash(), before);
        world.step();
    }
    // It has stood still for whole steps now.
    let before = world.state_hash();
    world.step();
    assert_eq!(world.step_back(&[]), Ok(()));
    assert_eq!(world.state_hash(), before);
    assert_eq!(world.step_back(&[]), Ok(()));
    assert_eq!(world.step_back(&[]), refused, "to when it stopped, and no farther");
}

/// A body that arrived and is disabled still has to stop when it is enabled; meanwhile no step touches it.
#[test]
fn steps_in_which_one_that_arrived_is_out_are_undone() {
    let def = WorldDef { gravity: vec2(0, -10), sleep_after: None, ..WorldDef::default() };
    let mut world = World::new(def).expect("a world");
    let [body, _] = [BodyDef::kinematic(), BodyDef::dynamic()].map(|def| world.add_body(def).expect("a body"));
    world.move_to(body, vec2(1, 0), fx!(0)).expect("near enough");
    world.step();
    world.disable(body).expect("it takes part");
    let before = world.state_hash();
    world.step();
    assert_eq!(world.step_back(&[]), Ok(()));
    assert_eq!(world.state_hash(), before);
    assert_eq!(world.step_back(&[]), Err(Error::NotReversible { why: Irreversible::Moved }));
    world.enable(body).expect("it is disabled");
    assert_eq!(world.step_back(&[]), Err(Error::NotReversible { why: Irreversible::Moved }));
    world.step();
    assert_eq!(motion(&world, body), STILL);
}

/// In ascending order, in descending order, and with two of three taken back.
#[test]
fn a_crowd_arrives_in_whatever_order_it_is_sent() {
    const COUNT: u32 = 1 << 16;
    let goal = |i: u32| vec2(Fx::from_bits(i64::from(i) << 24), 1);
    let mut world = World::new(WorldDef::default()).expect("a world");
    let bodies: Vec<BodyId> = (0..COUNT).map(|_| world.add_body(BodyDef::kinematic()).expect("a body")).collect();
    let mut twin = world.clone();
    for (i, body) in (0..COUNT).zip(&bodies).rev() {
        world.move_to(*body, goal(i), fx!(0)).expect("near enough");
    }
    for (i, body) in (0..COUNT).zip(&bodies) {
        twin.move_to(*body, goal(i), fx!(0)).expect("near enough");
    }
    assert_eq!(world.state_hash(), twin.state_hash());
    for (i, body) in bodies.iter().enumerate().rev().filter(|(i, _)| i % 3 > 0) {
        world.set_velocity(*body, Vec2::ZERO).expect("it is kinematic");
        twin.set_velocity(bodies[bodies.len() - 1 - i], Vec2::ZERO).expect("it is kinematic");
    }
    assert_eq!(world.state_hash(), twin.state_hash());
    world.step();
    for (i, body) in (0..COUNT).zip(bodies) {
        is_at(&world, body, if i % 3 == 0 { goal(i) } else { Vec2::ZERO }, fx!(0));
    }
}

#[test]
fn goals_are_state() {
    for steps in 0..4 {
        let mut world = world(Integrator::VelocityVerlet);
        let body = lift(&mut world);
        let still = world.clone();
        world.move_to(body, vec2(2, 2), fx!(0.25)).expect("near enough");
        if steps == 0 {
            assert_ne!((world.state_hash(), world.physics_hash()), (still.state_hash(), still.physics_hash()));
            let differences: Vec<String> =
                world.differences(&still).iter().map(|difference| format!("{difference:#}")).collect();
            assert_eq!(differences[0], "body 0, kinematic_target.given: true and false");
        }
        (0..steps).for_each(|_| _ = world.step());
        let bytes = world.snapshot().to_bytes();
        let mut read = Snapshot::from_bytes(&bytes, &[]).expect("sound").into_world();
        let mut copy = world.clone();
        let mut ahead = world.preview(body).expect("it is there");
        for _ in 0..5 {
            assert_eq!(read.state_hash(), world.state_hash());
            assert_eq!(copy.state_hash(), world.state_hash());
            let twin = ahead.body().expect("it is there");
            assert_eq!(twin.position_exact(), world.body(body).expect("one").position_exact());
            assert_eq!(twin.velocity_exact(), world.body(body).expect("one").velocity_exact());
            [&mut read, &mut copy, &mut world].into_iter().for_each(|world| _ = world.step());
            ahead.step();
        }
    }
}

#[test]
fn forged_targets_are_refused() {
    let mut world = world(Integrator::VelocityVerlet);
    let body = lift(&mut world);
    world.move_to(body, vec2(2, 2), fx!(0.25)).expect("near enough");
    let bytes = world.snapshot().to_bytes();
    // The only body: its kinematic target ends where its slot does, before the free slots, fields, their free slots, ages, the tick
    // of a contact, contacts, one-way and excluded pairs, overlaps, ended pairs, joints, their free slots, the tick of a pull, the
    // woken ones, hash and seal.
    let end = bytes.len() - 16 - 2 * 8 - 12 * 4;
    let arrived = end - 1;
    assert_eq!((bytes[arrived], bytes[arrived - 25], bytes[arrived - 26]), (0, 1, 1));
    let read = |change: &[(usize, u8)]| {
        let mut forged = bytes.clone();
        change.iter().for_each(|&(at, byte)| forged[at] = byte);
        match Snapshot::from_bytes(&forged, &[]) {
            Err(SnapshotError::Invalid { error, .. }) => Some(error),
            _ => None,
        }
    };
    let kind = bytes.windows(2).position(|two| two == [1, 1]).expect("present, and kinematic") + 1;
    assert_eq!(read(&[(arrived, 1)]), None, "that may be; the hash is another");
    assert_eq!(read(&[(kind, 2)]), Some(Error::Inconsistent), "of a dynamic body");
    assert_eq!(read(&[(kind + 1, 3)]), Some(Error::Inconsistent), "of a disabled one");
    assert_eq!(read(&[(kind + 1, 1)]), Some(Error::Inconsistent), "of a sleeper");
    let x = arrived - 24;
    assert_eq!(read(&[(x + 7, 0x7f)]), Some(Error::OutOfRange { quantity: Quantity::Position }));
}

#[test]
fn a_step_that_became_too_short_quarantines_also_where_bodies_sleep_at_once() {
    let mut world = World::new(WorldDef { sleep_after: Some(1), ..WorldDef::default() }).expect("a world");
    let body = world.add_body(BodyDef { velocity: vec2(1, 2), ..BodyDef::kinematic() }).expect("a body");
    world.move_to(body, vec2(10_000, 0), fx!(0)).expect("near enough");
    world.set_time_step(TimeStep::hz(10_000)).expect("a time step");
    let report = world.step();
    assert_eq!((report.faults.len(), report.fell_asleep), (1, &[][..]));
    assert_eq!(world.body(body).expect("it is there").activity(), Activity::Quarantined);
    let bytes = world.snapshot().to_bytes();
    assert_eq!(Snapshot::from_bytes(&bytes, &[]).expect("it is whole").world().state_hash(), world.state_hash());
}

/// Rounding reads some angles and their mirror images as not mirrored.
#[test]
fn whether_a_locked_angle_is_the_one_that_is_asked_for_is_the_same_in_a_mirror() {
    let locks = Locks { rotation: true, ..Locks::NONE };
    let mut random = SplitMix::seeded(7);
    let (mut taken, mut refused) = (0, 0);
    for _ in 0..2_000 {
        let angle = Fx::from_bits((random.next() >> 2) as i64 % Fx::TAU.to_bits());
        let spin = Fx::from_bits(random.next() as i64 >> 32);
        let off = Fx::from_bits(random.next() as i64 % 3);
        let mut asked = Vec::new();
        for sign in [Fx::ONE, -Fx::ONE] {
            let mut world = World::new(WorldDef::default()).expect("a world");
            let def = BodyDef { angle: sign * angle, angular_velocity: sign * spin, ..BodyDef::kinematic() };
            let body = world.add_body(def).expect("a body");
            world.step();
            world.set_locks(body, locks).expect("it is there");
            let read = world.body(body).expect("it is there").angle();
            assert_eq!(
                world.check(&umbra_physics::Command::MoveTo { body, position: Vec2::ZERO, angle: read }),
                Ok(())
            );
            asked.push((world, body, read));
        }
        // What the first is asked for, and the second for its mirror image.
        let angle = asked[0].2 + off;
        let said = [(0, angle), (1, -angle)].map(|(i, angle)| {
            let (world, body, _) = &asked[i];
            world.check(&umbra_physics::Command::MoveTo { body: *body, position: Vec2::ZERO, angle })
        });
        assert_eq!(said[0], said[1], "{angle}, {spin}");
        if said[0].is_ok() { taken += 1 } else { refused += 1 }
    }
    assert!(taken > 100 && refused > 100, "{taken}, {refused}");
}
