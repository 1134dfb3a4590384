//! The files that the program writes: whole or not at all, never over what it reads, and nothing that a terminal would obey.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::seeds::is_short;

/// A folder of a test's own; it goes when the test is over.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{}-outputs-{name}", std::process::id()));
        fs::create_dir_all(&path).expect("a folder");
        Self(path)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path(name);
        fs::write(&path, bytes).expect("a file");
        path
    }

    fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).expect("a file")
    }

    /// The program, started in this folder.
    fn command<S: AsRef<OsStr>>(&self, arguments: impl IntoIterator<Item = S>) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_umbra"));
        command.current_dir(&self.0).stdin(Stdio::null()).args(arguments);
        command
    }

    fn umbra(&self, arguments: &[&str]) -> Output {
        self.command(arguments).output().expect("the program starts")
    }

    /// The names in the folder.
    fn names(&self) -> Vec<String> {
        let name = |entry: fs::DirEntry| entry.file_name().to_string_lossy().into_owned();
        let mut names: Vec<String> = fs::read_dir(&self.0).expect("it is there").flatten().map(name).collect();
        names.sort();
        names
    }

    /// The outputs that were not finished.
    fn parts(&self) -> Vec<PathBuf> {
        let is_part = |name: &String| name.starts_with("umbra-") && name.ends_with(".part");
        self.names().into_iter().filter(is_part).map(|name| self.path(&name)).collect()
    }

    /// Asserts that the program fails with status 2, prints nothing, leaves the folder as it was, and says this.
    fn refuses(&self, arguments: &[&str], said: &str) {
        let content =
            |name: &String| Some(self.path(name)).filter(|file| file.is_file()).and_then(|file| fs::read(file).ok());
        let contents = || -> Vec<_> { self.names().into_iter().map(|name| (content(&name), name)).collect() };
        let before = contents();
        let output = self.umbra(arguments);
        let error = text(&output.stderr);
        assert_eq!((output.status.code(), &output.stdout[..]), (Some(2), &b""[..]), "{arguments:?}: {error}");
        assert!(error.starts_with(said), "{arguments:?}: {error}");
        assert_eq!(error.lines().count(), 1, "{arguments:?}: {error}");
        assert!(contents() == before, "{arguments:?} changed a file");
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

const SCENE: &str = r#"{"bodies": [{"name": "a", "velocity": [1, 0]}], "ticks": 9}"#;

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("UTF-8")
}

fn succeeds(output: &Output) {
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
}

/// Waits for a child, for a minute at most.
fn status(child: &mut Child) -> Option<i32> {
    let began = Instant::now();
    loop {
        match child.try_wait().expect("a child") {
            Some(status) => return status.code(),
            None if began.elapsed() > Duration::from_secs(60) => {
                let _ = child.kill();
                panic!("the program does not end");
            }
            None => thread::sleep(Duration::from_millis(5)),
        }
    }
}

#[test]
fn an_output_never_goes_over_an_input() {
    let folder = Folder::new("over-input");
    folder.write("a.json", SCENE);
    fs::create_dir(folder.path("below")).expect("a folder");
    fs::hard_link(folder.path("a.json"), folder.path("hard")).expect("a link");
    let mut names = vec!["a.json".to_owned(), "./a.json".into(), "below/../a.json".into(), "hard".into()];
    names.push(folder.path("a.json").to_str().expect("UTF-8").into());
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("a.json", folder.path("soft")).expect("a link");
        std::os::unix::fs::symlink(".", folder.path("here")).expect("a link");
        names.extend(["soft".into(), "here/soft".into()]);
    }
    for name in &names {
        let said = format!("{name}: cannot write: this is an input; choose another path [E805]");
        for (task, option) in [("view", "--out"), ("run", "--csv"), ("run", "--plot"), ("run", "--record")] {
            folder.refuses(&[task, "a.json", option, name], &said);
        }
        // And the other way round.
        folder.refuses(&["run", name, "--record", "a.json"], "a.json: cannot write: this is an input");
    }
    succeeds(&folder.umbra(&["run", "a.json", "--record", "a.umbrarep"]));
    folder.refuses(&["view", "a.umbrarep", "--out", "a.umbrarep"], "a.umbrarep: cannot write: this is an input");
    // The standard output, to which the shell appends.
    let before = folder.read("a.json");
    let appended = fs::OpenOptions::new().append(true).open(folder.path("a.json")).expect("a file");
    let output = folder.command(["run", "a.json"]).stdout(appended).output().expect("the program starts");
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).starts_with("standard output: cannot write: this is an input"));
    assert_eq!(folder.read("a.json"), before);
}

#[test]
fn two_outputs_never_go_to_one_file() {
    let folder = Folder::new("one-file");
    folder.write("s.json", SCENE);
    fs::hard_link(folder.write("old", "old"), folder.path("hard")).expect("a link");
    let mut pairs = vec![("new", "new"), ("new", "./new"), ("old", "old"), ("old", "hard"), ("old", "./hard")];
    #[cfg(unix)]
    {
        for (to, link) in [("old", "soft"), ("new", "dangling"), (".", "here")] {
            std::os::unix::fs::symlink(to, folder.path(link)).expect("a link");
        }
        pairs.extend([("soft", "hard"), ("new", "dangling"), ("dangling", "dangling"), ("here/new", "new")]);
        pairs.push(("/dev/stdout", "/dev/fd/1"));
    }
    for (a, b) in pairs {
        let said = |file: &str| format!("{file}: cannot write: this is where another output goes");
        // They are taken in the order of the help.
        folder.refuses(&["run", "s.json", "--csv", a, "--plot", b], &said(b));
        folder.refuses(&["run", "s.json", "--record", a, "--csv", b], &said(a));
    }
    // The standard output is one as well.
    let out = fs::File::create(folder.path("out")).expect("a file");
    let output = folder.command(["run", "s.json", "--csv", "out"]).stdout(out).output().expect("the program starts");
    assert_eq!((output.status.code(), folder.read("out")), (Some(2), Vec::new()));
    assert!(text(&output.stderr).starts_with("out: cannot write: this is where another output goes"));
}

#[test]
fn a_name_that_ends_as_those_of_another_format_do_is_refused() {
    let folder = Folder::new("ends");
    folder.write("s.json", SCENE);
    for (arguments, name, said) in [
        (&["run", "s.json", "--plot"][..], "b.png", "a picture in SVG: write b.svg, which browsers show"),
        (&["view", "s.json", "--plot"], "below.d/b.JPEG", "a picture in SVG: write below.d/b.svg, which browsers show"),
        (&["run", "s.json", "--csv"], "b.xlsx", "a table in CSV: write b.csv [E809]"),
        (&["view", "s.json", "--csv"], "b.json", "a table in CSV: write b.csv [E809]"),
        (&["view", "s.json", "--out"], "b.svg", "a page in HTML: write b.html [E809]"),
        (&["scenes", "pile", "--out"], "pile.umbrarep", "JSON: write pile.json [E809]"),
    ] {
        fs::create_dir_all(folder.path("below.d")).expect("a folder");
        folder.refuses(&[arguments, &[name]].concat(), &format!("{name}: cannot write: this is {said}"));
    }
    // Without an end, in capitals, and a replay as one likes.
    succeeds(&folder.umbra(&["run", "s.json", "--plot", "b.SVG", "--csv", "below.d/b", "--record", "b.match"]));
    succeeds(&folder.umbra(&["view", "b.match", "--out", "b.htm", "--csv", "b.txt"]));
    succeeds(&folder.umbra(&["scenes", "pile", "--out", "pile"]));
}

#[test]
fn unwritable_outputs_are_reported_before_the_work() {
    let folder = Folder::new("cannot");
    folder.write("s.json", SCENE);
    fs::create_dir(folder.path("below")).expect("a folder");
    folder.write("file", "");
    for name in ["below", "below/", ".", "no/such/folder/x", "file/x", "new/", "new/."] {
        let said = format!("{name}: cannot write: ");
        for option in ["--csv", "--plot", "--record"] {
            // As long as it lasts: it must not begin.
            folder.refuses(&["run", "s.json", "--ticks", "4000000000", option, name], &said);
        }
        folder.refuses(&["view", "s.json", "--ticks", "4000000000", "--out", name], &said);
    }
}

#[cfg(unix)]
#[test]
fn protected_files_stay() {
    use std::os::unix::fs::PermissionsExt;
    let folder = Folder::new("protected");
    folder.write("s.json", SCENE);
    let closed = folder.path("closed");
    fs::create_dir(&closed).expect("a folder");
    folder.write("closed/old", "old");
    let old = folder.write("old", "old");
    fs::set_permissions(&old, PermissionsExt::from_mode(0o444)).expect("its owner may");
    fs::set_permissions(&closed, PermissionsExt::from_mode(0o555)).expect("its owner may");
    // For root permissions protect nothing: without that power it is as any user.
    let is_root = fs::OpenOptions::new().write(true).open(&old).is_ok();
    let setpriv = ["--bounding-set=-dac_override,-dac_read_search", "--inh-caps=-dac_override,-dac_read_search"];
    let umbra = |name: &str| {
        let arguments = ["run", "s.json", "--csv", name];
        if !is_root {
            return folder.command(arguments).output();
        }
        let mut command = Command::new("setpriv");
        command.current_dir(&folder.0).args(setpriv).arg(env!("CARGO_BIN_EXE_umbra")).args(arguments).output()
    };
    if is_root && !umbra("new").is_ok_and(|output| output.status.success()) {
        println!("SKIPPED: for this user nothing is protected, and there is no setpriv");
    } else {
        for name in ["old", "closed/old", "closed/new"] {
            let output = umbra(name).expect("the program starts");
            let error = text(&output.stderr);
            assert_eq!(output.status.code(), Some(2), "{error}");
            assert!(error.starts_with(&format!("{name}: cannot write: ")), "{error}");
        }
        assert_eq!((folder.read("old"), folder.read("closed/old")), (b"old".into(), b"old".into()));
        assert!(!folder.path("closed/new").exists());
    }
    fs::set_permissions(&closed, PermissionsExt::from_mode(0o755)).expect("its owner may");
}

#[cfg(unix)]
#[test]
fn permissions_are_those_of_the_old_file_or_what_the_umask_leaves() {
    use std::os::unix::fs::PermissionsExt;
    let folder = Folder::new("permissions");
    folder.write("s.json", SCENE);
    let mode = |name: &str| fs::metadata(folder.path(name)).expect("it is there").permissions().mode() & 0o7777;
    for (umask, expected) in [("022", 0o644), ("027", 0o640), ("000", 0o666)] {
        let script = format!("umask {umask}; exec \"$0\" run s.json --csv new-{umask} --record old");
        fs::set_permissions(folder.write("old", "old"), PermissionsExt::from_mode(0o604)).expect("its owner may");
        let mut shell = Command::new("sh");
        let output = shell.current_dir(&folder.0).args(["-c", &script, env!("CARGO_BIN_EXE_umbra")]).output();
        succeeds(&output.expect("a shell"));
        assert_eq!((mode(&format!("new-{umask}")), mode("old")), (expected, 0o604), "{umask}");
        assert!(folder.read("old").starts_with(b"UMBRAREP"));
    }
}

#[cfg(unix)]
#[test]
fn a_link_stays_one_and_what_it_leads_to_is_written() {
    use std::os::unix::fs::symlink;
    let folder = Folder::new("links");
    folder.write("s.json", SCENE);
    fs::create_dir(folder.path("below")).expect("a folder");
    folder.write("below/old", "old");
    for (to, link) in [("below/old", "soft"), ("soft", "softer"), ("below/new", "dangling"), ("round", "round")] {
        symlink(to, folder.path(link)).expect("a link");
    }
    let is_link = |name: &str| fs::symlink_metadata(folder.path(name)).expect("it is there").is_symlink();
    for (name, to) in [("softer", "below/old"), ("dangling", "below/new")] {
        succeeds(&folder.umbra(&["run", "s.json", "--record", name]));
        assert!(is_link(name) && !is_link(to), "{name}");
        assert!(folder.read(to).starts_with(b"UMBRAREP"), "{name}");
    }
    folder.refuses(&["run", "s.json", "--record", "round"], "round: cannot write: ");
    // What else has the file under another name keeps what it had.
    let old = folder.write("old", "old");
    fs::hard_link(&old, folder.path("hard")).expect("a link");
    succeeds(&folder.umbra(&["run", "s.json", "--record", "old"]));
    assert!(folder.read("old").starts_with(b"UMBRAREP"));
    assert_eq!(folder.read("hard"), b"old");
    assert_eq!(folder.parts(), [""; 0].map(PathBuf::from));
}

#[test]
fn a_run_that_fails_leaves_the_old_files() {
    let folder = Folder::new("fails");
    folder.write("s.json", SCENE);
    let fails = r#"{"bodies": [{"name": "a"}], "ticks": 90, "inputs": [
        {"from": 80, "to": 81, "body": "a", "impulse": [6e5, 0]}]}"#;
    folder.write("fails.json", fails);
    let outputs = ["--csv", "t.csv", "--plot", "p.svg", "--record", "r.umbrarep"];
    succeeds(&folder.umbra(&[&["run", "s.json"], &outputs[..]].concat()));
    let read = || ["t.csv", "p.svg", "r.umbrarep"].map(|name| folder.read(name));
    let before = read();
    let output = folder.umbra(&[&["run", "fails.json"], &outputs[..]].concat());
    let error = text(&output.stderr);
    assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{error}");
    assert_eq!(read(), before);
    // Of the recording there is what went before, and it is said where.
    let parts = folder.parts();
    let [part] = &parts[..] else { panic!("{parts:?}") };
    let said = "r.umbrarep: not written; what there is of it is left in ";
    let left = error.lines().next().and_then(|line| line.strip_prefix(said)).unwrap_or_else(|| panic!("{error}"));
    assert_eq!(fs::canonicalize(left).expect("it is there"), fs::canonicalize(part).expect("it is there"));
    let verdict = folder.umbra(&["verify", "--json", left]);
    let line: Value = serde_json::from_slice(&verdict.stdout).expect("JSON");
    assert_eq!((line["status"].as_str(), line["ticks"].as_u64()), (Some("cut_off"), Some(64)));
    assert!(error.contains("at tick 81: out of range"), "{error}");
}

#[test]
fn a_recording_that_is_killed_leaves_the_old_file_and_what_there_is() {
    let folder = Folder::new("killed");
    folder.write("s.json", SCENE);
    succeeds(&folder.umbra(&["run", "s.json", "--record", "r.umbrarep"]));
    let before = folder.read("r.umbrarep");
    let endless = ["run", "s.json", "--ticks", "4000000000", "--record", "r.umbrarep"];
    let mut child = folder.command(endless).stdout(Stdio::null()).spawn().expect("the program starts");
    let began = Instant::now();
    let has_some = |part: &PathBuf| fs::metadata(part).is_ok_and(|metadata| metadata.len() > 100_000);
    while !folder.parts().iter().any(has_some) {
        assert!(began.elapsed() < Duration::from_secs(60), "nothing is recorded");
        assert!(child.try_wait().expect("a child").is_none(), "it ended");
        thread::sleep(Duration::from_millis(5));
    }
    child.kill().expect("it runs");
    child.wait().expect("it ends");
    assert!(folder.read("r.umbrarep") == before, "the old recording is as it was");
    let parts = folder.parts();
    let [part] = &parts[..] else { panic!("{parts:?}") };
    let output = folder.umbra(&["verify", "--json", part.to_str().expect("UTF-8")]);
    let line: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!((output.status.code(), line["status"].as_str()), (Some(1), Some("cut_off")));
    assert!(line["ticks"].as_u64().is_some_and(|ticks| ticks > 1000), "{line}");
    // The next one does as ever.
    succeeds(&folder.umbra(&["run", "s.json", "--record", "r.umbrarep"]));
}

#[test]
fn two_runs_at_once_leave_one_whole_file() {
    let folder = Folder::new("at-once");
    let names = ["one", "two"];
    for (i, name) in names.into_iter().enumerate() {
        folder.write(&format!("{name}.json"), SCENE.replace("[1, 0]", &format!("[{i}, 0]")));
    }
    let arguments = |name: &str, to: &str| {
        let [csv, record] = ["csv", "umbrarep"].map(|kind| format!("{to}.{kind}"));
        ["run", &format!("{name}.json"), "--ticks", "3000", "--csv", &csv, "--record", &record].map(str::to_owned)
    };
    for name in names {
        succeeds(&folder.command(arguments(name, name)).output().expect("the program starts"));
    }
    for round in 0..5 {
        let begin = |name| folder.command(arguments(name, "both")).stdout(Stdio::null()).spawn().expect("it starts");
        let mut children = [names, names].concat().into_iter().map(begin).collect::<Vec<_>>();
        children.iter_mut().for_each(|child| assert_eq!(status(child), Some(0)));
        for kind in ["csv", "umbrarep"] {
            let both = folder.read(&format!("both.{kind}"));
            assert!(names.iter().any(|name| folder.read(&format!("{name}.{kind}")) == both), "round {round}: {kind}");
        }
    }
    assert_eq!(folder.parts(), [""; 0].map(PathBuf::from));
}

#[cfg(unix)]
#[test]
fn pipes_and_devices_are_written_to_as_they_are() {
    let folder = Folder::new("pipes");
    folder.write("s.json", SCENE);
    succeeds(&folder.umbra(&["run", "s.json", "--csv", "table", "--record", "replay"]));
    let (table, replay) = (folder.read("table"), folder.read("replay"));
    let fifo = folder.path("fifo");
    assert!(Command::new("mkfifo").arg(&fifo).status().expect("mkfifo").success());
    let reader = thread::spawn({
        let fifo = fifo.clone();
        move || fs::read(fifo).expect("what comes")
    });
    // It is read from one, too: to look at it must not close it.
    let mut child =
        folder.command(["run", "s.json", "--record", "fifo"]).stdout(Stdio::null()).spawn().expect("starts");
    assert_eq!((status(&mut child), reader.join().expect("it reads") == replay), (Some(0), true));
    let writer = thread::spawn({
        let fifo = fifo.clone();
        move || fs::write(fifo, SCENE)
    });
    let input = folder.umbra(&["run", "fifo", "--csv", "again"]);
    succeeds(&input);
    writer.join().expect("it writes").expect("it is read");
    assert_eq!(folder.read("again"), table);
    // Nothing of it became a file.
    let kind = fs::metadata(&fifo).expect("it is there").file_type();
    assert!(std::os::unix::fs::FileTypeExt::is_fifo(&kind));
    folder
        .refuses(&["run", "s.json", "--csv", "fifo", "--record", "fifo"], "fifo: cannot write: this is where another");

    // What the program prints by itself goes elsewhere.
    let output = folder.umbra(&["run", "s.json", "--csv", "/dev/stdout"]);
    succeeds(&output);
    assert!(output.stdout == table && text(&output.stderr).contains("state hash"));
    let out = fs::File::create(folder.path("out")).expect("a file");
    let mut both = folder.command(["run", "s.json", "--csv", "/dev/stdout", "--plot", "/dev/null"]);
    succeeds(&both.args(["--record", "/dev/null"]).stdout(out).output().expect("the program starts"));
    assert!(folder.read("out") == table);
    assert_eq!(folder.parts(), [""; 0].map(PathBuf::from));
}

/// The program with these bytes on its standard input.
fn fed(folder: &Folder, arguments: &[&str], bytes: &[u8]) -> Output {
    let mut command = folder.command(arguments);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("the program starts");
    std::io::Write::write_all(&mut child.stdin.take().expect("a pipe"), bytes).expect("it reads");
    child.wait_with_output().expect("it ends")
}

#[test]
fn a_dash_is_the_standard_input_and_the_standard_output() {
    let folder = with_replays("dash");
    let replay = folder.read("r.umbrarep");
    succeeds(&folder.umbra(&["run", "s.json", "--csv", "s.csv", "--plot", "s.svg"]));
    succeeds(&folder.umbra(&["view", "r.umbrarep", "--out", "r.html"]));
    let outputs = [("--csv", folder.read("s.csv")), ("--plot", folder.read("s.svg")), ("--record", replay.clone())];
    for (option, expected) in outputs {
        // From a pipe into a pipe; the result is on the standard error.
        let output = fed(&folder, &["run", "-", option, "-"], SCENE.as_bytes());
        succeeds(&output);
        assert!(output.stdout == expected, "{option}");
        assert!(text(&output.stderr).contains("state hash"), "{option}: {}", text(&output.stderr));
    }
    let output = fed(&folder, &["run", "-", "--json", "--record", "-"], SCENE.as_bytes());
    let summary: Value = serde_json::from_slice(&output.stderr).expect("JSON");
    assert!(output.stdout == replay && summary["state_hash"].is_string());
    let page = text(&fed(&folder, &["view", "-", "--out", "-"], &replay).stdout);
    assert_eq!(page.replace("standard input", "r.umbrarep"), text(&folder.read("r.html")));
    let output = fed(&folder, &["verify", "r.umbrarep", "-"], &replay);
    succeeds(&output);
    assert!(text(&output.stdout).lines().nth(1).is_some_and(|line| line.starts_with("ok  standard input  9 ticks")));
    for files in [["-", "other.umbrarep"], ["other.umbrarep", "-"]] {
        let output = fed(&folder, &[&["diff"], &files[..]].concat(), &replay);
        assert_eq!((output.status.code(), text(&output.stdout).contains("velocity.x: ")), (Some(1), true), "{files:?}");
    }
    // It is read once, and written once; and a file of this name is one.
    folder.refuses(&["diff", "-", "-"], "- is given twice: the standard input can be read once");
    folder.refuses(&["verify", "-", "r.umbrarep", "-"], "- is given twice: the standard input can be read once");
    let said = "standard output: cannot write: this is where another output goes";
    folder.refuses(&["run", "s.json", "--csv", "-", "--plot", "-"], said);
    #[cfg(unix)]
    folder.refuses(&["run", "s.json", "--csv", "/dev/stdout", "--plot", "-"], said);
    assert!(!folder.path("-").exists());
    folder.write("-", SCENE);
    succeeds(&folder.umbra(&["run", "./-"]));
    // A file behind the standard input is an input.
    let stdin = fs::File::open(folder.path("s.json")).expect("a file");
    let output = folder.command(["run", "-", "--csv", "s.json"]).stdin(stdin).output().expect("the program starts");
    assert!(text(&output.stderr).starts_with("s.json: cannot write: this is an input"), "{}", text(&output.stderr));
    assert_eq!(folder.read("s.json"), SCENE.as_bytes());
    let output = fed(&folder, &["run", "-"], b"{\"bodys\": []}");
    assert_eq!(text(&output.stderr), "standard input:1: bodys: unknown field: did you mean `bodies`? [E503]\n");
}

#[test]
fn a_file_of_another_kind_is_named_with_what_to_do() {
    let folder = with_replays("kinds");
    let world = umbra_physics::World::new(umbra_physics::WorldDef::default()).expect("a world");
    let mut after = world.clone();
    after.step();
    folder.write("d.umbradmp", umbra_physics::Dump::of_game(&world, |_| (), &after).to_bytes());
    folder.write("w.umbrasnp", world.snapshot().to_bytes());
    let replay = "found a replay: `umbra verify r.umbrarep` runs it again, `umbra view r.umbrarep --out PAGE.html` plays it, and \
        `umbra diff r.umbrarep OTHER` compares it with another one [E804]";
    let dump = "found a desync dump: `umbra diff d.umbradmp OTHER` compares it with the one of another peer [E804]";
    let snapshot = "found a snapshot of a world: `umbra verify --start w.umbrasnp REPLAY` checks that a replay begins with it, and \
        `Snapshot::from_bytes` of the library reads it [E804]";
    folder.write("empty", "");
    let empty = "found an empty file [E804]";
    let either = "a replay or a desync dump of umbra-physics";
    for (arguments, file, expected, found) in [
        (&["run", "r.umbrarep"][..], "r.umbrarep", "a scene", replay),
        (&["run", "d.umbradmp"], "d.umbradmp", "a scene", dump),
        (&["run", "w.umbrasnp"], "w.umbrasnp", "a scene", snapshot),
        (&["view", "d.umbradmp", "--out", "x.html"], "d.umbradmp", "a scene or a replay", dump),
        (&["view", "w.umbrasnp", "--out", "x.html"], "w.umbrasnp", "a scene or a replay", snapshot),
        (&["diff", "r.umbrarep", "w.umbrasnp"], "w.umbrasnp", either, snapshot),
        (&["run", "empty"], "empty", "a scene", empty),
        (&["view", "empty", "--out", "x.html"], "empty", "a scene or a replay", empty),
        (&["diff", "r.umbrarep", "empty"], "empty", either, empty),
        (&["verify", "--limits", "empty", "r.umbrarep"], "empty", "a JSON object with limits", empty),
    ] {
        folder.refuses(arguments, &format!("{file}: expected {expected}, {found}\n"));
    }
    let output = folder.umbra(&["verify", "s.json", "d.umbradmp", "empty"]);
    let expected = "malformed  s.json  expected a replay, found a scene: `umbra run FILE --record REPLAY` makes a replay of it [E401]\n\
        malformed  d.umbradmp  expected a replay, found a desync dump: `umbra diff FILE OTHER` compares it with the one of another \
        peer [E401]\n\
        malformed  empty  expected a replay, found an empty file [E401]\n";
    assert_eq!((output.status.code(), text(&output.stdout)), (Some(2), expected.to_owned()));
}

#[cfg(unix)]
#[test]
fn a_file_that_cannot_be_moved_into_place_is_left_beside_it() {
    let folder = Folder::new("no-place");
    folder.write("s.json", SCENE);
    let fifo = folder.path("fifo");
    assert!(Command::new("mkfifo").arg(&fifo).status().expect("mkfifo").success());
    // It waits for a reader of the table; until then somebody takes the place of the replay.
    let mut command = folder.command(["run", "s.json", "--csv", "fifo", "--record", "r"]);
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("the program starts");
    let began = Instant::now();
    while folder.parts().is_empty() {
        assert!(began.elapsed() < Duration::from_secs(60), "it does not begin");
        thread::sleep(Duration::from_millis(5));
    }
    fs::create_dir(folder.path("r")).expect("a folder");
    fs::read(&fifo).expect("the table");
    assert_eq!(status(&mut child), Some(2));
    let error = text(&child.wait_with_output().expect("it ended").stderr);
    let parts = folder.parts();
    let [part] = &parts[..] else { panic!("{parts:?}") };
    let name = part.file_name().expect("a name").to_str().expect("UTF-8");
    assert!(error.starts_with("r: cannot write: ") && error.contains("; it is left in "), "{error}");
    assert!(error.ends_with(&format!("{name} [E801]\n")), "{error}");
    succeeds(&folder.umbra(&["verify", name]));
}

/// Every way to print something on the standard output, and the status where there is room for it. The self-test, which runs for longer
/// than all the others together, only by night.
fn printing() -> Vec<(Vec<&'static str>, i32)> {
    let lines: [(&str, i32); 20] = [
        ("run s.json", 0),
        ("run s.json --json", 0),
        ("verify r.umbrarep", 0),
        ("verify r.umbrarep --json", 0),
        ("verify r.umbrarep s.json r.umbrarep", 2),
        ("diff r.umbrarep r.umbrarep", 0),
        ("diff r.umbrarep r.umbrarep --json", 0),
        ("diff r.umbrarep other.umbrarep --all", 1),
        ("diff r.umbrarep other.umbrarep --json", 1),
        ("selftest", 0),
        ("selftest --json", 0),
        ("--help", 0),
        ("--version", 0),
        ("help run", 0),
        ("verify -h", 0),
        ("run s.json --record again.umbrarep", 0),
        ("scenes", 0),
        ("scenes kepler", 0),
        ("completions zsh", 0),
        ("man verify", 0),
    ];
    let lines = lines.into_iter().filter(|(line, _)| !is_short() || !line.starts_with("selftest"));
    lines.map(|(line, status)| (line.split(' ').collect(), status)).collect()
}

fn with_replays(name: &str) -> Folder {
    let folder = Folder::new(name);
    folder.write("s.json", SCENE);
    folder.write("other.json", SCENE.replace("[1, 0]", "[2, 0]"));
    succeeds(&folder.umbra(&["run", "s.json", "--record", "r.umbrarep"]));
    succeeds(&folder.umbra(&["run", "other.json", "--record", "other.umbrarep"]));
    folder
}

/// A device on which there is no room.
#[cfg(target_os = "linux")]
fn full() -> fs::File {
    fs::OpenOptions::new().write(true).open("/dev/full").expect("Linux has it")
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_an_error() {
    let folder = with_replays("full");
    for (arguments, _) in printing() {
        let output = folder.command(&arguments).stdout(full()).output().expect("the program starts");
        let error = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {error}");
        assert!(error.starts_with("standard output: cannot write: "), "{arguments:?}: {error}");
        assert_eq!(error.lines().count(), 1, "{arguments:?}: {error}");
    }
    for arguments in ["run s.json --plot", "view s.json --out"] {
        let arguments: Vec<&str> = arguments.split(' ').chain(["/dev/full"]).collect();
        folder.refuses(&arguments, "/dev/full: cannot write: ");
    }
    // A run without end ends there.
    for option in ["--csv", "--record"] {
        let mut command = folder.command(["run", "s.json", "--ticks", "4000000000", option, "/dev/full"]);
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("the program starts");
        assert_eq!(status(&mut child), Some(2), "{option}");
        let error = text(&child.wait_with_output().expect("it ended").stderr);
        assert!(error.starts_with("/dev/full: cannot write: "), "{error}");
    }
    // Nobody can be told: there is the status.
    for (arguments, status) in printing() {
        let output = folder.command(&arguments).stderr(full()).output().expect("the program starts");
        assert_eq!(output.status.code(), Some(status), "{arguments:?}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_file_that_finds_no_room_leaves_the_old_one_and_of_a_recording_what_there_is() {
    let folder = with_replays("no-room");
    fs::rename(folder.path("r.umbrarep"), folder.path("r")).expect("it is there");
    let before = folder.read("r");
    // A limit to the size of files, in blocks of half a kilobyte: it is reached on the way, and by the last write.
    for (option, blocks, ticks) in [("csv", 64, "4000000000"), ("record", 64, "4000000000"), ("record", 4, "90")] {
        let run = format!("run s.json --ticks {ticks} --{option} r");
        // A program that lives to see it.
        let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" {run}");
        let mut shell = Command::new("sh");
        shell.current_dir(&folder.0).args(["-c", &script, env!("CARGO_BIN_EXE_umbra")]);
        let mut child = shell.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("a shell");
        assert_eq!(status(&mut child), Some(2), "{option}");
        let error = text(&child.wait_with_output().expect("it ended").stderr);
        let (warnings, error) = error.trim_end().rsplit_once('\n').unwrap_or(("", error.trim_end()));
        assert!(error.starts_with("r: cannot write: File too large"), "{error}");
        assert!(folder.read("r") == before, "{option}");
        let parts = folder.parts();
        if option == "csv" {
            assert_eq!((warnings, parts), ("", vec![]));
            continue;
        }
        // Of the recording there is what went before, and it is said where.
        let [part] = &parts[..] else { panic!("{parts:?}") };
        let said = "r: not written; what there is of it is left in ";
        let left = warnings.strip_prefix(said).unwrap_or_else(|| panic!("{warnings}"));
        assert_eq!(
            fs::canonicalize(folder.path(left)).expect("it is there"),
            fs::canonicalize(part).expect("it is there")
        );
        let verdict = folder.umbra(&["verify", "--json", left]);
        let line: Value = serde_json::from_slice(&verdict.stdout).expect("JSON");
        assert_eq!(line["status"].as_str(), Some("cut_off"), "{line}");
        assert!(line["ticks"].as_u64().is_some_and(|played| played >= 64), "{line}");
        fs::remove_file(part).expect("it is there");
    }
}

#[test]
fn a_reader_that_stops_early_changes_no_status() {
    let folder = with_replays("reader");
    for (arguments, expected) in printing() {
        let mut command = folder.command(&arguments);
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts");
        drop(child.stdout.take());
        assert_eq!(status(&mut child), Some(expected), "{arguments:?}");
        let error = text(&child.wait_with_output().expect("it ended").stderr);
        assert!(!error.contains("cannot write") && !error.contains("panicked"), "{arguments:?}: {error}");
    }
    assert_eq!(folder.read("again.umbrarep"), folder.read("r.umbrarep"), "its other outputs are whole");
}

/// Colours, a bell, an end of line, a control character of 8 bits, and text that runs the other way.
#[cfg(unix)]
const HOSTILE: &str = "a\u{1b}[31m\u{7}\nok  b\r\u{7f}\u{9b}2J\u{202e}\u{2066}c";

/// Asserts that there is nothing that a terminal obeys, except ends of lines.
#[cfg(unix)]
fn is_plain(bytes: &[u8]) -> bool {
    let acts = |c: char| {
        (c.is_control() && c != '\n')
            || ('\u{202a}'..='\u{202e}').contains(&c)
            || ('\u{2066}'..='\u{2069}').contains(&c)
    };
    !text(bytes).contains(acts)
}

#[cfg(unix)]
#[test]
fn nothing_from_outside_reaches_a_terminal_raw() {
    let folder = with_replays("hostile");
    let name = |kind: &str| format!("{HOSTILE}.{kind}");
    let titled = SCENE.replacen(
        '{',
        "{\"title\": \"T\u{202e}itle\", \"about\": \"A\u{2067}bout\", \"gravity\": [60000, 0], ",
        1,
    );
    let titled = titled.replace("\"a\"", "\"n\u{202d}ame\"").replace("[1, 0]", "[1e6, 0], \"gravity_scale\": 16");
    folder.write(&name("json"), &titled);
    folder.write(&name("broken"), "{\"bo\u{9b}\u{202e}dy\": 1}");
    folder.write(&name("bodies"), "{\"inputs\": [{\"at\": 1, \"body\": \"b\u{202e}\\u009b\", \"torque\": 1}]}");
    let replay = folder.read("r.umbrarep");
    folder.write(&name("umbrarep"), &replay);
    folder.write(&name("cut"), &replay[..replay.len() - 1]);
    folder.write(&name("changed"), [&replay[..40], &[!replay[40]], &replay[41..]].concat());
    let [json, broken, bodies, whole, cut, changed, none] =
        ["json", "broken", "bodies", "umbrarep", "cut", "changed", "none"].map(name);
    let below = format!("{HOSTILE}/x");
    let lists: Vec<Vec<&str>> = vec![
        vec!["run", &json],
        vec!["run", &json, "--json"],
        vec!["run", &json, "--integrator", HOSTILE],
        vec!["run", &json, "--ticks", HOSTILE],
        vec!["run", &json, "--csv", &json],
        vec!["run", &json, "--csv", &below],
        vec!["run", &broken],
        vec!["run", &bodies],
        vec!["run", &whole],
        vec!["run", &none],
        vec!["view", &cut, "--out", "page"],
        vec!["view", &changed, "--out", "page"],
        vec!["verify", &whole, &cut, &changed, &none, &json],
        vec!["verify", "--json", &whole, &cut, &changed, &none, &json],
        vec!["diff", &changed, &whole],
        vec!["diff", &cut, "other.umbrarep", "--all"],
        vec!["diff", &cut, "other.umbrarep", "--json"],
        vec!["diff", &json, &none],
        vec![HOSTILE],
        vec!["--\u{1b}[31m\u{9b}\n"],
        vec!["run", "--\u{1b}[31m\u{9b}\n"],
        vec!["run", &json, HOSTILE],
        vec!["run", "--json=\u{1b}\n"],
    ];
    for arguments in lists {
        let output = folder.umbra(&arguments);
        assert!(is_plain(&output.stderr), "{arguments:?}: {:?}", text(&output.stderr));
        assert!(is_plain(&output.stdout), "{arguments:?}: {:?}", text(&output.stdout));
        for line in [&output.stdout, &output.stderr].map(|bytes| text(bytes)).iter().flat_map(|text| text.lines()) {
            assert!(!line.starts_with("ok  b"), "a name forges a line: {arguments:?}");
        }
    }
    // In JSON they are what they were.
    let output = folder.umbra(&["verify", "--json", &whole]);
    let line: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!((output.status.code(), line["file"].as_str()), (Some(0), Some(&whole[..])));
    let output = folder.umbra(&["run", &json, "--json"]);
    let result: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(result["title"], "T\u{202e}itle");
    assert_eq!(result["faults"][0]["name"], "n\u{202d}ame", "{result}");
    // And what is not from outside stays legible.
    let error = text(&folder.umbra(&["run", &none]).stderr);
    assert!(error.starts_with(r"a\u001b[31m\u0007\u000aok  b\u000d\u007f\u009b2J\u202e\u2066c.none: cannot read: "));
}

#[cfg(unix)]
#[test]
fn a_name_need_not_be_utf8() {
    use std::os::unix::ffi::OsStrExt;
    let folder = Folder::new("bytes");
    let scene = OsStr::from_bytes(b"s\xff.json");
    if fs::write(folder.0.join(scene), SCENE).is_err() {
        println!("SKIPPED: here names are UTF-8");
        return;
    }
    let replay = OsStr::from_bytes(b"r\xfe");
    let umbra = |arguments: &[&OsStr]| folder.command(arguments).output().expect("the program starts");
    succeeds(&umbra(&["run".as_ref(), scene, "--record".as_ref(), replay]));
    succeeds(&umbra(&["verify".as_ref(), replay]));
    let over = umbra(&["run".as_ref(), scene, "--record".as_ref(), scene]);
    assert_eq!(over.status.code(), Some(2));
    assert_eq!(umbra(&[OsStr::from_bytes(b"\xff\x1b")]).status.code(), Some(2));
}
