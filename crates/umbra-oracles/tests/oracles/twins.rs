//! Twins for each oracle: a game that breaks its property, and one like it that does not.

use std::cell::Cell;
use std::collections::BTreeSet;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::{AtomicI64, Ordering};
use std::thread;

use umbra_oracles::{Course, Fuzz, Game, Handles, Oracle, Verdict, Violation, fuzz, shrink};
use umbra_physics::Symmetry;
use umbra_physics::{
    ApplyOptions, BodyDef, BodyId, BodyState, Command, CustomForce, CustomForceError, Dependence, FieldId, FieldKind,
    ForceField, ForceOrImpulse, ForceTorque, Fx, Mass, Owner, Random, Replay, Stepper, Vec2, World, WorldDef, fx, vec2,
};

/// Keys from here on are no game's.
const BYSTANDERS: u64 = 1 << 63;

/// A fault in a game.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fault {
    /// No fault.
    None,
    /// No fault, and no body comes or goes.
    Calm,
    /// Matches share something.
    Shared,
    /// A count is kept beside the world.
    Beside,
    /// A velocity is set without the driver.
    Past,
    /// The first player to arrive is pushed twice.
    First,
    /// The body that comes last in the world is pushed.
    Slot,
    /// The random numbers are drawn by all bodies there are.
    Draw,
    /// A field that acts on nobody is as strong as there are bodies.
    Strength,
    /// A drag is added without the driver.
    Drag,
    /// The left one of two ways is preferred.
    Left,
    /// A body above is pushed, and no body to the right.
    Above,
    /// The distance from the origin matters.
    Origin,
    /// A custom force reads what it does not say it reads.
    Velocity,
    /// A custom force remembers.
    Memory,
    /// A custom force asks on which thread it is.
    Thread,
}

/// A push for a body, in a direction.
#[derive(Clone, Debug, PartialEq)]
struct Input {
    player: u64,
    body: BodyId,
    way: Vec2,
}

#[derive(Clone)]
struct Twin {
    fault: Fault,
    shared: Rc<Cell<u64>>,
    beside: u64,
    bodies: Vec<BodyId>,
}

impl Twin {
    fn new(fault: Fault) -> Self {
        Self { fault, shared: Rc::default(), beside: 0, bodies: Vec::new() }
    }

    fn is_calm(&self) -> bool {
        matches!(self.fault, Fault::Calm | Fault::Above)
    }

    fn push(&self, world: &mut World, driver: &mut dyn Stepper, body: BodyId, impulse: Vec2) {
        let action = ForceOrImpulse::Impulse { impulse, point: None };
        // A body that is gone is not pushed.
        let _ = driver.execute(world, &Command::Apply { body, action, options: ApplyOptions::default() });
    }

    /// The bodies of the game's own, by their keys.
    fn own(world: &World) -> Vec<BodyId> {
        let mut members: Vec<_> =
            world.bodies().filter(|body| body.key() < BYSTANDERS).map(|b| (b.key(), b.id())).collect();
        members.sort_by_key(|(key, _)| *key);
        members.into_iter().map(|(_, id)| id).collect()
    }
}

impl Game for Twin {
    type Input = Input;

    fn start(&mut self) -> World {
        let mut world = World::new(WorldDef { sleep_after: None, ..WorldDef::default() }).expect("a fair definition");
        for key in 0..4 {
            let position = vec2(3 * key - 4, key * key % 3);
            let mass = Mass::Explicit { mass: fx!(2), inertia: fx!(1) };
            let def = BodyDef { position, mass, key: key as u64, ..BodyDef::dynamic() };
            self.bodies.push(world.add_body(def).expect("a fair body"));
        }
        if self.fault == Fault::Strength {
            world.add_field(weak(0)).expect("a fair field");
        }
        if matches!(self.fault, Fault::Velocity | Fault::Memory | Fault::Thread) {
            world.register_custom_force(Arc::new(Odd(self.fault, AtomicI64::new(0)))).expect("the first of its id");
            world.add_field(FieldKind::Custom { id: 1 }).expect("it is registered");
        }
        world
    }

    fn tick(&mut self, world: &mut World, inputs: &[Input], driver: &mut dyn Stepper) {
        let mut inputs = inputs.to_vec();
        if self.fault != Fault::First {
            inputs.sort_by_key(|input| input.player);
        }
        for (i, Input { body, way, player }) in inputs.into_iter().enumerate() {
            self.push(world, driver, body, way);
            match self.fault {
                Fault::Strength => {
                    let (id, field) = (FieldId::from_parts(0, 0), weak(world.bodies().count() as i32));
                    driver.execute(world, &Command::SetField { id, field }).expect("it is there");
                }
                Fault::Drag => _ = world.add_field(weak(1)).expect("a fair field"),
                Fault::None | Fault::Calm | Fault::Velocity | Fault::Memory | Fault::Thread => {}
                Fault::Shared => {
                    self.shared.set(self.shared.get() + 1);
                    self.push(world, driver, body, vec2(self.shared.get() as i32, 0));
                }
                Fault::Beside => {
                    self.beside += 1;
                    self.push(world, driver, body, vec2(self.beside as i32, 0));
                }
                Fault::Past => {
                    if let Ok(velocity) = world.body(body).map(|body| body.velocity()) {
                        world.set_velocity(body, -velocity).expect("it is dynamic");
                    }
                }
                Fault::First if i == 0 => self.push(world, driver, body, way),
                Fault::Slot => {
                    let last = world.bodies().filter(|body| body.key() < BYSTANDERS).last().map(|body| body.id());
                    last.into_iter().for_each(|last| self.push(world, driver, last, way));
                }
                Fault::Draw => world.bodies().count().min(99).checked_sub(1).into_iter().for_each(|draws| {
                    (0..draws).for_each(|_| _ = world.random_mut().bits());
                }),
                Fault::Left if way.x < Fx::ZERO => self.push(world, driver, body, way),
                Fault::Above if way.y != Fx::ZERO => self.push(world, driver, body, way),
                Fault::Origin => {
                    let at = world.body(body).map_or(Vec2::ZERO, |body| body.position());
                    if at.checked_length().is_some_and(|length| length > fx!(100)) {
                        self.push(world, driver, body, way);
                    }
                }
                Fault::First | Fault::Left | Fault::Above => {}
            }
            // Bodies come and go, so that handles differ from match to match.
            let is_slanted = way.x != Fx::ZERO && way.y != Fx::ZERO && !self.is_calm();
            if player == 3 && is_slanted {
                let members = Self::own(world);
                let last = members.last().copied().filter(|_| members.len() > 3);
                last.into_iter().for_each(|last| _ = driver.execute(world, &Command::RemoveBody(last)));
            } else if player == 2 && is_slanted {
                let members = Self::own(world);
                let key = members.last().and_then(|&last| Some(world.body(last).ok()?.key() + 1)).unwrap_or_default();
                let at = world.body(self.bodies[0]).map_or(Vec2::ZERO, |body| body.position());
                let _ = driver.execute(world, &Command::AddBody(BodyDef { position: at, key, ..BodyDef::dynamic() }));
            }
        }
        driver.step(world);
    }

    /// A body that is added is at an angle of 0, which no quarter turn leaves it at.
    fn symmetries(&self) -> Vec<Symmetry> {
        let turn = self.is_calm().then_some(Symmetry::TURN);
        [Symmetry::MIRROR].into_iter().chain(turn).chain(Symmetry::shift(vec2(100, -60))).collect()
    }

    fn image(&self, input: &Input, symmetry: &Symmetry) -> Option<Input> {
        Some(Input { way: symmetry.vector(input.way)?, ..*input })
    }

    fn renamed(&self, input: &Input, handles: &Handles) -> Input {
        Input { body: handles.body(input.body), ..*input }
    }
}

/// A drag that nobody feels.
fn weak(linear: i32) -> ForceField {
    ForceField {
        kind: FieldKind::Drag { linear: linear.into(), quadratic: Fx::ZERO, wind: Vec2::ZERO },
        force_groups: 0,
    }
}

/// A custom force with a fault.
struct Odd(Fault, AtomicI64);

impl CustomForce for Odd {
    fn id(&self) -> u64 {
        1
    }

    fn version(&self) -> u32 {
        1
    }

    fn depends_on(&self) -> Dependence {
        Dependence::Position
    }

    fn push(&self, body: &BodyState) -> Result<ForceTorque, CustomForceError> {
        let force = match self.0 {
            Fault::Velocity => body.velocity,
            Fault::Memory => Vec2::new(Fx::from_bits(self.1.fetch_add(1, Ordering::Relaxed)), Fx::ZERO),
            // The threads of a pool have names or none, and tests have theirs.
            Fault::Thread => vec2(i32::from(thread::current().name().is_none()), 0),
            _ => Vec2::ZERO,
        };
        Ok(ForceTorque { force, torque: Fx::ZERO })
    }
}

/// Pushes of bodies that are there, for the most part: a match is played to see which handles it gives out.
fn course(fault: Fault, seed: u64, ticks: u64) -> Course<Input> {
    let mut random = Random::seeded(seed);
    let mut game = Twin::new(fault);
    let mut world = game.start();
    let mut inputs = Vec::new();
    for tick in 0..ticks {
        let mut now = Vec::new();
        for player in 0..4 {
            if random.below(2) == 0 {
                let members = Twin::own(&world);
                let body = members[random.below(members.len() as u64) as usize];
                let way = [vec2(1, 0), vec2(-1, 0), vec2(0, 1), vec2(0, -1), vec2(1, -1), vec2(-1, -1)]
                    [random.below(6) as usize];
                now.push(Input { player, body, way });
            }
        }
        game.tick(&mut world, &now, &mut ());
        inputs.extend(now.into_iter().map(|input| (tick, input)));
    }
    Course { inputs, ticks }
}

/// The oracles that object to some match of the game, with what the first of each said.
fn objecting(fault: Fault) -> Vec<Violation> {
    let mut violations: Vec<Violation> = Vec::new();
    for seed in 0..4 {
        let course = course(fault, seed, 30);
        for oracle in Oracle::ALL {
            if violations.iter().any(|violation| violation.oracle == oracle) {
                continue;
            }
            violations.extend(oracle.judge(&Twin::new(fault), &course).err().map(|violation| *violation));
        }
    }
    violations
}

fn names(violations: &[Violation]) -> BTreeSet<Oracle> {
    violations.iter().map(|violation| violation.oracle).collect()
}

/// Asserts that some oracles object, that some others may, and that no other does.
#[track_caller]
fn assert_found(fault: Fault, oracles: &[Oracle], perhaps: &[Oracle]) {
    let violations = objecting(fault);
    for violation in &violations {
        println!("{fault:?}: {violation}");
    }
    let objections = names(&violations);
    assert!(oracles.iter().all(|oracle| objections.contains(oracle)), "{fault:?} was found by {objections:?} alone");
    let others: Vec<_> =
        objections.iter().filter(|oracle| !oracles.contains(oracle) && !perhaps.contains(oracle)).collect();
    assert!(others.is_empty(), "{fault:?} was found by {others:?} as well");
}

#[test]
fn a_game_without_a_fault_is_found_fault_with_by_nobody() {
    for fault in [Fault::None, Fault::Calm] {
        assert_found(fault, &[], &[]);
        for oracle in Oracle::ALL {
            let is_on = oracle != Oracle::Threads || cfg!(feature = "parallel");
            let applies = is_on && (fault == Fault::Calm || oracle != Oracle::Turn);
            let verdict = oracle.judge(&Twin::new(fault), &course(fault, 1, 30)).expect("it has no fault");
            assert_eq!(verdict == Verdict::Held, applies, "{oracle}: {verdict:?}");
        }
    }
}

#[test]
fn state_shared_between_matches_is_found() {
    // It shows wherever two matches are compared.
    assert_found(Fault::Shared, &[Oracle::Repeat, Oracle::Restore], &Oracle::ALL);
}

#[test]
fn state_beside_the_world_is_found() {
    // And that the count pushes to the right.
    assert_found(Fault::Beside, &[Oracle::Restore, Oracle::Mirror], &[]);
}

#[test]
fn a_change_past_the_driver_is_found() {
    assert_found(Fault::Past, &[Oracle::Record], &[]);
}

#[test]
fn an_order_of_arrival_that_matters_is_found() {
    assert_found(Fault::First, &[Oracle::Order], &[]);
}

#[test]
fn an_order_of_slots_that_matters_is_found() {
    assert_found(Fault::Slot, &[Oracle::Bystanders], &[Oracle::Threads]);
}

#[test]
fn numbers_drawn_for_whoever_is_there_are_found() {
    assert_found(Fault::Draw, &[Oracle::Bystanders], &[Oracle::Threads]);
}

#[test]
fn a_field_that_is_another_one_among_bystanders_is_found() {
    assert_found(Fault::Strength, &[Oracle::Bystanders], &[Oracle::Threads]);
    let violations = objecting(Fault::Strength);
    let violation = violations.iter().find(|violation| violation.oracle == Oracle::Bystanders).expect("it is found");
    let difference = violation.difference.as_ref().expect("its strength");
    assert!(matches!(difference.owner, Owner::ForceField(_)) && difference.field.contains("linear"), "{violation}");
}

#[test]
fn fields_added_past_the_driver_are_not_judged_among_bystanders() {
    let course = course(Fault::Drag, 1, 30);
    for oracle in [Oracle::Bystanders, Oracle::Threads] {
        let verdict = oracle.judge(&Twin::new(Fault::Drag), &course).expect("nothing is compared");
        assert!(matches!(verdict, Verdict::Inapplicable { .. }), "{oracle}");
    }
}

#[test]
fn a_preference_for_a_side_is_found() {
    assert_found(Fault::Left, &[Oracle::Mirror], &[]);
}

#[test]
fn a_preference_for_an_axis_is_found() {
    // Left and right are alike, the axes are not.
    assert_found(Fault::Above, &[Oracle::Turn], &[]);
}

#[test]
fn a_place_that_matters_is_found() {
    assert_found(Fault::Origin, &[Oracle::Shift], &[]);
}

#[test]
fn a_law_that_says_it_reads_less_than_it_does_is_found() {
    // Forces are kept for a step that are no longer the same; what the image of such a force is nobody knows.
    let oracles = [Oracle::Restore, Oracle::Reverse, Oracle::Paths];
    assert_found(Fault::Velocity, &oracles, &[Oracle::Record, Oracle::Bystanders, Oracle::Threads]);
}

#[test]
fn a_law_that_remembers_is_found() {
    assert_found(
        Fault::Memory,
        &[Oracle::Record, Oracle::Restore, Oracle::Reverse, Oracle::Paths],
        &[Oracle::Bystanders, Oracle::Threads],
    );
}

#[cfg(feature = "parallel")]
#[test]
fn a_law_that_depends_on_threads_is_found() {
    assert_found(Fault::Thread, &[Oracle::Threads], &[]);
}

#[test]
fn a_difference_is_reported_with_its_place_and_value() {
    let violations = objecting(Fault::Left);
    let violation = violations.iter().find(|violation| violation.oracle == Oracle::Mirror).expect("it is found");
    let difference = violation.difference.as_ref().expect("a body moves in another way");
    assert!(matches!(difference.owner, umbra_physics::Owner::Body(_)) && difference.left != difference.right);
    let text = violation.to_string();
    assert!(text.starts_with(&format!("mirror, tick {}, mirror: body ", violation.tick)), "{text}");
    assert_eq!(violation.beside, Symmetry::MIRROR.name());
}

/// A match that is pushed in the second tick that is ever made, whoever makes it.
#[derive(Clone, Default)]
struct Hiccup(Rc<Cell<u32>>);

impl Game for Hiccup {
    type Input = ();

    fn start(&mut self) -> World {
        let mut world = World::new(WorldDef::default()).expect("a fair definition");
        world.add_body(BodyDef::dynamic()).expect("a fair body");
        world
    }

    fn tick(&mut self, world: &mut World, _: &[()], driver: &mut dyn Stepper) {
        if self.0.replace(self.0.get() + 1) == 1 {
            let action = ForceOrImpulse::Impulse { impulse: Vec2::X, point: None };
            let body = BodyId::from_parts(0, 0);
            driver
                .execute(world, &Command::Apply { body, action, options: ApplyOptions::default() })
                .expect("it is there");
        }
        driver.step(world);
    }
}

#[test]
fn a_failure_that_does_not_repeat_is_kept_as_played() {
    let options = Fuzz { runs: 3, ticks: 5, oracles: &[Oracle::Repeat], ..Fuzz::default() };
    let campaign = fuzz(&Hiccup::default(), &options, |_, tick| vec![(); (tick % 2) as usize]);
    let counterexample = campaign.found.expect("the second match is pushed");
    assert_eq!((campaign.runs, campaign.seed, counterexample.tries), (1, Some(0), 0));
    assert_eq!((counterexample.violation.oracle, counterexample.violation.tick), (Oracle::Repeat, 0));
    assert!(counterexample.violation.difference.is_some());
    assert_eq!(counterexample.course, Course { inputs: vec![(1, ()), (3, ())], ticks: 5 });
    let replay = Replay::from_bytes(&counterexample.replay, &[]).expect("it is whole");
    assert_eq!((replay.end(), replay.verify()), (5, Ok(())));
}

#[test]
fn every_kind_of_failure_is_shrunk() {
    for (fault, oracle, inputs, ticks) in [
        (Fault::Beside, Oracle::Restore, 2, 2),
        (Fault::Past, Oracle::Record, 1, 1),
        (Fault::First, Oracle::Order, 2, 1),
        // A body is to come while a bystander stands in the slot of one that went.
        (Fault::Slot, Oracle::Bystanders, 3, 8),
        (Fault::Left, Oracle::Mirror, 1, 1),
        (Fault::Above, Oracle::Turn, 1, 1),
        (Fault::Origin, Oracle::Shift, 1, 1),
        (Fault::Memory, Oracle::Reverse, 0, 1),
    ] {
        let counterexample = (0..8).find_map(|seed| shrink(&Twin::new(fault), &course(fault, seed, 30), oracle, 3_000));
        let counterexample = counterexample.unwrap_or_else(|| panic!("{fault:?} is not found"));
        assert_eq!(counterexample.violation.oracle, oracle);
        assert!(counterexample.course.inputs.len() <= inputs, "{fault:?}: {:#?}", counterexample.course);
        assert!(
            counterexample.course.ticks <= ticks && counterexample.tries < 3_000,
            "{fault:?}: {:#?}",
            counterexample.course
        );
        if fault != Fault::Memory {
            // What went past the driver is not in the replay.
            let replay = Replay::from_bytes(&counterexample.replay, &[]).expect("it is whole");
            assert_eq!(replay.verify().is_ok(), fault != Fault::Past, "{fault:?}");
            assert_eq!(replay.end(), counterexample.course.ticks);
        }
    }
}
