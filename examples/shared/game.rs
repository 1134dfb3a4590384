//! A game small enough to read: two ships in the pull of a planet on which crates pile up, each with a ball on a spring, among rocks
//! that sleep until something hits them. All of them collide.
//!
//! All of its state is in the world, the game's own numbers as user data of bodies. So a copy of the world is a copy of
//! the game, and the hash of the world finds whatever differs between two peers.

use umbra_physics::{
    ApplyOptions, Attachment, BodyDef, BodyId, BodyRef, ColliderDef, Damping, End, Error, FieldId, FieldKind, Filter,
    ForceField, ForceOrImpulse, Fx, Mass, Shape, SpringConstants, TimeStep, Vec2, World, WorldDef, fx, vec2,
};

use super::random::SplitMix;

/// The bits of [`BodyDef::force_groups`].
const SHIP: u32 = 1;
const ROCK: u32 = 2;
const SHOT: u32 = 4;
const CRATE: u32 = 8;

const PUSH: Fx = fx!(40); // N
const TURN: Fx = fx!(6); // N·m
const SHOT_SPEED: Fx = fx!(30); // m/s, from the ship
const SHOT_MASS: Fx = fx!(0.125); // kg
const SHOT_TICKS: u32 = 45;
const TICK_RATE: i32 = 60; // a second
const RELOAD_TICKS: u32 = 12;

/// Buttons that a player holds down over a tick. The default is none: GGRS uses it for a player who is gone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Controls(pub(crate) u8);

impl Controls {
    const ENGINE: u8 = 1;
    const LEFT: u8 = 2;
    const RIGHT: u8 = 4;
    const FIRE: u8 = 8;

    fn holds(self, button: u8) -> bool {
        self.0 & button != 0
    }
}

/// A bot: random buttons, changed every six ticks.
pub(crate) fn bot(seed: u64, player: usize, tick: u64) -> Controls {
    let held = tick / 6;
    Controls((SplitMix(seed ^ (held << 8) ^ player as u64).next() & 15) as u8)
}

/// Events of a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Tally {
    pub(crate) fired: usize,
    pub(crate) hits: usize,
}

/// Handles that are fixed for a whole match, the same on every peer.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Game {
    pub(crate) ships: [BodyId; 2],
    engines: [FieldId; 2],
}

/// A collider of a player's, which touches nothing else of that player.
fn of_player(player: usize, shape: Shape) -> ColliderDef {
    ColliderDef { filter: Filter { group: -1 - player as i32, ..Filter::default() }, ..ColliderDef::new(shape) }
}

/// A spring with a damper between the centres of two bodies.
fn spring(start: BodyId, end: BodyId, rest: Fx) -> FieldKind {
    let spring = SpringConstants { rest, stiffness: fx!(30), damping: fx!(0.5) };
    FieldKind::Spring { near: Attachment::centre(start), far: End::Body(Attachment::centre(end)), spring }
}

fn engine(ship: BodyId, is_on: bool) -> FieldKind {
    let force = vec2(if is_on { PUSH } else { Fx::ZERO }, 0);
    FieldKind::Thrust { at: Attachment { body: ship, point: vec2(fx!(-0.75), 0) }, force }
}

/// A ship's user data: the tick from which it may fire again, and how often it was hit.
fn ship_data(ready: u32, hits: u32) -> u64 {
    u64::from(ready) << 32 | u64::from(hits)
}

fn ready_and_hits(user_data: u64) -> (u32, u32) {
    ((user_data >> 32) as u32, user_data as u32)
}

impl Game {
    /// A match at its first tick.
    ///
    /// # Errors
    /// None, unless the definitions below are edited to invalid ones.
    pub(crate) fn start() -> Result<(Self, World), Error> {
        let mut world = World::new(WorldDef {
            time_step: TimeStep::hz(TICK_RATE as u32),
            linear_damping: Damping::kept_per_second(fx!(0.75)),
            angular_damping: Damping::kept_per_second(fx!(0.25)),
            ..WorldDef::default()
        })?;
        let pull = FieldKind::Attractor { centre: End::World(Vec2::ZERO), mu: 400.into(), softening: fx!(2) };
        world.add_field(ForceField { kind: pull, force_groups: SHIP | SHOT | CRATE })?;
        // Opposite each other, in orbit around the planet.
        let mut add_ship = |player: usize, side: i32, angle: Fx| -> Result<_, Error> {
            let hull = of_player(player, Shape::rectangle(fx!(1.5), fx!(1))?);
            let ship = BodyDef {
                mass: Mass::Kilograms(fx!(2)),
                position: vec2(-12 * side, 0),
                velocity: vec2(0, 5 * side),
                angle,
                force_groups: SHIP,
                key: player as u64,
                ..BodyDef::dynamic().with_collider(hull)
            };
            let ball = BodyDef {
                mass: Mass::Kilograms(fx!(0.5)),
                position: ship.position - vec2(2 * side, 0),
                angle: Fx::ZERO,
                key: player as u64 + 2,
                colliders: vec![of_player(player, Shape::circle(fx!(0.5))?)],
                ..ship.clone()
            };
            let (ship, ball) = (world.add_body(ship)?, world.add_body(ball)?);
            world.add_field(spring(ship, ball, fx!(2)))?;
            Ok((ship, world.add_field(engine(ship, false))?))
        };
        let (left, right) = (add_ship(0, 1, Fx::ZERO)?, add_ship(1, -1, fx!(3.1415926535))?);
        let rock = BodyDef {
            mass: Mass::Kilograms(fx!(4)),
            // Soon at rest again, and asleep.
            linear_damping: Some(Damping::kept_per_second(fx!(0.0001))),
            angular_damping: Some(Damping::kept_per_second(fx!(0.0001))),
            force_groups: ROCK,
            ..BodyDef::dynamic().with_collider(Shape::circle(fx!(1))?)
        };
        for (key, (x, y)) in (10..).zip([(0, 7), (6, 4), (6, -4), (0, -7), (-6, -4), (-6, 4)]) {
            world.add_body(BodyDef { position: vec2(x, y), key, ..rock.clone() })?;
        }
        // Bodies that are joined sleep and wake together.
        let bound = [(20, -2), (21, 2)].map(|(key, x)| BodyDef { position: vec2(x, 18), key, ..rock.clone() });
        let [a, b] = bound.map(|def| world.add_body(def));
        world.add_field(spring(a?, b?, fx!(4)))?;
        let planet = BodyDef { key: 30, ..BodyDef::fixed().with_collider(Shape::circle(fx!(1.5))?) };
        world.add_body(planet)?;
        let crate_ = BodyDef {
            force_groups: CRATE,
            ..BodyDef::dynamic().with_collider(Shape::rectangle(fx!(0.75), fx!(0.75))?)
        };
        for (key, (x, y)) in (31..).zip([(3, 1), (1, 3), (-1, 3), (-3, 1), (-3, -1), (-1, -3), (1, -3), (3, -1)]) {
            world.add_body(BodyDef { position: vec2(x, y), key, ..crate_.clone() })?;
        }
        Ok((Self { ships: [left.0, right.0], engines: [left.1, right.1] }, world))
    }

    /// Makes the calls of a tick from the world and the buttons alone; after them the world is stepped.
    ///
    /// # Errors
    /// An error of the world: the same for every peer.
    pub(crate) fn act(&self, world: &mut World, controls: [Controls; 2]) -> Result<Tally, Error> {
        let mut tally = Tally::default();
        for (player, held) in controls.into_iter().enumerate() {
            tally.fired += usize::from(self.steer(world, player, held)?);
        }
        tally.hits = self.strike(world)?;
        Ok(tally)
    }

    /// Applies a player's buttons to the ship; returns true if it fired.
    fn steer(&self, world: &mut World, player: usize, held: Controls) -> Result<bool, Error> {
        let (ship, engine_field) = (self.ships[player], self.engines[player]);
        let torque = match (held.holds(Controls::LEFT), held.holds(Controls::RIGHT)) {
            (true, false) => TURN,
            (false, true) => -TURN,
            _ => Fx::ZERO,
        };
        if torque != Fx::ZERO {
            world.apply_torque(ship, torque)?;
        }
        let wanted = engine(ship, held.holds(Controls::ENGINE));
        if world.field(engine_field)?.kind != wanted {
            world.set_field(engine_field, wanted)?;
        }
        let look = world.body(ship)?;
        let (ready, hits) = ready_and_hits(look.user_data());
        // A match is over long before its ticks leave 32 bits.
        let now = world.tick() as u32;
        if !held.holds(Controls::FIRE) || now < ready {
            return Ok(false);
        }
        let ahead = |length: Fx| look.rotation().checked_rotate(vec2(length, 0)).unwrap_or(Vec2::ZERO);
        let shot = BodyDef {
            mass: Mass::Kilograms(SHOT_MASS),
            position: look.position() + ahead(fx!(1)),
            velocity: look.velocity() + ahead(SHOT_SPEED),
            linear_damping: Some(Damping::NONE),
            force_groups: SHOT,
            key: 100 + player as u64,
            user_data: u64::from(now + SHOT_TICKS),
            ..BodyDef::dynamic().with_collider(of_player(player, Shape::circle(fx!(0.125))?))
        };
        world.add_body(shot)?;
        let recoil = ForceOrImpulse::Impulse { impulse: vec2(-(SHOT_SPEED * SHOT_MASS), 0), point: None };
        world.apply(ship, recoil, ApplyOptions::BODY)?;
        world.set_user_data(ship, ship_data(now + RELOAD_TICKS, hits))?;
        Ok(true)
    }

    /// Takes out the shots that hit something in the last tick or have flown for long enough; the number of hits.
    fn strike(&self, world: &mut World) -> Result<usize, Error> {
        let mut hits = 0;
        let is_shot = |body: &BodyRef<'_>| body.force_groups() == SHOT;
        let shots: Vec<BodyId> = world.bodies().filter(is_shot).map(|shot| shot.id()).collect();
        for shot in shots {
            let targets: Vec<BodyId> = world.contacts_of(shot)?.flat_map(|contact| contact.bodies).collect();
            for ship in self.ships.into_iter().filter(|ship| targets.contains(ship)) {
                let (ready, hits) = ready_and_hits(world.body(ship)?.user_data());
                world.set_user_data(ship, ship_data(ready, hits + 1))?;
            }
            if !targets.is_empty() || world.body(shot)?.user_data() <= world.tick() {
                world.remove_body(shot)?;
            }
            hits += usize::from(!targets.is_empty());
        }
        Ok(hits)
    }
}
