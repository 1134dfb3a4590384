//! Readers of a body: points, vectors and velocities against their exact values, applied forces, and the terms of
//! totals.

#[path = "support/random.rs"]
mod random;
#[path = "support/real.rs"]
mod real;

use random::SplitMix;
use real::{PRECISION, Real, TAU, exact, units};
use umbra_physics::scalar::FxSum;
use umbra_physics::{
    ApplyOptions, BodyDef, BodyId, BodyKind, ColliderDef, Error, ForceOrImpulse, Frame, Fx, FxWide, Mass, Quantity,
    Rot, Shape, Turn, Vec2, World, WorldDef, fx, limits, vec2,
};

fn cases() -> usize {
    crate::seeds::times(600)
}

fn number(random: &mut SplitMix, log2: i64) -> Fx {
    let bound = 1 << (32 + random.between(-8, log2));
    Fx::from_bits(random.between(-bound, bound))
}

fn vector(random: &mut SplitMix, log2: i64) -> Vec2 {
    Vec2::new(number(random, log2), number(random, log2))
}

/// Sine and cosine of an angle as it is kept.
fn sin_cos(angle: Turn) -> (Real, Real) {
    (units(angle.to_bits(), 64) * &*TAU).with_precision(PRECISION).value().sin_cos()
}

/// Distance of a number from the exact one, in ulps beyond the half of one rounding, in units of 2^-60 of a length.
fn check(actual: Option<Vec2>, [x, y]: [Real; 2], length: &Real, what: &str) {
    let half = units(1, 33);
    let bound = &half + (length.clone() >> 60);
    match actual {
        Some(actual) => {
            for (actual, right) in [(actual.x, x), (actual.y, y)] {
                let off = exact(actual) - &right;
                let off = if off < units(0, 0) { -off } else { off };
                assert!(off <= bound, "{what}: {actual} for {right}");
            }
        }
        None => {
            // What is refused does not fit, to within the error of what was computed.
            let limit = exact(Fx::MAX) - &bound;
            let beyond = |c: &Real| *c > limit || -c.clone() > limit;
            assert!(beyond(&x) || beyond(&y), "{what}: refused ({x}, {y})");
        }
    }
}

/// At least the length of a vector, at most twice.
fn length(v: [&Real; 2]) -> Real {
    let size = |c: &Real| if *c < units(0, 0) { -c.clone() } else { c.clone() };
    size(v[0]) + size(v[1])
}

#[test]
fn points_and_vectors_are_within_their_bound_of_the_exact_ones() {
    let mut random = SplitMix::seeded(0x0b0d_1e50_0000_0001);
    let mut world = World::new(WorldDef { sleep_after: None, ..WorldDef::default() }).expect("a world");
    let body = world.add_body(BodyDef { velocity: vec2(1, -2), angular_velocity: fx!(3), ..BodyDef::dynamic() });
    let body = body.expect("a body");
    let mut refused = 0;
    for case in 0..cases() {
        let far = if case % 16 == 0 { 30 } else { 20 };
        world.set_position(body, vector(&mut random, far.min(29))).expect("inside");
        world.set_angle(body, number(&mut random, 30)).expect("an angle");
        world.set_velocity(body, vector(&mut random, 19)).expect("inside");
        world.set_angular_velocity(body, number(&mut random, 19)).expect("inside");
        world.step();
        let at = world.body(body).expect("it is there");
        let (sin, cos) = sin_cos(at.angle_exact());
        let (centre, v) = (at.position(), at.velocity());
        let p = if case % 64 == 0 { Vec2::new(Fx::MAX, Fx::MIN) } else { vector(&mut random, far) };
        let [x, y] = [p.x, p.y].map(exact);
        let length_of_point = length([&x, &y]);
        let turned = [&x * &cos - &y * &sin, &x * &sin + &y * &cos];
        check(at.world_vector(p), turned.clone(), &length_of_point, "world_vector");
        let [right, up] = turned;
        match at.world_vector(p) {
            Some(_) => check(
                at.world_point(p),
                [exact(centre.x) + right, exact(centre.y) + up],
                &length_of_point,
                "world_point",
            ),
            None => assert_eq!(at.world_point(p), None),
        }
        if p.y != Fx::MIN {
            check(at.local_vector(p), [&x * &cos + &y * &sin, &y * &cos - &x * &sin], &length_of_point, "local_vector");
        }
        let [x, y] = [&x - exact(centre.x), &y - exact(centre.y)];
        let spin = exact(at.angular_velocity());
        let moves = [exact(v.x) - &spin * &y, exact(v.y) + &spin * &x];
        check(at.velocity_at(p), moves, &units(0, 0), "velocity_at");
        refused += usize::from(at.velocity_at(p).is_none());
        match (p.x.checked_sub(centre.x), p.y.checked_sub(centre.y)) {
            (Some(_), Some(across)) if across != Fx::MIN => {
                let local = [&x * &cos + &y * &sin, &y * &cos - &x * &sin];
                check(at.local_point(p), local, &length([&x, &y]), "local_point");
            }
            _ => assert_eq!(at.local_point(p), None),
        }
    }
    assert!(refused > cases() / 50 && refused < cases() / 2, "{refused} of {} velocities did not fit", cases());
}

fn within(actual: Real, right: &Real, bound: &Real, what: &str) {
    let off = actual - right;
    let off = if off < units(0, 0) { -off } else { off };
    assert!(off <= *bound, "{what}: off by {off}, {bound} allowed");
}

/// The length of a vector.
fn norm(v: &[Real; 2]) -> Real {
    (&v[0] * &v[0] + &v[1] * &v[1]).sqrt()
}

#[test]
fn forces_and_impulses_are_within_their_bounds_of_the_exact_ones() {
    let mut random = SplitMix::seeded(0x0b0d_1e50_0000_0004);
    let wide = |value: FxWide| units(value.to_bits(), 64);
    let mut struck = 0;
    for _ in 0..cases() {
        let mass = Mass::Explicit {
            mass: Fx::from_bits(random.between(1 << 24, 1 << 50)),
            inertia: Fx::from_bits(random.between(1 << 24, 1 << 50)),
        };
        let def =
            BodyDef { mass, angle: number(&mut random, 30), position: vector(&mut random, 20), ..BodyDef::dynamic() };
        let mut world = World::new(WorldDef::default()).expect("a world");
        let body = world.add_body(def).expect("a body");
        let (force, point) = (vector(&mut random, 20), vector(&mut random, 20));
        let (f, p) = ([force.x, force.y].map(exact), [point.x, point.y].map(exact));

        // In the world's frame.
        world.apply_force_at_point(body, force, point).expect("it fits");
        let at = world.body(body).expect("it is there");
        let arm = [&p[0] - exact(at.position().x), &p[1] - exact(at.position().y)];
        let applied = at.applied_force().expect("it fits");
        assert_eq!([wide(applied.x), wide(applied.y)], f);
        let torque = wide(at.applied_torque().expect("it fits"));
        assert_eq!(torque, &arm[0] * &f[1] - &arm[1] * &f[0]);

        // In the body's.
        world.clear_forces();
        let options = ApplyOptions { frame: Frame::Body, ..ApplyOptions::default() };
        world.apply(body, ForceOrImpulse::Force { force, point: Some(point) }, options).expect("it fits");
        let at = world.body(body).expect("it is there");
        let (sin, cos) = sin_cos(at.angle_exact());
        let turned = [&f[0] * &cos - &f[1] * &sin, &f[0] * &sin + &f[1] * &cos];
        let force = at.applied_force().expect("it fits");
        let bound = (norm(&f) >> 60) + units(1, 64);
        within(wide(force.x), &turned[0], &bound, "a force");
        within(wide(force.y), &turned[1], &bound, "a force");
        let (long, strong) = (norm(&p), norm(&f));
        let bound = ((&long * &strong) >> 58) + ((long + strong + units(1, 0)) >> 64);
        let torque = wide(at.applied_torque().expect("it fits"));
        within(torque, &(&p[0] * &f[1] - &p[1] * &f[0]), &bound, "a torque");

        // Impulses, from rest; those that are too large are refused.
        let (impulse, spin) = (vector(&mut random, 12), number(&mut random, 12));
        let Mass::Explicit { mass: kg, inertia } = mass else { unreachable!("it has one") };
        if world.apply_impulse(body, impulse).and_then(|()| world.apply_angular_impulse(body, spin)).is_err() {
            continue;
        }
        struck += 1;
        let at = world.body(body).expect("it is there");
        let (v, spun) = (at.velocity_exact(), at.angular_velocity_exact());
        for (actual, right, relative) in [
            (v.x, exact(impulse.x) / exact(kg), 64),
            (v.y, exact(impulse.y) / exact(kg), 64),
            (spun, exact(spin) / exact(inertia), 58),
        ] {
            let size = if right < units(0, 0) { -right.clone() } else { right.clone() };
            within(units(actual.to_bits(), 96), &right, &((size >> relative) + units(1, 96)), "a change by an impulse");
        }
    }
    assert!(struck > cases() / 2, "{struck} of {} were struck", cases());
}

#[test]
fn a_rotation_in_public_numbers_is_within_its_bound() {
    let mut random = SplitMix::seeded(0x0b0d_1e50_0000_0005);
    for _ in 0..cases() {
        let (angle, v) = (number(&mut random, 10), vector(&mut random, 20));
        let [x, y] = [v.x, v.y].map(exact);
        let (sin, cos) = exact(angle).sin_cos();
        let turned = Rot::from_radians(angle).checked_rotate(v).expect("it fits");
        // Half an ulp each of sine and cosine, times the components.
        let bound = units(1, 33) + ((length([&x, &y]) * units(5_001, 0) / units(10_000, 0)) >> 32);
        within(exact(turned.x), &(&x * &cos - &y * &sin), &bound, "x");
        within(exact(turned.y), &(&x * &sin + &y * &cos), &bound, "y");
    }
}

#[test]
fn a_quarter_turn_is_exact() {
    let mut world = World::new(WorldDef::default()).expect("a world");
    let def = BodyDef { position: vec2(5, -7), velocity: vec2(1, 2), angular_velocity: fx!(3), ..BodyDef::dynamic() };
    let body = world.add_body(def).expect("a body");
    let at = world.body(body).expect("it is there");
    assert_eq!(at.world_point(vec2(2, 3)), Some(vec2(7, -4)));
    assert_eq!(at.local_point(vec2(7, -4)), Some(vec2(2, 3)));
    assert_eq!(at.velocity_at(vec2(7, -4)), Some(vec2(1 - 9, 2 + 6)));
    assert_eq!(at.velocity_at(at.position()), Some(at.velocity()));
    assert_eq!(at.local_vector(Vec2::new(Fx::ZERO, Fx::MIN)), None, "it has no opposite");
    // 2^-32 rad/s times 2^-32 m, a hundred times, is far below an ulp: rounded once, not a hundred times.
    let mut slow = world.clone();
    slow.set_angular_velocity(body, Fx::DELTA).expect("it turns");
    let at = slow.body(body).expect("it is there");
    assert_eq!(at.velocity_at(Vec2::new(fx!(5.5), fx!(-7))), Some(vec2(1, 2)), "half an ulp goes to the even one");
    assert_eq!(at.velocity_at(Vec2::new(fx!(6.5), fx!(-7))).map(|v| v.y), Some(fx!(2) + Fx::DELTA + Fx::DELTA));
}

#[test]
fn the_terms_of_bodies_sum_to_the_totals() {
    let mut random = SplitMix::seeded(0x0b0d_1e50_0000_0002);
    let mut world = World::new(WorldDef { sleep_after: None, ..WorldDef::default() }).expect("a world");
    let kinds = [BodyKind::Dynamic, BodyKind::Dynamic, BodyKind::Dynamic, BodyKind::Kinematic, BodyKind::Static];
    let mut leaver: Option<BodyId> = None;
    for case in 0..40 {
        let kind = kinds[case % 5];
        let moves = kind != BodyKind::Static;
        let def = BodyDef {
            kind,
            position: vector(&mut random, 10),
            velocity: if moves { vector(&mut random, 8) } else { Vec2::ZERO },
            angular_velocity: if moves { number(&mut random, 8) } else { Fx::ZERO },
            colliders: (case % 3 == 0)
                .then(|| ColliderDef::ghost(Shape::circle(fx!(0.5)).expect("a circle")))
                .into_iter()
                .collect(),
            mass: Mass::Kilograms(Fx::from_bits(random.between(1 << 16, 1 << 40))),
            ..BodyDef::dynamic()
        };
        world.add_body(def).expect("a body");
        if case == 20 {
            let def = BodyDef { position: vec2(1_073_741_823, 0), velocity: vec2(900_000, 0), ..BodyDef::dynamic() };
            leaver = world.add_body(def).ok();
        }
    }
    for _ in 0..4 {
        world.step();
        let (mut energy, mut turns) = (FxSum::default(), FxSum::default());
        let mut momentum = Vec2::<FxSum>::default();
        for body in world.bodies() {
            let counts = body.kind() == BodyKind::Dynamic && Some(body.id()) != leaver;
            assert_eq!(body.kinetic_energy() != Ok(FxWide::default()), counts, "{}", body.id());
            energy.add(body.kinetic_energy().expect("it fits"));
            turns.add(body.angular_momentum().expect("it fits"));
            momentum.x.add(body.momentum().x);
            momentum.y.add(body.momentum().y);
        }
        assert_eq!(energy.total(), world.kinetic_energy().ok());
        assert_eq!(turns.total(), world.angular_momentum().ok());
        assert_eq!(momentum.try_map(FxSum::total), world.momentum().ok());
    }
}

/// A value that does not fit into a total does not fit alone either.
#[test]
fn a_term_that_does_not_fit_is_refused() {
    let mut world = World::new(WorldDef::default()).expect("a world");
    let def =
        BodyDef { velocity: vec2(1 << 20, 1 << 20), mass: Mass::Kilograms(limits::MASS_MAX), ..BodyDef::dynamic() };
    let body = world.add_body(def).expect("a body");
    let out = Err(Error::OutOfRange { quantity: Quantity::Total });
    assert_eq!(world.body(body).expect("it is there").kinetic_energy(), out);
    assert_eq!(world.kinetic_energy(), out);
    assert_eq!(world.body(body).expect("it is there").momentum().x.to_string(), (1u64 << 44).to_string());
}

#[test]
fn masses_are_read_as_they_were_given() {
    let mut world = World::new(WorldDef::default()).expect("a world");
    let disc = ColliderDef::ghost(Shape::circle(fx!(0.3)).expect("a circle"));
    let definitions = [
        Mass::Kilograms(fx!(0.1)),
        Mass::Explicit { mass: fx!(0.3), inertia: fx!(0.7) },
        Mass::FromColliders,
        Mass::Explicit { mass: limits::MASS_MIN, inertia: Fx::DELTA },
    ];
    for kind in [BodyKind::Dynamic, BodyKind::Kinematic, BodyKind::Static] {
        for mass in definitions {
            let body = world.add_body(BodyDef { kind, mass, ..BodyDef::dynamic().with_collider(disc.clone()) });
            let body = body.expect("a body");
            assert_eq!(world.body(body).expect("it is there").mass_def(), mass);
            world.set_mass(body, Mass::Explicit { mass: fx!(0.2), inertia: fx!(0.6) }).expect("a mass");
            let restored = umbra_physics::Snapshot::from_bytes(&world.snapshot().to_bytes(), &[]).expect("sound");
            let read = restored.world().body(body).expect("it is there").mass_def();
            assert_eq!(read, Mass::Explicit { mass: fx!(0.2), inertia: fx!(0.6) });
        }
    }
}

/// Exact decimals: the text of a total is the total.
#[test]
fn totals_print_exactly() {
    let mut random = SplitMix::seeded(0x0b0d_1e50_0000_0003);
    for _ in 0..cases() {
        let bits = (i128::from(random.next() as i64) << 64 | i128::from(random.next())) >> random.between(0, 127);
        let text = FxWide::from_bits(bits).to_string();
        let (whole, fraction) = text.split_once('.').unwrap_or((&text, ""));
        let digits: dashu_int::IBig = format!("{whole}{fraction}").parse().expect("a decimal");
        // text · 10^n · 2^64 = bits · 10^n
        let ten = dashu_int::IBig::from(10).pow(fraction.len());
        assert_eq!(digits << 64, dashu_int::IBig::from(bits) * ten, "{text}");
        assert_eq!(Vec2::new(FxWide::from_bits(bits), FxWide::default()).to_string(), format!("({text}, 0)"));
    }
}

#[cfg(feature = "float")]
#[test]
fn floats_read_alike() {
    let mut world: World<f64> = World::with_scalar(WorldDef::default()).expect("a world");
    let def = BodyDef {
        position: Vec2::new(1.0, 2.0),
        angular_velocity: 2.0,
        velocity: Vec2::new(3.0, 4.0),
        ..BodyDef::dynamic()
    };
    let body = world
        .add_body(BodyDef { mass: Mass::Explicit { mass: 3.0, inertia: 5.0 }, angle: 0.5, ..def })
        .expect("a body");
    let at = world.body(body).expect("it is there");
    let outside = at.world_point(Vec2::new(0.25, 0.5)).expect("it fits");
    let back = at.local_point(outside).expect("it fits");
    assert!((back.x - 0.25).abs() < 1e-15 && (back.y - 0.5).abs() < 1e-15);
    assert_eq!(at.velocity_at(Vec2::new(2.0, 4.0)), Some(Vec2::new(3.0 - 4.0, 4.0 + 2.0)));
    assert_eq!(at.velocity_at(Vec2::new(f64::INFINITY, 0.0)), None);
    assert_eq!(at.kinetic_energy(), Ok(0.5 * 3.0 * 25.0 + 0.5 * 5.0 * 4.0));
    assert_eq!(at.momentum(), Vec2::new(9.0, 12.0));
    assert_eq!(at.angular_momentum(), world.angular_momentum());
}
