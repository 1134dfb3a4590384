//! Reading shapes.

use alloc::vec::Vec;

use super::error::Flaw;
use super::node::{Kind, Node, Result};
use super::object::Object;
use umbra_physics::{
    Dimension, Error, Fx, Geometry, Part, Quantity, Scalar, Shape, Vec2,
    limits::{CHAIN, CONCAVE_CORNERS, CORNERS, PARTS, SIZE_MAX, SIZE_MIN},
};

/// A shape in the coordinates of the file, to be made for any scalar. Sizes in m.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[allow(missing_docs, reason = "as in `Geometry`, before re-centring")]
pub enum ShapeDef {
    Circle { radius: Fx },
    Rectangle { width: Fx, height: Fx },
    Capsule { length: Fx, radius: Fx },
    Polygon { corners: Vec<Vec2> },
    RoundedPolygon { corners: Vec<Vec2>, radius: Fx },
    Segment { ends: [Vec2; 2] },
    Compound { parts: Vec<PartDef> },
    Chain { points: Vec<Vec2>, closed: bool },
}

/// A part of a compound.
#[derive(Clone, Debug, PartialEq)]
pub struct PartDef {
    /// The shape of the part.
    pub shape: ShapeDef,
    /// The position of its centre of mass, m.
    pub position: Vec2,
    /// The angle, rad.
    pub angle: Fx,
    /// The density relative to the other parts.
    pub density: Fx,
}

pub(super) fn vector<S: Scalar>(v: Vec2) -> Vec2<S> {
    v.map(S::from_fx)
}

impl ShapeDef {
    /// The shape.
    ///
    /// # Errors
    /// As the constructors of [`Shape`].
    ///
    /// ```
    /// use umbra_scene::{PartDef, ShapeDef};
    /// use umbra_physics::{Fx, Shape, fx, vec2};
    ///
    /// let ball = ShapeDef::Circle { radius: fx!(1) };
    /// let part = |x: i32| PartDef { shape: ball.clone(), position: vec2(x, 0), angle: fx!(0), density: fx!(1) };
    /// let dumbbell: Shape<Fx> = ShapeDef::Compound { parts: vec![part(-2), part(2)] }.make()?;
    /// assert_eq!(dumbbell.measure().to_scalar().map(|area| format!("{area:.4}")), Some("6.2832".into()));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn make<S: Scalar>(&self) -> core::result::Result<Shape<S>, Error> {
        let scalar = |value: &Fx| S::from_fx(*value);
        match self {
            Self::Circle { radius } => Shape::new(Geometry::Circle { radius: scalar(radius) }),
            Self::Rectangle { width, height } => {
                Shape::new(Geometry::Rectangle { width: scalar(width), height: scalar(height) })
            }
            Self::Capsule { length, radius } => {
                Shape::new(Geometry::Capsule { length: scalar(length), radius: scalar(radius) })
            }
            Self::Polygon { corners } => {
                let corners: Vec<_> = corners.iter().map(|&corner| vector(corner)).collect();
                Shape::polygon(&corners)
            }
            Self::RoundedPolygon { corners, radius } => {
                let corners: Vec<_> = corners.iter().map(|&corner| vector(corner)).collect();
                Shape::rounded_polygon(&corners, scalar(radius))
            }
            Self::Segment { ends: [a, b] } => Shape::segment(vector(*a), vector(*b)),
            Self::Compound { parts } => {
                let part = |part: &PartDef| {
                    let PartDef { shape, position, angle, density } = part;
                    Ok(Part {
                        shape: shape.make()?,
                        position: vector(*position),
                        angle: S::from_fx(*angle),
                        density: S::from_fx(*density),
                    })
                };
                let parts: core::result::Result<Vec<_>, Error> = parts.iter().map(part).collect();
                Shape::compound(&parts?)
            }
            Self::Chain { points, closed } => {
                let points: Vec<_> = points.iter().map(|&point| vector(point)).collect();
                Shape::chain(&points, *closed)
            }
        }
    }
}

impl From<&Shape> for ShapeDef {
    /// Recovers what the shape was made from, exactly: the values it keeps and its shift are small multiples of an ulp. A polygon
    /// has its corners counter-clockwise.
    fn from(shape: &Shape) -> Self {
        let unshifted = |point: Vec2| point + shape.shift();
        match shape.geometry() {
            &Geometry::Circle { radius } => Self::Circle { radius },
            &Geometry::Rectangle { width, height } => Self::Rectangle { width, height },
            &Geometry::Capsule { length, radius } => Self::Capsule { length, radius },
            Geometry::Polygon { corners } => Self::Polygon { corners: corners.iter().map(|&c| unshifted(c)).collect() },
            Geometry::RoundedPolygon { corners, radius } => {
                Self::RoundedPolygon { corners: corners.iter().map(|&c| unshifted(c)).collect(), radius: *radius }
            }
            &Geometry::Segment { ends } => Self::Segment { ends: ends.map(unshifted) },
            Geometry::Compound { parts } => {
                let part = |part: &Part| {
                    let Part { ref shape, position, angle, density } = *part;
                    PartDef { shape: shape.into(), position: unshifted(position), angle, density }
                };
                Self::Compound { parts: parts.iter().map(part).collect() }
            }
            Geometry::Chain { points, closed } => Self::Chain { points: points.to_vec(), closed: *closed },
            // All there are stand above: `tests/layers.rs` compares the lists.
            geometry => unreachable!("a scene has no words for {geometry:?}"),
        }
    }
}

fn size(node: &Node<'_>, dimension: Dimension) -> Result<Fx> {
    let value = node.number()?;
    if (SIZE_MIN..=SIZE_MAX).contains(&value) {
        return Ok(value);
    }
    Err(node.fault(Error::OutOfRange { quantity: Quantity::Size { dimension, value } }))
}

fn radius(node: &Node<'_>) -> Result<Fx> {
    size(node, Dimension::Radius)
}

fn rounding(node: &Node<'_>) -> Result<Fx> {
    size(node, Dimension::Rounding)
}

/// Reads a shape and makes sure that it can be made.
pub(super) fn shape(node: &Node<'_>) -> Result<ShapeDef> {
    read(node, false)
}

fn read(node: &Node<'_>, part_of_one: bool) -> Result<ShapeDef> {
    let object = node.object()?;
    let names = [
        "circle",
        "rectangle",
        "capsule",
        "polygon",
        "hull",
        "concave_polygon",
        "rounded_polygon",
        "segment",
        "compound",
        "chain",
    ];
    let (name, inner) = object.one_of(&names)?;
    object.finish()?;
    if part_of_one && name == "concave_polygon" {
        return Err(inner.fault("a part cannot be a concave polygon, which has parts itself"));
    }
    if part_of_one && name == "compound" {
        // Refused before it is looked into: the depth of a file is no depth of calls.
        return Err(inner.fault("a part cannot be a compound itself"));
    }
    if part_of_one && name == "chain" {
        return Err(inner.fault("a part cannot be a chain"));
    }
    let def = match name {
        "polygon" => ShapeDef::Polygon { corners: corners(inner)? },
        "hull" => {
            let shape = Shape::hull(&points(inner, CHAIN)?).map_err(|error| inner.fault(error))?;
            ShapeDef::from(&shape)
        }
        "concave_polygon" => {
            let shape = Shape::concave_polygon(&points(inner, CONCAVE_CORNERS)?).map_err(|error| inner.fault(error))?;
            ShapeDef::from(&shape)
        }
        "rounded_polygon" => {
            let object = inner.object()?;
            let (corners, radius) = (object.need("corners", corners), object.need("radius", rounding));
            object.finish()?;
            ShapeDef::RoundedPolygon { corners: corners?, radius: radius? }
        }
        "segment" => {
            let [a, b] = inner.tuple()?.map(|end: Node<'_>| end.point());
            ShapeDef::Segment { ends: [a?, b?] }
        }
        "compound" => {
            let parts = inner.list(PARTS, Error::OutOfRange { quantity: Quantity::Count })?;
            let parts: Vec<_> = parts.iter().map(part).collect();
            ShapeDef::Compound { parts: parts.into_iter().collect::<Result<_>>()? }
        }
        "chain" => {
            let object = inner.object()?;
            let (points, closed) =
                (object.need("points", |node| points(node, CHAIN)), object.or("closed", false, Node::boolean));
            object.finish()?;
            ShapeDef::Chain { points: points?, closed }
        }
        _ => {
            let object = inner.object()?;
            match name {
                "circle" => {
                    let radius = object.need("radius", radius);
                    object.finish()?;
                    ShapeDef::Circle { radius: radius? }
                }
                "rectangle" => {
                    let width = object.need("width", |node| size(node, Dimension::Width));
                    let height = object.need("height", |node| size(node, Dimension::Height));
                    object.finish()?;
                    ShapeDef::Rectangle { width: width?, height: height? }
                }
                _ => {
                    let length = object.need("length", |node| size(node, Dimension::Length));
                    let radius = object.need("radius", rounding);
                    object.finish()?;
                    ShapeDef::Capsule { length: length?, radius: radius? }
                }
            }
        }
    };
    def.make::<Fx>().map_err(|error| inner.fault(error))?;
    Ok(def)
}

/// The corners of a convex polygon.
fn corners(node: &Node<'_>) -> Result<Vec<Vec2>> {
    let nodes = node.list(CORNERS, Error::OutOfRange { quantity: Quantity::Count })?;
    let corners: Vec<_> = nodes.iter().map(Node::point).collect();
    let corners = corners.into_iter().collect::<Result<Vec<_>>>()?;
    match Shape::polygon(&corners) {
        Err(Error::NotConvex { corner }) => Err(nodes[corner].fault(Error::NotConvex { corner })),
        Err(error) => Err(node.fault(error)),
        Ok(_) => Ok(corners),
    }
}

/// The points of a chain or a hull, or the corners of a concave polygon.
fn points(node: &Node<'_>, max_count: usize) -> Result<Vec<Vec2>> {
    let nodes = node.list(max_count, Error::OutOfRange { quantity: Quantity::Count })?;
    nodes.iter().map(Node::point).collect()
}

fn part(node: &Node<'_>) -> Result<PartDef> {
    let object = node.object()?;
    let shape = object.need("shape", |node| read(node, true));
    let position = object.or("position", Vec2::ZERO, Node::point);
    let angle = object.or("angle", Fx::ZERO, Node::number);
    let density = object.or("density", Fx::ONE, Node::number);
    object.finish()?;
    let part = PartDef { shape: shape?, position, angle, density };
    if part.density <= Fx::ZERO {
        return Err(object
            .at(&["density"])
            .fault(Error::OutOfRange { quantity: Quantity::Density { value: part.density } }));
    }
    Ok(part)
}

impl Node<'_> {
    /// A vector: [x, y], {x, y}, or {length, angle} in rad.
    pub(super) fn point(&self) -> Result<Vec2> {
        if self.kind() == Kind::List {
            let [x, y] = self.tuple()?.map(|component: Node<'_>| component.number());
            return Ok(Vec2::new(x?, y?));
        }
        if self.kind() != Kind::Object {
            return Err(self.wrong_kind(r#"[x, y] or {"x": …, "y": …}"#));
        }
        self.object()?.vector()
    }
}

impl Object<'_> {
    /// The vector that an object with `x` and `y`, or `length` and `angle`, is.
    pub(super) fn vector(&self) -> Result<Vec2> {
        if !self.has("length") && !self.has("angle") {
            let (x, y) = (self.need("x", Node::number), self.need("y", Node::number));
            self.finish()?;
            return Ok(Vec2::new(x?, y?));
        }
        let (length, angle) = (self.need("length", Node::number), self.need("angle", Node::number));
        self.finish()?;
        let (length, angle) = (length?, angle?);
        let (sin, cos) = angle.sin_cos();
        // |sin| and |cos| are at most 1. Against the largest length there is room for it one way alone: −2^31 turned round is no `Fx`.
        let component = |unit| length.checked_mul(unit);
        let vector = component(cos).zip(component(sin)).map(|(x, y)| Vec2::new(x, y));
        vector.ok_or_else(|| {
            self.node.fault(Flaw::OutOfRange.of("out of range: a component of the vector is not below 2^31"))
        })
    }
}
