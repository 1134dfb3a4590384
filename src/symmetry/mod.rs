//! Symmetries of the engine: exact images of worlds and commands, mirrored, turned by quarters or shifted.

mod world;

use alloc::vec::Vec;

use crate::body::{BodyDef, Locks};
use crate::force::ForceField;
use crate::fx::Fx;
use crate::joint::Gear;
use crate::math::Vec2;
use crate::scalar::{FxFactor, Turn};
use crate::shape::{Geometry, Part, Shape};
use crate::world::{Command, CommandMap};

/// A symmetry of the engine: p' = A·p + t, where A mirrors, turns by a quarter or does nothing, and t is an even number of
/// ulps. A world and its image, given images of the same inputs, stay each other's image to the bit.
///
/// The axes of the bodies go along: by as many quarters as the symmetry turns, and where it mirrors, points and shapes of a
/// body are mirrored in its axes. A value without an exact image has none here: a number whose opposite does not fit, a point more
/// than 2^29 m out under a symmetry that shifts, an angle in radians that no other one is a quarter turn from.
///
/// ```
/// use umbra_physics::{BodyDef, Command, ForceField, FieldKind, Shape, Symmetry, World, WorldDef, fx, vec2};
///
/// let mirror = Symmetry::MIRROR;
/// assert_eq!((mirror.name(), mirror.mirrors(), mirror.is_shift()), ("mirror", true, false));
/// assert_eq!((mirror.vector(vec2(3, 1)), mirror.point(vec2(3, 1))), (Some(vec2(-3, 1)), Some(vec2(-3, 1))));
/// assert_eq!((mirror.angular_velocity(fx!(2)), mirror.angle(fx!(0))), (Some(fx!(-2)), Some(fx!(0))));
/// // A quarter turn turns the axes of bodies along: in them nothing changes.
/// assert_eq!(
///     (Symmetry::TURN.vector(vec2(3, 1)), Symmetry::TURN.local(vec2(3, 1))),
///     (Some(vec2(-1, 3)), Some(vec2(3, 1)))
/// );
/// assert_eq!(mirror.about(vec2(5, 0)).and_then(|about| about.point(vec2(3, 1))), Some(vec2(7, 1)));
///
/// // A world and its image, given images of the same commands, stay each other's image to the bit.
/// let rod = Shape::segment(vec2(0, 0), vec2(1, 2))?;
/// assert_eq!(mirror.shape(&rod), Shape::segment(vec2(0, 0), vec2(-1, 2)).ok());
/// let mut world = World::new(WorldDef { gravity: vec2(1, -9), ..WorldDef::default() })?;
/// let body = world.add_body(BodyDef {
///     position: vec2(2, 3),
///     angular_velocity: fx!(1),
///     ..BodyDef::dynamic().with_collider(rod)
/// })?;
/// let wind = ForceField::from(FieldKind::Drag { linear: fx!(0.1), quadratic: fx!(0), wind: vec2(4, 0) });
/// let mut image = mirror.world(&world).unwrap();
/// world.add_field(wind)?;
/// image.add_field(mirror.field(&wind).unwrap())?;
/// let push = Command::SetVelocity { body, velocity: vec2(7, 0) };
/// world.execute(&push)?;
/// image.execute(&mirror.command(&push).unwrap())?;
/// (0..100).for_each(|_| _ = (world.step(), image.step()));
/// assert_eq!(mirror.world(&world).map(|moved| moved.state_hash()), Some(image.state_hash()));
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Symmetry {
    name: &'static str,
    /// Rows of A: a signed permutation.
    matrix: [[i8; 2]; 2],
    /// t.
    shift: Vec2,
    /// Quarter turns from a body's axes to their image, 0 or 1: θ' = ±θ + quarters/4 turns.
    quarters: u8,
}

/// An angle in `Fx` of 411,301,173 quarter turns, one beyond whole turns, within 0.034 of what a turn resolves; the only one
/// of its range as near.
const QUARTER: Fx = Fx::from_bits(2_774_851_117_601_566_901);

/// The largest coordinate from which a shift cannot lead out of the allowed positions.
const FAR: Fx = Fx::from_bits(1 << (32 + 29));
/// The largest shift of a coordinate, by far enough below what is left to [`limits::POSITION`](crate::limits::POSITION).
const SHIFT: i64 = 1 << (32 + 26);

impl Symmetry {
    /// Swaps left and right, about the line x = 0.
    pub const MIRROR: Self = Self { name: "mirror", matrix: [[-1, 0], [0, 1]], shift: Vec2::ZERO, quarters: 0 };
    /// Swaps up and down, about the line y = 0.
    pub const FLIP: Self = Self { name: "flip", matrix: [[1, 0], [0, -1]], shift: Vec2::ZERO, quarters: 0 };
    /// Swaps the axes, about the line x = y.
    pub const DIAGONAL: Self = Self { name: "diagonal", matrix: [[0, 1], [1, 0]], shift: Vec2::ZERO, quarters: 1 };
    /// Turns by a quarter to the left about the origin.
    pub const TURN: Self = Self { name: "turn", matrix: [[0, -1], [1, 0]], shift: Vec2::ZERO, quarters: 1 };

    /// Returns the symmetry about another point; `None` unless that shifts by an even number of ulps in each coordinate, and by at
    /// most 2^26 m.
    #[must_use]
    pub fn about(self, centre: Vec2) -> Option<Self> {
        let image = self.signed(centre, Fx::checked_neg)?;
        let shift = Vec2::new(centre.x.checked_sub(image.x)?, centre.y.checked_sub(image.y)?);
        Self { shift: Vec2::ZERO, ..self }.shifted(shift)
    }

    /// Returns the shift by a vector; `None` unless by an even number of ulps in each coordinate, and by at most 2^26 m.
    #[must_use]
    pub fn shift(shift: Vec2) -> Option<Self> {
        Self { name: "shift", matrix: [[1, 0], [0, 1]], shift: Vec2::ZERO, quarters: 0 }.shifted(shift)
    }

    fn shifted(self, shift: Vec2) -> Option<Self> {
        let is_fair = |c: Fx| c.to_bits() % 2 == 0 && c.to_bits().unsigned_abs() <= SHIFT.unsigned_abs();
        (is_fair(shift.x) && is_fair(shift.y)).then_some(Self { shift, ..self })
    }

    /// The name.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        self.name
    }

    /// Returns whether left and right hands change places.
    #[must_use]
    pub const fn mirrors(&self) -> bool {
        let [[a, b], [c, d]] = self.matrix;
        a * d - b * c < 0
    }

    /// Returns whether it only shifts.
    #[must_use]
    pub const fn is_shift(&self) -> bool {
        matches!(self.matrix, [[1, 0], [0, 1]])
    }

    /// A·v, `None` where a component has no opposite.
    fn signed<T: Copy>(&self, v: Vec2<T>, negative: impl Fn(T) -> Option<T>) -> Option<Vec2<T>> {
        let pick = |row: [i8; 2]| match row {
            [1, _] => Some(v.x),
            [-1, _] => negative(v.x),
            [_, 1] => Some(v.y),
            _ => negative(v.y),
        };
        Some(Vec2::new(pick(self.matrix[0])?, pick(self.matrix[1])?))
    }

    /// The image of a velocity, force, impulse or acceleration in the world's frame.
    #[must_use]
    pub fn vector(&self, vector: Vec2) -> Option<Vec2> {
        self.signed(vector, Fx::checked_neg)
    }

    /// The image of a point of the world, m.
    #[must_use]
    pub fn point(&self, point: Vec2) -> Option<Vec2> {
        let image = self.signed(point, Fx::checked_neg)?;
        if self.shift == Vec2::ZERO {
            return Some(image);
        }
        let is_near = |c: Fx| -FAR <= c && c <= FAR;
        (is_near(point.x) && is_near(point.y)).then(|| image + self.shift)
    }

    /// The image of a point or vector in the axes of its body.
    #[must_use]
    pub fn local(&self, v: Vec2) -> Option<Vec2> {
        self.signed_local(v, Fx::checked_neg)
    }

    /// [`local`](Self::local) of any numbers. A component keeps its axis: so along the axis of a joint, which has an angle in the axes of its body,
    /// and across it.
    fn signed_local<T: Copy>(&self, v: Vec2<T>, negative: impl Fn(T) -> Option<T> + Copy) -> Option<Vec2<T>> {
        let image = self.signed(v, negative)?;
        match self.quarters {
            0 => Some(image),
            _ => Some(Vec2::new(image.y, negative(image.x)?)),
        }
    }

    /// The image of an angular velocity, torque or angular impulse.
    #[must_use]
    pub fn angular_velocity(&self, value: Fx) -> Option<Fx> {
        if self.mirrors() { value.checked_neg() } else { Some(value) }
    }

    /// The image of an angle in radians, if there is one to the bit.
    #[must_use]
    pub fn angle(&self, angle: Fx) -> Option<Fx> {
        let image = self.angular_velocity(angle)?;
        let image = if self.quarters == 1 { image.checked_add(QUARTER)? } else { image };
        (Turn::from_radians(image) == self.turn(Turn::from_radians(angle))).then_some(image)
    }

    fn turn(&self, angle: Turn) -> Turn {
        let bits = angle.to_bits();
        let bits = if self.mirrors() { bits.wrapping_neg() } else { bits };
        Turn::from_bits(bits.wrapping_add(u64::from(self.quarters) << 62))
    }

    /// The image of what is locked: x and y change places where their axes do.
    ///
    /// ```
    /// use umbra_physics::{Locks, Symmetry};
    ///
    /// let rail = Locks { y: true, ..Locks::NONE };
    /// assert_eq!(Symmetry::TURN.locks(rail), Locks { x: true, ..Locks::NONE });
    /// ```
    #[must_use]
    pub fn locks(&self, locks: Locks) -> Locks {
        match self.matrix {
            [[0, _], _] => Locks { x: locks.y, y: locks.x, ..locks },
            _ => locks,
        }
    }

    /// The image of a shape.
    #[must_use]
    pub fn shape(&self, shape: &Shape) -> Option<Shape> {
        if !self.mirrors() {
            return Some(shape.clone());
        }
        let image = |point: Vec2| self.local(point + shape.shift());
        match shape.geometry() {
            Geometry::Circle { .. } | Geometry::Rectangle { .. } | Geometry::Capsule { .. } => Some(shape.clone()),
            Geometry::Polygon { corners } => {
                let corners: Vec<Vec2> = corners.iter().map(|&corner| image(corner)).collect::<Option<_>>()?;
                Shape::polygon(&corners).ok()
            }
            Geometry::RoundedPolygon { corners, radius } => {
                let corners: Vec<Vec2> = corners.iter().map(|&corner| image(corner)).collect::<Option<_>>()?;
                Shape::rounded_polygon(&corners, *radius).ok()
            }
            Geometry::Segment { ends: [a, b] } => Shape::segment(image(*a)?, image(*b)?).ok(),
            Geometry::Compound { parts } => {
                let part = |part: &Part| {
                    let (shape, position) = (self.shape(&part.shape)?, image(part.position)?);
                    Some(Part { shape, position, angle: self.angular_velocity(part.angle)?, ..*part })
                };
                let parts: Vec<Part> = parts.iter().map(part).collect::<Option<_>>()?;
                Shape::compound(&parts).ok()
            }
            // The other way through the points: the same side is the outer one.
            Geometry::Chain { points, closed } => {
                let points: Vec<Vec2> = points.iter().rev().map(|&point| self.local(point)).collect::<Option<_>>()?;
                Shape::chain(&points, *closed).ok()
            }
        }
    }

    /// The image of a force field; none of a custom force.
    #[must_use]
    pub fn field(&self, field: &ForceField) -> Option<ForceField> {
        Image(self).force_field(*field).ok()
    }

    /// The image of a body to be added.
    #[must_use]
    pub fn body(&self, def: &BodyDef) -> Option<BodyDef> {
        Image(self).body_def(def.clone()).ok()
    }

    /// The image of a command, for the same bodies and fields.
    #[must_use]
    pub fn command(&self, command: &Command) -> Option<Command> {
        command.clone().map(&mut Image(self)).ok()
    }
}

/// No image to the bit.
struct NoImage;

/// Replaces values by their images.
struct Image<'a>(&'a Symmetry);

impl CommandMap<Fx> for Image<'_> {
    type Error = NoImage;

    fn scalar(&mut self, value: Fx) -> Result<Fx, NoImage> {
        Ok(value)
    }

    fn factor(&mut self, value: FxFactor) -> Result<FxFactor, NoImage> {
        Ok(value)
    }

    fn shape(&mut self, shape: Shape) -> Result<Shape, NoImage> {
        self.0.shape(&shape).ok_or(NoImage)
    }

    fn vector(&mut self, vector: Vec2) -> Result<Vec2, NoImage> {
        self.0.vector(vector).ok_or(NoImage)
    }

    fn point(&mut self, point: Vec2) -> Result<Vec2, NoImage> {
        self.0.point(point).ok_or(NoImage)
    }

    fn local(&mut self, local: Vec2) -> Result<Vec2, NoImage> {
        self.0.local(local).ok_or(NoImage)
    }

    fn angle(&mut self, angle: Fx) -> Result<Fx, NoImage> {
        self.0.angle(angle).ok_or(NoImage)
    }

    fn pseudoscalar(&mut self, value: Fx) -> Result<Fx, NoImage> {
        self.0.angular_velocity(value).ok_or(NoImage)
    }

    fn along(&mut self, value: Fx) -> Result<Fx, NoImage> {
        self.local(Vec2::new(value, Fx::ZERO)).map(|image| image.x)
    }

    /// A quarter turn of both bodies takes gears out of step, unless it is by whole teeth.
    fn gear(&mut self, gear: Gear) -> Result<Gear, NoImage> {
        let [first, second] = gear.teeth.map(i32::from);
        let is_whole = i32::from(self.0.quarters) * (first + second) % 4 == 0;
        is_whole.then_some(gear).ok_or(NoImage)
    }

    fn locks(&mut self, locks: Locks) -> Result<Locks, NoImage> {
        Ok(self.0.locks(locks))
    }

    fn custom_force(&mut self, _: u64) -> Result<u64, NoImage> {
        Err(NoImage)
    }

    fn corners(&mut self, min: Vec2, max: Vec2) -> Result<(Vec2, Vec2), NoImage> {
        let (a, b) = (self.point(min)?, self.point(max)?);
        // The lower edge becomes the upper one where its axis is reversed; an empty box stays empty.
        let reversed = |row: [i8; 2]| row.contains(&-1);
        let along = |row, a: Fx, b: Fx| if reversed(row) { (b, a) } else { (a, b) };
        let [horizontal, vertical] = self.0.matrix;
        let ((left, right), (bottom, top)) = (along(horizontal, a.x, b.x), along(vertical, a.y, b.y));
        Ok((Vec2::new(left, bottom), Vec2::new(right, top)))
    }
}
