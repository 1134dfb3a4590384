//! P5: nothing overflows or panics. What is unfair is refused and changes nothing; who leaves the envelope is put back.

use umbra_oracles::Script;
use umbra_physics::{Activity, BodyId, BodyRef, Fx, Vec2, World, limits};

use crate::promises::check::{Verdict, check};
use crate::promises::plan::{FAIR, Taste};

fn is_within(point: Vec2, limit: Fx) -> bool {
    (-limit..=limit).contains(&point.x) && (-limit..=limit).contains(&point.y)
}

fn bits(body: &BodyRef<'_>) -> impl PartialEq {
    (body.position_exact(), body.velocity_exact(), body.angle_exact(), body.angular_velocity_exact())
}

/// Asserts that after a step each body is within range, and newly quarantined ones are where they were before.
fn is_sound(before: &World, after: &World) -> Verdict {
    let faults: Vec<BodyId> = after.last_report().faults.iter().map(|fault| fault.body).collect();
    for body in after.bodies() {
        let id = body.id();
        let inside = is_within(body.position(), limits::POSITION)
            && is_within(body.velocity(), limits::SPEED)
            && (-limits::ANGULAR_SPEED..=limits::ANGULAR_SPEED).contains(&body.angular_velocity());
        if !inside {
            return Err(format!("{id} is outside of the envelope: {:?}, {:?}", body.position(), body.velocity()));
        }
        let was = before.body(id).map_err(|error| error.to_string())?;
        let fell_out = body.activity() == Activity::Quarantined && was.activity() != Activity::Quarantined;
        if fell_out != faults.contains(&id) {
            return Err(format!("{id}: quarantined {fell_out}, but the report says {faults:?}"));
        }
        if fell_out && bits(&body) != bits(&was) {
            return Err(format!("{id} was not put back to its last good state"));
        }
    }
    Ok(())
}

fn nothing_unfair_passes(script: &Script) -> Verdict {
    let mut world = script.start().map_err(|error| error.to_string())?;
    for tick in 0..script.ticks {
        for command in script.commands_of(tick) {
            let before = world.state_hash();
            let said = world.check(command);
            let done = world.execute(command);
            if said != done.map(drop) {
                return Err(format!("tick {tick}: `check` says {said:?}, `execute` {done:?}, of {command:?}"));
            }
            if done.is_err() && world.state_hash() != before {
                return Err(format!("tick {tick}: refused, but something changed: {command:?}"));
            }
        }
        let before = world.clone();
        world.step();
        is_sound(&before, &world).map_err(|why| format!("tick {tick}: {why}"))?;
        // These add up over all bodies: they may have no answer, and do no harm.
        let _ = (world.energy(), world.momentum(), world.angular_momentum());
    }
    Ok(())
}

#[test]
fn values_beyond_the_limits_are_refused_or_quarantined() {
    let tastes =
        [Taste { near: 8, unfair: 8, ..FAIR }, Taste { near: 30, unfair: 0, ..FAIR }, Taste { unfair: 2, ..FAIR }];
    for taste in tastes {
        check("envelope", 100, taste.plan(), nothing_unfair_passes);
    }
}
