//! A pile of bodies that touch, from few bytes each.

use arbitrary::Result;
use umbra_physics::{
    BodyDef, BodyKind, ColliderDef, Command, CommandSource as _, Error, Filter, Fx, Locks, Mass, Material, MixRule,
    Part, Shape, TimeStep, Vec2, World, fx, vec2,
};

use super::author::Author;
use super::number;

/// The most bodies of a pile without its floor: of most piles, and of one in 16.
const BODIES: [u8; 2] = [5, 20];
/// Bodies in a row of a pile: a heap, a wall, a tower, a floor of discs.
const ROWS: [i32; 4] = [3, 2, 1, 5];

/// Units of length, speed and mass of the whole pile, most often everyday ones. One pile in 16 is fast.
const UNITS: [Fx; 8] = [fx!(1), fx!(1), fx!(1), fx!(1), fx!(1), fx!(0.0625), fx!(16), fx!(512)];
const SPEEDS: [Fx; 8] = [fx!(0), fx!(0.125), fx!(1), fx!(1), fx!(1), fx!(1), fx!(2), fx!(8)];
const FAST: [Fx; 2] = [fx!(256), fx!(65536)];
/// A load of more than 64 times the mass below it takes several times as long to solve: the last kind has such.
const MASSES: [[Fx; 4]; 4] = [
    [fx!(1); 4],
    [fx!(1), fx!(3), fx!(1), fx!(3)],
    [fx!(1), fx!(8), fx!(0.25), fx!(16)],
    [fx!(0.0001), fx!(1), fx!(16_777_216), fx!(1000)],
];

/// How near the bodies of a pile are to each other at its start.
#[derive(Clone, Copy, PartialEq)]
enum Fit {
    /// They touch, and overlap by 2^-8 m at most: more is a deep overlap, which takes a dozen times as long to solve.
    Close,
    /// They are up to a quarter of a cell apart.
    Loose,
    /// They overlap by any part of a cell or two. One pile in 16 does.
    Deep,
}

/// Adds a pile to a world: a floor or none, and bodies in rows that touch, overlap or are near each other. What the input lacks is
/// zero: a disc.
pub fn pile(author: &mut Author<'_>, world: &mut World) -> Result<()> {
    let [floor, count, units, place, fit]: [u8; 5] = author.any()?;
    let fit = match fit {
        240.. => Fit::Deep,
        _ if fit % 4 == 3 => Fit::Loose,
        _ => Fit::Close,
    };
    let row = ROWS[usize::from(floor / 64)];
    let unit = UNITS[usize::from(units % 8)];
    let is_fast = floor % 64 >= 60;
    let speed = if is_fast { FAST[usize::from(units / 8 % 2)] } else { SPEEDS[usize::from(units / 8 % 8)] };
    let masses = MASSES[usize::from(units / 64)];
    let corner = if place % 4 == 0 { author.generator().position() } else { Vec2::ZERO };
    // The side of a cell, a share of it by which a body is moved, and the angle of a turned one.
    let (gap, part, angle) = match fit {
        Fit::Close => (fx!(0.99951171875), fx!(0.00048828125), fx!(0.001953125)),
        Fit::Loose => (fx!(1.0625), fx!(0.0625), fx!(0.125)),
        Fit::Deep => {
            ([fx!(0.9375), fx!(0.9375), fx!(1.0625), fx!(0.75)][usize::from(place / 4 % 4)], fx!(0.0625), fx!(0.125))
        }
    };
    // A pile under everyday gravity and at an everyday rate stays one; one in 16 has what the world came with.
    if place / 16 != 15 {
        let gravity = vec2(0, [0, -10, -10, -30][usize::from(place >> 6)]) * unit;
        for command in [Command::SetGravity(gravity), Command::SetTimeStep(TimeStep::hz(60))] {
            _ = world.execute(&command);
        }
    }
    // Bodies that do not overlap each other rest on a chain and a plate from the start.
    let lift = if fit == Fit::Deep { fx!(0) } else { fx!(0.25) };
    for def in floors(floor, unit, lift).unwrap_or_default() {
        add(author, world, BodyDef { position: corner.checked_add(def.position).unwrap_or(corner), ..def });
    }
    for i in 0..number(count, BODIES[0], BODIES[1]) as i32 {
        let [kind, offsets, motion, look]: [u8; 4] = author.any()?;
        let parts = |number: u8| part * i32::from(number);
        let cell = vec2(i % row, 1 + i / row) * gap + Vec2::new(parts(offsets & 3), parts(offsets >> 2 & 3));
        let turn = [fx!(0), fx!(0), Fx::PI / 2, angle][usize::from(offsets >> 4 & 3)];
        let eighth = |bits: u8| Fx::from_ratio(i64::from(bits & 7) - 4, 4);
        let colliders =
            if kind == 255 { vec![author.generator().collider_def()] } else { colliders(kind, look, unit, fit) };
        let is_still = motion >> 6 == 0;
        let def = BodyDef {
            kind: if look >> 4 == 15 { BodyKind::Kinematic } else { BodyKind::Dynamic },
            position: corner.checked_add(cell * unit).unwrap_or(cell),
            angle: turn,
            velocity: if is_still { Vec2::ZERO } else { Vec2::new(eighth(motion), eighth(motion >> 3)) * speed },
            angular_velocity: if is_still { fx!(0) } else { eighth(motion >> 3) * 4 },
            mass: if units / 64 == 0 { Mass::FromColliders } else { Mass::Kilograms(masses[usize::from(look & 3)]) },
            locks: Locks { x: false, y: false, rotation: offsets >> 6 == 3 },
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
    world.execute(&Command::AddBody(def)).into_iter().for_each(|created| author.made(world, created));
}

/// The bodies under a pile, of which some are lifted: none, a box, a box with walls, a chain, or a plate that moves up.
fn floors(kind: u8, unit: Fx, lift: Fx) -> Result<Vec<BodyDef>, Error> {
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
            let hill = |i: i32| {
                vec2(fx!(8) - Fx::from_ratio(i.into(), 4), lift + Fx::from_ratio(i64::from(i * i % 5), 16)) * unit
            };
            let points: Vec<Vec2> = (0..50).map(hill).collect();
            vec![BodyDef::fixed().with_collider(Shape::chain(&points, false)?)]
        }
        _ => {
            let plate = slab(fx!(2.5), fx!(0.25) + lift / 2, fx!(16), fx!(0.25))?;
            vec![BodyDef { velocity: vec2(0, 1) * unit, ..BodyDef { kind: BodyKind::Kinematic, ..plate } }]
        }
    })
}

/// One to three colliders of a body, or a compound of as many parts; within the body's cell, if the pile is not deep.
fn colliders(kind: u8, look: u8, unit: Fx, fit: Fit) -> Vec<ColliderDef> {
    let (is_deep, count) = (fit == Fit::Deep, 1 + usize::from(kind >> 3 & 3) % 3);
    let largest = if is_deep { fx!(2) } else { fx!(1) };
    let size = unit * [fx!(1), fx!(0.5), largest, fx!(1)][usize::from(kind >> 6)];
    let size = if is_deep || count == 1 { size } else { size / 2 };
    let half = size / 2;
    // A triangle reaches two thirds of its height above its centre of mass.
    let side = if is_deep { half } else { half * 3 / 4 };
    let shape = match kind % 8 {
        0 | 1 => Shape::circle(half),
        2 => Shape::rectangle(size, size),
        3 => Shape::rectangle(size, half / 4),
        4 => Shape::capsule(half, half / 2),
        5 => Shape::segment(Vec2::new(-half, Fx::ZERO), Vec2::new(half, Fx::ZERO)),
        6 => Shape::polygon(&[(-side, -side), (side, -side), (Fx::ZERO, side)].map(|(x, y)| Vec2::new(x, y))),
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
    let first = if is_deep || count == 1 { Vec2::ZERO } else { Vec2::new(-half, -half) };
    let places = [Vec2::ZERO, Vec2::new(size, Fx::ZERO), Vec2::new(Fx::ZERO, size)].map(|place| first + place);
    let places = places.into_iter().take(count);
    let def = |shape, position| ColliderDef { position, material, filter, ..ColliderDef::new(shape) };
    if kind >> 5 & 1 == 1 {
        let part = |position| Part { shape: shape.clone(), position, angle: Fx::ZERO, density: Fx::ONE };
        let compound = Shape::compound(&places.map(part).collect::<Vec<_>>());
        return compound.into_iter().map(|shape| def(shape, Vec2::ZERO)).collect();
    }
    places.map(|position| def(shape.clone(), position)).collect()
}
