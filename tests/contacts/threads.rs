//! Islands shared out between threads: the same bits on any number of them.

use std::fs;

use umbra_physics::{Command, Created, Error, Fx, Stepper, World};
use umbra_scene::Scene;

/// Ticks of each scene.
const TICKS: u32 = 100;

/// Steps a world on threads that take islands with so many contacts at least, and keeps the state and the report of each step.
struct Shared {
    least: usize,
    steps: Vec<(u64, String)>,
}

impl Stepper for Shared {
    fn execute(&mut self, world: &mut World, command: &Command) -> Result<Created, Error> {
        world.execute(command)
    }

    fn step(&mut self, world: &mut World) {
        world.share_work(self.least);
        let report = format!("{:?}", world.step());
        self.steps.push((world.state_hash(), report));
    }
}

/// The steps of a scene on so many threads.
fn steps(scene: &Scene, threads: usize, least: usize) -> Vec<(u64, String)> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
    let mut shared = Shared { least, steps: Vec::new() };
    pool.install(|| {
        let mut run = scene.start::<Fx>().expect("a fair scene");
        for _ in 0..TICKS {
            run.advance_by(&mut shared).expect("fair inputs");
        }
    });
    shared.steps
}

/// Each shipped scene, with its stacks, crowds, joints and sensors, on one thread and with each island on a thread of its own.
#[test]
fn scenes_are_the_same_on_any_number_of_threads() {
    let mut scenes = 0;
    for entry in fs::read_dir("scenes").expect("the shipped scenes") {
        let path = entry.expect("an entry").path();
        if path.extension().is_none_or(|extension| extension != "json") {
            continue;
        }
        let scene = Scene::parse(&fs::read_to_string(&path).expect("a text")).expect("a scene");
        let single = steps(&scene, 1, usize::MAX);
        for threads in [2, 8] {
            assert!(steps(&scene, threads, 1) == single, "{} on {threads} threads", path.display());
        }
        scenes += 1;
    }
    assert!(scenes > 30, "{scenes} scenes");
}
