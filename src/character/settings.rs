//! The settings of a character.

use super::obstacle::{along, in_ulps, times};
use crate::error::{Error, Quantity};
use crate::fx;
use crate::fx::Fx;
use crate::limits;
use crate::math::Vec2;
use crate::query::Point;
use crate::scalar::Scalar;
use crate::shape::{Outline, Shape};

/// A character controller: a shape that is moved by translations and stops, slides and steps where it meets colliders.
///
/// It is data, and [`translate`](Self::translate) is a function of a world and its arguments: the controller keeps nothing between two
/// calls. A game keeps the position and the [`Ground`](crate::Ground) that it returns, and gives them back at the next tick.
///
/// ```
/// use umbra_physics::{BodyDef, Character, QueryFilter, Shape, World, WorldDef, fx, vec2};
///
/// let mut world = World::new(WorldDef::default())?;
/// let ground = world.add_body(BodyDef::fixed().with_collider(Shape::rectangle(20, 2)?))?;
/// let hero = Character::new(Shape::rectangle(fx!(0.6), fx!(1.8))?);
///
/// // It falls onto the ground, whose surface is at y = 1, and stands on it.
/// let all = QueryFilter::default();
/// let fallen = hero.translate(&world.queries(), vec2(0, 3), None, vec2(0, -2), &all)?;
/// assert_eq!((fallen.ground.map(|ground| ground.body), fallen.ground_normal), (Some(ground), vec2(0, 1)));
/// // It walks 0.1 m, exactly, at the same height.
/// let walked = hero.translate(&world.queries(), fallen.position, fallen.ground, vec2(fx!(0.1), fx!(-0.01)), &all)?;
/// assert_eq!(walked.position, fallen.position + vec2(fx!(0.1), 0));
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Character<S: Scalar = Fx> {
    /// The shape, as it is defined: it is never turned. A [capsule](Shape::capsule) lies along x unless it is a turned part of a compound.
    /// A chain is refused. A rectangle stands on an edge until its last corner has left it, a round shape slides off around the edge.
    pub shape: Shape<S>,
    /// The direction that is up. Its length does not matter: each component is within ±2^10, and one of them is at least 2^-10 in size.
    pub up: Vec2<S>,
    /// The distance from colliders that the character keeps, m, 2^-12 to 1, within 6 ulps: make the drawn figure larger by it, or it
    /// floats.
    pub skin: S,
    /// The angle of the steepest slope that it climbs and stands on, rad, 0 to π/2. A steeper slope is a wall for a walking character, and
    /// a falling one slides down on it. *Error* 2^-29 rad and, near 0, 2^-14 rad.
    pub max_slope: S,
    /// The angle of the steepest slope on which a downward translation moves it nowhere, rad, 0 to π/2. On a steeper one it slides, also
    /// where it can climb.
    pub max_rest_slope: S,
    /// The height of the highest step that it climbs, m, 0 to 2^4; 0 climbs none. It is measured from the lowest point of the shape. Colliders
    /// of dynamic bodies are no steps. The edge of a lower step is ground to a round shape that meets it within
    /// [`max_slope`](Self::max_slope), up to a height of (R + skin)·(1 − cos `max_slope`).
    pub step_height: S,
    /// The smallest depth of the top of a step that it climbs, m, 0 to 2^4. A shape with a radius R needs more, to stand on the edge of the
    /// step: (R + skin)·(1 − sin [max_slope](Self::max_slope)) in addition.
    pub step_width: S,
    /// The distance by which it is moved down to stay on the ground on its way down a slope or steps, m, 0 to 2^4; 0 never moves it.
    pub snap: S,
    /// The mass with which it [pushes](Self::push) dynamic bodies, kg: its own mass, or a share of it; from 0, which pushes nothing, to
    /// 2^24.
    pub push_mass: S,
}

impl<S: Scalar> Character<S> {
    /// A character with this shape: up is +y, the skin is 2^-6 m, it climbs slopes of 45° and steps of ¼ m with a top of 1/16 m, is moved
    /// down by up to ¼ m, rests wherever it can climb, and pushes nothing.
    ///
    /// ```
    /// use umbra_physics::{Character, Error, Quantity, Shape, fx};
    ///
    /// let hero: Character = Character::new(Shape::capsule(fx!(1), fx!(0.3))?);
    /// assert_eq!((hero.skin, hero.step_height, hero.check()), (fx!(0.015625), fx!(0.25), Ok(())));
    /// let none = Character { skin: fx!(0), ..hero };
    /// assert_eq!(none.check(), Err(Error::OutOfRange { quantity: Quantity::CharacterSkin }));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[must_use]
    pub fn new(shape: Shape<S>) -> Self {
        let scalar = S::from_fx;
        Self {
            shape,
            up: Vec2::new(S::ZERO, S::ONE),
            skin: scalar(fx!(0.015625)),
            max_slope: scalar(fx!(0.785398163)),
            max_rest_slope: scalar(fx!(0.785398163)),
            step_height: scalar(fx!(0.25)),
            step_width: scalar(fx!(0.0625)),
            snap: scalar(fx!(0.25)),
            push_mass: S::ZERO,
        }
    }

    /// Checks the settings as [`translate`](Self::translate) does.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] naming the quantity, such as [`Quantity::CharacterSkin`]; [`Error::DynamicChain`] for a chain.
    pub fn check(&self) -> Result<(), Error> {
        self.terms().map(drop)
    }

    /// The settings in integers.
    pub(super) fn terms(&self) -> Result<Terms, Error> {
        if self.shape.is_chain() {
            return Err(Error::DynamicChain);
        }
        let within = |value: S, min: Fx, max: Fx, quantity| {
            let is_within = value >= S::from_fx(min) && value <= S::from_fx(max);
            if is_within { Ok(value.to_fx()) } else { Err(Error::OutOfRange { quantity }) }
        };
        let skin = within(self.skin, Fx::from_bits(1 << 20), Fx::ONE, Quantity::CharacterSkin)?;
        let limit = Fx::from_bits(1 << 42);
        let x = within(self.up.x, -limit, limit, Quantity::CharacterUp)?;
        let y = within(self.up.y, -limit, limit, Quantity::CharacterUp)?;
        let up = Vec2::new(x, y).normalize().filter(|_| x.abs().max(y.abs()).to_bits() >= 1 << 22);
        let up = up.ok_or(Error::OutOfRange { quantity: Quantity::CharacterUp })?;
        let cosine = |angle: S| {
            let angle = within(angle, Fx::ZERO, Fx::FRAC_PI_2, Quantity::CharacterSlope)?;
            // Normals and the direction are rounded.
            Ok::<_, Error>(angle.cos().to_bits() - 4)
        };
        let length = |value: S| Ok::<_, Error>(within(value, Fx::ZERO, LENGTH, Quantity::CharacterStep)?.to_bits());
        let up = [up.x.to_bits(), up.y.to_bits()];
        let lowest = |outline: &Outline<S>| {
            let corners = outline.corners().iter().map(|corner| along(in_ulps(*corner), up));
            corners.min().unwrap_or_default() - outline.radius().to_fx().to_bits()
        };
        let sole = self.shape.outlines().iter().map(lowest).min().unwrap_or_default();
        let radius = self.shape.outlines().iter().map(|outline| outline.radius().to_fx()).max().unwrap_or_default();
        let edge = times([0, Fx::ONE.to_bits() - self.max_slope.to_fx().sin().to_bits()], (radius + skin).to_bits())[1];
        within(self.push_mass, Fx::ZERO, limits::MASS_MAX, Quantity::Mass { value: self.push_mass.to_fx() })?;
        Ok(Terms {
            up,
            sole,
            skin: skin.to_bits(),
            climbs: cosine(self.max_slope)?,
            rests: cosine(self.max_rest_slope)?,
            step_height: length(self.step_height)?,
            step_width: length(self.step_width)? + edge,
            // It stands up to 4 ulps higher or lower.
            snap: length(self.snap)? + if self.snap > S::ZERO { 8 } else { 0 },
        })
    }
}

/// The largest height, width or distance of steps.
const LENGTH: Fx = Fx::from_bits(1 << 36);

/// Settings in ulps. Cosines and the components of the unit vector `up` are in units of 2^-32.
#[derive(Clone, Copy, Debug)]
pub(super) struct Terms {
    pub(super) up: Point,
    /// The height of the lowest point of the shape above its centre, along up.
    pub(super) sole: i64,
    pub(super) skin: i64,
    /// The smallest cosine of the angle between up and the normal of a surface that it climbs.
    pub(super) climbs: i64,
    /// The smallest cosine of the angle between up and the normal of a surface that it rests on.
    pub(super) rests: i64,
    pub(super) step_height: i64,
    pub(super) step_width: i64,
    pub(super) snap: i64,
}
