//! Characters: slopes, steps, seams, platforms, pushes, walls, and mirror images to the bit.

mod ahead;
mod belts;
mod platforms;
mod pushes;
mod random;
mod slopes;
mod steps;

use std::collections::BTreeSet;

use umbra_physics::{
    BodyDef, BodyId, BodyKind, Character, ColliderDef, Command, Error, ForceOrImpulse, Fx, Ground, Locks, Mass,
    Movement, OneWay, Part, Quantity, QueryFilter, Random, Shape, Symmetry, TimeStep, Vec2, World, WorldDef, fx, vec2,
};

const ALL: QueryFilter<'_> = QueryFilter { filter: None, without_bodies: &[], without_colliders: &[], predicate: None };

/// The skin of a new character, and how far from it one stands.
const SKIN: Fx = fx!(0.015625);
const NEAR: Fx = Fx::from_bits(6);

fn world() -> World {
    let def = WorldDef { time_step: TimeStep::hz(64), gravity: vec2(0, -10), ..WorldDef::default() };
    World::new(def).expect("a world")
}

fn add(world: &mut World, def: BodyDef, at: Vec2, shape: Shape) -> BodyId {
    world.add_body(BodyDef { position: at, ..def.with_collider(shape) }).expect("a body")
}

fn bar(width: Fx, height: Fx) -> Shape {
    Shape::rectangle(width, height).expect("a bar")
}

/// A character of 0.5 m by 1 m: its centre is 0.5 m above its sole.
fn hero() -> Character {
    Character::new(bar(fx!(0.5), fx!(1)))
}

/// A character between two calls.
#[derive(Clone, Debug)]
struct Walk {
    hero: Character,
    position: Vec2,
    ground: Option<Ground>,
}

impl Walk {
    fn new(hero: Character, position: Vec2) -> Self {
        Self { hero, position, ground: None }
    }

    fn go(&mut self, world: &World, translation: Vec2) -> Movement {
        self.go_past(world, translation, &ALL)
    }

    fn go_past(&mut self, world: &World, translation: Vec2, filter: &QueryFilter<'_>) -> Movement {
        let moved = self
            .hero
            .translate(&world.queries(), self.position, self.ground, translation, filter)
            .expect("a movement in range");
        (self.position, self.ground) = (moved.position, moved.ground);
        moved
    }

    /// Goes on for some steps, standing on a body.
    fn ride(&mut self, world: &mut World, platform: BodyId, ticks: u32) {
        for tick in 0..ticks {
            world.step();
            self.go(world, vec2(0, fx!(-0.01)));
            assert_eq!(self.ground.map(|ground| ground.body), Some(platform), "tick {tick}: {}", self.position);
        }
    }

    /// Lets it fall onto what is below.
    fn land(&mut self, world: &World) {
        for _ in 0..200 {
            self.go(world, vec2(0, fx!(-0.1)));
        }
        assert!(self.ground.is_some(), "{self:?}");
    }
}

/// A floor whose surface is at y = 0, and steps of a height, each 2 m long, up to the right from x = 0 on.
fn stairs(height: Fx, count: i32) -> World {
    let mut world = world();
    add(&mut world, BodyDef::fixed(), vec2(-10, -5), bar(fx!(20), fx!(10)));
    for i in 0..count {
        let top = height * (i + 1);
        add(&mut world, BodyDef::fixed(), vec2(2 * i + 1, top - fx!(5)), bar(fx!(2), fx!(10)));
    }
    add(&mut world, BodyDef::fixed(), vec2(2 * count + 10, height * count - fx!(5)), bar(fx!(20), fx!(10)));
    world
}

#[test]
fn a_character_stops_in_corners_without_a_jitter() {
    for angle in [fx!(0), fx!(0.2), fx!(0.5)] {
        let mut world = world();
        add(&mut world, BodyDef { angle, ..BodyDef::fixed() }, vec2(0, -5), bar(fx!(40), fx!(10)));
        add(&mut world, BodyDef { angle: -angle, ..BodyDef::fixed() }, vec2(8, 0), bar(fx!(4), fx!(40)));
        let mut walk = Walk::new(hero(), vec2(0, 3));
        walk.land(&world);
        for _ in 0..200 {
            walk.go(&world, vec2(fx!(0.1), fx!(-0.05)));
        }
        let stopped = walk.position;
        for _ in 0..200 {
            let moved = walk.go(&world, vec2(fx!(0.1), fx!(-0.05)));
            assert_eq!(walk.position, stopped, "{angle}");
            assert!(moved.hits.len() >= 2 && moved.ground.is_some());
        }
    }
}

#[test]
fn a_ceiling_stops_it_and_it_slides_along() {
    let mut world = world();
    add(&mut world, BodyDef::fixed(), vec2(0, 5), bar(fx!(40), fx!(2)));
    let mut walk = Walk::new(hero(), vec2(0, 2));
    let moved = walk.go(&world, vec2(1, 3));
    assert_eq!((moved.hits.len(), moved.hits[0].normal, moved.ground), (1, vec2(0, -1), None));
    assert!((walk.position.y - fx!(3.5) + SKIN).abs() <= NEAR);
    assert!((walk.position.x - fx!(1)).abs() <= NEAR, "{}", walk.position);
}

/// A hero on a floor at y = 0, and what else is there.
fn on_floor(hero: Character, x: i32, more: impl FnOnce(&mut World)) -> (World, Walk) {
    let mut world = world();
    add(&mut world, BodyDef::fixed(), vec2(0, -5), bar(fx!(100), fx!(10)));
    let mut walk = Walk::new(hero, vec2(x, 1));
    walk.land(&world);
    more(&mut world);
    (world, walk)
}

#[test]
fn a_character_is_pushed_out_by_a_metre_at_most_and_upwards_where_ways_tie() {
    let place = |size: Fx, at: Vec2| {
        let mut world = world();
        add(&mut world, BodyDef::fixed(), vec2(0, 0), bar(size, size));
        let mut walk = Walk::new(Character::new(bar(fx!(0.5), fx!(0.5))), at);
        (walk.go(&world, vec2(0, 0)).is_overlapping, walk.position)
    };
    let (is_overlapping, at) = place(fx!(20), vec2(0, 7));
    assert!(is_overlapping && at.y <= fx!(8) && at.x == fx!(0), "{at}");
    let (is_overlapping, at) = place(fx!(0.5), vec2(0, 0));
    assert!(!is_overlapping && (at.y - fx!(0.5) - SKIN).abs() <= NEAR && at.x == fx!(0), "{at}");
}

#[test]
fn settings_and_translations_out_of_range_are_refused() {
    let world = world();
    let refused = |hero: &Character, translation: Vec2| {
        hero.translate(&world.queries(), vec2(0, 0), None, translation, &ALL).map(drop).map_err(|error| match error {
            Error::OutOfRange { quantity } => quantity,
            error => panic!("{error}"),
        })
    };
    let limit = fx!(256);
    assert_eq!(refused(&hero(), vec2(limit, -limit)), Ok(()));
    assert_eq!(refused(&hero(), vec2(0, limit + Fx::DELTA)), Err(Quantity::CharacterTranslation));
    let cases: [(Character, Quantity); 10] = [
        (Character { skin: fx!(0), ..hero() }, Quantity::CharacterSkin),
        (Character { skin: fx!(1) + Fx::DELTA, ..hero() }, Quantity::CharacterSkin),
        (Character { up: vec2(0, 0), ..hero() }, Quantity::CharacterUp),
        (Character { up: vec2(0, 2_000), ..hero() }, Quantity::CharacterUp),
        (Character { max_slope: fx!(1.6), ..hero() }, Quantity::CharacterSlope),
        (Character { max_rest_slope: -Fx::DELTA, ..hero() }, Quantity::CharacterSlope),
        (Character { step_height: fx!(17), ..hero() }, Quantity::CharacterStep),
        (Character { step_width: fx!(-1), ..hero() }, Quantity::CharacterStep),
        (Character { snap: fx!(17), ..hero() }, Quantity::CharacterStep),
        (Character { push_mass: fx!(-1), ..hero() }, Quantity::Mass { value: fx!(-1) }),
    ];
    for (hero, quantity) in cases {
        assert_eq!(refused(&hero, vec2(0, 0)), Err(quantity));
    }
    let chain = Shape::chain(&[vec2(0, 0), vec2(1, 0)], false).unwrap();
    assert_eq!(Character::new(chain).check(), Err(Error::DynamicChain));
}
