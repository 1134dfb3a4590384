//! P8: a scene pays for what it uses. `tests/costs.rs` counts instructions; here runs that are made up show what a step goes
//! through, what a look ahead takes along, and that going over ticks again takes nothing from the heap.

use std::collections::BTreeSet;

use allocation_counter::measure;
use umbra_oracles::{Oracle, Script};
use umbra_physics::{Activity, BodyId, BodyKind, End, FieldKind, ForceField, World};

use crate::promises::check::{Verdict, check, judge, there_is};
use crate::promises::plan::{FAIR, Plan, Taste};

fn end(script: &Script) -> Result<World, String> {
    script.run().map_err(|error| error.to_string())
}

/// A step goes through the bodies that may move, and no other.
fn moves_those_alone_who_may_move(script: &Script) -> Verdict {
    let mut world = script.start().map_err(|error| error.to_string())?;
    for tick in 0..script.ticks {
        script.advance(&mut world, &mut ());
        let may_move =
            |body: &umbra_physics::BodyRef<'_>| body.kind() != BodyKind::Static && body.activity() == Activity::Awake;
        let count = world.bodies().filter(may_move).count();
        if world.moving_count() != count {
            return Err(format!("at tick {tick} a step goes through {} bodies, not {count}", world.moving_count()));
        }
    }
    Ok(())
}

/// The bodies whose fields reach a body, by way of others or not: what there is to ask about its future, and no more.
fn reaching(world: &World, body: BodyId) -> BTreeSet<BodyId> {
    let mut reaching = BTreeSet::from([body]);
    let is_acted_on =
        |field: &ForceField, id: BodyId| world.body(id).is_ok_and(|body| body.force_groups() & field.force_groups != 0);
    loop {
        let mut more = reaching.clone();
        for (_, field) in world.fields() {
            match field.kind {
                FieldKind::Spring { near: start, far: End::Body(end), .. } => {
                    for (first, second) in [(start.body, end.body), (end.body, start.body)] {
                        // A static body hands nothing on, but who hangs on it asks where it is.
                        let hands_on = world.body(first).is_ok_and(|body| body.kind() != BodyKind::Static);
                        if reaching.contains(&first) && hands_on {
                            more.insert(second);
                        }
                    }
                }
                FieldKind::Attractor { centre: End::Body(at), .. }
                    if reaching.iter().any(|&member| is_acted_on(field, member)) =>
                {
                    more.insert(at.body);
                }
                _ => {}
            }
        }
        if more == reaching {
            return reaching;
        }
        reaching = more;
    }
}

/// A look ahead takes along who reaches the body and nobody else, and is its future.
fn looks_ahead_with_few(script: &Script) -> Verdict {
    let world = end(script)?;
    // A look ahead shows the free flight.
    if world.collider_count() > 0 || world.joint_count() > 0 {
        return Ok(());
    }
    for body in world.bodies().map(|body| body.id()) {
        let mut ahead = world.preview(body).map_err(|error| error.to_string())?;
        let (taken, least) = (ahead.world().body_count(), reaching(&world, body).len());
        if taken > least {
            return Err(format!("a look ahead with {body} takes {taken} bodies along, not {least}"));
        }
        let mut world = world.clone();
        for tick in 0..20 {
            ahead.step();
            world.step();
            let (actual, expected) =
                (ahead.body().map_err(|error| error.to_string())?, world.body(body).expect("it stays"));
            let bits = |body: &umbra_physics::BodyRef<'_>| {
                (body.position_exact(), body.velocity_exact(), body.angle_exact(), body.angular_velocity_exact())
            };
            if bits(&actual) != bits(&expected) {
                return Err(format!("{body} does not move as its preview, {tick} ticks on"));
            }
        }
    }
    Ok(())
}

/// Ticks that were gone through once take nothing from the heap when they are gone through again.
fn takes_nothing_the_second_time(script: &Script) -> Verdict {
    let mut world = end(script)?;
    let start = world.clone();
    let ticks = |world: &mut World| (0..30).for_each(|_| _ = world.step());
    ticks(&mut world);
    let again = measure(|| {
        world.clone_from(&start);
        ticks(&mut world);
    });
    if again.count_total == 0 { Ok(()) } else { Err(format!("{} times something was taken", again.count_total)) }
}

const NEAR: Taste = Taste { near: 3, ..FAIR };

/// Leaving out parts of a step, or taking several bodies through it at once, changes nothing.
#[test]
fn no_short_cut_changes_a_bit() {
    judge("pays", 40, NEAR.plan(), Oracle::Paths);
}

#[test]
fn a_step_goes_through_the_bodies_that_may_move() {
    check("pays-moving", 50, NEAR.plan(), moves_those_alone_who_may_move);
}

#[test]
fn a_look_ahead_takes_along_what_it_depends_on() {
    check("pays-preview", 50, NEAR.plan(), looks_ahead_with_few);
}

#[test]
fn ticks_gone_over_again_take_nothing_from_the_heap() {
    check("pays-heap", 50, NEAR.plan(), takes_nothing_the_second_time);
    // What the first time takes is seen.
    let first = |plan: &Plan| {
        let world = plan.script().run().expect("a fair world");
        let taken = measure(|| _ = world.clone().step());
        taken.count_total > 0
    };
    assert!(there_is(NEAR.plan(), first));
}
