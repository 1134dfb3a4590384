//! The kernels' tables are what the generator makes of the exact reference, entry by entry.

#[path = "../examples/generate_tables/tables.rs"]
mod tables;

#[test]
fn every_entry_is_the_exact_value_rounded() {
    let (committed, generated) = (include_str!("../src/kernel/tables.rs"), tables::text());
    // The names the kernels import are all there, so that a generator that lost one does not pass by losing it twice.
    let entries = generated.matches("0x").count();
    assert_eq!(entries, 4 + 2 * 129 + 129 + 128 + 128 + 10 + 2 * 128);
    for (number, (committed, generated)) in committed.lines().zip(generated.lines()).enumerate() {
        assert_eq!(committed, generated, "src/kernel/tables.rs, line {}", number + 1);
    }
    assert_eq!(committed, generated, "one of them is longer");
}
