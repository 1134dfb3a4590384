//! Playing a game with inputs at random.

use alloc::vec::Vec;

use super::game::{Course, Game, Played};
use super::trial::record;
use super::{Counterexample, Oracle, Verdict, shrink};
use crate::math::Random;

/// How a game is played to find something.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fuzz<'a> {
    /// The seed of the first run; each next one has the next.
    pub seed: u64,
    /// How many runs there are at most.
    pub runs: u32,
    /// How many ticks a run makes.
    pub ticks: u64,
    /// Who judges.
    pub oracles: &'a [Oracle],
    /// How many runs may be judged to make a failing one small.
    pub tries: u32,
}

impl Default for Fuzz<'_> {
    /// A hundred runs of two seconds at 60 ticks a second, judged by all.
    fn default() -> Self {
        Self { seed: 0, runs: 100, ticks: 120, oracles: &Oracle::ALL, tries: 2_000 }
    }
}

/// What came of playing.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Campaign<I> {
    /// How many runs were played.
    pub runs: u32,
    /// In how many of them each oracle had something to judge, and nothing against it. One with none has shown nothing.
    pub held: Vec<(Oracle, u32)>,
    /// The seed of the run in which something was found: [`Fuzz::seed`] with it, and one run, find it again.
    pub seed: Option<u64>,
    /// What was found, made small. A run in which nothing is wrong when it is judged again is there as it was played, with 0
    /// tries: what was wrong with it comes and goes, as a race does.
    pub found: Option<Counterexample<I>>,
}

/// Plays a game with inputs at random, until an oracle objects; `inputs` are those of a tick. The same seed finds the same.
///
/// A game that panics does so here as well: a panic is no verdict.
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
