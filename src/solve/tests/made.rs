//! Random scenes.

use alloc::vec::Vec;

use super::scene::{Scene, body, by_exponent, contact, fixed, fx, signed, unit};
use crate::fx::Fx;
use crate::math::{Random, TimeStep};
use crate::scalar::FxFactor;
use crate::solve::{Contact, Flight, Impulses};

/// The ranges of random quantities.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ranges {
    /// log2 of masses, kg.
    pub(super) mass: [f64; 2],
    /// R²·m/I.
    pub(super) gyration: [f64; 2],
    /// log2 of radii, m.
    pub(super) radius: [f64; 2],
    /// m/s
    pub(super) speed: f64,
    /// Separations, m.
    pub(super) separation: [f64; 2],
    pub(super) restitution: f64,
    /// Impulses of the previous step, N·s.
    pub(super) impulse: f64,
}

impl Default for Ranges {
    fn default() -> Self {
        Self {
            mass: [-4.0, 4.0],
            gyration: [1.0, 4.0],
            radius: [-2.0, 1.0],
            speed: 8.0,
            separation: [-0.05, 0.05],
            restitution: 0.0,
            impulse: 0.5,
        }
    }
}

fn within(random: &mut Random, [low, high]: [f64; 2]) -> f64 {
    low + (high - low) * unit(random)
}

impl Ranges {
    pub(super) fn flight(&self, random: &mut Random, seconds: f64) -> Flight {
        let radius = by_exponent(random, self.radius[0], self.radius[1]);
        let gyration = within(random, self.gyration);
        let resting = body(by_exponent(random, self.mass[0], self.mass[1]), gyration, radius);
        let [x, y, turn] = [0; 3].map(|_| self.speed * signed(random));
        let flight = resting.flying([x, y, turn / radius], seconds);
        // The field of a step.
        let mut end = flight.end;
        end.linear.y = end.linear.y.saturating_sub(fx(9.81 * seconds));
        let position = super::scene::vec(4.0 * signed(random), 4.0 * signed(random));
        Flight { end, position, ..flight }
    }

    /// A contact with points anywhere on both bodies.
    pub(super) fn contact(&self, random: &mut Random, bodies: [u32; 2], flights: &[Flight]) -> Contact {
        let angle = core::f64::consts::TAU * unit(random);
        let radii = bodies.map(|body| flights[body as usize].radius.to_bits() as f64 / 2f64.powi(32));
        let points = [0; 2].map(|_| {
            let [a, b] = radii.map(|radius| [0; 2].map(|_| 0.7 * radius * signed(random)));
            (a, b, within(random, self.separation))
        });
        let count = 1 + random.below(2) as usize;
        let mut contact = contact(bodies, [angle.cos(), angle.sin()], &points[..count]);
        contact.friction = fx(if random.below(3) == 0 { 0.0 } else { unit(random) });
        contact.restitution = fx(self.restitution * unit(random));
        if count == 1 && random.below(2) == 0 {
            contact.rolling_resistance = fx(unit(random));
            contact.rolling_radius = fx(radii[0].min(radii[1]) * (0.01 + unit(random)));
        }
        if random.below(4) == 0 {
            contact.surface_speed = fx(signed(random));
        }
        if random.below(2) == 0 {
            let values = [unit(random), unit(random), 0.3 * signed(random)];
            let values = values.map(|value| (value * self.impulse * 2f64.powi(24)) as i64);
            contact.impulses =
                Impulses { values: [values[0], if count == 2 { values[1] } else { 0 }, values[2]], exponent: -24 };
            if contact.rolling_resistance > Fx::ZERO {
                contact.impulses.values[1] = ((contact.rolling_resistance.to_bits() as f64 / 2f64.powi(32))
                    * signed(random)
                    * values[0] as f64) as i64;
            }
        }
        contact
    }

    /// Bodies, one in six of them fixed, with contacts between any two.
    pub(super) fn scene(&self, random: &mut Random, body_count: usize, contact_count: usize) -> Scene {
        let mut flights: Vec<Flight> = Vec::new();
        let seconds = 1.0 / 60.0;
        for index in 0..body_count {
            let flight = self.flight(random, seconds);
            // At least one body can be moved.
            let kind = random.below(12) + if index == 0 { 12 } else { 0 };
            flights.push(match kind {
                0 => fixed(4.0),
                2 => Flight { inverse_inertia: FxFactor::ZERO, ..flight },
                // A fixed body that moves.
                1 => Flight { radius: fx(4.0), ..fixed(4.0).flying([signed(random), signed(random), 0.25], seconds) },
                _ => flight,
            });
        }
        let mut contacts = Vec::new();
        while contacts.len() < contact_count {
            let pair = [0; 2].map(|_| random.below(body_count as u64) as u32);
            let is_fixed = pair.map(|body| flights[body as usize].is_fixed());
            if pair[0] != pair[1] && is_fixed != [true; 2] {
                contacts.push(self.contact(random, pair, &flights));
            }
        }
        Scene { time_step: TimeStep::hz(60), ..Scene::new(flights, contacts) }
    }
}
