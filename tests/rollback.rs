//! A match whose inputs arrive late ends where it would have ended had they been there in time, to the bit, tick by tick.

#[path = "support/commands.rs"]
#[allow(dead_code, reason = "this test checks no commands one by one")]
mod commands;
#[path = "support/random.rs"]
mod random;

use commands::Author;
use random::SplitMix;
use umbra_physics::{
    Activity, BodyDef, BodyId, Command, Created, Error, Fault, Fx, History, Input, InputResult, Inputs, Integrator,
    TickReport, TimeStep, Vec2, World, WorldDef, fx, limits, vec2,
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

fn seen(tick: &TickReport<'_>) -> Seen {
    assert_eq!(tick.step.tick, tick.world.tick());
    Seen {
        state: tick.world.state_hash(),
        outcomes: tick.outcomes.to_vec(),
        faults: tick.step.faults.to_vec(),
        fell_asleep: tick.step.fell_asleep.to_vec(),
        woke: tick.step.woke.to_vec(),
        drag_outside: tick.step.drag_outside,
    }
}

/// A match as it should have been: what each player did in each tick, and what came of it.
struct Match {
    start: World,
    /// A player does something in one tick of so many.
    quiet: u64,
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
            all.push(seen(&TickReport { outcomes: &outcomes, step: world.last_report(), world: &world }));
            inputs.push(commands);
        }
        Self { start, quiet, inputs, seen: all }
    }
}

/// Number of times something happened.
#[derive(Debug, Default)]
struct Counts {
    rollbacks: usize,
    wrong_guesses: usize,
    right_guesses: usize,
    added: usize,
    removed: usize,
    quarantined: usize,
    slept: usize,
    woke: usize,
    refused: usize,
}

impl Counts {
    fn add(&mut self, played: &Match) {
        for (commands, seen) in played.inputs.iter().zip(&played.seen) {
            let done = all_of(commands);
            for (input, outcome) in done.iter().zip(&seen.outcomes) {
                self.added += usize::from(matches!(outcome.result, Ok(Created::Body(_))));
                self.removed += usize::from(matches!(input.command, Command::RemoveBody(_)) && outcome.result.is_ok());
                self.refused += usize::from(outcome.result.is_err());
            }
            self.quarantined += seen.faults.len();
            self.slept += seen.fell_asleep.len();
            self.woke += seen.woke.len();
        }
    }
}

/// Guess of a player's inputs until they arrive.
fn guess(author: &mut Author, played: &Match, tick: usize, player: usize, world: &World) -> Vec<Command> {
    match author.random.next() % 3 {
        0 => Vec::new(),
        1 => played.inputs[tick.saturating_sub(1)][player].clone(),
        _ => moves(author, played.quiet, world),
    }
}

/// Goes back without a late input, as a caller does who steps again himself.
fn go_back_and_on(author: &mut Author, history: &mut History, world: &mut World, again: &mut [Option<Seen>]) {
    let (Some(oldest), present) = (history.oldest(), world.tick()) else { return };
    let tick = author.random.between(oldest as i64, present as i64 + 1) as u64;
    let inputs: Vec<Inputs> = (tick..present).map(|t| history.inputs(t).expect("it is kept").clone()).collect();
    history.rollback_to(world, tick).expect("it is kept");
    assert_eq!(world.tick(), tick);
    if tick > 0 {
        assert_eq!(Some(world.state_hash()), again[tick as usize - 1].as_ref().map(|seen| seen.state));
    }
    for (tick, inputs) in (tick..).zip(&inputs) {
        again[tick as usize] = Some(seen(&history.advance(world, inputs)));
    }
}

/// Plays a match with inputs that are late by up to the length of the history.
fn play_late(author: &mut Author, played: &Match, ticks: usize, counts: &mut Counts) {
    let mut world = played.start.clone();
    let mut history = History::new(ticks);
    let mut again = vec![None; played.seen.len()];
    // (when it arrives, tick, player)
    let mut under_way: Vec<(usize, usize, u32)> = Vec::new();
    // At the end the last inputs arrive while nothing new happens.
    for tick in 0..played.seen.len() + ticks {
        if tick < played.seen.len() {
            let mut inputs = all_of(&played.inputs[tick]);
            for player in 0..PLAYERS {
                let delay = author.random.next() as usize % (ticks + 1);
                if delay > 0 {
                    inputs.replace(player, guess(author, played, tick, player as usize, &world));
                    under_way.push((tick + delay, tick, player));
                }
            }
            let report = history.advance(&mut world, &inputs);
            again[tick] = Some(seen(&report));
        }
        // In any order, each by itself or several at once.
        let (mut arrived, others): (Vec<_>, Vec<_>) = under_way.into_iter().partition(|(when, ..)| *when == tick + 1);
        under_way = others;
        while !arrived.is_empty() {
            let (_, late, player) = arrived.swap_remove(author.random.next() as usize % arrived.len());
            let commands = played.inputs[late][player as usize].clone();
            let mut visit = |tick: TickReport<'_>| again[tick.step.tick as usize - 1] = Some(seen(&tick));
            let done_over = if author.one_in(2) {
                history.correct(&mut world, late as u64, player, commands, visit).expect("it is kept")
            } else {
                history.replace(late as u64, player, commands).expect("it is kept");
                if arrived.is_empty() { history.redo(&mut world, &mut visit) } else { continue }
            };
            let behind = world.tick() - late as u64;
            counts.rollbacks += usize::from(done_over > 0);
            counts.right_guesses += usize::from(done_over == 0);
            counts.wrong_guesses += usize::from(done_over >= behind);
            if author.one_in(4) {
                go_back_and_on(author, &mut history, &mut world, &mut again);
            }
        }
    }
    for (tick, (again, seen)) in again.iter().zip(&played.seen).enumerate() {
        assert_eq!(again.as_ref(), Some(seen), "tick {tick}, a history of {ticks}");
    }
}

#[test]
fn late_inputs_lead_to_the_states_that_inputs_in_time_lead_to() {
    let mut author = Author { random: SplitMix(3), unfair: 60 };
    let mut counts = Counts::default();
    for run in 0..90 {
        let integrator = Integrator::ALL[run % Integrator::ALL.len()];
        let played = Match::play(&mut author, integrator, [1, 10][run / 5 % 2], 50);
        counts.add(&played);
        play_late(&mut author, &played, 1 + run % 17, &mut counts);
    }
    // Otherwise this shows less than it says.
    let Counts { rollbacks, wrong_guesses, right_guesses, added, removed, quarantined, slept, woke, refused } = counts;
    assert!(rollbacks > 1_000 && wrong_guesses > 1_000 && right_guesses > 500, "{counts:?}");
    for count in [added, removed, quarantined, slept, woke, refused] {
        assert!(count > 50, "{counts:?}");
    }
}

/// A world of a few bodies that are pushed apart by hand.
fn small() -> (World, BodyId) {
    let mut world = World::new(WorldDef { gravity: vec2(0, -1), ..WorldDef::default() }).expect("fair");
    let body = world.add_body(BodyDef { velocity: vec2(1, 2), ..BodyDef::dynamic() }).expect("fair");
    (world, body)
}

fn set(body: BodyId, x: i32) -> [Command; 1] {
    [Command::SetVelocity { body, velocity: vec2(x, 0) }]
}

#[test]
fn ticks_that_are_not_kept_are_refused_by_name_and_nothing_changes() {
    let (mut world, body) = small();
    let mut history = History::new(3);
    assert_eq!(history.oldest(), None);
    assert_eq!(history.inputs(0), Err(Error::TickToCome { tick: 0, present: 0 }));
    for _ in 0..5 {
        history.advance(&mut world, &Inputs::new());
    }
    assert_eq!(history.oldest(), Some(2));
    let before = world.state_hash();
    let to_come = Error::TickToCome { tick: 5, present: 5 };
    let forgotten = Error::TickForgotten { tick: 1, oldest: 2 };
    for (tick, error) in [(5, to_come), (1, forgotten)] {
        assert_eq!(history.inputs(tick), Err(error));
        assert_eq!(history.inputs_mut(tick).map(drop), Err(error));
        assert_eq!(history.replace(tick, 0, []), Err(error));
        let visit = |_: TickReport<'_>| panic!("nothing is done over");
        assert_eq!(history.correct(&mut world, tick, 0, set(body, 1), visit), Err(error));
    }
    assert_eq!(history.rollback_to(&mut world, 1), Err(forgotten));
    assert_eq!(history.rollback_to(&mut world, 6), Err(Error::TickToCome { tick: 6, present: 5 }));
    // To the present: it is there.
    assert_eq!(history.rollback_to(&mut world, 5), Ok(()));
    assert_eq!((world.state_hash(), history.oldest()), (before, Some(2)));
}

#[test]
fn all_of_a_history_can_be_gone_back_over_and_it_begins_again_there() {
    let (mut world, body) = small();
    let mut history = History::new(4);
    let start = world.state_hash();
    for _ in 0..4 {
        history.advance(&mut world, &Inputs::new());
    }
    history.rollback_to(&mut world, 0).expect("it is kept");
    assert_eq!((world.state_hash(), world.tick(), history.oldest()), (start, 0, None));
    assert_eq!(history.rollback_to(&mut world, 0), Ok(()));
    assert_eq!(history.rollback_to(&mut world, 1), Err(Error::TickToCome { tick: 1, present: 0 }));
    history.advance(&mut world, &Inputs::new());
    assert_eq!(history.correct(&mut world, 0, 0, set(body, 7), |_| ()), Ok(1));
    assert_eq!(world.body(body).expect("it is there").velocity().x, fx!(7));
}

#[test]
fn a_history_of_no_ticks_has_one() {
    let (mut world, body) = small();
    let mut history = History::new(0);
    for _ in 0..3 {
        history.advance(&mut world, &Inputs::new());
    }
    assert_eq!(history.oldest(), Some(2));
    assert_eq!(history.correct(&mut world, 2, 0, set(body, 7), |_| ()), Ok(1));
}

#[test]
fn a_world_at_another_tick_begins_another_history() {
    let (mut world, body) = small();
    let mut history = History::new(4);
    for _ in 0..4 {
        history.advance(&mut world, &Inputs::new());
    }
    history.replace(2, 0, set(body, 9)).expect("it is kept");
    // By itself: what was changed above is of a past that this world does not have any more.
    world.step();
    let mut straight = world.clone();
    straight.step();
    history.advance(&mut world, &Inputs::new());
    assert_eq!((history.oldest(), world.state_hash()), (Some(5), straight.state_hash()));
}

#[test]
fn a_world_that_went_astray_is_put_back() {
    let (mut world, _) = small();
    let mut history = History::new(4);
    for _ in 0..4 {
        history.advance(&mut world, &Inputs::new());
    }
    let present = world.state_hash();
    world.step();
    history.rollback_to(&mut world, 4).expect("it is where the history ends");
    assert_eq!((world.state_hash(), history.oldest()), (present, Some(0)));
}

#[test]
fn inputs_changed_and_not_done_over_count_in_what_comes_next() {
    let (mut straight, body) = small();
    let mut world = straight.clone();
    let mut history = History::new(4);
    for tick in 0..4 {
        history.advance(&mut world, &Inputs::new());
        if tick == 1 {
            straight.set_velocity(body, vec2(7, 0)).expect("fair");
        }
        straight.step();
    }
    // By the next tick.
    history.replace(1, 0, set(body, 7)).expect("it is kept");
    let report = history.advance(&mut world, &Inputs::new());
    let next = report.world.state_hash();
    // By going back to a tick after the change.
    history.replace(1, 0, set(body, 3)).expect("it is kept");
    history.replace(1, 0, set(body, 7)).expect("it is kept");
    history.rollback_to(&mut world, 4).expect("it is kept");
    assert_eq!(world.state_hash(), straight.state_hash());
    straight.step();
    assert_eq!(next, straight.state_hash());
}

#[test]
fn what_was_changed_in_a_tick_that_is_given_up_is_gone_with_it() {
    let (mut world, body) = small();
    let mut history = History::new(4);
    for _ in 0..4 {
        history.advance(&mut world, &Inputs::new());
    }
    history.replace(3, 0, set(body, 3)).expect("it is kept");
    history.rollback_to(&mut world, 1).expect("it is kept");
    let mut straight = world.clone();
    history.advance(&mut world, &Inputs::new());
    straight.step();
    assert_eq!(world.state_hash(), straight.state_hash());
}

#[test]
fn a_handle_from_a_future_that_was_given_up_may_name_another_body() {
    let (mut world, _) = small();
    let mut history = History::new(4);
    let mut made = Vec::new();
    let mut inputs = Inputs::new();
    inputs.replace(1, [Command::AddBody(BodyDef { key: 1, ..BodyDef::dynamic() })]);
    made.push(history.advance(&mut world, &inputs).outcomes[0].result);
    let shot = [Command::AddBody(BodyDef { key: 2, ..BodyDef::dynamic() })];
    history.correct(&mut world, 0, 0, shot, |tick| made.push(tick.outcomes[0].result)).expect("it is kept");
    assert_eq!(made[0], made[1]);
    let Ok(Created::Body(body)) = made[0] else { panic!("{made:?}") };
    assert_eq!(world.body(body).expect("it is there").key(), 2);
    assert_eq!(world.body(body).expect("it is there").activity(), Activity::Awake);
}

#[test]
fn the_time_step_may_change_on_the_way() {
    let (mut world, _) = small();
    let mut history = History::new(8);
    let mut straight = world.clone();
    for tick in 0..8 {
        history.advance(&mut world, &Inputs::new());
        if tick == 3 {
            straight.set_time_step(TimeStep::ratio(1001, 60_000)).expect("fair");
        }
        straight.step();
    }
    let slower = Command::SetTimeStep(TimeStep::ratio(1001, 60_000));
    assert_eq!(history.correct(&mut world, 3, 0, [slower], |_| ()), Ok(5));
    assert_eq!((world.elapsed(), world.state_hash()), (straight.elapsed(), straight.state_hash()));
}

#[test]
fn a_world_that_is_rolled_back_has_the_report_of_its_own_step() {
    let (mut world, body) = small();
    let mut history = History::new(6);
    let lost = BodyDef { position: Vec2::new(limits::POSITION, fx!(0)), velocity: vec2(1, 0), ..BodyDef::dynamic() };
    let mut reports = Vec::new();
    for tick in 0..10 {
        if tick == 6 {
            history.correct(&mut world, 0, 1, set(body, 3), |_| ()).expect("it is kept");
        }
        let mut inputs = Inputs::new();
        if tick == 2 || tick == 7 {
            let command = Command::AddBody(lost.clone());
            inputs.insert(Input { player: 2, sequence: 0, command }).expect("it has its place");
        }
        history.advance(&mut world, &inputs);
        reports.push((world.tick(), world.last_report().faults.to_vec()));
    }
    let mut compared = Vec::new();
    for (tick, faults) in reports.into_iter().rev() {
        if history.rollback_to(&mut world, tick).is_ok() {
            assert_eq!(world.last_report().faults, faults, "the step to tick {tick}");
            compared.push((tick, faults.len()));
        }
    }
    assert_eq!(compared, [(10, 0), (9, 0), (8, 1), (7, 0), (6, 0), (5, 0), (4, 0)]);
}
