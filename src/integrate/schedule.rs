//! The lists of stages that the bodies of a step go through: those of coupled bodies, and those of free ones. The list of free bodies is
//! shorter: no field acts on them, and where the bodies of a block share one row of factors, damp, kick, drift, kick and damp are one loop.

use super::{Integrator, Stage, StageKind, stage};

/// A stage of the pass that takes a block of free bodies through a whole step. No field acts on them, so nothing between two
/// stages needs other bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FreeStage {
    /// A stage by itself.
    Single(Stage),
    /// Damp, kick, drift, kick, damp in one loop: the drift over the span `whole`, the others over the span `half`.
    FusedKickDriftKick { half: usize, whole: usize },
}

/// The stages that [`FreeStage::FusedKickDriftKick`] stands for, for blocks whose bodies cannot take them in one loop.
pub(crate) const fn split_fused(half: usize, whole: usize) -> [Stage; 5] {
    use StageKind::{Damp, Drift, Kick};
    [stage(Damp, half), stage(Kick, half), stage(Drift, whole), stage(Kick, half), stage(Damp, half)]
}

/// Both lists of the free flight of a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Schedule {
    pub(crate) coupled: &'static [Stage],
    pub(crate) free: &'static [FreeStage],
}

impl Integrator {
    /// The lists of a step.
    pub(crate) const fn schedule(self) -> Schedule {
        use FreeStage::{FusedKickDriftKick, Single};
        use StageKind::{Damp, Drift, Kick};
        const OUTER: FreeStage = FusedKickDriftKick { half: 1, whole: 0 };
        const INNER: FreeStage = FusedKickDriftKick { half: 3, whole: 2 };
        const EXPLICIT: [FreeStage; 3] = [Single(stage(Drift, 0)), Single(stage(Kick, 0)), Single(stage(Damp, 0))];
        const SYMPLECTIC: [FreeStage; 3] = [Single(stage(Kick, 0)), Single(stage(Drift, 0)), Single(stage(Damp, 0))];
        let free: &[FreeStage] = match self {
            Self::ExplicitEuler => &EXPLICIT,
            Self::SymplecticEuler => &SYMPLECTIC,
            Self::VelocityVerlet => &[OUTER],
            // All bodies are coupled: its last acceleration is the sum of all that acts on a body.
            Self::PublishedVerlet => &[],
            Self::Yoshida4 => &[OUTER, INNER, OUTER],
        };
        Schedule { coupled: self.flight(), free }
    }

    /// The lists that undo a step, each stage over its span the other way in time; `None` as for
    /// [`inverse`](Self::inverse).
    pub(crate) const fn inverse_schedule(self) -> Option<Schedule> {
        use FreeStage::Single;
        use StageKind::{Drift, Kick};
        const IN_TURN: &[FreeStage] = &[Single(stage(Drift, 0)), Single(stage(Kick, 0))];
        let free = match self {
            Self::SymplecticEuler => IN_TURN,
            // Their lists read the same from either end.
            _ => self.schedule().free,
        };
        match self.inverse() {
            Some(coupled) => Some(Schedule { coupled, free }),
            None => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use alloc::vec::Vec;

    use super::*;

    /// Kinds and spans of the stages that move a body by itself.
    fn by_itself<'a>(stages: impl IntoIterator<Item = &'a Stage>) -> Vec<(StageKind, usize)> {
        let acts = |stage: &&Stage| !matches!(stage.kind, StageKind::Fields | StageKind::Clear);
        stages.into_iter().filter(acts).map(|stage| (stage.kind, stage.span)).collect()
    }

    #[test]
    fn free_bodies_go_through_the_stages_of_coupled_ones() {
        for integrator in Integrator::ALL.into_iter().filter(|integrator| *integrator != Integrator::PublishedVerlet) {
            for Schedule { coupled, free } in
                [Some(integrator.schedule()), integrator.inverse_schedule()].into_iter().flatten()
            {
                let split = free.iter().flat_map(|stage| match *stage {
                    FreeStage::Single(stage) => Vec::from([stage]),
                    FreeStage::FusedKickDriftKick { half, whole } => Vec::from(split_fused(half, whole)),
                });
                let split: Vec<Stage> = split.collect();
                assert_eq!(by_itself(&split), by_itself(coupled), "{integrator:?}");
            }
        }
    }
}
