//! Heavy loads: bodies on top of much lighter ones.

use super::Flight;
use crate::fx::Fx;

/// A load is heavy if a body on top has more than this times the mass of the one that carries it.
const HEAVY: i64 = 64;

/// Returns true for a mass in kg that is a heavy load on another one.
pub(crate) fn is_heavy(load: Fx, mass: Fx) -> bool {
    // Masses are at most 2^56 ulps: a product is at most 2^62.
    load.to_bits() > mass.to_bits() * HEAVY
}

/// Returns true if masses differ by so much that one may be a heavy load. In most worlds they do not.
pub(crate) fn may_be_heavy(flights: &[Flight]) -> bool {
    let (mut min_mass, mut max_mass) = (Fx::MAX, Fx::ZERO);
    // Bodies without contacts and joints count as well, if their masses are known: the loads are found later.
    for mass in flights.iter().map(|flight| flight.mass).filter(|&mass| mass > Fx::ZERO) {
        (min_mass, max_mass) = (min_mass.min(mass), max_mass.max(mass));
    }
    min_mass < max_mass && is_heavy(max_mass, min_mass)
}
