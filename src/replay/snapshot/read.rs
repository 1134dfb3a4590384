//! Reading a world from the bytes of a snapshot: each value is checked, and a state that no world can have is refused.

use alloc::collections::BTreeSet;
use alloc::sync::Arc;
use alloc::vec::Vec;

use super::error::SnapshotError;
use super::hash::PHYSICS_VERSION;
use super::owner::Owner;
use super::write::{AppliedSums, FORMAT, MAGIC};
use crate::body::{Activity, Bodies, BodyKind, Damping, FactorTable, KinematicTarget, Record, check_position};
use crate::codec::{Malformed, Read, Reader, StateHasher};
use crate::collider::{ColliderDef, ColliderMass, ColliderSet, OutlineId, PairEntry};
use crate::contact::{ContactRecord, ContactSet, EndedPair, ExcludedPair, OneWayAnswer, Overlap, is_asleep};
use crate::error::Error;
use crate::force::{CustomForce, CustomForces, FieldSet, ForceField};
use crate::fx::Fx;
use crate::integrate::Integrator;
use crate::joint::{JointDef, JointSet, JointState, JointStates};
use crate::limits;
use crate::math::{Elapsed, Random};
use crate::slots::{BodyId, ColliderId, FieldId, JointId};
use crate::world::{ChangeLog, World, WorldDef};

/// Reads a snapshot; bytes after it are left to the caller.
pub(in crate::replay) fn read(
    reader: &mut Reader<'_>,
    custom_forces: &[Arc<dyn CustomForce>],
) -> Result<World, SnapshotError> {
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

/// Reads a snapshot that was changed, to name its values: its hash and its seal need not be right.
pub(in crate::replay) fn read_unsealed(
    reader: &mut Reader<'_>,
    custom_forces: &[Arc<dyn CustomForce>],
) -> Result<World, SnapshotError> {
    let world = read_world(reader, custom_forces)?;
    reader.take(16)?;
    Ok(world)
}

fn read_world(reader: &mut Reader<'_>, custom_forces: &[Arc<dyn CustomForce>]) -> Result<World, SnapshotError> {
    if reader.take(MAGIC.len()).ok() != Some(&MAGIC) {
        return Err(SnapshotError::Foreign);
    }
    match u32::read(reader)? {
        FORMAT => {}
        format => return Err(SnapshotError::Format { found: format, known: FORMAT }),
    }
    match u32::read(reader)? {
        PHYSICS_VERSION => {}
        version => return Err(SnapshotError::PhysicsVersion { found: version, own: PHYSICS_VERSION }),
    }
    read_state(reader, custom_forces)
}

pub(super) fn read_state(
    reader: &mut Reader<'_>,
    custom_forces: &[Arc<dyn CustomForce>],
) -> Result<World, SnapshotError> {
    let def = WorldDef::read(reader)?;
    let mut world = World::new(def)?;
    world.tick = u64::read(reader)?;
    world.change_log = ChangeLog::starting_at(world.tick);
    world.counted = (Elapsed::read(reader)?, u64::read(reader)?);
    world.targets.moved_at = u64::read(reader)?;
    let (elapsed, since) = world.counted;
    // Steps lead to these ticks and no others.
    if world.tick > limits::TICK || world.targets.moved_at > world.tick {
        return Err(Error::Inconsistent.into());
    }
    // A change of the time step leaves room for all ticks to come.
    if elapsed.plus(u64::MAX, def.time_step).is_none() || since > world.tick {
        return Err(Error::ElapsedTime.into());
    }
    world.random = Random::read(reader)?;
    world.set_blob(&Vec::read(reader)?)?;
    world.custom_forces = Arc::new(read_custom_forces(reader, custom_forces)?);
    world.colliders = Arc::new(read_colliders(reader)?);
    read_bodies(reader, &mut world)?;
    for collider in world.colliders.list() {
        world.bodies.find(collider.body)?;
    }
    world.fields = Arc::new(read_fields(reader, &world)?);
    world.contacts = read_contacts(reader, &world)?;
    read_joints(reader, &mut world)?;
    let malformed = reader.malformed("bodies that are awake, then bodies that sleep");
    let changed = read_sleep_changes(reader)?;
    changed.iter().try_for_each(|&body| world.bodies.find(body).map(drop))?;
    if !world.change_log.set_sleep_changes(&changed, &world.bodies) {
        return Err(malformed.into());
    }
    Ok(world)
}

/// Reads the force fields of a world that has its bodies.
fn read_fields(reader: &mut Reader<'_>, world: &World) -> Result<FieldSet<Fx>, SnapshotError> {
    let mut fields = FieldSet::default();
    for slot in 0..reader.count(5)? {
        let (generation, field) = (u32::read(reader)?, Option::<ForceField>::read(reader)?);
        let checked = field.as_ref().map_or(Ok(()), |field| field.check_values(&world.bodies, &world.custom_forces));
        let added = checked.and_then(|()| fields.rebuild(generation, field));
        let owner = Owner::ForceField(FieldId::from_parts(slot as u32, generation));
        added.map_err(|error| SnapshotError::Invalid { owner, error })?;
    }
    fields.set_free(read_list(reader, 4, u32::read)?)?;
    fields.set_ages(&read_list(reader, 4, u32::read)?)?;
    Ok(fields)
}

/// The fewest bytes of a slot for a body: a generation and whether there is one.
const LEAST_SLOT: usize = 5;

/// Reads the colliders. The body of each is not looked for yet.
fn read_colliders(reader: &mut Reader<'_>) -> Result<ColliderSet<Fx>, SnapshotError> {
    let mut colliders = ColliderSet::default();
    for slot in 0..reader.count(5)? {
        let generation = u32::read(reader)?;
        let owner = Owner::Collider(ColliderId::from_parts(slot as u32, generation));
        let invalid = |error| SnapshotError::Invalid { owner, error };
        let collider = if bool::read(reader)? {
            let (body, def) = (BodyId::read(reader)?, ColliderDef::read(reader)?);
            // Slots of bodies come after: there is no room made for more than the bytes that are left can have.
            if body.slot as usize >= reader.rest() / LEAST_SLOT {
                return Err(invalid(Error::NoSuchBody { body }));
            }
            def.check().map_err(invalid)?;
            Some((body, def))
        } else {
            None
        };
        colliders.rebuild(generation, collider).map_err(invalid)?;
    }
    colliders.set_free(read_list(reader, 4, u32::read)?)?;
    let malformed = reader.malformed("pairs of materials, sorted, each once with the lower number first");
    let pairs = read_list(reader, 32, PairEntry::read)?;
    if !pairs.is_sorted_by(|a, b| a.ids < b.ids) || pairs.iter().any(|entry| entry.ids[0] > entry.ids[1]) {
        return Err(malformed.into());
    }
    for PairEntry { ids, pair } in pairs {
        colliders.check_material_pair(ids, Some(&pair))?;
        colliders.set_material_pair(ids, Some(pair));
    }
    Ok(colliders)
}

/// Reads the contacts of a world that has its colliders.
fn read_contacts(reader: &mut Reader<'_>, world: &World) -> Result<ContactSet, SnapshotError> {
    let pushed_at = u64::read(reader)?;
    let malformed = reader.malformed("contacts of outlines of colliders of two bodies, sorted, each once");
    let records: Vec<ContactRecord> = read_list(reader, 40, ContactRecord::read)?;
    let body = |outline: OutlineId| {
        let collider = world.colliders.at(outline.slot)?;
        ((outline.part as usize) < collider.def.shape.outlines().len()).then_some(collider.body)
    };
    let is_pair = |[a, b]: [OutlineId; 2]| body(a).is_some() && body(b).is_some() && body(a) != body(b);
    let are_pairs = records.iter().all(|record| is_pair(record.pair()));
    if !are_pairs || !records.is_sorted_by(|a, b| a.pair() < b.pair()) {
        return Err(malformed.into());
    }
    if pushed_at > world.tick {
        return Err(Error::Inconsistent.into());
    }
    let malformed = reader.malformed("outlines of one-way colliders and bodies without them, sorted, each once");
    let passes: Vec<OneWayAnswer> = read_list(reader, 11, OneWayAnswer::read)?;
    let is_there = |slot| world.bodies.index_in(slot).is_some();
    let is_one_way = |record: &OneWayAnswer| {
        let (outline, answerer) = record.place();
        let side = world.colliders.at(outline.slot).is_some_and(|collider| collider.side.is_some());
        side && is_there(answerer) && body(outline).is_some_and(|id| id.slot != answerer)
    };
    if !passes.iter().all(is_one_way) || !passes.is_sorted_by(|a, b| a.place() < b.place()) {
        return Err(malformed.into());
    }
    let malformed = reader.malformed("pairs of two bodies, at most 65,536, sorted, each once");
    let excluded: Vec<ExcludedPair> = read_list(reader, 9, ExcludedPair::read)?;
    let are_two = |pair: &ExcludedPair| pair.bodies[0] < pair.bodies[1] && pair.bodies.into_iter().all(is_there);
    let fits = excluded.len() <= limits::EXCLUDED_PAIRS;
    if !fits || !excluded.iter().all(are_two) || !excluded.is_sorted_by(|a, b| a.bodies < b.bodies) {
        return Err(malformed.into());
    }
    let malformed = reader.malformed("sensors and colliders of other bodies that are none, sorted, each once");
    let overlaps: Vec<Overlap> = read_list(reader, 8, Overlap::read)?;
    let is_overlap = |overlap: &Overlap| {
        let [sensor, visitor] = overlap.slots().map(|slot| world.colliders.at(slot));
        let are_both =
            sensor.zip(visitor).filter(|(sensor, visitor)| sensor.def.is_sensing() && visitor.def.is_solid());
        are_both.is_some_and(|(sensor, visitor)| sensor.body != visitor.body)
    };
    if !overlaps.iter().all(is_overlap) || !overlaps.is_sorted_by(|a, b| a < b) {
        return Err(malformed.into());
    }
    let ended: Vec<EndedPair> = read_list(reader, 65, EndedPair::read)?;
    let mut contacts = ContactSet::new(records, |slot| is_asleep(&world.bodies, &world.colliders, slot));
    (contacts.passes, contacts.excluded, contacts.pushed_at) = (passes, excluded, pushed_at);
    (contacts.overlaps, contacts.ended) = (overlaps, ended);
    Ok(contacts)
}

/// Reads the joints of a world that has its bodies.
fn read_joints(reader: &mut Reader<'_>, world: &mut World) -> Result<(), SnapshotError> {
    let mut joints = JointSet::default();
    let mut states = JointStates::default();
    for slot in 0..reader.count(5)? {
        let generation = u32::read(reader)?;
        let owner = Owner::Joint(JointId::from_parts(slot as u32, generation));
        let invalid = |error| SnapshotError::Invalid { owner, error };
        let joint = if bool::read(reader)? {
            let def = JointDef::read(reader)?;
            def.check_values(&world.bodies).map_err(invalid)?;
            Some((def, JointState::read(&def.kind, reader)?))
        } else {
            None
        };
        joints.rebuild(generation, joint, &mut states).map_err(invalid)?;
    }
    joints.set_free(read_list(reader, 4, u32::read)?)?;
    states.pulled_at = u64::read(reader)?;
    if states.pulled_at > world.tick {
        return Err(Error::Inconsistent.into());
    }
    (world.joints, world.joint_states) = (Arc::new(joints), states);
    Ok(())
}

/// Reads the bodies that calls woke, then the bodies that calls put to sleep, in the order of the calls.
fn read_sleep_changes(reader: &mut Reader<'_>) -> Result<Vec<BodyId>, Malformed> {
    let mut once = BTreeSet::new();
    read_list(reader, 8, |reader| {
        let malformed = reader.malformed("a body that is not in the list before");
        let body = BodyId::read(reader)?;
        if once.insert(body) { Ok(body) } else { Err(malformed) }
    })
}

/// Reads which custom forces a world has, by their ids: each must be among those given, in the same version.
fn read_custom_forces(
    reader: &mut Reader<'_>,
    available: &[Arc<dyn CustomForce>],
) -> Result<CustomForces<Fx>, SnapshotError> {
    let mut custom_forces = CustomForces::new();
    for _ in 0..reader.count(12)? {
        let malformed = reader.malformed("a custom force with a larger id than the one before");
        let (id, version) = (u64::read(reader)?, u32::read(reader)?);
        if custom_forces.last_key_value().is_some_and(|(&last, _)| last >= id) {
            return Err(malformed.into());
        }
        let force = available.iter().find(|force| force.id() == id && force.version() == version);
        let force = force.ok_or(SnapshotError::CustomForce { id, version })?;
        custom_forces.insert(id, force.clone());
    }
    Ok(custom_forces)
}

/// Reads the bodies one by one into a world that has none, and which slots are free.
fn read_bodies(reader: &mut Reader<'_>, world: &mut World) -> Result<(), SnapshotError> {
    let mut factor_table = FactorTable::default();
    world.bodies = Bodies::empty(world.def.integrator == Integrator::PublishedVerlet);
    for slot in 0..reader.count(5)? {
        let generation = u32::read(reader)?;
        let body = BodyId::from_parts(slot as u32, generation);
        if bool::read(reader)? {
            read_body(reader, world, body, &mut factor_table)?;
        } else {
            let added = world.bodies.rebuild(generation, None, &mut factor_table);
            added.map_err(|error| SnapshotError::Invalid { owner: Owner::Body(body), error })?;
        }
    }
    world.bodies.set_free(read_list(reader, 4, u32::read)?)?;
    world.factor_table = Arc::new(factor_table);
    Ok(())
}

/// Reads a body into the next slot of a world.
fn read_body(
    reader: &mut Reader<'_>,
    world: &mut World,
    body: BodyId,
    factor_table: &mut FactorTable<Fx>,
) -> Result<(), SnapshotError> {
    let World { def, bodies, colliders, applied, targets, .. } = world;
    let (_, generation) = body.parts();
    let invalid = |error| SnapshotError::Invalid { owner: Owner::Body(body), error };
    let record = Record::read(reader)?;
    check_among(&record, def).map_err(invalid)?;
    let definitions = colliders.of(body).filter(|collider| collider.body == body).map(|collider| &collider.def);
    let is_dynamic = record.kind == BodyKind::Dynamic;
    definitions.clone().try_for_each(|def| def.check_on(is_dynamic)).map_err(invalid)?;
    let collider_mass = ColliderMass::of(definitions);
    let dense = bodies.rebuild(generation, Some((record, collider_mass)), factor_table).map_err(invalid)?;
    if let Some(AppliedSums { force, torque }) = Option::read(reader)? {
        let feels = |dense| bodies.info(dense).kind == BodyKind::Dynamic && bodies.activity(dense) == Activity::Awake;
        if !dense.is_some_and(feels) {
            return Err(invalid(Error::Inconsistent));
        }
        applied.adopt(body, force, torque);
    }
    let malformed = reader.malformed("a target with a goal or one that has arrived, or none");
    if let Some(target) = Option::<KinematicTarget<Fx>>::read(reader)? {
        if target.is_over() {
            return Err(malformed.into());
        }
        check_target(&record, &target).map_err(invalid)?;
        targets.set(body, target);
    }
    Ok(())
}

/// Refuses a body that the settings of its world forbid.
fn check_among(record: &Record<Fx>, def: &WorldDef) -> Result<(), Error> {
    if record.activity == Activity::Asleep && def.sleep_after.is_none() {
        return Err(Error::Inconsistent);
    }
    let stops = [record.linear_damping, record.angular_damping].into_iter().flatten().any(Damping::stops);
    if def.integrator == Integrator::Yoshida4 && stops {
        return Err(Error::DampingHasNoInverse);
    }
    Ok(())
}

/// Refuses a target that no call and no step gives a body.
fn check_target(record: &Record<Fx>, target: &KinematicTarget<Fx>) -> Result<(), Error> {
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
