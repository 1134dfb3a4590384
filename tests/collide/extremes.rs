//! The ends of the ranges, and shapes that are hardly any: nothing wraps, and images still have the images of manifolds.

use super::cases;
use crate::collide::fairness;
use crate::collide::pairs::{Case, KINDS, Recipe, random_case, reach};
use crate::collide::random::SplitMix;
use umbra_physics::collide::{Pose, collide, radius_bound};
use umbra_physics::{Aabb, Fx, Part, Shape, Turn, Vec2, fx, limits, vec2};

fn bits(random: &mut SplitMix, max_bits: u32) -> Fx {
    Fx::from_bits(random.of_bits(max_bits))
}

#[test]
fn pairs_of_every_size_anywhere_have_fair_manifolds() {
    let mut random = SplitMix::seeded(51);
    let mut counts = [0; 3];
    for _ in 0..cases() {
        let kinds = [0, 1].map(|_| KINDS[random.between(0, KINDS.len() as i64) as usize]);
        let exponents = [0, 1].map(|_| random.between(27, 43) as u32);
        let mut case = random_case(&mut random, kinds, exponents);
        // At a corner of the world, and never over its edge.
        let edge = limits::POSITION - fx!(32768);
        let corner = Vec2::new(edge, if random.between(0, 2) == 0 { edge } else { -edge });
        let offset = case.positions[1] - case.positions[0];
        case.positions = [corner, corner + offset];
        case.margin = [bits(&mut random, 62), Fx::MAX, Fx::MIN, Fx::ZERO, fx!(0.02)][random.between(0, 5) as usize];
        counts[fairness::check(&mut random, &case).map_or(0, |m| m.count)] += 1;
    }
    assert!(counts.iter().all(|&count| count > cases() / 20), "{counts:?}");
}

#[test]
fn slivers_and_deep_overlaps_have_fair_manifolds() {
    let mut random = SplitMix::seeded(52);
    let mut counts = [0; 3];
    for _ in 0..cases() {
        // Corners by ulps off a line; any of them may fall together when they are turned.
        let long = 1i64 << random.between(26, 44);
        let sliver = |random: &mut SplitMix| {
            let (x, y) = (random.between(-3, 4), random.between(1, 9));
            let corners = [[-long, 0], [x, -y], [long, 0], [x + 1, y]];
            Recipe::Polygon(corners.map(|[x, y]| Vec2::new(Fx::from_bits(x), Fx::from_bits(y))).into())
        };
        let mut recipes = [sliver(&mut random), sliver(&mut random)];
        if random.between(0, 2) == 0 {
            recipes[1] = Recipe::Rectangle(Fx::from_bits(long), Fx::from_bits(1 << 25));
        }
        if recipes.iter().any(|r| r.shape().is_none()) {
            continue;
        }
        let offset = Vec2::new(bits(&mut random, 34), bits(&mut random, 34));
        let turns = [0; 2].map(|_| Turn::from_bits(random.next() << (64 - random.between(1, 65))));
        let case = Case { recipes, positions: [Vec2::default(), offset], angles: turns, margin: fx!(0.02) };
        counts[fairness::check(&mut random, &case).map_or(0, |m| m.count)] += 1;
    }
    assert!(counts.iter().all(|&count| count > cases() / 50), "{counts:?}");
}

#[test]
fn bodies_at_opposite_ends_of_the_world_are_apart() {
    let shape = Shape::rectangle(limits::SIZE_MAX, limits::SIZE_MAX).expect("a shape");
    let outline = &shape.outlines()[0];
    let far = limits::POSITION + limits::POSITION / 2;
    for (x, y) in [(far, far), (-far, far), (Fx::ZERO, -far), (Fx::MAX, Fx::MIN)] {
        let at = |x, y| Pose::new(Vec2::new(x, y), Turn::from_bits(1 << 61));
        assert_eq!(collide(outline, &at(x, y), outline, &at(-far, -far), Fx::MAX), None);
    }
}

#[test]
fn outlines_of_compounds_turn_about_the_centre_of_the_body() {
    let disc = Shape::circle(fx!(0.5)).expect("a disc");
    let part = |x: i32| Part { shape: disc.clone(), position: vec2(x, 0), angle: Fx::ZERO, density: Fx::ONE };
    let dumbbell = Shape::compound(&[part(-4000), part(4000)]).expect("a dumbbell");
    let (left, ball) = (&dumbbell.outlines()[0], &disc.outlines()[0]);
    assert_eq!(radius_bound(left), fx!(4000.5) + Fx::DELTA);
    // Turned by a quarter, the left end is below.
    let body = Pose::new(vec2(7, 7), Turn::QUARTER);
    let manifold = collide(left, &body, ball, &Pose::new(vec2(7, fx!(-3994.0)), Turn::default()), fx!(0.02));
    let manifold = manifold.expect("a contact");
    assert_eq!((manifold.normal, manifold.count), ([0, -1 << 30], 1));
    let [point, _] = manifold.points;
    assert_eq!((point.arm_a, point.arm_b), (vec2(0, fx!(-4000.5)), vec2(0, fx!(0.5))));
    assert_eq!(point.separation, Fx::ZERO);
}

#[test]
fn the_bound_on_the_radius_is_less_than_two_ulps_above_it() {
    let mut random = SplitMix::seeded(53);
    for _ in 0..cases() / 10 {
        let kind = KINDS[random.between(0, KINDS.len() as i64) as usize];
        let exponent = random.between(27, 43) as u32;
        let shape = crate::collide::pairs::recipe(&mut random, kind, exponent).shape().expect("a shape");
        let outline = &shape.outlines()[0];
        let core = i128::from(reach(&shape) - outline.radius().to_bits());
        let square = |v: &Vec2| i128::from(v.x.to_bits()).pow(2) + i128::from(v.y.to_bits()).pow(2);
        let farthest = outline.corners().iter().map(square).max().expect("a corner");
        assert!(core * core >= farthest && (core - 2).max(0).pow(2) <= farthest, "{kind}");
    }
}

/// The box of a turned box against its corners in floats, and against the boxes of mirror images to the bit.
#[test]
fn the_box_of_a_pose_is_the_least_one_around_its_corners() {
    let mut random = SplitMix::seeded(54);
    for _ in 0..cases() {
        let exponent = random.between(20, 47) as u32;
        let [x, y] = [0, 1].map(|_| {
            let ends = [0, 1].map(|_| bits(&mut random, exponent));
            [ends[0].min(ends[1]), ends[0].max(ends[1])]
        });
        let local_bounds = Aabb { min: Vec2::new(x[0], y[0]), max: Vec2::new(x[1], y[1]) };
        let radius = Fx::from_bits(bits(&mut random, 44).to_bits().abs());
        let (position, angle) = (Vec2::new(bits(&mut random, 52), bits(&mut random, 52)), random.next());
        let bounds = Pose::new(position, Turn::from_bits(angle)).bounds(&local_bounds, radius);

        // Ulps, to 2^-53 of 2^53.
        let ulps = |value: Fx| value.to_bits() as f64;
        let (sin, cos) = (angle as f64 / 2.0_f64.powi(64) * std::f64::consts::TAU).sin_cos();
        let corners = [(x[0], y[0]), (x[1], y[0]), (x[1], y[1]), (x[0], y[1])].map(|(x, y)| (ulps(x), ulps(y)));
        let along = |part: &dyn Fn((f64, f64)) -> f64, centre: Fx, [low, high]: [Fx; 2]| {
            let parts = corners.map(part);
            let greatest = parts.iter().copied().fold(f64::MIN, f64::max) + ulps(radius);
            let least = parts.iter().copied().fold(f64::MAX, f64::min) - ulps(radius);
            let over = [ulps(high) - ulps(centre) - greatest, least - (ulps(low) - ulps(centre))];
            assert!(over.iter().all(|over| (0.9..3.1).contains(over)), "{over:?} at {angle:#x} of {local_bounds:?}");
        };
        along(&|(x, y)| x * cos - y * sin, position.x, [bounds.min.x, bounds.max.x]);
        along(&|(x, y)| x * sin + y * cos, position.y, [bounds.min.y, bounds.max.y]);

        // Mirrored at the y axis.
        let mirrored = Aabb {
            min: Vec2::new(-local_bounds.max.x, local_bounds.min.y),
            max: Vec2::new(-local_bounds.min.x, local_bounds.max.y),
        };
        let position = Vec2::new(-position.x, position.y);
        let image = Pose::new(position, Turn::from_bits(angle.wrapping_neg())).bounds(&mirrored, radius);
        assert_eq!((image.min.x, image.max.x), (-bounds.max.x, -bounds.min.x));
        assert_eq!((image.min.y, image.max.y), (bounds.min.y, bounds.max.y));
    }
}
