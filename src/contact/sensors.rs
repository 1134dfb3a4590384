//! Sensors: which colliders overlap them at the end of a step.
//!
//! A sensor and a collider of another body overlap if their filters agree, one of the two bodies is not static, both take part, and the
//! shapes have a point in common: exactly, by the geometry of queries. Sensors do not see each other.

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::ContactEngine as _;
use crate::body::{Activity, Bodies, BodyKind};
use crate::codec::{self, Encoder, Malformed, Read, Reader, Write};
use crate::collide::broad::Statics;
use crate::collider::{Collider, ColliderSet, OutlineId};
use crate::query::{Core, Placement, Point, Sum, beside, contains, in_scalar};
use crate::scalar::{Accumulator as _, Scalar};
use crate::shape::Aabb;

/// A sensor and a collider that overlaps it, by their slots.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Overlap {
    pub(crate) sensor: u32,
    pub(crate) visitor: u32,
}

// The state is copied with every snapshot.
const _: () = assert!(size_of::<Overlap>() == 8);

impl Overlap {
    /// The slots of both colliders.
    pub(crate) fn slots(self) -> [u32; 2] {
        [self.sensor, self.visitor]
    }
}

impl Write for Overlap {
    fn write(&self, out: &mut impl Encoder) {
        codec::field(out, "sensor", &self.sensor);
        codec::field(out, "visitor", &self.visitor);
    }
}

impl Read for Overlap {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        Ok(Self { sensor: u32::read(reader)?, visitor: u32::read(reader)? })
    }
}

/// The box of an outline of a body that is not static, ulps.
#[derive(Clone, Copy, Debug)]
struct Visitor {
    low: Point,
    high: Point,
    outline: OutlineId,
}

/// Memory that sensors use again.
#[derive(Debug, Default)]
pub(crate) struct Sensors {
    /// The slots of the sensors, and the revision of the colliders that they are of.
    slots: Vec<u32>,
    revision: Option<u64>,
    /// Sorted by their lower end along x.
    visitors: Vec<Visitor>,
    /// The largest extent of a visitor along x.
    widest: i64,
    sum: Sum,
    /// Sorted, each once.
    pub(crate) found: Vec<Overlap>,
}

/// The place of a body that takes part, and its kind.
fn place<S: Scalar>(bodies: &Bodies<S>, collider: &Collider<S>) -> Option<(Placement<S>, BodyKind)> {
    let dense = bodies.find(collider.body).ok()?;
    if !matches!(bodies.activity(dense), Activity::Awake | Activity::Asleep) {
        return None;
    }
    let motion = &bodies.columns.motion;
    let placement = Placement::new(motion.position.get(dense).map(|part| part.value()), motion.angle[dense]);
    Some((placement, bodies.info(dense).kind))
}

impl Sensors {
    /// Forgets which sensors there are.
    pub(crate) fn forget(&mut self) {
        self.revision = None;
    }

    /// Finds all overlaps of sensors; `standing` has the static colliders, and the engine that numbered them.
    pub(crate) fn find<S: Scalar>(
        &mut self,
        bodies: &Bodies<S>,
        colliders: &ColliderSet<S>,
        standing: Option<(&Arc<Statics>, &S::Contacts)>,
    ) {
        self.found.clear();
        if self.revision != Some(colliders.revision()) {
            self.revision = Some(colliders.revision());
            self.slots.clear();
            self.slots.extend(colliders.list().filter(|own| own.def.sensor).map(|own| own.slot));
        }
        self.list_visitors(bodies, colliders);
        for i in 0..self.slots.len() {
            let Some(sensor) = colliders.at(self.slots[i]) else { continue };
            let Some((placement, kind)) = place(bodies, sensor) else { continue };
            let from = placement.position();
            for part in 0..sensor.outline_count() {
                let Some(core) = Core::new(&sensor.outline(part).outline, &placement, from) else { continue };
                let [low, high] = core.bounds().map(|corner| beside(from, corner));
                let first =
                    self.visitors.partition_point(|visitor| visitor.low[0] < low[0].saturating_sub(self.widest));
                for at in first..self.visitors.len() {
                    let visitor = self.visitors[at];
                    if visitor.low[0] > high[0] {
                        break;
                    }
                    let meets = (0..2).all(|axis| visitor.low[axis] <= high[axis] && low[axis] <= visitor.high[axis]);
                    if meets {
                        self.meet(bodies, colliders, (sensor, &core, from), visitor.outline);
                    }
                }
                if let (Some((statics, engine)), false) = (standing, kind == BodyKind::Static) {
                    let bounds = Aabb { min: in_scalar(low), max: in_scalar(high) };
                    statics.search_box(bounds, sensor.def.filter, |number| {
                        self.meet(bodies, colliders, (sensor, &core, from), engine.outline(number));
                        true
                    });
                }
            }
        }
        self.found.sort_unstable();
        self.found.dedup();
    }

    /// Lists the boxes of all that is not static.
    fn list_visitors<S: Scalar>(&mut self, bodies: &Bodies<S>, colliders: &ColliderSet<S>) {
        self.visitors.clear();
        self.widest = 0;
        let moving = bodies.columns.slot[..bodies.moving()].iter().copied();
        let asleep = bodies.any_asleep().then(|| bodies.asleep()).into_iter().flatten();
        for slot in moving.chain(asleep.map(|dense| bodies.columns.slot[dense])) {
            for collider in colliders.solid_of_slot(slot) {
                let Some((placement, _)) = place(bodies, collider) else { continue };
                let from = placement.position();
                for part in 0..collider.outline_count() {
                    let Some(core) = Core::new(&collider.outline(part).outline, &placement, from) else { continue };
                    let [low, high] = core.bounds().map(|corner| beside(from, corner));
                    self.widest = self.widest.max(high[0].saturating_sub(low[0]));
                    self.visitors.push(Visitor { low, high, outline: OutlineId { slot: collider.slot, part } });
                }
            }
        }
        self.visitors.sort_unstable_by_key(|visitor| visitor.low[0]);
    }

    /// Adds an overlap, if an outline overlaps the core of a sensor.
    fn meet<S: Scalar>(
        &mut self,
        bodies: &Bodies<S>,
        colliders: &ColliderSet<S>,
        (sensor, core, from): (&Collider<S>, &Core, Point),
        outline: OutlineId,
    ) {
        let Some(other) = colliders.at(outline.slot) else { return };
        let overlap = Overlap { sensor: sensor.slot, visitor: other.slot };
        if other.body == sensor.body
            || !sensor.def.filter.agrees(other.def.filter)
            || self.found.last() == Some(&overlap)
        {
            return;
        }
        let Some((placement, _)) = place(bodies, other) else { return };
        let Some(own) = Core::new(&other.outline(outline.part).outline, &placement, from) else { return };
        self.sum.set(core, &own);
        if contains(&self.sum.core) {
            self.found.push(overlap);
        }
    }
}
