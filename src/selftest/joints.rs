//! Joined bodies: chains, nets, ragdolls and machines, beside their mirror images.

use alloc::vec::Vec;

use super::trial::{Numbers, Played, Trial, happened, same};
use crate::body::{BodyDef, BodyKind};
use crate::collider::{ColliderDef, Filter};
use crate::error::Error;
use crate::fx::{Fx, fx};
use crate::joint::{
    Distance, JointDef, JointKind, JointLimits, JointMotor, JointSpring, Prismatic, Revolute, Weld, Wheel,
};
use crate::math::{Vec2, vec2};
use crate::shape::Shape;
use crate::slots::BodyId;
use crate::symmetry::Symmetry;
use crate::world::{World, WorldDef};

fn world() -> Result<World, Error> {
    let mut world = World::new(WorldDef { gravity: vec2(0, fx!(-9.8125)), sleep_after: None, ..WorldDef::default() })?;
    let ground = BodyDef::fixed().with_collider(Shape::rectangle(64, 2)?);
    world.add_body(BodyDef { position: vec2(0, -9), key: u64::MAX, ..ground })?;
    Ok(world)
}

/// A bar that touches no body of its group.
fn bar(world: &mut World, position: Vec2, size: Vec2, density: Fx, group: i32) -> Result<BodyId, Error> {
    let collider = ColliderDef {
        density,
        filter: Filter { group, ..Filter::default() },
        ..ColliderDef::new(Shape::rectangle(size.x, size.y)?)
    };
    let key = world.bodies().count() as u64;
    world.add_body(BodyDef { position, key, ..BodyDef::dynamic().with_collider(collider) })
}

fn join(world: &mut World, bodies: [Option<BodyId>; 2], point: Vec2, kind: JointKind) -> Result<(), Error> {
    let joint = JointDef::at(world, bodies[0], bodies[1], point)?;
    let key = world.joints().count() as u64;
    world.add_joint(JointDef { kind, key, ..joint }).map(|_| ())
}

/// Steps a world beside its mirror image. Returns the widest gap of its hinges and welds.
fn step_beside_image(trial: &mut Trial, world: &mut World, ticks: u32) -> Result<Fx, super::Problem> {
    let mirror = |world: &World| Symmetry::MIRROR.world(world).ok_or(Error::Inconsistent);
    let mut image = mirror(world)?;
    let mut widest = Fx::ZERO;
    for _ in 0..ticks {
        trial.step(world);
        image.step();
        same("joined bodies and their mirror image", &mirror(world)?.state_hash(), &image.state_hash())?;
        let are_points = |kind: JointKind| matches!(kind, JointKind::Revolute(_) | JointKind::Weld(_));
        let gaps = world.joints().filter(|joint| are_points(joint.def().kind)).map(|joint| joint.length());
        widest = gaps.fold(widest, Fx::max);
    }
    Ok(widest)
}

/// A chain with a heavy end, a net of rods, a bridge with limits, motors and friction, and a beam of welds.
pub(super) fn chains(trial: &mut Trial) -> Played {
    let mut world = world()?;
    let mut last = None;
    for i in 0..12 {
        let x = Fx::from_ratio(i, 2);
        let density = if i == 11 { fx!(100) } else { fx!(1) };
        let link = bar(&mut world, Vec2::new(x + fx!(0.25), fx!(6)), Vec2::new(fx!(0.5), fx!(0.125)), density, -1)?;
        join(&mut world, [last, Some(link)], Vec2::new(x, fx!(6)), JointKind::Revolute(Revolute::default()))?;
        last = Some(link);
    }
    let mut speeds = Numbers(50);
    last = None;
    for i in 0..=8 {
        let x = Fx::from_int(i) - fx!(12);
        let plank = if i < 8 {
            let place = Vec2::new(x + fx!(0.5), fx!(-4));
            Some(bar(&mut world, place, Vec2::new(fx!(1), fx!(0.25)), fx!(4), -2)?)
        } else {
            None
        };
        let motor = Some(JointMotor { speed: speeds.fx(2), max_force: fx!(64) });
        let limits = Some(JointLimits { lower: fx!(-0.0625), upper: fx!(0.0625) });
        let kind = Revolute { limits, motor, friction: fx!(64), ..Revolute::default() };
        join(&mut world, [last, plank], Vec2::new(x, fx!(-4)), JointKind::Revolute(kind))?;
        last = plank;
    }
    last = None;
    for i in 0..6 {
        let x = Fx::from_ratio(i, 2) + fx!(10);
        let beam = bar(&mut world, Vec2::new(x + fx!(0.25), fx!(2)), Vec2::new(fx!(0.5), fx!(0.25)), fx!(1), -3)?;
        join(&mut world, [last, Some(beam)], Vec2::new(x, fx!(2)), JointKind::Weld(Weld::default()))?;
        last = Some(beam);
    }
    net(&mut world)?;
    let widest = step_beside_image(trial, &mut world, 240)?;
    happened("chains, bridges and beams that stay together", widest < fx!(0.004))
}

/// A net of rods that hangs on two of its corners.
fn net(world: &mut World) -> Result<(), Error> {
    let node = |column: i32, row: i32| vec2(column - 20, row);
    let mut nodes = Vec::new();
    for i in 0..16 {
        nodes.push(bar(world, node(i % 4, i / 4), Vec2::new(fx!(0.25), fx!(0.25)), fx!(8), -4)?);
    }
    for i in 0..16 {
        let (column, row) = (i % 4, i / 4);
        let neighbours = [(column + 1, row), (column, row + 1)];
        for (column_to, row_to) in neighbours.into_iter().filter(|&(column, row)| column < 4 && row < 4) {
            let (from, to) = (nodes[i as usize], nodes[(row_to * 4 + column_to) as usize]);
            let rod = JointDef::between(world, from, node(column, row), to, node(column_to, row_to))?;
            let (kind, key) = (JointKind::Distance(Distance::rod(fx!(1))), world.joints().count() as u64);
            world.add_joint(JointDef { kind, key, ..rod })?;
        }
    }
    for corner in [12, 15] {
        let at = node(corner % 4, 3);
        join(world, [None, Some(nodes[corner as usize])], at, JointKind::Revolute(Revolute::default()))?;
    }
    Ok(())
}

/// Ragdolls with limits and friction that fall on crates, at up to 12 m/s.
pub(super) fn ragdolls(trial: &mut Trial) -> Played {
    let mut world = world()?;
    for i in 0..6 {
        bar(
            &mut world,
            Vec2::new(Fx::from_int(i - 3) + fx!(0.5), fx!(-7.625)),
            Vec2::new(fx!(0.75), fx!(0.75)),
            fx!(4),
            0,
        )?;
    }
    let mut numbers = Numbers(51);
    for i in 0..4 {
        let middle = Vec2::new(Fx::from_int(2 * i - 3) + numbers.fx(0) / 2, fx!(-4) + Fx::from_int(i));
        let limb = |world: &mut World, x: Fx, y: Fx, width: Fx, height: Fx| {
            bar(world, middle + Vec2::new(x, y), Vec2::new(width, height), fx!(100), -10 - i)
        };
        let torso = limb(&mut world, fx!(0), fx!(0), fx!(0.375), fx!(0.75))?;
        let head = limb(&mut world, fx!(0), fx!(0.5), fx!(0.25), fx!(0.25))?;
        let mut joints = Vec::from([(torso, head, Vec2::new(fx!(0), fx!(0.375)), [fx!(-0.5), fx!(0.5)])]);
        for side in [-1, 1] {
            let x = Fx::from_ratio(side, 4);
            let arm = limb(&mut world, x, fx!(0), fx!(0.125), fx!(0.75))?;
            let thigh = limb(&mut world, x / 2, fx!(-0.625), fx!(0.1875), fx!(0.5))?;
            let shin = limb(&mut world, x / 2, fx!(-1.125), fx!(0.125), fx!(0.5))?;
            joints.push((torso, arm, Vec2::new(x, fx!(0.375)), [fx!(-1.5), fx!(1.5)]));
            joints.push((torso, thigh, Vec2::new(x / 2, fx!(-0.375)), [fx!(-1), fx!(1)]));
            joints.push((thigh, shin, Vec2::new(x / 2, fx!(-0.875)), [fx!(-2), fx!(0)]));
        }
        for (parent, limb, point, [lower, upper]) in joints {
            let limits = Some(JointLimits { lower, upper });
            let kind = Revolute { limits, friction: fx!(4), ..Revolute::default() };
            join(&mut world, [Some(parent), Some(limb)], middle + point, JointKind::Revolute(kind))?;
            world.set_velocity(limb, Vec2::new(numbers.fx(1), fx!(-6)))?;
        }
    }
    let widest = step_beside_image(trial, &mut world, 300)?;
    let moving = world.bodies().filter(|body| body.kind() == BodyKind::Dynamic);
    let lowest = moving.map(|body| body.position().y).min();
    happened("ragdolls that land and stay together", widest < fx!(0.015625) && lowest > Some(fx!(-8)))
}

/// A car on springs that drives over crates, and a lift.
pub(super) fn machines(trial: &mut Trial) -> Played {
    let mut world = world()?;
    let hull = bar(&mut world, vec2(-8, fx!(-7)), vec2(2, fx!(0.5)), fx!(20), -1)?;
    for side in [-1, 1] {
        let place = vec2(-8, fx!(-7.5)) + Vec2::new(Fx::from_ratio(3 * side, 4), Fx::ZERO);
        let filter = Filter { group: -1, ..Filter::default() };
        let tyre = ColliderDef { filter, density: fx!(4), ..ColliderDef::new(Shape::circle(fx!(0.375))?) };
        let key = world.bodies().count() as u64;
        let wheel = world.add_body(BodyDef { position: place, key, ..BodyDef::dynamic().with_collider(tyre) })?;
        let suspension = Wheel {
            limits: Some(JointLimits { lower: fx!(-0.25), upper: fx!(0.25) }),
            spring: Some(JointSpring::new(fx!(4), fx!(0.75))),
            motor: Some(JointMotor { speed: fx!(-12), max_force: fx!(64) }),
            ..Wheel::default()
        };
        let axle = JointDef::along(&world, hull, wheel, place, vec2(0, 1))?;
        let (kind, key) = (JointKind::Wheel(suspension), world.joints().count() as u64);
        world.add_joint(JointDef { kind, key, ..axle })?;
    }
    for i in 0..6 {
        bar(&mut world, vec2(-3 + 2 * i, fx!(-7.875)), vec2(fx!(0.5), fx!(0.25)), fx!(4), 0)?;
    }
    let cabin = bar(&mut world, vec2(12, -4), vec2(1, 1), fx!(8), -5)?;
    let rail = JointDef::along(&world, None, cabin, vec2(12, -4), vec2(0, 1))?;
    let lift = Prismatic {
        limits: Some(JointLimits { lower: fx!(-2), upper: fx!(3) }),
        motor: Some(JointMotor { speed: fx!(2), max_force: fx!(256) }),
        ..Prismatic::default()
    };
    let (kind, key) = (JointKind::Prismatic(lift), world.joints().count() as u64);
    world.add_joint(JointDef { kind, key, ..rail })?;
    step_beside_image(trial, &mut world, 300)?;
    let (car, lifted) = (world.body(hull)?.position(), world.body(cabin)?.position());
    happened("a car that drives over crates", car.x > fx!(2) && car.y > fx!(-8))?;
    happened("a lift at the upper end", (lifted.y - fx!(-1)).abs() < fx!(0.0009765625))
}
