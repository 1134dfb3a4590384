//! Looks for the scene of 1,000 bodies whose step costs most beside a calm one of the same kinds, by counting instructions
//! under callgrind and climbing. What it found is in `benches/scenes`, and `tests/costs.rs` holds it to a bound.
//!
//! `cargo bench --bench worst -- search 600` climbs for so many seconds and prints the worst scenes it came to, as
//! hexadecimal digits; `rank FILE...` counts the scenes in files, such as a corpus of the fuzz target `work`.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use umbra_physics::{Integrator, Random};

#[path = "../fuzz/src/work.rs"]
#[allow(dead_code, unreachable_pub, reason = "it is public in the crate of the fuzz targets, and runs by itself there")]
mod work;

#[path = "scenes/counting.rs"]
mod counting;

use work::{BYTES, Busy, Genes, KINDS};

/// Number of steps counted after a first one, as in `benches/instructions.rs`.
const STEPS: usize = 4;
/// Scenes of a generation.
const GENERATION: usize = 24;

#[inline(never)]
fn counted_step(scene: &mut Busy) {
    std::hint::black_box(&mut scene.world).step();
}

/// The part that runs under callgrind: the scenes in a file, a line each.
fn measure(path: &str) {
    for line in fs::read_to_string(path).expect("a file of scenes").lines() {
        let mut scene = Busy::new(&work::genes(line).expect("a scene in a line"));
        scene.push();
        scene.world.step();
        for _ in 0..STEPS {
            scene.push();
            counted_step(&mut scene);
        }
    }
}

fn text(genes: &Genes) -> String {
    genes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Instructions of the steps of each scene.
fn count(scenes: &[Genes], folder: &Path) -> Vec<u64> {
    let list = folder.with_extension("list");
    fs::write(&list, scenes.iter().map(|genes| text(genes) + "\n").collect::<String>()).expect("it can be written");
    let args = ["measure", list.to_str().expect("a path in UTF-8")];
    let counts = counting::each_call("worst::counted_step", scenes.len() * STEPS, &args, folder);
    _ = fs::remove_file(&list);
    counts.chunks(STEPS).map(|steps| steps.iter().sum()).collect()
}

/// A scene, what its steps cost, and those of the calm one.
#[derive(Clone, Copy)]
struct Counted {
    genes: Genes,
    cost: u64,
    calm: u64,
}

impl Counted {
    fn ratio(&self) -> f64 {
        self.cost as f64 / self.calm as f64
    }

    fn print(&self) {
        let Self { genes, cost, calm } = self;
        println!("{:.3} times {calm}: {cost}, {:?}, {}", self.ratio(), integrator(genes), text(genes));
    }
}

fn integrator(genes: &Genes) -> Integrator {
    Integrator::ALL[usize::from(genes[0]) % Integrator::ALL.len()]
}

/// Counts scenes and their calm ones; those of kinds that were counted before are known.
fn judge(scenes: &[Genes], known: &mut BTreeMap<[u8; KINDS], u64>, folder: &Path) -> Vec<Counted> {
    let kinds = |genes: &Genes| -> [u8; KINDS] { genes[..KINDS].try_into().expect("they come first") };
    let mut all = scenes.to_vec();
    for genes in scenes {
        let calm = work::calm(genes);
        if !known.contains_key(&kinds(genes)) && !all.contains(&calm) {
            all.push(calm);
        }
    }
    let counts = count(&all, folder);
    for (genes, cost) in all.iter().zip(&counts).skip(scenes.len()) {
        known.insert(kinds(genes), *cost);
    }
    let counted = |(genes, cost): (&Genes, &u64)| {
        let calm = known.get(&kinds(genes)).copied().unwrap_or(*cost);
        Counted { genes: *genes, cost: *cost, calm }
    };
    scenes.iter().zip(&counts).map(counted).collect()
}

/// Another scene near this one: some bytes changed, values rather than kinds.
fn changed(mut genes: Genes, random: &mut Random) -> Genes {
    for _ in 0..=random.below(4) {
        let first = if random.below(8) == 0 { 0 } else { KINDS as u64 };
        let at = (first + random.below(BYTES as u64 - first)) as usize;
        genes[at] = match random.below(4) {
            0 => random.bits() as u8,
            1 => [0, 1, 64, 127, 128, 192, 254, 255][random.below(8) as usize],
            _ => genes[at].wrapping_add(random.below(9) as u8).wrapping_sub(4),
        };
    }
    genes
}

fn search(seconds: u64, seed: u64, folder: &Path) {
    let (end, mut random) = (Instant::now() + Duration::from_secs(seconds), Random::seeded(seed));
    let mut known = BTreeMap::new();
    // The worst few, for each integrator.
    let mut best: BTreeMap<&str, Vec<Counted>> = BTreeMap::new();
    let mut tried = 0;
    while Instant::now() < end {
        let kept: Vec<Counted> = best.values().flatten().copied().collect();
        let scenes: Vec<Genes> = (0..GENERATION)
            .map(|_| {
                if kept.is_empty() || random.below(6) == 0 {
                    let mut genes: Genes = std::array::from_fn(|_| random.bits() as u8);
                    // Few kinds at once, as one that costs much hides what another costs more.
                    let lone = 2 + random.below(KINDS as u64 - 2) as usize;
                    (2..KINDS).filter(|i| *i != lone && random.below(3) > 0).for_each(|i| genes[i] = 0);
                    return genes;
                }
                let parent = kept[random.below(kept.len() as u64) as usize].genes;
                if random.below(4) > 0 {
                    return changed(parent, &mut random);
                }
                // The kinds of one with the values of another, or some of them.
                let second_parent = kept[random.below(kept.len() as u64) as usize].genes;
                let cut = KINDS + random.below((BYTES - KINDS) as u64) as usize;
                std::array::from_fn(|i| if i < cut { parent[i] } else { second_parent[i] })
            })
            .collect();
        tried += scenes.len();
        for counted in judge(&scenes, &mut known, folder) {
            let list = best.entry(integrator(&counted.genes).name()).or_default();
            if !list.iter().any(|listed| listed.genes == counted.genes) {
                list.push(counted);
            }
            list.sort_by(|a, b| b.ratio().total_cmp(&a.ratio()));
            list.truncate(6);
        }
    }
    println!("{tried} scenes");
    best.values().flatten().for_each(Counted::print);
}

fn rank(files: &[String], folder: &Path) {
    let mut scenes: Vec<Genes> = Vec::new();
    for file in files {
        let bytes = fs::read(file).expect("a file to read");
        scenes.push(std::array::from_fn(|i| bytes.get(i).copied().unwrap_or(0)));
    }
    let mut known = BTreeMap::new();
    let mut all: Vec<Counted> =
        scenes.chunks(GENERATION).flat_map(|scenes| judge(scenes, &mut known, folder)).collect();
    all.sort_by(|a, b| b.ratio().total_cmp(&a.ratio()));
    all.iter().take(20).for_each(Counted::print);
}

fn main() {
    let args: Vec<String> = std::env::args().skip(1).filter(|arg| arg != "--bench").collect();
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("worst-{}", std::process::id()));
    let words: Vec<&str> = args.iter().map(String::as_str).collect();
    match words[..] {
        ["measure", path] => measure(path),
        ["search", seconds] => search(seconds.parse().expect("a number of seconds"), 1, &folder),
        ["search", seconds, seed] => {
            search(seconds.parse().expect("a number of seconds"), seed.parse().expect("a seed"), &folder);
        }
        ["rank", ..] => rank(&args[1..], &folder),
        _ => println!("usage: search SECONDS [SEED] | rank FILE..."),
    }
    _ = fs::remove_dir_all(&folder);
}
