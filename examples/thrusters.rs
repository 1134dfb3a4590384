//! A lander with two engines, each pushing along its own axis wherever the hull points. It is thrown off its
//! course, straightens itself, and lands on its pad.
//!
//! ```sh
//! cargo run --release --example thrusters
//! ```

use umbra_physics::{
    ApplyOptions, Attachment, BodyDef, BodyId, BodyRef, ColliderDef, Error, FieldId, FieldKind, ForceOrImpulse, Fx,
    Mass, Shape, Vec2, World, WorldDef, fx, vec2,
};

const MOON: Fx = fx!(-1.62); // m/s²
const MASS: Fx = fx!(100); // kg
const MOST: Fx = fx!(200); // N, of an engine
/// Positions of the engines, m from the centre of mass: right and left, at the foot.
const ARM: Fx = fx!(0.75);
const FOOT: Fx = fx!(0.5);

fn main() -> Result<(), Error> {
    let mut world = World::new(WorldDef { gravity: vec2(0, MOON), ..WorldDef::default() })?;
    let hull = world.add_body(BodyDef {
        mass: Mass::Kilograms(MASS),
        position: vec2(-30, 60),
        velocity: vec2(4, -3),
        ..BodyDef::dynamic().with_collider(ColliderDef::ghost(Shape::rectangle(fx!(1.5), fx!(1))?))
    })?;
    let mut engines = [world.add_field(engine(hull, -ARM, Fx::ZERO))?, world.add_field(engine(hull, ARM, Fx::ZERO))?];
    // The right side gets an impulse of 40 N·s, along the body's own axes and at a point of its own.
    let bolt = ForceOrImpulse::Impulse { impulse: vec2(0, 40), point: Some(vec2(ARM, 0)) };
    world.apply(hull, bolt, ApplyOptions::BODY)?;

    println!("   s    x, m    y, m  v, m/s          tilt  left engine   right engine");
    while world.body(hull)?.position().y > FOOT {
        let look = world.body(hull)?;
        let thrust = pilot(&look);
        if world.tick() % 60 == 0 {
            show(world.tick() / 60, &look, thrust);
        }
        throttle(&mut world, hull, &mut engines, thrust)?;
        world.step();
        assert!(world.tick() < 60 * 60, "it is down within a minute");
    }
    let look = world.body(hull)?;
    let (at, velocity, tilt) = (look.position(), look.velocity(), tilt(&look));
    println!("down after {} ticks at x = {:.3} m, with {velocity:.3} m/s, {tilt:.4} rad askew", world.tick(), at.x);
    assert!(at.x.abs() < fx!(1) && velocity.y > fx!(-1) && velocity.x.abs() < fx!(0.25) && tilt.abs() < fx!(0.05));
    Ok(())
}

/// A force up the hull's own axis, at its foot: the field turns with the body, in every stage of a step.
fn engine(hull: BodyId, arm: Fx, thrust: Fx) -> FieldKind {
    FieldKind::Thrust { at: Attachment { body: hull, point: vec2(arm, -FOOT) }, force: vec2(0, thrust) }
}

fn throttle(world: &mut World, hull: BodyId, engines: &mut [FieldId; 2], thrust: [Fx; 2]) -> Result<(), Error> {
    for ((&mut id, arm), thrust) in engines.iter_mut().zip([-ARM, ARM]).zip(thrust) {
        world.set_field(id, engine(hull, arm, thrust))?;
    }
    Ok(())
}

/// Tilt to the left, rad in (−π, π]: the angle of a body is in [0, 2π).
fn tilt(look: &BodyRef) -> Fx {
    let angle = look.angle();
    if angle > Fx::PI { angle - Fx::TAU } else { angle }
}

/// Forces of the left and the right engine, N.
fn pilot(look: &BodyRef) -> [Fx; 2] {
    let clamp = |value: Fx, max: Fx| value.clamp(-max, max);
    let (Vec2 { x, y }, Vec2 { x: vx, y: vy }) = (look.position(), look.velocity());
    // The descent rate falls with height; the tilt steers over the pad; the turning rate reaches that tilt.
    let wanted = -(fx!(0.5) + fx!(0.1) * y);
    let lift = MASS * (fx!(2) * (wanted - vy) - MOON);
    let lean = clamp(fx!(0.05) * x + fx!(0.2) * vx, fx!(0.4));
    let turn = fx!(3) * (lean - tilt(look)) - fx!(3) * look.angular_velocity();
    let torque = turn * look.inertia().and_then(|inertia| inertia.to_scalar()).unwrap_or(Fx::ONE);
    let (half, difference) = (lift * Fx::HALF, torque / (ARM + ARM));
    [half - difference, half + difference].map(|thrust| thrust.clamp(Fx::ZERO, MOST))
}

fn show(second: u64, look: &BodyRef, thrust: [Fx; 2]) {
    let bars = thrust.map(|thrust| "#".repeat(((thrust / fx!(20)).to_bits() >> 32) as usize));
    let (at, velocity) = (look.position(), look.velocity());
    println!(
        "{second:>4}  {:>6.2}  {:>6.2}  {:>5.2} {:>6.2}  {:>7.3}  {:<10}    {:<10}",
        at.x,
        at.y,
        velocity.x,
        velocity.y,
        tilt(look),
        bars[0],
        bars[1]
    );
}
