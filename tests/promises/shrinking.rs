//! The tests of these tests: what is false is found, shrunk to little, and left as a scene that breaks it as well.

use std::cell::Cell;

use umbra_oracles::Script;
use umbra_physics::{Activity, FieldKind, Fx, World, fx};
use umbra_scene::Scene;

use crate::promises::check::{Verdict, broken, until_found, written};
use crate::promises::plan::{FAIR, Taste};

/// The world of a script, seen after each tick.
fn seen(script: &Script, mut see: impl FnMut(&World) -> Verdict) -> Verdict {
    let mut world = World::new(script.world).map_err(|error| error.to_string())?;
    for _ in 0..script.ticks {
        script.advance(&mut world, &mut ());
        see(&world)?;
    }
    Ok(())
}

fn nobody_is_pulled(world: &World) -> Verdict {
    let is_spring = |law: &FieldKind| matches!(law, FieldKind::Spring { .. });
    if world.fields().any(|(_, field)| is_spring(&field.kind)) && world.bodies().any(|body| body.velocity().x > fx!(1))
    {
        return Err("somebody is pulled".to_owned());
    }
    Ok(())
}

fn nobody_leaves(world: &World) -> Verdict {
    let quarantined = world.bodies().find(|body| body.activity() == Activity::Quarantined);
    quarantined.map_or(Ok(()), |body| Err(format!("{} left", body.id())))
}

fn breaks_as_a_file(name: &str, taste: Taste, property: fn(&World) -> Verdict) {
    let (script, why) = broken(until_found(), taste.plan(), |script| seen(script, property)).expect("it is false");
    let file = written(name, &why, &script).expect("it can be said");
    let text = std::fs::read_to_string(&file).expect("it was written");
    let scene = Scene::parse(&text).unwrap_or_else(|error| panic!("{}:{error}", file.display()));
    // Of some 25 things that a plan has.
    assert!(scene.bodies.len() + scene.fields.len() + scene.inputs.len() <= 6, "{text}");
    let mut run = scene.start::<Fx>().expect("it starts");
    let mut verdict = Ok(());
    for _ in 0..scene.ticks {
        run.advance().expect("it goes on");
        verdict = verdict.and(property(run.world()));
    }
    assert_eq!(verdict, Err(why), "{text}");
    std::fs::remove_file(file).expect("it is there");
}

#[test]
fn a_false_property_leaves_a_small_scene_that_breaks_it() {
    breaks_as_a_file("springs", FAIR, nobody_is_pulled);
    let taste = Taste { near: 10, ..FAIR };
    breaks_as_a_file("quarantine", taste, nobody_leaves);
}

#[test]
fn a_property_that_fails_once_and_then_holds_is_false() {
    let is_first = Cell::new(true);
    let once = |_: &Script| if is_first.replace(false) { Err("once".to_owned()) } else { Ok(()) };
    let (_, why) = broken(until_found(), FAIR.plan(), once).expect("the first plan breaks it");
    assert_eq!(why, "once");
}

#[test]
fn a_panic_is_what_is_found_and_shrunk_like_any_other() {
    let panics = |script: &Script| {
        assert!(script.run().expect("a fair world").body_count() < 3, "three or more");
        Ok(())
    };
    let (script, why) = broken(until_found(), FAIR.plan(), panics).expect("some have three");
    assert_eq!((script.commands.len(), script.ticks), (3, 1));
    assert_eq!(why, "a panic: three or more");
}
