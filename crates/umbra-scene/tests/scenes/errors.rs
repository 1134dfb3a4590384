//! The errors of a text: all at once, each at its place, with what would be right.

use umbra_scene::{Scene, SceneErrors};

fn errors(text: &str) -> SceneErrors {
    Scene::parse(text).expect_err("it is no scene")
}

/// Each error as a line, with its number.
fn lines(text: &str) -> Vec<String> {
    errors(text).errors().iter().map(|error| format!("{error} [E{}]", error.code())).collect()
}

#[test]
fn all_errors_of_a_text_are_reported_by_line() {
    let text = r#"{
"gravity": -9.81,
"time_step": "1/0",
"bodies": [
  {"name": "ball", "shape": {"circle": {"raduis": 0.1}}},
  {"nmae": "box", "type": "static", "friction": 0.5},
  {"name": "crate", "shape": {"box": {"width": 1}}, "mass": 0, "kind": "dynmic"},
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
        "5: bodies[0].shape.circle.raduis: unknown field: did you mean `radius`? [E503]",
        "6: bodies[1].nmae: unknown field: did you mean `name`? [E503]",
        "6: bodies[1].type: unknown field: did you mean `kind`? [E503]",
        "6: bodies[1].friction: unknown field: there is no collision yet [E503]",
        "7: bodies[2].kind: expected one of static, kinematic, dynamic, found \"dynmic\": did you mean `dynamic`? [E502]",
        "7: bodies[2].shape.box: unknown field: did you mean `rectangle`? [E503]",
        "8: bodies[3].max_speeds.liner: unknown field: did you mean `linear`? [E503]",
        "8: bodies[3].position: expected a list of 2 values, found 1 [E502]",
        "10: fields[0].spring.to: the field `y` is missing [E505]",
        "10: fields[0].spring.stifness: unknown field: did you mean `stiffness`? [E503]",
        "12: inputs[0].force[1]: expected a number, found a text [E502]",
        "12: inputs[0].torque: out of range: expected a number from -2^31 to below 2^31 [E713]",
        "14: inputs[2].do: expected one of remove, release, wake, disable, enable, found \"jump\" [E502]",
        "16: plot.trials: unknown field: did you mean `trails`? [E503]",
    ];
    let found = lines(text);
    assert_eq!(found, expected, "{found:#?}");
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
fn what_follows_from_another_error_is_not_reported() {
    // Both bodies are refused; what refers to them is right. So are the thousand that would be refused alike.
    let text = r#"{"bodies": [{"name": "a", "mass": -1}, {"name": 7}, {"name": "{i}", "angel": 0, "repeat": {"i": 1000}}],
"fields": [{"thrust": {"at": "a", "force": [1, 0]}}, {"thrust": {"at": "seven", "force": [1, 0]}}],
"inputs": [{"at": 1, "body": "999", "do": "wake"}, {"at": 2, "body": "a", "force": [1, 0]}]}"#;
    let found: Vec<String> = errors(text).errors().iter().map(|error| error.place.field.clone()).collect();
    assert_eq!(found, ["bodies[0].mass", "bodies[1].name", "bodies[2](i=0).angel"]);
    // A field that is missing for no other reason is.
    let found = lines(r#"{"bodies": [{"name": "a", "shape": {"rectangle": {"hight": 1}}}]}"#);
    assert_eq!(found.len(), 2, "{found:?}");
    assert!(found[0].ends_with("hight: unknown field: did you mean `height`? [E503]"), "{found:?}");
    assert!(found[1].ends_with("rectangle: the field `width` is missing [E505]"), "{found:?}");
}

#[test]
fn inputs_that_the_world_refuses_are_all_reported() {
    let text = r#"{"bodies": [{"name": "a", "kind": "static"}], "inputs": [
{"at": 3, "body": "a", "force": [1, 0]},
{"at": 1, "set": {"gravity": [1e6, 0]}},
{"at": 5, "body": "a", "set": {"gravity_scale": 99}}]}"#;
    let found = errors(text);
    let places: Vec<usize> = found.errors().iter().map(|error| error.place.line).collect();
    assert_eq!(places, [2, 3, 4], "{found}");
}

#[test]
fn twenty_are_listed_and_the_rest_counted() {
    let bodies = vec![r#"{"name": 1}"#; 1_000].join(",\n");
    let found = errors(&format!("{{\"bodies\": [\n{bodies}]}}"));
    assert_eq!((found.errors().len(), found.more()), (SceneErrors::LISTED, 980));
    let text = found.to_string();
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
