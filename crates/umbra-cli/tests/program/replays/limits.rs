//! Limits on the cost of a file of a stranger, and the start that it has to have.

use super::*;
use umbra_physics::{Explosion, Input, Inputs, Shape};

/// A line of `umbra verify` for a file: the exit status, the status, the number and the reason.
fn judged(file: &str, more: &[&str]) -> (i32, String, String, String) {
    let (exit, lines) = verify(&[file], more);
    let text = |key: &str| lines[0][key].as_str().unwrap_or_default().to_owned();
    (exit, text("status"), text("code"), text("reason"))
}

#[test]
fn each_limit_holds_and_says_so() {
    let folder = Folder::new("limits");
    // Four bodies, two fields and four colliders at once, and 34 commands in 100 ticks.
    let replay = folder.record(&folder.write("busy.json", busy("3")), &[]);
    let size = fs::metadata(&replay).expect("a replay").len();
    for (name, enough, code, said) in [
        ("ticks", 100, "E422", "the replay has 100 ticks, more than the limit of 99"),
        ("bodies", 4, "E423", "more than 3 bodies at tick 4"),
        ("fields", 2, "E424", "more than 1 force fields at tick 4"),
        ("commands", 34, "E425", "more than 33 commands up to tick 12"),
        ("colliders", 2, "E426", "more than 1 colliders at tick 4"),
        ("pairs", 1 << 20, "E427", "settings that allow more than 1048575 pairs of colliders at tick 0"),
    ] {
        assert_eq!(judged(&replay, &["--limit", &format!("{name}={enough}")]).0, 0, "{name}");
        let less = judged(&replay, &["--limit", &format!("{name}={}", enough - 1)]);
        assert_eq!(less, (1, "over_limits".to_owned(), code.to_owned(), said.to_owned()), "{name}");
    }
    assert_eq!(judged(&replay, &["--limit", &format!("bytes={size}")]).0, 0);
    let larger = judged(&replay, &["--limit", "bytes=999"]);
    assert_eq!(larger, (1, "too_large".to_owned(), "E806".to_owned(), "more than 999 bytes".to_owned()));
    let over = judged(&replay, &["--limit", "cpu_seconds=0"]);
    let said = "more than 0 s of CPU time at tick 0".to_owned();
    assert_eq!(over, (1, "over_limits".to_owned(), "E428".to_owned(), said));
    // A device without end is read up to the limit.
    #[cfg(unix)]
    assert_eq!(judged("/dev/zero", &["--limit", "bytes=100000"]).1, "too_large");
    let plain = umbra(&["verify", "--limit", "ticks=9", &replay]);
    let said = format!("over_limits  {replay}  the replay has 100 ticks, more than the limit of 9 [E422]\n");
    assert_eq!((plain.status.code(), text(&plain.stdout)), (Some(1), said));
}

#[test]
fn limits_come_from_the_arguments_then_from_a_file_and_else_are_the_stated_ones() {
    let folder = Folder::new("limits-file");
    let replay = folder.record(&folder.write("busy.json", busy("3")), &[]);
    let file = folder.write("limits.json", r#"{"ticks": 50, "bodies": 4}"#);
    assert_eq!(judged(&replay, &["--limits", &file]).2, "E422");
    assert_eq!(judged(&replay, &["--limits", &file, "--limit", "ticks=100"]).0, 0);
    assert_eq!(judged(&replay, &["--limits", &file, "--limit", "ticks=100,bodies=3"]).2, "E423");
    assert_eq!(judged(&replay, &["--limit", "ticks=1", "--limit", "ticks=100"]).0, 0, "the last one counts");
    let help = text(&umbra(&["verify", "--help"]).stdout);
    let readme = fs::read_to_string(root().join("crates/umbra-cli/README.md")).expect("a document");
    for (name, value) in [
        ("bytes", "67108864"),
        ("cpu_seconds", "600"),
        ("ticks", "1296000"),
        ("bodies", "16384"),
        ("fields", "4096"),
        ("colliders", "65536"),
        ("pairs", "1048576"),
        ("commands", "2000000"),
    ] {
        let is_row = |line: &str| line.split_whitespace().take(2).eq([name, value]);
        assert!(help.lines().any(is_row), "{name} in {help}");
        // Of the digits in threes that a person reads.
        let rows = readme.lines().filter(|line| line.contains(&format!("`{name}`")));
        assert!(rows.map(|row| row.replace(',', "")).any(|row| row.contains(value)), "{name} in README.md");
    }
    for (content, said) in [
        (r#"{"tick": 50}"#, "no limit `tick`; there are bytes, cpu_seconds, ticks, bodies, fields, "),
        (r#"{"ticks": -1}"#, "invalid value: integer `-1`, expected u64"),
        ("[]", "invalid type: sequence, expected a map"),
        ("{", "EOF while parsing an object"),
    ] {
        let file = folder.write("wrong.json", content);
        let output = umbra(&["verify", "--limits", &file, &replay]);
        assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{content}");
        assert!(text(&output.stderr).starts_with(&format!("{file}: cannot read: {said}")), "{}", text(&output.stderr));
    }
    for limit in ["tick=5", "ticks", "ticks=", "ticks=-1", "ticks=1.5", "ticks=18446744073709551616"] {
        let output = umbra(&["verify", "--limit", limit, &replay]);
        assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{limit}");
    }
}

/// A replay of three ticks: many explosions among 400 bodies in the second; with a bit of the run changed in the first, if it is
/// to differ.
fn explosive(explosions: usize, differs: bool) -> Vec<u8> {
    let mut world = World::new(WorldDef::default()).expect("a world");
    let disc = Shape::circle(fx!(0.1)).expect("a disc");
    let mut body = None;
    for i in 0..400 {
        let place = vec2(i % 20, i / 20);
        body = Some(
            world
                .add_body(BodyDef { position: place, ..BodyDef::dynamic() }.with_collider(disc.clone()))
                .expect("room"),
        );
    }
    let mut recorder = Recorder::new(&world, RecordOptions { hash_every: 1, snapshot_every: 0 });
    if differs {
        world.set_velocity(body.expect("one"), vec2(1, 0)).expect("it moves");
    }
    let explosion = Explosion { radius: fx!(30), ..Explosion::new(vec2(10, 10), fx!(0.000001)) };
    for tick in 0..3 {
        let mut inputs = Inputs::new();
        for sequence in 0..if tick == 1 { explosions } else { 0 } {
            let command = Order::Explode(explosion);
            inputs.insert(Input { player: 0, sequence: sequence as u32, command }).expect("one of its kind");
        }
        recorder.step(&mut world, &inputs);
    }
    recorder.finish(&world)
}

#[test]
#[cfg_attr(debug_assertions, ignore = "works for seconds: in release builds")]
fn the_time_of_a_file_is_bounded_within_a_tick_and_in_the_search_of_a_divergence() {
    let folder = Folder::new("cpu");
    // As many as take longer than the limit here.
    let mut explosions = 20_000;
    let (replay, whole) = loop {
        let replay = folder.write("long.umbrarep", explosive(explosions, false));
        let (exit, lines) = verify(&[&replay], &[]);
        assert_eq!(exit, 0, "{}", lines[0]);
        let seconds = lines[0]["cpu_seconds"].as_f64().expect("a time");
        if seconds > 1.6 {
            break (replay, seconds);
        }
        explosions *= 2;
    };
    let second = ["--limit", "cpu_seconds=1"];
    let (exit, lines) = verify(&[&replay], &second);
    let line = &lines[0];
    assert_eq!(
        (exit, line["status"].as_str(), line["code"].as_str()),
        (1, Some("over_limits"), Some("E428")),
        "{line}"
    );
    assert_eq!(line["reason"].as_str(), Some("more than 1 s of CPU time at tick 1"));
    let seconds = line["cpu_seconds"].as_f64().expect("a time");
    assert!((1.0..1.5).contains(&seconds), "{seconds} s of {whole}");
    // It differs after the first tick; which value does would be known at the end.
    let differs = folder.write("differs.umbrarep", explosive(explosions, true));
    let (exit, lines) = verify(&[&differs], &second);
    let line = &lines[0];
    assert_eq!((exit, line["status"].as_str()), (1, Some("diverged")), "{line}");
    assert_eq!(line["finding"]["field"].as_str(), Some("hash"), "{line}");
    let seconds = line["cpu_seconds"].as_f64().expect("a time");
    assert!((1.0..1.5).contains(&seconds), "{seconds} s of {whole}");
    assert_eq!(verify(&[&differs], &[]).1[0]["finding"]["field"].as_str(), Some("position.x"));
}

#[test]
fn a_replay_has_to_begin_with_the_start() {
    let folder = Folder::new("start");
    let level = folder.write("level.json", busy("3"));
    let replay = folder.record(&level, &[]);
    // The same start and other inputs; and with other bodies.
    let other_inputs = folder.record(&folder.write("inputs.json", busy("4")), &[]);
    let moved = folder.record(&folder.write("moved.json", busy("3").replace("[5, 0]", "[6, 0]")), &[]);
    let world = Scene::parse(&busy("3")).expect("a scene").start().expect("a start").into_world();
    let snapshot = world.snapshot().to_bytes();
    let whole = folder.write("level.umbrasnp", &snapshot);
    for start in [&level, &replay, &whole] {
        let (exit, lines) = verify(&[&replay, &other_inputs, &moved], &["--start", start]);
        let statuses: Vec<_> = lines.iter().map(|line| line["status"].as_str().expect("a status")).collect();
        assert_eq!((exit, &statuses[..]), (1, &["ok", "ok", "other_start"][..]));
        let line = &lines[2];
        let finding = &line["finding"];
        assert_eq!((line["code"].as_str(), line["ticks"].as_u64()), (Some("E807"), Some(0)), "it is not played");
        assert_eq!((finding["owner"].as_str(), finding["field"].as_str()), (Some("body 1"), Some("position.x")));
        assert_eq!((finding["recorded"].as_str(), finding["found"].as_str()), (Some("5"), Some("6")));
        let reason = line["reason"].as_str().expect("a reason");
        assert!(reason.starts_with("it begins with another world: tick 0, start, body 1"), "{reason}");
    }
    let table = folder.write("table.csv", "1,2\n");
    let cut = folder.write("cut.umbrasnp", &snapshot[..snapshot.len() / 2]);
    let empty = folder.write("empty", "");
    for (start, said) in [
        (&table, ":1: not JSON: "),
        (&folder.path("none"), ": cannot read: "),
        (&cut, ": byte "),
        (&empty, ": expected a scene, a replay or a snapshot, found an empty file [E804]"),
    ] {
        let output = umbra(&["verify", "--start", start, &replay]);
        assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{start}");
        assert!(text(&output.stderr).starts_with(&format!("{start}{said}")), "{}", text(&output.stderr));
    }
}
