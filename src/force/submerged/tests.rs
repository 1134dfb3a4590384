//! Areas and moments beside those of a dense polygon in doubles, and their images to the bit.

use alloc::vec::Vec;

use super::{Submerged, submerged};
use crate::cases::run_seed;
use crate::collider::{ColliderDef, ColliderSet};
use crate::fx::{Fx, fx};
use crate::math::{Random, Vec2, vec2};
use crate::scalar::{FxWide, ToF64 as _, Turn};
use crate::shape::{Aabb, Shape};
use crate::slots::BodyId;

/// A case: a collider of a body at a place, and a box.
#[derive(Clone)]
struct Case {
    def: ColliderDef,
    position: Vec2,
    angle: Turn,
    region: Aabb,
}

impl Case {
    /// Area and first moments in units of 2^-64.
    fn found(&self) -> [i128; 3] {
        let body = BodyId::from_parts(0, 0);
        let mut colliders = ColliderSet::<Fx>::default();
        colliders.insert(body, self.def.clone());
        let part = submerged(colliders.of(body), self.position, self.angle, self.region);
        let Some(Submerged { area, moments }) = part else { return [0; 3] };
        [area, moments.x, moments.y].map(|sum| sum.total().expect("it fits").to_bits())
    }

    /// The area and moments in doubles, of an outline with arcs of this many chords a turn.
    fn dense(&self, chords: usize) -> [f64; 3] {
        let mut sums = [0.0; 3];
        let [cx, cy] = self.position.to_f64();
        let ([left, bottom], [right, top]) = (self.region.min.to_f64(), self.region.max.to_f64());
        let (sin, cos) = libm::sincos(self.angle.radians().to_f64());
        for outline in self.def.shape.outlines_at(self.def.angle, self.def.position) {
            let radius = outline.radius().to_f64();
            let corners = outline.corners().iter().map(|corner| {
                let [x, y] = corner.to_f64();
                [x * cos - y * sin, x * sin + y * cos]
            });
            let normals: Vec<f64> = outline
                .normals()
                .iter()
                .map(|normal| libm::atan2(normal.y.to_f64(), normal.x.to_f64()) + self.angle.radians().to_f64())
                .collect();
            let mut ring: Vec<[f64; 2]> = Vec::new();
            for (i, [x, y]) in corners.enumerate() {
                if radius == 0.0 {
                    ring.push([x, y]);
                    continue;
                }
                let whole = core::f64::consts::TAU;
                let (from, way) = match normals[..] {
                    [] => (0.0, whole),
                    _ => {
                        let before = normals[(i + normals.len() - 1) % normals.len()];
                        (before, (normals[i] - before).rem_euclid(whole))
                    }
                };
                ring.extend((0..=chords).map(|k| {
                    let (sin, cos) = libm::sincos(from + way * k as f64 / chords as f64);
                    [x + radius * cos, y + radius * sin]
                }));
            }
            // One side after the other (Sutherland and Hodgman).
            for (axis, line, sign) in
                [(0, left - cx, 1.0), (0, right - cx, -1.0), (1, bottom - cy, 1.0), (1, top - cy, -1.0)]
            {
                let depth = |p: &[f64; 2]| sign * (p[axis] - line);
                let mut cut = Vec::new();
                for (p, q) in ring.iter().zip(ring.iter().cycle().skip(1)) {
                    let (a, b) = (depth(p), depth(q));
                    if a >= 0.0 {
                        cut.push(*p);
                    }
                    if (a > 0.0 && b < 0.0) || (a < 0.0 && b > 0.0) {
                        let t = a / (a - b);
                        cut.push([p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])]);
                    }
                }
                ring = cut;
            }
            for (p, q) in ring.iter().zip(ring.iter().cycle().skip(1)) {
                let cross = p[0] * q[1] - p[1] * q[0];
                sums[0] += cross / 2.0;
                sums[1] += (p[0] + q[0]) * cross / 6.0;
                sums[2] += (p[1] + q[1]) * cross / 6.0;
            }
        }
        sums
    }
}

fn shapes(random: &mut Random, size: Fx) -> Vec<Shape> {
    let mut number = |min: Fx, max: Fx| random.number(min * size..=max * size);
    let corners: [Vec2; 3] = [
        vec2(number(fx!(-1), fx!(-0.5)), number(fx!(-1), fx!(0))),
        vec2(number(fx!(0.3), fx!(1)), number(fx!(-1), fx!(0))),
        vec2(number(fx!(-0.5), fx!(0.5)), number(fx!(0.3), fx!(1))),
    ];
    let shapes = [
        Shape::polygon(&corners),
        Shape::rectangle(number(fx!(0.1), fx!(2)), number(fx!(0.1), fx!(2))),
        Shape::circle(number(fx!(0.1), fx!(1))),
        Shape::capsule(number(fx!(0.1), fx!(2)), number(fx!(0.1), fx!(1))),
        Shape::rounded_polygon(&corners, number(fx!(0.1), fx!(0.5))),
    ];
    shapes.into_iter().map(|shape| shape.expect("a shape")).collect()
}

/// Cases of all shapes, with the largest radius around a core in units of the size; about half of them are cut by a side.
fn each_case(count: u32, size: Fx, mut see: impl FnMut(&Case, bool)) {
    let mut random = Random::seeded(run_seed(7));
    for _ in 0..count {
        let shapes = shapes(&mut random, size);
        let mut number = |max: Fx| random.number(-max * size..=max * size);
        let at = vec2(number(fx!(3)), number(fx!(3)));
        let offset = vec2(number(fx!(0.5)), number(fx!(0.5)));
        let [a, b] = [(); 2].map(|()| at + vec2(number(fx!(1.7)), number(fx!(1.7))));
        let region = Aabb { min: vec2(a.x.min(b.x), a.y.min(b.y)), max: vec2(a.x.max(b.x), a.y.max(b.y)) };
        let [angle, own_angle] = [(); 2].map(|()| number(fx!(1)) * fx!(3) / size);
        for (i, shape) in shapes.into_iter().enumerate() {
            let def = ColliderDef { position: offset, angle: own_angle, ..ColliderDef::new(shape) };
            see(&Case { def, position: at, angle: Turn::from_radians(angle), region }, i > 1);
        }
    }
}

#[test]
fn areas_and_moments_are_those_of_a_dense_polygon() {
    for (size, ulps) in [(fx!(1), 1.0), (fx!(0.125), 1.0), (fx!(1000), 32.0)] {
        let (mut worst, mut round, mut cut) = (0.0_f64, [0.0_f64; 2], 0);
        each_case(400, size, |case, is_round| {
            let actual = case.found().map(|bits| bits as f64 / 2.0_f64.powi(64));
            let dense = case.dense(4_096);
            let length = 8.0 * size.to_f64();
            let unit = ulps / 2.0_f64.powi(32);
            cut += u32::from(actual[0] > 0.0);
            let off = [0, 1, 2].map(|k| (actual[k] - dense[k]).abs());
            if is_round {
                let radius = case.def.shape.outlines()[0].radius().to_f64();
                let shared = unit * length + radius * radius * 3e-6;
                round[0] = round[0].max((off[0] - shared) / (radius * radius));
                round[1] = round[1]
                    .max((off[1].max(off[2]) - 4.0 * size.to_f64() * shared) / (radius * radius * size.to_f64()));
            } else {
                worst = worst.max(off[0] / (unit * length));
                worst = worst.max(off[1].max(off[2]) / (unit * length * 4.0 * size.to_f64()));
            }
        });
        assert!(cut > 1_000, "{cut}");
        assert!(worst < 1.0, "{size}: {worst} of the bound");
        assert!(round[0] < 1.0 / 1024.0 && round[1] < 1.0 / 512.0, "{size}: {round:?}");
    }
}

#[test]
fn the_image_of_an_area_is_the_same_to_the_bit() {
    let flip = |v: Vec2, turn: bool, mirror: bool| {
        let v = if turn { Vec2::new(-v.y, v.x) } else { v };
        if mirror { Vec2::new(-v.x, v.y) } else { v }
    };
    each_case(200, fx!(1), |case, _| {
        let [area, x, y] = case.found();
        for (turn, mirror) in [(false, true), (true, false), (true, true)] {
            let moved = |v: Vec2| flip(v, turn, mirror);
            let (a, b) = (moved(case.region.min), moved(case.region.max));
            let region = Aabb { min: vec2(a.x.min(b.x), a.y.min(b.y)), max: vec2(a.x.max(b.x), a.y.max(b.y)) };
            // The mirror image of a polygon is made from its image's corners: those that are their own image are enough.
            if mirror
                && matches!(
                    case.def.shape.geometry(),
                    crate::shape::Geometry::Polygon { .. } | crate::shape::Geometry::RoundedPolygon { .. }
                )
            {
                continue;
            }
            let quarter = if turn { 1u64 << 62 } else { 0 };
            let bits = crate::scalar::Angle::<Fx>::to_bits(case.angle);
            let bits = bits.wrapping_add(quarter);
            let (angle, def) = if mirror {
                let position = Vec2::new(-case.def.position.x, case.def.position.y);
                (bits.wrapping_neg(), ColliderDef { position, angle: -case.def.angle, ..case.def.clone() })
            } else {
                (bits, case.def.clone())
            };
            let image = Case { def, position: moved(case.position), angle: Turn::from_bits(angle), region };
            let expected = {
                let (x, y) = if turn { (-y, x) } else { (x, y) };
                if mirror { [area, -x, y] } else { [area, x, y] }
            };
            assert_eq!(image.found(), expected, "{turn} {mirror}");
        }
    });
}

#[test]
fn an_outline_in_the_box_has_its_whole_area_and_one_beside_it_none() {
    let everywhere = Aabb { min: vec2(-100, -100), max: vec2(100, 100) };
    let beside = Aabb { min: vec2(-100, -100), max: vec2(-7, 100) };
    let inside = Aabb { min: vec2(fx!(-0.25), fx!(-0.25)), max: vec2(fx!(0.25), fx!(0.25)) };
    let case = |shape: Shape, region| Case {
        def: ColliderDef::new(shape),
        position: vec2(0, 0),
        angle: Turn::from_radians(fx!(0)),
        region,
    };
    let square = || Shape::rectangle(2, 3).expect("a shape");
    let whole = |meters: Fx| FxWide::from_scalar(meters).to_bits();
    assert_eq!(case(square(), everywhere).found(), [whole(fx!(6)), 0, 0]);
    assert_eq!(case(square(), beside).found(), [0; 3]);
    // The box is in the outline, or shares a side with it.
    assert_eq!(case(square(), inside).found(), [whole(fx!(0.25)), 0, 0]);
    let side = Aabb { min: vec2(0, fx!(-1.5)), max: vec2(1, fx!(1.5)) };
    assert_eq!(case(square(), side).found(), [whole(fx!(3)), whole(fx!(1.5)), 0]);
    let touching = Aabb { min: vec2(1, -5), max: vec2(5, 5) };
    assert_eq!(case(square(), touching).found(), [0; 3]);
    let disc = case(Shape::circle(fx!(1)).expect("a shape"), everywhere).found();
    let area = disc[0] as f64 / 2.0_f64.powi(64);
    assert!((area - core::f64::consts::PI).abs() < 1e-8 && disc[1..] == [0, 0], "{disc:?}");
}
