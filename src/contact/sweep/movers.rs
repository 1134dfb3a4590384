//! Moving outlines that may be in the way of fast bodies.
//!
//! Obstacles are in the way of all: kinematic bodies, bullets, and bodies that are swept as bullets are. All other dynamic bodies are in the
//! way of these alone, and of kinematic ones those that are not fast themselves.

use alloc::vec::Vec;
use core::slice::from_ref;

use super::super::flights::{FlightKind, Flights};
use super::super::movers::MovingOutline;
use super::{Paths, Regions, around};
use crate::collide::broad::{Proxy, Statics};
use crate::collider::Filter;
use crate::fx::Fx;
use crate::shape::Aabb;

/// The number of boxes up to which each is looked at, without a tree.
const FEW: usize = 64;
/// The number of searches up to which a tree is not worth its while.
const FEW_SEARCHES: usize = 16;

/// Boxes of outlines, and a tree of them where they are many.
#[derive(Debug, Default)]
struct Layer {
    proxies: Vec<Proxy>,
    tree: Option<Statics>,
    has_tree: bool,
}

/// The boxes of the moving outlines that may be in the way of fast bodies.
#[derive(Debug, Default)]
pub(super) struct Movers {
    obstacles: Layer,
    bodies: Layer,
}

impl Layer {
    /// Adds the outlines of a body.
    fn push(&mut self, paths: &Paths<'_>, flights: &Flights, regions: &Regions, flight: u32) {
        let leg = paths.leg(flights, flight);
        self.proxies.extend(flights.outlines.of(flight).iter().map(|outline| {
            let &MovingOutline { number, extent, filter, body, .. } = outline;
            let bounds = regions.bounds(number).unwrap_or_else(|| around(from_ref(&leg), extent));
            Proxy { collider: number, body, bounds, filter, digest: 0 }
        }));
    }

    /// Prepares this number of searches.
    fn prepare(&mut self, searches: usize) {
        self.has_tree = self.proxies.len() > FEW && searches > FEW_SEARCHES;
        if self.has_tree {
            self.tree.get_or_insert_default().refill(&self.proxies);
        }
    }

    fn search(&self, bounds: Aabb<Fx>, filter: Filter, visit: &mut impl FnMut(u32) -> bool) {
        match self.tree.as_ref().filter(|_| self.has_tree) {
            Some(tree) => tree.search_box(bounds, filter, visit),
            None => {
                let nearby_proxies = self.proxies.iter().filter(|proxy| overlap(&proxy.bounds, &bounds));
                nearby_proxies.for_each(|proxy| _ = visit(proxy.collider));
            }
        }
    }
}

impl Movers {
    /// Lists the outlines for these fast bodies, ascending, of which some are swept as bullets are; `is_listed` is false for bodies that are
    /// left out.
    pub(super) fn list(
        &mut self,
        paths: &Paths<'_>,
        flights: &Flights,
        regions: &Regions,
        fast: &[u32],
        deflected: &[u32],
        is_listed: &dyn Fn(u32) -> bool,
    ) {
        let Self { obstacles, bodies } = self;
        let kind = |flight: u32| flights.body(flight).kind;
        let is_bullet = |flight: u32| flights.body(flight).is_bullet || deflected.binary_search(&flight).is_ok();
        let has_dynamic = fast.iter().any(|&flight| kind(flight) == FlightKind::Dynamic);
        let bullets = fast.iter().filter(|&&flight| is_bullet(flight)).count();
        let kinematic = fast.iter().filter(|&&flight| kind(flight) == FlightKind::Kinematic).count();
        obstacles.proxies.clear();
        bodies.proxies.clear();
        let mut rest = fast.iter().copied().peekable();
        for flight in 0..paths.scene.starts.len() as u32 {
            let is_fast = rest.next_if_eq(&flight).is_some();
            if !is_listed(flight) {
                continue;
            }
            match kind(flight) {
                FlightKind::Kinematic if has_dynamic => obstacles.push(paths, flights, regions, flight),
                FlightKind::Dynamic if is_bullet(flight) => obstacles.push(paths, flights, regions, flight),
                FlightKind::Dynamic if bullets > 0 || kinematic > 0 && !is_fast => {
                    bodies.push(paths, flights, regions, flight);
                }
                _ => {}
            }
        }
        obstacles.prepare(fast.len());
        bodies.prepare(bullets + kinematic);
    }

    /// Visits the outlines that may be in the way of a box: of obstacles alone, or of all bodies.
    pub(super) fn search(
        &self,
        bounds: Aabb<Fx>,
        filter: Filter,
        is_obstacle: bool,
        visit: &mut impl FnMut(u32) -> bool,
    ) {
        self.obstacles.search(bounds, filter, visit);
        if is_obstacle {
            self.bodies.search(bounds, filter, visit);
        }
    }
}

/// Returns true if two boxes have a point in common.
fn overlap(a: &Aabb<Fx>, b: &Aabb<Fx>) -> bool {
    a.min.x <= b.max.x && b.min.x <= a.max.x && a.min.y <= b.max.y && b.min.y <= a.max.y
}
