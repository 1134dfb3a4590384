//! A rope of springs is let go and swings for ten seconds; its energy is printed to the last digit. Then every step is undone,
//! and the rope is back where it was, to the bit.
//!
//! ```sh
//! cargo run --release --example springs
//! ```

use umbra_physics::{
    Attachment, BodyDef, BodyId, End, Error, FieldKind, Fx, Mass, SpringConstants, TimeStep, World, WorldDef, fx, vec2,
};

const NODES: i32 = 16;
const SECONDS: u64 = 10;
/// Stiff springs ask for short steps: a node between two of these swings at 2·√(k/m) = 141 rad/s, and a step of velocity
/// Verlet has to be shorter than 2 over that.
const RATE: u32 = 480;
const STIFFNESS: Fx = fx!(500); // N/m
const MASS: Fx = fx!(0.1); // kg
const LINK: Fx = fx!(0.5); // m

fn main() -> Result<(), Error> {
    let (mut world, nodes) = rope()?;
    let (start, energy) = (world.state_hash(), world.energy()?);

    println!("{:>2}  {:<70}  end of the rope, m", "s", "energy, J");
    let print = |second: u64, world: &World| -> Result<(), Error> {
        let end = world.body(nodes[nodes.len() - 1])?.position();
        println!("{second:>2}  {:<70}  {end:.3}", world.energy()?.to_string());
        Ok(())
    };
    print(0, &world)?;
    for second in 1..=SECONDS {
        for _ in 0..RATE {
            world.step();
        }
        print(second, &world)?;
        // The energy varies with the stretch and does not drift: by less than a ten thousandth of the 13.3 J between here and
        // the rope hanging straight.
        assert!((world.energy()?.to_bits() - energy.to_bits()).abs() < (13 << 64) / 10_000);
    }

    for _ in 0..SECONDS * u64::from(RATE) {
        world.step_back(&[])?; // Nothing was applied by hand.
    }
    assert_eq!((world.tick(), world.state_hash(), world.energy()?), (0, start, energy));
    println!("and {} steps back: the first state, hash {start:016x}", SECONDS * u64::from(RATE));
    Ok(())
}

/// A rope that hangs from a hook, held out to the right.
fn rope() -> Result<(World, Vec<BodyId>), Error> {
    let mut world = World::new(WorldDef {
        time_step: TimeStep::hz(RATE),
        gravity: vec2(0, fx!(-9.81)),
        // Falling asleep cannot be undone, so sleeping is off.
        sleep_after: None,
        ..WorldDef::default()
    })?;
    let mut nodes = Vec::new();
    let mut last = End::World(vec2(0, 0));
    for i in 1..=NODES {
        let node = world.add_body(BodyDef {
            position: vec2(Fx::from(i) * fx!(0.3), Fx::from(i) * fx!(-0.4)),
            mass: Mass::Kilograms(MASS),
            key: i as u64,
            ..BodyDef::dynamic()
        })?;
        let spring = SpringConstants { rest: LINK, stiffness: STIFFNESS, damping: fx!(0) };
        world.add_field(FieldKind::Spring { near: Attachment::centre(node), far: last, spring })?;
        last = End::Body(Attachment::centre(node));
        nodes.push(node);
    }
    Ok((world, nodes))
}
