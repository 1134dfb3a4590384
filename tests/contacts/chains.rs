//! Chains: seams without bumps, one side, images, bad input; contacts beside a look at all segments.

use super::scenes::{def, keeps_its_bits, material, square, world};
use crate::seeds::run_seed;
use umbra_physics::collide::{Manifold, Pose, collide};
use umbra_physics::{
    BodyDef, BodyId, BodyKind, ColliderDef, Dimension, Error, Fx, Quantity, Random, Shape, Turn, Vec2, World, WorldDef,
    fx, vec2,
};

fn chain(points: &[Vec2], closed: bool) -> Shape {
    Shape::chain(points, closed).expect("a chain")
}

fn fixed(shape: Shape) -> BodyDef {
    BodyDef { key: 1 << 40, ..BodyDef::fixed().with_collider(shape) }
}

fn ball(position: Vec2, radius: Fx, key: u64) -> BodyDef {
    let collider = ColliderDef { key, ..ColliderDef::new(Shape::circle(radius).expect("a disc")) };
    BodyDef { position, key, ..BodyDef::dynamic().with_collider(collider) }
}

/// A flat ground at height 0 from 2,000 m on to the left, of so many segments of many lengths.
fn ground(segments: usize) -> Shape {
    let mut random = Random::seeded(run_seed(3));
    let mut points = vec![vec2(2_000, 0)];
    for i in 1..segments {
        let x = Fx::from_ratio(2_000 * (segments as i64 - 2 * i as i64), segments as i64);
        let off = random.number(fx!(-0.05)..=fx!(0.05));
        points.push(Vec2::new(x + off, Fx::ZERO));
    }
    points.push(vec2(-2_000, 0));
    chain(&points, false)
}

/// The largest differences of height and of velocities, ulp, between a body on a chain and on one segment, from one step to another; how
/// many seams it went over, and in how many steps it had two contacts.
fn differences(shape: &Shape, body: &BodyDef, settled: usize, steps: usize) -> ([u64; 4], usize, usize) {
    let (mut here, ids) = world(def(), [fixed(shape.clone()), body.clone()]).expect("a scene");
    let (mut reference, _) = world(def(), [fixed(ground(1)), body.clone()]).expect("a scene");
    let (mut largest, mut seams, mut last, mut double) = ([0; 4], 0, 0, 0);
    for step in 0..steps {
        here.step();
        reference.step();
        if step < settled {
            continue;
        }
        let [here_body, there_body] = [&here, &reference].map(|world| world.body(ids[1]).expect("it is there"));
        let apart = |a: Fx, b: Fx| a.to_bits().abs_diff(b.to_bits());
        let now = [
            apart(here_body.position().y, there_body.position().y),
            apart(here_body.velocity().y, there_body.velocity().y),
            apart(here_body.velocity().x, there_body.velocity().x),
            apart(here_body.angular_velocity(), there_body.angular_velocity()),
        ];
        largest = [0, 1, 2, 3].map(|i| largest[i].max(now[i]));
        if let Some(contact) = here.contacts().next() {
            let part = contact.parts[0] as usize;
            seams += part.abs_diff(last);
            last = part;
        }
        double += usize::from(here.contacts().count() > 1);
    }
    (largest, seams, double)
}

#[test]
fn a_ball_rolls_over_ten_thousand_seams_without_a_bump() {
    let start =
        BodyDef { velocity: vec2(30, 0), angular_velocity: fx!(-60), ..ball(vec2(-1_990, fx!(0.5)), fx!(0.5), 1) };
    let (largest, seams, double) = differences(&ground(12_000), &start, 0, 7_200);
    assert!(seams >= 10_000, "{seams}");
    // With the middle within half a micrometre of a seam, which happens at one of 10^5, it is on both segments for a step: it is off
    // by 8 µm and 0.3 mm/s afterwards.
    let most_allowed = if double == 0 { [0; 4] } else { [1 << 15, 1 << 20, 1 << 20, 1 << 21] };
    assert!(double < 3 && (0..4).all(|i| largest[i] <= most_allowed[i]), "{largest:?} ulp, after {seams} seams");
}

#[test]
fn boxes_and_capsules_slide_over_seams_without_a_bump() {
    let smooth = material(fx!(0), fx!(0));
    let shapes =
        [Shape::rectangle(1, 1), Shape::capsule(1, fx!(0.25)), Shape::polygon(&[vec2(0, 0), vec2(2, 0), vec2(1, 1)])];
    for (i, shape) in shapes.into_iter().enumerate() {
        let shape = shape.expect("a shape");
        let below = shape.bounds().min.y;
        let collider = ColliderDef { material: smooth, ..ColliderDef::new(shape) };
        let body = BodyDef {
            position: Vec2::new(fx!(-1_990), -below),
            velocity: vec2(20, 0),
            ..BodyDef::dynamic().with_collider(collider)
        };
        let (largest, seams, _) = differences(&ground(12_000), &body, 120, 1_200);
        assert!(seams >= 1_100, "{seams}");
        // 2^12 ulp are 1 µm, and 2^19 ulp are 0.12 mm/s: the corners are on two segments, which the solver does not have in one block, and
        // a corner that comes over a seam in a step is on one of both segments for all of it.
        let [height, velocities @ ..] = largest;
        assert!(height <= 1 << 12 && velocities.iter().all(|&ulps| ulps <= 1 << 19), "shape {i}: {largest:?} ulp");
    }
}

/// A landscape from right to left: hills, a step, a notch, walls at the ends.
fn hills(count: i32) -> Vec<Vec2> {
    let mut random = Random::seeded(run_seed(8));
    let mut points = vec![vec2(count + 1, 12)];
    for i in 0..=2 * count {
        let height = random.number(fx!(0)..=if i % 20 < 10 { fx!(0.25) } else { fx!(1.5) });
        points.push(Vec2::new(Fx::from(count - i), height));
    }
    points.push(vec2(-count - 1, 12));
    points
}

fn crowd(count: u64, width: i32) -> Vec<BodyDef> {
    let mut random = Random::seeded(run_seed(21));
    let each = |i: u64| {
        let at = Vec2::new(random.number(Fx::from(-width)..=Fx::from(width)), fx!(3) + Fx::from(i as i32) / 2);
        let shape = match i % 4 {
            0 => return ball(at, fx!(0.375), i),
            1 => return BodyDef { angle: fx!(0.3), ..square(at, i).expect("a square") },
            2 => Shape::capsule(fx!(0.75), fx!(0.25)).expect("a capsule"),
            _ => Shape::polygon(&[vec2(0, 0), vec2(1, 0), vec2(0, 1)]).expect("a triangle"),
        };
        let collider = ColliderDef { key: i, ..ColliderDef::new(shape) };
        BodyDef {
            position: at,
            key: i,
            angle: random.number(fx!(0)..=fx!(3)),
            ..BodyDef::dynamic().with_collider(collider)
        }
    };
    (0..count).map(each).collect()
}

#[test]
fn mirrored_shuffled_and_restored_chains_keep_their_bits() {
    // More than 256 segments, below bodies at both ends.
    for (points, closed, width) in [(hills(300), false, 290), (hills(6), true, 6)] {
        let ground = match closed {
            // The way round the landscape, far below.
            true => hills(6).into_iter().chain([vec2(-7, -9), vec2(7, -9)]).collect(),
            false => points,
        };
        let ground = fixed(chain(&ground, closed));
        let bodies: Vec<BodyDef> = std::iter::once(ground).chain(crowd(40, width)).collect();
        let (mut long, mut last) = (0, None);
        keeps_its_bits(bodies, (240, 10), |world| {
            long += world.contacts().filter(|contact| contact.parts[0] > 255).count();
            last = Some(world.clone());
        });
        let last = last.expect("there are steps");
        assert!(closed || long > 500, "{long}");
        // Nobody fell through.
        let lowest = last.bodies().skip(1).map(|body| body.position().y).min();
        assert!(lowest > Some(fx!(0)), "{lowest:?}");
        assert!(last.contacts().count() > 30);
    }
}

#[test]
fn a_body_passes_from_behind_and_stands_in_front() {
    let shapes = [
        Shape::circle(fx!(0.5)),
        Shape::rectangle(1, 1),
        Shape::capsule(1, fx!(0.25)),
        Shape::segment(vec2(-1, 0), vec2(1, 0)),
    ];
    for shape in shapes {
        let body_at = |position, velocity| BodyDef {
            position,
            velocity,
            ..BodyDef::dynamic().with_collider(shape.clone().expect("a shape"))
        };
        // From right to left: the outer side is above.
        let floor = fixed(chain(&[vec2(20, 0), vec2(3, 0), vec2(-2, 0), vec2(-20, 0)], false));
        let bodies = [floor, body_at(vec2(-5, -3), vec2(0, 12)), body_at(vec2(5, 2), vec2(0, 0))];
        let (mut world, ids) = world(def(), bodies).expect("a scene");
        let (mut free, free_ids) = super::scenes::world(def(), [body_at(vec2(-5, -3), vec2(0, 12))]).expect("a scene");
        for _ in 0..600 {
            world.step();
            free.step();
            let [body_here, alone] =
                [world.body(ids[1]), free.body(free_ids[0])].map(|body| body.expect("it is there"));
            // Its middle is behind the chain: as if nothing was there.
            if body_here.position().y < fx!(-0.25) && body_here.velocity().y > Fx::ZERO {
                assert_eq!(body_here.position_exact(), alone.position_exact());
            }
        }
        for &id in &ids[1..] {
            let body = world.body(id).expect("it is there");
            assert!(body.position().y > fx!(-0.02) && body.velocity().length() < fx!(0.01), "{:?}", body.position());
        }
    }
    // From within a closed chain with its points counter-clockwise nothing is held.
    let island = fixed(chain(&[vec2(-3, -3), vec2(3, -3), vec2(3, 3), vec2(-3, 3)], true));
    let inside = BodyDef { velocity: vec2(8, 1), ..ball(vec2(0, 0), fx!(0.5), 1) };
    let still = WorldDef { gravity: vec2(0, 0), ..def() };
    let (mut around, ids) = world(still, [island, inside.clone()]).expect("a scene");
    (0..20).for_each(|_| _ = around.step());
    assert_eq!(around.body(ids[1]).expect("it").velocity(), vec2(8, 1));
    // In a room, with its points clockwise, it stays.
    let room = fixed(chain(&[vec2(-3, 3), vec2(3, 3), vec2(3, -3), vec2(-3, -3)], true));
    let (mut within, ids) = world(still, [room, inside]).expect("a scene");
    (0..600).for_each(|_| _ = within.step());
    let at = within.body(ids[1]).expect("it").position();
    assert!(at.x.abs().max(at.y.abs()) < fx!(2.6), "{at}");
}

#[test]
fn a_kinematic_chain_carries_and_pushes() {
    let points = [vec2(4, 1), vec2(3, 0), vec2(-3, 0), vec2(-4, 1)];
    let tray = BodyDef { velocity: vec2(1, fx!(0.5)), ..BodyDef::kinematic().with_collider(chain(&points, false)) };
    let (mut world, ids) = world(def(), [tray, square(vec2(0, fx!(0.5)), 1).expect("a square")]).expect("a scene");
    (0..300).for_each(|_| _ = world.step());
    let [tray, rider] = [ids[0], ids[1]].map(|id| world.body(id).expect("it is there").position());
    assert_eq!(format!("{tray:.3}"), "(5.000, 2.500)");
    assert!((rider - tray - vec2(0, fx!(0.5))).length() < fx!(0.05), "{rider}");
}

#[test]
fn invalid_chains_are_refused_and_the_world_unchanged() {
    let out_of_range = |quantity| Err(Error::OutOfRange { quantity });
    let size = |dimension, value| Quantity::Size { dimension, value };
    let line = |count: i32| (0..count).map(|x| vec2(Fx::from_ratio(x.into(), 16), 0)).collect::<Vec<_>>();
    let far = umbra_physics::limits::SIZE_MAX + Fx::DELTA;
    let cases = [
        (line(0), false, out_of_range(Quantity::Count)),
        (line(1), false, out_of_range(Quantity::Count)),
        (line(2), true, out_of_range(Quantity::Count)),
        (line((1 << 16) + 1), false, out_of_range(Quantity::Count)),
        (vec![vec2(0, 0), vec2(1, 0), vec2(1, 0), vec2(2, 0)], false, out_of_range(size(Dimension::Edge(1), fx!(0)))),
        (vec![vec2(0, 0), vec2(1, 0), vec2(1, 1), vec2(0, 0)], true, out_of_range(size(Dimension::Edge(3), fx!(0)))),
        (vec![vec2(0, 0), vec2(fx!(0.0078), 0)], false, out_of_range(size(Dimension::Edge(0), fx!(0.0078)))),
        (vec![vec2(0, 0), Vec2::new(far, fx!(0))], false, out_of_range(size(Dimension::Coordinate(1), far))),
        // Across, back along itself, onto a segment, onto a point.
        (vec![vec2(0, 0), vec2(2, 2), vec2(2, 0), vec2(0, 2)], false, Err(Error::ChainCrosses { segments: [0, 2] })),
        (vec![vec2(0, 0), vec2(2, 0), vec2(1, 0)], false, Err(Error::ChainCrosses { segments: [0, 1] })),
        (vec![vec2(0, 0), vec2(2, 0), vec2(2, 2), vec2(1, 0)], false, Err(Error::ChainCrosses { segments: [0, 2] })),
        (vec![vec2(0, 0), vec2(2, 0), vec2(2, 2), vec2(0, 0)], false, Err(Error::ChainCrosses { segments: [0, 2] })),
    ];
    for (points, closed, error) in cases {
        assert_eq!(Shape::chain(&points, closed), error, "{} points, {closed}", points.len());
    }
    assert_eq!(Shape::chain(&line(1 << 16), false).map(|chain| chain.outlines().len()), Ok((1 << 16) - 1));
    let (mut world, ids) = world(def(), [fixed(ground(3)), square(vec2(0, 1), 1).expect("a square")]).expect("a scene");
    let collider = world.colliders_of(ids[1]).expect("it").next().expect("a collider");
    world.step();
    let before = world.state_hash();
    let refused = Err(Error::DynamicChain);
    assert_eq!(world.add_collider(ids[1], ground(2)), Err(Error::DynamicChain));
    assert_eq!(world.set_collider(collider, ground(2)), refused);
    assert_eq!(world.set_kind(ids[0], BodyKind::Dynamic), refused);
    assert_eq!(world.add_body(BodyDef::dynamic().with_collider(ground(2))), Err(Error::DynamicChain));
    let part = umbra_physics::Part { shape: ground(2), position: vec2(0, 0), angle: fx!(0), density: fx!(1) };
    assert_eq!(Shape::compound(&[part]), out_of_range(Quantity::Count));
    assert_eq!(world.state_hash(), before);
    world.set_kind(ids[0], BodyKind::Kinematic).expect("a chain may move");
}

fn pose(position: Vec2, angle: u64) -> Pose {
    Pose::new(position, Turn::from_bits(angle))
}

fn metres(value: Fx) -> f64 {
    value.to_bits() as f64 / 4_294_967_296.0
}

/// The nearest point of a polyline, and its distance.
fn nearest(points: &[[f64; 2]], at: [f64; 2]) -> ([f64; 2], f64) {
    let closest_on = |ends: &[[f64; 2]]| {
        let [d, to] = [[ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]], [at[0] - ends[0][0], at[1] - ends[0][1]]];
        let t = ((d[0] * to[0] + d[1] * to[1]) / (d[0] * d[0] + d[1] * d[1])).clamp(0.0, 1.0);
        let point = [ends[0][0] + t * d[0], ends[0][1] + t * d[1]];
        (point, (at[0] - point[0]).hypot(at[1] - point[1]))
    };
    points.windows(2).map(closest_on).min_by(|a, b| a.1.total_cmp(&b.1)).expect("a segment")
}

#[test]
fn discs_touch_the_nearest_point_of_a_chain_and_nothing_else() {
    let mut random = Random::seeded(run_seed(77));
    let margin = fx!(0.02);
    let (mut touched, mut corners, mut both) = (0, 0, 0);
    for _ in 0..crate::seeds::times(10_000) {
        let points: Vec<Vec2> = (0..8).map(|i| Vec2::new(Fx::from(4 - i), random.number(fx!(-1)..=fx!(1)))).collect();
        let shape = chain(&points, false);
        let centre = Vec2::new(random.number(fx!(-2)..=fx!(3)), random.number(fx!(-0.5)..=fx!(2)));
        let line: Vec<[f64; 2]> = points.iter().map(|point| [point.x, point.y].map(metres)).collect();
        let at = [centre.x, centre.y].map(metres);
        let (foot, distance) = nearest(&line, at);
        let height = line.windows(2).find(|ends| ends[1][0] <= at[0] && at[0] <= ends[0][0]).expect("above a segment");
        let above = at[1]
            - height[1][1]
            - (height[0][1] - height[1][1]) * (at[0] - height[1][0]) / (height[0][0] - height[1][0]);
        if above < 1e-6 {
            continue;
        }
        // Overlaps of up to a tenth of the distance, and gaps within the margin and beyond.
        let radius = distance - 0.1 * distance + random.below(1000) as f64 / 1000.0 * 0.2 * distance;
        let radius = Fx::from_bits((radius * 4_294_967_296.0) as i64);
        if radius < fx!(0.01) {
            continue;
        }
        let disc = Shape::circle(radius).expect("a disc");
        let (origin, disc_pose) = (pose(vec2(0, 0), 0), pose(centre, 0));
        let manifolds: Vec<Manifold> = shape
            .outlines()
            .iter()
            .filter_map(|outline| collide(outline, &origin, &disc.outlines()[0], &disc_pose, margin))
            .collect();
        let gap = distance - metres(radius);
        let separation = |manifold: &Manifold| metres(manifold.points[0].separation);
        let nearest_separation = manifolds.iter().map(separation).reduce(f64::min);
        if gap < 0.0199 {
            let nearest_separation =
                nearest_separation.unwrap_or_else(|| panic!("nothing at {at:?} with {gap} on {line:?}"));
            assert!((nearest_separation - gap).abs() < 1e-7, "{nearest_separation} and {gap} at {at:?} on {line:?}");
            let nearest_manifold =
                manifolds.iter().find(|manifold| separation(manifold) == nearest_separation).expect("the nearest");
            let normal = nearest_manifold.normal.map(|part| f64::from(part) / f64::from(1 << 30));
            let expected = [(at[0] - foot[0]) / distance, (at[1] - foot[1]) / distance];
            assert!((normal[0] - expected[0]).hypot(normal[1] - expected[1]) < 1e-5, "{normal:?} and {expected:?}");
            touched += 1;
            corners += usize::from(line.iter().any(|point| (point[0] - foot[0]).abs() < 1e-12));
            both += usize::from(manifolds.len() > 1);
        } else if gap > 0.0201 {
            assert!(manifolds.is_empty(), "{manifolds:?} at {gap}");
        }
    }
    assert!(touched > 1_000 && corners > 100 && both > 50, "{touched} {corners} {both}");
}

/// The manifolds that all segments have with an outline.
fn all(chain: &Shape, at: &Pose, shape: &Shape, shape_pose: &Pose) -> Vec<(usize, Manifold)> {
    let collide_part = |(i, outline)| Some((i, collide(outline, at, &shape.outlines()[0], shape_pose, fx!(0.02))?));
    chain.outlines().iter().enumerate().filter_map(collide_part).collect()
}

#[test]
fn a_world_has_the_contacts_of_all_segments() {
    let ground = chain(&hills(40), false);
    let (mut world, ids) = world(def(), std::iter::once(fixed(ground.clone())).chain(crowd(60, 36))).expect("a scene");
    let (mut pressed, mut count) = (0, 0);
    for step in 0..240 {
        let place = |world: &World, id: BodyId| {
            let body = world.body(id).expect("it is there");
            (Pose::new(body.position(), body.angle_exact()), body.velocity())
        };
        let mut expected = Vec::new();
        for &id in &ids[1..] {
            let shape = world.colliders_of(id).expect("it").next().and_then(|collider| world.collider(collider).ok());
            let (at, velocity) = place(&world, id);
            let manifolds = all(&ground, &pose(vec2(0, 0), 0), &shape.expect("a collider").shape, &at);
            // What overlaps by more than a hundredth of a millimetre and does not fly off is pushed.
            let is_pressed = |manifold: &Manifold| {
                let [x, y] = manifold.normal.map(|part| Fx::from_bits(i64::from(part) << 2));
                let leaves = velocity.x * x + velocity.y * y;
                manifold.points[..manifold.count].iter().any(|point| point.separation < fx!(-0.00001))
                    && leaves < fx!(0.001)
                    && manifold.count == 1
            };
            expected.extend(manifolds.iter().filter(|(_, manifold)| is_pressed(manifold)).map(|(part, _)| (*part, id)));
        }
        world.step();
        for (part, id) in expected {
            let is_own = |parts: [u32; 2], bodies: [BodyId; 2]| parts[0] as usize == part && bodies[1] == id;
            let is_there = world.contacts().any(|contact| is_own(contact.parts, contact.bodies));
            pressed += 1;
            count += usize::from(is_there);
        }
        let contacts_of_ground = world.contacts().filter(|contact| contact.bodies[0] == ids[0]);
        for contact in contacts_of_ground {
            let (at, _) = place(&world, contact.bodies[1]);
            let shape = world.collider(contact.colliders[1]).expect("it is there").shape.clone();
            let manifolds = all(&ground, &pose(vec2(0, 0), 0), &shape, &at);
            let (_, manifold) =
                manifolds.iter().find(|(part, _)| *part == contact.parts[0] as usize).expect("its own manifold");
            assert_eq!(contact.points().len(), manifold.count, "{step}");
        }
    }
    // Some have several contacts, of which one is relieved by the others.
    assert!(pressed > 1_000 && count * 100 > pressed * 95, "{count} of {pressed}");
}

/// A disc with its middle less than 2 cm behind an outward corner leaves by the nearer of the two sides, and by that one alone.
#[test]
fn a_disc_behind_a_corner_leaves_by_the_nearer_side() {
    // Up a wall on the left, and along the top to the left.
    let corner = chain(&[vec2(0, -4), vec2(0, 0), vec2(-4, 0)], false);
    let disc = Shape::circle(fx!(0.5)).expect("a disc");
    for (x, y, normal, part) in
        [(fx!(-0.015), fx!(-0.005), [0, 1 << 30], 1), (fx!(-0.005), fx!(-0.015), [1 << 30, 0], 0)]
    {
        let manifolds = all(&corner, &pose(vec2(0, 0), 0), &disc, &pose(vec2(x, y), 0));
        let sides: Vec<_> = manifolds.iter().map(|(part, manifold)| (*part, manifold.normal)).collect();
        assert_eq!(sides, [(part, normal)]);
    }
}
