//! Playing a game with random inputs.

use super::game::{Course, Game, Played};
use super::trial::record;
use super::{Counterexample, Oracle, Verdict, shrink};
use umbra_physics::Random;

/// Settings of [`fuzz`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fuzz<'a> {
    /// The seed of the first run; each next one has the next.
    pub seed: u64,
    /// The largest number of runs.
    pub runs: u32,
    /// The number of ticks of a run.
    pub ticks: u64,
    /// The oracles that check each run.
    pub oracles: &'a [Oracle],
    /// The largest number of runs that are checked to shrink a failing one.
    pub tries: u32,
}

impl Default for Fuzz<'_> {
    /// A hundred runs of two seconds at 60 ticks a second, judged by all.
    fn default() -> Self {
        Self { seed: 0, runs: 100, ticks: 120, oracles: &Oracle::ALL, tries: 2_000 }
    }
}

/// The result of [`fuzz`].
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Campaign<I> {
    /// The number of runs that were played.
    pub runs: u32,
    /// For each oracle the number of runs in which it had something to check and found nothing. A zero has shown nothing.
    pub held: Vec<(Oracle, u32)>,
    /// The seed of the failing run. With it as [`Fuzz::seed`], one run finds the fault again.
    pub seed: Option<u64>,
    /// The failing run, shrunk. If the check passes when the run is repeated, the run is here as it was played, with 0 tries: such a
    /// fault comes and goes, as a race does.
    pub found: Option<Counterexample<I>>,
}

/// Plays a game with random inputs until a check fails; `inputs` makes those of a tick. The same seed finds the same.
///
/// A panic of the game is passed on: it is no result of a check.
pub fn fuzz<G: Game>(
    game: &G,
    options: &Fuzz<'_>,
    mut inputs: impl FnMut(&mut Random, u64) -> Vec<G::Input>,
) -> Campaign<G::Input> {
    let held = options.oracles.iter().map(|oracle| (*oracle, 0)).collect();
    let mut campaign = Campaign { runs: 0, held, seed: None, found: None };
    for run in 0..options.runs {
        let seed = options.seed.wrapping_add(u64::from(run));
        let mut random = Random::seeded(seed);
        let mut course = Course { inputs: Vec::new(), ticks: options.ticks };
        for tick in 0..options.ticks {
            course.inputs.extend(inputs(&mut random, tick).into_iter().map(|input| (tick, input)));
        }
        campaign.runs += 1;
        for (oracle, held) in &mut campaign.held {
            match oracle.judge(game, &course) {
                Ok(Verdict::Held) => *held += 1,
                Ok(_) => {}
                Err(violation) => {
                    campaign.seed = Some(seed);
                    let small = shrink(game, &course, *oracle, options.tries.max(1));
                    let as_played = || {
                        let replay = record(&Played(game), &course);
                        Counterexample { course, violation: *violation, replay, tries: 0 }
                    };
                    campaign.found = Some(small.unwrap_or_else(as_played));
                    return campaign;
                }
            }
        }
    }
    campaign
}
