//! The coefficients of two surfaces that touch, and their contact as the solver takes it.

use super::Scene;
use super::flights::PairSide;
use super::seams::rolling_radius;
use crate::collide::{Manifold, ManifoldPoint};
use crate::collider::MaterialPair;
use crate::fx::Fx;
use crate::kernel::round::shr_round;
use crate::math::Vec2;
use crate::solve::{Contact, Impulses, Point};

/// The coefficients of a contact.
#[derive(Clone, Copy, Debug)]
pub(super) struct Coefficients {
    materials: MaterialPair,
    /// The radius at which one rolls on the other, m; zero if neither is round there.
    rolling_radius: Fx,
    /// The velocity of the second one against the first one along the tangent, m/s.
    speed: Fx,
}

impl Coefficients {
    /// The coefficients of a pair of outlines with a manifold.
    #[inline(always)]
    pub(super) fn new(scene: &Scene<'_>, pair: [&PairSide<'_>; 2], manifold: &Manifold) -> Self {
        let [first, second] = pair.map(|side| &side.collider.def.material);
        let defined = if scene.colliders.material_pairs().is_empty() {
            None
        } else {
            scene.colliders.material_pair([first.id, second.id]).copied()
        };
        let materials = defined.unwrap_or_else(|| first.mixed(second));
        let rolling_radius = if manifold.count == 1 && materials.rolling_resistance > Fx::ZERO {
            rolling_radius(manifold.features()[0], pair.map(|side| side.outline().outline.radius()))
        } else {
            Fx::ZERO
        };
        Self { materials, rolling_radius, speed: first.surface_speed_against(second) }
    }

    /// The contact of two flights, with the impulses that it starts from.
    pub(super) fn contact(&self, flights: [u32; 2], manifold: &Manifold, start: Impulses) -> Contact {
        let [first, second] = &manifold.points;
        Contact {
            bodies: flights,
            normal: manifold.normal,
            count: manifold.count,
            points: [on_surfaces(manifold.normal, first), on_surfaces(manifold.normal, second)],
            friction: self.materials.friction,
            restitution: self.materials.restitution,
            rolling_resistance: self.materials.rolling_resistance,
            rolling_radius: self.rolling_radius,
            surface_speed: self.speed,
            impulses: start,
        }
    }
}

/// A point with arms to the surface of each body: an open gap closes within the step.
#[inline(always)]
fn on_surfaces(normal: [i32; 2], point: &ManifoldPoint) -> Point {
    let gap = point.separation.to_bits();
    let mut arms = [point.arm_a, point.arm_b];
    if gap > 0 {
        // Half of the gap along the normal.
        let [x, y] = normal.map(|component| Fx::from_bits(half_along(component, gap)));
        let half = Vec2::new(x, y);
        arms = [arms[0] - half, arms[1] + half];
    }
    Point { arms, separation: point.separation }
}

/// Half of a gap times a component of a normal in units of 2^-30, to nearest, ties to even. *Domain* a gap below 2^57.
#[inline(always)]
fn half_along(n: i32, gap: i64) -> i64 {
    if gap >> 32 != 0 {
        return shr_round(i128::from(n) * i128::from(gap), 31) as i64;
    }
    // Below 2^62.1. As `shr_round`, in words.
    let product = i64::from(n) * gap;
    let floor = product >> 31;
    floor + i64::from((product & ((1 << 31) - 1)) > (1 << 30) - (floor & 1))
}
