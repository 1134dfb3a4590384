//! Runs a property over many plans, and leaves the least one that breaks it as a scene in a file.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;

use proptest::prelude::*;
use proptest::test_runner::{Config, TestCaseError, TestError, TestRunner};
use umbra_oracles::{self as oracle, Oracle, Script};
use umbra_scene::Scene;

use crate::promises::plan::Plan;

/// Description of the violation.
pub(crate) type Verdict = Result<(), String>;

/// So many cases by day.
pub(crate) fn config(by_day: u32) -> Config {
    Config { max_shrink_iters: 20_000, ..crate::promises::cases::cases(by_day) }
}

/// Enough to find what is false, however few are asked for, and to make little of it.
pub(crate) fn until_found() -> Config {
    Config { cases: 5_000, ..config(0) }
}

/// Returns true if one of the generated values satisfies the condition.
pub(crate) fn there_is<T: std::fmt::Debug>(values: impl Strategy<Value = T>, is_such: impl Fn(&T) -> bool) -> bool {
    let property = |value: &T| if is_such(value) { Err("found".to_owned()) } else { Ok(()) };
    falsified(Config { max_shrink_iters: 0, ..until_found() }, values, property).is_some()
}

/// The least value for which a property does not hold, and what it says of it.
pub(crate) fn falsified<T: std::fmt::Debug>(
    config: Config,
    values: impl Strategy<Value = T>,
    property: impl Fn(&T) -> Verdict,
) -> Option<(T, String)> {
    let outcome = TestRunner::new(config).run(&values, |value| property(&value).map_err(TestCaseError::fail));
    match outcome {
        Ok(()) => None,
        Err(TestError::Fail(why, value)) => Some((value, why.message().to_owned())),
        Err(TestError::Abort(why)) => panic!("no plan was tried to the end: {why}"),
    }
}

/// Writes a scene to where the system has files for a while.
pub(crate) fn written(promise: &str, why: &str, script: &Script) -> Result<PathBuf, String> {
    let scene = Scene::from_commands(script.world, &script.commands, script.ticks);
    let mut scene = scene.map_err(|unsayable| unsayable.to_string())?;
    // A scene's texts have no control characters.
    let in_a_line: String = why.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    (scene.title, scene.about) = (format!("Breaks {promise}"), in_a_line);
    let folder = std::env::temp_dir().join("umbra-promises");
    std::fs::create_dir_all(&folder).map_err(|error| error.to_string())?;
    let file = folder.join(format!("{promise}-{}.json", std::process::id()));
    std::fs::write(&file, scene.to_json()).map_err(|error| error.to_string())?;
    Ok(file)
}

/// Result of a property on a script; the panic message if the script makes it panic.
fn verdict(script: &Script, property: &impl Fn(&Script) -> Verdict) -> Verdict {
    catch_unwind(AssertUnwindSafe(|| property(script))).unwrap_or_else(|panic| {
        let said = panic.downcast_ref::<String>().map(String::as_str).or(panic.downcast_ref::<&str>().copied());
        Err(format!("a panic: {}", said.unwrap_or("without words")))
    })
}

/// The least run of these plans that breaks a property, and how.
pub(crate) fn broken(
    config: Config,
    plans: impl Strategy<Value = Plan>,
    property: impl Fn(&Script) -> Verdict,
) -> Option<(Script, String)> {
    let (plan, first) = falsified(config, plans, |plan| verdict(&plan.script(), &property))?;
    let script = plan.script();
    // What breaks it once and then holds is as it was found.
    let least = script.shrunk_by(20_000, |script| verdict(script, &property).err().map(|_| u64::MAX));
    let script = least.unwrap_or(script);
    // What does not break it again broke it once.
    let why = verdict(&script, &property).err().unwrap_or(first);
    Some((script, why))
}

fn fail(promise: &str, why: &str, value: &str, script: &Script) -> ! {
    let file = match written(promise, why, script) {
        Ok(file) => format!("umbra run {}", file.display()),
        Err(error) => format!("there is no scene of it: {error}\n{script:?}"),
    };
    panic!("{promise}: {why}\n{value}\n{file}");
}

/// Tries a property on runs of these plans.
#[track_caller]
pub(crate) fn check(
    promise: &str,
    cases: u32,
    plans: impl Strategy<Value = Plan>,
    property: impl Fn(&Script) -> Verdict,
) {
    if let Some((script, why)) = broken(config(cases), plans, property) {
        fail(promise, &why, "", &script);
    }
}

/// Tries a property on what has a run in it.
#[track_caller]
pub(crate) fn check_of<T: std::fmt::Debug>(
    promise: &str,
    cases: u32,
    values: impl Strategy<Value = T>,
    script: impl Fn(&T) -> Script,
    property: impl Fn(&T) -> Verdict,
) {
    if let Some((value, why)) = falsified(config(cases), values, property) {
        fail(promise, &why, &format!("{value:?}"), &script(&value));
    }
}

/// Has an oracle judge runs of these plans, and makes sure that in one of four there is something to judge.
#[track_caller]
pub(crate) fn judge(promise: &str, cases: u32, plans: impl Strategy<Value = Plan>, oracle: Oracle) {
    let (tried, held) = (Cell::new(0u32), Cell::new(0u32));
    check(&format!("{promise}-{oracle}"), cases, plans, |script| {
        let verdict = script.judge(oracle).map_err(|violation| violation.to_string())?;
        tried.set(tried.get() + 1);
        held.set(held.get() + u32::from(verdict == oracle::Verdict::Held));
        Ok(())
    });
    println!("{promise}: {oracle} judged {} of {}", held.get(), tried.get());
    assert!(4 * held.get() >= tried.get(), "{oracle} had something to judge in {held:?} of {tried:?} runs");
}
