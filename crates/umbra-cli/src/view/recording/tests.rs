//! Recordings: frames, lives, looks and clocks.

use umbra_physics::{BodyDef, FieldKind, Region, TimeStep, WorldDef, fx, vec2};

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
        let mut seen = 0;
        for (frame, hash) in recording.hashes.iter().enumerate() {
            let tick = tick_of(&recording, frame as u64);
            let (at, expected, values) = &states[(tick - 1) as usize];
            assert_eq!((at, expected), (&tick, hash), "{samples}");
            for life in &recording.lives {
                let sample = (frame as u64).checked_sub(life.first).filter(|&index| index < life.track.count());
                let sample = sample.and_then(|index| life.track.samples().nth(index as usize));
                let known = values.get(&life.id).copied();
                assert_eq!(sample, known, "{} at {tick}, {samples}", life.id);
                seen += usize::from(known.is_some());
            }
        }
        assert!(seen > 50);
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
