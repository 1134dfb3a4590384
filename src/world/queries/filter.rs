//! Filters: the colliders that a query finds.

use core::fmt;

use super::Target;
use crate::collider::{ColliderDef, Filter};
use crate::fx::Fx;
use crate::scalar::Scalar;
use crate::slots::{BodyId, ColliderId};

/// A condition of the caller on a collider.
type Predicate<'a, S> = &'a dyn Fn(ColliderId, &ColliderDef<S>) -> bool;

/// The colliders that a query finds: all by default.
///
/// ```
/// use umbra_physics::{BodyDef, ColliderDef, Filter, QueryFilter, Shape, World, WorldDef, vec2};
///
/// let mut world = World::new(WorldDef::default())?;
/// for (x, category, user_data) in [(2, 1, 0), (4, 2, 7), (6, 2, 8)] {
///     let filter = Filter { category, ..Filter::default() };
///     let disc = ColliderDef { filter, user_data, ..ColliderDef::new(Shape::circle(1)?) };
///     world.add_body(BodyDef { position: vec2(x, 0), ..BodyDef::fixed().with_collider(disc) })?;
/// }
/// let queries = world.queries();
/// let first = |filter: &QueryFilter| queries.cast_ray(vec2(0, 0), vec2(9, 0), filter).unwrap().unwrap().point.x;
/// assert_eq!(first(&QueryFilter::default()), 1.into());
/// // Only the second category.
/// let targets = QueryFilter { filter: Some(Filter { mask: 2, ..Filter::default() }), ..QueryFilter::default() };
/// assert_eq!(first(&targets), 3.into());
/// // A condition of your own.
/// let marked = QueryFilter { predicate: Some(&|_, def| def.user_data == 8), ..targets };
/// assert_eq!(first(&marked), 5.into());
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Copy, Default)]
pub struct QueryFilter<'a, S: Scalar = Fx> {
    /// The filter of the query: colliders are found whose own filter [agrees](Filter::agrees) with it. It counts both ways: a collider is
    /// found only if its mask has a category of the query, which is 1 by default. `None` for all colliders.
    pub filter: Option<Filter>,
    /// Bodies to leave out, such as the player who shoots. *Cost* each collider that is met is compared with all of them.
    pub without_bodies: &'a [BodyId],
    /// Colliders to leave out, at the same cost.
    pub without_colliders: &'a [ColliderId],
    /// A condition: a collider for which it returns false is left out. It is called for the colliders that the query meets and that pass
    /// the rest of the filter, in the order of the results, and not for colliders behind the first hit if only that is asked for.
    /// [`closest_point`](super::Queries::closest_point) may call it again for the same collider. It is not recorded, and is called again in
    /// a rollback or a replay: it must depend on the world and its arguments only.
    pub predicate: Option<Predicate<'a, S>>,
}

impl<S: Scalar> fmt::Debug for QueryFilter<'_, S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("QueryFilter")
            .field("filter", &self.filter)
            .field("without_bodies", &self.without_bodies)
            .field("without_colliders", &self.without_colliders)
            .field("predicate", &self.predicate.map(|_| "Fn"))
            .finish()
    }
}

impl<S: Scalar> QueryFilter<'_, S> {
    /// Returns true if a collider is named as one to leave out, or its body is.
    #[inline]
    pub(super) fn leaves_out(&self, target: &Target<'_, S>) -> bool {
        self.without_bodies.contains(&target.collider.body) || self.without_colliders.contains(&target.id)
    }

    /// Returns true if the predicate lets a collider through.
    pub(super) fn accepts(&self, id: ColliderId, def: &ColliderDef<S>) -> bool {
        self.predicate.is_none_or(|predicate| predicate(id, def))
    }
}
