//! Openings of doc blocks: a block begins with a noun or a verb, not with a pronoun whose noun the reader has to guess.

use std::fs;
use std::path::{Path, PathBuf};

/// Pronouns and conjunctions that leave a doc block without a noun when they open it: "What a step costs.", "Its mass."
const WORDS: [&str; 25] = [
    "as",
    "he",
    "her",
    "his",
    "it",
    "its",
    "of",
    "she",
    "so",
    "that",
    "their",
    "they",
    "those",
    "whatever",
    "what",
    "where",
    "wherever",
    "whether",
    "which",
    "whichever",
    "who",
    "whoever",
    "whom",
    "whose",
    "why",
];

/// Openings of two words: "How many bodies there are.", "One that is asleep."
const FIRST: [&str; 7] = ["all", "any", "none", "nothing", "one", "some", "something"];
const SECOND: [&str; 6] = ["that", "there", "which", "who", "whom", "whose"];
const AFTER_HOW: [&str; 14] =
    ["bad", "close", "far", "fast", "few", "high", "large", "long", "many", "much", "often", "small", "stiff", "well"];

fn is_headless(opening: &str) -> bool {
    let opening = opening.trim_start_matches([' ', '*', '_']);
    // `it` in code is a name.
    if opening.starts_with('`') {
        return false;
    }
    let words = opening.split_whitespace().map(|word| word.trim_matches(|c: char| !c.is_alphanumeric()).to_lowercase());
    let words: Vec<String> = words.take(3).collect();
    let word = |i: usize| words.get(i).map_or("", String::as_str);
    let is_of_them = word(1) == "of" && ["it", "them", "these", "those"].contains(&word(2));
    WORDS.contains(&word(0))
        || FIRST.contains(&word(0)) && (SECOND.contains(&word(1)) || is_of_them)
        || word(0) == "how" && AFTER_HOW.contains(&word(1))
        || word(0) == "the" && word(1) == "same" && ["as", "at", "but", "for", "in", "of", "with"].contains(&word(2))
}

/// The first line of each doc block of a source, with its number.
fn openings(source: &str) -> Vec<(usize, &str)> {
    let (mut blocks, mut open) = (Vec::new(), None);
    for (i, line) in source.lines().enumerate() {
        let line = line.trim_start();
        let kind = ["///", "//!"].into_iter().find(|kind| line.starts_with(kind) && !line.starts_with("////"));
        if let Some(kind) = kind.filter(|kind| open != Some(*kind)) {
            blocks.push((i + 1, line[kind.len()..].trim()));
        }
        open = kind;
    }
    blocks
}

/// Adds the sources in a folder and below it.
pub(crate) fn sources(folder: &Path, paths: &mut Vec<PathBuf>) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for entry in entries {
        let path = entry.expect("an entry").path();
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        if path.is_dir() && !["target", "seeds", "corpus", "artifacts"].contains(&name) {
            sources(&path, paths);
        } else if name.ends_with(".rs") {
            paths.push(path);
        }
    }
}

#[test]
fn fewer_than_one_doc_block_in_two_hundred_opens_headless() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = Vec::new();
    for folder in ["src", "crates", "capi", "fuzz", "tests", "examples", "benches"] {
        sources(&root.join(folder), &mut files);
    }
    files.sort();
    let (mut blocks, mut headless) = (0, Vec::new());
    for file in &files {
        let source = fs::read_to_string(file).expect("a source");
        for (line, opening) in openings(&source) {
            blocks += 1;
            if is_headless(opening) {
                let file = file.strip_prefix(root).expect("below the root");
                headless.push(format!("{}:{line}: {opening}", file.display()));
            }
        }
    }
    assert!(blocks > 3_000, "only {blocks} doc blocks found in {} files", files.len());
    assert!(headless.len() * 200 < blocks, "{} of {blocks}: {headless:#?}", headless.len());
}

#[test]
fn a_headless_opening_is_seen() {
    for opening in [
        "What a step costs.",
        "That of a body.",
        "Those that move.",
        "Whether it is asleep.",
        "*Its* mass, kg.",
        "It does.",
        "How many bodies there are.",
        "All that is public.",
        "One who is fair throughout.",
        "All of them.",
        "Of a half disc.",
        "The same for a chain.",
    ] {
        assert!(is_headless(opening), "{opening}");
    }
    for opening in [
        "Cost of a step.",
        "How a body moves.",
        "One of the three kinds.",
        "The same list in a world of floats.",
        "All bodies, in order.",
        "Itself and its neighbours.",
        "`what` as text.",
        "",
    ] {
        assert!(!is_headless(opening), "{opening}");
    }
    let source =
        "//! A file.\n//! Its second line.\n\n/// What.\n/// Why.\nfn f() {}\n//// Which.\n    /// Who.\nfn g() {}\n";
    assert_eq!(openings(source), [(1, "A file."), (4, "What."), (8, "Who.")]);
}
