//! The program `umbra`.
#![forbid(unsafe_code)]

fn main() -> std::process::ExitCode {
    umbra_cli::main()
}
