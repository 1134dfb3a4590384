//! Equal and opposite impulses: the momentum of an isolated pile.

use super::scenes::{def, material, world};
use crate::seeds::run_seed;
use umbra_physics::{BodyDef, BodyId, ColliderDef, Fx, Mass, Random, Shape, Vec2, World, WorldDef, fx, vec2};

/// A hollow square that spins, 16 m wide, with boxes and discs in it: all are free, and what is thrown outwards stays in touch. The walls
/// are 2 m thick. Masses are 1 and 3 kg in turn.
fn drum() -> (World, Vec<(BodyId, i128)>) {
    let mut random = Random::seeded(run_seed(63));
    let mut upto = |max: i32| Fx::from_ratio(random.below(2_000) as i64 - 1_000, 1_000) * max;
    let wall = |x: i32, y: i32, width: i32, height: i32| ColliderDef {
        position: vec2(x, y),
        material: material(fx!(0.5), fx!(0.5)),
        ..ColliderDef::new(Shape::rectangle(width, height).expect("a wall"))
    };
    let walls = vec![wall(-7, 0, 2, 16), wall(7, 0, 2, 16), wall(0, -7, 16, 2), wall(0, 7, 16, 2)];
    let frame = BodyDef { mass: Mass::Kilograms(fx!(3)), angular_velocity: fx!(2), ..BodyDef::dynamic() };
    let mut bodies = vec![BodyDef { colliders: walls, ..frame }];
    for i in 0..36 {
        let shape = match i % 2 {
            0 => Shape::rectangle(fx!(1), fx!(1)).expect("a box"),
            _ => Shape::circle(fx!(0.5)).expect("a disc"),
        };
        let material = material(fx!(0.5), if i % 4 < 2 { fx!(0.5) } else { fx!(0) });
        let (row, column) = (i / 6, i % 6);
        bodies.push(BodyDef {
            position: Vec2::new(Fx::from_ratio((3 * column).into(), 2), Fx::from_ratio((3 * row).into(), 2))
                - vec2(fx!(3.75), fx!(3.75)),
            angle: upto(3),
            velocity: Vec2::new(upto(5), upto(5)),
            mass: Mass::Kilograms(if i % 3 == 0 { fx!(3) } else { fx!(1) }),
            ..BodyDef::dynamic().with_collider(ColliderDef { material, ..ColliderDef::new(shape) })
        });
    }
    let masses: Vec<i128> = bodies.iter().map(|def| if def.mass == Mass::Kilograms(fx!(3)) { 3 } else { 1 }).collect();
    let (world, ids) = world(WorldDef { gravity: vec2(0, 0), ..def() }, bodies).expect("a scene");
    (world, ids.into_iter().zip(masses).collect())
}

/// The momentum of each body in 2^-96 N·s, exactly.
fn momenta(world: &World, bodies: &[(BodyId, i128)]) -> Vec<[i128; 2]> {
    let momentum_of = |&(id, mass): &(BodyId, i128)| {
        let velocity = world.body(id).expect("it").velocity_exact();
        [velocity.x, velocity.y].map(|v| mass * v.to_bits())
    };
    bodies.iter().map(momentum_of).collect()
}

fn total(momenta: &[[i128; 2]]) -> [i128; 2] {
    momenta.iter().fold([0; 2], |[x, y], momentum| [x + momentum[0], y + momentum[1]])
}

/// Steps the drum. After each tick its momentum has changed by at most 2^-63 of the sum of all impulses, plus 2^-96 m/s times mass for each
/// body and tick.
fn is_kept(ticks: i128) {
    let (mut world, bodies) = drum();
    let mass: i128 = bodies.iter().map(|(_, mass)| mass).sum();
    let mut before = momenta(&world, &bodies);
    let (start, spin) = (total(&before), world.angular_momentum());
    // The impulses that bodies took, in 2^-96 N·s: at most twice the sum of the impulses of contacts, each of which two bodies take.
    let (mut taken, mut pressed, mut largest) = (0i128, 0, 0);
    for tick in 1..=ticks {
        world.step();
        let after = momenta(&world, &bodies);
        let change = |(a, b): (&[i128; 2], &[i128; 2])| (a[0] - b[0]).abs().max((a[1] - b[1]).abs());
        let impulses: i128 = after.iter().zip(&before).map(change).sum();
        taken += impulses;
        pressed += i128::from(impulses > 0);
        for (now, start) in total(&after).into_iter().zip(start) {
            let (off, bound) = ((now - start).abs(), (taken >> 64) + mass * tick);
            assert!(off <= bound, "{off} of {bound} after {tick} ticks");
            largest = largest.max(off);
        }
        before = after;
    }
    assert!(pressed > ticks * 9 / 10, "{pressed} of {ticks} ticks with impulses");
    println!(
        "{ticks} ticks, impulses {:.0} N·s, momentum off by at most {:.1e} N·s, angular momentum {:.6} to {:.6} N·m·s",
        taken as f64 / 2f64.powi(97),
        largest as f64 / 2f64.powi(96),
        spin.expect("it fits"),
        world.angular_momentum().expect("it fits")
    );
}

#[test]
fn an_isolated_pile_keeps_its_momentum() {
    is_kept(crate::seeds::times(10_000));
}
