//! Parts of the guide and the README that do not run as tests: figures of the report, excerpts of programs, links.

use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use serde_json::Value;

use crate::shown::packages::packaged;

/// Reads a file of the repository; some of them are not in the published package.
pub(crate) fn read(path: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The lines of a chapter's tables.
fn rows(chapter: &str) -> impl Iterator<Item = Vec<&str>> {
    let rows = chapter.lines().filter_map(|line| line.strip_prefix('|')?.strip_suffix('|'));
    rows.map(|row| row.split('|').map(|cell| cell.trim().trim_matches('`')).collect())
}

pub(crate) fn report() -> Value {
    serde_json::from_str(&read("docs/report/report.json")).expect("the report")
}

/// The entry of a list that has this under the key.
fn among(list: &Value, key: &str, is: &Value) -> Value {
    let matching = list.as_array().expect("a list").iter().find(|entry| entry[key] == *is).cloned();
    matching.unwrap_or_else(|| panic!("the report has no {key} {is}"))
}

/// The runs of a problem in this scalar by this integrator, in the order of their rates.
pub(crate) fn runs(problem: &Value, scalar: &str, integrator: &str) -> Vec<Value> {
    let lines = problem["lines"].as_array().expect("lines").iter().filter(|line| line["scalar"] == scalar);
    let line = among(&Value::Array(lines.cloned().collect()), "integrator", &integrator.into());
    line["runs"].as_array().expect("runs").clone()
}

/// Cost of runs as a multiple of the cost of others, the median over the rates at which both came through.
fn times(runs: &[Value], others: &[Value]) -> f64 {
    let both = runs.iter().zip(others).filter(|(run, twin)| !run["error"].is_null() && !twin["error"].is_null());
    let cost = |run: &Value| run["cost"].as_f64().expect("a cost");
    let mut ratios: Vec<f64> = both.map(|(run, twin)| cost(run) / cost(twin)).collect();
    ratios.sort_by(f64::total_cmp);
    ratios[ratios.len() / 2]
}

/// (problem, how long a step of Yoshida4 takes in steps of velocity Verlet, in fx).
fn prices() -> Vec<(String, f64)> {
    let report = report();
    let problems = report["problems"].as_array().expect("problems").iter();
    let price = |problem| times(&runs(problem, "fx", "yoshida4"), &runs(problem, "fx", "velocity_verlet"));
    problems.map(|problem| (problem["name"].as_str().expect("a name").to_owned(), price(problem))).collect()
}

/// The least and the greatest of these, as they are written.
fn span(values: impl Iterator<Item = f64>) -> (String, String) {
    let (min, max) = values.fold((f64::INFINITY, 0.0_f64), |(min, max), value| (min.min(value), max.max(value)));
    (format!("{min:.1}"), format!("{max:.1}"))
}

/// A text with its line breaks taken for spaces.
pub(crate) fn flowing(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn the_errors_in_the_guide_are_those_of_the_report() {
    let report = report();
    let accuracy = read("src/guide/accuracy.md");
    let mut rows = rows(&accuracy).skip_while(|row| row[0] != "integrator");
    let head = rows.next().expect("a table");
    let mut compared = 0;
    for row in rows.skip(1).take_while(|row| row.len() == head.len()) {
        for (&name, &said) in head.iter().zip(&row).skip(2) {
            let problem = among(&report["problems"], "name", &name.into());
            let rate: u32 = row[1].parse().expect("a rate");
            let run = among(&Value::Array(runs(&problem, "fx", row[0])), "rate", &rate.into());
            let error = run["error"].as_f64();
            assert_eq!(error.map_or("none".into(), |error| format!("{error:.1e}")), said, "{name} at {row:?}");
            compared += 1;
        }
    }
    assert_eq!(compared, 28);
}

#[test]
fn the_errors_with_contacts_in_the_guide_are_those_of_the_report() {
    let report = report();
    let accuracy = read("src/guide/accuracy.md");
    let mut rows = rows(&accuracy).skip_while(|row| row[0] != "ticks/s" || row[1] != "bouncing-ball");
    let head = rows.next().expect("a table");
    let said: Vec<_> = rows.skip(1).take_while(|row| row.len() == head.len()).collect();
    assert_eq!((head.len(), said.len()), (5, 3));
    for row in said {
        for (&name, &said) in head.iter().zip(&row).skip(1) {
            let problem = among(&report["contacts"], "name", &name.into());
            let rate: u32 = row[0].parse().expect("a rate");
            let run = among(&Value::Array(runs(&problem, "fx", "velocity_verlet")), "rate", &rate.into());
            let error = run["error"].as_f64().expect("an error");
            assert_eq!(format!("{error:.1e}"), said, "{name} at {row:?}");
        }
    }
}

#[test]
fn the_times_in_the_guide_are_those_of_the_report() {
    let accuracy = read("src/guide/accuracy.md");
    let table: Vec<Vec<&str>> = rows(&accuracy).collect();
    let said = table.iter().position(|row| row[0] == "times").expect("a row of times");
    let (head, said) = (&table[said - 2][1..], &table[said][1..]);
    let prices = prices();
    assert!(prices.iter().map(|(name, _)| name).eq(head), "{head:?}");
    let measured: Vec<String> = prices.iter().map(|(_, price)| format!("{price:.1}")).collect();
    assert_eq!(measured, said);

    // The text as well: problems with fields and problems without.
    let text = flowing(&accuracy);
    let without = |name: &str| ["damped-fall", "spin"].contains(&name);
    let (min, max) = span(prices.iter().filter(|(name, _)| !without(name)).map(|&(_, price)| price));
    let (spin, fall) = span(prices.iter().filter(|(name, _)| without(name)).map(|&(_, price)| price));
    let claim =
        format!("{min} to {max} times as long as one of velocity Verlet where fields act, {spin} and {fall} times");
    assert!(text.contains(&claim), "{claim}");

    let report = report();
    let problems = report["problems"].as_array().expect("problems").iter();
    let dearer = |problem| times(&runs(problem, "fx", "velocity_verlet"), &runs(problem, "f64", "velocity_verlet"));
    let (three, few): (Vec<_>, Vec<_>) = problems.partition(|problem| problem["name"] == "figure-eight");
    let (min, max) = span(few.into_iter().map(dearer));
    let three = dearer(three[0]);
    let claim = format!("takes {min} to {max} times as long for a body or two, {three:.1} times where three attract");
    assert!(text.contains(&claim), "{claim}");
}

/// The error of these runs at a cost, between the two that are nearest to it; `None` beyond them or where one has none.
fn error_at(runs: &[Value], cost: f64) -> Option<f64> {
    let point = |run: &Value| Some((run["cost"].as_f64()?.ln(), run["error"].as_f64()?.ln()));
    runs.windows(2).find_map(|pair| {
        let ((a, at_a), (b, at_b)) = (point(&pair[0])?, point(&pair[1])?);
        let part = (cost.ln() - a) / (b - a);
        (0.0..=1.0).contains(&part).then(|| (at_a + (at_b - at_a) * part).exp())
    })
}

#[test]
fn yoshida_errs_less_at_the_same_price_from_where_the_guide_says() {
    let report = report();
    let mut compared = 0;
    for problem in report["problems"].as_array().expect("problems").iter().filter(|problem| problem["name"] != "spin") {
        let (yoshida, verlet) = (runs(problem, "fx", "yoshida4"), runs(problem, "fx", "velocity_verlet"));
        let from = if problem["name"] == "stiff-pendulum" { 120 } else { 60 };
        for run in yoshida.iter().filter(|run| run["rate"].as_u64() >= Some(60)) {
            let Some(error) = run["error"].as_f64() else {
                assert!(run["rate"].as_u64() < Some(from), "{}: {run}", problem["name"]);
                continue;
            };
            assert!(run["rate"].as_u64() >= Some(from), "{}: {run}", problem["name"]);
            if let Some(same_price) = error_at(&verlet, run["cost"].as_f64().expect("a cost")) {
                assert!(error < same_price, "{}: {run}, Verlet {same_price}", problem["name"]);
                compared += 1;
            }
        }
    }
    // Eight problems at six rates, one of them not at the first, or nearly: beyond these Verlet was not tried as long.
    assert!((45..=50).contains(&compared), "{compared}");
}

#[test]
fn the_readme_says_of_other_engines_what_was_measured() {
    let readme = flowing(&read("README.md"));
    let performance = read("PERFORMANCE.md");
    let table: Vec<Vec<&str>> = rows(&performance).collect();
    let nanoseconds = |engine: &str| {
        let row = table.iter().find(|row| row[0].starts_with(engine)).unwrap_or_else(|| panic!("no {engine}"));
        row[1].split(',').next().expect("a figure").to_owned()
    };
    let [ours, box2d, third] = ["fx, wide", "Box2D 3", "rapier"].map(nanoseconds);
    let whole = |figure: &str| figure.split('.').next().expect("a figure").to_owned();
    let claim = format!("take {ours} ns each per step, where Box2D takes {} and rapier {third}", whole(&box2d));
    assert!(readme.contains(&claim), "{claim}");
}

/// The blocks of a text that are marked as of this kind.
fn blocks<'a>(text: &'a str, kind: &str) -> Vec<&'a str> {
    let fence = format!("```{kind}\n");
    let parts = text.match_indices(&fence).map(|(at, _)| &text[at + fence.len()..]);
    parts.filter_map(|rest| rest.split("```").next()).collect()
}

#[test]
fn the_excerpts_in_the_guide_stand_in_the_examples() {
    let chapters = [
        ("engines", "rust,ignore", 6, &["examples/bevy/src/main.rs"][..]),
        ("languages", "c", 8, &["examples/c/main.c"]),
        ("languages", "js", 2, &["examples/web/match.js", "examples/web/page.js"]),
    ];
    for (chapter, kind, count, examples) in chapters {
        let chapter = read(&format!("src/guide/{chapter}.md"));
        let excerpts = blocks(&chapter, kind);
        assert!(excerpts.len() >= count, "{kind}: {excerpts:?}");
        let sources: Vec<String> = examples.iter().map(|example| read(example)).collect();
        for excerpt in excerpts {
            assert!(sources.iter().any(|source| source.contains(excerpt)), "in none of {examples:?}:\n{excerpt}");
        }
    }
}

/// Targets of the links in a Markdown text; code is left out.
fn links(text: &str) -> Vec<&str> {
    let prose = text.split("```").step_by(2);
    let inline = prose.clone().flat_map(|text| text.split("](").skip(1).filter_map(|rest| rest.split(')').next()));
    let defined = prose.flat_map(|text| {
        text.lines().filter(|line| line.starts_with('[')).filter_map(|line| Some(line.split_once("]: ")?.1))
    });
    inline.chain(defined).collect()
}

/// A heading by its anchor: lower case, hyphens for spaces, no other signs.
fn anchor(heading: &str) -> String {
    let signs = heading.trim_start_matches('#').trim().chars().filter_map(|sign| match sign {
        ' ' => Some('-'),
        '-' | '_' => Some(sign),
        _ => sign.is_alphanumeric().then(|| sign.to_ascii_lowercase()),
    });
    signs.collect()
}

/// Returns true for a path in the package on docs.rs.
fn is_published(path: &Path) -> bool {
    static FILES: LazyLock<Vec<String>> = LazyLock::new(|| packaged("umbra-physics"));
    FILES.iter().any(|file| Path::new(file).starts_with(path))
}

/// Fault of a link in a file, if any.
fn fault(file: &Path, link: &str) -> Option<&'static str> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let (to, heading) = link.split_once('#').map_or((link, None), |(to, heading)| (to, Some(heading)));
    let target = match to.strip_prefix("https://docs.rs/crate/umbra-physics/latest/source/") {
        Some(path) if !is_published(Path::new(path)) => return Some("is not in the package"),
        Some(path) => root.join(path),
        None if to.is_empty() => root.join(file),
        None => root.join(file).parent()?.join(to),
    };
    let Some(heading) = heading else { return (!target.exists()).then_some("is not there") };
    let Ok(text) = std::fs::read_to_string(target) else { return Some("is not there") };
    let mut lines = text.split("```").step_by(2).flat_map(str::lines);
    let has = lines.any(|line| line.starts_with('#') && anchor(line) == heading);
    (!has).then_some("has no such heading")
}

/// The texts of a folder and of those in it that are the project's own.
fn texts(folder: &Path, paths: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        if path.is_dir() && !name.starts_with('.') && !["target", "seeds", "corpus", "artifacts"].contains(&name) {
            texts(&path, paths);
        } else if name.ends_with(".md") {
            paths.push(path);
        }
    }
}

#[test]
fn the_links_of_all_texts_lead_somewhere() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = Vec::new();
    texts(root, &mut files);
    assert!(files.len() >= 22, "{files:?}");
    let (mut count, mut wrong) = (0, Vec::new());
    for file in &files {
        let file = file.strip_prefix(root).expect("below the root");
        // Names of the library in the guide are for rustdoc to find.
        let is_ours = |link: &&str| match link.strip_prefix("http") {
            Some(_) => link.starts_with("https://docs.rs/crate/umbra-physics/"),
            None => !link.starts_with("crate::"),
        };
        for link in links(&read(&file.to_string_lossy())).into_iter().filter(is_ours) {
            match fault(file, link) {
                Some(fault) => wrong.push(format!("{}: {link} {fault}", file.display())),
                None => count += 1,
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(count >= 70, "{count}");
}

#[test]
fn a_link_that_leads_nowhere_is_seen() {
    let readme = Path::new("README.md");
    let text = "[a](b.md) and\n```\n[c](d)\n```\n[e]: docs/f.md\n";
    assert_eq!(links(text), ["b.md", "docs/f.md"]);
    assert_eq!(fault(readme, "docs/errors.md"), None);
    assert_eq!(fault(readme, "docs/none.md"), Some("is not there"));
    assert_eq!(fault(readme, "#where-to-begin"), None);
    assert_eq!(fault(Path::new("docs/errors.md"), "formats.md#no-such"), Some("has no such heading"));
    let docs = |path: &str| format!("https://docs.rs/crate/umbra-physics/latest/source/{path}");
    assert_eq!(fault(readme, &docs("examples/ggrs/adapter.rs")), None);
    assert_eq!(fault(readme, &docs("examples/ggrs/none.rs")), Some("is not in the package"));
    assert_eq!(fault(readme, &docs("capi/README.md")), Some("is not in the package"));
    assert_eq!(fault(readme, &docs("examples/c/main.c")), Some("is not in the package"));
}

#[test]
fn the_guide_has_its_chapters_and_all_say_so() {
    let [module, readme, library] = ["src/guide/mod.rs", "README.md", "src/lib.rs"].map(read);
    let start = readme.split("\n## ").find(|part| part.starts_with("Where to begin")).expect("where to begin");
    let mut chapters = 0;
    for entry in std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("src/guide")).expect("the guide") {
        let path = entry.expect("an entry").path();
        if path.extension().is_some_and(|extension| extension == "md") {
            let name = path.file_stem().and_then(|name| name.to_str()).expect("a name");
            let built = format!("include_str!(\"{name}.md\")]\npub mod {name} {{}}");
            assert!(module.contains(&built), "{name} is left out");
            assert!(module.contains(&format!("//! | [`{name}`] | ")), "{name} is not in the list");
            assert!(start.contains(&format!("`{name}`")), "{name} is not in the README");
            assert!(library.contains(&format!("(guide::{name})")), "{name} is not on the first page");
            chapters += 1;
        }
    }
    assert_eq!(chapters, 16);
}
