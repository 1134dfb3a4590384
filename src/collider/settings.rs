//! The settings of contacts of a world.

use crate::codec::codec_struct;
use crate::error::{Error, Quantity};
use crate::fx;
use crate::fx::Fx;
use crate::scalar::Scalar;

/// Settings of contacts. The defaults suit bodies of 0.1 m to 10 m at 60 steps a second.
///
/// ```
/// use umbra_physics::{ContactSettings, Error, Quantity, World, WorldDef, fx};
///
/// let contacts = ContactSettings { substeps: 8, ..ContactSettings::default() }; // stiffer stacks, for 1.5 times the time
/// let def = WorldDef { contacts, ..WorldDef::default() };
/// assert_eq!(def.contacts.restitution_speed, fx!(1));
///
/// let mut world = World::new(def)?;
/// let no_bounce_below = ContactSettings { restitution_speed: fx!(2), ..contacts };
/// assert_eq!(no_bounce_below.check(), Ok(()));
/// world.set_contact_settings(no_bounce_below)?;
/// let none = ContactSettings { substeps: 0, ..contacts };
/// assert_eq!(world.set_contact_settings(none), Err(Error::OutOfRange { quantity: Quantity::Substeps }));
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct ContactSettings<S = Fx> {
    /// The number of sub-steps in which contacts are solved, 1 to 16. More make stacks stiffer. Bodies that touch where one bears another
    /// of more than 64 times its mass, directly or by others between them, are solved in 16 of them whatever the number is.
    pub substeps: u32,
    /// The largest speed with which overlapping bodies are pushed apart, m/s, 0 to 2^10; 3 by default. A lower one separates bodies that
    /// were spawned inside each other more gently.
    pub push_speed: S,
    /// The approach speed above which bodies bounce, m/s, 0 to 2^10; 1 by default. Slower impacts do not bounce, nor do those at less than the
    /// speed that forces give in two steps, so that bodies come to rest. A world seen from above, as of billiards, wants 0: by the default a
    /// ball that runs into a wall at 1 m/s or less stays there.
    pub restitution_speed: S,
    /// The speed below which a body that contacts push counts as at rest, m/s, 0 to 2^10; 0.05 by default. The speed of a body is that of
    /// its fastest point. An island of bodies that were all at rest for [`WorldDef::sleep_after`](crate::WorldDef::sleep_after) ticks stops
    /// and falls asleep. With 0 a body sleeps only where a step would change nothing at all: never while contacts push it or it floats.
    pub sleep_speed: S,
    /// The smallest approach speed at which a contact is a hit, m/s, 0 to 2^10; 1 by default.
    /// [`Event::ContactHit`](crate::Event::ContactHit) reports a hit where one of the colliders has
    /// [`hit_events`](crate::ColliderDef::hit_events).
    pub hit_speed: S,
    /// The number of pairs of outlines that may be close to each other in a step, 1 to 2^28; 2^20 by default. It bounds the time and memory
    /// of a step. A collider has one outline, a compound one for each part; two outlines of one body are no pair. With more pairs than
    /// this, the bodies of the outlines with the most pairs are quarantined.
    ///
    /// A step also looks at overlapping boxes that make no pair: those of two colliders of one body, of one negative group, and of a pair in
    /// which only one mask has the other's category. With these there may be 16 times as many as pairs, and 128 more for each outline
    /// of the world. With more, they count as pairs do. A step does not look at colliders of which neither has a category in the mask of
    /// the other: any number of them may be in one place.
    ///
    /// Sensors have limits of the same sizes of their own: they count the pairs of a sensor's outline and another body's outline whose boxes
    /// overlap at the end of the step, and the overlaps that make no pair. Beyond them, the sensors with the most pairs find nothing in
    /// that step, and the colliders that were in them leave; no body is quarantined.
    pub max_pairs: u32,
    /// The number of pairs that one outline of a moving body may have in a step with more than `max_pairs`, 1 to 2^12; 256 by default. In
    /// such a step the bodies of outlines with more are quarantined, or the sensors with more find nothing, whichever sort of pairs is
    /// beyond its limit. If there are still too many pairs, the number is lowered until the rest fits.
    pub max_pairs_per_collider: u32,
}

codec_struct!(ContactSettings {
    substeps,
    push_speed,
    restitution_speed,
    sleep_speed,
    hit_speed,
    max_pairs,
    max_pairs_per_collider
});

impl<S: Scalar> Default for ContactSettings<S> {
    /// 5 sub-steps, overlaps pushed apart with up to 3 m/s, bounces above 1 m/s, rest below 0.05 m/s, hits
    /// from 1 m/s on, 2^20 pairs and 256 of one outline.
    fn default() -> Self {
        Self {
            substeps: 5,
            push_speed: S::from_fx(fx!(3)),
            restitution_speed: S::ONE,
            sleep_speed: S::from_fx(fx!(0.05)),
            hit_speed: S::ONE,
            max_pairs: 1 << 20,
            max_pairs_per_collider: 256,
        }
    }
}

impl<S: Scalar> ContactSettings<S> {
    /// Checks the settings as a world does that is made with them.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Substeps`], [`Quantity::ContactSpeed`] or [`Quantity::Pairs`].
    pub fn check(&self) -> Result<(), Error> {
        let check = |ok: bool, quantity| if ok { Ok(()) } else { Err(Error::OutOfRange { quantity }) };
        let is_speed = |speed: S| speed >= S::ZERO && speed <= S::from_fx(fx!(1024));
        let are_counts =
            (1..=1 << 28).contains(&self.max_pairs) && (1..=1 << 12).contains(&self.max_pairs_per_collider);
        check((1..=16).contains(&self.substeps), Quantity::Substeps)?;
        let speeds = [self.push_speed, self.restitution_speed, self.sleep_speed, self.hit_speed];
        check(speeds.into_iter().all(is_speed), Quantity::ContactSpeed)?;
        check(are_counts, Quantity::Pairs)
    }
}
