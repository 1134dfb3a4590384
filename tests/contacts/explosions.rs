//! Explosions: closed forms, falloff, symmetry, order of insertion, and refusal as a whole.

use crate::seeds::run_seed;
use umbra_physics::{
    Activity, BodyDef, BodyId, ColliderDef, Command, Error, Explosion, Filter, Fx, Mass, Part, Quantity, Random, Shape,
    Symmetry, Vec2, World, WorldDef, fx, limits, vec2,
};

fn world() -> World {
    World::new(WorldDef { sleep_after: Some(3), ..WorldDef::default() }).expect("a world")
}

fn add(world: &mut World, at: Vec2, collider: impl Into<ColliderDef>) -> BodyId {
    let def = BodyDef { position: at, mass: Mass::Kilograms(fx!(2)), ..BodyDef::dynamic().with_collider(collider) };
    world.add_body(def).expect("a body")
}

fn velocity(world: &World, body: BodyId) -> Vec2 {
    world.body(body).expect("a body").velocity()
}

#[test]
fn the_impulse_is_the_width_that_is_turned_to_the_centre_times_the_strength() {
    let blast = Explosion { radius: fx!(4), falloff: fx!(4), ..Explosion::new(vec2(0, 0), fx!(8)) };
    let corners = [vec2(0, -1), vec2(3, 0), vec2(0, 1)];
    // A triangle with its flat side to the centre has its corners 1 m before and 2 m behind its centre of mass.
    let cases: [(Shape, Fx, Fx); 6] = [
        (Shape::rectangle(2, 3).unwrap(), fx!(3), fx!(12)),
        (Shape::circle(fx!(0.5)).unwrap(), fx!(3), fx!(4)),
        (Shape::capsule(2, fx!(0.25)).unwrap(), fx!(3), fx!(2)),
        (Shape::polygon(&corners).unwrap(), fx!(3), fx!(8)),
        // Its near side is 6 m away: a half of it. Then 8 m, and more.
        (Shape::rectangle(2, 3).unwrap(), fx!(7), fx!(6)),
        (Shape::rectangle(2, 3).unwrap(), fx!(9), fx!(0)),
    ];
    for (shape, x, expected) in cases {
        for sign in [1, -1] {
            let mut world = world();
            let body = add(&mut world, vec2(x, 0), shape.clone());
            world.explode(&Explosion { impulse: blast.impulse * sign, ..blast }).unwrap();
            // J/m, m = 2 kg.
            let got = velocity(&world, body);
            assert!((got.x - expected * sign).abs() <= Fx::from_bits(2) && got.y == fx!(0), "{shape:?}: {got}");
            assert_eq!(world.body(body).unwrap().angular_velocity(), fx!(0));
        }
    }
}

#[test]
fn the_impulse_on_a_shape_is_the_impulse_on_a_body_that_has_it() {
    let mut random = Random::seeded(run_seed(0x5A));
    let mut number = |low: i32, high: i32| random.number(Fx::from(low)..=Fx::from(high));
    let disc = |x: Fx| Part {
        shape: Shape::circle(fx!(0.5)).unwrap(),
        position: Vec2::new(x, fx!(0)),
        angle: fx!(0),
        density: fx!(1),
    };
    let shapes = [
        Shape::rectangle(fx!(0.6), fx!(1.8)).unwrap(),
        Shape::capsule(fx!(1), fx!(0.3)).unwrap(),
        Shape::compound(&[disc(fx!(-1)), disc(fx!(1))]).unwrap(),
    ];
    let mut hits = 0;
    for run in 0..300 {
        let (at, angle) = (Vec2::new(number(-6, 6), number(-6, 6)), number(-3, 3));
        let shape = &shapes[run % shapes.len()];
        let blast = Explosion { radius: fx!(1), falloff: fx!(5), ..Explosion::new(vec2(1, 0), number(-30, 30)) };
        let impulse = blast.impulse_on(shape, at, angle).unwrap();
        let mut world = world();
        let def = BodyDef { position: at, angle, mass: Mass::Kilograms(fx!(2)), ..BodyDef::dynamic() };
        let body = world.add_body(def.with_collider(shape.clone())).unwrap();
        world.explode(&blast).unwrap();
        let difference = velocity(&world, body) * 2 - impulse;
        assert!(difference.x.abs().max(difference.y.abs()) <= Fx::from_bits(6), "run {run}: {difference}");
        hits += usize::from(impulse != vec2(0, 0));
    }
    assert!((100..300).contains(&hits), "{hits}");
    let far = Explosion { radius: fx!(5000), ..Explosion::new(vec2(0, 0), fx!(1)) };
    assert_eq!(
        far.impulse_on(&shapes[0], vec2(0, 0), fx!(0)),
        Err(Error::OutOfRange { quantity: Quantity::ExplosionRadius })
    );
    let blast = Explosion { radius: fx!(1), ..far };
    let beyond = Vec2::new(limits::POSITION + Fx::ONE, fx!(0));
    assert_eq!(blast.impulse_on(&shapes[0], beyond, fx!(0)), Err(Error::OutOfRange { quantity: Quantity::Position }));
}

#[test]
fn a_body_that_is_hit_beside_its_centre_turns_and_is_pushed_straight_out() {
    let mut world = world();
    let bar = add(&mut world, vec2(4, 2), Shape::rectangle(2, 6).unwrap());
    world.explode(&Explosion { radius: fx!(10), ..Explosion::new(vec2(0, 0), fx!(3)) }).unwrap();
    // The nearest point is (3, 0), 2 m below the centre: 3·6 N·s along x, so 18·2 N·m·s; I = 2·(2² + 6²)/12.
    let body = world.body(bar).unwrap();
    assert_eq!(body.velocity(), vec2(9, 0));
    let expected = fx!(36) / (fx!(2) * 40 / 12);
    assert!((body.angular_velocity() - expected).abs() <= Fx::from_bits(2), "{}", body.angular_velocity());
}

#[test]
fn a_collider_around_the_centre_is_pushed_towards_its_own_centre_and_stays_if_both_are_one_point() {
    let blast = Explosion::new(vec2(0, 0), fx!(1));
    let mut world = world();
    let beside = add(&mut world, vec2(0, fx!(0.5)), Shape::rectangle(2, 2).unwrap());
    let around = add(&mut world, vec2(0, 0), Shape::circle(1).unwrap());
    world.explode(&blast).unwrap();
    assert_eq!((velocity(&world, beside), velocity(&world, around)), (vec2(0, 1), vec2(0, 0)));
}

#[test]
fn parts_and_colliders_of_one_body_count_each_by_itself() {
    let bar =
        |position: Vec2| Part { shape: Shape::rectangle(1, 2).unwrap(), position, angle: fx!(0), density: fx!(1) };
    let whole = Shape::compound(&[bar(vec2(0, 3)), bar(vec2(0, -3))]).unwrap();
    let mut together = world();
    let body = add(&mut together, vec2(3, 0), whole);
    let mut apart = world();
    let parts = [3, -3].map(|y| add(&mut apart, vec2(3, y), Shape::rectangle(1, 2).unwrap()));
    let blast = Explosion { radius: fx!(10), ..Explosion::new(vec2(0, 0), fx!(6)) };
    together.explode(&blast).unwrap();
    apart.explode(&blast).unwrap();
    // All have 2 kg.
    let sum = velocity(&apart, parts[0]) + velocity(&apart, parts[1]);
    assert!((velocity(&together, body).x - sum.x).abs() <= Fx::from_bits(2) && sum.y == fx!(0), "{sum}");
    assert_eq!(together.body(body).unwrap().angular_velocity(), fx!(0));
}

#[test]
fn an_explosion_acts_on_dynamic_bodies_of_its_categories_and_wakes_only_those() {
    let mut world = world();
    let disc = Shape::circle(1).unwrap();
    let close = add(&mut world, vec2(2, 0), disc.clone());
    let far = add(&mut world, vec2(9, 0), disc.clone());
    let filter = Filter { category: 4, ..Filter::default() };
    let filtered = add(&mut world, vec2(-2, 0), ColliderDef { filter, ..ColliderDef::new(disc.clone()) });
    let bare = world.add_body(BodyDef { position: vec2(0, 1), ..BodyDef::dynamic() }).unwrap();
    let moved = BodyDef { position: vec2(0, 2), ..BodyDef::kinematic().with_collider(disc.clone()) };
    let moved = world.add_body(moved).unwrap();
    let off = add(&mut world, vec2(0, -2), disc);
    world.disable(off).unwrap();
    (0..6).for_each(|_| _ = world.step());
    assert_eq!(world.moving_count(), 0, "all are asleep");
    world.explode(&Explosion { mask: 1, ..Explosion::new(vec2(0, 0), fx!(1)) }).unwrap();
    assert_eq!(velocity(&world, close), vec2(1, 0));
    assert_eq!(world.body(close).unwrap().activity(), Activity::Awake);
    for body in [far, filtered, bare, moved] {
        assert_eq!((velocity(&world, body), world.body(body).unwrap().activity()), (vec2(0, 0), Activity::Asleep));
    }
    assert_eq!((velocity(&world, moved), velocity(&world, off)), (vec2(0, 0), vec2(0, 0)));
}

#[test]
fn without_falloff_its_strength_ends_at_the_radius() {
    let blast = Explosion { radius: fx!(2), falloff: fx!(0), ..Explosion::new(vec2(0, 0), fx!(1)) };
    for (x, expected) in [(fx!(3), fx!(1)), (fx!(3) + Fx::DELTA, fx!(0))] {
        let mut world = world();
        let body = add(&mut world, Vec2::new(x, fx!(0)), Shape::circle(1).unwrap());
        world.explode(&blast).unwrap();
        assert_eq!(velocity(&world, body), Vec2::new(expected, fx!(0)));
    }
}

#[test]
fn an_explosion_hits_only_the_colliders_of_its_categories() {
    let mut world = world();
    let at = |y: i32, category| ColliderDef {
        position: vec2(0, y),
        filter: Filter { category, ..Filter::default() },
        ..ColliderDef::new(Shape::rectangle(1, 2).unwrap())
    };
    let def = BodyDef { position: vec2(3, 0), mass: Mass::Kilograms(fx!(2)), ..BodyDef::dynamic() };
    let body = world.add_body(def.with_collider(at(0, 1)).with_collider(at(5, 2))).unwrap();
    world.explode(&Explosion { radius: fx!(10), mask: 1, ..Explosion::new(vec2(0, 0), fx!(3)) }).unwrap();
    assert_eq!(velocity(&world, body).y, fx!(0));
}

#[test]
fn an_explosion_that_would_make_one_body_too_fast_is_refused_as_a_whole() {
    let mut world = world();
    let heavy = add(&mut world, vec2(2, 0), Shape::circle(1).unwrap());
    let light = BodyDef { position: vec2(-2, 0), mass: Mass::Kilograms(limits::MASS_MIN), ..BodyDef::dynamic() };
    world.add_body(light.with_collider(Shape::circle(1).unwrap())).unwrap();
    let before = world.state_hash();
    let blast = Explosion::new(vec2(0, 0), fx!(60000));
    let refused = Err(Error::OutOfRange { quantity: Quantity::Velocity });
    assert_eq!((world.check(&Command::Explode(blast)), world.explode(&blast)), (refused, refused));
    assert_eq!((world.state_hash(), velocity(&world, heavy)), (before, vec2(0, 0)));
    for (blast, quantity) in [
        (Explosion { radius: -Fx::DELTA, ..blast }, Quantity::ExplosionRadius),
        (Explosion { falloff: fx!(4096) + Fx::DELTA, ..blast }, Quantity::ExplosionRadius),
        (Explosion { impulse: fx!(65536) + Fx::DELTA, ..blast }, Quantity::ExplosionImpulse),
        (Explosion { position: Vec2::new(limits::POSITION + Fx::DELTA, fx!(0)), ..blast }, Quantity::Position),
    ] {
        assert_eq!(world.explode(&blast), Err(Error::OutOfRange { quantity }));
    }
}

/// Bodies at random, by keys.
fn clutter(random: &mut Random, count: u64) -> Vec<BodyDef> {
    let mut number = |max: i32| random.number(-Fx::from(max)..=Fx::from(max));
    (0..count)
        .map(|key| {
            let shape = match key % 4 {
                0 => Shape::circle(fx!(0.6)),
                1 => Shape::rounded_polygon(&[vec2(0, 0), vec2(2, 0), vec2(1, 2)], fx!(0.2)),
                2 => Shape::capsule(fx!(1), fx!(0.3)),
                _ => Shape::rectangle(fx!(1), fx!(0.5)),
            };
            let collider = ColliderDef { key, angle: number(2), ..ColliderDef::new(shape.expect("a shape")) };
            let (position, angle) = (Vec2::new(number(6), number(6)), number(3));
            BodyDef { position, angle, key, velocity: Vec2::new(number(1), number(1)), ..BodyDef::dynamic() }
                .with_collider(collider)
        })
        .collect()
}

#[test]
fn images_explode_to_images_and_order_makes_no_difference() {
    for seed in 0..30 {
        let random = &mut Random::seeded(run_seed(seed));
        let bodies = clutter(random, 16);
        let build = |bodies: &mut dyn Iterator<Item = &BodyDef>| {
            let mut world = world();
            bodies.for_each(|def| _ = world.add_body(def.clone()).expect("a body"));
            world
        };
        let (mut world, mut reordered) = (build(&mut bodies.iter()), build(&mut bodies.iter().rev()));
        let position = Vec2::new(random.number(fx!(-4)..=fx!(4)), random.number(fx!(-4)..=fx!(4)));
        let blast = Explosion { falloff: fx!(6), ..Explosion::new(position, random.number(fx!(-4)..=fx!(9))) };
        let before = world.state_hash();
        let symmetries = [Symmetry::MIRROR, Symmetry::TURN];
        let mut images = symmetries.map(|symmetry| symmetry.world(&world).expect("an image"));
        world.explode(&blast).unwrap();
        reordered.explode(&blast).unwrap();
        assert_ne!(world.state_hash(), before);
        assert_eq!(world.physics_hash(), reordered.physics_hash());
        for (symmetry, image) in symmetries.iter().zip(&mut images) {
            image.execute(&symmetry.command(&Command::Explode(blast)).unwrap()).unwrap();
            assert_eq!(
                symmetry.world(&world).map(|moved| moved.state_hash()),
                Some(image.state_hash()),
                "{symmetry:?}"
            );
        }
    }
}

/// A sensor touches nothing: an explosion does not push a body by the width of what it watches.
#[test]
fn sensors_are_not_pushed() {
    let blast = Explosion { radius: fx!(10), ..Explosion::new(vec2(0, 0), fx!(1)) };
    let solid = Shape::circle(1).unwrap();
    let mut world = world();
    let plain = add(&mut world, vec2(4, 0), solid.clone());
    let watching = add(&mut world, vec2(-4, 0), solid);
    let sensor = ColliderDef { sensor: true, ..ColliderDef::new(Shape::circle(3).unwrap()) };
    world.add_collider(watching, sensor).unwrap();
    world.explode(&blast).unwrap();
    assert_eq!(velocity(&world, watching), -velocity(&world, plain));
}
