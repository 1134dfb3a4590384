//! Poses between ticks.

use alloc::vec::Vec;

use super::pose::Pose;
use super::step_clock::TickFraction;
use crate::body::Activity;
use crate::limits;
use crate::scalar::{FloatAngle as _, Scalar, ToF64};
use crate::slots::BodyId;
use crate::world::World;

/// Moment to show, relative to the last ticks, from the [remainder](super::StepClock::remainder) of a step clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Blend {
    /// Between the tick before the last (0) and the last tick (1): positions that bodies had, a tick late. Above 1 the last
    /// tick is shown.
    Interpolated(TickFraction),
    /// Beyond the last tick by this fraction, at the velocities of that tick: not late, but wrong wherever a force acts.
    /// Fractions above 1 are used in full: the remainder of a paused clock is all still to come.
    Extrapolated(TickFraction),
}

/// A body as it was looked at.
#[derive(Clone, Copy, Debug)]
struct Seen {
    body: BodyId,
    before: Pose,
    now: Pose,
    /// m/s and rad/s; zeros for what does not move.
    velocity: ([f64; 2], f64),
}

/// Keeps where the bodies of a world were at its last two ticks, and gives their poses between these or soon after.
///
/// It is no part of the world: call [`look`](Self::look) after each step. It blends motion alone, and shows a body at its place
/// in the last tick, without a blend, when
/// - a call [placed](crate::StepReport::placed) or added the body since the tick before, in a slot used before or not;
/// - the world was put back ([`World::rewinds`]), or stepped without a look: then this holds for all bodies.
///
/// A [`Rollback`](crate::Rollback) sets the world back to make ticks again. Look at each tick as it begins, in the tick function,
/// and at the present one before a frame is drawn, as in the loop below: then motion is blended in its new past.
///
/// An interpolation tells one world from another by tick and rewinds alone. A different world may have both in common: a copy
/// that was stepped with other inputs, or the world of a received snapshot
/// ([`Snapshot::into_world`](crate::Snapshot::into_world)), whose rewinds start at 0. To go on with such a world, use
/// [`World::restore`] or `clone_from` on the world that was shown, or [clear](Self::clear) the interpolation. Otherwise bodies
/// may be blended from their places in the world before.
///
/// ```
/// use umbra_physics::{Blend, BodyDef, Interpolation, Rollback, StepClock, World, WorldDef, vec2};
///
/// let mut world = World::new(WorldDef::default())?;
/// let ball = world.add_body(BodyDef { velocity: vec2(6, 0), ..BodyDef::dynamic() })?;
/// let mut rollback = Rollback::<bool>::new(&world, [0], 8);
/// let mut step_clock = StepClock::new(world.def().time_step)?;
/// let mut interpolation = Interpolation::new();
/// interpolation.look(&world);
/// let mut shown = Vec::new();
/// for frame in 0..6 {
///     // What arrived late: here in frame 4, that the player stopped the ball in tick 1.
///     if frame == 4 {
///         rollback.add_input(1, 0, true)?;
///     }
///     // As many ticks as there is time for: a display of 120 Hz.
///     for _ in 0..step_clock.frame(8_333_334).ticks {
///         rollback.advance(&mut world, |world, inputs| {
///             interpolation.look(world);
///             if inputs[0].1 {
///                 world.set_velocity(ball, vec2(0, 0)).expect("it is there");
///             }
///         })?;
///         interpolation.look(&world);
///     }
///     let at = Blend::Interpolated(step_clock.remainder());
///     shown.push(interpolation.pose(ball, at).expect("it is there").position[0]);
/// }
/// // Half a tick is 5 cm. Shown a tick late; then it is found where it was stopped.
/// let expected = [0.0, 0.0, 0.05, 0.1, 0.15, 0.1];
/// assert!(shown.iter().zip(expected).all(|(x, expected)| (x - expected).abs() < 1e-6), "{shown:?}");
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Interpolation {
    /// By slot.
    seen: Vec<Option<Seen>>,
    /// The tick of the last look, and how often the world had been put back by then.
    looked: Option<(u64, u64)>,
    /// From that tick to the next, s.
    time_step: f64,
}

impl Interpolation {
    /// An interpolation that has not looked at a world yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { seen: Vec::new(), looked: None, time_step: 0.0 }
    }

    /// Reads the poses of all bodies after a step. Call it with the same world each time.
    ///
    /// Looking again at the same tick only updates the time step, which [`Blend::Extrapolated`] uses. At [`limits::TICK`], where
    /// ticks are no longer counted, each look is taken as one after a step.
    ///
    /// It takes nothing from the heap while no slots are added.
    pub fn look<S: Scalar + ToF64>(&mut self, world: &World<S>) {
        let (tick, rewinds) = (world.tick(), world.rewinds());
        let (num, den) = world.def().time_step.seconds();
        self.time_step = f64::from(num) / f64::from(den);
        let again = self.looked == Some((tick, rewinds));
        if again && tick != limits::TICK {
            return;
        }
        let goes_on = again || (tick > 0 && self.looked == Some((tick - 1, rewinds)));
        self.looked = Some((tick, rewinds));
        let mut free = 0;
        for body in world.bodies() {
            let id = body.id();
            let now = Pose::of(&body);
            let slot = id.parts().0 as usize;
            if self.seen.len() <= slot {
                self.seen.resize(slot + 1, None);
            }
            // The slots that were passed over have no body.
            self.seen[free..slot].fill(None);
            free = slot + 1;
            let before = self.seen[slot].filter(|look| goes_on && look.body == id).map_or(now, |look| look.now);
            let velocity = if body.activity() == Activity::Awake {
                (body.velocity().to_f64(), body.angular_velocity().to_f64())
            } else {
                ([0.0; 2], 0.0)
            };
            self.seen[slot] = Some(Seen { body: id, before, now, velocity });
        }
        self.seen.truncate(free);
        for placed in world.last_report().placed {
            if let Some(Some(look)) = self.seen.get_mut(placed.parts().0 as usize) {
                look.before = look.now;
            }
        }
    }

    /// The pose of a body; `None` if it was not there at the last look.
    #[must_use]
    pub fn pose(&self, body: BodyId, at: Blend) -> Option<Pose> {
        let look = self.seen.get(body.parts().0 as usize)?.filter(|look| look.body == body)?;
        Some(look.pose(at, self.time_step))
    }

    /// The poses of all bodies of the last look, in the order of their slots.
    ///
    /// ```
    /// use umbra_physics::{Blend, BodyDef, Interpolation, TickFraction, World, WorldDef, vec2};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let ball = world.add_body(BodyDef { velocity: vec2(60, 0), ..BodyDef::dynamic() })?;
    /// let mut interpolation = Interpolation::new();
    /// interpolation.look(&world);
    /// let half = Blend::Extrapolated(TickFraction { num: 1, den: 2 });
    /// for (body, pose) in interpolation.poses(half) {
    ///     assert_eq!((body, pose.position), (ball, [0.5, 0.0]));
    /// }
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn poses(&self, at: Blend) -> impl Iterator<Item = (BodyId, Pose)> {
        self.seen.iter().flatten().map(move |look| (look.body, look.pose(at, self.time_step)))
    }

    /// Forgets the bodies, to look at another world next. Nothing is blended until the second look from now.
    ///
    /// ```
    /// use umbra_physics::{Blend, BodyDef, Interpolation, TickFraction, World, WorldDef};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// world.add_body(BodyDef::dynamic())?;
    /// let mut interpolation = Interpolation::new();
    /// interpolation.look(&world);
    /// interpolation.clear();
    /// assert_eq!(interpolation.poses(Blend::Interpolated(TickFraction::ONE)).count(), 0);
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn clear(&mut self) {
        self.looked = None;
        self.seen.clear();
    }
}

/// The ratio, rounded three times: numerator, denominator and quotient.
impl ToF64 for TickFraction {
    fn to_f64(self) -> f64 {
        self.num as f64 / self.den as f64
    }
}

impl Seen {
    fn pose(&self, at: Blend, time_step: f64) -> Pose {
        match at {
            Blend::Interpolated(part) => self.before.between(self.now, part.to_f64().min(1.0)),
            Blend::Extrapolated(part) => {
                let (Pose { position, angle }, (velocity, angular_velocity)) = (self.now, self.velocity);
                let seconds = part.to_f64() * time_step;
                let position = [0, 1].map(|i| position[i] + velocity[i] * seconds);
                Pose { position, angle: angle.turned_by(angular_velocity * seconds) }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::BodyDef;
    use crate::math::vec2;
    use crate::world::WorldDef;

    #[test]
    fn poses_go_on_where_ticks_are_no_longer_counted() {
        let mut world = World::new(WorldDef::default()).expect("a world");
        let body = world.add_body(BodyDef { velocity: vec2(60, 0), ..BodyDef::dynamic() }).expect("a body");
        world.tick = limits::TICK - 2;
        let mut interpolation = Interpolation::new();
        interpolation.look(&world);
        for metres in 1..5 {
            world.step();
            interpolation.look(&world);
            let half = interpolation.pose(body, Blend::Interpolated(TickFraction { num: 1, den: 2 })).expect("a pose");
            let off = half.position[0] - (f64::from(metres) - 0.5);
            assert!((-1e-6..1e-6).contains(&off), "{metres}: {off}");
        }
    }
}
