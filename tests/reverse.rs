//! A step that is undone leads to the very bits it came from, and what has no way back is refused with nothing changed.

use std::sync::Arc;

use umbra_physics::{
    AppliedForce, Attachment, BodyDef, BodyId, BodyState, Cause, ColliderDef, CustomForce, CustomForceError, Damping,
    Dependence, End, Error, Fault, FieldKind, ForceField, ForceTorque, Fx, FxFactor, Integrator, Irreversible, Mass,
    Region, Shape, SpringConstants, StageKind, TimeStep, Vec2, World, WorldDef, fx, vec2,
};

#[path = "support/inputs.rs"]
#[allow(dead_code, reason = "this file uses a part of the inputs")]
mod inputs;

use inputs::Random;

const REVERSIBLE: [Integrator; 3] = [Integrator::SymplecticEuler, Integrator::VelocityVerlet, Integrator::Yoshida4];

fn def(integrator: Integrator) -> WorldDef {
    let gravity = vec2(fx!(0.125), fx!(-1.7));
    WorldDef { time_step: TimeStep::hz(60), integrator, gravity, sleep_after: None, ..WorldDef::default() }
}

fn world(def: WorldDef, bodies: impl IntoIterator<Item = BodyDef>) -> (World, Vec<BodyId>) {
    let mut world = World::new(def).expect("a fair definition");
    let ids = bodies.into_iter().map(|body| world.add_body(body).expect("a fair body")).collect();
    (world, ids)
}

fn mu(value: Fx) -> FxFactor {
    FxFactor::from_scalar(value)
}

/// Within ±2^(bits − 33).
fn number(random: &mut Random, bits: u32) -> Fx {
    Fx::from_bits(random.next() >> (64 - bits))
}

fn vector(random: &mut Random, bits: u32) -> Vec2 {
    Vec2::new(number(random, bits), number(random, bits))
}

/// Bodies at random within half a kilometre, turning, each of a mass of its own.
fn tumbling(count: usize, seed: u64) -> impl Iterator<Item = BodyDef> {
    let mut random = Random::seeded(seed);
    (0..count).map(move |_| BodyDef {
        position: vector(&mut random, 42),
        velocity: vector(&mut random, 36),
        angle: number(&mut random, 35),
        angular_velocity: number(&mut random, 36),
        mass: Mass::Explicit {
            mass: fx!(0.5) + Fx::from_bits(random.next().unsigned_abs() as i64 >> 30),
            inertia: fx!(0.3),
        },
        ..BodyDef::dynamic()
    })
}

/// A planet on an ellipse around a star, and a moon of an asteroid that passes by.
fn kepler(integrator: Integrator) -> (World, Vec<BodyId>) {
    let planet = BodyDef { position: vec2(10, 0), velocity: vec2(0, fx!(2.5)), ..BodyDef::dynamic() };
    let asteroid = BodyDef { position: vec2(20, 5), velocity: vec2(fx!(-0.1), 0), ..BodyDef::kinematic() };
    let moon = BodyDef { position: vec2(21, 5), velocity: vec2(0, fx!(0.9)), ..BodyDef::dynamic() };
    let (mut world, ids) = world(
        WorldDef { gravity: Vec2::ZERO, ..def(integrator) },
        [planet, asteroid, moon].map(|b| BodyDef { force_groups: 3, ..b }),
    );
    let star = FieldKind::Attractor { centre: End::World(Vec2::ZERO), mu: mu(fx!(100)), softening: fx!(0) };
    let carried =
        FieldKind::Attractor { centre: End::Body(Attachment::centre(ids[1])), mu: mu(fx!(1)), softening: fx!(0.25) };
    world.add_field(star).expect("a fair field");
    world.add_field(carried).expect("a fair field");
    (world, ids)
}

/// A net of rods that springs join at points off their centres, hung from two nails, so that all of it turns and swings.
fn net(integrator: Integrator) -> (World, Vec<BodyId>) {
    const SIDE: usize = 12;
    let rod = Shape::rectangle(fx!(0.5), fx!(0.125)).expect("a fair shape");
    let place = |i: usize| Vec2::new(Fx::from((i % SIDE) as i32), Fx::from(-((i / SIDE) as i32)));
    let mut random = Random::seeded(3);
    let rods = (0..SIDE * SIDE).map(|i| BodyDef {
        position: place(i),
        velocity: vector(&mut random, 33),
        mass: Mass::Kilograms(fx!(1)),
        ..BodyDef::dynamic().with_collider(ColliderDef::ghost(rod.clone()))
    });
    let (mut world, ids) = world(def(integrator), rods);
    let point = |x: Fx| vec2(x, fx!(0.03125));
    let mut join = |index: usize, far: End| {
        let spring = SpringConstants { rest: fx!(0.5), stiffness: fx!(90), damping: fx!(0) };
        let start = Attachment { body: ids[index], point: point(fx!(0.25)) };
        world.add_field(FieldKind::Spring { near: start, far, spring }).expect("a fair field");
    };
    let left = |i: usize| End::Body(Attachment { body: ids[i], point: point(fx!(-0.25)) });
    for i in 0..SIDE * SIDE {
        if i % SIDE > 0 {
            join(i - 1, left(i));
        }
        if i >= SIDE {
            join(i - SIDE, left(i));
        }
    }
    join(0, End::World(vec2(-1, 1)));
    join(SIDE - 1, End::World(vec2(SIDE as i32, 1)));
    (world, ids)
}

/// A law of position of the caller's own: towards the axis, with a torque.
struct Trough;

impl CustomForce for Trough {
    fn id(&self) -> u64 {
        7
    }

    fn version(&self) -> u32 {
        1
    }

    fn depends_on(&self) -> Dependence {
        Dependence::Position
    }

    fn push(&self, body: &BodyState) -> Result<ForceTorque, CustomForceError> {
        let fault = CustomForceError { code: 1 };
        let y = body.position.y.checked_mul(fx!(-0.01)).ok_or(fault)?;
        Ok(ForceTorque { force: vec2(fx!(0), y), torque: body.angle.sin() })
    }
}

/// Springs and thrusts on a few bodies, beside blocks of bodies that no field reaches.
fn few(integrator: Integrator) -> (World, Vec<BodyId>) {
    let free = tumbling(300, 1).map(|body| BodyDef { force_groups: 0, ..body });
    let nail = BodyDef { position: vec2(3, 3), ..BodyDef::fixed() };
    let cart = BodyDef { velocity: vec2(1, fx!(0.25)), angular_velocity: fx!(0.7), ..BodyDef::kinematic() };
    let (mut world, ids) = world(def(integrator), tumbling(20, 2).chain(free).chain([nail, cart]));
    let at = |i: usize, x: i32| Attachment { body: ids[i], point: vec2(x, 1) };
    let spring = SpringConstants { rest: fx!(3), stiffness: fx!(2), damping: fx!(0) };
    let custom_forces = [
        FieldKind::Spring { near: at(0, 1), far: End::Body(at(1, -1)), spring },
        FieldKind::Spring { near: at(2, 0), far: End::Body(at(320, 0)), spring },
        FieldKind::Spring { near: at(3, 2), far: End::Body(at(321, 1)), spring },
        FieldKind::Thrust { at: at(4, 0), force: vec2(fx!(0.5), fx!(2)) },
    ];
    for law in custom_forces {
        world.add_field(law).expect("a fair field");
    }
    (world, ids)
}

/// Every kind of field that has a way back.
fn everything(integrator: Integrator) -> (World, Vec<BodyId>) {
    let (mut world, ids) = few(integrator);
    world.register_custom_force(Arc::new(Trough)).expect("the first of its id");
    let carrier = End::Body(Attachment { body: ids[5], point: vec2(1, 1) });
    let custom_forces = [
        FieldKind::Attractor { centre: carrier, mu: mu(fx!(40)), softening: fx!(1) },
        FieldKind::Zone {
            region: Region::Disc { centre: vec2(0, 0), radius: fx!(400) },
            acceleration: vec2(1, fx!(-0.5)),
        },
        FieldKind::Zone { region: Region::Box { min: vec2(-50, -300), max: vec2(300, 50) }, acceleration: vec2(0, 3) },
        FieldKind::Custom { id: 7 },
    ];
    for law in custom_forces {
        world.add_field(ForceField { kind: law, force_groups: 1 }).expect("a fair field");
    }
    (world, ids)
}

/// Bodies that no field reaches, from one end of the envelope to the other and as fast as it has them, in blocks that are
/// alike and blocks that are not.
fn near_the_envelope(integrator: Integrator) -> (World, Vec<BodyId>) {
    let mut random = Random::seeded(5);
    let bodies = tumbling(700, 4).enumerate().map(|(i, body)| {
        let far = |x: Fx| if x < fx!(0) { x - fx!(1_073_730_000) } else { x + fx!(1_073_730_000) };
        // Fast near the middle, where there is room to go; slow near the edge.
        match i % 5 {
            0 => BodyDef { velocity: vector(&mut random, 53), angular_velocity: number(&mut random, 53), ..body },
            1 => BodyDef { position: body.position.map(far), ..body },
            2 if i > 400 => BodyDef { gravity_scale: fx!(-16), ..body },
            _ => body,
        }
    });
    world(def(integrator), bodies)
}

/// Pushes a few bodies in every way there is; impulses are handed out, to be taken back.
fn push(world: &mut World, ids: &[BodyId], random: &mut Random) -> Option<(BodyId, Vec2, Fx)> {
    let mut pick = || ids[random.next() as u64 as usize % ids.len()];
    let bodies = [pick(), pick(), pick(), pick()];
    let force = vector(random, 36);
    let dynamic = |body: &BodyId| world.body(*body).expect("it is there").kind() == umbra_physics::BodyKind::Dynamic;
    if !bodies.iter().all(dynamic) || force.x > fx!(4) {
        // None at all in some ticks.
        return None;
    }
    let centre = world.body(bodies[1]).expect("it is there").position();
    world.apply_force(bodies[0], force).expect("a fair force");
    world.apply_force_at_point(bodies[1], force, centre + vec2(1, fx!(0.5))).expect("a fair force");
    world.apply_torque(bodies[2], force.y).expect("a fair torque");
    let struck = (bodies[3], vector(random, 34), number(random, 34));
    world.apply_impulse(struck.0, struck.1).expect("a fair impulse");
    world.apply_angular_impulse(struck.0, struck.2).expect("a fair impulse");
    Some(struck)
}

/// There and back with inputs at each tick, every state on the way compared, and there again.
fn there_and_back(name: &str, make: fn(Integrator) -> (World, Vec<BodyId>), ticks: usize) {
    for integrator in REVERSIBLE {
        let (mut world, ids) = make(integrator);
        let mut random = Random::seeded(9);
        let mut ticks_kept = Vec::new();
        for tick in 0..ticks {
            let quiet = world.state_hash();
            let struck = push(&mut world, &ids, &mut random);
            let before = world.state_hash();
            let report = world.step();
            assert!(report.faults.is_empty(), "{name}, {integrator:?}: {:?} at tick {tick}", report.faults);
            ticks_kept.push((quiet, struck, before, report.applied.to_vec(), world.state_hash()));
        }
        assert!(ticks_kept.iter().any(|kept| !kept.3.is_empty()), "nobody was pushed");
        let end = world.clone();
        for (tick, (quiet, struck, before, applied, after)) in ticks_kept.iter().enumerate().rev() {
            assert_eq!(world.state_hash(), *after, "{name}, {integrator:?}: after tick {tick}");
            world.step_back(applied).expect("it has a way back");
            assert_eq!(world.tick(), tick as u64);
            assert_eq!(world.state_hash(), *before, "{name}, {integrator:?}: before tick {tick}");
            let report = world.last_report();
            assert!(report.applied.is_empty() && report.faults.is_empty() && report.tick == tick as u64);
            if tick % 16 == 0 {
                let mut again = world.clone();
                assert_eq!(again.step().applied, applied, "{name}, {integrator:?}: tick {tick} again");
                assert_eq!(again.state_hash(), *after, "{name}, {integrator:?}: tick {tick} again");
            }
            world.clear_forces();
            if let Some((body, impulse, angular)) = *struck {
                world.apply_angular_impulse(body, -angular).expect("a fair impulse");
                world.apply_impulse(body, -impulse).expect("a fair impulse");
            }
            assert_eq!(world.state_hash(), *quiet, "{name}, {integrator:?}: at rest before tick {tick}");
        }
        let start = make(integrator).0;
        assert_eq!(world.state_hash(), start.state_hash());
        let mut random = Random::seeded(9);
        for _ in 0..ticks {
            push(&mut world, &ids, &mut random);
            world.step();
        }
        assert_eq!(world.state_hash(), end.state_hash(), "{name}, {integrator:?}: there again");
    }
}

fn ticks() -> usize {
    crate::seeds::times(60)
}

#[test]
fn an_orbit_goes_back_to_the_bit() {
    there_and_back("kepler", kepler, 10 * ticks());
}

#[test]
fn a_net_of_springs_goes_back_to_the_bit() {
    there_and_back("net", net, ticks());
}

#[test]
fn every_force_that_has_a_way_back_goes_back_to_the_bit() {
    there_and_back("everything", everything, ticks());
}

#[test]
fn free_bodies_beside_bound_ones_go_back_to_the_bit() {
    there_and_back("few", few, ticks());
}

#[test]
fn free_bodies_near_the_envelope_go_back_to_the_bit() {
    there_and_back("near the envelope", near_the_envelope, ticks().min(200));
}

#[test]
fn many_steps_go_back_to_the_bit() {
    let steps = crate::seeds::times(100_000);
    const PUSHED: u64 = 64;
    for integrator in REVERSIBLE {
        let steps = if integrator == Integrator::VelocityVerlet { steps } else { steps / 4 };
        // A planet with spin, a pair that a spring joins around it, and one that no field reaches.
        let planet = BodyDef { position: vec2(10, 0), velocity: vec2(0, fx!(2.5)), ..BodyDef::dynamic() };
        let first = BodyDef { position: vec2(-20, 1), velocity: vec2(0, fx!(-2)), ..BodyDef::dynamic() };
        let second = BodyDef { position: vec2(-21, 1), angular_velocity: fx!(3), ..first.clone() };
        let free = BodyDef {
            force_groups: 0,
            velocity: vec2(fx!(0.01), fx!(0.02)),
            angular_velocity: fx!(1),
            ..planet.clone()
        };
        let calm = WorldDef { gravity: Vec2::ZERO, ..def(integrator) };
        let (mut world, ids) = world(calm, [planet, first, second, free]);
        let star = FieldKind::Attractor { centre: End::World(Vec2::ZERO), mu: mu(fx!(100)), softening: fx!(0.125) };
        let spring = SpringConstants { rest: fx!(1), stiffness: fx!(30), damping: fx!(0) };
        let far = End::Body(Attachment { body: ids[2], point: vec2(fx!(0.25), 0) });
        let spring = FieldKind::Spring { near: Attachment::centre(ids[1]), far, spring };
        for law in [star, spring] {
            world.add_field(ForceField { kind: law, force_groups: 1 }).expect("a fair field");
        }
        let mut random = Random::seeded(11);
        let mut applied: Vec<AppliedForce> = Vec::new();
        let mut hashes = Vec::new();
        for tick in 0..steps {
            if tick % (steps / 100) == 0 {
                hashes.push(world.state_hash());
            }
            if tick % PUSHED == 0 {
                let body = ids[(tick / PUSHED) as usize % ids.len()];
                world.apply_force(body, vector(&mut random, 30)).expect("a fair force");
                world.apply_torque(body, number(&mut random, 30)).expect("a fair torque");
            }
            let report = world.step();
            assert!(report.faults.is_empty(), "{integrator:?}: {:?} at tick {tick}", report.faults);
            applied.extend(report.applied);
        }
        assert_eq!(hashes.len(), 100);
        for tick in (0..steps).rev() {
            let pushed: &[AppliedForce] = if tick % PUSHED == 0 { &[applied.pop().expect("one a push")] } else { &[] };
            world.step_back(pushed).expect("it has a way back");
            world.clear_forces();
            if tick % (steps / 100) == 0 {
                assert_eq!(Some(world.state_hash()), hashes.pop(), "{integrator:?}: tick {tick}");
            }
        }
        assert!(applied.is_empty() && hashes.is_empty());
    }
}

#[test]
fn a_step_back_leads_to_where_a_step_leads_here_from_also_where_none_was_made() {
    for integrator in REVERSIBLE {
        let (mut world, ids) = everything(integrator);
        world.step();
        for (i, id) in ids.iter().enumerate().take(300) {
            world.set_velocity(*id, vec2(i as i32 % 7, 3)).expect("a fair velocity");
        }
        let here = world.state_hash();
        world.step_back(&[]).expect("it has a way back");
        assert!(world.state_hash() != here);
        world.step();
        assert_eq!(world.state_hash(), here, "{integrator:?}");
    }
}

#[test]
fn the_inverse_of_an_integrator_has_each_kick_and_drift_of_a_step_once() {
    for integrator in Integrator::ALL {
        let Some(inverse) = integrator.inverse() else {
            assert!(!REVERSIBLE.contains(&integrator));
            continue;
        };
        assert!(REVERSIBLE.contains(&integrator));
        // Where the fields are evaluated, and what there is to damp or clear, is another matter.
        let shears = |stages: &[umbra_physics::Stage]| {
            let moves = stages.iter().filter(|stage| matches!(stage.kind, StageKind::Kick | StageKind::Drift));
            moves.map(|stage| (stage.kind, stage.span)).collect::<Vec<_>>()
        };
        let mut reversed = shears(integrator.stages());
        reversed.reverse();
        assert_eq!(shears(inverse), reversed, "{integrator:?}");
    }
}

/// Tries to undo a step that has no way back: the error, once the world was found to be the same to the bit, and to
/// have the same future and the same report.
fn refused(world: &mut World, applied: &[AppliedForce]) -> Error {
    let (before, twin) = (world.state_hash(), world.clone());
    let error = world.step_back(applied).expect_err("there is no way back");
    assert_eq!(world.state_hash(), before, "{error}");
    assert_eq!(world.last_report(), twin.last_report(), "{error}");
    // Ahead in the world itself: a copy would not have what it keeps from one step for the next.
    let (here, mut twin) = (world.clone(), twin);
    for _ in 0..3 {
        assert_eq!(world.step(), twin.step(), "{error}");
        assert_eq!(world.state_hash(), twin.state_hash(), "{error}");
    }
    world.clone_from(&here);
    error
}

fn why(error: Error) -> Irreversible {
    match error {
        Error::NotReversible { why } => why,
        error => panic!("{error}"),
    }
}

fn ball(world: &mut World) -> BodyId {
    world.add_body(BodyDef { velocity: vec2(1, 2), ..BodyDef::dynamic() }).expect("a fair body")
}

/// A world with a ball, a step on.
fn stepped(def: WorldDef) -> (World, BodyId) {
    let (mut world, _) = world(def, []);
    let ball = ball(&mut world);
    world.step();
    (world, ball)
}

#[test]
fn an_integrator_without_an_inverse_is_refused() {
    for integrator in Integrator::ALL {
        let (mut world, _) = stepped(def(integrator));
        if REVERSIBLE.contains(&integrator) {
            assert_eq!(world.step_back(&[]), Ok(()));
        } else {
            assert_eq!(why(refused(&mut world, &[])), Irreversible::Integrator);
        }
    }
}

#[test]
fn there_is_nothing_before_the_start_or_a_change_of_the_time_step() {
    let (mut world, _) = stepped(def(Integrator::VelocityVerlet));
    world.step_back(&[]).expect("it has a way back");
    assert_eq!(why(refused(&mut world, &[])), Irreversible::Start);
    world.step();
    world.set_time_step(TimeStep::ratio(1001, 30_000)).expect("a fair time step");
    let elapsed = world.elapsed();
    assert_eq!(why(refused(&mut world, &[])), Irreversible::TimeStep);
    world.step();
    world.step_back(&[]).expect("it has a way back");
    assert_eq!(world.elapsed(), elapsed);
    assert_eq!(why(refused(&mut world, &[])), Irreversible::TimeStep);
}

#[test]
fn damping_that_acts_is_refused_and_one_that_does_not_is_not() {
    let calm = def(Integrator::VelocityVerlet);
    for damped in [
        WorldDef { linear_damping: Damping::kept_per_second(fx!(0.5)), ..calm },
        WorldDef { angular_damping: Damping::kept_per_second(fx!(0.5)), ..calm },
    ] {
        let (mut world, ball) = stepped(damped);
        assert_eq!(why(refused(&mut world, &[])), Irreversible::Damping);
        // No damping of its own, and bodies that feel none.
        world.set_body_damping(ball, Some(Damping::NONE), Some(Damping::NONE)).expect("a fair damping");
        world.add_body(BodyDef { velocity: vec2(1, 0), ..BodyDef::kinematic() }).expect("a fair body");
        world.step();
        assert_eq!(world.step_back(&[]), Ok(()));
    }
    for damping in [(Some(Damping::kept_per_second(fx!(0.5))), None), (None, Some(Damping::kept_per_second(fx!(0))))] {
        let (mut world, ball) = stepped(calm);
        world.set_body_damping(ball, damping.0, damping.1).expect("a fair damping");
        assert_eq!(why(refused(&mut world, &[])), Irreversible::Damping);
    }
}

/// A law that depends on what it is told to.
struct Any(Dependence);

impl CustomForce for Any {
    fn id(&self) -> u64 {
        5
    }

    fn version(&self) -> u32 {
        1
    }

    fn depends_on(&self) -> Dependence {
        self.0
    }

    fn push(&self, body: &BodyState) -> Result<ForceTorque, CustomForceError> {
        match body.position.x > fx!(1000) {
            true => Err(CustomForceError { code: 3 }),
            false => Ok(ForceTorque::default()),
        }
    }
}

#[test]
fn forces_of_velocity_are_refused() {
    for depends_on in [Dependence::Nothing, Dependence::Position, Dependence::Velocity] {
        let (mut world, ball) = stepped(def(Integrator::Yoshida4));
        world.register_custom_force(Arc::new(Any(depends_on))).expect("the first of its id");
        let spring = |damping| {
            let spring = SpringConstants { rest: fx!(1), stiffness: fx!(1), damping };
            FieldKind::Spring { near: Attachment::centre(ball), far: End::World(vec2(9, 9)), spring }
        };
        world.add_field(spring(fx!(0))).expect("a fair field");
        let custom = world.add_field(FieldKind::Custom { id: 5 }).expect("a fair field");
        world.step();
        if depends_on == Dependence::Velocity {
            assert_eq!(why(refused(&mut world, &[])), Irreversible::Velocity { field: custom });
        } else {
            assert_eq!(world.clone().step_back(&[]), Ok(()));
        }
        world.remove_field(custom).expect("it is there");
        for law in [spring(fx!(0.5)), FieldKind::Drag { linear: fx!(1), quadratic: fx!(0), wind: Vec2::ZERO }] {
            let field = world.add_field(law).expect("a fair field");
            assert_eq!(why(refused(&mut world, &[])), Irreversible::Velocity { field });
            world.remove_field(field).expect("it is there");
        }
    }
}

#[test]
fn sleep_and_quarantine_are_refused() {
    let (mut world, ball) = stepped(WorldDef { sleep_after: Some(2), ..def(Integrator::VelocityVerlet) });
    assert_eq!(why(refused(&mut world, &[])), Irreversible::Sleep);
    world.set_sleep_after(None).expect("a fair number");
    world.set_position(ball, vec2(fx!(1_073_741_824), 0)).expect("a fair position");
    world.step();
    assert_eq!(why(refused(&mut world, &[])), Irreversible::Quarantined { body: ball });
    world.set_position(ball, Vec2::ZERO).expect("a fair position");
    world.release(ball).expect("it was quarantined");
    world.step();
    assert_eq!(world.step_back(&[]), Ok(()));
}

#[test]
fn forces_that_would_be_lost_or_given_to_nobody_are_refused() {
    let (mut world, ball) = stepped(def(Integrator::VelocityVerlet));
    let second = self::ball(&mut world);
    for body in [ball, second] {
        world.apply_force(body, vec2(1, 2)).expect("a fair force");
    }
    assert_eq!(why(refused(&mut world, &[])), Irreversible::Pending);
    let applied = world.step().applied.to_vec();
    world.apply_torque(ball, fx!(0)).expect("a fair torque");
    assert_eq!(why(refused(&mut world, &applied)), Irreversible::Pending);
    world.clear_forces();
    let [first_push, second_push] = applied[..] else { panic!("two were pushed") };
    assert_eq!(why(refused(&mut world, &[first_push, second_push, first_push])), Irreversible::Twice { body: ball });
    world.remove_body(second).expect("it is there");
    assert_eq!(refused(&mut world, &applied), Error::NoSuchBody { body: second });
    // In the slot of the one that was removed.
    self::ball(&mut world);
    assert_eq!(refused(&mut world, &applied), Error::NoSuchBody { body: second });
    for kind in [umbra_physics::BodyKind::Static, umbra_physics::BodyKind::Kinematic] {
        world.set_kind(ball, kind).expect("it is there");
        assert_eq!(refused(&mut world, &[first_push]), Error::NotDynamic { body: ball });
    }
    // The others were not kept from their way by what was refused.
    assert_eq!(world.step_back(&[]), Ok(()));
    assert_eq!(world.step().applied, []);
}

#[test]
fn a_way_back_out_of_the_envelope_is_not_taken() {
    let edge = fx!(1_073_741_824);
    for integrator in REVERSIBLE {
        // One that fields reach and one that none does, beside bodies of either kind and among bound ones alone.
        for (make, stray) in [(few as fn(_) -> _, 10), (few, 200), (everything, 10)] {
            let (mut world, ids): (World, Vec<BodyId>) = make(integrator);
            for _ in 0..3 {
                world.step();
            }
            let body = ids[stray];
            let fault = |cause| Irreversible::Fault(Fault { body, cause });
            let good = world.clone();
            world.set_position(body, vec2(-edge, 0)).expect("a fair position");
            world.set_velocity(body, vec2(900, 0)).expect("a fair velocity");
            assert_eq!(why(refused(&mut world, &[])), fault(Cause::Position), "{integrator:?}");
            world.clone_from(&good);
            // Away from the zones gravity alone counts, so it was faster.
            world.set_position(body, vec2(600, 0)).expect("a fair position");
            world.set_velocity(body, vec2(fx!(-1_048_576), 0)).expect("a fair velocity");
            assert_eq!(why(refused(&mut world, &[])), fault(Cause::Velocity), "{integrator:?}");
            // A push that a lighter body could not have had, and one that the heavier one had.
            world.clone_from(&good);
            world.apply_force(body, vec2(2_000_000_000, 0)).expect("a fair force");
            world.set_mass(body, Mass::Explicit { mass: fx!(16_000_000), inertia: fx!(1) }).expect("a fair mass");
            let applied = world.step().applied.to_vec();
            world.clone().step_back(&applied).expect("it has a way back");
            world.set_mass(body, Mass::Explicit { mass: fx!(0.001), inertia: fx!(1) }).expect("a fair mass");
            assert_eq!(why(refused(&mut world, &applied)), fault(Cause::Velocity), "{integrator:?}");
            // Nothing of it stays: the same way is open as soon as the body is what it was.
            world.set_mass(body, Mass::Explicit { mass: fx!(16_000_000), inertia: fx!(1) }).expect("a fair mass");
            world.step_back(&applied).expect("it has a way back");
        }
    }
}

#[test]
fn undoing_a_step_names_the_fault_of_the_lowest_handle_and_the_first_fault_of_a_body() {
    let edge = fx!(1_073_741_824);
    let away = BodyDef { position: Vec2::new(edge, fx!(0)), velocity: vec2(-90, 0), ..BodyDef::dynamic() };
    let (mut world, ids) = world(def(Integrator::VelocityVerlet), [BodyDef::fixed(), BodyDef::dynamic()]);
    world.step();
    world.set_position(ids[1], away.position).expect("a fair position");
    world.set_velocity(ids[1], away.velocity).expect("a fair velocity");
    let cause = Cause::Position;
    assert_eq!(why(refused(&mut world, &[])), Irreversible::Fault(Fault { body: ids[1], cause }));
    // The last of those that move, by where it is kept.
    world.set_kind(ids[0], umbra_physics::BodyKind::Dynamic).expect("it has a mass");
    world.set_position(ids[0], away.position).expect("a fair position");
    world.set_velocity(ids[0], away.velocity).expect("a fair velocity");
    assert_eq!(why(refused(&mut world, &[])), Irreversible::Fault(Fault { body: ids[0], cause }));
    // A kick too large comes before the drift that leads out.
    let mut heavy = world.clone();
    heavy.set_position(ids[0], Vec2::ZERO).expect("a fair position");
    heavy.set_mass(ids[0], Mass::Kilograms(fx!(16_000_000))).expect("a fair mass");
    heavy.apply_force(ids[0], vec2(2_000_000_000, 0)).expect("a fair force");
    let applied = heavy.step().applied.to_vec();
    world.set_mass(ids[0], Mass::Kilograms(fx!(0.001))).expect("a fair mass");
    let cause = Cause::Velocity;
    assert_eq!(why(refused(&mut world, &applied)), Irreversible::Fault(Fault { body: ids[0], cause }));
}

#[test]
fn a_law_without_an_answer_on_the_way_back_is_not_passed() {
    let (mut world, ball) = stepped(WorldDef { gravity: Vec2::ZERO, ..def(Integrator::SymplecticEuler) });
    world.register_custom_force(Arc::new(Any(Dependence::Position))).expect("the first of its id");
    let field = world.add_field(FieldKind::Custom { id: 5 }).expect("a fair field");
    world.set_position(ball, vec2(1000, 0)).expect("a fair position");
    world.set_velocity(ball, vec2(-1, 0)).expect("a fair velocity");
    let cause = Cause::CustomForce { field, code: 3 };
    assert_eq!(why(refused(&mut world, &[])), Irreversible::Fault(Fault { body: ball, cause }));
}

#[test]
fn bodies_woken_before_an_undone_step_are_reported_by_the_next_step() {
    let still = WorldDef { gravity: Vec2::ZERO, sleep_after: Some(1), ..def(Integrator::VelocityVerlet) };
    let (mut world, ids) = world(still, [BodyDef::dynamic(), BodyDef::dynamic()]);
    world.step();
    world.step();
    assert_eq!(world.moving_count(), 0);
    world.set_sleep_after(None).expect("a fair number");
    assert_eq!(world.step().woke, ids);
    world.step_back(&[]).expect("it has a way back");
    assert!(world.last_report().woke.is_empty());
    assert_eq!(world.step().woke, ids);
    world.remove_body(ids[0]).expect("it is there");
    world.step_back(&[]).expect("it has a way back");
    assert_eq!(world.step().woke, &ids[1..]);
}

#[cfg(feature = "float")]
#[test]
fn floats_are_refused_as_their_sums_round() {
    let mut world = World::<f64>::with_scalar(WorldDef { sleep_after: None, ..WorldDef::default() }).expect("fair");
    world.add_body(BodyDef { velocity: Vec2::new(0.1, 0.2), ..BodyDef::dynamic() }).expect("a fair body");
    world.step();
    let before = world.state_hash();
    assert_eq!(world.step_back(&[]), Err(Error::NotReversible { why: Irreversible::Scalar }));
    assert_eq!(world.state_hash(), before);
}

#[cfg(feature = "parallel")]
#[test]
fn the_way_back_is_the_same_on_all_cores() {
    for integrator in REVERSIBLE {
        let (mut world, ids) = world(def(integrator), tumbling(20_000, 6));
        let start = world.state_hash();
        for _ in 0..20 {
            world.step();
        }
        for id in ids.iter().step_by(777) {
            world.apply_force(*id, vec2(3, 4)).expect("a fair force");
        }
        let applied = world.step().applied.to_vec();
        // Past the half of the bodies.
        world.set_position(ids[15_000], vec2(fx!(1_073_741_824), 0)).expect("a fair position");
        world.set_velocity(ids[15_000], vec2(-99, 0)).expect("a fair velocity");
        let mut stray = world.clone();
        let fault = Fault { body: ids[15_000], cause: Cause::Position };
        assert_eq!(why(refused(&mut stray, &applied)), Irreversible::Fault(fault));
        world.remove_body(ids[15_000]).expect("it is there");
        world.step_back(&applied).expect("it has a way back");
        world.clear_forces();
        for _ in 0..20 {
            world.step_back(&[]).expect("it has a way back");
        }
        let (mut same, ids) = self::world(def(integrator), tumbling(20_000, 6));
        assert_eq!(same.state_hash(), start);
        same.remove_body(ids[15_000]).expect("it is there");
        assert_eq!(world.state_hash(), same.state_hash(), "{integrator:?}");
    }
}
