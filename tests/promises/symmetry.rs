//! P6: fair. A run that is mirrored, turned by a quarter or shifted is the image of the run, and bodies of any mass fall alike.
//! The image of the origin is an even number of ulps away in each coordinate: [`Symmetry`] has no other images.

use std::cell::Cell;

use proptest::collection::vec;
use proptest::prelude::*;
use umbra_oracles::{Oracle, Script};
use umbra_physics::Symmetry;
use umbra_physics::{
    Activity, ApplyOptions, BodyDef, BodyId, Command, Created, End, Error, Event, FieldKind, ForceField,
    ForceOrImpulse, Fx, Mass, Random, Rollback, Snapshot, Vec2, World, WorldDef, fx, limits, vec2,
};

use crate::promises::check::{Verdict, check_of, judge, there_is};
use crate::promises::plan::{FAIR, Taste};

const TASTE: Taste = Taste { near: 1, unfair: 0, ..FAIR };

#[test]
fn a_mirrored_run_is_the_mirror_image() {
    judge("fair", 50, TASTE.plan(), Oracle::Mirror);
}

#[test]
fn a_turned_run_is_the_run_turned() {
    judge("fair", 50, TASTE.plan(), Oracle::Turn);
}

#[test]
fn a_run_shifted_by_an_even_number_of_ulps_is_the_run_shifted() {
    judge("fair", 50, TASTE.plan(), Oracle::Shift);
}

/// A world, and all that a game keeps beside it to call it by.
struct Side {
    world: World,
    saved: Snapshot,
    /// Over commands of players 0 and 1.
    rollback: Rollback<Vec<Command>>,
}

impl Side {
    fn new(world: World) -> Self {
        let rollback = Rollback::new(&world, [0, 1], 5).with_prediction(|_| Vec::new());
        Self { saved: world.snapshot(), world, rollback }
    }

    /// Makes the next tick with these inputs of player 0. Returns the number of ticks made again, or the refusal after which the
    /// rollback goes on from the world as it is; and the results of all commands of all ticks made.
    fn advance(&mut self, commands: &[Command]) -> (Result<u64, Error>, Vec<Result<Created, Error>>) {
        let (mut refused, mut results) = (None, Vec::new());
        loop {
            let (now, first) = (self.rollback.present(), self.rollback.first_unconfirmed());
            _ = self.rollback.add_input(now, 0, commands.to_vec()).expect("a player");
            if first + 5 == now {
                // Otherwise it waits.
                _ = self.rollback.add_input(first, 1, Vec::new()).expect("a player");
            }
            let tick = |world: &mut World, inputs: &[(u32, Vec<Command>)]| {
                results.extend(inputs.iter().flat_map(|(_, commands)| commands).map(|command| world.execute(command)));
            };
            match self.rollback.advance(&mut self.world, tick).map(|report| (report.redone, report.waits_for)) {
                Ok((redone, waits_for)) => {
                    assert_eq!(waits_for, None);
                    return (refused.map_or(Ok(redone), Err), results);
                }
                Err(error) => {
                    assert_eq!(refused.replace(error), None);
                    self.rollback.restart(&self.world);
                }
            }
        }
    }

    /// Report of the last step.
    fn told(&self) -> (Vec<Event>, u32, Vec<BodyId>) {
        let report = self.world.last_report();
        let changed = self.world.changed_since(report.tick).map(|body| body.id());
        (report.events().collect(), report.drag_outside, changed.collect())
    }

    /// Goes back by a step, if it has an inverse.
    fn undo(&mut self) -> Result<(), String> {
        let applied = self.world.last_report().applied.to_vec();
        self.world.step_back(&applied).map_err(|error| error.to_string())
    }
}

/// A run and its image, with calls between its commands that chance decides on.
struct Reflected {
    symmetry: Symmetry,
    /// Image of the commands: the same ones, unless the twin is to be found out.
    of_commands: Symmetry,
    sides: [Side; 2],
    dice: Random,
    /// Ticks are made by the rollback for a while, and then by the world itself: what arrives late finds ticks to make again.
    by_rollback: bool,
    compared: u32,
    redone: u64,
}

/// Reason to stop comparing.
enum Ended {
    /// Something has no image.
    Over,
    Unlike(String),
}

impl Reflected {
    /// Does the same to both, and compares what they say.
    fn both<T: PartialEq + std::fmt::Debug>(
        &mut self,
        what: &str,
        mut act: impl FnMut(&mut Side) -> T,
    ) -> Result<T, Ended> {
        let [ours, theirs] = &mut self.sides;
        let (ours_result, theirs_result) = (act(ours), act(theirs));
        if ours_result == theirs_result {
            Ok(ours_result)
        } else {
            Err(Ended::Unlike(format!("{what}: {ours_result:?} and {theirs_result:?}")))
        }
    }

    fn image(&self, command: &Command) -> Result<Command, Ended> {
        self.of_commands.command(command).ok_or(Ended::Over)
    }

    /// Image of an event. Hits and breaks alone have places and directions.
    fn image_of(&self, event: Event) -> Option<Event> {
        Some(match event {
            Event::ContactHit(mut hit) => {
                hit.normal = self.symmetry.vector(hit.normal)?;
                hit.point = self.symmetry.point(hit.point)?;
                Event::ContactHit(hit)
            }
            Event::JointBroke(mut broke) => {
                broke.force = self.symmetry.vector(broke.force)?;
                broke.torque = self.symmetry.angular_velocity(broke.torque)?;
                Event::JointBroke(broke)
            }
            event => event,
        })
    }

    fn is_image(&self, what: &str, world: &World, counterpart: &World) -> Result<(), Ended> {
        let image = self.symmetry.world(world).ok_or(Ended::Over)?;
        match image.first_difference(counterpart) {
            None if image.state_hash() == counterpart.state_hash() => Ok(()),
            difference => Err(Ended::Unlike(format!("{what}, {}: {difference:?}", self.symmetry.name()))),
        }
    }

    fn compare(&mut self, what: &str) -> Result<(), Ended> {
        let [(events, outside, changed), theirs] = self.sides.each_ref().map(Side::told);
        let events: Option<Vec<Event>> = events.into_iter().map(|event| self.image_of(event)).collect();
        let here = (events.ok_or(Ended::Over)?, outside, changed);
        if here != theirs {
            return Err(Ended::Unlike(format!("{what}: {here:?} and {theirs:?}")));
        }
        let [left, right] = &self.sides;
        self.is_image(what, &left.world, &right.world)?;
        self.compared += 1;
        Ok(())
    }

    /// A command on both, the image on the one.
    fn on_each<T>(&mut self, command: &Command, act: impl Fn(&mut Side, &Command) -> T) -> Result<[T; 2], Ended> {
        let image = self.image(command)?;
        let [ours, theirs] = &mut self.sides;
        Ok([act(ours, command), act(theirs, &image)])
    }

    fn tick(&mut self, commands: &[Command]) -> Result<(), Ended> {
        let images = commands.iter().map(|command| self.image(command)).collect::<Result<Vec<Command>, Ended>>()?;
        let [ours, theirs] = &mut self.sides;
        self.by_rollback ^= self.dice.below(8) == 0;
        if self.by_rollback {
            // By a rollback, as inputs of a player.
            let (left, right) = (ours.advance(commands), theirs.advance(&images));
            if left != right {
                return Err(Ended::Unlike(format!("what became of inputs: {left:?} and {right:?}")));
            }
            self.redone += left.0.unwrap_or(0);
        } else {
            for (command, image) in commands.iter().zip(&images) {
                let (left, right) = (ours.world.execute(command), theirs.world.execute(image));
                if left != right {
                    return Err(Ended::Unlike(format!("{command:?}: {left:?} and {right:?}")));
                }
            }
            if self.dice.below(3) == 0 {
                let (left, right) = (ours.world.step_traced(), theirs.world.step_traced());
                for ((stage, left), (_, right)) in left.stages().zip(right.stages()) {
                    self.is_image(stage.kind.name(), left, right)?;
                }
            } else {
                ours.world.step();
                theirs.world.step();
            }
        }
        self.compare("a tick")
    }

    /// One of the calls that are no commands.
    fn call(&mut self) -> Result<(), Ended> {
        match self.dice.below(11) {
            0 => {
                // Or why it cannot be.
                _ = self.both("a step undone", Side::undo)?;
            }
            1 => self.sides.iter_mut().for_each(|side| side.world.restore(&side.saved)),
            2 => self.sides.iter_mut().for_each(|side| side.world.snapshot_into(&mut side.saved)),
            3 => self.sides.iter_mut().for_each(|side| {
                let read = Snapshot::from_bytes(&side.world.snapshot().to_bytes(), &[]);
                side.world = read.expect("its own bytes").into_world();
            }),
            4 => self.sides.iter_mut().for_each(|side| side.world = side.world.clone()),
            5 => {
                let place = self.dice.below(8) as usize;
                let ahead = |side: &Side| {
                    let body = side.world.bodies().nth(place % side.world.body_count().max(1))?.id();
                    let mut ahead = side.world.preview(body).expect("it is there");
                    (0..3).for_each(|_| _ = ahead.step());
                    Some(ahead.world().clone())
                };
                let [left, right] = &self.sides;
                if let (Some(left), Some(right)) = (ahead(left), ahead(right)) {
                    self.is_image("ahead", &left, &right)?;
                }
            }
            6..=9 => {
                // What another player did in a past tick arrives: most often there is no tick to make again.
                let [ours, theirs] = &self.sides;
                let ticks = |side: &Side| side.rollback.first_unconfirmed()..side.rollback.present();
                let past = ticks(ours);
                if ticks(theirs) != past {
                    return Err(Ended::Unlike("ticks that are not confirmed".to_owned()));
                }
                if past.is_empty() {
                    return Ok(());
                }
                let tick = past.start + self.dice.below(past.end - past.start);
                let body = ours.world.bodies().next().map(|body| body.id());
                let Some(body) = body else { return Ok(()) };
                let mut part = || self.dice.number(fx!(-3)..=fx!(3));
                let action = ForceOrImpulse::Impulse { impulse: Vec2::new(part(), part()), point: None };
                let push = Command::Apply { body, action, options: ApplyOptions::default() };
                let [left, right] =
                    self.on_each(&push, |side, push| side.rollback.add_input(tick, 1, vec![push.clone()]))?;
                if left != right {
                    return Err(Ended::Unlike(format!("late inputs: {left:?} and {right:?}")));
                }
            }
            _ => {
                self.both("back to the confirmed tick", |side| {
                    let confirmed = side.rollback.confirmed_world(&side.world).clone();
                    side.world.clone_from(&confirmed);
                    side.rollback.restart(&side.world);
                    side.world.tick()
                })?;
            }
        }
        self.compare("a call")
    }
}

/// Number of times that a run and its image were compared and equal, and of ticks that were made again.
fn keeps_images(script: &Script, seed: u64, of_commands: impl Fn(Symmetry) -> Symmetry) -> Result<(u32, u64), String> {
    let mut dice = Random::seeded(seed);
    let ulp = Fx::DELTA;
    let kinds = [Symmetry::MIRROR, Symmetry::FLIP, Symmetry::DIAGONAL, Symmetry::TURN, Symmetry::TURN];
    let kind = kinds[dice.below(5) as usize];
    let about = kind.about(vec2(fx!(3.25) + ulp, fx!(-1) + ulp + ulp + ulp)).ok_or("it shifts by an even number")?;
    let symmetry = if dice.below(2) == 0 { kind } else { about };
    let world = script.start().map_err(|error| error.to_string())?;
    let image = symmetry.world(&world).ok_or("an empty world has an image")?;
    let sides = [world, image].map(Side::new);
    let by_rollback = dice.below(2) == 0;
    let of_commands = of_commands(symmetry);
    let mut run = Reflected { symmetry, of_commands, sides, dice, by_rollback, compared: 0, redone: 0 };
    let mut play = || {
        for tick in 0..script.ticks {
            let commands: Vec<Command> = script.commands_of(tick).cloned().collect();
            run.tick(&commands)?;
            while run.dice.below(2) == 0 {
                run.call()?;
            }
        }
        Ok(())
    };
    match play() {
        Ok(()) | Err(Ended::Over) => Ok((run.compared, run.redone)),
        Err(Ended::Unlike(why)) => Err(why),
    }
}

#[test]
fn calls_of_every_kind_keep_images() {
    let (tried, compared, redone) = (Cell::new(0u32), Cell::new(0u32), Cell::new(0u64));
    let runs = || (TASTE.plan(), any::<u64>());
    check_of(
        "fair-calls",
        40,
        runs(),
        |(plan, _)| plan.script(),
        |(plan, seed)| {
            let (times, ticks) = keeps_images(&plan.script(), *seed, |symmetry| symmetry)?;
            tried.set(tried.get() + 1);
            compared.set(compared.get() + times);
            redone.set(redone.get() + ticks);
            Ok(())
        },
    );
    // Runs have up to 40 ticks, and some have things without an image in them.
    println!("{} runs, compared {} times, {} ticks made again", tried.get(), compared.get(), redone.get());
    let (tried, compared, redone) = (tried.get(), compared.get(), redone.get());
    assert!(compared >= 20 * tried, "compared {compared} times in {tried} runs");
    assert!(redone >= u64::from(tried) / 2, "{redone} ticks made again in {tried} runs");
    // With the commands of another image they part.
    let unmoved = |_| Symmetry::shift(Vec2::ZERO).expect("by nothing");
    assert!(there_is(runs(), |(plan, seed)| keeps_images(&plan.script(), *seed, unmoved).is_err()));
}

/// Two bodies at one place, of different masses, under what pulls all masses alike.
#[derive(Clone, Debug)]
struct Pair {
    world: WorldDef,
    body: BodyDef,
    masses: [Mass; 2],
    fields: Vec<ForceField>,
}

impl Pair {
    fn script(&self) -> Script {
        let bodies = self.masses.map(|mass| Command::AddBody(BodyDef { mass, ..self.body.clone() }));
        let fields = self.fields.iter().copied().map(Command::AddField);
        let commands = bodies.into_iter().chain(fields).map(|command| (0, command)).collect();
        Script { world: self.world, commands, ticks: 60 }
    }

    fn falls_alike(&self) -> Verdict {
        let script = self.script();
        let mut world = script.start().map_err(|error| error.to_string())?;
        for tick in 0..script.ticks {
            script.advance(&mut world, &mut ());
            let ways = |world: &World| -> Vec<_> {
                let way = |body: umbra_physics::BodyRef<'_>| {
                    (body.position_exact(), body.velocity_exact(), body.activity() == Activity::Quarantined)
                };
                world.bodies().map(way).collect()
            };
            match ways(&world)[..] {
                // A damping of 0 does not go with every integrator: then neither is there.
                [] => return Ok(()),
                [a, b] if a == b => {}
                ref ways => return Err(format!("at tick {tick} they have come apart: {ways:?}")),
            }
        }
        Ok(())
    }
}

fn pairs(pulls_alike: bool) -> impl Strategy<Value = Pair> {
    let taste = Taste { near: 2, ..FAIR };
    let is_alike = move |law: &FieldKind| match law {
        FieldKind::Attractor { centre: End::World(_), .. } | FieldKind::Zone { .. } => true,
        FieldKind::Drag { .. } => !pulls_alike,
        _ => false,
    };
    let law = taste.field_kind().prop_filter("it pulls masses as they are heavy", is_alike);
    let mass = || {
        prop_oneof![
            taste.number(fx!(0.125), fx!(9), limits::MASS_MIN, limits::MASS_MAX).prop_map(Mass::Kilograms),
            prop::sample::select(vec![Mass::Kilograms(limits::MASS_MIN), Mass::Kilograms(limits::MASS_MAX)]),
        ]
    };
    let fields = vec(law.prop_map(ForceField::from), usize::from(!pulls_alike)..3);
    (taste.world(), taste.body(), mass(), mass(), fields).prop_map(|(world, body, a, b, fields)| {
        let body = BodyDef { kind: umbra_physics::BodyKind::Dynamic, colliders: Vec::new(), ..body };
        Pair { world, body, masses: [a, b], fields }
    })
}

#[test]
fn bodies_of_any_mass_fall_alike() {
    check_of("fair-masses", 60, pairs(true), Pair::script, Pair::falls_alike);
    // Drag does not pull alike.
    assert!(there_is(pairs(false), |pair| pair.falls_alike().is_err()));
}
