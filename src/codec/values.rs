//! Encoding and decoding of numbers, handles and other values of the layers below.

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::decode::{Malformed, Read, Reader};
use super::encode::{Encoder, Part, Write, count, field};
use crate::fx::Fx;
use crate::math::{Elapsed, Random, TimeStep, Vec2};
use crate::scalar::{FxAccumulator, FxFactor, FxSum, FxWide, Number, Turn};
use crate::slots::{BodyId, ColliderId, FieldId, JointId};

impl<N: Number> Write for N {
    #[inline]
    fn write(&self, out: &mut impl Encoder) {
        let words = self.to_words().map(u64::to_le_bytes);
        out.leaf(words[..N::WORDS].as_flattened(), self);
    }
}

macro_rules! codec_integers {
    ($($integer:ident)*) => { $(
        impl Write for $integer {
            #[inline]
            fn write(&self, out: &mut impl Encoder) {
                out.leaf(&self.to_le_bytes(), self);
            }
        }

        impl Read for $integer {
            fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
                reader.array().map(Self::from_le_bytes)
            }
        }
    )* };
}

codec_integers!(u8 u16 u32 u64 u128 i8 i16 i32 i64);

impl Read for Fx {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        reader.words().map(|[bits]| Self::from_bits(bits as i64))
    }
}

impl Read for Turn {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        reader.words().map(|[bits]| Self::from_bits(bits))
    }
}

fn wide_bits([high, low]: [u64; 2]) -> i128 {
    i128::from(high as i64) << 64 | i128::from(low)
}

impl Read for FxAccumulator {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        reader.words().map(|words| Self::from_bits(wide_bits(words)))
    }
}

impl Read for FxWide {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        reader.words().map(|words| Self::from_bits(wide_bits(words)))
    }
}

impl Read for FxSum {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        reader.words().map(Self::from_words)
    }
}

impl Read for FxFactor {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        let malformed = reader.malformed("a factor");
        Self::from_words(reader.words()?).ok_or(malformed)
    }
}

impl<T: Write> Write for Arc<T> {
    fn write(&self, out: &mut impl Encoder) {
        (**self).write(out);
    }
}

impl Write for bool {
    fn write(&self, out: &mut impl Encoder) {
        out.leaf(&[u8::from(*self)], self);
    }
}

impl Read for bool {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        let malformed = reader.malformed("0 or 1");
        match u8::read(reader)? {
            0 => Ok(false),
            1 => Ok(true),
            _ => Err(malformed),
        }
    }
}

impl<T: Write> Write for Option<T> {
    fn write(&self, out: &mut impl Encoder) {
        field(out, "given", &self.is_some());
        if let Some(value) = self {
            value.write(out);
        }
    }
}

impl<T: Read> Read for Option<T> {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        if bool::read(reader)? { T::read(reader).map(Some) } else { Ok(None) }
    }
}

impl<T: Write> Write for [T; 2] {
    fn write(&self, out: &mut impl Encoder) {
        for (index, value) in (0..).zip(self) {
            out.enter(Part::Entry(index));
            value.write(out);
            out.leave();
        }
    }
}

impl<T: Read> Read for [T; 2] {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        Ok([T::read(reader)?, T::read(reader)?])
    }
}

impl<T: Write> Write for Vec2<T> {
    fn write(&self, out: &mut impl Encoder) {
        field(out, "x", &self.x);
        field(out, "y", &self.y);
    }
}

impl<T: Read> Read for Vec2<T> {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        Ok(Self { x: T::read(reader)?, y: T::read(reader)? })
    }
}

macro_rules! codec_handles {
    ($($handle:ident)*) => { $(
        impl Write for $handle {
            fn write(&self, out: &mut impl Encoder) {
                let (slot, generation) = self.parts();
                let bytes = [slot.to_le_bytes(), generation.to_le_bytes()];
                out.leaf(bytes.as_flattened(), self);
            }
        }

        impl Read for $handle {
            fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
                Ok(Self::from_parts(u32::read(reader)?, u32::read(reader)?))
            }
        }
    )* };
}

codec_handles!(BodyId FieldId ColliderId JointId);

impl Write for TimeStep {
    fn write(&self, out: &mut impl Encoder) {
        let (num, den) = self.seconds();
        field(out, "num", &num);
        field(out, "den", &den);
    }
}

impl Read for TimeStep {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        let malformed = reader.malformed("a time step in lowest terms");
        let written = (u32::read(reader)?, u32::read(reader)?);
        let step = Self::ratio(written.0, written.1);
        // Each has one form: equal worlds have equal bytes.
        if step.seconds() == written { Ok(step) } else { Err(malformed) }
    }
}

impl Write for Elapsed {
    fn write(&self, out: &mut impl Encoder) {
        field(out, "num", &self.num);
        field(out, "den", &self.den);
    }
}

impl Read for Elapsed {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        let malformed = reader.malformed("a time in lowest terms");
        let time = Self { num: u128::read(reader)?, den: u128::read(reader)? };
        if time.den != 0 && time == time.reduced() { Ok(time) } else { Err(malformed) }
    }
}

impl Write for Random {
    fn write(&self, out: &mut impl Encoder) {
        let bytes = self.state().map(u64::to_le_bytes);
        let [a, b, c, d] = self.state();
        out.leaf(bytes.as_flattened(), &format_args!("{a:016x} {b:016x} {c:016x} {d:016x}"));
    }
}

impl Read for Random {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        let malformed = reader.malformed("a state of the generator");
        Self::from_state(reader.words()?).ok_or(malformed)
    }
}

/// Bytes of the caller, after their number.
impl Write for Vec<u8> {
    fn write(&self, out: &mut impl Encoder) {
        count(out, self.len());
        // In pieces, so that an index can name them.
        for (i, piece) in self.chunks(64).enumerate() {
            out.enter(Part::Entry(i as u32));
            out.bytes(piece);
            out.leave();
        }
    }
}

impl Read for Vec<u8> {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        let count = reader.count(1)?;
        reader.take(count).map(<[u8]>::to_vec)
    }
}
