//! Limits of the velocity at which contacts push overlaps out.

use super::batch::Batch;
use super::group::Group;
use crate::kernel::simd::{GROUP, Lanes};

impl Batch {
    /// Limits the pushes of the contacts of a group that would make a body faster than the push: see [`limit_push`](Self::limit_push).
    #[inline(always)]
    pub(super) fn limit_pushes<L: Lanes>(&self, lanes: L, group: &mut Group) {
        let mut is_none_limited = true;
        for at in (0..GROUP).step_by(L::WIDTH) {
            is_none_limited &= self.is_none_limited(lanes, group, at);
        }
        if !is_none_limited {
            for lane in (0..group.count).filter(|&lane| self.moves(lane)) {
                self.limit_push(lane, group);
            }
        }
    }

    /// Returns true if no push of these lanes needs a limit.
    #[inline(always)]
    fn is_none_limited<L: Lanes>(&self, lanes: L, group: &Group, at: usize) -> bool {
        let zero = lanes.all(0);
        let mut faster = zero;
        for (row, element) in [(0, 0), (1, 2)] {
            let along = lanes.wide(&self.whole[element], at);
            for side in 0..2 {
                let [x, y] = &self.linear[0][side];
                let rim = lanes.low(lanes.floored::<10>(lanes.wide(&self.rim[side], at)));
                let rim = lanes.times(lanes.low(lanes.wide(&self.angular[row][side], at)), rim);
                // Towards zero, as below.
                let rim = lanes.floored::<20>(lanes.magnitude(rim));
                let fastest = lanes.largest([lanes.wide(x, at), lanes.wide(y, at), rim]);
                faster = lanes.larger(faster, lanes.sub(fastest, along));
            }
        }
        let (first, second) = lanes.pair(&group.separation, at);
        let (_, limit) = lanes.pair(&group.push_out, at);
        let unit = lanes.splat(1);
        let limit = lanes.floored::<4>(lanes.times(limit, unit));
        let separation = lanes.times(lanes.at_least(first, second), unit);
        // Empty lanes have zeros.
        let deeper = lanes.positive(lanes.sub(limit, separation));
        lanes.is_zero(lanes.add(lanes.positive(faster), deeper))
    }

    /// Limits the velocity at which an overlap is pushed out so that neither a body nor its rim becomes faster than the push: a body with locks
    /// that is pushed across the way that they leave it, or at a small lever, would be thrown.
    ///
    /// # Ranges
    /// Changes of angular velocities are within 2^31 and rims at most 2^30 · 2^-10: products are below 2^51. Depths are below 2^31.
    #[cold]
    fn limit_push(&self, lane: usize, group: &mut Group) {
        let limit = group.push_out[lane][1];
        let change = |row: usize, side: usize| {
            // Towards zero: alike in a mirror image.
            let rim = self.angular[row][side][lane] * (self.rim[side][lane] >> 10) / (1 << 20);
            let [x, y] = [0, 1].map(|axis: usize| self.linear[0][side][axis][lane]);
            [rim, x, y]
        };
        let fastest = |changes: [i64; 3]| changes.into_iter().map(i64::abs).max().unwrap_or(0);
        for (row, element) in [(0, 0), (1, 2)] {
            let speed = fastest(change(row, 0)).max(fastest(change(row, 1)));
            let along = self.whole[element][lane];
            if speed > along {
                let deepest = i128::from(limit) * i128::from(along) / i128::from(speed);
                group.push_out[lane][1] = group.push_out[lane][1].max(deepest as i32);
            }
        }
        let [first, second] = group.separation[lane];
        if first.max(second) < limit >> 4 {
            self.limit_push_of_both(lane, group, limit, [0, 1].map(|side| [change(0, side), change(1, side)]));
        }
    }

    /// [`limit_push`](Self::limit_push) for both points together, with the changes of velocity (rim, x, y) of each body by an impulse at
    /// each point: points on both sides of a body that locks hold can only move it fast, or not at all.
    ///
    /// # Ranges
    /// All factors are within 2^33: products are below 2^66, their sums with a third factor below 2^101, times a depth below 2^132: depths
    /// are taken with 2^-8.
    #[cold]
    fn limit_push_of_both(&self, lane: usize, group: &mut Group, limit: i32, changes: [[[i64; 3]; 2]; 2]) {
        let [k11, k12, k22] = [0, 1, 2].map(|element: usize| i128::from(self.whole[element][lane]));
        // The impulses that move both points alike, times the determinant; one that pulls is none, and then one point decides.
        let impulses = [k22 - k12, k11 - k12];
        if impulses[0] <= 0 || impulses[1] <= 0 {
            return;
        }
        let determinant = (k11 * k22 - k12 * k12).max(0);
        let speed = |[first, second]: [[i64; 3]; 2]| {
            let sums = (0..3).map(|k| i128::from(first[k]) * impulses[0] + i128::from(second[k]) * impulses[1]);
            sums.map(i128::abs).max().unwrap_or(0)
        };
        let fastest = speed(changes[0]).max(speed(changes[1]));
        if fastest > determinant {
            let deepest = i128::from(limit >> 8) * determinant / fastest;
            group.push_out[lane][1] = group.push_out[lane][1].max((deepest << 8) as i32);
        }
    }
}
