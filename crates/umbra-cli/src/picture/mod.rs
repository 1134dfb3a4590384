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
use umbra_physics::{BodyClass, BodyKind, Scalar, Vec2, World};
use umbra_scene::{Scene, Trails};

use crate::cast::Cast;
use crate::jumps::Jumps;
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

/// The subject of a picture.
pub(crate) struct Subject {
    pub(crate) title: String,
    /// The part of the plane, m; `None` for all of what happens.
    pub(crate) view: Option<[Vec2; 2]>,
    /// The number of moments on the way at which outlines are drawn.
    pub(crate) exposures: u32,
    pub(crate) trails: Trails,
    /// The number of bodies, as far as it is known.
    pub(crate) bodies: usize,
}

impl Subject {
    pub(crate) fn of(scene: &Scene) -> Self {
        let plot = &scene.plot;
        Self {
            title: if scene.title.is_empty() { "Scene".to_owned() } else { scene.title.clone() },
            view: plot.view,
            exposures: plot.exposures,
            trails: plot.trails.clone(),
            bodies: scene.bodies.len(),
        }
    }
}

/// The contents of a picture, gathered while the run goes on.
pub(crate) struct Recorder {
    subject: Subject,
    contacts: ContactOptions,
    /// The step from one body with a trail to the next.
    each: usize,
    stride: u64,
    exposed_each: u64,
    ticks: u64,
    /// The number of ticks seen.
    seen: u64,
    /// The trails, by the number of the body.
    ways: BTreeMap<usize, NamedWay>,
    jumps: Jumps,
    exposures: Vec<Outline>,
    start: Vec<Outline>,
}

struct NamedWay {
    name: String,
    /// The pieces between which the body jumped, none without points but the last.
    pieces: Vec<Vec<Point>>,
}

impl NamedWay {
    fn new(name: &str) -> Self {
        Self { name: name.to_owned(), pieces: vec![Vec::new()] }
    }

    /// Adds a point, unless it is the last one again.
    fn reach(&mut self, point: Point) {
        if let Some(piece) = self.pieces.last_mut().filter(|piece| piece.last() != Some(&point)) {
            piece.push(point);
        }
    }

    /// Begins a piece.
    fn part(&mut self) {
        if self.pieces.last().is_some_and(|piece| !piece.is_empty()) {
            self.pieces.push(Vec::new());
        }
    }
}

impl Recorder {
    pub(crate) fn new(subject: Subject, ticks: u64, contacts: ContactOptions) -> Self {
        let each = subject.bodies.div_ceil(WAYS).max(1);
        let drawn = match &subject.trails {
            Trails::All => subject.bodies.div_ceil(each),
            Trails::Of(bodies) => bodies.len(),
            Trails::None => 0,
        };
        let exposures = u64::from(subject.exposures);
        Self {
            subject,
            contacts,
            each,
            stride: ((drawn as u64).saturating_mul(ticks) / POINTS).max(1),
            exposed_each: if exposures == 0 { u64::MAX } else { (ticks / (exposures + 1)).max(1) },
            ticks,
            seen: 0,
            ways: BTreeMap::new(),
            jumps: Jumps::default(),
            exposures: Vec::new(),
            start: Vec::new(),
        }
    }

    /// Says whether a body has a trail.
    fn is_chosen(&self, index: usize) -> bool {
        match &self.subject.trails {
            // Bodies that come later may be more than can be drawn.
            Trails::All => index % self.each == 0 && (self.ways.len() < WAYS || self.ways.contains_key(&index)),
            Trails::Of(bodies) => bodies.contains(&index),
            Trails::None => false,
        }
    }

    /// Takes in the world at a tick.
    pub(crate) fn record<S: Scalar + ToF64>(&mut self, world: &World<S>, cast: &impl Cast) {
        let tick = self.seen;
        self.seen += 1;
        let last = tick == self.ticks;
        if tick == 0 {
            self.start = Outline::all(world);
        } else if tick % self.exposed_each == 0 && !last {
            let moving = |outline: &Outline| !matches!(outline.class, BodyClass::Static | BodyClass::Disabled);
            self.exposures.extend(Outline::all(world).into_iter().filter(moving));
        }
        for body in self.jumps.see(world) {
            if let Some(way) = cast.index(body).and_then(|index| self.ways.get_mut(&index)) {
                way.part();
            }
        }
        if tick % self.stride != 0 && !last {
            return;
        }
        for body in world.bodies().filter(|body| body.kind() != BodyKind::Static) {
            let Some(index) = cast.index(body.id()).filter(|&index| self.is_chosen(index)) else { continue };
            let way = self.ways.entry(index).or_insert_with(|| NamedWay::new(cast.name(body.id())));
            way.reach(place(body.position()));
        }
    }

    /// The picture as SVG.
    pub(crate) fn draw<S: Scalar + ToF64>(&self, world: &World<S>, cast: &impl Cast) -> String {
        let bodies = world.bodies().zip(Outline::all(world)).map(|(body, outline)| {
            let way = cast.index(body.id()).filter(|index| self.ways.contains_key(index));
            EndState { way, at: place(body.position()), outline }
        });
        let ways = self.ways.iter().map(|(&index, way)| Way { index, name: &way.name, pieces: &way.pieces });
        let picture = Picture {
            title: &self.subject.title,
            caption: caption(world),
            view: self.subject.view.map(|corners| corners.map(place)),
            ways: ways.collect(),
            bodies: bodies.collect(),
            start: &self.start,
            exposures: &self.exposures,
            scenery: Scenery::of(world),
            contacts: Contacts::of(world, &self.contacts),
        };
        draw::draw(&picture)
    }
}

/// A picture of a world as it is now, as SVG: bodies, force fields and joints, all that there are of them.
///
/// ```
/// use umbra_physics::{BodyDef, Shape, World, WorldDef};
///
/// let mut world = World::new(WorldDef::default())?;
/// world.add_body(BodyDef::dynamic().with_collider(Shape::rectangle(2, 1)?))?;
/// std::fs::write("world.svg", umbra_cli::picture::svg(&world))?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn svg<S: Scalar + ToF64>(world: &World<S>) -> String {
    still(world, &format!("Tick {}", world.tick()), None)
}

/// Draws the bodies of a world as they are now, in a part of the plane or in all of it, m.
pub fn still<S: Scalar + ToF64>(world: &World<S>, title: &str, view: Option<[Point; 2]>) -> String {
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
    /// The pieces between which the body jumped.
    pieces: &'a [Vec<Point>],
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

#[cfg(test)]
mod tests {
    use umbra_physics::{BodyDef, Shape, WorldDef};

    use super::*;

    #[test]
    fn a_world_is_a_picture_in_one_call() {
        let mut world = World::new(WorldDef::default()).expect("a world");
        let empty = svg(&world);
        assert!(
            empty.starts_with("<svg ") && empty.ends_with("</svg>\n") && empty.contains(">Tick 0</text>"),
            "{empty}"
        );
        assert!(!empty.contains("<polygon"), "{empty}");
        world.add_body(BodyDef::dynamic().with_collider(Shape::rectangle(2, 1).expect("a plank"))).expect("room");
        world.step();
        let plank = svg(&world);
        assert!(plank.contains(">Tick 1</text>") && plank.matches("<polygon").count() == 1, "{plank}");
    }
}
