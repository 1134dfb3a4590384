//! Explosions: impulses on all colliders around a point.

use alloc::vec::Vec;

use super::forces::Effect;
use super::{Command, Frame, World};
use crate::body::{Activity, BodyKind, Change};
use crate::codec::codec_struct;
use crate::error::{Error, Quantity};
use crate::fx::Fx;
use crate::kernel::wide::div_256;
use crate::limits;
use crate::math::Vec2;
use crate::query::{
    Core, Placement, Point, beside, checked_point, distance, dot, in_scalar, nearest, odd_shift, point,
};
use crate::scalar::{Accumulator as _, Angle as _, Scalar, Wide as _};
use crate::shape::Shape;
use crate::slots::BodyId;

/// An explosion: an impulse, away from a point, on each collider of a dynamic body around it. Sensors get none.
///
/// A collider gets the impulse p·w·f at its nearest point, in the direction from the centre of the explosion to that point:
/// - p is [`impulse`](Self::impulse);
/// - w is the width of the collider as seen from the centre, m: its extent at right angles to that direction;
/// - f is the strength at the distance of the nearest point: 1 up to the radius, falling linearly to 0 over the falloff, 0 beyond.
///
/// Each part of a compound counts by itself. A collider that contains the centre gets its impulse at the centre, towards the centre of mass
/// of its body, or none where the two are the same. Bodies that are hit wake up. Walls do not shelter what is behind them.
///
/// ```
/// use umbra_physics::{BodyDef, Explosion, Mass, Shape, World, WorldDef, fx, vec2};
///
/// let mut world = World::new(WorldDef::default())?;
/// let def = BodyDef { mass: Mass::Kilograms(fx!(2)), ..BodyDef::dynamic().with_collider(Shape::rectangle(1, 3)?) };
/// let box_beside = world.add_body(BodyDef { position: vec2(2, 0), ..def.clone() })?;
/// let far = world.add_body(BodyDef { position: vec2(-5, 0), ..def })?;
///
/// // 4 N·s a metre up to 2 m, and less up to 7 m. The sides that face it are 3 m wide.
/// let blast = Explosion { radius: fx!(2), falloff: fx!(5), ..Explosion::new(vec2(0, 0), fx!(4)) };
/// world.explode(&blast)?;
/// assert_eq!(world.body(box_beside)?.velocity(), vec2(6, 0));
/// assert_eq!(world.body(far)?.velocity(), vec2(-3, 0)); // 4.5 m away: a half of it
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Explosion<S = Fx> {
    /// The centre, m.
    pub position: Vec2<S>,
    /// The distance up to which the explosion has its whole strength, m, 0 to 2^12.
    pub radius: S,
    /// The distance beyond the radius over which the strength falls to 0, m, 0 to 2^12.
    pub falloff: S,
    /// The impulse on each metre of width, N·s/m, within ±2^16; a negative one pulls.
    pub impulse: S,
    /// The [categories](crate::Filter::category) of the colliders that the explosion acts on.
    pub mask: u32,
}

codec_struct!(Explosion { position, radius, falloff, impulse, mask });

/// The largest radius and falloff, m.
const RADIUS: Fx = Fx::from_bits(1 << 44);
/// The largest impulse on a metre, N·s/m.
const IMPULSE: Fx = Fx::from_bits(1 << 48);

impl<S: Scalar> Explosion<S> {
    /// An explosion at a point, with a radius of 1 m and a falloff of 1 m, that acts on all categories.
    ///
    /// ```
    /// use umbra_physics::{Error, Explosion, Fx, Quantity, fx, vec2};
    ///
    /// let blast = Explosion::new(vec2(3, 4), fx!(10));
    /// assert_eq!((blast.position, blast.radius, blast.falloff, blast.mask), (vec2(3, 4), fx!(1), fx!(1), !0));
    /// let far = Explosion { radius: fx!(5000), ..blast };
    /// assert_eq!((blast.check(), far.check()), (Ok(()), Err(Error::OutOfRange { quantity: Quantity::ExplosionRadius })));
    /// ```
    #[must_use]
    pub fn new(position: Vec2<S>, impulse: S) -> Self {
        Self { position, radius: S::ONE, falloff: S::ONE, impulse, mask: !0 }
    }

    /// Checks the values as [`World::explode`] does.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Position`], [`Quantity::ExplosionRadius`] (radius and falloff) or
    /// [`Quantity::ExplosionImpulse`].
    pub fn check(&self) -> Result<(), Error> {
        let within = |value: S, min: Fx, max: Fx, quantity| {
            let is_within = value >= S::from_fx(min) && value <= S::from_fx(max);
            if is_within { Ok(()) } else { Err(Error::OutOfRange { quantity }) }
        };
        checked_point(self.position)?;
        within(self.radius, Fx::ZERO, RADIUS, Quantity::ExplosionRadius)?;
        within(self.falloff, Fx::ZERO, RADIUS, Quantity::ExplosionRadius)?;
        within(self.impulse, -IMPULSE, IMPULSE, Quantity::ExplosionImpulse)
    }

    /// The impulse on a shape at a position and an angle, N·s: the sum over its parts, by the law for the colliders of bodies. It is for
    /// a [`Character`](crate::Character), which has no velocity that the engine could change: divide it by its mass, and add the quotient
    /// to its velocity. The [mask](Self::mask) does not matter. Out of reach it is zero.
    ///
    /// *Error* 2^-30 of it and 4 ulps in each component. *Cost* in proportion to the corners.
    ///
    /// # Errors
    /// The errors of [`check`](Self::check); [`Error::OutOfRange`] with [`Quantity::Position`] for the position, or with
    /// [`Quantity::Impulse`] if a component does not fit.
    ///
    /// ```
    /// use umbra_physics::{Explosion, Shape, fx, vec2};
    ///
    /// let blast = Explosion { radius: fx!(2), falloff: fx!(4), ..Explosion::new(vec2(0, 0), fx!(40)) };
    /// // A hero of 80 kg, 2 m tall: 3 m to the right of it, half of 40 N·s a metre.
    /// let impulse = blast.impulse_on(&Shape::rectangle(fx!(1), fx!(2))?, vec2(fx!(4.5), 0), fx!(0))?;
    /// assert_eq!((impulse, impulse / 80), (vec2(40, 0), vec2(fx!(0.5), 0)));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn impulse_on(&self, shape: &Shape<S>, position: Vec2<S>, angle: S) -> Result<Vec2<S>, Error> {
        self.check()?;
        let (from, centre) = (checked_point(self.position)?, checked_point(position)?);
        let placement = Placement::<S>::new(position, S::Angle::from_radians(angle));
        // Positions are below 2^62 ulps, so that the difference fits.
        let towards = [centre[0] - from[0], centre[1] - from[1]];
        let mut sum = [0_i64; 2];
        for outline in shape.outlines() {
            let core = Core::new(outline, &placement, from);
            let Some(([x, y], _)) = core.and_then(|core| self.impulse_at(&core, from, towards)) else { continue };
            let out = Error::OutOfRange { quantity: Quantity::Impulse };
            sum = [sum[0].checked_add(x).ok_or(out)?, sum[1].checked_add(y).ok_or(out)?];
        }
        Ok(in_scalar(sum))
    }

    /// The share of its strength that is left at a distance in units of 2^-48 m, in units of 2^-32, rounded down.
    fn strength(&self, away: u128) -> i64 {
        let parts = |length: S| u128::from(length.to_fx().to_bits().unsigned_abs()) << 16;
        let (radius, falloff) = (parts(self.radius), parts(self.falloff));
        match (radius + falloff).checked_sub(away) {
            None => 0,
            Some(_) if away <= radius => 1 << 32,
            // Below 2^60, so that the quotient is below 2^32.
            Some(left) => div_256(0, left << 32, falloff).0 as i64,
        }
    }

    /// The impulse on an outline, and the point where it acts, both in ulps of their units. `towards` is the centre of mass of its body.
    ///
    /// *Error* of a component of the impulse 2^-32 of it and 2 ulps.
    fn impulse_at(&self, core: &Core, from: Point, towards: Point) -> Option<(Point, Point)> {
        let closest = nearest(core.corners());
        let away = distance(core, closest);
        let strength = self.strength(away);
        if strength == 0 {
            return None;
        }
        let (at, back) = point(core, closest, away);
        let out = if away == 0 { towards } else { back.map(|part| -part) };
        let direction = Vec2::new(Fx::from_bits(out[0]), Fx::from_bits(out[1])).normalize()?;
        let direction = [direction.x.to_bits(), direction.y.to_bits()];
        // Corners are below 2^15 m from the centre of mass.
        let across = [-direction[1], direction[0]];
        let shadow = |corner: &Point| odd_shift(dot([corner[0] - at[0], corner[1] - at[1]], across), 32);
        let (low, high) = core
            .corners()
            .iter()
            .map(shadow)
            .fold((i128::MAX, i128::MIN), |(low, high), part| (low.min(part), high.max(part)));
        let width = high - low + 2 * i128::from(core.radius);
        // An outline is at most 2^14 m wide: below 2^48·2^46, then 2^62·2^32. So an impulse is below 2^30 N·s, and fits.
        let size = odd_shift(i128::from(self.impulse.to_fx().to_bits()) * width, 32);
        let size = odd_shift(size * i128::from(strength), 32);
        let impulse = direction.map(|part| odd_shift(i128::from(part) * size, 32));
        let [x, y] = impulse.map(i64::try_from);
        Some(([x.ok()?, y.ok()?], beside(from, at)))
    }
}

impl<S: Scalar> World<S> {
    /// Sets off an explosion: an impulse on each collider of a dynamic body around it, all computed from the state before the call. It
    /// wakes the bodies that it hits. It hits neither sensors, bodies without colliders, nor disabled and quarantined bodies.
    ///
    /// *Error* of an impulse 2^-30 of it and 4 ulps in each component. *Cost* in proportion to the bodies that are not
    /// static, and to the colliders of those in reach.
    ///
    /// # Errors
    /// The errors of [`Explosion::check`]; [`Error::OutOfRange`] with [`Quantity::Velocity`] or [`Quantity::AngularVelocity`] if a body
    /// would leave the allowed range: then no body is hit.
    pub fn explode(&mut self, explosion: &Explosion<S>) -> Result<(), Error> {
        let effects = self.blast(explosion)?;
        self.journal.note(|| Command::Explode(*explosion));
        for (body, effect) in effects {
            let Effect::Strike { velocity, angular_velocity } = effect else { continue };
            let dense = self.touch(body, Change::VELOCITY)?;
            let motion = &mut self.bodies.columns.motion;
            motion.velocity.set(dense, velocity);
            motion.angular_velocity[dense] = angular_velocity;
        }
        Ok(())
    }

    /// The bodies that an explosion hits, by their handles, and their velocities after it.
    pub(super) fn blast(&self, explosion: &Explosion<S>) -> Result<Vec<(BodyId, Effect<S>)>, Error> {
        explosion.check()?;
        let from = checked_point(explosion.position)?;
        let asleep = self.bodies.any_asleep().then(|| self.bodies.asleep());
        let may_move = (0..self.bodies.moving()).chain(asleep.into_iter().flatten());
        let reached = may_move.filter(|&dense| self.is_near(explosion, from, dense));
        let mut bodies: Vec<(BodyId, usize)> = reached.map(|dense| (self.bodies.id(dense), dense)).collect();
        bodies.sort_unstable();
        let mut effects = Vec::new();
        for (body, dense) in bodies {
            if let Some(effect) = self.blast_on(explosion, from, body, dense)? {
                effects.push((body, effect));
            }
        }
        Ok(effects)
    }

    /// Returns false if an explosion does not hit a body: it is not dynamic, takes no part, or is too far away.
    fn is_near(&self, explosion: &Explosion<S>, from: Point, dense: usize) -> bool {
        let info = self.bodies.info(dense);
        let takes_part = matches!(self.bodies.activity(dense), Activity::Awake | Activity::Asleep);
        if !takes_part || info.kind != BodyKind::Dynamic || info.collider_mass().is_none() {
            return false;
        }
        let ulps = |length: S| length.to_fx().to_bits();
        // Below 2^49 ulps.
        let reach = ulps(explosion.radius) + ulps(explosion.falloff) + ulps(info.collider_mass().reach);
        let reach = reach.unsigned_abs();
        let position = self.bodies.columns.motion.position.get(dense).map(|part| part.value());
        let position = [ulps(position.x), ulps(position.y)];
        (0..2).all(|axis| position[axis].abs_diff(from[axis]) <= reach)
    }

    /// The bodies that an explosion would hit; none if it is refused.
    pub(crate) fn hit_by(&self, explosion: &Explosion<S>) -> Vec<BodyId> {
        self.blast(explosion).map(|hit| hit.into_iter().map(|(body, _)| body).collect()).unwrap_or_default()
    }

    /// The velocities of a body after an explosion, if it is hit.
    fn blast_on(
        &self,
        explosion: &Explosion<S>,
        from: Point,
        body: BodyId,
        dense: usize,
    ) -> Result<Option<Effect<S>>, Error> {
        let motion = &self.bodies.columns.motion;
        let position = motion.position.get(dense).map(|part| part.value());
        let placement = Placement::<S>::new(position, motion.angle[dense]);
        // Positions are below 2^62 ulps, so that the difference fits.
        let towards = [placement.position()[0] - from[0], placement.position()[1] - from[1]];
        let mut sum: Option<(Vec2<S::Wide>, S::Wide)> = None;
        for collider in self.colliders.solid_of_slot(body.slot) {
            if collider.def.filter.category & explosion.mask == 0 {
                continue;
            }
            for part in 0..collider.outline_count() {
                let core = Core::new(&collider.outline(part).outline, &placement, from);
                let hit = core.and_then(|core| explosion.impulse_at(&core, from, towards));
                let Some((impulse, at)) = hit else { continue };
                let out = Error::OutOfRange { quantity: Quantity::Impulse };
                let (impulse, at) = (in_scalar::<S>(impulse), in_scalar::<S>(at));
                let (impulse, moment) = self.lever(dense, impulse, Some(at), Frame::World, Quantity::Impulse)?;
                // Sums of fixed point are exact: their order makes no difference.
                let (whole, turn) = sum.unwrap_or_default();
                let whole = whole.x.plus(impulse.x).zip(whole.y.plus(impulse.y)).ok_or(out)?;
                sum = Some((Vec2::new(whole.0, whole.1), turn.plus(moment).ok_or(out)?));
            }
        }
        sum.map(|(impulse, moment)| self.strike(dense, impulse, moment)).transpose()
    }
}

const _: () =
    assert!(limits::QUERY.to_bits() > 2 * RADIUS.to_bits(), "what is out of reach is out of reach of any explosion");
