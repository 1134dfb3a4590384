//! Motor joints in worlds.

use super::scenes::{assert_images_and_copies, chain, falling, point_mass, steps, still};
use umbra_physics::scalar::ToF64;
use umbra_physics::{
    Attachment, BodyDef, BodyId, Distance, End, Error, Fx, JointDef, JointId, JointKind, JointLimits, JointMotor,
    JointSpring, Mass, Motor, PlanarMotor, PlanarSpring, Quantity, Random, Revolute, Shape, Vec2, World, fx, vec2,
};

fn solid(mass: i32) -> Mass {
    Mass::Explicit { mass: Fx::from(mass), inertia: Fx::from(mass) }
}

/// A joint from the origin of the world to the centre of a body.
fn hold(world: &mut World, body: BodyId, motor: Motor) -> JointId {
    let ends = [End::World(vec2(0, 0)), End::Body(Attachment::centre(body))];
    world.add_joint(JointDef::new(ends, JointKind::Motor(motor))).expect("a joint")
}

fn position(world: &World, body: BodyId) -> Vec2 {
    world.body(body).expect("a body").position()
}

/// Momentum along x and y, and angular momentum.
fn momenta(world: &World) -> [f64; 3] {
    let Vec2 { x, y } = world.momentum().expect("a momentum");
    [x, y, world.angular_momentum().expect("an angular momentum")].map(ToF64::to_f64)
}

fn assert_near(vector: Vec2, expected: Vec2, error: Fx) {
    assert!((vector - expected).length() < error, "{vector} is not {expected}");
}

/// Without damping a body swings about the point at rest, along a line, with the period that was asked for.
#[test]
fn a_spring_swings_in_its_period() {
    let mut world = still();
    let body = world.add_body(BodyDef { mass: solid(3), ..BodyDef::dynamic() }).expect("a body");
    let spring = Some(PlanarSpring::new(vec2(3, 4), fx!(0.5), fx!(0)));
    let joint = hold(&mut world, body, Motor { spring, ..Motor::default() });
    for (ticks, part) in [(60, fx!(2)), (60, fx!(0)), (60, fx!(2)), (3_600, fx!(2))] {
        steps(&mut world, ticks);
        assert_near(position(&world, body), vec2(3, 4) * part, fx!(0.005));
        assert_eq!(world.joint(joint).expect("a joint").offset(), position(&world, body));
    }
}

/// Critical damping: the distance is (1 + ωt)·e^(−ωt) of its start.
#[test]
fn a_damped_spring_decays() {
    let mut world = still();
    let body = world.add_body(BodyDef { mass: solid(3), ..BodyDef::dynamic() }).expect("a body");
    let spring = Some(PlanarSpring::new(vec2(-4, 3), fx!(0.5), fx!(1)));
    hold(&mut world, body, Motor { spring, ..Motor::default() });
    steps(&mut world, 60);
    // (1 + π)·e^−π for t = 1 s and ω = π/s.
    let left = fx!(0.178968);
    // Sub-steps are Euler's: half of one at the speed of 2.13 m/s.
    assert_near(position(&world, body), vec2(-4, 3) * (fx!(1) - left), fx!(0.004));
}

/// A target far away pulls with its largest force in its direction, not with as much along each axis.
#[test]
fn the_largest_force_is_the_length_of_a_vector() {
    let mut world = still();
    let body = world.add_body(BodyDef { mass: solid(2), ..BodyDef::dynamic() }).expect("a body");
    let joint = hold(&mut world, body, Motor::target(vec2(300, 400), fx!(5), fx!(1), fx!(20)));
    steps(&mut world, 60);
    assert_near(world.body(body).expect("a body").velocity(), vec2(6, 8), fx!(0.00001));
    // A straight line; half a sub-step more than 5 m.
    assert_near(position(&world, body), vec2(fx!(3.01), fx!(4.01333)), fx!(0.0001));
    assert_near(world.joint(joint).expect("a joint").force(), vec2(12, 16), fx!(0.000001));
}

/// Friction of a ground that is seen from above: a body stops where it should, in its direction, and stays there against a smaller force.
#[test]
fn friction_stops_a_body_in_its_direction() {
    let mut world = still();
    let body = BodyDef { mass: solid(2), velocity: vec2(3, -4), angular_velocity: fx!(2), ..BodyDef::dynamic() };
    let body = world.add_body(body).expect("a body");
    let joint = hold(&mut world, body, Motor::friction(fx!(10), fx!(2)));
    steps(&mut world, 50);
    // 5 m/s against 5 m/s².
    let velocity = world.body(body).expect("a body").velocity();
    assert_near(velocity, vec2(3, -4) / 6, fx!(0.00001));
    assert_near(world.joint(joint).expect("a joint").force(), vec2(-6, 8), fx!(0.0001));
    steps(&mut world, 11);
    assert_near(position(&world, body), vec2(fx!(1.5), -2), fx!(0.01));
    assert_near(world.body(body).expect("a body").velocity(), vec2(0, 0), fx!(0.000002));
    let place = position(&world, body);
    for _ in 0..600 {
        world.apply_force(body, vec2(7, 7)).expect("a force");
        world.step();
    }
    assert_near(position(&world, body), place, fx!(0.00001));
    // 10.01 N.
    for _ in 0..60 {
        world.apply_force(body, vec2(fx!(-6.006), fx!(8.008))).expect("a force");
        world.step();
    }
    assert_near(world.body(body).expect("a body").velocity(), vec2(fx!(-0.003), fx!(0.004)), fx!(0.0002));
}

/// A spring pulls a body until friction holds it, where k·x = F.
#[test]
fn a_spring_pulls_until_friction_holds() {
    let mut world = still();
    let body = world.add_body(BodyDef { mass: solid(1), position: vec2(3, 4), ..BodyDef::dynamic() }).expect("a body");
    let spring = PlanarSpring::new(vec2(0, 0), fx!(0.5), fx!(1));
    let motor = Some(PlanarMotor { velocity: vec2(0, 0), max_force: fx!(10) });
    let joint = hold(&mut world, body, Motor { spring: Some(spring), motor, ..Motor::default() });
    world.set_sleep_after(None).expect("a number");
    steps(&mut world, 600);
    // k = (2πf)² = π² N/m.
    let reach = fx!(10) / (Fx::PI * Fx::PI);
    let place = position(&world, body);
    assert_near(place, vec2(fx!(0.6), fx!(0.8)) * reach, fx!(0.0002));
    steps(&mut world, 600);
    assert_near(position(&world, body), place, fx!(0.0002));
    // A weak spring: friction keeps all of it.
    let weak = PlanarSpring { max_force: Some(fx!(9.9)), ..spring };
    world
        .set_joint_kind(joint, JointKind::Motor(Motor { spring: Some(weak), motor, ..Motor::default() }))
        .expect("a kind");
    let far = world.set_position(body, vec2(30, 40));
    far.expect("a position");
    steps(&mut world, 60);
    assert_near(position(&world, body), vec2(30, 40), fx!(0.00001));
}

/// Another end that moves and turns carries the second one along, with no loss of momentum.
#[test]
fn an_offset_turns_with_the_first_body() {
    let mut world = still();
    let ship = BodyDef { mass: solid(50), angular_velocity: fx!(1), velocity: vec2(1, 0), ..BodyDef::dynamic() };
    let ship = world.add_body(ship).expect("a body");
    let drone = BodyDef { mass: solid(1), position: vec2(1, 2), ..BodyDef::dynamic() };
    let drone = world.add_body(drone).expect("a body");
    let motor = Motor {
        spring: Some(PlanarSpring::new(vec2(2, 0), fx!(4), fx!(1))),
        angular_spring: Some(JointSpring { rest: fx!(0.5), ..JointSpring::new(fx!(4), fx!(1)) }),
        ..Motor::default()
    };
    let ends = [ship, drone].map(|body| End::Body(Attachment::centre(body)));
    let joint = world.add_joint(JointDef::new(ends, JointKind::Motor(motor))).expect("a joint");
    let before = momenta(&world);
    steps(&mut world, 300);
    let joint = world.joint(joint).expect("a joint");
    // 1 kg at 2 m and 1 rad/s needs 2 N of a spring of (8π)² N/m.
    assert_near(joint.offset(), vec2(fx!(2.0031), 0), fx!(0.001));
    assert!((joint.angle() - fx!(0.5)).abs() < fx!(0.001), "{}", joint.angle());
    for (before, after) in before.into_iter().zip(momenta(&world)) {
        assert!((after - before).abs() < 1e-6 * before.abs().max(1.0), "{before} {after}");
    }
}

/// Points that move apart by metres within a step: the arm of the first body reaches to where the point is then, so no momentum is lost.
#[test]
fn fast_ends_keep_their_momenta() {
    for speed in [10, 60, 80, 100, 200, 500] {
        let mut world = still();
        let ship = world.add_body(BodyDef { mass: solid(50), ..BodyDef::dynamic() }).expect("a body");
        let (position, velocity) = (Vec2::new(fx!(0.1), fx!(-0.1)), vec2(0, speed));
        let drone = BodyDef { mass: solid(1), position, velocity, ..BodyDef::dynamic() };
        let drone = world.add_body(drone).expect("a body");
        let spring = Some(PlanarSpring::new(vec2(2, 0), fx!(4), fx!(1)));
        let ends = [ship, drone].map(|body| End::Body(Attachment::centre(body)));
        let kind = JointKind::Motor(Motor { spring, ..Motor::default() });
        world.add_joint(JointDef::new(ends, kind)).expect("a joint");
        let before = momenta(&world);
        steps(&mut world, 60);
        for (before, after) in before.into_iter().zip(momenta(&world)) {
            println!("{speed} m/s: {before} {after}");
            assert!((after - before).abs() < 1e-5 * before.abs().max(1.0), "{speed} m/s: {before} {after}");
        }
    }
}

/// Motors give velocities in the frame of the first end, and a speed of turning.
#[test]
fn motors_reach_their_velocities() {
    let mut world = still();
    let body = world.add_body(BodyDef { mass: solid(2), ..BodyDef::dynamic() }).expect("a body");
    let ends = [End::World(vec2(0, 0)), End::Body(Attachment::centre(body))];
    let motor = Motor {
        motor: Some(PlanarMotor { velocity: vec2(1, 0), max_force: fx!(10) }),
        angular_motor: Some(JointMotor { speed: fx!(-3), max_force: fx!(100) }),
        ..Motor::default()
    };
    // The x axis of the frame is up.
    let angles = [Fx::FRAC_PI_2, fx!(0)];
    world.add_joint(JointDef { angles, ..JointDef::new(ends, JointKind::Motor(motor)) }).expect("a joint");
    steps(&mut world, 60);
    let body = world.body(body).expect("a body");
    assert_near(body.velocity(), vec2(0, 1), fx!(0.00001));
    assert!((body.angular_velocity() + fx!(3)).abs() < fx!(0.00001));
}

/// From rest to thousands of metres and radians a second within a step: motors have their speeds to the last bits, and a critically damped spring
/// has the speed of its closed form.
#[test]
fn forces_beyond_measure_speed_a_body_up_at_once() {
    let max_force = fx!(1_000_000_000);
    let run = |motor: Motor| {
        let mut world = still();
        let body = world.add_body(BodyDef { mass: solid(1), ..BodyDef::dynamic() }).expect("a body");
        hold(&mut world, body, motor);
        steps(&mut world, 2);
        let body = world.body(body).expect("a body");
        (body.velocity(), body.angular_velocity())
    };
    let far = vec2(3_000, -4_000);
    let motor = Some(PlanarMotor { velocity: far, max_force });
    let (velocity, _) = run(Motor { motor, ..Motor::default() });
    assert_near(velocity, far, fx!(0.000001));
    let (_, spin) =
        run(Motor { angular_motor: Some(JointMotor { speed: fx!(10_000), max_force }), ..Motor::default() });
    assert!((spin - fx!(10_000)).abs() < fx!(0.000001), "{spin}");
    // x·ω²t·e^(−ωt) for ω = 20π/s and t = 1/30 s.
    let (velocity, _) = run(Motor { spring: Some(PlanarSpring::new(far, fx!(10), fx!(1))), ..Motor::default() });
    assert_near(velocity, far * fx!(16.2073), fx!(500));
}

/// A mouse drags the end of a chain that hangs on the world: the hinges hold, and the end comes no farther than the chain is long.
#[test]
fn a_mouse_drags_a_chain() {
    let mut world = falling();
    let (bodies, joints) = chain(&mut world, 8);
    let hand = bodies[7];
    let ends = [End::World(vec2(0, 0)), End::Body(Attachment { body: hand, point: vec2(fx!(0.5), 0) })];
    let grab = |point: Vec2| JointKind::Motor(Motor::target(point, fx!(5), fx!(1), fx!(2_000)));
    let mouse = world.add_joint(JointDef::new(ends, grab(vec2(8, 0)))).expect("a joint");
    let mut gap = fx!(0);
    for (tick, point) in (0..600).zip([vec2(20, 3), vec2(-5, 2), vec2(0, -9), vec2(4, 4)].into_iter().cycle()) {
        if tick % 60 == 0 {
            world.set_joint_kind(mouse, grab(point)).expect("a kind");
        }
        world.step();
        gap = joints.iter().map(|&joint| world.joint(joint).expect("a joint").length()).fold(gap, Fx::max);
    }
    assert!(gap < fx!(0.01), "{gap}");
    let handle = world.joint(mouse).expect("a joint").points()[1];
    assert!(handle.length() < fx!(8.05), "{handle}");
}

/// A mouse with friction pulls the end of a chain whose hinges have limits, motors and friction, by a seed. Returns the world, the mouse and its bound.
fn mouse_at_a_chain(seed: u64, has_brace: bool, has_floor: bool) -> (World, JointId, Fx) {
    let mut random = Random::seeded(seed);
    let mut number = |range| random.integer(range) as i32;
    let mut world = falling();
    if has_floor {
        let floor = BodyDef::fixed().with_collider(Shape::rectangle(40, 1).expect("a shape"));
        world.add_body(BodyDef { position: vec2(0, fx!(-0.62)), ..floor }).expect("a body");
    }
    let count = number(2..=5);
    let (bodies, joints) = chain(&mut world, count);
    for joint in joints {
        let limits = (number(0..=2) > 0).then(|| JointLimits::degrees(-number(1..=40), number(1..=40)));
        let motor =
            (number(0..=1) > 0).then(|| JointMotor { speed: number(-3..=3).into(), max_force: number(1..=60).into() });
        let friction = Fx::from(number(0..=1) * number(1..=30));
        let kind = JointKind::Revolute(Revolute { limits, motor, friction, ..Revolute::default() });
        world.set_joint_kind(joint, kind).expect("a kind");
    }
    let hand = bodies[count as usize - 1];
    if has_brace {
        let ends = [bodies[0], hand].map(|body| End::Body(Attachment::centre(body)));
        let kind = JointKind::Distance(Distance::rod(Fx::from(count - 1)));
        world.add_joint(JointDef::new(ends, kind)).expect("a joint");
    }
    let max_force = Fx::from(number(1..=60));
    let motor = Some(PlanarMotor { velocity: vec2(0, 0), max_force });
    let target = vec2(number(-5..=5), number(-3..=5));
    let mouse = Motor { motor, ..Motor::target(target, number(1..=8).into(), fx!(1), max_force) };
    let ends = [End::World(vec2(0, 0)), End::Body(Attachment { body: hand, point: vec2(fx!(0.5), 0) })];
    let mouse = world.add_joint(JointDef::new(ends, JointKind::Motor(mouse))).expect("a joint");
    (world, mouse, max_force)
}

/// Rows move on until the last round of a pass: alone; with a brace from the first bar to the last one, in a loop; on a floor, so that there is a relax
/// pass. A mouse pulls with no more than both its bounds.
#[test]
fn a_mouse_keeps_to_its_bounds_where_other_rows_move_on() {
    for (has_brace, has_floor) in [(false, false), (true, false), (false, true), (true, true)] {
        for seed in 0..100 {
            let (mut world, mouse, max_force) = mouse_at_a_chain(seed, has_brace, has_floor);
            for tick in 0..60 {
                world.step();
                let force = world.joint(mouse).expect("a joint").force().length();
                assert!(
                    force < max_force * fx!(2.0001),
                    "{has_brace} {has_floor} seed {seed} tick {tick}: {force} of {max_force}"
                );
            }
        }
    }
}

/// Too heavy for the mouse: a body of 1,000 kg stays on the ground.
#[test]
fn a_mouse_does_not_lift_what_is_too_heavy() {
    let mut world = falling();
    let ground = BodyDef::fixed().with_collider(Shape::rectangle(20, 1).expect("a shape"));
    world.add_body(BodyDef { position: vec2(0, fx!(-0.5)), ..ground }).expect("a body");
    let stone = BodyDef::dynamic().with_collider(Shape::rectangle(1, 1).expect("a shape"));
    let stone = BodyDef { mass: solid(1_000), position: vec2(0, fx!(0.5)), ..stone };
    let stone = world.add_body(stone).expect("a body");
    hold(&mut world, stone, Motor::target(vec2(0, 5), fx!(5), fx!(1), fx!(9_900)));
    steps(&mut world, 300);
    assert_near(position(&world, stone), vec2(0, fx!(0.5)), fx!(0.003));
}

/// Images and copies of worlds with motor joints, in trees and in loops, go on in the same bits.
#[test]
fn images_and_copies_go_on_in_the_same_bits() {
    assert_images_and_copies(|| {
        let mut world = falling();
        let (bodies, _) = chain(&mut world, 4);
        let ends = [End::World(vec2(1, 1)), End::Body(Attachment { body: bodies[3], point: vec2(fx!(0.5), 0) })];
        let kind = JointKind::Motor(Motor::target(vec2(3, 4), fx!(3), fx!(0.5), fx!(300)));
        world.add_joint(JointDef { angles: [fx!(0), fx!(1)], ..JointDef::new(ends, kind) }).expect("a joint");
        let free = point_mass(&mut world, vec2(6, 6));
        let motor = Motor {
            spring: Some(PlanarSpring { max_force: Some(fx!(50)), ..PlanarSpring::new(vec2(2, 1), fx!(2), fx!(0.2)) }),
            motor: Some(PlanarMotor { velocity: vec2(1, 2), max_force: fx!(3) }),
            angular_spring: Some(JointSpring::new(fx!(1), fx!(0.1))),
            angular_motor: Some(JointMotor { speed: fx!(1), max_force: fx!(1) }),
        };
        let ends = [bodies[0], free].map(|body| End::Body(Attachment::centre(body)));
        world.add_joint(JointDef::new(ends, JointKind::Motor(motor))).expect("a joint");
        // A loop of three bodies.
        let [a, b, c] = [vec2(-5, 5), vec2(-4, 5), vec2(-4, 6)].map(|at| {
            let body = BodyDef { mass: solid(2), position: at, ..BodyDef::dynamic() };
            world.add_body(body).expect("a body")
        });
        for [first, second] in [[a, b], [b, c], [c, a]] {
            let ends = [first, second].map(|body| End::Body(Attachment::centre(body)));
            world.add_joint(JointDef::new(ends, JointKind::Motor(motor))).expect("a joint");
        }
        hold(&mut world, a, Motor::friction(fx!(5), fx!(1)));
        world
    });
}

/// A body that a motor holds at rest in a frame that turns goes round with it, and one that walks outwards in it is as far out as it has walked:
/// neither drifts by the way on a straight line within a sub-step, which would be 18 cm in the first second.
#[test]
fn a_frame_that_turns_carries_a_body_along() {
    for (spin, walk, ticks, way) in [(fx!(10), fx!(0), 60, fx!(0)), (fx!(5), fx!(1), 120, fx!(2))] {
        let mut world = still();
        let disc = BodyDef { angular_velocity: spin, ..BodyDef::kinematic() };
        let disc = world.add_body(disc).expect("a body");
        let velocity = Vec2::new(walk, spin);
        let rider = BodyDef { mass: solid(1), position: vec2(1, 0), velocity, ..BodyDef::dynamic() };
        let rider = world.add_body(rider).expect("a body");
        let motor = Some(PlanarMotor { velocity: Vec2::new(walk, fx!(0)), max_force: fx!(1_000) });
        let ends = [disc, rider].map(|body| End::Body(Attachment::centre(body)));
        let kind = JointKind::Motor(Motor { motor, ..Motor::default() });
        let joint = world.add_joint(JointDef::new(ends, kind)).expect("a joint");
        steps(&mut world, ticks);
        let joint = world.joint(joint).expect("a joint");
        assert_near(joint.offset(), Vec2::new(fx!(1) + way, fx!(0)), fx!(0.005));
    }
}

/// A body that hangs by a point beside its centre stretches the spring by m·g over the stiffness that the arm leaves, μ·(2πf)² with
/// 1/μ = 1/m + r²/I.
#[test]
fn an_arm_softens_a_spring() {
    let mut world = falling();
    let mass = Mass::Explicit { mass: fx!(2), inertia: fx!(1) };
    let body = world.add_body(BodyDef { mass, position: vec2(0, -1), ..BodyDef::dynamic() }).expect("a body");
    let ends = [End::World(vec2(0, 0)), End::Body(Attachment { body, point: vec2(0, 1) })];
    let spring = Some(PlanarSpring::new(vec2(0, 0), fx!(1), fx!(1)));
    let kind = JointKind::Motor(Motor { spring, ..Motor::default() });
    let joint = world.add_joint(JointDef::new(ends, kind)).expect("a joint");
    world.set_sleep_after(None).expect("a number");
    steps(&mut world, 600);
    // 20 N·(1/2 + 1) 1/kg over 4π² 1/s².
    assert_near(world.joint(joint).expect("a joint").offset(), vec2(0, fx!(-0.759909)), fx!(0.00001));
}

/// Across its arms a spring of two free bodies has the period that was asked for: both arms are to the point that it pulls.
#[test]
fn a_spring_across_its_arms_has_its_period() {
    let mut world = still();
    let ship = world.add_body(BodyDef { mass: solid(4), ..BodyDef::dynamic() }).expect("a body");
    let mass = Mass::Explicit { mass: fx!(2), inertia: fx!(0.5) };
    let drone = BodyDef { mass, position: vec2(fx!(1.5), fx!(0.01)), ..BodyDef::dynamic() };
    let drone = world.add_body(drone).expect("a body");
    let ends = [End::Body(Attachment::centre(ship)), End::Body(Attachment { body: drone, point: vec2(fx!(0.5), 0) })];
    let spring = Some(PlanarSpring::new(vec2(2, 0), fx!(1), fx!(0)));
    let kind = JointKind::Motor(Motor { spring, ..Motor::default() });
    let joint = world.add_joint(JointDef::new(ends, kind)).expect("a joint");
    world.set_sleep_after(None).expect("a number");
    for half_period in 1..=12 {
        steps(&mut world, 30);
        let across = if half_period % 2 == 0 { fx!(0.01) } else { fx!(-0.01) };
        assert_near(world.joint(joint).expect("a joint").offset(), vec2(2, across), fx!(0.0001));
    }
}

/// A strong damper with a bound stops a body within a step, and does not push it back by what is left of the step.
#[test]
fn a_damper_with_a_bound_stops_a_body_within_a_step() {
    for force in [fx!(600), fx!(1_000)] {
        let mut world = still();
        let body = BodyDef { mass: solid(1), velocity: vec2(3, 4), ..BodyDef::dynamic() };
        let body = world.add_body(body).expect("a body");
        let spring = PlanarSpring::new(vec2(0, 0), fx!(0.1), fx!(1_024));
        let spring = Some(PlanarSpring { max_force: Some(force), ..spring });
        hold(&mut world, body, Motor { spring, ..Motor::default() });
        for _ in 0..5 {
            world.step();
            assert_near(world.body(body).expect("a body").velocity(), vec2(0, 0), fx!(0.001));
        }
    }
}

/// A spring turns a body by as many whole turns as its rest is away.
#[test]
fn an_angular_spring_counts_turns() {
    let mut world = still();
    let body = world.add_body(BodyDef { mass: solid(2), ..BodyDef::dynamic() }).expect("a body");
    let spring = JointSpring { rest: Fx::TAU * 3, ..JointSpring::new(fx!(1), fx!(1)) };
    let joint = hold(&mut world, body, Motor { angular_spring: Some(spring), ..Motor::default() });
    world.set_sleep_after(None).expect("a number");
    let mut turned = fx!(0);
    for _ in 0..300 {
        world.step();
        turned += world.body(body).expect("a body").angular_velocity() / 60;
    }
    assert!((world.joint(joint).expect("a joint").angle() - Fx::TAU * 3).abs() < fx!(0.0001));
    assert!((turned - Fx::TAU * 3).abs() < fx!(0.2), "{turned}");
}

/// A spring or a motor that is taken away from a joint pulls no more, and the parts that stay pull on.
#[test]
fn parts_that_are_taken_away_pull_no_more() {
    let mut world = still();
    let body = world.add_body(BodyDef { mass: solid(2), ..BodyDef::dynamic() }).expect("a body");
    let angular_spring =
        Some(JointSpring { max_force: Some(fx!(3)), rest: fx!(100), ..JointSpring::new(fx!(5), fx!(1)) });
    let pull = Motor::target(vec2(300, 400), fx!(5), fx!(1), fx!(20));
    let joint = hold(&mut world, body, Motor { angular_spring, ..pull });
    steps(&mut world, 3);
    let forces = |world: &World| {
        let joint = world.joint(joint).expect("a joint");
        (joint.force(), joint.torque())
    };
    let (force, torque) = forces(&world);
    assert_near(force, vec2(12, 16), fx!(0.00001));
    assert!((torque - fx!(3)).abs() < fx!(0.00001), "{torque}");
    let mut set = |motor: Motor| {
        world.set_joint_kind(joint, JointKind::Motor(motor)).expect("a kind");
        forces(&world)
    };
    assert_eq!(set(pull), (force, fx!(0)));
    assert_eq!(set(Motor { angular_spring, ..Motor::default() }), (vec2(0, 0), fx!(0)));
}

/// Values out of range are refused by name.
#[test]
fn values_out_of_range_are_refused() {
    let spring = PlanarSpring::new(vec2(0, 0), fx!(1), fx!(1));
    let motor = PlanarMotor { velocity: vec2(0, 0), max_force: fx!(1) };
    let far = vec2(0, 1 << 21);
    let cases: [(Motor, Quantity); 6] = [
        (Motor { spring: Some(PlanarSpring { rest: far, ..spring }), ..Motor::default() }, Quantity::JointLength),
        (
            Motor { spring: Some(PlanarSpring { hertz: fx!(-1), ..spring }), ..Motor::default() },
            Quantity::SpringFrequency,
        ),
        (
            Motor { spring: Some(PlanarSpring { damping_ratio: fx!(-1), ..spring }), ..Motor::default() },
            Quantity::DampingRatio,
        ),
        (
            Motor { spring: Some(PlanarSpring { max_force: Some(fx!(-1)), ..spring }), ..Motor::default() },
            Quantity::JointForce,
        ),
        (Motor { motor: Some(PlanarMotor { velocity: far, ..motor }), ..Motor::default() }, Quantity::MotorSpeed),
        (Motor { motor: Some(PlanarMotor { max_force: fx!(-1), ..motor }), ..Motor::default() }, Quantity::JointForce),
    ];
    for (motor, quantity) in cases {
        assert_eq!(JointKind::Motor(motor).check(), Err(Error::OutOfRange { quantity }));
    }
}
