//! Operators and geometry of vectors, integers and degrees against exact integers: each result is the nearest, ties to even.

#[path = "support/random.rs"]
mod random;
#[path = "support/real.rs"]
mod real;

use dashu_int::{IBig, UBig};
use random::SplitMix;
use real::{TAU, exact, ratio, real, to_f64, units};
use umbra_physics::{Fx, FxFactor, FxWide, MathError, Rot, Turn, Vec2, fx};

fn cases() -> u32 {
    crate::seeds::times(50_000)
}

/// num / den to nearest, ties to even. *Domain* den > 0.
fn nearest(num: &IBig, den: &IBig) -> IBig {
    let two = IBig::from(2);
    // The floor of num / den + ½, less one for a tie above an even integer.
    let (num, den) = (num * &two + den, den * &two);
    let rest = ((&num % &den) + &den) % &den;
    let floor = (&num - &rest) / &den;
    let is_tie = rest == IBig::ZERO;
    if is_tie && &floor % &two != IBig::ZERO { floor - 1 } else { floor }
}

/// The number of these units of 2^-32, if it fits.
fn fitting(bits: IBig) -> Option<Fx> {
    i64::try_from(bits).ok().map(Fx::from_bits)
}

fn ulp() -> IBig {
    IBig::ONE << 32
}

/// Numbers of every size, the ends of the range and small integers among them.
struct Numbers(SplitMix);

impl Numbers {
    fn bits(&mut self) -> i64 {
        match self.0.next() % 16 {
            0 => i64::MIN + self.0.between(0, 3),
            1 => i64::MAX - self.0.between(0, 3),
            2 => self.0.between(-3, 4) << 32,
            3 => self.0.between(-3, 4),
            // Halves of products and quotients are near.
            4 => self.0.of_bits(31) << 16,
            _ => self.0.of_bits(63),
        }
    }

    fn number(&mut self) -> Fx {
        Fx::from_bits(self.bits())
    }

    fn vector(&mut self) -> Vec2 {
        Vec2::new(self.number(), self.number())
    }
}

fn big(value: Fx) -> IBig {
    value.to_bits().into()
}

#[test]
fn products_of_vectors_are_the_nearest() {
    let mut numbers = Numbers(SplitMix::seeded(1));
    let (mut fits, mut beyond) = (0, 0);
    for _ in 0..cases() {
        let (a, b) = (numbers.vector(), numbers.vector());
        let dot = big(a.x) * big(b.x) + big(a.y) * big(b.y);
        let cross = big(a.x) * big(b.y) - big(a.y) * big(b.x);
        for (actual, wide, exact) in
            [(a.checked_dot(b), a.wide_dot(b), dot), (a.checked_cross(b), a.wide_cross(b), cross)]
        {
            assert_eq!(actual, fitting(nearest(&exact, &ulp())), "{a} and {b}");
            assert_eq!(wide.map(FxWide::to_bits), i128::try_from(exact).ok(), "{a} and {b}");
            *if actual.is_some() { &mut fits } else { &mut beyond } += 1;
        }
        let squares = |x: IBig, y: IBig| fitting(nearest(&(&x * &x + &y * &y), &ulp()));
        assert_eq!(a.checked_length_squared(), squares(big(a.x), big(a.y)), "{a}");
        let distance = squares(big(b.x) - big(a.x), big(b.y) - big(a.y));
        assert_eq!(a.checked_distance_squared(b), distance, "{a} to {b}");
        let scaled = |c: Fx| fitting(nearest(&(big(c) * big(b.x)), &ulp()));
        assert_eq!(a.checked_scale(b.x), scaled(a.x).zip(scaled(a.y)).map(Vec2::from), "{a} times {}", b.x);
        let rot = Rot { cos: b.x, sin: b.y };
        let component = |sum: IBig| fitting(nearest(&sum, &ulp()));
        let x = component(big(b.x) * big(a.x) - big(b.y) * big(a.y));
        let turned = x.zip(component(big(b.y) * big(a.x) + big(b.x) * big(a.y))).map(Vec2::from);
        assert_eq!(rot.checked_rotate(a), turned, "{a} turned by {b}");
        if let Some(turned) = turned {
            assert_eq!(rot * a, turned, "{a} turned by {b}");
        }
    }
    assert!(fits > cases() / 4 && beyond > cases() / 20, "{fits} fit, {beyond} do not");
}

/// Returns true if `value` is the integer nearest to √squares: (2·value ± 1)² against 4·squares.
fn is_nearest_root(value: u64, squares: &UBig) -> bool {
    let bound = |twice: u128| UBig::from(twice).pow(2);
    let (twice, exact) = (2 * u128::from(value), squares * 4u8);
    exact <= bound(twice + 1) && (value == 0 || exact >= bound(twice - 1))
}

#[test]
fn lengths_and_distances_are_the_nearest() {
    let mut numbers = Numbers(SplitMix::seeded(2));
    let square = |c: IBig| UBig::try_from(&c * &c).expect("a square");
    // Half an ulp above the greatest number, squared and times four: lengths from there on do not fit.
    let limit = (UBig::from(u64::MAX)).pow(2);
    for _ in 0..cases() {
        let (a, b) = (numbers.vector(), numbers.vector());
        for (actual, x, y) in [
            (a.checked_length(), big(a.x), big(a.y)),
            (a.checked_distance(b), big(b.x) - big(a.x), big(b.y) - big(a.y)),
        ] {
            let squares = square(x) + square(y);
            match actual {
                Some(length) => {
                    assert!(length >= Fx::ZERO && is_nearest_root(length.to_bits() as u64, &squares), "{a} and {b}")
                }
                None => assert!(&squares * 4u8 >= limit, "{a} and {b}"),
            }
        }
    }
}

#[test]
fn unit_vectors_and_shortened_ones_have_the_nearest_components() {
    let mut numbers = Numbers(SplitMix::seeded(3));
    let (mut shortened, mut kept) = (0, 0);
    for _ in 0..cases() {
        let (v, max) = (numbers.vector(), numbers.number().saturating_abs());
        if v == Vec2::ZERO {
            continue;
        }
        let squares = UBig::from(v.x.to_bits().unsigned_abs()).pow(2) + UBig::from(v.y.to_bits().unsigned_abs()).pow(2);
        // |q − c·length/√squares| <= ½.
        let check = |component: Fx, actual: Fx, length: Fx| {
            let (q, length) = (2 * u128::from(actual.to_bits().unsigned_abs()), length.to_bits().unsigned_abs());
            let exact = (UBig::from(component.to_bits().unsigned_abs()) * length * 2u8).pow(2);
            let bound = |twice: u128| UBig::from(twice).pow(2) * &squares;
            assert!(exact <= bound(q + 1) && (q == 0 || exact >= bound(q - 1)), "{actual} of {v}");
            assert!(actual == Fx::ZERO || actual.signum() == component.signum(), "{actual} of {v}");
        };
        let unit = v.normalize().expect("it is not zero");
        check(v.x, unit.x, Fx::ONE);
        check(v.y, unit.y, Fx::ONE);
        let clamped = v.clamp_length(max);
        if squares <= UBig::from(max.to_bits().unsigned_abs()).pow(2) {
            assert_eq!(clamped, v);
            kept += 1;
        } else {
            check(v.x, clamped.x, max);
            check(v.y, clamped.y, max);
            shortened += 1;
        }
    }
    assert!(shortened > cases() / 10 && kept > cases() / 10, "{shortened} shortened, {kept} kept");
    assert_eq!((Vec2::ZERO.normalize(), Vec2::<Fx>::ZERO.clamp_length(Fx::ZERO)), (None, Vec2::ZERO));
}

#[test]
fn points_between_are_the_nearest() {
    let mut numbers = Numbers(SplitMix::seeded(4));
    for i in 0..cases() {
        let (a, b, t) = (numbers.vector(), numbers.vector(), numbers.number());
        let t = if i % 2 == 0 { t } else { Fx::from_bits(t.to_bits() & 0xffff_ffff) };
        let component =
            |from: Fx, to: Fx| fitting(nearest(&((big(from) << 32) + (big(to) - big(from)) * big(t)), &ulp()));
        let expected = component(a.x, b.x).zip(component(a.y, b.y)).map(Vec2::from);
        assert_eq!(a.checked_lerp(b, t), expected, "{a} to {b} at {t}");
        assert_eq!((a.lerp(b, Fx::ZERO), a.lerp(b, Fx::ONE)), (a, b));
    }
}

#[test]
fn operators_of_vectors_are_those_of_their_components() {
    let mut numbers = Numbers(SplitMix::seeded(5));
    let mut tried = 0;
    for _ in 0..cases() / 10 {
        let (a, b, s) = (numbers.vector(), numbers.vector(), numbers.number());
        let both = |f: &dyn Fn(Fx, Fx) -> Option<Fx>| f(a.x, b.x).zip(f(a.y, b.y)).map(Vec2::from);
        assert_eq!(a.checked_add(b), both(&Fx::checked_add));
        assert_eq!(a.checked_sub(b), both(&Fx::checked_sub));
        assert_eq!(Some((a.min(b), a.max(b))), both(&|x, y| Some(x.min(y))).zip(both(&|x, y| Some(x.max(y)))));
        assert_eq!(a.checked_abs(), a.x.checked_abs().zip(a.y.checked_abs()).map(Vec2::from));
        assert_eq!(a.checked_div(s), a.x.checked_div(s).zip(a.y.checked_div(s)).map(Vec2::from));
        let mut c = a;
        if let Some(sum) = a.checked_add(b) {
            c += b;
            assert_eq!((a + b, c, [a, b].into_iter().sum()), (sum, sum, sum));
            c -= b;
            assert_eq!(c, a);
        }
        if let Some(product) = a.checked_scale(s) {
            c *= s;
            assert_eq!((a * s, s * a, c), (product, product, product));
            tried += 1;
        }
        if let (Some(quotient), mut c) = (a.checked_div(s), a) {
            c /= s;
            assert_eq!((a / s, c), (quotient, quotient));
        }
        let n = numbers.0.of_bits(31) as i32;
        if let Some(product) = a.try_map(|c| c.checked_mul_int(n)) {
            let mut c = a;
            c *= n;
            assert_eq!((a * n, n * a, c), (product, product, product));
        }
        if let Some(quotient) = a.try_map(|c| c.checked_div_int(n)) {
            let mut c = a;
            c /= n;
            assert_eq!((a / n, c), (quotient, quotient));
        }
        assert_eq!((Vec2::from([a.x, a.y]), <[Fx; 2]>::from(a), <(Fx, Fx)>::from(a)), (a, [a.x, a.y], (a.x, a.y)));
    }
    assert!(tried > 100, "{tried} products fit");
}

/// Each of these does not fit, and says so in every profile.
#[test]
fn operators_panic_where_a_result_does_not_fit() {
    let (max, unit, min) = (Vec2::new(Fx::MAX, Fx::ZERO), Vec2::<Fx>::X, Vec2::new(Fx::ZERO, Fx::MIN));
    let cases: [(&str, &dyn Fn() -> Vec2); 13] = [
        ("sum", &|| max + unit),
        ("difference", &|| min - Vec2::Y),
        ("negative", &|| -min),
        ("product", &|| max * fx!(2)),
        ("division by zero", &|| max / Fx::ZERO),
        ("product", &|| max * 2),
        ("division by zero", &|| max / 0),
        ("magnitude", &|| min.abs()),
        ("sum", &|| [max, unit].into_iter().sum()),
        ("point", &|| Vec2::ZERO.lerp(max, fx!(2))),
        ("length is not negative", &|| max.clamp_length(fx!(-1))),
        ("negative", &|| min.perp()),
        ("turned vector", &|| Rot { cos: fx!(1), sin: fx!(-1) } * (max + Vec2::Y)),
    ];
    let numbers: [(&str, &dyn Fn() -> Fx); 11] = [
        ("dot product", &|| max.dot(max)),
        ("cross product", &|| max.cross(min)),
        ("length", &|| (max + min).length()),
        ("distance", &|| max.distance(min)),
        ("square of the length", &|| max.length_squared()),
        ("square of the distance", &|| max.distance_squared(min)),
        ("product", &|| Fx::MAX * 2),
        ("quotient", &|| Fx::MIN / -1),
        ("division by zero", &|| fx!(1) / 0),
        ("division by zero", &|| fx!(1) % Fx::ZERO),
        ("degrees", &|| Fx::MAX.to_degrees()),
    ];
    let cases =
        cases.map(|(word, call)| (word, std::panic::catch_unwind(std::panic::AssertUnwindSafe(call)).map(drop)));
    let numbers =
        numbers.map(|(word, call)| (word, std::panic::catch_unwind(std::panic::AssertUnwindSafe(call)).map(drop)));
    for (word, result) in cases.into_iter().chain(numbers) {
        let said = result.expect_err(word);
        let said = said.downcast_ref::<String>().cloned().or(said.downcast_ref::<&str>().map(|text| (*text).into()));
        assert!(said.as_ref().is_some_and(|said| said.contains(word)), "{word}: {said:?}");
    }
    for dividend in [FxFactor::ONE, FxFactor::ZERO] {
        let said = std::panic::catch_unwind(|| dividend.over(FxFactor::ZERO)).expect_err("a division by zero");
        assert!(said.downcast_ref::<&str>().is_some_and(|said| said.contains("divisor is zero")));
    }
    let said = std::panic::catch_unwind(|| FxFactor::from(fx!(-1))).expect_err("a negative factor");
    assert!(said.downcast_ref::<&str>().is_some_and(|said| said.contains("negative")));
}

#[test]
fn integers_and_remainders_are_exact() {
    let mut numbers = Numbers(SplitMix::seeded(6));
    for i in 0..cases() {
        let (a, b) = (numbers.number(), numbers.number());
        let n = match i % 8 {
            0 => i32::MIN,
            1 => i32::MAX,
            _ => numbers.0.of_bits(31) as i32,
        };
        assert_eq!(a.checked_mul_int(n), fitting(big(a) * n), "{a} · {n}");
        let product = a.checked_mul_int(n);
        assert!(product.is_none_or(|product| [a * n, n * a] == [product; 2]));
        let quotient = (n != 0).then(|| {
            let sign = if n < 0 { -1 } else { 1 };
            fitting(nearest(&(big(a) * sign), &IBig::from(n.unsigned_abs())))
        });
        assert_eq!(a.checked_div_int(n), quotient.flatten(), "{a} / {n}");
        let rest = (b != Fx::ZERO).then(|| big(a) % big(b));
        assert_eq!(a.checked_rem(b).map(big), rest, "{a} % {b}");
        if let Some(rest) = rest {
            let magnitude = IBig::from(b.to_bits().unsigned_abs());
            let euclid = if rest < IBig::ZERO { rest + magnitude } else { rest };
            assert_eq!(big(a.rem_euclid(b)), euclid, "{a} modulo {b}");
        }
        let floor = big(a) >> 32;
        assert_eq!(IBig::from(a.floor_to_int()), floor);
        assert_eq!(IBig::from(a.ceil_to_int()), -(-big(a) >> 32));
        assert_eq!(IBig::from(a.round_to_int()), nearest(&big(a), &ulp()));
        let value = a.to_bits();
        let expected = i32::try_from(value).map(Fx::from_int).map_err(|_| MathError::Overflow);
        assert_eq!((Fx::try_from(value), Fx::try_from(i128::from(value))), (expected, expected));
        if n >= 0 {
            assert_eq!(FxFactor::from(n).to_scalar(), Some(Fx::from_int(n)));
        }
        let all = [a, b, Fx::from_int(n)];
        let total = all.iter().fold(IBig::ZERO, |sum, number| sum + big(*number));
        if let Some(total) = fitting(total) {
            assert_eq!([all.iter().sum::<Fx>(), all.iter().rev().copied().sum()], [total; 2]);
        }
    }
}

#[test]
fn degrees_are_the_nearest() {
    let mut numbers = Numbers(SplitMix::seeded(7));
    let mut worst = [0.0f64; 2];
    for _ in 0..cases() / 10 {
        let a = numbers.number();
        let radians = exact(a) * &*TAU / real(360);
        let off = to_f64(&((exact(a.to_radians()) - radians) << 32)).abs();
        worst[0] = worst[0].max(off);
        let degrees = exact(a) * real(360) / &*TAU;
        match a.checked_to_degrees() {
            Some(actual) => worst[1] = worst[1].max(to_f64(&((exact(actual) - degrees) << 32)).abs()),
            None => assert!(to_f64(&degrees).abs() >= 2f64.powi(31) * 0.999_999, "{a}"),
        }
        // Whole turns are cut off.
        let turns = nearest(&(big(a) << 32), &IBig::from(360));
        let turns =
            u64::try_from(((turns % (IBig::ONE << 64)) + (IBig::ONE << 64)) % (IBig::ONE << 64)).expect("a word");
        assert_eq!(Turn::from_degrees(a).to_bits(), turns, "{a}");
        let angle = Turn::from_bits(a.to_bits() as u64);
        let off = exact(angle.degrees()) - units(angle.to_bits(), 64) * real(360);
        assert!((off.clone() << 32) <= ratio(1, 2) && (off << 32) >= ratio(-1, 2), "{a}");
    }
    assert!(worst.iter().all(|off| (0.49..=0.5001).contains(off)), "{worst:?}");
}
