//! Heavy loads on joints.

use alloc::vec::Vec;

use super::Joint;
use super::forest::Forest;
use crate::fx::Fx;
use crate::solve::graph::Graph;
use crate::solve::heavy::{is_heavy, may_be_heavy};
use crate::solve::{Contact, Flight};

/// True for islands that bear heavy loads among other constraints.
#[derive(Clone, Debug, Default)]
pub(in crate::solve) struct Loads {
    /// The largest mass on top of each body, kg.
    above: Vec<Fx>,
    /// By island.
    is_heavy: Vec<bool>,
    /// Joints to bodies that cannot be moved, by island; contacts and loops count as two.
    supports: Vec<u32>,
}

impl Loads {
    /// Finds the islands with contacts, loops or two supports in which a body bears a heavy load: there the tension of joints meets other
    /// constraints that do not give way, and joints must.
    pub(in crate::solve) fn find(
        &mut self,
        flights: &[Flight],
        joints: &[Joint],
        contacts: &[Contact],
        forest: &Forest,
        graph: &Graph,
    ) {
        let Self { above, is_heavy: heavy, supports } = self;
        heavy.clear();
        if !may_be_heavy(flights) {
            return;
        }
        let islands = graph.islands();
        supports.clear();
        supports.resize(islands, 0);
        let mut add = |ends: [u32; 2], count: u32| {
            if let Some(island) = graph.island_of_link(ends) {
                supports[island as usize] += count;
            }
        };
        for joint in joints.iter().filter(|joint| joint.bodies.iter().any(|&body| flights[body as usize].is_fixed())) {
            add(joint.bodies, 1);
        }
        contacts.iter().for_each(|contact| add(contact.bodies, 2));
        for range in &forest.loops {
            add(joints[forest.order[range.start] as usize].bodies, 2);
        }
        heavy.resize(islands, false);
        graph.largest_above(|body| flights[body as usize].mass, above);
        for ((body, flight), &load) in (0..).zip(flights).zip(&*above) {
            if let Some(island) = graph.island_of(body).filter(|_| is_heavy(load, flight.mass)) {
                heavy[island as usize] = supports[island as usize] >= 2;
            }
        }
    }

    pub(in crate::solve) fn is_heavy(&self, island: Option<u32>) -> bool {
        island.and_then(|island| self.is_heavy.get(island as usize).copied()).unwrap_or(false)
    }
}
