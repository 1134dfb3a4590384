//! `umbra verify --stream`: jobs in, answers out.

use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::json;

use super::*;

/// A running service.
struct Service {
    child: Child,
    jobs: Option<ChildStdin>,
    answers: BufReader<ChildStdout>,
}

impl Service {
    fn start(options: &[&str]) -> Self {
        let mut command = Command::new(env!("CARGO_BIN_EXE_umbra"));
        command.current_dir(root()).args(["verify", "--stream"]).args(options);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().expect("the program starts");
        let answers = BufReader::new(child.stdout.take().expect("a pipe"));
        Self { jobs: child.stdin.take(), child, answers }
    }

    /// Sends a line.
    fn send(&mut self, line: impl AsRef<[u8]>) {
        let jobs = self.jobs.as_mut().expect("it takes jobs");
        jobs.write_all(line.as_ref()).and_then(|()| jobs.write_all(b"\n")).expect("it reads");
    }

    fn answer(&mut self) -> Value {
        let mut line = String::new();
        self.answers.read_line(&mut line).expect("an answer");
        serde_json::from_str(&line).unwrap_or_else(|error| panic!("{error}: {line}"))
    }

    /// Ends the input, and gives the rest of the answers, what was said, and the exit status.
    fn end(mut self) -> (Vec<Value>, String, Option<i32>) {
        drop(self.jobs.take());
        self.wait()
    }

    /// Gives the rest of the answers, what was said, and the exit status, with an input that goes on.
    fn wait(mut self) -> (Vec<Value>, String, Option<i32>) {
        // One that does not end is to fail, and not to be waited for.
        let (id, (ended, has_ended)) = (self.child.id().to_string(), mpsc::channel::<()>());
        let watch = thread::spawn(move || {
            if has_ended.recv_timeout(Duration::from_secs(120)) == Err(RecvTimeoutError::Timeout) {
                let _ = Command::new("kill").args(["-KILL", &id]).status();
            }
        });
        let lines = (&mut self.answers).lines().map(|line| serde_json::from_str(&line.expect("text")).expect("JSON"));
        let (lines, mut said) = (lines.collect(), String::new());
        self.child.stderr.take().expect("a pipe").read_to_string(&mut said).expect("text");
        let status = self.child.wait().expect("it ends").code();
        drop(ended);
        watch.join().expect("it watches");
        (lines, said, status)
    }
}

impl Drop for Service {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn base64(bytes: &[u8]) -> String {
    STANDARD.encode(bytes)
}

/// A replay that takes some time, and a brief one.
fn long_and_brief(folder: &Folder) -> [String; 2] {
    let long = folder.record("scenes/spring-net.json", &["--ticks", "1000", "--hash-every", "100"]);
    [long, folder.record("scenes/kepler.json", &["--ticks", "3"])]
}

#[test]
fn each_job_gets_one_answer_with_its_id_whatever_it_is() {
    let folder = Folder::new("stream");
    let replay = folder.record(&folder.write("busy.json", busy("3")), &[]);
    let bytes = fs::read(&replay).expect("a replay");
    let hash = Replay::from_bytes(&bytes, &[]).map(|replay| {
        let mut playback = replay.play();
        playback.seek(100);
        format!("{:016x}", playback.world().state_hash())
    });
    let hash = hash.expect("it is whole");
    let elsewhere = folder.record(&folder.write("other.json", busy("3").replace("[5, 0]", "[6, 0]")), &[]);
    let strayed = strayed(RecordOptions::default());
    let file = |name: &str, bytes: &[u8]| json!({"id": name, "file": folder.write(name, bytes)}).to_string();
    let in_line = |id: Value, bytes: &[u8]| json!({"id": id, "bytes": base64(bytes)}).to_string();
    let limited = |id: &str, limits: Value| json!({"id": id, "file": replay, "limits": limits}).to_string();
    let id = r#"{"match": [81, 1e2, "\u202e"]}"#;
    let jobs: Vec<(Vec<u8>, &str, &str, &str)> = [
        (format!(r#"{{"id": {id}, "file": "{replay}"}}"#), "ok", "", id),
        (in_line(json!("in-line"), &bytes), "ok", "", "\"in-line\""),
        (in_line(json!(null), &bytes[..bytes.len() - 1]), "cut_off", "E404", "null"),
        (in_line(json!(3), &flipped(&bytes, bytes.len() / 2)), "tampered", "E405", "3"),
        (in_line(json!(""), b""), "malformed", "E401", "\"\""),
        (json!({"id": 6, "file": elsewhere}).to_string(), "other_start", "E807", "6"),
        (limited("a", json!({"ticks": 99})), "over_limits", "E422", "\"a\""),
        (limited("b", json!({"cpu_seconds": 0, "ticks": 100})), "over_limits", "E428", "\"b\""),
        (limited("c", json!({"bytes": 99})), "too_large", "E806", "\"c\""),
        (limited("d", json!({"ticks": 1_296_001})), "bad_job", "E808", "\"d\""),
        (limited("e", json!({"tick": 1})), "bad_job", "E808", "\"e\""),
        (limited("f", json!({"ticks": -1})), "bad_job", "E808", "\"f\""),
        (json!({"id": 13, "bytes": "===="}).to_string(), "bad_job", "E808", "13"),
        (json!({"id": 14}).to_string(), "bad_job", "E808", "14"),
        (json!({"id": 15, "file": replay, "bytes": ""}).to_string(), "bad_job", "E808", "15"),
        (json!({"id": 16, "file": replay, "more": 1}).to_string(), "bad_job", "E808", "16"),
        (json!({"file": replay}).to_string(), "bad_job", "E808", "null"),
        ("{".to_owned(), "bad_job", "E808", "null"),
        (json!([19, replay, null, {}]).to_string(), "bad_job", "E808", "null"),
        (format!("{{\"id\": 20, \"limits\": {}1{}}}", "[".repeat(9_999), "]".repeat(9_999)), "bad_job", "E808", "20"),
        (file("strayed.umbrarep", &strayed), "other_start", "E807", "\"strayed.umbrarep\""),
        (json!({"id": 22, "file": folder.path("none")}).to_string(), "unreadable", "E801", "22"),
        (json!({"id": 23, "file": folder.path("")}).to_string(), "unreadable", "E801", "23"),
    ]
    .map(|(line, status, code, id)| (line.into_bytes(), status, code, id))
    .to_vec();
    for jobs_at_once in ["1", "8"] {
        let mut service = Service::start(&["--jobs", jobs_at_once, "--start", &replay]);
        for (line, ..) in &jobs {
            service.send(line);
        }
        service.send(b" \r");
        service.send(b"{\"id\": \"\xff\", \"file\": \"x\"}");
        // The last line has no end.
        let last = limited("last", json!({}));
        service.jobs.as_mut().expect("it takes jobs").write_all(last.as_bytes()).expect("it reads");
        let (mut answers, said, status) = service.end();
        assert_eq!((&said[..], status), ("", Some(0)));
        if jobs_at_once == "1" {
            assert!(answers.is_sorted_by_key(|answer| answer["line"].as_u64()), "one after the other");
        }
        answers.sort_by_key(|answer| answer["line"].as_u64());
        assert_eq!(answers.len(), jobs.len() + 2);
        for (i, (answer, (_, status, code, id))) in answers.iter().zip(&jobs).enumerate() {
            assert_eq!(answer["line"], json!(i + 1));
            let id: Value = serde_json::from_str(id).expect("JSON");
            assert_eq!((&answer["id"], answer["status"].as_str()), (&id, Some(*status)), "{answer}");
            assert_eq!(answer["code"].as_str().unwrap_or_default(), *code, "{answer}");
            assert_eq!(answer["reason"].is_null(), *status == "ok", "{answer}");
            assert_eq!(answer["end_hash"] == json!(hash), matches!(*status, "ok" | "cut_off"), "{answer}");
            assert_eq!(answer["finding"].is_null(), !matches!(*status, "tampered" | "other_start"), "{answer}");
            assert!(answer["cpu_seconds"].is_f64(), "{answer}");
        }
        let [.., not_text, last] = &answers[..] else { panic!("two more") };
        assert_eq!((not_text["line"].as_u64(), not_text["status"].as_str()), (Some(25), Some("bad_job")));
        assert_eq!((last["id"].as_str(), last["status"].as_str()), (Some("last"), Some("ok")));
    }
    // Without a start, the run itself is judged; a service is no list of files.
    let mut service = Service::start(&[]);
    service.send(file("strayed.umbrarep", &strayed));
    let answer = service.answer();
    assert_eq!((answer["status"].as_str(), answer["code"].as_str()), (Some("diverged"), Some("E420")));
    assert_eq!((answer["finding"]["tick"].as_u64(), answer["end_hash"].is_null()), (Some(99), true));
    assert_eq!(service.end().2, Some(0));
    let from_jobs = [["--stream", "--start", "-"], ["--stream", "--limits", "-"]];
    for wrong in from_jobs.iter().map(|wrong| &wrong[..]).chain([
        &["--stream", &replay[..]][..],
        &["--stream", "--json"],
        &["--stream", "--exact"],
    ]) {
        assert_eq!(umbra(&[&["verify"], wrong].concat()).status.code(), Some(2), "{wrong:?}");
    }
}

#[test]
fn answers_come_as_they_are_done_and_nobody_is_held_up() {
    let folder = Folder::new("stream-order");
    let [long, brief] = long_and_brief(&folder);
    let mut service = Service::start(&["--jobs", "2"]);
    service.send(json!({"id": "long", "file": long}).to_string());
    // One thread has the long job; the other one does all these meanwhile. The input is still open.
    for id in 0..9 {
        service.send(json!({"id": id, "file": brief}).to_string());
        assert_eq!(service.answer()["id"], json!(id));
    }
    // Nor does a pipe that nobody writes to, or a device without end.
    #[cfg(unix)]
    {
        let fifo = folder.path("fifo");
        assert!(Command::new("mkfifo").arg(&fifo).status().expect("mkfifo").success());
        for file in [&fifo[..], "/dev/zero"] {
            service.send(json!({"id": file, "file": file}).to_string());
            let answer = service.answer();
            assert_eq!((answer["id"].as_str(), answer["status"].as_str()), (Some(file), Some("unreadable")));
            assert_eq!(answer["reason"].as_str(), Some("cannot read: not a regular file"));
        }
    }
    assert_eq!(service.answer()["id"].as_str(), Some("long"));
    assert_eq!(service.end(), (vec![], String::new(), Some(0)));
}

#[test]
fn a_line_that_is_too_long_is_answered_and_passed_over() {
    let folder = Folder::new("stream-lines");
    let brief = folder.record("scenes/kepler.json", &["--ticks", "3"]);
    let mut service = Service::start(&["--jobs", "1", "--limit", "bytes=30000"]);
    let padded = |length: usize| {
        let job = json!({"id": length, "file": brief}).to_string();
        job.clone() + &" ".repeat(length - job.len())
    };
    // 30,000 bytes are 40,000 in base64, and there are 64 KiB more.
    let longest = 40_000 + (64 << 10);
    let (just_fits, too_long) = (padded(longest), padded(longest + 1));
    let [within, beyond] =
        [30_000, 30_001].map(|count| json!({"id": count, "bytes": base64(&vec![7; count])}).to_string());
    for (line, status) in [
        (&just_fits, "ok"),
        (&too_long, "too_large"),
        (&within, "malformed"),
        (&beyond, "too_large"),
        (&"x".repeat(5_000_000), "too_large"),
        (&just_fits, "ok"),
    ] {
        service.send(line);
        let answer = service.answer();
        assert_eq!(answer["status"].as_str(), Some(status), "{answer}");
    }
    // The last line, without an end.
    service.jobs.as_mut().expect("it takes jobs").write_all(too_long.as_bytes()).expect("it reads");
    let (answers, said, status) = service.end();
    assert_eq!((answers.len(), answers[0]["line"].as_u64(), &said[..], status), (1, Some(7), "", Some(0)));
    assert_eq!((answers[0]["status"].as_str(), answers[0]["id"].is_null()), (Some("too_large"), true));
}

#[cfg(target_os = "linux")]
#[test]
fn memory_does_not_grow_with_the_number_of_jobs() {
    let folder = Folder::new("stream-memory");
    let brief = folder.record("scenes/kepler.json", &["--ticks", "3"]);
    let mut bytes = fs::read(brief).expect("a replay");
    bytes.resize(1 << 20, 0);
    let line = json!({"id": 1, "bytes": base64(&bytes)}).to_string();
    let mut service = Service::start(&["--jobs", "2", "--limit", "bytes=1048576"]);
    let peak = |service: &Service| {
        let status = fs::read_to_string(format!("/proc/{}/status", service.child.id())).expect("it runs");
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).expect("a peak");
        line.trim().trim_end_matches(" kB").parse::<u64>().expect("a number") << 10
    };
    // 280 MB in all; jobs are sent before earlier ones are answered.
    for _ in 0..50 {
        (0..4).for_each(|_| service.send(&line));
        (0..4).for_each(|_| assert_eq!(service.answer()["status"].as_str(), Some("malformed")));
    }
    // Two jobs of a line, its text, and the file, beside the program itself.
    assert!(peak(&service) < 48 << 20, "{} bytes", peak(&service));
    assert_eq!(service.end().2, Some(0));
}

#[cfg(unix)]
#[test]
fn sigterm_lets_what_has_begun_be_finished() {
    let folder = Folder::new("stream-term");
    let [long, brief] = long_and_brief(&folder);
    let terminate = |service: &Service| {
        let id = service.child.id().to_string();
        assert!(Command::new("kill").args(["-TERM", &id]).status().expect("kill").success());
    };
    let mut service = Service::start(&["--jobs", "2"]);
    service.send(json!({"id": "long", "file": long}).to_string());
    service.send(json!({"id": "brief", "file": brief}).to_string());
    // With this answer the long job has begun as well: lines are read in their order.
    assert_eq!(service.answer()["id"].as_str(), Some("brief"));
    terminate(&service);
    let input = service.jobs.take();
    let (answers, said, status) = service.wait();
    assert_eq!(answers.iter().map(|answer| answer["id"].as_str()).collect::<Vec<_>>(), [Some("long")]);
    assert_eq!((answers[0]["status"].as_str(), &said[..], status), (Some("ok"), "", Some(0)));
    drop(input);
    // A service that has nothing to do ends at once.
    let mut service = Service::start(&[]);
    service.send(json!({"id": 1, "file": brief}).to_string());
    service.answer();
    terminate(&service);
    let (input, began) = (service.jobs.take(), Instant::now());
    assert_eq!(service.wait(), (vec![], String::new(), Some(0)));
    assert!(began.elapsed() < Duration::from_secs(20));
    drop(input);
}

#[test]
fn a_service_whose_answers_nobody_takes_ends() {
    let folder = Folder::new("stream-closed");
    let brief = folder.record("scenes/kepler.json", &["--ticks", "3"]);
    let mut service = Service::start(&["--jobs", "2"]);
    let mut jobs = service.jobs.take().expect("it takes jobs");
    let line = json!({"id": 1, "file": brief}).to_string() + "\n";
    jobs.write_all(line.as_bytes()).expect("it reads");
    let mut first = String::new();
    service.answers.read_line(&mut first).expect("an answer");
    // The reader goes, and jobs keep coming.
    let mut idle = Command::new("true");
    service.answers = BufReader::new(idle.stdout(Stdio::piped()).spawn().expect("true").stdout.take().expect("a pipe"));
    let began = Instant::now();
    while service.child.try_wait().expect("a child").is_none() {
        assert!(began.elapsed() < Duration::from_secs(60), "it goes on");
        let _ = jobs.write_all(line.as_bytes());
        thread::sleep(Duration::from_millis(5));
    }
    let (_, said, status) = service.wait();
    assert!(said.starts_with("standard output: cannot write: "), "{said}");
    assert_eq!(status, Some(2));
}
