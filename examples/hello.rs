//! A stone falls from a kilometre at 60 ticks a second. At every second its position equals the formula to the bit.
//!
//! ```sh
//! cargo run --release --example hello
//! ```

use umbra_physics::{BodyDef, Error, Fx, TimeStep, World, WorldDef, fx, vec2};

const HEIGHT: Fx = fx!(1000);
const GRAVITY: Fx = fx!(-9.81);

fn main() -> Result<(), Error> {
    let def = WorldDef { time_step: TimeStep::hz(60), gravity: vec2(0, GRAVITY), ..WorldDef::default() };
    let mut world = World::new(def)?;
    let stone = world.add_body(BodyDef { position: vec2(0, HEIGHT), ..BodyDef::dynamic() })?;

    println!(" s  height, m                               velocity, m/s");
    for second in 1..=14 {
        for _ in 0..60 {
            world.step();
        }
        let look = world.body(stone)?;
        let (height, velocity) = (look.position().y, look.velocity().y);
        println!("{second:>2}  {height:<38}  {velocity}");
        // The formula, with the same g: 9.81 rounded to 32 fraction bits. Its products fit in them.
        let s = Fx::from(second);
        assert_eq!(height, HEIGHT + GRAVITY * Fx::HALF * s * s);
        assert_eq!(velocity, GRAVITY * s);
    }
    println!("{} ticks, state hash {:016x}: the same on every machine", world.tick(), world.state_hash());
    Ok(())
}
