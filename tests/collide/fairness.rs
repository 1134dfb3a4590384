//! The manifold of an image of a pair is the image of its manifold, to the bit.

use super::cases;
use crate::collide::pairs::{Case, KINDS, random_case, tied_case};
use crate::collide::random::SplitMix;
use umbra_physics::collide::{Manifold, ManifoldPoint, feature};
use umbra_physics::{Fx, Shape, Turn, Vec2};

/// The effect of an image on directions, numbers of corners and sides.
struct Image {
    case: Case,
    direction: fn(Vec2) -> Vec2,
    /// The number of each corner of A and of B in the image.
    numbers: [Vec<usize>; 2],
    mirrors: bool,
    swaps: bool,
}

/// The number of each corner of a shape in its image.
fn numbers(shape: &Shape, image: &Shape, map: fn(Vec2) -> Vec2) -> Vec<usize> {
    let (corners, images) = (shape.outlines()[0].corners(), image.outlines()[0].corners());
    corners
        .iter()
        .map(|&corner| images.iter().position(|&c| c == map(corner)).expect("the image of a corner"))
        .collect()
}

fn same_numbers(case: &Case, image: &Case, map: fn(Vec2) -> Vec2) -> [Vec<usize>; 2] {
    let (shapes, image_shapes) = (case.shapes(), image.shapes());
    [0, 1].map(|i| numbers(&shapes[i], &image_shapes[i], map))
}

fn flip(v: Vec2) -> Vec2 {
    Vec2::new(-v.x, v.y)
}

fn images(random: &mut SplitMix, case: &Case) -> Vec<Image> {
    let same: fn(Vec2) -> Vec2 = |v| v;
    let mut images = Vec::new();
    let mut add = |image: Case, direction, shape_map, mirrors, swaps| {
        let numbers = same_numbers(case, &image, shape_map);
        images.push(Image { case: image, direction, numbers, mirrors, swaps });
    };
    let mirrored = Case {
        recipes: case.recipes.each_ref().map(|r| r.mirrored()),
        positions: case.positions.map(flip),
        angles: case.angles.map(|a| Turn::from_bits(a.to_bits().wrapping_neg())),
        ..*case
    };
    add(mirrored, flip, flip, true, false);
    let quarter = Case {
        positions: case.positions.map(Vec2::perp),
        angles: case.angles.map(|a| Turn::from_bits(a.to_bits().wrapping_add(1 << 62))),
        ..case.clone()
    };
    add(quarter, Vec2::perp, same, false, false);
    let shift = Vec2::new(Fx::from_bits(random.between(-999, 999)), Fx::from_bits(random.between(-1 << 40, 1 << 40)));
    add(Case { positions: case.positions.map(|p| p + shift), ..case.clone() }, same, same, false, false);
    let steps = [0; 2].map(|_| random.between(1, 128) as usize);
    let renumbered = Case { recipes: [0, 1].map(|i| case.recipes[i].renumbered(steps[i])), ..case.clone() };
    add(renumbered, same, same, false, false);
    images.push(Image {
        case: Case {
            recipes: [case.recipes[1].clone(), case.recipes[0].clone()],
            positions: [case.positions[1], case.positions[0]],
            angles: [case.angles[1], case.angles[0]],
            margin: case.margin,
        },
        direction: same,
        numbers: case.shapes().map(|shape| (0..shape.outlines()[0].corners().len()).collect()),
        mirrors: false,
        swaps: true,
    });
    images
}

impl Image {
    fn of_point(&self, point: ManifoldPoint) -> ManifoldPoint {
        let part = |at: u32| (point.feature >> at & 63) as usize;
        let named = |side: usize, at: u32| {
            let [start, end] = [self.numbers[side][part(at)], self.numbers[side][part(at + 6)]];
            if self.mirrors { [end, start] } else { [start, end] }
        };
        let (a, b) = (named(0, 0), named(1, 12));
        let (arm_a, arm_b) = ((self.direction)(point.arm_a), (self.direction)(point.arm_b));
        if self.swaps {
            return ManifoldPoint { arm_a: arm_b, arm_b: arm_a, feature: feature(b, a), ..point };
        }
        ManifoldPoint { arm_a, arm_b, feature: feature(a, b), ..point }
    }

    fn of(&self, manifold: &Manifold) -> Manifold {
        let [x, y] = manifold.normal.map(Fx::from_int);
        let n = (self.direction)(Vec2::new(x, y));
        let n = [n.x, n.y].map(|part| (part.to_bits() >> 32) as i32);
        let mut image = Manifold {
            normal: if self.swaps { n.map(|part| -part) } else { n },
            count: manifold.count,
            points: [ManifoldPoint::default(); 2],
        };
        for (i, &point) in manifold.points[..manifold.count].iter().enumerate() {
            let place = if self.mirrors != self.swaps { manifold.count - 1 - i } else { i };
            image.points[place] = self.of_point(point);
        }
        image
    }
}

pub(crate) fn check(random: &mut SplitMix, case: &Case) -> Option<Manifold> {
    let manifold = case.manifold();
    for (number, image) in images(random, case).into_iter().enumerate() {
        let expected = manifold.map(|manifold| image.of(&manifold));
        assert_eq!(image.case.manifold(), expected, "image {number} of {case:?}");
    }
    manifold
}

#[test]
fn images_of_random_pairs_have_the_images_of_their_manifolds() {
    let mut random = SplitMix::seeded(41);
    let mut counts = [0; 3];
    for i in 0..cases() {
        let kinds = [0, 1].map(|_| KINDS[random.between(0, KINDS.len() as i64) as usize]);
        let exponent = random.between(27, 42) as u32;
        let second_exponent = if i % 3 == 0 { random.between(27, 42) as u32 } else { exponent };
        let case = random_case(&mut random, kinds, [exponent, second_exponent]);
        counts[check(&mut random, &case).map_or(0, |m| m.count)] += 1;
    }
    assert!(counts.iter().all(|&count| count > cases() / 10), "{counts:?}");
}

#[test]
fn images_of_pairs_that_tie_have_the_images_of_their_manifolds() {
    let mut random = SplitMix::seeded(42);
    let mut counts = [0; 3];
    for _ in 0..cases() {
        let case = tied_case(&mut random);
        counts[check(&mut random, &case).map_or(0, |m| m.count)] += 1;
    }
    assert!(counts.iter().all(|&count| count > cases() / 10), "{counts:?}");
}
