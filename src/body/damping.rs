//! Damping of velocities, as the share that is left after a second.

use crate::codec::{Encoder, Malformed, Read, Reader, Write};
use crate::error::{Error, Quantity};
use crate::fx::Fx;
use crate::kernel::exp_log;
use crate::scalar::Scalar;

use super::check;

/// The damping of a velocity: the share of it that is left after a second, from 0 to 1.
///
/// The engine solves dv/dt = −c·v exactly, so the effect over a second does not depend on the length of a step.
///
/// | | share kept in a second | effect |
/// |---|---|---|
/// | [`Damping::NONE`] | 1 | none; the default of a world |
/// | [`Damping::kept_per_second`]`(fx!(0.25))` | 0.25 | three quarters of the velocity are lost in each second |
/// | [`Damping::rate`]`(fx!(0.1))` | e^−0.1 = 0.905 | as a damping of 0.1 in Box2D and Rapier |
/// | [`Damping::kept_per_second`]`(fx!(0))` | 0 | stops at once, in the first step |
///
/// Like the other values of a definition, a damping out of range can be made, and is refused by what it is given to:
/// [`Error::OutOfRange`] with [`Quantity::Damping`].
///
/// ```
/// use umbra_physics::{BodyDef, Damping, World, WorldDef, fx, vec2};
///
/// const AIR: Damping = Damping::rate(fx!(0.1));
/// let mut world: World = World::new(WorldDef { linear_damping: AIR, ..WorldDef::default() })?;
/// let puck = BodyDef { velocity: vec2(16, 0), ..BodyDef::dynamic() };
/// let in_air = world.add_body(puck.clone())?;
/// let on_ice = world.add_body(BodyDef { linear_damping: Some(Damping::NONE), ..puck.clone() })?;
/// let in_tar = Some(Damping::kept_per_second(fx!(0.125)));
/// let in_tar = world.add_body(BodyDef { linear_damping: in_tar, ..puck })?;
/// (0..60).for_each(|_| _ = world.step());
/// let speed = |body| world.body(body).map(|body| body.velocity().x);
/// assert_eq!((speed(on_ice)?, speed(in_tar)?), (fx!(16), fx!(2)));
/// assert_eq!(format!("{:.4}", speed(in_air)?), "14.4774"); // 16·e^−0.1
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Damping<S = Fx> {
    kept_per_second: S,
}

impl<S: Scalar> Damping<S> {
    /// No damping: all of a velocity is left.
    pub const NONE: Self = Self { kept_per_second: S::ONE };

    /// The damping that leaves this share of a velocity after a second: 1 is no damping, 0 stops at once.
    ///
    /// A share outside 0 to 1 is refused by what the damping is given to.
    ///
    /// ```
    /// use umbra_physics::{Damping, Error, Quantity, WorldDef, fx};
    ///
    /// assert_eq!(Damping::kept_per_second(fx!(1)), Damping::NONE);
    /// let gains = WorldDef { linear_damping: Damping::kept_per_second(fx!(1.5)), ..WorldDef::default() };
    /// assert_eq!(gains.check(), Err(Error::OutOfRange { quantity: Quantity::Damping }));
    /// ```
    #[must_use]
    pub const fn kept_per_second(kept: S) -> Self {
        Self { kept_per_second: kept }
    }

    /// The share of a velocity that is left after a second.
    #[must_use]
    pub const fn kept(self) -> S {
        self.kept_per_second
    }

    /// Returns true for a damping that leaves nothing of a velocity.
    ///
    /// [`Yoshida4`](crate::Integrator::Yoshida4) steps backwards in time in the middle of a step, and has no inverse for it.
    pub(crate) fn stops(self) -> bool {
        self.kept_per_second == S::ZERO
    }

    /// Refuses a share outside 0 to 1, and a NaN.
    pub(crate) fn check(self) -> Result<(), Error> {
        check(self.kept_per_second >= S::ZERO && self.kept_per_second <= S::ONE, Quantity::Damping)
    }
}

impl Damping<Fx> {
    /// The damping with this rate c, in 1/s, the coefficient of dv/dt = −c·v: after a second e^−c of a velocity is left.
    ///
    /// Box2D and Rapier have this coefficient under the name of damping. They leave 1/(1 + c·h) in each step of h seconds, which tends
    /// to e^(−c·t) as the steps get shorter; at 60 steps a second and c = 0.5 they keep 0.6078 of a velocity in a second, not 0.6065.
    ///
    /// *Units* 1/s. *Domain* 0 and above; a negative rate is refused by what the damping is given to, as nothing may gain speed.
    /// *Error* of the share 0.5001 ulp. From 22.8739 (33·ln 2) on the share is 0, and the velocity stops at once. For a stronger
    /// damping that does not stop at once, use a linear [`FieldKind::Drag`](crate::FieldKind::Drag). *Source* a power of two, as
    /// [`Fx::exp2`].
    ///
    /// A `Damping<f64>` or `Damping<f32>` is made as `Damping::kept_per_second((-c).exp())`.
    ///
    /// ```
    /// use umbra_physics::{Damping, fx};
    ///
    /// assert_eq!(Damping::rate(fx!(0)), Damping::NONE);
    /// assert_eq!(Damping::rate(fx!(0.5)).kept(), fx!(0.60653065971)); // to the last bit
    /// assert_eq!(Damping::rate(fx!(22.8739)).kept(), fx!(0));
    /// ```
    #[must_use]
    pub const fn rate(rate: Fx) -> Self {
        match exp_log::exp(rate.to_bits().saturating_neg()) {
            Some(kept) => Self::kept_per_second(Fx::from_bits(kept as i64)),
            None => Self::kept_per_second(Fx::MAX),
        }
    }
}

impl<S: Scalar> Default for Damping<S> {
    /// [`Damping::NONE`].
    fn default() -> Self {
        Self::NONE
    }
}

impl<S: Scalar> Write for Damping<S> {
    fn write(&self, out: &mut impl Encoder) {
        self.kept_per_second.write(out);
    }
}

impl Read for Damping {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        Fx::read(reader).map(Self::kept_per_second)
    }
}
