//! Bodies that impulses send elsewhere within a step, and the contacts that they meet on their new ways.
//!
//! Reads: flights, corrections. Writes: the flights that are deflected; [`pipeline`](super::pipeline) finds the contacts on their ways.
//!
//! Contacts are found on free flights. A body that an impact turns aside or sets in motion may meet another one that its free flight
//! does not: so after the solver has run, the paths of these bodies are tested for the moments at which they meet bodies
//! without a contact, these contacts are added, and their islands are solved again from the start of the step, up to [`ROUNDS`] times. The
//! set of contacts only grows, and is a function of the scene. Only bodies that are deflected still after all rounds are swept as bullets
//! are: they stop at the bodies that they meet, and have the impact in the next step. (Bodies of a pile, whose contacts the solver has,
//! would stop at each other for ever.)
//!
//! An island is solved again as a whole, and in a crowd some body meets another one in each step: bodies of large islands have no contacts with
//! bodies that they meet on new ways before the next step. They overlap by at most the rest of their ways then, as all bodies do where contacts are
//! looked for once a step.

use alloc::vec::Vec;

use super::again::Again;
use super::flights::{FlightKind, Flights};
use super::{Correction, Scene};
use crate::fx::Fx;
use crate::math::Vec2;
use crate::scalar::FxAccumulator;
use crate::solve::{Contact, Joint};

/// Bodies of which impulses change the way by less than this, 1 mm, are not deflected: they overlap by no more in the next step.
const DEFLECTION: i64 = 1 << 22;

/// The most times that the solver runs again in a step.
pub(crate) const ROUNDS: u32 = 8;

/// Lists the flights of bodies that are deflected. Bodies whose paths have not changed since the last time are left out: they meet nothing new.
/// So are bodies of large islands.
pub(super) fn list_deflected(
    scene: &Scene<'_>,
    corrections: &[Correction],
    flights: &Flights,
    joints: &[Joint],
    contacts: &[Contact],
    again: &mut Again,
    deflected: &mut Vec<u32>,
) {
    deflected.clear();
    match again.solved_flights() {
        None => {
            let all = (0..).zip(corrections);
            deflected.extend(
                all.filter(|&(flight, change)| is_deflected(scene, flights, flight, change)).map(|(flight, _)| flight),
            );
        }
        Some(solved) => {
            deflected.extend(solved.filter(|&flight| {
                let change = corrections.get(flight as usize);
                change.is_some_and(|change| is_deflected(scene, flights, flight, change))
            }));
            deflected.sort_unstable();
        }
    }
    if !deflected.is_empty() {
        again.count_bodies(flights, joints, contacts);
        deflected.retain(|&flight| !again.is_in_large_island(flight));
    }
}

/// Returns true for a dynamic body that moves, and of which impulses change the way: it is neither the way of the free flight nor, for bodies
/// that another one carries, the way at the velocity of the start.
fn is_deflected(scene: &Scene<'_>, flights: &Flights, flight: u32, correction: &Correction) -> bool {
    if !correction.is_pushed || flights.body(flight).kind != FlightKind::Dynamic {
        return false;
    }
    let free = flights.flight(flight).displacement;
    // Most bodies that are pushed stay where they are: both parts of the way are below a half, within an ulp.
    let stays = |free: Fx, change: FxAccumulator| {
        let way = free.to_bits().saturating_add((change.to_bits() >> 64) as i64);
        way.saturating_abs() < DEFLECTION / 2 - 1
    };
    if stays(free.x, correction.displacement.x) && stays(free.y, correction.displacement.y) {
        return false;
    }
    let change = correction.displacement.map(FxAccumulator::value);
    let way = Vec2::new(free.x.saturating_add(change.x), free.y.saturating_add(change.y));
    if size(way) <= DEFLECTION || size(change) <= DEFLECTION {
        return false;
    }
    let steady = flights.steady_way(&scene.starts[flight as usize]);
    size(Vec2::new(way.x.saturating_sub(steady.x), way.y.saturating_sub(steady.y))) > DEFLECTION
}

/// A bound of the length of a vector, ulps: at most an eighth above it.
fn size(vector: Vec2) -> i64 {
    let [x, y] = [vector.x, vector.y].map(|part| part.to_bits().saturating_abs());
    x.max(y).saturating_add(x.min(y) / 2)
}
