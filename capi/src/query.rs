//! Queries: rays, shapes that are cast, overlaps and closest points.
//!
//! Each call gets the colliders of moving bodies ready, which takes about 0.5 µs for each: `umbra_world_cast_rays` does so once for many
//! rays.

use std::ffi::c_void;
use std::mem::MaybeUninit;

use umbra_physics::{
    Aabb, BodyId, CastHit, ClosestPoint, ColliderDef, ColliderId, Filter, Fx, Queries, QueryFilter, ShapeDistance,
    ShapeHit, ShapeImpact, Sweep,
};

use crate::collider::{UMBRA_ALL_CATEGORIES, collider_id, collider_word};
use crate::memory::{fill, given, slice};
use crate::number::{UmbraFx, UmbraVec2, vector};
use crate::shape::UmbraShape;
use crate::status::{Refusal, Result, UmbraStatus, guard};
use crate::world::{UmbraWorld, body_id, body_word};

/// A condition of the caller's on a collider, with its `user_data`: 0 to leave it out. It is called in the order of the results, and must
/// not call functions that change the world.
pub type UmbraPredicate = Option<unsafe extern "C" fn(context: *mut c_void, collider: u64, user_data: u64) -> u32>;

/// The colliders that a query finds; `umbra_query_filter_default` fills it in so that all are found. Null finds all, too.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct UmbraQueryFilter {
    /// The categories of the query, as bits; default all.
    pub category: u32,
    /// The categories that it finds, as bits; default all. A collider is found if each has a category in the other's mask.
    pub mask: u32,
    /// The group, which counts as that of a collider; 0 for none.
    pub group: i32,
    /// 0.
    pub reserved: u32,
    /// Bodies to leave out.
    pub without_bodies: *const u64,
    /// Number of them.
    pub without_body_count: usize,
    /// Colliders to leave out.
    pub without_colliders: *const u64,
    /// Number of them.
    pub without_collider_count: usize,
    /// A condition; null for none.
    pub predicate: UmbraPredicate,
    /// The first argument of the condition.
    pub context: *mut c_void,
}

/// A ray.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UmbraRay {
    /// The start of the ray, m.
    pub origin: UmbraVec2,
    /// The translation from the start to the end, m; each component within ±2^20.
    pub translation: UmbraVec2,
}

/// A collider that a ray or a shape met on its way.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UmbraCastHit {
    /// The collider; 0 for a shape without a world.
    pub collider: u64,
    /// The body of the collider; 0 for a shape without a world.
    pub body: u64,
    /// The fraction of the translation, from 0 to 1, rounded down.
    pub fraction: UmbraFx,
    /// The point where they meet, m.
    pub point: UmbraVec2,
    /// The outward unit normal of the surface there, that of all tiles together at a seam of tiles; zero if a ray starts in the collider, or a shape
    /// overlaps it at the start.
    pub normal: UmbraVec2,
    /// Number of the part of a compound or of the segment of a chain; 0 of all others.
    pub part: u32,
    /// 1; 0 if nothing was met, and then all else is 0 as well.
    pub is_hit: u32,
}

/// The point of a collider that is nearest to a point.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UmbraClosestPoint {
    /// The collider.
    pub collider: u64,
    /// The body of the collider.
    pub body: u64,
    /// The distance, m; 0 in the collider.
    pub distance: UmbraFx,
    /// The nearest point, m.
    pub point: UmbraVec2,
    /// Number of the part of a compound or of the segment of a chain; 0 of all others.
    pub part: u32,
    /// 1; 0 if nothing is that near, and then all else is 0 as well.
    pub is_found: u32,
}

/// The distance of two shapes, or the depth in which they overlap.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UmbraShapeDistance {
    /// The distance of the surfaces, m; negative where they overlap: the length of the shortest translation that separates them.
    pub separation: UmbraFx,
    /// The unit vector from the first shape to the second one along which they are that far apart.
    pub normal: UmbraVec2,
    /// The point of the first shape that is nearest to the second one, or deepest in it, m.
    pub point: UmbraVec2,
    /// The point of the second shape, m.
    pub second_point: UmbraVec2,
    /// Number of the part of the first shape: of a compound, or of the segment of a chain; 0 of all others.
    pub part: u32,
    /// Number of the part of the second shape.
    pub second_part: u32,
}

/// The motion of a shape over some time: at constant velocity, and turning at a constant rate around its centre of mass.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UmbraSweep {
    /// The position of the centre of mass at the start, m.
    pub position: UmbraVec2,
    /// The translation over all of the time, m; each component within ±2^20.
    pub translation: UmbraVec2,
    /// The angle at the start, rad.
    pub angle: UmbraFx,
    /// The rotation over all of the time, rad, whole turns included; within ±2^17.
    pub rotation: UmbraFx,
}

/// The moment at which two moving shapes meet, and their distance then.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UmbraShapeImpact {
    /// The fraction of the time, from 0 to 1, rounded down.
    pub fraction: UmbraFx,
    /// The distance of the two parts that meet, at that moment.
    pub distance: UmbraShapeDistance,
    /// 1; 0 if they do not meet, and then all else is 0 as well.
    pub is_hit: u32,
    /// 0.
    pub reserved: u32,
}

impl From<ShapeDistance> for UmbraShapeDistance {
    fn from(distance: ShapeDistance) -> Self {
        let ([point, second_point], [part, second_part]) = (distance.points, distance.parts);
        Self {
            separation: distance.separation.to_bits(),
            normal: distance.normal.into(),
            point: point.into(),
            second_point: second_point.into(),
            part,
            second_part,
        }
    }
}

impl From<&UmbraSweep> for Sweep {
    fn from(sweep: &UmbraSweep) -> Self {
        Self {
            position: sweep.position.into(),
            angle: Fx::from_bits(sweep.angle),
            translation: sweep.translation.into(),
            rotation: Fx::from_bits(sweep.rotation),
        }
    }
}

impl From<ShapeImpact> for UmbraShapeImpact {
    fn from(impact: ShapeImpact) -> Self {
        Self { fraction: impact.fraction.to_bits(), distance: impact.distance.into(), is_hit: 1, reserved: 0 }
    }
}

impl From<CastHit> for UmbraCastHit {
    fn from(hit: CastHit) -> Self {
        Self {
            collider: collider_word(hit.collider),
            body: body_word(hit.body),
            fraction: hit.fraction.to_bits(),
            point: hit.point.into(),
            normal: hit.normal.into(),
            part: hit.part,
            is_hit: 1,
        }
    }
}

impl From<ShapeHit> for UmbraCastHit {
    fn from(hit: ShapeHit) -> Self {
        Self {
            fraction: hit.fraction.to_bits(),
            point: hit.point.into(),
            normal: hit.normal.into(),
            part: hit.part,
            is_hit: 1,
            ..Self::default()
        }
    }
}

impl From<ClosestPoint> for UmbraClosestPoint {
    fn from(closest: ClosestPoint) -> Self {
        Self {
            collider: collider_word(closest.collider),
            body: body_word(closest.body),
            distance: closest.distance.to_bits(),
            point: closest.point.into(),
            part: closest.part,
            is_found: 1,
        }
    }
}

/// Calls `ask` with the queries of a world and a filter.
///
/// # Safety
/// The lists of the filter are as long as it says, and its condition may be called.
pub(crate) unsafe fn query<T>(
    world: Option<&UmbraWorld>,
    filter: Option<&UmbraQueryFilter>,
    ask: impl FnOnce(&Queries<'_>, &QueryFilter<'_>) -> Result<T>,
) -> Result<T> {
    let queries = given(world)?.world().queries();
    // SAFETY: as the caller promises.
    unsafe { query_by(&queries, filter, ask) }
}

/// Asks by a filter of C.
///
/// # Safety
/// As [`query`].
pub(crate) unsafe fn query_by<T>(
    queries: &Queries<'_>,
    filter: Option<&UmbraQueryFilter>,
    ask: impl FnOnce(&Queries<'_>, &QueryFilter<'_>) -> Result<T>,
) -> Result<T> {
    let Some(umbra_filter) = filter else { return ask(queries, &QueryFilter::default()) };
    // SAFETY: as the caller promises.
    let (bodies, colliders) = unsafe {
        (
            slice(umbra_filter.without_bodies, umbra_filter.without_body_count)?,
            slice(umbra_filter.without_colliders, umbra_filter.without_collider_count)?,
        )
    };
    let bodies: Vec<BodyId> = bodies.iter().map(|&body| body_id(body)).collect();
    let colliders: Vec<ColliderId> = colliders.iter().map(|&collider| collider_id(collider)).collect();
    let called = umbra_filter.predicate.map(|predicate| {
        move |id: ColliderId, def: &ColliderDef| {
            // SAFETY: as the caller promises.
            (unsafe { predicate(umbra_filter.context, collider_word(id), def.user_data) }) != 0
        }
    });
    let UmbraQueryFilter { category, mask, group, .. } = *umbra_filter;
    let finds_all = (category, mask, group) == (UMBRA_ALL_CATEGORIES, UMBRA_ALL_CATEGORIES, 0);
    let filter = QueryFilter {
        filter: (!finds_all).then_some(Filter { category, mask, group }),
        without_bodies: &bodies,
        without_colliders: &colliders,
        predicate: called.as_ref().map(|called| called as _),
    };
    ask(queries, &filter)
}

/// Fills in a filter that lets all colliders through.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_query_filter_default(filter: Option<&mut MaybeUninit<UmbraQueryFilter>>) -> UmbraStatus {
    guard(|| {
        given(filter)?.write(UmbraQueryFilter {
            category: UMBRA_ALL_CATEGORIES,
            mask: UMBRA_ALL_CATEGORIES,
            group: 0,
            reserved: 0,
            without_bodies: std::ptr::null(),
            without_body_count: 0,
            without_colliders: std::ptr::null(),
            without_collider_count: 0,
            predicate: None,
            context: std::ptr::null_mut(),
        });
        Ok(())
    })
}

/// The first collider on each of `length` rays: of several at the same fraction that with the least key, then handle. If one ray
/// is invalid, nothing is written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_cast_rays(
    world: Option<&UmbraWorld>,
    rays: *const UmbraRay,
    hits: *mut UmbraCastHit,
    length: usize,
    filter: Option<&UmbraQueryFilter>,
) -> UmbraStatus {
    guard(|| {
        // SAFETY: as the caller promises.
        let rays = unsafe { slice(rays, length) }?;
        let first = |queries: &Queries<'_>, filter: &QueryFilter<'_>| {
            let first = |ray: &UmbraRay| {
                let hit = queries.cast_ray(ray.origin.into(), ray.translation.into(), filter)?;
                Ok(hit.map(UmbraCastHit::from).unwrap_or_default())
            };
            rays.iter().map(first).collect::<Result<Vec<_>>>()
        };
        // SAFETY: as the caller promises.
        unsafe { fill(query(world, filter, first)?.into_iter(), hits, length, None) }
    })
}

/// 1 if a ray meets any collider, 0 if it meets none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_cast_ray_any(
    world: Option<&UmbraWorld>,
    ray: Option<&UmbraRay>,
    filter: Option<&UmbraQueryFilter>,
    is_hit: Option<&mut MaybeUninit<u32>>,
) -> UmbraStatus {
    guard(|| {
        let (place, ray) = (given(is_hit)?, given(ray)?);
        let any = |queries: &Queries<'_>, filter: &QueryFilter<'_>| {
            Ok(queries.cast_ray_any(ray.origin.into(), ray.translation.into(), filter)?)
        };
        // SAFETY: as the caller promises.
        place.write(unsafe { query(world, filter, any) }?.into());
        Ok(())
    })
}

/// All colliders on a ray, sorted by fraction, then key, then handle; with 1 for `ties` only those that tie for the first place. A list
/// as `umbra_world_outcomes` gives it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_cast_ray_all(
    world: Option<&UmbraWorld>,
    ray: Option<&UmbraRay>,
    ties: u32,
    filter: Option<&UmbraQueryFilter>,
    hits: *mut UmbraCastHit,
    capacity: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    guard(|| {
        let ray = given(ray)?;
        let (origin, translation) = (ray.origin.into(), ray.translation.into());
        let all = |queries: &Queries<'_>, filter: &QueryFilter<'_>| match ties {
            0 => Ok(queries.cast_ray_all(origin, translation, filter)?),
            1 => Ok(queries.cast_ray_ties(origin, translation, filter)?),
            _ => Err(Refusal::bad("ties is neither 0 nor 1")),
        };
        // SAFETY: as the caller promises.
        unsafe { fill(query(world, filter, all)?.into_iter().map(UmbraCastHit::from), hits, capacity, count) }
    })
}

/// All colliders that a shape meets on its way over a translation, without turning, sorted as those on a ray; with 1 for `ties` only those
/// that tie for the first place. A shape that touches a collider meets it if its way leads into it, not if it slides along it or leaves it. A list as `umbra_world_outcomes` gives it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_cast_shape(
    world: Option<&UmbraWorld>,
    shape: Option<&UmbraShape>,
    x: UmbraFx,
    y: UmbraFx,
    angle: UmbraFx,
    translation_x: UmbraFx,
    translation_y: UmbraFx,
    ties: u32,
    filter: Option<&UmbraQueryFilter>,
    hits: *mut UmbraCastHit,
    capacity: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    guard(|| {
        let (shape, translation) = (&given(shape)?.shape, vector(translation_x, translation_y));
        let pose = (vector(x, y), Fx::from_bits(angle));
        let all = |queries: &Queries<'_>, filter: &QueryFilter<'_>| match ties {
            0 => Ok(queries.cast_shape_all(shape, pose, translation, filter)?),
            1 => Ok(queries.cast_shape_ties(shape, pose, translation, filter)?),
            _ => Err(Refusal::bad("ties is neither 0 nor 1")),
        };
        // SAFETY: as the caller promises.
        unsafe { fill(query(world, filter, all)?.into_iter().map(UmbraCastHit::from), hits, capacity, count) }
    })
}

/// The colliders that overlap a shape or touch it, sorted by key, then by handle; a list as `umbra_world_outcomes` gives it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_overlap_shape(
    world: Option<&UmbraWorld>,
    shape: Option<&UmbraShape>,
    x: UmbraFx,
    y: UmbraFx,
    angle: UmbraFx,
    filter: Option<&UmbraQueryFilter>,
    colliders: *mut u64,
    capacity: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    guard(|| {
        let (shape, pose) = (&given(shape)?.shape, (vector(x, y), Fx::from_bits(angle)));
        // SAFETY: as the caller promises.
        let all = unsafe { query(world, filter, |queries, filter| Ok(queries.overlap_shape(shape, pose, filter)?)) }?;
        // SAFETY: as the caller promises.
        unsafe { fill(all.into_iter().map(collider_word), colliders, capacity, count) }
    })
}

/// The colliders that overlap a box between two corners or touch it, sorted by key, then by handle: with one point for both those at the
/// point. A list as `umbra_world_outcomes` gives it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_overlap_box(
    world: Option<&UmbraWorld>,
    min_x: UmbraFx,
    min_y: UmbraFx,
    max_x: UmbraFx,
    max_y: UmbraFx,
    filter: Option<&UmbraQueryFilter>,
    colliders: *mut u64,
    capacity: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    guard(|| {
        let bounds = Aabb { min: vector(min_x, min_y), max: vector(max_x, max_y) };
        // SAFETY: as the caller promises.
        let all = unsafe { query(world, filter, |queries, filter| Ok(queries.overlap_box(bounds, filter)?)) }?;
        // SAFETY: as the caller promises.
        unsafe { fill(all.into_iter().map(collider_word), colliders, capacity, count) }
    })
}

/// The collider nearest to a point, up to a distance from 0 to 2^20 m: of several at the same distance that with the least key, then
/// handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_closest_point(
    world: Option<&UmbraWorld>,
    x: UmbraFx,
    y: UmbraFx,
    most: UmbraFx,
    filter: Option<&UmbraQueryFilter>,
    closest: Option<&mut MaybeUninit<UmbraClosestPoint>>,
) -> UmbraStatus {
    guard(|| {
        let place = given(closest)?;
        let (point, max_distance) = (vector(x, y), Fx::from_bits(most));
        // SAFETY: as the caller promises.
        let closest_point =
            unsafe { query(world, filter, |queries, filter| Ok(queries.closest_point(point, max_distance, filter)?)) }?;
        place.write(closest_point.map(UmbraClosestPoint::from).unwrap_or_default());
        Ok(())
    })
}

/// All colliders up to a distance from 0 to 2^20 m from a point, each with its nearest point, sorted by distance, then key, then handle; a
/// list as `umbra_world_outcomes` gives it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_closest_points(
    world: Option<&UmbraWorld>,
    x: UmbraFx,
    y: UmbraFx,
    most: UmbraFx,
    filter: Option<&UmbraQueryFilter>,
    points: *mut UmbraClosestPoint,
    capacity: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    guard(|| {
        let (point, max_distance) = (vector(x, y), Fx::from_bits(most));
        // SAFETY: as the caller promises.
        let all = unsafe {
            query(world, filter, |queries, filter| Ok(queries.closest_points(point, max_distance, filter)?))
        }?;
        // SAFETY: as the caller promises.
        unsafe { fill(all.into_iter().map(UmbraClosestPoint::from), points, capacity, count) }
    })
}

/// 1 if a point, relative to the centre of mass of a shape, is in it or on its surface, else 0.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_shape_contains(
    shape: Option<&UmbraShape>,
    x: UmbraFx,
    y: UmbraFx,
    is_inside: Option<&mut MaybeUninit<u32>>,
) -> UmbraStatus {
    guard(|| {
        let (shape, place) = (given(shape)?, given(is_inside)?);
        place.write(shape.shape.contains(vector(x, y)).into());
        Ok(())
    })
}

/// The point of a shape that is nearest to a point, both relative to its centre of mass, and their distance; without a collider and a body.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_shape_closest_point(
    shape: Option<&UmbraShape>,
    x: UmbraFx,
    y: UmbraFx,
    closest: Option<&mut MaybeUninit<UmbraClosestPoint>>,
) -> UmbraStatus {
    guard(|| {
        let (shape, place) = (&given(shape)?.shape, given(closest)?);
        place.write(UmbraClosestPoint {
            distance: shape.distance(vector(x, y))?.to_bits(),
            point: shape.closest_point(vector(x, y))?.into(),
            is_found: 1,
            ..UmbraClosestPoint::default()
        });
        Ok(())
    })
}

/// The first point of a shape on a ray, relative to its centre of mass; without a collider and a body.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_shape_cast_ray(
    shape: Option<&UmbraShape>,
    ray: Option<&UmbraRay>,
    hit: Option<&mut MaybeUninit<UmbraCastHit>>,
) -> UmbraStatus {
    guard(|| {
        let (shape, ray, place) = (given(shape)?, given(ray)?, given(hit)?);
        let hit = shape.shape.cast_ray(ray.origin.into(), ray.translation.into())?;
        place.write(hit.map(UmbraCastHit::from).unwrap_or_default());
        Ok(())
    })
}

/// The distance of two shapes, each at a position of its centre of mass, m, and an angle, rad, or the depth in which they overlap. Of shapes with
/// several parts it is the pair that are nearest to each other, or that overlap deepest.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_shape_distance_to(
    shape: Option<&UmbraShape>,
    x: UmbraFx,
    y: UmbraFx,
    angle: UmbraFx,
    second: Option<&UmbraShape>,
    second_x: UmbraFx,
    second_y: UmbraFx,
    second_angle: UmbraFx,
    distance: Option<&mut MaybeUninit<UmbraShapeDistance>>,
) -> UmbraStatus {
    guard(|| {
        let (shape, second, place) = (&given(shape)?.shape, &given(second)?.shape, given(distance)?);
        let pose = (vector(x, y), Fx::from_bits(angle));
        let second_pose = (vector(second_x, second_y), Fx::from_bits(second_angle));
        place.write(shape.distance_to(pose, second, second_pose)?.into());
        Ok(())
    })
}

/// The moment at which two shapes meet on their ways. It is conservative: they are still apart then, by at most 2^-26 m and 2^-26 of their sizes.
/// Shapes that touch at the start meet where they come to overlap by 2^-20 m, so that they may leave, slide and roll.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_shape_time_of_impact(
    shape: Option<&UmbraShape>,
    sweep: Option<&UmbraSweep>,
    second: Option<&UmbraShape>,
    second_sweep: Option<&UmbraSweep>,
    impact: Option<&mut MaybeUninit<UmbraShapeImpact>>,
) -> UmbraStatus {
    guard(|| {
        let (shape, second, place) = (&given(shape)?.shape, &given(second)?.shape, given(impact)?);
        let (sweep, second_sweep) = (given(sweep)?.into(), given(second_sweep)?.into());
        let impact = shape.time_of_impact(&sweep, second, &second_sweep)?;
        place.write(impact.map(UmbraShapeImpact::from).unwrap_or_default());
        Ok(())
    })
}
