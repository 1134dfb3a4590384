//! Output for a display: poses between ticks, and the drawing of a world.

use std::f64::consts::{PI, TAU};

use umbra_physics::scalar::ToF64;
use umbra_physics::{
    Activity, Attachment, Blend, BodyClass, BodyDef, BodyId, BodyKind, DebugDraw, Distance, DrawOptions, End, FieldId,
    FieldKind, Fx, FxFactor, Interpolation, JointDef, JointKind, JointLimits, Mass, Part, Pose, Prismatic, Region,
    Role, Rollback, Scalar, Shape, Snapshot, SpringConstants, StepClock, TickFraction, TimeStep, Vec2, World, WorldDef,
    fx, vec2,
};

fn world() -> World {
    World::new(WorldDef { sleep_after: None, ..WorldDef::default() }).expect("a fair definition")
}

fn add(world: &mut World, def: BodyDef) -> BodyId {
    world.add_body(def).expect("a fair body")
}

/// 1 m and half a radian a tick.
fn mover() -> BodyDef {
    BodyDef { velocity: vec2(60, 0), angular_velocity: fx!(30), ..BodyDef::dynamic() }
}

fn part(num: u128, den: u128) -> Blend {
    Blend::Interpolated(TickFraction { num, den })
}

fn now<S: Scalar + ToF64>(world: &World<S>, body: BodyId) -> Pose {
    Pose::of(&world.body(body).expect("it is there"))
}

fn step(world: &mut World, interpolation: &mut Interpolation) {
    world.step();
    interpolation.look(world);
}

/// A world with a body that moves, and an interpolation that has seen two ticks of it.
fn watched() -> (World, BodyId, Interpolation) {
    let (mut world, mut interpolation) = (world(), Interpolation::new());
    let body = add(&mut world, mover());
    (0..2).for_each(|_| step(&mut world, &mut interpolation));
    (world, body, interpolation)
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-6
}

/// Returns true if a body is shown at its position, all the way between the last two ticks.
fn is_where_it_is(world: &World, interpolation: &Interpolation, body: BodyId) -> bool {
    let all = [part(0, 1), part(1, 3), part(1, 1)];
    all.iter().all(|&at| interpolation.pose(body, at) == Some(now(world, body)))
}

#[test]
fn a_pose_between_two_ticks_is_exact_at_both_and_half_way_between() {
    let (mut world, body, mut interpolation) = watched();
    let before = now(&world, body);
    step(&mut world, &mut interpolation);
    let after = now(&world, body);
    let at = |num, den| interpolation.pose(body, part(num, den)).expect("it is there");
    assert_eq!((at(0, 1), at(1, 1), at(5, 4)), (before, after, after));
    assert!(near(at(1, 4).position[0], before.position[0] + 0.25) && near(at(1, 4).angle, before.angle + 0.125));
    assert!(near(at(3, 4).position[0], before.position[0] + 0.75));
    // Looking again at the same tick is nothing new.
    interpolation.look(&world);
    assert_eq!(interpolation.pose(body, part(0, 1)), Some(before));
    assert!(interpolation.poses(part(0, 1)).eq([(body, before)]));
    assert_eq!(interpolation.pose(BodyId::from_parts(0, 1), part(0, 1)), None);
}

#[test]
fn the_ends_of_a_blend_are_exact_where_sums_of_doubles_round() {
    let poses = [
        Pose { position: [0.1, -1e9 / 7.0], angle: 0.1 },
        Pose { position: [1e9 / 3.0, 0.7], angle: 6.2 },
        Pose { position: [-1e-9, 1e5 / 3.0], angle: 3.3 },
    ];
    // A half turn has no short way.
    let half = Pose { angle: PI, ..Pose::ORIGIN };
    for (a, b) in [(Pose::ORIGIN, half), (half, Pose::ORIGIN)] {
        assert_eq!([0.0, 0.3, 0.7, 1.0].map(|share| a.between(b, share)), [a, a, a, b]);
    }
    for (a, b) in poses.iter().flat_map(|a| poses.iter().map(move |b| (*a, *b))) {
        assert_eq!((a.between(b, 0.0), a.between(b, 1.0)), (a, b));
        (0..100).for_each(|share| assert_eq!(a.between(a, f64::from(share) / 100.0), a));
    }
    // One addition does not do.
    let [a, b] = [poses[1].position[0], poses[0].position[0]];
    assert_ne!(a + (b - a), b);
}

#[test]
fn beyond_the_last_tick_a_body_goes_on_at_its_velocity() {
    let (mut world, body, mut interpolation) = watched();
    world.set_velocity(body, vec2(0, -120)).expect("it is there");
    step(&mut world, &mut interpolation);
    let (last, half) = (now(&world, body), Blend::Extrapolated(TickFraction { num: 1, den: 2 }));
    let ahead = interpolation.pose(body, half).expect("it is there");
    assert!(near(ahead.position[0], last.position[0]) && near(ahead.position[1], last.position[1] - 1.0));
    assert!(near(ahead.angle, last.angle + 0.25));
    assert_eq!(interpolation.pose(body, Blend::Extrapolated(TickFraction::ZERO)), Some(last));
    // What the world has taken out keeps its velocity, and does not move.
    world.set_position(body, vec2(0, fx!(-1_073_741_824))).expect("it is there");
    step(&mut world, &mut interpolation);
    assert_eq!(world.body(body).expect("it is there").activity(), Activity::Quarantined);
    assert_eq!(interpolation.pose(body, half), Some(now(&world, body)));
}

#[test]
fn angles_take_the_short_way_round() {
    let pose = |angle| Pose { angle, ..Pose::ORIGIN };
    for (from, to, half) in [
        (0.1, 0.3, 0.2),
        (TAU - 0.1, 0.1, 0.0),
        (0.1, TAU - 0.1, 0.0),
        (TAU - 0.3, 0.1, TAU - 0.1),
        (0.3, TAU - 0.1, 0.1),
        (0.0, 3.0, 1.5),
        (3.0, 0.0, 1.5),
        (1.0, 1.0 + PI + 0.1, 1.0 - (PI - 0.1) / 2.0 + TAU),
    ] {
        let angle = pose(from).between(pose(to), 0.5).angle;
        assert!((0.0..TAU).contains(&angle), "{from} to {to}: {angle}");
        let off = (angle - half).abs();
        assert!(off.min(TAU - off) < 1e-12, "{from} to {to}: {angle}");
        assert_eq!((pose(from).between(pose(to), 0.0).angle, pose(from).between(pose(to), 1.0).angle), (from, to));
    }
    // A body over the seam, both ways round.
    for spin in [fx!(30), fx!(-30)] {
        let (mut world, mut interpolation) = (world(), Interpolation::new());
        let body = add(&mut world, BodyDef { angular_velocity: spin, ..BodyDef::dynamic() });
        let mut whole = 0.0;
        for tick in 0..40 {
            interpolation.look(&world);
            if tick > 0 {
                let half = interpolation.pose(body, part(1, 2)).expect("it is there").angle;
                let exact = (whole - 0.25 * f64::from(spin.to_f32()).signum()).rem_euclid(TAU);
                let off = (half - exact).abs();
                assert!(off.min(TAU - off) < 1e-6, "{half} for {exact}");
            }
            world.step();
            whole += 0.5 * spin.to_f64().signum();
        }
    }
}

#[test]
fn nothing_is_blended_over_what_is_no_motion() {
    type Call = fn(&mut World, BodyId);
    let calls: [(Call, bool); 6] = [
        (|world, body| world.set_position(body, vec2(9, 9)).expect("it is there"), true),
        (|world, body| world.set_angle(body, fx!(2)).expect("it is there"), true),
        (|world, body| world.set_kind(body, BodyKind::Kinematic).expect("it is there"), true),
        (|world, _| world.restore(&world.snapshot()), true),
        (|world, body| world.set_velocity(body, vec2(0, 60)).expect("it is there"), false),
        (|world, body| world.set_mass(body, Mass::Kilograms(fx!(2))).expect("it is there"), false),
    ];
    for (i, (call, is_new)) in calls.into_iter().enumerate() {
        let (mut world, body, mut interpolation) = watched();
        let second = add(&mut world, mover());
        step(&mut world, &mut interpolation);
        call(&mut world, body);
        step(&mut world, &mut interpolation);
        assert_eq!(is_where_it_is(&world, &interpolation, body), is_new, "call {i}");
        // A call to one body is none to another.
        assert_eq!(is_where_it_is(&world, &interpolation, second), i == 3, "call {i}");
        // From the next tick on it is as ever.
        step(&mut world, &mut interpolation);
        assert!(!is_where_it_is(&world, &interpolation, body), "call {i}");
    }
}

#[test]
fn a_body_that_is_new_is_where_it_is_also_in_the_slot_of_another() {
    let (mut world, body, mut interpolation) = watched();
    let next = add(&mut world, BodyDef { position: vec2(50, 0), ..mover() });
    step(&mut world, &mut interpolation);
    assert!(is_where_it_is(&world, &interpolation, next) && !is_where_it_is(&world, &interpolation, body));
    world.remove_body(body).expect("it is there");
    let reused = add(&mut world, BodyDef { position: vec2(-50, 0), ..mover() });
    assert_eq!(reused.parts(), (0, 1));
    step(&mut world, &mut interpolation);
    assert!(is_where_it_is(&world, &interpolation, reused) && !is_where_it_is(&world, &interpolation, next));
    assert_eq!(interpolation.pose(body, part(1, 2)), None);
    // One that is gone without another in its place, before others and at the end.
    for gone in [reused, next] {
        world.remove_body(gone).expect("it is there");
        step(&mut world, &mut interpolation);
        assert_eq!(interpolation.pose(gone, part(1, 2)), None);
    }
    assert_eq!(interpolation.poses(part(1, 2)).count(), 0);
    // Slots that were empty for a while have forgotten what they had.
    let [a, b] = [add(&mut world, mover()), add(&mut world, mover())];
    step(&mut world, &mut interpolation);
    assert!(is_where_it_is(&world, &interpolation, a) && is_where_it_is(&world, &interpolation, b));
}

#[test]
fn a_past_that_is_no_more_is_not_blended_from() {
    let (mut world, body, mut interpolation) = watched();
    // The tick that comes next by its number, of another past.
    let saved = world.snapshot();
    step(&mut world, &mut interpolation);
    world.restore(&saved);
    world.set_velocity(body, vec2(0, 0)).expect("it is there");
    (0..2).for_each(|_| _ = world.step());
    interpolation.look(&world);
    assert!(is_where_it_is(&world, &interpolation, body));
    // A step undone, and another in its place.
    world.set_velocity(body, vec2(60, 0)).expect("it is there");
    step(&mut world, &mut interpolation);
    world.step_back(&[]).expect("it has a way back");
    world.set_velocity(body, vec2(0, 60)).expect("it is there");
    step(&mut world, &mut interpolation);
    assert!(is_where_it_is(&world, &interpolation, body));
    // A tick without a look.
    world.step();
    step(&mut world, &mut interpolation);
    assert!(is_where_it_is(&world, &interpolation, body));
    step(&mut world, &mut interpolation);
    assert!(!is_where_it_is(&world, &interpolation, body));
    interpolation.clear();
    assert_eq!(interpolation.pose(body, part(1, 2)), None);
    interpolation.look(&world);
    assert!(is_where_it_is(&world, &interpolation, body));
    interpolation.clear();
    step(&mut world, &mut interpolation);
    assert!(is_where_it_is(&world, &interpolation, body));
}

#[test]
fn a_state_from_elsewhere_is_not_blended_into_if_the_world_becomes_it_or_after_a_clear() {
    type Resync = fn(&mut World, &mut Interpolation, Snapshot);
    let ways: [(Resync, bool); 3] = [
        (|world, _, state| world.restore(&state), true),
        (|world, shown, state| (*world = state.into_world(), shown.clear()).1, true),
        // The same tick, and nothing put back yet in either: it cannot be told from the world before.
        (|world, _, state| *world = state.into_world(), false),
    ];
    for (i, (resync, is_new)) in ways.into_iter().enumerate() {
        let (mut world, body, mut interpolation) = watched();
        let mut host = world.clone();
        host.set_position(body, vec2(500, 0)).expect("it is there");
        let bytes = host.snapshot().to_bytes();
        resync(&mut world, &mut interpolation, Snapshot::from_bytes(&bytes, &[]).expect("it was written so"));
        step(&mut world, &mut interpolation);
        host.step();
        assert_eq!(world.state_hash(), host.state_hash());
        // In the host the body was placed by a call, of which the bytes say nothing.
        assert_eq!(is_where_it_is(&world, &interpolation, body), is_new, "way {i}");
        step(&mut world, &mut interpolation);
        assert!(!is_where_it_is(&world, &interpolation, body), "way {i}");
    }
}

#[test]
fn over_a_rollback_of_two_ticks_motion_goes_on_in_its_new_past() {
    // Looked at as each tick begins, or only when all are made.
    for (looks_in_tick, is_jump) in [(true, false), (false, true)] {
        let (mut world, mut interpolation) = (world(), Interpolation::new());
        let body = add(&mut world, mover());
        let mut rollback = Rollback::new(&world, [0], 8).with_prediction(|_| false);
        for now in 0..6 {
            if now == 5 {
                assert_eq!(rollback.add_input(4, 0, true), Ok(true));
            }
            let tick = |world: &mut World, inputs: &[(u32, bool)]| {
                if looks_in_tick {
                    interpolation.look(world);
                }
                if inputs[0].1 {
                    world.set_velocity(body, vec2(0, 60)).expect("it is there");
                }
            };
            assert_eq!(rollback.advance(&mut world, tick).expect("unchanged").redone, u64::from(now == 5));
            interpolation.look(&world);
        }
        assert_eq!(is_where_it_is(&world, &interpolation, body), is_jump, "{looks_in_tick}");
    }
}

#[test]
fn worlds_of_floats_are_shown_alike() {
    fn shown<S: Scalar + ToF64>() -> [Pose; 2] {
        let mut world: World<S> = World::with_scalar(WorldDef::default()).expect("a fair definition");
        let def = BodyDef {
            velocity: Vec2::new(S::from_fx(fx!(60)), S::ZERO),
            angular_velocity: S::from_fx(fx!(-30)),
            ..BodyDef::dynamic()
        };
        let body = world.add_body(def).expect("a fair body");
        let mut interpolation = Interpolation::new();
        for _ in 0..3 {
            world.step();
            interpolation.look(&world);
        }
        let third = TickFraction { num: 1, den: 3 };
        [Blend::Interpolated(third), Blend::Extrapolated(third)].map(|at| interpolation.pose(body, at).expect("there"))
    }
    let exact = shown::<Fx>();
    assert!(near(exact[0].position[0], 2.0 + 1.0 / 3.0) && near(exact[1].position[0], 3.0 + 1.0 / 3.0));
    for (float, exact) in shown::<f64>().iter().chain(&shown::<f32>()).zip(exact.iter().cycle()) {
        assert!((float.position[0] - exact.position[0]).abs() < 1e-5, "{float:?}");
        assert!((float.angle - exact.angle).abs() < 1e-5, "{float:?}");
    }
}

#[test]
fn the_rest_of_a_frame_in_a_pause_is_shown_unchanged_when_the_time_step_changes() {
    let (mut world, body, mut interpolation) = watched();
    let mut step_clock = StepClock::new(world.def().time_step).expect("that of a world");
    step_clock.frame(12_000_000);
    let shown = |interpolation: &Interpolation, step_clock: &StepClock| {
        interpolation.pose(body, Blend::Extrapolated(step_clock.remainder())).expect("it is there").position[0]
    };
    let before = shown(&interpolation, &step_clock);
    assert!(near(before, now(&world, body).position[0] + 0.72));
    step_clock.set_paused(true);
    world.set_time_step(TimeStep::hz(250)).expect("a fair step");
    step_clock.set_time_step(TimeStep::hz(250)).expect("a fair step");
    interpolation.look(&world);
    // Three ticks, which no frame asks for in a pause.
    assert_eq!((step_clock.frame(1).ticks, step_clock.remainder()), (0, TickFraction { num: 3, den: 1 }));
    assert!(near(shown(&interpolation, &step_clock), before));
    step_clock.set_paused(false);
    for _ in 0..step_clock.frame(0).ticks {
        step(&mut world, &mut interpolation);
    }
    assert!(near(shown(&interpolation, &step_clock), before));
}

/// Record of the drawing calls, in order.
#[derive(Clone, Debug, PartialEq)]
enum Mark {
    Polygon(Vec<[f64; 2]>),
    Segment([[f64; 2]; 2]),
    Point([f64; 2]),
    Circle([f64; 2], f64, Option<[f64; 2]>),
    Capsule([[f64; 2]; 2], f64),
    Arrow([f64; 2], [f64; 2]),
}

#[derive(Default)]
struct Drawn(Vec<(Role, Mark)>);

impl DebugDraw for Drawn {
    fn polygon(&mut self, corners: &[[f64; 2]], role: Role) {
        self.0.push((role, Mark::Polygon(corners.to_vec())));
    }
    fn segment(&mut self, ends: [[f64; 2]; 2], role: Role) {
        self.0.push((role, Mark::Segment(ends)));
    }
    fn point(&mut self, at: [f64; 2], role: Role) {
        self.0.push((role, Mark::Point(at)));
    }
    fn circle(&mut self, centre: [f64; 2], radius: f64, rim: Option<[f64; 2]>, role: Role) {
        self.0.push((role, Mark::Circle(centre, radius, rim)));
    }
    fn capsule(&mut self, ends: [[f64; 2]; 2], radius: f64, role: Role) {
        self.0.push((role, Mark::Capsule(ends, radius)));
    }
    fn arrow(&mut self, from: [f64; 2], to: [f64; 2], role: Role) {
        self.0.push((role, Mark::Arrow(from, to)));
    }
}

/// Drawn with what has to be there alone.
#[derive(Default)]
struct Plain(Vec<Vec<[f64; 2]>>);

impl DebugDraw for Plain {
    fn polygon(&mut self, corners: &[[f64; 2]], _role: Role) {
        self.0.push(corners.to_vec());
    }
    fn segment(&mut self, ends: [[f64; 2]; 2], _role: Role) {
        self.0.push(ends.to_vec());
    }
    fn point(&mut self, at: [f64; 2], _role: Role) {
        self.0.push(vec![at]);
    }
}

/// Rounded to what a test can write down.
fn round(mark: &Mark) -> Mark {
    let number = |x: f64| (x * 1e6).round() / 1e6 + 0.0;
    let point = |p: [f64; 2]| p.map(number);
    match mark.clone() {
        Mark::Polygon(corners) => Mark::Polygon(corners.into_iter().map(point).collect()),
        Mark::Segment(ends) => Mark::Segment(ends.map(point)),
        Mark::Point(at) => Mark::Point(point(at)),
        Mark::Circle(centre, radius, rim) => Mark::Circle(point(centre), number(radius), rim.map(point)),
        Mark::Capsule(ends, radius) => Mark::Capsule(ends.map(point), number(radius)),
        Mark::Arrow(from, to) => Mark::Arrow(point(from), point(to)),
    }
}

fn drawn(
    world: &World,
    pose: impl Fn(&umbra_physics::BodyRef<'_>) -> Pose,
    options: &DrawOptions,
) -> Vec<(Role, Mark)> {
    let mut drawn = Drawn::default();
    world.debug_draw(pose, options, &mut drawn);
    drawn.0.iter().map(|(role, mark)| (*role, round(mark))).collect()
}

/// A quarter turn at (10, 20), whatever the body's own pose.
fn quarter(_: &umbra_physics::BodyRef<'_>) -> Pose {
    Pose { position: [10.0, 20.0], angle: PI / 2.0 }
}

/// The rim of a rounded polygon: five points around each corner, all at the radius from the polygon.
#[test]
fn a_rounded_polygon_is_drawn_with_round_corners() {
    let mut world = world();
    let corners = [vec2(-2, -1), vec2(2, -1), vec2(2, 1), vec2(-2, 1)];
    let shape = Shape::rounded_polygon(&corners, fx!(0.5)).expect("a fair shape");
    add(&mut world, BodyDef::dynamic().with_collider(shape));
    let marks = drawn(&world, quarter, &DrawOptions::default());
    let [(_, Mark::Polygon(rim))] = &marks[..] else { panic!("{marks:?}") };
    assert_eq!(rim.len(), 4 * 5);
    for [x, y] in rim {
        // Turned by a quarter, the polygon is 2 m wide and 4 m high.
        let outside = [(x - 10.0).abs() - 1.0, (y - 20.0).abs() - 2.0].map(|part| part.max(0.0));
        assert!((outside[0].hypot(outside[1]) - 0.5).abs() < 1e-5, "{x}, {y}");
    }
    // The straight parts of its sides.
    for end in
        [[11.5, 22.0], [11.5, 18.0], [8.5, 22.0], [8.5, 18.0], [11.0, 22.5], [9.0, 22.5], [11.0, 17.5], [9.0, 17.5]]
    {
        assert!(rim.contains(&end), "{end:?} in {rim:?}");
    }
}

#[test]
fn each_shape_is_drawn_where_its_pose_is() {
    let shapes: [(Result<Shape, _>, Vec<Mark>); 6] = [
        (Shape::circle(fx!(2)), vec![Mark::Circle([10.0, 20.0], 2.0, Some([10.0, 22.0]))]),
        (
            Shape::rectangle(fx!(4), fx!(2)),
            vec![Mark::Polygon(vec![[11.0, 18.0], [11.0, 22.0], [9.0, 22.0], [9.0, 18.0]])],
        ),
        (Shape::capsule(fx!(4), fx!(1)), vec![Mark::Capsule([[10.0, 18.0], [10.0, 22.0]], 1.0)]),
        (
            Shape::polygon(&[vec2(0, 0), vec2(3, 0), vec2(0, 3)]),
            vec![Mark::Polygon(vec![[11.0, 19.0], [11.0, 22.0], [8.0, 19.0]])],
        ),
        (Shape::segment(vec2(-1, 0), vec2(1, 0)), vec![Mark::Segment([[10.0, 19.0], [10.0, 21.0]])]),
        (
            Shape::compound(&[(-1, fx!(0)), (1, Fx::FRAC_PI_2)].map(|(x, angle)| Part {
                shape: Shape::circle(fx!(0.5)).expect("a fair radius"),
                position: vec2(x, 0),
                angle,
                density: fx!(1),
            })),
            vec![
                Mark::Circle([10.0, 19.0], 0.5, Some([10.0, 19.5])),
                Mark::Circle([10.0, 21.0], 0.5, Some([9.5, 21.0])),
            ],
        ),
    ];
    for (shape, expected) in shapes {
        let mut world = world();
        let body = add(&mut world, BodyDef::dynamic().with_collider(shape.expect("a fair shape")));
        let collider = world.colliders_of(body).expect("it is there").next().expect("its collider");
        let role = Role::Collider(body, collider, BodyClass::Dynamic);
        let expected: Vec<_> = expected.into_iter().map(|mark| (role, mark)).collect();
        assert_eq!(drawn(&world, quarter, &DrawOptions::default()), expected);
    }
}

#[test]
fn fields_come_as_they_were_added_then_bodies_and_then_velocities_by_slot() {
    let mut world = World::new(WorldDef { sleep_after: Some(2), ..WorldDef::default() }).expect("a fair definition");
    let moving = BodyDef { velocity: vec2(0, 3), force_groups: 0, ..BodyDef::dynamic() };
    let gone = add(&mut world, moving.clone());
    let still = BodyDef { force_groups: 0, ..BodyDef::dynamic() };
    let b = add(&mut world, BodyDef { position: vec2(4, 0), ..still.clone() });
    let c = add(&mut world, BodyDef { position: vec2(5, 0), ..BodyDef::fixed() });
    let kinematic = BodyDef { position: vec2(6, 0), velocity: vec2(1, 0), force_groups: 0, ..BodyDef::kinematic() };
    let d = add(&mut world, kinematic);
    let edge = BodyDef { position: vec2(fx!(1_073_741_824), 0), velocity: vec2(60, 0), ..still };
    let e = add(&mut world, edge);
    let f = add(&mut world, BodyDef { position: vec2(7, 0), ..moving.clone() });
    world.disable(f).expect("it is there");
    // The first slot has the body that was added last.
    world.remove_body(gone).expect("it is there");
    let a = add(&mut world, moving.clone());
    assert_eq!((gone.parts(), a.parts()), ((0, 0), (0, 1)));
    (0..2).for_each(|_| _ = world.step());
    let at = |body| Attachment { body, point: vec2(1, 0) };
    let spring = SpringConstants { rest: fx!(1), stiffness: fx!(1), damping: fx!(0) };
    let mu = FxFactor::from_scalar(fx!(1));
    let attractor = |centre| FieldKind::Attractor { centre, mu, softening: fx!(1) };
    let disc = Region::Disc { centre: vec2(7, 7), radius: fx!(2) };
    let box_ = Region::Box { min: vec2(0, 0), max: vec2(4, 2) };
    let mut fields: Vec<FieldId> = Vec::new();
    for law in [
        FieldKind::Spring { near: at(a), far: End::World(vec2(3, 3)), spring },
        attractor(End::World(vec2(-3, 0))),
        attractor(End::Body(at(c))),
        FieldKind::Thrust { at: at(a), force: vec2(0, 5) },
        FieldKind::Zone { region: disc, acceleration: vec2(0, 0) },
        FieldKind::Zone { region: box_, acceleration: vec2(0, -3) },
        FieldKind::Drag { linear: fx!(1), quadratic: fx!(0), wind: vec2(0, 0) },
    ] {
        fields.push(world.add_field(umbra_physics::ForceField { kind: law, force_groups: 2 }).expect("a fair field"));
    }
    // The slot of the first field has the one that was added last.
    let first = fields.remove(0);
    let law = world.field(first).expect("it is there").kind;
    world.remove_field(first).expect("it is there");
    fields.push(world.add_field(umbra_physics::ForceField { kind: law, force_groups: 2 }).expect("a fair field"));
    assert_eq!((first.parts(), fields[6].parts()), ((0, 0), (0, 1)));
    // Half a turn, to see that points of bodies turn with them.
    let pose = |body: &umbra_physics::BodyRef<'_>| Pose {
        position: [f64::from(body.id().parts().0) * 100.0, 0.0],
        angle: if body.id() == a { PI } else { 0.0 },
    };
    let place = |i: i32| [f64::from(i) * 100.0, 0.0];
    let expected = [
        (Role::Attractor(fields[0]), Mark::Point([-3.0, 0.0])),
        (Role::Attractor(fields[1]), Mark::Point([201.0, 0.0])),
        (Role::Thrust(fields[2]), Mark::Arrow([-1.0, 1.0], [-1.0, 0.0])),
        (Role::Zone(fields[3]), Mark::Circle([7.0, 7.0], 2.0, None)),
        (Role::Zone(fields[4]), Mark::Polygon(vec![[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [0.0, 2.0]])),
        (Role::Zone(fields[4]), Mark::Arrow([2.0, 1.0], [2.0, 0.0])),
        (Role::Spring(fields[6]), Mark::Segment([[-1.0, 0.0], [3.0, 3.0]])),
        (Role::Body(a, BodyClass::Dynamic), Mark::Point(place(0))),
        (Role::Body(b, BodyClass::Asleep), Mark::Point(place(1))),
        (Role::Body(c, BodyClass::Static), Mark::Point(place(2))),
        (Role::Body(d, BodyClass::Kinematic), Mark::Point(place(3))),
        (Role::Body(e, BodyClass::Quarantined), Mark::Point(place(4))),
        (Role::Body(f, BodyClass::Disabled), Mark::Point(place(5))),
        (Role::Velocity(a), Mark::Arrow([0.0, 0.0], [0.0, 1.5])),
        (Role::Velocity(d), Mark::Arrow([300.0, 0.0], [300.5, 0.0])),
        (Role::Velocity(e), Mark::Arrow([400.0, 0.0], [430.0, 0.0])),
        (Role::Velocity(f), Mark::Arrow([500.0, 0.0], [500.0, 1.5])),
    ];
    let all = DrawOptions { velocities: Some(0.5), ..DrawOptions::default() };
    assert_eq!(drawn(&world, pose, &all), expected);
    let count = |options: DrawOptions| drawn(&world, pose, &options).len();
    assert_eq!(count(DrawOptions { bodies: false, ..all }), 7 + 4);
    assert_eq!(count(DrawOptions { fields: false, ..all }), 6 + 4);
    assert_eq!(count(DrawOptions::default()), 7 + 6);
}

/// A line between the ends and both ends of each joint, an axis where there is one, at the poses that are given and by the keys of joints.
#[test]
fn joints_are_drawn_by_their_ends_and_axes() {
    let mut world = world();
    let mass = Mass::Explicit { mass: fx!(1), inertia: fx!(1) };
    let [a, b] = [0, 3].map(|x| add(&mut world, BodyDef { position: vec2(x, 0), mass, ..BodyDef::dynamic() }));
    let at = |body, x: i32| End::Body(Attachment { body, point: vec2(x, 0) });
    let ends = [at(a, 1), at(b, -1)];
    let limits = Some(JointLimits { lower: fx!(-1), upper: fx!(3) });
    let rail = Prismatic { limits, ..Prismatic::default() };
    let kinds = [
        JointKind::default(),
        JointKind::Weld(Default::default()),
        JointKind::Distance(Distance::rope(fx!(5))),
        JointKind::Wheel(Default::default()),
        JointKind::Prismatic(rail),
    ];
    // The axis is upwards on the first body.
    let angles = [Fx::FRAC_PI_2, fx!(0)];
    let mut key = 10;
    let joints = kinds.map(|kind| {
        key -= 1;
        world.add_joint(JointDef { angles, key, ..JointDef::new(ends, kind) }).expect("a fair joint")
    });
    let off = JointDef { enabled: false, ..JointDef::new(ends, JointKind::default()) };
    world.add_joint(off).expect("a fair joint");
    let lift = JointDef { angles, ..JointDef::new([End::World(vec2(7, 0)), at(a, 0)], JointKind::Prismatic(rail)) };
    let lift = world.add_joint(lift).expect("a fair joint");
    // The first body is drawn at (10, 20) and the second one at (10, 30), both a quarter turned: its axis points to the left.
    let pose = |body: &umbra_physics::BodyRef<'_>| Pose {
        position: [10.0, if body.id() == a { 20.0 } else { 30.0 }],
        angle: PI / 2.0,
    };
    let (from, to) = ([10.0, 21.0], [10.0, 29.0]);
    let axes = [None, None, None, Some([[10.5, 21.0], [9.5, 21.0]]), Some([[11.0, 21.0], [7.0, 21.0]])];
    let mut expected = vec![
        (Role::Joint(lift), Mark::Segment([[7.0, 0.0], [10.0, 20.0]])),
        (Role::Joint(lift), Mark::Segment([[7.0, -1.0], [7.0, 3.0]])),
        (Role::Joint(lift), Mark::Point([7.0, 0.0])),
        (Role::Joint(lift), Mark::Point([10.0, 20.0])),
    ];
    for (joint, axis) in joints.into_iter().zip(axes).rev() {
        let lines = [Some([from, to]), axis].into_iter().flatten().map(Mark::Segment);
        let marks = lines.chain([from, to].map(Mark::Point));
        expected.extend(marks.map(|mark| (Role::Joint(joint), mark)));
    }
    let options = DrawOptions { bodies: false, ..DrawOptions::default() };
    assert_eq!(drawn(&world, pose, &options), expected);
    assert_eq!(drawn(&world, pose, &DrawOptions { joints: false, ..options }), []);
}

/// A crate of 1 m and 1 kg on a floor whose top is at y = 1, after a second in which it has slid to the right.
fn crate_on_floor() -> (World, [umbra_physics::ColliderId; 2], BodyId) {
    let mut world = World::new(WorldDef { gravity: vec2(0, -10), sleep_after: None, ..WorldDef::default() })
        .expect("a fair definition");
    let square = |size: i32| Shape::rectangle(size, if size > 1 { 2 } else { 1 }).expect("a fair shape");
    let floor = add(&mut world, BodyDef::fixed().with_collider(square(40)));
    let crate_ = BodyDef::dynamic().with_collider(square(1));
    let crate_ = add(&mut world, BodyDef { position: vec2(0, fx!(1.5)), velocity: vec2(8, 0), ..crate_ });
    (0..60).for_each(|_| assert!(world.step().faults.is_empty()));
    let collider = |body| world.colliders_of(body).expect("it is there").next().expect("one");
    let colliders = [collider(floor), collider(crate_)];
    (world, colliders, crate_)
}

/// An arrow of the drawing by its start and its direction.
fn arrows(marks: &[(Role, Mark)], arrow_role: Role) -> Vec<([f64; 2], [f64; 2])> {
    let of_role = marks.iter().filter(|(role, _)| *role == arrow_role);
    of_role
        .map(|(_, mark)| match mark {
            Mark::Arrow(from, to) => (*from, [to[0] - from[0], to[1] - from[1]]),
            mark => panic!("{mark:?}"),
        })
        .collect()
}

#[test]
fn contacts_are_drawn_for_those_who_ask() {
    let (world, colliders, crate_) = crate_on_floor();
    let at = now(&world, crate_);
    let nothing = DrawOptions { bodies: false, fields: false, ..DrawOptions::default() };
    assert_eq!(drawn(&world, Pose::of, &nothing), []);
    assert_eq!(drawn(&world, Pose::of, &DrawOptions::default()).len(), 2, "two bodies alone");

    let points = drawn(&world, Pose::of, &DrawOptions { contacts: true, ..nothing });
    let corners = [at.position[0] - 0.5, at.position[0] + 0.5];
    assert_eq!(points.len(), 2);
    for (role, mark) in &points {
        let Mark::Point([x, y]) = mark else { panic!("{mark:?}") };
        assert_eq!(*role, Role::Contact(colliders));
        assert!(corners.iter().any(|corner| (corner - x).abs() < 0.01) && (y - 1.0).abs() < 0.01, "{x}, {y}");
    }

    let normals = drawn(&world, Pose::of, &DrawOptions { contact_normals: Some(0.25), ..nothing });
    assert_eq!(normals.len(), 2);
    for (_, [dx, dy]) in arrows(&normals, Role::ContactNormal(colliders)) {
        assert!(dx.abs() < 1e-3 && (dy - 0.25).abs() < 1e-6, "{dx}, {dy}");
    }

    // 10 N for 1/300 s, times 30 m for each N·s; friction of 0.6 of it against the motion.
    let impulses = drawn(&world, Pose::of, &DrawOptions { contact_impulses: Some(30.0), ..nothing });
    let along = arrows(&impulses, Role::ContactImpulse(colliders));
    let total: f64 = along.iter().map(|(_, [_, dy])| dy).sum();
    assert!(along.len() == 2 && (total - 1.0).abs() < 1e-3, "{along:?}");
    let friction = arrows(&impulses, Role::FrictionImpulse(colliders));
    let &[(from, [dx, dy])] = &friction[..] else { panic!("{friction:?}") };
    assert!((from[0] - at.position[0]).abs() < 0.01 && (from[1] - 1.0).abs() < 0.01, "{from:?}");
    assert!((dx + 0.6).abs() < 1e-3 && dy.abs() < 1e-3, "{dx}, {dy}");
    assert_eq!(impulses.len(), 3);

    // All of it in one: the bodies first, as without.
    let all = DrawOptions {
        contacts: true,
        contact_normals: Some(0.25),
        contact_impulses: Some(30.0),
        ..DrawOptions::default()
    };
    let all = drawn(&world, Pose::of, &all);
    assert_eq!(all.len(), 2 + 2 + 2 + 3);
    assert_eq!(all[..2], drawn(&world, Pose::of, &DrawOptions::default()));
}

#[test]
fn contacts_are_drawn_where_the_poses_carry_them() {
    let (world, colliders, crate_) = crate_on_floor();
    let options = DrawOptions { bodies: false, contacts: true, ..DrawOptions::default() };
    let still = drawn(&world, Pose::of, &options);
    // The crate is drawn 2 m farther to the right: its contacts in the middle between the two bodies.
    let shifted = |body: &umbra_physics::BodyRef<'_>| {
        let pose = Pose::of(body);
        if body.id() == crate_ { Pose { position: [pose.position[0] + 2.0, pose.position[1]], ..pose } } else { pose }
    };
    let moved = drawn(&world, shifted, &options);
    assert_eq!((still.len(), moved.len()), (2, 2));
    for ((role, a), (_, b)) in still.iter().zip(&moved) {
        let (Mark::Point(a), Mark::Point(b)) = (a, b) else { panic!("{a:?}, {b:?}") };
        assert_eq!(*role, Role::Contact(colliders));
        assert!(near(b[0] - a[0], 1.0) && near(b[1], a[1]), "{a:?}, {b:?}");
    }
    // The world was only read.
    assert_eq!(world.state_hash(), crate_on_floor().0.state_hash());
}

#[test]
fn colliders_are_drawn_at_their_places_ghosts_too() {
    let mut world = world();
    let disc = || Shape::circle(fx!(0.5)).expect("a fair shape");
    let outer = umbra_physics::ColliderDef {
        position: vec2(2, 0),
        angle: Fx::FRAC_PI_2,
        ..umbra_physics::ColliderDef::new(Shape::capsule(2, fx!(0.25)).expect("a fair shape"))
    };
    let ghost = umbra_physics::ColliderDef::ghost(disc());
    let def = BodyDef::dynamic().with_collider(disc()).with_collider(ghost).with_collider(outer);
    let body = add(&mut world, def);
    let colliders: Vec<_> = world.colliders_of(body).expect("it is there").collect();
    let role = |i: usize| Role::Collider(body, colliders[i], BodyClass::Dynamic);
    let circle = Mark::Circle([10.0, 20.0], 0.5, Some([10.0, 20.5]));
    let capsule = Mark::Capsule([[11.0, 22.0], [9.0, 22.0]], 0.25);
    let expected = [(role(0), circle.clone()), (role(1), circle), (role(2), capsule)];
    assert_eq!(drawn(&world, quarter, &DrawOptions::default()), expected);
}

#[test]
fn round_shapes_are_drawn_as_polygons_where_a_renderer_has_no_discs() {
    let draw = |shape: Result<Shape, _>| {
        let mut plain = Plain::default();
        let role = Role::Body(BodyId::from_parts(0, 0), BodyClass::Dynamic);
        let pose = Pose { position: [3.0, 4.0], angle: 1.0 };
        shape.expect("a fair shape").debug_draw(pose, role, &mut plain);
        plain.0
    };
    // Its area by the formula of the surveyor: above zero counter-clockwise.
    let area = |ring: &[[f64; 2]]| {
        let next = ring.iter().cycle().skip(1);
        ring.iter().zip(next).map(|(a, b)| a[0] * b[1] - b[0] * a[1]).sum::<f64>() / 2.0
    };
    let disc = draw(Shape::circle(fx!(2)));
    assert_eq!((disc.len(), disc[0].len()), (2, 48));
    assert!(disc[0].iter().all(|[x, y]| near((x - 3.0).hypot(y - 4.0), 2.0)));
    assert!((area(&disc[0]) / (4.0 * PI) - 1.0).abs() < 0.005);
    assert!(near(disc[1][1][0], 3.0 + 2.0 * 1f64.cos()) && near(disc[1][1][1], 4.0 + 2.0 * 1f64.sin()));
    let capsule = draw(Shape::capsule(fx!(4), fx!(1)));
    assert_eq!((capsule.len(), capsule[0].len()), (1, 50));
    assert!((area(&capsule[0]) / (8.0 + PI) - 1.0).abs() < 0.005);
    let (sin, cos) = 1f64.sin_cos();
    for [x, y] in &capsule[0] {
        let (along, across) = ((x - 3.0) * cos + (y - 4.0) * sin, (y - 4.0) * cos - (x - 3.0) * sin);
        assert!(near((along.abs() - 2.0).max(0.0).hypot(across), 1.0));
    }
}

#[cfg(feature = "mint")]
#[test]
fn poses_and_vectors_are_those_of_mint() {
    fn generic(v: impl Into<mint::Vector2<Fx>> + mint::IntoMint<MintType = mint::Vector2<Fx>>) -> mint::Vector2<Fx> {
        v.into()
    }
    let vector: mint::Vector2<Fx> = vec2(1, 2).into();
    assert_eq!((vector, Vec2::from(vector)), (mint::Vector2 { x: fx!(1), y: fx!(2) }, vec2(1, 2)));
    let point: mint::Point2<Fx> = vec2(3, 4).into();
    assert_eq!((point, Vec2::from(point)), (mint::Point2 { x: fx!(3), y: fx!(4) }, vec2(3, 4)));
    assert_eq!(generic(vec2(1, 2)), vector);
    let pose = Pose { position: [3.0, 4.0], angle: 1.0 };
    assert_eq!(mint::Point2::from(pose), mint::Point2 { x: 3.0, y: 4.0 });
    let mint::ColumnMatrix3 { x, y, z } = pose.into();
    // Column vectors: the axes of the body, and where it is.
    let [[ox, oy], [ax, ay], [bx, by]] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|at| pose.point(at));
    assert!(near(x.x, ax - ox) && near(x.y, ay - oy) && near(y.x, bx - ox) && near(y.y, by - oy));
    assert_eq!([x.z, y.z, z.x, z.y, z.z], [0.0, 0.0, 3.0, 4.0, 1.0]);
    let single: mint::ColumnMatrix3<f32> = pose.to_f32().into();
    assert!(near(single.y.x.into(), y.x) && near(single.x.y.into(), x.y));
    assert_eq!((single.z.x, single.z.y, single.z.z), (3.0, 4.0, 1.0));
}
