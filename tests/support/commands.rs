//! Random commands for a world, with handles that the world has, and now and then values that it refuses.

use umbra_oracles::{Choices, Generator, Taste};
use umbra_physics::{BodyDef, BodyId, ColliderId, Command, CommandSource as _, FieldId, ForceField, JointId, World};

use super::random::SplitMix;

/// The number of kinds of commands.
#[allow(dead_code, reason = "not every test that takes this file in counts them")]
pub(crate) const KINDS: u64 = Command::NUMBERS.len() as u64;

/// Returns true if a command changes the motion of all bodies: it wakes all of them.
#[allow(dead_code, reason = "not every test that takes this file in tells them apart")]
pub(crate) fn is_global(command: &Command) -> bool {
    matches!(
        command,
        Command::SetTimeStep(_)
            | Command::SetGravity(_)
            | Command::SetIntegrator(_)
            | Command::SetDamping { .. }
            | Command::SetSleepAfter(_)
            | Command::SetContactSettings(_)
    )
}

/// Writes commands.
pub(crate) struct Author {
    pub(crate) random: SplitMix,
    /// One of so many values is refused by a world; none for 0.
    pub(crate) unfair: u64,
}

impl Choices for SplitMix {
    fn draw(&mut self, bits: u32) -> u64 {
        self.next() >> (64 - bits)
    }
}

// Each test takes what it needs.
#[allow(dead_code, reason = "each test that takes this file in uses a part of it")]
impl Author {
    pub(crate) fn one_in(&mut self, count: u64) -> bool {
        self.random.next() % count == 0
    }

    fn generate<T>(&mut self, world: Option<&World>, make: impl FnOnce(&mut Generator<'_, SplitMix>) -> T) -> T {
        let bodies: Vec<BodyId> = world.into_iter().flat_map(World::bodies).map(|body| body.id()).collect();
        let fields: Vec<FieldId> = world.into_iter().flat_map(World::fields).map(|(id, _)| id).collect();
        let wild = if self.unfair == 0 { 0 } else { 256u64.div_ceil(self.unfair) as u8 };
        let taste = Taste { near: wild / 4, wild, custom_forces: 3, ..Taste::FAIR };
        let colliders: Vec<ColliderId> = world.into_iter().flat_map(World::colliders).map(|(id, _)| id).collect();
        let joints: Vec<JointId> = world.into_iter().flat_map(World::joints).map(|joint| joint.id()).collect();
        let generator = Generator::new(&mut self.random, taste, &bodies, &fields);
        make(&mut generator.with_colliders(&colliders).with_joints(&joints))
    }

    pub(crate) fn body(&mut self) -> BodyDef {
        self.generate(None, |generator| generator.body_def())
    }

    /// A body of the world; or one that it has no more, or never had.
    pub(crate) fn some_body(&mut self, world: &World) -> BodyId {
        self.generate(Some(world), |generator| generator.body())
    }

    pub(crate) fn field(&mut self, world: &World) -> ForceField {
        self.generate(Some(world), |generator| generator.force_field())
    }

    /// A command that adds a joint.
    pub(crate) fn joint(&mut self, world: &World) -> Command {
        self.generate(Some(world), |generator| Command::AddJoint(generator.joint_def()))
    }

    /// A force or impulse on a body.
    pub(crate) fn push(&mut self, world: &World) -> Command {
        self.of_kind(2, world)
    }

    /// A command of any kind.
    pub(crate) fn any(&mut self, world: &World) -> Command {
        self.generate(Some(world), |generator| generator.command())
    }

    /// A command of the kind with this number.
    pub(crate) fn of_kind(&mut self, number: u8, world: &World) -> Command {
        self.generate(Some(world), |generator| generator.of_kind(number)).expect("it is one of them")
    }
}
