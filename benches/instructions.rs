//! Instruction counts of steps under callgrind: exact, and the same however busy the machine is. `tests/costs.rs` runs
//! this and asserts that a scene does not pay for what it lacks.
//!
//! Needs valgrind and gungraun-runner, which has to be of gungraun's version:
//! `cargo bench -p umbra-physics --bench instructions`.

use std::hint::black_box;

use gungraun::{Callgrind, EntryPoint, LibraryBenchmarkConfig, library_benchmark, library_benchmark_group, main};
use umbra_physics::scalar::Angle;
use umbra_physics::scalar::internals::{Bulk as _, Decay, Motion as _, Span, Weight};
use umbra_physics::{BodyId, Fx, FxAccumulator, FxFactor, FxWide, Scalar, Turn, World, fx};

#[allow(dead_code, reason = "the benches of time have scenes of their own")]
mod scenes;

#[path = "../fuzz/src/work.rs"]
#[allow(dead_code, unreachable_pub, reason = "the fuzz target runs by itself, and `benches/worst.rs` looks at counts")]
mod work;

use scenes::Scene;
use work::Busy;

// Scenes have fewer bodies than threads share with the feature `parallel`: these are counts of one thread.

/// Number of steps that a measurement counts, and of values for the arithmetic.
const STEPS: usize = 4;
const VALUES: usize = 1_000;

const INSTRUCTIONS: [&str; 1] = ["--cache-sim=no"];
/// Indirect jumps and calls: what goes through a table of functions.
const BRANCHES: [&str; 2] = ["--cache-sim=no", "--branch-sim=yes"];
/// The caches of no machine in particular. The last one holds 2,000 bodies and not 4,000.
const CACHES: [&str; 4] = ["--cache-sim=yes", "--I1=32768,8,64", "--D1=32768,8,64", "--LL=262144,16,64"];

/// Parts of a step that are counted.
#[inline(never)]
fn one_step<S: Scalar>(world: &mut World<S>) {
    black_box(world).step();
}

/// Counts in `one_step` alone.
fn stepping(options: &[&str]) -> LibraryBenchmarkConfig {
    counting(Callgrind::with_args(options).entry_point(EntryPoint::Custom("*one_step*".into())))
}

/// Counts in the function under test.
fn whole() -> LibraryBenchmarkConfig {
    counting(&mut Callgrind::with_args(INSTRUCTIONS))
}

fn counting(callgrind: &mut Callgrind) -> LibraryBenchmarkConfig {
    let mut config = LibraryBenchmarkConfig::default();
    config.tool(callgrind.clone());
    config
}

/// After a first step, which allocates and has no forces of the fields from the step before.
fn warm<S: Scalar>(mut scene: Scene<S>) -> Scene<S> {
    scene.advance();
    scene
}

/// After a change of all bodies, which makes the next step look where they are; so do forces, once they are over.
fn touched<S: Scalar>(mut scene: Scene<S>) -> Scene<S> {
    let bodies: Vec<BodyId> = scene.world.bodies().map(|body| body.id()).collect();
    bodies.into_iter().for_each(|body| scene.world.wake(body).expect("it is there"));
    scene
}

fn steps<S: Scalar>(mut scene: Scene<S>) -> Scene<S> {
    for _ in 0..STEPS {
        scene.push();
        one_step(&mut scene.world);
    }
    scene
}

#[library_benchmark(config = stepping(&INSTRUCTIONS), setup = warm)]
#[bench::nobody(scenes::free(0))]
#[bench::free_1k(scenes::free(1_000))]
#[bench::free_2k(scenes::free(2_000))]
#[bench::free_8k(scenes::free(8_000))]
#[bench::free_8k_one_spring(scenes::one_spring(8_000))]
#[bench::free_1k_zone_on_nobody(scenes::zone(1_000, 2))]
#[bench::free_1k_zone(scenes::zone(1_000, 1))]
#[bench::free_1k_ghosts(scenes::discs(1_000, true))]
#[bench::free_1k_discs(scenes::discs(1_000, false))]
#[bench::free_1k_beside_6k_static(scenes::beside_static(1_000, 6_000))]
#[bench::tiles_1k(scenes::over_tiles(100, 1_000))]
#[bench::tiles_20k(scenes::over_tiles(100, 20_000))]
#[bench::tiles_1k_twice_as_many_balls(scenes::over_tiles(200, 1_000))]
#[bench::asleep_8k(scenes::beside_sleepers(0, 8_000))]
#[bench::towers_asleep_5k(scenes::towers_asleep(0, 5_000))]
#[bench::one_beside_towers_asleep_1k(scenes::towers_asleep(1, 1_000))]
#[bench::one_beside_towers_asleep_5k(scenes::towers_asleep(1, 5_000))]
#[bench::two_beside_towers_asleep_1k(scenes::towers_asleep(2, 1_000))]
#[bench::pyramids_18(scenes::pyramids(18))]
#[bench::pyramids_90(scenes::pyramids(90))]
#[bench::at_rest_8k(scenes::at_rest(8_000))]
#[bench::plain_1k(scenes::plain(1_000))]
#[bench::kinematic_1k(scenes::kinematic(1_000))]
#[bench::pushed_1k(scenes::pushed(1_000, 1_000))]
#[bench::spinning_1k(scenes::spinning(1_000))]
#[bench::damped_1k(scenes::damped(1_000))]
#[bench::thrusters_1k(scenes::thrusters(1_000, 1))]
#[bench::thrusters_1k_beside_platform(scenes::thrusters_beside_platform(1_000))]
#[bench::thrusters_one_on_each_of_1k(scenes::thrusters_on_some(1_000, 1_000, 1))]
#[bench::thrusters_two_on_500_of_1k(scenes::thrusters_on_some(1_000, 500, 2))]
#[bench::net_1k(scenes::net(40, 25))]
#[bench::net_1k_on_ground(scenes::net_on_ground(40, 25))]
fn fx(scene: Scene<Fx>) -> Scene<Fx> {
    steps(scene)
}

// Of a step that follows one with forces.
#[library_benchmark(config = stepping(&INSTRUCTIONS))]
#[bench::plain_1k(touched(warm(scenes::plain(1_000))))]
#[bench::pushed_before_1k(touched(scenes::pushed_before(1_000)))]
#[bench::tower_woken_1k(scenes::tower_woken(1_000))]
#[bench::tower_woken_5k(scenes::tower_woken(5_000))]
#[bench::edited_1k(scenes::edited_tiles(100, 1_000))]
#[bench::edited_50k(scenes::edited_tiles(100, 50_000))]
fn after(mut scene: Scene<Fx>) -> Scene<Fx> {
    one_step(&mut scene.world);
    scene
}

/// A scene from its digits, after a first step; or the calm one of the same kinds.
fn busy(genes: &str, calm: bool) -> Busy {
    let genes = work::genes(genes).expect("digits of a scene");
    let mut busy = Busy::new(&if calm { work::calm(&genes) } else { genes });
    busy.push();
    busy.world.step();
    busy
}

fn busy_steps(mut busy: Busy) -> Busy {
    for _ in 0..STEPS {
        busy.push();
        one_step(&mut busy.world);
    }
    busy
}

// The worst that `benches/worst.rs` came to, for the values: bodies of which each damps and falls in a way of its own, in
// steps of a second, and those near the limits of the envelope. Of fields it came to less.
const DAMPED_SYMPLECTIC_EULER: &str =
    "014c00000034000000c50000018002028080ff8080808001808080808080808080808080808080808080808080808080";
const DAMPED_VELOCITY_VERLET: &str =
    "024c00000034000000c50000018002028080ff8080808001808080808080808080808080808080808080808080808080";
const FREE_VELOCITY_VERLET: &str =
    "ed2f2d000000fc0000e4c54633a8d93b2deb24f4782f4c2c960995c0800f299eb7ff252ead7a6b1392b3017fe4f8eca5";
const FREE_EXPLICIT_EULER: &str =
    "96140000000000000000820033aad93b2deb24f478134c0096c095c0800f299eb7ff252ead7a6b1392b3017fe4f8eca5";
const FREE_SYMPLECTIC_EULER: &str =
    "92140000000000000000820033aad83b2dda01f478134c2c960995f39bed72bfbbaf21b2bc4c4b61cf03468200c04151";
const FREE_YOSHIDA4: &str =
    "909c00000000000000000051830bff970dcf7112ed134c2c96090169067e9b2daf680b568ec009ac942b2c5f7efd0201";
const DRAGS_PUBLISHED_VERLET: &str =
    "df84005400eb000000e300fc4a82092110ed8fd95dbe5ba2024088353c7879253095c17701c0f05da3406aced3095b7e";
const SPRINGS_VELOCITY_VERLET: &str =
    "20fac417f50000fb00000000a5aaed77a5d61adad37ef5424c88532a1c9e47b5ac3dda2f164cdddfc33821de3de98790";

#[library_benchmark(config = stepping(&INSTRUCTIONS))]
#[bench::damped_symplectic_euler(busy(DAMPED_SYMPLECTIC_EULER, false))]
#[bench::damped_velocity_verlet(busy(DAMPED_VELOCITY_VERLET, false))]
#[bench::free_velocity_verlet(busy(FREE_VELOCITY_VERLET, false))]
#[bench::free_explicit_euler(busy(FREE_EXPLICIT_EULER, false))]
#[bench::free_symplectic_euler(busy(FREE_SYMPLECTIC_EULER, false))]
#[bench::free_yoshida4(busy(FREE_YOSHIDA4, false))]
#[bench::drags_published_verlet(busy(DRAGS_PUBLISHED_VERLET, false))]
#[bench::springs_velocity_verlet(busy(SPRINGS_VELOCITY_VERLET, false))]
fn worst(busy: Busy) -> Busy {
    busy_steps(busy)
}

#[library_benchmark(config = stepping(&INSTRUCTIONS))]
#[bench::damped_symplectic_euler(busy(DAMPED_SYMPLECTIC_EULER, true))]
#[bench::damped_velocity_verlet(busy(DAMPED_VELOCITY_VERLET, true))]
#[bench::free_velocity_verlet(busy(FREE_VELOCITY_VERLET, true))]
#[bench::free_explicit_euler(busy(FREE_EXPLICIT_EULER, true))]
#[bench::free_symplectic_euler(busy(FREE_SYMPLECTIC_EULER, true))]
#[bench::free_yoshida4(busy(FREE_YOSHIDA4, true))]
#[bench::drags_published_verlet(busy(DRAGS_PUBLISHED_VERLET, true))]
#[bench::springs_velocity_verlet(busy(SPRINGS_VELOCITY_VERLET, true))]
fn calm(busy: Busy) -> Busy {
    busy_steps(busy)
}

#[library_benchmark(config = stepping(&BRANCHES), setup = warm)]
#[bench::free_1k(scenes::free(1_000))]
#[bench::free_2k(scenes::free(2_000))]
#[bench::custom_force_1k(scenes::custom(1_000))]
fn branches(scene: Scene<Fx>) -> Scene<Fx> {
    steps(scene)
}

// Each step begins with nothing in the caches.
#[library_benchmark(config = stepping(&CACHES), setup = warm)]
#[bench::free_1k(scenes::free(1_000))]
#[bench::free_2k(scenes::free(2_000))]
#[bench::free_4k(scenes::free(4_000))]
#[bench::free_8k(scenes::free(8_000))]
fn caches(mut scene: Scene<Fx>) -> Scene<Fx> {
    let mut others = vec![0u8; 4 << 20];
    for _ in 0..STEPS {
        others.iter_mut().step_by(64).for_each(|line| *line = line.wrapping_add(1));
        black_box(&mut others);
        one_step(&mut scene.world);
    }
    scene
}

// The arithmetic of the things that a scene may lack, by itself, on the values of a scene that has them.

const STEP: Span = Span { ratio: (1, 60), weight: Weight::Whole, half: false };
const HALF_STEP: Span = Span { half: true, ..STEP };

fn free() -> World {
    warm(scenes::free(VALUES)).world
}

fn turning() -> Vec<(Turn, Fx)> {
    free().bodies().map(|body| (body.angle_exact(), body.angular_velocity())).collect()
}

fn velocities() -> Vec<FxAccumulator> {
    free().bodies().map(|body| body.velocity_exact().x).collect()
}

fn forces() -> Vec<FxWide> {
    free().bodies().map(|body| FxWide::from_scalar(body.velocity().x)).collect()
}

fn sum(bits: impl Iterator<Item = i128>) -> i128 {
    bits.fold(0, i128::wrapping_add)
}

#[library_benchmark(config = whole())]
#[bench::values(turning())]
fn sine_and_cosine(values: Vec<(Turn, Fx)>) -> i128 {
    let bits = |(sin, cos): (Fx, Fx)| (sin.to_bits() ^ cos.to_bits()).into();
    sum(values.iter().map(|(angle, _)| bits(angle.sin_cos())))
}

#[library_benchmark(config = whole())]
#[bench::values(turning(), <Turn as Angle<Fx>>::drift_factor(STEP))]
fn angle_drift(values: Vec<(Turn, Fx)>, factor: FxFactor) -> i128 {
    sum(values.iter().map(|(angle, spin)| angle.drifted(*spin, factor, false).to_bits().into()))
}

#[library_benchmark(config = whole())]
#[bench::values(velocities(), Fx::decay_over(Fx::decay_rate(Decay::KeptPerSecond(fx!(0.9))), HALF_STEP))]
fn damping(mut values: Vec<FxAccumulator>, factor: FxFactor) -> Vec<FxAccumulator> {
    Fx::damp_all(&mut values, factor);
    values
}

#[library_benchmark(config = whole())]
#[bench::values(forces(), FxFactor::from_ratio(1, 3))]
fn inverse_mass(values: Vec<FxWide>, factor: FxFactor) -> i128 {
    sum(values.iter().map(|force| force.times(factor).map_or(0, FxWide::to_bits)))
}

library_benchmark_group!(name = step; benchmarks = fx, after, worst, calm, branches, caches);
library_benchmark_group!(name = arithmetic; benchmarks = sine_and_cosine, angle_drift, damping, inverse_mass);
main!(library_benchmark_groups = step, arithmetic);
