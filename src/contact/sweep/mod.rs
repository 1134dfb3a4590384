//! Continuous collision: the paths of fast bodies end where they would cross something.
//!
//! The *path* of a body over a tick is the straight way of its centre of mass from where it was to where impulses left it, and a constant
//! rotation, whole turns included. A body is *fast* if it moved more than a quarter of its least width in the tick, after impulses; other
//! bodies are not swept. Fast bodies are swept against static and kinematic ones, fast kinematic bodies against all, and bullets against
//! all. In the first round each pair is looked at on the paths that impulses left. A body of which a pair finds a time of impact stops at
//! the least of its times: so does each of two dynamic bodies that meet. A kinematic body does not give way: it carries a body along that
//! it meets. Pairs of bodies whose paths changed are looked at again, in up to [`ROUNDS`] rounds; dynamic bodies that still meet others
//! then stay where they were at the start, in up to [`LAST_ROUNDS`] more. In [`WALL_ROUNDS`] after these only bodies that do not give way
//! count: each path is then looked at by itself, so that no wall is crossed for want of rounds. A body that stands does not change
//! when another one meets it; the body that carries it does.
//!
//! The least of times depends on no order. Where two kinematic bodies meet a body at the same moment and would carry it
//! to two places, it stops: it is squeezed, as is one that is carried into something.

mod legs;
mod paths;

use alloc::vec::Vec;
use core::slice::from_ref;

use super::engine::Engine;
use super::flights::{FlightOf, Place};
use super::{Correction, Scene, Stop};
use crate::collide::broad::{Proxy, Statics};
use crate::collide::sweep::{END, Form, Leg, Moment, Path, Second, Sweep};
use crate::collider::{BodyOutline, Collider, OutlineId};
use crate::fx::Fx;
use crate::shape::Aabb;
use crate::slots::NONE;

pub(crate) use legs::between;
use legs::moved;
pub(super) use legs::resting;
pub(crate) use paths::Paths;
pub(super) use paths::around;

/// The rounds in which paths end at times of impact.
const ROUNDS: u32 = 4;
/// The rounds after these, in which paths end at the start.
const LAST_ROUNDS: u32 = 8;
/// The rounds after these, in which only bodies that do not give way count.
const WALL_ROUNDS: u32 = 8;

/// The least motion that counts, ulps: 2^-12 m.
const MIN_MOTION: i64 = 1 << 20;

/// Memory of continuous collision. None of it lasts beyond a step.
#[derive(Debug, Default)]
pub(super) struct Workspace {
    /// The flights of fast bodies, ascending.
    pub(super) fast: Vec<u32>,
    /// By flight: true for a body that impulses sent elsewhere in the last look, or after all rounds; empty if there are none.
    pub(super) deflected: Vec<bool>,
    /// By flight: the index of its course; [`NONE`] if it has none.
    course_of: Vec<u32>,
    courses: Vec<Course>,
    /// The outlines of each pair by number, the lower one first.
    pub(super) pairs: Vec<[u32; 2]>,
    hits: Vec<Hit>,
    /// The boxes of moving outlines, and a tree of them where they are many.
    movers: Vec<Proxy>,
    tree: Option<Statics>,
    pub(super) moments: [Moment; 2],
}

/// A body and its path.
#[derive(Clone, Copy, Debug)]
struct Course {
    flight: u32,
    path: Path,
    /// The moment from which on the last round changed the path; `None` if it did not.
    changed: Option<u64>,
    /// The flight that carries it, or [`NONE`].
    carrier: u32,
    /// True if a body that does not give way keeps it at its start.
    is_stuck: bool,
}

/// The number of moving boxes up to which each is looked at, without a tree.
const FEW: usize = 64;

/// Returns true if two boxes have a point in common.
fn overlap(a: &Aabb<Fx>, b: &Aabb<Fx>) -> bool {
    a.min.x <= b.max.x && b.min.x <= a.max.x && a.min.y <= b.max.y && b.min.y <= a.max.y
}

/// The outlines of a pair, and the flights and the bodies that they belong to.
type Ends = ([OutlineId; 2], [(u32, Place); 2]);

/// A body that meets something.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Hit {
    course: u32,
    at: u64,
    /// The course of the body that it meets.
    obstacle: u32,
    /// Both give way.
    is_mutual: bool,
}

impl Engine {
    /// Finds the bodies whose paths end before the end of the tick, lest they cross something, and their poses then. `scene` holds the bodies
    /// as impulses left them, by these corrections. Bodies at fault are left out.
    pub(crate) fn sweep_paths(
        &mut self,
        scene: &Scene<'_>,
        corrections: &[Correction],
        is_faulty: &dyn Fn(usize) -> bool,
        stops: &mut Vec<Stop>,
    ) {
        stops.clear();
        self.sweep.course_of.clear();
        self.sweep.courses.clear();
        self.find_fast(scene, corrections, is_faulty);
        if self.sweep.fast.is_empty() {
            return;
        }
        let paths = Paths { scene, corrections, is_corrected: true };
        self.find_pairs(&paths, is_faulty);
        self.run_rounds(&paths);
        for course in &self.sweep.courses {
            if course.path.len() > 1 {
                stops.push(paths.stop(course));
            }
        }
        stops.sort_unstable_by_key(|stop| stop.dense);
    }

    /// Lists the bodies that moved far.
    fn find_fast(&mut self, scene: &Scene<'_>, corrections: &[Correction], is_faulty: &dyn Fn(usize) -> bool) {
        self.sweep.fast.clear();
        for (i, start) in scene.starts.iter().enumerate() {
            let place = self.flights.body(i as u32);
            let rotation = corrections.get(i).map(|correction| correction.rotation);
            let ends = [start.position, scene.bodies.position(start.dense)];
            let moved = moved(ends, self.flights.flight(i as u32), rotation, place.reach);
            if moved > (place.width >> 2).max(MIN_MOTION) && !is_faulty(start.dense) {
                self.sweep.fast.push(i as u32);
            }
        }
    }

    /// The path of a body as far as it went.
    fn ended_path(&self, paths: &Paths<'_>, flight: u32) -> Path {
        match self.sweep.course_of.get(flight as usize) {
            Some(&course) if course != NONE => self.sweep.courses[course as usize].path,
            _ => Path::new(self.leg(paths, flight)),
        }
    }

    /// The path of a body that does not end early.
    pub(super) fn leg(&self, paths: &Paths<'_>, flight: u32) -> Leg {
        paths.leg(self.flights.body(flight), self.flights.flight(flight), flight)
    }

    /// Visits the final paths of fast bodies, which may end early, with the slots of the bodies.
    pub(super) fn each_fast_path(&self, paths: &Paths<'_>, mut visit: impl FnMut(u32, Path)) {
        for &flight in &self.sweep.fast {
            visit(self.flights.body(flight).slot, self.ended_path(paths, flight));
        }
    }

    /// The path of a collider's body, if it moved more than a quarter of the collider's least width.
    pub(super) fn path_if_fast(&self, paths: &Paths<'_>, collider: &Collider) -> Option<Path> {
        let flight = self.flights.at(collider.body.slot)?;
        let start = paths.scene.starts.get(flight as usize)?;
        let rotation = paths.corrections.get(flight as usize).map(|correction| correction.rotation);
        let ends = [start.position, paths.scene.bodies.position(start.dense)];
        let moved = moved(ends, self.flights.flight(flight), rotation, collider.radius.to_bits());
        let is_fast = moved > (collider.width.to_bits() >> 2).max(MIN_MOTION);
        is_fast.then(|| self.ended_path(paths, flight))
    }

    /// Lists the pairs that are looked at. A body at fault is back at its start, and nothing moves it.
    pub(super) fn find_pairs(&mut self, paths: &Paths<'_>, is_faulty: &dyn Fn(usize) -> bool) {
        let scene = paths.scene;
        self.sweep.pairs.clear();
        let trees = self.resting.trees.take().unwrap_or_default();
        self.list_movers(paths);
        let movers = core::mem::take(&mut self.sweep.movers);
        let mut memory = self.sweep.tree.take();
        let tree = (movers.len() > FEW).then(|| {
            let tree = memory.get_or_insert_default();
            tree.refill(&movers);
            &*tree
        });
        for i in 0..self.sweep.fast.len() {
            let flight = self.sweep.fast[i];
            let place = *self.flights.body(flight);
            let leg = self.leg(paths, flight);
            for collider in scene.colliders.solid_of_slot(place.slot) {
                let first = self.resting.numbers.first(collider.slot);
                for part in 0..collider.outline_count() {
                    let bounds = around(from_ref(&leg), collider.outline(part).radius.to_bits());
                    let number = first + part;
                    let filter = collider.def.filter;
                    let mut pairs = core::mem::take(&mut self.sweep.pairs);
                    let mut visit = |candidate: u32| {
                        let pair = [number.min(candidate), number.max(candidate)];
                        if self.may_meet(scene, pair) {
                            pairs.push(pair);
                        }
                        true
                    };
                    if place.kind == FlightOf::Dynamic {
                        trees.statics.search_box(bounds, filter, &mut visit);
                        trees.sleepers.search_box(bounds, filter, &mut visit);
                    }
                    match tree {
                        Some(tree) => tree.search_box(bounds, filter, &mut visit),
                        None => {
                            let nearby_movers = movers.iter().filter(|proxy| overlap(&proxy.bounds, &bounds));
                            nearby_movers.for_each(|proxy| _ = visit(proxy.collider));
                        }
                    }
                    self.sweep.pairs = pairs;
                }
            }
        }
        self.sweep.movers = movers;
        self.sweep.tree = memory;
        self.resting.trees = Some(trees);
        let mut pairs = core::mem::take(&mut self.sweep.pairs);
        pairs.sort_unstable();
        pairs.dedup();
        let takes_part = |flight: u32| scene.starts.get(flight as usize).is_none_or(|start| !is_faulty(start.dense));
        pairs.retain(|&pair| {
            let ends = self.ends(paths, pair).map(|(_, ends)| ends);
            ends.is_some_and(|[a, b]| {
                takes_part(a.0)
                    && takes_part(b.0)
                    && (is_swept([&a.1, &b.1], paths) || self.is_deflected(a.0) || self.is_deflected(b.0))
            })
        });
        self.sweep.pairs = pairs;
    }

    /// Returns true for a body that impulses sent elsewhere in the last look.
    pub(super) fn is_deflected(&self, flight: u32) -> bool {
        self.sweep.deflected.get(flight as usize).is_some_and(|&is_deflected| is_deflected)
    }

    /// Returns true if two outlines may touch: neither their filters, nor an excluded pair, nor a one-way collider lets them pass each
    /// other. A one-way collider without an answer in this step had no manifold with the body, and lets it pass.
    fn may_meet(&self, scene: &Scene<'_>, pair: [u32; 2]) -> bool {
        let outlines = pair.map(|number| self.resting.numbers.outline(number));
        let [Some(a), Some(b)] = outlines.map(|outline| scene.colliders.at(outline.slot)) else { return false };
        a.body != b.body
            && a.def.filter.agrees(b.def.filter)
            && !self.are_excluded([a.body, b.body])
            && (a.side.is_none() || self.is_held(outlines[0], b.body.slot))
            && (b.side.is_none() || self.is_held(outlines[1], a.body.slot))
    }

    /// Lists the boxes of the moving outlines that may be in the way of fast bodies.
    fn list_movers(&mut self, paths: &Paths<'_>) {
        let place = |flight: u32| self.flights.body(flight);
        let is_bullet = |flight: u32| paths.is_bullet(place(flight).slot);
        let kind = |flight: u32| place(flight).kind;
        let wants_all = self
            .sweep
            .fast
            .iter()
            .any(|&flight| kind(flight) == FlightOf::Kinematic || is_bullet(flight) || self.is_deflected(flight));
        let has_dynamic = self.sweep.fast.iter().any(|&flight| kind(flight) == FlightOf::Dynamic);
        let mut proxies = core::mem::take(&mut self.sweep.movers);
        proxies.clear();
        for flight in 0..self.flights.len() as u32 {
            let is_wanted = match kind(flight) {
                // These stand in trees.
                FlightOf::Static | FlightOf::Asleep => false,
                FlightOf::Kinematic => has_dynamic,
                FlightOf::Dynamic => wants_all || is_bullet(flight),
            };
            if !is_wanted {
                continue;
            }
            let leg = self.leg(paths, flight);
            for collider in paths.scene.colliders.solid_of_slot(place(flight).slot) {
                let first = self.resting.numbers.first(collider.slot);
                proxies.extend((0..collider.outline_count()).map(|part| Proxy {
                    collider: first + part,
                    body: collider.body.slot,
                    bounds: around(from_ref(&leg), collider.outline(part).radius.to_bits()),
                    filter: collider.def.filter,
                    digest: 0,
                }));
            }
        }
        self.sweep.movers = proxies;
    }

    /// The outlines and the bodies of a pair.
    pub(super) fn ends(&mut self, paths: &Paths<'_>, pair: [u32; 2]) -> Option<Ends> {
        let outlines = pair.map(|number| self.resting.numbers.outline(number));
        let [a, b] = outlines.map(|outline| paths.scene.colliders.at(outline.slot));
        let flights = [a?, b?].map(|collider| self.flights.of(paths.scene, collider.body.slot));
        Some((outlines, flights.map(|flight| (flight, *self.flights.body(flight)))))
    }

    /// The course of a body, made when it is first asked for.
    fn course(&mut self, paths: &Paths<'_>, flight: u32) -> usize {
        let index = flight as usize;
        if self.sweep.course_of.len() <= index {
            self.sweep.course_of.resize(index + 1, NONE);
        }
        if self.sweep.course_of[index] == NONE {
            self.sweep.course_of[index] = self.sweep.courses.len() as u32;
            let path = Path::new(self.leg(paths, flight));
            self.sweep.courses.push(Course { flight, path, changed: Some(0), carrier: NONE, is_stuck: false });
        }
        self.sweep.course_of[index] as usize
    }

    /// Ends paths at times of impact.
    fn run_rounds(&mut self, paths: &Paths<'_>) {
        let pairs = core::mem::take(&mut self.sweep.pairs);
        for round in 0.. {
            self.sweep.hits.clear();
            for &pair in &pairs {
                self.find_impact(paths, pair);
            }
            if round >= ROUNDS + LAST_ROUNDS {
                self.sweep.hits.retain(|hit| !hit.is_mutual);
            }
            self.sweep.courses.iter_mut().for_each(|course| course.changed = None);
            if !self.end_paths(paths, round >= ROUNDS) || round >= ROUNDS + LAST_ROUNDS + WALL_ROUNDS {
                break;
            }
        }
        self.sweep.pairs = pairs;
    }

    /// Finds the time of impact of a pair, if the path of one of the two is new.
    fn find_impact(&mut self, paths: &Paths<'_>, pair: [u32; 2]) {
        let Some((mut outlines, [mut a, mut b])) = self.ends(paths, pair) else { return };
        // The one that gives way comes first.
        if a.1.kind != FlightOf::Dynamic {
            (outlines, a, b) = ([outlines[1], outlines[0]], b, a);
        }
        let indices = [self.course(paths, a.0), self.course(paths, b.0)];
        let courses = indices.map(|index| &self.sweep.courses[index]);
        let Some(from) = courses.iter().filter_map(|course| course.changed).min() else { return };
        let is_carried = courses[0].carrier == b.0 || courses[1].carrier == a.0;
        if is_carried || !courses.iter().any(|course| course.path.moves()) {
            return;
        }
        let colliders = outlines.map(|outline| paths.scene.colliders.at(outline.slot));
        let [Some(first), Some(second)] = colliders else { return };
        let shapes = [first.outline(outlines[0].part), second.outline(outlines[1].part)];
        let forms = [form(first, &shapes[0]), form(second, &shapes[1])];
        let sweep = Sweep {
            forms: [&forms[0], &forms[1]],
            paths: courses.map(|course| course.path.legs()),
            second: if is_dynamic(&b.1, paths) {
                Second::GivesWay
            } else if b.1.kind == FlightOf::Kinematic && courses[1].path.moves() {
                Second::Carries
            } else {
                Second::Stands
            },
        };
        let Some(at) = sweep.impact(from, &mut self.sweep.moments) else { return };
        let [first_course, second_course] = indices.map(|index| index as u32);
        let is_mutual = b.1.kind == FlightOf::Dynamic;
        // A dominant body that impulses deflected does not end its way at bodies that it dominates.
        let are_swept = is_swept([&a.1, &b.1], paths);
        if are_swept || a.1.dominance <= b.1.dominance {
            self.sweep.hits.push(Hit { course: first_course, at, obstacle: second_course, is_mutual });
        }
        if is_mutual && (are_swept || b.1.dominance <= a.1.dominance) {
            self.sweep.hits.push(Hit { course: second_course, at, obstacle: first_course, is_mutual });
        }
    }

    /// Ends the paths that meet something at their times of impact, or after the last round at the start. Returns true if a path changed.
    fn end_paths(&mut self, paths: &Paths<'_>, is_last: bool) -> bool {
        let mut hits = core::mem::take(&mut self.sweep.hits);
        hits.retain(|hit| !self.is_vain(hit, is_last));
        hits.sort_unstable();
        let mut has_changed = false;
        for course_hits in hits.chunk_by(|a, b| a.course == b.course) {
            let mut course = self.sweep.courses[course_hits[0].course as usize];
            // A body that a kinematic one pushes goes with it, through others if there is no other way.
            if is_last && course.carrier != NONE && course_hits.iter().all(|hit| hit.is_mutual) {
                continue;
            }
            let is_pushed = course.carrier != NONE || course_hits.iter().any(|hit| self.is_kinematic(hit));
            let at = if is_last && is_pushed {
                course_hits.iter().filter(|hit| !hit.is_mutual).map(|hit| hit.at).min().unwrap_or(course_hits[0].at)
            } else if is_last && course_hits.iter().any(|hit| hit.is_mutual) {
                0
            } else {
                course_hits[0].at
            };
            let meets = course_hits.iter().filter(|hit| hit.at == at && !(is_last && hit.is_mutual));
            let leg = self.carried(paths, &course, meets);
            let before = course.path;
            match leg {
                Some((carrier, leg)) => {
                    course.path.carry(at, leg);
                    course.carrier = carrier;
                }
                None => {
                    course.path.stop(at);
                    course.is_stuck = at == 0 && course_hits.iter().any(|hit| hit.at == 0 && !hit.is_mutual);
                    course.carrier = NONE;
                }
            }
            if course.path.differs(&before) {
                course.changed = Some(at);
                has_changed = true;
                self.sweep.courses[course_hits[0].course as usize] = course;
            }
        }
        self.sweep.hits = hits;
        has_changed
    }

    /// Returns true if a body that stands already meets another one, which stops by itself. Such a hit would hide a later one by a body that
    /// carries this one along.
    fn is_vain(&self, hit: &Hit, is_last: bool) -> bool {
        let path = &self.sweep.courses[hit.course as usize].path;
        path.stands_from(hit.at) && !self.is_kinematic(hit) && !(is_last && hit.is_mutual)
    }

    /// Returns true if a body meets a kinematic one.
    fn is_kinematic(&self, hit: &Hit) -> bool {
        let course = &self.sweep.courses[hit.obstacle as usize];
        !hit.is_mutual && self.flights.body(course.flight).kind == FlightOf::Kinematic
    }

    /// How kinematic bodies carry a body along that they meet, and one of them; `None` if none does, or if they disagree.
    fn carried<'a>(
        &self,
        paths: &Paths<'_>,
        course: &Course,
        hits: impl Iterator<Item = &'a Hit>,
    ) -> Option<(u32, Leg)> {
        let place = self.flights.body(course.flight);
        if course.carrier != NONE || paths.is_locked(place.slot) {
            return None;
        }
        let mut result: Option<(u32, Leg)> = None;
        for hit in hits {
            let carrier = &self.sweep.courses[hit.obstacle as usize];
            if self.flights.body(carrier.flight).kind != FlightOf::Kinematic || !carrier.path.moves() {
                continue;
            }
            let leg = course.path.carried(&carrier.path, hit.at);
            match result {
                Some((_, result_leg)) if result_leg.pose(END) != leg.pose(END) => return None,
                Some(_) => {}
                None => result = Some((carrier.flight, leg)),
            }
        }
        result
    }
}

/// Returns true if a body is dynamic, awake or asleep. A sleeping kinematic body is an obstacle like a static one.
fn is_dynamic(place: &Place, paths: &Paths<'_>) -> bool {
    place.kind == FlightOf::Dynamic || place.kind == FlightOf::Asleep && !paths.is_kinematic(place.slot)
}

/// Returns true if the paths of two bodies are tested where one of them is fast.
fn is_swept([a, b]: [&Place; 2], paths: &Paths<'_>) -> bool {
    let is_awake = a.kind == FlightOf::Dynamic || b.kind == FlightOf::Dynamic;
    let are_dynamic = is_dynamic(a, paths) && is_dynamic(b, paths);
    is_awake && (!are_dynamic || paths.is_bullet(a.slot) || paths.is_bullet(b.slot))
}

/// An outline for the time of impact.
pub(super) fn form<'a>(collider: &Collider, outline: &'a BodyOutline<Fx>) -> Form<'a> {
    Form::new(&outline.outline, outline.width, collider.def.shape.is_chain())
}
