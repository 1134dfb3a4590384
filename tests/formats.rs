//! `docs/formats.md` is right: a reader that knows nothing but its tables reads files and commands, and what it finds is what
//! the library says. The files of every format and law so far are in `tests/files`.
//!
//! `UMBRA_BLESS=1 cargo test --release --test formats` adds those of a new format or law. It never writes over one: those of
//! older laws are to be refused, with both numbers.

#[path = "support/formats.rs"]
mod formats;

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Arc, Once};
use std::{env, fs};

use formats::{Content, Layouts, Value};
use umbra_physics::scalar::{Accumulator, Angle, Factor};
use umbra_physics::{
    Action, Activity, Attachment, BodyDef, BodyId, BodyKind, BodyState, Command, Dependence, End, Field, FieldId,
    ForceLaw, Frame, Fx, FxFactor, Input, Inputs, Integrator, LAW, Law, LawFault, Manner, Mass, Part, Push, Random,
    RecordOptions, Recorder, Region, Replay, ReplayError, Shape, Snapshot, SnapshotError, SpringLaw, TimeStep, Vec2,
    World, WorldDef, fx, vec2,
};
use xxhash_rust::xxh3::xxh3_64;

struct Still;

impl ForceLaw for Still {
    fn id(&self) -> u64 {
        9
    }
    fn version(&self) -> u32 {
        2
    }
    fn depends_on(&self) -> Dependence {
        Dependence::Nothing
    }
    fn push(&self, _: &BodyState) -> Result<Push, LawFault> {
        Ok(Push::default())
    }
}

fn laws() -> Vec<Arc<dyn ForceLaw>> {
    vec![Arc::new(Still)]
}

fn shapes() -> Vec<Shape> {
    let disc = Shape::circle(fx!(0.5)).expect("a shape");
    let part = |x| Part { shape: disc.clone(), position: vec2(x, 0), angle: fx!(0.1), density: fx!(1) };
    vec![
        disc.clone(),
        Shape::rectangle(fx!(1), fx!(2)).expect("a shape"),
        Shape::capsule(fx!(1), fx!(0.5)).expect("a shape"),
        // Clockwise, and not about its centre.
        Shape::polygon(&[vec2(3, 3), vec2(fx!(3.1), fx!(5.7)), vec2(4, fx!(4.2))]).expect("a shape"),
        Shape::segment(vec2(0, 0), vec2(0, 1)).expect("a shape"),
        Shape::compound(&[part(-1), part(2)]).expect("a shape"),
    ]
}

/// A law of each kind, on the bodies in slots 1 and 2.
fn fields() -> Vec<Field> {
    let at = |slot| Attachment { body: BodyId::from_parts(slot, 0), point: vec2(0, fx!(0.25)) };
    let spring = SpringLaw { rest: fx!(1), stiffness: fx!(3), damping: fx!(0.5) };
    let mu: FxFactor = "2.5".parse().expect("a factor");
    let laws = [
        Law::Attractor { centre: End::Body(at(2)), mu, softening: fx!(0.5) },
        Law::Attractor { centre: End::World(vec2(1, 2)), mu, softening: fx!(0.5) },
        Law::Spring { near: at(1), far: End::Body(at(2)), spring },
        Law::Spring { near: at(1), far: End::World(vec2(5, 5)), spring },
        Law::Drag { linear: fx!(0.1), quadratic: fx!(0.2), wind: vec2(1, 0) },
        Law::Thrust { at: at(1), force: vec2(1, 1) },
        Law::Zone { region: Region::Disc { centre: vec2(0, 0), radius: fx!(3) }, acceleration: vec2(0, 1) },
        Law::Zone { region: Region::Box { min: vec2(0, 0), max: vec2(1, 1) }, acceleration: vec2(0, 1) },
        Law::Custom { id: 9 },
    ];
    laws.map(|law| Field { law, groups: 5 }).into()
}

/// Every command there is, the shortest and the longest of each; all are allowed in the world that is recorded.
fn commands() -> Vec<Command> {
    let body = BodyId::from_parts(1, 0);
    let point = Some(vec2(fx!(0.5), fx!(-7)));
    let actions = [
        Action::Force { force: vec2(1, -2), point },
        Action::Torque(fx!(0.5)),
        Action::Impulse { impulse: vec2(1, 2), point: None },
        Action::AngularImpulse(fx!(-0.25)),
    ];
    let manner = Manner { frame: Frame::Body, wake: false };
    let mut commands: Vec<Command> = actions.map(|action| Command::Apply { body, action, manner }).into();
    let masses = [Mass::Density(fx!(2)), Mass::Of(fx!(3)), Mass::WithInertia(fx!(4), fx!(5))];
    commands.extend(masses.map(|mass| Command::SetMass { body, mass }));
    commands.extend(shapes().into_iter().map(|shape| Command::SetShape { body, shape: Some(shape) }));
    commands.extend(fields().into_iter().map(Command::AddField));
    let damped = BodyDef { linear_damping: Some(fx!(0.5)), angular_damping: Some(fx!(0.25)), ..BodyDef::dynamic() };
    let set_field = |field| Command::SetField { id: FieldId::from_parts(0, 0), field };
    commands.extend([
        Command::AddBody(BodyDef {
            mass: Mass::WithInertia(fx!(2), fx!(3)),
            position: vec2(fx!(0.125), -8),
            angle: fx!(0.75),
            velocity: vec2(-3, 4),
            angular_velocity: fx!(-1),
            gravity_scale: fx!(2),
            groups: 6,
            key: 7,
            user_data: u64::MAX,
            ..damped
        }),
        Command::AddBody(BodyDef { shape: shapes().pop(), kind: BodyKind::Kinematic, ..BodyDef::dynamic() }),
        Command::AddBody(BodyDef::fixed()),
        Command::SetPosition { body, position: vec2(1, -2) },
        Command::SetAngle { body, angle: fx!(1) },
        Command::SetVelocity { body, velocity: vec2(1, 2) },
        Command::SetAngularVelocity { body, velocity: fx!(0.5) },
        Command::SetKind { body, kind: BodyKind::Dynamic },
        Command::SetGravityScale { body, scale: fx!(-0.5) },
        Command::SetBodyDamping { body, linear: Some(fx!(0.5)), angular: Some(fx!(0.75)) },
        Command::SetBodyDamping { body, linear: None, angular: None },
        Command::SetGroups { body, groups: 3 },
        Command::SetKey { body, key: 1 << 40 },
        Command::SetUserData { body, user_data: 6 },
        Command::Wake(body),
        Command::Release(BodyId::from_parts(7, 0)),
        set_field(fields()[2]),
        set_field(fields()[8]),
        Command::SetTimeStep(TimeStep::ratio(1001, 60_000)),
        Command::SetGravity(vec2(0, -9)),
        Command::SetIntegrator(Integrator::PublishedVerlet),
        Command::SetDamping { linear: fx!(0.5), angular: fx!(0.25) },
        Command::SetSleepAfter(None),
        Command::SetSleepAfter(Some(20)),
        Command::SetRandom(Random::seeded(3)),
        Command::SetBlob(vec![1, 2, 3]),
        Command::ClearForces,
        Command::SetShape { body: BodyId::from_parts(0, 0), shape: None },
        Command::RemoveField(FieldId::from_parts(0, 0)),
        Command::RemoveBody(BodyId::from_parts(3, 0)),
    ]);
    commands
}

/// A world with something of everything: every shape, one of them twice, every law, free slots, bodies asleep and
/// quarantined, forces that wait for the next step.
fn world() -> World {
    let def = WorldDef { gravity: vec2(0, -10), sleep_after: Some(2), ..WorldDef::default() };
    let mut world = World::new(def).expect("a world");
    world.register_law(laws().remove(0)).expect("a law");
    for shape in shapes().into_iter().chain([shapes().remove(0)]) {
        let def = BodyDef { shape: Some(shape), position: vec2(fx!(0.3), 3), ..BodyDef::dynamic() };
        world.add_body(BodyDef { angular_velocity: fx!(1), linear_damping: Some(fx!(0.9)), ..def }).expect("a body");
    }
    // Beyond the envelope with its first step.
    let edge = BodyDef { position: vec2(1 << 30, 0), velocity: vec2(1 << 20, 0), ..BodyDef::dynamic() };
    world.add_body(edge).expect("a body");
    for field in fields() {
        world.add_field(field).expect("a field");
    }
    let gone = world.add_field(fields()[3]).expect("a field");
    world.remove_field(gone).expect("it is there");
    world.set_blob(b"some bytes of the game's").expect("few");
    world.add_body(BodyDef { gravity_scale: Fx::ZERO, groups: 0, ..BodyDef::dynamic() }).expect("a body");
    let gone = world.add_body(BodyDef::fixed()).expect("a body");
    world.remove_body(gone).expect("it is there");
    for _ in 0..9 {
        world.step();
    }
    for (slot, push) in [(1, -2), (4, 3)] {
        let body = BodyId::from_parts(slot, 0);
        world.apply_force_at_point(body, vec2(fx!(-0.1), push), vec2(3, 4)).expect("a force");
    }
    world
}

/// All commands, a few a tick: by the level itself, and by two players.
fn recording() -> Vec<u8> {
    let mut world = world();
    let mut recorder = Recorder::new(&world, RecordOptions { hash_every: 1, snapshot_every: 8 });
    for (tick, some) in commands().chunks(4).enumerate() {
        let mut inputs = Inputs::new();
        for (i, command) in some.iter().enumerate() {
            if i == 3 {
                recorder.execute(&mut world, command).expect("it is allowed");
            } else {
                let (player, sequence) = ((tick + i) as u32 % 2, i as u32);
                inputs.insert(Input { player, sequence, command: command.clone() }).expect("the first");
            }
        }
        if tick == 5 {
            _ = world.random_mut().bits();
        }
        recorder.step(&mut world, &inputs);
        assert!(recorder.outcomes().iter().all(|outcome| outcome.result.is_ok()), "{:?}", recorder.outcomes());
    }
    recorder.step(&mut world, &Inputs::new());
    recorder.finish(&world)
}

// What is found, as what the library has.

fn number(value: &Value) -> Fx {
    Fx::from_bits(value.integer() as i64)
}

fn vector(value: &Value) -> Vec2 {
    Vec2::new(number(&value["x"]), number(&value["y"]))
}

fn body(value: &Value) -> BodyId {
    BodyId::from_parts(value["slot"].natural() as u32, value["generation"].natural() as u32)
}

fn field_id(value: &Value) -> FieldId {
    FieldId::from_parts(value["slot"].natural() as u32, value["generation"].natural() as u32)
}

fn kind(value: &Value) -> BodyKind {
    match value.case() {
        "Static" => BodyKind::Static,
        "Kinematic" => BodyKind::Kinematic,
        "Dynamic" => BodyKind::Dynamic,
        other => panic!("kind {other}"),
    }
}

fn activity(value: &Value) -> Activity {
    match value.case() {
        "Awake" => Activity::Awake,
        "Asleep" => Activity::Asleep,
        "Quarantined" => Activity::Quarantined,
        other => panic!("activity {other}"),
    }
}

fn integrator(value: &Value) -> Integrator {
    match value.case() {
        "ExplicitEuler" => Integrator::ExplicitEuler,
        "SymplecticEuler" => Integrator::SymplecticEuler,
        "VelocityVerlet" => Integrator::VelocityVerlet,
        "PublishedVerlet" => Integrator::PublishedVerlet,
        "Yoshida4" => Integrator::Yoshida4,
        other => panic!("integrator {other}"),
    }
}

fn time_step(value: &Value) -> TimeStep {
    TimeStep::ratio(value["num"].natural() as u32, value["den"].natural() as u32)
}

fn random(value: &Value) -> Random {
    Random::from_state(value.words()).expect("a state")
}

fn mass(value: &Value) -> Mass {
    match value.case() {
        "Density" => Mass::Density(number(&value["density"])),
        "Of" => Mass::Of(number(&value["mass"])),
        "WithInertia" => Mass::WithInertia(number(&value["mass"]), number(&value["inertia"])),
        other => panic!("mass {other}"),
    }
}

fn shape(value: &Value) -> Shape {
    let part = |part: &Value| Part {
        shape: shape(&part["shape"]),
        position: vector(&part["position"]),
        angle: number(&part["angle"]),
        density: number(&part["density"]),
    };
    let made = match value.case() {
        "Circle" => Shape::circle(number(&value["radius"])),
        "Rectangle" => Shape::rectangle(number(&value["width"]), number(&value["height"])),
        "Capsule" => Shape::capsule(number(&value["length"]), number(&value["radius"])),
        "Polygon" => Shape::polygon(&value["corners"].list().iter().map(vector).collect::<Vec<_>>()),
        "Segment" => Shape::segment(vector(&value["a"]), vector(&value["b"])),
        "Compound" => Shape::compound(&value["parts"].list().iter().map(part).collect::<Vec<_>>()),
        other => panic!("shape {other}"),
    };
    made.expect("a shape")
}

fn attachment(value: &Value) -> Attachment {
    Attachment { body: body(&value["body"]), point: vector(&value["point"]) }
}

fn end(value: &Value) -> End {
    match value.case() {
        "World" => End::World(vector(&value["point"])),
        "Body" => End::Body(attachment(&value["attachment"])),
        other => panic!("end {other}"),
    }
}

fn region(value: &Value) -> Region {
    match value.case() {
        "Disc" => Region::Disc { centre: vector(&value["centre"]), radius: number(&value["radius"]) },
        "Box" => Region::Box { min: vector(&value["min"]), max: vector(&value["max"]) },
        other => panic!("region {other}"),
    }
}

/// mantissa · 2^-shift.
fn factor(value: &Value) -> FxFactor {
    let [shift, mantissa] = value.words();
    assert!(mantissa >> 63 == 1 && shift < 64, "{mantissa} and {shift}");
    FxFactor::from_ratio(mantissa, 1 << shift)
}

fn field(value: &Value) -> Field {
    let law = &value["law"];
    let spring = |value: &Value| SpringLaw {
        rest: number(&value["rest"]),
        stiffness: number(&value["stiffness"]),
        damping: number(&value["damping"]),
    };
    let law = match law.case() {
        "Attractor" => {
            Law::Attractor { centre: end(&law["centre"]), mu: factor(&law["mu"]), softening: number(&law["softening"]) }
        }
        "Spring" => {
            Law::Spring { near: attachment(&law["near"]), far: end(&law["far"]), spring: spring(&law["spring"]) }
        }
        "Drag" => Law::Drag {
            linear: number(&law["linear"]),
            quadratic: number(&law["quadratic"]),
            wind: vector(&law["wind"]),
        },
        "Thrust" => Law::Thrust { at: attachment(&law["at"]), force: vector(&law["force"]) },
        "Zone" => Law::Zone { region: region(&law["region"]), acceleration: vector(&law["acceleration"]) },
        "Custom" => Law::Custom { id: law["id"].natural() },
        other => panic!("law {other}"),
    };
    Field { law, groups: value["groups"].natural() as u32 }
}

fn action(value: &Value) -> Action {
    let point = || value["point"].option().map(vector);
    match value.case() {
        "Force" => Action::Force { force: vector(&value["force"]), point: point() },
        "Torque" => Action::Torque(number(&value["torque"])),
        "Impulse" => Action::Impulse { impulse: vector(&value["impulse"]), point: point() },
        "AngularImpulse" => Action::AngularImpulse(number(&value["impulse"])),
        other => panic!("action {other}"),
    }
}

fn manner(value: &Value) -> Manner {
    let frame = match value["frame"].case() {
        "World" => Frame::World,
        "Body" => Frame::Body,
        other => panic!("frame {other}"),
    };
    Manner { frame, wake: value["wake"].natural() == 1 }
}

fn body_def(value: &Value) -> BodyDef {
    BodyDef {
        kind: kind(&value["kind"]),
        position: vector(&value["position"]),
        angle: number(&value["angle"]),
        velocity: vector(&value["velocity"]),
        angular_velocity: number(&value["angular_velocity"]),
        shape: value["shape"].option().map(shape),
        mass: mass(&value["mass"]),
        gravity_scale: number(&value["gravity_scale"]),
        linear_damping: value["linear_damping"].option().map(number),
        angular_damping: value["angular_damping"].option().map(number),
        groups: value["groups"].natural() as u32,
        key: value["key"].natural(),
        user_data: value["user_data"].natural(),
    }
}

fn command(value: &Value) -> Command {
    let on = || body(&value["body"]);
    match value.case() {
        "AddBody" => Command::AddBody(body_def(&value["def"])),
        "RemoveBody" => Command::RemoveBody(on()),
        "Apply" => Command::Apply { body: on(), action: action(&value["action"]), manner: manner(&value["manner"]) },
        "SetPosition" => Command::SetPosition { body: on(), position: vector(&value["position"]) },
        "SetAngle" => Command::SetAngle { body: on(), angle: number(&value["angle"]) },
        "SetVelocity" => Command::SetVelocity { body: on(), velocity: vector(&value["velocity"]) },
        "SetAngularVelocity" => Command::SetAngularVelocity { body: on(), velocity: number(&value["velocity"]) },
        "SetMass" => Command::SetMass { body: on(), mass: mass(&value["mass"]) },
        "SetShape" => Command::SetShape { body: on(), shape: value["shape"].option().map(shape) },
        "SetKind" => Command::SetKind { body: on(), kind: kind(&value["kind"]) },
        "SetGravityScale" => Command::SetGravityScale { body: on(), scale: number(&value["scale"]) },
        "SetBodyDamping" => Command::SetBodyDamping {
            body: on(),
            linear: value["linear"].option().map(number),
            angular: value["angular"].option().map(number),
        },
        "SetGroups" => Command::SetGroups { body: on(), groups: value["groups"].natural() as u32 },
        "SetKey" => Command::SetKey { body: on(), key: value["key"].natural() },
        "SetUserData" => Command::SetUserData { body: on(), user_data: value["user_data"].natural() },
        "Wake" => Command::Wake(on()),
        "Release" => Command::Release(on()),
        "AddField" => Command::AddField(field(&value["field"])),
        "SetField" => Command::SetField { id: field_id(&value["id"]), field: field(&value["field"]) },
        "RemoveField" => Command::RemoveField(field_id(&value["id"])),
        "SetTimeStep" => Command::SetTimeStep(time_step(&value["time_step"])),
        "SetGravity" => Command::SetGravity(vector(&value["gravity"])),
        "SetIntegrator" => Command::SetIntegrator(integrator(&value["integrator"])),
        "SetDamping" => Command::SetDamping { linear: number(&value["linear"]), angular: number(&value["angular"]) },
        "SetSleepAfter" => Command::SetSleepAfter(value["ticks"].option().map(|ticks| ticks.natural() as u32)),
        "SetRandom" => Command::SetRandom(random(&value["random"])),
        "SetBlob" => Command::SetBlob(value["bytes"].raw().to_vec()),
        "ClearForces" => Command::ClearForces,
        other => panic!("command {other}"),
    }
}

/// The hash of a state as the document has it.
fn hash_of(state: &Value) -> u64 {
    let mut hashed = LAW.to_le_bytes().to_vec();
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
        let names =
            ["kind", "groups", "key", "user_data", "mass", "gravity_scale", "linear_damping", "angular_damping"];
        let mut card: Vec<u8> = names.iter().flat_map(|name| body[name].bytes()).copied().collect();
        match shape_of(slots, body) {
            None => card.push(0),
            Some(shape) => {
                card.push(1);
                card.extend(shape.bytes());
            }
        }
        hashed.extend(xxh3_64(&card).to_le_bytes());
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

    let slots = state["fields"].list();
    hashed.extend((slots.len() as u32).to_le_bytes());
    for slot in slots {
        hashed.extend(slot["generation"].bytes());
        let field = slot["field"].option();
        hashed.push(u8::from(field.is_some()));
        hashed.extend(field.into_iter().flat_map(|field| xxh3_64(field.bytes()).to_le_bytes()));
    }
    hashed.extend(state["free_fields"].bytes());
    hashed.extend(state["laws"].bytes());
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

/// The shape of a body, wherever it stands.
fn shape_of<'a>(slots: &'a [Value], body: &'a Value) -> Option<&'a Value> {
    let source = &body["shape"];
    match source.case() {
        "None" => None,
        "New" => Some(&source["shape"]),
        "AsOf" => shape_of(slots, slots[source["slot"].natural() as usize]["present"].option()?),
        other => panic!("shape source {other}"),
    }
}

/// The state in a snapshot, and the hash it gives.
fn snapshot(layouts: &Layouts, file: &[u8]) -> (Value, u64) {
    assert_eq!(&file[..8], b"UMBRASNP");
    assert_eq!((word(file, 8), word(file, 12)), (layouts.number_of("Snapshots"), LAW));
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
    let found = WorldDef {
        time_step: time_step(&settings["time_step"]),
        gravity: vector(&settings["gravity"]),
        integrator: integrator(&settings["integrator"]),
        linear_damping: number(&settings["linear_damping"]),
        angular_damping: number(&settings["angular_damping"]),
        sleep_after: settings["sleep_after"].option().map(|ticks| ticks.natural() as u32),
    };
    assert_eq!(found, *def);
    assert_eq!(state["tick"].natural(), world.tick());
    assert_eq!(elapsed(state), (world.elapsed().num, world.elapsed().den));
    assert_eq!(random(&state["random"]), *world.random());
    assert_eq!(state["blob"].raw(), world.blob());
    let slots = state["bodies"].list();
    let found: Vec<(BodyId, &Value)> = (0u32..)
        .zip(slots)
        .filter_map(|(slot, entry)| {
            let id = BodyId::from_parts(slot, entry["generation"].natural() as u32);
            Some((id, entry["present"].option()?))
        })
        .collect();
    assert_eq!(found.len(), world.body_count());
    let bits = |v: &Value| (v["x"].integer(), v["y"].integer());
    for (id, found) in found {
        let own = world.body(id).expect("it is there");
        assert_eq!((kind(&found["kind"]), activity(&found["activity"])), (own.kind(), own.activity()), "{id}");
        let (position, velocity) = (own.position_exact(), own.velocity_exact());
        assert_eq!(bits(&found["position"]), (position.x.to_bits(), position.y.to_bits()), "{id}");
        assert_eq!(bits(&found["velocity"]), (velocity.x.to_bits(), velocity.y.to_bits()), "{id}");
        assert_eq!(found["angle"].natural(), own.angle_exact().to_bits(), "{id}");
        assert_eq!(found["angular_velocity"].integer(), own.angular_velocity_exact().to_bits(), "{id}");
        assert_eq!(number(&found["gravity_scale"]), own.gravity_scale(), "{id}");
        assert_eq!(found["linear_damping"].option().map(number), own.linear_damping(), "{id}");
        assert_eq!(found["angular_damping"].option().map(number), own.angular_damping(), "{id}");
        assert_eq!(found["groups"].natural(), u64::from(own.groups()), "{id}");
        assert_eq!(found["key"].natural(), own.key(), "{id}");
        assert_eq!(found["user_data"].natural(), own.user_data(), "{id}");
        assert_eq!(shape_of(slots, found).map(shape).as_ref(), own.shape(), "{id}");
        if let Mass::Of(mass) | Mass::WithInertia(mass, _) = mass(&found["mass"]) {
            assert!(own.mass().is_none_or(|own| own == mass), "{id}");
        }
        let (force, torque) = match found["applied"].option() {
            None => ((0, 0), 0),
            Some(applied) => (bits(&applied["force"]), applied["torque"].integer()),
        };
        let own_force = own.applied_force().expect("it fits").map(|wide| wide.to_bits());
        assert_eq!(force, (own_force.x, own_force.y), "{id}");
        assert_eq!(torque, own.applied_torque().expect("it fits").to_bits(), "{id}");
    }
    let found: Vec<(FieldId, Field)> = (0u32..)
        .zip(state["fields"].list())
        .filter_map(|(slot, entry)| {
            let id = FieldId::from_parts(slot, entry["generation"].natural() as u32);
            Some((id, field(entry["field"].option()?)))
        })
        .collect();
    let own: Vec<(FieldId, Field)> = world.fields().map(|(id, field)| (id, *field)).collect();
    assert_eq!(found, own);
    let given: Vec<(u64, u32)> = laws().iter().map(|law| (law.id(), law.version())).collect();
    let version = |law: &Value| (law["id"].natural(), law["version"].natural() as u32);
    assert_eq!(state["laws"].list().iter().map(version).collect::<Vec<_>>(), given);
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

/// The format and the law in the name of a file: `replay-format1-law3.umbrarep`.
fn numbers(stem: &str) -> (u32, u32) {
    let (_, numbers) = stem.split_once("-format").expect("a format");
    let (format, law) = numbers.split_once("-law").expect("a law");
    (format.parse().expect("a number"), law.parse().expect("a number"))
}

/// The files of a kind, by format and law.
fn committed(extension: &str) -> BTreeMap<(u32, u32), Vec<u8>> {
    static BLESSED: Once = Once::new();
    BLESSED.call_once(bless);
    let files = fs::read_dir(folder()).expect("the folder is there").map(|file| file.expect("it can be read").path());
    let files = files.filter(|path| path.extension().is_some_and(|e| e == extension));
    let stem = |path: &PathBuf| path.file_stem().expect("a name").to_string_lossy().into_owned();
    files.map(|path| (numbers(&stem(&path)), fs::read(&path).expect("it can be read"))).collect()
}

/// What is to be in the folder: the name, the extension, the bytes, and where in them the law is.
fn made_now() -> [(&'static str, &'static str, Vec<u8>, usize); 2] {
    let snapshot = world().snapshot().to_bytes();
    [("snapshot", "umbrasnp", snapshot, 12), ("replay", "umbrarep", recording(), 28)]
}

/// Adds the files of this format and law, if that is asked for and they are not there.
fn bless() {
    if env::var_os("UMBRA_BLESS").is_none_or(|value| value != "1") {
        return;
    }
    for (name, extension, bytes, law_at) in made_now() {
        let (format, law) = (word(&bytes, 8), word(&bytes, law_at));
        let path = folder().join(format!("{name}-format{format}-law{law}.{extension}"));
        if !path.exists() {
            fs::write(path, &bytes).expect("the file can be written");
        }
    }
}

fn word(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four"))
}

#[test]
fn files_of_this_format_and_law_are_there_and_made_the_same_now() {
    for (name, extension, bytes, law_at) in made_now() {
        let (format, law) = (word(&bytes, 8), word(&bytes, law_at));
        assert_eq!(law, LAW);
        let all = committed(extension);
        let old =
            all.get(&(format, law)).unwrap_or_else(|| panic!("no {name} of format {format} and law {law}: bless"));
        assert!(*old == bytes, "the bytes of a {name} changed: that needs another format or law");
    }
}

#[test]
fn files_of_other_formats_and_laws_are_refused_with_both_numbers() {
    let own_format = Layouts::documented().number_of("Replays");
    // As it will be once there is another law.
    let mut replays = committed("umbrarep");
    let mut snapshots = committed("umbrasnp");
    let newest = snapshots[&(own_format, LAW)].clone();
    snapshots.extend([(12, LAW + 1), (8, LAW)].map(|(at, law)| {
        let mut other = newest.clone();
        other[at] += 1;
        ((u32::from(at == 8) + own_format, law), other)
    }));
    let mut newest = replays[&(own_format, LAW)].clone();
    newest[8] += 1;
    replays.insert((own_format + 1, LAW), newest);
    assert!(snapshots.len() >= 3 && replays.len() >= 2);
    for ((format, law), file) in &snapshots {
        let read = Snapshot::from_bytes(file, &laws());
        match read {
            Ok(_) => assert_eq!((*format, *law), (own_format, LAW)),
            Err(SnapshotError::Format { found, known }) => assert_eq!((found, known), (*format, own_format)),
            Err(SnapshotError::Law { found, own }) => assert_eq!((found, own), (*law, LAW)),
            Err(error) => panic!("format {format}, law {law}: {error}"),
        }
    }
    for ((format, law), file) in &replays {
        match Replay::from_bytes(file, &laws()) {
            Ok(replay) => {
                assert_eq!((*format, *law), (own_format, LAW));
                assert_eq!(replay.verify(), Ok(()));
            }
            Err(ReplayError::Format { found, known }) => assert_eq!((found, known), (*format, own_format)),
            Err(error @ ReplayError::Law { found, own }) => {
                assert_eq!((found, own), (*law, LAW));
                let text = error.to_string();
                assert!(text.contains(&format!("law {law} ")) && text.contains(&format!("law {LAW}")), "{text}");
            }
            Err(error) => panic!("format {format}, law {law}: {error}"),
        }
    }
}

#[test]
fn the_tables_read_a_snapshot() {
    let layouts = Layouts::documented();
    let file = &committed("umbrasnp")[&(layouts.number_of("Snapshots"), LAW)];
    let (state, hash) = snapshot(&layouts, file);
    let world = Snapshot::from_bytes(file, &laws()).expect("it is whole").into_world();
    compare(&state, &world);
    assert_eq!(hash, world.state_hash());
    // It has what it is to have.
    let bodies: Vec<&Value> = state["bodies"].list().iter().filter_map(|slot| slot["present"].option()).collect();
    for activity in ["Awake", "Asleep", "Quarantined"] {
        assert!(bodies.iter().any(|body| body["activity"].case() == activity), "none is {activity}");
    }
    assert!(bodies.iter().any(|body| body["applied"].option().is_some()));
    assert!(bodies.iter().any(|body| body["shape"].case() == "AsOf"));
    assert!(!state["free_slots"].list().is_empty() && !state["free_fields"].list().is_empty());
}

#[test]
fn the_tables_read_a_replay() {
    let layouts = Layouts::documented();
    let file = &committed("umbrarep")[&(layouts.number_of("Replays"), LAW)];
    let replay = Replay::from_bytes(file, &laws()).expect("it is whole");
    assert_eq!(replay.verify(), Ok(()));
    let mut playback = replay.play();
    let chunks = chunks(&layouts, file);
    let (mut snapshots, mut accelerations, mut players, mut calls) = (0, 0, [0, 0], 0);
    for (i, (letters, contents)) in chunks.iter().enumerate() {
        match &letters[..] {
            "HEAD" => {
                let head = layouts.whole("head", contents);
                assert_eq!(i, 0);
                assert_eq!((head["law"].natural(), head["hash_every"].natural()), (u64::from(LAW), 1));
                assert_eq!(head["tick"].natural(), replay.start().tick());
                assert_eq!(head["snapshot_every"].natural(), 8);
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
                    assert_eq!(done, playback.commands().cloned().collect::<Vec<_>>());
                    playback.step().expect("it goes as recorded");
                    let places = playback.outcomes().iter().map(|outcome| (outcome.player, outcome.sequence));
                    let found = |input: &Value| (input["player"].natural() as u32, input["sequence"].natural() as u32);
                    assert_eq!(inputs.iter().map(found).collect::<Vec<_>>(), places.collect::<Vec<_>>());
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
            other => panic!("a chunk {other}"),
        }
    }
    assert_eq!(playback.world().tick(), replay.end());
    assert!(snapshots > 2 && accelerations > 0 && players.iter().all(|&some| some > 5) && calls > 5);
}

#[test]
fn the_tables_read_every_command_and_say_how_long_it_is() {
    let layouts = Layouts::documented();
    let mut lengths: BTreeMap<u8, Vec<usize>> = BTreeMap::new();
    for own in commands() {
        let bytes = own.to_bytes();
        let found = layouts.whole("command", &bytes);
        assert_eq!(command(&found), own);
        assert!(format!("{own:?}").starts_with(found.case()), "{own:?}");
        // Shapes and blobs come on top of what the table says.
        let more = match &own {
            Command::AddBody(_) => found["def"]["shape"].option().map_or(0, |shape| shape.bytes().len()),
            Command::SetShape { .. } => found["shape"].option().map_or(0, |shape| shape.bytes().len()),
            Command::SetBlob(blob) => blob.len(),
            _ => 0,
        };
        lengths.entry(bytes[0]).or_default().push(bytes.len() - more);
    }
    let Content::Choice(cases) = layouts.form("command") else { panic!("a command is a choice") };
    assert_eq!(lengths.len(), cases.len());
    for case in cases {
        let own = &lengths[&case.tag];
        let (least, most) = (own.iter().min().expect("one"), own.iter().max().expect("one"));
        let range = if least == most { format!("{least}") } else { format!("{least} to {most}") };
        let written = case.bytes.split(',').next().unwrap_or_default();
        assert_eq!(written, range, "{}", case.name);
    }
    let most = lengths.values().flatten().max().expect("one");
    assert_eq!(*most, Command::<Fx>::BYTES);
    let text = fs::read_to_string(formats::PATH).expect("the document");
    assert!(text.contains(&format!("none has more than {} bytes\n(`Command::BYTES`)", Command::<Fx>::BYTES)));
}
