//! Pushing bodies.

use alloc::vec::Vec;

use super::result::{CharacterHit, Movement};
use super::settings::Character;
use super::step::is_pushed;
use crate::math::Vec2;
use crate::scalar::{Factor as _, Scalar, Wide as _};
use crate::world::{ApplyOptions, Command, ForceOrImpulse, World};

impl<S: Scalar> Character<S> {
    /// The impulses with which a movement pushes the dynamic bodies that it met, as commands to execute and to record.
    ///
    /// The character counts as a body with the mass M = [`push_mass`](Self::push_mass) that moves by its desired translation in a step of
    /// the world. If it approaches a body of mass m and inertia I with the speed v along the normal n, at a point r from the body's centre
    /// of mass, the impulse is v / (1/M + 1/m + (r × n)²/I), as in an impact without bounce. The point is the one nearest to the centre of
    /// mass, along the surface, of the stretch in which they face each other with a gap that differs by less than a skin: a side that is
    /// pushed beside the centre does not turn. Each body gets one impulse: the greatest, or of equal ones the impulse of the first hit.
    /// With a push mass of 0 there are none.
    ///
    /// A dynamic body below gets one too: with gravity in the translation it is pressed in each tick, and it and its island stay awake. Take
    /// hits whose normal points up out of [`Movement::hits`] if you do not want that.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, Character, Mass, QueryFilter, Shape, TimeStep, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef { time_step: TimeStep::hz(64), ..WorldDef::default() })?;
    /// let def = BodyDef { mass: Mass::Kilograms(fx!(20)), ..BodyDef::dynamic().with_collider(Shape::rectangle(1, 1)?) };
    /// let crate_ = world.add_body(def)?;
    /// let hero = Character { push_mass: fx!(60), ..Character::new(Shape::rectangle(1, 1)?) };
    /// // It walks against the crate with 4 m/s.
    /// let all = QueryFilter::default();
    /// let moved = hero.translate(&world.queries(), vec2(fx!(-1.015625), 0), None, vec2(fx!(0.0625), 0), &all)?;
    /// for command in hero.push(&world, &moved) {
    ///     world.execute(&command)?;
    /// }
    /// assert_eq!(world.body(crate_)?.velocity(), vec2(3, 0)); // 4·60/(60 + 20)
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[must_use]
    pub fn push(&self, world: &World<S>, movement: &Movement<S>) -> Vec<Command<S>> {
        let mut pushes: Vec<(_, S, Command<S>)> = Vec::new();
        if self.push_mass <= S::ZERO {
            return Vec::new();
        }
        for hit in movement.hits.iter().filter(|hit| is_pushed(world, hit.body)) {
            let Some((size, impulse, point)) = self.impulse(world, movement, hit) else { continue };
            let action = ForceOrImpulse::Impulse { impulse, point: Some(point) };
            let command = Command::Apply { body: hit.body, action, options: ApplyOptions::default() };
            match pushes.iter_mut().find(|(body, ..)| *body == hit.body) {
                Some(push) if size > push.1 => *push = (hit.body, size, command),
                Some(_) => {}
                None => pushes.push((hit.body, size, command)),
            }
        }
        pushes.into_iter().map(|(.., command)| command).collect()
    }

    /// The size of the impulse of a hit, the impulse, and the point where it acts; `None` if the character does not approach the body, or a
    /// value does not fit.
    fn impulse(
        &self,
        world: &World<S>,
        movement: &Movement<S>,
        hit: &CharacterHit<S>,
    ) -> Option<(S, Vec2<S>, Vec2<S>)> {
        let body = world.body(hit.body).ok()?;
        let (num, den) = world.def().time_step.seconds();
        let rate = S::Factor::from_ratio(u64::from(den), u64::from(num));
        let dot = |a: Vec2<S>, b: Vec2<S>| a.x.product(b.x).plus(a.y.product(b.y));
        let normal = hit.normal;
        let point = point_of_push(hit, body.position())?;
        let body_velocity = body.velocity_at(point)?;
        let towards = dot(movement.desired, normal)?.times(rate)?.negated();
        let speed = towards.plus(dot(body_velocity, normal)?)?;
        if speed.is_negative() {
            return None;
        }
        let centre = body.position();
        let arm = Vec2::new(point.x.offset(centre.x).to_scalar()?, point.y.offset(centre.y).to_scalar()?);
        let lever = arm.x.product(normal.y).plus(arm.y.product(normal.x).negated())?;
        let lever = S::Factor::from_wide(lever);
        let turning = lever.times(lever).times(body.inverse_inertia());
        let inverse_push_mass = S::Factor::from_ratio(1, 1).over(S::Factor::from_scalar(self.push_mass));
        let inverse_mass = inverse_push_mass.plus(body.inverse_mass()).plus(turning);
        let size = S::Factor::from_wide(speed).over(inverse_mass).to_scalar()?;
        let part = |n: S| n.times(size);
        let impulse = Vec2::new(part(normal.x)?, part(normal.y)?).map(|part| S::ZERO.offset(part).to_scalar());
        Some((size, Vec2::new(impulse.x?, impulse.y?), point))
    }
}

/// The point of the stretch in which a character touches a body that is nearest to the line through the centre of mass along the normal.
/// Two faces that press on each other leave no approach at either end of it: beside the centre the body moves without a turn.
fn point_of_push<S: Scalar>(hit: &CharacterHit<S>, centre: Vec2<S>) -> Option<Vec2<S>> {
    let tangent = Vec2::new(S::ZERO - hit.normal.y, hit.normal.x);
    let away = Vec2::new(centre.x.offset(hit.point.x).to_scalar()?, centre.y.offset(hit.point.y).to_scalar()?);
    let centre = away.x.product(tangent.x).plus(away.y.product(tangent.y))?.to_scalar()?;
    let [low, high] = hit.stretch;
    let shift = if centre < low {
        low
    } else if centre > high {
        high
    } else {
        centre
    };
    let component = |start: S, tangent: S| tangent.product(shift).plus(S::Wide::from_scalar(start))?.to_scalar();
    Some(Vec2::new(component(hit.point.x, tangent.x)?, component(hit.point.y, tangent.y)?))
}
