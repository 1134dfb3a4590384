//! The places of the bodies of a run, and the distance between two runs.

use core::f64::consts::TAU;

use umbra_physics::scalar::ToF64;
use umbra_physics::{BodyKind, Scalar};
use umbra_scene::{Scene, SceneRun};

/// The largest number of places that are kept. In longer runs only every so many ticks count.
const PLACES: u64 = 2_000_000;

/// Every how many ticks the bodies are looked at.
#[derive(Clone, Copy)]
pub(super) struct Stride(u64);

impl Stride {
    pub(super) fn of(scene: &Scene, ticks: u64) -> Self {
        Self((scene.bodies.len() as u64).saturating_mul(ticks).div_ceil(PLACES).max(1))
    }

    pub(super) const fn is_due(self, tick: u64) -> bool {
        tick % self.0 == 0
    }
}

/// (x, y, angle) of the bodies that move or may, by their index in the scene.
type Places = Vec<Option<[f64; 3]>>;

/// The places of bodies as time goes on.
#[derive(Default)]
pub(super) struct Way(Vec<(f64, Places)>);

/// The distance between two runs at a moment: the largest of a body, m, and of an angle, rad.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Gap {
    pub(super) time: f64,
    pub(super) position: f64,
    pub(super) angle: f64,
}

impl Way {
    pub(super) fn record<S: Scalar<Accumulator: ToF64, Angle: ToF64>>(&mut self, run: &SceneRun<'_, S>) {
        let elapsed = run.world().elapsed();
        let mut places = Vec::new();
        for body in run.world().bodies().filter(|body| body.kind() != BodyKind::Static) {
            let Some(index) = run.index(body.id()) else { continue };
            let at = body.position_exact().map(ToF64::to_f64);
            if places.len() <= index {
                places.resize(index + 1, None);
            }
            places[index] = Some([at.x, at.y, body.angle_exact().to_f64()]);
        }
        self.0.push((elapsed.num as f64 / elapsed.den as f64, places));
    }

    /// The time that it takes, s.
    pub(super) fn seconds(&self) -> f64 {
        self.0.last().map_or(0.0, |(time, _)| *time)
    }

    /// From a way with the same moments. A body that is in one of them only is in no gap.
    pub(super) fn gaps(&self, rhs: &Self) -> Vec<Gap> {
        let gap = |((time, a), (_, b)): (&(f64, Places), &(f64, Places))| {
            let mut gap = Gap { time: *time, ..Gap::default() };
            for ([x, y, angle], [to_x, to_y, to_angle]) in a.iter().zip(b).filter_map(|(a, b)| (*a).zip(*b)) {
                let turned = (angle - to_angle).abs();
                gap.position = gap.position.max((x - to_x).hypot(y - to_y));
                gap.angle = gap.angle.max(turned.min(TAU - turned));
            }
            gap
        };
        self.0.iter().zip(&rhs.0).map(gap).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gap_is_that_of_the_farthest_body_and_angles_close_round_the_turn() {
        let a = Way(vec![(0.5, vec![Some([0.0, 0.0, 0.1]), Some([1.0, 1.0, 1.0]), Some([9.0, 0.0, 0.0])])]);
        let b = Way(vec![(0.5, vec![Some([3.0, 4.0, 6.2]), Some([1.0, 2.0, 1.0]), None])]);
        let [gap] = a.gaps(&b)[..] else { panic!("one moment") };
        assert_eq!((gap.time, gap.position), (0.5, 5.0));
        assert!((gap.angle - (0.1 + TAU - 6.2)).abs() < 1e-15, "{gap:?}");
    }
}
