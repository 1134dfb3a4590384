//! Damping of velocities, as the share that is left after a second or as a rate.

use crate::codec::{Encoder, Malformed, Read, Reader, Write};
use crate::error::{Error, Quantity};
use crate::fx::Fx;
use crate::kernel::exp_log;
use crate::scalar::{Decay, Scalar};

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
/// | [`Damping::rate`]`(fx!(60))` | e^−60 | 1/e of the velocity is left after 1/60 s |
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
pub struct Damping<S = Fx> {
    decay: Decay<S>,
}

/// Above this rate a damping holds the rate, in 1/s. Up to it the share is held, of which half an ulp is at most 2^-27.2.
const STRONG_RATE: i32 = 4;

impl<S: Scalar> Damping<S> {
    /// No damping: all of a velocity is left.
    pub const NONE: Self = Self::kept_per_second(S::ONE);

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
        Self { decay: Decay::KeptPerSecond(kept) }
    }

    /// The share of a velocity that is left after a second, rounded if the damping has a [`strong_rate`](Self::strong_rate).
    #[must_use]
    pub fn kept(self) -> S {
        match self.decay {
            Decay::KeptPerSecond(kept) => kept,
            Decay::Rate(rate) => S::kept_at(rate),
        }
    }

    /// The rate of a damping that was made by a rate above 4/s; `None` for any other, which has its share.
    ///
    /// ```
    /// use umbra_physics::{Damping, fx};
    ///
    /// assert_eq!(Damping::rate(fx!(50)).strong_rate(), Some(fx!(50)));
    /// assert_eq!(Damping::rate(fx!(4)).strong_rate(), None);
    /// assert_eq!(Damping::kept_per_second(fx!(0)).strong_rate(), None);
    /// ```
    #[must_use]
    pub const fn strong_rate(self) -> Option<S> {
        match self.decay {
            Decay::KeptPerSecond(_) => None,
            Decay::Rate(rate) => Some(rate),
        }
    }

    /// The damping as one number, as files, hashes and the C interface have it: the share, or minus a strong rate.
    ///
    /// A share below −4, which is refused as any below 0, becomes −4.
    #[must_use]
    pub fn number(self) -> S {
        let lowest = -strong_rate::<S>();
        match self.decay {
            Decay::KeptPerSecond(kept) if kept < lowest => lowest,
            Decay::KeptPerSecond(kept) => kept,
            Decay::Rate(rate) => -rate,
        }
    }

    /// The damping by a law, in the one form that it has.
    pub(crate) fn new(decay: Decay<S>) -> Self {
        match decay {
            Decay::Rate(rate) if rate > strong_rate() => Self { decay },
            Decay::Rate(rate) => Self::kept_per_second(S::kept_at(rate)),
            Decay::KeptPerSecond(kept) => Self::kept_per_second(kept),
        }
    }

    /// The law that the damping stands for.
    pub(crate) const fn decay(self) -> Decay<S> {
        self.decay
    }

    /// Returns true for a damping that leaves nothing of a velocity after a second, to the last bit of a share.
    ///
    /// [`Yoshida4`](crate::Integrator::Yoshida4) steps backwards in time in the middle of a step, and has no inverse for it.
    pub(crate) fn stops(self) -> bool {
        self.kept() == S::ZERO
    }

    /// Refuses a share outside 0 to 1, and a NaN. A negative rate has become a share above 1.
    pub(crate) fn check(self) -> Result<(), Error> {
        let kept = self.kept();
        check(kept >= S::ZERO && kept <= S::ONE, Quantity::Damping)
    }
}

/// [`STRONG_RATE`] as a scalar.
fn strong_rate<S: Scalar>() -> S {
    S::from_fx(Fx::from_int(STRONG_RATE))
}

impl Damping<Fx> {
    /// The damping with this rate c, in 1/s, the coefficient of dv/dt = −c·v: after a second e^−c of a velocity is left.
    ///
    /// Box2D and Rapier have this coefficient under the name of damping. They leave 1/(1 + c·h) in each step of h seconds, which tends
    /// to e^(−c·t) as the steps get shorter; at 60 steps a second and c = 0.5 they keep 0.6078 of a velocity in a second, not 0.6065.
    ///
    /// *Units* 1/s. *Domain* 0 and above; a negative rate is refused by what the damping is given to, as nothing may gain speed.
    /// *Error* of the share that a step of h seconds leaves, e^(−c·h): up to 4/s, where the share of a second is held within
    /// 0.5001 ulp, at most h·2^-27 of it; above 4/s, where the rate itself is held, 2^-60 of it. *Source* a power of two, as [`Fx::exp2`].
    /// [`Yoshida4`](crate::Integrator::Yoshida4) takes rates below 22.8739 (33·ln 2).
    ///
    /// A `Damping<f64>` or `Damping<f32>` is made as `Damping::kept_per_second((-c).exp())`.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, Damping, World, WorldDef, fx, vec2};
    ///
    /// assert_eq!(Damping::rate(fx!(0)), Damping::NONE);
    /// assert_eq!(Damping::rate(fx!(0.5)).kept(), fx!(0.60653065971)); // to the last bit
    ///
    /// // Of a body in treacle, 1/e of the velocity is left after each step.
    /// let treacle = Damping::rate(fx!(60));
    /// let mut world: World = World::new(WorldDef { linear_damping: treacle, ..WorldDef::default() })?;
    /// let ball = world.add_body(BodyDef { velocity: vec2(100, 0), ..BodyDef::dynamic() })?;
    /// for speed in ["36.787944", "13.533528", "4.978707"] {
    ///     world.step();
    ///     assert_eq!(format!("{:.6}", world.body(ball)?.velocity().x), speed);
    /// }
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[must_use]
    pub const fn rate(rate: Fx) -> Self {
        if rate.to_bits() > Fx::from_int(STRONG_RATE).to_bits() {
            return Self { decay: Decay::Rate(rate) };
        }
        match exp_log::exp(rate.to_bits().saturating_neg()) {
            Some(kept) => Self::kept_per_second(Fx::from_bits(kept as i64)),
            None => Self::kept_per_second(Fx::MAX),
        }
    }

    /// The damping of a [`number`](Self::number): a share, or minus a rate above 4/s.
    ///
    /// A number from −4 to 0 is a share that is refused by what the damping is given to, and so is [`Fx::MIN`], which is minus no rate.
    ///
    /// ```
    /// use umbra_physics::{Damping, fx};
    ///
    /// for damping in [Damping::NONE, Damping::kept_per_second(fx!(0)), Damping::rate(fx!(0.1)), Damping::rate(fx!(50))] {
    ///     assert_eq!(Damping::from_number(damping.number()), damping);
    /// }
    /// ```
    #[must_use]
    pub const fn from_number(number: Fx) -> Self {
        match number.to_bits().checked_neg() {
            Some(rate) if rate > Fx::from_int(STRONG_RATE).to_bits() => Self::rate(Fx::from_bits(rate)),
            _ => Self::kept_per_second(number),
        }
    }
}

#[cfg(feature = "serde")]
impl<S: Scalar + serde::Serialize> serde::Serialize for Damping<S> {
    fn serialize<T: serde::Serializer>(&self, serializer: T) -> Result<T::Ok, T::Error> {
        self.decay.serialize(serializer)
    }
}

#[cfg(feature = "serde")]
impl<'de, S: Scalar + serde::Deserialize<'de>> serde::Deserialize<'de> for Damping<S> {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Decay::deserialize(deserializer).map(Self::new)
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
        self.number().write(out);
    }
}

impl Read for Damping {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        let malformed = reader.malformed("a damping");
        let number = Fx::read(reader)?;
        // A share so far below 0 is written as −4.
        if number == Fx::MIN { Err(malformed) } else { Ok(Self::from_number(number)) }
    }
}
