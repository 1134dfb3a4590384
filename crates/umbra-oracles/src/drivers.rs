//! Drivers that check what is done to a world while they do it.

#[cfg(feature = "parallel")]
use std::cell::Cell;

use super::Handles;
use super::handles::all_made;
use super::nears_sleeper;
#[cfg(feature = "parallel")]
use umbra_physics::Integrator;
use umbra_physics::{Activity, BodyId, Command, Created, Difference, Error, Fx, Owner, Stepper, World};

/// A fault that a driver saw.
pub(super) struct Seen {
    pub(super) beside: &'static str,
    pub(super) difference: Option<Difference>,
}

/// A driver that sees what is wrong.
pub(super) trait Inspector: Stepper {
    /// The first that was wrong.
    fn seen(&mut self) -> Option<Seen>;
    /// The reason why there was nothing to check; `None` if there was.
    fn idle(&self) -> Option<&'static str>;
}

impl Inspector for () {
    fn seen(&mut self) -> Option<Seen> {
        None
    }

    fn idle(&self) -> Option<&'static str> {
        None
    }
}

/// Compares two worlds that have to be equal.
pub(super) fn unlike(beside: &'static str, left: &World, right: &World) -> Option<Seen> {
    let is_same = left.state_hash() == right.state_hash();
    (!is_same).then(|| Seen { beside, difference: left.differences(right).into_iter().next() })
}

/// Calls `check` before each command.
#[derive(Default)]
pub(super) struct Asking {
    seen: Option<Seen>,
    has_asked: bool,
}

impl Stepper for Asking {
    fn execute(&mut self, world: &mut World, command: &Command) -> Result<Created, Error> {
        self.has_asked = true;
        let before = world.state_hash();
        let said = world.check(command);
        let none = |beside| Some(Seen { beside, difference: None });
        if self.seen.is_none() && world.state_hash() != before {
            self.seen = none("a check that changed the world");
        }
        let kept = said.is_err().then(|| world.clone());
        let done = world.execute(command);
        if self.seen.is_none() && said != done.map(drop) {
            self.seen = none("a check that said otherwise");
        }
        if let (None, Err(_), Some(kept)) = (&self.seen, &done, kept) {
            self.seen = unlike("a command that was refused", &kept, world);
        }
        done
    }

    fn step(&mut self, world: &mut World) {
        world.step();
    }
}

impl Inspector for Asking {
    fn seen(&mut self) -> Option<Seen> {
        self.seen.take()
    }

    fn idle(&self) -> Option<&'static str> {
        (!self.has_asked).then_some("no command was given to the driver")
    }
}

/// Undoes each step, and makes it again.
#[derive(Default)]
pub(super) struct Undoing {
    seen: Option<Seen>,
    has_undone: bool,
}

impl Stepper for Undoing {
    fn execute(&mut self, world: &mut World, command: &Command) -> Result<Created, Error> {
        world.execute(command)
    }

    fn step(&mut self, world: &mut World) {
        let before = world.clone();
        let applied = world.step().applied.to_vec();
        let after = world.clone();
        let is_undone = world.step_back(&applied).is_ok();
        let mut fault;
        if is_undone {
            self.has_undone = true;
            fault = unlike("a step that was undone", &before, world);
            world.step();
            fault = fault.or_else(|| unlike("a step that was undone and made again", &after, world));
        } else {
            fault = unlike("a step that could not be undone", &after, world);
        }
        if fault.is_none() && world.last_report() != after.last_report() {
            fault = Some(Seen { beside: "the report of a step that was undone", difference: None });
        }
        self.seen = self.seen.take().or(fault);
    }
}

impl Inspector for Undoing {
    fn seen(&mut self) -> Option<Seen> {
        self.seen.take()
    }

    fn idle(&self) -> Option<&'static str> {
        (!self.has_undone).then_some("no step of it can be undone")
    }
}

/// Takes a copy through each step by the other ways there are.
#[derive(Default)]
pub(super) struct Detours {
    seen: Option<Seen>,
    has_stepped: bool,
    /// The bodies that a command has put to sleep, and that sleep: they would not rest if they were awake.
    put_to_sleep: Vec<BodyId>,
}

impl Stepper for Detours {
    fn execute(&mut self, world: &mut World, command: &Command) -> Result<Created, Error> {
        if !matches!(command, Command::Sleep(_)) {
            return world.execute(command);
        }
        let awake = world.bodies().filter(|body| body.activity() == Activity::Awake);
        let awake: Vec<BodyId> = awake.map(|body| body.id()).collect();
        let created = world.execute(command)?;
        self.put_to_sleep.extend(awake.into_iter().filter(|&body| sleeps(world, body)));
        Ok(created)
    }

    fn step(&mut self, world: &mut World) {
        self.has_stepped = true;
        // A trace takes all bodies stage by stage, free ones as well.
        let mut traced = world.clone();
        traced.step_traced();
        let mut awake = world.clone();
        // With contacts and joints, bodies that are slow stop when they fall asleep.
        self.put_to_sleep.retain(|&body| sleeps(world, body));
        let are_free = world.collider_count() == 0 && world.joint_count() == 0;
        let is_exact = are_free || world.def().contacts.sleep_speed == Fx::ZERO;
        let was_near = nears_sleeper(world);
        let is_awake = awake.set_sleep_after(None).is_ok() && is_exact;
        awake.step();
        world.step();
        // Only an awake body slows one that is pushed towards it, before they touch.
        let is_awake = is_awake && self.put_to_sleep.is_empty() && !was_near && !nears_sleeper(world);
        let fault = unlike("a step that was traced", world, &traced)
            .or_else(|| moved_unlike("a step with all bodies awake", world, &awake).filter(|_| is_awake));
        self.seen = self.seen.take().or(fault);
    }
}

impl Inspector for Detours {
    fn seen(&mut self) -> Option<Seen> {
        self.seen.take()
    }

    fn idle(&self) -> Option<&'static str> {
        (!self.has_stepped).then_some("no step was made by the driver")
    }
}

fn sleeps(world: &World, body: BodyId) -> bool {
    world.body(body).is_ok_and(|body| body.activity() == Activity::Asleep)
}

/// Compares how two worlds moved the same bodies, and what they report of it. No body sleeps in the right one.
fn moved_unlike(beside: &'static str, left: &World, right: &World) -> Option<Seen> {
    let is_same = left.bodies().zip(right.bodies()).all(|(a, b)| {
        (a.position_exact(), a.velocity_exact(), a.angle_exact(), a.angular_velocity_exact())
            == (b.position_exact(), b.velocity_exact(), b.angle_exact(), b.angular_velocity_exact())
    });
    let (a, b) = (left.last_report(), right.last_report());
    // A sleeping body is not stepped, so its drag is not counted.
    let any_asleep = left.bodies().any(|body| body.activity() == Activity::Asleep);
    let is_counted = a.drag_outside == b.drag_outside || (any_asleep && a.drag_outside < b.drag_outside);
    if is_same && is_counted && a.faults == b.faults {
        return None;
    }
    let moves = |difference: &Difference| {
        let name = difference.field.split('.').next().unwrap_or_default();
        let is_motion = matches!(name, "position" | "velocity" | "angle" | "angular_velocity");
        is_motion && matches!(difference.owner, Owner::Body(_))
    };
    Some(Seen { beside, difference: left.differences(right).into_iter().find(moves) })
}

/// Notes what is made.
#[derive(Default)]
pub(super) struct Noting {
    pub(super) made: Vec<Created>,
}

impl Stepper for Noting {
    fn execute(&mut self, world: &mut World, command: &Command) -> Result<Created, Error> {
        let created = world.execute(command)?;
        self.made.extend(all_made(world, created));
        Ok(created)
    }

    fn step(&mut self, world: &mut World) {
        world.step();
    }
}

/// Does in another run of the same inputs what was done in a first one, and pairs what is made in both.
pub(super) struct Pairing<'a, D> {
    pub(super) handles: &'a mut Handles,
    /// The bodies, fields and colliders that the first run made in this tick, in order.
    pub(super) made: std::vec::IntoIter<Created>,
    /// True if commands name the handles of the first run.
    pub(super) translates: bool,
    pub(super) inner: D,
}

impl<D: Stepper> Stepper for Pairing<'_, D> {
    fn execute(&mut self, world: &mut World, command: &Command) -> Result<Created, Error> {
        let renamed = self.translates.then(|| self.handles.command(command));
        let created = self.inner.execute(world, renamed.as_ref().unwrap_or(command))?;
        for object in all_made(world, created) {
            if let Some(first) = self.made.next() {
                self.handles.pair(first, object);
            }
        }
        Ok(created)
    }

    fn step(&mut self, world: &mut World) {
        self.inner.step(world);
    }
}

/// Steps on some threads.
#[cfg(feature = "parallel")]
pub(super) struct OnThreads<'a> {
    pub(super) pool: &'a rayon::ThreadPool,
    /// Set by a step with free bodies, which threads share.
    pub(super) has_shared: &'a Cell<bool>,
}

#[cfg(feature = "parallel")]
impl Stepper for OnThreads<'_> {
    fn execute(&mut self, world: &mut World, command: &Command) -> Result<Created, Error> {
        world.execute(command)
    }

    fn step(&mut self, world: &mut World) {
        if world.def().integrator != Integrator::PublishedVerlet {
            self.has_shared.set(true);
        }
        self.pool.install(|| _ = world.step());
    }
}
