//! Force fields but for springs: attractors, drag, thrust, zones, custom forces, groups.

use alloc::sync::Arc;

use super::trial::{
    Flight, Played, Trial, add_all, exact, happened, near, near_fx, near_turn, near_vec, near_wide, refused, same,
    same_body, there,
};
use crate::body::{Activity, BodyDef, Mass};
use crate::error::{Cause, Error, Fault};
use crate::force::{
    Attachment, BodyState, CustomForce, CustomForceError, Dependence, End, FieldKind, ForceField, ForceTorque, Region,
};
use crate::fx::{Fx, fx};
use crate::integrate::Integrator;
use crate::math::{Vec2, vec2};
use crate::scalar::{FxFactor, Turn};
use crate::slots::BodyId;
use crate::world::{World, WorldDef};

/// An attractor that a body carries, of so many m³/s².
fn carried(body: BodyId, mu: u64, softening: Fx) -> FieldKind {
    FieldKind::Attractor { centre: End::Body(Attachment::centre(body)), mu: FxFactor::from_ratio(mu, 1), softening }
}

pub(super) fn attractor_pair(trial: &mut Trial) -> Played {
    let mut world = World::new(WorldDef::default())?;
    let start =
        BodyDef { position: vec2(6, 1), velocity: vec2(-1, 4), mass: Mass::Kilograms(fx!(3)), ..BodyDef::dynamic() };
    let image = BodyDef { position: -start.position, velocity: -start.velocity, ..start.clone() };
    let ids = add_all(&mut world, [start, image])?;
    for &id in &ids {
        world.add_field(carried(id, 500, fx!(0.5)))?;
    }
    let energy = world.energy()?;
    let mut crossed = false;
    for _ in 0..600 {
        trial.step(&mut world);
        let (a, b) = (world.body(ids[0])?, world.body(ids[1])?);
        same("place of the point image", &a.position_exact(), &b.position_exact().map(|x| x.negated()))?;
        same("velocity of the point image", &a.velocity_exact(), &b.velocity_exact().map(|v| v.negated()))?;
        crossed |= a.position().x < fx!(0);
    }
    same("momentum", &world.momentum()?, &Vec2::default())?;
    happened("they went around each other", crossed)?;
    // Verlet's error of energy, of the order of (ω·h)² with ω = 2/s on average and 20/s where they meet: a twentieth.
    let bound = there("an energy", energy.times(FxFactor::from_ratio(1, 20)))?;
    near_wide("energy", world.energy()?, energy, bound.to_bits().unsigned_abs())
}

pub(super) fn three_bodies(trial: &mut Trial) -> Played {
    let mut world = World::new(WorldDef { integrator: Integrator::Yoshida4, ..WorldDef::default() })?;
    let places = [(1, vec2(9, 0), vec2(0, 6)), (2, vec2(-6, 3), vec2(0, -5)), (4, vec2(0, -5), vec2(1, 1))];
    for (mass, position, velocity) in places {
        let id = world.add_body(BodyDef {
            mass: Mass::Kilograms(Fx::from_int(mass)),
            position,
            velocity,
            ..BodyDef::dynamic()
        })?;
        // The same G for all, so that each action has its reaction.
        world.add_field(carried(id, 50 * mass.unsigned_abs() as u64, fx!(0.25)))?;
    }
    let before = world.momentum()?;
    trial.steps(&mut world, 3000);
    let after = world.momentum()?;
    // Public velocities are within ½ ulp, 7 kg in all; the fields' 2^-61 of 2^10 m/s² over 50 s is nothing beside it.
    near_wide("momentum along x", after.x, before.x, 4 << 32)?;
    near_wide("momentum along y", after.y, before.y, 4 << 32)?;
    let far = world.bodies().all(|body| body.position().x.abs() < fx!(1000));
    happened("three bodies that stay about", far && world.bodies().count() == 3)
}

pub(super) fn drag_linear(trial: &mut Trial) -> Played {
    let mut world = World::new(WorldDef::default())?;
    let wind = vec2(2, -1);
    let id = world.add_body(BodyDef { mass: Mass::Kilograms(fx!(2)), velocity: vec2(30, 40), ..BodyDef::dynamic() })?;
    world.add_field(FieldKind::Drag { linear: fx!(1), quadratic: fx!(0), wind })?;
    // e^(−t/2) after 1, 2 and 4 s.
    let left = [(60, fx!(0.6065306597126334)), (60, fx!(0.3678794411714423)), (120, fx!(0.1353352832366127))];
    for (ticks, left) in left {
        trial.steps(&mut world, ticks);
        // Half an ulp of what is left, times 41 m/s.
        let expected = wind + Vec2::new(fx!(28) * left, fx!(41) * left);
        near_vec("velocity in wind", world.body(id)?.velocity(), expected, 22)?;
    }
    trial.steps(&mut world, 60);
    // Towards −1 m/s by 41·e^-2.5.
    happened("carried along by the wind", world.body(id)?.velocity().y < fx!(2.4))
}

pub(super) fn drag_quadratic(trial: &mut Trial) -> Played {
    let mut world = World::new(WorldDef::default())?;
    let id = world.add_body(BodyDef { velocity: vec2(3, 4), ..BodyDef::dynamic() })?;
    world.add_field(FieldKind::Drag { linear: fx!(0), quadratic: fx!(0.25), wind: vec2(0, 0) })?;
    for n in 1..=300 {
        trial.step(&mut world);
        // 5 m/s at β = ¼/m: 1/(1 + 1.25·n/60) = 48/(48 + n) is left.
        let expected = Vec2::new(Fx::from_ratio(3 * 48, 48 + n), Fx::from_ratio(4 * 48, 48 + n));
        near_vec("velocity against quadratic drag", world.body(id)?.velocity(), expected, 1)?;
    }
    Ok(())
}

pub(super) fn drag_stiff(trial: &mut Trial) -> Played {
    let mut world = World::new(WorldDef { integrator: Integrator::Yoshida4, ..WorldDef::default() })?;
    let id = world.add_body(BodyDef { velocity: vec2(180, 240), ..BodyDef::dynamic() })?;
    world.add_field(FieldKind::Drag { linear: fx!(0), quadratic: fx!(1), wind: vec2(0, 0) })?;
    let (mut outside, mut inside) = (0, 0);
    for n in 1..=240 {
        trial.step(&mut world);
        match world.last_report().drag_outside {
            0 => inside += 1,
            _ => outside += 1,
        }
        // 300 m/s at β = 1/m: 1/(1 + 5·n) is left.
        let expected = Vec2::new(Fx::from_ratio(180, 1 + 5 * n), Fx::from_ratio(240, 1 + 5 * n));
        near_vec("velocity against stiff drag", world.body(id)?.velocity(), expected, 1)?;
    }
    happened("drag around the whole step, then inside it", outside > 0 && inside > 100)
}

pub(super) fn thruster(trial: &mut Trial) -> Played {
    let mut world = World::new(exact())?;
    let id =
        world.add_body(BodyDef { mass: Mass::Explicit { mass: fx!(2), inertia: fx!(4) }, ..BodyDef::dynamic() })?;
    // τ = 0·1 − (−2)·3 = 6 N·m, α = 1.5 rad/s².
    world.add_field(FieldKind::Thrust { at: Attachment { body: id, point: vec2(0, -2) }, force: vec2(3, 1) })?;
    let mut turned = Flight::new(fx!(0), fx!(0));
    let mut turned_full = false;
    for _ in 0..512 {
        trial.step(&mut world);
        turned.fly(fx!(1.5), 1);
        let body = world.body(id)?;
        near("angular velocity under thrust", body.angular_velocity().to_bits().into(), turned.v.into(), 1)?;
        // 512 steps with a velocity to ½ ulp are below 4 ulps, of 2^29.4 units each.
        near_turn("angle under thrust", body.angle_exact(), Turn::from_radians(Fx::from_bits(turned.x)), 1 << 32)?;
        turned_full |= Fx::from_bits(turned.x) > Fx::TAU;
    }
    happened("a full turn", turned_full)?;
    // It flies along a curve: as the thrust turns, the speed stays far below |F|/m·t = 12.6 m/s.
    happened("a curve", world.body(id)?.velocity().checked_length().is_some_and(|v| v < fx!(4)))
}

pub(super) fn zones(trial: &mut Trial) -> Played {
    let mut world = World::new(exact())?;
    let disc =
        FieldKind::Zone { region: Region::Disc { centre: vec2(0, 0), radius: fx!(5) }, acceleration: vec2(0, -8) };
    let shelf = Region::Box { min: vec2(10, 10), max: vec2(20, 500) };
    world.add_field(disc)?;
    world
        .add_field(ForceField { kind: FieldKind::Zone { region: shelf, acceleration: vec2(0, 4) }, force_groups: 2 })?;
    let at = |x: Fx, y: Fx, force_groups| BodyDef { position: Vec2::new(x, y), force_groups, ..BodyDef::dynamic() };
    let falls = world.add_body(at(fx!(3), fx!(4), 1))?; // on the very edge of the disc
    let outside = world.add_body(at(fx!(3), fx!(4) + Fx::DELTA, 1))?;
    let lifted = world.add_body(at(fx!(10), fx!(10), 3))?; // in the corner of the box
    let beside = world.add_body(at(fx!(10) - Fx::DELTA, fx!(10), 3))?;
    let bystander = world.add_body(at(fx!(15), fx!(15), 1))?;
    let mut flight = Flight::new(fx!(10), fx!(0));
    let mut left_at = None;
    for tick in 1..=320 {
        trial.step(&mut world);
        flight.fly(fx!(4), 1);
        same("place in the box", &world.body(lifted)?.position().y.to_bits(), &flight.x)?;
        if left_at.is_none() && world.body(falls)?.position().y < fx!(-4) {
            left_at = Some((tick, world.body(falls)?.velocity()));
        }
    }
    let (tick, speed) = there("a way out of the disc", left_at)?;
    happened("time outside the disc", tick < 200)?;
    same("velocity outside the disc", &world.body(falls)?.velocity(), &speed)?;
    // 2·8·8 = v² within what half a kick, 1/16 m/s at 11.3 m/s, makes of it.
    let squared = (speed.y * speed.y).to_bits();
    near("velocity out of the disc, squared", squared.into(), fx!(128).to_bits().into(), 3 << 31)?;
    for (id, x, y) in
        [(outside, fx!(3), fx!(4) + Fx::DELTA), (beside, fx!(10) - Fx::DELTA, fx!(10)), (bystander, fx!(15), fx!(15))]
    {
        same("place of one in no zone", &world.body(id)?.position(), &Vec2::new(x, y))?;
    }
    Ok(())
}

/// F = strength·(v.y, −v.x): across the velocity, as on a charge in a magnetic field.
struct Magnet {
    strength: Fx,
}

impl CustomForce for Magnet {
    fn id(&self) -> u64 {
        0x006d_6167_6e65_7400
    }

    fn version(&self) -> u32 {
        1
    }

    fn depends_on(&self) -> Dependence {
        Dependence::Velocity
    }

    fn push(&self, body: &BodyState) -> Result<ForceTorque, CustomForceError> {
        let across = Vec2::new(body.velocity.y, -body.velocity.x);
        let force = across.checked_scale(self.strength).ok_or(CustomForceError { code: 1 })?;
        Ok(ForceTorque { force, torque: fx!(0) })
    }
}

pub(super) fn magnet(trial: &mut Trial) -> Played {
    let mut world = World::new(WorldDef::default())?;
    let law = Arc::new(Magnet { strength: fx!(2) });
    world.register_custom_force(law.clone())?;
    refused("a custom force twice", world.register_custom_force(law.clone()), Error::CustomForce { id: law.id() })?;
    // ω = 1/s, so a radius of 3 m around the origin.
    let start =
        BodyDef { mass: Mass::Kilograms(fx!(2)), position: vec2(0, 3), velocity: vec2(3, 0), ..BodyDef::dynamic() };
    let id = world.add_body(start)?;
    world.add_field(FieldKind::Custom { id: law.id() })?;
    let mut sides = [false; 2];
    for _ in 0..400 {
        trial.step(&mut world);
        let body = world.body(id)?;
        let (radius, speed) = (body.position().checked_length(), body.velocity().checked_length());
        // The trapezoidal rule errs by (ω·h)²/12 a radian or less, 2^-15.4, over 2π of them; times 3.
        let bound = fx!(0.005).to_bits() as u32;
        near_fx("radius", there("a radius", radius)?, fx!(3), bound)?;
        near_fx("speed", there("a speed", speed)?, fx!(3), bound)?;
        sides[usize::from(body.position().y < fx!(0))] = true;
    }
    happened("a way around", sides == [true; 2])
}

/// Nothing up to x = 3 m, and no answer beyond.
struct Cliff;

impl CustomForce for Cliff {
    fn id(&self) -> u64 {
        7
    }

    fn version(&self) -> u32 {
        2
    }

    fn depends_on(&self) -> Dependence {
        Dependence::Position
    }

    fn push(&self, body: &BodyState) -> Result<ForceTorque, CustomForceError> {
        if body.position.x > fx!(3) { Err(CustomForceError { code: 42 }) } else { Ok(ForceTorque::default()) }
    }
}

pub(super) fn custom_force_error(trial: &mut Trial) -> Played {
    let mut world = World::new(exact())?;
    world.register_custom_force(Arc::new(Cliff))?;
    let walker = world.add_body(BodyDef { velocity: vec2(1, 0), ..BodyDef::dynamic() })?;
    let field = world.add_field(FieldKind::Custom { id: 7 })?;
    trial.steps(&mut world, 192);
    happened("nothing wrong up to the edge", world.last_report().faults.is_empty())?;
    same("place at the edge", &world.body(walker)?.position(), &vec2(3, 0))?;
    trial.step(&mut world);
    let fault = Fault { body: walker, cause: Cause::CustomForce { field, code: 42 } };
    same("the fault", &world.last_report().faults, &&[fault][..])?;
    trial.steps(&mut world, 30);
    let body = world.body(walker)?;
    same("place after the fault", &(body.position(), body.activity()), &(vec2(3, 0), Activity::Quarantined))?;
    world.remove_field(field)?;
    world.release(walker)?;
    trial.steps(&mut world, 64);
    same("place after the release", &world.body(walker)?.position(), &vec2(4, 0))
}

pub(super) fn groups(trial: &mut Trial) -> Played {
    let mut world = World::new(exact())?;
    let everywhere = Region::Disc { centre: vec2(0, 0), radius: fx!(1_000_000) };
    for bit in 0..4 {
        // 1, 2, 4, 8 m/s² along x.
        let kind = FieldKind::Zone { region: everywhere, acceleration: vec2(1 << bit, 0) };
        world.add_field(ForceField { kind, force_groups: 1 << bit })?;
    }
    let ids = add_all(&mut world, (0..16).map(|force_groups| BodyDef { force_groups, ..BodyDef::dynamic() }))?;
    trial.steps(&mut world, 64);
    for (mask, &id) in (0..).zip(&ids) {
        // The accelerations of its groups add up to its mask; ½·a·1².
        same("place by groups", &world.body(id)?.position(), &vec2(Fx::from_ratio(mask, 2), 0))?;
    }
    // All into the groups they were not in: after another second all have the same velocity.
    for (mask, &id) in (0..).zip(&ids) {
        world.set_force_groups(id, 15 ^ mask)?;
    }
    trial.steps(&mut world, 64);
    for &id in &ids {
        same("velocity by groups", &world.body(id)?.velocity(), &vec2(15, 0))?;
    }
    // Bodies in no group feel nothing, as if there were no fields.
    let mut alone = World::new(exact())?;
    let free = alone.add_body(BodyDef { velocity: vec2(fx!(0.3), 1), ..BodyDef::dynamic() })?;
    let none = world.add_body(BodyDef { force_groups: 0, velocity: vec2(fx!(0.3), 1), ..BodyDef::dynamic() })?;
    for _ in 0..64 {
        trial.step(&mut world);
        alone.step();
        same_body("one in no group", (&world, none), (&alone, free))?;
    }
    Ok(())
}
