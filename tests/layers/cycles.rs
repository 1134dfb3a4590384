//! Imports within a folder: no file leads back to itself.

use super::{code_of, heads, library, words};

/// The folders in which no file leads back to itself, each with its levels from left to right. Files of tests are left out.
const WITHOUT_CYCLES: [(&str, &[&str]); 2] = [("replay", &["snapshot", "diff", "file"]), ("codec", &[])];

/// The files below `folder` that a file there names. A folder is named by its `mod.rs`, which itself names all files beside it.
fn named_files(path: &str, source: &str, folder: &str, files: &[String]) -> Vec<String> {
    let code = code_of(source);
    let code = code.split("mod tests {").next().unwrap_or_default();
    let module = path.trim_end_matches(".rs").trim_end_matches("/mod");
    let is_folder = path.ends_with("/mod.rs");
    let mut named = Vec::new();
    // The file of the longest part of a path that is a module; the rest are items in it.
    let mut name = |start: &str, rest: &str| {
        for head in heads(rest) {
            let inner = format!("{start}/{head}");
            let files_of = |module: &str| [format!("{module}.rs"), format!("{module}/mod.rs")];
            let source = [files_of(&inner), files_of(start)].concat().into_iter().find(|file| files.contains(file));
            named.extend(source.filter(|file| file != path));
        }
    };
    for at in words(code, "crate") {
        let is_macro = at > 0 && code.as_bytes()[at - 1] == b'$';
        let rest = code[at + 5..].strip_prefix("::").filter(|_| !is_macro);
        let Some(mut rest) = rest.and_then(|rest| rest.strip_prefix(folder)?.strip_prefix("::")) else { continue };
        let mut start = folder.to_owned();
        // Down to the folder that is named.
        while let Some((head, below)) = rest.split_once("::") {
            if !files.contains(&format!("{start}/{head}/mod.rs")) {
                break;
            }
            (start, rest) = (format!("{start}/{head}"), below);
        }
        name(&start, rest);
    }
    for at in words(code, "super").filter(|at| !code[..*at].ends_with("super::")) {
        let (mut rest, mut start) = (&code[at + 5..], module);
        start = start.rsplit_once('/').map_or(start, |(above, _)| above);
        while let Some(next) = rest.strip_prefix("::super") {
            (rest, start) = (next, start.rsplit_once('/').map_or(start, |(above, _)| above));
        }
        rest.strip_prefix("::").into_iter().for_each(|rest| name(start, rest));
    }
    if is_folder {
        let beside = |file: &&String| {
            let below = file.strip_prefix(module).and_then(|rest| rest.strip_prefix('/'));
            below.is_some_and(|rest| rest != "mod.rs" && !rest.trim_end_matches("/mod.rs").contains('/'))
        };
        named.extend(files.iter().filter(beside).cloned());
    }
    named
}

/// The files that are left when all are taken out that name no other: those in cycles, and what names them.
fn cyclic(sources: &[(String, String)], folder: &str) -> Vec<String> {
    let files: Vec<String> = sources.iter().map(|(path, _)| path.clone()).collect();
    let mut left: Vec<(String, Vec<String>)> =
        sources.iter().map(|(path, source)| (path.clone(), named_files(path, source, folder, &files))).collect();
    loop {
        let count = left.len();
        let paths: Vec<String> = left.iter().map(|(path, _)| path.clone()).collect();
        left.retain(|(_, named)| named.iter().any(|file| paths.contains(file)));
        if left.len() == count {
            return left.into_iter().map(|(path, _)| path).collect();
        }
    }
}

/// The files of a folder, without those of its tests.
fn files_in(folder: &str) -> Vec<(String, String)> {
    let is_in = |path: &String| path.starts_with(&format!("{folder}/")) && !path.contains("/tests/");
    library().into_iter().filter(|(path, _)| is_in(path)).collect()
}

#[test]
fn no_file_of_these_folders_leads_back_to_itself() {
    for (folder, levels) in WITHOUT_CYCLES {
        let sources = files_in(folder);
        assert!(sources.len() > 5, "{folder}");
        assert_eq!(cyclic(&sources, folder), [""; 0], "{folder}");
        let files: Vec<String> = sources.iter().map(|(path, _)| path.clone()).collect();
        let level = |path: &str| levels.iter().position(|level| path.starts_with(&format!("{folder}/{level}/")));
        for (path, source) in &sources {
            for named in named_files(path, source, folder, &files) {
                assert!(level(path).is_none() || level(&named) <= level(path), "{path} names {named}");
            }
        }
    }
}

#[test]
fn the_checker_sees_a_cycle_in_every_form() {
    let owned = |files: &[(&str, &str)]| -> Vec<(String, String)> {
        files.iter().map(|(path, source)| ((*path).to_owned(), (*source).to_owned())).collect()
    };
    for files in [
        &[("a/b.rs", "use super::c::X;"), ("a/c.rs", "use super::b::Y;")][..],
        &[("a/b.rs", "fn f() -> crate::a::c::X {}"), ("a/c.rs", "use super::{b, d};"), ("a/d.rs", "")],
        &[("a/mod.rs", "mod b; pub use b::X;"), ("a/b.rs", "use super::Y;")],
        &[("a/mod.rs", "mod b;"), ("a/b/mod.rs", "mod c;"), ("a/b/c.rs", "use super::super::Y;")],
        &[("a/b/mod.rs", "mod e;"), ("a/b/e.rs", "use crate::a::c::X;"), ("a/c.rs", "use super::b::Y;")],
        &[("a/b.rs", "use super::c::X;"), ("a/c.rs", "use super::d;"), ("a/d.rs", "use crate::a::{b::Y};")],
    ] {
        assert!(cyclic(&owned(files), "a").len() > 1, "{files:?}");
    }
    for files in [
        &[("a/b.rs", "use super::c::X;"), ("a/c.rs", "use super::d::{Y, Z};"), ("a/d.rs", "")][..],
        &[("a/mod.rs", "mod b; mod c;"), ("a/b.rs", "use crate::a::c::X;\npub(super) fn f() {}"), ("a/c.rs", "")],
        &[("a/b.rs", "//! See [`super::c`]."), ("a/c.rs", "use super::b::Y; mod tests { use super::*; }")],
    ] {
        assert_eq!(cyclic(&owned(files), "a"), [""; 0], "{files:?}");
    }
}
