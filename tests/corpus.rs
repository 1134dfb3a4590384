//! The fuzz targets by their committed inputs, on stable: what was found once is not found again.
//!
//! `fuzz/README.md` says what each target asserts. `UMBRA_BLESS=1 cargo test --release --all-features --test corpus -- --ignored
//! write_seeds` writes inputs for a fuzzer to begin with.

#[path = "support/seeds.rs"]
mod seeds;

#[path = "../fuzz/src/lib.rs"]
#[allow(
    dead_code,
    unreachable_pub,
    reason = "it is the library of the fuzz targets there, and benches use a part of it"
)]
mod fuzz;

use fuzz::tally::Tally;
use std::collections::BTreeSet;
use std::fs;
use std::panic::{catch_unwind, resume_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::Instant;

use umbra_physics::{
    BodyDef, ColliderDef, Command, Fx, PHYSICS_VERSION, Random, Shape, Vec2, World, WorldDef, limits, vec2,
};
use umbra_scene::Scene;

fn folder(target: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/seeds").join(target)
}

/// The committed inputs of a target, by their names.
fn inputs(target: &str) -> Vec<(PathBuf, Vec<u8>)> {
    let files = fs::read_dir(folder(target)).unwrap_or_else(|error| panic!("no inputs for {target}: {error}"));
    let mut paths: Vec<PathBuf> = files.map(|file| file.expect("a file").path()).collect();
    paths.sort();
    paths.into_iter().map(|path| (path.clone(), fs::read(path).expect("it can be read"))).collect()
}

/// Runs the committed inputs of the target with this name.
fn run(target: &str) {
    let (_, run) = fuzz::TARGETS.into_iter().find(|(name, _)| *name == target).expect("a target");
    let inputs = inputs(target);
    // A folder that lost its files would pass.
    assert!(inputs.len() >= 10, "{} inputs for {target}", inputs.len());
    for (path, input) in inputs {
        // Where it panics, this is what the harness shows.
        println!("{}", path.display());
        run(&input);
    }
}

macro_rules! corpora {
    ($($target:ident)*) => {
        $(
            #[test]
            fn $target() {
                run(stringify!($target));
            }
        )*

        #[test]
        fn every_target_has_a_corpus_and_a_test() {
            let tested = BTreeSet::from([$(stringify!($target)),*]);
            let targets: BTreeSet<&str> = fuzz::TARGETS.into_iter().map(|(name, _)| name).collect();
            assert_eq!(tested, targets);
            let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz");
            let names = |folder: &str| -> BTreeSet<String> {
                let files = fs::read_dir(root.join(folder)).expect("it is there");
                let stem = |path: PathBuf| path.file_stem().and_then(|name| name.to_str()).map(str::to_string);
                files.filter_map(|file| stem(file.expect("a file").path())).collect()
            };
            let expected: BTreeSet<String> = tested.into_iter().map(str::to_string).collect();
            assert_eq!((names("fuzz_targets"), names("seeds")), (expected.clone(), expected.clone()));
            let manifest = fs::read_to_string(root.join("Cargo.toml")).expect("it is there");
            for target in expected {
                assert!(manifest.contains(&format!("path = \"fuzz_targets/{target}.rs\"")), "{target}");
            }
        }
    };
}

corpora!(commands contact_solver fx_f64 kernels queries replay scene snapshot threads work);

#[test]
fn corpora_are_small() {
    let sizes = fuzz::TARGETS.map(|(target, _)| {
        let inputs = inputs(target);
        let size: usize = inputs.iter().map(|(_, input)| input.len()).sum();
        assert!(inputs.len() <= 25 && size <= 60_000, "{target}: {} inputs, {size} bytes", inputs.len());
        size
    });
    assert!(sizes.iter().sum::<usize>() < 155_000, "{sizes:?}");
}

/// The least medians of ticks and of touching manifolds in a tick that committed inputs have, by target. Others have no world of their own,
/// or one without colliders: the bound of `fx_f64` covers no contacts, and `work` is about free flight. In `contact_solver` impacts throw
/// most bodies apart in the first tick.
const MEDIANS: [(&str, u64, u64); 7] = [
    ("commands", 8, 2),
    ("contact_solver", 4, 1),
    ("fx_f64", 10, 0),
    ("queries", 2, 3),
    ("replay", 4, 2),
    ("snapshot", 4, 2),
    ("threads", 4, 2),
];

/// The fewest comparisons of a world with one without sleep while a body sleeps, of all committed inputs of `commands`: where a body comes
/// near a sleeper they begin anew, which must not be everywhere.
const SLEPT: u64 = 20;

/// Steps and contacts of the committed inputs: they have to reach the solver. With `UMBRA_CORPUS=fuzz/corpus` it prints them instead
/// for each input of a campaign: ticks, touching manifolds in a tick, the most of them, µs that it takes, the file.
#[test]
fn inputs_have_ticks_and_contacts() {
    let median = |mut values: Vec<u64>| {
        values.sort_unstable();
        values[values.len() / 2]
    };
    for (target, run) in fuzz::TARGETS {
        if let Some(corpus) = std::env::var_os("UMBRA_CORPUS") {
            for file in fs::read_dir(Path::new(&corpus).join(target)).into_iter().flatten() {
                let path = file.expect("a file").path();
                let input = fs::read(&path).expect("it can be read");
                let tally = Tally::of(run, &input);
                // What else the machine does comes on top of one of the times, not of each.
                let times = [(); 3].map(|()| {
                    let start = Instant::now();
                    run(&input);
                    start.elapsed().as_micros()
                });
                let microseconds = times.iter().min().expect("three of them");
                println!("{} {} {} {microseconds} {}", tally.ticks, tally.mean(), tally.max_contacts, path.display());
            }
            continue;
        }
        let (inputs, start) = (inputs(target), Instant::now());
        let tallies: Vec<Tally> = inputs.iter().map(|(_, input)| Tally::of(run, input)).collect();
        let rate = inputs.len() as f64 / start.elapsed().as_secs_f64();
        let slept: u64 = tallies.iter().map(|tally| tally.slept).sum();
        let median_of = |value: fn(&Tally) -> u64| median(tallies.iter().map(value).collect());
        let [ticks, mean, max] =
            [median_of(|tally| tally.ticks), median_of(Tally::mean), median_of(|tally| tally.max_contacts)];
        println!(
            "{target}: medians of {ticks} ticks, {mean} touching manifolds in a tick, at most {max}; {slept} comparisons \
             with a sleeper; {rate:.0} inputs/s"
        );
        assert!(target != "commands" || slept >= SLEPT, "{slept} comparisons with a sleeping body");
        if let Some((_, least, fewest)) = MEDIANS.into_iter().find(|(name, ..)| *name == target) {
            assert!(ticks >= least && mean >= fewest, "{target}: {ticks} ticks with {mean} touching manifolds");
        }
    }
}

/// A committed input with some of its bytes changed, or with a part of another one.
fn mutated(random: &mut Random, inputs: &[(PathBuf, Vec<u8>)]) -> Vec<u8> {
    let below = |random: &mut Random, end: usize| random.below(end.max(1) as u64) as usize;
    let (_, input) = &inputs[below(random, inputs.len())];
    let mut input = input.clone();
    for _ in 0..1 + below(random, 8) {
        let at = below(random, input.len());
        match random.below(4) {
            0 if at < input.len() => input[at] ^= 1 << random.below(8),
            1 if at < input.len() => input[at] = random.bits() as u8,
            2 => input.insert(at, random.bits() as u8),
            _ => {
                let (_, donor) = &inputs[below(random, inputs.len())];
                let from = below(random, donor.len());
                let part = &donor[from..(from + below(random, 32)).min(donor.len())];
                let end = (at + below(random, 32)).min(input.len());
                input.splice(at..end, part.iter().copied());
            }
        }
    }
    input.truncate(2048);
    input
}

/// The CPU time of this thread, s, where the system says it.
fn cpu_seconds() -> Option<f64> {
    let text = fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    text.split(' ').next()?.parse::<f64>().ok().map(|nanoseconds| nanoseconds / 1e9)
}

/// Runs each target for `UMBRA_SECONDS` (5), two at once, by `UMBRA_SEED` on the same inputs each time. Coverage does not guide the
/// changes: `.ci/fuzz` does that.
#[test]
#[ignore = "takes half a minute: `cargo test --release --all-features --test corpus -- --ignored seconds`"]
fn seconds_of_mutated_inputs() {
    let number = |name, or| std::env::var(name).map_or(or, |text| text.parse().expect("a number"));
    let (seed, seconds) = (seeds::run_seed(1), number("UMBRA_SECONDS", 5));
    /// Inputs of each target, and the seconds beyond the given ones that they may take on a busy machine.
    const FEWEST: u64 = 10;
    const LONGEST: u64 = 60;
    let next = AtomicUsize::new(0);
    let work = || {
        while let Some((target, run)) = fuzz::TARGETS.get(next.fetch_add(1, Ordering::Relaxed)) {
            let (mut inputs, mut random, start) = (inputs(target), Random::seeded(seed), Instant::now());
            // What was found once is run as it is by the tests above. Some of it is of many bodies.
            inputs
                .retain(|(path, _)| !path.file_name().is_some_and(|name| name.to_string_lossy().starts_with("found-")));
            let begun = cpu_seconds().unwrap_or_default();
            let mut count = 0;
            while count < FEWEST || start.elapsed().as_secs() < seconds {
                let input = mutated(&mut random, &inputs);
                if let Err(panic) = catch_unwind(|| run(&input)) {
                    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{target}-{count}"));
                    fs::write(&file, &input).expect("a file");
                    eprintln!("{target}: input {count} fails: {}", file.display());
                    resume_unwind(panic);
                }
                count += 1;
            }
            match cpu_seconds() {
                // Others step on threads of their own.
                Some(end) if *target != "threads" => {
                    println!("{target}: {count} inputs, {:.0} a second of CPU time", count as f64 / (end - begun));
                }
                _ => println!("{target}: {count} inputs"),
            }
            assert!(start.elapsed().as_secs() < seconds + LONGEST, "{target}: {count} inputs");
        }
    };
    thread::scope(|scope| {
        scope.spawn(work);
        scope.spawn(work);
    });
}

/// The dictionary has the fields that the reader of scenes knows.
#[test]
fn the_dictionary_has_every_field_of_a_scene() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let dictionary = fs::read_to_string(root.join("fuzz/dictionaries/scene.txt")).expect("it is there");
    let mut looked = 0;
    let folder = fs::read_dir(root.join("crates/umbra-scene/src")).expect("it is there");
    for path in folder.map(|entry| entry.expect("an entry").path()).filter(|path| path.is_file()) {
        let source = fs::read_to_string(path).expect("it can be read");
        let code = source.split("#[cfg(test)]").next().expect("there is a first part");
        for call in
            ["get(\"", "need(\"", "or(\"", "kept(\"", "words(&object, \"", "term(\"", "set_by(object, \"", "apply(\""]
        {
            let named = code.split(call).skip(1).filter_map(|rest| rest.split('"').next());
            let is_field = |text: &&str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_lowercase() || b == b'_');
            for field in named.filter(is_field) {
                assert!(dictionary.contains(&format!("\"\\\"{field}\\\":\"")), "{field}");
                looked += 1;
            }
        }
    }
    assert!(looked > 80, "{looked}");
}

/// Inputs that are to be refused: values in another encoding than the one they are written in, and a value that no call allows.
fn refused_inputs() -> Vec<(&'static str, &'static str, Vec<u8>)> {
    let corners = [vec2(0, 0), vec2(3, 0), vec2(2, 2)];
    let def = ColliderDef::ghost(Shape::polygon(&corners).expect("a shape"));
    let in_bytes = |corners: &[Vec2]| -> Vec<u8> {
        corners.iter().flat_map(|c| [c.x, c.y]).flat_map(|c| c.to_bits().to_le_bytes()).collect()
    };
    let mut clockwise = corners;
    clockwise.reverse();
    let replaced = |bytes: &[u8], old: &[u8], new: &[u8]| {
        let at = bytes.windows(old.len()).rposition(|bytes| bytes == old).expect("it is there");
        [&bytes[..at], new, &bytes[at + old.len()..]].concat()
    };
    let polygon = |bytes: &[u8]| replaced(bytes, &in_bytes(&corners), &in_bytes(&clockwise));

    let mut world = World::new(WorldDef::default()).expect("a world");
    for law in fuzz::author::custom_forces() {
        world.register_custom_force(law).expect("its id is free");
    }
    let body = world.add_body(BodyDef::dynamic().with_collider(def.clone())).expect("a body");
    let command = Command::AddCollider { body, def }.to_bytes();
    // Between the head of a snapshot and its hash.
    let whole = world.snapshot().to_bytes();
    let state = &whole[16..whole.len() - 16];
    let law = |id: u64, version: u32| [&id.to_le_bytes()[..], &version.to_le_bytes()].concat();
    let custom_forces = replaced(state, &[law(0, 1), law(1, 3)].concat(), &[law(1, 3), law(0, 1)].concat());
    // An ulp faster than a body may be.
    let bits = |speed: Fx| speed.to_bits().to_le_bytes();
    world.set_velocity(body, Vec2::new(limits::SPEED, Fx::ZERO)).expect("it is within the limit");
    let fastest = world.snapshot().to_bytes();
    let too_fast = replaced(&fastest[16..fastest.len() - 16], &bits(limits::SPEED), &bits(limits::SPEED + Fx::DELTA));
    let first = |kind: u8, bytes: &[u8]| [&[kind], bytes].concat();
    vec![
        ("replay", "second-polygon", first(7, &polygon(&command))),
        ("snapshot", "second-polygon", first(1, &polygon(state))),
        ("snapshot", "second-custom-forces", first(1, &custom_forces)),
        ("snapshot", "too-fast", first(1, &too_fast)),
    ]
}

#[test]
fn refused_inputs_are_committed() {
    for (target, name, bytes) in refused_inputs() {
        assert!(fs::read(folder(target).join(name)).is_ok_and(|file| file == bytes), "{target}/{name}: UMBRA_BLESS=1");
    }
}

/// Random bytes, a third of them zeros: these end a list, and are what is usual.
fn random_bytes(length: u64, random: &mut Random) -> Vec<u8> {
    (0..length).map(|_| if random.below(3) == 0 { 0 } else { random.bits() as u8 }).collect()
}

/// An input of a target in which bodies lie in a pile and most of them touch; `start` makes the first bytes.
fn piled(
    target: &str,
    [least, more]: [u64; 2],
    random: &mut Random,
    start: impl Fn(&mut Random) -> Vec<u8>,
) -> Vec<u8> {
    let (_, run) = fuzz::TARGETS.into_iter().find(|(name, _)| *name == target).expect("a target");
    let (_, ticks, manifolds) = MEDIANS.into_iter().find(|(name, ..)| *name == target).expect("one with medians");
    loop {
        let length = least + random.below(more);
        let mut bytes = random_bytes(length, random);
        let start = start(random);
        bytes.splice(..start.len(), start);
        let tally = Tally::of(run, &bytes);
        if tally.ticks >= ticks && tally.mean() >= manifolds {
            return bytes;
        }
    }
}

/// Writes inputs for a fuzzer to begin with into `fuzz/corpus`: random bytes for the targets that make worlds of them, piles, the
/// repository's scenes. Among the committed ones, it writes the files of this format and physics version.
#[test]
#[ignore = "writes files"]
fn write_seeds() {
    assert!(std::env::var_os("UMBRA_BLESS").is_some(), "UMBRA_BLESS=1 writes inputs to fuzz/corpus and fuzz/seeds");
    let mut random = Random::seeded(1);
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let write_to = |folder: PathBuf, name: &str, bytes: &[u8]| {
        fs::create_dir_all(&folder).expect("a folder");
        fs::write(folder.join(name), bytes).expect("it can be written");
    };
    let write = |target: &str, name: &str, bytes: &[u8]| write_to(root.join("fuzz/corpus").join(target), name, bytes);
    for target in ["commands", "fx_f64", "kernels", "replay", "snapshot", "work"] {
        for i in 0..16u8 {
            let length = random.below(if target == "kernels" { 60 } else { 400 });
            let mut bytes = random_bytes(length, &mut random);
            // The first byte says what the others are.
            bytes.insert(0, i);
            write(target, &format!("random-{i:02}"), &bytes);
        }
    }
    for (target, name, bytes) in refused_inputs() {
        write_to(folder(target), name, &bytes);
    }
    // Bodies that sleep beside others in touch, in worlds that are compared with one without sleep.
    let mut chance = Random::seeded(3);
    let sleepers = core::iter::repeat_with(|| {
        let start = [241, 4 + chance.below(4) as u8 + 16 * chance.below(4) as u8];
        [&start, &random_bytes(300, &mut chance)[..]].concat()
    });
    let is_asleep = |bytes: &Vec<u8>| {
        let tally = Tally::of(fuzz::commands::run, bytes);
        tally.slept >= 5 && tally.mean() >= 1
    };
    for (number, bytes) in sleepers.filter(is_asleep).take(5).enumerate() {
        write_to(folder("commands"), &format!("asleep-{number}"), &bytes);
    }
    // Of each promise, piles that stay in touch.
    let mut choices = Random::seeded(2);
    for (promise, number) in
        (0..10).flat_map(|promise| [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10].map(|number| (promise, number)))
    {
        // A pile with values of one of four kinds, which falls together for a while of four lengths.
        let length = if number == 0 { 240 } else { 0 };
        let start = |random: &mut Random| vec![length + promise, 4 + random.below(4) as u8 + 16 * (number % 4)];
        write("commands", &format!("piled-{promise}-{number:02}"), &piled("commands", [150, 200], &mut choices, start));
    }
    for number in 0..110 {
        // A file made by the author, of a pile.
        let start = |_: &mut Random| vec![[35, 99, 163][number % 3]];
        write("snapshot", &format!("piled-{number:03}"), &piled("snapshot", [120, 120], &mut choices, start));
        let start = |_: &mut Random| vec![[35, 36, 99, 100][number % 4]];
        write("replay", &format!("piled-{number:03}"), &piled("replay", [120, 120], &mut choices, start));
    }
    for number in 0..90 {
        let start = |_: &mut Random| Vec::new();
        write(
            "contact_solver",
            &format!("piled-{number:02}"),
            &piled("contact_solver", [400, 300], &mut choices, start),
        );
    }
    for number in 0..15 {
        write(
            "threads",
            &format!("piled-{number:02}"),
            &piled("threads", [200, 100], &mut choices, |_| vec![17 * number]),
        );
    }
    let mut large = random_bytes(300, &mut choices);
    large[0] = 255;
    write("threads", "large", &large);
    for number in 0..40 {
        let start = |_: &mut Random| vec![128];
        write("queries", &format!("piled-{number:02}"), &piled("queries", [300, 300], &mut choices, start));
    }
    // Of each function of numbers, with all of its arguments.
    for (i, again) in (0..18u8).flat_map(|i| [(i, 0), (i, 1)]) {
        let mut bytes = vec![i];
        bytes.extend((0..100).map(|_| random.bits() as u8));
        // The sign of the first argument: each of the two.
        bytes[8] = bytes[8] & 0x7f | again << 7;
        write("kernels", &format!("function-{i:02}-{again}"), &bytes);
    }
    // Few contacts, and many.
    for i in 0..32 {
        let bytes: Vec<u8> = (0..60 + 20 * i).map(|_| random.bits() as u8).collect();
        write("contact_solver", &format!("random-{i:02}"), &bytes);
    }
    // Bodies that rays meet: many, and queries to the end.
    for i in 0..32 {
        let bytes: Vec<u8> = (0..900 + 36 * i).map(|_| random.bits() as u8).collect();
        write("queries", &format!("random-{i:02}"), &bytes);
    }
    for file in fs::read_dir(root.join("scenes")).expect("there are scenes") {
        let path = file.expect("a file").path();
        let text = fs::read_to_string(&path).unwrap_or_default();
        if Scene::parse(&text).is_ok() {
            write("scene", path.file_name().and_then(|name| name.to_str()).expect("a name"), text.as_bytes());
        }
    }
    for (target, kind, extension) in [("snapshot", "snapshot", "umbrasnp"), ("replay", "replay", "umbrarep")] {
        let end = format!("-version{PHYSICS_VERSION}.{extension}");
        let files = fs::read_dir(root.join("tests/files")).expect("there are files");
        let mut paths = files.map(|file| file.expect("a file").path());
        let path = paths.find(|path| path.to_string_lossy().ends_with(&end)).expect("this law's");
        let file = fs::read(path).expect("it can be read");
        write_to(folder(target), &format!("{kind}-version{PHYSICS_VERSION}"), &[&[0], &file[..]].concat());
    }
}
