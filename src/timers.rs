//! Timers and counters of steps, behind the feature `timers`; without it nothing of this is compiled.
//!
//! What is timed has a field `timers` of its own, which the step adds to those of its workspace. No result depends on them.

#[cfg(feature = "timers")]
use core::ops::AddAssign;
#[cfg(feature = "timers")]
use core::time::Duration;

/// Runs an expression, and adds the time it takes to a part of the timers of `$owner`.
macro_rules! timed {
    ($owner:expr, $part:ident, $run:expr) => {{
        #[cfg(feature = "timers")]
        let start = crate::timers::now();
        let result = $run;
        #[cfg(feature = "timers")]
        {
            $owner.timers.times.$part += start.elapsed();
        }
        result
    }};
}

/// Adds a number to a counter of the timers of `$owner`.
macro_rules! counted {
    ($owner:expr, $counter:ident, $number:expr) => {
        #[cfg(feature = "timers")]
        {
            $owner.timers.counts.$counter += $number as u64;
        }
    };
}

pub(crate) use {counted, timed};

#[cfg(feature = "timers")]
pub(crate) fn now() -> std::time::Instant {
    std::time::Instant::now()
}

/// Defines a struct of sums over steps, with their names.
#[cfg(feature = "timers")]
macro_rules! sums {
    ($(#[$about:meta])* $name:ident: $value:ty { $($(#[$meaning:meta])* $field:ident,)* }) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        #[non_exhaustive]
        pub struct $name {
            $($(#[$meaning])* pub $field: $value,)*
        }

        impl $name {
            /// All of them with their names, in the order of a step.
            pub fn each(&self) -> impl Iterator<Item = (&'static str, $value)> {
                [$((stringify!($field), self.$field)),*].into_iter()
            }
        }

        impl AddAssign for $name {
            fn add_assign(&mut self, terms: Self) {
                $(self.$field += terms.$field;)*
            }
        }
    };
}

/// The time that the parts of all steps so far took, and counts of what they did.
///
/// ```
/// use umbra_physics::{BodyDef, StepCounts, StepTimes, Timers, World, WorldDef};
///
/// let mut world = World::new(WorldDef::default())?;
/// world.add_body(BodyDef::dynamic())?;
/// (0..10).for_each(|_| _ = world.step());
/// let Timers { times, counts, .. } = world.timers();
/// for (part, time) in times.each().filter(|(_, time)| !time.is_zero()) {
///     println!("{part}: {time:?} of {:?}", times.sum());
/// }
/// let StepTimes { free, passes, .. } = times;
/// assert!(!free.is_zero() && passes.is_zero(), "a body that touches nothing");
/// let StepCounts { steps, contacts, .. } = counts;
/// assert_eq!([steps, contacts], [10, 0]);
/// assert_eq!(counts.each().next(), Some(("steps", 10)));
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[cfg(feature = "timers")]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Timers {
    /// The time of each part.
    pub times: StepTimes,
    /// The counts.
    pub counts: StepCounts,
}

#[cfg(feature = "timers")]
impl AddAssign for Timers {
    fn add_assign(&mut self, terms: Self) {
        self.times += terms.times;
        self.counts += terms.counts;
    }
}

#[cfg(feature = "timers")]
sums! {
    /// The time that each part of all steps so far took, wall clock. No part contains another one: together they are the time of the
    /// steps, but for what lies between two parts.
    StepTimes: Duration {
        /// Finding the coupled bodies and those with colliders, dropping the caches of bodies that changed, and turning applied forces
        /// into accelerations.
        survey,
        /// Kinematic bodies on their way to a target.
        targets,
        /// All stages of free bodies, on which no field can act.
        free,
        /// The fields stage of coupled bodies: evaluating the fields of position, and the fields of velocity that it needs.
        fields,
        /// Damping and drag of coupled bodies.
        damp,
        /// Gravity, forces and fields to velocities of coupled bodies; evaluates the fields of velocity for a closing half kick.
        kick,
        /// Velocities to positions of coupled bodies.
        drift,
        /// Pairs of colliders: flights of bodies, trees of colliders, pairs of boxes, rules that leave out pairs.
        pairs,
        /// From pairs to contacts: manifolds, materials, impulses of the step before.
        manifolds,
        /// Waking sleeping bodies that are touched; their flight counts above.
        waking,
        /// Preparing the solver: islands, rows of bodies, groups of contacts with their matrices.
        setup,
        /// Impacts at their moments. This time, the passes and `apply` are sums over threads, where these share islands out.
        impacts,
        /// The passes over the contacts in all sub-steps, and the motion of bodies between them.
        passes,
        /// From impulses to changes of bodies.
        apply,
        /// The search for contacts on the ways of bodies that impulses deflected.
        deflected,
        /// Solving the islands of such contacts again, all parts of the solver together.
        again,
        /// The ends of the paths of fast bodies.
        sweeps,
        /// Backups of coupled bodies, and for all bodies quarantine and sleep.
        finish,
        /// The list of contacts that the next step starts from; events of contacts and of sensors.
        events,
    }
}

#[cfg(feature = "timers")]
impl StepTimes {
    /// The time of all parts.
    #[must_use]
    pub fn sum(&self) -> Duration {
        self.each().map(|(_, time)| time).sum()
    }
}

#[cfg(feature = "timers")]
sums! {
    /// Counts of all steps so far. A step that wakes sleeping bodies looks for pairs and contacts again, and they count again.
    StepCounts: u64 {
        /// Steps, including steps that undo one.
        steps,
        /// Pairs of outlines of colliders whose boxes meet and that no rule leaves out.
        pairs,
        /// Contacts that are solved, and those that were added for bodies that impulses deflected.
        contacts,
        /// Points of these contacts, one or two each.
        points,
        /// Islands that are solved, as often as they are.
        islands,
        /// Islands that are solved again for contacts of deflected bodies, as often as they are.
        islands_again,
        /// Contacts with impacts, as often as they are solved.
        impacts,
        /// Impulses and velocities that the passes cut off at the limits of the solver.
        cut,
        /// Paths of fast bodies that end before the end of the step.
        stops,
    }
}

#[cfg(feature = "timers")]
impl Timers {
    /// Adds the timers of a solver, whose whole time was added to its preparation.
    pub(crate) fn add_solver(&mut self, solver: Self) {
        self.times.setup = self.times.setup.saturating_sub(solver.times.sum());
        *self += solver;
    }

    /// Adds the counts of a solver that solved islands again; its time has been added.
    pub(crate) fn add_again(&mut self, solver: Self) {
        self.counts += solver.counts;
        self.counts.islands_again += solver.counts.islands;
    }
}
