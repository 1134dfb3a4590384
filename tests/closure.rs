//! The next step depends on the state and the inputs alone, and a body's bits on nothing it does not interact with.

use std::sync::Arc;

use umbra_physics::{
    Activity, Attachment, BodyDef, BodyId, BodyKind, BodyState, ColliderDef, ColliderId, CustomForce, CustomForceError,
    Damping, Dependence, End, Error, FieldId, FieldKind, ForceField, ForceTorque, Fx, FxAccumulator, FxFactor,
    Integrator, Mass, Region, Shape, Snapshot, SpringConstants, TimeStep, Vec2, World, WorldDef, fx, vec2,
};

type Bits = ([i128; 5], u64, Activity);

fn bits(world: &World, body: BodyId) -> Bits {
    let body = world.body(body).expect("it is there");
    let (x, v) = (body.position_exact(), body.velocity_exact());
    let sums = [x.x, x.y, v.x, v.y, body.angular_velocity_exact()].map(FxAccumulator::to_bits);
    (sums, body.angle_exact().to_bits(), body.activity())
}

/// Random numbers for orders and choices: xorshift (Marsaglia 2003).
struct Dice(u64);

impl Dice {
    fn throw(&mut self, sides: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        ((self.0 >> 16) % sides as u64) as usize
    }

    /// Within ±size.
    fn number(&mut self, size: Fx) -> Fx {
        let size = size.to_bits();
        Fx::from_bits(self.throw(2 * size as usize) as i64 - size)
    }

    fn vector(&mut self, size: Fx) -> Vec2 {
        Vec2::new(self.number(size), self.number(size))
    }

    fn shuffled(&mut self, count: usize) -> Vec<usize> {
        let mut order: Vec<usize> = (0..count).collect();
        for i in (1..count).rev() {
            order.swap(i, self.throw(i + 1));
        }
        order
    }
}

fn mu(value: Fx) -> FxFactor {
    FxFactor::from_scalar(value)
}

fn spring(start: BodyId, point: Vec2, end: End, rest: Fx, stiffness: Fx, damping: Fx) -> FieldKind {
    FieldKind::Spring {
        near: Attachment { body: start, point },
        far: end,
        spring: SpringConstants { rest, stiffness, damping },
    }
}

fn world_def(integrator: Integrator) -> WorldDef {
    WorldDef {
        gravity: vec2(fx!(0.1), fx!(-2)),
        linear_damping: Damping::kept_per_second(fx!(0.8)),
        angular_damping: Damping::kept_per_second(fx!(0.9)),
        integrator,
        ..WorldDef::default()
    }
}

/// Nine bodies that act on each other in every way there is.
fn cast() -> Vec<BodyDef> {
    let at = |i: u32| vec2(fx!(1.7) * Fx::from(i as i32) - fx!(6), fx!(0.31) * Fx::from((i * i % 7) as i32));
    let plank = |height| ColliderDef::ghost(Shape::rectangle(fx!(0.5), height).expect("a shape"));
    let mut bodies: Vec<BodyDef> = (0..9u32)
        .map(|i| BodyDef {
            position: at(i),
            velocity: vec2(fx!(0.3) * Fx::from(i as i32 % 3 - 1), fx!(-0.2)),
            angle: fx!(0.7) * Fx::from(i as i32),
            angular_velocity: fx!(1.1) - fx!(0.4) * Fx::from(i as i32),
            mass: Mass::Kilograms(fx!(0.3) + fx!(0.37) * Fx::from(i as i32)),
            key: u64::from(i),
            ..BodyDef::dynamic().with_collider(plank(fx!(0.25) + fx!(0.1) * Fx::from(i as i32)))
        })
        .collect();
    bodies[3] =
        BodyDef { velocity: Vec2::ZERO, angular_velocity: Fx::ZERO, key: 3, position: at(3), ..BodyDef::fixed() };
    bodies[5] = BodyDef { kind: BodyKind::Kinematic, ..bodies[5].clone() };
    bodies[6] = BodyDef {
        linear_damping: Some(Damping::kept_per_second(fx!(0.5))),
        gravity_scale: fx!(-0.5),
        ..bodies[6].clone()
    };
    bodies
}

/// The fields between them, with the bodies' handles by their place in the cast.
fn fields(id: &[BodyId]) -> Vec<ForceField> {
    let body = |i: usize, point| End::Body(Attachment { body: id[i], point });
    let drag = |linear, quadratic| FieldKind::Drag { linear, quadratic, wind: vec2(fx!(-0.5), fx!(0.2)) };
    let custom_forces = [
        spring(id[0], vec2(fx!(0.1), fx!(0.2)), body(1, vec2(0, fx!(0.3))), fx!(1), fx!(4), fx!(0.2)),
        spring(id[1], Vec2::ZERO, body(2, vec2(fx!(0.2), 0)), fx!(1.5), fx!(2.3), fx!(0)),
        spring(id[2], vec2(fx!(-0.3), fx!(0.1)), body(3, Vec2::ZERO), fx!(1), fx!(6), fx!(0.1)),
        spring(id[4], Vec2::ZERO, body(5, vec2(fx!(0.2), fx!(0.2))), fx!(1), fx!(6), fx!(0.3)),
        spring(id[6], vec2(0, fx!(0.1)), End::World(vec2(4, 1)), fx!(0.5), fx!(3), fx!(0)),
        FieldKind::Attractor { centre: End::World(vec2(0, -1)), mu: mu(fx!(5)), softening: fx!(0.5) },
        FieldKind::Attractor { centre: body(7, vec2(fx!(0.1), 0)), mu: mu(fx!(1.5)), softening: fx!(0.7) },
        FieldKind::Thrust { at: Attachment { body: id[8], point: vec2(fx!(0.2), 0) }, force: vec2(fx!(0.3), fx!(1)) },
        FieldKind::Zone {
            region: Region::Disc { centre: vec2(0, 0), radius: fx!(3) },
            acceleration: vec2(fx!(0.3), fx!(1)),
        },
        drag(fx!(0.1), fx!(0.02)),
        drag(fx!(0.03), fx!(0.1)),
    ];
    // The medium is there for the dragged bystanders too.
    let force_groups = |law: &FieldKind| if matches!(law, FieldKind::Drag { .. }) { 1 | DRAGGED } else { 1 };
    custom_forces.into_iter().map(|law| ForceField { force_groups: force_groups(&law), kind: law }).collect()
}

/// The cast and its fields in a world, added in some order.
fn stage(integrator: Integrator, order: &[usize]) -> (World, Vec<BodyId>) {
    let mut world = World::new(world_def(integrator)).expect("a world");
    let mut ids = vec![BodyId::from_parts(u32::MAX, 0); 9];
    for &i in order {
        ids[i] = world.add_body(cast()[i].clone()).expect("a body");
    }
    for field in fields(&ids) {
        world.add_field(field).expect("a field");
    }
    (world, ids)
}

/// Forces applied at a tick: body, force, point.
fn pushes(tick: u32) -> Vec<(usize, Vec2, Vec2)> {
    let mut dice = Dice(0x9e37_79b9_7f4a_7c15 + u64::from(tick));
    (0..dice.throw(6))
        .map(|_| ([0, 1, 2, 4, 6, 7, 8][dice.throw(7)], dice.vector(fx!(3)), dice.vector(fx!(2))))
        .collect()
}

fn push_all(world: &mut World, ids: &[BodyId], tick: u32, order: impl Fn(usize) -> Vec<usize>) {
    let pushes = pushes(tick);
    for i in order(pushes.len()) {
        let (body, force, point) = pushes[i];
        world.apply_force_at_point(ids[body], force, point).expect("a force");
    }
}

fn in_order(count: usize) -> Vec<usize> {
    (0..count).collect()
}

fn ticks() -> u32 {
    crate::seeds::times(100)
}

#[test]
fn the_hash_of_the_motion_is_the_same_in_whatever_order_the_world_was_built() {
    for integrator in Integrator::ALL {
        let (mut straight, ids) = stage(integrator, &in_order(9));
        let (mut shuffled, others) = stage(integrator, &Dice(3).shuffled(9));
        // Another history of handles as well.
        let gone = shuffled.add_body(BodyDef::fixed()).expect("a body");
        shuffled.remove_body(gone).expect("it is there");
        for tick in 0..ticks() / 4 {
            assert_eq!(straight.physics_hash(), shuffled.physics_hash(), "{integrator:?}, tick {tick}");
            push_all(&mut straight, &ids, tick, in_order);
            push_all(&mut shuffled, &others, tick, |count| Dice(7).shuffled(count));
            assert_eq!(straight.physics_hash(), shuffled.physics_hash(), "{integrator:?}, tick {tick}, pushed");
            straight.step();
            shuffled.step();
        }
        assert_ne!(straight.state_hash(), shuffled.state_hash());
        let before = straight.physics_hash();
        let mut hashes = vec![before];
        let mut hash_after = |change: &dyn Fn(&mut World)| {
            let mut world = straight.clone();
            change(&mut world);
            let hash = world.physics_hash();
            assert!(!hashes.contains(&hash), "{integrator:?}: a change that is not in the hash");
            hashes.push(hash);
        };
        let body = ids[4];
        let place = straight.body(body).expect("it is there").position();
        hash_after(&|world| world.set_position(body, place + vec2(Fx::DELTA, 0)).expect("near"));
        hash_after(&|world| world.set_user_data(body, 1).expect("it is there"));
        hash_after(&|world| world.apply_force(body, vec2(Fx::DELTA, 0)).expect("it is dynamic"));
        hash_after(&|world| world.set_gravity(vec2(0, -1)).expect("in range"));
        hash_after(&|world| {
            let collider = world.colliders_of(body).expect("it is there").next().expect("one");
            world.remove_collider(collider).expect("it has a mass");
        });
        hash_after(&|world| {
            let (id, _) = world.fields().next().expect("one");
            world.remove_field(id).expect("it is there");
        });
        hash_after(&|world| {
            // Drags act in order.
            let drags: Vec<(FieldId, ForceField)> = world
                .fields()
                .filter(|(_, field)| matches!(field.kind, FieldKind::Drag { .. }))
                .map(|(id, field)| (id, *field))
                .collect();
            world.set_field(drags[0].0, drags[1].1).expect("a field");
            world.set_field(drags[1].0, drags[0].1).expect("a field");
        });
        hash_after(&|world| _ = world.step());
    }
}

#[test]
fn the_order_of_adding_bodies_and_of_calling_changes_no_bit_of_a_body() {
    for integrator in Integrator::ALL {
        let (mut straight, ids) = stage(integrator, &in_order(9));
        let mut others: Vec<_> = (1..5)
            .map(|seed| {
                let mut dice = Dice(seed * 77);
                stage(integrator, &dice.shuffled(9))
            })
            .collect();
        for tick in 0..ticks() {
            push_all(&mut straight, &ids, tick, in_order);
            straight.step();
            for (seed, (world, handles)) in others.iter_mut().enumerate() {
                push_all(world, handles, tick, |count| Dice(u64::from(tick) * 31 + seed as u64 + 1).shuffled(count));
                world.step();
                for i in 0..9 {
                    let (is, wanted) = (bits(world, handles[i]), bits(&straight, ids[i]));
                    assert_eq!(is, wanted, "{integrator:?}, tick {tick}, order {seed}, body {i}");
                }
            }
        }
    }
}

#[test]
fn the_order_of_adding_fields_changes_no_bit_but_for_drags_among_themselves() {
    for integrator in Integrator::ALL {
        let (mut straight, ids) = stage(integrator, &in_order(9));
        let (mut reordered, same) = stage(integrator, &in_order(9));
        let all: Vec<FieldId> = reordered.fields().map(|(id, _)| id).collect();
        all.into_iter().for_each(|id| reordered.remove_field(id).expect("it is there"));
        let fields = fields(&same);
        let is_drag = |i: usize| matches!(fields[i].kind, FieldKind::Drag { .. });
        let mut order = Dice(5).shuffled(fields.len());
        // The drags change places until they are in order.
        let (places, mut drags): (Vec<_>, Vec<_>) =
            order.iter().copied().enumerate().filter(|&(_, i)| is_drag(i)).unzip();
        drags.sort_unstable();
        places.into_iter().zip(drags).for_each(|(place, drag)| order[place] = drag);
        let mut handles = Vec::new();
        for &i in &order {
            handles.push(reordered.add_field(fields[i]).expect("a field"));
        }
        // Free slots are taken from the last one freed on: their order is not that of the drags.
        assert!(handles.is_sorted_by(|a, b| a.parts().0 > b.parts().0));
        for tick in 0..ticks() {
            push_all(&mut straight, &ids, tick, in_order);
            push_all(&mut reordered, &same, tick, in_order);
            straight.step();
            reordered.step();
            for i in 0..9 {
                assert_eq!(bits(&reordered, same[i]), bits(&straight, ids[i]), "{integrator:?}, tick {tick}, body {i}");
            }
        }
    }
}

/// The group of bystanders that only drags act on.
const DRAGGED: u32 = 8;

/// Bodies that no field of the cast's acts on, or the drags alone: sleepers, static ones, some on springs, some that leave
/// the envelope, some so fast that `Yoshida4` has their drag around the step.
fn add_stranger(world: &mut World, i: usize, last: Option<BodyId>) -> BodyId {
    let position = vec2(50 + i as i32, -3);
    let base = BodyDef { position, force_groups: 2, ..BodyDef::dynamic() };
    let def = match i % 6 {
        0 => BodyDef { gravity_scale: Fx::ZERO, ..base },
        1 => BodyDef { position, ..BodyDef::fixed() },
        2 => BodyDef {
            velocity: vec2(fx!(1), 0),
            linear_damping: Some(Damping::NONE),
            mass: Mass::Kilograms(fx!(77)),
            ..base
        },
        3 => BodyDef { position: vec2(fx!(1073741823), 0), velocity: vec2(fx!(900000), 0), ..base },
        4 => BodyDef { kind: BodyKind::Kinematic, velocity: vec2(0, fx!(3)), ..base },
        _ => BodyDef {
            velocity: vec2(fx!(9000), 0),
            angular_velocity: fx!(50),
            angular_damping: Some(Damping::kept_per_second(fx!(0.1))),
            force_groups: DRAGGED,
            ..base
        },
    };
    let body = world.add_body(def).expect("a bystander");
    if let Some(last) = last {
        // Where neither end gives there is no spring.
        let _ = world.add_field(spring(body, Vec2::ZERO, End::Body(Attachment::centre(last)), fx!(1), fx!(9), fx!(1)));
    }
    body
}

#[test]
fn strangers_in_any_number_change_no_bit_of_a_body() {
    for integrator in Integrator::ALL {
        let (mut alone, ids) = stage(integrator, &in_order(9));
        let mut history = Vec::new();
        for tick in 0..ticks() / 2 {
            push_all(&mut alone, &ids, tick, in_order);
            alone.step();
            history.push(ids.iter().map(|&id| bits(&alone, id)).collect::<Vec<_>>());
        }
        for count in 0..=17 {
            let mut world = World::new(world_def(integrator)).expect("a world");
            let mut bystanders: Vec<BodyId> = Vec::new();
            let mut ids = Vec::new();
            for (i, def) in cast().into_iter().enumerate() {
                // Half of them come in between.
                if i < count / 2 {
                    bystanders.push(add_stranger(&mut world, i, bystanders.last().copied()));
                }
                ids.push(world.add_body(def).expect("a body"));
            }
            for field in fields(&ids) {
                world.add_field(field).expect("a field");
            }
            let (mut gone, mut faults, mut outside) = (0, 0, 0);
            for (tick, wanted) in history.iter().enumerate() {
                if bystanders.len() + gone < count && tick % 7 == 0 {
                    let i = bystanders.len() + gone;
                    bystanders.push(add_stranger(&mut world, i, bystanders.last().copied()));
                }
                if tick % 23 == 22 && bystanders.len() > 3 {
                    world.remove_body(bystanders.remove(tick % 3)).expect("it is there");
                    gone += 1;
                }
                push_all(&mut world, &ids, tick as u32, in_order);
                let report = world.step();
                faults += report.faults.len();
                outside += report.drag_outside;
                for (i, (&id, wanted)) in ids.iter().zip(wanted).enumerate() {
                    assert_eq!(bits(&world, id), *wanted, "{integrator:?}, {count} bystanders, tick {tick}, body {i}");
                }
            }
            assert!(
                count < 8 || integrator != Integrator::Yoshida4 || outside > 0,
                "no drag of a bystander is that stiff"
            );
            assert!(count < 8 || faults > 0, "one of the bystanders is to be taken out");
        }
    }
}

#[test]
fn the_cache_of_fields_is_no_state() {
    for integrator in Integrator::ALL {
        let (mut world, ids) = stage(integrator, &in_order(9));
        let mut dropping = world.clone();
        for tick in 0..ticks() {
            push_all(&mut world, &ids, tick, in_order);
            push_all(&mut dropping, &ids, tick, in_order);
            // It changes nothing, but whatever is cached has to go.
            dropping.set_key(ids[0], 0).expect("it is there");
            world.step();
            dropping.step();
            assert_eq!(world.state_hash(), dropping.state_hash(), "{integrator:?}, tick {tick}");
        }
    }
}

#[test]
fn a_clone_has_the_same_future_and_leaves_the_original_alone() {
    for integrator in Integrator::ALL {
        let (mut world, ids) = stage(integrator, &in_order(9));
        for tick in 0..37 {
            push_all(&mut world, &ids, tick, in_order);
            world.step();
        }
        let mut into = World::new(WorldDef::default()).expect("a world");
        into.clone_from(&world);
        let mut straight = world.clone();
        let futures: Vec<u64> = (37..97)
            .map(|tick| {
                push_all(&mut world, &ids, tick, in_order);
                world.step();
                world.state_hash()
            })
            .collect();
        for (tick, wanted) in (37..97).zip(futures) {
            for twin in [&mut straight, &mut into] {
                push_all(twin, &ids, tick, in_order);
                twin.step();
                assert_eq!(twin.state_hash(), wanted, "{integrator:?}, tick {tick}");
            }
        }
    }
}

/// A pool of bodies at rest or nearly so, on springs, that strong damping brings to rest to the bit.
fn pool(integrator: Integrator, sleep_after: Option<u32>) -> (World, Vec<BodyId>) {
    let def = WorldDef {
        sleep_after,
        linear_damping: Damping::kept_per_second(fx!(0.0001)),
        angular_damping: Damping::kept_per_second(fx!(0.0001)),
        integrator,
        ..WorldDef::default()
    };
    let mut world = World::new(def).expect("a world");
    let bodies: Vec<BodyId> = (0..12)
        .map(|i| {
            let disc = ColliderDef::ghost(Shape::circle(fx!(0.5)).expect("a disc"));
            let kind = [BodyKind::Dynamic, BodyKind::Kinematic, BodyKind::Static][[0, 0, 0, 1, 0, 2][i as usize % 6]];
            let def = BodyDef { kind, position: vec2(3 * i, i % 5), force_groups: 1 << (i % 3), ..BodyDef::dynamic() };
            let def = def.with_collider(disc);
            world.add_body(def).expect("a body")
        })
        .collect();
    for (a, b) in [(0, 1), (1, 2), (2, 3), (4, 5), (6, 7), (8, 9), (8, 10)] {
        let far = End::Body(Attachment { body: bodies[b], point: vec2(0, fx!(0.25)) });
        world.add_field(spring(bodies[a], vec2(fx!(0.3), 0), far, fx!(3), fx!(20), fx!(1))).expect("a spring");
    }
    (world, bodies)
}

/// One of many changes, the same in both worlds; forces and impulses wake, as those that do not are for sleepers alone.
fn change(world: &mut World, bodies: &[BodyId], dice: &mut Dice) -> Result<(), Error> {
    let body = bodies[dice.throw(bodies.len())];
    let partner = bodies[dice.throw(bodies.len())];
    let fields: Vec<FieldId> = world.fields().map(|(id, _)| id).collect();
    let tiny = Fx::from_bits(dice.throw(64) as i64);
    match dice.throw(26) {
        0 => world.apply_force(body, dice.vector(fx!(2))),
        1 => world.apply_torque(body, dice.number(fx!(2))),
        2 => world.apply_impulse_at_point(body, dice.vector(fx!(2)), dice.vector(fx!(5))),
        3 => world.apply_angular_impulse(body, dice.number(fx!(1))),
        4 => world.set_position(body, dice.vector(fx!(20))),
        5 => world.set_angle(body, dice.number(fx!(7))),
        6 => world.set_velocity(body, dice.vector(fx!(1))),
        7 => world.set_angular_velocity(body, dice.number(fx!(1))),
        8 => world.set_mass(body, Mass::Kilograms(fx!(1) + dice.number(fx!(0.9)))),
        9 => {
            let def = ColliderDef::ghost(Shape::circle(fx!(1) + dice.number(fx!(0.9)))?);
            let collider = world.colliders_of(body)?.next();
            match collider {
                Some(collider) => world.set_collider(collider, def),
                None => world.add_collider(body, def).map(drop),
            }
        }
        10 => world.set_kind(body, [BodyKind::Dynamic, BodyKind::Static, BodyKind::Kinematic][dice.throw(3)]),
        11 => world.set_gravity_scale(body, dice.number(fx!(1))),
        12 => world.set_body_damping(
            body,
            Some(Damping::kept_per_second(fx!(0.001))),
            [None, Some(Damping::kept_per_second(fx!(0.01)))][dice.throw(2)],
        ),
        13 => world.set_force_groups(body, dice.throw(8) as u32),
        14 => world.wake(body),
        15 => world.set_time_step(TimeStep::ratio(1, [1, 10, 60, 64, 1000][dice.throw(5)])),
        // Gravity so small that what it gives in a short step is damped away, and in a long one is not.
        16 => world.set_gravity(Vec2::new(tiny, -tiny)),
        17 => world.set_integrator(Integrator::ALL[dice.throw(5)]),
        18 => world.set_damping(
            Damping::kept_per_second(fx!(0.0001)),
            [fx!(0.0001), fx!(0.01)].map(Damping::kept_per_second)[dice.throw(2)],
        ),
        19 => {
            let far = End::Body(Attachment::centre(partner));
            world.add_field(spring(body, vec2(0, fx!(0.1)), far, fx!(2), fx!(5), fx!(0.5))).map(drop)
        }
        20 => {
            let centre = End::Body(Attachment::centre(body));
            let law = FieldKind::Attractor { centre, mu: mu(dice.number(fx!(0.0001))), softening: fx!(1) };
            world.add_field(ForceField { kind: law, force_groups: 2 }).map(drop)
        }
        21 => {
            let region = Region::Disc { centre: dice.vector(fx!(20)), radius: fx!(4) };
            let law = FieldKind::Zone { region, acceleration: Vec2::new(tiny, tiny) };
            world.add_field(ForceField { kind: law, force_groups: 4 }).map(drop)
        }
        22..=24 if !fields.is_empty() => world.remove_field(fields[dice.throw(fields.len())]),
        _ => Ok(()),
    }
}

#[test]
fn sleeping_off_equals_sleeping_on_bit_for_bit_in_motion() {
    let runs = crate::seeds::times(6);
    let (mut slept, mut woken) = (0, 0);
    for seed in 1..=runs {
        let integrator = Integrator::ALL[seed as usize % 5];
        let (mut awake, bodies) = pool(integrator, None);
        let (mut sleepy, same) = pool(integrator, Some(1 + seed as u32 % 3));
        assert_eq!(bodies, same);
        let mut dice = [Dice(seed * 0x1234_5678_9abc_def1), Dice(seed * 0x1234_5678_9abc_def1)];
        for tick in 0..2_000 {
            // Pauses long enough to fall asleep.
            if tick % 40 == 0 {
                for _ in 0..1 + tick / 40 % 3 {
                    let [first, second] = &mut dice;
                    let (a, b) = (change(&mut awake, &bodies, first), change(&mut sleepy, &bodies, second));
                    assert_eq!(a, b, "run {seed}, tick {tick}");
                }
            }
            awake.step();
            let report = sleepy.step();
            slept += report.fell_asleep.len();
            woken += report.woke.len();
            for &body in &bodies {
                let ((a, turn, activity), (b, same, _)) = (bits(&awake, body), bits(&sleepy, body));
                let is = sleepy.body(body).expect("it is there").activity();
                assert!((activity == Activity::Quarantined) == (is == Activity::Quarantined));
                assert_eq!(
                    (a, turn),
                    (b, same),
                    "run {seed}, {:?}, tick {tick}, {body}, {is:?}",
                    sleepy.def().integrator
                );
            }
        }
    }
    println!("{slept} fell asleep, {woken} woke");
    assert!(slept > 100 && woken > 100, "{slept} fell asleep, {woken} woke: too few to show anything");
}

#[test]
fn no_cache_outlives_a_change() {
    let runs = crate::seeds::times(5);
    for seed in 1..=runs {
        let (mut keeping, bodies) = pool(Integrator::ALL[seed as usize % 5], None);
        let mut dropping = keeping.clone();
        let mut dice = [Dice(seed * 0x0fed_cba9_8765_4321), Dice(seed * 0x0fed_cba9_8765_4321)];
        for tick in 0..600 {
            let [first, second] = &mut dice;
            if tick % 3 == 0 {
                let (a, b) = (change(&mut keeping, &bodies, first), change(&mut dropping, &bodies, second));
                assert_eq!(a, b, "run {seed}, tick {tick}");
            }
            // The same gravity: all that is derived is made anew.
            let gravity = dropping.def().gravity;
            dropping.set_gravity(gravity).expect("it was there before");
            keeping.step();
            dropping.step();
            assert_eq!(keeping.state_hash(), dropping.state_hash(), "run {seed}, tick {tick}");
        }
    }
}

#[test]
fn a_longer_time_step_moves_a_sleeper_that_a_shorter_one_left_at_rest() {
    // 8 ulp/s²: in 1/1000 s less than half an ulp/s, which damping clears; in 1 s eight of them.
    let make = |sleep_after| {
        let def = WorldDef {
            time_step: TimeStep::hz(1_000),
            gravity: Vec2::new(Fx::ZERO, Fx::from_bits(-8)),
            linear_damping: Damping::kept_per_second(fx!(0.5)),
            sleep_after,
            ..WorldDef::default()
        };
        let mut world = World::new(def).expect("a world");
        let body = world.add_body(BodyDef::dynamic()).expect("a body");
        (world, body)
    };
    let ((mut awake, body), (mut sleepy, _)) = (make(None), make(Some(2)));
    for step in [TimeStep::hz(1_000), TimeStep::hz(1)] {
        for world in [&mut awake, &mut sleepy] {
            world.set_time_step(step).expect("a time step");
            for _ in 0..5 {
                world.step();
            }
        }
        let ((a, ..), (b, ..)) = (bits(&awake, body), bits(&sleepy, body));
        assert_eq!(a, b, "{step:?}");
    }
}

#[test]
fn another_integrator_moves_a_sleeper_that_the_one_before_left_at_rest() {
    // 24 ulp/s²: 0.4 ulp/s a step, which damping clears; the first of Yoshida's sub-steps gains 0.54, which it does not.
    let make = |sleep_after| {
        let gravity = Vec2::new(Fx::ZERO, Fx::from_bits(-24));
        let mut world = World::new(WorldDef {
            gravity,
            linear_damping: Damping::kept_per_second(fx!(0.5)),
            sleep_after,
            ..WorldDef::default()
        })
        .expect("a world");
        let body = world.add_body(BodyDef::dynamic()).expect("a body");
        (world, body)
    };
    let ((mut awake, body), (mut sleepy, _)) = (make(None), make(Some(2)));
    for integrator in [Integrator::VelocityVerlet, Integrator::Yoshida4] {
        for world in [&mut awake, &mut sleepy] {
            world.set_integrator(integrator).expect("any");
            for _ in 0..5 {
                world.step();
            }
        }
        let ((a, ..), (b, ..)) = (bits(&awake, body), bits(&sleepy, body));
        assert_eq!(a, b, "{integrator:?}");
        assert_eq!(a[3] != 0, integrator == Integrator::Yoshida4, "{integrator:?}: {a:?}");
    }
}

#[test]
fn a_stranger_that_falls_asleep_puts_nobody_else_to_sleep() {
    let asleep_at = |bystander: Option<u64>| {
        let mut world = World::new(WorldDef { sleep_after: Some(10), ..WorldDef::default() }).expect("a world");
        let still = world.add_body(BodyDef::dynamic()).expect("a body");
        let spinning = world.add_body(BodyDef { angular_velocity: fx!(1), ..BodyDef::dynamic() }).expect("a body");
        let link = spring(still, Vec2::ZERO, End::Body(Attachment::centre(spinning)), fx!(0), fx!(0), fx!(0));
        let link = world.add_field(link).expect("a spring");
        (1..100)
            .find(|&tick| {
                if Some(tick) == bystander {
                    world.add_body(BodyDef::dynamic()).expect("a body");
                }
                // Kept up by the other one till here, at rest for longer than it takes.
                if tick == 14 {
                    world.remove_field(link).expect("it is there");
                }
                world.step().fell_asleep.contains(&still)
            })
            .expect("it falls asleep")
    };
    for bystander in 1..20 {
        assert_eq!(asleep_at(Some(bystander)), asleep_at(None), "a bystander from tick {bystander} on");
    }
}

#[test]
fn drags_act_in_the_order_in_which_they_came_whichever_slots_strangers_left_them() {
    let zone = FieldKind::Zone { region: Region::Disc { centre: Vec2::ZERO, radius: fx!(1) }, acceleration: Vec2::X };
    let strange = ForceField { force_groups: 2, ..ForceField::from(zone) };
    let drag = |linear, wind| FieldKind::Drag { linear, quadratic: fx!(0.3), wind: vec2(wind, 0) };
    // A bystander's field makes room after the first drag came, and the second one takes its place.
    let play = |bystanders: bool, restored: bool, drags: [FieldKind; 2]| {
        let mut world = World::new(WorldDef::default()).expect("a world");
        let body = world.add_body(BodyDef { velocity: vec2(7, -2), ..BodyDef::dynamic() }).expect("a body");
        let bystander = bystanders.then(|| world.add_field(strange).expect("a field"));
        let first = world.add_field(drags[0]).expect("a drag");
        bystander.into_iter().for_each(|bystander| world.remove_field(bystander).expect("it is there"));
        let second = world.add_field(drags[1]).expect("a drag");
        assert_eq!(second.parts().0 < first.parts().0, bystanders, "it takes the slot that was left");
        assert!(world.fields().map(|(id, _)| id).eq([first, second]));
        // One that becomes another stays where it is.
        world.set_field(first, drags[0]).expect("a drag");
        if restored {
            let bytes = world.snapshot().to_bytes();
            world = Snapshot::from_bytes(&bytes, &[]).expect("it is whole").into_world();
        }
        for _ in 0..10 {
            world.step();
        }
        bits(&world, body)
    };
    let drags = [drag(fx!(0.5), fx!(3)), drag(fx!(0.2), fx!(-4))];
    let alone = play(false, false, drags);
    for (bystanders, restored) in [(true, false), (true, true), (false, true)] {
        assert_eq!(play(bystanders, restored, drags), alone, "bystanders: {bystanders}, restored: {restored}");
    }
    assert_ne!(play(false, false, [drags[1], drags[0]]), alone, "the order makes a difference");
}

#[test]
fn a_field_wakes_whom_it_acts_on_and_what_hangs_on_them_alone() {
    let disc = Region::Disc { centre: Vec2::ZERO, radius: fx!(1) };
    let custom_forces = [
        FieldKind::Zone { region: disc, acceleration: Vec2::X },
        FieldKind::Drag { linear: fx!(1), quadratic: fx!(0), wind: Vec2::X },
        FieldKind::Attractor { centre: End::World(Vec2::ZERO), mu: mu(fx!(1)), softening: fx!(1) },
        FieldKind::Custom { id: 5 },
    ];
    for law in custom_forces {
        let mut world = World::new(WorldDef { sleep_after: Some(3), ..WorldDef::default() }).expect("a world");
        world.register_custom_force(Arc::new(Push1(5, 1))).expect("a law");
        let mut add = |force_groups, x: i32| {
            let position = vec2(Fx::from(x), 0);
            world.add_body(BodyDef { position, force_groups, ..BodyDef::dynamic() }).expect("a body")
        };
        let (active, hanging, strange) = (add(4, 5), add(1, 6), add(2, 7));
        let far = End::Body(Attachment::centre(hanging));
        world.add_field(spring(active, Vec2::ZERO, far, fx!(1), fx!(1), fx!(0))).expect("a spring");
        let asleep = |world: &World| {
            [active, hanging, strange].map(|body| world.body(body).expect("it is there").activity() == Activity::Asleep)
        };
        let rest = |world: &mut World| {
            for _ in 0..9 {
                world.step();
            }
            assert_eq!(asleep(world), [true; 3], "{law:?}");
        };
        rest(&mut world);
        let field_of = |force_groups| ForceField { force_groups, ..ForceField::from(law) };
        let field = world.add_field(field_of(8)).expect("a field");
        assert_eq!(asleep(&world), [true; 3], "{law:?} acts on none");
        world.set_field(field, field_of(4)).expect("a field");
        assert_eq!(asleep(&world), [false, false, true], "{law:?} acts on one, and a spring joins it to another");
        world.step();
        world.set_field(field, field_of(8)).expect("a field");
        for body in [active, hanging] {
            world.set_velocity(body, Vec2::ZERO).expect("it is there");
            world.set_position(body, vec2(if body == active { 5 } else { 6 }, 0)).expect("it is there");
        }
        rest(&mut world);
        world.set_field(field, field_of(2)).expect("a field");
        assert_eq!(asleep(&world), [true, true, false], "{law:?} acts on the other");
        world.remove_field(field).expect("it is there");
        assert_eq!(asleep(&world), [true, true, false], "{law:?}");
    }
}

#[test]
fn a_spring_added_to_a_shared_anchor_wakes_no_other_body_that_hangs_there() {
    let mut world = World::new(WorldDef { sleep_after: Some(3), ..WorldDef::default() }).expect("a world");
    let anchor = world.add_body(BodyDef::fixed()).expect("a body");
    let hang = |world: &mut World, x: i32| {
        let body = world.add_body(BodyDef { position: vec2(Fx::from(x), 0), ..BodyDef::dynamic() }).expect("a body");
        let far = End::Body(Attachment::centre(anchor));
        let rest = Fx::from(x).abs();
        let link = world.add_field(spring(body, Vec2::ZERO, far, rest, fx!(1), fx!(0))).expect("a spring");
        (body, link)
    };
    let (hung, _) = hang(&mut world, 3);
    let is_asleep = |world: &World| world.body(hung).expect("it is there").activity() == Activity::Asleep;
    (0..9).for_each(|_| _ = world.step());
    assert!(is_asleep(&world));
    let (_, link) = hang(&mut world, -4);
    assert!(is_asleep(&world), "another came");
    world.step();
    world.remove_field(link).expect("it is there");
    assert!(is_asleep(&world), "and went");
    world.set_position(anchor, vec2(0, 1)).expect("it is there");
    assert!(!is_asleep(&world), "the anchor moved");
}

#[test]
fn no_body_sleeps_while_an_attractor_may_come_by() {
    // From 4000 m its pull is cleared by damping, so that the body stays where it is to the bit; from near it is not.
    let make = |sleep_after| {
        let mut world = World::new(WorldDef {
            linear_damping: Damping::kept_per_second(fx!(0.5)),
            sleep_after,
            ..WorldDef::default()
        })
        .expect("a world");
        let body = world.add_body(BodyDef { position: vec2(0, 1), ..BodyDef::dynamic() }).expect("a body");
        let comet = BodyDef { position: vec2(4_000, 0), velocity: vec2(-1_000, 0), ..BodyDef::kinematic() };
        let centre = End::Body(Attachment::centre(world.add_body(comet).expect("a body")));
        world.add_field(FieldKind::Attractor { centre, mu: mu(fx!(0.01)), softening: fx!(0) }).expect("a field");
        (world, body)
    };
    let ((mut awake, body), (mut sleepy, _)) = (make(None), make(Some(2)));
    let start = bits(&awake, body);
    for tick in 0..300 {
        awake.step();
        sleepy.step();
        assert_eq!(bits(&awake, body), bits(&sleepy, body), "tick {tick}");
        assert!(tick > 30 || bits(&awake, body) == start, "tick {tick}: it is to be at rest at first");
    }
    assert_ne!(bits(&awake, body), start);
}

#[test]
fn a_stale_handle_is_refused_after_removal_and_after_its_slot_is_taken_again() {
    let mut world = World::new(WorldDef::default()).expect("a world");
    let first = world.add_body(BodyDef::dynamic()).expect("a body");
    let field =
        world.add_field(FieldKind::Thrust { at: Attachment::centre(first), force: vec2(1, 0) }).expect("a field");
    world.remove_body(first).expect("it is there");
    let check = |world: &mut World| {
        let before = world.state_hash();
        assert_eq!(world.body(first).err(), Some(Error::NoSuchBody { body: first }));
        assert_eq!(world.set_key(first, 1), Err(Error::NoSuchBody { body: first }));
        assert_eq!(world.apply_force(first, Vec2::X), Err(Error::NoSuchBody { body: first }));
        assert_eq!(world.remove_body(first), Err(Error::NoSuchBody { body: first }));
        assert_eq!(world.release(first), Err(Error::NoSuchBody { body: first }));
        let law = spring(first, Vec2::ZERO, End::World(Vec2::ZERO), fx!(1), fx!(1), fx!(0));
        assert_eq!(world.add_field(law), Err(Error::NoSuchBody { body: first }));
        assert_eq!(world.field(field).err(), Some(Error::NoSuchField { field }));
        assert_eq!(world.remove_field(field), Err(Error::NoSuchField { field }));
        assert_eq!(world.state_hash(), before);
    };
    check(&mut world);
    let second = world.add_body(BodyDef::dynamic()).expect("a body");
    let thrust =
        world.add_field(FieldKind::Thrust { at: Attachment::centre(second), force: vec2(1, 0) }).expect("a field");
    assert_eq!((first.parts().0, second.parts()), (second.parts().0, (0, 1)), "the slot is taken again");
    assert_eq!((field.parts().0, thrust.parts()), (thrust.parts().0, (0, 1)));
    check(&mut world);
}

#[test]
fn the_hash_tells_histories_apart_that_lead_to_other_handles() {
    let make = |removed: [usize; 2]| {
        let mut world = World::new(WorldDef::default()).expect("a world");
        let bodies = [0, 1, 2].map(|_| world.add_body(BodyDef::dynamic()).expect("a body"));
        removed.into_iter().for_each(|i| world.remove_body(bodies[i]).expect("it is there"));
        world
    };
    let (mut first, mut second) = (make([0, 1]), make([1, 0]));
    let left = |world: &World| world.bodies().map(|body| bits(world, body.id())).collect::<Vec<_>>();
    assert_eq!(left(&first), left(&second), "the bodies that are left are the same");
    assert_ne!(first.state_hash(), second.state_hash(), "and yet the next handle is not");
    let next = [first.add_body(BodyDef::dynamic()), second.add_body(BodyDef::dynamic())]
        .map(|id| id.expect("a body").parts().0);
    assert_eq!(next, [1, 0], "the last slot freed is taken first");
    let make = |removed: [usize; 2]| {
        let mut world = World::new(WorldDef::default()).expect("a world");
        let zone =
            FieldKind::Zone { region: Region::Disc { centre: Vec2::ZERO, radius: fx!(1) }, acceleration: Vec2::X };
        let fields = [0, 1, 2].map(|_| world.add_field(zone).expect("a field"));
        removed.into_iter().for_each(|i| world.remove_field(fields[i]).expect("it is there"));
        world.state_hash()
    };
    assert_ne!(make([0, 1]), make([1, 0]), "the same for fields");
}

struct Push1(u64, u32);

impl CustomForce for Push1 {
    fn id(&self) -> u64 {
        self.0
    }
    fn version(&self) -> u32 {
        self.1
    }
    fn depends_on(&self) -> Dependence {
        Dependence::Nothing
    }
    fn push(&self, _: &BodyState) -> Result<ForceTorque, CustomForceError> {
        Ok(ForceTorque::default())
    }
}

#[test]
fn equal_worlds_hash_alike_and_any_single_difference_shows() {
    type Change = (&'static str, fn(&mut World, BodyId, FieldId));
    const FIRST: BodyId = BodyId::from_parts(0, 0);
    const OTHER: End = End::Body(Attachment { body: FIRST, point: Vec2::ZERO });
    const SPRING: SpringConstants<Fx> = SpringConstants { rest: fx!(1), stiffness: fx!(2), damping: fx!(0.5) };
    fn law(world: &mut World, field: FieldId, law: FieldKind) {
        world.set_field(field, law).expect("a field");
    }
    let make = |def: WorldDef, body: BodyDef| {
        let mut world = World::new(def).expect("a world");
        let anchor = world.add_body(BodyDef::dynamic()).expect("a body");
        let body = world.add_body(body).expect("a body");
        let far = End::Body(Attachment::centre(anchor));
        let law = FieldKind::Spring { near: Attachment::centre(body), far, spring: SPRING };
        let field = world.add_field(law).expect("a field");
        (world, body, field)
    };
    fn own(world: &World, body: BodyId) -> ColliderId {
        world.colliders_of(body).unwrap().next().unwrap()
    }
    fn reshape(world: &mut World, body: BodyId, shape: Result<Shape, Error>) {
        world.set_collider(own(world, body), ColliderDef::ghost(shape.unwrap())).unwrap();
    }
    let plain = BodyDef {
        mass: Mass::Kilograms(fx!(1)),
        ..BodyDef::dynamic().with_collider(ColliderDef::ghost(Shape::circle(fx!(1)).expect("a disc")))
    };
    let changes: &[Change] = &[
        ("nothing", |_, _, _| {}),
        ("add_body", |w, _, _| w.add_body(BodyDef::dynamic()).map(drop).unwrap()),
        ("remove_body", |w, b, _| w.remove_body(b).unwrap()),
        ("add and remove", |w, _, _| {
            let body = w.add_body(BodyDef::dynamic()).unwrap();
            w.remove_body(body).unwrap();
        }),
        ("force", |w, b, _| w.apply_force(b, Vec2::X).unwrap()),
        ("force y", |w, b, _| w.apply_force(b, Vec2::Y).unwrap()),
        ("force at a point", |w, b, _| w.apply_force_at_point(b, Vec2::X, Vec2::Y).unwrap()),
        ("force to overflow", |w, b, _| (0..6).for_each(|_| w.apply_force(b, vec2(Fx::MAX, 0)).unwrap())),
        ("torque", |w, b, _| w.apply_torque(b, Fx::ONE).unwrap()),
        ("impulse", |w, b, _| w.apply_impulse(b, Vec2::X).unwrap()),
        ("angular impulse", |w, b, _| w.apply_angular_impulse(b, Fx::DELTA).unwrap()),
        ("position x", |w, b, _| w.set_position(b, Vec2::new(Fx::DELTA, Fx::ZERO)).unwrap()),
        ("position y", |w, b, _| w.set_position(b, Vec2::new(Fx::ZERO, Fx::DELTA)).unwrap()),
        ("angle", |w, b, _| w.set_angle(b, Fx::DELTA).unwrap()),
        ("velocity x", |w, b, _| w.set_velocity(b, Vec2::new(Fx::DELTA, Fx::ZERO)).unwrap()),
        ("velocity y", |w, b, _| w.set_velocity(b, Vec2::new(Fx::ZERO, Fx::DELTA)).unwrap()),
        ("spin", |w, b, _| w.set_angular_velocity(b, -Fx::DELTA).unwrap()),
        ("mass", |w, b, _| w.set_mass(b, Mass::Kilograms(fx!(2))).unwrap()),
        ("mass by colliders", |w, b, _| w.set_mass(b, Mass::FromColliders).unwrap()),
        ("mass and inertia", |w, b, _| w.set_mass(b, Mass::Explicit { mass: fx!(1), inertia: fx!(1) }).unwrap()),
        ("mass and another inertia", |w, b, _| {
            w.set_mass(b, Mass::Explicit { mass: fx!(1), inertia: fx!(2) }).unwrap()
        }),
        ("no collider", |w, b, _| w.remove_collider(own(w, b)).unwrap()),
        ("circle", |w, b, _| reshape(w, b, Shape::circle(fx!(2)))),
        ("rectangle", |w, b, _| reshape(w, b, Shape::rectangle(fx!(1), fx!(2)))),
        ("another rectangle", |w, b, _| reshape(w, b, Shape::rectangle(fx!(2), fx!(1)))),
        ("capsule", |w, b, _| reshape(w, b, Shape::capsule(fx!(1), fx!(2)))),
        ("segment", |w, b, _| reshape(w, b, Shape::segment(Vec2::ZERO, Vec2::X))),
        ("shifted segment", |w, b, _| reshape(w, b, Shape::segment(vec2(fx!(1), 0), vec2(fx!(2), 0)))),
        ("polygon", |w, b, _| reshape(w, b, Shape::polygon(&[Vec2::ZERO, Vec2::X, Vec2::Y]))),
        ("static", |w, b, _| {
            w.set_kind(b, BodyKind::Static).unwrap();
        }),
        ("kinematic", |w, b, _| w.set_kind(b, BodyKind::Kinematic).unwrap()),
        ("gravity scale", |w, b, _| w.set_gravity_scale(b, fx!(2)).unwrap()),
        ("own damping", |w, b, _| w.set_body_damping(b, Some(Damping::NONE), None).unwrap()),
        ("own angular damping", |w, b, _| w.set_body_damping(b, None, Some(Damping::NONE)).unwrap()),
        ("groups", |w, b, _| w.set_force_groups(b, 2).unwrap()),
        ("key", |w, b, _| w.set_key(b, 1).unwrap()),
        ("user data", |w, b, _| w.set_user_data(b, 1).unwrap()),
        ("remove_field", |w, _, f| w.remove_field(f).unwrap()),
        ("groups of a field", |w, _, f| {
            let field = *w.field(f).unwrap();
            w.set_field(f, ForceField { force_groups: 3, ..field }).unwrap();
        }),
        ("rest", |w, b, f| {
            law(
                w,
                f,
                FieldKind::Spring {
                    near: Attachment::centre(b),
                    far: OTHER,
                    spring: SpringConstants { rest: fx!(2), ..SPRING },
                },
            )
        }),
        ("stiffness", |w, b, f| {
            law(
                w,
                f,
                FieldKind::Spring {
                    near: Attachment::centre(b),
                    far: OTHER,
                    spring: SpringConstants { stiffness: fx!(1), ..SPRING },
                },
            )
        }),
        ("damper", |w, b, f| {
            law(
                w,
                f,
                FieldKind::Spring {
                    near: Attachment::centre(b),
                    far: OTHER,
                    spring: SpringConstants { damping: fx!(1), ..SPRING },
                },
            )
        }),
        ("other way round", |w, b, f| {
            law(
                w,
                f,
                FieldKind::Spring {
                    near: Attachment::centre(FIRST),
                    far: End::Body(Attachment::centre(b)),
                    spring: SPRING,
                },
            )
        }),
        ("attachment", |w, b, f| {
            law(w, f, FieldKind::Spring { near: Attachment { body: b, point: Vec2::X }, far: OTHER, spring: SPRING })
        }),
        ("anchor", |w, b, f| {
            law(w, f, FieldKind::Spring { near: Attachment::centre(b), far: End::World(Vec2::ZERO), spring: SPRING })
        }),
        ("another anchor", |w, b, f| {
            law(w, f, FieldKind::Spring { near: Attachment::centre(b), far: End::World(Vec2::Y), spring: SPRING })
        }),
        ("drag", |w, _, f| law(w, f, FieldKind::Drag { linear: fx!(1), quadratic: fx!(0), wind: Vec2::ZERO })),
        ("quadratic drag", |w, _, f| {
            law(w, f, FieldKind::Drag { linear: fx!(0), quadratic: fx!(1), wind: Vec2::ZERO })
        }),
        ("wind", |w, _, f| law(w, f, FieldKind::Drag { linear: fx!(1), quadratic: fx!(0), wind: Vec2::X })),
        ("thrust", |w, b, f| law(w, f, FieldKind::Thrust { at: Attachment::centre(b), force: Vec2::X })),
        ("thrust elsewhere", |w, b, f| {
            law(w, f, FieldKind::Thrust { at: Attachment { body: b, point: Vec2::Y }, force: Vec2::X })
        }),
        ("more thrust", |w, b, f| law(w, f, FieldKind::Thrust { at: Attachment::centre(b), force: vec2(2, 0) })),
        ("attractor", |w, _, f| {
            law(w, f, FieldKind::Attractor { centre: End::World(Vec2::ZERO), mu: mu(fx!(1)), softening: fx!(0) })
        }),
        ("mu", |w, _, f| {
            law(w, f, FieldKind::Attractor { centre: End::World(Vec2::ZERO), mu: mu(fx!(2)), softening: fx!(0) })
        }),
        ("softening", |w, _, f| {
            law(w, f, FieldKind::Attractor { centre: End::World(Vec2::ZERO), mu: mu(fx!(1)), softening: fx!(1) })
        }),
        ("centre", |w, _, f| {
            law(w, f, FieldKind::Attractor { centre: End::World(Vec2::X), mu: mu(fx!(1)), softening: fx!(0) })
        }),
        ("carried", |w, b, f| {
            law(
                w,
                f,
                FieldKind::Attractor { centre: End::Body(Attachment::centre(b)), mu: mu(fx!(1)), softening: fx!(0) },
            )
        }),
        ("disc", |w, _, f| {
            law(
                w,
                f,
                FieldKind::Zone { region: Region::Disc { centre: Vec2::ZERO, radius: fx!(1) }, acceleration: Vec2::X },
            )
        }),
        ("larger disc", |w, _, f| {
            law(
                w,
                f,
                FieldKind::Zone { region: Region::Disc { centre: Vec2::ZERO, radius: fx!(2) }, acceleration: Vec2::X },
            )
        }),
        ("acceleration", |w, _, f| {
            law(
                w,
                f,
                FieldKind::Zone { region: Region::Disc { centre: Vec2::ZERO, radius: fx!(1) }, acceleration: Vec2::Y },
            )
        }),
        ("box", |w, _, f| {
            law(w, f, FieldKind::Zone { region: Region::Box { min: Vec2::ZERO, max: Vec2::X }, acceleration: Vec2::X })
        }),
        ("larger box", |w, _, f| {
            law(
                w,
                f,
                FieldKind::Zone { region: Region::Box { min: Vec2::ZERO, max: vec2(2, 0) }, acceleration: Vec2::X },
            )
        }),
        ("law", |w, _, _| w.register_custom_force(Arc::new(Push1(1, 1))).unwrap()),
        ("version of a law", |w, _, _| w.register_custom_force(Arc::new(Push1(1, 2))).unwrap()),
        ("another law", |w, _, _| w.register_custom_force(Arc::new(Push1(2, 1))).unwrap()),
        ("field of a law", |w, _, f| {
            w.register_custom_force(Arc::new(Push1(2, 1))).unwrap();
            law(w, f, FieldKind::Custom { id: 2 });
        }),
        ("time step", |w, _, _| w.set_time_step(TimeStep::hz(61)).unwrap()),
        ("gravity x", |w, _, _| w.set_gravity(Vec2::X).unwrap()),
        ("gravity y", |w, _, _| w.set_gravity(Vec2::Y).unwrap()),
        ("explicit Euler", |w, _, _| w.set_integrator(Integrator::ExplicitEuler).unwrap()),
        ("symplectic Euler", |w, _, _| w.set_integrator(Integrator::SymplecticEuler).unwrap()),
        ("published", |w, _, _| w.set_integrator(Integrator::PublishedVerlet).unwrap()),
        ("Yoshida", |w, _, _| w.set_integrator(Integrator::Yoshida4).unwrap()),
        ("damping", |w, _, _| w.set_damping(Damping::kept_per_second(fx!(0.5)), Damping::NONE).unwrap()),
        ("angular damping", |w, _, _| w.set_damping(Damping::NONE, Damping::kept_per_second(fx!(0.5))).unwrap()),
        ("never sleeps", |w, _, _| w.set_sleep_after(None).unwrap()),
        ("sleeps later", |w, _, _| w.set_sleep_after(Some(31)).unwrap()),
        ("a step", |w, _, _| {
            w.step();
        }),
    ];
    let mut known: Vec<(u64, String)> = Vec::new();
    let mut note = |hash: u64, name: String| {
        if let Some((_, same)) = known.iter().find(|(h, _)| *h == hash) {
            panic!("`{name}` and `{same}` hash alike");
        }
        known.push((hash, name));
    };
    for (name, change) in changes {
        let hashes = [0, 1].map(|_| {
            let (mut world, body, field) = make(WorldDef::default(), plain.clone());
            change(&mut world, body, field);
            world.state_hash()
        });
        assert_eq!(hashes[0], hashes[1], "{name}: equal worlds");
        note(hashes[0], (*name).to_owned());
    }
    // The definition of a body: what its setters set is the same state.
    let defs: [(&str, BodyDef); 5] = [
        ("defined position", BodyDef { position: vec2(fx!(7), 0), ..plain.clone() }),
        ("defined angle", BodyDef { angle: fx!(1), ..plain.clone() }),
        ("defined velocity", BodyDef { velocity: vec2(fx!(7), 0), ..plain.clone() }),
        ("defined kind", BodyDef { kind: BodyKind::Kinematic, key: 8, ..plain.clone() }),
        ("defined user data", BodyDef { user_data: 9, ..plain.clone() }),
    ];
    for (name, def) in defs {
        let (world, ..) = make(WorldDef::default(), def);
        note(world.state_hash(), name.to_owned());
    }
    let (mut set, body, _) = make(WorldDef::default(), plain.clone());
    set.set_position(body, vec2(fx!(7), 0)).unwrap();
    let (defined, ..) = make(WorldDef::default(), BodyDef { position: vec2(fx!(7), 0), ..plain });
    assert_eq!(set.state_hash(), defined.state_hash(), "how a state came to be is not in it");
}

#[test]
fn a_body_asleep_and_one_about_to_be_are_told_apart() {
    let mut world = World::new(WorldDef { sleep_after: Some(3), ..WorldDef::default() }).expect("a world");
    let body = world.add_body(BodyDef::dynamic()).expect("a body");
    let mut hashes = vec![world.state_hash()];
    for _ in 0..4 {
        world.step();
        hashes.push(world.state_hash());
    }
    assert_eq!(world.body(body).unwrap().activity(), Activity::Asleep);
    hashes.sort_unstable();
    hashes.dedup();
    assert_eq!(hashes.len(), 5, "the ticks at rest are state: when it falls asleep depends on them");
    let before = world.state_hash();
    world.wake(body).unwrap();
    assert_ne!(world.state_hash(), before);
}

/// Values of a body in a preview and in the world.
#[track_caller]
fn assert_foreseen(world: &World, body: BodyId, ticks: u32) -> usize {
    let mut ahead = world.preview(body).expect("it is there");
    let taken = ahead.world().body_count();
    let mut world = world.clone();
    for tick in 0..ticks {
        ahead.step();
        world.step();
        let twin = ahead.id();
        let (actual, expected) = (bits(ahead.world(), twin), bits(&world, body));
        assert_eq!(actual, expected, "{body}, {:?}, tick {tick}", world.def().integrator);
    }
    taken
}

#[test]
fn looking_ahead_with_one_body_is_its_future() {
    for integrator in Integrator::ALL {
        let mut dice = Dice(0x5eed_0a11);
        let mut world = World::new(world_def(integrator)).expect("a fair definition");
        let body = |dice: &mut Dice, force_groups| BodyDef {
            position: dice.vector(fx!(20)),
            velocity: dice.vector(fx!(3)),
            angular_velocity: dice.number(fx!(2)),
            mass: Mass::Explicit { mass: fx!(2), inertia: fx!(0.5) },
            force_groups,
            ..BodyDef::dynamic()
        };
        let bystanders: Vec<_> = (0..150).map(|_| world.add_body(body(&mut dice, 1)).expect("fair")).collect();
        let chain: Vec<_> = (0..6).map(|_| world.add_body(body(&mut dice, 2)).expect("fair")).collect();
        let suns: Vec<_> = (0..2).map(|_| world.add_body(body(&mut dice, 4)).expect("fair")).collect();
        let anchor = world.add_body(BodyDef { position: vec2(1, 2), ..BodyDef::fixed() }).expect("fair");
        world.remove_body(bystanders[17]).expect("it is there");
        let links = chain.windows(2).map(|pair| {
            let far = End::Body(Attachment::centre(pair[1]));
            spring(pair[0], vec2(fx!(0.25), fx!(-0.5)), far, fx!(2), fx!(15), fx!(0.5))
        });
        let mut custom_forces: Vec<ForceField> = links.map(ForceField::from).collect();
        let tied = spring(chain[5], vec2(0, 0), End::Body(Attachment::centre(anchor)), fx!(1), fx!(10), fx!(0));
        custom_forces.push(tied.into());
        // The chain feels a sun, which feels the other one; the bystanders feel drag, and so does the chain.
        let attractor = |sun| FieldKind::Attractor {
            centre: End::Body(Attachment::centre(sun)),
            mu: mu(fx!(50)),
            softening: fx!(1),
        };
        custom_forces.push(ForceField { kind: attractor(suns[0]), force_groups: 2 });
        custom_forces.push(ForceField { kind: attractor(suns[1]), force_groups: 4 });
        custom_forces.push(ForceField {
            kind: FieldKind::Drag { linear: fx!(0.25), quadratic: fx!(0.125), wind: vec2(1, 0) },
            force_groups: 3,
        });
        custom_forces.push(ForceField {
            kind: FieldKind::Drag { linear: fx!(0.5), quadratic: fx!(0), wind: vec2(0, 1) },
            force_groups: 2,
        });
        let at = Attachment { body: chain[0], point: vec2(0, 1) };
        custom_forces.push(FieldKind::Thrust { at, force: vec2(3, 0) }.into());
        // Tied to the same anchor, and no company for that: the anchor never moves.
        custom_forces.push(
            spring(bystanders[3], vec2(0, 0), End::Body(Attachment::centre(anchor)), fx!(1), fx!(2), fx!(0)).into(),
        );
        for law in custom_forces {
            world.add_field(law).expect("a fair field");
        }
        for _ in 0..5 {
            world.step();
        }
        world.apply_force(chain[2], vec2(7, -3)).expect("a fair force");
        world.apply_torque(suns[0], fx!(2)).expect("a fair torque");
        // The chain, its anchor, and both suns.
        assert_eq!(assert_foreseen(&world, chain[3], 100), 9);
        assert_eq!(assert_foreseen(&world, suns[0], 100), 2);
        // Nothing acts on the second.
        assert_eq!(assert_foreseen(&world, suns[1], 100), 1);
        assert_eq!(assert_foreseen(&world, bystanders[40], 100), 1);
        assert_eq!(assert_foreseen(&world, bystanders[3], 100), 2);
    }
}
