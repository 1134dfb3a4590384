use alloc::format;
use alloc::vec::Vec;

use super::super::{Cores, Margin, Pose};
use super::*;
use crate::cases::{run_seed, times};
use crate::kernel::simd::{Line, VectorSet, run_with};
use crate::kernel::trig::sin_cos_turn;
use crate::math::Random;
use crate::scalar::Turn;
use crate::shape::{Outline, Shape};

/// Pairs as they are, with the two outlines swapped, and in a mirror image.
const IMAGES: usize = 3;

/// The margin of bodies that do not move, ulps.
const MARGIN: i64 = 1 << 24;

/// A group of pairs in all images.
struct Group {
    kind: LaneKind,
    cores: Cores,
    margins: [Margin; GROUP],
    motions: Vec<Line>,
    /// The numbers of both outlines in `cores`, in the order of the pair.
    outlines: [[[usize; 2]; GROUP]; IMAGES],
    pairs: [LanePairs; IMAGES],
}

/// A box of 3 cm to 4 m in each direction; one in four is a square of 1 m.
fn sizes(random: &mut Random) -> [Fx; 2] {
    let mut half = || Fx::from_bits((1 << 26) + random.below(1 << 33) as i64);
    let sizes = [half(), half()];
    if random.below(4) == 0 { [crate::fx!(1); 2] } else { sizes }
}

/// Two angles: any ones, with a small difference or a quarter turn between them, equal ones, and zero.
fn angles(random: &mut Random) -> [u64; 2] {
    let angle = random.bits();
    match random.below(6) {
        0 => [angle, random.bits()],
        1 => [(1 << 62) + random.below(1 << 40), random.below(1 << 40)],
        2 => [angle, angle.wrapping_add(random.below(1 << 50))],
        3 => [angle, angle.wrapping_add(1 << 62).wrapping_sub(random.below(1 << 33))],
        4 => [angle; 2],
        _ => [0; 2],
    }
}

/// The offset of two outlines of these sizes: most are near each other, a few within some ulps, and a few as far as a step allows.
fn offset(random: &mut Random, sizes: &[[Fx; 2]; 2]) -> [i64; 2] {
    let reach = sizes.as_flattened().iter().map(|size| size.to_bits()).sum::<i64>() / 2;
    let (reach, bits) = match random.below(32) {
        0 => (4, 0),
        1 => (reach, random.below(22)),
        _ => (reach, 0),
    };
    let mut offset = || (random.below(2 * reach as u64) as i64 - reach) << bits;
    let [x, y] = [offset(), offset()];
    if random.below(4) == 0 { [0, y] } else { [x, y] }
}

/// The centre of a disc of this size in its body: every other one is at the centre of mass.
fn centre(random: &mut Random, size: &[Fx; 2]) -> Vec2 {
    let reach = size[0].to_bits();
    let mut part = || Fx::from_bits(random.below(2 * reach as u64) as i64 - reach);
    let centre = Vec2::new(part(), part());
    if random.below(2) == 0 { Vec2::ZERO } else { centre }
}

/// A form of an outline: its corners counter-clockwise, and the radius around them.
struct Form {
    corners: Vec<Vec2>,
    radius: Fx,
}

impl Form {
    /// A form for a side of a pair of a kind: its size is up to this.
    fn new(random: &mut Random, kind: LaneKind, side: usize, [width, height]: [Fx; 2]) -> Self {
        let (half_width, half_height) = (Fx::from_bits(width.to_bits() / 2), Fx::from_bits(height.to_bits() / 2));
        let corner = |x: Fx, y: Fx| Vec2::new(x, y);
        let rectangle = [
            corner(-half_width, -half_height),
            corner(half_width, -half_height),
            corner(half_width, half_height),
            corner(-half_width, half_height),
        ];
        let rounding = if random.below(2) == 0 { Fx::ZERO } else { half_height };
        let count = match kind {
            LaneKind::Boxes => 4,
            LaneKind::BoxDisc if side == 0 => 4,
            LaneKind::BoxDisc | LaneKind::Discs => 1,
            // The first outline has sides.
            LaneKind::FourCorners if side == 0 => 2 + random.below(3),
            LaneKind::FourCorners => 1 + random.below(4),
            LaneKind::EightCorners if side == 0 => 5 + random.below(4),
            LaneKind::EightCorners => 1 + random.below(8),
        };
        match count {
            1 => Self { corners: alloc::vec![centre(random, &[width, height])], radius: width },
            2 => Self {
                corners: alloc::vec![corner(-half_width, Fx::ZERO), corner(half_width, Fx::ZERO)],
                radius: half_height,
            },
            4 if !kind.has_polygons() => Self { corners: rectangle.into(), radius: Fx::ZERO },
            4 if random.below(2) == 0 => Self { corners: rectangle.into(), radius: rounding },
            count => Self { corners: round_polygon(random, count, half_width), radius: rounding },
        }
    }

    /// The outline, or its mirror image.
    fn outline(&self, mirror: i64) -> Outline {
        let mut corners = self.corners.clone();
        if mirror < 0 {
            corners.reverse();
            corners.iter_mut().for_each(|corner| corner.x = -corner.x);
        }
        let shape = match corners[..] {
            [centre] => {
                let disc = Shape::circle(self.radius).expect("a fair disc");
                return disc.outlines()[0].at(Fx::ZERO, centre);
            }
            [from, to] => Shape::capsule((to.x - from.x).abs(), self.radius),
            _ if self.radius == Fx::ZERO => Shape::polygon(&corners),
            _ => Shape::rounded_polygon(&corners, self.radius),
        };
        shape.expect("a fair shape").outlines()[0].clone()
    }
}

/// A polygon with corners at about even angles on a circle, one in two regular but for rounding.
fn round_polygon(random: &mut Random, count: u64, radius: Fx) -> Vec<Vec2> {
    let is_regular = random.below(2) == 0;
    let mut corner = |i: u64| {
        let step = u64::MAX / count;
        let angle = i * step + if is_regular { 0 } else { random.below(step / 2) };
        let (sin, cos) = sin_cos_turn(angle);
        let part = |unit: i64| Fx::from_bits(((i128::from(radius.to_bits()) * i128::from(unit)) >> 62) as i64);
        Vec2::new(part(cos), part(sin))
    };
    (0..count).map(&mut corner).collect()
}

/// The displacement of a body in a step, the bound of what its rotation adds, and its way to the moment of the manifold; one in four is at
/// rest.
fn motion(random: &mut Random) -> [i64; 6] {
    if random.below(4) == 0 {
        return [0; 6];
    }
    let mut within = |bits: u32| (random.bits() as i64) >> (63 - random.below(u64::from(bits)) as u32);
    [within(30), within(30), within(34).abs(), within(30), within(30), within(28)]
}

/// a / 2^bits to nearest, ties away from zero.
fn rounded(a: i128, bits: u32) -> i128 {
    let size = (a.abs() + (1 << (bits - 1))) >> bits;
    if a < 0 { -size } else { size }
}

/// A point as a contact takes it, in wide integers.
fn surface_point(normal: [i32; 2], point: &ManifoldPoint, motions: [&Line; 2]) -> SurfacePoint {
    let ManifoldPoint { arm_a, arm_b, separation, feature } = *point;
    let normal = normal.map(i128::from);
    let gap = i128::from(separation.to_bits().max(0));
    let [x, y] = normal.map(|part| Fx::from_bits(rounded(part * gap, 31) as i64));
    let arms = [arm_a - Vec2::new(x, y), arm_b + Vec2::new(x, y)];
    let along_row = |side: usize| {
        let Line([_, _, _, x, y, rotation, ..]) = *motions[side];
        let [arm_x, arm_y] = [arms[side].x, arms[side].y].map(|part| rounded(part.to_bits().into(), 4));
        let lever = rounded(arm_x * normal[1] - arm_y * normal[0], 30);
        normal[0] * i128::from(x) + normal[1] * i128::from(y) + 4 * lever * i128::from(rotation)
    };
    let closed = (along_row(0) - along_row(1)) >> 30;
    SurfacePoint { arms, separation: Fx::from_bits(separation.to_bits() + closed as i64), feature }
}

impl Group {
    fn new(random: &mut Random, kind: LaneKind) -> Self {
        let mut cores = Cores::default();
        let mut margins = [Margin::from(Fx::ZERO); GROUP];
        let mut outlines = [[[0; 2]; GROUP]; IMAGES];
        let mut pairs = [(); IMAGES].map(|()| LanePairs::default());
        let mut motions = Vec::new();
        for lane in 0..GROUP {
            let sizes = [sizes(random), sizes(random)];
            let angles = angles(random);
            let offset = offset(random, &sizes);
            let forms = [Form::new(random, kind, 0, sizes[0]), Form::new(random, kind, 1, sizes[1])];
            let position = random.below(1 << 40) as i64;
            let motion = [motion(random), motion(random)];
            let [[a_x, a_y, turned_a, ..], [b_x, b_y, turned_b, ..]] = motion;
            margins[lane] = Margin::new(Fx::from_bits(MARGIN + turned_a + turned_b), [b_x - a_x, b_y - a_y]);
            let mut place = |side: usize, mirror: i64| {
                let outline = forms[side].outline(mirror);
                let [x, y] = if side == 0 { [0; 2] } else { offset };
                let place = Vec2::new(Fx::from_bits(mirror * (x + position)), Fx::from_bits(y));
                let angle = angles[side].wrapping_mul(mirror as u64);
                cores.push(&outline, &Pose::new(place, Turn::from_bits(angle)))
            };
            let pair = [place(0, 1), place(1, 1)];
            let images = [pair, [pair[1], pair[0]], [place(0, -1), place(1, -1)]];
            for (image, pair) in images.into_iter().enumerate() {
                outlines[image][lane] = pair;
                let mirror = if image == 2 { -1 } else { 1 };
                let first = motions.len() as u32;
                motions.extend(motion.map(|[x, y, turned, way_x, way_y, rotation]| {
                    Line([mirror * x, y, turned, mirror * way_x, way_y, mirror * rotation, 0, 0])
                }));
                let mut numbers = [first, first + 1];
                let mut lines = pair.map(|core| if kind.has_polygons() { cores.polygon(core) } else { core as u32 });
                // A box comes before a disc in lanes.
                let is_swapped = image == 1 && kind == LaneKind::BoxDisc;
                if is_swapped {
                    lines.reverse();
                } else if image == 1 {
                    numbers.reverse();
                }
                pairs[image].set(lane, lines, numbers, is_swapped);
            }
        }
        Self { kind, cores, margins, motions, outlines, pairs }
    }

    /// The manifolds of an image with a set of vectors.
    fn collide(&self, set: VectorSet, image: usize) -> LaneManifolds {
        let mut manifolds = [LaneManifolds::default()];
        let (outlines, polygons) = self.cores.lines();
        let tables = Tables { outlines, polygons, motions: &self.motions, margin: MARGIN };
        let pairs = core::slice::from_ref(&self.pairs[image]);
        let job = CollidePairs { kind: self.kind, tables, pairs, manifolds: &mut manifolds };
        run_with(set, job);
        let [manifolds] = manifolds;
        manifolds
    }

    /// Compares a decided lane with the manifold of the pair alone, and returns the number of its points; `None` if it is undecided.
    fn check(&self, manifolds: &LaneManifolds, image: usize, lane: usize, name: &str) -> Option<usize> {
        let [a, b] = self.outlines[image][lane];
        let expected = self.cores.collide(a, b, self.margins[lane]);
        let (count, first) = match manifolds.get(lane) {
            LaneManifold::Undecided => return None,
            LaneManifold::None => {
                assert_eq!(None, expected, "{name}");
                return Some(0);
            }
            LaneManifold::Points(count, first) => (count, first),
        };
        let manifold = manifolds.manifold(lane, count, first);
        assert_eq!(Some(manifold), expected, "{name}");
        let mut motions = self.pairs[image].motions.map(|index| &self.motions[index[lane] as usize]);
        if self.pairs[image].swapped[lane] != 0 {
            motions.reverse();
        }
        for (k, point) in manifold.points.iter().enumerate().take(count) {
            let expected = surface_point(manifold.normal, point, motions);
            assert_eq!(manifolds.point(lane, first + k), expected, "{name}");
        }
        Some(count)
    }
}

/// Each lane that is decided has the manifold of the pair alone, to the bit, with any vectors, and its points on the surfaces. A pair is decided
/// in all its images, or in none.
#[test]
fn lanes_find_the_manifolds_of_pairs() {
    for kind in LaneKind::ALL {
        let (mut decided, mut touching) = (0, 0);
        let rounds = times(4_000);
        for round in 0..rounds {
            let group = Group::new(&mut Random::seeded(run_seed(round)), kind);
            let mut undecided = None;
            for set in VectorSet::available() {
                for image in 0..IMAGES {
                    let manifolds = group.collide(set, image);
                    let name = format!("{set:?}, round {round}, image {image}, {kind:?}");
                    assert_eq!(*undecided.get_or_insert(manifolds.undecided), manifolds.undecided, "{name}");
                    for lane in 0..GROUP {
                        let points = group.check(&manifolds, image, lane, &format!("{name}, lane {lane}"));
                        if set == VectorSet::Portable {
                            decided += u64::from(points.is_some());
                            touching += u64::from(points.is_some_and(|points| points > 0));
                        }
                    }
                }
            }
        }
        let all = rounds * (GROUP * IMAGES) as u64;
        assert!(
            decided > all / 2 && touching > all / 5,
            "{kind:?}: {decided} decided and {touching} touching of {all}"
        );
    }
}
