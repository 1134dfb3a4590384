//! Static polygons beside each other: the surface of their union, found for each polygon when a body first comes near.
//!
//! A surface is a function of the static colliders alone. It is kept until one of them changes; a collider that no
//! body comes near costs nothing, and a world without neighbours a look at each static outline once. A polygon in a [`CROWD`] counts as
//! alone.
//!
//! Two polygons are neighbours if their filters are the same, and their `one_way`: an outline that meets one of them meets the other too.
//! Polygons of two bodies that move are no neighbours: their surface would change with each step.

use alloc::vec::Vec;
use core::ops::Range;

use super::flights::pose;
use super::numbers::Numbers;
use super::reach;
use super::slot_table::SlotTable;
use super::{ContactRecord, Scene};
use crate::collide::Pose;
use crate::collide::broad::{Proxy, Statics};
use crate::collider::{BodyOutline, Collider};
use crate::fx::Fx;
use crate::shape::union::{Face, Polygons};
use crate::slots::NONE;

/// The surfaces of static polygons.
#[derive(Debug, Default)]
pub(super) struct Tiles {
    /// By number of the outline: the number of its surface, or [`ALONE`].
    surface_of: SlotTable,
    surfaces: SurfaceList,
    /// Workspace: a polygon and its neighbours.
    polygons: Polygons,
}

/// The faces of surfaces, each surface with a number.
#[derive(Debug, Default)]
pub(super) struct SurfaceList {
    surfaces: Vec<Range<usize>>,
    faces: Vec<Face>,
}

impl SurfaceList {
    pub(super) fn clear(&mut self) {
        self.surfaces.clear();
        self.faces.clear();
    }

    /// Adds the surface of the first of some polygons, and returns its number; [`ALONE`] if no other one touches it.
    pub(super) fn add(&mut self, polygons: &mut Polygons) -> u32 {
        let start = self.faces.len();
        if is_crowd(polygons) || !polygons.faces(&mut self.faces) {
            return ALONE;
        }
        self.surfaces.push(start..self.faces.len());
        self.surfaces.len() as u32 - 1
    }

    /// A surface by its number.
    pub(super) fn get(&self, number: u32) -> Option<&[Face]> {
        Some(&self.faces[self.surfaces.get(number as usize)?.clone()])
    }
}

/// Marks a polygon without neighbours.
const ALONE: u32 = NONE - 1;

/// The cosine of 60°, in 2^-60.
pub(super) const SLANTED: i64 = 1 << 59;

/// With more corners than this, a polygon and its neighbours are a crowd, in which each stands alone: else the work for polygons that lie on
/// each other would grow with the square of their number. 64 triangles around a point have 192.
const CROWD: usize = 256;

/// Returns true for a polygon in a crowd.
pub(super) fn is_crowd(polygons: &Polygons) -> bool {
    polygons.corner_count() > CROWD
}

/// Returns true for the outline of a sharp polygon.
pub(super) fn is_polygon(outline: &BodyOutline) -> bool {
    outline.outline.corners().len() > 2 && outline.outline.radius() == Fx::ZERO
}

impl Tiles {
    /// Forgets all surfaces, as a static collider has changed.
    pub(super) fn clear(&mut self) {
        self.surface_of.clear();
        self.surfaces.clear();
    }

    /// The edges of a static outline that are on the surface of its union with others; `None` if it stands alone.
    pub(super) fn find(
        &mut self,
        scene: &Scene<'_>,
        statics: &Statics,
        numbers: &Numbers,
        number: u32,
        outline: &BodyOutline,
        pose: &Pose,
    ) -> Option<&[Face]> {
        if !is_polygon(outline) {
            return None;
        }
        if self.surface_of.get(number) == NONE {
            let collider = scene.colliders.at(numbers.outline(number).slot)?;
            self.polygons.clear();
            self.polygons.push(pose.corners_from(&outline.outline, pose));
            statics.near(reach::resting(outline, pose), |proxy: &Proxy| {
                if proxy.collider != number && proxy.filter == collider.def.filter {
                    self.push(scene, numbers, proxy, collider, pose);
                }
                !is_crowd(&self.polygons)
            });
            self.surface_of.set(number, self.surfaces.add(&mut self.polygons));
        }
        self.surface(number)
    }

    /// Adds the polygon of a static collider that holds from the same sides as this tile, in coordinates relative to the tile's body.
    fn push(&mut self, scene: &Scene<'_>, numbers: &Numbers, neighbour: &Proxy, tile: &Collider, tile_pose: &Pose) {
        let id = numbers.outline(neighbour.collider);
        let Some(collider) = scene.colliders.at(id.slot) else { return };
        let Some(dense) = scene.bodies.index_in(neighbour.body) else { return };
        let outline = collider.outline(id.part);
        if is_polygon(&outline) && collider.def.one_way == tile.def.one_way {
            let pose = pose(scene.bodies.position(dense), scene.bodies.angle(dense));
            self.polygons.push(pose.corners_from(&outline.outline, tile_pose));
        }
    }

    /// The surface of an outline, if it was found and the outline does not stand alone.
    pub(super) fn surface(&self, number: u32) -> Option<&[Face]> {
        self.surfaces.get(self.surface_of.get(number))
    }
}

/// Returns true if points on two surfaces of one body, or of static ones, are on faces that turn from one to the other by less than an angle,
/// of this cosine in 2^-60: a body may have gone from one to the other in a step.
pub(super) fn are_joined(
    surfaces: [&[Face]; 2],
    side: usize,
    features: &[u32],
    before: &ContactRecord,
    cosine: i64,
) -> bool {
    let faces_at = |surface: usize, feature: u32| {
        let [first, second] = [feature >> (12 * side) & 63, feature >> (12 * side + 6) & 63];
        // An edge by its first corner; at a corner all edges that meet there. The last edge ends at corner 0.
        surfaces[surface].iter().filter(move |face| {
            let [from, to] = [face.edge, (face.edge + 1) % face.corners].map(|corner| corner as u32);
            if first == second { from == first || to == first } else { from == first }
        })
    };
    let is_joined = |a: &Face, b: &Face| {
        let dot = |k: usize| i64::from(a.normal[k]) * i64::from(b.normal[k]);
        // Unit vectors in units of 2^-30.
        dot(0) + dot(1) > cosine
    };
    let mut faces_before = before.features().into_iter().take(before.count()).flat_map(|feature| faces_at(1, feature));
    faces_before.any(|before| {
        let mut faces_now = features.iter().flat_map(|&feature| faces_at(0, feature));
        faces_now.any(|now| is_joined(now, before))
    })
}
