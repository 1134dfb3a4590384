//! Many bodies: every way a step may go with a block of them, and with many blocks.

use alloc::vec::Vec;

use super::trial::{Numbers, Played, Trial, add_all, happened, same, same_body};
use crate::body::{BodyDef, Damping, Mass};
use crate::error::Error;
use crate::force::{Attachment, End, FieldKind, ForceField, Region};
use crate::fx::{Fx, fx};
use crate::integrate::Integrator;
use crate::math::{TimeStep, vec2};
use crate::scalar::SpringConstants;
use crate::slots::BodyId;
use crate::world::{World, WorldDef};

fn flying(numbers: &mut Numbers) -> BodyDef {
    BodyDef {
        position: numbers.vec(12),
        angle: numbers.fx(4),
        velocity: numbers.vec(6),
        angular_velocity: numbers.fx(5),
        mass: Mass::Explicit { mass: fx!(2), inertia: fx!(0.5) },
        ..BodyDef::dynamic()
    }
}

/// Some bodies of a world, each in a world of its own with the same definition.
fn alone(world: &World, ids: impl Iterator<Item = BodyId>) -> Result<Vec<(BodyId, World, BodyId)>, Error> {
    let preview_of = |id: BodyId| {
        let preview = world.preview(id)?;
        Ok((id, preview.world().clone(), preview.id()))
    };
    ids.map(preview_of).collect()
}

fn step_beside(trial: &mut Trial, world: &mut World, alone: &mut [(BodyId, World, BodyId)], ticks: u32) -> Played {
    for _ in 0..ticks {
        trial.step(world);
        alone.iter_mut().for_each(|(_, world, _)| _ = world.step());
    }
    for (id, twin, twin_id) in alone {
        same_body("one in a crowd", (world, *id), (twin, *twin_id))?;
    }
    Ok(())
}

/// Blocks of bodies alike: with wide vectors where there are some.
pub(super) fn wide_blocks(trial: &mut Trial) -> Played {
    for (integrator, seed) in Integrator::ALL.into_iter().zip(10..) {
        let def = WorldDef {
            time_step: TimeStep::hz(60),
            gravity: vec2(fx!(0.5), fx!(-9.81)),
            integrator,
            linear_damping: Damping::kept_per_second(fx!(0.75)),
            angular_damping: Damping::kept_per_second(fx!(0.5)),
            sleep_after: None,
            ..WorldDef::default()
        };
        let mut world = World::new(def)?;
        let mut numbers = Numbers(seed);
        let ids = add_all(&mut world, (0..300).map(|_| flying(&mut numbers)))?;
        let mut few = alone(&world, ids.iter().copied().step_by(37))?;
        step_beside(trial, &mut world, &mut few, 240)?;
    }
    Ok(())
}

/// Neighbours of every sort: other factors, other kinds, pushed, asleep, leaving, in fields and on springs.
pub(super) fn mixed_blocks(trial: &mut Trial) -> Played {
    let def = WorldDef {
        gravity: vec2(0, -5),
        linear_damping: Damping::kept_per_second(fx!(0.875)),
        sleep_after: Some(5),
        ..WorldDef::default()
    };
    let mut world = World::new(def)?;
    let mut numbers = Numbers(20);
    let sort = |(i, def): (u32, BodyDef)| match i % 8 {
        0 => BodyDef { gravity_scale: fx!(-2), linear_damping: Some(Damping::kept_per_second(fx!(0.001))), ..def },
        1 => BodyDef { kind: crate::body::BodyKind::Kinematic, ..def },
        2 => BodyDef { position: def.position, ..BodyDef::fixed() },
        3 => BodyDef { position: def.position, gravity_scale: fx!(0), force_groups: 0, ..BodyDef::dynamic() },
        4 => BodyDef { velocity: vec2(1_048_575, 5), linear_damping: Some(Damping::NONE), force_groups: 0, ..def },
        5 => BodyDef { force_groups: 2, ..def },
        _ => def,
    };
    let bodies: Vec<BodyDef> = (0..400).map(|_| flying(&mut numbers)).collect();
    let ids = add_all(&mut world, (0..).zip(bodies).map(sort))?;
    let region = Region::Box { min: vec2(-2000, -2000), max: vec2(2000, 2000) };
    world.add_field(ForceField { kind: FieldKind::Zone { region, acceleration: vec2(3, 1) }, force_groups: 2 })?;
    let spring = SpringConstants { rest: fx!(5), stiffness: fx!(3), damping: fx!(0.25) };
    world.add_field(FieldKind::Spring { near: Attachment::centre(ids[6]), far: End::World(vec2(0, 0)), spring })?;
    let far = End::Body(Attachment::centre(ids[399]));
    world.add_field(FieldKind::Spring { near: Attachment::centre(ids[14]), far, spring })?;
    let mut few = alone(&world, ids.iter().copied().step_by(11))?;
    step_beside(trial, &mut world, &mut few, 60)?;
    let asleep = world.bodies().filter(|body| body.activity() == crate::body::Activity::Asleep).count();
    happened("some asleep, some not", asleep >= 50 && world.moving_count() > 200)?;
    // Bodies that are pushed move the same in a world of their own.
    let mut refusals = 0;
    for tick in 0..60u32 {
        for (id, twin, twin_id) in &mut few {
            if world.body(*id)?.mass().is_some() && tick % 3 == id.parts().0 % 3 {
                let force = vec2(Fx::from_int(tick as i32), -3);
                // The fastest are pushed out of the envelope, and there is no pushing them any more.
                let (pushed, own_pushed) = (world.apply_force(*id, force), twin.apply_force(*twin_id, force));
                same("a push that is refused", &pushed.is_ok(), &own_pushed.is_ok())?;
                refusals += u32::from(pushed.is_err());
            }
        }
        step_beside(trial, &mut world, &mut few, 1)?;
    }
    happened("some pushed out", refusals > 0)
}

/// More than 64 blocks of 128: steps go to all cores where the feature is there.
pub(super) fn nine_thousand(trial: &mut Trial) -> Played {
    let def = WorldDef { gravity: vec2(0, -10), sleep_after: Some(4), ..WorldDef::default() };
    let mut world = World::new(def)?;
    let mut numbers = Numbers(30);
    let body = |i: u32, def: BodyDef| match i % 1000 {
        // At rest in no gravity; and about to leave, each at another tick.
        7 => BodyDef { velocity: vec2(0, 0), angular_velocity: fx!(0), gravity_scale: fx!(0), ..def },
        77 => BodyDef { velocity: vec2(0, Fx::from_ratio(-1_048_574 * 1000 - i64::from(i) / 12, 1000)), ..def },
        _ => def,
    };
    let bodies: Vec<BodyDef> = (0..9000).map(|i| body(i, flying(&mut numbers))).collect();
    let ids = add_all(&mut world, bodies)?;
    let mut few = alone(&world, ids.iter().copied().step_by(1001).chain([ids[77], ids[8077], ids[7]]))?;
    let (mut faults, mut asleep) = (0, 0);
    for _ in 0..60 {
        step_beside(trial, &mut world, &mut few, 1)?;
        faults += world.last_report().faults.len();
        asleep += world.last_report().fell_asleep.len();
    }
    happened("some left, some fell asleep", faults == 9 && asleep == 9)
}
