//! Where bodies with joints end a step.

use alloc::vec::Vec;

use super::{Joint, JointKind};
use crate::solve::apply::Path;
use crate::solve::graph::Graph;
use crate::solve::{Contact, Flight};

/// Settles the paths of all bodies; none without joints. `held` is memory: true for islands that a fixed body holds.
pub(in crate::solve) fn find_paths(
    flights: &[Flight],
    joints: &[Joint],
    contacts: &[Contact],
    graph: &Graph,
    held: &mut Vec<bool>,
    paths: &mut Vec<Path>,
) {
    paths.clear();
    if joints.is_empty() {
        return;
    }
    held.clear();
    held.resize(graph.islands(), false);
    let pressed = contacts.iter().filter(|contact| contact.impulses.values != [0; 3]);
    // Ropes over pulleys hang from the world.
    let ropes_and_ends = joints.iter().map(|joint| (matches!(joint.kind, JointKind::Pulley { .. }), joint.bodies));
    for (is_rope, ends) in ropes_and_ends.chain(pressed.map(|contact| (false, contact.bodies))) {
        let mover = graph.island_of_link(ends);
        let is_held = is_rope || ends.iter().any(|&body| flights[body as usize].is_fixed());
        if let (Some(island), true) = (mover, is_held) {
            held[island as usize] = true;
        }
    }
    paths.resize(flights.len(), Path::Contacts);
    for body in joints.iter().flat_map(|joint| joint.bodies) {
        let island = graph.island_of(body);
        let is_held = island.is_some_and(|island| held[island as usize]);
        paths[body as usize] = if is_held { Path::Substeps } else { Path::Flight };
    }
}
