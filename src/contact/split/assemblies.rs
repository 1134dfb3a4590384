//! Bodies that joints join, as loads on what they touch.

use alloc::vec::Vec;

use crate::fx::Fx;
use crate::solve::{Flight, Graph, Joint};

/// An assembly is a load on a body of another assembly if it has more than this times its mass.
const LOAD: i64 = 16;

/// The assemblies that joints make of bodies.
#[derive(Debug, Default)]
pub(super) struct Assemblies {
    /// Islands are assemblies; bodies without joints are in none.
    graph: Graph,
    /// By assembly, kg.
    masses: Vec<Fx>,
}

impl Assemblies {
    /// Finds the assemblies and their masses.
    pub(super) fn find(&mut self, flights: &[Flight], joints: &[Joint]) {
        let Self { graph, masses } = self;
        let is_fixed = |body: u32| flights[body as usize].is_fixed();
        graph.build_islands(is_fixed, flights.len(), joints.iter().map(|joint| joint.bodies));
        masses.clear();
        masses.resize(graph.islands(), Fx::ZERO);
        for (body, flight) in (0..).zip(flights) {
            if let Some(assembly) = graph.island_of(body) {
                let mass = &mut masses[assembly as usize];
                *mass = mass.saturating_add(flight.mass);
            }
        }
    }

    /// Returns true if bodies that joints join press on a much lighter assembly or body, or it on them, in a contact of these bodies.
    pub(super) fn are_load(&self, flights: &[Flight], bodies: [u32; 2]) -> bool {
        if bodies.iter().any(|&body| flights[body as usize].is_fixed()) {
            return false;
        }
        let [mass_a, mass_b] = bodies.map(|body| self.mass(flights, body));
        let (body, heavy, light) =
            if mass_a < mass_b { (bodies[1], mass_b, mass_a) } else { (bodies[0], mass_a, mass_b) };
        heavy.to_bits() / LOAD > light.to_bits() && self.graph.island_of(body).is_some()
    }

    /// The mass of the assembly of a body, or of a body without joints, kg.
    fn mass(&self, flights: &[Flight], body: u32) -> Fx {
        self.graph.island_of(body).map_or(flights[body as usize].mass, |assembly| self.masses[assembly as usize])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fx;
    use crate::math::Vec2;
    use crate::scalar::FxFactor;
    use crate::solve::{Impulses, JointKind, Velocity};

    /// A body of a mass; zero for a body that cannot be moved.
    fn flight(mass: Fx) -> Flight {
        let inverse = if mass == Fx::ZERO { FxFactor::ZERO } else { FxFactor::ONE.over(mass.into()) };
        Flight {
            position: Vec2::ZERO,
            start: Velocity::default(),
            end: Velocity::default(),
            displacement: Vec2::ZERO,
            rotation: Fx::ZERO,
            mass,
            inverse_mass: Vec2::new(inverse, inverse),
            inverse_inertia: inverse,
            radius: fx!(1),
            leader: None,
        }
    }

    fn pin(bodies: [u32; 2]) -> Joint {
        let kind = JointKind::Revolute;
        Joint { bodies, anchors: [Vec2::ZERO; 2], kind, axis: None, slides: [None; 2], impulses: Impulses::default() }
    }

    #[test]
    fn joined_bodies_are_a_load_by_the_sum_of_their_masses() {
        // Two pinned pairs of 17 kg, the second one to the ground as well, a pebble, a boulder, a crate.
        let masses = [0, 9, 8, 9, 8, 1, 100, 2].map(Fx::from);
        let flights = masses.map(flight);
        let mut assemblies = Assemblies::default();
        assemblies.find(&flights, &[pin([1, 2]), pin([3, 4]), pin([0, 3])]);
        let are_load = |bodies| assemblies.are_load(&flights, bodies);
        for bodies in [[1, 5], [5, 2], [4, 5]] {
            assert!(are_load(bodies), "17 kg and 1 kg: {bodies:?}");
        }
        assert!(!are_load([1, 7]), "17 kg and 2 kg");
        assert!(!are_load([1, 3]), "17 kg and 17 kg");
        assert!(!are_load([6, 5]), "a boulder has no joints");
        assert!(!are_load([0, 5]) && !are_load([1, 0]), "the ground");
        assert!(!are_load([1, 2]), "one assembly");
        let light = [1, 15, 1].map(|mass| flight(Fx::from(mass)));
        assemblies.find(&light, &[pin([0, 1])]);
        assert!(!assemblies.are_load(&light, [1, 2]), "16 kg and 1 kg");
    }
}
