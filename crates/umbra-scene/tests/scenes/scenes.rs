//! The scenes of the repository run, and text that is no scene is refused without harm.

use crate::joints::SLIDING;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::cases::{cases, is_short};
use proptest::prelude::*;
use umbra_physics::scalar::ToF64;
use umbra_physics::{
    Activity, Attachment, BodyDef, BodyId, BodyRef, ColliderDef, Command, FieldKind, ForceField, Fx, Random, Scalar,
    Shape, Vec2, fx, vec2,
};
use umbra_scene::{Scene, SceneAction, SceneErrors, SceneRun};

/// The scenes by name.
pub(crate) fn texts() -> BTreeMap<String, String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let files = fs::read_dir(folder).expect("there are scenes").map(|entry| entry.expect("an entry").path());
    let scenes = files.filter(|path| path.extension().is_some_and(|extension| extension == "json"));
    let named = scenes.map(|path| {
        let name = path.file_stem().and_then(|name| name.to_str()).expect("a name").to_owned();
        (name, fs::read_to_string(path).expect("a scene is text"))
    });
    named.collect()
}

pub(crate) fn scenes() -> BTreeMap<String, Scene> {
    let parse = |(name, text): (String, String)| match Scene::parse(&text) {
        Ok(scene) => (name, scene),
        Err(error) => panic!("{name}: {error}"),
    };
    texts().into_iter().map(parse).collect()
}

fn without_colliders() -> impl Iterator<Item = (String, Scene)> {
    scenes().into_iter().filter(|(_, scene)| scene.bodies.iter().all(|body| body.colliders.is_empty()))
}

/// Runs a scene for so many ticks; the number of faults on the way.
fn run<S: Scalar>(scene: &Scene, ticks: u64) -> (SceneRun<'_, S>, usize) {
    let mut run = scene.start::<S>().unwrap_or_else(|error| panic!("{}: {error}", scene.title));
    let mut faults = 0;
    for _ in 0..ticks {
        match run.advance() {
            Ok(report) => faults += report.faults.len(),
            Err(error) => panic!("{}: {error}", scene.title),
        }
    }
    (run, faults)
}

/// The ticks of a scene by day: all scenes together take seconds.
pub(crate) fn short(scene: &Scene) -> u64 {
    scene.ticks.min(200_000 / (scene.bodies.len() as u64 + 100))
}

#[test]
fn hulls_and_concave_polygons_are_read_as_the_shapes_that_they_make() {
    let text = |shape: &str| {
        format!(r#"{{"bodies": [{{"name": "a", "kind": "static", "colliders": [{{"shape": {shape}}}]}}]}}"#)
    };
    let read = |shape: &str| Scene::parse(&text(shape)).map(|scene| scene.bodies[0].colliders[0].def.shape.clone());
    let hull = read(r#"{"hull": [[0, 0], [2, 0], [1, 0.5], [0, 1], [0, 0]]}"#).expect("a hull");
    assert_eq!(Ok(hull), Shape::polygon(&[vec2(0, 0), vec2(2, 0), vec2(0, 1)]));
    let corners = [vec2(0, 0), vec2(2, 0), vec2(2, 1), vec2(1, 1), vec2(1, 2), vec2(0, 2)];
    let l = "[[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]]";
    let shape = read(&format!(r#"{{"concave_polygon": {l}}}"#)).expect("an L");
    assert_eq!(Ok(shape), Shape::concave_polygon(&corners));
    // Written, they are what they are made of.
    for shape in [format!(r#"{{"concave_polygon": {l}}}"#), r#"{"hull": [[0, 0], [2, 0], [0, 1]]}"#.into()] {
        let scene = Scene::parse(&text(&shape)).expect("a scene");
        let again = Scene::parse(&scene.to_json()).expect("its own text");
        assert_eq!(again.bodies[0].colliders[0].def, scene.bodies[0].colliders[0].def);
    }
    let refused = |shape: &str| read(shape).expect_err("no shape").to_string();
    for (shape, word) in [
        (r#"{"concave_polygon": [[0, 0], [2, 2], [2, 0], [0, 2]]}"#, "segments 0 and 2"),
        (r#"{"hull": [[0, 0], [1, 1], [2, 2]]}"#, "3 to 64 corners"),
        (r#"{"compound": [{"shape": {"concave_polygon": [[0, 0], [2, 0], [0, 2]]}}]}"#, "a part cannot be"),
    ] {
        assert!(refused(shape).contains(word), "{shape}: {}", refused(shape));
    }
}

#[test]
fn each_scene_has_a_title_and_says_what_to_see() {
    let scenes = scenes();
    assert!(scenes.len() >= 30, "{}", scenes.len());
    for (name, scene) in scenes {
        assert!(!scene.title.is_empty(), "{name}");
        assert!(scene.about.len() > 60, "{name}");
        assert!(scene.starting_bodies > 0 && scene.ticks > 0, "{name}");
    }
    let count = |name: &str| Scene::parse(&texts()[name]).map(|scene| scene.bodies.len());
    assert_eq!(count("shots"), Ok(10_000));
    assert_eq!(count("spring-net"), Ok(1_000));
}

#[test]
fn each_runs_without_faults_and_twice_the_same() {
    for (name, scene) in scenes() {
        let ticks = if is_short() { short(&scene) } else { scene.ticks };
        let (first, faults) = run::<Fx>(&scene, ticks);
        assert_eq!(faults, usize::from(name == "too-stiff"), "{name}");
        let quarantined = first.world().bodies().filter(|body| body.activity() == Activity::Quarantined).count();
        assert_eq!(quarantined, faults, "{name}");
        let (second, _) = run::<Fx>(&scene, ticks);
        assert_eq!(first.world().state_hash(), second.world().state_hash(), "{name}");
    }
}

#[test]
fn fixed_point_and_doubles_agree() {
    // Those of bodies that touch have a test of their own.
    for (name, scene) in without_colliders() {
        // The spring beyond its step grows without bound, and so does every difference.
        let ticks = if name == "too-stiff" { 5 } else { short(&scene) };
        let ((fixed, _), (float, _)) = (run::<Fx>(&scene, ticks), run::<f64>(&scene, ticks));
        let mut worst = 0.0f64;
        for (a, b) in fixed.world().bodies().zip(float.world().bodies()) {
            let (p, q) = (a.position(), b.position());
            worst = worst.max((p.x.to_f64() - q.x).abs()).max((p.y.to_f64() - q.y).abs());
        }
        assert!(worst < 2e-6, "{name} after {ticks} ticks: {worst:e} m");
    }
}

#[test]
fn sleepers_sleep_and_wake() {
    let scene = &scenes()["sleepers"];
    let asleep = |run: &SceneRun<'_, Fx>| run.world().bodies().filter(|b| b.activity() == Activity::Asleep).count();
    let (run, _) = run::<Fx>(scene, 60);
    assert_eq!(asleep(&run), 100, "all boxes, before the first is struck");
    let mut run = run;
    assert_eq!(run.advance().map(|report| report.woke.len()), Ok(10));
    assert_eq!(asleep(&run), 90);
}

#[test]
fn the_net_hangs_in_mirrored_bits() {
    let scene = &scenes()["spring-net"];
    let ticks = if is_short() { short(scene) } else { scene.ticks };
    let (run, _) = run::<Fx>(scene, ticks);
    let places: BTreeMap<&str, Vec2> = run.world().bodies().map(|b| (run.name(b.id()), b.position())).collect();
    for i in 0..20 {
        for j in 0..25 {
            let (left, right) = (places[&*format!("n-{i}-{j}")], places[&*format!("n-{}-{j}", 39 - i)]);
            assert_eq!((left.x + right.x, left.y), (fx!(9.75), right.y), "node {i}, {j} at tick {ticks}");
        }
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "the whole run of the scene: in release builds")]
fn in_doubles_nearly_no_node_of_the_net_is_still_an_image() {
    let scene = &scenes()["spring-net"];
    let (run, _) = self::run::<f64>(scene, scene.ticks);
    let places: BTreeMap<&str, Vec2<f64>> = run.world().bodies().map(|b| (run.name(b.id()), b.position())).collect();
    let is_image = |i: usize, j: usize| {
        let (left, right) = (places[&*format!("n-{i}-{j}")], places[&*format!("n-{}-{j}", 39 - i)]);
        (left.x + right.x, left.y) == (9.75, right.y)
    };
    let parted = (0..40).flat_map(|i| (0..25).map(move |j| (i, j))).filter(|&(i, j)| !is_image(i, j)).count();
    assert_eq!((scene.ticks, parted), (2_000, 998));
}

/// Everything the format has, in few bodies.
pub(crate) const RICH: &str = r#"{
  "title": "All of it", "about": "…", "ticks": 20, "time_step": {"num": 1, "den": 120}, "gravity": {"x": 0, "y": -9.81},
  "integrator": "velocity_verlet", "damping": {"linear": {"kept_per_second": 0.9}, "angular": {"kept_per_second": 0.5}}, "sleep_after": null,
  "contacts": {"substeps": 4, "push_speed": 2, "restitution_speed": 0.5, "sleep_speed": 0.25, "hit_speed": 0.5, "max_pairs": 1000, "max_pairs_per_collider": 20},
  "material_pairs": [{"materials": [4294967295, 4294967295], "friction": 0.25, "restitution": 0.5, "rolling_resistance": 0.125}],
  "bodies": [
    {"name": "s", "kind": "static", "colliders": [{"shape": {"segment": [[-5, 0], [5, 0]]}, "category": [], "mask": []}], "position": [0, -3]},
    {"name": "k", "kind": "kinematic", "velocity": [1, 0], "angular_velocity": 2,
     "colliders": [{"shape": {"capsule": {"length": 1, "radius": 0.5}}, "mask": []}, {"name": "hull", "shape": {"polygon": [[0, 0], [1, 0], [0, 1]]}, "position": [1, 0.1], "angle": 0.5, "density": 2,
       "friction": 0.3, "restitution": 0.5, "rolling_resistance": 0.25, "surface_speed": -1.5, "material_id": 4294967295, "friction_rule": "minimum", "restitution_rule": "mean", "category": [1, 31], "mask": [0, 2, 4], "group": -2147483648, "one_way": {"direction": [0.5, -1], "tolerance": 0.25}, "contact_events": true, "hit_events": true, "key": 3, "user_data": 18446744073709551615},
      {"shape": {"segment": [[-1, 0], [1, 0]]}, "sensor": true},
      {"shape": {"rounded_polygon": {"corners": [[0, 0], [1, 0], [0, 1]], "radius": 0.125}}, "position": [-1, 0]},
      {"shape": {"chain": {"points": [[0, 0], [1, 0], [2, 1]]}}}, {"shape": {"chain": {"points": [[0, 0], [1, 0], [0, 1]], "closed": true}}}]},
    {"repeat": {"i": 2, "j": [-1, 1]}, "name": "r-{i}-{j}-{n}", "position": [{"start": 0.1, "i": 0.1, "j": 1e-3}, {"random": [-1, 1], "seed": 7}],
     "velocity": {"length": 3, "angle": {"j": 0.5}}, "mass": 2, "inertia": 0.5, "bullet": true, "max_speeds": {"linear": 50, "angular": 20}, "locks": ["rotation"], "key": {"i": 5}, "user_data": 9, "force_groups": [0, 31],
     "colliders": [{"name": "disc-{n}", "shape": {"circle": {"radius": 0.5}}, "key": {"start": 2, "i": 1, "j": 1}, "mask": [30]}]},
    {"name": "c", "angle": 1, "dominance": -5, "gravity_scale": -1, "damping": {"linear": {"rate": 0.1}, "angular": "none"}, "colliders": [{"density": 3, "mask": [], "shape": {"compound": [
      {"shape": {"polygon": [[0, 0], [1, 0], [0, 1]]}, "position": [1, 0], "angle": 0.5, "density": 2},
      {"shape": {"rectangle": {"width": 1, "height": 2}}}, {"shape": {"circle": {"radius": 0.25}}, "position": [0, 1]}]}}]}
  ],
  "fields": [
    {"name": "sun", "attractor": {"at": [10, 10], "mu": 3.986004418e3, "softening": 0.5}, "force_groups": [0]},
    {"attractor": {"at": {"body": "c", "point": [0, 1]}, "mu": 1}},
    {"spring": {"from": {"body": "c", "point": [0, 1]}, "to": [0, 5], "rest": 1, "stiffness": 10, "damping": 0.5}},
    {"repeat": {"i": [0, 0]}, "spring": {"from": "r-{i}-0-2", "to": "r-{i+1}-0-3", "stiffness": 10}},
    {"drag": {"linear": 0.1, "quadratic": 0.2, "wind": [3, 0]}},
    {"friction": {"deceleration": 0.1, "angular_deceleration": 0.3}},
    {"thrust": {"at": {"body": "c", "point": [1, 0]}, "force": [0, 1]}},
    {"zone": {"disc": {"centre": [0, 0], "radius": 2}, "acceleration": [1, 0]}},
    {"zone": {"box": {"min": [0, 0], "max": [2, 2]}, "acceleration": [1, 0]}},
    {"buoyancy": {"box": {"min": [-50, -50], "max": [50, -20]}, "density": 2, "linear_drag": 0.5, "angular_drag": 0.25, "flow": [1, 0]}}
  ],
  "inputs": [
    {"at": 1, "body": "c", "force": [1, 2], "torque": 3, "impulse": [0.1, 0], "angular_impulse": 0.1, "point": [0, 1], "frame": "body", "wake": false},
    {"from": 2, "to": 10, "every": 3, "body": "c", "force": [1, 2]},
    {"repeat": {"i": 2}, "at": {"start": 3, "i": 2}, "add": {"name": "new-{i}", "position": [{"i": 1}, 9]}},
    {"at": 6, "add_field": {"name": "late", "drag": {"linear": 1}}},
    {"at": 7, "field": "late", "replace": {"drag": {"linear": 2}}},
    {"at": 8, "field": "late", "do": "remove"},
    {"at": 9, "body": "new-0", "do": "remove"},
    {"at": 9, "body": "new-1", "do": "wake"},
    {"at": 10, "set": {"time_step": "1/60", "gravity": [0, 1], "integrator": "yoshida4", "damping": {"linear": {"kept_per_second": 0.5}}, "sleep_after": 9}},
    {"at": 9, "body": "k", "add_collider": {"name": "fin", "shape": {"rectangle": {"width": 1, "height": 0.1}}}},
    {"at": 10, "collider": "fin", "replace": {"shape": {"rectangle": {"width": 2, "height": 0.1}}, "friction": 0}},
    {"at": 10, "collider": "disc-2", "do": "remove", "replace": {"shape": {"circle": {"radius": 1}}}},
    {"at": 10, "set": {"contacts": {"substeps": 8}}},
    {"at": 10, "set": {"material_pair": {"materials": [3, 1], "friction": 2}}},
    {"at": 11, "set": {"material_pair": {"materials": [1, 3], "remove": true}}},
    {"at": 11, "body": "new-1", "set": {"mass": "from_colliders"}},
    {"at": 12, "body": "c", "exclude": "k", "exclude_until_apart": "s"},
    {"at": 13, "body": "k", "allow": "c", "move_to": {"position": [0.1, 0], "angle": 0.5}},
    {"at": 13, "explode": {"position": [0, 1], "impulse": 2, "radius": 5, "falloff": 3, "mask": [30]}},
    {"at": 14, "body": "r-0-0-2", "do": "disable"},
    {"at": 16, "body": "r-0-0-2", "do": "enable"},
    {"at": 10, "do": "clear_forces", "set": {"random": [1, 2, 3, 18446744073709551615], "blob": "00fFa9"}},
    {"at": 10, "set": {"random": 7}},
    {"at": 11, "body": "c", "set": {"kind": "dynamic", "mass": 3, "position": [0, 0], "angle": 0, "velocity": [0, 0], "angular_velocity": 0,
      "gravity_scale": 1, "damping": {}, "dominance": 7, "force_groups": [1], "key": 18446744073709551615, "user_data": 1}}
  ],
  "plot": {"view": [[-9, -9], [9, 9]], "trails": ["c", "k"], "exposures": 3}
}"#;

/// A scene with everything that joints have.
pub(crate) const JOINTED: &str = r#"{
  "ticks": 20, "gravity": [0, -10],
  "bodies": [
    {"name": "post", "kind": "static", "position": [-1, 0]},
    {"repeat": {"i": 4}, "name": "link-{i}", "position": [{"i": 1}, 0], "colliders": [{"shape": {"capsule": {"length": 0.8, "radius": 0.125}}}]},
    {"name": "wheel", "position": [0, -5], "angle": 2, "colliders": [{"shape": {"circle": {"radius": 0.5}}}]}
  ],
  "joints": [
    {"name": "hinge", "bodies": ["post", "link-0"], "point": [-0.5, 0], "revolute": {"limits": [-1, 1.5], "motor": {"speed": 2, "max_force": 20},
      "spring": {"hertz": 2, "damping_ratio": 0.5, "rest": 0.25, "max_force": 9}, "friction": 0.125, "ratchet": -12}},
    {"repeat": {"i": 2}, "name": "weld-{i}", "bodies": ["link-{i}", "link-{i+1}"], "point": [{"start": 0.5, "i": 1}, 0], "weld": {}},
    {"name": "soft", "ends": [{"body": "link-2", "point": [0.5, 0]}, {"body": "link-3", "point": [-0.5, 0]}], "angles": [0.5, -0.25],
      "weld": {"spring": {"hertz": 3}}, "collide_connected": true, "key": 3, "user_data": 18446744073709551615},
    {"name": "rod", "bodies": [null, "wheel"], "points": [[0, -2], [0.25, -5]], "distance": {}, "break_force": 5000, "break_torque": 70, "events": true},
    {"bodies": ["wheel", null], "points": [[0, -5], [3, -9]], "distance": {"length": 4.5}, "enabled": false, "break_force": null}
  ],
  "inputs": [
    {"at": 1, "joint": "hinge", "set": {"motor": null}},
    {"at": 2, "joint": "hinge", "set": {"kind": {"revolute": {"limits": [0, 0]}}, "motor": {"max_force": 3}, "break_force": 100}},
    {"at": 2, "joint": "hinge", "set": {"break_torque": 9}},
    {"at": 3, "joint": "hinge", "set": {"break_torque": null}},
    {"from": 3, "to": 5, "joint": "soft", "do": "disable"},
    {"at": 6, "joint": "soft", "do": "enable", "set": {"break_force": null, "kind": {"distance": {"length": 0.5}}}},
    {"at": 7, "joint": "rod", "do": "remove"},
    {"at": 8, "add_joint": {"name": "late", "ends": ["wheel", [0, -5]], "revolute": {"friction": 2}}},
    {"at": 9, "joint": "late", "set": {"motor": {"speed": -1, "max_force": 5}}}
  ]
}"#;

/// Puts something else in the place of a few characters.
fn mutate(text: &str, at: usize, cut: usize, put: &str) -> String {
    let chars: Vec<char> = text.chars().collect();
    let at = at % chars.len();
    let rest = chars.len().min(at + cut);
    chars[..at].iter().copied().chain(put.chars()).chain(chars[rest..].iter().copied()).collect()
}

/// Parses, and runs what is a scene; the place of what is not.
fn try_out(text: &str) -> Result<(), SceneErrors> {
    let scene = Scene::parse(text)?;
    let mut run = scene.start::<Fx>()?;
    for _ in 0..scene.ticks.min(20) {
        run.advance()?;
    }
    Ok(scene.start::<f32>().map(drop)?)
}

#[test]
fn the_rich_scene_is_one() {
    assert_eq!(try_out(RICH), Ok(()));
    let scene = Scene::parse(RICH).expect("it is one");
    assert_eq!((scene.starting_bodies, scene.bodies.len()), (9, 11));
    let (run, _) = run::<Fx>(&scene, 20);
    assert_eq!(run.world().body_count(), 10, "two were added, one was removed");
    assert_eq!(run.world().fields().count(), 10);
    // Three that touch nothing, five and a fin on the one, six discs of which one was removed.
    assert_eq!(run.world().collider_count(), 14);
    let (world, labels) = (run.world(), run.labels());
    let colliders = world.bodies().flat_map(|body| world.colliders_of(body.id()).expect("it is there"));
    let mut names: Vec<&str> = colliders.filter_map(|collider| labels.collider(collider)).collect();
    names.sort_unstable();
    assert_eq!(names, ["disc-0", "disc-1", "disc-3", "disc-4", "disc-5", "fin", "hull"], "seven have no name");
    assert_eq!(run.world().def().contacts.substeps, 8);
    assert_eq!((run.world().random(), run.world().blob()), (&Random::seeded(7), &[0, 255, 169][..]));
    // 10 steps of 1/120 s and 10 of 1/60.
    let time = run.world().elapsed();
    assert_eq!((time.num, time.den), (1, 4));
}

/// The words that fuzzing puts into scenes are those that the format has.
#[test]
fn the_rich_scenes_have_every_field() {
    let words = include_str!("../../../../fuzz/dictionaries/scene.txt").lines().filter(|line| line.ends_with(":\""));
    let fields: Vec<String> = words.map(|line| line[1..line.len() - 2].replace("\\\"", "\"")).collect();
    assert!(fields.len() > 100, "{}", fields.len());
    let has = |field: &str| [RICH, JOINTED, SLIDING].iter().any(|scene| scene.contains(field));
    let missing: Vec<&String> = fields.iter().filter(|field| !has(field)).collect();
    assert!(missing.is_empty(), "{missing:?}");
}

proptest! {
    #![proptest_config(cases(500))]

    #[test]
    fn arbitrary_text_is_refused_in_one_line(text in "\\PC{0,200}") {
        let is_empty_scene = text.trim() == "{}";
        match Scene::parse(&text) {
            Ok(_) => prop_assert!(is_empty_scene),
            Err(errors) => for error in errors.errors() {
                prop_assert_eq!(error.to_string().lines().count(), 1, "{}", error);
            },
        }
    }

    #[test]
    fn arbitrary_json_like_text_does_no_harm(parts in prop::collection::vec(
        prop::sample::select(vec!["{", "}", "[", "]", ",", ":", "\"", "\\", "1", "-", "e", ".", "null", "true", " ", "\n",
            "\"bodies\"", "\"name\"", "\"fields\"", "\"repeat\"", "\"i\"", "\u{1F600}"]), 0..60)) {
        let _ = Scene::parse(&parts.concat());
    }

    #[test]
    fn a_mutated_scene_does_no_harm(
        rich in prop::sample::select(vec![RICH, JOINTED]),
        changes in prop::collection::vec((0usize..8_000, 0usize..4, prop::sample::select(vec![
            "", "", "-", "0", "1e9", "0.5", "1e-40", "{", "}", "[", "]", "\"", ",", ":", "null", "{i}", "x", "c", "\n",
            "\"mass\": 0,", "99999999999999999999", "\\u0000", "\\n", "\"at\": 0,",
        ])), 1..4),
    ) {
        let text = changes.iter().fold(rich.to_owned(), |text, &(at, cut, put)| mutate(&text, at, cut, put));
        // A text that ends too soon may do so after its last line.
        let lines = text.matches('\n').count() + 1;
        for error in try_out(&text).err().iter().flat_map(SceneErrors::errors) {
            prop_assert!((1..=lines).contains(&error.place.line), "line {} of {lines}", error.place.line);
            prop_assert_eq!(error.to_string().lines().count(), 1, "{}", error);
        }
    }
}

/// A body that turns and is pushed, at 10 ticks a second, in so many steps a tick; in f64, whose sums are all but exact.
fn pushed(inputs: &str, steps: u32) -> (Vec2<f64>, Vec2<f64>) {
    let text = format!(
        r#"{{"time_step": "1/10", "sleep_after": 3, "bodies": [{{"name": "a", "mass": 2, "inertia": 1, "angular_velocity": 5}}], "inputs": [{inputs}]}}"#
    );
    let scene = Scene::parse(&text).expect("a scene");
    let mut run = scene.start_finer::<f64>(steps).expect("it starts");
    for tick in 0..10 {
        assert_eq!(run.tick(), tick);
        run.advance().expect("it goes on");
    }
    let elapsed = run.world().elapsed();
    assert_eq!((elapsed.num, elapsed.den, run.world().tick()), (1, 1, u64::from(10 * steps)));
    let body = run.world().bodies().next().expect("it is there");
    (body.velocity(), body.position())
}

#[test]
fn finer_steps_get_the_inputs_of_a_tick_at_its_moment_and_over_all_of_it() {
    for input in [
        r#"{"at": 3, "body": "a", "impulse": [1, 2]}"#,
        r#"{"at": 3, "body": "a", "set": {"velocity": [1, 2]}}"#,
        r#"{"from": 2, "to": 8, "every": 3, "body": "a", "force": [20, -5]}"#,
        // In the body's frame, which turns by 0.5 rad in a tick: the force does not.
        r#"{"from": 2, "to": 4, "body": "a", "frame": "body", "force": [20, 0]}"#,
    ] {
        let ((v, x), (finer_v, finer_x)) = (pushed(input, 1), pushed(input, 8));
        // Velocity Verlet is exact for constant forces. What rounds: 80 sums of numbers below 16, each to 2^-50.
        let apart = [finer_v.x - v.x, finer_v.y - v.y, finer_x.x - x.x, finer_x.y - x.y].map(f64::abs);
        assert!(apart.iter().all(|apart| *apart < 80.0 / (1u64 << 50) as f64), "{input}: {apart:?}");
        assert!(v != Vec2::default(), "{input}");
    }
}

#[test]
fn steps_that_are_too_fine_are_refused() {
    let scene = Scene::parse(r#"{"time_step": "1/5000"}"#).expect("a scene");
    assert!(scene.start_finer::<Fx>(2).is_ok());
    for steps in [0, 3, u32::MAX] {
        let error = scene.start_finer::<Fx>(steps).expect_err("too fine");
        assert!(error.message.starts_with("the time step must be"), "{steps}: {error}");
    }
}

#[test]
fn a_vector_of_the_greatest_length_fits_or_is_refused() {
    let vector = |length: &str, angle: &str| {
        let text = format!(
            "{{\"inputs\": [{{\"at\": 0, \"set\": {{\n\"gravity\": {{\"length\": {length}, \"angle\": {angle}}}}}}}]}}"
        );
        Scene::parse(&text).expect_err("more than any gravity").to_string()
    };
    // Turned round it is one ulp above the largest number.
    let turned = vector("-2147483648", "3.14159265358979");
    assert!(
        turned.starts_with("2: inputs[0].set.gravity: out of range: a component of the vector is not below 2^31"),
        "{turned}"
    );
    assert!(vector("-2147483648", "0").contains("gravity within"));
}

#[test]
fn a_body_that_an_input_adds_is_added_once() {
    for what in [r#""add": {"name": "b"}"#, r#""add_field": {"drag": {}}"#] {
        let error =
            Scene::parse(&format!(r#"{{"inputs": [{{"from": 0, "to": 9, {what}}}]}}"#)).expect_err("ten of them");
        assert!(error.first().message.contains("added once"), "{error}");
        assert!(Scene::parse(&format!(r#"{{"inputs": [{{"from": 3, "to": 3, {what}}}]}}"#)).is_ok());
    }
}

#[test]
fn options_of_a_force_are_refused_without_a_force() {
    let parse = |with: &str| {
        let text = format!(r#"{{"bodies": [{{"name": "a"}}], "inputs": [{{"at": 0, "body": "a", {with}}}]}}"#);
        Scene::parse(&text)
            .map(drop)
            .map_err(|errors| (errors.first().place.field.clone(), errors.first().message.clone()))
    };
    let any = "needs a `force`, `torque`, `impulse` or `angular_impulse` beside it";
    for (name, with, message) in [
        ("wake", r#""set": {"angle": 1}, "wake": false"#, format!("`wake` {any}")),
        ("frame", r#""do": "wake", "frame": "body""#, format!("`frame` {any}")),
        ("point", r#""torque": 1, "point": [1, 0]"#, "a `point` needs a `force` or an `impulse` beside it".into()),
        ("point", r#""do": "wake", "point": [1, 0]"#, "a `point` needs a `force` or an `impulse` beside it".into()),
    ] {
        assert_eq!(parse(with), Err((format!("inputs[0].{name}"), message)), "{with}");
    }
    for with in [
        r#""force": [1, 0], "point": [1, 0], "frame": "body", "wake": false"#,
        r#""torque": 1, "frame": "body", "wake": false"#,
        r#""impulse": [1, 0], "point": [1, 0]"#,
        r#""angular_impulse": 1, "wake": false, "set": {"angle": 1}"#,
    ] {
        assert_eq!(parse(with), Ok(()), "{with}");
    }
}

#[test]
fn commands_that_add_are_carried_out() {
    let mut scene = Scene::parse(
        r#"{"sleep_after": null, "bodies": [{"name": "a"}, {"name": "b"}], "inputs": [
            {"at": 0, "body": "b", "do": "wake"}, {"at": 1, "body": "b", "do": "wake"}, {"at": 2, "body": "b", "do": "wake"}]}"#,
    )
    .unwrap();
    let disc = Shape::circle(fx!(2)).expect("a shape");
    let [a, b] = [0, 1].map(|index| BodyId::from_parts(index, 0));
    let thrust =
        ForceField::from(FieldKind::Thrust { at: Attachment { body: b, point: Vec2::ZERO }, force: vec2(60, 0) });
    let new = BodyDef::dynamic().with_collider(disc.clone());
    let disc = ColliderDef::ghost(disc);
    let commands = [Command::AddCollider { body: a, def: disc }, Command::AddField(thrust), Command::AddBody(new)];
    for (input, command) in scene.inputs.iter_mut().zip(commands) {
        input.action = SceneAction::Command(command);
    }
    let (run, _) = self::run::<Fx>(&scene, 3);
    let bodies: Vec<_> = run.world().bodies().collect();
    let colliders = |body: &BodyRef<'_>| run.world().colliders_of(body.id()).expect("it is there").count();
    assert_eq!(bodies.iter().map(colliders).collect::<Vec<_>>(), [1, 0, 1]);
    assert_eq!(bodies.iter().map(|body| body.velocity().x > fx!(0)).collect::<Vec<_>>(), [false, true, false]);
    assert_eq!((run.index(bodies[2].id()), run.name(bodies[2].id())), (None, ""));
    assert_eq!(self::run::<f64>(&scene, 3).0.world().colliders().count(), 2);
    // As text the first two are what they were. A body needs a name there.
    let text = scene.to_json();
    assert!(text.contains(r#""add": {"colliders": [{"shape": {"circle": {"radius": 2}}}]}"#), "{text}");
    assert_eq!(Scene::parse(&text).expect_err("no name").first().place.field, "inputs[2].add");
    scene.inputs.pop();
    let again = Scene::parse(&scene.to_json()).expect("it is a scene");
    assert_eq!(self::run::<Fx>(&again, 3).0.world().state_hash(), self::run::<Fx>(&scene, 3).0.world().state_hash());
}

#[test]
fn a_scene_that_was_changed_into_nonsense_is_refused() {
    let scene =
        Scene::parse(r#"{"bodies": [{"name": "b"}], "inputs": [{"at": 1, "body": "b", "do": "wake"}]}"#).unwrap();
    let more = Scene { starting_bodies: 2, ..scene.clone() };
    assert!(more.start::<Fx>().is_err());
    let more = Scene { starting_fields: 1, ..scene.clone() };
    assert!(more.start::<Fx>().is_err());
    for action in [SceneAction::AddBody(99), SceneAction::AddField(99)] {
        let mut changed = scene.clone();
        changed.inputs[0].action = action;
        let mut run = changed.start::<Fx>().expect("nothing is wrong with its start");
        assert!(run.advance().is_ok() && run.advance().is_err());
    }
    let mut changed = scene;
    changed.inputs[0].every = 0;
    assert_eq!([0, 1, 2].map(|tick| changed.inputs[0].is_due(tick)), [false, true, false]);
}

#[test]
fn a_few_lines_that_repeat_a_long_one_are_refused() {
    let corners: Vec<String> = (0..64).map(|i| format!("[{i}, {}]", i * i)).collect();
    let part = format!(r#"{{"shape": {{"polygon": [{}]}}}}"#, corners.join(", "));
    let compound = format!(r#"{{"compound": [{}]}}"#, vec![part; 256].join(", "));
    let body = |count: u32, shape: &str| {
        format!(r#"{{"name": "{{n}}", "repeat": {{"i": {count}}}, "colliders": [{{"shape": {shape}}}]}}"#)
    };
    let refused = |bodies: &[String]| {
        let error = Scene::parse(&format!("{{\"bodies\": [\n{}\n]}}", bodies.join(",\n"))).expect_err("too much");
        let error = error.first();
        assert!(error.message.contains("written out"), "{error}");
        (error.place.line, error.place.field.clone())
    };
    assert_eq!(refused(&[body(1 << 17, &compound)]), (2, "bodies[0].repeat".to_string()));
    // Nor bit by bit: two times 2^25 bytes and a little.
    let long = format!("{{\"circle\":{}{{\"radius\": 1}}}}", " ".repeat(1 << 20));
    let (half, second) = (body(32, &long), body(32, &long).replace("{n}", "other {n}"));
    assert_eq!(refused(&[half, second]), (3, "bodies[1].repeat".to_string()));
}

#[test]
fn thousands_of_inputs_to_a_large_world_are_all_tried() {
    let text = r#"{
        "bodies": [{"name": "b{n}", "repeat": {"i": 8192}}],
        "fields": [{"zone": {"disc": {"centre": [0, 0], "radius": 1}, "acceleration": [1, 0]}, "force_groups": [9],
            "repeat": {"i": 65536}}],
        "inputs": [
            {"at": 5, "body": "b{n}", "do": "remove", "repeat": {"i": 8192}},
            {"at": 7, "body": "b0", "force": [1, 0]}
        ]}"#;
    let error = Scene::parse(text).expect_err("b0 is not there any more");
    assert!(error.first().message.starts_with("at tick 7"), "{error}");
}

#[test]
fn the_example_of_the_document_runs() {
    let document = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/scene.md");
    let document = fs::read_to_string(document).expect("the document of the format");
    let (_, rest) = document.split_once("```json\n").expect("an example");
    let (example, _) = rest.split_once("```").expect("its end");
    let scene = Scene::parse(example).unwrap_or_else(|errors| panic!("{errors}"));
    let mut run = scene.start::<Fx>().expect("a world");
    for _ in 0..scene.ticks {
        let report = run.advance().expect("its inputs are accepted");
        assert!(report.faults.is_empty());
    }
    let position = run.world().bodies().nth(1).expect("the box").position();
    // The rope of 2 m holds it: it stays within what 50 N/m give way under its 9.81 N.
    assert!(position.distance(vec2(0, 5)) < fx!(4), "{position}");
}
