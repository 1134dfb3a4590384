//! Contacts: bodies that come to rest, that meet in free flight, and at the ends of the ranges.

use super::contact_bodies::{Bodies, Body, RATE};
use super::trial::{Numbers, Played, Trial, happened, near, same};
use crate::error::Error;
use crate::fx::{Fx, fx};
use crate::math::{Vec2, vec2};
use crate::scalar::{FxAccumulator, Turn};
use crate::shape::Shape;
use crate::solve::{SolverOptions, Velocity};

/// Checks that bodies are mirror images: of each other in the pairs from number 1 to `end`, the others of themselves.
fn mirrored(bodies: &[Body], end: usize) -> Played {
    for (i, body) in bodies.iter().enumerate() {
        let image = if (1..end).contains(&i) { ((i - 1) ^ 1) + 1 } else { i };
        same("bodies and their mirror images", &bodies[image].bits(), &body.mirrored().bits())?;
    }
    Ok(())
}

/// A floor below y = 0, walls at x = ±3, and what falls between them: pairs, but for the floor and the last two bodies.
fn pile_of_bodies() -> Result<Bodies, Error> {
    let mut pile = Bodies::new(fx!(-9.8125), fx!(0.5), fx!(0.25));
    pile.bodies.push(Body::new(Shape::rectangle(8, 1)?, 0, vec2(0, fx!(-0.5))));
    pile.push_with_image(Body::new(Shape::rectangle(1, 8)?, 0, vec2(fx!(3.5), 3)));
    let mut numbers = Numbers(40);
    for i in 0..14 {
        let shape = if i % 3 == 2 { Shape::circle(fx!(0.25))? } else { Shape::rectangle(fx!(0.625), fx!(0.5))? };
        let place = vec2(fx!(0.75) * (1 + i % 3) + numbers.fx(0) / 16, fx!(0.5) + fx!(0.625) * (i / 3));
        let mut body = Body::new(shape, 1 + i % 4, place);
        body.angle = Turn::from_radians(numbers.fx(0) / 8);
        pile.push_with_image(body.moving(Vec2::new(numbers.fx(0), Fx::ZERO), numbers.fx(0)));
    }
    let wedge = Shape::polygon(&[vec2(fx!(-0.375), 0), vec2(fx!(0.375), 0), vec2(0, fx!(0.5))])?;
    pile.bodies.push(Body::new(wedge, 2, vec2(0, fx!(0.5))));
    pile.bodies.push(Body::new(Shape::circle(fx!(0.25))?, 1, vec2(0, 2)));
    Ok(pile)
}

pub(super) fn pile(trial: &mut Trial) -> Played {
    let mut pile = pile_of_bodies()?;
    let middle = pile.bodies.len() - 2;
    let mut most_contacts = 0;
    let mut deepest = Fx::ZERO;
    for _ in 0..256 {
        pile.step(trial);
        mirrored(&pile.bodies, middle)?;
        most_contacts = most_contacts.max(pile.touches.len());
        let points = pile.touches.iter().flat_map(|(contact, _)| &contact.points[..contact.count]);
        deepest = points.fold(deepest, |deepest, point| deepest.min(point.separation));
    }
    happened("bodies overlap by less than 2 cm", deepest > fx!(-0.02))?;
    let mut mass = 0;
    for body in &pile.bodies[3..] {
        let (Velocity { linear, angular }, position) =
            (body.public_velocity(), body.position.map(FxAccumulator::value));
        happened("rest", [linear.x, linear.y, angular].iter().all(|speed| speed.abs() < fx!(0.05)))?;
        happened("all on the floor and between the walls", position.y > Fx::ZERO && position.x.abs() < fx!(3))?;
        mass += i128::from(body.mass);
    }
    // At rest, what is fixed carries the weight: to 1 %, for what still creeps.
    let substeps = RATE * i64::from(SolverOptions::default().substeps);
    let weight = i128::from(-pile.gravity.to_bits()) * (mass << 32) / i128::from(substeps);
    near("upward impulse of floor and walls", pile.support(), weight, weight.unsigned_abs() / 100)?;
    happened("many contacts", most_contacts > 40 && pile.cut == 0)
}

pub(super) fn cluster(trial: &mut Trial) -> Played {
    let mut cluster = Bodies::new(Fx::ZERO, fx!(0.5), fx!(0.5));
    let mut numbers = Numbers(41);
    for i in 0..25 {
        let shape = if i % 2 == 0 { Shape::circle(fx!(0.375))? } else { Shape::rectangle(fx!(0.75), fx!(0.5))? };
        let place = vec2(i % 5 - 2, i / 5 - 2);
        // Towards the middle.
        let velocity = numbers.vec(0) - place * 2;
        cluster.bodies.push(Body::new(shape, 1 + i % 3, place).moving(velocity, numbers.fx(1)));
    }
    let masses: i128 = cluster.bodies.iter().map(|body| i128::from(body.mass)).sum();
    let (mut exchanged, mut most_contacts) = (0, 0);
    for _ in 0..120 {
        cluster.step(trial);
        let (gained, moved) = cluster.momentum_gained();
        // Impulses are equal and opposite. 1/m is rounded to 2^-63 of it, and Δv to 2^-96 m/s.
        let bound = ((moved >> 63) + masses).unsigned_abs();
        near("momentum along x", gained[0], 0, bound)?;
        near("momentum along y", gained[1], 0, bound)?;
        exchanged += moved >> 96;
        most_contacts = most_contacts.max(cluster.touches.len());
    }
    happened("momentum exchanged at many contacts", exchanged > 50 && most_contacts > 20 && cluster.cut == 0)
}

/// Heavy discs fall fast on light discs, needles and plates above a floor that rises, between paddles that turn; and a shot from
/// either side. Pairs, but for the floor and the last body.
fn extreme_bodies() -> Result<Bodies, Error> {
    let mut all = Bodies::new(fx!(-9.8125), fx!(0.5), fx!(0.75));
    all.bodies.push(Body::new(Shape::rectangle(64, 1)?, 0, vec2(0, fx!(-0.5))).moving(vec2(0, 1), Fx::ZERO));
    all.push_with_image(Body::new(Shape::rectangle(6, fx!(0.5))?, 0, vec2(8, 3)).moving(vec2(0, 0), fx!(8)));
    let mut numbers = Numbers(42);
    for i in 0..8 {
        let place = vec2(fx!(0.875) * (1 + i), fx!(0.25)) + numbers.vec(0) / 8;
        let (light, mass) = match i % 4 {
            0 => (Shape::circle(fx!(0.0625))?, 1),
            1 => (Shape::rectangle(2, fx!(1 / 64))?, 3),
            2 => (Shape::rectangle(fx!(1 / 128), fx!(0.5))?, 1),
            _ => (Shape::rectangle(fx!(0.5), fx!(0.25))?, 5000),
        };
        all.push_with_image(Body::new(light, mass, place).moving(numbers.vec(1), numbers.fx(4)));
        let heavy = Body::new(Shape::circle(fx!(0.5))?, 1 << (23 - 2 * i), place + vec2(0, 2));
        all.push_with_image(heavy.moving(vec2(0, -(1024 >> i)), numbers.fx(6)));
    }
    let shot = Body::new(Shape::circle(fx!(0.25))?, 1, vec2(4000, 1));
    all.push_with_image(shot.moving(vec2(-16_384, 0), fx!(1000)));
    all.bodies.push(Body::new(Shape::rectangle(fx!(0.5), 4)?, 16_777_216, vec2(0, 3)));
    Ok(all)
}

pub(super) fn extremes(trial: &mut Trial) -> Played {
    let (mut bodies, mut twin) = (extreme_bodies()?, extreme_bodies()?);
    twin.bodies.reverse();
    let last = bodies.bodies.len() - 1;
    let mut most_contacts = 0;
    let mut were_hit = false;
    for _ in 0..128 {
        bodies.step(trial);
        twin.step_alone();
        mirrored(&bodies.bodies, last)?;
        for (body, twin) in bodies.bodies.iter().zip(twin.bodies.iter().rev()) {
            same("bodies and those in another order", &body.bits(), &twin.bits())?;
        }
        most_contacts = most_contacts.max(bodies.touches.len());
        were_hit |= bodies.touches.iter().any(|(contact, _)| contact.bodies.contains(&(last as u32 - 1)));
    }
    same("counts of values cut off", &bodies.cut, &twin.cut)?;
    happened("many contacts, and shots that hit", most_contacts > 30 && were_hit)
}
