//! Tables of all bodies, one line each, in exact decimals.

use std::borrow::Cow;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use umbra_physics::Scalar;
use umbra_physics::scene::SceneRun;

use crate::failure::Failure;

pub(crate) struct Table {
    file: PathBuf,
    out: BufWriter<File>,
    every: u64,
}

impl Table {
    pub(crate) fn create(file: &Path, every: u64) -> Result<Self, Failure> {
        let failed = Failure::file(file, "write");
        let mut out = BufWriter::new(File::create(file).map_err(&failed)?);
        writeln!(out, "tick,name,x,y,angle,vx,vy,angular_velocity").map_err(&failed)?;
        Ok(Self { file: file.into(), out, every })
    }

    /// Writes the bodies if this is a tick to do so.
    pub(crate) fn write<S: Scalar>(&mut self, run: &SceneRun<'_, S>) -> Result<(), Failure> {
        let tick = run.world().tick();
        if tick % self.every != 0 {
            return Ok(());
        }
        let mut rows = || -> io::Result<()> {
            for body in run.world().bodies() {
                let (name, x, v) = (field(run.name(body.id())), body.position(), body.velocity());
                let (angle, spin) = (body.angle(), body.angular_velocity());
                writeln!(self.out, "{tick},{name},{},{},{angle},{},{},{spin}", x.x, x.y, v.x, v.y)?;
            }
            Ok(())
        };
        rows().map_err(Failure::file(&self.file, "write"))
    }

    pub(crate) fn finish(mut self) -> Result<(), Failure> {
        self.out.flush().map_err(Failure::file(&self.file, "write"))
    }
}

/// A name as RFC 4180 has it: in quotes where it must be.
fn field(name: &str) -> Cow<'_, str> {
    if name.contains(['"', ',', '\n', '\r']) {
        Cow::Owned(format!("\"{}\"", name.replace('"', "\"\"")))
    } else {
        Cow::Borrowed(name)
    }
}
