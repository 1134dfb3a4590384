//! The interface from several threads: worlds of their own, one that goes from thread to thread, things that several read, and
//! the last error of each. `README.md` says what may be shared.

use std::ffi::c_char;
use std::fs;
use std::mem::MaybeUninit;
use std::path::Path;
use std::sync::Barrier;
use std::sync::mpsc::channel;
use std::thread::{scope, spawn};

use umbra_physics::{Fx, Random, fx};
use umbra_physics_capi::*;

#[path = "support/out.rs"]
mod support;
use support::out;

const ONE: i64 = UMBRA_ONE;
const THREADS: u64 = 6;

/// An object that a function makes.
fn own<T>(call: impl FnOnce(Option<&mut MaybeUninit<Option<Box<T>>>>) -> UmbraStatus) -> Box<T> {
    support::own(call).expect("it is done")
}

fn last_message() -> String {
    let mut buffer = [0u8; 200];
    let mut length = MaybeUninit::new(0);
    // SAFETY: the buffer is there.
    let status = unsafe { umbra_last_message(buffer.as_mut_ptr().cast::<c_char>(), buffer.len(), Some(&mut length)) };
    assert_eq!(status, UMBRA_OK);
    // SAFETY: initialised above.
    String::from_utf8(buffer[..unsafe { length.assume_init() }].to_vec()).expect("UTF-8")
}

fn world() -> Box<UmbraWorld> {
    let mut def = out(|def| umbra_world_def_default(def)).expect("a definition");
    def.gravity.y = -10 * ONE;
    own(|world| umbra_world_new(Some(&def), world))
}

fn add(world: &mut UmbraWorld, shape: Option<&UmbraShape>, x: i64) -> Result<u64, UmbraStatus> {
    let mut def = out(|def| umbra_body_def_default(def))?;
    def.position.x = x;
    def.angular_velocity = ONE;
    let body = out(|body| umbra_world_add_body(Some(world), Some(&def), body))?;
    give_shape(world, body, shape).map(|()| body)
}

/// Gives a body a collider of this shape that touches nothing.
fn give_shape(world: &mut UmbraWorld, body: u64, shape: Option<&UmbraShape>) -> Result<(), UmbraStatus> {
    let Some(shape) = shape else { return Ok(()) };
    let mut ghost = out(|def| umbra_collider_def_default(def))?;
    (ghost.shape, ghost.mask) = (shape, 0);
    // SAFETY: its shape is alive.
    out(|collider| unsafe { umbra_world_add_collider(Some(world), body, Some(&ghost), collider) }).map(drop)
}

fn state_hash(world: &UmbraWorld) -> u64 {
    out(|hash| umbra_world_state_hash(Some(world), hash)).expect("a hash")
}

fn bodies(world: &UmbraWorld) -> Vec<u64> {
    let mut bodies = vec![0; out(|count| umbra_world_body_count(Some(world), count, None)).expect("a number")];
    // SAFETY: the buffer is there.
    let status = unsafe { umbra_world_bodies(Some(world), bodies.as_mut_ptr(), bodies.len(), None) };
    assert_eq!(status, UMBRA_OK);
    bodies
}

/// The bytes in it, which is freed.
fn taken(mut bytes: Box<UmbraBytes>) -> Vec<u8> {
    let (at, length) = (umbra_bytes_data(Some(&mut bytes)), umbra_bytes_length(Some(&bytes)));
    // SAFETY: that is where they are.
    let copy = unsafe { std::slice::from_raw_parts(at, length) }.to_vec();
    umbra_bytes_free(Some(bytes));
    copy
}

/// A tick of calls as chance has them, refused ones too; what each gave, and the hash after it.
fn tick(world: &mut UmbraWorld, shape: Option<&UmbraShape>, dice: &mut Random) -> (Vec<UmbraStatus>, u64) {
    let mut statuses = Vec::new();
    for _ in 0..dice.below(6) {
        let all = bodies(world);
        // At times one that is not there.
        let body = all.get(dice.below(1 + all.len() as u64) as usize).copied().unwrap_or(UMBRA_NO_HANDLE);
        let mut number = |size: Fx| dice.number(-size..=size).to_bits();
        let (x, y, kind) = (number(fx!(9)), number(fx!(9)), number(fx!(1)).rem_euclid(11));
        statuses.push(match kind {
            0 | 1 => add(world, shape, x).err().unwrap_or(UMBRA_OK),
            2 => umbra_world_remove_body(Some(world), body),
            3 => umbra_world_set_velocity(Some(world), body, x, y),
            4 => umbra_world_apply_force(Some(world), body, x, y, None, 0),
            5 => umbra_world_apply_impulse(Some(world), body, x, y, Some(&UmbraVec2 { x: y, y: x }), UMBRA_BODY_FRAME),
            6 => give_shape(world, body, shape).err().unwrap_or(UMBRA_OK),
            7 => umbra_world_set_mass(Some(world), body, UMBRA_MASS_KILOGRAMS, x, 0),
            8 => umbra_world_disable(Some(world), body),
            9 => {
                let mut spring = out(|def| umbra_field_def_default(UMBRA_SPRING, def)).expect("a definition");
                (spring.body, spring.other_point.x, spring.stiffness) = (body, x, y);
                out(|field| umbra_world_add_field(Some(world), Some(&spring), field)).err().unwrap_or(UMBRA_OK)
            }
            _ => umbra_world_set_gravity(Some(world), x, y),
        });
    }
    statuses.push(umbra_world_step(Some(world)));
    (statuses, state_hash(world))
}

/// A whole match by itself: a world is made, goes on by chance, is put back and read from bytes now and then, and recorded.
fn play(seed: u64, shape: Option<&UmbraShape>) -> (Vec<(Vec<UmbraStatus>, u64)>, Vec<u8>) {
    let mut dice = Random::seeded(seed);
    let mut world = world();
    let mut said: Vec<_> = (0..60).map(|_| tick(&mut world, shape, &mut dice)).collect();
    let mut snapshot = own(|snapshot| umbra_world_snapshot(Some(&world), snapshot));
    for round in 0..5 {
        said.extend((0..20).map(|_| tick(&mut world, shape, &mut dice)));
        match round % 3 {
            0 => assert_eq!(umbra_world_restore(Some(&mut world), Some(&snapshot)), UMBRA_OK),
            1 => assert_eq!(umbra_world_snapshot_into(Some(&world), Some(&mut snapshot)), UMBRA_OK),
            _ => {
                let bytes = taken(own(|bytes| umbra_snapshot_to_bytes(Some(&snapshot), bytes)));
                // SAFETY: the bytes are there.
                let read = own(|read| unsafe { umbra_snapshot_from_bytes(bytes.as_ptr(), bytes.len(), read) });
                let restored = own(|world| umbra_snapshot_world(Some(&read), world));
                umbra_world_free(Some(std::mem::replace(&mut world, restored)));
                umbra_snapshot_free(Some(read));
            }
        }
    }
    umbra_snapshot_free(Some(snapshot));
    assert_eq!(umbra_world_record(Some(&mut world), 1, 16), UMBRA_OK);
    said.extend((0..40).map(|_| tick(&mut world, shape, &mut dice)));
    let file = taken(own(|bytes| umbra_world_end_record(Some(&mut world), bytes)));
    umbra_world_free(Some(world));
    (said, file)
}

fn verified(file: &[u8]) -> Result<u64, UmbraStatus> {
    let limits = UmbraReplayLimits {
        ticks: 1 << 20,
        commands: 1 << 20,
        bodies: 1_000,
        fields: 1_000,
        colliders: 1_000,
        pairs: 1 << 20,
    };
    // SAFETY: the bytes are there.
    out(|ticks| unsafe { umbra_replay_verify(file.as_ptr(), file.len(), Some(&limits), ticks) })
}

#[test]
fn worlds_on_threads_of_their_own_do_what_each_does_alone() {
    let shape = own(|shape| umbra_shape_capsule(ONE, ONE, shape));
    let alone: Vec<_> = (0..THREADS).map(|seed| play(seed, Some(&shape))).collect();
    assert!(alone.iter().flat_map(|(said, _)| said).any(|(statuses, _)| statuses.contains(&UMBRA_ERROR_NO_SUCH_BODY)));
    for _ in 0..3 {
        // All at once, with one shape for all.
        let start = Barrier::new(THREADS as usize);
        let together: Vec<_> = scope(|threads| {
            let play = |seed| {
                let (shape, start) = (&*shape, &start);
                threads.spawn(move || {
                    start.wait();
                    play(seed, Some(shape))
                })
            };
            let all: Vec<_> = (0..THREADS).map(play).collect();
            all.into_iter().map(|thread| thread.join().expect("no panic")).collect()
        });
        assert!(together == alone);
    }
    // One replay is verified by all.
    let (_, file) = &alone[0];
    scope(|threads| (0..THREADS).for_each(|_| _ = threads.spawn(|| assert_eq!(verified(file), Ok(40)))));
    umbra_shape_free(Some(shape));
}

#[test]
fn a_world_goes_from_thread_to_thread() {
    let mut straight = world();
    let mut dice = Random::seeded(7);
    let expected: Vec<_> = (0..300).map(|_| tick(&mut straight, None, &mut dice)).collect();

    // Made here, stepped by each in turn, freed by the last.
    let (say, said) = channel();
    let mut state = (world(), Random::seeded(7));
    for _ in 0..30 {
        let say = say.clone();
        let thread = spawn(move || {
            let (world, dice) = &mut state;
            (0..10).for_each(|_| say.send(tick(world, None, dice)).expect("it listens"));
            state
        });
        state = thread.join().expect("no panic");
    }
    assert!(said.try_iter().eq(expected));
    assert_eq!(state_hash(&state.0), state_hash(&straight));
    spawn(move || umbra_world_free(Some(state.0))).join().expect("no panic");
    umbra_world_free(Some(straight));
}

#[test]
fn a_world_is_read_by_several_threads_at_once() {
    let mut world = world();
    let mut dice = Random::seeded(3);
    (0..100).for_each(|_| _ = tick(&mut world, None, &mut dice));
    let look = |world: &UmbraWorld| {
        let hash = state_hash(world);
        let physics = out(|hash| umbra_world_physics_hash(Some(world), hash)).expect("a hash");
        let states: Vec<UmbraBodyState> = bodies(world)
            .into_iter()
            .map(|body| out(|at| umbra_world_body(Some(world), body, at)).expect("it is there"))
            .collect();
        let report = out(|report| umbra_world_report(Some(world), report)).expect("a report");
        let snapshot = own(|snapshot| umbra_world_snapshot(Some(world), snapshot));
        let bytes = taken(own(|bytes| umbra_snapshot_to_bytes(Some(&snapshot), bytes)));
        umbra_snapshot_free(Some(snapshot));
        // A command that would be carried out, and is not.
        // SAFETY: the bytes are there.
        let check = unsafe { umbra_world_check(Some(world), [27].as_ptr(), 1) };
        (hash, physics, states, report, bytes, check)
    };
    for _ in 0..20 {
        // Between two changes all may look.
        let expected = look(&world);
        assert!(expected.2.len() > 3 && expected.5 == UMBRA_OK);
        scope(|threads| {
            let (world, look, expected) = (&*world, &look, &expected);
            (0..THREADS).for_each(|_| _ = threads.spawn(move || assert!(look(world) == *expected)));
        });
        _ = tick(&mut world, None, &mut dice);
    }
    umbra_world_free(Some(world));
}

#[test]
fn worlds_that_share_what_no_step_changes_go_on_apart() {
    let mut first = world();
    let shape = own(|shape| umbra_shape_circle(ONE, shape));
    let mut dice = Random::seeded(11);
    (0..80).for_each(|_| _ = tick(&mut first, Some(&shape), &mut dice));
    let snapshot = own(|snapshot| umbra_world_snapshot(Some(&first), snapshot));
    let before = state_hash(&first);
    // A copy, or a world from a snapshot: both share bodies, fields and shapes with it until one changes them.
    let go_on = |first: &UmbraWorld, snapshot: &UmbraSnapshot, seed: u64| {
        let mut copy = if seed % 2 == 0 {
            own(|copy| umbra_world_clone(Some(first), copy))
        } else {
            own(|world| umbra_snapshot_world(Some(snapshot), world))
        };
        let mut dice = Random::seeded(seed);
        let said: Vec<_> = (0..60).map(|_| tick(&mut copy, None, &mut dice)).collect();
        umbra_world_free(Some(copy));
        said
    };
    let alone: Vec<_> = (0..THREADS).map(|seed| go_on(&first, &snapshot, seed)).collect();
    for _ in 0..3 {
        let together: Vec<_> = scope(|threads| {
            let (first, snapshot, go_on) = (&*first, &*snapshot, &go_on);
            let all: Vec<_> = (0..THREADS).map(|seed| threads.spawn(move || go_on(first, snapshot, seed))).collect();
            all.into_iter().map(|thread| thread.join().expect("no panic")).collect()
        });
        assert!(together == alone && state_hash(&first) == before);
    }
    umbra_snapshot_free(Some(snapshot));
    umbra_shape_free(Some(shape));
    umbra_world_free(Some(first));
}

#[test]
fn runs_of_one_scene_go_on_apart_and_outlive_each_other() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let json = fs::read_to_string(root.join("scenes/lander.json")).expect("a scene");
    // SAFETY: the text is there.
    let first = own(|world| unsafe { umbra_world_from_scene(json.as_ptr().cast(), json.len(), 1_000, world) });
    let name = |world: &UmbraWorld| {
        let name = "lander";
        // SAFETY: the text is there.
        out(|body| unsafe { umbra_world_find_body(Some(world), name.as_ptr().cast(), name.len(), body) })
    };
    let run = |mut world: Box<UmbraWorld>, ticks: u64| {
        (0..ticks).for_each(|_| assert_eq!(umbra_world_step(Some(&mut world)), UMBRA_OK));
        let end = (name(&world), state_hash(&world));
        umbra_world_free(Some(world));
        end
    };
    let alone: Vec<_> =
        (0..THREADS).map(|i| run(own(|copy| umbra_world_clone(Some(&first), copy)), 40 + 10 * i)).collect();
    let copies: Vec<_> = (0..THREADS).map(|_| own(|copy| umbra_world_clone(Some(&first), copy))).collect();
    let together: Vec<_> = scope(|threads| {
        let run = &run;
        let all: Vec<_> = (0..).zip(copies).map(|(i, copy)| threads.spawn(move || run(copy, 40 + 10 * i))).collect();
        // The first of them goes while the others are on their way.
        umbra_world_free(Some(first));
        all.into_iter().map(|thread| thread.join().expect("no panic")).collect()
    });
    assert!(together == alone && alone[0].0.is_ok());
}

#[test]
fn inputs_are_read_by_several_worlds_at_once() {
    let mut draft = own(|draft| umbra_draft_new(draft));
    let mut inputs = own(|inputs| umbra_inputs_new(inputs));
    for player in 0..4 {
        // The fourth names a body that is not there.
        assert_eq!(umbra_world_set_velocity(Some(&mut draft), player.into(), ONE, 0), UMBRA_OK);
        let mut command = [0; 135];
        // SAFETY: the buffer is there.
        let length =
            out(|length| unsafe { umbra_draft_command(Some(&draft), command.as_mut_ptr(), command.len(), length) });
        let length = length.expect("bytes");
        // SAFETY: the bytes are there.
        let status = unsafe { umbra_inputs_insert(Some(&mut inputs), player, 0, command.as_ptr(), length) };
        assert_eq!(status, UMBRA_OK);
    }
    let go_on = |inputs: &UmbraInputs| {
        let mut world = world();
        (0..3).for_each(|x| _ = add(&mut world, None, x * ONE).expect("a body"));
        let hashes: Vec<u64> = (0..50)
            .map(|_| {
                assert_eq!(umbra_world_step_inputs(Some(&mut world), Some(inputs)), UMBRA_OK);
                state_hash(&world)
            })
            .collect();
        let mut outcomes = [UmbraInputResult::default(); 4];
        // SAFETY: the buffer is there.
        let status = unsafe { umbra_world_outcomes(Some(&world), outcomes.as_mut_ptr(), outcomes.len(), None) };
        assert_eq!(status, UMBRA_OK);
        umbra_world_free(Some(world));
        (hashes, outcomes.map(|outcome| outcome.status))
    };
    let alone = go_on(&inputs);
    assert_eq!(alone.1, [UMBRA_OK, UMBRA_OK, UMBRA_OK, UMBRA_ERROR_NO_SUCH_BODY]);
    scope(|threads| {
        let (inputs, go_on, alone) = (&*inputs, &go_on, &alone);
        (0..THREADS).for_each(|_| _ = threads.spawn(move || assert!(go_on(inputs) == *alone)));
    });
    umbra_inputs_free(Some(inputs));
    umbra_world_free(Some(draft));
}

#[test]
fn the_last_error_is_that_of_the_thread() {
    let world = world();
    type Call = fn(&UmbraWorld) -> UmbraStatus;
    let body: Call = |world| out(|at| umbra_world_body(Some(world), 5, at)).map_or_else(|status| status, |_| UMBRA_OK);
    let size: Call = |_| umbra_shape_circle(-ONE, Some(&mut MaybeUninit::uninit()));
    let null: Call = |_| umbra_world_step(None);
    // What is done leaves it as it is, and what was never refused has nothing to tell.
    let done: Call = |world| umbra_world_state_hash(Some(world), Some(&mut MaybeUninit::uninit()));
    let calls = [
        (body, UMBRA_ERROR_NO_SUCH_BODY, 0, "no such body: body 5"),
        (
            size,
            UMBRA_ERROR_OUT_OF_RANGE,
            158,
            "out of range: expected a radius from 2^-7 (0.0078125) to 2^12 m, not -1",
        ),
        (null, UMBRA_ERROR_NULL_POINTER, 0, "a pointer is null"),
        (done, UMBRA_OK, 0, ""),
    ];
    // Each is refused for another reason, and after all were, has its own still.
    let all = Barrier::new(calls.len());
    let told = scope(|threads| {
        let (world, all) = (&*world, &all);
        let told = calls.map(|(call, ..)| {
            threads.spawn(move || {
                let before = last_message();
                all.wait();
                let status = call(world);
                all.wait();
                (before, status, umbra_last_cause(), last_message())
            })
        });
        told.map(|thread| thread.join().expect("no panic"))
    });
    for ((before, status, cause, message), (_, its_status, its_cause, its_message)) in told.into_iter().zip(calls) {
        assert_eq!((&before[..], status, cause, &message[..]), ("", its_status, its_cause, its_message));
    }
    // An error stays with its thread when the world goes to another.
    assert_eq!(body(&world), UMBRA_ERROR_NO_SUCH_BODY);
    let thread = spawn(move || {
        umbra_world_free(Some(world));
        (umbra_last_cause(), last_message())
    });
    assert_eq!(thread.join().expect("no panic"), (0, String::new()));
    assert_eq!(last_message(), "no such body: body 5");
}
