//! Each function, type and constant of the public interface is shown in code that runs: in a doc example, in the README, in the
//! guide, or in an example of its own.
//!
//! It reads the sources. The lint `unreachable_pub` sees to it that what is `pub` is public.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Something public: `name`, or `Type::name`.
#[derive(Clone, Debug)]
struct Item {
    file: String,
    owner: Option<String>,
    name: String,
}

impl Item {
    fn path(&self) -> String {
        self.owner.as_ref().map_or(self.name.clone(), |owner| format!("{owner}::{}", self.name))
    }
}

/// Code that runs as a test or a program, and the source file that it stands in.
struct Block {
    file: String,
    code: String,
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Returns true if `word` stands in the code as a word of its own.
fn has_word(code: &str, word: &str) -> bool {
    code.match_indices(word).any(|(at, _)| {
        let ends = code[at + word.len()..].chars().next();
        !code[..at].chars().next_back().is_some_and(is_word) && !ends.is_some_and(is_word)
    })
}

/// Returns true if `word` is called or named after a `.` or `::`.
fn has_member(code: &str, word: &str) -> bool {
    code.match_indices(word).any(|(at, _)| {
        let ends = code[at + word.len()..].chars().next();
        (code[..at].ends_with('.') || code[..at].ends_with("::")) && !ends.is_some_and(is_word)
    })
}

fn first_word(text: &str) -> &str {
    text.split(|c| !is_word(c)).next().unwrap_or_default()
}

/// Public items in a source, line by line as rustfmt leaves it.
fn items(file: &str, source: &str) -> Vec<Item> {
    const KINDS: [&str; 7] = ["fn ", "const fn ", "struct ", "enum ", "trait ", "type ", "const "];
    let source = source.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let (mut items, mut owner, mut is_hidden) = (Vec::new(), None, false);
    for line in source.lines() {
        let code = line.trim_start();
        let depth = line.len() - code.len();
        if depth == 0 && code.starts_with("impl") && !code.ends_with('}') {
            // `impl<S: Scalar> World<S> {`: the name after the generics, which of a trait's is the trait's.
            let rest = &code[4..];
            let mut open = 0;
            let start = rest.char_indices().find(|(_, c)| {
                open += i32::from(*c == '<') - i32::from(*c == '>');
                open == 0 && is_word(*c)
            });
            owner = start.map(|(at, _)| first_word(&rest[at..]).to_owned());
        } else if depth == 0 && code.starts_with('}') {
            owner = None;
        }
        is_hidden |= code.starts_with("#[doc(hidden)]");
        let public = code.strip_prefix("pub ").and_then(|rest| KINDS.iter().find_map(|kind| rest.strip_prefix(kind)));
        if let Some(rest) = public {
            if !is_hidden {
                let owner = owner.clone().filter(|_| depth > 0);
                items.push(Item { file: file.to_owned(), owner, name: first_word(rest).to_owned() });
            }
        }
        // The attribute is that of the next line of code, public or not.
        is_hidden &= code.is_empty() || code.starts_with(['#', '/']);
    }
    items
}

/// The code in a text in Markdown that is shown and that runs.
fn blocks(file: &str, text: &str) -> Vec<Block> {
    let (mut blocks, mut open): (Vec<Block>, Option<Option<String>>) = (Vec::new(), None);
    for line in text.lines() {
        if let Some(info) = line.trim_start().strip_prefix("```") {
            open = match open.take() {
                Some(code) => {
                    blocks.extend(code.map(|code| Block { file: file.to_owned(), code }));
                    None
                }
                None => Some(["", "rust", "compile_fail"].contains(&info.trim()).then(String::new)),
            };
        } else if let Some(Some(code)) = &mut open {
            // A line that starts so is not shown.
            if !line.trim_start().starts_with("# ") {
                code.push_str(line);
                code.push('\n');
            }
        }
    }
    blocks
}

/// The documentation in a source as Markdown.
fn documentation(source: &str) -> String {
    let comment = |line: &str| {
        let line = line.trim_start();
        line.strip_prefix("///").or_else(|| line.strip_prefix("//!")).map(str::to_owned)
    };
    // What stands between two comments parts them.
    source.lines().map(|line| comment(line).unwrap_or_default() + "\n").collect()
}

/// Code without what it imports.
fn without_imports(code: &str) -> String {
    let mut rest = code;
    let mut kept = String::new();
    while let Some(at) = rest.find("use umbra_") {
        kept.push_str(&rest[..at]);
        rest = rest[at..].split_once(';').map_or("", |(_, after)| after);
    }
    kept + rest
}

fn files(folder: &Path, extension: &str, paths: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder of the crate") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            files(&path, extension, paths);
        } else if path.extension().is_some_and(|is| is == extension) {
            paths.push(path);
        }
    }
}

/// The files below a folder of the crate, with their texts.
fn texts(folder: &str, extension: &str) -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut paths = Vec::new();
    files(&root.join(folder), extension, &mut paths);
    let named = |path: &PathBuf| {
        let below = path.strip_prefix(root).expect("below the crate").to_string_lossy().into_owned();
        (below, fs::read_to_string(path).expect("a text"))
    };
    paths.iter().map(named).collect()
}

/// Folders and files of modules that the library hides: no part of the interface.
fn hidden_modules() -> Vec<String> {
    let root = include_str!("../../src/lib.rs");
    let names = root.split("#[doc(hidden)]\npub mod ").skip(1).map(first_word);
    names.flat_map(|name| [format!("src/{name}/"), format!("src/{name}.rs")]).collect()
}

/// The interface, and all code that is shown.
fn interface() -> (Vec<Item>, Vec<Block>) {
    let hidden = hidden_modules();
    let is_hidden = |file: &str| hidden.iter().any(|module| file.starts_with(module.as_str()));
    let is_library = |(file, _): &(String, String)| !file.ends_with("/tests.rs") && !is_hidden(file);
    let libraries = ["src", "crates/umbra-oracles/src", "crates/umbra-scene/src"];
    let sources: Vec<_> = libraries.iter().flat_map(|folder| texts(folder, "rs")).filter(is_library).collect();
    let all = sources.iter().flat_map(|(file, source)| items(file, source)).collect();
    let mut shown: Vec<Block> =
        sources.iter().flat_map(|(file, source)| blocks(file, &documentation(source))).collect();
    for (file, text) in
        texts("src/guide", "md").iter().chain([&("README.md".into(), include_str!("../../README.md").into())])
    {
        shown.extend(blocks(file, text));
    }
    shown.extend(texts("examples", "rs").into_iter().map(|(file, code)| Block { file, code }));
    (all, shown)
}

/// Returns true if an item is used in shown code. For a member the code must also name its type, or be in the docs beside it:
/// other types have members of that name.
fn is_shown(item: &Item, shown: &[Block]) -> bool {
    shown.iter().any(|block| match &item.owner {
        None => has_word(&without_imports(&block.code), &item.name),
        Some(owner) => (block.file == item.file || has_word(&block.code, owner)) && has_member(&block.code, &item.name),
    })
}

/// Items of a file that are shown nowhere, with the file.
fn missing<'a>(all: &'a [Item], shown: &'a [Block]) -> impl Iterator<Item = String> {
    all.iter().filter(|item| !is_shown(item, shown)).map(|item| format!("{} {}", item.file, item.path()))
}

#[test]
fn all_that_is_public_is_shown() {
    let (all, shown) = interface();
    assert!(all.len() > 300 && shown.len() > 100, "{} items, {} blocks", all.len(), shown.len());
    let nowhere: BTreeSet<String> = missing(&all, &shown).collect();
    assert!(nowhere.is_empty(), "shown nowhere: {nowhere:#?}");
}

#[test]
fn modules_that_the_library_hides_are_no_interface() {
    let hidden = hidden_modules();
    assert!(hidden.contains(&"src/collide/".to_owned()) && hidden.iter().all(|path| path.len() > "src/.rs".len()));
    let (all, _) = interface();
    assert!(all.iter().any(|item| item.file.starts_with("src/shape/")));
    assert!(!all.iter().any(|item| item.file.starts_with("src/collide/")));
}

#[test]
fn the_reader_of_sources_sees_what_is_public_and_what_is_shown() {
    let source = r#"
/// ```
/// # use umbra_physics::{Hidden, Shown};
/// # let hidden = Hidden::new();
/// let shown: Shown = Shown::new();
/// shown.run();
/// ```
/// ```text
/// Said::aloud()
/// ```
pub struct Shown<S: Scalar = Fx>(S);
pub struct Hidden;
pub(crate) struct Inner;
impl core::error::Error for Hidden {}
impl<S: Scalar<Wide = Vec<S>>> Shown<S> {
    pub const LIMIT: u32 = 1;
    pub const fn new() -> Self {}
    pub fn run(&self) {}
    #[doc(hidden)]
    pub fn secret() {}
    fn private() {}
}
pub trait Said {}
#[cfg(test)]
mod tests {
    pub fn helper() {}
}
"#;
    let all = items("a.rs", source);
    let paths: Vec<_> = all.iter().map(Item::path).collect();
    assert_eq!(paths, ["Shown", "Hidden", "Shown::LIMIT", "Shown::new", "Shown::run", "Said"]);
    let shown = blocks("a.rs", &documentation(source));
    assert_eq!(shown.len(), 1);
    assert_eq!(missing(&all, &shown).collect::<Vec<_>>(), ["a.rs Hidden", "a.rs Shown::LIMIT", "a.rs Said"]);
    // From elsewhere a member counts where its type is named: others have members of the same name.
    let elsewhere = |code: &str| [Block { file: "b.rs".into(), code: code.into() }];
    let run = all.iter().find(|item| item.name == "run").expect("it is there");
    assert!(!is_shown(run, &elsewhere("other.run()")) && !is_shown(run, &elsewhere("Shown.runs()")));
    assert!(is_shown(run, &elsewhere("let it: Shown = make(); it.run();")));
    // An import alone shows nothing.
    assert!(!is_shown(&all[0], &elsewhere("use umbra_physics::{\n    Shown,\n};\nlet it = 1;")));
}
