//! Worlds and commands by which a kilobyte of commands might cost more than it should: each named after what it does over
//! and over.

use std::f64::consts::TAU;

use umbra_physics::{
    ApplyOptions, Attachment, BodyDef, BodyId, BodyKind, ColliderDef, ColliderId, Command, Damping, Dump, End,
    Explosion, FieldKind, ForceField, ForceOrImpulse, Fx, Input, Inputs, Integrator, Part, RecordOptions, Recorder,
    Region, Replay, ReplayLimits, Shape, Snapshot, SpringConstants, TimeStep, World, WorldDef, fx, vec2,
};
use umbra_scene::Scene;

/// A world with so many bodies, and commands to repeat.
pub(crate) struct Hostile {
    pub(crate) name: &'static str,
    /// True if the commands must cost the same however many bodies there are.
    pub(crate) is_constant: bool,
    pub(crate) make: fn(usize) -> (World, Vec<Command>),
}

macro_rules! hostile {
    ($($name:ident $is_constant:literal),* $(,)?) => {
        &[$(Hostile { name: stringify!($name), is_constant: $is_constant, make: $name }),*]
    };
}

impl Hostile {
    pub(crate) const ALL: &'static [Self] = hostile![
        integrators true,
        published true,
        time_steps true,
        gravities true,
        dampings true,
        sleep_after false,
        own_dampings true,
        bodies_come_and_go true,
        removals_beside_inert_fields true,
        fields_removed true,
        anchors false,
        pairs_woken true,
        groups_woken false,
        disabled_when_woken false,
        goals true,
        pushes true,
        colliders_removed true,
        colliders_set true,
        colliders_of_a_compound_body true,
        kinds_of_a_map true,
        explosions_beside_a_map true,
        maps_moved false,
    ];
}

/// Calls whose cost has to be in proportion to how many things they name, but for a logarithm: made for so many.
pub(crate) struct Growing {
    pub(crate) name: &'static str,
    pub(crate) make: fn(usize) -> Box<dyn FnOnce()>,
}

impl Growing {
    pub(crate) const ALL: &'static [Self] = &[
        Self { name: "inputs_in_falling_sequence", make: |n| inserted((0..n as u32).rev()) },
        Self { name: "inputs_in_no_order", make: |n| inserted((0..n as u32).map(u32::reverse_bits)) },
        Self { name: "inputs_replaced_in_front", make: replaced_in_front },
        Self {
            name: "all_pairs_woken",
            make: |n| all(pairs_asleep(n).0, |ids| ids.iter().step_by(2).map(|&b| wake(b))),
        },
        Self { name: "a_chain_woken", make: |n| all(asleep(chain(n)), |ids| ids[..1].iter().map(|&b| wake(b))) },
        Self { name: "all_bodies_of_a_chain_removed", make: |n| all(chain(n), |ids| ids.iter().map(|&b| remove(b))) },
        Self { name: "all_woken_disabled", make: all_woken_disabled },
        Self { name: "all_fields_removed", make: all_fields_removed },
        Self { name: "a_hub_removed", make: hub_removed },
        Self { name: "a_snapshot_read", make: |n| snapshot_read(&chain(n)) },
        Self { name: "corners_read_and_set", make: corners_read_and_set },
        Self { name: "a_dump_read", make: dump_read },
        Self { name: "a_replay_of_one_tick_verified", make: replay_verified },
        Self { name: "a_scene_read", make: scene_read },
        Self { name: "a_scene_moved_on", make: scene_moved_on },
        Self { name: "colliders_added_to_a_body", make: colliders_added },
        Self { name: "colliders_of_a_body_set", make: |n| colliders_of_a_map(n, set) },
        Self { name: "colliders_of_a_body_removed", make: |n| colliders_of_a_map(n, Command::RemoveCollider) },
        Self { name: "colliders_added_to_a_body_that_moves", make: colliders_added_to_a_dynamic_body },
        Self { name: "a_map_moved", make: map_moved },
        Self { name: "a_map_with_contacts_removed", make: map_with_contacts_removed },
        Self { name: "tiles_on_each_other", make: tiles_on_each_other },
    ];
}

fn wake(body: BodyId) -> Command {
    Command::Wake(body)
}

fn remove(body: BodyId) -> Command {
    Command::RemoveBody(body)
}

fn inserted(sequences: impl Iterator<Item = u32> + 'static) -> Box<dyn FnOnce()> {
    let commands: Vec<Input> =
        sequences.map(|sequence| Input { player: 0, sequence, command: Command::ClearForces }).collect();
    Box::new(move || {
        let mut inputs = Inputs::new();
        commands.into_iter().for_each(|input| inputs.insert(input).expect("each has a place of its own"));
        std::hint::black_box(&inputs);
    })
}

fn replaced_in_front(count: usize) -> Box<dyn FnOnce()> {
    let mut inputs = Inputs::new();
    inputs.replace(1, std::iter::repeat_n(Command::ClearForces, count));
    Box::new(move || {
        inputs.replace(0, std::iter::repeat_n(Command::ClearForces, count));
        std::hint::black_box(&inputs);
    })
}

/// Carries out all commands for the bodies of a world.
fn all<I: Iterator<Item = Command>>(
    mut world: World,
    commands: impl FnOnce(&'static [BodyId]) -> I,
) -> Box<dyn FnOnce()> {
    let bodies: Vec<BodyId> = world.bodies().map(|body| body.id()).collect();
    let commands: Vec<Command> = commands(bodies.leak()).collect();
    Box::new(move || commands.iter().for_each(|command| _ = world.execute(command).expect("it may be done")))
}

fn pairs_asleep(count: usize) -> (World, Vec<BodyId>) {
    let (mut world, bodies) = unlike_world(count);
    for pair in bodies.chunks_exact(2) {
        world.add_field(spring(pair[0], pair[1])).expect("a spring");
    }
    (asleep(world), bodies)
}

fn chain(count: usize) -> World {
    let (mut world, bodies) = unlike_world(count);
    for pair in bodies.windows(2) {
        world.add_field(spring(pair[0], pair[1])).expect("a spring");
    }
    world
}

fn all_woken_disabled(count: usize) -> Box<dyn FnOnce()> {
    let mut world = asleep(unlike_world(count).0);
    world.set_gravity(vec2(1, 0)).expect("a gravity");
    all(world, |ids| ids.iter().map(|&body| Command::Disable(body)))
}

fn all_fields_removed(count: usize) -> Box<dyn FnOnce()> {
    let mut world = chain(count);
    let fields: Vec<_> = world.fields().map(|(id, _)| id).collect();
    Box::new(move || fields.into_iter().for_each(|id| world.remove_field(id).expect("it is there")))
}

/// A body that all others hang on.
fn hub_removed(count: usize) -> Box<dyn FnOnce()> {
    let (mut world, bodies) = unlike_world(count);
    let hub = world.add_body(BodyDef::fixed()).expect("a body");
    bodies.iter().for_each(|&body| _ = world.add_field(spring(body, hub)).expect("a spring"));
    Box::new(move || world.remove_body(hub).expect("it is there"))
}

fn snapshot_read(world: &World) -> Box<dyn FnOnce()> {
    let bytes = world.snapshot().to_bytes();
    Box::new(move || _ = std::hint::black_box(Snapshot::from_bytes(&bytes, &[]).expect("its own bytes")))
}

/// A dump of half as many bodies: the world stands in it at least twice, as one call changes it.
fn dump_read(count: usize) -> Box<dyn FnOnce()> {
    let before = chain(count / 2);
    let mut after = before.clone();
    let calls = [Command::SetGravity(vec2(0, 0))];
    after.execute(&calls[0]).expect("a gravity");
    after.step();
    let bytes = Dump::of_tick(&before, &calls, &Inputs::new(), &after).to_bytes();
    Box::new(move || _ = std::hint::black_box(Dump::from_bytes(&bytes, &[]).expect("its own bytes")))
}

/// Reads and carries out a command with so many corners, or as many as a shape can have.
fn corners_read_and_set(count: usize) -> Box<dyn FnOnce()> {
    let (mut world, bodies) = unlike_world(1);
    let parts = vec![Part { shape: polygon(), position: vec2(0, 0), angle: fx!(0), density: fx!(1) }; count / 64];
    let def = ColliderDef::ghost(Shape::compound(&parts).expect("a compound"));
    let bytes = Command::AddCollider { body: bodies[0], def }.to_bytes();
    Box::new(move || {
        let command: Command = Command::from_bytes(&bytes).expect("its own bytes");
        world.execute(&command).expect("it is there");
        world.step();
    })
}

/// One command that changes the factors of all bodies for each body.
fn replay_verified(count: usize) -> Box<dyn FnOnce()> {
    let (mut world, commands) = integrators(count);
    let mut recorder = Recorder::new(&world, RecordOptions::default());
    let mut inputs = Inputs::new();
    inputs.replace(0, commands.into_iter().cycle().take(count));
    recorder.step(&mut world, &inputs);
    let bytes = recorder.finish(&world);
    let limits = ReplayLimits {
        ticks: 1,
        bodies: count as u32,
        fields: 0,
        colliders: u32::MAX,
        pairs: u32::MAX,
        commands: count as u64,
    };
    Box::new(move || {
        let replay = Replay::from_bytes(&bytes, &[]).expect("its own bytes");
        replay.verify_within(limits).expect("it is as recorded");
    })
}

/// A few hundred bytes for many bodies, each with a damping of its own, and as many commands, each of which changes the factors of all.
fn scene(count: usize) -> String {
    format!(
        r#"{{"bodies": [{{"name": "b{{n}}", "damping": {{"linear": {{"kept_per_second": {{"start": 0.5, "i": 0.00001}}}}}}, "repeat": {{"i": {count}}}}}],
            "inputs": [{{"at": 0, "set": {{"gravity": [0, {{"start": -10, "i": 0.00001}}]}}, "repeat": {{"i": {count}}}}}]}}"#
    )
}

fn scene_read(count: usize) -> Box<dyn FnOnce()> {
    // Its inputs stand at a tick that is never reached.
    let text = scene(count).replace(r#""at": 0"#, r#""at": 1000000"#);
    Box::new(move || _ = std::hint::black_box(Scene::parse(&text).expect("a scene")))
}

fn scene_moved_on(count: usize) -> Box<dyn FnOnce()> {
    let scene: &'static Scene = Box::leak(Box::new(Scene::parse(&scene(count)).expect("a scene")));
    let mut run = scene.start::<Fx>().expect("a scene");
    Box::new(move || _ = run.advance().expect("a tick"))
}

fn world() -> World {
    World::new(WorldDef { gravity: vec2(0, -10), sleep_after: Some(30), ..WorldDef::default() }).expect("a world")
}

/// Each with a damping of its own, and without gravity, so that it may rest.
fn unlike(world: &mut World, count: usize) -> Vec<BodyId> {
    let def = |i: usize| BodyDef {
        position: vec2((i % 100) as i32 * 4, (i / 100) as i32 * 4),
        gravity_scale: fx!(0),
        linear_damping: Some(Damping::kept_per_second(Fx::from_bits(Fx::HALF.to_bits() + i as i64))),
        ..BodyDef::dynamic()
    };
    (0..count).map(|i| world.add_body(def(i)).expect("a body")).collect()
}

fn unlike_world(count: usize) -> (World, Vec<BodyId>) {
    let mut world = world();
    let bodies = unlike(&mut world, count);
    (world, bodies)
}

fn asleep(mut world: World) -> World {
    (0..32).for_each(|_| _ = world.step());
    assert_eq!(world.moving_count(), 0, "they are not asleep");
    world
}

fn spring(start: BodyId, end: BodyId) -> FieldKind {
    let spring = SpringConstants { rest: fx!(4), stiffness: fx!(0), damping: fx!(0) };
    FieldKind::Spring { near: Attachment::centre(start), far: End::Body(Attachment::centre(end)), spring }
}

fn integrators(count: usize) -> (World, Vec<Command>) {
    let integrators = [Integrator::SymplecticEuler, Integrator::VelocityVerlet];
    (unlike_world(count).0, integrators.map(Command::SetIntegrator).into())
}

fn published(count: usize) -> (World, Vec<Command>) {
    let integrators = [Integrator::PublishedVerlet, Integrator::VelocityVerlet];
    (unlike_world(count).0, integrators.map(Command::SetIntegrator).into())
}

fn time_steps(count: usize) -> (World, Vec<Command>) {
    let steps = [TimeStep::ratio(1001, 60_000), TimeStep::hz(60)];
    (unlike_world(count).0, steps.map(Command::SetTimeStep).into())
}

fn gravities(count: usize) -> (World, Vec<Command>) {
    (unlike_world(count).0, [9, 10].map(|g| Command::SetGravity(vec2(0, -g))).into())
}

fn dampings(count: usize) -> (World, Vec<Command>) {
    let dampings = [fx!(0.5), fx!(1)].map(Damping::kept_per_second);
    (unlike_world(count).0, dampings.map(|both| Command::SetDamping { linear: both, angular: both }).into())
}

fn sleep_after(count: usize) -> (World, Vec<Command>) {
    (unlike_world(count).0, [30, 31].map(|ticks| Command::SetSleepAfter(Some(ticks))).into())
}

fn own_dampings(count: usize) -> (World, Vec<Command>) {
    let (world, bodies) = unlike_world(count);
    let damping = |i: i64| Some(Damping::kept_per_second(Fx::from_bits(Fx::HALF.to_bits() / 2 + i)));
    let set = |(i, &body): (usize, &BodyId)| {
        let i = i as i64;
        Command::SetBodyDamping { body, linear: damping(2 * i), angular: damping(2 * i + 1) }
    };
    (world, bodies.iter().enumerate().take(100).map(set).collect())
}

fn bodies_come_and_go(count: usize) -> (World, Vec<Command>) {
    let (world, bodies) = unlike_world(count);
    // The first free slot, time and again.
    let pairs = (0..100).flat_map(|i| {
        let damping = Some(Damping::kept_per_second(Fx::from_bits(i64::from(i) + 1)));
        let def = BodyDef { linear_damping: damping, angular_damping: damping, ..BodyDef::dynamic() };
        [Command::AddBody(def), Command::RemoveBody(BodyId::from_parts(bodies.len() as u32, i))]
    });
    (world, pairs.collect())
}

/// Fields that act on nobody, which a step hardly sees: thrusts on a body that is disabled.
fn removals_beside_inert_fields(count: usize) -> (World, Vec<Command>) {
    let (mut world, bodies) = unlike_world(count);
    let [idle, rest @ ..] = &bodies[..] else { unreachable!() };
    for _ in 0..4 * count {
        world.add_field(FieldKind::Thrust { at: Attachment::centre(*idle), force: vec2(1, 0) }).expect("a thrust");
    }
    world.disable(*idle).expect("it takes part");
    (world, rest.iter().take(200).map(|&body| Command::RemoveBody(body)).collect())
}

/// A polygon with as many corners as there may be.
fn polygon() -> Shape {
    let corner = |i: i32| {
        let angle = TAU * f64::from(i) / 64.0;
        let bits = |x: f64| Fx::from_bits((x * 2f64.powi(34)) as i64);
        vec2(bits(angle.cos()), bits(angle.sin()))
    };
    Shape::polygon(&(0..64).map(corner).collect::<Vec<_>>()).expect("a polygon")
}

fn fields_removed(count: usize) -> (World, Vec<Command>) {
    let world = chain(count);
    let fields: Vec<_> = world.fields().map(|(id, _)| id).collect();
    (world, fields.into_iter().take(100).map(Command::RemoveField).collect())
}

/// A static body that all others hang on: each time it is moved, they are to be awake.
fn anchors(count: usize) -> (World, Vec<Command>) {
    let (mut world, bodies) = unlike_world(count);
    let anchor = world.add_body(BodyDef::fixed()).expect("a body");
    for &body in &bodies {
        world.add_field(spring(body, anchor)).expect("a spring");
    }
    (asleep(world), [0, 1].map(|x| Command::SetPosition { body: anchor, position: vec2(x, 0) }).into())
}

fn pairs_woken(count: usize) -> (World, Vec<Command>) {
    let (world, bodies) = pairs_asleep(count);
    (world, bodies.chunks(2).take(200).map(|pair| wake(pair[0])).collect())
}

/// Sleepers in all groups but one, woken group by group.
fn groups_woken(count: usize) -> (World, Vec<Command>) {
    let (mut world, bodies) = unlike_world(count);
    for (i, &body) in bodies.iter().enumerate() {
        world.set_force_groups(body, 1 << (i % 31)).expect("it is there");
    }
    let region = Region::Disc { centre: vec2(0, 0), radius: fx!(1) };
    let zone = |group: u32| ForceField {
        kind: FieldKind::Zone { region, acceleration: vec2(1, 0) },
        force_groups: 1 << group,
    };
    // Those that nobody is in between them.
    let force_groups = (0..31).flat_map(|group| [31, group]);
    (asleep(world), force_groups.map(|group| Command::AddField(zone(group))).collect())
}

fn disabled_when_woken(count: usize) -> (World, Vec<Command>) {
    let (world, bodies) = unlike_world(count);
    let all = std::iter::once(Command::SetSleepAfter(Some(31)));
    (asleep(world), all.chain(bodies.iter().take(200).map(|&body| Command::Disable(body))).collect())
}

fn goals(count: usize) -> (World, Vec<Command>) {
    let mut world = world();
    let lifts: Vec<_> = (0..count).map(|_| world.add_body(BodyDef::kinematic()).expect("a body")).collect();
    (world, lifts.iter().map(|&body| Command::MoveTo { body, position: vec2(0, 1), angle: fx!(1) }).collect())
}

fn pushes(count: usize) -> (World, Vec<Command>) {
    let mut world = world();
    let plank = ColliderDef::ghost(Shape::rectangle(fx!(2), fx!(1)).expect("a shape"));
    let def = BodyDef { angle: fx!(1), ..BodyDef::dynamic().with_collider(plank) };
    let bodies: Vec<_> = (0..count).map(|_| world.add_body(def.clone()).expect("a body")).collect();
    let action = ForceOrImpulse::Impulse { impulse: vec2(1, 2), point: Some(vec2(1, 1)) };
    let options = ApplyOptions { frame: umbra_physics::Frame::Body, wake: true };
    (world, bodies.iter().map(|&body| Command::Apply { body, action, options }).collect())
}

/// A tile of a map, 100 to a row.
fn tile(i: usize) -> ColliderDef {
    let position = vec2((i % 100) as i32, (i / 100) as i32);
    ColliderDef { position, ..ColliderDef::new(Shape::rectangle(1, 1).expect("a shape")) }
}

/// A static body with so many tiles.
fn add_map(world: &mut World, count: usize) -> (BodyId, Vec<ColliderId>) {
    let colliders = (0..count).map(tile).collect();
    let map = world.add_body(BodyDef { colliders, position: vec2(0, -1_000), ..BodyDef::fixed() }).expect("a body");
    let colliders = world.colliders_of(map).expect("it is there").collect();
    (map, colliders)
}

/// A map of so many tiles, and a disc that falls.
fn map_world(count: usize) -> (World, BodyId, Vec<ColliderId>) {
    let mut world = world();
    let (map, colliders) = add_map(&mut world, count);
    world.add_body(BodyDef::dynamic().with_collider(Shape::circle(1).expect("a shape"))).expect("a body");
    (0..2).for_each(|_| _ = world.step());
    (world, map, colliders)
}

/// A map of so many tiles, and bodies that move, of which one has a collider.
fn map_among(bodies: usize, count: usize) -> (World, BodyId, Vec<ColliderId>) {
    let (mut world, _) = unlike_world(bodies);
    let (map, colliders) = add_map(&mut world, count);
    world.add_body(BodyDef::dynamic().with_collider(Shape::circle(1).expect("a shape"))).expect("a body");
    (world, map, colliders)
}

fn set(collider: ColliderId) -> Command {
    Command::SetCollider { collider, def: ColliderDef { user_data: 1, ..tile(collider.parts().0 as usize) } }
}

/// Carries out all commands and a step.
fn all_and_a_step(mut world: World, commands: Vec<Command>) -> Box<dyn FnOnce()> {
    Box::new(move || {
        commands.iter().for_each(|command| _ = world.execute(command).expect("it may be done"));
        world.step();
    })
}

fn colliders_of_a_map(count: usize, command: fn(ColliderId) -> Command) -> Box<dyn FnOnce()> {
    let (world, _, colliders) = map_world(count);
    all_and_a_step(world, colliders.into_iter().map(command).collect())
}

fn colliders_added(count: usize) -> Box<dyn FnOnce()> {
    let (world, body, _) = map_world(1);
    all_and_a_step(world, (0..count).map(|i| Command::AddCollider { body, def: tile(i) }).collect())
}

fn colliders_added_to_a_dynamic_body(count: usize) -> Box<dyn FnOnce()> {
    let mut world = world();
    let body = world.add_body(BodyDef::dynamic()).expect("a body");
    let def = |i: usize| ColliderDef { density: fx!(0.01), ..tile(i) };
    all_and_a_step(world, (0..count).map(|i| Command::AddCollider { body, def: def(i) }).collect())
}

fn map_moved(count: usize) -> Box<dyn FnOnce()> {
    let (world, body, _) = map_world(count);
    all_and_a_step(world, vec![Command::SetPosition { body, position: vec2(fx!(0.001), -1_000) }])
}

/// A map with a box above one tile of 16, in rows that are apart.
fn map_with_contacts_removed(count: usize) -> Box<dyn FnOnce()> {
    let mut world = world();
    let place = |i: usize| vec2(2 * (i % 100) as i32, 4 * (i / 100) as i32);
    let colliders = (0..count).map(|i| ColliderDef { position: place(i), contact_events: true, ..tile(0) }).collect();
    let map = world.add_body(BodyDef { colliders, ..BodyDef::fixed() }).expect("a body");
    for i in (0..count).step_by(16) {
        let [x, y] = place(i).into();
        let shape = Shape::rectangle(1, 1).expect("a shape");
        world
            .add_body(BodyDef { position: vec2(x, y + fx!(1)), ..BodyDef::dynamic().with_collider(shape) })
            .expect("a body");
    }
    (0..2).for_each(|_| _ = world.step());
    all_and_a_step(world, vec![Command::RemoveBody(map)])
}

/// A disc on tiles that lie on each other, a quarter as many.
fn tiles_on_each_other(count: usize) -> Box<dyn FnOnce()> {
    let mut world = world();
    let colliders = vec![tile(0); count / 4];
    world.add_body(BodyDef { colliders, ..BodyDef::fixed() }).expect("a body");
    let disc = BodyDef::dynamic().with_collider(Shape::circle(1).expect("a shape"));
    world.add_body(BodyDef { position: vec2(0, fx!(1.5)), ..disc }).expect("a body");
    all_and_a_step(world, Vec::new())
}

fn colliders_removed(count: usize) -> (World, Vec<Command>) {
    let (world, _, colliders) = map_among(count, count);
    (world, colliders.into_iter().map(Command::RemoveCollider).collect())
}

fn colliders_set(count: usize) -> (World, Vec<Command>) {
    let (world, _, colliders) = map_among(count, count);
    (world, colliders.into_iter().take(100).map(set).collect())
}

/// Colliders of a dynamic body, whose mass they change.
fn colliders_of_a_compound_body(count: usize) -> (World, Vec<Command>) {
    let (mut world, _) = unlike_world(count);
    let colliders = (0..count).map(|i| ColliderDef { density: fx!(0.01), ..tile(i) }).collect();
    let body = world.add_body(BodyDef { colliders, ..BodyDef::dynamic() }).expect("a body");
    let colliders: Vec<ColliderId> = world.colliders_of(body).expect("it is there").collect();
    (world, colliders.into_iter().map(Command::RemoveCollider).collect())
}

fn kinds_of_a_map(count: usize) -> (World, Vec<Command>) {
    let (world, body, _) = map_among(count, count);
    (world, [BodyKind::Kinematic, BodyKind::Static].map(|kind| Command::SetKind { body, kind }).into())
}

fn explosions_beside_a_map(count: usize) -> (World, Vec<Command>) {
    let (world, ..) = map_among(50, count);
    (world, [0, 1].map(|x| Command::Explode(Explosion::new(vec2(x, 0), fx!(1)))).into())
}

fn maps_moved(count: usize) -> (World, Vec<Command>) {
    let (world, body, _) = map_among(count, count);
    (world, [0, 1].map(|x| Command::SetPosition { body, position: vec2(x, -1_000) }).into())
}
