//! Comparisons of recordings: `umbra diff`.

use super::*;

#[test]
fn diff_names_what_was_done_otherwise() {
    let folder = Folder::new("diff");
    let record = |name: &str, push: &str, more: &[&str]| folder.record(&folder.write(name, busy(push)), more);
    let (three, four) = (record("three.json", "3", &[]), record("four.json", "4", &[]));
    let output = umbra(&["diff", &three, &four]);
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(
        text(&output.stdout),
        "tick 2, calls, body 1 \"b\", call 1, action.impulse.x: 3 and 4 N·s (differ by 1 N·s)\n"
    );
    assert_eq!(text(&output.stderr), format!("{three} and {four} are not the same\n"));
    let json = |files: [&str; 2], more: &[&str]| -> (Option<i32>, Value) {
        let output = umbra(&[&["diff", "--json"], &files[..], more].concat());
        (output.status.code(), serde_json::from_slice(&output.stdout).expect("one JSON value"))
    };
    let (status, outcome) = json([&three, &four], &[]);
    let finding: Value = serde_json::from_str(
        r#"{"tick": 2, "phase": "calls", "owner": "body 1", "name": "b", "key": 0, "field": "calls[0].action.impulse.x", "recorded": "3", "found": "4"}"#,
    )
    .expect("JSON");
    assert_eq!((status, &outcome["same"], &outcome["finding"]), (Some(1), &Value::from(false), &finding));
    assert!(outcome.get("differences").is_none());

    // The values that differ after that tick: a kilogram has 1 m/s more, but for the drag, and is further on.
    let (status, outcome) = json([&three, &four], &["--all"]);
    let all = outcome["differences"].as_array().expect("a list");
    let fields: Vec<_> =
        all.iter().map(|difference| (difference["owner"].as_str(), difference["field"].as_str())).collect();
    assert_eq!(fields, [(Some("body 1"), Some("position.x")), (Some("body 1"), Some("velocity.x"))]);
    let speed = |side: &str| all[1][side].as_str().and_then(|text| text.parse::<f64>().ok()).expect("a number");
    assert!(speed("left") < 3.0 && speed("right") < 4.0 && speed("right") - speed("left") > 0.99);
    assert_eq!(status, Some(1));
    let output = umbra(&["diff", "--all", &three, &four]);
    let lines = text(&output.stdout);
    assert_eq!(lines.lines().nth(1), Some("values that differ after that: 2"));
    assert!(lines.lines().nth(2).is_some_and(|line| line.starts_with("  body 1 \"b\", position.x: 5.")), "{lines}");

    let digits = |more: &[&str]| {
        let output = umbra(&[&["diff", "--all", &three, &four], more].concat());
        text(&output.stdout).lines().nth(3).map(str::len).expect("a velocity")
    };
    assert!(digits(&[]) < 80 && digits(&["--exact"]) > 150);

    // Two replays with different starts.
    let start = folder.write("start.json", busy("3").replace("[5, 0]", "[6, 0]"));
    let (status, outcome) = json([&three, &folder.record(&start, &[])], &["--all"]);
    let finding = &outcome["finding"];
    assert_eq!((status, finding["phase"].as_str(), finding["tick"].as_u64()), (Some(1), Some("start"), Some(0)));
    assert_eq!((finding["owner"].as_str(), finding["field"].as_str()), (Some("body 1"), Some("position.x")));
    assert_eq!(outcome["differences"].as_array().map(Vec::len), Some(1));

    // A replay that ends sooner does not differ.
    let brief = record("brief.json", "3", &["--ticks", "40"]);
    let (status, outcome) = json([&three, &brief], &["--all"]);
    assert_eq!((status, &outcome["same"], &outcome["finding"]), (Some(0), &Value::from(true), &Value::Null));
    assert_eq!(outcome["ends"], serde_json::json!([100, 40]));
    let output = umbra(&["diff", &three, &brief]);
    let expected = format!("the same as far as both go: {three} ends at tick 100, {brief} ends at tick 40\n");
    assert_eq!((output.status.code(), text(&output.stdout)), (Some(0), expected));
    let output = umbra(&["diff", &three, &three]);
    assert_eq!((output.status.code(), text(&output.stdout)), (Some(0), "the same, to tick 100\n".to_owned()));
}

#[test]
fn diff_reads_what_is_cut_off_and_refuses_what_is_no_recording() {
    let folder = Folder::new("diff-input");
    let replay = folder.record(&folder.write("busy.json", busy("3")), &[]);
    let bytes = fs::read(&replay).expect("a replay");
    let cut = folder.write("cut.umbrarep", &bytes[..bytes.len() - 1]);
    let output = umbra(&["diff", "--json", &replay, &cut]);
    let outcome: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!((output.status.code(), &outcome["complete"]), (Some(0), &serde_json::json!([true, false])));
    let scrap = folder.write("scrap.umbrarep", &bytes[..60]);
    let changed = folder.write("changed.umbrarep", flipped(&bytes, bytes.len() / 2));
    let refused = |file: &str, reason: &str| {
        for files in [[&replay[..], file], [file, &replay]] {
            let output = umbra(&["diff", files[0], files[1]]);
            assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{files:?}");
            let error = text(&output.stderr);
            assert!(error.starts_with(&format!("{file}: {reason}")), "{error}");
        }
    };
    refused(&scrap, "cut off: too little of it is whole to be read [E404]");
    refused(&changed, "changed after it was recorded: ");
    let record = "found a scene: `umbra run scenes/kepler.json --record REPLAY` makes a replay of it";
    refused("scenes/kepler.json", &format!("expected a replay or a desync dump of umbra-physics, {record} [E804]"));
    let table = folder.write("table.csv", "1,2\n");
    refused(&table, "expected a replay or a desync dump of umbra-physics [E804]");
    refused(&folder.path("none"), "cannot read: ");
}

#[test]
fn diff_of_two_dumps_names_the_moment_the_body_and_the_field() {
    let folder = Folder::new("dumps");
    let mut world = World::new(WorldDef::default()).expect("a world");
    let body = world.add_body(BodyDef::dynamic()).expect("a body");
    let dump = |x: i32| {
        let mut after = world.clone();
        let push = |world: &mut World| world.apply_force(body, vec2(x, 0)).expect("it is dynamic");
        push(&mut after);
        after.step();
        Dump::of_game(&world, push, &after).to_bytes()
    };
    let (a, b) = (folder.write("a.umbradmp", dump(1)), folder.write("b.umbradmp", dump(2)));
    let same = umbra(&["diff", &a, &a]);
    assert_eq!((same.status.code(), text(&same.stdout)), (Some(0), "the same, to tick 1\n".to_owned()));
    let differ = umbra(&["diff", &a, &b, "--json", "--all"]);
    assert_eq!(differ.status.code(), Some(1));
    let outcome: Value = serde_json::from_str(&text(&differ.stdout)).expect("JSON");
    let finding = &outcome["finding"];
    assert_eq!(
        (finding["tick"].as_u64(), finding["field"].as_str(), finding["recorded"].as_str(), finding["found"].as_str()),
        (Some(0), Some("applied.force.x"), Some("1"), Some("2")),
        "{outcome}"
    );
    assert_eq!(outcome["differences"].as_array().map(Vec::len), Some(1), "{outcome}");
    let replay = folder.record("scenes/kepler.json", &["--ticks", "3"]);
    assert_eq!(umbra(&["diff", &a, &replay]).status.code(), Some(2));
}
