//! The memory of a moving collider: its fat box.

use super::Proxy;
use super::bounds::Bounds;
use super::tree::{Extent, NONE};
use crate::collider::Filter;

/// The largest margin around a box, 5 cm in ulps.
const MARGIN: i64 = (5 << 32) / 100;

/// The number of steps for which a fat box has room, at the motion that a collider has.
const STEPS_AHEAD: i64 = 4;

/// The memory of a moving collider.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub(super) fat: Bounds,
    /// The lower left corner of the box in the step before; the present corner for a new collider.
    pub(super) previous_min: [i64; 2],
    /// Half the perimeter of the fat box, in units of 8 ulp.
    half_perimeter: i64,
    pub(super) filter: Filter,
    pub(super) body: u32,
    /// The leaf, or [`NONE`] for one that does not move.
    pub(super) leaf: u32,
    /// The last step in which the collider moved.
    pub(super) last_step: u32,
    /// The number of colliders that its last search came to and that are no candidates with it.
    pub(super) rejected: u32,
    /// True if its candidates are searched anew in this step.
    pub(super) is_stale: bool,
}

impl Entry {
    pub(super) const NONE: Self = Self {
        fat: Bounds::EMPTY,
        previous_min: [0; 2],
        half_perimeter: 0,
        filter: Filter { category: 0, mask: 0, group: 0 },
        body: NONE,
        leaf: NONE,
        last_step: 0,
        rejected: 0,
        is_stale: false,
    };

    pub(super) fn extent(&self) -> Extent {
        Extent::new(self.fat, self.filter)
    }

    /// Returns true if a proxy has another filter or another body.
    #[inline(always)]
    pub(super) fn differs_from(&self, proxy: &Proxy) -> bool {
        self.filter != proxy.filter || self.body != proxy.body
    }

    /// Returns true if two colliders are of two bodies and their filters agree.
    #[inline(always)]
    pub(super) fn may_meet(&self, entry: &Self) -> bool {
        self.body != entry.body && self.filter.agrees(entry.filter)
    }

    /// Returns true if the fat box holds a box and is not far too large for it: a collider that stopped gives back its room for motion.
    #[inline(always)]
    pub(super) fn fits(&self, bounds: &Bounds) -> bool {
        // Between ±2^62, as both are from 0 to 2^62.
        let slack = self.half_perimeter - bounds.half_perimeter();
        self.fat.contains(bounds) && (slack <= MARGIN || slack <= self.max_slack(bounds))
    }

    /// The largest excess that half the perimeter of the fat box may have, given the motion: about twice its excess at first.
    fn max_slack(&self, bounds: &Bounds) -> i64 {
        let [x, y] = self.motion(bounds).map(|d| d.saturating_abs() >> 3);
        (x + y).saturating_mul(2 * STEPS_AHEAD).saturating_add(MARGIN)
    }

    /// The motion of the box since the step before.
    fn motion(&self, bounds: &Bounds) -> [i64; 2] {
        [0, 1].map(|k| bounds.min[k].saturating_sub(self.previous_min[k]))
    }

    /// Makes a fat box around a box.
    pub(super) fn fatten(&mut self, bounds: &Bounds) {
        let [width, height] = bounds.sides();
        let size = width.max(height);
        let margin = (size >> 3).min(MARGIN);
        let ahead = self.motion(bounds).map(|d| d.saturating_mul(STEPS_AHEAD).clamp(-size, size));
        // At the ends of the range a fat box is cut off there, where no box reaches beyond.
        self.fit(Bounds {
            min: [0, 1].map(|k| bounds.min[k].saturating_sub(margin).saturating_add(ahead[k].min(0))),
            max: [0, 1].map(|k| bounds.max[k].saturating_add(margin).saturating_add(ahead[k].max(0))),
        });
    }

    /// Makes a box the fat one, as it is.
    pub(super) fn fit(&mut self, bounds: Bounds) {
        (self.fat, self.half_perimeter) = (bounds, bounds.half_perimeter());
    }
}
