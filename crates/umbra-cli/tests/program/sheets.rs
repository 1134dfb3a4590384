//! Tables and pictures of scenes and of replays, and files that are opened.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use umbra_physics::{BodyDef, Inputs, RecordOptions, Recorder, World, WorldDef, vec2};

/// A folder of a test's own; it goes when the test is over.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{}-sheets-{name}", std::process::id()));
        fs::create_dir_all(&path).expect("a folder");
        Self(path)
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        fs::write(self.0.join(name), bytes).expect("a file");
        self.0.join(name)
    }

    fn read(&self, name: &str) -> String {
        fs::read_to_string(self.0.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// The program in this folder, with its arguments in one text.
    fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_umbra"));
        command.current_dir(&self.0).args(arguments.split(' '));
        command
    }

    fn umbra(&self, arguments: &str) -> Output {
        self.command(arguments).output().expect("the program starts")
    }

    /// Runs the program, which succeeds and says this on the standard error.
    fn says(&self, arguments: &str) -> String {
        let output = self.umbra(arguments);
        let said = String::from_utf8(output.stderr).expect("UTF-8");
        assert_eq!(output.status.code(), Some(0), "{arguments}: {said}");
        said
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Bodies that come, go, and have commas in their names.
const SCENE: &str = r#"{"ticks": 40, "gravity": [0, -10], "bodies": [
    {"name": "a, b", "velocity": [1, 2], "colliders": [{"shape": {"circle": {"radius": 1}}}]},
    {"name": "floor", "kind": "static", "position": [0, -9], "colliders": [{"shape": {"rectangle": {"width": 8, "height": 1}}}]}],
    "inputs": [{"at": 5, "body": "a, b", "do": "remove"},
        {"at": 6, "add": {"name": "c", "position": [3, 0], "velocity": [0, 3], "colliders": [{"shape": {"circle": {"radius": 1}}}]}}]}"#;

#[test]
fn a_replay_has_the_table_and_the_picture_of_its_scene() {
    let folder = Folder::new("replay");
    folder.write("s.json", SCENE);
    folder.says("run s.json --csv s.csv --plot s.svg --record r.umbrarep");
    folder.says("view r.umbrarep --csv r.csv --plot r.svg --out r.html");
    assert_eq!(folder.read("r.csv"), folder.read("s.csv"));
    assert!(!folder.read("r.csv").contains("\n6,\"a, b\",") && folder.read("r.csv").contains("\n5,\"a, b\","));
    assert!(folder.read("r.csv").contains("\n7,c,3,"));
    let picture = folder.read("s.svg");
    assert!(picture.contains(">Scene</text>") && picture.contains(">c</text>") && picture.contains(">a, b</text>"));
    assert_eq!(folder.read("r.svg").replace(">r.umbrarep</text>", ">Scene</text>"), picture);
    // Each alone, from a scene as well; in part.
    folder.says("view s.json --plot again.svg");
    assert_eq!(folder.read("again.svg"), picture);
    folder.says("view r.umbrarep --csv some.csv --every 20 --ticks 30");
    let rows = |name: &str, is_kept: &dyn Fn(&str) -> bool| -> Vec<String> {
        folder.read(name).lines().filter(|line| is_kept(line)).map(str::to_owned).collect()
    };
    let is_kept = |line: &str| ["tick,", "0,", "20,"].iter().any(|start| line.starts_with(start));
    assert_eq!(rows("some.csv", &|_| true), rows("s.csv", &is_kept));
    assert_eq!(rows("some.csv", &|_| true).len(), 1 + 2 + 2);
    for wrong in ["view r.umbrarep", "view r.umbrarep --every 2", "view r.umbrarep --csv x.csv --contacts"] {
        let output = folder.umbra(wrong);
        assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{wrong}");
    }
    assert!(!folder.0.join("x.csv").exists());
    let output = folder.umbra("view r.umbrarep --csv r.umbrarep");
    assert!(String::from_utf8_lossy(&output.stderr).starts_with("r.umbrarep: cannot write: this is an input"));
}

#[test]
fn a_replay_without_names_calls_bodies_by_their_handles_and_ends_where_it_parts() {
    let folder = Folder::new("nameless");
    let mut world = World::new(WorldDef::default()).expect("a world");
    // It begins at tick 3.
    (0..3).for_each(|_| _ = world.step());
    let body = world.add_body(BodyDef { velocity: vec2(60, 0), ..BodyDef::dynamic() }).expect("room");
    let mut recorder = Recorder::new(&world, RecordOptions::default());
    for tick in 3..20 {
        if tick == 10 {
            // Past the recorder.
            world.set_velocity(body, vec2(0, 60)).expect("it moves");
        }
        recorder.step(&mut world, &Inputs::new());
    }
    folder.write("r.umbrarep", recorder.finish(&world));
    let said = folder.says("view r.umbrarep --csv r.csv --plot r.svg");
    assert!(said.starts_with("r.umbrarep: at tick 11 the hash is "), "{said}");
    let table = folder.read("r.csv");
    let rows: Vec<&str> = table.lines().skip(1).collect();
    assert_eq!(
        (rows[0], rows.len()),
        ("3,body 0,0,0,0,60,0,0", 9),
        "ticks 3 to 11, the one at which it parts with it: {table}"
    );
    assert!(rows[8].starts_with("11,body 0,8"), "{table}");
    assert!(folder.read("r.svg").contains("1 body, 0.183 s in steps of 1/60 s"), "{}", folder.read("r.svg"));
}

/// Bodies that calls lead in each tick, and put elsewhere at tick 10.
const LED: &str = r#"{"ticks": 30, "sleep_after": null, "bodies": [
    {"name": "far", "velocity": [6, 0], "colliders": [{"shape": {"circle": {"radius": 0.5}}}]},
    {"name": "near", "position": [0, 5], "velocity": [6, 0], "colliders": [{"shape": {"circle": {"radius": 0.5}}}]},
    {"name": "turned", "position": [0, 10], "velocity": [600, 0], "colliders": [{"shape": {"circle": {"radius": 0.5}}}]}],
    "inputs": [{"at": 10, "body": "far", "set": {"position": [20, 0]}},
        {"at": 10, "body": "near", "set": {"position": [1.5, 5]}},
        {"from": 1, "to": 29, "body": "turned", "set": {"angle": 1}}]}"#;

#[test]
fn a_way_has_a_gap_where_a_call_put_the_body_elsewhere() {
    let folder = Folder::new("gaps");
    folder.write("s.json", LED);
    folder.says("run s.json --plot s.svg --record r.umbrarep");
    let picture = folder.read("s.svg");
    // The ways have the width of those of few bodies.
    let ways: Vec<&str> = picture.split('<').filter(|part| part.contains("stroke-width=\"1.6\"")).collect();
    assert_eq!(ways.len(), 4, "{ways:#?}");
    folder.says("view r.umbrarep --plot r.svg --out r.html");
    assert_eq!(folder.read("r.svg").replace(">r.umbrarep</text>", ">Scene</text>"), picture);
    let page = folder.read("r.html");
    let jumps = |name: &str| {
        let body = page.split(&format!("\"{name}\",")).nth(1).expect("a body");
        body.split("]],").nth(1).and_then(|rest| rest.split(']').next()).expect("a list").to_owned()
    };
    assert_eq!(["far", "near", "turned"].map(jumps), ["[11", "[", "["]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_page_or_a_picture_is_opened_by_the_program_of_the_system() {
    use std::os::unix::fs::PermissionsExt;
    use std::time::{Duration, Instant};
    let folder = Folder::new("open");
    folder.write("s.json", SCENE);
    fs::create_dir(folder.0.join("bin")).expect("a folder");
    let program = folder.write("bin/xdg-open", "#!/bin/sh\n[ -s \"$1\" ] && echo \"$1\" >> opened\n");
    fs::set_permissions(program, PermissionsExt::from_mode(0o755)).expect("its owner may");
    let opened = |arguments: &str, expected: &str| {
        let _ = fs::remove_file(folder.0.join("opened"));
        let path = format!("{}:/usr/bin:/bin", folder.0.join("bin").display());
        let output = folder.command(arguments).env("PATH", path).output().expect("the program starts");
        assert_eq!(output.status.code(), Some(0), "{arguments}: {}", String::from_utf8_lossy(&output.stderr));
        let began = Instant::now();
        while !fs::read_to_string(folder.0.join("opened")).is_ok_and(|text| text == expected) {
            assert!(
                began.elapsed() < Duration::from_secs(30),
                "{arguments}: {:?}",
                fs::read_to_string(folder.0.join("opened"))
            );
            std::thread::sleep(Duration::from_millis(5));
        }
    };
    opened("run s.json --plot s.svg --open", "./s.svg\n");
    opened("view s.json --out=-x.html --open", "./-x.html\n");
    let absolute = folder.0.join("y.html");
    opened(&format!("view s.json --out {} --open", absolute.display()), &format!("{}\n", absolute.display()));
    for wrong in ["run s.json --open", "run s.json --csv x.csv --open", "view s.json --csv x.csv --open"] {
        assert_eq!(folder.umbra(wrong).status.code(), Some(2), "{wrong}");
    }
    for wrong in ["run s.json --plot - --open", "view s.json --out /dev/null --open"] {
        let output = folder.umbra(wrong);
        assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{wrong}");
        assert!(String::from_utf8_lossy(&output.stderr).starts_with("--open needs a file: "), "{wrong}");
    }
    // Where there is none, it is said; the picture is written.
    let output = folder.command("run s.json --plot z.svg --open").env("PATH", "").output().expect("the program starts");
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).starts_with("z.svg: cannot open: "));
    assert!(folder.read("z.svg").starts_with("<svg"));
}
