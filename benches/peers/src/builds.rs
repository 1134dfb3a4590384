//! Engines in other builds of this program: of each dependency a program has one set of features. Such a build is made when one of its
//! engines is asked for, and runs as a child process, scene by scene after the engines of this program.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::report::Report;

pub struct Build {
    /// Its folder below `target`.
    name: &'static str,
    /// The features of this package, in place of the default ones.
    features: &'static str,
    rustflags: &'static str,
    pub engines: &'static [&'static str],
}

pub const BUILDS: [Build; 2] = [
    // As `cargo add rapier2d` has it.
    Build { name: "default", features: "", rustflags: "", engines: &["rapier-f32-default"] },
    Build {
        name: "avx2",
        features: "avx2",
        rustflags: "-C target-feature=+avx2,+fma",
        engines: &["rapier-f32-avx2", "box2d-avx2"],
    },
];

/// A build that is ready to run some of its engines.
pub struct Child {
    program: PathBuf,
    pub engines: Vec<&'static str>,
}

/// Makes the builds of the engines that are wanted, and prints the lines about them for the head of the run.
pub fn children(is_wanted: impl Fn(&str) -> bool, rep: &mut Report) -> Vec<Child> {
    let mut children = Vec::new();
    for build in &BUILDS {
        let engines: Vec<_> = build.engines.iter().copied().filter(|id| is_wanted(id)).collect();
        if engines.is_empty() {
            continue;
        }
        match build.make() {
            Ok(program) => {
                let child = Child { program, engines };
                print!("{}", child.output(&["--head"]));
                children.push(child);
            }
            Err(why) => rep.skip(&engines.join(" "), "all", 0, &why),
        }
    }
    children
}

impl Build {
    /// Returns the program; the error says why there is none that runs here.
    fn make(&self) -> Result<PathBuf, String> {
        if self.rustflags.contains("avx2") && !has_avx2() {
            return Err("this CPU has no AVX2".into());
        }
        let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
        let target = folder.join("target").join(self.name);
        let mut cargo = Command::new("cargo");
        // There `.cargo/config.toml` has the flags for C.
        cargo.current_dir(folder).args(["build", "--release", "--locked", "--no-default-features"]);
        cargo.args(["--features", self.features, "--target-dir"]).arg(&target).env("RUSTFLAGS", self.rustflags);
        match cargo.status() {
            Ok(status) if status.success() => Ok(target.join("release/peers")),
            Ok(status) => Err(format!("cargo build: {status}")),
            Err(e) => Err(format!("cargo build: {e}")),
        }
    }
}

#[cfg(target_arch = "x86_64")]
fn has_avx2() -> bool {
    is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma")
}

#[cfg(not(target_arch = "x86_64"))]
fn has_avx2() -> bool {
    false
}

impl Child {
    /// The text that it prints when run for its engines with some options.
    fn output(&self, options: &[&str]) -> String {
        let mut command = Command::new(&self.program);
        command.args(["--engine", &self.engines.join(",")]).args(options).stderr(Stdio::inherit());
        let output = command.output().expect("the build is there");
        assert!(output.status.success(), "{:?} {options:?}: {}", self.program, output.status);
        String::from_utf8_lossy(&output.stdout).into_owned()
    }

    /// Runs it with some options, and adds its rows and what it skipped.
    pub fn run(&self, options: &[&str], rep: &mut Report) {
        let csv = std::env::temp_dir().join(format!("peers-{}.csv", std::process::id()));
        let text = self.output(&[options, &["--csv", &csv.to_string_lossy()]].concat());
        let rows = std::fs::read_to_string(&csv).expect("the child has written it");
        std::fs::remove_file(&csv).expect("and nobody else");
        rows.lines().skip(1).for_each(|line| rep.add_line(line));
        text.lines().filter_map(|line| line.strip_prefix("# skipped: ")).for_each(|note| rep.note_skipped(note));
    }
}
