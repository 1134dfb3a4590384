//! Heavy loads on light bodies: islands that take finer sub-steps.

use super::scenes::{def, ground, keeps_its_bits, square, world};
use umbra_physics::{
    BodyDef, BodyId, ColliderDef, ContactHit, ContactSettings, Event, Fx, Locks, Shape, Vec2, World, WorldDef, fx, vec2,
};

/// A square of a metre, of this many kilograms.
fn box_of(kilograms: i32, position: Vec2, key: u64) -> BodyDef {
    let mut def = square(position, key).expect("a square");
    def.colliders[0].density = kilograms.into();
    def
}

/// Boxes on top of each other around x, from below.
fn tower(x: Fx, masses: &[i32]) -> Vec<BodyDef> {
    let place = |k: usize| Vec2::new(x, fx!(0.5) + Fx::from(k as i32));
    masses.iter().enumerate().map(|(k, &mass)| box_of(mass, place(k), 10 * k as u64)).collect()
}

fn on_ground(bodies: impl IntoIterator<Item = BodyDef>) -> Vec<BodyDef> {
    [ground().expect("a ground")].into_iter().chain(bodies).collect()
}

/// The deepest overlap of the present, m.
fn deepest(world: &World) -> Fx {
    let points = world.contacts().flat_map(|contact| contact.points().to_vec());
    points.map(|point| -point.separation).max().unwrap_or(Fx::ZERO)
}

fn bits(world: &World, ids: &[BodyId]) -> Vec<[i128; 6]> {
    let bits_of = |&id: &BodyId| {
        let body = world.body(id).expect("a body");
        let (at, velocity) = (body.position_exact(), body.velocity_exact());
        let [x, y, vx, vy, spin] =
            [at.x, at.y, velocity.x, velocity.y, body.angular_velocity_exact()].map(|word| word.to_bits());
        [x, y, vx, vy, spin, body.angle_exact().to_bits().into()]
    };
    ids.iter().map(bits_of).collect()
}

#[test]
fn light_boxes_carry_a_thousand_times_their_mass() {
    for (masses, max_overlap) in [
        (&[1, 1, 1, 1, 1000][..], fx!(0.05)),
        // No box is much heavier than the one below it.
        (&[1, 10, 100, 1000], fx!(0.03)),
        (&[1, 1, 1, 1, 1, 1, 1, 1, 1, 100], fx!(0.01)),
    ] {
        let (mut world, ids) = world(def(), on_ground(tower(fx!(0), masses))).expect("a scene");
        for tick in 0..600 {
            world.step();
            let overlap = deepest(&world);
            assert!(overlap <= max_overlap, "{masses:?} {tick}: {overlap}");
        }
        for &id in &ids[1..] {
            let body = world.body(id).expect("a box");
            assert_eq!((body.position_exact().x.to_bits(), body.angle_exact().to_bits()), (0, 0), "{masses:?}");
            assert!(body.velocity().length() < fx!(0.001), "{masses:?}");
        }
    }
}

/// A load of 64 times the mass takes the sub-steps of the settings, one of 65 times takes 16; and so does one of 16 kg on 250 g.
#[test]
fn a_load_is_heavy_from_one_mass_on() {
    let sink = |masses: &[i32]| {
        let (mut world, ids) = world(def(), on_ground(tower(fx!(0), masses))).expect("a scene");
        (0..300).for_each(|_| _ = world.step());
        Fx::from(masses.len() as i32) - fx!(0.5) - world.body(ids[masses.len()]).expect("it").position().y
    };
    let [light, heavy] = [64, 65].map(|mass| sink(&[1, mass]));
    assert!(light > fx!(0.005) && heavy < light / 5, "{light} {heavy}");
    // What lies below does not count, nor what floats.
    let floating = |masses: [i32; 2]| {
        let still = WorldDef { gravity: Vec2::ZERO, ..def() };
        let pushed = |substeps| {
            let contacts = ContactSettings { substeps, ..ContactSettings::default() };
            let mut bodies = tower(fx!(0), &masses);
            bodies[0].velocity = vec2(0, 2);
            let (mut world, ids) = world(WorldDef { contacts, ..still }, bodies).expect("a scene");
            (0..30).for_each(|_| _ = world.step());
            bits(&world, &ids)
        };
        pushed(5) == pushed(16)
    };
    assert!(!floating([1, 1000]), "without a ground the settings count");
}

/// Loads beside others: the order of bodies, mirror images and restoring change no bit.
#[test]
fn loads_keep_their_bits() {
    let mut bodies = on_ground(tower(fx!(-4), &[1, 1, 300]));
    bodies.extend(tower(fx!(3), &[2, 2, 2]));
    // One falls on another tower and off again.
    bodies.push(BodyDef { velocity: vec2(4, 0), ..box_of(500, vec2(0, 6), 777) });
    bodies.push(box_of(1, vec2(fx!(0.25), fx!(0.5)), 778));
    let mut deep = Fx::ZERO;
    keeps_its_bits(bodies, (240, 7), |world| deep = deep.max(deepest(world)));
    assert!(deep > fx!(0.005), "{deep}");
}

#[test]
fn a_load_elsewhere_changes_no_bit() {
    let run = |loads: bool| {
        let mut bodies = on_ground(tower(fx!(0), &[1, 2, 3]));
        bodies.push(BodyDef { angular_velocity: fx!(1), ..box_of(1, vec2(fx!(0.25), 5), 500) });
        if loads {
            bodies.extend(tower(fx!(20), &[1, 1, 1000]));
        }
        let (mut world, ids) = world(def(), bodies).expect("a scene");
        (0..200)
            .map(|_| {
                world.step();
                bits(&world, &ids[..5])
            })
            .collect::<Vec<_>>()
    };
    assert!(run(true) == run(false));
}

/// Boxes under one of dominance 1, which lies on a wall: its bits do not depend on them.
#[test]
fn a_body_that_dominates_a_load_keeps_its_bits() {
    let run = |below: &[i32], masses: &[i32]| {
        let mut bodies = on_ground(tower(fx!(0), masses));
        bodies.iter_mut().skip(1).for_each(|def| def.dominance = 1);
        let count = bodies.len();
        // Beside the dominant tower: they lean on it.
        for (k, &mass) in below.iter().enumerate() {
            let at = Vec2::new(fx!(0.9), fx!(0.5) + Fx::from(k as i32));
            bodies.push(BodyDef { velocity: vec2(-1, 0), ..box_of(mass, at, 600 + k as u64) });
        }
        let (mut world, ids) = world(def(), bodies).expect("a scene");
        let mut touched = 0;
        let path: Vec<_> = (0..200)
            .map(|_| {
                world.step();
                let is_below = |id: &BodyId| ids[count..].contains(id);
                let is_own = |id: &BodyId| ids[1..count].contains(id);
                touched += world
                    .contacts()
                    .filter(|contact| contact.bodies.iter().any(is_below) && contact.bodies.iter().any(is_own))
                    .count();
                bits(&world, &ids[..count])
            })
            .collect();
        (path, touched)
    };
    // Heavy loads in neither island, in the dominant one, in the lower one, in both.
    for masses in [&[1, 2][..], &[1, 100]] {
        let (alone, _) = run(&[], masses);
        for below in [&[1, 2][..], &[1, 100]] {
            let (path, touched) = run(below, masses);
            assert!(touched > 10, "{touched}");
            assert!(path == alone, "{masses:?} {below:?}");
        }
    }
}

/// Boxes of dominance 1, and on these others.
fn on_dominant(base: &[i32], top: &[i32]) -> Vec<BodyDef> {
    let mut bodies = tower(fx!(0), base);
    bodies.iter_mut().for_each(|def| def.dominance = 1);
    let height = vec2(0, base.len() as i32);
    bodies.extend(tower(fx!(0), top).into_iter().map(|def| BodyDef { position: def.position + height, ..def }));
    bodies
}

/// Boxes on a dominant tower see where that goes in each sub-step, whichever of the two is under a heavy load.
#[test]
fn boxes_rest_on_a_dominant_tower_whichever_carries_a_load() {
    for (base, top) in [(&[1, 2][..], &[1, 1000][..]), (&[1, 1000], &[1, 2]), (&[1, 1000], &[1, 1000])] {
        let (mut world, ids) = world(def(), on_ground(on_dominant(base, top))).expect("a scene");
        (0..300).for_each(|_| _ = world.step());
        for &id in &ids[1..] {
            let speed = world.body(id).expect("it").velocity().length();
            assert!(speed < fx!(0.001), "{base:?} {top:?}: {speed}");
        }
        let sink = fx!(3.5) - world.body(ids[4]).expect("it").position().y;
        assert!(sink < fx!(0.04), "{base:?} {top:?}: {sink}");
    }
}

/// A dominant pallet lands with a load, which does not go through it.
#[test]
fn a_load_lands_with_the_dominant_pallet_that_it_lies_on() {
    for speed in [2, 4, 8] {
        let bodies = on_dominant(&[1], &[1, 70]).into_iter();
        let bodies =
            bodies.map(|def| BodyDef { position: def.position + vec2(0, 1), velocity: vec2(0, -speed), ..def });
        let (mut world, ids) = world(def(), on_ground(bodies)).expect("a scene");
        let mut deep = Fx::ZERO;
        for _ in 0..300 {
            world.step();
            deep = deep.max(deepest(&world));
        }
        assert!(deep < fx!(0.05), "{speed}: {deep}");
        let load = world.body(ids[3]).expect("it");
        let sink = fx!(2.5) - load.position().y;
        assert!(sink < fx!(0.002) && load.velocity().length() < fx!(0.001), "{speed}: {sink}");
    }
}

/// The settings change while a load lies still: forces stay the same, so nothing jumps.
#[test]
fn other_sub_steps_do_not_move_a_load() {
    let (mut world, ids) = world(def(), on_ground(tower(fx!(0), &[1, 1, 500]))).expect("a scene");
    (0..300).for_each(|_| _ = world.step());
    for substeps in [16, 3, 8, 5] {
        world.set_contact_settings(ContactSettings { substeps, ..ContactSettings::default() }).expect("settings");
        let weight: Fx = world
            .contacts_of(ids[3])
            .expect("it")
            .flat_map(|contact| contact.points().to_vec())
            .fold(Fx::ZERO, |sum, point| sum + point.normal_impulse);
        // 500 kg at 10 m/s² over a sub-step.
        let expected = fx!(5000) / 60 / substeps as i32;
        assert!((weight - expected).abs() < expected / 1000, "{substeps}: {weight} {expected}");
        for _ in 0..120 {
            world.step();
            let speed = world.body(ids[3]).expect("it").velocity().length();
            assert!(speed < fx!(0.001), "{substeps}: {speed}");
        }
    }
}

/// A hit is reported with its own pair and its whole impulse, in whichever part of the contacts it is.
#[test]
fn a_hit_of_a_load_has_its_pair_and_its_impulse() {
    let mut bodies = on_ground(tower(fx!(0), &[1, 1]));
    bodies.extend(tower(fx!(10), &[1]));
    bodies.push(box_of(200, vec2(0, 4), 900));
    bodies.push(box_of(2, vec2(10, 4), 901));
    for def in &mut bodies[4..] {
        def.colliders[0] = ColliderDef { hit_events: true, ..def.colliders[0].clone() };
    }
    let (mut world, ids) = world(def(), bodies).expect("a scene");
    let mut hits = Vec::new();
    for _ in 0..90 {
        let before = [ids[4], ids[5]].map(|id| world.body(id).expect("it").velocity().y);
        for event in world.step() {
            if let Event::ContactHit(hit) = event {
                hits.push((hit, before));
            }
        }
    }
    for (falling, below, slot, mass) in [(ids[4], ids[2], 0, 200), (ids[5], ids[3], 1, 2)] {
        let is_falling = |(hit, _): &&(ContactHit, [Fx; 2])| hit.pair.bodies.contains(&falling);
        let (hit, before) = hits.iter().find(is_falling).expect("a hit");
        assert!(hit.pair.bodies.contains(&below), "{hit:?}");
        // Gravity adds to the speed of the step before up to the touch.
        let (speed, gained) = (hit.approach_speed, hit.approach_speed + before[slot]);
        assert!((fx!(-0.0001)..=Fx::from_ratio(1, 6)).contains(&gained) && speed > fx!(5), "{hit:?} {gained}");
        // The ground is near: at least a light body's share of it.
        assert!(hit.normal_impulse > speed / 2 && hit.normal_impulse < 2 * mass * speed, "{hit:?}");
    }
}

#[test]
fn a_load_sleeps_and_wakes_where_it_lies() {
    let (mut world, ids) =
        world(WorldDef { sleep_after: Some(30), ..def() }, on_ground(tower(fx!(0), &[1, 1, 400]))).expect("a scene");
    let mut fell_asleep = 0;
    for _ in 0..400 {
        fell_asleep += world.step().fell_asleep.len();
    }
    assert_eq!(fell_asleep, 3);
    let asleep = bits(&world, &ids);
    world.wake(ids[1]).expect("it");
    (0..20).for_each(|_| _ = world.step());
    for (before, now) in asleep.iter().zip(bits(&world, &ids)) {
        let moved = (0..2).map(|i| (before[i] - now[i]).unsigned_abs() >> 64).max();
        // In ulps: 0.1 mm.
        assert!(moved < Some(429_497), "{moved:?}");
    }
    assert_eq!(world.contacts().count(), 3);
}

/// A body that is pushed out of another one has no velocity, but moves: it does not fall asleep before it is out.
#[test]
fn a_body_that_is_pushed_out_does_not_sleep_inside() {
    let inside = box_of(1, vec2(0, fx!(-0.75)), 1);
    let (mut world, ids) = world(WorldDef { sleep_after: Some(5), ..def() }, on_ground([inside])).expect("a scene");
    let mut height = fx!(-0.75);
    for tick in 0..600 {
        let report = world.step();
        let fell_asleep = report.fell_asleep.contains(&ids[1]);
        let now = world.body(ids[1]).expect("it").position().y;
        if fell_asleep {
            assert!(now > fx!(0.49), "asleep after {tick} ticks at {now}");
            return;
        }
        height = now;
    }
    panic!("it is awake at {height}");
}

/// A bar that is held in its middle and turned out of the ground moves at its ends alone: it does not fall asleep before it is out.
#[test]
fn a_body_that_is_turned_out_does_not_sleep_inside() {
    let bar = ColliderDef::new(Shape::rectangle(4, fx!(0.5)).expect("a bar"));
    let locks = Locks { x: true, y: true, rotation: false };
    let inside = BodyDef { position: vec2(0, 1), angle: fx!(-0.75), locks, ..BodyDef::dynamic().with_collider(bar) };
    let (mut world, ids) = world(WorldDef { sleep_after: Some(5), ..def() }, on_ground([inside])).expect("a scene");
    for tick in 0..600 {
        let fell_asleep = world.step().fell_asleep.contains(&ids[1]);
        let angle = world.body(ids[1]).expect("it").angle();
        if fell_asleep {
            // The lower corner is 1 − 2·sin φ − ¼·cos φ above the ground: nothing at φ = 0.3947, and 1 cm deep at 0.4.
            let down = fx!(6.283185307) - angle;
            assert!(down < fx!(0.4), "asleep after {tick} ticks, {down} rad downwards");
            return;
        }
    }
    panic!("it is awake");
}
