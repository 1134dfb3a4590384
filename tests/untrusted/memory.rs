//! Memory that reading takes, for files made to take as much as possible. `UMBRA_SAY=1 cargo test --release
//! --all-features --test counting untrusted::memory -- --nocapture` prints it, as multiples of each file.

use allocation_counter::measure;
use umbra_physics::{
    BodyDef, BodyId, ColliderDef, ColliderId, Command, Dump, FieldId, FieldKind, ForceField, Fx, Input, Inputs,
    Integrator, JointDef, JointId, Part, RecordOptions, Recorder, Replay, Shape, Snapshot, World, WorldDef, fx, vec2,
};
use umbra_scene::{Scene, SceneErrors};

use crate::seeds::{is_short, times};
use crate::untrusted::everything::custom_forces;
use crate::untrusted::seals::{self, chunk};

/// Bytes taken for each of a file's, and for any file: what the documents promise.
pub(crate) const TIMES: u64 = 16;
pub(crate) const ANY: u64 = 1 << 16;

/// Reads a file and counts what is taken meanwhile, what is read included.
pub(crate) fn bounded<T>(what: &str, file: &[u8], read: impl FnOnce(&[u8]) -> T) -> T {
    let mut result = None;
    let taken = measure(|| result = Some(read(file))).bytes_max;
    let bound = TIMES * file.len() as u64 + ANY;
    assert!(taken <= bound, "{what}: {taken} bytes taken for {} in the file", file.len());
    if std::env::var_os("UMBRA_SAY").is_some() && file.len() > 10_000 {
        println!("{what:<28} {:>9} {taken:>10} {:>6.2}", file.len(), taken as f64 / file.len() as f64);
    }
    result.expect("it was read")
}

fn world() -> World {
    World::new(WorldDef::default()).expect("a world")
}

/// The world in a snapshot, in a replay with nothing more, and in one that was changed, which is then told of.
fn held(what: &str, world: &World) {
    let bytes = world.snapshot().to_bytes();
    bounded(what, &bytes, |file| _ = Snapshot::from_bytes(file, &custom_forces()).expect("a snapshot"));
    let mut file = Recorder::new(world, RecordOptions::default()).finish(world);
    bounded(what, &file, |file| _ = Replay::from_bytes(file, &custom_forces()).expect("a replay"));
    let middle = file.len() / 4;
    file[middle] ^= 1;
    bounded(what, &file, |file| assert!(Replay::from_bytes(file, &custom_forces()).is_err()));
}

/// Pins a body to the world.
fn pin(world: &mut World, body: BodyId) -> JointId {
    let pin = JointDef::at(world, None, body, vec2(0, 0)).expect("a point of the body");
    world.add_joint(pin).expect("a joint")
}

fn parts(count: i32, angle: Fx) -> Vec<Part> {
    let disc = Shape::circle(fx!(0.5)).expect("a shape");
    (0..count).map(|x| Part { shape: disc.clone(), position: vec2(x, 0), angle, density: fx!(1) }).collect()
}

#[test]
fn worlds_of_what_takes_little_in_a_file() {
    held("nothing", &world());
    let drag =
        ForceField { kind: FieldKind::Drag { linear: fx!(1), quadratic: fx!(0), wind: vec2(0, 0) }, force_groups: 1 };
    let mut emptied = world();
    let bodies: Vec<_> = (0..times(5_000)).map(|_| emptied.add_body(BodyDef::dynamic()).expect("a body")).collect();
    let fields: Vec<_> = (0..times(5_000)).map(|_| emptied.add_field(drag).expect("a field")).collect();
    held("bodies alike, fields", &emptied);
    let joints: Vec<_> = bodies.iter().map(|&body| pin(&mut emptied, body)).collect();
    held("joints", &emptied);
    for joint in joints {
        emptied.remove_joint(joint).expect("it is there");
    }
    held("free joints", &emptied);
    for field in fields {
        emptied.remove_field(field).expect("it is there");
    }
    held("free fields", &emptied);
    for body in bodies {
        emptied.remove_body(body).expect("it is there");
    }
    held("free slots and fields", &emptied);
    // One at the end has all before it in the file.
    let mut sparse = world();
    let bodies: Vec<_> = (0..times(5_000)).map(|_| sparse.add_body(BodyDef::dynamic()).expect("a body")).collect();
    for &body in &bodies[..bodies.len() - 1] {
        sparse.remove_body(body).expect("it is there");
    }
    sparse.apply_force(bodies[bodies.len() - 1], vec2(1, 0)).expect("it is dynamic");
    held("a body behind free slots", &sparse);

    let mut world_with_law = world();
    world_with_law.register_custom_force(custom_forces().remove(0)).expect("a law");
    for _ in 0..times(5_000) {
        world_with_law.add_field(FieldKind::Custom { id: 9 }).expect("a field");
    }
    held("laws of the user's", &world_with_law);
    for integrator in [Integrator::VelocityVerlet, Integrator::PublishedVerlet] {
        let mut unlike = World::new(WorldDef { integrator, ..WorldDef::default() }).expect("a world");
        for i in 0..times(1_000) {
            let gravity_scale = Fx::from_bits(i);
            unlike.add_body(BodyDef { gravity_scale, ..BodyDef::dynamic() }).expect("a body");
        }
        held("tunings", &unlike);
        for i in 0..times(1_000) {
            let disc = Shape::circle(fx!(0.5) + Fx::from_bits(i)).expect("a shape");
            let def = BodyDef::dynamic().with_collider(ColliderDef::ghost(disc));
            unlike.add_body(BodyDef { gravity_scale: Fx::from_bits(-i), ..def }).expect("a body");
        }
        held("tunings and shapes", &unlike);
    }
    let mut compounds = world();
    for i in 0..times(20) {
        let shape = Shape::compound(&parts(256, Fx::from_bits(i))).expect("a shape");
        compounds.add_body(BodyDef::dynamic().with_collider(ColliderDef::ghost(shape))).expect("a body");
    }
    held("compounds", &compounds);
    let mut colliders = world();
    for i in 0..times(20) {
        let shape = Shape::compound(&parts(256, Fx::from_bits(i))).expect("a shape");
        colliders.add_body(BodyDef::dynamic().with_collider(shape)).expect("a body");
    }
    held("compounds as colliders", &colliders);
    // Where they are given, and elsewhere; to and fro, so that the look for crossings has all segments at once.
    for x in [0, 1] {
        let mut chains = world();
        for _ in 0..4 {
            let far = |k: i32| vec2(if k % 2 == 0 { -4000 } else { 4000 }, Fx::from_ratio(k.into(), 32));
            let points: Vec<_> = (0..1 << 14).map(far).collect();
            let shape = Shape::chain(&points, false).expect("a chain");
            let collider = ColliderDef { position: vec2(x, 0), ..ColliderDef::new(shape) };
            chains.add_body(BodyDef::fixed().with_collider(collider)).expect("a body");
        }
        held("chains", &chains);
    }
    let mut blob = world();
    blob.set_blob(&vec![1; umbra_physics::limits::BLOB]).expect("it is allowed");
    held("a blob", &blob);
}

#[test]
fn commands_of_what_takes_little_in_a_file() {
    let def = BodyDef::dynamic().with_collider(Shape::compound(&parts(256, fx!(0))).expect("a shape"));
    for command in [Command::AddBody(def), Command::SetBlob(vec![1; 1 << 22])] {
        let read = |file: &[u8]| Command::from_bytes(file).expect("a command");
        assert_eq!(bounded("a command", &command.to_bytes(), read), command);
    }
}

/// A replay is read, verified, and gone about in, and a dump of its first tick is read, within the bound.
fn played(what: &str, file: &[u8]) {
    let read = |file: &[u8]| Replay::from_bytes(file, &[]).expect("a replay");
    bounded(what, file, |file| drop(read(file)));
    bounded(what, file, |file| read(file).verify().expect("it goes as recorded"));
    bounded(what, file, |file| {
        let replay = read(file);
        let mut playback = replay.play();
        for tick in [replay.end(), 0, replay.end() / 2] {
            playback.seek(tick);
            assert!(playback.commands().count() < file.len());
        }
    });
    let mut changed = file.to_vec();
    // Amid its ticks.
    let middle = file.len() / 2;
    changed[middle] ^= 1;
    bounded(what, &changed, |file| assert!(Replay::from_bytes(file, &[]).is_err()));
    let second = bounded(what, file, |file| Replay::from_bytes(file, &[]).expect("a replay"));
    bounded(what, file, |file| assert_eq!(read(file).first_difference(&second), None));
    for (tag, contents) in seals::chunks(file) {
        if tag == *b"TICK" && contents[8..12] == [1, 0, 0, 0] {
            let mut dump = seals::begin(b"UMBRADMP");
            chunk(&mut dump, b"PHYS", &umbra_physics::PHYSICS_VERSION.to_le_bytes());
            chunk(&mut dump, &tag, &contents);
            bounded(what, &dump, |file| assert!(Dump::from_bytes(file, &[]).is_err(), "it has no moments"));
        }
    }
}

#[test]
fn replays_of_what_takes_little_in_a_file() {
    // Neither hashes nor snapshots between.
    let bare = RecordOptions { hash_every: 1 << 30, snapshot_every: 0 };
    let mut world = world();
    let mut recorder = Recorder::new(&world, bare);
    for _ in 0..times(30_000) {
        recorder.execute(&mut world, &Command::ClearForces).expect("it is always allowed");
    }
    recorder.step(&mut world, &Inputs::new());
    played("the shortest calls", &recorder.finish(&world));

    let mut recorder = Recorder::new(&world, bare);
    let shortest = |player| Input { player, sequence: 0, command: Command::ClearForces };
    let inputs = Inputs::try_from((0..times(5_000)).map(shortest).collect::<Vec<_>>()).expect("each has a place");
    recorder.step(&mut world, &inputs);
    played("the shortest inputs", &recorder.finish(&world));

    let mut recorder = Recorder::new(&world, bare);
    let count = times(5_000u32);
    (0..count).for_each(|_| _ = recorder.step(&mut world, &Inputs::new()));
    let file = recorder.finish(&world);
    played("the shortest ticks", &file);
    // A chunk for each of them, and all in one chunk: refused for that, and at no greater price.
    let [mut alone, mut together] = [(); 2].map(|()| seals::begin(b"UMBRAREP"));
    let (mut ticks, mut tick) = (Vec::new(), 0u64);
    for (tag, contents) in seals::chunks(&file) {
        if tag == *b"TICK" {
            tick = tick.max(u64::from_le_bytes(contents[..8].try_into().expect("eight")));
            for entry in contents[12..].chunks(9) {
                chunk(&mut alone, &tag, &[&tick.to_le_bytes(), &1u32.to_le_bytes()[..], entry].concat());
                ticks.extend_from_slice(entry);
                tick += 1;
            }
            continue;
        }
        if !ticks.is_empty() {
            let head = [&(tick - u64::from(count)).to_le_bytes()[..], &count.to_le_bytes()].concat();
            chunk(&mut together, b"TICK", &[head, core::mem::take(&mut ticks)].concat());
        }
        chunk(&mut alone, &tag, &contents);
        chunk(&mut together, &tag, &contents);
    }
    for (what, file) in [("a chunk a tick", &alone), ("ticks in a chunk", &together)] {
        let error = bounded(what, file, |file| Replay::from_bytes(file, &[]).expect_err("no recorder writes it"));
        assert_eq!(error.code(), 406, "{what}: {error}");
    }

    let mut recorder = Recorder::new(&world, RecordOptions { hash_every: 1 << 30, snapshot_every: 1 });
    (0..times(300)).for_each(|_| _ = recorder.step(&mut world, &Inputs::new()));
    played("snapshots of nothing", &recorder.finish(&world));
}

#[test]
fn a_run_that_parts_is_named_within_the_bound() {
    let mut world = world();
    for i in 0..times(500) {
        world.add_body(BodyDef { position: vec2(i, 0), velocity: vec2(1, 0), ..BodyDef::dynamic() }).expect("a body");
    }
    let mut recorder = Recorder::new(&world, RecordOptions { hash_every: 1, snapshot_every: 0 });
    recorder.step(&mut world, &Inputs::new());
    // All of them, past the recorder: every value of every body differs.
    for body in world.bodies().map(|body| body.id()).collect::<Vec<_>>() {
        world.set_velocity(body, vec2(-1, 3)).expect("it moves");
    }
    recorder.step(&mut world, &Inputs::new());
    let file = recorder.finish(&world);
    bounded("a divergence", &file, |file| {
        let replay = Replay::from_bytes(file, &[]).expect("a replay");
        assert_eq!(replay.verify().expect_err("it parts").difference.field, "position.x");
    });
}

#[test]
fn names_of_one_letter_and_a_world_of_nobody() {
    let (start, mut recorder) = (world(), Recorder::new(&world(), RecordOptions::default()));
    for slot in 0..times(10_000) {
        recorder.labels_mut().set_body(BodyId::from_parts(slot, 0), "x");
        recorder.labels_mut().set_field(FieldId::from_parts(slot, 0), "x");
        recorder.labels_mut().set_collider(ColliderId::from_parts(slot, 0), "x");
        recorder.labels_mut().set_joint(JointId::from_parts(slot, 0), "x");
    }
    let file = recorder.finish(&start);
    let replay = bounded("names", &file, |file| Replay::from_bytes(file, &[])).expect("it is whole");
    assert!(replay.to_bytes() == file);
}

#[test]
fn dumps_in_which_nothing_happens() {
    let mut before = World::new(WorldDef { integrator: Integrator::Yoshida4, ..WorldDef::default() }).expect("a world");
    for i in 0..1_000 {
        before.add_body(BodyDef { user_data: i, ..BodyDef::dynamic() }).expect("a body");
    }
    let mut after = before.clone();
    after.step();
    // With Yoshida4 a tick has 26 moments; at most of them the world is as it was at the one before.
    let dump = Dump::of_tick(&before, &[], &Inputs::new(), &after).to_bytes();
    let read = bounded("a dump", &dump, |file| Dump::from_bytes(file, &[]).expect("a dump"));
    assert!(read.phases().len() >= 26 && dump.len() < 6 * before.snapshot().to_bytes().len(), "{}", dump.len());
}

/// A dump each moment of which has a world of its own, as no step makes them.
fn parted(what: &str, world: &World) {
    let dump = Dump::of_tick(world, &[], &Inputs::new(), world);
    let mut file = seals::begin(b"UMBRADMP");
    for (number, (tag, contents)) in seals::chunks(&dump.to_bytes()).into_iter().enumerate() {
        if tag != *b"PHAS" {
            chunk(&mut file, &tag, &contents);
            continue;
        }
        // A stage is five bytes more; then whether the world is new, and it.
        let (phase, is_last) = (if contents[0] == 3 { 6 } else { 1 }, contents[0] == 4);
        let mut changed_world = world.clone();
        if !is_last {
            changed_world.set_blob(&[number as u8]).expect("it is short");
        }
        chunk(&mut file, &tag, &[&contents[..phase], &[1], &changed_world.snapshot().to_bytes()].concat());
    }
    let read = bounded(what, &file, |file| Dump::from_bytes(file, &custom_forces()).expect("a dump"));
    assert_eq!(read.phases().len(), 26);
}

/// Small worlds take most for what a file says of them: there is room for bodies to come in each.
#[test]
fn dumps_of_worlds_that_are_all_different() {
    let empty = World::new(WorldDef { integrator: Integrator::Yoshida4, ..WorldDef::default() }).expect("a world");
    for count in [0, 1, 2, 4, 5, 16, 17, 32, 40, 100] {
        let mut world = empty.clone();
        for i in 0..count {
            world.add_body(BodyDef { user_data: i, ..BodyDef::dynamic() }).expect("a body");
        }
        parted(&format!("a dump of {count}"), &world);
    }
    let mut world = empty.clone();
    world.register_custom_force(custom_forces().remove(0)).expect("a law");
    world.add_field(FieldKind::Custom { id: 9 }).expect("a field");
    parted("a dump of a field", &world);
    let field = world.add_field(FieldKind::Custom { id: 9 }).expect("a field");
    world.remove_field(field).expect("it is there");
    let gone = world.add_body(BodyDef::dynamic()).expect("a body");
    let disc = BodyDef::dynamic().with_collider(Shape::circle(fx!(1)).expect("a shape"));
    let pushed = world.add_body(BodyDef { gravity_scale: fx!(2), ..disc }).expect("a body");
    world.remove_body(gone).expect("it is there");
    world.apply_force(pushed, vec2(1, 0)).expect("it is dynamic");
    parted("a dump of one pushed", &world);
    let lift = world.add_body(BodyDef::kinematic()).expect("a body");
    world.move_to(lift, vec2(1, 1), fx!(0)).expect("it is kinematic");
    parted("a dump of one with a goal", &world);
    pin(&mut world, pushed);
    parted("a dump of one with a joint", &world);
}

/// 4 GiB, or more than there can be, announced in a hundred bytes.
#[test]
fn announced_lengths_do_not_make_room() {
    let snapshot = world().snapshot().to_bytes();
    let replay = Recorder::new(&world(), RecordOptions::default()).finish(&world());
    for claim in [u32::MAX, u32::MAX / 2, 1 << 24] {
        let claimed_bytes = claim.to_le_bytes();
        for at in (16..snapshot.len() - 20).step_by(if is_short() { 7 } else { 1 }) {
            let mut changed = snapshot.clone();
            changed[at..at + 4].copy_from_slice(&claimed_bytes);
            changed.truncate(at + 20);
            _ = bounded("a snapshot", &changed, |file| Snapshot::from_bytes(file, &[]).map(drop));
        }
        for (tag, least) in [(b"SNAP", 16), (b"HEAD", 16), (b"TICK", 16), (b"DONE", 0)] {
            let mut word = [&tag[..], &claimed_bytes].concat();
            word.extend(word.clone().iter().map(|byte| !byte));
            let mut file = seals::begin(b"UMBRAREP");
            file.extend(word);
            file.resize(file.len() + least, 0);
            assert!(bounded("a chunk", &file, |file| Replay::from_bytes(file, &[]).is_err()));
        }
        for &tag in Command::<Fx>::NUMBERS {
            for before in 0..40 {
                let command = [&[tag][..], &vec![0; before], &claimed_bytes, &[0; 50]].concat();
                _ = bounded("a command", &command, |file| Command::<Fx>::from_bytes(file).map(drop));
            }
        }
    }
    assert!(Replay::from_bytes(&replay, &[]).is_ok());
}

/// Reads a scene and asserts what `Scene::parse_within` promises of it.
fn scene(what: &str, text: &str, written_out: usize, limit: u32) -> Result<Scene, u16> {
    let mut result = None;
    let taken = measure(|| result = Some(Scene::parse_within(text, limit))).bytes_max;
    let result = result.expect("it was read");
    let things =
        result.as_ref().map_or(limit as usize, |scene| scene.bodies.len() + scene.fields.len() + scene.inputs.len());
    let bound = 8 * (text.len() + written_out) as u64 + 4_096 * things as u64 + ANY;
    if std::env::var_os("UMBRA_SAY").is_some() {
        println!("{what:<28} {:>9} {things:>9} {taken:>10} {:>6.2}", text.len(), taken as f64 / bound as f64);
    }
    assert!(taken <= bound, "{what}: {taken} bytes taken for {} and {things} things", text.len());
    result.map_err(|errors| {
        for error in errors.errors() {
            assert!(error.place.line >= 1 && error.to_string().len() < 1_000, "{error}");
        }
        assert!(errors.errors().len() <= SceneErrors::LISTED);
        errors.code()
    })
}

#[test]
fn scenes_of_what_takes_little_in_a_file() {
    const MANY: usize = 200_000;
    let list = |item: &str| format!("[{}]", vec![item; MANY].join(","));
    let body = |fields: &str| format!(r#"{{"bodies": [{{"name": "a", {fields}}}]}}"#);
    let refused = |what: &str, text: String| scene(what, &text, 0, 10).expect_err("it is refused");
    assert_eq!(refused("a long vector", format!(r#"{{"gravity": {}}}"#, list("1"))), 502);
    assert_eq!(
        refused("corners", body(&format!(r#""colliders": [{{"shape": {{"polygon": {}}}}}]"#, list("[0,1]")))),
        101
    );
    assert_eq!(refused("parts", body(&format!(r#""colliders": [{{"shape": {{"compound": {}}}}}]"#, list("{}")))), 101);
    assert_eq!(refused("bodies of nothing", format!(r#"{{"bodies": {}}}"#, list("1"))), 502);
    assert_eq!(refused("inputs of nothing", format!(r#"{{"inputs": {}}}"#, list("{}"))), 505);
    assert_eq!(refused("empty lines", "\n".repeat(MANY) + "[]"), 502);
    assert_eq!(refused("lists in lists", format!(r#"{{"gravity": {}}}"#, "[".repeat(MANY) + &"]".repeat(MANY))), 502);
    assert_eq!(refused("open lists", "[".repeat(MANY)), 501);
    assert_eq!(refused("a long name", format!(r#"{{"{}": 1}}"#, "x".repeat(MANY))), 503);
    assert_eq!(refused("a long number", format!(r#"{{"gravity": [0.{}, x]}}"#, "1".repeat(MANY))), 501);
    let fields = |name: fn(usize) -> String| (0..MANY).map(name).collect::<Vec<_>>().join(",");
    assert_eq!(refused("one field again", format!("{{{}}}", fields(|_| r#""a":0"#.into()))), 504);
    assert_eq!(refused("many fields", format!("{{{}}}", fields(|i| format!(r#""{i}":0"#)))), 510);

    let force_groups = body(&format!(r#""force_groups": {}"#, list("31")));
    assert!(scene("groups", &force_groups, 0, 10).is_ok());
    let trails = format!(r#"{{"bodies": [{{"name": "a"}}], "plot": {{"trails": {}}}}}"#, list(r#""a""#));
    assert!(scene("trails", &trails, 0, 10).is_ok());
    let number = body(&format!(r#""mass": 1.{}"#, "0".repeat(MANY)));
    assert!(scene("a long number", &number, 0, 10).is_ok());
    let about = format!(r#"{{"about": "{}"}}"#, "x".repeat(MANY));
    assert!(scene("a long text", &about, 0, 10).is_ok());
    assert!(scene("empty lines", &("{}".to_owned() + &"\n".repeat(MANY)), 0, 10).is_ok());
}

#[test]
fn scenes_that_make_many_from_one() {
    let bodies =
        |count: u64, more: &str| format!(r#"{{"bodies": [{{"name": "{{i}}", "repeat": {{"i": {count}}}{more}}}]}}"#);
    let limit = 20_000;
    let written = |text: &String| text.len() * limit as usize;
    let text = bodies(limit.into(), "");
    assert!(scene("bodies", &text, written(&text), limit).is_ok());
    let text = bodies(
        limit.into(),
        r#", "colliders": [{"shape": {"circle": {"radius": {"start": 1, "i": 0.001}}}, "mask": []}], "gravity_scale": {"i": 1e-7}"#,
    );
    assert!(scene("bodies unlike", &text, written(&text), limit).is_ok());
    let text = r#"{"fields": [{"drag": {}, "repeat": {"i": 20000}}]}"#.to_owned();
    assert!(scene("fields", &text, written(&text), limit).is_ok());
    let text = r#"{"bodies": [{"name": "a"}], "inputs": [{"at": 1, "body": "a", "force": [0, 0], "torque": 0, "repeat": {"i": 10000}}]}"#.to_owned();
    assert!(scene("inputs", &text, written(&text), limit).is_ok());
    let sets = vec![r#"{"at":1,"body":"a","set":{"key":1,"angle":1,"mass":1,"user_data":1,"force_groups":[]}}"#; 4_000]
        .join(",");
    let text = format!(r#"{{"bodies":[{{"name":"a"}}],"inputs":[{sets}]}}"#);
    assert!(scene("inputs that set", &text, 0, limit).is_ok());
    assert_eq!(scene("and too much", &text, 0, limit - 1).map(drop), Err(510));

    // More than may be: refused before any is made, by line and field.
    for (count, more) in [(20_001, ""), (2_000_000_000, ""), (1, r#", "x": 1"#)] {
        let text = bodies(count, more);
        let error = Scene::parse_within(&text, limit).expect_err("too many").code();
        assert_eq!(error, if more.is_empty() { 510 } else { 503 });
    }
    let square = r#"{"bodies": [
        {"name": "{i} {j}", "repeat": {"i": [-2147483648, 2147483647], "j": [-2147483648, 2147483647]}}]}"#;
    let error = Scene::parse(square).expect_err("too many");
    let error = error.first();
    assert_eq!((error.code(), error.place.line, &error.place.field[..]), (510, 2, "bodies[0].repeat"));
    assert_eq!(scene("a square", square, 0, 10).map(drop), Err(510));
    // Repetitions are of things, not of what is in them.
    let nested = r#"{"bodies": [{"name": "a", "repeat": {"i": 2, "repeat": {"i": 2}}}]}"#;
    assert_eq!(scene("nested", nested, 0, 10).map(drop), Err(503));
    let nested = r#"{"bodies": [{"name": "{i}", "repeat": {"i": 2}, "colliders": [{"shape": {"compound": [{"repeat": {"i": 2}, "shape": {"circle": {"radius": 1}}}]}}]}]}"#;
    assert_eq!(scene("nested", nested, 0, 10).map(drop), Err(503));
    // A long text again and again.
    let long =
        format!(r#", "colliders": [{{"shape": {{"polygon": [[0, 0], [1, 0], [0, {}1]]}}}}]"#, " ".repeat(20_000));
    assert_eq!(scene("long texts", &bodies(1_000, &long), 0, 1_000).map(drop), Err(510));
    let name = format!(r#"{{"bodies": [{{"name": "{}", "repeat": {{"i": 2}}}}]}}"#, "{i}".repeat(300));
    assert_eq!(scene("a long name", &name, 0, 10).map(drop), Err(509));
    // Made with repetitions, and without: both count.
    let both = r#"{"bodies": [{"name": "a"}, {"name": "b{i}", "repeat": {"i": 9}}, {"name": "c"}]}"#;
    assert_eq!((scene("both", both, 0, 10).map(drop), scene("both", both, 0, 11).map(drop)), (Err(510), Ok(())));
    let added = r#"{"bodies": [{"name": "b{i}", "repeat": {"i": 10}}], "inputs": [{"at": 1, "add": {"name": "c"}}]}"#;
    assert_eq!((scene("added", added, 0, 10).map(drop), scene("added", added, 0, 11).map(drop)), (Err(510), Ok(())));
    let added = r#"{"fields": [{"drag": {}, "repeat": {"i": 10}}], "inputs": [{"at": 1, "add_field": {"drag": {}}}]}"#;
    assert_eq!((scene("added", added, 0, 10).map(drop), scene("added", added, 0, 11).map(drop)), (Err(510), Ok(())));
}
