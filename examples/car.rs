//! Two cars race over hills under rollback. A car has two wheel joints: springs carry it, and its player's pedal sets the motors of the
//! wheels. The inputs are the commands that do so, so that a tick only carries them out. Each peer gets the commands of the other one late;
//! at the end both have raced the race of a machine that had all of them in time.
//!
//! ```sh
//! cargo run --release --example car
//! ```

use umbra_physics::{
    BodyDef, BodyId, ColliderDef, Command, Error, Filter, Fx, JointDef, JointId, JointKind, JointLimits, JointMotor,
    JointSpring, Material, Shape, Vec2, Wheel, World, WorldDef, fx, vec2,
};

#[path = "shared/late.rs"]
mod late;

const TICKS: u64 = 900; // at 60 a second
const RADIUS: Fx = fx!(0.4); // m

struct Car {
    body: BodyId,
    axles: [JointId; 2],
}

impl Car {
    /// Adds a car with its wheels on the road. Cars do not touch each other.
    fn add(world: &mut World, x: Fx, player: i32) -> Result<Self, Error> {
        let collider = |shape: Shape, density: Fx| ColliderDef {
            density,
            filter: Filter { category: 2, mask: 1, group: 0 },
            material: Material { friction: fx!(0.9), ..Material::default() },
            ..ColliderDef::new(shape)
        };
        let key = 10 * (player as u64 + 1);
        let hull = BodyDef { key, position: vec2(x, fx!(0.9)), ..BodyDef::dynamic() };
        let body = world.add_body(hull.with_collider(collider(Shape::rectangle(fx!(2.6), fx!(0.5))?, fx!(250))))?;
        let mut axle = |way: Fx, key: u64| {
            let hub = vec2(x + way, RADIUS);
            let wheel = BodyDef { key, position: hub, ..BodyDef::dynamic() };
            let wheel = world.add_body(wheel.with_collider(collider(Shape::circle(RADIUS)?, fx!(80))))?;
            let kind = JointKind::Wheel(Wheel {
                limits: Some(JointLimits { lower: fx!(-0.2), upper: fx!(0.2) }),
                spring: Some(JointSpring::new(fx!(4), fx!(0.7))),
                ..Wheel::default()
            });
            // The axis of the suspension points up.
            world.add_joint(JointDef { kind, key, ..JointDef::along(world, body, wheel, hub, vec2(0, 1))? })
        };
        Ok(Self { body, axles: [axle(fx!(-0.85), key + 1)?, axle(fx!(0.85), key + 2)?] })
    }

    /// The commands that set the motors for a pedal: clockwise is forwards, and speed 0 is the brake.
    fn commands(&self, world: &World, pedal: Pedal) -> Result<Vec<Command>, Error> {
        let motor = match pedal {
            Pedal::Gas => Some(JointMotor { speed: fx!(-25), max_force: fx!(400) }),
            Pedal::Brake => Some(JointMotor { speed: fx!(0), max_force: fx!(600) }),
            Pedal::Free => None,
        };
        self.axles.iter().map(|&axle| world.joint_motor_command(axle, motor)).collect()
    }
}

enum Pedal {
    Gas,
    Brake,
    Free,
}

/// The foot of a player: off the pedal for a moment now and then, and on the brake at the end.
fn pedal(player: u32, tick: u64) -> Pedal {
    match (tick + 37 * u64::from(player)) % 120 {
        _ if tick >= 720 => Pedal::Brake,
        0..20 => Pedal::Free,
        20..26 => Pedal::Brake,
        _ => Pedal::Gas,
    }
}

/// The world at the start: a road with three hills, and the two cars.
fn start() -> Result<(World, [Car; 2]), Error> {
    let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
    // A chain holds what is on its right: it runs from right to left.
    let hill = |x: i32| if (20..80).contains(&x) { Fx::ONE - (Fx::TAU * (x - 20) / 20).cos() } else { Fx::ZERO };
    let road: Vec<Vec2> = (-20..=300).rev().map(|x| vec2(x, hill(x))).collect();
    let friction = Material { friction: fx!(0.9), ..Material::default() };
    let road = ColliderDef { material: friction, ..ColliderDef::new(Shape::chain(&road, false)?) };
    world.add_body(BodyDef::fixed().with_collider(road))?;
    let cars = [Car::add(&mut world, fx!(0), 0)?, Car::add(&mut world, fx!(4), 1)?];
    Ok((world, cars))
}

/// The calls of a tick. A refused command is refused on every peer.
fn tick(world: &mut World, inputs: &[(u32, Vec<Command>)]) {
    for command in inputs.iter().flat_map(|(_, commands)| commands) {
        _ = world.execute(command);
    }
}

fn main() -> Result<(), Error> {
    let (start, cars) = start()?;
    let input = |player: u32, tick: u64| {
        let car = &cars[player as usize];
        car.commands(&start, pedal(player, tick)).expect("an axle has a motor")
    };
    let mut world = start.clone();
    println!(" s  first car, m         m/s  second car, m        m/s");
    for now in 0..TICKS {
        if now % 60 == 0 {
            print!("{:>2}", now / 60);
            for car in &cars {
                let body = world.body(car.body)?;
                print!("  {:>6.2}  {:>6.1}", body.position(), body.velocity().length());
            }
            println!();
        }
        tick(&mut world, &[(0, input(0, now)), (1, input(1, now))]);
        world.step();
    }
    for peer in late::play(&start, TICKS, input, tick)? {
        assert_eq!(peer.hashes.last(), Some(&world.state_hash()), "a desync");
        println!("peer {}: {} ticks made again", peer.player, peer.redone);
    }
    let [first, second] = [world.body(cars[0].body)?.position().x, world.body(cars[1].body)?.position().x];
    println!("{:016x} at the end for both, at {first:.1} m and {second:.1} m", world.state_hash());
    Ok(())
}
