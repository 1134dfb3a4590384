//! Queries: which colliders a ray, a shape or a point meets.

mod cast;
mod filter;
mod overlap;

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::World;
use crate::body::{Activity, BodyKind};
use crate::collide::broad::{Path, Proxy, Statics};
use crate::collider::{Collider, Filter, OutlineId};
use crate::contact::ContactEngine as _;
use crate::fx::Fx;
use crate::query::{Core, Placement, Point, beside};
use crate::scalar::{Accumulator as _, Scalar};
use crate::shape::Aabb;
use crate::slots::{BodyId, ColliderId};

pub use cast::CastHit;
pub use filter::QueryFilter;
pub use overlap::ClosestPoint;

/// The colliders of a world, ready for queries. [`World::queries`] makes it; make it once for all queries between two changes.
///
/// Found are the colliders of all bodies but those that are disabled or quarantined: sleeping ones too. Sensors are not found. Results depend on the poses of
/// bodies and on the definitions of colliders alone: a world that was just restored, and one that was built in another order, give
/// the same. They are sorted: by the fraction of a ray or by the distance, then by the [key](crate::ColliderDef::key) of the collider,
/// then by its handle. Of a collider with several parts the part that comes first is reported, and of parts that tie the one with the least
/// number. So with distinct keys the order does not depend on the order in which the world was built.
///
/// A mirror image of a world has the mirror images of all results, to the bit, but for the numbers of the segments of a chain, which run
/// the other way there: where a ray meets a seam or a shape meets several segments at once, the one with the least number is reported.
///
/// # Precision
/// Queries compute in integers. Corners of colliders are turned by the angle of their body and rounded to 2^-32 m; all that follows is
/// exact for shapes without a radius, and for others as if the radius were at most 2^-46 m smaller. Fractions are compared as multiples of
/// 2^-62 and distances as multiples of 2^-48 m: what is closer together than that ties. A world of floats has its corners,
/// its poses and the arguments of queries converted to fixed point first.
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
    statics: Arc<Statics>,
    /// The engine of contacts that numbered the outlines in `statics`; without one they are in `outlines`.
    engine: Option<&'a S::Contacts>,
    movers: Statics,
    /// The outlines by their numbers in `movers`.
    outlines: Vec<OutlineId>,
}

impl<S: Scalar> World<S> {
    /// The colliders of the world, ready for [queries](Queries).
    ///
    /// *Cost* The static colliders stand in a tree that steps make and keep, so that they cost nothing here, unless a static body or a
    /// collider has changed since the last step, or the world was just made, cloned or restored: then their tree is built here, which
    /// takes about 0.5 µs for each, and more for compounds and chains. A tree of the colliders of all other bodies is always built, at
    /// the same price; while a body is asleep, this looks at all colliders. A query then takes time in proportion to what it meets and to the logarithm of the number of colliders.
    #[must_use]
    pub fn queries(&self) -> Queries<'_, S> {
        let mut queries = Queries {
            world: self,
            statics: Arc::default(),
            engine: None,
            movers: Statics::default(),
            outlines: Vec::new(),
        };
        if let Some((statics, engine)) = self.workspace.statics(&self.bodies, &self.colliders) {
            (queries.statics, queries.engine) = (Arc::clone(statics), Some(engine));
        } else if self.bodies.len() > 0 {
            queries.statics = Arc::new(queries.tree(self.colliders.list(), |kind| kind == BodyKind::Static));
        }
        let is_mover = |kind: BodyKind| kind != BodyKind::Static;
        queries.movers = if self.bodies.any_asleep() {
            queries.tree(self.colliders.list(), is_mover)
        } else {
            let moving = &self.bodies.columns.slot[..self.bodies.moving()];
            queries.tree(moving.iter().flat_map(|&slot| self.colliders.of_slot(slot)), is_mover)
        };
        queries
    }
}

/// A collider, an outline of it, and where it is.
struct Target<'a, S: Scalar> {
    collider: &'a Collider<S>,
    id: ColliderId,
    part: u32,
    placement: Placement<S>,
}

impl<S: Scalar> Target<'_, S> {
    /// The core of the outline as seen from a point, if it is in reach.
    #[inline]
    fn core(&self, from: Point) -> Option<Core> {
        Core::new(&self.collider.outline(self.part).outline, &self.placement, from)
    }
}

/// What a result is sorted by: the fraction or the distance, the key, the handle, the part.
type Rank = (u128, u64, ColliderId, u32);

impl<S: Scalar> Queries<'_, S> {
    /// The place of a body.
    #[inline]
    fn placement(&self, body: BodyId) -> Option<Placement<S>> {
        let bodies = &self.world.bodies;
        let dense = bodies.find(body).ok()?;
        let motion = &bodies.columns.motion;
        Some(Placement::new(motion.position.get(dense).map(|part| part.value()), motion.angle[dense]))
    }

    /// The kind of a body that takes part.
    fn kind(&self, body: BodyId) -> Option<BodyKind> {
        let bodies = &self.world.bodies;
        let dense = bodies.find(body).ok()?;
        matches!(bodies.activity(dense), Activity::Awake | Activity::Asleep).then(|| bodies.info(dense).kind)
    }

    /// The tree of those of these colliders whose bodies are of some kinds. Their outlines are numbered from the end of `outlines` on.
    fn tree<'c>(
        &mut self,
        colliders: impl Iterator<Item = &'c Collider<S>>,
        is_wanted: impl Fn(BodyKind) -> bool,
    ) -> Statics {
        let mut proxies = Vec::new();
        for collider in colliders {
            if collider.def.sensor || !self.kind(collider.body).is_some_and(&is_wanted) {
                continue;
            }
            let Some(placement) = self.placement(collider.body) else { continue };
            for part in 0..collider.outline_count() {
                // It sees itself in reach.
                let Some(core) = Core::new(&collider.outline(part).outline, &placement, placement.position()) else {
                    continue;
                };
                let [min, max] =
                    core.bounds().map(|corner| crate::query::in_scalar::<Fx>(beside(placement.position(), corner)));
                let number = self.outlines.len() as u32;
                self.outlines.push(OutlineId { slot: collider.slot, part });
                let filter = collider.def.filter;
                proxies.push(Proxy { collider: number, body: collider.body.slot, bounds: Aabb { min, max }, filter });
            }
        }
        Statics::new(proxies)
    }

    /// The outline of a number that a tree gave, if a filter lets it through: its body takes part, as none other is in a tree.
    #[inline]
    fn target(&self, number: u32, is_static: bool, filter: &QueryFilter<'_, S>) -> Option<Target<'_, S>> {
        let outline = match self.engine {
            Some(engine) if is_static => engine.outline(number),
            _ => self.outlines[number as usize],
        };
        let collider = self.world.colliders.at(outline.slot)?;
        let id = self.world.colliders.id(outline.slot);
        if !filter.lets_through(id, collider) {
            return None;
        }
        let placement = self.placement(collider.body)?;
        Some(Target { collider, id, part: outline.part, placement })
    }

    /// An outline of a collider.
    fn target_of(&self, id: ColliderId, part: u32) -> Option<Target<'_, S>> {
        let collider = self.world.colliders.get(id).ok()?;
        Some(Target { collider, id, part, placement: self.placement(collider.body)? })
    }

    /// Calls `found` with the targets whose boxes meet a box, until it returns false.
    fn in_box(
        &self,
        [min, max]: [Point; 2],
        filter: &QueryFilter<'_, S>,
        mut found: impl FnMut(&Target<'_, S>) -> bool,
    ) {
        let [min, max] = [min, max].map(crate::query::in_scalar::<Fx>);
        let mut goes_on = true;
        for (tree, is_static) in [(&*self.statics, true), (&self.movers, false)] {
            if !goes_on {
                return;
            }
            tree.search_box(Aabb { min, max }, filter.meeting(), |number| {
                goes_on = self.target(number, is_static, filter).is_none_or(|target| found(&target));
                goes_on
            });
        }
    }

    /// Calls `found` with the targets whose boxes meet a path, until it returns false. It may shorten the path.
    #[inline]
    fn on_path(
        &self,
        path: &mut Path,
        filter: &QueryFilter<'_, S>,
        mut found: impl FnMut(&Target<'_, S>, &mut Path) -> bool,
    ) {
        let mut goes_on = true;
        for (tree, is_static) in [(&*self.statics, true), (&self.movers, false)] {
            if !goes_on {
                return;
            }
            tree.search_path(path, filter.meeting(), |number, path| {
                goes_on = self.target(number, is_static, filter).is_none_or(|target| found(&target, path));
                goes_on
            });
        }
    }
}

/// Sorts results, and keeps the first one of each collider.
fn sort_by_rank<T>(found: &mut Vec<(Rank, T)>) {
    found.sort_unstable_by_key(|&((first, _, id, part), _)| (id, first, part));
    found.dedup_by_key(|((_, _, id, _), _)| *id);
    found.sort_unstable_by_key(|(rank, _)| *rank);
}

/// All categories, for queries without a filter.
const ALL: Filter = Filter { category: !0, mask: !0, group: 0 };
