//! Instruction counts under callgrind, of many calls of one function in one run of this program.

use std::fs;
use std::path::Path;
use std::process::Command;

/// Runs this program again under callgrind with the arguments given, and gives the instructions of each of so many calls of
/// `function`, in their order.
pub(crate) fn each_call(function: &str, calls: usize, args: &[&str], folder: &Path) -> Vec<u64> {
    _ = fs::remove_dir_all(folder);
    fs::create_dir_all(folder).expect("a folder for counts");
    let status = Command::new("valgrind")
        .args(["--quiet", "--tool=callgrind", "--collect-atstart=no", "--compress-strings=no"])
        .arg(format!("--toggle-collect=*{function}*"))
        // With a wildcard there would be no dumps.
        .arg(format!("--dump-after={function}"))
        .arg(format!("--callgrind-out-file={}", folder.join("out").display()))
        .arg(std::env::current_exe().expect("its own path"))
        .args(args)
        .status();
    assert!(status.expect("there is valgrind").success(), "valgrind failed");
    let count = |i: usize| {
        let dump = fs::read_to_string(folder.join(format!("out.{i}"))).expect("a dump for each call");
        let total = dump.lines().find_map(|line| line.strip_prefix("summary: ").or(line.strip_prefix("totals: ")));
        total.and_then(|total| total.trim().parse::<u64>().ok()).expect("a total in each dump")
    };
    (1..=calls).map(count).collect()
}
