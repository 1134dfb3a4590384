//! Impacts of joined bodies: a tree takes part as a whole.

use super::scenes::{assert_images_and_copies, bar, falling};
use umbra_physics::scalar::ToF64;
use umbra_physics::{
    BodyDef, BodyId, ColliderDef, Filter, Fx, JointDef, JointKind, Mass, Material, Revolute, Shape, Vec2, Weld, World,
    WorldDef, fx, vec2,
};

/// A chain of three bars, one of them on a weld, that is thrown at a floor beside a crate.
fn thrown() -> World {
    let mut world = falling();
    let floor = BodyDef::fixed().with_collider(Shape::rectangle(20, 1).expect("a shape"));
    world.add_body(BodyDef { position: vec2(0, fx!(-0.5)), ..floor }).expect("a body");
    let cube = BodyDef::dynamic().with_collider(Shape::rectangle(1, 1).expect("a shape"));
    world.add_body(BodyDef { position: vec2(2, fx!(0.5)), ..cube }).expect("a body");
    let bars = [-1, 0, 1].map(|x| {
        let bar = bar(&mut world, vec2(x, 2));
        world.set_velocity(bar, Vec2::new(fx!(4), fx!(-6))).expect("a velocity");
        bar
    });
    for (i, kind) in
        [JointKind::Revolute(Revolute::default()), JointKind::Weld(Weld::default())].into_iter().enumerate()
    {
        let point = Vec2::new(fx!(-0.5) + fx!(1) * i as i32, fx!(2));
        let joint = JointDef::at(&world, bars[i], bars[i + 1], point).expect("a joint");
        world.add_joint(JointDef { kind, ..joint }).expect("a joint");
    }
    world
}

#[test]
fn images_and_copies_of_joined_bodies_have_the_same_impacts() {
    assert_images_and_copies(thrown);
}

/// A wheel of 20 kg in front of a hull that it is joined to, both at 10 m/s, 0.55 m from a wall.
fn crash(hull_mass: Fx, kind: JointKind, restitution: Fx) -> (World, [BodyId; 2]) {
    let mut world = World::new(WorldDef::default()).expect("a world");
    let wall = BodyDef::fixed().with_collider(Shape::rectangle(1, 10).expect("a shape"));
    world.add_body(BodyDef { position: vec2(fx!(0.95), 0), ..wall }).expect("a body");
    let mut part = |x: Fx, shape: Shape, mass: Fx| {
        let material = Material { restitution, ..Material::default() };
        let collider = ColliderDef { material, hit_events: true, ..ColliderDef::new(shape) };
        let body = BodyDef {
            position: Vec2::new(x, fx!(0)),
            velocity: vec2(10, 0),
            colliders: vec![collider],
            ..BodyDef::dynamic()
        };
        world.add_body(BodyDef { mass: Mass::Kilograms(mass), ..body }).expect("a body")
    };
    let wheel = part(fx!(-1), Shape::circle(fx!(0.45)).expect("a shape"), fx!(20));
    let hull = part(fx!(-2), Shape::rectangle(fx!(1), fx!(0.5)).expect("a shape"), hull_mass);
    let joint = JointDef::at(&world, hull, wheel, vec2(-1, 0)).expect("a joint");
    world.add_joint(JointDef { kind, ..joint }).expect("a joint");
    (world, [wheel, hull])
}

/// The horizontal velocities of wheel and hull.
fn speeds(world: &World, bodies: [BodyId; 2]) -> [Fx; 2] {
    bodies.map(|body| world.body(body).expect("a body").velocity().x)
}

/// Runs a crash for a second. Returns the impulse of the first hit, and the widest gap of a joint.
fn run_crash(world: &mut World) -> [Fx; 2] {
    let (mut hits, mut gap) = (Vec::new(), fx!(0));
    for _ in 0..60 {
        hits.extend_from_slice(world.step().hits);
        gap = world.joints().map(|joint| joint.length()).fold(gap, Fx::max);
    }
    [hits[0].normal_impulse, gap]
}

/// Whatever the hull weighs, the first hit has the momentum of both, the joint stays closed, and nothing rebounds. Stopped alone, the wheel would
/// take 200 N·s of 10,200 and the hull push it into the wall; it would rebound with 6.5 m/s (6.4 in Box2D).
#[test]
fn a_wheel_in_front_of_a_hull_stops_it() {
    for mass in [2, 20, 60, 200, 1_000, 20_000] {
        for kind in [JointKind::Weld(Weld::default()), JointKind::Revolute(Revolute::default())] {
            let (mut world, bodies) = crash(Fx::from(mass), kind, fx!(0));
            let [impulse, gap] = run_crash(&mut world);
            let momentum = Fx::from(10 * (mass + 20));
            println!("{mass} kg: {:?}, {impulse} N·s of {momentum}, gap {gap}", speeds(&world, bodies));
            assert!((impulse - momentum).abs() < momentum / 1_000 && gap < fx!(0.0001), "{mass} kg: {impulse}, {gap}");
            assert!(speeds(&world, bodies).into_iter().all(|speed| speed.abs() < fx!(0.001)), "{mass} kg");
        }
    }
}

/// A bar of two halves, welded in the middle or of one piece, flies at two posts at 6 m/s. The posts stand so that the left end is struck within a
/// sub-step and the right end 1.5 ms later.
fn bar_at_posts(is_welded: bool) -> World {
    let mut world = World::new(WorldDef::default()).expect("a world");
    for (x, y) in [(fx!(-0.9), fx!(0.124)), (fx!(0.9), fx!(0.133))] {
        let post = BodyDef::fixed().with_collider(Shape::circle(fx!(0.1)).expect("a shape"));
        world.add_body(BodyDef { position: Vec2::new(x, -y), ..post }).expect("a body");
    }
    let y = fx!(0.1);
    let bar = |x: Fx, width: Fx| {
        let collider = ColliderDef {
            material: Material { restitution: fx!(0.5), ..Material::default() },
            density: fx!(10),
            ..ColliderDef::new(Shape::rectangle(width, fx!(0.2)).expect("a shape"))
        };
        BodyDef { position: Vec2::new(x, y), velocity: vec2(0, -6), colliders: vec![collider], ..BodyDef::dynamic() }
    };
    if !is_welded {
        world.add_body(bar(fx!(0), fx!(2))).expect("a body");
        return world;
    }
    let halves = [fx!(-0.5), fx!(0.5)].map(|x| world.add_body(bar(x, fx!(1))).expect("a body"));
    let joint = JointDef::at(&world, halves[0], halves[1], Vec2::new(fx!(0), y)).expect("a joint");
    world.add_joint(JointDef { kind: JointKind::Weld(Weld::default()), ..joint }).expect("a joint");
    world
}

/// Where an end is struck after the other end within a sub-step, the second impact sees the velocities of both halves that the first one has left:
/// as of one bar, whose momenta would be (0, 12, 0) if both ends were struck at once.
#[test]
fn welded_halves_strike_one_post_after_the_other_as_one_bar_does() {
    let [joined, whole] = [true, false].map(|is_welded| {
        let mut world = bar_at_posts(is_welded);
        (0..30).for_each(|_| _ = world.step());
        let Vec2 { x, y } = world.momentum().expect("a momentum");
        [x, y, world.angular_momentum().expect("an angular momentum")].map(ToF64::to_f64)
    });
    println!("two halves: {joined:?}, one bar: {whole:?}");
    assert!(joined.iter().zip(whole).all(|(joined, whole)| (joined - whole).abs() < 0.001), "{joined:?}, {whole:?}");
    assert!(whole[1] < 10.0, "{whole:?}");
}

/// A load on a foot of 20 kg that it is welded to falls 5 m: it lands as one body does, and stands.
#[test]
fn a_load_on_a_light_foot_lands() {
    for mass in [20, 200, 1_000] {
        let mut world = falling();
        let floor = BodyDef::fixed().with_collider(Shape::rectangle(20, 1).expect("a shape"));
        world.add_body(BodyDef { position: vec2(0, fx!(-0.5)), ..floor }).expect("a body");
        let [foot, load] = [(fx!(5.25), 20), (fx!(6), mass)].map(|(y, mass)| {
            let shape = Shape::rectangle(fx!(1), if y < fx!(6) { fx!(0.5) } else { fx!(1) }).expect("a shape");
            let body =
                BodyDef { position: Vec2::new(fx!(0), y), mass: Mass::Kilograms(Fx::from(mass)), ..BodyDef::dynamic() };
            world.add_body(body.with_collider(shape)).expect("a body")
        });
        let joint = JointDef::at(&world, load, foot, Vec2::new(fx!(0), fx!(5.5))).expect("a joint");
        world.add_joint(JointDef { kind: JointKind::Weld(Weld::default()), ..joint }).expect("a joint");
        let (mut lowest, mut rebound, mut gap) = (fx!(9), fx!(0), fx!(0));
        for _ in 0..300 {
            world.step();
            let y = world.body(foot).expect("a body").position().y;
            lowest = lowest.min(y);
            rebound = rebound.max(y - lowest);
            gap = world.joints().map(|joint| joint.length()).fold(gap, Fx::max);
        }
        let y = world.body(foot).expect("a body").position().y;
        println!("foot under {mass} kg: lowest {lowest}, rebound {rebound}, at last {y}, gap {gap}");
        assert!(rebound < fx!(0.002) && gap < fx!(0.002) && (y - fx!(0.25)).abs() < fx!(0.004), "{mass} kg");
    }
}

/// A hub of 1 kg with 40 spokes welded to it strikes a post: changes of the hub by single joints are far larger than any velocity, and cancel. Nothing
/// overflows, also with spokes of four tonnes, and with spokes of 20 kg no step gains energy.
#[test]
fn a_light_hub_of_heavy_spokes_strikes_a_post() {
    for mass in [20, 4_096] {
        let mut world = World::new(WorldDef::default()).expect("a world");
        let post = BodyDef::fixed().with_collider(Shape::circle(fx!(0.5)).expect("a shape"));
        world.add_body(BodyDef { position: vec2(6, 0), ..post }).expect("a body");
        let velocity = vec2(20, 0);
        let hub = BodyDef { mass: Mass::Kilograms(fx!(1)), velocity, ..BodyDef::dynamic() };
        let hub = world.add_body(hub).expect("a body");
        for i in 0..40 {
            let angle = Fx::TAU * i / 40;
            let position = Vec2::new(angle.cos(), angle.sin()) * 4;
            let filter = Filter { group: -1, ..Filter::default() };
            let collider = ColliderDef { filter, ..ColliderDef::new(Shape::rectangle(2, fx!(0.25)).expect("a shape")) };
            let mass = Mass::Kilograms(Fx::from(mass));
            let spoke = BodyDef { position, angle, velocity, mass, ..BodyDef::dynamic() };
            let spoke = world.add_body(spoke.with_collider(collider)).expect("a body");
            let joint = JointDef::at(&world, hub, spoke, vec2(0, 0)).expect("a joint");
            world.add_joint(JointDef { kind: JointKind::Weld(Weld::default()), ..joint }).expect("a joint");
        }
        let before = world.energy().expect("an energy");
        for _ in 0..60 {
            world.step();
            assert!(mass > 20 || world.energy().expect("an energy") <= before);
        }
    }
}

/// Two hinges in place of a weld make a loop.
#[test]
fn a_wheel_on_two_hinges_stops_its_hull() {
    for mass in [2, 20, 60, 200, 1_000] {
        let (mut world, bodies) = crash(Fx::from(mass), JointKind::Revolute(Revolute::default()), fx!(0));
        let [wheel, hull] = bodies;
        let second = JointDef::at(&world, hull, wheel, Vec2::new(fx!(-1.2), fx!(0.2))).expect("a joint");
        world.add_joint(second).expect("a joint");
        let [impulse, gap] = run_crash(&mut world);
        let momentum = Fx::from(10 * (mass + 20));
        println!("loop {mass} kg: {:?}, {impulse} N·s of {momentum}, gap {gap}", speeds(&world, bodies));
        assert!((impulse - momentum).abs() < momentum / 100 && gap < fx!(0.001), "{mass} kg: {impulse}, {gap}");
        assert!(speeds(&world, bodies).into_iter().all(|speed| speed.abs() < fx!(0.01)), "{mass} kg");
    }
}

/// Joined bodies bounce as one body does: with the restitution of the contact, and without a gain.
#[test]
fn a_wheel_in_front_of_a_hull_bounces_with_it() {
    for restitution in [fx!(0.5), fx!(1)] {
        for mass in [20, 200, 1_000] {
            let (mut world, bodies) = crash(Fx::from(mass), JointKind::Weld(Weld::default()), restitution);
            let mut gap = fx!(0);
            for _ in 0..10 {
                world.step();
                gap = world.joints().map(|joint| joint.length()).fold(gap, Fx::max);
            }
            println!("{restitution}, {mass} kg: {:?}, gap {gap}", speeds(&world, bodies));
            assert!(gap < fx!(0.0001), "{gap}");
            for speed in speeds(&world, bodies) {
                assert!((speed + restitution * 10).abs() < fx!(0.01), "{restitution}, {mass} kg: {speed}");
            }
        }
    }
}

/// A rod of two halves with a hinge in the middle that falls with one end on a post: the impulse is by the articulated inverse mass of that end.
#[test]
fn a_hinged_rod_meets_its_articulated_mass() {
    let mut world = World::new(WorldDef::default()).expect("a world");
    let post = BodyDef::fixed().with_collider(ColliderDef::new(Shape::circle(fx!(0.5)).expect("a shape")));
    world.add_body(BodyDef { position: vec2(-1, fx!(-0.6)), ..post }).expect("a body");
    let mass = Mass::Explicit { mass: fx!(1), inertia: Fx::from_ratio(1, 12) };
    let halves = [fx!(-0.5), fx!(0.5)].map(|x| {
        let shape = Shape::rectangle(fx!(1), fx!(0.1)).expect("a shape");
        let material = Material { friction: fx!(0), ..Material::default() };
        let collider = ColliderDef { hit_events: true, material, ..ColliderDef::new(shape) };
        let position = Vec2::new(x, fx!(0.5));
        let half = BodyDef { mass, position, velocity: vec2(0, -6), colliders: vec![collider], ..BodyDef::dynamic() };
        world.add_body(half).expect("a body")
    });
    let joint = JointDef::at(&world, halves[0], halves[1], Vec2::new(fx!(0), fx!(0.5))).expect("a joint");
    world.add_joint(joint).expect("a joint");
    let mut hits = Vec::new();
    while hits.is_empty() {
        hits.extend_from_slice(world.step().hits);
    }
    // With J at the end and H at the hinge: 4·J + 2·H = 6 m/s stop the end, and −2·J − 4·H = 4·H keep the hinge closed.
    let [hit] = hits[..] else { panic!("one hit, and not {}", hits.len()) };
    assert!((hit.normal_impulse - Fx::from_ratio(12, 7)).abs() < fx!(0.001), "{}", hit.normal_impulse);
    // In the rest of the step the hinge goes on to pull the halves round.
    let is_near = |value: Fx, expected: Fx| (value - expected).abs() < fx!(0.02);
    for (half, [speed, spin]) in halves.into_iter().zip([[-27, -54], [-45, 18]]) {
        let half = world.body(half).expect("a body");
        let (velocity, angular_velocity) = (half.velocity().y, half.angular_velocity());
        assert!(is_near(velocity, Fx::from_ratio(speed, 7)) && is_near(angular_velocity, Fx::from_ratio(spin, 7)));
    }
}

/// A chain of 300 links falls across posts at 5 to 7 m/s: more of its links are struck than have responses to each other. What is between the posts goes
/// on and pulls, and the ends swing around the last posts. No link is thrown, and most of the energy goes into the impacts.
#[test]
fn a_long_chain_falls_across_posts() {
    let gaps = [fx!(5), fx!(5.5), fx!(6), fx!(6.5), fx!(7)].map(gap_across_posts);
    // The ends are whips, whose gaps differ by chance.
    assert!(gaps.iter().all(|&gap| gap < fx!(0.12)), "{gaps:?}");
}

/// The widest gap of a chain of 300 links that falls across posts at a speed.
fn gap_across_posts(speed: Fx) -> Fx {
    let mut world = World::new(WorldDef::default()).expect("a world");
    let links: Vec<BodyId> = (0..300)
        .map(|k| {
            let x = Fx::from(k) / 2 - fx!(75);
            if k % 8 == 3 {
                let post = BodyDef::fixed().with_collider(Shape::rectangle(fx!(0.3), fx!(1)).expect("a shape"));
                world.add_body(BodyDef { position: Vec2::new(x, fx!(-0.5)), ..post }).expect("a body");
            }
            let shape = Shape::rectangle(fx!(0.4), fx!(0.1)).expect("a shape");
            let link = BodyDef {
                position: Vec2::new(x, fx!(0.14)),
                velocity: Vec2::new(fx!(0), -speed),
                ..BodyDef::dynamic()
            };
            world.add_body(link.with_collider(shape)).expect("a body")
        })
        .collect();
    for (k, pair) in (0..).zip(links.windows(2)) {
        let point = Vec2::new(Fx::from(k) / 2 - fx!(74.75), fx!(0.14));
        let joint = JointDef::at(&world, pair[0], pair[1], point).expect("a joint");
        world.add_joint(joint).expect("a joint");
    }
    let start = world.energy().expect("an energy");
    let (mut gap, mut fastest) = (fx!(0), fx!(0));
    for _ in 0..120 {
        world.step();
        assert!(world.energy().expect("an energy") <= start);
        gap = world.joints().map(|joint| joint.length()).fold(gap, Fx::max);
        fastest = world.bodies().map(|body| body.velocity().length()).fold(fastest, Fx::max);
    }
    let (kinetic, start) = (world.kinetic_energy().expect("an energy").to_f64(), start.to_f64());
    println!("{speed} m/s: gap {gap}, fastest {fastest}, {kinetic} of {start} J");
    assert!(fastest < 4 * speed && kinetic < start / 4.0);
    gap
}
