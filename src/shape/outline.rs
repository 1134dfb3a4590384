//! Outlines: each shape as convex cores with a radius around them, made once, when the shape is made.
//! A disc is a point with a radius, a capsule a line with one, a rectangle a polygon, a rounded polygon one with a radius.

use alloc::sync::Arc;
use alloc::vec::Vec;
use core::cmp::Ordering;
use core::fmt;

use super::{Aabb, Geometry, Part};
use crate::fx::Fx;
use crate::math::Vec2;
use crate::scalar::{Angle, Factor, Scalar, Wide};

/// A convex core and a radius: all points within `radius` of the core, in coordinates relative to the centre of mass of
/// the shape it belongs to.
///
/// ```
/// use umbra_physics::{Aabb, Outline, Shape, fx, vec2};
///
/// let capsule = Shape::capsule(fx!(2), fx!(0.5))?;
/// let [outline] = capsule.outlines() else { unreachable!() };
/// assert_eq!(outline.corners(), [vec2(-1, 0), vec2(1, 0)]);
/// assert_eq!(outline.normals(), [vec2(0, -1), vec2(0, 1)]);
/// assert_eq!(outline.radius(), fx!(0.5));
/// assert_eq!(outline.bounds(), Aabb { min: vec2(fx!(-1.5), fx!(-0.5)), max: vec2(fx!(1.5), fx!(0.5)) });
///
/// let wedge = Shape::polygon(&[vec2(0, 0), vec2(6, 0), vec2(0, 3)])?;
/// let outline: &Outline = &wedge.outlines()[0];
/// assert_eq!(outline.corners(), [vec2(-2, -1), vec2(4, -1), vec2(-2, 2)]);
/// assert_eq!(outline.normals()[0], vec2(0, -1)); // of the edge from corner 0 to corner 1
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Outline<S: Scalar = Fx> {
    core: Core<S>,
    radius: S,
}

#[derive(Clone, Debug, PartialEq)]
enum Core<S: Scalar> {
    /// The centre of a disc: nothing on the heap.
    Point(Vec2<S>),
    Sides {
        corners: Arc<[Vec2<S>]>,
        normals: Arc<[Vec2<S>]>,
    },
    /// A segment of a chain, by its number.
    Link(Arc<Links<S>>, usize),
}

/// The segments of a chain.
#[derive(PartialEq)]
struct Links<S> {
    /// The points; of a closed chain the first one is at the end again.
    points: Vec<Vec2<S>>,
    /// The outward normal of each segment, and its opposite.
    normals: Vec<[Vec2<S>; 2]>,
    is_closed: bool,
}

impl<S> fmt::Debug for Links<S> {
    /// The number of points: each outline of a chain shows it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Links").field("points", &self.points.len()).finish_non_exhaustive()
    }
}

/// The surface beside a segment of a chain, or beside an edge of a polygon among others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Neighbour<T> {
    /// No segment: the chain ends.
    None,
    /// The chain goes on straight, or turns to the side on which it touches others: the neighbour's outward normal.
    Inner(T),
    /// The chain turns to the other side: the neighbour's outward normal.
    Outer(T),
    /// The next edge of the same polygon: its outward normal.
    Own(T),
    /// Another polygon covers the end of the edge.
    Covered,
}

impl<T> Neighbour<T> {
    pub(crate) fn map<U>(self, image: impl FnOnce(T) -> U) -> Neighbour<U> {
        match self {
            Self::None => Neighbour::None,
            Self::Inner(normal) => Neighbour::Inner(image(normal)),
            Self::Outer(normal) => Neighbour::Outer(image(normal)),
            Self::Own(normal) => Neighbour::Own(image(normal)),
            Self::Covered => Neighbour::Covered,
        }
    }
}

/// The outlines of a shape.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Outlines<S: Scalar> {
    One(Outline<S>),
    /// Outlines of a compound's parts, or of a chain's segments.
    Parts(Arc<[Outline<S>]>),
}

impl<S: Scalar> Outlines<S> {
    pub(super) fn as_slice(&self) -> &[Outline<S>] {
        match self {
            Self::One(outline) => core::slice::from_ref(outline),
            Self::Parts(outlines) => outlines,
        }
    }

    /// The outlines turned and moved: see [`Shape::outlines_at`](super::Shape::outlines_at).
    pub(super) fn at(&self, angle: S, position: Vec2<S>) -> impl ExactSizeIterator<Item = Outline<S>> + '_ {
        let all = self.as_slice();
        // The segments of a chain share their points.
        let links = match &all[0].core {
            Core::Link(links, _) if angle == S::ZERO && position == Vec2::ZERO => Some(Arc::clone(links)),
            Core::Link(links, _) => {
                let direction = S::Angle::from_radians(angle).direction();
                Some(Arc::new(links.placed(direction, position)))
            }
            _ => None,
        };
        let of_chain = move |(number, outline): (usize, &Outline<S>)| match &links {
            Some(links) => Outline { core: Core::Link(Arc::clone(links), number), radius: S::ZERO },
            None => outline.at(angle, position),
        };
        all.iter().enumerate().map(of_chain)
    }
}

impl<S: Scalar> Links<S> {
    fn new(points: &[Vec2<S>], is_closed: bool) -> Self {
        let mut closed = Vec::with_capacity(points.len() + usize::from(is_closed));
        closed.extend_from_slice(points);
        closed.extend(points.first().filter(|_| is_closed));
        let normals = closed.windows(2).map(|ends| normal(ends[0], ends[1])).map(|normal| [normal, -normal]).collect();
        Self { points: closed, normals, is_closed }
    }

    fn placed(&self, direction: <S::Angle as Angle<S>>::Direction, position: Vec2<S>) -> Self {
        let turned = |v: &Vec2<S>| turned::<S>(direction, *v);
        Self {
            points: self.points.iter().map(|point| turned(point) + position).collect(),
            normals: self.normals.iter().map(|normals| [turned(&normals[0]), turned(&normals[1])]).collect(),
            is_closed: self.is_closed,
        }
    }

    /// The segments before and after one.
    fn neighbours(&self, number: usize) -> [Neighbour<Vec2<S>>; 2] {
        let count = self.normals.len();
        let beside = |first: usize, second: usize, turn: usize| {
            let (corner, normal) = (self.points[first + 1], self.normals[turn][0]);
            match S::orientation(self.points[first], corner, self.points[second + 1]) {
                Ordering::Greater => Neighbour::Outer(normal),
                _ => Neighbour::Inner(normal),
            }
        };
        let before = match number {
            0 if self.is_closed => beside(count - 1, 0, count - 1),
            0 => Neighbour::None,
            _ => beside(number - 1, number, number - 1),
        };
        let after = match number + 1 {
            next if next < count => beside(number, next, next),
            _ if self.is_closed => beside(count - 1, 0, 0),
            _ => Neighbour::None,
        };
        [before, after]
    }
}

/// A vector turned. Nothing in the domain is too large for it.
fn turned<S: Scalar>(direction: <S::Angle as Angle<S>>::Direction, v: Vec2<S>) -> Vec2<S> {
    S::Angle::turn(direction, v).and_then(|turned| turned.try_map(Wide::to_scalar)).unwrap_or(v)
}

impl<S: Scalar> Outline<S> {
    /// The corners of the core, counter-clockwise, m: one of a disc, two of a segment or a capsule, three or more of a
    /// polygon.
    ///
    /// *Error* none for polygons and segments; ½ ulp where half of a rectangle's or a capsule's size is no multiple of an
    /// ulp, the same on both sides; 0.51 ulp more in a compound, where a part is turned.
    #[must_use]
    pub fn corners(&self) -> &[Vec2<S>] {
        match &self.core {
            Core::Point(centre) => core::slice::from_ref(centre),
            Core::Sides { corners, .. } => corners,
            Core::Link(links, number) => &links.points[*number..*number + 2],
        }
    }

    /// The outward unit normals: number `i` belongs to the edge from corner `i` to the next one. Of a segment or a capsule
    /// there are two, of a disc none. *Error* 0.501 ulp in each component; 0.51 ulp more in a compound, where a part is turned.
    #[must_use]
    pub fn normals(&self) -> &[Vec2<S>] {
        match &self.core {
            Core::Point(_) => &[],
            Core::Sides { normals, .. } => normals,
            Core::Link(links, number) => &links.normals[*number],
        }
    }

    /// Another segment of the same chain, of a segment of a chain; else the outline itself.
    pub(crate) fn segment(&self, number: usize) -> Self {
        match &self.core {
            Core::Link(links, _) => Self { core: Core::Link(Arc::clone(links), number), radius: self.radius },
            _ => self.clone(),
        }
    }

    /// The segments before and after it, of a segment of a chain; `None` of all other outlines.
    pub(crate) fn neighbours(&self) -> Option<[Neighbour<Vec2<S>>; 2]> {
        match &self.core {
            Core::Link(links, number) => Some(links.neighbours(*number)),
            _ => None,
        }
    }

    /// The radius around the core, m; 0 for polygons and segments.
    #[must_use]
    pub fn radius(&self) -> S {
        self.radius
    }

    /// The least box around the core and its radius, exactly. *Cost* in proportion to the corners.
    #[must_use]
    pub fn bounds(&self) -> Aabb<S> {
        Aabb::around(self.corners(), self.radius)
    }

    /// The outline turned by an angle in radians and moved. *Domain* as [`placed`](Self::placed).
    pub(crate) fn at(&self, angle: S, position: Vec2<S>) -> Self {
        if angle == S::ZERO && position == Vec2::ZERO {
            return self.clone();
        }
        self.placed(S::Angle::from_radians(angle).direction(), position)
    }

    /// The largest distance of a point from the origin of the coordinates, m, rounded up: corners and radius.
    pub(crate) fn reach(&self) -> S {
        let farthest = self.corners().iter().map(|corner| corner.wide_length());
        let farthest = farthest.fold(S::Factor::ZERO, |max, length| if length > max { length } else { max });
        // Corners are within 2^15 m, so that lengths fit. A length is rounded to nearest: one ulp more is an upper bound.
        let farthest = farthest.to_scalar().unwrap_or(S::ZERO);
        if farthest == S::ZERO { self.radius } else { farthest + S::from_fx(Fx::DELTA) + self.radius }
    }

    /// The least distance of two parallel lines that the outline is between, m. *Error* 2 ulp.
    pub(crate) fn width(&self) -> S {
        let corners = self.corners();
        // From either end of an edge, as a normal is rounded: a mirror image has the ends in the opposite order.
        let ends = corners.iter().zip(corners.iter().cycle().skip(1));
        let depths = ends.zip(self.normals()).map(|((start, end), &normal)| {
            let behind = |(corner, end): (&Vec2<S>, &Vec2<S>)| {
                let [x, y] = [normal.x.product(corner.x - end.x), normal.y.product(corner.y - end.y)];
                x.plus(y).and_then(Wide::to_scalar).unwrap_or(S::ZERO)
            };
            let all = corners.iter().flat_map(|corner| [(start, corner), (end, corner)]);
            all.map(behind).fold(S::ZERO, |max, depth| if depth > max { depth } else { max })
        });
        // A segment is behind neither of its sides, a disc has none.
        let least = depths.reduce(|least, depth| if depth < least { depth } else { least }).unwrap_or(S::ZERO);
        least + self.radius + self.radius
    }

    /// The outline of two corners or more that stand counter-clockwise; normals follow.
    fn of(corners: Arc<[Vec2<S>]>, radius: S) -> Self {
        let next = corners.iter().cycle().skip(1);
        let normals = corners.iter().zip(next).map(|(&corner, &next)| normal(corner, next)).collect();
        Self { core: Core::Sides { corners, normals }, radius }
    }

    /// The outline where a part of a compound has it. *Domain* the part was checked: corners are within √2·2^13 m of its
    /// centre of mass, and that is within 2^13 m of the origin, so that sums stay below 2^15 m.
    fn placed(&self, direction: <S::Angle as Angle<S>>::Direction, position: Vec2<S>) -> Self {
        let turned = |v: &Vec2<S>| turned::<S>(direction, *v);
        let place = |corner: &Vec2<S>| turned(corner) + position;
        let core = match &self.core {
            Core::Point(centre) => Core::Point(place(centre)),
            Core::Sides { corners, normals } => Core::Sides {
                corners: corners.iter().map(place).collect(),
                normals: normals.iter().map(turned).collect(),
            },
            Core::Link(links, number) => Core::Link(Arc::new(links.placed(direction, position)), *number),
        };
        Self { core, radius: self.radius }
    }
}

/// The outward unit normal of the edge from `a` to `b`, counter-clockwise: (dy, −dx) / length. Both corners differ.
fn normal<S: Scalar>(a: Vec2<S>, b: Vec2<S>) -> Vec2<S> {
    let edge = b - a;
    let length = edge.wide_length();
    // A quotient is at most 1, which fits. Magnitudes are rounded, so that a mirrored edge has the mirrored normal.
    let part = |component: S| {
        let size = S::Factor::from_scalar(component).over(length).to_scalar().unwrap_or(S::ONE);
        if component < S::ZERO { -size } else { size }
    };
    Vec2::new(part(edge.y), part(-edge.x))
}

/// The unit vector along a vector, turned by an angle. *Error* as that of a normal.
pub(crate) fn turned_unit<S: Scalar>(v: Vec2<S>, angle: S) -> Vec2<S> {
    // The outward normal of the edge from the origin to what is a quarter turn further.
    let unit = normal(Vec2::ZERO, v.perp());
    if angle == S::ZERO { unit } else { turned::<S>(S::Angle::from_radians(angle).direction(), unit) }
}

/// Half of a size, rounded to nearest, ties to even.
fn half<S: Scalar>(size: S) -> S {
    S::Factor::from_scalar(size).times(S::Factor::from_ratio(1, 2)).to_scalar().unwrap_or(size)
}

/// The outlines of a geometry: one for each part of a compound or segment of a chain in their order, else one.
pub(super) fn outlines<S: Scalar>(geometry: &Geometry<S>) -> Outlines<S> {
    Outlines::One(match geometry {
        Geometry::Circle { radius } => Outline { core: Core::Point(Vec2::ZERO), radius: *radius },
        Geometry::Rectangle { width, height } => {
            let (x, y) = (half(*width), half(*height));
            let corners = [Vec2::new(-x, -y), Vec2::new(x, -y), Vec2::new(x, y), Vec2::new(-x, y)];
            Outline::of(Arc::new(corners), S::ZERO)
        }
        Geometry::Capsule { length, radius } => {
            let x = half(*length);
            Outline::of(Arc::new([Vec2::new(-x, S::ZERO), Vec2::new(x, S::ZERO)]), *radius)
        }
        Geometry::Polygon { corners } => Outline::of(Arc::clone(corners), S::ZERO),
        Geometry::RoundedPolygon { corners, radius } => Outline::of(Arc::clone(corners), *radius),
        Geometry::Segment { ends } => Outline::of(Arc::new(*ends), S::ZERO),
        Geometry::Compound { parts } => {
            return Outlines::Parts(parts.iter().flat_map(of_part).collect::<Vec<_>>().into());
        }
        Geometry::Chain { points, closed } => {
            let links = Arc::new(Links::new(points, *closed));
            let link = |number| Outline { core: Core::Link(Arc::clone(&links), number), radius: S::ZERO };
            return Outlines::Parts((0..links.normals.len()).map(link).collect());
        }
    })
}

/// The outlines of a part of a compound, where the compound has it.
fn of_part<S: Scalar>(part: &Part<S>) -> impl Iterator<Item = Outline<S>> {
    let direction = S::Angle::from_radians(part.angle).direction();
    part.shape.outlines().iter().map(move |outline| outline.placed(direction, part.position))
}
