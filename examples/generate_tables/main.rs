//! Writes the tables of the kernels: `cargo run --example generate_tables`. `tests/tables.rs` compares the file with
//! its output.

mod tables;

fn main() -> std::io::Result<()> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/src/kernel/tables.rs");
    std::fs::write(path, tables::text())?;
    println!("wrote {path}");
    Ok(())
}
