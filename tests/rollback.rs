//! A match whose inputs arrive late ends where it would have ended had they been there in time, to the bit, tick by tick.

#[path = "support/commands.rs"]
#[allow(dead_code, reason = "this test checks no commands one by one")]
mod commands;
#[path = "support/random.rs"]
mod random;

use std::collections::BTreeSet;

use commands::{Author, KINDS};
use random::SplitMix;
use umbra_oracles::{Generator, Taste};
use umbra_physics::{
    Activity, BodyDef, BodyId, Command, Created, Error, Fault, Fx, Input, InputResult, Inputs, Integrator,
    RecordOptions, Recorder, Replay, Rollback, TimeStep, Vec2, World, WorldDef, fx, limits, vec2,
};

const PLAYERS: u32 = 3;

/// Everything that can be seen of a tick.
#[derive(Clone, Debug, PartialEq)]
struct Seen {
    state: u64,
    outcomes: Vec<InputResult>,
    faults: Vec<Fault>,
    fell_asleep: Vec<BodyId>,
    woke: Vec<BodyId>,
    drag_outside: u32,
}

/// The last tick of a world, and the results of its inputs.
fn seen(world: &World, outcomes: &[InputResult]) -> Seen {
    let step = world.last_report();
    assert_eq!(step.tick, world.tick());
    Seen {
        state: world.state_hash(),
        outcomes: outcomes.to_vec(),
        faults: step.faults.to_vec(),
        fell_asleep: step.fell_asleep.to_vec(),
        woke: step.woke.to_vec(),
        drag_outside: step.drag_outside,
    }
}

/// A match as it should have been: what each player did in each tick, and what came of it.
struct Match {
    start: World,
    inputs: Vec<[Vec<Command>; PLAYERS as usize]>,
    seen: Vec<Seen>,
}

fn all_of(commands: &[Vec<Command>; PLAYERS as usize]) -> Inputs {
    let mut inputs = Inputs::new();
    for (player, commands) in (0..).zip(commands) {
        for (sequence, command) in (0..).zip(commands) {
            inputs.insert(Input { player, sequence, command: command.clone() }).expect("each has its place");
        }
    }
    inputs
}

/// Inputs of a player in a tick: mostly pushes, sometimes any command, sometimes a body is thrown out of the allowed range.
/// Most ticks have none, because cached values live from one change to the next.
fn moves(author: &mut Author, quiet: u64, world: &World) -> Vec<Command> {
    let mut commands = Vec::new();
    if !author.one_in(quiet) {
        return commands;
    }
    for _ in 0..author.random.next() % 3 {
        commands.push(if author.one_in(3) { author.any(world) } else { author.push(world) });
    }
    if author.one_in(30) {
        let body = author.some_body(world);
        commands.push(Command::SetPosition { body, position: Vec2::new(limits::POSITION, Fx::ZERO) });
        commands.push(Command::SetVelocity { body, velocity: vec2(9, 0) });
    }
    if author.one_in(8) {
        let (body, still) = (author.some_body(world), BodyDef { gravity_scale: Fx::ZERO, ..BodyDef::dynamic() });
        commands.extend([Command::AddBody(still), Command::Release(body)]);
    }
    commands
}

impl Match {
    fn play(author: &mut Author, integrator: Integrator, quiet: u64, ticks: usize) -> Self {
        let def = WorldDef { gravity: vec2(0, fx!(-1)), integrator, sleep_after: Some(2), ..WorldDef::default() };
        let mut world = World::new(def).expect("a fair definition");
        while world.bodies().count() < 8 {
            let _ = world.add_body(author.body());
            let _ = world.add_field(author.field(&world));
        }
        let start = world.clone();
        let (mut inputs, mut all) = (Vec::new(), Vec::new());
        for _ in 0..ticks {
            let commands = [(); PLAYERS as usize].map(|()| moves(author, quiet, &world));
            let outcomes = world.carry_out(&all_of(&commands));
            world.step();
            all.push(seen(&world, &outcomes));
            inputs.push(commands);
        }
        Self { start, inputs, seen: all }
    }
}

/// Number of times something happened.
#[derive(Debug, Default)]
struct Counts {
    rollbacks: usize,
    right_guesses: usize,
    waits: usize,
    returns: usize,
    added: usize,
    removed: usize,
    quarantined: usize,
    slept: usize,
    woke: usize,
    refused: usize,
}

impl Counts {
    fn add(&mut self, played: &Match) {
        for (commands, tick_log) in played.inputs.iter().zip(&played.seen) {
            let done = all_of(commands);
            for (input, outcome) in done.iter().zip(&tick_log.outcomes) {
                self.added += usize::from(matches!(outcome.result, Ok(Created::Body(_))));
                self.removed += usize::from(matches!(input.command, Command::RemoveBody(_)) && outcome.result.is_ok());
                self.refused += usize::from(outcome.result.is_err());
            }
            self.quarantined += tick_log.faults.len();
            self.slept += tick_log.fell_asleep.len();
            self.woke += tick_log.woke.len();
        }
    }
}

type Prediction = fn(&Vec<Command>) -> Vec<Command>;

/// Nothing, the same again, and something else.
const PREDICTIONS: [Prediction; 3] = [
    |_| Vec::new(),
    Vec::clone,
    |last| {
        let mut inputs = Inputs::new();
        inputs.replace(0, last.iter().cloned());
        let seed = inputs.to_bytes().iter().fold(7, |seed: u64, byte| seed.wrapping_mul(31) + u64::from(*byte));
        let (mut random, bodies) = (SplitMix(seed), [0, 1, 2, 5, 8].map(|slot| BodyId::from_parts(slot, 0)));
        let mut generator = Generator::new(&mut random, Taste::FAIR, &bodies, &[]);
        (0..2).map(|_| generator.command()).collect()
    },
];

/// The tick function of a game whose inputs are commands.
fn carry_out(world: &mut World, inputs: &[(u32, Vec<Command>)]) -> Vec<InputResult> {
    let mut outcomes = Vec::new();
    for (player, commands) in inputs {
        for (sequence, command) in (0..).zip(commands) {
            outcomes.push(InputResult { player: *player, sequence, result: world.execute(command) });
        }
    }
    outcomes
}

fn execute(world: &mut World, inputs: &[(u32, Vec<Command>)]) {
    carry_out(world, inputs);
}

/// The ticks of a match as they were made last.
struct Log {
    outcomes: Vec<Vec<InputResult>>,
    seen: Vec<Option<Seen>>,
}

impl Log {
    /// Notes the tick that led to this state. For the first tick of a rollback this is the restored state.
    fn look(&mut self, world: &World) {
        let Some(last) = world.tick().checked_sub(1).map(|tick| tick as usize) else { return };
        if let Some(place) = self.seen.get_mut(last) {
            *place = Some(seen(world, &self.outcomes[last]));
        }
    }

    fn tick(&mut self, world: &mut World, inputs: &[(u32, Vec<Command>)]) {
        self.look(world);
        let now = world.tick() as usize;
        let outcomes = carry_out(world, inputs);
        if let Some(place) = self.outcomes.get_mut(now) {
            *place = outcomes;
        }
    }
}

/// Plays a match with inputs that are late by up to two ticks more than there are in the window.
fn play_late(author: &mut Author, played: &Match, window: usize, predict: Prediction, counts: &mut Counts) {
    let ticks = played.seen.len();
    let mut world = played.start.clone();
    let mut rollback = Rollback::new(&world, 0..PLAYERS, window).with_prediction(predict);
    let mut log = Log { outcomes: vec![Vec::new(); ticks], seen: vec![None; ticks] };
    // (when it arrives, tick, player)
    let mut under_way: Vec<(usize, usize, u32)> = Vec::new();
    for tick in 0..ticks {
        let mut arrival = || tick + author.random.next() as usize % (window + 3);
        under_way.extend((0..PLAYERS).map(|player| (arrival(), tick, player)));
    }
    let (mut now, mut confirmed) = (0, 0);
    while confirmed < ticks {
        // In any order, each by itself or several at once.
        let (mut arrived, others): (Vec<_>, Vec<_>) = under_way.into_iter().partition(|(when, ..)| *when == now);
        (under_way, now) = (others, now + 1);
        let mut was_guessed = false;
        while !arrived.is_empty() {
            let (_, tick, player) = arrived.swap_remove(author.random.next() as usize % arrived.len());
            was_guessed |= (tick as u64) < rollback.present();
            let commands = played.inputs[tick][player as usize].clone();
            assert_eq!(rollback.add_input(tick as u64, player, commands), Ok(true));
        }
        let report = rollback.advance(&mut world, |world, inputs| log.tick(world, inputs)).expect("unchanged");
        counts.rollbacks += usize::from(report.redone > 0);
        counts.right_guesses += usize::from(was_guessed && report.redone == 0);
        counts.waits += usize::from(report.waits_for.is_some());
        for tick in report.confirmed() {
            assert_eq!(tick.tick, confirmed as u64);
            assert!(tick.inputs.iter().map(|(_, commands)| commands).eq(&played.inputs[confirmed]));
            assert_eq!(tick.after.state_hash(), played.seen[confirmed].state, "tick {confirmed}, a window of {window}");
            confirmed += 1;
        }
        log.look(&world);
        if author.one_in(20) {
            // Back to the last confirmed tick; the inputs after it have arrived already.
            world = rollback.confirmed_world(&world).clone();
            assert_eq!(world.tick(), confirmed as u64);
            rollback.restart(&world);
            counts.returns += 1;
        }
    }
    for (tick, (again, tick_log)) in log.seen.iter().zip(&played.seen).enumerate() {
        assert_eq!(again.as_ref(), Some(tick_log), "tick {tick}, a window of {window}");
    }
}

#[test]
fn late_inputs_lead_to_the_states_that_inputs_in_time_lead_to() {
    let mut author = Author { random: SplitMix::seeded(3), unfair: 60 };
    let mut counts = Counts::default();
    for run in 0..120 {
        let integrator = Integrator::ALL[run % Integrator::ALL.len()];
        let played = Match::play(&mut author, integrator, [1, 10][run / 5 % 2], 50);
        counts.add(&played);
        play_late(&mut author, &played, run % 17, PREDICTIONS[run % 3], &mut counts);
    }
    // Otherwise this shows less than it says.
    let Counts { rollbacks, right_guesses, waits, returns, added, removed, quarantined, slept, woke, refused } = counts;
    assert!(rollbacks > 1_000 && right_guesses > 500, "{counts:?}");
    for count in [waits, returns, added, removed, quarantined, slept, woke, refused] {
        assert!(count > 50, "{counts:?}");
    }
}

/// A tick of commands, and now and then a draw. Returns the commands that the world accepted.
fn tick_with_draws(world: &mut World, inputs: &[(u32, Vec<Command>)]) -> Vec<Command> {
    let mut accepted = Vec::new();
    for command in inputs.iter().flat_map(|(_, commands)| commands) {
        if world.execute(command).is_ok() {
            accepted.push(command.clone());
        }
    }
    if world.tick() % 5 == 3 {
        let drawn = world.random_mut().below(6);
        _ = world.set_gravity(vec2(0, -(drawn as i32)));
        accepted.extend([Command::SetGravity(vec2(0, -(drawn as i32))), Command::SetRandom(*world.random())]);
    }
    accepted
}

#[test]
fn confirmed_ticks_hold_every_accepted_command_and_make_a_replay_of_the_straight_run() {
    const TICKS: u64 = 40;
    let mut author = Author { random: SplitMix::seeded(8), unfair: 40 };
    let (mut kinds, mut redone) = (BTreeSet::new(), 0);
    for run in 0..60 {
        let start = Match::play(&mut author, Integrator::ALL[run % Integrator::ALL.len()], 1, 0).start;
        // Straight on: the inputs, the accepted commands and the states.
        let mut world = start.clone();
        let (mut inputs, mut straight) = (Vec::new(), Vec::new());
        for _ in 0..TICKS {
            let mut any = || {
                let kind = Command::NUMBERS[(author.random.next() % KINDS) as usize];
                author.of_kind(kind, &world)
            };
            let commands: Vec<(u32, Vec<Command>)> = (0..PLAYERS).map(|player| (player, vec![any(), any()])).collect();
            let accepted = tick_with_draws(&mut world, &commands);
            kinds.extend(accepted.iter().map(Command::number));
            world.step();
            inputs.push(commands);
            straight.push((accepted, world.state_hash()));
        }
        // Late, and recorded.
        let mut late = start.clone();
        let options = RecordOptions { hash_every: 3, snapshot_every: 16 };
        let mut recorder = Recorder::new(&late, options);
        let window = 1 + run % 12;
        let mut rollback = Rollback::new(&late, 0..PLAYERS, window).with_prediction(PREDICTIONS[run % 3]);
        let mut confirmed = 0;
        while confirmed < TICKS {
            for (tick, inputs) in inputs.iter().enumerate().take(rollback.present() as usize + 1) {
                for (player, commands) in inputs {
                    if author.one_in(window as u64) {
                        rollback.add_input(tick as u64, *player, commands.clone()).expect("a player");
                    }
                }
            }
            let report =
                rollback.advance(&mut late, |world, inputs| _ = tick_with_draws(world, inputs)).expect("unchanged");
            redone += report.redone;
            for tick in report.confirmed() {
                let (accepted, hash) = &straight[tick.tick as usize];
                assert_eq!(tick.commands, accepted, "tick {}", tick.tick);
                assert_eq!(tick.after.state_hash(), *hash);
                let recorded = recorder.record(&tick).expect("the next one");
                assert!(recorded.is_none_or(|recorded| recorded == *hash));
                // A tick out of turn is refused.
                if tick.tick > 0 {
                    let to_come = Error::TickToCome { tick: tick.tick, present: 0 };
                    assert_eq!(Recorder::new(&start, options).record(&tick), Err(to_come));
                }
                let forgotten = Error::TickForgotten { tick: tick.tick, oldest: tick.tick + 1 };
                assert_eq!(recorder.record(&tick), Err(forgotten));
                confirmed += 1;
            }
        }
        let file = recorder.finish(rollback.confirmed_world(&late));
        let replay = Replay::from_bytes(&file, &[]).expect("it is whole");
        assert_eq!((replay.verify(), replay.ticks()), (Ok(()), TICKS));
        let mut playback = replay.play();
        playback.seek(TICKS);
        assert_eq!(playback.world().state_hash(), world.state_hash());
    }
    assert!(redone > 5_000, "{redone}");
    assert_eq!(kinds.len() as u64, KINDS, "{kinds:?}");
}

/// A world of a body in motion.
fn small() -> (World, BodyId) {
    let mut world = World::new(WorldDef { gravity: vec2(0, -1), ..WorldDef::default() }).expect("fair");
    let body = world.add_body(BodyDef { velocity: vec2(1, 2), ..BodyDef::dynamic() }).expect("fair");
    (world, body)
}

/// A rollback over commands of player 0, and some ticks without any.
fn idle(world: &mut World, ticks: u64) -> Rollback<Vec<Command>> {
    let mut rollback = Rollback::new(world, [0], 8).with_prediction(PREDICTIONS[0]);
    for _ in 0..ticks {
        rollback.advance(world, execute).expect("unchanged");
    }
    rollback
}

fn set(body: BodyId, x: i32) -> Vec<Command> {
    vec![Command::SetVelocity { body, velocity: vec2(x, 0) }]
}

#[test]
fn inputs_of_confirmed_ticks_and_of_ticks_far_ahead_change_nothing() {
    let (mut world, body) = small();
    let mut rollback = idle(&mut world, 5);
    for tick in 0..3 {
        assert_eq!(rollback.add_input(tick, 0, Vec::new()), Ok(true));
    }
    assert_eq!(rollback.advance(&mut world, execute).expect("unchanged").confirmed().len(), 3);
    let mut straight = world.clone();
    for tick in 0..3 {
        assert_eq!(rollback.add_input(tick, 0, set(body, 9)), Ok(false));
    }
    let far = rollback.present() + Rollback::<Vec<Command>>::AHEAD + 1;
    assert_eq!(rollback.add_input(far, 0, set(body, 9)), Err(Error::TickToCome { tick: far, present: 6 }));
    assert_eq!(rollback.advance(&mut world, execute).expect("unchanged").redone, 0);
    straight.step();
    assert_eq!(world.state_hash(), straight.state_hash());
}

#[test]
fn a_world_that_went_astray_is_refused_and_what_came_late_is_of_a_past_that_it_has_no_more() {
    let (mut world, body) = small();
    let mut rollback = idle(&mut world, 4);
    rollback.add_input(2, 0, set(body, 9)).expect("a player");
    world.step();
    let mut straight = world.clone();
    let refused = rollback.advance(&mut world, execute).map(drop);
    assert_eq!(refused, Err(Error::ChangedBetweenTicks { tick: 4 }));
    assert_eq!(world.state_hash(), straight.state_hash());
    rollback.restart(&world);
    assert_eq!(rollback.advance(&mut world, execute).expect("from there").redone, 0);
    straight.step();
    assert_eq!((rollback.present(), world.state_hash()), (6, straight.state_hash()));
}

#[test]
fn late_inputs_of_several_ticks_take_one_rollback_from_the_first_of_them() {
    let (mut world, body) = small();
    let mut straight = world.clone();
    let mut rollback = idle(&mut world, 4);
    rollback.add_input(3, 0, set(body, 3)).expect("a player");
    rollback.add_input(1, 0, set(body, 7)).expect("a player");
    // The first one counts.
    assert_eq!(rollback.add_input(1, 0, set(body, 4)), Ok(false));
    assert_eq!(rollback.advance(&mut world, execute).expect("unchanged").redone, 3);
    for tick in 0..5 {
        execute(&mut straight, &[(0, [vec![], set(body, 7), vec![], set(body, 3), vec![]][tick].clone())]);
        straight.step();
    }
    assert_eq!(world.state_hash(), straight.state_hash());
}

#[test]
fn a_handle_from_a_tick_that_is_made_again_may_name_another_body() {
    let (mut world, _) = small();
    let mut rollback = Rollback::new(&world, [0, 1], 8).with_prediction(PREDICTIONS[0]);
    let mut created = Vec::new();
    let shot = |key| vec![Command::AddBody(BodyDef { key, ..BodyDef::dynamic() })];
    rollback.add_input(0, 1, shot(1)).expect("a player");
    rollback.advance(&mut world, |world, inputs| created.extend(carry_out(world, inputs))).expect("unchanged");
    rollback.add_input(0, 0, shot(2)).expect("a player");
    rollback.advance(&mut world, |world, inputs| created.extend(carry_out(world, inputs))).expect("unchanged");
    assert_eq!(created[0].result, created[1].result);
    let Ok(Created::Body(body)) = created[0].result else { panic!("{created:?}") };
    assert_eq!(world.body(body).expect("it is there").key(), 2);
    assert_eq!(world.body(body).expect("it is there").activity(), Activity::Awake);
}

#[test]
fn the_time_step_may_change_on_the_way() {
    let (mut world, _) = small();
    let mut straight = world.clone();
    let mut rollback = idle(&mut world, 8);
    for tick in 0..9 {
        if tick == 3 {
            straight.set_time_step(TimeStep::ratio(1001, 60_000)).expect("fair");
        }
        straight.step();
    }
    // It makes the ticks of the window again, and with the inputs up to there the next one.
    rollback.add_input(3, 0, vec![Command::SetTimeStep(TimeStep::ratio(1001, 60_000))]).expect("a player");
    (0..3).for_each(|tick| _ = rollback.add_input(tick, 0, Vec::new()).expect("a player"));
    assert_eq!(rollback.advance(&mut world, execute).expect("unchanged").redone, 5);
    assert_eq!((world.elapsed(), world.state_hash()), (straight.elapsed(), straight.state_hash()));
}
