//! Tables of all bodies, one line each, in exact decimals.

use std::borrow::Cow;

use umbra_physics::{Scalar, World};

use crate::cast::Cast;
use crate::failure::Failure;
use crate::output::{Destination, Output};

pub(crate) struct Table {
    output: Output,
    every: u64,
}

impl Table {
    pub(crate) fn create(to: &Destination, every: u64) -> Result<Self, Failure> {
        let mut output = to.create()?;
        output.put(|out| writeln!(out, "tick,name,x,y,angle,vx,vy,angular_velocity"))?;
        Ok(Self { output, every })
    }

    /// Writes the bodies if this is a tick to do so.
    pub(crate) fn write<S: Scalar>(&mut self, world: &World<S>, cast: &impl Cast) -> Result<(), Failure> {
        let tick = world.tick();
        if tick % self.every != 0 {
            return Ok(());
        }
        self.output.put(|out| {
            world.bodies().try_for_each(|body| {
                let (name, x, v) = (field(cast.name(body.id())), body.position(), body.velocity());
                let (angle, spin) = (body.angle(), body.angular_velocity());
                writeln!(out, "{tick},{name},{},{},{angle},{},{},{spin}", x.x, x.y, v.x, v.y)
            })
        })
    }

    pub(crate) fn finish(self) -> Result<(), Failure> {
        self.output.finish()
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
