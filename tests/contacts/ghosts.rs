//! Colliders whose filter meets nothing: mass and an outline, and nothing else.

use super::scenes::{def, ground, square, world};
use umbra_physics::{
    Activity, BodyDef, BodyId, ColliderDef, Explosion, FieldKind, Filter, Fx, FxFactor, Mass, OneWay, QueryFilter,
    Shape, Snapshot, Vec2, World, WorldDef, fx, vec2,
};

/// All that a step changes of a body, to the bit.
fn bits(world: &World, body: BodyId) -> impl PartialEq + std::fmt::Debug + use<> {
    let body = world.body(body).expect("it is there");
    let motion = (body.position_exact(), body.velocity_exact(), body.angular_velocity_exact());
    (motion, body.angle_exact().to_bits(), body.activity())
}

/// Filters that meet nothing.
fn nothing() -> impl Iterator<Item = Filter> {
    [(0, 0, 0), (1, 0, 0), (0, !0, 0), (0, 2, -3), (7, 0, i32::MIN)].into_iter().map(|(category, mask, group)| Filter {
        category,
        mask,
        group,
    })
}

fn disc(filter: Filter) -> ColliderDef {
    ColliderDef { filter, ..ColliderDef::new(Shape::circle(1).expect("a disc")) }
}

/// A wall, a sensor, a loose ball and a fluid around the origin, and a body with these colliders that flies through all of them.
fn thicket(colliders: Vec<ColliderDef>, sleep_after: Option<u32>) -> (World, BodyId) {
    let wall = BodyDef::fixed().with_collider(Shape::rectangle(1, 9).expect("a wall"));
    let sensor = ColliderDef { sensor: true, ..disc(Filter::default()) };
    let ball = BodyDef { position: vec2(-3, 0), ..BodyDef::dynamic().with_collider(disc(Filter::default())) };
    let flier = BodyDef {
        position: vec2(-9, fx!(0.25)),
        velocity: vec2(7, 0),
        angular_velocity: fx!(2),
        // As of a disc of 1 m², so that what is compared has the same without one.
        mass: Mass::Explicit { mass: fx!(3), inertia: fx!(1.5) },
        bullet: true,
        colliders,
        ..BodyDef::dynamic()
    };
    let bodies = [wall, BodyDef { position: vec2(4, 0), ..BodyDef::fixed().with_collider(sensor) }, ball, flier];
    let (mut world, ids) = world(WorldDef { sleep_after, gravity: vec2(0, -1), ..def() }, bodies).expect("a scene");
    let (min, max) = (vec2(-20, -20), vec2(20, 20));
    let (density, drag) = (fx!(0.5), fx!(0.5));
    let fluid = FieldKind::Buoyancy { min, max, density, linear_drag: drag, angular_drag: drag, flow: Vec2::ZERO };
    world.add_field(fluid).expect("a fluid");
    (world, ids[3])
}

#[test]
fn a_body_with_a_collider_that_meets_nothing_flies_as_one_without() {
    for filter in nothing() {
        let kinds: [fn(ColliderDef) -> ColliderDef; 3] = [
            |plain| plain,
            |plain| ColliderDef { sensor: true, ..plain },
            |plain| ColliderDef {
                one_way: Some(OneWay::default()),
                contact_events: true,
                hit_events: true,
                position: vec2(0, fx!(0.5)),
                ..plain
            },
        ];
        for (kind, sleep_after) in kinds.into_iter().flat_map(|kind| [(kind, None), (kind, Some(5))]) {
            let (mut here, body) = thicket(vec![kind(disc(filter))], sleep_after);
            let (mut alone, twin) = thicket(Vec::new(), sleep_after);
            for step in 0..240 {
                if step == 100 {
                    let blast = Explosion { radius: fx!(30), ..Explosion::new(vec2(0, -2), fx!(1)) };
                    here.explode(&blast).expect("in range");
                    alone.explode(&blast).expect("in range");
                }
                here.step();
                alone.step();
                assert_eq!(bits(&here, body), bits(&alone, twin), "{filter}, step {step}");
                let report = here.last_report();
                let pairs = [report.sensors_entered, report.sensors_crossed, report.contacts_began];
                assert!(pairs.into_iter().flatten().all(|pair| !pair.bodies.contains(&body)), "{filter}");
                assert_eq!(here.contacts_of(body).expect("it is there").count(), 0, "{filter}");
            }
            let read = Snapshot::from_bytes(&here.snapshot().to_bytes(), &[]).expect("a snapshot");
            assert_eq!(read.world().state_hash(), here.state_hash());
        }
    }
    // One that meets others is stopped.
    let (mut here, body) = thicket(vec![disc(Filter::default())], None);
    (0..240).for_each(|_| _ = here.step());
    assert!(here.body(body).expect("it is there").position().x < fx!(0));
}

#[test]
fn no_query_finds_a_collider_that_meets_nothing() {
    for filter in nothing() {
        let body = BodyDef::dynamic().with_collider(disc(filter));
        let (world, _) = world(
            def(),
            [body.clone(), BodyDef { position: vec2(0, 3), ..BodyDef::fixed() }.with_collider(disc(filter))],
        )
        .expect("a scene");
        let queries = world.queries();
        for asked in [None, Some(Filter::default()), Some(Filter { category: !0, mask: !0, group: filter.group })] {
            let all = QueryFilter { filter: asked, ..QueryFilter::default() };
            assert_eq!(queries.cast_ray(vec2(-9, 0), vec2(20, 0), &all), Ok(None));
            assert_eq!(queries.overlap_point(vec2(0, 0), &all), Ok(Vec::new()));
            assert_eq!(queries.overlap_point(vec2(0, 3), &all), Ok(Vec::new()));
            assert!(queries.closest_points(vec2(3, 0), fx!(9), &all).expect("in range").is_empty());
        }
        // Asked itself it answers.
        assert!(body.colliders[0].shape.contains(vec2(0, 0)));
    }
}

#[test]
fn a_collider_that_is_to_meet_nothing_lets_go_and_holds_again() {
    for (is_ground, sleep_after) in [(true, None), (true, Some(5)), (false, None), (false, Some(5))] {
        let bodies = [ground().expect("a ground"), square(vec2(0, fx!(0.5)), 1).expect("a square")];
        let (mut world, ids) = world(WorldDef { sleep_after, ..def() }, bodies).expect("a scene");
        (0..60).for_each(|_| _ = world.step());
        let square = ids[1];
        let expected = if sleep_after.is_some() { Activity::Asleep } else { Activity::Awake };
        assert_eq!(world.body(square).expect("it is there").activity(), expected);
        let height = |world: &World| world.body(square).expect("it is there").position().y;
        let rests = height(&world);
        let changed = world.colliders_of(ids[usize::from(!is_ground)]).expect("it is there").next().expect("one");
        let solid = world.collider(changed).expect("it is there").clone();
        world.set_collider(changed, ColliderDef { filter: Filter::NONE, ..solid.clone() }).expect("a collider");
        (0..6).for_each(|_| _ = world.step());
        assert!(height(&world) < rests - fx!(0.02), "{is_ground}, {sleep_after:?}");
        assert_eq!(world.contacts().count(), 0);
        world.set_collider(changed, solid).expect("a collider");
        (0..120).for_each(|_| _ = world.step());
        assert!((height(&world) - rests).abs() < fx!(0.02), "{is_ground}, {sleep_after:?}: {}", height(&world));
    }
}

#[test]
fn a_ghost_gives_mass_and_inertia_as_any_collider() {
    let shape = Shape::rectangle(2, 1).expect("a shape");
    let with = |collider: ColliderDef| {
        let (world, ids) = world(def(), [BodyDef::dynamic().with_collider(collider)]).expect("a scene");
        let body = world.body(ids[0]).expect("it is there");
        (body.mass(), body.inertia(), body.inverse_mass(), body.inverse_inertia())
    };
    let placed = |collider: ColliderDef| ColliderDef { position: vec2(1, 2), density: fx!(3), ..collider };
    assert_eq!(with(placed(ColliderDef::ghost(shape.clone()))), with(placed(ColliderDef::new(shape.clone()))));
    let (mass, inertia, ..) = with(ColliderDef::ghost(shape));
    assert_eq!(mass, Some(fx!(2)));
    // m·(w² + h²)/12
    let right = Fx::from_ratio(5, 6);
    assert!(inertia.and_then(FxFactor::to_scalar).is_some_and(|inertia| (inertia - right).abs() <= Fx::DELTA));
}
