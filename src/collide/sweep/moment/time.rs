//! The time for which two outlines surely stay apart along a direction.

use super::super::form::Swing;
use super::super::path::END;
use super::{Gap, Moment, ROUNDING, SHORTEST, TAU, along, length, product};

impl Moment {
    /// The longest step that a direction across the way proves safe.
    pub(in super::super) fn longest_across(&mut self, depth: i64, room: u64, guess: u64) -> u64 {
        let Some(across) = self.across else { return 0 };
        let gaps = self.places.gaps(across);
        let overlap = -gaps[0].distance.max(gaps[1].distance) - i128::from(depth);
        // The way does not change this distance, but for rounding: where turns do not open the gap, the direction says nothing more.
        if overlap > 0
            && overlap > self.turn_speed(0) + self.turn_speed(1) + i128::from(4 * ROUNDING) + (self.way() >> 28)
        {
            self.across = None;
            return 0;
        }
        let allowed = gaps.iter().filter(|gap| self.places.is_allowed(gap.n));
        allowed.map(|gap| self.time(gap, depth, room, guess)).max().unwrap_or(0)
    }

    /// A bound of the way of the two bodies against each other in a tick, ulps: below 2^66.
    pub(super) fn way(&self) -> i128 {
        let [a, b] = &self.legs;
        length([0, 1].map(|k| b.way[k] - a.way[k]))
    }

    /// A bound of the distance by which a body's rotation moves a corner in a tick, ulps.
    fn turn_speed(&self, side: usize) -> i128 {
        match self.radians(side) {
            0 => 0,
            // Corners are below 2^49.
            radians => ((product(radians, self.places.placed[side].reach.unsigned_abs()) >> 32) + 2) as i128,
        }
    }

    /// The angle that a body turns in a tick, 2^-32 rad, rounded up: below 2^53.
    pub(super) fn radians(&self, side: usize) -> u64 {
        match self.legs[side].spin.unsigned_abs() {
            0 => 0,
            // Below 2^50 in units of 2^-32 turns, 2^85 in 2^-64 rad.
            turns => (product((turns >> 32) as u64 + 1, TAU as u64) >> 32) as u64 + 1,
        }
    }

    /// The angle that a body turns in a part of the tick, in 2^-44 rad, rounded up by at most 8; `None` above half a turn.
    fn angle(&self, side: usize, time: u64) -> Option<i64> {
        let turns = self.legs[side].spin.unsigned_abs();
        // Whole turns below 2^18, and the rest.
        let turned = (product((turns >> 64) as u64, time) << 2) + (product(turns as u64, time) >> 62);
        // From 2^-64 turns to 2^-44 rad: below 2^43 · 2^35.
        (turned < 1 << 63).then(|| ((product((turned >> 20) as u64 + 1, TAU as u64) >> 32) + 1) as i64)
    }

    /// The time for which the distance along a direction surely stays above −depth, at most `room`.
    pub(in super::super) fn time(&self, gap: &Gap, depth: i64, room: u64, guess: u64) -> u64 {
        let free = gap.distance + i128::from(depth - ROUNDING - (self.places.radius >> 26));
        if free <= 0 {
            return 0;
        }
        let [a, b] = &self.legs;
        // Rounded up.
        let closing = -along(gap.n, [0, 1].map(|k| b.way[k] - a.way[k]));
        let bounds = [0, 1].map(|side| {
            // By how much the farthest corner may reach farther out; a unit vector is off by 2^-29.
            let reach = self.places.placed[side].reach;
            let reach = reach + (reach >> 28) + 2;
            let more = if side == 0 { reach - gap.support_a } else { reach + gap.support_b };
            (self.turn_speed(side), i128::from(more.max(0)))
        });
        let time = bounded(free, closing, bounds).min(room);
        if time == room || bounds.iter().all(|(speed, bound)| *speed == 0 || *bound == 0) {
            return time;
        }
        // Turns take corners back by at most as much as they take them farther out: the least way that closes in the tick, and what it has to
        // close, with room for rounding, of levers too.
        let closed =
            free + 32 + i128::from((self.places.placed[0].reach + self.places.placed[1].reach) >> 26) + (closing >> 56);
        let least_closing = i64::try_from(closing - bounds[0].0 - bounds[1].0).unwrap_or(0).max(0);
        let normals = [gap.n, gap.n.map(|part| -part)];
        let swings = [0, 1].map(|side| match self.legs[side].spin {
            0 => None,
            _ => self.places.placed[side].swing(normals[side]),
        });
        let stays = |time: u64| {
            let is_closed = (i128::from(least_closing) * i128::from(time)) >> 62 >= closed;
            !is_closed && self.stays_apart(gap, &swings, free, closing, time)
        };
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
    fn stays_apart(&self, gap: &Gap, swings: &[Option<Swing>; 2], free: i128, closing: i128, time: u64) -> bool {
        let (Some(turn_a), Some(turn_b)) = (self.angle(0, time), self.angle(1, time)) else { return false };
        let farther = |side: usize, turn: i64| {
            let (placed, leg) = (&self.places.placed[side], &self.legs[side]);
            if leg.spin == 0 {
                return 0;
            }
            let n = if side == 0 { gap.n } else { gap.n.map(|part| -part) };
            let signed = if leg.spin < 0 { -turn } else { turn };
            let highest = swings[side].as_ref().and_then(|swing| swing.highest_after(signed));
            let highest = highest.unwrap_or_else(|| placed.highest_after(n, signed));
            let support = if side == 0 { gap.support_a } else { -gap.support_b };
            // Rounded up: the product above, the angle, and half of its square.
            let rounding = i128::from(2 + (placed.reach >> 40));
            // Below 2^92 >> 44, and below 2^48 · 2^50.
            let size = turn.unsigned_abs();
            let square = (product(size, size) >> 44) as u64 + 1;
            let bend = product(square, (placed.reach + 2).unsigned_abs()) >> 45;
            (highest >> 30) - i128::from(support) + rounding + bend as i128 + 1
        };
        // Below 2^66 · 2^58, rounded up.
        let part = i128::from(if closing > 0 { (time >> 4) + 1 } else { time >> 4 });
        // Products of words are much faster.
        let closed = match i64::try_from(closing) {
            Ok(closing) => (i128::from(closing) * part) >> 58,
            Err(_) => (closing * part) >> 58,
        };
        let closed = closed + 1;
        farther(0, turn_a) + farther(1, turn_b) + closed < free
    }
}

/// The time for which `closing·t + Σ min(speed·t, bound)` stays below `free`, rounded down.
fn bounded(free: i128, closing: i128, bounds: [(i128, i128); 2]) -> u64 {
    // distance / speed. Both are cut to 64 bits, the speed rounded up.
    let time = |distance: i128, speed: i128| {
        if speed <= 0 || distance >= speed {
            return END;
        }
        if distance <= 0 {
            return 0;
        }
        let right = (128 - speed.leading_zeros()).saturating_sub(64);
        (((distance.unsigned_abs() >> right) << 62) / ((speed.unsigned_abs() >> right) + 1)) as u64
    };
    // A rotation is at its bound from some time on.
    let [first, second] = bounds.map(|(speed, bound)| {
        let bound = if speed == 0 { 0 } else { bound };
        (time(bound, speed.max(1)), speed, bound)
    });
    let (first, second) = if first.0 <= second.0 { (first, second) } else { (second, first) };
    // The sum is concave: where it stops growing below `free`, it stays there. Each line is an upper bound of it.
    let joint_time = time(free, closing + first.1 + second.1);
    if joint_time <= first.0 {
        return joint_time;
    }
    let second_time = time(free - first.2, closing + second.1);
    if second_time <= second.0 {
        return second_time.max(first.0);
    }
    time(free - first.2 - second.2, closing).max(second.0)
}
