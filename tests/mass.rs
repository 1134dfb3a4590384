//! Areas, centroids and moments of inertia against their exact values.

#[path = "support/random.rs"]
mod random;
#[path = "support/real.rs"]
mod real;

use random::SplitMix;
use real::{Real, TAU, exact, factor, ratio, real, to_f64};
use umbra_physics::{
    BodyDef, BodyKind, ColliderDef, Dimension, Error, Fx, Geometry, Mass, Part, Quantity, Shape, Vec2, World, WorldDef,
    fx, vec2,
};

/// log2 of the relative error.
fn bits_off(value: &Real, right: &Real) -> f64 {
    to_f64(&((value - right) / right)).abs().log2()
}

/// Promised relative errors: 2^-61 of an area, 2^-58 of a moment of inertia per mass.
const AREA: f64 = -61.0;
const GYRATION: f64 = -58.0;

/// The largest errors seen, log2 of them.
struct Worst {
    name: &'static str,
    area: f64,
    gyration: f64,
}

impl Worst {
    fn new(name: &'static str) -> Self {
        Self { name, area: f64::NEG_INFINITY, gyration: f64::NEG_INFINITY }
    }

    fn look(&mut self, shape: &Shape, area: &Real, gyration: &Real) {
        let area_off = bits_off(&factor(shape.measure()), area);
        let gyration_off = bits_off(&factor(shape.gyration()), gyration);
        assert!(area_off <= AREA, "{}: area off by 2^{area_off} in {shape:?}", self.name);
        assert!(gyration_off <= GYRATION, "{}: inertia off by 2^{gyration_off} in {shape:?}", self.name);
        self.area = self.area.max(area_off);
        self.gyration = self.gyration.max(gyration_off);
    }
}

impl Drop for Worst {
    fn drop(&mut self) {
        println!("{}: area within 2^{:.1}, inertia within 2^{:.1}", self.name, self.area, self.gyration);
    }
}

fn cases() -> usize {
    crate::seeds::times(2_000)
}

fn pi() -> Real {
    &*TAU / real(2)
}

/// A length between 2^-7 and 2^12 m, uniform in its exponent.
fn size(random: &mut SplitMix) -> Fx {
    let exponent = random.between(25, 44);
    Fx::from_bits(random.between(1 << exponent, 1 << (exponent + 1)))
}

#[test]
fn a_circle_has_half_its_squared_radius() {
    let (mut random, mut worst) = (SplitMix::seeded(1), Worst::new("circle"));
    for _ in 0..cases() {
        let radius = size(&mut random);
        let square = exact(radius) * exact(radius);
        worst.look(&Shape::circle(radius).expect("a fair size"), &(pi() * &square), &(square / real(2)));
    }
}

#[test]
fn a_rectangle_has_a_twelfth_of_its_squared_diagonal() {
    let (mut random, mut worst) = (SplitMix::seeded(2), Worst::new("rectangle"));
    for _ in 0..cases() {
        let (width, height) = (size(&mut random), size(&mut random));
        let (w, h) = (exact(width), exact(height));
        let shape = Shape::rectangle(width, height).expect("fair sizes");
        worst.look(&shape, &(&w * &h), &((&w * &w + &h * &h) / real(12)));
    }
}

#[test]
fn a_capsule_is_a_rectangle_and_two_half_discs() {
    let (mut random, mut worst) = (SplitMix::seeded(3), Worst::new("capsule"));
    for _ in 0..cases() {
        let (length, radius) = (size(&mut random), size(&mut random));
        let (l, r) = (exact(length), exact(radius));
        let (bar, disc) = (real(2) * &l * &r, pi() * &r * &r);
        let bar_inertia = &bar * (&l * &l + real(4) * &r * &r) / real(12);
        // A half disc about its own centroid, which is 4r/3π from the diameter, then moved out by l/2.
        let centroid = real(4) * &r / (real(3) * pi());
        let half_inertia = &r * &r / real(2) - &centroid * &centroid;
        let out = &l / real(2) + &centroid;
        let disc_inertia = &disc * (half_inertia + &out * &out);
        let area = &bar + &disc;
        let shape = Shape::capsule(length, radius).expect("fair sizes");
        worst.look(&shape, &area, &((bar_inertia + disc_inertia) / &area));
    }
}

#[test]
fn a_segment_has_a_twelfth_of_its_squared_length() {
    let (mut random, mut worst) = (SplitMix::seeded(4), Worst::new("segment"));
    for _ in 0..cases() {
        let mut coordinate = || Fx::from_bits(random.of_bits(44));
        let (a, b) = (Vec2::new(coordinate(), coordinate()), Vec2::new(coordinate(), coordinate()));
        let Ok(shape) = Shape::segment(a, b) else { continue };
        let (x, y) = (exact(a.x) - exact(b.x), exact(a.y) - exact(b.y));
        let square = x.clone() * x + y.clone() * y;
        worst.look(&shape, &square.sqrt(), &(square / real(12)));
    }
}

/// Area, centroid and second moment about it per area, by triangles from the first corner.
fn polygon(corners: &[Vec2]) -> (Real, [Real; 2], Real) {
    let points: Vec<[Real; 2]> = corners.iter().map(|c| [exact(c.x), exact(c.y)]).collect();
    let origin = &points[0];
    let (mut area, mut first, mut second) = (real(0), [real(0), real(0)], real(0));
    for pair in points[1..].windows(2) {
        let [p, q] = [0, 1].map(|i| [&pair[i][0] - &origin[0], &pair[i][1] - &origin[1]]);
        let triangle = (&p[0] * &q[1] - &p[1] * &q[0]) / real(2);
        for axis in [0, 1] {
            first[axis] += &triangle * (&p[axis] + &q[axis]) / real(3);
            second += &triangle * (&p[axis] * &p[axis] + &p[axis] * &q[axis] + &q[axis] * &q[axis]) / real(6);
        }
        area += triangle;
    }
    let from_origin = first.map(|f| f / &area);
    let about_centroid = second / &area - &from_origin[0] * &from_origin[0] - &from_origin[1] * &from_origin[1];
    let [x, y] = from_origin;
    (if area < real(0) { -area } else { area }, [x + &origin[0], y + &origin[1]], about_centroid)
}

/// A convex polygon of up to `most` corners about a random place: points on an ellipse.
fn random_polygon(random: &mut SplitMix, max_corners: i64) -> Vec<Vec2> {
    let (width, height) = (size(random), size(random));
    let half = |s: Fx| s.to_bits() as f64 / 2.0 / 1.5;
    let centre = [random.between(-1 << 42, 1 << 42), random.between(-1 << 42, 1 << 42)];
    let mut angles: Vec<f64> = (0..random.between(3, max_corners + 1))
        .map(|_| random.next() as f64 / 2f64.powi(64) * core::f64::consts::TAU)
        .collect();
    angles.sort_by(f64::total_cmp);
    let place = |angle: &f64| {
        let (sin, cos) = angle.sin_cos();
        vec2(
            Fx::from_bits(centre[0] + (half(width) * cos) as i64),
            Fx::from_bits(centre[1] + (half(height) * sin) as i64),
        )
    };
    angles.iter().map(place).collect()
}

#[test]
fn a_polygon_has_the_moments_of_its_triangles() {
    let (mut random, mut worst) = (SplitMix::seeded(5), Worst::new("polygon"));
    let (mut count, mut shifted) = (0, 0.0f64);
    for _ in 0..cases() {
        let corners = random_polygon(&mut random, 12);
        let Ok(shape) = Shape::polygon(&corners) else { continue };
        count += 1;
        let (area, centroid, gyration) = polygon(&corners);
        for (shift, right) in [shape.shift().x, shape.shift().y].into_iter().zip(&centroid) {
            let off = to_f64(&((exact(shift) - right) << 32)).abs();
            assert!(off <= 0.5, "the centroid is {off} ulps off in {corners:?}");
            shifted = shifted.max(off);
        }
        worst.look(&shape, &area, &gyration);
    }
    assert!(count > cases() / 2, "{count} were convex");
    println!("{count} polygons, the centroid within {shifted:.3} ulps");
}

/// The angle between the ways from `a` to `b` and from there to `c`, to 2^-100: halved until its tangent is small.
fn turning([a, b, c]: [&[Real; 2]; 3]) -> Real {
    let (x1, y1, x2, y2) = (&b[0] - &a[0], &b[1] - &a[1], &c[0] - &b[0], &c[1] - &b[1]);
    let (mut sine, mut cosine) = (&x1 * &y2 - &y1 * &x2, &x1 * &x2 + &y1 * &y2);
    for _ in 0..8 {
        let length = (&sine * &sine + &cosine * &cosine).sqrt();
        (sine, cosine) = (&sine / &length, &cosine / &length + real(1));
    }
    let tangent = &sine / &cosine;
    let square = &tangent * &tangent;
    // Below 2^-6: 12 terms reach beyond 2^-140.
    let series = (0..12).rev().fold(real(0), |sum, k| ratio(1, 2 * k + 1) - &square * sum);
    tangent * series * real(256)
}

/// Area, centroid and second moment about it per area: of the polygon, of a strip along each edge and of a sector at each corner.
fn rounded(corners: &[Vec2], radius: Fx) -> (Real, [Real; 2], Real) {
    let r = exact(radius);
    let points: Vec<[Real; 2]> = corners.iter().map(|c| [exact(c.x), exact(c.y)]).collect();
    let count = points.len();
    let normal = |i: usize| {
        let (a, b) = (&points[i % count], &points[(i + 1) % count]);
        let (x, y) = (&b[0] - &a[0], &b[1] - &a[1]);
        let length = (&x * &x + &y * &y).sqrt();
        ([&y / &length, -&x / &length], length)
    };
    // Areas, centroids, and second moments about these per area.
    let mut parts = vec![polygon(corners)];
    for i in 0..count {
        let (a, b) = (&points[i], &points[(i + 1) % count]);
        let (n, length) = normal(i);
        let centre = [0, 1].map(|k| (&a[k] + &b[k] + &n[k] * &r) / real(2));
        parts.push((&length * &r, centre, (&length * &length + &r * &r) / real(12)));
        let ([mx, my], _) = normal(i + count - 1);
        let turn = turning([&points[(i + count - 1) % count], a, b]);
        let (sum, difference) = ([&mx + &n[0], &my + &n[1]], [&n[0] - &mx, &n[1] - &my]);
        let [long, chord] = [sum, difference.clone()].map(|[x, y]| (&x * &x + &y * &y).sqrt());
        // 4r·sin(θ/2)/3θ along the middle direction, which is square to the chord.
        let out = real(2) * &r * &chord / (real(3) * &turn);
        let middle = [(&mx + &n[0]) / &long, (&my + &n[1]) / &long];
        let centre = [0, 1].map(|k| &a[k] + &middle[k] * &out);
        parts.push((&turn * &r * &r / real(2), centre, &r * &r / real(2) - &out * &out));
    }
    let area = parts.iter().fold(real(0), |sum, part| sum + &part.0);
    let centre = [0, 1].map(|k| parts.iter().fold(real(0), |sum, part| sum + &part.0 * &part.1[k]) / &area);
    let moment = parts.iter().fold(real(0), |sum, (area, at, inertia)| {
        let [x, y] = [&at[0] - &centre[0], &at[1] - &centre[1]];
        sum + area * (inertia + &x * &x + &y * &y)
    });
    (area.clone(), centre, moment / area)
}

#[test]
fn a_rounded_polygon_has_the_moments_of_its_strips_and_sectors() {
    let mut random = SplitMix::seeded(8);
    let (mut count, mut shifted, mut area_off, mut inertia_off) = (0, 0.0f64, f64::NEG_INFINITY, f64::NEG_INFINITY);
    for _ in 0..cases() / 10 {
        let (corners, radius) = (random_polygon(&mut random, 9), size(&mut random));
        let Ok(shape) = Shape::rounded_polygon(&corners, radius) else { continue };
        count += 1;
        let (area, centroid, gyration) = rounded(&corners, radius);
        for (shift, right) in [shape.shift().x, shape.shift().y].into_iter().zip(&centroid) {
            shifted = shifted.max(to_f64(&((exact(shift) - right) << 32)).abs());
        }
        area_off = area_off.max(bits_off(&factor(shape.measure()), &area));
        // Beside two square ulps, 2^-63 m².
        let off = to_f64(&(factor(shape.gyration()) - &gyration)).abs() - 2f64.powi(-63);
        inertia_off = inertia_off.max((off.max(0.0) / to_f64(&gyration)).log2());
    }
    assert!(count > cases() / 20, "{count} were convex");
    println!("{count} rounded: centre within {shifted:.3} ulps, area 2^{area_off:.1}, inertia 2^{inertia_off:.1}");
    assert!(shifted <= 1.1 && area_off <= AREA && inertia_off <= GYRATION);
}

#[test]
fn a_rounded_polygon_does_not_depend_on_its_first_corner_or_winding_or_image() {
    let mut random = SplitMix::seeded(9);
    let mut count = 0;
    for _ in 0..cases() / 20 {
        let (mut corners, radius) = (random_polygon(&mut random, 9), size(&mut random));
        let Ok(shape) = Shape::rounded_polygon(&corners, radius) else { continue };
        count += 1;
        let measure_of = |shape: &Shape| (shape.measure(), shape.gyration());
        for _ in 0..2 {
            for _ in 0..corners.len() {
                corners.rotate_left(1);
                let turned_shape = Shape::rounded_polygon(&corners, radius).expect("as convex as before");
                assert_eq!(
                    (turned_shape.shift(), measure_of(&turned_shape)),
                    (shape.shift(), measure_of(&shape)),
                    "{corners:?}"
                );
            }
            corners.reverse();
        }
        let images: [fn(Vec2) -> Vec2; 2] = [|c| Vec2::new(-c.x, c.y), |c| Vec2::new(-c.y, c.x)];
        for image in images {
            let turned: Vec<Vec2> = corners.iter().map(|&c| image(c)).collect();
            let turned_shape = Shape::rounded_polygon(&turned, radius).expect("as convex as before");
            assert_eq!(
                (turned_shape.shift(), measure_of(&turned_shape)),
                (image(shape.shift()), measure_of(&shape)),
                "{corners:?}"
            );
        }
    }
    assert!(count > cases() / 40, "{count} were convex");
}

#[test]
fn a_rounded_polygon_needs_a_radius_and_a_polygon() {
    let square = [vec2(-1, -1), vec2(1, -1), vec2(1, 1), vec2(-1, 1)];
    for radius in [fx!(0), fx!(-1), fx!(4097)] {
        let quantity = Quantity::Size { dimension: Dimension::Rounding, value: radius };
        assert_eq!(Shape::rounded_polygon(&square, radius), Err(Error::OutOfRange { quantity }));
    }
    assert!(Shape::rounded_polygon(&square[..2], fx!(1)).is_err());
    assert!(Shape::rounded_polygon(&[square[0], square[2], square[1], square[3]], fx!(1)).is_err());
}

/// The corners of a polygon's geometry, from the least on.
fn from_the_least(shape: &Shape) -> Vec<(i64, i64)> {
    let Geometry::Polygon { corners } = shape.geometry() else { panic!("it is a polygon") };
    let mut corners: Vec<_> = corners.iter().map(|c| (c.x.to_bits(), c.y.to_bits())).collect();
    let least = (0..corners.len()).min_by_key(|&i| corners[i]).expect("there are some");
    corners.rotate_left(least);
    corners
}

#[test]
fn a_polygon_does_not_depend_on_its_first_corner_or_winding() {
    let mut random = SplitMix::seeded(6);
    let mut count = 0;
    for _ in 0..cases() / 10 {
        let mut corners = random_polygon(&mut random, 9);
        let Ok(shape) = Shape::polygon(&corners) else { continue };
        count += 1;
        for _ in 0..2 {
            for _ in 0..corners.len() {
                corners.rotate_left(1);
                let turned_shape = Shape::polygon(&corners).expect("as convex as before");
                assert_eq!(turned_shape.shift(), shape.shift(), "{corners:?}");
                assert_eq!(turned_shape.measure(), shape.measure(), "{corners:?}");
                assert_eq!(turned_shape.gyration(), shape.gyration(), "{corners:?}");
                assert_eq!(from_the_least(&turned_shape), from_the_least(&shape), "{corners:?}");
            }
            corners.reverse();
        }
    }
    assert!(count > cases() / 20, "{count} were convex");
}

#[test]
fn a_compound_follows_the_parallel_axis_theorem() {
    let (mut random, mut worst) = (SplitMix::seeded(7), Worst::new("compound"));
    for _ in 0..cases() / 4 {
        let parts: Vec<Part> = (0..random.between(1, 6))
            .map(|_| {
                let shape = match random.between(0, 3) {
                    0 => Shape::circle(size(&mut random)),
                    1 => Shape::rectangle(size(&mut random), size(&mut random)),
                    _ => Shape::capsule(size(&mut random), size(&mut random)),
                };
                Part {
                    shape: shape.expect("fair sizes"),
                    position: Vec2::new(Fx::from_bits(random.of_bits(43)), Fx::from_bits(random.of_bits(43))),
                    angle: Fx::from_bits(random.of_bits(35)),
                    density: Fx::from_bits(random.of_bits(45).abs() + 1),
                }
            })
            .collect();
        let shape = Shape::compound(&parts).expect("fair parts");
        let weight = |p: &Part| exact(p.density) * factor(p.shape.measure());
        let total = parts.iter().fold(real(0), |sum, p| sum + weight(p));
        let mean =
            |pick: fn(&Part) -> Fx| parts.iter().fold(real(0), |sum, p| sum + weight(p) * exact(pick(p))) / &total;
        let centre = [mean(|p| p.position.x), mean(|p| p.position.y)];
        for (shift, right) in [shape.shift().x, shape.shift().y].into_iter().zip(&centre) {
            let off = to_f64(&((exact(shift) - right) << 32)).abs();
            assert!(off <= 0.51, "the centre is {off} ulps off in {parts:?}");
        }
        let inertia = parts.iter().fold(real(0), |sum, p| {
            let (x, y) = (exact(p.position.x) - &centre[0], exact(p.position.y) - &centre[1]);
            sum + weight(p) * (factor(p.shape.gyration()) + &x * &x + &y * &y)
        });
        worst.look(&shape, &total, &(inertia / &total));
    }
}

#[test]
fn two_halves_make_a_whole() {
    let whole = Shape::rectangle(fx!(3), fx!(2)).expect("fair sizes");
    let half = Shape::rectangle(fx!(1.5), fx!(2)).expect("fair sizes");
    let at = |x: Fx| Part { shape: half.clone(), position: vec2(x, fx!(5)), angle: fx!(0), density: fx!(1) };
    let joined = Shape::compound(&[at(fx!(6.25)), at(fx!(7.75))]).expect("fair parts");
    assert_eq!(joined.shift(), vec2(7, 5));
    assert!(bits_off(&factor(joined.measure()), &factor(whole.measure())) <= AREA);
    assert!(bits_off(&factor(joined.gyration()), &factor(whole.gyration())) <= GYRATION);
}

#[test]
fn a_body_has_mass_and_inertia_of_its_collider() {
    let mut world = World::new(WorldDef::default()).expect("a fair definition");
    let mut random = SplitMix::seeded(8);
    let mut count = 0;
    for _ in 0..cases() / 10 {
        let shape = Shape::capsule(size(&mut random), size(&mut random)).expect("fair sizes");
        let density = Fx::from_bits(random.of_bits(40).abs() + 1);
        let def = BodyDef::dynamic().with_collider(ColliderDef { density, ..ColliderDef::ghost(shape.clone()) });
        let Ok(body) = world.add_body(def) else { continue };
        count += 1;
        let body = world.body(body).expect("it is there");
        let mass = exact(density) * factor(shape.measure());
        let off = to_f64(&((exact(body.mass().expect("it is dynamic")) - &mass) << 32)).abs();
        assert!(off <= 0.51 + to_f64(&mass) * 2f64.powi(32 - 61), "{off} ulps");
        // The inertia goes with the mass it has, and the inverses with both.
        let mass = exact(body.mass().expect("it is dynamic"));
        let inertia = mass.clone() * factor(shape.gyration());
        assert!(bits_off(&factor(body.inertia().expect("it turns")), &inertia) <= GYRATION);
        assert!(bits_off(&factor(body.inverse_inertia()), &(real(1) / inertia)) <= GYRATION);
        assert!(bits_off(&factor(body.inverse_mass()), &(real(1) / mass)) <= -64.0);
    }
    assert!(count > cases() / 40, "{count} had a mass within the limits");
}

#[test]
fn a_disc_of_a_centimetre_and_one_of_a_kilometre_keep_their_inertia() {
    // 3 ulps of kg·m², and 8.8e12 kg·m²: neither fits in the public format.
    for (radius, mass) in [(fx!(0.0078125), fx!(0.0000152587890625)), (fx!(1000), fx!(16000000))] {
        let mut world = World::new(WorldDef::default()).expect("a fair definition");
        let disc = ColliderDef::ghost(Shape::circle(radius).expect("a fair size"));
        let def = BodyDef { mass: Mass::Kilograms(mass), ..BodyDef::dynamic().with_collider(disc) };
        let body = world.add_body(def).expect("a fair body");
        let inertia = factor(world.body(body).expect("it is there").inertia().expect("it turns"));
        let right = ratio(1, 2) * exact(mass) * exact(radius) * exact(radius);
        assert!(bits_off(&inertia, &right) <= GYRATION, "{radius} m");
    }
}

#[test]
fn a_length_has_all_its_bits_however_short_it_is() {
    let mut random = SplitMix::seeded(9);
    for _ in 0..cases() {
        let v = vec2(Fx::from_bits(random.of_bits(63)), Fx::from_bits(random.of_bits(63)));
        let (x, y) = (exact(v.x), exact(v.y));
        let right = (&x * &x + &y * &y).sqrt();
        if right != real(0) {
            // Beyond 2^31 m a bit is lost.
            let off = bits_off(&factor(v.wide_length()), &right);
            assert!(off <= -62.0, "2^{off} in {v}");
        }
    }
}

#[test]
fn only_a_dynamic_body_has_a_mass_and_an_inertia() {
    let mut world = World::new(WorldDef::default()).expect("a world");
    let mass = Mass::Explicit { mass: fx!(2), inertia: fx!(3) };
    for def in [BodyDef::fixed(), BodyDef::kinematic()] {
        let body = world.add_body(BodyDef { mass, ..def }).expect("a body");
        let look = world.body(body).expect("it is there");
        assert_eq!((look.mass(), look.inertia(), look.mass_def()), (None, None, mass));
        world.set_kind(body, BodyKind::Dynamic).expect("a mass");
        let look = world.body(body).expect("it is there");
        assert_eq!((look.mass(), look.inertia()), (Some(fx!(2)), Some(fx!(3).into())));
    }
}
