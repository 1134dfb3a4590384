//! Characters that move before a step, as the guide has it: where they stand after it.

use super::*;

/// A match of one character whose body goes where it gets, before each step.
struct Play {
    world: World,
    hero: Character,
    body: BodyId,
    ground: Option<Ground>,
    rise: Fx,
    held_back: Vec2,
}

const TICK: Fx = fx!(0.015625);

impl Play {
    fn new(mut world: World, hero: Character, at: Vec2) -> Self {
        let body = world.add_body(BodyDef { position: at, ..BodyDef::kinematic() }).unwrap();
        Self { world, hero, body, ground: None, rise: fx!(0), held_back: vec2(0, 0) }
    }

    fn position(&self) -> Vec2 {
        self.world.body(self.body).unwrap().position()
    }

    /// Where it is drawn, and where the next tick begins: it follows what fled from it in the step.
    fn drawn(&self) -> Movement {
        let others = QueryFilter { without_bodies: &[self.body], ..ALL };
        let queries = self.world.queries();
        self.hero.translate(&queries, self.position(), self.ground, self.held_back, &others).unwrap()
    }

    /// A tick at 64 Hz: it runs with a speed and falls, pushes what it meets, and then comes the step.
    fn tick(&mut self, speed: Fx) -> Movement {
        let start = self.drawn();
        self.rise = if start.ground.is_some() { fx!(0) } else { self.rise } - fx!(20) * TICK;
        let others = QueryFilter { without_bodies: &[self.body], ..ALL };
        let way = Vec2::new(speed * TICK, self.rise * TICK);
        let queries = self.world.queries_after_step();
        let moved = self.hero.translate(&queries, start.position, start.ground, way, &others).unwrap();
        drop(queries);
        for push in self.hero.push(&self.world, &moved) {
            self.world.execute(&push).unwrap();
        }
        self.world.move_to(self.body, moved.position, Fx::ZERO).unwrap();
        (self.ground, self.held_back) = (moved.ground, moved.held_back);
        self.world.step();
        moved
    }
}

/// How far the sole is above the top of a box that is not turned.
fn gap_above(play: &Play, body: BodyId, half_height: Fx) -> Fx {
    let top = play.world.body(body).unwrap().position().y + half_height;
    play.position().y - fx!(0.5) - top
}

#[test]
fn a_lift_and_who_rides_it_are_together_after_the_step() {
    for velocity in [vec2(0, 4), vec2(0, -4), vec2(3, fx!(-7)), vec2(-2, fx!(1.3))] {
        let mut world = world();
        let lift = add(&mut world, BodyDef { velocity, ..BodyDef::kinematic() }, vec2(0, 0), bar(fx!(6), fx!(0.5)));
        let mut play = Play::new(world, hero(), vec2(fx!(0.5), fx!(1)));
        for tick in 0..256 {
            let moved = play.tick(fx!(0));
            if tick < 64 {
                continue;
            }
            assert_eq!(moved.ground_velocity, velocity);
            let gap = gap_above(&play, lift, fx!(0.25));
            assert!((gap - SKIN).abs() <= NEAR, "{velocity} {tick}: {gap}");
        }
        let beside = play.position().x - play.world.body(lift).unwrap().position().x;
        (0..64).for_each(|_| _ = play.tick(fx!(0)));
        assert_eq!(play.position().x - play.world.body(lift).unwrap().position().x, beside);
    }
}

#[test]
fn a_lift_that_is_sent_to_places_leaves_no_gap_either_where_it_turns_around() {
    let mut world = world();
    let lift = add(&mut world, BodyDef::kinematic(), vec2(0, 0), bar(fx!(6), fx!(0.5)));
    let mut play = Play::new(world, hero(), vec2(fx!(0.5), fx!(1)));
    let mut height = fx!(0);
    for tick in 0..640 {
        let speed = if tick < 64 || tick % 3 == 2 { fx!(0) } else { fx!(4) };
        height += if tick / 64 % 2 == 0 { speed } else { -speed } * TICK;
        play.world.move_to(lift, Vec2::new(fx!(0), height), fx!(0)).unwrap();
        play.tick(fx!(0));
        let gap = gap_above(&play, lift, fx!(0.25));
        assert!(tick < 64 || (gap - SKIN).abs() <= NEAR, "{tick}: {gap}");
    }
    // Without a new target it stops.
    play.tick(fx!(0));
    assert!((gap_above(&play, lift, fx!(0.25)) - SKIN).abs() <= NEAR);
}

#[test]
fn seen_as_they_are_before_the_step_lifts_leave_the_way_of_a_tick() {
    let mut world = world();
    let lift =
        add(&mut world, BodyDef { velocity: vec2(0, 4), ..BodyDef::kinematic() }, vec2(0, 0), bar(fx!(6), fx!(1)));
    let mut walk = Walk::new(hero(), vec2(0, 2));
    walk.land(&world);
    for _ in 0..64 {
        walk.go(&world, vec2(0, fx!(-0.01)));
        world.step();
    }
    let gap = walk.position.y - fx!(1) - world.body(lift).unwrap().position().y;
    assert!((gap - SKIN + fx!(4) * TICK).abs() <= NEAR, "{gap}");
}

#[test]
fn a_wall_that_comes_is_never_in_a_character_after_the_step() {
    let mut world = world();
    add(&mut world, BodyDef::fixed(), vec2(0, fx!(-0.5)), bar(fx!(40), fx!(1)));
    let wall =
        add(&mut world, BodyDef { velocity: vec2(4, 0), ..BodyDef::kinematic() }, vec2(-2, 1), bar(fx!(1), fx!(2)));
    let mut play = Play::new(world, hero(), vec2(0, 1));
    let mut narrowest_gap = Fx::MAX;
    for _ in 0..128 {
        assert!(!play.tick(fx!(0)).is_overlapping);
        narrowest_gap = narrowest_gap.min(play.position().x - play.world.body(wall).unwrap().position().x - fx!(0.75));
    }
    assert!((narrowest_gap - SKIN).abs() <= NEAR, "{narrowest_gap}");
}

#[test]
fn a_dynamic_raft_and_who_rides_it_are_together_after_the_step() {
    let mut world = world();
    let def = BodyDef { velocity: vec2(1, 2), gravity_scale: fx!(0), ..BodyDef::dynamic() };
    let raft = add(&mut world, def, vec2(0, 0), bar(fx!(6), fx!(0.5)));
    let mut play = Play::new(world, hero(), vec2(fx!(0.5), fx!(1)));
    for tick in 0..256 {
        play.tick(fx!(0));
        let gap = gap_above(&play, raft, fx!(0.25));
        assert!(tick < 64 || (gap - SKIN).abs() <= NEAR, "{tick}: {gap}");
    }
    // One that turns as well: the centre keeps its distance from the surface in the axes of the raft.
    let mut world = self::world();
    let def = BodyDef { angular_velocity: fx!(0.25), gravity_scale: fx!(0), ..BodyDef::dynamic() };
    let raft = add(&mut world, def, vec2(0, 0), bar(fx!(6), fx!(0.5)));
    let mut play = Play::new(world, Character::new(Shape::circle(fx!(0.5)).unwrap()), vec2(fx!(1), fx!(1)));
    for tick in 0..160 {
        play.tick(fx!(0));
        let local = play.world.body(raft).unwrap().local_point(play.position()).unwrap();
        assert!(tick < 32 || (local.y - fx!(0.75) - SKIN).abs() <= NEAR, "{tick}: {local}");
    }
}

#[test]
fn a_runner_keeps_the_speed_that_the_masses_and_friction_leave_and_is_drawn_beside_the_crate() {
    for (mass, least) in [(5, fx!(3.85)), (30, fx!(3.78)), (100, fx!(3.5)), (400, fx!(2.55))] {
        let mut world = world();
        world.set_gravity(vec2(0, -25)).unwrap();
        add(&mut world, BodyDef::fixed(), vec2(0, -5), bar(fx!(400), fx!(10)));
        let def = BodyDef { mass: Mass::Kilograms(Fx::from(mass)), ..BodyDef::dynamic() };
        let crate_ = add(&mut world, def, vec2(3, fx!(0.5)), bar(fx!(1), fx!(1)));
        let hero = Character { push_mass: fx!(80), ..Character::new(bar(fx!(0.8), fx!(1.6))) };
        let mut play = Play::new(world, hero, vec2(0, 1));
        (0..128).for_each(|_| _ = play.tick(fx!(4)));
        let start = play.drawn().position;
        for tick in 0..128 {
            play.tick(fx!(4));
            let drawn = play.drawn().position;
            let gap = play.world.body(crate_).unwrap().position().x - fx!(0.9) - drawn.x;
            assert!((gap - SKIN).abs() < fx!(0.0005), "{mass} kg, tick {tick}: {gap}");
            assert!((drawn.y - play.position().y).abs() <= NEAR, "{drawn}");
        }
        let end = play.drawn().position;
        // The crate is given 4·M/(M + m) + v·m/(M + m), and friction takes 0.6·25/64 m/s off it within the step: it has v in the end.
        let speed = (end.x - start.x) / 2;
        let loss = fx!(0.6) * 25 / 64;
        let [last, pushed] = [fx!(4) - loss * (80 + mass) / 80, fx!(4) - loss * mass / 80];
        assert!(speed > least && (speed - (last + pushed) / 2).abs() < fx!(0.03), "{mass} kg: {speed}");
    }
}

#[test]
fn a_runner_who_stops_pushing_stands_and_is_not_drawn_back() {
    let mut world = world();
    add(&mut world, BodyDef::fixed(), vec2(0, -5), bar(fx!(400), fx!(10)));
    let def = BodyDef { mass: Mass::Kilograms(fx!(20)), ..BodyDef::dynamic() };
    add(&mut world, def, vec2(3, fx!(0.5)), bar(fx!(1), fx!(1)));
    // A wall ends the way.
    add(&mut world, BodyDef::fixed(), vec2(12, 2), bar(fx!(1), fx!(4)));
    let mut play = Play::new(world, Character { push_mass: fx!(80), ..hero() }, vec2(0, 1));
    let mut last = fx!(0);
    for tick in 0..400 {
        play.tick(if tick % 100 < 60 { fx!(4) } else { fx!(0) });
        let drawn = play.drawn();
        // A wall pushes the crate out by a little.
        let way = drawn.position.x - last;
        assert!(way >= fx!(-0.002) && way <= fx!(4) * TICK + NEAR, "{tick}: {way}");
        assert!(!drawn.is_overlapping);
        last = drawn.position.x;
    }
    assert!(last > fx!(9), "{last}");
}
