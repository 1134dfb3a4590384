//! P7: a body's bits never depend on bodies it does not interact with. `tests/closure.rs` has one cast and one kind of
//! bystanders, by number; here both are made up: what they are, what acts among them, what is done to either, when bystanders
//! come and go, which of them leave the envelope, and on how many threads a step goes.

use std::convert::Infallible;

use proptest::collection::vec;
use proptest::prelude::*;
use umbra_oracles::{Oracle, Script};
use umbra_physics::{
    Activity, BodyDef, BodyId, Command, CommandMap, Created, Damping, Error, FieldId, FieldKind, Filter, ForceField,
    Fx, FxAccumulator, FxFactor, Shape, Turn, Vec2, World, limits,
};

use crate::promises::check::{Verdict, check_of, judge, there_is};
use crate::promises::plan::{Cast, FAIR, Plan, Taste};

/// The group that bystanders alone are in, and their fields alone act on.
const BYSTANDERS: u32 = 1 << 31;

/// Number of moving bodies from which a step uses all threads: twice `SHARE` in `src/step/mod.rs`, which is held to be no more.
const THRONG: i32 = 8_200;

/// The category of the colliders of bystanders: no generated filter is in it.
const CATEGORY: u32 = 1 << 31;

/// The command with an explosion that does not act on bystanders: it would be refused where one of them left the allowed range.
fn sparing(mut command: Command) -> Command {
    if let Command::Explode(explosion) = &mut command {
        explosion.mask &= !CATEGORY;
    }
    command
}

/// The command with colliders that meet those of bystanders alone.
fn apart(mut command: Command) -> Command {
    let filter = Filter { category: CATEGORY, mask: CATEGORY, group: 0 };
    match &mut command {
        Command::AddBody(def) => def.colliders.iter_mut().for_each(|collider| collider.filter = filter),
        Command::AddCollider { def, .. } | Command::SetCollider { def, .. } => def.filter = filter,
        _ => {}
    }
    command
}

#[derive(Clone, Debug)]
struct Company {
    /// Commands of the bodies that are watched.
    plan: Plan,
    /// Bodies, fields and deeds of bystanders.
    bystanders: Plan,
    /// Order in which the two casts act, in turn: true for the bystanders.
    turns: Vec<bool>,
    /// Bystanders that are thrown out of the allowed range, and when.
    expelled: Option<(u32, u64)>,
    threads: usize,
    /// True if enough bystanders are added that a step uses all threads.
    throng: bool,
    /// True if the others are no bystanders: fields act on both alike.
    friends: bool,
}

/// Replaces the groups in a command, and notes whether it is about bodies and fields rather than about the whole world.
struct Regroup<F> {
    force_groups: F,
    is_of_bodies: bool,
}

impl<F: Fn(u32) -> u32> CommandMap<Fx> for Regroup<F> {
    type Error = Infallible;

    fn scalar(&mut self, value: Fx) -> Result<Fx, Infallible> {
        Ok(value)
    }

    fn factor(&mut self, value: FxFactor) -> Result<FxFactor, Infallible> {
        Ok(value)
    }

    fn shape(&mut self, shape: Shape) -> Result<Shape, Infallible> {
        Ok(shape)
    }

    fn body(&mut self, body: BodyId) -> Result<BodyId, Infallible> {
        self.is_of_bodies = true;
        Ok(body)
    }

    fn field(&mut self, field: FieldId) -> Result<FieldId, Infallible> {
        self.is_of_bodies = true;
        Ok(field)
    }

    fn force_groups(&mut self, force_groups: u32) -> Result<u32, Infallible> {
        self.is_of_bodies = true;
        Ok((self.force_groups)(force_groups))
    }
}

/// The command with other groups, and whether it is about bodies or fields.
fn in_groups(command: Command, force_groups: impl Fn(u32) -> u32) -> (Command, bool) {
    let mut regroup = Regroup { force_groups, is_of_bodies: false };
    let Ok(command) = command.map(&mut regroup);
    (command, regroup.is_of_bodies)
}

/// A bystander that stops at once would keep `Yoshida4` out of the world for all.
fn goes_on(command: Command) -> Command {
    let some = |damping: Option<Damping>| {
        damping.map(|damping| if damping.kept() == Fx::ZERO { Damping::kept_per_second(Fx::DELTA) } else { damping })
    };
    match command {
        Command::AddBody(def) => Command::AddBody(BodyDef {
            linear_damping: some(def.linear_damping),
            angular_damping: some(def.angular_damping),
            ..def
        }),
        Command::SetBodyDamping { body, linear, angular } => {
            Command::SetBodyDamping { body, linear: some(linear), angular: some(angular) }
        }
        command => command,
    }
}

/// All the bits of a body.
#[derive(Debug)]
struct Seen {
    _position: Vec2<FxAccumulator>,
    _velocity: Vec2<FxAccumulator>,
    _angle: Turn,
    _spin: FxAccumulator,
    _activity: Activity,
}

fn seen(world: &World, cast: &Cast) -> Vec<Result<Seen, ()>> {
    let look = |&body: &BodyId| {
        let body = world.body(body).map_err(drop)?;
        Ok(Seen {
            _position: body.position_exact(),
            _velocity: body.velocity_exact(),
            _angle: body.angle_exact(),
            _spin: body.angular_velocity_exact(),
            _activity: body.activity(),
        })
    };
    cast.bodies.iter().map(look).collect()
}

/// Members of a cast in a list of handles, by number.
fn numbers(cast: &Cast, bodies: impl Iterator<Item = BodyId>) -> Vec<Option<usize>> {
    let mut numbers: Vec<_> = bodies.map(|body| cast.bodies.iter().position(|&candidate| candidate == body)).collect();
    numbers.retain(Option::is_some);
    numbers.sort_unstable();
    numbers
}

/// The words of a result without its numbers, so that other handles make no difference.
fn kind(done: Result<Created, Error>) -> String {
    let text = format!("{:?}", done.map(drop));
    text.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.chars().all(|c| c.is_ascii_digit())).collect()
}

impl Company {
    fn own(&self, tick: u64) -> Vec<Command> {
        self.plan
            .due(tick)
            .into_iter()
            .map(|command| sparing(in_groups(command, |force_groups| force_groups & !BYSTANDERS).0))
            .collect()
    }

    fn strange(&self, tick: u64) -> Vec<Command> {
        let force_groups = if self.friends { u32::MAX } else { BYSTANDERS };
        let due = self.bystanders.due(tick).into_iter().map(|command| in_groups(command, |_| force_groups));
        let mut due: Vec<Command> =
            due.filter(|(_, is_of_bodies)| *is_of_bodies).map(|(command, _)| apart(goes_on(command))).collect();
        if let Some((number, _)) = self.expelled.filter(|(_, at)| *at == tick) {
            let body = BodyId::from_parts(number, 0);
            due.push(Command::SetPosition { body, position: Vec2::new(limits::POSITION, Fx::ZERO) });
            due.push(Command::SetVelocity { body, velocity: Vec2::new(limits::SPEED, Fx::ZERO) });
        }
        due
    }

    /// With or without bystanders: what becomes of the others, and how many bystanders are, or were, and were quarantined.
    fn play(&self, with_bystanders: bool, mut see: impl FnMut(u64, String) -> Verdict) -> Result<[usize; 2], String> {
        let mut world = World::new(self.plan.world).map_err(|error| error.to_string())?;
        let (mut cast, mut strange) = (Cast::default(), Cast::default());
        let mut quarantined = 0;
        if with_bystanders && self.throng {
            let bystander = BodyDef { velocity: Vec2::X, force_groups: BYSTANDERS, ..BodyDef::kinematic() };
            for i in 0..THRONG {
                let position = Vec2::new(Fx::from(i), Fx::from(-1_000));
                world.add_body(BodyDef { position, ..bystander.clone() }).map_err(|error| error.to_string())?;
            }
        }
        for tick in 0..self.plan.ticks {
            let mut turns = self.turns.iter().copied().cycle();
            let mut own_due = self.own(tick).into_iter().peekable();
            let strange_due = if with_bystanders { self.strange(tick) } else { Vec::new() };
            let mut strange_due = strange_due.into_iter().peekable();
            let mut told = String::new();
            while own_due.peek().is_some() || strange_due.peek().is_some() {
                let bystanders_turn = turns.next().unwrap_or(false);
                if let Some(command) = strange_due.next_if(|_| bystanders_turn || own_due.peek().is_none()) {
                    strange.carry_out(&mut world, &command);
                } else if let Some(command) = own_due.next() {
                    let done = world.execute(&cast.command(&command));
                    told += &kind(done);
                    if let Ok(created) = done {
                        cast.made(&world, created);
                    }
                }
            }
            world.step();
            let report = world.last_report();
            quarantined += numbers(&strange, report.faults.iter().map(|fault| fault.body)).len();
            let faults = numbers(&cast, report.faults.iter().map(|fault| fault.body));
            let (slept, woke) = (report.fell_asleep, report.woke);
            let [slept, woke] = [slept, woke].map(|bodies| numbers(&cast, bodies.iter().copied()));
            let picture = seen(&world, &cast);
            see(tick, format!("{told}, {faults:?} {slept:?} {woke:?}: {picture:?}"))?;
        }
        Ok([strange.bodies.len(), quarantined])
    }

    fn is_closed(&self) -> Verdict {
        let mut alone = Vec::new();
        self.play(false, |_, picture| {
            alone.push(picture);
            Ok(())
        })?;
        let beside = |tick: u64, picture: String| {
            if alone[tick as usize] == picture {
                return Ok(());
            }
            Err(format!("at tick {tick}: {picture}\nand alone: {}", alone[tick as usize]))
        };
        self.on_threads(|| self.play(true, beside)).map(drop)
    }

    #[cfg(feature = "parallel")]
    fn on_threads<T: Send>(&self, run: impl FnOnce() -> T + Send) -> T {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(self.threads).build().expect("a pool");
        pool.install(run)
    }

    #[cfg(not(feature = "parallel"))]
    fn on_threads<T>(&self, run: impl FnOnce() -> T) -> T {
        run()
    }

    /// The run with all bystanders, but for the throng.
    fn script(&self) -> Script {
        let mut world = World::new(self.plan.world).expect("plans have fair worlds");
        let (mut cast, mut strange, mut commands) = (Cast::default(), Cast::default(), Vec::new());
        for tick in 0..self.plan.ticks {
            // Without turns: bystanders last.
            for command in self.own(tick) {
                commands.push((tick, cast.carry_out(&mut world, &command)));
            }
            for command in self.strange(tick) {
                commands.push((tick, strange.carry_out(&mut world, &command)));
            }
            world.step();
        }
        Script { world: self.plan.world, commands, ticks: self.plan.ticks }
    }
}

fn companies() -> impl Strategy<Value = Company> {
    let taste = Taste { near: 3, ..FAIR };
    let deeds = || vec((0..taste.ticks, taste.command()), 0..14);
    let bystanders = (vec(taste.body(), 0..=17), vec(taste.field(), 0..9), deeds());
    let expelled = proptest::option::of((0u32..17, 0..taste.ticks / 2));
    let throng = proptest::bool::weighted(if cfg!(feature = "parallel") { 0.03 } else { 0.0 });
    (taste.plan(), bystanders, vec(any::<bool>(), 1..8), expelled, 1usize..4, throng).prop_map(
        |(plan, (bodies, fields, deeds), turns, expelled, threads, throng)| {
            let bystanders = Plan { bodies, fields, deeds, ..plan.clone() };
            Company { plan, bystanders, turns, expelled, threads, throng, friends: false }
        },
    )
}

#[test]
fn the_order_in_which_a_world_is_built_changes_no_bit_and_neither_do_bystanders() {
    let taste = Taste { near: 3, ..FAIR };
    judge("closure", 50, taste.plan(), Oracle::Order);
    judge("closure", 20, taste.plan(), Oracle::Bystanders);
}

#[test]
fn bystanders_change_no_bit_of_a_body() {
    check_of("closure", 150, companies(), Company::script, Company::is_closed);
}

/// Each of this happens in companies that are made up.
#[test]
fn bystanders_come_in_all_numbers_and_sleep_and_leave() {
    let happens = |what: &str, happens: fn(&Company) -> bool| {
        assert!(there_is(companies(), happens), "{what}");
    };
    let quarantined: fn(&Company) -> bool =
        |company| company.play(true, |_, _| Ok(())).is_ok_and(|[_, quarantined]| quarantined > 0);
    happens("none", |company| company.play(true, |_, _| Ok(())) == Ok([0, 0]));
    happens("seventeen", |company| company.bystanders.bodies.len() == 17);
    happens("one is quarantined", quarantined);
    happens("one of the others sleeps beside a field of theirs that reaches far", |company| {
        let end = company.script().run().expect("a fair world");
        let is_far = |field: &ForceField| !matches!(field.kind, FieldKind::Spring { .. } | FieldKind::Thrust { .. });
        end.fields().any(|(_, field)| field.force_groups == BYSTANDERS && is_far(field))
            && end.bodies().any(|body| body.force_groups() & !BYSTANDERS != 0 && body.activity() == Activity::Asleep)
    });
    happens("they are tied to each other", |company| {
        let end = company.script().run().expect("a fair world");
        let strange = |body: BodyId| end.body(body).is_ok_and(|body| body.force_groups() == BYSTANDERS);
        end.fields().any(|(_, field)| matches!(field.kind, FieldKind::Spring { near, .. } if strange(near.body)))
    });
    happens("one is asleep", |company| {
        let end = company.script().run().expect("a fair world");
        end.bodies().any(|body| body.force_groups() == BYSTANDERS && body.activity() == Activity::Asleep)
    });
    happens("one is removed", |company| {
        let end = company.script().run().expect("a fair world");
        let added = company.bystanders.bodies.len() + company.plan.bodies.len();
        end.body_count() < added && company.plan.deeds.is_empty()
    });
}

#[test]
fn a_friend_taken_for_a_stranger_is_found_out() {
    let friends = companies().prop_map(|company| Company { friends: true, ..company });
    assert!(there_is(friends, |company| company.is_closed().is_err()));
}
