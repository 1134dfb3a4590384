//! Scenes of impacts, and what is measured in them.

use umbra_physics::{
    BodyDef, BodyId, ColliderDef, Fx, FxAccumulator, Material, Random, Shape, TimeStep, Vec2, World, WorldDef, fx, vec2,
};

/// 60 steps a second without gravity, in which no body falls asleep.
pub(crate) fn floating() -> WorldDef {
    WorldDef { time_step: TimeStep::hz(60), gravity: Vec2::ZERO, sleep_after: None, ..WorldDef::default() }
}

/// 60 steps a second under a gravity of 10 m/s², in which no body falls asleep.
pub(crate) fn falling() -> WorldDef {
    WorldDef { gravity: vec2(0, -10), ..floating() }
}

/// A world in which the slowest impact bounces.
pub(crate) fn bouncing(mut def: WorldDef) -> WorldDef {
    def.contacts.restitution_speed = Fx::ZERO;
    def
}

/// The number that is nearest to this value.
pub(crate) fn number(value: f64) -> Fx {
    Fx::from_bits((value * 2f64.powi(32)).round() as i64)
}

pub(crate) fn point(x: f64, y: f64) -> Vec2 {
    Vec2::new(number(x), number(y))
}

/// The value of a number, for what is measured.
pub(crate) fn float(value: Fx) -> f64 {
    value.to_bits() as f64 / 2f64.powi(32)
}

pub(crate) fn floats(vector: Vec2) -> [f64; 2] {
    [float(vector.x), float(vector.y)]
}

pub(crate) fn disc(radius: Fx) -> Shape {
    Shape::circle(radius).expect("a disc")
}

pub(crate) fn rectangle(width: Fx, height: Fx) -> Shape {
    Shape::rectangle(width, height).expect("a rectangle")
}

/// A body with one collider at a place.
pub(crate) fn dynamic(collider: impl Into<ColliderDef>, position: Vec2) -> BodyDef {
    BodyDef { position, ..BodyDef::dynamic().with_collider(collider) }
}

pub(crate) fn kinematic(collider: impl Into<ColliderDef>, position: Vec2) -> BodyDef {
    BodyDef { position, ..BodyDef::kinematic().with_collider(collider) }
}

pub(crate) fn fixed(collider: impl Into<ColliderDef>, position: Vec2) -> BodyDef {
    BodyDef { position, ..BodyDef::fixed().with_collider(collider) }
}

/// A floor whose top is at height 0.
pub(crate) fn floor() -> BodyDef {
    fixed(rectangle(fx!(80), fx!(2)), vec2(0, -1))
}

/// The body with all its colliders of this material.
pub(crate) fn of_material(mut body: BodyDef, friction: Fx, restitution: Fx) -> BodyDef {
    for collider in &mut body.colliders {
        collider.material = Material { friction, restitution, ..Material::default() };
    }
    body
}

/// The four walls around a room, each a metre thick; `half` is half of the inner width and height.
pub(crate) fn room(half: i32) -> Vec<BodyDef> {
    let length = Fx::from(2 * half + 2);
    let middle = fx!(0.5) + half.into();
    vec![
        fixed(rectangle(length, fx!(1)), vec2(0, middle)),
        fixed(rectangle(length, fx!(1)), vec2(0, -middle)),
        fixed(rectangle(fx!(1), length), vec2(middle, 0)),
        fixed(rectangle(fx!(1), length), vec2(-middle, 0)),
    ]
}

/// A world with these bodies, and their handles.
pub(crate) fn build(def: WorldDef, bodies: impl IntoIterator<Item = BodyDef>) -> (World, Vec<BodyId>) {
    let mut world = World::new(def).expect("a world");
    let ids = bodies.into_iter().map(|body| world.add_body(body).expect("a body")).collect();
    (world, ids)
}

pub(crate) fn steps(world: &mut World, ticks: u32) {
    (0..ticks).for_each(|_| _ = world.step());
}

pub(crate) fn position(world: &World, body: BodyId) -> [f64; 2] {
    floats(world.body(body).expect("a body").position())
}

pub(crate) fn velocity(world: &World, body: BodyId) -> [f64; 2] {
    floats(world.body(body).expect("a body").velocity())
}

pub(crate) fn spin(world: &World, body: BodyId) -> f64 {
    float(world.body(body).expect("a body").angular_velocity())
}

/// The angle between −π and π.
pub(crate) fn angle(world: &World, body: BodyId) -> f64 {
    let angle = float(world.body(body).expect("a body").angle());
    if angle > std::f64::consts::PI { angle - std::f64::consts::TAU } else { angle }
}

/// The exact position, velocity, angle and angular velocity.
pub(crate) fn motion(world: &World, body: BodyId) -> [i128; 6] {
    let body = world.body(body).expect("a body");
    let (position, velocity) = (body.position_exact(), body.velocity_exact());
    let [x, y, vx, vy, spin] =
        [position.x, position.y, velocity.x, velocity.y, body.angular_velocity_exact()].map(FxAccumulator::to_bits);
    [x, y, vx, vy, spin, body.angle_exact().to_bits().into()]
}

/// The kinetic energy of the dynamic bodies, J.
pub(crate) fn kinetic_energy(world: &World) -> f64 {
    world.kinetic_energy().expect("an energy").to_bits() as f64 / 2f64.powi(64)
}

/// Kinetic and potential energy of the dynamic bodies, J.
pub(crate) fn energy(world: &World) -> f64 {
    world.energy().expect("an energy").to_bits() as f64 / 2f64.powi(64)
}

pub(crate) fn momentum(world: &World) -> [f64; 2] {
    let momentum = world.momentum().expect("a momentum");
    [momentum.x, momentum.y].map(|component| component.to_bits() as f64 / 2f64.powi(64))
}

/// What rounding and the softness of contacts may add to the energy, J: as much as lifts all bodies by 5 mm, and a thousandth of what there is.
pub(crate) fn allowance(world: &World) -> f64 {
    let [x, y] = floats(world.def().gravity);
    let mass: f64 = world.bodies().filter_map(|body| body.mass()).map(float).sum();
    mass * x.hypot(y) * 0.005 + 0.001 * energy(world).abs()
}

/// The first tick at which one of the dynamic bodies does not move as it does alone in a world, and the number of the body.
pub(crate) fn first_exchange(def: WorldDef, bodies: &[BodyDef], ticks: u32) -> Option<(u32, usize)> {
    let (mut world, ids) = build(def, bodies.to_vec());
    let mut flights: Vec<(World, BodyId)> = bodies
        .iter()
        .map(|body| {
            let (world, ids) = build(def, [body.clone()]);
            (world, ids[0])
        })
        .collect();
    for tick in 0..ticks {
        world.step();
        for (number, (flight, alone)) in flights.iter_mut().enumerate() {
            flight.step();
            if motion(&world, ids[number]) != motion(flight, *alone) {
                return Some((tick, number));
            }
        }
    }
    None
}

/// The seeds of a search that has this many cases by day.
pub(crate) fn seeds(cases: u64) -> impl Iterator<Item = u64> {
    0..crate::seeds::times(cases)
}

/// The random numbers of a case of a search.
pub(crate) fn random(search: &str, seed: u64) -> Random {
    let name = search.bytes().fold(0u64, |hash, byte| hash.wrapping_mul(31).wrapping_add(byte.into()));
    Random::seeded(name.wrapping_add(seed))
}

/// A number between the two.
pub(crate) fn between(random: &mut Random, low: f64, high: f64) -> f64 {
    low + (high - low) * float(random.fraction())
}

/// A size between the two, each order of magnitude as likely as the others.
pub(crate) fn of_any_size(random: &mut Random, low: f64, high: f64) -> f64 {
    between(random, low.ln(), high.ln()).exp()
}

/// Fails if a search found something: says how often, and shows the first of it.
#[track_caller]
pub(crate) fn conclude(tried: usize, failures: &[String]) {
    let shown = failures.iter().take(5).map(|failure| format!("\n  {failure}")).collect::<String>();
    assert!(failures.is_empty(), "{} of {tried} cases fail:{shown}", failures.len());
}

/// As [`conclude`], for a search in which the cases of some seeds are known to fail.
#[track_caller]
pub(crate) fn conclude_but(known: &[u64], tried: usize, failures: &[String]) {
    let is_known = |failure: &String| known.iter().any(|seed| failure.starts_with(&format!("seed {seed}:")));
    let others: Vec<String> = failures.iter().filter(|failure| !is_known(failure)).cloned().collect();
    conclude(tried, &others);
}
