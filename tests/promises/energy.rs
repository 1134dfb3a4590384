//! The energy of bodies that meet in a closed room never exceeds that after the last input.

use proptest::prelude::*;
use umbra_oracles::Oracle;
use umbra_physics::{BodyDef, BodyKind, Fx, Integrator, Shape, TimeStep, Vec2, WorldDef, vec2};

use crate::promises::check::{judge, there_is};
use crate::promises::plan::{FAIR, Plan, Taste};

/// Half of the inner width and height of the room, m.
const HALF: i32 = 7;

const CROWDED: Taste = Taste { near: 0, changes: false, colliding: true, bodies: 12, ticks: 90, ..FAIR };

/// The walls of the room.
fn walls() -> [BodyDef; 4] {
    let wall = |x: i32, y: i32, width: i32, height: i32| {
        let shape = Shape::rectangle(width, height).expect("a rectangle");
        BodyDef { position: vec2(x, y), ..BodyDef::fixed().with_collider(shape) }
    };
    let (middle, length) = (HALF + 1, 2 * HALF + 4);
    [wall(0, -middle, length, 2), wall(0, middle, length, 2), wall(-middle, 0, 2, length), wall(middle, 0, 2, length)]
}

/// A body in the room that does not move by itself, carry others along or dominate them.
fn passive(def: BodyDef) -> BodyDef {
    let is_kinematic = def.kind == BodyKind::Kinematic;
    let mut def = BodyDef { position: def.position / 4, dominance: 0, ..def };
    if is_kinematic {
        (def.velocity, def.angular_velocity) = (Vec2::ZERO, Fx::ZERO);
    }
    def.colliders.iter_mut().for_each(|collider| collider.material.surface_speed = Fx::ZERO);
    def
}

/// Runs that the oracle judges: pushes at first, and then nothing.
fn crowds() -> impl Strategy<Value = Plan> {
    CROWDED.plan().prop_map(|plan| {
        let integrator = match plan.world.integrator {
            Integrator::ExplicitEuler | Integrator::PublishedVerlet => Integrator::VelocityVerlet,
            integrator => integrator,
        };
        let (num, den) = plan.world.time_step.seconds();
        let time_step = if 30 * num > den { TimeStep::hz(60) } else { plan.world.time_step };
        let bodies = walls().into_iter().chain(plan.bodies.into_iter().map(passive)).collect();
        let deeds = plan.deeds.into_iter().map(|(tick, command)| (tick / 3, command)).collect();
        Plan { world: WorldDef { integrator, time_step, ..plan.world }, bodies, fields: Vec::new(), deeds, ..plan }
    })
}

#[test]
fn bodies_that_nobody_pushes_gain_no_energy() {
    judge("energy", 30, crowds(), Oracle::Energy);
}

#[test]
#[ignore = "a search of some minutes"]
fn bodies_that_nobody_pushes_gain_no_energy_in_many_worlds() {
    judge("energy", 2_000, crowds(), Oracle::Energy);
}

/// In some of the runs bodies meet while the oracle judges them.
#[test]
fn crowds_meet() {
    let meet = |plan: &Plan| {
        let script = plan.script();
        let end = script.run().expect("a fair world");
        let is_touching =
            end.contacts().any(|contact| contact.points().iter().any(|point| point.normal_impulse > Fx::ZERO));
        is_touching && script.judge(Oracle::Energy) == Ok(umbra_oracles::Verdict::Held)
    };
    assert!(there_is(crowds(), meet));
}
