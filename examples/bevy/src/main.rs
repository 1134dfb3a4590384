//! A match of two ships, with entities that follow the bodies of a world. One player's buttons arrive five ticks late and are
//! guessed until then. Corrections roll the world back: entities of wrongly guessed shots disappear, all others keep their
//! identity.
//!
//! ```sh
//! cargo run --release            # in this folder
//! ```
//!
//! The world is the match. One system writes to it, `advance`; all others read. So it does not matter
//! in which order the ECS visits its entities, or on how many threads.

mod game;

use std::collections::{BTreeMap, VecDeque};
use std::error::Error;
use std::mem;

use bevy_ecs::prelude::{Commands, Component, DetectChangesMut as _, Entity, Query, Res, ResMut, Resource, Schedule};
use umbra_physics::{Blend, BodyId, Interpolation, Pose, StepClock, TickFraction, World};

use game::{Held, Match, SHOT_TICKS, fired_at, pressed};

/// Number of ticks that player 1 is away.
const LATE: u64 = 5;
/// Number of ticks the match can go back by.
const WINDOW: usize = 8;
const TICKS: u64 = 300;
/// Duration of a display frame, ns: 144 Hz, while ticks are 60 Hz.
const FRAME: u64 = 6_944_444;

/// The match; its last ticks with the world before each and the buttons, real or guessed; and the poses between two ticks.
#[derive(Resource)]
struct Physics {
    game: Match,
    world: World,
    past: VecDeque<(World, [Held; 2])>,
    shown: Interpolation,
}

/// The moment of this frame, from the remainder of the step clock.
#[derive(Resource)]
struct Moment(Blend);

/// Buttons from the network, with their tick and player.
#[derive(Resource, Default)]
struct Arrived(Vec<(u64, usize, Held)>);

/// The entity of each body, by the body's key, which stays the same through a rollback, unlike the handle.
#[derive(Resource, Default)]
struct Entities(BTreeMap<u64, Entity>);

/// The body of an entity.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
struct Body(BodyId);

/// Pose to draw the body at. Floats come out of the world, and never go in.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
struct Place(Pose<f32>);

/// Applies late inputs, then makes a tick.
fn advance(mut physics: ResMut<Physics>, mut arrived: ResMut<Arrived>) {
    let Physics { game, world, past, shown } = &mut *physics;
    let present = world.tick();
    // Unknown buttons are guessed: a player continues as in the tick before.
    let mut held = past.back().map_or_else(Default::default, |(_, held)| *held);
    let mut first = present;
    for (tick, player, buttons) in arrived.0.drain(..) {
        held[player] = buttons;
        for (before, guess) in past.iter_mut().filter(|(before, _)| before.tick() >= tick) {
            if mem::replace(&mut guess[player], buttons) != buttons {
                first = first.min(before.tick());
            }
        }
    }
    if let Some((before, _)) = past.iter().find(|(before, _)| before.tick() == first) {
        world.clone_from(before);
        for (before, held) in past.iter_mut().filter(|(before, _)| before.tick() >= first) {
            before.clone_from(world);
            game.tick(world, *held);
            shown.look(world);
        }
    }
    // Reuse the memory of the oldest tick.
    let mut row = if past.len() == WINDOW { past.pop_front() } else { None };
    match &mut row {
        Some((before, _)) => before.clone_from(world),
        None => row = Some((world.clone(), held)),
    }
    past.extend(row.map(|(before, _)| (before, held)));
    game.tick(world, held);
    shown.look(world);
}

/// Keeps one entity for each body, at its pose at the moment of the frame: after a step, after many, after a
/// rollback.
fn follow(
    mut commands: Commands,
    physics: Res<Physics>,
    moment: Res<Moment>,
    mut entities: ResMut<Entities>,
    mut looks: Query<(&mut Body, &mut Place)>,
) {
    let mut gone = mem::take(&mut entities.0);
    for look in physics.world.bodies() {
        let pose = physics.shown.pose(look.id(), moment.0).unwrap_or_else(|| Pose::of(&look));
        let (body, place) = (Body(look.id()), Place(pose.to_f32()));
        let entity = match gone.remove(&look.key()) {
            Some(entity) => {
                if let Ok((mut old_body, mut old_place)) = looks.get_mut(entity) {
                    // Systems that ask for `Changed<Place>` see what moved, and nothing else.
                    old_body.set_if_neq(body);
                    old_place.set_if_neq(place);
                }
                entity
            }
            None => commands.spawn((body, place)).id(),
        };
        let twin = entities.0.insert(look.key(), entity);
        assert_eq!(twin, None, "two bodies have the key {}", look.key());
    }
    gone.into_values().for_each(|entity| commands.entity(entity).despawn());
}

fn main() -> Result<(), Box<dyn Error>> {
    let (game, world) = Match::start()?;
    let (start, mut ecs) = (world.clone(), bevy_ecs::world::World::new());
    let mut step_clock = StepClock::new(world.def().time_step)?;
    let mut shown = Interpolation::new();
    shown.look(&world);
    ecs.insert_resource(Physics { game, world, past: VecDeque::new(), shown });
    ecs.init_resource::<Arrived>();
    ecs.init_resource::<Entities>();
    let (mut ticks, mut frames) = (Schedule::default(), Schedule::default());
    ticks.add_systems(advance);
    frames.add_systems(follow);

    let (mut tick, mut last, mut guessed) = (0, BTreeMap::new(), 0);
    // At the end nobody presses anything, until all inputs have arrived.
    while tick < TICKS + LATE {
        // At most one: a frame is shorter than a tick.
        let due = step_clock.frame(FRAME).ticks;
        for _ in 0..due {
            let mut arrived = ecs.resource_mut::<Arrived>();
            arrived.0.push((tick, 0, buttons(0, tick)));
            if tick >= LATE {
                arrived.0.push((tick - LATE, 1, buttons(1, tick - LATE)));
            }
            ticks.run(&mut ecs);
            tick += 1;
        }
        ecs.insert_resource(Moment(Blend::Interpolated(step_clock.remainder())));
        frames.run(&mut ecs);
        check(&mut ecs)?;
        let entities = ecs.resource::<Entities>().0.clone();
        for (key, entity) in mem::replace(&mut last, entities) {
            match last.get(&key) {
                Some(&now) => assert_eq!(entity, now, "a body stays the entity it is"),
                None => guessed += usize::from(fired_at(key).is_some_and(|fired| tick <= fired + SHOT_TICKS)),
            }
        }
        if due > 0 && tick % 60 == 0 {
            show(&ecs, tick);
        }
    }

    // The same match with all inputs in time, and without an ECS.
    let mut straight = start;
    for tick in 0..TICKS + LATE {
        game.tick(&mut straight, [buttons(0, tick), buttons(1, tick)]);
    }
    let hash = ecs.resource::<Physics>().world.state_hash();
    assert_eq!(hash, straight.state_hash(), "what came late has left no trace");
    assert!(guessed > 0, "guesses went wrong");
    println!("{guessed} shots were guessed and never were; state hash {hash:016x}, as if nothing had come late");
    Ok(())
}

fn buttons(player: usize, tick: u64) -> Held {
    if tick < TICKS { pressed(player, tick) } else { Held::default() }
}

/// Returns true if the entities match the bodies: as many, each shown on its body's way.
fn check(ecs: &mut bevy_ecs::world::World) -> Result<(), Box<dyn Error>> {
    let entities: Vec<(Body, Place)> = ecs.query::<(&Body, &Place)>().iter(ecs).map(|(b, p)| (*b, *p)).collect();
    let (Physics { world, shown, .. }, Moment(at)) = (ecs.resource::<Physics>(), ecs.resource::<Moment>());
    assert_eq!(entities.len(), world.body_count());
    for (Body(body), Place(pose)) in entities {
        assert_eq!(Some(pose), shown.pose(body, *at).map(Pose::to_f32));
        let end = Blend::Interpolated(TickFraction::ONE);
        assert_eq!(shown.pose(body, end), Some(Pose::of(&world.body(body)?)));
    }
    Ok(())
}

fn show(ecs: &bevy_ecs::world::World, tick: u64) {
    println!("tick {tick}");
    for (key, &entity) in &ecs.resource::<Entities>().0 {
        if let Some(Place(Pose { position: [x, y], angle })) = ecs.get::<Place>(entity) {
            println!("  key {key:>6} is entity {entity}: ({x:.2}, {y:.2}) m, {angle:.2} rad");
        }
    }
}
