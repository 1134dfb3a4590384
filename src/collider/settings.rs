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
    /// The number of sub-steps in which contacts are solved, 1 to 16. More make stacks stiffer: a box that bears 1,000 times its own mass
    /// needs 13 of them at 60 steps a second.
    pub substeps: u32,
    /// The largest speed with which overlapping bodies are pushed apart, m/s, up to 2^10.
    pub push_speed: S,
    /// The approach speed from which on bodies bounce, m/s, up to 2^10.
    pub restitution_speed: S,
    /// The speed below which a body that contacts push counts as at rest, m/s, up to 2^10: that of its fastest point. An island of bodies
    /// that were all at rest for [`WorldDef::sleep_after`](crate::WorldDef::sleep_after) ticks stops and falls asleep. With 0 a body sleeps
    /// only where a step would change nothing at all: never while contacts push it or it floats.
    pub sleep_speed: S,
    /// The approach speed from which on a contact is a hit, m/s, up to 2^10: [`Event::ContactHit`](crate::Event::ContactHit) reports it
    /// where one of the colliders has [`hit_events`](crate::ColliderDef::hit_events).
    pub hit_speed: S,
    /// The number of pairs of outlines that may be close to each other in a step, 1 to 2^28: a collider has one outline, that of a compound
    /// one for each part, and those of one body are no pair. With more, the bodies of the outlines with the most pairs are quarantined.
    ///
    /// A step also looks at overlapping boxes that make no pair: those of one body, of one negative group, and those of which only one
    /// collider has a category in the mask of the other. With these there may be 16 times as many as pairs, and 64 more for each outline of
    /// the world. With more, they count as pairs do. It does not look at colliders of which neither has a category in the mask of the
    /// other: any number of them may be in one place.
    ///
    /// As many pairs again of an outline of a sensor with one of another body, where their boxes overlap at the end of the step. With more,
    /// the sensors with the most pairs find nothing in that step: nobody is quarantined, and what was in them leaves.
    pub max_pairs: u32,
    /// The number of pairs of one outline of a moving body that may be close, where there are more than `max_pairs` in all; 1 to
    /// 2^12. The bodies of outlines with more are quarantined, and sensors with more find nothing, each where the pairs of its own sort are
    /// too many. If there are still too many, the number is lowered until the rest fits.
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
    /// 5 sub-steps, overlaps pushed apart with up to 3 m/s, bounces from 1 m/s on, rest below 0.05 m/s, hits
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
    /// [`Error::OutOfRange`] naming the quantity.
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
