//! Observing a world: bodies by key, their events, and the bodies that changed.

#[path = "support/commands.rs"]
mod commands;
#[path = "support/random.rs"]
mod random;

use std::collections::{BTreeMap, BTreeSet};

use commands::{Author, is_global};
use random::SplitMix;
use umbra_physics::{
    Activity, BodyDef, BodyId, BodyKind, BodyRef, Cause, Command, Created, Event, Rollback, Snapshot, World, WorldDef,
    fx, vec2,
};

fn world(sleep_after: Option<u32>) -> World {
    World::new(WorldDef { sleep_after, ..WorldDef::default() }).expect("a fair definition")
}

fn add(world: &mut World, def: BodyDef) -> BodyId {
    world.add_body(def).expect("a fair body")
}

fn drifting() -> BodyDef {
    BodyDef { velocity: vec2(1, 0), ..BodyDef::dynamic() }
}

fn ids<'a>(bodies: impl Iterator<Item = BodyRef<'a>>) -> Vec<BodyId> {
    bodies.map(|body| body.id()).collect()
}

#[test]
fn bodies_with_a_key_come_by_slot_whatever_order_they_were_added_in() {
    let mut world = world(None);
    let keyed = |key| BodyDef { key, ..BodyDef::dynamic() };
    let [a, b, c] = [5, 6, 5].map(|key| add(&mut world, keyed(key)));
    world.remove_body(a).expect("it is there");
    // The last one added takes the first slot.
    let d = add(&mut world, keyed(5));
    assert_eq!(d.parts().0, 0);
    assert_eq!(ids(world.bodies_with_key(5)), [d, c]);
    assert_eq!(world.body_with_key(5).map(|body| body.id()), Some(d));
    world.set_key(d, 7).expect("it is there");
    assert_eq!(world.body_with_key(5).map(|body| body.id()), Some(c));
    assert_eq!(ids(world.bodies_with_key(6)), [b]);
    assert!(world.body_with_key(0).is_none());
}

#[test]
fn events_come_one_kind_after_the_other() {
    let mut world = world(Some(3));
    let [gone, placed, turned, kind] = [(); 4].map(|()| add(&mut world, drifting()));
    let [early, woken] = [(); 2].map(|()| add(&mut world, BodyDef::dynamic()));
    world.step();
    let late = add(&mut world, BodyDef::dynamic());
    world.step();
    assert_eq!(world.step().fell_asleep, [early, woken]);
    let edge = BodyDef { position: vec2(fx!(1_073_741_823), 0), velocity: vec2(1_000, 0), ..BodyDef::dynamic() };
    // In another order than that of the report, and some twice.
    world.wake(woken).expect("it is there");
    world.set_kind(kind, BodyKind::Kinematic).expect("it is there");
    world.set_position(placed, vec2(0, 5)).expect("it is there");
    world.set_angle(turned, fx!(1)).expect("it is there");
    world.set_angle(placed, fx!(1)).expect("it is there");
    let stray = add(&mut world, edge);
    world.set_position(stray, vec2(fx!(1_073_741_824), 0)).expect("it is there");
    world.remove_body(gone).expect("it is there");
    // Added and removed: nobody needs to know.
    let passing = add(&mut world, BodyDef::dynamic());
    assert_eq!(passing.parts(), (gone.parts().0, 1));
    world.remove_body(passing).expect("it is there");
    let new = add(&mut world, drifting());
    assert_eq!(new.parts(), (gone.parts().0, 2));
    let report = world.step();
    let events: Vec<Event> = report.events().collect();
    let cause = Cause::Position;
    let fault = report.faults[0];
    assert_eq!((report.faults.len(), fault.body, fault.cause), (1, stray, cause));
    let expected = [
        Event::Removed(gone),
        Event::Added(stray),
        Event::Added(new),
        Event::Placed(kind),
        Event::Placed(placed),
        Event::Placed(turned),
        Event::Woke(woken),
        Event::Quarantined(fault),
        Event::FellAsleep(late),
    ];
    assert_eq!(events, expected);
    // Nothing is told twice.
    assert!(world.step().events().next().is_none());
}

/// Every public value of a body, as text.
fn seen(body: &BodyRef<'_>) -> String {
    format!(
        "{:?}",
        (
            (body.position_exact(), body.velocity_exact(), body.angle_exact(), body.angular_velocity_exact()),
            (body.kind(), body.activity(), body.mass(), body.inertia(), body.inverse_mass(), body.inverse_inertia()),
            (body.mass_def(), body.gravity_scale(), body.linear_damping(), body.angular_damping(), body.locks()),
            (body.max_speed(), body.max_angular_speed(), body.goal(), body.force_groups(), body.key()),
            (body.user_data(), body.applied_force(), body.applied_torque()),
        )
    )
}

/// A world and what follows it by its events and its changes alone.
struct Watched {
    world: World,
    /// Public values of the bodies at the last look.
    known: BTreeMap<BodyId, String>,
    looked: u64,
    there: BTreeSet<BodyId>,
    /// Bodies that calls were about since the step before, and those that a call has put somewhere.
    touched: BTreeSet<BodyId>,
    put: BTreeSet<BodyId>,
    before: BTreeSet<BodyId>,
    /// Number of times that a body which no step moves was and was not among the changed ones.
    still: [u64; 2],
}

impl Watched {
    fn new(world: World) -> Self {
        let mut mirror = Self {
            world,
            known: BTreeMap::new(),
            looked: 0,
            there: BTreeSet::new(),
            touched: BTreeSet::new(),
            put: BTreeSet::new(),
            before: BTreeSet::new(),
            still: [0; 2],
        };
        mirror.start_over();
        mirror
    }

    fn start_over(&mut self) {
        self.looked = self.world.tick();
        self.known = self.world.bodies().map(|body| (body.id(), seen(&body))).collect();
        self.there = self.known.keys().copied().collect();
        self.before = self.there.clone();
        (self.touched, self.put) = Default::default();
    }

    fn execute(&mut self, command: &Command) {
        let owner = command.collider().and_then(|collider| self.world.collider_body(collider).ok());
        let joint = command.joint().and_then(|joint| self.world.joint(joint).ok()).map(|joint| joint.bodies());
        let joined = match command {
            Command::RemoveBody(body) => {
                let joints = self.world.joints_of(*body).into_iter().flatten();
                joints.flat_map(|joint| joint.bodies()).collect()
            }
            _ => joint.map_or(Vec::new(), Vec::from),
        };
        let Ok(created) = self.world.execute(command) else { return };
        let (Command::SetPosition { body, .. } | Command::SetAngle { body, .. } | Command::SetKind { body, .. }) =
            command
        else {
            self.touched.extend(joined.into_iter().flatten());
            if let Created::Joint(joint) = created {
                let bodies = self.world.joint(joint).expect("it was made").bodies();
                self.touched.extend(bodies.into_iter().flatten());
            }
            if let Command::ExcludePair { a, b, .. } | Command::AllowPair { a, b } = command {
                self.touched.extend([*a, *b]);
            }
            let named = if let Created::Body(body) = created { Some(body) } else { command.body() };
            return self.touched.extend(owner.or(named));
        };
        self.put.insert(*body);
        self.touched.insert(*body);
    }

    fn step(&mut self) {
        let report = self.world.step();
        let mut placed = BTreeSet::new();
        for event in report.events() {
            match event {
                Event::Removed(body) => assert!(self.there.remove(&body), "{body} removed"),
                Event::Added(body) => assert!(self.there.insert(body), "{body} added"),
                Event::Placed(body) => assert!(placed.insert(body), "{body} placed twice"),
                Event::Quarantined(fault) => _ = self.touched.insert(fault.body),
                Event::FellAsleep(body) => _ = self.touched.insert(body),
                _ => {}
            }
        }
        let now: BTreeSet<BodyId> = ids(self.world.bodies()).into_iter().collect();
        assert_eq!(self.there, now);
        let put: BTreeSet<BodyId> = &(&self.put & &self.before) & &now;
        assert_eq!(placed, put);
        self.put.clear();
        self.before = now;
    }

    /// Bodies that changed since the last look, in order, and no others but moving ones.
    fn look(&mut self) {
        let changed = ids(self.world.changed_since(self.looked));
        let in_order: Vec<u32> = changed.iter().map(|body| body.parts().0).collect();
        assert!(in_order.is_sorted() && in_order.windows(2).all(|pair| pair[0] != pair[1]));
        let changed: BTreeSet<BodyId> = changed.into_iter().collect();
        for body in self.world.bodies() {
            let (id, now) = (body.id(), seen(&body));
            let before = self.known.insert(id, now.clone());
            assert!(before.as_ref() == Some(&now) || changed.contains(&id), "{id}: {before:?} to {now}");
            let is_still = body.kind() == BodyKind::Static || body.activity() != Activity::Awake;
            if is_still {
                self.still[usize::from(changed.contains(&id))] += 1;
                assert!(!changed.contains(&id) || self.touched.contains(&id), "{id} is as it was");
            } else {
                assert!(changed.contains(&id), "{id} moves");
            }
        }
        self.looked = self.world.tick();
        self.touched.clear();
    }
}

#[test]
fn an_observer_of_events_and_changes_knows_all_bodies() {
    let mut still = [0; 2];
    for seed in 0..crate::seeds::times(4) {
        let mut author = Author { random: SplitMix::seeded(seed), unfair: 64 };
        let mut world = world(Some(4));
        for _ in 0..30 {
            _ = world.add_body(author.body());
        }
        world.step();
        let mut watched = Watched::new(world);
        let mut saved: Snapshot = watched.world.snapshot();
        for round in 0..150u64 {
            for _ in 0..author.random.next() % 3 {
                let command = author.any(&watched.world);
                let is_crowded = matches!(command, Command::AddBody(_)) && watched.world.body_count() > 60;
                // Bodies would hardly sleep if a command woke all of them in each round.
                if !(is_crowded || is_global(&command) && round % 16 != 0) {
                    watched.execute(&command);
                }
            }
            watched.step();
            if author.one_in(3) {
                watched.look();
            }
            if author.one_in(25) {
                watched.world.snapshot_into(&mut saved);
            }
            if author.one_in(40) {
                let left = watched.world.tick();
                watched.world.restore(&saved);
                assert_eq!(watched.world.changed_since(left).count(), watched.world.body_count());
                watched.start_over();
                // Up to where it had been all is new, and then no more.
                while watched.world.tick() <= left {
                    watched.step();
                    assert_eq!(watched.world.changed_since(left).count(), watched.world.body_count());
                }
                watched.start_over();
            }
        }
        (0..2).for_each(|i| still[i] += watched.still[i]);
    }
    assert!(still.iter().all(|&count| count > crate::seeds::times(20)), "{still:?}");
}

#[test]
fn a_match_after_another_in_the_same_memory_sees_changes_from_its_start() {
    let mut old = world(None);
    add(&mut old, BodyDef::fixed());
    (0..1_000).for_each(|_| _ = old.step());
    let mut kept = old.snapshot();
    let mut new = world(None);
    let [wall, ball] = [add(&mut new, BodyDef::fixed()), add(&mut new, drifting())];
    (0..3).for_each(|_| _ = new.step());
    new.snapshot_into(&mut kept);
    new.step();
    new.restore(&kept);
    assert_eq!(ids(new.changed_since(4)), [wall, ball]);
    (0..2).for_each(|_| _ = new.step());
    // The former contents of the memory do not count as a past of this world.
    assert_eq!(ids(new.changed_since(5)), [ball]);
}

#[test]
fn each_call_that_sets_a_world_back_counts_and_a_clone_counts_on() {
    let mut world = world(None);
    let wall = add(&mut world, BodyDef::fixed());
    let mut rollback = Rollback::new(&world, [0], 8).with_prediction(|_| false);
    let tick = |world: &mut World, inputs: &[(u32, bool)]| {
        if inputs[0].1 {
            world.wake(wall).expect("it is there");
        }
    };
    for _ in 0..6 {
        rollback.advance(&mut world, tick).expect("unchanged");
    }
    assert_eq!(world.rewinds(), 0);
    let still = |world: &World, since| world.changed_since(since).count();
    assert_eq!((still(&world, 5), still(&world, 6)), (0, 0));
    // The wall was woken in tick 4: ticks 4 and 5 are made again, and one more.
    rollback.add_input(4, 0, true).expect("a player");
    assert_eq!(rollback.advance(&mut world, tick).expect("unchanged").redone, 2);
    assert_eq!((world.rewinds(), still(&world, 5), still(&world, 6), still(&world, 7)), (1, 1, 1, 0));
    let twin = world.clone();
    assert_eq!((twin.rewinds(), still(&twin, 6), still(&twin, 7)), (1, 1, 0));
    world.clone_from(&twin);
    assert_eq!((world.rewinds(), still(&world, 7)), (2, 1));
    world.restore(&twin.snapshot());
    assert_eq!(world.rewinds(), 3);
    world.step_back(&[]).expect("it has a way back");
    assert_eq!((world.rewinds(), still(&world, 7)), (4, 1));
    world.set_sleep_after(Some(9)).expect("a fair number");
    assert!(world.step_back(&[]).is_err());
    assert_eq!(world.rewinds(), 4);
    // From bytes: nobody knows what was seen before.
    let restored = Snapshot::from_bytes(&world.snapshot().to_bytes(), &[]).expect("its own bytes").into_world();
    assert_eq!((still(&restored, 6), still(&restored, 7)), (1, 0));
    assert_eq!(still(restored.preview(wall).expect("it is there").world(), 6), 1);
}

#[test]
fn a_step_that_is_undone_reports_the_same_when_it_is_made_again() {
    let mut world = world(None);
    let bodies = [(); 4].map(|()| add(&mut world, drifting()));
    world.step();
    let new = add(&mut world, drifting());
    world.set_position(bodies[1], vec2(3, 3)).expect("it is there");
    world.remove_body(bodies[0]).expect("it is there");
    let events: Vec<Event> = world.step().events().collect();
    assert_eq!(events, [Event::Removed(bodies[0]), Event::Added(new), Event::Placed(bodies[1])]);
    let undo = |world: &mut World| world.step_back(&[]).expect("it has a way back");
    undo(&mut world);
    assert!(world.last_report().events().next().is_none());
    assert!(world.step().events().eq(events.iter().copied()));
    // With calls in between that take back or add to those before.
    world.set_position(bodies[1], vec2(4, 4)).expect("it is there");
    world.set_position(bodies[2], vec2(4, 4)).expect("it is there");
    world.remove_body(new).expect("it is there");
    undo(&mut world);
    let expected = [Event::Removed(bodies[0]), Event::Placed(bodies[1]), Event::Placed(bodies[2])];
    assert!(world.step().events().eq(expected));
}

#[test]
fn a_body_of_a_step_that_is_undone_is_added_and_not_placed_as_well() {
    let mut world = world(None);
    let new = add(&mut world, drifting());
    let at = world.body(new).expect("it is there").position();
    world.step();
    let end = world.body(new).expect("it is there").position();
    world.set_position(new, at).expect("it is there");
    world.set_position(new, end).expect("it is there");
    world.step_back(&[]).expect("it has a way back");
    assert!(world.step().events().eq([Event::Added(new)]));
}

#[test]
fn a_copy_made_between_calls_reports_all_of_them() {
    let mut world = world(None);
    let bodies = [(); 3].map(|()| add(&mut world, drifting()));
    world.step();
    let new = add(&mut world, drifting());
    world.set_position(bodies[0], vec2(3, 3)).expect("it is there");
    world.remove_body(bodies[2]).expect("it is there");
    // Into memory that has another world's calls pending.
    let mut reference = World::new(WorldDef::default()).expect("a fair definition");
    (0..4).for_each(|_| _ = add(&mut reference, drifting()));
    let [mut fresh, mut reused] = [world.clone(), reference];
    reused.clone_from(&world);
    for copy in [&mut fresh, &mut reused, &mut world] {
        copy.set_angle(bodies[0], fx!(1)).expect("it is there");
        copy.set_position(bodies[1], vec2(3, 3)).expect("it is there");
        copy.remove_body(new).expect("it is there");
        let expected = [Event::Removed(bodies[2]), Event::Placed(bodies[0]), Event::Placed(bodies[1])];
        assert!(copy.step().events().eq(expected));
    }
}

#[test]
fn bodies_that_come_and_go_without_a_step_do_not_add_up() {
    let mut world = world(None);
    let first = add(&mut world, drifting());
    world.step();
    for _ in 0..1_000 {
        let passing = add(&mut world, drifting());
        world.set_position(passing, vec2(1, 1)).expect("it is there");
        world.set_position(first, vec2(1, 1)).expect("it is there");
        world.remove_body(passing).expect("it is there");
    }
    assert!(world.step().events().eq([Event::Placed(first)]));
}
