//! What the guide and the README have beside examples that run as tests: figures of the report, excerpts of a program, links.

use serde_json::Value;

/// The lines of a chapter's tables.
fn rows(chapter: &str) -> impl Iterator<Item = Vec<&str>> {
    let rows = chapter.lines().filter_map(|line| line.strip_prefix('|')?.strip_suffix('|'));
    rows.map(|row| row.split('|').map(|cell| cell.trim().trim_matches('`')).collect())
}

#[test]
fn the_errors_in_the_guide_are_those_of_the_report() {
    let report = include_str!("../../docs/report/report.json");
    let report: Value = serde_json::from_str(report).expect("the report");
    let among = |list: &Value, key: &str, is: &Value| {
        let found = list.as_array().expect("a list").iter().find(|entry| entry[key] == *is).cloned();
        found.unwrap_or_else(|| panic!("the report has no {key} {is}"))
    };
    let mut rows = rows(include_str!("../../src/guide/accuracy.md")).skip_while(|row| row[0] != "integrator");
    let head = rows.next().expect("a table");
    let mut compared = 0;
    for row in rows.skip(1).take_while(|row| row.len() == head.len()) {
        for (&name, &said) in head.iter().zip(&row).skip(2) {
            let problem = among(&report["problems"], "name", &name.into());
            let lines = problem["lines"].as_array().expect("lines").iter().filter(|line| line["scalar"] == "fx");
            let lines = Value::Array(lines.cloned().collect());
            let runs = among(&lines, "integrator", &row[0].into())["runs"].clone();
            let rate: u32 = row[1].parse().expect("a rate");
            let error = among(&runs, "rate", &rate.into())["error"].as_f64();
            assert_eq!(error.map_or("none".into(), |error| format!("{error:.1e}")), said, "{name} at {row:?}");
            compared += 1;
        }
    }
    assert_eq!(compared, 28);
}

#[test]
fn the_excerpts_in_the_guide_stand_in_the_example() {
    let example = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/bevy/src/main.rs");
    let example = std::fs::read_to_string(example).expect("the example, which the published package has not");
    let chapter = include_str!("../../src/guide/engines.md");
    let excerpts: Vec<_> = chapter.split("```rust,ignore\n").skip(1).map(|rest| rest.split("```").next()).collect();
    assert!(excerpts.len() >= 6, "{excerpts:?}");
    for excerpt in excerpts.into_iter().flatten() {
        assert!(example.contains(excerpt), "not in the example:\n{excerpt}");
    }
}

/// Where the links of a text in Markdown lead to, other than to the web.
fn links(text: &str) -> impl Iterator<Item = &str> {
    let links = text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    links.filter(|link| !link.starts_with("http"))
}

#[test]
fn the_links_of_the_readme_lead_somewhere() {
    let readme = include_str!("../../README.md");
    // A heading by its anchor: lower case, hyphens for spaces.
    let headings = readme.lines().filter_map(|line| line.strip_prefix("## "));
    let anchors: Vec<_> = headings.map(|heading| format!("#{}", heading.to_lowercase().replace(' ', "-"))).collect();
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let is_there = |link: &str| match link.starts_with('#') {
        true => anchors.iter().any(|anchor| anchor == link),
        false => root.join(link.split('#').next().unwrap_or_default()).exists(),
    };
    let (there, nowhere): (Vec<_>, Vec<_>) = links(readme).partition(|link| is_there(link));
    assert!(there.len() > 20 && nowhere.is_empty(), "{nowhere:?}");
}

#[test]
fn the_guide_has_its_chapters_and_says_so() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("src/guide");
    let module = include_str!("../../src/guide/mod.rs");
    let mut chapters = 0;
    for entry in std::fs::read_dir(folder).expect("the guide") {
        let path = entry.expect("an entry").path();
        if path.extension().is_some_and(|extension| extension == "md") {
            let name = path.file_stem().and_then(|name| name.to_str()).expect("a name");
            assert!(
                module.contains(&format!("include_str!(\"{name}.md\")]\npub mod {name} {{}}")),
                "{name} is left out"
            );
            assert!(module.contains(&format!("//! | [`{name}`] | ")), "{name} is not in the list");
            chapters += 1;
        }
    }
    assert_eq!(chapters, 9);
}
