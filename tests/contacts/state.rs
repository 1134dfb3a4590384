//! The state of contacts: snapshots, changes between steps, faults.

use super::scenes::{def, ground, material, pyramid, square, world};
use crate::seeds::is_short;
use umbra_physics::{
    Activity, BodyDef, BodyId, Cause, ColliderDef, ColliderId, ContactSettings, Error, FxAccumulator, Irreversible,
    Quantity, Shape, Snapshot, TimeStep, Vec2, World, WorldDef, fx, vec2,
};

#[test]
fn a_restored_pile_goes_on_with_the_same_bits() {
    let (mut world, _) = world(def(), pyramid(8).expect("a pyramid")).expect("a scene");
    world.set_velocity(world.bodies().last().expect("a body").id(), vec2(5, 3)).expect("a velocity");
    let mut fresh = world.clone();
    for step in 0..200 {
        world.step();
        // From bytes, in each step: nothing is cached.
        fresh.step();
        let bytes = fresh.snapshot().to_bytes();
        fresh = Snapshot::from_bytes(&bytes, &[]).expect("its own bytes").into_world();
        assert_eq!(fresh.state_hash(), world.state_hash(), "{step}");
        assert!(fresh.contacts().eq(world.contacts()));
    }
    assert!(world.contacts().count() > 30);
}

#[test]
fn a_step_with_impulses_cannot_be_undone_and_one_in_flight_can() {
    let ball =
        BodyDef { position: vec2(0, 3), ..BodyDef::dynamic().with_collider(Shape::circle(fx!(0.5)).expect("a disc")) };
    let mut ground = ground().expect("a ground");
    ground.colliders[0].material = material(fx!(0.6), fx!(0.9));
    let (mut world, _) = world(def(), [ground, ball]).expect("a scene");
    let (mut undone, mut refused) = (0, 0);
    for _ in 0..120 {
        let before = world.state_hash();
        world.step();
        let mut back = world.clone();
        match back.step_back(&[]) {
            Ok(()) => {
                assert_eq!(back.state_hash(), before);
                undone += 1;
            }
            Err(error) => {
                assert_eq!(error, Error::NotReversible { why: Irreversible::Contact });
                refused += 1;
            }
        }
    }
    assert!(undone > 90 && refused > 1, "{undone} {refused}");
}

#[test]
fn more_pairs_than_allowed_are_a_fault_and_the_rest_goes_on() {
    let contacts = ContactSettings { max_pairs: 60, max_pairs_per_collider: 8, ..ContactSettings::default() };
    let crowd = (0..40).map(|i| square(vec2(50, 50), i).expect("a square"));
    let mut bodies: Vec<BodyDef> = vec![ground().expect("a ground"), square(vec2(0, fx!(0.5)), 99).expect("a square")];
    bodies.extend(crowd);
    let (mut world, ids) = world(WorldDef { contacts, ..def() }, bodies).expect("a scene");
    let report = world.step();
    assert_eq!(report.faults.len(), 40);
    assert!(report.faults.iter().all(|fault| fault.cause == Cause::Pairs));
    (0..60).for_each(|_| assert!(world.step().faults.is_empty()));
    assert!((world.body(ids[1]).expect("it").position().y - fx!(0.5)).abs() < fx!(0.001));
    assert_eq!(world.body(ids[5]).expect("it").position(), vec2(50, 50));
}

#[test]
fn sleepers_with_too_many_pairs_are_at_fault_as_if_they_were_awake() {
    // Discs near each other that exchange no impulses, and fall asleep.
    let disc = |i: i32| BodyDef {
        position: Vec2::new(umbra_physics::Fx::from_ratio((i % 6).into(), 1) * fx!(1.01), fx!(1.01) * (i / 6)),
        key: i as u64,
        ..BodyDef::dynamic().with_collider(Shape::circle(fx!(0.5)).expect("a disc"))
    };
    let run = |sleep_after| {
        let def = WorldDef { gravity: vec2(0, 0), sleep_after, ..def() };
        let (mut world, _) = world(def, (0..36).map(disc)).expect("a scene");
        (0..10).for_each(|_| assert!(world.step().faults.is_empty()));
        let asleep = world.bodies().filter(|body| body.activity() == umbra_physics::Activity::Asleep).count();
        let contacts = ContactSettings { max_pairs: 30, max_pairs_per_collider: 4, ..ContactSettings::default() };
        world.set_contact_settings(contacts).expect("settings");
        let faults: Vec<_> = world.step().faults.iter().map(|fault| (fault.body, fault.cause)).collect();
        let bits: Vec<_> = world.bodies().map(|body| (body.position_exact(), body.velocity_exact())).collect();
        (asleep, faults, bits)
    };
    let (asleep, faults, bits) = run(Some(2));
    let (awake, others, same) = run(None);
    assert_eq!((asleep, awake), (36, 0));
    assert!(!faults.is_empty() && faults.len() < 36, "{}", faults.len());
    assert_eq!((faults, bits), (others, same));
}

#[test]
fn many_bodies_in_one_point_are_pushed_apart_at_a_bounded_speed() {
    let bodies = (0..if is_short() { 300 } else { 1_000 }).map(|i| BodyDef {
        position: Vec2::new(umbra_physics::Fx::from_bits(i % 31), umbra_physics::Fx::from_bits(i / 31)),
        ..square(vec2(0, 0), i as u64).expect("a square")
    });
    let (mut world, _) = world(WorldDef { gravity: vec2(0, 0), ..def() }, bodies).expect("a scene");
    let mut fastest = fx!(0);
    for _ in 0..20 {
        assert!(world.step().faults.is_empty());
        fastest = world.bodies().map(|body| body.velocity().length()).fold(fastest, umbra_physics::Fx::max);
    }
    assert!(fastest < fx!(200), "{fastest}");
}

#[test]
fn colliders_and_bodies_that_go_leave_no_impulses() {
    let stack: Vec<BodyDef> = [ground().expect("a ground")]
        .into_iter()
        .chain((0..3).map(|row| square(Vec2::new(fx!(0), fx!(0.5) + row.into()), row as u64).expect("a square")))
        .collect();
    let (mut world, ids) = world(def(), stack).expect("a scene");
    (0..60).for_each(|_| _ = world.step());
    assert_eq!(world.contacts().count(), 3);
    let middle = world.colliders_of(ids[2]).expect("it").next().expect("a collider");
    world.set_collider(middle, Shape::circle(fx!(0.5)).expect("a disc")).expect("a collider");
    assert_eq!(world.contacts().count(), 1);
    world.step();
    assert_eq!(world.contacts().count(), 3);
    world.remove_body(ids[3]).expect("it");
    assert_eq!(world.contacts().count(), 2);
    assert_eq!(world.collider_count(), 3);
    world.remove_collider(middle).expect("it");
    assert_eq!(world.contacts().count(), 1);
    // A new collider in the slot of the old one starts without impulses.
    let added = world.add_collider(ids[2], Shape::rectangle(fx!(1), fx!(1)).expect("a square")).expect("it");
    assert_eq!((added.parts().0, world.contacts_of(ids[2]).expect("it").count()), (middle.parts().0, 0));
    (0..60).for_each(|_| _ = world.step());
    assert!((world.body(ids[2]).expect("it").position().y - fx!(1.5)).abs() < fx!(0.01));
}

#[test]
fn a_change_of_the_time_step_keeps_forces() {
    let stack = (0..10).map(|row| square(Vec2::new(fx!(0), fx!(0.5) + row.into()), row as u64).expect("a square"));
    let (mut world, ids) = world(def(), [ground().expect("a ground")].into_iter().chain(stack)).expect("a scene");
    (0..300).for_each(|_| _ = world.step());
    // The impulse that carries all ten squares of 1 kg for a sub-step.
    let carries = |world: &umbra_physics::World, hz: i64| {
        let ground = world.contacts_of(ids[0]).expect("it").next().expect("a contact");
        let impulse = ground.points().iter().fold(fx!(0), |sum, point| sum + point.normal_impulse);
        let weight = umbra_physics::Fx::from_ratio(100, 5 * hz);
        (impulse - weight).abs() < weight * fx!(0.001)
    };
    let mut hz = 60;
    assert!(carries(&world, hz));
    for next in [240, 60, 30, 1_000, 60] {
        world.set_time_step(TimeStep::hz(next)).expect("a time step");
        hz = next.into();
        assert!(carries(&world, hz), "{hz}");
    }
    // A sub-step of half the length.
    world.set_contact_settings(ContactSettings { substeps: 8, ..ContactSettings::default() }).expect("settings");
    assert!(carries(&world, hz * 8 / 5));
    (0..60).for_each(|_| _ = world.step());
    assert!(carries(&world, hz * 8 / 5));
}

/// All quantities of each body that a step changes.
fn bits(world: &World, ids: &[BodyId]) -> Vec<([i128; 5], u64)> {
    let bits_of = |&id: &BodyId| {
        let body = world.body(id).expect("it is there");
        let (x, v) = (body.position_exact(), body.velocity_exact());
        ([x.x, x.y, v.x, v.y, body.angular_velocity_exact()].map(FxAccumulator::to_bits), body.angle_exact().to_bits())
    };
    ids.iter().map(bits_of).collect()
}

#[test]
fn bodies_with_too_many_pairs_stay_as_they_were_and_change_no_bit_of_the_others() {
    let contacts = ContactSettings { max_pairs: 60, max_pairs_per_collider: 8, ..ContactSettings::default() };
    let def = WorldDef { contacts, ..def() };
    let pile = || pyramid(3).expect("a pyramid");
    let moving = |i: i32| BodyDef { velocity: vec2(i, -i), ..square(vec2(50, 50), i as u64).expect("a square") };
    let crowd: Vec<BodyDef> = (0..40).map(moving).collect();
    let (mut alone, _) = world(def, pile()).expect("a scene");
    let (mut crowded, ids) = world(def, pile().into_iter().chain(crowd)).expect("a scene");
    let (others, crowd) = ids.split_at(7);
    let before = bits(&crowded, crowd);
    for step in 0..100 {
        alone.step();
        let report = crowded.step();
        assert_eq!(report.faults.len(), if step == 0 { 40 } else { 0 });
        assert!(report.faults.iter().zip(crowd).all(|(fault, id)| fault.cause == Cause::Pairs && fault.body == *id));
        assert_eq!(bits(&crowded, crowd), before);
        assert_eq!(bits(&crowded, others), bits(&alone, others));
    }
    for id in crowd {
        assert_eq!(crowded.body(*id).expect("it").activity(), Activity::Quarantined);
    }
    assert_eq!(crowded.contacts().count(), alone.contacts().count());
}

#[test]
fn sleeping_bodies_with_too_many_pairs_are_at_fault_as_if_awake() {
    let contacts = ContactSettings { max_pairs: 16, max_pairs_per_collider: 4, ..ContactSettings::default() };
    let at = |position: Vec2, velocity: Vec2, key| BodyDef {
        position,
        velocity,
        ..BodyDef { key, ..BodyDef::dynamic().with_collider(Shape::circle(fx!(0.5)).expect("a disc")) }
    };
    // One disc alone, and eight that come to it from all sides in the same step, so that it alone has too many pairs at first.
    let corners = [(0, 1), (0, -1), (1, 0), (-1, 0), (1, 1), (1, -1), (-1, 1), (-1, -1)];
    let mut bodies = vec![at(vec2(0, 0), vec2(0, 0), 0)];
    bodies.extend((1..).zip(corners).map(|(key, (x, y))| at(vec2(x, y) * fx!(6), vec2(-x, -y) * fx!(3), key)));
    bodies.extend(
        (0..20).map(|key| at(vec2(0, 0), vec2(0, 0), 9 + key)).map(|def| BodyDef { position: vec2(90, 0), ..def }),
    );
    let still = WorldDef { gravity: vec2(0, 0), contacts, ..def() };
    let (mut awake, ids) = world(still, bodies.clone()).expect("a scene");
    let (mut sleeping, _) = world(WorldDef { sleep_after: Some(5), ..still }, bodies).expect("a scene");
    for step in 0..200 {
        let faults = awake.step().faults.to_vec();
        assert_eq!(sleeping.step().faults, faults, "{step}");
        assert_eq!(bits(&sleeping, &ids), bits(&awake, &ids), "{step}");
    }
}

#[test]
fn invalid_definitions_are_refused_and_the_world_unchanged() {
    let (mut world, ids) = world(def(), pyramid(3).expect("a pyramid")).expect("a scene");
    (0..30).for_each(|_| _ = world.step());
    let collider = world.colliders_of(ids[3]).expect("it").next().expect("a collider");
    let good = ColliderDef::new(Shape::circle(fx!(1)).expect("a disc"));
    let out_of_range = |quantity| Error::OutOfRange { quantity };
    let bad = [
        (ColliderDef { material: material(fx!(-1), fx!(0)), ..good.clone() }, out_of_range(Quantity::Friction)),
        (ColliderDef { material: material(fx!(33), fx!(0)), ..good.clone() }, out_of_range(Quantity::Friction)),
        (ColliderDef { material: material(fx!(1), fx!(1.5)), ..good.clone() }, out_of_range(Quantity::Restitution)),
        (ColliderDef { material: material(fx!(1), fx!(-0.5)), ..good.clone() }, out_of_range(Quantity::Restitution)),
        (ColliderDef { density: fx!(-1), ..good.clone() }, out_of_range(Quantity::ColliderDensity { value: fx!(-1) })),
        (ColliderDef { position: vec2(5_000, 0), ..good.clone() }, out_of_range(Quantity::ColliderPosition)),
    ];
    let (before, contacts) = (world.state_hash(), (world.collider_count(), world.contacts().count()));
    for (def, error) in bad {
        assert_eq!(world.add_collider(ids[3], def.clone()), Err(error));
        assert_eq!(world.state_hash(), before, "{error}");
        assert_eq!(world.set_collider(collider, def.clone()), Err(error));
        assert_eq!(world.state_hash(), before, "{error}");
        assert_eq!(world.add_body(BodyDef { colliders: vec![good.clone(), def], ..BodyDef::dynamic() }), Err(error));
        assert_eq!(world.state_hash(), before, "{error}");
    }
    let nobody = umbra_physics::BodyId::from_parts(9, 0);
    assert_eq!(world.add_collider(nobody, good.clone()), Err(Error::NoSuchBody { body: nobody }));
    let none = umbra_physics::ColliderId::from_parts(collider.parts().0, collider.parts().1 + 1);
    assert_eq!(world.set_collider(none, good), Err(Error::NoSuchCollider { collider: none }));
    assert_eq!(world.remove_collider(none), Err(Error::NoSuchCollider { collider: none }));
    let slow = ContactSettings { push_speed: fx!(-1), ..ContactSettings::default() };
    assert_eq!(world.set_contact_settings(slow), Err(out_of_range(Quantity::ContactSpeed)));
    for (substeps, max_pairs, quantity) in
        [(0, 9, Quantity::Substeps), (17, 9, Quantity::Substeps), (5, 0, Quantity::Pairs)]
    {
        let settings = ContactSettings { substeps, max_pairs, ..ContactSettings::default() };
        assert_eq!(world.set_contact_settings(settings), Err(out_of_range(quantity)));
    }
    assert_eq!(world.state_hash(), before);
    assert_eq!((world.collider_count(), world.contacts().count()), contacts);
}

#[test]
fn colliders_that_are_gone_are_refused_and_the_world_unchanged() {
    let (mut world, ids) = world(def(), pyramid(3).expect("a pyramid")).expect("a scene");
    (0..30).for_each(|_| _ = world.step());
    let [body, partner] = [ids[6], ids[5]];
    let lost_collider = world.colliders_of(body).expect("it").next().expect("a collider");
    let lost = world.colliders_of(partner).expect("it").next().expect("a collider");
    let disc = || ColliderDef::new(Shape::circle(fx!(0.5)).expect("a disc"));
    world.remove_body(body).expect("it is there");
    world.remove_collider(lost).expect("it is there");
    let check = |world: &mut World| {
        let before = world.state_hash();
        assert_eq!(world.add_collider(body, disc()), Err(Error::NoSuchBody { body }));
        assert_eq!(world.colliders_of(body).err(), Some(Error::NoSuchBody { body }));
        for collider in [lost_collider, lost, ColliderId::from_parts(99, 0), ColliderId::from_parts(u32::MAX, u32::MAX)]
        {
            let gone = Error::NoSuchCollider { collider };
            assert_eq!(world.collider(collider).err(), Some(gone));
            assert_eq!(world.collider_body(collider), Err(gone));
            assert_eq!(world.set_collider(collider, disc()), Err(gone));
            assert_eq!(world.remove_collider(collider), Err(gone));
        }
        assert_eq!(world.state_hash(), before);
    };
    check(&mut world);
    // Their slots are taken again.
    let added = [ids[1], ids[2]].map(|body| world.add_collider(body, disc()).expect("it is there"));
    let slots = |colliders: [ColliderId; 2]| colliders.map(|collider| collider.parts().0);
    assert_eq!(slots(added), slots([lost, lost_collider]));
    world.add_body(BodyDef::dynamic()).expect("a body");
    check(&mut world);
    world.step();
    check(&mut world);
}

#[test]
fn colliders_of_one_key_hash_alike_in_either_order() {
    let bodies = || {
        let mut block = square(vec2(0, fx!(0.5)), 7).expect("a square");
        block.colliders[0].key = 0;
        block.angle = fx!(0.01);
        [ground().expect("a ground"), block]
    };
    let (mut first, _) = world(def(), bodies()).expect("a scene");
    let (mut second, _) = world(def(), bodies().into_iter().rev()).expect("a scene");
    let mut touched = 0;
    for step in 0..60 {
        first.step();
        second.step();
        touched += first.contacts().count();
        assert_eq!(first.physics_hash(), second.physics_hash(), "{step}");
    }
    assert!(touched > 30, "{touched}");
}
