//! Time of impact: the moment of a tick at which two outlines on given paths meet.
//!
//! *Conservative advancement.* At a moment, any direction n along which the outlines are apart (or overlap by less than is allowed) bounds
//! from below the time for which they stay so: along n, the distance shrinks by the displacement, by what corners approach at their
//! present speeds, and by at most φ²·r/2 more for a rotation by φ of corners within r of the centre; nor does a corner ever
//! reach farther than r. The longest of those times over several directions is passed in one step, and so on until the end of the tick or
//! until no direction says more. So the outlines do not meet before the moment that is found, whatever the directions: a direction that
//! is not the best one costs steps, and a path that takes more than [`STEPS`] of them ends early.
//!
//! All directions that tie are tried and the longest time is taken, so that neither the order of corners nor a mirror image changes the
//! moment.

mod form;
mod path;

use crate::kernel::sqrt::direction;
use crate::scalar::Turn;

pub(crate) use form::Form;
use form::Seen;
pub(crate) use path::{END, Leg, Path, ends};

/// The most steps along a path.
pub(crate) const STEPS: u32 = 96;

/// Outlines that overlap by this touch, ulps: a micrometre.
const TOUCH: i64 = 1 << 12;

/// The most that rounding adds to a distance, ulps: that of corners, of centres and their angles, and of the parts of a bound.
const ROUNDING: i64 = 16;

/// 2π in 2^-32, rounded up.
const TAU: u128 = 26_986_075_410;

/// Two outlines on their paths.
pub(crate) struct Sweep<'a> {
    pub(crate) forms: [&'a Form<'a>; 2],
    /// The pieces of their paths.
    pub(crate) paths: [&'a [Leg]; 2],
    /// True if both give way; else the first one does.
    pub(crate) is_mutual: bool,
}

/// Two outlines at a moment: memory for sweeps.
#[derive(Clone, Debug)]
pub(crate) struct Moment {
    seen: [Seen; 2],
    legs: [Leg; 2],
    /// From the centre of the first to that of the second.
    offset: [i128; 2],
    radius: i64,
    /// The moment at which a piece of either path ends.
    until: u64,
    /// `None` until somebody asks.
    widest: Option<Widest>,
}

impl Default for Moment {
    fn default() -> Self {
        let leg = Leg::new([0; 2], [0; 2], Turn::default(), 0);
        Self { seen: [Seen::NONE; 2], legs: [leg; 2], offset: [0; 2], radius: 0, until: 0, widest: None }
    }
}

/// The most directions of the largest distance that are kept: faces that lie on each other have four.
const KEPT: usize = 8;

/// The largest distance along a direction that counts.
#[derive(Clone, Copy, Debug)]
struct Widest {
    /// `None` if no direction counts.
    distance: Option<i128>,
    /// The number of directions that have it, and the first ones of these.
    count: usize,
    gaps: [Gap; KEPT],
}

impl Widest {
    const NONE: Self =
        Self { distance: None, count: 0, gaps: [Gap { n: [0; 2], most: 0, least: 0, distance: 0 }; KEPT] };

    fn add(&mut self, gap: Gap) {
        if Some(gap.distance) > self.distance {
            (self.distance, self.count) = (Some(gap.distance), 0);
        }
        if Some(gap.distance) == self.distance {
            if let Some(place) = self.gaps.get_mut(self.count) {
                *place = gap;
            }
            self.count += 1;
        }
    }
}

/// The distance along a direction, ulps.
#[derive(Clone, Copy, Debug)]
struct Gap {
    n: [i32; 2],
    /// The largest component of a corner of the first one, and the least of the second one, relative to their centres.
    most: i64,
    least: i64,
    /// The distance of the surfaces, rounded down.
    distance: i128,
}

/// n·p in units of p, rounded down. *Domain* |p| < 2^72: products are below 2^103.
fn along(n: [i32; 2], p: [i128; 2]) -> i128 {
    (i128::from(n[0]) * p[0] + i128::from(n[1]) * p[1]) >> 30
}

/// n·p in units of 2^-30 of p's.
fn height(n: [i32; 2], p: [i64; 2]) -> i128 {
    i128::from(n[0]) * i128::from(p[0]) + i128::from(n[1]) * i128::from(p[1])
}

/// The unit vector along a vector of any size, 2^-30.
fn unit([x, y]: [i128; 2]) -> Option<[i32; 2]> {
    if (x, y) == (0, 0) {
        return None;
    }
    let bits = 128 - (x.unsigned_abs() | y.unsigned_abs()).leading_zeros();
    // The magnitudes are cut off, so that it is odd.
    let cut = |v: i128| {
        let size = (v.unsigned_abs() >> bits.saturating_sub(62)) as i64;
        if v < 0 { -size } else { size }
    };
    Some(direction(cut(x), cut(y)).0)
}

impl Moment {
    fn gap(&self, n: [i32; 2]) -> Gap {
        let most = self.seen[0].corners().iter().map(|&corner| height(n, corner)).max().unwrap_or(0);
        let least = self.seen[1].corners().iter().map(|&corner| height(n, corner)).min().unwrap_or(0);
        // Rounded to what is farther out.
        let (most, least) = (-((-most) >> 30) as i64, (least >> 30) as i64);
        let between = along(n, self.offset) + i128::from(least) - i128::from(most);
        Gap { n, most, least, distance: between - i128::from(self.radius) }
    }

    /// The directions that may separate best: of all edges, and between the corners that are nearest to each other.
    fn each_direction(&self, mut visit: impl FnMut([i32; 2])) {
        self.seen[0].normals().iter().for_each(|&n| visit(n));
        self.seen[1].normals().iter().for_each(|&n| visit(n.map(|part| -part)));
        // Centres are cut to words, which tells apart what is never near; corners are below 2^50.
        let offset = self.offset.map(|part| part.clamp(-(1 << 62), 1 << 62) as i64);
        let [a, b] = [0, 1].map(|side: usize| self.seen[side].corners());
        let between = |a: [i64; 2], b: [i64; 2]| [offset[0] + b[0] - a[0], offset[1] + b[1] - a[1]];
        let square = |[x, y]: [i64; 2]| u128::from(x.unsigned_abs()).pow(2) + u128::from(y.unsigned_abs()).pow(2);
        let mut least = u128::MAX;
        for &a in a {
            for &b in b {
                least = least.min(square(between(a, b)));
            }
        }
        for &a in a {
            for &b in b {
                let d = between(a, b);
                if square(d) == least {
                    unit(d.map(i128::from)).into_iter().for_each(&mut visit);
                }
            }
        }
    }

    /// The distance of the outlines, negative where they overlap.
    fn distance(&self) -> i128 {
        self.widest.as_ref().and_then(|widest| widest.distance).unwrap_or(-(1 << 80))
    }

    /// A bound of the distance by which a body's rotation moves a corner in a tick, ulps.
    fn turn_speed(&self, side: usize) -> i128 {
        let turns = self.legs[side].spin.unsigned_abs();
        if turns == 0 {
            return 0;
        }
        // Below 2^50 in units of 2^-32 turns, 2^85 in 2^-64 rad; corners are below 2^49.
        let radians = ((((turns >> 32) + 1) * TAU) >> 32) + 1;
        (((radians * self.seen[side].reach.unsigned_abs() as u128) >> 32) + 2) as i128
    }

    /// The angle that a body turns in a part of the tick, in 2^-44 rad, rounded up by at most 8; `None` above half a turn.
    fn angle(&self, side: usize, time: u64) -> Option<i64> {
        let (turns, time) = (self.legs[side].spin.unsigned_abs(), u128::from(time));
        // Whole turns below 2^18, and the rest.
        let turned = (((turns >> 64) * time) << 2) + (((turns & u128::from(u64::MAX)) * time) >> 62);
        // From 2^-64 turns to 2^-44 rad: below 2^43 · 2^35.
        (turned < 1 << 63).then(|| (((((turned >> 20) + 1) * TAU) >> 32) + 1) as i64)
    }

    /// The time for which the distance along a direction surely stays above −depth, at most `room`.
    fn time(&self, gap: &Gap, depth: i64, room: u64, guess: u64) -> u64 {
        let free = gap.distance + i128::from(depth - ROUNDING - (self.radius >> 26));
        if free <= 0 {
            return 0;
        }
        let [a, b] = &self.legs;
        // Rounded up.
        let closing = -along(gap.n, [0, 1].map(|k| b.way[k] - a.way[k]));
        let bounds = [0, 1].map(|side| {
            // By how much the farthest corner may reach farther out; a unit vector is off by 2^-29.
            let reach = self.seen[side].reach;
            let reach = reach + (reach >> 28) + 2;
            let more = if side == 0 { reach - gap.most } else { reach + gap.least };
            (self.turn_speed(side), i128::from(more.max(0)))
        });
        let time = bounded(free, closing, bounds).min(room);
        if time == room || bounds.iter().all(|(speed, most)| *speed == 0 || *most == 0) {
            return time;
        }
        let stays = |time: u64| self.stays_apart(gap, free, closing, time);
        if stays(room) {
            return room;
        }
        let mut next = room.min(guess) >> 1;
        while next > time && next > SHORTEST {
            if stays(next) {
                let more = next + (next >> 1);
                return if more < room && stays(more) { more } else { next };
            }
            next >>= 1;
        }
        time
    }

    /// Returns true if a distance along a direction stays below `free` for some time, as far as the speeds of corners and the bound of
    /// their acceleration say. This bound is convex in the time and zero at first, so that it holds all the time if it holds at the end.
    fn stays_apart(&self, gap: &Gap, free: i128, closing: i128, time: u64) -> bool {
        let (Some(turn_a), Some(turn_b)) = (self.angle(0, time), self.angle(1, time)) else { return false };
        let farther = |side: usize, turn: i64| {
            let (seen, leg) = (&self.seen[side], &self.legs[side]);
            if leg.spin == 0 {
                return 0;
            }
            let [x, y] = if side == 0 { gap.n } else { gap.n.map(|part| -part) };
            let (turn, size) = (if leg.spin < 0 { -i128::from(turn) } else { turn.into() }, i128::from(turn));
            // Along n, and along n the corner turned by a quarter. Corners are below 2^49.5 ulps, angles below 2^46: below 2^126.
            let at = |&corner: &[i64; 2]| height([x, y], corner) + ((height([y, -x], corner) * turn) >> 44);
            let most = seen.corners().iter().map(at).max().unwrap_or(0);
            let own = if side == 0 { gap.most } else { -gap.least };
            // Rounded up: the product above, the angle, and half of its square.
            let rounding = i128::from(2 + (seen.reach >> 40));
            let square = ((size * size) >> 44) + 1;
            (most >> 30) - i128::from(own) + rounding + ((square * i128::from(seen.reach + 2)) >> 45) + 1
        };
        // Below 2^66 · 2^58, rounded up.
        let part = i128::from(if closing > 0 { (time >> 4) + 1 } else { time >> 4 });
        let closed = ((closing * part) >> 58) + 1;
        farther(0, turn_a) + farther(1, turn_b) + closed < free
    }
}

/// The shortest step: 2^-40 of a tick.
const SHORTEST: u64 = END >> 40;

/// The time for which `closing·t + Σ min(speed·t, most)` stays below `free`, rounded down.
fn bounded(free: i128, closing: i128, bounds: [(i128, i128); 2]) -> u64 {
    // distance / speed. Both are cut to 64 bits, the speed rounded up.
    let time = |distance: i128, speed: i128| {
        if speed <= 0 || distance >= speed {
            return END;
        }
        let right = (128 - speed.leading_zeros()).saturating_sub(64);
        (((distance.max(0).unsigned_abs() >> right) << 62) / ((speed.unsigned_abs() >> right) + 1)) as u64
    };
    // A rotation is at its bound from some time on.
    let [first, second] = bounds.map(|(speed, most)| {
        let most = if speed == 0 { 0 } else { most };
        (time(most, speed.max(1)), speed, most)
    });
    let (first, second) = if first.0 <= second.0 { (first, second) } else { (second, first) };
    // The sum is concave: where it stops growing below `free`, it stays there. Each line is an upper bound of it.
    let both = time(free, closing + first.1 + second.1);
    if both <= first.0 {
        return both;
    }
    let one = time(free - first.2, closing + second.1);
    if one <= second.0 {
        return one.max(first.0);
    }
    time(free - first.2 - second.2, closing).max(second.0)
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
    fn new(width: i64) -> Self {
        let eighth = width >> 3;
        let small = eighth.min(SMALL);
        if small == 0 {
            // A line may overlap another one at its ends alone.
            return Self { small, deep: 1 << 22, touch: -APART };
        }
        Self { small, deep: eighth, touch: width >> 2 }
    }
}

/// Lines nearer than this touch, ulps: 6e-8 m.
const APART: i64 = 1 << 8;

/// The distance that a path leaves between lines: 15 µm, or half of what there was.
const LEFT: i64 = 1 << 16;

/// Width of a segment where it meets something on one side alone, or something thick: 4 cm.
const OF_LINES: i64 = (4 << 32) / 100;

impl Sweep<'_> {
    /// Brings both outlines to a moment.
    fn set(&self, moment: &mut Moment, at: u64) {
        let [(a, until_a), (b, until_b)] = self.paths.map(|legs| path::leg(legs, at));
        moment.seen[0].set(self.forms[0], a, at);
        moment.seen[1].set(self.forms[1], b, at);
        let [from, to] = [moment.seen[0].centre, moment.seen[1].centre];
        moment.offset = [0, 1].map(|k| i128::from(to[k]) - i128::from(from[k]));
        moment.legs = [*a, *b];
        moment.radius = self.forms[0].radius + self.forms[1].radius;
        moment.until = until_a.min(until_b);
        moment.widest = None;
    }

    /// Finds the largest distance along a direction at a moment.
    fn measure(&self, moment: &mut Moment) {
        if moment.widest.is_some() {
            return;
        }
        let mut widest = Widest::NONE;
        moment.each_direction(|n| {
            if self.is_allowed(moment, n) {
                widest.add(moment.gap(n));
            }
        });
        moment.widest = Some(widest);
    }

    /// Visits the directions of the largest distance, all that tie, at a moment that was [measured](Self::measure).
    fn each_widest(&self, moment: &Moment, mut visit: impl FnMut(&Gap)) {
        let Some(widest) = &moment.widest else { return };
        if let Some(gaps) = widest.gaps.get(..widest.count) {
            gaps.iter().for_each(visit);
            return;
        }
        moment.each_direction(|n| {
            let gap = moment.gap(n);
            if self.is_allowed(moment, n) && Some(gap.distance) == widest.distance {
                visit(&gap);
            }
        });
    }

    /// The width that an overlap is compared with: that of the outline that gives way, or the lesser one.
    fn width(&self) -> i64 {
        let [a, b] = self.forms;
        match (a.width, b.width) {
            (0, 0) if a.is_link || b.is_link => OF_LINES,
            (0, width) => width.min(OF_LINES),
            (width, 0) if self.is_mutual => width.min(OF_LINES),
            (a, b) if self.is_mutual => a.min(b),
            (width, _) => width,
        }
    }

    /// Returns true if a direction counts. A segment touches a chain on the chain's outer side, and has no other side to be told by.
    fn is_allowed(&self, moment: &Moment, n: [i32; 2]) -> bool {
        let [a, b] = self.forms;
        let front = match (a.is_link, b.is_link) {
            (true, _) if b.width == 0 => moment.seen[0].normals()[0],
            (_, true) if a.width == 0 => moment.seen[1].normals()[0].map(|part| -part),
            _ => return true,
        };
        height(n, front.map(i64::from)) >= 0
    }

    /// Returns true if an outline is behind a segment of a chain, by more than it may overlap it.
    fn is_behind(&self, moment: &Moment) -> bool {
        [0, 1].into_iter().filter(|&side| self.forms[side].is_link).any(|side| {
            let (own, other) = (&moment.seen[side], &moment.seen[1 - side]);
            let sign = if side == 0 { 1 } else { -1 };
            let corners = other.corners();
            let count = corners.len() as i128;
            // Twice the heights over the middle of the segment: in a mirror image its ends change places. Below 2^72.
            let [from, to] = [own.corners()[0], own.corners()[1]];
            let sum = [0, 1].map(|k| {
                let all: i128 = corners.iter().map(|corner| i128::from(corner[k])).sum();
                2 * all + (2 * sign * moment.offset[k] - i128::from(from[k]) - i128::from(to[k])) * count
            });
            along(own.normals()[0], sum) < -2 * i128::from(self.width() >> 3) * count
        })
    }

    /// The first moment from a start on at which they may come to overlap by a depth; `None` if they stay less deep to the end. `moment` is
    /// the start, and then that moment.
    fn reach(&self, depth: i64, from: u64, moment: &mut Moment) -> Option<u64> {
        // Most outlines pass each other, or go together.
        if moment.until == END && self.longest_across(moment, depth, END - from, END) == END - from {
            return None;
        }
        self.measure(moment);
        // From here on the rest of the way counts as gone.
        // Outlines that overlap at the start have only what is left up to the depth.
        let left = i128::from(depth) + moment.distance();
        let way = if left > 0 { left.min(depth.abs().into()) } else { depth.abs().into() };
        let tolerance = (way >> 2).max(ROUNDING.into());
        let (mut at, mut guess) = (from, END);
        for _ in 0..STEPS {
            let room = moment.until - at;
            let mut longest = self.longest_across(moment, depth, room, guess);
            if longest < room {
                self.measure(moment);
                self.each_widest(moment, |gap| {
                    if longest < room {
                        longest = longest.max(moment.time(gap, depth, room, guess));
                    }
                });
            }
            if longest < room {
                let widest = moment.widest.as_ref().and_then(|widest| widest.distance).unwrap_or(0);
                if longest <= SHORTEST || widest + i128::from(depth) <= tolerance {
                    return Some(at);
                }
            }
            at += longest;
            if at == END {
                return None;
            }
            guess = longest.saturating_mul(16).min(END);
            self.set(moment, at);
        }
        Some(at)
    }

    /// The longest step that a direction across the way proves safe.
    fn longest_across(&self, moment: &Moment, depth: i64, room: u64, guess: u64) -> u64 {
        let [a, b] = &moment.legs;
        let Some([x, y]) = unit([0, 1].map(|k| b.way[k] - a.way[k])) else { return 0 };
        let allowed = [[-y, x], [y, -x]].into_iter().filter(|&n| self.is_allowed(moment, n));
        allowed.map(|n| moment.time(&moment.gap(n), depth, room, guess)).max().unwrap_or(0)
    }

    /// Returns true if they are on the same side of each other at two moments, as far as the directions that separate best tell.
    fn are_sides_alike(&self, first: &Moment, second: &Moment) -> bool {
        let mut are_alike = false;
        self.each_widest(first, |a| {
            self.each_widest(second, |b| are_alike |= height(a.n, b.n.map(i64::from)) > 0);
        });
        are_alike
    }

    /// The first moment at which the outlines may overlap by a micrometre; `None` if they do not in the tick, or if one of them is behind a
    /// segment of a chain.
    pub(crate) fn first_touch(&self, memory: &mut Moment) -> Option<u64> {
        self.set(memory, 0);
        if self.is_behind(memory) { None } else { self.reach(TOUCH, 0, memory) }
    }

    /// The moment, not before `from`, at which the paths must end so that neither outline crosses the other; `None` if they need not end.
    ///
    /// At that moment they overlap by 5 mm at most, and by less than an eighth of the width. A path may lead to a deeper overlap, up to
    /// that eighth, if the overlap is still there at the end of the tick: then there is a contact, which the next step solves. Outlines
    /// that overlap deeper at `from`, or are behind a segment of a chain, are not looked at.
    pub(crate) fn impact(&self, from: u64, [moment, end]: &mut [Moment; 2]) -> Option<u64> {
        let depths = Depths::new(self.width());
        self.set(moment, from);
        self.measure(moment);
        let before = moment.distance();
        if before < -i128::from(depths.touch) || self.is_behind(moment) {
            return None;
        }
        // Outlines that overlap already may do so as deep as a tick may end, or else hardly deeper than now.
        let depth = if depths.small == 0 {
            -((before >> 1).min(i128::from(LEFT)) as i64)
        } else if before < -i128::from(depths.small >> 1) {
            // Thin ones would creep through in some ticks.
            let more = if depths.deep > depths.small { depths.small >> 2 } else { 2 * ROUNDING };
            depths.deep.max(more - before as i64)
        } else {
            depths.small
        };
        let hit = self.reach(depth, from, moment)?;
        self.set(end, END);
        self.measure(end);
        let is_contact = end.distance() < 0 && {
            self.set(moment, from);
            self.reach(depths.deep.max(depth), from, moment).is_none()
        };
        self.set(moment, hit);
        self.measure(moment);
        if is_contact && self.are_sides_alike(moment, end) || self.is_behind(moment) { None } else { Some(hit) }
    }
}
