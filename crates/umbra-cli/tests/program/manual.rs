//! Things that come with the program: scenes, completions, pages of the manual.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::{root, umbra};

const COMMANDS: [&str; 8] = ["run", "view", "verify", "diff", "scenes", "selftest", "completions", "man"];

fn printed(arguments: &[&str]) -> String {
    let output = umbra(arguments);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    assert!(output.stderr.is_empty(), "{arguments:?}");
    String::from_utf8(output.stdout).expect("UTF-8")
}

#[test]
fn the_scenes_are_those_of_the_repository_and_written_as_they_are() {
    let files = fs::read_dir(root().join("scenes")).expect("scenes").map(|entry| entry.expect("an entry").path());
    let scene = |path: &Path| {
        (path.file_stem().expect("a name").to_str().expect("UTF-8").to_owned(), fs::read_to_string(path).expect("text"))
    };
    let scenes: BTreeMap<String, String> = files.map(|path| scene(&path)).collect();
    let (list, lines) = (printed(&["scenes"]), printed(&["scenes", "--json"]));
    assert!(list.lines().filter_map(|line| line.split_whitespace().next()).eq(scenes.keys()), "{list}");
    assert!(list.contains("\nkepler            "), "{list}");
    for (line, (name, text)) in lines.lines().zip(&scenes) {
        let line: serde_json::Value = serde_json::from_str(line).expect("JSON");
        assert_eq!(line["name"].as_str(), Some(&name[..]));
        assert!(["title", "about"].iter().all(|key| line[key].as_str().is_some_and(|text| !text.is_empty())), "{line}");
        assert!(line["ticks"].is_u64() && line["bodies"].is_u64(), "{line}");
        assert_eq!(printed(&["scenes", name]), *text, "{name}");
    }
    assert_eq!(lines.lines().count(), scenes.len());
    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{}-scene.json", std::process::id()));
    assert_eq!(printed(&["scenes", "pile", "--out", file.to_str().expect("UTF-8")]), "");
    assert_eq!(fs::read_to_string(&file).expect("it is there"), scenes["pile"]);
    fs::remove_file(file).expect("it is there");
    for (arguments, said) in [
        (&["scenes", "pyle"][..], "error: invalid value 'pyle' for '[NAME]'"),
        (&["scenes", "--out", "x.json"], "error: "),
        (&["scenes", "pile", "--json"], "error: "),
    ] {
        let output = umbra(arguments);
        assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{arguments:?}");
        assert!(String::from_utf8_lossy(&output.stderr).starts_with(said), "{arguments:?}");
    }
    for (wrong, tip) in [("pil", "a similar value exists: 'pile'"), ("pyramyd", "a similar value exists: 'pyramid'")] {
        let said = String::from_utf8(umbra(&["scenes", wrong]).stderr).expect("UTF-8");
        assert!(said.contains(tip) && said.contains("kepler"), "{said}");
    }
    assert!(!printed(&["scenes", "--help"]).contains("kepler"), "the list is long");
}

#[test]
fn a_missing_file_with_the_name_of_a_scene_is_written_by_scenes() {
    let replay = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{}-missing.umbrarep", std::process::id()));
    let replay = replay.to_str().expect("UTF-8");
    printed(&["run", "scenes/pile.json", "--ticks", "1", "--record", replay]);
    let tip =
        "; `umbra scenes pile --out pile.json` writes the scene of this name that comes with the program [E801]\n";
    for file in ["pile", "pile.json", "no/pile.json"] {
        for arguments in [&["run", file][..], &["view", file, "--plot", "p.svg"], &["verify", "--start", file, replay]]
        {
            let output = umbra(arguments);
            let said = String::from_utf8(output.stderr).expect("UTF-8");
            assert!(said.starts_with(&format!("{file}: cannot read: ")) && said.ends_with(tip), "{said}");
            assert_eq!(output.status.code(), Some(2));
        }
    }
    let said = String::from_utf8(umbra(&["run", "heap.json"]).stderr).expect("UTF-8");
    assert!(!said.contains("umbra scenes"), "{said}");
    fs::remove_file(replay).expect("it is there");
}

#[test]
fn shells_know_the_commands_and_their_options() {
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let script = printed(&["completions", shell]);
        for word in COMMANDS.iter().chain(&["hash-every", "stream", "impulses"]) {
            assert!(script.contains(word), "{word} for {shell}");
        }
    }
    assert_eq!(umbra(&["completions", "dos"]).status.code(), Some(2));
}

#[test]
fn each_command_has_a_page_with_its_options() {
    let page = printed(&["man"]);
    assert!(page.contains(".TH umbra 1 "), "{page}");
    for command in COMMANDS {
        assert!(page.contains(&format!("umbra\\-{command}(1)")), "{command} in {page}");
        let page = printed(&["man", command]);
        assert!(page.contains(&format!(".TH umbra-{command} 1 ")) && page.contains("umbra 0."), "{page}");
        let help = printed(&[command, "--help"]);
        let options = help.split_whitespace().filter_map(|word| word.strip_prefix("--"));
        for option in options.map(|option| option.trim_end_matches(|c: char| !c.is_ascii_alphanumeric())) {
            let escaped = format!("\\-\\-{}", option.replace('-', "\\-"));
            assert!(page.contains(&escaped) || option.is_empty(), "--{option} of {command} in {page}");
        }
    }
    let output = umbra(&["man", "walk"]);
    assert_eq!(output.status.code(), Some(2));
    let said = "there is no command \"walk\": `umbra help` lists them\n";
    assert_eq!(String::from_utf8_lossy(&output.stderr), said);
}
