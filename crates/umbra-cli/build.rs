//! Puts the scenes together in one file, for the program to have them: `scenes/` of the package, or of the repository, which it is a link to.

use std::path::{Path, PathBuf};
use std::{env, fs};

fn main() {
    let package = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").expect("Cargo sets it"));
    // Where links are not kept the one of the package is a file.
    let folders = [package.join("scenes"), package.join("../../scenes")];
    let folder = folders.iter().find(|folder| folder.is_dir()).expect("the scenes are in one of them");
    let entries = fs::read_dir(folder).expect("it can be read").map(|entry| entry.expect("an entry").path());
    let mut scenes: Vec<PathBuf> = entries.filter(|path| path.extension().is_some_and(|kind| kind == "json")).collect();
    scenes.sort_by(|a, b| a.file_stem().cmp(&b.file_stem()));
    let scenes: Vec<String> = scenes.iter().map(|path| scene(path)).collect();
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("Cargo sets it"));
    fs::write(out.join("scenes"), scenes.concat()).expect("it can be written");
    println!("cargo::rerun-if-changed={}", folder.display());
}

/// A separator, the name of a scene, an end of line, and its text.
fn scene(path: &Path) -> String {
    let name = path.file_stem().expect("a name").to_str().expect("UTF-8");
    let text = fs::read_to_string(path).expect("a text");
    assert!(!text.contains('\u{1e}'), "{name} has a separator");
    format!("\u{1e}{name}\n{text}")
}
