//! Values as bytes for a hash: little-endian whatever the machine, without padding, each list after its length.

use xxhash_rust::xxh3::Xxh3;

use crate::handle::BodyId;
use crate::math::Vec2;
use crate::scalar::Scalar;

/// Where the bytes go: XXH3, 64 bits (Collet).
pub(crate) struct Sink(Xxh3);

impl Sink {
    pub(crate) fn new() -> Self {
        Self(Xxh3::new())
    }

    pub(crate) fn finish(&self) -> u64 {
        self.0.digest()
    }

    pub(crate) fn u8(&mut self, value: u8) {
        self.0.update(&[value]);
    }

    pub(crate) fn u32(&mut self, value: u32) {
        self.0.update(&value.to_le_bytes());
    }

    pub(crate) fn u64(&mut self, value: u64) {
        self.0.update(&value.to_le_bytes());
    }

    pub(crate) fn i128(&mut self, value: i128) {
        self.0.update(&value.to_le_bytes());
    }

    pub(crate) fn u128(&mut self, value: u128) {
        self.0.update(&value.to_le_bytes());
    }

    /// The length of what follows; no list has 2^32 entries.
    pub(crate) fn count(&mut self, count: usize) {
        self.u32(count as u32);
    }

    pub(crate) fn scalar<S: Scalar>(&mut self, value: S) {
        self.0.update(&value.to_bits().to_le_bytes());
    }

    pub(crate) fn vector<S: Scalar>(&mut self, value: Vec2<S>) {
        self.scalar(value.x);
        self.scalar(value.y);
    }

    pub(crate) fn option<T>(&mut self, value: Option<T>, write: impl FnOnce(&mut Self, T)) {
        self.u8(u8::from(value.is_some()));
        if let Some(value) = value {
            write(self, value);
        }
    }

    pub(crate) fn id(&mut self, id: BodyId) {
        let (slot, generation) = id.parts();
        self.u32(slot);
        self.u32(generation);
    }

    /// Many values at once, each as so many bytes. Hashing takes larger pieces than one value faster.
    pub(crate) fn all<T: Copy, const BYTES: usize>(&mut self, values: &[T], bytes: impl Fn(T) -> [u8; BYTES]) {
        const PIECE: usize = 64;
        let mut piece = [[0; BYTES]; PIECE];
        for values in values.chunks(PIECE) {
            for (to, value) in piece.iter_mut().zip(values) {
                *to = bytes(*value);
            }
            self.0.update(piece[..values.len()].as_flattened());
        }
    }
}
