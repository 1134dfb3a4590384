//! Hashes of values.

use xxhash_rust::xxh3::Xxh3;

use super::encode::{Encoder, Write};

/// The number of values that are handed to the hash at once.
const PIECE: usize = 128;

/// A hash: XXH3, 64 bits (Collet).
pub(crate) struct StateHasher(Xxh3);

impl Encoder for StateHasher {
    #[inline]
    fn bytes(&mut self, bytes: &[u8]) {
        self.0.update(bytes);
    }
}

impl StateHasher {
    pub(crate) fn new() -> Self {
        Self(Xxh3::new())
    }

    pub(crate) fn finish(&self) -> u64 {
        self.0.digest()
    }

    /// Hashes one value.
    pub(crate) fn of(value: &impl Write) -> u64 {
        let mut sink = Self::new();
        value.write(&mut sink);
        sink.finish()
    }

    /// Hashes bytes.
    pub(crate) fn of_bytes(bytes: &[u8]) -> u64 {
        xxhash_rust::xxh3::xxh3_64(bytes)
    }

    /// Hashes many values, each as so many bytes. Larger pieces than one value are hashed faster.
    pub(crate) fn all<T: Copy, const BYTES: usize>(&mut self, values: &[T], bytes: impl Fn(T) -> [u8; BYTES]) {
        let mut piece = [[0; BYTES]; PIECE];
        for values in values.chunks(PIECE) {
            for (to, value) in piece.iter_mut().zip(values) {
                *to = bytes(*value);
            }
            self.0.update(piece[..values.len()].as_flattened());
        }
    }

    /// Hashes many values that do not stand side by side.
    pub(crate) fn each<T, const BYTES: usize>(
        &mut self,
        mut values: impl Iterator<Item = T>,
        bytes: impl Fn(T) -> [u8; BYTES],
    ) {
        let mut piece = [[0; BYTES]; PIECE];
        loop {
            let mut count = 0;
            for (to, value) in piece.iter_mut().zip(&mut values) {
                *to = bytes(value);
                count += 1;
            }
            if count == 0 {
                return;
            }
            self.0.update(piece[..count].as_flattened());
        }
    }
}
