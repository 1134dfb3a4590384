//! `Fx` in files: decimal text in formats for people, bits in binary ones.

use umbra_physics::{Fx, fx};

#[test]
fn json_holds_the_exact_decimal_text() {
    for x in [fx!(0.1), Fx::MIN, Fx::MAX, Fx::DELTA, Fx::ZERO, fx!(-9.81)] {
        let json = serde_json::to_string(&x).unwrap();
        assert_eq!(json, format!("\"{x}\""));
        assert_eq!(serde_json::from_str::<Fx>(&json).unwrap(), x);
    }
    assert_eq!(serde_json::from_str::<Fx>("\"-1.5e-1\"").unwrap(), fx!(-0.15));
}

#[test]
fn a_bare_json_number_is_taken_only_if_no_float_stands_between() {
    let read = |json: &str| serde_json::from_str::<Fx>(json).map_err(|error| error.to_string());
    assert_eq!(read("-2147483648"), Ok(Fx::MIN));
    assert_eq!(read("2147483647"), Ok(fx!(2147483647)));
    for json in ["0.5", "1.0", "1e3", "2147483648", "-2147483649", "18446744073709551615"] {
        let error = read(json).unwrap_err();
        assert!(error.contains("a decimal number as a string"), "{json}: {error}");
    }
    assert!(read("\"2147483648\"").unwrap_err().contains("outside the range of I32F32"));
    assert!(read("\"1.5x\"").unwrap_err().contains("byte 3"));
    assert!(read("true").is_err());
}

#[test]
fn binary_formats_hold_the_bits() {
    for bits in [0, 1, -1, i64::MIN, i64::MAX] {
        let bytes = postcard::to_allocvec(&Fx::from_bits(bits)).unwrap();
        assert_eq!(bytes, postcard::to_allocvec(&bits).unwrap());
        assert_eq!(postcard::from_bytes::<Fx>(&bytes).unwrap().to_bits(), bits);
    }
}
