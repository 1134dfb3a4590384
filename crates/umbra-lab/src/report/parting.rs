//! The time at which fx, f64 and f32 part in a chaotic scene, in which the smallest difference grows until nothing agrees.

use serde::Serialize;
use umbra_physics::scalar::ToF64;
use umbra_physics::{Integrator, Scalar, TimeStep, World, WorldDef};
use umbra_scene::{Scene, SceneError, SceneErrors};

use super::problem::{positions, state};
use crate::truth::{Equations, real, solve, to_f64};

/// Three unequal masses with room to pass through each other: their centres come close time and again, and nothing faults.
const SCENE: &str = r#"{"sleep_after": null, "bodies": [
        {"name": "a", "position": [8, 24], "velocity": [10, 0]}, {"name": "b", "position": [-16, -8], "velocity": [0, 10]},
        {"name": "c", "position": [8, -8], "velocity": [-6, -8]}],
    "fields": [{"attractor": {"at": "a", "mu": 24000, "softening": 6}},
        {"attractor": {"at": "b", "mu": 32000, "softening": 6}}, {"attractor": {"at": "c", "mu": 40000, "softening": 6}}]}"#;
/// Steps a second of all runs.
const RATE: u32 = 1000;
/// Moments a second at which distances are taken.
const SAMPLES: u32 = 4;
/// Steps of the coarser of the two solutions from moment to moment.
const STEPS: u32 = 32;

/// The scene, and how far its runs are from each other as time goes on.
#[derive(Serialize)]
pub(crate) struct Parting {
    /// The scene, as `umbra run` takes it.
    pub(crate) scene: serde_json::Value,
    /// Steps a second of all runs.
    pub(crate) rate: u32,
    /// The moments, s.
    pub(crate) times: Vec<f64>,
    pub(crate) pairs: Vec<Pair>,
    /// The largest distance of the reference from a solution with half as many steps, m.
    pub(crate) reference_error: f64,
}

/// Two runs.
#[derive(Serialize)]
pub(crate) struct Pair {
    pub(crate) a: &'static str,
    pub(crate) b: &'static str,
    /// The largest distance between a body in the one and in the other at each moment, m.
    pub(crate) distance: Vec<f64>,
    /// The first of the moments at which it is above 1 mm, and above 1 m, s.
    pub(crate) beyond_millimetre: Option<f64>,
    pub(crate) beyond_metre: Option<f64>,
}

/// (x, y) of each body at each moment.
type Way = Vec<Vec<f64>>;

impl Parting {
    pub(crate) fn measure(seconds: u32) -> Result<Option<Self>, SceneErrors> {
        let scene = Scene::parse(SCENE)?;
        let start = scene.build()?;
        let Some(equations) = Equations::of(&start) else { return Ok(None) };
        let phases = seconds * SAMPLES;
        let truth = |steps| solution(&equations, &start, steps, phases);
        let (rough, truth) = (truth(STEPS), truth(2 * STEPS));
        let run = |integrator| WorldDef { integrator, time_step: TimeStep::hz(RATE), ..scene.world };
        let (verlet, yoshida) = (run(Integrator::VelocityVerlet), run(Integrator::Yoshida4));
        let ways = [
            ("fx", way::<umbra_physics::Fx>(&scene, verlet, phases)?),
            ("f64", way::<f64>(&scene, verlet, phases)?),
            ("f32", way::<f32>(&scene, verlet, phases)?),
            ("truth", truth),
            ("fx, yoshida4", way::<umbra_physics::Fx>(&scene, yoshida, phases)?),
        ];
        let times: Vec<f64> = (0..=phases).map(|phase| f64::from(phase) / f64::from(SAMPLES)).collect();
        let pair = |[a, b]: [usize; 2]| Pair::new([&ways[a], &ways[b]], &times);
        let pairs = [[0, 1], [0, 2], [1, 2], [0, 3], [1, 3], [2, 3], [4, 3]].map(pair).into();
        let reference_error = distances(&rough, &ways[3].1).into_iter().fold(0.0, f64::max);
        let scene = serde_json::from_str(SCENE).unwrap_or_default();
        Ok(Some(Self { scene, rate: RATE, times, pairs, reference_error }))
    }
}

impl Pair {
    fn new([a, b]: [&(&'static str, Way); 2], times: &[f64]) -> Self {
        let distance = distances(&a.1, &b.1);
        let beyond = |limit: f64| times.iter().zip(&distance).find(|(_, d)| **d > limit).map(|(time, _)| *time);
        let (beyond_millimetre, beyond_metre) = (beyond(1e-3), beyond(1.0));
        Self { a: a.0, b: b.0, distance, beyond_millimetre, beyond_metre }
    }
}

fn distances(a: &Way, b: &Way) -> Vec<f64> {
    let apart = |(a, b): (&[f64], &[f64])| (a[0] - b[0]).hypot(a[1] - b[1]);
    let largest = |(a, b): (&Vec<f64>, &Vec<f64>)| a.chunks(2).zip(b.chunks(2)).map(apart).fold(0.0, f64::max);
    a.iter().zip(b).map(largest).collect()
}

fn way<S: Scalar<Accumulator: ToF64>>(scene: &Scene, world: WorldDef, phases: u32) -> Result<Way, SceneError> {
    let mut world: World<S> = Scene { world, ..scene.clone() }.build()?;
    let now = |world: &World<S>| {
        let at = world.bodies().map(|body| body.position_exact().map(ToF64::to_f64));
        at.flat_map(|at| [at.x, at.y]).collect()
    };
    let mut way = vec![now(&world)];
    for _ in 0..phases {
        for _ in 0..RATE / SAMPLES {
            world.step();
        }
        way.push(now(&world));
    }
    Ok(way)
}

fn solution(equations: &Equations, start: &World, steps: u32, phases: u32) -> Way {
    let step = real(1) / real((SAMPLES * steps).into());
    let mut state = state(start);
    let now = |state: &[_]| positions(state).iter().map(to_f64).collect();
    let mut way = vec![now(&state)];
    for _ in 0..phases {
        solve(equations, &mut state, &step, steps);
        way.push(now(&state));
    }
    way
}
