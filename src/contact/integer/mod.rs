//! The computations of contacts in fixed point: the free flight as the solver takes it, the narrow phase, and the solver.

mod approach;
mod flights;
mod pairs;
mod paths;
mod solvers;

use alloc::vec::Vec;

use super::engine::Engine;
use super::numerics::{Approach, MARGIN, Numerics, OVERLAP, Surface, Touching};
use super::{Correction, Placed, Scene, Start, TouchPoint};
use crate::collide::seam::Face;
use crate::collide::sweep::{END, Leg};
use crate::collide::{self, Cores, Manifold, ManifoldPoint, Pose};
use crate::collider::{BodyOutline, ContactSettings, Material, MaterialPair};
use crate::fx::Fx;
use crate::kernel::round::shr_round;
use crate::math::{TimeStep, Vec2};
use crate::scalar::{FxAccumulator, FxFactor, Turn};
use crate::shape::{Aabb, Outline};
use crate::solve::{self, Contact, Flight, Impulses, SolverOptions};

use pairs::{closing, grown, mixed, way};
use solvers::Solvers;

/// The contacts of a world in [`Fx`].
#[doc(hidden)]
pub type FxContacts = Engine<Fx, Fixed>;

/// Bodies that approach by less than this in a step have their contacts as they are, 4 mm.
const LEAST_WAY: i64 = 1 << 24;

/// Outlines in world axes, contacts and the solver.
#[derive(Debug, Default)]
#[doc(hidden)]
pub struct Fixed {
    cores: Cores,
    contacts: Vec<Contact>,
    solvers: Solvers,
    corrections: Vec<solve::Correction>,
    /// No contact is found ahead of time.
    #[cfg(feature = "selftest")]
    is_discrete: bool,
}

/// A point with arms to the surface of each body: an open gap closes within the step.
#[inline(always)]
fn on_surfaces(normal: [i32; 2], point: &ManifoldPoint) -> solve::Point {
    let gap = point.separation.to_bits();
    let (mut arms, separation) = ([point.arm_a, point.arm_b], point.separation);
    if gap > 0 {
        // Half of the gap along the normal.
        let (x, y) = (half_along(normal[0], gap), half_along(normal[1], gap));
        let half = Vec2::new(Fx::from_bits(x), Fx::from_bits(y));
        arms = [arms[0] - half, arms[1] + half];
    }
    solve::Point { arms, separation }
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

impl From<&ContactSettings> for SolverOptions {
    fn from(settings: &ContactSettings) -> Self {
        Self {
            substeps: settings.substeps,
            push_speed: settings.push_speed,
            restitution_speed: settings.restitution_speed,
            ..Self::default()
        }
    }
}

impl Touching for Manifold {
    #[inline]
    fn features(&self) -> ([u32; 2], usize) {
        (self.points.map(|point| point.feature), self.count)
    }

    fn is_pressed(&self) -> bool {
        self.points.iter().any(|point| point.separation < -OVERLAP)
    }
}

impl Numerics<Fx> for Fixed {
    type Pose = Pose;
    type Flight = Flight;
    type Manifold = Manifold;

    fn pose(position: Vec2<FxAccumulator>, angle: Turn) -> Pose {
        Pose::new(position.map(FxAccumulator::value), angle)
    }

    fn moving(scene: &Scene<'_, Fx>, start: &Start<Fx>, pose: &Pose) -> Flight {
        flights::moving(scene, start, pose)
    }

    fn complete(scene: &Scene<'_, Fx>, start: &Start<Fx>, flight: &mut Flight) {
        flights::complete(scene, start, flight);
    }

    fn still(position: Vec2<FxAccumulator>) -> Flight {
        flights::still(position.map(FxAccumulator::value))
    }

    fn follower(flight: &Flight, leader: u32) -> Flight {
        let fixed = FxFactor::default();
        let inverse_mass = Vec2::new(fixed, fixed);
        Flight { inverse_mass, inverse_inertia: fixed, leader: Some(leader), ..*flight }
    }

    fn clear(&mut self) {
        self.cores.clear();
        self.contacts.clear();
    }

    fn place(&mut self, outline: &Outline, pose: &Pose) -> usize {
        self.cores.push(outline, pose)
    }

    fn set_faces(&mut self, faces: &[Face]) {
        self.cores.set_faces(faces);
    }

    fn corners(outline: &BodyOutline<Fx>, pose: &Pose, from: &Pose) -> impl Iterator<Item = [i64; 2]> {
        pose.corners_from(&outline.outline, from)
    }

    fn swept(outline: &BodyOutline<Fx>, pose: &Pose, flight: &Flight) -> Aabb {
        grown(outline, pose, way(flight, outline.radius))
    }

    fn resting(outline: &BodyOutline<Fx>, pose: &Pose) -> Aabb {
        grown(outline, pose, 0)
    }

    fn collide(&self, cores: [usize; 2], flights: [&Flight; 2], radii: [Fx; 2]) -> Option<Manifold> {
        let margin = closing(flights, radii);
        #[cfg(feature = "selftest")]
        let margin = if self.is_discrete { MARGIN.into() } else { margin };
        self.cores.collide(cores[0], cores[1], margin)
    }

    fn may_close(manifold: &Manifold, flights: [&Flight; 2]) -> bool {
        manifold.points[..manifold.count]
            .iter()
            .any(|point| pairs::closed(manifold.normal, point, flights, END) >= point.separation.to_bits())
    }

    fn are_fast(flights: [&Flight; 2], radii: [Fx; 2]) -> bool {
        pairs::approach(flights, radii) > LEAST_WAY
    }

    fn at_start(mut manifold: Manifold, flights: [&Flight; 2], at: u64) -> Manifold {
        let normal = manifold.normal;
        for point in &mut manifold.points[..manifold.count] {
            let solved = on_surfaces(normal, point);
            (point.arm_a, point.arm_b) = (solved.arms[0], solved.arms[1]);
            let closed = pairs::closed(normal, point, flights, at);
            point.separation = Fx::from_bits(point.separation.to_bits().saturating_add(closed));
        }
        manifold.is_moved = true;
        manifold
    }

    fn along(manifold: &Manifold, pose: &Pose, direction: Vec2<Fx>) -> Fx {
        let ([x, y], [u, v]) = (manifold.normal, pose.turned(direction));
        // In units of 2^-60, at most 2^61: a mirror image has the same.
        Fx::from_bits((i64::from(x) * i64::from(u) + i64::from(y) * i64::from(v)) >> 28)
    }

    fn least_separation(manifold: &Manifold) -> Fx {
        let [first, second] = manifold.points.map(|point| point.separation);
        if manifold.count == 2 { first.min(second) } else { first }
    }

    fn mixed([a, b]: [&Material; 2]) -> MaterialPair {
        let [friction, restitution] = a.rules(b);
        MaterialPair {
            friction: mixed(friction, a.friction, b.friction),
            restitution: mixed(restitution, a.restitution, b.restitution),
            rolling_resistance: a.rolling_resistance.max(b.rolling_resistance),
        }
    }

    fn push(&mut self, bodies: [u32; 2], manifold: &Manifold, surface: &Surface<Fx>, start: Impulses) {
        let MaterialPair { friction, restitution, rolling_resistance } = surface.coefficients;
        let [first, second] = &manifold.points;
        self.contacts.push(Contact {
            bodies,
            normal: manifold.normal,
            count: manifold.count,
            points: [first, second].map(|point| {
                if manifold.is_moved {
                    solve::Point { arms: [point.arm_a, point.arm_b], separation: point.separation }
                } else {
                    on_surfaces(manifold.normal, point)
                }
            }),
            friction,
            restitution,
            rolling_resistance,
            rolling_radius: surface.radius,
            surface_speed: surface.speed,
            impulses: start,
        });
    }

    fn solve(&mut self, scene: &Scene<'_, Fx>, flights: &[Flight], corrections: &mut Vec<Correction<Fx>>) {
        let options = SolverOptions::from(scene.settings);
        self.solvers.solve(scene.time_step, &options, (flights, &mut self.contacts), &mut self.corrections);
        corrections.extend(self.corrections.iter().take(scene.starts.len()).map(|from| Correction {
            is_pushed: *from != solve::Correction::default(),
            velocity: from.velocity,
            angular_velocity: from.angular_velocity,
            displacement: from.displacement,
            rotation: from.rotation,
        }));
    }

    fn totals(&self) -> impl Iterator<Item = (usize, Impulses)> + '_ {
        self.solvers.totals().map(|(contact, [first, second], exponent)| {
            let contact = contact as usize;
            let second = if self.contacts[contact].count == 2 { second } else { 0 };
            (contact, Impulses { values: [first, second, 0], exponent })
        })
    }

    fn approach(manifold: &Manifold, flights: [&Flight; 2], time_step: TimeStep) -> Approach<Fx> {
        approach::approach(manifold, flights, time_step)
    }

    fn middle(a: Fx, b: Fx) -> Fx {
        approach::middle(a, b)
    }

    fn contacts(&self) -> impl Iterator<Item = ([u32; 2], Impulses)> + '_ {
        self.contacts.iter().map(|contact| (contact.bodies, contact.impulses))
    }

    #[cfg(feature = "selftest")]
    fn set_discrete(&mut self, is_discrete: bool) {
        self.is_discrete = is_discrete;
    }

    fn ulps(value: Fx) -> i64 {
        value.to_bits()
    }

    fn from_ulps(ulps: i64) -> FxAccumulator {
        FxAccumulator::from_scalar(Fx::from_bits(ulps))
    }

    fn from_turn(turn: Turn) -> Turn {
        turn
    }

    fn moved(
        positions: [Vec2<FxAccumulator>; 2],
        (flight, rotation): (&Flight, Option<FxAccumulator>),
        reach: i64,
    ) -> i64 {
        paths::moved(positions, (flight, rotation), reach)
    }

    fn leg(
        start: &Start<Fx>,
        end: (Vec2<FxAccumulator>, Turn),
        flight: &Flight,
        rotation: Option<FxAccumulator>,
    ) -> Leg {
        paths::leg(start, end, flight, rotation)
    }

    fn still_leg(position: Vec2<FxAccumulator>, angle: Turn) -> Leg {
        Leg::new(paths::ulps(position), [0; 2], angle, 0)
    }

    fn between(from: FxAccumulator, to: FxAccumulator, part: u64) -> FxAccumulator {
        paths::between(from, to, part)
    }

    fn touch(a: Placed<'_, Fx>, b: Placed<'_, Fx>) -> Option<(Vec2<Fx>, [TouchPoint<Fx>; 2], usize)> {
        let pose = |(_, (position, angle)): &Placed<'_, Fx>| Pose::new(position.map(FxAccumulator::value), *angle);
        let manifold = collide::collide(a.0, &pose(&a), b.0, &pose(&b), MARGIN)?;
        let from = a.1.0.map(FxAccumulator::value);
        let point = |point: ManifoldPoint| TouchPoint {
            // Positions are within 2^31 m, arms within 2^15 m.
            position: Vec2::new(from.x.saturating_add(point.arm_a.x), from.y.saturating_add(point.arm_a.y)),
            separation: point.separation,
            feature: point.feature,
        };
        // From 2^-30 to 2^-32.
        let normal = manifold.normal.map(|part| Fx::from_bits(i64::from(part) << 2));
        Some((Vec2::new(normal[0], normal[1]), manifold.points.map(point), manifold.count))
    }
}
