//! Three bodies in chaos: when the number types part ways.

use umbra_physics::{Fx, Integrator, Vec2, World, fx, vec2};

use crate::seeds::times;
use crate::stability::momentum::Exact;
use crate::stability::scene::{Ball, Gravity, Scene, bits, look};

const RATE: u32 = 60;

/// The Pythagorean three bodies (Burrau 1913), softened so that none is thrown out.
fn three() -> Scene {
    let ball = |mass, x: i32, y: i32| Ball { mass, position: vec2(x, y), velocity: Vec2::ZERO };
    let bodies = vec![ball(fx!(3), 100, 300), ball(fx!(4), -200, -100), ball(fx!(5), 100, -100)];
    Scene { bodies, springs: vec![], gravity: Some(Gravity { constant: fx!(1000000), softening: fx!(150) }) }
}

fn world<S: Exact>(scene: &Scene) -> World<S> {
    scene.world(RATE, Integrator::VelocityVerlet)
}

/// The step after which a body of one world is 10 m from its twin in the other.
fn parting<A: Exact, B: Exact>(mut a: World<A>, mut b: World<B>) -> u32 {
    let apart = |a: &World<A>, b: &World<B>| {
        let mut twins = look(a).into_iter().zip(look(b));
        twins.any(|(a, b)| (a.x[0] - b.x[0]).hypot(a.x[1] - b.x[1]) > 10.0)
    };
    let parted = (1..100_000).find(|_| {
        assert!(a.step().faults.is_empty() && b.step().faults.is_empty());
        apart(&a, &b)
    });
    parted.expect("chaos")
}

#[test]
fn singles_part_from_doubles_long_before_fixed_point_does() {
    let scene = three();
    let mut nudged = scene.clone();
    nudged.bodies[0].position.x += Fx::DELTA;
    let (singles, fixed) =
        (parting(world::<f32>(&scene), world::<f64>(&scene)), parting(world::<Fx>(&scene), world::<f64>(&scene)));
    let (singles_from_fixed, by_an_ulp) =
        (parting(world::<f32>(&scene), world::<Fx>(&scene)), parting(world::<Fx>(&nudged), world::<Fx>(&scene)));
    println!("f32 parts at step {singles}, fx at {fixed}, fx from itself nudged by an ulp at {by_an_ulp}");
    // Differences grow as a power of 2 with time. Those of singles begin at some 2^-16 m and have 19 doublings to go to
    // 10 m, those of public positions at 2^-33 m, and have 36.
    assert!(2 * fixed > 3 * singles, "f32 parts at {singles}, fx at {fixed}");
    // Until long after singles have left, fixed point and doubles are as one.
    assert_eq!(singles_from_fixed, singles);
    // What parts fixed point from doubles is no more than the rounding of public values: an ulp at the start does as
    // much.
    assert!(2 * by_an_ulp > fixed && by_an_ulp < 2 * fixed, "an ulp parts at {by_an_ulp}, fx at {fixed}");
}

#[test]
fn chaos_repeats_itself_to_the_bit() {
    let (mut once, mut again) = (world::<Fx>(&three()), world::<Fx>(&three()));
    for _ in 0..times(2_000) {
        once.step();
        again.step();
        assert_eq!(once.state_hash(), again.state_hash());
    }
    assert_eq!(bits(&once), bits(&again));
}
