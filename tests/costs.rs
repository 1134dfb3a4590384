//! A scene does not pay for what it lacks: counts of instructions, each beside a control that has the thing and pays.
//!
//! `benches/instructions.rs` and `benches/calls.rs` do the counting, in the scenes of `benches/scenes`. Where valgrind or gungraun-runner
//! is missing the tests say that they are skipped, and with UMBRA_REQUIRE_COUNTS=1 they fail.

#[path = "support/seeds.rs"]
mod seeds;

use std::collections::BTreeMap;
use std::io::Write as _;
use std::process::Command;
use std::sync::LazyLock;

use seeds::is_short;
use serde_json::Value;

/// Number of steps of a measurement, and of values of a count of arithmetic alone, as in the bench.
const STEPS: i64 = 4;
const VALUES: i64 = 1_000;

/// Events by measurement, such as `fx/free_1k`, and name.
struct Counts(BTreeMap<String, BTreeMap<String, i64>>);

impl Counts {
    /// An event's count over all steps of a measurement.
    fn event(&self, name: &str, measurement: &str) -> i64 {
        let count = self.0.get(measurement).and_then(|events| events.get(name));
        *count.unwrap_or_else(|| panic!("the bench counts no {name} in {measurement}"))
    }

    fn instructions(&self, measurement: &str) -> i64 {
        self.event("Ir", measurement)
    }

    /// The instructions of a step of a scene beyond those of a world without bodies.
    fn beyond_nobody(&self, scene: &str) -> i64 {
        (self.instructions(&format!("fx/{scene}")) - self.instructions("fx/nobody")) / STEPS
    }

    /// Lower bound for arithmetic on the values in each step, from its count by itself. It is half of that count: within a loop
    /// that does more it shares loads and stores.
    fn share(&self, arithmetic: &str, values_a_step: i64) -> i64 {
        STEPS * values_a_step * self.instructions(arithmetic) / VALUES / 2
    }
}

/// The version of gungraun, which its runner has to have.
fn locked_version() -> &'static str {
    let lock = include_str!("../Cargo.lock");
    let (_, rest) = lock.split_once("name = \"gungraun\"\nversion = \"").expect("it is a dependency");
    rest.split('"').next().expect("a version")
}

fn missing_tool() -> Option<String> {
    let runner = format!("gungraun-runner {}", locked_version());
    for (tool, wanted) in [("valgrind", "valgrind-"), ("gungraun-runner", runner.as_str())] {
        let said = Command::new(tool).arg("--version").output().map(|output| output.stdout).unwrap_or_default();
        if !String::from_utf8_lossy(&said).starts_with(wanted) {
            return Some(format!("there is no {}", wanted.trim_end_matches('-')));
        }
    }
    None
}

/// The number of things that the calls whose cost may grow name at most.
fn grown() -> u16 {
    if is_short() { 4_000 } else { 16_000 }
}

/// The output of a bench. By day it is built as the tests are, for which the library is built already; by night with the default features.
fn bench(name: &str, options: &[&str]) -> String {
    let features = if is_short() { "--all-features" } else { "--package=umbra-physics" };
    let bench = ["bench", "--quiet", "--profile", "release", features, "--bench", name, "--"];
    let output = Command::new(env!("CARGO")).args(bench).args(options).current_dir(env!("CARGO_MANIFEST_DIR")).output();
    let output = output.expect("cargo starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("text")
}

fn count() -> Counts {
    Counts(bench("instructions", &["--output-format=json"]).lines().map(read).collect())
}

fn calls() -> Vec<Vec<String>> {
    bench("calls", &["check", &grown().to_string()])
        .lines()
        .map(|line| line.split(' ').map(str::to_string).collect())
        .collect()
}

/// A measurement and its events from a line of the bench.
fn read(line: &str) -> (String, BTreeMap<String, i64>) {
    let summary: Value = serde_json::from_str(line).expect("a summary a line");
    let word = |key: &str| summary[key].as_str().expect("a word");
    let events = &summary["profiles"][0]["summaries"]["total"]["summary"]["Callgrind"];
    let count = |(event, value): (&String, &Value)| {
        // Beside that of the run before, if there was one.
        let metrics = &value["metrics"];
        let new = metrics.get("Left").unwrap_or(&metrics["Both"][0]);
        Some((event.clone(), new["Int"].as_i64()?))
    };
    let events = events.as_object().expect("events by name").iter().filter_map(count).collect();
    (format!("{}/{}", word("function_name"), word("id")), events)
}

/// The counts and the lines of `benches/calls.rs`, each in words. They are made at the same time, once for all tests; `None` where they
/// cannot be made.
fn counted() -> Option<&'static (Counts, Vec<Vec<String>>)> {
    static COUNTS: LazyLock<Option<(Counts, Vec<Vec<String>>)>> = LazyLock::new(|| {
        let Some(missing) = missing_tool() else {
            return Some(std::thread::scope(|scope| {
                let calls = scope.spawn(calls);
                (count(), calls.join().expect("calls are counted"))
            }));
        };
        assert!(std::env::var_os("UMBRA_REQUIRE_COUNTS").is_none(), "{missing}");
        // Past the harness, which keeps what is printed by tests that pass.
        writeln!(std::io::stderr(), "instruction counts: SKIPPED, {missing}").expect("stderr is open");
        None
    });
    COUNTS.as_ref()
}

fn counts() -> Option<&'static Counts> {
    counted().map(|(counts, _)| counts)
}

#[test]
#[cfg_attr(debug_assertions, ignore = "counts optimised code: in release builds")]
fn static_bodies_cost_nothing() {
    let Some(counts) = counts() else { return };
    let without = counts.instructions("fx/free_1k");
    let with = counts.instructions("fx/free_1k_beside_6k_static");
    assert!((with - without).abs() * 100 <= without, "{with} beside 6,000 static bodies, {without} without");
    // As many again that move cost as much again, within what a body may cost more or less.
    let control = counts.instructions("fx/free_2k");
    assert!(control * 100 >= without * 198, "{control} for 2,000 bodies, {without} for 1,000");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "counts optimised code: in release builds")]
fn static_tiles_out_of_reach_cost_nothing() {
    let Some(counts) = counts() else { return };
    let (few, many) = (counts.instructions("fx/tiles_1k"), counts.instructions("fx/tiles_20k"));
    assert!((many - few).abs() * 100 <= few, "{many} over 20,000 tiles, {few} over 1,000");
    let control = counts.instructions("fx/tiles_1k_twice_as_many_balls");
    assert!(control * 100 >= few * 180, "{control} for 200 balls, {few} for 100");
    // After an edit: less than two instructions for each tile that is not edited.
    let (few, many) = (counts.instructions("after/edited_1k"), counts.instructions("after/edited_50k"));
    assert!(many - few < 100_000, "{many} after an edit of 50,000 tiles, {few} of 1,000");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "counts optimised code: in release builds")]
fn sleeping_bodies_cost_nothing() {
    let Some(counts) = counts() else { return };
    let asleep = counts.beyond_nobody("asleep_8k");
    assert!(asleep < 100, "{asleep} a step");
    // At rest but awake each is looked at, if with a single instruction.
    let control = counts.instructions("fx/at_rest_8k") / STEPS;
    assert!(control >= 8_000, "{control} a step awake");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "counts optimised code: in release builds")]
fn piles_that_sleep_cost_nothing() {
    let Some(counts) = counts() else { return };
    let asleep = counts.beyond_nobody("towers_asleep_5k");
    assert!(asleep < 500, "{asleep} a step");
    // Nor do they where somebody is awake.
    let cost_of = |count| counts.instructions(&format!("fx/one_beside_towers_asleep_{count}")) / STEPS;
    let (few, many) = (cost_of("1k"), cost_of("5k"));
    assert!((many - few).abs() <= 500, "{few} beside 1,000, {many} beside 5,000 a step");
    let control = counts.instructions("fx/two_beside_towers_asleep_1k") / STEPS;
    assert!(control >= few + 500, "{control} with two that fall, {few} with one");
    // A tower that wakes costs that tower. The tree keeps a list of those that left it.
    let (few, many) = (counts.instructions("after/tower_woken_1k"), counts.instructions("after/tower_woken_5k"));
    assert!(many - few <= few / 10, "{few} among 1,000, {many} among 5,000");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "counts optimised code: in release builds")]
fn forces_not_applied_cost_nothing() {
    let Some(counts) = counts() else { return };
    // No inverse mass is multiplied by where none is: kinematic bodies have no mass, and cost the same.
    let (dynamic, kinematic) = (counts.instructions("fx/plain_1k"), counts.instructions("fx/kinematic_1k"));
    assert!((dynamic - kinematic).abs() * 1_000 <= dynamic, "{dynamic} dynamic, {kinematic} kinematic");
    // Those of the tick before leave nothing to clear body by body: a list or two is emptied as a whole.
    let (never, before) = (counts.instructions("after/plain_1k"), counts.instructions("after/pushed_before_1k"));
    assert!((before - never).abs() <= 100, "{never} without forces, {before} a step later");
    let control = counts.instructions("fx/pushed_1k") - dynamic;
    let share = counts.share("inverse_mass/values", 2_000);
    assert!(control >= share, "{control} for forces on all, {share} for their products alone");
}

/// Friction is looked up once a step, and not for each body among all fields: a net of 1,000 bodies has 1,935 springs.
#[test]
#[cfg_attr(debug_assertions, ignore = "counts optimised code: in release builds")]
fn friction_costs_the_bodies_that_it_acts_on() {
    let Some(counts) = counts() else { return };
    let (without, with) = (counts.instructions("fx/net_1k"), counts.instructions("fx/net_1k_on_ground"));
    let each = (with - without) / STEPS / 1_000;
    // A root, a quotient and three products in each of two kicks.
    assert!((100..2_000).contains(&each), "{each} instructions a body and step");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "counts optimised code: in release builds")]
fn angles_of_bodies_that_do_not_turn_cost_nothing() {
    let Some(counts) = counts() else { return };
    // Were they integrated all the same, spin would cost nothing more.
    let spin = counts.instructions("fx/spinning_1k") - counts.instructions("fx/plain_1k");
    let share = counts.share("angle_drift/values", 1_000);
    assert!(spin >= share, "{spin} for spin, {share} for its products alone");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "counts optimised code: in release builds")]
fn damping_by_a_factor_of_1_costs_nothing() {
    let Some(counts) = counts() else { return };
    // Were it multiplied all the same, damping would cost nothing more: two components, in two half steps.
    let damping = counts.instructions("fx/damped_1k") - counts.instructions("fx/plain_1k");
    let share = counts.share("damping/values", 4_000);
    assert!(damping >= share, "{damping} for damping, {share} for its products alone");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "counts optimised code: in release builds")]
fn a_rotation_nobody_asks_for_costs_nothing() {
    let Some(counts) = counts() else { return };
    let plain = counts.instructions("fx/plain_1k");
    let sine = STEPS * counts.instructions("sine_and_cosine/values");
    let spin = counts.instructions("fx/spinning_1k") - plain;
    assert!(spin < sine / 2, "{spin} for spin has room for a sine and cosine: {sine}");
    let control = counts.instructions("fx/thrusters_1k") - plain;
    assert!(control >= sine / 2, "{control} for thrusters has no room for a sine and cosine: {sine}");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "counts optimised code: in release builds")]
fn a_rotation_is_computed_once_a_body_and_step() {
    let Some(counts) = counts() else { return };
    // As many thrusters on as many bodies: those on one body share its sine and cosine.
    let alone = counts.instructions("fx/thrusters_one_on_each_of_1k");
    let paired = counts.instructions("fx/thrusters_two_on_500_of_1k");
    let share = counts.share("sine_and_cosine/values", 500);
    assert!(alone - paired >= share, "{alone} alone, {paired} in pairs, {share} for 500 sines and cosines");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "counts optimised code: in release builds")]
fn without_force_fields_no_body_goes_through_a_table_of_functions() {
    let Some(counts) = counts() else { return };
    let indirect = |scene: &str| counts.event("Bi", &format!("branches/{scene}"));
    let (once, twice) = (indirect("free_1k"), indirect("free_2k"));
    // What is there once a block of bodies, such as a jump by the kind of a stage, is no table a body goes through.
    assert!((twice - once) * 10 < STEPS * 1_000, "{once} for 1,000 bodies, {twice} for twice as many");
    let control = indirect("custom_force_1k") - once;
    assert!(control >= STEPS * 1_000, "{control} for a law of the caller's own on all");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "counts optimised code: in release builds")]
fn without_force_fields_a_step_is_one_pass() {
    let Some(counts) = counts() else { return };
    let misses = |scene: &str| {
        let event = |name| counts.event(name, &format!("caches/{scene}"));
        (event("DLmr") + event("DLmw")) as f64 / STEPS as f64
    };
    // A world that fits in the cache brings each line in once; what is there in any world drops out of the difference.
    let fits = (misses("free_2k") - misses("free_1k")) / 1e3;
    // One that does not fit brings in each line once a pass. A hundredth is the ends of columns, in lines they share.
    let does_not = (misses("free_8k") - misses("free_4k")) / 4e3;
    assert!(does_not <= 1.01 * fits, "{does_not:.2} lines a body, of {fits:.2} that it is in");
    // The cache does not hold the large world: two positions and two velocities of 16 bytes each are one line.
    assert!(does_not >= 1.0, "{does_not:.2} lines a body");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "counts optimised code: in release builds")]
fn a_body_costs_the_same_in_worlds_of_all_sizes() {
    let Some(counts) = counts() else { return };
    let sizes = [("fx/free_1k", 1_000), ("fx/free_2k", 2_000), ("fx/free_8k", 8_000)];
    let each = sizes.map(|(scene, bodies)| counts.instructions(scene) as f64 / (STEPS * bodies) as f64);
    let (min, max) = (each.into_iter().fold(f64::MAX, f64::min), each.into_iter().fold(0.0, f64::max));
    assert!(max <= 1.02 * min, "a body and step: {each:.1?}");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "counts optimised code: in release builds")]
fn a_pile_costs_the_same_however_many_there_are() {
    let Some(counts) = counts() else { return };
    let each = [("fx/pyramids_18", 18), ("fx/pyramids_90", 90)];
    let [few, many] = each.map(|(scene, piles)| counts.instructions(scene) / (STEPS * piles));
    assert!((many - few).abs() * 20 <= few, "{few} a pyramid and step among 18, {many} among 90");
    // Each of its 55 boxes has contacts that are solved.
    let alone = counts.instructions("fx/free_1k_discs") / (STEPS * 1_000);
    assert!(few >= 55 * 2 * alone, "{few} a pyramid, {alone} a disc that touches nothing");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "counts optimised code: in release builds")]
fn a_spring_costs_bodies_that_it_does_not_join_nothing() {
    let Some(counts) = counts() else { return };
    let (without, with) = (counts.instructions("fx/free_8k"), counts.instructions("fx/free_8k_one_spring"));
    assert!((with - without) * 100 <= without, "{with} with a spring among 8,000 bodies, {without} without");
    // It acts: a step is more than that of the other bodies.
    let each = without / 8_000;
    assert!(with >= without + 2 * each, "{with} with a spring, {without} without");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "counts optimised code: in release builds")]
fn a_field_on_nobody_costs_nothing() {
    let Some(counts) = counts() else { return };
    let (without, with) = (counts.instructions("fx/free_1k"), counts.instructions("fx/free_1k_zone_on_nobody"));
    assert!((with - without).abs() <= 100 * STEPS, "{with} with a zone that acts on nobody, {without} without");
    let control = counts.instructions("fx/free_1k_zone");
    assert!(control >= 2 * without, "{control} with one that acts on all");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "counts optimised code: in release builds")]
fn colliders_that_touch_nothing_cost_nothing() {
    let Some(counts) = counts() else { return };
    let (without, with) = (counts.instructions("fx/free_1k"), counts.instructions("fx/free_1k_ghosts"));
    assert!((with - without).abs() * 100 <= without, "{with} with colliders that touch nothing, {without} without");
    let control = counts.instructions("fx/free_1k_discs");
    assert!(control >= 2 * without, "{control} with colliders that meet others");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "counts optimised code: in release builds")]
fn a_moving_platform_costs_bodies_that_it_does_not_touch_nothing() {
    let Some(counts) = counts() else { return };
    let without = counts.instructions("fx/thrusters_1k");
    let with = counts.instructions("fx/thrusters_1k_beside_platform");
    assert!((with - without) * 100 <= without, "{with} beside a platform on its way, {without} without");
    // Where it has the fields of all bodies evaluated twice a step, the products of the thrusts alone would show.
    let all_changed = counts.share("sine_and_cosine/values", 1_000);
    assert!(all_changed * 100 > without, "{all_changed} for the sines and cosines of all, {without} for the steps");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "counts optimised code: in release builds")]
fn no_values_make_a_step_cost_three_times_a_calm_one() {
    let Some(counts) = counts() else { return };
    let scenes: Vec<&str> = counts.0.keys().filter_map(|name| name.strip_prefix("worst/")).collect();
    assert!(scenes.len() >= 5, "{scenes:?}");
    let mut worst_ratio = 0.0;
    for scene in scenes {
        let (worst, calm) =
            (counts.instructions(&format!("worst/{scene}")), counts.instructions(&format!("calm/{scene}")));
        assert!(worst <= 3 * calm, "{scene}: {worst} at worst, {calm} with everyday values");
        worst_ratio = f64::max(worst_ratio, worst as f64 / calm as f64);
    }
    // Scenes in which values make no difference would show nothing.
    assert!(worst_ratio >= 1.5, "{worst_ratio} times at worst");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "counts optimised code: in release builds")]
fn no_kilobyte_of_commands_costs_more_than_ten_steps_and_no_call_more_than_what_it_names() {
    let Some((_, lines)) = counted() else { return };
    let number = |word: &String| word.parse::<f64>().expect("a number");
    let (mut constant, mut growing) = (0, 0);
    for line in lines {
        let line: Vec<&String> = line.iter().collect();
        match line[..] {
            [kind, name, is_constant, commands, calls, steps, calls_of_more, steps_of_more] if kind == "kilobyte" => {
                assert!(
                    number(steps) <= 10.0 && number(steps_of_more) <= 10.0,
                    "{name}: {steps}, {steps_of_more} steps"
                );
                if is_constant == "true" {
                    constant += 1;
                    let factor = number(calls_of_more) / number(calls);
                    assert!(factor <= 1.25, "{name}: {factor:.2} times as much among four times the bodies");
                    let each = number(calls) / number(commands);
                    // A collider that is defined anew costs the most: its mass and inertia leave exact sums and enter them.
                    // 12,066 in `release`, 11,568 where the library is compiled as a single unit.
                    assert!(each <= 12_500.0, "{name}: {each} instructions a command");
                }
            }
            [kind, name, few, many] if kind == "growing" => {
                growing += 1;
                let factor = number(many) / number(few);
                // A logarithm adds a fifth: that of 4,000 beside that of 1,000.
                assert!(factor <= 4.0 * 1.25, "{name}: {factor:.2} times as much for four times as many");
                // In a scene a body and an input each: 100,600 in `release`.
                let each = number(many) / f64::from(grown());
                assert!(
                    each <= if name.starts_with("a_scene") { 105_000.0 } else { 26_000.0 },
                    "{name}: {each} for one"
                );
            }
            _ => panic!("{line:?}"),
        }
    }
    assert!(constant >= 10 && growing >= 8, "{constant} constant, {growing} growing");
}
