//! Random cores and rays.

use alloc::vec::Vec;

use crate::math::Random;
use crate::query::{Core, Point};

/// Cases of a test.
pub(super) fn cases() -> u32 {
    crate::cases::times(20_000)
}

impl Core {
    /// The hull of these points, with a radius.
    pub(super) fn of(points: &[Point], radius: i64) -> Self {
        let mut core = Self::default();
        core.radius = radius;
        points.iter().for_each(|&point| core.push(point));
        core.take_hull();
        core
    }
}

/// A core, a second one, and a ray.
#[derive(Debug)]
pub(super) struct Case {
    pub(super) core: Core,
    pub(super) other: Core,
    pub(super) ray: Point,
}

fn within(random: &mut Random, bound: i64) -> i64 {
    random.bits().cast_signed().rem_euclid(2 * bound + 1) - bound
}

fn vector(random: &mut Random, bound: i64) -> Point {
    [within(random, bound), within(random, bound)]
}

/// A case of one of three kinds: on a lattice of few points, where all ties and grazes occur; of like sizes; at the ends of the ranges.
pub(super) fn case(random: &mut Random) -> Case {
    let kind = random.bits() % 4;
    let (unit, size, away, far, radius) = match kind {
        // Lattices.
        0 => (1, 4, 4, 9, 5),
        1 => (1 << (random.bits() % 44), 3, 3, 7, 5),
        // Sizes of games, with fractions.
        2 => (1, 1 << (26 + random.bits() % 12), 1 << 38, 1 << (28 + random.bits() % 14), 1 << 36),
        _ => {
            (1, 1 << (25 + random.bits() % 23), 1 << (40 + random.bits() % 13), 1 << (30 + random.bits() % 23), 1 << 44)
        }
    };
    let mut core = |away: i64| {
        let count = [1, 2, 3, 4, 5, 12, 40][(random.bits() % 7) as usize];
        let centre = vector(random, away);
        let points: Vec<Point> = (0..count)
            .map(|_| {
                let [x, y] = vector(random, size);
                [(centre[0] + x) * unit, (centre[1] + y) * unit]
            })
            .collect();
        let radius = if random.bits() % 2 == 0 { 0 } else { within(random, radius).abs() * unit };
        Core::of(&points, radius)
    };
    let (core, second) = (core(away), core(away / 2));
    let max = far.min((1 << 52) / unit);
    let mut ray = vector(random, max).map(|part| part * unit);
    match random.bits() % 8 {
        0 => ray[0] = 0,
        1 => ray[1] = 0,
        2 => ray[1] = ray[0],
        // At a corner, or beyond it.
        3 | 4 => {
            let corner = core.corners()[(random.bits() % core.corners().len() as u64) as usize];
            let times = 1 + (random.bits() % 3) as i64;
            ray = corner.map(|part| (part * times).clamp(-(1 << 52), 1 << 52));
        }
        _ => {}
    }
    Case { core, other: second, ray }
}
