//! The match: two ships that fly and fire, all of it in the world.

use umbra_physics::{
    ApplyOptions, BodyDef, BodyId, ColliderDef, Damping, Error, ForceOrImpulse, Fx, Mass, Shape, Vec2, World, WorldDef,
    fx, vec2,
};

pub(crate) const SHOT_TICKS: u64 = 40;
const RELOAD_TICKS: u64 = 12;
/// Keys from here on belong to shots, two for each tick.
const SHOTS: u64 = 10;

/// Buttons that a player holds over a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Held {
    engine: bool,
    turn: bool,
    fire: bool,
}

/// Buttons of a player at a tick: other ones every eight ticks, the trigger for some of these.
pub(crate) fn pressed(player: usize, tick: u64) -> Held {
    let hand = (tick / 8 * 5 + player as u64 * 3) % 7;
    Held { engine: hand % 2 == 1, turn: hand % 3 == 1, fire: hand > 3 && tick % 8 < 3 }
}

/// The tick that a shot was fired in, by its key; `None` for a ship's.
pub(crate) fn fired_at(key: u64) -> Option<u64> {
    Some(key.checked_sub(SHOTS)? / 2)
}

/// Handles that are fixed for a whole match.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Match {
    ships: [BodyId; 2],
}

impl Match {
    /// # Errors
    /// None, unless the definitions are edited to invalid ones.
    pub(crate) fn start() -> Result<(Self, World), Error> {
        let mut world = World::new(WorldDef {
            linear_damping: Damping::kept_per_second(fx!(0.5)),
            angular_damping: Damping::kept_per_second(fx!(0.2)),
            ..WorldDef::default()
        })?;
        let mut ship = |key: u64, x: i32, angle: Fx| {
            let hull = ColliderDef::ghost(Shape::rectangle(fx!(2), fx!(1))?);
            let def = BodyDef {
                mass: Mass::Kilograms(fx!(2)),
                position: vec2(x, 0),
                angle,
                key,
                ..BodyDef::dynamic().with_collider(hull)
            };
            world.add_body(def)
        };
        let ships = [ship(0, -10, Fx::ZERO)?, ship(1, 10, Fx::PI)?];
        Ok((Self { ships }, world))
    }

    /// A tick of the match: it depends only on the world and the buttons.
    pub(crate) fn tick(&self, world: &mut World, held: [Held; 2]) {
        for (player, held) in held.into_iter().enumerate() {
            // Every peer refuses the same commands.
            _ = self.steer(world, player, held);
        }
        let now = world.tick();
        let over: Vec<BodyId> =
            world.bodies().filter(|b| b.key() >= SHOTS && b.user_data() <= now).map(|b| b.id()).collect();
        over.into_iter().for_each(|shot| _ = world.remove_body(shot));
        world.step();
    }

    fn steer(&self, world: &mut World, player: usize, held: Held) -> Result<(), Error> {
        let ship = self.ships[player];
        if held.engine {
            world.apply(ship, ForceOrImpulse::Force { force: vec2(20, 0), point: None }, ApplyOptions::BODY)?;
        }
        if held.turn {
            world.apply_torque(ship, fx!(3))?;
        }
        let look = world.body(ship)?;
        // A ship's user data: the tick from which it can fire again.
        if held.fire && world.tick() >= look.user_data() {
            let ahead = look.rotation().checked_rotate(vec2(20, 0)).unwrap_or(Vec2::ZERO);
            world.add_body(BodyDef {
                mass: Mass::Kilograms(fx!(0.125)),
                position: look.position(),
                velocity: look.velocity() + ahead,
                // The same shot has the same key, however often its tick is recomputed.
                key: SHOTS + 2 * world.tick() + player as u64,
                user_data: world.tick() + SHOT_TICKS,
                ..BodyDef::dynamic().with_collider(ColliderDef::ghost(Shape::circle(fx!(0.25))?))
            })?;
            world.set_user_data(ship, world.tick() + RELOAD_TICKS)?;
        }
        Ok(())
    }
}
