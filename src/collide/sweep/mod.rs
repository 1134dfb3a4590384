//! Time of impact: the moment of a tick at which two outlines on given paths meet.
//!
//! *Conservative advancement.* At a moment, any direction n along which the outlines are apart (or overlap by less than is allowed) bounds
//! from below the time for which they stay so: along n, the distance shrinks by the displacement, by the way that corners come closer at
//! their present speeds, and by at most φ²·r/2 more for a rotation by φ of corners within r of the centre; nor does a corner ever
//! reach farther than r. The longest of the times over several directions is passed in one step, and so on until the end of the tick or
//! until no direction says more. So the outlines do not meet before the moment that is found, whatever the directions: a direction that
//! is not the best one costs steps, and a path that takes more than [`STEPS`] of them ends early.
//!
//! The directions tried are the directions of largest separation, and the directions across the way, which show in one step that a body
//! flies past. The bound by r is for a bar that spins a thousand turns in a tick: beyond its reach no step is spent on turns.
//!
//! *Tolerance.* A resting or sliding body overlaps the ground a little, and must not stop for it. So a path ends at an overlap of 5 mm or of an
//! eighth of the body's width, whichever is less: the body without a rim of that width never touches the wall. If the body still overlaps at
//! the end of the tick, on the same side, by less than an eighth of the width, the path does not end: a contact takes over, and a box that
//! tumbles along the ground loses no time. A body that overlaps so deep already may go a little deeper: a body narrower than 4 cm by a
//! sixteenth of the rest up to a quarter of its width, so that it is never kept at its start for ever and never crosses. A body without
//! width has no such rim, and keeps its distance: at least half of its distance at the start.
//!
//! All directions that tie are tried and the longest time is taken, so that neither the order of corners nor a mirror image changes the
//! moment.

mod form;
mod hull;
mod moment;
mod path;

pub(crate) use form::Form;
use form::height;
pub(crate) use hull::Hull;
pub(crate) use moment::Moment;
use moment::{ROUNDING, SHORTEST, along};
pub(crate) use path::{END, Leg, Path, ends, passes_beyond};

/// The most steps along a path.
pub(crate) const STEPS: u32 = 96;

/// The most steps to a time of impact that is asked for.
pub(crate) const FINE_STEPS: u32 = 1 << 14;

/// Outlines that overlap by this touch, ulps: a micrometre.
const TOUCH: i64 = 1 << 12;

/// Two outlines on their paths.
pub(crate) struct Sweep<'a> {
    pub(crate) forms: [&'a Form<'a>; 2],
    /// The pieces of their paths.
    pub(crate) paths: [&'a [Leg]; 2],
    /// The first one gives way.
    pub(crate) second: Second,
}

/// The response of the body of the second outline where the two meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Second {
    /// It gives way as well.
    GivesWay,
    /// It stands still.
    Stands,
    /// It goes on, and carries the first one along.
    Carries,
}

/// The depths that a path may reach, ulps.
#[derive(Clone, Copy, Debug)]
struct Depths {
    /// The overlap in which a path ends.
    small: i64,
    /// The overlap in which a tick may end.
    deep: i64,
    /// The deepest overlap at the start of a path that counts as a touch.
    touch: i64,
}

/// The largest overlap in which a path ends: 5 mm.
const SMALL: i64 = (5 << 32) / 1000;

impl Depths {
    /// The depths for outlines of this width: an eighth of it, so that most of an outline never crosses.
    fn new(width: i64, second: Second) -> Self {
        let eighth = width >> 3;
        let small = eighth.min(SMALL);
        if small == 0 {
            // A line may overlap another one at its ends alone.
            return Self { small, deep: 1 << 22, touch: -APART };
        }
        // A body that others press into its carrier would be left behind for good.
        let touch = if second == Second::Carries { width >> 1 } else { width >> 2 };
        Self { small, deep: eighth, touch }
    }
}

/// Lines nearer than this touch, ulps: 6e-8 m.
const APART: i64 = 1 << 8;

/// The distance that a path leaves between lines: 15 µm, or half of the distance at its start.
const CLEARANCE: i64 = 1 << 16;

/// Width of a segment where it meets something on one side alone, or something thick: 4 cm.
const LINE_WIDTH: i64 = (4 << 32) / 100;

impl Sweep<'_> {
    /// Brings both outlines to a moment.
    fn set(&self, moment: &mut Moment, at: u64) {
        moment.set(self.forms, self.paths, at);
    }

    /// The width that an overlap is compared with: the width of the outline that gives way, or the lesser width.
    fn width(&self) -> i64 {
        let [a, b] = self.forms;
        let is_mutual = self.second == Second::GivesWay;
        match (a.width, b.width) {
            (0, 0) if a.is_link || b.is_link => LINE_WIDTH,
            (0, width) => width.min(LINE_WIDTH),
            (width, 0) if is_mutual => width.min(LINE_WIDTH),
            (a, b) if is_mutual => a.min(b),
            (width, _) => width,
        }
    }

    /// Returns true if an outline is behind a segment of a chain, by more than it may overlap it.
    fn is_behind(&self, moment: &Moment) -> bool {
        [0, 1].into_iter().filter(|&side| self.forms[side].is_link).any(|side| {
            let (segment, outline) = (&moment.places.placed[side], &moment.places.placed[1 - side]);
            let sign = if side == 0 { 1 } else { -1 };
            let corners = outline.corners();
            let count = corners.len() as i128;
            // Twice the heights over the middle of the segment: in a mirror image its ends change places. Below 2^72.
            let [from, to] = [segment.corners()[0], segment.corners()[1]];
            let sum = [0, 1].map(|k| {
                let total: i128 = corners.iter().map(|corner| i128::from(corner[k])).sum();
                2 * total + (2 * sign * moment.places.offset[k] - i128::from(from[k]) - i128::from(to[k])) * count
            });
            along(segment.normals()[0], sum) < -2 * i128::from(self.width() >> 3) * count
        })
    }

    /// The first moment from a start on at which they may come to overlap by a depth; `None` if they stay less deep to the end. `moment` is
    /// the start, and then that moment.
    fn reach(&self, depth: i64, from: u64, moment: &mut Moment) -> Option<u64> {
        self.reach_within(STEPS, depth, from, moment)
    }

    /// [`reach`](Self::reach) by at most so many steps.
    fn reach_within(&self, steps: u32, depth: i64, from: u64, moment: &mut Moment) -> Option<u64> {
        let mut at = from;
        let mut guess = END;
        let mut tolerance = None;
        for _ in 0..steps {
            let room = moment.until - at;
            let mut longest = moment.longest_across(depth, room, guess);
            // Most outlines pass each other, or go together.
            if at + longest == END {
                return None;
            }
            moment.measure();
            let tolerance = *tolerance.get_or_insert_with(|| rest_of_way(depth, moment.distance()));
            if longest < room {
                moment.each_widest(|gap| {
                    if longest < room {
                        longest = longest.max(moment.time(gap, depth, room, guess));
                    }
                });
            }
            if longest < room {
                let widest = moment.widest_distance().unwrap_or(0);
                if longest <= SHORTEST || widest + i128::from(depth) <= tolerance {
                    return Some(at);
                }
            }
            at += longest;
            if at == END {
                return None;
            }
            guess = longest.saturating_mul(16).min(END);
            moment.advance(self.forms, self.paths, at);
        }
        Some(at)
    }

    /// The first moment at which the outlines may overlap by a micrometre; `None` if they do not in the tick, or if one of them is behind a
    /// segment of a chain.
    pub(crate) fn first_touch(&self, memory: &mut Moment) -> Option<u64> {
        self.set(memory, 0);
        if self.is_behind(memory) { None } else { self.reach(TOUCH, 0, memory) }
    }

    /// The moment at which the outlines meet; `None` if they do not come to overlap by a micrometre, or if one of them is behind a segment of a
    /// chain at the start.
    ///
    /// Outlines that are more than a micrometre apart at the start are still apart then, up to rounding, and others overlap by a micrometre at most.
    /// Both moments are early if they take more than [`FINE_STEPS`] steps.
    pub(crate) fn time_of_impact(&self, memory: &mut Moment) -> Option<u64> {
        self.set(memory, 0);
        memory.measure();
        let start = memory.distance();
        if self.is_behind(memory) {
            return None;
        }
        let overlap = self.reach_within(FINE_STEPS, TOUCH, 0, memory)?;
        if start <= i128::from(TOUCH) {
            return Some(overlap);
        }
        self.set(memory, 0);
        self.reach_within(FINE_STEPS, 0, 0, memory).or(Some(overlap))
    }

    /// The moment, not before `from`, at which the paths must end so that neither outline crosses the other; `None` if they need not end.
    ///
    /// At that moment they overlap by 5 mm at most, and by less than an eighth of the width. A path may lead to a deeper overlap, up to
    /// that eighth, if the overlap is still there at the end of the tick: then there is a contact, which the next step solves. Outlines
    /// that overlap deeper at `from`, or are behind a segment of a chain, are not looked at.
    pub(crate) fn impact(&self, from: u64, [moment, end]: &mut [Moment; 2]) -> Option<u64> {
        let depths = Depths::new(self.width(), self.second);
        self.set(moment, from);
        moment.measure();
        let before = moment.distance();
        if before < -i128::from(depths.touch) || self.is_behind(moment) {
            return None;
        }
        // Outlines that overlap already may do so as deep as a tick may end, or else somewhat deeper than now.
        let depth = if depths.small == 0 {
            -((before >> 1).min(i128::from(CLEARANCE)) as i64)
        } else if before < -i128::from(depths.small >> 1) {
            // Thin ones would creep through in some ticks: they get a part of the depth that is left, and so never deeper than a touch. A
            // line that is as deep in a segment of a chain is almost behind it.
            let are_lines = self.forms.iter().all(|form| form.width == 0);
            let limit = if are_lines { depths.deep } else { depths.touch };
            let more = if depths.deep > depths.small { depths.small >> 2 } else { (limit + before as i64) >> 4 };
            depths.deep.max(more.max(2 * ROUNDING) - before as i64)
        } else {
            depths.small
        };
        let hit = self.reach(depth, from, moment)?;
        self.set(end, END);
        end.measure();
        let is_contact = end.distance() < 0 && {
            self.set(moment, from);
            self.reach(depths.deep.max(depth), from, moment).is_none()
        };
        self.set(moment, hit);
        moment.measure();
        if is_contact && are_sides_alike(moment, end) || self.is_behind(moment) { None } else { Some(hit) }
    }
}

/// The rest of a way down to a depth that counts as gone, for the distance at its start: a quarter.
fn rest_of_way(depth: i64, start: i128) -> i128 {
    // Outlines that overlap at the start have only the rest of the way up to the depth.
    let left = i128::from(depth) + start;
    let way = if left > 0 { left.min(depth.abs().into()) } else { depth.abs().into() };
    (way >> 2).max(ROUNDING.into())
}

/// Returns true if outlines are on the same side of each other at two moments, as far as the directions that separate best tell.
fn are_sides_alike(first: &Moment, second: &Moment) -> bool {
    let mut are_alike = false;
    first.each_widest(|a| second.each_widest(|b| are_alike |= height(a.n, b.n.map(i64::from)) > 0));
    are_alike
}
