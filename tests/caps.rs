//! Capped speeds: what is faster after a step is slowed down in its direction, and nothing else is touched.

#[path = "support/random.rs"]
mod random;

use random::SplitMix;
use umbra_physics::{
    Activity, BodyDef, BodyId, BodyKind, Error, FieldKind, Fx, FxAccumulator, Integrator, Irreversible, Locks, Mass,
    Vec2, World, WorldDef, fx, limits, vec2,
};

fn world(integrator: Integrator, gravity: Vec2) -> World {
    let def = WorldDef { integrator, gravity, sleep_after: None, ..WorldDef::default() };
    World::new(def).expect("a world")
}

fn capped(linear: Fx, angular: Fx) -> BodyDef {
    let mass = Mass::Explicit { mass: fx!(1), inertia: fx!(1) };
    BodyDef { max_speed: Some(linear), max_angular_speed: Some(angular), mass, ..BodyDef::dynamic() }
}

/// The square of a length in ulps.
fn square(v: Vec2) -> u128 {
    let square = |c: Fx| u128::from(c.to_bits().unsigned_abs()).pow(2);
    square(v.x) + square(v.y)
}

/// At most `most` and 0.7072 ulp long.
fn is_within(v: Vec2, max: Fx) -> bool {
    // (10⁴·l)² against (10⁴·most + 7072)².
    let bound = u128::from(max.to_bits().unsigned_abs()) * 10_000 + 7_072;
    square(v) * 100_000_000 <= bound * bound
}

#[test]
fn a_public_speed_is_at_most_the_cap_and_three_quarters_of_an_ulp() {
    let mut random = SplitMix::seeded(0x0ca9_0000_0000_0001);
    let cases = crate::seeds::times(2_000);
    let (mut over, mut slowed) = (0, 0);
    for case in 0..cases {
        let mut world = world(Integrator::VelocityVerlet, Vec2::ZERO);
        // With few bits above the cap, so that 10⁸ times a square fits in 128.
        let size = random.between(1, 17);
        let max_speed = Fx::from_bits(random.between(1, 1 << (18 + size)));
        let component = |random: &mut SplitMix| Fx::from_bits(random.of_bits(20 + size as u32));
        let velocity = Vec2::new(component(&mut random), component(&mut random));
        let spin = component(&mut random);
        let body = world
            .add_body(BodyDef { velocity, angular_velocity: spin, ..capped(max_speed, max_speed) })
            .expect("a body");
        world.step();
        let now = world.body(body).expect("it is there");
        let (v, w) = (now.velocity(), now.angular_velocity());
        assert!(is_within(v, max_speed), "case {case}: {velocity} became {v}, more than {max_speed}");
        over += usize::from(square(v) > u128::from(max_speed.to_bits().unsigned_abs()).pow(2));
        if square(velocity) <= u128::from(max_speed.to_bits().unsigned_abs()).pow(2) {
            assert_eq!(v, velocity, "it was not too fast");
        } else {
            slowed += 1;
            // Not slower than it has to be, and in its direction.
            let min_speed = Fx::from_bits(max_speed.to_bits() - 1);
            assert!(square(v) >= square(Vec2::new(min_speed, Fx::ZERO)), "case {case}: {v} is slower than {max_speed}");
            let cross = i128::from(v.x.to_bits()) * i128::from(velocity.y.to_bits())
                - i128::from(v.y.to_bits()) * i128::from(velocity.x.to_bits());
            assert!(cross.unsigned_abs().pow(2) <= square(velocity), "case {case}: {v} is not along {velocity}");
        }
        assert_eq!(w.abs(), spin.abs().min(max_speed));
        assert!(w == Fx::ZERO || (w > Fx::ZERO) == (spin > Fx::ZERO));
    }
    assert!(slowed > cases / 8 && over > 0, "{slowed} of {cases} slowed, {over} a part of an ulp above");
}

#[test]
fn a_capped_body_falls_at_its_cap_in_every_integrator() {
    for integrator in Integrator::ALL {
        let mut world = world(integrator, vec2(6, -8));
        let body = world.add_body(capped(fx!(5), fx!(2))).expect("a body");
        let coupled = world.add_body(BodyDef { position: vec2(0, 9), ..capped(fx!(5), fx!(2)) }).expect("a body");
        world
            .add_field(FieldKind::Thrust { at: umbra_physics::Attachment::centre(coupled), force: vec2(0, 0) })
            .expect("one");
        for _ in 0..120 {
            world.apply_torque(body, fx!(10)).expect("a torque");
            world.apply_torque(coupled, fx!(10)).expect("a torque");
            world.step();
        }
        for id in [body, coupled] {
            let now = world.body(id).expect("it is there");
            assert_eq!((now.velocity(), now.angular_velocity()), (vec2(3, -4), fx!(2)), "{integrator:?}");
            assert_eq!((now.max_speed(), now.max_angular_speed()), (Some(fx!(5)), Some(fx!(2))));
        }
        // Taken away, it goes on as it likes.
        world.set_max_speeds(body, None, None).expect("it is there");
        (0..3).for_each(|_| _ = world.step());
        assert!(world.body(body).expect("it is there").velocity().x > fx!(3));
    }
}

#[test]
fn an_impulse_is_felt_for_a_step() {
    let mut world = world(Integrator::VelocityVerlet, Vec2::ZERO);
    let body = world.add_body(capped(fx!(1), fx!(1))).expect("a body");
    world.apply_impulse(body, vec2(60, 0)).expect("an impulse");
    assert_eq!(world.body(body).expect("it is there").velocity(), vec2(60, 0));
    world.step();
    let now = world.body(body).expect("it is there");
    assert_eq!((now.position(), now.velocity()), (vec2(1, 0), vec2(1, 0)));
}

/// A body that is too fast during the step, but not after it was slowed down, stays in the world.
#[test]
fn the_envelope_is_for_what_is_left() {
    let mut world = world(Integrator::VelocityVerlet, Vec2::ZERO);
    let def = BodyDef { velocity: vec2(1 << 20, 0), ..capped(fx!(10), fx!(10)) };
    let [slowed, lost] = [def.clone(), BodyDef { max_speed: None, ..def }].map(|def| world.add_body(def).expect("one"));
    for body in [slowed, lost] {
        world.apply_force(body, vec2(60_000, 0)).expect("a force");
    }
    let faults: Vec<BodyId> = world.step().faults.iter().map(|fault| fault.body).collect();
    assert_eq!(faults, [lost]);
    assert_eq!(world.body(slowed).expect("it is there").velocity(), vec2(10, 0));
    assert_eq!(world.body(slowed).expect("it is there").activity(), Activity::Awake);
}

#[test]
fn caps_are_for_dynamic_bodies_and_nobody_else_notices() {
    let run = |is_capped: bool| {
        let mut world = world(Integrator::VelocityVerlet, vec2(0, -10));
        let ids: Vec<BodyId> = (0..300)
            .map(|i| {
                // A kinematic one is not slowed down by any.
                let kind = if i % 2 == 1 { BodyKind::Kinematic } else { BodyKind::Dynamic };
                let max_speed = match kind {
                    BodyKind::Kinematic => Some(fx!(0)),
                    _ => (is_capped && i % 7 == 0).then_some(fx!(2)),
                };
                let (position, velocity) = (vec2(i, 0), vec2(i % 5, 1));
                let def = BodyDef { kind, position, velocity, angular_velocity: fx!(3), ..BodyDef::dynamic() };
                world.add_body(BodyDef { max_speed, max_angular_speed: max_speed, ..def }).expect("a body")
            })
            .collect();
        (0..60).for_each(|_| _ = world.step());
        ids.into_iter()
            .map(|id| {
                let body = world.body(id).expect("it is there");
                let (x, v) = (body.position_exact(), body.velocity_exact());
                (x.map(FxAccumulator::to_bits), v.map(FxAccumulator::to_bits), body.angle_exact().to_bits())
            })
            .collect::<Vec<_>>()
    };
    for (i, (with, without)) in run(true).iter().zip(run(false)).enumerate() {
        assert_eq!(*with == without, !(i % 7 == 0 && i % 2 == 0), "body {i}");
    }
}

#[test]
fn locked_axes_stay_still_and_the_rest_is_capped() {
    let mut world = world(Integrator::VelocityVerlet, vec2(100, -100));
    let locks = Locks { y: true, ..Locks::NONE };
    let body = world.add_body(BodyDef { locks, ..capped(fx!(3), fx!(1)) }).expect("a body");
    (0..60).for_each(|_| _ = world.step());
    let now = world.body(body).expect("it is there");
    assert_eq!((now.velocity(), now.position().y), (vec2(3, 0), fx!(0)));
}

#[test]
fn a_world_with_a_cap_has_no_way_back() {
    let mut world = world(Integrator::VelocityVerlet, vec2(0, -10));
    let free = world.add_body(BodyDef::dynamic()).expect("a body");
    let kinematic = BodyDef { kind: BodyKind::Kinematic, ..capped(fx!(9), fx!(9)) };
    let rail = world.add_body(kinematic).expect("a body");
    world.step();
    let applied = world.last_report().applied.to_vec();
    assert_eq!(world.clone().step_back(&applied), Ok(()), "a kinematic body is not capped");
    for (linear, angular) in [(Some(fx!(9)), None), (None, Some(fx!(9)))] {
        world.set_max_speeds(free, linear, angular).expect("it is there");
        let before = world.state_hash();
        let refused = Err(Error::NotReversible { why: Irreversible::Capped });
        assert_eq!(world.step_back(&[]), refused);
        assert_eq!(world.state_hash(), before);
    }
    world.set_max_speeds(free, None, None).expect("it is there");
    assert_eq!(world.clone().step_back(&[]), Ok(()));
    world.set_kind(rail, BodyKind::Dynamic).expect("it has a mass");
    assert_eq!(world.step_back(&[]), Err(Error::NotReversible { why: Irreversible::Capped }));
    world.remove_body(rail).expect("it is there");
    assert_eq!(world.step_back(&[]), Ok(()));
}

/// Along an axis the rounded factor would leave one in two of these above the limit, by less than an ulp; a push of less than
/// an ulp takes those there that are at the limit in public.
#[test]
fn a_velocity_capped_at_the_largest_speed_limit_never_exceeds_it() {
    for integrator in Integrator::ALL {
        for (gravity, push) in [(6_000, Fx::ZERO), (0, Fx::DELTA)] {
            let mut world = world(integrator, vec2(gravity, 0));
            for i in 0..64 {
                let velocity = Vec2::new(limits::SPEED - Fx::from_bits(i * 5_000_000_011), Fx::ZERO);
                let position = vec2(-(1 << 24), i as i32);
                world.add_body(BodyDef { position, velocity, ..capped(limits::SPEED, fx!(1)) }).expect("a body");
            }
            let fastest = world.bodies().next().expect("there are some").id();
            for _ in 0..40 {
                world.apply_force(fastest, Vec2::new(push, Fx::ZERO)).expect("it is dynamic");
                assert_eq!(world.step().faults, []);
            }
            assert_eq!(world.body(fastest).expect("it is there").velocity().x, limits::SPEED);
        }
    }
}

#[test]
fn the_limits_of_speeds_are_caps() {
    let mut world = world(Integrator::VelocityVerlet, Vec2::ZERO);
    let def = BodyDef { velocity: Vec2::new(limits::SPEED, limits::SPEED), ..capped(limits::SPEED, Fx::ZERO) };
    let body = world.add_body(BodyDef { angular_velocity: limits::ANGULAR_SPEED, ..def }).expect("a body");
    assert_eq!(world.step().faults, []);
    let now = world.body(body).expect("it is there");
    // 2^20/√2 m/s each.
    let component = Fx::from_bits(3_184_525_836_262_886);
    assert!(now.velocity().x.to_bits().abs_diff(component.to_bits()) <= 1 && now.velocity().x == now.velocity().y);
    assert_eq!(now.angular_velocity(), Fx::ZERO);
}
