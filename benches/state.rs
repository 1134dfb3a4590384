//! Time of what a rollback does besides steps: keeping a copy of the world, going back to it, and the hash of the state; and
//! of a whole rollback, beside the steps that are in it; of undoing steps, which needs no copy; and of recording them.
//!
//! Ids are paths such as `state/copy_100k/fx`. Bytes a second count the motion of the bodies alone: positions, velocities,
//! angles, spins; of steps what counts is their number. Compare within one run only.

use divan::counter::{BytesCount, ItemsCount};
use divan::{Bencher, black_box};
use scenes::Scene;
use umbra_physics::{
    ApplyOptions, Command, ForceOrImpulse, Fx, Input, Inputs, RecordOptions, Recorder, Rollback, Scalar, World, fx,
    vec2,
};

#[allow(dead_code, reason = "these benches use one of the scenes")]
mod scenes;

fn main() {
    divan::main();
}

fn motion<S: Scalar>(bodies: usize) -> BytesCount {
    BytesCount::new(bodies * (5 * size_of::<S::Accumulator>() + size_of::<S::Angle>()))
}

/// A world, and a copy of it from eight ticks ago.
fn rolled<S: Scalar>(bodies: usize) -> (World<S>, World<S>) {
    let mut world = scenes::free(bodies).world;
    world.step();
    let kept = world.clone();
    for _ in 0..8 {
        world.step();
    }
    (world, kept)
}

/// Into the memory of an older copy, as at every tick of a match.
fn copy<S: Scalar>(bencher: Bencher, bodies: usize) {
    let (world, mut kept) = rolled::<S>(bodies);
    bencher.counter(motion::<S>(bodies)).bench_local(|| black_box(&mut kept).clone_from(black_box(&world)));
}

fn restore<S: Scalar>(bencher: Bencher, bodies: usize) {
    let (mut world, kept) = rolled::<S>(bodies);
    bencher.counter(motion::<S>(bodies)).bench_local(|| black_box(&mut world).clone_from(black_box(&kept)));
}

fn hash<S: Scalar>(bencher: Bencher, bodies: usize) {
    let (world, _) = rolled::<S>(bodies);
    bencher.counter(motion::<S>(bodies)).bench_local(|| black_box(&world).state_hash());
}

/// A step of bodies that no field reaches, or of a net of springs.
fn there(bencher: Bencher, mut world: World) {
    bencher.counter(ItemsCount::new(world.moving_count())).bench_local(|| _ = black_box(&mut world).step());
}

/// A step, and the same undone: twice the time if one costs what the other does.
fn there_and_back(bencher: Bencher, mut world: World) {
    bencher.counter(ItemsCount::new(2 * world.moving_count())).bench_local(|| {
        black_box(&mut world).step();
        black_box(&mut world).step_back(&[]).expect("it has a way back");
    });
}

/// One module a bench and size, with a bench a scalar.
macro_rules! sizes {
    ($($name:ident: $bench:ident($bodies:expr);)*) => {$(
        mod $name {
            use super::*;

            #[divan::bench]
            fn fx(bencher: Bencher) {
                $bench::<Fx>(bencher, $bodies);
            }

            #[divan::bench]
            fn f64(bencher: Bencher) {
                $bench::<f64>(bencher, $bodies);
            }
        }
    )*};
}

sizes! {
    copy_10: copy(10);
    copy_1k: copy(1_000);
    copy_100k: copy(100_000);
    restore_10: restore(10);
    restore_1k: restore(1_000);
    restore_100k: restore(100_000);
    hash_10: hash(10);
    hash_1k: hash(1_000);
    hash_100k: hash(100_000);
}

/// Number of ticks that a rollback goes back.
const BACK: u64 = 8;

/// A player who changes nothing in the world.
fn no_calls<S: Scalar>(_: &mut World<S>, _: &[(u32, bool)]) {}

/// A world and a rollback with as many unconfirmed ticks.
fn unconfirmed<S: Scalar>(mut world: World<S>) -> (World<S>, Rollback<bool, S>) {
    let mut rollback = Rollback::new(&world, [0], BACK as usize + 1);
    for now in 0..32 {
        if let Some(confirmed) = (now as u64).checked_sub(BACK) {
            rollback.add_input(confirmed, 0, false).expect("a player");
        }
        rollback.advance(&mut world, no_calls).expect("nothing else changes the world");
    }
    (world, rollback)
}

/// An input that was predicted wrongly: back by eight ticks, to the present again, and on to the next tick.
fn roll_back<S: Scalar>(bencher: Bencher, scene: Scene<S>) {
    let (mut world, mut rollback) = unconfirmed(scene.world);
    let mut pressed = true;
    bencher.bench_local(|| {
        rollback.add_input(rollback.first_unconfirmed(), 0, pressed).expect("a player");
        let report = black_box(&mut rollback).advance(black_box(&mut world), no_calls).expect("unchanged");
        assert_eq!(black_box(report.redone), BACK);
        pressed = !pressed;
    });
}

/// The steps alone.
fn nine_steps<S: Scalar>(bencher: Bencher, scene: Scene<S>) {
    let (mut world, _) = unconfirmed(scene.world);
    bencher.bench_local(|| {
        for _ in 0..=BACK {
            black_box(&mut world).step();
        }
    });
}

macro_rules! rollbacks {
    ($($name:ident: $scene:expr;)*) => {$(
        mod $name {
            use super::*;

            #[divan::bench]
            fn nine_steps(bencher: Bencher) {
                super::nine_steps::<Fx>(bencher, $scene);
            }

            #[divan::bench]
            fn roll_back(bencher: Bencher) {
                super::roll_back::<Fx>(bencher, $scene);
            }
        }
    )*};
}

rollbacks! {
    rollback_free_1k: scenes::free(1_000);
    rollback_net_1k: scenes::net(40, 25);
    rollback_orbits_1k: scenes::orbits(1_000);
    rollback_free_10: scenes::free(10);
}

/// One module a scene, with a bench of its step and one of its step and back, in fixed point: sums of floats round.
macro_rules! ways {
    ($($name:ident: $scene:expr;)*) => {$(
        mod $name {
            use super::*;

            #[divan::bench]
            fn there(bencher: Bencher) {
                super::there(bencher, $scene.world);
            }

            #[divan::bench]
            fn there_and_back(bencher: Bencher) {
                super::there_and_back(bencher, $scene.world);
            }
        }
    )*};
}

ways! {
    step_free_10: scenes::falling(10);
    step_free_1k: scenes::falling(1_000);
    step_free_100k: scenes::falling(100_000);
    step_net_1k: scenes::net(40, 25);
}

/// Number of ticks measured at once, so that each sample contains the occasional hash.
const TICKS: u32 = 16;

/// A player who pushes the last body.
fn push(world: &World) -> Inputs {
    let body = world.bodies().last().expect("it has bodies").id();
    let action = ForceOrImpulse::Force { force: vec2(1, fx!(0.5)), point: None };
    let command = Command::Apply { body, action, options: ApplyOptions::default() };
    let mut inputs = Inputs::new();
    inputs.insert(Input { player: 0, sequence: 0, command }).expect("the first");
    inputs
}

/// Ticks with a command each, as they are without a recorder.
fn unrecorded(bencher: Bencher, mut world: World) {
    let inputs = push(&world);
    bencher.counter(ItemsCount::new(TICKS)).bench_local(|| {
        for _ in 0..TICKS {
            _ = black_box(black_box(&mut world).carry_out(&inputs));
            world.step();
        }
    });
}

/// Ticks that are recorded, with the bytes taken as by a game that writes them away.
fn recorded(bencher: Bencher, mut world: World, hash_every: u32) {
    let inputs = push(&world);
    let mut recorder = Recorder::new(&world, RecordOptions { hash_every, ..RecordOptions::default() });
    bencher.counter(ItemsCount::new(TICKS)).bench_local(|| {
        for _ in 0..TICKS {
            black_box(&mut recorder).step(black_box(&mut world), &inputs);
            _ = black_box(recorder.take_bytes());
        }
    });
}

macro_rules! recordings {
    ($($name:ident: $scene:expr;)*) => {$(
        mod $name {
            use super::*;

            #[divan::bench]
            fn unrecorded(bencher: Bencher) {
                super::unrecorded(bencher, $scene.world);
            }

            #[divan::bench]
            fn hash_every_16th(bencher: Bencher) {
                super::recorded(bencher, $scene.world, 16);
            }

            #[divan::bench]
            fn hash_every_tick(bencher: Bencher) {
                super::recorded(bencher, $scene.world, 1);
            }
        }
    )*};
}

recordings! {
    record_free_1k: scenes::free(1_000);
    record_plain_1k: scenes::plain(1_000);
    record_net_1k: scenes::net(40, 25);
    record_mixed_1k: scenes::mixed(1_000);
}
