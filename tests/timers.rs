//! The timers and counters of steps.

use std::time::{Duration, Instant};

use umbra_physics::{BodyDef, FieldKind, Fx, StepCounts, Timers, World, WorldDef, fx, vec2};
use umbra_scene::{Scene, SceneRun};

/// Takes a scene from `scenes` through some steps, and returns its timers.
fn timers(file: &str, steps: u64) -> Timers {
    let scene = scene(file);
    let mut run = scene.start::<Fx>().expect("a fair scene");
    advance(&mut run, steps);
    run.world().timers()
}

fn scene(file: &str) -> Scene {
    let path = format!("{}/scenes/{file}.json", env!("CARGO_MANIFEST_DIR"));
    Scene::parse(&std::fs::read_to_string(path).expect("a scene")).expect("a fair scene")
}

fn advance(run: &mut SceneRun<'_, Fx>, steps: u64) {
    (0..steps).for_each(|_| _ = run.advance().expect("a fair step"));
}

#[test]
fn parts_that_a_scene_lacks_take_no_time() {
    let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() }).expect("fair");
    for _ in 0..1_000 {
        world.add_body(BodyDef::dynamic()).expect("a fair body");
    }
    let steps = |world: &mut World| (0..10).for_each(|_| _ = world.step());
    steps(&mut world);
    let Timers { times, counts, .. } = world.timers();
    assert!(!times.free.is_zero(), "{times:?}");
    assert_eq!(times.sum() - times.survey - times.free - times.finish - times.events, Duration::ZERO, "{times:?}");
    assert_eq!(counts.steps, 10);
    assert_eq!(counts.each().map(|(_, count)| count).sum::<u64>(), 10, "nothing but steps: {counts:?}");
    let drag = FieldKind::Drag { linear: fx!(1), quadratic: fx!(1), wind: vec2(3, 0) };
    world.add_field(drag).expect("a fair field");
    steps(&mut world);
    let Timers { times: later, counts, .. } = world.timers();
    assert!([later.damp, later.kick, later.drift].iter().all(|part| !part.is_zero()), "{later:?}");
    assert_eq!(counts.steps, 20);
    assert_eq!(world.clone().timers(), Timers::default());
}

#[test]
fn the_parts_are_the_whole_step() {
    let scene = scene("pyramid");
    let mut run = scene.start::<Fx>().expect("a fair scene");
    advance(&mut run, 5);
    let mut world = run.into_world();
    // Something else may take the processor between two parts: then another round tells.
    let shares = (0..10).map(|_| {
        let before = world.timers().times.sum();
        let start = Instant::now();
        (0..5).for_each(|_| _ = world.step());
        let whole = start.elapsed();
        let parts = world.timers().times.sum() - before;
        assert!(parts <= whole, "{parts:?} of {whole:?}: a part is in another one");
        parts.as_secs_f64() / whole.as_secs_f64()
    });
    let largest = shares.fold(0.0, f64::max);
    assert!(largest > 0.97, "{largest}");
}

#[test]
fn counts_are_those_of_the_contacts() {
    let scene = scene("pyramid");
    let mut run = scene.start::<Fx>().expect("a fair scene");
    advance(&mut run, 50);
    let before = run.world().timers().counts;
    advance(&mut run, 1);
    let after = run.world().timers().counts;
    let pushing = run.world().contacts().count() as u64;
    assert!(pushing > 50, "{pushing}");
    assert_eq!(after.steps - before.steps, 1);
    let contacts = after.contacts - before.contacts;
    assert!((pushing..=after.pairs - before.pairs).contains(&contacts), "{contacts}, of them {pushing} push");
    assert!((contacts..=2 * contacts).contains(&(after.points - before.points)), "{after:?}");
    assert_eq!(after.islands - before.islands, 1);
    assert_eq!([after.islands_again, after.cut, after.stops], [0; 3]);
}

#[test]
fn each_scene_is_timed_for_what_it_has() {
    let Timers { times, counts, .. } = timers("billiards", 120);
    assert!(counts.impacts > 0 && !times.impacts.is_zero(), "{counts:?}");
    let Timers { times, counts, .. } = timers("pile", 240);
    assert!(counts.islands_again > 0 && !times.again.is_zero() && !times.sweeps.is_zero(), "{times:?}");
    let StepCounts { steps, .. } = timers("pile", 3).counts;
    assert_eq!(steps, 3);
}
