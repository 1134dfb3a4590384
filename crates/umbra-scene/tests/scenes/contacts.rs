//! The scenes of bodies that touch: each shows what it says.

use std::collections::{BTreeMap, BTreeSet};

use umbra_physics::scalar::ToF64;
use umbra_physics::{BodyKind, BodyRef, Fx, Scalar, fx};
use umbra_scene::{Scene, SceneBody, SceneRun};

use super::scenes::{scenes, short};
use crate::cases::is_short;

/// The scenes of bodies that touch.
const NAMES: [&str; 15] = [
    "arch",
    "belts",
    "billiards",
    "buoyancy",
    "cards",
    "cradle",
    "dominoes",
    "explosion",
    "hopper",
    "marble-run",
    "pile",
    "platforms",
    "pyramid",
    "slope",
    "tower",
];

fn scene(name: &str) -> Scene {
    scenes().remove(name).unwrap_or_else(|| panic!("there is no scene {name}"))
}

/// Makes steps up to a tick.
fn advance<S: Scalar>(run: &mut SceneRun<'_, S>, tick: u64) {
    while run.world().tick() < tick {
        let report = run.advance().expect("its inputs are accepted");
        assert!(report.faults.is_empty(), "{:?}", report.faults);
    }
}

fn start(scene: &Scene) -> SceneRun<'_, Fx> {
    scene.start::<Fx>().expect("it starts")
}

fn body<'a>(run: &'a SceneRun<'_, Fx>, name: &str) -> BodyRef<'a> {
    let body = run.world().bodies().find(|body| run.name(body.id()) == name);
    body.unwrap_or_else(|| panic!("there is no body {name}"))
}

/// Positions by name, m, of the bodies that are not static.
fn places(run: &SceneRun<'_, Fx>) -> BTreeMap<String, [f64; 2]> {
    let moving = run.world().bodies().filter(|body| body.kind() != BodyKind::Static);
    moving.map(|body| (run.name(body.id()).to_owned(), body.position().to_f64())).collect()
}

/// The farthest that a body moved between two looks, m.
fn largest_shift(before: &BTreeMap<String, [f64; 2]>, after: &BTreeMap<String, [f64; 2]>) -> f64 {
    assert_eq!(before.len(), after.len());
    before.iter().map(|(name, [x, y])| (after[name][0] - x).hypot(after[name][1] - y)).fold(0.0, f64::max)
}

/// The largest angle of a body from its upright position, rad.
fn tilt(body: &BodyRef<'_>) -> f64 {
    let angle = body.angle().to_f64();
    angle.min(std::f64::consts::TAU - angle)
}

/// The number of bodies whose mirror image is not there. `axis` is the component that changes its sign: 0 for x, 1 for y.
fn without_image<S: Scalar>(run: &SceneRun<'_, S>, axis: usize) -> usize {
    let state = |body: &BodyRef<'_, S>| {
        let (at, v) = (body.position(), body.velocity());
        [at.x, at.y, v.x, v.y, body.angular_velocity()]
    };
    let moving = run.world().bodies().filter(|body| body.kind() != BodyKind::Static);
    // A number and its opposite as texts: floats have no order, and −0 is 0.
    let text = |[a, b, c, d, e]: [S; 5]| format!("{a:?} {b:?} {c:?} {d:?} {e:?}");
    let plain = |value: S| if value == S::ZERO { S::ZERO } else { value };
    let states: Vec<[S; 5]> = moving.map(|body| state(&body).map(plain)).collect();
    let known: BTreeSet<String> = states.iter().copied().map(text).collect();
    let image = |mut state: [S; 5]| {
        for i in [axis, 2 + axis, 4] {
            state[i] = plain(S::ZERO - state[i]);
        }
        state
    };
    states.into_iter().map(image).filter(|&image| !known.contains(&text(image))).count()
}

#[test]
fn the_scenes_of_bodies_that_touch_are_those_that_are_tested_here() {
    let touches = |body: &SceneBody| body.colliders.iter().any(|collider| collider.def.filter.mask != 0);
    // Those with joints have tests of their own.
    let touching =
        scenes().into_iter().filter(|(_, scene)| scene.joints.is_empty() && scene.bodies.iter().any(touches));
    assert_eq!(touching.map(|(name, _)| name).collect::<Vec<_>>(), NAMES);
}

/// Contacts multiply the difference between two number types, so that piles agree for a while only.
#[test]
fn fixed_point_and_doubles_agree_for_half_a_second() {
    for name in NAMES {
        let scene = scene(name);
        let (mut fixed, mut float) = (start(&scene), scene.start::<f64>().expect("it starts"));
        // Before the charge of the explosion: in doubles, impacts are part of the passes.
        advance(&mut fixed, 30);
        advance(&mut float, 30);
        let pairs = fixed.world().bodies().zip(float.world().bodies());
        let far = pairs.map(|(a, b)| {
            let ([ax, ay], [bx, by]) = (a.position().to_f64(), b.position().to_f64());
            (ax - bx).hypot(ay - by)
        });
        let worst = far.fold(0.0, f64::max);
        // Cards that lean on each other, and a tower that sways.
        let bound = if ["cards", "tower"].contains(&name) { 1e-3 } else { 1e-5 };
        assert!(worst < bound, "{name}: {worst:e} m");
    }
}

#[test]
fn the_pyramid_stands_and_falls_as_its_own_mirror_image() {
    let scene = scene("pyramid");
    let mut run = start(&scene);
    let before = places(&run);
    for tick in [60, 120, 300] {
        advance(&mut run, tick);
        assert_eq!(without_image(&run, 0), 0, "tick {tick}");
    }
    assert_eq!(before.len(), 120);
    let shift = largest_shift(&before, &places(&run));
    assert!(shift < 0.1, "{shift} m");
    let standing = places(&run);
    for tick in [360, 420, scene.ticks] {
        advance(&mut run, tick);
        assert_eq!(without_image(&run, 0), 0, "after the balls, tick {tick}");
    }
    let fallen = places(&run);
    let scattered = standing.iter().filter(|(name, [x, y])| (fallen[*name][0] - x).hypot(fallen[*name][1] - y) > 1.0);
    let scattered = scattered.count();
    assert!(scattered > 40, "{scattered} boxes");
    assert!(fallen.values().all(|[_, y]| *y > 0.0), "all are on the floor or above it");
    // The balls rock to and fro on the ruins, and the column with them.
    advance(&mut run, scene.ticks + 600);
    let top = body(&run, "box-14-0");
    assert_eq!((top.position().x, top.angle()), (fx!(0), fx!(0)));
    assert!(top.position().y > fx!(10) && top.velocity().length() < fx!(0.05), "{top:?}");
}

#[test]
fn two_towers_stand_and_one_falls() {
    let scene = scene("tower");
    let mut run = start(&scene);
    let before = places(&run);
    // At the start the top block is beyond the lowest one, in both.
    let over = |name: &str| before[&format!("{name}-4")][0] - before[&format!("{name}-0")][0];
    assert!(over("leaning") > 4.0 && over("falling") > over("leaning"), "{} {}", over("leaning"), over("falling"));
    advance(&mut run, scene.ticks);
    for k in 0..15 {
        let box_ = body(&run, &format!("straight-{k}"));
        assert_eq!((box_.position().x, box_.angle(), box_.velocity().x), (fx!(-8), fx!(0), fx!(0)), "{k}");
    }
    let after = places(&run);
    let shift = |name: &str| {
        let places_of = |places: &BTreeMap<String, [f64; 2]>| {
            places.iter().filter(|(known, _)| known.starts_with(name)).map(|(k, v)| (k.clone(), *v)).collect()
        };
        largest_shift(&places_of(&before), &places_of(&after))
    };
    assert!(shift("straight") < 0.1, "{} m", shift("straight"));
    assert!(shift("leaning") < 0.1, "{} m", shift("leaning"));
    assert!(after["falling-4"][1] < 2.5, "{:?}", after["falling-4"]);
}

#[test]
fn the_house_of_cards_stands_until_a_card_is_struck() {
    let scene = scene("cards");
    let mut run = start(&scene);
    let before = places(&run);
    advance(&mut run, 600);
    assert_eq!(without_image(&run, 0), 0);
    let shift = largest_shift(&before, &places(&run));
    assert!(shift < 0.1, "{shift} m");
    advance(&mut run, scene.ticks);
    let top = |places: &BTreeMap<String, [f64; 2]>| places.values().map(|[_, y]| *y).fold(0.0, f64::max);
    let (was, is) = (top(&before), top(&places(&run)));
    assert!(was > 5.0 && is < was / 4.0, "from {was} m to {is} m");
}

#[test]
fn the_dominoes_fall_one_after_the_other() {
    let scene = scene("dominoes");
    let mut run = start(&scene);
    advance(&mut run, 30);
    assert!(run.world().bodies().all(|body| tilt(&body) < 1e-6), "they stand before the push");
    let mut fell = Vec::new();
    while fell.len() < 40 && run.world().tick() < scene.ticks {
        let tick = run.world().tick();
        advance(&mut run, tick + 1);
        let next = body(&run, &format!("domino-{}", fell.len()));
        if tilt(&next) > 0.2 {
            fell.push(run.world().tick());
        }
    }
    assert_eq!(fell.len(), 40, "{fell:?}");
    // The wave runs at one speed: a domino each 0.19 s, to a tick.
    for pair in fell[10..].windows(2) {
        assert!((11..=12).contains(&(pair[1] - pair[0])), "{fell:?}");
    }
    advance(&mut run, scene.ticks);
    for k in 0..40 {
        let domino = body(&run, &format!("domino-{k}"));
        assert!(tilt(&domino) > 1.2, "{k}: {} rad", tilt(&domino));
    }
}

#[test]
fn the_arch_stands_until_a_stone_is_taken_out() {
    let scene = scene("arch");
    let mut run = start(&scene);
    let before = places(&run);
    advance(&mut run, 300);
    assert_eq!((before.len(), without_image(&run, 0)), (15, 0));
    let shift = largest_shift(&before, &places(&run));
    assert!(shift < 0.02, "{shift} m");
    advance(&mut run, scene.ticks);
    let keystone = body(&run, "keystone").position();
    assert!(keystone.y < fx!(1), "{keystone}");
}

#[test]
fn on_the_slope_two_boxes_hold_and_two_slide() {
    let scene = scene("slope");
    let mut run = start(&scene);
    let before = places(&run);
    advance(&mut run, scene.ticks);
    let after = places(&run);
    let moved = |name: &str| {
        let ([ax, ay], [bx, by]) = (before[name], after[name]);
        (bx - ax).hypot(by - ay)
    };
    for name in ["rough", "holds"] {
        assert!(moved(name) < 1e-3, "{name}: {} m", moved(name));
    }
    // The acceleration is g·(sin − μ·cos), here on a slope of 1 in 2; from 1 s on, when the boxes have settled.
    let mut early = start(&scene);
    advance(&mut early, 60);
    let seconds = (scene.ticks - 60) as f64 / 60.0;
    for (name, mu) in [("slides", 0.495), ("smooth", 0.4)] {
        let speed = |run: &SceneRun<'_, Fx>| body(run, name).velocity().length().to_f64();
        let (measured, law) = ((speed(&run) - speed(&early)) / seconds, 9.81 * (1.0 - 2.0 * mu) / 5f64.sqrt());
        assert!((measured / law - 1.0).abs() < 1e-3, "{name}: {measured} m/s², by the law {law} m/s²");
    }
}

#[test]
fn the_billiard_break_stays_symmetric_to_the_bit() {
    let scene = scene("billiards");
    let mut run = start(&scene);
    let before = places(&run);
    for tick in 1..=scene.ticks {
        advance(&mut run, tick);
        assert_eq!(without_image(&run, 1), 0, "tick {tick}");
    }
    let after = places(&run);
    let far = before.iter().filter(|(name, [x, y])| (after[*name][0] - x).hypot(after[*name][1] - y) > 1.0);
    assert!(far.count() >= 15);
}

/// Rails give back what the coefficients say at any speed: a ball that reaches one slowly does not stick to it and slide along.
#[test]
fn the_rails_of_the_billiard_table_give_slow_balls_back() {
    let table = include_str!("../../../../scenes/billiards.json");
    let cue = r#""position": [-12, 0], "velocity": [30, 0]"#;
    assert!(table.contains(cue));
    for speed in [0.3, 0.9, 1.0, 1.1, 5.0] {
        // A tenth of a second away from the rail on the left, whose restitution is the lower one.
        let aimed = format!(r#""position": [{}, 0], "velocity": [-{speed}, 0.2]"#, -21.5 + speed / 10.0);
        let scene = Scene::parse(&table.replace(cue, &aimed)).expect("a scene");
        let mut run = start(&scene);
        let mut before = -speed;
        let after = loop {
            let tick = run.world().tick() + 1;
            assert!(tick < 20, "{speed} m/s: it is still at the rail");
            advance(&mut run, tick);
            match body(&run, "cue").velocity().to_f64()[0] {
                velocity if velocity > 0.0 => break velocity,
                velocity => before = velocity,
            }
        };
        // The cloth takes 0.5 m/s in a second. Over the tick of the bounce it acts as on a ball that goes straight on, into the rail.
        let lost = -0.95 * before - after;
        assert!(lost.abs() <= 0.5 / 60.0, "{speed} m/s: {after} after {before} m/s");
    }
}

#[test]
fn the_cradle_passes_the_swing_on() {
    let scene = scene("cradle");
    let mut run = start(&scene);
    let before = places(&run);
    let height = before["disc-0"][1];
    let mut tops = BTreeMap::<String, f64>::new();
    // The first swing to the right: until the last disc is back.
    for tick in 1..=1_400 {
        advance(&mut run, tick);
        for (name, [x, y]) in places(&run) {
            if tick > 520 {
                let top = tops.entry(name.clone()).or_default();
                *top = top.max(y);
                if name != "disc-0" && name != "disc-4" {
                    assert!((x - before[&name][0]).abs() < 0.1, "tick {tick}: {name} at {x}");
                }
            }
        }
    }
    assert!(tops["disc-4"] > 0.98 * height && tops["disc-4"] <= height, "{} of {height} m", tops["disc-4"]);
    assert!(["disc-0", "disc-1", "disc-2", "disc-3"].iter().all(|name| tops[*name] < 0.01), "{tops:?}");
}

#[test]
fn the_hopper_runs_and_stays_symmetric_to_the_bit() {
    let scene = scene("hopper");
    let mut run = start(&scene);
    assert_eq!(places(&run).len(), 2_000);
    advance(&mut run, short(&scene).min(60));
    assert_eq!(without_image(&run, 0), 0);
    if is_short() {
        return;
    }
    let mut before = 0;
    for tick in (150..=scene.ticks).step_by(150) {
        advance(&mut run, tick);
        assert_eq!(without_image(&run, 0), 0, "tick {tick}");
        let through = places(&run).values().filter(|[_, y]| *y < 10.0).count();
        assert!(through > before, "tick {tick}: {through} after {before}");
        before = through;
    }
    let inside = places(&run).values().filter(|[x, y]| x.abs() < 21.0 && *y > 0.0).count();
    assert!(before > 600 && inside == 2_000, "{before} went through, {inside} are within the walls");
}

#[test]
fn the_pile_is_symmetric_to_the_bit_and_in_doubles_is_not() {
    let scene = scene("pile");
    let mut run = start(&scene);
    for tick in (10..=scene.ticks).step_by(10) {
        advance(&mut run, tick);
        assert_eq!(without_image(&run, 0), 0, "tick {tick}");
    }
    let within = places(&run).values().filter(|[x, y]| x.abs() < 12.0 && *y > 0.0 && *y < 10.0).count();
    assert_eq!(within, 140);
    let mut float = scene.start::<f64>().expect("it starts");
    advance(&mut float, 60);
    assert!(without_image(&float, 0) > 20, "{} of 140", without_image(&float, 0));
}

/// Each ball lands on the highest platform that its bottom gets above, by its speed; two drop by one of them.
#[test]
fn balls_land_on_the_platforms_that_they_get_above() {
    let scene = scene("platforms");
    let mut run = start(&scene);
    let tops = [0.0, 2.125, 4.125, 6.125];
    let level = |i: usize| {
        let speed = 6.0 + 0.55 * i as f64;
        tops.iter().rposition(|&top| speed * speed / (2.0 * 9.81) > top).unwrap_or(0)
    };
    assert_eq!([0, 1, 6, 11].map(level), [0, 1, 2, 3]);
    advance(&mut run, 299);
    let rests = |run: &SceneRun<'_, Fx>, i: usize, level: usize| {
        let [x, y] = body(run, &format!("ball-{i}")).position().to_f64();
        assert!((x - (i as f64 - 5.5)).abs() < 1e-6 && (y - tops[level] - 0.3).abs() < 0.005, "{i}: {x} {y}");
    };
    (0..12).for_each(|i| rests(&run, i, level(i)));
    advance(&mut run, 480);
    (0..12).for_each(|i| rests(&run, i, level(i).min(if i < 10 { 3 } else { 2 })));
}

/// Rough boxes ride up, go over to the next belts and come back; smooth ones slide down.
#[test]
fn belts_hand_boxes_over_and_smooth_boxes_slide_down() {
    let scene = scene("belts");
    let mut run = start(&scene);
    advance(&mut run, 60);
    let along = |run: &SceneRun<'_, Fx>, name: &str| {
        let [x, y] = body(run, name).velocity().to_f64();
        x * 0.3_f64.cos() + y * 0.3_f64.sin()
    };
    assert!((along(&run, "rough-2") - 2.0).abs() < 0.01);
    // −g·(sin 0.3 − 0.2·cos 0.3) for the whole second.
    let slides = -9.81 * (0.3_f64.sin() - 0.2 * 0.3_f64.cos());
    assert!((along(&run, "smooth-1") - slides).abs() < 0.01, "{}", along(&run, "smooth-1"));
    let mut farthest = [0.0_f64; 4];
    for tick in 61..=1500 {
        advance(&mut run, tick);
        for (i, max_x) in farthest.iter_mut().enumerate() {
            *max_x = max_x.max(body(&run, &format!("rough-{}", i + 1)).position().x.to_f64());
        }
    }
    for (i, max_x) in farthest.into_iter().enumerate() {
        // On the floor or on a box that lies there, at the end of the last belt; a box that tumbles over another may lie
        // below the belt.
        let [x, y] = body(&run, &format!("rough-{}", i + 1)).position().to_f64();
        assert!(max_x > 14.0 && x < 4.5 && y < -2.0, "rough-{}: {max_x} {x} {y}", i + 1);
    }
    assert!(["smooth-1", "smooth-2"].iter().all(|name| body(&run, name).position().x < fx!(-6)));
}

/// All marbles end up in the basket, and those that start higher land farther away.
#[test]
fn marbles_fly_from_the_track_into_the_basket() {
    let scene = scene("marble-run");
    let mut run = start(&scene);
    let mut landings = BTreeMap::new();
    for tick in 1..=scene.ticks {
        advance(&mut run, tick);
        for (name, [x, y]) in places(&run) {
            // No bump on the way: a marble is 0.2 m from the track, which is steeper above.
            let surface = 2.0 + 8.0 * (1.0 - x / 18.0).powi(2);
            assert!(x > 19.7 || y - surface < 0.32, "{name} at {x}, {y}");
            if y < -2.7 {
                landings.entry(name).or_insert(x);
            }
        }
    }
    let landings: Vec<f64> = landings.into_values().collect();
    assert!(landings.len() == 8 && landings[0] > landings[7] + 1.0, "{landings:?}");
    for (name, [x, y]) in places(&run) {
        assert!(25.0 < x && x < 36.0 && -3.0 < y && y < 0.0, "{name} at {x}, {y}");
    }
}

/// Each box floats as deep as its density says, what is heavier sinks, and all sleep in the end.
#[test]
fn boxes_float_as_deep_as_they_are_heavy_and_fall_asleep() {
    let scene = scene("buoyancy");
    let mut run = start(&scene);
    advance(&mut run, scene.ticks);
    let height = |name: &str| body(&run, name).position().y.to_f64();
    for (name, share) in [("share-2", 0.2), ("share-4", 0.4), ("share-6", 0.6), ("share-8", 0.8)] {
        // Asleep they are within what 0.05 m/s for half a second make.
        assert!((height(name) - (0.5 - share)).abs() < 0.03, "{name}: {}", height(name));
        assert!(tilt(&body(&run, name)) < 0.02, "{name}");
    }
    assert!((height("anchor") + 4.5).abs() < 0.02, "{}", height("anchor"));
    assert!(height("plank").abs() < 0.03 && tilt(&body(&run, "plank")) < 0.05);
    assert!(height("disc").abs() < 0.03, "{}", height("disc"));
    // 6 m² of 0.25 kg/m² and 1.5 kg on 6 m: half of it is under water.
    assert!(height("raft").abs() < 0.05 && (height("crate") - height("raft") - 1.0).abs() < 0.02);
    let moving = run.world().bodies().filter(|body| body.kind() == umbra_physics::BodyKind::Dynamic);
    assert!(moving.clone().all(|body| body.activity() == umbra_physics::Activity::Asleep));
    assert_eq!(moving.count(), 9);
}

/// The charge throws the plate up and the walls apart, and does not reach the posts.
#[test]
fn the_explosion_stays_symmetric_to_the_bit_and_spares_the_posts() {
    let scene = scene("explosion");
    let mut run = start(&scene);
    advance(&mut run, 30);
    let before = places(&run);
    advance(&mut run, 31);
    assert!(body(&run, "plate").velocity().y > fx!(5));
    assert!(body(&run, "left-1-0").velocity().x < fx!(-1));
    // Nothing that flies is there yet.
    let posts = ["post-left", "post-right"].map(|name| body(&run, name).velocity().to_f64());
    assert!(posts.as_flattened().iter().all(|part| part.abs() < 0.01), "{posts:?}");
    let mut highest = 0.0_f64;
    for tick in 32..=scene.ticks {
        advance(&mut run, tick);
        highest = highest.max(body(&run, "plate").position().y.to_f64());
        if tick % 60 == 0 {
            assert_eq!(without_image(&run, 0), 0, "tick {tick}");
        }
    }
    let after = places(&run);
    assert!(highest > 2.0, "{highest}");
    let moved = |name: &str| (after[name][0] - before[name][0]).hypot(after[name][1] - before[name][1]);
    let thrown = before.keys().filter(|name| name.starts_with("left") && moved(name) > 1.0).count();
    assert!(thrown >= 4, "{thrown} of 8 boxes");
}
