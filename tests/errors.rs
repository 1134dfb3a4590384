//! Errors have numbers that no other error has and that stay: in the code, in `docs/errors.md`, and here.

use std::collections::BTreeMap;
use std::error::Error as _;
use std::fs;
use std::path::{Path, PathBuf};

use umbra_physics::{
    BodyDef, BodyId, Cause, Command, Error, Fault, Inputs, Irreversible, Quantity, RecordOptions, Recorder, Replay,
    ReplayError, ReplayLimits, Snapshot, SnapshotError, World, WorldDef, fx,
};

/// Numbers that were given, and are no more.
const RETIRED: [(u16, &str); 3] = [(106, "Error::NoShape"), (149, "Error::FloatJoint"), (180, "Quantity::Filter")];

/// Every number that is given, and to what. Lines are added, none is changed; one that is taken out goes to [`RETIRED`].
const GIVEN: [(u16, &str); 178] = [
    (101, "Error::OutOfRange"),
    (102, "Error::NoSuchBody"),
    (103, "Error::NoSuchField"),
    (104, "Error::TimeStep"),
    (105, "Error::NotConvex"),
    (107, "Error::NotDynamic"),
    (108, "Error::NotMovable"),
    (109, "Error::Quarantined"),
    (110, "Error::NotQuarantined"),
    (111, "Error::DampingHasNoInverse"),
    (112, "Error::SameBody"),
    (113, "Error::CustomForce"),
    (114, "Error::Full"),
    (115, "Error::ElapsedTime"),
    (116, "Error::Inconsistent"),
    (117, "Error::DuplicateInput"),
    (118, "Error::TickForgotten"),
    (119, "Error::TickToCome"),
    (120, "Error::NotReversible"),
    (121, "Error::Locked"),
    (122, "Error::Disabled"),
    (123, "Error::NotDisabled"),
    (124, "Error::NotKinematic"),
    (125, "Error::NoSuchPlayer"),
    (126, "Error::ChangedBetweenTicks"),
    (127, "Error::SteppedInTick"),
    (128, "Error::NoSuchCollider"),
    (129, "Error::DynamicChain"),
    (130, "Error::ChainCrosses"),
    (131, "Irreversible::Scalar"),
    (132, "Irreversible::Integrator"),
    (133, "Irreversible::Start"),
    (134, "Irreversible::TimeStep"),
    (135, "Irreversible::Sleep"),
    (136, "Irreversible::Damping"),
    (137, "Irreversible::Velocity"),
    (138, "Irreversible::Quarantined"),
    (139, "Irreversible::Pending"),
    (140, "Irreversible::Twice"),
    (141, "Irreversible::Fault"),
    (142, "Irreversible::Capped"),
    (143, "Irreversible::Moved"),
    (144, "Irreversible::End"),
    (145, "Irreversible::Contact"),
    (146, "Irreversible::Joint"),
    (147, "Error::NoSuchJoint"),
    (148, "Error::NothingToMove"),
    (151, "Quantity::Position"),
    (152, "Quantity::Angle"),
    (153, "Quantity::Velocity"),
    (154, "Quantity::AngularVelocity"),
    (155, "Quantity::Mass"),
    (156, "Quantity::Inertia"),
    (157, "Quantity::Density"),
    (158, "Quantity::Size"),
    (159, "Quantity::Count"),
    (160, "Quantity::Force"),
    (161, "Quantity::Torque"),
    (162, "Quantity::Impulse"),
    (163, "Quantity::Gravity"),
    (164, "Quantity::GravityScale"),
    (165, "Quantity::Damping"),
    (166, "Quantity::Mu"),
    (167, "Quantity::Softening"),
    (168, "Quantity::Stiffness"),
    (169, "Quantity::Drag"),
    (170, "Quantity::RestLength"),
    (171, "Quantity::SleepAfter"),
    (172, "Quantity::Total"),
    (173, "Quantity::Blob"),
    (174, "Quantity::MaxSpeed"),
    (175, "Quantity::MaxAngularSpeed"),
    (176, "Quantity::ColliderPosition"),
    (177, "Quantity::ColliderDensity"),
    (178, "Quantity::Friction"),
    (179, "Quantity::Restitution"),
    (181, "Quantity::Substeps"),
    (182, "Quantity::ContactSpeed"),
    (183, "Quantity::Pairs"),
    (184, "Quantity::SurfaceSpeed"),
    (185, "Quantity::OneWayDirection"),
    (186, "Quantity::OneWayTolerance"),
    (187, "Quantity::RollingResistance"),
    (188, "Quantity::MaterialId"),
    (189, "Quantity::Query"),
    (190, "Quantity::CharacterSkin"),
    (191, "Quantity::CharacterUp"),
    (192, "Quantity::CharacterSlope"),
    (193, "Quantity::CharacterStep"),
    (194, "Quantity::CharacterTranslation"),
    (195, "Quantity::ExplosionRadius"),
    (196, "Quantity::ExplosionImpulse"),
    (197, "Quantity::FluidBox"),
    (198, "Quantity::JointPoint"),
    (199, "Quantity::JointLength"),
    (200, "Quantity::BreakForce"),
    (201, "Cause::Position"),
    (202, "Cause::Velocity"),
    (203, "Cause::AngularVelocity"),
    (204, "Cause::Force"),
    (205, "Cause::Field"),
    (206, "Cause::CustomForce"),
    (207, "Cause::Pairs"),
    (208, "Quantity::JointAngle"),
    (209, "Quantity::JointLimits"),
    (210, "Quantity::JointForce"),
    (211, "Quantity::MotorSpeed"),
    (212, "Quantity::SpringFrequency"),
    (213, "Quantity::DampingRatio"),
    (214, "Error::NoMotor"),
    (215, "Quantity::Teeth"),
    (216, "Quantity::Strands"),
    (217, "Quantity::Deceleration"),
    (218, "Error::SleepIsOff"),
    (219, "Error::KeptAwake"),
    (301, "SnapshotError::Foreign"),
    (302, "SnapshotError::Format"),
    (303, "SnapshotError::PhysicsVersion"),
    (304, "SnapshotError::Malformed"),
    (305, "SnapshotError::Invalid"),
    (306, "SnapshotError::CustomForce"),
    (307, "SnapshotError::Changed"),
    (320, "Malformed"),
    (401, "ReplayError::Foreign"),
    (402, "ReplayError::Format"),
    (403, "ReplayError::PhysicsVersion"),
    (404, "ReplayError::CutOff"),
    (405, "ReplayError::Tampered"),
    (406, "ReplayError::Malformed"),
    (407, "ReplayError::Snapshot"),
    (420, "Divergence"),
    (421, "VerifyError::Divergence"),
    (422, "VerifyError::Ticks"),
    (423, "VerifyError::Bodies"),
    (424, "VerifyError::Fields"),
    (425, "VerifyError::Commands"),
    (426, "VerifyError::Colliders"),
    (427, "VerifyError::Pairs"),
    (428, "VerifyError::Stopped"),
    (500, "SceneError"),
    (501, "Flaw::NotJson"),
    (502, "Flaw::WrongKind"),
    (503, "Flaw::Unknown"),
    (504, "Flaw::Doubled"),
    (505, "Flaw::Missing"),
    (506, "Flaw::Taken"),
    (507, "Flaw::NoSuchName"),
    (508, "Flaw::OutOfRange"),
    (509, "Flaw::Text"),
    (510, "Flaw::TooMany"),
    (521, "ExportError::World"),
    (522, "ExportError::CustomForce"),
    (523, "ExportError::Mu"),
    (524, "ExportError::Many"),
    (601, "Problem::Refused"),
    (602, "Problem::DidNotHappen"),
    (603, "Problem::Differs"),
    (604, "Problem::Wrong"),
    (620, "Violation"),
    (701, "MathError::NotPositive"),
    (702, "MathError::Overflow"),
    (711, "ParseFxError::Empty"),
    (712, "ParseFxError::InvalidDigit"),
    (713, "ParseFxError::OutOfRange"),
    (801, "file"),
    (802, "option"),
    (804, "kind"),
    (805, "output"),
    (806, "size"),
    (807, "start"),
    (808, "job"),
    (809, "name"),
    (901, "UMBRA_ERROR_NULL_POINTER"),
    (902, "UMBRA_ERROR_BAD_ARGUMENT"),
    (903, "UMBRA_ERROR_BUFFER_TOO_SMALL"),
    (904, "UMBRA_ERROR_PANIC"),
    (905, "UMBRA_ERROR_BUSY"),
    (906, "UMBRA_ERROR_END"),
];

fn read(path: &str) -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).expect("a text")
}

fn sources(folder: PathBuf, texts: &mut Vec<String>) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            sources(path, texts);
        } else if path.extension().is_some_and(|kind| kind == "rs") {
            texts.push(fs::read_to_string(path).expect("a text"));
        }
    }
}

/// The sources of the library, and of the packages beside it.
fn all_sources() -> Vec<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut texts = Vec::new();
    sources(root.join("src"), &mut texts);
    for package in ["umbra-cli", "umbra-lab", "umbra-oracles", "umbra-scene", "umbra-selftest"] {
        sources(root.join("crates").join(package).join("src"), &mut texts);
    }
    texts
}

/// The numbers that a source gives in functions `code` that are written out: a number for each variant, or one for all.
fn written_out(text: &str) -> Vec<(u16, String)> {
    let mut numbers = Vec::new();
    for part in text.split("\nimpl ").skip(1) {
        let name = part.split([' ', '<']).next().expect("a name");
        let Some((_, body)) = part.split_once("pub const fn code(&self) -> u16 {\n") else { continue };
        for line in body.split("\n    }").next().expect("an end").lines().map(str::trim) {
            if let Ok(number) = line.parse() {
                numbers.push((number, name.to_owned()));
            } else if let Some((variant, number)) = line.split_once(" => ") {
                let variant = variant.trim_start_matches("Self::").split([' ', '(']).next().expect("a variant");
                let number = number.trim_end_matches(',').parse().expect("a number");
                numbers.push((number, format!("{name}::{variant}")));
            }
        }
    }
    numbers
}

/// The numbers in the code: those of `codes!`, of `enum Flaw`, of functions that are written out, and what the program has of its
/// own.
fn in_the_code() -> Vec<(u16, String)> {
    let mut numbers = Vec::new();
    for text in &all_sources() {
        numbers.extend(written_out(text));
        // Calls begin a line; the definition and the text of this sentence do not.
        for part in text.split("\ncodes!(").skip(1).chain(text.split("\npub(super) enum Flaw {").skip(1)) {
            let is_flaw = part.starts_with('\n');
            let body = part.split(if is_flaw { "}" } else { ");" }).next().expect("an end");
            if let Some((name, number)) = body.split_once(" = ").filter(|_| !body.contains(['{', ','])) {
                numbers.push((number.parse().expect("a number"), name.to_owned()));
                continue;
            }
            let (name, variants) = if is_flaw { ("Flaw", body) } else { body.split_once('{').expect("a list") };
            for line in variants.split([',', '}']).filter(|line| line.contains('=')) {
                let (variant, number) = line.split_once('=').expect("a number");
                numbers
                    .push((number.trim().parse().expect("a number"), format!("{}::{}", name.trim(), variant.trim())));
            }
        }
    }
    numbers
}

#[test]
fn every_number_is_given_once_and_stays() {
    let mut names = BTreeMap::new();
    for (code, name) in GIVEN.into_iter().chain(RETIRED) {
        assert_eq!(names.insert(code, name), None, "{code}");
    }
    let mut code = in_the_code();
    code.sort();
    // Some are given by hand: that of scenes in general, the four of the program, which the tests of the program see, and those of
    // the C interface, which has its own.
    let by_hand = |(code, _): &&(u16, &str)| *code == 500 || *code > 800;
    let expected: Vec<(u16, String)> =
        GIVEN.iter().filter(|row| !by_hand(row)).map(|(code, name)| (*code, (*name).to_owned())).collect();
    assert_eq!(code, expected);
    assert!(read("crates/umbra-scene/src/error.rs").contains("const UNFIT: u16 = 500;"));
}

#[test]
fn every_error_has_numbers() {
    let texts = all_sources();
    let errors = texts.iter().flat_map(|text| text.split("::error::Error for ").skip(1));
    let names: Vec<&str> = errors.map(|rest| rest.split([' ', '{']).next().unwrap_or_default()).collect();
    assert!(names.len() > 15, "{names:?}");
    // Those of `Fault` and `Failure` are their causes'; that of `SceneError` is a `Flaw`'s or the engine's, and `SceneErrors` lists
    // several; `CustomForceError` is a user's own word, which the engine hands on as a `Cause`.
    let others = ["Fault", "Failure", "SceneError", "SceneErrors", "CustomForceError"];
    for name in names.iter().filter(|name| !others.contains(name)) {
        let has = |name_in_use: &str| name_in_use.split("::").next() == Some(*name);
        assert!(GIVEN.iter().any(|(_, name_in_use)| has(name_in_use)), "{name}");
    }
}

#[test]
fn the_document_has_each() {
    let document = read("docs/errors.md");
    let rows: Vec<(u16, &str)> = document
        .lines()
        .filter_map(|line| {
            let mut cells = line.strip_prefix("| E")?.split(" | ");
            Some((cells.next()?.parse().ok()?, cells.next()?.trim_matches('`')))
        })
        .collect();
    let shown = |name: &'static str| if name.starts_with("Flaw::") { "SceneError" } else { name };
    let (retired, mut rows): (Vec<_>, Vec<_>) =
        rows.into_iter().partition(|(code, _)| RETIRED.iter().any(|(old, _)| old == code));
    // Each section has later numbers at its end.
    rows.sort_unstable_by_key(|(code, _)| *code);
    assert_eq!(rows, GIVEN.map(|(code, name)| (code, shown(name))));
    assert_eq!(retired, RETIRED);
    let said = |line: &str| line.rsplit(" | ").next().is_some_and(|said| said.trim_end_matches(" |").len() > 3);
    assert!(document.lines().filter(|line| line.starts_with("| E")).all(said));
}

#[test]
fn an_error_that_wraps_another_has_it_as_its_source() {
    let sourced = |error: &dyn std::error::Error| error.source().map(ToString::to_string);
    let mass = Error::OutOfRange { quantity: Quantity::Mass { value: fx!(-1) } };
    assert_eq!((mass.code(), sourced(&mass)), (101, Some("a mass from 2^-16 to 2^24 kg, not -1".to_owned())));
    assert_eq!(Quantity::Mass { value: fx!(-1) }.code(), 155);
    let locked = Error::Locked { quantity: Quantity::Velocity };
    assert_eq!((locked.code(), sourced(&locked)), (121, None));
    let body = BodyId::from_parts(3, 0);
    let fault = Fault { body, cause: Cause::Force };
    let why = Irreversible::Fault(fault);
    let undone = Error::NotReversible { why };
    assert_eq!((undone.code(), why.code(), fault.code()), (120, 141, 204));
    assert_eq!((sourced(&undone), sourced(&why)), (Some(why.to_string()), Some(Cause::Force.to_string())));
    assert_eq!(fault.to_string(), "body 3 was quarantined: sum of forces too large");
    assert_eq!((Error::Full.code(), sourced(&Error::Full)), (114, None));

    let malformed = Command::from_bytes(&[99]).expect_err("no command");
    assert_eq!((malformed.code(), malformed.at), (320, 0));
    let error = SnapshotError::from(malformed);
    assert_eq!((error.code(), error.source().map(ToString::to_string)), (304, Some(malformed.to_string())));
    assert_eq!(Snapshot::from_bytes(b"{}", &[]).expect_err("no snapshot").code(), 301);
    assert_eq!(Replay::from_bytes(b"{}", &[]).expect_err("no replay").code(), 401);
    let error = ReplayError::Snapshot { chunk: 1, error };
    let inner = error.source().and_then(|inner| inner.source());
    assert_eq!((error.code(), inner.map(ToString::to_string)), (407, Some(malformed.to_string())));

    let mut world = World::new(WorldDef::default()).expect("a world");
    let mut recorder = Recorder::new(&world, RecordOptions::default());
    // Past the recorder.
    world.add_body(BodyDef::dynamic()).expect("a body");
    recorder.step(&mut world, &Inputs::new());
    let replay = Replay::from_bytes(&recorder.finish(&world), &[]).expect("a replay");
    let divergence = replay.verify().expect_err("it parts");
    let limits = ReplayLimits { ticks: 1, bodies: 1, fields: 0, colliders: u32::MAX, pairs: u32::MAX, commands: 1 };
    let error = replay.verify_within(limits).expect_err("it parts");
    assert_eq!((divergence.code(), error.code()), (420, 421));
    assert_eq!((error.to_string(), sourced(&error)), (divergence.to_string(), Some(divergence.to_string())));
    let error = replay.verify_within(ReplayLimits { ticks: 0, ..limits }).expect_err("it is too long");
    assert_eq!((error.code(), sourced(&error)), (422, None));
}
