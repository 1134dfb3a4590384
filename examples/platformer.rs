//! A platformer for two under rollback: floor tiles, a slope, stairs, a one-way platform, a lift, and crates to push. Two peers each play
//! a player, get the inputs of the other one late, predict them, and go back where they were wrong. At the end both have played
//! the match of a machine that had all inputs in time.
//!
//! ```sh
//! cargo run --release --example platformer
//! ```
//!
//! A player is a kinematic body that goes where a [`Character`] gets. All else that the game keeps of a player is in the blob of the world:
//! so a copy of the world is a copy of the game.

use umbra_physics::{
    BodyDef, BodyId, Character, ColliderDef, Error, Filter, Fx, Ground, Mass, OneWay, QueryFilter, Random, Shape,
    TimeStep, Vec2, World, WorldDef, fx, vec2,
};

#[path = "shared/late.rs"]
mod late;

use late::Peer;

const TICKS: u64 = 1_200; // at 60 a second

const SPEED: Fx = fx!(5); // m/s
const JUMP: Fx = fx!(9); // m/s
const GRAVITY: Fx = fx!(20); // m/s²
const TICK: Fx = fx!(0.016666667); // s

/// Buttons that a player holds in a tick.
#[derive(Clone, Copy, Default, PartialEq)]
struct Buttons(u8);

const LEFT: u8 = 1;
const RIGHT: u8 = 2;
const UP: u8 = 4;
const DOWN: u8 = 8;

/// Players push bodies by impulses alone, without contacts, and are obstacles for each other.
const PLAYERS: Filter = Filter { category: 2, mask: 2, group: 0 };

/// State of a player that its body does not have.
#[derive(Clone, Copy, Default)]
struct Player {
    /// The speed upwards, m/s.
    rise: Fx,
    ground: Option<Ground>,
}

impl Player {
    /// Numbers in the blob.
    const NUMBERS: usize = 7;

    fn numbers(&self) -> [i64; Self::NUMBERS] {
        let mut numbers = [self.rise.to_bits(), 0, 0, 0, 0, 0, 0];
        if let Some(Ground { body, local, point }) = self.ground {
            let (slot, generation) = body.parts();
            let vectors = [local.x, local.y, point.x, point.y].map(Fx::to_bits);
            numbers[1] = i64::from(slot) + 1;
            numbers[2] = i64::from(generation);
            numbers[3..].copy_from_slice(&vectors);
        }
        numbers
    }

    /// The player with these numbers.
    fn from_numbers(numbers: &[i64]) -> Self {
        let vector = |i: usize| Vec2::new(Fx::from_bits(numbers[i]), Fx::from_bits(numbers[i + 1]));
        let ground = (numbers[1] > 0).then(|| {
            let body = BodyId::from_parts((numbers[1] - 1) as u32, numbers[2] as u32);
            Ground { body, local: vector(3), point: vector(5) }
        });
        Self { rise: Fx::from_bits(numbers[0]), ground }
    }
}

/// The handles of the level, the same on every peer, and the character of the players.
struct Game {
    players: [BodyId; 2],
    lift: BodyId,
    platform: BodyId,
    hero: Character,
}

impl Game {
    fn start() -> Result<(Self, World), Error> {
        let def = WorldDef { time_step: TimeStep::hz(60), gravity: vec2(0, -GRAVITY), ..WorldDef::default() };
        let mut world = World::new(def)?;
        let mut key = 10;
        let mut add = |def: BodyDef, at: Vec2, collider: ColliderDef| {
            key += 1;
            let collider = ColliderDef { key, ..collider };
            world.add_body(BodyDef { position: at, key, ..def.with_collider(collider) })
        };
        let bar = |width: Fx, height: Fx| Shape::rectangle(width, height).map(ColliderDef::new);
        // Tiles, walls at the ends, stairs on the right, and a slope on the left.
        for x in -15..15 {
            add(BodyDef::fixed(), vec2(fx!(0.5) + Fx::from(x), fx!(-0.5)), bar(fx!(1), fx!(1))?)?;
        }
        for x in [fx!(-15.5), fx!(15.5)] {
            add(BodyDef::fixed(), vec2(x, 5), bar(fx!(1), fx!(12))?)?;
        }
        for i in 0..6 {
            let top = fx!(0.25) * (i + 1);
            add(BodyDef::fixed(), vec2(i + 8, top / 2), bar(fx!(1), top)?)?;
        }
        let slope = Shape::polygon(&[vec2(-14, 0), vec2(-8, 0), vec2(-14, 3)])?;
        add(BodyDef::fixed(), vec2(-12, 1), ColliderDef::new(slope))?;
        let one_way = Some(OneWay::default());
        let platform = ColliderDef { one_way, ..bar(fx!(4), fx!(0.25))? };
        let platform = add(BodyDef::fixed(), vec2(-3, fx!(1.5)), platform)?;
        let lift = BodyDef { velocity: vec2(1, 1), ..BodyDef::kinematic() };
        let lift = add(lift, vec2(1, 1), bar(fx!(2), fx!(0.25))?)?;
        let crate_ = BodyDef { mass: Mass::Kilograms(fx!(30)), ..BodyDef::dynamic() };
        for x in [-6, 4, 6] {
            add(crate_.clone(), vec2(x, fx!(0.5)), bar(fx!(0.8), fx!(0.8))?)?;
        }
        let shape = Shape::rectangle(fx!(0.6), fx!(1.2))?;
        let collider = ColliderDef { filter: PLAYERS, ..ColliderDef::new(shape.clone()) };
        let mut player = |x: i32| add(BodyDef::kinematic(), vec2(x, 2), collider.clone());
        let players = [player(-5)?, player(5)?];
        let hero = Character { push_mass: fx!(70), ..Character::new(shape) };
        world.set_blob(&[0; 2 * 8 * Player::NUMBERS])?;
        Ok((Self { players, lift, platform, hero }, world))
    }

    /// The rules of a tick: a function of the world and the inputs.
    fn tick(&self, world: &mut World, inputs: &[(u32, Buttons)]) -> Result<(), Error> {
        // The lift goes around a square.
        let at = world.body(self.lift)?.position();
        let way = world.body(self.lift)?.velocity();
        let turned = |way: Fx, at: Fx, low: i32, high: i32| {
            if at < Fx::from(low) {
                way.abs()
            } else if at > Fx::from(high) {
                -way.abs()
            } else {
                way
            }
        };
        world.set_velocity(self.lift, vec2(turned(way.x, at.x, 0, 4), turned(way.y, at.y, 1, 3)))?;
        let numbers: Vec<i64> =
            world.blob().chunks_exact(8).filter_map(|bytes| Some(i64::from_le_bytes(bytes.try_into().ok()?))).collect();
        let mut blob = Vec::new();
        for (&(player, Buttons(held)), numbers) in inputs.iter().zip(numbers.chunks_exact(Player::NUMBERS)) {
            let next = self.play(world, self.players[player as usize], held, Player::from_numbers(numbers))?;
            blob.extend(next.numbers().into_iter().flat_map(i64::to_le_bytes));
        }
        world.set_blob(&blob)
    }

    fn play(&self, world: &mut World, id: BodyId, held: u8, mut player: Player) -> Result<Player, Error> {
        let holds = |button: u8| if held & button != 0 { Fx::ONE } else { Fx::ZERO };
        let mut run = (holds(RIGHT) - holds(LEFT)) * SPEED;
        if let Some(ground) = player.ground {
            player.rise = Fx::ZERO;
            if held & UP != 0 {
                // A player who jumps off a lift keeps its velocity. A ground that is gone has none.
                let here = world.body(id)?.position();
                let velocity = world.body(ground.body).ok().and_then(|body| body.velocity_at(here)).unwrap_or_default();
                player.rise = JUMP + velocity.y.max(Fx::ZERO);
                run += velocity.x;
                player.ground = None;
            }
        }
        player.rise -= GRAVITY * TICK;
        // Down from a platform: it is left out in this tick, and then lets through the player who is in it.
        let without = [id, self.platform];
        let without = if held & DOWN != 0 { &without[..] } else { &without[..1] };
        let filter = QueryFilter {
            filter: Some(Filter { mask: !0, ..PLAYERS }),
            without_bodies: without,
            ..QueryFilter::default()
        };
        let (position, way) = (world.body(id)?.position(), vec2(run, player.rise) * TICK);
        let moved = self.hero.translate(&world.queries_after_step(), position, player.ground, way, &filter)?;
        for push in self.hero.push(world, &moved) {
            world.execute(&push)?;
        }
        if moved.hits.iter().any(|hit| hit.normal.y < fx!(-0.5)) {
            player.rise = player.rise.min(Fx::ZERO); // a ceiling
        }
        world.move_to(id, moved.position, Fx::ZERO)?;
        Ok(Player { ground: moved.ground, ..player })
    }
}

/// A bot: random buttons, held for a while.
fn bot(player: u64, tick: u64) -> Buttons {
    let mut random = Random::seeded(tick / 15 * 2 + player);
    let (run, jump) = (random.below(4) as u8, random.below(4));
    Buttons(run | if jump == 0 { UP } else { 0 } | if jump == 1 { DOWN } else { 0 })
}

fn main() -> Result<(), Error> {
    let (game, start) = Game::start()?;
    // A machine that has all inputs in time.
    let mut world = start.clone();
    let mut hashes = Vec::new();
    let (mut steps, mut air) = (0, 0);
    println!("   s    left player      right player");
    for tick in 0..TICKS {
        if tick % 120 == 0 {
            let [a, b] = game.players.map(|id| world.body(id).map(|body| body.position()));
            println!("{:>4}  ({:>5.1}, {:>4.1})    ({:>5.1}, {:>4.1})", tick / 60, a?.x, a?.y, b?.x, b?.y);
        }
        game.tick(&mut world, &[(0, bot(0, tick)), (1, bot(1, tick))])?;
        world.step();
        hashes.push(world.state_hash());
        let on_ground = world.blob().chunks_exact(8 * Player::NUMBERS).filter(|player| player[8] != 0).count();
        (steps, air) = (steps + on_ground, air + 2 - on_ground);
    }
    println!("{steps} ticks of a player on the ground, {air} in the air");

    let calls = |world: &mut World, inputs: &[(u32, Buttons)]| game.tick(world, inputs).expect("valid calls");
    let input = |player: u32, tick: u64| bot(u64::from(player), tick);
    for Peer { player, hashes: own_hashes, redone, .. } in late::play(&start, TICKS, input, calls)? {
        assert_eq!(own_hashes, hashes, "a desync");
        println!("peer {player}: {redone} ticks made again, all {TICKS} hashes are the same");
    }
    println!("{:016x} at the end", hashes[hashes.len() - 1]);
    Ok(())
}
