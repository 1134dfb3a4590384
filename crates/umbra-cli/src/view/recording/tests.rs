//! Recordings: frames, lives, looks and clocks.

use serde_json::Value;
use umbra_physics::scalar::ToF64;
use umbra_physics::{
    BodyDef, DebugDraw, Distance, DrawOptions, FieldKind, JointKind, JointLimits, Pose, Prismatic, Region, Role, Shape,
    TimeStep, Wheel, WorldDef, fx, vec2,
};

use super::super::events::EVENTS;
use super::*;

fn world() -> World<Fx> {
    World::new(WorldDef { gravity: vec2(0, -10), sleep_after: Some(5), ..WorldDef::default() }).expect("a world")
}

fn ball(x: i32) -> BodyDef {
    BodyDef { position: vec2(x, 0), velocity: vec2(fx!(0.3), 1), angular_velocity: fx!(2.5), ..BodyDef::dynamic() }
}

fn unnamed(_: BodyId) -> String {
    String::new()
}

/// The values of all bodies.
fn truth(world: &World<Fx>) -> BTreeMap<BodyId, Sample> {
    let values = |body: BodyRef<'_>| {
        let (at, v) = (body.position(), body.velocity());
        (body.id(), [at.x, at.y, body.angle(), v.x, v.y, body.angular_velocity()].map(Fx::to_bits))
    };
    world.bodies().map(values).collect()
}

fn tick_of(recording: &Recording, frame: u64) -> u64 {
    recording.last.min(recording.start + frame * recording.stride)
}

#[test]
fn every_frame_is_the_world_at_its_tick_however_often_it_was_thinned() {
    for samples in [60, 100, 250, 700, 10_000] {
        let mut world = world();
        let (mut recording, mut states) = (Recording::new(Budget { samples, ..Budget::default() }), Vec::new());
        world.step();
        let mut bodies = vec![world.add_body(ball(0)).expect("there is room")];
        for tick in 0..=203u64 {
            states.push((world.tick(), world.state_hash(), truth(&world)));
            recording.see(&world, None, unnamed);
            if tick % 17 == 3 {
                bodies.push(world.add_body(ball(tick as i32)).expect("there is room"));
            }
            if tick % 29 == 11 {
                world.remove_body(bodies.remove(0)).expect("it is there");
            }
            if tick < 203 {
                world.step();
            }
        }
        let last = states.last().map(|(tick, ..)| *tick).expect("some");
        // What was done after the last step is not of the run.
        recording.finish(&world);
        assert_eq!((recording.start, recording.last), (1, last));
        assert_eq!(recording.stride > 1, samples < 1000, "{samples}");
        let mut count = 0;
        for (frame, hash) in recording.hashes.iter().enumerate() {
            let tick = tick_of(&recording, frame as u64);
            let (at, expected, values) = &states[(tick - 1) as usize];
            assert_eq!((at, expected), (&tick, hash), "{samples}");
            for life in &recording.lives {
                let sample = (frame as u64).checked_sub(life.first).filter(|&index| index < life.track.count());
                let sample = sample.and_then(|index| life.track.samples().nth(index as usize));
                let known = values.get(&life.id).copied();
                assert_eq!(sample, known, "{} at {tick}, {samples}", life.id);
                count += usize::from(known.is_some());
            }
        }
        assert!(count > 50);
    }
}

#[test]
fn a_slot_taken_again_within_a_tick_is_another_body() {
    let mut world = world();
    let mut recording = Recording::new(Budget::default());
    let first = world.add_body(ball(1)).expect("there is room");
    recording.see(&world, None, unnamed);
    world.step();
    world.remove_body(first).expect("it is there");
    let second = world.add_body(ball(2)).expect("there is room");
    assert_eq!(first.parts().0, second.parts().0);
    recording.see(&world, None, unnamed);
    let events: Vec<_> =
        recording.events.told.iter().map(|event| (event.tick, event.what, &event.bodies[..])).collect();
    assert_eq!(events, [(1, What::Removed, &[0][..]), (1, What::Added, &[1][..])]);
    assert_eq!((recording.lives[0].to, recording.lives[1].from), (0, 1));
}

#[test]
fn a_run_that_is_not_the_recorded_one_is_one_event_while_it_lasts() {
    let mut world = world();
    let mut recording = Recording::new(Budget::default());
    for tick in 0..12 {
        let wrong = u64::from((3..7).contains(&tick) || tick == 10);
        recording.see(&world, Some(world.state_hash() ^ wrong), unnamed);
        world.step();
    }
    let events: Vec<_> = recording.events.told.iter().map(|event| (event.tick, event.until, event.what)).collect();
    assert_eq!(events, [(3, 6, What::Diverged), (10, 10, What::Diverged)]);
}

#[test]
fn time_is_that_of_the_world_when_the_step_changes() {
    let mut world = world();
    let mut recording = Recording::new(Budget::default());
    let mut times = Vec::new();
    for tick in 0..40 {
        times.push((world.elapsed().num, world.elapsed().den));
        recording.see(&world, None, unnamed);
        match tick {
            9 => world.set_time_step(TimeStep::ratio(1001, 60_000)).expect("within the limits"),
            10 => world.set_time_step(TimeStep::hz(7)).expect("within the limits"),
            _ => {}
        }
        world.step();
    }
    assert_eq!(recording.clock.iter().map(|span| span.tick).collect::<Vec<_>>(), [0, 9, 10]);
    for (tick, (num, den)) in times.into_iter().enumerate() {
        let span = recording.clock.iter().rev().find(|span| span.tick <= tick as u64).expect("one");
        let ((top, bottom), (n, d)) = (span.time, span.step.seconds());
        let (n, d, ticks) = (u128::from(n), u128::from(d), u128::from(tick as u64 - span.tick));
        assert_eq!((top * d + ticks * n * bottom) * den, num * bottom * d, "tick {tick}");
    }
}

#[test]
fn bodies_at_rest_and_fields_have_their_ticks() {
    let mut world = world();
    let mut recording = Recording::new(Budget::default());
    let still = BodyDef { gravity_scale: Fx::ZERO, ..BodyDef::dynamic() };
    let body = world.add_body(still).expect("there is room");
    let region = Region::Disc { centre: vec2(50, 0), radius: Fx::ONE };
    let zone = |g: i32| FieldKind::Zone { region, acceleration: vec2(0, g) };
    let field = world.add_field(zone(1)).expect("there is room");
    for tick in 0..20 {
        recording.see(&world, None, unnamed);
        match tick {
            8 => world.wake(body).expect("it is there"),
            12 => world.set_field(field, zone(2)).expect("it is there"),
            15 => world.remove_field(field).expect("it is there"),
            _ => {}
        }
        world.step();
    }
    let events: Vec<_> = recording.events.told.iter().map(|event| (event.tick, event.what)).take(2).collect();
    assert_eq!(events, [(5, What::Slept), (9, What::Woke)]);
    let fields: Vec<_> = recording.fields.iter().map(|field| (field.from, field.to)).collect();
    assert_eq!(fields, [(0, 12), (13, 15)]);
}

/// The contacts of a frame again: the body, the number of points, and the sum of their impulses along the normal.
fn decoded(mut bytes: &[u8]) -> Vec<(u32, usize, f32)> {
    let word = |bytes: &mut &[u8]| {
        let (first, rest) = bytes.split_first_chunk::<4>().expect("a word");
        *bytes = rest;
        *first
    };
    let mut contacts = Vec::new();
    while !bytes.is_empty() {
        let head = u32::from_le_bytes(word(&mut bytes));
        let (angle, friction) = (f32::from_le_bytes(word(&mut bytes)), f32::from_le_bytes(word(&mut bytes)));
        assert!((angle - std::f32::consts::FRAC_PI_2).abs() < 1e-3 && friction.abs() < 1e-3, "{angle} {friction}");
        let points = (head & 1) as usize + 1;
        let impulses = (0..points).map(|_| {
            let [x, y, impulse] = [(); 3].map(|()| f32::from_le_bytes(word(&mut bytes)));
            assert!((x.abs() - 0.5).abs() < 0.01 && (y + 0.5).abs() < 0.01, "{x} {y}");
            impulse
        });
        let total = impulses.sum();
        contacts.push((head >> 1, points, total));
    }
    contacts
}

#[test]
fn contacts_are_kept_for_each_frame_if_they_are_asked_for() {
    for samples in [30, 10_000] {
        let mut world = world();
        let rectangle = |width: i32, height: i32| Shape::rectangle(width, height).expect("a fair shape");
        let floor = BodyDef::fixed().with_collider(rectangle(20, 2));
        world.add_body(BodyDef { position: vec2(0, -1), ..floor }).expect("there is room");
        let crate_ = BodyDef::dynamic().with_collider(rectangle(1, 1));
        world.add_body(BodyDef { position: vec2(0, fx!(0.5)), ..crate_ }).expect("there is room");
        let budget = Budget { samples, ..Budget::default() };
        let (mut with, mut without) = (Recording::new(budget).with_contacts(true), Recording::new(budget));
        for tick in 0..=101 {
            with.see(&world, None, unnamed);
            without.see(&world, None, unnamed);
            if tick < 101 {
                world.step();
            }
        }
        with.finish(&world);
        without.finish(&world);
        assert_eq!((without.contacts.is_none(), &with.hashes), (true, &without.hashes));
        let frames = with.contacts.expect("they were asked for");
        assert_eq!((frames.len(), with.stride > 1), (with.hashes.len(), samples < 100));
        assert_eq!(decoded(&frames[0]), [], "before the first step");
        for (frame, bytes) in frames.iter().enumerate().skip(10usize.div_ceil(with.stride as usize)) {
            let contacts = decoded(bytes);
            let [(1, 2, total)] = contacts[..] else { panic!("frame {frame}: {contacts:?}") };
            assert!((total - 1.0 / 30.0).abs() < 2e-4, "frame {frame}: {total}");
        }
    }
}

#[test]
fn a_body_is_drawn_anew_when_its_colliders_change() {
    let mut world = world();
    let disc = |radius: i32| Shape::circle(radius).expect("a fair shape");
    let body = world.add_body(BodyDef::dynamic().with_collider(disc(1))).expect("there is room");
    world.add_body(BodyDef::dynamic()).expect("there is room");
    let mut recording = Recording::new(Budget::default());
    for tick in 0..12 {
        recording.see(&world, None, unnamed);
        let collider = world.colliders_of(body).expect("it is there").next();
        match tick {
            3 => _ = world.add_collider(body, ColliderDef::new(disc(2))).expect("there is room"),
            6 => world.remove_collider(collider.expect("one")).expect("it is there"),
            9 => world.set_collider(collider.expect("one"), ColliderDef::new(disc(1))).expect("it is there"),
            _ => {}
        }
    }
    let drawn: Vec<_> = recording.lives[0].looks.iter().map(|(_, look)| look.shape).collect();
    assert_eq!((drawn, recording.lives[1].looks[0].1.shape), (vec![Some(0), Some(1), Some(2), Some(0)], None));
    let circle = |radius: f64| serde_json::json!(["c", [0.0, 0.0], radius, [radius, 0.0]]);
    let shapes: Vec<_> = recording.shapes.into_iter().map(|(_, drawn)| drawn).collect();
    let expected = [vec![circle(1.0)], vec![circle(1.0), circle(2.0)], vec![circle(2.0)]];
    assert_eq!(shapes, expected.map(serde_json::Value::Array));
}

/// A lift, a wheel that turns on it, a rod between two falling bodies, and a rope of 1 m that breaks by its load at once.
fn joined() -> (World<Fx>, [JointId; 4]) {
    let mut world = world();
    let [cabin, tyre, first, second, load] = [0, 1, 3, 5, 8].map(|x| world.add_body(ball(x)).expect("there is room"));
    let lift = JointDef::along(&world, None, cabin, vec2(0, 0), vec2(1, 2)).expect("a joint");
    let limits = Some(JointLimits { lower: fx!(-1), upper: fx!(40) });
    let lift = JointDef { kind: JointKind::Prismatic(Prismatic { limits, ..Prismatic::default() }), ..lift };
    let axle = JointDef::along(&world, cabin, tyre, vec2(1, 0), vec2(0, 1)).expect("a joint");
    let axle = JointDef { kind: JointKind::Wheel(Wheel::default()), ..axle };
    let rod = JointDef::between(&world, first, vec2(3, fx!(0.5)), second, vec2(5, 0)).expect("a joint");
    let rope = JointDef::between(&world, None, vec2(8, 1), load, vec2(8, 0)).expect("a joint");
    let rope = JointDef {
        kind: JointKind::Distance(Distance::rope(fx!(1))),
        break_force: Some(fx!(1)),
        enabled: false,
        ..rope
    };
    let joints = [lift, axle, rod, rope].map(|joint| world.add_joint(joint).expect("a fair joint"));
    (world, joints)
}

/// The lines and points of joints as the library draws them.
#[derive(Default)]
struct Drawn(Vec<(Role, Vec<[f64; 2]>)>);

impl DebugDraw for Drawn {
    fn polygon(&mut self, _corners: &[[f64; 2]], role: Role) {
        panic!("an area of {role:?}");
    }

    fn segment(&mut self, ends: [[f64; 2]; 2], role: Role) {
        self.0.push((role, ends.to_vec()));
    }

    fn point(&mut self, at: [f64; 2], role: Role) {
        self.0.push((role, vec![at]));
    }
}

/// The points of a mark in the world, with the bodies where they are.
fn placed(recording: &Recording, world: &World<Fx>, mark: &Value) -> Vec<[f64; 2]> {
    let pair = |value: &Value| [0, 1].map(|i| value[i].as_f64().expect("a number"));
    let ends = mark.as_array().expect("a list").iter().skip(1).map(|end| match end[1].as_u64() {
        Some(life) => {
            let body = world.body(recording.lives[life as usize].id).expect("it is there");
            Pose { position: body.position().to_f64(), angle: body.angle().to_f64() }.point(pair(&end[0]))
        }
        None => pair(&end[0]),
    });
    ends.collect()
}

#[test]
fn joints_are_where_the_library_draws_them() {
    let (mut world, joints) = joined();
    let mut recording = Recording::new(Budget::default());
    for tick in 0..90 {
        recording.see(&world, None, unnamed);
        let mut drawn = Drawn::default();
        world.debug_draw(Pose::of, &DrawOptions { bodies: false, fields: false, ..DrawOptions::default() }, &mut drawn);
        let mut count = 0;
        for (joint, &number) in &recording.joints_there {
            let marks = recording.joints[number].drawing.as_ref().and_then(Value::as_array).expect("a list");
            let expected: Vec<_> = drawn.0.iter().filter(|(role, _)| *role == Role::Joint(*joint)).collect();
            assert_eq!(marks.len(), expected.len(), "{joint}");
            for (mark, (_, expected)) in marks.iter().zip(expected) {
                let points = placed(&recording, &world, mark);
                assert_eq!((points.len(), &mark[0]), (expected.len(), &["m", "s"].map(Value::from)[points.len() - 1]));
                let off =
                    points.iter().zip(expected).map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1])).fold(0.0, f64::max);
                assert!(off < 1e-9, "{joint} at {tick}: {off}");
                count += 1;
            }
        }
        assert_eq!(count, drawn.0.len(), "{tick}");
        assert!(count >= 11, "two lines of the lift and of the wheel, one of the rod, and their ends: {count}");
        if tick == 40 {
            world.enable_joint(joints[3], true).expect("it is there");
        }
        world.step();
    }
    assert!(world.joint(joints[3]).expect("it is there").is_broken());
}

#[test]
fn joints_are_drawn_while_steps_keep_them() {
    let (mut world, [lift, axle, rod, rope]) = joined();
    let mut recording = Recording::new(Budget::default());
    for tick in 0..60 {
        recording.see(&world, None, unnamed);
        match tick {
            10 => world.enable_joint(axle, false).expect("it is there"),
            15 => world.enable_joint(rope, true).expect("it is there"),
            20 => world.enable_joint(axle, true).expect("it is there"),
            // Limits change the drawing of a lift, its friction does not.
            30 | 35 => {
                let limits = Some(JointLimits { lower: fx!(-1), upper: fx!(50) });
                let friction = Fx::from(i32::from(tick == 35));
                let kind = JointKind::Prismatic(Prismatic { limits, friction, ..Prismatic::default() });
                world.set_joint_kind(lift, kind).expect("it is there");
            }
            40 => {
                let [first, _] = world.joint(rod).expect("it is there").bodies();
                world.remove_body(first.expect("a body")).expect("it is there");
            }
            _ => {}
        }
        world.step();
    }
    let mut spans: Vec<_> = recording.joints.iter().map(|joint| (joint.from, joint.to)).collect();
    spans.sort_unstable();
    // The rope broke in the step in which it was enabled.
    assert_eq!(spans, [(0, 10), (0, 30), (0, 40), (21, 59), (31, 59)]);
}

/// The ticks, the numbers of times and the texts of all events.
fn listed(events: &Events) -> Vec<(u64, u64, u64, &str)> {
    events.told.iter().map(|event| (event.tick, event.until, event.times, &event.text[..])).collect()
}

#[test]
fn inputs_about_one_thing_that_change_all_the_time_are_one_event() {
    let mut events = Events::default();
    let velocity = |events: &mut Events, tick: u64, value: u64| {
        events.input(tick, "velocity of a".to_owned(), format!("velocity of a: ({value}, 0) m/s"));
    };
    // Another value each tick, then each third tick; a pause; a value that is held, and another one.
    (0..100).for_each(|tick| velocity(&mut events, tick, tick));
    (100..160).step_by(3).for_each(|tick| velocity(&mut events, tick, tick));
    (200..210).for_each(|tick| velocity(&mut events, tick, 7));
    (210..220).for_each(|tick| velocity(&mut events, tick, 8));
    // The same each sixth tick goes on, and each seventh it is another one.
    (300..313).step_by(6).for_each(|tick| velocity(&mut events, tick, 9));
    (400..415).step_by(7).for_each(|tick| velocity(&mut events, tick, 9));
    let expected = [
        (0, 157, 120, "velocity of a"),
        (200, 209, 10, "velocity of a: (7, 0) m/s"),
        (210, 219, 10, "velocity of a: (8, 0) m/s"),
        (300, 312, 3, "velocity of a: (9, 0) m/s"),
        (400, 400, 1, "velocity of a: (9, 0) m/s"),
        (407, 407, 1, "velocity of a: (9, 0) m/s"),
        (414, 414, 1, "velocity of a: (9, 0) m/s"),
    ];
    assert_eq!(listed(&events), expected);
    // Two things at a time do not disturb each other.
    let mut events = Events::default();
    for tick in 0..50 {
        velocity(&mut events, tick, tick);
        events.input(tick, "torque on b".to_owned(), format!("torque {tick} N·m on b"));
    }
    assert_eq!(listed(&events), [(0, 49, 50, "velocity of a"), (0, 49, 50, "torque on b")]);
}

#[test]
fn many_events_of_a_group_leave_room_for_the_others() {
    let mut events = Events::default();
    for tick in 0..EVENTS as u64 + 3 {
        events.input(tick, format!("topic {tick}"), "text".to_owned());
        events.add(tick, What::Hit, vec![0, 1], String::new());
        events.add(tick, What::Touched, vec![0, 1], String::new());
    }
    events.tell(99_999, What::Removed, Some(0), String::new());
    events.diverge(99_999, "another hash".to_owned());
    assert_eq!(events.told.len(), 2 * EVENTS + 2);
    assert_eq!(events.untold, [0, EVENTS as u64 + 6, 3]);
    assert_eq!(events.told.last().map(|event| event.what), Some(What::Diverged));
}

#[test]
fn contacts_hits_sensors_and_joints_are_events_with_both_bodies() {
    let mut world = world();
    let floor = Shape::rectangle(fx!(8), fx!(1)).expect("a floor");
    let gate = ColliderDef { sensor: true, ..ColliderDef::new(Shape::rectangle(2, fx!(0.5)).expect("a gate")) };
    let loud = ColliderDef {
        contact_events: true,
        hit_events: true,
        ..ColliderDef::new(Shape::circle(fx!(0.25)).expect("a disc"))
    };
    let bodies = [
        BodyDef::fixed().with_collider(floor),
        BodyDef { position: vec2(0, 3), ..BodyDef::fixed() }.with_collider(gate),
        BodyDef { position: vec2(0, 5), ..BodyDef::dynamic() }.with_collider(loud),
        BodyDef { position: vec2(3, 5), ..BodyDef::dynamic() },
    ];
    let [_, _, ball, lamp] = bodies.map(|def| world.add_body(def).expect("there is room"));
    let wire = JointDef::between(&world, None, vec2(3, 7), lamp, vec2(3, 5)).expect("a wire");
    world.add_joint(JointDef { break_force: Some(fx!(5)), events: true, ..wire }).expect("there is room");
    let mut recording = Recording::new(Budget::default());
    for tick in 0..120 {
        recording.see(&world, None, unnamed);
        if tick == 90 {
            world.remove_body(ball).expect("it is there");
        }
        world.step();
    }
    recording.see(&world, None, unnamed);
    let events: Vec<_> = recording.events.told.iter().map(|event| (event.what, &event.bodies[..])).collect();
    let expected = [
        (What::Broke, &[3][..]),
        (What::Entered, &[2, 1]),
        (What::Left, &[2, 1]),
        (What::Touched, &[0, 2]),
        (What::Hit, &[0, 2]),
        (What::Slept, &[2]),
        (What::Removed, &[2]),
        (What::Parted, &[0, 2]),
    ];
    assert_eq!(events, expected);
    let hit = recording.events.told.iter().find(|event| event.what == What::Hit).expect("a hit");
    // A fall of 4.25 m: 9.2 m/s, and the impulse of its mass with it.
    let speed = hit.text.strip_prefix("at ").and_then(|text| text.split(' ').next()?.parse::<f64>().ok());
    assert!(speed.is_some_and(|speed| (speed - 85f64.sqrt()).abs() < 0.1), "{}", hit.text);
}
