//! Impulses of contacts in dumps: a tampered one is named by tick, stage, contact, point and value.

use alloc::string::{String, ToString as _};
use alloc::vec::Vec;

use crate::body::BodyDef;
use crate::fx::fx;
use crate::integrate::StageKind;
use crate::math::vec2;
use crate::replay::{Dump, HashTree, Owner, TickPhase};
use crate::shape::Shape;
use crate::slots::ColliderId;
use crate::world::{Inputs, World, WorldDef};

/// A crate on the ground, after some ticks.
fn resting() -> World {
    let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() }).expect("a world");
    let shape = |width, height| Shape::rectangle(width, height).expect("a rectangle");
    world.add_body(BodyDef::fixed().with_collider(shape(fx!(20), fx!(2)))).expect("the ground");
    let brick = BodyDef::dynamic().with_collider(shape(fx!(1), fx!(1)));
    world.add_body(BodyDef { position: vec2(0, fx!(1.5)), ..brick }).expect("a crate");
    (0..9).for_each(|_| _ = world.step());
    world
}

#[test]
fn a_tampered_impulse_is_named_by_tick_stage_contact_point_and_value() {
    let before = resting();
    let mut after = before.clone();
    after.step();
    let dump = Dump::of_tick(&before, &[], &Inputs::new(), &after);
    let contact = Owner::Contact(ColliderId::from_parts(0, 0), ColliderId::from_parts(1, 0));
    let phases: Vec<TickPhase> = dump.phases().map(|(phase, _)| phase).collect();
    let (mut named, mut stages) = (0, Vec::new());
    for (at, phase) in phases.into_iter().enumerate() {
        let tampered = dump.with_world(at, |world| world.contacts.records[0].impulses[1] += 1);
        let difference = dump.first_difference(&tampered).expect("they differ");
        assert_eq!((difference.tick, difference.phase, difference.owner), (9, phase, contact), "{difference}");
        assert_eq!(difference.field, "points[1].normal_impulse");
        let [left, right] =
            [&difference.left, &difference.right].map(|value| value.as_deref().and_then(|v| v.parse::<i64>().ok()));
        assert_eq!(left.map(|value| value + 1), right, "{difference}");
        stages.extend(match phase {
            TickPhase::Stage { kind, .. } => Some(kind),
            _ => None,
        });
        named += 1;
    }
    assert_eq!(stages[stages.len() - 4..], [StageKind::Detect, StageKind::Solve, StageKind::Push, StageKind::Clear]);
    assert_eq!(named, 4 + stages.len());
    let bytes = dump.to_bytes();
    assert_eq!(Dump::from_bytes(&bytes, &[]).expect("its own bytes").to_bytes(), bytes);
}

/// Each stage writes the values that its kind says.
#[test]
fn the_stages_of_contacts_write_impulses_and_then_motion() {
    let mut world = resting();
    let before = world.clone();
    let trace = world.step_traced();
    let impulses = |world: &World| world.contacts.records.clone();
    let place = |world: &World| world.bodies().map(|body| body.position_exact()).collect::<Vec<_>>();
    let stages: Vec<(StageKind, &World)> = trace.stages().map(|(stage, world)| (stage.kind, world)).collect();
    let after = |kind| stages.iter().rfind(|(stage_kind, _)| *stage_kind == kind).expect("a stage").1;
    let [flown, detected, solved, pushed] =
        [StageKind::Damp, StageKind::Detect, StageKind::Solve, StageKind::Push].map(after);
    assert_eq!((impulses(flown), place(flown)), (impulses(&before), place(detected)));
    assert!(impulses(detected) != impulses(solved) && place(detected) == place(solved));
    assert!(impulses(solved) == impulses(pushed) && place(solved) != place(pushed));
    assert_eq!((impulses(pushed), place(pushed)), (impulses(&world), place(&world)));
    // A traced step has the bits of another one.
    let mut plain = before;
    plain.step();
    assert_eq!(plain.state_hash(), world.state_hash());
    let names: Vec<String> = HashTree::of_step(&trace, &world).parts.iter().map(|part| part.name.to_string()).collect();
    assert!(names.iter().any(|name| name.contains("solve")), "{names:?}");
}
