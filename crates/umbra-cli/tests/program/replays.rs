//! From a scene to a replay and its verification: `umbra run --record`, `verify`, `diff`.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;
use umbra_physics::{
    ApplyOptions, BodyDef, BodyId, Command as Order, Dump, ForceOrImpulse, Fx, PHYSICS_VERSION, RecordOptions,
    Recorder, Replay, World, WorldDef, fx, vec2,
};
use umbra_scene::Scene;
use xxhash_rust::xxh3::Xxh3;

mod diff;
mod limits;
mod service;

use crate::{root, umbra};

/// A folder of a test's own; it goes when the test is over.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{}-replays-{name}", std::process::id()));
        fs::create_dir_all(&path).expect("a folder");
        Self(path)
    }

    fn path(&self, name: &str) -> String {
        self.0.join(name).to_str().expect("UTF-8").to_owned()
    }

    /// Writes a file, and returns its path.
    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> String {
        let path = self.path(name);
        fs::write(&path, bytes).expect("a file");
        path
    }

    /// Records a replay of a scene, and returns its path.
    fn record(&self, scene: &str, more: &[&str]) -> String {
        let name = Path::new(scene).file_stem().expect("a name").to_string_lossy().into_owned();
        let path = self.path(&format!("{name}.umbrarep"));
        let output = umbra(&[&["run", scene, "--record", &path], more].concat());
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        path
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("UTF-8")
}

/// The exit status and JSON lines of `umbra verify`.
fn verify(files: &[&str], more: &[&str]) -> (i32, Vec<Value>) {
    let output = umbra(&[&["verify", "--json"], more, files].concat());
    let lines = text(&output.stdout).lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    (output.status.code().expect("a status"), lines)
}

/// The exit status and JSON line of `umbra verify` for one file with these bytes.
fn verified(folder: &Folder, name: &str, bytes: &[u8]) -> (i32, Value) {
    let path = folder.write(name, bytes);
    let (status, mut lines) = verify(&[&path], &[]);
    assert_eq!((lines.len(), lines[0]["file"].as_str()), (1, Some(&path[..])));
    (status, lines.remove(0))
}

/// Every kind of input that a scene can have, the marks of two bodies, and a push to the second of them at tick 2.
fn busy(push: &str) -> String {
    r#"{"ticks": 100, "gravity": [0, -10], "bodies": [
        {"name": "a", "mass": 1, "colliders": [{"shape": {"circle": {"radius": 1}}, "mask": []}], "user_data": 1234605616436508552},
        {"name": "b", "position": [5, 0]}, {"name": "s", "kind": "static"}],
    "fields": [{"name": "d", "drag": {"linear": 0.5}}],
    "inputs": [
        {"at": 2, "body": "b", "impulse": [PUSH, 0]},
        {"from": 3, "to": 9, "every": 2, "body": "a", "force": [1, 2], "torque": 3, "frame": "body", "point": [0.5, 0]},
        {"at": 4, "add": {"name": "c", "colliders": [{"name": "hull", "shape": {"rectangle": {"width": 1, "height": 2}}, "mask": []}], "mass": 2}},
        {"at": 4, "add_field": {"name": "p", "spring": {"from": "c", "to": "b", "stiffness": 3}}},
        {"at": 5, "body": "c", "angular_impulse": 1, "set": {"position": [1, 1], "angle": 1, "velocity": [1, 0],
            "angular_velocity": 2, "gravity_scale": 0.5, "damping": {"linear": {"kept_per_second": 0.5}}, "force_groups": [1], "key": 3,
            "user_data": 4}},
        {"at": 5, "collider": "hull", "do": "remove"},
        {"at": 6, "body": "c", "set": {"mass": 3, "inertia": 2}, "add_collider": {"shape": {"circle": {"radius": 0.5}}, "mask": []}},
        {"at": 7, "field": "d", "replace": {"zone": {"disc": {"centre": [0, 0], "radius": 3}, "acceleration": [0, 1]}}},
        {"at": 8, "set": {"time_step": "1/120", "gravity": [0, -1], "integrator": "symplectic_euler",
            "damping": {"linear": {"kept_per_second": 0.9}}, "sleep_after": 5}},
        {"at": 9, "body": "s", "set": {"kind": "kinematic"}},
        {"at": 10, "body": "a", "do": "wake"},
        {"at": 11, "field": "p", "do": "remove"},
        {"at": 12, "body": "c", "do": "remove"}]}"#
        .replace("PUSH", push)
}

fn starts(bytes: &[u8], part: &[u8]) -> Vec<usize> {
    (0..=bytes.len() - part.len()).filter(|&at| bytes[at..].starts_with(part)).collect()
}

fn flipped(bytes: &[u8], at: usize) -> Vec<u8> {
    let mut changed = bytes.to_vec();
    changed[at] ^= 1;
    changed
}

/// The file with other bytes in its first chunk, which gets a valid seal.
fn resealed(file: &[u8], change: impl Fn(&mut [u8])) -> Vec<u8> {
    let mut file = file.to_vec();
    let (start, word) = (12 + 16, 12);
    let length = u32::from_le_bytes(file[word + 4..word + 8].try_into().expect("four")) as usize;
    change(&mut file[start..start + length]);
    let mut hash = Xxh3::new();
    hash.update(&file[word..word + 8]);
    hash.update(&file[start..start + length]);
    let (mut sum, mut weighted) = (0u128, 0u128);
    for (k, bytes) in file[start..start + length].chunks(8).enumerate() {
        let mut word = [0; 8];
        word[..bytes.len()].copy_from_slice(bytes);
        sum += u128::from(u64::from_le_bytes(word));
        weighted += (k as u128 + 1) * u128::from(u64::from_le_bytes(word));
    }
    let seal = [&hash.digest().to_le_bytes()[..], &sum.to_le_bytes(), &weighted.to_le_bytes()].concat();
    file[start + length..start + length + seal.len()].copy_from_slice(&seal);
    file
}

/// A run whose world is changed without the recorder before tick 40.
fn strayed(options: RecordOptions) -> Vec<u8> {
    let mut world = World::new(WorldDef::default()).expect("a world");
    world.add_body(BodyDef::dynamic()).expect("a body");
    let body = world.add_body(BodyDef { velocity: vec2(1, 0), ..BodyDef::dynamic() }).expect("a body");
    let mut recorder = Recorder::new(&world, options);
    for tick in 0..100 {
        if tick == 40 {
            world.set_velocity(body, vec2(1, 2)).expect("it is there");
        }
        recorder.step(&mut world, &umbra_physics::Inputs::new());
    }
    recorder.finish(&world)
}

#[test]
fn every_scene_is_recorded_as_it_runs_and_verified() {
    let folder = Folder::new("scenes");
    let mut replays = Vec::new();
    for entry in fs::read_dir(root().join("scenes")).expect("scenes") {
        let scene = entry.expect("an entry").path();
        if scene.extension().is_none_or(|kind| kind != "json") {
            continue;
        }
        let parsed = Scene::parse(&fs::read_to_string(&scene).expect("a text")).expect("a scene");
        let ticks = if parsed.bodies.len() > 100 { 70 } else { 400 };
        let path = folder.path(&format!("{}.umbrarep", scene.file_stem().expect("a name").to_string_lossy()));
        let (scene, count) = (scene.to_str().expect("UTF-8"), ticks.to_string());
        let ran = |more: &[&str]| -> Value {
            let output = umbra(&[&["run", scene, "--json", "--ticks", &count], more].concat());
            assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
            serde_json::from_slice(&output.stdout).expect("JSON")
        };
        let (recorded, alone) = (ran(&["--record", &path]), ran(&[]));
        assert_eq!(recorded["state_hash"], alone["state_hash"], "{scene}");
        replays.push((path, ticks));
    }
    assert_eq!(replays.len(), 41);
    let files: Vec<&str> = replays.iter().map(|(path, _)| &path[..]).collect();
    let (status, lines) = verify(&files, &[]);
    assert_eq!((status, lines.len()), (0, replays.len()));
    for (line, (path, ticks)) in lines.iter().zip(&replays) {
        assert_eq!((line["file"].as_str(), line["status"].as_str()), (Some(&path[..]), Some("ok")), "{line}");
        assert_eq!((line["ticks"].as_u64(), line["hashes"].as_u64()), (Some(*ticks), Some(*ticks)), "{line}");
        assert!(line["code"].is_null() && line["reason"].is_null() && line["finding"].is_null(), "{line}");
    }
}

#[test]
fn all_that_a_scene_can_do_goes_through_the_recorder() {
    let folder = Folder::new("busy");
    let text = busy("3");
    let replay = folder.record(&folder.write("busy.json", &text), &[]);
    let bytes = fs::read(&replay).expect("a replay");
    let replay = Replay::from_bytes(&bytes, &[]).expect("it is whole");
    assert_eq!(replay.verify(), Ok(()));
    // A run without a recorder has the same hash at every tick.
    let scene = Scene::parse(&text).expect("a scene");
    let (mut run, mut playback, mut commands) = (scene.start::<Fx>().expect("it starts"), replay.play(), 0);
    for tick in 0..100 {
        commands += playback.commands().count();
        assert_eq!(playback.step(), Ok(true));
        run.advance().expect("it goes on");
        assert_eq!(playback.world().state_hash(), run.world().state_hash(), "tick {tick}");
    }
    // By ticks: an impulse; four times force and torque; two additions; an impulse and ten settings of a body; two more; a
    // field; five settings of the world; and four calls.
    assert_eq!((commands, playback.step()), (1 + 4 * 2 + 2 + 11 + 2 + 1 + 5 + 4, Ok(false)));
}

#[test]
fn finer_steps_are_recorded_with_the_forces_that_they_hold() {
    let scene = Scene::parse(&busy("3")).expect("a scene");
    let mut run = scene.start_finer::<Fx>(3).expect("it starts");
    let mut recorder = Recorder::new(run.world(), RecordOptions::default());
    for _ in 0..12 {
        run.advance_by(&mut recorder).expect("it goes on");
    }
    let replay = Replay::from_bytes(&recorder.finish(run.world()), &[]).expect("it is whole");
    assert_eq!((replay.end(), replay.verify()), (36, Ok(())));
    let mut alone = scene.start_finer::<Fx>(3).expect("it starts");
    for _ in 0..12 {
        alone.advance().expect("it goes on");
    }
    assert_eq!(alone.world().state_hash(), run.world().state_hash());
}

#[test]
fn a_changed_byte_is_named_by_tick_moment_body_and_field() {
    let folder = Folder::new("tampered");
    let text = busy("3");
    let bytes = fs::read(folder.record(&folder.write("busy.json", &text), &[])).expect("a replay");
    let scene = Scene::parse(&text).expect("a scene");
    let mut run = scene.start::<Fx>().expect("it starts");
    for _ in 0..5 {
        run.advance().expect("it goes on");
    }
    let (hash, wrong_hash) = (run.world().state_hash(), run.world().state_hash() ^ 1);

    // The lowest bit of the impulse's x is in the first of the last 19 bytes: x and y, no point, frame, wake.
    let push = Order::Apply {
        body: BodyId::from_parts(1, 0),
        action: ForceOrImpulse::Impulse { impulse: vec2(3, 0), point: None },
        options: ApplyOptions::default(),
    };
    let push = push.to_bytes();
    let [at] = starts(&bytes, &push)[..] else { panic!("the push is there once") };
    let x = starts(&push, &fx!(3).to_bits().to_le_bytes())[0];
    let marks = starts(&bytes, &1_234_605_616_436_508_552u64.to_le_bytes());
    assert_eq!(marks.len(), 2, "in both snapshots");
    let hashes = starts(&bytes, &hash.to_le_bytes());
    let ulp_more = "3.00000000023283064365386962890625";
    let cases = [
        (at + x, 2, "calls", "body 1", "calls[0].action.impulse.x", "3", ulp_more),
        (marks[0], 0, "start", "body 0", "user_data", "1234605616436508552", "1234605616436508553"),
        (marks[1], 100, "start", "body 0", "user_data", "1234605616436508552", "1234605616436508553"),
        (hashes[0], 4, "end", "the world", "hash", &hash.to_string(), &wrong_hash.to_string()),
    ];
    for (at, tick, phase, place, field, recorded, value) in cases {
        let (status, line) = verified(&folder, "changed.umbrarep", &flipped(&bytes, at));
        let finding = &line["finding"];
        assert_eq!((status, line["status"].as_str()), (1, Some("tampered")), "{line}");
        assert_eq!((finding["tick"].as_u64(), finding["phase"].as_str()), (Some(tick), Some(phase)), "{line}");
        assert_eq!((finding["owner"].as_str(), finding["field"].as_str()), (Some(place), Some(field)), "{line}");
        let values = (finding["recorded"].as_str(), finding["found"].as_str());
        assert_eq!(values, (Some(recorded), Some(value)), "{line}");
    }
    let changed = folder.write("changed.umbrarep", flipped(&bytes, at + x));
    let output = umbra(&["verify", &changed]);
    let expected = |value: &str| {
        let what = format!(
            "tick 2, calls, body 1, call 1, action.impulse.x: 3 and {value} N·s (differ by 1 ulp, 2.3e-10 N·s)"
        );
        format!("tampered  {changed}  changed after it was recorded: {what} [E405]\n")
    };
    assert_eq!(self::text(&output.stdout), expected("3.00000000023"));
    assert_eq!(self::text(&umbra(&["verify", "--exact", &changed]).stdout), expected(ulp_more));
    assert_eq!(self::text(&output.stderr), "1 of 1 file is not verified\n");
}

#[test]
fn each_way_to_be_wrong_has_its_status() {
    let folder = Folder::new("status");
    let bytes = fs::read(folder.record(&folder.write("busy.json", busy("3")), &[])).expect("a replay");
    let status = |name: &str, bytes: &[u8]| {
        let (status, line) = verified(&folder, name, bytes);
        let codes: &[&str] = match line["status"].as_str() {
            Some("ok") => &[],
            Some("cut_off") => &["E404"],
            Some("physics_version") => &["E403"],
            Some("diverged") => &["E420"],
            _ => &["E401", "E402", "E406"],
        };
        assert!(line["code"].as_str().map_or(codes.is_empty(), |code| codes.contains(&code)), "{line}");
        (status, line["status"].as_str().expect("a text").to_owned(), line["ticks"].as_u64().expect("a number"))
    };
    let is = |exit: i32, name: &str, ticks: u64| (exit, name.to_owned(), ticks);
    assert_eq!(status("whole", &bytes), is(0, "ok", 100));
    // The last chunk, and the one before; then the ticks from 64 on; then all of it but the first bytes.
    assert_eq!(status("cut", &bytes[..bytes.len() - 1]), is(1, "cut_off", 100));
    let last = *starts(&bytes, b"TICK").last().expect("ticks");
    assert_eq!(status("cut", &bytes[..last + 100]), is(1, "cut_off", 64));
    assert_eq!(status("cut", &bytes[..11]), is(1, "cut_off", 0));
    assert_eq!(status("cut", &bytes[..7]), is(2, "malformed", 0));
    assert_eq!(status("empty", b""), is(2, "malformed", 0));
    assert_eq!(status("longer", &[&bytes[..], b"x"].concat()), is(2, "malformed", 0));
    let mut format = bytes.clone();
    format[8] = 99;
    assert_eq!(status("format", &format), is(2, "malformed", 0));
    assert_eq!(status("resealed", &resealed(&bytes, |_| {})), is(0, "ok", 100));
    let law = resealed(&bytes, |head| head[..4].copy_from_slice(&(PHYSICS_VERSION + 1).to_le_bytes()));
    assert_eq!(status("law", &law), is(2, "physics_version", 0));
    let strayed = strayed(RecordOptions { hash_every: 1, snapshot_every: 8 });
    assert_eq!(status("strayed", &strayed), is(1, "diverged", 41));
    // A divergence in the part that is there counts more than the missing rest.
    assert_eq!(status("strayed-and-cut", &strayed[..strayed.len() - 1]), is(1, "diverged", 41));
    let (exit, lines) = verify(&[&folder.path("none")], &[]);
    assert_eq!((exit, lines[0]["status"].as_str()), (2, Some("unreadable")));
}

#[test]
fn a_run_that_went_another_way_is_named_by_the_next_snapshot() {
    let folder = Folder::new("strayed");
    for (hash_every, snapshot_every, hash_tick, tick) in [(1, 8, 41, 47), (16, 0, 48, 99), (16, 50, 48, 49)] {
        let bytes = strayed(RecordOptions { hash_every, snapshot_every });
        let (status, line) = verified(&folder, "strayed.umbrarep", &bytes);
        assert_eq!((status, line["status"].as_str()), (1, Some("diverged")), "{line}");
        assert_eq!(line["hashes"].as_u64(), Some((hash_tick - 1) / u64::from(hash_every)), "{line}");
        let finding = &line["finding"];
        assert_eq!((finding["tick"].as_u64(), finding["phase"].as_str()), (Some(tick), Some("end")), "{line}");
        assert_eq!((finding["owner"].as_str(), finding["field"].as_str()), (Some("body 1"), Some("position.y")));
        // 2 m/s for so many ticks: the exact place, with what is below the ulp.
        let place = finding["recorded"].as_str().and_then(|y| y.parse::<f64>().ok()).expect("a number");
        assert!((place - 2.0 * (tick + 1 - 40) as f64 / 60.0).abs() < 1e-9, "{line}");
        assert_eq!(finding["found"].as_str(), Some("0"), "{line}");
        let reason = line["reason"].as_str().expect("a reason");
        assert!(reason.starts_with(&format!("at tick {hash_tick} the hash is ")), "{reason}");
    }
}

#[test]
fn files_come_in_the_order_given_whatever_is_done_at_once() {
    let folder = Folder::new("jobs");
    let long = folder.record("scenes/spring-net.json", &["--ticks", "60"]);
    let short = folder.record("scenes/kepler.json", &["--ticks", "16"]);
    let bad = folder.write("bad.umbrarep", strayed(RecordOptions::default()));
    let files = [&long[..], &bad, &short, &short, &long, &short];
    let expected = ["ok", "diverged", "ok", "ok", "ok", "ok"];
    for jobs in ["1", "4", "1024"] {
        let (status, lines) = verify(&files, &["--jobs", jobs]);
        assert_eq!(status, 1, "{jobs} at once");
        let statuses: Vec<_> = lines.iter().map(|line| (&line["file"], &line["status"])).collect();
        let wanted: Vec<_> =
            files.iter().zip(expected).map(|(file, is)| (Value::from(*file), Value::from(is))).collect();
        assert_eq!(statuses, wanted.iter().map(|(file, is)| (file, is)).collect::<Vec<_>>(), "{jobs} at once");
    }
    // The highest status counts, wherever it stands.
    assert_eq!(verify(&[&folder.path("none"), &bad, &short], &[]).0, 2);
    assert_eq!(verify(&[&bad, &folder.path("none")], &[]).0, 2);
    assert_eq!(verify(&[&short, &long], &[]).0, 0);
    let output = umbra(&["verify", &bad, &short]);
    let lines = text(&output.stdout);
    let ok = lines.lines().nth(1).expect("two lines");
    let factor = ok
        .strip_prefix(&format!("ok  {short}  16 ticks, 16 hashes, "))
        .and_then(|rest| rest.strip_suffix("× real time"));
    assert!(
        factor.is_some_and(|factor| factor.replace(',', "").parse::<f64>().is_ok_and(|number| number > 0.0)),
        "{ok}"
    );
    assert_eq!(text(&output.stderr), "1 of 2 files is not verified\n", "no progress but on a terminal");
}

#[test]
fn how_much_is_recorded_can_be_chosen() {
    let folder = Folder::new("chosen");
    let every = |more: &[&str]| {
        let replay = folder.record("scenes/kepler.json", &[&["--ticks", "100"], more].concat());
        let (status, lines) = verify(&[&replay], &[]);
        assert_eq!((status, lines[0]["ticks"].as_u64()), (0, Some(100)));
        let bytes = fs::read(&replay).expect("a replay");
        (lines[0]["hashes"].as_u64(), starts(&bytes, b"SNAP").len())
    };
    assert_eq!(every(&[]), (Some(100), 2));
    assert_eq!(every(&["--hash-every", "16"]), (Some(6), 2));
    assert_eq!(every(&["--hash-every", "1000", "--snapshot-every", "25"]), (Some(0), 5));
    assert_eq!(every(&["--snapshot-every", "0"]), (Some(100), 2));
    let never = folder.path("never.umbrarep");
    for arguments in [
        &["run", "scenes/kepler.json", "--hash-every", "16"][..],
        &["run", "scenes/kepler.json", "--snapshot-every", "16"],
        &["run", "scenes/kepler.json", "--record", &never, "--hash-every", "0"],
        &["run", "scenes/kepler.json", "--record", &never, "--scalar", "f64"],
        &["run", "scenes/kepler.json", "--record", &never, "--scalar", "f32"],
        &["run", "scenes/kepler.json", "--record", &folder.path("no/such/folder")],
        &["verify"],
        &["verify", "--jobs", "0", &never],
        &["diff", &never],
    ] {
        let output = umbra(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(!output.stderr.is_empty() && output.stdout.is_empty(), "{arguments:?}");
    }
    assert!(!Path::new(&never).exists(), "nothing is begun that cannot be done");
}
