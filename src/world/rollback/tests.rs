use alloc::vec;
use alloc::vec::Vec;

use super::*;
use crate::body::BodyDef;
use crate::cases::run_seed;
use crate::fx::{Fx, fx};
use crate::math::{Random, vec2};
use crate::slots::BodyId;
use crate::world::{ApplyOptions, ForceOrImpulse, WorldDef};

const PLAYERS: u32 = 3;

type Buttons = u8;

fn level() -> World {
    let mut world: World = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() }).expect("a world");
    for x in 0..PLAYERS {
        world.add_body(BodyDef { position: vec2(10 * x as i32, 0), ..BodyDef::dynamic() }).expect("a body");
    }
    world
}

fn ship(player: u32) -> BodyId {
    BodyId::from_parts(player, 0)
}

/// A tick with rules: a push that depends on the velocity, shots that are added and removed, a draw of a random number, a blob.
fn tick(world: &mut World, inputs: &[(u32, Buttons)]) {
    let old: Vec<BodyId> =
        world.bodies().filter(|body| body.key() != 0 && body.key() + 6 < world.tick()).map(|b| b.id()).collect();
    old.into_iter().for_each(|shot| world.remove_body(shot).expect("a shot"));
    for &(player, buttons) in inputs {
        let body = world.body(ship(player)).expect("a ship");
        let (position, is_slow) = (body.position(), body.velocity().y < fx!(5));
        if buttons & 1 != 0 && is_slow {
            world.apply_impulse(ship(player), vec2(0, 1)).expect("a push");
        }
        if buttons & 2 != 0 {
            let x = Fx::from(world.random_mut().below(5) as i32);
            let key = world.tick() + 1;
            world.add_body(BodyDef { position, velocity: vec2(x, 30), key, ..BodyDef::dynamic() }).expect("a shot");
        }
        if buttons & 4 != 0 {
            let mut blob = world.blob().to_vec();
            blob.push(player as u8);
            world.set_blob(&blob).expect("a short blob");
        }
    }
}

/// The buttons of a player in a tick; they are held for a few ticks, so that many predictions are right.
fn buttons(player: u32, tick: u64) -> Buttons {
    let mut random = Random::seeded(run_seed(tick / 5 * 64 + u64::from(player)));
    random.below(8) as u8
}

fn inputs(tick: u64) -> Vec<(u32, Buttons)> {
    (0..PLAYERS).map(|player| (player, buttons(player, tick))).collect()
}

/// The worlds after each tick of a match in which no input is late.
fn straight(ticks: u64) -> Vec<World> {
    let mut world = level();
    let step = |now| {
        tick(&mut world, &inputs(now));
        world.step();
        world.clone()
    };
    (0..ticks).map(step).collect()
}

#[test]
fn late_inputs_in_any_order_lead_where_inputs_in_time_lead() {
    const TICKS: u64 = 200;
    let expected = straight(TICKS);
    for seed in 0..20 {
        let mut random = Random::seeded(run_seed(seed));
        let mut world = level();
        let mut rollback = Rollback::new(&world, 0..PLAYERS, 8);
        // (when it arrives, tick, player); the ticks of player 0 are in time.
        let mut mail: Vec<(u64, u64, u32)> = Vec::new();
        for tick in 0..TICKS {
            mail.extend((1..PLAYERS).map(|player| (tick + random.below(12), tick, player)));
        }
        let (mut confirmed, mut redone) = (Vec::new(), 0);
        let mut now = 0;
        while rollback.first_unconfirmed() < TICKS {
            for &(_, tick, player) in mail.iter().filter(|(arrives, ..)| *arrives == now) {
                assert_eq!(rollback.add_input(tick, player, buttons(player, tick)), Ok(true));
            }
            _ = rollback.add_input(rollback.present(), 0, buttons(0, rollback.present())).expect("a player");
            let before = rollback.present();
            let report = rollback.advance(&mut world, tick).expect("nothing else changes the world");
            redone += report.redone;
            for tick in report.confirmed() {
                assert_eq!((tick.tick, tick.inputs), (confirmed.len() as u64, &inputs(tick.tick)[..]), "seed {seed}");
                confirmed.push(tick.after.state_hash());
            }
            assert_eq!(report.waits_for.is_some(), rollback.present() == before);
            assert!(rollback.present() - rollback.first_unconfirmed() <= 8);
            let end = rollback.first_unconfirmed();
            if end > 0 && end <= TICKS {
                assert_eq!(rollback.confirmed_world(&world).state_hash(), expected[end as usize - 1].state_hash());
            }
            now += 1;
            // Past the end everything is known at once.
            mail.extend(
                (0..PLAYERS).filter(|_| rollback.present() >= TICKS).map(|player| (now, rollback.present(), player)),
            );
        }
        assert!(redone > 100, "seed {seed}: {redone}");
        for (hash, world) in confirmed.iter().zip(&expected) {
            assert_eq!(*hash, world.state_hash(), "seed {seed}");
        }
    }
}

#[test]
fn a_window_of_zero_waits_for_all_inputs() {
    let mut world = level();
    let mut rollback = Rollback::new(&world, [2, 0, 1, 1], 0);
    for now in 0..20 {
        assert_eq!(rollback.advance(&mut world, tick).expect("unchanged").waits_for, Some(0));
        for player in 0..PLAYERS {
            assert_eq!(world.tick(), now);
            rollback.add_input(now, player, buttons(player, now)).expect("a player");
        }
        let report = rollback.advance(&mut world, tick).expect("unchanged");
        assert_eq!((report.redone, report.waits_for, report.confirmed().len()), (0, None, 1));
    }
    assert_eq!(world.state_hash(), straight(20)[19].state_hash());
}

#[test]
fn changes_outside_of_the_tick_function_are_noticed() {
    let advanced = || {
        let mut world = level();
        let mut rollback = Rollback::<Buttons>::new(&world, [0], 8);
        rollback.advance(&mut world, |_, _| ()).expect("the first tick");
        (world, rollback)
    };
    let foreign = level();
    let changes: [&dyn Fn(&mut World); 7] = [
        &|world| world.set_velocity(ship(0), vec2(1, 0)).expect("a velocity"),
        &|world| world.set_blob(&[1]).expect("a blob"),
        &|world| _ = world.random_mut().below(3),
        &|world| _ = world.step(),
        &|world| world.restore(&foreign.snapshot()),
        &|world| world.clear_forces(),
        // Nobody can tell whether it was changed before.
        &|world| *world = world.clone(),
    ];
    for (i, change) in changes.into_iter().enumerate() {
        let (mut world, mut rollback) = advanced();
        change(&mut world);
        let before = world.state_hash();
        let refused = rollback.advance(&mut world, |_, _| ()).expect_err("a change");
        assert_eq!(refused, Error::ChangedBetweenTicks { tick: 1 }, "{i}");
        assert_eq!(world.state_hash(), before);
        rollback.restart(&world);
        rollback.advance(&mut world, |_, _| ()).expect("goes on from there");
    }
    // A refused call changes nothing.
    let (mut world, mut rollback) = advanced();
    assert!(world.set_velocity(BodyId::from_parts(9, 9), vec2(0, 0)).is_err());
    rollback.advance(&mut world, |_, _| ()).expect("nothing has changed");

    let (mut world, mut rollback) = advanced();
    let stepped = rollback.advance(&mut world, |world, _| _ = world.step());
    assert_eq!(stepped.err(), Some(Error::SteppedInTick { tick: 1 }));
    assert!(rollback.advance(&mut world, |_, _| ()).is_err());
    // Another world than the one at the start.
    let mut world = level();
    let mut rollback = Rollback::<Buttons>::new(&world, [0], 8);
    world.step();
    assert_eq!(rollback.advance(&mut world, |_, _| ()).err(), Some(Error::ChangedBetweenTicks { tick: 0 }));
}

#[test]
fn inputs_are_taken_once_and_within_bounds() {
    let world = level();
    let mut rollback = Rollback::new(&world, [1, 4], 8);
    assert_eq!(rollback.add_input(0, 2, 0u8), Err(Error::NoSuchPlayer { player: 2 }));
    assert_eq!(rollback.add_input(3, 4, 1), Ok(true));
    assert_eq!(rollback.add_input(3, 4, 2), Ok(false));
    let far = Rollback::<Buttons>::AHEAD;
    assert_eq!(rollback.add_input(far, 1, 0), Ok(true));
    assert_eq!(rollback.add_input(far + 1, 1, 0), Err(Error::TickToCome { tick: far + 1, present: 0 }));
    assert_eq!(rollback.add_input(u64::MAX, 1, 0), Err(Error::TickToCome { tick: u64::MAX, present: 0 }));
}

#[test]
fn a_player_who_leaves_is_not_waited_for() {
    let mut world = level();
    let mut rollback = Rollback::new(&world, [0, 1], 4);
    for now in 0..3 {
        rollback.add_input(now, 0, 1).expect("a player");
        rollback.advance(&mut world, tick).expect("unchanged");
    }
    rollback.add_input(0, 1, 1).expect("a player");
    rollback.remove_player(1, 2).expect("not confirmed");
    rollback.add_input(1, 1, 1).expect("a player");
    assert_eq!(rollback.add_input(2, 1, 1), Ok(false));
    let report = rollback.advance(&mut world, tick).expect("unchanged");
    let players: Vec<Vec<u32>> =
        report.confirmed().map(|tick| tick.inputs.iter().map(|(player, _)| *player).collect()).collect();
    assert_eq!(players, [vec![0, 1], vec![0, 1], vec![0]]);
    // A player who is gone does not come back by a later end.
    rollback.remove_player(1, 9).expect("gone already");
    assert_eq!(rollback.add_input(5, 1, 1), Ok(false));
    assert_eq!(rollback.remove_player(1, 0), Err(Error::TickForgotten { tick: 0, oldest: 3 }));
    assert_eq!(rollback.remove_player(9, 9), Err(Error::NoSuchPlayer { player: 9 }));
    let mut expected = level();
    for inputs in [&[(0, 1), (1, 1)][..], &[(0, 1), (1, 1)], &[(0, 1)], &[(0, 1)]] {
        tick(&mut expected, inputs);
        expected.step();
    }
    assert_eq!(world.state_hash(), expected.state_hash());
}

#[test]
fn the_confirmed_world_does_not_depend_on_inputs_added_since() {
    let mut world = level();
    let mut rollback = Rollback::new(&world, [0, 1], 8);
    for now in 0..4 {
        rollback.add_input(now, 0, 1).expect("a player");
        rollback.advance(&mut world, tick).expect("unchanged");
    }
    // Ticks 0 to 2 have all inputs now, but were made with predictions that were wrong.
    (0..3).for_each(|now| assert_eq!(rollback.add_input(now, 1, 1), Ok(true)));
    assert_eq!(rollback.confirmed_world(&world).state_hash(), level().state_hash());
    rollback.advance(&mut world, tick).expect("unchanged");
    let mut expected = level();
    for _ in 0..3 {
        tick(&mut expected, &[(0, 1), (1, 1)]);
        expected.step();
    }
    assert_eq!(rollback.confirmed_world(&world).state_hash(), expected.state_hash());
}

#[test]
fn a_restart_may_be_followed_by_waiting() {
    let mut world = level();
    let mut rollback = Rollback::<Buttons>::new(&world, [0], 0);
    rollback.add_input(0, 0, 1).expect("a player");
    rollback.advance(&mut world, tick).expect("unchanged");
    world.set_velocity(ship(0), vec2(1, 0)).expect("a velocity");
    rollback.restart(&world);
    assert_eq!(rollback.advance(&mut world, tick).expect("restarted").waits_for, Some(0));
    rollback.add_input(1, 0, 1).expect("a player");
    assert_eq!(rollback.advance(&mut world, tick).expect("unchanged").waits_for, None);
}

#[test]
fn predictions_are_the_last_input_or_what_the_game_says() {
    let predicted = |rollback: Rollback<Buttons>| {
        let (mut world, mut rollback, mut predictions) = (level(), rollback, Vec::new());
        rollback.add_input(0, 0, 3).expect("a player");
        for _ in 0..3 {
            rollback.advance(&mut world, |_, inputs| predictions.push(inputs[0].1)).expect("unchanged");
        }
        predictions
    };
    assert_eq!(predicted(Rollback::new(&level(), [0], 8)), [3, 3, 3]);
    assert_eq!(predicted(Rollback::new(&level(), [0], 8).with_prediction(|last| last & 1)), [3, 1, 1]);
}

#[test]
fn events_are_new_seen_before_or_undone() {
    use EventStatus::{New, SeenBefore, Undone};
    let mut world = level();
    let mut rollback = Rollback::new(&world, [0, 1], 8);
    let game = |world: &mut World, inputs: &[(u32, Buttons)]| {
        for (player, _) in inputs.iter().filter(|(_, held)| *held == 1) {
            world.add_body(BodyDef { key: u64::from(*player), ..BodyDef::dynamic() }).expect("a body");
        }
    };
    rollback.advance(&mut world, game).expect("the level");
    for held in [1, 0] {
        rollback.add_input(rollback.present(), 0, held).expect("a player");
        rollback.advance(&mut world, game).expect("unchanged");
    }
    // Player 0 pressed in tick 1, and was predicted to press nothing in tick 0, as is now known.
    rollback.add_input(0, 0, 0).expect("a player");
    rollback.add_input(1, 1, 1).expect("a player");
    let report = rollback.advance(&mut world, game).expect("unchanged");
    let events: Vec<(u64, EventStatus)> = report.events.iter().map(|event| (event.tick, event.status)).collect();
    // Tick 1 is made again, with two bodies. Player 1 is predicted to press on.
    assert_eq!(events, [(1, SeenBefore), (1, New), (2, New), (3, New)]);
    rollback.add_input(2, 1, 0).expect("a player");
    let report = rollback.advance(&mut world, game).expect("unchanged");
    let events: Vec<(u64, EventStatus)> = report.events.iter().map(|event| (event.tick, event.status)).collect();
    assert_eq!(events, [(2, Undone), (3, Undone)]);
}

#[test]
fn every_call_is_noted_as_the_command_that_it_is() {
    use crate::world::Command::*;
    let body = ship(0);
    let commands: Vec<Command> = vec![
        AddBody(BodyDef::dynamic()),
        Apply { body, action: ForceOrImpulse::Torque(fx!(1)), options: ApplyOptions::default() },
        SetPosition { body, position: vec2(1, 2) },
        SetUserData { body, user_data: 3 },
        SetKey { body, key: 5 },
        Disable(body),
        Enable(body),
        SetGravity(vec2(0, -3)),
        SetRandom(Random::seeded(3)),
        SetBlob(vec![1, 2]),
        ClearForces,
        RemoveBody(body),
    ];
    let mut world = level();
    let mut rollback = Rollback::<Buttons>::new(&world, [], 0);
    let report = rollback
        .advance(&mut world, |world, _| {
            for command in &commands {
                world.execute(command).expect("in order");
            }
            // A refused one is not noted.
            assert!(world.execute(&Wake(body)).is_err());
        })
        .expect("unchanged");
    assert_eq!(report.confirmed().next().expect("nobody is missing").commands, commands);
}
