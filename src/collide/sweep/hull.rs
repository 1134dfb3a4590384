//! The region that a turning outline passes: a box around all that its body passes is far too large for a long outline.

use core::slice::from_ref;

use super::form::{Form, PlacedForm};
use super::moment::{TAU, along};
use super::path::{END, Leg};

/// The most normals by which other outlines are told to be outside.
const NORMALS: usize = 8;

/// The largest rotation, a sixteenth of a turn, and the longest way, ulps.
const ROTATION: u128 = 1 << 60;
const WAY: u128 = 1 << 54;

/// The growth of the region, ulps: more than the distance that lines keep, and than rounding.
const GROWTH: i64 = 1 << 17;

/// A region around an outline on a path of one piece: what has no point in it does not come near the outline.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hull {
    centre: [i64; 2],
    /// Its box: low and high ends.
    pub(crate) ends: [[i64; 2]; 2],
    count: usize,
    /// Directions, and how far it reaches along them from the centre.
    sides: [([i32; 2], i128); NORMALS],
}

impl Hull {
    /// The region of an outline; `None` if it turns or moves far.
    ///
    /// # Ranges
    /// Corners are within 2^50 ulps of the centre, on a way below 2^54. The angle is below 2^31 in 2^-32 rad: with the reach of corners
    /// below 2^112.
    pub(crate) fn new(form: &Form<'_>, leg: &Leg) -> Option<Self> {
        let turns = leg.spin.unsigned_abs();
        if turns > ROTATION || leg.way.iter().any(|way| way.unsigned_abs() > WAY) || leg.arm(0) != [0; 2] {
            return None;
        }
        let mut placed = [PlacedForm::NONE; 2];
        placed[0].set(form, leg, 0);
        placed[1].set(form, leg, END);
        // Corners leave the lines from their starts to their ends by at most r·φ²/8.
        let angle = ((((turns >> 32) + 1) * TAU) >> 32) + 1;
        let height = ((placed[0].reach.unsigned_abs() as u128 * angle * angle) >> 67) as i64 + 1;
        let margin = form.radius + height + GROWTH;
        let way = leg.way.map(|way| way as i64);
        let starts = placed[0].corners().iter().copied();
        let stops = placed[1].corners().iter().map(|&[x, y]| [x + way[0], y + way[1]]);
        let points = || starts.clone().chain(stops.clone());
        let mut hull = Self { centre: placed[0].centre, ends: [[0; 2]; 2], count: 0, sides: [([0; 2], 0); NORMALS] };
        for axis in 0..2 {
            let low = points().map(|point| point[axis]).min().unwrap_or(0) - margin;
            let high = points().map(|point| point[axis]).max().unwrap_or(0) + margin;
            hull.ends[0][axis] = hull.centre[axis].saturating_add(low);
            hull.ends[1][axis] = hull.centre[axis].saturating_add(high);
        }
        for (side, &normal) in hull.sides.iter_mut().zip(placed[0].normals()) {
            let highest = points().map(|point| along(normal, point.map(i128::from))).max().unwrap_or(0);
            *side = (normal, highest + i128::from(margin + (margin >> 28)));
            hull.count += 1;
        }
        Some(hull)
    }

    /// Returns true if a body on a path of one piece, with points within `reach` of its centre, may come into the region.
    pub(crate) fn is_met(&self, leg: &Leg, reach: i64) -> bool {
        let (low, high) = super::path::ends(from_ref(leg));
        let [hull_low, hull_high] = self.ends;
        if (0..2).any(|k| low[k].saturating_sub(reach) > hull_high[k] || high[k].saturating_add(reach) < hull_low[k]) {
            return false;
        }
        let start = leg.centre(0);
        let offset = [0, 1].map(|k| i128::from(start[k]) - i128::from(self.centre[k]));
        let end = [0, 1].map(|k| offset[k] + leg.way[k]);
        let reach = i128::from(reach) + i128::from(reach >> 28) + 2;
        self.sides[..self.count]
            .iter()
            .all(|&(normal, highest)| along(normal, offset).min(along(normal, end)) - reach <= highest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fx;
    use crate::scalar::Turn;
    use crate::shape::Shape;

    /// A long bar around its middle, which turns by up to a sixteenth of a turn, and points on it.
    #[test]
    fn points_of_a_turning_bar_are_met_at_all_moments_and_points_beside_it_are_not() {
        let shape = Shape::rectangle(40, 1).expect("a bar");
        let outline = shape.outlines().first().expect("an outline");
        let form = Form::new(outline, fx!(1), false);
        for spin in [0, 1 << 50, 1 << 60, -(1 << 60)] {
            let leg = Leg::new([3 << 32, -5 << 32], [1 << 31, -1 << 30], Turn::from_bits(7 << 58), spin);
            let hull = Hull::new(&form, &leg).expect("it turns by little");
            for part in 0..=16 {
                let at = END / 16 * part;
                let mut placed = PlacedForm::NONE;
                placed.set(&form, &leg, at);
                for corner in placed.corners() {
                    let point = [0, 1].map(|k| placed.centre[k] + corner[k]);
                    let still = Leg::new(point, [0; 2], Turn::default(), 0);
                    assert!(hull.is_met(&still, 0), "{spin} {part} {corner:?}");
                }
            }
            // Fifteen metres across from the middle: the ends of the bar come to eight.
            let mut placed = PlacedForm::NONE;
            placed.set(&form, &leg, 0);
            let long_side = placed
                .normals()
                .iter()
                .copied()
                .find(|&normal| along(normal, placed.corners()[0].map(i128::from)) < 1 << 32);
            let normal = long_side.expect("a long side");
            let beside = [0, 1].map(|k| placed.centre[k] + 60 * i64::from(normal[k]));
            assert!(!hull.is_met(&Leg::new(beside, [0; 2], Turn::default(), 0), 1 << 32), "{spin}");
        }
        assert!(Hull::new(&form, &Leg::new([0; 2], [0; 2], Turn::default(), (1 << 60) + 1)).is_none());
    }
}
