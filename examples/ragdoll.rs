//! Two ragdolls are thrown down stairs under rollback: a player's button pushes the ragdoll of that player. Limits keep knees and elbows
//! from turning the wrong way, and friction in the joints lets the ragdolls lie still: both fall asleep. Each peer gets the button of the
//! other one late; at the end both have the state of a machine that had it in time.
//!
//! ```sh
//! cargo run --release --example ragdoll
//! ```

use umbra_physics::{
    Activity, BodyDef, BodyId, BodyKind, ColliderDef, Error, Filter, Fx, JointDef, JointKind, JointLimits, Revolute,
    Shape, Vec2, World, WorldDef, fx, vec2,
};

#[path = "shared/late.rs"]
mod late;

const TICKS: u64 = 480; // at 60 a second
const PUSH: Vec2 = Vec2::new(fx!(1500), fx!(500)); // N

/// An upright capsule and the hinge on which it hangs.
struct Limb {
    /// The height of its middle over the feet, its length between the centres of its ends, and its radius, m.
    size: [Fx; 3],
    /// The limb on the other side of the hinge, by its place in the list.
    parent: usize,
    /// The height of the hinge, m.
    hinge: Fx,
    /// Degrees, counter-clockwise from where it hangs straight.
    limits: [i32; 2],
    /// The largest torque of friction in the hinge, N·m.
    friction: Fx,
}

const TORSO: usize = 0;
const ARM: Limb = Limb {
    size: [fx!(1.37), fx!(0.22), fx!(0.05)],
    parent: TORSO,
    hinge: fx!(1.51),
    limits: [-60, 170],
    friction: fx!(2),
};
const FOREARM: Limb =
    Limb { size: [fx!(1.09), fx!(0.22), fx!(0.045)], parent: 2, hinge: fx!(1.23), limits: [0, 140], friction: fx!(1) };
const THIGH: Limb = Limb {
    size: [fx!(0.84), fx!(0.28), fx!(0.07)],
    parent: TORSO,
    hinge: fx!(1.04),
    limits: [-35, 115],
    friction: fx!(4),
};
const SHIN: Limb =
    Limb { size: [fx!(0.44), fx!(0.3), fx!(0.06)], parent: 4, hinge: fx!(0.64), limits: [-125, 0], friction: fx!(2) };

/// All limbs, each after the one on which it hangs. The first one is the torso, which hangs on nothing.
const LIMBS: [Limb; 10] = [
    Limb { size: [fx!(1.28), fx!(0.34), fx!(0.15)], parent: TORSO, hinge: fx!(0), limits: [0, 0], friction: fx!(0) },
    Limb {
        size: [fx!(1.76), fx!(0.08), fx!(0.12)],
        parent: TORSO,
        hinge: fx!(1.62),
        limits: [-35, 35],
        friction: fx!(2),
    },
    ARM,
    FOREARM,
    THIGH,
    SHIN,
    ARM,
    Limb { parent: 6, ..FOREARM },
    THIGH,
    Limb { parent: 8, ..SHIN },
];

/// Adds a ragdoll of some 60 kg with its feet at a point, and returns its torso.
fn add_ragdoll(world: &mut World, feet: Vec2, player: i32) -> Result<BodyId, Error> {
    let mut bodies: Vec<BodyId> = Vec::new();
    for (Limb { size: [middle, length, radius], parent, hinge, limits: [lower, upper], friction }, key) in
        LIMBS.iter().zip(1..)
    {
        let collider = ColliderDef {
            angle: Fx::FRAC_PI_2,
            density: fx!(125),
            // The limbs of a ragdoll do not touch each other.
            filter: Filter { group: -1 - player, ..Filter::default() },
            ..ColliderDef::new(Shape::capsule(*length, *radius)?)
        };
        let key = 100 * player as u64 + key;
        let limb = BodyDef { position: feet + vec2(0, *middle), key, ..BodyDef::dynamic().with_collider(collider) };
        let limb = world.add_body(limb)?;
        if let Some(&parent) = bodies.get(*parent) {
            let limits = Some(JointLimits::degrees(*lower, *upper));
            let kind = JointKind::Revolute(Revolute { limits, friction: *friction, ..Revolute::default() });
            let joint = JointDef::at(world, parent, limb, feet + vec2(0, *hinge))?;
            world.add_joint(JointDef { kind, key, ..joint })?;
        }
        bodies.push(limb);
    }
    Ok(bodies[TORSO])
}

/// The world at the start: a landing, eight stairs, a floor with a wall, and two ragdolls that stand on the landing.
fn start() -> Result<(World, [BodyId; 2]), Error> {
    let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
    let mut block = |left: Fx, right: Fx, top: Fx| -> Result<(), Error> {
        let shape = Shape::rectangle(right - left, top + fx!(3))?;
        let position = vec2((left + right) / 2, (top - fx!(3)) / 2);
        world.add_body(BodyDef { position, ..BodyDef::fixed().with_collider(shape) }).map(drop)
    };
    block(fx!(-6), fx!(0), fx!(0))?;
    for i in 0..8 {
        block(fx!(0.7) * i, fx!(0.7) * (i + 1), fx!(-0.3) * i)?;
    }
    block(fx!(5.6), fx!(16), fx!(-2.4))?;
    block(fx!(16), fx!(17), fx!(2))?;
    let torsos = [add_ragdoll(&mut world, vec2(fx!(-0.4), 0), 0)?, add_ragdoll(&mut world, vec2(fx!(-1.4), 0), 1)?];
    Ok((world, torsos))
}

/// The button of a player: the first one holds it for a third of a second, and the second one somewhat later.
fn button(player: u32, tick: u64) -> bool {
    let pressed = 20 + 25 * u64::from(player);
    (pressed..pressed + 20).contains(&tick)
}

fn main() -> Result<(), Error> {
    let (start, torsos) = start()?;
    let tick = |world: &mut World, inputs: &[(u32, bool)]| {
        for &(player, _) in inputs.iter().filter(|(_, is_held)| *is_held) {
            world.apply_force(torsos[player as usize], PUSH).expect("the torso is there");
        }
    };
    let mut world = start.clone();
    println!("   s  awake  torsos, m");
    for now in 0..TICKS {
        if now % 60 == 0 {
            let [first, second] = [world.body(torsos[0])?.position(), world.body(torsos[1])?.position()];
            println!("{:>4}  {:>5}  {first:.2}  {second:.2}", now / 60, world.moving_count());
        }
        tick(&mut world, &[(0, button(0, now)), (1, button(1, now))]);
        world.step();
    }
    let limbs = || world.bodies().filter(|body| body.kind() == BodyKind::Dynamic);
    assert!(limbs().all(|limb| limb.activity() == Activity::Asleep), "they lie still");
    assert!(limbs().all(|limb| limb.position().y > fx!(-2.4)), "none is below the floor");
    for peer in late::play(&start, TICKS, button, tick)? {
        assert_eq!(peer.hashes.last(), Some(&world.state_hash()), "a desync");
        println!("peer {}: {} ticks made again", peer.player, peer.redone);
    }
    println!("{} limbs asleep, {:016x} at the end for both", limbs().count(), world.state_hash());
    Ok(())
}
