//! Images of worlds, and of what is done to them, that have to move in images.

use alloc::sync::Arc;
use alloc::vec::Vec;

use crate::body::{BodyDef, Locks, mass_properties};
use crate::force::{Attachment, End, FieldKind, ForceField, Region};
use crate::math::Vec2;
use crate::scalar::fx::{Fx, fx};
use crate::scalar::{Accumulator as _, Angle as _, FxAccumulator, FxSum, Number as _, Turn, Wide as _};
use crate::shape::{Geometry, Part, Shape};
use crate::world::{Command, ForceOrImpulse, Frame, World};

/// A symmetry of the engine: p' = A·p + t, where A mirrors, turns by a quarter or does nothing, and t is an even number of
/// ulps. A world and its image, given images of the same inputs, stay each other's image to the bit.
///
/// The axes of the bodies go along: by as many quarters as the symmetry turns, and where it mirrors, points and shapes of a
/// body are mirrored in its axes. What has no exact image has none here: a number whose opposite does not fit, a point more
/// than 2^29 m out under a symmetry that shifts, an angle in radians that no other one is a quarter turn from.
///
/// ```
/// use umbra_physics::oracle::Symmetry;
/// use umbra_physics::{BodyDef, Command, ForceField, FieldKind, Shape, World, WorldDef, fx, vec2};
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
/// let mut world: World = World::new(WorldDef { gravity: vec2(1, -9), ..WorldDef::default() })?;
/// let body = world.add_body(BodyDef {
///     position: vec2(2, 3),
///     shape: Some(rod),
///     angular_velocity: fx!(1),
///     ..BodyDef::dynamic()
/// })?;
/// let wind = ForceField::from(FieldKind::Drag { linear: fx!(0.1), quadratic: fx!(0), wind: vec2(4, 0) });
/// let mut image = mirror.world(&world).unwrap();
/// world.add_field(wind)?;
/// image.add_field(mirror.field(&wind).unwrap())?;
/// let push = Command::SetVelocity { body, velocity: vec2(7, 0) };
/// world.execute(&push)?;
/// image.execute(&mirror.command(&push).unwrap())?;
/// (0..100).for_each(|_| _ = (world.step(), image.step()));
/// assert_eq!(mirror.world(&world).map(|there| there.state_hash()), Some(image.state_hash()));
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

/// Beyond this a shift may lead out of what the world admits.
const FAR: Fx = fx!(536870912);
/// The largest shift of a coordinate, by far enough below what is left to [`limits::POSITION`](crate::limits::POSITION).
const SHIFT: i64 = 1 << (32 + 26);

impl Symmetry {
    /// Left and right change places, about the line x = 0.
    pub const MIRROR: Self = Self { name: "mirror", matrix: [[-1, 0], [0, 1]], shift: Vec2::ZERO, quarters: 0 };
    /// Up and down change places, about the line y = 0.
    pub const FLIP: Self = Self { name: "flip", matrix: [[1, 0], [0, -1]], shift: Vec2::ZERO, quarters: 0 };
    /// The axes change places, about the line x = y.
    pub const DIAGONAL: Self = Self { name: "diagonal", matrix: [[0, 1], [1, 0]], shift: Vec2::ZERO, quarters: 1 };
    /// A quarter turn to the left about the origin.
    pub const TURN: Self = Self { name: "turn", matrix: [[0, -1], [1, 0]], shift: Vec2::ZERO, quarters: 1 };

    /// The same about another point: `None` unless that shifts by an even number of ulps in each coordinate, and by at most
    /// 2^26 m.
    #[must_use]
    pub fn about(self, centre: Vec2) -> Option<Self> {
        let image = self.signed(centre, Fx::checked_neg)?;
        let by = Vec2::new(centre.x.checked_sub(image.x)?, centre.y.checked_sub(image.y)?);
        Self { shift: Vec2::ZERO, ..self }.shifted(by)
    }

    /// All is moved: `None` unless by an even number of ulps in each coordinate, and by at most 2^26 m.
    #[must_use]
    pub fn shift(by: Vec2) -> Option<Self> {
        Self { name: "shift", matrix: [[1, 0], [0, 1]], shift: Vec2::ZERO, quarters: 0 }.shifted(by)
    }

    fn shifted(self, by: Vec2) -> Option<Self> {
        let is_fair = |c: Fx| c.to_bits() % 2 == 0 && c.to_bits().unsigned_abs() <= SHIFT.unsigned_abs();
        (is_fair(by.x) && is_fair(by.y)).then_some(Self { shift: by, ..self })
    }

    /// Its name.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        self.name
    }

    /// Whether left and right hands change places.
    #[must_use]
    pub const fn mirrors(&self) -> bool {
        let [[a, b], [c, d]] = self.matrix;
        a * d - b * c < 0
    }

    /// Whether it does no more than shift.
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
        let image = self.signed(v, Fx::checked_neg)?;
        match self.quarters {
            0 => Some(image),
            _ => Some(Vec2::new(image.y, image.x.checked_neg()?)),
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
    /// use umbra_physics::{Locks, oracle::Symmetry};
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
        let given = |point: Vec2| self.local(point + shape.shift());
        match shape.geometry() {
            Geometry::Circle { .. } | Geometry::Rectangle { .. } | Geometry::Capsule { .. } => Some(shape.clone()),
            Geometry::Polygon { corners } => {
                let corners: Vec<Vec2> = corners.iter().map(|&corner| given(corner)).collect::<Option<_>>()?;
                Shape::polygon(&corners).ok()
            }
            Geometry::Segment { ends: [a, b] } => Shape::segment(given(*a)?, given(*b)?).ok(),
            Geometry::Compound { parts } => {
                let part = |part: &Part| {
                    let (shape, position) = (self.shape(&part.shape)?, given(part.position)?);
                    Some(Part { shape, position, angle: self.angular_velocity(part.angle)?, ..*part })
                };
                let parts: Vec<Part> = parts.iter().map(part).collect::<Option<_>>()?;
                Shape::compound(&parts).ok()
            }
        }
    }

    fn attachment(&self, at: &Attachment) -> Option<Attachment> {
        Some(Attachment { point: self.local(at.point)?, ..*at })
    }

    fn end(&self, end: &End) -> Option<End> {
        Some(match end {
            End::World(point) => End::World(self.point(*point)?),
            End::Body(at) => End::Body(self.attachment(at)?),
        })
    }

    fn region(&self, region: &Region) -> Option<Region> {
        Some(match *region {
            Region::Disc { centre, radius } => Region::Disc { centre: self.point(centre)?, radius },
            Region::Box { min, max } => {
                let (a, b) = (self.point(min)?, self.point(max)?);
                // What was the lower edge is the upper one where its axis is turned round; an empty box stays empty.
                let turned = |row: [i8; 2]| row.contains(&-1);
                let along = |row, a: Fx, b: Fx| if turned(row) { (b, a) } else { (a, b) };
                let ((x, right), (y, top)) = (along(self.matrix[0], a.x, b.x), along(self.matrix[1], a.y, b.y));
                Region::Box { min: Vec2::new(x, y), max: Vec2::new(right, top) }
            }
        })
    }

    /// The image of a force field; none of a law of force of the user's own.
    #[must_use]
    pub fn field(&self, field: &ForceField) -> Option<ForceField> {
        let kind = match &field.kind {
            FieldKind::Attractor { centre, mu, softening } => {
                FieldKind::Attractor { centre: self.end(centre)?, mu: *mu, softening: *softening }
            }
            FieldKind::Spring { near, far, spring } => {
                FieldKind::Spring { near: self.attachment(near)?, far: self.end(far)?, spring: *spring }
            }
            FieldKind::Drag { linear, quadratic, wind } => {
                FieldKind::Drag { linear: *linear, quadratic: *quadratic, wind: self.vector(*wind)? }
            }
            FieldKind::Thrust { at, force } => {
                FieldKind::Thrust { at: self.attachment(at)?, force: self.local(*force)? }
            }
            FieldKind::Zone { region, acceleration } => {
                FieldKind::Zone { region: self.region(region)?, acceleration: self.vector(*acceleration)? }
            }
            FieldKind::Custom { .. } => return None,
        };
        Some(ForceField { kind, groups: field.groups })
    }

    /// The image of a body to be added.
    #[must_use]
    pub fn body(&self, def: &BodyDef) -> Option<BodyDef> {
        let shape = match &def.shape {
            Some(shape) => Some(self.shape(shape)?),
            None => None,
        };
        Some(BodyDef {
            position: self.point(def.position)?,
            angle: self.angle(def.angle)?,
            velocity: self.vector(def.velocity)?,
            angular_velocity: self.angular_velocity(def.angular_velocity)?,
            shape,
            locks: self.locks(def.locks),
            ..def.clone()
        })
    }

    fn action(&self, action: &ForceOrImpulse, frame: Frame) -> Option<ForceOrImpulse> {
        let vector = |v| if frame == Frame::Body { self.local(v) } else { self.vector(v) };
        let at = |point: Option<Vec2>| match point {
            Some(point) if frame == Frame::Body => self.local(point).map(Some),
            Some(point) => self.point(point).map(Some),
            None => Some(None),
        };
        Some(match *action {
            ForceOrImpulse::Force { force, point } => {
                ForceOrImpulse::Force { force: vector(force)?, point: at(point)? }
            }
            ForceOrImpulse::Impulse { impulse, point } => {
                ForceOrImpulse::Impulse { impulse: vector(impulse)?, point: at(point)? }
            }
            ForceOrImpulse::Torque(torque) => ForceOrImpulse::Torque(self.angular_velocity(torque)?),
            ForceOrImpulse::AngularImpulse(impulse) => ForceOrImpulse::AngularImpulse(self.angular_velocity(impulse)?),
        })
    }

    /// The image of a command, for the same bodies and fields.
    #[must_use]
    pub fn command(&self, command: &Command) -> Option<Command> {
        Some(match command {
            Command::AddBody(def) => Command::AddBody(self.body(def)?),
            Command::Apply { body, action, manner } => {
                Command::Apply { body: *body, action: self.action(action, manner.frame)?, manner: *manner }
            }
            Command::SetPosition { body, position } => {
                Command::SetPosition { body: *body, position: self.point(*position)? }
            }
            Command::SetAngle { body, angle } => Command::SetAngle { body: *body, angle: self.angle(*angle)? },
            Command::MoveTo { body, position, angle } => {
                Command::MoveTo { body: *body, position: self.point(*position)?, angle: self.angle(*angle)? }
            }
            Command::SetVelocity { body, velocity } => {
                Command::SetVelocity { body: *body, velocity: self.vector(*velocity)? }
            }
            Command::SetAngularVelocity { body, velocity } => {
                Command::SetAngularVelocity { body: *body, velocity: self.angular_velocity(*velocity)? }
            }
            Command::SetShape { body, shape } => {
                let shape = match shape {
                    Some(shape) => Some(self.shape(shape)?),
                    None => None,
                };
                Command::SetShape { body: *body, shape }
            }
            Command::SetLocks { body, locks } => Command::SetLocks { body: *body, locks: self.locks(*locks) },
            Command::AddField(field) => Command::AddField(self.field(field)?),
            Command::SetField { id, field } => Command::SetField { id: *id, field: self.field(field)? },
            Command::SetGravity(gravity) => Command::SetGravity(self.vector(*gravity)?),
            Command::RemoveBody(_)
            | Command::ClearForces
            | Command::SetMass { .. }
            | Command::SetKind { .. }
            | Command::SetGravityScale { .. }
            | Command::SetBodyDamping { .. }
            | Command::SetMaxSpeeds { .. }
            | Command::SetGroups { .. }
            | Command::SetKey { .. }
            | Command::SetUserData { .. }
            | Command::Wake(_)
            | Command::Release(_)
            | Command::Disable(_)
            | Command::Enable(_)
            | Command::RemoveField(_)
            | Command::SetTimeStep(_)
            | Command::SetIntegrator(_)
            | Command::SetDamping { .. }
            | Command::SetSleepAfter(_)
            | Command::SetRandom(_)
            | Command::SetBlob(_) => command.clone(),
        })
    }

    /// The image of a world, with the same handles. What the game keeps in it, its generator, its blob and the bodies' data,
    /// is as it was. None where a law of force of the user's own acts, or a body is more than 2^29 m out and would be shifted.
    #[must_use]
    pub fn world(&self, world: &World) -> Option<World> {
        let mut image = world.clone();
        image.def.gravity = self.vector(world.def.gravity)?;
        Arc::make_mut(&mut image.factor_table).change_all();
        for i in 0..image.bodies.len() {
            self.take(&mut image, i)?;
        }
        let fields = Arc::make_mut(&mut image.fields);
        for (id, field) in world.fields.iter() {
            fields.replace(id, self.field(field)?).ok()?;
        }
        image.applied.clear();
        for row in world.applied.rows() {
            let force = self.signed(row.force, |sum| Some(opposite(sum)))?;
            let torque = if self.mirrors() { opposite(row.torque) } else { row.torque };
            image.applied.adopt(row.body, force, torque);
        }
        for (_, target) in image.targets.rows_mut() {
            if let Some(goal) = &mut target.goal {
                (goal.position, goal.angle) = (self.point(goal.position)?, self.turn(goal.angle));
            }
        }
        image.bodies.changes_mut().note_all();
        Some(image)
    }

    /// Makes of the body at an index in the columns its image.
    fn take(&self, world: &mut World, i: usize) -> Option<()> {
        let negative = |a: FxAccumulator| Some(a.negated());
        let motion = &mut world.bodies.columns.motion;
        let position = motion.position.get(i);
        let is_near = |c: FxAccumulator| self.shift == Vec2::ZERO || c.is_within(FAR);
        if !(is_near(position.x) && is_near(position.y)) {
            return None;
        }
        let position = self.signed(position, negative)?;
        let moved = |c: FxAccumulator, by: Fx| c.plus(FxAccumulator::from_scalar(by));
        motion.position.set(i, Vec2::new(moved(position.x, self.shift.x), moved(position.y, self.shift.y)));
        motion.velocity.set(i, self.signed(motion.velocity.get(i), negative)?);
        motion.angle[i] = self.turn(motion.angle[i]);
        if self.mirrors() {
            motion.angular_velocity[i] = motion.angular_velocity[i].negated();
        }
        if let Some(last) = motion.last_acceleration.get_mut(i) {
            last.linear = self.signed(last.linear, |wide| Some(wide.negated()))?;
            if self.mirrors() {
                last.angular = last.angular.negated();
            }
        }
        let locks = world.bodies.info(i).locks;
        if self.locks(locks) != locks {
            world.bodies.set_locks(i, Arc::make_mut(&mut world.factor_table), self.locks(locks));
        }
        let info = world.bodies.info(i);
        if let Some(shape) = info.shape.as_deref().filter(|_| self.mirrors()) {
            let (kind, mass, shape) = (info.kind, info.mass, self.shape(shape)?);
            let properties = mass_properties(kind, mass, Some(&shape)).ok()?;
            world.bodies.set_shape(i, Some(shape), properties);
        }
        Some(())
    }
}

/// The sum on the other side of zero.
fn opposite(sum: FxSum) -> FxSum {
    let [carries, high, low] = sum.to_words();
    // Carries count 2^128, and what is beside them has a sign; its least value is its own opposite, a carry off.
    let rest = u128::from(high) << 64 | u128::from(low);
    let carries = carries.wrapping_neg().wrapping_add(u64::from(rest == 1 << 127));
    let rest = rest.wrapping_neg();
    FxSum::from_words([carries, (rest >> 64) as u64, rest as u64])
}
