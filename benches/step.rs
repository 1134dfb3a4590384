//! Time of a step: free bodies in numbers, each thing that a scene may lack beside what it costs, and mixed scenes; in
//! fixed point and, by the same code, in floats.
//!
//! Ids are paths such as `step/free_100k/fx`. Compare within one run only.

use divan::Bencher;
use divan::counter::ItemsCount;
#[cfg(feature = "parallel")]
use umbra_physics::step_all;
use umbra_physics::{Fx, Scalar};
use umbra_scene::Scene as File;

#[allow(dead_code, reason = "some scenes are for counts of instructions")]
mod scenes;

use scenes::Scene;

fn main() {
    divan::main();
}

/// Times ticks of a scene, the forces applied in each included.
fn steps<S: Scalar>(bencher: Bencher, mut scene: Scene<S>) {
    let count = scene.world.moving_count();
    bencher.counter(ItemsCount::new(count)).bench_local(|| scene.advance());
}

/// One module a scene, with a bench a scalar.
macro_rules! scenes {
    ($($(#[$doc:meta])* $name:ident: $scene:expr;)*) => {$(
        $(#[$doc])*
        mod $name {
            use super::*;

            #[divan::bench]
            fn fx(bencher: Bencher) {
                steps::<Fx>(bencher, $scene);
            }

            #[divan::bench]
            fn f64(bencher: Bencher) {
                steps::<f64>(bencher, $scene);
            }

            #[divan::bench]
            fn f32(bencher: Bencher) {
                steps::<f32>(bencher, $scene);
            }
        }
    )*};
}

scenes! {
    free_10: scenes::free(10);
    free_100: scenes::free(100);
    free_1k: scenes::free(1_000);
    free_10k: scenes::free(10_000);
    free_100k: scenes::free(100_000);
    free_1m: scenes::free(1_000_000);
}

// What a scene may lack: `plain_1k` lacks all of it, the others have one thing each.
scenes! {
    plain_1k: scenes::plain(1_000);
    free_1k_beside_100k_static: scenes::beside_static(1_000, 100_000);
    /// The control: as many again that move.
    free_2k: scenes::free(2_000);
    asleep_10k: scenes::beside_sleepers(0, 10_000);
    at_rest_10k: scenes::at_rest(10_000);
    pushed_1k: scenes::pushed(1_000, 1_000);
    pushed_before_1k: scenes::pushed_before(1_000);
    spinning_1k: scenes::spinning(1_000);
    damped_1k: scenes::damped(1_000);
    /// Asks for one rotation a body.
    thrusters_1k: scenes::thrusters(1_000, 1);
    /// Asks for the same rotation twice.
    thrusters_1k_twice: scenes::thrusters(1_000, 2);
    custom_force_1k: scenes::custom(1_000);
}

scenes! {
    orbits_1k: scenes::orbits(1_000);
    spring_net_1k: scenes::net(40, 25);
    drag_1k: scenes::drag(1_000);
    thrusters_1k_pushed: scenes::pushed_thrusters(1_000);
    free_1k_beside_10k_asleep: scenes::beside_sleepers(1_000, 10_000);
}

/// Steps on one core and on two.
#[cfg(feature = "parallel")]
mod threads {
    use super::*;

    #[divan::bench(args = [1, 2])]
    fn free_100k_fx(bencher: Bencher, threads: usize) {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        let mut scene = scenes::free::<Fx>(100_000);
        bencher.counter(ItemsCount::new(100_000usize)).bench_local(|| pool.install(|| scene.advance()));
    }

    /// 64 pyramids of 55 boxes in a world.
    #[divan::bench(args = [1, 2])]
    fn pyramids_64_fx(bencher: Bencher, threads: usize) {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        let mut scene = scenes::pyramids(64);
        bencher.bench_local(|| pool.install(|| scene.advance()));
    }

    /// 64 worlds of 1,000 bodies each.
    #[divan::bench(args = [1, 2])]
    fn worlds_64_of_1k_fx(bencher: Bencher, threads: usize) {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        let mut worlds: Vec<_> = (0..64).map(|_| scenes::free::<Fx>(1_000).world).collect();
        bencher.counter(ItemsCount::new(64_000usize)).bench_local(|| pool.install(|| step_all(&mut worlds)));
    }
}

/// The first second of the scene files, their inputs included.
mod file {
    use super::*;

    const TICKS: usize = 60;
    const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes");

    fn names() -> Vec<String> {
        let files = std::fs::read_dir(FOLDER).expect("the folder is there");
        let path = files.map(|file| file.expect("it can be read").path());
        let scenes = path.filter(|path| path.extension().is_some_and(|extension| extension == "json"));
        let mut names: Vec<_> = scenes.filter_map(|path| Some(path.file_stem()?.to_str()?.to_owned())).collect();
        names.sort_unstable();
        names
    }

    fn run<S: Scalar>(bencher: Bencher, name: &str) {
        let text = std::fs::read_to_string(format!("{FOLDER}/{name}.json")).expect("the file is there");
        let scene = File::parse(&text).expect("the scene is fair");
        let start = || scene.start::<S>().expect("the scene is fair");
        bencher.counter(ItemsCount::new(TICKS)).with_inputs(start).bench_local_refs(|run| {
            for _ in 0..TICKS {
                run.advance().expect("the inputs are fair");
            }
        });
    }

    #[divan::bench(args = names())]
    fn fx(bencher: Bencher, name: &str) {
        run::<Fx>(bencher, name);
    }

    #[divan::bench(args = names())]
    fn f64(bencher: Bencher, name: &str) {
        run::<f64>(bencher, name);
    }
}
