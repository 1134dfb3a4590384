//! Worlds at their bounds: each that is accepted goes on, and can be saved, recorded and read again after any step.

use alloc::vec;
use alloc::vec::Vec;

use super::encodings::replaced;
use super::{custom_forces, everything};
use crate::body::{BodyDef, FactorTable};
use crate::collider::ColliderSet;
use crate::error::{Error, Irreversible, Quantity};
use crate::force::{FieldKind, FieldSet, ForceField};
use crate::fx::{Fx, fx};
use crate::integrate::Integrator;
use crate::joint::{JointSet, JointStates};
use crate::limits;
use crate::math::{Elapsed, Random, TimeStep, vec2};
use crate::replay::{Dump, RecordOptions, Recorder, Replay, ReplayLimits, Snapshot, SnapshotError, VerifyError};
use crate::slots::{BodyId, FieldId};
use crate::world::{Command, Inputs, Rollback, World, WorldDef};

/// Writes a world as bytes, and reads it from them.
fn read_again(world: &World) -> World {
    let bytes = world.snapshot().to_bytes();
    let read = Snapshot::from_bytes(&bytes, &custom_forces()).expect("a world like any other");
    assert!(read.to_bytes() == bytes && read.world().state_hash() == world.state_hash());
    read.into_world()
}

fn inputs(tick: u64) -> Inputs {
    let mut inputs = Inputs::new();
    inputs.replace(0, [Command::SetRandom(Random::seeded(tick)), Command::SetGravity(vec2(0, -9))]);
    inputs
}

/// A world goes on for some ticks: saved and read after each, dumped, undone, done over, recorded and played.
fn lives_on(start: &World, ticks: u64) {
    let mut world = read_again(start);
    let mut saved = world.clone();
    for tick in 0..ticks {
        let inputs = inputs(tick);
        let before = world.clone();
        world.carry_out(&inputs);
        let called = world.state_hash();
        let applied = world.step().applied.to_vec();
        let hash = world.state_hash();
        assert_eq!(world.tick(), limits::TICK.min(before.tick() + 1));

        saved.carry_out(&inputs);
        saved.step();
        saved = read_again(&saved);
        assert_eq!(saved.state_hash(), hash, "through bytes");

        let dump = Dump::of_tick(&before, &[], &inputs, &world).to_bytes();
        assert_eq!(Dump::from_bytes(&dump, &custom_forces()).expect("its own bytes").to_bytes(), dump);

        let mut back = world.clone();
        if back.step_back(&applied).is_ok() {
            assert_eq!(read_again(&back).state_hash(), called, "undone");
        }
        let mut over = before.clone();
        let mut rollback = Rollback::new(&over, [0], 3);
        let make = |world: &mut World, inputs: &[(u32, Inputs)]| _ = world.carry_out(&inputs[0].1);
        rollback.advance(&mut over, make).expect("the first tick");
        rollback.add_input(before.tick(), 0, inputs).expect("a player");
        match rollback.advance(&mut over, make) {
            Ok(report) => {
                let hashes: Vec<u64> = report.confirmed().map(|tick| tick.after.state_hash()).collect();
                assert_eq!((report.redone, &hashes[..]), (1, &[hash][..]), "made again");
            }
            // The count of ticks ends, and a rollback with it.
            Err(error) => {
                assert_eq!(before.tick(), limits::TICK);
                assert_eq!(error, Error::ChangedBetweenTicks { tick: limits::TICK + 1 });
            }
        }
    }
    for (hash_every, snapshot_every) in [(1, 0), (1, 1), (3, 4), (64, 4096)] {
        let mut again = start.clone();
        let mut recorder = Recorder::new(&again, RecordOptions { hash_every, snapshot_every });
        (0..ticks).for_each(|tick| _ = recorder.step(&mut again, &inputs(tick)));
        let file = recorder.finish(&again);
        let replay = Replay::from_bytes(&file, &custom_forces()).expect("it is whole");
        assert!(replay.to_bytes() == file && (replay.end(), replay.ticks()) == (world.tick(), ticks));
        assert_eq!(replay.verify(), Ok(()), "{hash_every}, {snapshot_every}");
        assert_eq!(replay.first_difference(&replay), None);
        let replay_limits = ReplayLimits {
            ticks,
            bodies: u32::MAX,
            fields: u32::MAX,
            colliders: u32::MAX,
            pairs: u32::MAX,
            commands: u64::MAX,
        };
        assert_eq!(replay.verify_within(replay_limits), Ok(()));
        let less = ReplayLimits { ticks: ticks - 1, ..replay_limits };
        assert_eq!(replay.verify_within(less), Err(VerifyError::Ticks { found: ticks, most: ticks - 1 }));
        let mut playback = replay.play();
        for (tick, hash) in [(u64::MAX, world.state_hash()), (0, start.state_hash()), (u64::MAX, world.state_hash())] {
            playback.seek(tick);
            assert_eq!(playback.world().state_hash(), hash);
        }
    }
}

/// An empty world with some bodies.
fn with(def: WorldDef, bodies: impl IntoIterator<Item = BodyDef>) -> World {
    let mut world = World::new(def).expect("a world");
    bodies.into_iter().for_each(|body| _ = world.add_body(body).expect("a body"));
    world
}

/// The world with the values of these names replaced.
fn forged(world: &World, changes: &[(&str, &[u8])]) -> Result<World, SnapshotError> {
    let bytes = changes.iter().fold(world.snapshot().to_bytes(), |bytes, (name, value)| {
        // The values before were made right, but for what hangs together with those to come.
        replaced(&bytes, name, 0, value)
    });
    Snapshot::from_bytes(&bytes, &custom_forces()).map(Snapshot::into_world)
}

fn accumulator(bits: i128) -> [u8; 16] {
    bits.rotate_left(64).to_le_bytes()
}

#[test]
fn the_count_of_ticks_ends_and_the_world_goes_on() {
    let def = WorldDef { sleep_after: None, gravity: vec2(0, -10), ..WorldDef::default() };
    let def = |integrator| WorldDef { integrator, ..def };
    for integrator in Integrator::ALL {
        for start in [limits::TICK - 3, limits::TICK - 1, limits::TICK] {
            let mut world = with(def(integrator), [BodyDef { velocity: vec2(1, 0), ..BodyDef::dynamic() }]);
            world.tick = start;
            lives_on(&world, 12);
        }
    }
    for start in [limits::TICK - 2, limits::TICK] {
        let mut world = everything::world();
        world.tick = start;
        lives_on(&world, 5);
    }
}

#[test]
fn at_the_last_tick_all_but_the_clock_goes_on() {
    let def = WorldDef { sleep_after: None, ..WorldDef::default() };
    let mut world = with(def, [BodyDef { velocity: vec2(60, 0), ..BodyDef::dynamic() }, BodyDef::fixed()]);
    world.tick = limits::TICK - 1;
    let bodies: Vec<BodyId> = world.bodies().map(|body| body.id()).collect();
    let mut sixtieth = Elapsed::ZERO.plus(limits::TICK - 1, def.time_step).expect("it fits");
    assert_eq!(world.elapsed(), sixtieth);
    world.step();
    world.step_back(&[]).expect_err("how many steps were made is not known");
    sixtieth = sixtieth.plus(1, def.time_step).expect("it fits");
    for steps in 1..5 {
        assert_eq!((world.tick(), world.elapsed()), (limits::TICK, sixtieth));
        assert_eq!(world.body(bodies[0]).expect("it is there").position(), vec2(steps, 0));
        assert_eq!(world.step_back(&[]), Err(Error::NotReversible { why: Irreversible::End }));
        // A reader that looked before the last step is told of all changes.
        assert!(world.changed_since(limits::TICK).map(|body| body.id()).eq(bodies.iter().copied()));
        assert_eq!(world.step().tick, limits::TICK);
    }
    // No file says more.
    for tick in [limits::TICK + 1, u64::MAX] {
        world.tick = tick;
        let read = Snapshot::from_bytes(&world.snapshot().to_bytes(), &[]);
        assert!(matches!(read, Err(SnapshotError::Invalid { error: Error::Inconsistent, .. })), "{:?}", read.err());
    }
}

#[test]
fn a_handle_of_the_last_generation_is_never_given_out_again() {
    let mut world = with(WorldDef::default(), [BodyDef::dynamic()]);
    let drag = ForceField::from(FieldKind::Drag { linear: fx!(1), quadratic: fx!(0), wind: vec2(0, 0) });
    world.add_field(drag).expect("a field");
    let last = u32::MAX.to_le_bytes();
    let mut world =
        forged(&world, &[("bodies[0].generation", &last), ("fields[0].generation", &last)]).expect("a world");
    lives_on(&world, 3);
    world.remove_body(BodyId::from_parts(0, u32::MAX)).expect("it is there");
    world.remove_field(FieldId::from_parts(0, u32::MAX)).expect("it is there");
    lives_on(&world, 3);
    let mut world = read_again(&world);
    assert_eq!(world.add_body(BodyDef::dynamic()), Ok(BodyId::from_parts(1, 0)));
    assert_eq!(world.add_field(drag), Ok(FieldId::from_parts(1, 0)));
    lives_on(&world, 3);
}

/// Slots that are used up count: their number, and so that of a handle, is never too large for a file.
#[test]
fn a_world_with_as_many_slots_as_can_be_is_full() {
    let World { mut bodies, .. } = with(WorldDef::default(), []);
    let mut factor_table = FactorTable::default();
    let mut fields = FieldSet::<Fx>::default();
    for _ in 0..limits::BODIES {
        assert_eq!(bodies.check_room(), Ok(()));
        assert_eq!(bodies.rebuild(u32::MAX, None, &mut factor_table), Ok(None));
    }
    for _ in 0..limits::FIELDS {
        assert_eq!(fields.check_room(), Ok(()));
        assert_eq!(fields.rebuild(u32::MAX, None), Ok(()));
    }
    let mut colliders = ColliderSet::<Fx>::default();
    for _ in 0..limits::COLLIDERS {
        assert_eq!(colliders.check_room(1, 0), Ok(()));
        assert_eq!(colliders.rebuild(u32::MAX, None), Ok(()));
    }
    assert_eq!((colliders.check_room(1, 0), colliders.check_room(0, 0)), (Err(Error::Full), Ok(())));
    assert_eq!(colliders.rebuild(u32::MAX, None), Err(Error::Full));
    assert_eq!(
        (colliders.set_free(vec![3]), colliders.check_room(1, 0), colliders.check_room(2, 0)),
        (Ok(()), Ok(()), Err(Error::Full))
    );
    // As many outlines beyond the first ones as there may be colliders.
    let room = [limits::COLLIDERS, limits::COLLIDERS + 1].map(|more| colliders.check_room(1, more));
    assert_eq!(room, [Ok(()), Err(Error::Full)]);
    let (mut joints, mut states) = (JointSet::<Fx>::default(), JointStates::default());
    for _ in 0..limits::JOINTS {
        assert_eq!(joints.check_room(), Ok(()));
        assert_eq!(joints.rebuild(u32::MAX, None, &mut states), Ok(()));
    }
    assert_eq!(
        (joints.check_room(), joints.rebuild(u32::MAX, None, &mut states)),
        (Err(Error::Full), Err(Error::Full))
    );
    assert_eq!((joints.set_free(vec![3]), joints.check_room()), (Ok(()), Ok(())));
    assert_eq!((bodies.check_room(), fields.check_room()), (Err(Error::Full), Err(Error::Full)));
    assert_eq!(bodies.rebuild(u32::MAX, None, &mut factor_table), Err(Error::Full));
    assert_eq!(fields.rebuild(u32::MAX, None), Err(Error::Full));
    // Another body, or field, in the slot of one that is gone.
    assert_eq!((bodies.set_free(vec![3]), fields.set_free(vec![3])), (Ok(()), Ok(())));
    assert_eq!((bodies.check_room(), fields.check_room()), (Ok(()), Ok(())));
}

#[test]
fn a_body_rests_for_no_longer_than_can_be_counted() {
    for ticks in [1, 2, u32::MAX - 1, u32::MAX] {
        for rest in [u32::MAX - 2, u32::MAX] {
            let def = WorldDef { sleep_after: Some(ticks), ..WorldDef::default() };
            let world = with(def, [BodyDef::dynamic()]);
            lives_on(&forged(&world, &[("bodies[0].ticks_at_rest", &rest.to_le_bytes())]).expect("a world"), 4);
            let mut world = world;
            world.bodies.columns.motion.ticks_at_rest[0] = rest;
            (0..4).for_each(|_| _ = world.step());
            read_again(&world);
        }
    }
}

#[test]
fn accelerations_and_pushes_of_any_size_are_used_up_by_a_step() {
    let def = WorldDef { integrator: Integrator::PublishedVerlet, ..WorldDef::default() };
    for bits in [i128::MAX, i128::MIN, i128::MAX - 1, 1 << 100, -1] {
        let last = accumulator(bits);
        let changes =
            ["linear.x", "linear.y", "angular"].map(|part| alloc::format!("bodies[0].last_acceleration.{part}"));
        let world = with(def, [BodyDef::dynamic()]);
        let changes: Vec<(&str, &[u8])> = changes.iter().map(|name| (&name[..], &last[..])).collect();
        lives_on(&forged(&world, &changes).expect("a world"), 4);
    }
    for word in [0, 1, 1 << 63, u64::MAX, u64::MAX >> 1] {
        let mut world = with(WorldDef::default(), [BodyDef::dynamic()]);
        let body = BodyId::from_parts(0, 0);
        world.apply_force(body, vec2(1, 2)).expect("it is dynamic");
        let sum = [word; 3].map(u64::to_le_bytes).concat();
        let names = ["force.x", "force.y", "torque"].map(|part| alloc::format!("bodies[0].applied.{part}"));
        let changes: Vec<(&str, &[u8])> = names.iter().map(|name| (&name[..], &sum[..])).collect();
        let mut world = forged(&world, &changes).expect("a world");
        lives_on(&world, 3);
        for (force, torque) in [(vec2(Fx::MAX, Fx::MIN), Fx::MAX), (vec2(Fx::MIN, Fx::MAX), Fx::MIN)] {
            world.apply_force(body, force).expect("it is dynamic");
            world.apply_torque(body, torque).expect("it is dynamic");
            lives_on(&world, 3);
        }
    }
}

#[test]
fn at_the_edge_of_the_envelope_a_body_goes_on_or_is_quarantined() {
    let edge = |value: Fx, sign: i128| accumulator((sign * i128::from(value.to_bits())) << 64);
    for integrator in Integrator::ALL {
        let def = WorldDef { integrator, gravity: vec2(3, -10), ..WorldDef::default() };
        let world = with(def, [BodyDef::dynamic(), BodyDef::kinematic()]);
        for (position, speed) in [(1, 1), (1, -1), (-1, 1), (-1, -1), (0, 1), (1, 0)] {
            let values = [
                ("position.x", edge(limits::POSITION, position)),
                ("position.y", edge(limits::POSITION, -position)),
                ("velocity.x", edge(limits::SPEED, speed)),
                ("velocity.y", edge(limits::SPEED, -speed)),
                ("angular_velocity", edge(limits::ANGULAR_SPEED, speed)),
            ];
            let named = |body: usize| values.map(|(name, value)| (alloc::format!("bodies[{body}].{name}"), value));
            let named: Vec<_> = (0..2).flat_map(named).collect();
            let changes: Vec<(&str, &[u8])> = named.iter().map(|(name, value)| (&name[..], &value[..])).collect();
            lives_on(&forged(&world, &changes).expect("at the edge"), 4);
        }
        // Quarantined as far off as a step may have it on its way.
        let far = [
            ("activity", vec![2]),
            ("position.x", edge(limits::TRANSIENT_POSITION, -1).to_vec()),
            ("velocity.y", edge(limits::TRANSIENT_SUM, 1).to_vec()),
            ("angular_velocity", edge(limits::TRANSIENT_SUM, -1).to_vec()),
        ];
        let named = far.map(|(name, value)| (alloc::format!("bodies[0].{name}"), value));
        let changes: Vec<(&str, &[u8])> = named.iter().map(|(name, value)| (&name[..], &value[..])).collect();
        let mut world = forged(&world, &changes).expect("quarantined");
        lives_on(&world, 4);
        let body = BodyId::from_parts(0, 0);
        world.release(body).expect_err("it is beyond the envelope");
        world.set_position(body, vec2(limits::POSITION, 0)).expect("at the edge");
        world.set_velocity(body, vec2(limits::SPEED, 0)).expect("at the edge");
        world.set_angular_velocity(body, -limits::ANGULAR_SPEED).expect("at the edge");
        world.release(body).expect("within it");
        lives_on(&world, 4);
    }
}

#[test]
fn time_goes_on_where_no_other_time_step_fits() {
    let def = WorldDef { time_step: TimeStep::hz(64), ..WorldDef::default() };
    // With 2^64 − 1 steps more the numerator is the largest there is.
    let (largest, den) = (u128::MAX - (u128::from(u64::MAX) << 57), 1 << 63);
    let end = Elapsed { num: largest, den }.plus(u64::MAX, def.time_step);
    assert_eq!(end, Some(Elapsed { num: u128::MAX, den }));
    let at = |num: u128| {
        let mut world = with(def, [BodyDef::dynamic()]);
        world.counted.0 = Elapsed { num, den };
        Snapshot::from_bytes(&world.snapshot().to_bytes(), &[]).map(Snapshot::into_world)
    };
    assert!(at(largest + 2).is_err(), "one more");
    let mut world = at(largest).expect("it fits");
    lives_on(&world, 5);
    for time_step in [TimeStep::hz(7), TimeStep::hz(61), TimeStep::ratio(1001, 60_000)] {
        let hash = world.state_hash();
        assert_eq!(world.set_time_step(time_step), Err(Error::ElapsedTime));
        assert_eq!(world.state_hash(), hash);
    }
    world.step();
    lives_on(&world, 5);
    world.tick = limits::TICK - 2;
    lives_on(&world, 5);
}

#[test]
fn user_data_and_blob_may_have_their_largest_values() {
    let mut world = with(WorldDef::default(), [BodyDef::dynamic()]);
    let command = Command::<Fx>::SetBlob(vec![7; limits::BLOB]);
    let mut recorder = Recorder::new(&world, RecordOptions { hash_every: 1, snapshot_every: 1 });
    recorder.execute(&mut world, &command).expect("as many bytes as can be");
    recorder.step(&mut world, &Inputs::new());
    read_again(&world);
    let file = recorder.finish(&world);
    let replay = Replay::from_bytes(&file, &[]).expect("it is whole");
    assert!(replay.to_bytes() == file && replay.verify().is_ok());
    let more = Command::<Fx>::SetBlob(vec![7; limits::BLOB + 1]);
    assert_eq!(Command::from_bytes(&more.to_bytes()).as_ref(), Ok(&more));
    assert_eq!(world.execute(&more), Err(Error::OutOfRange { quantity: Quantity::Blob }));
    read_again(&world);
}

#[test]
fn a_generator_goes_on_from_any_state_it_may_have() {
    for state in [[0, 0, 0, 1], [1 << 63, 0, 0, 0], [u64::MAX; 4]] {
        let mut world = with(WorldDef::default(), []);
        world.set_random(Random::from_state(state).expect("not all zero"));
        for _ in 0..100 {
            world.random_mut().bits();
            read_again(&world);
        }
        world.random_mut().jump();
        lives_on(&world, 2);
    }
}
