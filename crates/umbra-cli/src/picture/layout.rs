//! The part of the plane that is shown, and its size.

use super::clip::Window;
use super::outline::Outline;
use super::{Picture, Point};

/// The longer and the shorter side of the plot, px.
const LONG: f64 = 760.0;
const SHORT: f64 = 300.0;
/// The shorter side where the scene says what is shown, px.
const SHORTEST: f64 = 160.0;

/// The part of the plane that is shown, m, and the size of the plot in px; both axes have the same scale.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    pub(super) least: Point,
    pub(super) most: Point,
    pub(super) width: f64,
    pub(super) height: f64,
}

impl Layout {
    pub(super) fn of(picture: &Picture<'_>) -> Self {
        let [mut min, mut max] = picture.view.unwrap_or_else(|| around(picture));
        let (width, height) = (max.0 - min.0, max.1 - min.1);
        let scale = LONG / width.max(height);
        let mut size = (width * scale, height * scale);
        let short = if picture.view.is_some() { SHORTEST } else { SHORT };
        // A thin picture is widened on both sides of what is in it.
        let widen = |size: &mut f64, min: &mut f64, max: &mut f64| {
            if *size < short {
                let more = (short - *size) / scale / 2.0;
                (*min, *max, *size) = (*min - more, *max + more, short);
            }
        };
        widen(&mut size.0, &mut min.0, &mut max.0);
        widen(&mut size.1, &mut min.1, &mut max.1);
        Self { least: min, most: max, width: size.0.round(), height: size.1.round() }
    }

    /// px per m.
    pub(super) fn scale(&self) -> f64 {
        self.width / (self.most.0 - self.least.0)
    }

    /// The length of the longest arrow of an impulse, m, where the caller gives no scale.
    pub(super) fn longest_impulse(&self) -> f64 {
        self.width.max(self.height) / 10.0 / self.scale()
    }

    pub(super) fn window(&self) -> Window {
        [self.least, self.most]
    }

    pub(super) fn holds(&self, point: Point) -> bool {
        let (x, y) = point;
        x >= self.least.0 && x <= self.most.0 && y >= self.least.1 && y <= self.most.1
    }
}

/// The rectangle around all that is drawn, with a margin.
fn around(picture: &Picture<'_>) -> [Point; 2] {
    let ways = picture.ways.iter().flat_map(|way| way.pieces.iter().flatten());
    let outlines = picture.bodies.iter().map(|body| &body.outline).chain(picture.start).chain(picture.exposures);
    let outlines = outlines.flat_map(Outline::points);
    let rest = picture.bodies.iter().map(|body| &body.at).chain(&picture.scenery.centres);
    // The ends of joints, and not their axes: limits may be far out.
    let springs = picture.scenery.springs.iter().flatten().chain(&picture.scenery.joint_ends);
    let mut bounds: Option<[Point; 2]> = None;
    for &(x, y) in ways.chain(outlines).chain(rest).chain(springs) {
        let [min, max] = bounds.get_or_insert([(x, y); 2]);
        *min = (min.0.min(x), min.1.min(y));
        *max = (max.0.max(x), max.1.max(y));
    }
    let [min, max] = bounds.unwrap_or([(-1.0, -1.0), (1.0, 1.0)]);
    let margin = 0.06 * (max.0 - min.0).max(max.1 - min.1).max(1e-3);
    [(min.0 - margin, min.1 - margin), (max.0 + margin, max.1 + margin)]
}
