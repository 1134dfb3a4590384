//! Effects of the calls of a world on its bodies.

use umbra_physics::{
    Activity, ApplyOptions, Attachment, BodyDef, BodyId, BodyKind, ColliderDef, ColliderId, Command, ContactSettings,
    Created, Damping, Distance, End, Error, Exclusion, Explosion, FieldId, FieldKind, ForceField, ForceOrImpulse,
    Frame, Fx, FxFactor, FxWide, Integrator, JointDef, JointId, JointKind, JointMotor, Locks, Mass, MaterialPair,
    Random, Shape, SpringConstants, TimeStep, Turn, Vec2, World, WorldDef, fx, vec2,
};

fn world(def: WorldDef) -> World {
    World::new(def).expect("a world")
}

fn disc(radius: Fx) -> ColliderDef {
    ColliderDef::ghost(Shape::circle(radius).expect("a disc"))
}

fn ball(world: &mut World) -> BodyId {
    world
        .add_body(BodyDef { mass: Mass::Kilograms(fx!(4)), ..BodyDef::dynamic().with_collider(disc(fx!(2))) })
        .expect("a ball")
}

fn factor(value: Fx) -> Option<FxFactor> {
    Some(FxFactor::from_scalar(value))
}

fn wide(value: Fx) -> FxWide {
    FxWide::from_scalar(value)
}

fn sixty_four() -> WorldDef {
    WorldDef { time_step: TimeStep::hz(64), sleep_after: None, ..WorldDef::default() }
}

#[test]
fn a_new_mass_or_collider_changes_the_inertia_and_both_inverses() {
    let mut world = world(WorldDef::default());
    let body = ball(&mut world);
    let collider = world.colliders_of(body).unwrap().next().unwrap();
    let mass_of = |world: &World| {
        let body = world.body(body).unwrap();
        (body.mass(), body.inertia(), Some(body.inverse_mass()), Some(body.inverse_inertia()))
    };
    // ½mr²
    assert_eq!(mass_of(&world), (Some(fx!(4)), factor(fx!(8)), factor(fx!(0.25)), factor(fx!(0.125))));
    world.set_mass(body, Mass::Kilograms(fx!(2))).unwrap();
    assert_eq!(mass_of(&world), (Some(fx!(2)), factor(fx!(4)), factor(fx!(0.5)), factor(fx!(0.25))));
    world.set_collider(collider, disc(fx!(4))).unwrap();
    assert_eq!(mass_of(&world), (Some(fx!(2)), factor(fx!(16)), factor(fx!(0.5)), factor(fx!(0.0625))));
    world.set_mass(body, Mass::Explicit { mass: fx!(2), inertia: fx!(0.5) }).unwrap();
    assert_eq!(mass_of(&world), (Some(fx!(2)), factor(fx!(0.5)), factor(fx!(0.5)), factor(fx!(2))));
    world.remove_collider(collider).unwrap();
    assert_eq!(mass_of(&world).1, factor(fx!(0.5)), "an inertia that was given stays");
    world.set_mass(body, Mass::Kilograms(fx!(2))).unwrap();
    assert_eq!(
        mass_of(&world),
        (Some(fx!(2)), None, factor(fx!(0.5)), factor(fx!(0))),
        "without colliders it does not turn"
    );
    world.set_mass(body, Mass::FromColliders).unwrap();
    assert_eq!(mass_of(&world), (Some(fx!(1)), None, factor(fx!(1)), factor(fx!(0))));
    let square =
        |width| ColliderDef { density: fx!(2), ..ColliderDef::ghost(Shape::rectangle(width, fx!(3)).unwrap()) };
    let collider = world.add_collider(body, square(fx!(2))).unwrap();
    assert_eq!(world.body(body).unwrap().mass(), Some(fx!(12)));
    world.set_collider(collider, square(fx!(1))).unwrap();
    assert_eq!(world.body(body).unwrap().mass(), Some(fx!(6)), "a density gives another mass to another shape");
}

#[test]
fn a_new_mass_acts_from_the_next_step_on() {
    let mut world = world(sixty_four());
    let body = ball(&mut world);
    world.apply_force(body, vec2(fx!(64), 0)).unwrap();
    world.set_mass(body, Mass::Kilograms(fx!(8))).unwrap();
    world.step();
    assert_eq!(world.body(body).unwrap().velocity(), vec2(fx!(0.125), 0), "64 N on 8 kg over 1/64 s");
}

#[test]
fn a_new_time_step_damps_alike_over_time_and_keeps_the_elapsed_time_exact() {
    let def = WorldDef {
        linear_damping: Damping::kept_per_second(fx!(0.25)),
        angular_damping: Damping::kept_per_second(fx!(0.5)),
        ..sixty_four()
    };
    let mut world = world(def);
    let body = ball(&mut world);
    world.set_velocity(body, vec2(fx!(1024), 0)).unwrap();
    world.set_angular_velocity(body, fx!(1024)).unwrap();
    for (rate, seconds, left, spin) in [(64, 1, 256, 512), (10, 1, 64, 256), (1, 1, 16, 128), (1000, 1, 4, 64)] {
        world.set_time_step(TimeStep::hz(rate)).unwrap();
        for _ in 0..rate * seconds {
            world.step();
        }
        let body = world.body(body).unwrap();
        // 2^-64 relative a step: far below the ulp these are compared to.
        let is_close = |value: Fx, wanted: i32| (value - Fx::from(wanted)).to_bits().abs() <= 1;
        assert!(is_close(body.velocity().x, left), "{} at {rate}", body.velocity());
        assert!(is_close(body.angular_velocity(), spin), "{} at {rate}", body.angular_velocity());
    }
    assert_eq!((world.elapsed().num, world.elapsed().den), (4, 1));
    assert_eq!(world.tick(), 64 + 10 + 1 + 1000);
    world.set_time_step(TimeStep::ratio(1001, 60_000)).unwrap();
    world.step();
    assert_eq!((world.elapsed().num, world.elapsed().den), (4 * 60_000 + 1001, 60_000));
}

#[test]
fn a_damping_of_its_own_overrides_the_worlds_each_for_itself_and_not_at_all_for_kinematic_bodies() {
    let def = WorldDef {
        time_step: TimeStep::hz(1),
        linear_damping: Damping::kept_per_second(fx!(0.5)),
        angular_damping: Damping::kept_per_second(fx!(0.25)),
        sleep_after: None,
        ..WorldDef::default()
    };
    let mut world = world(def);
    let start =
        BodyDef { velocity: vec2(64, 0), angular_velocity: fx!(64), ..BodyDef::dynamic().with_collider(disc(fx!(1))) };
    let defs = [
        start.clone(),
        BodyDef { linear_damping: Some(Damping::NONE), ..start.clone() },
        BodyDef { angular_damping: Some(Damping::NONE), ..start.clone() },
        BodyDef {
            linear_damping: Some(Damping::kept_per_second(Fx::ZERO)),
            angular_damping: Some(Damping::kept_per_second(fx!(0.5))),
            ..start.clone()
        },
        BodyDef { kind: BodyKind::Kinematic, ..start },
    ];
    let bodies = defs.map(|def| world.add_body(def).unwrap());
    world.step();
    let now = |world: &World| bodies.map(|b| world.body(b).map(|b| (b.velocity().x, b.angular_velocity())).unwrap());
    let pairs = |list: [(i32, i32); 5]| list.map(|(v, w)| (Fx::from(v), Fx::from(w)));
    assert_eq!(now(&world), pairs([(32, 16), (64, 16), (32, 64), (0, 32), (64, 64)]));
    world.set_body_damping(bodies[1], None, None).unwrap();
    world.set_damping(Damping::kept_per_second(fx!(0.25)), Damping::NONE).unwrap();
    world.step();
    assert_eq!(now(&world), pairs([(8, 16), (16, 16), (8, 64), (0, 16), (64, 64)]));
}

#[test]
fn gravity_is_scaled_by_the_body_and_felt_by_dynamic_ones_alone() {
    let mut world = world(WorldDef { gravity: vec2(0, -64), ..sixty_four() });
    let scaled = |scale| BodyDef { gravity_scale: scale, ..BodyDef::dynamic() };
    let defs = [scaled(fx!(1)), scaled(fx!(0)), scaled(fx!(-2)), BodyDef::kinematic(), BodyDef::fixed()];
    let bodies = defs.map(|def| world.add_body(def).unwrap());
    world.step();
    let fallen = bodies.map(|body| world.body(body).unwrap().velocity().y);
    assert_eq!(fallen, [fx!(-1), fx!(0), fx!(2), fx!(0), fx!(0)]);
    world.set_gravity_scale(bodies[1], fx!(16)).unwrap();
    world.set_gravity(vec2(64, 0)).unwrap();
    world.step();
    assert_eq!(world.body(bodies[1]).unwrap().velocity(), vec2(16, 0));
}

#[test]
fn a_force_acts_over_one_step_and_is_gone() {
    for integrator in Integrator::ALL {
        let mut world = world(WorldDef { integrator, ..sixty_four() });
        let body = ball(&mut world);
        world.apply_force(body, vec2(256, 0)).unwrap();
        world.apply_torque(body, fx!(512)).unwrap();
        assert_eq!(world.body(body).unwrap().applied_force(), Some(Vec2::new(wide(fx!(256)), wide(fx!(0)))));
        let applied = world.step().applied.to_vec();
        assert_eq!(applied.len(), 1);
        assert_eq!(applied[0].body, body);
        assert_eq!(applied[0].force(), Some(Vec2::new(wide(fx!(256)), wide(fx!(0)))), "{integrator:?}");
        assert_eq!(applied[0].torque(), Some(wide(fx!(512))));
        assert_eq!(world.body(body).unwrap().applied_force(), Some(Vec2::default()));
        assert_eq!(world.body(body).unwrap().applied_torque(), Some(FxWide::default()));
        assert_eq!(world.step().applied, [], "{integrator:?}");
        world.step();
        let body = world.body(body).unwrap();
        // 256 N on 4 kg, 512 N·m on 8 kg·m², over 1/64 s. Yoshida's three weights sum to one within their last bit.
        let is_close = |value: Fx| (value - Fx::ONE).to_bits().abs() <= i64::from(integrator == Integrator::Yoshida4);
        assert!(
            is_close(body.velocity().x) && is_close(body.angular_velocity()),
            "{integrator:?}: {}",
            body.velocity()
        );
    }
}

#[test]
fn calls_add_up_to_the_bit_in_any_order_and_the_report_has_the_sums_in_order_of_handles() {
    let mut world = world(sixty_four());
    let bodies = [0, 1, 2].map(|_| ball(&mut world));
    let mut by_twin = world.clone();
    let calls =
        [(2, fx!(0.1)), (0, fx!(-0.7)), (2, fx!(2147483647)), (0, fx!(0.3)), (2, fx!(-2147483647)), (1, fx!(5))];
    for &(i, f) in &calls {
        world.apply_force_at_point(bodies[i], Vec2::new(f, -f), vec2(fx!(0.3), fx!(1.1))).unwrap();
    }
    for &(i, f) in calls.iter().rev() {
        by_twin.apply_force_at_point(bodies[i], Vec2::new(f, -f), vec2(fx!(0.3), fx!(1.1))).unwrap();
    }
    assert_eq!(world.state_hash(), by_twin.state_hash());
    let applied = world.step().applied.to_vec();
    assert_eq!(applied.iter().map(|row| row.body).collect::<Vec<_>>(), bodies);
    assert_eq!(applied, by_twin.step().applied);
    let tenth = fx!(0.1);
    assert_eq!(applied[2].force(), Some(Vec2::new(wide(tenth), wide(-tenth))), "large forces cancel to the bit");
    assert_eq!(world.state_hash(), by_twin.state_hash());
}

#[test]
fn an_impulse_acts_at_once_and_at_a_point_turns_as_well() {
    let mut world = world(sixty_four());
    let body = ball(&mut world);
    world.set_position(body, vec2(10, 10)).unwrap();
    world.apply_impulse(body, vec2(4, 8)).unwrap();
    let now = |world: &World| world.body(body).map(|b| (b.velocity(), b.angular_velocity())).unwrap();
    assert_eq!(now(&world), (vec2(1, 2), fx!(0)));
    // r × J = 2·8 − 0·4 on 8 kg·m².
    world.apply_impulse_at_point(body, vec2(4, 8), vec2(12, 10)).unwrap();
    assert_eq!(now(&world), (vec2(2, 4), fx!(2)));
    world.apply_angular_impulse(body, fx!(-16)).unwrap();
    assert_eq!(now(&world), (vec2(2, 4), fx!(0)));
    assert_eq!(world.step().applied, [], "impulses are not forces");
    assert_eq!(world.body(body).unwrap().position(), vec2(fx!(10.03125), fx!(10.0625)));
}

#[test]
fn vectors_in_the_frame_of_the_body_turn_with_it() {
    let mut world = world(sixty_four());
    let body = ball(&mut world);
    world.set_position(body, vec2(100, -7)).unwrap();
    // As near to a quarter turn as an angle comes: 411,301,173 quarters.
    world.set_angle(body, Fx::from_bits(2_774_851_117_601_566_901)).unwrap();
    assert_eq!(world.body(body).unwrap().angle_exact(), Turn::QUARTER);
    let force = |vector, point| ForceOrImpulse::Force { force: vector, point };
    world.apply(body, force(vec2(256, 0), Some(vec2(0, fx!(-2)))), ApplyOptions::BODY).unwrap();
    let sums = world.body(body).map(|b| (b.applied_force(), b.applied_torque())).unwrap();
    assert_eq!(sums, (Some(Vec2::new(wide(fx!(0)), wide(fx!(256)))), Some(wide(fx!(512)))));
    let impulse = ForceOrImpulse::Impulse { impulse: vec2(0, 4), point: Some(vec2(2, 0)) };
    world.apply(body, impulse, ApplyOptions::BODY).unwrap();
    let body = world.body(body).unwrap();
    assert_eq!((body.velocity(), body.angular_velocity()), (vec2(fx!(-1), 0), fx!(1)));
}

#[test]
fn a_sleeper_feels_what_wakes_it_and_nothing_else() {
    let mut world = world(WorldDef { sleep_after: Some(3), ..sixty_four() });
    let body = ball(&mut world);
    let mut fell = Vec::new();
    for tick in 1..=5 {
        let report = world.step();
        if report.fell_asleep == [body] {
            fell.push(tick);
        }
        assert_eq!(report.tick, tick);
    }
    assert_eq!(fell, [3]);
    assert_eq!((world.moving_count(), world.body(body).unwrap().activity()), (0, Activity::Asleep));
    let before = world.state_hash();
    let gently = ApplyOptions { wake: false, ..ApplyOptions::default() };
    for action in [
        ForceOrImpulse::Force { force: vec2(1, 0), point: None },
        ForceOrImpulse::Torque(fx!(1)),
        ForceOrImpulse::Impulse { impulse: vec2(1, 0), point: Some(vec2(0, 1)) },
        ForceOrImpulse::AngularImpulse(fx!(1)),
    ] {
        world.apply(body, action, gently).unwrap();
        assert_eq!(world.state_hash(), before, "{action:?}");
        let mut woken = world.clone();
        woken.apply(body, action, ApplyOptions::default()).unwrap();
        assert_eq!(woken.body(body).unwrap().activity(), Activity::Awake, "{action:?}");
        assert_eq!(woken.step().woke, [body], "{action:?}");
        assert_eq!(woken.step().woke, [], "reported once");
    }
    world.wake(body).unwrap();
    assert_eq!(world.step().woke, [body]);
    world.apply(body, ForceOrImpulse::Impulse { impulse: vec2(4, 0), point: None }, gently).unwrap();
    assert_eq!(world.body(body).unwrap().velocity(), vec2(1, 0), "one awake feels it");
}

#[test]
fn a_body_that_is_pushed_every_tick_stays_awake_even_where_the_push_moves_nothing() {
    let mut world = world(WorldDef { sleep_after: Some(3), ..sixty_four() });
    let (pushed, bystander) = (ball(&mut world), ball(&mut world));
    let gently = ApplyOptions { wake: false, ..ApplyOptions::default() };
    for _ in 0..10 {
        for x in [fx!(1), fx!(-1)] {
            world.apply(pushed, ForceOrImpulse::Force { force: vec2(x, 0), point: None }, gently).unwrap();
        }
        world.step();
    }
    // Asleep it would no longer feel what does not wake it.
    assert_eq!(world.body(pushed).unwrap().activity(), Activity::Awake);
    assert_eq!(world.body(bystander).unwrap().activity(), Activity::Asleep);
}

#[test]
fn every_setter_wakes_and_a_sleeper_is_woken_through_its_springs() {
    let mut world = world(WorldDef { sleep_after: Some(2), ..sixty_four() });
    let chain = [0, 1, 2].map(|i| {
        world.add_body(BodyDef { position: vec2(i, 0), ..BodyDef::dynamic().with_collider(disc(fx!(1))) }).unwrap()
    });
    let lone = ball(&mut world);
    for (a, b) in [(0, 1), (1, 2)] {
        let far = End::Body(Attachment::centre(chain[b]));
        let spring = SpringConstants { rest: fx!(1), stiffness: fx!(1), damping: fx!(1) };
        world.add_field(FieldKind::Spring { near: Attachment::centre(chain[a]), far, spring }).unwrap();
    }
    for _ in 0..4 {
        world.step();
    }
    assert_eq!(world.moving_count(), 0);
    type Set = fn(&mut World, BodyId) -> Result<(), Error>;
    let sets: [Set; 16] = [
        |w, b| w.set_position(b, Vec2::ZERO),
        |w, b| w.set_angle(b, Fx::ZERO),
        |w, b| w.set_velocity(b, Vec2::ZERO),
        |w, b| w.set_angular_velocity(b, Fx::ZERO),
        |w, b| w.set_mass(b, Mass::Kilograms(fx!(1))),
        |w, b| w.add_collider(b, disc(fx!(2))).map(drop),
        |w, b| w.set_kind(b, BodyKind::Dynamic),
        |w, b| w.set_gravity_scale(b, fx!(1)),
        |w, b| w.set_body_damping(b, None, None),
        |w, b| w.set_dominance(b, 1),
        |w, b| w.set_bullet(b, true),
        |w, b| w.set_force_groups(b, 1),
        |w, b| w.set_key(b, 0),
        |w, b| w.set_user_data(b, 0),
        |w, b| w.wake(b),
        |w, b| w.remove_body(b),
    ];
    for (i, set) in sets.iter().enumerate() {
        let mut world = world.clone();
        set(&mut world, chain[0]).unwrap();
        for &body in &chain[if i == 15 { 1 } else { 0 }..] {
            assert_eq!(world.body(body).unwrap().activity(), Activity::Awake, "setter {i}, {body}");
        }
        assert_eq!(world.body(lone).unwrap().activity(), Activity::Asleep, "setter {i}");
        assert!(!world.step().woke.contains(&lone));
    }
    world.set_gravity(vec2(0, 0)).unwrap();
    assert_eq!(world.moving_count(), 4, "gravity wakes all");
}

#[test]
fn kinds_move_as_they_say_and_change_into_each_other() {
    let mut world = world(WorldDef { gravity: vec2(0, -64), ..sixty_four() });
    let body = world
        .add_body(BodyDef {
            velocity: vec2(64, 0),
            angular_velocity: fx!(1),
            mass: Mass::Kilograms(fx!(1)),
            ..BodyDef::dynamic().with_collider(disc(fx!(1)))
        })
        .unwrap();
    let anchor = ball(&mut world);
    world.set_kind(body, BodyKind::Kinematic).unwrap();
    assert_eq!(world.body(body).unwrap().mass(), None);
    let spring = SpringConstants { rest: fx!(0), stiffness: fx!(100), damping: fx!(0) };
    let far = End::Body(Attachment::centre(body));
    world.add_field(FieldKind::Spring { near: Attachment::centre(anchor), far, spring }).unwrap();
    world.step();
    assert_eq!(world.body(body).unwrap().position(), vec2(1, 0), "with the velocity it was given");
    assert_eq!(world.body(body).unwrap().velocity(), vec2(64, 0));
    world.set_kind(body, BodyKind::Static).unwrap();
    world.step();
    let still = world.body(body).unwrap();
    assert_eq!((still.position(), still.velocity(), still.angular_velocity()), (vec2(1, 0), Vec2::ZERO, Fx::ZERO));
    assert_eq!(world.moving_count(), 1);
    world.set_kind(body, BodyKind::Dynamic).unwrap();
    assert_eq!(world.body(body).unwrap().mass(), Some(Fx::ONE), "its mass was kept");
    world.apply_force(body, vec2(64, 0)).unwrap();
    world.set_kind(body, BodyKind::Dynamic).unwrap();
    assert_eq!(world.step().applied, [], "a change of kind forgets what was applied");
    assert!(world.body(body).unwrap().velocity().y < fx!(-0.9), "it falls now");
}

#[test]
fn a_removed_body_takes_its_fields_along_and_slots_are_used_again() {
    let mut world = world(sixty_four());
    let bodies = [0, 1, 2].map(|_| ball(&mut world));
    let spring = |a: usize, b: usize| FieldKind::Spring {
        near: Attachment::centre(bodies[a]),
        far: End::Body(Attachment::centre(bodies[b])),
        spring: SpringConstants { rest: fx!(1), stiffness: fx!(1), damping: fx!(1) },
    };
    let thrust = FieldKind::Thrust { at: Attachment::centre(bodies[0]), force: Vec2::X };
    let mu = FxFactor::ONE;
    let carried = FieldKind::Attractor { centre: End::Body(Attachment::centre(bodies[0])), mu, softening: fx!(1) };
    let drag = FieldKind::Drag { linear: fx!(1), quadratic: fx!(0), wind: Vec2::ZERO };
    let custom_forces = [spring(0, 1), spring(1, 0), spring(1, 2), thrust, carried, drag];
    let fields: Vec<FieldId> = custom_forces.into_iter().map(|law| world.add_field(law).unwrap()).collect();
    world.remove_body(bodies[0]).unwrap();
    let left: Vec<FieldId> = world.fields().map(|(id, _)| id).collect();
    assert_eq!(left, [fields[2], fields[5]]);
    let again = world.add_field(drag).unwrap();
    assert_eq!(again.parts(), (4, 1), "the last slot freed, in its next generation");
    assert_eq!(world.field(fields[4]).err(), Some(Error::NoSuchField { field: fields[4] }));
    world.set_field(again, ForceField { force_groups: 0, ..drag.into() }).unwrap();
    assert_eq!(world.field(again).unwrap().force_groups, 0);
    world.remove_body(bodies[1]).unwrap();
    assert_eq!(world.fields().count(), 2);
    assert_eq!((world.body_count(), world.moving_count()), (1, 1));
    assert_eq!(ball(&mut world).parts(), (1, 1));
    assert_eq!(ball(&mut world).parts(), (0, 1));
}

#[test]
fn a_body_removed_with_forces_on_it_leaves_the_others_theirs() {
    let mut world = world(sixty_four());
    let bodies = [0, 1, 2].map(|_| ball(&mut world));
    for (i, &body) in bodies.iter().enumerate() {
        world.apply_force(body, vec2(256 * (1 + i as i32), 0)).unwrap();
    }
    world.remove_body(bodies[0]).unwrap();
    let new = ball(&mut world);
    assert_eq!(world.body(new).unwrap().applied_force(), Some(Vec2::default()), "it has its slot, and not its forces");
    assert_eq!(world.step().applied.len(), 2);
    let moved = [new, bodies[1], bodies[2]].map(|body| world.body(body).unwrap().velocity().x);
    assert_eq!(moved, [fx!(0), fx!(2), fx!(3)]);
}

#[test]
fn values_that_are_set_are_read_back() {
    let mut world = world(WorldDef::default());
    let corners = [vec2(1, 1), vec2(3, 1), vec2(3, 2), vec2(1, 2)];
    let def = BodyDef {
        position: vec2(fx!(-3.7), fx!(1073741824)),
        angle: fx!(6.283),
        velocity: vec2(fx!(1048576), fx!(-0.1)),
        angular_velocity: fx!(0.3),
        colliders: vec![ColliderDef { density: fx!(3), ..ColliderDef::ghost(Shape::polygon(&corners).unwrap()) }],
        mass: Mass::FromColliders,
        gravity_scale: fx!(-0.3),
        linear_damping: Some(Damping::kept_per_second(fx!(0.7))),
        angular_damping: None,
        max_speed: Some(fx!(0.1)),
        max_angular_speed: None,
        locks: Locks::NONE,
        bullet: true,
        dominance: -8,
        force_groups: 6,
        key: 5,
        user_data: u64::MAX,
        kind: BodyKind::Dynamic,
    };
    let id = world.add_body(def.clone()).unwrap();
    let body = world.body(id).unwrap();
    assert_eq!((body.id(), body.kind(), body.activity()), (id, def.kind, Activity::Awake));
    assert_eq!((body.position(), body.velocity()), (def.position, def.velocity));
    assert_eq!((body.angle(), body.angular_velocity()), (def.angle, def.angular_velocity));
    assert_eq!((body.mass(), body.gravity_scale()), (Some(fx!(6)), def.gravity_scale));
    assert_eq!((body.linear_damping(), body.angular_damping()), (def.linear_damping, None));
    assert_eq!((body.max_speed(), body.max_angular_speed()), (def.max_speed, None));
    assert_eq!((body.dominance(), body.force_groups(), body.key(), body.user_data()), (-8, 6, 5, u64::MAX));
    let colliders = world.colliders_of(id).unwrap().map(|collider| world.collider(collider).unwrap());
    assert!(colliders.eq(&def.colliders));
    assert_eq!(body.position_exact().x.to_bits(), i128::from(fx!(-3.7).to_bits()) << 64);
    assert_eq!(world.bodies().count(), 1);
    world.set_angle(id, fx!(-1)).unwrap();
    assert_eq!(world.body(id).unwrap().angle(), Fx::TAU - fx!(1), "angles are read in [0, 2π)");
    assert_eq!(world.body(id).unwrap().angle_exact().to_bits(), Turn::from_radians(fx!(-1)).to_bits());
}

/// The call of the method that a command stands for.
fn by_method(world: &mut World, command: &Command) -> Result<Created, Error> {
    let nothing = |result: Result<(), Error>| result.map(|()| Created::Nothing);
    match command.clone() {
        Command::AddBody(def) => world.add_body(def).map(Created::Body),
        Command::RemoveBody(body) => nothing(world.remove_body(body)),
        Command::Apply { body, action, options } if options == ApplyOptions::default() => nothing(match action {
            ForceOrImpulse::Force { force, point: None } => world.apply_force(body, force),
            ForceOrImpulse::Force { force, point: Some(point) } => world.apply_force_at_point(body, force, point),
            ForceOrImpulse::Torque(torque) => world.apply_torque(body, torque),
            ForceOrImpulse::Impulse { impulse, point: None } => world.apply_impulse(body, impulse),
            ForceOrImpulse::Impulse { impulse, point: Some(point) } => {
                world.apply_impulse_at_point(body, impulse, point)
            }
            ForceOrImpulse::AngularImpulse(impulse) => world.apply_angular_impulse(body, impulse),
        }),
        Command::Apply { body, action, options } => nothing(world.apply(body, action, options)),
        Command::ClearForces => {
            world.clear_forces();
            Ok(Created::Nothing)
        }
        Command::SetPosition { body, position } => nothing(world.set_position(body, position)),
        Command::SetAngle { body, angle } => nothing(world.set_angle(body, angle)),
        Command::SetVelocity { body, velocity } => nothing(world.set_velocity(body, velocity)),
        Command::SetAngularVelocity { body, velocity } => nothing(world.set_angular_velocity(body, velocity)),
        Command::SetMass { body, mass } => nothing(world.set_mass(body, mass)),
        Command::SetKind { body, kind } => nothing(world.set_kind(body, kind)),
        Command::SetGravityScale { body, scale } => nothing(world.set_gravity_scale(body, scale)),
        Command::SetBodyDamping { body, linear, angular } => nothing(world.set_body_damping(body, linear, angular)),
        Command::SetDominance { body, dominance } => nothing(world.set_dominance(body, dominance)),
        Command::Explode(explosion) => nothing(world.explode(&explosion)),
        Command::SetBullet { body, bullet } => nothing(world.set_bullet(body, bullet)),
        Command::ExcludePair { a, b, exclusion } => nothing(world.exclude_pair(a, b, exclusion)),
        Command::AllowPair { a, b } => nothing(world.allow_pair(a, b)),
        Command::SetForceGroups { body, force_groups } => nothing(world.set_force_groups(body, force_groups)),
        Command::SetKey { body, key } => nothing(world.set_key(body, key)),
        Command::SetUserData { body, user_data } => nothing(world.set_user_data(body, user_data)),
        Command::Wake(body) => nothing(world.wake(body)),
        Command::Sleep(body) => nothing(world.sleep(body)),
        Command::Release(body) => nothing(world.release(body)),
        Command::AddField(field) => world.add_field(field).map(Created::ForceField),
        Command::SetField { id, field } => nothing(world.set_field(id, field)),
        Command::RemoveField(id) => nothing(world.remove_field(id)),
        Command::SetTimeStep(time_step) => nothing(world.set_time_step(time_step)),
        Command::SetGravity(gravity) => nothing(world.set_gravity(gravity)),
        Command::SetIntegrator(integrator) => nothing(world.set_integrator(integrator)),
        Command::SetDamping { linear, angular } => nothing(world.set_damping(linear, angular)),
        Command::SetSleepAfter(ticks) => nothing(world.set_sleep_after(ticks)),
        Command::SetRandom(random) => {
            world.set_random(random);
            Ok(Created::Nothing)
        }
        Command::SetBlob(bytes) => nothing(world.set_blob(&bytes)),
        Command::SetLocks { body, locks } => nothing(world.set_locks(body, locks)),
        Command::SetMaxSpeeds { body, linear, angular } => nothing(world.set_max_speeds(body, linear, angular)),
        Command::Disable(body) => nothing(world.disable(body)),
        Command::Enable(body) => nothing(world.enable(body)),
        Command::MoveTo { body, position, angle } => nothing(world.move_to(body, position, angle)),
        Command::AddCollider { body, def } => world.add_collider(body, def).map(Created::Collider),
        Command::SetCollider { collider, def } => nothing(world.set_collider(collider, def)),
        Command::RemoveCollider(collider) => nothing(world.remove_collider(collider)),
        Command::SetContactSettings(contacts) => nothing(world.set_contact_settings(contacts)),
        Command::SetMaterialPair { first, second, pair } => nothing(world.set_material_pair(first, second, pair)),
        Command::AddJoint(def) => world.add_joint(def).map(Created::Joint),
        Command::RemoveJoint(joint) => nothing(world.remove_joint(joint)),
        Command::SetJointKind { joint, kind } => nothing(world.set_joint_kind(joint, kind)),
        Command::SetJointMotor { joint, motor } => nothing(world.set_joint_motor(joint, motor)),
        Command::SetJointBreak { joint, force } => nothing(world.set_joint_break(joint, force)),
        Command::SetJointBreakTorque { joint, torque } => nothing(world.set_joint_break_torque(joint, torque)),
        Command::EnableJoint { joint, enabled } => nothing(world.enable_joint(joint, enabled)),
        command => panic!("{command:?} has no case here"),
    }
}

#[test]
fn a_command_does_what_the_method_of_its_name_does() {
    let mut world = world(WorldDef::default());
    let body = ball(&mut world);
    let gone = BodyId::from_parts(77, 0);
    let joint = JointId::from_parts(0, 0);
    let ends = [End::World(Vec2::ZERO), End::Body(Attachment::centre(body))];
    let pin = JointDef::new(ends, JointKind::default());
    let id = world.add_field(FieldKind::Drag { linear: fx!(1), quadratic: fx!(0), wind: Vec2::ZERO }).unwrap();
    let far = world
        .add_body(BodyDef { position: vec2(fx!(1073741824), 0), velocity: vec2(1, 0), ..BodyDef::dynamic() })
        .unwrap();
    world.step();
    assert_eq!(world.body(far).unwrap().activity(), Activity::Quarantined);
    let square = ColliderDef::new(Shape::rectangle(fx!(1), fx!(1)).unwrap());
    let collider = ColliderId::from_parts(0, 0);
    let options = ApplyOptions::default();
    let apply = |action| Command::Apply { body, action, options };
    let field = ForceField::from(FieldKind::Thrust { at: Attachment::centre(body), force: Vec2::X });
    let force = Vec2::new(fx!(2), fx!(1));
    let commands = [
        Command::AddBody(BodyDef { position: vec2(4, 4), ..BodyDef::dynamic() }),
        Command::AddBody(BodyDef { gravity_scale: fx!(17), ..BodyDef::dynamic() }),
        apply(ForceOrImpulse::Force { force, point: None }),
        apply(ForceOrImpulse::Force { force, point: Some(vec2(1, 3)) }),
        apply(ForceOrImpulse::Torque(fx!(3))),
        apply(ForceOrImpulse::Impulse { impulse: force, point: None }),
        apply(ForceOrImpulse::Impulse { impulse: force, point: Some(vec2(1, 3)) }),
        apply(ForceOrImpulse::AngularImpulse(fx!(3))),
        Command::Apply {
            body,
            action: ForceOrImpulse::Force { force, point: Some(force) },
            options: ApplyOptions::BODY,
        },
        Command::Apply {
            body,
            action: ForceOrImpulse::Torque(fx!(1)),
            options: ApplyOptions { frame: Frame::World, wake: false },
        },
        Command::ClearForces,
        Command::SetPosition { body, position: force },
        Command::SetAngle { body, angle: fx!(2) },
        Command::SetVelocity { body, velocity: force },
        Command::SetAngularVelocity { body, velocity: fx!(2) },
        Command::SetMass { body, mass: Mass::Kilograms(fx!(9)) },
        Command::AddCollider { body, def: disc(fx!(3)) },
        Command::AddCollider { body, def: square.clone() },
        Command::Explode(Explosion { radius: fx!(9), ..Explosion::new(vec2(1, 0), fx!(2)) }),
        Command::AddCollider { body: gone, def: square.clone() },
        Command::SetCollider { collider, def: ColliderDef { density: fx!(3), ..square.clone() } },
        Command::RemoveCollider(collider),
        Command::SetCollider { collider, def: square },
        Command::SetContactSettings(ContactSettings { substeps: 2, ..ContactSettings::default() }),
        Command::SetContactSettings(ContactSettings { substeps: 0, ..ContactSettings::default() }),
        Command::SetMaterialPair { first: 2, second: 1, pair: Some(MaterialPair::default()) },
        Command::SetMaterialPair { first: 0, second: 1, pair: Some(MaterialPair::default()) },
        Command::SetMaterialPair { first: 1, second: 2, pair: None },
        Command::SetKind { body, kind: BodyKind::Kinematic },
        Command::SetKind { body, kind: BodyKind::Dynamic },
        Command::SetGravityScale { body, scale: fx!(2) },
        Command::SetBodyDamping {
            body,
            linear: Some(Damping::kept_per_second(fx!(0.5))),
            angular: Some(Damping::rate(fx!(30))),
        },
        Command::SetDominance { body, dominance: 3 },
        Command::SetBullet { body, bullet: true },
        Command::ExcludePair { a: body, b: far, exclusion: Exclusion::Always },
        Command::ExcludePair { a: body, b: gone, exclusion: Exclusion::UntilApart },
        Command::AllowPair { a: far, b: body },
        Command::SetForceGroups { body, force_groups: 3 },
        Command::SetKey { body, key: 4 },
        Command::SetUserData { body, user_data: 5 },
        Command::Wake(body),
        Command::Wake(gone),
        Command::Sleep(body),
        Command::Sleep(gone),
        Command::Wake(body),
        Command::Release(far),
        Command::Release(body),
        Command::AddField(field),
        Command::SetField { id, field },
        Command::RemoveField(id),
        Command::SetTimeStep(TimeStep::hz(50)),
        Command::SetGravity(force),
        Command::SetIntegrator(Integrator::SymplecticEuler),
        Command::SetDamping {
            linear: Damping::kept_per_second(fx!(0.5)),
            angular: Damping::kept_per_second(fx!(0.25)),
        },
        Command::SetSleepAfter(Some(9)),
        Command::SetRandom(Random::seeded(3)),
        Command::SetBlob(vec![1, 2, 3]),
        Command::SetMaxSpeeds { body, linear: Some(fx!(0.5)), angular: None },
        Command::SetLocks { body, locks: Locks { x: true, ..Locks::NONE } },
        Command::SetVelocity { body, velocity: force },
        Command::Disable(body),
        Command::Disable(body),
        Command::Enable(body),
        Command::Enable(body),
        Command::MoveTo { body, position: force, angle: fx!(1) },
        Command::SetLocks { body, locks: Locks::NONE },
        Command::SetKind { body, kind: BodyKind::Kinematic },
        Command::MoveTo { body, position: force, angle: fx!(1) },
        Command::SetKind { body, kind: BodyKind::Dynamic },
        Command::AddJoint(pin),
        Command::AddJoint(JointDef { break_force: Some(fx!(-1)), ..pin }),
        Command::SetJointMotor { joint, motor: Some(JointMotor { speed: fx!(1), max_force: fx!(2) }) },
        Command::SetJointMotor { joint, motor: None },
        Command::SetJointKind { joint, kind: JointKind::Distance(Distance::rod(fx!(3))) },
        Command::SetJointBreak { joint, force: Some(fx!(9)) },
        Command::SetJointBreakTorque { joint, torque: Some(fx!(9)) },
        Command::EnableJoint { joint, enabled: false },
        Command::RemoveJoint(joint),
        Command::RemoveJoint(joint),
        Command::RemoveBody(body),
        Command::RemoveBody(gone),
    ];
    // The enum is open to more variants, so no match from outside has to name them all: their numbers say which there are.
    for &number in Command::NUMBERS {
        assert!(commands.iter().any(|command| command.number() == number), "no case for number {number}");
    }
    for command in commands {
        let mut twin = world.clone();
        let before = world.state_hash();
        let (created, same) = (world.execute(&command), by_method(&mut twin, &command));
        assert_eq!(created, same, "{command:?}");
        assert_eq!(world.state_hash(), twin.state_hash(), "{command:?}");
        let without_effect =
            matches!(command, Command::Wake(_) | Command::RemoveBody(_) | Command::ClearForces) || created.is_err();
        assert!(without_effect || world.state_hash() != before, "{command:?} changed nothing");
        world.step();
        twin.step();
        assert_eq!(world.state_hash(), twin.state_hash(), "{command:?}, a step later");
        assert_eq!(world.last_report(), twin.last_report());
    }
}

/// A body of this mass that starts at rest, under drag of the square of the speed.
fn heavy_drag(integrator: Integrator, rate: u32, mass: Fx, quadratic: Fx, gravity: Fx) -> (World, BodyId) {
    let gravity = Vec2::new(Fx::ZERO, gravity);
    let mut world = world(WorldDef {
        time_step: TimeStep::hz(rate),
        integrator,
        gravity,
        sleep_after: None,
        ..WorldDef::default()
    });
    let body = world.add_body(BodyDef { mass: Mass::Kilograms(mass), ..BodyDef::dynamic() }).unwrap();
    world.add_field(FieldKind::Drag { linear: Fx::ZERO, quadratic, wind: Vec2::ZERO }).unwrap();
    (world, body)
}

#[test]
fn drag_too_stiff_to_run_backwards_acts_around_the_step_under_yoshida4_also_from_rest() {
    for (rate, mass, quadratic) in [(60, fx!(0.0001), fx!(0.1)), (60, fx!(0.001), fx!(1)), (1, fx!(1), fx!(1))] {
        let speed = |integrator| {
            let (mut world, body) = heavy_drag(integrator, rate, mass, quadratic, fx!(-10));
            for _ in 0..600 {
                let report = world.step();
                assert!(report.faults.is_empty(), "{rate} Hz, {mass} kg, {quadratic}");
                assert_eq!(report.drag_outside, u32::from(integrator == Integrator::Yoshida4));
            }
            -world.body(body).unwrap().velocity().y
        };
        // Under a constant force that is what Verlet does, but for the rounding of three falls in place of one.
        let (yoshida, verlet) = (speed(Integrator::Yoshida4), speed(Integrator::VelocityVerlet));
        assert!((yoshida - verlet).abs() <= Fx::from_bits(4), "{rate} Hz, {mass} kg: {yoshida} against {verlet}");
    }
    // A bullet, then a ball that drag holds back gently: √(F/c) and √(m·g/c).
    let (mut bullet, body) = heavy_drag(Integrator::Yoshida4, 60, fx!(0.01), fx!(0.001), Fx::ZERO);
    for _ in 0..60 {
        bullet.apply_force(body, vec2(1_000, 0)).unwrap();
        assert!(bullet.step().faults.is_empty());
    }
    let speed = bullet.body(body).unwrap().velocity().x;
    assert!(speed > fx!(500) && speed < fx!(1_000), "{speed}");
    let (mut ball, body) = heavy_drag(Integrator::Yoshida4, 60, fx!(1), fx!(0.01), fx!(-10));
    for _ in 0..3_600 {
        assert_eq!(ball.step().drag_outside, 0);
    }
    let off = -ball.body(body).unwrap().velocity().y - fx!(1_000).sqrt();
    assert!(off.abs() < fx!(0.000001), "{off}");
}

#[test]
fn drag_without_coefficients_changes_no_bit() {
    let fall = |with_field: bool| {
        let def = WorldDef { gravity: Vec2::new(Fx::ZERO, -Fx::DELTA), ..WorldDef::default() };
        let mut world = World::new(def).expect("a world");
        let body = world.add_body(BodyDef::dynamic()).expect("a body");
        if with_field {
            let law = FieldKind::Drag { linear: Fx::ZERO, quadratic: Fx::ZERO, wind: Vec2::ZERO };
            world.add_field(law).expect("a field");
        }
        for _ in 0..600 {
            world.step();
        }
        world.body(body).expect("it is there").velocity_exact()
    };
    assert_eq!(fall(true), fall(false));
}

#[test]
fn totals_do_not_depend_on_the_order_of_the_bodies() {
    let far = Fx::from_int(1 << 22);
    let energy = |heights: [Fx; 3]| {
        let def = WorldDef { gravity: Vec2::new(Fx::ZERO, -umbra_physics::limits::GRAVITY), ..WorldDef::default() };
        let mut world = World::new(def).expect("a world");
        for height in heights {
            let mass = Mass::Kilograms(umbra_physics::limits::MASS_MAX);
            let position = Vec2::new(Fx::ZERO, height);
            world.add_body(BodyDef { position, mass, ..BodyDef::dynamic() }).expect("a body");
        }
        world.potential_energy()
    };
    let total = energy([far, -far, far]);
    assert!(total.is_ok());
    assert_eq!(energy([far, far, -far]), total);
}

#[test]
fn setting_the_time_step_it_has_changes_nothing_of_a_world() {
    let mut world = World::new(WorldDef::default()).expect("a world");
    world.step();
    let before = world.state_hash();
    world.set_time_step(TimeStep::ratio(2, 120)).expect("a time step");
    assert_eq!(world.state_hash(), before);
}

#[test]
fn the_smallest_square_is_a_polygon_as_well_as_a_rectangle() {
    let side = umbra_physics::limits::SIZE_MIN;
    let (o, s) = (Fx::ZERO, side);
    assert!(Shape::rectangle(s, s).is_ok());
    assert!(Shape::polygon(&[Vec2::new(o, o), Vec2::new(s, o), Vec2::new(s, s), Vec2::new(o, s)]).is_ok());
    let s = side - Fx::DELTA;
    assert!(Shape::polygon(&[Vec2::new(o, o), Vec2::new(s, o), Vec2::new(s, s), Vec2::new(o, s)]).is_err());
}
