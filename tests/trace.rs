//! A step looked at stage by stage is the same step, and each stage writes what its verb says and nothing else.

use std::collections::BTreeSet;

use umbra_physics::{
    Activity, Attachment, BodyDef, BodyId, Damping, End, Error, FieldKind, ForceField, Fx, FxFactor, FxWide,
    Integrator, Mass, Quantity, Region, Snapshot, SpringConstants, Stage, StageKind, TimeStep, Vec2, World, WorldDef,
    fx, limits, vec2,
};

#[path = "support/inputs.rs"]
#[allow(dead_code, reason = "this file uses a part of the inputs")]
mod inputs;

use inputs::Random;

fn def(integrator: Integrator) -> WorldDef {
    WorldDef {
        gravity: vec2(fx!(0.5), fx!(-3)),
        linear_damping: Damping::kept_per_second(fx!(0.75)),
        angular_damping: Damping::kept_per_second(fx!(0.5)),
        integrator,
        sleep_after: Some(2),
        ..WorldDef::default()
    }
}

fn number(random: &mut Random, bits: u32) -> Fx {
    Fx::from_bits(random.next() >> (64 - bits))
}

fn vector(random: &mut Random, bits: u32) -> Vec2 {
    Vec2::new(number(random, bits), number(random, bits))
}

/// Three blocks of bodies: two under a spring with a damper, one under a thrust; some at rest; one about to leave the
/// envelope. If fields are to reach all blocks, there is an attractor that a body carries and drags besides, one of them too
/// stiff for a step backwards.
fn busy(integrator: Integrator, all: bool) -> (World, Vec<BodyId>) {
    let mut random = Random::seeded(1);
    let mut world = World::new(def(integrator)).expect("a fair definition");
    let mut bodies: Vec<BodyDef> = (0..300)
        .map(|i| BodyDef {
            position: vector(&mut random, 41),
            velocity: vector(&mut random, 36),
            angle: number(&mut random, 35),
            angular_velocity: number(&mut random, 35),
            mass: Mass::Explicit { mass: fx!(2), inertia: fx!(0.5) },
            force_groups: if i < 20 { 1 } else { 2 },
            ..BodyDef::dynamic()
        })
        .collect();
    for body in &mut bodies[200..210] {
        (body.velocity, body.angular_velocity, body.gravity_scale) = (Vec2::ZERO, fx!(0), fx!(0));
    }
    bodies[30].position = vec2(fx!(1_073_741_823), 0);
    bodies[30].velocity = vec2(20, 0);
    bodies[31] = BodyDef { force_groups: 4, mass: Mass::Kilograms(fx!(0.001)), ..bodies[31].clone() };
    let ids: Vec<BodyId> = bodies.into_iter().map(|body| world.add_body(body).expect("a fair body")).collect();
    let at = |i: usize| Attachment { body: ids[i], point: vec2(fx!(0.5), 1) };
    let spring = SpringConstants { rest: fx!(3), stiffness: fx!(2), damping: fx!(0.5) };
    let drag = |linear| FieldKind::Drag { linear, quadratic: fx!(0.01), wind: vec2(1, 2) };
    let mu = FxFactor::from_scalar(fx!(40));
    let fields = [
        (1, FieldKind::Spring { near: at(0), far: End::Body(at(1)), spring }),
        (1, FieldKind::Thrust { at: at(4), force: vec2(fx!(0.5), fx!(2)) }),
        (1, FieldKind::Attractor { centre: End::Body(at(5)), mu, softening: fx!(1) }),
        (1, drag(fx!(0.25))),
        (4, drag(fx!(1))),
    ];
    for (force_groups, law) in fields.into_iter().take(if all { 5 } else { 2 }) {
        world.add_field(ForceField { kind: law, force_groups }).expect("a fair field");
    }
    (world, ids)
}

fn cases() -> impl Iterator<Item = (Integrator, bool)> {
    Integrator::ALL.into_iter().flat_map(|integrator| [(integrator, true), (integrator, false)])
}

fn push(world: &mut World, ids: &[BodyId], tick: usize) {
    for id in ids[40..190].iter().skip(tick % 7).step_by(11) {
        world.apply_force(*id, vec2(tick as i32, -4)).expect("a fair force");
        world.apply_torque(*id, fx!(0.5)).expect("a fair torque");
    }
}

#[test]
fn a_step_that_is_traced_is_the_step() {
    for (integrator, all) in cases() {
        let (mut plain, ids) = busy(integrator, all);
        let (mut traced, mut now_and_then) = (plain.clone(), plain.clone());
        let (mut faults, mut asleep, mut outside) = (0, 0, 0);
        for tick in 0..60 {
            for world in [&mut plain, &mut traced, &mut now_and_then] {
                push(world, &ids, tick);
            }
            plain.step();
            traced.step_traced();
            if tick % 3 == 1 {
                now_and_then.step_traced();
            } else {
                now_and_then.step();
            }
            let report = plain.last_report();
            for world in [&traced, &now_and_then] {
                assert_eq!(world.state_hash(), plain.state_hash(), "{integrator:?}, tick {tick}");
                assert_eq!(world.last_report(), report, "{integrator:?}, tick {tick}");
            }
            faults += report.faults.len();
            asleep += report.fell_asleep.len();
            outside += report.drag_outside;
        }
        assert!(faults > 0 && asleep > 0, "{integrator:?}: {faults} faults, {asleep} asleep");
        assert_eq!(outside > 0, all && integrator == Integrator::Yoshida4);
    }
}

/// Quantities that a stage may write, by name, to the bit; applied forces are compared by their public sums.
fn parts(world: &World) -> [(&'static str, Vec<[i128; 4]>); 3] {
    let bodies = || world.bodies();
    let places = bodies().map(|body| {
        let x = body.position_exact();
        [x.x.to_bits(), x.y.to_bits(), i128::from(body.angle_exact().to_bits()), 0]
    });
    let speeds = bodies().map(|body| {
        let (v, spin) = (body.velocity_exact(), body.angular_velocity_exact());
        [v.x.to_bits(), v.y.to_bits(), spin.to_bits(), 0]
    });
    let forces = bodies().map(|body| {
        let (force, torque) = (body.applied_force(), body.applied_torque());
        let force = force.expect("it fits");
        let bits = FxWide::to_bits;
        [bits(force.x), bits(force.y), bits(torque.expect("it fits")), 0]
    });
    [("places", places.collect()), ("speeds", speeds.collect()), ("forces", forces.collect())]
}

#[test]
fn a_stage_writes_what_its_verb_says_alone() {
    for (integrator, all) in cases() {
        let (mut world, ids) = busy(integrator, all);
        let mut written = BTreeSet::new();
        for tick in 0..5 {
            push(&mut world, &ids, tick);
            let mut before = world.clone();
            let start = before.tick();
            let trace = world.step_traced();
            let stages: Vec<Stage> = trace.stages().map(|(stage, _)| *stage).collect();
            assert_eq!(stages, integrator.stages());
            for (stage, after) in trace.stages() {
                let may = match stage.kind {
                    StageKind::Fields => "",
                    StageKind::Damp | StageKind::Kick => "speeds",
                    StageKind::Drift => "places",
                    StageKind::Clear => "forces",
                    // Caps of speeds and arrival at targets come between the flight and contacts. There are no colliders here;
                    // `tests/contacts` has them.
                    StageKind::Detect => {
                        before = after.clone();
                        continue;
                    }
                    StageKind::Solve | StageKind::Push => "",
                    kind => panic!("{kind:?} has no list of what it may write"),
                };
                for ((name, old), (_, new)) in parts(&before).iter().zip(&parts(after)) {
                    assert!(old == new || *name == may, "{integrator:?}, {stage:?} writes {name}");
                    if old != new {
                        written.insert((stage.kind.name(), *name));
                    }
                }
                // What the bodies do not show: nothing else is written.
                assert_eq!(after.tick(), start);
                match stage.kind {
                    StageKind::Fields => assert_eq!(after.state_hash(), before.state_hash(), "{integrator:?}"),
                    StageKind::Clear => {
                        before.clear_forces();
                        assert_eq!(after.state_hash(), before.state_hash(), "{integrator:?}");
                    }
                    _ => {}
                }
                before = after.clone();
            }
            // Quarantine and sleep are what is left to do.
            let taken_out: Vec<BodyId> = world.last_report().faults.iter().map(|fault| fault.body).collect();
            for (body, last) in world.bodies().zip(before.bodies()).filter(|(body, _)| !taken_out.contains(&body.id()))
            {
                assert_eq!(body.position_exact(), last.position_exact());
                assert_eq!(body.velocity_exact(), last.velocity_exact());
                assert_eq!(body.angle_exact(), last.angle_exact());
                assert_eq!(body.angular_velocity_exact(), last.angular_velocity_exact());
            }
        }
        let everything = [("clear", "forces"), ("damp", "speeds"), ("drift", "places"), ("kick", "speeds")];
        assert_eq!(written.into_iter().collect::<Vec<_>>(), everything, "{integrator:?}");
    }
}

#[test]
fn two_runs_part_in_the_stage_that_parts_them() {
    for integrator in Integrator::ALL {
        let make = |wind: Fx| {
            let (mut world, _) = busy(integrator, true);
            world
                .add_field(FieldKind::Drag { linear: fx!(0.1), quadratic: fx!(0), wind: Vec2::new(wind, fx!(0)) })
                .expect("fair");
            world
        };
        let (mut first, mut second) = (make(fx!(1)), make(fx!(2)));
        let (first_trace, second_trace) = (first.step_traced(), second.step_traced());
        let parted = first_trace.stages().zip(second_trace.stages()).find(|((_, a), (_, b))| parts(a) != parts(b));
        assert_eq!(parted.map(|((stage, _), _)| stage.kind), Some(StageKind::Damp), "{integrator:?}");
    }
}

#[test]
fn an_empty_world_has_its_stages_too() {
    for integrator in Integrator::ALL {
        let mut world = World::new(def(integrator)).expect("a fair definition");
        let trace = world.step_traced();
        assert_eq!(trace.stages().len(), integrator.stages().len());
        assert_eq!(world.tick(), 1);
    }
}

#[test]
fn a_body_beyond_the_envelope_in_the_midst_of_a_step_is_quarantined_there() {
    // Up and down again within a step: beyond the limit of speed only in between.
    let limit = fx!(1_048_576);
    let down =
        WorldDef { time_step: TimeStep::hz(1), gravity: vec2(0, -10_000), sleep_after: None, ..WorldDef::default() };
    let mut world = World::new(down).expect("a fair definition");
    let still = world.add_body(BodyDef { gravity_scale: fx!(0), ..BodyDef::dynamic() }).expect("a fair body");
    let fast = BodyDef { position: vec2(5, 0), velocity: Vec2::new(fx!(0), -limit), ..BodyDef::dynamic() };
    let ids = [fast.clone(), fast].map(|body| world.add_body(body).expect("a fair body"));
    let region = Region::Box { min: vec2(-10, -10_000_000), max: vec2(10, -1_000) };
    world.add_field(FieldKind::Zone { region, acceleration: vec2(0, 30_000) }).expect("a fair field");
    let trace = world.step_traced();
    assert!(world.last_report().faults.is_empty());
    let (_, midway) = trace.stages().find(|(stage, _)| stage.kind == StageKind::Drift).expect("it drifts");
    for id in ids {
        let body = midway.body(id).expect("it is there");
        assert_eq!(body.velocity().y, -limit - fx!(5_000));
        assert_eq!(body.activity(), Activity::Quarantined);
        assert_eq!(world.body(id).expect("it is there").activity(), Activity::Awake);
    }
    assert_eq!(midway.body(still).expect("it is there").activity(), Activity::Awake);
    // A world like any other.
    let mut continued = midway.clone();
    assert_eq!(continued.release(ids[0]), Err(Error::OutOfRange { quantity: Quantity::Velocity }));
    continued.step();
    continued.set_velocity(ids[0], Vec2::new(fx!(0), -limit)).expect("a fair velocity");
    continued.release(ids[0]).expect("it is quarantined");
    assert!(continued.step().faults.is_empty());
    assert_eq!(continued.body(ids[0]).expect("it is there").velocity().y, fx!(20_000) - limit);
}

#[test]
fn a_body_pushed_beyond_the_envelope_is_quarantined_in_worlds_that_go_on() {
    let limit = fx!(1_048_576);
    for integrator in Integrator::ALL {
        let slow = WorldDef { time_step: TimeStep::hz(1), integrator, sleep_after: None, ..WorldDef::default() };
        let mut world = World::new(slow).expect("a fair definition");
        let ids: Vec<_> = (0..3).map(|_| world.add_body(BodyDef::dynamic()).expect("a fair body")).collect();
        world
            .add_field(FieldKind::Drag { linear: fx!(0.1), quadratic: fx!(0), wind: Vec2::ZERO })
            .expect("a fair field");
        world.set_velocity(ids[1], Vec2::new(limit, fx!(0))).expect("a fair velocity");
        world.apply_force(ids[1], vec2(200_000, 0)).expect("a fair force");
        world.apply_force(ids[2], vec2(1, 0)).expect("a fair force");
        let trace = world.step_traced();
        let mut strayed = false;
        for (stage, midway) in trace.stages() {
            let copy = Snapshot::from_bytes(&midway.snapshot().to_bytes(), &[]).expect("a world like any other");
            assert_eq!(copy.world().state_hash(), midway.state_hash());
            let mut continued = midway.clone();
            continued.step();
            let body = midway.body(ids[1]).expect("it is there");
            if body.activity() == Activity::Quarantined {
                assert_eq!(body.applied_force().map(|force| force.x.to_bits()), Some(0), "{integrator:?} {stage:?}");
                strayed = true;
            }
            let after = continued.body(ids[0]).expect("it is there");
            assert_eq!(after.velocity(), Vec2::ZERO);
        }
        assert!(strayed, "{integrator:?}");
    }
}

#[test]
fn a_body_beyond_the_envelope_by_less_than_an_ulp_is_not_released() {
    let mut world = World::new(WorldDef { sleep_after: None, ..WorldDef::default() }).expect("fair");
    let edge = Vec2::new(limits::POSITION, fx!(0));
    let velocity = Vec2::new(Fx::from_bits(1), fx!(0));
    let body = world.add_body(BodyDef { position: edge, velocity, ..BodyDef::dynamic() }).expect("fair");
    let trace = world.step_traced();
    assert_eq!(world.last_report().faults.len(), 1);
    let (_, beyond) = trace.stages().find(|(stage, _)| stage.kind == StageKind::Drift).expect("it drifts");
    assert_eq!(beyond.body(body).expect("it is there").position(), edge);
    let mut beyond = beyond.clone();
    assert_eq!(beyond.release(body), Err(Error::OutOfRange { quantity: Quantity::Position }));
    beyond.set_position(body, edge).expect("it is the last there is");
    assert_eq!(beyond.release(body), Ok(()));
}

#[test]
fn worlds_of_stages_have_the_factors_of_bodies_that_came_with_the_step() {
    let gravity = vec2(0, -10);
    let mut world = World::new(WorldDef { gravity, ..WorldDef::default() }).expect("a world");
    let body = world.add_body(BodyDef::dynamic()).expect("a fair body");
    world.disable(body).expect("it is there");
    world.step();
    world.enable(body).expect("it is disabled");
    let trace = world.step_traced();
    for (stage, after) in trace.stages() {
        let mut after = after.clone();
        let bytes = after.snapshot().to_bytes();
        let mut read = umbra_physics::Snapshot::from_bytes(&bytes, &[]).expect("its own bytes").into_world();
        after.step();
        read.step();
        assert_eq!(after.state_hash(), read.state_hash(), "{stage:?}");
    }
}
