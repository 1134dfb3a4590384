//! Polygons of one body beside each other, as a platform, a raft or a compound has them: the surface of their union, found for each polygon
//! when another body first comes near.
//!
//! A surface is in the axes of the body: a function of the body's colliders alone, kept until one of them changes. Static bodies have
//! [surfaces](super::tiles) with each other. Polygons are neighbours as there, with the same filter and the same side of a
//! one-way collider; a sensor touches nothing. Faces are turned where an outline is placed.
//!
//! The set of colliders names the state of the colliders of each body by a hash of their changes: so a copy of a world, or a world that goes
//! back, knows whether its surfaces still hold. A body of one outline costs a look at two links.

use alloc::boxed::Box;
use alloc::vec::Vec;

use super::tiles::{SurfaceList, is_crowd, is_polygon};
use crate::collide::broad::{Proxy, Statics};
use crate::collider::{BodyOutline, ColliderSet, OutlineId};
use crate::fx::Fx;
use crate::math::Vec2;
use crate::shape::Aabb;
use crate::shape::union::{Face, Polygons, REACH};
use crate::slots::NONE;

/// The surfaces of polygons, by body.
#[derive(Debug, Default)]
pub(super) struct BodyTiles {
    /// By the slot of the body.
    bodies: Vec<Option<Box<Body>>>,
    count: usize,
    /// The number of bodies above which removed and changed bodies are dropped.
    max_count: usize,
    workspace: Workspace,
}

#[derive(Debug, Default)]
struct Workspace {
    /// A polygon and its neighbours.
    polygons: Polygons,
    proxies: Vec<Proxy>,
}

/// A body with several outlines.
#[derive(Debug, Default)]
struct Body {
    /// The revision of the body's colliders.
    revision: u64,
    /// The sharp polygons, sorted.
    outlines: Vec<OutlineId>,
    /// The boxes around the outlines, grown by [`REACH`], by their indices in the list, if there are more than [`FEW`].
    boxes: Option<Box<Statics>>,
    /// By index in the list: the number of its surface; [`NONE`] if it was not asked for.
    surface_of: Vec<u32>,
    surfaces: SurfaceList,
}

/// The number of outlines of a body up to which each is looked at, without a tree.
const FEW: usize = 16;

/// The box around an outline, grown by the largest distance of neighbours.
fn grown(outline: &BodyOutline) -> Aabb {
    let reach = Fx::from_bits(REACH);
    let Aabb { min, max } = outline.corners;
    Aabb { min: min - Vec2::new(reach, reach), max: max + Vec2::new(reach, reach) }
}

/// The corners of an outline in ulps, in the axes of its body.
fn corners(outline: &BodyOutline) -> impl Iterator<Item = [i64; 2]> {
    outline.outline.corners().iter().map(|corner| [corner.x.to_bits(), corner.y.to_bits()])
}

impl Body {
    /// Lists the outlines of a body. Allocates nothing if there were as many before.
    fn refill(&mut self, colliders: &ColliderSet, body: u32, revision: u64, proxies: &mut Vec<Proxy>) {
        self.revision = revision;
        self.outlines.clear();
        for collider in colliders.solid_of_slot(body).filter(|collider| !collider.def.shape.is_chain()) {
            let parts = (0..collider.outline_count()).filter(|&part| is_polygon(&collider.outline(part)));
            self.outlines.extend(parts.map(|part| OutlineId { slot: collider.slot, part }));
        }
        self.outlines.sort_unstable();
        self.surface_of.clear();
        self.surface_of.resize(self.outlines.len(), NONE);
        self.surfaces.clear();
        if self.outlines.len() <= FEW {
            return;
        }
        proxies.clear();
        for (index, id) in (0..).zip(&self.outlines) {
            let Some(collider) = colliders.at(id.slot) else { continue };
            let bounds = grown(&collider.outline(id.part));
            proxies.push(Proxy { collider: index, body, bounds, filter: collider.def.filter, digest: 0 });
        }
        self.boxes.get_or_insert_default().refill(proxies);
    }

    /// The surface of an outline; `None` if it stands alone.
    fn find(&mut self, colliders: &ColliderSet, id: OutlineId, polygons: &mut Polygons) -> Option<&[Face]> {
        let index = self.outlines.binary_search(&id).ok()?;
        if self.surface_of[index] == NONE {
            let tile = colliders.at(id.slot)?;
            let outline = tile.outline(id.part);
            let bounds = grown(&outline);
            polygons.clear();
            polygons.push(corners(&outline));
            let mut push = |neighbour: OutlineId| {
                let collider = colliders.at(neighbour.slot).filter(|collider| {
                    neighbour != id && collider.def.filter == tile.def.filter && collider.side == tile.side
                });
                let outline = collider.map(|collider| collider.outline(neighbour.part));
                if let Some(outline) = outline.filter(|outline| bounds.overlaps(grown(outline))) {
                    polygons.push(corners(&outline));
                }
                !is_crowd(polygons)
            };
            match self.boxes.as_deref().filter(|_| self.outlines.len() > FEW) {
                Some(boxes) => boxes.near(bounds, |proxy| push(self.outlines[proxy.collider as usize])),
                None => _ = self.outlines.iter().all(|&neighbour| push(neighbour)),
            }
            self.surface_of[index] = self.surfaces.add(polygons);
        }
        self.surfaces.get(self.surface_of[index])
    }
}

impl BodyTiles {
    /// The edges of an outline of a body that are on the surface of its union with the body's other outlines, in the axes of the body;
    /// `None` if it stands alone.
    pub(super) fn find(&mut self, colliders: &ColliderSet, body: u32, id: OutlineId) -> Option<&[Face]> {
        let index = body as usize;
        let revision = colliders.revision_of(body)?;
        if self.bodies.len() <= index {
            self.bodies.resize_with(index + 1, || None);
        }
        if self.bodies[index].as_ref().is_none_or(|body| body.revision != revision) {
            if self.bodies[index].is_none() {
                self.count += 1;
                self.drop_stale(colliders);
            }
            let tiles = self.bodies[index].get_or_insert_default();
            tiles.refill(colliders, body, revision, &mut self.workspace.proxies);
        }
        self.bodies[index].as_mut()?.find(colliders, id, &mut self.workspace.polygons)
    }

    /// The surface of an outline, if it was found and the outline does not stand alone.
    pub(super) fn surface(&self, colliders: &ColliderSet, body: u32, id: OutlineId) -> Option<&[Face]> {
        let Body { revision, outlines, surface_of, surfaces, .. } = self.bodies.get(body as usize)?.as_deref()?;
        if colliders.revision_of(body) != Some(*revision) {
            return None;
        }
        surfaces.get(surface_of[outlines.binary_search(&id).ok()?])
    }

    /// Drops the bodies that were removed or changed, whenever there are twice as many as were left the last time.
    fn drop_stale(&mut self, colliders: &ColliderSet) {
        if self.count <= self.max_count {
            return;
        }
        for (slot, place) in (0..).zip(&mut self.bodies) {
            if place.as_ref().is_some_and(|body| colliders.revision_of(slot) != Some(body.revision)) {
                *place = None;
                self.count -= 1;
            }
        }
        self.max_count = 2 * self.count;
    }
}
