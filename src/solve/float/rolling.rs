//! Rolling resistance in floats, as in integers: the rows of a phase after its friction.

use alloc::vec::Vec;

use super::body::Body;
use super::number::{Float, Pair};
use super::rows::{Contact, Pass, Rows};

/// A contact that resists rolling: its impulse acts at the lever R.
#[derive(Debug)]
pub(super) struct Roll {
    /// The number of its contact, and that of its rows in the phase.
    contact: u32,
    rows: usize,
    bodies: [u32; 2],
    radius: f64,
    coefficient: f64,
    /// One over the change of the velocity R·(ω_b − ω_a) by the impulse.
    inverse: f64,
    impulse: f64,
    applied: f64,
    weighted: f64,
}

impl Roll {
    /// The rows of a phase that resist rolling, with those that friction has there.
    pub(super) fn list(out: &mut Vec<Self>, rows: &[Rows], contacts: &[Contact], bodies: &[Body]) {
        let zero = 0.0;
        out.clear();
        let resists =
            |of: &Contact| of.manifold.count == 1 && of.rolling_resistance > zero && of.rolling_radius > zero;
        for (at, row) in rows.iter().enumerate() {
            let contact = &contacts[row.contact as usize];
            if resists(contact) {
                out.push(Self {
                    contact: row.contact,
                    rows: at,
                    bodies: row.bodies,
                    radius: contact.rolling_radius,
                    coefficient: contact.rolling_resistance,
                    inverse: zero,
                    impulse: contact.impulses[1],
                    applied: zero,
                    weighted: zero,
                });
            }
        }
        // The number of rows by body: a phase has few of them.
        let share = |body: u32| F::of(out.iter().filter(|roll| roll.bodies.contains(&body)).count() as f64);
        let inverse = |roll: &Self| {
            let of = |body: u32| share(body) * bodies[body as usize].inverse[2];
            1.0 / (roll.radius * roll.radius * (of(roll.bodies[0]) + of(roll.bodies[1])))
        };
        let inverses: Vec<f64> = out.iter().map(inverse).collect();
        out.iter_mut().zip(inverses).for_each(|(roll, inverse)| roll.inverse = inverse);
        out.retain(|roll| roll.inverse.is_finite());
    }

    /// A pass over the rows of a phase.
    pub(super) fn run(rolls: &mut [Self], rows: &[Rows], bodies: &mut [Body], pass: Pass) {
        if pass == Pass::Solve {
            return;
        }
        for roll in rolls.iter_mut() {
            let before = roll.impulse;
            let mut change = before;
            if pass == Pass::Relax {
                let [a, b] = roll.bodies.map(|body| bodies[body as usize].velocity[2]);
                let wanted = before - roll.radius * (b - a) * roll.inverse;
                roll.impulse = wanted.within(roll.coefficient * rows[roll.rows].impulses[0]);
                roll.weighted += roll.applied + before;
                roll.applied += roll.impulse;
                change = roll.impulse - before;
            }
            roll.push(change, |body, turn| {
                let body = &mut bodies[body as usize];
                body.add_gain([0.0, 0.0, turn * body.inverse[2]]);
            });
        }
        for body in rolls.iter().flat_map(|roll| roll.bodies) {
            bodies[body as usize].take_gain();
        }
    }

    /// Writes the impulses, and adds the sums of bodies.
    pub(super) fn apply(rolls: &[Self], rows: &[Rows], contacts: &mut [Contact], bodies: &mut [Body]) {
        for roll in rolls {
            // A contact that bounced starts with a smaller normal impulse.
            let limit = roll.coefficient * rows[roll.rows].impulses[0];
            contacts[roll.contact as usize].impulses[1] = roll.impulse.within(limit);
            roll.push(roll.applied, |body, turn| bodies[body as usize].applied[2] += turn);
            roll.push(roll.weighted, |body, turn| bodies[body as usize].weighted[2] += turn);
        }
    }

    /// The angular impulses on both bodies.
    fn push(&self, impulse: f64, mut add: impl FnMut(u32, f64)) {
        let turn = self.radius * impulse;
        let turns: Pair = [-turn, turn];
        self.bodies.into_iter().zip(turns).for_each(|(body, turn)| add(body, turn));
    }
}
