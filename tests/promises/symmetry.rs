//! P6: fair. A run that is mirrored, turned by a quarter or shifted is the image of the run, and bodies of any mass fall alike.

use proptest::collection::vec;
use proptest::prelude::*;
use umbra_physics::oracle::{Oracle, Script};
use umbra_physics::{Activity, BodyDef, Command, End, Field, Law, Mass, World, WorldDef, fx, limits};

use crate::check::{Verdict, check_of, judge, there_is};
use crate::plan::{FAIR, Taste};

const TASTE: Taste = Taste { near: 1, unfair: 0, ..FAIR };

#[test]
fn a_mirrored_run_is_the_mirror_image() {
    judge("fair", 500, TASTE.plan(), Oracle::Mirror);
}

#[test]
fn a_turned_run_is_the_run_turned() {
    judge("fair", 500, TASTE.plan(), Oracle::Turn);
}

#[test]
fn a_shifted_run_is_the_run_shifted() {
    judge("fair", 500, TASTE.plan(), Oracle::Shift);
}

/// Two bodies at one place, of different masses, under what pulls all masses alike.
#[derive(Clone, Debug)]
struct Pair {
    world: WorldDef,
    body: BodyDef,
    masses: [Mass; 2],
    fields: Vec<Field>,
}

impl Pair {
    fn script(&self) -> Script {
        let bodies = self.masses.map(|mass| Command::AddBody(BodyDef { mass, ..self.body.clone() }));
        let fields = self.fields.iter().copied().map(Command::AddField);
        let commands = bodies.into_iter().chain(fields).map(|command| (0, command)).collect();
        Script { world: self.world, commands, ticks: 60 }
    }

    fn falls_alike(&self) -> Verdict {
        let script = self.script();
        let mut world = script.start().map_err(|error| error.to_string())?;
        for tick in 0..script.ticks {
            script.advance(&mut world, &mut ());
            let ways = |world: &World| -> Vec<_> {
                let way = |body: umbra_physics::BodyRef<'_>| {
                    (body.position_exact(), body.velocity_exact(), body.activity() == Activity::Quarantined)
                };
                world.bodies().map(way).collect()
            };
            match ways(&world)[..] {
                // A damping of 0 does not go with every integrator: then neither is there.
                [] => return Ok(()),
                [a, b] if a == b => {}
                ref ways => return Err(format!("at tick {tick} they have come apart: {ways:?}")),
            }
        }
        Ok(())
    }
}

fn pairs(pulls_alike: bool) -> impl Strategy<Value = Pair> {
    let near = Taste { near: 2, ..FAIR };
    let is_alike = move |law: &Law| match law {
        Law::Attractor { centre: End::World(_), .. } | Law::Zone { .. } => true,
        Law::Drag { .. } => !pulls_alike,
        _ => false,
    };
    let law = near.law().prop_filter("it pulls masses as they are heavy", is_alike);
    let mass = || {
        prop_oneof![
            near.number(fx!(0.125), fx!(9), limits::MASS_MIN, limits::MASS_MAX).prop_map(Mass::Of),
            prop::sample::select(vec![Mass::Of(limits::MASS_MIN), Mass::Of(limits::MASS_MAX)]),
        ]
    };
    let fields = vec(law.prop_map(Field::from), usize::from(!pulls_alike)..3);
    (near.world(), near.body(), mass(), mass(), fields).prop_map(|(world, body, a, b, fields)| {
        let body = BodyDef { kind: umbra_physics::BodyKind::Dynamic, ..body };
        Pair { world, body, masses: [a, b], fields }
    })
}

#[test]
fn bodies_of_any_mass_fall_alike() {
    check_of("fair-masses", 600, pairs(true), Pair::script, Pair::falls_alike);
    // Drag does not pull alike.
    assert!(there_is(pairs(false), |pair| pair.falls_alike().is_err()));
}
