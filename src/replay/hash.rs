//! The hash of a world's state: over a canonical sequence of little-endian bytes, the same on every machine.

use super::LAW;
use crate::digest::Sink;
use crate::scalar::Scalar;
use crate::world::World;

impl<S: Scalar> World<S> {
    /// A hash of all that the future depends on, handles included: for peers that carried out the same calls. Equal
    /// worlds have equal hashes whatever the machine; what is derived or cached is not in it.
    ///
    /// *Source* XXH3, 64 bits (Collet).
    #[must_use]
    pub fn state_hash(&self) -> u64 {
        let mut sink = Sink::new();
        sink.u32(LAW);
        self.write_head(&mut sink);
        self.bodies.write(&mut sink);
        self.applied.write(&mut sink);
        self.fields.write(&mut sink);
        sink.count(self.laws.len());
        for law in self.laws.values() {
            sink.u64(law.id());
            sink.u32(law.version());
        }
        sink.finish()
    }

    fn write_head(&self, sink: &mut Sink) {
        let (num, den) = self.def.time_step.seconds();
        sink.u32(num);
        sink.u32(den);
        sink.vector(self.def.gravity);
        sink.u8(self.def.integrator as u8);
        sink.scalar(self.def.linear_damping);
        sink.scalar(self.def.angular_damping);
        sink.option(self.def.sleep_after, Sink::u32);
        sink.u64(self.tick);
        let elapsed = self.elapsed();
        sink.u128(elapsed.num);
        sink.u128(elapsed.den);
    }
}
