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
        let end = [x - 4.0 * self.position[0] * TICK, y - 4.0 * self.position[1] * TICK];
        let of = body(self.mass as f64, 2.0, 0.5).flying([x, y, turn], TICK);
        let end = Velocity { linear: vec(end[0], end[1]), ..of.end };
        Flight { position: vec(self.position[0], self.position[1]), end, ..of }
    }

    /// Takes the flight and its correction.
    fn moved(&mut self, flight: &Flight, by: &Correction) {
        let part = |value: i128| value as f64 / 2f64.powi(96);
        let fixed = |value: Fx| value.to_bits() as f64 / 2f64.powi(32);
        let ends = [flight.end.linear.x, flight.end.linear.y, flight.end.angular].map(fixed);
        let changes = [by.velocity.x, by.velocity.y, by.angular_velocity].map(|v| part(v.to_bits()));
        self.velocity = [0, 1, 2].map(|i| ends[i] + changes[i]);
        let moved = [flight.displacement.x, flight.displacement.y].map(fixed);
        let corrected = [by.displacement.x, by.displacement.y].map(|d| part(d.to_bits()));
        (0..2).for_each(|i| self.position[i] += moved[i] + corrected[i]);
    }
}

/// Contacts of discs that are near, with the impulses of the step before.
fn contacts(discs: &[Disc], before: &[(u32, u32, Impulses)]) -> Vec<Contact> {
    let mut found = Vec::new();
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
            let known = before.iter().find(|&&(i, j, _)| (i, j) == (a, b)).map(|known| known.2);
            found.push(Contact {
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
                impulses: known.unwrap_or_default(),
            });
        }
    }
    found
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
    let (mut solver, mut corrections, mut before) = (Solver::default(), Vec::new(), Vec::new());
    let (mut sum, mut impulses, mut most_contacts) = ([0i128; 2], 0i128, 0);
    for tick in 1..=6000_i128 {
        let flights: Vec<Flight> = discs.iter().map(Disc::flight).collect();
        let mut scene = Scene::new(flights, contacts(&discs, &before));
        let Scene { time_step, options, flights, contacts } = &mut scene;
        solver.solve(*time_step, options, flights, &mut [], contacts, &mut corrections);
        for ((disc, by), flight) in discs.iter_mut().zip(&corrections).zip(flights.iter()) {
            let changes = [by.velocity.x, by.velocity.y].map(|v| disc.mass * v.to_bits());
            (0..2).for_each(|i| sum[i] += changes[i]);
            // Half of what all bodies get is at most the sum of impulses.
            impulses += changes.iter().map(|change| change.abs()).max().unwrap_or_default() / 2;
            disc.moved(flight, by);
        }
        before = contacts.iter().map(|of| (of.bodies[0], of.bodies[1], of.impulses)).collect();
        most_contacts = most_contacts.max(contacts.len());
        let masses: i128 = discs.iter().map(|disc| disc.mass).sum();
        let most = (impulses >> 63) + masses * tick;
        assert!(sum.iter().all(|sum| sum.abs() <= most), "tick {tick}: {sum:?} beyond {most}");
    }
    assert!(most_contacts > 60 && impulses >> 96 > 1000, "{most_contacts} contacts, {} N·s", impulses >> 96);
}
