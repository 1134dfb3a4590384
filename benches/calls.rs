//! Cost of a kilobyte of commands at worst, in steps of the world that it is sent to, by counting instructions under
//! callgrind.
//!
//! `cargo bench -p umbra-physics --bench calls -- check 16000` counts those of `benches/scenes/hostile.rs`, a line each: whether their cost
//! is constant, how many commands they are, then for worlds of 1,000 and of 4,000 bodies the instructions of the calls alone, and how many
//! steps the calls and what they leave the next step to do come to. After them it counts calls that name 4,000 and 16,000 things.
//! `tests/costs.rs` holds all of them to bounds. `search 600` looks for worse ones for so many seconds, and fails if it comes to one that
//! costs more than ten steps; `search 600 7` begins elsewhere.

use std::collections::BTreeMap;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use umbra_physics::{Command, Input, Inputs, Integrator, Random, World};

#[path = "../fuzz/src/work.rs"]
#[allow(dead_code, unreachable_pub, reason = "it is public in the crate of the fuzz targets, and runs by itself there")]
mod work;

#[path = "../tests/support/commands.rs"]
#[allow(dead_code, reason = "the tests write other commands too")]
mod commands;
#[path = "../tests/support/random.rs"]
#[allow(dead_code, reason = "the tests draw in other ways too")]
mod random;

#[path = "scenes/counting.rs"]
mod counting;
#[path = "scenes/hostile.rs"]
mod hostile;

use commands::{Author, KINDS};
use hostile::{Growing, Hostile};
use random::SplitMix;
use work::{BYTES, Busy, Genes};

/// The most bytes of commands in the tick that is counted.
const KILOBYTE: usize = 1024;
/// A kilobyte may cost as much as so many steps.
const MOST_STEPS: u64 = 10;
/// Candidates of a generation.
const GENERATION: usize = 16;
/// Number of commands that a candidate of the search repeats.
const PATTERN: usize = 6;

/// The function whose calls are counted.
#[inline(never)]
fn counted<F: FnOnce()>(act: F) {
    black_box(act)();
}

/// The commands, over and over, as the inputs of one tick.
fn kilobyte(commands: impl IntoIterator<Item = Command>) -> Inputs {
    let (mut inputs, mut bytes) = (Inputs::new(), 0);
    for (sequence, command) in (0..).zip(commands) {
        bytes += command.to_bytes().len();
        if bytes > KILOBYTE {
            break;
        }
        inputs.insert(Input { player: 0, sequence, command }).expect("each has a place of its own");
    }
    inputs
}

/// Counts a step of the calm world, with all bodies awake, then the inputs to the other one, then two steps after them.
fn measure(mut calm: World, mut world: World, inputs: &Inputs) {
    world.step();
    calm.set_sleep_after(None).expect("it may be");
    calm.step();
    counted(|| _ = calm.step());
    counted(|| _ = black_box(world.carry_out(inputs)));
    counted(|| _ = world.step());
    counted(|| _ = world.step());
}

/// Number of times [`measure`] counts.
const COUNTS: usize = 4;

/// Things that [`measure`] counts.
#[derive(Clone, Copy, Debug)]
struct Counts {
    step: u64,
    calls: u64,
    step_after: u64,
    next_step: u64,
}

impl Counts {
    fn all(counts: &[u64]) -> Vec<Self> {
        let counted = |c: &[u64]| Self { step: c[0], calls: c[1], step_after: c[2], next_step: c[3] };
        counts.chunks_exact(COUNTS).map(counted).collect()
    }

    /// Cost of the calls and of the work they leave to the next step, in steps. Things they add for good, such as a
    /// force field that acts on all bodies, are part of its step.
    fn steps(&self) -> f64 {
        let once = self.calls + self.step_after.saturating_sub(self.next_step);
        once as f64 / self.step.max(self.next_step) as f64
    }
}

/// Bodies of the worlds that the kilobytes are sent to.
const SIZES: [usize; 2] = [1_000, 4_000];
/// Numbers of things that the growing calls name: the largest number, and a quarter of it.
fn grown(most: usize) -> [usize; 2] {
    [most / 4, most]
}

fn check(most: usize, folder: &Path) {
    let count = COUNTS * Hostile::ALL.len() * SIZES.len();
    let all = count + Growing::ALL.len() * grown(most).len();
    let counts = counting::each_call("calls::counted", all, &["measure_all", &most.to_string()], folder);
    let (kilobytes, growing) = counts.split_at(count);
    let kilobytes = Counts::all(kilobytes);
    for (hostile, sizes) in Hostile::ALL.iter().zip(kilobytes.chunks(SIZES.len())) {
        let each = |counts: &Counts| format!("{} {:.2}", counts.calls, counts.steps());
        let sizes: Vec<String> = sizes.iter().map(each).collect();
        let commands = kilobyte((hostile.make)(SIZES[0]).1.into_iter().cycle()).len();
        println!("kilobyte {} {} {commands} {}", hostile.name, hostile.is_constant, sizes.join(" "));
    }
    for (Growing { name, .. }, counts) in Growing::ALL.iter().zip(growing.chunks(grown(most).len())) {
        println!("growing {name} {} {}", counts[0], counts[1]);
    }
}

/// Runs everything that [`check`] counts.
fn measure_all(most: usize) {
    for hostile in Hostile::ALL {
        for size in SIZES {
            let (world, commands) = (hostile.make)(size);
            measure((hostile.make)(size).0, world, &kilobyte(commands.into_iter().cycle()));
        }
    }
    for growing in Growing::ALL {
        for count in grown(most) {
            counted((growing.make)(count));
        }
    }
}

/// A world and a pattern of commands, of which the first says by its kind and seed what it is.
#[derive(Clone, PartialEq)]
struct Candidate {
    world: Genes,
    pattern: [(u8, u32); PATTERN],
}

impl Candidate {
    fn random(random: &mut Random) -> Self {
        let mut world: Genes = std::array::from_fn(|_| random.bits() as u8);
        // Few kinds at once, as one that costs much hides what another costs more.
        let lone = 2 + random.below(work::KINDS as u64 - 2) as usize;
        (2..work::KINDS).filter(|i| *i != lone && random.below(3) > 0).for_each(|i| world[i] = 0);
        Self { world, pattern: std::array::from_fn(|_| Self::gene(random)) }
    }

    fn gene(random: &mut Random) -> (u8, u32) {
        (random.below(KINDS) as u8, random.bits() as u32)
    }

    fn changed(&self, random: &mut Random) -> Self {
        let mut changed = self.clone();
        match random.below(4) {
            0 => changed.world[random.below(BYTES as u64) as usize] = random.bits() as u8,
            1 => {
                let [from, to] = [random.below(PATTERN as u64), random.below(PATTERN as u64)];
                changed.pattern[to as usize] = changed.pattern[from as usize];
            }
            _ => changed.pattern[random.below(PATTERN as u64) as usize] = Self::gene(random),
        }
        changed
    }

    fn text(&self) -> String {
        let bytes = self.pattern.iter().flat_map(|(kind, seed)| std::iter::once(*kind).chain(seed.to_le_bytes()));
        self.world.iter().copied().chain(bytes).map(|byte| format!("{byte:02x}")).collect()
    }

    fn of(text: &str) -> Option<Self> {
        let byte = |i: usize| u8::from_str_radix(text.get(2 * i..2 * i + 2)?, 16).ok();
        let bytes: Vec<u8> = (0..text.len() / 2).map(byte).collect::<Option<_>>()?;
        let (world, pattern) = bytes.split_at_checked(BYTES)?;
        let gene = |gene: &[u8]| Some((gene[0], u32::from_le_bytes(gene[1..].try_into().ok()?)));
        let pattern: Option<Vec<(u8, u32)>> = pattern.chunks_exact(5).map(gene).collect();
        Some(Self { world: world.try_into().ok()?, pattern: pattern?.try_into().ok()? })
    }

    fn measure(&self) {
        let mut world = Busy::new(&self.world).world;
        // Until those that rest are asleep, where any may be.
        for _ in 0..world.def().sleep_after.map_or(2, |ticks| ticks + 2) {
            world.step();
        }
        let mut round = 0;
        let commands = std::iter::from_fn(|| {
            let (kind, seed) = self.pattern[round % PATTERN];
            let seed = u64::from(seed) << 32 | round as u64;
            round += 1;
            Some(Author { random: SplitMix(seed), unfair: 0 }.of_kind(kind, &world))
        });
        let inputs = kilobyte(commands);
        // With as many bodies, in a world in which values have taken out none of them.
        measure(Busy::new(&work::calm(&self.world)).world, world, &inputs);
    }
}

fn search(seconds: u64, seed: u64, folder: &Path) {
    let (end, mut random) = (Instant::now() + Duration::from_secs(seconds), Random::seeded(seed));
    // The worst few of each kind of command that comes first, so that none of them takes the place of all others.
    let mut best: BTreeMap<u8, Vec<(Counts, Candidate)>> = BTreeMap::new();
    let mut tried = 0;
    while Instant::now() < end {
        let kept: Vec<Candidate> = best.values().flatten().map(|(_, candidate)| candidate.clone()).collect();
        let fresh = |random: &mut Random| {
            if kept.is_empty() || random.below(4) == 0 {
                return Candidate::random(random);
            }
            kept[random.below(kept.len() as u64) as usize].changed(random)
        };
        let candidates: Vec<Candidate> = (0..GENERATION).map(|_| fresh(&mut random)).collect();
        tried += candidates.len();
        let texts: Vec<String> = candidates.iter().map(Candidate::text).collect();
        let mut args = vec!["measure"];
        args.extend(texts.iter().map(String::as_str));
        let counts = Counts::all(&counting::each_call("calls::counted", COUNTS * candidates.len(), &args, folder));
        for (candidate, counts) in candidates.into_iter().zip(counts) {
            let list = best.entry(candidate.pattern[0].0).or_default();
            list.push((counts, candidate));
            list.sort_by(|a, b| b.0.steps().total_cmp(&a.0.steps()));
            list.truncate(2);
        }
    }
    let mut all: Vec<(Counts, Candidate)> = best.into_values().flatten().collect();
    all.sort_by(|a, b| b.0.steps().total_cmp(&a.0.steps()));
    println!("{tried} kilobytes; the worst, in steps of their world:");
    for (counts, candidate) in all.iter().take(8) {
        let integrator = Integrator::ALL[usize::from(candidate.world[0]) % Integrator::ALL.len()];
        println!("{:.2} {counts:?} {integrator:?} {}", counts.steps(), candidate.text());
    }
    let worst = all.first().map_or(0.0, |(counts, _)| counts.steps());
    assert!(worst <= MOST_STEPS as f64, "a kilobyte costs {worst:.1} steps");
}

fn main() {
    let args: Vec<String> = std::env::args().skip(1).filter(|arg| arg != "--bench").collect();
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("calls-{}", std::process::id()));
    let words: Vec<&str> = args.iter().map(String::as_str).collect();
    match words[..] {
        ["measure_all", most] => measure_all(most.parse().expect("a number of things")),
        ["measure", ref candidates @ ..] => {
            for text in candidates {
                Candidate::of(text).expect("the digits of a candidate").measure();
            }
        }
        ["check", most] => check(most.parse().expect("a number of things"), &folder),
        ["search", seconds] => search(seconds.parse().expect("a number of seconds"), 1, &folder),
        ["search", seconds, seed] => {
            search(seconds.parse().expect("a number of seconds"), seed.parse().expect("a seed"), &folder);
        }
        _ => println!("usage: check THINGS | search SECONDS [SEED]"),
    }
    _ = std::fs::remove_dir_all(&folder);
}
