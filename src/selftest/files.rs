//! Scenes that write bytes and read them back, and that undo steps.

use alloc::vec::Vec;

use super::trial::{Numbers, Played, Trial, add_all, happened, same, there};
use crate::body::BodyDef;
use crate::collider::ColliderDef;
use crate::force::{Attachment, End, FieldKind};
use crate::fx::{Fx, fx};
use crate::integrate::Integrator;
use crate::math::{Random, vec2};
use crate::replay::{Dump, HashTree, RecordOptions, Recorder, Replay, Snapshot};
use crate::scalar::SpringConstants;
use crate::shape::Shape;
use crate::slots::BodyId;
use crate::world::{Command, Input, Inputs, World, WorldDef};

/// Bodies of every shape on springs between each other, one that sleeps, a generator and a blob.
fn start(integrator: Integrator) -> Result<(World, Vec<BodyId>), crate::error::Error> {
    let mut world = World::new(WorldDef { gravity: vec2(0, -10), integrator, ..WorldDef::default() })?;
    world.set_random(Random::seeded(11));
    world.set_blob(b"what the game needs")?;
    let shapes = [
        Shape::circle(fx!(0.5))?,
        Shape::rectangle(fx!(1), fx!(0.25))?,
        Shape::polygon(&[vec2(1, 1), vec2(fx!(2.5), 1), vec2(1, 3)])?,
    ];
    let mut numbers = Numbers(5);
    let ids = add_all(
        &mut world,
        shapes.into_iter().cycle().take(12).map(|shape| BodyDef {
            position: numbers.vec(4),
            velocity: numbers.vec(2),
            angle: numbers.fx(3),
            angular_velocity: numbers.fx(2),
            ..BodyDef::dynamic().with_collider(ColliderDef { density: fx!(2), ..ColliderDef::ghost(shape) })
        }),
    )?;
    for pair in ids.windows(2) {
        let spring = SpringConstants { rest: fx!(2), stiffness: fx!(9), damping: fx!(0.25) };
        let far = End::Body(Attachment::centre(pair[1]));
        world.add_field(FieldKind::Spring { near: Attachment::centre(pair[0]), far, spring })?;
    }
    world.add_body(BodyDef { gravity_scale: Fx::ZERO, position: vec2(99, 99), ..BodyDef::dynamic() })?;
    Ok((world, ids))
}

/// Inputs of two players at a tick: none at most ticks.
fn inputs(tick: u64, ids: &[BodyId]) -> Inputs {
    let mut inputs = Inputs::new();
    let body = ids[tick as usize % ids.len()];
    if tick % 5 == 0 {
        let kicked = Command::SetVelocity { body, velocity: vec2(1, 5) };
        // Out of order, and one twice.
        _ = inputs.insert(Input { player: 1, sequence: 0, command: Command::SetUserData { body, user_data: tick } });
        _ = inputs.insert(Input { player: 0, sequence: 1, command: kicked.clone() });
        _ = inputs.insert(Input { player: 0, sequence: 1, command: Command::Wake(body) });
        _ = inputs.insert(Input { player: 0, sequence: 0, command: Command::RemoveBody(BodyId::from_parts(77, 0)) });
    }
    inputs
}

pub(super) fn recording(trial: &mut Trial) -> Played {
    for integrator in Integrator::ALL {
        let (mut world, ids) = start(integrator)?;
        let mut recorder = Recorder::new(&world, RecordOptions { hash_every: 1, snapshot_every: 32 });
        for tick in 0..80 {
            let drawn = world.random_mut().below(6);
            if drawn == 0 {
                world.set_blob(&[tick as u8; 3])?;
            }
            recorder.step(&mut world, &inputs(tick, &ids));
            trial.take(&world);
        }
        let file = recorder.finish(&world);
        trial.take_bytes(&file);
        let replay = there("a replay", Replay::from_bytes(&file, &[]).ok())?;
        happened("a replay that goes as recorded", replay.verify().is_ok())?;
        let mut changed = file.clone();
        changed[file.len() / 2] ^= 4;
        happened("a changed bit found", Replay::from_bytes(&changed, &[]).is_err())?;
    }
    Ok(())
}

pub(super) fn snapshots(trial: &mut Trial) -> Played {
    for integrator in Integrator::ALL {
        let (mut world, _) = start(integrator)?;
        trial.steps(&mut world, 40);
        let bytes = world.snapshot().to_bytes();
        trial.take_bytes(&bytes);
        let mut back = there("a snapshot", Snapshot::from_bytes(&bytes, &[]).ok())?.into_world();
        same("bytes of what was read from them", &back.snapshot().to_bytes(), &bytes)?;
        trial.steps(&mut world, 40);
        (0..40).for_each(|_| _ = back.step());
        same("the future of a snapshot", &back.state_hash(), &world.state_hash())?;
        same("trees of equal states", &HashTree::of(&back), &HashTree::of(&world))?;
        let before = world.clone();
        trial.step(&mut world);
        let dump = Dump::of_tick(&before, &[], &Inputs::new(), &world);
        trial.take_bytes(&dump.to_bytes());
        let read = there("a dump", Dump::from_bytes(&dump.to_bytes(), &[]).ok())?;
        happened("dumps of one tick that are the same", read.first_difference(&dump).is_none())?;
    }
    Ok(())
}

pub(super) fn there_and_back(trial: &mut Trial) -> Played {
    for integrator in [Integrator::SymplecticEuler, Integrator::VelocityVerlet, Integrator::Yoshida4] {
        let (mut world, ids) = start(integrator)?;
        // Steps with damping or sleep cannot be undone.
        world.set_sleep_after(None)?;
        let dampers: Vec<_> = world.fields().map(|(id, field)| (id, *field)).collect();
        for (id, field) in dampers {
            if let FieldKind::Spring { near, far, spring } = field.kind {
                world.set_field(
                    id,
                    FieldKind::Spring { near, far, spring: SpringConstants { damping: Fx::ZERO, ..spring } },
                )?;
            }
        }
        let mut way = Vec::new();
        for tick in 0..100 {
            way.push((world.state_hash(), Vec::new()));
            world.apply_force_at_point(ids[tick % ids.len()], vec2(3, 1), vec2(1, 2))?;
            trial.step(&mut world);
            way[tick].1 = world.last_report().applied.to_vec();
        }
        for (hash, applied) in way.into_iter().rev() {
            world.step_back(&applied)?;
            world.clear_forces();
            same("a step undone", &world.state_hash(), &hash)?;
            trial.take(&world);
        }
    }
    Ok(())
}
