//! A pile of bodies that touch, from few bytes each.

use arbitrary::Result;
use umbra_physics::{
    BodyDef, BodyKind, ColliderDef, Command, CommandSource as _, Error, Filter, Fx, Locks, Mass, Material, MixRule,
    Part, Shape, TimeStep, Vec2, World, fx, vec2,
};

use super::author::Author;

/// Bodies in a row of the pile.
const ROW: i32 = 5;
/// The least and the most bodies, without the floor.
const BODIES: [u8; 2] = [8, 20];

/// Units of length, speed and mass of the whole pile, most often everyday ones.
const UNITS: [Fx; 8] = [fx!(1), fx!(1), fx!(1), fx!(1), fx!(1), fx!(0.0625), fx!(16), fx!(512)];
const SPEEDS: [Fx; 8] = [fx!(0), fx!(0.125), fx!(1), fx!(1), fx!(1), fx!(8), fx!(256), fx!(65536)];
const MASSES: [[Fx; 4]; 4] = [
    [fx!(1); 4],
    [fx!(1), fx!(3), fx!(1), fx!(3)],
    [fx!(1), fx!(1000), fx!(0.125), fx!(20)],
    [fx!(0.0001), fx!(1), fx!(16_777_216), fx!(1000)],
];

/// Adds a pile to a world: a floor or none, and bodies in rows that touch, overlap or are near each other. What the input lacks is
/// zero: discs in a square.
pub fn pile(author: &mut Author<'_>, world: &mut World) -> Result<()> {
    let [floor, count, units, place]: [u8; 4] = author.any()?;
    let unit = UNITS[usize::from(units % 8)];
    let speed = SPEEDS[usize::from(units / 8 % 8)];
    let masses = MASSES[usize::from(units / 64)];
    let corner = if place % 4 == 0 { author.generator().position() } else { Vec2::ZERO };
    let gap = [fx!(0.9375), fx!(0.9375), fx!(1.0625), fx!(0.75)][usize::from(place / 4 % 4)];
    // A pile under everyday gravity and at an everyday rate stays one; a quarter of them has what the world came with.
    if place / 16 % 4 != 3 {
        let gravity = vec2(0, [0, -10, -10, -30][usize::from(place >> 6)]) * unit;
        for command in [Command::SetGravity(gravity), Command::SetTimeStep(TimeStep::hz(60))] {
            _ = world.execute(&command);
        }
    }
    for def in floors(floor, unit).unwrap_or_default() {
        add(author, world, BodyDef { position: corner.checked_add(def.position).unwrap_or(corner), ..def });
    }
    for i in 0..i32::from(BODIES[0] + count % (BODIES[1] - BODIES[0] + 1)) {
        let [kind, near, motion, look]: [u8; 4] = author.any()?;
        let sixteenths = |nibble: u8| Fx::from_ratio(nibble.into(), 16);
        let cell = vec2(i % ROW, 1 + i / ROW) * gap + Vec2::new(sixteenths(near & 3), sixteenths(near >> 2 & 3));
        let turn = [fx!(0), fx!(0), Fx::PI / 2, fx!(0.125)][usize::from(near >> 4 & 3)];
        let eighth = |bits: u8| Fx::from_ratio(i64::from(bits & 7) - 4, 4);
        let colliders = if kind == 255 { vec![author.generator().collider_def()] } else { colliders(kind, look, unit) };
        let is_still = motion >> 6 == 0;
        let def = BodyDef {
            kind: if look >> 4 == 15 { BodyKind::Kinematic } else { BodyKind::Dynamic },
            position: corner.checked_add(cell * unit).unwrap_or(cell),
            angle: turn,
            velocity: if is_still { Vec2::ZERO } else { Vec2::new(eighth(motion), eighth(motion >> 3)) * speed },
            angular_velocity: if is_still { fx!(0) } else { eighth(motion >> 3) * 4 },
            mass: if units / 64 == 0 { Mass::FromColliders } else { Mass::Kilograms(masses[usize::from(look & 3)]) },
            locks: Locks { x: false, y: false, rotation: near >> 6 == 3 },
            key: u64::from(look >> 6) + i as u64,
            colliders,
            ..BodyDef::dynamic()
        };
        add(author, world, def);
    }
    Ok(())
}

fn add(author: &mut Author<'_>, world: &mut World, def: BodyDef) {
    // What is out of range is left out.
    world.execute(&Command::AddBody(def)).into_iter().for_each(|made| author.made(world, made));
}

/// The bodies under a pile: none, a box, a box with walls, a chain, or a plate that moves up.
fn floors(kind: u8, unit: Fx) -> Result<Vec<BodyDef>, Error> {
    let slab = |x: Fx, y: Fx, width: Fx, height: Fx| {
        let shape = Shape::rectangle(width * unit, height * unit)?;
        Ok(BodyDef { position: Vec2::new(x, y) * unit, ..BodyDef::fixed().with_collider(shape) })
    };
    Ok(match kind % 5 {
        0 => Vec::new(),
        1 => vec![slab(fx!(2.5), fx!(-0.5), fx!(16), fx!(2))?],
        2 => vec![
            slab(fx!(2.5), fx!(-0.5), fx!(16), fx!(2))?,
            slab(fx!(-1.5), fx!(3), fx!(2), fx!(9))?,
            slab(fx!(6.5), fx!(3), fx!(2), fx!(9))?,
        ],
        3 => {
            // A chain of short segments with hills, between walls.
            let hill =
                |i: i32| vec2(fx!(8) - Fx::from_ratio(i.into(), 4), Fx::from_ratio(i64::from(i * i % 5), 16)) * unit;
            let points: Vec<Vec2> = (0..50).map(hill).collect();
            vec![BodyDef::fixed().with_collider(Shape::chain(&points, false)?)]
        }
        _ => {
            let plate = slab(fx!(2.5), fx!(0.25), fx!(16), fx!(0.25))?;
            vec![BodyDef { velocity: vec2(0, 1) * unit, ..BodyDef { kind: BodyKind::Kinematic, ..plate } }]
        }
    })
}

/// One to three colliders of a body, or a compound of as many parts.
fn colliders(kind: u8, look: u8, unit: Fx) -> Vec<ColliderDef> {
    let size = unit * [fx!(1), fx!(0.5), fx!(2), fx!(1)][usize::from(kind >> 6)];
    let half = size / 2;
    let shape = match kind % 8 {
        0 | 1 => Shape::circle(half),
        2 => Shape::rectangle(size, size),
        3 => Shape::rectangle(size, half / 4),
        4 => Shape::capsule(half, half / 2),
        5 => Shape::segment(Vec2::new(-half, Fx::ZERO), Vec2::new(half, Fx::ZERO)),
        6 => Shape::polygon(&[(-half, -half), (half, -half), (Fx::ZERO, half)].map(|(x, y)| Vec2::new(x, y))),
        _ => {
            let corners = [(2, 0), (1, 2), (-1, 2), (-2, 0), (-1, -2), (1, -2)];
            Shape::polygon(&corners.map(|(x, y)| vec2(x, y) * (half / 2)))
        }
    };
    let Ok(shape) = shape.or_else(|_| Shape::circle(fx!(0.5))) else { return Vec::new() };
    let parts = [fx!(0), fx!(0.5), fx!(1), fx!(4)];
    let material = Material {
        friction: parts[usize::from(look & 3)],
        restitution: parts[usize::from(look >> 2 & 3)].min(Fx::ONE),
        rolling_resistance: if look >> 4 == 11 { fx!(0.125) } else { Fx::ZERO },
        surface_speed: if look >> 4 == 12 { fx!(1) } else { Fx::ZERO },
        friction_rule: MixRule::ALL[usize::from(kind) % 6],
        restitution_rule: MixRule::ALL[usize::from(look) % 6],
        id: u32::from(kind) % 3,
    };
    let filter = match look >> 4 {
        13 => Filter { category: 2, mask: 1, ..Filter::default() },
        14 => Filter { group: -1, ..Filter::default() },
        _ => Filter::default(),
    };
    let places = [Vec2::ZERO, Vec2::new(size, Fx::ZERO), Vec2::new(Fx::ZERO, size)];
    let places = places.into_iter().take(1 + usize::from(kind >> 3 & 3) % 3);
    let def = |shape, position| ColliderDef { position, material, filter, ..ColliderDef::new(shape) };
    if kind >> 5 & 1 == 1 {
        let part = |position| Part { shape: shape.clone(), position, angle: Fx::ZERO, density: Fx::ONE };
        let compound = Shape::compound(&places.map(part).collect::<Vec<_>>());
        return compound.into_iter().map(|shape| def(shape, Vec2::ZERO)).collect();
    }
    places.map(|position| def(shape.clone(), position)).collect()
}
