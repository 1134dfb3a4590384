//! Functions of numbers against their defining properties.
#![no_main]

use libfuzzer_sys::fuzz_target;
use umbra_physics::Fx;

fuzz_target!(|input: (i64, i64, &str)| {
    let (a, b, text) = (Fx::from_bits(input.0), Fx::from_bits(input.1), input.2);
    let (x, y) = (i128::from(input.0), i128::from(input.1));

    if let Some(product) = a.checked_mul(b) {
        let away = x * y - (i128::from(product.to_bits()) << 32);
        assert!(away.abs() <= 1 << 31, "{a} · {b} = {product}");
        assert!(away.abs() < 1 << 31 || product.to_bits() % 2 == 0, "a tie not to even: {a} · {b}");
    }
    if let Some(quotient) = a.checked_div(b) {
        let away = (x << 32) - i128::from(quotient.to_bits()) * y;
        assert!(2 * away.abs() <= y.abs(), "{a} / {b} = {quotient}");
        assert!(2 * away.abs() < y.abs() || quotient.to_bits() % 2 == 0, "a tie not to even: {a} / {b}");
    }
    if let Some(root) = a.checked_sqrt() {
        let root = i128::from(root.to_bits());
        // (r − ½)² <= x·2^32 < (r + ½)², all times four.
        assert!((2 * root - 1).pow(2) <= (x << 34) || root == 0);
        assert!((x << 34) < (2 * root + 1).pow(2));
    }
    let (sin, cos) = a.sin_cos();
    let square = i128::from(sin.to_bits()).pow(2) + i128::from(cos.to_bits()).pow(2);
    assert!((square - (1 << 64)).abs() < 1 << 34, "off the unit circle at {a}");
    let angle = Fx::atan2(a, b);
    assert!(angle.abs() <= Fx::PI);
    for result in [a.exp2(), a.log2(), a.pow(b)].into_iter().flatten() {
        assert_eq!(result.to_string().parse(), Ok(result));
    }
    assert_eq!(a.to_string().parse(), Ok(a));
    if let Ok(value) = text.parse::<Fx>() {
        assert_eq!(value.to_string().parse(), Ok(value));
    }
});
