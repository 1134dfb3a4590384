//! Aim lines: the future path of a ship without stepping the world, and its path after a burn.
//!
//! ```sh
//! cargo run --release --example orbit
//! ```

#[path = "shared/grid.rs"]
mod grid;

use umbra_physics::{BodyDef, BodyId, End, Error, FieldKind, Preview, Vec2, World, WorldDef, fx, vec2};

use grid::Grid;

const TICKS: usize = 360;
/// Characters on the map: two per metre from left to right, one from top to bottom.
const WIDTH: i64 = 76;
const HEIGHT: i64 = 28;

/// The impulse of a burn, N·s, in the direction of flight of the ship, whose mass is 1 kg.
fn burn() -> Vec2 {
    vec2(0, fx!(0.9))
}

fn main() -> Result<(), Error> {
    let (mut world, ship) = sky()?;

    // Each line is computed in a small world of its own: the ship and the star's pull, without the hundred rocks.
    let mut coast = world.preview(ship)?;
    let mut burnt = world.preview(ship)?;
    let ship_there = burnt.id();
    burnt.world_mut().apply_impulse(ship_there, burn())?;
    assert_eq!((world.body_count(), coast.world().body_count()), (101, 1));
    let (coast, burnt) = (line(&mut coast)?, line(&mut burnt)?);
    draw(&world, &coast, &burnt);

    // The player burns; the world follows the line, bit by bit.
    world.apply_impulse(ship, burn())?;
    for at in &burnt {
        world.step();
        assert_eq!(world.body(ship)?.position(), *at);
    }
    println!("{TICKS} ticks on, the ship is at {}: on its line to the bit", world.body(ship)?.position());
    Ok(())
}

/// A ship on its way around a star, among rocks of the same sky.
fn sky() -> Result<(World, BodyId), Error> {
    let mut world = World::new(WorldDef::default())?;
    let centre = End::World(Vec2::ZERO);
    world.add_field(FieldKind::Attractor { centre, mu: 200.into(), softening: fx!(0) })?;
    let ship = BodyDef { position: vec2(8, 0), velocity: vec2(0, 5), key: 1, ..BodyDef::dynamic() };
    let ship = world.add_body(ship)?;
    for i in 0..100 {
        let position = vec2(i % 20 * 4 - 38, i / 20 * 6 - 12);
        world.add_body(BodyDef { position, ..BodyDef::fixed() })?;
    }
    Ok((world, ship))
}

fn line(preview: &mut Preview) -> Result<Vec<Vec2>, Error> {
    let mut line = Vec::with_capacity(TICKS);
    for _ in 0..TICKS {
        preview.step();
        line.push(preview.body()?.position());
    }
    Ok(line)
}

fn draw(world: &World, coast: &[Vec2], burnt: &[Vec2]) {
    let mut map = Grid::new(WIDTH, HEIGHT);
    // Half metres and metres, rounded down: an arithmetic shift of the bits.
    let mut put = |p: Vec2, sign: char| map.put(p.x.to_bits() >> 31, p.y.to_bits() >> 32, sign);
    world.bodies().for_each(|rock| put(rock.position(), '\''));
    burnt.iter().for_each(|&p| put(p, 'o'));
    coast.iter().for_each(|&p| put(p, '.'));
    put(Vec2::ZERO, '*');
    put(coast[0], '>');
    map.rows().for_each(|row| println!("{row}"));
    println!("> the ship, * the star; . as it goes, o after a burn; {TICKS} ticks of each");
}
