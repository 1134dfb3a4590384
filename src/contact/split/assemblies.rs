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
