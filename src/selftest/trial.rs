//! Tools of a scene: the digest of its ticks, and the checks.

use alloc::vec::Vec;

use super::{Outcome, Problem};
use crate::body::BodyDef;
use crate::codec::{Encoder as _, StateHasher, Write as _};
use crate::error::Error;
use crate::fx::Fx;
use crate::math::{TimeStep, Vec2};
use crate::scalar::{FxAccumulator, FxWide, Turn};
use crate::slots::BodyId;
use crate::world::{World, WorldDef};

pub(super) type Played = Result<(), Problem>;

/// Steps worlds and takes down their hashes.
pub(super) struct Trial {
    digest: StateHasher,
    ticks: u64,
}

impl Trial {
    pub(super) fn new() -> Self {
        Self { digest: StateHasher::new(), ticks: 0 }
    }

    pub(super) fn outcome(&self) -> Outcome {
        Outcome { ticks: self.ticks, digest: self.digest.finish() }
    }

    pub(super) fn step(&mut self, world: &mut World) {
        world.step();
        self.take(world);
    }

    /// Takes down a tick that was made otherwise.
    pub(super) fn take(&mut self, world: &World) {
        world.state_hash().write(self.tick());
    }

    /// Counts a tick and returns the digest, for its bits.
    pub(super) fn tick(&mut self) -> &mut StateHasher {
        self.ticks += 1;
        &mut self.digest
    }

    /// Takes down bytes that are to be the same everywhere.
    pub(super) fn take_bytes(&mut self, bytes: &[u8]) {
        self.digest.bytes(bytes);
    }

    pub(super) fn steps(&mut self, world: &mut World, ticks: u32) {
        (0..ticks).for_each(|_| self.step(world));
    }
}

/// A world where nothing sleeps, at 64 steps a second: there a number with few digits behind the point goes through a step
/// of constant acceleration without rounding.
pub(super) fn exact() -> WorldDef {
    WorldDef { time_step: TimeStep::hz(64), sleep_after: None, ..WorldDef::default() }
}

pub(super) fn add_all(world: &mut World, defs: impl IntoIterator<Item = BodyDef>) -> Result<Vec<BodyId>, Error> {
    defs.into_iter().map(|def| world.add_body(def)).collect()
}

/// Checks that the event the scene is meant for happened.
pub(super) fn happened(what: &'static str, yes: bool) -> Played {
    if yes { Ok(()) } else { Err(Problem::DidNotHappen { what }) }
}

/// Checks that two values are equal.
pub(super) fn same<T: PartialEq>(what: &'static str, actual: &T, expected: &T) -> Played {
    if actual == expected { Ok(()) } else { Err(Problem::Differs { what }) }
}

/// A value is there.
pub(super) fn there<T>(what: &'static str, value: Option<T>) -> Result<T, Problem> {
    value.ok_or(Problem::DidNotHappen { what })
}

/// Two values of the same unit are no farther apart than `bound`.
pub(super) fn near(what: &'static str, actual: i128, expected: i128, bound: u128) -> Played {
    if actual.abs_diff(expected) <= bound {
        Ok(())
    } else {
        Err(Problem::Wrong { what, found: actual, expected, bound })
    }
}

/// In ulps.
pub(super) fn near_fx(what: &'static str, actual: Fx, expected: Fx, ulps: u32) -> Played {
    near(what, actual.to_bits().into(), expected.to_bits().into(), ulps.into())
}

pub(super) fn near_vec(what: &'static str, actual: Vec2, expected: Vec2, ulps: u32) -> Played {
    near_fx(what, actual.x, expected.x, ulps)?;
    near_fx(what, actual.y, expected.y, ulps)
}

/// In 2^-64 turns, the short way round.
pub(super) fn near_turn(what: &'static str, actual: Turn, expected: Turn, bound: u128) -> Played {
    near(what, i128::from(actual.to_bits().wrapping_sub(expected.to_bits()) as i64), 0, bound)
}

/// In units of 2^-64.
pub(super) fn near_wide(what: &'static str, actual: FxWide, expected: FxWide, bound: u128) -> Played {
    near(what, actual.to_bits(), expected.to_bits(), bound)
}

/// A call is refused, and for this reason.
pub(super) fn refused<T>(what: &'static str, call: Result<T, Error>, why: Error) -> Played {
    happened(what, call.err() == Some(why))
}

/// All the bits of a body that a step changes.
pub(super) fn bits(
    world: &World,
    body: BodyId,
) -> Result<(Vec2<FxAccumulator>, Vec2<FxAccumulator>, u64, i128), Error> {
    let body = world.body(body)?;
    let (angle, spin) = (body.angle_exact().to_bits(), body.angular_velocity_exact().to_bits());
    Ok((body.position_exact(), body.velocity_exact(), angle, spin))
}

/// Two bodies of two worlds, bit by bit.
pub(super) fn same_body(what: &'static str, a: (&World, BodyId), b: (&World, BodyId)) -> Played {
    same(what, &bits(a.0, a.1)?, &bits(b.0, b.1)?)
}

/// A flight of constant acceleration in steps of 1/64 s, in ulps; exact for what has few digits behind the point.
#[derive(Clone, Copy)]
pub(super) struct Flight {
    pub(super) x: i64,
    pub(super) v: i64,
}

impl Flight {
    pub(super) fn new(x: Fx, v: Fx) -> Self {
        Self { x: x.to_bits(), v: v.to_bits() }
    }

    /// x += v·t + ½·a·t², v += a·t with t = `ticks`/64 s.
    pub(super) fn fly(&mut self, a: Fx, ticks: i64) {
        self.x += self.v * ticks / 64 + a.to_bits() * ticks * ticks / (2 * 64 * 64);
        self.v += a.to_bits() * ticks / 64;
    }
}

/// Numbers without a pattern, the same everywhere.
///
/// *Source* SplitMix64: Steele, Lea, Flood, OOPSLA 2014.
pub(super) struct Numbers(pub(super) u64);

impl Numbers {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// From −2^log2 to 2^log2. *Domain* log2 < 31.
    pub(super) fn fx(&mut self, log2: u32) -> Fx {
        Fx::from_bits(self.next() as i64 >> (31 - log2))
    }

    pub(super) fn vec(&mut self, log2: u32) -> Vec2 {
        Vec2::new(self.fx(log2), self.fx(log2))
    }
}
