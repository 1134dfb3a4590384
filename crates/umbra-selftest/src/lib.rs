//! Runs the built-in scenes of `umbra-physics` in every way that must change no bit: on one thread and on many, with wide vectors
//! and without. The programs `umbra-selftest` and `umbra selftest` print the results.
#![forbid(unsafe_code)]
#![warn(missing_docs)]

mod stream;

use std::fmt;
use std::time::{Duration, Instant};

use umbra_physics::PHYSICS_VERSION;
use umbra_physics::scalar::internals::VectorSet;
use umbra_physics::selftest::{Failure, Golden, Outcome, Scene, Total, golden, scenes};

pub use stream::Stream;

/// A way to run the corpus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Way {
    /// The number of threads; `None` without the feature `parallel`.
    threads: Option<usize>,
    vectors: VectorSet,
}

impl fmt::Display for Way {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.threads {
            None => f.write_str("one thread")?,
            Some(1) => f.write_str("a pool of 1 thread")?,
            Some(threads) => write!(f, "a pool of {threads} threads")?,
        }
        match self.vectors {
            VectorSet::Portable => f.write_str(", no wide vectors"),
            VectorSet::Neon => f.write_str(", NEON"),
            VectorSet::Simd128 => f.write_str(", SIMD128"),
            VectorSet::Avx2 => f.write_str(", AVX2"),
            VectorSet::Avx512 => f.write_str(", AVX-512"),
        }
    }
}

impl Way {
    /// All ways that this build has on this machine.
    pub fn all() -> Vec<Self> {
        // The widest first.
        let mut sets: Vec<VectorSet> = VectorSet::available().collect();
        sets.reverse();
        let threads: &[Option<usize>] = if cfg!(feature = "parallel") { &[Some(1), Some(2), Some(8)] } else { &[None] };
        threads.iter().flat_map(|&threads| sets.iter().map(move |&vectors| Self { threads, vectors })).collect()
    }

    /// Runs something in this way; the error says why there are no threads for it.
    fn with<T: Send>(self, run: impl FnOnce() -> T + Send) -> Result<T, String> {
        let _own = OwnVectors::allow(self.vectors);
        #[cfg(feature = "parallel")]
        if let Some(threads) = self.threads {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            return Ok(pool.map_err(|error| error.to_string())?.install(run));
        }
        Ok(run())
    }
}

/// Wide vectors as this library needs them; when it is dropped, they are what they were before. The switch is one for the whole
/// process, which may be a game.
struct OwnVectors(VectorSet);

impl OwnVectors {
    fn allow(widest: VectorSet) -> Self {
        let before = VectorSet::used();
        VectorSet::allow(widest);
        Self(before)
    }
}

impl Drop for OwnVectors {
    fn drop(&mut self) {
        VectorSet::allow(self.0);
    }
}

/// A disagreement found in a scene.
#[derive(Clone, Debug, PartialEq)]
pub enum Trouble {
    /// The scene failed.
    Failed {
        /// The way it was run in.
        way: Way,
        /// The failure.
        failure: Failure,
    },
    /// The scene gives another outcome in this way than in the first one.
    Ways {
        /// The way.
        way: Way,
        /// The outcome in the first way.
        first: Outcome,
        /// The outcome in this way.
        here: Outcome,
    },
    /// The outcome is not the golden one, which every machine gives.
    NotGolden {
        /// The golden outcome.
        golden: Outcome,
    },
    /// The list of golden outcomes does not have the scene, or is of another physics version.
    NoGolden,
    /// The threads for a way could not be started.
    Threads {
        /// The reason.
        what: String,
    },
}

impl fmt::Display for Trouble {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Failed { way, failure } => write!(f, "with {way}: {failure}"),
            Self::Ways { way, first, here } => {
                write!(f, "with {way} it gives {:016x}, before it gave {:016x}", here.digest, first.digest)
            }
            Self::NotGolden { golden } => write!(f, "expected {:016x} of {} ticks", golden.digest, golden.ticks),
            Self::NoGolden => {
                write!(f, "there is no golden digest of physics version {PHYSICS_VERSION} to compare with")
            }
            Self::Threads { what } => write!(f, "no threads: {what}"),
        }
    }
}

/// The results of a scene in all ways.
pub struct Checked {
    /// The scene.
    pub scene: &'static Scene,
    /// The outcome in the first way; `None` if the scene failed in it.
    pub outcome: Option<Outcome>,
    /// The disagreements; empty if all is well.
    pub troubles: Vec<Trouble>,
    /// The time that the first way took.
    pub time: Duration,
}

impl Checked {
    fn new(scene: &'static Scene, ways: &[Way]) -> Self {
        let mut checked = Self { scene, outcome: None, troubles: Vec::new(), time: Duration::ZERO };
        for (i, &way) in ways.iter().enumerate() {
            let started = Instant::now();
            match way.with(|| scene.run()) {
                Err(what) => checked.troubles.push(Trouble::Threads { what }),
                Ok(Err(failure)) => checked.troubles.push(Trouble::Failed { way, failure }),
                Ok(Ok(here)) => match checked.outcome {
                    Some(first) if first != here => checked.troubles.push(Trouble::Ways { way, first, here }),
                    None if i == 0 => checked.outcome = Some(here),
                    _ => {}
                },
            }
            if i == 0 {
                checked.time = started.elapsed();
            }
        }
        let golden = valid_golden().and_then(|golden| golden.scene(scene.name()));
        checked.troubles.extend(checked.outcome.and_then(|outcome| against(outcome, golden)));
        checked
    }
}

/// The list of golden outcomes, if it is of this physics version.
fn valid_golden() -> Option<Golden<'static>> {
    Some(golden()).filter(|golden| golden.physics_version() == Some(PHYSICS_VERSION))
}

fn against(outcome: Outcome, golden: Option<Outcome>) -> Option<Trouble> {
    match golden {
        None => Some(Trouble::NoGolden),
        Some(golden) if golden != outcome => Some(Trouble::NotGolden { golden }),
        Some(_) => None,
    }
}

/// The result of all scenes together.
pub struct Verdict {
    /// The outcome of all scenes as one; `None` if a scene failed.
    pub all: Option<Outcome>,
    /// True if there was no disagreement, and all together give the golden digest.
    pub agrees: bool,
}

/// Runs all scenes in these ways, and passes each to `show` when it is done.
pub fn check(ways: &[Way], mut show: impl FnMut(&Checked)) -> Verdict {
    let (mut outcomes, mut agrees) = (Vec::new(), true);
    for scene in scenes() {
        let checked = Checked::new(scene, ways);
        show(&checked);
        agrees &= checked.troubles.is_empty();
        outcomes.push(checked.outcome.map(|outcome| (scene.name(), outcome)));
    }
    let all = outcomes.into_iter().collect::<Option<Total>>().map(|total| total.outcome());
    let golden = valid_golden().and_then(|golden| golden.all());
    Verdict { all, agrees: agrees && all.is_some_and(|all| against(all, golden).is_none()) }
}
