//! The engine behind functions that take and give integers: numbers as their bits (multiples of 2^-32), handles as
//! slot and generation in one 64-bit word. Worlds are pointers that the host keeps.
//!
//! Every command there is can be reached from [`execute`], which reads them, so that the linker leaves nothing of the engine out.
#![no_std]

extern crate alloc;

use alloc::boxed::Box;
use alloc::string::ToString as _;
use alloc::vec::Vec;
use core::panic::PanicInfo;

use dlmalloc::GlobalDlmalloc;
use umbra_physics::{
    BodyId, Command, Created, Fx, Inputs, RecordOptions, Recorder, Replay, Snapshot, TimeStep, World, WorldDef,
    selftest,
};

#[global_allocator]
static HEAP: GlobalDlmalloc = GlobalDlmalloc;

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    core::arch::wasm32::unreachable()
}

/// Result of [`execute`] for a command that is refused, or is none; no handle has this value.
const REFUSED: i64 = -1;
/// Result for a command that made nothing new.
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

/// Number of bytes that the host writes at [`address`].
#[unsafe(no_mangle)]
pub extern "C" fn buffer(length: usize) -> Box<Vec<u8>> {
    Box::new(alloc::vec![0; length])
}

/// Address of the bytes.
#[unsafe(no_mangle)]
pub extern "C" fn address(bytes: &Vec<u8>) -> usize {
    bytes.as_ptr() as usize
}

/// Number of bytes.
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

/// Carries out a command that comes as bytes. Gives the handle of what it made.
#[unsafe(no_mangle)]
pub extern "C" fn execute(world: &mut World, bytes: &Vec<u8>) -> i64 {
    let Ok(command) = Command::from_bytes(bytes) else { return REFUSED };
    match world.execute(&command) {
        Err(_) => REFUSED,
        Ok(Created::Body(body)) => word(body.parts()),
        Ok(Created::ForceField(field)) => word(field.parts()),
        Ok(_) => DONE,
    }
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

/// Runs a replay again: its number of ticks, -1 if it is none, -2 if the run differs.
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
    let Ok(body) = world.body(body_id(body)) else { return 0 };
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

/// Position of a body along x, for drawing: floats, on purpose.
#[cfg(feature = "drawing")]
#[unsafe(no_mangle)]
pub extern "C" fn draw_x(world: &World, body: u64) -> f64 {
    const ULP: f64 = 1.0 / 4_294_967_296.0;
    world.body(body_id(body)).map_or(0.0, |body| body.position().x.to_bits() as f64 * ULP)
}

fn body_id(word: u64) -> BodyId {
    BodyId::from_parts(word as u32, (word >> 32) as u32)
}

fn word((slot, generation): (u32, u32)) -> i64 {
    i64::from(generation) << 32 | i64::from(slot)
}
