//! `umbra completions` and `umbra man`: what shells and `man` know of the program.

use std::io;

use clap::{Args, Command};
use clap_complete::Shell;
use clap_mangen::Man;

use crate::failure::Failure;
use crate::text;

#[derive(Args)]
pub(crate) struct CompletionOptions {
    /// The shell.
    shell: Shell,
}

/// Prints the completions for a shell.
pub(crate) fn completions(options: &CompletionOptions, mut program: Command) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(options.shell, &mut program, "umbra", &mut script);
    text::print_bytes(&script)
}

#[derive(Args)]
pub(crate) struct ManOptions {
    /// The command whose page it is [default: the program as a whole].
    command: Option<String>,
}

/// Prints the page of the program, or of one of its commands.
pub(crate) fn man(options: &ManOptions, mut program: Command) -> Result<(), Failure> {
    // With it the commands have their full names, and the options that all of them take.
    program.build();
    let command = match &options.command {
        None => program,
        Some(name) => program
            .find_subcommand(name)
            .cloned()
            .ok_or_else(|| Failure::Usage { what: format!("there is no command {name:?}: `umbra help` lists them") })?,
    };
    let mut page = Vec::new();
    let source = concat!("umbra ", env!("CARGO_PKG_VERSION"));
    Man::new(command)
        .source(source)
        .render(&mut page)
        .map_err(|error: io::Error| Failure::file("man".as_ref(), "write")(error))?;
    text::print_bytes(&page)
}
