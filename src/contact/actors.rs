//! The outlines that may meet others in a step, as pairs look at them, and pairs of them side by side in lanes.
//!
//! Reads: sides of pairs, outlines in world axes. Writes: actors, manifolds of these pairs.

use alloc::vec::Vec;

use super::Scene;
use super::coefficients::{Coefficients, Materials};
use super::flights::{FlightKind, PairSide};
use super::moment::Way;
use super::movers::{MovingOutline, MovingOutlines};
use super::reach::{CLOSE, Reach};
use super::slot_table::SlotTable;
use crate::collide::{Cores, LaneKind, LaneManifolds, LanePairs, LaneShape};
use crate::collider::OutlineId;
use crate::fx::Fx;
use crate::kernel::simd::{GROUP, Line, VectorSet};
use crate::math::Vec2;
use crate::slots::NONE;

/// The number of pairs that are looked at together: their manifolds stay in the first cache.
pub(super) const CHUNK: usize = 64;

/// An outline of a body that moves, or of one that is near such an outline.
#[derive(Clone, Copy, Debug)]
pub(super) struct Actor {
    pub(super) number: u32,
    pub(super) id: OutlineId,
    pub(super) flight: u32,
    pub(super) kind: FlightKind,
    /// Its index in [`Cores`], if it is placed.
    pub(super) core: u32,
    /// Its shape, if lanes take it.
    pub(super) shape: Option<LaneShape>,
    /// The number of its material in the step, if it has one.
    pub(super) material: Option<u8>,
    /// True if its contacts may be hits.
    pub(super) has_hits: bool,
    /// True if no other outline goes on where its surface ends.
    pub(super) is_alone: bool,
    /// The largest distance of a point of the outline from the centre of mass of its body, ulps.
    pub(super) extent: i64,
}

impl Actor {
    /// The side of a pair.
    #[inline(always)]
    pub(super) fn side<'a>(&self, scene: &Scene<'a>) -> Option<PairSide<'a>> {
        let Self { number, id, flight, kind, .. } = *self;
        Some(PairSide { number, id, collider: scene.colliders.at(id.slot)?, flight, kind })
    }

    /// The radius of the outline, m.
    pub(super) fn radius(&self, scene: &Scene<'_>) -> Fx {
        self.side(scene).map_or(Fx::ZERO, |side| side.outline().outline.radius())
    }
}

/// The place of a pair in the lanes of a chunk.
#[derive(Clone, Copy, Debug)]
pub(super) struct LanePlace {
    kind: LaneKind,
    place: usize,
}

/// Pairs of a chunk in groups of lanes, and their manifolds.
#[derive(Debug, Default)]
struct Queue {
    pairs: Vec<LanePairs>,
    manifolds: Vec<LaneManifolds>,
    /// The number of pairs.
    count: usize,
}

impl Queue {
    fn clear(&mut self) {
        self.count = 0;
    }

    #[inline(always)]
    fn push(&mut self, outlines: [u32; 2], motions: [u32; 2], is_swapped: bool) -> usize {
        let place = self.count;
        if place == self.pairs.len() * GROUP {
            self.pairs.push(LanePairs::default());
            self.manifolds.push(LaneManifolds::default());
        }
        self.pairs[place / GROUP].set(place % GROUP, outlines, motions, is_swapped);
        self.count += 1;
        place
    }

    /// The groups with pairs, and room for their manifolds; `None` if there is no pair.
    fn groups(&mut self) -> Option<(&[LanePairs], &mut [LaneManifolds])> {
        let groups = self.count.div_ceil(GROUP);
        let (pairs, manifolds) = (&mut self.pairs[..groups], &mut self.manifolds[..groups]);
        pairs.last_mut()?.fill((self.count - 1) % GROUP + 1);
        Some((pairs, manifolds))
    }
}

/// The actors of a step: outlines of moving bodies, each made when the body is entered, and other ones, each made when a pair first names it.
#[derive(Debug, Default)]
pub(super) struct Actors {
    actors: Vec<Actor>,
    /// The motion of each over the step, as lanes read it, and the centre of mass of its body at the start.
    motions: Vec<Line>,
    pub(super) materials: Materials,
    /// The index by the number of the outline.
    index_of: SlotTable,
    /// The pairs of a chunk, by [`LaneKind`].
    queues: [Queue; LaneKind::ALL.len()],
    /// False where one pair at a time is as fast: lanes of polygons pay from eight lanes on.
    has_lanes: bool,
    has_polygon_lanes: bool,
}

impl Actors {
    pub(super) fn clear(&mut self) {
        self.actors.clear();
        self.motions.clear();
        self.materials.clear();
        self.index_of.clear();
        self.has_lanes = VectorSet::used() != VectorSet::Portable;
        self.has_polygon_lanes = VectorSet::used() == VectorSet::Avx512;
    }

    /// The index of an outline, if it is an actor already.
    #[inline(always)]
    pub(super) fn find(&self, number: u32) -> Option<usize> {
        Some(self.index_of.get(number)).filter(|&index| index != NONE).map(|index| index as usize)
    }

    /// Begins with the outlines of bodies that move, which are [placed](Self::place) in their order.
    pub(super) fn begin(&mut self, scene: &Scene<'_>, outlines: &MovingOutlines) {
        self.materials.begin(scene, outlines.materials());
        self.actors.extend(outlines.all().iter().map(MovingOutline::actor));
    }

    /// Writes the motion of an actor, whose body goes from this centre and this way to the moment of manifolds: of each actor once, in their
    /// order.
    #[inline(always)]
    pub(super) fn place(&mut self, index: usize, reach: &Reach, centre: Vec2, way: &Way) -> &mut Actor {
        let Way { displacement: Vec2 { x, y }, rotation } = *way;
        let Reach { displacement: [step_x, step_y], turned } = *reach;
        let words = [
            step_x,
            step_y,
            turned,
            x.to_bits(),
            y.to_bits(),
            rotation.to_bits(),
            centre.x.to_bits(),
            centre.y.to_bits(),
        ];
        self.motions.push(Line(words));
        let actor = &mut self.actors[index];
        self.index_of.set(actor.number, index as u32);
        actor
    }

    /// Adds an outline with its motion, and returns its index.
    pub(super) fn push(&mut self, actor: Actor, reach: &Reach, centre: Vec2, way: &Way) -> usize {
        let index = self.actors.len();
        self.actors.push(actor);
        self.place(index, reach, centre, way);
        index
    }

    #[inline(always)]
    pub(super) fn get(&self, index: usize) -> &Actor {
        &self.actors[index]
    }

    /// The motion of an actor over the step.
    #[inline(always)]
    pub(super) fn reach(&self, index: usize) -> Reach {
        let Line([x, y, turned, ..]) = self.motions[index];
        Reach { displacement: [x, y], turned }
    }

    /// Returns true if the outlines of a pair stay so far apart on their free flights that they surely do not meet.
    #[inline(always)]
    pub(super) fn stay_apart(&self, pair: [usize; 2]) -> bool {
        let centres = pair.map(|index| {
            let Line([.., x, y]) = self.motions[index];
            [x, y]
        });
        let [a, b] = pair;
        self.reach(a).stays_apart(&self.reach(b), centres, self.actors[a].extent + self.actors[b].extent)
    }

    /// Begins a chunk of pairs.
    pub(super) fn begin_chunk(&mut self) {
        self.queues.iter_mut().for_each(Queue::clear);
    }

    /// Adds a pair to the chunk, if lanes take it. Returns its place.
    #[inline(always)]
    pub(super) fn push_pair(&mut self, cores: &mut Cores, pair: [usize; 2]) -> Option<LanePlace> {
        if !self.has_lanes {
            return None;
        }
        let [a, b] = pair.map(|index| &self.actors[index]);
        let shapes = [a.shape?, b.shape?];
        let kind = LaneKind::new(shapes);
        let (mut outlines, mut motions) = ([a.core, b.core], pair.map(|index| index as u32));
        if kind.has_polygons() {
            if !self.has_polygon_lanes {
                return None;
            }
            outlines = outlines.map(|core| cores.polygon(core as usize));
        }
        let is_swapped = shapes == [LaneShape::Disc, LaneShape::Box];
        if is_swapped {
            outlines.reverse();
            motions.reverse();
        }
        Some(LanePlace { kind, place: self.queues[kind as usize].push(outlines, motions, is_swapped) })
    }

    /// Finds the manifolds of the pairs of the chunk.
    pub(super) fn collide(&mut self, cores: &Cores) {
        let Self { motions, queues, .. } = self;
        for (kind, queue) in LaneKind::ALL.into_iter().zip(queues) {
            if let Some((pairs, manifolds)) = queue.groups() {
                cores.collide_pairs(kind, motions, CLOSE, pairs, manifolds);
            }
        }
    }

    /// The group of manifolds with a place, and its lane there.
    #[inline(always)]
    pub(super) fn manifolds(&self, LanePlace { kind, place }: LanePlace) -> (&LaneManifolds, usize) {
        (&self.queues[kind as usize].manifolds[place / GROUP], place % GROUP)
    }

    /// Returns true if contacts of a pair may be hits.
    #[inline(always)]
    pub(super) fn have_hits(&self, pair: [usize; 2]) -> bool {
        pair.into_iter().any(|index| self.actors[index].has_hits)
    }

    /// The coefficients of a pair, if both materials have numbers.
    #[inline(always)]
    pub(super) fn coefficients(&self, pair: [usize; 2]) -> Option<&Coefficients> {
        let [a, b] = pair.map(|index| self.actors[index].material);
        Some(self.materials.coefficients([a?, b?]))
    }
}
