//! Shrinking a failing run.

use super::game::{Commands, Course, Game, Played, Subject};
use super::trial::{Trial, record};
use super::{Oracle, Script, Verdict, Violation};

/// A failing run, shrunk.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Counterexample<I> {
    /// The inputs of the run.
    pub course: Course<I>,
    /// The failed check.
    pub violation: Violation,
    /// The run as a replay: the bytes of a file that `umbra view` opens, and `umbra verify` unless the game goes past its
    /// driver.
    pub replay: Vec<u8>,
    /// The number of runs that were checked to shrink it; 0 for a run that is as it was played.
    pub tries: u32,
}

/// Makes a run of a game that an oracle objects to as small as it can, judging at most so many runs: none if it does not
/// object to it.
///
/// Of what is left, no input can be left out, nor ticks between inputs, unless the tries were used up. The same run leads to
/// the same counterexample.
///
/// *Source* delta debugging: Zeller and Hildebrandt, IEEE Transactions on Software Engineering 28 (2002), by complements.
pub fn shrink<G: Game>(
    game: &G,
    course: &Course<G::Input>,
    oracle: Oracle,
    tries: u32,
) -> Option<Counterexample<G::Input>> {
    smallest(&Played(game), course, oracle, tries)
}

impl Script {
    /// Judges the run.
    ///
    /// # Errors
    /// The first [`Violation`].
    pub fn judge(&self, oracle: Oracle) -> Result<Verdict, Box<Violation>> {
        let course = Course { inputs: self.commands.clone(), ticks: self.ticks };
        Trial::new(oracle, &Commands(self.world), &course).judge()
    }

    /// Makes a script that an oracle objects to as small as it can, as [`shrink`] does, and says what is wrong with it then.
    #[must_use]
    pub fn shrunk(&self, oracle: Oracle, tries: u32) -> Option<(Self, Violation)> {
        let course = Course { inputs: self.commands.clone(), ticks: self.ticks };
        let commands = Commands(self.world);
        let found = smallest(&commands, &course, oracle, tries)?;
        Some((commands.script(&found.course), found.violation))
    }
}

fn smallest<S: Subject>(
    subject: &S,
    course: &Course<S::Input>,
    oracle: Oracle,
    tries: u32,
) -> Option<Counterexample<S::Input>> {
    let mut search =
        Search { subject, course, oracle, order: Vec::new(), ticks: 0, found: None, tries: 0, most: tries };
    search.attempt(course.order(), course.ticks);
    while search.drop_inputs() | search.drop_ticks() {}
    let (violation, course) = search.found?;
    Some(Counterexample { violation, replay: record(subject, &course), course, tries: search.tries })
}

/// A run that is being made small.
struct Search<'a, S: Subject> {
    subject: &'a S,
    /// The run as it was given.
    course: &'a Course<S::Input>,
    oracle: Oracle,
    /// The inputs that are left, by their places, at their ticks.
    order: Vec<(u64, usize)>,
    ticks: u64,
    found: Option<(Violation, Course<S::Input>)>,
    tries: u32,
    most: u32,
}

impl<S: Subject> Search<'_, S> {
    /// Returns whether the tries are used up.
    const fn is_spent(&self) -> bool {
        self.tries >= self.most
    }

    /// Takes these inputs instead, if the oracle objects to them as well; of the ticks, those up to where it does.
    fn attempt(&mut self, mut order: Vec<(u64, usize)>, mut ticks: u64) -> bool {
        let mut is_found = false;
        while !self.is_spent() {
            self.tries += 1;
            order.retain(|(tick, _)| *tick < ticks);
            let course = self.subject.arranged(self.course, order.clone(), ticks);
            let Err(violation) = Trial::new(self.oracle, self.subject, &course).judge() else { break };
            let end = violation.tick + 1;
            (self.order, self.ticks, is_found) = (order.clone(), ticks, true);
            self.found = Some((*violation, course));
            if end >= ticks {
                break;
            }
            ticks = end;
        }
        is_found
    }

    /// Leaves out inputs, many at once and then fewer; whether any went.
    fn drop_inputs(&mut self) -> bool {
        let mut is_smaller = false;
        let mut size = self.order.len();
        while size > 0 && !self.is_spent() {
            let mut start = 0;
            while start < self.order.len() && !self.is_spent() {
                let mut order = self.order.clone();
                order.drain(start..order.len().min(start + size));
                if self.attempt(order, self.ticks) {
                    is_smaller = true;
                } else {
                    start += size;
                }
            }
            size /= 2;
        }
        is_smaller
    }

    /// Leaves out ticks, many at once and then fewer: inputs of theirs go to the tick after them. Whether any went.
    fn drop_ticks(&mut self) -> bool {
        let mut is_smaller = false;
        let mut size = self.ticks / 2;
        while size > 0 && !self.is_spent() {
            let mut start = 0;
            while start + size < self.ticks && !self.is_spent() {
                let earlier = |tick: u64| if tick < start { tick } else { start.max(tick.saturating_sub(size)) };
                let order = self.order.iter().map(|(tick, place)| (earlier(*tick), *place)).collect();
                if self.attempt(order, self.ticks - size) {
                    is_smaller = true;
                } else {
                    start += size;
                }
            }
            size /= 2;
        }
        is_smaller
    }
}
