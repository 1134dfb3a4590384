//! The hash of a world's state: over a canonical sequence of little-endian bytes, the same on every machine.

use super::LAW;
use crate::scalar::Scalar;
use crate::wire::{self, Sink, Write as _};
use crate::world::World;

impl<S: Scalar> World<S> {
    /// A hash of all that the future depends on, handles included: for peers that carried out the same calls. Equal
    /// worlds have equal hashes whatever the machine; what is derived or cached is not in it.
    ///
    /// *Source* XXH3, 64 bits (Collet).
    #[must_use]
    pub fn state_hash(&self) -> u64 {
        let mut sink = Sink::new();
        LAW.write(&mut sink);
        self.def.write(&mut sink);
        self.tick.write(&mut sink);
        self.elapsed().write(&mut sink);
        self.random.write(&mut sink);
        self.blob.write(&mut sink);
        self.bodies.write(&mut sink);
        self.applied.write(&mut sink);
        self.fields.write(&mut sink);
        wire::count(&mut sink, self.laws.len());
        for law in self.laws.values() {
            law.id().write(&mut sink);
            law.version().write(&mut sink);
        }
        sink.finish()
    }
}
