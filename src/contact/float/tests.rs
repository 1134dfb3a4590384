//! Manifolds in floats beside those in integers, and impulses as integers.

use core::f64::consts::TAU;

use alloc::vec::Vec;

use super::{FloatContacts, impulses_of, newton_seconds};
use crate::cases::run_seed;
use crate::contact::{ContactEngine, FxContacts};
use crate::fx::Fx;
use crate::math::{Random, Vec2};
use crate::scalar::{FxAccumulator, ToF64 as _, Turn};
use crate::shape::{Geometry, Outline, Shape};

fn within(random: &mut Random, from: f64, to: f64) -> f64 {
    from + (to - from) * random.below(1 << 24) as f64 / f64::from(1 << 24)
}

/// Both to the same bits.
fn both(value: f64) -> (Fx, f64) {
    let value = Fx::from_f64_for_tools(value).expect("a number that fits");
    (value, value.to_f64())
}

/// A shape in both scalars.
fn shape(random: &mut Random) -> (Shape<Fx>, Shape<f64>) {
    let [a, b] = [0, 1].map(|_| both(within(random, 0.2, 1.5)));
    let of = match random.below(4) {
        0 => (Geometry::Circle { radius: a.0 }, Geometry::Circle { radius: a.1 }),
        1 => (Geometry::Rectangle { width: a.0, height: b.0 }, Geometry::Rectangle { width: a.1, height: b.1 }),
        2 => (Geometry::Capsule { length: a.0, radius: b.0 }, Geometry::Capsule { length: a.1, radius: b.1 }),
        _ => {
            let count = 3 + random.below(5);
            let start = within(random, 0.0, TAU);
            let at = |k: u64| {
                let angle = start + TAU * k as f64 / count as f64;
                (both(libm::cos(angle) * a.1), both(libm::sin(angle) * b.1))
            };
            let corners: Vec<_> = (0..count).map(at).collect();
            let fixed: Vec<_> = corners.iter().map(|(x, y)| Vec2::new(x.0, y.0)).collect();
            let floats: Vec<_> = corners.iter().map(|(x, y)| Vec2::new(x.1, y.1)).collect();
            return (Shape::polygon(&fixed).expect("a polygon"), Shape::polygon(&floats).expect("a polygon"));
        }
    };
    (Shape::new(of.0).expect("a shape"), Shape::new(of.1).expect("a shape"))
}

type Place = ((Vec2<FxAccumulator>, Turn), (Vec2<f64>, f64));

fn place(random: &mut Random, reach: f64) -> Place {
    let [x, y] = [0, 1].map(|_| both(within(random, -reach, reach)));
    let turn = Turn::from_bits(random.below(1 << 32) << 32);
    let at = Vec2::new(x.0, y.0).map(FxAccumulator::from_scalar);
    ((at, turn), (Vec2::new(x.1, y.1), turn.to_f64()))
}

/// The differences between manifolds in both scalars.
#[derive(Default)]
struct Differences {
    touching: u32,
    /// Manifolds with other points, or of other directions that tie.
    other: u32,
    /// The largest difference of a position or a separation, m.
    off: f64,
}

impl Differences {
    /// Compares the manifolds of two outlines.
    fn add(&mut self, a: (&Outline<Fx>, &Outline<f64>), at: Place, b: (&Outline<Fx>, &Outline<f64>), there: Place) {
        let fixed = FxContacts::touch((a.0, at.0), (b.0, there.0));
        let float = FloatContacts::touch((a.1, at.1), (b.1, there.1));
        let (Some((n, p, count)), Some((m, q, other))) = (fixed, float) else {
            self.other += u32::from(fixed.is_some() != float.is_some());
            return;
        };
        self.touching += 1;
        let apart = (n.x.to_f64() - m.x).abs().max((n.y.to_f64() - m.y).abs());
        if count != other || apart > 1e-6 || (0..count).any(|k| p[k].feature != q[k].feature) {
            self.other += 1;
            return;
        }
        for (p, q) in p.iter().zip(&q).take(count) {
            let way = [p.position.x.to_f64() - q.position.x, p.position.y.to_f64() - q.position.y];
            let off = [way[0], way[1], p.separation.to_f64() - q.separation].map(f64::abs);
            self.off = off.into_iter().fold(self.off, f64::max);
        }
    }
}

#[test]
fn manifolds_are_those_of_integers() {
    let mut random = Random::seeded(run_seed(1));
    let cases = if cfg!(debug_assertions) { 20_000 } else { 500_000 };
    let mut found = Differences::default();
    for _ in 0..cases {
        let [a, b] = [0, 1].map(|_| shape(&mut random));
        let [at, there] = [0, 1].map(|_| place(&mut random, 1.0));
        found.add((&a.0.outlines()[0], &a.1.outlines()[0]), at, (&b.0.outlines()[0], &b.1.outlines()[0]), there);
    }
    let Differences { touching, other, off } = found;
    assert!(touching > cases / 4, "{touching}");
    assert!(other < touching / 1000, "{other} of {touching} differ");
    // Directions differ by 2^-30. Where two edges are nearly parallel, the end of their overlap moves by a few hundred times as much.
    assert!(off < 2.5e-7, "{off:e}");
}

#[test]
fn manifolds_with_chains_are_those_of_integers() {
    let mut random = Random::seeded(run_seed(4));
    let cases = if cfg!(debug_assertions) { 2_000 } else { 50_000 };
    let mut found = Differences::default();
    for _ in 0..cases {
        let points: Vec<_> = (0..8).map(|x| [both(4.0 - f64::from(x)), both(within(&mut random, -0.5, 0.5))]).collect();
        let fixed: Vec<_> = points.iter().map(|[x, y]| Vec2::new(x.0, y.0)).collect();
        let floats: Vec<_> = points.iter().map(|[x, y]| Vec2::new(x.1, y.1)).collect();
        let chains = (Shape::chain(&fixed, false).expect("a chain"), Shape::chain(&floats, false).expect("a chain"));
        let (b, [at, there]) = (shape(&mut random), [0.1, 2.0].map(|reach| place(&mut random, reach)));
        for (fixed, float) in chains.0.outlines().iter().zip(chains.1.outlines()) {
            found.add((fixed, float), at, (&b.0.outlines()[0], &b.1.outlines()[0]), there);
        }
    }
    let Differences { touching, other, off } = found;
    assert!(touching > cases / 4, "{touching}");
    assert!(other < touching / 1000, "{other} of {touching} differ");
    assert!(off < 2.5e-7, "{off:e}");
}

#[test]
fn impulses_come_back() {
    let mut random = Random::seeded(run_seed(2));
    for _ in 0..10_000 {
        let size = libm::scalbn(1.0, random.below(60) as i32 - 30);
        let values = [0, 1, 2].map(|k| size * within(&mut random, if k == 2 { -1.0 } else { 0.0 }, 1.0));
        let impulses = impulses_of(values);
        assert!(impulses.values.iter().all(|value| value.unsigned_abs() <= 1 << 62));
        let largest = values.into_iter().map(f64::abs).fold(0.0, f64::max);
        for (value, back) in values.into_iter().zip(newton_seconds::<f64>(impulses)) {
            assert!((value - back).abs() <= largest * f64::EPSILON / 256.0, "{value:e} {back:e}");
        }
    }
}

#[test]
fn impulses_that_are_no_numbers_count_as_zero() {
    assert_eq!(impulses_of([f64::NAN, f64::INFINITY, f64::NEG_INFINITY]).values, [0; 3]);
    let impulses = impulses_of([f32::NAN, 2.0, -1.0]);
    assert_eq!(newton_seconds::<f32>(impulses), [0.0, 2.0, -1.0]);
    // Beyond what a record holds.
    let [most, least, _] = impulses_of([f64::MAX, f64::MIN_POSITIVE, 0.0]).values;
    assert_eq!((most, least), (1 << 62, 0));
}
