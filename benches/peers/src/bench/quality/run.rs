//! A scene run once beside its twins, and what was seen on the way.

use crate::bench::geometry::{joint_gap, kinetic, largest, largest_speed, overlap, radius};
use crate::bench::now;
use crate::engine::{Engine, State, World};
use crate::scene::{self, Mirror, Scene};
use std::f64::consts::PI;

/// Below this speed all bodies rest, m/s.
const REST_SPEED: f64 = 0.05;

/// Twins run along for this many ticks, or until they differ.
const TWIN_TICKS: usize = 3600;

/// Overlap is measured at every tick of this many, later at every tenth.
const DENSE_TICKS: usize = 3600;

/// All bodies at a tick.
pub struct Kept {
    pub tick: usize,
    pub states: Vec<State>,
    pub largest_speed: f64,
}

pub struct Run {
    pub scene: Scene,
    pub ticks: usize,
    pub start: Vec<State>,
    /// The states at the ticks asked for, and those of the end.
    pub kept: Vec<Kept>,
    /// The path of the last body, from before the first tick on.
    pub path: Vec<State>,
    /// The kinetic energy from before the first tick on.
    pub kinetic: Vec<f64>,
    /// The first tick since when all bodies rest.
    pub rest_after: Option<usize>,
    pub worst_overlap: f64,
    pub end_overlap: f64,
    /// The largest distance of a body from the mirror image of its partner.
    pub asymmetry: f64,
    pub worst_gap: f64,
    pub twins: Vec<Twin>,
    pub mean_step_us: f64,
}

/// A run whose states must be those of the first one, after a map.
pub struct Twin {
    pub name: &'static str,
    world: Box<dyn World>,
    /// The index that each of its bodies has in the scene.
    original: Vec<usize>,
    mirror: Option<Mirror>,
    /// The first tick with a difference.
    pub differs: Option<usize>,
    /// The ticks compared.
    pub ticks: usize,
}

impl Twin {
    fn all(engine: &dyn Engine, s: &Scene) -> Vec<Twin> {
        let twin = |name, world, original, mirror| Twin { name, world, original, mirror, differs: None, ticks: 0 };
        let (shuffled, original) = scene::shuffled(s, 1);
        vec![
            twin("mirrored_equal", engine.build(&scene::mirrored(s)), (0..s.bodies.len()).collect(), Some(Mirror::X)),
            twin("shuffled_equal", engine.build(&shuffled), original, None),
        ]
    }

    fn step(&mut self, tick: usize, states: &[State]) {
        if self.differs.is_some() || tick > TWIN_TICKS {
            return;
        }
        self.world.step();
        self.ticks = tick;
        let equal = self.original.iter().enumerate().all(|(k, &i)| {
            let q = self.world.state(k);
            same(self.mirror.map_or(q, |m| m.state(q)), states[i])
        });
        if !equal {
            self.differs = Some(tick);
        }
    }
}

/// True if the states are equal to the bit. The angles pi and -pi are one.
fn same(a: State, b: State) -> bool {
    let angle = a.angle == b.angle || (a.angle == -b.angle && a.angle.abs() == PI);
    angle && (a.x, a.y, a.vx, a.vy, a.w) == (b.x, b.y, b.vx, b.vy, b.w)
}

fn states(s: &Scene, w: &dyn World) -> Vec<State> {
    (0..s.bodies.len()).map(|i| w.state(i)).collect()
}

/// The largest distance between a body and the mirror image of its partner; angles count at the radius.
fn asymmetry(s: &Scene, states: &[State]) -> f64 {
    let Some(symmetry) = &s.symmetry else { return 0.0 };
    let distance = |(i, &partner): (usize, &usize)| {
        let (a, b) = (states[i], symmetry.mirror.state(states[partner]));
        let turn = a.angle - b.angle;
        let turn = turn - (turn / (2.0 * PI)).round() * 2.0 * PI;
        largest((a.x - b.x).hypot(a.y - b.y), turn.abs() * radius(&s.bodies[i]))
    };
    symmetry.partner.iter().enumerate().map(distance).fold(0.0, largest)
}

impl Run {
    /// Runs the scene for `ticks` and keeps all states at the ticks of `keep` and at the end.
    pub fn new(engine: &dyn Engine, scene: Scene, ticks: usize, keep: &[usize]) -> Run {
        let mut world = engine.build(&scene);
        let start = states(&scene, world.as_ref());
        let twins = Twin::all(engine, &scene);
        let last = scene.bodies.len() - 1;
        let mut run = Run {
            ticks,
            kept: Vec::new(),
            path: vec![start[last]],
            kinetic: vec![kinetic(&scene, &start)],
            start,
            rest_after: Some(0),
            worst_overlap: 0.0,
            end_overlap: 0.0,
            asymmetry: 0.0,
            worst_gap: 0.0,
            twins,
            mean_step_us: 0.0,
            scene,
        };
        let mut stepping = 0.0;
        for tick in 1..=ticks {
            let t = now();
            world.step();
            stepping += now() - t;
            let states = states(&run.scene, world.as_ref());
            run.twins.iter_mut().for_each(|twin| twin.step(tick, &states));
            run.see(tick, &states);
            if tick == ticks || keep.contains(&tick) {
                let largest_speed = largest_speed(&run.scene, &states);
                run.kept.push(Kept { tick, states, largest_speed });
            }
        }
        run.mean_step_us = stepping * 1e6 / ticks as f64;
        run
    }

    fn see(&mut self, tick: usize, states: &[State]) {
        self.path.push(states[states.len() - 1]);
        self.kinetic.push(kinetic(&self.scene, states));
        if !(largest_speed(&self.scene, states) < REST_SPEED) {
            self.rest_after = None;
        } else if self.rest_after.is_none() {
            self.rest_after = Some(tick);
        }
        self.asymmetry = largest(self.asymmetry, asymmetry(&self.scene, states));
        self.worst_gap = largest(self.worst_gap, joint_gap(&self.scene, states));
        if self.scene.contacts && (tick <= DENSE_TICKS || tick.is_multiple_of(10) || tick == self.ticks) {
            self.end_overlap = overlap(&self.scene, states);
            self.worst_overlap = largest(self.worst_overlap, self.end_overlap);
        }
    }

    /// The states at the end.
    pub fn end(&self) -> &Kept {
        &self.kept[self.kept.len() - 1]
    }

    /// The states after `seconds`, if they were kept.
    pub fn after(&self, seconds: f64) -> Option<&Kept> {
        let tick = ticks(&self.scene, seconds);
        self.kept.iter().find(|k| k.tick == tick)
    }

    /// The position of the last body after `seconds`, if the run was that long.
    pub fn last_body(&self, seconds: f64) -> Option<State> {
        self.path.get(ticks(&self.scene, seconds)).copied()
    }
}

pub fn ticks(s: &Scene, seconds: f64) -> usize {
    (seconds / s.dt).round() as usize
}
