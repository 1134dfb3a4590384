//! The messages of the compiler to a wrong number: one error, which says what to write instead. And the size of what it compiles
//! for a game: not the engine, which the library holds.
//!
//! Each case is a program that rustc refuses against the library that this test was built with. The texts of the library are
//! compared, not those of the compiler, which differ from version to version.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::SystemTime;

/// A program with a mistake: the statement, what its error says, and the statement without the mistake.
struct Case {
    wrong: &'static str,
    says: &'static [&'static str],
    right: &'static str,
}

const INTO_FX: &[&str] =
    &["`{float}` does not convert to `Fx` exactly", "`fx!(0.5)`", "`fx!(1/60)`", "`Fx::parse(text)`"];
const MACRO: &[&str] = &["fx! takes a literal, as in fx!(0.5), fx!(-9.81) or fx!(1/60)", "Fx::from_ratio(a, b)"];
const RATIO: &[&str] = &["fx! takes ratios of two integers, as in fx!(1/60)"];

const CASES: [Case; 20] = [
    Case { wrong: "vec2(0, -0.5);", says: INTO_FX, right: "vec2(0, fx!(-0.5));" },
    Case { wrong: "vec2(1u64, 0);", says: &["`u64` does not convert to `Fx` exactly"], right: "vec2(1u16, 0);" },
    Case { wrong: "Shape::circle(0.5)?;", says: INTO_FX, right: "Shape::circle(fx!(0.5))?;" },
    Case { wrong: "Shape::rectangle(50, 0.5)?;", says: INTO_FX, right: "Shape::rectangle(50, 1)?;" },
    Case { wrong: "Shape::capsule(0.5, 1)?;", says: INTO_FX, right: "Shape::capsule(1, 1)?;" },
    Case {
        wrong: "world.add_body(BodyDef { position: vec2(0, 0.5), ..BodyDef::dynamic().with_collider(Shape::circle(1)?) })?;",
        says: INTO_FX,
        right: "world.add_body(BodyDef { position: vec2(0, fx!(0.5)), ..BodyDef::dynamic().with_collider(Shape::circle(1)?) })?;",
    },
    // A field of a number takes an `Fx`: the words are the compiler's.
    Case {
        wrong: "world.add_body(BodyDef { angle: 0, ..BodyDef::dynamic() })?;",
        says: &["expected `Fx`"],
        right: "world.add_body(BodyDef { angle: fx!(0), ..BodyDef::dynamic() })?;",
    },
    Case {
        wrong: "world.add_body(BodyDef { mass: Mass::Kilograms(1), ..BodyDef::dynamic() })?;",
        says: &["expected `Fx`"],
        right: "world.add_body(BodyDef { mass: Mass::Kilograms(fx!(1)), ..BodyDef::dynamic() })?;",
    },
    Case {
        wrong: "world.apply_torque(body, 5)?;",
        says: &["expected `Fx`"],
        right: "world.apply_torque(body, fx!(5))?;",
    },
    Case {
        wrong: "world.add_field(FieldKind::Attractor { centre: End::World(vec2(0, 0)), mu: fx!(60), softening: fx!(0) })?;",
        says: &["expected `FxFactor`, found `Fx`", ".into()"],
        right: "world.add_field(FieldKind::Attractor { centre: End::World(vec2(0, 0)), mu: fx!(60).into(), softening: fx!(0) })?;",
    },
    Case {
        wrong: "world.add_field(FieldKind::Attractor { centre: End::Body(Attachment::centre(body)), mu: 60, softening: fx!(0) })?;",
        says: &["expected `FxFactor`, found integer", ".into()"],
        right: "world.add_field(FieldKind::Attractor { centre: End::Body(Attachment::centre(body)), mu: 60.into(), softening: fx!(0) })?;",
    },
    Case { wrong: "fx!(number);", says: MACRO, right: "Fx::from(number);" },
    Case { wrong: "fx!(-number);", says: MACRO, right: "fx!(-1.5);" },
    Case { wrong: "fx!(number / 60);", says: MACRO, right: "Fx::from_ratio(number.into(), 60);" },
    Case { wrong: "fx!(1 + 2);", says: MACRO, right: "fx!(3);" },
    Case {
        wrong: "fx!(1.5f64);",
        says: &["fx! takes a decimal number without a suffix, as in fx!(0.5)"],
        right: "fx!(1.5);",
    },
    Case { wrong: "fx!(-2147483649);", says: &["the number does not fit in I32F32"], right: "fx!(-2147483648);" },
    Case { wrong: "fx!(0.5/60);", says: RATIO, right: "fx!(1/120);" },
    Case { wrong: "fx!(-1/6e1);", says: RATIO, right: "fx!(-1/6_0);" },
    Case { wrong: "fx!(1/0);", says: &["fx!: the denominator is zero"], right: "fx!(0/1);" },
];

/// Programs that a newcomer writes, without a type named anywhere.
const INFERRED: &str = "
    let _ = World::new(WorldDef::default())?;
    let _ = Inputs::new();
    let _ = vec2(1, 2);
    let _ = Attachment::centre(body);
    let v = vec2(3, 4) * 2 - 2 * vec2(1, 0) / 2;
    let _ = v.normalize().map(|unit| unit * fx!(0.5) + -unit);
    for event in world.step() {
        if let Event::FellAsleep(body) = event {
            world.remove_body(body)?;
        }
    }
    for body in &*world {
        println!(\"{body:?} {}\", body.activity());
    }
    let _ = BodyDef { position: v, ..Default::default() };
";

/// A program of these statements.
fn program(statements: &str) -> String {
    format!(
        "#![allow(unused)]
        use umbra_physics::*;
        pub fn program(world: &mut World, body: BodyId, number: i32) -> Result<(), Error> {{
            {statements}
            Ok(())
        }}"
    )
}

/// The compiler, and the library that this test was built with.
struct Compiler {
    rustc: PathBuf,
    libraries: PathBuf,
    library: PathBuf,
    folder: PathBuf,
}

impl Compiler {
    /// The folder of its files has this name.
    fn new(name: &str) -> Self {
        let beside = Path::new(env!("CARGO")).with_file_name(format!("rustc{}", env::consts::EXE_SUFFIX));
        let rustc = env::var_os("RUSTC").map_or(beside, PathBuf::from);
        let test = env::current_exe().expect("a test has a file");
        let libraries = test.parent().expect("it is in a folder").to_owned();
        let folder = env::temp_dir().join(format!("umbra-{name}-{}", std::process::id()));
        fs::create_dir_all(&folder).expect("a temporary folder");
        let mut compiler = Self { rustc, libraries, library: PathBuf::new(), folder };
        // Those of other features and of earlier sources may lie beside it: it is the last one that was made.
        let is_library = |path: &PathBuf| {
            let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
            name.starts_with("libumbra_physics-") && name.ends_with(".rlib")
        };
        let modified =
            |path: &PathBuf| fs::metadata(path).and_then(|file| file.modified()).unwrap_or(SystemTime::UNIX_EPOCH);
        let files = fs::read_dir(&compiler.libraries).expect("the folder of the test");
        let mut libraries: Vec<PathBuf> =
            files.filter_map(|entry| Some(entry.ok()?.path())).filter(is_library).collect();
        libraries.sort_by_key(modified);
        compiler.library = libraries.pop().expect("a test is built with the library");
        compiler
    }

    /// Compiles a program, optimised. Returns the object file, or the messages of the compiler.
    fn compile(&self, source: &str) -> Result<PathBuf, String> {
        let file = self.folder.join("program.rs");
        fs::write(&file, source).expect("room for a file");
        let output = Command::new(&self.rustc)
            // Constants are computed when code is made.
            .args(["--edition=2024", "--crate-type=lib", "--emit=obj", "-O", "--out-dir"])
            .arg(&self.folder)
            .arg("--extern")
            .arg(format!("umbra_physics={}", self.library.display()))
            .arg("-L")
            .arg(format!("dependency={}", self.libraries.display()))
            .arg(&file)
            .output()
            .expect("the compiler that made this test");
        if output.status.success() {
            Ok(file.with_extension("o"))
        } else {
            Err(String::from_utf8_lossy(&output.stderr).into_owned())
        }
    }
}

impl Drop for Compiler {
    fn drop(&mut self) {
        _ = fs::remove_dir_all(&self.folder);
    }
}

#[test]
fn a_wrong_number_is_one_error_that_says_what_to_write() {
    let compiler = Compiler::new("diagnostics");
    let right: String = CASES.iter().map(|case| format!("let _ = {}\n", case.right)).collect();
    if let Err(said) = compiler.compile(&program(&(right + INFERRED))) {
        panic!("what the errors say to write compiles:\n{said}");
    }
    for Case { wrong, says, .. } in CASES {
        let said = compiler.compile(&program(&format!("let _ = {wrong}"))).expect_err(wrong);
        let is_error = |line: &&str| line.starts_with("error") && !line.starts_with("error: aborting");
        assert_eq!(said.lines().filter(is_error).count(), 1, "{wrong}\n{said}");
        for words in says {
            assert!(said.contains(words), "{wrong} is not answered by {words}:\n{said}");
        }
    }
}

/// A program that uses much of the engine.
const GAME: &str = "
    let copy = world.clone();
    world.clone_from(&copy);
    world.restore(&Snapshot::from_bytes(&world.snapshot().to_bytes(), &[]).map_err(|_| Error::Inconsistent)?);
    world.execute(&Command::Wake(body))?;
    world.add_body(BodyDef::dynamic().with_collider(Shape::polygon(&[vec2(0, 0), vec2(1, 0), vec2(0, 1)])?))?;
    world.add_field(FieldKind::Attractor { centre: End::Body(Attachment::centre(body)), mu: 60.into(), softening: fx!(0) })?;
    world.set_position(body, vec2(1, 2))?;
    world.set_kind(body, BodyKind::Kinematic)?;
    world.move_to(body, vec2(1, 2), fx!(1))?;
    world.apply_force_at_point(body, vec2(1, 2), vec2(0, 0))?;
    world.set_gravity(vec2(0, -10))?;
    world.preview(body)?.step();
    world.step_traced();
    world.step();
    world.step_back(&[])?;
    world.remove_body(body)?;
    let mut rollback = Rollback::new(world, [0, 1], 8);
    let mut recorder = Recorder::new(world, RecordOptions::default());
    rollback.add_input(world.tick(), 0, number)?;
    let tick = |world: &mut World, _: &[(u32, i32)]| _ = world.set_velocity(body, vec2(1, 0));
    for confirmed in rollback.advance(world, tick)?.confirmed() {
        recorder.record(&confirmed)?;
    }
    println!(\"{} {:?}\", world.state_hash(), world.differences(&copy));
";

#[test]
fn the_engine_is_compiled_in_the_library_and_not_in_a_program() {
    let compiler = Compiler::new("weight");
    let object = compiler.compile(&program(GAME)).unwrap_or_else(|said| panic!("{said}"));
    let bytes = fs::metadata(&object).expect("what was compiled").len();
    // With the symbols and tables of an object file. With the engine it would be over 600 kB.
    assert!(
        bytes < 250_000,
        "{bytes} bytes of code and tables: a generic function of the engine was compiled with the program"
    );
}
