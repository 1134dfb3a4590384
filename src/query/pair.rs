//! The distance of two shapes, and how deep they overlap.
//!
//! The second shape less the first one is a set of differences (`sum`), and the origin is the place where both have a point in common. Apart, the
//! nearest point of that set is the shortest way from one shape to the other; overlapping, its nearest point of the surface is the
//! shortest translation that separates them. Both are exact up to their rounding.

use super::core::in_fx;
use super::near::FRACTION;
use super::shape::{checked_point, in_scalar};
use super::sum::middle_of_overlap;
use super::{Core, Near, Placement, Point, Sum, beside, distance, edge, from_to, nearest, odd_shift, outward, point};
use crate::error::{Error, Quantity};
use crate::fx::Fx;
use crate::math::Vec2;
use crate::scalar::{Angle as _, Scalar};
use crate::shape::Shape;

/// The distance of two shapes, or the depth in which they overlap, and the points where: see [`Shape::distance_to`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct ShapeDistance<S = Fx> {
    /// The distance of the surfaces, m. Negative where the shapes overlap: then it is the length of the shortest translation that separates
    /// them. *Error* ½ ulp and 2^-16.
    pub separation: S,
    /// The unit vector from the first shape to the second one, along which they are that far apart: the second one moved along it by the depth of
    /// the overlap, or the first one against it, only touches the other. *Error* 1 ulp in each component.
    pub normal: Vec2<S>,
    /// The points of the first and of the second shape that are nearest to each other, m; where they overlap, the ones that are deepest in the other
    /// shape. Where two edges are parallel, points in the middle of the stretch along which they face each other. The way from the first to the
    /// second one is `separation` along `normal`. *Error* 2 ulps in each component, and 2^-31 of the radii.
    pub points: [Vec2<S>; 2],
    /// The numbers of the parts of a compound or of the segments of a chain; 0 for all other shapes.
    pub parts: [u32; 2],
}

impl<S: Scalar> Shape<S> {
    /// The distance from this shape to another one, each at a pose (the position of its centre of mass in m, and the angle in rad), or the depth
    /// in which they overlap.
    ///
    /// Of shapes with several parts it is the pair of parts that are nearest to each other, or that overlap deepest; of several pairs the one with
    /// the least numbers. A segment of a chain is a line without a side. Where several directions separate two shapes equally, to 2^-48 m,
    /// the one that leads most from the centre of the first shape to the centre of the second one counts, and of those that still tie the one
    /// that leads up most, then to the right: two discs around one point are separated upwards.
    ///
    /// Swapped shapes have the opposite normal and the same points, to the bit, and a mirror image has the mirror image: but for directions
    /// or pairs of parts that tie, of which either may take another one.
    ///
    /// *Cost* in proportion to the product of the numbers of parts, and to the corners of each two.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Position`] or [`Quantity::Angle`]; with [`Quantity::Query`] for shapes 2^21 m apart or more along an
    /// axis.
    ///
    /// ```
    /// use umbra_physics::{Fx, Shape, ShapeDistance, fx, vec2};
    ///
    /// let (square, disc) = (Shape::rectangle(2, 2)?, Shape::circle(1)?);
    /// let at = |x: i32, y: i32| (vec2(x, y), fx!(0));
    /// // The corner (1, 1) is 3 m and 4 m from the middle of the disc, along the axes.
    /// let apart: ShapeDistance = square.distance_to(at(0, 0), &disc, at(4, 5))?;
    /// assert_eq!((apart.separation, apart.normal), (fx!(4), vec2(fx!(0.6), fx!(0.8))));
    /// assert_eq!(apart.points, [vec2(1, 1), vec2(fx!(3.4), fx!(4.2))]);
    /// // Half a metre of the disc is in the square: it comes out on the right.
    /// let overlap = square.distance_to(at(0, 0), &disc, (vec2(fx!(1.5), 0), fx!(0)))?;
    /// assert_eq!((overlap.separation, overlap.normal), (fx!(-0.5), vec2(1, 0)));
    /// assert_eq!(overlap.points, [vec2(1, 0), vec2(fx!(0.5), 0)]);
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[doc(alias = "penetration")]
    #[doc(alias = "closest_points")]
    pub fn distance_to(
        &self,
        pose: (Vec2<S>, S),
        shape: &Self,
        shape_pose: (Vec2<S>, S),
    ) -> Result<ShapeDistance<S>, Error> {
        let placements = [checked_placement(pose.0, pose.1)?, checked_placement(shape_pose.0, shape_pose.1)?];
        let from = placements[0].position();
        let out_of_reach = Error::OutOfRange { quantity: Quantity::Query };
        let placed = |shape: &Self, placement: &Placement<S>| {
            shape
                .outlines()
                .iter()
                .map(|outline| Core::new(outline, placement, from))
                .collect::<Option<alloc::vec::Vec<_>>>()
        };
        let cores = (placed(self, &placements[0]), placed(shape, &placements[1]));
        let (Some(cores_a), Some(cores_b)) = cores else { return Err(out_of_reach) };
        let offset = from_to(from, placements[1].position());
        let mut nearest_pair: Option<(CoreDistance, [u32; 2])> = None;
        for (a, i) in cores_a.iter().zip(0..) {
            for (b, j) in cores_b.iter().zip(0..) {
                let pair = CoreDistance::new(a, b, from, offset);
                if nearest_pair.as_ref().is_none_or(|(least, _)| pair.separation < least.separation) {
                    nearest_pair = Some((pair, [i, j]));
                }
            }
        }
        let (pair, parts) = nearest_pair.ok_or(out_of_reach)?;
        Ok(pair.seen_at(from, parts))
    }
}

/// A pose within the limits.
fn checked_placement<S: Scalar>(position: Vec2<S>, angle: S) -> Result<Placement<S>, Error> {
    checked_point(position)?;
    if !angle.is_finite() {
        return Err(Error::OutOfRange { quantity: Quantity::Angle });
    }
    Ok(Placement::new(position, S::Angle::from_radians(angle)))
}

/// The distance of two cores with their radii, as seen from some point.
pub(crate) struct CoreDistance {
    /// 2^-48 m, negative where they overlap.
    separation: i128,
    /// From the first to the second one.
    normal: Vec2,
    /// ulps.
    points: [Point; 2],
}

/// A direction along which two cores are separated, or are to be separated.
#[derive(Clone, Copy)]
struct Way {
    /// The part of the sum that is nearest to the origin.
    feature: Near,
    /// The distance of the cores without their radii along the normal, 2^-48 m, negative where they overlap.
    separation: i128,
    /// The normal from the first to the second one, of any length.
    towards: Point,
}

impl CoreDistance {
    /// The distance from A to B, which are seen from a point of the world, for the way from the centre of A's body to that of B's.
    pub(crate) fn new(a: &Core, b: &Core, from: Point, offset: Point) -> Self {
        let sum = Sum::new(a, b);
        let sharp = sum.core.seen_from([0; 2], 0);
        let feature = nearest(sharp.corners());
        let towards = match feature {
            Near::Inside => None,
            Near::Edge(i) => Some(outward(edge(sharp.corners(), i)).map(|part| -part)),
            Near::Corner(i) => Some(sharp.corners()[i]),
        };
        let way = match towards {
            Some(towards) => Way { feature, separation: distance(&sharp, feature) as i128, towards },
            None => way_out(&sharp, offset),
        };
        let normal = unit(way.towards);
        let points = sum.points_along([a, b], &sharp, way, from);
        let out = |radius: i64| {
            // Below 2^32 + 1 times 2^46.
            [normal.x, normal.y].map(|part| odd_shift(i128::from(part.to_bits()) * i128::from(radius), 32) as i64)
        };
        let points = [beside(points[0], out(a.radius)), beside(points[1], out(-b.radius))];
        Self { separation: way.separation - (i128::from(a.radius + b.radius) << FRACTION), normal, points }
    }

    /// The distance as it is seen from the origin of the world, for the point from which the cores were seen.
    pub(crate) fn seen_at<S: Scalar>(&self, from: Point, parts: [u32; 2]) -> ShapeDistance<S> {
        ShapeDistance {
            separation: S::from_fx(Fx::from_bits(odd_shift(self.separation, FRACTION) as i64)),
            normal: self.normal.map(S::from_fx),
            points: self.points.map(|point| in_scalar(beside(from, point))),
            parts,
        }
    }
}

/// The unit vector along a vector.
fn unit(v: Point) -> Vec2 {
    in_fx(v).normalize().unwrap_or_default()
}

/// The shortest way out of a core around the origin, for the offset of the centres of two bodies.
fn way_out(sharp: &Core, offset: Point) -> Way {
    let corners = sharp.corners();
    if corners.len() == 1 {
        let towards = if offset == [0; 2] { [0, 1] } else { offset };
        return Way { feature: Near::Corner(0), separation: 0, towards };
    }
    let ways = (0..corners.len()).map(|i| {
        let feature = Near::Edge(i);
        let towards = outward(edge(corners, i)).map(|part| -part);
        Way { feature, separation: -(distance(sharp, feature) as i128), towards }
    });
    // Below 2^33·2^54.
    let rank = |way: &Way| {
        let [x, y] = [unit(way.towards).x, unit(way.towards).y].map(Fx::to_bits);
        let along = i128::from(x) * i128::from(offset[0]) + i128::from(y) * i128::from(offset[1]);
        (way.separation, along, y, x)
    };
    // There are two edges at least.
    ways.max_by_key(rank).unwrap_or(Way { feature: Near::Corner(0), separation: 0, towards: offset })
}

impl Sum {
    /// The points of the cores A and B, without their radii, that are beside each other along a way.
    fn points_along(&self, [a, b]: [&Core; 2], sharp: &Core, way: Way, from: Point) -> [Point; 2] {
        let (first, last) = match way.feature {
            Near::Edge(k) if k + 1 < self.pairs.len() => (k, k + 1),
            Near::Edge(k) => (k, 0),
            Near::Corner(k) => (k, k),
            Near::Inside => (0, 0),
        };
        let ([i, j], [last_i, last_j]) = (self.pairs[first], self.pairs[last]);
        let (corners_a, corners_b) = (a.corners(), b.corners());
        if i == last_i && j == last_j {
            return [corners_a[i], corners_b[j]];
        }
        // From A to B: what is beyond the surface is on the other side of it.
        let (offset, _) = point(sharp, way.feature, way.separation.unsigned_abs());
        let offset = if way.separation < 0 { offset.map(|part| -part) } else { offset };
        if j == last_j {
            return [from_to(offset, corners_b[j]), corners_b[j]];
        }
        if i == last_i {
            return [corners_a[i], beside(corners_a[i], offset)];
        }
        // The edge of A runs the other way.
        let (edge_a, edge_b) = ([corners_a[last_i], corners_a[i]], [corners_b[j], corners_b[last_j]]);
        // Halves are rounded away from the origin of the world, so that no point from which the cores are seen matters.
        let world = |edge: [Point; 2]| edge.map(|corner| beside(from, corner));
        let (edge_a, edge_b) = (world(edge_a), world(edge_b));
        [middle_of_overlap(edge_a, edge_b), middle_of_overlap(edge_b, edge_a)].map(|middle| from_to(from, middle))
    }
}
