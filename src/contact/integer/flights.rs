//! The free flight of the bodies of a step, as the solver takes it.

use crate::body::BodyKind;
use crate::collide::Pose;
use crate::contact::{Scene, Start};
use crate::fx::Fx;
use crate::math::{TimeStep, Vec2};
use crate::scalar::{Accumulator as _, FxAccumulator, FxFactor, Turn};
use crate::solve::{Flight, Velocity};

/// 2π in ulps.
const TURN: i128 = 26_986_075_409;

/// The angle turned in a step, rad: the way between two angles, and as many whole turns as the velocities say.
fn turned(from: Turn, to: Turn, velocities: [FxAccumulator; 2], time_step: TimeStep) -> Fx {
    let way = i128::from(from.way_to(to).to_scalar().unwrap_or(Fx::ZERO).to_bits());
    let (num, den) = time_step.seconds();
    // Velocities are below 2^21 rad/s, a step takes at most a second: below 2^54 · 2^32. Up to 2 ulp more than the sum of the two.
    let most: u64 =
        velocities.iter().map(|velocity| (velocity.to_bits() >> 64) as i64).map(|v| v.unsigned_abs() + 1).sum();
    // A way and a mean velocity of at most a radian: no turn is between them.
    if way.unsigned_abs() <= 1 << 32 && u128::from(most) * u128::from(num) <= u128::from(den) << 33 {
        return Fx::from_bits(way as i64);
    }
    let sum: i128 = velocities.iter().map(|velocity| i128::from(velocity.value().to_bits())).sum();
    let about = sum * i128::from(num) / (2 * i128::from(den));
    let rest = about - way;
    let turns = (rest.abs() + TURN / 2) / TURN * rest.signum();
    Fx::from_bits((way + turns * TURN) as i64)
}

/// The flight of a moving body as far as it decides about contacts.
pub(super) fn moving(scene: &Scene<'_, Fx>, start: &Start<Fx>, pose: &Pose) -> Flight {
    let motion = &scene.bodies.columns.motion;
    let way = |from: FxAccumulator, to: FxAccumulator| to.plus(from.negated()).value();
    let end = motion.position.get(start.dense);
    let velocities = [start.angular_velocity, motion.angular_velocity[start.dense]];
    Flight {
        displacement: Vec2::new(way(start.position.x, end.x), way(start.position.y, end.y)),
        rotation: turned(start.angle, motion.angle[start.dense], velocities, scene.time_step),
        ..still(pose.position())
    }
}

/// Adds velocities and masses.
pub(super) fn complete(scene: &Scene<'_, Fx>, start: &Start<Fx>, flight: &mut Flight) {
    let (bodies, dense) = (scene.bodies, start.dense);
    let (motion, mass) = (&bodies.columns.motion, bodies.mass(dense));
    let velocity = |linear: Vec2<FxAccumulator>, angular: FxAccumulator| Velocity {
        linear: linear.map(FxAccumulator::value),
        angular: angular.value(),
    };
    flight.start = velocity(start.velocity, start.angular_velocity);
    flight.end = velocity(motion.velocity.get(dense), motion.angular_velocity[dense]);
    let info = bodies.info(dense);
    if info.kind == BodyKind::Dynamic {
        flight.mass = info.kilograms();
        flight.inertia = info.inertia_for(flight.mass);
    }
    (flight.inverse_mass, flight.inverse_inertia) = (mass.axis_inverse_mass, mass.inverse_inertia);
    let radii = scene.colliders.solid_of_slot(bodies.id(dense).slot).map(|collider| collider.radius);
    flight.radius = radii.max().unwrap_or(Fx::ONE);
}

/// The flight of a body that stands still.
pub(super) fn still(position: Vec2) -> Flight {
    Flight {
        position,
        start: Velocity::default(),
        end: Velocity::default(),
        displacement: Vec2::ZERO,
        rotation: Fx::ZERO,
        mass: Fx::ZERO,
        inertia: FxFactor::ZERO,
        inverse_mass: Vec2::new(FxFactor::ZERO, FxFactor::ZERO),
        inverse_inertia: FxFactor::ZERO,
        radius: Fx::ONE,
        leader: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Angle as _;

    /// A constant rotation has the angle that its velocity says, over any number of turns: within half an ulp for each, as 2π is in ulps.
    #[test]
    fn whole_turns_follow_the_velocities() {
        for (num, den) in [(1, 60), (1, 1), (1, 1000), (7, 240)] {
            // From 10^-8 to 2^21 rad/s.
            let speeds = core::iter::successors(Some(43_i64), |&speed| Some(speed + speed / 4));
            for speed in speeds.take_while(|&speed| speed < 1 << 53).flat_map(|speed| [speed, -speed]) {
                let expected = i128::from(speed) * num / den;
                let from = Turn::from_radians(crate::fx!(2.5));
                let to = from.turned(FxAccumulator::from_scalar(Fx::from_bits(expected as i64)));
                let way = turned(
                    from,
                    to,
                    [FxAccumulator::from_scalar(Fx::from_bits(speed)); 2],
                    TimeStep::ratio(num as u32, den as u32),
                );
                let error = (i128::from(way.to_bits()) - expected).abs();
                assert!(error <= 2 + expected.abs() / TURN, "{speed} for {num}/{den} s: {way}");
            }
        }
    }
}
