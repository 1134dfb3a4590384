//! Random runs for the promises: worlds, bodies, force fields and commands, fair for the most part, near a limit now and then,
//! and beyond it where a test asks for it.
//!
//! A plan names bodies and fields by numbers, each of which always means one that was made. So a plan can lose any part and
//! still be about the rest, which is what shrinking needs. The values come from the generator of the oracles, each from a seed
//! of its own; shrinking leaves out parts, and then makes the values of the script simple.

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::strategy::Union;
use umbra_oracles::{Generator, Script, rename};
use umbra_physics::{
    Attachment, BodyDef, BodyId, ColliderId, Command, CommandSource as _, Created, End, FieldId, FieldKind, ForceField,
    Fx, JointId, Random, Vec2, World, WorldDef,
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

/// Bodies and fields that a plan has made in a world so far.
#[derive(Clone, Debug, Default)]
pub(crate) struct Cast {
    pub(crate) bodies: Vec<BodyId>,
    pub(crate) fields: Vec<FieldId>,
    pub(crate) colliders: Vec<ColliderId>,
    pub(crate) joints: Vec<JointId>,
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

    fn collider(&self, number: ColliderId) -> ColliderId {
        let place = number.parts().0 as usize % self.colliders.len().max(1);
        self.colliders.get(place).copied().unwrap_or(ColliderId::from_parts(u32::MAX, 0))
    }

    fn joint(&self, number: JointId) -> JointId {
        let place = number.parts().0 as usize % self.joints.len().max(1);
        self.joints.get(place).copied().unwrap_or(JointId::from_parts(u32::MAX, 0))
    }

    /// Returns the field, or one whose spring leads to the next body rather than back to its own.
    fn between_two(&self, field: ForceField) -> ForceField {
        match field.kind {
            FieldKind::Spring { near, far: End::Body(far), spring } if near.body == far.body => {
                let place = self.bodies.iter().position(|&body| body == near.body).unwrap_or(0);
                let body = self.body(BodyId::from_parts(place as u32 + 1, 0));
                let far = End::Body(Attachment { body, ..far });
                ForceField { kind: FieldKind::Spring { near, far, spring }, ..field }
            }
            _ => field,
        }
    }

    /// The command with handles of the world in place of numbers.
    pub(crate) fn command(&self, command: &Command) -> Command {
        let renamed = rename(
            command,
            |number| self.body(number),
            |number| self.field(number),
            |number| self.collider(number),
            |number| self.joint(number),
        );
        match renamed {
            Command::AddField(field) => Command::AddField(self.between_two(field)),
            Command::SetField { id, field } => Command::SetField { id, field: self.between_two(field) },
            command => command,
        }
    }

    pub(crate) fn made(&mut self, world: &World, created: Created) {
        match created {
            Created::Body(body) => {
                self.bodies.push(body);
                self.colliders.extend(world.colliders_of(body).into_iter().flatten());
            }
            Created::ForceField(field) => self.fields.push(field),
            Created::Collider(collider) => self.colliders.push(collider),
            Created::Joint(joint) => self.joints.push(joint),
            _ => {}
        }
    }

    /// Carries out a command of the plan's, unless the world refuses it.
    pub(crate) fn carry_out(&mut self, world: &mut World, command: &Command) -> Command {
        let command = self.command(command);
        if let Ok(created) = world.execute(&command) {
            self.made(world, created);
        }
        command
    }
}

impl Plan {
    /// Commands at a tick, in order; the start comes first.
    pub(crate) fn due(&self, tick: u64) -> Vec<Command> {
        let mut due = Vec::new();
        if tick == 0 {
            due.extend(self.bodies.iter().cloned().map(Command::AddBody));
            due.extend(self.fields.iter().copied().map(Command::AddField));
        }
        due.extend(self.deeds.iter().filter(|(at, _)| *at == tick).map(|(_, command)| command.clone()));
        due
    }

    /// The run as commands of a world.
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

/// The kind of values that plans have.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Taste {
    /// Percentage of numbers at a limit.
    pub(crate) near: u32,
    /// Percentage of numbers beyond a limit, or arbitrary.
    pub(crate) unfair: u32,
    /// True if every step can be undone.
    pub(crate) reversible: bool,
    /// True if there are commands other than pushes after the start.
    pub(crate) changes: bool,
    /// True if nearly all bodies have colliders.
    pub(crate) colliding: bool,
    /// Largest number of bodies at the start.
    pub(crate) bodies: usize,
    /// Largest number of ticks.
    pub(crate) ticks: u64,
}

pub(crate) const FAIR: Taste =
    Taste { near: 1, unfair: 0, reversible: false, changes: true, colliding: false, bodies: 6, ticks: 40 };

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

impl Taste {
    fn values(self) -> umbra_oracles::Taste {
        let of_256 = |percent: u32| (percent * 256).div_ceil(100) as u8;
        umbra_oracles::Taste {
            near: of_256(self.near),
            wild: of_256(self.unfair),
            reversible: self.reversible,
            colliders: if self.colliding { 255 } else { umbra_oracles::Taste::FAIR.colliders },
            ..umbra_oracles::Taste::FAIR
        }
    }

    /// Values of the generator, each from a seed. A seed is not made simpler: there is no order in what comes of it.
    fn made<T: std::fmt::Debug + 'static>(
        self,
        make: impl Fn(&mut Generator<'_, Random>) -> T + 'static,
    ) -> BoxedStrategy<T> {
        let bodies: Vec<BodyId> = (0..12).map(|number| BodyId::from_parts(number, 0)).collect();
        let fields: Vec<FieldId> = (0..8).map(|number| FieldId::from_parts(number, 0)).collect();
        let colliders: Vec<ColliderId> = (0..8).map(|number| ColliderId::from_parts(number, 0)).collect();
        let joints: Vec<JointId> = (0..8).map(|number| JointId::from_parts(number, 0)).collect();
        let seeds = any::<u64>().no_shrink();
        let value = move |seed| {
            let mut random = Random::seeded(seed);
            let generator = Generator::new(&mut random, self.values(), &bodies, &fields);
            make(&mut generator.with_colliders(&colliders).with_joints(&joints))
        };
        seeds.prop_map(value).boxed()
    }

    /// From `low` to `high`; at times at one of the limits, or beyond.
    pub(crate) fn number(self, low: Fx, high: Fx, min: Fx, max: Fx) -> BoxedStrategy<Fx> {
        self.made(move |generator| generator.number([low, high], [min, max]))
    }

    /// Within ±`usual`.
    pub(crate) fn signed(self, usual: i32, limit: Fx) -> BoxedStrategy<Fx> {
        self.number(Fx::from(-usual), Fx::from(usual), -limit, limit)
    }

    pub(crate) fn vector(self, usual: i32, limit: Fx) -> BoxedStrategy<Vec2> {
        self.made(move |generator| generator.vector(Fx::from(usual), limit))
    }

    pub(crate) fn world(self) -> BoxedStrategy<WorldDef> {
        Self { unfair: 0, ..self }.made(|generator| generator.world())
    }

    pub(crate) fn body(self) -> BoxedStrategy<BodyDef> {
        self.made(|generator| generator.body_def())
    }

    pub(crate) fn field_kind(self) -> BoxedStrategy<FieldKind> {
        self.made(|generator| generator.field_kind())
    }

    pub(crate) fn field(self) -> BoxedStrategy<ForceField> {
        self.made(|generator| generator.force_field())
    }

    pub(crate) fn command(self) -> BoxedStrategy<Command> {
        let apply = |generator: &mut Generator<'_, Random>| generator.of_kind(2).expect("a force or impulse");
        union(vec![(4, self.made(apply)), (5 * u32::from(self.changes), self.made(|generator| generator.command()))])
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
