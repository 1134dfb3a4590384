//! The published packages: each has all files that it needs, and no others.

use std::path::Path;
use std::process::Command;

/// The packages, and the most bytes that each may have, unpacked.
const PACKAGES: [(&str, u64); 5] = [
    ("umbra-physics", 5_250_000),
    ("umbra-scene", 300_000),
    ("umbra-oracles", 300_000),
    ("umbra-selftest", 100_000),
    ("umbra-physics-cli", 450_000),
];

/// Every package has these; the last two beside a manifest that Cargo rewrites.
const ALWAYS: [&str; 6] = ["Cargo.toml", "LICENSE-APACHE", "LICENSE-MIT", "README.md", "Cargo.lock", "Cargo.toml.orig"];

fn folder(package: &str) -> String {
    match package {
        "umbra-physics" => ".".into(),
        // The folder has the name of the library in it.
        "umbra-physics-cli" => "crates/umbra-cli".into(),
        _ => format!("crates/{package}"),
    }
}

/// The files of a package, as Cargo would publish them.
pub(crate) fn packaged(package: &str) -> Vec<String> {
    let mut cargo = Command::new(env!("CARGO"));
    cargo.args(["package", "--list", "--allow-dirty", "--offline", "--quiet", "--package", package]);
    let output = cargo.current_dir(env!("CARGO_MANIFEST_DIR")).output().expect("cargo runs");
    assert!(output.status.success(), "{package}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("UTF-8").lines().map(str::to_owned).collect()
}

/// Returns true for a file that a user of the package builds, reads or runs.
fn belongs(package: &str, file: &str) -> bool {
    let (folder, name) = file.rsplit_once('/').unwrap_or_default();
    let kind = name.rsplit_once('.').map_or("", |(_, kind)| kind);
    // Cargo writes it: the commit that the package was made from.
    let is_common = ALWAYS.contains(&file) || file == ".cargo_vcs_info.json";
    let is_source = file.starts_with("src/") && matches!(kind, "rs" | "md" | "txt" | "css" | "csv" | "html" | "js");
    let is_of_library = match folder {
        "docs" => matches!(kind, "md" | "svg"),
        "docs/report" => name == "README.md",
        "examples" | "examples/ggrs" | "examples/lockstep" | "examples/shared" => kind == "rs",
        _ => ["CHANGELOG.md", "CONTRIBUTING.md", "PERFORMANCE.md", "SECURITY.md"].contains(&file),
    };
    let is_of_program = file == "build.rs" || (folder == "scenes" && kind == "json");
    is_common
        || is_source
        || (package == "umbra-physics" && is_of_library)
        || (package == "umbra-physics-cli" && is_of_program)
}

#[test]
fn a_package_has_what_belongs_there_and_nothing_else() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for (package, max_size) in PACKAGES {
        let files = packaged(package);
        let junk: Vec<&String> = files.iter().filter(|file| !belongs(package, file)).collect();
        assert!(junk.is_empty(), "{package}: {junk:?}");
        for file in ALWAYS {
            assert!(files.iter().any(|packaged_file| packaged_file == file), "{package} lacks {file}");
        }
        assert!(files.iter().any(|file| file == "src/lib.rs" || file == "src/main.rs"), "{package} has no source");
        let size = |file: &String| root.join(folder(package)).join(file).metadata().map_or(0, |data| data.len());
        let bytes: u64 = files.iter().map(size).sum();
        assert!(bytes < max_size, "{package}: {bytes} bytes");
    }
}

#[test]
fn junk_in_a_package_is_seen() {
    for junk in ["fuzz/seeds/scene/a", "tests/engine.rs", "notes.txt", "src/notes.orig", "examples/oracles/main.rs"] {
        assert!(!belongs("umbra-physics", junk), "{junk}");
    }
    assert!(!belongs("umbra-physics-cli", "docs/scene.md") && !belongs("umbra-physics", "scenes/pile.json"));
    assert!(belongs("umbra-physics", "docs/scene.md") && belongs("umbra-physics-cli", "src/view/page.html"));
}

#[test]
fn unpublished_packages_say_so_and_the_others_have_their_metadata() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let manifest = |folder: &str| std::fs::read_to_string(root.join(folder).join("Cargo.toml")).expect("a manifest");
    for (package, _) in PACKAGES {
        let manifest = manifest(&folder(package));
        for field in ["description", "documentation", "categories", "keywords", "readme", "include"] {
            assert!(manifest.contains(&format!("\n{field} = ")), "{package} has no {field}");
        }
        for shared in ["license", "repository"] {
            assert!(
                manifest.contains(&format!("\n{shared}.workspace = true\n")),
                "{package} has a {shared} of its own"
            );
        }
        let is_program = package == "umbra-physics-cli";
        assert_eq!(manifest.contains("[package.metadata.docs.rs]"), !is_program, "{package}");
    }
    for package_folder in
        ["crates/umbra-lab", "capi", "fuzz", "benches/peers", "examples/bevy", "tests/wasm", "tests/wasm/scan"]
    {
        assert!(manifest(package_folder).contains("\npublish = false\n"), "{package_folder}");
    }
    // The library is published beside them, and `umbra-lab` is not.
    let beside = std::fs::read_dir(root.join("crates")).expect("the packages").count();
    assert_eq!(beside, PACKAGES.len(), "a package came or went");
}

/// `cargo run` takes the one program that a package of the workspace says is its default.
#[test]
fn cargo_run_starts_umbra() {
    let crates = std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("crates")).expect("the packages");
    let manifests = crates.map(|entry| entry.expect("an entry").path().join("Cargo.toml"));
    let lines: Vec<String> = manifests
        .flat_map(|path| {
            let text = std::fs::read_to_string(path).expect("a manifest");
            text.lines().filter(|line| line.starts_with("default-run")).map(str::to_owned).collect::<Vec<_>>()
        })
        .collect();
    assert_eq!(lines, ["default-run = \"umbra\""]);
}
