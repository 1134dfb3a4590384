//! The table and the picture of a run, made while it goes on.

use std::path::PathBuf;

use clap::Args;
use umbra_physics::scalar::ToF64;
use umbra_physics::{Scalar, World};

use crate::cast::Cast;
use crate::csv::Table;
use crate::failure::Failure;
use crate::format::Format;
use crate::output::{Destination, Destinations};
use crate::picture::{ContactOptions, Recorder, Subject};

#[derive(Args)]
pub(crate) struct SheetOptions {
    /// Writes all bodies to a table, in exact decimals.
    #[arg(long, value_name = "FILE.csv")]
    csv: Option<PathBuf>,
    /// Writes them each so many ticks.
    #[arg(long, value_name = "K", default_value_t = 1, requires = "csv", value_parser = clap::value_parser!(u64).range(1..))]
    every: u64,
    /// Draws the ways of the bodies.
    #[arg(long, value_name = "FILE.svg")]
    plot: Option<PathBuf>,
}

/// The destinations of the table and the picture.
pub(crate) struct SheetFiles {
    csv: Option<Destination>,
    every: u64,
    pub(crate) plot: Option<Destination>,
}

impl SheetFiles {
    pub(crate) fn new(options: &SheetOptions, all: &mut Destinations<'_>) -> Result<Self, Failure> {
        let csv = all.add_any(options.csv.as_ref(), Format::Csv)?;
        Ok(Self { csv, every: options.every, plot: all.add_any(options.plot.as_ref(), Format::Svg)? })
    }

    /// Says whether one of them goes to the standard output.
    pub(crate) fn has_stdout(&self) -> bool {
        [&self.csv, &self.plot].into_iter().flatten().any(Destination::is_stdout)
    }
}

/// The table and the picture in progress, as far as they are wanted.
pub(crate) struct Sheets<'a> {
    table: Option<Table>,
    picture: Option<(Recorder, &'a Destination)>,
}

impl<'a> Sheets<'a> {
    /// Begins them for a run of so many ticks.
    pub(crate) fn create(
        files: &'a SheetFiles,
        subject: Subject,
        ticks: u64,
        contacts: ContactOptions,
    ) -> Result<Self, Failure> {
        let table = files.csv.as_ref().map(|to| Table::create(to, files.every)).transpose()?;
        let picture = files.plot.as_ref().map(|to| (Recorder::new(subject, ticks, contacts), to));
        Ok(Self { table, picture })
    }

    /// Takes in the world at a tick.
    pub(crate) fn see<S: Scalar + ToF64>(&mut self, world: &World<S>, cast: &impl Cast) -> Result<(), Failure> {
        if let Some((recorder, _)) = &mut self.picture {
            recorder.record(world, cast);
        }
        self.table.as_mut().map_or(Ok(()), |table| table.write(world, cast))
    }

    /// Writes them out at the end of the run.
    pub(crate) fn finish<S: Scalar + ToF64>(self, world: &World<S>, cast: &impl Cast) -> Result<(), Failure> {
        if let Some(table) = self.table {
            table.finish()?;
        }
        self.picture.map_or(Ok(()), |(recorder, to)| to.write(&recorder.draw(world, cast)))
    }
}
