//! Sensors: which colliders overlap them at the end of a step, and which crossed them within it.
//!
//! A sensor and a collider of another body overlap if their filters agree, one of the two bodies is not static, both take part, and the
//! shapes have a point in common: exactly, by the geometry of queries. Sensors do not see each other.
//!
//! A pair that does not overlap then *crosses* in the step if one of the two bodies is fast and the outlines overlap by a micrometre on the
//! paths of continuous collision: from the start, to where impulses left the bodies or to where their paths ended. A body is fast as it is
//! there, by the least width of its colliders; one that has sensors, also by theirs.
//!
//! Time and memory are bounded by the numbers of sensors and of moving colliders, and by the pairs of outlines whose boxes overlap, pairs
//! included that filters reject. If these are more than a world may have, the sensors with the most pairs find nothing: a function of the
//! boxes and the filters alone.
//!
//! Moving colliders search the tree of sensors; sensors search the trees of colliders that stand still. Overlaps are kept, so that sleeping
//! bodies out of reach cost nothing.

use alloc::vec::Vec;
use core::ops::Range;
use core::slice::from_ref;

use super::pipeline::Pipeline;
use super::sweep::{Paths, around, form, resting};
use super::{ContactBodies, pair_limits};
use crate::body::{Activity, BodyKind};
use crate::codec::{self, Encoder, Malformed, Read, Reader, Write};
use crate::collide::broad::{PairLimits, Proxy, Statics};
use crate::collide::sweep::{Moment, Path, Second, Sweep};
use crate::collider::{Collider, ColliderSet, ContactSettings, OutlineId};
use crate::fx::Fx;
use crate::query::{Core, Placement, Sum, beside, contains, in_fx};
use crate::scalar::FxAccumulator;
use crate::shape::Aabb;
use crate::slots::{BodyId, NONE};

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

/// An outline at the pose of its body: the box of its exact shape, or of a fast body's path, and the state of its body.
#[derive(Clone, Copy, Debug)]
struct PlacedOutline {
    outline: OutlineId,
    body: u32,
    bounds: Aabb,
    kind: BodyKind,
    activity: Activity,
}

/// The path of a fast body over the step, by its slot.
type BodyPath = (u32, Path);

/// Reused memory for sensors.
#[derive(Debug, Default)]
pub(crate) struct Sensors {
    /// The slots of the sensors, and the revision of the colliders that they are of.
    slots: Vec<u32>,
    revision: Option<u64>,
    /// The outlines of sensors that take part, and the outlines that are no sensors, of bodies that a step moves.
    sensors: Vec<PlacedOutline>,
    movers: Vec<PlacedOutline>,
    /// One of the two lists in a tree, by index in the list: the sensors, as long as there are few pairs.
    tree: Statics,
    proxies: Vec<Proxy>,
    /// Sensors, by their index, with outlines whose boxes overlap theirs.
    pairs: Vec<(u32, OutlineId)>,
    /// The number of pairs of each sensor; and for each such number, the total of the pairs of the sensors that have as many.
    degrees: Vec<u32>,
    sums: Vec<usize>,
    sum: Sum,
    /// The distances at the moments of one pair's paths.
    moment: Moment,
    /// The paths of fast bodies, sorted by slot.
    paths: Vec<BodyPath>,
    /// The overlaps at the end of the step; sorted, each once.
    pub(crate) overlaps: Vec<Overlap>,
    /// The pairs that do not overlap then and did in the step; sorted, each once.
    pub(crate) crossed: Vec<Overlap>,
}

/// The parts of a world that sensors look at.
struct View<'a> {
    bodies: &'a dyn ContactBodies,
    colliders: &'a ColliderSet,
    pipeline: &'a Pipeline,
    paths: &'a [BodyPath],
}

impl View<'_> {
    /// The path of the body in a slot, if it is fast.
    fn path(&self, slot: u32) -> Option<&Path> {
        let index = self.paths.binary_search_by_key(&slot, |(slot, _)| *slot).ok()?;
        Some(&self.paths[index].1)
    }

    /// Returns true if two outlines overlap on the paths of their bodies, of which one at least is fast.
    fn is_crossed(&self, outlines: [(&Collider, u32); 2], moment: &mut Moment) -> bool {
        let paths = outlines.map(|(collider, _)| self.path(collider.body.slot));
        if paths.iter().all(Option::is_none) {
            return false;
        }
        let resting_legs = outlines.map(|(collider, _)| {
            let dense = self.bodies.index_of(collider.body).unwrap_or(0);
            resting(self.bodies.position(dense), self.bodies.angle(dense))
        });
        // A sensor has no side.
        let shapes = outlines.map(|(collider, part)| collider.outline(part));
        let forms = [0, 1].map(|side: usize| form(outlines[side].0, &shapes[side]).without_sides());
        let paths = [0, 1].map(|side: usize| paths[side].map_or(from_ref(&resting_legs[side]), Path::legs));
        let sweep = Sweep { forms: [&forms[0], &forms[1]], paths, second: Second::GivesWay };
        sweep.first_touch(moment).is_some()
    }

    /// The place of the body of a collider, its kind and its activity, if it takes part.
    fn place(&self, collider: &Collider) -> Option<(Placement<Fx>, BodyKind, Activity)> {
        let dense = self.bodies.index_of(collider.body)?;
        let activity = self.bodies.activity(dense);
        if !matches!(activity, Activity::Awake | Activity::Asleep) {
            return None;
        }
        let position = self.bodies.position(dense).map(FxAccumulator::value);
        let placement = Placement::new(position, self.bodies.angle(dense));
        Some((placement, self.bodies.contact_info(dense).kind, activity))
    }

    /// These outlines of a collider, if its body takes part.
    fn outlines<'a>(&'a self, collider: &'a Collider, parts: Range<u32>) -> impl Iterator<Item = PlacedOutline> + 'a {
        let place = self.place(collider).into_iter();
        place.flat_map(move |(placement, kind, activity)| {
            parts.clone().filter_map(move |part| {
                let from = placement.position();
                let core = Core::new(&collider.outline(part).outline, &placement, from)?;
                let outline = OutlineId { slot: collider.slot, part };
                let bounds = match self.path(collider.body.slot) {
                    Some(path) => around(path.legs(), collider.outline(part).radius.to_bits()),
                    None => {
                        let [min, max] = core.bounds().map(|corner| in_fx(beside(from, corner)));
                        Aabb { min, max }
                    }
                };
                Some(PlacedOutline { outline, body: collider.body.slot, bounds, kind, activity })
            })
        })
    }

    /// The proxy of an outline with this number in the tree, or with [`NONE`] one to search a tree with.
    fn proxy(&self, number: u32, placed: &PlacedOutline) -> Option<Proxy> {
        let filter = self.colliders.at(placed.outline.slot)?.def.filter;
        Some(Proxy { collider: number, body: placed.body, bounds: placed.bounds, filter, digest: 0 })
    }

    /// Calls `visit` with each outline at rest near a sensor, and with whether it makes a pair, until it returns false: with outlines of
    /// sleeping bodies, and for a sensor that is not static with outlines of static bodies. In the trees they have larger boxes, so that the
    /// box of each is tested.
    fn standing(&self, sensor: &PlacedOutline, proxy: &Proxy, mut visit: impl FnMut(OutlineId, bool) -> bool) {
        let mut goes_on = true;
        let sleepers = self.pipeline.sleepers(self.colliders);
        let statics = self.pipeline.statics(self.colliders);
        let statics = statics.map(|statics| &**statics).filter(|_| sensor.kind != BodyKind::Static);
        for (tree, state) in [(sleepers, Activity::Asleep), (statics, Activity::Awake)] {
            let Some(tree) = tree.filter(|tree| goes_on && !tree.is_empty()) else { continue };
            tree.touching(proxy, |visitor, may_meet| {
                let outline = self.pipeline.outline(visitor.collider);
                let collider = self.colliders.at(outline.slot).filter(|_| may_meet);
                let parts = outline.part..outline.part + 1;
                let mut placed = collider.into_iter().flat_map(|collider| self.outlines(collider, parts.clone()));
                let is_pair = placed.any(|placed| placed.activity == state && placed.bounds.overlaps(proxy.bounds));
                goes_on = visit(outline, is_pair);
                goes_on
            });
        }
    }
}

impl Sensors {
    /// Forgets which sensors there are.
    pub(crate) fn forget(&mut self) {
        self.revision = None;
    }

    /// Forgets the paths of the step before.
    pub(crate) fn begin(&mut self) {
        self.paths.clear();
    }

    fn list_sensors(&mut self, colliders: &ColliderSet) {
        if self.revision != Some(colliders.revision()) {
            self.revision = Some(colliders.revision());
            self.slots.clear();
            self.slots
                .extend(colliders.list().filter(|collider| collider.def.is_sensing()).map(|collider| collider.slot));
        }
    }

    /// Keeps the paths of fast bodies. `pipeline` ended them, and `paths` has the bodies then.
    pub(crate) fn follow(&mut self, paths: &Paths<'_>, pipeline: &Pipeline) {
        self.list_sensors(paths.scene.colliders);
        self.paths.clear();
        if self.slots.is_empty() {
            return;
        }
        pipeline.each_fast_path(paths, |slot, path| self.paths.push((slot, path)));
        for &slot in &self.slots {
            let Some(sensor) = paths.scene.colliders.at(slot) else { continue };
            let path = pipeline.path_if_fast(paths, sensor);
            self.paths.extend(path.map(|path| (sensor.body.slot, path)));
        }
        // Paths of one body are the same.
        self.paths.sort_unstable_by_key(|(slot, _)| *slot);
        self.paths.dedup_by_key(|(slot, _)| *slot);
    }

    /// Finds all overlaps of sensors; `pipeline` found the contacts of the step, in which the bodies of `fell_asleep` did so.
    pub(crate) fn find(
        &mut self,
        bodies: &dyn ContactBodies,
        colliders: &ColliderSet,
        pipeline: &Pipeline,
        fell_asleep: &[BodyId],
        settings: &ContactSettings,
    ) {
        self.list_sensors(colliders);
        self.overlaps.clear();
        self.crossed.clear();
        let paths = core::mem::take(&mut self.paths);
        self.find_all(&View { bodies, colliders, pipeline, paths: &paths }, fell_asleep, settings);
        self.paths = paths;
    }

    fn find_all(&mut self, view: &View<'_>, fell_asleep: &[BodyId], settings: &ContactSettings) {
        let bodies = view.bodies;
        let colliders = view.colliders;
        self.sensors.clear();
        let sensors = self.slots.iter().filter_map(|&slot| colliders.at(slot));
        self.sensors.extend(sensors.flat_map(|collider| view.outlines(collider, 0..collider.outline_count())));
        self.movers.clear();
        if self.sensors.is_empty() {
            return;
        }
        let moving = (0..bodies.moving()).map(|dense| bodies.id(dense).slot);
        for slot in moving.chain(fell_asleep.iter().map(|body| body.slot)) {
            self.movers.extend(
                colliders.solid_of_slot(slot).flat_map(|collider| view.outlines(collider, 0..collider.outline_count())),
            );
        }
        let limits = pair_limits(settings, colliders);
        let overlaps = self.pair_all(view, &limits);
        if overlaps > limits.overlaps || self.pairs.len() > limits.pairs {
            self.pair_fewest(view, &limits, overlaps > limits.overlaps);
        }
        self.meet(view);
    }

    /// Puts outlines into the tree, by their index in the list.
    fn fill_tree(&mut self, view: &View<'_>, are_sensors: bool) {
        let list = if are_sensors { &self.sensors } else { &self.movers };
        self.proxies.clear();
        self.proxies.extend((0..).zip(list).filter_map(|(number, placed)| view.proxy(number, placed)));
        if !self.tree.are(&self.proxies) {
            self.tree.refill(&self.proxies);
        }
    }

    /// Lists the pairs of sensors and outlines whose boxes overlap, up to one more than there may be. Returns the number of overlaps,
    /// overlaps included that filters reject, up to one more than there may be.
    fn pair_all(&mut self, view: &View<'_>, limits: &PairLimits) -> usize {
        self.fill_tree(view, true);
        let Self { sensors, movers, tree, pairs, .. } = self;
        pairs.clear();
        let mut overlaps = 0;
        let mut add = |sensor: u32, outline: OutlineId, is_pair: bool| {
            if is_pair && pairs.len() <= limits.pairs {
                pairs.push((sensor, outline));
            }
            overlaps += 1;
            overlaps <= limits.overlaps
        };
        let mut goes_on = true;
        for mover in &*movers {
            let Some(proxy) = view.proxy(NONE, mover).filter(|_| goes_on) else { continue };
            tree.touching(&proxy, |sensor, is_pair| {
                goes_on = add(sensor.collider, mover.outline, is_pair);
                goes_on
            });
        }
        for (number, sensor) in (0..).zip(&*sensors) {
            let Some(proxy) = view.proxy(NONE, sensor).filter(|_| goes_on) else { continue };
            view.standing(sensor, &proxy, |outline, is_pair| {
                goes_on = add(number, outline, is_pair);
                goes_on
            });
        }
        overlaps
    }

    /// Lists the pairs of the sensors that have the fewest: of all sensors with up to the number of pairs that one collider may have, or up
    /// to the largest number at which all pairs fit. It counts no pairs of a sensor beyond the first number. With `are_rejected_counted`, overlaps
    /// that filters reject count as pairs do.
    #[cold]
    fn pair_fewest(&mut self, view: &View<'_>, limits: &PairLimits, are_rejected_counted: bool) {
        self.fill_tree(view, false);
        let per_sensor = limits.per_collider as u32;
        let Self { sensors, movers, tree, pairs, degrees, sums, .. } = self;
        let visit_all = |number: usize, visit: &mut dyn FnMut(OutlineId, bool) -> bool| {
            let Some(proxy) = view.proxy(NONE, &sensors[number]) else { return };
            let mut goes_on = true;
            tree.touching(&proxy, |mover, is_pair| {
                goes_on = visit(movers[mover.collider as usize].outline, is_pair);
                goes_on
            });
            if goes_on {
                view.standing(&sensors[number], &proxy, visit);
            }
        };
        degrees.clear();
        sums.clear();
        sums.resize(per_sensor as usize + 1, 0);
        for number in 0..sensors.len() {
            let mut degree = 0;
            visit_all(number, &mut |_, is_pair| {
                degree += u32::from(is_pair || are_rejected_counted);
                degree <= per_sensor
            });
            degrees.push(degree);
            if let Some(sum) = sums.get_mut(degree as usize) {
                *sum += degree as usize;
            }
        }
        let mut total = 0;
        let fitting = sums.iter().take_while(|&&pairs| {
            total += pairs;
            total <= limits.pairs
        });
        // Sensors without pairs always fit.
        let cap = (fitting.count() as u32).saturating_sub(1);
        pairs.clear();
        for number in (0..sensors.len()).filter(|&number| degrees[number] <= cap) {
            visit_all(number, &mut |outline, is_pair| {
                if is_pair {
                    pairs.push((number as u32, outline));
                }
                true
            });
        }
    }

    /// Finds which pairs overlap at the end of the step, and which other pairs overlap within it.
    fn meet(&mut self, view: &View<'_>) {
        let Self { sensors, pairs, sum, moment, overlaps, crossed, .. } = self;
        pairs.sort_unstable();
        for sensor_pairs in pairs.chunk_by(|a, b| a.0 == b.0) {
            let outline = sensors[sensor_pairs[0].0 as usize].outline;
            let Some(sensor) = view.colliders.at(outline.slot) else { continue };
            let Some((placement, ..)) = view.place(sensor) else { continue };
            let from = placement.position();
            let Some(sensor_core) = Core::new(&sensor.outline(outline.part).outline, &placement, from) else {
                continue;
            };
            for (_, visitor) in sensor_pairs {
                let overlap = Overlap { sensor: outline.slot, visitor: visitor.slot };
                let Some(collider) = view.colliders.at(visitor.slot).filter(|_| overlaps.last() != Some(&overlap))
                else {
                    continue;
                };
                let Some((placement, ..)) = view.place(collider) else { continue };
                let Some(visitor_core) = Core::new(&collider.outline(visitor.part).outline, &placement, from) else {
                    continue;
                };
                sum.set(&sensor_core, &visitor_core);
                if contains(&sum.core) {
                    overlaps.push(overlap);
                } else if crossed.last() != Some(&overlap)
                    && view.is_crossed([(sensor, outline.part), (collider, visitor.part)], moment)
                {
                    crossed.push(overlap);
                }
            }
        }
        overlaps.sort_unstable();
        overlaps.dedup();
        crossed.sort_unstable();
        crossed.dedup();
        crossed.retain(|overlap| overlaps.binary_search(overlap).is_err());
    }
}
