//! Cases whose manifold is known, and what stays the same while bodies slide.

use super::cases;
use crate::collide::pairs::{Case, Recipe};
use crate::collide::random::SplitMix;
use umbra_physics::collide::{Manifold, feature};
use umbra_physics::{Fx, FxWide, Turn, Vec2, fx, vec2};

const ONE: i32 = 1 << 30;
/// At least the unit in which directions of boxes of 1 m are compared.
const UNIT: Fx = Fx::from_bits(16);
const EIGHTH: Turn = Turn::from_bits(1 << 61);
const NONE: Turn = Turn::from_bits(0);

fn square() -> Recipe {
    Recipe::Rectangle(fx!(1), fx!(1))
}

fn manifold(recipes: [Recipe; 2], offset: Vec2, angles: [Turn; 2]) -> Option<Manifold> {
    Case { recipes, positions: [vec2(3, 5), vec2(3, 5) + offset], angles, margin: fx!(0.02) }.manifold()
}

fn features(manifold: &Manifold) -> Vec<u32> {
    manifold.points[..manifold.count].iter().map(|p| p.feature).collect()
}

/// Corners of a rectangle: 0 and 1 below, 2 and 3 above, counter-clockwise.
#[test]
fn an_aligned_stack_has_two_points_exactly() {
    let m = manifold([square(), square()], vec2(0, fx!(0.998)), [NONE; 2]).expect("a contact");
    assert_eq!((m.normal, m.count), ([0, ONE], 2));
    // Across the normal, to the left, is the order of the points.
    assert_eq!(features(&m), [feature([2, 2], [1, 1]), feature([3, 3], [0, 0])]);
    let sunk = fx!(0.998) - Fx::ONE;
    for (point, x) in m.points.into_iter().zip([fx!(0.5), fx!(-0.5)]) {
        assert_eq!((point.separation, point.arm_a.x, point.arm_b.x), (sunk, x, x));
        // In the middle between the faces; half an ulp goes away from either centre.
        assert_eq!((point.arm_a.y, point.arm_b.y), (fx!(0.499), -fx!(0.499)));
    }
}

#[test]
fn a_box_that_slides_keeps_its_features() {
    let mut random = SplitMix::seeded(61);
    let wide = Recipe::Rectangle(fx!(3), fx!(1));
    for recipes in [[square(), square()], [wide.clone(), square()], [square(), wide]] {
        let reach = if matches!(recipes, [Recipe::Rectangle(a, _), Recipe::Rectangle(b, _)] if a == b) { 1 } else { 2 };
        let expected = [feature([2, 2], [1, 1]), feature([3, 3], [0, 0])];
        let steps = cases() as i64 / 10;
        // To where the sides overlap less than the faces.
        for step in 1 - steps..steps {
            let x = Fx::from_ratio(step * reach, steps) * fx!(0.998);
            // Separations of the faces differ by ulps, and either face is the better one.
            let y = fx!(0.999) + Fx::from_bits(random.between(-3, 4));
            let angles = [0; 2].map(|_| Turn::from_bits(random.between(-16, 17) as u64));
            let m = manifold(recipes.clone(), Vec2::new(x, y), angles).expect("a contact");
            assert_eq!(features(&m), expected, "{x} {y} {angles:?}");
        }
    }
}

#[test]
fn a_corner_on_a_diagonal_is_pushed_along_it() {
    let m = manifold([square(), square()], vec2(fx!(0.875), fx!(0.875)), [NONE; 2]).expect("a contact");
    // cos 45° in units of 2^-30.
    assert_eq!((m.normal, m.count), ([759_250_125, 759_250_125], 1));
    assert_eq!(features(&m), [feature([2, 2], [0, 0])]);
    assert_eq!(m.points[0].arm_a, vec2(fx!(0.4375), fx!(0.4375)));
    // -√2/8.
    assert!((m.points[0].separation.to_bits() + 759_250_125).abs() <= 2);
    // A unit off, it is a face, and faces overlap.
    let m = manifold([square(), square()], vec2(fx!(0.875), fx!(0.875) + UNIT), [NONE; 2]).expect("a contact");
    assert_eq!((m.normal, m.count), ([0, ONE], 2));
}

#[test]
fn the_longer_edge_wins_a_tie() {
    let bar = Recipe::Rectangle(fx!(2), fx!(1));
    let m = manifold([bar.clone(), bar], vec2(fx!(1.875), fx!(0.875)), [NONE; 2]).expect("a contact");
    assert_eq!((m.normal, m.count), ([0, ONE], 2));
}

#[test]
fn a_box_on_its_corner_has_one_point() {
    let up = fx!(0.5) + Fx::from_ratio(1_000, 1_414);
    let m = manifold([Recipe::Rectangle(fx!(9), fx!(1)), square()], Vec2::new(fx!(1), up), [NONE, EIGHTH]);
    let m = m.expect("a contact");
    assert_eq!((m.normal, m.count), ([0, ONE], 1));
    assert_eq!(features(&m), [feature([2, 3], [0, 0])]);
    assert!((m.points[0].arm_b.x).abs() <= Fx::DELTA);
}

#[test]
fn corners_that_touch_hold_nothing() {
    for offset in [vec2(1, 1), vec2(fx!(1.0001), fx!(1)), vec2(fx!(1), fx!(1.0001)), vec2(1, -1)] {
        assert_eq!(manifold([square(), square()], offset, [NONE; 2]), None, "{offset}");
    }
    // From 2^-11 of the size on they have a direction.
    let m = manifold([square(), square()], vec2(fx!(1.003), fx!(1.004)), [NONE; 2]).expect("a contact");
    assert_eq!((m.count, m.points[0].separation), (1, fx!(0.005)));
    assert!((m.normal[0] - ONE / 5 * 3).abs() < 64 && (m.normal[1] - ONE / 5 * 4).abs() < 64, "{:?}", m.normal);
}

#[test]
fn without_a_fair_direction_there_is_no_manifold() {
    let (disc, bar) = (Recipe::Disc(fx!(0.25)), Recipe::Rectangle(fx!(4), fx!(1)));
    let middle = Vec2::default();
    for (recipes, offset) in [
        ([disc.clone(), disc.clone()], middle),
        ([square(), square()], middle),
        ([square(), disc.clone()], middle),
        ([bar.clone(), disc], vec2(1, 0)),
        ([bar.clone(), bar], middle),
    ] {
        for angle in [NONE, EIGHTH] {
            // Its offset along the bar is not turned with it.
            let angles = if offset == middle { [angle; 2] } else { [NONE, angle] };
            assert_eq!(manifold(recipes.clone(), offset, angles), None, "{recipes:?}");
        }
    }
    // A unit off, there is one.
    let m = manifold([square(), square()], Vec2::new(Fx::ZERO, UNIT), [NONE; 2]).expect("a contact");
    assert_eq!(m.normal, [0, ONE]);
}

#[test]
fn a_disc_inside_leaves_by_the_nearest_edge() {
    let m = manifold([square(), Recipe::Disc(fx!(0.25))], vec2(fx!(0.25), fx!(0.125)), [NONE; 2]).expect("a contact");
    assert_eq!((m.normal, m.count, m.points[0].separation), ([ONE, 0], 1, fx!(-0.5)));
    assert_eq!(features(&m), [feature([1, 2], [0, 0])]);
    // Beside a corner, from there.
    let m = manifold([square(), Recipe::Disc(fx!(0.25))], vec2(fx!(0.625), fx!(0.625)), [NONE; 2]).expect("a contact");
    assert_eq!((m.normal, features(&m)), ([759_250_125; 2], vec![feature([2, 2], [0, 0])]));
}

#[test]
fn capsules_on_one_line_meet_at_their_ends() {
    let capsule = Recipe::Capsule(fx!(2), fx!(0.5));
    let mut random = SplitMix::seeded(62);
    for _ in 0..cases() / 10 {
        let angle = Turn::from_bits(random.next());
        let along = Vec2::new(fx!(3.01), Fx::from_bits(random.between(-2, 3)));
        let offset = angle.rotate(along).and_then(|v| v.try_map(FxWide::to_scalar)).expect("small");
        let m = manifold([capsule.clone(), capsule.clone()], offset, [angle; 2]).expect("a contact");
        assert_eq!((m.count, features(&m)), (1, vec![feature([1, 1], [0, 0])]));
        assert!((m.points[0].separation - fx!(0.01)).abs() <= Fx::from_bits(4), "{:?}", m.points[0]);
    }
}

#[test]
fn sharp_segments_on_one_line_meet_at_their_ends() {
    let segment = Recipe::Segment([vec2(fx!(-1), fx!(0)), vec2(fx!(1), fx!(0))]);
    for quarter in 0..4 {
        let angle = Turn::from_bits(quarter << 62);
        for (recipe, length) in [(segment.clone(), fx!(1)), (Recipe::Disc(fx!(0.5)), fx!(0.5))] {
            let along = vec2(fx!(1.01) + length, fx!(0));
            let offset = angle.rotate(along).and_then(|v| v.try_map(FxWide::to_scalar)).expect("small");
            let m = manifold([segment.clone(), recipe], offset, [angle; 2]).expect("a contact");
            assert_eq!((m.count, features(&m)), (1, vec![feature([1, 1], [0, 0])]));
            assert_eq!(m.points[0].separation, fx!(1.01) - fx!(1));
        }
    }
}

/// A floor whose upper edge has a corner in the middle, by ulps above the line between its ends: its shape, and its centre.
fn bent_floor(sticks_out: i64) -> (Recipe, Vec2) {
    let up = |x: i32, y: Fx| Vec2::new(Fx::from_int(x), y);
    let corners =
        vec![up(-2, fx!(-1)), up(2, fx!(-1)), up(2, fx!(0)), up(0, Fx::from_bits(sticks_out)), up(-2, fx!(0))];
    let floor = Recipe::Polygon(corners);
    let shift = floor.shape().expect("a floor").shift();
    (floor, shift)
}

/// Height of the floor's surface above its ends.
fn surface(sticks_out: i64, x: Fx) -> Fx {
    let from_end = (2i128 << 32) - i128::from(x.to_bits().abs());
    Fx::from_bits(((i128::from(sticks_out) * from_end) >> 33) as i64)
}

#[test]
fn a_corner_that_hardly_is_one_does_not_split_a_floor() {
    let mut random = SplitMix::seeded(63);
    for i in 0..cases() {
        // To 60 µm.
        let sticks_out = 1 << random.between(0, 18);
        let (floor, shift) = bent_floor(sticks_out);
        let slope = sticks_out as f64 / 2f64.powi(33);
        let tilt = Turn::from_bits((slope / std::f64::consts::TAU * 2f64.powi(64)) as u64);
        let sunk = Fx::from_bits(random.between(-1 << 22, 1 << 22));
        // A box flat on the left half, or a disc on either.
        let (recipe, angle, x, count) = if i % 2 == 0 {
            (square(), tilt, random.between(-5 << 30, -9 << 28), 2)
        } else {
            (Recipe::Disc(fx!(0.5)), NONE, random.between(-1 << 31, 1 << 31), 1)
        };
        let x = Fx::from_bits(x);
        // The whole of it turned, so that corners and normals round.
        let world = Turn::from_bits(random.next());
        let turned = |v: Vec2| world.rotate(v).and_then(|v| v.try_map(FxWide::to_scalar)).expect("small");
        let case = Case {
            recipes: [floor, recipe],
            positions: [turned(shift), turned(Vec2::new(x, surface(sticks_out, x) + fx!(0.5) + sunk))],
            angles: [world, Turn::from_bits(world.to_bits().wrapping_add(angle.to_bits()))],
            margin: fx!(0.02),
        };
        let m = case.manifold().unwrap_or_else(|| panic!("a contact: {case:?}"));
        assert_eq!(m.count, count, "{case:?} {m:?}");
        for point in &m.points[..count] {
            let error = point.separation - sunk;
            assert!(error.abs() < Fx::from_bits(64), "{case:?} {m:?}");
        }
        let (sin, cos) = world.sin_cos();
        let right = [-sin, cos].map(|part| (part.to_bits() >> 2) as i32);
        assert!((0..2).all(|i| (m.normal[i] - right[i]).abs() < ONE >> 12), "{case:?} {m:?}");
    }
}

/// Stones of an arch, each with the next: they share a face, and lean from the middle alike.
#[test]
fn stones_of_an_arch_share_two_points_on_each_face() {
    for count in [5i64, 15, 25] {
        let half = Fx::PI.checked_mul(Fx::from_ratio(1, 2 * count)).expect("small");
        let (sin, cos) = half.sin_cos();
        let corner = |radius: i32, side: i32| Vec2::new(sin * Fx::from_int(side * radius), cos * Fx::from_int(radius));
        let stone = Recipe::Polygon(vec![corner(5, -1), corner(5, 1), corner(6, 1), corner(6, -1)]);
        let middle = stone.shape().expect("a stone").shift();
        let place = |i: i64| {
            let turn = Turn::from_bits((i as i128 * (1i128 << 63) / i128::from(count)) as u64);
            (turn.rotate(middle).and_then(|v| v.try_map(FxWide::to_scalar)).expect("small"), turn)
        };
        for i in -(count / 2)..count / 2 {
            let ((p, a), (q, b)) = (place(i), place(i + 1));
            let recipes = [stone.clone(), stone.clone()];
            let case = Case { recipes, positions: [p, q], angles: [a, b], margin: fx!(0.02) };
            let m = case.manifold().expect("a contact");
            assert_eq!(m.count, 2, "{i} of {count}");
            let ends = m.points.map(|p| (p.arm_a + case.positions[0]).length());
            for (end, radius) in ends.into_iter().zip([fx!(6), fx!(5)]) {
                assert!((end - radius).abs() < Fx::from_bits(32), "{end}");
            }
            assert!(m.points.iter().all(|p| p.separation.abs() < Fx::from_bits(32)), "{m:?}");
            crate::collide::fairness::check(&mut SplitMix::seeded(64), &case);
        }
    }
}
