//! Outlines of shapes against exact references, and against their mirror images and quarter turns.

#[path = "support/random.rs"]
mod random;
#[path = "support/real.rs"]
mod real;

use dashu_int::IBig;
use random::SplitMix;
use real::{Real, exact, real, to_f64};
use umbra_physics::{Aabb, Fx, Geometry, Outline, Part, Shape, Vec2, fx, vec2};

fn cases() -> usize {
    crate::seeds::times(400)
}

/// A length between 2^-7 and 2^12 m, uniform in its exponent.
fn size(random: &mut SplitMix) -> Fx {
    let exponent = random.between(25, 44);
    Fx::from_bits(random.between(1 << exponent, 1 << (exponent + 1)))
}

fn point(random: &mut SplitMix, reach: i64) -> Vec2 {
    Vec2::new(Fx::from_bits(random.between(-reach, reach)), Fx::from_bits(random.between(-reach, reach)))
}

/// A convex polygon: triangles of random points, and cut discs of up to 64 corners.
fn polygon(random: &mut SplitMix) -> Shape {
    loop {
        let exponent = random.between(27, 44);
        let reach = 1i64 << exponent;
        let corners: Vec<Vec2> = if random.between(0, 2) == 0 {
            (0..3).map(|_| point(random, reach)).collect()
        } else {
            let (count, radius) = (random.between(3, 65), Fx::from_bits(reach));
            let on_circle = |i: i64| {
                let (sin, cos) = (Fx::TAU.checked_mul(Fx::from_ratio(i, count)).expect("at most a turn")).sin_cos();
                vec2(cos, sin).checked_scale(radius).expect("within the limits")
            };
            (0..count).map(on_circle).collect()
        };
        if let Ok(shape) = Shape::polygon(&corners) {
            return shape;
        }
    }
}

/// Returns true if `normal` is (dy, −dx) / length of the edge from `a` to `b`, within 0.501 ulp. Squares of integers: exact.
fn is_normal(normal: Vec2, a: Vec2, b: Vec2) -> bool {
    let bits = |value: Fx| IBig::from(value.to_bits());
    let (dx, dy) = (bits(b.x) - bits(a.x), bits(b.y) - bits(a.y));
    let square = &dx * &dx + &dy * &dy;
    [(normal.x, dy), (normal.y, -dx)].into_iter().all(|(part, right)| {
        let (part, right): (IBig, IBig) = (bits(part) * 1000, right << 32);
        // From here on both magnitudes: their signs are the same, or the part is zero.
        let same_side = part == IBig::ZERO || (part < IBig::ZERO) == (right < IBig::ZERO);
        let (part, right) = (if part < IBig::ZERO { -part } else { part }, right * 1000);
        let (low, high) = (&part - 501, &part + 501);
        let right = &right * &right;
        same_side && (low < IBig::ZERO || &low * &low * &square <= right) && right <= &high * &high * &square
    })
}

fn edges(outline: &Outline) -> impl Iterator<Item = (Vec2, Vec2, Vec2)> {
    let corners = outline.corners();
    let next = move |i: usize| corners[(i + 1) % corners.len()];
    outline.normals().iter().enumerate().map(move |(i, &normal)| (normal, corners[i], next(i)))
}

/// The least box around an outline, found corner by corner.
fn box_of(outline: &Outline) -> Aabb {
    let all = |pick: fn(&Vec2) -> Fx| outline.corners().iter().map(pick).collect::<Vec<_>>();
    let (xs, ys, r) = (all(|c| c.x), all(|c| c.y), outline.radius());
    let least = |values: &[Fx]| *values.iter().min().expect("a corner") - r;
    let greatest = |values: &[Fx]| *values.iter().max().expect("a corner") + r;
    Aabb { min: vec2(least(&xs), least(&ys)), max: vec2(greatest(&xs), greatest(&ys)) }
}

fn only(shape: &Shape) -> &Outline {
    let [outline] = shape.outlines() else { panic!("{} outlines", shape.outlines().len()) };
    assert_eq!((outline.bounds(), shape.bounds()), (box_of(outline), box_of(outline)));
    outline
}

/// Returns true if two values are halves of `size` to each side of zero: the same to the bit, and half an ulp off at most.
fn are_halves(low: Fx, high: Fx, size: Fx) -> bool {
    low == -high && (2 * high.to_bits() - size.to_bits()).abs() <= 1
}

#[test]
fn discs_are_points_and_capsules_lines_with_a_radius() {
    let mut random = SplitMix::seeded(1);
    for _ in 0..cases() {
        let (length, radius) = (size(&mut random), size(&mut random));
        let shape = Shape::circle(radius).expect("a fair size");
        let disc = only(&shape);
        assert_eq!((disc.corners(), disc.normals(), disc.radius()), (&[Vec2::ZERO][..], &[][..], radius));
        let shape = Shape::capsule(length, radius).expect("fair sizes");
        let capsule = only(&shape);
        let [a, b] = capsule.corners() else { panic!("two ends") };
        assert!(are_halves(a.x, b.x, length) && (a.y, b.y) == (fx!(0), fx!(0)), "{capsule:?}");
        assert_eq!((capsule.normals(), capsule.radius()), (&[vec2(0, -1), vec2(0, 1)][..], radius));
    }
}

#[test]
fn rectangles_have_their_corners_and_the_axes_as_normals() {
    let mut random = SplitMix::seeded(2);
    for _ in 0..cases() {
        let (width, height) = (size(&mut random), size(&mut random));
        let shape = Shape::rectangle(width, height).expect("fair sizes");
        let outline = only(&shape);
        let [a, b, c, d] = outline.corners() else { panic!("four corners") };
        assert!(are_halves(a.x, c.x, width) && are_halves(a.y, c.y, height), "{outline:?}");
        assert_eq!((*b, *d), (vec2(c.x, a.y), vec2(a.x, c.y)));
        assert_eq!(outline.normals(), [vec2(0, -1), vec2(1, 0), vec2(0, 1), vec2(-1, 0)]);
        assert_eq!(outline.radius(), fx!(0));
    }
}

#[test]
fn polygons_and_segments_keep_their_corners_and_have_exact_normals() {
    let mut random = SplitMix::seeded(3);
    for _ in 0..cases() {
        let shape = polygon(&mut random);
        let Geometry::Polygon { corners } = shape.geometry() else { panic!("a polygon") };
        let outline = only(&shape);
        assert_eq!((outline.corners(), outline.radius()), (&corners[..], fx!(0)));
        assert_eq!(outline.normals().len(), corners.len());
        for (normal, a, b) in edges(outline) {
            assert!(is_normal(normal, a, b), "{normal} from {a} to {b}");
            // A component of the normal is up to 0.501 ulp off, so that a product is off by as much times the offset.
            let allowed = |d: Vec2| Fx::from_bits(((d.x.to_bits().abs() + d.y.to_bits().abs()) >> 32) + 1);
            let away = |d: Vec2| d.wide_dot(normal).expect("small").to_scalar().expect("small");
            let outside = |p: Vec2| away(p - a) > allowed(p - a);
            assert!(!corners.iter().any(|&corner| outside(corner)), "{normal} points inwards");
        }
        let reach = 1 << random.between(28, 43);
        let (a, b) = (point(&mut random, reach), point(&mut random, reach));
        let Ok(shape) = Shape::segment(a, b) else { continue };
        let outline = only(&shape);
        let Geometry::Segment { ends } = shape.geometry() else { panic!("a segment") };
        assert_eq!((outline.corners(), outline.normals().len()), (&ends[..], 2));
        assert!(edges(outline).all(|(normal, a, b)| is_normal(normal, a, b)), "{outline:?}");
    }
}

#[test]
fn a_normal_that_is_an_ulp_off_is_told() {
    let (a, b) = (vec2(1, 1), vec2(4, 5));
    assert!(is_normal(vec2(fx!(0.8), fx!(-0.6)), a, b));
    let ulp = Fx::DELTA;
    for off in [vec2(ulp, 0), vec2(-ulp, 0), vec2(0, ulp), vec2(0, -ulp)] {
        assert!(!is_normal(vec2(fx!(0.8), fx!(-0.6)) + off, a, b));
    }
    assert!(!is_normal(vec2(fx!(-0.8), fx!(0.6)), a, b), "inwards");
}

/// The corners and the normals of one outline, from the least corner on.
fn turned_to_the_least(outline: &Outline) -> Vec<(Vec2, Vec2)> {
    let key = |(corner, _): &(Vec2, Vec2)| (corner.x, corner.y);
    let mut all: Vec<_> = outline.corners().iter().copied().zip(outline.normals().iter().copied()).collect();
    let least = (0..all.len()).min_by_key(|&i| key(&all[i])).expect("a corner");
    all.rotate_left(least);
    all
}

#[test]
fn images_of_a_polygon_have_the_images_of_its_outline() {
    let mirror = |v: Vec2| vec2(-v.x, v.y);
    let mut random = SplitMix::seeded(4);
    for _ in 0..cases() {
        let shape = polygon(&mut random);
        let Geometry::Polygon { corners } = shape.geometry() else { panic!("a polygon") };
        let image = |map: fn(Vec2) -> Vec2| Shape::polygon(&corners.iter().map(|&c| map(c)).collect::<Vec<_>>());
        // Where the centre of mass falls between two ulps, the corners are re-centred first.
        let again = image(|c| c).expect("the same");
        let quarter = image(Vec2::perp).expect("the same, turned");
        let want: Vec<_> = edges(only(&again)).map(|(n, a, _)| (a.perp(), n.perp())).collect();
        let actual: Vec<_> = edges(only(&quarter)).map(|(n, a, _)| (a, n)).collect();
        assert_eq!(actual, want);
        let mirrored = image(mirror).expect("the same, mirrored");
        // An edge from a to b is one from the image of b to that of a.
        let mut want: Vec<_> = edges(only(&again)).map(|(n, _, b)| (mirror(b), mirror(n))).collect();
        want.reverse();
        let least = (0..want.len()).min_by_key(|&i| (want[i].0.x, want[i].0.y)).expect("a corner");
        want.rotate_left(least);
        assert_eq!(turned_to_the_least(only(&mirrored)), want);
    }
}

#[test]
fn parts_of_a_compound_are_turned_and_moved_to_their_places() {
    let mut random = SplitMix::seeded(5);
    let bound = real(51) / real(100) / real(1 << 32);
    for _ in 0..cases() / 10 {
        let definitions: Vec<Part> = (0..random.between(1, 6))
            .map(|i| {
                let shape = match i % 3 {
                    0 => Shape::capsule(size(&mut random), size(&mut random)).expect("fair sizes"),
                    1 => Shape::rectangle(size(&mut random), size(&mut random)).expect("fair sizes"),
                    _ => polygon(&mut random),
                };
                let angle = Fx::from_bits(random.between(-(1 << 36), 1 << 36));
                Part { shape, position: point(&mut random, 1 << 40), angle, density: fx!(1) }
            })
            .collect();
        let compound = Shape::compound(&definitions).expect("a fair compound");
        let Geometry::Compound { parts } = compound.geometry() else { panic!("a compound") };
        assert_eq!(compound.outlines().len(), parts.len());
        for (outline, part) in compound.outlines().iter().zip(parts.iter()) {
            let local = only(&part.shape);
            let (sin, cos): (Real, Real) = exact(part.angle).sin_cos();
            let assert_close = |actual: Vec2, local: Vec2, position: Vec2| {
                let (x, y) = (exact(local.x), exact(local.y));
                let right = [&x * &cos - &y * &sin + exact(position.x), &x * &sin + &y * &cos + exact(position.y)];
                let off = [exact(actual.x) - &right[0], exact(actual.y) - &right[1]].map(|off| to_f64(&off).abs());
                assert!(off.iter().all(|&off| off <= to_f64(&bound)), "{off:?} at {actual} from {local}");
            };
            assert_eq!(outline.radius(), local.radius());
            assert_eq!(outline.bounds(), box_of(outline));
            assert_eq!(
                (outline.corners().len(), outline.normals().len()),
                (local.corners().len(), local.normals().len())
            );
            outline
                .corners()
                .iter()
                .zip(local.corners())
                .for_each(|(&actual, &local)| assert_close(actual, local, part.position));
            outline
                .normals()
                .iter()
                .zip(local.normals())
                .for_each(|(&actual, &local)| assert_close(actual, local, Vec2::ZERO));
            let (whole, bounds) = (compound.bounds(), outline.bounds());
            assert!(whole.contains(bounds.min) && whole.contains(bounds.max), "{whole:?}, {bounds:?}");
        }
    }
}
