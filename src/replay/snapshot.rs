//! Snapshots: a world to come back to, in memory or as bytes.

use alloc::collections::BTreeSet;
use alloc::collections::btree_map::{BTreeMap, Entry};
use alloc::sync::Arc;
use alloc::vec::Vec;
use core::fmt;

use super::PHYSICS_VERSION;
use super::difference::Owner;
use super::error::SnapshotError;
use crate::body::{Activity, Bodies, BodyKind, FactorTable, KinematicTarget, Record, ShapeSource, check_position};
use crate::codec::{self, Encoder, Malformed, Part, Read, Reader, StateHasher, Write};
use crate::error::Error;
use crate::force::{CustomForce, CustomForces, FieldSet, ForceField};
use crate::integrate::Integrator;
use crate::limits;
use crate::math::{Elapsed, Random, Vec2};
use crate::scalar::{FxSum, Scalar, fx::Fx};
use crate::shape::Shape;
use crate::slots::{BodyId, FieldId};
use crate::world::{ChangeLog, World, WorldDef};

/// The first bytes of a snapshot.
const MAGIC: [u8; 8] = *b"UMBRASNP";
/// The number of the format, in the second four bytes after them. It moves when the layout does.
const FORMAT: u32 = 3;

/// A world as it was: to go back to, to send, to keep.
///
/// In memory it costs a copy of what steps change, 117 bytes a body (165 with
/// [`PublishedVerlet`](crate::Integrator::PublishedVerlet)); all else is shared until the world changes it. As bytes it is the
/// same on every machine. There a body with a circle takes 151 to 196 bytes, by how many of its options are set. It takes 48
/// more with `PublishedVerlet`, 72 more if a force waits for the next step, and 8 more if a call woke it since the last one:
/// at most 324 bytes. A kinematic body with a goal takes 26 more.
///
/// A world that is restored is that world: it has the same hash, handles and future, in another process or on another
/// machine as well. Read from bytes its reports start anew, but for the bodies that calls had woken. What was made after the snapshot is
/// gone with it: a handle from that abandoned future may come to name another body.
///
/// ```
/// use umbra_physics::{BodyDef, Snapshot, World, WorldDef, vec2};
///
/// let mut world: World = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
/// let ball = world.add_body(BodyDef::dynamic())?;
/// let saved = world.snapshot();
/// for _ in 0..60 {
///     world.step();
/// }
/// let after = world.state_hash();
///
/// world.restore(&saved);
/// for _ in 0..60 {
///     world.step();
/// }
/// assert_eq!(world.state_hash(), after);
///
/// // The same over the network or from a file.
/// let bytes = saved.to_bytes();
/// let mut there = Snapshot::from_bytes(&bytes, &[])?.into_world();
/// for _ in 0..60 {
///     there.step();
/// }
/// assert_eq!(there.state_hash(), after);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Snapshot<S: Scalar = Fx> {
    world: World<S>,
}

clone_by_field!(Snapshot { world });

impl<S: Scalar> fmt::Debug for Snapshot<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Snapshot").field(&self.world).finish()
    }
}

impl<S: Scalar> World<S> {
    /// The world as it is, to go back to.
    #[must_use]
    pub fn snapshot(&self) -> Snapshot<S> {
        Snapshot { world: self.clone() }
    }

    /// The same in the memory another snapshot has.
    pub fn snapshot_into(&self, snapshot: &mut Snapshot<S>) {
        snapshot.world.keep(self);
    }

    /// Goes back to a snapshot, of this world or another.
    pub fn restore(&mut self, snapshot: &Snapshot<S>) {
        self.clone_from(&snapshot.world);
    }
}

impl<S: Scalar> Snapshot<S> {
    /// The world as it was.
    #[must_use]
    pub fn world(&self) -> &World<S> {
        &self.world
    }

    /// The world as it was, to go on with.
    #[must_use]
    pub fn into_world(self) -> World<S> {
        self.world
    }
}

impl Snapshot {
    /// As bytes, the same on every machine; `docs/formats.md` has them one by one.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.write_to(&mut bytes);
        bytes
    }

    /// Puts the bytes at the end of a buffer.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, Snapshot, World, WorldDef};
    ///
    /// let mut world: World = World::new(WorldDef::default())?;
    /// world.add_body(BodyDef::dynamic())?;
    /// let mut message = b"state: ".to_vec();
    /// world.snapshot().write_to(&mut message);
    /// let there = Snapshot::from_bytes(&message[7..], &[])?.into_world();
    /// assert_eq!(there.state_hash(), world.state_hash());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn write_to(&self, bytes: &mut Vec<u8>) {
        Saved(&self.world).write(bytes);
    }

    /// The snapshot that is these bytes, of a world in which these laws of force may act.
    ///
    /// Nothing is believed: what no world can be is refused, however the bytes came about. Reading takes at most 16 bytes of
    /// memory for each of theirs and 64 KiB, the snapshot included, so that a limit on their number is one on both.
    ///
    /// # Errors
    /// A [`SnapshotError`].
    pub fn from_bytes(bytes: &[u8], custom_forces: &[Arc<dyn CustomForce>]) -> Result<Self, SnapshotError> {
        let mut reader = Reader::new(bytes);
        let world = read(&mut reader, custom_forces)?;
        reader.end()?;
        Ok(Self { world })
    }
}

/// A world as the bytes of a snapshot.
pub(super) struct Saved<'a, S: Scalar>(pub(super) &'a World<S>);

impl<S: Scalar> Write for Saved<'_, S> {
    fn write(&self, out: &mut impl Encoder) {
        let unsealed = Unsealed(self.0);
        unsealed.write(out);
        codec::field(out, "seal", &StateHasher::of(&unsealed));
    }
}

struct Unsealed<'a, S: Scalar>(&'a World<S>);

impl<S: Scalar> Write for Unsealed<'_, S> {
    fn write(&self, out: &mut impl Encoder) {
        out.enter(Part::Name("magic"));
        out.bytes(&MAGIC);
        out.leave();
        codec::field(out, "format", &FORMAT);
        codec::field(out, "law", &PHYSICS_VERSION);
        State(self.0).write(out);
        codec::field(out, "hash", &self.0.state_hash());
    }
}

/// All that the future of a world depends on, body by body.
pub(super) struct State<'a, S: Scalar>(pub(super) &'a World<S>);

impl<S: Scalar> Write for State<'_, S> {
    fn write(&self, out: &mut impl Encoder) {
        let world = self.0;
        codec::field(out, "settings", &world.def);
        codec::field(out, "tick", &world.tick);
        let (elapsed, since) = &world.counted;
        codec::field(out, "elapsed", elapsed);
        codec::field(out, "elapsed_at_tick", since);
        codec::field(out, "moved_at_tick", &world.targets.moved_at);
        codec::field(out, "random", &world.random);
        codec::field(out, "blob", &world.blob);
        part(out, "laws", |out| {
            codec::count(out, world.custom_forces.len());
            for (i, law) in world.custom_forces.values().enumerate() {
                entry(out, i, |out| {
                    codec::field(out, "id", &law.id());
                    codec::field(out, "version", &law.version());
                });
            }
        });
        part(out, "bodies", |out| self.write_bodies(out));
        part(out, "free_slots", |out| codec::list(out, world.bodies.free().iter()));
        part(out, "fields", |out| {
            codec::count(out, world.fields.slots().len());
            for (slot, (generation, field)) in world.fields.slots().enumerate() {
                entry(out, slot, |out| {
                    codec::field(out, "generation", &generation);
                    codec::field(out, "field", &field.copied());
                });
            }
        });
        part(out, "free_fields", |out| codec::list(out, world.fields.free().iter()));
        part(out, "fields_by_age", |out| codec::list(out, world.fields.ages().iter()));
        part(out, "woken", |out| codec::list(out, world.change_log.woken().iter()));
    }
}

impl<S: Scalar> State<'_, S> {
    fn write_bodies(&self, out: &mut impl Encoder) {
        let world = self.0;
        let mut sources = Sources::default();
        codec::count(out, world.bodies.slots().len());
        for (slot, (generation, dense)) in world.bodies.slots().enumerate() {
            entry(out, slot, |out| {
                codec::field(out, "generation", &generation);
                codec::field(out, "present", &dense.is_some());
                let Some(dense) = dense else { return };
                world.bodies.record(dense, &world.factor_table).write(out);
                codec::field(out, "shape", &sources.name(slot as u32, &world.bodies.info(dense).shape));
                let row = world.applied.row(BodyId::from_parts(slot as u32, generation));
                codec::field(out, "applied", &row.map(|row| Pushed::<S> { force: row.force, torque: row.torque }));
                codec::field(out, "errand", &world.targets.of(BodyId::from_parts(slot as u32, generation)).copied());
            });
        }
    }
}

/// The shapes of the bodies so far, and the slot of the first that has each.
struct Sources<S: Scalar>(BTreeMap<*const Shape<S>, u32>);

impl<S: Scalar> Default for Sources<S> {
    fn default() -> Self {
        Self(BTreeMap::new())
    }
}

impl<S: Scalar> Sources<S> {
    /// How the shape of the body in this slot is written.
    fn name(&mut self, slot: u32, shape: &Option<Arc<Shape<S>>>) -> ShapeSource<S> {
        let Some(shape) = shape else { return ShapeSource::None };
        // Shapes that are alike are one in memory. Where that is decides nothing.
        match self.0.entry(Arc::as_ptr(shape)) {
            Entry::Occupied(first) => ShapeSource::AsOf(*first.get()),
            Entry::Vacant(place) => {
                place.insert(slot);
                ShapeSource::New(shape.clone())
            }
        }
    }
}

fn part<O: Encoder>(out: &mut O, name: &'static str, write: impl FnOnce(&mut O)) {
    out.enter(Part::Name(name));
    write(out);
    out.leave();
}

fn entry<O: Encoder>(out: &mut O, index: usize, write: impl FnOnce(&mut O)) {
    out.enter(Part::Entry(index as u32));
    write(out);
    out.leave();
}

/// The sums of what was applied to a body since the last step.
struct Pushed<S: Scalar> {
    force: Vec2<S::Sum>,
    torque: S::Sum,
}

impl<S: Scalar> Write for Pushed<S> {
    fn write(&self, out: &mut impl Encoder) {
        codec::field(out, "force", &self.force);
        codec::field(out, "torque", &self.torque);
    }
}

impl Read for Pushed<Fx> {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        Ok(Self { force: Vec2::read(reader)?, torque: FxSum::read(reader)? })
    }
}

/// Reads a snapshot, and what may come after it is left.
pub(super) fn read(reader: &mut Reader<'_>, custom_forces: &[Arc<dyn CustomForce>]) -> Result<World, SnapshotError> {
    let start = reader.at();
    let world = read_world(reader, custom_forces)?;
    let (recorded, computed) = (u64::read(reader)?, world.state_hash());
    if recorded != computed {
        return Err(SnapshotError::Changed { recorded, computed });
    }
    let malformed = reader.malformed("the hash of the bytes before it");
    let seal = StateHasher::of_bytes(reader.since(start));
    if u64::read(reader)? != seal {
        return Err(malformed.into());
    }
    Ok(world)
}

/// The same of one that was changed, to say what is there now.
pub(super) fn read_unsealed(
    reader: &mut Reader<'_>,
    custom_forces: &[Arc<dyn CustomForce>],
) -> Result<World, SnapshotError> {
    let world = read_world(reader, custom_forces)?;
    // Its hash and its seal, of what it was.
    reader.take(16)?;
    Ok(world)
}

fn read_world(reader: &mut Reader<'_>, custom_forces: &[Arc<dyn CustomForce>]) -> Result<World, SnapshotError> {
    if reader.take(MAGIC.len()).ok() != Some(&MAGIC) {
        return Err(SnapshotError::Foreign);
    }
    match u32::read(reader)? {
        FORMAT => {}
        found => return Err(SnapshotError::Format { found, known: FORMAT }),
    }
    match u32::read(reader)? {
        PHYSICS_VERSION => {}
        found => return Err(SnapshotError::PhysicsVersion { found, own: PHYSICS_VERSION }),
    }
    read_state(reader, custom_forces)
}

fn read_state(reader: &mut Reader<'_>, custom_forces: &[Arc<dyn CustomForce>]) -> Result<World, SnapshotError> {
    let def = WorldDef::read(reader)?;
    let mut world = World::new(def)?;
    world.tick = u64::read(reader)?;
    world.change_log = ChangeLog::starting_at(world.tick);
    world.counted = (Elapsed::read(reader)?, u64::read(reader)?);
    world.targets.moved_at = u64::read(reader)?;
    let (elapsed, since) = world.counted;
    // All ticks that steps lead to.
    if world.tick > limits::TICK || world.targets.moved_at > world.tick {
        return Err(Error::Inconsistent.into());
    }
    // As a change of the time step leaves it: with room for all ticks to come.
    if elapsed.plus(u64::MAX, def.time_step).is_none() || since > world.tick {
        return Err(Error::ElapsedTime.into());
    }
    world.random = Random::read(reader)?;
    world.set_blob(&Vec::read(reader)?)?;
    world.custom_forces = Arc::new(read_custom_forces(reader, custom_forces)?);
    read_bodies(reader, &mut world)?;
    let mut fields = FieldSet::default();
    for slot in 0..reader.count(5)? {
        let (generation, field) = (u32::read(reader)?, Option::<ForceField>::read(reader)?);
        let checked = field.as_ref().map_or(Ok(()), |field| field.check_values(&world.bodies, &world.custom_forces));
        let added = checked.and_then(|()| fields.rebuild(generation, field));
        let place = Owner::ForceField(FieldId::from_parts(slot as u32, generation));
        added.map_err(|error| SnapshotError::Invalid { place, error })?;
    }
    fields.set_free(read_list(reader, 4, u32::read)?)?;
    fields.set_ages(&read_list(reader, 4, u32::read)?)?;
    world.fields = Arc::new(fields);
    let woken = read_woken(reader)?;
    woken.iter().try_for_each(|&body| world.bodies.find(body).map(drop))?;
    world.change_log.set_woken(woken);
    Ok(world)
}

/// The bodies that calls woke, in the order of the calls.
fn read_woken(reader: &mut Reader<'_>) -> Result<Vec<BodyId>, Malformed> {
    let mut once = BTreeSet::new();
    read_list(reader, 8, |reader| {
        let malformed = reader.malformed("a body that is not in the list before");
        let body = BodyId::read(reader)?;
        if once.insert(body) { Ok(body) } else { Err(malformed) }
    })
}

/// The laws of force a world has, by their ids: each must be among those given, in the same version.
fn read_custom_forces(
    reader: &mut Reader<'_>,
    given: &[Arc<dyn CustomForce>],
) -> Result<CustomForces<Fx>, SnapshotError> {
    let mut custom_forces = CustomForces::new();
    for _ in 0..reader.count(12)? {
        let malformed = reader.malformed("a law of force with a larger id than the one before");
        let (id, version) = (u64::read(reader)?, u32::read(reader)?);
        if custom_forces.last_key_value().is_some_and(|(&last, _)| last >= id) {
            return Err(malformed.into());
        }
        let law = given.iter().find(|law| law.id() == id && law.version() == version);
        let law = law.ok_or(SnapshotError::CustomForce { id, version })?;
        custom_forces.insert(id, law.clone());
    }
    Ok(custom_forces)
}

/// Reads the bodies one by one into a world that has none, and which slots are free.
fn read_bodies(reader: &mut Reader<'_>, world: &mut World) -> Result<(), SnapshotError> {
    let World { def, bodies, applied, targets, .. } = world;
    let mut factor_table = FactorTable::default();
    *bodies = Bodies::empty(def.integrator == Integrator::PublishedVerlet);
    let mut sources = Sources::default();
    for slot in 0..reader.count(5)? {
        let generation = u32::read(reader)?;
        let body = BodyId::from_parts(slot as u32, generation);
        let invalid = |error| SnapshotError::Invalid { place: Owner::Body(body), error };
        if !bool::read(reader)? {
            bodies.rebuild(generation, None, &mut factor_table).map_err(invalid)?;
            continue;
        }
        let record = Record::read(reader)?;
        let malformed = reader.malformed("the shape, or the slot of the first body that has this shape");
        let source = ShapeSource::read(reader)?;
        let shape = match &source {
            ShapeSource::None => None,
            ShapeSource::New(shape) => Some(shape.clone()),
            ShapeSource::AsOf(first) => Some(bodies.shape_in(*first).ok_or(malformed)?.clone()),
        };
        check_among(&record, def).map_err(invalid)?;
        let dense = bodies.rebuild(generation, Some((record, shape)), &mut factor_table).map_err(invalid)?;
        if !dense.is_some_and(|dense| sources.name(slot as u32, &bodies.info(dense).shape) == source) {
            return Err(malformed.into());
        }
        if let Some(Pushed { force, torque }) = Option::read(reader)? {
            let feels =
                |dense| bodies.info(dense).kind == BodyKind::Dynamic && bodies.activity(dense) == Activity::Awake;
            if !dense.is_some_and(feels) {
                return Err(invalid(Error::Inconsistent));
            }
            applied.adopt(body, force, torque);
        }
        let malformed = reader.malformed("an errand with a goal or one that has arrived, or none");
        if let Some(target) = Option::<KinematicTarget<Fx>>::read(reader)? {
            if target.is_over() {
                return Err(malformed.into());
            }
            check_errand(&record, &target).map_err(invalid)?;
            targets.set(body, target);
        }
    }
    bodies.set_free(read_list(reader, 4, u32::read)?)?;
    world.factor_table = Arc::new(factor_table);
    Ok(())
}

/// Refuses of a body what the world it is in forbids.
fn check_among(record: &Record<Fx>, def: &WorldDef) -> Result<(), Error> {
    if record.activity == Activity::Asleep && def.sleep_after.is_none() {
        return Err(Error::Inconsistent);
    }
    let stops = |kept: Option<Fx>| def.integrator == Integrator::Yoshida4 && kept == Some(Fx::ZERO);
    if stops(record.linear_damping) || stops(record.angular_damping) {
        return Err(Error::DampingHasNoInverse);
    }
    Ok(())
}

/// Refuses what no call and no step has a body do.
fn check_errand(record: &Record<Fx>, target: &KinematicTarget<Fx>) -> Result<(), Error> {
    let may = match record.activity {
        Activity::Awake => true,
        Activity::Asleep => false,
        Activity::Quarantined | Activity::Disabled => target.goal.is_none(),
    };
    if record.kind != BodyKind::Kinematic || !may {
        return Err(Error::Inconsistent);
    }
    let Some(goal) = target.goal else { return Ok(()) };
    check_position(goal.position)?;
    goal.check_locks(record.position, record.angle, record.locks)
}

fn read_list<T>(
    reader: &mut Reader<'_>,
    least: usize,
    mut read: impl FnMut(&mut Reader<'_>) -> Result<T, Malformed>,
) -> Result<Vec<T>, Malformed> {
    (0..reader.count(least)?).map(|_| read(reader)).collect()
}
