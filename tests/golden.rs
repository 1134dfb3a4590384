//! The corpus gives the digests that are written down, in debug and release, on any number of threads, with wide vectors
//! and without: `src/selftest/golden.txt` holds them, a line a scene.
//!
//! `UMBRA_BLESS=1 cargo test --release --all-features --test engine golden` writes the file. It takes new scenes as they
//! are; a digest that changes needs another `PHYSICS_VERSION`, and a line in the changelog. (To change a scene, take its line out.)

use std::path::Path;
use std::{env, fs};

use umbra_physics::PHYSICS_VERSION;
use umbra_physics::scalar::internals::VectorSet;
use umbra_physics::selftest::{self, Golden, Outcome, Total, golden, scenes};

fn path(below: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(below)
}

fn outcomes() -> Vec<(&'static str, Outcome)> {
    scenes().iter().map(|scene| (scene.name(), scene.run().unwrap_or_else(|failure| panic!("{failure}")))).collect()
}

/// The scenes of a list that give something else now.
fn changed(list: Golden<'_>, outcomes: &[(&'static str, Outcome)]) -> Vec<String> {
    let differs = |(name, now): &&(&'static str, Outcome)| list.scene(name).is_some_and(|then| then != *now);
    outcomes.iter().filter(differs).map(|(name, now)| format!("{name} gives {:016x}", now.digest)).collect()
}

#[test]
fn every_scene_gives_its_golden_digest() {
    let outcomes = outcomes();
    let all = outcomes.iter().copied().collect::<Total>().outcome();
    if env::var_os("UMBRA_BLESS").is_some_and(|value| value == "1") {
        let file = path("src/selftest/golden.txt");
        // What is in the file now, not when this was compiled.
        let old = fs::read_to_string(&file).unwrap_or_default();
        let old = Golden::parse(&old);
        let changed = changed(old, &outcomes);
        assert!(
            old.physics_version() != Some(PHYSICS_VERSION) || changed.is_empty(),
            "results changed, so PHYSICS_VERSION has to change: {changed:#?}"
        );
        let mut text = String::new();
        Golden::write(&mut text, PHYSICS_VERSION, outcomes, all).expect("a string takes it");
        fs::write(file, text).expect("the file can be written");
        return;
    }
    assert_eq!(
        golden().physics_version(),
        Some(PHYSICS_VERSION),
        "the golden digests are of another physics version: bless them"
    );
    assert_eq!(changed(golden(), &outcomes), [""; 0]);
    let listed: Vec<_> = golden().scenes().collect();
    assert_eq!(listed, outcomes, "scenes came or went: bless them");
    assert_eq!(golden().all(), Some(all));
}

#[test]
fn all_at_once_is_one_by_one() {
    let all = outcomes().into_iter().collect::<Total>().outcome();
    assert_eq!(selftest::run(), Ok(all));
}

#[test]
fn a_new_physics_version_is_in_the_changelog() {
    let changelog = fs::read_to_string(path("CHANGELOG.md")).expect("the changelog");
    let (_, results) = changelog.split_once("\n### Results changed\n").expect("a heading for changed results");
    let results = results.split("\n#").next().unwrap_or_default();
    assert!(
        results.contains(&format!("\n- Physics version {PHYSICS_VERSION}: ")),
        "the changelog does not say what changed with physics version {PHYSICS_VERSION}"
    );
}

#[test]
fn a_list_is_read_as_it_was_written() {
    let some = [("one", Outcome { ticks: 3, digest: 0xab }), ("two", Outcome { ticks: 12, digest: u64::MAX })];
    let all = Outcome { ticks: 15, digest: 1 };
    let mut text = String::new();
    Golden::write(&mut text, 77, some, all).expect("a string takes it");
    let list = Golden::parse(&text);
    assert_eq!((list.physics_version(), list.all()), (Some(77), Some(all)));
    assert_eq!(list.scenes().collect::<Vec<_>>(), some);
    assert_eq!(list.scene("two"), Some(some[1].1));
    assert_eq!(changed(list, &[("one", all), some[1], ("three", all)]), ["one gives 0000000000000001"]);
    for broken in [
        "",
        "physics_version",
        "physics_version x\none 1",
        "one 3 xyz\none 3\n\n# one 3 ab",
        "physics_version 99999999999",
    ] {
        let list = Golden::parse(broken);
        assert_eq!((list.physics_version(), list.all(), list.scenes().count()), (None, None, 0), "{broken}");
    }
}

#[test]
fn the_corpus_is_large_and_its_names_are_words() {
    let names: Vec<&str> = scenes().iter().map(|scene| scene.name()).collect();
    assert!(names.len() >= 24, "{} scenes", names.len());
    for (i, name) in names.iter().enumerate() {
        assert!(name.bytes().all(|b| matches!(b, b'a'..=b'z' | b'0'..=b'9' | b'_')) && *name != "all", "{name}");
        assert!(!names[..i].contains(name), "{name} twice");
    }
    assert!(scenes().iter().all(|scene| !scene.about().is_empty()));
}

#[test]
fn wide_vectors_change_no_digest() {
    // Whatever other tests do meanwhile: none asks which there are.
    let run = |set| {
        VectorSet::allow(set);
        outcomes()
    };
    let without = run(VectorSet::Portable);
    let wide = VectorSet::available().filter(|&set| set != VectorSet::Portable);
    wide.for_each(|set| assert_eq!(run(set), without, "{set:?}"));
    VectorSet::allow(VectorSet::Avx512);
}

#[cfg(feature = "parallel")]
#[test]
fn the_number_of_threads_changes_no_digest() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(outcomes)
    };
    let single = run(1);
    // The self-test of the program has a pool of 2 and one of 8.
    for &threads in if crate::seeds::is_short() { &[3][..] } else { &[2, 3, 8] } {
        assert_eq!(run(threads), single, "{threads} threads");
    }
}
