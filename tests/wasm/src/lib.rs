//! The engine behind functions that take and give integers: numbers as their bits (multiples of 2^-32), handles as
//! slot and generation in one 64-bit word. Worlds are pointers that the host keeps.
//!
//! Every command there is can be reached from [`command`], so that the linker leaves nothing of the engine out.
#![no_std]

extern crate alloc;

use alloc::boxed::Box;
use alloc::string::ToString as _;
use alloc::vec::Vec;
use core::panic::PanicInfo;

use dlmalloc::GlobalDlmalloc;
use umbra_physics::scalar::Factor as _;
use umbra_physics::{
    Action, Attachment, BodyDef, BodyId, BodyKind, Command, End, Error, Field, FieldId, Frame, Fx, FxFactor, Inputs,
    Integrator, Law, Made, Manner, Mass, Part, RecordOptions, Recorder, Region, Replay, Shape, Snapshot, SpringLaw,
    TimeStep, Vec2, World, WorldDef, selftest,
};

#[global_allocator]
static HEAP: GlobalDlmalloc = GlobalDlmalloc;

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    core::arch::wasm32::unreachable()
}

/// What [`command`] gives for one that is refused, or is none; nothing made has it.
const REFUSED: i64 = -1;
/// What it gives for one that made nothing new.
const DONE: i64 = -2;

/// A world of so many steps a second, or none if that is out of range.
#[unsafe(no_mangle)]
pub extern "C" fn create(rate: u32) -> Option<Box<World>> {
    let def = WorldDef { time_step: TimeStep::hz(rate), ..WorldDef::default() };
    World::new(def).ok().map(Box::new)
}

/// Ends a world.
#[unsafe(no_mangle)]
pub extern "C" fn destroy(world: Box<World>) {
    drop(world);
}

/// Moves a world on by a tick; gives the number of bodies that were quarantined.
#[unsafe(no_mangle)]
pub extern "C" fn step(world: &mut World) -> u32 {
    world.step().faults.len() as u32
}

/// The hash of its state.
#[unsafe(no_mangle)]
pub extern "C" fn hash(world: &World) -> u64 {
    world.state_hash()
}

/// So many bytes that the host writes into, where [`address`] says.
#[unsafe(no_mangle)]
pub extern "C" fn buffer(length: usize) -> Box<Vec<u8>> {
    Box::new(alloc::vec![0; length])
}

/// Where bytes lie.
#[unsafe(no_mangle)]
pub extern "C" fn address(bytes: &Vec<u8>) -> usize {
    bytes.as_ptr() as usize
}

/// How many there are.
#[unsafe(no_mangle)]
pub extern "C" fn length(bytes: &Vec<u8>) -> usize {
    bytes.len()
}

/// Ends bytes.
#[unsafe(no_mangle)]
pub extern "C" fn discard(bytes: Box<Vec<u8>>) {
    drop(bytes);
}

/// The bytes of a snapshot.
#[unsafe(no_mangle)]
pub extern "C" fn snapshot(world: &World) -> Box<Vec<u8>> {
    Box::new(world.snapshot().to_bytes())
}

/// Goes back to a snapshot: 0, or -1 if the bytes are none.
#[unsafe(no_mangle)]
pub extern "C" fn restore(world: &mut World, bytes: &Vec<u8>) -> i32 {
    let Ok(snapshot) = Snapshot::from_bytes(bytes, &[]) else { return -1 };
    world.restore(&snapshot);
    0
}

/// Carries out a command that comes as bytes: 0, or -1 if they are none or it is refused.
#[unsafe(no_mangle)]
pub extern "C" fn execute(world: &mut World, bytes: &Vec<u8>) -> i32 {
    let command = Command::from_bytes(bytes);
    if command.is_ok_and(|command| world.execute(&command).is_ok()) { 0 } else { -1 }
}

/// Begins to record a world.
#[unsafe(no_mangle)]
pub extern "C" fn record(world: &World) -> Box<Recorder> {
    Box::new(Recorder::new(world, RecordOptions::default()))
}

/// Moves a world on by a tick that is recorded.
#[unsafe(no_mangle)]
pub extern "C" fn record_step(recorder: &mut Recorder, world: &mut World) {
    recorder.step(world, &Inputs::new());
}

/// Ends a recording: the bytes of the replay.
#[unsafe(no_mangle)]
pub extern "C" fn record_end(recorder: Box<Recorder>, world: &World) -> Box<Vec<u8>> {
    Box::new(recorder.finish(world))
}

/// Runs a replay again: its number of ticks, -1 if it is none, -2 if it goes another way.
#[unsafe(no_mangle)]
pub extern "C" fn verify(bytes: &Vec<u8>) -> i64 {
    let Ok(replay) = Replay::from_bytes(bytes, &[]) else { return -1 };
    match replay.verify() {
        Ok(()) => (replay.end() - replay.start().tick()) as i64,
        Err(_) => -2,
    }
}

/// A number of a body: 0 and 1 its place, 2 and 3 its velocity, 4 its angle, 5 its angular velocity, 6 and 7 the cosine and
/// sine of its angle; 0 of a body that is not there.
#[unsafe(no_mangle)]
pub extern "C" fn read(world: &World, body: u64, number: u32) -> i64 {
    let Ok(body) = world.body(body_id(body as i64)) else { return 0 };
    let (place, velocity, turned) = (body.position(), body.velocity(), body.rotation());
    let numbers =
        [place.x, place.y, velocity.x, velocity.y, body.angle(), body.angular_velocity(), turned.cos, turned.sin];
    numbers.get(number as usize).map_or(0, |number| number.to_bits())
}

/// The energy of a world in whole joules, and the decimal text of a number there and back: 1 if it comes back.
#[unsafe(no_mangle)]
pub extern "C" fn texts(world: &World, number: i64) -> i64 {
    let number = Fx::from_bits(number);
    let energy = world.energy().map_or(0, |energy| energy.to_string().len() as i64);
    let back = number.to_string().parse::<Fx>() == Ok(number);
    energy << 1 | i64::from(back)
}

/// The digest of the corpus; 0 if a scene failed.
#[unsafe(no_mangle)]
pub extern "C" fn corpus() -> u64 {
    selftest::run().map_or(0, |outcome| outcome.digest)
}

/// Where a body is along x, for drawing: floats, on purpose.
#[cfg(feature = "drawing")]
#[unsafe(no_mangle)]
pub extern "C" fn draw_x(world: &World, body: u64) -> f64 {
    const ULP: f64 = 1.0 / 4_294_967_296.0;
    world.body(body_id(body as i64)).map_or(0.0, |body| body.position().x.to_bits() as f64 * ULP)
}

fn body_id(word: i64) -> BodyId {
    BodyId::from_parts(word as u32, (word >> 32) as u32)
}

fn field_id(word: i64) -> FieldId {
    FieldId::from_parts(word as u32, (word >> 32) as u32)
}

fn word((slot, generation): (u32, u32)) -> i64 {
    i64::from(generation) << 32 | i64::from(slot)
}

/// A command by its number, with up to six arguments. Gives the handle of what it made.
#[unsafe(no_mangle)]
pub extern "C" fn command(world: &mut World, number: u32, a: i64, b: i64, c: i64, d: i64, e: i64, f: i64) -> i64 {
    let Ok(Some(command)) = decode(number, [a, b, c, d, e, f]) else { return REFUSED };
    match world.execute(&command) {
        Err(_) => REFUSED,
        Ok(Made::Body(body)) => word(body.parts()),
        Ok(Made::Field(field)) => word(field.parts()),
        Ok(Made::Nothing) => DONE,
    }
}

fn decode(number: u32, [a, b, c, d, e, f]: [i64; 6]) -> Result<Option<Command>, Error> {
    let fx = Fx::from_bits;
    let pair = |x: i64, y: i64| Vec2::new(fx(x), fx(y));
    let body = body_id(a);
    let manner = Manner { frame: if f & 1 == 0 { Frame::World } else { Frame::Body }, wake: f & 2 == 0 };
    let kind = |word: i64| match word {
        0 => BodyKind::Static,
        1 => BodyKind::Kinematic,
        _ => BodyKind::Dynamic,
    };
    let point = (f & 4 == 0).then(|| pair(d, e));
    Ok(Some(match number {
        0 => {
            let (position, velocity, mass) = (pair(b, c), pair(d, e), Mass::Of(fx(f)));
            Command::AddBody(BodyDef { kind: kind(a), position, velocity, mass, ..BodyDef::dynamic() })
        }
        1 => Command::RemoveBody(body),
        2 => Command::Apply { body, action: Action::Force { force: pair(b, c), point }, manner },
        3 => Command::Apply { body, action: Action::Torque(fx(b)), manner },
        4 => Command::Apply { body, action: Action::Impulse { impulse: pair(b, c), point }, manner },
        5 => Command::Apply { body, action: Action::AngularImpulse(fx(b)), manner },
        6 => Command::SetPosition { body, position: pair(b, c) },
        7 => Command::SetAngle { body, angle: fx(b) },
        8 => Command::SetVelocity { body, velocity: pair(b, c) },
        9 => Command::SetAngularVelocity { body, velocity: fx(b) },
        10 => {
            Command::SetMass { body, mass: if c == 0 { Mass::Density(fx(b)) } else { Mass::WithInertia(fx(b), fx(c)) } }
        }
        11 => Command::SetShape { body, shape: shape(b, c, d)? },
        12 => Command::SetKind { body, kind: kind(b) },
        13 => Command::SetGravityScale { body, scale: fx(b) },
        14 => Command::SetBodyDamping { body, linear: Some(fx(b)), angular: Some(fx(c)) },
        15 => Command::SetGroups { body, groups: b as u32 },
        16 => Command::SetKey { body, key: b as u64 },
        17 => Command::SetUserData { body, user_data: b as u64 },
        18 => Command::Wake(body),
        19 => Command::Release(body),
        20 => Command::AddField(field(a, b, c, d, e, f)),
        21 => Command::SetField { id: field_id(f), field: field(a, b, c, d, e, 0) },
        22 => Command::RemoveField(field_id(a)),
        23 => Command::SetTimeStep(TimeStep::ratio(a as u32, b as u32)),
        24 => Command::SetGravity(pair(a, b)),
        25 => Command::SetIntegrator(Integrator::ALL[a.unsigned_abs() as usize % Integrator::ALL.len()]),
        26 => Command::SetDamping { linear: fx(a), angular: fx(b) },
        27 => Command::SetSleepAfter(u32::try_from(a).ok()),
        _ => return Ok(None),
    }))
}

fn shape(kind: i64, a: i64, b: i64) -> Result<Option<Shape>, Error> {
    let (a, b) = (Fx::from_bits(a), Fx::from_bits(b));
    let corner = |x, y| Vec2::new(x, y);
    Ok(Some(match kind {
        0 => return Ok(None),
        1 => Shape::circle(a)?,
        2 => Shape::rectangle(a, b)?,
        3 => Shape::capsule(a, b)?,
        4 => Shape::polygon(&[Vec2::ZERO, corner(a, Fx::ZERO), corner(a, b), corner(Fx::ZERO, b)])?,
        5 => Shape::segment(Vec2::ZERO, corner(a, b))?,
        _ => {
            let part = |x| -> Result<Part, Error> {
                Ok(Part { shape: Shape::circle(a)?, position: corner(x, b), angle: b, density: Fx::ONE })
            };
            Shape::compound(&[part(Fx::ZERO)?, part(a)?].into_iter().collect::<Vec<_>>())?
        }
    }))
}

/// A field of a kind, mostly of the body `a`.
fn field(a: i64, kind: i64, b: i64, c: i64, d: i64, other: i64) -> Field {
    let fx = Fx::from_bits;
    let (at, point) = (Attachment::centre(body_id(a)), Vec2::new(fx(b), fx(c)));
    let end = || if other == 0 { End::World(point) } else { End::Body(Attachment::centre(body_id(other))) };
    match kind {
        0 => Law::Attractor { centre: end(), mu: FxFactor::from_scalar(fx(d)), softening: fx(c) },
        1 => Law::Spring { near: at, far: end(), spring: SpringLaw { rest: fx(b), stiffness: fx(c), damping: fx(d) } },
        2 => Law::Drag { linear: fx(b), quadratic: fx(c), wind: Vec2::new(fx(d), Fx::ZERO) },
        3 => Law::Thrust { at, force: point },
        4 => Law::Zone { region: Region::Disc { centre: point, radius: fx(d) }, acceleration: point },
        5 => Law::Zone { region: Region::Box { min: -point, max: point }, acceleration: point },
        _ => Law::Custom { id: b as u64 },
    }
    .into()
}
