//! Where the time of steps goes, behind the feature `timers`; without it nothing of this is compiled.

/// Runs an expression, and adds the time it takes to a part of the timers.
macro_rules! timed {
    ($scratch:expr, $part:ident, $run:expr) => {{
        #[cfg(feature = "timers")]
        let start = crate::step::timers::now();
        let done = $run;
        #[cfg(feature = "timers")]
        {
            $scratch.timers.$part += start.elapsed();
        }
        done
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
/// let mut world: World = World::new(WorldDef::default())?;
/// world.add_body(BodyDef::dynamic())?;
/// (0..10).for_each(|_| _ = world.step());
/// let Timers { steps, march, kick, .. } = world.timers();
/// println!("{steps} steps: {march:?} for free bodies, {kick:?} for the kicks of others");
/// assert_eq!(steps, 10);
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[cfg(feature = "timers")]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Timers {
    /// Steps, also those that undo one.
    pub steps: u64,
    /// What was applied over the tick to accelerations, and which bodies a field may reach.
    pub survey: core::time::Duration,
    /// All stages of the bodies that no field reaches.
    pub march: core::time::Duration,
    /// Of the others: evaluating the fields of position.
    pub fields: core::time::Duration,
    /// Damping and drag.
    pub damp: core::time::Duration,
    /// Gravity, forces and fields to velocities; evaluates the fields of velocity.
    pub kick: core::time::Duration,
    /// Velocities to positions.
    pub drift: core::time::Duration,
    /// Quarantine and sleep, of the others also keeping what they were before the step.
    pub finish: core::time::Duration,
}
