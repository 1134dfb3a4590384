//! The narrow phase: the manifold of a pair of outlines, at the [moment](super::moment) of the step that fits the pair.
//!
//! Reads: the flights of the bodies, the surfaces of polygons beside each other, records of the step before. Writes: manifolds.

mod over_seams;

use core::slice::from_ref;

use self::over_seams::presses_nearby;
use super::actors::{Actor, Actors, LanePlace};
use super::body_tiles::BodyTiles;
use super::flights::{FlightKind, Flights, PairSide, Place};
use super::moment::{LEVEL, SLOW, Way};
use super::movers::{Form, MovingOutline};
use super::reach::Reach;
use super::resting::Resting;
use super::seams::Unions;
use super::slot_table::SlotTable;
use super::sweep::{Paths, form};
use super::tiles::{SLANTED, Tiles, is_polygon};
use super::{ContactRecord, MARGIN, Scene};
use crate::collide::sweep::{Moment, Second, Sweep};
use crate::collide::{Cores, LANE_CORNERS, Manifold, Margin, Pose};
use crate::collider::OutlineId;
use crate::fx::Fx;
use crate::math::Vec2;
use crate::shape::Aabb;
use crate::shape::union::Face;
use crate::slots::NONE;

/// The memory of the narrow phase: outlines in world axes, each placed when it is first asked for, and surfaces of polygons.
#[derive(Debug, Default)]
pub(super) struct Narrow {
    cores: Cores,
    /// The index in `cores` of an outline at the moment of manifolds, by the number of the outline.
    core_of: SlotTable,
    /// The index in `cores` of an outline at the start of the step.
    start_core_of: SlotTable,
    tiles: Tiles,
    body_tiles: BodyTiles,
    unions: Unions,
    moment: Moment,
    pub(super) actors: Actors,
    /// No contact is found ahead of time.
    #[cfg(feature = "selftest")]
    pub(super) is_discrete: bool,
}

/// The manifold of a pair, and the ways of its two bodies from the start of the step to the moment of the manifold.
#[derive(Debug)]
pub(super) struct Meeting {
    pub(super) manifold: Manifold,
    pub(super) ways: [Way; 2],
}

impl Narrow {
    /// Forgets the outlines of the last search; `have_statics_changed` is true if the surfaces of static polygons may have changed.
    pub(super) fn begin(&mut self, have_statics_changed: bool) {
        self.cores.clear();
        self.core_of.clear();
        self.start_core_of.clear();
        self.actors.clear();
        self.unions.clear();
        if have_statics_changed {
            self.tiles.clear();
        }
    }

    /// Forgets the outlines of the last search at the moment of manifolds.
    pub(super) fn forget_placed(&mut self) {
        self.cores.clear();
        self.core_of.clear();
        self.actors.clear();
    }

    /// Forgets the surfaces of static polygons.
    pub(super) fn forget_tiles(&mut self) {
        self.tiles.clear();
    }

    /// The index of an outline at the moment of manifolds.
    #[inline(always)]
    fn core(&mut self, scene: &Scene<'_>, flights: &Flights, resting: &Resting, side: &PairSide<'_>) -> usize {
        match self.core_of.get(side.number) {
            NONE => {
                let core = self.push_core(scene, flights, resting, side, &flights.body(side.flight).pose);
                self.core_of.set(side.number, core as u32);
                core
            }
            core => core as usize,
        }
    }

    /// The index of an outline at the start of the step.
    fn start_core(&mut self, scene: &Scene<'_>, flights: &Flights, resting: &Resting, side: &PairSide<'_>) -> usize {
        let Some(pose) = flights.start_pose(scene, side.flight) else {
            return self.core(scene, flights, resting, side);
        };
        match self.start_core_of.get(side.number) {
            NONE => {
                let core = self.push_core(scene, flights, resting, side, &pose);
                self.start_core_of.set(side.number, core as u32);
                core
            }
            core => core as usize,
        }
    }

    /// Places an outline at a pose of its body, and gives a polygon its surface.
    fn push_core(
        &mut self,
        scene: &Scene<'_>,
        flights: &Flights,
        resting: &Resting,
        side: &PairSide<'_>,
        pose: &Pose,
    ) -> usize {
        let outline = side.outline();
        let core = self.cores.push(&outline.outline, pose);
        if !is_polygon(&outline) {
            return core;
        }
        if side.kind == FlightKind::Static {
            let statics = resting.trees.as_ref().map(|trees| &trees.statics);
            let tiles = &mut self.tiles;
            let faces =
                statics.and_then(|statics| tiles.find(scene, statics, &resting.numbers, side.number, &outline, pose));
            if let Some(faces) = faces {
                self.cores.set_faces(faces.iter().copied());
            }
        } else if side.collider.has_others() {
            let body = flights.body(side.flight).slot;
            if let Some(faces) = self.body_tiles.find(scene.colliders, body, side.id) {
                self.cores.set_faces(faces.iter().map(|face| face.turned(pose)));
            }
        }
        core
    }

    /// The surface of an outline that was placed; none if the outline stands alone.
    pub(super) fn faces(&self, scene: &Scene<'_>, side: &PairSide<'_>) -> &[Face] {
        let surface = match side.kind {
            FlightKind::Static => self.tiles.surface(side.number),
            _ if side.collider.has_others() => {
                self.body_tiles.surface(scene.colliders, side.collider.body.slot, side.id)
            }
            _ => None,
        };
        surface.unwrap_or_default()
    }

    /// The largest distance of two outlines at which they have a manifold.
    #[inline(always)]
    fn margin(&self, flights: &Flights, pair: [&PairSide<'_>; 2]) -> Margin {
        #[cfg(feature = "selftest")]
        if self.is_discrete {
            return MARGIN.into();
        }
        flights.reach(pair[0]).closing(&flights.reach(pair[1]))
    }

    /// The manifold of a pair at the start of the step.
    pub(super) fn start_manifold(
        &mut self,
        scene: &Scene<'_>,
        flights: &Flights,
        resting: &Resting,
        pair: [&PairSide<'_>; 2],
    ) -> Option<Manifold> {
        let cores = pair.map(|side| self.start_core(scene, flights, resting, side));
        self.cores.collide(cores[0], cores[1], self.margin(flights, pair))
    }

    /// The manifold of a pair at the moment of manifolds of bodies that press each other.
    #[inline(always)]
    pub(super) fn mean_manifold(
        &mut self,
        scene: &Scene<'_>,
        flights: &Flights,
        resting: &Resting,
        pair: [&PairSide<'_>; 2],
    ) -> Option<Manifold> {
        let first = self.core(scene, flights, resting, pair[0]);
        let second = self.core(scene, flights, resting, pair[1]);
        self.cores.collide(first, second, self.margin(flights, pair))
    }

    /// Returns true for an outline on a union: a segment of a chain, or a polygon beside others, of static bodies or of one body. Points go over its seams.
    #[inline(always)]
    pub(super) fn is_on_union(&self, scene: &Scene<'_>, side: &PairSide<'_>) -> bool {
        side.collider.def.shape.is_chain() || side.may_be_tile() && !self.faces(scene, side).is_empty()
    }

    /// The manifold of two actors in place of this one, at the moment of bodies that press each other: see
    /// [`manifold_before`](ContactRecord::manifold_before).
    pub(super) fn manifold_before(
        &self,
        record: &ContactRecord,
        actors: [usize; 2],
        manifold: &Manifold,
    ) -> Option<Manifold> {
        record.manifold_before(manifold, |corners| {
            let cores = actors.map(|actor| self.core_of.get(self.actors.get(actor).number));
            let margin = self.actors.reach(actors[0]).closing(&self.actors.reach(actors[1]));
            let are_placed = !cores.contains(&NONE);
            let cores = are_placed.then_some(cores.map(|core| core as usize))?;
            self.cores.between_edges(cores, manifold.normal, corners, margin)
        })
    }

    /// Returns true if two outlines have a manifold, or would have one after a small shift. Outlines that overlap have none where all
    /// directions out tie, such as two discs with one centre: the shift tells these from outlines that are apart. The four shifts are their
    /// own mirror image.
    pub(super) fn are_near(
        &mut self,
        scene: &Scene<'_>,
        flights: &Flights,
        resting: &Resting,
        pair: [&PairSide<'_>; 2],
    ) -> bool {
        /// 2^-10 m
        const SHIFT: Fx = Fx::from_bits(1 << 22);
        if self.mean_manifold(scene, flights, resting, pair).is_some() {
            return true;
        }
        let second_core = self.core(scene, flights, resting, pair[1]);
        let outline = pair[0].outline();
        let pose = flights.body(pair[0].flight).pose;
        let margin = self.margin(flights, pair);
        let shifts = [(SHIFT, Fx::ZERO), (-SHIFT, Fx::ZERO), (Fx::ZERO, SHIFT), (Fx::ZERO, -SHIFT)];
        shifts.into_iter().any(|(x, y)| {
            let first_core = self.cores.push(&outline.outline, &pose.shifted(Vec2::new(x, y)));
            self.cores.collide(first_core, second_core, margin).is_some()
        })
    }

    /// The index of an outline among the actors of the step; `None` if its collider is gone.
    #[inline(always)]
    pub(super) fn actor(
        &mut self,
        scene: &Scene<'_>,
        flights: &mut Flights,
        resting: &Resting,
        number: u32,
    ) -> Option<usize> {
        if let Some(actor) = self.actors.find(number) {
            return Some(actor);
        }
        let side = flights.side(scene, &resting.numbers, number)?;
        if side.outline().outline.corners().len() <= LANE_CORNERS {
            _ = self.core(scene, flights, resting, &side);
        }
        Some(self.push_side(scene, flights, &side, flights.reach(&side), side.radius().to_bits()))
    }

    /// Places an outline of a body that moves, which is this actor. Returns the box around it over the step.
    #[inline(always)]
    pub(super) fn place_mover(
        &mut self,
        scene: &Scene<'_>,
        flights: &Flights,
        actor: usize,
        outline: &MovingOutline,
    ) -> Aabb {
        let &MovingOutline { number, id, form, extent, .. } = outline;
        let &Place { kind, ref pose, ref way, .. } = flights.body(outline.flight);
        let flight = flights.flight(outline.flight);
        let reach = Reach::new(flight, Fx::from_bits(extent));
        let (core, bounds) = match form {
            Form::Disc { centre, radius } => self.cores.push_disc(centre, radius, pose),
            Form::Upright { corner, radius } => self.cores.push_upright(corner, radius, pose),
            Form::Other => self.push_other(scene, id, pose),
        };
        let mut shape = None;
        if core != NONE {
            self.core_of.set(number, core);
            shape = self.cores.lane_shape(core as usize);
        }
        let place = self.actors.place(actor, &reach, flight.position, way);
        (place.kind, place.core, place.shape) = (kind, core, shape);
        reach.swept(bounds)
    }

    /// Places an outline of a body that moves, unless it has many corners or is a polygon beside others: these have a surface, which is found
    /// when a pair asks for it. Returns its index, or [`NONE`], and the box around it.
    fn push_other(&mut self, scene: &Scene<'_>, id: OutlineId, pose: &Pose) -> (u32, Aabb) {
        let Some(collider) = scene.colliders.at(id.slot) else {
            return (NONE, Aabb::around(&[pose.position()], Fx::ZERO));
        };
        let outline = collider.outline(id.part);
        let bounds = pose.outline_bounds(&outline);
        let is_placed = outline.outline.corners().len() <= LANE_CORNERS && !collider.has_others();
        let core = if is_placed { self.cores.push(&outline.outline, pose) as u32 } else { NONE };
        (core, bounds)
    }

    fn push_side(
        &mut self,
        scene: &Scene<'_>,
        flights: &Flights,
        side: &PairSide<'_>,
        reach: Reach,
        extent: i64,
    ) -> usize {
        let PairSide { number, id, flight, kind, .. } = *side;
        let core = self.core_of.get(number);
        let shape = if core == NONE { None } else { self.cores.lane_shape(core as usize) };
        let def = &side.collider.def;
        let material = self.actors.materials.number(scene, &def.material);
        let is_alone = !side.may_be_tile() && !def.shape.is_chain();
        let has_hits = def.hit_events;
        let actor = Actor { number, id, flight, kind, core, shape, material, has_hits, is_alone, extent };
        self.actors.push(actor, &reach, flights.flight(flight).position, &flights.body(flight).way)
    }

    /// Takes a pair of actors for the lanes, if these have its shapes and it has the manifold of bodies that press each other: returns its place
    /// there. `pressed` as in [`meet`](Self::meet).
    #[inline(always)]
    pub(super) fn push_pair(&mut self, actors: [usize; 2], pressed: bool) -> Option<LanePlace> {
        let [a, b] = actors.map(|actor| self.actors.get(actor));
        let reaches = actors.map(|actor| self.actors.reach(actor));
        let are_awake = a.kind != FlightKind::Asleep && b.kind != FlightKind::Asleep;
        let is_mean = are_awake && (pressed || reaches[0].approach_bound(&reaches[1]) <= SLOW);
        #[cfg(feature = "selftest")]
        let is_mean = is_mean && !self.is_discrete;
        if is_mean { self.actors.push_pair(&mut self.cores, actors) } else { None }
    }

    /// Finds the manifolds of the pairs in the lanes.
    pub(super) fn collide_pairs(&mut self) {
        let Self { cores, actors, .. } = self;
        actors.collide(cores);
    }

    /// Returns true if two outlines, which did not press each other in the step before, are asked for the moment at which they meet.
    #[inline(always)]
    fn is_asked(&self, kinds: [FlightKind; 2], reaches: &[Reach; 2]) -> bool {
        #[cfg(feature = "selftest")]
        if self.is_discrete {
            return false;
        }
        let bound = reaches[0].approach_bound(&reaches[1]);
        bound > SLOW || bound > 0 && kinds.contains(&FlightKind::Asleep)
    }

    /// Returns true if two actors, which did not press each other in the step before, surely do not [meet](Self::meet).
    #[inline(always)]
    pub(super) fn stay_apart(&self, flights: &Flights, actors: [usize; 2]) -> bool {
        let [a, b] = actors.map(|actor| self.actors.get(actor));
        let reaches = actors.map(|actor| self.actors.reach(actor));
        a.is_alone
            && b.is_alone
            && self.is_asked([a.kind, b.kind], &reaches)
            && (self.actors.stay_apart(actors) || self.outlines_stay_apart(flights, actors))
    }

    /// Returns true if the outlines of two actors surely do not touch on their free flights.
    #[inline(always)]
    fn outlines_stay_apart(&self, flights: &Flights, actors: [usize; 2]) -> bool {
        let [a, b] = actors.map(|actor| self.actors.get(actor));
        if a.core == NONE || b.core == NONE {
            return false;
        }
        let motions = [a, b].map(|actor| flights.placed_motion(actor.flight, &[], actor.extent));
        self.cores.stay_apart([a.core as usize, b.core as usize], &motions)
    }

    /// Finds where the outlines of a pair, which are these actors, meet; `None` if they do not meet in the step. `pressed` is true if they
    /// pressed each other in the step before.
    #[inline(always)]
    pub(super) fn meet(
        &mut self,
        scene: &Scene<'_>,
        flights: &mut Flights,
        resting: &Resting,
        pair: [&PairSide<'_>; 2],
        actors: [usize; 2],
        pressed: bool,
    ) -> Option<Meeting> {
        let reaches = actors.map(|actor| self.actors.reach(actor));
        let ways = pair.map(|side| flights.body(side.flight).way);
        if pressed || !self.is_asked(pair.map(|side| side.kind), &reaches) || presses_nearby(scene, pair) {
            let cores = [self.core(scene, flights, resting, pair[0]), self.core(scene, flights, resting, pair[1])];
            let margin = reaches[0].closing(&reaches[1]);
            #[cfg(feature = "selftest")]
            let margin = if self.is_discrete { MARGIN.into() } else { margin };
            let manifold = self.cores.collide(cores[0], cores[1], margin)?;
            return Some(Meeting { manifold, ways });
        }
        if (pair[0].may_be_tile() || pair[1].may_be_tile()) && self.have_faces(scene, flights, resting, pair) {
            if let Some(manifold) = self.mean_manifold(scene, flights, resting, pair) {
                if self.comes_over_seams(scene, flights, resting, pair, &manifold, SLANTED) {
                    return Some(Meeting { manifold, ways });
                }
            }
        }
        if self.actors.stay_apart(actors) {
            return None;
        }
        let paths = Paths { scene, corrections: &[], is_corrected: false };
        let meeting = self.meet_on_paths(&paths, flights, resting, pair)?;
        // A body does not meet a tile of a level surface before it arrives there.
        let is_later = self.comes_over_seams(scene, flights, resting, pair, &meeting.manifold, LEVEL);
        (!is_later).then_some(meeting)
    }

    /// [`meet`](Self::meet) for the moment at which these paths meet.
    pub(super) fn meet_on_paths(
        &mut self,
        paths: &Paths<'_>,
        flights: &Flights,
        resting: &Resting,
        pair: [&PairSide<'_>; 2],
    ) -> Option<Meeting> {
        let legs = pair.map(|side| paths.leg(flights, side.flight));
        let outlines = pair.map(PairSide::outline);
        let reach = outlines[0].radius.saturating_add(outlines[1].radius);
        if legs[0].stays_apart(&legs[1], reach.to_bits()) {
            return None;
        }
        if pair.into_iter().all(|side| !side.collider.def.shape.is_chain()) {
            let motion = |side: usize| {
                flights.placed_motion(pair[side].flight, paths.corrections, outlines[side].radius.to_bits())
            };
            let motions = [motion(0), motion(1)];
            let cores = pair.map(|side| self.core(paths.scene, flights, resting, side));
            if self.cores.stay_apart(cores, &motions) {
                return None;
            }
        }
        let forms = [form(pair[0].collider, &outlines[0]), form(pair[1].collider, &outlines[1])];
        let pieces = [from_ref(&legs[0]), from_ref(&legs[1])];
        let sweep = Sweep { forms: [&forms[0], &forms[1]], paths: pieces, second: Second::GivesWay };
        let moment = sweep.first_touch(&mut self.moment)?;
        let mut cores = [0; 2];
        for side in 0..2 {
            cores[side] = if legs[side].moves() {
                let (centre, angle) = legs[side].pose(moment);
                let pose = Pose::new(Vec2::new(Fx::from_bits(centre[0]), Fx::from_bits(centre[1])), angle);
                self.push_core(paths.scene, flights, resting, pair[side], &pose)
            } else {
                self.core(paths.scene, flights, resting, pair[side])
            };
        }
        let ways = pair.map(|side| Way::along(&flights.deflected(side.flight, paths.corrections), moment));
        let manifold = self.cores.collide(cores[0], cores[1], MARGIN.into())?;
        Some(Meeting { manifold, ways })
    }
}
