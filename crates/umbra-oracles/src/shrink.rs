//! Making a failing run small.

use std::convert::Infallible;

use super::game::{Commands, Course, Game, Played, Subject};
use super::trial::{Trial, record};
use super::{Oracle, Script, Verdict, Violation};
use umbra_physics::{ColliderDef, CommandMap, Fx, FxFactor, Locks, Shape};

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
    let subject = Played(game);
    let mut violation = None;
    let (course, tries) = smallest(&subject, course, tries, &mut |course| {
        violation = Some(*Trial::new(oracle, &subject, course).judge().err()?);
        violation.as_ref().map(|violation| violation.tick)
    })?;
    Some(Counterexample { violation: violation?, replay: record(&subject, &course), course, tries })
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

    /// Makes a script that an oracle objects to as small as it can, as [`shrink`] does, and the values in its commands as
    /// simple as it can, and says what is wrong with it then.
    #[must_use]
    pub fn shrunk(&self, oracle: Oracle, tries: u32) -> Option<(Self, Violation)> {
        let mut violation = None;
        let script = self.shrunk_by(tries, |script| {
            violation = Some(*script.judge(oracle).err()?);
            violation.as_ref().map(|violation| violation.tick)
        })?;
        Some((script, violation?))
    }

    /// Makes a script that fails a check as small and simple as it can, with at most so many checks; `None` if it does not fail.
    ///
    /// The check returns the tick at which a script fails, or any later tick if it does not know; `None` if it does not fail.
    /// Of what is left, no command can be left out, nor ticks, unless the tries were used up. Numbers in commands become zero,
    /// whole or multiples of an eighth where the script still fails.
    ///
    /// ```
    /// use umbra_oracles::Script;
    /// use umbra_physics::{BodyDef, Command, World, WorldDef, fx, vec2};
    ///
    /// let add = |x| Command::AddBody(BodyDef { position: vec2(x, fx!(0.7)), ..BodyDef::dynamic() });
    /// let script = Script { world: WorldDef::default(), commands: vec![(0, add(fx!(3.3))), (4, add(fx!(7.9)))], ticks: 9 };
    /// let is_far = |world: &World| world.bodies().any(|body| body.position().x > fx!(5));
    /// let least = script.shrunk_by(1_000, |script| script.run().is_ok_and(|end| is_far(&end)).then_some(u64::MAX)).unwrap();
    /// assert!(matches!(&least.commands[..], [(0, Command::AddBody(def))] if def.position == vec2(7, 0)), "{least:?}");
    /// assert_eq!(least.ticks, 1);
    /// ```
    #[must_use]
    pub fn shrunk_by(&self, tries: u32, mut fails: impl FnMut(&Self) -> Option<u64>) -> Option<Self> {
        let commands = Commands(self.world);
        let (mut script, mut used) = (self.clone(), 0);
        loop {
            let before = Course { inputs: script.commands.clone(), ticks: script.ticks };
            let smaller = smallest(&commands, &before, tries - used, &mut |course| fails(&commands.script(course)));
            let Some((course, took)) = smaller else { return (used > 0).then_some(script) };
            script = commands.script(&course);
            used += took;
            let mut is_as_bad = |script: &Self| {
                let may_try = used < tries;
                used += u32::from(may_try);
                may_try && fails(script).is_some()
            };
            for place in 0..script.commands.len() {
                simplify(&mut script, place, &mut is_as_bad);
            }
            // Simpler values may let go of commands and ticks that were needed before.
            if (&script.commands, script.ticks) == (&before.inputs, before.ticks) {
                return Some(script);
            }
        }
    }
}

/// Makes the values of a command simple, one at a time, where the script still fails.
fn simplify(script: &mut Script, place: usize, fails: &mut impl FnMut(&Script) -> bool) {
    let mut at = 0;
    loop {
        let mut count = 0;
        // Short of one, zero and the whole number are the same, and what is no number has one simpler form.
        let mut tried = None;
        for form in [Form::Zero, Form::Whole, Form::Eighths] {
            let mut simpler = Simpler { at, form, count: 0 };
            let Ok(command) = script.commands[place].1.clone().map(&mut simpler);
            count = simpler.count;
            if command == script.commands[place].1 || tried.as_ref() == Some(&command) {
                continue;
            }
            let before = core::mem::replace(&mut script.commands[place].1, command);
            if fails(script) {
                break;
            }
            tried = Some(core::mem::replace(&mut script.commands[place].1, before));
        }
        at += 1;
        if at >= count {
            return;
        }
    }
}

/// How a number becomes simpler.
#[derive(Clone, Copy)]
enum Form {
    /// Zero, or absent.
    Zero,
    /// The whole number next to it towards zero.
    Whole,
    /// The multiple of an eighth next to it towards zero.
    Eighths,
}

/// Makes one value of a command simpler, the one at this place in the order in which they are mapped.
struct Simpler {
    at: usize,
    form: Form,
    /// The number of values so far.
    count: usize,
}

impl Simpler {
    fn is_it(&mut self) -> bool {
        self.count += 1;
        self.count == self.at + 1
    }
}

impl CommandMap<Fx> for Simpler {
    type Error = Infallible;

    fn scalar(&mut self, value: Fx) -> Result<Fx, Infallible> {
        let unit = match self.form {
            Form::Zero => return Ok(if self.is_it() { Fx::ZERO } else { value }),
            Form::Whole => Fx::ONE.to_bits(),
            Form::Eighths => Fx::ONE.to_bits() / 8,
        };
        Ok(if self.is_it() { Fx::from_bits(value.to_bits() / unit * unit) } else { value })
    }

    fn factor(&mut self, value: FxFactor) -> Result<FxFactor, Infallible> {
        Ok(value)
    }

    fn shape(&mut self, shape: Shape) -> Result<Shape, Infallible> {
        Ok(shape)
    }

    /// Without one of them.
    fn colliders(&mut self, defs: Vec<ColliderDef>) -> Result<Vec<ColliderDef>, Infallible> {
        let kept: Vec<ColliderDef> = defs.into_iter().filter(|_| !self.is_it()).collect();
        kept.into_iter().map(|def| self.collider_def(def)).collect()
    }

    fn locks(&mut self, locks: Locks) -> Result<Locks, Infallible> {
        Ok(if self.is_it() { Locks::NONE } else { locks })
    }
}

/// Makes a course as small as it can while `fails` returns a tick, and says after how many tries.
fn smallest<S: Subject>(
    subject: &S,
    course: &Course<S::Input>,
    tries: u32,
    fails: &mut dyn FnMut(&Course<S::Input>) -> Option<u64>,
) -> Option<(Course<S::Input>, u32)> {
    let created = subject.made(course);
    let mut search = Search {
        subject,
        course,
        made: created,
        fails,
        order: Vec::new(),
        ticks: 0,
        found: None,
        tries: 0,
        most: tries,
    };
    search.attempt(course.order(), course.ticks);
    while search.drop_inputs() | search.drop_ticks() {}
    Some((search.found?, search.tries))
}

/// A run that is being made small.
struct Search<'a, S: Subject> {
    subject: &'a S,
    /// The run as it was given.
    course: &'a Course<S::Input>,
    made: S::Made,
    /// Returns the tick at which a run fails; `None` if it does not.
    fails: &'a mut dyn FnMut(&Course<S::Input>) -> Option<u64>,
    /// The inputs that are left, by their places, at their ticks.
    order: Vec<(u64, usize)>,
    ticks: u64,
    found: Option<Course<S::Input>>,
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
            let course = self.subject.arranged(self.course, &self.made, order.clone(), ticks);
            let Some(tick) = (self.fails)(&course) else { break };
            let end = tick.saturating_add(1);
            (self.order, self.ticks, is_found) = (order.clone(), ticks, true);
            self.found = Some(course);
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
