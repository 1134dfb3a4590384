//! Contacts in plain floats, to compare with: the same pairs and the algorithm of fixed point, without its units, roundings and limits.
//!
//! - `number`: what contacts ask of a float.
//! - `body`: bodies through the sub-steps.
//! - `cores`, `frame`, `points`: the narrow phase.
//! - `solvers`, `solver`, `rows`, `rolling`, `bounce`: the solver.

mod body;
mod bounce;
mod cores;
mod frame;
mod link;
mod number;
mod points;
mod rolling;
mod rows;
mod solver;
mod solvers;
#[cfg(test)]
mod tests;

use alloc::vec::Vec;

use self::body::{Flight, seconds};
use self::cores::{Cores, Pose};
use self::number::{Float, Pair, dot, length, minus, plus, times};
use self::points::{Manifold, ManifoldPoint, collide};
use self::rows::Contact;
use self::solvers::Solvers;
use super::engine::Engine;
use super::numerics::{Approach, MARGIN, Numerics, OVERLAP, Surface, Touching};
use super::{Correction, Placed, Scene, Start, TouchPoint};
use crate::collide::seam::Face;
use crate::collide::sweep::{END, Leg};
use crate::collider::{BodyOutline, Material, MaterialPair, MixRule};
use crate::fx::Fx;
use crate::limits;
use crate::math::{TimeStep, Vec2};
use crate::scalar::{ToF64 as _, Turn};
use crate::shape::{Aabb, Outline};
use crate::solve::Impulses;

/// The contacts of a world in floats.
#[doc(hidden)]
pub type FloatContacts<F> = Engine<F, Floats<F>>;

/// Outlines, contacts and the solver.
#[derive(Debug, Default)]
#[doc(hidden)]
pub struct Floats<F: Float> {
    cores: Cores<F>,
    contacts: Vec<Contact<F>>,
    solvers: Solvers<F>,
}

/// Impulses in N·s as multiples of a power of two of which the largest has 62 bits. What is not finite counts as zero.
fn impulses_of<F: Float>(values: [F; 3]) -> Impulses {
    let values = values.map(|value| if value.is_finite() { value.to_f64() } else { 0.0 });
    let largest = values.into_iter().fold(0.0, |most: f64, value| most.max(libm::fabs(value)));
    if largest == 0.0 {
        return Impulses::default();
    }
    let (_, above) = libm::frexp(largest);
    // Records keep exponents of eight bits.
    let exponent = (above - 62).clamp(-128, 60);
    let most = (1u64 << 62) as f64;
    let units = |value: f64| libm::rint(libm::scalbn(value, -exponent).clamp(-most, most)) as i64;
    Impulses { values: values.map(units), exponent }
}

/// Ulps of a metre, and units of 2^-64 turns of a turn.
const ULPS: f64 = 4_294_967_296.0;
const TURNS: f64 = ULPS * ULPS;

/// An angle as a fraction of a turn.
fn turn<F: Float>(angle: F) -> Turn {
    let turns = angle.to_f64() / core::f64::consts::TAU;
    Turn::from_bits(((turns - libm::floor(turns)) * TURNS) as u64)
}

/// Two coefficients as one.
fn mixed<F: Float>(rule: MixRule, a: F, b: F) -> F {
    match rule {
        MixRule::Minimum => a.or_less(b),
        MixRule::Maximum => a.or_more(b),
        MixRule::Mean => (a + b) * F::of(0.5),
        MixRule::Product => a * b,
        MixRule::GeometricMean | MixRule::Standard if a == b => a,
        MixRule::GeometricMean | MixRule::Standard => (a * b).root(),
    }
}

/// Impulses in N·s.
fn newton_seconds<F: Float>(impulses: Impulses) -> [F; 3] {
    impulses.values.map(|value| F::of(libm::scalbn(value as f64, impulses.exponent)))
}

impl<F: Float> Touching for Manifold<F> {
    fn features(&self) -> ([u32; 2], usize) {
        (self.points.map(|point| point.feature), self.count)
    }

    fn is_pressed(&self) -> bool {
        self.points[..self.count].iter().any(|point| point.separation < -F::from_fx(OVERLAP))
    }
}

impl<F: Float> Numerics<F> for Floats<F> {
    type Pose = Pose<F>;
    type Flight = Flight<F>;
    type Manifold = Manifold<F>;

    fn pose(position: Vec2<F>, angle: F) -> Pose<F> {
        Pose::new(position, angle)
    }

    fn moving(scene: &Scene<'_, F>, start: &Start<F>, _pose: &Pose<F>) -> Flight<F> {
        Flight::moving(scene, start)
    }

    fn still(position: Vec2<F>) -> Flight<F> {
        Flight::still(position)
    }

    fn follower(flight: &Flight<F>, leader: u32) -> Flight<F> {
        Flight { inverse: [F::of(0.0); 3], leader: Some(leader), ..*flight }
    }

    fn clear(&mut self) {
        self.cores.clear();
        self.contacts.clear();
    }

    fn place(&mut self, outline: &Outline<F>, pose: &Pose<F>) -> usize {
        self.cores.push(outline, pose)
    }

    fn set_faces(&mut self, faces: &[Face]) {
        self.cores.set_faces(faces);
    }

    fn corners(outline: &BodyOutline<F>, pose: &Pose<F>, from: &Pose<F>) -> impl Iterator<Item = [i64; 2]> {
        pose.corners(&outline.outline, from)
    }

    fn swept(outline: &BodyOutline<F>, pose: &Pose<F>, flight: &Flight<F>) -> Aabb<Fx> {
        let [x, y, _] = flight.displacement;
        let way = length([x, y]) + flight.turned(outline.radius);
        pose.bounds(&outline.outline, F::from_fx(MARGIN) * F::of(0.5) + way)
    }

    fn resting(outline: &BodyOutline<F>, pose: &Pose<F>) -> Aabb<Fx> {
        pose.bounds(&outline.outline, F::from_fx(MARGIN) * F::of(0.5))
    }

    fn collide(&self, cores: [usize; 2], [a, b]: [&Flight<F>; 2], radii: [F; 2]) -> Option<Manifold<F>> {
        let ways = [a, b].map(|flight| [flight.displacement[0], flight.displacement[1]]);
        let closing = length(minus(ways[1], ways[0])) + a.turned(radii[0]) + b.turned(radii[1]);
        collide(self.cores.core(cores[0]), self.cores.core(cores[1]), F::from_fx(MARGIN) + closing)
    }

    fn along(manifold: &Manifold<F>, pose: &Pose<F>, direction: Vec2<F>) -> F {
        let ([x, y], [u, v]) = (manifold.normal, pose.turned(direction));
        x * u + y * v
    }

    fn least_separation(manifold: &Manifold<F>) -> F {
        let [first, second] = manifold.points.map(|point| point.separation);
        if manifold.count == 2 { first.or_less(second) } else { first }
    }

    fn mixed([a, b]: [&Material<F>; 2]) -> MaterialPair<F> {
        let [friction, restitution] = a.rules(b);
        MaterialPair {
            friction: mixed(friction, a.friction, b.friction).or_less(F::from_fx(limits::FRICTION)),
            restitution: mixed(restitution, a.restitution, b.restitution),
            rolling_resistance: a.rolling_resistance.or_more(b.rolling_resistance),
        }
    }

    fn push(&mut self, bodies: [u32; 2], manifold: &Manifold<F>, surface: &Surface<F>, start: Impulses) {
        let MaterialPair { friction, restitution, rolling_resistance } = surface.coefficients;
        self.contacts.push(Contact {
            bodies,
            manifold: *manifold,
            friction,
            restitution,
            rolling_resistance,
            rolling_radius: surface.radius,
            surface_speed: surface.speed,
            impulses: newton_seconds(start),
        });
    }

    fn solve(&mut self, scene: &Scene<'_, F>, flights: &[Flight<F>], corrections: &mut Vec<Correction<F>>) {
        self.solvers.solve(scene, (flights, &mut self.contacts), corrections);
    }

    fn totals(&self) -> impl Iterator<Item = (usize, Impulses)> + '_ {
        let one =
            |(contact, [first, second]): (u32, Pair<F>)| (contact as usize, impulses_of([first, second, F::of(0.0)]));
        self.solvers.totals().map(one)
    }

    fn approach(manifold: &Manifold<F>, flights: [&Flight<F>; 2], time_step: TimeStep) -> Approach<F> {
        let vector = |[x, y]: Pair<F>| Vec2::new(x, y);
        let (zero, half) = (F::of(0.0), F::of(0.5));
        let mut approach = Approach {
            normal: vector(manifold.normal),
            positions: flights.map(|flight| vector(flight.position)),
            speeds: [zero; 2],
            arms: [[vector([zero; 2]); 2]; 2],
        };
        for (k, point) in manifold.points.iter().enumerate().take(manifold.count) {
            let [a, b] = [0, 1].map(|side| {
                let ([x, y, turn], [rx, ry]) = (flights[side].start, point.arms[side]);
                [x - turn * ry, y + turn * rx]
            });
            let speed = dot(minus(a, b), manifold.normal);
            let is_open = point.separation > zero && speed > zero;
            let time = if is_open { (point.separation / speed).or_less(seconds(time_step)) } else { zero };
            let way = times(plus(a, b), half * time);
            approach.speeds[k] = speed;
            (0..2).for_each(|side| approach.arms[side][k] = vector(plus(point.arms[side], way)));
        }
        approach
    }

    fn middle(a: F, b: F) -> F {
        (a + b) * F::of(0.5)
    }

    fn contacts(&self) -> impl Iterator<Item = ([u32; 2], Impulses)> + '_ {
        self.contacts.iter().map(|contact| (contact.bodies, impulses_of(contact.impulses)))
    }

    fn ulps(value: F) -> i64 {
        // A cast from a float saturates.
        libm::rint(value.to_f64() * ULPS) as i64
    }

    fn from_ulps(ulps: i64) -> F {
        F::of(ulps as f64 / ULPS)
    }

    fn from_turn(turn: Turn) -> F {
        F::of(turn.to_f64())
    }

    fn moved(positions: [Vec2<F>; 2], (flight, rotation): (&Flight<F>, Option<F>), reach: i64) -> i64 {
        let [from, to] = positions;
        let turned = flight.displacement[2] + rotation.unwrap_or(F::of(0.0));
        let straight = length([to.x - from.x, to.y - from.y]).to_f64() * ULPS;
        let reach = reach as f64;
        (straight + (turned.size().to_f64() * reach).min(2.0 * reach)) as i64
    }

    fn leg(start: &Start<F>, (position, angle): (Vec2<F>, F), flight: &Flight<F>, rotation: Option<F>) -> Leg {
        let ends = [start.position, position].map(|at| [Self::ulps(at.x), Self::ulps(at.y)]);
        let way = [0, 1].map(|k| i128::from(ends[1][k]) - i128::from(ends[0][k]));
        let [from, to] = [start.angle, angle].map(turn);
        let shortest = i128::from(to.to_bits().wrapping_sub(from.to_bits()) as i64);
        let about = (flight.displacement[2] + rotation.unwrap_or(F::of(0.0))).to_f64() / core::f64::consts::TAU;
        let turns = libm::rint(about - shortest as f64 / TURNS) as i128;
        Leg::new(ends[0], way, from, shortest + (turns << 64))
    }

    fn still_leg(position: Vec2<F>, angle: F) -> Leg {
        Leg::new([Self::ulps(position.x), Self::ulps(position.y)], [0; 2], turn(angle), 0)
    }

    fn between(from: F, to: F, part: u64) -> F {
        from + (to - from) * F::of(part as f64 / END as f64)
    }

    fn touch(a: Placed<'_, F>, b: Placed<'_, F>) -> Option<(Vec2<F>, [TouchPoint<F>; 2], usize)> {
        let mut cores = Cores::default();
        let [a, b] = [a, b].map(|(outline, (position, angle))| cores.push(outline, &Pose::new(position, angle)));
        let (a, b) = (cores.core(a), cores.core(b));
        let manifold = collide(a, b, F::from_fx(MARGIN))?;
        let vector = |[x, y]: Pair<F>| Vec2::new(x, y);
        let point = |point: ManifoldPoint<F>| TouchPoint {
            position: vector(plus(a.position, point.arms[0])),
            separation: point.separation,
            feature: point.feature,
        };
        Some((vector(manifold.normal), manifold.points.map(point), manifold.count))
    }
}
