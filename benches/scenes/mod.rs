//! The worlds that the benches measure, in any scalar. Each has what its name says and nothing else, so that two of them
//! differ by one thing.

use std::sync::Arc;

use umbra_physics::scalar::Factor;
use umbra_physics::{
    Activity, Attachment, BodyDef, BodyId, BodyState, ColliderDef, CustomForce, CustomForceError, Damping, Dependence,
    End, FieldKind, ForceField, ForceTorque, Fx, Mass, Region, Scalar, Shape, SpringConstants, Vec2, World, WorldDef,
    fx,
};

#[path = "../../tests/support/inputs.rs"]
#[allow(dead_code, reason = "the scenes use a part of the inputs")]
mod inputs;

use inputs::Random;

/// A world and what a step of it begins with.
pub(crate) struct Scene<S: Scalar> {
    pub(crate) world: World<S>,
    /// The bodies that are pushed before each step.
    pub(crate) pushed: Vec<BodyId>,
    /// A kinematic body that is sent on before each step.
    pub(crate) platform: Option<BodyId>,
}

impl<S: Scalar> Scene<S> {
    /// Applies the forces of a tick, and sends the platform on.
    pub(crate) fn push(&mut self) {
        let force = vector(fx!(0.25), fx!(-0.5));
        for &body in &self.pushed {
            self.world.apply_force(body, force).expect("a fair force");
        }
        if let Some(platform) = self.platform {
            let at = self.world.body(platform).expect("it is there").position();
            let next = at + vector(fx!(0.125), Fx::ZERO);
            self.world.move_to(platform, next, S::ZERO).expect("it is near");
        }
    }

    /// A whole tick.
    pub(crate) fn advance(&mut self) {
        self.push();
        self.world.step();
    }
}

fn vector<S: Scalar>(x: Fx, y: Fx) -> Vec2<S> {
    Vec2::new(S::from_fx(x), S::from_fx(y))
}

/// No gravity, no damping, no sleep.
fn calm<S: Scalar>() -> WorldDef<S> {
    WorldDef { sleep_after: None, ..WorldDef::default() }
}

/// Fraction of a velocity left after a second.
const KEPT: Fx = fx!(0.9);

/// Gravity and damping for all.
fn rough<S: Scalar>() -> WorldDef<S> {
    let gravity = vector(Fx::ZERO, fx!(-9.81));
    WorldDef {
        gravity,
        linear_damping: Damping::kept_per_second(S::from_fx(KEPT)),
        angular_damping: Damping::kept_per_second(S::from_fx(KEPT)),
        ..calm()
    }
}

fn scene<S: Scalar>(def: WorldDef<S>, bodies: impl IntoIterator<Item = BodyDef<S>>) -> Scene<S> {
    let mut world = World::with_scalar(def).expect("a fair definition");
    for body in bodies {
        world.add_body(body).expect("a fair body");
    }
    Scene { world, pushed: Vec::new(), platform: None }
}

/// Bodies 4 m apart in a square, at rest.
fn resting<S: Scalar>(count: usize) -> impl Iterator<Item = BodyDef<S>> {
    let side = count.isqrt().max(1);
    let metres = |i: usize| Fx::from(4 * i as i32);
    (0..count).map(move |i| {
        let position = vector(metres(i % side), metres(i / side));
        BodyDef { position, ..BodyDef::dynamic() }
    })
}

/// Up to 4 m/s a component.
fn random_velocity<S: Scalar>(random: &mut Random) -> Vec2<S> {
    let mut component = || Fx::from_bits(random.next() >> 29);
    vector(component(), component())
}

/// Bodies of [`resting`], each on its way.
fn moving<S: Scalar>(count: usize) -> impl Iterator<Item = BodyDef<S>> {
    let mut random = Random(1);
    resting(count).map(move |body| BodyDef { velocity: random_velocity(&mut random), ..body })
}

/// Bodies of [`moving`], each turning as well, by up to 4 rad/s.
fn tumbling<S: Scalar>(count: usize) -> impl Iterator<Item = BodyDef<S>> {
    let mut random = Random(2);
    // An odd number of ulps is not zero.
    moving(count)
        .map(move |body| BodyDef { angular_velocity: S::from_fx(Fx::from_bits(random.next() >> 29 | 1)), ..body })
}

/// All properties that a body alone can have: gravity, damping, spin.
pub(crate) fn free<S: Scalar>(count: usize) -> Scene<S> {
    scene(rough(), tumbling(count))
}

/// Like `free`, with a disc on each body that touches nothing, or that meets others and has none near.
pub(crate) fn discs(count: usize, are_ghosts: bool) -> Scene<Fx> {
    let shape = Shape::circle(fx!(0.25)).expect("a disc");
    let disc = if are_ghosts { ColliderDef::ghost(shape) } else { ColliderDef::new(shape) };
    // The mass that a body without colliders has.
    let mass = Mass::Kilograms(Fx::ONE);
    scene(rough(), tumbling(count).map(|body| BodyDef { mass, ..body }.with_collider(disc.clone())))
}

/// Bodies that move on straight: none of the things that the scenes below have one each of.
pub(crate) fn plain<S: Scalar>(count: usize) -> Scene<S> {
    scene(calm(), moving(count))
}

/// Like `plain`, but without a mass, so that no force moves the bodies.
pub(crate) fn kinematic<S: Scalar>(count: usize) -> Scene<S> {
    let velocities = moving::<S>(count);
    scene(
        calm(),
        velocities.map(|BodyDef { position, velocity, .. }| BodyDef { position, velocity, ..BodyDef::kinematic() }),
    )
}

/// Like `free`, with bodies that never move.
pub(crate) fn beside_static<S: Scalar>(count: usize, fixed: usize) -> Scene<S> {
    let fixed = resting(fixed).map(|BodyDef { position, .. }| BodyDef { position, ..BodyDef::fixed() });
    scene(rough(), fixed.chain(tumbling(count)))
}

/// Balls that roll over a floor of tiles on one body; more tiles are below, out of reach.
pub(crate) fn over_tiles(count: usize, tiles: usize) -> Scene<Fx> {
    let width = 4 * count.max(1);
    let shape = Shape::rectangle(1, 1).expect("a tile");
    let tile = |i: usize| {
        let depth = if i < width { 0 } else { 10 + i / width };
        let position = vector(Fx::from((i % width) as i32), Fx::from(-(depth as i32)));
        ColliderDef { position, ..ColliderDef::new(shape.clone()) }
    };
    let map = BodyDef { colliders: (0..tiles.max(width)).map(tile).collect(), ..BodyDef::fixed() };
    let disc = Shape::circle(fx!(0.5)).expect("a disc");
    let ball = move |i: usize| BodyDef {
        position: vector(Fx::from(4 * i as i32), fx!(1)),
        velocity: vector(fx!(1), Fx::ZERO),
        ..BodyDef::dynamic().with_collider(disc.clone())
    };
    scene(
        WorldDef { gravity: vector(Fx::ZERO, fx!(-9.81)), ..calm() },
        std::iter::once(map).chain((0..count).map(ball)),
    )
}

/// Like [`over_tiles`], after a step and the removal of a tile that is out of reach.
pub(crate) fn edited_tiles(count: usize, tiles: usize) -> Scene<Fx> {
    let mut scene = over_tiles(count, tiles);
    (0..2).for_each(|_| scene.advance());
    let mut colliders: Vec<_> = scene
        .world
        .bodies()
        .flat_map(|body| scene.world.colliders_of(body.id()).expect("it").collect::<Vec<_>>())
        .collect();
    colliders.sort_unstable();
    scene.world.remove_collider(colliders[tiles - 1]).expect("a tile");
    scene
}

/// Bodies at rest which are awake.
pub(crate) fn at_rest<S: Scalar>(count: usize) -> Scene<S> {
    scene(calm(), resting(count))
}

/// Like `free`, beside bodies that are asleep.
pub(crate) fn beside_sleepers<S: Scalar>(count: usize, sleepers: usize) -> Scene<S> {
    let weightless = resting(sleepers).map(|body| BodyDef { gravity_scale: S::ZERO, ..body });
    let def = WorldDef { sleep_after: Some(1), ..rough() };
    let mut scene = scene(def, weightless.chain(tumbling(count)));
    // At rest since the first step, asleep by the end of the second at the latest.
    scene.world.step();
    scene.world.step();
    assert_eq!(scene.world.moving_count(), count, "they are not asleep");
    scene
}

/// Towers of five boxes, each on a floor of its own, that sleep; and boxes that fall far above them.
pub(crate) fn towers_asleep(falling: usize, boxes: usize) -> Scene<Fx> {
    let shape = Shape::rectangle(1, 1).expect("a box");
    let box_at =
        |x: i32, y: Fx| BodyDef { position: vector(Fx::from(x), y), ..BodyDef::dynamic().with_collider(shape.clone()) };
    let tower = |i: usize| 3 * (i / 5) as i32;
    let asleep = (0..boxes).map(|i| box_at(tower(i), fx!(0.5) + Fx::from((i % 5) as i32)));
    let floor = Shape::rectangle(2, 1).expect("a floor");
    let floors = (0..boxes).step_by(5).map(|i| BodyDef {
        position: vector(Fx::from(tower(i)), fx!(-0.5)),
        ..BodyDef::fixed().with_collider(floor.clone())
    });
    let above = (0..falling).map(|i| box_at(3 * i as i32, fx!(1000)));
    let def = WorldDef { gravity: vector(Fx::ZERO, fx!(-9.81)), sleep_after: Some(4), ..calm() };
    let mut scene = scene(def, floors.chain(asleep).chain(above));
    (0..8).for_each(|_| scene.advance());
    assert_eq!(scene.world.moving_count(), falling, "they are not asleep");
    scene
}

/// Pyramids of ten rows of boxes that just touch, each on a floor of its own, after eight steps.
pub(crate) fn pyramids(count: usize) -> Scene<Fx> {
    const ROWS: i32 = 10;
    let (shape, floor) = (Shape::rectangle(1, 1).expect("a box"), Shape::rectangle(11, 1).expect("a floor"));
    let body = |def: BodyDef, shape: &Shape, x: Fx, y: Fx| {
        BodyDef { position: vector(x, y), ..def }.with_collider(shape.clone())
    };
    let bodies = (0..count as i32).flat_map(|i| {
        let middle = Fx::from(12 * i);
        let boxes = (0..ROWS).flat_map(move |row| (0..ROWS - row).map(move |k| (row, 2 * k - (ROWS - row - 1))));
        let along = |halves: i32| middle + Fx::from(halves) / 2;
        let boxes =
            boxes.map(|(row, halves)| body(BodyDef::dynamic(), &shape, along(halves), fx!(0.5) + Fx::from(row)));
        std::iter::once(body(BodyDef::fixed(), &floor, middle, fx!(-0.5))).chain(boxes).collect::<Vec<_>>()
    });
    let mut scene = scene(WorldDef { gravity: vector(Fx::ZERO, fx!(-9.81)), ..calm() }, bodies);
    (0..8).for_each(|_| scene.advance());
    scene
}

/// Like [`towers_asleep`] with one box that falls, after a call that wakes a tower.
pub(crate) fn tower_woken(boxes: usize) -> Scene<Fx> {
    let mut scene = towers_asleep(1, boxes);
    let asleep = |body: &umbra_physics::BodyRef<'_, Fx>| body.activity() == Activity::Asleep;
    let sleeper = scene.world.bodies().find(asleep).expect("one that sleeps").id();
    scene.world.wake(sleeper).expect("it is there");
    scene
}

/// Like `plain`, with the first `count` bodies pushed each tick.
pub(crate) fn pushed<S: Scalar>(count: usize, pushed: usize) -> Scene<S> {
    let mut scene = plain(count);
    scene.pushed = scene.world.bodies().map(|body| body.id()).take(pushed).collect();
    scene
}

/// Like `plain`, with all bodies pushed in the tick before.
pub(crate) fn pushed_before<S: Scalar>(count: usize) -> Scene<S> {
    let mut scene = pushed(count, count);
    scene.advance();
    scene.pushed.clear();
    scene
}

/// Like `plain`, turning.
pub(crate) fn spinning<S: Scalar>(count: usize) -> Scene<S> {
    scene(calm(), tumbling(count))
}

/// Like `spinning`, in gravity.
pub(crate) fn falling<S: Scalar>(count: usize) -> Scene<S> {
    scene(WorldDef { gravity: vector(Fx::ZERO, fx!(-9.81)), ..calm() }, tumbling(count))
}

/// Like `plain`, damped.
pub(crate) fn damped<S: Scalar>(count: usize) -> Scene<S> {
    scene(WorldDef { linear_damping: Damping::kept_per_second(S::from_fx(KEPT)), ..calm() }, moving(count))
}

fn with_fields<S: Scalar, F: Into<ForceField<S>>>(
    mut scene: Scene<S>,
    fields: impl FnOnce(&[BodyId]) -> Vec<F>,
) -> Scene<S> {
    let bodies: Vec<BodyId> = scene.world.bodies().map(|body| body.id()).collect();
    for field in fields(&bodies) {
        scene.world.add_field(field).expect("a fair field");
    }
    scene
}

/// A number of thrusts fixed in the frame of each of the first `some` bodies.
fn with_thrusters<S: Scalar>(scene: Scene<S>, some: usize, each: usize) -> Scene<S> {
    with_fields(scene, |bodies| {
        let thrust = |&body| FieldKind::Thrust {
            at: Attachment { body, point: Vec2::ZERO },
            force: vector(fx!(0.25), fx!(0.5)),
        };
        bodies[..some].iter().flat_map(|body| std::iter::repeat_n(thrust(body), each)).collect()
    })
}

/// Like `plain`, with a number of thrusts on each body.
pub(crate) fn thrusters<S: Scalar>(count: usize, each: usize) -> Scene<S> {
    with_thrusters(plain(count), count, each)
}

/// Like `thrusters` with one thrust each, and all bodies pushed each tick besides.
pub(crate) fn pushed_thrusters<S: Scalar>(count: usize) -> Scene<S> {
    let mut scene = thrusters(count, 1);
    scene.pushed = scene.world.bodies().map(|body| body.id()).collect();
    scene
}

/// Like `free`, two of the bodies in the midst of the others joined by a spring.
pub(crate) fn one_spring<S: Scalar>(count: usize) -> Scene<S> {
    with_fields(free(count), |bodies| {
        let [near, far] = [count / 2, count / 2 + 1].map(|i| Attachment { body: bodies[i], point: Vec2::ZERO });
        let spring = SpringConstants { rest: S::from_fx(fx!(4)), stiffness: S::ONE, damping: S::ZERO };
        vec![FieldKind::Spring { near, far: End::Body(far), spring }]
    })
}

/// Like `free`, with a zone around all bodies that acts on those in these groups; the bodies are in group 1.
pub(crate) fn zone<S: Scalar>(count: usize, force_groups: u32) -> Scene<S> {
    with_fields(free(count), |_| {
        let [min, max] = [fx!(-1_000_000), fx!(1_000_000)].map(|c| vector(c, c));
        let kind = FieldKind::Zone { region: Region::Box { min, max }, acceleration: vector(fx!(1), fx!(2)) };
        vec![ForceField { kind, force_groups }]
    })
}

/// Like `thrusters`, one each, beside a kinematic body that is sent on each tick.
pub(crate) fn thrusters_beside_platform<S: Scalar>(count: usize) -> Scene<S> {
    let mut scene = thrusters(count, 1);
    let position = vector(fx!(0), fx!(-100));
    let platform = BodyDef { position, ..BodyDef::kinematic() };
    scene.platform = Some(scene.world.add_body(platform).expect("a fair body"));
    scene
}

/// Like `free`, the first tenth with a thrust each, the second joined in a chain of springs.
pub(crate) fn mixed<S: Scalar>(count: usize) -> Scene<S> {
    with_fields(with_thrusters(free(count), count / 10, 1), |bodies| {
        let spring = SpringConstants { rest: S::from_fx(fx!(4)), stiffness: S::from_fx(fx!(10)), damping: S::ZERO };
        let join = |pair: &[BodyId]| FieldKind::Spring {
            near: Attachment { body: pair[0], point: Vec2::ZERO },
            far: End::Body(Attachment { body: pair[1], point: Vec2::ZERO }),
            spring,
        };
        bodies[count / 10..count / 5].windows(2).map(join).collect()
    })
}

/// Like `free`, around three attractors.
pub(crate) fn orbits<S: Scalar>(count: usize) -> Scene<S> {
    with_fields(free(count), |_| {
        let centres = [(-1000, 0), (1000, 0), (0, 1000)];
        let attractor = |(x, y): (i32, i32)| FieldKind::Attractor {
            centre: End::World(vector(Fx::from(x), Fx::from(y))),
            mu: S::Factor::from_ratio(100_000, 1),
            softening: S::from_fx(fx!(1)),
        };
        centres.map(attractor).into()
    })
}

/// Like `free`, against a wind.
pub(crate) fn drag<S: Scalar>(count: usize) -> Scene<S> {
    with_fields(free(count), |_| {
        let (linear, quadratic) = (S::from_fx(fx!(0.125)), S::from_fx(fx!(0.0078125)));
        vec![FieldKind::Drag { linear, quadratic, wind: vector(fx!(5), fx!(1)) }]
    })
}

/// A net of springs, as long at rest as they are at first, that springs to and fro.
pub(crate) fn net<S: Scalar>(columns: usize, rows: usize) -> Scene<S> {
    let nodes = (0..columns * rows).map(|i| (i % columns, i / columns));
    let place = |(x, y): (usize, usize)| vector(Fx::from(x as i32), Fx::from(y as i32));
    let mut random = Random(3);
    let bodies = nodes.clone().map(|node| BodyDef {
        position: place(node),
        velocity: random_velocity(&mut random),
        ..BodyDef::dynamic()
    });
    with_fields(scene(calm(), bodies), |bodies| {
        let spring = SpringConstants { rest: S::ONE, stiffness: S::from_fx(fx!(100)), damping: S::ZERO };
        let join = |a: usize, b: usize| FieldKind::Spring {
            near: Attachment { body: bodies[a], point: Vec2::ZERO },
            far: End::Body(Attachment { body: bodies[b], point: Vec2::ZERO }),
            spring,
        };
        let across = nodes.clone().filter(|&(x, _)| x > 0).map(|(x, y)| (y * columns + x, 1));
        let down = nodes.clone().filter(|&(_, y)| y > 0).map(|(x, y)| (y * columns + x, columns));
        across.chain(down).map(|(node, stride)| join(node - stride, node)).collect()
    })
}

/// Like `net`, on a ground that is seen from above.
pub(crate) fn net_on_ground<S: Scalar>(columns: usize, rows: usize) -> Scene<S> {
    with_fields(net(columns, rows), |_| {
        let (deceleration, angular_deceleration) = (S::from_fx(fx!(0.5)), S::from_fx(fx!(0.25)));
        vec![FieldKind::Friction { deceleration, angular_deceleration }]
    })
}

/// A law of the caller's own: the same force on each body.
struct Steady;

impl<S: Scalar> CustomForce<S> for Steady {
    fn id(&self) -> u64 {
        1
    }

    fn version(&self) -> u32 {
        1
    }

    fn depends_on(&self) -> Dependence {
        Dependence::Position
    }

    fn push(&self, _: &BodyState<S>) -> Result<ForceTorque<S>, CustomForceError> {
        Ok(ForceTorque { force: vector(fx!(0.25), fx!(0.5)), torque: S::ZERO })
    }
}

fn with_steady_law<S: Scalar>(mut scene: Scene<S>) -> Scene<S> {
    scene.world.register_custom_force(Arc::new(Steady)).expect("the first of its id");
    with_fields(scene, |_| vec![FieldKind::Custom { id: 1 }])
}

/// Like `free`, with a custom force.
pub(crate) fn custom<S: Scalar>(count: usize) -> Scene<S> {
    with_steady_law(free(count))
}

/// Like `thrusters` on the first bodies, with a custom force, so that a force acts on each body.
pub(crate) fn thrusters_on_some<S: Scalar>(count: usize, some: usize, each: usize) -> Scene<S> {
    with_thrusters(with_steady_law(plain(count)), some, each)
}
