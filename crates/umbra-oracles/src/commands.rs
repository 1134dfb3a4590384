//! Random commands: one generator for tests, fuzzing and oracles.

mod values;

use umbra_physics::scalar::Factor;
use umbra_physics::{
    Attachment, BodyId, ColliderDef, ColliderId, Command, CommandSource as _, ContactSettings, Damping, End, FieldId,
    FieldKind, Filter, Fx, FxFactor, JointId, Material, MixRule, OneWay, Part, Random, Region, Shape, SpringConstants,
    TimeStep, Vec2, WorldDef, fx, limits,
};
use values::ANGLE;

/// A source of choices: a random generator, or the bytes of a fuzzer's input.
///
/// ```
/// use umbra_oracles::{Choices, Generator, Taste};
/// use umbra_physics::{Command, CommandSource};
///
/// /// The first choice each time: zero.
/// struct First;
///
/// impl Choices for First {
///     fn draw(&mut self, _bits: u32) -> u64 {
///         0
///     }
/// }
///
/// fn added(source: &mut impl CommandSource) -> Option<Command> {
///     Command::fill(0, source)
/// }
/// let command = added(&mut Generator::new(&mut First, Taste::FAIR, &[], &[]));
/// assert_eq!(command.map(|command| command.name()), Some("AddBody"));
/// ```
pub trait Choices {
    /// Returns a whole number of this many bits, 1 to 64.
    fn draw(&mut self, bits: u32) -> u64;

    /// Returns a whole number below `end`, which is at least 1. It takes 8 bits for an `end` up to 256, and 64 bits for others.
    fn choose(&mut self, end: u64) -> u64 {
        self.draw(if end <= 256 { 8 } else { 64 }) % end
    }

    /// Returns true once in so many times.
    fn one_in(&mut self, count: u64) -> bool {
        self.choose(count) == 0
    }
}

impl Choices for Random {
    fn draw(&mut self, bits: u32) -> u64 {
        self.bits() >> (64 - bits)
    }
}

/// The kind of values a [`Generator`] gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Taste {
    /// The number, of 256 values, that are at a limit, or one ulp inside it.
    pub near: u8,
    /// The number, of 256 values, handles and definitions, that a world refuses, or that are anything at all.
    pub wild: u8,
    /// True if every step can be undone: no damping, no drag, no impulse, no largest speed.
    pub reversible: bool,
    /// True if another scalar makes the same decisions: no zones, no shapes that only a fine scalar finds valid, no masses that
    /// a scalar rounds, no sleep, no damping that stops a body at once.
    pub smooth: bool,
    /// Custom forces have ids below this; 0 for none.
    pub custom_forces: u8,
    /// The number, of 256 new bodies, that have colliders. No collider touches another where steps can be undone or the taste is smooth.
    pub colliders: u8,
}

impl Taste {
    /// Everyday values, each of which a world admits.
    pub const FAIR: Self = Self { near: 0, wild: 0, reversible: false, smooth: false, custom_forces: 0, colliders: 48 };
    /// Values of all kinds, most of which a world admits.
    pub const WILD: Self = Self { near: 12, wild: 16, custom_forces: 3, ..Self::FAIR };
}

/// Kinds of commands that come more often than others, by their numbers: bodies added (0), forces and impulses (2), fields
/// added (17), kinematic bodies moved (32), colliders added (33), joints added (43).
const OFTEN: [u8; 13] = [0, 0, 0, 2, 2, 2, 17, 17, 32, 32, 33, 43, 43];

/// Makes random commands, bodies and fields of a [`Taste`] from [`Choices`].
///
/// ```
/// use umbra_oracles::{Generator, Taste};
/// use umbra_physics::{BodyId, Command, Random, World, WorldDef};
///
/// let mut random = Random::seeded(1);
/// let mut world = World::new(WorldDef::default())?;
/// let mut bodies: Vec<BodyId> = Vec::new();
/// while world.tick() < 100 {
///     let command = Generator::new(&mut random, Taste::WILD, &bodies, &[]).command();
///     let expected = world.check(&command).err();
///     assert_eq!(world.execute(&command).err(), expected);
///     bodies = world.bodies().map(|body| body.id()).collect();
///     world.step();
/// }
/// # Ok::<(), umbra_physics::Error>(())
/// ```
///
/// ```
/// use umbra_oracles::{Generator, Taste};
/// use umbra_physics::{Command, FieldKind, Fx, Random, fx, limits};
///
/// let mut random = Random::seeded(7);
/// let mut generator = Generator::new(&mut random, Taste { near: 255, ..Taste::FAIR }, &[], &[]);
/// assert!(generator.world().check().is_ok());
/// assert!(matches!(generator.of_kind(30), Some(Command::Disable(_))));
/// let (low, high) = (Fx::ZERO, limits::SIZE_MAX);
/// assert!((low..=high).contains(&generator.number([fx!(1), fx!(2)], [low, high])));
/// assert!(generator.vector(fx!(1), high).x <= high);
/// assert!(!matches!(generator.field_kind(), FieldKind::Custom { .. }));
/// ```
#[derive(Debug)]
pub struct Generator<'a, C: ?Sized> {
    choices: &'a mut C,
    taste: Taste,
    bodies: &'a [BodyId],
    fields: &'a [FieldId],
    colliders: &'a [ColliderId],
    joints: &'a [JointId],
}

impl<'a, C: Choices + ?Sized> Generator<'a, C> {
    /// A generator whose commands name these bodies and fields.
    pub fn new(choices: &'a mut C, taste: Taste, bodies: &'a [BodyId], fields: &'a [FieldId]) -> Self {
        Self { choices, taste, bodies, fields, colliders: &[], joints: &[] }
    }

    /// The generator with these colliders for commands to name.
    ///
    /// ```
    /// use umbra_oracles::{Generator, Taste};
    /// use umbra_physics::{ColliderId, Command, Random};
    ///
    /// let (mut random, known) = (Random::seeded(1), [ColliderId::from_parts(4, 2)]);
    /// let mut generator = Generator::new(&mut random, Taste::FAIR, &[], &[]).with_colliders(&known);
    /// assert_eq!(generator.of_kind(35), Some(Command::RemoveCollider(known[0])));
    /// ```
    #[must_use]
    pub fn with_colliders(self, colliders: &'a [ColliderId]) -> Self {
        Self { colliders, ..self }
    }

    /// The generator with these joints for commands to name.
    ///
    /// ```
    /// use umbra_oracles::{Generator, Taste};
    /// use umbra_physics::{Command, JointId, Random};
    ///
    /// let (mut random, known) = (Random::seeded(1), [JointId::from_parts(4, 2)]);
    /// let mut generator = Generator::new(&mut random, Taste::FAIR, &[], &[]).with_joints(&known);
    /// assert_eq!(generator.of_kind(44), Some(Command::RemoveJoint(known[0])));
    /// ```
    #[must_use]
    pub fn with_joints(self, joints: &'a [JointId]) -> Self {
        Self { joints, ..self }
    }

    /// Makes a command of any kind.
    pub fn command(&mut self) -> Command {
        let index = self.choices.choose((Command::NUMBERS.len() + OFTEN.len()) as u64) as usize;
        let number = Command::NUMBERS.iter().chain(&OFTEN).nth(index).copied();
        number.and_then(|number| self.of_kind(number)).unwrap_or(Command::ClearForces)
    }

    /// Makes a command of the kind with this number; `None` if it is none of [`Command::NUMBERS`].
    pub fn of_kind(&mut self, number: u8) -> Option<Command> {
        Command::fill(number, self)
    }

    /// Makes the definition of a world. Worlds of a wild taste may be refused.
    pub fn world(&mut self) -> WorldDef {
        let def = WorldDef {
            time_step: self.time_step(),
            gravity: if self.choices.one_in(2) { Vec2::ZERO } else { self.gravity() },
            integrator: self.integrator(),
            linear_damping: self.damping(),
            angular_damping: self.damping(),
            sleep_after: self.sleep_after(),
            contacts: if self.choices.one_in(3) { self.contact_settings() } else { ContactSettings::default() },
        };
        if self.taste.wild > 0 {
            return def;
        }
        // Not every integrator goes with every damping, nor is every ratio a rate.
        let undamped = WorldDef { linear_damping: Damping::NONE, angular_damping: Damping::NONE, ..def };
        let standard = WorldDef { time_step: TimeStep::hz(60), ..undamped };
        [def, undamped].into_iter().find(|def| def.check().is_ok()).unwrap_or(standard)
    }

    fn is_wild(&mut self) -> bool {
        self.taste.wild > 0 && self.choices.draw(8) < u64::from(self.taste.wild)
    }

    /// A number usually from `low` to `high`, of few bits half of the time, so that sums come to ties; else, as the taste
    /// says, at one of the limits `min` and `max`, beyond them, or of any size.
    ///
    /// # Panics
    /// If `min` is more than `max` and the taste has values near limits.
    pub fn number(&mut self, [low, high]: [Fx; 2], [min, max]: [Fx; 2]) -> Fx {
        let (near_share, wild) = (u64::from(self.taste.near), u64::from(self.taste.wild));
        let style = self.choices.draw(8);
        let inside = |limit: Fx, ulps: i64| {
            Fx::from_bits(limit.to_bits().saturating_add(ulps).clamp(min.to_bits(), max.to_bits()))
        };
        if style < near_share {
            return [min, max, inside(min, 1), inside(max, -1)][self.choices.choose(4) as usize];
        }
        if style < near_share + wild {
            return match self.choices.choose(8) {
                0 => Fx::from_bits(min.to_bits().saturating_sub(1)),
                1 => Fx::from_bits(max.to_bits().saturating_add(1)),
                2 => Fx::MIN,
                3 => Fx::MAX,
                4 => Fx::ZERO,
                _ => Fx::from_bits(self.choices.draw(64) as i64 >> self.choices.choose(64)),
            };
        }
        let range = high.to_bits().abs_diff(low.to_bits());
        let above = if style % 2 == 0 {
            let step = (range / 256).next_power_of_two();
            (self.choices.draw(8) * step).min(range)
        } else {
            let any = self.choices.draw(64);
            range.checked_add(1).map_or(any, |count| any % count)
        };
        Fx::from_bits(low.to_bits().saturating_add_unsigned(above))
    }

    fn signed(&mut self, usual: Fx, limit: Fx) -> Fx {
        self.number([-usual, usual], [-limit, limit])
    }

    /// A vector with components usually within ±`usual`.
    pub fn vector(&mut self, usual: Fx, limit: Fx) -> Vec2 {
        Vec2::new(self.signed(usual, limit), self.signed(usual, limit))
    }

    fn not_negative(&mut self, usual: Fx, limit: Fx) -> Fx {
        self.number([Fx::ZERO, usual], [Fx::ZERO, limit])
    }

    fn size(&mut self) -> Fx {
        self.number([fx!(0.125), fx!(2)], [limits::SIZE_MIN, limits::SIZE_MAX])
    }

    fn local(&mut self) -> Vec2 {
        self.vector(fx!(2), limits::SIZE_MAX)
    }

    /// A shape, if the values drawn make one. A dynamic body has no chain: of a wild taste alone there are some.
    fn shape(&mut self) -> Option<Shape> {
        let kinds = if self.taste.smooth { 3 } else { 6 + u64::from(self.is_wild()) };
        let shape = match self.choices.choose(kinds) {
            0 => Shape::circle(self.size()),
            1 => Shape::rectangle(self.size(), self.size()),
            2 => Shape::capsule(self.size(), self.size()),
            3 => Shape::segment(self.local(), self.local()),
            4 => {
                let count = 3 + self.choices.choose(3);
                let corners: Vec<Vec2> = (0..count).map(|_| self.vector(fx!(3), limits::SIZE_MAX)).collect();
                if self.choices.choose(4) == 3 {
                    Shape::rounded_polygon(&corners, self.size())
                } else {
                    Shape::polygon(&corners)
                }
            }
            6 => {
                let count = 2 + self.choices.choose(4);
                let points: Vec<Vec2> = (0..count).map(|_| self.local()).collect();
                Shape::chain(&points, self.choices.one_in(2))
            }
            _ => {
                let count = 1 + self.choices.choose(3);
                let parts: Vec<Part> = (0..count).filter_map(|_| self.part()).collect();
                Shape::compound(&parts)
            }
        };
        shape.ok()
    }

    /// A collider that touches nothing, for half of the bodies.
    pub(crate) fn ghost(&mut self) -> Option<ColliderDef> {
        let shape = if self.choices.one_in(2) { self.shape() } else { None };
        shape.map(ColliderDef::ghost)
    }

    fn part(&mut self) -> Option<Part> {
        let shape = match self.choices.choose(3) {
            0 => Shape::circle(self.size()),
            1 => Shape::rectangle(self.size(), self.size()),
            _ => Shape::segment(self.local(), self.local()),
        };
        let (position, angle) = (self.local(), self.signed(fx!(7), ANGLE));
        let density = self.number([fx!(0.5), fx!(4)], [Fx::DELTA, Fx::MAX]);
        Some(Part { shape: shape.ok()?, position, angle, density })
    }

    /// The colliders of a new body, if the taste gives it any: one or two.
    fn colliders(&mut self) -> Vec<ColliderDef> {
        if self.taste.colliders == 0 || self.choices.draw(8) >= u64::from(self.taste.colliders) {
            return Vec::new();
        }
        let count = 1 + self.choices.choose(2);
        (0..count).map(|_| self.collider_def()).collect()
    }

    /// A surface, half of them the usual one.
    fn material(&mut self) -> Material {
        if self.choices.one_in(2) {
            return Material::default();
        }
        Material {
            friction: self.number([Fx::ZERO, fx!(1)], [Fx::ZERO, limits::FRICTION]),
            restitution: self.number([Fx::ZERO, fx!(1)], [Fx::ZERO, Fx::ONE]),
            rolling_resistance: if self.choices.one_in(2) {
                Fx::ZERO
            } else {
                self.number([Fx::ZERO, fx!(0.1)], [Fx::ZERO, Fx::ONE])
            },
            surface_speed: if self.choices.one_in(2) { Fx::ZERO } else { self.signed(fx!(3), limits::SURFACE_SPEED) },
            friction_rule: MixRule::ALL[self.choices.choose(6) as usize],
            restitution_rule: MixRule::ALL[self.choices.choose(6) as usize],
            id: self.choices.choose(4) as u32,
        }
    }

    /// The side from which a collider holds, of one in eight.
    fn one_way(&mut self) -> Option<OneWay> {
        if !self.choices.one_in(8) {
            return None;
        }
        let direction = self.vector(fx!(4), Fx::from(1 << 12));
        Some(OneWay { direction, tolerance: self.number([Fx::ZERO, fx!(1.5)], [Fx::ZERO, Fx::FRAC_PI_2]) })
    }

    /// A filter, mostly one that meets all. No collider is in the last category, which is that of bystanders.
    fn filter(&mut self) -> Filter {
        if self.taste.reversible || self.taste.smooth {
            return Filter { group: -1, ..Filter::default() };
        }
        let is_wild = self.is_wild();
        let filter = match self.choices.choose(8) {
            0 => Filter { category: 1 << self.choices.choose(3), ..Filter::default() },
            1 => Filter { mask: self.choices.draw(3) as u32, ..Filter::default() },
            2 => Filter { group: self.choices.choose(5) as i32 - 2, ..Filter::default() },
            _ => Filter::default(),
        };
        if is_wild { Filter { category: self.choices.draw(4) as u32, ..filter } } else { filter }
    }

    fn attachment(&mut self) -> Attachment {
        let body = self.body();
        if self.choices.one_in(2) { Attachment::centre(body) } else { Attachment { body, point: self.local() } }
    }

    fn end(&mut self) -> End {
        if self.choices.one_in(2) { End::World(self.position()) } else { End::Body(self.attachment()) }
    }

    fn spring(&mut self) -> FieldKind {
        let (start, end) = (self.attachment(), self.end());
        let far = match end {
            // A spring from a body to itself would be refused.
            End::Body(at) if at.body == start.body && self.taste.wild == 0 && self.bodies.len() > 1 => {
                let index = self.bodies.iter().position(|&body| body == start.body).unwrap_or(0);
                End::Body(Attachment { body: self.bodies[(index + 1) % self.bodies.len()], ..at })
            }
            far => far,
        };
        let is_damped = !self.taste.reversible && self.choices.one_in(2);
        let spring = SpringConstants {
            rest: self.not_negative(fx!(3), limits::POSITION),
            stiffness: self.not_negative(fx!(9), Fx::MAX),
            damping: if is_damped { self.not_negative(fx!(1), Fx::MAX) } else { Fx::ZERO },
        };
        FieldKind::Spring { near: start, far, spring }
    }

    fn region(&mut self) -> Region {
        if self.choices.one_in(2) {
            let (centre, radius) =
                (self.vector(fx!(9), limits::POSITION), self.number([fx!(1), fx!(9)], [Fx::ZERO, limits::POSITION]));
            return Region::Disc { centre, radius };
        }
        Region::Box { min: self.vector(fx!(9), limits::POSITION), max: self.vector(fx!(9), limits::POSITION) }
    }

    fn buoyancy(&mut self) -> FieldKind {
        let [a, b] = [(); 2].map(|()| self.vector(fx!(9), limits::POSITION));
        // A box with its corners in any order would be refused.
        let is_sorted = self.taste.wild == 0 || !self.choices.one_in(8);
        let sorted = |a: Fx, b: Fx| if is_sorted && b < a { (b, a) } else { (a, b) };
        let ((left, right), (bottom, top)) = (sorted(a.x, b.x), sorted(a.y, b.y));
        let is_resisting = !self.taste.reversible && self.choices.one_in(2);
        let mut drag = || if is_resisting { self.not_negative(fx!(2), Fx::MAX) } else { Fx::ZERO };
        let (linear_drag, angular_drag) = (drag(), drag());
        FieldKind::Buoyancy {
            min: Vec2::new(left, bottom),
            max: Vec2::new(right, top),
            density: self.not_negative(fx!(4), Fx::MAX),
            linear_drag,
            angular_drag,
            flow: if is_resisting { self.vector(fx!(2), limits::SPEED) } else { Vec2::ZERO },
        }
    }

    /// The kind of a force field.
    pub fn field_kind(&mut self) -> FieldKind {
        let is_heavy = self.taste.near > 0 && self.choices.draw(8) < u64::from(self.taste.near);
        match self.choices.choose(10) {
            9 if self.taste.custom_forces > 0 => {
                FieldKind::Custom { id: self.choices.choose(self.taste.custom_forces.into()) }
            }
            8 if !self.taste.smooth && self.choices.one_in(2) => self.buoyancy(),
            7 | 8 if !self.taste.smooth => {
                let region = self.region();
                FieldKind::Zone { region, acceleration: self.vector(fx!(3), limits::GRAVITY) }
            }
            6 => FieldKind::Thrust { at: self.attachment(), force: self.vector(fx!(2), Fx::MAX) },
            5 if !self.taste.reversible && !self.taste.smooth && self.choices.one_in(4) => FieldKind::Friction {
                deceleration: self.number([fx!(0), fx!(3)], [fx!(0), limits::GRAVITY]),
                angular_deceleration: self.number([fx!(0), fx!(3)], [fx!(0), limits::GRAVITY]),
            },
            5 if !self.taste.reversible => FieldKind::Drag {
                linear: self.not_negative(fx!(0.25), Fx::MAX),
                quadratic: self.not_negative(fx!(0.25), Fx::MAX),
                wind: self.vector(fx!(2), limits::SPEED),
            },
            3 | 4 => {
                let centre = self.end();
                let mu = <FxFactor as Factor<Fx>>::from_scalar(self.not_negative(fx!(9), Fx::MAX));
                // As large as it may be.
                let mu = if is_heavy { "18446744073709551616".parse().unwrap_or(mu) } else { mu };
                let softening = self.number([fx!(0.5), fx!(2)], [Fx::ZERO, limits::SIZE_MAX]);
                FieldKind::Attractor { centre, mu, softening }
            }
            _ => self.spring(),
        }
    }
}
