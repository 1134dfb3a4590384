//! Regions that long kinematic bodies pass, which are far smaller than the boxes around all that they might reach.
//!
//! A kinematic body may carry another one along, out of the box around its path: so the regions of a body count as larger by the longest
//! way of another one.

use alloc::vec::Vec;

use super::super::flights::Flights;
use super::super::resting::Resting;
use super::{Paths, form};
use crate::collide::sweep::{Hull, Leg};
use crate::fx::Fx;
use crate::math::Vec2;
use crate::shape::Aabb;
use crate::slots::NONE;

/// An outline of a kinematic body and the region that it passes.
#[derive(Clone, Copy, Debug)]
struct Region {
    number: u32,
    flight: u32,
    hull: Hull,
}

/// The regions of long kinematic bodies.
#[derive(Debug, Default)]
pub(super) struct Regions {
    /// By number.
    regions: Vec<Region>,
    /// The body with the longest way of a point, that way, and the longest one of all others, ulps.
    farthest: u32,
    ways: [i64; 2],
}

impl Regions {
    /// Lists the regions, where bodies are fast.
    pub(super) fn list(&mut self, paths: &Paths<'_>, flights: &Flights, resting: &Resting, fast: &[u32]) {
        self.regions.clear();
        (self.farthest, self.ways) = (NONE, [0; 2]);
        if fast.is_empty() {
            return;
        }
        for &flight in &flights.kinematic {
            let start = &paths.scene.starts[flight as usize];
            let leg = paths.leg(flights, flight);
            if !leg.moves() {
                continue;
            }
            let [reach, width] = [start.body.turning_radius, start.body.width].map(Fx::to_bits);
            self.count_way(flight, leg.farthest(reach));
            if reach <= width.saturating_mul(2) {
                continue;
            }
            for collider in paths.scene.colliders.solid_of_slot(start.body.slot) {
                for (number, part) in resting.numbers.of(collider.slot).zip(0..) {
                    let outline = collider.outline(part);
                    if let Some(hull) = Hull::new(&form(collider, &outline), &leg) {
                        self.regions.push(Region { number, flight, hull });
                    }
                }
            }
        }
        self.regions.sort_unstable_by_key(|region| region.number);
    }

    fn count_way(&mut self, flight: u32, way: i64) {
        let [longest, second] = self.ways;
        if way > longest {
            (self.farthest, self.ways) = (flight, [way, longest]);
        } else {
            self.ways[1] = second.max(way);
        }
    }

    /// By how much farther than on its own way a body may come as others than this one carry it.
    fn carried(&self, carrier: u32, reach: i64) -> i64 {
        let way = if carrier == self.farthest { self.ways[1] } else { self.ways[0] };
        if way == 0 { 0 } else { way.saturating_add(2 * reach) }
    }

    fn find(&self, number: u32) -> Option<&Region> {
        let index = self.regions.binary_search_by_key(&number, |region| region.number).ok()?;
        Some(&self.regions[index])
    }

    /// The box around the region of an outline, unless bodies may be carried into it.
    pub(super) fn bounds(&self, number: u32) -> Option<Aabb<Fx>> {
        let region = self.find(number).filter(|region| self.carried(region.flight, 0) == 0)?;
        let [min, max] = region.hull.ends.map(|[x, y]| Vec2::new(Fx::from_bits(x), Fx::from_bits(y)));
        Some(Aabb { min, max })
    }

    /// Returns true unless one of two outlines has a region and the other one stays out of it. `leg` is the path of the first one, with points
    /// within `reach` of the centre.
    pub(super) fn meet(
        &self,
        paths: &Paths<'_>,
        flights: &mut Flights,
        resting: &Resting,
        [number, candidate]: [u32; 2],
        leg: &Leg,
        reach: i64,
    ) -> bool {
        if self.regions.is_empty() {
            return true;
        }
        if let Some(region) = self.find(candidate) {
            return region.hull.is_met(leg, reach.saturating_add(self.carried(region.flight, reach)));
        }
        let Some(region) = self.find(number) else { return true };
        let Some(side) = flights.side(paths.scene, &resting.numbers, candidate) else { return true };
        let (leg, reach) = (paths.leg(flights, side.flight), side.radius().to_bits());
        region.hull.is_met(&leg, reach.saturating_add(self.carried(region.flight, reach)))
    }
}
