//! Pairs, their manifolds, and the impulses that they keep from step to step.

use super::bodies::Body;
use std::sync::Arc;
use umbra_physics::collide::broad::{BroadPhase, PairLimits, Proxy, RestingTrees, Statics};
use umbra_physics::collide::{Cores, Filter, Manifold, Margin, Pose};
use umbra_physics::solve::{Contact, Flight, Impulses, Point};
use umbra_physics::{Aabb, Fx, Outline, Vec2, fx, vec2};

/// Shapes have a manifold from this distance on, and from what they close in the step, m.
const MARGIN: Fx = fx!(0.02);

/// The record of a contact.
#[derive(Clone, Copy)]
struct Record {
    pair: [u32; 2],
    count: usize,
    features: [u32; 2],
    impulses: Impulses,
}

#[derive(Default)]
pub struct Pairs {
    /// The contacts of the step.
    pub contacts: Vec<Contact>,
    /// Beside each contact: what it keeps. Sorted by pair.
    records: Vec<Record>,
    /// The records of the step before.
    before: Vec<Record>,
    /// The outlines of all bodies that have one, in world axes.
    cores: Cores,
    /// The place in `cores` by body; of no meaning for others.
    core_of: Vec<usize>,
    broad: BroadPhase,
    /// The bodies that do not move, from the first step on.
    statics: Option<Arc<Statics>>,
    /// The bodies that move.
    movers: Vec<Proxy>,
}

/// The length of a vector in ulps, rounded up.
fn length(x: i64, y: i64) -> i64 {
    let square = |v: i64| u128::from(v.unsigned_abs()).pow(2);
    (square(x) + square(y)).isqrt() as i64 + 1
}

/// The distance that a point of a body moves by its rotation, in ulps, rounded up.
fn turned(flight: &Flight) -> i64 {
    let product = i128::from(flight.rotation.to_bits()).abs() * i128::from(flight.radius.to_bits());
    (product >> 32) as i64 + i64::from(product != 0)
}

/// The largest distance of two bodies that may touch in the step: the margin and what they close. The way is rounded up by the ulp.
fn closing(a: &Flight, b: &Flight) -> Margin {
    let way = |a: Fx, b: Fx| b.to_bits() - a.to_bits();
    let (x, y) = (way(a.displacement.x, b.displacement.x), way(a.displacement.y, b.displacement.y));
    Margin::new(Fx::from_bits(MARGIN.to_bits() + 1 + turned(a) + turned(b)), [x, y])
}

/// The geometric mean, rounded to nearest.
fn mixed_friction(a: Fx, b: Fx) -> Fx {
    let product = u128::from(a.to_bits().unsigned_abs()) * u128::from(b.to_bits().unsigned_abs());
    let root = product.isqrt();
    // The middle between root and root + 1 has the square root² + root + 1/4.
    Fx::from_bits((root + u128::from(product - root * root > root)) as i64)
}

/// The least box around the corners of an outline.
fn corner_box(outline: &Outline) -> Aabb {
    let first = outline.corners()[0];
    outline.corners().iter().fold(Aabb { min: first, max: first }, |Aabb { min, max }, corner| Aabb {
        min: vec2(min.x.min(corner.x), min.y.min(corner.y)),
        max: vec2(max.x.max(corner.x), max.y.max(corner.y)),
    })
}

impl Pairs {
    /// Finds the contacts at the start poses, with the impulses of the step before.
    /// Bodies that are joined do not collide: `joined` is sorted.
    pub fn collide(&mut self, bodies: &[Body], poses: &[Pose], flights: &[Flight], joined: &[[u32; 2]]) {
        self.contacts.clear();
        self.records.clear();
        self.cores.clear();
        self.core_of.clear();
        let mut cores = 0;
        for (body, pose) in bodies.iter().zip(poses) {
            self.core_of.push(cores);
            if let Some(outline) = &body.outline {
                self.cores.push(outline, pose);
                cores += 1;
            }
        }
        self.search(bodies, poses, flights);
        for &pair in self.broad.pairs() {
            let [a, b] = pair.map(|i| i as usize);
            if joined.binary_search(&pair).is_ok() {
                continue;
            }
            let margin = closing(&flights[a], &flights[b]);
            if let Some(manifold) = self.cores.collide(self.core_of[a], self.core_of[b], margin) {
                let record = self.record(pair, &manifold);
                self.contacts.push(contact(&record, &manifold, [&bodies[a], &bodies[b]]));
                self.records.push(record);
            }
        }
    }

    /// Finds the pairs of bodies, not both fixed, whose boxes overlap.
    fn search(&mut self, bodies: &[Body], poses: &[Pose], flights: &[Flight]) {
        let proxies = |is_dynamic: bool| {
            let all = bodies.iter().zip(poses).zip(flights).enumerate();
            all.filter(move |(_, ((body, _), _))| body.is_dynamic == is_dynamic).filter_map(
                |(i, ((body, pose), flight))| {
                    let outline = body.outline.as_ref()?;
                    Some(proxy(i, pose.bounds(&corner_box(outline), outline.radius()), flight))
                },
            )
        };
        let statics = self.statics.get_or_insert_with(|| Arc::new(Statics::new(proxies(false).collect())));
        self.movers.clear();
        self.movers.extend(proxies(true));
        let limits = PairLimits { pairs: usize::MAX, per_collider: usize::MAX, overlaps: usize::MAX };
        self.broad.update(&RestingTrees::of(statics), &self.movers, &limits);
    }

    /// The record of a pair: impulses of points with features of the step before, others zero; that of friction if there is such a
    /// point.
    fn record(&self, pair: [u32; 2], manifold: &Manifold) -> Record {
        let features = manifold.points.map(|point| point.feature);
        let mut impulses = Impulses::default();
        if let Ok(at) = self.before.binary_search_by_key(&pair, |record| record.pair) {
            let old = &self.before[at];
            impulses.exponent = old.impulses.exponent;
            for (k, feature) in features.iter().enumerate().take(manifold.count) {
                let same = (0..old.count).find(|&i| old.features[i] == *feature);
                if let Some(i) = same {
                    impulses.values[k] = old.impulses.values[i];
                    impulses.values[2] = old.impulses.values[2];
                }
            }
        }
        Record { pair, count: manifold.count, features, impulses }
    }

    /// Keeps the impulses of the step for the next one.
    pub fn keep(&mut self) {
        for (record, contact) in self.records.iter_mut().zip(&self.contacts) {
            record.impulses = contact.impulses;
        }
        std::mem::swap(&mut self.records, &mut self.before);
    }
}

fn contact(record: &Record, manifold: &Manifold, [a, b]: [&Body; 2]) -> Contact {
    Contact {
        bodies: record.pair,
        normal: manifold.normal,
        count: manifold.count,
        points: manifold.points.map(|p| Point { arms: [p.arm_a, p.arm_b], separation: p.separation }),
        friction: mixed_friction(a.friction, b.friction),
        restitution: a.restitution.max(b.restitution),
        rolling_resistance: Fx::ZERO,
        rolling_radius: Fx::ZERO,
        surface_speed: a.surface_speed.saturating_add(b.surface_speed),
        impulses: record.impulses,
    }
}

/// The box around a body over the step, with half the margin: those of all that may come within the margin of it overlap it.
fn proxy(i: usize, at_start: Aabb, flight: &Flight) -> Proxy {
    let way = length(flight.displacement.x.to_bits(), flight.displacement.y.to_bits());
    let more = MARGIN.to_bits() / 2 + 1 + way + turned(flight);
    let grown = |v: Vec2, ulps: i64| v.map(|c| Fx::from_bits(c.to_bits() + ulps));
    let bounds = Aabb { min: grown(at_start.min, -more), max: grown(at_start.max, more) };
    Proxy { collider: i as u32, body: i as u32, bounds, filter: Filter::default(), digest: 0 }
}
