//! Scripts, and what is judged of them.

use std::collections::BTreeMap;

use umbra_oracles::{Oracle, Script, Verdict};
use umbra_physics::{BodyDef, BodyId, Command, Damping, FieldKind, Integrator, Replay, World, WorldDef, fx, vec2};

use crate::commands::Author;
use crate::random::SplitMix;
use crate::random::seeds::times;

/// Histories by day. `.ci/hunt` has a million of others.
const RUNS: u64 = 18;

/// A script by an author who sees the world as it is at each tick: bodies and fields come and go, slots are used again.
fn script(seed: u64, ticks: u64, unfair: u64) -> Script {
    let mut author = Author { random: SplitMix::seeded(seed), unfair };
    let integrator = Integrator::ALL[seed as usize % Integrator::ALL.len()];
    // Steps of one in three can be undone, at first.
    let sleep_after = if seed % 3 == 0 { None } else { Some(5) };
    let def = WorldDef { gravity: vec2(0, fx!(-1)), integrator, sleep_after, ..WorldDef::default() };
    let mut script = Script { world: def, commands: Vec::new(), ticks };
    let mut world = script.start().expect("a fair definition");
    for tick in 0..ticks {
        let count = if tick == 0 { 20 } else { author.random.next() % 4 };
        for i in 0..count {
            let command = match i % 4 {
                0..3 if tick == 0 => {
                    // What is damped or capped is not undone.
                    let (linear_damping, angular_damping, max_speed, max_angular_speed) = (None, None, None, None);
                    let body = author.body();
                    Command::AddBody(BodyDef { linear_damping, angular_damping, max_speed, max_angular_speed, ..body })
                }
                3 if tick == 0 && i < 8 => Command::AddField(author.field(&world)),
                3 if tick == 0 => author.joint(&world),
                _ => author.any(&world),
            };
            // The tick is the script's, and so is the way a step goes.
            if matches!(command, Command::SetTimeStep(_)) {
                continue;
            }
            _ = world.execute(&command);
            script.commands.push((tick, command));
        }
        world.step();
    }
    assert_eq!(script.run().map(|end| end.state_hash()), Ok(world.state_hash()));
    script
}

/// The bodies, with all of them that steps change.
fn seen(world: &World) -> Vec<String> {
    let body = |body: umbra_physics::BodyRef<'_>| {
        let (at, speed) = (body.position_exact(), body.velocity_exact());
        format!("{} {at} {speed} {} {:?}", body.user_data(), body.angle_exact(), body.activity())
    };
    world.bodies().map(body).collect()
}

#[test]
fn a_script_runs_as_its_commands_do_and_is_recorded() {
    for seed in 0..10 {
        let script = script(seed, 30, 9);
        let file = script.record().expect("a fair definition");
        let replay = Replay::from_bytes(&file, &[]).expect("it is whole");
        assert_eq!((replay.end(), replay.verify()), (30, Ok(())));
        // In whatever order the list has the ticks.
        let mut turned = script.clone();
        turned.commands.sort_by_key(|(tick, _)| std::cmp::Reverse(*tick));
        let hash = |script: &Script| script.run().expect("a fair definition").state_hash();
        assert_eq!(hash(&turned), hash(&script));
    }
    let refused = Script {
        world: WorldDef { linear_damping: Damping::kept_per_second(fx!(2)), ..WorldDef::default() },
        commands: vec![(0, Command::ClearForces)],
        ticks: 3,
    };
    assert!(refused.run().is_err() && refused.record().is_err());
    assert_eq!(refused.with(|_| true), refused);
}

#[test]
fn commands_that_are_left_out_take_no_handle_from_others() {
    let body = |user_data| Command::AddBody(BodyDef { user_data, ..BodyDef::dynamic() });
    let handle = BodyId::from_parts;
    let at = |body| Command::SetVelocity { body, velocity: vec2(body.parts().1 as i32 + 1, body.parts().0 as i32) };
    let script = Script {
        world: WorldDef::default(),
        commands: vec![
            (0, body(0)),
            (0, body(1)),
            (0, at(handle(1, 0))),
            (1, Command::RemoveBody(handle(0, 0))),
            // Takes the slot of the one that is gone.
            (1, body(2)),
            (2, at(handle(0, 1))),
            (2, at(handle(0, 0))),
            (9, at(handle(0, 1))),
        ],
        ticks: 4,
    };
    let end = |script: &Script| {
        let world = script.run().expect("a fair definition");
        let bodies = world.bodies().map(|body| (body.user_data(), body.velocity()));
        let mut bodies: Vec<_> = bodies.collect();
        bodies.sort_by_key(|(data, _)| *data);
        bodies
    };
    assert_eq!(end(&script), [(1, vec2(1, 1)), (2, vec2(2, 0))]);
    assert_eq!(script.with(|_| true), script);
    // Neither the first body nor its removal: the others stand in other slots, and are named by them.
    let without = script.with(|index| index != 0 && index != 3);
    assert_eq!(without.commands[1].1, Command::SetVelocity { body: handle(0, 0), velocity: vec2(1, 1) });
    assert_eq!(without.commands[3].1, Command::SetVelocity { body: handle(1, 0), velocity: vec2(2, 0) });
    assert_eq!(without.commands[5].1, Command::SetVelocity { body: handle(1, 0), velocity: vec2(2, 0) });
    assert_eq!(end(&without), end(&script));
    // Nobody is hit by what was for the last body.
    let without = script.with(|index| index != 4);
    assert_eq!(end(&without), [(1, vec2(1, 1))]);
    let without = script.with(|index| index != 3);
    assert_eq!(end(&without), [(0, vec2(1, 0)), (1, vec2(1, 1)), (2, vec2(2, 0))]);
}

#[test]
fn leaving_out_what_was_refused_changes_nothing() {
    for seed in 0..30 {
        let script = script(seed, 25, 6);
        let mut world = script.start().expect("a fair definition");
        let mut accepted = Vec::new();
        for tick in 0..script.ticks {
            accepted.extend(script.commands_of(tick).map(|command| world.execute(command).is_ok()));
            world.step();
        }
        assert!(accepted.contains(&false), "all were fair");
        let fair = script.with(|index| accepted[index]);
        assert_eq!(seen(&fair.run().expect("a fair definition")), seen(&world));
    }
}

#[test]
fn a_run_without_ticks_is_judged_by_nobody() {
    let script = Script { ticks: 0, ..script(0, 9, 0) };
    for oracle in Oracle::ALL {
        let verdict = script.judge(oracle).expect("nothing happens");
        assert!(matches!(verdict, Verdict::Inapplicable { .. }), "{oracle}");
    }
}

#[test]
fn a_law_that_names_a_body_names_it_still() {
    let handle = BodyId::from_parts;
    let spring = umbra_physics::SpringConstants { rest: fx!(1), stiffness: fx!(2), damping: fx!(0) };
    let far = umbra_physics::End::Body(umbra_physics::Attachment::centre(handle(2, 0)));
    let law = FieldKind::Spring { near: umbra_physics::Attachment::centre(handle(1, 0)), far, spring };
    let mut commands: Vec<_> = (0..3).map(|_| (0, Command::AddBody(BodyDef::dynamic()))).collect();
    commands.push((0, Command::AddField(law.into())));
    commands.push((1, Command::RemoveField(umbra_physics::FieldId::from_parts(0, 0))));
    let script = Script { world: WorldDef::default(), commands, ticks: 2 };
    let without = script.with(|index| index != 0);
    let named = |law: &FieldKind| match law {
        FieldKind::Spring { near: start, far: umbra_physics::End::Body(end), .. } => (start.body, end.body),
        _ => panic!("it was a spring"),
    };
    let Command::AddField(field) = &without.commands[2].1 else { panic!("it adds a field") };
    assert_eq!(named(&field.kind), (handle(0, 0), handle(1, 0)));
    assert_eq!(without.run().expect("a fair definition").fields().count(), 0);
    // Without one of its ends it is refused, and there is no field to remove.
    let without = script.with(|index| index != 2);
    assert_eq!(without.run().expect("a fair definition").fields().count(), 0);
    assert!(without.start().expect("a fair definition").check(&without.commands[2].1).is_err());
}

/// Drags act in the order in which the fields were added, also those that were something else then.
#[test]
fn fields_that_become_drags_are_in_no_other_order() {
    let handle = umbra_physics::FieldId::from_parts;
    let drag = |factor| FieldKind::Drag { linear: fx!(1), quadratic: factor, wind: vec2(factor, 0) };
    let zone = FieldKind::Zone {
        region: umbra_physics::Region::Disc { centre: vec2(0, 0), radius: fx!(9) },
        acceleration: vec2(0, 1),
    };
    let mut commands = vec![(0, Command::AddBody(BodyDef { velocity: vec2(5, 0), ..BodyDef::dynamic() }))];
    commands.extend([(0, Command::AddField(zone.into())), (0, Command::AddField(zone.into()))]);
    let set = |slot, factor| Command::SetField { id: handle(slot, 0), field: drag(factor).into() };
    let mut script = Script { world: WorldDef::default(), commands, ticks: 3 };
    assert_eq!(script.judge(Oracle::Order), Ok(Verdict::Held));
    script.commands.extend([(1, set(0, fx!(1))), (1, set(1, fx!(3)))]);
    assert!(matches!(script.judge(Oracle::Order), Ok(Verdict::Inapplicable { .. })));
    // Bodies still are.
    script.commands.insert(1, (0, Command::AddBody(BodyDef { key: 1, ..BodyDef::dynamic() })));
    assert_eq!(script.judge(Oracle::Order), Ok(Verdict::Held));
}

#[test]
fn every_oracle_holds_of_scripts_and_has_something_to_judge() {
    let mut held = BTreeMap::new();
    for seed in 0..times(RUNS) {
        for unfair in [0, 12] {
            let script = script(seed, 40, unfair);
            for oracle in Oracle::ALL {
                match script.judge(oracle) {
                    Ok(verdict) => *held.entry(oracle).or_insert(0) += u64::from(verdict == Verdict::Held),
                    Err(violation) => {
                        let smallest = script.shrunk(oracle, 5_000);
                        panic!("seed {seed}, unfair {unfair}: {violation}; small: {smallest:#?}");
                    }
                }
            }
        }
    }
    for (oracle, held) in held {
        // Their fields and kinematic bodies do work. `energy.rs` has worlds without.
        let is_on = oracle != Oracle::Energy && (oracle != Oracle::Threads || cfg!(feature = "parallel"));
        // Few can be undone: of a third, those with three of the integrators, until something damps. Of some seeds it is one.
        let required_runs = if oracle == Oracle::Reverse { 1 } else { times(RUNS).div_ceil(10) };
        assert!(!is_on || held >= required_runs, "{oracle} had something to judge in {held} runs");
    }
}

/// Once the first body stands at zero, the second command is needed no more.
#[test]
fn calls_that_simpler_values_make_superfluous_are_left_out() {
    let add = |x| Command::AddBody(BodyDef { position: vec2(x, 0), ..BodyDef::dynamic() });
    let commands = vec![(0, add(fx!(3.3))), (0, Command::ClearForces)];
    let script = Script { world: WorldDef::default(), commands, ticks: 1 };
    let fails = |script: &Script| {
        let (first, others) = script.commands.split_first()?;
        let is_first = matches!(&first.1, Command::AddBody(def) if def.position.x == fx!(0) || !others.is_empty());
        is_first.then_some(0)
    };
    let least = script.shrunk_by(1_000, fails).expect("it fails");
    assert!(matches!(&least.commands[..], [(0, Command::AddBody(def))] if def.position == vec2(0, 0)), "{least:?}");
    // With few tries it is still a script that fails.
    for tries in 1..60 {
        let tried = std::cell::Cell::new(0);
        let counted = |script: &Script| {
            tried.set(tried.get() + 1);
            fails(script)
        };
        let smaller = script.shrunk_by(tries, counted).expect("the first try is the script itself");
        assert!(fails(&smaller).is_some() && tried.get() <= tries, "{tries}");
    }
}

/// Threads share free bodies, and with published Verlet no body is free.
#[test]
fn threads_are_judged_only_of_steps_that_use_them() {
    let commands = vec![(0, Command::AddBody(BodyDef { velocity: vec2(1, 0), ..BodyDef::dynamic() }))];
    let verdict = |integrator, ticks| {
        let world = WorldDef { integrator, ..WorldDef::default() };
        Script { world, commands: commands.clone(), ticks }.judge(Oracle::Threads)
    };
    assert!(matches!(verdict(Integrator::PublishedVerlet, 3), Ok(Verdict::Inapplicable { .. })));
    if cfg!(feature = "parallel") {
        assert_eq!(verdict(Integrator::VelocityVerlet, 3), Ok(Verdict::Held));
    }
}
