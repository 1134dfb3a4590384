//! Springs: to an anchor, between bodies, and a net of them.

use alloc::vec::Vec;

use super::trial::{Played, Trial, add_all, exact, happened, near_fx, near_wide, same};
use crate::body::{BodyDef, Damping, Mass};
use crate::force::{Attachment, End, FieldKind};
use crate::fx::{Fx, fx};
use crate::math::{Vec2, vec2};
use crate::scalar::{FxAccumulator, SpringConstants};
use crate::slots::BodyId;
use crate::world::{World, WorldDef};

/// Verlet's x(n+1) − 2·x(n) + x(n−1) = −(ω·h)²·x(n) is cos(n·φ) with cos φ = 1 − (ω·h)²/2: sixty degrees for ω·h = 1.
pub(super) fn to_anchor(trial: &mut Trial) -> Played {
    let mut world = World::new(exact())?;
    let anchor = vec2(5, 7);
    let id = world.add_body(BodyDef { position: vec2(11, -1), ..BodyDef::dynamic() })?;
    // ω = 64/s.
    let spring = SpringConstants { rest: fx!(0), stiffness: fx!(4096), damping: fx!(0) };
    world.add_field(FieldKind::Spring { near: Attachment::centre(id), far: End::World(anchor), spring })?;
    for n in 1..=600 {
        trial.step(&mut world);
        let (cosine, halves) =
            [(fx!(3), 1), (fx!(-3), -1), (fx!(-6), -2), (fx!(-3), -1), (fx!(3), 1), (fx!(6), 2)][(n - 1) % 6];
        let off = world.body(id)?.position() - anchor;
        // A drift goes with the velocity to ½ ulp: 1/128 ulp a step, which grows to 2/√3 of it.
        let bound = 1 + n as u32 / 64;
        near_fx("place along x after sixths of a period", off.x, cosine, bound)?;
        near_fx("place along y after sixths of a period", off.y, Fx::from_int(-4 * halves), bound)?;
    }
    Ok(())
}

pub(super) fn pair(trial: &mut Trial) -> Played {
    let mut world = World::new(WorldDef { sleep_after: None, ..WorldDef::default() })?;
    let start = BodyDef { mass: Mass::Explicit { mass: fx!(2), inertia: fx!(0.75) }, ..BodyDef::dynamic() };
    let ids = add_all(
        &mut world,
        [
            BodyDef { position: vec2(-2, 0), velocity: vec2(1, 3), ..start.clone() },
            BodyDef { position: vec2(3, 1), velocity: vec2(-1, -3), angular_velocity: fx!(2), ..start },
        ],
    )?;
    let spring = SpringConstants { rest: fx!(2), stiffness: fx!(40), damping: fx!(0.5) };
    let near = Attachment { body: ids[0], point: vec2(fx!(0.5), fx!(0.25)) };
    let far = End::Body(Attachment { body: ids[1], point: vec2(fx!(-0.25), fx!(0.5)) });
    world.add_field(FieldKind::Spring { near, far, spring })?;
    let spin = world.angular_momentum()?;
    let mut energy = world.energy()?;
    for _ in 0..10 {
        trial.steps(&mut world, 60);
        // Equal masses and opposite forces: opposite velocities to the bit.
        let (a, b) = (world.body(ids[0])?.velocity_exact(), world.body(ids[1])?.velocity_exact());
        same("velocities of a free pair", &a, &b.map(|v| v.negated()))?;
        let now = world.energy()?;
        happened("energy lost to the damper", now < energy)?;
        energy = now;
    }
    // Torques and arms are of the same positions, and the forces act along the line between their points, so only roundings
    // add up: 600 steps with places and velocities to an ulp, 4 kg at some metres.
    near_wide("angular momentum", world.angular_momentum()?, spin, 4096 << 32)
}

/// A net of 8 by 8 nodes, the upper corners of which are held.
pub(super) fn net(trial: &mut Trial) -> Played {
    const SIDE: i32 = 8;
    let mut world = World::new(WorldDef {
        gravity: vec2(0, -10),
        linear_damping: Damping::kept_per_second(fx!(0.8)),
        ..WorldDef::default()
    })?;
    // Half metres apart, from −7/4 to 7/4 m: the mirror is x = 0.
    let node = |i: i32| {
        let (column, row) = (i % SIDE, i / SIDE);
        let position =
            Vec2::new(Fx::from_ratio(i64::from(2 * column - (SIDE - 1)), 4), Fx::from_ratio(i64::from(row), 2));
        let held = row == SIDE - 1 && (column == 0 || column == SIDE - 1);
        if held { BodyDef { position, ..BodyDef::fixed() } } else { BodyDef { position, ..BodyDef::dynamic() } }
    };
    let ids: Vec<BodyId> = add_all(&mut world, (0..SIDE * SIDE).map(node))?;
    let id = |column: i32, row: i32| ids[(row * SIDE + column) as usize];
    let spring = SpringConstants { rest: fx!(0.4375), stiffness: fx!(900), damping: fx!(0.125) };
    for row in 0..SIDE {
        for column in 0..SIDE {
            let mut join = |column_to: i32, row_to: i32| {
                let ends = (id(column, row), id(column_to, row_to));
                let (near, far) = (Attachment::centre(ends.0), Attachment::centre(ends.1));
                if world.body(ends.0)?.mass().or(world.body(ends.1)?.mass()).is_some() {
                    world.add_field(FieldKind::Spring { near, far: End::Body(far), spring })?;
                }
                Ok::<_, super::Problem>(())
            };
            if column + 1 < SIDE {
                join(column + 1, row)?;
            }
            if row + 1 < SIDE {
                join(column, row + 1)?;
            }
        }
    }
    let bottom = world.body(id(3, 0))?.position().y;
    for _ in 0..600 {
        trial.step(&mut world);
        for row in 0..SIDE {
            for column in 0..SIDE / 2 {
                let (left, right) = (world.body(id(column, row))?, world.body(id(SIDE - 1 - column, row))?);
                let mirrored = |v: Vec2<FxAccumulator>| Vec2::new(v.x.negated(), v.y);
                same("place in the mirror", &left.position_exact(), &mirrored(right.position_exact()))?;
                same("velocity in the mirror", &left.velocity_exact(), &mirrored(right.velocity_exact()))?;
            }
        }
    }
    happened("a net that sags", world.body(id(3, 0))?.position().y < bottom - fx!(0.25))
}
