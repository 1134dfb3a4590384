//! Bodies that impulses send elsewhere within a step, and the contacts that they meet on their new ways.
//!
//! Contacts are found on free flights. A body that an impact turns aside or sets in motion may meet another one that its free flight
//! does not: so after the solver has run, the paths of these bodies are tested for the moments at which they meet bodies
//! without a contact, these contacts are added, and their islands are solved again from the start of the step, up to [`ROUNDS`] times. The
//! set of contacts only grows, and is a function of the scene. Only bodies that are deflected still after all rounds are swept as bullets
//! are: they stop at the bodies that they meet, and have the impact in the next step. (Bodies of a pile, whose contacts the solver has,
//! would stop at each other for ever.)

use super::engine::Engine;
use super::flights::FlightOf;
use super::sweep::Paths;
use super::{Correction, Detected, Scene};
use crate::fx::Fx;
use crate::math::Vec2;
use crate::scalar::FxAccumulator;
use crate::solve::Impulses;

/// Bodies of which impulses change the way by less than this, 1 mm, are not deflected: they overlap by no more in the next step.
const DEFLECTION: i64 = 1 << 22;

/// The most times that the solver runs again in a step.
pub(crate) const ROUNDS: u32 = 8;

impl Engine {
    /// Adds the contacts that deflected bodies meet on the paths of these corrections, and to `touched` the sleeping bodies. Bodies whose
    /// paths have not changed since the last time meet nothing new. Returns true if there is a contact.
    pub(crate) fn add_deflected(&mut self, scene: &Scene<'_>, corrections: &[Correction], out: &mut Detected) -> bool {
        #[cfg(feature = "selftest")]
        if self.is_discrete {
            return false;
        }
        self.find_deflected(scene, corrections);
        let has_met = !self.sweep.fast.is_empty() && self.meet_all_deflected(scene, corrections, out);
        if !has_met {
            self.sweep.deflected.clear();
        }
        has_met
    }

    /// Adds the contacts that the deflected bodies meet on the paths of these corrections. Returns true if there is one.
    fn meet_all_deflected(&mut self, scene: &Scene<'_>, corrections: &[Correction], out: &mut Detected) -> bool {
        let paths = Paths { scene, corrections, is_corrected: false };
        self.find_pairs(&paths, &|_| false);
        self.flights.set_deflections(corrections);
        let pairs = core::mem::take(&mut self.sweep.pairs);
        let known = self.contacts.len();
        for &numbers in &pairs {
            self.meet_deflected(&paths, numbers, known, out);
        }
        self.sweep.pairs = pairs;
        if self.contacts.len() == known {
            return false;
        }
        self.again.added.extend(self.contacts.solver_contacts[known..].iter().flat_map(|contact| contact.bodies));
        self.contacts.sort_from(known);
        true
    }

    /// Lists the dynamic bodies that move, and of which impulses change the way: it is neither the way of the free flight nor, for bodies
    /// that another one carries, the way at the velocity of the start.
    pub(crate) fn find_deflected(&mut self, scene: &Scene<'_>, corrections: &[Correction]) {
        self.sweep.fast.clear();
        self.sweep.deflected.clear();
        for (flight, correction) in corrections.iter().enumerate() {
            let place = self.flights.body(flight as u32);
            let may_meet = place.kind == FlightOf::Dynamic && self.again.may_have_changed(flight as u32);
            if !correction.is_pushed || !may_meet {
                continue;
            }
            let free = self.flights.flight(flight as u32).displacement;
            let change = correction.displacement.map(FxAccumulator::value);
            let way = Vec2::new(free.x.saturating_add(change.x), free.y.saturating_add(change.y));
            let steady = self.flights.steady_way(&scene.starts[flight]);
            let turned = Vec2::new(way.x.saturating_sub(steady.x), way.y.saturating_sub(steady.y));
            if [change, turned, way].into_iter().all(|vector| size(vector.x, vector.y) > DEFLECTION) {
                self.sweep.fast.push(flight as u32);
                self.sweep.deflected.resize(scene.starts.len(), false);
                self.sweep.deflected[flight] = true;
            }
        }
    }

    /// Adds the contact of a pair, if it has none and its outlines meet on these paths. The first `known` contacts are sorted.
    fn meet_deflected(&mut self, paths: &Paths<'_>, numbers: [u32; 2], known: usize, out: &mut Detected) {
        let scene = paths.scene;
        let Some((pair, ends)) = self.ends(paths, numbers) else { return };
        if self.contacts.has(pair, known) {
            return;
        }
        let [Some(a), Some(b)] = pair.map(|outline| scene.colliders.at(outline.slot)) else { return };
        let flights = ends.map(|(flight, _)| flight);
        let parts = pair.map(|outline| outline.part);
        let Some((manifold, ways)) = self.meet_on_paths(scene, numbers, parts, [a, b], flights, paths) else {
            return;
        };
        let asleep = [a, b].into_iter().zip(ends).filter(|(_, (_, place))| place.kind == FlightOf::Asleep);
        let touched = out.touched.len();
        out.touched.extend(asleep.map(|(collider, _)| collider.body));
        if out.touched.len() == touched {
            self.add_contact(scene, pair, [a, b], flights, &manifold, &ways, Impulses::default());
        }
    }
}

/// A bound of the length of a vector, ulps: at most an eighth above it.
fn size(x: Fx, y: Fx) -> i64 {
    let [x, y] = [x, y].map(|part| part.to_bits().saturating_abs());
    x.max(y).saturating_add(x.min(y) / 2)
}
