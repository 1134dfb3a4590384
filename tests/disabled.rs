//! Disabled bodies: out of the simulation as they are, with what is attached to them inert, and back in it.

use umbra_physics::{
    Activity, Attachment, BodyDef, BodyId, BodyKind, Damping, End, Error, FieldKind, FxFactor, FxWide, Integrator,
    Locks, Snapshot, SpringConstants, World, WorldDef, fx, vec2,
};

fn world(integrator: Integrator) -> World {
    let gravity = vec2(fx!(0.5), -10);
    let def = WorldDef {
        integrator,
        gravity,
        linear_damping: Damping::kept_per_second(fx!(0.9)),
        sleep_after: Some(4),
        ..WorldDef::default()
    };
    World::new(def).expect("a world")
}

fn join(world: &mut World, start: BodyId, far: BodyId) {
    let spring = SpringConstants { rest: fx!(1), stiffness: fx!(20), damping: fx!(1) };
    let start = Attachment { body: start, point: vec2(fx!(0.5), 0) };
    world
        .add_field(FieldKind::Spring { near: start, far: End::Body(Attachment::centre(far)), spring })
        .expect("a field");
}

/// Every known value of a body, as text.
fn all(world: &World, body: BodyId) -> String {
    let body = world.body(body).expect("it is there");
    let (x, v) = (body.position_exact(), body.velocity_exact());
    format!("{x} {v} {} {} {:?}", body.angle_exact(), body.angular_velocity_exact(), body.activity())
}

#[test]
fn a_disabled_body_stays_as_it_is_and_goes_on_as_it_was() {
    for integrator in Integrator::ALL {
        for kind in [BodyKind::Dynamic, BodyKind::Kinematic, BodyKind::Static] {
            let mut world = world(integrator);
            let moves = kind != BodyKind::Static;
            let velocity = if moves { vec2(3, 4) } else { vec2(0, 0) };
            let spin = if moves { fx!(2) } else { fx!(0) };
            let def = BodyDef { kind, velocity, angular_velocity: spin, ..BodyDef::dynamic() };
            let [body, twin] = [def.clone(), def].map(|def| world.add_body(def).expect("a body"));
            (0..3).for_each(|_| _ = world.step());
            world.disable(body).expect("it takes part");
            assert!(!world.body(body).expect("it is there").activity().takes_part());
            let still = all(&world, body);
            let mut twin_alone = world.clone();
            (0..5).for_each(|_| _ = world.step());
            assert_eq!(all(&world, body), still, "{integrator:?}, {kind:?}");
            // Back in, it goes where its twin went from there.
            world.enable(body).expect("it is disabled");
            (0..5).for_each(|_| _ = world.step());
            (0..5).for_each(|_| _ = twin_alone.step());
            let last = world.body(body).expect("it is there").last_tick_free(&twin_alone, twin);
            assert!(last, "{integrator:?}, {kind:?}: {} and {}", all(&world, body), all(&twin_alone, twin));
        }
    }
}

trait Twins {
    /// Returns true if the body equals its twin in another world, handles apart.
    fn last_tick_free(&self, world: &World, twin: BodyId) -> bool;
}

impl Twins for umbra_physics::BodyRef<'_> {
    fn last_tick_free(&self, world: &World, twin: BodyId) -> bool {
        let twin = world.body(twin).expect("it is there");
        self.position_exact() == twin.position_exact()
            && self.velocity_exact() == twin.velocity_exact()
            && self.angle_exact() == twin.angle_exact()
            && self.angular_velocity_exact() == twin.angular_velocity_exact()
    }
}

#[test]
fn fields_attached_to_a_disabled_body_are_inert() {
    let mu = FxFactor::from_scalar(fx!(50));
    for integrator in Integrator::ALL {
        let run = |is_there: bool| {
            let mut world = world(integrator);
            let body = world.add_body(BodyDef { position: vec2(5, 0), ..BodyDef::dynamic() }).expect("a body");
            let partner = world.add_body(BodyDef { position: vec2(2, 1), ..BodyDef::dynamic() }).expect("a body");
            if is_there {
                join(&mut world, body, partner);
                let centre = End::Body(Attachment::centre(partner));
                world.add_field(FieldKind::Attractor { centre, mu, softening: fx!(1) }).expect("a field");
                world
                    .add_field(FieldKind::Thrust { at: Attachment::centre(partner), force: vec2(0, 9) })
                    .expect("a field");
                world.disable(partner).expect("it takes part");
            }
            let mut way = Vec::new();
            for _ in 0..30 {
                world.step();
                way.push(all(&world, body));
            }
            (way, world.momentum().expect("it fits"), world.potential_energy().expect("it fits"), partner, world)
        };
        let ((with, momentum, potential, partner, world), (without, alone, _, free, world_alone)) =
            (run(true), run(false));
        assert_eq!(with, without, "{integrator:?}");
        // The totals are of those that take part.
        let free_momentum = world_alone.body(free).expect("it is there").momentum();
        let plus = |a: FxWide, b: FxWide| a.to_bits() + b.to_bits();
        assert_eq!(plus(momentum.x, free_momentum.x), alone.x.to_bits());
        assert_eq!(plus(momentum.y, free_momentum.y), alone.y.to_bits());
        let out = world.body(partner).expect("it is there");
        assert_eq!((out.momentum(), out.kinetic_energy()), (umbra_physics::Vec2::default(), Ok(FxWide::default())));
        let mut gone = world.clone();
        gone.remove_body(partner).expect("it is there");
        assert_eq!(gone.potential_energy(), Ok(potential));
    }
}

/// Bystanders' bits do not depend on who is disabled, asleep or awake themselves.
#[test]
fn strangers_notice_nothing() {
    let run = |disables: bool| {
        let mut world = world(Integrator::VelocityVerlet);
        let ids: Vec<BodyId> = (0..300)
            .map(|i| {
                let def = BodyDef { position: vec2(i, 0), velocity: vec2(0, i % 3), ..BodyDef::dynamic() };
                let sleepy = BodyDef { gravity_scale: fx!(0), velocity: vec2(0, 0), ..def.clone() };
                world.add_body(if i % 5 == 0 { sleepy } else { def }).expect("a body")
            })
            .collect();
        for tick in 0..40 {
            if disables && tick % 3 == 1 {
                world.disable(ids[7 * (tick / 3)]).expect("it takes part");
            }
            if disables && tick % 6 == 5 {
                world.enable(ids[7 * ((tick - 4) / 3)]).expect("it is disabled");
            }
            world.step();
        }
        ids.iter().map(|&id| all(&world, id)).collect::<Vec<_>>()
    };
    for (i, (with, without)) in run(true).iter().zip(run(false)).enumerate() {
        // Of those that were touched the sleepers may be awake.
        assert!(i % 7 == 0 && i < 98 || *with == without, "body {i}: {with} and {without}");
    }
}

#[test]
fn bodies_joined_to_a_body_wake_when_it_is_disabled_and_enabled() {
    let mut world = World::new(WorldDef { sleep_after: Some(4), ..WorldDef::default() }).expect("a world");
    let [left, middle, right, bystander] =
        [-1, 0, 1, 9].map(|x| world.add_body(BodyDef { position: vec2(x, 0), ..BodyDef::dynamic() }).expect("a body"));
    for far in [left, right] {
        let spring = SpringConstants { rest: fx!(1), stiffness: fx!(20), damping: fx!(1) };
        let near = Attachment::centre(middle);
        world.add_field(FieldKind::Spring { near, far: End::Body(Attachment::centre(far)), spring }).expect("a field");
    }
    let activities = |world: &World| [left, middle, right, bystander].map(|id| world.body(id).expect("one").activity());
    let sleep = |world: &mut World| (0..12).for_each(|_| _ = world.step());
    use Activity::{Asleep, Awake, Disabled};
    sleep(&mut world);
    assert_eq!(activities(&world), [Asleep; 4]);
    world.disable(middle).expect("it takes part");
    assert_eq!(activities(&world), [Awake, Disabled, Awake, Asleep]);
    assert_eq!(world.step().woke, [left, right], "one that is out is not reported as woken");
    sleep(&mut world);
    assert_eq!(activities(&world), [Asleep, Disabled, Asleep, Asleep]);
    // Nothing is joined by it while it is out.
    world.wake(left).expect("it sleeps");
    assert_eq!(activities(&world), [Awake, Disabled, Asleep, Asleep]);
    sleep(&mut world);
    world.enable(middle).expect("it is disabled");
    assert_eq!(activities(&world), [Awake, Awake, Awake, Asleep]);
}

/// An attractor whose carrier is out keeps nobody awake, and wakes those it acts on when it is back.
#[test]
fn an_inert_attractor_lets_sleep() {
    let mut world = World::new(WorldDef { sleep_after: Some(4), ..WorldDef::default() }).expect("a world");
    let body = world.add_body(BodyDef::dynamic()).expect("a body");
    let carrier = world.add_body(BodyDef { position: vec2(9, 0), ..BodyDef::kinematic() }).expect("a body");
    let mu = FxFactor::from_scalar(fx!(1));
    world.disable(carrier).expect("it takes part");
    let centre = End::Body(Attachment::centre(carrier));
    world.add_field(FieldKind::Attractor { centre, mu, softening: fx!(1) }).expect("a field");
    (0..12).for_each(|_| _ = world.step());
    assert_eq!(world.body(body).expect("it is there").activity(), Activity::Asleep);
    world.enable(carrier).expect("it is disabled");
    world.step();
    assert!(world.body(body).expect("it is there").velocity().x > fx!(0));
}

#[test]
fn a_disabled_body_refuses_forces_and_takes_other_changes() {
    let mut world = world(Integrator::VelocityVerlet);
    let body = world.add_body(BodyDef::dynamic()).expect("a body");
    assert_eq!(world.enable(body), Err(Error::NotDisabled { body }));
    world.apply_force(body, vec2(1, 0)).expect("a force");
    world.disable(body).expect("it takes part");
    let before = world.state_hash();
    let out = Err(Error::Disabled { body });
    assert_eq!(world.disable(body), out);
    assert_eq!(
        (world.wake(body), world.apply_force(body, vec2(1, 0)), world.set_kind(body, BodyKind::Static)),
        (out, out, out)
    );
    assert_eq!(world.release(body), Err(Error::NotQuarantined { body }));
    assert_eq!(world.state_hash(), before);
    assert_eq!(world.body(body).expect("it is there").applied_force(), Some(umbra_physics::Vec2::default()));
    // It can be changed, as a snapshot of it can be read.
    world.set_position(body, vec2(7, 7)).expect("inside");
    world.set_velocity(body, vec2(1, 1)).expect("inside");
    world.set_locks(body, Locks { x: true, ..Locks::NONE }).expect("it is there");
    let read = Snapshot::from_bytes(&world.snapshot().to_bytes(), &[]).expect("sound").into_world();
    assert_eq!(read.state_hash(), world.state_hash());
    assert_eq!(world.step().applied, []);
    assert_eq!(world.moving_count(), 0);
    world.enable(body).expect("it is disabled");
    world.step();
    assert_eq!(world.body(body).expect("it is there").position().x, fx!(7));
    // One in quarantine is not disabled, and cannot be.
    let lost = BodyDef { position: vec2(1_073_741_823, 0), velocity: vec2(900_000, 0), ..BodyDef::dynamic() };
    let lost = world.add_body(lost).expect("a body");
    world.step();
    assert_eq!(world.disable(lost), Err(Error::Quarantined { body: lost }));
    assert_eq!(world.enable(lost), Err(Error::NotDisabled { body: lost }));
    world.disable(body).expect("it takes part");
    assert_eq!(world.remove_body(body), Ok(()));
    assert_eq!(world.enable(body), Err(Error::NoSuchBody { body }));
}

#[test]
fn a_step_in_which_it_was_out_is_undone() {
    let def = WorldDef { gravity: vec2(0, -10), sleep_after: None, ..WorldDef::default() };
    let mut world = World::new(def).expect("a world");
    let [body, out] =
        [1, 2].map(|x| world.add_body(BodyDef { velocity: vec2(x, 0), ..BodyDef::dynamic() }).expect("one"));
    join(&mut world, body, out);
    let spring = world.fields().next().expect("a spring").0;
    let FieldKind::Spring { near, far, spring: law } = world.field(spring).expect("a spring").kind else {
        panic!("a spring")
    };
    world
        .set_field(spring, FieldKind::Spring { near, far, spring: SpringConstants { damping: fx!(0), ..law } })
        .expect("fair");
    world.disable(out).expect("it takes part");
    let before = world.state_hash();
    world.step();
    assert_eq!(world.step_back(&[]), Ok(()));
    assert_eq!(world.state_hash(), before);
}

#[test]
fn forces_on_a_body_that_was_disabled_since_are_not_undone() {
    let mut world = World::new(WorldDef { sleep_after: None, ..WorldDef::default() }).expect("a world");
    let bodies = [(); 2].map(|()| world.add_body(BodyDef::dynamic()).expect("a body"));
    world.apply_force(bodies[1], vec2(1, 0)).expect("it is dynamic");
    let applied = world.step().applied.to_vec();
    world.disable(bodies[1]).expect("it takes part");
    let before = world.state_hash();
    assert_eq!(world.step_back(&applied), Err(Error::Disabled { body: bodies[1] }));
    assert_eq!(world.state_hash(), before);
    world.set_integrator(Integrator::PublishedVerlet).expect("it can be");
    world.step();
}

/// A body woken by a call before a step that is undone is woken before the next one, unless it is out by then.
#[test]
fn a_body_woken_before_an_undone_step_and_disabled_since_is_not_reported_as_woken() {
    let mut world = World::new(WorldDef { sleep_after: Some(1), ..WorldDef::default() }).expect("a world");
    let [body, bystander] =
        [1, 2].map(|x| world.add_body(BodyDef { position: vec2(x, 0), ..BodyDef::dynamic() }).expect("a body"));
    world.step();
    assert_eq!(world.bodies().map(|b| b.activity()).collect::<Vec<_>>(), [Activity::Asleep; 2]);
    world.set_sleep_after(None).expect("it can be");
    assert_eq!(world.step().woke, [body, bystander]);
    world.disable(body).expect("it takes part");
    assert_eq!(world.step_back(&[]), Ok(()));
    assert_eq!(world.step().woke, [bystander]);
}
