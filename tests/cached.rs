//! A step keeps for the next one what still holds, and drops what belongs to bodies that changed. Whether something was kept
//! must not show: a world is stepped beside one that forgets everything before each step.

use std::sync::Arc;

use umbra_physics::{
    Attachment, BodyDef, BodyId, BodyKind, BodyState, ColliderDef, CustomForce, CustomForceError, Damping, Dependence,
    End, Error, FieldId, FieldKind, ForceField, ForceTorque, Fx, FxFactor, Integrator, Locks, Mass, Region, Shape,
    Snapshot, SpringConstants, TimeStep, Vec2, World, WorldDef, fx, vec2,
};

#[path = "support/inputs.rs"]
#[allow(dead_code, reason = "this file uses a part of the inputs")]
mod inputs;

use inputs::Random;

const COUNT: usize = 300;
fn ticks() -> u32 {
    crate::seeds::times(20)
}

fn number(random: &mut Random, bits: u32) -> Fx {
    Fx::from_bits(random.next() >> (64 - bits))
}

fn vector(random: &mut Random, bits: u32) -> Vec2 {
    Vec2::new(number(random, bits), number(random, bits))
}

fn below(random: &mut Random, count: usize) -> usize {
    random.next().unsigned_abs() as usize % count
}

/// A world of bodies at rest, every third in a group of its own, one in ten of another kind.
fn world(integrator: Integrator) -> (World, Vec<BodyId>) {
    let def = WorldDef { integrator, sleep_after: Some(4), ..WorldDef::default() };
    let mut world = World::new(def).expect("a fair definition");
    let mut random = Random::seeded(5);
    let bodies = (0..COUNT).map(|i| {
        let def = BodyDef {
            position: vector(&mut random, 38),
            force_groups: if i % 3 == 0 { 2 } else { 1 },
            mass: Mass::Explicit { mass: fx!(2), inertia: fx!(0.5) },
            kind: match i % 20 {
                7 => BodyKind::Static,
                13 => BodyKind::Kinematic,
                _ => BodyKind::Dynamic,
            },
            ..BodyDef::dynamic()
        };
        world.add_body(def).expect("a fair body")
    });
    let bodies = bodies.collect();
    (world, bodies)
}

/// A field. Where every step can be undone, none depends on velocities.
fn field(random: &mut Random, bodies: &[BodyId], is_reversible: bool) -> ForceField {
    let [near, far] = [(); 2]
        .map(|()| Attachment { point: vector(random, 33), ..Attachment::centre(bodies[below(random, bodies.len())]) });
    let damping = if is_reversible { Fx::ZERO } else { Fx::from(below(random, 2) as i32) };
    let spring = SpringConstants { rest: fx!(1), stiffness: fx!(3), damping };
    let force_groups = [0, 2, 4, u32::MAX][below(random, 4)];
    let kind = match below(random, 14) {
        0 => FieldKind::Attractor { centre: End::Body(near), mu: FxFactor::from_ratio(20, 1), softening: fx!(1) },
        1 if !is_reversible => FieldKind::Drag { linear: fx!(0.5), quadratic: fx!(0.25), wind: vec2(1, 0) },
        2 => {
            let region = Region::Disc { centre: vector(random, 38), radius: fx!(20) };
            FieldKind::Zone { region, acceleration: vec2(1, 2) }
        }
        3..6 => FieldKind::Thrust { at: near, force: vec2(1, 2) },
        6..8 => FieldKind::Custom { id: Charge.id() },
        _ => FieldKind::Spring { near, far: End::Body(far), spring },
    };
    ForceField { kind, force_groups }
}

/// A custom force of position that reads the user data.
struct Charge;

impl CustomForce for Charge {
    fn id(&self) -> u64 {
        3
    }

    fn version(&self) -> u32 {
        1
    }

    fn depends_on(&self) -> Dependence {
        Dependence::Position
    }

    fn push(&self, body: &BodyState) -> Result<ForceTorque, CustomForceError> {
        let charge = Fx::from(body.user_data as u8);
        let force = body.position.checked_scale(-charge).ok_or(CustomForceError { code: 1 })?;
        Ok(ForceTorque { force, torque: charge })
    }
}

fn custom_forces() -> [Arc<dyn CustomForce>; 1] {
    [Arc::new(Charge)]
}

/// A step, and then the step back.
fn there_and_back(world: &mut World) -> Result<(), Error> {
    let applied = world.step().applied.to_vec();
    world.step_back(&applied)
}

/// A step from a snapshot, and then the snapshot again.
fn there_and_restored(world: &mut World) {
    let saved = world.snapshot();
    world.step();
    world.restore(&saved);
}

/// The things in a world, and whether every step of it can be undone.
struct Scene {
    bodies: Vec<BodyId>,
    fields: Vec<FieldId>,
    is_reversible: bool,
}

/// One call or another, some of which are refused.
fn change(world: &mut World, random: &mut Random, scene: &mut Scene) {
    let Scene { bodies, fields, is_reversible } = scene;
    let body = bodies[below(random, bodies.len())];
    let vector = vector(random, 34);
    let one_of = below(random, 3);
    _ = match below(random, if *is_reversible { 28 } else { 36 }) {
        0 => world.set_position(body, vector),
        1 => world.set_angle(body, vector.x),
        2 => world.set_velocity(body, vector),
        3 => world.set_force_groups(body, 1 << one_of),
        4 => world.set_mass(body, Mass::Explicit { mass: fx!(3), inertia: fx!(2) }),
        5 => world.set_kind(body, [BodyKind::Static, BodyKind::Kinematic, BodyKind::Dynamic][one_of]),
        6 => world.disable(body),
        7 => world.enable(body),
        8 => world.wake(body),
        9 => world.apply_force(body, vector),
        10 => world.apply_impulse(body, vector),
        11 => world.remove_body(body).map(|()| bodies.retain(|&candidate| candidate != body)),
        12 => world.add_body(BodyDef { position: vector, ..BodyDef::dynamic() }).map(|body| bodies.push(body)),
        13..16 => world.add_field(field(random, bodies, *is_reversible)).map(|field| fields.push(field)),
        16 | 17 if !fields.is_empty() => world.remove_field(fields.swap_remove(below(random, fields.len()))),
        18 if !fields.is_empty() => {
            world.set_field(fields[below(random, fields.len())], field(random, bodies, *is_reversible))
        }
        19 | 20 => world.set_user_data(body, below(random, 5) as u64),
        21 => world.set_gravity_scale(body, [fx!(0), fx!(1), fx!(-2)][one_of]),
        22 => {
            let shapes = [Shape::circle(fx!(0.5)), Shape::rectangle(fx!(1), fx!(3))];
            let collider = world.colliders_of(body).into_iter().flatten().next();
            match (one_of, collider) {
                (2, Some(collider)) => world.remove_collider(collider),
                (2, None) => Ok(()),
                _ => shapes[one_of]
                    .clone()
                    .and_then(|shape| world.add_collider(body, ColliderDef::ghost(shape)).map(drop)),
            }
        }
        23 => world.set_locks(body, Locks { x: one_of == 0, y: one_of == 1, rotation: one_of != 2 }),
        24 => world.set_gravity(vec2(0, [0, 0, -1][one_of])),
        25 => there_and_back(world),
        26 => {
            there_and_restored(world);
            Ok(())
        }
        28 => world.move_to(body, vector, fx!(1)),
        29 => world.release(body),
        30 => world.set_body_damping(
            body,
            [None, Some(fx!(0.5)), Some(fx!(1))][one_of].map(Damping::kept_per_second),
            None,
        ),
        31 => world.set_max_speeds(body, [None, Some(fx!(2)), Some(fx!(5))][one_of], None),
        32 => world.set_damping(
            [fx!(1), fx!(0.75), fx!(0.5)].map(Damping::kept_per_second)[one_of],
            Damping::kept_per_second(fx!(0.75)),
        ),
        33 => world.set_time_step(TimeStep::hz([50, 60, 100][one_of])),
        34 => world.set_integrator(Integrator::ALL[below(random, Integrator::ALL.len())]),
        35 => world.sleep(body),
        _ => Ok(()),
    };
}

/// A world as a file has it: its bodies came in another order, and it has never taken a step.
fn forgetful(world: &World) -> World {
    let bytes = world.snapshot().to_bytes();
    Snapshot::from_bytes(&bytes, &custom_forces()).expect("it was written just now").into_world()
}

#[test]
fn values_cached_between_steps_change_no_result() {
    let (mut slept, mut moved, mut undone) = (0, 0, 0);
    for (integrator, is_reversible) in
        Integrator::ALL.into_iter().flat_map(|integrator| [(integrator, false), (integrator, true)])
    {
        let mut random = Random::seeded(3);
        let (mut world, bodies) = world(integrator);
        custom_forces().into_iter().for_each(|force| world.register_custom_force(force).expect("its id is free"));
        if is_reversible {
            world.set_sleep_after(None).expect("a fair number");
        }
        let mut scene = Scene { bodies, fields: Vec::new(), is_reversible };
        for tick in 0..ticks() {
            // Ticks without a call, with a few, and with so many that all is dropped.
            let count = [0, 1, 2, 5, 200][below(&mut random, 5)];
            (0..count).for_each(|_| change(&mut world, &mut random, &mut scene));
            undone += u32::from(there_and_back(&mut world.clone()).is_ok());
            let (mut cloned, mut restored) = (world.clone(), forgetful(&world));
            slept += world.step().fell_asleep.len();
            cloned.step();
            restored.step();
            moved += world.moving_count();
            let expected = world.state_hash();
            assert_eq!(cloned.state_hash(), expected, "a copy, {integrator:?}, tick {tick}");
            assert_eq!(restored.state_hash(), expected, "a restored one, {integrator:?}, tick {tick}");
            assert_eq!(cloned.last_report().faults, world.last_report().faults, "{integrator:?}, tick {tick}");
        }
    }
    assert!(slept > 20 && moved > 200 && undone > 20, "{slept} slept, {moved} moved, {undone} steps were undone");
}

/// The block that it comes to was found safe for many steps without it.
#[test]
fn a_body_that_a_field_lets_go_is_quarantined_where_it_leaves_the_allowed_range() {
    let mut world = World::new(WorldDef { sleep_after: None, ..WorldDef::default() }).expect("a fair definition");
    for _ in 0..40 {
        world.add_body(BodyDef { velocity: vec2(1, 0), ..BodyDef::dynamic() }).expect("a fair body");
    }
    let (position, velocity) = (vec2(1_073_741_814, 0), vec2(60, 0));
    world.add_body(BodyDef { position, velocity, force_groups: 2, ..BodyDef::dynamic() }).expect("a fair body");
    let region = Region::Disc { centre: vec2(0, 0), radius: fx!(1) };
    let kind = FieldKind::Zone { region, acceleration: vec2(0, 0) };
    let zone = world.add_field(ForceField { kind, force_groups: 2 }).expect("a fair field");
    world.step();
    world.remove_field(zone).expect("it is there");
    let faults: Vec<usize> = (0..15).map(|_| world.step().faults.len()).collect();
    assert_eq!(faults.iter().sum::<usize>(), 1, "{faults:?}");
}

/// Steps a world beside one that has nothing cached.
fn same_steps(world: &mut World, ticks: u32, what: &str) {
    let mut fresh = forgetful(world);
    for _ in 0..ticks {
        world.step();
        fresh.step();
        assert_eq!(world.state_hash(), fresh.state_hash(), "{what}");
    }
}

#[test]
fn a_body_that_turned_while_no_field_was_attached_has_the_direction_it_has_now() {
    for integrator in Integrator::ALL {
        let mut world = World::new(WorldDef { integrator, ..WorldDef::default() }).expect("a world");
        let [body, partner] = [fx!(1), fx!(-2)].map(|angular_velocity| {
            let mass = Mass::Explicit { mass: fx!(1), inertia: fx!(1) };
            world.add_body(BodyDef { angular_velocity, mass, ..BodyDef::dynamic() }).expect("a fair body")
        });
        let thrust = FieldKind::Thrust { at: Attachment::centre(body), force: vec2(1, 0) };
        let spring = SpringConstants { rest: fx!(1), stiffness: fx!(3), damping: fx!(0) };
        let near = Attachment { point: vec2(0, 1), ..Attachment::centre(body) };
        let tie = FieldKind::Spring { near, far: End::Body(Attachment::centre(partner)), spring };
        for kind in [thrust, tie] {
            let field = world.add_field(kind).expect("a fair field");
            same_steps(&mut world, 1, "attached");
            world.remove_field(field).expect("it is there");
            (0..3).for_each(|_| _ = world.step());
            let field = world.add_field(kind).expect("a fair field");
            same_steps(&mut world, 2, "attached again");
            // So it has through a field on a body that takes no part for a while.
            world.disable(body).expect("it is there");
            (0..2).for_each(|_| _ = world.step());
            world.enable(body).expect("it is disabled");
            same_steps(&mut world, 2, "enabled again");
            world.remove_field(field).expect("it is there");
        }
    }
}

#[test]
fn a_body_that_is_named_often_and_has_many_fields_moves_as_ever() {
    let mut world = World::new(WorldDef::default()).expect("a world");
    let bodies: Vec<BodyId> = (0..400)
        .map(|i| world.add_body(BodyDef { position: vec2(i, 0), ..BodyDef::dynamic() }).expect("a fair body"))
        .collect();
    let spring = SpringConstants { rest: fx!(1), stiffness: fx!(1), damping: fx!(0) };
    for &far in &bodies[1..] {
        let far = End::Body(Attachment::centre(far));
        world.add_field(FieldKind::Spring { near: Attachment::centre(bodies[0]), far, spring }).expect("a fair field");
    }
    same_steps(&mut world, 2, "at first");
    for i in 0..20 {
        world.set_user_data(bodies[0], i).expect("it is there");
        world.set_user_data(bodies[1], i).expect("it is there");
    }
    same_steps(&mut world, 2, "the hub was named");
    world.set_user_data(bodies[7], 1).expect("it is there");
    same_steps(&mut world, 2, "a rim was named");
}
