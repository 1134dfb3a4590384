//! The program: what it prints, writes and refuses.

use std::fs;
use std::path::{Path, PathBuf};

use crate::umbra;

/// A file of a test's own; it goes when the test is over.
struct Scratch(PathBuf);

impl Scratch {
    fn new(name: &str, text: impl AsRef<[u8]>) -> Self {
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{}-{name}", std::process::id()));
        fs::write(&path, text).expect("the scratch file can be written");
        Self(path)
    }

    fn path(&self) -> &str {
        self.0.to_str().expect("the path is UTF-8")
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.0);
    }
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("UTF-8")
}

/// Runs a scene that is wrong: exit status 2, nothing on the standard output, one line that begins with the file, and
/// the rest of that line.
fn refused(name: &str, scene: impl AsRef<[u8]>) -> String {
    let file = Scratch::new(name, scene);
    let output = umbra(&["run", file.path()]);
    assert_eq!(output.status.code(), Some(2), "{name}");
    assert!(output.stdout.is_empty(), "{name}: {}", text(&output.stdout));
    let error = text(&output.stderr);
    assert_eq!(error.lines().count(), 1, "{name}: {error}");
    let rest = error.trim_end().strip_prefix(file.path()).unwrap_or_else(|| panic!("{name}: no file in {error}"));
    let (rest, number) = rest.rsplit_once(" [E").unwrap_or_else(|| panic!("{name}: no number in {error}"));
    assert!(number.strip_suffix(']').is_some_and(|digits| digits.parse::<u16>().is_ok()), "{name}: {error}");
    rest.to_owned()
}

#[test]
fn each_message_ends_with_the_number_of_its_error() {
    let number = |arguments: &[&str]| {
        let error = text(&umbra(arguments).stderr);
        error.trim_end().rsplit_once(" [").map(|(_, number)| number.trim_end_matches(']').to_owned())
    };
    let scene = |name: &str, text: &str| number(&["run", Scratch::new(name, text).path()]);
    for (code, scene_text) in [
        ("E500", r#"{"inputs": [{"at": 1}]}"#.to_owned()),
        ("E501", "{".to_owned()),
        ("E502", "[]".to_owned()),
        ("E503", r#"{"bodys": []}"#.to_owned()),
        ("E504", with_body("\"mass\": 5, \"mass\": 5")),
        ("E505", r#"{"bodies": [{}]}"#.to_owned()),
        ("E506", r#"{"bodies": [{"name": "a"}, {"name": "a"}]}"#.to_owned()),
        ("E507", r#"{"fields": [{"thrust": {"at": "b", "force": [0, 1]}}]}"#.to_owned()),
        ("E508", with_body("\"force_groups\": [32]")),
        ("E509", r#"{"title": "\u001b"}"#.to_owned()),
        ("E510", r#"{"bodies": [{"repeat": {"i": 2000000000}, "name": "{i}"}]}"#.to_owned()),
        ("E101", with_body("\"mass\": 0")),
        ("E713", with_body("\"mass\": 1e300")),
        ("E105", with_body("\"colliders\": [{\"shape\": {\"polygon\": [[0, 0], [4, 0], [1, 1], [0, 4]]}}]")),
        (
            "E107",
            r#"{"bodies": [{"name": "s", "kind": "static"}], "inputs": [{"at": 1, "body": "s", "force": [0, 1]}]}"#
                .to_owned(),
        ),
    ] {
        assert_eq!(scene(code, &scene_text).as_deref(), Some(code), "{scene_text}");
    }
    assert_eq!(number(&["run", "scenes/no-such-scene.json"]).as_deref(), Some("E801"));
    let free = Scratch::new("free.json", "{}");
    assert_eq!(number(&["run", free.path(), "--hash-every", "5"]), None, "bad usage is the arguments' own");
    assert_eq!(number(&["diff", free.path(), free.path()]).as_deref(), Some("E804"));
    let foreign = Scratch::new("foreign.umbrarep", b"UMBRAREP\x63\0\0\0");
    assert_eq!(number(&["diff", foreign.path(), foreign.path()]).as_deref(), Some("E402"));
}

/// A scene with a body on line 3.
fn with_body(fields: &str) -> String {
    format!("{{\n  \"bodies\": [\n    {{\"name\": \"a\", {fields}}}\n  ]\n}}\n")
}

#[test]
fn a_missing_file_is_named() {
    let output = umbra(&["run", "scenes/no-such-scene.json"]);
    assert_eq!(output.status.code(), Some(2));
    let error = text(&output.stderr);
    assert!(error.starts_with("scenes/no-such-scene.json: cannot read: "), "{error}");
    assert_eq!(error.lines().count(), 1);
}

#[test]
fn broken_json_is_found_by_line_and_column() {
    let broken = refused("broken.json", "{\n  \"ticks\": 5,\n  \"gravity\" [0, 1]\n}");
    assert_eq!(broken, ":3: not JSON: expected `:` at column 13");
    assert!(refused("blank.json", "\n").starts_with(":2: not JSON: "), "a file of white space");
    assert!(refused("cut.json", "{\n\"bodies\": [").starts_with(":2: not JSON: "), "a cut file");
    assert!(refused("two.json", "{}\n{}").starts_with(":2: not JSON: "), "two values");
    assert_eq!(refused("list.json", "[]"), ":1: expected an object, found a list");
    assert!(refused("bytes.json", b"{\"title\": \"\xff\"}").starts_with(": cannot read: "), "not UTF-8");
}

#[test]
fn deep_nesting_costs_no_stack() {
    let deep = |open: &str, close: &str| open.repeat(200_000) + "1" + &close.repeat(200_000);
    let scene = format!("{{\n\"gravity\": {}}}", deep("[", "]"));
    assert_eq!(refused("deep.json", scene), ":2: gravity: expected a list of 2 values, found 1");
    let scene = format!("{{\n\"gravity\": [{}, 0]}}", deep("[", "]"));
    assert_eq!(refused("deeper.json", scene), ":2: gravity[0]: expected a number, found a list");
    let scene = format!("{{\n\"depth\": {}}}", deep("{\"a\":", "}"));
    assert!(refused("objects.json", scene).starts_with(":2: depth: unknown field"), "objects");
    assert!(refused("open.json", "[".repeat(200_000)).starts_with(":1: not JSON: EOF"), "open lists");
    let scene = with_body(&format!("\"colliders\": [{{\"shape\": {}}}]", deep(r#"{"compound": [{"shape": "#, "}]}")));
    let error = refused("compounds.json", scene);
    assert_eq!(
        error,
        ":3: bodies[0].colliders[0].shape.compound[0].shape.compound: a part cannot be a compound itself"
    );
}

#[test]
fn unknown_doubled_and_missing_fields_are_named() {
    let unknown = refused("unknown.json", with_body("\n    \"wieght\": 5"));
    assert!(unknown.starts_with(":4: bodies[0].wieght: unknown field; there are repeat, name, kind, "), "{unknown}");
    assert_eq!(
        refused("doubled.json", with_body("\"mass\": 5, \"mass\": 5")),
        ":3: bodies[0].mass: this field is given twice: give it once"
    );
    assert_eq!(
        refused("escaped.json", with_body(r#""mass": 5, "m\u0061ss": 5"#)),
        ":3: bodies[0].mass: this field is given twice: give it once"
    );
    assert_eq!(refused("nameless.json", "{\"bodies\": [\n{}]}"), ":2: bodies[0]: the field `name` is missing");
    let lines = refused("lines.json", with_body(r#""two\nlines": 5"#));
    assert!(lines.starts_with(r":3: bodies[0].two\nlines: unknown field"), "{lines}");
    let control = refused("control.json", r#"{"title": "\u001b[31mred"}"#);
    assert_eq!(control, r":1: title: a text must have no control characters: found \u{1b}");
    let top = refused("top.json", "{\"bodys\": []}");
    assert!(top.starts_with(":1: bodys: unknown field: did you mean `bodies`?"), "{top}");
}

#[test]
fn doubled_names_are_refused() {
    let scene = "{\"bodies\": [{\"name\": \"a\"},\n{\"name\": \"b\"},\n{\"name\": \"a\"}]}";
    assert_eq!(refused("names.json", scene), ":3: bodies[2].name: there is a body \"a\" already: choose another name");
    let scene = "{\"bodies\": [{\"repeat\": {\"i\": 2}, \"name\": \"a\"}]}";
    assert_eq!(
        refused("rounds.json", scene),
        ":1: bodies[0](i=1).name: there is a body \"a\" already: choose another name"
    );
    let scene = "{\"fields\": [{\"name\": \"f\", \"drag\": {}}, {\"name\": \"f\", \"drag\": {}}]}";
    assert_eq!(
        refused("fields.json", scene),
        ":1: fields[1].name: there is a force field \"f\" already: choose another name"
    );
}

#[test]
fn numbers_out_of_range_are_refused_at_their_field() {
    let mass = ":3: bodies[0].mass: out of range: expected a mass from 2^-16 to 2^24 kg";
    // Of a decimal that binary digits do not hold exactly, the nearest that they do.
    for (number, value) in
        [("-1", "-1"), ("0", "0"), ("1e8", "100000000"), ("0.00001", "0.0000100000761449337005615234375")]
    {
        let told = refused("mass.json", with_body(&format!("\"mass\": {number}")));
        assert_eq!(told, format!("{mass}, not {value}"), "{number}");
    }
    let cases = [
        ("\"mass\": 1e300", "mass: out of range: expected a number from -2^31 to below 2^31"),
        ("\"mass\": \"5\"", "mass: expected one of from_colliders, found \"5\""),
        ("\"mass\": null", "mass: expected a number, found null"),
        ("\"mass\": 1, \"inertia\": 0", "inertia: out of range: expected a moment of inertia above zero, not 0"),
        ("\"position\": [0, 1.1e9]", "position: out of range: expected a position within ±2^30 m"),
        ("\"position\": [0]", "position: expected a list of 2 values, found 1"),
        ("\"velocity\": [2e6, 0]", "velocity: out of range: expected a velocity within ±2^20 m/s a component"),
        (
            "\"damping\": {\"linear\": {\"kept_per_second\": 1.5}}",
            "damping.linear.kept_per_second: out of range: expected damping that keeps from 0 to 1 of a velocity a second, so a \
             rate of at least 0",
        ),
        (
            "\"damping\": {\"linear\": {\"rate\": -0.1}}",
            "damping.linear.rate: out of range: expected damping that keeps from 0 to 1 of a velocity a second, so a \
             rate of at least 0",
        ),
        (
            "\"damping\": {\"linear\": 0}",
            "damping.linear: expected a damping: {\"rate\": 0.1} in 1/s as in Box2D and Rapier, {\"kept_per_second\": 0.9} for the share \
             of a velocity that is left after a second, or \"none\", found a number",
        ),
        (
            "\"damping\": 0.9",
            "damping: expected dampings such as {\"linear\": {\"rate\": 0.1}, \"angular\": {\"kept_per_second\": 0.9}}, found a number",
        ),
        ("\"damping\": {\"rate\": 0.1}", "damping.rate: unknown field; there are linear, angular"),
        ("\"gravity_scale\": 17", "gravity_scale: out of range: expected a gravity scale within ±16"),
        ("\"kind\": \"solid\"", "kind: expected one of static, kinematic, dynamic, found \"solid\""),
        ("\"kind\": \"static\", \"velocity\": [1, 0]", "velocity: a static body has no velocity"),
        ("\"force_groups\": [32]", "force_groups[0]: out of range: expected a group from 0 to 31"),
        ("\"key\": -1", "key: out of range: expected a whole number that fits in 64 bits"),
        ("\"density\": 1", "density: unknown field: give it to a collider, in the list `colliders` of a body"),
        (
            "\"shape\": {\"circle\": {\"radius\": 1}}",
            "shape: unknown field: give it to a collider, `\"colliders\": [{\"shape\": …}]`; one with `\"mask\": []` touches nothing",
        ),
        (
            "\"colliders\": [{\"shape\": {\"circle\": {\"radius\": 5000}}}]",
            "colliders[0].shape.circle.radius: out of range: expected a radius from 2^-7 (0.0078125) to 2^12 m, not 5000",
        ),
        (
            "\"colliders\": [{\"shape\": {\"ball\": {}}}]",
            "colliders[0].shape.ball: unknown field: did you mean `circle`?",
        ),
    ];
    for (fields, expected) in cases {
        assert_eq!(refused("range.json", with_body(fields)), format!(":3: bodies[0].{expected}"), "{fields}");
    }
}

#[test]
fn mistakes_in_colliders_are_refused_with_file_line_and_field() {
    let disc = "\"shape\": {\"circle\": {\"radius\": 1}}";
    let cases = [
        ("\n\"friction\": 33", 4, ".friction", "out of range: expected a coefficient of friction from 0 to 32"),
        ("\"restitution\": -1", 3, ".restitution", "out of range: expected a coefficient of restitution from 0 to 1"),
        ("\n\n\"mask\": [32]", 5, ".mask[0]", "out of range: expected a category from 0 to 31"),
        ("\"category\": [-1]", 3, ".category[0]", "out of range: expected a category from 0 to 31"),
        ("\"groop\": 1", 3, ".groop", "unknown field: did you mean `group`?"),
        ("\"density\": -1", 3, ".density", "out of range: expected a density of at least zero, not -1"),
    ];
    for (fields, line, field, what) in cases {
        let scene = with_body(&format!("\"colliders\": [{{{disc}, {fields}}}]"));
        assert_eq!(
            refused("collider.json", scene),
            format!(":{line}: bodies[0].colliders[0]{field}: {what}"),
            "{fields}"
        );
    }
    let shapeless = refused("shapeless.json", with_body("\"colliders\": [{\"friction\": 0.5}]"));
    assert_eq!(shapeless, ":3: bodies[0].colliders[0]: the field `shape` is missing");
}

#[test]
fn a_number_of_forty_digits_is_rounded_once() {
    // 2^-33 is a tie and goes to 0; a digit in the fortieth place more makes it an ulp.
    for (digits, ulps) in
        [("0.000000000116415321826934814453125", "0"), ("0.0000000001164153218269348144531250000001", "1")]
    {
        let file = Scratch::new(&format!("digits-{ulps}.json"), with_body(&format!("\"position\": [{digits}, 0]")));
        let table = Scratch::new(&format!("digits-{ulps}.csv"), "");
        let output = umbra(&["run", file.path(), "--ticks", "0", "--csv", table.path()]);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        let rows = fs::read_to_string(&table.0).expect("the table is there");
        let x = if ulps == "0" { "0" } else { "0.00000000023283064365386962890625" };
        assert_eq!(rows.lines().nth(1), Some(format!("0,a,{x},0,0,0,0,0").as_str()));
    }
}

#[test]
fn a_polygon_that_is_not_convex_is_refused_at_its_corner() {
    let dent = with_body("\"colliders\": [{\"shape\": {\"polygon\": [\n[0, 0], [4, 0],\n[1, 1],\n[0, 4]]}}]");
    assert_eq!(
        refused("dent.json", dent),
        ":5: bodies[0].colliders[0].shape.polygon[2]: corner 2 is not convex, or repeats its neighbour: list the corners of a convex polygon in order"
    );
    let two = refused("two-corners.json", with_body("\"colliders\": [{\"shape\": {\"polygon\": [[0, 0], [1, 0]]}}]"));
    assert_eq!(
        two,
        ":3: bodies[0].colliders[0].shape.polygon: out of range: expected 3 to 64 corners, also of a hull, up to 1,024 of a concave polygon, 2 to 65,536 points of a chain (at least 3 if it is closed), or 1 to 256 parts, none of them a compound or a chain"
    );
}

#[test]
fn a_spring_needs_its_bodies() {
    let spring = |from: &str, to: &str| {
        format!(
            "{{\"bodies\": [{{\"name\": \"a\"}}, {{\"name\": \"s\", \"kind\": \"static\"}}],\n\"fields\": [{{\"spring\": {{\"from\": {from},\n\"to\": {to}, \"stiffness\": 1}}}}]}}"
        )
    };
    let cases = [
        ("\"a\"", "\"b\"", ":3: fields[0].spring.to: there is no body \"b\""),
        ("{\"body\": \"c\"}", "[0, 0]", ":2: fields[0].spring.from.body: there is no body \"c\""),
        ("\"a\"", "\"a\"", ":3: fields[0].spring.to: both ends are attached to the same body"),
        ("\"s\"", "[0, 0]", ":3: fields[0].spring.to: a spring or thrust needs a dynamic body"),
    ];
    for (from, to, expected) in cases {
        assert_eq!(refused("spring.json", spring(from, to)), expected);
    }
    let law = "{\"fields\": [\n{\"attractor\": {\"at\": [0, 0], \"mu\": -1}}]}";
    let expected = ":2: fields[0].attractor.mu: out of range: expected a gravitational parameter from 0 to 2^64 m³/s²";
    assert_eq!(refused("mu.json", law), expected);
    assert_eq!(refused("large.json", law.replace("-1", "1e20")), expected);
}

#[test]
fn a_time_step_is_a_ratio_above_zero() {
    let range = ":1: time_step: the time step must be num/den seconds, from 1 to 10,000 steps a second";
    for step in ["\"0/60\"", "\"1/0\"", "{\"num\": 0, \"den\": 1}", "\"2/1\"", "\"1/10001\""] {
        assert_eq!(refused("step.json", format!("{{\"time_step\": {step}}}")), range, "{step}");
    }
    let zero = refused("zero.json", "{\"time_step\": 0}");
    assert_eq!(zero, ":1: time_step: expected a ratio such as \"1/60\", found a number");
    let text = refused("text.json", "{\"time_step\": \"1/6.5\"}");
    assert_eq!(text, ":1: time_step: expected a ratio of whole numbers such as \"1/60\"");
}

#[test]
fn inputs_are_tried_before_the_run() {
    let with_input = |input: &str| {
        let bodies = "{\"name\": \"a\"}, {\"name\": \"s\", \"kind\": \"static\"}";
        format!("{{\"bodies\": [{bodies}],\n\"inputs\": [\n{input}]}}")
    };
    let cases = [
        ("{\"at\": 5, \"body\": \"b\", \"force\": [0, 1]}", "body: there is no body \"b\""),
        ("{\"at\": 5, \"body\": \"s\", \"force\": [0, 1]}", "force: at tick 5: \"s\" is not dynamic"),
        ("{\"at\": 5, \"body\": \"a\"}", ": this input does nothing: give it an action such as `force`, `set` or `do`"),
        ("{\"body\": \"a\", \"force\": [0, 1]}", ": one of the fields at, from is missing"),
        (
            "{\"from\": 5, \"to\": 4, \"body\": \"a\", \"force\": [0, 1]}",
            "to: out of range: the last tick is before the first: expected `to` of at least `from`",
        ),
        (
            "{\"at\": 5, \"body\": \"a\", \"set\": {\"mass\": -1}}",
            "set.mass: at tick 5: out of range: expected a mass from 2^-16 to 2^24 kg, not -1",
        ),
        (
            "{\"at\": 5, \"set\": {\"gravity\": [0, 1e6]}}",
            "set.gravity: at tick 5: out of range: expected gravity within ±2^16 m/s² a component",
        ),
        ("{\"at\": 5, \"body\": \"a\", \"do\": \"remove\"}, {\"at\": 6, \"body\": \"a\", \"torque\": 1}", ""),
    ];
    for (input, expected) in cases {
        let error = refused("input.json", with_input(input));
        let expected = match expected {
            "" => ":3: inputs[1].torque: at tick 6: the body does not exist at that tick".to_owned(),
            _ if expected.starts_with(':') => format!(":3: inputs[0]{expected}"),
            _ => format!(":3: inputs[0].{expected}"),
        };
        assert_eq!(error, expected, "{input}");
    }
}

#[test]
fn an_input_that_fails_during_the_run_is_named() {
    let scene = "{\"bodies\": [{\"name\": \"a\"}], \"ticks\": 9, \"inputs\": [\n{\"from\": 0, \"to\": 8, \"body\": \"a\", \"impulse\": [3e5, 0]}]}";
    let expected = ":2: inputs[0].impulse: at tick 3: out of range: expected a velocity within ±2^20 m/s a component";
    assert_eq!(refused("way.json", scene), expected);
}

#[test]
fn bad_usage_is_status_two() {
    for arguments in [
        &["run"][..],
        &["run", "scenes/kepler.json", "--scalar", "f16"],
        &["run", "scenes/kepler.json", "--integrator", "rk4"],
        &["run", "scenes/kepler.json", "--every", "5"],
        &["run", "scenes/kepler.json", "--csv", "x.csv", "--every", "0"],
        &["run", "scenes/kepler.json", "--ticks", "-1"],
        &["run", "scenes/damping.json", "--integrator", "yoshida4"],
        &["walk"],
        &[],
    ] {
        let output = umbra(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(!output.stderr.is_empty(), "{arguments:?}");
    }
    let output = umbra(&["run", "scenes/kepler.json", "--ticks", "1", "--csv", "no/such/folder/x.csv"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).starts_with("no/such/folder/x.csv: cannot write: "));
}

#[test]
fn a_run_gives_summary_table_and_picture() {
    let (table, picture) = (Scratch::new("fall.csv", ""), Scratch::new("fall.svg", ""));
    let output = umbra(&[
        "run",
        "scenes/free-fall.json",
        "--ticks",
        "60",
        "--csv",
        table.path(),
        "--every",
        "30",
        "--plot",
        picture.path(),
    ]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(output.stderr.is_empty(), "no progress but on a terminal: {}", text(&output.stderr));
    let summary = text(&output.stdout);
    for part in ["Free fall", "60, after 1 s", "4: 4 moving, 0 asleep, 0 quarantined", "state hash", "energy"] {
        assert!(summary.contains(part), "{part} in {summary}");
    }
    let rows = fs::read_to_string(&table.0).expect("the table is there");
    let lines: Vec<&str> = rows.lines().collect();
    assert_eq!(lines[0], "tick,name,x,y,angle,vx,vy,angular_velocity");
    assert_eq!(lines.len(), 1 + 3 * 4, "four bodies at ticks 0, 30 and 60");
    // 45 − ½·10·1², at −10 m/s: to the last bit, whatever the mass.
    assert_eq!(lines[9], "60,1 g,0,40,0,0,-10,0");
    assert_eq!(lines[10], "60,1 kg,5,40,0,0,-10,0");
    let svg = fs::read_to_string(&picture.0).expect("the picture is there");
    assert!(svg.starts_with("<svg ") && svg.trim_end().ends_with("</svg>"));
    assert!(svg.contains("Free fall") && svg.contains("x in m") && svg.contains("<polyline"));
}

#[test]
fn a_picture_has_disabled_bodies_as_grey_outlines_whatever_they_did_before() {
    let svg = |input: &str| {
        let scene = format!(
            r#"{{"ticks": 20, "bodies": [
                {{"name": "a", "velocity": [3, 0], "colliders": [{{"shape": {{"rectangle": {{"width": 2, "height": 2}}}}, "mask": []}}]}},
                {{"name": "b", "velocity": [0, 3], "colliders": [{{"shape": {{"rectangle": {{"width": 2, "height": 2}}}}, "mask": []}}]}}
            ], "inputs": [{input}], "plot": {{"exposures": 1}}}}"#
        );
        let (scene, picture) = (Scratch::new("disabled.json", &scene), Scratch::new("disabled.svg", ""));
        let output = umbra(&["run", scene.path(), "--plot", picture.path()]);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        fs::read_to_string(&picture.0).expect("the picture is there")
    };
    // Filled areas, grey lines, faint lines of a time between.
    let marks =
        |svg: &str| ["<polygon", "stroke=\"#969696\"", "stroke=\"#787878\""].map(|mark| svg.matches(mark).count());
    assert_eq!(marks(&svg("")), [2, 0, 2]);
    assert_eq!(marks(&svg(r#"{"at": 5, "body": "b", "do": "disable"}"#)), [1, 1, 1]);
}

#[test]
fn contacts_are_drawn_if_asked_for() {
    let scene = r#"{"ticks": 60, "gravity": [0, -10], "bodies": [
        {"name": "floor", "kind": "static", "colliders": [{"shape": {"rectangle": {"width": 4, "height": 1}}}]},
        {"name": "crate", "position": [0, 1], "colliders": [{"shape": {"rectangle": {"width": 1, "height": 1}}}]}]}"#;
    let (scene, picture) = (Scratch::new("crate.json", scene), Scratch::new("crate.svg", ""));
    let svg = |options: &[&str]| {
        let output = umbra(&[&["run", scene.path(), "--plot", picture.path()], options].concat());
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        fs::read_to_string(&picture.0).expect("the picture is there")
    };
    // Dots at two corners of the crate; two arrows of a line and a head each; two areas of the colliders.
    let marks = |svg: &str| {
        let count_of =
            |element: &str| svg.split('<').filter(|tag| tag.starts_with(element) && tag.contains("#A50F15")).count();
        [count_of("circle"), count_of("polyline"), svg.matches("<polygon").count()]
    };
    assert_eq!(marks(&svg(&[])), [0, 0, 2]);
    let lines = |svg: &str| svg.matches("<polyline").count();
    let bare = lines(&svg(&[]));
    let points = svg(&["--contacts", "points"]);
    assert_eq!((marks(&points), lines(&points)), ([2, 0, 2], bare));
    let normals = svg(&["--contacts", "normals"]);
    assert_eq!((marks(&normals), lines(&normals)), ([0, 0, 2], bare + 2));
    let all = svg(&["--contacts", "points,normals,impulses", "--impulse-scale", "30"]);
    assert_eq!((marks(&all), lines(&all)), ([2, 4, 2], bare + 2 + 4));
    assert!(all.contains("impulses 30.000 m per N·s"), "{all}");
    // By itself the longest is a tenth of the picture, here of 4 m and its margins: half of 1/30 N·s.
    let caption = svg(&["--contacts", "impulses"]);
    let (_, scale) = caption.split_once("impulses ").expect("the scale");
    let scale: f64 = scale.split(' ').next().and_then(|scale| scale.parse().ok()).expect("a number");
    assert!((scale / 60.0 - 0.448).abs() < 0.001, "{scale}");
    // What cannot be meant.
    for (options, said) in [
        (&["--contacts", "points"][..], "--plot"),
        (&["--plot", picture.path(), "--contacts", "forces"], "points, normals, impulses"),
        (&["--plot", picture.path(), "--impulse-scale", "1"], "--contacts"),
        (&["--plot", picture.path(), "--contacts", "impulses", "--impulse-scale", "0"], "expected a number above 0"),
    ] {
        let output = umbra(&[&["run", scene.path()], options].concat());
        assert_eq!(output.status.code(), Some(2), "{options:?}");
        assert!(text(&output.stderr).contains(said), "{options:?}: {}", text(&output.stderr));
    }
}

/// The summary counts joints, and the picture has a line between the ends of each, an axis where it has one, and a mark at each end.
#[test]
fn joints_are_counted_and_drawn() {
    let scene = r#"{"ticks": 2, "gravity": [0, -10], "bodies": [{"name": "a", "mass": 1, "inertia": 1}, {"name": "b", "position": [4, 0]},
        {"name": "c", "position": [0, -2]}, {"name": "d", "position": [4, 2]}],
      "joints": [{"bodies": [null, "a"], "point": [0, 0], "revolute": {}}, {"bodies": ["a", "b"], "points": [[0, 0], [4, 0]], "distance": {}},
        {"bodies": [null, "b"], "point": [4, 0], "axis": [0, 1], "prismatic": {"limits": [-1000, 1000]}},
        {"bodies": ["a", "c"], "point": [0, -1], "axis": [0, 1], "wheel": {}},
        {"bodies": [null, "d"], "points": [[4, 3], [4, 2]], "distance": {"limits": [0, 1]}, "break_force": 1}]}"#;
    let (scene, picture) = (Scratch::new("joints.json", scene), Scratch::new("joints.svg", ""));
    let output = umbra(&["run", scene.path(), "--plot", picture.path()]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains("  joints            5: 1 broken\n"), "{}", text(&output.stdout));
    let svg = fs::read_to_string(&picture.0).expect("the picture is there");
    // Of four joints; the axis of 2 km is cut at the edges of a picture around the ends.
    let stroke = r##"stroke="#323232" stroke-opacity="0.80""##;
    let drawn = svg.lines().filter(|line| line.starts_with("<polyline") && line.contains(stroke));
    let points: Vec<usize> = drawn.map(|line| line.matches(',').count()).collect();
    assert_eq!(points, [[2; 6].as_slice(), &[5; 8]].concat(), "{svg}");
    let without = Scratch::new("alone.json", r#"{"ticks": 1, "bodies": [{"name": "a"}]}"#);
    assert!(!text(&umbra(&["run", without.path()]).stdout).contains("joints"));
    let json = umbra(&["run", scene.path(), "--json"]);
    let told = text(&json.stdout).replace([' ', '\n'], "");
    assert!(told.contains(r#""joints":{"total":5,"broken":1}"#), "{told}");
}

/// ½·1 kg·(2π·2 Hz)²·(½ m)² at the start, which the spring gives back after 10 s of swinging.
#[test]
fn energy_counts_springs_of_joints() {
    let scene = r#"{"ticks": 600, "sleep_after": null, "bodies": [{"name": "a", "position": [3, 0]}],
      "joints": [{"bodies": [null, "a"], "points": [[0, 0], [3, 0]],
        "distance": {"spring": {"hertz": 2, "damping_ratio": 0, "rest": 2.5}}}]}"#;
    let scene = Scratch::new("energy.json", scene);
    let printed = text(&umbra(&["run", scene.path()]).stdout);
    assert!(printed.contains("  energy            19.73920880 → 19.7"), "{printed}");
    let json = umbra(&["run", scene.path(), "--json"]);
    let result: serde_json::Value = serde_json::from_slice(&json.stdout).expect("JSON");
    let energy = |when: &str| result[when]["energy"].as_str().and_then(|energy| energy.parse::<f64>().ok());
    let [before, after] = ["before", "after"].map(|when| energy(when).expect("a number"));
    assert!((after / before - 1.0).abs() < 1e-4, "{before} {after}");
}

#[test]
fn texts_stay_inside_a_narrow_picture() {
    let scene = r#"{"title": "A title that is longer than the picture is wide, as nobody would expect", "ticks": 1,
        "bodies": [{"name": "a", "position": [0, 123456789.5]}], "plot": {"view": [[-1, 123456780], [1, 123456800]]}}"#;
    let (scene, picture) = (Scratch::new("narrow.json", scene), Scratch::new("narrow.svg", ""));
    let output = umbra(&["run", scene.path(), "--plot", picture.path()]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let svg = fs::read_to_string(&picture.0).expect("the picture is there");
    let value = |tag: &str, name: &str| -> f64 {
        let (_, rest) = tag.split_once(&format!(" {name}=\"")).unwrap_or_else(|| panic!("{tag} has no {name}"));
        rest.split('"').next().expect("an end").parse().expect("a number")
    };
    let (width, mut labels) = (value(&svg, "width"), 0);
    for line in svg.lines().filter(|line| line.starts_with("<text x=")) {
        let (tag, rest) = line.split_once('>').expect("a tag");
        let letters = rest.strip_suffix("</text>").expect("a text").chars().count() as f64;
        let long = 0.6 * letters * value(tag, "font-size");
        let share = if tag.contains("\"end\"") {
            1.0
        } else if tag.contains("\"middle\"") {
            0.5
        } else {
            0.0
        };
        let start = value(tag, "x") - share * long;
        assert!(start >= 20.0 && start + long <= width, "{line}");
        labels += usize::from(rest.starts_with("1.234567"));
    }
    assert!(labels >= 9 && svg.contains("A title that") && svg.contains('…'), "{svg}");
}

#[test]
fn json_has_the_same_in_exact_decimals() {
    let run = |scalar: &str| {
        let output = umbra(&["run", "scenes/too-stiff.json", "--json", "--scalar", scalar]);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        serde_json::from_slice::<serde_json::Value>(&output.stdout).expect("one JSON value")
    };
    let fx = run("fx");
    assert_eq!(fx["tick"], 150);
    assert_eq!(fx["time"], "5/2");
    assert_eq!(fx["bodies"]["quarantined"], 1);
    assert_eq!(fx["faults"][0]["name"], "ω·dt = 2.1");
    assert_eq!(fx["faults"][0]["cause"], "velocity beyond 2^20 m/s");
    assert_eq!(fx["before"]["energy"], "34843.5");
    assert_eq!(fx["state_hash"].as_str().map(str::len), Some(16));
    assert_eq!(run("fx")["state_hash"], fx["state_hash"], "twice the same");
    for scalar in ["f64", "f32"] {
        let float = run(scalar);
        assert_eq!(float["scalar"], scalar);
        assert_eq!(float["bodies"]["quarantined"], 1);
        assert_ne!(float["state_hash"], fx["state_hash"]);
    }
}

#[test]
fn a_profile_says_where_the_time_of_the_steps_went() {
    let output = umbra(&["run", "scenes/pyramid.json", "--ticks", "30", "--profile"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let summary = text(&output.stdout);
    for part in ["part of a step", "\n  manifolds ", "\n  passes ", "\n  all ", "\n  contacts ", "\n  islands  "] {
        assert!(summary.contains(part), "{part} in {summary}");
    }
    assert!(!summary.contains("\n  damp "), "there are no coupled bodies: {summary}");
    for scalar in ["fx", "f64"] {
        let arguments = ["run", "scenes/pyramid.json", "--ticks", "30", "--json", "--scalar", scalar];
        let json = |profile: &[&str]| {
            let output = umbra(&[&arguments[..], profile].concat());
            serde_json::from_slice::<serde_json::Value>(&output.stdout).expect("one JSON value")
        };
        assert_eq!(json(&[]).get("profile"), None);
        let result = json(&["--profile"]);
        let profile = &result["profile"];
        assert_eq!(profile["steps"], 30);
        let parts = profile["parts"].as_array().expect("a list");
        let sum = |key: &str| parts.iter().map(|part| part[key].as_f64().expect("a number")).sum::<f64>();
        assert!((sum("share") - 1.0).abs() < 1e-9);
        let steps = sum("us_per_step") * 30e-6;
        assert!(steps > 0.0 && steps <= result["wall_seconds"].as_f64().expect("a number"), "{result}");
        let counts = profile["counts"].as_array().expect("a list");
        assert!(counts.iter().any(|count| count["name"] == "points" && count["per_step"].as_f64() > Some(10.0)));
    }
}

#[test]
fn the_integrator_can_be_chosen() {
    let energy = |name: &str| {
        let output = umbra(&["run", "scenes/kepler.json", "--ticks", "1200", "--json", "--integrator", name]);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        let result: serde_json::Value = serde_json::from_slice(&output.stdout).expect("one JSON value");
        assert_eq!(result["integrator"], name);
        result["after"]["energy"].as_str().and_then(|energy| energy.parse::<f64>().ok()).expect("a number")
    };
    assert!((energy("yoshida4") + 5.0).abs() < 1e-3);
    assert!(energy("explicit_euler") > -4.5, "it gains energy");
}

#[test]
fn the_selftest_agrees_with_what_is_written_down() {
    let output = umbra(&["selftest"]);
    assert_eq!(output.status.code(), Some(0), "{}{}", text(&output.stdout), text(&output.stderr));
    let table = text(&output.stdout);
    let golden = umbra_physics::selftest::golden();
    for (name, outcome) in golden.scenes() {
        let row = table.lines().find(|line| line.split_whitespace().next() == Some(name)).expect("a row a scene");
        assert!(row.contains(&format!("{:016x}", outcome.digest)) && row.ends_with("ok"), "{row}");
    }
    let all = golden.all().expect("one digest of all");
    assert!(table.contains(&format!("{:016x}", all.digest)));
    assert!(table.trim_end().ends_with("agrees: this machine computes what all others do"), "{table}");
    assert!(table.contains("no wide vectors"), "{table}");
    let threads = if cfg!(feature = "parallel") { "a pool of 8 threads" } else { "one thread" };
    assert!(table.contains(threads), "{table}");
}

#[test]
fn the_selftest_as_json_is_an_object_a_line() {
    let output = umbra(&["selftest", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let lines: Vec<serde_json::Value> =
        text(&output.stdout).lines().map(|line| serde_json::from_str(line).expect("a JSON object")).collect();
    let golden = umbra_physics::selftest::golden();
    let scenes: Vec<_> = golden.scenes().collect();
    let (last, rows) = lines.split_last().expect("a line of all");
    assert_eq!(rows.len(), scenes.len());
    for (row, (name, outcome)) in rows.iter().zip(scenes) {
        assert_eq!(row["scene"], name);
        assert_eq!(row["ticks"], outcome.ticks);
        assert_eq!(row["digest"], format!("{:016x}", outcome.digest));
        assert_eq!((row["agrees"].as_bool(), row["troubles"].as_array().map(Vec::len)), (Some(true), Some(0)));
    }
    let all = golden.all().expect("one digest of all");
    assert_eq!(last["digest"], format!("{:016x}", all.digest));
    assert_eq!(
        (last["physics_version"].as_u64(), last["agrees"].as_bool()),
        (Some(umbra_physics::PHYSICS_VERSION.into()), Some(true))
    );
}
