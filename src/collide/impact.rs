//! The time of impact of two shapes that move and turn.

use alloc::vec::Vec;
use core::slice::from_ref;

use super::sweep::{self, Form, Leg, Moment, Second};
use crate::error::{Error, Quantity};
use crate::fx::Fx;
use crate::kernel::wide::mul_shift;
use crate::limits;
use crate::math::Vec2;
use crate::query::{
    Core, CoreDistance, Placement, Point, ShapeDistance, beside, checked_point, checked_translation, from_to, in_fx,
    in_parts,
};
use crate::scalar::Turn;
use crate::shape::{Outline, Shape};

/// The motion of a shape over some time: at constant velocity, and turning at a constant rate around its centre of mass.
///
/// ```
/// use umbra_physics::{Sweep, fx, vec2};
///
/// // It moves 3 m to the right.
/// let sweep = Sweep { translation: vec2(3, 0), ..Sweep::at(vec2(1, 2), fx!(0)) };
/// assert_eq!((sweep.position, sweep.rotation), (vec2(1, 2), fx!(0)));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Sweep {
    /// The position of the centre of mass at the start, m.
    pub position: Vec2,
    /// The angle at the start, rad.
    pub angle: Fx,
    /// The translation over all of the time, m; components within ±2^20.
    pub translation: Vec2,
    /// The rotation over all of the time, rad, whole turns included; within ±2^17.
    pub rotation: Fx,
}

impl Sweep {
    /// A shape that stands still.
    #[must_use]
    pub fn at(position: Vec2, angle: Fx) -> Self {
        Self { position, angle, translation: Vec2::ZERO, rotation: Fx::ZERO }
    }

    fn leg(&self) -> Result<Leg, Error> {
        // 1/2π in 2^-66; from 2^-32 rad to 2^-64 turns.
        const PER_TURN: u128 = 0xa2f9_836e_4e44_152a;
        let (position, translation) = (checked_point(self.position)?, checked_translation(self.translation)?);
        if !(-limits::JOINT_ANGLE..=limits::JOINT_ANGLE).contains(&self.rotation) {
            return Err(Error::OutOfRange { quantity: Quantity::Query });
        }
        // Below 2^49 · 2^64 · 2^-34.
        let spin = mul_shift(self.rotation.to_bits().into(), PER_TURN, 66 + 32 - 64).unwrap_or(0);
        Ok(Leg::new(position, translation.map(i128::from), Turn::from_radians(self.angle), spin))
    }
}

/// The moment at which two moving shapes meet, and their distance then: see [`Shape::time_of_impact`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct ShapeImpact {
    /// The fraction of the time at which they meet, from 0 to 1, rounded down to units of 2^-32.
    pub fraction: Fx,
    /// The distance of the two parts that meet, at that moment before rounding.
    pub distance: ShapeDistance,
}

impl Shape {
    /// The moment at which this shape and another one meet on their ways; `None` if they do not.
    ///
    /// *Conservative*: shapes that are more than 2^-20 m apart at the start are still apart, by at most 2^-26 m and 2^-26 of their sizes, and before
    /// they are farther apart; half of that they may overlap by rounding. Shapes that touch at the start, to 2^-20 m, meet where they come to
    /// overlap by ¾ of 2^-20 m, and 2^-20 m at most: so shapes that touch and leave, slide or roll do not meet. Those that overlap more at the start
    /// meet at fraction 0. Shapes that overlap by less on their whole ways, as they only graze each other, do not meet. A segment of a chain is met
    /// from its outer side alone.
    ///
    /// Of several pairs of parts the first one counts, of several at one moment (2^-62) the one with the least numbers. Swapped
    /// shapes meet at the same moment, and so do mirror images.
    ///
    /// *Source* conservative advancement along the directions of largest distance, as in a step's [continuous
    /// collision](crate::guide::collisions). *Cost* some microseconds for each pair of parts whose ways are near each other. After 16,384 steps the
    /// moment that was reached counts: it takes grazing over many turns to come so far, and `distance` tells it.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Position`]; with [`Quantity::Query`] for a translation or a rotation, or for shapes that meet 2^20 m or
    /// more away from where the first one is then.
    ///
    /// ```
    /// use umbra_physics::{Fx, Shape, ShapeImpact, Sweep, fx, vec2};
    ///
    /// // A bar of 4 m by 0.2 m turns by a quarter while a ball comes up from below, 1 m to the right of its middle.
    /// let (bar, ball) = (Shape::rectangle(4, fx!(0.2))?, Shape::circle(fx!(0.25))?);
    /// let ball_sweep = Sweep { translation: vec2(0, 3), ..Sweep::at(vec2(1, -4), fx!(0)) };
    /// let turning = |rotation| Sweep { rotation, ..Sweep::default() };
    /// // At rest it is out of reach, and turned to the left its right end goes up. Turned to the right that end comes down to the ball.
    /// assert_eq!(bar.time_of_impact(&turning(fx!(0)), &ball, &ball_sweep)?, None);
    /// assert_eq!(bar.time_of_impact(&turning(Fx::FRAC_PI_2), &ball, &ball_sweep)?, None);
    /// let impact: Option<ShapeImpact> = bar.time_of_impact(&turning(-Fx::FRAC_PI_2), &ball, &ball_sweep)?;
    /// let impact = impact.unwrap();
    /// assert!(impact.fraction > fx!(0.65) && impact.fraction < fx!(0.68), "{}", impact.fraction);
    /// assert!(impact.distance.separation.abs() < fx!(0.0000001));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn time_of_impact(
        &self,
        sweep: &Sweep,
        shape: &Self,
        shape_sweep: &Sweep,
    ) -> Result<Option<ShapeImpact>, Error> {
        let legs = [sweep.leg()?, shape_sweep.leg()?];
        let moving = [MovingShape::new(self, &legs[0]), MovingShape::new(shape, &legs[1])];
        let (mut first, mut memory) = (None, Moment::default());
        for (i, (form_a, bounds_a)) in moving[0].outlines.iter().enumerate() {
            for (j, (form_b, bounds_b)) in moving[1].outlines.iter().enumerate() {
                let is_beside = |k: usize| bounds_a[1][k] < bounds_b[0][k] || bounds_b[1][k] < bounds_a[0][k];
                if is_beside(0) || is_beside(1) {
                    continue;
                }
                let paths = [from_ref(&legs[0]), from_ref(&legs[1])];
                let pair = sweep::Sweep { forms: [form_a, form_b], paths, second: Second::GivesWay };
                let moment = pair.time_of_impact(&mut memory);
                if let Some(moment) = moment.filter(|moment| first.is_none_or(|(first, _)| *moment < first)) {
                    first = Some((moment, [i, j]));
                }
            }
        }
        let Some((moment, [i, j])) = first else { return Ok(None) };
        let out_of_reach = Error::OutOfRange { quantity: Quantity::Query };
        let places = legs.map(|leg| leg.pose(moment));
        let from = places[0].0;
        let core = |outline: &Outline, (position, angle): (Point, Turn)| {
            Core::new(outline, &Placement::<Fx>::new(in_fx(position), angle), from).ok_or(out_of_reach)
        };
        let cores = [core(&self.outlines()[i], places[0])?, core(&shape.outlines()[j], places[1])?];
        let distance = CoreDistance::new(&cores[0], &cores[1], from, from_to(from, places[1].0));
        let distance = distance.seen_at(from, [i as u32, j as u32]);
        Ok(Some(ShapeImpact { fraction: in_parts(moment), distance }))
    }
}

/// The outlines of a shape on its way, each with the box around all of its places: low and high ends, ulps.
struct MovingShape<'a> {
    outlines: Vec<(Form<'a>, [Point; 2])>,
}

impl<'a> MovingShape<'a> {
    fn new(shape: &'a Shape, leg: &Leg) -> Self {
        let (start, angle) = leg.pose(0);
        let placement = Placement::<Fx>::new(in_fx(start), angle);
        let (end, _) = leg.pose(sweep::END);
        let outline = |outline: &'a Outline| {
            let around = Core::new(outline, &placement, start).filter(|_| !leg.turns()).map(|core| core.bounds());
            let reach = outline.reach().to_bits();
            // Rounding moves a corner by some ulps.
            let [min, max] = around.unwrap_or([[-reach; 2], [reach; 2]]);
            let (min, max) = (min.map(|part| part - MARGIN), max.map(|part| part + MARGIN));
            let low = beside(min, [0, 1].map(|k| start[k].min(end[k])));
            let high = beside(max, [0, 1].map(|k| start[k].max(end[k])));
            (Form::new(outline, outline.width(), shape.is_chain()), [low, high])
        };
        Self { outlines: shape.outlines().iter().map(outline).collect() }
    }
}

/// More than rounding moves an outline on its way, ulps.
const MARGIN: i64 = 64;
