//! Timers for the parts of a step, behind the feature `timers`; without it nothing of this is compiled.

/// Runs an expression, and adds the time it takes to a part of the timers.
macro_rules! timed {
    ($workspace:expr, $part:ident, $run:expr) => {{
        #[cfg(feature = "timers")]
        let start = crate::step::timers::now();
        let result = $run;
        #[cfg(feature = "timers")]
        {
            $workspace.timers.$part += start.elapsed();
        }
        result
    }};
}

pub(super) use timed;

#[cfg(feature = "timers")]
pub(super) fn now() -> std::time::Instant {
    std::time::Instant::now()
}

/// The time that the parts of all steps so far took.
///
/// ```
/// use umbra_physics::{BodyDef, Timers, World, WorldDef};
///
/// let mut world = World::new(WorldDef::default())?;
/// world.add_body(BodyDef::dynamic())?;
/// (0..10).for_each(|_| _ = world.step());
/// let Timers { steps, free, kick, .. } = world.timers();
/// println!("{steps} steps: {free:?} for free bodies, {kick:?} for the kicks of others");
/// assert_eq!(steps, 10);
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[cfg(feature = "timers")]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Timers {
    /// Steps, including steps that undo one.
    pub steps: u64,
    /// Finding the coupled bodies, dropping the caches of bodies that changed, and turning applied forces into
    /// accelerations.
    pub survey: core::time::Duration,
    /// All stages of free bodies, on which no field can act.
    pub free: core::time::Duration,
    /// The fields stage: evaluating the fields of position, and the fields of velocity that it needs. This and the parts below are
    /// the time of coupled bodies.
    pub fields: core::time::Duration,
    /// Damping and drag.
    pub damp: core::time::Duration,
    /// Gravity, forces and fields to velocities; evaluates the fields of velocity for a closing half kick.
    pub kick: core::time::Duration,
    /// Velocities to positions.
    pub drift: core::time::Duration,
    /// Pairs, manifolds, impulses.
    pub contacts: core::time::Duration,
    /// Backups of coupled bodies, and for all bodies quarantine and sleep.
    pub finish: core::time::Duration,
}
