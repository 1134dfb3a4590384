//! Mirror images and quarter turns.

use alloc::vec::Vec;

use super::cases::{case, cases};
use crate::cases::run_seed;
use crate::math::{Random, Vec2};
use crate::query::core::in_fx;
use crate::query::ray::first_hit;
use crate::query::{Core, Point, Sum, at, contains, distance, nearest, normal, point, ray_hit};

/// The image of a vector; `swap` takes each axis to the other one.
fn image([x, y]: Point, signs: [i64; 2], swap: bool) -> Point {
    let [x, y] = if swap { [y, x] } else { [x, y] };
    [x * signs[0], y * signs[1]]
}

/// The images of a core, its corners in counter-clockwise order, from another one on.
fn core_image(core: &Core, signs: [i64; 2], swap: bool, first: usize) -> Core {
    let mut corners: Vec<Point> = core.corners().iter().map(|&corner| image(corner, signs, swap)).collect();
    if (signs[0] * signs[1] < 0) != swap {
        corners.reverse();
    }
    let count = corners.len();
    corners.rotate_left(first % count);
    let mut rotated = Core::default();
    rotated.radius = core.radius;
    corners.into_iter().for_each(|corner| rotated.push(corner));
    rotated
}

fn unit_image(v: Vec2, signs: [i64; 2], swap: bool) -> Vec2 {
    in_fx(image([v.x.to_bits(), v.y.to_bits()], signs, swap))
}

#[test]
fn images_of_cores_and_rays_have_the_images_of_all_results() {
    let mut random = Random::seeded(run_seed(6));
    let mut hits = 0;
    for i in 0..cases() {
        let case = case(&mut random);
        let bits = random.bits();
        let (signs, swap, first) =
            ([1, -1].map(|s| if bits & 1 == 0 { 1 } else { s }), bits & 2 == 0, (bits >> 8) as usize % 64);
        let signs = if bits & 4 == 0 { signs } else { signs.map(|sign| -sign) };
        let image_of = |core: &Core| core_image(core, signs, swap, first);
        let [a, b] = [image_of(&case.core), image_of(&case.other)];
        let ray = image(case.ray, signs, swap);
        assert_eq!(contains(&a), contains(&case.core));
        let distances = [&case.core, &a].map(|core| {
            let closest = nearest(core.corners());
            let away = distance(core, closest);
            (away, point(core, closest, away).0)
        });
        assert_eq!(distances[1], (distances[0].0, image(distances[0].1, signs, swap)), "{i}: {case:?}");

        let sums = [Sum::new(&case.core, &case.other), Sum::new(&a, &b)];
        for [left, right] in [[&case.core, &a], [&sums[0].core, &sums[1].core]] {
            let ends = [first_hit(left, case.ray), first_hit(right, ray)];
            assert_eq!(ends[0].map(|end| end.fraction), ends[1].map(|end| end.fraction), "{i}: {case:?}");
            let [Some(end), Some(other_end)] = ends else { continue };
            hits += 1;
            let normals = [normal(left, case.ray, end), normal(right, ray, other_end)];
            assert_eq!(normals[1], unit_image(normals[0], signs, swap), "{i}: {case:?}");
            assert_eq!(at(ray, other_end.fraction), image(at(case.ray, end.fraction), signs, swap));
        }
        if let [Some(end), Some(other_end)] = [first_hit(&sums[0].core, case.ray), first_hit(&sums[1].core, ray)] {
            let normals = [normal(&sums[0].core, case.ray, end), normal(&sums[1].core, ray, other_end)];
            let touch = sums[0].touch_point([&case.core, &case.other], case.ray, end, normals[0]);
            let image_touch = sums[1].touch_point([&a, &b], ray, other_end, normals[1]);
            assert_eq!(image_touch, image(touch, signs, swap), "{i}: {case:?}");
        }
    }
    assert!(hits > cases() / 10, "{hits}");
}

#[test]
fn a_segment_of_a_chain_is_hit_from_its_right_alone() {
    let mut core = Core::default();
    [[4, 3], [-4, 3]].into_iter().for_each(|corner| core.push(corner));
    // From right to left: it touches what is above.
    assert_eq!(ray_hit(&core, true, [0, 6]), None);
    assert!(ray_hit(&core, false, [0, 6]).is_some());
    let mut core = Core::default();
    [[4, -3], [-4, -3]].into_iter().for_each(|corner| core.push(corner));
    let end = ray_hit(&core, true, [0, -6]).expect("from above");
    assert_eq!((end.fraction, normal(&core, [0, -6], end)), (1 << 61, crate::math::vec2(0, 1)));
    // A ray that starts on the segment: through it, away from it, and along it.
    let mut core = Core::default();
    [[4, 0], [-4, 0]].into_iter().for_each(|corner| core.push(corner));
    assert_eq!(ray_hit(&core, true, [0, -1]).map(|end| end.fraction), Some(0));
    assert_eq!([[0, 1], [1, 0], [0, 0]].map(|ray| ray_hit(&core, true, ray)), [None; 3]);
}
