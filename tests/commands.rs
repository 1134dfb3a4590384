//! A command can be checked without carrying it out, and a refused one changes nothing.

#[path = "support/commands.rs"]
mod commands;
#[path = "support/random.rs"]
mod random;

use std::collections::BTreeSet;
use std::sync::Arc;

use commands::{Author, KINDS};
use random::SplitMix;
use umbra_physics::{
    BodyDef, BodyId, BodyState, Command, Dependence, Error, ForceLaw, Fx, Integrator, LawFault, Made, Push, TimeStep,
    Vec2, World, WorldDef, fx, limits, vec2,
};

/// The name of a variant.
fn name(value: &impl std::fmt::Debug) -> String {
    let text = format!("{value:?}");
    text.split(|c: char| !c.is_alphanumeric()).next().unwrap_or_default().to_owned()
}

/// A law that is registered, and pushes nothing.
struct Idle;

impl ForceLaw for Idle {
    fn id(&self) -> u64 {
        1
    }

    fn version(&self) -> u32 {
        1
    }

    fn depends_on(&self) -> Dependence {
        Dependence::Position
    }

    fn push(&self, _: &BodyState) -> Result<Push, LawFault> {
        Ok(Push::default())
    }
}

fn world(author: &mut Author, integrator: Integrator) -> World {
    let def = WorldDef { gravity: vec2(0, fx!(-1)), integrator, sleep_after: Some(3), ..WorldDef::default() };
    let mut world = World::new(def).expect("a fair definition");
    world.register_law(Arc::new(Idle)).expect("the first of its id");
    if author.one_in(8) {
        // Steps of so many lengths that the elapsed time has hardly room for another.
        for rate in [9_973, 9_967, 9_949, 9_941, 9_931] {
            let _ = world.set_time_step(TimeStep::hz(rate));
            world.step();
        }
    }
    while world.bodies().count() < 6 {
        // Not every body and field it writes is fair.
        let _ = world.add_body(author.body());
        let _ = world.add_field(author.field(&world));
    }
    world
}

/// A body on its way out of the envelope is quarantined in the next step.
fn expel(world: &mut World, body: BodyId) {
    let at_the_edge = Vec2::new(limits::POSITION, Fx::ZERO);
    if world.set_position(body, at_the_edge).is_ok() && world.set_velocity(body, vec2(9, 0)).is_ok() {
        world.step();
    }
}

#[test]
fn checking_a_command_says_what_carrying_it_out_would_and_what_is_refused_changes_nothing() {
    let mut author = Author { random: SplitMix(1), unfair: 12 };
    let (mut accepted, mut refused, mut errors) = (BTreeSet::new(), BTreeSet::new(), BTreeSet::new());
    for run in 0..300 {
        let mut world = world(&mut author, Integrator::ALL[run % Integrator::ALL.len()]);
        for _ in 0..60 {
            if author.one_in(40) {
                let body = author.some_body(&world);
                expel(&mut world, body);
            }
            let command = author.any(&world);
            let before = world.state_hash();
            let said = world.check(&command);
            assert_eq!(world.state_hash(), before, "{command:?}");
            let mut copy = world.clone();
            let done = copy.execute(&command);
            assert_eq!(said, done.map(drop), "{command:?}");
            match done {
                Err(error) => {
                    assert_eq!(copy.state_hash(), before, "{command:?} was refused: {error}");
                    // Nor does it change what is to come.
                    let mut untouched = world.clone();
                    untouched.step();
                    copy.step();
                    assert_eq!(copy.state_hash(), untouched.state_hash(), "{command:?} was refused: {error}");
                    refused.insert(name(&command));
                    errors.insert(name(&error));
                }
                Ok(made) => {
                    assert_eq!(matches!(made, Made::Body(_)), matches!(command, Command::AddBody(_)));
                    assert_eq!(matches!(made, Made::Field(_)), matches!(command, Command::AddField(_)));
                    accepted.insert(name(&command));
                    world = copy;
                }
            }
            if author.one_in(3) {
                world.step();
            }
        }
    }
    assert_eq!(accepted.len() as u64, KINDS, "{accepted:?}");
    assert_eq!(refused, accepted);
    let all = "DampingHasNoInverse ElapsedTime ForceLaw NoShape NoSuchBody NoSuchField NotDynamic NotMovable \
               NotQuarantined OutOfRange Quarantined SameBody TimeStep";
    assert_eq!(errors, all.split_whitespace().map(str::to_owned).collect());
}

#[test]
fn a_command_is_checked_against_the_world_as_it_is_now() {
    let mut world: World = World::new(WorldDef::default()).expect("a fair definition");
    let gone = BodyId::from_parts(0, 0);
    let wake = Command::Wake(gone);
    assert_eq!(world.check(&wake), Err(Error::NoSuchBody { body: gone }));
    assert_eq!(world.add_body(BodyDef::dynamic()), Ok(gone));
    assert_eq!(world.check(&wake), Ok(()));
    let step = Command::SetTimeStep(TimeStep::hz(0));
    assert_eq!((world.check(&step), world.execute(&step)), (Err(Error::TimeStep), Err(Error::TimeStep)));
}
