//! The program `umbra-selftest`: what it prints, and its exit status.

#[path = "../../../tests/support/seeds.rs"]
mod seeds;

use std::ffi::OsStr;
use std::fs;
use std::process::{Command, Stdio};

use umbra_physics::scalar::internals::VectorSet;
use umbra_selftest::{Way, check};

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("UTF-8")
}

/// A device on which there is no room.
#[cfg(target_os = "linux")]
fn full() -> fs::File {
    fs::OpenOptions::new().write(true).open("/dev/full").expect("Linux has it")
}

/// The program, without an input.
fn selftest() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_umbra-selftest"));
    command.stdin(Stdio::null());
    command
}

#[test]
fn the_small_selftest_takes_no_arguments_whatever_they_are() {
    let many = vec!["1"; 20_000];
    for arguments in [&["--count=99999999999999999999"][..], &["--help"], &["--"], &[""], &["\u{1b}[31m"], &many] {
        let output = selftest().args(arguments).output().expect("the program starts");
        assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0));
        assert!(output.stderr.starts_with(b"usage: umbra-selftest\n"));
    }
    #[cfg(unix)]
    {
        let bytes = std::os::unix::ffi::OsStrExt::from_bytes(b"\xff\xfe");
        let output = selftest().arg::<&OsStr>(bytes).output().expect("the program starts");
        assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0));
    }
}

#[test]
fn the_small_selftest_says_what_came_out_whoever_reads() {
    #[cfg(target_os = "linux")]
    {
        // Its usage finds no room.
        let output = selftest().arg("x").stderr(full()).output().expect("the program starts");
        assert_eq!(output.status.code(), Some(2));
    }
    // The program runs each scene in each way, every time.
    if seeds::is_short() {
        return;
    }
    let mut child = selftest().stdout(Stdio::piped()).stderr(Stdio::null()).spawn().expect("the program starts");
    drop(child.stdout.take());
    assert_eq!(child.wait().expect("it ends").code(), Some(0));
    #[cfg(target_os = "linux")]
    {
        let output = selftest().stdout(full()).output().expect("the program starts");
        assert_eq!(output.status.code(), Some(2));
        let error = text(&output.stderr);
        assert!(error.lines().any(|line| line.starts_with("standard output: cannot write: ")), "{error}");
        let output = selftest().stderr(full()).output().expect("the program starts");
        assert_eq!(output.status.code(), Some(0));
        assert!(text(&output.stdout).lines().last().is_some_and(|line| line.starts_with("all ")));
    }
}

#[test]
fn the_small_selftest_prints_the_golden_list() {
    let output = selftest().output().expect("the program starts");
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let golden =
        fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../src/selftest/golden.txt")).expect("the list");
    let golden: Vec<&str> = golden.lines().filter(|line| !line.starts_with('#')).collect();
    assert_eq!(text(&output.stdout).lines().collect::<Vec<_>>(), golden);
}

#[test]
fn a_check_leaves_wide_vectors_as_they_were() {
    let used = VectorSet::used();
    let ways = Way::all();
    // The last way is without them.
    assert!(check(&ways[ways.len() - 1..], |_| ()).agrees);
    assert_eq!(VectorSet::used(), used);
    VectorSet::allow(VectorSet::Portable);
    assert_eq!(Way::all(), ways);
    assert_eq!(VectorSet::used(), VectorSet::Portable);
}
