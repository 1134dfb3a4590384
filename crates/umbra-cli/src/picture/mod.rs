//! Pictures of a run: the ways of the bodies, and their outlines at its end.

mod axis;
mod clip;
mod contacts;
mod draw;
mod layout;
mod outline;
mod simplify;
mod svg;

use std::collections::BTreeMap;

use umbra_physics::scalar::ToF64;
use umbra_physics::{BodyClass, BodyKind, Scalar, World};
use umbra_scene::{Scene, SceneRun, Trails};

pub use axis::ticks;
use contacts::Contacts;
pub(crate) use contacts::{ContactMark, ContactOptions};
use outline::{Outline, Scenery, place};

/// A point of a picture, m.
type Point = (f64, f64);

/// The length of a vector: rounded alike on every machine, which `hypot` is not.
fn length(vector: Point) -> f64 {
    (vector.0 * vector.0 + vector.1 * vector.1).sqrt()
}

/// Ways with more points than this in all are recorded each few ticks.
const POINTS: u64 = 2_000_000;
/// The largest number of trails in a picture. Of more, an even choice is drawn.
const WAYS: usize = 600;

/// The contents of a picture, gathered while the run goes on.
pub(crate) struct Recorder<'a> {
    scene: &'a Scene,
    contacts: ContactOptions,
    chosen: Vec<bool>,
    stride: u64,
    exposed_each: u64,
    ticks: u64,
    /// The trails, by the index of the body in the scene.
    ways: BTreeMap<usize, Vec<Point>>,
    exposures: Vec<Outline>,
    start: Vec<Outline>,
}

impl<'a> Recorder<'a> {
    pub(crate) fn new(scene: &'a Scene, ticks: u64, contacts: ContactOptions) -> Self {
        let count = scene.bodies.len();
        let mut chosen = vec![false; count];
        match &scene.plot.trails {
            Trails::All => {
                let step = count.div_ceil(WAYS).max(1);
                chosen.iter_mut().step_by(step).for_each(|chosen| *chosen = true);
            }
            Trails::Of(bodies) => bodies.iter().for_each(|&index| chosen[index] = true),
            Trails::None => {}
        }
        let drawn = chosen.iter().filter(|&&chosen| chosen).count() as u64;
        let exposures = u64::from(scene.plot.exposures);
        Self {
            scene,
            contacts,
            chosen,
            stride: (drawn.saturating_mul(ticks) / POINTS).max(1),
            exposed_each: if exposures == 0 { u64::MAX } else { (ticks / (exposures + 1)).max(1) },
            ticks,
            ways: BTreeMap::new(),
            exposures: Vec::new(),
            start: Vec::new(),
        }
    }

    /// Keeps where the bodies are now.
    pub(crate) fn record<S: Scalar + ToF64>(&mut self, run: &SceneRun<'_, S>) {
        let world = run.world();
        let tick = world.tick();
        let last = tick == self.ticks;
        if tick == 0 {
            self.start = Outline::all(world);
        } else if tick % self.exposed_each == 0 && !last {
            let moving = |outline: &Outline| !matches!(outline.class, BodyClass::Static | BodyClass::Disabled);
            self.exposures.extend(Outline::all(world).into_iter().filter(moving));
        }
        if tick % self.stride != 0 && !last {
            return;
        }
        for body in world.bodies().filter(|body| body.kind() != BodyKind::Static) {
            let Some(index) = run.index(body.id()) else { continue };
            if self.chosen[index] {
                let way = self.ways.entry(index).or_default();
                let point = place(body.position());
                if way.last() != Some(&point) {
                    way.push(point);
                }
            }
        }
    }

    /// The picture as SVG.
    pub(crate) fn draw<S: Scalar + ToF64>(&self, run: &SceneRun<'_, S>) -> String {
        let world = run.world();
        let bodies = world.bodies().zip(Outline::all(world)).map(|(body, outline)| {
            let way = run.index(body.id()).filter(|index| self.ways.contains_key(index));
            EndState { way, at: place(body.position()), outline }
        });
        let picture = Picture {
            title: if self.scene.title.is_empty() { "Scene" } else { &self.scene.title },
            caption: caption(world),
            view: self.scene.plot.view.map(|corners| corners.map(place)),
            ways: self
                .ways
                .iter()
                .map(|(&index, points)| Way { index, name: &self.scene.bodies[index].name, points })
                .collect(),
            bodies: bodies.collect(),
            start: &self.start,
            exposures: &self.exposures,
            scenery: Scenery::of(world),
            contacts: Contacts::of(world, &self.contacts),
        };
        draw::draw(&picture)
    }
}

/// Draws the bodies of a world as they are now, in a part of the plane or in all of it, m.
pub fn still(world: &World, title: &str, view: Option<[Point; 2]>) -> String {
    let bodies = world.bodies().zip(Outline::all(world));
    let picture = Picture {
        title,
        caption: caption(world),
        view,
        ways: Vec::new(),
        bodies: bodies.map(|(body, outline)| EndState { way: None, at: place(body.position()), outline }).collect(),
        start: &[],
        exposures: &[],
        scenery: Scenery::of(world),
        contacts: Contacts::of(world, &ContactOptions::default()),
    };
    draw::draw(&picture)
}

/// The way of a body.
struct Way<'a> {
    index: usize,
    name: &'a str,
    points: &'a [Point],
}

/// A body at the end.
struct EndState {
    /// The index of its way, if that is drawn.
    way: Option<usize>,
    at: Point,
    outline: Outline,
}

/// The points of everything that is drawn.
struct Picture<'a> {
    title: &'a str,
    caption: String,
    view: Option<[Point; 2]>,
    ways: Vec<Way<'a>>,
    bodies: Vec<EndState>,
    start: &'a [Outline],
    exposures: &'a [Outline],
    scenery: Scenery,
    contacts: Contacts,
}

fn caption<S: Scalar>(world: &World<S>) -> String {
    let (num, den) = world.def().time_step.seconds();
    let seconds = world.elapsed();
    let seconds = seconds.num as f64 / seconds.den as f64;
    let time = format!("{seconds:.3}");
    let time = time.trim_end_matches('0').trim_end_matches('.');
    let bodies = world.body_count();
    let plural = if bodies == 1 { "body" } else { "bodies" };
    format!("{bodies} {plural}, {time} s in steps of {num}/{den} s, {}, {}", world.def().integrator.name(), S::NAME)
}
