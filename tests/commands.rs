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
    BodyDef, BodyId, BodyState, Command, Created, CustomForce, CustomForceError, Dependence, Error, ForceTorque, Fx,
    Input, InputResult, Inputs, Integrator, Quantity, TimeStep, Vec2, World, WorldDef, fx, limits, vec2,
};

/// The name of a variant.
fn name(value: &impl std::fmt::Debug) -> String {
    let text = format!("{value:?}");
    text.split(|c: char| !c.is_alphanumeric()).next().unwrap_or_default().to_owned()
}

/// A law that is registered, and pushes nothing.
struct Idle;

impl CustomForce for Idle {
    fn id(&self) -> u64 {
        1
    }

    fn version(&self) -> u32 {
        1
    }

    fn depends_on(&self) -> Dependence {
        Dependence::Position
    }

    fn push(&self, _: &BodyState) -> Result<ForceTorque, CustomForceError> {
        Ok(ForceTorque::default())
    }
}

fn world(author: &mut Author, integrator: Integrator) -> World {
    let def = WorldDef { gravity: vec2(0, fx!(-1)), integrator, sleep_after: Some(3), ..WorldDef::default() };
    let mut world = World::new(def).expect("a fair definition");
    world.register_custom_force(Arc::new(Idle)).expect("the first of its id");
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
    let mut author = Author { random: SplitMix::seeded(1), unfair: 12 };
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
                Ok(created) => {
                    assert_eq!(matches!(created, Created::Body(_)), matches!(command, Command::AddBody(_)));
                    assert_eq!(matches!(created, Created::ForceField(_)), matches!(command, Command::AddField(_)));
                    assert_eq!(matches!(created, Created::Collider(_)), matches!(command, Command::AddCollider { .. }));
                    assert_eq!(matches!(created, Created::Joint(_)), matches!(command, Command::AddJoint(_)));
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
    // Any generator is fair, so are small blobs, and forces can always be taken back.
    accepted.retain(|name| !["SetRandom", "SetBlob", "ClearForces"].contains(&&name[..]));
    assert_eq!(refused, accepted);
    let all = "DynamicChain NoSuchCollider DampingHasNoInverse Disabled ElapsedTime CustomForce Locked NoMotor NoSuchBody NoSuchField NoSuchJoint \
               NotDisabled NotDynamic NotKinematic NotMovable NotQuarantined NothingToMove OutOfRange Quarantined SameBody SleepIsOff TimeStep";
    assert_eq!(errors, all.split_whitespace().map(str::to_owned).collect());
}

#[test]
fn a_command_is_checked_against_the_world_as_it_is_now() {
    let mut world = World::new(WorldDef::default()).expect("a fair definition");
    let gone = BodyId::from_parts(0, 0);
    let wake = Command::Wake(gone);
    assert_eq!(world.check(&wake), Err(Error::NoSuchBody { body: gone }));
    assert_eq!(world.add_body(BodyDef::dynamic()), Ok(gone));
    assert_eq!(world.check(&wake), Ok(()));
    let blob = |more| Command::SetBlob(vec![0; limits::BLOB + more]);
    assert_eq!(world.check(&blob(0)), Ok(()));
    let error = Err(Error::OutOfRange { quantity: Quantity::Blob });
    assert_eq!((world.check(&blob(1)), world.execute(&blob(1)).map(drop)), (error, error));
    let step = Command::SetTimeStep(TimeStep::hz(0));
    assert_eq!((world.check(&step), world.execute(&step)), (Err(Error::TimeStep), Err(Error::TimeStep)));
}

/// Commands of some players in a tick.
fn inputs_of_a_tick(author: &mut Author, world: &World) -> Vec<Input> {
    let sequences = [(0, 0), (0, 1), (0, 7), (1, 0), (2, 0), (2, u32::MAX), (u32::MAX, 3)];
    let input = |(player, sequence)| Input { player, sequence, command: author.any(world) };
    sequences.map(input).into()
}

/// Each order of so many things once (Heap 1963).
fn permutations(count: usize, visit: &mut impl FnMut(&[usize])) {
    fn permute(order: &mut [usize], count: usize, visit: &mut impl FnMut(&[usize])) {
        if count <= 1 {
            return visit(order);
        }
        for i in 0..count {
            permute(order, count - 1, visit);
            order.swap(if count % 2 == 0 { i } else { 0 }, count - 1);
        }
    }
    permute(&mut (0..count).collect::<Vec<_>>(), count, visit);
}

#[test]
fn the_order_in_which_inputs_arrive_never_matters() {
    let mut author = Author { random: SplitMix::seeded(2), unfair: 40 };
    let (mut made_a_difference, mut refused) = (0, 0);
    let runs = crate::seeds::times(8);
    for run in 0..runs {
        let world = world(&mut author, Integrator::ALL[run % Integrator::ALL.len()]);
        let written = inputs_of_a_tick(&mut author, &world);
        let mut expected = None;
        let mut unordered = BTreeSet::new();
        let mut count = 0;
        permutations(written.len(), &mut |order| {
            let mut inputs = Inputs::new();
            for &i in order {
                inputs.insert(written[i].clone()).expect("each has a place of its own");
            }
            assert!(inputs.iter().eq(&written), "they are not in their order");
            let mut end = world.clone();
            let outcomes = end.carry_out(&inputs);
            refused += outcomes.iter().filter(|outcome| outcome.result.is_err()).count();
            end.step();
            let end = (end.state_hash(), outcomes);
            assert_eq!(*expected.get_or_insert_with(|| end.clone()), end);
            let mut naive = world.clone();
            for &i in order {
                let _ = naive.execute(&written[i].command);
            }
            naive.step();
            unordered.insert(naive.state_hash());
            count += 1;
        });
        assert_eq!(count, 5040);
        made_a_difference += usize::from(unordered.len() > 1);
    }
    // Otherwise this shows nothing.
    assert!(
        made_a_difference > 0 && refused > 0,
        "{made_a_difference} of {runs} depend on the order, {refused} refused"
    );
}

#[test]
fn an_input_that_is_there_already_is_refused_by_name_and_the_first_one_stays() {
    let input =
        |player, sequence, ticks| Input::<Fx> { player, sequence, command: Command::SetSleepAfter(Some(ticks)) };
    let mut inputs = Inputs::new();
    for (player, sequence) in [(1, 1), (0, 2), (1, 0)] {
        assert_eq!(inputs.insert(input(player, sequence, 1)), Ok(()));
    }
    let before = inputs.clone();
    // The first of them came in order, the others late.
    for (player, sequence) in [(1, 1), (0, 2), (1, 0)] {
        assert_eq!(inputs.insert(input(player, sequence, 2)), Err(Error::DuplicateInput { player, sequence }));
        assert_eq!(inputs, before);
    }
    let places: Vec<_> = inputs.iter().map(|input| (input.player, input.sequence)).collect();
    assert_eq!(places, [(0, 2), (1, 0), (1, 1)]);
    inputs.clear();
    assert!(inputs.is_empty() && !before.is_empty() && before.len() == 3);
}

#[test]
fn a_refused_command_is_named_and_stops_no_other() {
    let mut world = World::new(WorldDef::default()).expect("a fair definition");
    let gone = BodyId::from_parts(5, 0);
    let mut inputs = Inputs::new();
    for (player, command) in
        [(2, Command::AddBody(BodyDef::dynamic())), (1, Command::Wake(gone)), (0, Command::SetGravity(vec2(0, 1)))]
    {
        inputs.insert(Input { player, sequence: 9, command }).expect("each has a place of its own");
    }
    let outcome = |player, result| InputResult { player, sequence: 9, result };
    let body = BodyId::from_parts(0, 0);
    let expected = [Ok(Created::Nothing), Err(Error::NoSuchBody { body: gone }), Ok(Created::Body(body))];
    let expected: Vec<InputResult> = (0..).zip(expected).map(|(player, result)| outcome(player, result)).collect();
    assert_eq!(world.carry_out(&inputs), expected);
    assert_eq!(world.def().gravity, vec2(0, 1));
}

#[test]
fn a_players_inputs_are_replaced_and_nobody_elses() {
    let command = |ticks: u32| Command::<Fx>::SetSleepAfter(Some(ticks));
    let listed = |inputs: &Inputs| -> Vec<(u32, u32, Command)> {
        inputs.iter().map(|input| (input.player, input.sequence, input.command.clone())).collect()
    };
    // A player between two others, one before all, one after all, one alone; with fewer, as many and more commands.
    for player in 0..4 {
        for before in 0..4 {
            for after in 0..4 {
                let mut inputs = Inputs::new();
                let mut expected = Vec::new();
                for sender in 0..4 {
                    for sequence in 0..if sender == player { before } else { 2 } {
                        let input = Input { player: sender, sequence, command: command(1 + sequence) };
                        inputs.insert(input).expect("each has a place of its own");
                    }
                    for sequence in 0..if sender == player { after } else { 2 } {
                        expected.push((sender, sequence, command(1 + sequence)));
                    }
                }
                assert_eq!(inputs.replace(player, (0..after).map(|i| command(1 + i))), before != after);
                assert_eq!(listed(&inputs), expected);
                assert!(!inputs.replace(player, (0..after).map(|i| command(1 + i))));
                let changes = inputs.replace(player, (0..after).map(|i| command(2 + i)));
                assert_eq!(changes, after > 0);
            }
        }
    }
    // Also where the sequence numbers alone differ.
    let mut inputs = Inputs::new();
    inputs.insert(Input { player: 0, sequence: 5, command: command(1) }).expect("the first");
    assert!(inputs.replace(0, [command(1)]));
    assert_eq!(listed(&inputs), [(0, 0, command(1))]);
}
