//! The hash of a world's state: over a canonical sequence of little-endian bytes, the same on every machine.

use xxhash_rust::xxh3::Xxh3;

use super::LAW;
use crate::body::{Activity, BodyKind, Card, Mass};
use crate::force::{Attachment, End, Field, Law, Region};
use crate::handle::BodyId;
use crate::math::Vec2;
use crate::scalar::{Accumulator, Angle, Factor, Scalar, Sum, Wide};
use crate::shape::{Geometry, Shape};
use crate::world::World;

/// Where the bytes go.
struct Sink(Xxh3);

impl Sink {
    fn u8(&mut self, value: u8) {
        self.0.update(&[value]);
    }
    fn u32(&mut self, value: u32) {
        self.0.update(&value.to_le_bytes());
    }
    fn u64(&mut self, value: u64) {
        self.0.update(&value.to_le_bytes());
    }
    fn i128(&mut self, value: i128) {
        self.0.update(&value.to_le_bytes());
    }
    fn u128(&mut self, value: u128) {
        self.0.update(&value.to_le_bytes());
    }
    /// The length of what follows; no list has 2^32 entries.
    fn count(&mut self, count: usize) {
        self.u32(count as u32);
    }
    fn slots(&mut self, slots: &[u32]) {
        self.count(slots.len());
        slots.iter().for_each(|&slot| self.u32(slot));
    }
    fn scalar<S: Scalar>(&mut self, value: S) {
        self.0.update(&value.to_bits().to_le_bytes());
    }
    fn vector<S: Scalar>(&mut self, value: Vec2<S>) {
        self.scalar(value.x);
        self.scalar(value.y);
    }
    fn option<T>(&mut self, value: Option<T>, write: impl FnOnce(&mut Self, T)) {
        self.u8(u8::from(value.is_some()));
        if let Some(value) = value {
            write(self, value);
        }
    }
    fn id(&mut self, id: BodyId) {
        let (slot, generation) = id.parts();
        self.u32(slot);
        self.u32(generation);
    }
    fn attachment<S: Scalar>(&mut self, at: &Attachment<S>) {
        self.id(at.body);
        self.vector(at.point);
    }
    fn end<S: Scalar>(&mut self, end: &End<S>) {
        match end {
            End::World(point) => {
                self.u8(0);
                self.vector(*point);
            }
            End::Body(at) => {
                self.u8(1);
                self.attachment(at);
            }
        }
    }

    fn shape<S: Scalar>(&mut self, shape: &Shape<S>) {
        self.vector(shape.shift());
        match shape.geometry() {
            Geometry::Circle { radius } => {
                self.u8(0);
                self.scalar(*radius);
            }
            Geometry::Rectangle { width, height } => {
                self.u8(1);
                self.scalar(*width);
                self.scalar(*height);
            }
            Geometry::Capsule { length, radius } => {
                self.u8(2);
                self.scalar(*length);
                self.scalar(*radius);
            }
            Geometry::Polygon { corners } => {
                self.u8(3);
                self.count(corners.len());
                corners.iter().for_each(|&corner| self.vector(corner));
            }
            Geometry::Segment { ends } => {
                self.u8(4);
                ends.iter().for_each(|&end| self.vector(end));
            }
            Geometry::Compound { parts } => {
                self.u8(5);
                self.count(parts.len());
                for part in parts.iter() {
                    self.shape(&part.shape);
                    self.vector(part.position);
                    self.scalar(part.angle);
                    self.scalar(part.density);
                }
            }
        }
    }

    fn card<S: Scalar>(&mut self, card: &Card<S>) {
        self.u8(match card.kind {
            BodyKind::Static => 0,
            BodyKind::Kinematic => 1,
            BodyKind::Dynamic => 2,
        });
        self.u8(match card.activity {
            Activity::Awake => 0,
            Activity::Asleep => 1,
            Activity::Quarantined => 2,
        });
        self.u32(card.groups);
        self.u64(card.key);
        self.u64(card.user_data);
        match card.mass {
            Mass::Density(density) => {
                self.u8(0);
                self.scalar(density);
            }
            Mass::Of(mass) => {
                self.u8(1);
                self.scalar(mass);
            }
            Mass::WithInertia(mass, inertia) => {
                self.u8(2);
                self.scalar(mass);
                self.scalar(inertia);
            }
        }
        self.scalar(card.gravity_scale);
        self.option(card.linear_damping, Self::scalar);
        self.option(card.angular_damping, Self::scalar);
        self.option(card.shape.as_ref(), Self::shape);
    }

    fn field<S: Scalar>(&mut self, field: &Field<S>) {
        self.u32(field.groups);
        match &field.law {
            Law::Attractor { centre, mu, softening } => {
                self.u8(0);
                self.end(centre);
                self.i128(mu.to_bits());
                self.scalar(*softening);
            }
            Law::Spring { near, far, spring } => {
                self.u8(1);
                self.attachment(near);
                self.end(far);
                self.scalar(spring.rest);
                self.scalar(spring.stiffness);
                self.scalar(spring.damping);
            }
            Law::Drag { linear, quadratic, wind } => {
                self.u8(2);
                self.scalar(*linear);
                self.scalar(*quadratic);
                self.vector(*wind);
            }
            Law::Thrust { at, force } => {
                self.u8(3);
                self.attachment(at);
                self.vector(*force);
            }
            Law::Zone { region, acceleration } => {
                self.u8(4);
                match *region {
                    Region::Disc { centre, radius } => {
                        self.u8(0);
                        self.vector(centre);
                        self.scalar(radius);
                    }
                    Region::Box { min, max } => {
                        self.u8(1);
                        self.vector(min);
                        self.vector(max);
                    }
                }
                self.vector(*acceleration);
            }
            Law::Custom { id } => {
                self.u8(5);
                self.u64(*id);
            }
        }
    }
}

impl<S: Scalar> World<S> {
    /// A hash of all that the future depends on, handles included: for peers that carried out the same calls. Equal
    /// worlds have equal hashes whatever the machine; what is derived or cached is not in it.
    ///
    /// *Source* XXH3, 64 bits (Collet).
    #[must_use]
    pub fn state_hash(&self) -> u64 {
        let mut sink = Sink(Xxh3::new());
        sink.u32(LAW);
        self.write_head(&mut sink);
        self.write_bodies(&mut sink);
        let (generations, free) = self.fields.allocator();
        sink.count(generations.len());
        generations.for_each(|generation| sink.u32(generation));
        sink.slots(free);
        for (id, field) in self.fields.iter() {
            sink.u32(id.parts().0);
            sink.field(field);
        }
        sink.count(self.laws.len());
        for law in self.laws.values() {
            sink.u64(law.id());
            sink.u32(law.version());
        }
        sink.0.digest()
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

    fn write_bodies(&self, sink: &mut Sink) {
        let (slots, free) = self.bodies.allocator();
        sink.count(slots.len());
        for (generation, taken) in slots {
            sink.u32(generation);
            sink.u8(u8::from(taken));
        }
        sink.slots(free);
        let columns = &self.bodies.columns;
        for i in self.bodies.in_order() {
            let motion = &columns.motion;
            for component in [motion.position.x[i], motion.position.y[i], motion.velocity.x[i], motion.velocity.y[i]] {
                sink.i128(component.to_bits());
            }
            sink.u64(motion.angle[i].to_bits());
            sink.i128(motion.spin[i].to_bits());
            if let Some(last) = motion.last.get(i) {
                for component in [last.linear.x, last.linear.y, last.angular] {
                    sink.i128(component.to_bits());
                }
            }
            sink.u32(motion.rest[i]);
            sink.card(&columns.card[i]);
            sink.option(self.applied.row(columns.card[i].applied), |sink, row| {
                for sum in [row.force.x, row.force.y, row.torque] {
                    let (low, carries) = sum.to_bits();
                    sink.i128(low);
                    sink.u64(carries as u64);
                }
            });
        }
    }
}
