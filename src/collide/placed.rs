//! Outlines in world axes, each turned once for all its pairs.

mod apart;

use alloc::vec::Vec;

pub(crate) use self::apart::PlacedMotion;
use super::cores::across;
use super::lanes::{CollidePairs, LANE_CORNERS, LaneKind, LaneManifolds, LanePairs, LaneShape, Polygons, Tables};
use super::link::{collide_surfaces, swapped};
use super::place::{Placed, PlacedBox, Pose, Room, View, places_of, turned_normal};
use super::points::Ends;
use super::surface::{Link, Surface, Surfaces};
use super::{Manifold, Margin, collide_placed};
use crate::fx::Fx;
use crate::kernel::simd::{self, Line};
use crate::math::Vec2;
use crate::shape::union::Face;
use crate::shape::{Aabb, Outline};
use crate::slots::NONE;

/// In place of the first place of a core in the lists of corners and normals: a rectangle or a disc is not there, as its line has all of it.
const IN_LINE: usize = usize::MAX;

/// Outlines in world axes, each turned once for all its pairs.
#[derive(Clone, Debug, Default)]
pub struct Cores {
    corners: Vec<[i64; 2]>,
    normals: Vec<[i32; 2]>,
    /// Each core with its first place, and whether it is among the surfaces.
    placed: Vec<(Placed, usize, bool)>,
    /// Segments of chains and polygons among others, by number: true for a segment, and the last of its links.
    surfaces: Vec<(usize, bool, usize)>,
    links: Vec<Link>,
    /// By core: a box or a disc, as [`CollidePairs`] reads it.
    lines: Vec<Line>,
    /// Cores of pairs with polygons, and their numbers among these by core, [`NONE`] for others.
    polygons: Polygons,
    polygon_of: Vec<u32>,
}

impl Cores {
    /// Forgets all outlines and keeps the memory.
    pub fn clear(&mut self) {
        self.corners.clear();
        self.normals.clear();
        self.placed.clear();
        self.surfaces.clear();
        self.links.clear();
        self.lines.clear();
        self.polygons.clear();
        self.polygon_of.clear();
    }

    /// Adds the outline of a body at a pose, and returns its number: 0, 1, 2 and so on.
    pub fn push(&mut self, outline: &Outline, pose: &Pose) -> usize {
        // A rectangle, whose second normal is the first one turned by a quarter.
        let rectangle = PlacedBox::new(outline, pose).filter(|PlacedBox { normals: [n1, n2], .. }| *n2 == across(*n1));
        if let Some(placed_box) = rectangle {
            return self.push_rectangle(&placed_box) as usize;
        }
        if let &[centre] = outline.corners() {
            return self.push_disc(centre, outline.radius(), pose).0 as usize;
        }
        let start = self.corners.len();
        let end = start + places_of(outline.corners().len());
        self.corners.resize(end, [0; 2]);
        self.normals.resize(end, [0; 2]);
        let placed = Placed::new(outline, pose, &mut self.corners[start..], &mut self.normals[start..]);
        if let Some(neighbours) = outline.neighbours() {
            let turned = |normal| turned_normal(normal, pose);
            let neighbours = neighbours.map(|neighbour| neighbour.map(turned));
            self.links.push(Link::new([0, 1], self.normals[start], neighbours, None));
            self.surfaces.push((self.placed.len(), true, self.links.len()));
        }
        self.lines.push(Line::default());
        self.placed.push((placed, start, outline.neighbours().is_some()));
        self.placed.len() - 1
    }

    /// Adds a disc around this place in the axes of its body. Returns its number and the box around it.
    #[inline(always)]
    pub(crate) fn push_disc(&mut self, centre: Vec2, radius: Fx, pose: &Pose) -> (u32, Aabb) {
        let (placed, [x, y]) = Placed::disc(centre, radius, pose);
        let position = placed.position;
        self.lines.push(Line([x, y, 0, 0, placed.radius, 0, position.x.to_bits(), position.y.to_bits()]));
        (self.push_in_line(placed), placed.bounds())
    }

    /// Adds a rectangle around the centre of mass that is not turned in the axes of its body, by the corner where x and y are positive.
    /// Returns its number and the box around it.
    #[inline(always)]
    pub(crate) fn push_upright(&mut self, corner: Vec2, radius: Fx, pose: &Pose) -> (u32, Aabb) {
        let placed_box = PlacedBox::upright(corner, radius, pose);
        (self.push_rectangle(&placed_box), placed_box.placed.bounds())
    }

    #[inline(always)]
    fn push_rectangle(&mut self, placed_box: &PlacedBox) -> u32 {
        let PlacedBox { placed, corners: [[x1, y1], [x2, y2]], normals: [first, _] } = *placed_box;
        let ([nx, ny], Vec2 { x, y }) = (first.map(i64::from), placed.position);
        self.lines.push(Line([x1, y1, x2, y2, nx, ny, x.to_bits(), y.to_bits()]));
        self.push_in_line(placed)
    }

    #[inline(always)]
    fn push_in_line(&mut self, placed: Placed) -> u32 {
        self.placed.push((placed, IN_LINE, false));
        self.placed.len() as u32 - 1
    }

    /// The shape of an outline, if lanes take it.
    #[inline]
    pub(crate) fn lane_shape(&self, i: usize) -> Option<LaneShape> {
        let (placed, start, is_surface) = &self.placed[i];
        match placed.count {
            _ if *is_surface => None,
            1 => Some(LaneShape::Disc),
            4 if *start == IN_LINE && placed.radius == 0 => Some(LaneShape::Box),
            2..=4 => Some(LaneShape::FourCorners),
            5..=LANE_CORNERS => Some(LaneShape::EightCorners),
            _ => None,
        }
    }

    /// The number of an outline among the polygons that lanes read: it gets one when it is first asked for.
    #[inline]
    pub(crate) fn polygon(&mut self, i: usize) -> u32 {
        match self.polygon_of.get(i) {
            Some(&polygon) if polygon != NONE => polygon,
            _ => self.push_polygon(i),
        }
    }

    fn push_polygon(&mut self, i: usize) -> u32 {
        let mut polygons = core::mem::take(&mut self.polygons);
        let polygon = polygons.push(&self.view(i, &mut Room::default()));
        self.polygons = polygons;
        self.polygon_of.resize(self.placed.len(), NONE);
        self.polygon_of[i] = polygon;
        polygon
    }

    #[cfg(test)]
    pub(super) fn lines(&self) -> (&[Line], &Polygons) {
        (&self.lines, &self.polygons)
    }

    /// Finds the manifolds of pairs of a kind with these motions: they have one if they are nearer than
    /// a margin, in ulps, and the distance that they close.
    pub(crate) fn collide_pairs(
        &self,
        kind: LaneKind,
        motions: &[Line],
        margin: i64,
        pairs: &[LanePairs],
        manifolds: &mut [LaneManifolds],
    ) {
        let tables = Tables { outlines: &self.lines, polygons: &self.polygons, motions, margin };
        simd::run(CollidePairs { kind, tables, pairs, manifolds });
    }

    /// Names the edges of the outline that was added last that are on the surface among other polygons, in world axes.
    pub(crate) fn set_faces(&mut self, faces: impl Iterator<Item = Face>) {
        let Self { placed, lines, normals, links, surfaces, .. } = self;
        let (Some((placed, start, is_surface)), Some(line)) = (placed.last_mut(), lines.last()) else { return };
        *is_surface = true;
        let mut room = Room::default();
        let (count, normals) = match *start {
            IN_LINE => {
                room.fill_rectangle(line);
                (4, &room.normals[..])
            }
            start => (placed.count, &normals[start..]),
        };
        let link = |face: Face| {
            let corners = [face.edge, (face.edge + 1) % count];
            Link::new(corners, normals[face.edge], face.ends, face.part)
        };
        links.extend(faces.map(link));
        surfaces.push((lines.len() - 1, false, links.len()));
    }

    /// The manifold of two of the outlines: see [`collide`](super::collide()).
    ///
    /// # Panics
    /// Panics if one of them is not there.
    #[must_use]
    pub fn collide(&self, a: usize, b: usize, margin: Margin) -> Option<Manifold> {
        if self.placed[a].2 || self.placed[b].2 {
            return self.collide_surfaces(a, b, margin);
        }
        let mut rooms = [Room::default(); 2];
        let [room_a, room_b] = &mut rooms;
        collide_placed(self.view(a, room_a), self.view(b, room_b), margin)
    }

    /// The manifold of two outlines without surfaces at the ends of the overlap of these edges along a direction, if they overlap: the
    /// corners of A and of B in order of place.
    #[cold]
    pub(crate) fn between_edges(
        &self,
        [a, b]: [usize; 2],
        normal: [i32; 2],
        corners: [[usize; 2]; 2],
        margin: Margin,
    ) -> Option<Manifold> {
        let mut rooms = [Room::default(); 2];
        let [room_a, room_b] = &mut rooms;
        Ends::new(self.view(a, room_a), self.view(b, room_b), margin)?.between_edges(normal, corners)
    }

    fn surface(&self, i: usize) -> Option<Surface<'_>> {
        let index = self.surfaces.binary_search_by_key(&i, |(number, ..)| *number).ok()?;
        let start = if index == 0 { 0 } else { self.surfaces[index - 1].2 };
        let (_, is_one_sided, end) = self.surfaces[index];
        Some(Surface { links: &self.links[start..end], is_one_sided, is_across: false })
    }

    #[cold]
    fn collide_surfaces(&self, a: usize, b: usize, margin: Margin) -> Option<Manifold> {
        let mut rooms = [Room::default(); 2];
        let [room_a, room_b] = &mut rooms;
        let (view_a, view_b) = (self.view(a, room_a), self.view(b, room_b));
        let surfaces = Surfaces { a: self.surface(a), b: self.surface(b) };
        if surfaces.a.is_some() {
            return collide_surfaces(view_a, view_b, surfaces, margin);
        }
        let surfaces = Surfaces { a: surfaces.b, b: None };
        collide_surfaces(view_b, view_a, surfaces, margin).map(swapped)
    }

    /// An outline; the corners and normals of a rectangle or a disc go to `room`.
    #[inline(always)]
    fn view<'a>(&'a self, i: usize, room: &'a mut Room) -> View<'a> {
        let (placed, start, _) = &self.placed[i];
        if *start == IN_LINE {
            if placed.count == 1 {
                let Line([x, y, ..]) = self.lines[i];
                room.corners = [[x, y]; 4];
            } else {
                room.fill_rectangle(&self.lines[i]);
            }
            return View { placed, corners: &room.corners, normals: &room.normals };
        }
        let places = *start..start + places_of(placed.count);
        View { placed, corners: &self.corners[places.clone()], normals: &self.normals[places] }
    }
}
