//! The time for which two outlines surely stay apart along a direction.

use super::super::form::Swing;
use super::super::path::END;
use super::{Gap, Moment, ROUNDING, SHORTEST, TAU, along, length, product};

/// How a gap closes in a tick.
struct Closing {
    /// The free part of the gap, ulps.
    free: i128,
    /// The part that the way of the bodies against each other closes.
    way: i128,
    /// The corners along the direction, of bodies that turn.
    swings: [Option<Swing>; 2],
    /// The part that the way and the farthest corners close, if these go on straight: all corners together close no less.
    straight: i64,
    /// The free part with room for rounding, of levers too.
    far: i128,
}

impl Closing {
    /// Returns true if the farthest corners alone close the gap in some time.
    fn is_closed(&self, time: u64) -> bool {
        (i128::from(self.straight) * i128::from(time)) >> 62 >= self.far
    }
}

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
        let closing = self.closing(gap, free, closing);
        let stays = |time: u64| !closing.is_closed(time) && self.stays_apart(gap, &closing, time);
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

    /// How a gap closes, of which so much is free, where the way closes so much in a tick.
    fn closing(&self, gap: &Gap, free: i128, way: i128) -> Closing {
        let normals = [gap.n, gap.n.map(|part| -part)];
        let swings = [0, 1].map(|side| match self.legs[side].spin {
            0 => None,
            _ => self.places.placed[side].swing(normals[side]),
        });
        let straight = way + self.farthest_way(0, &swings[0]) + self.farthest_way(1, &swings[1]);
        let reaches = self.places.placed[0].reach + self.places.placed[1].reach;
        Closing {
            free,
            way,
            swings,
            straight: i64::try_from(straight.max(0)).unwrap_or(0),
            far: free + 32 + i128::from(reaches >> 26) + (way.max(0) >> 56),
        }
    }

    /// The way of the corner that is farthest along a direction, if it goes on straight at the speed of its body's rotation, ulps; of outlines
    /// without a swing a lower bound.
    fn farthest_way(&self, side: usize, swing: &Option<Swing>) -> i128 {
        match swing {
            Some(swing) => {
                // Below 2^62.1 · 2^53.
                let way = (i128::from(swing.farthest_way) * i128::from(self.radians(side))) >> 62;
                if self.legs[side].spin < 0 { -way } else { way }
            }
            None => -self.turn_speed(side),
        }
    }

    /// Returns true if the way that closes a gap stays below the free part for some time, as far as the speeds of corners and the bound of
    /// their acceleration say. This bound is convex in the time and zero at first, so that it holds all the time if it holds at the end.
    fn stays_apart(&self, gap: &Gap, closing: &Closing, time: u64) -> bool {
        let &Closing { free, way, ref swings, .. } = closing;
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
        let part = i128::from(if way > 0 { (time >> 4) + 1 } else { time >> 4 });
        // Products of words are much faster.
        let closed = match i64::try_from(way) {
            Ok(way) => (i128::from(way) * part) >> 58,
            Err(_) => (way * part) >> 58,
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

#[cfg(test)]
mod tests {
    use core::slice::from_ref;

    use super::*;
    use crate::cases::{run_seed, times};
    use crate::collide::sweep::{Form, Leg};
    use crate::fx;
    use crate::math::{Random, vec2};
    use crate::scalar::Turn;
    use crate::shape::Shape;

    /// Boxes, polygons and discs on all kinds of ways, which turn by up to a turn, and times up to the tick.
    #[test]
    fn gaps_that_the_farthest_corners_close_do_not_stay_open() {
        let mut random = Random::seeded(run_seed(59));
        let triangle = Shape::polygon(&[vec2(-1, -1), vec2(2, 0), vec2(0, 1)]);
        let shapes = [Shape::circle(fx!(0.5)), Shape::rectangle(1, 1), Shape::rectangle(900, fx!(0.5)), triangle];
        let shapes = shapes.map(|shape| shape.expect("a shape"));
        let outlines = shapes.each_ref().map(|shape| shape.outlines().first().expect("an outline"));
        let mut moment = Moment::default();
        let (mut closed, mut open) = (0, 0);
        for _ in 0..times(10_000) {
            let pair = [0, 1].map(|_| outlines[random.bits() as usize % outlines.len()]);
            let forms = pair.map(|outline| Form::new(outline, outline.width(), false));
            let (bits, spin_bits) = (24 + random.bits() as u32 % 16, 40 + random.bits() as u32 % 24);
            let legs = [0, 1].map(|_| {
                let mut part = |bits: u32| random.bits() as i64 >> (63 - bits);
                let (centre, way) = ([part(34), part(34)], [part(bits), part(bits)].map(i128::from));
                Leg::new(centre, way, Turn::from_bits(part(63) as u64), part(spin_bits).into())
            });
            moment.set([&forms[0], &forms[1]], [from_ref(&legs[0]), from_ref(&legs[1])], 0);
            moment.measure();
            let mut widest = None;
            moment.each_widest(|gap| widest = Some(*gap));
            let Some(gap) = widest else { continue };
            let way = -along(gap.n, [0, 1].map(|k| legs[1].way[k] - legs[0].way[k]));
            let closing = moment.closing(&gap, gap.distance.max(1), way);
            for _ in 0..8 {
                let time = END >> (random.bits() % 24);
                let stays = moment.stays_apart(&gap, &closing, time);
                assert!(!(stays && closing.is_closed(time)), "{legs:?} {time}");
                open += usize::from(stays);
                closed += usize::from(closing.is_closed(time));
            }
        }
        assert!(closed > 0 && open > 0, "{closed} {open}");
    }
}
