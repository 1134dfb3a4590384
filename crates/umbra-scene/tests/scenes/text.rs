//! A scene that is written and read again is the same scene, and one that is made of commands does what they did.

#[path = "../../../../tests/support/commands.rs"]
mod commands;
#[path = "../../../../tests/support/everything.rs"]
#[allow(dead_code, reason = "commands alone are taken from there")]
mod everything;
#[path = "../../../../tests/support/random.rs"]
mod random;

use std::collections::BTreeSet;

use crate::scenes::{JOINTED, RICH, texts};
use commands::{Author, KINDS};
use random::SplitMix;
use umbra_physics::{
    Attachment, BodyDef, BodyId, ColliderDef, Command, End, Error, FieldId, FieldKind, ForceField, Fx, FxFactor,
    Integrator, JointDef, JointKind, Quantity, Shape, TimeStep, Vec2, World, WorldDef, fx, limits, vec2,
};
use umbra_scene::{ExportError, Place, Scene, SceneAction};

/// The scene without its places in a text.
fn placeless(mut scene: Scene) -> Scene {
    scene.place = Place::default();
    scene.bodies.iter_mut().for_each(|body| body.place = Place::default());
    scene.fields.iter_mut().for_each(|field| field.place = Place::default());
    scene.joints.iter_mut().for_each(|joint| joint.place = Place::default());
    scene.inputs.iter_mut().for_each(|input| input.place = Place::default());
    scene.material_pairs.iter_mut().for_each(|pair| pair.place = Place::default());
    let colliders = scene.bodies.iter_mut().flat_map(|body| &mut body.colliders);
    colliders.for_each(|collider| collider.place = Place::default());
    scene
}

#[track_caller]
fn read(text: &str) -> Scene {
    placeless(Scene::parse(text).unwrap_or_else(|error| panic!("{error}\n{text}")))
}

#[test]
fn every_scene_of_the_repository_is_the_same_once_written() {
    for (name, text) in texts()
        .into_iter()
        .chain([("rich", RICH), ("jointed", JOINTED)].map(|(name, text)| (name.to_owned(), text.to_owned())))
    {
        let scene = read(&text);
        let written = scene.to_json();
        assert!(read(&written) == scene, "{name}");
        assert_eq!(read(&written).to_json(), written, "{name}");
    }
}

/// The hash of the state at every tick.
fn hashes(scene: &Scene) -> Vec<u64> {
    let mut run = scene.start::<Fx>().unwrap_or_else(|error| panic!("{error}"));
    let mut hashes = Vec::new();
    for _ in 0..scene.ticks {
        run.advance().unwrap_or_else(|error| panic!("{error}"));
        hashes.push(run.world().state_hash());
    }
    hashes
}

/// Returns false for a command that a scene has no words for: of custom forces, which a world without laws refuses.
fn has_words(command: &Command) -> bool {
    match command {
        Command::AddField(field) | Command::SetField { field, .. } => !matches!(field.kind, FieldKind::Custom { .. }),
        _ => true,
    }
}

/// The number of [`Command::AddJoint`].
const ADD_JOINT: u8 = 43;

/// The states that commands lead to, tick by tick.
struct Played {
    def: WorldDef,
    commands: Vec<(u64, Command)>,
    hashes: Vec<u64>,
    carried_out: usize,
}

/// Commands of all kinds, some of them refused: those of the start, then a few in some of the ticks.
fn play(author: &mut Author, integrator: Integrator, kinds: &mut BTreeSet<String>) -> Played {
    let def = WorldDef { gravity: vec2(0, fx!(-1)), integrator, sleep_after: Some(3), ..WorldDef::default() };
    let mut world = World::new(def).expect("a fair definition");
    let mut played = Played { def, commands: Vec::new(), hashes: Vec::new(), carried_out: 0 };
    for tick in 0..40 {
        let mut due = Vec::new();
        let mut write = |world: &mut World, command: Command| {
            if !has_words(&command) {
                return;
            }
            if world.execute(&command).is_ok() {
                let name = format!("{command:?}");
                kinds.insert(name.split(|c: char| !c.is_alphanumeric()).next().unwrap_or_default().to_owned());
                played.carried_out += 1;
            }
            due.push((tick, command));
        };
        if tick == 0 {
            for _ in 0..6 {
                let body = author.body();
                write(&mut world, Command::AddBody(body));
                let field = author.field(&world);
                write(&mut world, Command::AddField(field));
                let joint = author.of_kind(ADD_JOINT, &world);
                write(&mut world, joint);
            }
        }
        for _ in 0..author.random.next() % 5 {
            let command = author.any(&world);
            write(&mut world, command);
        }
        if tick % 10 == 5 {
            // Out of the envelope with the next step, and back some ticks later.
            let body = author.some_body(&world);
            write(&mut world, Command::SetPosition { body, position: Vec2::new(limits::POSITION, Fx::ZERO) });
            write(&mut world, Command::SetVelocity { body, velocity: vec2(9, 0) });
        }
        if tick % 10 == 8 {
            for body in world.bodies().map(|body| body.id()).collect::<Vec<_>>() {
                write(&mut world, Command::Release(body));
            }
        }
        played.commands.extend(due);
        world.step();
        played.hashes.push(world.state_hash());
    }
    played
}

#[test]
fn a_scene_of_commands_has_their_bits_at_every_tick() {
    let mut author = Author { random: SplitMix::seeded(5), unfair: 25 };
    let (mut kinds, mut refused, mut starting) = (BTreeSet::new(), 0, [0; 3]);
    for run in 0..60 {
        let mut played = play(&mut author, Integrator::ALL[run % Integrator::ALL.len()], &mut kinds);
        refused += played.commands.len() - played.carried_out;
        let ticks = played.hashes.len() as u64;
        if run % 2 == 1 {
            // Those of a tick keep their order, and that is all the order there is.
            played.commands.sort_by_key(|(tick, _)| tick.wrapping_mul(27) % 64);
        }
        let scene = Scene::from_commands(played.def, &played.commands, ticks).unwrap_or_else(|why| panic!("{why}"));
        let count = scene.starting_bodies + scene.starting_fields + scene.starting_joints + scene.inputs.len();
        assert_eq!(count, played.carried_out, "what is refused is left out, and nothing else");
        starting[0] += scene.starting_bodies;
        starting[1] += scene.starting_fields;
        starting[2] += scene.starting_joints;
        assert_eq!(hashes(&scene), played.hashes);
        let written = read(&scene.to_json());
        assert!(written == scene, "{}", scene.to_json());
        assert_eq!(hashes(&written), played.hashes);
    }
    assert!(starting.iter().all(|&count| count > 60), "{starting:?}");
    assert_eq!(kinds.len() as u64, KINDS, "{kinds:?}");
    assert!(refused > 0);
}

/// Eight bodies, three of them with shapes and the last on its way out of the envelope, a force field, and two joints.
fn stage() -> Vec<(u64, Command)> {
    let body = |slot| BodyId::from_parts(slot, 0);
    let disc = Shape::circle(fx!(1)).expect("a shape");
    let drag = FieldKind::Drag { linear: fx!(1), quadratic: fx!(0), wind: Vec2::ZERO };
    let mut commands = vec![Command::AddBody(BodyDef::dynamic()); 8];
    // And two more: slot 9 has a kinematic one.
    commands.extend([BodyDef::dynamic(), BodyDef::kinematic()].map(Command::AddBody));
    commands.push(Command::AddField(drag.into()));
    let ghost = ColliderDef::ghost(disc.clone());
    commands.extend((0..7).map(|slot| Command::AddCollider { body: body(slot), def: ghost.clone() }));
    commands.push(Command::AddCollider { body: body(0), def: disc.into() });
    commands.push(Command::SetPosition { body: body(7), position: Vec2::new(limits::POSITION, Fx::ZERO) });
    commands.push(Command::SetVelocity { body: body(7), velocity: vec2(9, 0) });
    let [hinge, axle] = [4, 5].map(|slot| [End::World(Vec2::ZERO), End::Body(Attachment::centre(body(slot)))]);
    commands.extend([hinge, axle].map(|ends| Command::AddJoint(JointDef::new(ends, JointKind::default()))));
    commands.into_iter().map(|command| (0, command)).collect()
}

#[test]
fn a_slot_that_is_freed_before_the_first_tick_is_taken_again() {
    let first = BodyId::from_parts(0, 0);
    let still = Command::AddBody(BodyDef::dynamic());
    let moving = Command::AddBody(BodyDef { velocity: vec2(1, 0), ..BodyDef::dynamic() });
    let commands = [still.clone(), Command::RemoveBody(first), moving, still].map(|command| (0, command));
    let scene = Scene::from_commands(WorldDef::default(), &commands, 1).expect("a scene");
    assert_eq!((scene.starting_bodies, scene.inputs.len()), (1, 3));
    let mut world = World::new(WorldDef::default()).expect("the standard world");
    commands.iter().for_each(|(_, command)| _ = world.execute(command));
    world.step();
    assert_eq!(hashes(&read(&scene.to_json())), [world.state_hash()]);
}

#[test]
fn each_command_on_its_own_is_the_same_once_written() {
    let mut own_forces = 0;
    for command in everything::commands() {
        let mut commands = stage();
        if let Command::Enable(body) = command {
            commands.push((1, Command::Disable(body)));
        }
        commands.push((2, command.clone()));
        match Scene::from_commands(WorldDef::default(), &commands, 4) {
            Ok(scene) => {
                let last = scene.inputs.last().expect("the command");
                assert_eq!((last.from, last.to), (2, 2), "{command:?} was refused");
                assert!(read(&scene.to_json()) == scene, "{}", scene.to_json());
            }
            Err(why) => {
                assert_eq!(why, ExportError::CustomForce { command: commands.len() - 1, id: 9 });
                own_forces += 1;
            }
        }
    }
    assert_eq!(own_forces, 2, "one that is added, one in the place of another");
}

fn attractor(mu: &str) -> Command {
    let mu: FxFactor = mu.parse().expect("a factor");
    Command::AddField(FieldKind::Attractor { centre: End::World(Vec2::ZERO), mu, softening: fx!(0) }.into())
}

#[test]
fn commands_that_scenes_cannot_express_are_refused_by_name() {
    let export = |commands: &[(u64, Command)]| Scene::from_commands(WorldDef::default(), commands, 9).map(drop);
    let custom = |id| Command::AddField(FieldKind::Custom { id }.into());
    assert_eq!(export(&[(0, attractor("1")), (3, custom(5))]), Err(ExportError::CustomForce { command: 1, id: 5 }));
    assert_eq!(export(&[(9, custom(5))]), Ok(()), "it is not done any more");
    let set = Command::SetField { id: FieldId::from_parts(0, 0), field: FieldKind::Custom { id: 6 }.into() };
    assert_eq!(
        export(&[(1, set)]),
        Err(ExportError::CustomForce { command: 0, id: 6 }),
        "whether there is such a field or not"
    );
    // The least there is to read, and less.
    assert_eq!(export(&[(0, attractor("1e-60"))]), Ok(()));
    let least = Scene::from_commands(WorldDef::default(), &[(0, attractor("1e-60"))], 9).expect("a scene");
    assert!(read(&least.to_json()) == least, "its factor is below 10^-60 by a rounding");
    let Command::AddField(ForceField { kind: FieldKind::Attractor { mu, .. }, .. }) = attractor("1e-60") else {
        unreachable!()
    };
    let less = FieldKind::Attractor {
        centre: End::World(Vec2::ZERO),
        mu: mu.times("0.5".parse().expect("a factor")),
        softening: fx!(0),
    };
    assert_eq!(export(&[(0, Command::AddField(less.into()))]), Err(ExportError::Mu { command: 0 }));
    let def = WorldDef { time_step: TimeStep::hz(0), ..WorldDef::default() };
    assert_eq!(Scene::from_commands(def, &[], 1).map(drop), Err(ExportError::World(Error::TimeStep)));
    let error = ExportError::World(Error::OutOfRange { quantity: Quantity::Gravity });
    let source = std::error::Error::source(&error).map(ToString::to_string);
    assert_eq!(error.to_string(), format!("the world: {}", source.expect("the engine's own error")));
}

#[test]
fn a_scene_holds_as_many_inputs_as_can_be_read_and_no_more() {
    const MOST: usize = Scene::MOST as usize;
    let clear = |count| vec![(0, Command::ClearForces); count];
    assert!(Scene::from_commands(WorldDef::default(), &clear(MOST), 1).is_ok());
    let error = Scene::from_commands(WorldDef::default(), &clear(MOST + 1), 1).map(drop);
    assert_eq!(error, Err(ExportError::Many { command: MOST }));
}

#[test]
fn a_scene_changed_by_hand_is_refused_where_it_says_what_the_format_lacks() {
    let scene = read(
        r#"{"bodies": [{"name": "a"}], "fields": [{"name": "f", "drag": {}}], "inputs": [{"at": 0, "body": "a", "do": "wake"}]}"#,
    );
    let refused = |change: &dyn Fn(&mut Scene), field: &str, message: &str| {
        let mut changed = scene.clone();
        change(&mut changed);
        let error = Scene::parse(&changed.to_json()).expect_err("it is no scene");
        let error = error.first();
        assert!(error.place.field == field && error.message.contains(message), "{error}");
    };
    let nobody = BodyId::from_parts(1, 0);
    refused(
        &|s| s.inputs[0].action = SceneAction::Command(Command::Wake(nobody)),
        "inputs[0].body",
        "expected a text, found null",
    );
    let remove = Command::RemoveField(FieldId::from_parts(3, 0));
    refused(
        &|s| s.inputs[0].action = SceneAction::Command(remove.clone()),
        "inputs[0].field",
        "expected a text, found null",
    );
    refused(&|s| s.fields[0].field.kind = FieldKind::Custom { id: 3 }, "fields[0].custom", "unknown field");
    refused(&|s| s.bodies[0].name.push('\n'), "bodies[0].name", "no control characters");
    refused(&|s| s.inputs[0].every = 0, "inputs[0].every", "out of range");
}

#[test]
fn bytes_and_generators_are_refused_with_their_place() {
    let refused = |set: &str, field: &str, message: &str| {
        let error = Scene::parse(&format!("{{\"inputs\": [\n{{\"at\": 1, {set}}}]}}")).expect_err("it is no scene");
        let error = error.first();
        assert_eq!((error.place.line, &*error.place.field), (2, field), "{error}");
        assert!(error.message.contains(message), "{error}");
    };
    refused(r#""set": {"blob": "0"}"#, "inputs[0].set.blob", "two hexadecimal digits");
    refused(r#""set": {"blob": "0g"}"#, "inputs[0].set.blob", "two hexadecimal digits");
    refused(r#""set": {"blob": "é"}"#, "inputs[0].set.blob", "two hexadecimal digits");
    refused(r#""set": {"blob": 1}"#, "inputs[0].set.blob", "expected a text");
    refused(r#""set": {"random": [0, 0, 0, 0]}"#, "inputs[0].set.random", "four zeros");
    refused(r#""set": {"random": [1, 2, 3]}"#, "inputs[0].set.random", "a list of 4");
    refused(r#""set": {"random": -1}"#, "inputs[0].set.random", "64 bits");
    refused(r#""set": {"random": [1, 2, 3, 18446744073709551616]}"#, "inputs[0].set.random[3]", "64 bits");
    refused(r#""do": "remove""#, "inputs[0].do", "clear_forces");
    let blob = "00".repeat(limits::BLOB + 1);
    refused(&format!(r#""set": {{"blob": "{blob}"}}"#), "inputs[0].set.blob", "blob");
}
