//! Continuous collision: the paths of fast bodies end where they would cross something.
//!
//! Reads: bodies as impulses left them, the trees of colliders at rest, the rules of the step. Writes: a [`Stop`] for each path that ends
//! early.
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
mod movers;
mod paths;
mod regions;

use alloc::vec::Vec;
use core::slice::from_ref;

use super::Stop;
use super::flights::{FlightKind, Flights, Place};
use super::movers::MovingOutline;
use super::pairs::Pairs;
use super::resting::Resting;
use super::rules::Rules;
use crate::collide::sweep::{END, Form, Leg, Moment, Path, Second, Sweep};
use crate::collider::{BodyOutline, Collider};
use crate::fx::Fx;
use crate::slots::NONE;

pub(crate) use legs::between;
pub(super) use legs::resting;
use movers::Movers;
pub(crate) use paths::Paths;
pub(super) use paths::around;
use regions::Regions;

/// The rounds in which paths end at times of impact.
const ROUNDS: u32 = 4;
/// The rounds after these, in which paths end at the start.
const LAST_ROUNDS: u32 = 8;
/// The rounds after these, in which only bodies that do not give way count.
const WALL_ROUNDS: u32 = 8;

/// The paths of fast bodies in a step, and where they end.
#[derive(Debug, Default)]
pub(super) struct Sweeps {
    /// The flights of fast bodies, ascending.
    pub(super) fast: Vec<u32>,
    /// The flights of bodies that impulses sent elsewhere in the last look, or after all rounds, ascending.
    pub(super) deflected: Vec<u32>,
    /// By flight: the index of its course; [`NONE`] if it has none.
    course_of: Vec<u32>,
    courses: Vec<Course>,
    /// The outlines of each pair by number, the lower one first.
    pub(super) pairs: Vec<[u32; 2]>,
    /// The outlines near an outline that fly freely.
    nearby: Vec<u32>,
    hits: Vec<Hit>,
    movers: Movers,
    regions: Regions,
    moments: [Moment; 2],
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

impl Sweeps {
    /// Finds the bodies whose paths end before the end of the tick, lest they cross something, and their poses then. Bodies at fault are left
    /// out.
    pub(super) fn end_fast_paths(
        &mut self,
        paths: &Paths<'_>,
        flights: &mut Flights,
        resting: &Resting,
        rules: &Rules,
        is_faulty: &dyn Fn(usize) -> bool,
        stops: &mut Vec<Stop>,
    ) {
        stops.clear();
        self.course_of.clear();
        self.courses.clear();
        self.find_fast(paths, flights, is_faulty);
        if self.fast.is_empty() {
            return;
        }
        let takes_part =
            |flight: u32| paths.scene.starts.get(flight as usize).is_none_or(|start| !is_faulty(start.dense));
        self.find_pairs(paths, flights, resting, rules, None, &takes_part);
        self.run_rounds(paths, flights, resting);
        for course in &self.courses {
            if course.path.len() > 1 {
                stops.push(paths.stop(course));
            }
        }
        stops.sort_unstable_by_key(|stop| stop.dense);
    }

    /// Lists the bodies that moved far.
    fn find_fast(&mut self, paths: &Paths<'_>, flights: &Flights, is_faulty: &dyn Fn(usize) -> bool) {
        self.fast.clear();
        for (flight, start) in (0..).zip(paths.scene.starts) {
            let [reach, width] = [start.body.turning_radius, start.body.width].map(Fx::to_bits);
            if paths.is_fast(flights, flight, reach, width) && !is_faulty(start.dense) {
                self.fast.push(flight);
            }
        }
    }

    /// The path of a body as far as it went.
    fn ended_path(&self, paths: &Paths<'_>, flights: &Flights, flight: u32) -> Path {
        match self.course_of.get(flight as usize) {
            Some(&course) if course != NONE => self.courses[course as usize].path,
            _ => Path::new(paths.leg(flights, flight)),
        }
    }

    /// Visits the final paths of fast bodies, which may end early, with the slots of the bodies.
    pub(super) fn each_fast_path(&self, paths: &Paths<'_>, flights: &Flights, mut visit: impl FnMut(u32, Path)) {
        for &flight in &self.fast {
            visit(flights.body(flight).slot, self.ended_path(paths, flights, flight));
        }
    }

    /// The path of a collider's body, if it moved more than a quarter of the collider's least width.
    pub(super) fn path_if_fast(&self, paths: &Paths<'_>, flights: &Flights, collider: &Collider) -> Option<Path> {
        let flight = flights.at(collider.body.slot).filter(|&flight| (flight as usize) < paths.scene.starts.len())?;
        let is_fast = paths.is_fast(flights, flight, collider.radius.to_bits(), collider.width.to_bits());
        is_fast.then(|| self.ended_path(paths, flights, flight))
    }

    /// Lists the pairs that are looked at, of bodies that take part. A body at fault does not: it is back at its start, and nothing moves it.
    /// `free_pairs` are the pairs of the step where the paths of bodies without impulses are their free flights, on which they were found.
    pub(super) fn find_pairs(
        &mut self,
        paths: &Paths<'_>,
        flights: &mut Flights,
        resting: &Resting,
        rules: &Rules,
        free_pairs: Option<&Pairs>,
        takes_part: &dyn Fn(u32) -> bool,
    ) {
        let scene = paths.scene;
        let Self { fast, deflected, movers, regions, .. } = self;
        regions.list(paths, flights, resting, fast);
        let is_listed = |flight: u32| takes_part(flight) && (free_pairs.is_none() || !paths.is_free(flights, flight));
        movers.list(paths, flights, regions, fast, deflected, &is_listed);
        self.list_near(paths, flights, resting, rules, free_pairs);
        let Self { pairs, deflected, .. } = self;
        pairs.sort_unstable();
        pairs.dedup();
        pairs.retain(|&pair| {
            let sides = pair.map(|number| flights.side(scene, &resting.numbers, number));
            let [Some(first), Some(second)] = sides else { return false };
            let ends = [first.flight, second.flight];
            ends.into_iter().all(takes_part)
                && (is_swept(ends.map(|flight| flights.body(flight)), paths)
                    || ends.into_iter().any(|flight| deflected.binary_search(&flight).is_ok()))
        });
    }

    /// Lists the pairs that are near each other.
    fn list_near(
        &mut self,
        paths: &Paths<'_>,
        flights: &mut Flights,
        resting: &Resting,
        rules: &Rules,
        free_pairs: Option<&Pairs>,
    ) {
        let scene = paths.scene;
        let Self { fast, deflected, pairs, movers, regions, nearby, .. } = self;
        pairs.clear();
        for &flight in fast.iter() {
            let place = *flights.body(flight);
            let leg = paths.leg(flights, flight);
            let is_obstacle =
                place.kind == FlightKind::Kinematic || place.is_bullet || deflected.binary_search(&flight).is_ok();
            for index in 0..flights.outlines.of(flight).len() {
                let MovingOutline { number, extent: reach, filter, .. } = flights.outlines.of(flight)[index];
                let bounds = regions.bounds(number).unwrap_or_else(|| around(from_ref(&leg), reach));
                nearby.clear();
                if let Some(free_pairs) = free_pairs.filter(|_| is_obstacle) {
                    free_pairs.search_movers(bounds, filter, |candidate, slot| {
                        let is_free = flights.at(slot).is_some_and(|flight| paths.is_free(flights, flight));
                        nearby.extend(is_free.then_some(candidate));
                        true
                    });
                }
                let mut visit = |candidate: u32| {
                    let pair = [number.min(candidate), number.max(candidate)];
                    if regions.meet(paths, flights, resting, [number, candidate], &leg, reach)
                        && rules.may_touch(scene, resting, pair)
                    {
                        pairs.push(pair);
                    }
                    true
                };
                if let Some(trees) = resting.trees.as_ref().filter(|_| place.kind == FlightKind::Dynamic) {
                    trees.statics.search_box(bounds, filter, &mut visit);
                    trees.sleepers.search_box(bounds, filter, &mut visit);
                }
                movers.search(bounds, filter, is_obstacle, &mut visit);
                nearby.iter().for_each(|&candidate| _ = visit(candidate));
            }
        }
    }

    /// The course of a body, made when it is first asked for.
    fn course(&mut self, paths: &Paths<'_>, flights: &Flights, flight: u32) -> usize {
        let index = flight as usize;
        if self.course_of.len() <= index {
            self.course_of.resize(index + 1, NONE);
        }
        if self.course_of[index] == NONE {
            self.course_of[index] = self.courses.len() as u32;
            let path = Path::new(paths.leg(flights, flight));
            self.courses.push(Course { flight, path, changed: Some(0), carrier: NONE, is_stuck: false });
        }
        self.course_of[index] as usize
    }

    /// Ends paths at times of impact.
    fn run_rounds(&mut self, paths: &Paths<'_>, flights: &mut Flights, resting: &Resting) {
        let pairs = core::mem::take(&mut self.pairs);
        for round in 0.. {
            self.hits.clear();
            for &pair in &pairs {
                self.find_impact(paths, flights, resting, pair);
            }
            if round >= ROUNDS + LAST_ROUNDS {
                self.hits.retain(|hit| !hit.is_mutual);
            }
            self.courses.iter_mut().for_each(|course| course.changed = None);
            if !self.end_paths(paths, flights, round >= ROUNDS) || round >= ROUNDS + LAST_ROUNDS + WALL_ROUNDS {
                break;
            }
        }
        self.pairs = pairs;
    }

    /// Finds the time of impact of a pair, if the path of one of the two is new.
    fn find_impact(&mut self, paths: &Paths<'_>, flights: &mut Flights, resting: &Resting, pair: [u32; 2]) {
        let sides = pair.map(|number| flights.side(paths.scene, &resting.numbers, number));
        let [Some(mut first), Some(mut second)] = sides else { return };
        // The one that gives way comes first.
        if first.kind != FlightKind::Dynamic {
            core::mem::swap(&mut first, &mut second);
        }
        let indices = [self.course(paths, flights, first.flight), self.course(paths, flights, second.flight)];
        let courses = indices.map(|index| &self.courses[index]);
        let Some(from) = courses.iter().filter_map(|course| course.changed).min() else { return };
        let is_carried = courses[0].carrier == second.flight || courses[1].carrier == first.flight;
        if is_carried || !courses.iter().any(|course| course.path.moves()) {
            return;
        }
        let outlines = [first.outline(), second.outline()];
        let forms = [form(first.collider, &outlines[0]), form(second.collider, &outlines[1])];
        let places = [flights.body(first.flight), flights.body(second.flight)];
        let sweep = Sweep {
            forms: [&forms[0], &forms[1]],
            paths: courses.map(|course| course.path.legs()),
            second: if is_dynamic(places[1], paths) {
                Second::GivesWay
            } else if second.kind == FlightKind::Kinematic && courses[1].path.moves() {
                Second::Carries
            } else {
                Second::Stands
            },
        };
        let Some(at) = sweep.impact(from, &mut self.moments) else { return };
        let [first_course, second_course] = indices.map(|index| index as u32);
        let is_mutual = second.kind == FlightKind::Dynamic;
        // A dominant body that impulses deflected does not end its way at bodies that it dominates.
        let are_swept = is_swept(places, paths);
        if are_swept || places[0].dominance <= places[1].dominance {
            self.hits.push(Hit { course: first_course, at, obstacle: second_course, is_mutual });
        }
        if is_mutual && (are_swept || places[1].dominance <= places[0].dominance) {
            self.hits.push(Hit { course: second_course, at, obstacle: first_course, is_mutual });
        }
    }

    /// Ends the paths that meet something at their times of impact, or after the last round at the start. Returns true if a path changed.
    fn end_paths(&mut self, paths: &Paths<'_>, flights: &Flights, is_last: bool) -> bool {
        let mut hits = core::mem::take(&mut self.hits);
        hits.retain(|hit| !self.is_vain(flights, hit, is_last));
        hits.sort_unstable();
        let mut has_changed = false;
        for course_hits in hits.chunk_by(|a, b| a.course == b.course) {
            let mut course = self.courses[course_hits[0].course as usize];
            // A body that a kinematic one pushes goes with it, through others if there is no other way.
            if is_last && course.carrier != NONE && course_hits.iter().all(|hit| hit.is_mutual) {
                continue;
            }
            let is_pushed = course.carrier != NONE || course_hits.iter().any(|hit| self.is_kinematic(flights, hit));
            let at = if is_last && is_pushed {
                course_hits.iter().filter(|hit| !hit.is_mutual).map(|hit| hit.at).min().unwrap_or(course_hits[0].at)
            } else if is_last && course_hits.iter().any(|hit| hit.is_mutual) {
                0
            } else {
                course_hits[0].at
            };
            let meets = course_hits.iter().filter(|hit| hit.at == at && !(is_last && hit.is_mutual));
            let leg = self.carried(paths, flights, &course, meets);
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
                self.courses[course_hits[0].course as usize] = course;
            }
        }
        self.hits = hits;
        has_changed
    }

    /// Returns true if a body that stands already meets another one, which stops by itself. Such a hit would hide a later one by a body that
    /// carries this one along.
    fn is_vain(&self, flights: &Flights, hit: &Hit, is_last: bool) -> bool {
        let path = &self.courses[hit.course as usize].path;
        path.stands_from(hit.at) && !self.is_kinematic(flights, hit) && !(is_last && hit.is_mutual)
    }

    /// Returns true if a body meets a kinematic one.
    fn is_kinematic(&self, flights: &Flights, hit: &Hit) -> bool {
        let course = &self.courses[hit.obstacle as usize];
        !hit.is_mutual && flights.body(course.flight).kind == FlightKind::Kinematic
    }

    /// How kinematic bodies carry a body along that they meet, and one of them; `None` if none does, or if they disagree.
    fn carried<'a>(
        &self,
        paths: &Paths<'_>,
        flights: &Flights,
        course: &Course,
        hits: impl Iterator<Item = &'a Hit>,
    ) -> Option<(u32, Leg)> {
        let place = flights.body(course.flight);
        if course.carrier != NONE || paths.is_locked(place.slot) {
            return None;
        }
        let mut result: Option<(u32, Leg)> = None;
        for hit in hits {
            let carrier = &self.courses[hit.obstacle as usize];
            if flights.body(carrier.flight).kind != FlightKind::Kinematic || !carrier.path.moves() {
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
    place.kind == FlightKind::Dynamic || place.kind == FlightKind::Asleep && !paths.is_kinematic(place.slot)
}

/// Returns true if the paths of two bodies are tested where one of them is fast.
fn is_swept([a, b]: [&Place; 2], paths: &Paths<'_>) -> bool {
    let is_awake = a.kind == FlightKind::Dynamic || b.kind == FlightKind::Dynamic;
    let are_dynamic = is_dynamic(a, paths) && is_dynamic(b, paths);
    is_awake && (!are_dynamic || a.is_bullet || b.is_bullet)
}

/// An outline for the time of impact.
pub(super) fn form<'a>(collider: &Collider, outline: &'a BodyOutline<Fx>) -> Form<'a> {
    Form::new(&outline.outline, outline.width, collider.def.shape.is_chain())
}
