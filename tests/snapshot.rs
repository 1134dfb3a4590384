//! A world that is restored is the world: in memory, from bytes, whatever happened in between.

use std::sync::Arc;

use umbra_physics::{
    Activity, Attachment, BodyDef, BodyId, BodyKind, BodyState, ColliderDef, CustomForce, CustomForceError, Damping,
    Dependence, End, Error, FieldKind, ForceField, ForceTorque, Fx, HashTree, Inputs, Integrator, Mass, Owner,
    PHYSICS_VERSION, Random, RecordOptions, Recorder, Region, Shape, Snapshot, SnapshotError, SpringConstants,
    TimeStep, Vec2, World, WorldDef, fx, vec2,
};

#[allow(dead_code, reason = "each test that takes this file in uses a part of it")]
#[path = "support/random.rs"]
mod random;
use random::SplitMix;

/// Pulls every body back to the origin by a tenth of its distance.
struct Tether(u32);

impl CustomForce for Tether {
    fn id(&self) -> u64 {
        7
    }
    fn version(&self) -> u32 {
        self.0
    }
    fn depends_on(&self) -> Dependence {
        Dependence::Position
    }
    fn push(&self, body: &BodyState) -> Result<ForceTorque, CustomForceError> {
        let tenth = |x: Fx| Fx::from_bits(-(x.to_bits() / 10));
        Ok(ForceTorque { force: body.position.map(tenth), torque: Fx::ZERO })
    }
}

fn custom_forces() -> Vec<Arc<dyn CustomForce>> {
    vec![Arc::new(Tether(1))]
}

fn shapes() -> Vec<Shape> {
    let box_ = Shape::rectangle(fx!(0.5), fx!(0.25)).expect("a shape");
    let part = |shape: &Shape, x| umbra_physics::Part {
        shape: shape.clone(),
        position: vec2(x, fx!(0.3)),
        angle: fx!(0.4),
        density: fx!(2),
    };
    let disc = Shape::circle(fx!(0.3)).expect("a shape");
    vec![
        disc.clone(),
        box_.clone(),
        Shape::capsule(fx!(1), fx!(0.1)).expect("a shape"),
        Shape::segment(vec2(fx!(0.1), 1), vec2(2, fx!(3.3))).expect("a shape"),
        // Clockwise, and not about its centre.
        Shape::polygon(&[vec2(3, 3), vec2(fx!(3.1), fx!(5.7)), vec2(4, fx!(4.2))]).expect("a shape"),
        Shape::compound(&[part(&box_, fx!(1.7)), part(&disc, fx!(-0.1))]).expect("a shape"),
    ]
}

/// A world with something of everything, after some ticks of random doings.
fn lived(integrator: Integrator, seed: u64, ticks: u32) -> World {
    let mut world = World::new(WorldDef {
        gravity: vec2(fx!(0.1), fx!(-3)),
        linear_damping: Damping::kept_per_second(fx!(0.9)),
        integrator,
        sleep_after: Some(4),
        ..WorldDef::default()
    })
    .expect("a world");
    world.register_custom_force(custom_forces().remove(0)).expect("a law");
    world.set_random(Random::seeded(seed));
    world.set_blob(b"whatever the game needs").expect("small");
    for tick in 0..ticks {
        meddle(&mut world, seed, tick);
        world.step();
    }
    // Something is pending as well.
    meddle(&mut world, seed, ticks);
    let first = world.bodies().find(|body| body.mass().is_some() && body.activity() == Activity::Awake);
    if let Some(body) = first.map(|body| body.id()) {
        world.apply_force_at_point(body, vec2(1, 2), vec2(3, 0)).expect("it is dynamic");
    }
    world
}

/// Random calls; those that are refused are no matter.
fn meddle(world: &mut World, seed: u64, tick: u32) {
    let mut dice = SplitMix::seeded(seed ^ u64::from(tick) << 32);
    let number = |dice: &mut SplitMix| Fx::from_bits(dice.between(-3 << 32, 3 << 32));
    let vector = |dice: &mut SplitMix| Vec2::new(number(dice), number(dice));
    for _ in 0..dice.next() % 5 {
        let ids: Vec<BodyId> = world.bodies().map(|body| body.id()).collect();
        let any = |dice: &mut SplitMix| ids.get((dice.next() % 64) as usize % ids.len().max(1)).copied();
        let target = any(&mut dice);
        let shape = shapes()[(dice.next() % 6) as usize].clone();
        match (dice.next() % 16, target) {
            (0..=4, _) | (_, None) => {
                let def = match dice.next() % 5 {
                    0 => BodyDef::fixed(),
                    1 => BodyDef { velocity: vector(&mut dice), ..BodyDef::kinematic() },
                    // Nothing acts on it, so it sleeps.
                    2 => BodyDef { gravity_scale: Fx::ZERO, force_groups: 0, ..BodyDef::dynamic() },
                    _ => BodyDef {
                        velocity: vector(&mut dice),
                        angular_velocity: number(&mut dice),
                        angular_damping: Some(Damping::kept_per_second(fx!(0.5))),
                        ..BodyDef::dynamic()
                    },
                };
                let (position, angle, key) = (vector(&mut dice), number(&mut dice), dice.next());
                let mass = if dice.next() & 1 == 0 {
                    Mass::FromColliders
                } else {
                    Mass::Explicit { mass: fx!(2), inertia: fx!(3) }
                };
                _ = world.add_body(BodyDef {
                    position,
                    angle,
                    key,
                    mass,
                    colliders: vec![ColliderDef::ghost(shape)],
                    ..def
                });
            }
            (5, Some(body)) => _ = world.remove_body(body),
            (6, Some(body)) => _ = world.apply_force_at_point(body, vector(&mut dice), vector(&mut dice)),
            (7, Some(body)) => _ = world.add_collider(body, ColliderDef::ghost(shape)),
            // Out of the envelope within a step or two.
            (8, Some(body)) => {
                _ = world.set_position(body, vec2(Fx::from_int(1 << 30), 0));
                _ = world.set_velocity(body, vec2(Fx::from_int(1 << 20), 0));
            }
            (9, Some(body)) => _ = world.set_user_data(body, dice.next()),
            (10, Some(start)) => {
                let far = any(&mut dice).map_or(End::World(vector(&mut dice)), |body| {
                    End::Body(Attachment { body, point: vec2(fx!(0.1), 0) })
                });
                let spring = SpringConstants { rest: fx!(1), stiffness: fx!(5), damping: fx!(0.1) };
                _ = world.add_field(FieldKind::Spring { near: Attachment::centre(start), far, spring });
            }
            (11, Some(_)) => {
                let law = match dice.next() % 4 {
                    0 => FieldKind::Custom { id: 7 },
                    1 => FieldKind::Drag { linear: fx!(0.1), quadratic: fx!(0.2), wind: vector(&mut dice) },
                    2 => FieldKind::Zone {
                        region: Region::Disc { centre: vector(&mut dice), radius: fx!(2) },
                        acceleration: vector(&mut dice),
                    },
                    _ => FieldKind::Attractor {
                        centre: End::World(vector(&mut dice)),
                        mu: "3.5".parse().expect("a factor"),
                        softening: fx!(0.5),
                    },
                };
                _ = world.add_field(ForceField { kind: law, force_groups: 1 });
            }
            (12, Some(body)) => {
                let field = world.fields().next().map(|(id, _)| id);
                _ = field.map(|id| world.remove_field(id));
                _ = world.release(body);
            }
            (13, Some(_)) => _ = world.set_time_step(TimeStep::ratio(1, 50 + (dice.next() % 3) as u32 * 10)),
            (14, Some(body)) => _ = [World::wake, World::sleep][dice.next() as usize % 2](world, body),
            (_, Some(_)) => {
                let drawn = world.random_mut().bits().to_le_bytes();
                world.set_blob(&drawn[..(dice.next() % 8) as usize]).expect("small");
            }
        }
    }
}

/// The hashes of some ticks to come, with the same doings.
fn future(world: &mut World, seed: u64, from: u32) -> Vec<u64> {
    let mut hashes = vec![world.state_hash()];
    for tick in from..from + 40 {
        meddle(world, seed, tick);
        world.step();
        hashes.push(world.state_hash());
    }
    hashes
}

fn seeds() -> u64 {
    crate::seeds::times(6)
}

#[test]
fn a_restored_world_has_the_same_future_and_handles() {
    let mut kinds = [false; 4];
    for integrator in Integrator::ALL {
        for seed in 0..seeds() {
            let mut world = lived(integrator, seed, 60 + seed as u32);
            kinds[0] |= world.bodies().any(|body| body.activity() == Activity::Asleep);
            kinds[1] |= world.bodies().any(|body| body.activity() == Activity::Quarantined);
            kinds[2] |= world.bodies().any(|body| body.id().parts().1 > 0);
            kinds[3] |= world.bodies().any(|body| body.applied_force() != Some(Vec2::default()));
            let saved = world.snapshot();
            let bytes = saved.to_bytes();
            let expected = future(&mut world, seed, 1_000);

            // Here, after whatever happened; elsewhere, from a buffer that was another world's; and from bytes.
            world.restore(&saved);
            assert_eq!(future(&mut world, seed, 1_000), expected, "{integrator:?}, {seed}: in memory");
            let mut buffer = lived(integrator, seed + 1, 9).snapshot();
            saved.world().snapshot_into(&mut buffer);
            world.restore(&buffer);
            assert_eq!(future(&mut world, seed, 1_000), expected, "{integrator:?}, {seed}: from a buffer");
            let restored = Snapshot::from_bytes(&bytes, &custom_forces()).expect("it is whole");
            assert_eq!(restored.to_bytes(), bytes, "{integrator:?}, {seed}: bytes of what was read from them");
            assert_eq!(restored.world().differences(saved.world()), []);
            let mut restored = restored.into_world();
            for (a, b) in restored.bodies().zip(saved.world().bodies()) {
                assert_eq!((a.id(), a.mass(), a.inertia()), (b.id(), b.mass(), b.inertia()));
                assert_eq!((a.kind(), a.activity()), (b.kind(), b.activity()));
            }
            let woke = |world: &mut World| (world.step().woke.to_vec(), world.state_hash());
            assert_eq!(woke(&mut restored.clone()), woke(&mut saved.world().clone()), "what calls woke is reported");
            assert_eq!(future(&mut restored, seed, 1_000), expected, "{integrator:?}, {seed}: from bytes");
        }
    }
    assert_eq!(kinds, [true; 4], "slept, quarantined, recycled, pushed");
}

/// Bytes that each of 1,000 bodies like this one adds to a snapshot.
fn bytes_a_body(def: WorldDef, body: &BodyDef, prepare: impl Fn(&mut World, BodyId)) -> usize {
    let mut world = World::new(def).expect("a world");
    let head = world.snapshot().to_bytes().len();
    for _ in 0..1_000 {
        let body = world.add_body(body.clone()).expect("a body");
        prepare(&mut world, body);
    }
    let bytes = world.snapshot().to_bytes().len() - head;
    bytes.checked_div(1_000).filter(|each| each * 1_000 == bytes).expect("alike")
}

#[test]
fn a_body_takes_as_many_bytes_as_documented() {
    let plain = BodyDef::dynamic();
    let circle = plain.clone().with_collider(Shape::circle(fx!(0.5)).expect("a shape"));
    let all_set = BodyDef {
        mass: Mass::Explicit { mass: fx!(1), inertia: fx!(1) },
        linear_damping: Some(Damping::kept_per_second(fx!(0.5))),
        angular_damping: Some(Damping::kept_per_second(fx!(0.5))),
        max_speed: Some(fx!(5)),
        max_angular_speed: Some(fx!(5)),
        ..plain.clone()
    };
    let verlet = WorldDef { sleep_after: Some(1), ..WorldDef::default() };
    let published = WorldDef { integrator: Integrator::PublishedVerlet, ..verlet };
    let nothing = |_: &mut World, _: BodyId| ();
    let push = |world: &mut World, body| world.apply_force(body, vec2(1, 2)).expect("it is dynamic");
    assert_eq!(bytes_a_body(verlet, &plain, nothing), 143);
    assert_eq!(bytes_a_body(verlet, &circle, nothing), 143 + 124);
    assert_eq!(bytes_a_body(verlet, &all_set, nothing), 191);
    assert_eq!(bytes_a_body(published, &all_set, nothing), 191 + 48);
    assert_eq!(bytes_a_body(verlet, &all_set, push), 191 + 72);
    assert_eq!(bytes_a_body(published, &all_set, push), 191 + 48 + 72);
    // The worst: a force wakes it. One body alone, as the steps until it sleeps clear what was applied to others.
    let mut world = World::new(published).expect("a world");
    let head = world.snapshot().to_bytes().len();
    let body = world.add_body(all_set.clone()).expect("a body");
    while world.body(body).expect("it is there").activity() != Activity::Asleep {
        world.step();
    }
    push(&mut world, body);
    assert_eq!(world.snapshot().to_bytes().len() - head, 319);
    // A goal takes less than a force: only kinematic bodies have one, and no force waits on them.
    let goal = |world: &mut World, body| world.move_to(body, vec2(1, 2), fx!(1)).expect("it is kinematic");
    let kinematic = BodyDef { kind: BodyKind::Kinematic, ..all_set };
    assert_eq!(bytes_a_body(published, &kinematic, goal), 191 + 48 + 26);
    assert!(head <= 308, "{head}");
}

#[test]
fn an_idle_tick_takes_18_bytes_of_a_replay() {
    let file = |ticks: u64| {
        let mut world = World::new(WorldDef::default()).expect("a world");
        let mut recorder = Recorder::new(&world, RecordOptions { snapshot_every: 0, ..RecordOptions::default() });
        (0..ticks).for_each(|_| _ = recorder.step(&mut world, &Inputs::new()));
        recorder.finish(&world).len()
    };
    // Chunks of 64 ticks: 17 bytes a tick, 68 a chunk.
    let taken = file(6_400) - file(3_200);
    assert_eq!(taken, 50 * (64 * 17 + 68));
    let said = format!("{} bytes a tick", (taken + 1_600) / 3_200);
    assert!(include_str!("../src/guide/replays.md").contains(&said), "{said}");
}

#[test]
fn bytes_that_are_no_snapshot_are_refused_with_a_reason() {
    let world = lived(Integrator::default(), 3, 60);
    let bytes = world.snapshot().to_bytes();
    let read = |bytes: &[u8]| Snapshot::from_bytes(bytes, &custom_forces()).map(|_| ());
    assert_eq!(read(&bytes), Ok(()));
    assert_eq!(read(b"{}"), Err(SnapshotError::Foreign));
    for (at, error) in [
        (8, SnapshotError::Format { found: 9, known: 8 }),
        (12, SnapshotError::PhysicsVersion { found: PHYSICS_VERSION ^ 1, own: PHYSICS_VERSION }),
    ] {
        let mut changed = bytes.clone();
        changed[at] ^= 1;
        assert_eq!(read(&changed), Err(error));
    }
    let strange =
        |version| Snapshot::from_bytes(&bytes, &[Arc::new(Tether(version)) as Arc<dyn CustomForce>]).map(|_| ());
    assert_eq!(strange(2), Err(SnapshotError::CustomForce { id: 7, version: 1 }));
    let every = if crate::seeds::is_short() { 37 } else { 1 };
    for end in (0..bytes.len()).step_by(every) {
        assert!(read(&bytes[..end]).is_err(), "cut off at {end}");
    }
    let mut longer = bytes.clone();
    longer.push(0);
    assert!(matches!(read(&longer), Err(SnapshotError::Malformed(_))));
    // Bits of all kinds: either the world is refused, or it says something else than its hash. Nothing panics.
    for at in (0..bytes.len()).step_by(every) {
        for bit in 0..8 {
            let mut changed = bytes.clone();
            changed[at] ^= 1 << bit;
            assert!(read(&changed).is_err(), "bit {bit} of byte {at}");
        }
    }
}

#[test]
fn a_difference_is_named_to_the_body_and_field() {
    let world = lived(Integrator::default(), 5, 60);
    let body = world.bodies().find(|body| body.kind() == umbra_physics::BodyKind::Dynamic).expect("one").id();
    let mut twin = world.clone();
    let data = world.body(body).expect("it is there").user_data().to_string();
    twin.set_user_data(body, 99).expect("it is there");
    let (ours, theirs) = (HashTree::of(&world), HashTree::of(&twin));
    let slot = body.parts().0.to_string();
    let differences = world.differences(&twin);
    let named = differences.iter().find(|d| d.field == "user_data").expect("named");
    assert_eq!(
        (named.owner, named.left.as_deref(), named.right.as_deref()),
        (Owner::Body(body), Some(&data[..]), Some("99"))
    );
    let path = ours.first_difference(&theirs).expect("they differ");
    assert_eq!(path[1..3], ["bodies", &slot]);
    assert_eq!(ours.first_difference(&ours.clone()), None);

    // Less than an ulp: what is carried below it is dropped by a setter.
    let mut twin = world.clone();
    let carries = |body: &umbra_physics::BodyRef| body.velocity_exact().x.to_string() != body.velocity().x.to_string();
    let body = world.bodies().find(carries).expect("one");
    let (body, velocity) = (body.id(), body.velocity());
    twin.set_velocity(body, velocity).expect("it moves");
    let fields: Vec<_> = world.differences(&twin).into_iter().map(|d| (d.owner, d.field)).collect();
    assert!(fields.iter().all(|(owner, _)| *owner == Owner::Body(body)), "{fields:?}");
    assert!(fields.iter().any(|(_, field)| field.starts_with("velocity.")), "{fields:?}");
}

#[test]
fn a_tree_of_a_step_leads_to_the_stage_the_body_and_the_field() {
    let mut world = lived(Integrator::Yoshida4, 8, 60);
    let mut twin = world.clone();
    let dynamic = |body: &umbra_physics::BodyRef| {
        body.kind() == umbra_physics::BodyKind::Dynamic && body.activity() == Activity::Awake
    };
    let body = world.bodies().find(dynamic).expect("one").id();
    assert_eq!(HashTree::of(&world), HashTree::of(&twin));
    twin.apply_torque(body, fx!(0.001)).expect("it is dynamic");
    let (ours, theirs) = (world.step_traced(), twin.step_traced());
    let (ours, theirs) = (HashTree::of_step(&ours, &world), HashTree::of_step(&theirs, &twin));
    // What was applied is there from the first stage on, and turns the body in the first kick.
    let path = ours.first_difference(&theirs).expect("they differ");
    let slot = body.parts().0.to_string();
    let tick = format!("tick {}", world.tick() - 1);
    assert_eq!(path[..4], [&tick, "stage 1 (damp)", "bodies", &slot], "{path:?}");
    assert!(path.contains(&"applied"), "{path:?}");
    assert_eq!(ours.parts.len(), Integrator::Yoshida4.stages().len() + 1);
}

#[test]
fn a_blob_has_its_limit() {
    let mut world = World::new(WorldDef::default()).expect("a world");
    let limit = umbra_physics::limits::BLOB;
    assert_eq!(world.set_blob(&vec![1; limit]), Ok(()));
    let hash = world.state_hash();
    let error = Error::OutOfRange { quantity: umbra_physics::Quantity::Blob };
    assert_eq!(world.set_blob(&vec![2; limit + 1]), Err(error));
    assert_eq!(world.state_hash(), hash);
}

#[test]
fn a_hash_does_not_depend_on_where_in_memory_bodies_stand() {
    for integrator in [Integrator::VelocityVerlet, Integrator::PublishedVerlet] {
        for gaps in [0, 1, 20, 200] {
            let mut world = World::new(WorldDef { integrator, ..WorldDef::default() }).expect("a world");
            let body =
                |i: i32| BodyDef { position: vec2(i, 0), velocity: vec2(1, i), key: i as u64, ..BodyDef::dynamic() };
            let ids: Vec<BodyId> = (0..500).map(|i| world.add_body(body(i)).expect("a body")).collect();
            // The last body takes the place of one that is gone; a world made from bytes has all in order.
            for &gone in ids.iter().step_by(2).take(gaps) {
                world.remove_body(gone).expect("it is there");
            }
            world.step();
            let restored =
                Snapshot::from_bytes(&world.snapshot().to_bytes(), &[]).expect("it has the same hash").into_world();
            assert_eq!(restored.state_hash(), world.state_hash());
        }
    }
}
