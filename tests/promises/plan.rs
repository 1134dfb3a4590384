//! What runs are made from: worlds, bodies, force fields and commands, fair for the most part, near a limit now and then, and
//! where it is asked for beyond it.
//!
//! A plan names bodies and fields by numbers that always mean one that was made, so that it can lose any part of it and
//! still be about the rest: that is what shrinking does.

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::strategy::Union;
use umbra_oracles::Script;
use umbra_physics::{
    ApplyOptions, Attachment, BodyDef, BodyId, BodyKind, Command, Created, End, FieldId, FieldKind, ForceField,
    ForceOrImpulse, Frame, Fx, FxFactor, Integrator, Locks, Mass, Part, Random, Region, Shape, SpringConstants,
    TimeStep, Vec2, World, WorldDef, fx, limits,
};

/// A run in which a handle's slot is the number of a body or field: of all that were made so far, counted round.
#[derive(Clone, Debug)]
pub(crate) struct Plan {
    pub(crate) world: WorldDef,
    pub(crate) bodies: Vec<BodyDef>,
    pub(crate) fields: Vec<ForceField>,
    pub(crate) deeds: Vec<(u64, Command)>,
    pub(crate) ticks: u64,
}

/// What a plan has made in a world so far.
#[derive(Clone, Debug, Default)]
pub(crate) struct Cast {
    pub(crate) bodies: Vec<BodyId>,
    pub(crate) fields: Vec<FieldId>,
}

impl Cast {
    fn body(&self, number: BodyId) -> BodyId {
        let place = number.parts().0 as usize % self.bodies.len().max(1);
        // Nobody has this slot.
        self.bodies.get(place).copied().unwrap_or(BodyId::from_parts(u32::MAX, 0))
    }

    fn field(&self, number: FieldId) -> FieldId {
        let place = number.parts().0 as usize % self.fields.len().max(1);
        self.fields.get(place).copied().unwrap_or(FieldId::from_parts(u32::MAX, 0))
    }

    fn named(&self, field: &ForceField) -> ForceField {
        let attachment = |at: Attachment| Attachment { body: self.body(at.body), ..at };
        let end = |end| match end {
            End::World(point) => End::World(point),
            End::Body(at) => End::Body(attachment(at)),
        };
        let kind = match field.kind {
            FieldKind::Attractor { centre, mu, softening } => {
                FieldKind::Attractor { centre: end(centre), mu, softening }
            }
            FieldKind::Spring { near, far, spring } => {
                let near = attachment(near);
                let far = match end(far) {
                    // To the next one rather than to itself.
                    End::Body(at) if at.body == near.body => {
                        let place = self.bodies.iter().position(|&body| body == near.body).unwrap_or(0);
                        let next = BodyId::from_parts(place as u32 + 1, 0);
                        End::Body(Attachment { body: self.body(next), ..at })
                    }
                    far => far,
                };
                FieldKind::Spring { near, far, spring }
            }
            FieldKind::Thrust { at, force } => FieldKind::Thrust { at: attachment(at), force },
            kind => kind,
        };
        ForceField { kind, ..*field }
    }

    /// The command with handles of the world in place of numbers.
    pub(crate) fn command(&self, command: &Command) -> Command {
        let mut command = command.clone();
        match &mut command {
            Command::Apply { body, .. }
            | Command::SetPosition { body, .. }
            | Command::SetAngle { body, .. }
            | Command::SetVelocity { body, .. }
            | Command::SetAngularVelocity { body, .. }
            | Command::SetMass { body, .. }
            | Command::SetShape { body, .. }
            | Command::SetKind { body, .. }
            | Command::SetGravityScale { body, .. }
            | Command::SetBodyDamping { body, .. }
            | Command::SetGroups { body, .. }
            | Command::SetKey { body, .. }
            | Command::SetUserData { body, .. }
            | Command::SetLocks { body, .. }
            | Command::SetMaxSpeeds { body, .. }
            | Command::MoveTo { body, .. }
            | Command::RemoveBody(body)
            | Command::Wake(body)
            | Command::Disable(body)
            | Command::Enable(body)
            | Command::Release(body) => *body = self.body(*body),
            Command::AddField(field) => *field = self.named(field),
            Command::SetField { id, field } => (*id, *field) = (self.field(*id), self.named(field)),
            Command::RemoveField(id) => *id = self.field(*id),
            _ => {}
        }
        command
    }

    pub(crate) fn made(&mut self, made: Created) {
        match made {
            Created::Body(body) => self.bodies.push(body),
            Created::ForceField(field) => self.fields.push(field),
            Created::Nothing => {}
        }
    }

    /// Carries out a command of the plan's, unless the world refuses it.
    pub(crate) fn carry_out(&mut self, world: &mut World, command: &Command) -> Command {
        let command = self.command(command);
        if let Ok(made) = world.execute(&command) {
            self.made(made);
        }
        command
    }
}

impl Plan {
    /// What is done at a tick, in order; the start comes first.
    pub(crate) fn due(&self, tick: u64) -> Vec<Command> {
        let mut due = Vec::new();
        if tick == 0 {
            due.extend(self.bodies.iter().cloned().map(Command::AddBody));
            due.extend(self.fields.iter().copied().map(Command::AddField));
        }
        due.extend(self.deeds.iter().filter(|(at, _)| *at == tick).map(|(_, command)| command.clone()));
        due
    }

    /// The same run as commands of a world.
    pub(crate) fn script(&self) -> Script {
        let mut world = World::new(self.world).expect("plans have fair worlds");
        let (mut cast, mut commands) = (Cast::default(), Vec::new());
        for tick in 0..self.ticks {
            for command in self.due(tick) {
                commands.push((tick, cast.carry_out(&mut world, &command)));
            }
            world.step();
        }
        Script { world: self.world, commands, ticks: self.ticks }
    }
}

/// What plans are like.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Taste {
    /// How many numbers of a hundred are at a limit.
    pub(crate) near: u32,
    /// How many are beyond one, or anything at all.
    pub(crate) unfair: u32,
    /// Whether every step can be undone.
    pub(crate) reversible: bool,
    /// Whether anything is done after the start but pushes.
    pub(crate) changes: bool,
    /// How many bodies there are at the start, at most.
    pub(crate) bodies: usize,
    /// How many ticks, at most.
    pub(crate) ticks: u64,
}

pub(crate) const FAIR: Taste = Taste { near: 1, unfair: 0, reversible: false, changes: true, bodies: 6, ticks: 40 };

fn union<T: std::fmt::Debug + 'static>(choices: Vec<(u32, BoxedStrategy<T>)>) -> BoxedStrategy<T> {
    Union::new_weighted(choices.into_iter().filter(|(weight, _)| *weight > 0).collect()).boxed()
}

/// From bits `low` to `high`: eighths for the most part, which are short to read and often tie.
pub(crate) fn between(low: Fx, high: Fx) -> BoxedStrategy<Fx> {
    const EIGHTH: i64 = 1 << 29;
    let (low, high) = (low.to_bits(), high.to_bits());
    let eighths = (low.div_euclid(EIGHTH) + i64::from(low % EIGHTH != 0)..=high.div_euclid(EIGHTH))
        .prop_map(|n| Fx::from_bits(n * EIGHTH));
    union(vec![(6, eighths.boxed()), (3, (low..=high).prop_map(Fx::from_bits).boxed())])
}

fn any_number() -> BoxedStrategy<Fx> {
    (any::<i64>(), 0u32..64).prop_map(|(bits, shift)| Fx::from_bits(bits >> shift)).boxed()
}

fn one_of(numbers: Vec<Fx>) -> BoxedStrategy<Fx> {
    prop::sample::select(numbers).boxed()
}

impl Taste {
    /// From `low` to `high`; at times at one of the limits, or beyond.
    pub(crate) fn number(self, low: Fx, high: Fx, least: Fx, most: Fx) -> BoxedStrategy<Fx> {
        let inside = |limit: Fx| Fx::from_bits(limit.to_bits() - limit.to_bits().signum());
        let outside = |limit: Fx| Fx::from_bits(limit.to_bits().saturating_add(limit.to_bits().signum().max(1)));
        let below = Fx::from_bits(least.to_bits().saturating_sub(1));
        let near = one_of(vec![least, most, inside(least).max(least), inside(most)]);
        let beyond =
            union(vec![(1, one_of(vec![below, outside(most), Fx::MIN, Fx::MAX, Fx::ZERO])), (1, any_number())]);
        union(vec![(100 - self.near - self.unfair, between(low, high)), (self.near, near), (self.unfair, beyond)])
    }

    /// Within ±usual.
    pub(crate) fn signed(self, usual: i32, limit: Fx) -> BoxedStrategy<Fx> {
        self.number(Fx::from(-usual), Fx::from(usual), -limit, limit)
    }

    pub(crate) fn vector(self, usual: i32, limit: Fx) -> BoxedStrategy<Vec2> {
        (self.signed(usual, limit), self.signed(usual, limit)).prop_map(|(x, y)| Vec2::new(x, y)).boxed()
    }

    fn share(self) -> BoxedStrategy<Fx> {
        if self.reversible {
            return Just(Fx::ONE).boxed();
        }
        let some = self.number(fx!(0.5), fx!(1), Fx::ZERO, Fx::ONE);
        union(vec![(3, Just(Fx::ONE).boxed()), (1, some)])
    }

    fn integrator(self) -> BoxedStrategy<Integrator> {
        let all = Integrator::ALL.into_iter().filter(|integrator| !self.reversible || integrator.inverse().is_some());
        prop::sample::select(all.collect::<Vec<_>>()).boxed()
    }

    pub(crate) fn world(self) -> BoxedStrategy<WorldDef> {
        let rates = [(1, 60), (1, 64), (1, 100), (1001, 60_000), (1, 7), (1, 1), (1, 10_000)];
        let time_step = union(vec![
            (4, prop::sample::select(rates.map(|(num, den)| TimeStep::ratio(num, den)).to_vec()).boxed()),
            (1, (1u32..=500, 500u32..=60_000).prop_map(|(num, den)| TimeStep::ratio(num, den)).boxed()),
        ]);
        let fair = Self { unfair: 0, ..self };
        let sleep = prop::sample::select(vec![Some(30), None, Some(1), Some(4)]);
        let parts = (time_step, fair.vector(12, limits::GRAVITY), self.integrator(), fair.share(), fair.share(), sleep);
        let world = move |(time_step, gravity, integrator, linear_damping, angular_damping, sleep_after)| {
            let sleep_after = if self.reversible { None } else { sleep_after };
            let def = WorldDef { time_step, gravity, integrator, linear_damping, angular_damping, sleep_after };
            let undamped = WorldDef { linear_damping: Fx::ONE, angular_damping: Fx::ONE, ..def };
            let standard = WorldDef { time_step: TimeStep::hz(60), ..undamped };
            // Not every ratio is a rate, nor goes every integrator with every damping.
            [def, undamped, standard].into_iter().find(|def| def.check().is_ok()).expect("the last is fair")
        };
        parts.prop_map(world).boxed()
    }

    fn shape(self) -> BoxedStrategy<Option<Shape>> {
        let size = || self.number(fx!(0.125), fx!(3), limits::SIZE_MIN, limits::SIZE_MAX);
        let point = || self.vector(3, limits::SIZE_MAX);
        let part = (size(), point(), self.signed(7, Fx::MAX), self.number(fx!(0.5), fx!(4), fx!(0.5), fx!(99)));
        let compound = vec(part, 1..3).prop_map(|parts| {
            let part = |(radius, position, angle, density)| {
                Some(Part { shape: Shape::circle(radius).ok()?, position, angle, density })
            };
            Shape::compound(&parts.into_iter().map(part).collect::<Option<Vec<_>>>()?).ok()
        });
        union(vec![
            (6, Just(None).boxed()),
            (1, size().prop_map(|radius| Shape::circle(radius).ok()).boxed()),
            (1, (size(), size()).prop_map(|(width, height)| Shape::rectangle(width, height).ok()).boxed()),
            (1, (size(), size()).prop_map(|(length, radius)| Shape::capsule(length, radius).ok()).boxed()),
            (1, (point(), point()).prop_map(|(a, b)| Shape::segment(a, b).ok()).boxed()),
            (1, (point(), point(), point()).prop_map(|(a, b, c)| Shape::polygon(&[a, b, c]).ok()).boxed()),
            (1, compound.boxed()),
        ])
    }

    fn mass(self) -> BoxedStrategy<Mass> {
        let kilograms = || self.number(fx!(0.125), fx!(4), limits::MASS_MIN, limits::MASS_MAX);
        let inertia = self.number(fx!(0.125), fx!(4), Fx::DELTA, Fx::MAX);
        union(vec![
            (3, Just(Mass::Kilograms(Fx::ONE)).boxed()),
            (2, kilograms().prop_map(Mass::Kilograms).boxed()),
            (2, (kilograms(), inertia).prop_map(|(mass, inertia)| Mass::Explicit { mass, inertia }).boxed()),
            (1, self.number(fx!(0.125), fx!(4), Fx::DELTA, Fx::MAX).prop_map(Mass::Density).boxed()),
        ])
    }

    fn kind(self) -> BoxedStrategy<BodyKind> {
        union(vec![
            (8, Just(BodyKind::Dynamic).boxed()),
            (1, Just(BodyKind::Kinematic).boxed()),
            (1, Just(BodyKind::Static).boxed()),
        ])
    }

    fn groups(self) -> BoxedStrategy<u32> {
        union(vec![(2, Just(1).boxed()), (1, any::<u32>().boxed())])
    }

    fn locks(self) -> BoxedStrategy<Locks> {
        let any = (any::<bool>(), any::<bool>(), any::<bool>());
        let any = any.prop_map(|(x, y, rotation)| Locks { x, y, rotation });
        union(vec![(6, Just(Locks::NONE).boxed()), (1, any.boxed())])
    }

    /// A largest speed, none for the most part: what was capped is not undone.
    fn most(self) -> BoxedStrategy<Option<Fx>> {
        let some = self.number(Fx::ZERO, fx!(4), Fx::ZERO, limits::SPEED).prop_map(Some);
        union(vec![(6, Just(None).boxed()), (u32::from(!self.reversible), some.boxed())])
    }

    pub(crate) fn body(self) -> BoxedStrategy<BodyDef> {
        let own = || proptest::option::weighted(0.25, self.share());
        let motion = (
            self.vector(20, limits::POSITION),
            self.signed(9, Fx::MAX),
            self.vector(3, limits::SPEED),
            self.signed(3, limits::ANGULAR_SPEED),
        );
        let rest = (self.mass(), self.signed(2, limits::GRAVITY_SCALE), own(), own(), self.groups(), 0u64..16);
        let held = ((self.most(), self.most()), self.locks());
        let body = move |(kind, motion, shape, rest, sleeper, held): (_, _, Option<Shape>, _, _, _)| {
            let (position, angle, velocity, spin): (_, _, Vec2, _) = motion;
            let ((max_speed, max_angular_speed), locks): (_, Locks) = held;
            let free = |v: Fx, locked: bool| if locked && self.unfair == 0 { Fx::ZERO } else { v };
            let velocity = Vec2::new(free(velocity.x, locks.x), free(velocity.y, locks.y));
            let spin = free(spin, locks.rotation);
            let (mass, scale, linear_damping, angular_damping, groups, key): (Mass, _, _, _, _, _) = rest;
            let still = (kind == BodyKind::Static && self.unfair == 0) || sleeper;
            // A density needs a shape.
            let mass = match mass {
                Mass::Density(density) if shape.is_none() && self.unfair == 0 => Mass::Kilograms(density),
                mass => mass,
            };
            BodyDef {
                kind,
                position,
                angle,
                velocity: if still { Vec2::ZERO } else { velocity },
                angular_velocity: if still { Fx::ZERO } else { spin },
                shape,
                mass,
                gravity_scale: if sleeper { Fx::ZERO } else { scale },
                linear_damping,
                angular_damping,
                max_speed,
                max_angular_speed,
                locks,
                groups,
                key,
                user_data: key,
            }
        };
        (self.kind(), motion, self.shape(), rest, proptest::bool::weighted(0.2), held).prop_map(body).boxed()
    }

    fn attachment(self) -> BoxedStrategy<Attachment> {
        let point = union(vec![(1, Just(Vec2::ZERO).boxed()), (1, self.vector(1, limits::SIZE_MAX))]);
        (0u32..12, point).prop_map(|(number, point)| Attachment { body: BodyId::from_parts(number, 0), point }).boxed()
    }

    fn end(self) -> BoxedStrategy<End> {
        let place = self.vector(20, limits::POSITION).prop_map(End::World);
        union(vec![(1, place.boxed()), (1, self.attachment().prop_map(End::Body).boxed())])
    }

    pub(crate) fn field_kind(self) -> BoxedStrategy<FieldKind> {
        let number = |high| self.number(Fx::ZERO, high, Fx::ZERO, Fx::MAX);
        let mu = union(vec![
            (100 - self.near, number(fx!(9)).prop_map(FxFactor::from_scalar).boxed()),
            // As large as it may be.
            (self.near, Just("18446744073709551616".parse().expect("2^64")).boxed()),
        ]);
        let softening = self.number(fx!(0.25), fx!(2), Fx::ZERO, limits::SIZE_MAX);
        let damper = if self.reversible { Just(Fx::ZERO).boxed() } else { number(fx!(1)) };
        let damper = union(vec![(2, Just(Fx::ZERO).boxed()), (1, damper)]);
        let spring = (self.number(Fx::ZERO, fx!(3), Fx::ZERO, limits::POSITION), number(fx!(9)), damper);
        let spring = spring.prop_map(|(rest, stiffness, damping)| SpringConstants { rest, stiffness, damping });
        let disc = (self.vector(9, limits::POSITION), self.number(fx!(1), fx!(9), Fx::ZERO, limits::POSITION))
            .prop_map(|(centre, radius)| Region::Disc { centre, radius });
        let area = (self.vector(9, limits::POSITION), self.vector(9, limits::POSITION))
            .prop_map(|(min, max)| Region::Box { min, max });
        let region = union(vec![(1, disc.boxed()), (1, area.boxed())]);
        let drag = (number(fx!(0.5)), number(fx!(0.5)), self.vector(2, limits::SPEED));
        union(vec![
            (
                3,
                (self.attachment(), self.end(), spring)
                    .prop_map(|(near, far, spring)| FieldKind::Spring { near, far, spring })
                    .boxed(),
            ),
            (
                2,
                (self.end(), mu, softening)
                    .prop_map(|(centre, mu, softening)| FieldKind::Attractor { centre, mu, softening })
                    .boxed(),
            ),
            (
                1,
                (self.attachment(), self.vector(2, Fx::MAX))
                    .prop_map(|(at, force)| FieldKind::Thrust { at, force })
                    .boxed(),
            ),
            (
                1,
                (region, self.vector(3, limits::GRAVITY))
                    .prop_map(|(region, acceleration)| FieldKind::Zone { region, acceleration })
                    .boxed(),
            ),
            (
                u32::from(!self.reversible),
                drag.prop_map(|(linear, quadratic, wind)| FieldKind::Drag { linear, quadratic, wind }).boxed(),
            ),
        ])
    }

    pub(crate) fn field(self) -> BoxedStrategy<ForceField> {
        let groups = union(vec![(2, Just(u32::MAX).boxed()), (1, self.groups())]);
        (self.field_kind(), groups).prop_map(|(kind, groups)| ForceField { kind, groups }).boxed()
    }

    fn push(self) -> BoxedStrategy<Command> {
        let point = || proptest::option::of(self.vector(20, Fx::MAX));
        let action = union(vec![
            (
                3,
                (self.vector(9, Fx::MAX), point())
                    .prop_map(|(force, point)| ForceOrImpulse::Force { force, point })
                    .boxed(),
            ),
            (1, self.signed(5, Fx::MAX).prop_map(ForceOrImpulse::Torque).boxed()),
            (
                u32::from(!self.reversible),
                (self.vector(1, Fx::MAX), point())
                    .prop_map(|(impulse, point)| ForceOrImpulse::Impulse { impulse, point })
                    .boxed(),
            ),
            (u32::from(!self.reversible), self.signed(1, Fx::MAX).prop_map(ForceOrImpulse::AngularImpulse).boxed()),
        ]);
        let frame = prop::sample::select(vec![Frame::World, Frame::World, Frame::Body]);
        (number(), action, frame, proptest::bool::weighted(0.75))
            .prop_map(|(body, action, frame, wake)| Command::Apply {
                body,
                action,
                manner: ApplyOptions { frame, wake },
            })
            .boxed()
    }

    /// Anything that can be done to a body.
    fn change(self) -> BoxedStrategy<Command> {
        let own = || proptest::option::of(self.share());
        union(vec![
            (1, self.body().prop_map(Command::AddBody).boxed()),
            (1, number().prop_map(Command::RemoveBody).boxed()),
            (1, number().prop_map(Command::Wake).boxed()),
            (1, number().prop_map(Command::Disable).boxed()),
            (2, number().prop_map(Command::Enable).boxed()),
            (1, (number(), self.locks()).prop_map(|(body, locks)| Command::SetLocks { body, locks }).boxed()),
            (
                1,
                (number(), self.most(), self.most())
                    .prop_map(|(body, linear, angular)| Command::SetMaxSpeeds { body, linear, angular })
                    .boxed(),
            ),
            (
                3,
                (number(), self.vector(20, limits::POSITION), self.signed(9, Fx::MAX))
                    .prop_map(|(body, position, angle)| Command::MoveTo { body, position, angle })
                    .boxed(),
            ),
            (1, number().prop_map(Command::Release).boxed()),
            (
                1,
                (number(), self.vector(20, limits::POSITION))
                    .prop_map(|(body, position)| Command::SetPosition { body, position })
                    .boxed(),
            ),
            (
                1,
                (number(), self.signed(9, Fx::MAX)).prop_map(|(body, angle)| Command::SetAngle { body, angle }).boxed(),
            ),
            (
                1,
                (number(), self.vector(3, limits::SPEED))
                    .prop_map(|(body, velocity)| Command::SetVelocity { body, velocity })
                    .boxed(),
            ),
            (
                1,
                (number(), self.signed(3, limits::ANGULAR_SPEED))
                    .prop_map(|(body, velocity)| Command::SetAngularVelocity { body, velocity })
                    .boxed(),
            ),
            (1, (number(), self.mass()).prop_map(|(body, mass)| Command::SetMass { body, mass }).boxed()),
            (1, (number(), self.shape()).prop_map(|(body, shape)| Command::SetShape { body, shape }).boxed()),
            (1, (number(), self.kind()).prop_map(|(body, kind)| Command::SetKind { body, kind }).boxed()),
            (
                1,
                (number(), self.signed(2, limits::GRAVITY_SCALE))
                    .prop_map(|(body, scale)| Command::SetGravityScale { body, scale })
                    .boxed(),
            ),
            (
                1,
                (number(), own(), own())
                    .prop_map(|(body, linear, angular)| Command::SetBodyDamping { body, linear, angular })
                    .boxed(),
            ),
            (1, (number(), self.groups()).prop_map(|(body, groups)| Command::SetGroups { body, groups }).boxed()),
            (1, (number(), 0u64..16).prop_map(|(body, key)| Command::SetKey { body, key }).boxed()),
            (
                1,
                (number(), any::<u64>()).prop_map(|(body, user_data)| Command::SetUserData { body, user_data }).boxed(),
            ),
        ])
    }

    /// Anything that can be done to a world but to its bodies.
    fn setting(self) -> BoxedStrategy<Command> {
        let field = || (0u32..8).prop_map(|number| FieldId::from_parts(number, 0));
        union(vec![
            (2, self.field().prop_map(Command::AddField).boxed()),
            (1, (field(), self.field()).prop_map(|(id, field)| Command::SetField { id, field }).boxed()),
            (1, field().prop_map(Command::RemoveField).boxed()),
            (1, self.world().prop_map(|def| Command::SetTimeStep(def.time_step)).boxed()),
            (1, self.vector(12, limits::GRAVITY).prop_map(Command::SetGravity).boxed()),
            (1, self.integrator().prop_map(Command::SetIntegrator).boxed()),
            (
                1,
                (self.share(), self.share())
                    .prop_map(|(linear, angular)| Command::SetDamping { linear, angular })
                    .boxed(),
            ),
            (1, self.world().prop_map(|def| Command::SetSleepAfter(def.sleep_after)).boxed()),
            (1, any::<u64>().prop_map(|seed| Command::SetRandom(Random::seeded(seed))).boxed()),
            (1, vec(any::<u8>(), 0..4).prop_map(Command::SetBlob).boxed()),
            (1, Just(Command::ClearForces).boxed()),
        ])
    }

    pub(crate) fn command(self) -> BoxedStrategy<Command> {
        let changes = u32::from(self.changes);
        union(vec![(4, self.push()), (3 * changes, self.change()), (2 * changes, self.setting())])
    }

    pub(crate) fn plan(self) -> BoxedStrategy<Plan> {
        // Some before the first tick, when slots are freed and taken again.
        let when = prop_oneof![1 => Just(0), 5 => 0..self.ticks];
        let deeds = vec((when, self.command()), 0..14);
        (self.world(), vec(self.body(), 1..=self.bodies), vec(self.field(), 0..7), deeds, 1..=self.ticks)
            .prop_map(|(world, bodies, fields, deeds, ticks)| Plan { world, bodies, fields, deeds, ticks })
            .boxed()
    }
}

/// The number of a body.
fn number() -> BoxedStrategy<BodyId> {
    (0u32..12).prop_map(|number| BodyId::from_parts(number, 0)).boxed()
}
