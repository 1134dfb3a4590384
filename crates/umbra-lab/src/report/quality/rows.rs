//! The scenes of the quality page with what is measured of each, and what is promised.

use umbra_physics::{Error, World, fx};

use super::impacts;
use super::run::{Run, State};
use super::scenes::{self, SLOPES, Scene};
use super::shots;

/// A promise about a measure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Promise {
    AtMost(f64),
    AtLeast(f64),
    /// A value, and how far from it.
    Within(f64, f64),
    /// Zero, to the bit.
    Zero,
    /// No more than Box2D, in the figures that are committed.
    NoMoreThanBox2d,
}

/// A measure of a scene.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measure {
    /// The name in the figures of other engines.
    pub(super) name: &'static str,
    pub(super) about: &'static str,
    pub(super) unit: &'static str,
    /// Infinite if the event whose time is measured never happened.
    pub(super) value: f64,
    pub(super) promise: Option<Promise>,
    /// True if the promise is a goal that is not reached yet.
    pub(super) open: bool,
}

/// A measure without a promise.
pub(super) fn measure(name: &'static str, about: &'static str, unit: &'static str, value: f64) -> Measure {
    Measure { name, about, unit, value, promise: None, open: false }
}

impl Measure {
    pub(super) fn promised(self, promise: Promise) -> Self {
        Self { promise: Some(promise), ..self }
    }

    fn open(self, goal: Promise) -> Self {
        Self { promise: Some(goal), open: true, ..self }
    }
}

/// The settings of a run.
#[derive(Clone, Copy)]
pub(super) struct Length {
    pub(super) substeps: u32,
    pub(super) quick: bool,
}

/// The end of a scene: its world, to be drawn, and the measures.
pub(super) struct Played {
    pub(super) world: World,
    pub(super) measures: Vec<Measure>,
    /// The duration of the run, or the number of shots.
    pub(super) length: String,
    /// The part of the plane that is drawn, where that depends on the run.
    pub(super) view: Option<View>,
    /// Charts below the picture, as HTML.
    pub(super) charts: String,
}

/// A part of the plane, m: its lower left and its upper right corner.
pub(super) type View = [(f64, f64); 2];

/// A scene of the page.
pub(crate) struct Row {
    /// The name of the scene in the figures of other engines.
    pub(crate) name: &'static str,
    pub(super) title: &'static str,
    pub(super) about: &'static str,
    /// The part of the plane that is drawn, where that is not all.
    pub(super) view: Option<View>,
    pub(super) play: fn(Length) -> Result<Played, Error>,
}

/// A part of the page.
pub(super) struct Part {
    /// The name of its section.
    pub(super) name: &'static str,
    pub(super) title: &'static str,
    pub(super) rows: &'static [Row],
}

pub(super) static PARTS: [Part; 2] = [
    Part { name: "rest-and-motion", title: "Stacks, slopes, bounces and shots", rows: &ROWS },
    Part { name: "impacts", title: "Impacts", rows: &impacts::ROWS },
];

/// The scenes of all parts.
pub(super) fn rows() -> impl Iterator<Item = &'static Row> {
    PARTS.iter().flat_map(|part| part.rows)
}

static ROWS: [Row; 17] = [
    Row {
        name: "flat_drop",
        title: "Flat drop",
        about: "A box falls 2 m flat onto a floor, restitution 0.5. It should go up again to 0.5 m, and neither aside nor turn.",
        view: Some([(-3.0, -0.5), (3.0, 3.0)]),
        play: |length| {
            let mut run = Run::new(&scenes::flat_drop()?, length.substeps)?;
            run.step(600);
            let largest = |value: fn(&State) -> f64| run.path.iter().map(value).fold(0.0, f64::max);
            let rises = run.path.iter().position(|state| state.velocity[1] > 0.0).unwrap_or(run.path.len());
            let top = run.path[rises..].iter().map(|state| state.at[1] - 0.5).fold(0.0, f64::max);
            let measures = vec![
                measure("bounce_height", "height of the bounce", "m", top).promised(Promise::Within(0.5, 1e-3)),
                measure("sideways", "farthest aside", "m", largest(|state| state.at[0].abs())).promised(Promise::Zero),
                measure("tilt", "largest tilt", "rad", largest(|state| state.angle.abs())).promised(Promise::Zero),
            ];
            Ok(played(run, measures))
        },
    },
    Row {
        name: "pyramid40",
        title: "Pyramid of 40",
        about: "820 boxes, 40 in the lowest row, 5 cm apart. It stands, and sinks as far as its contacts are soft.",
        view: Some([(-26.0, -0.5), (26.0, 41.0)]),
        play: |length| {
            let mut run = Run::new(&scenes::pyramid(40)?, length.substeps)?;
            run.step(300);
            let speed = run.largest_speed();
            run.step(300);
            let measures = vec![
                sink(&run).promised(Promise::AtMost(0.135)),
                shift(&run).promised(Promise::AtMost(0.05)),
                measure("max_speed@300", "largest speed after 5 s", "m/s", speed).promised(Promise::AtMost(2e-3)),
                rest(&run),
                asymmetry(&run),
            ];
            Ok(played(run, measures))
        },
    },
    Row {
        name: "tower20",
        title: "Tower of 20",
        about: "20 boxes on top of each other, which stand for an hour without moving aside by one bit.",
        view: Some([(-8.0, -0.5), (8.0, 21.0)]),
        play: |length| {
            let mut run = Run::new(&scenes::tower(20, fx!(1))?, length.substeps)?;
            run.step(if length.quick { 3_600 } else { 216_000 });
            let measures = vec![shift(&run).promised(Promise::Zero), sink(&run), asymmetry(&run)];
            Ok(played(run, measures))
        },
    },
    Row {
        name: "tower_100x",
        title: "Ten boxes, the top one 100 times as heavy",
        about: "A load that soft contacts hardly carry: boxes sink into each other, and the tower leans where it is solved unevenly. Here its island takes 16 sub-steps.",
        view: Some([(-4.0, -0.5), (4.0, 11.0)]),
        play: |length| {
            let mut run = Run::new(&scenes::tower(10, fx!(100))?, length.substeps)?;
            run.step(600);
            let measures = vec![
                shift(&run).promised(Promise::Zero),
                tilt(&run).promised(Promise::Zero),
                sink(&run).promised(Promise::AtMost(0.05)),
                asymmetry(&run),
            ];
            Ok(played(run, measures))
        },
    },
    Row {
        name: "tower_1000x",
        title: "Five boxes, the top one 1,000 times as heavy",
        about: "In other engines the top box sinks through the others. Here its island takes 16 sub-steps, in which soft contacts give way less.",
        view: Some([(-4.0, -0.5), (4.0, 6.0)]),
        play: |length| {
            let mut run = Run::new(&scenes::tower(5, fx!(1000))?, length.substeps)?;
            run.overlap = Some(0.0);
            run.step(600);
            let overlap = run.overlap.unwrap_or(f64::INFINITY);
            let measures = vec![
                measure("overlap_worst", "deepest overlap", "m", overlap).promised(Promise::AtMost(0.05)),
                sink(&run).promised(Promise::AtMost(0.15)),
                shift(&run).promised(Promise::Zero),
                tilt(&run).promised(Promise::Zero),
                asymmetry(&run),
            ];
            Ok(played(run, measures))
        },
    },
    Row {
        name: "cards",
        title: "House of cards, eight storeys",
        about: "Cards that lean on each other and stand by friction. Creep is how far they still move after a tenth of the time.",
        view: Some([(-7.0, -0.5), (7.0, 8.5)]),
        play: |length| stones(&scenes::cards(8)?, length),
    },
    Row {
        name: "arch",
        title: "Arch of 15 stones",
        about: "A half circle of wedges without mortar, 1 m thick and 5 m wide inside.",
        view: Some([(-8.0, -0.5), (8.0, 7.0)]),
        play: |length| stones(&scenes::arch(15, [fx!(5), fx!(6)])?, length),
    },
    Row {
        name: "thin_arch",
        title: "Thin arch of 25 stones",
        about: "The same with stones that are 0.75 m thick.",
        view: Some([(-8.0, -0.5), (8.0, 7.0)]),
        play: |length| stones(&scenes::arch(25, [fx!(5), fx!(5.75)])?, length),
    },
    Row {
        name: "belt",
        title: "Sixty boxes on a belt",
        about: "The floor carries three layers of boxes against a stop at 2 m/s, and slides on below them.",
        view: Some([(-42.0, -1.0), (3.0, 8.0)]),
        play: |length| {
            let mut run = Run::new(&scenes::belt()?, length.substeps)?;
            run.step(if length.quick { 900 } else { 2_400 });
            let measures = vec![rest(&run).promised(Promise::AtMost(600.0))];
            Ok(played(run, measures))
        },
    },
    Row {
        name: "mixed",
        title: "500 discs and boxes",
        about: "They fall into a container. When the last one rests is a matter of chance, within a factor of two.",
        view: Some([(-13.0, -0.5), (13.0, 12.0)]),
        play: |length| {
            let mut run = Run::new(&scenes::mixed(500)?, length.substeps)?;
            run.step(if length.quick { 600 } else { 1_500 });
            let measures = vec![rest(&run).promised(Promise::AtMost(400.0))];
            Ok(played(run, measures))
        },
    },
    Row {
        name: "break",
        title: "Billiard break",
        about: "A disc at 20 m/s into 15 that touch, restitution 0.95, no friction. The lower half mirrors the upper half.",
        view: None,
        play: |length| {
            let mut run = Run::new(&scenes::billiards()?, length.substeps)?;
            run.overlap = Some(0.0);
            let start = run.kinetic();
            run.step(180);
            let overlap = run.overlap.unwrap_or(f64::INFINITY);
            let measures = vec![
                asymmetry(&run),
                measure("overlap_worst", "deepest overlap", "m", overlap).promised(Promise::AtMost(5e-3)),
                measure("energy_left", "share of the energy that is left", "", run.kinetic() / start)
                    .promised(Promise::AtLeast(0.54)),
            ];
            Ok(played(run, measures))
        },
    },
    Row {
        name: "slope_below",
        title: "Slope just below the angle of friction",
        about: "A box on a slope of atan(0.6) less 1e-3 rad, with μ = 0.6. It holds.",
        view: Some([(-5.0, -4.0), (5.0, 4.0)]),
        play: |length| Ok(slope(SLOPES[0], length)?.0),
    },
    Row {
        name: "slope_above",
        title: "Slope just above the angle of friction",
        about: "The same with 1e-3 rad more. It slides with the acceleration that the law of friction gives, 0.0117 m/s².",
        view: Some([(-5.0, -4.0), (5.0, 4.0)]),
        play: |length| {
            let (mut played, acceleration) = slope(SLOPES[1], length)?;
            let error = measure(
                "acceleration_err",
                "relative error of the acceleration",
                "",
                acceleration / ACCELERATION - 1.0,
            );
            played.measures = vec![error.promised(Promise::Within(0.0, 1e-4))];
            Ok(played)
        },
    },
    Row {
        name: "bounce",
        title: "Bouncing disc",
        about: "A disc falls 10 m, restitution 0.9: after n bounces it should go up to 0.81ⁿ of that.",
        view: Some([(-6.0, -0.5), (6.0, 11.0)]),
        play: |length| {
            let mut run = Run::new(&scenes::bounce()?, length.substeps)?;
            run.step(1_800);
            let tops = tops(&run.path);
            let error = |name, about, bounces: usize| {
                let law = (0..bounces).fold(10.0, |height, _| height * 0.81);
                let top = tops.get(bounces - 1).copied().unwrap_or(0.0);
                measure(name, about, "", top / law - 1.0).promised(Promise::Within(0.0, 1e-3))
            };
            let measures = vec![
                error("height_err_1", "relative error of the height after 1 bounce", 1),
                error("height_err_5", "after 5 bounces", 5),
                error("height_err_10", "after 10 bounces", 10),
            ];
            Ok(played(run, measures))
        },
    },
    Row {
        name: "cradle",
        title: "Newton's cradle",
        about: "Five discs on springs with gaps, 480 steps a second. The outer two are let go at once, and stay mirror images.",
        view: Some([(-7.0, -1.2), (7.0, 4.5)]),
        play: |length| {
            let mut run = Run::new(&scenes::cradle()?, length.substeps)?;
            run.step(if length.quick { 4_800 } else { 28_800 });
            let measures = vec![asymmetry(&run)];
            Ok(played(run, measures))
        },
    },
    Row {
        name: "shots",
        title: "1 cm at 1 km/s",
        about: "Boxes of 1 cm and discs of 1.6 cm, bullets, in a room whose walls are 1 cm thick: fixed, or a heavy body that moves freely.",
        view: Some([(-6.0, -6.0), (6.0, 6.0)]),
        play: shots::walls,
    },
    Row {
        name: "seams",
        title: "Ball over 10,000 seams",
        about: "A ball rolls at 30 m/s over a chain of 12,000 flat segments, beside a twin on one segment.",
        view: None,
        play: shots::seams,
    },
];

pub(super) fn played(run: Run, mut measures: Vec<Measure>) -> Played {
    let quarantined = run.quarantined() as f64;
    if quarantined > 0.0 {
        // None of the other measures means anything then.
        measures.push(
            measure("quarantined", "bodies that the world took out", "bodies", quarantined).promised(Promise::Zero),
        );
    }
    let elapsed = run.world.elapsed();
    let length = format!("{} s", elapsed.num as f64 / elapsed.den as f64);
    Played { world: run.world, measures, length, view: None, charts: String::new() }
}

fn sink(run: &Run) -> Measure {
    let [from, to] = [&run.start, &run.now].map(|states| states.last().map_or(0.0, |top| top.at[1]));
    measure("top_sink", "sink of the top", "m", from - to)
}

fn shift(run: &Run) -> Measure {
    let shift = run.most(&run.start, |from, to| (to.at[0] - from.at[0]).abs());
    measure("largest_shift", "largest shift aside", "m", shift)
}

fn tilt(run: &Run) -> Measure {
    measure("largest_tilt", "largest tilt", "rad", run.most(&run.start, |from, to| (to.angle - from.angle).abs()))
}

fn rest(run: &Run) -> Measure {
    let ticks = run.rest_after.map_or(f64::INFINITY, |tick| tick as f64);
    measure("rest_after", "all below 0.05 m/s after", "steps", ticks)
}

fn asymmetry(run: &Run) -> Measure {
    measure("asymmetry", "largest difference from the mirror image", "m", run.asymmetry).promised(Promise::Zero)
}

/// Structures that stand for ten minutes, or a minute.
fn stones(scene: &Scene, length: Length) -> Result<Played, Error> {
    let ticks = if length.quick { 3_600 } else { 36_000 };
    let creep = |run: &mut Run| {
        run.step(ticks / 10);
        let settled = run.now.clone();
        run.step(ticks - ticks / 10);
        run.most(&settled, State::distance)
    };
    let mut run = Run::new(scene, length.substeps)?;
    let awake = creep(&mut run);
    let sleeping = creep(&mut Run::new(&scene.sleeping(), length.substeps)?);
    let measures = vec![
        measure("largest_shift", "largest shift", "m", run.most(&run.start, State::distance))
            .promised(Promise::NoMoreThanBox2d),
        measure("creep_after_60s", "creep after a tenth of the time, if nothing may sleep", "m", awake)
            .open(Promise::Zero),
        measure("creep_sleeping", "the same in a world with the default settings of sleep", "m", sleeping)
            .promised(Promise::Zero),
        asymmetry(&run),
    ];
    Ok(played(run, measures))
}

/// The acceleration on the steeper slope by the law of friction: 10·(sin α − 0.6·cos α) with α = 567,719/2^20 rad, m/s².
const ACCELERATION: f64 = 0.01165640868691642;

/// A slope, and the mean acceleration between 5 s and 10 s, m/s².
fn slope(angle: i64, length: Length) -> Result<(Played, f64), Error> {
    let mut run = Run::new(&scenes::slope(angle)?, length.substeps)?;
    run.step(600);
    let (from, to) = (run.path[300], run.path[600]);
    // In 5 s a body at the least velocity that the solver knows, 2^-22 m/s, goes farther.
    let moved = measure("moved", "way between 5 s and 10 s", "m", to.distance(&from)).promised(Promise::AtMost(1e-6));
    Ok((played(run, vec![moved]), (to.speed() - from.speed()) / 5.0))
}

/// The heights that the flights between bounces reach, by the energy at the tick before each comes down.
fn tops(path: &[State]) -> Vec<f64> {
    let mut tops = Vec::new();
    let mut rising = false;
    for state in path {
        let [_, velocity] = state.velocity;
        if velocity > 0.0 {
            let height = state.at[1] - 0.5 + velocity * velocity / 20.0;
            if rising {
                tops.pop();
            }
            tops.push(height);
        }
        rising = velocity > 0.0;
    }
    tops
}
