//! The text of `src/kernel/tables.rs`, every entry from the arbitrary-precision reference.

use dashu_float::FBig;
use dashu_float::round::mode::HalfEven;
use dashu_int::IBig;

type Real = FBig<HalfEven, 2>;

/// Bits carried: the widest entry has 128, and none lies within 2^-100 of a tie unless it is exact.
const PRECISION: usize = 256;

fn real(value: i64) -> Real {
    Real::from(value).with_precision(PRECISION).value()
}

fn tau() -> Real {
    real(1).asin() * real(4)
}

fn ln_2() -> Real {
    real(2).ln()
}

/// `value` in units of 2^-bits, rounded to nearest.
fn units(value: Real, bits: isize) -> IBig {
    (value << bits).round().to_int().value()
}

struct Text(String);

impl Text {
    fn doc(&mut self, doc: &str) {
        self.0.push_str(&format!("\n/// {doc}\n"));
    }

    fn constant(&mut self, doc: &str, name: &str, kind: &str, value: String) {
        self.doc(doc);
        self.0.push_str(&format!("pub(crate) const {name}: {kind} = {value};\n"));
    }

    /// `per_line` entries a line.
    fn table(&mut self, doc: &str, name: &str, kind: &str, entries: Vec<String>, per_line: usize) {
        self.doc(doc);
        self.0.push_str("#[rustfmt::skip]\n");
        self.0.push_str(&format!("pub(crate) static {name}: [{kind}; {}] = [\n", entries.len()));
        for line in entries.chunks(per_line) {
            self.0.push_str(&format!("    {},\n", line.join(", ")));
        }
        self.0.push_str("];\n");
    }
}

fn hex(value: IBig, digits: usize) -> String {
    format!("0x{:0digits$x}", u128::try_from(value).expect("every entry is positive and below 2^128"))
}

/// The file, complete.
pub(crate) fn text() -> String {
    let mut text = Text(
        "//! Tables and constants of the kernels. Written by `cargo run --example generate_tables`, checked entry by entry by\n\
         //! `tests/tables.rs`; every value is the exact one rounded to nearest.\n"
            .to_owned(),
    );
    constants(&mut text);
    let entry = |value, bits| hex(units(value, bits), 16);
    let wide_entry = |value, bits| hex(units(value, bits), 32);

    text.table(
        "(sin, cos) of i/1024 turn for i = 0..=128, in Q2.62.",
        "SIN_COS_Q62",
        "(i64, i64)",
        (0..=128)
            .map(|i| {
                let (sin, cos) = (tau() * real(i) / real(1024)).sin_cos();
                format!("({}, {})", entry(sin, 62), entry(cos, 62))
            })
            .collect(),
        2,
    );
    text.table(
        "atan(i/128) for i = 0..=128, in 2^-64 turn.",
        "ATAN_TURN",
        "u64",
        (0..=128).map(|i| entry((real(i) / real(128)).atan() / tau(), 64)).collect(),
        5,
    );
    text.table(
        "-log2(r/256) for i = 0..128, in Q7.120, where r = `log2_reciprocal`(128 + i).",
        "LOG2_Q120",
        "i128",
        (128..256)
            .map(|j| {
                let reciprocal = if j == 128 { 256 } else { ((1 << 16) + j) / (2 * j + 1) };
                wide_entry(-(real(reciprocal) / real(256)).ln() / ln_2(), 120)
            })
            .collect(),
        3,
    );
    text.table(
        "2^(i/128) for i = 0..128, in Q1.127.",
        "EXP2_Q127",
        "u128",
        (0..128).map(|i| wide_entry((ln_2() * real(i) / real(128)).exp(), 127)).collect(),
        3,
    );
    let mut term = real(1);
    let series = (1..=10).map(|n| {
        term = &term * ln_2() / real(n);
        wide_entry(term.clone(), 127)
    });
    text.table(
        "(ln 2)^n / n! for n = 1..=10, in Q1.127: the series of 2^x.",
        "EXP2_SERIES_Q127",
        "u128",
        series.collect(),
        3,
    );
    text.table(
        "1/√v over [i/128, (i+1)/128] for i = 32..128, in Q2.30: (value at the left end, fall over the interval) of the\n\
         /// chord, lowered by half its height over the curve at the middle. The entries below 32 are for v = 0.",
        "RSQRT_Q30",
        "(u32, u32)",
        (0..128)
            .map(|i| {
                if i < 32 {
                    return format!("({}, {})", hex(IBig::ZERO, 8), hex(IBig::ZERO, 8));
                }
                let at = |half_steps: i64| real(1) / (real(half_steps) / real(256)).sqrt();
                let (left, middle, right) = (at(2 * i), at(2 * i + 1), at(2 * i + 2));
                let height = (&left + &right) / real(2) - middle;
                let lowered = &left - height / real(2);
                format!("({}, {})", hex(units(lowered, 30), 8), hex(units(left - right, 30), 8))
            })
            .collect(),
        4,
    );
    text.0
}

fn constants(text: &mut Text) {
    let wide_entry = |value, bits| hex(units(value, bits), 32);
    text.constant(
        "1/2π in Q0.128: a radian in turns.",
        "TURN_PER_RADIAN_Q128",
        "u128",
        wide_entry(real(1) / tau(), 128),
    );
    text.constant("2π in Q4.60.", "TAU_Q60", "i64", hex(units(tau(), 60), 16));
    text.constant("1/2π in Q0.66.", "INV_TAU_Q66", "u64", hex(units(real(1) / tau(), 66), 16));
    text.constant(
        "2^127 / ln 2, less 2^127: log2 e in Q1.127 without its leading one.",
        "LOG2_E_LESS_ONE_Q127",
        "u128",
        wide_entry(real(1) / ln_2() - real(1), 127),
    );
}
