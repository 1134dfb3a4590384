//! Locked axes: what acts along one has no effect to the bit, and changes nothing of the others.

use umbra_physics::{
    ApplyOptions, Attachment, BodyDef, BodyId, BodyKind, Cause, Command, Damping, End, Error, FieldKind,
    ForceOrImpulse, Frame, Fx, FxFactor, Integrator, Locks, Mass, Quantity, Region, Snapshot, SnapshotError,
    SpringConstants, TimeStep, Vec2, World, WorldDef, fx, limits, vec2,
};

const ALL: Locks = Locks { x: true, y: true, rotation: true };

fn each() -> impl Iterator<Item = Locks> {
    (0..8u8).map(|bits| Locks { x: bits & 1 > 0, y: bits & 2 > 0, rotation: bits & 4 > 0 })
}

fn def(integrator: Integrator) -> WorldDef {
    WorldDef {
        integrator,
        gravity: vec2(3, -10),
        linear_damping: Damping::kept_per_second(fx!(0.7)),
        angular_damping: Damping::kept_per_second(fx!(0.6)),
        sleep_after: None,
        ..WorldDef::default()
    }
}

/// A body under all there is: gravity, damping, an attractor, a spring with a damper off its centre, wind, a thrust, a zone.
fn under_everything(integrator: Integrator, locks: Locks) -> (World, BodyId) {
    let mut world = World::new(def(integrator)).expect("a world");
    let far = world.add_body(BodyDef { position: vec2(3, 4), velocity: vec2(1, 1), ..BodyDef::dynamic() });
    let body = world.add_body(BodyDef {
        position: vec2(fx!(0.1), fx!(-0.2)),
        angle: fx!(0.3),
        mass: Mass::Explicit { mass: fx!(2), inertia: fx!(0.7) },
        locks,
        ..BodyDef::dynamic()
    });
    let (far, body) = (far.expect("a body"), body.expect("a body"));
    let at = Attachment { body, point: vec2(fx!(0.5), fx!(0.25)) };
    let spring = SpringConstants { rest: fx!(1), stiffness: fx!(7), damping: fx!(2) };
    let mu = FxFactor::from_scalar(fx!(5));
    let region = Region::Disc { centre: Vec2::ZERO, radius: fx!(1000) };
    for law in [
        FieldKind::Attractor { centre: End::World(vec2(-5, 6)), mu, softening: fx!(1) },
        FieldKind::Spring { near: at, far: End::Body(Attachment::centre(far)), spring },
        FieldKind::Drag { linear: fx!(0.5), quadratic: fx!(0.25), wind: vec2(4, -3) },
        FieldKind::Thrust { at, force: vec2(2, 1) },
        FieldKind::Zone { region, acceleration: vec2(1, 2) },
    ] {
        world.add_field(law).expect("a field");
    }
    (world, body)
}

fn push(world: &mut World, body: BodyId, tick: i32) {
    let (force, point) = (vec2(tick % 7 - 3, 2), Some(vec2(1, 1)));
    let actions = [
        ForceOrImpulse::Force { force, point },
        ForceOrImpulse::Torque(fx!(3)),
        ForceOrImpulse::Impulse { impulse: force, point },
        ForceOrImpulse::AngularImpulse(fx!(0.5)),
    ];
    for action in actions {
        world.apply(body, action, ApplyOptions { frame: Frame::World, wake: true }).expect("a push");
    }
}

/// Position and velocity along x, along y, and in rotation.
fn bits(world: &World, body: BodyId) -> [(i128, i128); 3] {
    let body = world.body(body).expect("it is there");
    let (x, v) = (body.position_exact(), body.velocity_exact());
    let angle = i128::from(body.angle_exact().to_bits());
    let spin = body.angular_velocity_exact().to_bits();
    [(x.x.to_bits(), v.x.to_bits()), (x.y.to_bits(), v.y.to_bits()), (angle, spin)]
}

#[test]
fn nothing_moves_a_body_along_a_locked_axis() {
    for integrator in Integrator::ALL {
        for locks in each() {
            let (mut world, body) = under_everything(integrator, locks);
            let start = bits(&world, body);
            for tick in 0..40 {
                push(&mut world, body, tick);
                world.step();
                let now = bits(&world, body);
                for (axis, locked) in [locks.x, locks.y, locks.rotation].into_iter().enumerate() {
                    assert_eq!(now[axis] == start[axis], locked, "{integrator:?}, {locks:?}, axis {axis}, tick {tick}");
                    assert!(!locked || now[axis].1 == 0);
                }
            }
            let read = world.body(body).expect("it is there");
            assert_eq!(read.locks(), locks);
            assert_eq!(read.inverse_inertia() == FxFactor::ZERO, locks.rotation);
        }
    }
}

/// Free axes move as if nothing was locked, if the axes do not interact.
#[test]
fn the_other_axes_move_in_the_same_bits() {
    for integrator in Integrator::ALL {
        let run = |locks| {
            let mut world = World::new(def(integrator)).expect("a world");
            let mass = Mass::Explicit { mass: fx!(0.3), inertia: fx!(0.7) };
            let body = world.add_body(BodyDef { mass, locks, ..BodyDef::dynamic() }).expect("a body");
            let far = world.add_body(BodyDef { position: vec2(0, 1), ..BodyDef::dynamic() }).expect("a body");
            let region = Region::Disc { centre: Vec2::ZERO, radius: fx!(1000) };
            world.add_field(FieldKind::Zone { region, acceleration: vec2(1, 2) }).expect("a field");
            world
                .add_field(FieldKind::Drag { linear: fx!(0.3), quadratic: fx!(0), wind: vec2(2, 5) })
                .expect("a field");
            let mut way = Vec::new();
            for tick in 0..60 {
                world.apply_force(body, vec2(tick % 5, 3 - tick % 4)).expect("a force");
                world.apply_torque(body, fx!(0.1)).expect("a torque");
                world.apply_impulse(body, vec2(fx!(0.1), fx!(-0.2))).expect("an impulse");
                world.apply_angular_impulse(body, fx!(0.3)).expect("an impulse");
                world.step();
                way.push((bits(&world, body), bits(&world, far)));
            }
            way
        };
        let free = run(Locks::NONE);
        for locks in each() {
            for (tick, (locked, free)) in run(locks).iter().zip(&free).enumerate() {
                for (axis, is) in [locks.x, locks.y, locks.rotation].into_iter().enumerate() {
                    assert_eq!(locked.0[axis] == free.0[axis], !is, "{integrator:?}, {locks:?}, axis {axis}, {tick}");
                }
                assert_eq!(locked.1, free.1, "{locks:?}: a bystander noticed");
            }
        }
    }
}

/// The drag of the square of the speed goes by the whole velocity through the air, also where an axis is locked.
#[test]
fn wind_across_a_rail_is_part_of_the_drag_along_it() {
    let run = |locks, wind| {
        let mut world = World::new(WorldDef { sleep_after: None, ..WorldDef::default() }).expect("a world");
        let def = BodyDef { velocity: vec2(8, 0), locks, ..BodyDef::dynamic() };
        let body = world.add_body(def).expect("a body");
        world.add_field(FieldKind::Drag { linear: fx!(0), quadratic: fx!(1), wind }).expect("a field");
        world.step();
        bits(&world, body)[0]
    };
    let rail = Locks { y: true, ..Locks::NONE };
    // Over the opening half of the step the two are alike to the bit; then a free one is carried along.
    assert_ne!(run(rail, vec2(0, 30)), run(rail, vec2(0, 0)));
    assert!(run(rail, vec2(0, 30)).1 < run(rail, vec2(0, 0)).1, "it brakes more");
    assert_eq!(run(rail, vec2(0, 30)), run(rail, vec2(0, -30)), "from either side");
}

#[test]
fn free_blocks_have_locks_too() {
    // Some hundreds of bodies that no field reaches, every other one locked in its own way, beside the same ones unlocked.
    let locks: Vec<Locks> = each().collect();
    let run = |is_locked: bool| {
        let mut world =
            World::new(WorldDef { linear_damping: Damping::NONE, ..def(Integrator::VelocityVerlet) }).expect("a world");
        let ids: Vec<BodyId> = (0..300)
            .map(|i| {
                let locks = if is_locked { locks[i % 8] } else { Locks::NONE };
                world.add_body(BodyDef { position: vec2(i as i32, 7), locks, ..BodyDef::dynamic() }).expect("a body")
            })
            .collect();
        for tick in 0..40 {
            for id in ids.iter().skip(tick % 3).step_by(9) {
                world.apply_force(*id, vec2(1, 2)).expect("a force");
            }
            world.step();
        }
        ids.iter().map(|&id| bits(&world, id)).collect::<Vec<_>>()
    };
    for (i, (locked, free)) in run(true).iter().zip(run(false)).enumerate() {
        let start = i128::from(i as u64) << 96;
        let locks = locks[i % 8];
        assert_eq!(locked[0], if locks.x { (start, 0) } else { free[0] });
        assert_eq!(locked[1], if locks.y { (7 << 96, 0) } else { free[1] });
    }
}

#[test]
fn a_lock_stops_and_its_release_lets_go() {
    for kind in [BodyKind::Dynamic, BodyKind::Kinematic] {
        let mut world = World::new(WorldDef {
            linear_damping: Damping::NONE,
            angular_damping: Damping::NONE,
            ..def(Integrator::PublishedVerlet)
        })
        .expect("a world");
        let def = BodyDef { kind, velocity: vec2(3, 4), angular_velocity: fx!(5), ..BodyDef::dynamic() };
        let body = world.add_body(def).expect("a body");
        (0..3).for_each(|_| _ = world.step());
        let before = bits(&world, body);
        world.set_locks(body, Locks { x: true, rotation: true, ..Locks::NONE }).expect("it is there");
        assert_eq!(bits(&world, body).map(|(_, v)| v), [0, before[1].1, 0]);
        assert_eq!(bits(&world, body).map(|(x, _)| x), before.map(|(x, _)| x));
        (0..9).for_each(|_| _ = world.step());
        let after = bits(&world, body);
        assert_eq!((after[0], after[2]), ((before[0].0, 0), (before[2].0, 0)), "{kind:?}");
        assert_ne!(after[1].0, before[1].0);
        // Refused along it, allowed across.
        let (linear, angular) = (Quantity::Velocity, Quantity::AngularVelocity);
        let locked = |quantity| Err(Error::Locked { quantity });
        assert_eq!(world.set_velocity(body, vec2(Fx::DELTA, 1)), locked(linear));
        assert_eq!(world.set_angular_velocity(body, -Fx::DELTA), locked(angular));
        assert_eq!((world.set_velocity(body, vec2(0, 1)), world.set_angular_velocity(body, fx!(0))), (Ok(()), Ok(())));
        let still = world.clone();
        assert_eq!(world.set_locks(body, Locks::NONE), Ok(()));
        assert_ne!(world.state_hash(), still.state_hash());
        assert_eq!(world.set_velocity(body, vec2(2, 1)), Ok(()));
        world.step();
        assert_ne!(bits(&world, body)[0].0, before[0].0);
    }
    let moves: BodyDef =
        BodyDef { velocity: vec2(0, 1), locks: Locks { y: true, ..Locks::NONE }, ..BodyDef::dynamic() };
    assert_eq!(moves.check(), Err(Error::Locked { quantity: Quantity::Velocity }));
    let turns = BodyDef { angular_velocity: fx!(1), locks: ALL, ..BodyDef::kinematic() };
    assert_eq!(turns.check(), Err(Error::Locked { quantity: Quantity::AngularVelocity }));
    assert_eq!(BodyDef { locks: ALL, ..BodyDef::<Fx>::fixed() }.check(), Ok(()));
}

/// A force that is too large for its body is no fault along a locked axis.
#[test]
fn a_force_along_a_locked_axis_is_never_too_large() {
    let mut world = World::new(WorldDef::default()).expect("a world");
    let light = BodyDef {
        mass: Mass::Explicit { mass: limits::MASS_MIN, inertia: Fx::DELTA },
        locks: ALL,
        ..BodyDef::dynamic()
    };
    let body = world.add_body(light).expect("a body");
    world.apply_impulse_at_point(body, Vec2::new(Fx::MAX, Fx::MAX), vec2(1, 0)).expect("without effect");
    world.apply_force_at_point(body, Vec2::new(Fx::MAX, Fx::MIN), vec2(9, 1)).expect("without effect");
    assert_eq!(world.step().faults, []);
    assert_eq!(bits(&world, body), [(0, 0); 3]);
    // Nor is a torque that fits no number, of a push with a long lever or of a spring.
    let position = Vec2::new(limits::POSITION, limits::POSITION);
    let (push, point) = (Vec2::new(Fx::MAX, Fx::MIN), Vec2::new(Fx::MIN, Fx::MIN));
    for locks in [ALL, Locks { rotation: false, ..ALL }] {
        let mut world = World::new(WorldDef::default()).expect("a world");
        let body = world.add_body(BodyDef { position, locks, ..BodyDef::dynamic() }).expect("a body");
        let too_large = Err(Error::OutOfRange { quantity: Quantity::Torque });
        assert_eq!(world.apply_force_at_point(body, push, point), if locks == ALL { Ok(()) } else { too_large });
        world.clear_forces();
        let spring = SpringConstants { rest: fx!(0), stiffness: Fx::MAX, damping: fx!(0) };
        let (near, end) = (Attachment { body, point: vec2(0, 4_000) }, position - vec2(4_000_000, 0));
        let field = world.add_field(FieldKind::Spring { near, far: End::World(end), spring }).expect("a field");
        let faults: Vec<Cause> = world.step().faults.iter().map(|fault| fault.cause).collect();
        assert_eq!(faults, if locks == ALL { vec![] } else { vec![Cause::Field { field }] });
    }
}

#[test]
fn energy_is_that_of_where_a_body_is_and_how_it_moves() {
    let potential = |locks| {
        let mut world = World::new(WorldDef { gravity: vec2(2, -10), ..WorldDef::default() }).expect("a world");
        let def = BodyDef {
            position: vec2(3, 7),
            mass: Mass::Kilograms(fx!(2)),
            gravity_scale: fx!(0.5),
            locks,
            ..BodyDef::dynamic()
        };
        world.add_body(def).expect("a body");
        world.potential_energy().expect("it fits").to_string()
    };
    // −m·g·x: −2·(1·3 − 5·7).
    assert!(each().all(|locks| potential(locks) == "64"));
    // On a rail it keeps its energy as a free one does.
    let mut world = World::new(WorldDef { sleep_after: None, ..WorldDef::default() }).expect("a world");
    let locks = Locks { y: true, rotation: true, ..Locks::NONE };
    let body = world.add_body(BodyDef { position: vec2(1, 0), locks, ..BodyDef::dynamic() }).expect("a body");
    let spring = SpringConstants { rest: fx!(0), stiffness: fx!(4), damping: fx!(0) };
    let near = Attachment { body, point: vec2(0, 1) };
    world.add_field(FieldKind::Spring { near, far: End::World(vec2(0, 3)), spring }).expect("a field");
    let energy = |world: &World| world.energy().expect("it fits").to_bits() >> 44;
    let start = energy(&world);
    for _ in 0..600 {
        world.step();
        assert!((energy(&world) - start).abs() < 1 << 14, "1.6 % of a joule");
    }
}

#[test]
fn steps_with_locks_are_undone() {
    for integrator in Integrator::ALL.into_iter().filter(|integrator| integrator.inverse().is_some()) {
        for locks in each() {
            let def = WorldDef { linear_damping: Damping::NONE, angular_damping: Damping::NONE, ..def(integrator) };
            let mut world = World::new(def).expect("a world");
            let body = world.add_body(BodyDef { locks, ..BodyDef::dynamic() }).expect("a body");
            let near = Attachment { body, point: vec2(1, fx!(0.5)) };
            let spring = SpringConstants { rest: fx!(1), stiffness: fx!(9), damping: fx!(0) };
            world.add_field(FieldKind::Spring { near, far: End::World(vec2(2, 3)), spring }).expect("a field");
            let mut ticks = Vec::new();
            for tick in 0..50 {
                world.apply_force_at_point(body, vec2(tick % 3, 1), vec2(1, 1)).expect("a force");
                let before = world.state_hash();
                ticks.push((before, world.step().applied.to_vec()));
            }
            for (before, applied) in ticks.into_iter().rev() {
                world.step_back(&applied).expect("there is a way back");
                assert_eq!(world.state_hash(), before, "{integrator:?}, {locks:?}");
                world.clear_forces();
            }
        }
    }
}

#[test]
fn locks_are_in_files_and_forgeries_are_refused() {
    let mut world = World::new(WorldDef::default()).expect("a world");
    let locks = Locks { x: true, ..Locks::NONE };
    let body = world.add_body(BodyDef { velocity: vec2(0, 3), locks, ..BodyDef::dynamic() }).expect("a body");
    let bytes = world.snapshot().to_bytes();
    let read = Snapshot::from_bytes(&bytes, &[]).expect("sound").into_world();
    assert_eq!((read.body(body).expect("it is there").locks(), read.state_hash()), (locks, world.state_hash()));
    let mut twin = world.clone();
    twin.set_locks(body, Locks::NONE).expect("it is there");
    let differences: Vec<String> =
        world.differences(&twin).iter().map(|difference| format!("{difference:#}")).collect();
    assert_eq!(differences, ["body 0, locks.x: true and false"]);
    assert_ne!(world.physics_hash(), twin.physics_hash());
    // One that says it is locked along y, where it moves.
    let at = bytes.windows(3).position(|three| three == [1, 0, 0]).expect("the locks");
    let candidates = (at..bytes.len() - 16).filter(|&i| bytes[i..i + 3] == [1, 0, 0]);
    let refused = candidates.filter(|&i| {
        let mut forged = bytes.clone();
        forged[i + 1] = 1;
        let error = Snapshot::from_bytes(&forged, &[]).err();
        matches!(error, Some(SnapshotError::Invalid { error: Error::Locked { quantity: Quantity::Velocity }, .. }))
    });
    assert_eq!(refused.count(), 1);
}

/// The command is the call, in time as well: a world of another rate, and a copy that takes it back.
#[test]
fn the_command_is_the_call() {
    let (mut world, body) = under_everything(Integrator::Yoshida4, Locks::NONE);
    world.set_time_step(TimeStep::hz(144)).expect("a rate");
    let mut twin = world.clone();
    world.set_locks(body, ALL).expect("it is there");
    twin.execute(&Command::SetLocks { body, locks: ALL }).expect("it is there");
    world.step();
    twin.step();
    assert_eq!(world.state_hash(), twin.state_hash());
    let gone = BodyId::from_parts(9, 0);
    assert_eq!(world.set_locks(gone, ALL), Err(Error::NoSuchBody { body: gone }));
}
