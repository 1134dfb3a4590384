//! Scenes of impacts, each of which has an exact result. Coordinates and sizes are multiples of 2^-20, as in the other scenes.

use umbra_physics::{BodyDef, Error, Filter, Fx, Shape, Turn, Vec2, fx, vec2};

use super::super::scenes::{Numbers, Scene, grid, rectangle, set_material, unit_box, whole};

/// Colliders of a body that meet none of the others that are set apart.
fn set_apart(body: &mut BodyDef) {
    body.colliders.iter_mut().for_each(|collider| collider.filter = Filter { group: -1, ..Filter::default() });
}

fn set_smooth(body: &mut BodyDef, restitution: Fx) {
    set_material(body, |material| (material.friction, material.restitution) = (fx!(0), restitution));
}

fn floating() -> Scene {
    let mut scene = Scene::new(None);
    scene.def.gravity = Vec2::ZERO;
    scene
}

/// A disc that falls past the right side of a block, whose corner is the origin, for each of four gaps and four speeds.
pub(super) fn ghosts(block: BodyDef) -> Result<Scene, Error> {
    let mut scene = floating();
    scene.add(block, vec2(-2, -1), rectangle(fx!(2), fx!(1))?);
    let radius = grid(fx!(0.16));
    for gap in [fx!(0.01), fx!(0.05), fx!(0.5), fx!(1)] {
        for (speed, height) in [(300, fx!(12.6)), (100, fx!(10.6)), (20, fx!(3)), (5, fx!(0.9))] {
            let disc = scene.dynamic(radius + gap, height, Shape::circle(radius)?);
            disc.velocity = vec2(0, -speed);
            set_apart(disc);
        }
    }
    Ok(scene)
}

/// A hundred discs that slide on a floor against a wall, each at another moment of a step, without friction.
pub(super) fn bounces(speed: Fx, restitution: Fx) -> Result<Scene, Error> {
    let mut scene = Scene::new(None);
    set_smooth(scene.floor(fx!(30))?, fx!(0));
    set_smooth(scene.fixed(fx!(5.5), fx!(4.5), rectangle(fx!(0.5), fx!(4.5))?), restitution);
    for phase in 0..100 {
        let start = fx!(3) + whole(phase) * speed / 6_000;
        let disc = scene.dynamic(start, fx!(0.25), Shape::circle(fx!(0.25))?);
        disc.velocity = vec2(speed, 0);
        set_smooth(disc, fx!(0));
        set_apart(disc);
    }
    Ok(scene)
}

/// Forty elastic discs in a room of 12 m, with random velocities of up to 4 m/s along each axis.
pub(super) fn gas(seed: u64) -> Result<Scene, Error> {
    let mut scene = floating();
    scene.def.contacts.restitution_speed = Fx::ZERO;
    for side in [fx!(-6.5), fx!(6.5)] {
        scene.fixed(side, fx!(0), rectangle(fx!(0.5), fx!(7))?);
        scene.fixed(fx!(0), side, rectangle(fx!(7), fx!(0.5))?);
    }
    let mut numbers = Numbers(seed);
    let radius = grid(fx!(0.3));
    for i in 0..40 {
        let place = vec2(whole(i % 10) * fx!(1.1) - fx!(5), whole(i / 10) * 3 - fx!(4.5));
        let disc = scene.dynamic(place.x, place.y, Shape::circle(radius)?);
        disc.velocity = Vec2::new(numbers.next() * 8 - fx!(4), numbers.next() * 8 - fx!(4));
    }
    scene.bodies.iter_mut().for_each(|body| set_smooth(body, fx!(1)));
    Ok(scene)
}

/// An elastic disc that runs into six at rest with gaps between them.
pub(super) fn row(gap: Fx, speed: i32) -> Result<Scene, Error> {
    let mut scene = floating();
    scene.dynamic(fx!(-2), fx!(0), Shape::circle(fx!(0.5))?).velocity = vec2(speed, 0);
    for i in 0..6 {
        scene.dynamic(fx!(1.01) + whole(i) * (fx!(1) + gap), fx!(0), Shape::circle(fx!(0.5))?);
    }
    scene.bodies.iter_mut().for_each(|body| set_smooth(body, fx!(1)));
    Ok(scene)
}

/// A crate on a fixed one, 0.3 m aside, and another one that falls on it from a height, 0.25 m farther aside.
pub(super) fn overhang(drop: Fx) -> Result<Scene, Error> {
    let mut scene = Scene::new(None);
    scene.fixed(fx!(0), fx!(0.5), unit_box()?);
    scene.dynamic(fx!(0.3), fx!(1.5), unit_box()?);
    scene.dynamic(fx!(0.55), fx!(2.5) + drop, unit_box()?);
    Ok(scene)
}

/// The same on a stack: two crates, the one 0.3 m aside, and the one that falls.
pub(super) fn stack(drop: Fx) -> Result<Scene, Error> {
    let mut scene = Scene::new(None);
    scene.floor(fx!(40))?;
    for (x, y) in [(fx!(0), fx!(0.5)), (fx!(0), fx!(1.5)), (fx!(0.3), fx!(2.5)), (fx!(0.55), fx!(3.5) + drop)] {
        scene.dynamic(x, y, unit_box()?);
    }
    Ok(scene)
}

/// A ball of 0.25 m let go at 0.62 rad in half a circle of 3 m, a chain of so many segments.
pub(super) fn half_pipe(segments: u32, friction: Fx) -> Result<Scene, Error> {
    let mut scene = Scene::new(None);
    let corner = |i: u32| {
        let (sin, cos) = Turn::from_bits(((u128::from(i) << 64) / u128::from(2 * segments)) as u64).sin_cos();
        vec2(grid(cos * 3), grid(fx!(3) - sin * 3))
    };
    let pipe = Shape::chain(&(0..=segments).map(corner).collect::<Vec<_>>(), false)?;
    scene.fixed(fx!(0), fx!(0), pipe);
    // 6 mm from the circle on which its centre may be.
    scene.dynamic(fx!(1.59436), fx!(0.766718), Shape::circle(fx!(0.25))?);
    scene.bodies.iter_mut().for_each(|body| set_material(body, |material| material.friction = friction));
    Ok(scene)
}

/// A disc of 1.01 m that flies across a corridor of 1 m.
pub(super) fn corridor(speed: i32, restitution: Fx) -> Result<Scene, Error> {
    let mut scene = floating();
    for y in [fx!(-1), fx!(2)] {
        set_smooth(scene.fixed(fx!(0), y, rectangle(fx!(10), fx!(1))?), fx!(0));
    }
    let disc = scene.dynamic(fx!(0), fx!(0.5), Shape::circle(grid(fx!(0.505)))?);
    disc.velocity = vec2(0, speed);
    set_smooth(disc, restitution);
    Ok(scene)
}
