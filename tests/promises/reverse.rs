//! P9: a run of steps that have an inverse is undone to its first bit.

use umbra_oracles::{Oracle, Script};
use umbra_physics::{Activity, Error, Irreversible};

use crate::promises::check::{Verdict, check, judge, there_is};
use crate::promises::plan::{FAIR, Plan, Taste};

const REVERSIBLE: Taste = Taste { near: 2, reversible: true, changes: false, ticks: 80, ..FAIR };

/// Goes all the way, and back as far as everybody stayed within the envelope.
fn goes_there_and_back(script: &Script) -> Verdict {
    let mut world = script.start().map_err(|error| error.to_string())?;
    let mut ticks = Vec::new();
    for tick in 0..script.ticks {
        script.commands_of(tick).for_each(|command| _ = world.execute(command));
        let before = world.state_hash();
        let applied = world.step().applied.to_vec();
        ticks.push((before, applied));
    }
    let after = world.state_hash();
    while let Some((before, applied)) = ticks.pop() {
        let hash_after = world.state_hash();
        let quarantined = world.bodies().any(|body| body.activity() == Activity::Quarantined);
        match world.step_back(&applied) {
            Ok(()) if quarantined => return Err("what left the envelope came back".to_owned()),
            Ok(()) => {}
            Err(Error::NotReversible { why: Irreversible::Quarantined { .. } | Irreversible::Fault(_) })
                if quarantined =>
            {
                if world.state_hash() != hash_after {
                    return Err("refused, but something changed".to_owned());
                }
                return Ok(());
            }
            Err(error) => return Err(format!("tick {} is not undone: {error}", world.tick())),
        }
        if world.state_hash() != before {
            return Err(format!("another state at tick {}", world.tick()));
        }
        // Forces wait for the step that was undone: before another one is, they are taken back.
        world.clear_forces();
    }
    // And there once more.
    while world.tick() < script.ticks {
        let tick = world.tick();
        let start =
            |command: &&umbra_physics::Command| tick > 0 || matches!(command, umbra_physics::Command::Apply { .. });
        script.commands_of(tick).filter(start).for_each(|command| _ = world.execute(command));
        world.step();
    }
    if world.state_hash() == after { Ok(()) } else { Err("the way there is another one the second time".to_owned()) }
}

#[test]
fn a_run_is_undone_to_its_first_bit() {
    check("reverse", 100, REVERSIBLE.plan(), goes_there_and_back);
}

#[test]
fn any_step_is_undone_or_nothing_changes() {
    judge("reverse", 40, REVERSIBLE.plan(), Oracle::Reverse);
    // In few of these there is a step that can be undone, and in many one that cannot.
    let any = Taste { near: 3, ..FAIR }.plan();
    check("reverse-any", 40, any, |script| {
        script.judge(Oracle::Reverse).map(drop).map_err(|violation| violation.to_string())
    });
}

#[test]
fn a_run_that_loses_something_is_not_undone() {
    let damped = Taste { reversible: false, ..REVERSIBLE };
    assert!(there_is(damped.plan(), |plan: &Plan| goes_there_and_back(&plan.script()).is_err()));
}
