//! The errors of a text: all at once, each at its place, with what would be right.

use umbra_physics::Fx;
use umbra_scene::{Scene, SceneErrors};

fn errors(text: &str) -> SceneErrors {
    Scene::parse(text).expect_err("it is no scene")
}

/// Each error as a line, with its number.
pub(crate) fn lines(text: &str) -> Vec<String> {
    errors(text).errors().iter().map(|error| format!("{error} [E{}]", error.code())).collect()
}

#[test]
fn all_errors_of_a_text_are_reported_by_line() {
    let text = r#"{
"gravity": -9.81,
"time_step": "1/0",
"bodies": [
  {"name": "ball", "colliders": [{"shape": {"circle": {"raduis": 0.1}}}]},
  {"nmae": "box", "type": "static", "friction": 0.5, "shape": {"circle": {"radius": 1}}},
  {"name": "crate", "colliders": [{"shape": {"box": {"width": 1}}}], "mass": 0, "kind": "dynmic"},
  {"name": "ball", "position": [0], "max_speeds": {"liner": 1}}
],
"fields": [{"spring": {"from": "bal", "to": {"x": 1}, "stifness": 3}}],
"inputs": [
  {"at": 1, "body": "crate", "force": [0, "x"], "torque": 1e99},
  {"at": 1, "body": "cradle", "impulse": [1, 0]},
  {"at": 1, "body": "ball", "do": "jump"}
],
"plot": {"trials": "none"}
}"#;
    let expected = [
        "2: gravity: expected [x, y] or {\"x\": …, \"y\": …}, found a number [E502]",
        "3: time_step: the time step must be num/den seconds, from 1 to 10,000 steps a second [E104]",
        "5: bodies[0].colliders[0].shape.circle.raduis: unknown field: did you mean `radius`? [E503]",
        "6: bodies[1].nmae: unknown field: did you mean `name`? [E503]",
        "6: bodies[1].type: unknown field: did you mean `kind`? [E503]",
        "6: bodies[1].friction: unknown field: give it to a collider, in the list `colliders` of a body [E503]",
        "6: bodies[1].shape: unknown field: give it to a collider, `\"colliders\": [{\"shape\": …}]`; one with `\"mask\": []` touches nothing [E503]",
        "7: bodies[2].kind: expected one of static, kinematic, dynamic, found \"dynmic\": did you mean `dynamic`? [E502]",
        "7: bodies[2].colliders[0].shape.box: unknown field: did you mean `rectangle`? [E503]",
        "8: bodies[3].max_speeds.liner: unknown field: did you mean `linear`? [E503]",
        "8: bodies[3].position: expected a list of 2 values, found 1 [E502]",
        "10: fields[0].spring.to: the field `y` is missing [E505]",
        "10: fields[0].spring.stifness: unknown field: did you mean `stiffness`? [E503]",
        "12: inputs[0].force[1]: expected a number, found a text [E502]",
        "12: inputs[0].torque: out of range: expected a number from -2^31 to below 2^31 [E713]",
        "14: inputs[2].do: expected one of remove, release, wake, sleep, disable, enable, found \"jump\" [E502]",
        "16: plot.trials: unknown field: did you mean `trails`? [E503]",
    ];
    let actual = lines(text);
    assert_eq!(actual, expected, "{actual:#?}");
}

#[test]
fn a_name_that_nothing_has_is_told_the_nearest_one() {
    let text = r#"{"bodies": [{"name": "ball"}, {"name": "bell"}],
"fields": [{"name": "wind", "drag": {}}, {"thrust": {"at": "bal", "force": [1, 0]}}],
"inputs": [{"at": 1, "field": "wnid", "do": "remove"}, {"at": 1, "body": "x", "do": "wake"}]}"#;
    let expected = [
        "2: fields[1].thrust.at: there is no body \"bal\": did you mean \"ball\"? [E507]",
        "3: inputs[0].field: there is no force field \"wnid\": did you mean \"wind\"? [E507]",
        "3: inputs[1].body: there is no body \"x\" [E507]",
    ];
    assert_eq!(lines(text), expected);
}

#[test]
fn every_mistake_in_a_collider_is_told_at_its_field() {
    let text = r#"{"contacts": {"substeps": 17, "sleep_speed": -1, "restitution_speed": 2000, "max_pair": 3},
"bodies": [{"name": "a", "colliders": [
  {"name": "hull", "friction": 0.5},
  {"shape": {"compound": [{"shape": {"circle": {"radius": 1}}}]}, "friction": -1},
  {"shape": {"circle": {"radius": 1}}, "position": [5000, 0]},
  {"shape": {"circle": {"radius": 1}}, "density": -1},
  {"shape": {"circle": {"radius": 1}}, "friction": 33},
  {"shape": {"circle": {"radius": 1}}, "restitution": 1.5},
  {"shape": {"circle": {"radius": 1}}, "mask": [-1]},
  {"shape": {"circle": {"radius": 1}}, "category": [32]},
  {"shape": {"circle": {"radius": 1}}, "bounciness": 1},
  {"shape": {"circle": {"radius": 1}}, "group": 0.5}]},
 {"name": "b", "colliders": [{"name": "c", "shape": {"circle": {"radius": 1}}},
  {"name": "c", "shape": {"circle": {"radius": 1}}}]},
 {"name": "d", "colliders": [{"shape": {"circle": {"radius": 1}}, "density": 0}]}],
"inputs": [
  {"at": 1, "collider": "hul", "do": "remove"},
  {"from": 1, "to": 2, "body": "b", "add_collider": {"shape": {"circle": {"radius": 1}}}},
  {"at": 1, "body": "b", "add_collider": {"shape": {"circle": {"radius": 0}}}},
  {"at": 1, "set": {"contacts": {"substeps": 0}}}]}"#;
    let expected = [
        "1: contacts.substeps: out of range: expected a number of sub-steps from 1 to 16 [E101]",
        "1: contacts.restitution_speed: out of range: expected a push, restitution, sleep or hit speed from 0 to 2^10 m/s [E101]",
        "1: contacts.sleep_speed: out of range: expected a push, restitution, sleep or hit speed from 0 to 2^10 m/s [E101]",
        "1: contacts.max_pair: unknown field: did you mean `max_pairs`? [E503]",
        "3: bodies[0].colliders[0]: the field `shape` is missing [E505]",
        "4: bodies[0].colliders[1].friction: out of range: expected a coefficient of friction from 0 to 32 [E101]",
        "5: bodies[0].colliders[2].position: out of range: expected a position of a collider within ±2^12 m of its body's centre of mass [E101]",
        "6: bodies[0].colliders[3].density: out of range: expected a density of at least zero, not -1 [E101]",
        "7: bodies[0].colliders[4].friction: out of range: expected a coefficient of friction from 0 to 32 [E101]",
        "8: bodies[0].colliders[5].restitution: out of range: expected a coefficient of restitution from 0 to 1 [E101]",
        "9: bodies[0].colliders[6].mask[0]: out of range: expected a category from 0 to 31 [E508]",
        "10: bodies[0].colliders[7].category[0]: out of range: expected a category from 0 to 31 [E508]",
        "11: bodies[0].colliders[8].bounciness: unknown field: did you mean `restitution`? [E503]",
        "12: bodies[0].colliders[9].group: out of range: expected a whole number that fits in 32 bits [E508]",
    ];
    let actual = lines(text);
    assert_eq!(actual[..expected.len()], expected, "{actual:#?}");
    let rest = [
        "14: bodies[1].colliders[1].name: there is a collider \"c\" already: choose another name [E506]",
        "15: bodies[2].colliders: out of range: expected a mass from 2^-16 to 2^24 kg, not 0 [E101]",
    ];
    assert_eq!(actual[expected.len()..expected.len() + 2], rest, "{actual:#?}");
    assert!(
        actual[expected.len() + 2].starts_with("17: inputs[0].collider: there is no collider \"hul\": did you mean")
    );
    assert!(
        actual[expected.len() + 3]
            .starts_with("18: inputs[1].add_collider: out of range: a body, field, joint or collider")
    );
    assert!(actual[expected.len() + 4].starts_with("19: inputs[2].add_collider.shape.circle.radius: out of range"));
    assert!(actual[expected.len() + 5].starts_with("20: inputs[3].set.contacts.substeps: out of range"));
    assert_eq!(actual.len(), expected.len() + 6);
}

#[test]
fn every_mistake_in_a_fluid_is_told_at_its_field() {
    let fluid = |rest: &str| format!("{{\"buoyancy\": {{{rest}}}}}");
    let fields = [
        fluid(r#""density": 1"#),
        fluid(r#""box": {"min": [0, 0], "max": [1, 1]}"#),
        fluid(r#""box": {"min": [0, 0]}, "density": 1"#),
        fluid(r#""box": {"min": [0, 0], "max": [1, -1]}, "density": 1"#),
        fluid(r#""box": {"min": [0, 0], "max": [2000000000, 1]}, "density": 1"#),
        fluid(r#""box": {"min": [0, 0], "max": [1, 1]}, "density": -1"#),
        fluid(r#""box": {"min": [0, 0], "max": [1, 1]}, "density": 1, "linear_drag": -1"#),
        fluid(r#""box": {"min": [0, 0], "max": [1, 1]}, "density": 1, "angular_drag": "much""#),
        fluid(r#""box": {"min": [0, 0], "max": [1, 1]}, "density": 1, "flow": [2000000, 0]"#),
        fluid(r#""box": {"min": [0, 0], "max": [1, 1]}, "density": 1, "flows": [1, 0]"#),
    ];
    let expected = [
        "2: fields[0].buoyancy: the field `box` is missing [E505]",
        "2: fields[0].buoyancy: the field `density` is missing [E505]",
        "2: fields[0].buoyancy.box: the field `max` is missing [E505]",
        "2: fields[0].buoyancy.box: out of range: expected a box of a fluid within ±2^30 m whose least corner is not beyond the greatest one [E101]",
        "2: fields[0].buoyancy.box: out of range: expected a box of a fluid within ±2^30 m whose least corner is not beyond the greatest one [E101]",
        "2: fields[0].buoyancy.density: out of range: expected a density of at least zero, not -1 [E101]",
        "2: fields[0].buoyancy.linear_drag: out of range: expected a coefficient of at least zero [E101]",
        "2: fields[0].buoyancy.angular_drag: expected a number, found a text [E502]",
        "2: fields[0].buoyancy.flow: out of range: expected a velocity within ±2^20 m/s a component [E101]",
        "2: fields[0].buoyancy.flows: unknown field: did you mean `flow`? [E503]",
    ];
    assert_eq!(told_alone("fields", &fields), expected);
}

/// The mistake in each entry, alone in a list of a scene on the second line.
pub(crate) fn told_alone(list: &str, entries: &[String]) -> Vec<String> {
    let alone = entries.iter().map(|entry| {
        let told = lines(&format!("{{\"{list}\": [\n{entry}]}}"));
        assert_eq!(told.len(), 1, "{told:#?}");
        told[0].clone()
    });
    alone.collect()
}

#[test]
fn every_mistake_in_an_explosion_is_told_at_its_field() {
    let explosion = |rest: &str| format!("{{\"at\": 1, \"explode\": {{{rest}}}}}");
    let inputs = [
        explosion(r#""impulse": 1"#),
        explosion(r#""position": [0, 0]"#),
        explosion(r#""position": [2000000000, 0], "impulse": 1"#),
        explosion(r#""position": [0, 0], "impulse": 65537"#),
        explosion(r#""position": [0, 0], "impulse": 1, "radius": -1"#),
        explosion(r#""position": [0, 0], "impulse": 1, "falloff": 4097"#),
        explosion(r#""position": [0, 0], "impulse": 1, "mask": [32]"#),
        explosion(r#""position": [0, 0], "impulse": 1, "fallof": 1"#),
        explosion(r#""position": [0, 0], "impulse": "big""#),
    ];
    let radius = "out of range: expected a radius or a falloff of an explosion from 0 to 2^12 m [E101]";
    let expected = [
        "2: inputs[0].explode: the field `position` is missing [E505]".into(),
        "2: inputs[0].explode: the field `impulse` is missing [E505]".into(),
        "2: inputs[0].explode.position: out of range: expected a position within ±2^30 m [E101]".into(),
        "2: inputs[0].explode.impulse: out of range: expected an impulse of an explosion within ±2^16 N·s/m [E101]"
            .into(),
        format!("2: inputs[0].explode.radius: {radius}"),
        format!("2: inputs[0].explode.falloff: {radius}"),
        "2: inputs[0].explode.mask[0]: out of range: expected a category from 0 to 31 [E508]".into(),
        "2: inputs[0].explode.fallof: unknown field: did you mean `falloff`? [E503]".into(),
        "2: inputs[0].explode.impulse: expected a number, found a text [E502]".into(),
    ];
    assert_eq!(told_alone("inputs", &inputs), expected);
}

#[test]
fn every_mistake_in_a_surface_is_told_at_its_field() {
    let text = r#"{"bodies": [{"name": "a", "colliders": [
  {"shape": {"circle": {"radius": 1}}, "surface_speed": 1025},
  {"shape": {"circle": {"radius": 1}}, "tangent_speed": 1},
  {"shape": {"circle": {"radius": 1}}, "friction_rule": "average"},
  {"shape": {"circle": {"radius": 1}}, "rolling_resistance": 1.5},
  {"shape": {"circle": {"radius": 1}}, "rolling_friction": 0.5},
  {"shape": {"circle": {"radius": 1}}, "material_id": -1}]}]}"#;
    let expected = [
        "2: bodies[0].colliders[0].surface_speed: out of range: expected a surface speed within ±2^10 m/s [E101]",
        "3: bodies[0].colliders[1].tangent_speed: unknown field: did you mean `surface_speed`? [E503]",
        "4: bodies[0].colliders[2].friction_rule: expected one of standard, geometric_mean, mean, minimum, product, maximum, found \"average\" [E502]",
        "5: bodies[0].colliders[3].rolling_resistance: out of range: expected a coefficient of rolling resistance from 0 to 1 [E101]",
        "6: bodies[0].colliders[4].rolling_friction: unknown field: did you mean `rolling_resistance`? [E503]",
        "7: bodies[0].colliders[5].material_id: out of range: expected a whole number that fits in 32 bits [E508]",
    ];
    assert_eq!(lines(text), expected);
}

#[test]
fn mistakes_in_shapes_materials_and_filters_are_told_at_their_fields() {
    let disc = r#""shape": {"circle": {"radius": 1}}"#;
    let text = format!(
        r#"{{"bodies": [{{"name": "a", "colliders": [
  {{"shape": {{"circle": {{"radius": "big"}}}}}},
  {{"shape": {{"polygon": [[0, 0], [2, 0], [1, 0.5], [0, 2]]}}}},
  {{"shape": {{"rounded_polygon": {{"corners": [[0, 0], [1, 0], [0, 1]], "radius": -1}}}}}},
  {{"shape": {{"segment": [[0, 0], [0, 0]]}}}},
  {{"shape": {{"ball": {{"radius": 1}}}}}},
  {{{disc}, "friction": "rough"}},
  {{{disc}, "friction": -0.5}},
  {{{disc}, "restitution": [0.5]}},
  {{{disc}, "category": 3}},
  {{{disc}, "category": [32]}},
  {{{disc}, "mask": [-1]}},
  {{{disc}, "group": 2147483648}},
  {{{disc}, "angle": "left"}},
  {{{disc}, "name": 7}}]}},
 {{"name": "b", "colliders": {{"shape": 1}}}}]}}"#
    );
    let expected = [
        "2: bodies[0].colliders[0].shape.circle.radius: expected a number, found a text [E502]",
        "3: bodies[0].colliders[1].shape.polygon[2]: corner 2 is not convex, or repeats its neighbour: list the corners of a convex polygon in order [E105]",
        "4: bodies[0].colliders[2].shape.rounded_polygon.radius: out of range: expected a radius from 2^-7 (0.0078125) to 2^12 m, not -1 [E101]",
        "5: bodies[0].colliders[3].shape.segment: out of range: expected a length from 2^-7 (0.0078125) to 2^12 m, not 0 [E101]",
        "6: bodies[0].colliders[4].shape.ball: unknown field: did you mean `circle`? [E503]",
        "7: bodies[0].colliders[5].friction: expected a number, found a text [E502]",
        "8: bodies[0].colliders[6].friction: out of range: expected a coefficient of friction from 0 to 32 [E101]",
        "9: bodies[0].colliders[7].restitution: expected a number, found a list [E502]",
        "10: bodies[0].colliders[8].category: expected a list, found a number [E502]",
        "11: bodies[0].colliders[9].category[0]: out of range: expected a category from 0 to 31 [E508]",
        "12: bodies[0].colliders[10].mask[0]: out of range: expected a category from 0 to 31 [E508]",
        "13: bodies[0].colliders[11].group: out of range: expected a whole number that fits in 32 bits [E508]",
        "14: bodies[0].colliders[12].angle: expected a number, found a text [E502]",
        "15: bodies[0].colliders[13].name: expected a text, found a number [E502]",
        "16: bodies[1].colliders: expected a list, found an object [E502]",
    ];
    let actual = lines(&text);
    assert_eq!(actual, expected, "{actual:#?}");
}

#[test]
fn mistakes_in_inputs_for_colliders_are_told_at_their_fields() {
    let disc = r#""shape": {"circle": {"radius": 1}}"#;
    let text = format!(
        r#"{{"bodies": [{{"name": "a", "colliders": [{{"name": "hull", {disc}}}]}}], "inputs": [
  {{"at": 1, "body": "b", "add_collider": {{{disc}}}}},
  {{"at": 1, "body": "a", "add_collider": {{"name": "hull", {disc}}}}},
  {{"at": 1, "body": "a", "add_collider": {{{disc}, "friction": 99}}}},
  {{"at": 1, "collider": "hull", "replace": {{{disc}, "restitution": 2}}}},
  {{"at": 1, "collider": "hull", "replace": {{"frction": 1}}}},
  {{"at": 1, "collider": "hull", "do": "jump"}},
  {{"at": 1, "collider": 3, "do": "remove"}}]}}"#
    );
    let expected = [
        "2: inputs[0].body: there is no body \"b\" [E507]",
        "3: inputs[1].add_collider.name: there is a collider \"hull\" already: choose another name [E506]",
        "4: inputs[2].add_collider.friction: out of range: expected a coefficient of friction from 0 to 32 [E101]",
        "5: inputs[3].replace.restitution: out of range: expected a coefficient of restitution from 0 to 1 [E101]",
        "6: inputs[4].replace.frction: unknown field: did you mean `friction`? [E503]",
        "6: inputs[4].replace: the field `shape` is missing [E505]",
        "7: inputs[5].do: expected one of remove, found \"jump\" [E502]",
        "8: inputs[6].collider: expected a text, found a number [E502]",
    ];
    let actual = lines(&text);
    assert_eq!(actual, expected, "{actual:#?}");
}

#[test]
fn inputs_to_a_collider_that_is_gone_are_reported() {
    let text = r#"{"bodies": [{"name": "a", "mass": 1, "colliders": [{"name": "hull", "shape": {"circle": {"radius": 1}}}]}], "inputs": [
  {"at": 1, "collider": "hull", "do": "remove"},
  {"at": 2, "collider": "hull", "do": "remove"}]}"#;
    let expected = ["3: inputs[1].do: at tick 2: the collider does not exist at that tick [E128]"];
    let actual = lines(text);
    assert_eq!(actual, expected, "{actual:#?}");
}

#[test]
fn errors_that_follow_from_another_are_not_reported() {
    // Both bodies are refused; what refers to them is right. So are the thousand that would be refused alike.
    let text = r#"{"bodies": [{"name": "a", "mass": -1}, {"name": 7}, {"name": "{i}", "angel": 0, "repeat": {"i": 1000}}],
"fields": [{"thrust": {"at": "a", "force": [1, 0]}}, {"thrust": {"at": "seven", "force": [1, 0]}}],
"inputs": [{"at": 1, "body": "999", "do": "wake"}, {"at": 2, "body": "a", "force": [1, 0]}]}"#;
    let fields: Vec<String> = errors(text).errors().iter().map(|error| error.place.field.clone()).collect();
    assert_eq!(fields, ["bodies[0].mass", "bodies[1].name", "bodies[2](i=0).angel"]);
    // A field that is missing for no other reason is.
    let actual = lines(r#"{"bodies": [{"name": "a", "colliders": [{"shape": {"rectangle": {"hight": 1}}}]}]}"#);
    assert_eq!(actual.len(), 2, "{actual:?}");
    assert!(actual[0].ends_with("hight: unknown field: did you mean `height`? [E503]"), "{actual:?}");
    assert!(actual[1].ends_with("rectangle: the field `width` is missing [E505]"), "{actual:?}");
}

#[test]
fn inputs_that_the_world_refuses_are_all_reported() {
    let text = r#"{"bodies": [{"name": "a", "kind": "static"}], "inputs": [
{"at": 3, "body": "a", "force": [1, 0]},
{"at": 1, "set": {"gravity": [1e6, 0]}},
{"at": 5, "body": "a", "set": {"gravity_scale": 99}}]}"#;
    let errors_found = errors(text);
    let places: Vec<usize> = errors_found.errors().iter().map(|error| error.place.line).collect();
    assert_eq!(places, [2, 3, 4], "{errors_found}");
}

/// At the start the explosion would take the body beyond the largest speed; the step before it stops the body.
#[test]
fn an_explosion_is_refused_by_the_motion_at_its_tick() {
    let text = |at: u64| {
        let colliders = r#"[{"shape": {"circle": {"radius": 1}}}]"#;
        let motion = r#""position": [20, 0], "velocity": [-1048576, 0]"#;
        let body = format!(r#"{{"name": "a", {motion}, "colliders": {colliders}}}"#);
        let explosion = format!(r#"{{"at": {at}, "explode": {{"position": [0, 0], "radius": 30, "impulse": -1}}}}"#);
        format!(r#"{{"damping": {{"linear": {{"kept_per_second": 0}}}}, "bodies": [{body}], "inputs": [{explosion}]}}"#)
    };
    let run = |at: u64| {
        let scene = Scene::parse(&text(at)).expect("a scene");
        let mut run = scene.start::<Fx>().expect("a start");
        (0..2).try_for_each(|_| run.advance().map(drop))
    };
    assert_eq!(run(0).map_err(|error| error.code()), Err(101));
    assert_eq!(run(1), Ok(()));
}

#[test]
fn twenty_are_listed_and_the_rest_counted() {
    let bodies = vec![r#"{"name": 1}"#; 1_000].join(",\n");
    let errors_found = errors(&format!("{{\"bodies\": [\n{bodies}]}}"));
    assert_eq!((errors_found.errors().len(), errors_found.more()), (SceneErrors::LISTED, 980));
    let text = errors_found.to_string();
    assert_eq!(text.lines().next(), Some("2: bodies[0].name: expected a text, found a number"));
    assert_eq!((text.lines().count(), text.lines().last()), (21, Some("and 980 more")));
}

#[test]
fn vectors_may_be_objects() {
    let gravity = |text: &str| Scene::parse(&format!("{{\"gravity\": {text}}}")).map(|scene| scene.world.gravity);
    assert_eq!(gravity(r#"{"x": 1.5, "y": -10}"#), gravity("[1.5, -10]"));
    assert!(gravity("[1.5, -10]").is_ok());
    for (text, expected) in [
        ("{}", &["1: gravity: the field `x` is missing [E505]", "1: gravity: the field `y` is missing [E505]"][..]),
        (r#"{"length": 1}"#, &["1: gravity: the field `angle` is missing [E505]"]),
        (r#"{"x": 1, "y": 2, "z": 3}"#, &["1: gravity.z: unknown field; there are x, y [E503]"]),
        ("\"down\"", &["1: gravity: expected [x, y] or {\"x\": …, \"y\": …}, found a text [E502]"]),
    ] {
        assert_eq!(lines(&format!("{{\"gravity\": {text}}}")), expected, "{text}");
    }
    let scene = |at: &str| Scene::parse(&format!(r#"{{"fields": [{{"attractor": {{"at": {at}, "mu": 1}}}}]}}"#));
    let field = |at: &str| scene(at).map(|scene| scene.fields[0].field);
    assert_eq!(field(r#"{"x": 1, "y": 2}"#), field("[1, 2]"));
    assert!(scene("7").is_err_and(|errors| errors.first().message.contains("the name of a body")));
}

#[test]
fn every_mistake_in_a_pair_of_materials_is_told_at_its_field() {
    let text = r#"{"bodies": [{"name": "a", "colliders": [
  {"shape": {"circle": {"radius": 1}}, "material_id": 1}, {"shape": {"circle": {"radius": 1}}, "material_id": 2}]}],
"material_pairs": [
  {"materials": [1, 3]},
  {"materials": [0, 1]},
  {"materials": [1, 2], "friction": 33},
  {"materials": [1, 2], "restitution": 1.5},
  {"materials": [1, 2], "rolling_resistance": -1},
  {"materials": [1, 2], "remove": true},
  {"materials": [1, 2]},
  {"materials": [2, 1]},
  {"friction": 1}],
"inputs": [{"at": 1, "set": {"material_pair": {"materials": [1, 0]}}}]}"#;
    let expected = [
        "4: material_pairs[0].materials: no collider has the material 3: expected a `material_id` of one [E507]",
        "5: material_pairs[1].materials[0]: out of range: expected a number of a material from 1: 0 is no material [E101]",
        "6: material_pairs[2].friction: out of range: expected a coefficient of friction from 0 to 32 [E101]",
        "7: material_pairs[3].restitution: out of range: expected a coefficient of restitution from 0 to 1 [E101]",
        "8: material_pairs[4].rolling_resistance: out of range: expected a coefficient of rolling resistance from 0 to 1 [E101]",
        "9: material_pairs[5].remove: unknown field; there are repeat, materials, friction, restitution, rolling_resistance [E503]",
        "11: material_pairs[7].materials: there is an entry for these two materials already [E506]",
        "12: material_pairs[8]: the field `materials` is missing [E505]",
        "13: inputs[0].set.material_pair.materials[1]: out of range: expected a number of a material from 1: 0 is no material [E101]",
    ];
    assert_eq!(lines(text), expected);
}
