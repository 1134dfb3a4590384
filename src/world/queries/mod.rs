//! Queries: which colliders a ray, a shape or a point meets.

mod around;
mod cast;
mod filter;
mod overlap;

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::{Moment, Stance, World};
use crate::body::{Activity, BodyKind};
use crate::collide::broad::{CoreAt, CoreTree, Path, PlacedCore, Proxy, Statics};
use crate::collider::{Collider, OutlineId};
use crate::contact::Pipeline;
use crate::fx::Fx;
use crate::query::{Core, Line, Placement, Point, beside};
use crate::scalar::Scalar;
use crate::shape::Aabb;
use crate::slots::{BodyId, ColliderId};

pub(crate) use around::Neighbour;
pub use cast::CastHit;
pub use filter::QueryFilter;
pub use overlap::ClosestPoint;

/// The colliders of a world, ready for queries. [`World::queries`] makes it: call that once for all queries between two changes of the
/// world, as it takes longer than a query.
///
/// Queries find the colliders of all bodies that take part, sleeping ones too. They do not find sensors, colliders whose
/// filter [meets nothing](crate::Filter::NONE), nor colliders of disabled or quarantined bodies.
///
/// Results are sorted by the fraction of the cast or by distance, then by the [key](crate::ColliderDef::key) of the collider, then by its
/// handle. They depend on the poses of bodies and on the definitions of colliders alone: a restored world gives the same results, and
/// with distinct keys so does a world that was built in another order. A collider with several parts is reported once, with the part that
/// comes first; where parts tie, the one with the least number.
///
/// A mirror image of a world has the mirror images of all results, to the bit. One number differs: the segments of a chain are counted the
/// other way round there, and where several segments tie the one with the least number is reported.
///
/// # Precision
/// Queries compute in integers. Corners of colliders are turned by the angle of their body and rounded to 2^-32 m; all further steps are
/// exact for shapes without a radius, and for others as if the radius were at most 2^-46 m smaller. Fractions are compared as multiples of
/// 2^-62 and distances as multiples of 2^-48 m: results that are closer together than that tie. A world of floats has its corners, its
/// poses and the arguments of queries converted to fixed point first.
///
/// ```
/// use umbra_physics::{BodyDef, Queries, QueryFilter, Shape, World, WorldDef, fx, vec2};
///
/// let mut world = World::new(WorldDef::default())?;
/// let wall = BodyDef { position: vec2(10, 0), ..BodyDef::fixed().with_collider(Shape::rectangle(2, 4)?) };
/// let wall = world.add_body(wall)?;
/// let ball = BodyDef { position: vec2(5, 0), ..BodyDef::dynamic().with_collider(Shape::circle(1)?) };
/// let ball = world.add_body(ball)?;
///
/// let queries: Queries<'_> = world.queries();
/// let hit = queries.cast_ray(vec2(0, 0), vec2(20, 0), &QueryFilter::default())?.unwrap();
/// assert_eq!((hit.body, hit.fraction, hit.point, hit.normal), (ball, fx!(0.2), vec2(4, 0), vec2(-1, 0)));
/// // All on the way; past the ball alone.
/// let hits = queries.cast_ray_all(vec2(0, 0), vec2(20, 0), &QueryFilter::default())?;
/// assert!(hits.iter().map(|hit| hit.body).eq([ball, wall]));
/// let past_the_ball = QueryFilter { without_bodies: &[ball], ..QueryFilter::default() };
/// let hit = queries.cast_ray(vec2(0, 0), vec2(20, 0), &past_the_ball)?.unwrap();
/// assert_eq!((hit.body, hit.point), (wall, vec2(9, 0)));
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Debug)]
pub struct Queries<'a, S: Scalar = Fx> {
    world: &'a World<S>,
    moment: Moment,
    statics: Arc<Statics>,
    /// The pipeline of contacts that numbered the outlines in `statics`; without one they are in `outlines`.
    pipeline: Option<&'a Pipeline>,
    /// The outlines of `statics` as they were when their tree was built, those that changed since, and those that may move.
    trees: [Arc<CoreTree>; 3],
    /// The outlines by the numbers that they have here.
    outlines: Vec<OutlineId>,
}

impl<S: Scalar> World<S> {
    /// The colliders of the world, ready for [queries](Queries).
    ///
    /// *Cost* The call builds a tree of the colliders of bodies that are not static, about 0.5 µs for each; while a body is asleep, it
    /// looks at all colliders. The tree of static colliders is built by the first call and kept, also by a [`Rollback`](crate::Rollback), so
    /// that they cost nothing in later calls; up to 512 changes of static colliders are kept beside it. It is built for this call alone, at
    /// the same price,
    ///
    /// - if a collider or a static body changed since the last step: one that was added with a new body too;
    /// - if more than 64 bodies, and more than an eighth of all, were changed since it, by contacts too where a field acts on them;
    /// - if the world was just made, cloned or restored, and always without the feature `std`.
    ///
    /// A query then takes time in proportion to the colliders that it meets and to the logarithm of the number of all.
    #[doc(alias("cast_ray", "cast_shape", "overlap_box", "raycast", "query_pipeline"))]
    #[must_use]
    pub fn queries(&self) -> Queries<'_, S> {
        self.queries_at(Moment::Now)
    }

    /// The colliders of the world as the next step finds its way through them: kinematic bodies are where their velocities or
    /// [targets](Self::move_to) take them in that step, and all others where they are now.
    ///
    /// It is for bodies that a game moves before a step, such as a [`Character`](crate::Character): after the step they stand exactly
    /// beside lifts, doors and each other. Nothing holds a kinematic body, so its way is known before; the way of a dynamic body is not.
    ///
    /// *Cost* as [`queries`](Self::queries). *Error* the way of a step, which the step may take in several parts, is within 1 ulp; a target
    /// is met to the bit.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, QueryFilter, Shape, TimeStep, World, WorldDef, vec2};
    ///
    /// let mut world = World::new(WorldDef { time_step: TimeStep::hz(64), ..WorldDef::default() })?;
    /// let lift = BodyDef { velocity: vec2(0, 4), ..BodyDef::kinematic() };
    /// world.add_body(lift.with_collider(Shape::rectangle(2, 2)?))?;
    /// let top = |world: &World, is_after: bool| {
    ///     let queries = if is_after { world.queries_after_step() } else { world.queries() };
    ///     let hit = queries.cast_ray(vec2(0, 9), vec2(0, -9), &QueryFilter::default()).unwrap();
    ///     hit.unwrap().point
    /// };
    /// let (before, after) = (top(&world, false), top(&world, true));
    /// assert_eq!((before, after - before), (vec2(0, 1), vec2(0, 4) / 64));
    /// world.step();
    /// assert_eq!(top(&world, false), after);
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[must_use]
    pub fn queries_after_step(&self) -> Queries<'_, S> {
        self.queries_at(Moment::AfterStep)
    }

    fn queries_at(&self, moment: Moment) -> Queries<'_, S> {
        let mut queries = Queries {
            world: self,
            moment,
            statics: Arc::default(),
            pipeline: None,
            trees: Default::default(),
            outlines: Vec::new(),
        };
        let [base, changed] = match self.workspace.statics(&self.bodies, &self.colliders) {
            Some((statics, pipeline)) => {
                (queries.statics, queries.pipeline) = (Arc::clone(statics), Some(pipeline));
                statics.cores(|number| self.place(pipeline.outline(number), moment))
            }
            None => queries.trees_of(self.colliders.list(), |kind| kind == BodyKind::Static),
        };
        let is_mover = |kind: BodyKind| kind != BodyKind::Static;
        let [movers, _] = if self.bodies.any_asleep() {
            queries.trees_of(self.colliders.list(), is_mover)
        } else {
            let moving = &self.bodies.columns.slot[..self.bodies.moving()];
            queries.trees_of(moving.iter().flat_map(|&slot| self.colliders.of_slot(slot)), is_mover)
        };
        queries.trees = [base, changed, movers];
        queries
    }
}

impl<S: Scalar> World<S> {
    /// The place of a body at a moment.
    #[inline]
    fn placement(&self, body: BodyId, moment: Moment) -> Option<Placement<S>> {
        let Stance { position, angle } = self.stance_at(self.bodies.find(body).ok()?, moment);
        Some(Placement::new(position, angle))
    }

    /// The core of an outline, relative to the position of its body.
    fn place(&self, outline: OutlineId, moment: Moment) -> Option<CoreAt> {
        let collider = self.colliders.at(outline.slot)?;
        let placement = self.placement(collider.body, moment)?;
        // It sees itself in reach.
        let core = Core::new(&collider.outline(outline.part).outline, &placement, placement.position())?;
        Some(CoreAt { core, position: placement.position(), is_link: collider.def.shape.is_chain() })
    }

    /// The core of an outline as seen from a point, if it is in reach, and whether it is a segment of a chain.
    fn core(&self, outline: OutlineId, from: Point, moment: Moment) -> Option<(Core, bool)> {
        let CoreAt { core, position: [x, y], is_link } = self.place(outline, moment)?;
        let corners: Vec<Point> = core.corners().iter().map(|corner| [corner[0] + x, corner[1] + y]).collect();
        Some((Core::at(&corners, core.radius, from)?, is_link))
    }
}

/// An outline that a search found: its collider is looked up only where it is needed.
#[derive(Clone, Copy)]
struct Found<'a, S: Scalar> {
    world: &'a World<S>,
    moment: Moment,
    outline: OutlineId,
    placed: Option<PlacedCore<'a>>,
}

/// A collider and an outline of it.
struct Target<'a, S: Scalar> {
    collider: &'a Collider<S>,
    id: ColliderId,
    part: u32,
}

impl<'a, S: Scalar> Found<'a, S> {
    /// The core of the outline as seen from a point, if it is in reach, and whether it is a segment of a chain.
    #[inline]
    fn core(&self, from: Point) -> Option<(Core, bool)> {
        match self.placed {
            Some(placed) => Some((Core::at(placed.corners, placed.radius, from)?, placed.is_link)),
            None => self.core_of(self.outline, from),
        }
    }

    /// The core of another outline as seen from a point, if it is in reach, and whether it is a segment of a chain.
    fn core_of(&self, outline: OutlineId, from: Point) -> Option<(Core, bool)> {
        self.world.core(outline, from, self.moment)
    }

    /// Returns true if it is beside a line.
    #[inline]
    fn is_beside(&self, line: &Line) -> bool {
        self.placed.is_some_and(|placed| line.misses(placed.corners, placed.radius))
    }

    /// The rank of a result.
    fn rank(&self, first: u128) -> Option<Rank> {
        let target = self.target()?;
        Some((first, target.collider.def.key, target.id, target.part))
    }

    fn target(&self) -> Option<Target<'a, S>> {
        let OutlineId { slot, part } = self.outline;
        let colliders = &self.world.colliders;
        Some(Target { collider: colliders.at(slot)?, id: colliders.id(slot), part })
    }
}

/// The order of results: the fraction or the distance, the key, the handle, the part.
type Rank = (u128, u64, ColliderId, u32);

impl<S: Scalar> Queries<'_, S> {
    /// The kind of a body that takes part.
    fn kind(&self, body: BodyId) -> Option<BodyKind> {
        let bodies = &self.world.bodies;
        let dense = bodies.find(body).ok()?;
        matches!(bodies.activity(dense), Activity::Awake | Activity::Asleep).then(|| bodies.info(dense).kind)
    }

    /// The trees of those of these colliders whose bodies are of some kinds. Their outlines are numbered from the end of `outlines` on.
    fn trees_of<'c>(
        &mut self,
        colliders: impl Iterator<Item = &'c Collider<S>>,
        is_wanted: impl Fn(BodyKind) -> bool,
    ) -> [Arc<CoreTree>; 2] {
        let first = self.outlines.len();
        let (mut proxies, mut places) = (Vec::new(), Vec::new());
        for collider in colliders {
            if !collider.def.is_solid() || !self.kind(collider.body).is_some_and(&is_wanted) {
                continue;
            }
            for part in 0..collider.outline_count() {
                let outline = OutlineId { slot: collider.slot, part };
                let Some(place) = self.world.place(outline, self.moment) else { continue };
                let corners = place.core.bounds().map(|corner| beside(place.position, corner));
                let [min, max] = corners.map(crate::query::in_scalar::<Fx>);
                let number = self.outlines.len() as u32;
                let filter = collider.def.filter;
                self.outlines.push(outline);
                places.push(Some(place));
                let bounds = Aabb { min, max };
                proxies.push(Proxy { collider: number, body: collider.body.slot, bounds, filter, digest: 0 });
            }
        }
        Statics::new(proxies).cores(|number| places[number as usize - first].take())
    }

    /// The outline of a number that a tree gave.
    #[inline]
    fn outline(&self, number: u32, is_static: bool) -> OutlineId {
        match self.pipeline {
            Some(pipeline) if is_static => pipeline.outline(number),
            _ => self.outlines[number as usize],
        }
    }

    /// Calls `visit` with the outlines whose boxes meet a box, until it returns false.
    fn in_box<'q>(
        &'q self,
        [min, max]: [Point; 2],
        filter: &QueryFilter<'_, S>,
        mut visit: impl FnMut(Found<'q, S>) -> bool,
    ) {
        self.on_path(&mut Path::new(min, max, [0; 2]), filter, |outline, _| visit(outline));
    }

    /// Calls `visit` with the outlines that a filter lets through and whose boxes may meet a path, until it returns false. It may shorten
    /// the path. All bodies in the trees take part.
    #[inline]
    fn on_path<'q>(
        &'q self,
        path: &mut Path,
        filter: &QueryFilter<'_, S>,
        mut visit: impl FnMut(Found<'q, S>, &mut Path) -> bool,
    ) {
        let names_some = !filter.without_bodies.is_empty() || !filter.without_colliders.is_empty();
        for (which, tree) in self.trees.iter().enumerate() {
            let goes_on = tree.search(path, filter.filter, |placed, path| {
                if which == 0 && self.statics.is_gone(placed.number) {
                    return true;
                }
                let outline = self.outline(placed.number, which < 2);
                let placed = (!placed.corners.is_empty()).then_some(placed);
                let outline = Found { world: self.world, moment: self.moment, outline, placed };
                let is_left_out = names_some && outline.target().is_none_or(|target| filter.leaves_out(&target));
                is_left_out || visit(outline, path)
            });
            if !goes_on {
                return;
            }
        }
    }
}

/// Sorts results, and keeps the first one of each collider.
fn sort_by_rank<T>(results: &mut Vec<(Rank, T)>) {
    results.sort_unstable_by_key(|&((first, _, id, part), _)| (id, first, part));
    results.dedup_by_key(|((_, _, id, _), _)| *id);
    results.sort_unstable_by_key(|(rank, _)| *rank);
}
