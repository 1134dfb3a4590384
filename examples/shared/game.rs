//! A game small enough to read: two ships in the pull of a star, each with a ball on a spring, among rocks that sleep until
//! something hits them.
//!
//! All of its state is in the world, the game's own numbers as user data of bodies. So a copy of the world is a copy of
//! the game, and the hash of the world finds whatever differs between two peers.

use umbra_physics::{
    ApplyOptions, Attachment, BodyDef, BodyId, Damping, End, Error, FieldId, FieldKind, ForceField, ForceOrImpulse, Fx,
    Mass, Shape, SpringConstants, TimeStep, Vec2, World, WorldDef, fx, vec2,
};

use crate::random::SplitMix;

/// The bits of [`BodyDef::force_groups`].
const SHIP: u32 = 1;
const ROCK: u32 = 2;
const SHOT: u32 = 4;

const PUSH: Fx = fx!(40); // N
const TURN: Fx = fx!(6); // N·m
const SHOT_SPEED: Fx = fx!(30); // m/s, from the ship
const SHOT_MASS: Fx = fx!(0.125); // kg
const REACH: Fx = fx!(1.25); // m, from the centre of what a shot hits
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

/// A spring with a damper between the centres of two bodies.
fn spring(near: BodyId, far: BodyId, rest: Fx) -> FieldKind {
    let spring = SpringConstants { rest, stiffness: fx!(30), damping: fx!(0.5) };
    FieldKind::Spring { near: Attachment::centre(near), far: End::Body(Attachment::centre(far)), spring }
}

fn engine(ship: BodyId, on: bool) -> FieldKind {
    let force = vec2(if on { PUSH } else { Fx::ZERO }, 0);
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
        let star = FieldKind::Attractor { centre: End::World(Vec2::ZERO), mu: 400.into(), softening: fx!(2) };
        world.add_field(ForceField { kind: star, force_groups: SHIP | SHOT })?;
        let ship = BodyDef {
            shape: Some(Shape::rectangle(fx!(1.5), fx!(1))?),
            mass: Mass::Kilograms(fx!(2)),
            force_groups: SHIP,
            ..BodyDef::dynamic()
        };
        // Opposite each other, in orbit around the star.
        let mut add_ship = |key: u64, side: i32, angle: Fx| -> Result<_, Error> {
            let def =
                BodyDef { position: vec2(-12 * side, 0), velocity: vec2(0, 5 * side), angle, key, ..ship.clone() };
            let (position, velocity) = (def.position, def.velocity);
            let ship = world.add_body(def)?;
            let ball = BodyDef {
                shape: Some(Shape::circle(fx!(0.5))?),
                mass: Mass::Kilograms(fx!(0.5)),
                position: position - vec2(2 * side, 0),
                velocity,
                force_groups: SHIP,
                key: key + 2,
                ..BodyDef::dynamic()
            };
            let ball = world.add_body(ball)?;
            world.add_field(spring(ship, ball, fx!(2)))?;
            Ok((ship, world.add_field(engine(ship, false))?))
        };
        let (left, right) = (add_ship(0, 1, Fx::ZERO)?, add_ship(1, -1, fx!(3.1415926535))?);
        let rock = BodyDef {
            shape: Some(Shape::circle(fx!(1))?),
            mass: Mass::Kilograms(fx!(4)),
            // Soon at rest again, and asleep.
            linear_damping: Some(Damping::kept_per_second(fx!(0.0001))),
            angular_damping: Some(Damping::kept_per_second(fx!(0.0001))),
            force_groups: ROCK,
            ..BodyDef::dynamic()
        };
        for (key, (x, y)) in (10..).zip([(0, 7), (6, 4), (6, -4), (0, -7), (-6, -4), (-6, 4)]) {
            world.add_body(BodyDef { position: vec2(x, y), key, ..rock.clone() })?;
        }
        // Bodies that are joined sleep and wake together.
        let bound = [(20, 1), (21, -1)].map(|(key, x)| BodyDef { position: vec2(x, 18), key, ..rock.clone() });
        let [a, b] = bound.map(|def| world.add_body(def));
        world.add_field(spring(a?, b?, fx!(2)))?;
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
            shape: Some(Shape::circle(fx!(0.125))?),
            mass: Mass::Kilograms(SHOT_MASS),
            position: look.position() + ahead(fx!(1)),
            velocity: look.velocity() + ahead(SHOT_SPEED),
            linear_damping: Some(Damping::NONE),
            force_groups: SHOT,
            key: 100 + player as u64,
            user_data: u64::from(now + SHOT_TICKS),
            ..BodyDef::dynamic()
        };
        world.add_body(shot)?;
        let recoil = ForceOrImpulse::Impulse { impulse: vec2(-(SHOT_SPEED * SHOT_MASS), 0), point: None };
        world.apply(ship, recoil, ApplyOptions::BODY)?;
        world.set_user_data(ship, ship_data(now + RELOAD_TICKS, hits))?;
        Ok(true)
    }

    /// Takes out the shots that hit something before the next tick or have flown for long enough; the number of hits.
    fn strike(&self, world: &mut World) -> Result<usize, Error> {
        let mut hits = 0;
        let shots: Vec<BodyId> = world.bodies().filter(|b| b.force_groups() == SHOT).map(|b| b.id()).collect();
        for shot in shots {
            let look = world.body(shot)?;
            let (at, velocity, owner) = (look.position(), look.velocity(), look.key() - 100);
            if let Some(target) = self.target(world, at, velocity, owner as usize) {
                let impulse = velocity.checked_scale(SHOT_MASS).unwrap_or(Vec2::ZERO);
                world.apply_impulse_at_point(target, impulse, at)?;
                if self.ships.contains(&target) {
                    let (ready, hits) = ready_and_hits(world.body(target)?.user_data());
                    world.set_user_data(target, ship_data(ready, hits + 1))?;
                }
                world.remove_body(shot)?;
                hits += 1;
            } else if world.body(shot)?.user_data() <= world.tick() {
                world.remove_body(shot)?;
            }
        }
        Ok(hits)
    }

    /// The first body, by its handle, that a shot of this player's comes in reach of before the next tick.
    fn target(&self, world: &World, at: Vec2, velocity: Vec2, owner: usize) -> Option<BodyId> {
        let hit = |b: &umbra_physics::BodyRef<'_>| {
            let from = at - b.position();
            (b.force_groups() == ROCK || b.id() == self.ships[1 - owner])
                && passes(from, from + (velocity - b.velocity()) / TICK_RATE)
        };
        world.bodies().find(hit).map(|b| b.id())
    }
}

/// Returns true if a point that moves straight between two places comes in reach of the origin. A distance at the ticks alone
/// would miss a fast shot.
fn passes(from: Vec2, to: Vec2) -> bool {
    let way = to - from;
    let (along, whole) = (-from.dot(way), way.length_squared());
    let nearest = if along <= Fx::ZERO {
        from
    } else if along >= whole {
        to
    } else {
        from + way * (along / whole)
    };
    nearest.length() <= REACH
}
