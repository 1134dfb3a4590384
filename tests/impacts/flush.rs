//! Parts of a body that lie side by side are one surface, whether the body stands still or moves.

use umbra_physics::{BodyDef, BodyKind, ColliderDef, FieldKind, Mass, Part, Shape, Snapshot, Vec2, World, fx, vec2};

use crate::impacts::scenes::{
    between, build, conclude, disc, dynamic, falling, fixed, float, floating, number, of_any_size, point, position,
    random, rectangle, seeds, steps,
};

/// How the surface is put together.
#[derive(Clone, Copy, Debug)]
enum Surface {
    /// A collider for each tile.
    Colliders,
    /// A part of one compound for each tile.
    Compound,
    /// One rectangle: the twin.
    Whole,
}

/// A body of tiles of these widths, a metre high, its top at height 0 and its left end at x = 0.
fn tiles(surface: Surface, widths: &[f64]) -> BodyDef {
    let length: f64 = widths.iter().sum();
    let mut edge = -length / 2.0;
    let places: Vec<(f64, f64)> = widths
        .iter()
        .map(|&width| {
            edge += width;
            (edge - width / 2.0, width)
        })
        .collect();
    let tile = |width: f64| rectangle(number(width), fx!(1));
    let colliders = match surface {
        Surface::Colliders => places
            .iter()
            .map(|&(x, width)| ColliderDef { position: point(x, 0.0), ..ColliderDef::new(tile(width)) })
            .collect(),
        Surface::Compound => {
            let parts: Vec<Part> = places
                .iter()
                .map(|&(x, width)| Part { shape: tile(width), position: point(x, 0.0), angle: fx!(0), density: fx!(1) })
                .collect();
            vec![ColliderDef::new(Shape::compound(&parts).expect("a compound"))]
        }
        Surface::Whole => vec![ColliderDef::new(tile(length))],
    };
    BodyDef { colliders, position: point(length / 2.0, -0.5), ..BodyDef::dynamic() }
}

/// The highest that a body comes above its start on these tiles, m, and the least share of its speed that it has.
fn ride(surface: BodyDef, rider: BodyDef, ticks: u32) -> [f64; 2] {
    let mut bodies = vec![surface.clone(), rider.clone()];
    if surface.kind == BodyKind::Dynamic {
        bodies.push(fixed(rectangle(fx!(80), fx!(1)), vec2(0, fx!(-1.5))));
    }
    let (mut world, ids) = build(falling(), bodies);
    let (mut highest, mut slowest) = (0.0f64, 1.0f64);
    for _ in 0..ticks {
        world.step();
        let body = world.body(ids[1]).expect("a body");
        let relative = body.velocity() - world.body(ids[0]).expect("a body").velocity();
        highest = highest.max(float(body.position().y - rider.position.y));
        slowest = slowest.min(float(relative.x) / float(rider.velocity.x - surface.velocity.x));
    }
    [highest, slowest]
}

fn ball(speed: f64, radius: f64) -> BodyDef {
    BodyDef {
        velocity: point(speed, 0.0),
        angular_velocity: number(-speed / radius),
        ..dynamic(disc(number(radius)), point(0.5, radius))
    }
}

#[test]
fn a_ball_rolls_over_a_kinematic_platform_of_tiles() {
    for speed in [1.0, 3.0, 6.0, 12.0] {
        for surface in [Surface::Whole, Surface::Colliders, Surface::Compound] {
            let platform = BodyDef { kind: BodyKind::Kinematic, ..tiles(surface, &[1.0; 10]) };
            let [rise, share] = ride(platform, ball(speed, 0.2), (60.0 * 9.0 / speed) as u32);
            assert!(rise < 0.001 && share > 0.99, "{speed} m/s, {surface:?}: rises by {rise}, keeps {share}");
        }
    }
}

#[test]
fn a_ball_rolls_over_a_heavy_body_of_tiles() {
    for surface in [Surface::Whole, Surface::Colliders, Surface::Compound] {
        let raft = BodyDef { mass: Mass::Kilograms(fx!(2000)), ..tiles(surface, &[1.0; 10]) };
        let [rise, share] = ride(raft, ball(6.0, 0.2), 80);
        assert!(rise < 0.002 && share > 0.98, "{surface:?}: rises by {rise}, keeps {share}");
    }
}

/// Tiles of random widths on a body of any kind, at rest or moving; a ball rolls, a box slides.
#[test]
fn random_riders_pass_the_seams_of_random_tiles() {
    let (mut failures, mut tried) = (Vec::new(), 0);
    for seed in seeds(15) {
        let random = &mut random("tiles", seed);
        let widths: Vec<f64> = (0..16).map(|_| (between(random, 0.1, 1.5) * 64.0).round() / 64.0).collect();
        let length: f64 = widths.iter().sum();
        let kind =
            [BodyKind::Static, BodyKind::Kinematic, BodyKind::Kinematic, BodyKind::Dynamic][random.below(4) as usize];
        let surface = if random.below(2) == 0 { Surface::Colliders } else { Surface::Compound };
        let motion = if kind == BodyKind::Kinematic && random.below(2) == 0 { between(random, -3.0, 3.0) } else { 0.0 };
        let speed = of_any_size(random, 0.5, 15.0);
        let size = between(random, 0.1, 0.5);
        let is_ball = random.below(2) == 0;
        let rider = if is_ball {
            ball(speed, size)
        } else {
            let collider = ColliderDef::new(rectangle(number(2.0 * size), number(2.0 * size)));
            BodyDef { velocity: point(speed, 0.0), ..dynamic(collider, point(0.5, size)) }
        };
        let slide = |mut body: BodyDef| {
            let friction = if is_ball { fx!(0.6) } else { fx!(0) };
            body.colliders.iter_mut().for_each(|collider| collider.material.friction = friction);
            body
        };
        let rider = BodyDef { velocity: rider.velocity + point(motion, 0.0), ..rider };
        let tiles =
            BodyDef { kind, velocity: point(motion, 0.0), mass: Mass::Kilograms(fx!(5000)), ..tiles(surface, &widths) };
        tried += 1;
        let ticks = (60.0 * (length - 2.0) / speed) as u32;
        let [rise, share] = ride(slide(tiles), slide(rider), ticks.min(300));
        if rise > 0.002 || share < 0.98 {
            failures.push(format!(
                "seed {seed}: {kind}, {surface:?}, ball {is_ball}, {speed:.1} m/s, moving at {motion:.1}: rises by {rise:.4}, keeps {share:.3}"
            ));
        }
    }
    conclude(tried, &failures);
}

/// A ball at 3 m/s over a raft that floats: it moves as over a raft of one piece.
#[test]
fn a_ball_rolls_over_a_raft_of_tiles_as_over_one_of_one_piece() {
    let height = |surface: Surface| -> Vec<f64> {
        let mut raft = tiles(surface, &[1.0; 8]);
        raft.colliders.iter_mut().for_each(|collider| collider.density = fx!(0.5));
        let (mut world, ids) = build(falling(), [BodyDef { position: vec2(4, 0), ..raft }]);
        let water = FieldKind::Buoyancy {
            min: vec2(-50, -50),
            max: vec2(50, 0),
            density: fx!(1),
            linear_drag: fx!(2),
            angular_drag: fx!(2),
            flow: Vec2::ZERO,
        };
        world.add_field(water).expect("a field");
        steps(&mut world, 120);
        let top = float(world.body(ids[0]).expect("a body").position().y) + 0.5;
        let ball = ball(3.0, 0.2);
        let ball = BodyDef { position: ball.position + Vec2::new(fx!(2), number(top)), ..ball };
        let ball = world.add_body(ball).expect("a body");
        (0..80)
            .map(|_| {
                world.step();
                float(world.body(ball).expect("a body").position().y)
            })
            .collect()
    };
    let whole = height(Surface::Whole);
    for surface in [Surface::Colliders, Surface::Compound] {
        let apart = height(surface).iter().zip(&whole).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 0.002, "{surface:?}: {apart} m");
    }
}

/// The check can fail: a step of 3 cm between two tiles throws the ball up.
#[test]
fn a_step_between_tiles_is_seen() {
    let mut platform = BodyDef { kind: BodyKind::Kinematic, ..tiles(Surface::Colliders, &[1.0; 10]) };
    platform.colliders[4].position.y = fx!(0.03);
    let [rise, _] = ride(platform, ball(6.0, 0.2), 80);
    assert!(rise > 0.02, "{rise}");
}

/// A raft of three boxes slides without friction over ten tiles; either of the two is added first.
#[test]
fn a_raft_of_tiles_slides_over_tiles_with_other_seams() {
    let smooth = |mut body: BodyDef| {
        body.colliders.iter_mut().for_each(|collider| collider.material.friction = fx!(0));
        body
    };
    let mut failures = Vec::new();
    let all = [Surface::Whole, Surface::Colliders, Surface::Compound];
    for (ground, raft) in all.into_iter().flat_map(|ground| all.map(|raft| (ground, raft))) {
        for (speed, kind) in [(2.0, BodyKind::Static), (7.0, BodyKind::Static), (7.0, BodyKind::Kinematic)] {
            for is_raft_first in [false, true] {
                let ground = smooth(BodyDef { kind, ..tiles(ground, &[1.0; 30]) });
                let raft = smooth(BodyDef {
                    position: point(2.0, 0.5),
                    velocity: point(speed, 0.0),
                    ..tiles(raft, &[0.75, 0.5, 0.75])
                });
                let (bodies, number) = if is_raft_first { ([raft, ground], 0) } else { ([ground, raft], 1) };
                let (mut world, ids) = build(falling(), bodies);
                let mut highest = 0.0f64;
                for _ in 0..(60.0 * 25.0 / speed) as u32 {
                    world.step();
                    highest = highest.max(float(world.body(ids[number]).expect("a body").position().y) - 0.5);
                }
                let share = float(world.body(ids[number]).expect("a body").velocity().x) / speed;
                if highest > 0.001 || (share - 1.0).abs() > 0.001 {
                    failures.push(format!("{kind}, {is_raft_first}, {speed} m/s: rises by {highest}, keeps {share}"));
                }
            }
        }
    }
    conclude(all.len() * all.len() * 6, &failures);
}

/// A part with another filter covers nothing: a ball that meets only its neighbour is stopped by that neighbour's side.
#[test]
fn a_part_with_another_filter_covers_no_edge() {
    for kind in [BodyKind::Static, BodyKind::Kinematic, BodyKind::Dynamic] {
        let mut body = BodyDef { kind, mass: Mass::Kilograms(fx!(100)), ..tiles(Surface::Colliders, &[1.0; 2]) };
        body.colliders[1].filter.category = 2;
        let mut ball = BodyDef { velocity: point(-3.0, 0.0), ..dynamic(disc(fx!(0.25)), point(1.5, -0.5)) };
        ball.colliders[0].filter.mask = 1;
        let (mut world, ids) = build(floating(), [body, ball]);
        steps(&mut world, 60);
        let [left, right] = [ids[0], ids[1]].map(|id| float(world.body(id).expect("a body").position().x));
        assert!(right - left > 0.24, "{kind}: {right} from {left}");
    }
}

/// Where a part of a platform is removed, the sides of its neighbours are there from the next step on.
#[test]
fn parts_of_a_body_that_are_removed_open_their_neighbours() {
    let platform = BodyDef { kind: BodyKind::Kinematic, ..tiles(Surface::Colliders, &[1.0; 5]) };
    let (mut world, ids) = build(falling(), [platform, dynamic(disc(fx!(0.25)), point(2.5, 0.25))]);
    steps(&mut world, 30);
    let fresh =
        |world: &World| Snapshot::from_bytes(&world.snapshot().to_bytes(), &[]).expect("its bytes").into_world();
    let middle = world.colliders_of(ids[0]).expect("a body").nth(2).expect("a collider");
    world.remove_collider(middle).expect("a collider");
    let mut twin = fresh(&world);
    for _ in 0..60 {
        world.step();
        twin.step();
        let [x, y] = position(&world, ids[1]);
        assert!(y > -0.25 || (x - 2.5).abs() <= 0.26, "{x}, {y}");
    }
    assert!(position(&world, ids[1])[1] < -1.0, "{:?}", position(&world, ids[1]));
    assert_eq!(world.state_hash(), twin.state_hash());
}
