//! Names and sentences that a reader who has not written the code can follow.
//!
//! Counted in the library and in the programs: bindings named by a pronoun or a preposition, and parameters that are tuples. Counted in
//! the folders of the step and of contacts: comments that point to a noun ("those", "that of", "what") instead of naming it.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use syn::visit::{self, Visit};
use syn::{FieldPat, FnArg, Pat, PatIdent, Signature};

use super::openings;

/// The folders in which names are counted.
const SOURCES: [&str; 4] = ["src", "crates", "capi/src", "fuzz/src"];

/// The folders in which comments are counted.
const FOLDERS: [&str; 6] = ["src/contact", "src/collide", "src/solve", "src/step", "src/character", "src/island"];

/// Words that name a binding by its relation to another one, or by nothing.
const PRONOUNS: [&str; 14] =
    ["by", "found", "given", "it", "made", "most", "near", "of", "on", "one", "other", "own", "seen", "there"];

/// The most bindings of that kind in 1,000 lines of code, the most pointing words in 1,000 words of comments, and the most tuple
/// parameters in all.
const PRONOUN_LIMIT: f64 = 0.5;
const POINTER_LIMIT: f64 = 0.25;
const TUPLE_LIMIT: usize = 13;

/// Counts of a source.
#[derive(Default)]
struct Names {
    pronouns: BTreeMap<String, usize>,
    tuples: Vec<String>,
}

impl<'ast> Visit<'ast> for Names {
    fn visit_pat_ident(&mut self, binding: &'ast PatIdent) {
        let name = binding.ident.to_string();
        if PRONOUNS.contains(&name.as_str()) {
            *self.pronouns.entry(name).or_default() += 1;
        }
        visit::visit_pat_ident(self, binding);
    }

    /// A field in shorthand names the binding itself.
    fn visit_field_pat(&mut self, field: &'ast FieldPat) {
        if field.colon_token.is_some() {
            visit::visit_field_pat(self, field);
        }
    }

    fn visit_signature(&mut self, signature: &'ast Signature) {
        let is_tuple = |input: &&FnArg| matches!(input, FnArg::Typed(typed) if matches!(*typed.pat, Pat::Tuple(_)));
        let tuples = signature.inputs.iter().filter(is_tuple);
        self.tuples.extend(tuples.map(|_| signature.ident.to_string()));
        visit::visit_signature(self, signature);
    }
}

impl Names {
    fn of(source: &str) -> Self {
        let mut names = Self::default();
        names.visit_file(&syn::parse_file(source).expect("it compiles"));
        names
    }
}

/// The number of words in the comments of a source, and the words among them that point to a noun.
fn pointers(source: &str) -> (usize, usize) {
    let comments = source.lines().map(str::trim_start).filter(|line| line.starts_with("//"));
    let text = comments.map(|line| line.trim_start_matches(['/', '!'])).collect::<Vec<_>>().join(" ").to_lowercase();
    let words: Vec<&str> = text.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty()).collect();
    let is_pointer = |pair: &&[&str]| matches!(pair, ["those" | "what", _] | ["that", "of"]);
    (words.len(), words.windows(2).filter(is_pointer).count())
}

/// The number of lines with code.
fn code_lines(source: &str) -> usize {
    source.lines().map(str::trim_start).filter(|line| !line.is_empty() && !line.starts_with("//")).count()
}

/// The sources in some folders of the repository.
fn sources(folders: &[&str]) -> Vec<(PathBuf, String)> {
    let mut paths = Vec::new();
    folders
        .iter()
        .for_each(|folder| openings::sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join(folder), &mut paths));
    paths.into_iter().map(|path| (path.clone(), fs::read_to_string(path).expect("it can be read"))).collect()
}

#[test]
fn bindings_are_nouns() {
    let (mut lines, mut pronouns) = (0, Vec::new());
    for (path, source) in sources(&SOURCES) {
        lines += code_lines(&source);
        pronouns.extend(Names::of(&source).pronouns.into_iter().map(|(name, count)| (count, name, path.clone())));
    }
    let count: usize = pronouns.iter().map(|(count, ..)| count).sum();
    let rate = 1_000.0 * count as f64 / lines as f64;
    assert!(lines > 70_000, "{lines} lines");
    println!("{count} bindings in {lines} lines: {rate:.2} in 1,000");
    assert!(rate < PRONOUN_LIMIT, "{rate:.2} in 1,000 lines: {pronouns:#?}");
}

#[test]
fn comments_name_nouns() {
    let (mut words, mut pointers_in) = (0, Vec::new());
    for (path, source) in sources(&FOLDERS) {
        let (length, count) = pointers(&source);
        words += length;
        pointers_in.push((count, path));
    }
    let count: usize = pointers_in.iter().map(|(count, _)| count).sum();
    let rate = 1_000.0 * count as f64 / words as f64;
    assert!(words > 20_000, "{words} words");
    println!("{count} pointing words in {words}: {rate:.2} in 1,000");
    pointers_in.retain(|(count, _)| *count > 0);
    assert!(rate < POINTER_LIMIT, "{rate:.2} in 1,000 words: {pointers_in:#?}");
}

#[test]
fn parameters_are_no_tuples() {
    let names = sources(&SOURCES).into_iter().map(|(path, source)| (path, Names::of(&source)));
    let tuples: Vec<_> =
        names.flat_map(|(path, names)| names.tuples.into_iter().map(move |name| (path.clone(), name))).collect();
    println!("{} parameters are tuples", tuples.len());
    assert!(tuples.len() < TUPLE_LIMIT, "{}: {tuples:#?}", tuples.len());
}

#[test]
fn names_are_counted_as_they_are_written() {
    let names = Names::of(
        "fn f((a, b): (u8, u8), own: u8) { let Some(of) = a else { return }; (|by| by)(b); let owner = own; } \
         fn g(Spring { near, far: there }: Spring) {}",
    );
    let counted: Vec<_> = names.pronouns.into_iter().collect();
    assert_eq!(counted, ["by", "of", "own", "there"].map(|name| (name.to_owned(), 1)));
    assert_eq!(names.tuples, ["f"]);
    assert_eq!(pointers("/// Those of a body, and that of it.\nfn what() {} // what\n    // What is asleep."), (11, 3));
}
