//! Bodies near sleepers, where sleep may change the result of a step.

use umbra_physics::{Aabb, Activity, BodyKind, BodyRef, Fx, Geometry, QueryFilter, Vec2, World, fx};

/// Twice the distance from which on two awake bodies have a contact, m.
const MARGINS: Fx = fx!(0.04);

/// Returns true if an awake dynamic body is so near to a sleeping one that it may have a contact with it in a step: if a square about its
/// centre of mass, of its radius, its way of a step at its velocity and 0.04 m, overlaps a collider of a sleeper.
///
/// At a [`sleep_speed`](umbra_physics::ContactSettings::sleep_speed) of 0 a world is the same with and without sleep, but for bodies that
/// are pushed out of an overlap towards a sleeper: an awake neighbour slows them before they touch it, a sleeper does not. A comparison of the two worlds
/// has to begin anew after a step that such a body begins or ends near a sleeper.
///
/// ```
/// use umbra_oracles::nears_sleeper;
/// use umbra_physics::{Activity, BodyDef, Shape, World, WorldDef, fx, vec2};
///
/// let mut world = World::new(WorldDef { sleep_after: Some(1), ..WorldDef::default() })?;
/// let disc = |x| BodyDef { position: vec2(x, 0), ..BodyDef::dynamic().with_collider(Shape::circle(1).unwrap()) };
/// let sleeper = world.add_body(disc(fx!(0)))?;
/// world.step();
/// assert_eq!(world.body(sleeper)?.activity(), Activity::Asleep);
/// world.add_body(disc(fx!(2.05)))?;
/// assert!(!nears_sleeper(&world));
/// world.add_body(disc(fx!(-2.03)))?;
/// assert!(nears_sleeper(&world));
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[must_use]
pub fn nears_sleeper(world: &World) -> bool {
    let is = |body: &BodyRef<'_>, activity| body.activity() == activity;
    if !world.bodies().any(|body| is(&body, Activity::Asleep)) {
        return false;
    }
    let queries = world.queries();
    world.bodies().filter(|body| body.kind() == BodyKind::Dynamic && is(body, Activity::Awake)).any(|body| {
        let Some(radius) = radius(world, &body) else { return false };
        let Some(reach) = (radius + MARGINS).checked_add(way(world, &body)) else { return true };
        let (position, corner) = (body.position(), Vec2::new(reach, reach));
        let [min, max] = [position.checked_sub(corner), position.checked_add(corner)];
        let (Some(min), Some(max)) = (min, max) else { return true };
        // A square beyond the limits of queries is taken to have a sleeper in it.
        let Ok(colliders) = queries.overlap_box(Aabb { min, max }, &QueryFilter::default()) else { return true };
        let mut owners = colliders.into_iter().filter_map(|collider| world.collider_body(collider).ok());
        owners.any(|owner| world.body(owner).is_ok_and(|owner| is(&owner, Activity::Asleep)))
    })
}

/// The distance from the centre of mass of a body within which its colliders are, m; `None` for a body without colliders.
fn radius(world: &World, body: &BodyRef<'_>) -> Option<Fx> {
    let colliders = world.colliders_of(body.id()).ok()?.filter_map(|collider| world.collider(collider).ok());
    let radii = colliders.map(|collider| {
        let bounds = collider.shape.bounds();
        let side = |low: Fx, high: Fx| low.abs().max(high.abs());
        let corner = Vec2::new(side(bounds.min.x, bounds.max.x), side(bounds.min.y, bounds.max.y));
        let is_disc = matches!(collider.shape.geometry(), Geometry::Circle { .. });
        collider.position.length() + if is_disc { corner.x } else { corner.length() }
    });
    radii.max()
}

/// The way of a body in a step at its velocity, m, at most [`Fx::MAX`]: the sum of the ways along the two axes.
fn way(world: &World, body: &BodyRef<'_>) -> Fx {
    let (num, den) = world.def().time_step.seconds();
    let speed: i128 = [body.velocity().x, body.velocity().y].iter().map(|part| i128::from(part.to_bits()).abs()).sum();
    let bits = speed * i128::from(num) / i128::from(den);
    Fx::from_bits(bits.min(Fx::MAX.to_bits().into()) as i64)
}
