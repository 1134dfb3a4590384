//! Conservation of momentum: impulses are equal and opposite.

use alloc::vec::Vec;

use super::scene::{Scene, body, fx, signed, vec};
use crate::cases::run_seed;
use crate::fx::Fx;
use crate::math::{Random, Vec2};
use crate::solve::{Contact, Correction, Flight, Impulses, Point, Solver, Velocity};

const TICK: f64 = 1.0 / 60.0;

/// A disc of radius 0.5 m.
struct Disc {
    mass: i128,
    position: [f64; 2],
    velocity: [f64; 3],
}

impl Disc {
    /// The free flight towards the origin.
    fn flight(&self) -> Flight {
        let [x, y, turn] = self.velocity;
        let linear = vec(x - 4.0 * self.position[0] * TICK, y - 4.0 * self.position[1] * TICK);
        let flight = body(self.mass as f64, 2.0, 0.5).flying([x, y, turn], TICK);
        let end = Velocity { linear, ..flight.end };
        Flight { position: vec(self.position[0], self.position[1]), end, ..flight }
    }

    /// Moves the disc by its flight and the correction of the flight.
    fn advance(&mut self, flight: &Flight, correction: &Correction) {
        let exact = |value: i128| value as f64 / 2f64.powi(96);
        let fixed = |value: Fx| value.to_bits() as f64 / 2f64.powi(32);
        let ends = [flight.end.linear.x, flight.end.linear.y, flight.end.angular].map(fixed);
        let changes = [correction.velocity.x, correction.velocity.y, correction.angular_velocity];
        let changes = changes.map(|v| exact(v.to_bits()));
        self.velocity = [0, 1, 2].map(|i| ends[i] + changes[i]);
        let free = [flight.displacement.x, flight.displacement.y].map(fixed);
        let corrected = [correction.displacement.x, correction.displacement.y].map(|d| exact(d.to_bits()));
        (0..2).for_each(|i| self.position[i] += free[i] + corrected[i]);
    }
}

/// The contacts of discs near each other, with their impulses from the previous step.
fn contacts(discs: &[Disc], previous_impulses: &[(u32, u32, Impulses)]) -> Vec<Contact> {
    let mut contacts = Vec::new();
    for b in 0..discs.len() as u32 {
        for a in 0..b {
            let [from, to] = [a, b].map(|i| discs[i as usize].position);
            let [x, y] = [to[0] - from[0], to[1] - from[1]];
            let distance = x.hypot(y);
            if distance > 1.3 {
                continue;
            }
            let [nx, ny] = [x / distance, y / distance];
            let arms = [vec(0.5 * nx, 0.5 * ny), vec(-0.5 * nx, -0.5 * ny)];
            let previous = previous_impulses.iter().find(|&&(i, j, _)| (i, j) == (a, b));
            contacts.push(Contact {
                bodies: [a, b],
                normal: [nx, ny].map(|n| (n * f64::from(1 << 30)).round() as i32),
                count: 1,
                points: [
                    Point { arms, separation: fx(distance - 1.0) },
                    Point { arms: [Vec2::default(); 2], ..Point::default() },
                ],
                friction: fx(0.5),
                restitution: fx(0.5),
                rolling_resistance: fx(0.0),
                rolling_radius: fx(0.0),
                surface_speed: fx(0.0),
                impulses: previous.map(|&(.., impulses)| impulses).unwrap_or_default(),
            });
        }
    }
    contacts
}

#[test]
fn a_pile_keeps_its_momentum() {
    let mut random = Random::seeded(run_seed(1));
    let mut discs: Vec<Disc> = (0..40)
        .map(|i| Disc {
            mass: if i % 2 == 0 { 1 } else { 3 },
            position: [0; 2].map(|_| 6.0 * signed(&mut random)),
            velocity: [0; 3].map(|_| 4.0 * signed(&mut random)),
        })
        .collect();
    let mut solver = Solver::default();
    let mut corrections = Vec::new();
    let mut previous_impulses = Vec::new();
    let mut momentum_change = [0i128; 2];
    let mut impulse_sum = 0i128;
    let mut max_contacts = 0;
    for tick in 1..=6000_i128 {
        let flights: Vec<Flight> = discs.iter().map(Disc::flight).collect();
        let mut scene = Scene::new(flights, contacts(&discs, &previous_impulses));
        let Scene { time_step, options, flights, contacts } = &mut scene;
        solver.solve(*time_step, options, flights, &mut [], contacts, &mut corrections);
        for ((disc, correction), flight) in discs.iter_mut().zip(&corrections).zip(flights.iter()) {
            let changes = [correction.velocity.x, correction.velocity.y].map(|v| disc.mass * v.to_bits());
            (0..2).for_each(|i| momentum_change[i] += changes[i]);
            // Half of the changes of momentum of all bodies is at most the sum of impulses.
            impulse_sum += changes.iter().map(|change| change.abs()).max().unwrap_or_default() / 2;
            disc.advance(flight, correction);
        }
        previous_impulses =
            contacts.iter().map(|contact| (contact.bodies[0], contact.bodies[1], contact.impulses)).collect();
        max_contacts = max_contacts.max(contacts.len());
        let masses: i128 = discs.iter().map(|disc| disc.mass).sum();
        let limit = (impulse_sum >> 63) + masses * tick;
        let is_conserved = momentum_change.iter().all(|change| change.abs() <= limit);
        assert!(is_conserved, "tick {tick}: {momentum_change:?} beyond {limit}");
    }
    assert!(max_contacts > 60 && impulse_sum >> 96 > 1000, "{max_contacts} contacts, {} N·s", impulse_sum >> 96);
}
