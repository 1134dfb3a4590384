//! Obstacles of a point: where it is near one, and where its way meets one.

use alloc::vec::Vec;

use super::settings::Terms;
use crate::fx::Fx;
use crate::math::Vec2;
use crate::query::{
    Core, FULL, Feature, Near, Point, RayEnd, cross, distance, dot, edge, first_hit, from_to, nearest, normal, outward,
};
use crate::scalar::Scalar;
use crate::slots::BodyId;
use crate::world::Neighbour;

/// A point on its way stops this many ulps within the skin. So a way along surfaces that are flush, or that rounding moved by an ulp, meets
/// none of them.
const REST: i64 = 2;
/// A point up to this many ulps outside of the skin is in contact.
const NEAR: i64 = 2;
/// A point more than this many ulps within the skin is pushed out.
const DEEP: i64 = 6;

/// An obstacle that the point is near to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    /// The number of the obstacle in the list.
    pub(super) index: usize,
    /// The direction out of it, of any length; below 2^54.
    pub(super) direction: Point,
    /// The unit vector along `direction`, in units of 2^-32, rounded.
    pub(super) unit: Point,
    /// The cosine of the angle between it and up, in units of 2^-32.
    pub(super) cosine: i64,
    /// The depth of the point in the skin, ulps.
    pub(super) depth: i64,
    pub(super) feature: Feature,
    /// The point is within the obstacle itself, not in its skin alone.
    pub(super) overlaps: bool,
}

impl Plane {
    /// Returns true if the point is so deep in the skin that it is pushed out.
    pub(super) fn is_deep(&self) -> bool {
        self.depth > DEEP
    }
}

/// The planes at a place, and the obstacles that are passed there.
#[derive(Debug, Default)]
pub(super) struct Contacts {
    pub(super) planes: Vec<Plane>,
    /// The numbers of obstacles that do not stop a way from this place: the obstacles of planes, and obstacles that let the point pass.
    skipped: Vec<usize>,
}

/// The obstacles around a character.
pub(super) struct Obstacles<'a> {
    pub(super) neighbours: &'a [Neighbour],
    pub(super) terms: &'a Terms,
    /// The body on which the character stood: its one-way colliders hold it until it has left their skins.
    pub(super) stood_on: Option<BodyId>,
}

/// The product of two vectors of which one is in units of 2^-32, in the units of the other, rounded to nearest.
pub(super) fn along(a: Point, unit: Point) -> i64 {
    crate::query::odd_shift(dot(a, unit), 32) as i64
}

/// A unit vector times a length, rounded to nearest.
pub(super) fn times(unit: Point, length: i64) -> Point {
    unit.map(|part| crate::query::odd_shift(i128::from(part) * i128::from(length), 32) as i64)
}

pub(super) fn in_ulps<S: Scalar>(v: Vec2<S>) -> Point {
    [v.x.to_fx().to_bits(), v.y.to_fx().to_bits()]
}

pub(super) fn sum(a: Point, b: Point) -> Point {
    [a[0] + b[0], a[1] + b[1]]
}

pub(super) fn unit(direction: Point) -> Point {
    let unit = Vec2::new(Fx::from_bits(direction[0]), Fx::from_bits(direction[1])).normalize().unwrap_or_default();
    [unit.x.to_bits(), unit.y.to_bits()]
}

/// The distance of the origin from the line of an edge of a core without a radius, ulps, rounded up.
fn depth_of(core: &Core, i: usize) -> i64 {
    (distance(core, Near::Edge(i)) >> 16) as i64 + 1
}

/// The edges of a core through which the origin, which is in it, leaves it on the shortest way; if several tie, the ones that lead up the
/// most. A core that is a point or a line is left upwards.
fn ways_out(core: &Core, link: Option<Point>, up: Point) -> (i64, Vec<(Point, Feature)>) {
    let corners = core.corners();
    if corners.len() < 3 {
        return (0, alloc::vec![(up, Feature::Corner(0))]);
    }
    let mut best: Option<(i64, i64)> = None;
    let mut ways = Vec::new();
    for i in 0..corners.len() {
        let e = edge(corners, i);
        // A segment of a chain is left to its outer side.
        if link.is_some_and(|link| cross(link, e) != 0 || dot(link, e) < 0) {
            continue;
        }
        let rank = (depth_of(core, i), -along(unit(outward(e)), up));
        if best.is_none_or(|best| rank < best) {
            best = Some(rank);
            ways.clear();
        }
        if best == Some(rank) {
            ways.push((outward(e), Feature::Edge(i)));
        }
    }
    (best.map_or(0, |(depth, _)| depth), ways)
}

impl Obstacles<'_> {
    /// Returns true if an obstacle is a segment of a chain, and the middle of the corners of the character is behind it.
    fn is_behind(neighbour: &Neighbour, at: Point) -> bool {
        let (Some(link), &[from, ..]) = (neighbour.link, neighbour.cores[1].corners()) else { return false };
        let corners = neighbour.cores[0].corners().iter();
        // At most 64 terms below 2^105.
        corners.map(|&corner| cross(from_to(sum(corner, at), from), link)).sum::<i128>() > 0
    }

    /// Returns true if a one-way obstacle holds a point in this direction from it.
    fn holds(neighbour: &Neighbour, unit: Point) -> bool {
        neighbour.side.is_none_or(|side| {
            along(unit, [side.direction.x.to_bits(), side.direction.y.to_bits()]) >= side.cosine.to_bits()
        })
    }

    /// The planes at a point, relative to the start. Obstacles of the body `excluded` are left out.
    pub(super) fn contacts(&self, at: Point, excluded: Option<BodyId>) -> Contacts {
        let Terms { up, skin, .. } = *self.terms;
        let mut contacts = Contacts::default();
        for (index, neighbour) in self.neighbours.iter().enumerate() {
            let radius = neighbour.sum.core.radius;
            let core = neighbour.sum.core.seen_from(at, 0);
            if excluded == Some(neighbour.body) || Self::is_behind(neighbour, at) {
                contacts.skipped.push(index);
                continue;
            }
            let nearest = nearest(core.corners());
            // Below 2^55.
            let separation = (distance(&core, nearest) >> 16) as i64 - radius;
            if separation > skin + NEAR {
                continue;
            }
            contacts.skipped.push(index);
            let mut add = |direction: Point, depth: i64, feature: Feature| {
                let unit = unit(direction);
                // A one-way collider that the character came through lets it pass until it has left the skin.
                let is_held = neighbour.side.is_none() || depth <= DEEP || self.stood_on == Some(neighbour.body);
                if is_held && Self::holds(neighbour, unit) {
                    let cosine = along(unit, up);
                    let overlaps = depth >= skin;
                    contacts.planes.push(Plane { index, direction, unit, cosine, depth, feature, overlaps });
                }
            };
            match nearest {
                Near::Edge(i) => add(outward(edge(core.corners(), i)), skin - separation, Feature::Edge(i)),
                Near::Corner(i) => add(core.corners()[i].map(|part| -part), skin - separation, Feature::Corner(i)),
                Near::Inside => {
                    let (depth, ways) = ways_out(&core, neighbour.link, up);
                    ways.into_iter().for_each(|(direction, feature)| add(direction, depth + radius + skin, feature));
                }
            }
        }
        contacts
    }

    /// The fraction of a way from a point to where it is stopped, in units of 2^-62. Obstacles of its contacts, which it leads along or out
    /// of, do not stop it.
    pub(super) fn cast(&self, at: Point, way: Point, contacts: &Contacts) -> u64 {
        let mut first_fraction = FULL;
        for (index, neighbour) in self.neighbours.iter().enumerate() {
            // In ascending order.
            if contacts.skipped.binary_search(&index).is_ok() {
                continue;
            }
            if neighbour.link.is_some_and(|link| cross(way, link) >= 0) {
                continue;
            }
            let core = neighbour.sum.core.seen_from(at, neighbour.sum.core.radius + self.terms.skin - REST);
            let Some(end) = first_hit(&core, way).filter(|end| end.fraction < first_fraction) else { continue };
            if neighbour.side.is_none() || Self::holds(neighbour, normal_bits(&core, way, end)) {
                first_fraction = end.fraction;
            }
        }
        first_fraction
    }
}

fn normal_bits(core: &Core, way: Point, end: RayEnd) -> Point {
    let normal = normal(core, way, end);
    [normal.x.to_bits(), normal.y.to_bits()]
}
