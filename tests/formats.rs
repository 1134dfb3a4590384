//! `docs/formats.md` is right: a reader that knows nothing but its tables reads files and commands, and what it finds is what
//! the library says. `tests/files` has files of the first and the last physics version of every format so far.
//!
//! `UMBRA_BLESS=1 cargo test --release --all-features --test repository formats` adds those of a new format or physics version. It never writes over one: those of
//! older versions are to be refused, with both numbers.

#[path = "support/everything.rs"]
mod everything;
#[path = "support/found.rs"]
mod found;
#[path = "support/layouts.rs"]
mod layouts;

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Once;
use std::{env, fs};

use everything::{commands, custom_forces, recording, world};
use found::{
    activity, command, contact_settings, damping, field, integrator, kind, locks, mass, number, random, time_step,
    vector,
};
use layouts::{Content, Layouts, Value};
use umbra_physics::{
    BodyDef, BodyId, ColliderDef, ColliderId, Command, FieldId, ForceField, Fx, Inputs, Mass, PHYSICS_VERSION,
    RecordOptions, Recorder, Replay, ReplayError, Snapshot, SnapshotError, Turn, World, WorldDef,
};
use xxhash_rust::xxh3::xxh3_64;

/// The hash of a state as the document has it.
fn hash_of(state: &Value) -> u64 {
    let mut hashed = PHYSICS_VERSION.to_le_bytes().to_vec();
    let settings = &state["settings"];
    for field in [settings, &state["tick"]] {
        hashed.extend(field.bytes());
    }
    let (num, den) = elapsed(state);
    hashed.extend(num.to_le_bytes());
    hashed.extend(den.to_le_bytes());
    hashed.extend(state["random"].bytes());
    hashed.extend(state["blob"].bytes());

    let slots = state["bodies"].list();
    hashed.extend((slots.len() as u32).to_le_bytes());
    for slot in slots {
        let present = slot["present"].option().is_some();
        hashed.extend((2 * slot["generation"].natural() + u64::from(present)).to_le_bytes());
    }
    hashed.extend(state["free_slots"].bytes());
    let bodies: Vec<&Value> = slots.iter().filter_map(|slot| slot["present"].option()).collect();
    let columns: [fn(&Value) -> &[u8]; 8] = [
        |body| body["position"]["x"].bytes(),
        |body| body["position"]["y"].bytes(),
        |body| body["velocity"]["x"].bytes(),
        |body| body["velocity"]["y"].bytes(),
        |body| body["angular_velocity"].bytes(),
        |body| body["angle"].bytes(),
        |body| body["ticks_at_rest"].bytes(),
        |body| body["activity"].bytes(),
    ];
    for column in columns {
        bodies.iter().for_each(|body| hashed.extend(column(body)));
    }
    for body in &bodies {
        let names = [
            "kind",
            "bullet",
            "force_groups",
            "key",
            "user_data",
            "mass",
            "gravity_scale",
            "linear_damping",
            "angular_damping",
            "max_speed",
            "max_angular_speed",
            "locks",
            "dominance",
        ];
        let info: Vec<u8> = names.iter().flat_map(|name| body[name].bytes()).copied().collect();
        hashed.extend(xxh3_64(&info).to_le_bytes());
    }
    for last in bodies.iter().filter_map(|body| body["last_acceleration"].option()) {
        hashed.extend(last.bytes());
    }

    let pushed: Vec<(u32, &Value)> = (0u32..)
        .zip(slots)
        .filter_map(|(slot, entry)| Some((slot, entry["present"].option()?["applied"].option()?)))
        .collect();
    hashed.extend((pushed.len() as u32).to_le_bytes());
    for (slot, applied) in pushed {
        hashed.extend(slot.to_le_bytes());
        hashed.extend(applied.bytes());
    }

    let targets: Vec<(u32, &Value)> = (0u32..)
        .zip(state["bodies"].list())
        .filter_map(|(slot, entry)| Some((slot, entry["present"].option()?["kinematic_target"].option()?)))
        .collect();
    hashed.extend((targets.len() as u32).to_le_bytes());
    for (slot, target) in targets {
        hashed.extend(slot.to_le_bytes());
        hashed.extend(target.bytes());
    }
    hashed.extend(state["moved_at_tick"].bytes());

    let slots = state["fields"].list();
    hashed.extend((slots.len() as u32).to_le_bytes());
    for slot in slots {
        hashed.extend(slot["generation"].bytes());
        let field = slot["field"].option();
        hashed.push(u8::from(field.is_some()));
        hashed.extend(field.into_iter().flat_map(|field| xxh3_64(field.bytes()).to_le_bytes()));
    }
    hashed.extend(state["free_fields"].bytes());
    hashed.extend(state["fields_by_age"].bytes());

    let slots = state["colliders"].list();
    hashed.extend((slots.len() as u32).to_le_bytes());
    for slot in slots {
        hashed.extend(slot["generation"].bytes());
        let collider = slot["present"].option();
        hashed.push(u8::from(collider.is_some()));
        hashed.extend(collider.into_iter().flat_map(|collider| xxh3_64(collider.bytes()).to_le_bytes()));
    }
    hashed.extend(state["free_colliders"].bytes());
    hashed.extend(state["material_pairs"].bytes());
    hashed.extend(state["pushed_at_tick"].bytes());
    hashed.extend((state["contacts"].list().len() as u32).to_le_bytes());
    for contact in state["contacts"].list() {
        let points = ["first_point", "second_point"].map(|point| &contact[point]);
        hashed.extend(contact["first_collider"].bytes());
        hashed.extend(contact["second_collider"].bytes());
        points.iter().for_each(|point| hashed.extend(point["feature"].bytes()));
        points.iter().for_each(|point| hashed.extend(point["normal_impulse"].bytes()));
        hashed.extend(contact["tangent_impulse"].bytes());
    }
    hashed.extend(state["one_way_pairs"].bytes());
    hashed.extend(state["excluded_pairs"].bytes());
    hashed.extend(state["sensor_overlaps"].bytes());
    hashed.extend(state["ended_pairs"].bytes());
    hashed.extend(state["custom_forces"].bytes());
    let slots = state["joints"].list();
    if !slots.is_empty() {
        hashed.extend((slots.len() as u32).to_le_bytes());
        for slot in slots {
            hashed.extend(slot["generation"].bytes());
            let joint = slot["present"].option();
            hashed.push(u8::from(joint.is_some()));
            hashed.extend(joint.into_iter().flat_map(|joint| xxh3_64(joint["def"].bytes()).to_le_bytes()));
        }
        hashed.extend(state["free_joints"].bytes());
        for joint in slots.iter().filter_map(|slot| slot["present"].option()) {
            let (joint_state, impulses) = (&joint["state"], &joint["state"]["impulses"]);
            hashed.extend(joint_state["exponent"].bytes());
            hashed.extend(joint_state["broken"].bytes());
            // Turns, tooth, and three impulses.
            let zeros = |count: usize| vec![0; count];
            let parts = match impulses.case() {
                "Revolute" => [zeros(6), impulses["x"].bytes().to_vec(), impulses["y"].bytes().to_vec(), zeros(8)],
                "Distance" => [zeros(6), impulses["along"].bytes().to_vec(), zeros(8), zeros(8)],
                case => {
                    let tooth = if case == "Ratchet" { impulses["tooth"].bytes() } else { &[0; 4] };
                    let [x, y] = if case == "Slider" { ["along", "across"] } else { ["x", "y"] };
                    let rows = [x, y, "torque"].map(|name| impulses[name].bytes().to_vec());
                    let [first, second, third] = rows;
                    [[impulses["turns"].bytes(), tooth].concat(), first, second, third]
                }
            };
            hashed.extend(parts.concat());
        }
        hashed.extend(state["pulled_at_tick"].bytes());
    }
    xxh3_64(&hashed)
}

/// The time at the tick of a state, in lowest terms.
fn elapsed(state: &Value) -> (u128, u128) {
    let (before, step) = (&state["elapsed"], &state["settings"]["time_step"]);
    let ticks = state["tick"].long() - state["elapsed_at_tick"].long();
    let (a, b) = (before["num"].long(), before["den"].long());
    let (c, d) = (ticks * step["num"].long(), step["den"].long());
    let (num, den) = (a * d + c * b, b * d);
    let mut pair = (num, den);
    while pair.1 != 0 {
        pair = (pair.1, pair.0 % pair.1);
    }
    (num / pair.0, den / pair.0)
}

/// The state in a snapshot, and the hash it gives.
fn snapshot(layouts: &Layouts, file: &[u8]) -> (Value, u64) {
    assert_eq!(&file[..8], b"UMBRASNP");
    assert_eq!((word(file, 8), word(file, 12)), (layouts.number_of("Snapshots"), PHYSICS_VERSION));
    let end = file.len() - 16;
    let state = layouts.whole("state", &file[16..end]);
    let long = |at: usize| u64::from_le_bytes(file[at..at + 8].try_into().expect("eight"));
    assert_eq!(long(end + 8), xxh3_64(&file[..end + 8]), "the seal");
    assert_eq!(long(end), hash_of(&state), "the hash");
    (state, long(end))
}

/// Compares a state that was found with the world that the library makes of the same bytes.
fn compare(state: &Value, world: &World) {
    let def = world.def();
    let settings = &state["settings"];
    let settings_read = WorldDef {
        time_step: time_step(&settings["time_step"]),
        gravity: vector(&settings["gravity"]),
        integrator: integrator(&settings["integrator"]),
        linear_damping: damping(&settings["linear_damping"]),
        angular_damping: damping(&settings["angular_damping"]),
        sleep_after: settings["sleep_after"].option().map(|ticks| ticks.natural() as u32),
        contacts: contact_settings(&settings["contacts"]),
    };
    assert_eq!(settings_read, *def);
    assert_eq!(state["tick"].natural(), world.tick());
    assert!(state["moved_at_tick"].natural() <= world.tick());
    assert_eq!(elapsed(state), (world.elapsed().num, world.elapsed().den));
    assert_eq!(random(&state["random"]), *world.random());
    assert_eq!(state["blob"].raw(), world.blob());
    let slots = state["bodies"].list();
    let body_values: Vec<(BodyId, &Value)> = (0u32..)
        .zip(slots)
        .filter_map(|(slot, entry)| {
            let id = BodyId::from_parts(slot, entry["generation"].natural() as u32);
            Some((id, entry["present"].option()?))
        })
        .collect();
    assert_eq!(body_values.len(), world.body_count());
    let bits = |v: &Value| (v["x"].integer(), v["y"].integer());
    for (id, value) in body_values {
        let body = world.body(id).expect("it is there");
        assert_eq!((kind(&value["kind"]), activity(&value["activity"])), (body.kind(), body.activity()), "{id}");
        let (position, velocity) = (body.position_exact(), body.velocity_exact());
        assert_eq!(bits(&value["position"]), (position.x.to_bits(), position.y.to_bits()), "{id}");
        assert_eq!(bits(&value["velocity"]), (velocity.x.to_bits(), velocity.y.to_bits()), "{id}");
        assert_eq!(value["angle"].natural(), body.angle_exact().to_bits(), "{id}");
        assert_eq!(value["angular_velocity"].integer(), body.angular_velocity_exact().to_bits(), "{id}");
        assert_eq!(number(&value["gravity_scale"]), body.gravity_scale(), "{id}");
        assert_eq!(value["linear_damping"].option().map(damping), body.linear_damping(), "{id}");
        assert_eq!(value["angular_damping"].option().map(damping), body.angular_damping(), "{id}");
        assert_eq!(value["max_speed"].option().map(number), body.max_speed(), "{id}");
        assert_eq!(value["max_angular_speed"].option().map(number), body.max_angular_speed(), "{id}");
        assert_eq!(locks(&value["locks"]), body.locks(), "{id}");
        let goal = value["kinematic_target"].option().and_then(|target| target["goal"].option());
        let goal = goal.map(|goal| (vector(&goal["position"]), Turn::from_bits(goal["angle"].natural())));
        assert_eq!(goal, body.goal(), "{id}");
        assert_eq!(value["dominance"].natural() as u32 as i32, body.dominance(), "{id}");
        assert_eq!(value["force_groups"].natural(), u64::from(body.force_groups()), "{id}");
        assert_eq!(value["key"].natural(), body.key(), "{id}");
        assert_eq!(value["user_data"].natural(), body.user_data(), "{id}");
        if let Mass::Kilograms(mass) | Mass::Explicit { mass, inertia: _ } = mass(&value["mass"]) {
            assert!(body.mass().is_none_or(|actual| actual == mass), "{id}");
        }
        let (force, torque) = match value["applied"].option() {
            None => ((0, 0), 0),
            Some(applied) => (bits(&applied["force"]), applied["torque"].integer()),
        };
        let own_force = body.applied_force().expect("it fits").map(|wide| wide.to_bits());
        assert_eq!(force, (own_force.x, own_force.y), "{id}");
        assert_eq!(torque, body.applied_torque().expect("it fits").to_bits(), "{id}");
    }
    let fields_read: Vec<(FieldId, ForceField)> = (0u32..)
        .zip(state["fields"].list())
        .filter_map(|(slot, entry)| {
            let id = FieldId::from_parts(slot, entry["generation"].natural() as u32);
            Some((id, field(entry["field"].option()?)))
        })
        .collect();
    let fields_here: Vec<(FieldId, ForceField)> = world.fields().map(|(id, field)| (id, *field)).collect();
    assert_eq!(fields_read, fields_here);
    let colliders_read: Vec<(ColliderId, BodyId, ColliderDef)> = (0u32..)
        .zip(state["colliders"].list())
        .filter_map(|(slot, entry)| {
            let id = ColliderId::from_parts(slot, entry["generation"].natural() as u32);
            let present = entry["present"].option()?;
            Some((id, found::body(&present["body"]), found::collider_def(&present["def"])))
        })
        .collect();
    let colliders_here =
        world.colliders().map(|(id, def)| (id, world.collider_body(id).expect("it has one"), def.clone()));
    assert_eq!(colliders_read, colliders_here.collect::<Vec<_>>());
    let forces: Vec<(u64, u32)> = custom_forces().iter().map(|force| (force.id(), force.version())).collect();
    let version = |force: &Value| (force["id"].natural(), force["version"].natural() as u32);
    assert_eq!(state["custom_forces"].list().iter().map(version).collect::<Vec<_>>(), forces);
}

/// The chunks of a replay, by their letters, each with its seal right.
fn chunks(layouts: &Layouts, file: &[u8]) -> Vec<(String, Vec<u8>)> {
    assert_eq!(&file[..8], b"UMBRAREP");
    assert_eq!(file[8..12], layouts.number_of("Replays").to_le_bytes());
    let mut rest = &file[12..];
    let mut chunks = Vec::new();
    while !rest.is_empty() {
        let (word, double) = (&rest[..8], &rest[8..16]);
        assert!(word.iter().zip(double).all(|(a, b)| *a == !*b), "a word and its double");
        let length = u32::from_le_bytes(word[4..].try_into().expect("four")) as usize;
        let (contents, seal) = (&rest[16..16 + length], &rest[16 + length..16 + length + 40]);
        assert_eq!(seal[..8], xxh3_64(&[word, contents].concat()).to_le_bytes());
        let (mut sum, mut weighted) = (0u128, 0u128);
        for (k, piece) in (1u128..).zip(contents.chunks(8)) {
            let mut filled = [0; 8];
            filled[..piece.len()].copy_from_slice(piece);
            let word = u128::from(u64::from_le_bytes(filled));
            sum += word;
            weighted += k * word;
        }
        assert_eq!((&seal[8..24], &seal[24..]), (&sum.to_le_bytes()[..], &weighted.to_le_bytes()[..]));
        chunks.push((String::from_utf8(word[..4].to_vec()).expect("letters"), contents.to_vec()));
        rest = &rest[16 + length + 40..];
    }
    chunks
}

fn folder() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/files"))
}

/// The format and the physics version in the name of a file: `replay-format1-version3.umbrarep`.
fn numbers(stem: &str) -> (u32, u32) {
    let (_, numbers) = stem.split_once("-format").expect("a format");
    let (format, version) = numbers.split_once("-version").expect("a physics version");
    (format.parse().expect("a number"), version.parse().expect("a number"))
}

/// The files of a kind, by format and physics version.
fn committed(extension: &str) -> BTreeMap<(u32, u32), Vec<u8>> {
    static BLESSED: Once = Once::new();
    BLESSED.call_once(bless);
    let files = fs::read_dir(folder()).expect("the folder is there").map(|file| file.expect("it can be read").path());
    let files = files.filter(|path| path.extension().is_some_and(|e| e == extension));
    let stem = |path: &PathBuf| path.file_stem().expect("a name").to_string_lossy().into_owned();
    files.map(|path| (numbers(&stem(&path)), fs::read(&path).expect("it can be read"))).collect()
}

/// Expected files of the folder: name, extension, bytes, and the position of the physics version in them.
fn made_now() -> [(&'static str, &'static str, Vec<u8>, usize); 2] {
    let snapshot = world().snapshot().to_bytes();
    [("snapshot", "umbrasnp", snapshot, 12), ("replay", "umbrarep", recording(), 28)]
}

/// Adds the files of this format and physics version, if that is asked for and they are not there.
fn bless() {
    if env::var_os("UMBRA_BLESS").is_none_or(|value| value != "1") {
        return;
    }
    for (name, extension, bytes, force_at) in made_now() {
        let (format, version) = (word(&bytes, 8), word(&bytes, force_at));
        let path = folder().join(format!("{name}-format{format}-version{version}.{extension}"));
        if !path.exists() {
            fs::write(path, &bytes).expect("the file can be written");
        }
    }
}

fn word(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four"))
}

#[test]
fn files_of_this_format_and_version_are_there_and_made_the_same_now() {
    for (name, extension, bytes, force_at) in made_now() {
        let (format, version) = (word(&bytes, 8), word(&bytes, force_at));
        assert_eq!(version, PHYSICS_VERSION);
        let all = committed(extension);
        let old = all
            .get(&(format, version))
            .unwrap_or_else(|| panic!("no {name} of format {format} and physics version {version}: bless"));
        assert!(*old == bytes, "the bytes of a {name} changed: that needs another format or physics version");
    }
}

#[test]
fn files_of_other_formats_and_versions_are_refused_with_both_numbers() {
    let [own_format, own_snapshots] = ["Replays", "Snapshots"].map(|name| Layouts::documented().number_of(name));
    // As it will be once there is another physics version.
    let mut replays = committed("umbrarep");
    let mut snapshots = committed("umbrasnp");
    let newest = snapshots[&(own_snapshots, PHYSICS_VERSION)].clone();
    snapshots.extend([(12, PHYSICS_VERSION + 1), (8, PHYSICS_VERSION)].map(|(at, version)| {
        let mut altered = newest.clone();
        altered[at] += 1;
        ((u32::from(at == 8) + own_snapshots, version), altered)
    }));
    let mut newest = replays[&(own_format, PHYSICS_VERSION)].clone();
    newest[8] += 1;
    replays.insert((own_format + 1, PHYSICS_VERSION), newest);
    assert!(snapshots.len() >= 3 && replays.len() >= 2);
    for ((format, version), file) in &snapshots {
        let read = Snapshot::from_bytes(file, &custom_forces());
        match read {
            Ok(_) => assert_eq!((*format, *version), (own_snapshots, PHYSICS_VERSION)),
            Err(SnapshotError::Format { found: version_found, known }) => {
                assert_eq!((version_found, known), (*format, own_snapshots))
            }
            Err(SnapshotError::PhysicsVersion { found: version_found, own }) => {
                assert_eq!((version_found, own), (*version, PHYSICS_VERSION))
            }
            Err(error) => panic!("format {format}, physics version {version}: {error}"),
        }
    }
    for ((format, version), file) in &replays {
        match Replay::from_bytes(file, &custom_forces()) {
            Ok(replay) => {
                assert_eq!((*format, *version), (own_format, PHYSICS_VERSION));
                assert_eq!(replay.verify(), Ok(()));
            }
            Err(ReplayError::Format { found: version_found, known }) => {
                assert_eq!((version_found, known), (*format, own_format))
            }
            Err(error @ ReplayError::PhysicsVersion { found: version_found, own }) => {
                assert_eq!((version_found, own), (*version, PHYSICS_VERSION));
                let text = error.to_string();
                assert!(
                    text.contains(&format!("physics version {version};"))
                        && text.contains(&format!("physics version {PHYSICS_VERSION}")),
                    "{text}"
                );
            }
            Err(error) => panic!("format {format}, physics version {version}: {error}"),
        }
    }
}

#[test]
fn the_tables_read_a_snapshot() {
    let layouts = Layouts::documented();
    let file = &committed("umbrasnp")[&(layouts.number_of("Snapshots"), PHYSICS_VERSION)];
    let (state, hash) = snapshot(&layouts, file);
    let world = Snapshot::from_bytes(file, &custom_forces()).expect("it is whole").into_world();
    compare(&state, &world);
    assert_eq!(hash, world.state_hash());
    // It has what it is to have.
    let bodies: Vec<&Value> = state["bodies"].list().iter().filter_map(|slot| slot["present"].option()).collect();
    for activity in ["Awake", "Asleep", "Quarantined", "Disabled"] {
        assert!(bodies.iter().any(|body| body["activity"].case() == activity), "none is {activity}");
    }
    assert!(bodies.iter().any(|body| body["applied"].option().is_some()));
    assert!(bodies.iter().any(|body| body["locks"]["rotation"].natural() == 1 && body["locks"]["x"].natural() == 0));
    assert!(bodies.iter().any(|body| body["max_speed"].option().is_some()));
    let target = bodies.iter().find_map(|body| body["kinematic_target"].option()).expect("one is on its way");
    assert!(target["goal"].option().is_some() && target["arrived"].natural() == 1);
    let free = ["free_slots", "free_fields", "free_colliders", "free_joints"];
    assert!(free.iter().all(|list| !state[list].list().is_empty()));
    assert!(state["colliders"].list().iter().filter(|slot| slot["present"].option().is_some()).count() > 3);
}

#[test]
fn the_tables_read_a_replay() {
    let layouts = Layouts::documented();
    let file = &committed("umbrarep")[&(layouts.number_of("Replays"), PHYSICS_VERSION)];
    let replay = Replay::from_bytes(file, &custom_forces()).expect("it is whole");
    assert_eq!(replay.verify(), Ok(()));
    let mut playback = replay.play();
    let chunks = chunks(&layouts, file);
    let (mut snapshots, mut accelerations, mut players, mut calls) = (0, 0, [0, 0], 0);
    for (i, (letters, contents)) in chunks.iter().enumerate() {
        match &letters[..] {
            "HEAD" => {
                let head = layouts.whole("head", contents);
                assert_eq!(i, 0);
                assert_eq!(
                    (head["physics_version"].natural(), head["hash_every"].natural()),
                    (u64::from(PHYSICS_VERSION), 1)
                );
                assert_eq!(head["tick"].natural(), replay.start().tick());
                assert_eq!(head["snapshot_every"].natural(), 24);
            }
            "SNAP" => {
                let (state, hash) = snapshot(&layouts, contents);
                compare(&state, playback.world());
                assert_eq!(hash, playback.world().state_hash());
                let slots = state["bodies"].list().iter().filter_map(|slot| slot["present"].option());
                accelerations += slots.filter(|body| body["last_acceleration"].option().is_some()).count();
                snapshots += 1;
            }
            "TICK" => {
                let segment = layouts.whole("segment", contents);
                assert_eq!(segment["tick"].natural(), playback.world().tick());
                for tick in segment["ticks"].list() {
                    let inputs = tick["inputs"].list();
                    let done = tick["calls"].list().iter().chain(inputs.iter().map(|input| &input["command"]));
                    let done: Vec<Command> = done.map(command).collect();
                    assert_eq!(done, playback.commands().collect::<Vec<_>>());
                    playback.step().expect("it goes as recorded");
                    let places = playback.outcomes().iter().map(|outcome| (outcome.player, outcome.sequence));
                    let place_of =
                        |input: &Value| (input["player"].natural() as u32, input["sequence"].natural() as u32);
                    assert_eq!(inputs.iter().map(place_of).collect::<Vec<_>>(), places.collect::<Vec<_>>());
                    let hash = tick["hash"].option().map(|hash| hash.natural());
                    assert_eq!(hash, Some(playback.world().state_hash()));
                    inputs.iter().for_each(|input| players[input["player"].natural() as usize] += 1);
                    calls += tick["calls"].list().len();
                }
            }
            "DONE" => {
                let done = layouts.whole("done", contents);
                assert_eq!(i, chunks.len() - 1);
                assert_eq!(done["tick"].natural(), playback.world().tick());
                assert_eq!(done["hash"].natural(), playback.world().state_hash());
            }
            tag => panic!("a chunk {tag}"),
        }
    }
    assert_eq!(playback.world().tick(), replay.end());
    assert!(snapshots > 2 && accelerations > 0 && players.iter().all(|&some| some > 5) && calls > 5);
}

#[test]
fn the_tables_read_the_names_in_a_replay() {
    let mut world: World = World::new(WorldDef::default()).expect("a world");
    let body = world.add_body(BodyDef::dynamic()).expect("a body");
    let mut recorder = Recorder::new(&world, RecordOptions::default());
    recorder.step(&mut world, &Inputs::new());
    recorder.labels_mut().set_body(body, "ball");
    recorder.labels_mut().set_field(FieldId::from_parts(2, 1), "wind");
    recorder.labels_mut().set_collider(ColliderId::from_parts(5, 0), "lid");
    let layouts = Layouts::documented();
    let chunks = chunks(&layouts, &recorder.finish(&world));
    let letters: Vec<&str> = chunks.iter().map(|(letters, _)| &letters[..]).collect();
    assert_eq!(letters, ["HEAD", "SNAP", "TICK", "SNAP", "NAME", "DONE"]);
    let labels = layouts.whole("labels", &chunks[4].1);
    let lists = ["bodies", "fields", "colliders"].map(|list| labels[list].list());
    assert_eq!(lists.map(|list| list.len()), [1, 1, 1]);
    let name = lists.map(|list| list[0]["name"].bytes()[4..].to_vec());
    assert_eq!(name, [b"ball".to_vec(), b"wind".to_vec(), b"lid".to_vec()]);
}

#[test]
fn the_tables_read_every_command_and_say_how_long_it_is() {
    let layouts = Layouts::documented();
    let mut lengths: BTreeMap<u8, Vec<usize>> = BTreeMap::new();
    for expected in commands() {
        let bytes = expected.to_bytes();
        let value = layouts.whole("command", &bytes);
        assert_eq!(command(&value), expected);
        assert!(format!("{expected:?}").starts_with(value.case()), "{expected:?}");
        // Shapes, colliders and blobs come on top of what the table says.
        let more = match &expected {
            Command::AddBody(_) => value["def"]["colliders"].list().iter().map(|collider| collider.bytes().len()).sum(),
            Command::AddCollider { .. } | Command::SetCollider { .. } => value["def"]["shape"].bytes().len(),
            Command::SetBlob(blob) => blob.len(),
            _ => 0,
        };
        lengths.entry(bytes[0]).or_default().push(bytes.len() - more);
    }
    let Content::Choice(cases) = layouts.form("command") else { panic!("a command is a choice") };
    assert_eq!(lengths.len(), cases.len());
    for case in cases {
        let sizes = &lengths[&case.tag];
        let (min, max) = (sizes.iter().min().expect("one"), sizes.iter().max().expect("one"));
        let range = if min == max { format!("{min}") } else { format!("{min} to {max}") };
        let written = case.bytes.split(',').next().unwrap_or_default();
        assert_eq!(written, range, "{}", case.name);
    }
    let max = lengths.values().flatten().max().expect("one");
    assert_eq!(*max, Command::<Fx>::BYTES);
    let text = fs::read_to_string(layouts::PATH).expect("the document");
    assert!(text.contains(&format!("none has more than {} bytes\n(`Command::BYTES`)", Command::<Fx>::BYTES)));
}
