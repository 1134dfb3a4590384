//! Random commands: one generator for tests, fuzzing and oracles.
//!
//! This file uses the public interface alone, so that tests without the oracles include it too.

extern crate alloc;

use alloc::vec;
use alloc::vec::Vec;

use umbra_physics::scalar::Factor;
use umbra_physics::{
    ApplyOptions, Attachment, BodyDef, BodyId, BodyKind, Command, CommandSource, End, FieldId, FieldKind, ForceField,
    ForceOrImpulse, Frame, Fx, FxFactor, Integrator, Locks, Mass, Part, Random, Region, Shape, SpringConstants,
    TimeStep, Vec2, WorldDef, fx, limits,
};

/// A source of choices: a random generator, or the bytes of a fuzzer's input.
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
    /// How many of 256 numbers are at a limit, or one ulp inside it.
    pub near: u8,
    /// How many of 256 numbers, handles and definitions are beyond what a world admits, or anything at all.
    pub wild: u8,
    /// Whether every step can be undone: no damping, no drag, no impulse, no largest speed.
    pub reversible: bool,
    /// Whether another scalar makes the same decisions: no zones, no shapes that only a fine scalar finds valid, no sleep, no
    /// damping that stops a body at once.
    pub smooth: bool,
    /// Custom forces have ids below this; 0 for none.
    pub custom_forces: u8,
}

impl Taste {
    /// Everyday values, each of which a world admits.
    pub const FAIR: Self = Self { near: 0, wild: 0, reversible: false, smooth: false, custom_forces: 0 };
    /// Values of all kinds, most of which a world admits.
    pub const WILD: Self = Self { near: 12, wild: 16, custom_forces: 3, ..Self::FAIR };
}

/// Kinds of commands that come more often than others, by their numbers: bodies added (0), forces and impulses (2), fields
/// added (17), kinematic bodies moved (32).
const OFTEN: [u8; 10] = [0, 0, 0, 2, 2, 2, 17, 17, 32, 32];
/// Angles far beyond whole turns.
const ANGLE: Fx = Fx::MAX;

/// Makes random commands, bodies and fields of a [`Taste`] from [`Choices`].
///
/// ```
/// use umbra_physics::oracle::{Generator, Taste};
/// use umbra_physics::{BodyId, Command, Random, World, WorldDef};
///
/// let mut random = Random::seeded(1);
/// let mut world: World = World::new(WorldDef::default())?;
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
#[derive(Debug)]
pub struct Generator<'a, C: ?Sized> {
    choices: &'a mut C,
    taste: Taste,
    bodies: &'a [BodyId],
    fields: &'a [FieldId],
}

impl<'a, C: Choices + ?Sized> Generator<'a, C> {
    /// A generator whose commands name these bodies and fields.
    pub fn new(choices: &'a mut C, taste: Taste, bodies: &'a [BodyId], fields: &'a [FieldId]) -> Self {
        Self { choices, taste, bodies, fields }
    }

    /// Makes a command of any kind.
    pub fn command(&mut self) -> Command {
        let kind = self.choices.choose(u64::from(Command::KINDS) + OFTEN.len() as u64) as u8;
        let often = kind.checked_sub(Command::KINDS).map(|index| OFTEN[usize::from(index)]);
        self.of_kind(often.unwrap_or(kind)).unwrap_or(Command::ClearForces)
    }

    /// Makes a command of the kind with this number; `None` from [`Command::KINDS`] on.
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
        };
        if self.taste.wild > 0 {
            return def;
        }
        // Not every integrator goes with every damping, nor is every ratio a rate.
        let undamped = WorldDef { linear_damping: Fx::ONE, angular_damping: Fx::ONE, ..def };
        let standard = WorldDef { time_step: TimeStep::hz(60), ..undamped };
        [def, undamped].into_iter().find(|def| def.check().is_ok()).unwrap_or(standard)
    }

    fn is_wild(&mut self) -> bool {
        self.taste.wild > 0 && self.choices.draw(8) < u64::from(self.taste.wild)
    }

    /// A number usually from `low` to `high`, of few bits half of the time, so that sums come to ties; else, as the taste
    /// says, at one of the limits `least` and `most`, beyond them, or of any size.
    pub fn number(&mut self, [low, high]: [Fx; 2], [least, most]: [Fx; 2]) -> Fx {
        let (near, wild) = (u64::from(self.taste.near), u64::from(self.taste.wild));
        let style = self.choices.draw(8);
        let inside = |limit: Fx, by: i64| {
            Fx::from_bits(limit.to_bits().saturating_add(by).clamp(least.to_bits(), most.to_bits()))
        };
        if style < near {
            return [least, most, inside(least, 1), inside(most, -1)][self.choices.choose(4) as usize];
        }
        if style < near + wild {
            return match self.choices.choose(8) {
                0 => Fx::from_bits(least.to_bits().saturating_sub(1)),
                1 => Fx::from_bits(most.to_bits().saturating_add(1)),
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

    /// A shape, if the values drawn make one.
    fn shape(&mut self) -> Option<Shape> {
        let kinds = if self.taste.smooth { 3 } else { 6 };
        let shape = match self.choices.choose(kinds) {
            0 => Shape::circle(self.size()),
            1 => Shape::rectangle(self.size(), self.size()),
            2 => Shape::capsule(self.size(), self.size()),
            3 => Shape::segment(self.local(), self.local()),
            4 => {
                let count = 3 + self.choices.choose(3);
                let corners: Vec<Vec2> = (0..count).map(|_| self.vector(fx!(3), limits::SIZE_MAX)).collect();
                Shape::polygon(&corners)
            }
            _ => {
                let count = 1 + self.choices.choose(3);
                let parts: Vec<Part> = (0..count).filter_map(|_| self.part()).collect();
                Shape::compound(&parts)
            }
        };
        shape.ok()
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

    fn attachment(&mut self) -> Attachment {
        let body = self.body();
        if self.choices.one_in(2) { Attachment::centre(body) } else { Attachment { body, point: self.local() } }
    }

    fn end(&mut self) -> End {
        if self.choices.one_in(2) { End::World(self.position()) } else { End::Body(self.attachment()) }
    }

    fn spring(&mut self) -> FieldKind {
        let (near, far) = (self.attachment(), self.end());
        let far = match far {
            // A spring from a body to itself would be refused.
            End::Body(at) if at.body == near.body && self.taste.wild == 0 && self.bodies.len() > 1 => {
                let index = self.bodies.iter().position(|&body| body == near.body).unwrap_or(0);
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
        FieldKind::Spring { near, far, spring }
    }

    fn region(&mut self) -> Region {
        if self.choices.one_in(2) {
            let (centre, radius) =
                (self.vector(fx!(9), limits::POSITION), self.number([fx!(1), fx!(9)], [Fx::ZERO, limits::POSITION]));
            return Region::Disc { centre, radius };
        }
        Region::Box { min: self.vector(fx!(9), limits::POSITION), max: self.vector(fx!(9), limits::POSITION) }
    }

    /// The kind of a force field.
    pub fn field_kind(&mut self) -> FieldKind {
        let is_heavy = self.taste.near > 0 && self.choices.draw(8) < u64::from(self.taste.near);
        match self.choices.choose(10) {
            9 if self.taste.custom_forces > 0 => {
                FieldKind::Custom { id: self.choices.choose(self.taste.custom_forces.into()) }
            }
            7 | 8 if !self.taste.smooth => {
                let region = self.region();
                FieldKind::Zone { region, acceleration: self.vector(fx!(3), limits::GRAVITY) }
            }
            6 => FieldKind::Thrust { at: self.attachment(), force: self.vector(fx!(2), Fx::MAX) },
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

impl<C: Choices + ?Sized> CommandSource for Generator<'_, C> {
    /// One of the bodies; of a wild taste, now and then one that never was.
    fn body(&mut self) -> BodyId {
        if self.bodies.is_empty() || self.is_wild() {
            return BodyId::from_parts(self.choices.choose(8) as u32, self.choices.choose(3) as u32);
        }
        self.bodies[self.choices.choose(self.bodies.len() as u64) as usize]
    }

    fn field(&mut self) -> FieldId {
        if self.fields.is_empty() || self.is_wild() {
            return FieldId::from_parts(self.choices.choose(8) as u32, self.choices.choose(3) as u32);
        }
        self.fields[self.choices.choose(self.fields.len() as u64) as usize]
    }

    /// The definition of a body. A third of them rest, to fall asleep.
    fn body_def(&mut self) -> BodyDef {
        let (kind, locks) = (self.kind(), self.locks());
        let is_wild = self.is_wild();
        let is_resting = self.choices.one_in(3);
        let is_still = is_resting || kind == BodyKind::Static && !is_wild;
        let free = |value: Fx, is_locked: bool| if is_locked && !is_wild { Fx::ZERO } else { value };
        let (velocity, angular_velocity) =
            if is_still { (Vec2::ZERO, Fx::ZERO) } else { (self.velocity(), self.angular_velocity()) };
        let shape = self.optional_shape();
        let mass = match self.mass() {
            Mass::Density(density) if shape.is_none() && !is_wild => Mass::Kilograms(density.max(limits::MASS_MIN)),
            mass => mass,
        };
        let key = self.choices.choose(16);
        BodyDef {
            kind,
            position: self.position(),
            angle: self.angle(),
            velocity: Vec2::new(free(velocity.x, locks.x), free(velocity.y, locks.y)),
            angular_velocity: free(angular_velocity, locks.rotation),
            shape,
            mass,
            gravity_scale: if is_resting { Fx::ZERO } else { self.gravity_scale() },
            linear_damping: self.body_damping(),
            angular_damping: self.body_damping(),
            max_speed: self.max_speed(),
            max_angular_speed: self.max_angular_speed(),
            locks,
            groups: self.groups(),
            key,
            user_data: key,
        }
    }

    fn force_field(&mut self) -> ForceField {
        let kind = self.field_kind();
        ForceField { kind, groups: if self.choices.one_in(2) { self.groups() } else { u32::MAX } }
    }

    fn force_or_impulse(&mut self) -> ForceOrImpulse {
        let point = if self.choices.one_in(2) { Some(self.vector(fx!(20), Fx::MAX)) } else { None };
        match self.choices.choose(if self.taste.reversible { 3 } else { 5 }) {
            0 | 1 => ForceOrImpulse::Force { force: self.vector(fx!(20), Fx::MAX), point },
            2 => ForceOrImpulse::Torque(self.signed(fx!(5), Fx::MAX)),
            3 => ForceOrImpulse::Impulse { impulse: self.vector(fx!(1), Fx::MAX), point },
            _ => ForceOrImpulse::AngularImpulse(self.signed(fx!(1), Fx::MAX)),
        }
    }

    fn apply_options(&mut self) -> ApplyOptions {
        let frame = if self.choices.one_in(3) { Frame::Body } else { Frame::World };
        ApplyOptions { frame, wake: !self.choices.one_in(4) }
    }

    fn position(&mut self) -> Vec2 {
        self.vector(fx!(20), limits::POSITION)
    }

    fn angle(&mut self) -> Fx {
        self.signed(fx!(9), ANGLE)
    }

    fn velocity(&mut self) -> Vec2 {
        self.vector(fx!(3), limits::SPEED)
    }

    fn angular_velocity(&mut self) -> Fx {
        self.signed(fx!(3), limits::ANGULAR_SPEED)
    }

    fn mass(&mut self) -> Mass {
        let usual = [fx!(0.25), fx!(4)];
        let mut kilograms = || self.number(usual, [limits::MASS_MIN, limits::MASS_MAX]);
        let mass = kilograms();
        match self.choices.choose(8) {
            0..3 => Mass::Kilograms(Fx::ONE),
            3..5 => Mass::Kilograms(mass),
            5..7 => Mass::Explicit { mass, inertia: self.number(usual, [Fx::DELTA, Fx::MAX]) },
            _ if self.taste.smooth => Mass::Kilograms(mass),
            _ => Mass::Density(self.number(usual, [Fx::DELTA, Fx::MAX])),
        }
    }

    fn optional_shape(&mut self) -> Option<Shape> {
        if self.choices.one_in(2) { self.shape() } else { None }
    }

    fn kind(&mut self) -> BodyKind {
        match self.choices.choose(10) {
            8 => BodyKind::Kinematic,
            9 => BodyKind::Static,
            _ => BodyKind::Dynamic,
        }
    }

    fn gravity_scale(&mut self) -> Fx {
        match self.choices.one_in(2) {
            true => self.number([fx!(-1), fx!(2)], [-limits::GRAVITY_SCALE, limits::GRAVITY_SCALE]),
            false => Fx::ONE,
        }
    }

    fn body_damping(&mut self) -> Option<Fx> {
        if self.choices.one_in(3) { Some(self.damping()) } else { None }
    }

    fn max_speed(&mut self) -> Option<Fx> {
        let is_capped = !self.taste.reversible && self.choices.one_in(7);
        if is_capped { Some(self.not_negative(fx!(4), limits::SPEED)) } else { None }
    }

    fn max_angular_speed(&mut self) -> Option<Fx> {
        let is_capped = !self.taste.reversible && self.choices.one_in(7);
        if is_capped { Some(self.not_negative(fx!(4), limits::ANGULAR_SPEED)) } else { None }
    }

    fn groups(&mut self) -> u32 {
        if self.choices.one_in(3) { self.choices.draw(32) as u32 } else { 1 }
    }

    fn key(&mut self) -> u64 {
        if self.choices.one_in(2) { self.choices.choose(16) } else { self.choices.draw(64) }
    }

    fn user_data(&mut self) -> u64 {
        self.choices.draw(64)
    }

    /// Mostly none.
    fn locks(&mut self) -> Locks {
        let bits = if self.choices.one_in(6) { self.choices.draw(3) } else { 0 };
        Locks { x: bits & 1 != 0, y: bits & 2 != 0, rotation: bits & 4 != 0 }
    }

    fn time_step(&mut self) -> TimeStep {
        const RATES: [(u32, u32); 10] = [
            (1, 60),
            (1, 60),
            (1, 64),
            (1, 144),
            (1001, 60_000),
            (1, 100),
            (1, 50),
            // Steps of a second and of a tenth of a millisecond.
            (1, 7),
            (1, 1),
            (1, 10_000),
        ];
        if self.is_wild() {
            return TimeStep::ratio(self.choices.draw(32) as u32, self.choices.draw(32) as u32);
        }
        if !self.taste.smooth && self.choices.one_in(6) {
            let (num, den) = (1 + self.choices.choose(500), 500 + self.choices.choose(59_501));
            let time_step = TimeStep::ratio(num as u32, den as u32);
            let def: WorldDef = WorldDef { time_step, ..WorldDef::default() };
            return if def.check().is_ok() { time_step } else { TimeStep::hz(60) };
        }
        let rates = if self.taste.smooth { &RATES[..7] } else { &RATES };
        let (num, den) = rates[self.choices.choose(rates.len() as u64) as usize];
        TimeStep::ratio(num, den)
    }

    fn gravity(&mut self) -> Vec2 {
        self.vector(fx!(12), limits::GRAVITY)
    }

    fn integrator(&mut self) -> Integrator {
        let all = Integrator::ALL.into_iter().filter(|own| !self.taste.reversible || own.inverse().is_some());
        let all: Vec<Integrator> = all.collect();
        all[self.choices.choose(all.len() as u64) as usize]
    }

    /// The share of a velocity that is left after a second.
    fn damping(&mut self) -> Fx {
        if self.taste.reversible {
            return Fx::ONE;
        }
        match self.choices.choose(8) {
            0..5 => Fx::ONE,
            5 if !self.taste.smooth && self.choices.one_in(2) => Fx::ZERO,
            _ => self.number([fx!(0.5), fx!(1)], [Fx::ZERO, Fx::ONE]),
        }
    }

    fn sleep_after(&mut self) -> Option<u32> {
        if self.taste.reversible || self.taste.smooth {
            return None;
        }
        let ticks = [None, Some(1), Some(3), Some(4), Some(30)];
        if self.is_wild() { Some(self.choices.draw(32) as u32 & 1) } else { ticks[self.choices.choose(5) as usize] }
    }

    fn random(&mut self) -> Random {
        Random::seeded(self.choices.draw(64))
    }

    fn blob(&mut self) -> Vec<u8> {
        vec![self.choices.draw(8) as u8; self.choices.choose(9) as usize]
    }
}
