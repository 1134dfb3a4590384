//! Calls after the last step: a recording ends with the world as that step left it.

use alloc::vec;
use alloc::vec::Vec;

use super::encodings::replaced;
use super::{commands, custom_forces, everything, recording};
use crate::body::{Activity, BodyDef};
use crate::cases::run_seed;
use crate::collider::ColliderDef;
use crate::force::{Attachment, End, FieldKind, ForceField, Region};
use crate::fx::fx;
use crate::integrate::Integrator;
use crate::math::{Random, TimeStep, vec2};
use crate::replay::{RecordOptions, Recorder, Replay, Snapshot};
use crate::scalar::SpringConstants;
use crate::shape::Shape;
use crate::slots::{BodyId, FieldId};
use crate::world::{Command, Inputs, World, WorldDef};

/// Records some ticks, in which each of the commands is given with this chance in eight, and calls of another tick after each:
/// these must leave no trace in a file that ends there. Says how many of them were carried out.
fn calls_leave_no_trace(world: &World, commands: &[Command], chance: u64, random: &mut Random) -> u32 {
    let mut world = world.clone();
    let mut recorder = Recorder::new(&world, RecordOptions { hash_every: 1, snapshot_every: 0 });
    let mut calls = 0;
    for _ in 0..3 {
        let expected = recorder.clone().finish(&world);
        for command in commands {
            if random.below(8) < chance {
                calls += u32::from(recorder.execute(&mut world, command).is_ok());
                assert!(recorder.clone().finish(&world) == expected, "after {command:?}");
            }
        }
        recorder.step(&mut world, &Inputs::new());
    }
    let file = recorder.finish(&world);
    assert_eq!(Replay::from_bytes(&file, &custom_forces()).expect("it is whole").verify(), Ok(()));
    calls
}

#[test]
fn calls_of_every_kind_after_the_last_step_leave_no_trace() {
    let mut random = Random::seeded(run_seed(1));
    let recorded = Replay::from_bytes(&recording(), &custom_forces()).expect("it is whole");
    for world in [everything::world(), recorded.start().clone()] {
        for command in commands() {
            calls_leave_no_trace(&world, &[command], 8, &mut random);
        }
        let calls: u32 = (0..20).map(|_| calls_leave_no_trace(&world, &commands(), 3, &mut random)).sum();
        assert!(calls > 500, "{calls}");
    }
}

/// Pairs of sleeping bodies on springs, some of one shape, one slot free.
fn sleepers() -> World {
    let mut world = World::new(WorldDef { sleep_after: Some(1), ..WorldDef::default() }).expect("a world");
    let shapes = [Shape::circle(fx!(0.5)).ok(), None, Shape::rectangle(fx!(1), fx!(1)).ok()];
    let bodies: Vec<BodyId> = (0..9i32)
        .map(|i| {
            let colliders = shapes[i as usize % 3].iter().cloned().map(ColliderDef::ghost).collect();
            let def = BodyDef { position: vec2(i, 0), colliders, ..BodyDef::dynamic() };
            world.add_body(def).expect("there is room")
        })
        .collect();
    let spring = SpringConstants { rest: fx!(1), stiffness: fx!(1), damping: fx!(1) };
    for pair in bodies.chunks_exact(2) {
        let [near, far] = [pair[0], pair[1]].map(|body| Attachment { body, point: vec2(0, 0) });
        let kind = FieldKind::Spring { near, far: End::Body(far), spring };
        world.add_field(ForceField { kind, force_groups: 1 }).expect("there is room");
    }
    world.remove_body(bodies[8]).expect("it is there");
    (0..3).for_each(|_| _ = world.step());
    assert!(world.bodies().all(|body| body.activity() == Activity::Asleep));
    world
}

/// Commands that wake, add and remove bodies of [`sleepers`].
fn disturbing() -> Vec<Command> {
    let disc = || ColliderDef::ghost(Shape::circle(fx!(0.5)).expect("a shape"));
    let pull =
        FieldKind::Zone { region: Region::Disc { centre: vec2(0, 0), radius: fx!(3) }, acceleration: vec2(0, 1) };
    let mut commands = vec![
        Command::AddBody(BodyDef::dynamic().with_collider(disc())),
        Command::AddBody(BodyDef { position: vec2(0, 9), ..BodyDef::dynamic() }),
        Command::SetGravity(vec2(0, -1)),
        Command::SetGravity(vec2(0, 0)),
        Command::SetTimeStep(TimeStep::hz(50)),
        Command::SetIntegrator(Integrator::PublishedVerlet),
        Command::SetIntegrator(Integrator::Yoshida4),
        Command::SetSleepAfter(None),
        Command::SetSleepAfter(Some(1)),
        Command::AddField(ForceField { kind: pull, force_groups: 1 }),
        Command::RemoveField(FieldId::from_parts(1, 0)),
        Command::ClearForces,
        Command::SetBlob(vec![7]),
        Command::SetRandom(Random::seeded(9)),
    ];
    for slot in 0..9 {
        let body = BodyId::from_parts(slot, 0);
        commands.extend([
            Command::Wake(body),
            Command::Sleep(body),
            Command::Disable(body),
            Command::Enable(body),
            Command::SetVelocity { body, velocity: vec2(0, 1) },
            Command::SetPosition { body, position: vec2(2, 2) },
            Command::AddCollider { body, def: disc() },
            Command::RemoveBody(body),
        ]);
    }
    commands
}

#[test]
fn calls_that_wake_bodies_after_the_last_step_leave_no_trace() {
    let (world, mut random) = (sleepers(), Random::seeded(run_seed(2)));
    for command in disturbing() {
        calls_leave_no_trace(&world, &[command], 8, &mut random);
    }
    let calls: u32 = (0..40).map(|_| calls_leave_no_trace(&world, &disturbing(), 1, &mut random)).sum();
    assert!(calls > 300, "{calls}");
}

/// A file may say that a sleeping body has rested for some ticks, which no step leaves it with.
#[test]
fn the_ticks_at_rest_of_a_sleeping_body_are_kept_too() {
    let forged = replaced(&sleepers().snapshot().to_bytes(), "bodies[2].ticks_at_rest", 0, &7u32.to_le_bytes());
    let world = Snapshot::from_bytes(&forged, &[]).expect("it may be so").into_world();
    let wake = Command::Wake(BodyId::from_parts(3, 0));
    assert!(calls_leave_no_trace(&world, &[wake], 8, &mut Random::seeded(run_seed(3))) > 0);
}
