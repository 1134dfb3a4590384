//! Statuses of calls: error numbers that stay, and their messages.

use std::any::Any;
use std::cell::RefCell;
use std::error::Error as StdError;
use std::ffi::c_char;
use std::mem::MaybeUninit;
use std::panic::{AssertUnwindSafe, catch_unwind};

use umbra_physics::selftest::{Failure, Problem};
use umbra_physics::{
    Cause, Divergence, Error, Irreversible, Malformed, MathError, ParseFxError, Quantity, ReplayError, SnapshotError,
    VerifyError,
};
use umbra_scene::{SceneError, SceneErrors};

use crate::memory::write_text;

/// Result of a call: `UMBRA_OK`, or the number of an error. The numbers are those of the library (`docs/errors.md`), with
/// some of the interface's own from 901 on. A number is never changed or reused.
pub type UmbraStatus = i32;

/// The call was carried out.
pub const UMBRA_OK: UmbraStatus = 0;
/// A value is outside of the range of its kind; `umbra_last_cause` has the number of the kind, from 151 on.
pub const UMBRA_ERROR_OUT_OF_RANGE: UmbraStatus = 101;
/// The handle names no body: it was removed, or never there.
pub const UMBRA_ERROR_NO_SUCH_BODY: UmbraStatus = 102;
/// The handle names no force field.
pub const UMBRA_ERROR_NO_SUCH_FIELD: UmbraStatus = 103;
/// A time step is num/den seconds, with 1 to 10,000 steps a second.
pub const UMBRA_ERROR_TIME_STEP: UmbraStatus = 104;
/// A corner of a polygon is not convex, or repeats its neighbour.
pub const UMBRA_ERROR_NOT_CONVEX: UmbraStatus = 105;
/// The call needs a dynamic body.
pub const UMBRA_ERROR_NOT_DYNAMIC: UmbraStatus = 107;
/// A static body has no velocity.
pub const UMBRA_ERROR_NOT_MOVABLE: UmbraStatus = 108;
/// The body is quarantined: set its state and release it first.
pub const UMBRA_ERROR_QUARANTINED: UmbraStatus = 109;
/// The body is not quarantined, and cannot be released.
pub const UMBRA_ERROR_NOT_QUARANTINED: UmbraStatus = 110;
/// Yoshida4 needs damping that keeps more than 2^-33 of a velocity a second: a rate below 22.87.
pub const UMBRA_ERROR_DAMPING_HAS_NO_INVERSE: UmbraStatus = 111;
/// One body is named twice, where two different ones are needed.
pub const UMBRA_ERROR_SAME_BODY: UmbraStatus = 112;
/// The world already has the maximum number of bodies, colliders, outlines of colliders, force fields or excluded pairs.
pub const UMBRA_ERROR_FULL: UmbraStatus = 114;
/// The elapsed time no longer fits in a ratio of 128-bit integers.
pub const UMBRA_ERROR_ELAPSED_TIME: UmbraStatus = 115;
/// The tick already has an input of this player and sequence.
pub const UMBRA_ERROR_DUPLICATE_INPUT: UmbraStatus = 117;
/// The last step cannot be undone; `umbra_last_cause` has the number of the reason, 131 to 146.
pub const UMBRA_ERROR_NOT_REVERSIBLE: UmbraStatus = 120;
/// The body is locked along an axis of the velocity; `umbra_last_cause` has which velocity, 153 or 154.
pub const UMBRA_ERROR_LOCKED: UmbraStatus = 121;
/// The body is disabled: enable it first.
pub const UMBRA_ERROR_DISABLED: UmbraStatus = 122;
/// The body is not disabled, and cannot be enabled.
pub const UMBRA_ERROR_NOT_DISABLED: UmbraStatus = 123;
/// The call needs a kinematic body.
pub const UMBRA_ERROR_NOT_KINEMATIC: UmbraStatus = 124;
/// The handle names no collider.
pub const UMBRA_ERROR_NO_SUCH_COLLIDER: UmbraStatus = 128;
/// A chain cannot be on a dynamic body.
pub const UMBRA_ERROR_DYNAMIC_CHAIN: UmbraStatus = 129;
/// Two segments of the chain or the concave polygon cross or touch.
pub const UMBRA_ERROR_CHAIN_CROSSES: UmbraStatus = 130;
/// The handle names no joint.
pub const UMBRA_ERROR_NO_SUCH_JOINT: UmbraStatus = 147;
/// Neither end of the joint is on a dynamic body.
pub const UMBRA_ERROR_NOTHING_TO_MOVE: UmbraStatus = 148;
/// The joint is of a kind that has no motor.
pub const UMBRA_ERROR_NO_MOTOR: UmbraStatus = 214;
/// Sleeping is off in the world.
pub const UMBRA_ERROR_SLEEP_IS_OFF: UmbraStatus = 218;
/// A kinematic body that moves touches the bodies that were to sleep, or is joined to them.
pub const UMBRA_ERROR_KEPT_AWAKE: UmbraStatus = 219;
/// The bytes are not a snapshot.
pub const UMBRA_ERROR_SNAPSHOT_FOREIGN: UmbraStatus = 301;
/// The bytes have another layout.
pub const UMBRA_ERROR_SNAPSHOT_FORMAT: UmbraStatus = 302;
/// The snapshot was made under another physics version.
pub const UMBRA_ERROR_SNAPSHOT_PHYSICS_VERSION: UmbraStatus = 303;
/// The snapshot is cut off or damaged.
pub const UMBRA_ERROR_SNAPSHOT_MALFORMED: UmbraStatus = 304;
/// The snapshot contains an impossible value; `umbra_last_cause` has the reason.
pub const UMBRA_ERROR_SNAPSHOT_INVALID: UmbraStatus = 305;
/// The snapshot uses a custom force, which this interface does not support.
pub const UMBRA_ERROR_SNAPSHOT_CUSTOM_FORCE: UmbraStatus = 306;
/// The restored world does not have the hash that the snapshot states.
pub const UMBRA_ERROR_SNAPSHOT_CHANGED: UmbraStatus = 307;
/// The bytes are not what is expected there.
pub const UMBRA_ERROR_MALFORMED: UmbraStatus = 320;
/// The bytes are not a replay.
pub const UMBRA_ERROR_REPLAY_FOREIGN: UmbraStatus = 401;
/// The bytes have another layout.
pub const UMBRA_ERROR_REPLAY_FORMAT: UmbraStatus = 402;
/// The replay was recorded under another physics version.
pub const UMBRA_ERROR_REPLAY_PHYSICS_VERSION: UmbraStatus = 403;
/// The file ends before the recording did.
pub const UMBRA_ERROR_REPLAY_CUT_OFF: UmbraStatus = 404;
/// The replay was changed after it was recorded; `umbra_last_message` names the value.
pub const UMBRA_ERROR_REPLAY_TAMPERED: UmbraStatus = 405;
/// A chunk of the replay is malformed.
pub const UMBRA_ERROR_REPLAY_MALFORMED: UmbraStatus = 406;
/// A snapshot in the replay is invalid.
pub const UMBRA_ERROR_REPLAY_SNAPSHOT: UmbraStatus = 407;
/// The run diverged from the recording; `umbra_last_message` says where.
pub const UMBRA_ERROR_DIVERGENCE: UmbraStatus = 420;
/// The replay has more ticks than the limit allows.
pub const UMBRA_ERROR_VERIFY_TICKS: UmbraStatus = 422;
/// The replay makes more bodies than the limit allows.
pub const UMBRA_ERROR_VERIFY_BODIES: UmbraStatus = 423;
/// The replay makes more force fields than the limit allows.
pub const UMBRA_ERROR_VERIFY_FIELDS: UmbraStatus = 424;
/// The replay has more commands than the limit allows.
pub const UMBRA_ERROR_VERIFY_COMMANDS: UmbraStatus = 425;
/// The replay makes more colliders than the limit allows.
pub const UMBRA_ERROR_VERIFY_COLLIDERS: UmbraStatus = 426;
/// The replay's contact settings allow more pairs of colliders than the limit.
pub const UMBRA_ERROR_VERIFY_PAIRS: UmbraStatus = 427;
/// The scene says what cannot be. Scenes have numbers from 500 to 510, and those of what the engine refuses of them;
/// `umbra_last_message` has the line.
pub const UMBRA_ERROR_SCENE: UmbraStatus = 500;
/// The argument is zero or negative, where the function has no value.
pub const UMBRA_ERROR_MATH_NOT_POSITIVE: UmbraStatus = 701;
/// The value does not fit in an `UmbraFx`.
pub const UMBRA_ERROR_MATH_OVERFLOW: UmbraStatus = 702;
/// A number is expected, and there is no text.
pub const UMBRA_ERROR_NUMBER_EMPTY: UmbraStatus = 711;
/// The text stops being a number.
pub const UMBRA_ERROR_NUMBER_INVALID_DIGIT: UmbraStatus = 712;
/// The number does not fit.
pub const UMBRA_ERROR_NUMBER_OUT_OF_RANGE: UmbraStatus = 713;
/// A pointer is null where that means nothing.
pub const UMBRA_ERROR_NULL_POINTER: UmbraStatus = 901;
/// An argument is none of those that the function knows: a number of a kind, a flag, a length that no memory has, text that is
/// not UTF-8.
pub const UMBRA_ERROR_BAD_ARGUMENT: UmbraStatus = 902;
/// The buffer is too small; nothing was written to it, and the length or count that was asked for says how large it has to be.
pub const UMBRA_ERROR_BUFFER_TOO_SMALL: UmbraStatus = 903;
/// The library has a fault: it panicked, and the call was ended. What the call changed may only be freed.
pub const UMBRA_ERROR_PANIC: UmbraStatus = 904;
/// A world that a scene or a replay runs is changed by that alone (`umbra_world_leave_scene`), a draft is not stepped, and a world that
/// is being recorded does not go to another state at once.
pub const UMBRA_ERROR_BUSY: UmbraStatus = 905;
/// The replay that runs the world has no more ticks.
pub const UMBRA_ERROR_END: UmbraStatus = 906;

/// Reason why a call was refused.
#[derive(Debug)]
pub(crate) struct Refusal {
    status: UmbraStatus,
    cause: UmbraStatus,
    message: String,
}

pub(crate) type Result<T = ()> = std::result::Result<T, Refusal>;

impl Refusal {
    /// One of the interface's own.
    pub(crate) fn own(status: UmbraStatus, message: &str) -> Self {
        Self { status, cause: 0, message: message.to_owned() }
    }

    /// For an argument that means nothing to the function.
    pub(crate) fn bad(message: &str) -> Self {
        Self::own(UMBRA_ERROR_BAD_ARGUMENT, message)
    }

    fn of(code: u16, error: &dyn StdError) -> Self {
        Self { status: code.into(), cause: error.source().map_or(0, code_of), message: error.to_string() }
    }
}

/// The number of an error that is the cause of another; 0 for one that has none.
fn code_of(error: &(dyn StdError + 'static)) -> UmbraStatus {
    macro_rules! first {
        ($($type:ty),*) => {
            $(if let Some(error) = error.downcast_ref::<$type>() { return error.code().into(); })*
        };
    }
    first!(Quantity, Error, Malformed, Irreversible, Cause, SnapshotError, Problem);
    0
}

macro_rules! refusals {
    ($($type:ty),*) => {
        $(impl From<$type> for Refusal {
            fn from(error: $type) -> Self {
                Self::of(error.code(), &error)
            }
        })*
    };
}

refusals!(Error, Malformed, SnapshotError, ReplayError, MathError, SceneError, SceneErrors, ParseFxError);

impl From<Box<Divergence>> for Refusal {
    fn from(divergence: Box<Divergence>) -> Self {
        Self::of(divergence.code(), &*divergence)
    }
}

impl From<VerifyError> for Refusal {
    fn from(error: VerifyError) -> Self {
        match error {
            VerifyError::Divergence(divergence) => divergence.into(),
            error => Self::of(error.code(), &error),
        }
    }
}

impl From<Failure> for Refusal {
    fn from(failure: Failure) -> Self {
        Self { message: failure.to_string(), ..Self::of(failure.problem.code(), &failure.problem) }
    }
}

thread_local! {
    static LAST: RefCell<Refusal> = const { RefCell::new(Refusal { status: UMBRA_OK, cause: 0, message: String::new() }) };
}

/// Calls, and gives the number of what came of it. The reason of a refusal is kept for this thread.
pub(crate) fn guard(call: impl FnOnce() -> Result) -> UmbraStatus {
    // A panic ends here. What it leaves behind is memory in order, and values that may not belong together: the header says
    // that they may only be freed.
    let refusal = match catch_unwind(AssertUnwindSafe(call)) {
        Ok(Ok(())) => return UMBRA_OK,
        Ok(Err(refusal)) => refusal,
        Err(payload) => panicked(payload),
    };
    let status = refusal.status;
    // A thread that is ending has no place for it any more.
    let _ = LAST.try_with(|last| last.replace(refusal));
    status
}

fn panicked(payload: Box<dyn Any + Send>) -> Refusal {
    let words = payload.downcast_ref::<&str>().copied().or(payload.downcast_ref::<String>().map(String::as_str));
    let refusal = Refusal::own(UMBRA_ERROR_PANIC, words.unwrap_or("a panic"));
    // Its own destructor may panic.
    std::mem::forget(payload);
    refusal
}

/// The number of what caused the last error of this thread, such as 155 (a mass) for `UMBRA_ERROR_OUT_OF_RANGE`; 0 if it has
/// none. Calls that are done leave it as it is.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_last_cause() -> UmbraStatus {
    LAST.try_with(|last| last.borrow().cause).unwrap_or(0)
}

/// The last error of this thread in words, with names, places and values: for a log. Empty if there was none.
///
/// Text goes into `buffer`, which has room for `capacity` bytes, with a zero after it. `length`, which may be null, is given the
/// number of bytes before the zero, also if the buffer is too small; a `capacity` of 0 asks for the length alone.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_last_message(
    buffer: *mut c_char,
    capacity: usize,
    length: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    let text = LAST.try_with(|last| last.borrow().message.clone()).unwrap_or_default();
    // Not guarded: what is said of this call must not take the place of what it is asked for.
    // SAFETY: as the caller promises.
    unsafe { write_text(&text, buffer, capacity, length) }.map_or_else(|refusal| refusal.status, |()| UMBRA_OK)
}

/// General meaning of an error number, as `docs/errors.md` gives it; text as for `umbra_last_message`.
/// `UMBRA_ERROR_BAD_ARGUMENT` for an unknown number, and then nothing is written. The last error is not changed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_status_message(
    status: UmbraStatus,
    buffer: *mut c_char,
    capacity: usize,
    length: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    let Some(text) = meaning(status) else { return UMBRA_ERROR_BAD_ARGUMENT };
    // Not guarded, as in `umbra_last_message`: it is asked of an error that is still to be told.
    // SAFETY: as the caller promises.
    unsafe { write_text(&text, buffer, capacity, length) }.map_or_else(|refusal| refusal.status, |()| UMBRA_OK)
}

/// The list in the document is the list of the interface: no second one to fall behind.
fn meaning(status: UmbraStatus) -> Option<String> {
    if status == UMBRA_OK {
        return Some("done".to_owned());
    }
    let row = format!("| E{status} | ");
    let row = include_str!("../../docs/errors.md").lines().find_map(|line| line.strip_prefix(&row))?;
    let (_, said) = row.trim_end_matches(" |").split_once(" | ")?;
    // A link is its text: `[old files](formats.md#old-files)`.
    let mut text = String::new();
    for (i, part) in said.split('[').enumerate() {
        match part.split_once("](").and_then(|(words, rest)| Some((words, rest.split_once(')')?.1))) {
            Some((words, rest)) if i > 0 => text.extend([words, rest]),
            _ => text.push_str(part),
        }
    }
    Some(text.replace('`', ""))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_ends_in_the_call() {
        assert_eq!(guard(|| panic!("on purpose")), UMBRA_ERROR_PANIC);
        assert_eq!(LAST.with_borrow(|last| last.message.clone()), "on purpose");
        assert_eq!(guard(|| Ok(())), UMBRA_OK);
    }

    #[test]
    fn a_panic_whose_payload_panics_ends_there_too() {
        struct Again;
        impl Drop for Again {
            fn drop(&mut self) {
                panic!("again");
            }
        }
        assert_eq!(guard(|| std::panic::panic_any(Again)), UMBRA_ERROR_PANIC);
    }

    #[test]
    fn a_meaning_is_plain_text() {
        assert_eq!(meaning(302).as_deref(), Some("the snapshot has another format: see old files"));
        assert_eq!(
            meaning(111).as_deref(),
            Some("Yoshida4 needs damping that keeps more than 2^-33 of a velocity a second: a rate below 22.87")
        );
        assert_eq!(meaning(0).as_deref(), Some("done"));
        assert_eq!((meaning(1), meaning(-101), meaning(UmbraStatus::MAX)), (None, None, None));
    }
}
